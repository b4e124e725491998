/* SPDX-License-Identifier: Apache-2.0 */
/* Exact numbers: roots of polynomials, their positions, multiple roots, which appear once, the comparison of
 * equal and nearly equal roots, and their values. */
#include "testing.h"

#include "core/base/random.h"
#include "exact/exact.h"

/* ---- polynomials by their roots ---- */

static RtPolynomial constant(RtRational a) {
    return (RtPolynomial){0, {a}};
}

/* p times (t - root) */
static RtPolynomial times_root(const RtPolynomial *p, RtRational root) {
    RtPolynomial out = {.degree = p->degree + 1};
    RtRational zero = rt_exact_of(0);
    for (int i = 0; i <= out.degree; i++) {
        RtRational up = i > 0 ? p->at[i - 1] : zero, here = i <= p->degree ? p->at[i] : zero;
        out.at[i] = rt_exact_sub(up, rt_exact_mul(here, root));
    }
    return out;
}

static RtPolynomial with_roots(double lead, const RtRational *roots, int count) {
    RtPolynomial p = constant(rt_exact_of(lead));
    for (int i = 0; i < count; i++) p = times_root(&p, roots[i]);
    return p;
}

/* (t^2 - a) (t^2 - b) */
static RtPolynomial with_squares(double a, double b) {
    RtPolynomial p = {4, {rt_exact_of(a * b), rt_exact_of(0), rt_exact_of(-a - b)}};
    p.at[3] = rt_exact_of(0);
    p.at[4] = rt_exact_of(1);
    return p;
}

static bool is_at(const RtRoot *root, RtRational t) {
    RtRoot at = rt_root_of(t);
    int order = rt_root_compare(root, &at);
    assert_int_equal(rt_root_compare(&at, root), -order);
    return order == 0;
}

/* ---- where they are ---- */

/* Up to four rational roots, some of them alike, of any size and nearness; the lead of either sign. */
RT_TEST(roots_are_found_at_known_places_and_multiple_ones_once) {
    RtRandom random = rt_random(31, 0);
    int doubles = 0;
    for (int round = 0; round < 2000; round++) {
        double known[4];
        RtRational exact[4], third = rt_exact_div(rt_exact_of(1), rt_exact_of(3));
        int degree = (int)(rt_random_below(&random, 5)), found = 0;
        for (int i = 0; i < degree; i++) {
            uint32_t how = rt_random_below(&random, 4);
            int exponent = (int)(rt_random_below(&random, 200)) - 100;
            double number = rt_random_betweend(&random, -9, 9);
            known[i] = how == 0 ? floor(number) : how == 1 ? ldexp(number, exponent) : number;
            if (how == 2 && i > 0) known[i] = known[i - 1];
            if (how == 3 && i > 0) known[i] = nextafter(known[i - 1], 99);
            int k = i;
            for (; k > 0 && known[k - 1] > known[k]; k--) {
                double swap = known[k];
                known[k] = known[k - 1];
                known[k - 1] = swap;
            }
        }
        for (int i = 0; i < degree; i++) exact[i] = rt_exact_mul(rt_exact_of(known[i]), third);
        RtPolynomial p = with_roots(round % 2 ? 7 : -0.3, exact, degree);
        RtRoot roots[RT_MAX_DEGREE];
        int count = rt_polynomial_roots(&p, roots);
        for (int i = 0, next; i < degree; i = next, found++) {
            for (next = i; next < degree && known[next] == known[i];) next++;
            if (found >= count || !is_at(&roots[found], exact[i])) fail_msg("round %d, root %d", round, i);
            assert_int_equal(roots[found].crossed, (next - i) % 2);
            doubles += next - i > 1;
        }
        assert_int_equal(found, count);
        rt_exact_rewind(0);
    }
    assert_true(doubles > 300);
}

RT_TEST(a_polynomial_without_real_roots_has_none) {
    RtRoot roots[RT_MAX_DEGREE];
    RtPolynomial p = with_squares(-1, -2), square = with_squares(-2, -2), one = constant(p.at[4]);
    assert_int_equal(rt_polynomial_roots(&p, roots), 0);
    assert_int_equal(rt_polynomial_roots(&square, roots), 0);
    assert_int_equal(rt_polynomial_roots(&one, roots), 0);
}

/* t^4 - 10 t^2 + 1 is that of sqrt(2) + sqrt(3), and has no factors. */
RT_TEST(values_have_all_digits_of_a_long_double) {
    RtRoot roots[RT_MAX_DEGREE];
    RtRational zero = rt_exact_of(0);
    RtPolynomial p = {4, {rt_exact_of(1), zero, rt_exact_of(-10), zero, rt_exact_of(1)}};
    assert_int_equal(rt_polynomial_roots(&p, roots), 4);
    long double sum = sqrtl(2) + sqrtl(3), difference = sqrtl(3) - sqrtl(2);
    const long double expected[4] = {-sum, -difference, difference, sum};
    for (int i = 0; i < 4; i++) assert_true(fabsl(rt_root_value(&roots[i], zero) - expected[i]) <= 0x1p-61L);
    p.at[2] = rt_exact_of(-0x1p40); /* the third root is 2^-20 and about 2^-101 */
    assert_int_equal(rt_polynomial_roots(&p, roots), 4);
    long double off = rt_root_value(&roots[2], rt_exact_of(0x1p-20));
    assert_true(fabsl(off - 0x1p-101L) <= 0x1p-160L);
}

/* ---- equal and nearly so ---- */

/* sqrt(2) as a root of polynomials of degree 4 that share it, and of degree 2. */
RT_TEST(equal_roots_of_different_polynomials_are_a_tie) {
    RtRoot a[RT_MAX_DEGREE], b[RT_MAX_DEGREE];
    RtPolynomial p = with_squares(2, 3), q = with_squares(1.5, 2);
    assert_int_equal(rt_polynomial_roots(&p, a), 4);
    assert_int_equal(rt_polynomial_roots(&q, b), 4);
    /* -sqrt(3) -sqrt(2) sqrt(2) sqrt(3) and -sqrt(2) -sqrt(1.5) sqrt(1.5) sqrt(2) */
    static const int orders[4][4] = {{-1, -1, -1, -1}, {0, -1, -1, -1}, {1, 1, 1, 0}, {1, 1, 1, 1}};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 4; k++) {
            assert_int_equal(rt_root_compare(&a[i], &b[k]), orders[i][k]);
            assert_int_equal(rt_root_compare(&b[k], &a[i]), -orders[i][k]);
        }
    }
    RtRoot square[RT_MAX_DEGREE];
    RtPolynomial of_degree_2 = {2, {rt_exact_of(-2), rt_exact_of(0), rt_exact_of(1)}};
    assert_int_equal(rt_polynomial_roots(&of_degree_2, square), 2);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(rt_root_compare(&square[i], &a[i + 1]), 0);
        assert_int_equal(rt_root_compare(&a[i + 1], &square[i]), 0);
    }
}

/* t^2 (t^2 - 2) - 2^-n is 0 next to sqrt(2): 2^-n / (4 sqrt(2)) above it, however large n is. */
RT_TEST(roots_2_to_the_minus_200_apart_are_told_apart) {
    for (int n = 50; n <= 400; n += 50) {
        RtRoot a[RT_MAX_DEGREE], b[RT_MAX_DEGREE];
        RtPolynomial p = with_squares(0, 2), q = p;
        q.at[0] = rt_exact_of(-ldexp(1, -n));
        assert_int_equal(rt_polynomial_roots(&p, a), 3);
        assert_int_equal(rt_polynomial_roots(&q, b), 2);
        assert_int_equal(rt_root_compare(&a[2], &b[1]), -1);
        assert_int_equal(rt_root_compare(&b[1], &a[2]), 1);
        assert_int_equal(rt_root_compare(&a[0], &b[0]), 1);
    }
}

/* Two roots of one polynomial, 2^-n apart, and a third far away. */
RT_TEST(near_roots_of_one_polynomial_are_parted) {
    for (int n = 10; n <= 500; n += 70) {
        RtRational third = rt_exact_div(rt_exact_of(1), rt_exact_of(3));
        RtRational known[3] = {third, rt_exact_add(third, rt_exact_of(ldexp(1, -n))), rt_exact_of(0x1p60)};
        RtPolynomial p = with_roots(1, known, 3);
        RtRoot roots[RT_MAX_DEGREE];
        assert_int_equal(rt_polynomial_roots(&p, roots), 3);
        for (int i = 0; i < 3; i++) {
            assert_true(is_at(&roots[i], known[i]));
            assert_true(rt_root_value(&roots[i], known[i]) == 0);
        }
        assert_int_equal(rt_root_compare(&roots[0], &roots[1]), -1);
        long double apart = rt_root_value(&roots[1], third), expected = ldexpl(1, -n);
        assert_true(fabsl(apart - expected) <= 0x1p-60L * expected);
    }
}

/* ---- roots of degree 2 ---- */

/* The root of (t - p)^2 - q^2 d that is p + q sqrt(d). */
static RtRoot surd(double p, double q, double d) {
    RtRoot roots[RT_MAX_DEGREE];
    RtPolynomial of = {2, {rt_exact_of(p * p - q * q * d), rt_exact_of(-2 * p), rt_exact_of(1)}};
    int count = rt_polynomial_roots(&of, roots);
    assert_int_equal(count, q * d == 0 ? 1 : 2);
    assert_int_equal(roots[0].crossed, count == 2);
    return roots[count == 2 && q > 0];
}

/* All p + q sqrt(d) of small numbers, by pairs: 240,100 of them, with many ties (sqrt(8) = 2 sqrt(2),
 * sqrt(9) = 3). Two that differ do so by more than the error of long double. */
RT_TEST(surds_are_ordered_like_their_values_and_ties_are_found) {
    enum { MOST = 7 * 7 * 10 };
    static RtRoot all[MOST];
    static long double values[MOST];
    RtRational zero = rt_exact_of(0);
    int count = 0, ties = 0;
    for (int p = -3; p <= 3; p++) {
        for (int q = -3; q <= 3; q++) {
            for (int d = 0; d < 10; d++, count++) {
                all[count] = surd(p, q, d);
                values[count] = (long double)p + (long double)q * sqrtl((long double)d);
                long double value = rt_root_value(&all[count], zero);
                assert_true(fabsl(value - values[count]) <= 0x1p-60L);
                assert_true((rt_root_compare_rational(&all[count], zero) == 0) == (value == 0));
            }
        }
    }
    for (int a = 0; a < count; a++) {
        for (int b = 0; b < count; b++) {
            long double apart = values[a] - values[b];
            int expected = apart > 1e-6L ? 1 : apart < -1e-6L ? -1 : 0;
            if (rt_root_compare(&all[a], &all[b]) != expected) fail_msg("%Lg and %Lg", values[a], values[b]);
            ties += a != b && expected == 0;
        }
    }
    assert_true(ties > 1000);
    rt_exact_rewind(0);
}

/* With x^2 - 2 y^2 = 1 (Pell) x - y sqrt(2) is 1 / (x + y sqrt(2)): nearly all digits cancel. */
RT_TEST(a_surd_that_cancels_keeps_all_its_digits) {
    RtRational zero = rt_exact_of(0);
    double x = 3, y = 2;
    while (x < 0x1p50) {
        RtRoot roots[RT_MAX_DEGREE];
        RtPolynomial of = {2, {rt_exact_of(1), rt_exact_of(-2 * x), rt_exact_of(1)}};
        assert_int_equal(rt_polynomial_roots(&of, roots), 2);
        long double expected = 1 / ((long double)x + (long double)y * sqrtl(2));
        assert_true(fabsl(rt_root_value(&roots[0], zero) - expected) <= 0x1p-60L * expected);
        assert_int_equal(rt_root_compare_rational(&roots[0], zero), 1);
        double next = 3 * x + 4 * y;
        y = 2 * x + 3 * y;
        x = next;
    }
}

RT_TEST(rationals_of_any_size_become_the_nearest_long_double) {
    RtRational third = rt_exact_div(rt_exact_of(1), rt_exact_of(-3));
    assert_true(fabsl(rt_exact_value(third) + 1 / 3.0L) <= 0x1p-64L);
    const double sizes[] = {0x1p-149, 0x1p-1074, 1, 0x1.fffffffffffffp1023};
    for (int i = 0; i < 4; i++) assert_true(rt_exact_value(rt_exact_of(sizes[i])) == sizes[i]);
    RtRational tiny = rt_exact_mul(rt_exact_of(0x1p-1000), rt_exact_of(0x1p-1000));
    assert_true(rt_exact_value(tiny) == 0x1p-2000L);
}

RT_TESTS(algebraic, NULL, NULL)
