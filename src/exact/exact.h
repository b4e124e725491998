/* SPDX-License-Identifier: Apache-2.0 */
/* Exact numbers: rationals (GMP), vectors of them, and surds p + q sqrt(d), the roots of quadratic equations.
 * A float32 or double is a rational, so + - * / on such numbers are exact, and order and sign are decided,
 * never estimated.
 *
 * The signs of sums of square roots are found by algebra alone. The sign of a + b sqrt(c), if both parts have
 * opposite signs, is that of a^2 - b^2 c. For (p + q sqrt(d)) + r sqrt(e) with parts of opposite signs it is
 * that of the difference of their squares, which has one root less. Nothing is approximated, so a tie is a
 * tie.
 *
 * Layout. Numbers are written to an arena one after another and never changed. Rewinding the arena to a
 * mark discards the later ones and reuses their memory. Memory is allocated by GMP (a number of a ray
 * takes a few hundred bytes), which ends the program with a message if it fails. */
#ifndef RT_EXACT_EXACT_H
#define RT_EXACT_EXACT_H

#include "core/base/vec.h"

#include <gmp.h>
#include <stddef.h>

/* A number in an arena. */
typedef mpq_srcptr RtRational;

/* A zeroed struct is empty. For one thread at a time. */
typedef struct RtExactArena {
    mpq_t **blocks; /* [block_count] of RT_EXACT_ARENA_BLOCK numbers each, all initialised */
    size_t block_count, used;
} RtExactArena;

#define RT_EXACT_ARENA_BLOCK 64

void rt_exact_arena_clear(RtExactArena *arena);

static inline size_t rt_exact_arena_mark(const RtExactArena *arena) {
    return arena->used;
}

/* Discards all numbers written after the mark. */
static inline void rt_exact_arena_rewind(RtExactArena *arena, size_t mark) {
    arena->used = mark;
}

/* A new number of the arena, to be written once. */
mpq_ptr rt_exact_arena_number(RtExactArena *arena);

/* The calling thread's own arena, which lives as long as the thread; it is used from its mark on. A nested
 * borrower continues behind the numbers of the outer one. Return it with that mark. */
RtExactArena *rt_exact_arena_borrow(void);
void rt_exact_arena_return(RtExactArena *arena, size_t mark);

/* ---- rationals ---- */

/* A finite `x`. */
RtRational rt_exact_of(RtExactArena *arena, double x);
RtRational rt_exact_add(RtExactArena *arena, RtRational a, RtRational b);
RtRational rt_exact_sub(RtExactArena *arena, RtRational a, RtRational b);
RtRational rt_exact_mul(RtExactArena *arena, RtRational a, RtRational b);
RtRational rt_exact_div(RtExactArena *arena, RtRational a, RtRational b); /* b is not 0 */
RtRational rt_exact_neg(RtExactArena *arena, RtRational a);

/* -1, 0, 1 */
static inline int rt_exact_sign(RtRational a) {
    return mpq_sgn(a);
}

/* The nearest long double or one next to it: a relative error below 2^-62. */
long double rt_exact_value(RtRational a);

typedef struct RtExactVec {
    RtRational at[3];
} RtExactVec;

RtExactVec rt_exact_vec(RtExactArena *arena, RtVec3d v);
RtExactVec rt_exact_vec_sub(RtExactArena *arena, RtExactVec a, RtExactVec b);
RtExactVec rt_exact_vec_add_scaled(RtExactArena *arena, RtExactVec a, RtExactVec b, RtRational scale);
RtRational rt_exact_dot(RtExactArena *arena, RtExactVec a, RtExactVec b);
RtExactVec rt_exact_cross(RtExactArena *arena, RtExactVec a, RtExactVec b);

/* ---- surds ---- */

/* p + q sqrt(d), d >= 0 */
typedef struct RtSurd {
    RtRational p, q, d;
} RtSurd;

RtSurd rt_surd_of(RtExactArena *arena, RtRational p);

/* a + b x */
RtSurd rt_surd_line(RtExactArena *arena, RtRational a, RtRational b, const RtSurd *x);

/* The sign (-1, 0, 1) of the number, and of a - b. Nothing stays in the arena. */
int rt_surd_sign(RtExactArena *arena, const RtSurd *a);
int rt_surd_compare(RtExactArena *arena, const RtSurd *a, const RtSurd *b);

/* Like rt_exact_value, also under cancellation of p and q sqrt(d). */
long double rt_surd_value(RtExactArena *arena, const RtSurd *a);

/* The real roots of a t^2 + 2 b t + c in ascending order; returns their number. A double root appears
 * once; an equation that holds for no t or for every t has none. */
int rt_exact_roots(RtExactArena *arena, RtRational a, RtRational half_b, RtRational c, RtSurd roots[2]);

#endif
