/* SPDX-License-Identifier: Apache-2.0 */
/* Chunks are traced by all threads, each with a query of its own. The passes of plugins are timed in their
 * process, by what is below. */
#include "accel/pass.h"

#include "accel/plugin.h"
#include "core/base/clock.h"
#include "core/base/parallel.h"

#include <string.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

RtStatus rt_pass_init(RtPass *pass, const RtAccel *accel, const RtRay *rays, size_t count, bool any,
                      int threads, bool counted, RtError *error) {
    const size_t answer = any ? sizeof(bool) : sizeof(RtHit);
    *pass = (RtPass){.rays = rays, .count = count, .threads = rt_thread_count(threads)};
    pass->queries = rt_alloc((size_t)pass->threads, sizeof *pass->queries);
    if (counted) pass->tallies = rt_alloc((size_t)pass->threads, sizeof *pass->tallies);
    if (any)
        pass->blocked = rt_alloc_unset(count, answer);
    else
        pass->hits = rt_alloc_unset(count, answer);
    if (!pass->queries || (counted && !pass->tallies) || (!pass->hits && !pass->blocked))
        return rt_fail_memory(error, "the answers to a ray set", count * answer);
    for (int i = 0; i < pass->threads; i++) RT_TRY(rt_query_init(&pass->queries[i], accel, error));
    return RT_OK;
}

void rt_pass_clear(RtPass *pass) {
    for (int i = 0; pass->queries && i < pass->threads; i++) rt_query_clear(&pass->queries[i]);
    rt_free(pass->queries);
    rt_free(pass->tallies);
    rt_free(pass->hits);
    rt_free(pass->blocked);
    *pass = (RtPass){0};
}

void rt_pass_trace(RtPass *pass, int thread, size_t first, size_t count) {
    RtQuery *query = &pass->queries[thread];
    RtTally *tallies = pass->tallies ? pass->tallies[thread] : NULL;
    rt_remote_progress();
    rt_query_begin(query);
    if (pass->blocked)
        rt_occluded(query, pass->rays + first, count, pass->blocked + first, tallies);
    else
        rt_nearest(query, pass->rays + first, count, pass->hits + first, tallies);
}

static RtStatus trace_chunk(void *context, size_t item, int thread, RtError *error) {
    (void)error;
    RtPass *pass = context;
    const size_t first = item * RT_PASS_CHUNK, left = pass->count - first;
    rt_pass_trace(pass, thread, first, left < RT_PASS_CHUNK ? left : RT_PASS_CHUNK);
    return RT_OK;
}

/* Chunk by chunk also on a single thread: counts may depend on where chunks begin. */
RtStatus rt_pass_run(RtPass *pass, RtError *error) {
    const size_t chunks = (pass->count + RT_PASS_CHUNK - 1) / RT_PASS_CHUNK;
    if (pass->threads == 1) {
        for (size_t chunk = 0; chunk < chunks; chunk++) RT_TRY(trace_chunk(pass, chunk, 0, error));
    } else {
        RT_TRY(rt_parallel_for(chunks, pass->threads, trace_chunk, pass, error));
    }
    return rt_accel_check(pass->queries[0].accel, error);
}

/* ---- timed passes of a remote accelerator, in its process, which holds the rays and the answers ---- */

/* In the process of the accelerator. */
typedef struct TimedPass {
    RtPass pass;
    RtRay *rays;       /* [pass.count] */
    XXH64_hash_t hash; /* of the rays */
} TimedPass;

struct RtRemotePass {
    RtQuery query;
    TimedPass *there; /* an address of the other process, or NULL */
};

typedef struct Message {
    TimedPass *there;
    uint64_t count, first, some; /* rays in all; those sent: first..first + some - 1 */
    bool any;
    int threads;
    uint32_t repeats;
    double seconds, wall;
} Message;

/* ---- in the accelerator's process ---- */

static RtStatus add_rays(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    Message *m = message;
    if (m->first == 0) m->there = rt_alloc(1, sizeof(TimedPass));
    if (m->first == 0 && m->there) m->there->rays = rt_alloc_unset(m->count, sizeof(RtRay));
    TimedPass *timed = m->there;
    if (!timed || !timed->rays) return rt_fail_memory(error, "a ray set", m->count * sizeof(RtRay));
    memcpy(timed->rays + m->first, rays, m->some * sizeof(RtRay));
    if (m->first + m->some < m->count) return RT_OK;
    timed->hash = XXH3_64bits(timed->rays, m->count * sizeof(RtRay));
    return rt_pass_init(&timed->pass, query->accel, timed->rays, m->count, m->any, m->threads, false, error);
}

/* The accelerator could change the rays, so they are checked. */
static RtStatus time_pass(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)query, (void)rays;
    Message *m = message;
    RtPass *pass = &m->there->pass;
    const double wall = rt_wall_seconds(), processor = rt_thread_seconds();
    for (uint32_t i = 0; i < m->repeats; i++) RT_TRY(rt_pass_run(pass, error));
    m->wall = rt_wall_seconds() - wall;
    m->seconds = pass->threads > 1 ? m->wall : rt_thread_seconds() - processor;
    if (XXH3_64bits(pass->rays, pass->count * sizeof(RtRay)) == m->there->hash) return RT_OK;
    return rt_fail(error, RT_BROKEN, "it wrote to the rays that it was given while it was timed");
}

static RtStatus destroy(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)query, (void)rays, (void)error;
    TimedPass *timed = ((Message *)message)->there;
    rt_pass_clear(&timed->pass);
    rt_free(timed->rays);
    rt_free(timed);
    return RT_OK;
}

/* ---- in raytally's ---- */

static RtStatus request(RtRemotePass *pass, RtRemoteWork *work, const RtRay *rays, Message *m,
                        RtError *error) {
    m->there = pass->there;
    RtStatus status = rt_remote_do(&pass->query, work, rays, m->some, m, sizeof *m, error);
    pass->there = m->there;
    return status;
}

RtStatus rt_remote_pass_open(RtRemotePass **out, const RtAccel *accel, const RtRay *rays, size_t count,
                             bool any, int threads, RtError *error) {
    RtRemotePass *pass = *out = rt_alloc(1, sizeof(RtRemotePass));
    Message message = {.count = count, .any = any, .threads = threads};
    if (!pass) return rt_fail_memory(error, "a pass", sizeof(RtRemotePass));
    RT_TRY(rt_query_init(&pass->query, accel, error));
    for (; message.first < count; message.first += message.some) {
        const uint64_t left = count - message.first;
        message.some = left < RT_REMOTE_RAYS ? left : RT_REMOTE_RAYS;
        RT_TRY(request(pass, add_rays, rays + message.first, &message, error));
    }
    return RT_OK;
}

RtStatus rt_remote_pass_time(RtRemotePass *pass, uint32_t repeats, double *seconds, double *wall,
                             RtError *error) {
    Message message = {.repeats = repeats};
    RT_TRY(request(pass, time_pass, NULL, &message, error));
    *seconds = message.seconds;
    *wall = message.wall;
    if (*seconds >= 0 && *seconds < INFINITY && *wall >= 0 && *wall < INFINITY) return RT_OK;
    rt_remote_break(pass->query.accel, "it overwrote the times", "it was timed");
    return rt_accel_check(pass->query.accel, error);
}

void rt_remote_pass_close(RtRemotePass *pass) {
    Message message = {.some = 0};
    if (pass && pass->there) request(pass, destroy, NULL, &message, NULL);
    if (pass && pass->query.accel) rt_query_clear(&pass->query);
    rt_free(pass);
}
