/* SPDX-License-Identifier: Apache-2.0 */
/* Findings: sentences with expressions in braces, which are claims and figures over the data
 * (experiment/claim.h). claims/findings.h fills them in.
 *
 *     {QUANTITY [PLACE] [as FORMAT]}   a readout: its figure is shown
 *     {WORDS: CLAIM}                   the words are shown, and marked if the claim does not hold
 *     {"TEXT"}                         shown as it is: a figure that is none of this experiment's
 *     {from NAME: ...}                 one of the first two, over the results beside these, in ../NAME
 *
 * A claim whose words have a general one ("always", "fastest") may name only places that the words name, so
 * that it is about all cells otherwise; a number in the words is the claim's. Outside braces there are no
 * numbers and no general words. */
#ifndef RT_EXPERIMENT_FINDING_H
#define RT_EXPERIMENT_FINDING_H

#include "experiment/experiment.h"

typedef enum RtFindingSort {
    RT_FINDING_TEXT,
    RT_FINDING_LITERAL, /* {"TEXT"} */
    RT_FINDING_READOUT,
    RT_FINDING_CLAIM
} RtFindingSort;

typedef struct RtFindingPiece {
    RtFindingSort sort;
    const char *words; /* [length], borrowed from the finding: what is shown; none of a readout */
    uint32_t length;
    char from[RT_MAX_WORD]; /* the name of another experiment, or "" */
    char expression[RT_MAX_CLAIM];
} RtFindingPiece;

/* Takes the next piece from *at, which is at the beginning of a finding first. False at the end, and with an
 * error if braces do not match. */
bool rt_finding_next(const char **at, RtFindingPiece *piece, RtError *error);

/* Checks an expression of a finding: RT_BAD_INPUT if it is no claim, or narrower than its words.
 * `experiment` is that of its results. */
RtStatus rt_finding_check_piece(const RtExperiment *experiment, const RtFindingPiece *piece, RtError *error);

/* Checks all of them except those of other experiments. */
RtStatus rt_finding_check(const RtExperiment *experiment, const char *text, RtError *error);

/* RT_BAD_INPUT with the first number or general word that stands outside braces. Allowed are numbers in words
 * that begin with a letter (AVX-512, x86-64, density=4), and years in parentheses. */
RtStatus rt_finding_check_bound(const char *text, RtError *error);

#endif
