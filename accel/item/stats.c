/* SPDX-License-Identifier: Apache-2.0 */
/* What an item buffer looks like, and whether its invariants hold. */
#include "accel/item/item.h"

#include "base/memory.h"

/* Validating asks hit functions at most about this often. */
#define MOST_TESTS (UINT64_C(1) << 24)

void rt_item_describe(const RtAccel *accel, RtDescription *out) {
    const RtItemBuffer *buffer = (const RtItemBuffer *)accel;
    size_t samples = rt_item_sample_count(buffer);
    *out = (RtDescription){.leaves = samples, .bytes = samples * sizeof(RtItemSample), RT_NO_PREDICTION};
    for (size_t i = 0; i < samples; i++) {
        out->empty_leaves += buffer->samples[i].id == RT_NO_OBJECT;
        out->references += buffer->samples[i].id < RT_ITEM_UNDECIDED;
    }
}

/* No object but the sample's own is nearer than it says. */
static RtStatus check_other(const RtItemBuffer *buffer, uint32_t column, uint32_t row, RtCrossing *room,
                            RtError *error) {
    const RtGeometry *g = &buffer->base.scene->geometry;
    RtRay ray = rt_view_ray(&buffer->view, column, row);
    RtItemSample sample = buffer->samples[ray.source];
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, g, &ray, room);
    float own = INFINITY, t;
    if (sample.id < g->object_count && !rt_object_hit(g, sample.id, &prepared, &own, NULL)) own = INFINITY;
    for (uint32_t id = 0; id < g->object_count; id++) {
        if (id == sample.id || !rt_object_hit(g, id, &prepared, &t, NULL)) continue;
        if (t >= sample.other || (t == own && id > sample.id)) continue;
        return rt_fail(
            error, RT_MISMATCH,
            "item: the ray of sample %u,%u meets object %u at %g, where no other than %d is said to "
            "be before %g",
            column, row, id, (double)t, (int)sample.id, (double)sample.other);
    }
    return RT_OK;
}

RtStatus rt_item_validate(const RtAccel *accel, RtError *error) {
    const RtItemBuffer *buffer = (const RtItemBuffer *)accel;
    uint32_t columns = buffer->view.sampling.columns, objects = accel->scene->geometry.object_count;
    size_t samples = rt_item_sample_count(buffer);
    for (size_t i = 0; i < samples; i++) {
        RtItemSample s = buffer->samples[i];
        if (s.id == RT_ITEM_UNDECIDED || s.id < objects || (s.id == RT_NO_OBJECT && s.other == INFINITY)) {
            continue;
        }
        return rt_fail(error, RT_MISMATCH, "item: sample %u,%u names object %u, where others are from %g on",
                       (uint32_t)(i % columns), (uint32_t)(i / columns), s.id, (double)s.other);
    }
    uint64_t every = (uint64_t)samples * objects / MOST_TESTS + 1;
    RtCrossing *room;
    RT_TRY(rt_hit_room(&accel->scene->geometry, &room, error));
    RtStatus status = RT_OK;
    for (size_t i = 0; i < samples && status == RT_OK; i += every) {
        status = check_other(buffer, (uint32_t)(i % columns), (uint32_t)(i / columns), room, error);
    }
    rt_free(room);
    return status;
}
