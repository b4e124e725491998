/* SPDX-License-Identifier: Apache-2.0 */
/* The lists of the cells, face by face, on all threads. All objects are projected twice: first candidates are
 * counted, and the depth is found behind which an object covers a cell; then candidates that are not behind
 * that get their place. Each list is sorted, cut where it would be too long, and moved together with the
 * others. Threads put candidates in any order, but no two of a cell are equal, so sorted lists are the same.
 */
#include "accel/light/light.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* ---- drawing ---- */

enum { CHUNK = 256 }; /* objects that a thread takes at a time */

/* A face while its lists are made. */
typedef struct Drawing {
    RtLightFace on;
    RtLightGrid *grid;
    uint32_t longest;
    atomic_uint *count; /* [cells] candidates, as many as are counted or in their place; then lengths */
    atomic_uint *cover; /* [cells] the bits of a depth >= 0, which are in its order; INFINITY; or NULL */
} Drawing;

static uint32_t cells_of(const RtLightGrid *grid) {
    return grid->columns * grid->rows;
}

static uint32_t bits_of(float a) {
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}

static float cover_of(const Drawing *d, uint32_t cell) {
    float depth = INFINITY;
    uint32_t bits = d->cover ? d->cover[cell] : bits_of(depth);
    memcpy(&depth, &bits, sizeof depth);
    return depth;
}

static void lower(atomic_uint *cover, float depth) {
    uint32_t bits = bits_of(depth), old = *cover;
    while (bits < old && !atomic_compare_exchange_weak(cover, &old, bits)) {
    }
}

/* Counts an object as a candidate of a cell, or gives it its place there. */
static void draw_in_cell(const Drawing *d, uint32_t id, uint32_t cell, RtLightDepths depths) {
    const RtLightGrid *grid = d->grid;
    if (!grid->entries) {
        atomic_fetch_add_explicit(&d->count[cell], 1, memory_order_relaxed);
        if (d->cover) lower(&d->cover[cell], depths.cover);
        return;
    }
    if (depths.near > cover_of(d, cell)) return;
    uint32_t place = atomic_fetch_add_explicit(&d->count[cell], 1, memory_order_relaxed);
    grid->entries[grid->first[cell] + place] = (RtLightEntry){depths.near, d->on.geometry->objects[id]};
}

static void draw_chunk(void *context, size_t item) {
    const Drawing *d = context;
    const uint32_t first = (uint32_t)item * CHUNK, objects = d->on.geometry->object_count;
    RtLightFootprint footprint;
    RtLightDepths depths;
    uint32_t column, last;
    for (uint32_t id = first; id < objects && id < first + CHUNK; id++) {
        if (!rt_light_project(&d->on, id, &footprint)) continue;
        for (uint32_t row = footprint.lo[1]; row <= footprint.hi[1]; row++) {
            if (!rt_light_columns(&footprint, row, &column, &last)) continue;
            for (; column <= last; column++) {
                if (rt_light_see(&footprint, column, row, &depths))
                    draw_in_cell(d, id, row * d->grid->columns + column, depths);
            }
        }
    }
}

/* ---- lists ---- */

static int compare_entries(const void *a, const void *b) {
    const RtLightEntry *x = a, *y = b;
    if (x->depth != y->depth) return x->depth < y->depth ? -1 : 1;
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

/* Sorts and cuts the lists of a row; counts become lengths. A list that is cut has a candidate to spare for
 * its end. */
static void finish_row(void *context, size_t item) {
    const Drawing *d = context;
    const RtLightGrid *grid = d->grid;
    for (uint32_t cell = (uint32_t)item * grid->columns, end = cell + grid->columns; cell < end; cell++) {
        RtLightEntry *list = grid->entries + grid->first[cell];
        uint32_t placed = d->count[cell], kept = placed < d->longest ? placed : d->longest;
        sort_list(list, placed);
        if (kept == grid->first[cell + 1] - grid->first[cell]) continue;
        list[kept] = (RtLightEntry){kept < placed ? list[kept].depth : cover_of(d, cell), RT_LIGHT_BEYOND};
        d->count[cell] = kept + 1;
    }
}

/* Sets `first` to the sums of counts, and counts to 0; returns the sum. */
static uint64_t place_lists(const Drawing *d) {
    uint64_t sum = 0;
    for (uint32_t cell = 0; cell < cells_of(d->grid); cell++) {
        d->grid->first[cell] = (uint32_t)sum;
        sum += d->count[cell];
        d->count[cell] = 0;
    }
    d->grid->first[cells_of(d->grid)] = (uint32_t)sum;
    return sum;
}

/* Moves lists together, and frees what is left. */
static void pack_lists(const Drawing *d, uint32_t capacity) {
    RtLightGrid *grid = d->grid;
    uint32_t sum = 0;
    for (uint32_t cell = 0; cell < cells_of(grid); cell++) {
        uint32_t length = d->count[cell];
        memmove(grid->entries + sum, grid->entries + grid->first[cell], length * sizeof(RtLightEntry));
        grid->first[cell] = sum;
        sum += length;
    }
    grid->first[cells_of(grid)] = sum;
    rt_trim(&grid->entries, sum, &capacity, sizeof(RtLightEntry));
}

/* *left: bytes for candidates and lists; what is made is subtracted, and all of it where they do not fit. */
static RtStatus draw_face(const Drawing *d, uint64_t *left, int threads, RtError *error) {
    RtLightGrid *grid = d->grid;
    const size_t chunks = (d->on.geometry->object_count + (size_t)CHUNK - 1) / CHUNK;
    RT_TRY(rt_parallel_each(chunks, threads, draw_chunk, (void *)d, error));
    uint64_t sum = place_lists(d);
    if (sum >= *left / sizeof(RtLightEntry) || sum > UINT32_MAX) {
        *left = 0;
        return RT_OK;
    }
    grid->entries = rt_alloc_unset(sum, sizeof(RtLightEntry));
    if (!grid->entries)
        return rt_fail_memory(error, "the lists of a light buffer", sum * sizeof(RtLightEntry));
    RT_TRY(rt_parallel_each(chunks, threads, draw_chunk, (void *)d, error));
    RT_TRY(rt_parallel_each(grid->rows, threads, finish_row, (void *)d, error));
    pack_lists(d, (uint32_t)sum);
    *left -= grid->first[cells_of(grid)] * sizeof(RtLightEntry);
    return RT_OK;
}

static RtStatus make_face(RtLightBuffer *buffer, uint32_t light, int face, uint64_t *left, int threads,
                          RtError *error) {
    RtLightGrid *grid = &buffer->cubes[light].grids[face];
    Drawing d = {.on = rt_light_face(buffer, light, face), .grid = grid, .longest = buffer->longest};
    const uint32_t cells = cells_of(grid);
    if (cells == 0) return RT_OK;
    grid->first = rt_alloc_unset(cells + (size_t)1, sizeof(uint32_t));
    d.count = rt_alloc(cells, sizeof *d.count);
    if (buffer->full_occlusion) d.cover = rt_alloc_unset(cells, sizeof *d.cover);
    bool made = grid->first && d.count && (d.cover || !buffer->full_occlusion);
    for (uint32_t cell = 0; made && d.cover && cell < cells; cell++) d.cover[cell] = bits_of(INFINITY);
    RtStatus status = made ? draw_face(&d, left, threads, error)
                           : rt_fail_memory(error, "the cells of a light buffer", cells * sizeof(uint32_t));
    rt_free(d.count);
    rt_free(d.cover);
    return status;
}

RtStatus rt_light_make_lists(RtLightBuffer *buffer, uint64_t limit, int threads, RtError *error) {
    for (uint32_t light = 0; light < buffer->isa.base.scene->light_count; light++) {
        for (int face = 0; face < 6 && limit > 0; face++)
            RT_TRY(make_face(buffer, light, face, &limit, threads, error));
    }
    buffer->serves = limit > 0;
    return RT_OK;
}

void rt_light_drop_lists(RtLightBuffer *buffer) {
    for (uint32_t light = 0; buffer->cubes && light < buffer->isa.base.scene->light_count; light++) {
        for (int face = 0; face < 6; face++) {
            RtLightGrid *grid = &buffer->cubes[light].grids[face];
            rt_free(grid->first);
            rt_free(grid->entries);
            grid->first = NULL;
            grid->entries = NULL;
        }
    }
    buffer->serves = false;
}
