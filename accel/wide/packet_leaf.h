/* SPDX-License-Identifier: Apache-2.0 */
/* What a packet does at a leaf. Four rays at a time are sieved by four triangles, sixteen pairs in a vector;
 * what passes waits until there are sixteen pairs to be tested in full, by the operations of rt_triangle_hit.
 * Their rays go on meanwhile, for nothing at worst. */
#ifndef RT_ACCEL_WIDE_PACKET_LEAF_H
#define RT_ACCEL_WIDE_PACKET_LEAF_H

#include "accel/pairs.h"
#include "accel/simd_words.h"
#include "accel/wide/packet.h"

/* ---- triangles, roughly ---- */

/* Where a block has what belongs to a coordinate of a triangle, in floats from the first. */
RT_KERNEL size_t place_of(int vertex, uint32_t axis) {
    return ((size_t)vertex * 3 + axis) * RT_WIDE_BLOCK;
}

/* Adds to the pairs of rays with triangles of a block, which lies `at` floats from the arena's start, those
 * that sieve_block would let pass. */
RT_KERNEL void sieve_rays(Packet *p, const RtWideTriangles *block, uint32_t at, uint64_t rays) {
    static const uint32_t lane[BEAM] = {0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3};
    const RtW16 triangles = rt_w16_add(rt_w16_get(lane), rt_w16_all(at));
    RtV16 x[3], y[3], z[3];
    for (int i = 0; i < 3; i++) {
        x[i] = rt_v16_tile(coordinate(block, i, p->kx * COORDINATE));
        y[i] = rt_v16_tile(coordinate(block, i, p->ky * COORDINATE));
        z[i] = rt_v16_tile(coordinate(block, i, p->kz * COORDINATE));
    }
    uint32_t pairs = p->pair_count;
    prepare_sieve(p);
    do {
        const float *ray[4];
        for (int k = 0; k < 4; k++) {
            ray[k] = p->sieve[first_ray(rays)];
            rays &= rays - 1;
        }
        RtV16 place = rt_v16_join(ray[0], ray[1], ray[2], ray[3]);
        RtV16 more = rt_v16_join(ray[0] + 4, ray[1] + 4, ray[2] + 4, ray[3] + 4);
        RtSieveLine line = {rt_v16_spread(place, 0), rt_v16_spread(place, 1), rt_v16_spread(place, 2),
                            rt_v16_spread(more, 0), rt_v16_spread(more, 1)};
        RtV16 a[3] = {x[0], x[1], x[2]}, b[3] = {y[0], y[1], y[2]}, c[3] = {z[0], z[1], z[2]};
        rt_sieve_shear(&line, a, b, c);
        uint32_t passed = rt_sieve(a, b);
        rt_w16_put_some(&p->pair_ray[pairs], passed, rt_w16_of(rt_v16_spread(more, 2)));
        rt_w16_put_some(&p->pair_triangle[pairs], passed, triangles);
        pairs += (uint32_t)__builtin_popcount(passed);
    } while (rays);
    p->pair_count = pairs;
}

/* From so many rays of a beam on a block is tested triangle by triangle. */
enum { MANY_RAYS = 6 };

/* The same as sieve_rays for rays of beam b, with `count` triangles. */
RT_KERNEL void sieve_beam(Packet *p, const RtWideTriangles *block, uint32_t at, uint32_t count, uint32_t b,
                          uint32_t rays) {
    static const uint32_t lane[BEAM] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    const RtSieveLine line = {rt_v16_load(&p->org[p->kx][first_of(b)]),
                              rt_v16_load(&p->org[p->ky][first_of(b)]),
                              rt_v16_load(&p->org[p->kz][first_of(b)]), rt_v16_load(&p->shear_x[first_of(b)]),
                              rt_v16_load(&p->shear_y[first_of(b)])};
    for (uint32_t k = 0; k < count; k++) {
        const float *triangle = &block->v[0][0][k];
        RtV16 x[3], y[3], z[3];
        for (int i = 0; i < 3; i++) {
            x[i] = rt_v16_all(triangle[place_of(i, p->kx)]);
            y[i] = rt_v16_all(triangle[place_of(i, p->ky)]);
            z[i] = rt_v16_all(triangle[place_of(i, p->kz)]);
        }
        rt_sieve_shear(&line, x, y, z);
        uint32_t passed = rays & rt_sieve(x, y);
        rt_w16_put_some(&p->pair_ray[p->pair_count], passed,
                        rt_w16_add(rt_w16_get(lane), rt_w16_all(b * BEAM)));
        rt_w16_put_some(&p->pair_triangle[p->pair_count], passed, rt_w16_all(at + k));
        p->pair_count += (uint32_t)__builtin_popcount(passed);
    }
}

/* ---- triangles, in full ---- */

/* rt_triangle_hit of sixteen pairs: those that hit, and where. */
static __attribute__((noinline)) uint32_t hit_pairs(const Packet *p, const float *arena, const uint32_t *ray,
                                                    const uint32_t *triangle, float t[BEAM]) {
    const RtW16 rays = rt_w16_get(ray), triangles = rt_w16_get(triangle);
    RtPairsRays of = {.tmin = rt_v16_pick64(p->tmin, rays), .tmax = rt_v16_pick64(p->tmax, rays)};
    RtV16 v[3][3], at;
    for (int i = 0; i < 3; i++) {
        for (uint32_t a = 0; a < 3; a++) v[i][a] = rt_v16_lookup(arena + place_of(i, a), triangles);
    }
    for (int a = 0; a < 3; a++) {
        of.org[a] = rt_v16_pick64(p->org[a], rays);
        of.inv[a] = rt_v16_pick64(p->inv[a], rays);
        of.negative[a] = rt_v16_negative(rt_v16_all(p->negative[a] ? -1 : 1));
    }
    const RtSieveLine line = {of.org[p->kx], of.org[p->ky], of.org[p->kz], rt_v16_pick64(p->shear_x, rays),
                              rt_v16_pick64(p->shear_y, rays)};
    RtPairsSheared s;
    for (int i = 0; i < 3; i++) {
        s.x[i] = v[i][p->kx];
        s.y[i] = v[i][p->ky];
        s.z[i] = v[i][p->kz];
    }
    rt_sieve_shear(&line, s.x, s.y, s.z);
    uint32_t hit = rt_pairs_cross(&s, rt_v16_pick64(p->dir[p->kz], rays), &at);
    hit = rt_pairs_admit(&of, v, hit, &at);
    rt_v16_store(t, at);
    return hit;
}

/* What a ray has found, where it may be its answer. */
RT_KERNEL void take_hit(Packet *p, uint32_t ray, RtHit hit, bool any) {
    if (rt_hit_before(hit.t, hit.object, p->best[ray])) p->best[ray] = hit;
    p->limit[ray] = rt_minf(p->best[ray].t, p->limit[ray]);
    if (any) p->open &= ~one_ray(ray);
}

RT_KERNEL void limit_beam(Packet *p, uint32_t b) {
    p->beam[b].limit = rt_v16_most(rt_v16_load(&p->limit[first_of(b)]));
}

RT_KERNEL uint32_t id_of(const float *triangle) {
    uint32_t id;
    memcpy(&id, triangle + place_of(3, 0), sizeof id);
    return id;
}

/* Tests the pairs found last, sixteen at a time, while there are at least so many. */
RT_KERNEL void test_pairs(Packet *p, const RtWideTree *tree, uint32_t least, bool any) {
    const float *arena = (const float *)(const void *)tree->arena;
    while (p->pair_count >= least) {
        _Alignas(RT_CACHE_LINE) float t[BEAM];
        uint32_t some = p->pair_count < BEAM ? p->pair_count : BEAM, first = p->pair_count - some;
        for (uint32_t i = first + some; i < first + BEAM; i++) {
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

RT_KERNEL void visit_list(Packet *p, const Question *q, RtWideRef ref, uint64_t rays, bool any) {
    for (; rays; rays &= rays - 1) {
        uint32_t i = first_ray(rays);
        RtHit best = p->best[i];
        test_objects(q->tree, q->geometry, ref, prepared(p, q, i), any, &best, NULL);
        if (best.object != p->best[i].object) take_hit(p, i, best, any);
    }
}

RT_KERNEL void visit_block(Packet *p, const RtWideTree *tree, const RtWideTriangles *block, uint32_t count,
                           uint64_t rays) {
    uint32_t at = (uint32_t)((const char *)block - tree->arena) / sizeof(float);
    for (uint32_t b = 0; b < BEAMS; b++) {
        uint32_t some = (uint32_t)(rays >> b * BEAM) & ((1u << BEAM) - 1);
        if (__builtin_popcount(some) < MANY_RAYS) continue;
        sieve_beam(p, block, at, count, b, some);
        rays &= ~((uint64_t)some << b * BEAM);
    }
    if (rays) sieve_rays(p, block, at, rays);
}

RT_KERNEL void visit_leaf(Packet *p, const Question *q, RtWideRef ref, uint64_t rays, bool any) {
    if (rt_wide_kind(ref) != RT_WIDE_TRIANGLES) {
        visit_list(p, q, ref, rays, any);
        return;
    }
    const RtWideTriangles *block = rt_wide_leaf_at(q->tree, ref);
    uint32_t count = rt_wide_count(ref);
    for (; count > RT_WIDE_BLOCK; count -= RT_WIDE_BLOCK)
        visit_block(p, q->tree, block++, RT_WIDE_BLOCK, rays);
    visit_block(p, q->tree, block, count, rays);
    test_pairs(p, q->tree, BEAM, any);
}

#endif
