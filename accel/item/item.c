/* SPDX-License-Identifier: Apache-2.0 */
/* item: the item buffer of Weghorst, Hooper & Greenberg 1984, an overlay for primary rays.
 *
 * Each sample of the image knows which object its ray meets first, found once by projecting all objects
 * (build.c). A ray through a sample tests that one object; where the sample sees nothing, none.
 *
 * Exact: the object's own hit function says whether and where it is hit, and a hit counts only if it is
 * nearer than any other object can be. A sample that is undecided, an object that is missed where others may
 * be behind it, and rays that are not bit for bit those of the samples are passed on. */
#include "accel/item/item.h"
#include "accel/kernel.h"

/* Is it the ray of its sample? */
RT_KERNEL bool is_of_sample(const RtItemBuffer *self, const RtRay *ray) {
    uint32_t columns = self->view.sampling.columns;
    if (ray->source >= rt_item_sample_count(self)) return false;
    RtRay own = rt_view_ray(&self->view, ray->source % columns, ray->source / columns);
    bool same = ray->tmin == own.tmin && ray->tmax == own.tmax;
    for (int a = 0; a < 3; a++) same &= ray->org.at[a] == own.org.at[a] && ray->dir.at[a] == own.dir.at[a];
    return same;
}

RT_KERNEL RtHit see(const RtItemBuffer *self, const RtScratch *scratch, const RtRay *ray, RtTally *tallies) {
    RtTally *tally = tallies ? &tallies[RT_RAY_PRIMARY] : NULL;
    const RtGeometry *g = &self->base.scene->geometry;
    if (!is_of_sample(self, ray)) return rt_pass_on_nearest(&self->base, scratch, ray, tallies);

    RtItemSample sample = self->samples[ray->source];
    RtHit hit = RT_MISS;
    RT_COUNT(tally, steps, 1);
    if (sample.id == RT_NO_OBJECT) return rt_answer_nearest(hit, tally);
    if (sample.id != RT_ITEM_UNDECIDED) {
        RtPreparedRay prepared;
        rt_hit_ray(&prepared, g, ray, scratch->room);
        rt_test_object(g, sample.id, &prepared, false, &hit, tally);
        if (hit.object == RT_NO_OBJECT ? sample.other == INFINITY : hit.t < sample.other) {
            return rt_answer_nearest(hit, tally);
        }
    }
    return rt_pass_on_nearest(&self->base, scratch, ray, tallies);
}

RT_DEFINE_PRIMARY_KERNELS(RtItemBuffer, see)

const RtAccelOps rt_item_ops = {
    .name = "item",
    .summary =
        "overlay: the object that is seen at each sample of the image, found by projecting all objects",
    .paper = "Weghorst, Hooper & Greenberg 1984, Improved Computational Methods for Ray Tracing, TOG 3(1)",
    RT_PARAMS_OF(rt_item_params),
    .kinds = 1u << RT_RAY_PRIMARY,
    .build = rt_item_build,
    .destroy = rt_item_destroy,
    RT_KERNEL_OPS,
    .describe = rt_item_describe,
    .validate = rt_item_validate,
};
