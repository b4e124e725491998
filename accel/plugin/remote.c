/* SPDX-License-Identifier: Apache-2.0 */
/* Remote accelerators in raytally's own process: an RtAccel that sends requests. See wire.h. */
#include "accel/remote.h"
#include "accel/plugin/watch.h"
#include "core/base/memory.h"
#include "core/base/observe.h"
#include "core/base/words.h"

#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

typedef struct Remote {
    RtAccel base;
    RtAccelOps ops; /* remote_ops, with the name of the topmost plugin */
    RtWatched child;
    RtSpec spec;
    int threads;  /* to build with */
    int pipe_end; /* the process ends when this is closed */
    RtDescription description;
    bool used[CHANNELS];    /* by queries, under child.lock; channel 0 by none */
    pthread_mutex_t master; /* of channel 0 */
} Remote;

typedef struct RemoteQuery {
    uint32_t channel;
    bool begin; /* rt_query_begin was called since the last request */
} RemoteQuery;

static const RtAccelOps remote_ops;
static void destroy(RtAccel *accel);

static Remote *of(const RtAccel *accel) {
    return (Remote *)accel;
}

bool rt_accel_is_remote(const RtAccel *accel) {
    return accel->ops->destroy == destroy;
}

static double time_limit_of_user(void) {
    if (getenv("RAYTALLY_PLUGIN_WAIT")) return INFINITY; /* for a debugger */
    const char *text = getenv("RAYTALLY_PLUGIN_SECONDS");
    char *end;
    double seconds = text ? strtod(text, &end) : 0;
    return text && end != text && *end == '\0' && seconds > 0 && seconds < 1e6 ? seconds : 60;
}

void rt_remote_break(const RtAccel *accel, const char *what, const char *doing) {
    rt_watched_break(&of(accel)->child, what, doing);
}

/* ---- requests ---- */

typedef struct Request {
    RtRemoteWork *work;
    void *message; /* changes only if there is an answer; NULL: it lies in the channel */
    size_t bytes;
    const RtRay *rays; /* [ray_count] */
    size_t ray_count;
    bool begin;
    const char *doing;
} Request;

/* False if the accelerator is broken, or breaks now. */
static bool request(Remote *remote, uint32_t number, const Request *r) {
    Channel *channel = &remote->child.wire->channels[number];
    if (remote->child.broken) return false;
    if (r->message) memcpy(channel->message, r->message, r->bytes);
    if (r->ray_count) memcpy(rt_wire_rays(channel->message, r->bytes), r->rays, r->ray_count * sizeof(RtRay));
    channel->work = r->work;
    channel->bytes = r->bytes;
    channel->rays = r->ray_count;
    channel->begin = r->begin;
    rt_futex_set(&channel->asked, ++remote->child.asked[number]);
    if (!rt_watched_wait(&remote->child, number, r->doing, remote->child.time_limit)) return false;
    if (r->message) memcpy(r->message, channel->message, r->bytes);
    return true;
}

static bool request_master(Remote *remote, RtRemoteWork *work, void *message, size_t bytes,
                           const char *doing) {
    pthread_mutex_lock(&remote->master);
    bool answered =
        request(remote, 0, &(Request){.work = work, .message = message, .bytes = bytes, .doing = doing});
    pthread_mutex_unlock(&remote->master);
    return answered;
}

/* Takes an error from the process, whose text names the accelerator unless it is `unnamed`. It may lack its
 * end, or be missing, and its status may be invalid. */
static RtStatus forward(const Remote *remote, RtStatus status, bool unnamed, RtError *from, RtError *error) {
    from->message[sizeof from->message - 1] = '\0';
    const char *why = *from->message ? from->message : "it failed and sent no reason";
    unnamed |= !*from->message;
    return rt_fail(error, status > RT_OK && status <= RT_IO ? status : RT_BROKEN, "%s%s%s",
                   unnamed ? remote->child.name : "", unnamed ? ": " : "", why);
}

static RtStatus fail_broken(const Remote *remote, RtError *error) {
    if (error) *error = remote->child.error;
    return remote->child.error.status;
}

/* A request to channel 0 whose message is a WireChecked. */
static RtStatus request_check(Remote *remote, RtRemoteWork *work, WireChecked *message, const char *doing,
                              RtError *error) {
    if (!request_master(remote, work, message, sizeof *message, doing)) return fail_broken(remote, error);
    if (message->status == RT_OK) return RT_OK;
    return forward(remote, message->status, message->status == RT_BROKEN, &message->error, error);
}

bool rt_remote_do(RtQuery *query, RtRemoteWork *work, const RtRay *rays, size_t count, void *message,
                  size_t bytes) {
    if (!rt_accel_is_remote(query->accel)) {
        work(query, rays, message);
        return true;
    }
    RemoteQuery *own = query->scratch[0].own;
    bool answered = request(of(query->accel), own->channel,
                            &(Request){work, message, bytes, rays, count, own->begin, "it was traced"});
    own->begin = false;
    return answered;
}

/* ---- building ---- */

static RtStatus start(Remote *remote, RtError *error) {
    int ends[2];
    Wire *wire =
        mmap(NULL, sizeof(Wire), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (wire == MAP_FAILED) return rt_fail_memory(error, "memory shared with a plugin", sizeof(Wire));
    remote->child.wire = wire;
    remote->child.asked[0] = WIRE_BUILD;
    wire->channels[0].asked = WIRE_BUILD;
    if (pipe2(ends, O_CLOEXEC) != 0) return rt_fail(error, RT_IO, "a pipe: %s", strerror(errno));
    rt_usage_begin(&remote->child.usage, remote->ops.name);
    RtStatus status = rt_process_fork(&remote->child.process, ends[0], error);
    if (status == RT_OK && remote->child.process.pid == 0)
        rt_wire_serve(wire, &remote->spec, remote->base.scene, remote->threads);
    madvise(wire, sizeof(Wire), MADV_DONTFORK); /* other plugins must not have it */
    close(ends[0]);
    remote->pipe_end = ends[1];
    return status;
}

static RtStatus take_built(Remote *remote, double limit, RtError *error) {
    char doing[96];
    WireBuilt built;
    snprintf(doing, sizeof doing, "it was built over %u object%s", remote->base.scene->geometry.object_count,
             rt_plural(remote->base.scene->geometry.object_count));
    if (!rt_watched_wait(&remote->child, 0, doing, limit)) return fail_broken(remote, error);
    memcpy(&built, remote->child.wire->channels[0].message, sizeof built);
    if (built.status != RT_OK) return forward(remote, built.status, false, &built.error, error);
    /* The process has checked its description; an invalid one here was overwritten. */
    if (!(built.seconds >= 0 && built.seconds < INFINITY) || rt_description_impossible(&built.description)) {
        rt_watched_break(&remote->child, "it overwrote its description", doing);
        return fail_broken(remote, error);
    }
    remote->base.exact = built.exact != 0;
    remote->base.absolute = built.absolute != 0;
    remote->base.counts = built.counts != 0;
    remote->base.build_seconds = built.seconds;
    remote->base.build_tally = built.description.build;
    remote->description = built.description;
    rt_usage_built(&remote->child.usage, &remote->child.process, built.description.bytes);
    return RT_OK;
}

/* Gives up after `limit` seconds without progress. */
static RtStatus build(const RtSpec *spec, const RtScene *scene, int threads, double limit, RtAccel **out,
                      RtError *error) {
    Remote *remote = rt_alloc(1, sizeof(Remote));
    *out = NULL;
    if (!remote) return rt_fail_memory(error, "an accelerator", sizeof(Remote));
    *remote = (Remote){.base = {.ops = &remote->ops, .scene = scene, .scratch_bytes = sizeof(RemoteQuery)},
                       .ops = remote_ops,
                       .spec = *spec,
                       .threads = threads,
                       .pipe_end = -1,
                       .child.time_limit = time_limit_of_user()};
    const RtSpecLayer *plugin = spec->layers;
    while (!plugin->ops->remote) plugin++;
    remote->ops.name = plugin->ops->name;
    pthread_mutex_init(&remote->child.lock, NULL);
    pthread_mutex_init(&remote->master, NULL);
    rt_spec_format(spec, remote->child.name);
    RtStatus status = start(remote, error);
    if (status == RT_OK) status = take_built(remote, limit, error);
    if (status == RT_OK) {
        *out = &remote->base;
    } else {
        remote->child.broken = true;
        rt_accel_destroy(&remote->base);
    }
    return status;
}

/* In a fresh process, without the overlays above the plugin: traces each ray by itself, until the process
 * fails. The search takes at most the time limit to build, and MOST_SECONDS to trace. */
static uint32_t find_ray(const RtWatched *child) {
    enum { MOST_SECONDS = 10 };
    const Remote *remote = (const Remote *)((const char *)child - offsetof(Remote, child));
    const Crash *crash = &child->wire->crash;
    const WireAlone stream = {.count = crash->count, .any = crash->any, .counted = crash->counted};
    const uint32_t layers = crash->layers, all = remote->spec.layer_count;
    RtSpec spec = {.layer_count = layers};
    RtAccel *accel;
    RtQuery query;
    uint32_t found = RT_FAILS_SOMEHOW;
    if (isinf(child->time_limit) || stream.count > WIRE_RAYS || layers == 0 || layers > all) return found;
    memcpy(spec.layers, remote->spec.layers + (all - layers), layers * sizeof *spec.layers);
    if (!spec.layers[0].ops->remote ||
        build(&spec, remote->base.scene, remote->threads, child->time_limit, &accel, NULL) != RT_OK)
        return found;
    RtWatched *fresh = &of(accel)->child;
    fresh->time_limit = fmin(fresh->time_limit, MOST_SECONDS);
    if (rt_query_init(&query, accel, NULL) == RT_OK) {
        WireAlone message = stream;
        bool survived =
            rt_remote_do(&query, rt_wire_trace_alone, crash->rays, stream.count, &message, sizeof message);
        found = survived ? RT_FAILS_TOGETHER : fresh->wire->crash.alone;
        rt_query_clear(&query);
    }
    rt_accel_destroy(accel);
    return found;
}

RtStatus rt_remote_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                         RtError *error) {
    RT_TRY(build(spec, scene, threads, 10 * time_limit_of_user(), out, error));
    of(*out)->child.find_ray = find_ray;
    return RT_OK;
}

static _Thread_local char exit_message[sizeof(((RtError *)0)->message)];

const char *rt_remote_exit_message(void) {
    return *exit_message ? exit_message : NULL;
}

/* A plugin may crash while it frees its memory. */
static void destroy(RtAccel *accel) {
    Remote *remote = of(accel);
    if (remote->child.process.pid > 0 && !remote->child.broken) {
        rt_usage_traced(&remote->child.usage, &remote->child.process);
        if (request_master(remote, rt_wire_destroy, NULL, 0, "it was destroyed"))
            rt_usage_destroyed(&remote->child.usage, &remote->child.process);
        if (remote->child.broken)
            snprintf(exit_message, sizeof exit_message, "%s", remote->child.error.message);
    }
    if (remote->child.process.pid > 0) {
        RtProcessEnd end;
        rt_process_signal(&remote->child.process, SIGKILL);
        rt_process_wait(&remote->child.process, -1, &end);
        rt_usage_ended(&remote->child.usage, &end);
    }
    if (remote->pipe_end >= 0) close(remote->pipe_end);
    if (remote->child.wire) munmap(remote->child.wire, sizeof(Wire));
    pthread_mutex_destroy(&remote->child.lock);
    pthread_mutex_destroy(&remote->master);
}

/* ---- queries ---- */

static void release_channel(Remote *remote, uint32_t channel) {
    pthread_mutex_lock(&remote->child.lock);
    remote->used[channel] = false;
    pthread_mutex_unlock(&remote->child.lock);
}

static RtStatus open_query(const RtAccel *accel, void *scratch, RtError *error) {
    Remote *remote = of(accel);
    uint32_t channel = 1;
    pthread_mutex_lock(&remote->child.lock);
    while (channel < CHANNELS && remote->used[channel]) channel++;
    if (channel < CHANNELS) remote->used[channel] = true;
    pthread_mutex_unlock(&remote->child.lock);
    if (channel == CHANNELS)
        return rt_fail(error, RT_BAD_INPUT, "%s: a plugin traces on at most %d threads", remote->child.name,
                       CHANNELS - 1);
    ((RemoteQuery *)scratch)->channel = channel;
    WireChecked message = {.channel = channel, .done = remote->child.asked[channel]};
    RtStatus status = request_check(remote, rt_wire_open, &message, "a query was opened", error);
    if (status == RT_OK) return RT_OK;
    release_channel(remote, channel);
    if (status != RT_BROKEN) forward(remote, RT_BROKEN, true, &message.error, error);
    return RT_BROKEN;
}

static void close_query(const RtAccel *accel, void *scratch) {
    const RemoteQuery *query = scratch;
    request(of(accel), query->channel, &(Request){.doing = "a query was closed"});
    release_channel(of(accel), query->channel);
}

static void begin(const RtAccel *accel, void *scratch) {
    (void)accel;
    ((RemoteQuery *)scratch)->begin = true;
}

/* ---- kernels ---- */

/* Each layer may count as much for a ray as a plugin may. */
static bool are_possible(const RtTally *counts, size_t rays) {
    bool possible = true;
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++)
        possible &= rt_count_is_possible(rt_tally_get(counts, i), rays * RT_MAX_LAYERS);
    return possible;
}

static void add_tallies(const RtAccel *accel, const RtTally *sent, size_t rays, RtTally *tallies) {
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        RtTally counts;
        memcpy(&counts, &sent[kind], sizeof counts);
        if (are_possible(&counts, rays))
            rt_tally_add(&tallies[kind], &counts);
        else
            rt_remote_break(accel, "it overwrote its counts", "it answered a stream");
    }
}

/* Traces at most WIRE_RAYS rays. The process has checked its answers; an invalid one here was overwritten. */
static void trace_part(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, uint32_t count,
                       bool any, RtHit *hits, RtTally *tallies) {
    Remote *remote = of(accel);
    RemoteQuery *query = scratch->own;
    WireRays *message = (WireRays *)remote->child.wire->channels[query->channel].message;
    char doing[64];
    snprintf(doing, sizeof doing, "it answered a stream of %u ray%s", count, rt_plural(count));
    *message = (WireRays){.count = count, .any = any, .counted = tallies != NULL};
    const Request traced = {.work = rt_wire_trace,
                            .bytes = sizeof(WireRays) + count * sizeof(RtHit),
                            .rays = rays,
                            .ray_count = count,
                            .begin = query->begin,
                            .doing = doing};
    query->begin = false;
    if (!request(remote, query->channel, &traced)) {
        for (uint32_t i = 0; i < count; i++) hits[i] = RT_MISS;
        return;
    }
    if (tallies) add_tallies(accel, message->tallies, count, tallies);
    memcpy(hits, message->hits, count * sizeof *hits);
    for (uint32_t i = 0; i < count; i++) {
        if (any ? rt_occluder_is_possible(accel, hits[i].object)
                : rt_hit_is_possible(accel, &rays[i], hits[i]))
            continue;
        rt_remote_break(accel, "it overwrote its answers", "it answered a stream");
        hits[i] = RT_MISS;
    }
}

/* Traces a ray again for its events, as often as it takes to send them, to the observer of this thread. */
static void observe(const RtAccel *accel, const RtScratch *scratch, const RtRay *ray, bool any) {
    Remote *remote = of(accel);
    const RemoteQuery *query = scratch->own;
    WireEvents *message = (WireEvents *)remote->child.wire->channels[query->channel].message;
    uint32_t count = WIRE_EVENTS;
    for (uint64_t first = 0; count == WIRE_EVENTS && first < UINT32_MAX; first += count) {
        message->first = first;
        message->any = any;
        if (!request(remote, query->channel,
                     &(Request){.work = rt_wire_events,
                                .bytes = sizeof(WireEvents),
                                .rays = ray,
                                .ray_count = 1,
                                .begin = true,
                                .doing = "it traced a ray step by step"}))
            return;
        count = message->count;
        count = count < WIRE_EVENTS ? count : WIRE_EVENTS;
        for (uint32_t i = 0; i < count; i++) rt_wire_observe(&message->events[i]);
    }
}

/* One of `hits` and `occluders` is NULL. */
static void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                  RtHit *hits, uint32_t *occluders, RtTally *tallies) {
    RtHit some[WIRE_RAYS];
    for (size_t first = 0; first < count; first += WIRE_RAYS) {
        uint32_t n = (uint32_t)(count - first < WIRE_RAYS ? count - first : WIRE_RAYS);
        trace_part(accel, scratch, rays + first, n, !hits, hits ? hits + first : some, tallies);
        for (uint32_t i = 0; i < n && occluders; i++) occluders[first + i] = some[i].object;
    }
    for (size_t i = 0; i < count && RT_OBSERVED(tallies); i++) observe(accel, scratch, &rays[i], !hits);
}

/* The process times itself, so here a timed kernel is a counted one without tallies. */
#define DEFINE_KERNELS(question, Answer, hits, occluders)                                                    \
    static void question(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,    \
                         Answer *answers) {                                                                  \
        trace(accel, scratch, rays, count, hits, occluders, NULL);                                           \
    }                                                                                                        \
    static void count_##question(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,          \
                                 size_t count, Answer *answers, RtTally *tallies) {                          \
        trace(accel, scratch, rays, count, hits, occluders, tallies);                                        \
    }
DEFINE_KERNELS(nearest, RtHit, answers, NULL)
DEFINE_KERNELS(occluded, uint32_t, NULL, answers)

/* ---- the structure ---- */

static void describe(const RtAccel *accel, RtDescription *out) {
    *out = of(accel)->description;
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    WireChecked message = {.status = RT_OK};
    RT_TRY(request_check(of(accel), rt_wire_validate, &message, "it was validated", error));
    return request_check(of(accel), rt_wire_show, &message, "it showed its boxes", error);
}

static RtStatus check(const RtAccel *accel, RtError *error) {
    WireChecked message = {.status = RT_OK};
    return request_check(of(accel), rt_wire_check, &message, "it was checked after tracing", error);
}

/* The accelerator breaks if not all boxes could be shown; rt_accel_check reports it. */
static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    Remote *remote = of(accel);
    WireBoxes *some = rt_alloc(1, sizeof(WireBoxes));
    uint64_t first = 0;
    bool more = some != NULL, all = more;
    while (more) {
        some->first = first;
        if (!request_master(remote, rt_wire_boxes, some, sizeof *some, "it showed its boxes")) break;
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
        more = count == WIRE_BOXES && !remote->child.broken && first < UINT32_MAX;
        all = some->complete != 0;
    }
    if (!all) rt_remote_break(accel, "there is no memory for all its boxes", "it showed them");
    rt_free(some);
}

static const RtAccelOps remote_ops = {
    .name = "plugin",
    .summary = "represents an accelerator in another process",
    .paper = "",
    .destroy = destroy,
    .nearest = nearest,
    .occluded = occluded,
    .nearest_counted = count_nearest,
    .occluded_counted = count_occluded,
    .open = open_query,
    .close = close_query,
    .begin = begin,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
    .check = check,
};
