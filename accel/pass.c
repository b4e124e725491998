/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/pass.h"

#include "accel/remote.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

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
