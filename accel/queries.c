/* SPDX-License-Identifier: Apache-2.0 */
/* Queries of a stack of accelerators: their scratch memory, and streams of rays. */
#include "accel/accel.h"

#include "core/base/memory.h"

/* Closes the layers above `end`. */
static void close_layers(const RtQuery *query, const RtAccel *end) {
    const RtScratch *scratch = query->scratch;
    for (const RtAccel *layer = query->accel; layer != end; layer = layer->below, scratch++) {
        if (layer->ops->close) layer->ops->close(layer, scratch->own);
    }
}

/* Bytes of the scratch memory of a layer: whole cache lines. */
static size_t scratch_stride(const RtAccel *layer) {
    return (layer->scratch_bytes + RT_CACHE_LINE - 1) / RT_CACHE_LINE * RT_CACHE_LINE;
}

/* On failure nothing is left of the query. */
static RtStatus open_layers(RtQuery *query, RtError *error) {
    const RtScratch *scratch = query->scratch;
    for (const RtAccel *layer = query->accel; layer; layer = layer->below, scratch++) {
        RtStatus status = layer->ops->open ? layer->ops->open(layer, scratch->own, error) : RT_OK;
        if (status == RT_OK) continue;
        close_layers(query, layer);
        query->accel = NULL;
        rt_query_clear(query);
        return status;
    }
    return RT_OK;
}

RtStatus rt_query_init(RtQuery *query, const RtAccel *accel, RtError *error) {
    RtScratch scratch = {NULL, NULL};
    size_t bytes = 0;
    *query = (RtQuery){0};
    RT_TRY(rt_crossings_alloc(&accel->scene->geometry, &scratch.crossings, error));
    for (const RtAccel *layer = accel; layer; layer = layer->below) bytes += scratch_stride(layer);
    if (bytes > 0 && !(scratch.own = rt_alloc(bytes, 1))) {
        rt_free(scratch.crossings);
        return rt_fail_memory(error, "the scratch memory of a query", bytes);
    }
    query->accel = accel;
    uint32_t layers = 0;
    for (const RtAccel *layer = accel; layer; layer = layer->below) {
        query->scratch[layers++] = scratch;
        if (scratch.own) scratch.own = (char *)scratch.own + scratch_stride(layer);
    }
    RT_TRY(open_layers(query, error));
    if (bytes > 0) rt_query_begin(query);
    return RT_OK;
}

void rt_query_clear(RtQuery *query) {
    close_layers(query, NULL);
    rt_free(query->scratch[0].own);
    rt_free(query->scratch[0].crossings);
    *query = (RtQuery){0};
}

void rt_query_begin(RtQuery *query) {
    const RtScratch *scratch = query->scratch;
    for (const RtAccel *layer = query->accel; layer; layer = layer->below, scratch++) {
        if (layer->ops->begin) layer->ops->begin(layer, scratch->own);
    }
}

void rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies) {
    const RtAccelOps *ops = query->accel->ops;
    if (tallies)
        ops->nearest_counted(query->accel, query->scratch, rays, count, hits, tallies);
    else
        ops->nearest(query->accel, query->scratch, rays, count, hits);
}

void rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies) {
    enum { STREAM = 1024 };
    const RtAccelOps *ops = query->accel->ops;
    uint32_t occluders[STREAM];
    for (size_t first = 0; first < count; first += STREAM) {
        size_t n = count - first < STREAM ? count - first : STREAM;
        if (tallies)
            ops->occluded_counted(query->accel, query->scratch, rays + first, n, occluders, tallies);
        else
            ops->occluded(query->accel, query->scratch, rays + first, n, occluders);
        for (size_t i = 0; i < n; i++) blocked[first + i] = occluders[i] != RT_NO_OBJECT;
    }
}
