/* SPDX-License-Identifier: Apache-2.0 */
/* Describing and validating a light buffer. */
#include "accel/light/light.h"

#include "accel/raster/raster.h"

bool rt_light_find_cell(const RtAccel *accel, const RtRay *ray, RtCellView *out) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    const int face = rt_light_face_of(ray->dir);
    const RtLightGrid *grids = buffer->cubes[ray->source].grids, *grid = &grids[face];
    uint32_t cell;
    if (!buffer->serves || !rt_light_cell_of(grid, face, ray->dir, &cell)) return false;
    const RtLightEntry *list = grid->entries + grid->first[cell];
    out->number = cell;
    for (int before = 0; before < face; before++) out->number += grids[before].columns * grids[before].rows;
    out->length = grid->first[cell + 1] - grid->first[cell];
    out->cut = out->length > 0 && list[out->length - 1].object == RT_LIGHT_BEYOND;
    out->length -= out->cut;
    out->object = out->length > 0 ? rt_raster_id(&accel->scene->geometry, list[0].object) : RT_NO_OBJECT;
    return true;
}

uint64_t rt_light_bytes(const RtLightBuffer *buffer) {
    RtDescription description;
    rt_light_describe(&buffer->isa.base, &description);
    return description.bytes;
}

void rt_light_describe(const RtAccel *accel, RtDescription *out) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    *out = (RtDescription){RT_NO_PREDICTION};
    out->bytes = accel->scene->light_count * sizeof(RtLightCube);
    if (!buffer->serves) return;
    for (uint32_t i = 0; i < 6 * accel->scene->light_count; i++) {
        const RtLightGrid *grid = &buffer->cubes[i / 6].grids[i % 6];
        uint32_t cells = grid->columns * grid->rows;
        if (cells == 0) continue;
        out->leaves += cells;
        out->references += grid->first[cells];
        for (uint32_t cell = 0; cell < cells; cell++)
            out->empty_leaves += grid->first[cell] == grid->first[cell + 1];
        out->bytes += (cells + (size_t)1) * sizeof(uint32_t) + grid->first[cells] * sizeof(RtLightEntry);
    }
}

/* ---- validate ---- */

static RtStatus check_order(const RtLightFace *on, uint32_t light, RtError *error) {
    const RtLightGrid *grid = on->grid;
    for (uint32_t cell = 0; cell < grid->columns * grid->rows; cell++) {
        const uint32_t first = grid->first[cell], end = grid->first[cell + 1];
        if (first > end)
            return rt_fail(error, RT_MISMATCH, "light: list %u of face %d of light %u ends before it begins",
                           cell, on->face, light);
        for (uint32_t i = first; i < end; i++) {
            const RtLightEntry *entry = &grid->entries[i];
            bool last = i + 1 == end, good = entry->depth >= 0;
            if (entry->object == RT_LIGHT_BEYOND)
                good = good && last;
            else
                good = good && rt_raster_id(on->geometry, entry->object) < on->geometry->object_count;
            if (good && (last || entry->depth <= entry[1].depth)) continue;
            return rt_fail(error, RT_MISMATCH, "light: list %u of face %d of light %u is not in order", cell,
                           on->face, light);
        }
    }
    return RT_OK;
}

/* Is the object in the list of a cell, not deeper than that, or was the list cut before? */
static bool is_listed(const RtLightGrid *grid, uint32_t cell, RtRef object, float depth) {
    for (uint32_t i = grid->first[cell]; i < grid->first[cell + 1]; i++) {
        const RtLightEntry *entry = &grid->entries[i];
        if (entry->depth > depth) return false;
        if (entry->object == object || entry->object == RT_LIGHT_BEYOND) return true;
    }
    return false;
}

static RtStatus check_object(const RtLightFace *on, uint32_t light, uint32_t id, RtError *error) {
    RtLightFootprint footprint;
    RtLightDepths depths;
    if (!rt_light_project(on, id, &footprint)) return RT_OK;
    for (uint32_t row = footprint.lo[1]; row <= footprint.hi[1]; row++) {
        for (uint32_t column = footprint.lo[0]; column <= footprint.hi[0]; column++) {
            const uint32_t cell = row * on->grid->columns + column;
            if (!rt_light_see(&footprint, column, row, &depths)) continue;
            if (is_listed(on->grid, cell, on->geometry->objects[id], depths.near)) continue;
            return rt_fail(error, RT_MISMATCH,
                           "light: the list of cell %u,%u of face %d of light %u lacks object %u at depth %g",
                           column, row, on->face, light, id, (double)depths.near);
        }
    }
    return RT_OK;
}

RtStatus rt_light_validate(const RtAccel *accel, RtError *error) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    if (!buffer->serves) return RT_OK;
    for (uint32_t i = 0; i < 6 * accel->scene->light_count; i++) {
        const RtLightFace on = rt_light_face(buffer, i / 6, (int)(i % 6));
        RT_TRY(check_order(&on, i / 6, error));
        for (uint32_t id = 0; id < on.geometry->object_count; id++)
            RT_TRY(check_object(&on, i / 6, id, error));
    }
    return RT_OK;
}
