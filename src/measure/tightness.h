/* SPDX-License-Identifier: Apache-2.0 */
/* Tightness of extents (Weghorst, Hooper & Greenberg 1984): the projected area of an extent over that of its
 * object, averaged over all directions.
 *
 * The part of uniform random lines through a sphere that hit a body within it is proportional to this area
 * (Crofton's formula). So tightness is found by counting: of random lines through a sphere around the object
 * and its extents, those that hit the extent over those that hit the object.
 *
 * A row covers many objects: the summed areas of their extents over their own summed areas. That is the
 * number of extents that a random line hits for each object that it hits. Each object gets lines in
 * proportion to the area of its sphere, so plain sums of hits have this ratio.
 *
 * A line that hits an object hits its extent (accel/extent.h), so the number O of the E lines through the
 * extent is binomial, and the interval of O / E is Wilson's (1927, "Probable Inference", JASA 22). */
#ifndef RT_MEASURE_TIGHTNESS_H
#define RT_MEASURE_TIGHTNESS_H

#include "accel/extent.h"

typedef struct RtExtentChoice {
    RtExtentKind kind;
    uint32_t slabs; /* plane sets, 3..RT_MAX_SLABS; 0 for the other kinds */
} RtExtentChoice;

/* Objects of one shape of a finished geometry, or all of them: RT_SHAPE_COUNT. */
typedef struct RtPopulation {
    const RtGeometry *geometry; /* borrowed */
    RtShape shape;
    uint32_t count;
    uint32_t *ids; /* [count] ascending, owned */
} RtPopulation;

RtStatus rt_population_init(RtPopulation *population, const RtGeometry *geometry, RtShape shape,
                            RtError *error);
void rt_population_clear(RtPopulation *population);

typedef struct RtTightness {
    uint64_t lines, extent_hits, object_hits;
    double ratio, low, high; /* tightness and its 95 % interval. If no object is hit (triangles without
                                area), the ratio is NaN and `high` infinite; if no extent is hit either, all
                                three are NaN */
    double met; /* mean number of extents of the population that a random line through the scene's bounding
                   sphere hits */
} RtTightness;

/* Counts the hits of `lines` lines; out[i] is for choices[i], with the same lines. */
RtStatus rt_tightness_count(const RtPopulation *population, const RtExtentChoice *choices, size_t count,
                            uint64_t lines, uint64_t seed, RtTightness *out, RtError *error);

/* A sphere around object `id` and its extents of every kind, slightly enlarged. */
RtBall rt_sphere_about_extents(const RtGeometry *geometry, uint32_t id);

#endif
