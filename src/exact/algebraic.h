/* SPDX-License-Identifier: Apache-2.0 */
/* Roots of polynomials with rational coefficients, as exact numbers. A root is its polynomial, which has no
 * root twice, and an interval with rational ends that holds this root and no other: it can be narrowed for as
 * long as it takes.
 *
 * Real roots are told apart by Sturm's theorem ("Memoire sur la resolution des equations numeriques", 1829):
 * of the chain p, p', and minus the remainder of each two before, the changes of sign at x, less those at y,
 * are the roots between x and y. Intervals are narrowed by signs at rational points alone, chosen by a secant
 * (Abbott 2014, "Quadratic Interval Refinement for Real Roots"). Two roots are the same number where the
 * greatest common divisor of their polynomials has a root in both intervals; if not, narrowing parts them. So
 * nothing is estimated, and a tie is a tie.
 *
 * Numbers are in an arena (exact.h). Polynomials that come out of divisions are multiplied by a number above
 * 0 that makes their coefficients integers without a common factor: so they stay as short as they can. */
#ifndef RT_EXACT_ALGEBRAIC_H
#define RT_EXACT_ALGEBRAIC_H

#include "exact/exact.h"

#define RT_MAX_DEGREE 4

/* The sum of at[i] t^i, i = 0..degree; at[degree] is not 0. The polynomial 0 has degree -1. */
typedef struct RtPolynomial {
    int degree;
    RtRational at[RT_MAX_DEGREE + 1];
} RtPolynomial;

/* -1, 0, 1 */
int rt_polynomial_sign(RtExactArena *arena, const RtPolynomial *p, RtRational t);

/* The greatest common divisor of two that are not both 0. */
RtPolynomial rt_polynomial_common(RtExactArena *arena, const RtPolynomial *p, const RtPolynomial *q);

/* A root of `of`, the only one with lo <= t <= hi; lo and hi are none. No root of `of` is one twice. */
typedef struct RtAlgebraic {
    RtPolynomial of;
    RtRational lo, hi;
} RtAlgebraic;

/* The real roots of p, of degree 0 or more, in ascending order; gives their number. A multiple root is given
 * once: it is one that p changes its sign at if p has different signs at lo and hi. Intervals are no wider
 * than 2^-64 of the largest number that a root of p may be. */
int rt_polynomial_roots(RtExactArena *arena, const RtPolynomial *p, RtAlgebraic roots[RT_MAX_DEGREE]);

RtAlgebraic rt_algebraic_of_surd(RtExactArena *arena, const RtSurd *surd);

/* -1, 0, 1: the sign of a - b. Nothing stays in the arena. */
int rt_algebraic_compare(RtExactArena *arena, const RtAlgebraic *a, const RtAlgebraic *b);

/* a - from, with an error below 2^-62 of it. */
long double rt_algebraic_value(RtExactArena *arena, const RtAlgebraic *a, RtRational from);

#endif
