/* SPDX-License-Identifier: Apache-2.0 */
/* What a light buffer looks like, and whether its invariants hold. */
#include "accel/light/light.h"

#include "base/memory.h"

static size_t cells_of(const RtLightCube *cube) {
    return (size_t)cube->tile_count * RT_LIGHT_TILE_CELLS;
}

/* Cells are counted as far as they are in a grid: tiles may be wider. */
void rt_light_describe(const RtAccel *accel, RtDescription *out) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    *out = (RtDescription){RT_NO_PREDICTION};
    for (uint32_t light = 0; light < accel->scene->light_count; light++) {
        const RtLightCube *cube = &buffer->cubes[light];
        out->bytes += sizeof *cube + cube->near_count * sizeof(uint32_t);
        out->references += cube->near_count;
        if (!cube->serves) continue;
        uint32_t entries = cube->first[cells_of(cube)];
        out->references += entries;
        out->bytes += (cells_of(cube) + 1) * sizeof(uint32_t) + entries * sizeof(RtLightEntry);
        for (int face = 0; face < 6; face++) {
            const RtLightGrid *grid = &cube->grids[face];
            out->leaves += (uint64_t)grid->columns * grid->rows;
            for (uint32_t row = 0; row < grid->rows; row++) {
                for (uint32_t column = 0; column < grid->columns; column++) {
                    uint32_t cell = rt_light_cell(grid, column, row);
                    out->empty_leaves += cube->first[cell] == cube->first[cell + 1];
                }
            }
        }
    }
}

/* ---- validate ---- */

static uint32_t depth_of(uint32_t key) {
    return key >> 16;
}

static RtStatus check_order(const RtLightCube *cube, uint32_t light, uint32_t objects, RtError *error) {
    for (size_t cell = 0; cell < cells_of(cube); cell++) {
        if (cube->first[cell] > cube->first[cell + 1]) {
            return rt_fail(error, RT_MISMATCH, "light: list %zu of light %u ends before it begins", cell,
                           light);
        }
        for (uint32_t i = cube->first[cell]; i < cube->first[cell + 1]; i++) {
            const RtLightEntry *entry = &cube->entries[i];
            bool last = i + 1 == cube->first[cell + 1], good = !(entry->key & (RT_LIGHT_DEEP | RT_LIGHT_BOXED));
            if (entry->object == RT_LIGHT_BEYOND) {
                good = good && last && !(entry->key & 0xffff);
            } else {
                good = good && rt_ref_index(entry->object) < objects;
            }
            if (good && !last) good = depth_of(entry->key) <= depth_of(entry[1].key);
            if (good) continue;
            return rt_fail(error, RT_MISMATCH, "light: list %zu of light %u is not in order", cell, light);
        }
    }
    return RT_OK;
}

/* May the object be in the cell? Then *depth is the least it may have there. As for the lists, of which not
 * one may have less. */
static bool is_seen(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id,
                    const RtLightFootprint *at, uint32_t column, uint32_t row, float *depth) {
    RtShape shape = rt_ref_shape(buffer->base.scene->geometry.objects[id]);
    *depth = at->near;
    if (shape != RT_SHAPE_TRIANGLE && shape != RT_SHAPE_POLYGON)
        return rt_light_touches(buffer, light, face, id, column, row);
    RtLightOutline outline;
    rt_light_outline(buffer, light, face, id, at, column, row, &outline);
    for (uint32_t i = 0; i < outline.count; i++) {
        const float *line = outline.parts[i];
        /* Beyond what lists allow for rounding. */
        if ((line[0] + line[1]) * 0.5f + line[2] < 0x1p-5f) return false;
    }
    float slope = (outline.slope[0] + outline.slope[1]) * 0.5f + outline.slope[2];
    *depth = rt_maxf(*depth, 1 / rt_maxf(slope, 1 / at->far));
    *depth *= 1 + 0x1p-18f;
    return true;
}

static RtStatus check_object(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id,
                             RtError *error) {
    const RtLightCube *cube = &buffer->cubes[light];
    const RtLightGrid *grid = &cube->grids[face];
    RtLightFootprint at;
    if (!rt_light_footprint(buffer, light, face, id, &at)) return RT_OK;
    for (uint32_t row = at.lo[1]; row <= at.hi[1]; row++) {
        for (uint32_t column = at.lo[0]; column <= at.hi[0]; column++) {
            uint32_t cell = rt_light_cell(grid, column, row), i = cube->first[cell];
            float near;
            if (!is_seen(buffer, light, face, id, &at, column, row, &near)) continue;
            uint32_t depth = rt_light_depth_key(grid, near);
            for (; i < cube->first[cell + 1] && depth_of(cube->entries[i].key) <= depth; i++) {
                RtRef object = cube->entries[i].object;
                if (object == buffer->base.scene->geometry.objects[id] || object == RT_LIGHT_BEYOND) break;
            }
            if (i < cube->first[cell + 1] && depth_of(cube->entries[i].key) <= depth) continue;
            return rt_fail(error, RT_MISMATCH,
                           "light: the list of cell %u,%u of face %d of light %u lacks object %u at depth %g",
                           column, row, face, light, id, (double)near);
        }
    }
    return RT_OK;
}

static RtStatus check_near(const RtLightBuffer *buffer, uint32_t light, RtError *error) {
    const RtLightCube *cube = &buffer->cubes[light];
    uint32_t at = 0;
    for (uint32_t id = 0; id < buffer->base.scene->geometry.object_count; id++) {
        if (!rt_light_is_near(buffer, light, id)) continue;
        if (at < cube->near_count && cube->near[at++] == id) continue;
        at = UINT32_MAX;
        break;
    }
    if (at == cube->near_count) return RT_OK;
    return rt_fail(error, RT_MISMATCH,
                   "light: the near list of light %u does not hold the objects that touch it", light);
}

RtStatus rt_light_validate(const RtAccel *accel, RtError *error) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    uint32_t objects = accel->scene->geometry.object_count;
    for (uint32_t light = 0; light < accel->scene->light_count; light++) {
        RT_TRY(check_near(buffer, light, error));
        if (!buffer->cubes[light].serves) continue;
        RT_TRY(check_order(&buffer->cubes[light], light, objects, error));
        for (uint32_t id = 0; id < objects; id++) {
            if (rt_light_is_near(buffer, light, id)) continue;
            for (int face = 0; face < 6; face++) RT_TRY(check_object(buffer, light, face, id, error));
        }
    }
    return RT_OK;
}
