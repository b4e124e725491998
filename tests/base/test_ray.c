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

RT_TESTS(ray, NULL, NULL)
