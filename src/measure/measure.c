/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/measure.h"

#include "accel/pass.h"
#include "accel/plugin.h"
#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"
#include "core/base/random.h"

#include <string.h>

/* Rays traced at a time while warming up. */
enum { MOST_WARM = 256 };

static RtStatus init_pass(RtPass *pass, const RtAccel *accel, const RtRaySet *set, int threads, bool counted,
                          RtError *error) {
    return rt_pass_init(pass, accel, set->rays, set->count, rt_ray_kind_is_any_hit(set->kind), threads,
                        counted, error);
}

/* ---- counting ---- */

RtStatus rt_measure_answers(const RtAccel *accel, const RtRaySet *set, int threads, RtHit *hits,
                            RtError *error) {
    /* `nearest` also for shadow and occlusion rays: a hit is then known by its object. */
    RtPass pass;
    RtStatus status = rt_pass_init(&pass, accel, set->rays, set->count, false, threads, false, error);
    if (status == RT_OK) status = rt_pass_run(&pass, error);
    if (status == RT_OK) memcpy(hits, pass.hits, set->count * sizeof(RtHit));
    rt_pass_clear(&pass);
    return status;
}

static bool answers_agree(const RtPass *pass, size_t i, RtHit expected) {
    if (pass->blocked) return pass->blocked[i] == (expected.object != RT_NO_OBJECT);
    return memcmp(&pass->hits[i], &expected, sizeof expected) == 0;
}

/* One pass by the counted kernel or the timed one. */
static RtStatus compare_pass(const RtAccel *accel, const RtRaySet *set, const RtHit *expected, int threads,
                             bool counted, RtCount *count, RtError *error) {
    *count = (RtCount){0};
    RtPass pass;
    RtStatus status = init_pass(&pass, accel, set, threads, counted, error);
    double start = rt_wall_seconds();
    if (status == RT_OK) status = rt_pass_run(&pass, error);
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
    rt_pass_clear(&pass);
    return status;
}

RtStatus rt_counts_check(const RtAccel *accel, const RtTally *first, const RtTally *second, RtRayKind kind,
                         RtError *error) {
    const size_t i = rt_tally_difference(first, second);
    if (i == RT_TALLY_COUNTER_COUNT) return RT_OK;
    return rt_fail(error, RT_BROKEN,
                   "%s: it counts %llu %s on some %s rays, and %llu when they are traced again",
                   accel->ops->name, (unsigned long long)rt_tally_get(first, i), rt_tally_name(i),
                   rt_ray_kind_name(kind), (unsigned long long)rt_tally_get(second, i));
}

RtStatus rt_measure_count(const RtAccel *accel, const RtRaySet *set, const RtHit *expected, int threads,
                          RtCount *count, RtError *error) {
    RtCount other;
    RT_TRY(compare_pass(accel, set, expected, threads, true, count, error));
    if (!rt_accel_is_remote(accel) || (accel->exact && count->differ > 0)) return RT_OK;
    RT_TRY(compare_pass(accel, set, expected, threads, true, &other, error));
    RT_TRY(rt_counts_check(accel, &count->tally, &other.tally, set->kind, error));
    RT_TRY(compare_pass(accel, set, expected, threads, false, &other, error));
    if (other.differ <= count->differ) return RT_OK;
    count->differ = other.differ;
    count->first = other.first;
    count->timed_kernel = true;
    return RT_OK;
}

/* ---- ray by ray ---- */

typedef struct RowsPass {
    RtPass pass;
    RtRayKind kind;
    RtTally *rows; /* [set->count] */
} RowsPass;

static RtStatus count_rows(void *context, size_t item, int thread, RtError *error) {
    (void)error;
    RowsPass *work = context;
    RtQuery *query = &work->pass.queries[thread];
    rt_query_begin(query);
    for (size_t i = item * RT_PASS_CHUNK; i < work->pass.count && i < (item + 1) * RT_PASS_CHUNK; i++) {
        RtTally tallies[RT_RAY_KIND_COUNT] = {0};
        RtHit hit;
        bool blocked;
        if (work->pass.blocked) {
            rt_occluded(query, &work->pass.rays[i], 1, &blocked, tallies);
        } else {
            rt_nearest(query, &work->pass.rays[i], 1, &hit, tallies);
        }
        work->rows[i] = tallies[work->kind];
    }
    return RT_OK;
}

RtStatus rt_measure_rows(const RtAccel *accel, const RtRaySet *set, int threads, RtRows *rows,
                         RtError *error) {
    RowsPass work;
    *rows = (RtRows){.count = set->count, .tallies = rt_alloc(set->count, sizeof(RtTally))};
    if (!rows->tallies) return rt_fail_memory(error, "the counts of rays", set->count * sizeof(RtTally));
    work.rows = rows->tallies;
    work.kind = set->kind;
    RtStatus status = init_pass(&work.pass, accel, set, threads, false, error);
    if (status == RT_OK) status = rt_pass_run(&work.pass, error);
    if (status == RT_OK) {
        size_t chunks = (set->count + RT_PASS_CHUNK - 1) / RT_PASS_CHUNK;
        status = rt_parallel_for(chunks, work.pass.threads, count_rows, &work, error);
    }
    if (status == RT_OK) status = rt_accel_check(accel, error);
    if (status == RT_OK) {
        rows->hits = work.pass.hits;
        rows->blocked = work.pass.blocked;
        work.pass.hits = NULL;
        work.pass.blocked = NULL;
    }
    rt_pass_clear(&work.pass);
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
    RtPass *pass = context;
    const uint64_t count = pass->count;
    const uint64_t block = count < 128 ? 1 : count / 64 < MOST_WARM ? count / 64 : MOST_WARM;
    const uint64_t blocks = count / block;
    double start = rt_thread_seconds(), place = 0;
    uint64_t done = 0;
    do {
        rt_pass_trace(pass, 0, block * (uint64_t)(place * (double)blocks), block);
        place += place + golden < 1 ? golden : golden - 1;
    } while (++done < blocks && rt_thread_seconds() - start < seconds);
    *part = (double)(done * block) / (double)count;
    return rt_accel_check(pass->queries[0].accel, error);
}

static RtStatus run_runner(void *context, RtError *error) {
    return rt_pass_run(context, error);
}

static RtStatus open_pass(RtRunner *runner, const RtTimed *timed, int threads, RtError *error) {
    RtPass *pass = runner->context = rt_alloc(1, sizeof(RtPass));
    runner->run = run_runner;
    runner->warm = warm_runner;
    if (!pass) return rt_fail_memory(error, "a pass", sizeof(RtPass));
    RT_TRY(init_pass(pass, timed->accel, timed->set, threads, false, error));
    /* Touches the memory, so that no round does that for the first time. */
    if (pass->hits) memset(pass->hits, 0, timed->set->count * sizeof(RtHit));
    if (pass->blocked) memset(pass->blocked, 0, timed->set->count * sizeof(bool));
    return RT_OK;
}

static RtStatus time_remote(void *context, uint32_t repeats, double *seconds, double *wall, RtError *error) {
    return rt_remote_pass_time(context, repeats, seconds, wall, error);
}

static RtStatus open_remote(RtRunner *runner, const RtTimed *timed, int threads, RtError *error) {
    const RtRaySet *set = timed->set;
    RtRemotePass *pass;
    runner->time = time_remote;
    RtStatus status = rt_remote_pass_open(&pass, timed->accel, set->rays, set->count,
                                          rt_ray_kind_is_any_hit(set->kind), threads, error);
    runner->context = pass;
    return status;
}

RtStatus rt_runner_open(RtRunner *runner, const RtTimed *timed, int threads, RtError *error) {
    *runner = (RtRunner){.work = (double)timed->set->count,
                         .parallel = rt_thread_count(threads) > 1,
                         .seconds = timed->seconds,
                         .wall = timed->wall,
                         .broken = timed->broken};
    return rt_accel_is_remote(timed->accel) ? open_remote(runner, timed, threads, error)
                                            : open_pass(runner, timed, threads, error);
}

void rt_runner_close(RtRunner *runner) {
    if (runner->time) {
        rt_remote_pass_close(runner->context);
    } else if (runner->context) {
        rt_pass_clear(runner->context);
        rt_free(runner->context);
    }
    *runner = (RtRunner){0};
}

/* ---- in rounds ---- */

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
    RT_ARENA(arena);
    TimingRun run = {.timing = timing,
                     .timed = timed,
                     .runners = rt_arena_alloc(&arena, count, sizeof(RtRunner)),
                     .order = rt_arena_alloc(&arena, count, sizeof(size_t)),
                     .count = count,
                     .random = rt_random(timing->rounds.seed, 1)};
    RtRounds rounds = timing->rounds;
    rounds.renew = timing->renew ? renew_runners : NULL;
    rounds.renew_context = &run;
    RT_TRY(rt_arena_check(&arena, "the rounds", error));
    for (size_t i = 0; i < count; i++) run.order[i] = i;
    RtStatus status = open_runners(&run, error);
    if (status == RT_OK) status = rt_rounds_run(run.runners, count, &rounds, done, error);
    close_runners(&run);
    return status;
}

/* ---- rays that are learnt ---- */

/* The seconds of `repeats` passes, each after a pass `before`, if there is one. */
static RtStatus time_after(RtPass *before, RtPass *pass, uint32_t repeats, double *seconds, RtError *error) {
    *seconds = 0;
    for (uint32_t i = 0; i < repeats; i++) {
        if (before) RT_TRY(rt_pass_run(before, error));
        const double start = rt_thread_seconds();
        RT_TRY(rt_pass_run(pass, error));
        *seconds += rt_thread_seconds() - start;
    }
    return RT_OK;
}

RtStatus rt_measure_learning(const RtAccel *accel, const RtRaySet *set, const RtRaySet *others, uint32_t most,
                             double *learnt, RtError *error) {
    enum { PAIRS = 7 };
    const double least = 2e-3; /* seconds */
    RT_OWNED(RtPass, own, rt_pass_clear);
    RT_OWNED(RtPass, other, rt_pass_clear);
    double ratios[PAIRS], once, alone, beside;
    RT_TRY(init_pass(&own, accel, set, 1, false, error));
    RT_TRY(init_pass(&other, accel, others, 1, false, error));
    RT_TRY(time_after(&other, &own, 1, &once, error));
    const uint32_t enough = rt_runner_repeats(once, least), repeats = enough < most ? enough : most;
    for (int i = 0; i < PAIRS; i++) {
        RT_TRY(time_after(NULL, &own, repeats, &alone, error));
        RT_TRY(time_after(&other, &own, repeats, &beside, error));
        ratios[i] = beside / alone;
    }
    *learnt = rt_median(ratios, PAIRS);
    return RT_OK;
}
