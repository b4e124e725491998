/* SPDX-License-Identifier: Apache-2.0 */
/* Verification of the embedding interface: one accelerator against brute on one scene. */
#include "library/library.h"
#include "verify/verify_rays.h"

#include <inttypes.h>

/* The limit of `raytally verify`. */
#define MOST_RAYS UINT64_C(20000000)

static void fill(const RtEquivalence *result, const RtCertain *certain, raytally_verify_result *out) {
    *out = (raytally_verify_result){.rays = result->rays,
                                    .equal = result->verdicts[RT_EQUAL],
                                    .tie = result->verdicts[RT_TIE],
                                    .marginal = result->verdicts[RT_MARGINAL],
                                    .wrong = result->verdicts[RT_WRONG],
                                    .occluded_wrong = result->occluded_wrong,
                                    .certain = certain->certain,
                                    .must_hit = certain->must_hit,
                                    .certain_of = certain->rays};
}

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

static RtStatus verify(RtVerifyScene *stage, const RtVerifyRays *wanted, RtAccel *accel, const char *spec,
                       raytally_verify_result *out, RtError *error) {
    RtEquivalence result;
    RtCertain certain = {0};
    RT_TRY(rt_verify_scene_answer(stage, wanted, error));
    RT_TRY(rt_equivalence_check(&stage->reference, accel, wanted->threads, &result, error));
    if (!accel->exact)
        RT_TRY(rt_reference_certain(&stage->reference, accel->absolute, wanted->threads, &certain, error));
    fill(&result, &certain, out);
    return judge(accel, wanted, &result, &certain, spec, error);
}

/* Answering the rays takes longest, so the accelerator is built first: a bad spec fails at once. */
static RtStatus build_and_verify(RtVerifyScene *stage, const RtScene *scene, const RtVerifyRays *wanted,
                                 const char *spec, raytally_verify_result *out, RtError *error) {
    RtAccel *accel;
    RT_TRY(rt_verify_scene_init(stage, scene, wanted, error));
    RT_TRY(rt_accel_open_on(spec, &stage->scene, wanted->threads, &accel, error));
    RtStatus status = verify(stage, wanted, accel, spec, out, error);
    rt_accel_destroy(accel);
    return status;
}

static RtStatus check(const raytally_verify_options *how, RtError *error) {
    RT_TRY(rt_threads_check(how->threads, error));
    if (how->given || (how->rays >= 1 && how->rays <= MOST_RAYS)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%" PRIu64 " rays to verify by: expected 1..%" PRIu64, how->rays,
                   MOST_RAYS);
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
    if (status == RT_OK) status = check(&own, rt_error_of(error));
    if (status == RT_OK)
        status = build_and_verify(&stage, &scene->scene, &wanted, spec, out, rt_error_of(error));
    rt_verify_scene_clear(&stage);
    return (raytally_status)status;
}
