/* SPDX-License-Identifier: Apache-2.0 */
/* The vector code of core/base/ray.h returns the same bits as a scalar version, for zero, denormal and
 * huge numbers, too. */
#include "testing.h"

#include "ray_testing.h"

enum { TRIES = 200000 };

RT_TEST(a_ray_is_prepared_as_number_by_number) {
    RtRandom random = rt_random(1, 7);
    for (int i = 0; i < TRIES; i++) {
        float size = hostile_size(&random);
        RtRay ray = hostile_ray(&random, size);
        RtBox box = i % 64 ? hostile_box(&random, size) : RT_EMPTY_BOX;
        RtPreparedRay p = rt_ray_prepare(&ray, &box);
        assert_memory_equal(&p.org, &ray.org, sizeof p.org);
        assert_memory_equal(&p.dir, &ray.dir, sizeof p.dir);
        for (int a = 0; a < 3; a++) {
            float org = ray.org.at[a], shift = shift_by_hand(&ray, &box, a);
            bool backward = signbit(ray.dir.at[a]);
            assert_true(same_bits(p.inv[a], 1 / ray.dir.at[a]));
            assert_true(same_bits(p.org_near[a], backward ? org - shift : org + shift));
            assert_true(same_bits(p.org_far[a], backward ? org + shift : org - shift));
            assert_int_equal(p.negative[a], backward);
            assert_true(fabsf(ray.dir.at[a]) <= fabsf(ray.dir.at[p.kz]));
        }
        assert_int_equal(p.kx, (p.kz + 1) % 3);
        assert_int_equal(p.ky, (p.kz + 2) % 3);
        float inv = 1 / ray.dir.at[p.kz];
        assert_true(same_bits(p.shear_x, ray.dir.at[p.kx] * inv));
        assert_true(same_bits(p.shear_y, ray.dir.at[p.ky] * inv));
        assert_true(p.tmin == ray.tmin && p.tmax == (ray.tmax < FLT_MAX ? ray.tmax : FLT_MAX));
    }
}

RT_TEST(the_span_within_an_own_box_is_as_number_by_number) {
    RtRandom random = rt_random(2, 7);
    int met = 0;
    for (int i = 0; i < TRIES; i++) {
        float size = hostile_size(&random);
        RtRay ray = hostile_ray(&random, size);
        RtBox box = hostile_box(&random, size);
        RtPreparedRay p = rt_ray_prepare(&ray, &box);
        float near, far, near_by_hand, far_by_hand;
        rt_box_own_span(&box, &p, &near, &far);
        own_span_by_hand(&box, &ray, &near_by_hand, &far_by_hand);
        assert_true(same_bits(near, near_by_hand) && same_bits(far, far_by_hand));
        met += near <= far;
    }
    assert_in_range(met, TRIES / 20, TRIES / 20 * 19);
}

/* A box that holds all its objects' boxes is entered no later and left no sooner than any of them: what every
 * structure rests on. */
RT_TEST(a_ray_is_no_longer_in_an_own_box_than_in_one_around_it) {
    RtRandom random = rt_random(3, 7);
    for (int i = 0; i < TRIES; i++) {
        float size = hostile_size(&random);
        RtRay ray = hostile_ray(&random, size);
        RtBox own = hostile_box(&random, size), around = rt_box_union(own, hostile_box(&random, size));
        RtPreparedRay p = rt_ray_prepare(&ray, &around);
        float near = -INFINITY, far = INFINITY, own_near, own_far;
        rt_box_cut(&around, &p, &near, &far);
        rt_box_own_span(&own, &p, &own_near, &own_far);
        assert_true(near <= own_near && own_far <= far);
    }
}

/* Point 3 of accel/clipping.h proves 14 units; rounding the product back to t leaves a little more. The box
 * touches a point that is 14.75 units from the ray's along each axis: with 15/16 of the thickness this fails.
 */
RT_TEST(a_ray_is_in_every_box_with_a_point_within_14_units_of_its_own) {
    RtRandom random = rt_random(14, 0);
    for (int i = 0; i < 200000; i++) {
        RtRay ray = {.org = rt_random_point(&random, i % 4 ? 0x1p-20f : 0x1p10f), .tmax = INFINITY};
        ray.dir = rt_random_point(&random, 1);
        if (i % 3 == 0) ray.dir.at[i % 9 / 3] *= 0x1p-20f;
        float longest = fabsf(ray.dir.at[rt_major_axis(ray.dir)]);
        float t = rt_random_between(&random, 1, 2) / longest * (i % 8 ? 1 : rt_random_unit(&random));
        RtVec3d p = rt_ray_point(&ray, t);
        float half = t * longest + 0x1p-12f;
        RtBox scene = {rt_sub(ray.org, rt_vec3(half, half, half)),
                       rt_add(ray.org, rt_vec3(half, half, half))};
        RtBox box = scene;
        double unit = 0;
        for (int k = 0; k < 6; k++) {
            float side = k < 3 ? scene.lo.at[k] : scene.hi.at[k - 3];
            unit = fmax(unit, 0x1p-24 * fabs((double)side - (double)ray.org.at[k % 3]));
        }
        for (int a = 0; a < 3; a++) {
            bool above = rt_random_below(&random, 2);
            double s = p.at[a] + (above ? 14.75 : -14.75) * unit;
            s = fmin(fmax(s, (double)scene.lo.at[a]), (double)scene.hi.at[a]);
            if (above)
                box.lo.at[a] = rt_maxf(rt_float_below(s), scene.lo.at[a]);
            else
                box.hi.at[a] = rt_minf(rt_float_above(s), scene.hi.at[a]);
        }
        RtPreparedRay prepared = rt_ray_prepare(&ray, &scene);
        float enter = -INFINITY, leave = INFINITY;
        rt_box_cut(&box, &prepared, &enter, &leave);
        if (!(enter <= t && t <= leave))
            fail_msg("ray %d: t = %.9g is not in [%.9g, %.9g]", i, (double)t, (double)enter, (double)leave);
    }
}

RT_TESTS(ray, NULL, NULL)
