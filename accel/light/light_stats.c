/* SPDX-License-Identifier: Apache-2.0 */
/* Describing and validating a light buffer. */
#include "accel/light/light.h"

#include "core/base/memory.h"

bool rt_light_find_cell(const RtAccel *accel, const RtRay *ray, RtCellView *cell) {
    const RtLightCube *cube = &((const RtLightBuffer *)accel)->cubes[ray->source];
    int z = rt_major_axis(ray->dir);
    bool down = ray->dir.at[z] < 0; /* as the ray comes to the light: it is seen from there along +z */
    const RtLightGrid *grid = &cube->grids[2 * z + down];
    if (!cube->serves || grid->columns == 0) return false;
    float depth = fabsf(ray->dir.at[z]);
    float u = (-ray->dir.at[(z + 1) % 3] / depth - grid->u) * grid->scale;
    float w = (-ray->dir.at[(z + 2) % 3] / depth - grid->w) * grid->scale;
    if (!(u >= 0 && w >= 0 && u < (float)grid->columns && w < (float)grid->rows)) return false;
    uint32_t column = (uint32_t)u, row = (uint32_t)w;
    uint32_t tile = cube->tiles[grid->first_tile + row * grid->columns + column],
             n = rt_light_resolution(tile);
    uint32_t x = (uint32_t)((u - (float)column) * (float)n), y = (uint32_t)((w - (float)row) * (float)n);
    cell->number =
        grid->first_cell + rt_light_first_cell(tile) + (y < n ? y : n - 1) * n + (x < n ? x : n - 1);
    uint32_t first = cube->first[cell->number], end = cube->first[cell->number + 1];
    cell->cut = end > first && cube->entries[end - 1].object == RT_LIGHT_BEYOND;
    cell->length = end - first - cell->cut;
    cell->object =
        cell->length == 0 ? RT_NO_OBJECT : rt_raster_id(&accel->scene->geometry, cube->entries[first].object);
    return true;
}

uint64_t rt_light_bytes(const RtLightCube *cube) {
    uint64_t bytes = sizeof *cube + cube->near_count * sizeof(uint32_t);
    if (!cube->serves) return bytes;
    return bytes + (cube->cell_count + (size_t)1 + cube->tile_count) * sizeof(uint32_t) +
           cube->first[cube->cell_count] * sizeof(RtLightEntry);
}

void rt_light_describe(const RtAccel *accel, RtDescription *out) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    *out = (RtDescription){RT_NO_PREDICTION};
    for (uint32_t light = 0; light < accel->scene->light_count; light++) {
        const RtLightCube *cube = &buffer->cubes[light];
        out->bytes += rt_light_bytes(cube);
        out->references += cube->near_count;
        if (!cube->serves) continue;
        out->leaves += cube->cell_count;
        out->references += cube->first[cube->cell_count];
        for (uint32_t i = 0; i < cube->cell_count; i++)
            out->empty_leaves += cube->first[i] == cube->first[i + 1];
    }
}

/* ---- validate ---- */

static uint32_t depth_of(uint32_t key) {
    return key >> 16;
}

static RtStatus check_order(const RtLightCube *cube, uint32_t light, uint32_t objects, RtError *error) {
    for (uint32_t cell = 0; cell < cube->cell_count; cell++) {
        if (cube->first[cell] > cube->first[cell + 1])
            return rt_fail(error, RT_MISMATCH, "light: list %u of light %u ends before it begins", cell,
                           light);
        for (uint32_t i = cube->first[cell]; i < cube->first[cell + 1]; i++) {
            const RtLightEntry *entry = &cube->entries[i];
            bool last = i + 1 == cube->first[cell + 1], good = depth_of(entry->key) < RT_LIGHT_DEPTHS;
            if (entry->object == RT_LIGHT_BEYOND)
                good = good && last && (entry->key & RT_LIGHT_PARTS) == RT_LIGHT_PARTS;
            else
                good = good && rt_ref_index(entry->object) < objects;
            if (good && !last) good = depth_of(entry->key) <= depth_of(entry[1].key);
            if (good) continue;
            return rt_fail(error, RT_MISMATCH, "light: list %u of light %u is not in order", cell, light);
        }
    }
    return RT_OK;
}

/* By how much objects may be said to be nearer to cells, in cells, than lists say: both err on the safe side,
 * lists by less. */
static float tolerance(const RtLightTile *tile, const RtLightFootprint *at) {
    double cells = (double)tile->on.grid->scale * tile->n;
    return (float)(0x1p-5 + 8 * tile->on.cube->margin * cells / (double)at->near);
}

/* The least depth that the lists may have for an object in a cell: they, too, allow for rounding. */
static float least_depth(const RtLightFootprint *at, const RtLightOutline *outline, uint32_t column,
                         uint32_t row) {
    float x = (float)column + 0.5f, y = (float)row + 0.5f;
    const float *slope = outline->slope;
    float rounding = fabsf(slope[0] * x) + fabsf(slope[1] * y) + fabsf(slope[2]);
    float least = slope[0] * x + slope[1] * y + slope[2] - 0x1p-19f * rounding;
    return rt_maxf(at->near, 1 / rt_maxf(least, 1 / at->far)) * (1 + 0x1p-18f);
}

/* Is the object in the list of a cell, in these parts of it and not deeper than that, or was the list cut
 * before? */
static bool is_listed(const RtLightCube *cube, uint32_t cell, RtRef object, uint32_t parts, uint32_t depth) {
    for (uint32_t i = cube->first[cell]; i < cube->first[cell + 1]; i++) {
        const RtLightEntry *entry = &cube->entries[i];
        if (depth_of(entry->key) > depth) return false;
        if (entry->object == object || entry->object == RT_LIGHT_BEYOND) return (entry->key & parts) == parts;
    }
    return false;
}

/* The parts of a cell that a flat object is certainly seen in; of another, none are certain. */
static uint32_t parts_seen(const RtLightCells *at, const RtLightOutline *outline, float tolerated,
                           uint32_t column, uint32_t row) {
    uint32_t parts = 0;
    for (uint32_t i = 0; i < RT_LIGHT_PART * RT_LIGHT_PART; i++) {
        uint32_t x = column * RT_LIGHT_PART + i % RT_LIGHT_PART, y = row * RT_LIGHT_PART + i / RT_LIGHT_PART;
        bool seen = (int32_t)x > at->part_lo[0] && (int32_t)x < at->part_hi[0] &&
                    (int32_t)y > at->part_lo[1] && (int32_t)y < at->part_hi[1];
        for (uint32_t k = 0; seen && k < outline->count; k++) {
            const float *line = outline->parts[k];
            float on = line[0] * ((float)x + 0.5f) + line[1] * ((float)y + 0.5f);
            seen = on / RT_LIGHT_PART + line[2] - RT_LIGHT_NARROWER >= tolerated;
        }
        parts |= (uint32_t)seen << i;
    }
    return parts;
}

static RtStatus check_tile(const RtLightTile *tile, uint32_t id, const RtLightFootprint *from,
                           RtError *error) {
    const RtLightCube *cube = tile->on.cube;
    const RtLightGrid *grid = tile->on.grid;
    const RtLightCells at = rt_light_cells(tile, from);
    RtRef object = tile->on.geometry->objects[id];
    RtLightOutline outline;
    bool flat = rt_light_is_flat(object);
    if (flat) rt_light_outline(tile, id, from, &outline);
    uint32_t number = grid->first_tile + tile->row * grid->columns + tile->column;
    uint32_t first = grid->first_cell + rt_light_first_cell(cube->tiles[number]);
    for (uint32_t row = (uint32_t)at.lo[1]; (int32_t)row <= at.hi[1]; row++) {
        for (uint32_t column = (uint32_t)at.lo[0]; (int32_t)column <= at.hi[0]; column++) {
            float near = flat ? least_depth(from, &outline, column, row) : from->near;
            uint32_t cell = first + row * tile->n + column, depth = rt_light_depth_key(grid, near);
            uint32_t parts = flat ? parts_seen(&at, &outline, tolerance(tile, from), column, row) : 0;
            if (flat ? parts == 0 : !rt_light_touches(tile, id, column, row)) continue;
            if (is_listed(cube, cell, object, parts, depth)) continue;
            return rt_fail(
                error, RT_MISMATCH,
                "light: the list of cell %u,%u of tile %u,%u of face %d of light %u lacks object %u "
                "at depth %g",
                column, row, tile->column, tile->row, tile->on.face,
                (uint32_t)(cube - tile->on.buffer->cubes), id, (double)near);
        }
    }
    return RT_OK;
}

static RtStatus check_object(const RtLightFace *on, uint32_t id, RtError *error) {
    const RtLightGrid *grid = on->grid;
    RtLightFootprint at;
    if (!rt_light_footprint(on, id, &at)) return RT_OK;
    for (uint32_t row = at.lo[1]; row <= at.hi[1]; row++) {
        for (uint32_t column = at.lo[0]; column <= at.hi[0]; column++) {
            uint32_t tile = on->cube->tiles[grid->first_tile + row * grid->columns + column];
            RT_TRY(check_tile(&(RtLightTile){*on, column, row, rt_light_resolution(tile)}, id, &at, error));
        }
    }
    return RT_OK;
}

static RtStatus check_near(const RtLightFace *on, uint32_t light, RtError *error) {
    uint32_t at = 0;
    for (uint32_t id = 0; id < on->geometry->object_count; id++) {
        if (!rt_light_is_near(on, id)) continue;
        if (at < on->cube->near_count && on->cube->near[at++] == id) continue;
        at = UINT32_MAX;
        break;
    }
    if (at == on->cube->near_count) return RT_OK;
    return rt_fail(error, RT_MISMATCH,
                   "light: the near list of light %u does not hold the objects that touch it", light);
}

RtStatus rt_light_validate(const RtAccel *accel, RtError *error) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    uint32_t objects = accel->scene->geometry.object_count;
    for (uint32_t light = 0; light < accel->scene->light_count; light++) {
        if (!buffer->cubes[light].serves) continue;
        RtLightFace faces[6];
        for (int face = 0; face < 6; face++) faces[face] = rt_light_face(buffer, light, face);
        RT_TRY(check_near(&faces[0], light, error));
        RT_TRY(check_order(faces[0].cube, light, objects, error));
        for (uint32_t id = 0; id < objects; id++) {
            for (int face = 0; face < 6 && !rt_light_is_near(&faces[0], id); face++)
                RT_TRY(check_object(&faces[face], id, error));
        }
    }
    return RT_OK;
}
