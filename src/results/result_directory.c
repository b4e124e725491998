/* SPDX-License-Identifier: Apache-2.0 */
#include "results/result_directory.h"

#include "core/base/parallel.h"
#include "core/base/versions.h"
#include "measure/machine.h"
#include "results/journal.h"
#include "results/result_tables.h"

/* ---- the manifest ---- */

static json_t *lines_json(const char *text) {
    json_t *list = json_array();
    for (const char *end; *text; text = *end ? end + 1 : end) {
        end = text + strcspn(text, "\n");
        json_array_append_new(list, json_stringn(text, (size_t)(end - text)));
    }
    return list;
}

static json_t *scenes_json(const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    json_t *list = json_array();
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        const RtWorkloadResult *workload = &results->workloads[t];
        json_t *sets = json_object();
        for (uint32_t k = 0; workload->known && k < experiment->kind_count; k++)
            json_object_set_new(sets, rt_ray_kind_name(experiment->kinds[k]),
                                rt_ray_set_json(workload, experiment->kinds[k]));
        json_array_append_new(
            list, json_pack("{s:s, s:s, s:b, s:I, s:o, s:I, s:I, s:b, s:b, s:I, s:o, s:o}", "scene",
                            experiment->workloads[t].label, "scene_spec", experiment->workloads[t].spec,
                            "skipped", workload->skipped, "objects", (json_int_t)workload->objects, "hash",
                            rt_json_hex(workload->scene), "width", (json_int_t)workload->width, "height",
                            (json_int_t)workload->height, "corners", experiment->workloads[t].corners,
                            "light_from_outside", experiment->workloads[t].light_from_outside, "depth",
                            (json_int_t)experiment->workloads[t].depth, "rays", sets, "warnings",
                            lines_json(workload->warnings)));
    }
    return list;
}

static json_t *candidates_json(const RtExperiment *experiment) {
    json_t *list = json_array();
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        const RtCandidate *candidate = &experiment->candidates[c];
        json_t *scenes = json_array();
        for (uint32_t t = 0; t < experiment->workload_count; t++) {
            if (candidate->excluded >> t & 1) continue;
            json_array_append_new(scenes, json_string(experiment->workloads[t].label));
        }
        json_t *entry = json_pack("{s:s, s:s, s:I, s:b, s:o}", "accel", candidate->label, "spec",
                                  candidate->spec, "ray_stride", (json_int_t)candidate->ray_stride, "missing",
                                  candidate->missing, "scenes", scenes);
        json_t *members = candidate->member_count ? json_array() : NULL;
        for (uint32_t i = 0; i < candidate->member_count; i++)
            json_array_append_new(members, json_string(experiment->candidates[candidate->members[i]].label));
        if (members) entry = rt_json_add(entry, "best_of", members);
        json_array_append_new(list, entry);
    }
    return list;
}

static json_t *manifest_json(const RtResults *results, int counting, int timing) {
    const RtExperiment *experiment = results->experiment;
    return json_pack("{s:i, s:i, s:s, s:s, s:o, s:s, s:s, s:b, s:I, s:I, s:I, s:I, s:I, s:I, s:s, s:o, s:i, "
                     "s:i, s:o, s:o, s:o}",
                     "format", RT_FILE_FORMAT, "counts", RT_COUNTS_VERSION, "experiment", experiment->name,
                     "file", experiment->path, "hash", rt_json_hex(experiment->fingerprint), "question",
                     experiment->question, "prediction", experiment->prediction, "quick", experiment->quick,
                     "seed", (json_int_t)experiment->seed, "limit", (json_int_t)experiment->limit,
                     "coherent_run", (json_int_t)experiment->coherent_run, "rounds",
                     (json_int_t)experiment->rounds, "builds", (json_int_t)experiment->builds, "milliseconds",
                     (json_int_t)experiment->milliseconds, "baseline", rt_baseline_label(experiment), "date",
                     rt_json_now(), "threads_counting", rt_thread_count(counting), "threads_timing",
                     rt_thread_count(timing), "scenes", scenes_json(results), "accelerators",
                     candidates_json(experiment), "machine", rt_machine_json());
}

/* The claims with which the run began, and those of now if they are others. */
static void set_claims(json_t *manifest, const RtResults *results) {
    json_t *now = rt_claims_json(results->experiment);
    json_object_set(manifest, "claims", results->first_claims ? results->first_claims : now);
    if (rt_claims_are_changed(results))
        json_object_set(manifest, "claims_changed", now);
    else
        json_object_del(manifest, "claims_changed");
    json_decref(now);
}

RtStatus rt_manifest_set_claims(const RtResults *results, const char *directory, RtError *error) {
    char path[RT_MAX_PATH];
    json_t *manifest;
    RT_TRY(rt_path_join(directory, RT_MANIFEST, path, error));
    if (!results->first_claims) return RT_OK; /* of version 1.0 */
    RT_TRY(rt_manifest_read(directory, &manifest, error));
    set_claims(manifest, results);
    return rt_json_save(path, manifest, error);
}

RtStatus rt_manifest_write(const RtResults *results, int counting, int timing, const char *directory,
                           RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(rt_path_join(directory, RT_MANIFEST, path, error));
    json_t *manifest = manifest_json(results, counting, timing);
    set_claims(manifest, results);
    return rt_json_save(path, manifest, error);
}

RtStatus rt_manifest_read(const char *directory, json_t **manifest, RtError *error) {
    char path[RT_MAX_PATH];
    json_error_t fault;
    *manifest = NULL;
    if (!rt_file_exists(directory))
        return rt_fail(error, RT_BAD_INPUT, "there is no directory %s", directory);
    RT_TRY(rt_path_join(directory, RT_MANIFEST, path, error));
    if (!rt_file_exists(path)) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s is not a finished result directory: it has no manifest.json; `raytally run "
                       "EXPERIMENT --out %s --resume` measures what is missing",
                       directory, directory);
    }
    *manifest = json_load_file(path, 0, &fault);
    if (!*manifest)
        return rt_fail_at(error, path, fault.line > 0 ? (size_t)fault.line : 0, 0,
                          "%s; the file is damaged: run the experiment again", fault.text);
    RtStatus status = rt_json_check_format(*manifest, path, error);
    if (status == RT_OK) return RT_OK;
    json_decref(*manifest);
    *manifest = NULL;
    return status;
}

static RtStatus load_experiment(const json_t *manifest, const char *directory, bool elsewhere,
                                RtExperiment *experiment, RtError *error) {
    const char *file = json_string_value(json_object_get(manifest, "file"));
    char copy[RT_MAX_PATH];
    const json_t *hash = json_object_get(manifest, "hash");
    if (!file || !json_is_string(hash)) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s/manifest.json does not say what was run: give the YAML of the experiment",
                       directory);
    }
    RT_TRY(rt_path_join(directory, rt_result_files[RT_FILE_EXPERIMENT], copy, error));
    if (!rt_file_exists(file) && elsewhere) file = copy;
    if (!rt_file_exists(file)) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s cannot be read here: start raytally in the folder in which %s was measured", file,
                       directory);
    }
    RT_TRY(
        rt_experiment_load(experiment, file, json_is_true(json_object_get(manifest, "quick")), NULL, error));
    const json_int_t run = json_integer_value(json_object_get(manifest, "coherent_run"));
    if (run > 0) experiment->coherent_run = (uint64_t)run; /* its default was another in older versions */
    if (rt_experiment_has_hash(experiment, hash)) return RT_OK;
    return rt_fail(error, RT_MISMATCH,
                   "%s has changed since %s was made from it (its copy there is experiment.yaml)", file,
                   directory);
}

RtStatus rt_manifest_experiment(const char *directory, bool elsewhere, RtExperiment *experiment,
                                RtError *error) {
    json_t *manifest;
    RT_TRY(rt_manifest_read(directory, &manifest, error));
    RtStatus status = load_experiment(manifest, directory, elsewhere, experiment, error);
    json_decref(manifest);
    return status;
}

/* ---- the other files ---- */

RtFileSort rt_result_file_sort(const RtExperiment *e, RtResultFile file) {
    const bool timed = !e->count_only;
    switch (file) {
    case RT_FILE_COUNTS: return RT_FILE_COUNTED;
    case RT_FILE_DISTRIBUTIONS:
    case RT_FILE_HISTOGRAMS: return e->distributions ? RT_FILE_COUNTED : RT_FILE_OTHER;
    case RT_FILE_TIMES:
    case RT_FILE_ROUNDS: return timed ? RT_FILE_MEASURED : RT_FILE_OTHER;
    case RT_FILE_FRAME: return timed && *e->frame.without ? RT_FILE_MEASURED : RT_FILE_OTHER;
    case RT_FILE_RENDER: return timed && e->render ? RT_FILE_MEASURED : RT_FILE_OTHER;
    default: return RT_FILE_OTHER;
    }
}

void rt_result_csv_write(RtResultFile file, const RtResults *results, FILE *out) {
    static const RtResultTable tables[] = {
        [RT_FILE_COUNTS] = RT_COUNTS,         [RT_FILE_TIMES] = RT_TIMES,
        [RT_FILE_ROUNDS] = RT_ROUNDS,         [RT_FILE_DISTRIBUTIONS] = RT_DISTRIBUTIONS,
        [RT_FILE_HISTOGRAMS] = RT_HISTOGRAMS, [RT_FILE_RENDER] = RT_RENDERED};
    RtResultRow row = {.results = results};
    RtFrameRow frame = {.results = results};
    const RtTable table =
        file == RT_FILE_FRAME ? rt_frame_table(&frame) : rt_result_table(tables[file], &row);
    rt_table_csv(&table, out);
}

RtStatus rt_results_image_path(const char *directory, const RtExperiment *experiment, uint32_t workload,
                               char *path, RtError *error) {
    char name[RT_MAX_LABEL + 24];
    snprintf(name, sizeof name, "images/%s.png", experiment->workloads[workload].file_name);
    return rt_path_join(directory, name, path, error);
}

RtStatus rt_results_load(const char *directory, RtExperiment *experiment, RtResults *results,
                         RtError *error) {
    char path[RT_MAX_PATH], journal[RT_MAX_PATH];
    json_t *manifest;
    *results = (RtResults){0};
    RT_TRY(rt_path_join(directory, "experiment.yaml", path, error));
    RT_TRY(rt_path_join(directory, RT_RUN_JOURNAL, journal, error));
    RT_TRY(rt_manifest_read(directory, &manifest, error));
    if (!rt_file_exists(path)) {
        json_decref(manifest);
        return rt_fail(error, RT_BAD_INPUT,
                       "%s is not the result directory of an experiment: it has no experiment.yaml",
                       directory);
    }
    RtStatus status = rt_experiment_load(experiment, path, json_is_true(json_object_get(manifest, "quick")),
                                         manifest, error);
    json_decref(manifest);
    RT_TRY(status);
    RT_TRY(rt_results_init(results, experiment, error));
    return rt_journal_load(journal, results, NULL, error);
}
