/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/progress.h"

#include "cli/stop.h"
#include "core/base/clock.h"
#include "core/base/words.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <time.h>
#include <unistd.h>

/* Seconds. */
static const double LINE_EVERY = 60, LINE_OF_TERMINAL_EVERY = 1;

RtProgress rt_progress_begin(const RtWorkloadOptions *options) {
    double now = rt_wall_seconds();
    bool terminal = isatty(STDERR_FILENO) == 1;
    return (RtProgress){.terminal = terminal,
                        .options = *options,
                        .start = now,
                        .shown = now,
                        .every = terminal ? LINE_OF_TERMINAL_EVERY : LINE_EVERY};
}

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
            !rt_only_cell(&options->only, e, at.workload, at.candidate, at.kind))
            continue;
        count.cells++;
        count.finished += at.cell->counted && (at.cell->timed || count_only);
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

/* Seconds left if all cells take as long as those measured so far; NAN if there are none. */
static double left_of(const RtProgress *progress, double now) {
    const RtCellCount *count = &progress->count;
    const double done = count->finished - progress->before, left = count->cells - count->finished;
    if (done <= 0) return (double)NAN;
    return fmax((progress->counted - progress->start) * left / done - (now - progress->counted), 0);
}

/* ---- lines ---- */

static void show(RtProgress *progress) {
    const RtCellCount *count = &progress->count;
    double now = rt_wall_seconds(), left = left_of(progress, now);
    char duration[RT_MAX_DURATION], rest[RT_MAX_DURATION + 16] = "";
    rt_format_duration(left, duration);
    if (!isnan(left)) snprintf(rest, sizeof rest, ", about %s left", duration);
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
    if (progress->watched) pthread_mutex_lock(&progress->lock);
    progress->count = rt_count_cells(results, &progress->options);
    progress->counted = now;
    if (!progress->begun) progress->before = progress->count.finished; /* in earlier runs */
    progress->begun = true;
    describe(progress, results, event);
    if (progress->terminal || now - progress->shown >= progress->every) show(progress);
    if (progress->watched) pthread_mutex_unlock(&progress->lock);
    return RT_OK;
}

RtRunObserver rt_progress_observer(RtProgress *progress) {
    return (RtRunObserver){progress, on_event, rt_progress_notice};
}

/* ---- the thread ---- */

/* The journal is always whole. */
static void leave(const RtProgress *progress, int number) {
    rt_progress_clear();
    fprintf(stderr, "raytally: %s%s; ", progress->title, rt_stop_reason(number));
    if (progress->begun) {
        fprintf(stderr, "%u of %u cell%s %s finished, all measurements are kept in %s.",
                progress->count.finished, progress->count.cells, rt_plural(progress->count.cells),
                progress->count.cells == 1 ? "is" : "are", progress->keeps);
    } else {
        fprintf(stderr, "nothing was measured yet, and %s is unchanged.", progress->keeps);
    }
    fprintf(stderr, " To continue:\n  %s\n", progress->go_on);
    rt_stop_clean();
    _exit(rt_stop_code(number));
}

/* Those that the thread takes; SIGUSR2 wakes it. */
static sigset_t signals_taken(void) {
    sigset_t signals = rt_stop_signals();
    sigaddset(&signals, SIGUSR2);
    return signals;
}

static void *watch(void *context) {
    RtProgress *progress = context;
    const struct timespec second = {.tv_sec = 1};
    const sigset_t signals = signals_taken();
    for (;;) {
        int number = sigtimedwait(&signals, NULL, &second);
        pthread_mutex_lock(&progress->lock);
        bool ended = progress->ended;
        if (!ended && number > 0 && number != SIGUSR2) leave(progress, number);
        double since = rt_wall_seconds() - progress->shown;
        if (!ended && progress->begun && since >= progress->every) show(progress);
        pthread_mutex_unlock(&progress->lock);
        if (ended) return NULL;
    }
}

static void block(int how) {
    const sigset_t signals = signals_taken();
    pthread_sigmask(how, &signals, NULL);
}

void rt_progress_watch(RtProgress *progress, const char *directory, const char *go_on) {
    progress->keeps = directory;
    progress->go_on = go_on;
    pthread_mutex_init(&progress->lock, NULL);
    block(SIG_BLOCK);
    progress->watched = pthread_create(&progress->watcher, NULL, watch, progress) == 0;
    if (!progress->watched) block(SIG_UNBLOCK);
}

void rt_progress_end(RtProgress *progress) {
    if (progress->watched) {
        pthread_mutex_lock(&progress->lock);
        progress->ended = true;
        pthread_mutex_unlock(&progress->lock);
        pthread_kill(progress->watcher, SIGUSR2);
        pthread_join(progress->watcher, NULL);
        pthread_mutex_destroy(&progress->lock);
        block(SIG_UNBLOCK);
    }
    if (progress->terminal) fputs("\r\033[K", stderr);
}
