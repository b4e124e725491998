/* SPDX-License-Identifier: Apache-2.0 */
/* light: the light buffer of Haines & Greenberg 1986, an overlay for shadow rays.
 *
 * A ray to a light lies in one cell of the cube around it, and can be blocked by the objects in the list of
 * that cell alone, and of these by none that is deeper than the ray's origin. A cell may have a cover, an
 * object that hides whatever is behind it: lists end there.
 *
 * Two things save object tests beside the lists. An object's box is tested first, and if it is flat, whether
 * its plane lies between origin and light at all: the receiver's does not, nor that of its neighbours
 * (side.h). And each cell remembers the entry that blocked its last ray, which is tried before the others
 * (cache): a shadow cache whose entries are as many as there are cells. What is remembered lies in the query,
 * stamped with the epoch in which it was; rt_query_begin begins a new one.
 *
 * Every object is opaque: shadow rays are blocked by whatever they meet, transmission or not (rt_shadow_ray
 * in render/illumination.c and its caller attenuate nothing). So any shape that fills a cell can cover it.
 *
 * Exact: every object is tested by its own hit function; lists hold more than needed rather than less
 * (build.c). A ray from behind a cover meets it, so it is tested first; should it miss by rounding, the ray
 * is passed on. So that a cover covers need not be proved. Passed on are also rays that are not exactly what
 * a shadow ray is: from inside the domain, dir = light - origin, tmax at most 1. */
#include "accel/light/light.h"
#include "accel/light/side.h"

#include <string.h>

/* ---- what a query remembers ---- */

static size_t scratch_bytes(const RtAccel *accel) {
    const RtLightBuffer *self = (const RtLightBuffer *)accel;
    return self->cache ? (1 + rt_light_cell_count(self)) * sizeof(RtLightMemory) : 0;
}

static void begin(const RtAccel *accel, void *scratch) {
    RtLightMemory *memory = scratch;
    if (!((const RtLightBuffer *)accel)->cache) return;
    if (++memory->epoch == 0) {
        memset(memory, 0, scratch_bytes(accel));
        memory->epoch = 1;
    }
}

/* ---- queries ---- */

/* True when the search is over. */
RT_KERNEL bool try_object(const RtLightBuffer *self, uint32_t id, const RtPreparedRay *ray, RtHit *hit,
                          RtTally *tally) {
    const RtGeometry *g = &self->base.scene->geometry;
    float enter;
    RT_COUNT(tally, steps, 1);
    if (self->extents) {
        RT_COUNT(tally, extent_tests, 1);
        if (!rt_box_hit(&g->boxes[id], ray, ray->tmax, &enter)) return false;
        if (rt_light_is_flat(g, id)) {
            RT_COUNT(tally, extent_tests, 1);
            if (!rt_light_is_between(g, id, ray)) return false;
        }
    }
    return rt_test_object(g, id, ray, true, hit, tally);
}

/* Is it a ray that the lists are made for? */
RT_KERNEL bool is_to_light(const RtLightBuffer *self, const RtRay *ray) {
    const RtScene *scene = self->base.scene;
    if (ray->source >= scene->light_count || ray->tmax > 1) return false;
    RtVec3 dir = rt_sub(scene->lights[ray->source].position, ray->org);
    return ray->dir.x == dir.x && ray->dir.y == dir.y && ray->dir.z == dir.z &&
           rt_box_contains(self->domain, (RtBox){ray->org, ray->org});
}

/* The cell of a ray, and its depth, rounded up. */
RT_KERNEL size_t find_cell(const RtLightBuffer *self, const RtRay *ray, float *depth) {
    int axis = rt_major_axis(ray->dir), face = 2 * axis + (ray->dir.at[axis] < 0);
    double length = fabs((double)ray->dir.at[axis]);
    uint32_t column = rt_light_column(self, -(double)ray->dir.at[(axis + 1) % 3] / length);
    uint32_t row = rt_light_column(self, -(double)ray->dir.at[(axis + 2) % 3] / length);
    *depth = rt_float_above(length * (1 + 0x1p-22));
    return rt_light_face(self, ray->source, face) + (size_t)row * self->n + column;
}

/* The blocker among the objects of a cell, the remembered one first. */
RT_KERNEL uint32_t search_cell(const RtLightBuffer *self, RtLightMemory *memory, size_t cell, float depth,
                               const RtPreparedRay *ray, RtTally *tally) {
    RtHit hit = RT_MISS;
    uint32_t tried = UINT32_MAX, light = ray->original->source;
    if (self->cache && memory[1 + cell].epoch == memory->epoch) {
        RtLightEntry entry = self->entries[memory[1 + cell].entry];
        if (entry.depth <= depth) {
            tried = memory[1 + cell].entry;
            if (try_object(self, entry.id, ray, &hit, tally)) return entry.id;
        }
    }
    for (uint32_t i = self->near_first[light]; i < self->near_first[light + 1]; i++) {
        if (try_object(self, self->near[i], ray, &hit, tally)) return self->near[i];
    }
    for (uint32_t i = self->first[cell]; i < self->first[cell + 1]; i++) {
        RtLightEntry entry = self->entries[i];
        if (entry.depth > depth) break;
        if (i == tried || !try_object(self, entry.id, ray, &hit, tally)) continue;
        if (self->cache) memory[1 + cell] = (RtLightMemory){memory->epoch, i};
        return entry.id;
    }
    return RT_NO_OBJECT;
}

RT_KERNEL uint32_t shade(const RtLightBuffer *self, const RtScratch *scratch, const RtRay *ray,
                         RtTally *tallies) {
    RtTally *tally = tallies ? &tallies[RT_RAY_SHADOW] : NULL;
    if (!is_to_light(self, ray)) return rt_pass_on_occluded(&self->base, scratch, ray, tallies);

    RtPreparedRay prepared;
    rt_hit_ray(&prepared, &self->base.scene->geometry, ray, scratch->room);
    float depth;
    size_t cell = find_cell(self, ray, &depth);
    if (self->covers && depth > self->covers[cell].depth) {
        RtHit hit = RT_MISS;
        uint32_t id = self->covers[cell].id;
        if (try_object(self, id, &prepared, &hit, tally)) return rt_answer_occluded(id, tally);
        return rt_pass_on_occluded(&self->base, scratch, ray, tallies);
    }
    return rt_answer_occluded(search_cell(self, scratch->own, cell, depth, &prepared, tally), tally);
}

RT_DEFINE_SHADOW_KERNELS(RtLightBuffer, shade)

const RtAccelOps rt_light_ops = {
    .name = "light",
    .summary = "overlay: a cube of cells around each light, with the objects seen in each cell by depth",
    .paper = "Haines & Greenberg 1986, The Light Buffer: A Shadow-Testing Accelerator, CG&A 6(9)",
    RT_PARAMS_OF(rt_light_params),
    .kinds = 1u << RT_RAY_SHADOW,
    .build = rt_light_build,
    .destroy = rt_light_destroy,
    RT_KERNEL_OPS,
    .scratch_bytes = scratch_bytes,
    .begin = begin,
    .describe = rt_light_describe,
    .validate = rt_light_validate,
};
