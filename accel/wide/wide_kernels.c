/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of `wide`, compiled once for each instruction set (accel/isa.h): rays traced independently, one
 * after the other or many interleaved on one thread, and the choice of packets (packet.h).
 *
 * A single ray waits for memory and for long chains of dependent arithmetic. So many rays are in flight, in
 * queues by what each visits next: a node, a leaf of triangles, one of spheres, another leaf or nothing. Each
 * queue is processed by a loop with one short body: the processor overlaps several rays, and no branch
 * depends on the path of a ray. What a ray visits next is prefetched when it is enqueued. Wald, Gribble,
 * Boulos & Kensler 2007 ("SIMD Ray Stream Tracing") process rays in lists; their lists share a node, these
 * queues only share the kind of work.
 *
 * Rays are traced in packets while the rays of a packet share enough of their visits, else one by one in
 * streams. The sharing is estimated from the packets traced last, and packets are tried again from time to
 * time. Few rays, as those of a packet that enter an instance may be, are traced one after the other. Counted
 * kernels trace no packets, because a count belongs to one ray, and no ray alone, whose stack has another
 * order: they always have rays in flight. */
#include "accel/wide/packet.h"

/* Writes the answer of a ray. */
RT_KERNEL void finish_ray(const Query *q, const RayState *f, bool any, bool counted) {
    rt_put_answer(&f->best, f->index, any, q->hits, q->occluders, counted ? f->tally : NULL);
}

/* ---- one ray after the other ---- */

/* A ray at nodes, in registers: filled where a visit of nodes begins, so that none is live across a leaf. */
typedef struct NodeRay {
    RtFloat8 inv[3], near[3], far[3], tmin, limit; /* near, far: org_near, org_far; fused: times inv */
    size_t near_at[3], far_at[3];                  /* offsets of planes */
} NodeRay;

RT_KERNEL NodeRay at_nodes(const RayState *f) {
    NodeRay r;
    r.tmin = rt_all8(f->tmin);
    r.limit = rt_all8(f->limit);
#pragma GCC unroll 3
    for (int a = 0; a < 3; a++) {
        r.inv[a] = rt_all8(f->inv[a]);
        r.near[a] = rt_all8(f->org_near[a]);
        r.far[a] = rt_all8(f->org_far[a]);
        r.near_at[a] = f->near[a];
        r.far_at[a] = f->far[a];
    }
    return r;
}

/* hit_children, of a NodeRay; fused: see ray.h. Streams visit one node at a time, for which filling a NodeRay
 * does not pay: by this function they take up to twice the time where vectors have four lanes. */
RT_KERNEL uint32_t meet_children(const RtWideNode *node, const NodeRay *r, bool fused, RtFloat8 *enter) {
    RtFloat8 near = r->tmin, far = r->limit;
#pragma GCC unroll 3
    for (int a = 0; a < 3; a++) {
        const RtFloat8 first = rt_load8((const char *)node + r->near_at[a]);
        const RtFloat8 last = rt_load8((const char *)node + r->far_at[a]);
        near = rt_max(fused ? rt_fused_less8(first, r->inv[a], r->near[a]) : (first - r->near[a]) * r->inv[a],
                      near);
        far =
            rt_min(fused ? rt_fused_less8(last, r->inv[a], r->far[a]) : (last - r->far[a]) * r->inv[a], far);
    }
    *enter = near;
    return rt_le_bits(near, far);
}

/* Pops the stack until an entry is not entered beyond the best hit; the bottom is entered at -infinity. */
RT_KERNEL RtWideRef pop(const RayState *f, uint32_t *top, float limit, bool any) {
    do {
        --*top;
    } while (!any && f->enter[*top] > limit);
    return f->stack[*top];
}

/* From `ref`, a node, to a leaf, or RT_WIDE_DONE. */
RT_KERNEL RtWideRef find_leaf(RayState *f, const RtWideTree *tree, RtWideRef ref, bool any, bool ordered,
                              bool ahead, bool fused) {
    const NodeRay r = at_nodes(f);
    const float limit = f->limit;
    uint32_t top = f->top;
    do {
        const RtWideNode *node = rt_wide_node(tree, ref);
        if (ahead) __builtin_prefetch(node->child); /* comes while the planes do */
        RtFloat8 near;
        uint32_t mask = meet_children(node, &r, fused, &near);
        if (mask == 0) {
            ref = pop(f, &top, limit, any);
            continue;
        }
        uint32_t lane = (uint32_t)__builtin_ctz(mask);
        ref = node->child[lane];
        mask &= mask - 1;
        if (mask == 0) continue;
        _Alignas(RtFloat8) float enter[RT_WIDE];
        if (!any) rt_store(enter, near);
        float at = any ? 0 : enter[lane];
        do {
            lane = (uint32_t)__builtin_ctz(mask);
            mask &= mask - 1;
            RtWideRef other = node->child[lane];
            const float d = any ? 0 : enter[lane];
            if (any || d < at || !ordered) {
                f->stack[top] = ref;
                if (!any) f->enter[top] = at;
                ref = other;
                at = d;
            } else {
                f->stack[top] = other;
                f->enter[top] = d;
            }
            if (ahead) prefetch(tree, f->stack[top]);
            top++;
        } while (mask);
    } while (rt_wide_kind(ref) == RT_WIDE_NODE);
    f->top = top;
    return ref;
}

/* With one ray nothing overlaps a chain of dependent operations. Branches on the number of children hit cut
 * it, and an entry beyond the best hit is dropped when it is popped, not after each hit. */
RT_KERNEL void trace_one(const Query *q, RayState *f, bool any, bool fused) {
    const RtWideTree tree = *q->tree;
    const bool ordered = !any && q->self->order, ahead = q->self->prefetch;
    RtWideRef ref = 0;
    for (bool ready = false;; ready = true) {
        if (rt_wide_kind(ref) == RT_WIDE_NODE) ref = find_leaf(f, &tree, ref, any, ordered, ahead, fused);
        if (ref == RT_WIDE_DONE) return;
        if (!ready) init_leaves(f, &q->rays[f->index]); /* many rays reach none */
        if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) {
            const RtWideTriangles *block = rt_wide_leaf_at(&tree, ref), *last = block + rt_wide_has_more(ref);
            for (; block <= last; block++) {
                const RtSheared4 s = shear(block, f);
                const uint32_t mask = rt_edge_prefilter4(&s);
                if (mask && test_block(block, &s, mask, f, q, any, NULL)) return;
            }
        } else if (rt_wide_kind(ref) == RT_WIDE_SPHERES) {
            if (test_spheres(q, ref, f, any, NULL)) return;
        } else if (test_objects(q, ref, state_ray(f, q), any, &f->best, NULL)) {
            return;
        }
        if (!any) f->limit = rt_minf(f->best.t, f->limit);
        ref = pop(f, &f->top, f->limit, any);
    }
}

/* Whether the box tests of this ray may be fused, and then prepares it for that. */
RT_KERNEL bool fuse(const Query *q, RayState *f) {
    const RtFloat4 inv = rt_loadu4(f->inv), size = rt_abs(inv);
    if (!q->self->fused || q->tree->split_refs || rt_bits((size < 0x1p-40f) | (size > 0x1p40f)) & 7)
        return false;
    for (int a = 0; a < 3; a++) {
        f->org_near[a] *= f->inv[a];
        f->org_far[a] *= f->inv[a];
    }
    return true;
}

RT_KERNEL void trace_one_by_one(const Query *q, size_t count, bool any) {
    RayState *f = q->states;
    for (size_t i = 0; i < count; i++) {
        if (init_ray(f, q, i, any, false, NULL)) {
            if (RT_FUSES && fuse(q, f))
                trace_one(q, f, any, true);
            else
                trace_one(q, f, any, false);
        }
        finish_ray(q, f, any, false);
    }
}

/* ---- many at once ---- */

typedef struct RayQueues {
    uint32_t in_flight;
    uint32_t count[4]; /* rays in the queue of each RtWideKind */
    RayState *list[4][RT_WIDE_MAX_IN_FLIGHT];
} RayQueues;

/* Enqueues a ray if `one` is 1; if it is 0, the next entry overwrites it. */
RT_KERNEL void enqueue(RayQueues *t, const RtWideTree *tree, RayState *f, RtWideRef next, uint32_t one,
                       bool ahead) {
    uint32_t kind = rt_wide_kind(next), count = t->count[kind];
    f->next = next;
    t->list[kind][count] = f;
    t->count[kind] = count + one;
    if (ahead) prefetch(tree, next);
}

/* Empties a queue and returns its length. The entries stay in place until new ones overwrite them. */
RT_KERNEL uint32_t take_queue(RayQueues *t, RtWideKind kind) {
    uint32_t count = t->count[kind];
    t->count[kind] = 0;
    return count;
}

RT_KERNEL void visit_nodes(const Query *q, RayQueues *t, bool any, bool counted, bool ahead) {
    _Alignas(RT_CACHE_LINE) float enters[RT_WIDE_MAX_IN_FLIGHT][RT_WIDE];
    uint32_t masks[RT_WIDE_MAX_IN_FLIGHT], n = take_queue(t, RT_WIDE_NODE);
    const bool ordered = !any && q->self->order;
    const RtWideTree tree = *q->tree;
    for (uint32_t i = 0; i < n; i++) {
        RayState *f = t->list[RT_WIDE_NODE][i];
        const RtWideNode *node = rt_wide_node(&tree, f->next);
        RtFloat8 enter;
        masks[i] = hit_children(node, f, &enter);
        if (!any) rt_store(enters[i], enter);
        if (counted) {
            f->tally->steps++, f->tally->extent_tests += node->count;
            if (RT_OBSERVED(f->tally)) observe_node(node, f->next, masks[i]);
        }
    }
    for (uint32_t i = 0; i < n; i++) {
        RayState *f = t->list[RT_WIDE_NODE][i];
        const RtWideNode *node = rt_wide_node(&tree, f->next);
        RtFloat8 enter = any ? rt_all8(0) : rt_load8(enters[i]);
        enqueue(t, &tree, f, descend(f, node, masks[i], enter, ordered, any), 1, ahead);
    }
}

/* The triangles of a leaf that pass the prefilter for a ray. */
typedef struct Candidates {
    RayState *state;
    uint32_t mask;
} Candidates;

/* Prefilters all queued leaves of triangles: rays with candidates go to found[0..result), the others to
 * their next queue. */
RT_KERNEL uint32_t prefilter_leaves(const Query *q, RayQueues *t, Candidates *found, bool counted,
                                    bool ahead) {
    uint32_t masks[RT_WIDE_MAX_IN_FLIGHT], n = take_queue(t, RT_WIDE_TRIANGLES), count = 0;
    const RtWideTree tree = *q->tree;
    for (uint32_t i = 0; i < n; i++) {
        RayState *f = t->list[RT_WIDE_TRIANGLES][i];
        if (counted) count_leaf(f->tally, &tree, q->geometry, f->next);
        masks[i] = prefilter_leaf(rt_wide_leaf_at(&tree, f->next), f->next, f);
    }
    for (uint32_t i = 0; i < n; i++) {
        RayState *f = t->list[RT_WIDE_TRIANGLES][i];
        uint32_t none = masks[i] == 0;
        RtWideRef popped = f->stack[f->top - 1];
        found[count] = (Candidates){f, masks[i]};
        count += !none;
        f->top -= none;
        enqueue(t, &tree, f, none ? popped : f->next, none, ahead);
    }
    return count;
}

RT_KERNEL void finish_leaf(const Query *q, RayQueues *t, RayState *f, bool over, bool any, bool ahead) {
    RtWideRef next = RT_WIDE_DONE;
    if (!over) {
        if (!any) cull_stack(f);
        next = f->stack[--f->top];
    }
    enqueue(t, q->tree, f, next, 1, ahead);
}

/* Tests all queued leaves of spheres. */
RT_KERNEL void visit_spheres(const Query *q, RayQueues *t, bool any, bool counted, bool ahead) {
    SpherePair pairs[RT_WIDE_MAX_IN_FLIGHT * RT_WIDE_MAX_LEAF];
    float at[RT_WIDE_MAX_IN_FLIGHT * RT_WIDE_MAX_LEAF];
    uint32_t n = take_queue(t, RT_WIDE_SPHERES), count = 0, first = 0, ends[RT_WIDE_MAX_IN_FLIGHT];
    for (uint32_t i = 0; i < n; i++) {
        const RayState *f = t->list[RT_WIDE_SPHERES][i];
        ends[i] = count + list_count(q, f->next);
        for (uint32_t k = 0; count < ends[i]; k++)
            pairs[count++] = sphere_pair(q, &q->rays[f->index], f->next, k);
    }
    hit_sphere_pairs(q->geometry, pairs, count, at);
    for (uint32_t i = 0; i < n; i++) {
        RayState *f = t->list[RT_WIDE_SPHERES][i];
        RtTally *tally = counted ? f->tally : NULL;
        bool over = false;
        count_leaf(tally, q->tree, q->geometry, f->next);
        for (uint32_t k = first; k < ends[i] && !over; k++)
            over = rt_take_test(q->geometry, pairs[k].id, at[k], any, &f->best, tally);
        finish_leaf(q, t, f, over, any, ahead);
        first = ends[i];
    }
}

/* Starts rays until one is in flight, or none are left. */
RT_KERNEL void start_next_ray(const Query *q, RayQueues *t, RayState *f, bool any, bool counted, bool ahead) {
    while (more_rays(q)) {
        size_t i = q->source->index[q->source->taken++];
        RtTally *tally = counted ? &q->tallies[q->rays[i].kind] : NULL;
        if (init_ray(f, q, i, any, q->geometry->triangle_count > 0, tally)) {
            t->in_flight++;
            enqueue(t, q->tree, f, 0, 1, ahead);
            return;
        }
        finish_ray(q, f, any, counted);
    }
}

/* Tests the other leaves, and starts other rays in place of those that have finished. */
RT_KERNEL void visit_others(const Query *q, RayQueues *t, bool any, bool counted, bool ahead) {
    uint32_t n = take_queue(t, RT_WIDE_OBJECTS);
    for (uint32_t i = 0; i < n; i++) {
        RayState *f = t->list[RT_WIDE_OBJECTS][i];
        RtTally *tally = counted ? f->tally : NULL;
        if (f->next == RT_WIDE_DONE) {
            t->in_flight--;
            finish_ray(q, f, any, counted);
            start_next_ray(q, t, f, any, counted, ahead);
            continue;
        }
        count_leaf(tally, q->tree, q->geometry, f->next);
        finish_leaf(q, t, f, test_objects(q, f->next, state_ray(f, q), any, &f->best, tally), any, ahead);
    }
}

RT_KERNEL void trace_many(const Query *q, bool any, bool counted) {
    const bool ahead = q->self->prefetch;
    Candidates candidates[RT_WIDE_MAX_IN_FLIGHT];
    RayQueues t;
    t.in_flight = 0;
    memset(t.count, 0, sizeof t.count); /* not the lists: a stream may have few rays */
    for (uint32_t i = 0; i < q->self->in_flight; i++)
        start_next_ray(q, &t, &q->states[i], any, counted, ahead);
    while (t.in_flight > 0) {
        while (t.count[RT_WIDE_NODE] > t.in_flight / 4) visit_nodes(q, &t, any, counted, ahead);
        uint32_t n = prefilter_leaves(q, &t, candidates, counted, ahead);
        for (uint32_t i = 0; i < n; i++) {
            RayState *f = candidates[i].state;
            const RtWideTriangles *blocks = rt_wide_leaf_at(q->tree, f->next);
            bool over = test_triangles(blocks, candidates[i].mask, f, q, any, counted ? f->tally : NULL);
            finish_leaf(q, &t, f, over, any, ahead);
        }
        if (t.count[RT_WIDE_SPHERES]) visit_spheres(q, &t, any, counted, ahead);
        visit_others(q, &t, any, counted, ahead);
    }
}

/* ---- packets ---- */

/* A single packet would wait for each node to come from memory. So several are interleaved: while one waits
 * for its prefetched node, the others continue. */

RT_KERNEL void finish_packet(Packet *p, const Query *q, bool any) {
    test_pairs(p, q->tree, 1, any);
    for (uint32_t i = 0; i < p->count; i++)
        rt_put_answer(&p->best[i], p->index[i], any, q->hits, q->occluders, NULL);
}

/* Traces the next rays of a query, about `count`. */
RT_KERNEL Shared trace_packets(const Query *q, Packet *packets, Sorter *sorter, int32_t count, bool any) {
    Shared shared = {0};
    Packet *active[RT_WIDE_MAX_PACKETS];
    uint32_t n = 0, class;
    begin_sorting(sorter, count);
    for (; n < q->self->packets; n++) {
        class = sort_rays(sorter, q);
        if (class == CLASSES) break;
        active[n] = &packets[n];
        init_packet(active[n], q, sorter, class, any);
    }
    while (n > 0) {
        uint32_t kept = 0;
        for (uint32_t i = 0; i < n; i++) {
            Packet *p = active[kept] = active[i];
            if (step_packet(p, q, &shared, any)) {
                kept++;
                continue;
            }
            finish_packet(p, q, any);
            class = sort_rays(sorter, q);
            if (class == CLASSES) continue;
            init_packet(p, q, sorter, class, any);
            kept++;
        }
        n = kept;
    }
    return shared;
}

/* ---- packets or streams ---- */

/* What is known of the rays of a kind. */
typedef struct RateEstimate {
    float sharing;  /* rays per visit of a node, a moving average; 0: no packets traced yet */
    bool alone;     /* packets did not pay */
    uint64_t retry; /* rays until packets are tried again */
    uint32_t pause; /* of the filter (RaySource) */
} RateEstimate;

/* The scratch memory of a query. */
typedef struct Scratch {
    Packet packets[RT_WIDE_MAX_PACKETS];
    Sorter sorter;
    RaySource source;
    RateEstimate estimates[RT_RAY_KIND_COUNT];
    RayState states[]; /* [in_flight] */
} Scratch;

enum {
    WINDOW = 4096,      /* rays that are sorted together */
    RETRY = 256 * 1024, /* rays traced alone before packets are tried again */
    FEWEST = 9          /* rays of a stream: fewer, one after the other, take no longer */
};

/* Each is compiled once, not inlined into its callers. */
#define DEFINE_STREAMS(question, any)                                                                        \
    static __attribute__((noinline)) void stream_##question##_timed(const Query *q) {                        \
        trace_many(q, any, false);                                                                           \
    }                                                                                                        \
    static __attribute__((noinline)) void stream_##question##_counted(const Query *q) {                      \
        trace_many(q, any, true);                                                                            \
    }                                                                                                        \
    static __attribute__((noinline)) Shared packets_##question##_timed(const Query *q) {                     \
        Scratch *own = q->scratch->own;                                                                      \
        return trace_packets(q, own->packets, &own->sorter, WINDOW, any);                                    \
    }
DEFINE_STREAMS(nearest, false)
DEFINE_STREAMS(occluded, true)

/* Factors on the parameter `sharing`. Streams for any hit need no distances, so packets pay later. Without
 * AVX2 a gather loads word by word, so packets pay for rays that share much, and hardly for any hit. */
#if defined(__AVX2__)
#define WORTH_NEAREST 1.0f
#define WORTH_ANY     1.2f
#else
#define WORTH_NEAREST 1.6f
#define WORTH_ANY     13.0f
#endif

/* Traces packets while they pay; `count`: rays of the query. */
RT_KERNEL void trace_as_packets(const Query *q, RateEstimate *estimate, size_t count, bool any) {
    const float worth = q->self->sharing * (any ? WORTH_ANY : WORTH_NEAREST);
    if (estimate->alone && estimate->retry > count) {
        estimate->retry -= count;
        return;
    }
    /* Packets begin with an estimate that one poor window does not end. */
    if (estimate->alone || estimate->sharing == 0) estimate->sharing = 1.5f * worth;
    estimate->alone = false;
    while (!estimate->alone && more_rays(q)) {
        Shared shared = any ? packets_occluded_timed(q) : packets_nearest_timed(q);
        float sharing = (float)shared.rays / (float)(shared.visits + 1);
        estimate->sharing += 0.25f * (sharing - estimate->sharing);
        estimate->alone = estimate->sharing < worth;
        estimate->retry = RETRY;
    }
}

RT_KERNEL void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    const RtWide *self = (const RtWide *)accel;
    const RtWideTree *tree = any ? self->occluded : &self->trees[0];
    Scratch *own = scratch->own;
    const Query q = {
        self,         tree,       &accel->scene->geometry, scratch, rays, hits, occluders, tallies,
        &own->source, own->states};
    if (!counted && (self->in_flight == 1 || count < FEWEST)) {
        trace_one_by_one(&q, count, any);
        return;
    }
    RateEstimate *estimate = &own->estimates[count > 0 ? rays[0].kind : 0];
    const bool filtered = !counted && tree->node_count > 0;
    own->source.next = own->source.taken = own->source.count = 0;
    own->source.end = count;
    own->source.pause = filtered ? &estimate->pause : NULL;
    if (filtered && self->packets > 0 && count >= BEAM) trace_as_packets(&q, estimate, count, any);
    if (any)
        (counted ? stream_occluded_counted : stream_occluded_timed)(&q);
    else
        (counted ? stream_nearest_counted : stream_nearest_timed)(&q);
}

RT_DEFINE_STREAM_KERNELS(trace, sizeof(Scratch))
RT_DEFINE_KERNEL_TABLE(wide);
