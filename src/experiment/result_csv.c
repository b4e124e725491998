/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/result_csv.h"

#include "experiment/distribution_tables.h"
#include "experiment/frame_table.h"
#include "experiment/result_tables.h"

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
    case RT_FILE_HARDWARE: return timed && e->hardware ? RT_FILE_MEASURED : RT_FILE_OTHER;
    case RT_FILE_PUBLISHED:
    case RT_FILE_BEST:
    case RT_FILE_PUBLISHED_PAGE: return e->published.table_count ? RT_FILE_COMPARED : RT_FILE_OTHER;
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
    case RT_FILE_HARDWARE: table = rt_result_table(RT_HARDWARE, &row); break;
    case RT_FILE_DISTRIBUTIONS: table = rt_distribution_table(RT_DISTRIBUTIONS, &distribution); break;
    case RT_FILE_HISTOGRAMS: table = rt_distribution_table(RT_HISTOGRAMS, &distribution); break;
    case RT_FILE_FRAME: table = rt_frame_table(&frame); break;
    default: return;
    }
    rt_table_csv(&table, out);
}

RtStatus rt_result_csvs_write(const RtResults *results, const char *directory, RtError *error) {
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
