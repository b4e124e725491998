/* SPDX-License-Identifier: Apache-2.0 */
#include "report/result_directory.h"

#include "experiment/distribution_tables.h"
#include "experiment/journal.h"
#include "experiment/manifest.h"
#include "experiment/result_tables.h"
#include "literature/published_tables.h"
#include "measure/previous_results.h"
#include "report/plot.h"
#include "report/report.h"
#include "report/scripts.h"

/* A run, and what the literature says of it. */
typedef struct Work {
    RtRun run;
    RtPublished published;
} Work;

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

static void write_best(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)results;
    write_published_table(published, RT_BEST, out);
}

static void write_markdown(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)results;
    rt_published_page(published, false, out);
}

static void write_distribution_table(const RtResults *results, RtDistributionTable which, FILE *out) {
    RtDistributionRow row = {.results = results};
    RtTable table = rt_distribution_table(which, &row);
    rt_table_csv(&table, out);
}

static void write_distributions(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)published;
    write_distribution_table(results, RT_DISTRIBUTIONS, out);
}

static void write_histograms(const RtResults *results, const RtPublished *published, FILE *out) {
    (void)published;
    write_distribution_table(results, RT_HISTOGRAMS, out);
}

static bool always(const RtExperiment *experiment) {
    (void)experiment;
    return true;
}

static bool is_published(const RtExperiment *experiment) {
    return experiment->published.table_count > 0;
}

static bool has_distributions(const RtExperiment *experiment) {
    return experiment->distributions;
}

const RtExactFile rt_exact_files[RT_EXACT_FILES] = {
    {"counts.csv", always, write_counts},
    {RT_DISTRIBUTIONS_CSV, has_distributions, write_distributions},
    {RT_HISTOGRAMS_CSV, has_distributions, write_histograms},
    {"published.csv", is_published, write_published},
    {"best.csv", is_published, write_best},
    {"published.md", is_published, write_markdown}};

/* A table that lies in a folder beside the YAML gets to one of the same name, where the copy of the YAML
 * finds it. */
static RtStatus copy_table(const RtRun *run, const char *name, RtOutputs *copies, RtError *error) {
    char from[RT_MAX_PATH], to[RT_MAX_PATH], folder[RT_MAX_PATH];
    RT_TRY(rt_path_join(run->experiment->folder, name, from, error));
    RT_TRY(rt_run_path(run, name, to, error));
    rt_path_folder(to, folder);
    RT_TRY(rt_directory_create(folder, error));
    return rt_outputs_copy(copies, from, to, error);
}

static RtStatus copy_experiment(const RtRun *run, RtOutputs *copies, RtError *error) {
    const RtPublishedSetup *published = &run->experiment->published;
    char path[RT_MAX_PATH];
    RT_TRY(rt_run_path(run, "experiment.yaml", path, error));
    RT_TRY(rt_outputs_copy(copies, run->experiment->path, path, error));
    for (uint32_t i = 0; i < published->table_count; i++)
        RT_TRY(copy_table(run, published->tables[i], copies, error));
    if (*published->reasons) RT_TRY(copy_table(run, published->reasons, copies, error));
    return rt_scripts_copy(run->experiment, run->options->directory, run->resumed, copies, error);
}

/* The copies are on the disk before the earlier results are removed, and get their names after that. */
static RtStatus replace_previous(RtRun *run, RtError *error) {
    RtOutputs copies = {0};
    RtStatus status = copy_experiment(run, &copies, error);
    if (status == RT_OK) status = rt_run_replace(run, error);
    if (status == RT_OK) status = rt_outputs_commit(&copies, error);
    rt_outputs_clear(&copies);
    return status;
}

static RtStatus begin(Work *work, RtError *error) {
    RtRun *run = &work->run;
    RT_TRY(rt_published_load(&work->published, run->experiment, error));
    RT_TRY(rt_scripts_find(run->experiment, error));
    RT_TRY(rt_scripts_check(run->experiment, run->options->directory, run->resumed, run->options->scripts,
                            error));
    RT_TRY(rt_run_begin(run, error));
    return replace_previous(run, error);
}

static RtStatus write_exact(const Work *work, const RtExactFile *file, RtError *error) {
    char path[RT_MAX_PATH];
    RtOutput output;
    RT_TRY(rt_run_path(&work->run, file->name, path, error));
    RT_TRY(rt_output_open(&output, path, error));
    file->write(work->run.results, &work->published, output.file);
    return rt_output_commit(&output, error);
}

/* ---- after ---- */

static RtStatus write_compared(Work *work, RtError *error) {
    if (work->run.experiment->published.table_count == 0) return RT_OK;
    rt_published_compare(&work->published, work->run.results);
    for (size_t i = 0; i < RT_EXACT_FILES; i++) {
        if (rt_exact_files[i].is_wanted == is_published) RT_TRY(write_exact(work, &rt_exact_files[i], error));
    }
    return RT_OK;
}

/* It tells when and with what was measured: where nothing was, the one that is there still does. */
static RtStatus write_manifest(const RtRun *run, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(rt_run_path(run, RT_MANIFEST, path, error));
    if (!run->measured && rt_file_exists(path)) return RT_OK;
    return rt_manifest_write(run->results, &run->options->workload, run->options->directory, error);
}

static RtStatus write_report(const Work *work, RtError *error) {
    const char *directory = work->run.options->directory;
    json_t *manifest;
    RT_TRY(rt_manifest_read(directory, &manifest, error));
    RtStatus status = rt_report_write(work->run.results, &work->published, manifest, directory, error);
    json_decref(manifest);
    return status;
}

static RtStatus finish(Work *work, RtError *error) {
    const RtRun *run = &work->run;
    /* A shard is finished; what is made of all of them is for rt_run_merge. */
    if (run->options->workload.only.shards) return write_manifest(run, error);
    RT_TRY(write_compared(work, error));
    RT_TRY(write_manifest(run, error));
    /* What was measured is worth a report, drawn or not. */
    RtError drawing = {RT_OK, ""};
    RtStatus drawn = rt_plots_draw(run->results, run->options->directory, &drawing);
    RT_TRY(write_report(work, error));
    RtStatus checked = rt_published_check(&work->published, error);
    if (drawn == RT_OK) return checked;
    if (drawn == RT_NOT_AVAILABLE || checked != RT_OK) {
        rt_run_notice(run, drawing.message);
        return checked;
    }
    if (error) *error = drawing;
    return drawn;
}

RtStatus rt_run_experiment(RtResults *results, const RtRunOptions *options, RtError *error) {
    Work work = {0};
    RtStatus status = rt_run_open(&work.run, results, options, error);
    if (status == RT_OK) status = begin(&work, error);
    if (status == RT_OK) status = rt_run_measure(&work.run, error);
    if (status == RT_OK && rt_run_is_complete(&work.run)) {
        status = finish(&work, error);
    } else if (status == RT_OK) {
        rt_run_notice(&work.run, "a part was measured; --resume without --only measures what is left");
    }
    rt_run_close(&work.run);
    rt_published_clear(&work.published);
    return status;
}

RtStatus rt_run_load(const char *directory, RtExperiment *experiment, RtResults *results, RtError *error) {
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
    RtStatus status = rt_experiment_load_from_manifest(experiment, path, manifest, error);
    json_decref(manifest);
    RT_TRY(status);
    RT_TRY(rt_results_init(results, experiment, error));
    return rt_journal_load(journal, results, NULL, false, error);
}
