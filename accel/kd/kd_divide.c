/* SPDX-License-Identifier: Apache-2.0 */
/* Dividing a cell of a kd-tree where that is expected to cost less than testing all its objects.
 *
 * The split: every plane at which the part of an object begins, ends or lies is a candidate; one pass over
 * the events of each axis counts the objects below and above. Papers: MacDonald & Booth 1990 (the cost); Wald
 * & Havran 2006 (the sweep, planar objects on either side, the bonus for cutting off empty space).
 *
 * The lists: one pass over each partitions it in order, so it stays sorted. The larger child keeps the place
 * of its parent's lists; those of the smaller child go on top of them, and it is divided first. So the stacks
 * hold less than twice the root's lists, except for objects in both children. An object in both children has
 * its events in both, and events outside a cell are dropped, which clips its box. With overlap=exact the
 * object itself is clipped: its events are dropped, and those of its new parts are merged in. */
#include "accel/kd/kd.h"

#include "core/base/memory.h"

#include <float.h>
#include <string.h>

/* ---- events ---- */

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
                           int axis, RtKdEvent *out) {
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
        sort_by_radix(out, out + 2 * (size_t)count, n);
    return n;
}

/* Merges more[0..n) into events[0..count), which has room; both sorted. From the back, so that nothing is
 * overwritten before it is moved. */
static void merge_events(RtKdEvent *events, uint32_t count, const RtKdEvent *more, uint32_t n) {
    for (uint32_t to = count + n; n > 0; to--) {
        bool old = count > 0 && before(more[n - 1], events[count - 1]);
        events[to - 1] = old ? events[--count] : more[--n];
    }
}

/* ---- the split ---- */

/* The sweep along one axis of a cell; areas are half surfaces. */
typedef struct Sweep {
    double lo, hi, across, face; /* the area of a cell of this width is width * across + face */
    double visit;                /* cost of an inner node, times the area of the cell */
    double emptied;              /* factor for planes with an empty side */
    RtKdSplit best;
} Sweep;

static inline __attribute__((always_inline)) void consider(Sweep *s, float plane, int32_t below,
                                                           int32_t above, bool planar_upper) {
    double lower = ((double)plane - s->lo) * s->across + s->face;
    double upper = (s->hi - (double)plane) * s->across + s->face;
    double cost = s->visit + (below * lower + above * upper);
    if (below == 0 || above == 0) cost *= s->emptied;
    if (!(cost < s->best.cost)) return;
    s->best.cost = cost;
    s->best.plane = plane;
    s->best.planar_upper = planar_upper;
}

/* `planars` parts lie in the plane, `below` and `above` on its sides. A plane on a face of the cell cuts off
 * a flat cell with only the planar parts in it. */
static void consider_planars(Sweep *s, float plane, int32_t below, int32_t above, int32_t planars) {
    if ((double)plane == s->lo) {
        consider(s, plane, planars, above, false);
    } else if ((double)plane == s->hi) {
        consider(s, plane, below, planars, true);
    } else {
        consider(s, plane, below + planars, above, false);
        consider(s, plane, below, above + planars, true);
    }
}

/* An end is counted before its plane is considered, a start after. Among several events at one plane the last
 * end and the first start see the right counts; the others see more objects and cost no less. The order of
 * starts and ends is unpredictable, so they are counted without a branch. */
static void sweep(Sweep *s, const RtKdEvent *events, uint32_t count, uint32_t objects) {
    int32_t below = (int32_t)objects, above = (int32_t)objects;
    for (uint32_t i = 0; i < count; i++) below -= events[i].what >= RT_KD_PLANAR;
    for (uint32_t i = 0; i < count; i++) {
        RtKdEvent event = events[i];
        if (rt_kd_event_type(event) == RT_KD_PLANAR) {
            int32_t planars = 1;
            while (i + 1 < count && events[i + 1].plane == event.plane &&
                   rt_kd_event_type(events[i + 1]) == RT_KD_PLANAR) {
                planars++;
                i++;
            }
            above -= planars;
            consider_planars(s, event.plane, below, above, planars);
            below += planars;
        } else {
            bool start = event.what >= RT_KD_START;
            above -= !start;
            consider(s, event.plane, below, above, false);
            below += start;
        }
    }
}

static RtKdSplit find_split(const RtKdBuilder *b, const RtKdCell *cell) {
    RtVec3d size = rt_subd(rt_widen(cell->box.hi), rt_widen(cell->box.lo));
    Sweep s = {.visit = b->kd->traversal_cost * rt_box_half_area(cell->box),
               .emptied = 1 - b->kd->empty_bonus,
               .best = {.cost = INFINITY}};
    for (uint32_t a = 0; a < 3; a++) {
        if (!(size.at[a] > 0)) continue;
        double least = s.best.cost;
        s.lo = (double)cell->box.lo.at[a];
        s.hi = (double)cell->box.hi.at[a];
        s.across = size.at[(a + 1) % 3] + size.at[(a + 2) % 3];
        s.face = size.at[(a + 1) % 3] * size.at[(a + 2) % 3];
        sweep(&s, b->events[a] + cell->events[a].from, cell->events[a].count, cell->ids.count);
        if (s.best.cost < least) s.best.axis = a;
    }
    return s.best;
}

/* ---- the lists ---- */

/* sides[id]: bit c: child c gets the object's events unchanged; bit 2 + c: child c lists the object. */
enum { LOWER = 5, UPPER = 10, BOTH = 15, CLIPPED_LOWER = 4, CLIPPED_UPPER = 8 };

/* Branchless: the order of starts and ends is unpredictable. */
static void set_unless(uint8_t *side, uint8_t to, bool not ) {
    uint8_t kept = (uint8_t) - not ;
    *side = (uint8_t)((*side & kept) | (to & ~kept));
}

static void classify(const RtKdBuilder *b, const RtKdCell *cell, const RtKdSplit *split) {
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
        if (event.plane < split->plane)
            set_unless(side, LOWER, type == RT_KD_START);
        else if (event.plane > split->plane)
            set_unless(side, UPPER, type == RT_KD_END);
        else
            *side = type == RT_KD_END ? LOWER : type == RT_KD_START ? UPPER : flat;
    }
}

/* Clips the objects that are in both children; cut[c] parts are in child c. */
static RtStatus clip_objects(RtKdBuilder *b, const RtKdCell *cell, const RtKdCell children[2],
                             uint32_t cut[2], RtError *error) {
    const uint32_t *ids = b->ids + cell->ids.from;
    uint32_t most = 0;
    for (uint32_t i = 0; i < cell->ids.count; i++) most += b->sides[ids[i]] == BOTH;
    for (uint32_t c = 0; c < 2; c++) {
        RT_TRY(rt_reserve(&b->cut_ids[c], &b->cut_id_capacity[c], most, sizeof(uint32_t), error));
        RT_TRY(rt_reserve(&b->cut_parts[c], &b->cut_part_capacity[c], most, sizeof(RtBox), error));
    }
    RT_TRY(rt_reserve(&b->fresh, &b->fresh_capacity, 4 * (uint64_t)most, sizeof(RtKdEvent), error));
    for (uint32_t i = 0; i < cell->ids.count; i++) {
        uint32_t id = ids[i];
        if (b->sides[id] != BOTH) continue;
        b->sides[id] = 0;
        for (uint32_t c = 0; c < 2; c++) {
            if (!rt_kd_part(b->kd, id, &children[c].box, &b->cut_parts[c][cut[c]])) continue;
            b->sides[id] |= c == 0 ? CLIPPED_LOWER : CLIPPED_UPPER;
            b->cut_ids[c][cut[c]++] = id;
        }
    }
    return RT_OK;
}

static void partition_ids(const RtKdBuilder *b, const RtKdCell *cell, RtKdCell children[2], uint32_t above) {
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

/* Partitions the events of an axis to `to`: along the split by position, otherwise by object. */
static void partition_events(const RtKdBuilder *b, const RtKdEvent *events, uint32_t n,
                             const RtKdSplit *split, bool along, RtKdEvent *to[2], uint32_t count[2]) {
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

static void partition_axis(const RtKdBuilder *b, const RtKdCell *cell, const RtKdSplit *split, int axis,
                           const uint32_t cut[2], RtKdCell children[2], uint32_t above) {
    RtKdRun run = cell->events[axis];
    RtKdEvent *to[2], *events = b->events[axis] + run.from;
    uint32_t count[2] = {0, 0};
    to[1 - above] = events;
    to[above] = events + run.count + (size_t)2 * cut[1 - above];
    partition_events(b, events, run.count, split, (int)split->axis == axis, to, count);
    for (uint32_t c = 0; c < 2; c++) {
        uint32_t n =
            rt_kd_make_events(b->cut_ids[c], b->cut_parts[c], cut[c], &children[c].box, axis, b->fresh);
        merge_events(to[c], count[c], b->fresh, n);
        children[c].events[axis] = (RtKdRun){run.from, count[c] + n};
    }
    children[above].events[axis].from += children[1 - above].events[axis].count;
    memmove(b->events[axis] + children[above].events[axis].from, to[above],
            children[above].events[axis].count * sizeof(RtKdEvent));
}

/* Partitions the lists of `cell`, the topmost, to children[0], the lower, and children[1]; their nodes are
 * set later. *above is the child whose lists lie on top of the other's. */
static RtStatus partition(RtKdBuilder *b, const RtKdCell *cell, const RtKdSplit *split, RtKdCell children[2],
                          uint32_t *above, RtError *error) {
    uint32_t cut[2] = {0, 0}, listed[2] = {0, 0};
    const uint32_t *ids = b->ids + cell->ids.from;
    for (uint32_t c = 0; c < 2; c++) {
        children[c].depth = cell->depth + 1;
        children[c].box = rt_kd_half(cell->box, split->axis, split->plane, c);
    }
    classify(b, cell, split);
    if (b->kd->surfaces) RT_TRY(clip_objects(b, cell, children, cut, error));
    for (uint32_t i = 0; i < cell->ids.count; i++) {
        for (uint32_t c = 0; c < 2; c++) listed[c] += b->sides[ids[i]] >> (2 + c) & 1;
    }
    *above = listed[1] < listed[0];
    uint64_t needed = cell->ids.from + 2 * (uint64_t)cell->ids.count + 1;
    RT_TRY(rt_reserve(&b->ids, &b->id_capacity, needed, sizeof(uint32_t), error));
    partition_ids(b, cell, children, *above);
    for (int a = 0; a < 3; a++) {
        const RtKdRun *run = &cell->events[a];
        needed = run->from + 2 * ((uint64_t)run->count + cut[0] + cut[1]) + 1;
        RT_TRY(rt_reserve(&b->events[a], &b->event_capacity[a], needed, sizeof(RtKdEvent), error));
        partition_axis(b, cell, split, a, cut, children, *above);
    }
    return RT_OK;
}

/* ---- the memory limit ---- */

static uint64_t bytes_of(uint64_t nodes, uint64_t ids) {
    return nodes * sizeof(RtKdNode) + ids * sizeof(uint32_t);
}

/* The bytes so far of the tree cut off at `depth`; *estimate extrapolates them to the whole tree. */
static uint64_t bytes_down_to(const RtKdMemory *memory, uint32_t depth, double *estimate) {
    const RtKdLevel *levels = memory->levels;
    uint64_t nodes = levels[depth].nodes, ids = levels[depth].ids;
    double share = levels[depth].share;
    for (uint32_t d = 0; d < depth; d++) {
        nodes += levels[d].nodes;
        ids += levels[d].leaf_ids;
        share += levels[d].leaf_share;
    }
    *estimate = (double)bytes_of(nodes, ids) / fmax(share, DBL_MIN);
    return bytes_of(nodes, ids);
}

/* Counts a cell; lowers max_depth where the tree would exceed the limit. */
static void count_cell(RtKdBuilder *b, const RtKdCell *cell, bool leaf) {
    RtKdMemory *memory = b->memory;
    RtKdLevel *level = &memory->levels[cell->depth];
    level->nodes++;
    level->ids += cell->ids.count;
    level->share += cell->share;
    level->leaf_ids += leaf ? cell->ids.count : 0;
    level->leaf_share += leaf ? cell->share : 0;
    memory->bytes += bytes_of(1, leaf ? cell->ids.count : 0);
    if (memory->shared) rt_kd_hold(memory->shared, bytes_of(1, leaf ? cell->ids.count : 0));
    if (memory->bytes <= memory->limit) return;
    double estimate;
    bytes_down_to(memory, b->kd->max_depth, &estimate);
    if (memory->estimate == 0) memory->estimate = estimate;
    while (b->kd->max_depth > 0 && (memory->bytes > memory->limit || estimate > (double)memory->limit))
        memory->bytes = bytes_down_to(memory, --b->kd->max_depth, &estimate);
}

/* ---- nodes ---- */

static RtStatus make_leaf(RtKdBuilder *b, const RtKdCell *cell, RtError *error) {
    RtKd *kd = b->kd;
    uint64_t needed = (uint64_t)kd->id_count + cell->ids.count;
    count_cell(b, cell, true);
    if (b->memory->estimate > 0) return RT_OK;
    RT_TRY(rt_reserve(&kd->ids, &b->leaf_id_capacity, needed, sizeof(uint32_t), error));
    kd->nodes[cell->node] = (RtKdNode){.first = kd->id_count, .link = cell->ids.count << 2 | RT_KD_LEAF};
    if (cell->ids.count > 0)
        memcpy(kd->ids + kd->id_count, b->ids + cell->ids.from, cell->ids.count * sizeof(uint32_t));
    kd->id_count += cell->ids.count;
    return RT_OK;
}

static RtStatus make_inner(RtKdBuilder *b, const RtKdCell *cell, const RtKdSplit *split, uint32_t failures,
                           RtError *error) {
    RtKd *kd = b->kd;
    RtKdCell children[2];
    uint32_t above, child = kd->node_count;
    count_cell(b, cell, false);
    if (b->memory->estimate == 0) {
        RT_TRY(rt_reserve(&kd->nodes, &b->node_capacity, (uint64_t)child + 2, sizeof(RtKdNode), error));
        kd->nodes[cell->node] = (RtKdNode){.split = split->plane, .link = child << 2 | split->axis};
        kd->node_count += 2;
    }
    RT_TRY(partition(b, cell, split, children, &above, error));
    double sum = fmax((double)children[0].ids.count + children[1].ids.count, 1);
    for (uint32_t c = 0; c < 2; c++) {
        children[c].node = child + c;
        children[c].failures = failures;
        children[c].share = cell->share * children[c].ids.count / sum;
    }
    b->pending[b->pending_count++] = children[1 - above];
    b->pending[b->pending_count++] = children[above];
    return RT_OK;
}

RtStatus rt_kd_divide(RtKdBuilder *b, const RtKdCell *cell, RtError *error) {
    const RtKd *kd = b->kd;
    if (cell->depth > kd->max_depth) return RT_OK; /* max_depth has been lowered */
    if (cell->ids.count <= kd->max_leaf_size || cell->depth == kd->max_depth)
        return make_leaf(b, cell, error);
    RtKdSplit split = find_split(b, cell);
    bool saves = split.cost < cell->ids.count * rt_box_half_area(cell->box);
    if (!saves && (split.cost == INFINITY || cell->failures == kd->failures))
        return make_leaf(b, cell, error);
    return make_inner(b, cell, &split, cell->failures + !saves, error);
}

void rt_kd_clear(RtKdBuilder *b) {
    RtKdBuilder cleared = {.kd = b->kd, .memory = b->memory};
    for (int a = 0; a < 3; a++) rt_free(b->events[a]);
    for (int c = 0; c < 2; c++) {
        rt_free(b->cut_ids[c]);
        rt_free(b->cut_parts[c]);
    }
    rt_free(b->ids);
    rt_free(b->sides);
    rt_free(b->fresh);
    *b = cleared;
}
