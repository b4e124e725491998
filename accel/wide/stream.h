/* SPDX-License-Identifier: Apache-2.0 */
/* Rays that go each their own way: one after the other, or many at once on one thread.
 *
 * A ray alone waits for memory, then for one long chain of arithmetic after the other. So many are in flight
 * together, in lists by what they go on to: a node, a leaf of triangles, another leaf, or nothing any more.
 * One list after the other is taken up, in loops that do one short thing for each of its rays: the processor
 * works at several rays at once, and no branch depends on which way a ray went. As soon as it is known what a
 * ray goes on to that is fetched, and has come by the time it is its turn. The idea of following rays in
 * lists is Wald, Gribble, Boulos & Kensler's (2007, "SIMD Ray Stream Tracing"); there a list shares a node,
 * here it only shares the work to be done.
 *
 * A ray's own path is the same in either way, so the counts are. */
#ifndef RT_ACCEL_WIDE_STREAM_H
#define RT_ACCEL_WIDE_STREAM_H

#include "accel/wide/flight.h"

/* The answers to a stream: `hits` or `blockers`, and the tallies of the counted kernels. */
typedef struct Answers {
    RtHit *hits;
    uint32_t *blockers;
    RtTally *tallies;
} Answers;

RT_KERNEL Answers answers_from(Answers all, size_t first) {
    if (all.hits) return (Answers){all.hits + first, NULL, all.tallies};
    return (Answers){NULL, all.blockers + first, all.tallies};
}

RT_KERNEL void land(const Flight *f, Answers to) {
    RT_COUNT(f->tally, rays, 1);
    RT_COUNT(f->tally, hits, f->best.object != RT_NO_OBJECT);
    if (to.hits)
        to.hits[f->index] = f->best;
    else
        to.blockers[f->index] = f->best.object;
}

/* ---- one ray after the other ---- */

RT_KERNEL void fly_alone(const RtWide *self, const RtWideTree *tree, Flight *f, bool any, RtTally *tally) {
    const RtGeometry *g = &self->base.scene->geometry;
    const bool ordered = !any && self->order;
    RtWideRef ref = 0;
    do {
        if (rt_wide_kind(ref) == RT_WIDE_NODE) {
            const RtWideNode *node = rt_wide_node(tree, ref);
            __m256 enter;
            uint32_t mask = meet(node, f, &enter);
            RT_COUNT(tally, steps, 1);
            RT_COUNT(tally, extent_tests, node->count);
            if ((mask & (mask - 1)) == 0 && mask != 0) {
                ref = node->child[__builtin_ctz(mask)];
            } else {
                ref = go_on(f, node, mask, enter, ordered, any);
                if (mask && self->prefetch) prefetch(tree, f->waiting[f->top - 1]);
            }
            continue;
        }
        count_leaf(tally, ref);
        if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) {
            const RtWideTriangles *blocks = rt_wide_leaf_at(tree, ref);
            uint32_t mask = sieve_leaf(blocks, ref, &f->axes);
            if (test_triangles(blocks, mask, &f->ray, any, &f->best, tally)) return;
        } else if (test_objects(tree, g, ref, &f->ray, any, &f->best, tally)) {
            return;
        }
        if (!any) narrow(f);
        ref = f->waiting[--f->top];
    } while (ref != RT_WIDE_DONE);
}

RT_KERNEL void trace_singly(const RtWide *self, const RtWideTree *tree, const RtScratch *scratch,
                            const RtRay *rays, size_t count, Answers to) {
    Flight *f = scratch->own;
    for (size_t i = 0; i < count; i++) {
        if (take_off(f, tree, &self->base.scene->geometry, scratch, &rays[i], i, !to.hits, to.tallies))
            fly_alone(self, tree, f, !to.hits, f->tally);
        land(f, to);
    }
}

/* ---- many at once ---- */

typedef struct Traffic {
    const RtWide *self;
    const RtWideTree *tree;
    const RtScratch *scratch;
    const RtRay *rays;
    size_t begun, count; /* of the rays */
    uint32_t in_flight;
    uint64_t visits;     /* of nodes and leaves, for whoever compares with packets */
    uint32_t waiting[4]; /* rays that go on to each RtWideKind; RT_WIDE_DONE is a list */
    Flight *list[4][RT_WIDE_MAX_IN_FLIGHT];
} Traffic;

/* Enters a flight in a list, if `one` is 1; where it is 0 the entry is written over by the next. */
RT_KERNEL void enlist(Traffic *t, Flight *f, RtWideRef next, uint32_t one) {
    uint32_t kind = rt_wide_kind(next), count = t->waiting[kind];
    f->next = next;
    t->list[kind][count] = f;
    t->waiting[kind] = count + one;
    if (t->self->prefetch) prefetch(t->tree, next);
}

/* How many are in a list, which is empty from now on; they stay where they are until as many are entered. */
RT_KERNEL uint32_t take_list(Traffic *t, RtWideKind kind) {
    uint32_t count = t->waiting[kind];
    t->waiting[kind] = 0;
    return count;
}

RT_KERNEL void visit_nodes(Traffic *t, bool any, bool counted) {
    _Alignas(RT_CACHE_LINE) float enters[RT_WIDE_MAX_IN_FLIGHT][RT_WIDE];
    uint32_t masks[RT_WIDE_MAX_IN_FLIGHT], n = take_list(t, RT_WIDE_NODE);
    const bool ordered = !any && t->self->order;
    t->visits += n;
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = t->list[RT_WIDE_NODE][i];
        const RtWideNode *node = rt_wide_node(t->tree, f->next);
        __m256 enter;
        masks[i] = meet(node, f, &enter);
        if (!any) _mm256_store_ps(enters[i], enter);
        if (counted) f->tally->steps++, f->tally->extent_tests += node->count;
    }
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = t->list[RT_WIDE_NODE][i];
        const RtWideNode *node = rt_wide_node(t->tree, f->next);
        enlist(t, f,
               go_on(f, node, masks[i], any ? _mm256_setzero_ps() : _mm256_load_ps(enters[i]), ordered, any),
               1);
    }
}

/* Some triangles of a leaf that a ray is to be tested against in full. */
typedef struct Suspects {
    Flight *flight;
    uint32_t mask;
} Suspects;

/* Of the rays at leaves of triangles those with suspects, to found[0..result); the others go on. */
RT_KERNEL uint32_t sieve_leaves(Traffic *t, Suspects *found, bool counted) {
    uint32_t masks[RT_WIDE_MAX_IN_FLIGHT], n = take_list(t, RT_WIDE_TRIANGLES), count = 0;
    t->visits += n;
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = t->list[RT_WIDE_TRIANGLES][i];
        if (counted) count_leaf(f->tally, f->next);
        masks[i] = sieve_leaf(rt_wide_leaf_at(t->tree, f->next), f->next, &f->axes);
    }
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = t->list[RT_WIDE_TRIANGLES][i];
        uint32_t none = masks[i] == 0;
        RtWideRef popped = f->waiting[f->top - 1];
        found[count] = (Suspects){f, masks[i]};
        count += !none;
        f->top -= none;
        enlist(t, f, none ? popped : f->next, none);
    }
    return count;
}

RT_KERNEL void leave_leaf(Traffic *t, Flight *f, bool over, bool any) {
    RtWideRef next = RT_WIDE_DONE;
    if (!over) {
        if (!any) narrow(f);
        next = f->waiting[--f->top];
    }
    enlist(t, f, next, 1);
}

/* Tests the other leaves. */
RT_KERNEL void visit_objects(Traffic *t, bool any) {
    const RtGeometry *g = &t->self->base.scene->geometry;
    uint32_t n = take_list(t, RT_WIDE_OBJECTS);
    t->visits += n;
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = t->list[RT_WIDE_OBJECTS][i];
        count_leaf(f->tally, f->next);
        leave_leaf(t, f, test_objects(t->tree, g, f->next, &f->ray, any, &f->best, f->tally), any);
    }
}

/* Sends rays off until one is in flight, or there are no more. */
RT_KERNEL void send_off(Traffic *t, Flight *f, Answers to) {
    while (t->begun < t->count) {
        size_t i = t->begun++;
        if (take_off(f, t->tree, &t->self->base.scene->geometry, t->scratch, &t->rays[i], i, !to.hits,
                     to.tallies)) {
            t->in_flight++;
            enlist(t, f, 0, 1);
            return;
        }
        land(f, to);
    }
}

RT_KERNEL uint64_t trace_many(const RtWide *self, const RtWideTree *tree, const RtScratch *scratch,
                              const RtRay *rays, size_t count, Answers to) {
    const bool any = !to.hits, counted = to.tallies != NULL;
    Suspects suspects[RT_WIDE_MAX_IN_FLIGHT];
    Flight *flights = scratch->own;
    Traffic t = {self, tree, scratch, rays, .count = count};
    for (uint32_t i = 0; i < self->in_flight; i++) send_off(&t, &flights[i], to);
    while (t.in_flight > 0) {
        while (t.waiting[RT_WIDE_NODE] > t.in_flight / 4) visit_nodes(&t, any, counted);
        uint32_t n = sieve_leaves(&t, suspects, counted);
        for (uint32_t i = 0; i < n; i++) {
            Flight *f = suspects[i].flight;
            const RtWideTriangles *blocks = rt_wide_leaf_at(tree, f->next);
            leave_leaf(&t, f, test_triangles(blocks, suspects[i].mask, &f->ray, any, &f->best, f->tally),
                       any);
        }
        if (t.waiting[RT_WIDE_OBJECTS]) visit_objects(&t, any);
        n = take_list(&t, RT_WIDE_LANDED);
        t.in_flight -= n;
        for (uint32_t i = 0; i < n; i++) {
            Flight *f = t.list[RT_WIDE_LANDED][i];
            land(f, to);
            send_off(&t, f, to);
        }
    }
    return t.visits;
}

#endif
