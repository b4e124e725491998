/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/summary.h"

#include "core/base/words.h"
#include "experiment/claims.h"
#include "experiment/frame_table.h"
#include "experiment/result_tables.h"

void rt_cli_print_summary(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    const bool frames = *experiment->frame.without;
    char null_runs[RT_MAX_SENTENCE], answer[RT_MAX_FRAME_SENTENCE];
    if (frames)
        rt_print_frames(results, out);
    else
        rt_print_results(results, RT_TOTALS, out);
    if (experiment->hardware) rt_print_hardware(results, out);
    rt_print_limits(results, out);
    rt_claims_print(results, out);
    rt_null_sentence(results, null_runs);
    fputc('\n', out);
    if (*null_runs) rt_print_wrapped(null_runs, out);
    for (uint32_t t = 0; frames && t < experiment->workload_count; t++) {
        rt_frame_sentence(results, t, answer);
        if (!*answer) continue;
        fputc('\n', out);
        rt_print_wrapped(answer, out);
    }
}
