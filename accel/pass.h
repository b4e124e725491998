/* SPDX-License-Identifier: Apache-2.0 */
/* Passes over an array of rays, which is cut into chunks that threads take in turn. A chunk begins with
 * rt_query_begin, so counts do not depend on the number of threads. */
#ifndef RT_ACCEL_PASS_H
#define RT_ACCEL_PASS_H

#include "accel/accel.h"

enum { RT_PASS_CHUNK = 4096 }; /* rays */

typedef struct RtPass {
    const RtRay *rays; /* [count] borrowed */
    size_t count;
    RtQuery *queries; /* [threads] */
    int threads;
    RtHit *hits;                           /* [count] answers of `nearest`, or NULL */
    bool *blocked;                         /* [count] answers of `occluded`, or NULL */
    RtTally (*tallies)[RT_RAY_KIND_COUNT]; /* [threads], or NULL: the timed kernels */
} RtPass;

/* Everything that a pass by `occluded` (if `any`) or `nearest` needs, so that nothing is allocated while it
 * runs. Clear it also after a failure. `threads`: 0 = all processors. */
RtStatus rt_pass_init(RtPass *pass, const RtAccel *accel, const RtRay *rays, size_t count, bool any,
                      int threads, bool counted, RtError *error);
void rt_pass_clear(RtPass *pass);

/* Traces rays[first..first + count) on this thread, by the query of thread number `thread`. */
void rt_pass_trace(RtPass *pass, int thread, size_t first, size_t count);

/* Traces all rays; then RT_OK, or why the answers are invalid. */
RtStatus rt_pass_run(RtPass *pass, RtError *error);

#endif
