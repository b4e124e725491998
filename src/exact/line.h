/* SPDX-License-Identifier: Apache-2.0 */
/* Lines for exact arithmetic: rays whose origin need not be float32, in double and as exact numbers, and
 * the possible results of a query. */
#ifndef RT_EXACT_LINE_H
#define RT_EXACT_LINE_H

#include "core/base/box.h"
#include "core/base/ray.h"
#include "exact/algebraic.h"

/* A ray whose origin need not be float32. */
typedef struct RtWideRay {
    RtVec3d org, dir;  /* finite; dir, rounded to float32, is not 0 */
    double tmin, tmax; /* tmin finite */
} RtWideRay;

RtWideRay rt_wide_ray(const RtRay *ray);

/* Conservative test in double: may the line meet something in `box` within [tmin, tmax], and at which t at
 * the earliest? */
bool rt_line_may_meet(const RtWideRay *line, const RtBox *box, double *soonest);

/* The relative widening of that test: far above the rounding of a few operations in double, and far too
 * small to admit many objects. */
#define RT_LINE_SLACK 0x1p-40

/* The same in an arena; tmax is at most FLT_MAX, since a hit at infinity does not count. */
typedef struct RtExactLine {
    RtWideRay wide;
    RtExactVec org, dir;
    RtRational zero, tmin, tmax;
} RtExactLine;

RtExactLine rt_exact_line(RtExactArena *arena, const RtWideRay *line);

/* Is t within [tmin, tmax]? */
bool rt_exact_counts(RtExactArena *arena, const RtExactLine *line, const RtRoot *t);

/* Does the line meet an object within [tmin, tmax]? */
typedef enum RtExactResult { RT_MISSED, RT_HIT, RT_UNDECIDED } RtExactResult;

#endif
