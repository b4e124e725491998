/* SPDX-License-Identifier: Apache-2.0 */
/* The traversals, included once for each instruction set: RT_WIDE_KERNELS is the name of the table that is
 * defined. */
#include "accel/kernel.h"
#include "accel/surface.h"
#include "accel/wide/simd.h"
#include "accel/wide/wide.h"
#include "base/memory.h"

#include <string.h>

/* One ray on its way. */
typedef struct Flight {
    _Alignas(RT_CACHE_LINE) RtPreparedRay ray;
    RtHit best;
    float limit;        /* the best t so far, or tmax */
    uint32_t near[3];   /* which plane of each axis is met first: 2 a or 2 a + 1 */
    uint32_t kx, ky, kz;
    float org_x, org_y, org_z; /* along kx, ky, kz */
    uint32_t top;       /* of the stack: how many entries */
    RtWideRef next;     /* what it goes on to */
    size_t index;       /* in the stream */
    RtTally *tally;
    float enter[RT_WIDE_STACK]; /* what waits, the next one last; under all of it RT_WIDE_DONE */
    RtWideRef waiting[RT_WIDE_STACK];
} Flight;

_Static_assert(sizeof(Flight) <= 6144, "fits");

RT_KERNEL void begin(Flight *f, const RtWideTree *tree, const RtAccel *accel, const RtScratch *scratch,
                     const RtRay *ray, size_t index, RtTally *tallies) {
    const RtGeometry *g = &accel->scene->geometry;
    rt_hit_ray(&f->ray, g, ray, scratch->room);
    if (tree->divided) rt_surface_thicken(&f->ray, &g->box);
    f->best = RT_MISS;
    f->limit = f->ray.tmax;
    for (uint32_t a = 0; a < 3; a++) f->near[a] = 2 * a + f->ray.negative[a];
    f->kx = (uint32_t)f->ray.kx, f->ky = (uint32_t)f->ray.ky, f->kz = (uint32_t)f->ray.kz;
    f->org_x = f->ray.org.at[f->kx], f->org_y = f->ray.org.at[f->ky], f->org_z = f->ray.org.at[f->kz];
    f->enter[0] = -INFINITY;
    f->waiting[0] = RT_WIDE_DONE;
    f->top = 1;
    f->index = index;
    f->tally = tallies ? &tallies[ray->kind] : NULL;
}

/* The children that the ray meets, as a mask; where it enters each, to *enter. */
RT_KERNEL uint32_t meet(const RtWideNode *node, const Flight *f, __m256 *enter) {
    const RtPreparedRay *r = &f->ray;
    __m256 near = _mm256_set1_ps(r->tmin), far = _mm256_set1_ps(f->limit);
    for (uint32_t a = 0; a < 3; a++) {
        __m256 inv = _mm256_set1_ps(r->inv[a]);
        __m256 first = _mm256_sub_ps(_mm256_load_ps(node->plane[f->near[a]]), _mm256_set1_ps(r->org_near[a]));
        __m256 second = _mm256_sub_ps(_mm256_load_ps(node->plane[f->near[a] ^ 1]), _mm256_set1_ps(r->org_far[a]));
        near = _mm256_max_ps(_mm256_mul_ps(first, inv), near);
        far = _mm256_min_ps(_mm256_mul_ps(second, inv), far);
    }
    *enter = near;
    return rt_v8_at_most(near, far);
}

/* Goes on to the nearest child of the mask, and waits with the others; where there is none, to what waits
 * last. Without a branch. */
RT_KERNEL RtWideRef go_on(Flight *f, const RtWideNode *node, uint32_t mask, __m256 enter, bool ordered) {
    __m256i keys = _mm256_castps_si256(enter), refs = _mm256_load_si256((const __m256i *)node->child);
    uint32_t top = f->top, lane, none = mask == 0;
    RtWideRef popped = f->waiting[top - 1];
    if (ordered) {
        /* The least key: entries are at least 0, so their bits are in their order. Its lane is in the lowest bits. */
        const __m256i lanes = _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7), last = _mm256_set1_epi32(INT32_MAX);
        __m256i key = _mm256_or_si256(_mm256_and_si256(keys, _mm256_set1_epi32(~7)), lanes);
#if defined(__AVX512VL__)
        key = _mm256_mask_mov_epi32(last, (__mmask8)mask, key);
#else
        const __m256i bits = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
        __m256i in = _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)mask), bits), bits);
        key = _mm256_blendv_epi8(last, key, in);
#endif
        __m128i least = _mm_min_epi32(_mm256_castsi256_si128(key), _mm256_extracti128_si256(key, 1));
        least = _mm_min_epi32(least, _mm_shuffle_epi32(least, 0x4e));
        least = _mm_min_epi32(least, _mm_shuffle_epi32(least, 0xb1));
        lane = (uint32_t)_mm_cvtsi128_si32(least) & 7;
    } else {
        lane = 31 - (uint32_t)__builtin_clz(mask | 1);
    }
    uint32_t others = mask & ~(1u << lane);
    RtV8Order order = rt_v8_order(others);
    RtWideRef near = node->child[lane];
    _mm256_storeu_si256((__m256i *)&f->enter[top], rt_v8_take(order, keys));
    _mm256_storeu_si256((__m256i *)&f->waiting[top], rt_v8_take(order, refs));
    f->top = top + (uint32_t)__builtin_popcount(others) - none;
    return none ? popped : near;
}

/* Of a block those triangles that the ray may meet, as a mask: all that rt_triangle_hit would not turn away by
 * its edge functions in float32, which are computed as there. */
RT_KERNEL uint32_t may_hit(const RtWideTriangles *block, const Flight *f) {
    const __m128 org_x = _mm_set1_ps(f->org_x), org_y = _mm_set1_ps(f->org_y), org_z = _mm_set1_ps(f->org_z);
    const __m128 shear_x = _mm_set1_ps(f->ray.shear_x), shear_y = _mm_set1_ps(f->ray.shear_y);
    __m128 x[3], y[3];
    for (int i = 0; i < 3; i++) {
        __m128 z = _mm_sub_ps(_mm_load_ps(block->v[i][f->kz]), org_z);
        x[i] = _mm_sub_ps(_mm_sub_ps(_mm_load_ps(block->v[i][f->kx]), org_x), _mm_mul_ps(shear_x, z));
        y[i] = _mm_sub_ps(_mm_sub_ps(_mm_load_ps(block->v[i][f->ky]), org_y), _mm_mul_ps(shear_y, z));
    }
    __m128 u = _mm_sub_ps(_mm_mul_ps(x[2], y[1]), _mm_mul_ps(y[2], x[1]));
    __m128 v = _mm_sub_ps(_mm_mul_ps(x[0], y[2]), _mm_mul_ps(y[0], x[2]));
    __m128 w = _mm_sub_ps(_mm_mul_ps(x[1], y[0]), _mm_mul_ps(y[1], x[0]));
    __m128 least = _mm_min_ps(_mm_min_ps(u, v), w), most = _mm_max_ps(_mm_max_ps(u, v), w);
    __m128 zero = _mm_setzero_ps();
    __m128 both = _mm_and_ps(_mm_cmplt_ps(least, zero), _mm_cmpgt_ps(most, zero));
    return ~(uint32_t)_mm_movemask_ps(both) & 15;
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

/* Bit i: triangle i of the leaf is to be tested in full. */
RT_KERNEL uint32_t may_hit_leaf(const RtWideTree *tree, const Flight *f, RtWideRef ref) {
    const RtWideTriangles *block = &tree->triangles[rt_wide_index(ref)];
    uint32_t count = rt_wide_count(ref), mask = may_hit(block, f);
    for (uint32_t b = 1; b * RT_WIDE_BLOCK < count; b++) mask |= may_hit(&block[b], f) << b * RT_WIDE_BLOCK;
    return mask & ((2u << (count - 1)) - 1);
}

/* Tests those triangles of a leaf; true where the search is over. */
RT_KERNEL bool test_triangles(const RtWideTree *tree, Flight *f, RtWideRef ref, uint32_t mask, bool any, RtTally *tally) {
    const RtWideTriangles *blocks = &tree->triangles[rt_wide_index(ref)];
    for (; mask; mask &= mask - 1) {
        uint32_t i = (uint32_t)__builtin_ctz(mask), lane = i % RT_WIDE_BLOCK;
        const RtWideTriangles *block = &blocks[i / RT_WIDE_BLOCK];
        RtTriangle triangle;
        float t;
        for (int v = 0; v < 3; v++) {
            for (int a = 0; a < 3; a++) triangle.v[v].at[a] = block->v[v][a][lane];
        }
        if (!rt_triangle_hit(&triangle, &f->ray, &t)) continue;
        RT_COUNT(tally, object_hits, 1);
        if (rt_hit_before(t, block->id[lane], f->best)) f->best = (RtHit){t, block->id[lane]};
        if (any) return true;
    }
    return false;
}

/* Tests what else is in a leaf; true where the search is over. */
RT_KERNEL bool test_objects(const RtWideTree *tree, const RtGeometry *g, Flight *f, RtWideRef ref, bool any, RtTally *tally) {
    uint32_t first = rt_wide_index(ref), count = rt_wide_count(ref);
    for (uint32_t i = 0; i < count; i++) {
        uint32_t id = rt_wide_kind(ref) == RT_WIDE_LIST ? tree->ids[first + i] : tree->spheres[first + i / RT_WIDE_BLOCK].id[i % RT_WIDE_BLOCK];
        if (rt_test_object(g, id, &f->ray, any, &f->best, tally)) return true;
    }
    return false;
}

/* What follows a leaf in which something was tested. */
RT_KERNEL void narrow(Flight *f) {
    float limit = rt_minf(f->best.t, f->ray.tmax);
    if (!(limit < f->limit)) return;
    f->limit = limit;
    drop(f);
}

RT_KERNEL void prefetch_lines(const void *at, int lines) {
    for (int i = 0; i < lines; i++) __builtin_prefetch((const char *)at + i * RT_CACHE_LINE, 0, 3);
}

RT_KERNEL void prefetch(const RtWideTree *tree, RtWideRef ref) {
    uint32_t index = rt_wide_index(ref);
    const char *node = (const char *)&tree->nodes[index], *block = (const char *)&tree->triangles[index];
    const char *at = rt_wide_kind(ref) == RT_WIDE_NODE ? node : block;
    prefetch_lines(at, 4);
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
            const RtWideNode *node = &tree->nodes[ref];
            __m256 enter;
            uint32_t mask = meet(node, f, &enter);
            RT_COUNT(tally, steps, 1);
            RT_COUNT(tally, extent_tests, node->count);
            if (mask && !(mask & (mask - 1))) {
                ref = node->child[__builtin_ctz(mask)];
                continue;
            }
            if (mask) {
                ref = go_on(f, node, mask, enter, ordered);
                if (self->prefetch) prefetch(tree, f->waiting[f->top - 1]);
                continue;
            }
        } else {
            count_leaf(tally, ref);
            if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) {
                if (test_triangles(tree, f, ref, may_hit_leaf(tree, f, ref), any, tally)) return;
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
    uint32_t kind = next >> 30;
    f->next = next;
    lists->of[kind][lists->count[kind]] = f;
    lists->count[kind] += one;
    if (ahead) prefetch(tree, next);
}

static __attribute__((noinline)) void visit(Lists *lists, const RtWideTree *tree, bool ordered, bool ahead, bool counted) {
    uint32_t n = lists->count[RT_WIDE_NODE];
    lists->count[RT_WIDE_NODE] = 0;
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = lists->of[RT_WIDE_NODE][i];
        const RtWideNode *node = &tree->nodes[f->next];
        __m256 enter;
        uint32_t mask = meet(node, f, &enter);
        if (counted) {
            f->tally->steps++;
            f->tally->extent_tests += node->count;
        }
        enlist(lists, tree, f, go_on(f, node, mask, enter, ordered), 1, ahead);
    }
}

typedef struct Candidate {
    Flight *flight;
    uint32_t mask;
} Candidate;

static __attribute__((noinline)) uint32_t sieve(Lists *lists, const RtWideTree *tree, Candidate *candidates, bool ahead, bool counted) {
    uint32_t n = lists->count[RT_WIDE_TRIANGLES], found = 0;
    lists->count[RT_WIDE_TRIANGLES] = 0;
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = lists->of[RT_WIDE_TRIANGLES][i];
        if (counted) count_leaf(f->tally, f->next);
        uint32_t mask = may_hit_leaf(tree, f, f->next), none = mask == 0;
        candidates[found] = (Candidate){f, mask};
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
        while (lists.count[RT_WIDE_NODE] > active / 4) visit(&lists, tree, ordered, ahead, tallies != NULL);
        uint32_t found = sieve(&lists, tree, candidates, ahead, tallies != NULL);
        for (uint32_t i = 0; i < found; i++) {
            Flight *f = candidates[i].flight;
            RtWideRef next = RT_WIDE_DONE;
            if (!test_triangles(tree, f, f->next, candidates[i].mask, any, f->tally)) {
                narrow(f);
                next = f->waiting[--f->top];
            }
            enlist(&lists, tree, f, next, 1, ahead);
        }
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
    }
}

RT_KERNEL void trace(const RtWide *self, const RtWideTree *tree, const RtScratch *scratch, const RtRay *rays, size_t count,
                     RtHit *hits, uint32_t *blockers, RtTally *tallies) {
    if (tree->node_count > 0 && self->in_flight > 1 && count > 1 && !tree->divided) {
        trace_many(self, tree, scratch, rays, count, hits, blockers, tallies);
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
