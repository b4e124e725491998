/* SPDX-License-Identifier: Apache-2.0 */
/* Verification for those who embed us: one accelerator against brute on one scene. */
#include "base/memory.h"
#include "library/library.h"
#include "verify/equivalence.h"
#include "verify/verify_rays.h"

#include <inttypes.h>

/* As many as `raytally verify` takes. */
#define MOST_RAYS UINT64_C(20000000)

/* What a verification holds while it runs. */
typedef struct Stage {
    RtAccel *truth, *accel;
    RtRay *rays;
    RtReference reference;
} Stage;

static void fill(const RtEquivalence *result, raytally_verified *out) {
    *out = (raytally_verified){.rays = result->rays,
                               .equal = result->verdicts[RT_EQUAL],
                               .tie = result->verdicts[RT_TIE],
                               .marginal = result->verdicts[RT_MARGINAL],
                               .wrong = result->verdicts[RT_WRONG],
                               .occluded_wrong = result->occluded_wrong};
}

/* A broken structure is told of only where all its answers are right all the same. */
static RtStatus judge(const Stage *stage, const RtEquivalence *result, const char *spec, RtError *error) {
    char says[512];
    if (!result->any_wrong) return rt_accel_validate(stage->accel, error);
    rt_wrong_answer_format(&result->first_wrong, says, sizeof says);
    return rt_fail(error, RT_MISMATCH, "%.200s differs from %s, first on %s", spec, rt_accel_truth(), says);
}

static RtStatus verify(Stage *stage, const RtScene *scene, const char *spec, const RtVerifyRays *wanted,
                       raytally_verified *out, RtError *error) {
    RtEquivalence result;
    RT_TRY(rt_accel_open_on(rt_accel_truth(), scene, wanted->threads, &stage->truth, error));
    RT_TRY(rt_accel_open_on(spec, scene, wanted->threads, &stage->accel, error));
    stage->rays = rt_alloc(wanted->count, sizeof(RtRay));
    if (!stage->rays) return rt_fail_memory(error, "rays", wanted->count * sizeof(RtRay));
    RT_TRY(rt_verify_rays(wanted, stage->truth, stage->rays, error));
    RT_TRY(rt_reference_init(&stage->reference, stage->truth, stage->rays, wanted->count, wanted->threads,
                             error));
    RT_TRY(rt_equivalence_check(&stage->reference, stage->accel, wanted->threads, &result, error));
    fill(&result, out);
    return judge(stage, &result, spec, error);
}

static RtStatus check(const raytally_verifying *how, RtError *error) {
    RT_TRY(rt_threads_check(how->threads, error));
    if (how->given || (how->rays >= 1 && how->rays <= MOST_RAYS)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%" PRIu64 " rays to verify by: expected 1..%" PRIu64, how->rays,
                   MOST_RAYS);
}

raytally_status raytally_verify(const raytally_scene *scene, const char *spec, const raytally_verifying *how,
                                raytally_verified *out, raytally_error *error) {
    Stage stage = {0};
    raytally_verifying own = RAYTALLY_VERIFYING;
    rt_options_take(&own, sizeof own, how);
    *out = (raytally_verified){0};
    RtVerifyRays wanted = {.count = own.given ? own.given->set.count : own.rays,
                           .seed = own.seed,
                           .threads = own.threads,
                           .given = own.given ? &own.given->set : NULL};
    locale_t before = rt_locale_enter();
    RtStatus status = check(&own, rt_error_of(error));
    if (status == RT_OK) status = verify(&stage, &scene->scene, spec, &wanted, out, rt_error_of(error));
    rt_locale_leave(before);
    rt_reference_clear(&stage.reference);
    rt_free(stage.rays);
    rt_accel_destroy(stage.accel);
    rt_accel_destroy(stage.truth);
    return (raytally_status)status;
}
