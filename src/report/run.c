#include "report/run.h"

#include "base/lock.h"
#include "bench/journal.h"
#include "bench/manifest.h"
#include "bench/result_tables.h"
#include "literature/published_tables.h"
#include "render/image.h"
#include "report/plot.h"
#include "report/report.h"
#include "scenes/open.h"

#include <string.h>

typedef struct Run {
    RtResults *results;
    const RtExperiment *experiment;
    const RtRunOptions *options;
    RtLock lock;
    bool resumed;  /* the directory has the journal that is gone on with */
    bool measured; /* anything that the journal did not know */
    RtPublished published;
    RtScene scenes[RT_MAX_TRIALS]; /* at slot_of their trials */
    bool opened[RT_MAX_TRIALS];
    RtJsonLines journal;
} Run;

/* ---- what is exact ---- */

static void write_counts(const RtResults *results, const RtPublished *published, FILE *out) {
    RtResultRow row = {.results = results};
    RtTable table = rt_result_table(RT_COUNTS, &row);
    (void)published;
    rt_table_csv(&table, out);
}

static void write_published_table(const RtPublished *published, RtPublishedTable which, FILE *out) {
    RtPublishedCursor cursor = {.published = published};
    RtTable table = rt_published_table(which, &cursor);
    rt_table_csv(&table, out);
}

static void write_published(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)results;
    write_published_table(published, RT_FIGURES, out);
}

static void write_least(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)results;
    write_published_table(published, RT_LEAST, out);
}

static void write_markdown(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)results;
    rt_published_page(published, false, out);
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

/* Keeps others away from the directory and looks at what is there, as soon as it is there. */
static RtStatus take_directory(Run *run, RtError *error) {
    const RtRunOptions *options = run->options;
    char path[RT_MAX_PATH];
    if (rt_lock_is_held(&run->lock)) return RT_OK;
    RT_TRY(rt_lock_take(&run->lock, options->directory, error));
    RT_TRY(in_directory(run, RT_RUN_JOURNAL, path, error));
    /* A journal tells more of itself than that it is there. */
    if (options->start != RT_START_ANEW && rt_file_exists(path)) {
        RT_TRY(rt_journal_load(path, run->results, true, error));
    }
    return rt_earlier_look(options->directory, RT_RUN_JOURNAL, options->start, &run->resumed, error);
}

/* Where a trial's scene is kept: at the first trial of the same scene. */
static uint32_t slot_of(const RtExperiment *experiment, uint32_t t) {
    uint32_t slot = 0;
    while (strcmp(experiment->trials[slot].path, experiment->trials[t].path) != 0) slot++;
    return slot;
}

static RtStatus image_path(const Run *run, uint32_t t, char *path, RtError *error) {
    char name[RT_MAX_LABEL + 16];
    snprintf(name, sizeof name, "images/%s.png", run->experiment->trials[t].label);
    return in_directory(run, name, path, error);
}

static RtStatus open_scenes(Run *run, RtError *error) {
    for (uint32_t t = 0; t < run->experiment->trial_count; t++) {
        uint32_t slot = slot_of(run->experiment, t);
        char image[RT_MAX_PATH];
        RT_TRY(image_path(run, t, image, error));
        bool drawn = run->resumed && rt_file_exists(image);
        if (run->opened[slot] || (drawn && rt_trial_is_done(run->results, t, &run->options->trial))) continue;
        RT_TRY(rt_trial_open(run->results, t, &run->options->trial, &run->scenes[slot], error));
        run->opened[slot] = !run->results->trials[t].skipped;
    }
    return RT_OK;
}

/* Frees the scene of trial `t`, unless a later one is on it, too. */
static void close_scene(Run *run, uint32_t t) {
    uint32_t slot = slot_of(run->experiment, t);
    for (uint32_t later = t + 1; later < run->experiment->trial_count; later++) {
        if (slot_of(run->experiment, later) == slot) return;
    }
    rt_scene_clear(&run->scenes[slot]);
}

/* Up to here nothing of an earlier run was touched. */
static RtStatus open_journal(Run *run, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(in_directory(run, RT_RUN_JOURNAL, path, error));
    if (!run->resumed) rt_earlier_remove(run->options->directory, RT_RUN_JOURNAL);
    return rt_journal_open(&run->journal, path, run->experiment, run->resumed, error);
}

static RtStatus begin(Run *run, RtError *error) {
    RT_TRY(take_directory(run, error));
    RT_TRY(rt_published_load(&run->published, run->experiment, error));
    RT_TRY(rt_plots_find(run->experiment, error));
    RT_TRY(open_scenes(run, error));
    RT_TRY(make_directories(run, error));
    RT_TRY(take_directory(run, error));
    RT_TRY(copy_experiment(run, error));
    RT_TRY(rt_plots_prepare(run->experiment, run->options->directory, error));
    RT_TRY(open_journal(run, error));
    for (uint32_t c = 0; c < run->experiment->contender_count; c++) {
        char message[RT_MAX_LABEL + 64];
        if (!run->experiment->contenders[c].missing) continue;
        snprintf(message, sizeof message, "'%s' is skipped: this build does not have it",
                 run->experiment->contenders[c].label);
        notice(run, message);
    }
    return RT_OK;
}

/* ---- measuring ---- */

static RtStatus on_event(void *context, const RtResults *results, const RtEvent *event, RtError *error) {
    Run *run = context;
    const RtObserver *observer = &run->options->trial.observer;
    run->measured = true;
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
    RtResultRow row = {.results = run->results};
    RtTable table = rt_result_table(RT_TIMES, &row);
    if (run->experiment->count_only) return RT_OK;
    RT_TRY(in_directory(run, "times.csv", path, error));
    RT_TRY(rt_output_open(&output, path, error));
    rt_table_csv(&table, output.file);
    return rt_output_commit(&output, error);
}

static RtStatus draw_scene(RtScene *scene, const RtTrialResult *trial, const char *path, RtError *error) {
    RtAccel *accel;
    RtFrame frame = {0};
    RtImage image = {0};
    RtFrameOptions options = {.depth = RT_DEFAULT_DEPTH};
    RT_TRY(rt_scene_sample(scene, trial->width, trial->height, 2, false, error));
    RT_TRY(rt_accel_open(rt_accel_default(), scene, &accel, error));
    RtStatus status = rt_frame_trace(&frame, accel, &options, error);
    if (status == RT_OK) status = rt_image_from_frame(&image, &frame, error);
    if (status == RT_OK) status = rt_png_write(&image, path, error);
    rt_image_clear(&image);
    rt_frame_clear(&frame);
    rt_accel_destroy(accel);
    return status;
}

/* The picture of a trial's scene, unless it is there. */
static RtStatus write_image(Run *run, uint32_t t, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(image_path(run, t, path, error));
    if (run->results->trials[t].skipped || (run->resumed && rt_file_exists(path))) return RT_OK;
    return draw_scene(&run->scenes[slot_of(run->experiment, t)], &run->results->trials[t], path, error);
}

static RtStatus measure(Run *run, RtError *error) {
    RtTrialOptions options = run->options->trial;
    options.observer = (RtObserver){run, on_event, on_notice};
    for (uint32_t t = 0; t < run->experiment->trial_count; t++) {
        RtScene *scene = &run->scenes[slot_of(run->experiment, t)];
        RT_TRY(rt_trial_measure(run->results, t, &options, scene, error));
        RT_TRY(write_exact(run, &rt_exact_files[0], error));
        RT_TRY(write_times(run, error));
        RT_TRY(write_image(run, t, error));
        close_scene(run, t);
    }
    if (run->measured || !run->resumed) return RT_OK;
    notice(run, "nothing was left to measure: this run is finished. --force begins it anew");
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

/* It tells when and with what was measured: where nothing was, the one that is there still does. */
static RtStatus write_manifest(const Run *run, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(in_directory(run, RT_MANIFEST, path, error));
    if (!run->measured && rt_file_exists(path)) return RT_OK;
    return rt_manifest_write(run->results, &run->options->trial, run->options->directory, error);
}

static RtStatus write_report(const Run *run, RtError *error) {
    json_t *manifest;
    RT_TRY(rt_manifest_read(run->options->directory, &manifest, error));
    RtStatus status =
        rt_report_write(run->results, &run->published, manifest, run->options->directory, error);
    json_decref(manifest);
    return status;
}

static RtStatus finish(Run *run, RtError *error) {
    RT_TRY(write_compared(run, error));
    RT_TRY(write_manifest(run, error));
    /* What was measured is worth a report, drawn or not. */
    RtError drawing = {RT_OK, ""};
    RtStatus drawn = rt_plots_draw(run->results, run->options->directory, &drawing);
    RT_TRY(write_report(run, error));
    RtStatus checked = rt_published_check(&run->published, error);
    if (drawn == RT_OK) return checked;
    if (drawn == RT_NOT_AVAILABLE || checked != RT_OK) {
        notice(run, drawing.message);
        return checked;
    }
    if (error) *error = drawing;
    return drawn;
}

RtStatus rt_run(RtResults *results, const RtRunOptions *options, RtError *error) {
    Run run = {.results = results, .experiment = results->experiment, .options = options, .lock = RT_NO_LOCK};
    RtStatus status = begin(&run, error);
    if (status == RT_OK) status = measure(&run, error);
    rt_json_lines_close(&run.journal);
    if (status == RT_OK) status = finish(&run, error);
    for (uint32_t t = 0; t < RT_MAX_TRIALS; t++) rt_scene_clear(&run.scenes[t]);
    rt_published_clear(&run.published);
    rt_lock_release(&run.lock);
    return status;
}

RtStatus rt_run_load(const char *directory, RtExperiment *experiment, RtResults *results, RtError *error) {
    char path[RT_MAX_PATH], journal[RT_MAX_PATH];
    json_t *manifest;
    *results = (RtResults){0};
    RT_TRY(rt_path_join(directory, "experiment.yaml", path, error));
    RT_TRY(rt_path_join(directory, RT_RUN_JOURNAL, journal, error));
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
