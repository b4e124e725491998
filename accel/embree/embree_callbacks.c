/* SPDX-License-Identifier: Apache-2.0 */
/* Embree's callbacks for user geometry. A callback gets a primitive and a packet of N rays, and tests the
 * rays whose `valid` is not zero. */
#include "accel/embree/embree.h"
#include "accel/kernel.h"

void rt_embree_bounds(const struct RTCBoundsFunctionArguments *arguments) {
    const RtEmbreeSlot *slot = arguments->geometryUserPtr;
    const RtBox *box = &slot->self->base.scene->geometry.boxes[slot->ids[arguments->primID]];
    double growth = (double)slot->self->growth;
    *arguments->bounds_o = (struct RTCBounds){
        .lower_x = rt_float_below((double)box->lo.x - growth),
        .lower_y = rt_float_below((double)box->lo.y - growth),
        .lower_z = rt_float_below((double)box->lo.z - growth),
        .upper_x = rt_float_above((double)box->hi.x + growth),
        .upper_y = rt_float_above((double)box->hi.y + growth),
        .upper_z = rt_float_above((double)box->hi.z + growth),
    };
}

/* ---- user mode: our rays and hits; only tfar of Embree's ray is updated ---- */

RT_KERNEL void search_lanes(const RtEmbreeSlot *slot, const void *context, uint32_t primitive,
                            const int *valid, RtEmbreeWord *rays, unsigned lanes, bool any, bool counted) {
    const RtGeometry *geometry = &slot->self->base.scene->geometry;
    const RtEmbreeTrace *trace = context;
    uint32_t id = slot->ids[primitive];
    for (unsigned i = 0; i < lanes; i++) {
        if (!valid[i]) continue;
        RtEmbreeSearch *search = &trace->searches[rt_embree_word(rays, lanes, RT_EMBREE_ID, i)->u];
        float *tfar = &rt_embree_word(rays, lanes, RT_EMBREE_TFAR, i)->f;
        bool over =
            rt_test_object(geometry, id, &search->ray, any, &search->best, counted ? search->tally : NULL);
        if (over)
            *tfar = -INFINITY;
        else if (search->best.object == id)
            *tfar = rt_embree_limit(search->best.t, search->shrink);
    }
}

#define DEFINE_SEARCHES(suffix, counted)                                                                     \
    static void intersect_##suffix(const struct RTCIntersectFunctionNArguments *a) {                         \
        search_lanes(a->geometryUserPtr, a->context, a->primID, a->valid, (RtEmbreeWord *)a->rayhit, a->N,   \
                     false, counted);                                                                        \
    }                                                                                                        \
    static void occluded_##suffix(const struct RTCOccludedFunctionNArguments *a) {                           \
        search_lanes(a->geometryUserPtr, a->context, a->primID, a->valid, (RtEmbreeWord *)a->ray, a->N,      \
                     true, counted);                                                                         \
    }
DEFINE_SEARCHES(timed, false)
DEFINE_SEARCHES(counted, true)
#undef DEFINE_SEARCHES

void rt_embree_trace_init(RtEmbreeTrace *trace, bool coherent, bool counted, RtEmbreeSearch *searches,
                          RtCrossing *crossings) {
    rt_embree_init_context(&trace->context, coherent);
    trace->intersect = counted ? intersect_counted : intersect_timed;
    trace->occluded = counted ? occluded_counted : occluded_timed;
    trace->searches = searches;
    trace->crossings = crossings;
}

void rt_embree_user_intersect(const struct RTCIntersectFunctionNArguments *arguments) {
    ((const RtEmbreeTrace *)(const void *)arguments->context)->intersect(arguments);
}

void rt_embree_user_occluded(const struct RTCOccludedFunctionNArguments *arguments) {
    ((const RtEmbreeTrace *)(const void *)arguments->context)->occluded(arguments);
}

/* ---- native mode: Embree's rays, for shapes that Embree lacks ---- */

static bool lane_hit(const RtGeometry *geometry, uint32_t id, const void *context, RtEmbreeWord *rays,
                     unsigned lanes, unsigned i, float *t) {
    const RtEmbreeTrace *trace = context;
    RtRay ray = {.tmin = rt_embree_word(rays, lanes, RT_EMBREE_TNEAR, i)->f,
                 .tmax = rt_embree_word(rays, lanes, RT_EMBREE_TFAR, i)->f};
    for (unsigned a = 0; a < 3; a++) {
        ray.org.at[a] = rt_embree_word(rays, lanes, RT_EMBREE_ORG + a, i)->f;
        ray.dir.at[a] = rt_embree_word(rays, lanes, RT_EMBREE_DIR + a, i)->f;
    }
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, geometry, &ray, trace->crossings);
    return rt_object_hit(geometry, id, &prepared, t, NULL);
}

/* Sets tfar of the lanes that hit: to t, or with `any` to -inf. Without `any`, `instance` is also written as
 * part of the hit. */
RT_KERNEL void test_lanes(const RtEmbreeSlot *slot, const void *context, uint32_t geometry,
                          uint32_t primitive, const int *valid, RtEmbreeWord *rays, unsigned lanes, bool any,
                          uint32_t instance) {
    for (unsigned i = 0; i < lanes; i++) {
        float t;
        if (!valid[i]) continue;
        if (!lane_hit(&slot->self->base.scene->geometry, slot->ids[primitive], context, rays, lanes, i, &t))
            continue;
        rt_embree_word(rays, lanes, RT_EMBREE_TFAR, i)->f = any ? -INFINITY : t;
        if (any) continue;
        for (unsigned field = RT_EMBREE_NG; field <= RT_EMBREE_V; field++)
            rt_embree_word(rays, lanes, field, i)->f = 0;
        rt_embree_word(rays, lanes, RT_EMBREE_PRIMITIVE, i)->u = primitive;
        rt_embree_word(rays, lanes, RT_EMBREE_GEOMETRY, i)->u = geometry;
        rt_embree_word(rays, lanes, RT_EMBREE_INSTANCE, i)->u = instance;
    }
}

void rt_embree_native_intersect(const struct RTCIntersectFunctionNArguments *a) {
    test_lanes(a->geometryUserPtr, a->context, a->geomID, a->primID, a->valid, (RtEmbreeWord *)a->rayhit,
               a->N, false, a->context->instID[0]);
}

void rt_embree_native_occluded(const struct RTCOccludedFunctionNArguments *a) {
    test_lanes(a->geometryUserPtr, a->context, a->geomID, a->primID, a->valid, (RtEmbreeWord *)a->ray, a->N,
               true, 0);
}
