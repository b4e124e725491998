/* SPDX-License-Identifier: Apache-2.0 */
/* All claims of an experiment: as an exit code, and as text. */
#include "claims/claims.h"

#include "core/base/words.h"
#include "results/result_tables.h"

#include <inttypes.h>

RtStatus rt_claims_check(const RtResults *results, RtError *error) {
    const RtExperiment *experiment = results->experiment;
    uint32_t wrong = 0, first = 0, claims = 0;
    RtClaimResult result;
    for (uint32_t i = experiment->claim_count; i-- > 0;) {
        rt_claim_judge(results, i, &result);
        claims += result.verdict != RT_CLAIM_FIGURE;
        if (result.verdict != RT_CLAIM_FALSE) continue;
        first = i;
        wrong++;
    }
    if (wrong == 0) return RT_OK;
    return rt_fail(error, RT_MISMATCH, "%" PRIu32 " of %" PRIu32 " claims do not hold, the first: %s", wrong,
                   claims, experiment->claims[first]);
}

void rt_claims_level(const RtResults *results, char out[RT_MAX_CLAIM_LEVEL]) {
    uint32_t count;
    const double coverage = rt_claims_coverage(results, &count);
    out[0] = '\0';
    if (count > 1)
        rt_append_text(out, RT_MAX_CLAIM_LEVEL,
                       "The %" PRIu32 " intervals of tracing times in these claims hold together with 95 %% "
                       "confidence: each covers %.6g %%.",
                       count, 100 * coverage);
}

static void print_dropped(void *context, const char *claim) {
    fprintf(context, "  %-15s  %s\n", "dropped since", claim);
}

void rt_claims_print(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    char level[RT_MAX_CLAIM_LEVEL];
    bool open = false;
    if (experiment->claim_count)
        fprintf(out, "\nClaims%s:\n",
                experiment->quick ? " (made for the full experiment; this is its --quick variant)" : "");
    for (uint32_t i = 0; i < experiment->claim_count; i++) {
        RtClaimResult result;
        rt_claim_judge(results, i, &result);
        fprintf(out, "  %-15s  %s%s\n  %-15s  %s\n", rt_claim_verdict_name(result.verdict),
                experiment->claims[i], rt_claim_is_later(results, i) ? " [" RT_CLAIM_LATER "]" : "", "",
                result.figures);
        open |= result.verdict == RT_CLAIM_UNDECIDED;
    }
    rt_claims_dropped(results, print_dropped, out);
    if (open)
        fprintf(out,
                "  undecided: the interval includes the bound, a value is missing, fewer than %d rays were "
                "measured, or no crossover is certain\n",
                RT_CLAIM_RAYS);
    rt_claims_level(results, level);
    if (*level) fprintf(out, "  %s\n", level);
}

void rt_print_summary(const RtResults *results, FILE *out) {
    rt_print_outcome(results, out);
    rt_claims_print(results, out);
    rt_print_null_runs(results, out);
}
