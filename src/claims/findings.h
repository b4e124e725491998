/* SPDX-License-Identifier: Apache-2.0 */
/* Findings filled in with figures (experiment/finding.h), and whether verdicts on papers are supported. */
#ifndef RT_CLAIMS_FINDINGS_H
#define RT_CLAIMS_FINDINGS_H

#include "claims/claims.h"

typedef enum RtFindingMark {
    RT_FINDING_PLAIN,   /* text */
    RT_FINDING_FIGURE,  /* a readout */
    RT_FINDING_UPHELD,  /* words whose claim holds */
    RT_FINDING_MISSING, /* there are no measurements for it */
    RT_FINDING_BROKEN   /* the claim does not hold or is undecided, or the figure is unknown */
} RtFindingMark;

typedef struct RtFindingSegment {
    RtFindingMark mark;
    const char *said; /* beside it: "does not hold", "undecided", "no measurements"; "" if nothing is wrong */
    char text[RT_MAX_TEXT]; /* as a reader sees it */
    /* The expression, its verdict and figures; "" of text. */
    char note[RT_MAX_CLAIM + RT_MAX_CLAIM_FIGURES + 64];
} RtFindingSegment;

typedef struct RtFinding {
    RtFindingSegment *segments; /* owned, [count] */
    uint32_t count;
    uint32_t broken; /* of them, RT_FINDING_BROKEN */
} RtFinding;

/* Fills the experiment's finding in; none if it has none. Results of other experiments are beside
 * `directory`. RT_NO_MEMORY; all else that is wrong, also with other results, breaks only its segment. */
RtStatus rt_finding_fill(const RtResults *results, const char *directory, RtFinding *finding, RtError *error);
void rt_finding_clear(RtFinding *finding);

/* All of it as text, an owned string; broken and missing words with a mark: "never [does not hold]". NULL if
 * memory is short. */
char *rt_finding_text(const RtFinding *finding);

/* What keeps a paper's verdict from being supported by its claims; "" if nothing does. */
const char *rt_paper_problem(const RtResults *results, const RtPaper *paper);

/* Prints the finding, which of its expressions do not hold, and verdicts on papers that are not supported. */
void rt_findings_print(const RtResults *results, const char *directory, FILE *out);

/* RT_MISMATCH if a claim does not hold (rt_claims_check), an expression of the finding is broken, or a
 * verdict on a paper is not supported. */
RtStatus rt_findings_check(const RtResults *results, const char *directory, RtError *error);

/* What a run ends with: its outcome, claims, finding and null runs (results/result_tables.h). */
void rt_print_summary(const RtResults *results, const char *directory, FILE *out);

#endif
