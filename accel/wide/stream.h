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

/* What is asked: a stream of rays, and where the answers go. */
typedef struct Question {
    const RtWide *self;
    const RtWideTree *tree;
    const RtGeometry *geometry;
    const RtScratch *scratch;
    const RtRay *rays;
    RtHit *hits;         /* of `nearest` */
    uint32_t *occluders; /* of `occluded` */
    RtTally *tallies;    /* of the counted kernels */
} Question;

/* The ray is answered by what the flight has found. */
RT_KERNEL void land(const Question *q, const Flight *f, bool any, bool counted) {
    RtTally *tally = counted ? f->tally : NULL;
    RT_COUNT(tally, rays, 1);
    RT_COUNT(tally, hits, f->best.object != RT_NO_OBJECT);
    if (any)
        q->occluders[f->index] = f->best.object;
    else
        q->hits[f->index] = f->best;
}

/* ---- one ray after the other ---- */

RT_KERNEL void fly_alone(const Question *q, Flight *f, bool any, bool counted) {
    const RtWideTree *tree = q->tree;
    RtTally *tally = counted ? f->tally : NULL;
    const bool ordered = !any && q->self->order, ahead = q->self->prefetch;
    RtWideRef ref = 0;
    do {
        if (rt_wide_kind(ref) == RT_WIDE_NODE) {
            const RtWideNode *node = rt_wide_node(tree, ref);
            RtFloat8 enter;
            uint32_t mask = meet(node, f, &enter);
            RT_COUNT(tally, steps, 1);
            RT_COUNT(tally, extent_tests, node->count);
            if (RT_OBSERVED(tally)) observe_node(node, ref, mask);
            if ((mask & (mask - 1)) == 0 && mask != 0) {
                ref = node->child[__builtin_ctz(mask)];
            } else {
                ref = go_on(f, node, mask, enter, ordered, any);
                if (mask && ahead) prefetch(tree, f->waiting[f->top - 1]);
            }
            continue;
        }
        count_leaf(tally, tree, q->geometry, ref);
        if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) {
            const RtWideTriangles *blocks = rt_wide_leaf_at(tree, ref);
            uint32_t mask = sieve_leaf(blocks, ref, &f->axes);
            if (test_triangles(blocks, mask, &f->axes, &f->ray, any, &f->best, tally)) return;
        } else if (test_objects(tree, q->geometry, ref, &f->ray, any, &f->best, tally)) {
            return;
        }
        if (!any) narrow(f);
        ref = f->waiting[--f->top];
    } while (ref != RT_WIDE_DONE);
}

RT_KERNEL void trace_singly(const Question *q, size_t first, size_t count, bool any, bool counted) {
    Flight *f = q->scratch->own;
    for (size_t i = first; i < first + count; i++) {
        RtTally *tally = counted ? &q->tallies[q->rays[i].kind] : NULL;
        if (take_off(f, q->tree, q->geometry, q->scratch, &q->rays[i], i, any, tally))
            fly_alone(q, f, any, counted);
        land(q, f, any, counted);
    }
}

/* ---- many at once ---- */

typedef struct Traffic {
    size_t next, end; /* of the question's rays: the first that is not under way, and where they end */
    uint32_t in_flight;
    uint32_t waiting[4]; /* rays that go on to each RtWideKind */
    Flight *list[4][RT_WIDE_MAX_IN_FLIGHT];
} Traffic;

/* Enters a flight in a list, if `one` is 1; where it is 0 the entry is written over by the next. */
RT_KERNEL void enlist(Traffic *t, const RtWideTree *tree, Flight *f, RtWideRef next, uint32_t one,
                      bool ahead) {
    uint32_t kind = rt_wide_kind(next), count = t->waiting[kind];
    f->next = next;
    t->list[kind][count] = f;
    t->waiting[kind] = count + one;
    if (ahead) prefetch(tree, next);
}

/* How many are in a list, which is empty from now on; they stay where they are until as many are entered. */
RT_KERNEL uint32_t take_list(Traffic *t, RtWideKind kind) {
    uint32_t count = t->waiting[kind];
    t->waiting[kind] = 0;
    return count;
}

RT_KERNEL void visit_nodes(const Question *q, Traffic *t, bool any, bool counted, bool ahead) {
    _Alignas(RT_CACHE_LINE) float enters[RT_WIDE_MAX_IN_FLIGHT][RT_WIDE];
    uint32_t masks[RT_WIDE_MAX_IN_FLIGHT], n = take_list(t, RT_WIDE_NODE);
    const bool ordered = !any && q->self->order;
    const RtWideTree tree = *q->tree;
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = t->list[RT_WIDE_NODE][i];
        const RtWideNode *node = rt_wide_node(&tree, f->next);
        RtFloat8 enter;
        masks[i] = meet(node, f, &enter);
        if (!any) rt_store(enters[i], enter);
        if (counted) {
            f->tally->steps++, f->tally->extent_tests += node->count;
            if (RT_OBSERVED(f->tally)) observe_node(node, f->next, masks[i]);
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = t->list[RT_WIDE_NODE][i];
        const RtWideNode *node = rt_wide_node(&tree, f->next);
        RtFloat8 enter = any ? rt_all8(0) : rt_load8(enters[i]);
        enlist(t, &tree, f, go_on(f, node, masks[i], enter, ordered, any), 1, ahead);
    }
}

/* Some triangles of a leaf that a ray is to be tested against in full. */
typedef struct Suspects {
    Flight *flight;
    uint32_t mask;
} Suspects;

/* Of the rays at leaves of triangles those with suspects, to found[0..result); the others go on. */
RT_KERNEL uint32_t sieve_leaves(const Question *q, Traffic *t, Suspects *found, bool counted, bool ahead) {
    uint32_t masks[RT_WIDE_MAX_IN_FLIGHT], n = take_list(t, RT_WIDE_TRIANGLES), count = 0;
    const RtWideTree tree = *q->tree;
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = t->list[RT_WIDE_TRIANGLES][i];
        if (counted) count_leaf(f->tally, &tree, q->geometry, f->next);
        masks[i] = sieve_leaf(rt_wide_leaf_at(&tree, f->next), f->next, &f->axes);
    }
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = t->list[RT_WIDE_TRIANGLES][i];
        uint32_t none = masks[i] == 0;
        RtWideRef popped = f->waiting[f->top - 1];
        found[count] = (Suspects){f, masks[i]};
        count += !none;
        f->top -= none;
        enlist(t, &tree, f, none ? popped : f->next, none, ahead);
    }
    return count;
}

RT_KERNEL void leave_leaf(const Question *q, Traffic *t, Flight *f, bool over, bool any, bool ahead) {
    RtWideRef next = RT_WIDE_DONE;
    if (!over) {
        if (!any) narrow(f);
        next = f->waiting[--f->top];
    }
    enlist(t, q->tree, f, next, 1, ahead);
}

/* Tests the other leaves. */
RT_KERNEL void visit_objects(const Question *q, Traffic *t, bool any, bool counted, bool ahead) {
    uint32_t n = take_list(t, RT_WIDE_OBJECTS);
    for (uint32_t i = 0; i < n; i++) {
        Flight *f = t->list[RT_WIDE_OBJECTS][i];
        RtTally *tally = counted ? f->tally : NULL;
        count_leaf(tally, q->tree, q->geometry, f->next);
        leave_leaf(q, t, f, test_objects(q->tree, q->geometry, f->next, &f->ray, any, &f->best, tally), any,
                   ahead);
    }
}

/* Sends rays off until one is in flight, or there are no more. */
RT_KERNEL void send_off(const Question *q, Traffic *t, Flight *f, bool any, bool counted, bool ahead) {
    while (t->next < t->end) {
        size_t i = t->next++;
        RtTally *tally = counted ? &q->tallies[q->rays[i].kind] : NULL;
        if (take_off(f, q->tree, q->geometry, q->scratch, &q->rays[i], i, any, tally)) {
            t->in_flight++;
            enlist(t, q->tree, f, 0, 1, ahead);
            return;
        }
        land(q, f, any, counted);
    }
}

RT_KERNEL void trace_many(const Question *q, size_t first, size_t count, bool any, bool counted) {
    const bool ahead = q->self->prefetch;
    Suspects suspects[RT_WIDE_MAX_IN_FLIGHT];
    Flight *flights = q->scratch->own;
    Traffic t = {.next = first, .end = first + count};
    for (uint32_t i = 0; i < q->self->in_flight; i++) send_off(q, &t, &flights[i], any, counted, ahead);
    while (t.in_flight > 0) {
        while (t.waiting[RT_WIDE_NODE] > t.in_flight / 4) visit_nodes(q, &t, any, counted, ahead);
        uint32_t n = sieve_leaves(q, &t, suspects, counted, ahead);
        for (uint32_t i = 0; i < n; i++) {
            Flight *f = suspects[i].flight;
            const RtWideTriangles *blocks = rt_wide_leaf_at(q->tree, f->next);
            bool over = test_triangles(blocks, suspects[i].mask, &f->axes, &f->ray, any, &f->best,
                                       counted ? f->tally : NULL);
            leave_leaf(q, &t, f, over, any, ahead);
        }
        if (t.waiting[RT_WIDE_OBJECTS]) visit_objects(q, &t, any, counted, ahead);
        n = take_list(&t, RT_WIDE_LANDED);
        t.in_flight -= n;
        for (uint32_t i = 0; i < n; i++) {
            Flight *f = t.list[RT_WIDE_LANDED][i];
            land(q, f, any, counted);
            send_off(q, &t, f, any, counted, ahead);
        }
    }
}

#endif
