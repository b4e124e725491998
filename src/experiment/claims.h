/* SPDX-License-Identifier: Apache-2.0 */
/* Claims: statements about the results that an experiment expects to hold (`expect:`).
 *
 *     CLAIM    = QUANTITY [PLACE] OP NUMBER                   OP: <  <=  >  >=
 *              | MEASURE of ACCEL TREND with PARAM [PLACE]    TREND: falls, rises, never falls, never rises
 *     QUANTITY = MEASURE of ACCEL
 *              | ratio of MEASURE of ACCEL to ACCEL
 *              | exponent of MEASURE of ACCEL in PARAM
 *     PLACE    = any of: on SCENE, for KIND rays, at largest PARAM, at smallest PARAM, at PARAM=VALUE
 *     MEASURE  = time, object_tests, extent_tests, steps (each per ray), build_time, bytes
 *
 * ACCEL and SCENE are labels, or the common part of the labels of a sweep; PARAM is a swept parameter: n, or
 * scene.n or accel.n if both have it. A claim covers every cell that it does not exclude, all kinds of rays
 * together unless it names one; it holds if it holds for all of them. "at" excludes cells without the
 * parameter. The second ACCEL of a ratio is one accelerator. "falls" means from each value of the parameter
 * to the next larger one.
 *
 * Times have intervals, counts are exact. A claim about times holds if it holds for all values within the
 * intervals, does not hold if it holds for none, and is undecided otherwise. A ratio of times to the baseline
 * on one kind of rays is the paired one; other ratios use the quotients of the intervals' ends. An exponent
 * is the least-squares slope of the logarithms; its interval covers all values within the times' intervals. A
 * build time has no interval.
 *
 * A cell has no value for all kinds of rays together if one of them was not measured. A claim about cells
 * without a value is undecided, unless the others disprove it. If none of its cells was measured, as where a
 * plugin is missing, its verdict is "no measurements". An exponent needs all values of its line. */
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

/* A parsed claim. */
typedef struct RtClaim {
    RtClaimForm form;
    RtClaimMeasure measure;
    char accel[RT_MAX_LABEL], scene[RT_MAX_LABEL]; /* scene: "" for all */
    uint32_t other;                                /* of a ratio: the denominator */
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

/* Parses `text`, or says what is wrong. The claim borrows from the experiment. */
RtStatus rt_claim_parse(const RtExperiment *experiment, const char *text, RtClaim *claim, RtError *error);

typedef enum RtClaimVerdict {
    RT_CLAIM_HOLDS,
    RT_CLAIM_UNDECIDED,
    RT_CLAIM_FALSE,
    RT_CLAIM_UNMEASURED, /* no cell that it is about was measured */
    RT_CLAIM_VERDICT_COUNT
} RtClaimVerdict;

#define RT_MAX_CLAIM_FIGURES 256
typedef struct RtClaimResult {
    RtClaimVerdict verdict;
    char figures[RT_MAX_CLAIM_FIGURES]; /* with interval: the deciding figure, or the one nearest to deciding
                                         */
} RtClaimResult;

/* "holds", "does not hold", "undecided", "no measurements". */
const char *rt_claim_verdict_name(RtClaimVerdict verdict);

/* Judges claim number `i` of the experiment; an invalid one has no measurements. */
void rt_claim_judge(const RtResults *results, uint32_t i, RtClaimResult *result);

/* RT_MISMATCH with the number of claims that do not hold, if there are any. */
RtStatus rt_claims_check(const RtResults *results, RtError *error);

/* Prints all claims with their verdicts. */
void rt_claims_print(const RtResults *results, FILE *out);

#endif
