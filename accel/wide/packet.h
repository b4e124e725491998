/* SPDX-License-Identifier: Apache-2.0 */
/* Packets: up to sixty-four rays whose directions have the same signs and the same major axis, and how rays
 * are sorted into them.
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
 * rt_triangle_hit. Their rays continue meanwhile. Leaves of spheres are tested at once. */
#ifndef RT_ACCEL_WIDE_PACKET_H
#define RT_ACCEL_WIDE_PACKET_H

#include "accel/instance.h"
#include "accel/wide/ray.h"

#include <assert.h>

enum {
    PACKET = 64,
    BEAM = 16,
    BEAMS = PACKET / BEAM,
    CLASSES = 24, /* signs and major axis of a direction: class_of */
    /* Pairs of a ray and a triangle to be tested: fewer than a vector, and those that a leaf may add; and
     * whole vectors may be written behind the last. */
    MOST_PAIRS = BEAM + PACKET * RT_WIDE_MAX_LEAF + BEAM
};

/* The bounds of a beam: the origins of the first ray to enter a box and of the last to leave it, and the
 * least and the greatest reciprocals. */
typedef struct Beam {
    float first[3], tmin; /* the least */
    float last[3], limit; /* the greatest */
    float inv_least[3], inv_most[3];
    bool tight; /* the rays are close enough to be tested as one */
} Beam;

typedef struct Packet {
    _Alignas(RT_CACHE_LINE) float org[3][PACKET];
    float dir[3][PACKET], inv[3][PACKET], org_near[3][PACKET], org_far[3][PACKET];
    float tmin[PACKET], tmax[PACKET], shear_x[PACKET], shear_y[PACKET];
    float limit[PACKET];                /* the best t so far, or tmax */
    uint32_t pair_ray[MOST_PAIRS];      /* [pair_count] pairs that passed the prefilter: the ray, */
    uint32_t pair_triangle[MOST_PAIRS]; /* and the triangle's offset in the arena, in floats */
    /* Each ray, prepared for the prefilter: the origin by kx, ky and kz, nothing; the shear, the ray's
     * number, nothing. The entry behind the last passes no triangle. */
    float prefilter[PACKET + 1][8];
    Beam beam[BEAMS];
    RtHit best[PACKET];
    RtPreparedRay ray[PACKET];
    uint64_t open;     /* bit i: ray i has no answer yet */
    uint64_t prepared; /* bit i: ray[i] is */
    uint64_t going;    /* the rays that visit `next` */
    uint64_t rays[RT_WIDE_STACK];
    float enter[RT_WIDE_STACK];
    RtWideRef stack[RT_WIDE_STACK], next;
    uint32_t top; /* entries of the stack */
    uint32_t pair_count;
    uint32_t count, index[PACKET];        /* of rays, and their indices in the query */
    uint32_t kx, ky, kz, near[3], far[3]; /* as in RayState */
    bool negative[3], prefilter_ready;
} Packet;

/* The rays of each class that wait for a packet, and how many more are sorted. */
typedef struct Sorter {
    int32_t left;   /* rays that may still be sorted */
    uint32_t class; /* when all are sorted: the first that may still have rays */
    uint32_t count[CLASSES], list[CLASSES][PACKET + BEAM];
} Sorter;

/* The number of a beam's first ray. */
RT_KERNEL size_t first_of(uint32_t beam) {
    return (size_t)beam * BEAM;
}

/* The first of a set of rays; PACKET if the set is empty. */
RT_KERNEL uint32_t first_ray(uint64_t rays) {
    return rays ? (uint32_t)__builtin_ctzll(rays) : PACKET;
}

RT_KERNEL uint64_t one_ray(uint32_t i) {
    return UINT64_C(1) << i;
}

/* ---- sorting ---- */

RT_KERNEL uint32_t class_of(const RtRay *ray) {
    uint32_t class = 8 * (uint32_t)rt_major_axis(ray->dir);
    for (int a = 0; a < 3; a++) class |= (uint32_t)(signbit(ray->dir.at[a]) != 0) << a;
    return class;
}

/* The class of the BEAM rays `index`; CLASSES if they differ. */
RT_KERNEL uint32_t class_of_all(const RtRay *rays, const uint32_t *index) {
    const RtRay *one = &rays[index[0]];
    const uint32_t class = class_of(one), axis = class / 8;
    const RtFloat4 dir = rt_loadu4((const char *)one + offsetof(RtRay, dir));
    RtInt4 signs = {0}, larger = {0};
    for (int i = 0; i < BEAM; i++) {
        const RtRay *ray = &rays[index[i]];
        RtFloat4 own = rt_loadu4((const char *)ray + offsetof(RtRay, dir));
        signs |= (RtInt4)own ^ (RtInt4)dir;
        larger |= rt_abs(own) >= fabsf(ray->dir.at[axis]);
    }
    larger[axis] = 0;
    RtInt4 differ = (signs < 0) | larger;
    return differ[0] | differ[1] | differ[2] ? CLASSES : class;
}

RT_KERNEL void begin_sorting(Sorter *s, int32_t count) {
    memset(s->count, 0, sizeof s->count);
    s->left = count;
    s->class = 0;
}

/* Sorts until a class fills a packet, and returns it. When all rays are sorted, returns any class that has
 * rays, or CLASSES. Not inlined, as init_packet: they run once a packet, and the loop of visits stays small.
 */
static __attribute__((noinline)) uint32_t sort_rays(Sorter *s, const Query *q) {
    RaySource *from = q->source;
    while (s->left > 0 && more_rays(q)) {
        const uint32_t *index = &from->index[from->taken];
        uint32_t class = CLASSES, many = 1;
        if (from->taken % BEAM == 0 && from->count - from->taken >= BEAM)
            class = class_of_all(q->rays, index);
        if (class == CLASSES)
            class = class_of(&q->rays[*index]);
        else
            many = BEAM;
        uint32_t *to = &s->list[class][s->count[class]];
        for (uint32_t k = 0; k < many; k++) to[k] = index[k];
        from->taken += many;
        s->left -= (int32_t)many;
        s->count[class] += many;
        if (s->count[class] >= PACKET) return class;
    }
    while (s->class < CLASSES && s->count[s->class] == 0) s->class ++;
    return s->class;
}

/* ---- preparing ---- */

/* Prepares rays [first, first + RT_LANES) of the packet, thickened as by rt_ray_prepare_in. */
RT_KERNEL void prepare_lanes(Packet *p, const RtGeometry *g, uint32_t first) {
    RtFloats org[3];
    for (int a = 0; a < 3; a++) org[a] = rt_load(&p->org[a][first]);
    const RtFloats thickness = rt_lanes_thickness(org, &g->box);
    for (int a = 0; a < 3; a++) {
        RtFloats shift = rt_lanes_shift(thickness, org[a]), above = org[a] + shift, below = org[a] - shift;
        rt_store(&p->org_near[a][first], p->negative[a] ? below : above);
        rt_store(&p->org_far[a][first], p->negative[a] ? above : below);
        rt_store(&p->inv[a][first], 1 / rt_load(&p->dir[a][first]));
    }
    RtFloats limit = rt_min(rt_load(&p->tmax[first]), rt_all(FLT_MAX));
    RtFloats inv = rt_load(&p->inv[p->kz][first]);
    rt_store(&p->tmax[first], limit);
    rt_store(&p->limit[first], limit);
    rt_store(&p->shear_x[first], rt_load(&p->dir[p->kx][first]) * inv);
    rt_store(&p->shear_y[first], rt_load(&p->dir[p->ky][first]) * inv);
}

/* The least lane of each of four vectors. */
RT_KERNEL RtFloat4 least_of_each(const RtFloats v[4]) {
    RtFloat4 rows[4];
    for (int i = 0; i < 4; i++) rows[i] = rt_fold4(v[i]);
    rt_transpose4(rows);
    return rt_min(rt_min(rows[0], rows[1]), rt_min(rows[2], rows[3]));
}

/* Rays of a beam differ in direction by no more than this, as a slope along the major axis. */
#define BEAM_SPREAD 0.1f

RT_KERNEL void bound_beam(Packet *p, uint32_t b) {
    Beam *beam = &p->beam[b];
    RtFloats ends[5][4]; /* minimised: first, last, inverses and shears; greatest values negated */
    for (int k = 0; k < 20; k++) ends[k / 4][k % 4] = rt_all(INFINITY);
    for (size_t i = first_of(b); i < first_of(b) + BEAM; i += RT_LANES) {
        RtFloats x = rt_load(&p->shear_x[i]), y = rt_load(&p->shear_y[i]);
        for (int a = 0; a < 3; a++) {
            RtFloats inv = rt_load(&p->inv[a][i]), near = rt_load(&p->org_near[a][i]);
            RtFloats far = rt_load(&p->org_far[a][i]);
            ends[0][a] = rt_min(ends[0][a], p->negative[a] ? near : -near);
            ends[1][a] = rt_min(ends[1][a], p->negative[a] ? -far : far);
            ends[2][a] = rt_min(ends[2][a], inv);
            ends[3][a] = rt_min(ends[3][a], -inv);
        }
        ends[0][3] = rt_min(ends[0][3], rt_load(&p->tmin[i]));
        ends[1][3] = rt_min(ends[1][3], -rt_load(&p->limit[i]));
        ends[2][3] = rt_min(ends[2][3], x);
        ends[3][3] = rt_min(ends[3][3], -x);
        ends[4][0] = rt_min(ends[4][0], y);
        ends[4][1] = rt_min(ends[4][1], -y);
    }
    RtFloat4 first = least_of_each(ends[0]), last = least_of_each(ends[1]), lo = least_of_each(ends[2]);
    RtFloat4 hi = least_of_each(ends[3]), up = least_of_each(ends[4]);
    beam->tight = true;
    for (int a = 0; a < 3; a++) {
        beam->first[a] = p->negative[a] ? first[a] : -first[a];
        beam->last[a] = p->negative[a] ? -last[a] : last[a];
        beam->inv_least[a] = lo[a];
        beam->inv_most[a] = -hi[a];
        beam->tight &= fabsf(lo[a]) <= FLT_MAX && fabsf(hi[a]) <= FLT_MAX;
    }
    beam->tmin = first[3];
    beam->limit = -last[3];
    beam->tight &= -hi[3] - lo[3] < BEAM_SPREAD && -up[1] - up[0] < BEAM_SPREAD;
}

/* Once per packet, at the first leaf with few rays. */
RT_KERNEL void prepare_prefilter(Packet *p) {
    if (p->prefilter_ready) return;
    p->prefilter_ready = true;
    for (uint32_t i = 0; i < p->count; i += 4) {
        const RtInt4 number = (RtInt4){0, 1, 2, 3} + (int32_t)i;
        RtFloat4 place[4] = {rt_load4(&p->org[p->kx][i]), rt_load4(&p->org[p->ky][i]),
                             rt_load4(&p->org[p->kz][i])};
        RtFloat4 more[4] = {rt_load4(&p->shear_x[i]), rt_load4(&p->shear_y[i]), (RtFloat4)number};
        rt_transpose4(place);
        rt_transpose4(more);
        for (uint32_t k = 0; k < 4; k++) {
            rt_store(p->prefilter[i + k], place[k]);
            rt_store(p->prefilter[i + k] + 4, more[k]);
        }
    }
    for (int k = 0; k < 8; k++) p->prefilter[PACKET][k] = NAN;
}

/* Ray i, prepared for hit functions. */
RT_KERNEL const RtPreparedRay *packet_ray(Packet *p, const Query *q, uint32_t i) {
    if (!(p->prepared & one_ray(i)))
        rt_hit_ray(&p->ray[i], q->geometry, &q->rays[p->index[i]], q->scratch->hit_memory);
    p->prepared |= one_ray(i);
    return &p->ray[i];
}

/* Tests rays that are too extreme for the boxes of split references against all objects. */
RT_KERNEL void test_extreme_rays(Packet *p, const Query *q, bool any) {
    uint64_t odd = 0;
    for (uint32_t i = 0; i < PACKET; i += RT_LANES)
        odd |= (uint64_t)rt_bits(~dirs_are_ordinary(rt_load(&p->dir[p->kz][i]))) << i;
    for (odd &= p->open; odd; odd &= odd - 1) {
        uint32_t i = first_ray(odd);
        rt_test_all(q->geometry, packet_ray(p, q, i), any, &p->best[i], NULL);
        p->open &= ~one_ray(i);
    }
}

/* Makes a packet of up to PACKET rays of a class, which is not empty. */
static __attribute__((noinline)) void init_packet(Packet *p, const Query *q, Sorter *s, uint32_t class,
                                                  bool any) {
    uint32_t *list = s->list[class], count = s->count[class] < PACKET ? s->count[class] : PACKET;
    assert(count > 0);
    p->count = count;
    for (uint32_t i = 0; i < count; i++) p->index[i] = list[i];
    const uint32_t beams = (count + BEAM - 1) / BEAM, end = beams * BEAM;
    for (uint32_t i = count; i < end; i++) p->index[i] = list[0];
    s->count[class] -= count;
    for (uint32_t i = 0; i < s->count[class]; i++) list[i] = list[PACKET + i];

    p->kz = class / 8;
    p->kx = (uint32_t)rt_next_axis((int)p->kz);
    p->ky = (uint32_t)rt_next_axis((int)p->kx);
    for (uint32_t a = 0; a < 3; a++) {
        p->negative[a] = class >> a & 1;
        p->near[a] = (2 * a + p->negative[a]) * PLANE;
        p->far[a] = (2 * a + !p->negative[a]) * PLANE;
    }
    for (uint32_t i = 0; i < end; i += 4) {
        RtFloat4 org[4], dir[4];
        for (uint32_t k = 0; k < 4; k++) {
            const RtRay *ray = &q->rays[p->index[i + k]];
            org[k] = rt_loadu4(ray);
            dir[k] = rt_loadu4((const char *)ray + offsetof(RtRay, dir));
        }
        rt_transpose4(org);
        rt_transpose4(dir);
        for (int a = 0; a < 3; a++) {
            rt_store(&p->org[a][i], org[a]);
            rt_store(&p->dir[a][i], dir[a]);
        }
        rt_store(&p->tmin[i], org[3]);
        rt_store(&p->tmax[i], dir[3]);
    }
    for (uint32_t i = 0; i < end; i += RT_LANES) prepare_lanes(p, q->geometry, i);
    for (uint32_t b = 0; b < beams; b++) bound_beam(p, b);
    p->prefilter_ready = false;
    for (uint32_t i = 0; i < count; i++) p->best[i] = RT_MISS;
    p->open = ~UINT64_C(0) >> (PACKET - count);
    p->prepared = 0;
    p->pair_count = p->top = p->next = 0;
    if (q->tree->split_refs) test_extreme_rays(p, q, any);
    p->going = p->open;
}

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

/* Moves rays into an instance, and asks its part for their hits, as one stream. */
static __attribute__((noinline)) void visit_instance(Packet *p, const Query *q, uint32_t id, uint64_t rays,
                                                     bool any) {
    const RtInstance *instance = rt_instance_of(q->geometry, id);
    const RtQuery *part = &q->scratch->hit_memory->parts[instance->part];
    RtEntry entry[PACKET];
    RtRay inside[PACKET];
    RtHit hits[PACKET];
    uint32_t number[PACKET], occluders[PACKET], count = 0;
    for (; rays; rays &= rays - 1) {
        const uint32_t i = first_ray(rays);
        const RtFloat4 inv = {p->inv[0][i], p->inv[1][i], p->inv[2][i]};
        RtPreparedRay ray;
        span_ray(&ray, &q->rays[p->index[i]], inv, p->tmin[i], p->tmax[i]);
        if (!rt_enter_begin(q->geometry, id, &ray, &p->best[i], &entry[count], &inside[count], NULL))
            continue;
        number[count++] = i;
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
