/* SPDX-License-Identifier: Apache-2.0 */
/* What a light buffer looks like, and whether its invariants hold. */
#include "accel/light/light.h"

#include "base/memory.h"

void rt_light_describe(const RtAccel *accel, RtDescription *out) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    uint32_t lights = accel->scene->light_count;
    size_t cells = rt_light_cell_count(buffer);
    uint64_t references = (uint64_t)buffer->first[cells] + buffer->near_first[lights], empty = 0;
    for (size_t i = 0; i < cells; i++) empty += buffer->first[i] == buffer->first[i + 1];
    *out = (RtDescription){
        .leaves = cells,
        .empty_leaves = empty,
        .references = references,
        .bytes = (cells + 1) * sizeof(uint32_t) + buffer->first[cells] * sizeof(RtLightEntry) +
                 (buffer->covers ? cells * sizeof(RtLightCover) : 0) + lights * sizeof(double) +
                 (lights + (size_t)1 + buffer->near_first[lights]) * sizeof(uint32_t),
        RT_NO_PREDICTION,
    };
}

/* The lists of a face hold, in order, what belongs to them; `cursor` [n * n] starts where each list does. */
static RtStatus check_face(const RtLightBuffer *buffer, uint32_t light, int face, RtLightEntry *order,
                           uint32_t *cursor, RtError *error) {
    size_t first_cell = rt_light_face(buffer, light, face), in_face = (size_t)buffer->n * buffer->n;
    for (size_t i = 0; i < in_face; i++) cursor[i] = buffer->first[first_cell + i];
    uint32_t count = rt_light_order(buffer, light, face, order);
    for (uint32_t i = 0; i < count; i++) {
        RtLightEntry entry = order[i];
        RtLightFootprint at;
        rt_light_footprint(buffer, light, face, entry.id, &at);
        for (uint32_t row = at.lo[1]; row <= at.hi[1]; row++) {
            for (uint32_t column = at.lo[0]; column <= at.hi[0]; column++) {
                size_t in = (size_t)row * buffer->n + column, cell = first_cell + in;
                if (buffer->covers && entry.depth > buffer->covers[cell].depth) continue;
                if (!rt_light_touches(buffer, light, face, entry.id, column, row)) continue;
                const RtLightEntry *found = &buffer->entries[cursor[in]];
                if (cursor[in] < buffer->first[cell + 1] && found->id == entry.id &&
                    found->depth == entry.depth) {
                    cursor[in]++;
                    continue;
                }
                return rt_fail(
                    error, RT_MISMATCH,
                    "light: the list of cell %u,%u of face %d of light %u lacks object %u at depth %g, "
                    "or is not in order",
                    column, row, face, light, entry.id, (double)entry.depth);
            }
        }
    }
    return RT_OK;
}

static RtStatus check_covers(const RtLightBuffer *buffer, uint32_t light, int face, RtError *error) {
    size_t first_cell = rt_light_face(buffer, light, face), in_face = (size_t)buffer->n * buffer->n;
    for (size_t i = 0; buffer->covers && i < in_face; i++) {
        const RtLightCover *cover = &buffer->covers[first_cell + i];
        uint32_t column = (uint32_t)(i % buffer->n), row = (uint32_t)(i / buffer->n);
        float depth = 0;
        if (cover->id == RT_NO_OBJECT
                ? cover->depth == INFINITY
                : cover->id < buffer->base.scene->geometry.object_count &&
                      rt_light_covers(buffer, light, face, cover->id, column, row, &depth) &&
                      depth == cover->depth) {
            continue;
        }
        return rt_fail(error, RT_MISMATCH,
                       "light: cell %u,%u of face %d of light %u is not covered by object %u", column, row,
                       face, light, cover->id);
    }
    return RT_OK;
}

static RtStatus check_near(const RtLightBuffer *buffer, RtError *error) {
    uint32_t at = 0;
    for (uint32_t light = 0; light < buffer->base.scene->light_count; light++) {
        bool good = buffer->near_first[light] == at;
        for (uint32_t id = 0; good && id < buffer->base.scene->geometry.object_count; id++) {
            if (!rt_light_is_near(buffer, light, id)) continue;
            good = at < buffer->near_first[light + 1] && buffer->near[at++] == id;
        }
        if (good && buffer->near_first[light + 1] == at) continue;
        return rt_fail(error, RT_MISMATCH,
                       "light: the near list of light %u does not hold the objects that touch it", light);
    }
    return RT_OK;
}

RtStatus rt_light_validate(const RtAccel *accel, RtError *error) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    size_t cells = rt_light_cell_count(buffer), in_face = (size_t)buffer->n * buffer->n;
    for (size_t i = 0; i < cells; i++) {
        if (buffer->first[i] <= buffer->first[i + 1]) continue;
        return rt_fail(error, RT_MISMATCH, "light: list %zu ends before it begins", i);
    }
    RT_TRY(check_near(buffer, error));
    RtLightEntry *order = rt_alloc(accel->scene->geometry.object_count, sizeof *order);
    uint32_t *cursor = rt_alloc(in_face, sizeof *cursor);
    RtStatus status = order && cursor ? RT_OK : rt_fail_memory(error, "validating", in_face * sizeof *cursor);
    for (uint32_t light = 0; status == RT_OK && light < accel->scene->light_count; light++) {
        for (int face = 0; status == RT_OK && face < 6; face++) {
            status = check_covers(buffer, light, face, error);
            if (status == RT_OK) status = check_face(buffer, light, face, order, cursor, error);
        }
    }
    rt_free(order);
    rt_free(cursor);
    return status;
}
