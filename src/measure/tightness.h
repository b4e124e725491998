/* SPDX-License-Identifier: Apache-2.0 */
/* Tightness of extents (Weghorst, Hooper & Greenberg 1984): the projected area of an extent over that of its
 * object, averaged over all directions.
 *
 * Of the lines that meet a sphere, drawn uniformly, a part that is proportional to this area meets a thing
 * within it (Crofton's formula). So tightness is found by counting: random lines through a sphere about the
 * object and its extents, those that meet the extent over those that meet the object.
 *
 * A row is about many objects: the sum of the areas of their extents over the sum of theirs. That is how many
 * extents a random line meets for every object that it meets, and so what tightness costs. Each object gets
 * lines in proportion to the area of the sphere about it; then plain sums of hits have this ratio.
 *
 * A line that meets an object meets its extent (accel/extent.h), so O of the E lines that meet the extent is
 * a binomial count, and the interval of O / E is Wilson's (1927, "Probable Inference", JASA 22). */
#ifndef RT_MEASURE_TIGHTNESS_H
#define RT_MEASURE_TIGHTNESS_H

#include "accel/extent.h"

typedef struct RtExtentChoice {
    RtExtentKind kind;
    uint32_t slabs; /* plane sets, 3..RT_MAX_SLABS; 0 for the other kinds */
} RtExtentChoice;

/* Objects of one shape of a finished geometry, or all of it: RT_SHAPE_COUNT. */
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
    double ratio, low, high; /* tightness and its 95 % interval. Where no object is ever met (triangles
                                without area) the ratio is NaN and `high` infinite; where no extent is met,
                                either, all three are NaN */
    double met; /* extents of the population that a random line through the scene's bounding sphere meets, on
                   average */
} RtTightness;

/* Counts what `lines` lines meet; the same lines for out[i] of each choices[i]. */
RtStatus rt_tightness_count(const RtPopulation *population, const RtExtentChoice *choices, size_t count,
                            uint64_t lines, uint64_t seed, RtTightness *out, RtError *error);

/* A sphere about object `id` and its extents of every kind, with some room. */
RtBall rt_sphere_about_extents(const RtGeometry *geometry, uint32_t id);

#endif
