/* SPDX-License-Identifier: Apache-2.0 */
/* The table of `raytally info --extents`: how tight the extents of a scene are, by shape, and what they
 * cost. */
#ifndef RT_MEASURE_EXTENTS_TABLE_H
#define RT_MEASURE_EXTENTS_TABLE_H

#include "core/scene/scene.h"
#include "core/text/table.h"
#include "measure/extent_cost.h"

/* Boxes, spheres, oriented boxes, and 3..RT_MAX_SLABS slabs. */
enum { RT_MAX_EXTENT_CHOICES = RT_EXTENT_KIND_COUNT - 1 + RT_MAX_SLABS - 2 };

/* The extents of the objects of one shape, or of all. */
typedef struct RtExtentsOfShape {
    RtShape shape; /* RT_SHAPE_COUNT: all objects of a scene of several shapes */
    uint32_t objects;
    RtTightness tightness[RT_MAX_EXTENT_CHOICES];
    RtExtentCost cost[RT_MAX_EXTENT_CHOICES];
    RtEstimate object; /* seconds an object test takes */
} RtExtentsOfShape;

typedef struct RtExtentsTable {
    uint64_t lines, seed;
    size_t choice_count, shape_count;
    RtExtentChoice choices[RT_MAX_EXTENT_CHOICES];
    RtExtentsOfShape shapes[RT_SHAPE_COUNT + 1];
} RtExtentsTable;

/* Measures with `lines` random lines a shape; of slabs, 3, 7 and 13, or with `every_slabs` each number. */
RtStatus rt_extents_table(RtExtentsTable *table, const RtScene *scene, bool every_slabs, uint64_t lines,
                          uint64_t seed, RtError *error);

/* The columns of "rows" there: a shape and an extent. */
extern const RtColumnGroup rt_extents_json[1];

void rt_extents_table_print(const RtExtentsTable *table, FILE *out);
json_t *rt_extents_table_json(const RtExtentsTable *table);

#endif
