/* SPDX-License-Identifier: Apache-2.0 */
/* A ray set is cut into chunks of CHUNK rays, which threads take in turn. A chunk begins with rt_query_begin,
 * so counts do not depend on the number of threads. */
#include "measure/measure.h"

#include "accel/remote.h"
#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "measure/rounds.h"

#include <string.h>

/* Rays of a work item. */
enum { CHUNK = 4096 };

/* Rays traced at a time while warming up. */
enum { MOST_WARM = 256 };

/* One pass of an accelerator over a ray set. Either `hits` or `blocked` takes the answers. */
typedef struct Pass {
    const RtRaySet *set;
    RtQuery *queries; /* [threads] */
    int threads;
    RtHit *hits;
    bool *blocked;
    RtTally (*tallies)[RT_RAY_KIND_COUNT]; /* [threads], or NULL: the timed kernels */
} Pass;

static void pass_clear(Pass *pass) {
    for (int i = 0; pass->queries && i < pass->threads; i++) rt_query_clear(&pass->queries[i]);
    rt_free(pass->queries);
    rt_free(pass->tallies);
    rt_free(pass->hits);
    rt_free(pass->blocked);
    *pass = (Pass){0};
}

/* Everything a pass needs, so that nothing is allocated while it runs. Clear it also after a failure. */
static RtStatus pass_init(Pass *pass, const RtAccel *accel, const RtRaySet *set, int threads, bool counted,
                          RtError *error) {
    *pass = (Pass){.set = set, .threads = rt_thread_count(threads)};
    size_t count = set->count, answer = rt_ray_kind_is_any_hit(set->kind) ? sizeof(bool) : sizeof(RtHit);
    pass->queries = rt_alloc((size_t)pass->threads, sizeof *pass->queries);
    if (counted) pass->tallies = rt_alloc((size_t)pass->threads, sizeof *pass->tallies);
    if (rt_ray_kind_is_any_hit(set->kind)) {
        pass->blocked = rt_alloc_unset(count, answer);
    } else {
        pass->hits = rt_alloc_unset(count, answer);
    }
    if (!pass->queries || (counted && !pass->tallies) || (!pass->hits && !pass->blocked)) {
        return rt_fail_memory(error, "the answers to a ray set", count * answer);
    }
    for (int i = 0; i < pass->threads; i++) RT_TRY(rt_query_init(&pass->queries[i], accel, error));
    return RT_OK;
}

static void trace(Pass *pass, int thread, size_t first, size_t count) {
    const RtRay *rays = pass->set->rays + first;
    rt_remote_progress();
    rt_query_begin(&pass->queries[thread]);
    RtTally *tallies = pass->tallies ? pass->tallies[thread] : NULL;
    if (pass->blocked) {
        rt_occluded(&pass->queries[thread], rays, count, pass->blocked + first, tallies);
    } else {
        rt_nearest(&pass->queries[thread], rays, count, pass->hits + first, tallies);
    }
}

static RtStatus trace_chunk(void *context, size_t item, int thread, RtError *error) {
    (void)error;
    Pass *pass = context;
    size_t first = item * CHUNK, left = pass->set->count - first;
    trace(pass, thread, first, left < CHUNK ? left : CHUNK);
    return RT_OK;
}

/* Chunk by chunk also on a single thread: counts may depend on where chunks begin. */
static RtStatus run_pass(void *context, RtError *error) {
    Pass *pass = context;
    size_t chunks = (pass->set->count + CHUNK - 1) / CHUNK;
    if (pass->threads == 1) {
        for (size_t chunk = 0; chunk < chunks; chunk++) RT_TRY(trace_chunk(pass, chunk, 0, error));
    } else {
        RT_TRY(rt_parallel_for(chunks, pass->threads, trace_chunk, pass, error));
    }
    return rt_accel_check(pass->queries[0].accel, error);
}

/* ---- counting ---- */

RtStatus rt_measure_answers(const RtAccel *accel, const RtRaySet *set, int threads, RtHit *hits,
                            RtError *error) {
    /* `nearest` also for shadow and occlusion rays: a hit is then known by its object. */
    RtRaySet nearest = *set;
    nearest.kind = RT_RAY_PRIMARY;
    Pass pass;
    RtStatus status = pass_init(&pass, accel, &nearest, threads, false, error);
    if (status == RT_OK) status = run_pass(&pass, error);
    if (status == RT_OK) memcpy(hits, pass.hits, set->count * sizeof(RtHit));
    pass_clear(&pass);
    return status;
}

static bool answers_agree(const Pass *pass, size_t i, RtHit expected) {
    if (pass->blocked) return pass->blocked[i] == (expected.object != RT_NO_OBJECT);
    return memcmp(&pass->hits[i], &expected, sizeof expected) == 0;
}

/* One pass by the counted kernel or the timed one. */
static RtStatus compare_pass(const RtAccel *accel, const RtRaySet *set, const RtHit *expected, int threads,
                             bool counted, RtCount *count, RtError *error) {
    *count = (RtCount){0};
    Pass pass;
    RtStatus status = pass_init(&pass, accel, set, threads, counted, error);
    double start = rt_wall_seconds();
    if (status == RT_OK) status = run_pass(&pass, error);
    count->seconds = rt_wall_seconds() - start;
    count->timed_kernel = !counted;
    for (int i = 0; status == RT_OK && counted && i < pass.threads; i++)
        rt_tally_add(&count->tally, &pass.tallies[i][set->kind]);
    const char *overflown = rt_tally_overflown(&count->tally);
    if (overflown)
        status = rt_fail(error, RT_BAD_INPUT, "%s: it counts 2^63 %s or more: measure fewer rays",
                         accel->ops->name, overflown);
    if (status == RT_OK) {
        for (size_t i = 0; i < set->count; i++) {
            if (answers_agree(&pass, i, expected[i])) continue;
            if (count->differ++ == 0) count->first = i;
        }
    }
    pass_clear(&pass);
    return status;
}

/* Whether two passes over the same rays counted the same. */
static RtStatus check_counts(const RtAccel *accel, const RtTally *first, const RtTally *second,
                             RtError *error) {
    const size_t i = rt_tally_difference(first, second);
    if (i == RT_TALLY_COUNTER_COUNT) return RT_OK;
    return rt_fail(error, RT_BROKEN,
                   "%s: it counts %llu %s on some rays, and %llu when they are traced again",
                   accel->ops->name, (unsigned long long)rt_tally_get(first, i), rt_tally_name(i),
                   (unsigned long long)rt_tally_get(second, i));
}

RtStatus rt_measure_count(const RtAccel *accel, const RtRaySet *set, const RtHit *expected, int threads,
                          RtCount *count, RtError *error) {
    RtCount other;
    RT_TRY(compare_pass(accel, set, expected, threads, true, count, error));
    if (!rt_accel_is_remote(accel) || (accel->exact && count->differ > 0)) return RT_OK;
    RT_TRY(compare_pass(accel, set, expected, threads, true, &other, error));
    RT_TRY(check_counts(accel, &count->tally, &other.tally, error));
    RT_TRY(compare_pass(accel, set, expected, threads, false, &other, error));
    if (other.differ <= count->differ) return RT_OK;
    count->differ = other.differ;
    count->first = other.first;
    count->timed_kernel = true;
    return RT_OK;
}

/* ---- ray by ray ---- */

typedef struct RowsPass {
    Pass pass;
    RtTally *rows; /* [set->count] */
} RowsPass;

static RtStatus count_rows(void *context, size_t item, int thread, RtError *error) {
    (void)error;
    RowsPass *work = context;
    const RtRaySet *set = work->pass.set;
    RtQuery *query = &work->pass.queries[thread];
    rt_query_begin(query);
    for (size_t i = item * CHUNK; i < set->count && i < (item + 1) * CHUNK; i++) {
        RtTally tallies[RT_RAY_KIND_COUNT] = {0};
        RtHit hit;
        bool blocked;
        if (work->pass.blocked) {
            rt_occluded(query, &set->rays[i], 1, &blocked, tallies);
        } else {
            rt_nearest(query, &set->rays[i], 1, &hit, tallies);
        }
        work->rows[i] = tallies[set->kind];
    }
    return RT_OK;
}

RtStatus rt_measure_rows(const RtAccel *accel, const RtRaySet *set, int threads, RtRows *rows,
                         RtError *error) {
    RowsPass work;
    *rows = (RtRows){.count = set->count, .tallies = rt_alloc(set->count, sizeof(RtTally))};
    if (!rows->tallies) return rt_fail_memory(error, "the counts of rays", set->count * sizeof(RtTally));
    work.rows = rows->tallies;
    RtStatus status = pass_init(&work.pass, accel, set, threads, false, error);
    if (status == RT_OK) status = run_pass(&work.pass, error);
    if (status == RT_OK) {
        size_t chunks = (set->count + CHUNK - 1) / CHUNK;
        status = rt_parallel_for(chunks, work.pass.threads, count_rows, &work, error);
    }
    if (status == RT_OK) status = rt_accel_check(accel, error);
    if (status == RT_OK) {
        rows->hits = work.pass.hits;
        rows->blocked = work.pass.blocked;
        work.pass.hits = NULL;
        work.pass.blocked = NULL;
    }
    pass_clear(&work.pass);
    return status;
}

void rt_rows_clear(RtRows *rows) {
    rt_free(rows->hits);
    rt_free(rows->blocked);
    rt_free(rows->tallies);
    *rows = (RtRows){0};
}

/* ---- timing ---- */

/* Traces blocks of rays whose places follow the golden ratio, so that even few blocks are spread over the
 * set. */
static RtStatus warm_runner(void *context, double seconds, double *part, RtError *error) {
    const double golden = 0.6180339887498949;
    Pass *pass = context;
    const uint64_t count = pass->set->count;
    const uint64_t block = count < 128 ? 1 : count / 64 < MOST_WARM ? count / 64 : MOST_WARM;
    const uint64_t blocks = count / block;
    double start = rt_thread_seconds(), place = 0;
    uint64_t done = 0;
    do {
        trace(pass, 0, block * (uint64_t)(place * (double)blocks), block);
        place += place + golden < 1 ? golden : golden - 1;
    } while (++done < blocks && rt_thread_seconds() - start < seconds);
    *part = (double)(done * block) / (double)count;
    return rt_accel_check(pass->queries[0].accel, error);
}

RtStatus rt_runner_open_local(RtRunner *runner, const RtTimed *timed, int threads, RtError *error) {
    Pass *pass = rt_alloc(1, sizeof(Pass));
    *runner = (RtRunner){.run = run_pass,
                         .warm = warm_runner,
                         .context = pass,
                         .work = (double)timed->set->count,
                         .parallel = rt_thread_count(threads) > 1,
                         .seconds = timed->seconds,
                         .wall = timed->wall,
                         .broken = timed->broken};
    if (!pass) return rt_fail_memory(error, "a pass", sizeof(Pass));
    RT_TRY(pass_init(pass, timed->accel, timed->set, threads, false, error));
    /* Touches the memory, so that no round does that for the first time. */
    if (pass->hits) memset(pass->hits, 0, timed->set->count * sizeof(RtHit));
    if (pass->blocked) memset(pass->blocked, 0, timed->set->count * sizeof(bool));
    return RT_OK;
}

void rt_runner_close_local(RtRunner *runner) {
    if (runner->context) pass_clear(runner->context);
    rt_free(runner->context);
    *runner = (RtRunner){0};
}
