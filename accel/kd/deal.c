/* SPDX-License-Identifier: Apache-2.0 */
/* Dealing the lists of a cell to its two children: one pass over each, in order, so that they stay sorted.
 *
 * The child with more objects keeps the place of its parent's lists, the other's come on top of them and are
 * divided first: so the stacks hold less than twice the root's lists, but for objects in both children.
 *
 * Events of an object that is in both children go into both, and an event beyond the cell is dropped, which
 * is all there is to cutting its box. With overlap=exact the object is cut itself instead: its events are
 * dropped, and those of its new parts merged in. */
#include "accel/kd/kd.h"

#include "core/base/memory.h"
#include "core/shape/overlap.h"

#include <string.h>

bool rt_kd_part(const RtKd *kd, uint32_t id, const RtBox *cell, RtBox *out) {
    const RtGeometry *g = &kd->base.scene->geometry;
    if (kd->surfaces) return rt_object_part(g, id, cell, kd->served.margin, out);
    *out = rt_box_common(g->boxes[id], *cell);
    return true;
}

/* sides[id]: bit c says that child c gets the object's events as they are, bit 2 + c that it lists it. */
enum { LOWER = 5, UPPER = 10, BOTH = 15, CUT_LOWER = 4, CUT_UPPER = 8 };

/* Without a branch: starts and ends come as if at random. */
static void set_unless(uint8_t *side, uint8_t to, bool not ) {
    uint8_t kept = (uint8_t) - not ;
    *side = (uint8_t)((*side & kept) | (to & ~kept));
}

static void mark_sides(const RtKdBuilder *b, const RtKdCell *cell, const RtKdSplit *split) {
    const RtKdEvent *events = b->events[split->axis] + cell->events[split->axis].from;
    const uint32_t *ids = b->ids + cell->ids.from;
    bool at_lo = split->plane == cell->box.lo.at[split->axis];
    bool at_hi = split->plane == cell->box.hi.at[split->axis];
    uint8_t usual = at_lo ? UPPER : at_hi ? LOWER : BOTH, flat = split->planar_upper ? UPPER : LOWER;
    for (uint32_t i = 0; i < cell->ids.count; i++) b->sides[ids[i]] = usual;
    for (uint32_t i = 0; i < cell->events[split->axis].count; i++) {
        RtKdEvent event = events[i];
        uint32_t type = rt_kd_event_type(event);
        uint8_t *side = &b->sides[rt_kd_event_object(event)];
        if (event.plane < split->plane) {
            set_unless(side, LOWER, type == RT_KD_START);
        } else if (event.plane > split->plane) {
            set_unless(side, UPPER, type == RT_KD_END);
        } else {
            *side = type == RT_KD_END ? LOWER : type == RT_KD_START ? UPPER : flat;
        }
    }
}

/* Makes the new parts of objects in both children; cut[c] of them are in child c. */
static RtStatus cut_objects(RtKdBuilder *b, const RtKdCell *cell, const RtKdCell children[2], uint32_t cut[2],
                            RtError *error) {
    const uint32_t *ids = b->ids + cell->ids.from;
    uint32_t most = 0;
    for (uint32_t i = 0; i < cell->ids.count; i++) most += b->sides[ids[i]] == BOTH;
    for (uint32_t c = 0; c < 2; c++) {
        RT_TRY(rt_reserve(&b->cut_ids[c], &b->cut_id_capacity[c], most, sizeof(uint32_t), error));
        RT_TRY(rt_reserve(&b->cut_parts[c], &b->cut_part_capacity[c], most, sizeof(RtBox), error));
    }
    RT_TRY(rt_reserve(&b->fresh, &b->fresh_capacity, 2 * (uint64_t)most, sizeof(RtKdEvent), error));
    RT_TRY(rt_reserve(&b->spare, &b->spare_capacity, 2 * (uint64_t)most, sizeof(RtKdEvent), error));
    for (uint32_t i = 0; i < cell->ids.count; i++) {
        uint32_t id = ids[i];
        if (b->sides[id] != BOTH) continue;
        b->sides[id] = 0;
        for (uint32_t c = 0; c < 2; c++) {
            if (!rt_kd_part(b->kd, id, &children[c].box, &b->cut_parts[c][cut[c]])) continue;
            b->sides[id] |= c == 0 ? CUT_LOWER : CUT_UPPER;
            b->cut_ids[c][cut[c]++] = id;
        }
    }
    return RT_OK;
}

static void deal_ids(const RtKdBuilder *b, const RtKdCell *cell, RtKdCell children[2], uint32_t above) {
    uint32_t *ids = b->ids + cell->ids.from, *to[2], count[2] = {0, 0};
    to[1 - above] = ids;
    to[above] = ids + cell->ids.count;
    for (uint32_t i = 0; i < cell->ids.count; i++) {
        uint32_t id = ids[i];
        for (uint32_t c = 0; c < 2; c++) {
            to[c][count[c]] = id;
            count[c] += b->sides[id] >> (2 + c) & 1;
        }
    }
    for (uint32_t c = 0; c < 2; c++) children[c].ids = (RtKdRun){cell->ids.from, count[c]};
    children[above].ids.from += count[1 - above];
    memmove(b->ids + children[above].ids.from, to[above], count[above] * sizeof(uint32_t));
}

/* Deals the events of an axis to `to`: along the split by where they are, else by whose they are. */
static void deal_events(const RtKdBuilder *b, const RtKdEvent *events, uint32_t n, const RtKdSplit *split,
                        bool along, RtKdEvent *to[2], uint32_t count[2]) {
    for (uint32_t i = 0; i < n; i++) {
        RtKdEvent event = events[i];
        uint32_t side = b->sides[rt_kd_event_object(event)];
        if (along) {
            bool flat = rt_kd_event_type(event) == RT_KD_PLANAR;
            if (!(event.plane < split->plane || flat)) side &= ~UINT32_C(1);
            if (!(event.plane > split->plane || flat)) side &= ~UINT32_C(2);
        }
        to[0][count[0]] = event;
        count[0] += side & 1;
        to[1][count[1]] = event;
        count[1] += side >> 1 & 1;
    }
}

static void deal_axis(const RtKdBuilder *b, const RtKdCell *cell, const RtKdSplit *split, int axis,
                      const uint32_t cut[2], RtKdCell children[2], uint32_t above) {
    RtKdRun run = cell->events[axis];
    RtKdEvent *to[2], *events = b->events[axis] + run.from;
    uint32_t count[2] = {0, 0};
    to[1 - above] = events;
    to[above] = events + run.count + (size_t)2 * cut[1 - above];
    deal_events(b, events, run.count, split, (int)split->axis == axis, to, count);
    for (uint32_t c = 0; c < 2; c++) {
        uint32_t n = rt_kd_make_events(b->cut_ids[c], b->cut_parts[c], cut[c], &children[c].box, axis,
                                       b->fresh, b->spare);
        rt_kd_merge_events(to[c], count[c], b->fresh, n);
        children[c].events[axis] = (RtKdRun){run.from, count[c] + n};
    }
    children[above].events[axis].from += children[1 - above].events[axis].count;
    memmove(b->events[axis] + children[above].events[axis].from, to[above],
            children[above].events[axis].count * sizeof(RtKdEvent));
}

RtStatus rt_kd_deal(RtKdBuilder *b, const RtKdCell *cell, const RtKdSplit *split, RtKdCell children[2],
                    uint32_t *above, RtError *error) {
    uint32_t cut[2] = {0, 0}, listed[2] = {0, 0};
    const uint32_t *ids = b->ids + cell->ids.from;
    for (uint32_t c = 0; c < 2; c++) {
        children[c].depth = cell->depth + 1;
        children[c].box = rt_kd_half(cell->box, split->axis, split->plane, c);
    }
    mark_sides(b, cell, split);
    if (b->kd->surfaces) RT_TRY(cut_objects(b, cell, children, cut, error));
    for (uint32_t i = 0; i < cell->ids.count; i++) {
        for (uint32_t c = 0; c < 2; c++) listed[c] += b->sides[ids[i]] >> (2 + c) & 1;
    }
    *above = listed[1] < listed[0];
    uint64_t room = cell->ids.from + 2 * (uint64_t)cell->ids.count + 1;
    RT_TRY(rt_reserve(&b->ids, &b->id_capacity, room, sizeof(uint32_t), error));
    deal_ids(b, cell, children, *above);
    for (int a = 0; a < 3; a++) {
        const RtKdRun *run = &cell->events[a];
        room = run->from + 2 * ((uint64_t)run->count + cut[0] + cut[1]) + 1;
        RT_TRY(rt_reserve(&b->events[a], &b->event_capacity[a], room, sizeof(RtKdEvent), error));
        deal_axis(b, cell, split, a, cut, children, *above);
    }
    return RT_OK;
}
