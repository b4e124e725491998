/* SPDX-License-Identifier: Apache-2.0 */
/* The cells that a claim is about, with their values. */
#ifndef RT_CLAIMS_CLAIMS_POINTS_H
#define RT_CLAIMS_CLAIMS_POINTS_H

#include "claims/claims.h"

/* A cell. `candidate` may be RT_FASTEST_BASELINE. */
typedef struct RtClaimPoint {
    uint32_t workload, candidate;
    RtRayKind kind; /* or RT_ALL_RAYS */
    uint64_t rays;  /* measured: the fewest of both accelerators; UINT64_MAX if the claim is not of rays */
    double x;       /* of the parameter; of a correlation: the first measure, NAN if unknown */
    RtEstimate y;   /* the measure, or the ratio of a ratio or a crossover; NAN if unknown */
} RtClaimPoint;

/* Whether x and y are known. An infinite break-even is known. */
bool rt_claim_point_known(const RtClaimPoint *point);

/* Writes the cells of a claim to points[0..workload_count * candidate_count * RT_RAY_KIND_COUNT), kind by
 * kind; returns their number. Intervals of tracing times cover `coverage`. NULL: only their number. */
uint32_t rt_claim_gather(const RtResults *results, const RtClaim *claim, double coverage,
                         RtClaimPoint *points);

/* Whether anything that the claim could be about was measured in any of the cells. */
bool rt_claim_any_measured(const RtResults *results, const RtClaim *claim, const RtClaimPoint *points,
                           uint32_t count);

/* Moves the points that differ from points[0] only in the claim's parameter to the front and sorts them by
 * it; returns their number, >= 1. */
uint32_t rt_claim_line(const RtExperiment *experiment, const RtClaim *claim, RtClaimPoint *points,
                       uint32_t count);

/* Why an accelerator that the claim names refused a scene of it; NULL if none did. */
const char *rt_claim_refusal(const RtResults *results, const RtClaim *claim);

#endif
