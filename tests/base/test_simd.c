/* SPDX-License-Identifier: Apache-2.0 */
/* core/base/simd.h and simd_across.h at the width of the program itself: vectors of four, and of eight in two
 * halves, return the bits of the scalar operators, for NaN, infinite, denormal and negative zero, too. The
 * kernels of the other instruction sets are tested by the accelerators that have them. */
#include "testing.h"

#include "core/base/simd_across.h"

#include <float.h>

enum { VALUES = 12 };
static const float values[VALUES] = {0,   -0.0f, INFINITY, -INFINITY, NAN,     FLT_MIN / 4,
                                     2.5, -0.5f, 1,        -3,        FLT_MAX, -FLT_MIN / 8};

/* Eight of them, from number i on, and others for each `step`. */
static RtFloat8 eight(int i, int step) {
    RtFloat8 out;
    for (int k = 0; k < 8; k++) out[k] = values[(i + k * step) % VALUES];
    return out;
}

static bool same_float(float a, float b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

static bool same_double(double a, double b) {
    return memcmp(&a, &b, sizeof a) == 0;
}

RT_TEST(a_minimum_or_maximum_is_the_second_number_where_one_is_no_number) {
    for (int i = 0; i < VALUES * VALUES; i++) {
        const RtFloat8 a = eight(i % VALUES, 1), b = eight(i / VALUES, 5);
        const RtFloat8 min = rt_min(a, b), max = rt_max(a, b);
        const RtFloat4 min4 = rt_min(rt_upper4(a), rt_upper4(b)), max4 = rt_max(rt_upper4(a), rt_upper4(b));
        for (int k = 0; k < 8; k++) {
            assert_true(same_float(min[k], a[k] < b[k] ? a[k] : b[k]));
            assert_true(same_float(max[k], a[k] > b[k] ? a[k] : b[k]));
        }
        for (int k = 0; k < 4; k++) {
            assert_true(same_float(min4[k], min[4 + k]));
            assert_true(same_float(max4[k], max[4 + k]));
        }
        const RtInt8 least = rt_min((RtInt8)a, (RtInt8)b), most = rt_max((RtInt8)a, (RtInt8)b);
        for (int k = 0; k < 8; k++) {
            const int32_t x = ((RtInt8)a)[k], y = ((RtInt8)b)[k];
            assert_int_equal(least[k], x < y ? x : y);
            assert_int_equal(most[k], x > y ? x : y);
        }
    }
}

RT_TEST(a_comparison_sets_the_bits_of_the_lanes_where_it_holds) {
    for (int i = 0; i < VALUES * VALUES; i++) {
        const RtFloat8 a = eight(i % VALUES, 1), b = eight(i / VALUES, 5);
        const RtInt8 m = (RtInt8)a, n = (RtInt8)b;
        uint32_t le = 0, lt = 0, less = 0, one_sign = 0, negative = 0;
        for (int k = 0; k < 8; k++) {
            le |= (uint32_t)(a[k] <= b[k]) << k;
            lt |= (uint32_t)(a[k] < b[k]) << k;
            less |= (uint32_t)(m[k] < n[k]) << k;
            one_sign |= (uint32_t)(a[k] >= 0 || b[k] <= 0) << k;
            negative |= (uint32_t)(m[k] < 0) << k;
        }
        assert_int_equal(rt_le_bits(a, b), le);
        assert_int_equal(rt_le_bits(rt_lower4(a), rt_lower4(b)), le & 15);
        assert_int_equal(rt_mask8_bits(rt_le_mask8(a, b)), le);
        assert_int_equal(rt_lt_bits(a, b), lt);
        assert_int_equal(rt_lt_bits(m, n), less);
        assert_int_equal(rt_one_sign_bits(a, b), one_sign);
        assert_int_equal(rt_bits(m), negative);
        assert_int_equal(rt_bits((RtInt4)rt_upper4(a)), negative >> 4);
    }
}

RT_TEST(the_lanes_of_bits_are_selected_and_brought_to_the_front) {
    const RtInt8 a = {10, 11, 12, 13, 14, 15, 16, 17}, b = -a;
    for (uint32_t bits = 0; bits < 256; bits++) {
        const RtInt8 selected = rt_select_bits8(bits, a, b), front = rt_compress8(rt_order8(bits), a);
        uint32_t stored[RT_LANES];
        rt_compress_store(stored, bits & ((1u << RT_LANES) - 1), rt_lane_numbers());
        for (int k = 0, count = 0; k < 8; k++) {
            const bool set = bits >> k & 1;
            assert_int_equal(selected[k], set ? a[k] : b[k]);
            if (set && k < RT_LANES) assert_int_equal(stored[count], k);
            if (set) assert_int_equal(front[count++], a[k]);
        }
    }
}

RT_TEST(a_set_holds_the_members_that_were_added_to_it) {
    const uint64_t members[] = {1, UINT64_C(1) << 63, UINT64_C(1) << 40, UINT64_C(0x8000000080000000)};
    uint64_t right[8] = {0}, got[8];
    RtSets8 sets = {0};
    assert_int_equal(rt_sets8_bits(&sets), 0);
    for (uint32_t i = 0; i < 4; i++) {
        rt_sets8_add(&sets, rt_one_mask8(2 * i), members[i]);
        rt_sets8_add(&sets, rt_one_mask8(i), members[3 - i]);
        right[2 * i] |= members[i];
        right[i] |= members[3 - i];
        uint32_t some = 0;
        for (int k = 0; k < 8; k++) some |= (uint32_t)(right[k] != 0) << k;
        assert_int_equal(rt_sets8_bits(&sets), some);
    }
    rt_sets8_compress(got, 255, &sets);
    assert_memory_equal(got, right, sizeof right);
}

RT_TEST(roundings_roots_and_doubles_are_those_of_scalar_functions) {
    for (int i = 0; i < VALUES; i++) {
        const RtFloat8 both = eight(i, 1);
        RtFloats a;
        for (int k = 0; k < RT_LANES; k++) a[k] = both[k % 8];
        const RtFloats floors = rt_floor(a), ceilings = rt_ceil(a);
        const RtDouble2 two = rt_widen_lower(rt_lower4(both));
        const RtDoubles halves[2] = {rt_to_doubles(a, 0) / 3, rt_to_doubles(a, 1) / 3};
        const RtFloats back = rt_round_doubles(halves[0], halves[1]);
        const RtDoubles roots = rt_sqrt(rt_abs(halves[0]));
        for (int k = 0; k < RT_LANES; k++) {
            if (isnan(a[k])) continue;
            const double third = (double)a[k] / 3;
            assert_true(same_float(floors[k], floorf(a[k])));
            assert_true(same_float(ceilings[k], ceilf(a[k])));
            assert_true(same_double(halves[k / RT_HALF][k % RT_HALF], third));
            assert_true(same_float(back[k], (float)third));
            if (k < 2) assert_true(same_double(two[k], (double)a[k]));
            if (k < RT_HALF) assert_true(same_double(roots[k], sqrt(fabs(third))));
        }
    }
}

RT_TESTS(simd, NULL, NULL)
