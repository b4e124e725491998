/* SPDX-License-Identifier: Apache-2.0 */
/* Raytally's side of an accelerator that lives away: what stands in for it, and what is said of one that
 * broke. See wire.h. */
#include "accel/remote.h"
#include "accel/plugin/futex.h"
#include "accel/plugin/now.h"
#include "core/base/process.h"
#include "accel/plugin/wire.h"
#include "core/base/words.h"

#include "core/base/clock.h"
#include "core/base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

typedef struct Away {
    RtAccel base;
    RtAccelOps ops; /* away_ops, by the name of the base */
    char name[RT_MAX_SPEC_CHARS];
    Wire *wire;
    RtProcess process;
    int alive;       /* the end of a pipe: closed, it ends the process */
    double patience; /* seconds without progress after which it hangs */
    RtDescription description;
    pthread_mutex_t lock;   /* of what follows */
    atomic_bool broken;     /* error says why */
    bool gone;              /* the process has ended, and was waited for */
    bool taken[LANES];      /* by queries; lane 0 is nobody's */
    unsigned asked[LANES];  /* the number of the last request on each lane, of who has it */
    pthread_mutex_t master; /* of lane 0 */
    RtError error;
} Away;

/* What a query has: its lane, and whether it has begun anew since the last request. */
typedef struct RemoteQuery {
    uint32_t lane;
    bool begin;
} RemoteQuery;

static const RtAccelOps away_ops;
static void destroy(RtAccel *accel);

static Away *of(const RtAccel *accel) {
    return (Away *)accel;
}

bool rt_accel_is_remote(const RtAccel *accel) {
    return accel->ops->destroy == destroy;
}

static double patience_of_user(void) {
    if (getenv("RAYTALLY_PLUGIN_WAIT")) return INFINITY; /* for a debugger */
    const char *text = getenv("RAYTALLY_PLUGIN_SECONDS");
    char *end;
    double seconds = text ? strtod(text, &end) : 0;
    return text && end != text && *end == '\0' && seconds > 0 && seconds < 1e6 ? seconds : 60;
}

/* ---- how it ended ---- */

static void say_end(const Away *away, RtProcessEnd end, char *out, size_t room) {
    const Crash *crash = &away->wire->crash;
    static const char *const past[] = {"", ": it wrote or read past the memory of its query",
                                       ": it wrote or read past its answers"};
    uint32_t out_of = crash->out_of;
    rt_process_end_format(end, crash->signal, out_of <= RT_GUARD_COUNT ? past[out_of] : "", out, room);
}

/* "NAME: WHAT while DOING, at the ray ...". The first thing that is said of it stays. */
static void break_remote(Away *away, const char *what, const char *doing, bool ray) {
    char text[RT_RAY_TEXT] = "";
    if (ray && away->wire->crash.has_ray) {
        RtRay traced = away->wire->crash.ray;
        rt_ray_format(&traced, text, sizeof text);
    }
    if (away->broken) return;
    rt_fail(&away->error, RT_BROKEN, "%s: %s while %s%s%s", away->name, what, doing,
            *text ? ", at the ray " : "", text);
    away->broken = true;
}

void rt_remote_break(const RtAccel *accel, const char *what, const char *doing) {
    Away *away = of(accel);
    pthread_mutex_lock(&away->lock);
    break_remote(away, what, doing, false);
    pthread_mutex_unlock(&away->lock);
}

/* Of one that hangs: it is asked at which ray, and ended. */
static void end_hanging(Away *away, const char *doing, double limit) {
    char what[96];
    away->wire->crash.has_ray = false;
    rt_process_signal(&away->process, SIGXCPU);
    rt_process_end(&away->process, 1000);
    away->gone = true;
    snprintf(what, sizeof what, "it made no progress for %g s (RAYTALLY_PLUGIN_SECONDS)", limit);
    break_remote(away, what, doing, true);
}

/* Whether its plugin wrote to the words of a lane, which are known at any time. */
static bool is_overwritten(const Away *away, uint32_t number, unsigned answered) {
    const unsigned asked = away->asked[number];
    return away->wire->lanes[number].asked != asked || (answered != asked && answered != asked - 1);
}

/* Is it broken, has it ended, or hung for longer than it may? */
static bool look_after(Away *away, const char *doing, bool overwritten, double waited, double limit) {
    pthread_mutex_lock(&away->lock);
    RtProcessEnd end;
    if (!away->gone && overwritten) {
        away->gone = true;
        rt_process_end(&away->process, 0);
        break_remote(away, "it overwrote memory that it shares with raytally", doing, false);
    } else if (!away->gone && rt_process_wait(&away->process, 0, &end)) {
        char what[160];
        away->gone = true;
        say_end(away, end, what, sizeof what);
        break_remote(away, what, doing, true);
    } else if (!away->gone && waited > limit) {
        end_hanging(away, doing, limit);
    }
    bool broken = away->broken;
    pthread_mutex_unlock(&away->lock);
    return broken;
}

/* Waits for the answer on a lane; false if there will be none. What is waited for is time in which this
 * process looked: if both were stopped for a while, that was no time. */
static bool wait_for(Away *away, uint32_t number, const char *doing, double limit) {
    const struct timespec some = {.tv_nsec = 50000000};
    atomic_uint *answered = &away->wire->lanes[number].answered;
    unsigned long beat = away->wire->beat;
    double last = rt_wall_seconds(), waited = 0;
    for (;;) {
        unsigned value = atomic_load_explicit(answered, memory_order_acquire);
        bool overwritten = is_overwritten(away, number, value);
        if (!overwritten && value == away->asked[number]) return true;
        if (!overwritten && rt_futex_wait(answered, value, &some) && atomic_load(answered) != value) continue;
        unsigned long seen = away->wire->beat;
        double now = rt_wall_seconds();
        waited = seen == beat ? waited + fmin(now - last, 1) : 0;
        beat = seen;
        last = now;
        if (look_after(away, doing, overwritten, waited, limit)) return false;
    }
}

/* ---- asking ---- */

/* Has a message that lies in its lane answered there. False where it is broken, or breaks now. */
static bool ask_in_place(Away *away, uint32_t number, bool begin, WireWork *work, size_t bytes,
                         const char *doing) {
    Lane *lane = &away->wire->lanes[number];
    if (away->broken) return false;
    lane->work = work;
    lane->bytes = bytes;
    lane->begin = begin;
    rt_futex_set(&lane->asked, ++away->asked[number]);
    return wait_for(away, number, doing, away->patience);
}

/* The same for one that comes from elsewhere, and goes back there only if it was answered. */
static bool ask(Away *away, uint32_t number, bool begin, WireWork *work, void *message, size_t bytes,
                const char *doing) {
    Lane *lane = &away->wire->lanes[number];
    if (bytes > 0) memcpy(lane->message, message, bytes);
    if (!ask_in_place(away, number, begin, work, bytes, doing)) return false;
    if (bytes > 0) memcpy(message, lane->message, bytes);
    return true;
}

static bool ask_master(Away *away, WireWork *work, void *message, size_t bytes, const char *doing) {
    pthread_mutex_lock(&away->master);
    bool answered = ask(away, 0, false, work, message, bytes, doing);
    pthread_mutex_unlock(&away->master);
    return answered;
}

/* What was said over there, which may lack its end, and be no status of ours. */
static RtStatus hand_on(RtStatus status, const char *name, RtError *said, RtError *error) {
    said->message[sizeof said->message - 1] = '\0';
    return rt_fail(error, rt_remote_status(status), "%s%s%s", name, *name ? ": " : "", said->message);
}

static RtStatus why(const Away *away, RtError *error) {
    if (error) *error = away->error;
    return RT_BROKEN;
}

void rt_remote_do(RtQuery *query, RtRemoteWork *work, void *message, size_t bytes) {
    RemoteQuery *own = query->scratch[0].own;
    ask(of(query->accel), own->lane, own->begin, work, message, bytes, "it was traced");
    own->begin = false;
}

/* ---- building ---- */

/* The memory that both have, and the pipe whose end says that raytally is no more. */
static RtStatus connect_away(Away *away, int alive[2], RtError *error) {
    away->wire =
        mmap(NULL, sizeof(Wire), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (away->wire == MAP_FAILED) {
        away->wire = NULL;
        return rt_fail_memory(error, "what is shared with a plugin", sizeof(Wire));
    }
    away->asked[0] = WIRE_BUILD;
    away->wire->lanes[0].asked = WIRE_BUILD;
    if (pipe2(alive, O_CLOEXEC) == 0) return RT_OK;
    return rt_fail(error, RT_IO, "a pipe: %s", strerror(errno));
}

static RtStatus start(Away *away, const RtSpec *spec, int threads, RtError *error) {
    int alive[2] = {-1, -1};
    RT_TRY(connect_away(away, alive, error));
    RtStatus status = rt_process_fork(&away->process, alive[0], error);
    if (status == RT_OK && away->process.pid == 0) rt_wire_serve(away->wire, spec, away->base.scene, threads);
    madvise(away->wire, sizeof(Wire), MADV_DONTFORK); /* other plugins do not get it */
    close(alive[0]);
    away->alive = alive[1];
    return status;
}

/* What was built, or why not. */
static RtStatus take_built(Away *away, RtError *error) {
    char doing[96];
    WireBuilt built;
    snprintf(doing, sizeof doing, "it was built over %u object%s", away->base.scene->geometry.object_count,
             rt_plural(away->base.scene->geometry.object_count));
    if (!wait_for(away, 0, doing, 10 * away->patience)) return why(away, error);
    memcpy(&built, away->wire->lanes[0].message, sizeof built);
    if (built.status != RT_OK) return hand_on(built.status, "", &built.error, error);
    away->base.exact = built.exact != 0;
    away->base.counts = built.counts != 0;
    away->base.build_seconds = built.seconds;
    away->base.build_tally = built.description.build;
    away->description = built.description;
    return RT_OK;
}

RtStatus rt_remote_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                         RtError *error) {
    Away *away = rt_alloc(1, sizeof(Away));
    *out = NULL;
    if (!away) return rt_fail_memory(error, "an accelerator", sizeof(Away));
    *away = (Away){.base = {.ops = &away->ops, .scene = scene, .scratch_room = RT_CACHE_LINE},
                   .ops = away_ops,
                   .alive = -1,
                   .patience = patience_of_user()};
    away->ops.name = spec->layers[spec->layer_count - 1].ops->name;
    pthread_mutex_init(&away->lock, NULL);
    pthread_mutex_init(&away->master, NULL);
    rt_spec_format(spec, away->name);
    RtStatus status = start(away, spec, threads, error);
    if (status == RT_OK) status = take_built(away, error);
    if (status == RT_OK) {
        *out = &away->base;
    } else {
        away->broken = true;
        destroy(&away->base);
    }
    return status;
}

static _Thread_local char exit_message[sizeof(((RtError *)0)->message)];

const char *rt_remote_exit_message(void) {
    return *exit_message ? exit_message : NULL;
}

/* In peace, if it still can: a plugin may crash as it frees what it has. */
static void destroy(RtAccel *accel) {
    Away *away = of(accel);
    if (away->process.pid > 0 && !away->broken) {
        ask_master(away, rt_wire_destroy, NULL, 0, "it was destroyed");
        if (away->broken) snprintf(exit_message, sizeof exit_message, "%s", away->error.message);
    }
    if (away->alive >= 0) close(away->alive); /* ends it */
    rt_process_end(&away->process, 0);
    if (away->wire) munmap(away->wire, sizeof(Wire));
    pthread_mutex_destroy(&away->lock);
    pthread_mutex_destroy(&away->master);
    rt_free(away);
}

/* ---- queries ---- */

static size_t scratch_bytes(const RtAccel *accel) {
    (void)accel;
    return sizeof(RemoteQuery);
}

static uint32_t take_lane(Away *away) {
    uint32_t lane = 1;
    pthread_mutex_lock(&away->lock);
    while (lane < LANES && away->taken[lane]) lane++;
    if (lane < LANES) away->taken[lane] = true;
    pthread_mutex_unlock(&away->lock);
    return lane;
}

static void give_lane_back(Away *away, uint32_t lane) {
    pthread_mutex_lock(&away->lock);
    away->taken[lane] = false;
    pthread_mutex_unlock(&away->lock);
}

static RtStatus open_lane(Away *away, uint32_t lane, RtError *error) {
    WireChecked message = {.lane = lane, .done = away->asked[lane]};
    if (!ask_master(away, rt_wire_open, &message, sizeof message, "a query was opened"))
        return why(away, error);
    if (message.status == RT_OK) return RT_OK;
    return hand_on(RT_BROKEN, away->name, &message.error, error);
}

static RtStatus open_query(const RtAccel *accel, void *scratch, RtError *error) {
    Away *away = of(accel);
    RemoteQuery *query = scratch;
    query->lane = take_lane(away);
    if (query->lane == LANES) {
        return rt_fail(error, RT_BAD_INPUT, "%s: a plugin traces on %d threads at most", away->name,
                       LANES - 1);
    }
    RtStatus status = open_lane(away, query->lane, error);
    if (status != RT_OK) give_lane_back(away, query->lane);
    return status;
}

static void close_query(const RtAccel *accel, void *scratch) {
    const RemoteQuery *query = scratch;
    ask(of(accel), query->lane, false, NULL, NULL, 0, "a query was closed");
    give_lane_back(of(accel), query->lane);
}

static void begin(const RtAccel *accel, void *scratch) {
    (void)accel;
    ((RemoteQuery *)scratch)->begin = true;
}

/* ---- kernels ---- */

/* A stream of at most WIRE_RAYS; returns the answers, which lie in shared memory, or NULL where it broke. */
static const RtHit *trace_some(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,
                               uint32_t count, bool any, RtTally *tallies) {
    Away *away = of(accel);
    RemoteQuery *query = scratch->own;
    WireRays *asked = (WireRays *)away->wire->lanes[query->lane].message;
    char doing[64];
    snprintf(doing, sizeof doing, "it answered a stream of %u ray%s", count, rt_plural(count));
    *asked = (WireRays){.count = count, .any = any, .counted = tallies != NULL};
    memcpy(rt_wire_rays(asked, count), rays, count * sizeof *rays);
    bool begin_anew = query->begin;
    query->begin = false;
    if (!ask_in_place(away, query->lane, begin_anew, rt_wire_trace, rt_wire_rays_bytes(count), doing))
        return NULL;
    for (int kind = 0; kind < RT_RAY_KIND_COUNT && tallies; kind++)
        rt_tally_add(&tallies[kind], &asked->tallies[kind]);
    return asked->hits;
}

/* Answers are looked at where they are written: what is not sound here was changed since. */
static void tell_overwritten(const RtAccel *accel) {
    rt_remote_break(accel, "it overwrote its answers", "it answered a stream");
}

static bool is_object(const RtAccel *accel, uint32_t object) {
    return object < accel->scene->geometry.object_count;
}

static void trace_nearest(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits, RtTally *tallies) {
    for (size_t first = 0; first < count; first += WIRE_RAYS) {
        uint32_t n = (uint32_t)(count - first < WIRE_RAYS ? count - first : WIRE_RAYS);
        const RtHit *answers = trace_some(accel, scratch, rays + first, n, false, tallies);
        if (answers) memcpy(hits + first, answers, n * sizeof(RtHit));
        for (size_t i = first; i < first + n; i++) {
            bool sound = answers && is_object(accel, hits[i].object) && hits[i].t >= rays[i].tmin &&
                         hits[i].t <= rays[i].tmax;
            if (answers && !sound && hits[i].object != RT_NO_OBJECT) tell_overwritten(accel);
            if (!sound) hits[i] = RT_MISS;
        }
    }
}

static void trace_occluded(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                           uint32_t *occluders, RtTally *tallies) {
    for (size_t first = 0; first < count; first += WIRE_RAYS) {
        uint32_t n = (uint32_t)(count - first < WIRE_RAYS ? count - first : WIRE_RAYS);
        const RtHit *answers = trace_some(accel, scratch, rays + first, n, true, tallies);
        for (uint32_t i = 0; i < n; i++) {
            uint32_t *occluder = &occluders[first + i];
            memcpy(occluder, answers ? &answers[i].object : &RT_MISS.object, sizeof *occluder);
            if (is_object(accel, *occluder)) continue;
            if (*occluder != RT_NO_OBJECT) tell_overwritten(accel);
            *occluder = RT_NO_OBJECT;
        }
    }
}

/* What is timed is timed over there: here a counted question differs in its message alone. */
static void nearest(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                    RtHit *hits) {
    trace_nearest(accel, scratch, rays, count, hits, NULL);
}

static void occluded(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     uint32_t *occluders) {
    trace_occluded(accel, scratch, rays, count, occluders, NULL);
}

/* ---- the structure ---- */

static void describe(const RtAccel *accel, RtDescription *out) {
    *out = of(accel)->description;
}

static RtStatus ask_checked(const RtAccel *accel, WireWork *work, const char *doing, RtError *error) {
    Away *away = of(accel);
    WireChecked message = {.status = RT_OK};
    if (!ask_master(away, work, &message, sizeof message, doing)) return why(away, error);
    if (message.status == RT_OK) return RT_OK;
    return hand_on(message.status, message.status == RT_BROKEN ? away->name : "", &message.error, error);
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    RT_TRY(ask_checked(accel, rt_wire_validate, "it was validated", error));
    return ask_checked(accel, rt_wire_show, "it showed its boxes", error);
}

static RtStatus check(const RtAccel *accel, RtError *error) {
    return ask_checked(accel, rt_wire_check, "it was asked how it went", error);
}

/* Broken if not all are shown: rt_accel_check tells. */
static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    Away *away = of(accel);
    WireBoxes *some = rt_alloc(1, sizeof(WireBoxes));
    uint64_t first = 0;
    bool more = some != NULL, all = more;
    while (more) {
        some->first = first;
        if (!ask_master(away, rt_wire_boxes, some, sizeof *some, "it showed its boxes")) break;
        uint32_t count = some->count < WIRE_BOXES ? some->count : WIRE_BOXES;
        for (uint32_t i = 0; i < count; i++) {
            const WireBox *shown = &some->boxes[i];
            if (!rt_wire_is_box(&shown->box, shown->depth)) {
                rt_remote_break(accel, "it overwrote boxes", "it showed them");
                break;
            }
            viewer.show(viewer.context,
                        &(RtBoxView){.box = &shown->box, .depth = shown->depth, .leaf = shown->leaf != 0});
        }
        first += count;
        more = count == WIRE_BOXES && !away->broken && first < UINT32_MAX;
        all = some->complete != 0;
    }
    if (!all) rt_remote_break(accel, "there is no memory for all its boxes", "it showed them");
    rt_free(some);
}

static const RtAccelOps away_ops = {
    .name = "plugin",
    .summary = "stands in for one that lives in a process of its own",
    .paper = "",
    .destroy = destroy,
    .nearest = nearest,
    .occluded = occluded,
    .nearest_counted = trace_nearest,
    .occluded_counted = trace_occluded,
    .scratch_bytes = scratch_bytes,
    .open = open_query,
    .close = close_query,
    .begin = begin,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
    .check = check,
};
