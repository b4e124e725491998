/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/measure_remote.h"

#include "accel/remote.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "measure/measure_local.h"

#include <math.h>
#include <string.h>
#include <xxhash.h>

/* A runner here, and its like over there. */
typedef struct Remote {
    RtQuery query;
    struct RemoteRunner *there; /* an address of the other process */
} Remote;

typedef struct RemoteRunner {
    RtRunner runner;
    RtRaySet set;
    XXH64_hash_t rays; /* the hash of what the set had */
} RemoteRunner;

/* What crosses over. */
enum { RAYS_A_MESSAGE = 4096 };
typedef struct RemoteMessage {
    RemoteRunner *there;
    RtStatus status;
    RtError error;
    RtRayKind kind;
    uint64_t count;   /* rays in all */
    int threads;      /* of a pass */
    uint32_t repeats; /* of it */
    double seconds, wall;
    uint64_t first; /* of rays[0..some) in the set */
    uint32_t some;
    RtRay rays[RAYS_A_MESSAGE];
} RemoteMessage;

/* All but the rays. */
enum { HEAD = offsetof(RemoteMessage, rays) };

static void close_there(RtQuery *query, void *message) {
    (void)query;
    RemoteMessage *m = message;
    if (!m->there) return;
    rt_runner_close_here(&m->there->runner);
    rt_rayset_clear(&m->there->set);
    rt_free(m->there);
    m->there = NULL;
}

static void make_set_there(RtQuery *query, void *message) {
    (void)query;
    RemoteMessage *m = message;
    m->there = rt_alloc(1, sizeof(RemoteRunner));
    m->status = m->there ? rt_rayset_init(&m->there->set, m->kind, m->count, &m->error)
                         : rt_fail_memory(&m->error, "a runner", sizeof(RemoteRunner));
}

static void take_rays_there(RtQuery *query, void *message) {
    (void)query;
    RemoteMessage *m = message;
    memcpy(m->there->set.rays + m->first, m->rays, m->some * sizeof(RtRay));
}

static XXH64_hash_t hash_rays(const RtRaySet *set) {
    return XXH3_64bits(set->rays, set->count * sizeof(RtRay));
}

static void open_there(RtQuery *query, void *message) {
    RemoteMessage *m = message;
    RtTimed timed = {.accel = query->accel, .set = &m->there->set};
    m->there->rays = hash_rays(&m->there->set);
    m->status = rt_runner_open_here(&m->there->runner, &timed, m->threads, &m->error);
}

/* On the rays that it was to be timed on, and no others: they lie within its reach. */
static void time_there(RtQuery *query, void *message) {
    (void)query;
    RemoteMessage *m = message;
    m->status = rt_runner_time(&m->there->runner, m->repeats, &m->seconds, &m->wall, &m->error);
    if (m->status == RT_OK && hash_rays(&m->there->set) != m->there->rays)
        m->status = rt_fail(&m->error, RT_BROKEN, "it wrote to the rays that it was given");
}

/* Has it done there; what that came to, or why the accelerator is broken. */
static RtStatus remote_do(Remote *remote, RtRemoteWork *work, RemoteMessage *message, size_t bytes,
                          RtError *error) {
    message->there = remote->there;
    message->status = RT_OK;
    rt_remote_do(&remote->query, work, message, bytes);
    remote->there = message->there;
    RtStatus status = rt_remote_status(message->status);
    if (status == RT_OK) return rt_accel_check(remote->query.accel, error);
    message->error.message[sizeof message->error.message - 1] = '\0';
    if (status != RT_BROKEN) return rt_fail(error, status, "%s", message->error.message);
    rt_remote_break(remote->query.accel, message->error.message, "it was timed");
    return rt_accel_check(remote->query.accel, error);
}

static bool is_duration(double seconds) {
    return isfinite(seconds) && seconds >= 0;
}

static RtStatus time_remote(void *context, uint32_t repeats, double *seconds, double *wall, RtError *error) {
    RemoteMessage message; /* of which the rays stay unset */
    message.repeats = repeats;
    RT_TRY(remote_do(context, time_there, &message, HEAD, error));
    if (!is_duration(message.seconds) || !is_duration(message.wall)) {
        const RtAccel *accel = ((const Remote *)context)->query.accel;
        rt_remote_break(accel, "it overwrote the times", "it was timed");
        return rt_accel_check(accel, error);
    }
    *seconds = message.seconds;
    *wall = message.wall;
    return RT_OK;
}

static RtStatus run_remote(void *context, RtError *error) {
    double seconds, wall;
    return time_remote(context, 1, &seconds, &wall, error);
}

static RtStatus send_rays(Remote *remote, const RtRaySet *set, RemoteMessage *message, RtError *error) {
    message->kind = set->kind;
    message->count = set->count;
    RT_TRY(remote_do(remote, make_set_there, message, HEAD, error));
    for (uint64_t first = 0; first < set->count; first += RAYS_A_MESSAGE) {
        uint64_t left = set->count - first, some = left < RAYS_A_MESSAGE ? left : RAYS_A_MESSAGE;
        message->first = first;
        message->some = (uint32_t)some;
        memcpy(message->rays, set->rays + first, some * sizeof(RtRay));
        RT_TRY(remote_do(remote, take_rays_there, message, HEAD + some * sizeof(RtRay), error));
    }
    return RT_OK;
}

RtStatus rt_runner_open_away(RtRunner *runner, const RtTimed *timed, int threads, RtError *error) {
    Remote *remote = rt_alloc(1, sizeof(Remote));
    RemoteMessage *message = rt_alloc(1, sizeof(RemoteMessage));
    *runner = (RtRunner){.run = run_remote,
                         .time = time_remote,
                         .context = remote,
                         .work = (double)timed->set->count,
                         .parallel = rt_thread_count(threads) > 1,
                         .seconds = timed->seconds,
                         .wall = timed->wall,
                         .broken = timed->broken};
    RtStatus status = remote && message ? RT_OK : rt_fail_memory(error, "a runner", sizeof(RemoteMessage));
    if (status == RT_OK) status = rt_query_init(&remote->query, timed->accel, error);
    if (status == RT_OK) status = send_rays(remote, timed->set, message, error);
    if (status == RT_OK) {
        message->threads = threads;
        status = remote_do(remote, open_there, message, HEAD, error);
    }
    rt_free(message);
    return status;
}

void rt_runner_close_away(RtRunner *runner) {
    Remote *remote = runner->context;
    RemoteMessage message;
    if (remote && remote->query.accel) {
        remote_do(remote, close_there, &message, HEAD, NULL);
        rt_query_clear(&remote->query);
    }
    rt_free(remote);
    *runner = (RtRunner){0};
}
