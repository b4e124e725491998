/* SPDX-License-Identifier: Apache-2.0 */
/* The verdicts on claims (experiment/claim.h), those of lists and those of findings.
 *
 * Times have intervals, counts are exact. A claim about times holds if it holds for all values within the
 * intervals, does not hold if it holds for none, and is undecided otherwise. It is undecided, too, with fewer
 * than RT_CLAIM_RAYS rays. Ratios of times, and the steps of a trend of times on one scene, are paired
 * (results/results.h); one of cells in different places has the quotient of both estimates, and rests on two
 * intervals. With many intervals some miss by chance; so all those of tracing times in an experiment's claims
 * hold together in 95 % of all cases (rt_coverage_of_each, counting the cells of all claims). Readouts claim
 * nothing and have 95 % each; so have times of builds and rendered frames, whose single measurements are not
 * kept. The time of a single build has no interval and is taken as exact. A break-even is the number of rays
 * from which on an accelerator is ahead of the baseline, its build included; it is infinite if there is none.
 *
 * That an accelerator is fastest is judged against each other one, and counts as so many intervals. A claim
 * about a mean or a correlation rests on those of its cells.
 *
 * An exponent is the least-squares slope of the logarithms, a correlation Pearson's of the logarithms.
 * claims_points.h defines their intervals. They include the scatter of the values, also of counts: a curve
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
#ifndef RT_CLAIMS_CLAIMS_H
#define RT_CLAIMS_CLAIMS_H

#include "experiment/claim.h"
#include "experiment/finding.h"
#include "results/results.h"

typedef enum RtClaimVerdict {
    RT_CLAIM_HOLDS,
    RT_CLAIM_UNDECIDED,
    RT_CLAIM_FALSE,
    RT_CLAIM_UNMEASURED, /* no cell that it is about was measured */
    RT_CLAIM_FIGURE,     /* a readout, which claims nothing */
    RT_CLAIM_VERDICT_COUNT
} RtClaimVerdict;

#define RT_MAX_CLAIM_FIGURES 512
#define RT_MAX_CLAIM_VALUE   160
typedef struct RtClaimResult {
    RtClaimVerdict verdict;
    /* With intervals: the deciding figure, or the one nearest to deciding; of a readout all, or the smallest
     * and the largest of many. */
    char figures[RT_MAX_CLAIM_FIGURES];
    char value[RT_MAX_CLAIM_VALUE]; /* of a readout, for a sentence: "1.43 [1.40, 1.47]", "0.30 to 0.89" */
    bool measured, whole;           /* any, or all values of its cells are known */
    bool contrary;                  /* "percent less" or "more" of what may be the other way round */
} RtClaimResult;

/* "holds", "does not hold", "undecided", "no measurements", "figure". */
const char *rt_claim_verdict_name(RtClaimVerdict verdict);

/* The coverage of each interval of a tracing time, with which those of all claims hold together in 95 % of
 * all cases; *count gets the number of them. */
double rt_claims_coverage(const RtResults *results, uint32_t *count);

/* Judges a claim. `other`: it is none of this experiment's, and counts as one more of them in the coverage.
 * RT_BAD_INPUT if it is none; then it has no measurements. */
RtStatus rt_claim_judge_text(const RtResults *results, const char *text, bool other, RtClaimResult *result,
                             RtError *error);

/* The same of claim number `i` of the experiment; an invalid one has no measurements. */
void rt_claim_judge(const RtResults *results, uint32_t i, RtClaimResult *result);

/* RT_MISMATCH with the number of claims that do not hold, if there are any. */
RtStatus rt_claims_check(const RtResults *results, RtError *error);

/* A sentence on the intervals of many claims; "" without any. */
#define RT_MAX_CLAIM_LEVEL 160
void rt_claims_level(const RtResults *results, char out[RT_MAX_CLAIM_LEVEL]);

/* A heading's remark on claims and findings of a --quick variant; else "". */
const char *rt_claims_variant(const RtExperiment *experiment);

/* Prints all claims with their verdicts, and which of them changed after the run. */
void rt_claims_print(const RtResults *results, FILE *out);

#endif
