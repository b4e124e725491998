/* SPDX-License-Identifier: Apache-2.0 */
/* A packet's visit of a leaf. The prefilter tests RT_GROUPS rays with four triangles, RT_LANES pairs in a
 * vector. Pairs that pass are collected until there are RT_LANES of them, and tested in full by the
 * operations of rt_triangle_hit. Their rays continue meanwhile. Leaves of spheres are tested at once. */
#ifndef RT_ACCEL_WIDE_PACKET_LEAF_H
#define RT_ACCEL_WIDE_PACKET_LEAF_H

#include "accel/wide/packet.h"

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

RT_KERNEL void visit_list(Packet *p, const Query *q, RtWideRef ref, uint64_t rays, bool any) {
    for (; rays; rays &= rays - 1) {
        uint32_t i = first_ray(rays);
        RtHit best = p->best[i];
        test_objects(q, ref, packet_ray(p, q, i), any, &best, NULL);
        if (best.object != p->best[i].object) take_hit(p, i, best, any);
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

#endif
