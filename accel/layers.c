/* SPDX-License-Identifier: Apache-2.0 */
/* Stacks of accelerators, overlays over a base: building, describing and destroying a stack. */
#include "accel/accel.h"

#include "core/base/clock.h"

uint64_t rt_accel_byte_limit(const RtScene *scene) {
    const uint64_t bytes = scene->geometry.object_count * RT_ACCEL_OBJECT_BYTES;
    return bytes > RT_ACCEL_MAX_BYTES ? bytes : RT_ACCEL_MAX_BYTES;
}

RtStatus rt_accel_build_here(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                             RtError *error) {
    RtAccel *top = NULL;
    double start = rt_wall_seconds();
    *out = NULL;
    RT_TRY(rt_spec_available(spec, error));
    for (uint32_t i = spec->layer_count; i-- > 0;) {
        RtAccel *accel = NULL;
        const RtBuild what = {spec->layers[i].ops,       scene, spec->layers[i].values, top, threads,
                              rt_accel_byte_limit(scene)};
        RtStatus status = what.ops->build(&what, &accel, error);
        if (status != RT_OK) {
            rt_accel_destroy(top);
            return status;
        }
        accel->build_seconds = rt_wall_seconds() - start;
        top = accel;
    }
    *out = top;
    return RT_OK;
}

void rt_accel_destroy(RtAccel *accel) {
    while (accel) {
        RtAccel *below = accel->below;
        accel->ops->destroy(accel);
        accel = below;
    }
}

const RtAccel *rt_accel_base(const RtAccel *accel) {
    while (accel->below) accel = accel->below;
    return accel;
}

void rt_accel_describe(const RtAccel *accel, RtDescription *out) {
    accel->ops->describe(accel, out);
    out->build = accel->build_tally;
    while ((accel = accel->below)) {
        RtDescription own;
        accel->ops->describe(accel, &own);
        out->interior += own.interior;
        out->leaves += own.leaves;
        out->empty_leaves += own.empty_leaves;
        out->references += own.references;
        out->bytes += own.bytes;
        rt_tally_add(&out->build, &accel->build_tally);
        if (own.depth > out->depth) out->depth = own.depth;
#define COPY_PREDICTION(name, meaning) out->name = own.name;
        RT_PREDICTIONS(COPY_PREDICTION)
        RT_QUALITIES(COPY_PREDICTION)
#undef COPY_PREDICTION
    }
}

RtStatus rt_accel_validate(const RtAccel *accel, RtError *error) {
    for (; accel; accel = accel->below) RT_TRY(accel->ops->validate(accel, error));
    return RT_OK;
}

RtStatus rt_accel_check(const RtAccel *accel, RtError *error) {
    for (; accel; accel = accel->below) {
        if (accel->ops->check) RT_TRY(accel->ops->check(accel, error));
    }
    return RT_OK;
}

RtStatus rt_accel_learn(RtAccel *accel, const RtRay *rays, const RtHit *hits, size_t count, RtError *error) {
    for (; accel; accel = accel->below) {
        if (accel->ops->learn) RT_TRY(accel->ops->learn(accel, rays, hits, count, error));
    }
    return RT_OK;
}
