/* SPDX-License-Identifier: Apache-2.0 */
/* One ray on its way through a wide hierarchy, and what it does at a node and at a leaf. */
#ifndef RT_ACCEL_WIDE_FLIGHT_H
#define RT_ACCEL_WIDE_FLIGHT_H

#include "accel/kernel.h"
#include "accel/simd.h"
#include "accel/surface.h"
#include "accel/wide/wide.h"
#include "core/base/memory.h"

/* A vector of eight may be written above what waits. */
enum { RT_WIDE_STACK = RT_TREE_MAX_DEPTH * (RT_WIDE - 1) + 2 * RT_WIDE };

/* What triangles are tested by first: for kx, ky and kz of a ray, where in a block the coordinates of the
 * first vertex are, in bytes, and the origin; and the shear. */
typedef struct Axes {
    uint32_t x, y, z;
    float org_x, org_y, org_z, shear_x, shear_y;
} Axes;

typedef struct Flight {
    _Alignas(RT_CACHE_LINE) RtPreparedRay ray;
    float limit;              /* the best t so far, or tmax */
    RtWideRef next;           /* what it goes on to */
    uint32_t top;             /* entries of the stack */
    uint32_t near[3], far[3]; /* of each axis, where in a node the planes are that are met first, and last */
    Axes axes;
    RtHit best;
    size_t index;               /* in the stream */
    RtTally *tally;             /* NULL in the timed kernels */
    float enter[RT_WIDE_STACK]; /* what waits, the next one last; at the bottom RT_WIDE_DONE */
    RtWideRef waiting[RT_WIDE_STACK];
} Flight;

/* Bytes from a plane of a node to the next, and from a coordinate of a block to the next. */
enum { PLANE = RT_WIDE * sizeof(float), COORDINATE = RT_WIDE_BLOCK * sizeof(float) };

/* Floats from a vertex of a triangle in a block to the next. */
enum { VERTEX = 3 * RT_WIDE_BLOCK };

/* Objects that are tested one by one, in functions of their own: what stands in each of the many loops here
 * takes long to compile. */
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

static __attribute__((noinline)) void all_timed(const RtGeometry *g, const RtPreparedRay *ray, bool any,
                                                RtHit *best) {
    rt_test_all(g, ray, any, best, NULL);
}

static __attribute__((noinline)) void all_counted(const RtGeometry *g, const RtPreparedRay *ray, bool any,
                                                  RtHit *best, RtTally *tally) {
    rt_test_all(g, ray, any, best, tally);
}

RT_KERNEL void test_all(const RtGeometry *g, const RtPreparedRay *ray, bool any, RtHit *best,
                        RtTally *tally) {
    if (tally)
        all_counted(g, ray, any, best, tally);
    else
        all_timed(g, ray, any, best);
}

/* Ready for the root. False where the ray is answered already: there is nothing, or the ray is too odd for
 * the boxes of divided objects, and was tested against all. */
RT_KERNEL bool take_off(Flight *f, const RtWideTree *tree, const RtGeometry *g, const RtScratch *scratch,
                        const RtRay *ray, size_t index, bool any, RtTally *tally) {
    const RtPreparedRay *r = &f->ray;
    rt_hit_ray(&f->ray, g, ray, scratch->room);
    f->best = RT_MISS;
    f->index = index;
    f->tally = tally;
    if (tree->node_count == 0) return false;
    if (tree->divided) {
        if (!rt_surface_is_near(&f->ray)) {
            test_all(g, &f->ray, any, &f->best, tally);
            return false;
        }
        rt_surface_thicken(&f->ray, &g->box);
    }
    f->limit = r->tmax;
    for (uint32_t a = 0; a < 3; a++) {
        uint32_t lo = 2 * a * PLANE, hi = lo + PLANE;
        f->near[a] = r->negative[a] ? hi : lo;
        f->far[a] = r->negative[a] ? lo : hi;
    }
    f->axes = (Axes){(uint32_t)r->kx * COORDINATE,
                     (uint32_t)r->ky * COORDINATE,
                     (uint32_t)r->kz * COORDINATE,
                     r->org.at[r->kx],
                     r->org.at[r->ky],
                     r->org.at[r->kz],
                     r->shear_x,
                     r->shear_y};
    f->enter[0] = -INFINITY;
    f->waiting[0] = RT_WIDE_DONE;
    f->top = 1;
    return true;
}

RT_KERNEL void prefetch(const RtWideTree *tree, RtWideRef ref) {
    const char *at = tree->arena + ref;
    for (size_t i = 0; i < sizeof(RtWideNode); i += RT_CACHE_LINE) __builtin_prefetch(at + i, 0, 3);
}

/* ---- nodes ---- */

RT_KERNEL __m256 planes(const RtWideNode *node, uint32_t offset) {
    return _mm256_load_ps((const float *)(const void *)((const char *)node + offset));
}

/* The children that the ray meets, as a mask, by rt_box_hit in eight lanes; where it enters each, to
 * *enter. */
RT_KERNEL uint32_t meet(const RtWideNode *node, const Flight *f, __m256 *enter) {
    const RtPreparedRay *r = &f->ray;
    __m256 near = _mm256_set1_ps(r->tmin), far = _mm256_set1_ps(f->limit);
    for (uint32_t a = 0; a < 3; a++) {
        __m256 inv = _mm256_set1_ps(r->inv[a]);
        __m256 first = _mm256_sub_ps(planes(node, f->near[a]), _mm256_set1_ps(r->org_near[a]));
        __m256 second = _mm256_sub_ps(planes(node, f->far[a]), _mm256_set1_ps(r->org_far[a]));
        near = _mm256_max_ps(_mm256_mul_ps(first, inv), near);
        far = _mm256_min_ps(_mm256_mul_ps(second, inv), far);
    }
    *enter = near;
    return rt_v8_at_most(near, far);
}

/* A node has no box of its own but those of its children, which are tested together. */
RT_COLD static void observe_node(const RtWideNode *node, RtWideRef ref, uint32_t mask) {
    RtBox child[RT_WIDE], all = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < node->count; i++) {
        for (size_t a = 0; a < 3; a++) {
            child[i].lo.at[a] = node->plane[2 * a][i];
            child[i].hi.at[a] = node->plane[2 * a + 1][i];
        }
        all = rt_box_union(all, child[i]);
    }
    rt_observe(
        &(RtTraced){.kind = RT_TRACED_STEP, .what = "node at", .index = rt_wide_place(ref), .box = &all});
    for (uint32_t i = 0; i < node->count; i++) {
        bool leaf = rt_wide_kind(node->child[i]) != RT_WIDE_NODE;
        rt_observe(&(RtTraced){.kind = RT_TRACED_EXTENT_TEST,
                               .what = leaf ? "leaf at" : "node at",
                               .index = rt_wide_place(node->child[i]),
                               .box = &child[i],
                               .met = mask >> i & 1});
    }
}

/* The lane of a mask with the least entry, but for the last three bits, by which ties are few; any lane of no
 * mask. Entries are at least 0, so their bits are in their order. */
RT_KERNEL uint32_t least_lane(uint32_t mask, __m256i enter) {
    const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7), none = _mm256_set1_epi32(INT32_MAX);
    __m256i key = _mm256_or_si256(_mm256_and_si256(enter, _mm256_set1_epi32(~7)), lanes);
    key = rt_v8_pick(mask, none, key);
    __m128i least = _mm_min_epi32(_mm256_castsi256_si128(key), _mm256_extracti128_si256(key, 1));
    least = _mm_min_epi32(least, _mm_shuffle_epi32(least, 0x4e));
    least = _mm_min_epi32(least, _mm_shuffle_epi32(least, 0xb1));
    return (uint32_t)_mm_cvtsi128_si32(least) & 7;
}

/* The child to go on to: the nearest, or without order the last; any where the mask is empty. */
RT_KERNEL uint32_t choose(uint32_t mask, __m256 enter, bool ordered) {
    return ordered ? least_lane(mask, _mm256_castps_si256(enter)) : 31 - (uint32_t)__builtin_clz(mask | 1);
}

/* Goes on to one child of the mask, and waits with the others; where there is none, to what waits last.
 * Without a branch, for which way it went nobody could predict. */
RT_KERNEL RtWideRef go_on(Flight *f, const RtWideNode *node, uint32_t mask, __m256 enter, bool ordered,
                          bool any) {
    uint32_t top = f->top, lane = choose(mask, enter, ordered), others = mask & ~(1u << lane);
    RtWideRef popped = f->waiting[top - 1], child = node->child[lane];
    RtV8Order order = rt_v8_order(others);
    if (!any) rt_v8_put(&f->enter[top], rt_v8_take(order, _mm256_castps_si256(enter)));
    rt_v8_put(&f->waiting[top], rt_v8_take(order, rt_v8_get(node->child)));
    f->top = top + (uint32_t)__builtin_popcount(others) - (mask == 0);
    return mask == 0 ? popped : child;
}

/* ---- leaves ---- */

/* The vertices of a block as rt_triangle_hit moves and shears them. */
typedef struct Sheared {
    __m128 x[3], y[3], z[3];
} Sheared;

RT_KERNEL __m128 coordinate(const RtWideTriangles *block, int vertex, uint32_t offset) {
    return _mm_load_ps((const float *)(const void *)((const char *)block->v[vertex] + offset));
}

RT_KERNEL Sheared shear(const RtWideTriangles *block, const Axes *axes) {
    const __m128 shear_x = _mm_set1_ps(axes->shear_x), shear_y = _mm_set1_ps(axes->shear_y);
    const __m128 org_x = _mm_set1_ps(axes->org_x), org_y = _mm_set1_ps(axes->org_y),
                 org_z = _mm_set1_ps(axes->org_z);
    Sheared s;
    for (int i = 0; i < 3; i++) {
        s.z[i] = _mm_sub_ps(coordinate(block, i, axes->z), org_z);
        s.x[i] = _mm_sub_ps(_mm_sub_ps(coordinate(block, i, axes->x), org_x), _mm_mul_ps(shear_x, s.z[i]));
        s.y[i] = _mm_sub_ps(_mm_sub_ps(coordinate(block, i, axes->y), org_y), _mm_mul_ps(shear_y, s.z[i]));
    }
    return s;
}

/* Of a block the triangles whose edge functions in float32 let the ray pass: all that rt_triangle_hit would
 * not turn away by them, but for those where one is no number, of which it finds none hit either. */
RT_KERNEL uint32_t sieve_block(const RtWideTriangles *block, const Axes *axes) {
    const __m128 zero = _mm_setzero_ps();
    Sheared s = shear(block, axes);
    __m128 u = _mm_sub_ps(_mm_mul_ps(s.x[2], s.y[1]), _mm_mul_ps(s.y[2], s.x[1]));
    __m128 v = _mm_sub_ps(_mm_mul_ps(s.x[0], s.y[2]), _mm_mul_ps(s.y[0], s.x[2]));
    __m128 w = _mm_sub_ps(_mm_mul_ps(s.x[1], s.y[0]), _mm_mul_ps(s.y[1], s.x[0]));
    __m128 least = _mm_min_ps(_mm_min_ps(u, v), w), most = _mm_max_ps(_mm_max_ps(u, v), w);
    return (uint32_t)_mm_movemask_ps(_mm_or_ps(_mm_cmpge_ps(least, zero), _mm_cmple_ps(most, zero)));
}

/* The same of a leaf: bit i is triangle i of it. */
RT_KERNEL uint32_t sieve_leaf(const RtWideTriangles *blocks, RtWideRef ref, const Axes *axes) {
    uint32_t mask = sieve_block(&blocks[0], axes);
    if (rt_wide_count(ref) > RT_WIDE_BLOCK) mask |= sieve_block(&blocks[1], axes) << RT_WIDE_BLOCK;
    return mask;
}

/* What rt_triangle_hit does in double, with four triangles: those whose plane the ray crosses within them,
 * and where. `major`: dir along kz. */
RT_KERNEL uint32_t cross(const Sheared *s, __m128 major, __m128 *t) {
    const __m256d zero = _mm256_setzero_pd();
    __m256d x[3], y[3], z[3];
    for (int i = 0; i < 3; i++) {
        x[i] = _mm256_cvtps_pd(s->x[i]);
        y[i] = _mm256_cvtps_pd(s->y[i]);
        z[i] = _mm256_cvtps_pd(s->z[i]);
    }
    __m256d u = _mm256_sub_pd(_mm256_mul_pd(x[2], y[1]), _mm256_mul_pd(y[2], x[1]));
    __m256d v = _mm256_sub_pd(_mm256_mul_pd(x[0], y[2]), _mm256_mul_pd(y[0], x[2]));
    __m256d w = _mm256_sub_pd(_mm256_mul_pd(x[1], y[0]), _mm256_mul_pd(y[1], x[0]));
    __m256d least = _mm256_min_pd(_mm256_min_pd(u, v), w), most = _mm256_max_pd(_mm256_max_pd(u, v), w);
    __m256d determinant = _mm256_add_pd(_mm256_add_pd(u, v), w);
    __m256d within =
        _mm256_or_pd(_mm256_cmp_pd(least, zero, _CMP_GE_OQ), _mm256_cmp_pd(most, zero, _CMP_LE_OQ));
    within = _mm256_and_pd(within, _mm256_cmp_pd(determinant, zero, _CMP_NEQ_OQ));
    __m256d depth = _mm256_add_pd(_mm256_mul_pd(u, z[0]), _mm256_mul_pd(v, z[1]));
    depth = _mm256_div_pd(_mm256_add_pd(depth, _mm256_mul_pd(w, z[2])), determinant);
    *t = _mm256_cvtpd_ps(_mm256_div_pd(depth, _mm256_cvtps_pd(major)));
    return (uint32_t)_mm256_movemask_pd(within);
}

/* The last of rt_triangle_hit for one triangle of a block. */
RT_KERNEL bool admit(const float *triangle, const RtPreparedRay *ray, float *t) {
    RtFour a = rt_triangle_vertex(triangle, RT_WIDE_BLOCK);
    RtFour b = rt_triangle_vertex(triangle + VERTEX, RT_WIDE_BLOCK);
    RtFour c = rt_triangle_vertex(triangle + (size_t)2 * VERTEX, RT_WIDE_BLOCK);
    return rt_four_admit(rt_four_min(rt_four_min(a, b), c), rt_four_max(rt_four_max(a, b), c), ray, t);
}

/* Tests those triangles of a block in full; true where the search is over. */
RT_KERNEL bool test_block(const RtWideTriangles *block, uint32_t mask, const Axes *axes,
                          const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    _Alignas(16) float at[RT_WIDE_BLOCK];
    __m128 t;
    const Sheared s = shear(block, axes);
    mask &= cross(&s, _mm_set1_ps(ray->dir.at[ray->kz]), &t);
    _mm_store_ps(at, t);
    for (; mask; mask &= mask - 1) {
        uint32_t lane = (uint32_t)__builtin_ctz(mask);
        if (!admit(&block->v[0][0][lane], ray, &at[lane])) continue;
        RT_COUNT(tally, object_hits, 1);
        RT_OBSERVE(tally, .kind = RT_TRACED_OBJECT_HIT, .index = block->id[lane], .t = at[lane]);
        if (rt_hit_before(at[lane], block->id[lane], *best)) *best = (RtHit){at[lane], block->id[lane]};
        if (any) return true;
    }
    return false;
}

/* The same of a leaf. */
RT_KERNEL bool test_triangles(const RtWideTriangles *blocks, uint32_t mask, const Axes *axes,
                              const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    for (; mask; mask >>= RT_WIDE_BLOCK, blocks++) {
        uint32_t some = mask & ((1u << RT_WIDE_BLOCK) - 1);
        if (some && test_block(blocks, some, axes, ray, any, best, tally)) return true;
    }
    return false;
}

/* Tests what is in a leaf of anything else; true where the search is over. */
RT_KERNEL bool test_objects(const RtWideTree *tree, const RtGeometry *g, RtWideRef ref,
                            const RtPreparedRay *ray, bool any, RtHit *best, RtTally *tally) {
    const RtWideList *list = rt_wide_leaf_at(tree, ref);
    for (uint32_t i = 0; i < rt_wide_count(ref); i++) {
        if (test_object(g, list->id[i], ray, any, best, tally)) return true;
    }
    return false;
}

/* The objects of triangles are tested there and then, in lanes. */
RT_COLD static void observe_leaf(const RtWideTree *tree, const RtGeometry *g, RtWideRef ref) {
    RtBox box = RT_EMPTY_BOX;
    bool triangles = rt_wide_kind(ref) == RT_WIDE_TRIANGLES;
    for (uint32_t i = 0; i < rt_wide_count(ref); i++)
        box = rt_box_union(box, g->boxes[rt_wide_leaf_object(tree, ref, i)]);
    rt_observe(&(RtTraced){
        .kind = RT_TRACED_STEP, .what = "leaf at", .index = rt_wide_place(ref), .box = &box, .leaf = true});
    for (uint32_t i = 0; triangles && i < rt_wide_count(ref); i++) {
        uint32_t id = rt_wide_leaf_object(tree, ref, i);
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &g->boxes[id]});
    }
}

RT_KERNEL void count_leaf(RtTally *tally, const RtWideTree *tree, const RtGeometry *g, RtWideRef ref) {
    RT_COUNT(tally, steps, 1);
    RT_COUNT(tally, leaf_steps, 1);
    if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) RT_COUNT(tally, object_tests, rt_wide_count(ref));
    if (RT_OBSERVED(tally)) observe_leaf(tree, g, ref);
}

/* What follows a leaf in which something was tested: what waits and is entered beyond the best hit is
 * dropped, so that what is taken from the stack need not be looked at again. */
RT_KERNEL void narrow(Flight *f) {
    float limit = rt_minf(f->best.t, f->ray.tmax);
    if (!(limit < f->limit)) return;
    f->limit = limit;
    uint32_t kept = 1, top = f->top;
    for (uint32_t i = 1; i < top; i += RT_WIDE) {
        __m256 enter = _mm256_loadu_ps(&f->enter[i]);
        uint32_t left = top - i, lanes = left < RT_WIDE ? (1u << left) - 1 : 255;
        uint32_t mask = rt_v8_at_most(enter, _mm256_set1_ps(limit)) & lanes;
        RtV8Order order = rt_v8_order(mask);
        __m256i refs = rt_v8_get(&f->waiting[i]);
        rt_v8_put(&f->enter[kept], rt_v8_take(order, _mm256_castps_si256(enter)));
        rt_v8_put(&f->waiting[kept], rt_v8_take(order, refs));
        kept += (uint32_t)__builtin_popcount(mask);
    }
    f->top = kept;
}

#endif
