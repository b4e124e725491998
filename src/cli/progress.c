#include "cli/progress.h"

#include "base/clock.h"

#include <stdio.h>
#include <unistd.h>

RtProgress rt_progress_begin(const RtExperiment *experiment, uint32_t parts) {
    uint32_t contenders = 0;
    for (uint32_t c = 0; c < experiment->contender_count; c++)
        contenders += !experiment->contenders[c].missing;
    return (RtProgress){.terminal = isatty(STDERR_FILENO) == 1,
                        .all = experiment->trial_count * experiment->kind_count * contenders * parts,
                        .start = rt_wall_seconds()};
}

void rt_progress_event(RtProgress *progress, const RtResults *results, const RtEvent *event) {
    const RtExperiment *experiment = results->experiment;
    bool null = event->contender == experiment->contender_count;
    bool cell = event->what == RT_EVENT_COUNT || event->what == RT_EVENT_TIME;
    progress->done += cell && !null;
    if (!progress->terminal) return;
    double passed = rt_wall_seconds() - progress->start;
    double left = progress->done ? passed / progress->done * (progress->all - progress->done) : 0;
    fprintf(stderr, "\r\033[K[%u/%u] %s", progress->done, progress->all,
            experiment->trials[event->trial].label);
    if (event->what != RT_EVENT_TRIAL)
        fprintf(stderr, " %s", rt_contender_label(experiment, event->contender));
    if (cell) fprintf(stderr, " %s", rt_ray_kind_name(event->kind));
    fprintf(stderr, event->what == RT_EVENT_TRIAL   ? ": rays recorded"
                    : event->what == RT_EVENT_BUILD ? ": built"
                    : event->what == RT_EVENT_COUNT ? ": counted"
                                                    : ": timed");
    if (progress->done) fprintf(stderr, ", about %.0f s left", left);
    fflush(stderr);
}

void rt_progress_notice(RtProgress *progress, const char *message) {
    fprintf(stderr, "%sraytally: %s\n", progress->terminal ? "\r\033[K" : "", message);
}

void rt_progress_end(RtProgress *progress) {
    if (progress->terminal) fputs("\r\033[K", stderr);
}
