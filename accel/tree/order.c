/* SPDX-License-Identifier: Apache-2.0 */
/* Sorting boxes by their centres: along the Morton curve (Morton 1966) or along an axis. Radix sort, in
 * linear time; equal keys stay in the order of ids. */
#include "accel/tree/tree.h"

#include "core/base/parallel.h"

#include <string.h>

enum { DIGIT_BITS = 8, DIGITS = 1 << DIGIT_BITS, CHUNK = 1 << 14 };

/* The next position of the items of a chunk, by digit. */
typedef struct Offsets {
    uint32_t of[DIGITS];
} Offsets;

/* The chunks do not affect the order. */
typedef struct Sorter {
    const RtBox *boxes;
    RtBox centers; /* the box of all centres */
    uint32_t bits; /* of a Morton code along each axis; 0: sort along `axis` */
    int axis;
    RtKeyed *items, *out;
    uint32_t count, chunk_size, shift;
    Offsets *offsets;  /* [chunks] */
    RtBox *centers_of; /* [chunks] */
} Sorter;

static uint32_t chunk_begin(const Sorter *s, size_t chunk) {
    return (uint32_t)chunk * s->chunk_size;
}

static uint32_t chunk_end(const Sorter *s, size_t chunk) {
    uint32_t begin = chunk_begin(s, chunk);
    return s->count - begin < s->chunk_size ? s->count : begin + s->chunk_size;
}

static void find_centers(void *context, size_t chunk) {
    Sorter *s = context;
    RtBox centers = RT_EMPTY_BOX;
    for (uint32_t i = chunk_begin(s, chunk); i < chunk_end(s, chunk); i++)
        centers = rt_box_add_point(centers, rt_box_center(s->boxes[i]));
    s->centers_of[chunk] = centers;
}

static void count_digits(void *context, size_t chunk) {
    Sorter *s = context;
    uint32_t *offset = s->offsets[chunk].of;
    memset(offset, 0, sizeof(Offsets));
    for (uint32_t i = chunk_begin(s, chunk); i < chunk_end(s, chunk); i++)
        offset[s->items[i].key >> s->shift & (DIGITS - 1)]++;
}

static void move_items(void *context, size_t chunk) {
    Sorter *s = context;
    uint32_t *offset = s->offsets[chunk].of;
    for (uint32_t i = chunk_begin(s, chunk); i < chunk_end(s, chunk); i++)
        s->out[offset[s->items[i].key >> s->shift & (DIGITS - 1)]++] = s->items[i];
}

/* Turns counts of digits into positions, digit by digit, then chunk by chunk. False if all items have the
 * same digit. */
static bool find_offsets(Sorter *s, size_t chunks) {
    for (uint32_t digit = 0, begin = 0; digit < DIGITS; digit++) {
        for (size_t c = 0; c < chunks; c++) {
            uint32_t number = s->offsets[c].of[digit];
            if (number == s->count && chunks == 1) return false;
            s->offsets[c].of[digit] = begin;
            begin += number;
        }
    }
    return true;
}

/* Sorts the items, whose keys have `bits` bits. */
static RtStatus sort(Sorter *s, uint32_t bits, size_t chunks, int threads, RtError *error) {
    for (s->shift = 0; s->shift < bits; s->shift += DIGIT_BITS) {
        RT_TRY(rt_parallel_each(chunks, threads, count_digits, s, error));
        if (!find_offsets(s, chunks)) continue;
        RT_TRY(rt_parallel_each(chunks, threads, move_items, s, error));
        RtKeyed *kept = s->items;
        s->items = s->out;
        s->out = kept;
    }
    return RT_OK;
}

/* Inserts two zeros after each of 21 bits. */
static uint64_t spread_bits(uint64_t x) {
    x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (x | x << 2) & UINT64_C(0x1249249249249249);
}

static uint64_t morton_code(RtVec3 center, const RtBox *centers, int cells) {
    uint64_t code = 0;
    for (int a = 0; a < 3; a++) {
        double size = (double)centers->hi.at[a] - (double)centers->lo.at[a];
        double at = (double)center.at[a] - (double)centers->lo.at[a];
        int cell = size > 0 ? (int)(at / size * cells) : 0;
        code |= spread_bits((uint64_t)(cell < cells ? cell : cells - 1)) << a;
    }
    return code;
}

/* Bits whose order as integers is that of the floats. */
static uint32_t ascending_bits(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits & UINT32_C(0x80000000) ? ~bits : bits | UINT32_C(0x80000000);
}

static void make_keys(void *context, size_t chunk) {
    Sorter *s = context;
    for (uint32_t i = chunk_begin(s, chunk); i < chunk_end(s, chunk); i++) {
        RtVec3 center = rt_box_center(s->boxes[i]);
        uint64_t key =
            s->bits > 0 ? morton_code(center, &s->centers, 1 << s->bits) : ascending_bits(center.at[s->axis]);
        s->items[i] = (RtKeyed){key, i};
    }
}

RtStatus rt_tree_order(const RtGeometry *geometry, uint32_t bits, int axis, int threads, RtArena *memory,
                       const RtKeyed **order, RtError *error) {
    const uint32_t count = geometry->object_count, share = count / (uint32_t)rt_thread_count(threads) + 1;
    Sorter s = {
        .boxes = geometry->boxes, .centers = RT_EMPTY_BOX, .bits = bits, .axis = axis, .count = count};
    s.chunk_size = share > CHUNK ? share : CHUNK;
    const size_t chunks = count / s.chunk_size + 1;
    s.items = rt_arena_alloc_unset(memory, count, sizeof(RtKeyed));
    s.out = rt_arena_alloc_unset(memory, count, sizeof(RtKeyed));
    s.offsets = rt_arena_alloc(memory, chunks, sizeof(Offsets));
    s.centers_of = rt_arena_alloc(memory, chunks, sizeof(RtBox));
    RT_TRY(rt_arena_check(memory, "an order of objects", error));
    RT_TRY(rt_parallel_each(chunks, threads, find_centers, &s, error));
    for (size_t c = 0; c < chunks; c++) s.centers = rt_box_union(s.centers, s.centers_of[c]);
    RT_TRY(rt_parallel_each(chunks, threads, make_keys, &s, error));
    RT_TRY(sort(&s, bits > 0 ? 3 * bits : 32, chunks, threads, error));
    rt_arena_free(memory, s.out);
    *order = s.items;
    return RT_OK;
}
