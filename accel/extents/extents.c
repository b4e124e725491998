/* SPDX-License-Identifier: Apache-2.0 */
/* extents: one extent per object and no hierarchy. Every ray is tested against every extent, and against the
 * object only where it meets the extent (Weghorst, Hooper & Greenberg 1984: the cost is b B + i I).
 *
 * With lanes=16, the default, many boxes are tested at once (extents_kernels.c), as `brute` tests objects.
 * With lanes=1, and for every other kind of extent, it is one after the other. A test compares the counts.
 *
 * Exact for every kind: see accel/extent.h. */
#include "accel/extents/extents.h"

/* ---- tracing ---- */

RT_KERNEL void scan(RtExtentKind kind, const RtExtents *self, const RtPreparedRay *ray, bool any, RtHit *best,
                    RtTally *tally) {
    const RtGeometry *geometry = &self->base.scene->geometry;
    const RtExtentSet *set = &self->set;
    RtLine line = rt_line(set, kind, geometry, ray);
    float enter;
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        RT_COUNT(tally, steps, 1);
        RT_COUNT(tally, extent_tests, 1);
        const RtBox *own = &geometry->boxes[id];
        RT_OBSERVE(tally, .kind = RT_TRACED_STEP, .what = "extent", .index = id);
        bool met = rt_extent_hit(set, kind, id, own, ray, &line, rt_limit(ray, best), &enter);
        RT_OBSERVE(tally, .kind = RT_TRACED_EXTENT_TEST, .what = "extent", .index = id, .box = own,
                   .ball = rt_extent_ball(set, kind, id), .met = met);
        if (!met) continue;
        if (rt_test_object(geometry, id, ray, any, best, tally)) return;
    }
}

RT_KERNEL void search(const RtExtents *self, void *scratch, const RtPreparedRay *ray, bool any, RtHit *best,
                      RtTally *tally) {
    (void)scratch;
    RT_BY_EXTENT_KIND(self->set.kind, scan, self, ray, any, best, tally);
}

RT_DEFINE_KERNELS(RtExtents, search)

/* ---- building ---- */

#define PARAMS(X)                                                                                            \
    X(PARAM_KIND, "kind", RT_CHOICE("box", RT_EXTENT_KINDS),                                                 \
      "the extent of an object: axis-aligned box, sphere, oriented box, or k slabs", "the cheapest test")    \
    X(PARAM_SLABS, "slabs", RT_INT("7", 3, RT_MAX_SLABS, "3|5|7|13"),                                        \
      "plane sets of kind=slabs: 3 axes, 4 diagonals of a cube, 6 of its faces, in this order",              \
      "Kay & Kajiya 1986")                                                                                   \
    X(PARAM_LANES, RT_LANES_PARAM("kind=box: boxes"))

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

static RtGroup group_of(const RtGeometry *geometry, const uint32_t *id) {
    return (RtGroup){geometry, id, 1, geometry->boxes[*id]};
}

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    const RtGeometry *geometry = &what->scene->geometry;
    const uint32_t count = geometry->object_count;
    const RtValue *values = what->values;
    RtExtents *self = (RtExtents *)accel;
    RtExtentKind kind = (RtExtentKind)values[PARAM_KIND].choice;
    if (kind == RT_EXTENT_BOX && rt_has_lanes(values[PARAM_LANES]))
        rt_isa_use(accel, RT_KERNELS_FOR(extents, rt_isa_best()));
    RT_TRY(
        rt_extent_set_init(&self->set, &accel->memory, kind, (uint32_t)values[PARAM_SLABS].i, count, error));
    for (uint32_t id = 0; id < count; id++) {
        RtGroup group = group_of(geometry, &id);
        rt_extent_fit(&self->set, id, &group);
    }
    return RT_OK;
}

/* ---- looking at it ---- */

/* A line that meets a convex body meets a convex part of it with a probability of the ratio of their
 * surfaces: the sum over all extents is the expected number of object tests (too many where an extent sticks
 * out). */
static void describe(const RtAccel *accel, RtDescription *out) {
    const RtExtents *self = (const RtExtents *)accel;
    uint32_t count = accel->scene->geometry.object_count;
    double sum = 0, whole = rt_box_half_area(accel->scene->geometry.box);
    for (uint32_t id = 0; id < count; id++)
        sum += rt_extent_half_area(&self->set, id, &accel->scene->geometry.boxes[id]);
    *out = (RtDescription){.references = count,
                           .bytes = rt_extent_set_bytes(&self->set),
                           .predicted_steps = count,
                           RT_NO_QUALITY};
    out->predicted_tests = count == 0 ? 0 : whole > 0 ? sum / whole : (double)NAN;
    out->predicted_cost = out->predicted_tests;
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtExtents *self = (const RtExtents *)accel;
    for (uint32_t id = 0; id < accel->scene->geometry.object_count; id++) {
        RtGroup group = group_of(&accel->scene->geometry, &id);
        RT_TRY(rt_extent_check(&self->set, id, &group, "extents", error));
    }
    return RT_OK;
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    const RtGeometry *geometry = &accel->scene->geometry;
    const RtExtentSet *set = &((const RtExtents *)accel)->set;
    for (uint32_t id = 0; id < geometry->object_count; id++)
        viewer.show(viewer.context, &(RtBoxView){&geometry->boxes[id], 0, true, set, id, .objects = 1});
}

const RtAccelOps rt_extents_ops = {
    .name = "extents",
    .summary = "tests every object's extent, and the object only if its extent is hit: no hierarchy",
    .paper = "Weghorst, Hooper & Greenberg 1984, Improved Computational Methods for Ray Tracing, TOG 3(1)",
    RT_PARAMS_OF(params),
    .bytes = sizeof(RtExtents),
    .build = build,
    .kernels = &kernels,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
};
