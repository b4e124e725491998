/* SPDX-License-Identifier: Apache-2.0 */
/* A run in order: begin looks at the directory, opens the scenes, and removes the results of a previous run;
 * measure begins the journal and fills the results; finish writes the files made from all of them. */
#include "run/run.h"

#include "core/base/lock.h"
#include "core/base/parallel.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "render/image.h"
#include "results/journal.h"
#include "results/result_directory.h"

#include <inttypes.h>
#include <string.h>

/* All that the experiment has. */
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

typedef struct Run {
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

/* ---- before ---- */

/* Locks the directory and checks its contents, once it exists. */
static RtStatus take_directory(Run *run, RtError *error) {
    const RtRunOptions *options = run->options;
    if (rt_lock_is_held(&run->lock)) return RT_OK;
    RT_TRY(rt_lock_take(&run->lock, options->directory, error));
    RT_TRY(path_in(run, RT_RUN_JOURNAL, run->path, error));
    /* Loading a journal gives a better error than its existence. */
    if (options->start != RT_START_ANEW && rt_file_exists(run->path)) {
        RT_TRY(rt_journal_load(run->path, run->results, &options->workload.only, error));
    }
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
    const RtRunJoin *join = run->options->join;
    char path[RT_MAX_PATH];
    RT_TRY(path_in(run, rt_result_files[RT_FILE_EXPERIMENT], path, error));
    RT_TRY(rt_outputs_copy(copies, run->experiment->path, path, error));
    RT_TRY(rt_scripts_copy(run->experiment, directory, run->resumed, copies, error));
    return join ? join->add(join->context, run->experiment, directory, copies, error) : RT_OK;
}

/* Writes the copies, removes the previous results, and then renames the copies. */
static RtStatus replace_previous(Run *run, RtError *error) {
    RtOutputs copies = {0};
    RtStatus status = copy_files(run, &copies, error);
    if (status == RT_OK && !run->resumed)
        status = rt_result_files_remove(run->options->directory, RT_RUN_JOURNAL, error);
    if (status == RT_OK) status = rt_outputs_commit(&copies, error);
    rt_outputs_clear(&copies);
    return status;
}

static RtStatus prepare_directory(Run *run, RtError *error) {
    RT_TRY(rt_scripts_find(run->experiment, error));
    RT_TRY(rt_scripts_check(run->experiment, run->options->directory, run->resumed, run->options->scripts,
                            error));
    RT_TRY(make_directory(run, error));
    return replace_previous(run, error);
}

/* Writes the journal of the joined shards, which is then resumed. */
static RtStatus join_shards(Run *run, RtError *error) {
    RT_TRY(prepare_directory(run, error));
    run->resumed = true;
    return rt_journal_load(run->path, run->results, &run->options->workload.only, error);
}

static RtStatus begin(Run *run, RtError *error) {
    const RtRunJoin *join = run->options->join;
    RT_TRY(take_directory(run, error));
    if (join) RT_TRY(join_shards(run, error));
    RT_TRY(open_scenes(run, error));
    if (run->resumed && !is_complete(run)) RT_TRY(check_threads(run, error));
    return join ? RT_OK : prepare_directory(run, error);
}

/* ---- measuring ---- */

static RtStatus open_journal(Run *run, RtError *error) {
    const RtSelection *only = &run->options->workload.only;
    if (run->resumed)
        RT_TRY(rt_journal_drop_changed(run->path, run->experiment, only, &run->options->workload.observer,
                                       error));
    return rt_journal_open(&run->journal, run->path, run->experiment, only, run->resumed, error);
}

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

/* The manifest marks a finished run. */
static RtStatus unfinish(Run *run, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(path_in(run, RT_MANIFEST, path, error));
    remove(path);
    run->measured = true;
    return RT_OK;
}

static RtStatus on_event(void *context, const RtResults *results, const RtEvent *event, RtError *error) {
    Run *run = context;
    const RtRunObserver *observer = &run->options->workload.observer;
    if (!run->measured) RT_TRY(unfinish(run, error));
    RT_TRY(rt_json_lines_write(&run->journal, rt_journal_line(results, event), error));
    return observer->event ? observer->event(observer->context, results, event, error) : RT_OK;
}

static void on_notice(void *context, const char *message) {
    const Run *run = context;
    rt_notify(&run->options->workload.observer, "%s", message);
}

static RtStatus draw_scene(RtScene *scene, const RtWorkloadResult *workload, int threads, const char *path,
                           RtError *error) {
    RtAccel *accel;
    RtFrame frame = {0};
    RtFrameOptions options = {.depth = RT_DEFAULT_DEPTH, .threads = threads};
    RT_TRY(rt_scene_sample(scene, workload->width, workload->height, 2, false, error));
    RT_TRY(rt_accel_open_on(rt_accel_default(), scene, threads, &accel, error));
    RtStatus status = rt_frame_trace(&frame, accel, &options, error);
    if (status == RT_OK) status = rt_png_write(&frame, path, error);
    rt_frame_clear(&frame);
    rt_accel_destroy(accel);
    return status;
}

/* The picture of a workload's scene, unless it exists. */
static RtStatus write_image(Run *run, uint32_t t, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(rt_results_image_path(run->options->directory, run->experiment, t, path, error));
    if (run->results->workloads[t].skipped || (run->resumed && rt_file_exists(path))) return RT_OK;
    return draw_scene(&run->scenes[slot_of(run->experiment, t)], &run->results->workloads[t],
                      run->options->workload.threads, path, error);
}

/* Frees the scene of workload `t`, unless a later workload uses it. */
static void close_scene(Run *run, uint32_t t) {
    uint32_t slot = slot_of(run->experiment, t);
    for (uint32_t later = t + 1; later < run->experiment->workload_count; later++) {
        if (slot_of(run->experiment, later) == slot) return;
    }
    rt_scene_clear(&run->scenes[slot]);
}

/* Says what was done if nothing was measured. */
static void tell_end(const Run *run) {
    const RtRunObserver *observer = &run->options->workload.observer;
    uint32_t scenes, shards = run->options->join ? run->options->join->shards : 0;
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
    RT_TRY(open_journal(run, error));
    name_missing(run);
    for (uint32_t t = 0; t < run->experiment->workload_count; t++) {
        RtScene *scene = &run->scenes[slot_of(run->experiment, t)];
        if (!rt_selection_has_scene(&options.only, run->experiment, t)) continue;
        RT_TRY(rt_workload_measure(run->results, t, &options, scene, error));
        RT_TRY(write_csvs(run->results, run->options->directory, error));
        RT_TRY(write_image(run, t, error));
        close_scene(run, t);
    }
    if (run->measured || !run->resumed || !is_complete(run)) return RT_OK;
    tell_end(run);
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

RtStatus rt_run_experiment(RtResults *results, const RtRunOptions *options, RtError *error) {
    Run run = {.results = results, .experiment = results->experiment, .options = options, .lock = RT_NO_LOCK};
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
