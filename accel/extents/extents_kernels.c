/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes for many rays, RT_LANES at a time (accel/batch.h); compiled once for each instruction set
 * (accel/isa.h).
 *
 * The same tests: a lane does what rt_box_hit does, operation by operation. The limit enters that test only
 * in the last comparison, near <= min(far, limit). So all boxes of a vector are tested with the limit before
 * the first of them. A box that is hit is compared with the current limit again when its turn comes, by
 * ascending id; it then counts as hit exactly if rt_box_hit says so.
 *
 * The same counts: every box up to where a ray stops is a step and an extent test. */
#include "accel/batch.h"
#include "accel/isa.h"

enum { BOX = sizeof(RtBox) / sizeof(float) };

_Static_assert(BOX == 6, "a box is its coordinates, without gaps");

/* A ray, prepared for boxes in lanes. */
typedef struct Line {
    RtFloats tmin, org_near[3], org_far[3], inv[3];
    uint32_t first[3], last[3]; /* the rows of the sides that it crosses first, and last */
} Line;

RT_KERNEL void make_line(Line *line, const RtPreparedRay *ray) {
    line->tmin = rt_all(ray->tmin);
    for (int a = 0; a < 3; a++) {
        line->org_near[a] = rt_all(ray->org_near[a]);
        line->org_far[a] = rt_all(ray->org_far[a]);
        line->inv[a] = rt_all(ray->inv[a]);
        line->first[a] = ray->first[a] / (uint32_t)sizeof(float);
        line->last[a] = ray->last[a] / (uint32_t)sizeof(float);
    }
}

/* Bit i: rt_box_hit of box i; *enter: where the ray enters each box. */
RT_KERNEL uint32_t hit_boxes(const RtBlock *block, const Line *line, RtFloats limit, RtFloats *enter) {
    RtFloats near = line->tmin, far = limit;
    for (int a = 0; a < 3; a++) {
        RtFloats first = rt_load(block->row[line->first[a]]) - line->org_near[a];
        RtFloats second = rt_load(block->row[line->last[a]]) - line->org_far[a];
        near = rt_max(first * line->inv[a], near);
        far = rt_min(second * line->inv[a], far);
    }
    *enter = near;
    return rt_le_bits(near, far);
}

/* Reports the tests of boxes first..end-1 to the observer; `met`: the last is hit. Returns end. */
RT_COLD static uint32_t observe_tests(const RtGeometry *g, uint32_t first, uint32_t end, bool met) {
    for (uint32_t id = first; id < end; id++) {
        rt_observe(&(RtTraced){.kind = RT_TRACED_STEP, .what = "extent", .index = id});
        rt_observe(&(RtTraced){.kind = RT_TRACED_EXTENT_TEST,
                               .what = "extent",
                               .index = id,
                               .box = &g->boxes[id],
                               .met = met && id + 1 == end});
    }
    return end;
}

/* Tests boxes first..first+count-1, which are the chunk, and the objects in those that the ray meets; true
 * when the search is over. */
RT_KERNEL bool test_chunk(const RtBatch *batch, const RtGeometry *g, RtActiveRay *a, uint32_t first,
                          uint32_t count, bool any, RtTally *tally) {
    Line line;
    uint32_t reported = first;
    make_line(&line, &a->ray);
    RtFloats limit = rt_all(rt_limit(&a->ray, &a->best));
    for (uint32_t i = 0; i < count; i += RT_LANES) {
        float enter[RT_LANES];
        RtFloats near;
        uint32_t met = hit_boxes(&batch->chunk[i / RT_LANES], &line, limit, &near);
        if (!met) continue;
        if (count - i < RT_LANES) met &= (1u << (count - i)) - 1; /* lanes without a box */
        rt_store(enter, near);
        for (; met; met &= met - 1) {
            uint32_t lane = (uint32_t)__builtin_ctz(met), id = first + i + lane;
            if (!(enter[lane] <= rt_limit(&a->ray, &a->best))) continue;
            if (RT_OBSERVED(tally)) reported = observe_tests(g, reported, id + 1, true);
            if (!rt_test_object(g, id, &a->ray, any, &a->best, tally)) continue;
            RT_COUNT(tally, steps, id + 1);
            RT_COUNT(tally, extent_tests, id + 1);
            return true;
        }
        limit = rt_all(rt_limit(&a->ray, &a->best));
    }
    if (RT_OBSERVED(tally)) observe_tests(g, reported, first + count, false);
    return false;
}

/* Tests all boxes, chunk by chunk, and keeps the rays active whose search is not over. */
RT_KERNEL void test_all(RtBatch *batch, const RtGeometry *g, bool any, bool counted) {
    for (uint32_t first = 0, count; first < g->object_count && batch->active_count > 0; first += count) {
        uint32_t left = g->object_count - first, kept = 0;
        count = left > RT_CHUNK ? RT_CHUNK : left;
        rt_fill_chunk(batch, &g->boxes[first].lo.x, BOX, count);
        for (uint32_t i = 0; i < batch->active_count; i++) {
            RtActiveRay *a = &batch->rays[batch->active[i]];
            bool over = test_chunk(batch, g, a, first, count, any, counted ? a->tally : NULL);
            batch->active[kept] = batch->active[i];
            kept += !over;
        }
        batch->active_count = kept;
    }
    for (uint32_t i = 0; counted && i < batch->active_count; i++) {
        RtTally *tally = batch->rays[batch->active[i]].tally;
        RT_COUNT(tally, steps, g->object_count);
        RT_COUNT(tally, extent_tests, g->object_count);
    }
}

RT_DEFINE_BATCH_KERNELS(extents, test_all);
