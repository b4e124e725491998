/* SPDX-License-Identifier: Apache-2.0 */
/* The traversal of packets. At a node the active rays of a packet are tested one after the other, each
 * against all children at once, and each child gets the set of rays that meet it. So the rays share the loads
 * of the node and the work on the stack. A beam that meets few of the children is tested in place of its
 * rays; rays for any hit, which need no order, are then tested in lanes, against those children alone. This
 * is the stream tracing of Wald, Gribble, Boulos & Kensler 2007
 * ("SIMD Ray Stream Tracing"), with sets as bits in place of lists.
 *
 * A single packet would wait for each node to come from memory. So several are interleaved: while one waits
 * for its prefetched node, the others continue. */
#ifndef RT_ACCEL_WIDE_PACKET_TRACE_H
#define RT_ACCEL_WIDE_PACKET_TRACE_H

#include "accel/wide/packet_leaf.h"

/* A beam is tested in place of its rays if at least so many are active. For nearest hits the result is used
 * if it meets at most so many children; otherwise its rays would visit too many children that they miss. */
enum { BEAM_LEAST_RAYS = 8, BEAM_MOST_CHILDREN = 3 };

/* The cost of testing a vector of rays with one child, in tests of one ray with all children: measured. */
enum { LANES_COST = 2 };

/* How much the rays share their visits. */
typedef struct Shared {
    uint64_t visits, rays; /* of nodes, and the active rays summed over them */
} Shared;

/* ---- nodes ---- */

/* The planes of a node in the order in which the rays of a packet meet them. */
typedef struct Planes {
    RtFloat8 enter[3], leave[3];
} Planes;

/* The rays that meet each child, and where the first of them may enter it. */
typedef struct ChildSets {
    RtSets8 rays;
    RtFloat8 first;
} ChildSets;

RT_KERNEL void add_rays(ChildSets *met, uint64_t rays, RtFloat8 near, RtMask8 mask) {
    rt_sets8_add(&met->rays, mask, rays);
    met->first = rt_select_mask8(mask, rt_min(near, met->first), met->first);
}

RT_KERNEL void test_ray(ChildSets *met, const Planes *planes, const Packet *p, uint32_t i) {
    RtFloat8 near = rt_all8(p->tmin[i]), far = rt_all8(p->limit[i]);
    for (uint32_t a = 0; a < 3; a++) {
        near = rt_max((planes->enter[a] - p->org_near[a][i]) * p->inv[a][i], near);
        far = rt_min((planes->leave[a] - p->org_far[a][i]) * p->inv[a][i], far);
    }
    add_rays(met, one_ray(i), near, rt_le_mask8(near, far));
}

/* The children that rays of a beam may hit; *near: where the first of them may enter each. */
RT_KERNEL RtMask8 test_beam(const Planes *planes, const Beam *beam, RtFloat8 *near) {
    RtFloat8 far = rt_all8(beam->limit);
    *near = rt_all8(beam->tmin);
    for (uint32_t a = 0; a < 3; a++) {
        float least = beam->inv_least[a], most = beam->inv_most[a];
        RtFloat8 enter = planes->enter[a] - beam->first[a], leave = planes->leave[a] - beam->last[a];
        *near = rt_max(rt_min(enter * least, enter * most), *near);
        far = rt_min(rt_max(leave * least, leave * most), far);
    }
    return rt_le_mask8(*near, far);
}

RT_KERNEL RtFloats plane_of(const RtWideNode *node, uint32_t offset, uint32_t child) {
    float plane;
    memcpy(&plane, (const char *)node + offset + child * sizeof plane, sizeof plane);
    return rt_all(plane);
}

/* Rays of beam b against one child after the other, RT_LANES rays at a time. */
RT_KERNEL void test_lanes(RtSets8 *met, const Packet *p, const RtWideNode *node, uint32_t b, uint64_t rays,
                          uint32_t children) {
    for (; children; children &= children - 1) {
        const uint32_t child = (uint32_t)__builtin_ctz(children);
        uint64_t hit = 0;
        for (size_t i = first_of(b); i < first_of(b) + BEAM; i += RT_LANES) {
            RtFloats near = rt_load(&p->tmin[i]), far = rt_load(&p->limit[i]);
            for (uint32_t a = 0; a < 3; a++) {
                const RtFloats inv = rt_load(&p->inv[a][i]);
                RtFloats enter = plane_of(node, p->near[a], child) - rt_load(&p->org_near[a][i]);
                RtFloats leave = plane_of(node, p->far[a], child) - rt_load(&p->org_far[a][i]);
                near = rt_max(enter * inv, near);
                far = rt_min(leave * inv, far);
            }
            hit |= (uint64_t)rt_le_bits(near, far) << i;
        }
        rt_sets8_add(met, rt_one_mask8(child), hit & rays);
    }
}

/* Tests rays of beam b together. False if they must be tested one by one. */
RT_KERNEL bool test_together(ChildSets *met, const Planes *planes, const Packet *p, const RtWideNode *node,
                             uint32_t b, uint64_t rays, bool any) {
    const Beam *beam = &p->beam[b];
    if (!any && !beam->tight) return false;
    const uint32_t active = (uint32_t)__builtin_popcountll(rays);
    if (active < BEAM_LEAST_RAYS) return false;
    RtFloat8 near;
    if (!any) {
        const RtMask8 mask = test_beam(planes, beam, &near);
        if (__builtin_popcount(rt_mask8_bits(mask)) > BEAM_MOST_CHILDREN) return false;
        add_rays(met, rays, near, mask);
        return true;
    }
    const uint32_t children =
        beam->tight ? rt_mask8_bits(test_beam(planes, beam, &near)) : (1u << node->count) - 1;
    if ((uint32_t)__builtin_popcount(children) * LANES_COST * (BEAM / RT_LANES) >= active) return false;
    test_lanes(&met->rays, p, node, b, rays, children);
    return true;
}

/* Descends to one child that rays hit, and pushes the others; false if they hit none. */
RT_KERNEL bool visit_node(Packet *p, const RtWideNode *node, uint64_t rays, bool ordered, bool any) {
    ChildSets met = {.first = rt_all8(INFINITY)};
    Planes sides;
    for (uint32_t a = 0; a < 3; a++) {
        sides.enter[a] = planes(node, p->near[a]);
        sides.leave[a] = planes(node, p->far[a]);
    }
    uint64_t alone = rays;
    for (uint32_t b = 0; b < BEAMS; b++) {
        uint64_t some = rays & UINT64_C(0xffff) << b * BEAM;
        if (test_together(&met, &sides, p, node, b, some, any)) alone &= ~some;
    }
    for (; alone; alone &= alone - 1) test_ray(&met, &sides, p, first_ray(alone));

    uint32_t mask = rt_sets8_bits(&met.rays);
    if (mask == 0) return false;
    uint32_t top = p->top, lane = choose_child(mask, met.first, ordered), others = mask & ~(1u << lane);
    _Alignas(RT_CACHE_LINE) uint64_t sets[RT_WIDE];
    RtOrder8 order = rt_order8(others);
    memcpy(sets, &met.rays, sizeof sets);
    if (!any) rt_store(&p->enter[top], rt_compress8(order, (RtInt8)met.first));
    rt_store(&p->stack[top], rt_compress8(order, rt_load_ints8(node->child)));
    rt_sets8_compress(&p->rays[top], others, &met.rays);
    p->top = top + (uint32_t)__builtin_popcount(others);
    p->next = node->child[lane];
    p->going = sets[lane];
    return true;
}

/* ---- the traversal ---- */

/* The rays of a set that have found nothing nearer than this. */
RT_KERNEL uint64_t rays_before(const Packet *p, uint64_t rays, float enter) {
    uint64_t open = 0;
    for (uint32_t i = 0; i < PACKET; i += RT_LANES)
        open |= (uint64_t)rt_le_bits(rt_all(enter), rt_load(&p->limit[i])) << i;
    return rays & open;
}

/* Pops the stack down to an entry that a ray must still visit; false if there is none. */
RT_KERNEL bool pop_stack(Packet *p, bool any) {
    while (p->top > 0) {
        uint64_t rays = p->rays[--p->top];
        p->going = any ? rays & p->open : rays_before(p, rays, p->enter[p->top]);
        p->next = p->stack[p->top];
        if (p->going) return true;
    }
    return false;
}

/* One visit; false if it was the last. */
RT_KERNEL bool step_packet(Packet *p, const Query *q, Shared *shared, bool any) {
    bool more = true;
    if (rt_wide_kind(p->next) == RT_WIDE_NODE) {
        shared->visits++;
        shared->rays += (uint64_t)__builtin_popcountll(p->going);
        if (!visit_node(p, rt_wide_node(q->tree, p->next), p->going, !any && q->self->order, any))
            more = pop_stack(p, any);
    } else {
        visit_leaf(p, q, p->next, p->going, any);
        more = pop_stack(p, any);
    }
    if (q->self->prefetch) prefetch(q->tree, p->next);
    return more;
}

RT_KERNEL void finish_packet(Packet *p, const Query *q, bool any) {
    test_pairs(p, q->tree, 1, any);
    for (uint32_t i = 0; i < p->count; i++) {
        if (any)
            q->occluders[p->index[i]] = p->best[i].object;
        else
            q->hits[p->index[i]] = p->best[i];
    }
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

#endif
