/* SPDX-License-Identifier: Apache-2.0 */
/* Describing and validating an item buffer. */
#include "accel/item/item.h"

#include "core/base/memory.h"

/* Validating asks hit functions at most about this often. */
#define MOST_TESTS (UINT64_C(1) << 24)

bool rt_item_find_cell(const RtAccel *accel, const RtRay *ray, RtCellView *cell) {
    uint32_t named = ((const RtItemBuffer *)accel)->samples[ray->source];
    bool undecided = named == RT_ITEM_UNDECIDED;
    *cell = (RtCellView){ray->source, named < RT_ITEM_UNDECIDED, undecided ? RT_UNNAMED_OBJECT : named,
                         undecided};
    return true;
}

void rt_item_describe(const RtAccel *accel, RtDescription *out) {
    const RtItemBuffer *buffer = (const RtItemBuffer *)accel;
    size_t samples = rt_item_sample_count(buffer);
    size_t terms = (size_t)buffer->view.sampling.columns + buffer->view.sampling.rows;
    *out = (RtDescription){.leaves = samples,
                           .bytes = samples * sizeof(uint32_t) + terms * sizeof(RtItemTerm),
                           RT_NO_PREDICTION};
    for (size_t i = 0; i < samples; i++) {
        out->empty_leaves += buffer->samples[i] == RT_NO_OBJECT;
        out->references += buffer->samples[i] < RT_ITEM_UNDECIDED;
    }
}

/* No object but the sample's own is hit before it, if that is hit at all. */
static RtStatus check_sample(const RtItemBuffer *buffer, uint32_t column, uint32_t row, RtCrossing *crossings,
                             RtError *error) {
    const RtGeometry *g = rt_item_geometry(buffer);
    RtRay ray = rt_view_ray(&buffer->view, column, row);
    uint32_t named = buffer->samples[ray.source];
    RtPreparedRay prepared;
    float own = INFINITY, t;
    if (named == RT_ITEM_UNDECIDED) return RT_OK;
    rt_hit_ray(&prepared, g, &ray, crossings);
    if (named != RT_NO_OBJECT && !rt_object_hit(g, named, &prepared, &own, NULL)) return RT_OK;
    for (uint32_t id = 0; id < g->object_count; id++) {
        if (id == named || !rt_object_hit(g, id, &prepared, &t, NULL)) continue;
        if (t > own || (t == own && id > named)) continue;
        return rt_fail(
            error, RT_MISMATCH,
            "item: the ray of sample %u,%u hits object %u at %g, but the sample names object %d, at %g",
            column, row, id, (double)t, (int)named, (double)own);
    }
    return RT_OK;
}

RtStatus rt_item_validate(const RtAccel *accel, RtError *error) {
    const RtItemBuffer *buffer = (const RtItemBuffer *)accel;
    uint32_t columns = buffer->view.sampling.columns, objects = accel->scene->geometry.object_count;
    size_t samples = rt_item_sample_count(buffer);
    for (size_t i = 0; i < samples; i++) {
        uint32_t named = buffer->samples[i];
        if (named >= RT_ITEM_UNDECIDED || named < objects) continue;
        return rt_fail(error, RT_MISMATCH, "item: sample %u,%u names object %u, but there are only %u",
                       (uint32_t)(i % columns), (uint32_t)(i / columns), named, objects);
    }
    uint64_t every = (uint64_t)samples * objects / MOST_TESTS + 1;
    RtCrossing *crossings;
    RT_TRY(rt_crossings_alloc(&accel->scene->geometry, &crossings, error));
    RtStatus status = RT_OK;
    for (size_t i = 0; i < samples && status == RT_OK; i += every)
        status = check_sample(buffer, (uint32_t)(i % columns), (uint32_t)(i / columns), crossings, error);
    rt_free(crossings);
    return status;
}
