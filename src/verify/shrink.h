/* SPDX-License-Identifier: Apache-2.0 */
/* Shrinking: which few objects of a scene are enough for an accelerator to answer a ray wrong.
 *
 * Zeller & Hildebrandt 2002, "Simplifying and Isolating Failure-Inducing Input" (IEEE TSE 28(2)): objects are
 * left out in halves, quarters, ... down to single ones, as long as the answer stays wrong; each try builds
 * the accelerator over what is left and asks. Objects keep their order. At the end none of those left can be
 * spared, unless the budget was spent before. */
#ifndef RT_VERIFY_SHRINK_H
#define RT_VERIFY_SHRINK_H

#include "verify/failure.h"

/* Called after each try with the number of objects left and of tries. */
typedef struct RtShrinkObserver {
    void (*tried)(void *context, uint32_t left, uint32_t tries);
    void *context;
} RtShrinkObserver;

/* The budget is counted in objects that were built over, so that the result does not depend on a clock; some
 * seconds. */
#define RT_SHRINK_BUDGET (UINT64_C(1) << 21)

typedef struct RtShrunk {
    uint32_t *ids; /* [count] of the objects left, ascending; owned: rt_free */
    uint32_t count, tries;
    bool minimal;    /* false: the budget was spent */
    RtAnswer answer; /* over the objects left; ids there are places in `ids` */
} RtShrunk;

/* Shrinks `scene` for a failure over it, with `answer`. `observer` may be NULL. An
 * accelerator that cannot be built over a part is taken to answer right there. */
RtStatus rt_shrink(const RtScene *scene, const RtFailure *failure, const RtAnswer *answer, RtMaker maker,
                   uint64_t budget, const RtShrinkObserver *observer, RtShrunk *out, RtError *error);

#endif
