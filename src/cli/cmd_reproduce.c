/* SPDX-License-Identifier: Apache-2.0 */
/* raytally reproduce: the counts of a result directory, counted again and compared byte for byte, with all
 * that is made of them alone. */
#include "cli/cli.h"
#include "cli/directory.h"
#include "cli/plugins.h"
#include "cli/progress.h"
#include "core/base/memory.h"
#include "experiment/manifest.h"
#include "report/result_files.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CSV_BYTES = 1 << 28 };

static RtStatus count_again(RtResults *results, RtError *error) {
    RtWorkloadOptions options = {.timing = 1, .count_only = true};
    RtProgress progress = rt_progress_begin(&options);
    options.observer = rt_progress_observer(&progress);
    RtStatus status = RT_OK;
    for (uint32_t t = 0; status == RT_OK && t < results->experiment->workload_count; t++) {
        status = rt_workload_run(results, t, &options, error);
    }
    rt_progress_end(&progress);
    return status;
}

/* What stands behind a line, if not the next one. */
static const char *end_of_line(const char *line) {
    return *line == '\0'                       ? "(nothing more)"
           : line[strcspn(line, "\n")] == '\0' ? " (without an end of line)"
                                               : "";
}

/* RT_MISMATCH with the first line that differs. */
static RtStatus compare(const char *path, const char *kept, const char *counted, RtError *error) {
    if (strcmp(kept, counted) == 0) return RT_OK;
    size_t line = 1, start = 0; /* of the line in hand: up to there the texts are alike */
    for (size_t i = 0; kept[i] && kept[i] == counted[i]; i++) {
        if (kept[i] != '\n') continue;
        line++;
        start = i + 1;
    }
    kept += start;
    counted += start;
    return rt_fail(error, RT_MISMATCH,
                   "%s:%zu: differs from what is counted now:\n  there: %.*s%s\n  now:   %.*s%s", path, line,
                   (int)strcspn(kept, "\n"), kept, end_of_line(kept), (int)strcspn(counted, "\n"), counted,
                   end_of_line(counted));
}

static RtStatus compare_file(const char *directory, RtResultFile file, const RtResults *results,
                             const RtPublished *published, RtError *error) {
    char path[RT_MAX_PATH], *kept = NULL, *counted = NULL;
    size_t size;
    RT_TRY(rt_path_join(directory, rt_result_files[file], path, error));
    FILE *stream = open_memstream(&counted, &size);
    if (!stream) return rt_fail_memory(error, "the counts", 0);
    rt_result_file_write(file, results, published, stream);
    RtStatus status = fclose(stream) == 0 ? RT_OK : rt_fail_memory(error, "the counts", 0);
    if (status == RT_OK) status = rt_file_read(path, MOST_CSV_BYTES, &kept, &size, error);
    if (status == RT_OK) status = compare(path, kept, counted, error);
    if (status == RT_OK) printf("Reproduced: %s, byte for byte\n", path);
    rt_free(kept);
    free(counted);
    return status;
}

static RtStatus compare_all(const char *directory, const RtResults *results, RtError *error) {
    RtPublished published;
    RtStatus status = rt_published_load(&published, results->experiment, error);
    if (status == RT_OK) rt_published_compare(&published, results);
    for (int i = 0; status == RT_OK && i < RT_RESULT_FILE_COUNT; i++) {
        const RtFileSort sort = rt_result_file_sort(results->experiment, (RtResultFile)i);
        if (sort == RT_FILE_COUNTED || sort == RT_FILE_COMPARED)
            status = compare_file(directory, (RtResultFile)i, results, &published, error);
    }
    if (status == RT_OK) status = rt_published_check(&published, error);
    rt_published_clear(&published);
    return status;
}

static RtStatus reproduce(const char *directory, const RtExperiment *experiment, RtResults *results,
                          RtError *error) {
    rt_cli_tell_plugins(directory, experiment);
    /* That is the copy in the directory: its scenes are not found from there. */
    RtExperiment *original = rt_alloc(1, sizeof *original);
    if (!original) return rt_fail_memory(error, "an experiment", sizeof *original);
    RtStatus status = rt_manifest_experiment(directory, original, error);
    rt_results_clear(results);
    if (status == RT_OK) status = rt_results_init(results, original, error);
    if (status == RT_OK) status = count_again(results, error);
    if (status == RT_OK) status = compare_all(directory, results, error);
    rt_results_clear(results);
    rt_free(original);
    return status;
}

typedef struct Options {
    const char *directory;
} Options;

static const struct argp_child children[] = {{&rt_plugin_argp, 0, NULL, 0}, {0}};
const RtSyntax rt_reproduce_syntax = {
    .children = children,
    .arguments = "DIR",
    .argument = RT_DIRECTORY_ARGUMENT,
    .help = "Count everything in a result directory again and compare it with DIR/counts.csv, byte for byte, "
            "and with published figures if the experiment names any. Start it where the experiment was run."};

int rt_command_reproduce(int argc, char **argv) {
    Options o = {0};
    rt_cli_parse(&rt_reproduce_syntax, argc, argv, &o);
    return rt_cli_directory_work(o.directory, false, reproduce);
}
