/* SPDX-License-Identifier: Apache-2.0 */
/* The way of packets through the hierarchy. At a node those rays of a packet that are there are tested one
 * after the other, against all its children at once, and each child gets the set of rays that meet it: the
 * node is read once for all, and what remains of a visit is shared by them. A beam that meets few of the
 * children is tested in place of its rays. This is the stream tracing of Wald, Gribble, Boulos & Kensler 2007
 * ("SIMD Ray Stream Tracing"), with sets as bits in place of lists.
 *
 * A packet alone would wait for each node to come from memory. So several are in flight, and take turns: what
 * one goes on to comes while the others are at theirs. */
#ifndef RT_ACCEL_WIDE_PACKET_WAY_H
#define RT_ACCEL_WIDE_PACKET_WAY_H

#include "accel/wide/packet_leaf.h"

/* A beam is tested in place of at least so many of its rays; and that counts if it meets at most so many of
 * the children, or its rays would visit too much that they miss. */
enum { BEAM_LEAST_RAYS = 8, BEAM_MOST_CHILDREN = 3 };

/* What has been done, to tell how much was shared. */
typedef struct Shared {
    uint64_t visits, rays; /* of nodes, and the rays there */
} Shared;

/* ---- nodes ---- */

/* The planes of a node in the order in which the rays of a packet meet them. */
typedef struct Planes {
    __m256 enter[3], leave[3];
} Planes;

/* The rays that meet each child, and where the first of them may enter it. */
typedef struct Met {
    RtV8Sets rays;
    __m256 first;
} Met;

RT_KERNEL void meet_child(Met *met, uint64_t rays, __m256 near, __m256 far) {
    RtV8Mask mask = rt_v8_within(near, far);
    rt_v8_sets_add(&met->rays, mask, rays);
    met->first = rt_v8_min_where(mask, near, met->first);
}

RT_KERNEL void meet_ray(Met *met, const Planes *planes, const Packet *p, uint32_t i) {
    __m256 near = _mm256_set1_ps(p->tmin[i]), far = _mm256_set1_ps(p->limit[i]);
    for (uint32_t a = 0; a < 3; a++) {
        __m256 inv = _mm256_set1_ps(p->inv[a][i]);
        __m256 enter = _mm256_sub_ps(planes->enter[a], _mm256_set1_ps(p->org_near[a][i]));
        __m256 leave = _mm256_sub_ps(planes->leave[a], _mm256_set1_ps(p->org_far[a][i]));
        near = _mm256_max_ps(_mm256_mul_ps(enter, inv), near);
        far = _mm256_min_ps(_mm256_mul_ps(leave, inv), far);
    }
    meet_child(met, one_ray(i), near, far);
}

/* False where the rays are to be tested one by one. */
RT_KERNEL bool meet_beam(Met *met, const Planes *planes, const Beam *beam, uint64_t rays) {
    __m256 near = _mm256_set1_ps(beam->tmin), far = _mm256_set1_ps(beam->limit);
    for (uint32_t a = 0; a < 3; a++) {
        __m256 least = _mm256_set1_ps(beam->inv_least[a]), most = _mm256_set1_ps(beam->inv_most[a]);
        __m256 enter = _mm256_sub_ps(planes->enter[a], _mm256_set1_ps(beam->first[a]));
        __m256 leave = _mm256_sub_ps(planes->leave[a], _mm256_set1_ps(beam->last[a]));
        near = _mm256_max_ps(_mm256_min_ps(_mm256_mul_ps(enter, least), _mm256_mul_ps(enter, most)), near);
        far = _mm256_min_ps(_mm256_max_ps(_mm256_mul_ps(leave, least), _mm256_mul_ps(leave, most)), far);
    }
    if (__builtin_popcount(rt_v8_at_most(near, far)) > BEAM_MOST_CHILDREN) return false;
    meet_child(met, rays, near, far);
    return true;
}

/* Goes on to one child that rays meet, and waits with the others; false where they meet none. */
RT_KERNEL bool visit_node(Packet *p, const RtWideNode *node, uint64_t rays, bool ordered, bool any) {
    Met met = {rt_v8_sets_none(), _mm256_set1_ps(INFINITY)};
    Planes sides;
    for (uint32_t a = 0; a < 3; a++) {
        sides.enter[a] = planes(node, p->near[a]);
        sides.leave[a] = planes(node, p->far[a]);
    }
    uint64_t alone = rays;
    for (uint32_t b = 0; b < BEAMS; b++) {
        uint64_t some = rays & UINT64_C(0xffff) << b * BEAM;
        if (!p->beam[b].tight || __builtin_popcountll(some) < BEAM_LEAST_RAYS) continue;
        if (meet_beam(&met, &sides, &p->beam[b], some)) alone &= ~some;
    }
    for (; alone; alone &= alone - 1) meet_ray(&met, &sides, p, first_ray(alone));

    uint32_t mask = rt_v8_sets_some(&met.rays);
    if (mask == 0) return false;
    uint32_t top = p->top, lane = choose(mask, met.first, ordered), others = mask & ~(1u << lane);
    _Alignas(RT_CACHE_LINE) uint64_t sets[RT_WIDE];
    RtV8Order order = rt_v8_order(others);
    rt_v8_sets_put(sets, &met.rays);
    if (!any) rt_v8_put(&p->enter[top], rt_v8_take(order, _mm256_castps_si256(met.first)));
    rt_v8_put(&p->waiting[top], rt_v8_take(order, rt_v8_get(node->child)));
    rt_v8_sets_take(&p->rays[top], others, &met.rays);
    p->top = top + (uint32_t)__builtin_popcount(others);
    p->next = node->child[lane];
    p->going = sets[lane];
    return true;
}

/* ---- the way ---- */

/* The rays of a set that have found nothing nearer than this. */
RT_KERNEL uint64_t not_beyond(const Packet *p, uint64_t rays, float enter) {
    uint64_t not = 0;
    for (uint32_t b = 0; b < BEAMS; b++)
        not |= (uint64_t)rt_v16_at_most(rt_v16_all(enter), rt_v16_load(&p->limit[first_of(b)])) << b * BEAM;
    return rays & not ;
}

/* Goes on to what waits last and still matters to a ray; false where there is nothing. */
RT_KERNEL bool take_waiting(Packet *p, bool any) {
    while (p->top > 0) {
        uint64_t rays = p->rays[--p->top];
        p->going = any ? rays & p->open : not_beyond(p, rays, p->enter[p->top]);
        p->next = p->waiting[p->top];
        if (p->going) return true;
    }
    return false;
}

/* One visit; false where it was the last. */
RT_KERNEL bool go_ahead(Packet *p, const Question *q, Shared *shared, bool any) {
    bool more = true;
    if (rt_wide_kind(p->next) == RT_WIDE_NODE) {
        shared->visits++;
        shared->rays += (uint64_t)__builtin_popcountll(p->going);
        if (!visit_node(p, rt_wide_node(q->tree, p->next), p->going, !any && q->self->order, any))
            more = take_waiting(p, any);
    } else {
        visit_leaf(p, q, p->next, p->going, any);
        more = take_waiting(p, any);
    }
    if (q->self->prefetch) prefetch(q->tree, p->next);
    return more;
}

RT_KERNEL void land_packet(Packet *p, const Question *q, bool any) {
    test_pairs(p, q->tree, 1, any);
    for (uint32_t i = 0; i < p->count; i++) {
        if (any)
            q->occluders[p->index[i]] = p->best[i].object;
        else
            q->hits[p->index[i]] = p->best[i];
    }
}

/* Traces rays[first..first + count) of a question, few enough for the numbers of a Sorter. */
RT_KERNEL Shared trace_packets(const Question *q, Packet *packets, Sorter *sorter, size_t first, size_t count,
                               bool any) {
    Shared shared = {0};
    Packet *flying[RT_WIDE_MAX_PACKETS];
    uint32_t n = 0, class;
    begin_sorting(sorter, first, count);
    for (; n < q->self->packets; n++) {
        class = sort_rays(sorter, q->rays);
        if (class == CLASSES) break;
        flying[n] = &packets[n];
        take_up(flying[n], q, sorter, class, any);
    }
    while (n > 0) {
        uint32_t kept = 0;
        for (uint32_t i = 0; i < n; i++) {
            Packet *p = flying[kept] = flying[i];
            if (go_ahead(p, q, &shared, any)) {
                kept++;
                continue;
            }
            land_packet(p, q, any);
            class = sort_rays(sorter, q->rays);
            if (class == CLASSES) continue;
            take_up(p, q, sorter, class, any);
            kept++;
        }
        n = kept;
    }
    return shared;
}

#endif
