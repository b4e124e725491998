/* SPDX-License-Identifier: Apache-2.0 */
/* Drawing all objects. They are sorted into the tiles of the image that they may be seen in (the sort-middle
 * of Molnar et al. 1994): threads find where objects are seen, each for a contiguous part of them, and count
 * by tile and class of depth; sums over tiles and parts say where each goes. Then each tile is drawn by one
 * thread. Objects that are in many tiles are kept in a list of their own, which every tile draws first: so no
 * list is long, and large objects hide others. A tile's objects come in one order, triangles first: neither
 * the samples nor the hit functions asked depend on the number of threads.
 *
 * An instance is drawn by its box, and its part answers. To draw its objects would cost what drawing copies
 * does: in a forest four times as much.
 *
 * Where an object is seen: its box, projected. The box is grown by E = 2^-19 M + 2^-21 |eye|
 * (accel/raster/raster.h, 1). A hit is off the object's box by the thickness, 2^-20 M, by 2^-23 of the eye's
 * coordinates, and by three roundings of 2^-24 of both; what is left covers the double arithmetic of this
 * file. The part below tmin is cut off. A direction rounded to float32 is off by 2^-24 of its length, which
 * moves its position in the image by less than `direction_error`, and its component along the axis, which is
 * 1, by less than that. */
#include "accel/instance.h"
#include "accel/item/item.h"
#include "core/base/parallel.h"

#include <stdlib.h>

static uint32_t lesser(uint32_t a, uint32_t b) {
    return a < b ? a : b;
}

/* ---- where an object is seen ---- */

RtItemProjection rt_item_projection(const RtView *v) {
    double right = rt_lengthd(v->right), down = rt_lengthd(v->down);
    RtVec3d across = rt_scaled(v->right, 1 / (right * right));
    RtVec3d downward = rt_scaled(v->down, 1 / (down * down));
    /* Position i of n samples: (2 i + 1) / n - 1, or between corners 2 i / (n - 1) - 1. */
    const RtSampling *s = &v->sampling;
    double step[2] = {(s->corners ? s->columns - 1 : s->columns) * 0.5,
                      (s->corners ? s->rows - 1 : s->rows) * 0.5};
    double longest = 1.001 + right + down;
    return (RtItemProjection){
        .x = rt_add_scaledd(rt_scaled(across, step[0]), v->forward, (s->columns - 1) * 0.5),
        .y = rt_add_scaledd(rt_scaled(downward, step[1]), v->forward, (s->rows - 1) * 0.5),
        .depth = v->forward,
        .scale = {step[0] / right, step[1] / down},
        .longest = longest,
        .direction_error = 0x1p-22 * longest * (1 + 1 / right + 1 / down),
    };
}

/* A point relative to the eye: column and row times depth, and depth. */
typedef struct Projected {
    double x[2], w;
} Projected;

/* Bounds of columns, rows and depths; empty while lo > hi. */
typedef struct Bounds {
    double lo[2], hi[2], near;
    double zero[2]; /* an x at w = 0 that is as good as 0 */
} Bounds;

static void include(Bounds *b, const Projected *p) {
    b->near = fmin(b->near, p->w);
    for (int i = 0; i < 2; i++) {
        if (p->w > 0) {
            b->lo[i] = fmin(b->lo[i], p->x[i] / p->w);
            b->hi[i] = fmax(b->hi[i], p->x[i] / p->w);
        } else {
            if (p->x[i] < b->zero[i]) b->lo[i] = -INFINITY;
            if (p->x[i] > -b->zero[i]) b->hi[i] = INFINITY;
        }
    }
}

/* Where the edge between two corners passes depth `cut`. */
static Projected at_depth(const Projected *a, const Projected *b, double cut) {
    double part = (cut - a->w) / (b->w - a->w);
    return (Projected){{a->x[0] + part * (b->x[0] - a->x[0]), a->x[1] + part * (b->x[1] - a->x[1])}, cut};
}

/* The projection of the part of the grown box that is not less deep than `cut` >= 0. */
static Bounds project_box(const RtItemBuffer *buffer, const RtBox *box, double cut) {
    const RtItemProjection *to = &buffer->projection;
    RtVec3d ends[2] = {rt_subd(rt_widen(box->lo), buffer->view.eye),
                       rt_subd(rt_widen(box->hi), buffer->view.eye)};
    double reach = 0, eye = 0;
    for (int a = 0; a < 3; a++) {
        reach = fmax(reach, fmax(fabs(ends[0].at[a]), fabs(ends[1].at[a])));
        eye = fmax(eye, fabs(buffer->view.eye.at[a]));
    }
    double margin = 0x1p-19 * reach + 0x1p-21 * eye + 0x1p-120;
    Bounds bounds = {.lo = {INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY}, .near = INFINITY};
    bounds.zero[0] = 0x1p-40 * (reach + margin) * (to->scale[0] + buffer->view.sampling.columns);
    bounds.zero[1] = 0x1p-40 * (reach + margin) * (to->scale[1] + buffer->view.sampling.rows);
    Projected corners[8];
    for (int i = 0; i < 8; i++) {
        RtVec3d q;
        for (int a = 0; a < 3; a++) q.at[a] = i >> a & 1 ? ends[1].at[a] + margin : ends[0].at[a] - margin;
        corners[i] = (Projected){{rt_dotd(q, to->x), rt_dotd(q, to->y)}, rt_dotd(q, to->depth)};
        if (corners[i].w >= cut) include(&bounds, &corners[i]);
    }
    for (int i = 0; i < 8; i++) {
        for (int a = 0; a < 3; a++) {
            int k = i | 1 << a;
            if (k == i || (corners[i].w < cut) == (corners[k].w < cut)) continue;
            Projected p = at_depth(&corners[i], &corners[k], cut);
            include(&bounds, &p);
        }
    }
    return bounds;
}

bool rt_item_footprint(const RtItemBuffer *buffer, uint32_t id, RtItemFootprint *footprint) {
    const RtSampling *s = &buffer->view.sampling;
    const uint32_t count[2] = {s->columns, s->rows};
    float tmin = (float)buffer->view.near;
    double error = buffer->projection.direction_error;
    if (!(error <= RT_ITEM_MAX_DIRECTION_ERROR)) {
        *footprint = (RtItemFootprint){{0, 0}, {s->columns - 1, s->rows - 1}, tmin};
        return true;
    }
    Bounds b = project_box(buffer, &rt_item_geometry(buffer)->boxes[id], (double)tmin * (1 - error));
    for (int a = 0; a < 2; a++) {
        double grow = error * count[a] / 2, first = ceil(b.lo[a] - grow), last = floor(b.hi[a] + grow);
        if (!(last >= 0 && first < count[a] && first <= last)) return false;
        footprint->lo[a] = first > 0 ? (uint32_t)first : 0;
        footprint->hi[a] = last < count[a] ? (uint32_t)last : count[a] - 1;
    }
    footprint->near = rt_maxf(rt_float_below(b.near * (1 - error)), tmin);
    return true;
}

/* ---- sorting ---- */

enum { MANY_TILES = 64 }; /* of an object that is kept apart */

/* The objects of one thread. */
typedef struct Part {
    RtItemRange *ranges; /* [count] of those that may be seen */
    uint32_t first, end; /* the objects, numbered triangles first */
    uint32_t count;
    size_t *next; /* [lists]: how many objects it has, then where the next goes */
} Part;

typedef struct Drawing {
    RtItemBuffer *buffer;
    uint32_t across; /* tiles of a row */
    Part *parts;     /* [part_count] */
    size_t part_count;
    size_t lists;       /* RT_ITEM_CLASSES for each tile */
    size_t *first;      /* [lists + 1] list k is objects[first[k]..first[k + 1]) */
    RtRef *objects;     /* NULL while they are counted */
    RtItemRange *large; /* [large_count] of many tiles, in no list */
    uint32_t large_count;
    RtItemTile *drawn; /* [threads] */
} Drawing;

RtItemRange rt_item_range(const RtItemBuffer *buffer, RtRef object, const RtItemFootprint *at) {
    RtItemRange range = {.object = object};
    while (range.depth < RT_ITEM_CLASSES - 1 && at->near >= buffer->farther[range.depth]) range.depth++;
    for (int a = 0; a < 2; a++) {
        range.lo[a] = (uint16_t)(at->lo[a] / RT_ITEM_TILE);
        range.hi[a] = (uint16_t)(at->hi[a] / RT_ITEM_TILE);
    }
    return range;
}

static bool is_large(const RtItemRange *range) {
    uint32_t columns = range->hi[0] - range->lo[0] + 1u, rows = range->hi[1] - range->lo[1] + 1u;
    return (uint64_t)columns * rows > MANY_TILES;
}

/* Counts the part's objects by list or, where the lists have room, puts them there. */
static void go_over_tiles(const Drawing *drawing, Part *part) {
    for (uint32_t i = 0; i < part->count; i++) {
        const RtItemRange *range = &part->ranges[i];
        if (is_large(range)) continue;
        for (uint32_t row = range->lo[1]; row <= range->hi[1]; row++) {
            for (uint32_t column = range->lo[0]; column <= range->hi[0]; column++) {
                const size_t tile = (size_t)row * drawing->across + column;
                size_t *to = &part->next[tile * RT_ITEM_CLASSES + range->depth];
                if (drawing->objects) drawing->objects[*to] = range->object;
                ++*to;
            }
        }
    }
}

/* The id of an object that is no triangle, by its number among these, shape by shape. */
static uint32_t other_object(const RtGeometry *g, uint32_t number) {
#define AMONG(CONSTANT, name, Type)                                                                          \
    if (RT_SHAPE_##CONSTANT != RT_SHAPE_TRIANGLE) {                                                          \
        if (number < g->name##_count) return g->name##_ids[number];                                          \
        number -= g->name##_count;                                                                           \
    }
    RT_SHAPES(AMONG)
#undef AMONG
    return RT_NO_OBJECT;
}

static void place_part(void *context, size_t item) {
    const Drawing *drawing = context;
    const RtItemBuffer *buffer = drawing->buffer;
    const RtGeometry *g = rt_item_geometry(buffer);
    Part *part = &drawing->parts[item];
    uint32_t i = part->first, triangles = lesser(part->end, g->triangle_count);
    if (i < triangles) {
        part->count = buffer->raster->place(buffer, i, triangles - i, part->ranges);
        i = triangles;
    }
    for (; i < part->end; i++) {
        const uint32_t id = other_object(g, i - g->triangle_count);
        RtItemFootprint at;
        if (rt_item_footprint(buffer, id, &at))
            part->ranges[part->count++] = rt_item_range(buffer, g->objects[id], &at);
    }
    go_over_tiles(drawing, part);
}

static void fill_part(void *context, size_t item) {
    const Drawing *drawing = context;
    go_over_tiles(drawing, &drawing->parts[item]);
}

/* Sets where each list begins, and each part of it; returns their length. */
static size_t begin_lists(Drawing *drawing) {
    size_t sum = 0;
    for (size_t list = 0; list < drawing->lists; list++) {
        drawing->first[list] = sum;
        for (size_t i = 0; i < drawing->part_count; i++) {
            size_t count = drawing->parts[i].next[list];
            drawing->parts[i].next[list] = sum;
            sum += count;
        }
    }
    drawing->first[drawing->lists] = sum;
    return sum;
}

static RtStatus sort_objects(Drawing *drawing, int threads, RtArena *memory, RtError *error) {
    const uint32_t count = rt_item_geometry(drawing->buffer)->object_count;
    RtItemRange *ranges = rt_arena_alloc_unset(memory, count, sizeof *ranges);
    drawing->parts = rt_arena_alloc(memory, drawing->part_count, sizeof(Part));
    size_t *next = rt_arena_alloc(memory, drawing->part_count * drawing->lists, sizeof *next);
    drawing->first = rt_arena_alloc_unset(memory, drawing->lists + 1, sizeof *next);
    RT_TRY(rt_arena_check(memory, "an item buffer", error));
    for (size_t i = 0; i < drawing->part_count; i++) {
        const uint32_t first = (uint32_t)(count * (uint64_t)i / drawing->part_count);
        const uint32_t end = (uint32_t)(count * (uint64_t)(i + 1) / drawing->part_count);
        drawing->parts[i] =
            (Part){.ranges = ranges + first, .first = first, .end = end, .next = next + i * drawing->lists};
    }
    RT_TRY(rt_parallel_each(drawing->part_count, threads, place_part, drawing, error));
    for (size_t i = 0; i < drawing->part_count; i++) {
        const Part *part = &drawing->parts[i];
        for (uint32_t k = 0; k < part->count; k++) drawing->large_count += is_large(&part->ranges[k]);
    }
    drawing->large = rt_arena_alloc_unset(memory, drawing->large_count, sizeof *drawing->large);
    RtRef *objects = rt_arena_alloc_unset(memory, begin_lists(drawing), sizeof *objects);
    RT_TRY(rt_arena_check(memory, "an item buffer", error));
    drawing->objects = objects;
    drawing->large_count = 0;
    for (size_t i = 0; i < drawing->part_count; i++) {
        const Part *part = &drawing->parts[i];
        for (uint32_t k = 0; k < part->count; k++) {
            if (is_large(&part->ranges[k])) drawing->large[drawing->large_count++] = part->ranges[k];
        }
    }
    return rt_parallel_each(drawing->part_count, threads, fill_part, drawing, error);
}

/* ---- one tile ---- */

/* A sample by its column and row in the tile. */
static uint32_t sample_at(uint32_t column, uint32_t row) {
    uint32_t block = row / RT_ITEM_BLOCK * RT_ITEM_ACROSS + column / RT_ITEM_BLOCK;
    return block * RT_ITEM_BLOCK_SAMPLES + row % RT_ITEM_BLOCK * RT_ITEM_BLOCK + column % RT_ITEM_BLOCK;
}

static void begin_tile(RtItemTile *tile, size_t at) {
    const RtItemBuffer *buffer = tile->buffer;
    const RtSampling *s = &buffer->view.sampling;
    uint32_t across = rt_item_tiles(s->columns);
    tile->column = (uint32_t)(at % across) * RT_ITEM_TILE;
    tile->row = (uint32_t)(at / across) * RT_ITEM_TILE;
    tile->columns = lesser(s->columns - tile->column, RT_ITEM_TILE);
    tile->rows = lesser(s->rows - tile->row, RT_ITEM_TILE);
    for (uint32_t row = 0; row < RT_ITEM_TILE; row++) {
        for (uint32_t column = 0; column < RT_ITEM_TILE; column++) {
            const uint32_t i = sample_at(column, row);
            rt_store_float4(tile->dir[i], rt_round4(buffer->columns[tile->column + column] +
                                                    buffer->rows[tile->row + row]));
            tile->t[i] = column < tile->columns && row < tile->rows ? INFINITY : -1;
            tile->id[i] = RT_NO_OBJECT;
        }
    }
    for (uint32_t block = 0; block < RT_ITEM_BLOCKS; block++) tile->farthest[block] = INFINITY;
}

void rt_item_update_farthest(RtItemTile *tile, uint32_t block) {
    const float *t = &tile->t[(size_t)block * RT_ITEM_BLOCK_SAMPLES];
    tile->farthest[block] = t[0];
    for (uint32_t i = 1; i < RT_ITEM_BLOCK_SAMPLES; i++)
        tile->farthest[block] = rt_maxf(t[i], tile->farthest[block]);
}

/* The rays of a block that enter an instance, whose part answers them as a stream. */
typedef struct Entering {
    RtEntry entries[RT_ITEM_BLOCK_SAMPLES];
    RtRay inside[RT_ITEM_BLOCK_SAMPLES];
    uint32_t samples[RT_ITEM_BLOCK_SAMPLES], count;
} Entering;

static void enter_part(RtItemTile *tile, const RtInstance *instance, const Entering *entering) {
    const RtQuery *part = &rt_query_hit_memory(&tile->query)->parts[instance->part];
    RtHit hits[RT_ITEM_BLOCK_SAMPLES];
    rt_trace_stream(part->accel, part->scratch, entering->inside, entering->count, hits, NULL, &tile->tally);
    for (uint32_t k = 0; k < entering->count; k++) {
        const uint32_t i = entering->samples[k];
        RtHit nearest = {tile->t[i], tile->id[i]};
        rt_enter_end(instance, &entering->entries[k], hits[k], false, &nearest, &tile->tally);
        tile->t[i] = nearest.t;
        tile->id[i] = nearest.object;
    }
}

/* Tests the samples of a block that are in columns lo[0]..end[0]-1 and rows lo[1]..end[1]-1 of the tile. */
static void draw_block(RtItemTile *tile, uint32_t block, const RtItemFootprint *at, uint32_t id,
                       const uint32_t lo[2], const uint32_t end[2]) {
    const RtGeometry *g = rt_item_geometry(tile->buffer);
    const uint32_t left = block % RT_ITEM_ACROSS * RT_ITEM_BLOCK,
                   top = block / RT_ITEM_ACROSS * RT_ITEM_BLOCK;
    RtRay ray = rt_view_ray(&tile->buffer->view, tile->column, tile->row);
    Entering entering;
    entering.count = 0;
    ray.kind = 0; /* one tally for all kinds */
    for (uint32_t k = 0; k < RT_ITEM_BLOCK_SAMPLES; k++) {
        const uint32_t i = block * RT_ITEM_BLOCK_SAMPLES + k;
        const uint32_t column = left + k % RT_ITEM_BLOCK, row = top + k / RT_ITEM_BLOCK;
        RtHit nearest = {tile->t[i], tile->id[i]};
        if (column < lo[0] || column >= end[0] || row < lo[1] || row >= end[1] || at->near > nearest.t)
            continue;
        ray.dir = rt_vec3(tile->dir[i][0], tile->dir[i][1], tile->dir[i][2]);
        RtPreparedRay prepared;
        rt_hit_ray(&prepared, g, &ray, rt_query_hit_memory(&tile->query));
        if (rt_is_instance(g, id)) {
            const uint32_t next = entering.count;
            entering.samples[next] = i;
            entering.count += rt_enter_begin(g, id, &prepared, &nearest, &entering.entries[next],
                                             &entering.inside[next], &tile->tally);
            continue;
        }
        rt_test_object(g, id, &prepared, false, &nearest, &tile->tally);
        tile->t[i] = nearest.t;
        tile->id[i] = nearest.object;
    }
    if (entering.count > 0) enter_part(tile, rt_instance_of(g, id), &entering);
    rt_item_update_farthest(tile, block);
}

void rt_item_draw_object(RtItemTile *tile, uint32_t id) {
    const uint32_t corner[2] = {tile->column, tile->row}, count[2] = {tile->columns, tile->rows};
    uint32_t lo[2], end[2];
    RtItemFootprint at;
    if (!rt_item_footprint(tile->buffer, id, &at)) return;
    for (int a = 0; a < 2; a++) {
        lo[a] = at.lo[a] > corner[a] ? at.lo[a] - corner[a] : 0;
        end[a] = lesser(at.hi[a] + 1 - corner[a], count[a]);
    }
    for (uint32_t row = lo[1] / RT_ITEM_BLOCK; row * RT_ITEM_BLOCK < end[1]; row++) {
        for (uint32_t column = lo[0] / RT_ITEM_BLOCK; column * RT_ITEM_BLOCK < end[0]; column++) {
            const uint32_t block = row * RT_ITEM_ACROSS + column;
            if (at.near <= tile->farthest[block]) draw_block(tile, block, &at, id, lo, end);
        }
    }
}

/* Writes the tile into the image. */
static void end_tile(const RtItemTile *tile) {
    const size_t columns = tile->buffer->view.sampling.columns;
    uint32_t *corner = tile->buffer->samples + tile->row * columns + tile->column;
    for (uint32_t row = 0; row < tile->rows; row++) {
        for (uint32_t column = 0; column < tile->columns; column++)
            corner[row * columns + column] = tile->id[sample_at(column, row)];
    }
}

static RtStatus draw_tile(void *context, size_t item, int thread, RtError *error) {
    enum { SOME = 64 }; /* large objects drawn at once */
    (void)error;
    const Drawing *drawing = context;
    const RtItemRaster *raster = drawing->buffer->raster;
    RtItemTile *tile = &drawing->drawn[thread];
    const size_t *first = &drawing->first[item * RT_ITEM_CLASSES];
    RtRef large[SOME];
    size_t count = 0;
    begin_tile(tile, item);
    const uint32_t x = tile->column / RT_ITEM_TILE, y = tile->row / RT_ITEM_TILE;
    for (size_t i = 0; i < drawing->large_count; i++) {
        const RtItemRange *range = &drawing->large[i];
        if (x < range->lo[0] || x > range->hi[0] || y < range->lo[1] || y > range->hi[1]) continue;
        large[count++] = range->object;
        if (count < SOME) continue;
        raster->draw(tile, large, count);
        count = 0;
    }
    raster->draw(tile, large, count);
    raster->draw(tile, drawing->objects + first[0], first[RT_ITEM_CLASSES] - first[0]);
    end_tile(tile);
    return RT_OK;
}

/* ---- all of them ---- */

static int compare_floats(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Each class gets as many objects, by a sample of them. */
static void choose_classes(RtItemBuffer *buffer) {
    enum { SOME = 1024 };
    const RtGeometry *g = rt_item_geometry(buffer);
    const uint64_t some = g->object_count < SOME ? g->object_count : SOME;
    float depth[SOME];
    uint32_t count = 0;
    for (uint64_t i = 0; i < some; i++) {
        RtVec3 q = rt_box_center(g->boxes[i * g->object_count / some]);
        double at = rt_dotd(rt_subd(rt_widen(q), buffer->view.eye), buffer->projection.depth);
        if (at > 0) depth[count++] = (float)at;
    }
    qsort(depth, count, sizeof *depth, compare_floats);
    for (uint32_t i = 0; i < RT_ITEM_CLASSES - 1; i++)
        buffer->farther[i] = count > 0 ? depth[(i + 1) * count / RT_ITEM_CLASSES] : 0;
}

RtStatus rt_item_draw_all(RtItemBuffer *buffer, int threads, RtError *error) {
    RT_ARENA(memory);
    const size_t thread_count = (size_t)rt_thread_count(threads);
    const uint32_t across = rt_item_tiles(buffer->view.sampling.columns);
    const size_t tiles = (size_t)across * rt_item_tiles(buffer->view.sampling.rows);
    Drawing drawing = {
        .buffer = buffer, .across = across, .part_count = thread_count, .lists = tiles * RT_ITEM_CLASSES};
    choose_classes(buffer);
    RT_TRY(sort_objects(&drawing, threads, &memory, error));
    drawing.drawn = rt_arena_alloc(&memory, thread_count, sizeof(RtItemTile));
    RT_TRY(rt_arena_check(&memory, "an item buffer", error));
    RtStatus status = RT_OK;
    for (size_t k = 0; k < thread_count && status == RT_OK; k++) {
        drawing.drawn[k].buffer = buffer;
        status = rt_query_init(&drawing.drawn[k].query, buffer->base.below, error);
    }
    if (status == RT_OK) status = rt_parallel_for(tiles, threads, draw_tile, &drawing, error);
    for (size_t k = 0; k < thread_count; k++) {
        rt_tally_add(&buffer->base.build_tally, &drawing.drawn[k].tally);
        rt_query_clear(&drawing.drawn[k].query);
    }
    return status;
}
