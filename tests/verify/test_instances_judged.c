/* SPDX-License-Identifier: Apache-2.0 */
/* The referee and verdicts follow an id into instances: exact hits there; what may be wrong and what may not;
 * how far clamping moves a hit. */
#include "crossings_testing.h"
#include "equivalence_testing.h"
#include "instances_testing.h"
#include "random_testing.h"
#include "verify/verdict_testing.h"

#include "core/base/random.h"
#include "verify/failure.h"
#include "verify/verdict.h"

#include <inttypes.h>

static bool is_wrong(const RtGeometry *g, const RtRay *ray, RtHit answer) {
    return verdict_by_margins(g, ray, answer) == RT_WRONG;
}

static bool must_be(const RtGeometry *g, const RtRay *ray) {
    bool certain, must_hit;
    assert_ok(rt_verdict_certain(rt_judge(g, ray, false), &certain, &must_hit, error));
    return certain;
}

static const RtVec3 down = {{0, 0, -1}};

/* ---- exact hits ---- */

RT_TEST(an_id_in_nested_instances_is_met_where_it_is_placed) {
    OWNED_SCENE scene = begin_balls();
    RtScene pair = begin_scene();
    place(&pair, &scene, 0, moved(0, 0, 1)), place(&pair, &scene, 0, moved(0, 0, 5));
    add_part(&scene, &pair);
    add_ball(&scene, 0, 0, -9, 1);
    place(&scene, &scene, 0, moved(8, 0, 0)), place(&scene, &scene, 1, moved(0, 0, 10));
    assert_ok(rt_scene_finish(&scene, error));
    const RtRay ray = ray_along(rt_vec3(0, 0, 20), down);
    static const long double at[] = {28, 0, 8, 4};
    for (uint32_t id = 0; id < 4; id++) {
        const RtWideRay line = rt_wide_ray(&ray);
        long double t = 0;
        const RtExactResult result = rt_referee_hit(&scene.geometry, id, &line, &t);
        assert_int_equal(result, id == 1 ? RT_MISSED : RT_HIT);
        assert_true(t == at[id]);
        assert_int_equal(is_wrong(&scene.geometry, &ray, (RtHit){(float)at[id], id}), id != 3);
    }
    const RtExactAnswer exact = rt_referee_nearest(&scene.geometry, &ray);
    assert_true(exact.object == 3 && exact.tied == 1 && exact.t == 4);
    assert_true(must_be(&scene.geometry, &ray));
    const RtHit other = {4, 2};
    RtFault fault;
    assert_ok(rt_verdict_fault(rt_judge(&scene.geometry, &ray, false), other, &fault, error));
    assert_int_equal(fault, RT_FAULT_DISPLACED);
    assert_true(is_wrong(&scene.geometry, &ray, (RtHit){4, 4})); /* there is no such id */
    assert_true(is_wrong(&scene.geometry, &ray, RT_MISS));
    RtHit unnamed = {8, RT_UNNAMED_OBJECT};
    assert_ok(rt_verdict_name_object(rt_judge(&scene.geometry, &ray, false), (RtHit){4, 3}, &unnamed, error));
    assert_int_equal(unnamed.object, 2);
    unnamed = (RtHit){2, RT_UNNAMED_OBJECT};
    assert_ok(rt_verdict_name_object(rt_judge(&scene.geometry, &ray, false), (RtHit){4, 3}, &unnamed, error));
    assert_int_equal(unnamed.object, 3);
}

RT_TEST(an_inverse_that_no_double_represents_is_exact) {
    OWNED_SCENE scene = begin_balls();
    add_ball(&scene, 0, 0, 0, 3);
    place(&scene, &scene, 0, scaled(3, 3, 3)), place(&scene, &scene, 0, scaled(3, 3, nextafter(3, 4)));
    assert_ok(rt_scene_finish(&scene, error));
    RtRandom random = rt_random(1, 0);
    for (int i = 0; i < 50; i++) {
        const RtVec3 org = rt_random_point(&random, 9);
        const RtRay ray = ray_along(org, rt_sub(rt_random_point(&random, 1), org));
        int order;
        long double apart;
        if (rt_referee_order(&scene.geometry, 0, 1, &ray, &order, &apart) != RT_HIT) continue;
        assert_true(order == 0 && apart == 0);
        if (rt_referee_order(&scene.geometry, 0, 2, &ray, &order, &apart) != RT_HIT) continue;
        assert_true(order != 0 && apart < 1e-12L);
    }
}

RT_TEST(instances_that_coincide_are_a_tie_of_all_that_the_first_wins) {
    OWNED_SCENE scene = begin_balls();
    const uint32_t count = RT_SHARE(3000, 200);
    for (uint32_t i = 0; i < count; i++) place(&scene, &scene, 0, sheared(0.3));
    assert_ok(rt_scene_finish(&scene, error));
    const RtRay ray = ray_along(rt_vec3(0.1f, 0.2f, 9), down);
    const RtExactAnswer exact = rt_referee_nearest(&scene.geometry, &ray);
    assert_true(exact.object == 0 && exact.tied == count);
    const RtHit first = {(float)exact.t, 0}, last = {first.t, count - 1};
    assert_int_equal(verdict_of(&scene.geometry, &ray, first, last), RT_TIE);
    assert_true(is_wrong(&scene.geometry, &ray, RT_MISS));
    assert_false(must_be(&scene.geometry, &ray));
}

/* ---- flattened ---- */

static RtVec3 coarse(RtRandom *random, int size) {
    RtVec3 p;
    for (int a = 0; a < 3; a++)
        p.at[a] = (float)rt_random_below(random, (uint32_t)size << 5) / 16 - (float)size;
    return p;
}

/* Turned by multiples of 90 degrees, scaled by 1 or 2 along each axis, and moved by integers. */
static RtTransform exact_matrix(RtRandom *random, bool even) {
    RtTransform t = rt_transform_identity();
    RtVec3 axis = {{0, 0, 0}}, factors;
    const float scale = 1 + (float)rt_random_below(random, 2);
    axis.at[rt_random_below(random, 3)] = 1;
    for (int a = 0; a < 3; a++) factors.at[a] = even ? scale : 1 + (float)rt_random_below(random, 2);
    assert_ok(rt_transform_rotate(&t, axis, 90 * (double)rt_random_below(random, 4), error));
    assert_ok(rt_transform_scale(&t, factors, error));
    const RtVec3 by = coarse(random, 4);
    for (int a = 0; a < 3; a++) t.m[a][3] = floor((double)by.at[a]);
    return t;
}

/* Parts of small-integer triangles, and of balls where scales are even; the last one has two levels below. */
static RtScene exactly_placed(RtRandom *random, bool even) {
    RtScene scene = begin_scene();
    for (uint32_t k = 0; k < 4; k++) {
        RtScene part = begin_scene(), *to = k < 3 ? &part : &scene;
        for (int i = 0; i < 4; i++) {
            const RtVec3 v[3] = {coarse(random, 2), coarse(random, 2), coarse(random, 2)},
                         at = coarse(random, 2);
            assert_ok(rt_scene_add_triangle(to, 0, v, NULL, error));
            if (even) add_ball(to, at.x, at.y, at.z, 0.5f);
        }
        for (int i = 0; k > 0 && i < 4; i++)
            place(to, &scene, rt_random_below(random, scene.part_count), exact_matrix(random, even));
        if (k < 3)
            add_part(&scene, &part);
        else
            rt_scene_clear(&part);
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

RT_TEST(where_a_matrix_rounds_nothing_the_exact_and_all_certain_answers_are_those_of_the_flattened_scene) {
    uint64_t certain = 0, rays = 0;
    for (uint64_t s = 0; s < RT_SHARE(6, 2); s++) {
        RtRandom random = rt_random(21, s);
        OWNED_BENCH bench = {.scene = exactly_placed(&random, s % 2)};
        OWNED_SCENE flat;
        set_up_rays(&bench, 1 + s, RT_SHARE(100, 10));
        assert_ok(rt_scene_flatten(&bench.scene, &flat, error));
        OWNED_ACCEL RtAccel *of_flat = open_accel(&flat, "bvh");
        OWNED_QUERY query = open_query(of_flat);
        const RtGeometry *g = &bench.scene.geometry;
        for (size_t i = 0; i < bench.reference.count; i++) {
            const RtRay *ray = &bench.rays[i];
            const RtHit hit = bench.reference.hits[i];
            RtHit same;
            rt_nearest(&query, ray, 1, &same, NULL);
            rays++;
            if (i % 10 == 0) {
                const RtExactAnswer one = rt_referee_nearest(g, ray),
                                    other = rt_referee_nearest(&flat.geometry, ray);
                if (one.object != other.object || one.tied != other.tied || one.t != other.t)
                    fail_msg("scene %d, ray %zu: exactly %u of %u at %Lg, flattened %u of %u at %Lg", (int)s,
                             i, one.object, one.tied, one.t, other.object, other.tied, other.t);
            }
            if (!must_be(g, ray)) continue;
            certain++;
            if (hit.object != same.object)
                fail_msg("scene %d, ray %zu: certain, but %u and flattened %u", (int)s, i, hit.object,
                         same.object);
        }
    }
    print_message("%" PRIu64 " of %" PRIu64 " rays are certain\n", certain, rays);
    assert_true(certain > rays / 2);
}

/* ---- what is not wrong ---- */

/* Instances by float32 alone: the matrix is rounded, inverted and applied in it; boxes are not tested. */
static bool enter_in_float(const RtInstance *instance, const RtRay *ray, RtRay *inside) {
    float m[3][4], c[3][3], sum[3];
    for (int row = 0; row < 3; row++)
        for (int k = 0; k < 4; k++) m[row][k] = (float)instance->to_world.m[row][k];
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, d = (a + 2) % 3;
        for (int k = 0; k < 3; k++) {
            const int u = (k + 1) % 3, v = (k + 2) % 3;
            c[a][k] = m[u][b] * m[v][d] - m[v][b] * m[u][d];
        }
    }
    const float determinant = m[0][0] * c[0][0] + m[1][0] * c[0][1] + m[2][0] * c[0][2];
    *inside = *ray;
    for (int a = 0; a < 3; a++) {
        for (int k = 0; k < 3; k++) c[a][k] *= 1 / determinant;
        sum[a] = -(c[a][0] * m[0][3] + c[a][1] * m[1][3] + c[a][2] * m[2][3]);
        inside->org.at[a] = c[a][0] * ray->org.x + c[a][1] * ray->org.y + c[a][2] * ray->org.z + sum[a];
        inside->dir.at[a] = c[a][0] * ray->dir.x + c[a][1] * ray->dir.y + c[a][2] * ray->dir.z;
    }
    return rt_ray_is_valid(inside);
}

static RtHit answer_in_float(const RtGeometry *g, const RtRay *ray) {
    RtPreparedRay prepared;
    RtHit best = RT_MISS;
    rt_hit_ray(&prepared, g, ray, hit_memory_of_tests());
    for (uint32_t id = 0; id < g->object_count; id++) {
        RtHit hit = {0, id};
        RtRay inside;
        if (rt_is_instance(g, id)) {
            const RtInstance *instance = rt_instance_of(g, id);
            if (!enter_in_float(instance, ray, &inside)) continue;
            hit = answer_in_float(instance->geometry, &inside);
            if (hit.object == RT_NO_OBJECT) continue;
            hit.object += instance->first;
        } else if (!rt_object_hit(g, id, &prepared, &hit.t, NULL)) {
            continue;
        }
        if (rt_hit_before(hit.t, hit.object, best)) best = hit;
    }
    return best;
}

/* Ours, those of float32, and those of copies, rounded to float32. */
static void assert_none_is_wrong(const FamilyBench *bench, uint64_t *certain) {
    const RtGeometry *g = &bench->scene.geometry;
    OWNED_SCENE flat;
    RtError refused;
    const bool copied = rt_scene_flatten(&bench->scene, &flat, &refused) == RT_OK;
    OWNED_ACCEL RtAccel *of_flat = copied ? open_accel(&flat, "bvh") : NULL;
    OWNED_QUERY query = copied ? open_query(of_flat) : (RtQuery){0};
    static const char *const names[] = {"brute", "float32", "copies"};
    for (size_t i = 0; i < bench->reference.count; i++) {
        const RtRay *ray = &bench->rays[i];
        RtHit answers[3] = {bench->reference.hits[i], answer_in_float(g, ray), RT_MISS};
        if (copied) rt_nearest(&query, ray, 1, &answers[2], NULL);
        *certain += must_be(g, ray);
        for (int k = 0; k < 2 + copied; k++) {
            if (!is_wrong(g, ray, answers[k])) continue;
            RtFault fault;
            char text[RT_RAY_TEXT];
            rt_ray_format(ray, text, sizeof text);
            assert_ok(rt_verdict_fault(rt_judge(g, ray, false), answers[k], &fault, error));
            fail_msg("%s, %s, ray %zu (%s), %s: %s, object %u at %g; brute says %u at %g", bench->scene.name,
                     names[k], i, rt_ray_family_name(i * rt_ray_family_count() / bench->reference.count),
                     text, rt_fault_name(fault), answers[k].object, (double)answers[k].t, answers[0].object,
                     (double)answers[0].t);
        }
    }
}

RT_TEST(structures_that_round_moved_rays_or_copies_have_nothing_wrong) {
    uint64_t certain = 0, rays = 0;
    for (size_t f = 0; f < rt_family_count(); f++) {
        for (uint64_t seed = 1; seed <= RT_SHARE(2, 1); seed++) {
            OWNED_SCENE probe = open_family(f, seed);
            if (probe.geometry.instance_count == 0) break;
            OWNED_BENCH bench;
            uint64_t before = certain;
            set_up_family(&bench, f, seed, RT_SHARE(15, 5));
            assert_none_is_wrong(&bench, &certain);
            rays += bench.reference.count;
            print_message("%s: %" PRIu64 " of %zu certain\n", bench.scene.name, certain - before,
                          bench.reference.count);
        }
    }
    assert_true(certain > rays / 3);
}

/* Flat between two turns. */
static RtTransform turned(float flat) {
    RtTransform at = rt_transform_identity();
    assert_ok(rt_transform_rotate(&at, rt_vec3(1, 2, 3), 40, error));
    assert_ok(rt_transform_scale(&at, rt_vec3(1, flat, 1), error));
    assert_ok(rt_transform_rotate(&at, rt_vec3(3, -1, 2), 70, error));
    return at;
}

RT_TEST(nested_and_nearly_singular_instances_have_nothing_wrong) {
    const RtTransform matrices[] = {scaled(1e-6, 1, 1), scaled(1, 1, 1e6), sheared(998.9), moved(4e7, 0, 0),
                                    turned(3e-3f),      turned(1e-4f),     turned(4e-6f)};
    uint64_t certain = 0;
    for (uint32_t levels = 2; levels <= 8; levels += 2) {
        OWNED_BENCH bench = {.scene = nested(levels)};
        set_up_rays(&bench, levels, RT_SHARE(20, 4));
        assert_none_is_wrong(&bench, &certain);
        print_message("%u levels: %" PRIu64 " certain\n", levels, certain);
    }
    for (size_t i = 0; i < sizeof matrices / sizeof matrices[0]; i++) {
        OWNED_BENCH bench = {.scene = one_ball(matrices[i])};
        set_up_rays(&bench, i, RT_SHARE(100, 10));
        assert_none_is_wrong(&bench, &certain);
    }
    assert_true(certain > 100);
}

/* ---- what is wrong ---- */

RT_TEST(a_structure_that_never_hits_is_wrong_about_what_instances_contain) {
    static const char *const kinds[] = {"instanced", "instanced-far"};
    for (uint64_t i = 0; i < 2; i++) {
        OWNED_BENCH bench;
        set_up_family(&bench, scene_family(kinds[i]), 3, 120);
        const size_t count = bench.reference.count;
        OWNED_MEMORY RtHit *hits = rt_alloc(count, sizeof(RtHit));
        RtEquivalence result;
        RtCertain certain;
        for (size_t k = 0; k < count; k++) hits[k] = RT_MISS;
        assert_ok(rt_equivalence_judge(&bench.reference, hits, 1, &result, error));
        assert_ok(rt_reference_certain(&bench.reference, false, 1, &certain, error));
        print_message("%s: %" PRIu64 " wrong; %" PRIu64 " certain and %" PRIu64 " must hit, of %zu\n",
                      kinds[i], result.verdicts[RT_WRONG], certain.certain, certain.must_hit, count);
        assert_true(result.verdicts[RT_WRONG] > count / 10);
        assert_int_equal(result.verdicts[RT_WRONG], certain.must_hit);
        assert_int_equal(result.faults[RT_FAULT_LOST], result.verdicts[RT_WRONG]);
        assert_true(rt_certain_suffices(&certain, count, false));
    }
}

RT_TEST(a_ray_that_leaves_the_numbers_of_a_part_may_hit_and_may_miss) {
    OWNED_SCENE scene = one_ball(scaled(1e-6, 1e-6, 1e-6));
    const RtRay ray = ray_along(rt_vec3(0, 0, 6e11f), down);
    const RtExactAnswer exact = rt_referee_nearest(&scene.geometry, &ray);
    assert_int_equal(exact.object, 0);
    assert_false(is_wrong(&scene.geometry, &ray, RT_MISS)); /* brute's */
    assert_false(is_wrong(&scene.geometry, &ray, (RtHit){(float)exact.t, 0}));
}

/* A ray passes beside a ball, by less than it is moved by rounding far from the zero of the part, and is in
 * the box of the instance only much later, because of another ball there. */
RT_TEST(a_hit_that_is_clamped_to_far_behind_its_object_is_not_wrong) {
    const float far = 131072;
    OWNED_SCENE scene = begin_scene();
    RtScene part = begin_scene();
    add_ball(&part, far, 0, 0, 1), add_ball(&part, far, 100, 5, 1);
    add_part(&scene, &part);
    place(&scene, &scene, 0, moved(-(double)far, 0, 0));
    assert_ok(rt_scene_finish(&scene, error));
    RtRay ray = ray_along(rt_vec3(1.0064f, -3, 0), rt_vec3(-0.00015f, 1, 0));
    OWNED_ACCEL RtAccel *bvh = open_accel(&scene, "bvh");
    OWNED_QUERY query = open_query(bvh);
    RtHit hit;
    rt_nearest(&query, &ray, 1, &hit, NULL);
    assert_int_equal(hit.object, 0);
    assert_true(hit.t > 20);
    assert_int_equal(rt_referee_nearest(&scene.geometry, &ray).result, RT_MISSED);
    assert_false(is_wrong(&scene.geometry, &ray, hit));
}

RT_TEST(the_objects_near_a_wrong_ray_are_copied_from_instances) {
    OWNED_SCENE scene = begin_balls();
    const char *path = RT_BINARY_DIR "/test_near_instances.yaml";
    for (int i = 0; i < 9; i++) place(&scene, &scene, 0, moved(i < 2 ? 0 : 9, 0, 3 * i));
    assert_ok(rt_scene_finish(&scene, error));
    const RtWrongAnswer wrong = {.ray = ray_along(rt_vec3(0, 0, 9), down), .expected = {5, 1}, .got = {3, 4}};
    uint32_t count;
    assert_ok(rt_near_save(&scene, &wrong, path, &count, error));
    assert_int_equal(count, 3);
    OWNED_SCENE near = open_scene(path);
    assert_int_equal(near.geometry.sphere_count, 3);
    assert_true(near.geometry.spheres[1].center.z == 3 && near.geometry.spheres[2].center.z == 12);
    unlink(path);
    OWNED_SCENE other = one_ball(scaled(1, 1, 2)); /* no copy of a ball */
    assert_ok(rt_near_save(&other, &wrong, path, &count, error));
    assert_int_equal(count, 0);
    assert_int_not_equal(access(path, F_OK), 0);
}

RT_TEST(answers_across_a_border_in_an_instance_at_four_times_delta_are_wrong) {
    RtRandom random = rt_random(23, 0);
    for (int i = 0; i < 400; i++) {
        RtTransform at = rt_transform_identity();
        const RtVec3 org = rt_scale(rt_random_point(&random, 9), 1);
        assert_ok(rt_transform_scale(&at, rt_vec3(1, 0.5f, 0.75f), error));
        assert_ok(rt_transform_rotate(&at, rt_random_point(&random, 1), 50, error));
        assert_ok(rt_transform_translate(&at, rt_random_point(&random, 2), error));
        OWNED_SCENE scene = one_ball(at);
        const RtGeometry *g = &scene.geometry;
        const RtVec3d center = rt_transform_column(&at, 3), to = rt_subd(center, rt_widen(org));
        const RtRay ray = ray_along(org, rt_narrow(to));
        const RtMarginRay prepared = rt_margin_ray(g, &ray, false);
        const double by = 4 * rt_margin_delta(&prepared, g, 0) / prepared.line.length;
        if (rt_lengthd(to) < 3) continue;
        assert_true(by < 1e-2);
        const RtExactAnswer exact = rt_referee_nearest(g, &ray);
        const float t = (float)exact.t, off = (float)by;
        assert_int_equal(exact.object, 0);
        assert_true(must_be(g, &ray));
        assert_false(is_wrong(g, &ray, (RtHit){t, 0}));
        assert_true(is_wrong(g, &ray, (RtHit){t + off, 0}) && is_wrong(g, &ray, (RtHit){t - off, 0}));
        assert_true(is_wrong(g, &ray, RT_MISS));
    }
}

RT_TESTS(instances_judged, NULL, NULL)
