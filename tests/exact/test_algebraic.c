/* SPDX-License-Identifier: Apache-2.0 */
/* Roots of polynomials as exact numbers: their positions, multiple roots, which appear once, and the
 * comparison of equal and nearly equal roots. */
#include "testing.h"

#include "core/base/random.h"
#include "exact/algebraic.h"

/* ---- polynomials by their roots ---- */

static RtPolynomial constant(RtRational a) {
    return (RtPolynomial){0, {a}};
}

/* p times (t - root) */
static RtPolynomial times_root(RtExactArena *s, const RtPolynomial *p, RtRational root) {
    RtPolynomial out = {.degree = p->degree + 1};
    RtRational zero = rt_exact_of(s, 0);
    for (int i = 0; i <= out.degree; i++) {
        RtRational up = i > 0 ? p->at[i - 1] : zero, here = i <= p->degree ? p->at[i] : zero;
        out.at[i] = rt_exact_sub(s, up, rt_exact_mul(s, here, root));
    }
    return out;
}

static RtPolynomial with_roots(RtExactArena *s, double lead, const RtRational *roots, int count) {
    RtPolynomial p = constant(rt_exact_of(s, lead));
    for (int i = 0; i < count; i++) p = times_root(s, &p, roots[i]);
    return p;
}

/* (t^2 - a) (t^2 - b) */
static RtPolynomial with_squares(RtExactArena *s, double a, double b) {
    RtPolynomial p = {4, {rt_exact_of(s, a * b), rt_exact_of(s, 0), rt_exact_of(s, -a - b)}};
    p.at[3] = rt_exact_of(s, 0);
    p.at[4] = rt_exact_of(s, 1);
    return p;
}

static bool is_at(RtExactArena *s, const RtAlgebraic *root, RtRational t) {
    RtRoot a = rt_root_of_algebraic(root), b = rt_root_of(s, t);
    int order = rt_root_compare(s, &a, &b);
    assert_int_equal(rt_root_compare(s, &b, &a), -order);
    return order == 0;
}

/* ---- where they are ---- */

/* Up to four rational roots, some of them alike, of any size and nearness; the lead of either sign. */
RT_TEST(roots_are_found_at_known_places_and_multiple_ones_once) {
    RtRandom random = rt_random(31, 0);
    OWNED(rt_exact_arena_clear) RtExactArena s = {0};
    int doubles = 0;
    for (int round = 0; round < 2000; round++) {
        double known[4];
        RtRational exact[4], third = rt_exact_div(&s, rt_exact_of(&s, 1), rt_exact_of(&s, 3));
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
        for (int i = 0; i < degree; i++) exact[i] = rt_exact_mul(&s, rt_exact_of(&s, known[i]), third);
        RtPolynomial p = with_roots(&s, round % 2 ? 7 : -0.3, exact, degree);
        RtAlgebraic roots[RT_MAX_DEGREE];
        int count = rt_polynomial_roots(&s, &p, roots);
        for (int i = 0, next; i < degree; i = next, found++) {
            for (next = i; next < degree && known[next] == known[i];) next++;
            if (found >= count || !is_at(&s, &roots[found], exact[i]))
                fail_msg("round %d, root %d", round, i);
            int lo = rt_polynomial_sign(&s, &p, roots[found].lo),
                hi = rt_polynomial_sign(&s, &p, roots[found].hi);
            assert_true(lo != 0 && hi != 0 && (lo != hi) == ((next - i) % 2 == 1));
            doubles += next - i > 1;
        }
        assert_int_equal(found, count);
        rt_exact_arena_rewind(&s, 0);
    }
    assert_true(doubles > 300);
}

RT_TEST(a_polynomial_without_real_roots_has_none) {
    OWNED(rt_exact_arena_clear) RtExactArena s = {0};
    RtAlgebraic roots[RT_MAX_DEGREE];
    RtPolynomial p = with_squares(&s, -1, -2), square = with_squares(&s, -2, -2), one = constant(p.at[4]);
    assert_int_equal(rt_polynomial_roots(&s, &p, roots), 0);
    assert_int_equal(rt_polynomial_roots(&s, &square, roots), 0);
    assert_int_equal(rt_polynomial_roots(&s, &one, roots), 0);
}

/* t^4 - 10 t^2 + 1 is that of sqrt(2) + sqrt(3), and has no factors. */
RT_TEST(values_have_all_digits_of_a_long_double) {
    OWNED(rt_exact_arena_clear) RtExactArena s = {0};
    RtAlgebraic roots[RT_MAX_DEGREE];
    RtRational zero = rt_exact_of(&s, 0);
    RtPolynomial p = {4, {rt_exact_of(&s, 1), zero, rt_exact_of(&s, -10), zero, rt_exact_of(&s, 1)}};
    assert_int_equal(rt_polynomial_roots(&s, &p, roots), 4);
    long double sum = sqrtl(2) + sqrtl(3), difference = sqrtl(3) - sqrtl(2);
    const long double expected[4] = {-sum, -difference, difference, sum};
    for (int i = 0; i < 4; i++)
        assert_true(fabsl(rt_algebraic_value(&s, &roots[i], zero) - expected[i]) <= 0x1p-61L);
    p.at[2] = rt_exact_of(&s, -0x1p40); /* the third root is 2^-20 and about 2^-101 */
    assert_int_equal(rt_polynomial_roots(&s, &p, roots), 4);
    long double off = rt_algebraic_value(&s, &roots[2], rt_exact_of(&s, 0x1p-20));
    assert_true(fabsl(off - 0x1p-101L) <= 0x1p-160L);
}

/* ---- equal and nearly so ---- */

/* sqrt(2) as a root of polynomials of degree 4 that share it, with and without the other factor, and as a
 * surd. */
RT_TEST(equal_roots_of_different_polynomials_are_a_tie) {
    OWNED(rt_exact_arena_clear) RtExactArena s = {0};
    RtAlgebraic a[RT_MAX_DEGREE], b[RT_MAX_DEGREE];
    RtPolynomial p = with_squares(&s, 2, 3), q = with_squares(&s, 1.5, 2);
    assert_int_equal(rt_polynomial_roots(&s, &p, a), 4);
    assert_int_equal(rt_polynomial_roots(&s, &q, b), 4);
    /* -sqrt(3) -sqrt(2) sqrt(2) sqrt(3) and -sqrt(2) -sqrt(1.5) sqrt(1.5) sqrt(2) */
    static const int orders[4][4] = {{-1, -1, -1, -1}, {0, -1, -1, -1}, {1, 1, 1, 0}, {1, 1, 1, 1}};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 4; k++) {
            assert_int_equal(rt_algebraic_compare(&s, &a[i], &b[k]), orders[i][k]);
            assert_int_equal(rt_algebraic_compare(&s, &b[k], &a[i]), -orders[i][k]);
        }
    }
    for (int sign = -1; sign <= 1; sign += 2) {
        RtSurd surd = {rt_exact_of(&s, 0), rt_exact_of(&s, sign), rt_exact_of(&s, 2)};
        RtRoot place = rt_root_of_surd(&surd), root = rt_root_of_algebraic(&a[sign < 0 ? 1 : 2]);
        assert_int_equal(rt_root_compare(&s, &place, &root), 0);
        assert_int_equal(rt_root_compare(&s, &root, &place), 0);
    }
}

/* t^2 (t^2 - 2) - 2^-n is 0 next to sqrt(2): 2^-n / (4 sqrt(2)) above it, however large n is. */
RT_TEST(roots_2_to_the_minus_200_apart_are_told_apart) {
    OWNED(rt_exact_arena_clear) RtExactArena s = {0};
    for (int n = 50; n <= 400; n += 50) {
        RtAlgebraic a[RT_MAX_DEGREE], b[RT_MAX_DEGREE];
        RtPolynomial p = with_squares(&s, 0, 2), q = p;
        q.at[0] = rt_exact_of(&s, -ldexp(1, -n));
        assert_int_equal(rt_polynomial_roots(&s, &p, a), 3);
        assert_int_equal(rt_polynomial_roots(&s, &q, b), 2);
        RtSurd surd = {rt_exact_of(&s, 0), rt_exact_of(&s, 1), rt_exact_of(&s, 2)};
        RtRoot root = rt_root_of_surd(&surd), above = rt_root_of_algebraic(&b[1]);
        assert_int_equal(rt_algebraic_compare(&s, &a[2], &b[1]), -1);
        assert_int_equal(rt_algebraic_compare(&s, &b[1], &a[2]), 1);
        assert_int_equal(rt_algebraic_compare(&s, &a[0], &b[0]), 1);
        assert_int_equal(rt_root_compare(&s, &root, &above), -1);
        assert_int_equal(rt_root_compare(&s, &above, &root), 1);
    }
}

/* Two roots of one polynomial, 2^-n apart, and a third far away. */
RT_TEST(near_roots_of_one_polynomial_are_parted) {
    OWNED(rt_exact_arena_clear) RtExactArena s = {0};
    for (int n = 10; n <= 500; n += 70) {
        RtRational third = rt_exact_div(&s, rt_exact_of(&s, 1), rt_exact_of(&s, 3));
        RtRational known[3] = {third, rt_exact_add(&s, third, rt_exact_of(&s, ldexp(1, -n))),
                               rt_exact_of(&s, 0x1p60)};
        RtPolynomial p = with_roots(&s, 1, known, 3);
        RtAlgebraic roots[RT_MAX_DEGREE];
        assert_int_equal(rt_polynomial_roots(&s, &p, roots), 3);
        for (int i = 0; i < 3; i++) {
            assert_true(is_at(&s, &roots[i], known[i]));
            assert_true(rt_algebraic_value(&s, &roots[i], known[i]) == 0);
        }
        assert_int_equal(rt_algebraic_compare(&s, &roots[0], &roots[1]), -1);
        long double apart = rt_algebraic_value(&s, &roots[1], third), expected = ldexpl(1, -n);
        assert_true(fabsl(apart - expected) <= 0x1p-60L * expected);
    }
}

RT_TESTS(algebraic, NULL, NULL)
