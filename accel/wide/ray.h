/* SPDX-License-Identifier: Apache-2.0 */
/* The rays of a query in a wide hierarchy: the order in which they start, after a filter; the state of one,
 * and its visits of nodes and leaves.
 *
 * The filter. Many rays miss every child of the root: most that leave a closed shape, and many random chords.
 * RT_LANES rays at once are tested with the children of the root, before any ray is sorted or prepared.
 * Rejected rays are answered; only the others start. Where few rays are rejected, most blocks of rays pass
 * untested. Exact: a ray is tested by the operations of rt_box_hit with the thickness of the traversal, so a
 * rejected ray would visit no child. Choosing a plane by the sign of a direction is replaced by a minimum and
 * a maximum, because lo - (org + shift) <= hi - (org - shift), also rounded. Rays with an infinite reciprocal
 * or an extreme direction always start.
 *
 * Sure hits. rt_triangle_hit ends with raytally_admit4, which clamps t to the interval [near, far] of the
 * triangle's own thick box. Hits at |t| >= RayState.sure omit it: near <= t <= far holds there, so only tmin
 * <= t <= tmax is left. Proof. Let e = 2^-24; d = dir, z = kz, x another axis; o = org; D the largest
 * distance along one axis from o to a plane of the box; t > 0. Float32 is relatively exact to e throughout,
 * because 2^-64 <= |d_z| <= 2^64 and t |d_z| >= 2^-60 (both within a rounding), so t >= 2^-125 and D >=
 * 2^-61.
 *
 * 1. Let P be the vertices, relative to o, averaged by the edge functions in double. They have one sign, so P
 * is in the box. Each has a relative error of 2^-53, so the sheared x average to 0 within 2^-51 D. A sheared
 * x is off by 7 e D: e D of v - o, 4 e D of the product, since |d_x| <= |d_z|, and 2 e D of the difference.
 * So |P_x - P_z d_x / d_z| <= 7 e D. Rounding z and t gives |t d_z - P_z| <= 2 e D. Thus |t d_x - P_x| <= 9 e
 * D, up to 2^-40 D here and below for products of errors.
 * 2. Let d_x have no sign bit; otherwise mirror. The shifted origins are at least 16 e D (1 - 4 e) from o,
 * because raytally_shift4 compensates their rounding. Let N = lo - (o + shift), so N <= P_x - 16 e D <= t d_x
 * - 7 e D. If N <= 0, the crossing is at most 0 < t, or NaN, which is ignored. If N > 0, then d_x > 7 e D / t
 * > e |d_z| >= 2^-88, so 1 / d_x is accurate. N and 1 / d_x have one rounding each, so their product is at
 * most t (1 + 2 e) - 7 e D / d_x < t, since t d_x <= D (1 + 3 e). Rounding is monotone and t a float32
 * number: the crossing is at most t.
 * 3. Let M = hi - (o - shift) >= t d_x + 7 e D. Two roundings take at most 2 e of it, so the crossing is at
 * least t, or infinite.
 * 4. If t < 0, negate t and dir: near and far become -far and -near, bit for bit.
 *
 * Fused box tests. One ray alone computes a crossing as p inv - at, rounded once, where at = o' inv is
 * rounded before, in place of (p - o') inv; o' is the shifted origin. That is done for scenes of triangles,
 * not split, with a side S >= 2^-29 and no coordinate beyond 2^20 S, and for rays with 2^-40 <= |inv| <= 2^40
 * on each axis. No hit is lost: near <= t <= far in each box around its triangle. Proof, in the terms above.
 *
 * 1. D >= S / 2 >= 2^-30, and |o| <= 2^20 S + D < 2^22 D. Rounding `at` moves the origin by e |o'|, or less
 * than 2^-109 if `at` underflows. Of the 2 e |o| in a shift, o' itself takes e |o'|, so this takes the rest.
 * Second-order terms, 6 e^2 |o| < 1.5 e D, are missing. So o'' = at / inv is still at least 14.4 e D from o.
 * 2. Where |t| >= sure: steps 2 and 3 with N = lo - o'' <= t d_x - 5.4 e D. N is not rounded, since the fused
 * operation is exact until its end; there remain the roundings of inv and of the result.
 * 3. Where |t| < sure, |P_z| <= 2^-59, so |P_x| <= 7 e D + 2^-59 on each axis, and N <= -7 e D < 0: near is
 * tmin. M >= 7 e D >= 2^-52, and far >= 2^-53 inv. The final t is at most the first, or where the triangle's
 * own thick box begins. With its own D', which may be tiny, that is at (P_y - 16 e D') inv_y <= t (1 + 5 e) +
 * 2^-149 inv_y, the last for underflow. So t d_x <= 2^-58 + 2^-149 2^80 < 2^-53. */
#ifndef RT_ACCEL_WIDE_RAY_H
#define RT_ACCEL_WIDE_RAY_H

#include "accel/sphere_pairs.h"
#include "accel/watertight.h"
#include "accel/wide/wide.h"
#include "core/base/memory.h"
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

typedef struct RayState RayState;

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
    RayState *states; /* [self->in_flight] */
} Query;

/* ---- lanes of rays ---- */

/* rt_dir_is_ordinary of rays in lanes. */
RT_KERNEL RtInts dirs_are_ordinary(RtFloats longest) {
    longest = rt_abs(longest);
    return (longest >= RT_ORDINARY_LEAST_DIR) & (longest <= RT_ORDINARY_MOST_DIR);
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
    const RtFloats thickness = rt_lanes_thickness(org, &q->geometry->box);
    const RtFloats longest = rt_max(rt_max(rt_abs(dir[0]), rt_abs(dir[1])), rt_abs(dir[2]));
    RtInts met = ~dirs_are_ordinary(longest); /* or special */
    for (int a = 0; a < 3; a++) {
        RtFloats shift = rt_lanes_shift(thickness, org[a]);
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

/* ---- the state of a ray ---- */

/* A vector of eight may be written above the top. */
enum { RT_WIDE_STACK = RT_TREE_MAX_DEPTH * (RT_WIDE - 1) + 2 * RT_WIDE };

/* Bytes from a plane of a node to the next, and from a coordinate of a block to the next. */
enum { PLANE = RT_WIDE * sizeof(float), COORDINATE = RT_WIDE_BLOCK * sizeof(float) };

struct RayState {
    /* Arrays of four have an element more than axes, for vectors. */
    _Alignas(RT_CACHE_LINE) float inv[4]; /* this, and what follows, as in RtPreparedRay */
    float org_near[4], org_far[4];
    uint32_t near[4], far[4]; /* for each axis the offsets in a node of the planes crossed first and last */
    float tmin, limit;        /* limit: the best t so far, or tmax */
    RtWideRef next;           /* what it visits next */
    uint32_t top;             /* entries of the stack */
    uint32_t at[3];           /* for kx, ky and kz the offset in a block of a vertex's coordinate, */
    float org[3];             /* and the origin */
    float shear_x, shear_y, major; /* major: dir along kz */
    float sure; /* triangles hit at this |t| or more are hit within their own thick boxes (see above) */
    float tmax;
    bool prepared; /* `ray` is */
    RtHit best;
    size_t index;               /* in the stream */
    RtTally *tally;             /* NULL in the timed kernels */
    float enter[RT_WIDE_STACK]; /* the stack, its top last; at the bottom RT_WIDE_DONE */
    RtWideRef stack[RT_WIDE_STACK];
    RtPreparedRay ray; /* for hit functions */
    char apart[RT_CACHE_LINE];
};

_Static_assert(sizeof(RayState) == RT_WIDE_STATE_BYTES, "the build allocates states");

/* States in an array would compete for the same lines of the cache. */
_Static_assert(sizeof(RayState) % 4096 >= RT_CACHE_LINE, "states do not lie pages apart");

/* Floats from a vertex of a triangle in a block to the next. */
enum { VERTEX = 3 * RT_WIDE_BLOCK };

/* Objects tested one by one: functions of their own, which are not inlined, to save compile time. */
static __attribute__((noinline)) bool object_timed(const RtGeometry *g, uint32_t id, const RtPreparedRay *ray,
                                                   bool any, RtHit *best) {
    return rt_test_object(g, id, ray, any, best, NULL);
}

static __attribute__((noinline)) bool object_counted(const RtGeometry *g, uint32_t id,
                                                     const RtPreparedRay *ray, bool any, RtHit *best,
                                                     RtTally *tally) {
    return rt_test_object(g, id, ray, any, best, tally);
}

RT_KERNEL bool test_object(const RtGeometry *g, uint32_t id, const RtPreparedRay *ray, bool any, RtHit *best,
                           RtTally *tally) {
    return tally ? object_counted(g, id, ray, any, best, tally) : object_timed(g, id, ray, any, best);
}

/* The ray of a state, prepared for hit functions. */
RT_KERNEL const RtPreparedRay *state_ray(RayState *f, const Query *q) {
    if (!f->prepared) rt_hit_ray(&f->ray, q->geometry, &q->rays[f->index], q->scratch->hit_memory);
    f->prepared = true;
    return &f->ray;
}

/* Prepares a ray for leaves. */
RT_KERNEL void init_leaves(RayState *f, const RtRay *ray) {
    const int kz = rt_major_axis(ray->dir), kx = rt_next_axis(kz), ky = rt_next_axis(kx), k[3] = {kx, ky, kz};
    for (int i = 0; i < 3; i++) {
        f->at[i] = (uint32_t)k[i] * COORDINATE;
        f->org[i] = ray->org.at[k[i]];
    }
    f->shear_x = ray->dir.at[kx] * f->inv[kz];
    f->shear_y = ray->dir.at[ky] * f->inv[kz];
    f->major = ray->dir.at[kz];
    f->sure = rt_dir_is_ordinary(f->major) ? 0x1p-60f * fabsf(f->inv[kz]) : INFINITY;
}

/* Prepares a ray for the root, and if `whole` for leaves. False if it is answered already: the tree is empty,
 * or the ray is too extreme for the boxes of split references and was tested against all objects. */
RT_KERNEL bool init_ray(RayState *f, const Query *q, size_t index, bool any, bool whole, RtTally *tally) {
    const RtRay *ray = &q->rays[index];
    /* The loads rely on the layout of RtRay: org, tmin, dir, tmax. */
    const RtFloat4 org = rt_loadu4(ray), dir = rt_loadu4((const char *)ray + offsetof(RtRay, dir));
    const RtFloat4 inv = 1 / dir;
    f->best = RT_MISS;
    f->index = index;
    f->tally = tally;
    f->prepared = false;
    if (q->tree->node_count == 0) return false;
    if (q->tree->split_refs && !rt_dir_is_ordinary(ray->dir.at[rt_major_axis(ray->dir)])) {
        rt_test_all(q->geometry, state_ray(f, q), any, &f->best, tally);
        return false;
    }
    const RtInt4 lo = {0, 2 * PLANE, 4 * PLANE}, down = ((RtInt4)dir < 0) & PLANE;
    const RtInt4 near = lo + down, far = lo + PLANE - down;
    memcpy(f->inv, &inv, sizeof f->inv);
    raytally_thicken(org, dir, rt_public_box(&q->geometry->box), f->org_near, f->org_far);
    memcpy(f->near, &near, sizeof f->near);
    memcpy(f->far, &far, sizeof f->far);
    f->tmin = ray->tmin;
    f->limit = f->tmax = rt_minf(ray->tmax, FLT_MAX);
    if (whole) init_leaves(f, ray);
    f->enter[0] = -INFINITY;
    f->stack[0] = RT_WIDE_DONE;
    f->top = 1;
    return true;
}

RT_KERNEL void prefetch(const RtWideTree *tree, RtWideRef ref) {
    const char *at = (const char *)rt_wide_node(tree, ref); /* of a leaf, some bytes into it: the same line */
    for (size_t i = 0; i < sizeof(RtWideNode); i += RT_CACHE_LINE) __builtin_prefetch(at + i, 0, 3);
}

/* ---- nodes ---- */

RT_KERNEL RtFloat8 planes(const RtWideNode *node, uint32_t offset) {
    return rt_load8((const char *)node + offset);
}

/* The mask of children that the ray hits, by rt_box_hit in eight lanes; *enter: where it enters each. */
RT_KERNEL uint32_t hit_children(const RtWideNode *node, const RayState *f, RtFloat8 *enter) {
    RtFloat8 near = rt_all8(f->tmin), far = rt_all8(f->limit);
    for (uint32_t a = 0; a < 3; a++) {
        near = rt_max((planes(node, f->near[a]) - f->org_near[a]) * f->inv[a], near);
        far = rt_min((planes(node, f->far[a]) - f->org_far[a]) * f->inv[a], far);
    }
    *enter = near;
    return rt_le_bits(near, far);
}

/* A node has no box of its own; the boxes of its children are tested together. */
RT_COLD static void observe_node(const RtWideNode *node, RtWideRef ref, uint32_t mask) {
    RtBox all = rt_wide_children_box(node);
    rt_observe(&(RtTraced){.kind = RT_TRACED_STEP, .what = "node", .index = rt_wide_place(ref), .box = &all});
    for (uint32_t i = 0; i < node->count; i++) {
        bool leaf = rt_wide_kind(node->child[i]) != RT_WIDE_NODE;
        RtBox box = rt_wide_child_box(node, i);
        rt_observe(&(RtTraced){.kind = RT_TRACED_EXTENT_TEST,
                               .what = leaf ? "leaf" : "node",
                               .index = rt_wide_place(node->child[i]),
                               .box = &box,
                               .met = mask >> i & 1});
    }
}

/* The lane of a mask with the least entry, ignoring its last three bits; any lane if the mask is empty.
 * Entries are at least 0, so they compare like their bits. */
RT_KERNEL uint32_t least_lane(uint32_t mask, RtInt8 enter) {
    const RtInt8 lanes = {0, 1, 2, 3, 4, 5, 6, 7};
    RtFloat8 key = (RtFloat8)rt_select_bits8(mask, (enter & ~7) | lanes, rt_all_ints8(INT32_MAX));
    RtInt4 least = rt_min((RtInt4)rt_lower4(key), (RtInt4)rt_upper4(key));
    least = rt_min(least, __builtin_shufflevector(least, least, 2, 3, 0, 1));
    least = rt_min(least, __builtin_shufflevector(least, least, 1, 0, 3, 2));
    return (uint32_t)least[0] & 7;
}

/* The child to visit next: the nearest, or without order the last; any if the mask is empty. */
RT_KERNEL uint32_t choose_child(uint32_t mask, RtFloat8 enter, bool ordered) {
    return ordered ? least_lane(mask, (RtInt8)enter) : 31 - (uint32_t)__builtin_clz(mask | 1);
}

/* Pushes the children of a mask; the caller raises the top. */
RT_KERNEL void push(RayState *f, uint32_t top, const RtWideNode *node, uint32_t mask, RtFloat8 enter,
                    bool any) {
    RtOrder8 order = rt_order8(mask);
    if (!any) rt_store(&f->enter[top], rt_compress8(order, (RtInt8)enter));
    rt_store(&f->stack[top], rt_compress8(order, rt_load_ints8(node->child)));
}

/* Returns one child of the mask and pushes the others; if there is none, pops the stack. Without a branch,
 * because it would be unpredictable. */
RT_KERNEL RtWideRef descend(RayState *f, const RtWideNode *node, uint32_t mask, RtFloat8 enter, bool ordered,
                            bool any) {
    uint32_t top = f->top, lane = choose_child(mask, enter, ordered), others = mask & ~(1u << lane);
    RtWideRef popped = f->stack[top - 1], child = node->child[lane];
    push(f, top, node, others, enter, any);
    f->top = top + (uint32_t)__builtin_popcount(others) - (mask == 0);
    return mask == 0 ? popped : child;
}

/* ---- leaves ---- */

RT_KERNEL RtFloat4 coordinate(const RtWideTriangles *block, int vertex, uint32_t offset) {
    return rt_load4((const char *)block->v[vertex] + offset);
}

RT_KERNEL RtSheared4 shear(const RtWideTriangles *block, const RayState *f) {
    const RtShear4 ray = {rt_all4(f->org[0]), rt_all4(f->org[1]), rt_all4(f->org[2]), rt_all4(f->shear_x),
                          rt_all4(f->shear_y)};
    const uint32_t *at = f->at;
    RtSheared4 s;
    for (int i = 0; i < 3; i++) {
        s.x[i] = coordinate(block, i, at[0]);
        s.y[i] = coordinate(block, i, at[1]);
        s.z[i] = coordinate(block, i, at[2]);
    }
    rt_shear4(&ray, &s);
    return s;
}

/* Bit i: triangle i of a block passes the edge-function prefilter. */
RT_KERNEL uint32_t prefilter_block(const RtWideTriangles *block, const RayState *f) {
    const RtSheared4 s = shear(block, f);
    return rt_edge_prefilter4(&s);
}

/* The same of a leaf: bit i is triangle i of it. */
RT_KERNEL uint32_t prefilter_leaf(const RtWideTriangles *blocks, RtWideRef ref, const RayState *f) {
    uint32_t mask = prefilter_block(&blocks[0], f);
    if (rt_wide_has_more(ref)) mask |= prefilter_block(&blocks[1], f) << RT_WIDE_BLOCK;
    return mask;
}

/* The last step of rt_triangle_hit for one triangle of a block. */
RT_KERNEL bool admit(const float *triangle, RayState *f, const Query *q, float *t) {
    if (fabsf(*t) >= f->sure) return *t >= f->tmin && *t <= f->tmax;
    RtFloat4 a = raytally_triangle_vertex(triangle, RT_WIDE_BLOCK);
    RtFloat4 b = raytally_triangle_vertex(triangle + VERTEX, RT_WIDE_BLOCK);
    RtFloat4 c = raytally_triangle_vertex(triangle + (size_t)2 * VERTEX, RT_WIDE_BLOCK);
    return raytally_admit4(rt_min(rt_min(a, b), c), rt_max(rt_max(a, b), c), state_ray(f, q), t);
}

/* Tests the triangles `mask` of a block, sheared, in full; true if the search is over. */
RT_KERNEL bool test_block(const RtWideTriangles *block, const RtSheared4 *s, uint32_t mask, RayState *f,
                          const Query *q, bool any, RtTally *tally) {
    float at[RT_WIDE_BLOCK];
    RtFloat4 t;
    mask &= rt_cross4(s, rt_all4(f->major), &t);
    rt_store(at, t);
    for (; mask; mask &= mask - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(mask);
        if (!admit(&block->v[0][0][lane], f, q, &at[lane])) continue;
        RT_COUNT(tally, object_hits, 1);
        RT_OBSERVE(tally, .kind = RT_TRACED_OBJECT_HIT, .index = block->id[lane], .t = at[lane]);
        if (rt_hit_before(at[lane], block->id[lane], f->best)) f->best = (RtHit){at[lane], block->id[lane]};
        if (any) return true;
    }
    return false;
}

/* The same of a leaf. */
RT_KERNEL bool test_triangles(const RtWideTriangles *blocks, uint32_t mask, RayState *f, const Query *q,
                              bool any, RtTally *tally) {
    for (; mask; mask >>= RT_WIDE_BLOCK, blocks++) {
        const uint32_t some = mask & ((1u << RT_WIDE_BLOCK) - 1);
        if (some == 0) continue;
        const RtSheared4 s = shear(blocks, f);
        if (test_block(blocks, &s, some, f, q, any, tally)) return true;
    }
    return false;
}

/* rt_wide_count of a leaf without triangles. Ids are less than 2^31, and RT_NO_OBJECT is not. */
RT_KERNEL uint32_t list_count(const Query *q, RtWideRef ref) {
    const RtWideList *list = rt_wide_leaf_at(q->tree, ref);
    const uint32_t none = rt_bits(rt_load_ints8(list->id));
    return rt_wide_is_sphere(ref) ? 1 : RT_WIDE_MAX_LEAF - (uint32_t)__builtin_popcount(none);
}

/* Tests the objects of another leaf; true if the search is over. */
RT_KERNEL bool test_objects(const Query *q, RtWideRef ref, const RtPreparedRay *ray, bool any, RtHit *best,
                            RtTally *tally) {
    const RtWideList *list = rt_wide_leaf_at(q->tree, ref);
    const uint32_t objects = list_count(q, ref);
    for (uint32_t i = 0; i < objects; i++) {
        if (test_object(q->geometry, list->id[i], ray, any, best, tally)) return true;
    }
    return false;
}

/* A ray with sphere `i` of a leaf. */
RT_KERNEL SpherePair sphere_pair(const Query *q, const RtRay *ray, RtWideRef ref, uint32_t i) {
    const RtGeometry *g = q->geometry;
    const RtWideSphere *only = rt_wide_leaf_at(q->tree, ref);
    const RtWideList *list = rt_wide_leaf_at(q->tree, ref);
    if (rt_wide_is_sphere(ref)) return (SpherePair){ray, &only->sphere, only->id};
    return (SpherePair){ray, &g->spheres[rt_ref_index(g->objects[list->id[i]])], list->id[i]};
}

/* hit_sphere_pairs of one pair. One ray alone tests its spheres one by one: a branch that is foreseen costs
 * less than a chain of four divisions. |t| is sure from `sure` on. */
static __attribute__((noinline)) float hit_pair(const RtGeometry *g, const SpherePair *pair, float sure) {
    const RtRay *ray = pair->ray;
    double roots[2];
    int count = raytally_sphere_roots((const float *)pair->sphere, ray->org.at, ray->dir.at, roots);
    for (int i = 0; i < count; i++) {
        float t = (float)roots[i];
        if (!(fabsf(t) >= sure)) return hit_unsure_pair(g, pair);
        if (t >= ray->tmin && t <= rt_minf(ray->tmax, FLT_MAX)) return t;
    }
    return NAN;
}

/* Tests the spheres of a leaf; true if the search is over. */
static __attribute__((noinline)) bool test_spheres(const Query *q, RtWideRef ref, RayState *f, bool any,
                                                   RtTally *tally) {
    for (uint32_t i = 0, count = list_count(q, ref); i < count; i++) {
        const SpherePair pair = sphere_pair(q, &q->rays[f->index], ref, i);
        const float t = hit_pair(q->geometry, &pair, f->sure);
        if (rt_take_test(q->geometry, pair.id, t, any, &f->best, tally)) return true;
    }
    return false;
}

/* The triangles of a leaf are tested at once, in lanes. */
RT_COLD static void observe_leaf(const RtWideTree *tree, const RtGeometry *g, RtWideRef ref) {
    RtBox box = RT_EMPTY_BOX;
    bool triangles = rt_wide_kind(ref) == RT_WIDE_TRIANGLES;
    for (uint32_t i = 0; i < rt_wide_count(tree, ref); i++)
        box = rt_box_union(box, g->boxes[rt_wide_leaf_object(tree, ref, i)]);
    rt_observe(&(RtTraced){
        .kind = RT_TRACED_STEP, .what = "leaf", .index = rt_wide_place(ref), .box = &box, .leaf = true});
    for (uint32_t i = 0; triangles && i < rt_wide_count(tree, ref); i++) {
        uint32_t id = rt_wide_leaf_object(tree, ref, i);
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &g->boxes[id]});
    }
}

RT_KERNEL void count_leaf(RtTally *tally, const RtWideTree *tree, const RtGeometry *g, RtWideRef ref) {
    RT_COUNT(tally, steps, 1);
    RT_COUNT(tally, leaf_steps, 1);
    if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) RT_COUNT(tally, object_tests, rt_wide_count(tree, ref));
    if (RT_OBSERVED(tally)) observe_leaf(tree, g, ref);
}

/* After a leaf: drops the stack entries that are entered beyond the best hit, so entries need no test when
 * they are popped. */
RT_KERNEL void cull_stack(RayState *f) {
    float limit = rt_minf(f->best.t, f->tmax);
    if (!(limit < f->limit)) return;
    f->limit = limit;
    uint32_t kept = 1, top = f->top;
    for (uint32_t i = 1; i < top; i += RT_WIDE) {
        RtFloat8 enter = rt_loadu8(&f->enter[i]);
        uint32_t left = top - i, lanes = left < RT_WIDE ? (1u << left) - 1 : 255;
        uint32_t mask = rt_le_bits(enter, rt_all8(limit)) & lanes;
        RtOrder8 order = rt_order8(mask);
        RtInt8 refs = rt_load_ints8(&f->stack[i]);
        rt_store(&f->enter[kept], rt_compress8(order, (RtInt8)enter));
        rt_store(&f->stack[kept], rt_compress8(order, refs));
        kept += (uint32_t)__builtin_popcount(mask);
    }
    f->top = kept;
}

#endif
