/* SPDX-License-Identifier: Apache-2.0 */
/* The table of `raytally info --extents`: how tight the extents of a scene are, by shape, and what they cost
 * (Weghorst, Hooper & Greenberg 1984).
 *
 * Tightness is the projected area of an extent over that of its object, averaged over all directions. The
 * part of uniform random lines through a sphere that hit a body within it is proportional to this area
 * (Crofton's formula). So tightness is found by counting: of random lines through a sphere around the object
 * and its extents, those that hit the extent over those that hit the object.
 *
 * A row covers many objects: the summed areas of their extents over their own summed areas. That is the
 * number of extents that a random line hits for each object that it hits. Each object gets lines in
 * proportion to the area of its sphere, so plain sums of hits have this ratio.
 *
 * A line that hits an object hits its extent (accel/extent.h), so the number O of the E lines through the
 * extent is binomial, and the interval of O / E is Wilson's (1927, "Probable Inference", JASA 22).
 *
 * The cost of a line is T = b B + i I. Here the b extents of the objects of a shape are in a list without a
 * hierarchy: b is their number, B the time of an extent test, i the number of extents that a random line
 * through the scene hits, and I the time of an object test. B is measured by traversing a list: a ray and its
 * line are prepared once, then each extent is tested. I is measured on rays that hit the object's box; no
 * other ray is tested against the object. */
#ifndef RT_MEASURE_EXTENTS_TABLE_H
#define RT_MEASURE_EXTENTS_TABLE_H

#include "accel/extent.h"
#include "core/scene/scene.h"
#include "core/text/table.h"
#include "measure/measure.h"

typedef struct RtExtentChoice {
    RtExtentKind kind;
    uint32_t slabs; /* plane sets, 3..RT_MAX_SLABS; 0 for the other kinds */
} RtExtentChoice;

/* Of the objects of one shape, or of all; with the same lines for each extent. */
typedef struct RtTightness {
    uint64_t lines, extent_hits, object_hits;
    double ratio, low, high; /* tightness and its 95 % interval. If no object is hit (triangles without
                                area), the ratio is NaN and `high` infinite; if no extent is hit either, all
                                three are NaN */
    double met; /* mean number of extents of these objects that a random line through the scene's bounding
                   sphere hits */
} RtTightness;

typedef struct RtExtentCost {
    RtEstimate test;  /* B, seconds */
    RtEstimate line;  /* T, seconds */
    RtEstimate ratio; /* T over that of the first choice, paired by rounds */
} RtExtentCost;

/* Boxes, spheres, oriented boxes, and 3..RT_MAX_SLABS slabs. */
enum { RT_MAX_EXTENT_CHOICES = RT_EXTENT_KIND_COUNT - 1 + RT_MAX_SLABS - 2 };

/* The extents of the objects of one shape, or of all. */
typedef struct RtExtentsOfShape {
    RtShape shape; /* RT_SHAPE_COUNT: all objects of a scene of several shapes */
    uint32_t objects;
    RtTightness tightness[RT_MAX_EXTENT_CHOICES];
    RtExtentCost cost[RT_MAX_EXTENT_CHOICES];
    RtEstimate object; /* seconds of an object test; all NaN if no ray hit a box */
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
