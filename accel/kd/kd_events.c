/* SPDX-License-Identifier: Apache-2.0 */
/* Making, sorting and merging events. Radix sort orders those of the root; later only the events of clipped
 * objects are made anew, sorted and merged. */
#include "accel/kd/kd.h"

#include <string.h>

/* Up to so many events, insertion sort is faster than radix sort. */
enum { SMALL = 64 };

/* Increases with the plane. */
static uint32_t key(RtKdEvent event) {
    uint32_t bits;
    memcpy(&bits, &event.plane, sizeof bits);
    return bits >> 31 ? ~bits : bits | UINT32_C(0x80000000);
}

static bool before(RtKdEvent a, RtKdEvent b) {
    return a.plane < b.plane || (a.plane == b.plane && a.what < b.what);
}

static void sort_by_insertion(RtKdEvent *events, uint32_t count) {
    for (uint32_t i = 1; i < count; i++) {
        RtKdEvent event = events[i];
        uint32_t k = i;
        for (; k > 0 && before(event, events[k - 1]); k--) events[k] = events[k - 1];
        events[k] = event;
    }
}

enum { DIGIT = 11, DIGITS = 1 << DIGIT, PASSES = 3 };

static uint32_t digit(RtKdEvent event, int pass) {
    return key(event) >> (pass * DIGIT) & (DIGITS - 1);
}

/* Stable, from the lowest digits of the keys to the highest. */
static void sort_by_radix(RtKdEvent *events, RtKdEvent *spare, uint32_t count) {
    uint32_t place[PASSES][DIGITS] = {{0}}, sum[PASSES] = {0};
    for (uint32_t i = 0; i < count; i++) {
        for (int pass = 0; pass < PASSES; pass++) place[pass][digit(events[i], pass)]++;
    }
    for (uint32_t d = 0; d < DIGITS; d++) {
        for (int pass = 0; pass < PASSES; pass++) {
            uint32_t length = place[pass][d];
            place[pass][d] = sum[pass];
            sum[pass] += length;
        }
    }
    for (int pass = 0; pass < PASSES; pass++) {
        RtKdEvent *from = pass % 2 ? spare : events, *to = pass % 2 ? events : spare;
        for (uint32_t i = 0; i < count; i++) to[place[pass][digit(from[i], pass)]++] = from[i];
    }
    memcpy(events, spare, count * sizeof *events);
}

/* Adding 0 turns -0 into 0, the same plane. */
static RtKdEvent event_at(float plane, uint32_t type, uint32_t id) {
    return (RtKdEvent){plane + 0.0f, type + id};
}

/* Made in the order of `what`, which a stable sort by planes preserves for equal planes. */
uint32_t rt_kd_make_events(const uint32_t *ids, const RtBox *parts, uint32_t count, const RtBox *cell,
                           int axis, RtKdEvent *out, RtKdEvent *spare) {
    uint32_t n = 0;
    float first = cell->lo.at[axis], last = cell->hi.at[axis];
    for (uint32_t i = 0; i < count; i++) {
        float lo = parts[i].lo.at[axis], hi = parts[i].hi.at[axis];
        if (lo < hi && hi < last) out[n++] = event_at(hi, RT_KD_END, ids[i]);
    }
    for (uint32_t i = 0; i < count; i++) {
        float lo = parts[i].lo.at[axis], hi = parts[i].hi.at[axis];
        if (lo == hi) out[n++] = event_at(lo, RT_KD_PLANAR, ids[i]);
    }
    for (uint32_t i = 0; i < count; i++) {
        float lo = parts[i].lo.at[axis], hi = parts[i].hi.at[axis];
        if (lo < hi && lo > first) out[n++] = event_at(lo, RT_KD_START, ids[i]);
    }
    if (n <= SMALL)
        sort_by_insertion(out, n);
    else
        sort_by_radix(out, spare, n);
    return n;
}

/* From the back, so that nothing is overwritten before it is moved. */
void rt_kd_merge_events(RtKdEvent *events, uint32_t count, const RtKdEvent *more, uint32_t n) {
    for (uint32_t to = count + n; n > 0; to--) {
        bool old = count > 0 && before(more[n - 1], events[count - 1]);
        events[to - 1] = old ? events[--count] : more[--n];
    }
}
