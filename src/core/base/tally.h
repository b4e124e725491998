/* SPDX-License-Identifier: Apache-2.0 */
/* Tallies: the cost of tracing, counted in events that are the same on every machine. RT_TALLY_COUNTERS is
 * the one list of counters: the struct, the sums, the CSV columns, --help and the docs all expand it.
 *
 * A tally belongs to one thread and one ray kind; tallies are summed at the end, so counts do not depend
 * on the number of threads. Kernels count with RT_COUNT(tally, field, n). In timed kernels the tally is a
 * constant NULL, and the count vanishes. */
#ifndef RT_BASE_TALLY_H
#define RT_BASE_TALLY_H

#include <stddef.h>
#include <stdint.h>

/* X(name, meaning) */
#define RT_TALLY_COUNTERS(X) RT_FIRST_TALLY_COUNTERS(X) RT_ADDED_TALLY_COUNTERS(X)

/* Results of earlier versions lack these. */
#define RT_ADDED_TALLY_COUNTERS(X)                                                                           \
    X(instances_entered, "rays moved into a part, after the object test of its instance")

#define RT_FIRST_TALLY_COUNTERS(X)                                                                           \
    X(rays, "rays traced")                                                                                   \
    X(hits, "rays that hit an object")                                                                       \
    X(object_tests,                                                                                          \
      "calls of exact ray-object intersection routines; a SIMD lane that holds an object counts as one")     \
    X(object_hits, "object tests that found the object within [tmin, tmax]")                                 \
    X(extent_tests, "ray-extent tests; a SIMD lane that holds an extent counts as one")                      \
    X(steps, "nodes, voxels or list entries visited by a traversal")                                         \
    X(leaf_steps, "steps to leaves or voxels, including empty ones")                                         \
    X(empty_steps, "steps to leaves or voxels without objects")                                              \
    X(csg_tests, "leaf solids tested inside CSG trees")                                                      \
    X(repeats_avoided, "object tests that a mailbox saved")                                                  \
    X(passed_on, "rays of its own kind that an overlay passed to the accelerator below it")

typedef struct RtTally {
#define RT_TALLY_FIELD(name, meaning) uint64_t name;
    RT_TALLY_COUNTERS(RT_TALLY_FIELD)
#undef RT_TALLY_FIELD
} RtTally;

enum { RT_TALLY_COUNTER_COUNT = sizeof(RtTally) / sizeof(uint64_t) };

/* Adds `n` to a counter of `tally`, unless that is NULL. */
#define RT_COUNT(tally, counter, n)                                                                          \
    do {                                                                                                     \
        if (tally) (tally)->counter += (uint64_t)(n);                                                        \
    } while (0)

/* Name and one-line meaning of counter `i`, 0 <= i < RT_TALLY_COUNTER_COUNT, in the order of the struct. */
const char *rt_tally_name(size_t i);
const char *rt_tally_meaning(size_t i);

/* Value of counter `i`. */
uint64_t rt_tally_get(const RtTally *tally, size_t i);

/* The first counter in which two tallies differ; RT_TALLY_COUNTER_COUNT if none does. */
size_t rt_tally_difference(const RtTally *a, const RtTally *b);

/* The most that a counter of a sum reaches: JSON has signed integers of 64 bits. */
#define RT_TALLY_MOST ((uint64_t)INT64_MAX)

/* sum += part, counter by counter; a counter that would exceed RT_TALLY_MOST stays there. */
void rt_tally_add(RtTally *sum, const RtTally *part);

/* The name of a counter that has reached RT_TALLY_MOST, so that its value is unknown; NULL if none has. */
const char *rt_tally_overflown(const RtTally *tally);

#endif
