/* SPDX-License-Identifier: Apache-2.0 */
/* The lists of a light, tile by tile on all threads. In a tile, first the corners of cells are covered by
 * what lies on them, as in a shadow map; a cell whose four corners are covered is taken to be covered, a
 * little beyond the deepest of them. Then objects are drawn: each becomes a candidate of the cells that it
 * may be seen in and that are not covered before it. Candidates are sorted by cell, depth and object.
 *
 * What is behind a hole between corners is passed on: what covers a cell is a guess, that lists were cut is
 * not (light.h). */
#include "accel/light/light.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <stdlib.h>
#include <string.h>

/* What one thread has made. */
typedef struct Worker {
    RtLightDesk desk;
    uint32_t end[RT_LIGHT_TILE_CELLS + 2]; /* of lists in `sorted` */
    RtLightEntry *sorted;                  /* [sorted_capacity]: the candidates of a tile */
    uint32_t sorted_capacity;
    /* The lists of all tiles of a light, in blocks that stay where they are: to move what has become too
     * large takes longer than to draw it. The next light writes over them. */
    struct Block {
        RtLightEntry *entries;
        uint32_t room;
    } * blocks;
    uint32_t block_count, block_capacity, blocks_used;
    RtLightEntry *next; /* in the last block used, in which there is room for */
    uint32_t room;
    uint16_t *lengths; /* of the lists of all their cells */
    uint32_t cell_count, cell_capacity;
} Worker;

/* Where the lists of a tile are until they have their place; then their place. */
typedef struct Made {
    const RtLightEntry *entries;
    uint32_t count, first_cell, n;
    int thread;
    uint32_t place, cell_place;
} Made;

typedef struct Drawing {
    RtLightBuffer *buffer;
    uint32_t light, most; /* entries of a tile */
    const RtLightBins *bins;
    Worker *workers;
    Made *made; /* [tiles] */
} Drawing;

/* ---- how fine ---- */

/* A ray meets, in the list of its cell, objects that it does not meet itself: of width x and height y, in
 * tiles, an object is in about (n x + 1) (n y + 1) of a tile's n^2 cells, of which n^2 x y are its own share.
 * The others, sums of (x + y) / n + 1 / n^2 to a list, are to be two where a list holds one object of the
 * area of the tile, and more where more do, as a ray does not look at the deeper ones. With three the bunny's
 * rays take a tenth longer, with one and a half the hall's lists take twice the time and memory of three.
 * From some of the objects. */
static uint32_t choose_fineness(const RtLightTile *tile, const uint32_t *objects, uint32_t count) {
    enum { SAMPLE = 6 };
    const RtLightGrid *grid = &tile->buffer->cubes[tile->light].grids[tile->face];
    double sides = 0, areas = 0, seen = 0, part = (double)count / (count < SAMPLE ? count : SAMPLE);
    if (tile->buffer->cells > 0) return grid->finest;
    for (uint32_t i = 0; i < count && i < SAMPLE; i++) {
        uint32_t object = objects[count < SAMPLE ? i : (uint32_t)((uint64_t)i * count / SAMPLE)];
        uint32_t id = rt_light_id_of(&tile->buffer->isa.base.scene->geometry, object & ~RT_LIGHT_ALONE);
        RtLightFootprint at;
        if (!rt_light_footprint(tile->buffer, tile->light, tile->face, id, &at)) continue;
        double size[2];
        for (int k = 0; k < 2; k++) {
            double from = k ? tile->row : tile->column;
            size[k] = fmin((double)at.most[k], from + 1) - fmax((double)at.least[k], from);
            size[k] = fmax(size[k], 0x1p-10);
        }
        sides += part * (size[0] + size[1]);
        areas += part * size[0] * size[1];
        seen += part;
    }
    double others = 2.0 * sqrt(fmax(areas, 0x1p-10));
    double n = (sides + sqrt(sides * sides + 4 * others * seen)) / (2 * others);
    n = fmin(n, 1 + 3 * sqrt((double)count)); /* about nine cells an object at most */
    return (uint32_t)fmin(fmax(n, 1), grid->finest);
}

/* ---- drawing ---- */

static RtLightTile tile_at(const RtLightBuffer *buffer, uint32_t light, uint32_t tile) {
    const RtLightCube *cube = &buffer->cubes[light];
    int face = 5;
    while (cube->grids[face].columns == 0 || cube->grids[face].first_tile > tile) face--;
    const RtLightGrid *grid = &cube->grids[face];
    tile -= grid->first_tile;
    return (RtLightTile){buffer, light, face, tile % grid->columns, tile / grid->columns, 1};
}

static bool is_flat(RtRef object) {
    return rt_ref_shape(object) == RT_SHAPE_TRIANGLE || rt_ref_shape(object) == RT_SHAPE_POLYGON;
}

static void cover_round(const RtLightTile *tile, uint32_t id, const RtLightCells *at, RtLightDesk *desk) {
    for (int row = at->lo[1]; row <= at->hi[1] + 1; row++) {
        for (int column = at->lo[0]; column <= at->hi[0] + 1; column++) {
            float depth, *corner = &desk->corner[row][column];
            if (!rt_light_covers(tile, id, (uint32_t)column, (uint32_t)row, &depth)) continue;
            *corner = rt_minf(depth, *corner);
        }
    }
}

/* Objects with curves by what their cells say of each. */
static void draw_round(const RtLightTile *tile, uint32_t id, RtRef object, const RtLightFootprint *from,
                       const RtLightCells *at, RtLightDesk *desk) {
    uint32_t cells = 0, before = desk->count;
    const RtLightOutline nothing = {.slope = {0, 0, INFINITY}};
    tile->buffer->painting->draw_outline(tile, &nothing, from, at, object, desk);
    if (desk->count == before) return;
    for (uint32_t i = before; i < desk->count; i++) {
        uint32_t cell = desk->cell[i];
        if (!rt_light_touches(tile, id, cell % tile->n, cell / tile->n)) continue;
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

static RtStatus take_alone(const RtLightTile *tile, RtRef object, bool cover, RtLightDesk *desk,
                           RtError *error) {
    const RtLightBuffer *buffer = tile->buffer;
    uint32_t id = rt_light_id_of(&buffer->isa.base.scene->geometry, object);
    RtLightFootprint from;
    RtLightOutline outline;
    if (!rt_light_footprint(buffer, tile->light, tile->face, id, &from)) return RT_OK;
    const RtLightCells at = rt_light_cells(tile, &from);
    if (at.lo[0] > at.hi[0] || at.lo[1] > at.hi[1]) return RT_OK;
    if (!cover) RT_TRY(make_room(desk, RT_LIGHT_TILE_CELLS, error));
    if (is_flat(object)) {
        rt_light_outline(tile, id, &from, &outline);
        if (cover) {
            buffer->painting->cover_outline(&outline, &at, desk);
        } else {
            buffer->painting->draw_outline(tile, &outline, &from, &at, object, desk);
        }
    } else if (cover) {
        cover_round(tile, id, &at, desk);
    } else {
        draw_round(tile, id, object, &from, &at, desk);
    }
    return RT_OK;
}

/* Covers the tile's corners with up to sixteen triangles, or draws them. */
static RtStatus take_sixteen(const RtLightTile *tile, const uint32_t *triangles, uint32_t count, bool cover,
                             RtLightDesk *desk, RtError *error) {
    const RtLightPainting *painting = tile->buffer->painting;
    if (!cover) RT_TRY(make_room(desk, 16 * RT_LIGHT_SMALL_ROOM, error));
    uint32_t large = (cover ? painting->cover : painting->draw)(tile, triangles, count, desk);
    for (; large; large &= large - 1) {
        RtRef object = rt_ref(RT_SHAPE_TRIANGLE, triangles[__builtin_ctz(large)]);
        RT_TRY(take_alone(tile, object, cover, desk, error));
    }
    return RT_OK;
}

/* The same of all its objects. */
static RtStatus go_over(const RtLightTile *tile, const uint32_t *objects, uint32_t count, bool cover,
                        RtLightDesk *desk, RtError *error) {
    uint32_t waiting[16], number = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (objects[i] & RT_LIGHT_ALONE) {
            RT_TRY(take_alone(tile, objects[i] & ~RT_LIGHT_ALONE, cover, desk, error));
            continue;
        }
        waiting[number++] = rt_ref_index(objects[i]);
        if (number < 16) continue;
        RT_TRY(take_sixteen(tile, waiting, number, cover, desk, error));
        number = 0;
    }
    return number > 0 ? take_sixteen(tile, waiting, number, cover, desk, error) : RT_OK;
}

/* From corners to cells. `step` is one of a key's depth: a ray from what covers a cell is not to be beyond it
 * by rounding. */
static void cover_cells(const RtLightTile *tile, RtLightDesk *desk) {
    const float step = 2 / tile->buffer->cubes[tile->light].grids[tile->face].depth_scale;
    for (uint32_t row = 0; row < tile->n; row++) {
        for (uint32_t column = 0; column < tile->n; column++) {
            const float *a = &desk->corner[row][column], *b = &desk->corner[row + 1][column];
            float least = rt_minf(rt_minf(a[0], a[1]), rt_minf(b[0], b[1]));
            float most = rt_maxf(rt_maxf(a[0], a[1]), rt_maxf(b[0], b[1]));
            desk->cover[row][column] = most < INFINITY ? most + 0.5f * (most - least) + step : INFINITY;
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

/* Candidates by cell to worker->sorted: list i is from end[i] to end[i + 1]. */
static RtStatus sort_candidates(Worker *worker, uint32_t cells, RtError *error) {
    const RtLightDesk *desk = &worker->desk;
    uint32_t *end = worker->end;
    RT_TRY(rt_reserve(&worker->sorted, &worker->sorted_capacity, desk->count, sizeof(RtLightEntry), error));
    memset(end, 0, (cells + 2) * sizeof *end);
    for (uint32_t i = 0; i < desk->count; i++) end[desk->cell[i] + 2]++;
    for (uint32_t i = 2; i < cells + 2; i++) end[i] += end[i - 1];
    for (uint32_t run = 0, i = 0; run < desk->run_count; run++) {
        for (uint32_t last = i + desk->runs[run].key; i < last; i++) {
            worker->sorted[end[desk->cell[i] + 1]++] = (RtLightEntry){desk->key[i], desk->runs[run].object};
        }
    }
    for (uint32_t i = 0; i < cells; i++) sort_list(worker->sorted + end[i], end[i + 1] - end[i]);
    return RT_OK;
}

static uint32_t depth_bits(uint32_t key) {
    return key & 0x7fff0000u;
}

/* How long a tile's lists may be for it to have at most `most` entries. */
static uint32_t longest_that_fits(const uint32_t *end, uint32_t cells, uint32_t longest, uint32_t most) {
    for (; longest > 1; longest /= 2) {
        uint64_t sum = 0;
        for (uint32_t i = 0; i < cells; i++) {
            uint32_t length = end[i + 1] - end[i];
            sum += (uint64_t)(length < longest ? length : longest) + 1;
        }
        if (sum <= most) break;
    }
    return longest;
}

enum { BLOCK_ENTRIES = 1 << 19 };

static RtStatus add_block(Worker *worker, uint32_t room, RtError *error) {
    RT_TRY(rt_reserve(&worker->blocks, &worker->block_capacity, worker->block_count + UINT64_C(1),
                      sizeof *worker->blocks, error));
    RtLightEntry *block = rt_alloc_unset(room, sizeof *block);
    if (!block) return rt_fail_memory(error, "the lists of a light buffer", room * sizeof *block);
    struct Block *next = &worker->blocks[worker->blocks_used], *last = &worker->blocks[worker->block_count++];
    *last = *next;
    *next = (struct Block){block, room};
    return RT_OK;
}

static RtStatus reserve_entries(Worker *worker, uint32_t needed, RtError *error) {
    if (needed <= worker->room) return RT_OK;
    if (worker->blocks_used == worker->block_count || worker->blocks[worker->blocks_used].room < needed)
        RT_TRY(add_block(worker, needed < BLOCK_ENTRIES ? BLOCK_ENTRIES : needed, error));
    worker->next = worker->blocks[worker->blocks_used].entries;
    worker->room = worker->blocks[worker->blocks_used++].room;
    return RT_OK;
}

/* The lists to worker->next, and their lengths. */
static RtStatus keep_lists(const Drawing *d, const RtLightTile *tile, Worker *worker, Made *made,
                           RtError *error) {
    const RtLightGrid *grid = &d->buffer->cubes[d->light].grids[tile->face];
    const RtLightDesk *desk = &worker->desk;
    const uint32_t cells = tile->n * tile->n, *end = worker->end;
    uint32_t longest = longest_that_fits(end, cells, d->buffer->longest, d->most);
    RT_TRY(reserve_entries(worker, desk->count + cells, error));
    RtLightEntry *to = worker->next;
    made->entries = to;
    for (uint32_t i = 0; i < cells; i++) {
        const RtLightEntry *list = worker->sorted + end[i];
        uint32_t count = end[i + 1] - end[i], kept = count < longest ? count : longest;
        uint32_t row = i / tile->n, column = i % tile->n;
        bool cut = desk->cut[row] >> column & 1;
        uint32_t beyond = cut ? rt_light_depth_key(grid, desk->cover[row][column]) << 16 : 0;
        if (kept < count) beyond = depth_bits(list[kept].key), cut = true;
        for (uint32_t k = 0; k < kept; k++) *to++ = list[k];
        if (cut) *to++ = (RtLightEntry){beyond | RT_LIGHT_PARTS, RT_LIGHT_BEYOND};
        worker->lengths[worker->cell_count++] = (uint16_t)(kept + cut);
    }
    made->count = (uint32_t)(to - worker->next);
    worker->room -= made->count;
    worker->next = to;
    return RT_OK;
}

static RtStatus draw_tile(const Drawing *d, const RtLightTile *tile, const uint32_t *objects, uint32_t count,
                          Worker *worker, Made *made, RtError *error) {
    RtLightDesk *desk = &worker->desk;
    desk->count = desk->run_count = 0;
    memset(desk->cut, 0, sizeof desk->cut);
    for (size_t row = 0; row <= tile->n; row++) {
        for (size_t i = 0; i <= tile->n; i++) desk->corner[row][i] = INFINITY;
    }
    if (d->buffer->full_occlusion) RT_TRY(go_over(tile, objects, count, true, desk, error));
    cover_cells(tile, desk);
    RT_TRY(go_over(tile, objects, count, false, desk, error));
    RT_TRY(sort_candidates(worker, tile->n * tile->n, error));
    return keep_lists(d, tile, worker, made, error);
}

static RtStatus make_tile(void *context, size_t item, int thread, RtError *error) {
    Drawing *d = context;
    Worker *worker = &d->workers[thread];
    uint32_t first = d->bins->first[item], count = d->bins->first[item + 1] - first;
    RtLightTile tile = tile_at(d->buffer, d->light, (uint32_t)item);
    Made made = {NULL, 0, worker->cell_count, 1, thread, 0, 0};
    if (count > 0) made.n = tile.n = choose_fineness(&tile, d->bins->objects + first, count);
    RT_TRY(rt_reserve(&worker->lengths, &worker->cell_capacity,
                      worker->cell_count + UINT64_C(1) * tile.n * tile.n, sizeof(uint16_t), error));
    if (count > 0) {
        RT_TRY(draw_tile(d, &tile, d->bins->objects + first, count, worker, &made, error));
    } else {
        worker->lengths[worker->cell_count++] = 0;
    }
    d->made[item] = made;
    return RT_OK;
}

/* ---- all tiles ---- */

/* To their places. */
static RtStatus move_tile(void *context, size_t item, int thread, RtError *error) {
    (void)thread, (void)error;
    const Drawing *d = context;
    RtLightCube *cube = &d->buffer->cubes[d->light];
    const Made *made = &d->made[item];
    const Worker *worker = &d->workers[made->thread];
    uint32_t sum = made->place;
    const int face = tile_at(d->buffer, d->light, (uint32_t)item).face;
    cube->tiles[item] = rt_light_tile(made->cell_place - cube->grids[face].first_cell, made->n);
    for (uint32_t i = 0; i < made->n * made->n; i++) {
        cube->first[made->cell_place + i] = sum;
        sum += worker->lengths[made->first_cell + i];
    }
    if (made->count == 0) return RT_OK;
    memcpy(cube->entries + made->place, made->entries, made->count * sizeof(RtLightEntry));
    return RT_OK;
}

/* Gives faces and tiles their places; how many entries there are. */
static uint32_t place_tiles(Drawing *d) {
    RtLightCube *cube = &d->buffer->cubes[d->light];
    uint32_t sum = 0;
    for (uint32_t face = 0, tile = 0; face < 6; face++) {
        RtLightGrid *grid = &cube->grids[face];
        grid->first_cell = cube->cell_count;
        for (uint32_t end = tile + grid->columns * grid->rows; tile < end; tile++) {
            Made *made = &d->made[tile];
            made->place = sum;
            made->cell_place = cube->cell_count;
            sum += made->count;
            cube->cell_count += made->n * made->n;
        }
    }
    return sum;
}

static RtStatus make_all(Drawing *d, int threads, RtError *error) {
    RtLightCube *cube = &d->buffer->cubes[d->light];
    for (int i = 0; i < threads; i++)
        d->workers[i].cell_count = d->workers[i].blocks_used = d->workers[i].room = 0;
    RT_TRY(rt_parallel_for(cube->tile_count, threads, make_tile, d, error));
    uint32_t sum = place_tiles(d);
    cube->tiles = rt_alloc(cube->tile_count, sizeof(uint32_t));
    cube->first = rt_alloc_unset(cube->cell_count + (size_t)1, sizeof(uint32_t));
    cube->entries = rt_alloc_unset(sum, sizeof(RtLightEntry));
    if (!cube->tiles || !cube->first || !cube->entries)
        return rt_fail_memory(error, "the lists of a light buffer", sum * sizeof(RtLightEntry));
    cube->first[cube->cell_count] = sum;
    return rt_parallel_for(cube->tile_count, threads, move_tile, d, error);
}

static RtStatus make_light(RtLightBuffer *buffer, uint32_t light, uint32_t most, Worker *workers, int threads,
                           RtError *error) {
    RtLightBins bins = {NULL, NULL};
    Drawing d = {buffer, light, most, &bins, workers, NULL};
    RtStatus status = rt_light_fill_bins(buffer, light, threads, &bins, error);
    d.made = rt_alloc(buffer->cubes[light].tile_count, sizeof(Made));
    if (status == RT_OK && !d.made) status = rt_fail_memory(error, "a light buffer", sizeof(Made));
    if (status == RT_OK) status = make_all(&d, threads, error);
    rt_free(bins.first);
    rt_free(bins.objects);
    rt_free(d.made);
    return status;
}

RtStatus rt_light_make_lists(RtLightBuffer *buffer, uint32_t most, int threads, RtError *error) {
    int count = rt_thread_count(threads);
    Worker *workers = rt_alloc((size_t)count, sizeof *workers);
    RtStatus status = workers ? RT_OK : rt_fail_memory(error, "a light buffer", sizeof *workers);
    for (uint32_t i = 0; status == RT_OK && i < buffer->isa.base.scene->light_count; i++)
        status = make_light(buffer, i, most, workers, count, error);
    for (int i = 0; workers && i < count; i++) {
        RtLightDesk *desk = &workers[i].desk;
        rt_free(desk->cell);
        rt_free(desk->key);
        rt_free(desk->runs);
        rt_free(workers[i].sorted);
        for (uint32_t k = 0; k < workers[i].block_count; k++) rt_free(workers[i].blocks[k].entries);
        rt_free(workers[i].blocks);
        rt_free(workers[i].lengths);
    }
    rt_free(workers);
    return status;
}
