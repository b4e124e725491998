/* SPDX-License-Identifier: Apache-2.0 */
/* The lists of a light, tile by tile on all threads. First the corners of cells are covered by what lies on
 * them, as in a shadow map; a cell whose four corners are covered is taken to be covered, a little beyond the
 * deepest of them. Then objects are drawn: each becomes a candidate of the cells that it may be seen in and
 * that are not covered before it. Candidates are sorted by cell, depth and object.
 *
 * That a cell is covered is a guess, for there may be a hole between its corners; that its list was cut is
 * noted (light.h), so a ray from behind is passed on. */
#include "accel/light/light.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <stdlib.h>
#include <string.h>

/* What one thread has made. */
typedef struct Worker {
    RtLightDraft draft;
    uint32_t end[RT_LIGHT_TILE_CELLS + 2]; /* of lists in `sorted` */
    RtLightEntry *sorted;                  /* [sorted_capacity]: the candidates of a tile */
    uint32_t sorted_capacity;
    uint16_t *lengths; /* of the lists of all cells of its tiles */
    uint32_t cell_count, cell_capacity;
} Worker;

/* The lists of a tile until they have their place, and their place. */
typedef struct Made {
    RtLightEntry *entries; /* [count] */
    uint32_t count, first_cell, n;
    int thread;
    uint32_t place, cell_place;
} Made;

typedef struct Drawing {
    RtLightBuffer *buffer;
    uint32_t light, most; /* entries of a tile */
    RtLightFace faces[6];
    RtBins bins;
    Worker *workers;
    Made *made; /* [tiles] */
} Drawing;

/* ---- the resolution of a tile ---- */

/* In the list of its cell a ray finds objects that it does not hit: of width x and height y, in tiles, an
 * object is in about (n x + 1) (n y + 1) of a tile's n^2 cells, of which n^2 x y are its own share. The
 * others, sums of (x + y) / n + 1 / n^2 to a list, are to be two where a list holds one object of the area of
 * the tile, and more where more do, as a ray does not look at the deeper ones. With three the bunny's rays
 * take a tenth longer, with one and a half the hall's lists take twice the time and memory of three. By a
 * sample of the objects. */
static uint32_t choose_resolution(const RtLightTile *tile, const uint32_t *objects, uint32_t count) {
    enum { SAMPLE = 6 };
    const RtLightGrid *grid = tile->on.grid;
    double sides = 0, areas = 0, seen = 0, part = (double)count / (count < SAMPLE ? count : SAMPLE);
    if (tile->on.buffer->cells > 0) return grid->max_resolution;
    for (uint32_t i = 0; i < count && i < SAMPLE; i++) {
        uint32_t object = objects[count < SAMPLE ? i : (uint32_t)((uint64_t)i * count / SAMPLE)];
        uint32_t id = rt_raster_id(tile->on.geometry, object & ~RT_LIGHT_BY_FOOTPRINT);
        RtLightFootprint at;
        if (!rt_light_footprint(&tile->on, id, &at)) continue;
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
    return (uint32_t)fmin(fmax(n, 1), grid->max_resolution);
}

/* ---- drawing ---- */

static RtLightTile tile_at(const Drawing *d, uint32_t tile) {
    const RtLightFace *on = &d->faces[5];
    while (on->grid->columns == 0 || on->grid->first_tile > tile) on--;
    tile -= on->grid->first_tile;
    return (RtLightTile){*on, tile % on->grid->columns, tile / on->grid->columns, 1};
}

static void cover_curved(const RtLightTile *tile, uint32_t id, const RtLightCells *at, RtLightDraft *draft) {
    for (int row = at->lo[1]; row <= at->hi[1] + 1; row++) {
        for (int column = at->lo[0]; column <= at->hi[0] + 1; column++) {
            float depth, *corner = &draft->corner[row][column];
            if (!rt_light_covers(tile, id, (uint32_t)column, (uint32_t)row, &depth)) continue;
            *corner = rt_minf(depth, *corner);
        }
    }
}

/* Curved objects are tested cell by cell. */
static void draw_curved(const RtLightTile *tile, uint32_t id, RtRef object, const RtLightFootprint *from,
                        const RtLightCells *at, RtLightDraft *draft) {
    uint32_t cells = 0, before = draft->count;
    const RtLightOutline nothing = {.slope = {0, 0, INFINITY}};
    tile->on.buffer->raster->draw_outline(tile, &nothing, from, at, object, draft);
    if (draft->count == before) return;
    for (uint32_t i = before; i < draft->count; i++) {
        uint32_t cell = draft->cell[i];
        if (!rt_light_touches(tile, id, cell % tile->n, cell / tile->n)) continue;
        draft->cell[before + cells] = cell;
        draft->key[before + cells++] = draft->key[i];
    }
    draft->count = before + cells;
    draft->runs[draft->run_count - 1].key = cells;
}

static RtStatus make_room(RtLightDraft *draft, uint32_t cells, RtError *error) {
    uint64_t needed = draft->count + (uint64_t)cells;
    RT_TRY(rt_reserve(&draft->cell, &draft->cell_capacity, needed, sizeof(uint32_t), error));
    RT_TRY(rt_reserve(&draft->key, &draft->key_capacity, needed, sizeof(uint32_t), error));
    return rt_reserve(&draft->runs, &draft->run_capacity, draft->run_count + UINT64_C(16),
                      sizeof(RtLightEntry), error);
}

/* Covers corners with an object, or draws it, by its footprint. */
static RtStatus take_footprint(const RtLightTile *tile, RtRef object, bool cover, RtLightDraft *draft,
                               RtError *error) {
    const RtLightRaster *raster = tile->on.buffer->raster;
    uint32_t id = rt_raster_id(tile->on.geometry, object);
    RtLightFootprint from;
    RtLightOutline outline;
    if (!rt_light_footprint(&tile->on, id, &from)) return RT_OK;
    const RtLightCells at = rt_light_cells(tile, &from);
    if (at.lo[0] > at.hi[0] || at.lo[1] > at.hi[1]) return RT_OK;
    if (!cover) RT_TRY(make_room(draft, RT_LIGHT_TILE_CELLS, error));
    if (rt_light_is_flat(object)) {
        rt_light_outline(tile, id, &from, &outline);
        if (cover)
            raster->cover_outline(&outline, &at, draft);
        else
            raster->draw_outline(tile, &outline, &from, &at, object, draft);
    } else if (cover) {
        cover_curved(tile, id, &at, draft);
    } else {
        draw_curved(tile, id, object, &from, &at, draft);
    }
    return RT_OK;
}

/* The same of up to sixteen triangles, those that are small in lanes. */
static RtStatus take_triangles(const RtLightTile *tile, const RtRef *triangles, uint32_t count, bool cover,
                               RtLightDraft *draft, RtError *error) {
    const RtLightRaster *raster = tile->on.buffer->raster;
    if (!cover) RT_TRY(make_room(draft, 16 * RT_LIGHT_SMALL_ROOM, error));
    uint32_t large = (cover ? raster->cover : raster->draw)(tile, triangles, count, draft);
    for (; large; large &= large - 1)
        RT_TRY(take_footprint(tile, triangles[__builtin_ctz(large)], cover, draft, error));
    return RT_OK;
}

/* The same of all objects of a tile. */
static RtStatus take_all(const RtLightTile *tile, const uint32_t *objects, uint32_t count, bool cover,
                         RtLightDraft *draft, RtError *error) {
    RtRef triangles[16];
    uint32_t waiting = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (objects[i] & RT_LIGHT_BY_FOOTPRINT) {
            RT_TRY(take_footprint(tile, objects[i] & ~RT_LIGHT_BY_FOOTPRINT, cover, draft, error));
            continue;
        }
        triangles[waiting++] = objects[i];
        if (waiting < 16) continue;
        RT_TRY(take_triangles(tile, triangles, waiting, cover, draft, error));
        waiting = 0;
    }
    return waiting > 0 ? take_triangles(tile, triangles, waiting, cover, draft, error) : RT_OK;
}

/* From corners to cells. `step` is one of a key's depth: a ray from the occluder that covers a cell is not
 * beyond it by rounding. */
static void cover_cells(const RtLightTile *tile, RtLightDraft *draft) {
    const float step = 2 / tile->on.grid->depth_scale;
    for (uint32_t row = 0; row < tile->n; row++) {
        for (uint32_t column = 0; column < tile->n; column++) {
            const float *a = &draft->corner[row][column], *b = &draft->corner[row + 1][column];
            float least = rt_minf(rt_minf(a[0], a[1]), rt_minf(b[0], b[1]));
            float most = rt_maxf(rt_maxf(a[0], a[1]), rt_maxf(b[0], b[1]));
            draft->cover[row][column] = most < INFINITY ? most + 0.5f * (most - least) + step : INFINITY;
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
    const RtLightDraft *draft = &worker->draft;
    uint32_t *end = worker->end;
    RT_TRY(rt_reserve(&worker->sorted, &worker->sorted_capacity, draft->count, sizeof(RtLightEntry), error));
    memset(end, 0, (cells + 2) * sizeof *end);
    for (uint32_t i = 0; i < draft->count; i++) end[draft->cell[i] + 2]++;
    for (uint32_t i = 2; i < cells + 2; i++) end[i] += end[i - 1];
    for (uint32_t run = 0, i = 0; run < draft->run_count; run++) {
        for (uint32_t last = i + draft->runs[run].key; i < last; i++)
            worker->sorted[end[draft->cell[i] + 1]++] =
                (RtLightEntry){draft->key[i], draft->runs[run].object};
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

/* Where the list of a cell ends: how many candidates of it are kept, and whether it is cut. */
static uint32_t kept_of(const Worker *worker, uint32_t cell, uint32_t n, uint32_t longest, bool *cut) {
    uint32_t count = worker->end[cell + 1] - worker->end[cell];
    *cut = (worker->draft.cut[cell / n] >> cell % n & 1) || count > longest;
    return count < longest ? count : longest;
}

/* The lists of a tile to made->entries, and their lengths. */
static RtStatus keep_lists(const Drawing *d, const RtLightTile *tile, Worker *worker, Made *made,
                           RtError *error) {
    const RtLightDraft *draft = &worker->draft;
    const uint32_t n = tile->n, cells = n * n, *end = worker->end;
    uint32_t longest = longest_that_fits(end, cells, d->buffer->longest, d->most);
    bool cut;
    for (uint32_t i = 0; i < cells; i++) {
        uint32_t length = kept_of(worker, i, n, longest, &cut) + cut;
        worker->lengths[worker->cell_count++] = (uint16_t)length;
        made->count += length;
    }
    RtLightEntry *to = made->entries = rt_alloc_unset(made->count, sizeof *to);
    if (!to) return rt_fail_memory(error, "the lists of a light buffer", made->count * sizeof *to);
    for (uint32_t i = 0; i < cells; i++) {
        const RtLightEntry *list = worker->sorted + end[i];
        uint32_t kept = kept_of(worker, i, n, longest, &cut);
        for (uint32_t k = 0; k < kept; k++) *to++ = list[k];
        if (!cut) continue;
        uint32_t beyond = kept < end[i + 1] - end[i]
                              ? depth_bits(list[kept].key)
                              : rt_light_depth_key(tile->on.grid, draft->cover[i / n][i % n]) << 16;
        *to++ = (RtLightEntry){beyond | RT_LIGHT_PARTS, RT_LIGHT_BEYOND};
    }
    return RT_OK;
}

static RtStatus draw_tile(const Drawing *d, const RtLightTile *tile, const uint32_t *objects, uint32_t count,
                          Worker *worker, Made *made, RtError *error) {
    RtLightDraft *draft = &worker->draft;
    draft->count = draft->run_count = 0;
    memset(draft->cut, 0, sizeof draft->cut);
    for (size_t row = 0; row <= tile->n; row++) {
        for (size_t i = 0; i <= tile->n; i++) draft->corner[row][i] = INFINITY;
    }
    if (d->buffer->full_occlusion) RT_TRY(take_all(tile, objects, count, true, draft, error));
    cover_cells(tile, draft);
    RT_TRY(take_all(tile, objects, count, false, draft, error));
    RT_TRY(sort_candidates(worker, tile->n * tile->n, error));
    return keep_lists(d, tile, worker, made, error);
}

static RtStatus make_tile(void *context, size_t item, int thread, RtError *error) {
    Drawing *d = context;
    Worker *worker = &d->workers[thread];
    const uint32_t *objects = d->bins.objects + d->bins.first[item];
    uint32_t count = (uint32_t)(d->bins.first[item + 1] - d->bins.first[item]);
    RtLightTile tile = tile_at(d, (uint32_t)item);
    Made *made = &d->made[item];
    if (count > 0) tile.n = choose_resolution(&tile, objects, count);
    *made = (Made){.first_cell = worker->cell_count, .n = tile.n, .thread = thread};
    RT_TRY(rt_reserve(&worker->lengths, &worker->cell_capacity,
                      worker->cell_count + UINT64_C(1) * tile.n * tile.n, sizeof(uint16_t), error));
    if (count > 0) return draw_tile(d, &tile, objects, count, worker, made, error);
    worker->lengths[worker->cell_count++] = 0;
    return RT_OK;
}

/* ---- all tiles ---- */

/* Moves the lists of a tile to their place. */
static void move_tile(void *context, size_t item) {
    const Drawing *d = context;
    RtLightCube *cube = &d->buffer->cubes[d->light];
    Made *made = &d->made[item];
    const uint16_t *lengths = d->workers[made->thread].lengths + made->first_cell;
    uint32_t sum = made->place, before = tile_at(d, (uint32_t)item).on.grid->first_cell;
    cube->tiles[item] = rt_light_tile(made->cell_place - before, made->n);
    for (uint32_t i = 0; i < made->n * made->n; i++) {
        cube->first[made->cell_place + i] = sum;
        sum += lengths[i];
    }
    if (made->count > 0)
        memcpy(cube->entries + made->place, made->entries, made->count * sizeof(RtLightEntry));
    rt_free(made->entries);
    made->entries = NULL;
}

/* Assigns faces and tiles their places; returns the number of entries. */
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
    for (int i = 0; i < threads; i++) d->workers[i].cell_count = 0;
    RT_TRY(rt_parallel_for(cube->tile_count, threads, make_tile, d, error));
    uint32_t sum = place_tiles(d);
    cube->tiles = rt_alloc(cube->tile_count, sizeof(uint32_t));
    cube->first = rt_alloc_unset(cube->cell_count + (size_t)1, sizeof(uint32_t));
    cube->entries = rt_alloc_unset(sum, sizeof(RtLightEntry));
    if (!cube->tiles || !cube->first || !cube->entries)
        return rt_fail_memory(error, "the lists of a light buffer", sum * sizeof(RtLightEntry));
    cube->first[cube->cell_count] = sum;
    return rt_parallel_each(cube->tile_count, threads, move_tile, d, error);
}

/* An object that is no triangle, on all faces. */
static uint32_t place_object(const void *view, uint32_t id, RtTileRange *to) {
    const RtLightFace *faces = view;
    uint32_t placed = 0;
    if (rt_light_is_near(&faces[0], id)) return 0;
    for (int face = 0; face < 6; face++) placed += rt_light_place(&faces[face], id, &to[placed]);
    return placed;
}

static RtStatus make_light(RtLightBuffer *buffer, uint32_t light, uint32_t most, Worker *workers, int threads,
                           RtError *error) {
    uint32_t tiles = buffer->cubes[light].tile_count;
    Drawing d = {.buffer = buffer, .light = light, .most = most, .workers = workers};
    RtBinning binning = {.geometry = &buffer->isa.base.scene->geometry,
                         .what = "the tiles of a light buffer",
                         .view = d.faces,
                         .place_triangles = buffer->raster->place,
                         .place_object = place_object,
                         .lists = tiles,
                         .most_tiles = UINT32_MAX};
    for (int face = 0; face < 6; face++) {
        const RtLightGrid *grid = &buffer->cubes[light].grids[face];
        d.faces[face] = rt_light_face(buffer, light, face);
        binning.layers[face] = (RtTileLayer){grid->first_tile, 1, grid->columns};
    }
    RtStatus status = rt_bins_fill(&binning, threads, &d.bins, error);
    d.made = rt_alloc(tiles, sizeof(Made));
    if (status == RT_OK && !d.made) status = rt_fail_memory(error, "a light buffer", sizeof(Made));
    if (status == RT_OK) status = make_all(&d, threads, error);
    for (uint32_t i = 0; d.made && i < tiles; i++) rt_free(d.made[i].entries);
    rt_bins_clear(&d.bins);
    rt_free(d.made);
    return status;
}

RtStatus rt_light_make_lists(RtLightBuffer *buffer, uint32_t most, int threads, RtError *error) {
    int count = rt_thread_count(threads);
    Worker *workers = rt_alloc((size_t)count, sizeof *workers);
    RtStatus status = workers ? RT_OK : rt_fail_memory(error, "a light buffer", sizeof *workers);
    for (uint32_t i = 0; status == RT_OK && i < buffer->isa.base.scene->light_count; i++) {
        if (buffer->cubes[i].serves) status = make_light(buffer, i, most, workers, count, error);
    }
    for (int i = 0; workers && i < count; i++) {
        RtLightDraft *draft = &workers[i].draft;
        rt_free(draft->cell);
        rt_free(draft->key);
        rt_free(draft->runs);
        rt_free(workers[i].sorted);
        rt_free(workers[i].lengths);
    }
    rt_free(workers);
    return status;
}

void rt_light_drop(RtLightCube *cube) {
    rt_free(cube->tiles);
    rt_free(cube->first);
    rt_free(cube->entries);
    rt_free(cube->near);
    cube->tiles = cube->first = cube->near = NULL;
    cube->entries = NULL;
    cube->near_count = 0;
    cube->serves = false;
}
