/* SPDX-License-Identifier: Apache-2.0 */
/* Trees in exact arithmetic: tori, their tangents and ties; and every ray at the trees of the families is
 * decided as by our hit functions, except within rounding of a decision boundary. */
#include "csg_testing.h"
#include "equivalence_testing.h"
#include "solids_testing.h"

#include "exact/border.h"
#include "exact/referee.h"

/* ---- rings ---- */

/* Circles of radius 4 in planes across z, tubes of radius 1: both are exact. */
static RtCsgTerm ring_at(RtCsgBuilder *b, float x) {
    uint32_t solid;
    assert_ok(rt_solid_add_ring(&b->set, rt_vec3(x, 0, 0), rt_vec3(0, 0, 1), 4, 1, &solid, error));
    return term_of(b, solid);
}

/* 0: a ring; 1: the ring to its right that touches it from within; 2: the ring without the ball that fills
 * it at x = 4; 3: a ball in the ring; 4: the first ring without itself. */
static void make_rings(RtGeometry *g, RtCsgBuilder *b) {
    RtCsgTerm ring = ring_at(b, 0), other = ring_at(b, 8), filling = ball(b, rt_vec3(4, 0, 0), 1, 0);
    add_tree(g, b, ring);
    add_tree(g, b, other);
    add_tree(g, b, cut(b, ring, filling));
    add_tree(g, b, filling);
    add_tree(g, b, cut(b, ring, ring));
    assert_ok(rt_geometry_finish(g, error));
}

/* All places of `id` along the line, which are numbers of float32, to t[0..most). */
static int places(const RtGeometry *g, uint32_t id, RtRay ray, long double *t, int most) {
    int count = 0;
    RtWideRay line = rt_wide_ray(&ray);
    while (count < most && rt_referee_hit(g, id, &line, &t[count]) == RT_HIT) {
        /* the referee's error; on x86 rounding to 64 bits hides it */
        const float at = (float)t[count];
        assert_true(fabsl(t[count] - (long double)at) <= 0x1p-60L * fabsl(t[count]));
        t[count++] = (long double)at;
        line.tmin = (double)nextafterf(at, INFINITY);
    }
    return count;
}

static void assert_places(const RtGeometry *g, uint32_t id, RtRay ray, int count,
                          const long double *expected) {
    long double t[8];
    assert_int_equal(places(g, id, ray, t, 8), count);
    for (int i = 0; i < count; i++) assert_true(t[i] == expected[i]);
}

RT_TEST(a_ring_is_met_at_four_places_and_touched_at_none) {
    OWNED_GEOMETRY g = {0};
    OWNED_BUILDER b = {0};
    make_rings(&g, &b);
    RtVec3 x = rt_vec3(1, 0, 0), y = rt_vec3(0, 1, 0);
    assert_places(&g, 0, ray_along(rt_vec3(-9, 0, 0), x), 4, (long double[]){4, 6, 12, 14});
    assert_places(&g, 0, ray_along(rt_vec3(0, 0, 9), rt_vec3(0, 0, -1)), 0, NULL);
    /* along the circle on which it lies on a plane, through two of its points; from outside; at the outer
     * equator; and an ulp farther in */
    assert_places(&g, 0, ray_along(rt_vec3(-9, 0, 1), x), 0, NULL);
    assert_places(&g, 0, ray_along(rt_vec3(4, -9, 1), y), 0, NULL);
    assert_places(&g, 0, ray_along(rt_vec3(5, -9, 0), y), 0, NULL);
    RtWideRay near = {rt_vec3d(5 - 0x1p-50, -9, 0), rt_widen(y), 0, HUGE_VAL};
    long double t;
    assert_int_equal(rt_referee_hit(&g, 0, &near, &t), RT_HIT);
    assert_true(t < 9 && t > 8.9999L);
    /* 3-4-5: touches the hole from within the tube, where there is no wall; an ulp farther in are two */
    assert_places(&g, 0, ray_along(rt_vec3(3, -9, 0), y), 2, (long double[]){5, 13});
    near = (RtWideRay){rt_vec3d(3 - 0x1p-50, -9, 0), rt_widen(y), 6, HUGE_VAL};
    assert_int_equal(rt_referee_hit(&g, 0, &near, &t), RT_HIT);
    assert_true(t < 9 && t > 8.9999L);
}

/* At height 1/2 the tubes are met at 4 -+ sqrt(3/4), which is no number of theirs: those of two rings, by
 * different polynomials, and the ball's, a surd. */
RT_TEST(equal_places_of_rings_and_balls_are_a_tie) {
    OWNED_GEOMETRY g = {0};
    OWNED_BUILDER b = {0};
    make_rings(&g, &b);
    RtRay ray = ray_along(rt_vec3(0, 0, 0.5f), rt_vec3(1, 0, 0));
    for (uint32_t other = 1; other <= 3; other += 2) {
        int order = 99;
        long double apart;
        assert_int_equal(rt_referee_order(&g, 0, other, &ray, &order, &apart), RT_HIT);
        assert_true(order == 0 && apart == 0);
    }
    RtExactAnswer ruling = rt_referee_nearest(&g, &ray);
    assert_true(ruling.object == 0 && ruling.tied == 3);
    assert_true(fabsl(ruling.t - (4 - sqrtl(0.75L))) <= 0x1p-60L);
    RtWideRay line = rt_wide_ray(&ray);
    long double t;
    for (uint32_t empty = 2; empty <= 4; empty += 2)
        assert_int_equal(rt_referee_hit(&g, empty, &line, &t), RT_MISSED);
    ray.org.z = 0.25f;
    ray.org.y = 0x1p-40f; /* beside the plane through both centres: a little of the ring is left */
    line = rt_wide_ray(&ray);
    assert_int_equal(rt_referee_hit(&g, 2, &line, &t), RT_HIT);
    long double off, ulps, full;
    assert_int_equal(rt_referee_hit(&g, 0, &line, &full), RT_HIT);
    assert_int_equal(rt_referee_error(&g, 0, &ray, (float)full, &off, &ulps), RT_HIT);
    assert_true(fabsl(ulps) <= 0.5L && ulps != 0);
}

/* ---- by membership of points ---- */

/* Tori placed and stretched at random: before its first place the line is outside, behind it inside, by a
 * function of points that knows no polynomial. */
RT_TEST(a_line_is_outside_of_a_torus_up_to_the_first_place_and_inside_behind_it) {
    RtRandom random = rt_random(41, 0);
    int hits = 0;
    for (int i = 0; i < 400; i++) {
        RtTransform place = rt_transform_identity();
        RtVec3 size = rt_random_point(&random, 1);
        for (int a = 0; a < 3; a++) size.at[a] = 0.5f + fabsf(size.at[a]);
        assert_ok(rt_transform_scale(&place, size, error));
        assert_ok(rt_transform_rotate(&place, rt_random_point(&random, 1), 77, error));
        assert_ok(rt_transform_translate(&place, rt_random_point(&random, 5), error));
        Model model = {.name = "torus", .inside = in_torus, .place = place};
        model.ratio = rt_random_betweend(&random, 0.01, 0.99);
        invert(&place, model.back);
        OWNED_GEOMETRY g = {0};
        OWNED_BUILDER b = {0};
        assert_ok(rt_solid_add_torus(&b.set, model.ratio, &place, &model.index, error));
        add_tree(&g, &b, term_of(&b, model.index));
        assert_ok(rt_geometry_finish(&g, error));
        RtVec3d target = random_target(&model, &random);
        RtRay ray = random_ray(&model, &random, target, 9);
        RtWideRay line = rt_wide_ray(&ray);
        long double t = HUGE_VALL, sooner = HUGE_VALL;
        bool hit = rt_referee_hit(&g, 0, &line, &t) == RT_HIT;
        hits += hit;
        for (int k = 0; k < 200; k++) {
            long double at = (hit ? t : 20 / (long double)rt_lengthd(line.dir)) * (1 - 0x1p-40L) * k / 199;
            sooner = fminl(sooner, value_at(&model, &ray, at));
        }
        if (sooner < -0x1p-36L) fail_msg("torus %d: %Lg inside before %Lg", i, -sooner, t);
        if (hit && fabsl(value_at(&model, &ray, t)) > 0x1p-50L) fail_msg("torus %d: not met at %Lg", i, t);
    }
    assert_true(hits > 100);
}

/* ---- all trees ---- */

static bool is_of_trees(size_t family) {
    return strncmp(rt_family_name(family), "csg", 3) == 0;
}

/* Whether dir is so long that t, wherever the ray is at the scene, lies below the least normal number of
 * float32: then it has few digits or none. */
static bool has_few_digits(const RtGeometry *g, const RtWideRay *line) {
    double far = 0;
    for (int a = 0; a < 3; a++) {
        far = fmax(far, fabs((double)g->box.lo.at[a] - line->org.at[a]));
        far = fmax(far, fabs((double)g->box.hi.at[a] - line->org.at[a]));
    }
    return far < FLT_MIN * rt_lengthd(line->dir);
}

/* Asks about the object that is exactly the nearest, and about all that our hit function finds. Where
 * [tmin, tmax] is one number the exact t, which has more digits, is not in it; nor may it be where float32
 * has few. */
static void judge(const RtGeometry *g, const RtRay *ray, int *hits) {
    RtExactAnswer ruling = rt_referee_nearest(g, ray);
    assert_int_not_equal(ruling.result, RT_UNDECIDED);
    *hits += ruling.result == RT_HIT;
    RtWideRay line = rt_wide_ray(ray);
    if (ray->tmin == ray->tmax || has_few_digits(g, &line)) return;
    for (uint32_t id = 0; id < g->object_count; id++) {
        RtDecision ours = rt_decision_of(g, id, ray, crossings_of_tests());
        if (!ours.hit && id != ruling.object) continue;
        if (rt_decision_check(g, id, &line, ours) == RT_HIT) continue;
        double border = rt_border_distance(g, id, ray, ours);
        if (border > 2) fail_msg("object %u, %g units from a border", id, border);
    }
}

RT_TEST(no_ray_at_the_families_of_trees_is_undecided_and_differences_are_at_borders) {
    enum { EACH = 16 };
    int hits = 0, rays = 0;
    for (size_t family = 0; family < rt_family_count(); family++) {
        for (uint64_t seed = 1; seed <= 3 && is_of_trees(family); seed++) {
            OWNED_SCENE scene = open_family(family, seed);
            OWNED_ACCEL RtAccel *brute = open_accel(&scene, "brute");
            OWNED_QUERY query = open_query(brute);
            for (size_t aim = 0; aim < rt_ray_family_count(); aim++, rays += EACH) {
                RtRay some[EACH];
                rt_ray_family_fill(aim, &query, seed, 0, EACH, some);
                for (int i = 0; i < EACH; i++) judge(&scene.geometry, &some[i], &hits);
            }
        }
    }
    assert_true(hits > rays / 6); /* rays of past-hits are meant to miss */
}

RT_TEST(a_tree_is_undecided_where_memory_is_short_and_only_there) {
    RtGeometry g[2] = {{0}, {0}};
    OWNED_BUILDER b = {0};
    RtTriangle triangles[12];
    RtTransform still = rt_transform_identity();
    uint32_t mesh;
    make_rings(&g[0], &b);
    assert_ok(rt_solid_add_mesh(&b.set, triangles, cube_mesh(triangles), &still, &mesh, error));
    add_tree(&g[1], &b, term_of(&b, mesh));
    assert_ok(rt_geometry_finish(&g[1], error));
    RtRay ray = ray_along(rt_vec3(0, 0, 0.5f), rt_vec3(1, 0, 0));
    int64_t before = rt_alloc_live();
    for (int i = 0; i < 2; i++) {
        RtExactResult finding = RT_UNDECIDED;
        int short_of = 0;
        for (uint64_t n = 1; finding == RT_UNDECIDED; n++, short_of++) {
            rt_alloc_fail_at(n);
            finding = rt_referee_nearest(&g[i], &ray).result;
            rt_alloc_fail_at(0);
            assert_int_equal(rt_alloc_live(), before);
        }
        assert_true(short_of > 1 && finding == RT_HIT);
    }
    for (int i = 0; i < 2; i++) rt_geometry_clear(&g[i]);
}

RT_TESTS(exact_trees, NULL, NULL)
