/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/tree/order.h"

#include "base/memory.h"

#include <string.h>

enum { DIGIT_BITS = 8, DIGITS = 1 << DIGIT_BITS };

/* Moves items[0..count) to out, in order of the digit at bit `shift` of their keys, else as they are. False,
 * and nothing is moved, if all have the same digit. */
static bool sort_by_digit(const RtKeyed *items, RtKeyed *out, uint32_t count, uint32_t shift) {
    uint32_t place[DIGITS] = {0};
    for (uint32_t i = 0; i < count; i++) place[items[i].key >> shift & (DIGITS - 1)]++;
    if (place[items[0].key >> shift & (DIGITS - 1)] == count) return false;
    for (uint32_t digit = 0, begin = 0; digit < DIGITS; digit++) {
        uint32_t next = begin + place[digit];
        place[digit] = begin;
        begin = next;
    }
    for (uint32_t i = 0; i < count; i++) out[place[items[i].key >> shift & (DIGITS - 1)]++] = items[i];
    return true;
}

/* Sorts items[0..count), whose keys have `bits` bits; takes the block, gives the one that they are in
 * then. */
static RtKeyed *sorted(RtKeyed *items, uint32_t count, uint32_t bits) {
    RtKeyed *spare = items ? rt_alloc(count, sizeof(RtKeyed)) : NULL;
    if (!spare) {
        rt_free(items);
        return NULL;
    }
    for (uint32_t shift = 0; count > 1 && shift < bits; shift += DIGIT_BITS) {
        if (!sort_by_digit(items, spare, count, shift)) continue;
        RtKeyed *kept = items;
        items = spare;
        spare = kept;
    }
    rt_free(spare);
    return items;
}

/* Spreads 21 bits so that two zeros follow each. */
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

RtKeyed *rt_order_morton(const RtBox *boxes, uint32_t count, uint32_t bits) {
    RtKeyed *items = rt_alloc(count, sizeof(RtKeyed));
    RtBox centers = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) centers = rt_box_add_point(centers, rt_box_center(boxes[i]));
    for (uint32_t i = 0; items && i < count; i++) {
        items[i] = (RtKeyed){morton_code(rt_box_center(boxes[i]), &centers, 1 << bits), i};
    }
    return sorted(items, count, 3 * bits);
}

/* The bits of a number, so that they ascend with it: those of negative ones turned about. */
static uint32_t ascending_bits(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits & UINT32_C(0x80000000) ? ~bits : bits | UINT32_C(0x80000000);
}

RtKeyed *rt_order_axis(const RtBox *boxes, uint32_t count, int axis) {
    RtKeyed *items = rt_alloc(count, sizeof(RtKeyed));
    for (uint32_t i = 0; items && i < count; i++) {
        items[i] = (RtKeyed){ascending_bits(rt_box_center(boxes[i]).at[axis]), i};
    }
    return sorted(items, count, 32);
}
