/* SPDX-License-Identifier: Apache-2.0 */
/* The child that runs under valgrind, and the rays it is given. */
#include "accel/isa.h"
#include "accel/plugin.h"
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/text/json_lines.h"
#include "experiment/callgrind.h"
#include "measure/measure.h"

#include <inttypes.h>
#include <string.h>

enum { PASSES = 2 };

/* ---- files of rays: those of a kind and their answers, as in memory, for the same program ---- */

static RtStatus rays_path(const char *folder, uint32_t workload, RtRayKind kind, char *path, RtError *error) {
    char name[64];
    snprintf(name, sizeof name, "%" PRIu32 "-%s.rays", workload, rt_ray_kind_name(kind));
    return rt_path_join(folder, name, path, error);
}

static RtStatus write_rays(const char *path, const RtRaySet *set, const RtHit *hits, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    fwrite(&set->count, sizeof set->count, 1, output.file);
    fwrite(set->rays, sizeof(RtRay), set->count, output.file);
    fwrite(hits, sizeof(RtHit), set->count, output.file);
    return rt_output_commit(&output, error);
}

RtStatus rt_callgrind_save_rays(const RtCallgrind *callgrind, uint32_t workload, const RtRaySet *set,
                                const RtAccel *accel, RtError *error) {
    enum { RUN = 64 }; /* neighbours, so that packets are coherent */
    char path[RT_MAX_PATH];
    RtRaySet some;
    RT_TRY(rays_path(callgrind->folder, workload, set->kind, path, error));
    RT_TRY(rt_rayset_limit(set, callgrind->most, RUN, &some, error));
    RtHit *hits = rt_alloc(some.count, sizeof(RtHit));
    RtStatus status = hits ? rt_measure_answers(accel, &some, 1, hits, error)
                           : rt_fail_memory(error, "answers", some.count * sizeof(RtHit));
    if (status == RT_OK) status = write_rays(path, &some, hits, error);
    rt_free(hits);
    rt_rayset_clear(&some);
    return status;
}

/* Rays of one kind and their answers; none if there is no file. */
typedef struct Given {
    RtRaySet set;
    const RtHit *hits;
    char *data; /* owned; the hits are in it */
} Given;

static RtStatus read_rays(const char *folder, uint32_t workload, RtRayKind kind, Given *given,
                          RtError *error) {
    char path[RT_MAX_PATH];
    size_t size;
    *given = (Given){.set.kind = kind};
    RT_TRY(rays_path(folder, workload, kind, path, error));
    if (!rt_file_exists(path)) return RT_OK;
    RT_TRY(rt_file_read(path, SIZE_MAX / 2, &given->data, &size, error));
    uint64_t count;
    memcpy(&count, given->data, sizeof count);
    if (size != sizeof count + count * (sizeof(RtRay) + sizeof(RtHit)))
        return rt_fail(error, RT_BAD_INPUT, "%s: not a file of rays of this program", path);
    RT_TRY(rt_rayset_init(&given->set, kind, count, error));
    memcpy(given->set.rays, given->data + sizeof count, count * sizeof(RtRay));
    given->hits = (const RtHit *)(given->data + sizeof count + count * sizeof(RtRay));
    return RT_OK;
}

/* ---- tracing ---- */

/* The function that callgrind counts, by its name. */
__attribute__((noinline, visibility("default"))) RtStatus rt_callgrind_pass(const RtRunner *runner,
                                                                            RtError *error);
RtStatus rt_callgrind_pass(const RtRunner *runner, RtError *error) {
    RtStatus status = runner->run(runner->context, error);
    __asm__ volatile("" ::: "memory"); /* no tail call: the function must end after the pass */
    return status;
}

/* Replaces instruction sets that are not available here, and `best`, by the name of the best one. */
static void settle_isa(RtSpec *spec) {
    const char *best = rt_isa_name(rt_isa_best());
    for (uint32_t i = 0; i < spec->layer_count; i++) {
        RtSpecLayer *layer = &spec->layers[i];
        for (size_t p = 0; p < layer->ops->param_count; p++) {
            const RtParam *param = &layer->ops->params[p];
            char text[RT_MAX_SPEC_CHARS];
            if (strcmp(param->name, "isa") != 0) continue;
            rt_param_format(param, layer->values[p], text, sizeof text);
            if (strcmp(text, "best") != 0 && strcmp(text, "default") != 0 && strcmp(text, "avx512") != 0)
                continue;
            for (uint32_t n = 0; rt_param_try(param, n, text, sizeof text); n++) {
                if (strcmp(text, best) == 0) layer->values[p].choice = n;
            }
        }
    }
}

typedef struct Serving {
    const RtExperiment *experiment;
    const char *folder;
    json_t *broken; /* lines of RT_CALLGRIND_BROKEN, owned */
    FILE *out;
} Serving;

/* What an accelerator did wrong on these rays before, or NULL. */
static const char *why_broken(const Serving *serving, const char *scene, const char *accel,
                              const char *kind) {
    const json_t *line;
    size_t i;
    json_array_foreach(serving->broken, i, line) {
        const char *its_scene, *its_accel, *its_kind, *why;
        if (json_unpack((json_t *)line, "{s:s, s:s, s:s, s:s}", "scene", &its_scene, "accel", &its_accel,
                        "kind", &its_kind, "why", &why) == 0 &&
            strcmp(its_scene, scene) == 0 && strcmp(its_accel, accel) == 0 && strcmp(its_kind, kind) == 0)
            return why;
    }
    return NULL;
}

/* Traces the rays of one kind with *accel, which is built from `spec` if it is NULL. */
static RtStatus serve_kind(const RtSpec *spec, const RtScene *scene, const Given *given, RtAccel **accel,
                           int *passes, RtError *error) {
    RtRunner runner;
    if (!*accel) {
        RT_TRY(rt_plugin_enter(spec, error)); /* callgrind sees this process, so plugins run in it, too */
        RT_TRY(rt_accel_build_here(spec, scene, 1, accel, error));
    }
    RT_TRY(rt_accel_learn(*accel, given->set.rays, given->hits, given->set.count, error));
    RtTimed timed = {.accel = *accel, .set = &given->set};
    RtStatus status = rt_runner_open(&runner, &timed, 1, error);
    for (; *passes < PASSES && status == RT_OK; ++*passes) status = rt_callgrind_pass(&runner, error);
    rt_runner_close(&runner);
    return status;
}

static void serve_accel(const Serving *serving, const RtScene *scene, uint32_t t, uint32_t c,
                        const Given given[RT_RAY_KIND_COUNT]) {
    const RtExperiment *e = serving->experiment;
    RtSpec spec = e->candidates[c].parsed;
    RtAccel *accel = NULL;
    char text[RT_MAX_SPEC_CHARS];
    const char *label = e->candidates[c].label, *at = e->workloads[t].label;
    settle_isa(&spec);
    rt_spec_format(&spec, text);
    for (uint32_t k = 0; k < e->kind_count; k++) {
        const Given *g = &given[e->kinds[k]];
        const char *kind = rt_ray_kind_name(e->kinds[k]), *why = why_broken(serving, at, label, kind);
        RtError failure = {RT_OK, ""};
        int passes = 0;
        if (!g->set.count) continue;
        if (!why && serve_kind(&spec, scene, g, &accel, &passes, &failure) != RT_OK) why = failure.message;
        json_t *row =
            json_pack("{s:s, s:s, s:s, s:i}", "scene", at, "accel", label, "kind", kind, "passes", passes);
        if (why)
            json_object_set_new(row, "why", json_string(why));
        else
            json_object_update_new(row,
                                   json_pack("{s:s, s:I}", "spec", text, "rays", (json_int_t)g->set.count));
        json_dumpf(row, serving->out, JSON_COMPACT);
        fputc('\n', serving->out);
        fflush(serving->out);
        json_decref(row);
    }
    rt_accel_destroy(accel);
}

static RtStatus serve_scene(const Serving *serving, uint32_t t, RtScene *scene, RtError *error) {
    const RtExperiment *e = serving->experiment;
    const RtWorkload *setup = &e->workloads[t];
    Given given[RT_RAY_KIND_COUNT] = {0};
    RtStatus status = rt_scene_sample(scene, setup->width, setup->height, 1, setup->corners, error);
    for (uint32_t k = 0; k < e->kind_count && status == RT_OK; k++)
        status = read_rays(serving->folder, t, e->kinds[k], &given[e->kinds[k]], error);
    for (uint32_t c = 0; c < e->candidate_count && status == RT_OK; c++) {
        if (rt_candidate_runs(e, c, t)) serve_accel(serving, scene, t, c, given);
    }
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        rt_rayset_clear(&given[k].set);
        rt_free(given[k].data);
    }
    return status;
}

RtStatus rt_callgrind_serve(const RtExperiment *experiment, const char *folder, FILE *out, RtError *error) {
    Serving serving = {.experiment = experiment, .folder = folder, .out = out};
    char path[RT_MAX_PATH];
    RT_TRY(rt_path_join(folder, RT_CALLGRIND_BROKEN, path, error));
    if (rt_file_exists(path)) RT_TRY(rt_json_lines_load(path, &serving.broken, error));
    RtStatus status = RT_OK;
    for (uint32_t t = 0; t < experiment->workload_count && status == RT_OK; t++) {
        RtScene scene;
        status = rt_workload_open_scene(&experiment->workloads[t], &scene, error);
        if (status != RT_OK) break;
        status = serve_scene(&serving, t, &scene, error);
        rt_scene_clear(&scene);
    }
    json_decref(serving.broken);
    return status;
}
