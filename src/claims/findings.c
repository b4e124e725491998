/* SPDX-License-Identifier: Apache-2.0 */
#include "claims/findings.h"

#include "core/base/memory.h"
#include "core/base/words.h"
#include "results/result_directory.h"
#include "results/result_tables.h"

#include <inttypes.h>
#include <string.h>

/* ---- filling in ---- */

/* The results of another experiment, kept for the next expression. */
typedef struct Other {
    const char *directory; /* of this one */
    char name[RT_MAX_WORD];
    RtExperiment *experiment; /* owned */
    RtResults results;
    RtStatus status;
    RtError why;
} Other;

static void close_other(Other *other) {
    rt_results_clear(&other->results);
    rt_free(other->experiment);
    other->experiment = NULL;
    *other->name = '\0';
}

static RtStatus open_other(Other *other, const char *name, RtError *error) {
    char path[RT_MAX_PATH], beside[RT_MAX_PATH];
    if (strcmp(other->name, name) != 0) {
        close_other(other);
        strcpy(other->name, name);
        other->experiment = rt_alloc(1, sizeof *other->experiment);
        if (!other->experiment) return rt_fail_memory(error, "an experiment", sizeof *other->experiment);
        snprintf(beside, sizeof beside, "../%s", name);
        other->status = rt_path_join(other->directory, beside, path, &other->why);
        if (other->status == RT_OK)
            other->status = rt_results_load(path, other->experiment, &other->results, &other->why);
    }
    return other->status == RT_OK ? RT_OK : rt_fail(error, other->status, "%s", other->why.message);
}

static RtStatus judge(const RtResults *results, const RtFindingPiece *piece, Other *other,
                      RtClaimResult *result, RtError *error) {
    const bool elsewhere = *piece->from;
    if (elsewhere) RT_TRY(open_other(other, piece->from, error));
    const RtResults *of = elsewhere ? &other->results : results;
    RT_TRY(rt_finding_check_piece(of->experiment, piece, error));
    return rt_claim_judge_text(of, piece->expression, elsewhere, result, error);
}

static void fill_segment(const RtResults *results, const RtFindingPiece *piece, Other *other,
                         RtFindingSegment *segment) {
    RtClaimResult result;
    RtError why = {RT_OK, ""};
    *segment = (RtFindingSegment){.said = ""};
    rt_append_text(segment->text, RT_MAX_TEXT, "%.*s", (int)piece->length, piece->words);
    if (piece->sort < RT_FINDING_READOUT) return;
    const bool readout = piece->sort == RT_FINDING_READOUT;
    if (judge(results, piece, other, &result, &why) != RT_OK) {
        segment->mark = RT_FINDING_BROKEN;
        segment->said = "no results";
        rt_append_text(segment->text, RT_MAX_TEXT, "%s", readout ? "unknown" : "");
        rt_append_text(segment->note, sizeof segment->note, "%s: %s", piece->expression, why.message);
        return;
    }
    const bool open = readout ? strcmp(result.value, "unknown") == 0 : result.verdict != RT_CLAIM_HOLDS;
    segment->said = !result.measured             ? "no measurements"
                    : readout && !result.whole   ? "values missing"
                    : readout && result.contrary ? "not surely so"
                    : open && readout            ? "undecided"
                    : open                       ? rt_claim_verdict_name(result.verdict)
                                                 : "";
    segment->mark = !result.measured ? RT_FINDING_MISSING
                    : *segment->said ? RT_FINDING_BROKEN
                    : readout        ? RT_FINDING_FIGURE
                                     : RT_FINDING_UPHELD;
    rt_append_text(segment->text, RT_MAX_TEXT, "%s", readout ? result.value : "");
    rt_append_text(segment->note, sizeof segment->note, "%s%s%s: %s, %s", piece->from,
                   *piece->from ? ": " : "", piece->expression, rt_claim_verdict_name(result.verdict),
                   result.figures);
}

RtStatus rt_finding_fill(const RtResults *results, const char *directory, RtFinding *finding,
                         RtError *error) {
    const char *const text = results->experiment->finding;
    RtFindingPiece piece;
    Other other = {.directory = directory};
    uint32_t count = 0;
    *finding = (RtFinding){0};
    for (const char *at = text; rt_finding_next(&at, &piece, NULL);) count++;
    finding->segments = rt_alloc(count ? count : 1, sizeof *finding->segments);
    if (!finding->segments) return rt_fail_memory(error, "a finding", count * sizeof *finding->segments);
    for (const char *at = text; rt_finding_next(&at, &piece, NULL);) {
        RtFindingSegment *segment = &finding->segments[finding->count++];
        fill_segment(results, &piece, &other, segment);
        finding->broken += segment->mark == RT_FINDING_BROKEN;
    }
    close_other(&other);
    return RT_OK;
}

void rt_finding_clear(RtFinding *finding) {
    rt_free(finding->segments);
    *finding = (RtFinding){0};
}

char *rt_finding_text(const RtFinding *finding) {
    const size_t size = (size_t)finding->count * (RT_MAX_TEXT + 32) + 1;
    char *text = rt_alloc(size, 1);
    for (uint32_t i = 0; text && i < finding->count; i++) {
        const RtFindingSegment *segment = &finding->segments[i];
        const bool said = *segment->said;
        rt_append_text(text, size, "%s%s%s%s", segment->text, said ? " [" : "", segment->said,
                       said ? "]" : "");
    }
    return text;
}

/* ---- verdicts on papers ---- */

const char *rt_paper_problem(const RtResults *results, const RtPaper *paper) {
    uint32_t holds = 0;
    RtClaimResult result;
    if (paper->verdict == RT_PAPER_UNJUDGED || paper->verdict >= RT_PAPER_NOT_TESTED) return "";
    if (paper->claim_count == 0) return "it names no claims that it rests on";
    for (uint32_t i = 0; i < paper->claim_count; i++) {
        rt_claim_judge(results, paper->first_claim + i, &result);
        holds += result.verdict == RT_CLAIM_HOLDS || result.verdict == RT_CLAIM_FIGURE;
    }
    const bool all = holds == paper->claim_count;
    if (paper->verdict == RT_PAPER_CONFIRMED) return all ? "" : "not all of its claims hold";
    if (paper->verdict == RT_PAPER_IN_PART)
        return all ? "all of its claims hold" : holds == 0 ? "none of its claims holds" : "";
    return all ? "all of its claims hold" : "";
}

/* ---- text ---- */

/* Calls rt_finding_fill, and notes what does not hold; returns how many do not. */
static uint32_t print_broken(const RtResults *results, const RtFinding *finding, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    uint32_t wrong = finding->broken;
    for (uint32_t i = 0; i < finding->count; i++) {
        const RtFindingSegment *segment = &finding->segments[i];
        if (segment->mark >= RT_FINDING_MISSING && out)
            fprintf(out, "  %-15s  %s\n  %-15s  %s\n", segment->said, segment->text, "", segment->note);
    }
    for (uint32_t i = 0; i < experiment->paper_count; i++) {
        const RtPaper *paper = &experiment->papers[i];
        const char *problem = rt_paper_problem(results, paper);
        if (!*problem) continue;
        wrong++;
        if (out)
            fprintf(out, "  %-15s  '%s' for %s: %s\n", "not supported", rt_paper_verdict_name(paper->verdict),
                    paper->citation, problem);
    }
    return wrong;
}

void rt_findings_print(const RtResults *results, const char *directory, FILE *out) {
    RtFinding finding;
    if (rt_finding_fill(results, directory, &finding, NULL) != RT_OK) return;
    char *text = rt_finding_text(&finding);
    if (text && *text) {
        fprintf(out, "\nFinding%s:\n", rt_claims_variant(results->experiment));
        rt_print_wrapped(text, out);
    }
    print_broken(results, &finding, out);
    rt_free(text);
    rt_finding_clear(&finding);
}

RtStatus rt_findings_check(const RtResults *results, const char *directory, RtError *error) {
    RtFinding finding;
    RT_TRY(rt_claims_check(results, error));
    RT_TRY(rt_finding_fill(results, directory, &finding, error));
    const uint32_t wrong = print_broken(results, &finding, NULL);
    rt_finding_clear(&finding);
    if (wrong == 0) return RT_OK;
    return rt_fail(error, RT_MISMATCH,
                   "%" PRIu32 " expression%s of the finding or verdicts on papers do not hold", wrong,
                   rt_plural(wrong));
}

void rt_print_summary(const RtResults *results, const char *directory, FILE *out) {
    rt_print_outcome(results, out);
    rt_claims_print(results, out);
    rt_findings_print(results, directory, out);
    rt_print_null_runs(results, out);
}
