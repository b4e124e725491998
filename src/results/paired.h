/* SPDX-License-Identifier: Apache-2.0 */
/* Times of accelerators relative to each other, paired: divided within each round, so that what slows a round
 * slows both. Only cells that were timed in the same rounds can be paired directly; of others each is first
 * divided by the baseline of its own rounds and rays. */
#ifndef RT_RESULTS_PAIRED_H
#define RT_RESULTS_PAIRED_H

#include "results/results.h"

/* The time of a ray: of one kind, or with RT_ALL_RAYS the weighted mean of all kinds, summed within each
 * round. Its interval covers at least `coverage`, 0.95 or more (rt_estimate_covering); that of a journal of
 * an older version, which has no times of rounds, is as it was kept. NAN if a kind was not measured. */
RtEstimate rt_results_time(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind,
                           double coverage);

/* The time of `over` relative to that of `under`, likewise. Where nothing can be paired, because there are no
 * times of rounds or no common baseline, the quotient of both estimates, with those of the intervals' ends.
 * Both may be RT_FASTEST_BASELINE. */
RtEstimate rt_results_time_ratio(const RtResults *results, uint32_t workload, uint32_t over, uint32_t under,
                                 RtRayKind kind, double coverage);

/* False of null runs and the yardstick (rt_accel_yardstick). */
bool rt_candidate_is_compared(const RtExperiment *experiment, uint32_t candidate);

/* Compares a candidate with all others of the workload, for one kind of rays or RT_ALL_RAYS: by time if
 * anything was timed, else by object tests per ray. No other is faster than the best by the medians of paired
 * ratios; one whose ratio to the best has 1 in its interval is level with it. Only rt_candidate_is_compared
 * are compared. */
RtStanding rt_standing(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind);

/* The same by time, or by object tests, whatever was timed. */
RtStanding rt_standing_by(bool time, const RtResults *results, uint32_t workload, uint32_t candidate,
                          RtRayKind kind);

#endif
