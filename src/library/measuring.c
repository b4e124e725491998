/* SPDX-License-Identifier: Apache-2.0 */
/* Counting, timing and statistics of the embedding interface. */
#include "core/base/memory.h"
#include "library/library.h"
#include "measure/measure.h"

#include <inttypes.h>

/* ---- counting ---- */

static bool learns(const RtAccel *accel) {
    while (accel && !accel->ops->learn) accel = accel->below;
    return accel != NULL;
}

/* Writes the right answers to hits[0..set->count): those of the accelerator itself, or of the default one
 * where it learns, because one that has not learned yet is very slow. */
static RtStatus answer(const RtAccel *accel, const RtRaySet *set, int threads, RtHit *hits, RtError *error) {
    RtAccel *other;
    if (!learns(accel)) return rt_measure_answers(accel, set, threads, hits, error);
    RT_TRY(rt_accel_open_on(rt_accel_default(), accel->scene, threads, &other, error));
    RtStatus status = rt_measure_answers(other, set, threads, hits, error);
    rt_accel_destroy(other);
    return status;
}

/* Makes an accelerator that learns forget the rays, which it knows by their addresses. Returns `status`
 * unless that is RT_OK and this fails. */
static RtStatus forget(RtAccel *accel, RtStatus status, RtError *error) {
    RtStatus forgotten = rt_accel_learn(accel, NULL, NULL, 0, status == RT_OK ? error : NULL);
    return status == RT_OK ? forgotten : status;
}

static RtStatus count_taught(RtAccel *accel, const RtRaySet *set, const RtHit *hits, int threads,
                             raytally_counters *out, RtError *error) {
    RtCount count;
    RT_TRY(rt_measure_count(accel, set, hits, threads, &count, error));
    rt_counters_add(out, &count.tally);
    if (!accel->exact || count.differ == 0) return RT_OK;
    return rt_fail(error, RT_MISMATCH,
                   "%s: %" PRIu64
                   " answers of the counted kernel differ from the timed one's, the first on ray %" PRIu64,
                   accel->ops->name, count.differ, count.first);
}

static RtStatus count_rays(RtAccel *accel, const RtRaySet *set, RtHit *hits, int threads,
                           raytally_counters *out, RtError *error) {
    RT_TRY(rt_threads_check(threads, error));
    RT_TRY(answer(accel, set, threads, hits, error));
    RtStatus status = rt_accel_learn(accel, set->rays, hits, (size_t)set->count, error);
    if (status == RT_OK) status = count_taught(accel, set, hits, threads, out, error);
    return forget(accel, status, error);
}

raytally_status raytally_count(raytally_accelerator *accelerator, const raytally_rays *rays, int threads,
                               raytally_counters *out, raytally_error *error) {
    *out = (raytally_counters){{0}};
    RT_C_LOCALE;
    RtHit *hits = rt_alloc((size_t)rays->set.count, sizeof *hits);
    RtStatus status =
        hits ? count_rays(accelerator->accel, &rays->set, hits, threads, out, rt_error_of(error))
             : rt_fail_memory(rt_error_of(error), "answers", (size_t)rays->set.count * sizeof *hits);
    rt_free(hits);
    return (raytally_status)status;
}

/* ---- statistics ---- */

static RtStatus check_rounds(uint32_t count, const char *what, RtError *error) {
    if (count >= 1 && count <= RT_MAX_ROUNDS) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%" PRIu32 " %s: expected 1..%d", count, what, RT_MAX_ROUNDS);
}

static raytally_estimate public_estimate(RtEstimate estimate, uint32_t count) {
    return (raytally_estimate){.median = estimate.median,
                               .low = estimate.low,
                               .high = estimate.high,
                               .least = estimate.least,
                               .coverage = rt_interval_coverage(count)};
}

raytally_status raytally_estimate_median(const double *values, uint32_t count, raytally_estimate *out,
                                         raytally_error *error) {
    RT_C_LOCALE;
    RtStatus status = check_rounds(count, "measurements", rt_error_of(error));
    if (status == RT_OK) *out = public_estimate(rt_estimate(values, count), count);
    return (raytally_status)status;
}

raytally_status raytally_estimate_ratio(const double *over, const double *under, uint32_t count,
                                        raytally_estimate *out, raytally_error *error) {
    RT_C_LOCALE;
    RtStatus status = check_rounds(count, "pairs of measurements", rt_error_of(error));
    if (status == RT_OK) *out = public_estimate(rt_estimate_ratio(over, under, count), count);
    return (raytally_status)status;
}

/* ---- timing ---- */

typedef struct TimingRun {
    raytally_accelerator *const *accelerators; /* [count] */
    size_t count;
    const RtRaySet *set;
    RtHit *hits;     /* [set->count] */
    RtTimed *timed;  /* [count] */
    double *seconds; /* [count][2][rounds] */
} TimingRun;

static RtStatus check_timing(const raytally_time_options *how, const TimingRun *run, RtError *error) {
    RT_TRY(check_rounds(how->rounds, "rounds", error));
    RT_TRY(rt_threads_check(how->threads, error));
    if (!(how->least >= 0 && how->least <= 60))
        return rt_fail(error, RT_BAD_INPUT, "a round of at least %g s: expected 0..60", how->least);
    if (run->count == 0) return rt_fail(error, RT_BAD_INPUT, "no accelerator to time");
    if (run->set->count == 0) return rt_fail(error, RT_BAD_INPUT, "no rays to time accelerators on");
    return RT_OK;
}

static RtStatus timing_run_init(TimingRun *run, const raytally_time_options *how, RtError *error) {
    size_t doubles = 2 * (size_t)how->rounds;
    run->hits = rt_alloc((size_t)run->set->count, sizeof(RtHit));
    run->timed = rt_alloc(run->count, sizeof(RtTimed));
    run->seconds = rt_alloc(run->count, doubles * sizeof(double));
    if (!run->hits || !run->timed || !run->seconds)
        return rt_fail_memory(error, "times", run->count * doubles * sizeof(double));
    for (size_t i = 0; i < run->count; i++) {
        double *place = run->seconds + doubles * i;
        run->timed[i] = (RtTimed){.accel = run->accelerators[i]->accel,
                                  .set = run->set,
                                  .seconds = place,
                                  .wall = place + how->rounds};
    }
    return RT_OK;
}

static RtStatus teach(const TimingRun *run, int threads, RtError *error) {
    const RtRaySet *set = run->set;
    for (size_t i = 0; i < run->count; i++) {
        RtAccel *accel = run->accelerators[i]->accel;
        if (!learns(accel)) continue;
        RT_TRY(answer(accel, set, threads, run->hits, error));
        RT_TRY(rt_accel_learn(accel, set->rays, run->hits, (size_t)set->count, error));
    }
    return RT_OK;
}

static RtStatus take_times(TimingRun *run, const raytally_time_options *how, raytally_time *times,
                           RtError *error) {
    const RtTiming timing = {
        .rounds = {.rounds = how->rounds, .most = how->rounds, .least = how->least, .seed = how->seed},
        .threads = how->threads};
    uint32_t done = 0;
    RT_TRY(teach(run, how->threads, error));
    RT_TRY(rt_measure_time(run->timed, run->count, &timing, &done, error));
    const double *first = run->timed[0].seconds;
    for (size_t i = 0; i < run->count; i++) {
        const double *own = run->timed[i].seconds;
        times[i] = (raytally_time){.seconds = public_estimate(rt_estimate(own, done), done),
                                   .ratio = public_estimate(rt_estimate_ratio(first, own, done), done)};
    }
    return RT_OK;
}

raytally_status raytally_time_all(raytally_accelerator *const *accelerators, size_t count,
                                  const raytally_rays *rays, const raytally_time_options *how,
                                  raytally_time *times, raytally_error *error) {
    TimingRun run = {.accelerators = accelerators, .count = count, .set = &rays->set};
    raytally_time_options own = RAYTALLY_TIME_DEFAULTS;
    RT_C_LOCALE;
    RtStatus status = rt_options_take(&own, sizeof own, how, "raytally_time_options", rt_error_of(error));
    if (status == RT_OK) status = check_timing(&own, &run, rt_error_of(error));
    if (status == RT_OK) status = timing_run_init(&run, &own, rt_error_of(error));
    if (status == RT_OK) {
        status = take_times(&run, &own, times, rt_error_of(error));
        for (size_t i = 0; i < count; i++)
            status = forget(accelerators[i]->accel, status, rt_error_of(error));
    }
    rt_free(run.hits);
    rt_free(run.timed);
    rt_free(run.seconds);
    return (raytally_status)status;
}
