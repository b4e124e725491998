/* SPDX-License-Identifier: Apache-2.0 */
/* The table of `raytally info --extents`: how tight the extents of a scene are, by shape, and what they cost.
 *
 * The cost of a line is T = b B + i I (Weghorst, Hooper & Greenberg 1984). Here the b extents of a population
 * are in a list without a hierarchy: b is their number, B the time of an extent test, i the number of extents
 * that a random line through the scene hits, and I the time of an object test. B is measured by traversing a
 * list: a ray and its line are prepared once, then each extent is tested. I is measured on rays that hit the
 * object's box; no other ray is tested against the object. */
#ifndef RT_MEASURE_EXTENTS_TABLE_H
#define RT_MEASURE_EXTENTS_TABLE_H

#include "core/scene/scene.h"
#include "core/text/table.h"
#include "measure/statistics.h"
#include "measure/tightness.h"

typedef struct RtExtentCost {
    RtEstimate test;  /* B, seconds */
    RtEstimate line;  /* T, seconds */
    RtEstimate ratio; /* T over that of the first choice, paired by rounds */
} RtExtentCost;

/* Times what rt_tightness_count has counted: tightness[i] and out[i] are for choices[i]. *object is I, all
 * NaN if no ray hit a box. The population is not empty. */
RtStatus rt_extent_cost_time(const RtPopulation *population, const RtExtentChoice *choices, size_t count,
                             const RtTightness *tightness, const RtRounds *rounds, RtEstimate *object,
                             RtExtentCost *out, RtError *error);

/* Boxes, spheres, oriented boxes, and 3..RT_MAX_SLABS slabs. */
enum { RT_MAX_EXTENT_CHOICES = RT_EXTENT_KIND_COUNT - 1 + RT_MAX_SLABS - 2 };

/* The extents of the objects of one shape, or of all. */
typedef struct RtExtentsOfShape {
    RtShape shape; /* RT_SHAPE_COUNT: all objects of a scene of several shapes */
    uint32_t objects;
    RtTightness tightness[RT_MAX_EXTENT_CHOICES];
    RtExtentCost cost[RT_MAX_EXTENT_CHOICES];
    RtEstimate object; /* seconds of an object test */
} RtExtentsOfShape;

typedef struct RtExtentsTable {
    uint64_t lines, seed;
    size_t choice_count, shape_count;
    RtExtentChoice choices[RT_MAX_EXTENT_CHOICES];
    RtExtentsOfShape shapes[RT_SHAPE_COUNT + 1];
} RtExtentsTable;

/* Measures with `lines` random lines per shape; slabs of 3, 7 and 13, or with `every_slabs` each number. */
RtStatus rt_extents_table(RtExtentsTable *table, const RtScene *scene, bool every_slabs, uint64_t lines,
                          uint64_t seed, RtError *error);

/* The columns of "rows" in JSON: a shape and an extent. */
extern const RtColumnGroup rt_extents_json[1];

void rt_extents_table_print(const RtExtentsTable *table, FILE *out);
json_t *rt_extents_table_json(const RtExtentsTable *table);

#endif
