/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of verdicts. */
#ifndef RT_TESTS_VERDICT_TESTING_H
#define RT_TESTS_VERDICT_TESTING_H

#include "testing.h"
#include "verify/verdict.h"

static inline RtVerdict verdict_of(const RtGeometry *g, const RtRay *ray, RtHit expected, RtHit answer) {
    RtVerdict verdict;
    assert_ok(rt_verdict_nearest(rt_judge(g, ray, false), expected, answer, &verdict, error));
    return verdict;
}

/* The same whatever brute says: by the margins alone. */
static inline RtVerdict verdict_by_margins(const RtGeometry *g, const RtRay *ray, RtHit answer) {
    const RtHit any = {0, 0};
    return verdict_of(g, ray, answer.object == RT_NO_OBJECT ? any : RT_MISS, answer);
}

#endif
