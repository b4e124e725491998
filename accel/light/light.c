/* light: the light buffer of Haines & Greenberg 1986, an overlay for shadow rays.
 *
 * A ray to a light lies in one cell of the cube around it, and can be blocked by the objects in the list of
 * that cell alone, and of these by none that is deeper than the ray's origin. A cell may have a cover, an
 * object that hides whatever is behind it: lists end there.
 *
 * Exact: every object is tested by its own hit function; lists hold more than needed rather than less
 * (build.c). A ray from behind a cover meets it, so it is tested first; should it miss by rounding, the ray
 * is passed on. So that a cover covers need not be proved. Passed on are also rays that are not exactly what
 * a shadow ray is: from inside the domain, dir = light - origin, tmax at most 1. */
#include "accel/light/light.h"
#include "accel/kernel.h"

/* True when the search is over. */
RT_KERNEL bool try_object(const RtLightBuffer *self, uint32_t id, const RtPreparedRay *ray, RtHit *hit,
                          RtTally *tally) {
    const RtGeometry *g = &self->base.scene->geometry;
    float enter;
    RT_COUNT(tally, steps, 1);
    if (self->extents) {
        RT_COUNT(tally, extent_tests, 1);
        if (!rt_box_hit(&g->boxes[id], ray, ray->tmax, &enter)) return false;
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

RT_KERNEL uint32_t shade(const RtLightBuffer *self, void *scratch, const RtRay *ray, RtTally *tallies) {
    RtTally *tally = tallies ? &tallies[RT_RAY_SHADOW] : NULL;
    if (!is_to_light(self, ray)) return rt_pass_on_occluded(&self->base, scratch, ray, tallies);

    RtPreparedRay prepared = rt_ray_prepare(ray, &self->base.scene->geometry.box);
    RtHit hit = RT_MISS;
    float depth;
    size_t cell = find_cell(self, ray, &depth);
    if (self->covers && depth > self->covers[cell].depth) {
        uint32_t id = self->covers[cell].id;
        if (try_object(self, id, &prepared, &hit, tally)) return rt_answer_occluded(id, tally);
        return rt_pass_on_occluded(&self->base, scratch, ray, tallies);
    }
    for (uint32_t i = self->near_first[ray->source]; i < self->near_first[ray->source + 1]; i++) {
        uint32_t id = self->near[i];
        if (try_object(self, id, &prepared, &hit, tally)) return rt_answer_occluded(id, tally);
    }
    for (uint32_t i = self->first[cell]; i < self->first[cell + 1]; i++) {
        RtLightEntry entry = self->entries[i];
        if (entry.depth > depth) break;
        if (try_object(self, entry.id, &prepared, &hit, tally)) return rt_answer_occluded(entry.id, tally);
    }
    return rt_answer_occluded(RT_NO_OBJECT, tally);
}

RT_DEFINE_SHADOW_KERNELS(RtLightBuffer, shade)

const RtAccelOps rt_light_ops = {
    .name = "light",
    .summary = "overlay: a cube of cells around each light, with the objects seen in each cell by depth",
    .paper = "Haines & Greenberg 1986, The Light Buffer: A Shadow-Testing Accelerator, CG&A 6(9)",
    .params = rt_light_params,
    .param_count = RT_LIGHT_PARAM_COUNT,
    .kinds = 1u << RT_RAY_SHADOW,
    .build = rt_light_build,
    .destroy = rt_light_destroy,
    RT_KERNEL_OPS,
    .describe = rt_light_describe,
    .validate = rt_light_validate,
};
