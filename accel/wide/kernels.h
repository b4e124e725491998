/* SPDX-License-Identifier: Apache-2.0 */
/* The traversals, included once for each instruction set: RT_WIDE_KERNELS is the name of the table that is
 * defined. */
#include "accel/kernel.h"
#include "accel/surface.h"
#include "accel/simd.h"
#include "accel/wide/wide.h"
#include "base/memory.h"
#ifdef PROF
#define PROF_KERNEL static __attribute__((noinline))
#else
#define PROF_KERNEL RT_KERNEL
#endif

/* What triangles are tested by first: for kx, ky and kz of a ray, where in a block the coordinates of the first
 * vertex are, and the origin; and the shear. */
typedef struct Axes {
    uint32_t x, y, z;
    float org_x, org_y, org_z, shear_x, shear_y;
} Axes;

/* One ray on its way. */
typedef struct Flight {
    _Alignas(RT_CACHE_LINE) RtPreparedRay ray;
    float limit;                /* the best t so far, or tmax */
    RtWideRef next;             /* what it goes on to */
    uint32_t top;               /* entries of the stack */
    uint32_t near[3], far[3];   /* of each axis, where in a node the planes are that are met first, and last */
    Axes axes;
    RtHit best;
    size_t index; /* in the stream */
    RtTally *tally;
    float enter[RT_WIDE_STACK]; /* what waits, the next one last; under all of it RT_WIDE_DONE */
    RtWideRef waiting[RT_WIDE_STACK];
} Flight;

_Static_assert(sizeof(Flight) <= 6144, "fits");

PROF_KERNEL void begin(Flight *f, const RtWideTree *tree, const RtAccel *accel, const RtScratch *scratch,
                     const RtRay *ray, size_t index, RtTally *tallies) {
    const RtGeometry *g = &accel->scene->geometry;
    rt_hit_ray(&f->ray, g, ray, scratch->room);
    if (tree->divided) rt_surface_thicken(&f->ray, &g->box);
    f->best = RT_MISS;
    f->limit = f->ray.tmax;
    for (uint32_t a = 0; a < 3; a++) {
        uint32_t lo = 2 * a * RT_WIDE * (uint32_t)sizeof(float), hi = lo + RT_WIDE * (uint32_t)sizeof(float);
        f->near[a] = f->ray.negative[a] ? hi : lo;
        f->far[a] = f->ray.negative[a] ? lo : hi;
    }
    uint32_t kx = (uint32_t)f->ray.kx, ky = (uint32_t)f->ray.ky, kz = (uint32_t)f->ray.kz;
    f->axes = (Axes){kx * 16, ky * 16, kz * 16, f->ray.org.at[kx], f->ray.org.at[ky], f->ray.org.at[kz], f->ray.shear_x, f->ray.shear_y};
    f->enter[0] = -INFINITY;
    f->waiting[0] = RT_WIDE_DONE;
    f->top = 1;
    f->index = index;
    f->tally = tallies ? &tallies[ray->kind] : NULL;
}

/* The children that the ray meets, as a mask; where it enters each, to *enter. */
RT_KERNEL uint32_t meet(const RtWideNode *node, const Flight *f, __m256 *enter) {
    const RtPreparedRay *r = &f->ray;
    const char *planes = (const char *)node;
    __m256 near = _mm256_set1_ps(r->tmin), far = _mm256_set1_ps(f->limit);
    for (uint32_t a = 0; a < 3; a++) {
        __m256 inv = _mm256_set1_ps(r->inv[a]);
        __m256 first = _mm256_sub_ps(_mm256_load_ps((const float *)(planes + f->near[a])), _mm256_set1_ps(r->org_near[a]));
        __m256 second = _mm256_sub_ps(_mm256_load_ps((const float *)(planes + f->far[a])), _mm256_set1_ps(r->org_far[a]));
        near = _mm256_max_ps(_mm256_mul_ps(first, inv), near);
        far = _mm256_min_ps(_mm256_mul_ps(second, inv), far);
    }
    *enter = near;
    return rt_v8_at_most(near, far);
}

/* The lane of a mask with the least entry, ties by lane; of no mask, any. Entries are at least 0, so their
 * bits are in their order. */
RT_KERNEL uint32_t least_lane(uint32_t mask, __m256i keys) {
    const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7), last = _mm256_set1_epi32(INT32_MAX);
#if defined(__AVX512VL__)
    __m256i key = _mm256_mask_ternarylogic_epi32(keys, 0xff, _mm256_set1_epi32(~7), lanes, 0xea);
    key = _mm256_mask_blend_epi32((__mmask8)mask, last, key);
#else
    __m256i key = _mm256_or_si256(_mm256_and_si256(keys, _mm256_set1_epi32(~7)), lanes);
    const __m256i bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    __m256i in = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)mask), bits), bits);
    key = _mm256_blendv_epi8(last, key, in);
#endif
    __m128i least = _mm_min_epi32(_mm256_castsi256_si128(key), _mm256_extracti128_si256(key, 1));
    least = _mm_min_epi32(least, _mm_shuffle_epi32(least, 0x4e));
    least = _mm_min_epi32(least, _mm_shuffle_epi32(least, 0xb1));
    return (uint32_t)_mm_cvtsi128_si32(least) & 7;
}

/* Goes on to the nearest child of the mask, and waits with the others; where there is none, to what waits
 * last. Without a branch. */
RT_KERNEL RtWideRef go_on(Flight *f, const RtWideNode *node, uint32_t mask, __m256 enter, bool ordered, bool any) {
    __m256i keys = _mm256_castps_si256(enter), refs = _mm256_load_si256((const __m256i *)node->child);
    uint32_t top = f->top;
    RtWideRef popped = f->waiting[top - 1];
    uint32_t lane = ordered ? least_lane(mask, keys) : 31 - (uint32_t)__builtin_clz(mask | 1);
    uint32_t others = mask & ~(1u << lane);
    RtV8Order order = rt_v8_order(others);
    RtWideRef near = node->child[lane];
    if (!any) _mm256_storeu_si256((__m256i *)&f->enter[top], rt_v8_take(order, keys));
    _mm256_storeu_si256((__m256i *)&f->waiting[top], rt_v8_take(order, refs));
    f->top = top + (uint32_t)__builtin_popcount(others) - (mask == 0);
    return mask == 0 ? popped : near;
}

/* ---- triangles ---- */

/* The vertices of a block as rt_triangle_hit moves and shears them, for the ray's axes. */
typedef struct Sheared {
    __m128 x[3], y[3], z[3];
} Sheared;

RT_KERNEL __m128 coordinate(const RtWideTriangles *block, int vertex, uint32_t axis) {
    return _mm_load_ps((const float *)((const char *)block->v[vertex] + axis));
}

RT_KERNEL Sheared shear(const RtWideTriangles *block, const Axes *f) {
    const __m128 org_x = _mm_set1_ps(f->org_x), org_y = _mm_set1_ps(f->org_y), org_z = _mm_set1_ps(f->org_z);
    const __m128 shear_x = _mm_set1_ps(f->shear_x), shear_y = _mm_set1_ps(f->shear_y);
    Sheared s;
    for (int i = 0; i < 3; i++) {
        s.z[i] = _mm_sub_ps(coordinate(block, i, f->z), org_z);
        s.x[i] = _mm_sub_ps(_mm_sub_ps(coordinate(block, i, f->x), org_x), _mm_mul_ps(shear_x, s.z[i]));
        s.y[i] = _mm_sub_ps(_mm_sub_ps(coordinate(block, i, f->y), org_y), _mm_mul_ps(shear_y, s.z[i]));
    }
    return s;
}

/* Of a block the triangles whose edge functions in float32 let the ray pass: all that rt_triangle_hit would
 * not turn away by them, but for those that are no numbers, of which it finds none hit either. */
RT_KERNEL uint32_t sieve_block(const RtWideTriangles *block, const Axes *f) {
    Sheared s = shear(block, f);
    __m128 u = _mm_sub_ps(_mm_mul_ps(s.x[2], s.y[1]), _mm_mul_ps(s.y[2], s.x[1]));
    __m128 v = _mm_sub_ps(_mm_mul_ps(s.x[0], s.y[2]), _mm_mul_ps(s.y[0], s.x[2]));
    __m128 w = _mm_sub_ps(_mm_mul_ps(s.x[1], s.y[0]), _mm_mul_ps(s.y[1], s.x[0]));
    __m128 least = _mm_min_ps(_mm_min_ps(u, v), w), most = _mm_max_ps(_mm_max_ps(u, v), w);
    __m128 zero = _mm_setzero_ps();
    return (uint32_t)_mm_movemask_ps(_mm_or_ps(_mm_cmpge_ps(least, zero), _mm_cmple_ps(most, zero)));
}

/* Bit i: triangle i of the leaf is to be tested in full. */
RT_KERNEL uint32_t sieve_leaf(const RtWideTriangles *blocks, const Flight *f, RtWideRef ref) {
    uint32_t mask = sieve_block(&blocks[0], &f->axes);
    if (rt_wide_count(ref) > RT_WIDE_BLOCK) mask |= sieve_block(&blocks[1], &f->axes) << RT_WIDE_BLOCK;
    return mask;
}

/* Tests triangles of a leaf in full; true where the search is over. */
PROF_KERNEL bool test_triangles(const RtWideTriangles *blocks, Flight *f, uint32_t mask, bool any, RtTally *tally) {
    for (; mask; mask &= mask - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(mask), lane = i % RT_WIDE_BLOCK;
        const RtWideTriangles *block = &blocks[i / RT_WIDE_BLOCK];
        float t;
        if (!rt_triangle_hit_strided(&block->v[0][0][lane], 3 * RT_WIDE_BLOCK, RT_WIDE_BLOCK, &f->ray, &t)) continue;
        RT_COUNT(tally, object_hits, 1);
        if (rt_hit_before(t, block->id[lane], f->best)) f->best = (RtHit){t, block->id[lane]};
        if (any) return true;
    }
    return false;
}

/* Tests what else is in a leaf; true where the search is over. */
RT_KERNEL bool test_objects(const RtWideTree *tree, const RtGeometry *g, Flight *f, RtWideRef ref, bool any, RtTally *tally) {
    uint32_t count = rt_wide_count(ref);
    const RtWideSpheres *spheres = rt_wide_leaf_at(tree, ref);
    const RtWideList *list = rt_wide_leaf_at(tree, ref);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t id = rt_wide_kind(ref) == RT_WIDE_LIST ? list->id[i] : spheres[i / RT_WIDE_BLOCK].id[i % RT_WIDE_BLOCK];
        if (rt_test_object(g, id, &f->ray, any, &f->best, tally)) return true;
    }
    return false;
}

/* Drops what waits and is entered beyond the best hit; not what lies at the bottom. */
RT_KERNEL void drop(Flight *f) {
    const __m256 limit = _mm256_set1_ps(f->limit);
    uint32_t kept = 1, top = f->top;
    for (uint32_t i = 1; i < top; i += RT_WIDE) {
        __m256 enter = _mm256_loadu_ps(&f->enter[i]);
        __m256i refs = _mm256_loadu_si256((const __m256i *)&f->waiting[i]);
        uint32_t left = top - i, mask = rt_v8_at_most(enter, limit) & (left < RT_WIDE ? (1u << left) - 1 : 255);
        RtV8Order order = rt_v8_order(mask);
        _mm256_storeu_si256((__m256i *)&f->enter[kept], rt_v8_take(order, _mm256_castps_si256(enter)));
        _mm256_storeu_si256((__m256i *)&f->waiting[kept], rt_v8_take(order, refs));
        kept += (uint32_t)__builtin_popcount(mask);
    }
    f->top = kept;
}

/* What follows a leaf in which something was tested. */
PROF_KERNEL void narrow(Flight *f) {
    float limit = rt_minf(f->best.t, f->ray.tmax);
    if (!(limit < f->limit)) return;
    f->limit = limit;
    drop(f);
}

RT_KERNEL void prefetch(const RtWideTree *tree, RtWideRef ref) {
    const char *at = tree->arena + ref;
    for (int i = 0; i < 4; i++) __builtin_prefetch(at + i * RT_CACHE_LINE, 0, 3);
}

RT_KERNEL void count_leaf(RtTally *tally, RtWideRef ref) {
    RT_COUNT(tally, steps, 1);
    RT_COUNT(tally, leaf_steps, 1);
    if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) RT_COUNT(tally, object_tests, rt_wide_count(ref));
}

/* ---- one ray after the other ---- */

RT_KERNEL void trace_one(const RtWide *self, const RtWideTree *tree, Flight *f, bool any, RtTally *tally) {
    const RtGeometry *g = &self->base.scene->geometry;
    const bool ordered = !any && self->order;
    RtWideRef ref = 0;
    for (;;) {
        if (rt_wide_kind(ref) == RT_WIDE_NODE) {
            const RtWideNode *node = rt_wide_node(tree, ref);
            __m256 enter;
            uint32_t mask = meet(node, f, &enter);
            RT_COUNT(tally, steps, 1);
            RT_COUNT(tally, extent_tests, node->count);
            if (mask && !(mask & (mask - 1))) {
                ref = node->child[__builtin_ctz(mask)];
                continue;
            }
            if (mask) {
                ref = go_on(f, node, mask, enter, ordered, any);
                if (self->prefetch) prefetch(tree, f->waiting[f->top - 1]);
                continue;
            }
        } else {
            count_leaf(tally, ref);
            if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) {
                const RtWideTriangles *blocks = rt_wide_leaf_at(tree, ref);
                uint32_t mask = sieve_leaf(blocks, f, ref);
                if (mask && test_triangles(blocks, f, mask, any, tally)) return;
            } else {
                if (test_objects(tree, g, f, ref, any, tally)) return;
            }
            narrow(f);
        }
        ref = f->waiting[--f->top];
        if (ref == RT_WIDE_DONE) return;
    }
}

/* ---- many rays at once ---- */

/* Rays by what they go on to. */
typedef struct Lists {
    uint32_t count[4];
    Flight *of[4][RT_WIDE_MAX_IN_FLIGHT];
} Lists;

RT_KERNEL void enlist(Lists *lists, const RtWideTree *tree, Flight *f, RtWideRef next, uint32_t one, bool ahead) {
    uint32_t kind = rt_wide_kind(next), count = lists->count[kind];
    f->next = next;
    lists->of[kind][count] = f;
    lists->count[kind] = count + one;
    if (ahead) prefetch(tree, next);
}

PROF_KERNEL void visit(Lists *lists, const RtWideTree *tree, bool ordered, bool any, bool ahead, bool counted) {
    uint32_t n = lists->count[RT_WIDE_NODE], masks[RT_WIDE_MAX_IN_FLIGHT];
    _Alignas(RT_CACHE_LINE) float enters[RT_WIDE_MAX_IN_FLIGHT][RT_WIDE];
    lists->count[RT_WIDE_NODE] = 0;
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = lists->of[RT_WIDE_NODE][i];
        const RtWideNode *node = rt_wide_node(tree, f->next);
        __m256 enter;
        masks[i] = meet(node, f, &enter);
        if (ordered || !any) _mm256_store_ps(enters[i], enter);
        if (counted) {
            f->tally->steps++;
            f->tally->extent_tests += node->count;
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = lists->of[RT_WIDE_NODE][i];
        const RtWideNode *node = rt_wide_node(tree, f->next);
        enlist(lists, tree, f, go_on(f, node, masks[i], _mm256_load_ps(enters[i]), ordered, any), 1, ahead);
    }
}

typedef struct Candidate {
    Flight *flight;
    uint32_t mask;
} Candidate;

PROF_KERNEL uint32_t sieve(Lists *lists, const RtWideTree *tree, Candidate *candidates, bool ahead, bool counted) {
    uint32_t n = lists->count[RT_WIDE_TRIANGLES], found = 0, masks[RT_WIDE_MAX_IN_FLIGHT];
    lists->count[RT_WIDE_TRIANGLES] = 0;
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = lists->of[RT_WIDE_TRIANGLES][i];
        if (counted) count_leaf(f->tally, f->next);
        masks[i] = sieve_leaf(rt_wide_leaf_at(tree, f->next), f, f->next);
    }
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = lists->of[RT_WIDE_TRIANGLES][i];
        uint32_t none = masks[i] == 0;
        candidates[found] = (Candidate){f, masks[i]};
        found += !none;
        RtWideRef popped = f->waiting[f->top - 1];
        f->top -= none;
        enlist(lists, tree, f, none ? popped : f->next, none, ahead);
    }
    return found;
}

RT_KERNEL void trace_many(const RtWide *self, const RtWideTree *tree, const RtScratch *scratch, const RtRay *rays,
                          size_t count, RtHit *hits, uint32_t *blockers, RtTally *tallies) {
    const RtGeometry *g = &self->base.scene->geometry;
    const bool any = !hits, ordered = !any && self->order, ahead = self->prefetch;
    Flight *flights = scratch->own;
    Lists lists = {.count = {0}};
    Candidate candidates[RT_WIDE_MAX_IN_FLIGHT];
    uint32_t most = self->in_flight, active = 0;
    size_t begun = 0;
    for (; begun < count && begun < most; begun++) {
        Flight *f = &flights[begun];
        begin(f, tree, &self->base, scratch, &rays[begun], begun, tallies);
        enlist(&lists, tree, f, 0, 1, ahead);
        active++;
    }
    while (active > 0) {
        while (lists.count[RT_WIDE_NODE] > active / 4) {
            /*T0*/
            visit(&lists, tree, ordered, any, ahead, tallies != NULL);
            /*T0e*/
        }
        /*T1*/
        uint32_t found = sieve(&lists, tree, candidates, ahead, tallies != NULL);
        /*T2*/
        for (uint32_t i = 0; i < found; i++) {
            Flight *f = candidates[i].flight;
            RtWideRef next = RT_WIDE_DONE;
            if (!test_triangles(rt_wide_leaf_at(tree, f->next), f, candidates[i].mask, any, f->tally)) {
                narrow(f);
                next = f->waiting[--f->top];
            }
            enlist(&lists, tree, f, next, 1, ahead);
        }
        /*T3*/
        for (int kind = RT_WIDE_SPHERES; kind <= RT_WIDE_LIST; kind++) {
            uint32_t n = lists.count[kind];
            lists.count[kind] = 0;
            for (uint32_t i = 0; i < n; i++) {
                Flight *f = lists.of[kind][i];
                RtWideRef ref = f->next, next = 0;
                if (ref != RT_WIDE_DONE) count_leaf(f->tally, ref);
                if (ref != RT_WIDE_DONE && !test_objects(tree, g, f, ref, any, f->tally)) {
                    narrow(f);
                    next = f->waiting[--f->top];
                } else {
                    if (hits)
                        hits[f->index] = f->best;
                    else
                        blockers[f->index] = f->best.object;
                    RT_COUNT(f->tally, rays, 1);
                    RT_COUNT(f->tally, hits, f->best.object != RT_NO_OBJECT);
                    if (begun == count) {
                        active--;
                        continue;
                    }
                    begin(f, tree, &self->base, scratch, &rays[begun], begun, tallies);
                    begun++;
                }
                enlist(&lists, tree, f, next, 1, ahead);
            }
        }
        /*T3e*/
    }
}

/* ---- sixteen rays that go the same way ---- */

enum { PACKET = 16 };

/* Rays whose directions have the same signs and the same major axis, none of them along a plane. What is
 * between the least and the most of their origins and reciprocals bounds where any of them enters a box, and
 * leaves it, bit for bit, for rounding is monotone. */
typedef struct Packet {
    _Alignas(RT_CACHE_LINE) float org[3][PACKET];
    float inv[3][PACKET], org_near[3][PACKET], org_far[3][PACKET];
    float tmin[PACKET], limit[PACKET], shear_x[PACKET], shear_y[PACKET];
    uint32_t near[3], far[3];                                /* as in Flight */
    uint32_t kx, ky, kz;
    float first[3], last[3], inv_least[3], inv_most[3];      /* the origin that enters first, and leaves last */
    float tmin_least, limit_most;
    RtHit best[PACKET];
    uint32_t prepared; /* bit i: ray[i] is */
    RtPreparedRay ray[PACKET];
    RtWideRef waiting[RT_WIDE_STACK], parent[RT_WIDE_STACK];
    float enter[RT_WIDE_STACK];
} Packet;

RT_KERNEL bool uniform(uint32_t mask) {
    return mask == 0 || mask == 0xffff;
}

/* Do two rays go the same way, roughly? */
RT_KERNEL bool alike(const RtRay *a, const RtRay *b) {
    bool same = true;
    for (int i = 0; i < 3; i++) same &= signbit(a->dir.at[i]) == signbit(b->dir.at[i]);
    return same;
}

PROF_KERNEL bool begin_packet(Packet *p, const RtGeometry *g, const RtRay *rays) {
    _Alignas(RT_CACHE_LINE) float dir[3][PACKET], tmax[PACKET];
    if (!alike(&rays[0], &rays[PACKET - 1]) || !alike(&rays[0], &rays[PACKET / 2])) return false;
    for (int i = 0; i < PACKET; i++) {
        for (int a = 0; a < 3; a++) p->org[a][i] = rays[i].org.at[a], dir[a][i] = rays[i].dir.at[a];
        p->tmin[i] = rays[i].tmin;
        tmax[i] = rays[i].tmax;
    }
    const RtV16 most = rt_v16_all(FLT_MAX);
    RtV16 d[3], inv[3], org[3], farthest = rt_v16_all(0);
    uint32_t signs[3], usual = 0xffff;
    for (int a = 0; a < 3; a++) {
        d[a] = rt_v16_load(dir[a]);
        org[a] = rt_v16_load(p->org[a]);
        inv[a] = rt_v16_div(rt_v16_all(1), d[a]);
        signs[a] = rt_v16_signs(d[a]);
        usual &= rt_v16_at_most(rt_v16_abs(inv[a]), most);
        farthest = rt_v16_max(rt_v16_abs(rt_v16_sub(rt_v16_all(g->box.lo.at[a]), org[a])), farthest);
        farthest = rt_v16_max(rt_v16_abs(rt_v16_sub(rt_v16_all(g->box.hi.at[a]), org[a])), farthest);
    }
    RtV16 x = rt_v16_abs(d[0]), y = rt_v16_abs(d[1]), z = rt_v16_abs(d[2]);
    uint32_t is_z = ~rt_v16_at_most(z, x) & ~rt_v16_at_most(z, y) & 0xffff, is_y = ~rt_v16_at_most(y, x) & ~is_z & 0xffff;
    if (usual != 0xffff || !uniform(signs[0]) || !uniform(signs[1]) || !uniform(signs[2]) || !uniform(is_z) || !uniform(is_y)) return false;
    p->kz = is_z ? 2 : is_y ? 1 : 0;
    p->kx = 9u >> 2 * p->kz & 3;
    p->ky = 9u >> 2 * p->kx & 3;
    RtV16 thickness = rt_v16_mul(farthest, rt_v16_all(0x1p-20f));
    for (int a = 0; a < 3; a++) {
        uint32_t lo = 2 * (uint32_t)a * 32, hi = lo + 32;
        RtV16 shift = rt_v16_add(thickness, rt_v16_mul(rt_v16_abs(org[a]), rt_v16_all(0x1p-23f)));
        RtV16 plus = rt_v16_add(org[a], shift), minus = rt_v16_sub(org[a], shift);
        RtV16 near = signs[a] ? minus : plus, far = signs[a] ? plus : minus;
        rt_v16_store(p->inv[a], inv[a]);
        rt_v16_store(p->org_near[a], near);
        rt_v16_store(p->org_far[a], far);
        p->near[a] = signs[a] ? hi : lo;
        p->far[a] = signs[a] ? lo : hi;
        p->first[a] = signs[a] ? rt_v16_least(near) : rt_v16_most(near);
        p->last[a] = signs[a] ? rt_v16_most(far) : rt_v16_least(far);
        p->inv_least[a] = rt_v16_least(inv[a]);
        p->inv_most[a] = rt_v16_most(inv[a]);
    }
    RtV16 limit = rt_v16_min(rt_v16_load(tmax), most);
    rt_v16_store(p->limit, limit);
    rt_v16_store(p->shear_x, rt_v16_mul(d[p->kx], inv[p->kz]));
    rt_v16_store(p->shear_y, rt_v16_mul(d[p->ky], inv[p->kz]));
    p->limit_most = rt_v16_most(limit);
    p->tmin_least = rt_v16_least(rt_v16_load(p->tmin));
    p->prepared = 0;
    for (int i = 0; i < PACKET; i++) p->best[i] = RT_MISS;
    return true;
}

/* The children that some ray may meet, and where the first may enter each. */
RT_KERNEL uint32_t meet_packet(const RtWideNode *node, const Packet *p, __m256 *enter) {
    const char *planes = (const char *)node;
    __m256 near = _mm256_set1_ps(p->tmin_least), far = _mm256_set1_ps(p->limit_most);
    for (uint32_t a = 0; a < 3; a++) {
        __m256 least = _mm256_set1_ps(p->inv_least[a]), most = _mm256_set1_ps(p->inv_most[a]);
        __m256 first = _mm256_sub_ps(_mm256_load_ps((const float *)(planes + p->near[a])), _mm256_set1_ps(p->first[a]));
        __m256 last = _mm256_sub_ps(_mm256_load_ps((const float *)(planes + p->far[a])), _mm256_set1_ps(p->last[a]));
        near = _mm256_max_ps(_mm256_min_ps(_mm256_mul_ps(first, least), _mm256_mul_ps(first, most)), near);
        far = _mm256_min_ps(_mm256_max_ps(_mm256_mul_ps(last, least), _mm256_mul_ps(last, most)), far);
    }
    *enter = near;
    return rt_v8_at_most(near, far);
}

/* The rays that meet the box of a child. */
RT_KERNEL uint32_t meet_rays(const RtWideNode *node, uint32_t lane, const Packet *p) {
    const char *planes = (const char *)node + lane * sizeof(float);
    RtV16 near = rt_v16_load(p->tmin), far = rt_v16_load(p->limit);
    for (int a = 0; a < 3; a++) {
        RtV16 inv = rt_v16_load(p->inv[a]);
        RtV16 first = rt_v16_sub(rt_v16_all(*(const float *)(planes + p->near[a])), rt_v16_load(p->org_near[a]));
        RtV16 second = rt_v16_sub(rt_v16_all(*(const float *)(planes + p->far[a])), rt_v16_load(p->org_far[a]));
        near = rt_v16_max(rt_v16_mul(first, inv), near);
        far = rt_v16_min(rt_v16_mul(second, inv), far);
    }
    return rt_v16_at_most(near, far);
}

/* Tests a leaf for the rays of the mask; true where a limit has changed. */
PROF_KERNEL bool test_packet(const RtWideTree *tree, const RtGeometry *g, Packet *p, const RtRay *rays, RtWideRef ref,
                           uint32_t mask, bool any, RtCrossing *room) {
    bool changed = false;
    for (; mask; mask &= mask - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(mask), found = 1;
        const RtWideTriangles *blocks = rt_wide_leaf_at(tree, ref);
        Axes axes;
        if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) {
            axes = (Axes){p->kx * 16, p->ky * 16, p->kz * 16, p->org[p->kx][i], p->org[p->ky][i], p->org[p->kz][i], p->shear_x[i], p->shear_y[i]};
            found = sieve_block(blocks, &axes);
            if (rt_wide_count(ref) > RT_WIDE_BLOCK) found |= sieve_block(&blocks[1], &axes) << RT_WIDE_BLOCK;
        }
        if (!found) continue;
        RtPreparedRay *ray = &p->ray[i];
        if (!(p->prepared >> i & 1)) {
            rt_hit_ray(ray, g, &rays[i], room);
            p->prepared |= 1u << i;
        }
        if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) {
            for (; found; found &= found - 1) {
                uint32_t c = (uint32_t)__builtin_ctz(found), lane = c % RT_WIDE_BLOCK;
                const RtWideTriangles *block = &blocks[c / RT_WIDE_BLOCK];
                float t;
                if (!rt_triangle_hit_strided(&block->v[0][0][lane], 3 * RT_WIDE_BLOCK, RT_WIDE_BLOCK, ray, &t)) continue;
                if (rt_hit_before(t, block->id[lane], p->best[i])) p->best[i] = (RtHit){t, block->id[lane]};
                if (any) break;
            }
        } else {
            const RtWideSpheres *spheres = rt_wide_leaf_at(tree, ref);
            const RtWideList *list = rt_wide_leaf_at(tree, ref);
            for (uint32_t c = 0; c < rt_wide_count(ref); c++) {
                uint32_t id = rt_wide_kind(ref) == RT_WIDE_LIST ? list->id[c] : spheres[c / RT_WIDE_BLOCK].id[c % RT_WIDE_BLOCK];
                if (rt_test_object(g, id, ray, any, &p->best[i], NULL)) break;
            }
        }
        if (any && p->best[i].object != RT_NO_OBJECT) {
            p->limit[i] = -INFINITY;
            changed = true;
        } else if (p->best[i].t < p->limit[i]) {
            p->limit[i] = p->best[i].t;
            changed = true;
        }
    }
    return changed;
}

PROF_KERNEL void trace_packet(const RtWide *self, const RtWideTree *tree, Packet *p, const RtRay *rays, bool any, RtCrossing *room) {
    const RtGeometry *g = &self->base.scene->geometry;
    const bool ordered = !any && self->order;
    uint32_t top = 0;
    RtWideRef ref = 0, parent = 0;
    for (;;) {
        if (rt_wide_kind(ref) == RT_WIDE_NODE) {
            const RtWideNode *node = rt_wide_node(tree, ref);
            __m256 enter;
            uint32_t mask = meet_packet(node, p, &enter);
            if (mask) {
                __m256i keys = _mm256_castps_si256(enter), refs = _mm256_load_si256((const __m256i *)node->child);
                uint32_t lane = ordered ? least_lane(mask, keys) : 31 - (uint32_t)__builtin_clz(mask);
                uint32_t others = mask & ~(1u << lane);
                if (others) {
                    RtV8Order order = rt_v8_order(others);
                    __m256i from = _mm256_add_epi32(_mm256_set1_epi32((int)ref), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
                    _mm256_storeu_si256((__m256i *)&p->enter[top], rt_v8_take(order, keys));
                    _mm256_storeu_si256((__m256i *)&p->waiting[top], rt_v8_take(order, refs));
                    _mm256_storeu_si256((__m256i *)&p->parent[top], rt_v8_take(order, from));
                    top += (uint32_t)__builtin_popcount(others);
                    if (self->prefetch) prefetch(tree, p->waiting[top - 1]);
                }
                parent = ref + lane;
                ref = node->child[lane];
                continue;
            }
        } else {
            uint32_t mask = meet_rays(rt_wide_node(tree, rt_wide_place(parent)), parent & 7, p);
            if (mask && test_packet(tree, g, p, rays, ref, mask, any, room)) {
                p->limit_most = rt_v16_most(rt_v16_load(p->limit));
                if (any && p->limit_most < 0) return;
            }
        }
        do {
            if (top == 0) return;
            top--;
        } while (p->enter[top] > p->limit_most);
        ref = p->waiting[top];
        parent = p->parent[top];
    }
}

RT_KERNEL void trace(const RtWide *self, const RtWideTree *tree, const RtScratch *scratch, const RtRay *rays, size_t count,
                     RtHit *hits, uint32_t *blockers, RtTally *tallies) {
    if (tree->node_count > 0 && self->in_flight > 1 && count > 1 && !tree->divided) {
        Packet *p = (Packet *)(void *)((char *)scratch->own + RT_WIDE_MAX_IN_FLIGHT * sizeof(Flight));
        size_t done = 0, i = 0;
        for (; self->packets && !tallies && i + PACKET <= count; i += PACKET) {
            if (!begin_packet(p, &self->base.scene->geometry, rays + i)) continue;
            if (done < i) trace_many(self, tree, scratch, rays + done, i - done, hits ? hits + done : NULL, hits ? NULL : blockers + done, tallies);
            trace_packet(self, tree, p, rays + i, !hits, scratch->room);
            for (int k = 0; k < PACKET; k++) {
                if (hits)
                    hits[i + (size_t)k] = p->best[k];
                else
                    blockers[i + (size_t)k] = p->best[k].object;
            }
            done = i + PACKET;
        }
        if (done < count) trace_many(self, tree, scratch, rays + done, count - done, hits ? hits + done : NULL, hits ? NULL : blockers + done, tallies);
        return;
    }
    const RtGeometry *g = &self->base.scene->geometry;
    Flight *f = scratch->own;
    for (size_t i = 0; i < count; i++) {
        begin(f, tree, &self->base, scratch, &rays[i], i, tallies);
        if (tree->divided && !rt_surface_is_near(&f->ray))
            rt_test_all(g, &f->ray, !hits, &f->best, f->tally);
        else if (tree->node_count > 0)
            trace_one(self, tree, f, !hits, f->tally);
        RT_COUNT(f->tally, rays, 1);
        RT_COUNT(f->tally, hits, f->best.object != RT_NO_OBJECT);
        if (hits)
            hits[i] = f->best;
        else
            blockers[i] = f->best.object;
    }
}

static void nearest_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count, RtHit *hits) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->nearest, scratch, rays, count, hits, NULL, NULL);
}

static void nearest_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                            RtHit *hits, RtTally *tallies) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->nearest, scratch, rays, count, hits, NULL, tallies);
}

static void occluded_timed(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                           uint32_t *blockers) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->occluded, scratch, rays, count, NULL, blockers, NULL);
}

static void occluded_counted(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                             uint32_t *blockers, RtTally *tallies) {
    const RtWide *self = (const RtWide *)accel;
    trace(self, self->occluded, scratch, rays, count, NULL, blockers, tallies);
}

const RtWideKernels RT_WIDE_KERNELS = {nearest_timed, occluded_timed, nearest_counted, occluded_counted};
