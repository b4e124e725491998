/* SPDX-License-Identifier: Apache-2.0 */
#include "results/result_directory.h"

#include "results/distribution_tables.h"
#include "results/frame_table.h"
#include "results/journal.h"
#include "results/manifest.h"
#include "results/result_tables.h"

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
    RtResultRow row = {.results = results};
    RtDistributionRow distribution = {.results = results};
    RtFrameRow frame = {.results = results};
    RtTable table = {0};
    switch (file) {
    case RT_FILE_COUNTS: table = rt_result_table(RT_COUNTS, &row); break;
    case RT_FILE_TIMES: table = rt_result_table(RT_TIMES, &row); break;
    case RT_FILE_ROUNDS: table = rt_result_table(RT_ROUNDS, &row); break;
    case RT_FILE_RENDER: table = rt_result_table(RT_RENDERED, &row); break;
    case RT_FILE_DISTRIBUTIONS: table = rt_distribution_table(RT_DISTRIBUTIONS, &distribution); break;
    case RT_FILE_HISTOGRAMS: table = rt_distribution_table(RT_HISTOGRAMS, &distribution); break;
    case RT_FILE_FRAME: table = rt_frame_table(&frame); break;
    default: return;
    }
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
    RtStatus status = rt_experiment_load_from_manifest(experiment, path, manifest, error);
    json_decref(manifest);
    RT_TRY(status);
    RT_TRY(rt_results_init(results, experiment, error));
    return rt_journal_load(journal, results, NULL, error);
}
