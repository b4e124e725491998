/* SPDX-License-Identifier: Apache-2.0 */
/* core/shape/solid.h: spans of every kind of solid against membership of points, accuracy, extents,
 * normals. */
#include "solids_testing.h"

static uint32_t check_random_lines(const RtSolidSet *set, const Model *model, RtRandom *random,
                                   double distance, uint32_t rays) {
    uint32_t met = 0;
    for (uint32_t i = 0; i < rays; i++) {
        RtRay ray = random_ray(model, random, random_target(model, random), distance);
        List list = check_line(model, set, &ray);
        met += list.count > 0;
        double length = rt_lengthd(rt_widen(ray.dir));
        for (int k = 0; k < 4; k++) {
            double t = rt_random_betweend(random, distance - 2, distance + 2) / length;
            check_at(model, &ray, &list, t, ulp_at(model, &ray, t));
        }
    }
    return met;
}

RT_TEST(random_lines_are_inside_where_their_points_are) {
    static const double distances[] = {0, 2, 1e3, 1e5, 1e7};
    RtRandom random = rt_random(1, 0);
    RtTransform place = rt_transform_identity();
    OWNED_MODELS(set, models, &place);
    for (int i = 0; i < MODELS; i++) {
        for (size_t d = 0; d < sizeof distances / sizeof *distances; d++) {
            uint32_t met = check_random_lines(&set, &models[i], &random, distances[d], 2000);
            bool seen =
                models[i].ratio != 1e-4 || distances[d] < 1e4; /* where ulps are not wider than the tube */
            if (seen && met < 20)
                fail_msg("only %u lines met the %s from %g", met, models[i].name, distances[d]);
        }
    }
}

RT_TEST(so_they_are_where_solids_are_turned_stretched_and_moved) {
    RtRandom random = rt_random(2, 0);
    for (int round = 0; round < 60; round++) {
        RtTransform place = rt_transform_identity();
        float size = powf(10, (float)(round % 21 - 10));
        RtVec3 factors = rt_vec3(size, size, size);
        for (int a = 0; a < 3 && round % 2; a++) factors.at[a] *= rt_random_between(&random, 0.1f, 1);
        assert_ok(rt_transform_scale(&place, factors, error));
        double degrees = 360 * (double)rt_random_unit(&random);
        assert_ok(rt_transform_rotate(&place, rt_narrow(rt_random_direction(&random)), degrees, error));
        assert_ok(rt_transform_translate(&place, rt_random_point(&random, 3 * size), error));
        OWNED_MODELS(set, models, &place);
        for (int i = 0; i < MODELS; i++) check_random_lines(&set, &models[i], &random, 5, 100);
    }
}

/* ---- accuracy ---- */

/* The place within an ulp of t where membership changes, by halving. */
static long double true_place(const Model *model, const RtRay *ray, float t) {
    long double lo = (long double)nextafterf(t, -INFINITY), hi = (long double)nextafterf(t, INFINITY);
    bool inside = value_at(model, ray, lo) < 0;
    if ((value_at(model, ray, hi) < 0) == inside) return NAN;
    for (int i = 0; i < 60; i++) {
        long double middle = lo / 2 + hi / 2;
        *((value_at(model, ray, middle) < 0) == inside ? &lo : &hi) = middle;
    }
    return lo / 2 + hi / 2;
}

/* All but one in ten thousand: the error in double is so small that it seldom shows. */
static void check_accuracy(const RtSolidSet *set, const Model *model, RtRandom *random) {
    uint32_t asked = 0, second_best = 0;
    for (int k = 0; k < 5000; k++) {
        RtRay ray = random_ray(model, random, random_target(model, random), 4);
        List list = cross(set, model->index, &ray);
        for (uint32_t c = 0; c < list.count; c++) {
            if (isinf(list.at[c].t)) continue;
            asked++;
            second_best += (float)true_place(model, &ray, list.at[c].t) != list.at[c].t;
        }
    }
    if (asked < 4000 || second_best * 10000 > asked)
        fail_msg("%s: %u of %u crossings are not the nearest", model->name, second_best, asked);
}

RT_TEST(crossings_are_the_float32_nearest_to_the_truth) {
    RtRandom random = rt_random(8, 0);
    for (int turned = 0; turned < 2; turned++) {
        RtTransform place = rt_transform_identity();
        if (turned) assert_ok(rt_transform_rotate(&place, rt_vec3(1, 2, 3), 30, error));
        OWNED_MODELS(set, models, &place);
        for (int i = 0; i < MODELS; i++) {
            bool rounded = models[i].rounding > 0x1p-50; /* its vertices, when turned */
            if (!turned || !rounded) check_accuracy(&set, &models[i], &random);
        }
    }
}

/* ---- extents ---- */

static void check_extents(const RtSolidSet *set, const Model *model, RtRandom *random) {
    const RtSolid *solid = &set->solids[model->index];
    RtBall ball = rt_solid_ball(set, model->index);
    RtVec3d up = rt_random_direction(random);
    double support = rt_solid_support(set, model->index, up), most = -INFINITY;
    for (int i = 0; i < 400; i++) {
        RtRay ray = random_ray(model, random, random_target(model, random), 3);
        List list = cross(set, model->index, &ray);
        for (uint32_t k = 0; k < list.count; k++) {
            if (isinf(list.at[k].t)) continue;
            RtVec3d p = rt_ray_point(&ray, list.at[k].t);
            double noise = 1e-6 * rt_lengthd(rt_widen(rt_vec3((float)p.x, (float)p.y, (float)p.z))) +
                           2 * ulp_at(model, &ray, (double)list.at[k].t) / stretch_of(model);
            most = fmax(most, rt_dotd(p, up));
            assert_true(rt_dotd(p, up) <= support + noise);
            assert_true(rt_lengthd(rt_subd(p, ball.center)) <= ball.radius + noise);
            for (int a = 0; a < 3; a++) {
                assert_true(p.at[a] >= (double)solid->box.lo.at[a] - noise);
                assert_true(p.at[a] <= (double)solid->box.hi.at[a] + noise);
            }
        }
    }
    double size = 0;
    for (int a = 0; a < 3; a++) size += fabs(model->place.m[a][0]) + fabs(model->place.m[a][1]);
    if (isfinite(support)) assert_true(most > support - 0.5 * size);
}

RT_TEST(extents_hold_every_crossing) {
    RtRandom random = rt_random(6, 0);
    for (int round = 0; round < 30; round++) {
        RtTransform place = rt_transform_identity();
        RtVec3 factors = {2, 1, 1};
        for (int a = 1; a < 3; a++) factors.at[a] = rt_random_between(&random, 0.5f, 3);
        assert_ok(rt_transform_scale(&place, factors, error));
        assert_ok(rt_transform_rotate(&place, rt_narrow(rt_random_direction(&random)), 77, error));
        assert_ok(rt_transform_translate(&place, rt_random_point(&random, 10), error));
        OWNED_MODELS(set, models, &place);
        for (int i = 0; i < MODELS; i++) check_extents(&set, &models[i], &random);
    }
}

RT_TEST(extents_are_tight_where_they_can_be_known) {
    OWNED_SOLIDS set = {0};
    uint32_t at;
    RtVec3d aslant = {{3, 0, 4}};
    assert_ok(rt_solid_add_ellipsoid(&set, rt_vec3(1, 2, 3), rt_vec3(2, 2, 2), &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 2, 1e-8);
    assert_near(rt_solid_support(&set, at, aslant), 15 + 10, 1e-12);
    assert_ok(rt_solid_add_ellipsoid(&set, rt_vec3(1, 2, 3), rt_vec3(1, 4, 2), &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 4, 1e-8);
    assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0), 3, rt_vec3(0, 0, 8), 3, &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 5, 1e-8);
    assert_near(rt_solid_ball(&set, at).center.z, 4, 1e-8);
    assert_near(rt_solid_support(&set, at, aslant), 9 + 32, 1e-12);
    assert_ok(rt_solid_add_frustum(&set, rt_vec3(0, 0, 0), 9, rt_vec3(0, 0, 1), 3, &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 9, 1e-7);
    assert_ok(rt_solid_add_ring(&set, rt_vec3(0, 0, 0), rt_vec3(0, 1, 0), 3, 1, &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 4, 1e-8);
    assert_near(rt_solid_support(&set, at, rt_vec3d(0, 1, 0)), 1, 1e-12);
    assert_near(rt_solid_support(&set, at, aslant), 20, 1e-12);
    assert_ok(rt_solid_add_box(&set, rt_vec3(-1, -2, -2), rt_vec3(1, 2, 2), &at, error));
    assert_near(rt_solid_ball(&set, at).radius, 3, 1e-8);
    assert_near(rt_solid_support(&set, at, aslant), 11, 1e-8);
}

RT_TEST(what_has_no_end_has_extents_without_end) {
    OWNED_SOLIDS set = {0};
    uint32_t half, oblique, slab, wedge;
    RtPlane slab_planes[2] = {{{{0, 1, 0}}, 3}, {{{0, -1, 0}}, -2}},
            wedge_planes_too[2] = {{{{1, 0, 0}}, 3}, {{{0, 1, 0}}, 5}};
    assert_ok(rt_solid_add_half_space(&set, rt_vec3(0, 0, 7), rt_vec3(0, 0, 1), &half, error));
    assert_ok(rt_solid_add_half_space(&set, rt_vec3(0, 0, 7), rt_vec3(1, 1, 1), &oblique, error));
    assert_ok(rt_solid_add_polyhedron(&set, slab_planes, 2, NULL, &slab, error));
    assert_ok(rt_solid_add_polyhedron(&set, wedge_planes_too, 2, NULL, &wedge, error));
    const float none = INFINITY;
    const RtBox boxes[4] = {{{{-none, -none, -none}}, {{none, none, 7}}},
                            {{{-none, -none, -none}}, {{none, none, none}}},
                            {{{-none, 2, -none}}, {{none, 3, none}}},
                            {{{-none, -none, -none}}, {{3, 5, none}}}};
    for (uint32_t i = 0; i < 4; i++) {
        assert_memory_equal(&set.solids[i].box, &boxes[i], sizeof(RtBox));
        assert_true(isinf(rt_solid_ball(&set, i).radius));
    }
    const RtPlane octant_planes[3] = {{{{1, 0, 0}}, 3}, {{{0, 1, 0}}, 5}, {{{0, 0, 1}}, 7}};
    uint32_t octant;
    assert_ok(rt_solid_add_polyhedron(&set, octant_planes, 3, NULL, &octant, error));
    assert_near(rt_solid_support(&set, octant, rt_vec3d(1, 1, 1)), 15, 1e-9);
    assert_true(isinf(rt_solid_support(&set, octant, rt_vec3d(1, 1, -1))));
    assert_near(rt_solid_support(&set, oblique, rt_vec3d(2, 2, 2)), 14, 1e-9);
    assert_true(isinf(rt_solid_support(&set, oblique, rt_vec3d(-1, -1, -1))));
    assert_near(rt_solid_support(&set, wedge, rt_vec3d(1, 2, 0)), 13, 1e-9);
    assert_true(isinf(rt_solid_support(&set, wedge, rt_vec3d(1, 2, 0.1))));
}

/* ---- normals ---- */

/* Along the way on which membership grows fastest. */
RT_TEST(normals_point_out) {
    RtRandom random = rt_random(7, 0);
    RtTransform place = rt_transform_identity();
    assert_ok(rt_transform_scale(&place, rt_vec3(1, 2, 3), error));
    assert_ok(rt_transform_rotate(&place, rt_vec3(1, 2, 3), 50, error));
    assert_ok(rt_transform_translate(&place, rt_vec3(5, 6, 7), error));
    OWNED_MODELS(set, models, &place);
    for (int i = 0; i < MODELS; i++) {
        if (models[i].ratio == 1e-4) continue; /* as thin as the steps below are long */
        uint32_t wrong = 0, asked = 0;
        for (int k = 0; k < 500; k++) {
            RtRay ray = random_ray(&models[i], &random, random_target(&models[i], &random), 3);
            List list = cross(&set, models[i].index, &ray);
            for (uint32_t c = 0; c < list.count; c++) {
                if (isinf(list.at[c].t)) continue;
                RtVec3d p = rt_ray_point(&ray, list.at[c].t), gradient;
                RtVec3d n = rt_solid_normal(&set, models[i].index, list.at[c].face, p);
                assert_near(rt_lengthd(n), 1, 1e-12);
                for (int a = 0; a < 3; a++) {
                    RtRay probe = ray_along(rt_narrow(p), rt_vec3(a == 0, a == 1, a == 2));
                    gradient.at[a] =
                        (double)(value_at(&models[i], &probe, 1e-3L) - value_at(&models[i], &probe, -1e-3L));
                }
                asked++;
                wrong += rt_dotd(rt_normalized(gradient), n) < 0.999; /* so it is at an edge */
            }
        }
        if (wrong * 50 > asked || asked == 0) fail_msg("%s: %u of %u normals", models[i].name, wrong, asked);
    }
}

RT_TESTS(solids, NULL, NULL)
