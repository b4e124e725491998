/* SPDX-License-Identifier: Apache-2.0 */
/* Hit functions against the referee: ours differ from exact arithmetic only if a ray passes an edge within
 * the rounding of float32; broken ones do so elsewhere. docs/precision.md has the counts for all shapes. */
#include "random_testing.h"
#include "testing.h"

#include "exact/border.h"
#include "verify/verdict.h"

/* Ray `i` at a triangle with corners in the unit cube: at a random point beside it or, every second time, at
 * one of its edges. */
static RtRay ray_at_triangle(RtRandom *random, const RtVec3 v[3], int i) {
    float b = rt_random_unit(random), c = i % 2 ? 0 : rt_random_unit(random);
    RtVec3 target = rt_add(v[0], rt_add(rt_scale(rt_sub(v[1], v[0]), b), rt_scale(rt_sub(v[2], v[0]), c)));
    RtRay ray = {.org = rt_scale(rt_random_point(random, 1), 4), .tmax = INFINITY};
    ray.dir = rt_sub(target, ray.org);
    return ray;
}

typedef Decision HitFunction(const RtGeometry *g, const RtRay *ray);

static Decision ours(const RtGeometry *g, const RtRay *ray) {
    return decision_of(g, 0, ray, NULL);
}

/* The well-known mistake: what counts as parallel does not depend on how large the triangle is. */
static Decision with_an_absolute_epsilon(const RtGeometry *g, const RtRay *ray) {
    const RtVec3 *v = g->triangles[0].v;
    RtVec3d side = rt_subd(rt_widen(v[1]), rt_widen(v[0])), other = rt_subd(rt_widen(v[2]), rt_widen(v[0]));
    double determinant = rt_dotd(side, rt_crossd(rt_widen(ray->dir), other));
    return fabs(determinant) < 1e-6 ? (Decision){.t = INFINITY} : ours(g, ray);
}

/* Decides by a place that is a little beside the ray. */
static Decision decided_beside(const RtGeometry *g, const RtRay *ray) {
    RtRay moved = *ray;
    for (int a = 0; a < 3; a++) moved.org.at[a] += a == 0 ? 0x1p-8f : -0x1p-8f;
    return ours(g, &moved);
}

/* How many of `rays` random rays a hit function decides wrongly, and how many of those farther than two units
 * from the edges of the triangle, of corners in [-size, size). */
typedef struct Wrongs {
    int wrong, far;
} Wrongs;

static Wrongs wrongs_of(HitFunction *decide, float size, int rays) {
    Wrongs wrongs = {0, 0};
    RtRandom random = rt_random(3, 0);
    for (int i = 0; i < rays; i++) {
        RtVec3 v[3];
        for (int k = 0; k < 3; k++) v[k] = rt_scale(rt_random_point(&random, 1), size);
        OWNED_OBJECT(g, triangle, v, NULL);
        RtRay ray = ray_at_triangle(&random, v, i);
        Decision decision = decide(&g, &ray);
        RtWideRay line = rt_wide_ray(&ray);
        if (check_decision(&g, 0, &line, decision) != RT_HIT) {
            wrongs.wrong++;
            wrongs.far += border_distance(&g, 0, &ray, decision) > 2;
        }
    }
    return wrongs;
}

RT_TEST(our_hit_function_errs_at_edges_alone) {
    Wrongs near = wrongs_of(ours, 1, 4000), small = wrongs_of(ours, 0x1p-12f, 4000);
    assert_true(near.wrong > 100 && near.wrong < 2000);
    assert_int_equal(near.far + small.far, 0);
}

RT_TEST(broken_hit_functions_are_caught_far_from_edges) {
    assert_int_equal(wrongs_of(with_an_absolute_epsilon, 1, 1000).far, 0);
    assert_true(wrongs_of(with_an_absolute_epsilon, 0x1p-12f, 1000).far > 100);
    assert_true(wrongs_of(decided_beside, 1, 4000).far > 10);
}

/* Where our own answer is the wrong one, that of another is right and not merely excused. */
RT_TEST(the_referee_decides_against_us_too) {
    RtRandom random = rt_random(5, 0);
    int against = 0;
    for (int i = 1; i < 2000; i += 2) {
        RtVec3 v[3];
        for (int k = 0; k < 3; k++) v[k] = rt_random_point(&random, 1);
        OWNED_OBJECT(g, triangle, v, NULL);
        RtRay ray = ray_at_triangle(&random, v, i);
        RtHit expected = RT_MISS, right = RT_MISS;
        Decision decision = ours(&g, &ray);
        RtExactAnswer ruling = rt_referee_nearest(&g, &ray);
        if (decision.hit) expected = (RtHit){decision.t, 0};
        if (ruling.result == RT_HIT) right = (RtHit){(float)ruling.t, 0};
        if (decision.hit != (ruling.result == RT_HIT)) {
            against++;
            RtSide side;
            RtVerdict verdict;
            assert_ok(rt_verdict_side(rt_judge(&g, &ray, false), expected, right, &side, error));
            assert_int_equal(side, RT_SIDE_GOT);
            assert_ok(rt_verdict_nearest(rt_judge(&g, &ray, false), expected, right, &verdict, error));
            assert_int_equal(verdict, RT_MARGINAL);
            assert_ok(
                rt_verdict_occluded(rt_judge(&g, &ray, false), decision.hit, !decision.hit, &verdict, error));
            assert_int_equal(verdict, RT_MARGINAL);
        }
    }
    assert_true(against > 100);
}

RT_TESTS(border, NULL, NULL)
