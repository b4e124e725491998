/* SPDX-License-Identifier: Apache-2.0 */
/* The rays of a packet (packet.h): how they are sorted into packets and prepared, RT_LANES at once. */
#ifndef RT_ACCEL_WIDE_PACKET_RAYS_H
#define RT_ACCEL_WIDE_PACKET_RAYS_H

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

#endif
