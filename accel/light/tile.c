/* SPDX-License-Identifier: Apache-2.0 */
/* The lists of a light, tile by tile on all threads. In a tile, first the corners of cells are covered by what
 * lies on them, as in a shadow map; a cell whose four corners are covered is taken to be covered, a little
 * beyond the deepest of them. Then objects are drawn: each becomes a candidate of the cells that it may be
 * seen in and that are not covered before it. Candidates are sorted by cell, depth and object.
 *
 * What is behind a hole between corners is passed on: what covers a cell is a guess, that lists were cut is
 * not (light.h). */
#include "accel/light/light.h"

#include "base/memory.h"
#include "base/parallel.h"

#include <stdlib.h>
#include <string.h>

/* What one thread has made. */
typedef struct Worker {
    RtLightDesk desk;
    RtLightEntry *sorted; /* [sorted_capacity]: the candidates of a tile */
    uint32_t sorted_capacity;
    RtLightEntry *entries; /* of all tiles of this thread */
    uint32_t count, capacity;
} Worker;

/* Where the lists of a tile are until they have their place. */
typedef struct Made {
    uint32_t first, count;
    int thread;
    uint32_t place; /* of the first among all */
} Made;

typedef struct Drawing {
    RtLightBuffer *buffer;
    uint32_t light, most; /* entries of a tile */
    const RtLightBins *bins;
    Worker *workers;
    Made *made; /* [tiles] */
} Drawing;

/* ---- drawing ---- */

static RtLightTile tile_at(const RtLightBuffer *buffer, uint32_t light, uint32_t tile) {
    const RtLightCube *cube = &buffer->cubes[light];
    int face = 5;
    while (cube->grids[face].columns == 0 || cube->grids[face].first_tile > tile) face--;
    const RtLightGrid *grid = &cube->grids[face];
    tile -= grid->first_tile;
    return (RtLightTile){buffer, light, face, tile % grid->across * RT_LIGHT_TILE,
                         tile / grid->across * RT_LIGHT_TILE};
}

static bool is_flat(RtRef object) {
    return rt_ref_shape(object) == RT_SHAPE_TRIANGLE || rt_ref_shape(object) == RT_SHAPE_POLYGON;
}

/* The part of a footprint in a tile, `more` cells wider above. */
static void cut_to_tile(const RtLightFootprint *at, const RtLightTile *tile, uint32_t more, uint32_t lo[2],
                        uint32_t hi[2]) {
    for (int k = 0; k < 2; k++) {
        uint32_t from = k ? tile->row : tile->column, end = from + RT_LIGHT_TILE - 1 + more;
        lo[k] = at->lo[k] > from ? at->lo[k] : from;
        hi[k] = at->hi[k] + more < end ? at->hi[k] + more : end;
    }
}

static void cover_round(const RtLightTile *tile, uint32_t id, const RtLightFootprint *at, RtLightDesk *desk) {
    uint32_t lo[2], hi[2];
    cut_to_tile(at, tile, 1, lo, hi);
    for (uint32_t row = lo[1]; row <= hi[1]; row++) {
        for (uint32_t column = lo[0]; column <= hi[0]; column++) {
            float depth, *corner = &desk->corner[row - tile->row][column - tile->column];
            if (!rt_light_covers(tile->buffer, tile->light, tile->face, id, column, row, &depth)) continue;
            *corner = rt_minf(depth, *corner);
        }
    }
}

/* Objects with curves by what their cells say of each. */
static void draw_round(const RtLightTile *tile, uint32_t id, RtRef object, const RtLightFootprint *at,
                       RtLightDesk *desk) {
    uint32_t lo[2], hi[2], cells = 0, before = desk->count;
    const RtLightOutline nothing = {.slope = {0, 0, INFINITY}};
    cut_to_tile(at, tile, 0, lo, hi);
    tile->buffer->kernels->draw_outline(&nothing, at, tile, object, desk);
    if (desk->count == before) return;
    for (uint32_t i = before; i < desk->count; i++) {
        uint32_t cell = desk->cell[i];
        if (!rt_light_touches(tile->buffer, tile->light, tile->face, id, tile->column + cell % RT_LIGHT_TILE,
                              tile->row + cell / RT_LIGHT_TILE)) {
            continue;
        }
        desk->cell[before + cells] = cell;
        desk->key[before + cells++] = desk->key[i];
    }
    desk->count = before + cells;
    desk->runs[desk->run_count - 1].key = cells;
}

static RtStatus make_room(RtLightDesk *desk, uint32_t cells, RtError *error) {
    uint64_t needed = desk->count + (uint64_t)cells;
    RT_TRY(rt_reserve(&desk->cell, &desk->cell_capacity, needed, sizeof(uint32_t), error));
    RT_TRY(rt_reserve(&desk->key, &desk->key_capacity, needed, sizeof(uint32_t), error));
    return rt_reserve(&desk->runs, &desk->run_capacity, desk->run_count + UINT64_C(16), sizeof(RtLightEntry),
                      error);
}

static RtStatus take_large(const RtLightTile *tile, RtRef object, bool cover, RtLightDesk *desk,
                           RtError *error) {
    const RtLightBuffer *buffer = tile->buffer;
    uint32_t id = rt_light_id_of(&buffer->base.scene->geometry, object);
    RtLightFootprint at;
    RtLightOutline outline;
    if (!rt_light_footprint(buffer, tile->light, tile->face, id, &at)) return RT_OK;
    if (!cover) RT_TRY(make_room(desk, RT_LIGHT_TILE_CELLS + 16, error));
    if (is_flat(object)) {
        rt_light_outline(buffer, tile->light, tile->face, id, &at, tile->column, tile->row, &outline);
        if (cover) {
            buffer->kernels->cover_outline(&outline, &at, tile, desk);
        } else {
            buffer->kernels->draw_outline(&outline, &at, tile, object, desk);
        }
    } else if (cover) {
        cover_round(tile, id, &at, desk);
    } else {
        draw_round(tile, id, object, &at, desk);
    }
    return RT_OK;
}

/* Covers the tile's corners with all its objects, or draws them. */
static RtStatus go_over(const RtLightTile *tile, const uint32_t *objects, uint32_t count, bool cover,
                        RtLightDesk *desk, RtError *error) {
    const RtLightKernels *kernels = tile->buffer->kernels;
    uint32_t small[16], waiting = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (objects[i] & RT_LIGHT_LARGE_BIT) {
            RT_TRY(take_large(tile, objects[i] & ~RT_LIGHT_LARGE_BIT, cover, desk, error));
        } else {
            small[waiting++] = rt_ref_index(objects[i]);
        }
        if (waiting < 16 && i + 1 < count) continue;
        if (!cover) RT_TRY(make_room(desk, 16 * RT_LIGHT_SMALL_ROOM, error));
        if (waiting > 0) (cover ? kernels->cover : kernels->draw)(tile, small, waiting, desk);
        waiting = 0;
    }
    return RT_OK;
}

/* From corners to cells. */
static void cover_cells(RtLightDesk *desk) {
    for (int row = 0; row < RT_LIGHT_TILE; row++) {
        for (int column = 0; column < RT_LIGHT_TILE; column++) {
            const float *a = &desk->corner[row][column], *b = &desk->corner[row + 1][column];
            float least = rt_minf(rt_minf(a[0], a[1]), rt_minf(b[0], b[1]));
            float most = rt_maxf(rt_maxf(a[0], a[1]), rt_maxf(b[0], b[1]));
            desk->cover[row][column] = most < INFINITY ? most + 0.5f * (most - least) : INFINITY;
        }
    }
}

/* ---- lists ---- */

static int compare_entries(const void *a, const void *b) {
    const RtLightEntry *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return x->object < y->object ? -1 : x->object > y->object;
}

static void sort_list(RtLightEntry *list, uint32_t count) {
    if (count > 24) {
        qsort(list, count, sizeof *list, compare_entries);
        return;
    }
    for (uint32_t i = 1; i < count; i++) {
        RtLightEntry entry = list[i];
        uint32_t at = i;
        for (; at > 0 && compare_entries(&entry, &list[at - 1]) < 0; at--) list[at] = list[at - 1];
        list[at] = entry;
    }
}

/* Candidates by cell to worker->sorted; end[i + 1] becomes the end of the list of cell i, end[0] 0. */
static RtStatus sort_candidates(Worker *worker, uint32_t end[RT_LIGHT_TILE_CELLS + 2], RtError *error) {
    const RtLightDesk *desk = &worker->desk;
    RT_TRY(rt_reserve(&worker->sorted, &worker->sorted_capacity, desk->count, sizeof(RtLightEntry), error));
    memset(end, 0, (RT_LIGHT_TILE_CELLS + 2) * sizeof *end);
    for (uint32_t i = 0; i < desk->count; i++) end[desk->cell[i] + 2]++;
    for (uint32_t i = 2; i < RT_LIGHT_TILE_CELLS + 2; i++) end[i] += end[i - 1];
    for (uint32_t run = 0, i = 0; run < desk->run_count; run++) {
        for (uint32_t last = i + desk->runs[run].key; i < last; i++) {
            worker->sorted[end[desk->cell[i] + 1]++] = (RtLightEntry){desk->key[i], desk->runs[run].object};
        }
    }
    for (uint32_t i = 0; i < RT_LIGHT_TILE_CELLS; i++)
        sort_list(worker->sorted + end[i], end[i + 1] - end[i]);
    return RT_OK;
}

static uint32_t depth_bits(uint32_t key) {
    return key & 0x7fff0000u;
}

/* How long a tile's lists may be for it to have at most `most` entries. */
static uint32_t longest_that_fits(const uint32_t *end, uint32_t longest, uint32_t most) {
    for (; longest > 1; longest /= 2) {
        uint64_t sum = 0;
        for (uint32_t i = 0; i < RT_LIGHT_TILE_CELLS; i++) {
            uint32_t length = end[i + 1] - end[i];
            sum += (uint64_t)(length < longest ? length : longest) + 1;
        }
        if (sum <= most) break;
    }
    return longest;
}

/* The lists to worker->entries; lengths of lists to lengths[0..RT_LIGHT_TILE_CELLS). */
static RtStatus keep_lists(const Drawing *d, const RtLightGrid *grid, Worker *worker, const uint32_t *end,
                           uint32_t *lengths, RtError *error) {
    const RtLightDesk *desk = &worker->desk;
    uint32_t longest = longest_that_fits(end, d->buffer->longest, d->most);
    RT_TRY(rt_reserve(&worker->entries, &worker->capacity,
                      worker->count + (uint64_t)desk->count + RT_LIGHT_TILE_CELLS, sizeof(RtLightEntry), error));
    for (uint32_t i = 0; i < RT_LIGHT_TILE_CELLS; i++) {
        const RtLightEntry *list = worker->sorted + end[i];
        uint32_t count = end[i + 1] - end[i], kept = count < longest ? count : longest;
        uint32_t row = i / RT_LIGHT_TILE, column = i % RT_LIGHT_TILE;
        bool cut = desk->cut[row] >> column & 1;
        uint32_t beyond = cut ? rt_light_depth_key(grid, desk->cover[row][column]) << 16 : 0;
        if (kept < count) beyond = depth_bits(list[kept].key), cut = true;
        if (kept > 0) memcpy(worker->entries + worker->count, list, kept * sizeof *list);
        worker->count += kept;
        if (cut) worker->entries[worker->count++] = (RtLightEntry){beyond, RT_LIGHT_BEYOND};
        lengths[i] = kept + cut;
    }
    return RT_OK;
}

static RtStatus make_tile(void *context, size_t item, int thread, RtError *error) {
    Drawing *d = context;
    RtLightCube *cube = &d->buffer->cubes[d->light];
    Worker *worker = &d->workers[thread];
    RtLightDesk *desk = &worker->desk;
    uint32_t first = d->bins->first[item], count = d->bins->first[item + 1] - first;
    const uint32_t *objects = d->bins->objects + first;
    uint32_t end[RT_LIGHT_TILE_CELLS + 2], *lengths = cube->first + item * RT_LIGHT_TILE_CELLS;
    d->made[item] = (Made){worker->count, 0, thread, 0};
    if (count == 0) return RT_OK;
    const RtLightTile tile = tile_at(d->buffer, d->light, (uint32_t)item);
    desk->count = desk->run_count = 0;
    memset(desk->cut, 0, sizeof desk->cut);
    for (size_t row = 0; row < sizeof desk->corner / sizeof desk->corner[0]; row++) {
        for (size_t i = 0; i < sizeof desk->corner[0] / sizeof(float); i++) desk->corner[row][i] = INFINITY;
    }
    if (d->buffer->full_occlusion) RT_TRY(go_over(&tile, objects, count, true, desk, error));
    cover_cells(desk);
    RT_TRY(go_over(&tile, objects, count, false, desk, error));
    RT_TRY(sort_candidates(worker, end, error));
    RT_TRY(keep_lists(d, &cube->grids[tile.face], worker, end, lengths, error));
    d->made[item].count = worker->count - d->made[item].first;
    return RT_OK;
}

/* ---- all tiles ---- */

/* Lengths of lists become where they begin. */
static RtStatus move_tile(void *context, size_t item, int thread, RtError *error) {
    (void)thread, (void)error;
    const Drawing *d = context;
    RtLightCube *cube = &d->buffer->cubes[d->light];
    const Made *made = &d->made[item];
    uint32_t *first = cube->first + item * RT_LIGHT_TILE_CELLS, sum = made->place;
    for (uint32_t i = 0; i < RT_LIGHT_TILE_CELLS; i++) {
        uint32_t length = first[i];
        first[i] = sum;
        sum += length;
    }
    if (made->count == 0) return RT_OK;
    memcpy(cube->entries + made->place, d->workers[made->thread].entries + made->first,
           made->count * sizeof(RtLightEntry));
    return RT_OK;
}

/* Gives tiles their places; how many entries there are. */
static uint32_t place_tiles(Drawing *d) {
    uint32_t sum = 0;
    for (uint32_t tile = 0; tile < d->buffer->cubes[d->light].tile_count; tile++) {
        d->made[tile].place = sum;
        sum += d->made[tile].count;
    }
    return sum;
}

static RtStatus make_all(Drawing *d, int threads, RtError *error) {
    RtLightCube *cube = &d->buffer->cubes[d->light];
    size_t cells = (size_t)cube->tile_count * RT_LIGHT_TILE_CELLS;
    cube->first = rt_alloc(cells + 1, sizeof(uint32_t));
    if (!cube->first) return rt_fail_memory(error, "the cells of a light buffer", cells * sizeof(uint32_t));
    RT_TRY(rt_parallel_for(cube->tile_count, threads, make_tile, d, error));
    uint32_t sum = place_tiles(d);
    cube->first[cells] = sum;
    cube->entries = rt_alloc_unset(sum, sizeof(RtLightEntry));
    if (!cube->entries)
        return rt_fail_memory(error, "the lists of a light buffer", sum * sizeof(RtLightEntry));
    return rt_parallel_for(cube->tile_count, threads, move_tile, d, error);
}

RtStatus rt_light_make_lists(RtLightBuffer *buffer, uint32_t light, const RtLightBins *bins, uint32_t most,
                             int threads, RtError *error) {
    int count = rt_thread_count(threads);
    Drawing d = {buffer, light, most, bins, NULL, NULL};
    d.workers = rt_alloc((size_t)count, sizeof(Worker));
    d.made = rt_alloc(buffer->cubes[light].tile_count, sizeof(Made));
    RtStatus status = d.workers && d.made ? make_all(&d, threads, error)
                                          : rt_fail_memory(error, "a light buffer", sizeof(Worker));
    for (int i = 0; d.workers && i < count; i++) {
        RtLightDesk *desk = &d.workers[i].desk;
        rt_free(desk->cell);
        rt_free(desk->key);
        rt_free(desk->runs);
        rt_free(d.workers[i].sorted);
        rt_free(d.workers[i].entries);
    }
    rt_free(d.workers);
    rt_free(d.made);
    return status;
}
