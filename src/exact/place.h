/* SPDX-License-Identifier: Apache-2.0 */
/* Places on a line: numbers t where it meets a surface. Of surfaces of degree 2 they are surds (exact.h), of
 * tori, which have degree 4, roots of a polynomial (algebraic.h). All are compared with all, exactly. */
#ifndef RT_EXACT_PLACE_H
#define RT_EXACT_PLACE_H

#include "exact/algebraic.h"

typedef struct RtPlace {
    RtSurd surd;      /* where root.of.degree is 0 */
    RtAlgebraic root; /* else */
} RtPlace;

RtPlace rt_place_of_surd(const RtSurd *surd);
RtPlace rt_place_of(RtExactArena *arena, RtRational t);
RtPlace rt_place_of_root(const RtAlgebraic *root);

/* -1, 0, 1: the sign of a - b. Nothing stays in the arena. */
int rt_place_compare(RtExactArena *arena, const RtPlace *a, const RtPlace *b);

/* place - from, with an error below 2^-62 of it, however near they are; exactly 0 where it is 0. */
long double rt_place_value(RtExactArena *arena, const RtPlace *place, RtRational from);

#endif
