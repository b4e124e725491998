/* SPDX-License-Identifier: Apache-2.0 */
/* The first failure is kept; later ones follow from it. */
#include "accel/plugin/watch.h"

#include "accel/plugin/host.h"
#include "core/base/clock.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>

/* "NAME: WHAT while DOING, at the ray ...". Only the first failure is kept. */
static void set_broken(RtWatched *child, const char *what, const char *doing, bool ray) {
    char text[RT_RAY_TEXT] = "";
    if (ray && child->wire->crash.has_ray) {
        RtRay traced = child->wire->crash.ray;
        rt_ray_format(&traced, text, sizeof text);
    }
    if (child->broken) return;
    rt_fail(&child->error, RT_BROKEN, "%s: %s while %s%s%s", child->name, what, doing,
            *text ? ", at the ray " : "", text);
    child->broken = true;
}

void rt_watched_break(RtWatched *child, const char *what, const char *doing) {
    pthread_mutex_lock(&child->lock);
    set_broken(child, what, doing, false);
    pthread_mutex_unlock(&child->lock);
}

static void report_end(RtWatched *child, RtProcessEnd end, const char *doing) {
    static const char *const past[1 + RT_GUARD_COUNT] = {
        "", ": it wrote or read past the memory of its query", ": it wrote or read past its answers"};
    const uint32_t out_of = child->wire->crash.out_of;
    char what[160];
    rt_process_end_format(end, child->wire->crash.signal, out_of <= RT_GUARD_COUNT ? past[out_of] : "", what,
                          sizeof what);
    set_broken(child, what, doing, true);
}

/* SIGXCPU makes a hung process record its ray. */
static void end_hung(RtWatched *child, const char *doing, double limit) {
    char what[96];
    child->wire->crash.has_ray = false;
    rt_process_signal(&child->process, SIGXCPU);
    rt_process_end(&child->process, 1000);
    snprintf(what, sizeof what, "it made no progress for %g s (RAYTALLY_PLUGIN_SECONDS)", limit);
    set_broken(child, what, doing, true);
}

/* Whether the plugin overwrote the words of a channel, whose values are always known. */
static bool is_overwritten(const RtWatched *child, uint32_t number, unsigned answered) {
    const unsigned asked = child->asked[number];
    return child->wire->channels[number].asked != asked || (answered != asked && answered != asked - 1);
}

/* Ends a process that overwrote shared memory or hangs. Returns whether the accelerator is broken. */
static bool check_process(RtWatched *child, const char *doing, bool overwritten, double waited,
                          double limit) {
    pthread_mutex_lock(&child->lock);
    RtProcessEnd end;
    if (!child->ended) {
        child->ended = true;
        if (overwritten) {
            rt_process_end(&child->process, 0);
            set_broken(child, "it overwrote memory that it shares with raytally", doing, false);
        } else if (rt_process_wait(&child->process, 0, &end)) {
            report_end(child, end, doing);
        } else if (waited > limit) {
            end_hung(child, doing, limit);
        } else {
            child->ended = false;
        }
    }
    bool broken = child->broken;
    pthread_mutex_unlock(&child->lock);
    return broken;
}

/* Each pause counts for at most a second: both processes may have been stopped. */
bool rt_watched_wait(RtWatched *child, uint32_t number, const char *doing, double limit) {
    const struct timespec some = {.tv_nsec = 50000000};
    atomic_uint *answered = &child->wire->channels[number].answered;
    unsigned long progress = child->wire->progress;
    double last = rt_wall_seconds(), waited = 0;
    for (;;) {
        unsigned value = atomic_load_explicit(answered, memory_order_acquire);
        bool overwritten = is_overwritten(child, number, value);
        if (!overwritten && value == child->asked[number]) return true;
        if (!overwritten && rt_futex_wait(answered, value, &some) && atomic_load(answered) != value) continue;
        unsigned long seen = child->wire->progress;
        double now = rt_wall_seconds();
        waited = seen == progress ? waited + fmin(now - last, 1) : 0;
        progress = seen;
        last = now;
        if (check_process(child, doing, overwritten, waited, limit)) return false;
    }
}
