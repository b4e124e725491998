/* SPDX-License-Identifier: Apache-2.0 */
/* Packets: up to sixty-four rays whose directions have the same signs and the same major axis
 * (packet_rays.h).
 *
 * Origins and directions may differ: diffuse rays of a patch of the image, sorted by direction, share most of
 * their visits near the root. A packet is a structure of arrays, so that RT_LANES rays are prepared at once,
 * and one field of a ray fills a vector.
 *
 * Sixteen neighbours of a packet are a beam, if they are close to one another: between the least and the most
 * of their origins and reciprocals lies, along each axis, where any of them enters a box and leaves it
 * (interval arithmetic, as in Boulos, Wald & Shirley 2006, "Geometric and Arithmetic Culling Methods for
 * Entire Ray Packets"). It is conservative to the bit, for the operations are those of rt_box_hit, and
 * rounding is monotone.
 *
 * At a node the active rays of a packet are tested one after the other, each against all children at once,
 * and each child gets the set of rays that meet it. So the rays share the loads of the node and the work on
 * the stack. A beam that meets few of the children is tested in place of its rays; rays for any hit, which
 * need no order, are then tested in lanes, against those children alone. This is the stream tracing of Wald,
 * Gribble, Boulos & Kensler 2007 ("SIMD Ray Stream Tracing"), with sets as bits in place of lists.
 *
 * At a leaf the prefilter tests RT_GROUPS rays with four triangles, RT_LANES pairs in a vector. Pairs that
 * pass are collected until there are RT_LANES of them, and tested in full by the operations of
 * rt_triangle_hit. Their rays continue meanwhile. Leaves of spheres are tested at once. Rays that meet the
 * box of an instance, tested in lanes, enter its part as a stream. */
#ifndef RT_ACCEL_WIDE_PACKET_H
#define RT_ACCEL_WIDE_PACKET_H

#include "accel/instance.h"
#include "accel/wide/packet_rays.h"

/* ---- the prefilter of triangles ---- */

/* The offset in a block of a coordinate of its first triangle, in floats. */
RT_KERNEL size_t place_of(int vertex, uint32_t axis) {
    return ((size_t)vertex * 3 + axis) * RT_WIDE_BLOCK;
}

/* Appends the pairs of `passed` behind `count` others; returns how many there are then. */
RT_KERNEL uint32_t add_pairs(Packet *p, uint32_t count, uint32_t passed, RtInts rays, RtInts triangles) {
    rt_compress_store(&p->pair_ray[count], passed, rays);
    rt_compress_store(&p->pair_triangle[count], passed, triangles);
    return count + (uint32_t)__builtin_popcount(passed);
}

/* Adds to the pairs of rays with triangles of a block, which lies `at` floats from the arena's start, those
 * that pass the prefilter. Each vector holds RT_GROUPS rays with the four triangles. */
RT_KERNEL void prefilter_rays(Packet *p, const RtWideTriangles *block, uint32_t at, uint64_t rays) {
    const RtInts triangles = (RtInts)rt_repeat4((RtFloat4)((RtInt4){0, 1, 2, 3} + (int32_t)at));
    RtSheared corners;
    for (int i = 0; i < 3; i++) {
        corners.x[i] = rt_repeat4(coordinate(block, i, p->kx * COORDINATE));
        corners.y[i] = rt_repeat4(coordinate(block, i, p->ky * COORDINATE));
        corners.z[i] = rt_repeat4(coordinate(block, i, p->kz * COORDINATE));
    }
    uint32_t pairs = p->pair_count;
    prepare_prefilter(p);
    do {
        const float *at_place[RT_GROUPS], *at_shear[RT_GROUPS];
        for (int k = 0; k < RT_GROUPS; k++) {
            at_place[k] = p->prefilter[first_ray(rays)];
            at_shear[k] = at_place[k] + 4;
            rays &= rays - 1;
        }
        RtFloats place = rt_load_groups(at_place), more = rt_load_groups(at_shear);
        const RtShear ray = {rt_spread4(place, 0), rt_spread4(place, 1), rt_spread4(place, 2),
                             rt_spread4(more, 0), rt_spread4(more, 1)};
        RtSheared s = corners;
        rt_shear(&ray, &s);
        pairs = add_pairs(p, pairs, rt_edge_prefilter(&s), (RtInts)rt_spread4(more, 2), triangles);
    } while (rays);
    p->pair_count = pairs;
}

/* With at least so many rays of a beam, a block is tested triangle by triangle, and spheres are filtered. */
enum { MANY_RAYS = 6 };

/* The same as prefilter_rays for rays of beam b. */
RT_KERNEL void prefilter_beam(Packet *p, const RtWideTriangles *block, uint32_t at, uint32_t b,
                              uint32_t rays) {
    const uint32_t count = rt_wide_block_count(block);
    uint32_t pairs = p->pair_count;
    for (uint32_t lane = 0; lane < BEAM; lane += RT_LANES) {
        const size_t first = first_of(b) + lane;
        const RtInts numbers = rt_lane_numbers() + (int32_t)first;
        const RtShear ray = {rt_load(&p->org[p->kx][first]), rt_load(&p->org[p->ky][first]),
                             rt_load(&p->org[p->kz][first]), rt_load(&p->shear_x[first]),
                             rt_load(&p->shear_y[first])};
        for (uint32_t k = 0; k < count; k++) {
            const float *triangle = &block->v[0][0][k];
            RtSheared s;
            for (int i = 0; i < 3; i++) {
                s.x[i] = rt_all(triangle[place_of(i, p->kx)]);
                s.y[i] = rt_all(triangle[place_of(i, p->ky)]);
                s.z[i] = rt_all(triangle[place_of(i, p->kz)]);
            }
            rt_shear(&ray, &s);
            pairs = add_pairs(p, pairs, rays >> lane & rt_edge_prefilter(&s), numbers,
                              rt_all_ints((int32_t)(at + k)));
        }
    }
    p->pair_count = pairs;
}

/* ---- the full test ---- */

/* rt_triangle_hit of RT_LANES pairs: returns those that hit, and t of each. */
static __attribute__((noinline)) uint32_t hit_pairs(const Packet *p, const float *arena, const uint32_t *ray,
                                                    const uint32_t *triangle, float t[RT_LANES]) {
    const RtInts rays = rt_load_ints(ray), triangles = rt_load_ints(triangle);
    RtLaneRays of = {.tmin = rt_gather64(p->tmin, rays), .tmax = rt_gather64(p->tmax, rays)};
    RtFloats v[3][3], at;
    for (int i = 0; i < 3; i++) {
        for (uint32_t a = 0; a < 3; a++) v[i][a] = rt_gather(arena + place_of(i, a), triangles);
    }
    for (int a = 0; a < 3; a++) {
        of.org[a] = rt_gather64(p->org[a], rays);
        of.inv[a] = rt_gather64(p->inv[a], rays);
        of.negative[a] = rt_all_ints(-p->negative[a]);
    }
    const RtShear shear = {of.org[p->kx], of.org[p->ky], of.org[p->kz], rt_gather64(p->shear_x, rays),
                           rt_gather64(p->shear_y, rays)};
    RtSheared s;
    for (int i = 0; i < 3; i++) {
        s.x[i] = v[i][p->kx];
        s.y[i] = v[i][p->ky];
        s.z[i] = v[i][p->kz];
    }
    rt_shear(&shear, &s);
    uint32_t hit = rt_cross(&s, rt_gather64(p->dir[p->kz], rays), &at);
    hit = rt_admit(&of, v, hit, &at);
    rt_store(t, at);
    return hit;
}

/* Records a hit that may be the ray's answer. */
RT_KERNEL void take_hit(Packet *p, uint32_t ray, RtHit hit, bool any) {
    if (rt_hit_before(hit.t, hit.object, p->best[ray])) p->best[ray] = hit;
    p->limit[ray] = rt_minf(p->best[ray].t, p->limit[ray]);
    if (any) p->open &= ~one_ray(ray);
}

RT_KERNEL void limit_beam(Packet *p, uint32_t b) {
    RtFloats most = rt_load(&p->limit[first_of(b)]);
    for (size_t i = RT_LANES; i < BEAM; i += RT_LANES)
        most = rt_max(rt_load(&p->limit[first_of(b) + i]), most);
    p->beam[b].limit = rt_most(most);
}

RT_KERNEL uint32_t id_of(const float *triangle) {
    uint32_t id;
    memcpy(&id, triangle + place_of(3, 0), sizeof id);
    return id;
}

/* Tests the last pairs, RT_LANES at a time, until fewer than `least` are left. */
RT_KERNEL void test_pairs(Packet *p, const RtWideTree *tree, uint32_t least, bool any) {
    const float *arena = (const float *)(const void *)tree->arena;
    while (p->pair_count >= least) {
        float t[RT_LANES];
        uint32_t some = p->pair_count < RT_LANES ? p->pair_count : RT_LANES, first = p->pair_count - some;
        for (uint32_t i = first + some; i < first + RT_LANES; i++) {
            p->pair_ray[i] = p->pair_ray[first];
            p->pair_triangle[i] = p->pair_triangle[first];
        }
        uint32_t hit = hit_pairs(p, arena, &p->pair_ray[first], &p->pair_triangle[first], t), beams = 0;
        for (hit &= (1u << some) - 1; hit; hit &= hit - 1) {
            uint32_t i = (uint32_t)__builtin_ctz(hit), ray = p->pair_ray[first + i];
            take_hit(p, ray, (RtHit){t[i], id_of(arena + p->pair_triangle[first + i])}, any);
            beams |= 1u << ray / BEAM;
        }
        for (; beams && !any; beams &= beams - 1) limit_beam(p, (uint32_t)__builtin_ctz(beams));
        p->pair_count = first;
    }
}

/* ---- leaves ---- */

/* Those of the rays that may find something better in the box of an instance, and where they are in it. */
RT_KERNEL uint64_t rays_in_box(const Packet *p, const RtBox *box, uint64_t rays, float near[PACKET],
                               float far[PACKET]) {
    RtFloats lo[3], hi[3], from, to;
    for (int a = 0; a < 3; a++) {
        lo[a] = rt_all(box->lo.at[a]);
        hi[a] = rt_all(box->hi.at[a]);
    }
    uint64_t met = 0;
    for (uint32_t i = 0; i < PACKET; i += RT_LANES) {
        if ((rays >> i & ((1u << RT_LANES) - 1)) == 0) continue;
        RtLaneRays lanes;
        for (int a = 0; a < 3; a++) {
            lanes.org[a] = rt_load(&p->org[a][i]);
            lanes.inv[a] = rt_load(&p->inv[a][i]);
            lanes.negative[a] = rt_all_ints(-p->negative[a]);
        }
        rt_own_span(&lanes, lo, hi, &from, &to);
        rt_store(&near[i], from);
        rt_store(&far[i], to);
        met |= (uint64_t)(rt_le_bits(from, to) & rt_le_bits(from, rt_load(&p->limit[i])) &
                          rt_le_bits(rt_load(&p->tmin[i]), to))
               << i;
    }
    return met & rays;
}

/* Moves rays into an instance, and asks its part for their hits, as one stream. */
static __attribute__((noinline)) void visit_instance(Packet *p, const Query *q, uint32_t id, uint64_t rays,
                                                     bool any) {
    const RtInstance *instance = rt_instance_of(q->geometry, id);
    const RtQuery *part = &q->scratch->hit_memory->parts[instance->part];
    _Alignas(RT_CACHE_LINE) float near[PACKET], far[PACKET];
    RtEntry entry[PACKET];
    RtRay inside[PACKET];
    RtHit hits[PACKET];
    uint32_t number[PACKET], occluders[PACKET], count = 0;
    for (rays = rays_in_box(p, &q->geometry->boxes[id], rays, near, far); rays; rays &= rays - 1) {
        const uint32_t i = number[count] = first_ray(rays);
        entry[count] = (RtEntry){near[i], far[i]};
        count += rt_enter_move(instance, &q->rays[p->index[i]], &p->best[i], &entry[count], &inside[count]);
    }
    if (count == 0) return;
    rt_trace_stream(part->accel, part->scratch, inside, count, any ? NULL : hits, any ? occluders : NULL,
                    NULL);
    for (uint32_t k = 0; k < count; k++) {
        RtHit best = p->best[number[k]];
        rt_enter_end(instance, &entry[k], any ? (RtHit){0, occluders[k]} : hits[k], any, &best, NULL);
        if (best.object != p->best[number[k]].object) take_hit(p, number[k], best, any);
    }
}

RT_KERNEL void visit_object(Packet *p, const Query *q, uint32_t id, uint64_t rays, bool any) {
    for (; rays; rays &= rays - 1) {
        uint32_t i = first_ray(rays);
        RtHit best = p->best[i];
        test_object(q->geometry, id, packet_ray(p, q, i), any, &best, NULL);
        if (best.object != p->best[i].object) take_hit(p, i, best, any);
    }
}

RT_KERNEL void visit_list(Packet *p, const Query *q, RtWideRef ref, uint64_t rays, bool any) {
    const RtWideList *list = rt_wide_leaf_at(q->tree, ref);
    for (uint32_t i = 0, count = list_count(q, ref); i < count && rays; i++) {
        if (rt_is_instance(q->geometry, list->id[i]))
            visit_instance(p, q, list->id[i], rays, any);
        else
            visit_object(p, q, list->id[i], rays, any);
        if (any) rays &= p->open;
    }
}

/* Of the rays first..first+3, those whose lines meet a sphere. */
RT_KERNEL uint32_t meet_sphere(const Packet *p, const RtSphere *sphere, size_t first) {
    RtFloat4 org[3], dir[3], ball[4] = {[3] = rt_all4(sphere->radius)};
    Chords chords;
    for (int a = 0; a < 3; a++) {
        org[a] = rt_load4(&p->org[a][first]);
        dir[a] = rt_load4(&p->dir[a][first]);
        ball[a] = rt_all4(sphere->center.at[a]);
    }
    find_chords(org, dir, ball, &chords);
    return chords.met;
}

/* Those of the rays that may hit a sphere. Beams with many rays are filtered: they need no transposition. */
RT_KERNEL uint64_t filter_rays(const Packet *p, const RtSphere *sphere, uint64_t rays) {
    for (uint32_t b = 0; b < BEAMS; b++) {
        uint32_t some = (uint32_t)(rays >> b * BEAM) & ((1u << BEAM) - 1), met = 0;
        if (__builtin_popcount(some) < MANY_RAYS) continue;
        for (uint32_t i = 0; i < BEAM; i += PAIRS) met |= meet_sphere(p, sphere, first_of(b) + i) << i;
        rays &= ~((uint64_t)(some & ~met) << b * BEAM);
    }
    return rays;
}

RT_KERNEL void visit_sphere_leaf(Packet *p, const Query *q, RtWideRef ref, uint64_t rays, bool any) {
    SpherePair pairs[PACKET * RT_WIDE_MAX_LEAF];
    uint32_t ray[PACKET * RT_WIDE_MAX_LEAF], count = 0;
    float t[PACKET * RT_WIDE_MAX_LEAF];
    for (uint32_t i = 0, spheres = list_count(q, ref); i < spheres; i++) {
        SpherePair pair = sphere_pair(q, NULL, ref, i);
        for (uint64_t left = filter_rays(p, pair.sphere, rays); left; left &= left - 1) {
            ray[count] = first_ray(left);
            pair.ray = &q->rays[p->index[ray[count]]];
            pairs[count++] = pair;
        }
    }
    hit_sphere_pairs(q->geometry, pairs, count, t);
    for (uint32_t i = 0; i < count; i++) {
        if (!isnan(t[i])) take_hit(p, ray[i], (RtHit){t[i], pairs[i].id}, any);
    }
}

RT_KERNEL void visit_block(Packet *p, const RtWideTree *tree, const RtWideTriangles *block, uint64_t rays) {
    uint32_t at = (uint32_t)((size_t)((const char *)block - tree->arena) / sizeof(float));
    for (uint32_t b = 0; b < BEAMS; b++) {
        uint32_t some = (uint32_t)(rays >> b * BEAM) & ((1u << BEAM) - 1);
        if (__builtin_popcount(some) < MANY_RAYS) continue;
        prefilter_beam(p, block, at, b, some);
        rays &= ~((uint64_t)some << b * BEAM);
    }
    if (rays) prefilter_rays(p, block, at, rays);
}

RT_KERNEL void visit_leaf(Packet *p, const Query *q, RtWideRef ref, uint64_t rays, bool any) {
    if (rt_wide_kind(ref) == RT_WIDE_OBJECTS) {
        visit_list(p, q, ref, rays, any);
        return;
    }
    if (rt_wide_kind(ref) == RT_WIDE_SPHERES) {
        visit_sphere_leaf(p, q, ref, rays, any);
        return;
    }
    const RtWideTriangles *block = rt_wide_leaf_at(q->tree, ref);
    if (rt_wide_has_more(ref)) visit_block(p, q->tree, block++, rays);
    visit_block(p, q->tree, block, rays);
    test_pairs(p, q->tree, RT_LANES, any);
}

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

#endif
