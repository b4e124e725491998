/* SPDX-License-Identifier: Apache-2.0 */
/* The first failure is kept; later ones follow from it. */
#include "accel/plugin/watch.h"

#include "accel/plugin/host.h"
#include "core/base/clock.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>

enum { RT_PLACE_TEXT = RT_RAY_TEXT + 96 };

/* Writes ", at the ray ...", or of which stream, to out[0..size). A hung process has shown the ray if it
 * prepared any; one that crashed may have been at another ray than the last that it prepared. */
static void format_place(const RtWatched *child, bool hung, char *out, size_t size) {
    char text[RT_RAY_TEXT];
    const Crash *crash = &child->wire->crash;
    const uint32_t count = crash->count, last = crash->ray;
    *out = '\0';
    if (count == 0 || count > WIRE_RAYS || last >= count) return;
    const bool known = count == 1 || (hung && last > 0);
    const uint32_t found = known ? last : child->find_ray ? child->find_ray(child) : RT_FAILS_SOMEHOW;
    const RtRay ray = crash->rays[found < count ? found : last];
    rt_ray_format(&ray, text, sizeof text);
    if (found < count)
        snprintf(out, size, ", at the ray %s", text);
    else
        snprintf(out, size, "%s %s%s",
                 last > 0 ? ", after it prepared the ray" : "; the stream begins with the ray", text,
                 found == RT_FAILS_TOGETHER ? "; no ray of the stream fails alone" : "");
}

/* "NAME: WHAT while DOING, WHERE". Only the first failure is kept. */
static void set_broken(RtWatched *child, const char *what, const char *doing, const char *where) {
    if (child->broken) return;
    rt_fail(&child->error, RT_BROKEN, "%s: %s while %s%s", child->name, what, doing, where);
    child->broken = true;
}

void rt_watched_break(RtWatched *child, const char *what, const char *doing) {
    pthread_mutex_lock(&child->lock);
    set_broken(child, what, doing, "");
    pthread_mutex_unlock(&child->lock);
}

static void report_end(RtWatched *child, RtProcessEnd end, const char *doing) {
    static const char *const past[1 + RT_GUARD_COUNT] = {
        "", ": it wrote or read past the memory of its query", ": it wrote or read past its answers"};
    const uint32_t out_of = child->wire->crash.out_of;
    char what[160], where[RT_PLACE_TEXT];
    rt_process_end_format(end, child->wire->crash.signal, out_of <= RT_GUARD_COUNT ? past[out_of] : "", what,
                          sizeof what);
    rt_usage_ended(&child->usage, &end);
    format_place(child, false, where, sizeof where);
    set_broken(child, what, doing, where);
}

/* SIGXCPU makes a hung process record its ray. */
static void end_hung(RtWatched *child, const char *doing, double limit) {
    char what[96], where[RT_PLACE_TEXT];
    child->wire->crash.count = 0;
    rt_process_signal(&child->process, SIGXCPU);
    rt_process_end(&child->process, 1000);
    snprintf(what, sizeof what, "it made no progress for %g s (RAYTALLY_PLUGIN_SECONDS)", limit);
    format_place(child, true, where, sizeof where);
    set_broken(child, what, doing, where);
}

/* Whether the plugin overwrote the words of a channel, whose values are always known. */
static bool is_overwritten(const RtWatched *child, uint32_t number, unsigned answered) {
    const unsigned asked = child->asked[number];
    return child->wire->channels[number].asked != asked || (answered != asked && answered != asked - 1);
}

/* Whether a structure exceeds the limit as it is built is no fault; later it is. */
static void end_large(RtWatched *child, const char *doing, uint64_t bytes) {
    char what[128];
    rt_process_end(&child->process, 0);
    snprintf(what, sizeof what, "its process used %.4g MB of memory, more than %.4g MB (--memory),",
             1e-6 * (double)bytes, 1e-6 * (double)child->usage.limit);
    set_broken(child, what, doing, "");
    if (child->asked[0] == WIRE_BUILD) child->error.status = RT_BAD_INPUT;
}

/* Ends a process that overwrote shared memory, holds too much memory or hangs. Returns whether the
 * accelerator is broken. */
static bool check_process(RtWatched *child, const char *doing, bool overwritten, double waited,
                          double limit) {
    pthread_mutex_lock(&child->lock);
    RtProcessEnd end;
    uint64_t bytes;
    if (!child->ended) {
        child->ended = true;
        if (overwritten) {
            rt_process_end(&child->process, 0);
            set_broken(child, "it overwrote memory that it shares with raytally", doing, "");
        } else if (rt_process_wait(&child->process, 0, &end)) {
            report_end(child, end, doing);
        } else if (rt_usage_exceeds_limit(&child->usage, &child->process, &bytes)) {
            end_large(child, doing, bytes);
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

/* A plugin may take memory in many short requests, too. */
static bool is_checked(const RtWatched *child, uint32_t number) {
    return child->usage.limit < UINT64_MAX && (number == 0 || child->asked[number] % 64 == 1);
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
        if (!overwritten && value == child->asked[number])
            return !is_checked(child, number) || !check_process(child, doing, false, 0, limit);
        if (!overwritten && rt_futex_wait(answered, value, &some) && atomic_load(answered) != value) continue;
        unsigned long seen = child->wire->progress;
        double now = rt_wall_seconds();
        waited = seen == progress ? waited + fmin(now - last, 1) : 0;
        progress = seen;
        last = now;
        if (check_process(child, doing, overwritten, waited, limit)) return false;
    }
}
