/* SPDX-License-Identifier: Apache-2.0 */
/* Bundles of rays that go the same way, or nearly do, so that they are traced as packets or hard to keep from
 * it; each about a scene and the boxes that a structure has of it. */
#ifndef RT_TESTS_BUNDLES_TESTING_H
#define RT_TESTS_BUNDLES_TESTING_H

#include "random_testing.h"
#include "slivers_testing.h"

#include "core/scene/scene.h"

/* As many rays as a packet holds, and how many bundles of each sort there are. A sanitizer looks at what is
 * read and written, which is the same in each round. */
enum { BUNDLE = 64, ROUNDS = RT_SHARE(3, 1) };

/* What rays are aimed at: a scene, and the boxes that a structure has of it. */
typedef struct Target {
    const RtScene *scene;
    RtRandom random;
    RtVec3 middle;
    float size;
    RtBox boxes[512];
    uint32_t box_count;
} Target;

/* A point of an object's box: of a triangle also a vertex, or a point of an edge. */
static inline RtVec3 point_on(Target *target, uint32_t id) {
    const RtGeometry *g = &target->scene->geometry;
    RtRandom *random = &target->random;
    if (g->object_count == 0) return rt_random_point(random, 1);
    RtVec3 p;
    const RtBox *own = &g->boxes[id];
    for (int a = 0; a < 3; a++)
        p.at[a] = own->lo.at[a] + (own->hi.at[a] - own->lo.at[a]) * rt_random_unit(random);
    if (rt_ref_shape(g->objects[id]) != RT_SHAPE_TRIANGLE) return p;
    const RtVec3 *v = g->triangles[rt_ref_index(g->objects[id])].v;
    uint32_t pick = rt_random_below(random, 4);
    float u = pick ? rt_random_unit(random) : 0, w = pick > 1 ? (1 - u) * rt_random_unit(random) : 0;
    for (int a = 0; a < 3; a++) p.at[a] = v[0].at[a] * (1 - u - w) + v[1].at[a] * u + v[2].at[a] * w;
    return p;
}

static inline RtVec3 any_point(Target *target) {
    uint32_t count = target->scene->geometry.object_count;
    return point_on(target, count ? rt_random_below(&target->random, count) : 0);
}

static inline RtVec3 outside(Target *target, float sizes) {
    return rt_add(target->middle,
                  rt_narrow(rt_scaled(rt_random_direction(&target->random), (double)(sizes * target->size))));
}

/* From a point, towards what is seen in a small window about another. */
static inline void pinhole(Target *target, RtRay *rays, RtVec3 eye, float window) {
    RtVec3 middle = any_point(target);
    for (int i = 0; i < BUNDLE; i++) {
        RtVec3 at = rt_add(middle, rt_random_point(&target->random, window * target->size));
        rays[i] = (RtRay){eye, 0, rt_sub(at, eye), INFINITY, RT_RAY_PRIMARY, 0};
    }
}

static inline void from_outside(Target *target, RtRay *rays) {
    pinhole(target, rays, outside(target, 3), 0.02f);
}

static inline void from_within(Target *target, RtRay *rays) {
    pinhole(target, rays, any_point(target), 0.1f);
}

static inline void over_the_whole(Target *target, RtRay *rays) { /* signs or the major axis may change */
    pinhole(target, rays, outside(target, 0.8f), 0.5f);
}

static inline void from_far_away(Target *target, RtRay *rays) {
    pinhole(target, rays, outside(target, 1e5f), 0.01f);
}

static inline void at_exact_points(Target *target, RtRay *rays) {
    pinhole(target, rays, outside(target, 2), 1e-7f);
}

static inline void parallel(Target *target, RtRay *rays) {
    RtVec3 eye = outside(target, 3), dir = rt_sub(any_point(target), eye);
    for (int i = 0; i < BUNDLE; i++) {
        RtVec3 from = rt_add(eye, rt_random_point(&target->random, 0.1f * target->size));
        rays[i] = (RtRay){from, 0, dir, INFINITY, RT_RAY_RANDOM, 0};
    }
}

static inline void all_the_same(Target *target, RtRay *rays) {
    RtVec3 eye = outside(target, 2);
    for (int i = 0; i < BUNDLE; i++)
        rays[i] = (RtRay){eye, 0, rt_sub(target->middle, eye), INFINITY, RT_RAY_RANDOM, 0};
}

/* Into one octant, but each its own way. */
static inline void scattered(Target *target, RtRay *rays) {
    for (int i = 0; i < BUNDLE; i++) {
        RtVec3 at = any_point(target), from = at;
        for (int a = 0; a < 3; a++) from.at[a] -= target->size * (0.01f + rt_random_unit(&target->random));
        from.x -= target->size; /* x is the major axis */
        rays[i] = (RtRay){from, 0, rt_sub(at, from), INFINITY, RT_RAY_DIFFUSE, 0};
    }
}

static inline void to_a_light(Target *target, RtRay *rays) {
    RtVec3 light = outside(target, 1.5f), middle = any_point(target);
    for (int i = 0; i < BUNDLE; i++) {
        RtVec3 from = rt_add(middle, rt_random_point(&target->random, 0.05f * target->size));
        rays[i] = (RtRay){from, 0, rt_sub(light, from), 1, RT_RAY_SHADOW, 0};
    }
}

/* With intervals of t that begin or end within the scene. */
static inline void bounded(Target *target, RtRay *rays) {
    pinhole(target, rays, outside(target, 1.2f), 0.05f);
    for (int i = 0; i < BUNDLE; i++) {
        rays[i].tmin = rt_random_between(&target->random, 0, 1);
        rays[i].tmax = rays[i].tmin + rt_random_between(&target->random, 0, 1);
    }
}

/* One component is 0, or -0, of all or of one in a packet; the rays start in a plane of a box. */
static inline void with_a_zero(Target *target, RtRay *rays) {
    uint32_t axis = rt_random_below(&target->random, 3), some = rt_random_bits(&target->random);
    const RtBox *box = target->box_count ? &target->boxes[rt_random_below(&target->random, target->box_count)]
                                         : &target->scene->geometry.box;
    RtVec3 eye = outside(target, 2);
    if (target->box_count) eye.at[axis] = (some & 1 ? box->lo : box->hi).at[axis];
    pinhole(target, rays, eye, 0.02f);
    bool negative = signbit(rays[0].dir.at[axis]);
    for (int i = 0; i < BUNDLE; i++) {
        if (some & 2 && i % 16 != (int)(some >> 8 & 15)) continue;
        rays[i].dir.at[axis] = negative != ((some & 4) != 0) ? -0.0f : 0.0f;
    }
}

/* A point of a triangle, or of its edge, in a plane across an axis; false where none was found. */
static inline bool point_in_plane(Target *target, int axis, float plane, RtVec3 *at) {
    const RtGeometry *g = &target->scene->geometry;
    for (int tries = 0; tries < 64 && g->triangle_count; tries++) {
        const RtVec3 *v = g->triangles[rt_random_below(&target->random, g->triangle_count)].v;
        RtVec3 ends[3];
        int count = 0;
        for (int i = 0; i < 3; i++) {
            RtVec3 a = v[i], b = v[(i + 1) % 3];
            float u = (plane - a.at[axis]) / (b.at[axis] - a.at[axis]);
            if (u >= 0 && u <= 1) ends[count++] = rt_add(a, rt_scale(rt_sub(b, a), u));
        }
        if (count < 2) continue;
        float w = tries % 2 ? rt_random_unit(&target->random) : 0;
        *at = rt_add(ends[0], rt_scale(rt_sub(ends[1], ends[0]), w));
        at->at[axis] = plane;
        return true;
    }
    return false;
}

/* All but in the planes that cut objects, where these are: a packet each. */
static inline void along_planes(Target *target, RtRay *rays) {
    from_outside(target, rays); /* where there is no better */
    for (int packet = 0; packet < BUNDLE && target->box_count; packet += 16) {
        int axis = (int)rt_random_below(&target->random, 3);
        uint32_t some = rt_random_bits(&target->random);
        const RtBox *box = &target->boxes[rt_random_below(&target->random, target->box_count)];
        RtVec3 at, from;
        float plane = (some & 1 ? box->lo : box->hi).at[axis];
        if (!point_in_plane(target, axis, plane, &at)) continue;
        from = rt_add(at, rt_random_point(&target->random, (some & 2 ? 1.0f : 100.0f) * target->size));
        if (some & 4) from = rt_vec3(0, 0, 0); /* where rounding the origin makes no ray thicker */
        from.at[axis] = plane;
        RtVec3 dir = rt_sub(at, from);
        for (int i = packet; i < packet + 16; i++) {
            rays[i] = (RtRay){from, 0, dir, INFINITY, RT_RAY_RANDOM, 0};
            for (int a = 0; a < 3; a++)
                rays[i].dir.at[a] *= 1 + rt_random_between(&target->random, 0, 0x1p-20f);
            rays[i].dir.at[axis] = (some & 8 ? 1e-12f : -1e-12f) * target->size;
        }
    }
}

/* As slivers ask for: each by itself, and a packet of each, for which it may have no zero. */
static inline void at_slivers(Target *target, RtRay *rays) {
    bool packets = rt_random_below(&target->random, 2);
    for (int i = 0; i < BUNDLE; i++) {
        const RtBox *box = &target->boxes[rt_random_below(&target->random, target->box_count)];
        if (packets && i % 16) {
            rays[i] = rays[i - 1];
            rays[i].dir.at[i % 3] *= 1 + 0x1p-22f;
            continue;
        }
        aim_at_slivers(&target->random, target->scene, box, &rays[i]);
        float *dir = rays[i].dir.at, tiny = 1e-12f * dir[rt_major_axis(rays[i].dir)];
        for (int a = 0; a < 3 && packets; a++) dir[a] = dir[a] == 0 ? tiny : dir[a];
    }
}

/* So long, or short, that float32 is nearly out of exponents, or that 1 / dir is infinite. */
static inline void odd_lengths(Target *target, RtRay *rays) {
    static const float factors[] = {0x1p-63f, 0x1p-70f, 0x1p-120f, 0x1p-140f, 0x1p63f, 0x1p70f, 0x1p100f};
    float factor = factors[rt_random_below(&target->random, 7)];
    pinhole(target, rays, outside(target, 2), 0.02f);
    for (int i = 0; i < BUNDLE; i++) rays[i].dir = rt_scale(rays[i].dir, factor);
}

/* Nearly along an axis, and so short that 1 / dir is infinite along the others, though the ray moves along
 * them too; and that some of the t are. A tree that divides objects has them elsewhere than such rays look.
 */
static inline void short_along_an_axis(Target *target, RtRay *rays) {
    RtRandom *random = &target->random;
    uint32_t axis = rt_random_below(random, 3);
    float length = target->size * (rt_random_below(random, 4) ? 0.3f : 6);
    for (int i = 0; i < BUNDLE; i++) {
        RtVec3 at = any_point(target), dir;
        for (uint32_t a = 0; a < 3; a++) dir.at[a] = a == axis ? 1 : rt_random_between(random, 0.01f, 0.2f);
        rays[i] = (RtRay){
            rt_sub(at, rt_scale(dir, length)), 0, rt_scale(dir, 0x1p-126f), INFINITY, RT_RAY_RANDOM, 0};
    }
}

/* Sixteen at a time whose first has one longest component and the others another that is as long. */
static inline void with_ties_of_axes(Target *target, RtRay *rays) {
    RtRandom *random = &target->random;
    for (int i = 0; i < BUNDLE; i++) {
        uint32_t axis = (uint32_t)(i / 16) % 3, other = (axis + 1 + rt_random_below(random, 2)) % 3;
        RtVec3 at = any_point(target), dir;
        for (int a = 0; a < 3; a++) dir.at[a] = target->size * rt_random_between(random, 0.1f, 0.9f);
        dir.at[axis] = target->size;
        if (i % 16) dir.at[other] = target->size;
        rays[i] = (RtRay){rt_sub(at, dir), 0, dir, INFINITY, RT_RAY_RANDOM, 0};
    }
}

typedef void Bundle(Target *target, RtRay *rays);
static Bundle *const bundles[] = {
    from_outside, from_within,  over_the_whole, from_far_away,       at_exact_points,
    parallel,     all_the_same, scattered,      to_a_light,          bounded,
    with_a_zero,  along_planes, odd_lengths,    short_along_an_axis, with_ties_of_axes};
enum { BUNDLES = sizeof bundles / sizeof bundles[0], RAYS = BUNDLES * ROUNDS * BUNDLE, ALL = 2 * RAYS };

/* Rays that are not valid, where a scene is tiny or huge, become one that is. */
static inline void make_rays(Target *target, RtRay *rays, Bundle *only) {
    for (size_t i = 0; i < RAYS; i += BUNDLE) (only ? only : bundles[i / BUNDLE % BUNDLES])(target, rays + i);
    for (int i = 0; i < RAYS; i++) {
        if (!rt_ray_is_valid(&rays[i]))
            rays[i] = (RtRay){target->middle, 0, {{1, 1, 1}}, INFINITY, RT_RAY_RANDOM, 0};
    }
}

#endif
