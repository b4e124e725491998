/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/run.h"

#include "core/base/parallel.h"
#include "core/base/words.h"
#include "experiment/distribution_tables.h"
#include "experiment/frame_table.h"
#include "experiment/journal.h"
#include "experiment/manifest.h"
#include "experiment/result_tables.h"
#include "render/image.h"

#include <inttypes.h>
#include <string.h>

RtStatus rt_run_path(const RtRun *run, const char *name, char *path, RtError *error) {
    return rt_path_join(run->options->directory, name, path, error);
}

void rt_run_notice(const RtRun *run, const char *message) {
    const RtObserver *observer = &run->options->workload.observer;
    if (observer->notice) observer->notice(observer->context, message);
}

RtStatus rt_run_write_table(const RtRun *run, const char *name, const RtTable *table, RtError *error) {
    char path[RT_MAX_PATH];
    RtOutput output;
    RT_TRY(rt_run_path(run, name, path, error));
    RT_TRY(rt_output_open(&output, path, error));
    rt_table_csv(table, output.file);
    return rt_output_commit(&output, error);
}

/* ---- before ---- */

/* Keeps others away from the directory and looks at what is there, as soon as it is there. */
static RtStatus take_directory(RtRun *run, RtError *error) {
    const RtRunOptions *options = run->options;
    char path[RT_MAX_PATH];
    if (rt_lock_is_held(&run->lock)) return RT_OK;
    RT_TRY(rt_lock_take(&run->lock, options->directory, error));
    RT_TRY(rt_run_path(run, RT_RUN_JOURNAL, path, error));
    /* A journal tells more of itself than that it is there. */
    if (options->start != RT_START_ANEW && rt_file_exists(path)) {
        RT_TRY(rt_journal_load(path, run->results, &options->workload.only, options->renew, error));
    }
    return rt_previous_results_look(options->directory, RT_RUN_JOURNAL, options->start, &run->resumed, error);
}

/* Where a workload's scene is kept: at the first workload of the same scene. */
static uint32_t slot_of(const RtExperiment *experiment, uint32_t t) {
    uint32_t slot = 0;
    while (strcmp(experiment->workloads[slot].path, experiment->workloads[t].path) != 0) slot++;
    return slot;
}

static RtStatus image_path(const RtRun *run, uint32_t t, char *path, RtError *error) {
    char name[RT_MAX_LABEL + 16];
    snprintf(name, sizeof name, "images/%s.png", run->experiment->workloads[t].label);
    return rt_run_path(run, name, path, error);
}

static RtStatus open_scenes(RtRun *run, RtError *error) {
    for (uint32_t t = 0; t < run->experiment->workload_count; t++) {
        uint32_t slot = slot_of(run->experiment, t);
        char image[RT_MAX_PATH];
        if (!rt_only_scene(&run->options->workload.only, run->experiment, t)) continue;
        RT_TRY(image_path(run, t, image, error));
        bool drawn = run->resumed && rt_file_exists(image);
        if (run->opened[slot] || (drawn && rt_workload_is_done(run->results, t, &run->options->workload)))
            continue;
        RT_TRY(rt_workload_open(run->results, t, &run->options->workload, &run->scenes[slot], error));
        run->opened[slot] = !run->results->workloads[t].skipped;
    }
    return RT_OK;
}

/* Cells are timed on as many threads as those that are known: else their times would not compare. */
static RtStatus check_threads(const RtRun *run, RtError *error) {
    const RtExperiment *experiment = run->experiment;
    const int threads = rt_thread_count(run->options->workload.timing);
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            for (uint32_t k = 0; k < experiment->kind_count; k++) {
                const RtCell *cell = rt_cell_at(run->results, t, c, experiment->kinds[k]);
                if (!cell->timed || cell->threads == threads) continue;
                return rt_fail(
                    error, RT_BAD_INPUT,
                    "%s was timed on %d thread%s so far, and would be on %d from here on: go on with "
                    "--threads %d, or start over with --force",
                    run->options->directory, cell->threads, cell->threads == 1 ? "" : "s", threads,
                    cell->threads);
            }
        }
    }
    return RT_OK;
}

RtStatus rt_run_open(RtRun *run, RtResults *results, const RtRunOptions *options, RtError *error) {
    *run = (RtRun){
        .results = results, .experiment = results->experiment, .options = options, .lock = RT_NO_LOCK};
    RT_TRY(take_directory(run, error));
    RT_TRY(open_scenes(run, error));
    return run->resumed && !rt_run_is_complete(run) ? check_threads(run, error) : RT_OK;
}

static const char *const folders[] = {"", "plots", "images"};

RtStatus rt_run_begin(RtRun *run, RtError *error) {
    char path[RT_MAX_PATH];
    for (int i = 0; i < 3; i++) {
        RT_TRY(rt_run_path(run, folders[i], path, error));
        RT_TRY(rt_directory_create(path, error));
    }
    RT_TRY(take_directory(run, error));
    for (int i = 0; i < 3; i++) {
        RT_TRY(rt_run_path(run, folders[i], path, error));
        rt_outputs_remove_left(path);
    }
    return RT_OK;
}

RtStatus rt_run_replace(RtRun *run, RtError *error) {
    if (run->resumed) return RT_OK;
    return rt_previous_results_remove(run->options->directory, RT_RUN_JOURNAL, error);
}

/* ---- measuring ---- */

static RtStatus open_journal(RtRun *run, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(rt_run_path(run, RT_RUN_JOURNAL, path, error));
    if (run->resumed && run->options->renew)
        RT_TRY(rt_journal_renew(path, run->experiment, &run->options->workload.only, error));
    return rt_journal_open(&run->journal, path, run->experiment, &run->options->workload.only, run->resumed,
                           error);
}

static void name_missing(const RtRun *run) {
    for (uint32_t c = 0; c < run->experiment->candidate_count; c++) {
        char message[RT_MAX_LABEL + 64];
        if (!run->experiment->candidates[c].missing) continue;
        snprintf(message, sizeof message, "'%s' is skipped: this build does not have it",
                 run->experiment->candidates[c].label);
        rt_run_notice(run, message);
    }
}

/* The manifest tells of a run that is over, and what was measured until then. */
static RtStatus unfinish(RtRun *run, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(rt_run_path(run, RT_MANIFEST, path, error));
    remove(path);
    run->measured = true;
    return RT_OK;
}

static RtStatus on_event(void *context, const RtResults *results, const RtEvent *event, RtError *error) {
    RtRun *run = context;
    const RtObserver *observer = &run->options->workload.observer;
    if (!run->measured) RT_TRY(unfinish(run, error));
    RT_TRY(rt_journal_append(&run->journal, results, event, error));
    return observer->event ? observer->event(observer->context, results, event, error) : RT_OK;
}

static void on_notice(void *context, const char *message) {
    rt_run_notice(context, message);
}

static RtStatus write_distributions(const RtRun *run, RtError *error) {
    RtDistributionRow row = {.results = run->results};
    RtTable distributions = rt_distribution_table(RT_DISTRIBUTIONS, &row);
    RT_TRY(rt_run_write_table(run, RT_DISTRIBUTIONS_CSV, &distributions, error));
    RtTable histograms = rt_distribution_table(RT_HISTOGRAMS, &row);
    return rt_run_write_table(run, RT_HISTOGRAMS_CSV, &histograms, error);
}

static RtStatus write_tables(const RtRun *run, RtError *error) {
    RtResultRow row = {.results = run->results};
    RtTable counts = rt_result_table(RT_COUNTS, &row);
    RT_TRY(rt_run_write_table(run, "counts.csv", &counts, error));
    if (run->experiment->distributions) RT_TRY(write_distributions(run, error));
    if (run->experiment->count_only) return RT_OK;
    RtTable times = rt_result_table(RT_TIMES, &row);
    RT_TRY(rt_run_write_table(run, "times.csv", &times, error));
    RtTable rounds = rt_result_table(RT_ROUNDS, &row);
    RT_TRY(rt_run_write_table(run, "rounds.csv", &rounds, error));
    if (*run->experiment->frame.without) {
        RtFrameRow frame = {.results = run->results};
        RtTable frames = rt_frame_table(&frame);
        RT_TRY(rt_run_write_table(run, RT_FRAME_CSV, &frames, error));
    }
    if (!run->experiment->hardware) return RT_OK;
    RtTable hardware = rt_result_table(RT_HARDWARE, &row);
    return rt_run_write_table(run, RT_HARDWARE_CSV, &hardware, error);
}

static RtStatus draw_scene(RtScene *scene, const RtWorkloadResult *workload, int threads, const char *path,
                           RtError *error) {
    RtAccel *accel;
    RtFrame frame = {0};
    RtImage image = {0};
    RtFrameOptions options = {.depth = RT_DEFAULT_DEPTH, .threads = threads};
    RT_TRY(rt_scene_sample(scene, workload->width, workload->height, 2, false, error));
    RT_TRY(rt_accel_open_on(rt_accel_default(), scene, threads, &accel, error));
    RtStatus status = rt_frame_trace(&frame, accel, &options, error);
    if (status == RT_OK) status = rt_image_from_frame(&image, &frame, error);
    if (status == RT_OK) status = rt_png_write(&image, path, error);
    rt_image_clear(&image);
    rt_frame_clear(&frame);
    rt_accel_destroy(accel);
    return status;
}

/* The picture of a workload's scene, unless it is there. */
static RtStatus write_image(RtRun *run, uint32_t t, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(image_path(run, t, path, error));
    if (run->results->workloads[t].skipped || (run->resumed && rt_file_exists(path))) return RT_OK;
    return draw_scene(&run->scenes[slot_of(run->experiment, t)], &run->results->workloads[t],
                      run->options->workload.threads, path, error);
}

/* Frees the scene of workload `t`, unless a later one is on it, too. */
static void close_scene(RtRun *run, uint32_t t) {
    uint32_t slot = slot_of(run->experiment, t);
    for (uint32_t later = t + 1; later < run->experiment->workload_count; later++) {
        if (slot_of(run->experiment, later) == slot) return;
    }
    rt_scene_clear(&run->scenes[slot]);
}

bool rt_run_is_complete(const RtRun *run) {
    RtWorkloadOptions options = run->options->workload;
    options.only = (RtOnly){.shard = options.only.shard, .shards = options.only.shards};
    for (uint32_t t = 0; t < run->experiment->workload_count; t++) {
        if (!rt_workload_is_done(run->results, t, &options)) return false;
    }
    return true;
}

/* What was done where nothing was measured. */
static void tell_end(const RtRun *run) {
    char message[128];
    uint32_t scenes;
    uint64_t cells = rt_results_size(run->results, &scenes);
    if (run->options->joined) {
        snprintf(message, sizeof message,
                 "joined %" PRIu32 " shard%s: %" PRIu64 " cell%s of %" PRIu32 " scene%s",
                 run->options->joined, rt_plural(run->options->joined), cells, rt_plural(cells), scenes,
                 rt_plural(scenes));
        rt_run_notice(run, message);
    } else {
        rt_run_notice(run, "nothing was left to measure: this run is finished. --force begins it anew");
    }
}

RtStatus rt_run_measure(RtRun *run, RtError *error) {
    RtWorkloadOptions options = run->options->workload;
    options.observer = (RtObserver){run, on_event, on_notice};
    RT_TRY(open_journal(run, error));
    name_missing(run);
    for (uint32_t t = 0; t < run->experiment->workload_count; t++) {
        RtScene *scene = &run->scenes[slot_of(run->experiment, t)];
        if (!rt_only_scene(&options.only, run->experiment, t)) continue;
        RT_TRY(rt_workload_measure(run->results, t, &options, scene, error));
        RT_TRY(write_tables(run, error));
        RT_TRY(write_image(run, t, error));
        close_scene(run, t);
    }
    if (run->measured || !run->resumed || !rt_run_is_complete(run)) return RT_OK;
    tell_end(run);
    return RT_OK;
}

void rt_run_close(RtRun *run) {
    rt_json_lines_close(&run->journal);
    for (uint32_t t = 0; t < RT_MAX_WORKLOADS; t++) rt_scene_clear(&run->scenes[t]);
    rt_lock_release(&run->lock);
}
