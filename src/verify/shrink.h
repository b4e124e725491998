/* SPDX-License-Identifier: Apache-2.0 */
/* Shrinking: reduces the scene of a failure to a few objects.
 *
 * Delta debugging (Zeller & Hildebrandt 2002, "Simplifying and Isolating Failure-Inducing Input", IEEE TSE
 * 28(2)): objects are removed in halves, quarters, ... down to single ones while the answer stays wrong;
 * each try builds the accelerator over the remaining objects and repeats the query. Objects keep their
 * order. In the end every remaining object is necessary, unless the budget was exhausted. */
#ifndef RT_VERIFY_SHRINK_H
#define RT_VERIFY_SHRINK_H

#include "verify/failure.h"

/* Called after each try with the numbers of remaining objects and of tries. */
typedef struct RtShrinkObserver {
    void (*tried)(void *context, uint32_t left, uint32_t tries);
    void *context;
} RtShrinkObserver;

/* The budget counts objects built over, so that the result does not depend on a clock; it lasts some
 * seconds. */
#define RT_SHRINK_BUDGET (UINT64_C(1) << 21)

typedef struct RtShrunk {
    uint32_t *ids; /* [count] remaining objects, ascending; owned: rt_free */
    uint32_t count, tries;
    bool minimal;    /* false: the budget was exhausted */
    RtAnswer answer; /* over the remaining objects; its ids are positions in `ids` */
} RtShrunk;

/* Shrinks `scene` for a failure with `answer`. `observer` may be NULL. If the accelerator cannot be built
 * over a part, its answer there counts as right. */
RtStatus rt_shrink(const RtScene *scene, const RtFailure *failure, const RtAnswer *answer,
                   RtAccelBuilder builder, uint64_t budget, const RtShrinkObserver *observer, RtShrunk *out,
                   RtError *error);

#endif
