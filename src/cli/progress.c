/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/progress.h"

#include "base/clock.h"

#include <stdio.h>
#include <unistd.h>

RtProgress rt_progress_begin(const RtExperiment *experiment, uint32_t parts) {
    uint32_t candidates = 0; /* on each scene */
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++)
            candidates += rt_candidate_runs(experiment, c, t);
    }
    return (RtProgress){.terminal = isatty(STDERR_FILENO) == 1,
                        .all = experiment->kind_count * candidates * parts,
                        .start = rt_wall_seconds()};
}

static RtStatus on_event(void *context, const RtResults *results, const RtEvent *event, RtError *error) {
    (void)error;
    RtProgress *progress = context;
    const RtExperiment *experiment = results->experiment;
    bool null = event->candidate == experiment->candidate_count;
    bool cell = event->what == RT_EVENT_COUNT || event->what == RT_EVENT_TIME;
    progress->done += cell && !null;
    if (!progress->terminal) return RT_OK;
    double passed = rt_wall_seconds() - progress->start;
    double left = progress->done ? passed / progress->done * (progress->all - progress->done) : 0;
    fprintf(stderr, "\r\033[K[%u/%u] %s", progress->done, progress->all,
            experiment->workloads[event->workload].label);
    if (event->what != RT_EVENT_WORKLOAD)
        fprintf(stderr, " %s", rt_candidate_label(experiment, event->candidate));
    if (cell) fprintf(stderr, " %s", rt_experiment_kind_name(experiment, event->kind));
    fprintf(stderr, event->what == RT_EVENT_WORKLOAD ? ": rays recorded"
                    : event->what == RT_EVENT_BUILD  ? ": built"
                    : event->what == RT_EVENT_COUNT  ? ": counted"
                                                     : ": timed");
    if (progress->done) fprintf(stderr, ", about %.0f s left", left);
    fflush(stderr);
    return RT_OK;
}

static void on_notice(void *context, const char *message) {
    const RtProgress *progress = context;
    fprintf(stderr, "%sraytally: %s\n", progress->terminal ? "\r\033[K" : "", message);
}

RtObserver rt_progress_observer(RtProgress *progress) {
    return (RtObserver){progress, on_event, on_notice};
}

void rt_progress_end(RtProgress *progress) {
    if (progress->terminal) fputs("\r\033[K", stderr);
}
