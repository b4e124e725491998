/* SPDX-License-Identifier: Apache-2.0 */
/* Claims: statements about the results that an experiment expects to hold, and figures that it asks for
 * (`expect`).
 *
 *     CLAIM    = QUANTITY [PLACE] OP NUMBER                   OP: <  <=  >  >=
 *              | QUANTITY [PLACE]                             a readout
 *              | MEASURE of ACCEL TREND with PARAM [PLACE]    TREND: falls, rises, never falls, never rises
 *     QUANTITY = MEASURE of ACCEL
 *              | ratio of MEASURE of ACCEL to ACCEL
 *              | exponent of MEASURE of ACCEL in PARAM
 *              | crossover of MEASURE of ACCEL and ACCEL in PARAM
 *              | correlation of MEASURE and MEASURE of ACCEL
 *     PLACE    = any of: on SCENE, for KIND rays, for all rays, at largest PARAM, at smallest PARAM, at
 * PARAM=VALUE MEASURE  = time, object_tests, extent_tests, steps, csg_tests (each per ray), build_time,
 * bytes, predicted_cost, break_even (rays), render_time (s), query_share (`render`)
 *
 * ACCEL and SCENE are labels, or the common part of the labels of a sweep. ACCEL may be `all`, every
 * accelerator of the list, in a crossover every one but the second; or the name of a baseline of several
 * settings ("embree:best"): the setting that is the fastest on each kind of rays. PARAM is a swept parameter:
 * n, or scene.n or accel.n if both have it; or, except in "at", `objects`, the number of objects of the
 * scene, however scenes are named. A claim covers every cell that it does not exclude, and holds if it holds
 * for all of them. Without "for" that is each kind of rays by itself that a scene has, and the verdict says
 * where kinds differ; "for all rays" is their sum: the mean cost of a ray, each kind weighted by the size of
 * its set. "at" excludes cells without the parameter. The second ACCEL of a ratio or a crossover is one
 * accelerator; in a crossover it may sweep PARAM, too. "falls" means from each value of the parameter to the
 * next larger one.
 *
 * Times have intervals, counts are exact. A claim about times holds if it holds for all values within the
 * intervals, does not hold if it holds for none, and is undecided otherwise. It is undecided, too, with fewer
 * than RT_CLAIM_RAYS rays. Ratios of times, and the steps of a trend of times on one scene, are paired
 * (paired.h). With many cells some interval misses by chance; so all intervals of tracing times in an
 * experiment's claims hold together in 95 % of all cases (rt_coverage_of_each, counting the cells of all
 * claims). Readouts claim nothing and have 95 % each; so have times of builds and frames, whose single
 * measurements are not kept. The time of a single build has no interval and is taken as exact. A break-even
 * is the number of rays from which on an accelerator is ahead of the baseline, its build included; it is
 * infinite if there is none.
 *
 * An exponent is the least-squares slope of the logarithms, a correlation Pearson's of the logarithms.
 * claims_figures.h defines their intervals. They include the scatter of the values, also of counts: a curve
 * that is no power law has no precise exponent.
 *
 * A crossover is where the ratio of the two curves is 1, interpolated in the logarithms; its interval is the
 * range around it in which the interval of the ratio contains 1. It is certain if the interval excludes 1 on
 * both sides. Every crossover is printed, and a claim must hold for all that are certain; those that are not
 * can only make it undecided. It is undecided, too, if no crossover is certain: curves that do not cross
 * within the measured values may cross beyond them.
 *
 * A cell has no value for all rays if one kind of them was not measured. A claim about cells
 * without a value is undecided, unless the others disprove it. If none of its cells was measured, as where a
 * plugin is missing, its verdict is "no measurements"; if an accelerator refused the scene, it is undecided.
 * An exponent needs all values of its line; a crossover only those between the first and the last cell in
 * which both accelerators have a value. A correlation of `all` leaves out structures to which a measure does
 * not apply, as those without a prediction. */
#ifndef RT_EXPERIMENT_CLAIMS_H
#define RT_EXPERIMENT_CLAIMS_H

#include "experiment/results.h"

/* X(CONSTANT, name, unit of a figure); from BUILD_TIME on of structures, so not of a kind of rays. */
#define RT_CLAIM_MEASURES(X)                                                                                 \
    X(TIME, "time", " ns")                                                                                   \
    X(OBJECT_TESTS, "object_tests", "")                                                                      \
    X(EXTENT_TESTS, "extent_tests", "")                                                                      \
    X(STEPS, "steps", "")                                                                                    \
    X(CSG_TESTS, "csg_tests", "")                                                                            \
    X(BUILD_TIME, "build_time", " s")                                                                        \
    X(BYTES, "bytes", " bytes")                                                                              \
    X(PREDICTED_COST, "predicted_cost", "")                                                                  \
    X(BREAK_EVEN, "break_even", " rays")                                                                     \
    X(RENDER_TIME, "render_time", " s")                                                                      \
    X(QUERY_SHARE, "query_share", "")

typedef enum RtClaimMeasure {
#define RT_CLAIM_MEASURE(CONSTANT, name, unit) RT_CLAIM_##CONSTANT,
    RT_CLAIM_MEASURES(RT_CLAIM_MEASURE)
#undef RT_CLAIM_MEASURE
} RtClaimMeasure;

typedef enum RtClaimForm {
    RT_CLAIM_VALUE,
    RT_CLAIM_RATIO,
    RT_CLAIM_EXPONENT,
    RT_CLAIM_CROSSOVER,
    RT_CLAIM_CORRELATION,
    RT_CLAIM_TREND
} RtClaimForm;

#define RT_CLAIM_ALL "all" /* as ACCEL */

#define RT_MAX_CLAIM_PLACES 4

#define RT_CLAIM_RAYS 1000 /* fewer rays decide nothing */

/* A parsed claim. */
typedef struct RtClaim {
    RtClaimForm form;
    RtClaimMeasure measure, first;                 /* first: of a correlation's two; else the same */
    char accel[RT_MAX_LABEL], scene[RT_MAX_LABEL]; /* scene: "" for all */
    char other[RT_MAX_LABEL]; /* of a ratio, the denominator; of a crossover, the second; else "" */
    RtSweptKey key;           /* of an exponent, a crossover or a trend; key.key NULL: none */
    bool by_objects;          /* key is the number of objects of the scene */
    bool each_kind;           /* judged for each kind of rays by itself */
    RtRayKind kind;           /* else; or RT_ALL_RAYS */
    uint32_t place_count;
    struct {
        RtSweptKey key;
        char value[RT_MAX_SWEPT_CHARS];
    } places[RT_MAX_CLAIM_PLACES];
    bool rises, strictly;   /* of a trend */
    bool readout;           /* without OP and NUMBER */
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
    RT_CLAIM_FIGURE,     /* a readout, which claims nothing */
    RT_CLAIM_VERDICT_COUNT
} RtClaimVerdict;

#define RT_MAX_CLAIM_FIGURES 512
typedef struct RtClaimResult {
    RtClaimVerdict verdict;
    /* With intervals: the deciding figure, or the one nearest to deciding; of a readout all, or the smallest
     * and the largest of many. */
    char figures[RT_MAX_CLAIM_FIGURES];
} RtClaimResult;

/* "holds", "does not hold", "undecided", "no measurements", "figure". */
const char *rt_claim_verdict_name(RtClaimVerdict verdict);

/* The coverage of each interval of a tracing time, with which those of all claims hold together in 95 % of
 * all cases; *count gets the number of them. */
double rt_claims_coverage(const RtResults *results, uint32_t *count);

/* Judges claim number `i` of the experiment; an invalid one has no measurements. */
void rt_claim_judge(const RtResults *results, uint32_t i, RtClaimResult *result);

/* RT_MISMATCH with the number of claims that do not hold, if there are any. */
RtStatus rt_claims_check(const RtResults *results, RtError *error);

/* A sentence on the intervals of many claims; "" without any. */
#define RT_MAX_CLAIM_LEVEL 160
void rt_claims_level(const RtResults *results, char out[RT_MAX_CLAIM_LEVEL]);

/* Prints all claims with their verdicts, and which of them changed after the run. */
void rt_claims_print(const RtResults *results, FILE *out);

#endif
