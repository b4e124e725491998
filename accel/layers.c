/* SPDX-License-Identifier: Apache-2.0 */
/* Stacks of accelerators, overlays over a base: building, describing and destroying a stack. */
#include "accel/accel.h"

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <assert.h>

uint64_t rt_accel_byte_limit(const RtScene *scene) {
    const uint64_t bytes = scene->geometry.object_count * RT_ACCEL_OBJECT_BYTES;
    return bytes > RT_ACCEL_MAX_BYTES ? bytes : RT_ACCEL_MAX_BYTES;
}

static void destroy_layer(RtAccel *accel) {
    if (accel->ops->destroy) accel->ops->destroy(accel);
    rt_arena_clear(&accel->memory);
    rt_free(accel);
}

RtStatus rt_accel_build_layer(const RtAccelOps *ops, const RtBuild *what, RtAccel *below, RtAccel **out,
                              RtError *error) {
    assert(ops->bytes >= sizeof(RtAccel));
    RtAccel *accel = rt_alloc(1, ops->bytes);
    if (!accel) return rt_fail_memory(error, ops->name, ops->bytes);
    *accel = (RtAccel){.ops = ops,
                       .scene = what->scene,
                       .below = below,
                       .exact = !below || below->exact,
                       .absolute = below && below->absolute,
                       .counts = !below || below->counts};
    RtStatus status = ops->build ? ops->build(accel, what, error) : RT_OK;
    if (status == RT_OK) status = rt_arena_check(&accel->memory, ops->name, error);
    if (status == RT_OK)
        *out = accel;
    else
        destroy_layer(accel);
    return status;
}

static RtStatus build_layers(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                             RtError *error) {
    RtAccel *top = NULL;
    double start = rt_wall_seconds();
    *out = NULL;
    RT_TRY(rt_spec_available(spec, error));
    for (uint32_t i = spec->layer_count; i-- > 0;) {
        const RtBuild what = {scene, spec->layers[i].values, threads, rt_accel_byte_limit(scene)};
        RtStatus status = rt_accel_build_layer(spec->layers[i].ops, &what, top, &top, error);
        if (status != RT_OK) {
            rt_accel_destroy(top);
            return status;
        }
        top->build_seconds = rt_wall_seconds() - start;
    }
    *out = top;
    return RT_OK;
}

RtStatus rt_accel_build_here(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                             RtError *error) {
    const RtStatus status = build_layers(spec, scene, threads, out, error);
    const bool too_large = status == RT_NO_MEMORY && rt_memory_limit_was_reached();
    return too_large && rt_thread_count(threads) > 1 ? build_layers(spec, scene, 1, out, error) : status;
}

bool rt_accel_refuses(RtStatus status) {
    return status == RT_BAD_INPUT || (status == RT_NO_MEMORY && rt_memory_limit_was_reached());
}

void rt_accel_destroy(RtAccel *accel) {
    while (accel) {
        RtAccel *below = accel->below;
        destroy_layer(accel);
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
    for (; accel; accel = accel->below) {
        if (accel->ops->validate) RT_TRY(accel->ops->validate(accel, error));
    }
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
