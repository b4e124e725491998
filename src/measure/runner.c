/* SPDX-License-Identifier: Apache-2.0 */
/* Runners of accelerators, local and remote, and timing accelerators against each other. A remote runner has
 * a counterpart in the accelerator's process; the counterpart holds the rays. */
#include "measure/measure.h"

#include "accel/remote.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/random.h"

#include <math.h>
#include <string.h>
#include <xxhash.h>

typedef struct Remote {
    RtQuery query;
    struct Counterpart *counterpart; /* an address of the other process */
} Remote;

typedef struct Counterpart {
    RtRunner runner;
    RtRaySet set;
    XXH64_hash_t rays; /* hash of the rays when they were complete */
} Counterpart;

typedef struct Message {
    Counterpart *counterpart;
    RtStatus status;
    RtError error;
    RtRayKind kind;
    uint64_t count; /* rays in all */
    int threads;
    uint32_t repeats;
    double seconds, wall;
    uint64_t first, some; /* rays of the set: first..first + some - 1 */
} Message;

/* ---- in the accelerator's process ---- */

static XXH64_hash_t hash_rays(const RtRaySet *set) {
    return XXH3_64bits(set->rays, set->count * sizeof(RtRay));
}

static void create(RtQuery *query, const RtRay *rays, void *message) {
    (void)query, (void)rays;
    Message *m = message;
    m->counterpart = rt_alloc(1, sizeof(Counterpart));
    m->status = m->counterpart ? rt_rayset_init(&m->counterpart->set, m->kind, m->count, &m->error)
                               : rt_fail_memory(&m->error, "a runner", sizeof(Counterpart));
}

static void take_rays(RtQuery *query, const RtRay *rays, void *message) {
    (void)query;
    Message *m = message;
    memcpy(m->counterpart->set.rays + m->first, rays, m->some * sizeof(RtRay));
}

static void open_counterpart(RtQuery *query, const RtRay *rays, void *message) {
    (void)rays;
    Message *m = message;
    RtTimed timed = {.accel = query->accel, .set = &m->counterpart->set};
    m->counterpart->rays = hash_rays(&m->counterpart->set);
    m->status = rt_runner_open_local(&m->counterpart->runner, &timed, m->threads, &m->error);
}

/* The accelerator could change the rays, so they are checked. */
static void time_counterpart(RtQuery *query, const RtRay *rays, void *message) {
    (void)query, (void)rays;
    Message *m = message;
    m->status = rt_runner_time(&m->counterpart->runner, m->repeats, &m->seconds, &m->wall, &m->error);
    if (m->status == RT_OK && hash_rays(&m->counterpart->set) != m->counterpart->rays)
        m->status = rt_fail(&m->error, RT_BROKEN, "it wrote to the rays that it was given");
}

static void destroy(RtQuery *query, const RtRay *rays, void *message) {
    (void)query, (void)rays;
    Message *m = message;
    if (!m->counterpart) return;
    rt_runner_close_local(&m->counterpart->runner);
    rt_rayset_clear(&m->counterpart->set);
    rt_free(m->counterpart);
    m->counterpart = NULL;
}

/* ---- in this process ---- */

/* Runs `work` there. Returns its failure, or RT_BROKEN if the accelerator is broken. */
static RtStatus request(Remote *remote, RtRemoteWork *work, const RtRay *rays, Message *message,
                        RtError *error) {
    message->counterpart = remote->counterpart;
    message->status = RT_OK;
    rt_remote_do(&remote->query, work, rays, rays ? message->some : 0, message, sizeof *message);
    remote->counterpart = message->counterpart;
    message->error.message[sizeof message->error.message - 1] = '\0';
    if (message->status > RT_OK && message->status <= RT_IO && message->status != RT_BROKEN)
        return rt_fail(error, message->status, "%s", message->error.message);
    if (message->status != RT_OK)
        rt_remote_break(remote->query.accel, message->error.message, "it was timed");
    return rt_accel_check(remote->query.accel, error);
}

static bool is_amount(double value) {
    return isfinite(value) && value >= 0;
}

static RtStatus time_remote(void *context, uint32_t repeats, double *seconds, double *wall, RtError *error) {
    Remote *remote = context;
    Message message = {.repeats = repeats};
    RT_TRY(request(remote, time_counterpart, NULL, &message, error));
    *seconds = message.seconds;
    *wall = message.wall;
    if (is_amount(*seconds) && is_amount(*wall)) return RT_OK;
    rt_remote_break(remote->query.accel, "it overwrote the times", "it was timed");
    return rt_accel_check(remote->query.accel, error);
}

static RtStatus run_remote(void *context, RtError *error) {
    double seconds, wall;
    return time_remote(context, 1, &seconds, &wall, error);
}

static RtStatus open_remote(Remote *remote, const RtTimed *timed, int threads, RtError *error) {
    enum { RAYS_A_MESSAGE = 4096 };
    const RtRaySet *set = timed->set;
    Message message = {.kind = set->kind, .count = set->count, .threads = threads};
    RT_TRY(rt_query_init(&remote->query, timed->accel, error));
    RT_TRY(request(remote, create, NULL, &message, error));
    for (message.first = 0; message.first < set->count; message.first += message.some) {
        uint64_t left = set->count - message.first;
        message.some = left < RAYS_A_MESSAGE ? left : RAYS_A_MESSAGE;
        RT_TRY(request(remote, take_rays, set->rays + message.first, &message, error));
    }
    return request(remote, open_counterpart, NULL, &message, error);
}

RtStatus rt_runner_open(RtRunner *runner, const RtTimed *timed, int threads, RtError *error) {
    if (!rt_accel_is_remote(timed->accel)) return rt_runner_open_local(runner, timed, threads, error);
    Remote *remote = rt_alloc(1, sizeof(Remote));
    *runner = (RtRunner){.run = run_remote,
                         .time = time_remote,
                         .context = remote,
                         .work = (double)timed->set->count,
                         .parallel = rt_thread_count(threads) > 1,
                         .seconds = timed->seconds,
                         .wall = timed->wall,
                         .broken = timed->broken};
    return remote ? open_remote(remote, timed, threads, error)
                  : rt_fail_memory(error, "a runner", sizeof(Remote));
}

void rt_runner_close(RtRunner *runner) {
    Remote *remote = runner->context;
    Message message = {0};
    if (!runner->time) {
        rt_runner_close_local(runner);
        return;
    }
    if (remote && remote->query.accel) {
        request(remote, destroy, NULL, &message, NULL);
        rt_query_clear(&remote->query);
    }
    rt_free(remote);
    *runner = (RtRunner){0};
}

/* ---- timing ---- */

typedef struct TimingRun {
    const RtTiming *timing;
    RtTimed *timed;    /* [count] */
    RtRunner *runners; /* [count] */
    size_t *order;     /* [count] in which they are opened: what is opened first lies first in memory */
    size_t count;
    RtRandom random;
} TimingRun;

static RtStatus open_runners(TimingRun *run, RtError *error) {
    rt_random_shuffle(&run->random, run->order, run->count);
    for (size_t k = 0; k < run->count; k++) {
        const size_t i = run->order[k];
        const RtRunner before = run->runners[i];
        RtStatus status = RT_BROKEN;
        if (run->timed[i].accel)
            status = rt_runner_open(&run->runners[i], &run->timed[i], run->timing->threads, error);
        run->runners[i].repeats = before.repeats;
        run->runners[i].once = before.once;
        run->runners[i].broken = run->timed[i].broken;
        if (status != RT_BROKEN || !run->timed[i].broken) RT_TRY(status);
        if (status == RT_BROKEN) *run->timed[i].broken = true;
    }
    return RT_OK;
}

static void close_runners(TimingRun *run) {
    for (size_t i = 0; i < run->count; i++) {
        const RtRunner before = run->runners[i];
        run->timed[i].repeats = before.repeats;
        rt_runner_close(&run->runners[i]);
        run->runners[i].repeats = before.repeats;
        run->runners[i].once = before.once;
    }
}

static RtStatus renew_runners(void *context, RtError *error) {
    TimingRun *run = context;
    close_runners(run);
    RT_TRY(run->timing->renew(run->timing->rounds.context, run->timed, run->count, error));
    return open_runners(run, error);
}

RtStatus rt_measure_time(RtTimed *timed, size_t count, const RtTiming *timing, uint32_t *done,
                         RtError *error) {
    TimingRun run = {.timing = timing,
                     .timed = timed,
                     .runners = rt_alloc(count, sizeof(RtRunner)),
                     .order = rt_alloc(count, sizeof(size_t)),
                     .count = count,
                     .random = rt_random(timing->rounds.seed, 1)};
    RtRounds rounds = timing->rounds;
    rounds.renew = timing->renew ? renew_runners : NULL;
    rounds.renew_context = &run;
    RtStatus status = run.runners && run.order
                          ? RT_OK
                          : rt_fail_memory(error, "the rounds", count * (sizeof(RtRunner) + sizeof(size_t)));
    if (status == RT_OK) {
        for (size_t i = 0; i < count; i++) run.order[i] = i;
        status = open_runners(&run, error);
        if (status == RT_OK) status = rt_rounds_run(run.runners, count, &rounds, done, error);
        close_runners(&run);
    }
    rt_free(run.runners);
    rt_free(run.order);
    return status;
}
