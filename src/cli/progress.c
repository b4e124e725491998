/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/cli.h"

#include "core/base/clock.h"
#include "core/base/words.h"

#include <math.h>
#include <stdio.h>
#include <unistd.h>

static const double LINE_EVERY = 60; /* seconds, where there is no terminal */

void rt_progress_clear(void) {
    if (isatty(STDERR_FILENO)) fputs("\r\033[K", stderr);
}

void rt_progress_notice(void *context, const char *message) {
    (void)context;
    rt_progress_clear();
    fprintf(stderr, "raytally: %s\n", message);
}

/* ---- cells and time ---- */

RtCellCount rt_count_cells(const RtResults *results, const RtWorkloadOptions *options) {
    const RtExperiment *e = results->experiment;
    const bool count_only = options->count_only || e->count_only;
    RtCellCount count = {0, 0};
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) {
        const RtWorkloadResult *workload = &results->workloads[at.workload];
        const bool no_rays = workload->known && !workload->rays[at.kind];
        if (workload->skipped || no_rays || *rt_build_at(results, at.workload, at.candidate)->left_out ||
            *at.cell->left_out || !rt_candidate_runs(e, at.candidate, at.workload) ||
            !rt_selection_has(&options->only, e, at.workload, at.candidate, at.kind))
            continue;
        count.cells++;
        count.finished +=
            at.cell->counted &&
            (at.cell->timed || count_only || !rt_results_times(results, at.workload, at.candidate, at.kind));
    }
    return count;
}

void rt_format_duration(double seconds, char out[RT_MAX_DURATION]) {
    int minutes = (int)fmin(round(seconds / 60), 1e8);
    if (seconds < 90)
        snprintf(out, RT_MAX_DURATION, "%.0f s", seconds);
    else if (minutes < 100)
        snprintf(out, RT_MAX_DURATION, "%d min", minutes);
    else
        snprintf(out, RT_MAX_DURATION, "%d h %d min", minutes / 60, minutes % 60);
}

/* ---- lines ---- */

/* The cells that are left take as long as those measured so far. */
static void show(RtProgress *progress, double now) {
    const RtCellCount *count = &progress->count;
    const uint32_t done = count->finished - progress->before, left = count->cells - count->finished;
    char duration[RT_MAX_DURATION], rest[RT_MAX_DURATION + 16] = "";
    if (done > 0) rt_format_duration((now - progress->start) * left / done, duration);
    if (done > 0) snprintf(rest, sizeof rest, ", about %s left", duration);
    if (progress->terminal)
        fprintf(stderr, "\r\033[K%s[%u/%u] %s%s", progress->title, count->finished, count->cells,
                progress->doing, rest);
    else
        fprintf(stderr, "raytally: %s%u of %u cell%s, %s%s\n", progress->title, count->finished, count->cells,
                rt_plural(count->cells), progress->doing, rest);
    fflush(stderr);
    progress->shown = now;
}

static void describe(RtProgress *progress, const RtResults *results, const RtEvent *event) {
    static const char *const what[] = {[RT_EVENT_WORKLOAD] = "rays recorded",
                                       [RT_EVENT_BUILD] = "built",
                                       [RT_EVENT_COUNT] = "counted",
                                       [RT_EVENT_CHOICE] = "chosen",
                                       [RT_EVENT_TIME] = "timed",
                                       [RT_EVENT_DISTRIBUTION] = "distributed",
                                       [RT_EVENT_RENDER] = "rendered",
                                       [RT_EVENT_NO_BUILD] = "left out",
                                       [RT_EVENT_NO_CELL] = "left out"};
    const RtExperiment *experiment = results->experiment;
    const bool scene = event->what == RT_EVENT_WORKLOAD;
    const bool cell = !scene && event->what != RT_EVENT_BUILD && event->what != RT_EVENT_RENDER &&
                      event->what != RT_EVENT_NO_BUILD;
    char accel[RT_MAX_SHOWN] = "";
    if (!scene) rt_candidate_show(experiment, event->candidate, accel);
    snprintf(progress->doing, sizeof progress->doing, "%s%s%s%s%s: %s",
             experiment->workloads[event->workload].shown, scene ? "" : " ", accel, cell ? " " : "",
             cell ? rt_experiment_kind_name(experiment, event->kind) : "",
             rt_event_is_broken(results, event) ? "is broken" : what[event->what]);
}

static RtStatus on_event(void *context, const RtResults *results, const RtEvent *event, RtError *error) {
    (void)error;
    RtProgress *progress = context;
    double now = rt_wall_seconds();
    progress->count = rt_count_cells(results, &progress->options);
    if (!progress->begun) progress->before = progress->count.finished; /* in earlier runs */
    progress->begun = true;
    describe(progress, results, event);
    if (progress->terminal || now - progress->shown >= progress->every) show(progress, now);
    return RT_OK;
}

void rt_progress_begin(RtProgress *progress, RtWorkloadOptions *options) {
    const double now = rt_wall_seconds();
    *progress = (RtProgress){.terminal = isatty(STDERR_FILENO) == 1,
                             .options = *options,
                             .start = now,
                             .shown = now,
                             .every = LINE_EVERY};
    options->observer = (RtRunObserver){progress, on_event, rt_progress_notice};
}

void rt_progress_end(const RtProgress *progress) {
    if (progress->terminal) fputs("\r\033[K", stderr);
}
