#include "experiments/run.h"

#include "experiments/families.h"
#include "experiments/journal.h"
#include "experiments/manifest.h"
#include "experiments/plot.h"
#include "experiments/report.h"
#include "experiments/tables.h"
#include "render/image.h"

#include <string.h>

typedef struct Run {
    RtResults *results;
    const RtExperiment *experiment;
    const RtRunOptions *options;
    RtPublished published;
    RtJsonLines journal;
} Run;

/* ---- what is exact ---- */

static void write_counts(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)published;
    rt_counts_csv(results, out);
}

static void write_published(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)results;
    rt_published_csv(published, out);
}

static void write_least(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)results;
    rt_least_csv(published, out);
}

static void write_markdown(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)results;
    rt_published_markdown(published, out);
}

const RtExactFile rt_exact_files[RT_EXACT_FILES] = {{"counts.csv", false, write_counts},
                                                    {"published.csv", true, write_published},
                                                    {"least.csv", true, write_least},
                                                    {"published.md", true, write_markdown}};

static RtStatus in_directory(const Run *run, const char *name, char *path, RtError *error) {
    return rt_path_join(run->options->directory, name, path, error);
}

static void notice(const Run *run, const char *message) {
    const RtObserver *observer = &run->options->trial.observer;
    if (observer->notice) observer->notice(observer->context, message);
}

/* ---- before ---- */

static RtStatus make_directories(const Run *run, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(in_directory(run, "plots", path, error));
    RT_TRY(rt_directory_create(path, error));
    RT_TRY(in_directory(run, "images", path, error));
    return rt_directory_create(path, error);
}

/* A table that lies in a folder beside the YAML gets to one of the same name, where the copy of the YAML
 * finds it. */
static RtStatus copy_table(const Run *run, const char *name, RtError *error) {
    char from[RT_MAX_PATH], to[RT_MAX_PATH], folder[RT_MAX_PATH];
    RT_TRY(rt_path_join(run->experiment->folder, name, from, error));
    RT_TRY(in_directory(run, name, to, error));
    rt_path_folder(to, folder);
    RT_TRY(rt_directory_create(folder, error));
    return rt_file_copy(from, to, error);
}

static RtStatus copy_experiment(const Run *run, RtError *error) {
    const RtPublishedSetup *published = &run->experiment->published;
    char path[RT_MAX_PATH];
    RT_TRY(in_directory(run, "experiment.yaml", path, error));
    RT_TRY(rt_file_copy(run->experiment->path, path, error));
    for (uint32_t i = 0; i < published->table_count; i++)
        RT_TRY(copy_table(run, published->tables[i], error));
    return *published->reasons ? copy_table(run, published->reasons, error) : RT_OK;
}

static RtStatus open_journal(Run *run, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(in_directory(run, "cells.jsonl", path, error));
    bool resume = run->options->resume && rt_file_exists(path);
    if (resume) RT_TRY(rt_journal_load(path, run->results, true, error));
    return rt_journal_open(&run->journal, path, run->experiment, resume, error);
}

static RtStatus begin(Run *run, RtError *error) {
    for (uint32_t t = 0; t < run->experiment->trial_count; t++) {
        RT_TRY(rt_trial_find_scene(&run->experiment->trials[t], error));
    }
    RT_TRY(rt_published_load(&run->published, run->experiment, error));
    RT_TRY(make_directories(run, error));
    RT_TRY(open_journal(run, error));
    RT_TRY(copy_experiment(run, error));
    for (uint32_t c = 0; c < run->experiment->contender_count; c++) {
        char message[RT_MAX_LABEL + 64];
        if (!run->experiment->contenders[c].missing) continue;
        snprintf(message, sizeof message, "'%s' is skipped: this build does not have it",
                 run->experiment->contenders[c].label);
        notice(run, message);
    }
    return rt_plots_prepare(run->experiment, run->options->directory, error);
}

/* ---- measuring ---- */

static RtStatus on_event(void *context, const RtResults *results, const RtEvent *event, RtError *error) {
    Run *run = context;
    const RtObserver *observer = &run->options->trial.observer;
    RT_TRY(rt_journal_append(&run->journal, results, event, error));
    return observer->event ? observer->event(observer->context, results, event, error) : RT_OK;
}

static void on_notice(void *context, const char *message) {
    notice(context, message);
}

static RtStatus write_exact(const Run *run, const RtExactFile *file, RtError *error) {
    char path[RT_MAX_PATH];
    RtOutput output;
    RT_TRY(in_directory(run, file->name, path, error));
    RT_TRY(rt_output_open(&output, path, error));
    file->write(run->results, &run->published, output.file);
    return rt_output_commit(&output, error);
}

static RtStatus write_times(const Run *run, RtError *error) {
    char path[RT_MAX_PATH];
    RtOutput output;
    if (run->experiment->count_only) return RT_OK;
    RT_TRY(in_directory(run, "times.csv", path, error));
    RT_TRY(rt_output_open(&output, path, error));
    rt_times_csv(run->results, output.file);
    return rt_output_commit(&output, error);
}

static RtStatus draw_scene(RtScene *scene, const RtTrialResult *trial, int threads, const char *path,
                           RtError *error) {
    RtSpec spec;
    RtAccel *accel;
    RtFrame frame = {0};
    RtImage image = {0};
    RtFrameOptions options = {.depth = RT_DEFAULT_DEPTH, .threads = threads};
    RT_TRY(rt_scene_sample(scene, trial->width, trial->height, 2, false, error));
    RT_TRY(rt_spec_parse(rt_accel_default(), &spec, error));
    RT_TRY(rt_accel_build(&spec, scene, threads, &accel, error));
    RtStatus status = rt_frame_trace(&frame, accel, &options, error);
    if (status == RT_OK) status = rt_image_from_frame(&image, &frame, error);
    if (status == RT_OK) status = rt_png_write(&image, path, error);
    rt_image_clear(&image);
    rt_frame_clear(&frame);
    rt_accel_destroy(accel);
    return status;
}

/* The picture of a trial's scene, unless it is there. */
static RtStatus write_image(const Run *run, uint32_t t, RtError *error) {
    char name[RT_MAX_LABEL + 16], path[RT_MAX_PATH];
    RtScene scene;
    snprintf(name, sizeof name, "images/%s.png", run->experiment->trials[t].label);
    RT_TRY(in_directory(run, name, path, error));
    if (run->results->trials[t].skipped || (run->options->resume && rt_file_exists(path))) return RT_OK;
    RT_TRY(rt_hard_scene_open(run->experiment->trials[t].path, &scene, error));
    const int threads = run->options->trial.threads;
    RtStatus status = draw_scene(&scene, &run->results->trials[t], threads, path, error);
    rt_scene_clear(&scene);
    return status;
}

static RtStatus measure(Run *run, RtError *error) {
    RtTrialOptions options = run->options->trial;
    options.observer = (RtObserver){run, on_event, on_notice};
    for (uint32_t t = 0; t < run->experiment->trial_count; t++) {
        RT_TRY(rt_trial_run(run->results, t, &options, error));
        RT_TRY(write_exact(run, &rt_exact_files[0], error));
        RT_TRY(write_times(run, error));
        RT_TRY(write_image(run, t, error));
    }
    return RT_OK;
}

/* ---- after ---- */

static RtStatus write_compared(Run *run, RtError *error) {
    if (run->experiment->published.table_count == 0) return RT_OK;
    rt_published_compare(&run->published, run->results);
    for (size_t i = 0; i < RT_EXACT_FILES; i++) {
        if (rt_exact_files[i].published) RT_TRY(write_exact(run, &rt_exact_files[i], error));
    }
    return RT_OK;
}

static RtStatus finish(Run *run, RtError *error) {
    json_t *manifest;
    RT_TRY(write_compared(run, error));
    RT_TRY(rt_manifest_write(run->results, &run->options->trial, run->options->directory, error));
    /* What was measured is worth a report, drawn or not. */
    RtError drawing;
    RtStatus status = rt_plots_draw(run->results, run->options->directory, &drawing);
    if (status != RT_OK) notice(run, drawing.message);
    RT_TRY(rt_manifest_read(run->options->directory, &manifest, error));
    status = rt_report_write(run->results, &run->published, manifest, run->options->directory, error);
    json_decref(manifest);
    return status == RT_OK ? rt_published_check(&run->published, error) : status;
}

RtStatus rt_run(RtResults *results, const RtRunOptions *options, RtError *error) {
    Run run = {.results = results, .experiment = results->experiment, .options = options};
    RtStatus status = begin(&run, error);
    if (status == RT_OK) status = measure(&run, error);
    rt_json_lines_close(&run.journal);
    if (status == RT_OK) status = finish(&run, error);
    rt_published_clear(&run.published);
    return status;
}

RtStatus rt_run_load(const char *directory, RtExperiment *experiment, RtResults *results, RtError *error) {
    char path[RT_MAX_PATH], journal[RT_MAX_PATH];
    json_t *manifest;
    *results = (RtResults){0};
    RT_TRY(rt_path_join(directory, "experiment.yaml", path, error));
    RT_TRY(rt_path_join(directory, "cells.jsonl", journal, error));
    RT_TRY(rt_manifest_read(directory, &manifest, error));
    bool quick = json_is_true(json_object_get(manifest, "quick"));
    json_decref(manifest);
    if (!rt_file_exists(path)) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s is no result directory of an experiment: it has no experiment.yaml", directory);
    }
    RT_TRY(rt_experiment_load(experiment, path, quick, error));
    RT_TRY(rt_results_init(results, experiment, error));
    return rt_journal_load(journal, results, false, error);
}
