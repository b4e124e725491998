/* SPDX-License-Identifier: Apache-2.0 */
/* A run in order: begin looks at the directory, opens the scenes, and removes the results of a previous run;
 * measure begins the journal and fills the results; finish writes the files made from all of them. Shards are
 * merged by a run that has nothing left to measure, once the directory has their journal. */
#include "run/run.h"

#include "core/base/parallel.h"
#include "core/base/words.h"
#include "experiment/plugins_used.h"
#include "results/result_directory.h"

#include <inttypes.h>
#include <string.h>

static RtStatus write_csvs(const RtResults *results, const char *directory, RtError *error) {
    for (RtResultFile file = 0; file < RT_RESULT_FILE_COUNT; file++) {
        const RtFileSort sort = rt_result_file_sort(results->experiment, file);
        RtOutput output;
        if (sort != RT_FILE_MEASURED && sort != RT_FILE_COUNTED) continue;
        RT_TRY(rt_output_open_in(&output, directory, rt_result_files[file], error));
        rt_result_csv_write(file, results, output.file);
        RT_TRY(rt_output_commit(&output, error));
    }
    return RT_OK;
}

/* ---- a run ---- */

/* The shards that a run joins. */
typedef struct Merge {
    const char *const *directories;
    uint32_t count;
    json_t *journals[RT_MAX_SHARDS];
} Merge;

typedef struct Run {
    const Merge *merge;             /* or NULL */
    RtResults *results;             /* borrowed, like what follows */
    const RtExperiment *experiment; /* that of the results */
    const RtRunOptions *options;
    RtLock lock;
    char path[RT_MAX_PATH];           /* of the journal */
    bool resumed;                     /* the directory has the journal that is resumed */
    bool measured;                    /* anything that the journal did not have */
    RtScene scenes[RT_MAX_WORKLOADS]; /* each until its last workload is over */
    bool opened[RT_MAX_WORKLOADS];
    RtJsonLines journal;
} Run;

static RtStatus path_in(const Run *run, const char *name, char *path, RtError *error) {
    return rt_path_join(run->options->directory, name, path, error);
}

/* ---- the shards ---- */

static const json_t *header_of(const Merge *merge, uint32_t i) {
    return json_array_get(merge->journals[i], 0);
}

static uint32_t number_of(const Merge *merge, uint32_t i, const char *key) {
    return (uint32_t)json_integer_value(json_object_get(header_of(merge, i), key));
}

static RtStatus load_journals(Merge *merge, RtError *error) {
    for (uint32_t i = 0; i < merge->count; i++) {
        char path[RT_MAX_PATH];
        json_auto_t *manifest = NULL;
        RT_TRY(rt_path_join(merge->directories[i], RT_RUN_JOURNAL, path, error));
        if (!rt_file_exists(path))
            return rt_fail(error, RT_BAD_INPUT, "%s is not the directory of a run: it has no %s",
                           merge->directories[i], RT_RUN_JOURNAL);
        if (rt_manifest_read(merge->directories[i], &manifest, NULL) != RT_OK)
            return rt_fail(error, RT_BAD_INPUT,
                           "%s is not finished: finish it with raytally run ... --resume",
                           merge->directories[i]);
        RT_TRY(rt_json_lines_load(path, &merge->journals[i], error));
        if (number_of(merge, i, "shards") > 0) continue;
        return rt_fail(error, RT_BAD_INPUT, "%s is not a shard: it was not run with --shard",
                       merge->directories[i]);
    }
    return RT_OK;
}

static RtStatus check_alike(const Merge *merge, RtError *error) {
    static const char *const keys[] = {"hash", "quick", "build", "shards"};
    static const char *const what[] = {"experiments, or versions of one", "variants (--quick)",
                                       "builds of raytally", "numbers of shards"};
    for (uint32_t i = 1; i < merge->count; i++) {
        for (int k = 0; k < 4; k++) {
            const json_t *a = json_object_get(header_of(merge, 0), keys[k]);
            const json_t *b = json_object_get(header_of(merge, i), keys[k]);
            if (json_equal(a, b)) continue;
            return rt_fail(error, RT_BAD_INPUT, "%s and %s have different %s", merge->directories[0],
                           merge->directories[i], what[k]);
        }
    }
    const char *build = rt_json_text(header_of(merge, 0), "build", "unknown");
    if (strcmp(build, rt_build_alone()) == 0) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s was measured by another build of raytally (%s; this is %s): merge with that one",
                   merge->directories[0], build, rt_build_alone());
}

/* The number of threads that timed the shards, 1 if nothing was timed. It must be the same for all: times on
 * one thread are processor times, times on several are wall times. */
static RtStatus check_same_threads(const Merge *merge, int *threads, RtError *error) {
    uint32_t first = merge->count;
    *threads = 1;
    for (uint32_t i = 0; i < merge->count; i++) {
        for (size_t line = 1; line < json_array_size(merge->journals[i]); line++) {
            const json_t *timed = json_object_get(json_array_get(merge->journals[i], line), "timed");
            int here = (int)json_integer_value(json_object_get(timed, "threads"));
            if (!timed || (first < merge->count && here == *threads)) continue;
            if (first < merge->count)
                return rt_fail(error, RT_BAD_INPUT,
                               "%s was timed on %d thread%s, and %s on %d: their times are not comparable. "
                               "Run one of them again with the --threads of the other, and --force",
                               merge->directories[first], *threads, rt_plural((uint64_t)*threads),
                               merge->directories[i], here);
            first = i;
            *threads = here;
        }
    }
    return RT_OK;
}

/* The shards must have used the plugins that are loaded here, which the manifest will name. */
static RtStatus check_plugins(const Merge *merge, const RtExperiment *experiment, RtError *error) {
    for (uint32_t i = 0; i < merge->count; i++) {
        json_auto_t *changed =
            rt_plugins_changed_since(json_object_get(header_of(merge, i), "plugins"), experiment);
        const char *name = json_object_iter_key(json_object_iter(changed));
        char sentence[RT_MAX_PLUGIN_CHANGE];
        if (!name) continue;
        rt_plugins_change_format(name, json_object_get(changed, name), "there", "here", sentence);
        return rt_fail(error, RT_BAD_INPUT, "%s: %s: load that one", merge->directories[i], sentence);
    }
    return RT_OK;
}

static RtStatus check_whole(const Merge *merge, RtError *error) {
    const char *found[RT_MAX_SHARDS + 1] = {NULL};
    const uint32_t shards = number_of(merge, 0, "shards");
    for (uint32_t i = 0; i < merge->count; i++) {
        const uint32_t shard = number_of(merge, i, "shard");
        if (shard <= RT_MAX_SHARDS && found[shard])
            return rt_fail(error, RT_BAD_INPUT, "shard %u of %u is given twice: %s and %s", shard, shards,
                           found[shard], merge->directories[i]);
        if (shard <= RT_MAX_SHARDS) found[shard] = merge->directories[i];
    }
    for (uint32_t shard = 1; shard <= shards; shard++) {
        if (shard > RT_MAX_SHARDS || !found[shard])
            return rt_fail(error, RT_BAD_INPUT, "shard %u of %u is missing", shard, shards);
    }
    return RT_OK;
}

/* The journal has all lines, shard by shard, after a header without a shard. */
static RtStatus add_shards(const Merge *merge, const RtExperiment *experiment, const char *directory,
                           RtOutputs *files, RtError *error) {
    static const RtSelection all = {0};
    char from[RT_MAX_PATH], to[RT_MAX_PATH];
    for (uint32_t i = 0; i < merge->count * experiment->workload_count; i++) {
        const char *shard = merge->directories[i / experiment->workload_count];
        const uint32_t t = i % experiment->workload_count;
        RT_TRY(rt_results_image_path(shard, experiment, t, from, error));
        RT_TRY(rt_results_image_path(directory, experiment, t, to, error));
        if (rt_file_exists(from)) RT_TRY(rt_outputs_copy(files, from, to, error));
    }
    RT_TRY(rt_path_join(directory, RT_RUN_JOURNAL, to, error));
    json_auto_t *lines = json_array();
    for (uint32_t i = 0; i < merge->count; i++) {
        for (size_t line = 1; line < json_array_size(merge->journals[i]); line++) {
            json_t *object = json_array_get(merge->journals[i], line);
            if (json_is_object(object)) json_array_append(lines, object);
        }
    }
    return rt_journal_add(files, to, experiment, &all, lines, error);
}

/* ---- before ---- */

/* Locks the directory and checks its contents, once it exists. */
static RtStatus take_directory(Run *run, RtError *error) {
    const RtRunOptions *options = run->options;
    if (rt_lock_is_held(&run->lock)) return RT_OK;
    RT_TRY(rt_lock_take(&run->lock, options->directory, error));
    RT_TRY(path_in(run, RT_RUN_JOURNAL, run->path, error));
    /* Loading a journal gives a better error than its existence. */
    if (options->start != RT_START_ANEW && rt_file_exists(run->path))
        RT_TRY(rt_journal_load(run->path, run->results, &options->workload.only, error));
    return rt_result_files_look(options->directory, RT_RUN_JOURNAL, options->start, &run->resumed, error);
}

static bool is_complete(const Run *run) {
    RtWorkloadOptions options = run->options->workload;
    options.only = (RtSelection){.shard = options.only.shard, .shards = options.only.shards};
    for (uint32_t t = 0; t < run->experiment->workload_count; t++) {
        if (!rt_workload_is_done(run->results, t, &options)) return false;
    }
    return true;
}

/* The slot of a workload's scene: the first workload of the same scene. */
static uint32_t slot_of(const RtExperiment *experiment, uint32_t t) {
    uint32_t slot = 0;
    while (strcmp(experiment->workloads[slot].path, experiment->workloads[t].path) != 0) slot++;
    return slot;
}

static RtStatus open_scenes(Run *run, RtError *error) {
    for (uint32_t t = 0; t < run->experiment->workload_count; t++) {
        uint32_t slot = slot_of(run->experiment, t);
        char image[RT_MAX_PATH];
        if (!rt_selection_has_scene(&run->options->workload.only, run->experiment, t)) continue;
        RT_TRY(rt_results_image_path(run->options->directory, run->experiment, t, image, error));
        bool drawn = run->resumed && rt_file_exists(image);
        if (run->opened[slot] || (drawn && rt_workload_is_done(run->results, t, &run->options->workload)))
            continue;
        RT_TRY(rt_workload_open(run->results, t, &run->options->workload, &run->scenes[slot], error));
        run->opened[slot] = !run->results->workloads[t].skipped;
    }
    return RT_OK;
}

/* All cells must be timed on the same number of threads, to be comparable. */
static RtStatus check_threads(const Run *run, RtError *error) {
    const int threads = rt_thread_count(run->options->workload.timing);
    for (RtCellCursor at = {0}; rt_results_next(run->results, &at);) {
        if (!at.cell->timed || at.cell->threads == threads) continue;
        return rt_fail(error, RT_BAD_INPUT,
                       "%s was timed on %d thread%s so far, and this command would use %d: resume with "
                       "--threads %d, or start over with --force",
                       run->options->directory, at.cell->threads, rt_plural((uint64_t)at.cell->threads),
                       threads, at.cell->threads);
    }
    return RT_OK;
}

static const char *const folders[] = {"", "plots", "images"};

static RtStatus make_directory(Run *run, RtError *error) {
    char path[RT_MAX_PATH];
    for (int i = 0; i < 3; i++) {
        RT_TRY(path_in(run, folders[i], path, error));
        RT_TRY(rt_directory_create(path, error));
    }
    RT_TRY(take_directory(run, error));
    for (int i = 0; i < 3; i++) {
        RT_TRY(path_in(run, folders[i], path, error));
        rt_outputs_remove_left(path);
    }
    return RT_OK;
}

static RtStatus copy_files(const Run *run, RtOutputs *copies, RtError *error) {
    const char *directory = run->options->directory;
    char path[RT_MAX_PATH];
    RT_TRY(path_in(run, rt_result_files[RT_FILE_EXPERIMENT], path, error));
    RT_TRY(rt_outputs_copy(copies, run->experiment->path, path, error));
    RT_TRY(rt_scripts_copy(run->experiment, directory, run->resumed, copies, error));
    return run->merge ? add_shards(run->merge, run->experiment, directory, copies, error) : RT_OK;
}

/* Writes the copies, removes the previous results, and then renames the copies. */
static RtStatus replace_previous(Run *run, RtError *error) {
    RT_OWNED(RtOutputs, copies, rt_outputs_clear);
    RT_TRY(copy_files(run, &copies, error));
    if (!run->resumed) RT_TRY(rt_result_files_remove(run->options->directory, RT_RUN_JOURNAL, error));
    return rt_outputs_commit(&copies, error);
}

static RtStatus prepare_directory(Run *run, RtError *error) {
    RT_TRY(rt_scripts_find(run->experiment, error));
    RT_TRY(rt_scripts_check(run->experiment, run->options->directory, run->resumed, run->options->scripts,
                            error));
    RT_TRY(make_directory(run, error));
    return replace_previous(run, error);
}

static RtStatus begin(Run *run, RtError *error) {
    RT_TRY(take_directory(run, error));
    if (run->merge) { /* whose journal is then resumed */
        RT_TRY(prepare_directory(run, error));
        run->resumed = true;
        RT_TRY(rt_journal_load(run->path, run->results, &run->options->workload.only, error));
    }
    RT_TRY(open_scenes(run, error));
    if (run->resumed && !is_complete(run)) RT_TRY(check_threads(run, error));
    return run->merge ? RT_OK : prepare_directory(run, error);
}

/* ---- measuring ---- */

static void name_missing(const Run *run) {
    const char *names[RT_MAX_CANDIDATES];
    char list[1024];
    size_t count = 0;
    for (uint32_t c = 0; c < run->experiment->candidate_count; c++) {
        if (run->experiment->candidates[c].missing) names[count++] = run->experiment->candidates[c].label;
    }
    rt_join_names(names, count, list, sizeof list);
    if (count > 0)
        rt_notify(&run->options->workload.observer,
                  "skipped, because neither this build, with its plugins, nor this machine has them: %s",
                  list);
}

static RtStatus on_event(void *context, const RtResults *results, const RtEvent *event, RtError *error) {
    Run *run = context;
    const RtRunObserver *observer = &run->options->workload.observer;
    char path[RT_MAX_PATH];
    if (!run->measured) { /* the manifest marks a finished run */
        RT_TRY(path_in(run, RT_MANIFEST, path, error));
        remove(path);
        run->measured = true;
    }
    RT_TRY(rt_json_lines_write(&run->journal, rt_journal_line(results, event), error));
    return observer->event ? observer->event(observer->context, results, event, error) : RT_OK;
}

static void on_notice(void *context, const char *message) {
    const Run *run = context;
    rt_notify(&run->options->workload.observer, "%s", message);
}

static RtStatus write_image(Run *run, uint32_t t, RtError *error) {
    const RtWorkloadResult *workload = &run->results->workloads[t];
    const int threads = run->options->workload.threads;
    RtScene *scene = &run->scenes[slot_of(run->experiment, t)];
    char path[RT_MAX_PATH];
    RT_OWNED(RtAccel *, accel, rt_accel_destroy_at);
    RT_OWNED(RtFrame, frame, rt_frame_clear);
    const RtFrameOptions options = {.depth = RT_DEFAULT_DEPTH, .threads = threads};
    RT_TRY(rt_results_image_path(run->options->directory, run->experiment, t, path, error));
    if (workload->skipped || (run->resumed && rt_file_exists(path))) return RT_OK;
    RT_TRY(rt_scene_sample(scene, workload->width, workload->height, 2, false, error));
    RT_TRY(rt_accel_open_on(rt_accel_default(), scene, threads, &accel, error));
    RT_TRY(rt_frame_trace(&frame, accel, &options, error));
    return rt_png_write(&frame, path, error);
}

/* Frees the scene of workload `t`, unless a later workload uses it. */
static void close_scene(Run *run, uint32_t t) {
    uint32_t slot = slot_of(run->experiment, t);
    for (uint32_t later = t + 1; later < run->experiment->workload_count; later++) {
        if (slot_of(run->experiment, later) == slot) return;
    }
    rt_scene_clear(&run->scenes[slot]);
}

static void tell_end(const Run *run) {
    const RtRunObserver *observer = &run->options->workload.observer;
    uint32_t scenes, shards = run->merge ? run->merge->count : 0;
    uint64_t cells = rt_results_size(run->results, &scenes);
    if (shards)
        rt_notify(observer, "joined %" PRIu32 " shard%s: %" PRIu64 " cell%s of %" PRIu32 " scene%s", shards,
                  rt_plural(shards), cells, rt_plural(cells), scenes, rt_plural(scenes));
    else
        rt_notify(observer, "nothing was left to measure: this run is finished. --force starts it over");
}

static RtStatus measure(Run *run, RtError *error) {
    RtWorkloadOptions options = run->options->workload;
    options.observer = (RtRunObserver){run, on_event, on_notice};
    if (run->resumed)
        RT_TRY(rt_journal_drop_changed(run->path, run->experiment, &options.only,
                                       &run->options->workload.observer, error));
    RT_TRY(rt_journal_open(&run->journal, run->path, run->experiment, &options.only, run->resumed, error));
    name_missing(run);
    for (uint32_t t = 0; t < run->experiment->workload_count; t++) {
        RtScene *scene = &run->scenes[slot_of(run->experiment, t)];
        if (!rt_selection_has_scene(&options.only, run->experiment, t)) continue;
        RT_TRY(rt_workload_measure(run->results, t, &options, scene, error));
        RT_TRY(write_csvs(run->results, run->options->directory, error));
        RT_TRY(write_image(run, t, error));
        close_scene(run, t);
    }
    if (!run->measured && run->resumed && is_complete(run)) tell_end(run);
    return RT_OK;
}

/* ---- after ---- */

static RtStatus finish(const Run *run, RtError *error) {
    const RtRunOptions *options = run->options;
    /* If nothing was measured, the existing manifest stays valid, except for claims. */
    if (run->measured || !rt_file_exists_in(options->directory, RT_MANIFEST))
        RT_TRY(rt_manifest_write(run->results, options->workload.threads, options->workload.timing,
                                 options->directory, error));
    else
        RT_TRY(rt_manifest_set_claims(run->results, options->directory, error));
    /* rt_merge has the report written of all shards. */
    if (!options->report || options->workload.only.shards) return RT_OK;
    return options->report(run->results, options->directory, options->scripts, &options->workload.observer,
                           error);
}

static RtStatus run_all(const Merge *merge, RtResults *results, const RtRunOptions *options, RtError *error) {
    Run run = {.merge = merge,
               .results = results,
               .experiment = results->experiment,
               .options = options,
               .lock = RT_NO_LOCK};
    RtStatus status = begin(&run, error);
    if (status == RT_OK) status = measure(&run, error);
    if (status == RT_OK && is_complete(&run)) {
        status = finish(&run, error);
    } else if (status == RT_OK) {
        rt_notify(&options->workload.observer,
                  "a part was measured, which has no report; --resume without --only measures the rest and "
                  "writes it");
    }
    rt_json_lines_close(&run.journal);
    for (uint32_t t = 0; t < RT_MAX_WORKLOADS; t++) rt_scene_clear(&run.scenes[t]);
    rt_lock_release(&run.lock);
    return status;
}

RtStatus rt_run_experiment(RtResults *results, const RtRunOptions *options, RtError *error) {
    return run_all(NULL, results, options, error);
}

static RtStatus merge_all(Merge *merge, RtRunOptions options, RtExperiment *experiment, RtResults *results,
                          RtError *error) {
    RT_TRY(load_journals(merge, error));
    RT_TRY(check_alike(merge, error));
    RT_TRY(check_whole(merge, error));
    RT_TRY(check_same_threads(merge, &options.workload.timing, error));
    RtStatus status = rt_manifest_experiment(merge->directories[0], true, experiment, error);
    if (status == RT_MISMATCH)
        return rt_fail(error, RT_BAD_INPUT, "%s has changed since the shards were made from it",
                       experiment->path);
    RT_TRY(status);
    RT_TRY(check_plugins(merge, experiment, error));
    RT_TRY(rt_results_init(results, experiment, error));
    return run_all(merge, results, &options, error);
}

RtStatus rt_merge(const char *const *directories, uint32_t count, const RtRunOptions *options,
                  RtExperiment *experiment, RtResults *results, RtError *error) {
    Merge merge = {.directories = directories, .count = count};
    *results = (RtResults){0};
    RtStatus status = merge_all(&merge, *options, experiment, results, error);
    for (uint32_t i = 0; i < count; i++) json_decref(merge.journals[i]);
    return status;
}
