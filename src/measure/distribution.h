/* SPDX-License-Identifier: Apache-2.0 */
/* Distributions of counts: object tests, extent tests and steps over the rays of a cell, sizes and depths
 * over the leaves of a structure. A mean hides the few rays that cost a hundred times as much, and the few
 * leaves that hold half of the objects.
 *
 * Percentiles are exact: of `count` sorted values, the one of rank ceil(part * count). Histograms have a bin
 * for each value below 16 and eight for every doubling beyond, so no bin is wider than an eighth of its lower
 * end. */
#ifndef RT_MEASURE_DISTRIBUTION_H
#define RT_MEASURE_DISTRIBUTION_H

#include "core/base/status.h"
#include "core/base/tally.h"

#include <jansson.h>
#include <stdbool.h>

/* Quantities, each X(name, meaning): counters of RtTally with that name, over rays; and quantities of leaves.
 */
#define RT_RAY_QUANTITIES(X)                                                                                 \
    X(object_tests, "object tests of a ray")                                                                 \
    X(extent_tests, "extent tests of a ray")                                                                 \
    X(steps, "steps of a ray")
#define RT_LEAF_QUANTITIES(X)                                                                                \
    X(leaf_size, "objects in the list of a leaf, or voxel")                                                  \
    X(leaf_depth, "depth of a leaf, or voxel, the root being 0")

#define RT_QUANTITY_ENUM(name, meaning) RT_QUANTITY_##name,
typedef enum RtRayQuantity { RT_RAY_QUANTITIES(RT_QUANTITY_ENUM) RT_RAY_QUANTITY_COUNT } RtRayQuantity;
typedef enum RtLeafQuantity { RT_LEAF_QUANTITIES(RT_QUANTITY_ENUM) RT_LEAF_QUANTITY_COUNT } RtLeafQuantity;
#undef RT_QUANTITY_ENUM

/* "object_tests", ..., and after the quantities of rays, "leaf_size", ...: 0 <= i < RT_QUANTITY_COUNT. */
enum { RT_QUANTITY_COUNT = (int)RT_RAY_QUANTITY_COUNT + (int)RT_LEAF_QUANTITY_COUNT };
const char *rt_quantity_name(size_t i);

enum { RT_HISTOGRAM_BINS = 16 + 8 * 28 };

typedef struct RtDistribution {
    uint64_t count, sum;                   /* of the values */
    uint64_t median, p90, p99, p999, most; /* percentiles: 50 %, 90 %, 99 %, 99.9 %; the largest value */
    uint64_t bins[RT_HISTOGRAM_BINS];      /* number of values in each */
} RtDistribution;

/* The bin of a value < 2^32, and the least value of a bin; that of RT_HISTOGRAM_BINS is the end of the last
 * bin. */
uint32_t rt_histogram_bin(uint64_t value);
uint64_t rt_histogram_low(uint32_t bin);

/* Counts how often each value occurs. */
typedef struct RtOccurrences {
    uint64_t *of;           /* [end], owned */
    uint32_t end, capacity; /* all values are below `end` */
} RtOccurrences;

/* Adds a value. RT_NO_MEMORY: every value up to the largest takes eight bytes. RT_BROKEN if it is absurdly
 * large. */
RtStatus rt_occurrences_add(RtOccurrences *occurrences, uint64_t value, RtError *error);
void rt_occurrences_clear(RtOccurrences *occurrences);

/* All zero if there are no values. */
RtDistribution rt_distribution_of(const RtOccurrences *occurrences);

/* distributions[0..count) under their names, from rt_quantity_name(first), as a JSON object, a new reference,
 * and back; empty bins are omitted. False if one is missing. */
json_t *rt_distributions_json(const RtDistribution *distributions, size_t first, size_t count);
bool rt_distributions_take(RtDistribution *distributions, size_t first, size_t count, const json_t *object);

#endif
