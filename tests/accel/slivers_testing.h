/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of trees with split references: scenes of long slivers, and rays that reveal lost parts. */
#ifndef RT_TESTS_SLIVERS_TESTING_H
#define RT_TESTS_SLIVERS_TESTING_H

#include "accel_testing.h"

#include "core/base/random.h"

static inline void add_triangle(RtScene *scene, RtVec3 a, RtVec3 b, RtVec3 c) {
    const RtVec3 v[3] = {a, b, c};
    assert_ok(rt_scene_add_triangle(scene, 0, v, NULL, error));
}

static inline RtVec3 point_in(RtRandom *random, float scale, float offset) {
    RtVec3 p;
    for (int a = 0; a < 3; a++) p.at[a] = offset + scale * rt_random_between(random, 0, 1);
    return p;
}

/* `count` objects: long slivers in all directions, with spheres, cones and thin polygons among them. */
static inline RtScene make_slivers(uint32_t count, uint64_t seed, float scale, float offset) {
    RtScene scene = begin_scene();
    RtRandom random = rt_random(seed, 0);
    for (uint32_t i = 0; i < count; i++) {
        RtVec3 a = point_in(&random, scale, offset), b = point_in(&random, scale, offset), c = b;
        for (int k = 0; k < 3; k++) c.at[k] += scale * rt_random_between(&random, -0.01f, 0.01f);
        const RtVec3 corners[4] = {a, b, c, {{a.x + c.x - b.x, a.y + c.y - b.y, a.z + c.z - b.z}}};
        RtError ignored; /* a polygon may have turned out not to be planar */
        if (i % 8 == 7)
            assert_ok(
                rt_scene_add_sphere(&scene, 0, a, scale * rt_random_between(&random, 0.01f, 0.4f), error));
        else if (i % 8 == 6)
            assert_ok(rt_scene_add_cone(&scene, 0, a, scale * 0.01f, b, 0, error));
        else if (i % 8 > 3 || rt_scene_add_polygon(&scene, 0, corners, 4, &ignored) != RT_OK)
            add_triangle(&scene, a, b, c);
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* At points of objects, from in and around the scene or very far away; in the planes of a box's sides, along
 * axes or across; with dirs of any length; ending at the point or beyond. */
static inline void aim_at_slivers(RtRandom *random, const RtScene *scene, const RtBox *box, RtRay *ray) {
    const RtGeometry *g = &scene->geometry;
    RtVec3 size = rt_box_size(g->box), from, to;
    float longest = size.at[rt_major_axis(size)], away = 1;
    uint32_t pick = rt_random_bits(random), id = rt_random_below(random, g->object_count);
    for (uint32_t i = pick % 8; i > 4; i--) away *= 100; /* 1, 1e2, 1e4, 1e6 scene sizes */
    for (int a = 0; a < 3; a++) {
        const RtBox *own = &g->boxes[id];
        to.at[a] = own->lo.at[a] + (own->hi.at[a] - own->lo.at[a]) * rt_random_between(random, 0, 1);
        from.at[a] = to.at[a] + longest * away * rt_random_between(random, -1, 1);
    }
    if (rt_ref_shape(g->objects[id]) == RT_SHAPE_TRIANGLE) { /* a point of it, or of an edge */
        const RtVec3 *v = g->triangles[rt_ref_index(g->objects[id])].v;
        float u = rt_random_between(random, 0, 1),
              w = pick & 16 ? 0 : (1 - u) * rt_random_between(random, 0, 1);
        for (int a = 0; a < 3; a++) to.at[a] = v[0].at[a] * (1 - u - w) + v[1].at[a] * u + v[2].at[a] * w;
    }
    if ((pick & 6144) == 0) from = rt_vec3(0, 0, 0); /* where rounding the origin makes no ray thicker */
    if (pick & 32) {                                 /* in a plane of the box */
        int a = (int)(rt_random_below(random, 3));
        from.at[a] = to.at[a] = (pick & 64 ? box->lo : box->hi).at[a];
        if (pick & 128) from.at[(a + 1) % 3] = to.at[(a + 1) % 3]; /* along an axis */
    }
    RtVec3 dir = rt_sub(to, from);
    float reach = 1;
    if (pick & 256) {
        float factor = pick & 512 ? 0x1p-70f : 0x1p70f; /* beyond what float32 bears, nearly */
        dir = rt_scale(dir, factor);
        reach = 1 / factor;
    }
    *ray = (RtRay){from, 0, dir, pick & 1024 ? reach : INFINITY, RT_RAY_RANDOM, 0};
    if (!rt_ray_is_valid(ray)) *ray = (RtRay){to, 0, {{1, 0, 0}}, INFINITY, RT_RAY_RANDOM, 0};
}

#endif
