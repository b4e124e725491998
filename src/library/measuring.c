/* SPDX-License-Identifier: Apache-2.0 */
/* Counting, timing, statistics and verification of the embedding interface. */
#include "core/base/memory.h"
#include "library/library.h"
#include "measure/measure.h"
#include "verify/verify_rays.h"

#include <inttypes.h>

/* ---- counting ---- */

static bool learns(const RtAccel *accel) {
    while (accel && !accel->ops->learn) accel = accel->below;
    return accel != NULL;
}

/* Writes the right answers to hits[0..set->count): those of the accelerator itself, or of the default one
 * where it learns, because one that has not learned yet is very slow. */
static RtStatus answer(const RtAccel *accel, const RtRaySet *set, int threads, RtHit *hits, RtError *error) {
    RT_OWNED(RtAccel *, other, rt_accel_destroy_at);
    if (!learns(accel)) return rt_measure_answers(accel, set, threads, hits, error);
    RT_TRY(rt_accel_open_on(rt_accel_default(), accel->scene, threads, &other, error));
    return rt_measure_answers(other, set, threads, hits, error);
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

static RtStatus check_counts(const raytally_accelerator *accelerator, RtError *error) {
    if (accelerator->accel->counts) return RT_OK;
    return rt_fail(error, RT_NOT_AVAILABLE,
                   "%s does not count, or differently on each machine: compare its hits and times",
                   accelerator->spec);
}

static RtStatus count_rays(const raytally_accelerator *accelerator, const RtRaySet *set, int threads,
                           raytally_counters *out, RtError *error) {
    RtAccel *accel = accelerator->accel;
    RT_ARENA(arena);
    RT_TRY(check_counts(accelerator, error));
    RtHit *hits = rt_arena_alloc(&arena, (size_t)set->count, sizeof *hits);
    RT_TRY(rt_arena_check(&arena, "answers", error));
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
    return (raytally_status)count_rays(accelerator, &rays->set, threads, out, rt_error_of(error));
}

/* An accelerator that learns does so in a copy: this one may be in use by other threads. */
static RtStatus count_each(const raytally_accelerator *accelerator, const RtRaySet *set, int threads,
                           uint64_t *counts, uint32_t counters, RtError *error) {
    RT_ARENA(arena);
    RT_OWNED(RtRows, rows, rt_rows_clear);
    RT_OWNED(RtAccel *, copy, rt_accel_destroy_at);
    const RtAccel *accel = accelerator->accel;
    RT_TRY(check_counts(accelerator, error));
    RT_TRY(rt_threads_check(threads, error));
    if (learns(accel)) {
        RtHit *hits = rt_arena_alloc(&arena, (size_t)set->count, sizeof *hits);
        RT_TRY(rt_arena_check(&arena, "answers", error));
        RT_TRY(rt_accel_open_on(accelerator->spec, accel->scene, threads, &copy, error));
        RT_TRY(answer(copy, set, threads, hits, error));
        RT_TRY(rt_accel_learn(copy, set->rays, hits, (size_t)set->count, error));
        accel = copy;
    }
    RT_TRY(rt_measure_rows(accel, set, threads, &rows, error));
    for (uint64_t i = 0; i < set->count; i++) {
        for (uint32_t c = 0; c < counters; c++, counts++)
            *counts = c < RT_TALLY_COUNTER_COUNT ? rt_tally_get(&rows.tallies[i], c) : 0;
    }
    return RT_OK;
}

raytally_status raytally_count_each(const raytally_accelerator *accelerator, const raytally_rays *rays,
                                    int threads, uint64_t *counts, uint32_t counters, raytally_error *error) {
    RT_C_LOCALE;
    return (raytally_status)count_each(accelerator, &rays->set, threads, counts, counters,
                                       rt_error_of(error));
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

static RtStatus check_timing(const raytally_time_options *how, raytally_accelerator *const *accelerators,
                             size_t count, const RtRaySet *set, RtError *error) {
    RT_TRY(check_rounds(how->rounds, "rounds", error));
    RT_TRY(rt_threads_check(how->threads, error));
    if (!(how->least >= 0 && how->least <= 60))
        return rt_fail(error, RT_BAD_INPUT, "a round of at least %g s: expected 0..60", how->least);
    if (count == 0) return rt_fail(error, RT_BAD_INPUT, "no accelerator to time");
    if (set->count == 0) return rt_fail(error, RT_BAD_INPUT, "no rays to time accelerators on");
    for (size_t i = 1; i < count; i++) {
        const RtScene *first = &accelerators[0]->scene->scene, *own = &accelerators[i]->scene->scene;
        if (own == first || rt_scene_fingerprint(own) == rt_scene_fingerprint(first)) continue;
        return rt_fail(error, RT_BAD_INPUT, "accelerators 0 and %zu are built over different scenes", i);
    }
    return RT_OK;
}

static RtStatus teach(raytally_accelerator *const *accelerators, size_t count, const RtRaySet *set,
                      int threads, RtHit *hits, RtError *error) {
    for (size_t i = 0; i < count; i++) {
        RtAccel *accel = accelerators[i]->accel;
        if (!learns(accel)) continue;
        RT_TRY(answer(accel, set, threads, hits, error));
        RT_TRY(rt_accel_learn(accel, set->rays, hits, (size_t)set->count, error));
    }
    return RT_OK;
}

static RtStatus time_all(raytally_accelerator *const *accelerators, size_t count, const RtRaySet *set,
                         const raytally_time_options *how, raytally_time *times, RtError *error) {
    const RtTiming timing = {
        .rounds = {.rounds = how->rounds, .most = how->rounds, .least = how->least, .seed = how->seed},
        .threads = how->threads};
    uint32_t done = 0;
    RT_ARENA(arena);
    RtHit *hits = rt_arena_alloc(&arena, (size_t)set->count, sizeof(RtHit));
    RtTimed *timed = rt_arena_alloc(&arena, count, sizeof(RtTimed));
    double *seconds = rt_arena_alloc(&arena, count, 2 * (size_t)how->rounds * sizeof(double));
    RT_TRY(rt_arena_check(&arena, "times", error));
    for (size_t i = 0; i < count; i++, seconds += 2 * (size_t)how->rounds) {
        timed[i] = (RtTimed){
            .accel = accelerators[i]->accel, .set = set, .seconds = seconds, .wall = seconds + how->rounds};
    }
    RtStatus status = teach(accelerators, count, set, how->threads, hits, error);
    if (status == RT_OK) status = rt_measure_time(timed, count, &timing, &done, error);
    for (size_t i = 0; i < count; i++) {
        const double *first = timed[0].seconds, *own = timed[i].seconds;
        status = forget(accelerators[i]->accel, status, error);
        if (status == RT_OK)
            times[i] = (raytally_time){.seconds = public_estimate(rt_estimate(own, done), done),
                                       .ratio = public_estimate(rt_estimate_ratio(first, own, done), done)};
    }
    return status;
}

raytally_status raytally_time_all(raytally_accelerator *const *accelerators, size_t count,
                                  const raytally_rays *rays, const raytally_time_options *how,
                                  raytally_time *times, raytally_error *error) {
    raytally_time_options own = RAYTALLY_TIME_DEFAULTS;
    RT_C_LOCALE;
    RtStatus status = rt_options_take(&own, sizeof own, how, "raytally_time_options", rt_error_of(error));
    if (status == RT_OK) status = check_timing(&own, accelerators, count, &rays->set, rt_error_of(error));
    if (status == RT_OK) status = time_all(accelerators, count, &rays->set, &own, times, rt_error_of(error));
    return (raytally_status)status;
}

/* ---- verifying: one accelerator against brute on one scene ---- */

/* The limit of `raytally verify`. */
#define MOST_RAYS UINT64_C(20000000)

/* Reports the first wrong answer; a broken structure, and too few certain rays, only if all answers are
 * right. */
static RtStatus judge(const RtAccel *accel, const RtVerifyRays *wanted, const RtEquivalence *result,
                      const RtCertain *certain, const char *spec, RtError *error) {
    char says[512];
    if (result->any_wrong) {
        rt_wrong_answer_format(&result->first_wrong, says, sizeof says);
        return rt_fail(error, RT_MISMATCH, "%.200s differs from %s, first on %s", spec, rt_accel_truth(),
                       says);
    }
    RT_TRY(rt_accel_validate(accel, error));
    if (accel->exact || rt_certain_suffices(certain, wanted->count, wanted->given)) return RT_OK;
    rt_certain_undecided(certain, wanted->count, wanted->given, accel->absolute, says, sizeof says);
    return rt_fail(error, RT_MISMATCH, "%.200s: %s", spec, says);
}

/* Answering the rays takes longest, so the accelerator is built first: a bad spec fails at once. */
static RtStatus verify(RtVerifyScene *stage, const RtScene *scene, const RtVerifyRays *wanted,
                       const char *spec, raytally_verify_result *out, RtError *error) {
    RT_OWNED(RtAccel *, accel, rt_accel_destroy_at);
    RtEquivalence result;
    RtCertain certain = {0};
    RT_TRY(rt_verify_scene_init(stage, scene, wanted, error));
    RT_TRY(rt_accel_open_on(spec, &stage->scene, wanted->threads, &accel, error));
    RT_TRY(rt_reference_init(&stage->reference, stage->truth, stage->rays, wanted->count, wanted->threads,
                             error));
    RT_TRY(rt_equivalence_check(&stage->reference, accel, wanted->threads, &result, error));
    if (!accel->exact)
        RT_TRY(rt_reference_certain(&stage->reference, accel->absolute, wanted->threads, &certain, error));
    *out = (raytally_verify_result){.rays = result.rays,
                                    .equal = result.verdicts[RT_EQUAL],
                                    .tie = result.verdicts[RT_TIE],
                                    .marginal = result.verdicts[RT_MARGINAL],
                                    .wrong = result.verdicts[RT_WRONG],
                                    .occluded_wrong = result.occluded_wrong,
                                    .certain = certain.certain,
                                    .must_hit = certain.must_hit,
                                    .certain_of = certain.rays};
    return judge(accel, wanted, &result, &certain, spec, error);
}

raytally_status raytally_verify(const raytally_scene *scene, const char *spec,
                                const raytally_verify_options *how, raytally_verify_result *out,
                                raytally_error *error) {
    RtVerifyScene stage = {0};
    raytally_verify_options own = RAYTALLY_VERIFY_DEFAULTS;
    *out = (raytally_verify_result){0};
    RT_C_LOCALE;
    RtStatus status = rt_options_take(&own, sizeof own, how, "raytally_verify_options", rt_error_of(error));
    RtVerifyRays wanted = {.count = own.given ? own.given->set.count : own.rays,
                           .seed = own.seed,
                           .threads = own.threads,
                           .given = own.given ? &own.given->set : NULL};
    if (status == RT_OK) status = rt_threads_check(own.threads, rt_error_of(error));
    if (status == RT_OK && !own.given && (own.rays < 1 || own.rays > MOST_RAYS))
        status = rt_fail(rt_error_of(error), RT_BAD_INPUT,
                         "%" PRIu64 " rays to verify by: expected 1..%" PRIu64, own.rays, MOST_RAYS);
    if (status == RT_OK) status = verify(&stage, &scene->scene, &wanted, spec, out, rt_error_of(error));
    rt_verify_scene_clear(&stage);
    return (raytally_status)status;
}
