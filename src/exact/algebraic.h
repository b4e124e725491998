/* SPDX-License-Identifier: Apache-2.0 */
/* Roots of polynomials with rational coefficients, as exact numbers. A root is represented by its polynomial,
 * which has no multiple root, and an interval with rational ends that contains this root alone; the interval
 * can be narrowed as far as necessary.
 *
 * Real roots are isolated by Sturm's theorem ("Memoire sur la resolution des equations numeriques", 1829):
 * for the chain p, p', and minus the remainder of each two before, the sign changes at x minus those at y are
 * the number of roots between x and y. Intervals are narrowed by signs at rational points alone, chosen by a
 * secant (Abbott 2014, "Quadratic Interval Refinement for Real Roots"). Two roots are equal if the greatest
 * common divisor of their polynomials has a root in both intervals; otherwise narrowing separates them. So
 * nothing is estimated, and a tie is a tie.
 *
 * Numbers lie in an arena (exact.h). Polynomials that result from divisions are scaled by a positive
 * number that makes their coefficients integers without a common factor, to keep them short. */
#ifndef RT_EXACT_ALGEBRAIC_H
#define RT_EXACT_ALGEBRAIC_H

#include "exact/exact.h"

#define RT_MAX_DEGREE 4

/* The sum of at[i] t^i, i = 0..degree; at[degree] is not 0. The zero polynomial has degree -1. */
typedef struct RtPolynomial {
    int degree;
    RtRational at[RT_MAX_DEGREE + 1];
} RtPolynomial;

/* -1, 0, 1 */
int rt_polynomial_sign(RtExactArena *arena, const RtPolynomial *p, RtRational t);

/* A simple root of `of`, and the only one with lo <= t <= hi; lo and hi are no roots. */
typedef struct RtAlgebraic {
    RtPolynomial of;
    RtRational lo, hi;
} RtAlgebraic;

/* The real roots of p, of degree 0 or more, in ascending order; returns their number. A multiple root
 * appears once; p changes its sign there if its signs at lo and hi differ. Intervals are no wider than
 * 2^-64 of the bound on the roots of p. */
int rt_polynomial_roots(RtExactArena *arena, const RtPolynomial *p, RtAlgebraic roots[RT_MAX_DEGREE]);

/* -1, 0, 1: the sign of a - b. Nothing stays in the arena. */
int rt_algebraic_compare(RtExactArena *arena, const RtAlgebraic *a, const RtAlgebraic *b);

/* a - from, with a relative error below 2^-62. */
long double rt_algebraic_value(RtExactArena *arena, const RtAlgebraic *a, RtRational from);

/* ---- where a line meets a surface ---- */

/* A number t at which a line meets a surface: a surd for surfaces of degree 2, an algebraic number for tori,
 * which have degree 4. All are compared exactly. */
typedef struct RtRoot {
    RtSurd surd;           /* if algebraic.of.degree is 0 */
    RtAlgebraic algebraic; /* otherwise */
} RtRoot;

RtRoot rt_root_of_surd(const RtSurd *surd);
RtRoot rt_root_of(RtExactArena *arena, RtRational t);
RtRoot rt_root_of_algebraic(const RtAlgebraic *algebraic);

/* -1, 0, 1: the sign of a - b. Nothing stays in the arena. */
int rt_root_compare(RtExactArena *arena, const RtRoot *a, const RtRoot *b);

/* root - from, with a relative error below 2^-62 however close they are; exactly 0 if equal. */
long double rt_root_value(RtExactArena *arena, const RtRoot *root, RtRational from);

#endif
