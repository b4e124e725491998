/* SPDX-License-Identifier: Apache-2.0 */
/* Claims: what an experiment expects of its results, in words that are held against them (`expect:`).
 *
 *     CLAIM    = QUANTITY [PLACE] OP NUMBER                   OP: <  <=  >  >=
 *              | MEASURE of ACCEL TREND with PARAM [PLACE]    TREND: falls, rises, never falls, never rises
 *     QUANTITY = MEASURE of ACCEL
 *              | ratio of MEASURE of ACCEL to ACCEL
 *              | exponent of MEASURE of ACCEL in PARAM
 *     PLACE    = any of: on SCENE, for KIND rays, at largest PARAM, at smallest PARAM, at PARAM=VALUE
 *     MEASURE  = time, object_tests, extent_tests, steps (each per ray), build_time, bytes
 *
 * ACCEL and SCENE are labels, or what the labels of a sweep have in common; PARAM is swept: n, or where a
 * scene and an accelerator have it scene.n or accel.n. A claim is about every cell that it does not leave
 * out, all kinds of rays together unless it names one; it holds where it holds for all of them. "at" leaves
 * out what lacks the parameter. The second ACCEL of a ratio is one accelerator. "falls" means from each value
 * of the parameter to the next larger one.
 *
 * Times have intervals, counts are exact. A claim about times holds where it does for all values that the
 * intervals leave open, does not hold where it does for none, and is undecided otherwise. A ratio of times is
 * the paired one where it is that to the baseline on one kind of rays, else the quotients of the intervals'
 * ends. An exponent is the slope of the least squares of the logarithms; its interval is what all values
 * within the times' intervals could give. A time to build has no interval and is taken as it is.
 *
 * A cell has no value for all kinds of rays together where one of them was not measured. A claim about cells
 * without a value is undecided, unless the others disprove it. An exponent needs all values of its line. */
#ifndef RT_EXPERIMENT_CLAIMS_H
#define RT_EXPERIMENT_CLAIMS_H

#include "experiment/results.h"

typedef enum RtClaimMeasure {
    RT_CLAIM_TIME,
    RT_CLAIM_OBJECT_TESTS,
    RT_CLAIM_EXTENT_TESTS,
    RT_CLAIM_STEPS,
    RT_CLAIM_BUILD_TIME,
    RT_CLAIM_BYTES
} RtClaimMeasure;

typedef enum RtClaimForm { RT_CLAIM_VALUE, RT_CLAIM_RATIO, RT_CLAIM_EXPONENT, RT_CLAIM_TREND } RtClaimForm;

#define RT_MAX_CLAIM_PLACES 4

/* A claim as it is understood. */
typedef struct RtClaim {
    RtClaimForm form;
    RtClaimMeasure measure;
    char accel[RT_MAX_LABEL], scene[RT_MAX_LABEL]; /* scene: "" for all */
    uint32_t other;                                /* of a ratio: what stands below */
    RtSweptKey key;                                /* of an exponent or a trend */
    RtRayKind kind;                                /* or RT_ALL_RAYS */
    uint32_t place_count;
    struct {
        RtSweptKey key;
        char value[RT_MAX_SWEPT_CHARS];
    } places[RT_MAX_CLAIM_PLACES];
    bool rises, strictly;   /* of a trend */
    bool greater, or_equal; /* of all others */
    double number;
} RtClaim;

/* Understands `text`, or says what would be right. The claim borrows from the experiment. */
RtStatus rt_claim_parse(const RtExperiment *experiment, const char *text, RtClaim *claim, RtError *error);

typedef enum RtClaimVerdict { RT_CLAIM_HOLDS, RT_CLAIM_UNDECIDED, RT_CLAIM_FALSE } RtClaimVerdict;

#define RT_MAX_CLAIM_FIGURES 256
typedef struct RtClaimResult {
    RtClaimVerdict verdict;
    char figures[RT_MAX_CLAIM_FIGURES]; /* with interval: of what decides, or comes nearest to it */
} RtClaimResult;

/* "holds", "does not hold", "undecided". */
const char *rt_claim_verdict_name(RtClaimVerdict verdict);

/* Holds claim number `i` of the experiment against its results; what cannot be understood, or was not
 * measured, is undecided. */
void rt_claim_judge(const RtResults *results, uint32_t i, RtClaimResult *result);

/* RT_MISMATCH where any claim does not hold, with how many. */
RtStatus rt_claims_check(const RtResults *results, RtError *error);

/* All claims, a line each with their verdicts; nothing where there are none. */
void rt_claims_print(const RtResults *results, FILE *out);

#endif
