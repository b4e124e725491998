/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/raster/bins.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

/* The objects of one thread. */
typedef struct Part {
    RtTileRange *ranges;
    uint32_t count, capacity;
    size_t *next; /* [lists]: how many objects it has, then where the next goes */
} Part;

typedef struct Sorter {
    const RtBinning *what;
    RtBins *bins;
    size_t part_count;
    Part *parts; /* [part_count] */
} Sorter;

static bool is_large(const RtBinning *what, const RtTileRange *range) {
    uint32_t columns = range->hi[0] - range->lo[0] + 1u, rows = range->hi[1] - range->lo[1] + 1u;
    return range->layer == RT_TILE_APART || (uint64_t)columns * rows > what->most_tiles;
}

/* Counts the part's objects by list or, where the lists have room, puts them there. */
static void go_over_tiles(const Sorter *s, Part *part) {
    uint32_t *objects = s->bins->objects;
    for (uint32_t i = 0; i < part->count; i++) {
        const RtTileRange *range = &part->ranges[i];
        if (is_large(s->what, range)) continue;
        const RtTileLayer *layer = &s->what->layers[range->layer];
        for (uint32_t row = range->lo[1]; row <= range->hi[1]; row++) {
            size_t *next = part->next + layer->first + (size_t)row * layer->row_stride;
            for (uint32_t column = range->lo[0]; column <= range->hi[0]; column++) {
                size_t *to = next + (size_t)column * layer->column_stride;
                if (objects) objects[*to] = range->object;
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

/* Objects are numbered triangles first. */
static RtStatus place_part(void *context, size_t item, int thread, RtError *error) {
    (void)thread;
    Sorter *s = context;
    const RtBinning *what = s->what;
    const RtGeometry *g = what->geometry;
    Part *part = &s->parts[item];
    uint32_t first = (uint32_t)(g->object_count * (uint64_t)item / s->part_count);
    uint32_t end = (uint32_t)(g->object_count * (uint64_t)(item + 1) / s->part_count);
    uint32_t triangles = end < g->triangle_count ? end : g->triangle_count;
    part->next = rt_alloc(what->lists, sizeof(size_t));
    if (!part->next) return rt_fail_memory(error, what->what, what->lists * sizeof(size_t));
    RT_TRY(rt_reserve(&part->ranges, &part->capacity, end - first + UINT64_C(1), sizeof(RtTileRange), error));
    for (uint32_t i = first, count; i < end; i += count) {
        count = i < triangles ? triangles - i : 1;
        if (count > RT_TILE_TRIANGLES) count = RT_TILE_TRIANGLES;
        RT_TRY(rt_reserve(&part->ranges, &part->capacity, part->count + (uint64_t)RT_TILE_MOST_RANGES * count,
                          sizeof(RtTileRange), error));
        RtTileRange *to = part->ranges + part->count;
        part->count += i < triangles ? what->place_triangles(what->view, i, count, to)
                                     : what->place_object(what->view, other_object(g, i - triangles), to);
    }
    go_over_tiles(s, part);
    return RT_OK;
}

static void fill_part(void *context, size_t item) {
    Sorter *s = context;
    go_over_tiles(s, &s->parts[item]);
}

static RtStatus make_room(Sorter *s, RtError *error) {
    const RtBinning *what = s->what;
    size_t sum = 0;
    s->bins->first = rt_alloc_unset(what->lists + 1, sizeof(size_t));
    if (!s->bins->first) return rt_fail_memory(error, what->what, what->lists * sizeof(size_t));
    for (size_t list = 0; list < what->lists; list++) {
        s->bins->first[list] = sum;
        for (size_t i = 0; i < s->part_count; i++) {
            size_t count = s->parts[i].next[list];
            s->parts[i].next[list] = sum;
            sum += count;
        }
    }
    s->bins->first[what->lists] = sum;
    s->bins->objects = rt_alloc_unset(sum, sizeof(uint32_t));
    return s->bins->objects ? RT_OK : rt_fail_memory(error, what->what, sum * sizeof(uint32_t));
}

static RtStatus collect_large(Sorter *s, RtError *error) {
    RtBins *bins = s->bins;
    uint32_t capacity = 0;
    for (int apart = 0; apart < 2; apart++) {
        for (size_t i = 0; i < s->part_count; i++) {
            for (uint32_t k = 0; k < s->parts[i].count; k++) {
                const RtTileRange *range = &s->parts[i].ranges[k];
                if (!is_large(s->what, range) || (range->layer == RT_TILE_APART) != apart) continue;
                RT_TRY(rt_reserve(&bins->large, &capacity, bins->large_count + UINT64_C(1), sizeof *range,
                                  error));
                bins->large[bins->large_count++] = *range;
            }
        }
    }
    return RT_OK;
}

RtStatus rt_bins_fill(const RtBinning *what, int threads, RtBins *bins, RtError *error) {
    *bins = (RtBins){0};
    Sorter s = {what, bins, (size_t)rt_thread_count(threads), NULL};
    s.parts = rt_alloc(s.part_count, sizeof(Part));
    if (!s.parts) return rt_fail_memory(error, what->what, s.part_count * sizeof(Part));
    RtStatus status = rt_parallel_for(s.part_count, threads, place_part, &s, error);
    if (status == RT_OK) status = collect_large(&s, error);
    if (status == RT_OK) status = make_room(&s, error);
    if (status == RT_OK) status = rt_parallel_each(s.part_count, threads, fill_part, &s, error);
    for (size_t i = 0; i < s.part_count; i++) {
        rt_free(s.parts[i].ranges);
        rt_free(s.parts[i].next);
    }
    rt_free(s.parts);
    return status;
}

void rt_bins_clear(RtBins *bins) {
    rt_free(bins->first);
    rt_free(bins->objects);
    rt_free(bins->large);
    *bins = (RtBins){0};
}
