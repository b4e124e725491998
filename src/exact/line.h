/* SPDX-License-Identifier: Apache-2.0 */
/* Lines that are asked about in exact arithmetic: rays whose origin need not be float32, in double and as
 * exact numbers, and what can come of asking. */
#ifndef RT_EXACT_LINE_H
#define RT_EXACT_LINE_H

#include "core/base/box.h"
#include "core/base/ray.h"
#include "exact/place.h"

/* A ray whose origin need not be float32. */
typedef struct RtWideRay {
    RtVec3d org, dir;  /* finite; dir, rounded to float32, is not 0 */
    double tmin, tmax; /* tmin finite */
} RtWideRay;

RtWideRay rt_wide_ray(const RtRay *ray);

/* May the line meet what lies in `box`, within [tmin, tmax], and how soon at the earliest? In double; rounds
 * towards yes. */
bool rt_line_may_meet(const RtWideRay *line, const RtBox *box, double *soonest);

/* By how much that is wider than the box, in parts of the numbers it is computed from: far above the rounding
 * of a few operations in double, and far below what would let many objects in. */
#define RT_LINE_SLACK 0x1p-40

/* The same in an arena; tmax is at most FLT_MAX, for a hit at infinity is none. */
typedef struct RtExactLine {
    RtWideRay wide;
    RtExactVec org, dir;
    RtRational zero, tmin, tmax;
} RtExactLine;

RtExactLine rt_exact_line(RtExactArena *arena, const RtWideRay *line);

/* Is t within [tmin, tmax]? */
bool rt_exact_counts(RtExactArena *arena, const RtExactLine *line, const RtPlace *t);

/* Of an object: whether the line meets it within [tmin, tmax], so far as that can be said. */
typedef enum RtFinding { RT_MISSED, RT_HIT, RT_UNDECIDED } RtFinding;

#endif
