/* SPDX-License-Identifier: Apache-2.0 */
/* Sets of rays of the embedding interface: recorded, or copied from the caller. */
#include "core/base/memory.h"
#include "library/library.h"

#include <string.h>

static RtStatus check_kind(enum raytally_ray_kind kind, RtError *error) {
    if ((unsigned)kind < RT_RAY_KIND_COUNT) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "no kind of rays has the number %d", (int)kind);
}

static RtStatus check_recording(const raytally_record_options *how, const RtAccel *accel, RtError *error) {
    RT_TRY(rt_threads_check(how->threads, error));
    if (how->limit < 1 || how->limit > RT_MAX_RAYS_A_KIND) {
        return rt_fail(error, RT_BAD_INPUT, "a limit of %llu rays: expected 1..%llu",
                       (unsigned long long)how->limit, (unsigned long long)RT_MAX_RAYS_A_KIND);
    }
    if (accel->exact) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s is not exact: record rays by another accelerator, such as %s",
                   accel->ops->name, rt_accel_default());
}

static RtStatus record(const RtAccel *accel, enum raytally_ray_kind kind, const raytally_record_options *how,
                       RtRaySet *out, RtError *error) {
    RtRaySet sets[RT_RAY_KIND_COUNT] = {0};
    RT_TRY(check_kind(kind, error));
    RT_TRY(check_recording(how, accel, error));
    RtRecording recording = {.depth = how->depth,
                             .seed = how->seed,
                             .random = kind == RAYTALLY_RANDOM ? how->limit : 0,
                             .threads = how->threads};
    RtStatus status = rt_rayset_record(sets, accel, &recording, error);
    if (status == RT_OK) status = rt_rayset_limit(&sets[kind], how->limit, RT_COHERENT_RUN, out, error);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&sets[k]);
    return status;
}

static RtStatus copy(enum raytally_ray_kind kind, const raytally_ray *rays, size_t count, RtRaySet *out,
                     RtError *error) {
    RT_TRY(check_kind(kind, error));
    RT_TRY(rt_rayset_init(out, (RtRayKind)kind, count, error));
    if (count > 0) memcpy(out->rays, rays, count * sizeof *rays);
    for (size_t i = 0; i < count; i++) {
        out->rays[i].kind = (uint32_t)kind;
        if (rt_ray_is_valid(&out->rays[i])) continue;
        return rt_fail(
            error, RT_BAD_INPUT,
            "ray %zu (the first is 0) is not valid: org and dir are finite, dir is not 0, and 0 <= tmin "
            "<= tmax",
            i);
    }
    rt_rayset_seal(out);
    return RT_OK;
}

/* Moves the rays to a new *out if `status` is RT_OK; else frees them. */
static raytally_status finish(RtRaySet *made, RtStatus status, raytally_rays **out, RtError *error) {
    *out = status == RT_OK ? rt_alloc(1, sizeof **out) : NULL;
    if (*out) {
        (*out)->set = *made;
        return RAYTALLY_OK;
    }
    rt_rayset_clear(made);
    return (raytally_status)(status != RT_OK ? status : rt_fail_memory(error, "rays", sizeof **out));
}

raytally_status raytally_rays_record(const raytally_accelerator *accelerator, enum raytally_ray_kind kind,
                                     const raytally_record_options *how, raytally_rays **out,
                                     raytally_error *error) {
    RtRaySet made = {0};
    raytally_record_options own = RAYTALLY_RECORD_DEFAULTS;
    RT_C_LOCALE;
    RtStatus status = rt_options_take(&own, sizeof own, how, "raytally_record_options", rt_error_of(error));
    if (status == RT_OK) status = record(accelerator->accel, kind, &own, &made, rt_error_of(error));
    return finish(&made, status, out, rt_error_of(error));
}

raytally_status raytally_rays_copy(enum raytally_ray_kind kind, const raytally_ray *rays, size_t count,
                                   raytally_rays **out, raytally_error *error) {
    RtRaySet made = {0};
    RT_C_LOCALE;
    RtStatus status = copy(kind, rays, count, &made, rt_error_of(error));
    return finish(&made, status, out, rt_error_of(error));
}

void raytally_rays_free(raytally_rays *rays) {
    if (!rays) return;
    rt_rayset_clear(&rays->set);
    rt_free(rays);
}

size_t raytally_rays_count(const raytally_rays *rays) {
    return (size_t)rays->set.count;
}

const raytally_ray *raytally_rays_data(const raytally_rays *rays) {
    return (const raytally_ray *)rays->set.rays;
}

uint64_t raytally_rays_fingerprint(const raytally_rays *rays) {
    return rays->set.fingerprint;
}
