/* SPDX-License-Identifier: Apache-2.0 */
/* Accelerators and tracers of the embedding interface. */
#include "accel/plugin.h"
#include "core/base/memory.h"
#include "library/library.h"

/* ---- specs ---- */

size_t raytally_accelerator_count(void) {
    return rt_accel_count();
}

const char *raytally_accelerator_name(size_t i) {
    return rt_accel_at(i)->name;
}

raytally_status raytally_spec_format(const char *spec, char out[RAYTALLY_SPEC_CHARS], raytally_error *error) {
    RtSpec parsed;
    RT_C_LOCALE;
    RtStatus status = rt_spec_parse(spec, &parsed, rt_error_of(error));
    if (status == RT_OK) rt_spec_format(&parsed, out);
    return (raytally_status)status;
}

/* ---- accelerators ---- */

raytally_status raytally_plugin_load(const char *path, raytally_error *error) {
    RT_C_LOCALE;
    return (raytally_status)rt_plugin_load(path, rt_error_of(error));
}

static RtStatus build(raytally_accelerator *made, const char *text, int threads, RtError *error) {
    RtSpec spec;
    RT_TRY(rt_threads_check(threads, error));
    RT_TRY(rt_spec_parse(text, &spec, error));
    RT_TRY(rt_accel_build(&spec, &made->scene->scene, threads, &made->accel, error));
    rt_spec_format(&spec, made->spec);
    atomic_fetch_add(&made->scene->accelerators, 1);
    return RT_OK;
}

raytally_status raytally_accelerator_build(const raytally_scene *scene, const char *spec, int threads,
                                           raytally_accelerator **out, raytally_error *error) {
    RT_C_LOCALE;
    raytally_accelerator *made = *out = rt_alloc(1, sizeof *made);
    if (!made) return (raytally_status)rt_fail_memory(rt_error_of(error), "an accelerator", sizeof *made);
    made->scene = (raytally_scene *)scene; /* it counts its accelerators */
    RtStatus status = build(made, spec, threads, rt_error_of(error));
    if (status == RT_OK) return RAYTALLY_OK;
    rt_free(made);
    *out = NULL;
    return (raytally_status)status;
}

void raytally_accelerator_free(raytally_accelerator *accelerator) {
    if (!accelerator) return;
    RT_C_LOCALE;
    rt_accel_destroy(accelerator->accel);
    atomic_fetch_sub(&accelerator->scene->accelerators, 1);
    rt_free(accelerator);
}

const char *raytally_accelerator_spec(const raytally_accelerator *accelerator) {
    return accelerator->spec;
}

bool raytally_accelerator_exact(const raytally_accelerator *accelerator) {
    return accelerator->accel->exact;
}

raytally_status raytally_accelerator_check(const raytally_accelerator *accelerator, raytally_error *error) {
    RT_C_LOCALE;
    return (raytally_status)rt_accel_check(accelerator->accel, rt_error_of(error));
}

void raytally_accelerator_describe(const raytally_accelerator *accelerator, raytally_structure *out) {
    RtDescription d;
    RT_C_LOCALE;
    rt_accel_describe(accelerator->accel, &d);
    *out = (raytally_structure){.at = {
                                    [RAYTALLY_INTERIOR] = (double)d.interior,
                                    [RAYTALLY_LEAVES] = (double)d.leaves,
                                    [RAYTALLY_EMPTY_LEAVES] = (double)d.empty_leaves,
                                    [RAYTALLY_REFERENCES] = (double)d.references,
                                    [RAYTALLY_DEPTH] = (double)d.depth,
                                    [RAYTALLY_BYTES] = (double)d.bytes,
                                    [RAYTALLY_PREDICTED_COST] = d.predicted_cost,
                                    [RAYTALLY_PREDICTED_TESTS] = d.predicted_tests,
                                    [RAYTALLY_PREDICTED_STEPS] = d.predicted_steps,
                                }};
}

/* ---- tracers ---- */

bool raytally_ray_is_valid(const raytally_ray *ray) {
    return rt_ray_is_valid((const RtRay *)ray) && ray->kind < RAYTALLY_RAY_KINDS;
}

raytally_status raytally_tracer_new(const raytally_accelerator *accelerator, raytally_tracer **out,
                                    raytally_error *error) {
    RT_C_LOCALE;
    raytally_tracer *made = *out = rt_alloc(1, sizeof *made);
    if (!made) return (raytally_status)rt_fail_memory(rt_error_of(error), "a tracer", sizeof *made);
    RtStatus status = rt_query_init(&made->query, accelerator->accel, rt_error_of(error));
    if (status == RT_OK) return RAYTALLY_OK;
    rt_free(made);
    *out = NULL;
    return (raytally_status)status;
}

void raytally_tracer_free(raytally_tracer *tracer) {
    if (!tracer) return;
    RT_C_LOCALE;
    rt_query_clear(&tracer->query);
    rt_free(tracer);
}

void raytally_tracer_begin(raytally_tracer *tracer) {
    RT_C_LOCALE;
    rt_query_begin(&tracer->query);
}

static void add_tallies(raytally_counters *counters, const RtTally *tallies) {
    for (size_t kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_counters_add(&counters[kind], &tallies[kind]);
}

void raytally_nearest(raytally_tracer *tracer, const raytally_ray *rays, size_t count, raytally_hit *hits,
                      raytally_counters *counters) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    RT_C_LOCALE;
    rt_nearest(&tracer->query, (const RtRay *)rays, count, (RtHit *)hits, counters ? tallies : NULL);
    if (counters) add_tallies(counters, tallies);
}

void raytally_occluded(raytally_tracer *tracer, const raytally_ray *rays, size_t count, bool *blocked,
                       raytally_counters *counters) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    RT_C_LOCALE;
    rt_occluded(&tracer->query, (const RtRay *)rays, count, blocked, counters ? tallies : NULL);
    if (counters) add_tallies(counters, tallies);
}
