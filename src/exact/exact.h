/* SPDX-License-Identifier: Apache-2.0 */
/* Exact numbers: rationals (GMP), vectors of them, the real roots of polynomials with rational coefficients,
 * and rays in such numbers. A float32 or double is a rational, so + - * / on such numbers are exact, and
 * order and sign are decided, never estimated.
 *
 * A root is represented by its polynomial, which has no multiple root, and an interval with rational ends
 * that contains this root alone; the interval can be narrowed as far as necessary. Real roots are isolated by
 * Sturm's theorem ("Memoire sur la resolution des equations numeriques", 1829): for the chain p, p', and
 * minus the remainder of each two before, the sign changes at x minus those at y are the number of roots
 * between x and y. Intervals are narrowed by signs at rational points alone, chosen by a secant (Abbott 2014,
 * "Quadratic Interval Refinement for Real Roots"). Two roots are equal if the greatest common divisor of
 * their polynomials has a root in both intervals; otherwise narrowing separates them. So nothing is
 * estimated, and a tie is a tie.
 *
 * Layout. Each thread has an arena, in which numbers are written one after another and never changed.
 * Rewinding it to a mark discards the later ones and reuses their memory. Memory is allocated by GMP (a
 * number of a ray takes a few hundred bytes), which ends the program with a message if it fails. */
#ifndef RT_EXACT_EXACT_H
#define RT_EXACT_EXACT_H

#include "core/base/box.h"
#include "core/base/ray.h"

#include <gmp.h>
#include <stddef.h>

/* A number in the arena. */
typedef mpq_srcptr RtRational;

/* The place in the calling thread's arena; rewinding to it discards all numbers written since. */
size_t rt_exact_mark(void);
void rt_exact_rewind(size_t mark);

/* ---- rationals ---- */

/* A finite `x`. */
RtRational rt_exact_of(double x);
RtRational rt_exact_add(RtRational a, RtRational b);
RtRational rt_exact_sub(RtRational a, RtRational b);
RtRational rt_exact_mul(RtRational a, RtRational b);
RtRational rt_exact_div(RtRational a, RtRational b); /* b is not 0 */
RtRational rt_exact_neg(RtRational a);

/* -1, 0, 1 */
static inline int rt_exact_sign(RtRational a) {
    return mpq_sgn(a);
}

/* The nearest long double or one next to it: a relative error below 2^-62. */
long double rt_exact_value(RtRational a);

typedef struct RtExactVec {
    RtRational at[3];
} RtExactVec;

RtExactVec rt_exact_vec(RtVec3d v);
RtExactVec rt_exact_vec_sub(RtExactVec a, RtExactVec b);
RtExactVec rt_exact_vec_add_scaled(RtExactVec a, RtExactVec b, RtRational scale);
RtRational rt_exact_dot(RtExactVec a, RtExactVec b);
RtExactVec rt_exact_cross(RtExactVec a, RtExactVec b);

/* ---- roots ---- */

#define RT_MAX_DEGREE 4

/* The sum of at[i] t^i, i = 0..degree; at[degree] is not 0. The zero polynomial has degree -1. */
typedef struct RtPolynomial {
    int degree;
    RtRational at[RT_MAX_DEGREE + 1];
} RtPolynomial;

/* The sum of at[i] t^i, i = 0..degree; any coefficient may be 0. */
RtPolynomial rt_polynomial(int degree, const RtRational *at);

/* A rational number if lo == hi; otherwise a simple root of `of`, the only one with lo <= t <= hi, and lo and
 * hi are no roots. */
typedef struct RtRoot {
    RtPolynomial of;
    RtRational lo, hi;
    bool crossed; /* the polynomial that was solved changes its sign here */
} RtRoot;

RtRoot rt_root_of(RtRational t);

/* The real roots of p in ascending order; returns their number. A multiple root appears once; a constant has
 * none. Intervals are no wider than 2^-64 of the bound on the roots. */
int rt_polynomial_roots(const RtPolynomial *p, RtRoot roots[RT_MAX_DEGREE]);

/* -1, 0, 1: the sign of a - b, and of a - t. Nothing stays in the arena. */
int rt_root_compare(const RtRoot *a, const RtRoot *b);
int rt_root_compare_rational(const RtRoot *a, RtRational t);

/* a - from, with a relative error below 2^-62 however close they are; exactly 0 if equal. */
long double rt_root_value(const RtRoot *a, RtRational from);

/* ---- lines ---- */

/* A ray whose origin need not be float32. */
typedef struct RtWideRay {
    RtVec3d org, dir;  /* finite; dir, rounded to float32, is not 0 */
    double tmin, tmax; /* tmin finite */
} RtWideRay;

RtWideRay rt_wide_ray(const RtRay *ray);

/* Conservative test in double: may the line meet something in `box` within [tmin, tmax], and at which t at
 * the earliest? */
bool rt_line_may_meet(const RtWideRay *line, const RtBox *box, double *soonest);

/* The relative widening of that test: far above the rounding of a few operations in double. */
#define RT_LINE_SLACK 0x1p-40

/* The same in the arena; tmax is at most FLT_MAX, since a hit at infinity does not count. */
typedef struct RtExactLine {
    RtWideRay wide;
    RtExactVec org, dir;
    RtRational zero, tmin, tmax;
} RtExactLine;

RtExactLine rt_exact_line(const RtWideRay *line);

/* Is t within [tmin, tmax]? */
bool rt_exact_counts(const RtExactLine *line, const RtRoot *t);

#endif
