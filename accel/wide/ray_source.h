/* SPDX-License-Identifier: Apache-2.0 */
/* The rays of a query in the order in which they start, after a filter.
 *
 * Many rays miss every child of the root: most that leave a closed shape, and many random chords. The filter
 * tests RT_LANES rays at once with the children of the root, before any ray is sorted or prepared. Rejected
 * rays are answered; only the others start. Where few rays are rejected, the filter passes most blocks of
 * rays untested.
 *
 * Exact: a ray is tested by the operations of rt_box_hit with the thickness of the traversal, so a rejected
 * ray would visit no child. Choosing a plane by the sign of a direction is replaced by a minimum and a
 * maximum, because lo - (org + shift) <= hi - (org - shift), also rounded. Rays with an infinite reciprocal
 * or an extreme direction always start. */
#ifndef RT_ACCEL_WIDE_RAY_SOURCE_H
#define RT_ACCEL_WIDE_RAY_SOURCE_H

#include "accel/kernel.h"
#include "accel/surface.h"
#include "accel/wide/wide.h"
#include "core/base/simd_across.h"

enum {
    FILTER_BLOCK = 256, /* rays that are filtered together */
    FILTER_PAUSE = 31   /* blocks that pass untested after one of which few rays were rejected */
};

typedef struct RaySource {
    size_t next, end;                        /* rays of the query that are in no block yet */
    uint32_t taken, count;                   /* rays of the block that have started, and all that start */
    uint32_t *pause;                         /* blocks until the filter is tried again; NULL: no filter */
    uint32_t index[FILTER_BLOCK + RT_LANES]; /* [count], in the query; whole vectors are written */
} RaySource;

/* A stream of rays, and where the answers go. */
typedef struct Query {
    const RtWide *self;
    const RtWideTree *tree;
    const RtGeometry *geometry;
    const RtScratch *scratch;
    const RtRay *rays;
    RtHit *hits;         /* of `nearest` */
    uint32_t *occluders; /* of `occluded` */
    RtTally *tallies;    /* of the counted kernels */
    RaySource *source;
} Query;

/* ---- lanes of rays ---- */

/* The thickness by rt_ray_prepare_in. */
RT_KERNEL RtFloats thickness_of(const RtFloats org[3], const RtGeometry *g) {
    RtFloats farthest = rt_all(0);
    for (int a = 0; a < 3; a++) {
        farthest = rt_max(rt_abs(g->box.lo.at[a] - org[a]), farthest);
        farthest = rt_max(rt_abs(g->box.hi.at[a] - org[a]), farthest);
    }
    return farthest * 0x1p-20f;
}

RT_KERNEL RtFloats shift_of(RtFloats thickness, RtFloats org) {
    return thickness + rt_abs(org) * 0x1p-23f;
}

/* rt_surface_is_near of rays in lanes. */
RT_KERNEL RtInts surface_is_near(RtFloats longest) {
    longest = rt_abs(longest);
    return (longest >= RT_SURFACE_LEAST_DIR) & (longest <= RT_SURFACE_MOST_DIR);
}

/* ---- the filter ---- */

/* RT_LANES rays, prepared for tests of boxes. */
typedef struct RayLanes {
    RtFloats above[3], below[3], inv[3]; /* org + shift, org - shift, 1 / dir */
    RtFloats tmin, tmax;
} RayLanes;

RT_KERNEL RtInts meet_box(const RayLanes *r, RtBox box) {
    RtFloats near = r->tmin, far = r->tmax;
    for (int a = 0; a < 3; a++) {
        RtFloats lo = (box.lo.at[a] - r->above[a]) * r->inv[a];
        RtFloats hi = (box.hi.at[a] - r->below[a]) * r->inv[a];
        near = rt_max(rt_min(lo, hi), near);
        far = rt_min(rt_max(lo, hi), far);
    }
    return near <= far;
}

/* Bit i: rays[i] may meet a child of the root. Most groups of rays that leave the scene miss its box. */
RT_KERNEL uint32_t meet_root(const Query *q, const RtRay rays[RT_LANES]) {
    const RtWideNode *root = rt_wide_node(q->tree, 0);
    const float *at_org[RT_LANES], *at_dir[RT_LANES];
    RtFloats org[4], dir[4]; /* then tmin, tmax */
    for (int i = 0; i < RT_LANES; i++) {
        at_org[i] = rays[i].org.at;
        at_dir[i] = rays[i].dir.at;
    }
    rt_load_columns(at_org, org);
    rt_load_columns(at_dir, dir);
    RayLanes r = {.tmin = org[3], .tmax = rt_min(dir[3], rt_all(FLT_MAX))};
    const RtFloats thickness = thickness_of(org, q->geometry);
    const RtFloats longest = rt_max(rt_max(rt_abs(dir[0]), rt_abs(dir[1])), rt_abs(dir[2]));
    RtInts met = ~surface_is_near(longest); /* or special */
    for (int a = 0; a < 3; a++) {
        RtFloats shift = shift_of(thickness, org[a]);
        r.above[a] = org[a] + shift;
        r.below[a] = org[a] - shift;
        r.inv[a] = 1 / dir[a];
        met |= ~(rt_abs(r.inv[a]) <= FLT_MAX);
    }
    if (rt_bits(met | meet_box(&r, q->geometry->box)) == 0) return 0;
    for (uint32_t c = 0; c < root->count && rt_bits(~met); c++)
        met |= meet_box(&r, rt_wide_child_box(root, c));
    return rt_bits(met);
}

/* Answers a block of rays with a miss until they are traced. */
RT_KERNEL void miss_all(const Query *q, size_t first, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        if (q->hits) q->hits[first + i] = RT_MISS;
        if (q->occluders) q->occluders[first + i] = RT_NO_OBJECT;
    }
}

/* Fills the next block; it may be empty. A function of its own for all kinds of kernels. */
static __attribute__((noinline)) void filter_block(const Query *q, RaySource *s) {
    const uint32_t first = (uint32_t)s->next;
    const uint32_t count = s->end - s->next < FILTER_BLOCK ? (uint32_t)(s->end - s->next) : FILTER_BLOCK;
    const bool tests = s->pause && *s->pause == 0;
    uint32_t i = 0;
    s->next += count;
    s->taken = s->count = 0;
    if (tests) miss_all(q, first, count);
    for (; i < count; i += RT_LANES) {
        const bool whole = count - i >= RT_LANES;
        uint32_t bits = tests && whole ? meet_root(q, &q->rays[first + i]) : (1u << RT_LANES) - 1;
        rt_compress_store(&s->index[s->count], bits, rt_lane_numbers() + (int32_t)(first + i));
        s->count += whole ? (uint32_t)__builtin_popcount(bits) : count - i;
    }
    if (!s->pause) return;
    if (!tests)
        --*s->pause;
    else if ((count - s->count) * RT_LANES < 3 * count) /* testing a ray takes 1 / RT_LANES */
        *s->pause = FILTER_PAUSE;
}

/* Whether more rays are to be started: source->index[taken] is the next. */
RT_KERNEL bool more_rays(const Query *q) {
    RaySource *s = q->source;
    while (s->taken == s->count && s->next < s->end) filter_block(q, s);
    return s->taken < s->count;
}

#endif
