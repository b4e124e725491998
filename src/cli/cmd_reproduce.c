/* SPDX-License-Identifier: Apache-2.0 */
/* raytally reproduce: counts a result directory again and compares its exact files byte for byte. */
#include "cli/cli.h"
#include "cli/directory.h"
#include "cli/plugins.h"
#include "cli/progress.h"
#include "core/base/memory.h"
#include "experiment/manifest.h"
#include "experiment/result_csv.h"
#include "literature/published_tables.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CSV_BYTES = 1 << 28 };

typedef struct Options {
    const char *directory;
    const char *scene; /* label of the only scene to count, or of a sweep of scenes; NULL: all */
} Options;

static RtOnly only_scene(const char *scene) {
    return (RtOnly){.parts[0].scene = scene, .part_count = 1};
}

static RtStatus count_again(RtResults *results, const char *scene, RtError *error) {
    RtWorkloadOptions options = {.timing = 1, .count_only = true, .only = only_scene(scene)};
    RtProgress progress = rt_progress_begin(&options);
    options.observer = rt_progress_observer(&progress);
    RtStatus status = rt_workloads_run(results, &options, error);
    rt_progress_end(&progress);
    return status;
}

/* With its '\n', if there is one. */
static size_t line_length(const char *line) {
    size_t length = strcspn(line, "\n");
    return length + (line[length] != '\0');
}

/* A note if the line is not followed by another. */
static const char *end_of_line(const char *line) {
    return *line == '\0'                       ? "(nothing more)"
           : line[strcspn(line, "\n")] == '\0' ? " (without an end of line)"
                                               : "";
}

/* Whether a table has a row that begins with the same field, the scene. */
static bool has_scene_of(const char *table, const char *row) {
    const size_t field = *row == '"' ? strcspn(row + 1, "\"") + 2 : strcspn(row, ",\n");
    for (; *table; table += line_length(table)) {
        if (strncmp(table, row, field + 1) == 0) return true;
    }
    return false;
}

/* Compares line by line; RT_MISMATCH with the first line that differs. If only `some` scenes were counted,
 * rows of the others are skipped. */
static RtStatus compare(const char *path, const char *kept, const char *counted, bool some, RtError *error) {
    const char *const table = counted;
    for (size_t line = 1; *kept || *counted; line++) {
        size_t length = line_length(kept);
        bool skipped = some && *kept && !has_scene_of(table, kept);
        if (!skipped && (length != line_length(counted) || memcmp(kept, counted, length) != 0)) {
            return rt_fail(error, RT_MISMATCH,
                           "%s:%zu: differs from the new counts:\n  there: %.*s%s\n  now:   %.*s%s", path,
                           line, (int)strcspn(kept, "\n"), kept, end_of_line(kept),
                           (int)strcspn(counted, "\n"), counted, end_of_line(counted));
        }
        kept += length;
        if (!skipped) counted += length;
    }
    return RT_OK;
}

static RtStatus compare_file(const char *directory, RtResultFile file, const RtResults *results,
                             const RtPublished *published, const char *scene, RtError *error) {
    char path[RT_MAX_PATH], *kept = NULL, *counted = NULL;
    size_t size;
    RT_TRY(rt_path_join(directory, rt_result_files[file], path, error));
    FILE *stream = open_memstream(&counted, &size);
    if (!stream) return rt_fail_memory(error, "the counts", 0);
    if (rt_result_file_sort(results->experiment, file) == RT_FILE_COMPARED)
        rt_published_file_write(file, published, stream);
    else
        rt_result_csv_write(file, results, stream);
    RtStatus status = fclose(stream) == 0 ? RT_OK : rt_fail_memory(error, "the counts", 0);
    if (status == RT_OK) status = rt_file_read(path, MOST_CSV_BYTES, &kept, &size, error);
    if (status == RT_OK) status = compare(path, kept, counted, scene, error);
    if (status == RT_OK)
        printf("Reproduced: %s%s%s, byte for byte\n", scene ? scene : "", scene ? " in " : "", path);
    rt_free(kept);
    free(counted);
    return status;
}

/* Comparisons with published figures need all scenes. */
static RtStatus compare_all(const char *directory, const RtResults *results, const char *scene,
                            RtError *error) {
    RtPublished published;
    RtStatus status = rt_published_load(&published, results->experiment, error);
    if (status == RT_OK && !scene) rt_published_compare(&published, results);
    for (RtResultFile file = 0; status == RT_OK && file < RT_RESULT_FILE_COUNT; file++) {
        const RtFileSort sort = rt_result_file_sort(results->experiment, file);
        if (sort == RT_FILE_COUNTED || (sort == RT_FILE_COMPARED && !scene))
            status = compare_file(directory, file, results, &published, scene, error);
    }
    if (status == RT_OK && !scene) status = rt_published_check(&published, error);
    rt_published_clear(&published);
    return status;
}

static RtStatus reproduce(const char *directory, RtResults *results, const void *options, RtError *error) {
    const char *scene = ((const Options *)options)->scene;
    rt_cli_tell_plugins(directory, results->experiment);
    /* The copy in the directory does not find its scenes; the original does. */
    static RtExperiment original;
    RtStatus status = rt_manifest_experiment(directory, &original, error);
    rt_results_clear(results);
    const RtOnly only = only_scene(scene);
    if (status == RT_OK) status = rt_only_check(&only, &original, error);
    if (status == RT_OK) status = rt_results_init(results, &original, error);
    if (status == RT_OK) status = count_again(results, scene, error);
    if (status == RT_OK) status = compare_all(directory, results, scene, error);
    rt_results_clear(results);
    return status;
}

static const RtOption options[] = {{"only", 0, "SCENE", RT_TO_TEXT(scene),
                                    "Count and compare only the rows of one scene, or of a sweep of scenes, "
                                    "by its label; published figures are left out"},
                                   {0}};
const RtSyntax rt_reproduce_syntax = {
    .options = options,
    .plugins = true,
    .arguments = "DIR",
    .argument = RT_DIRECTORY_ARGUMENT,
    .help = "Count everything in a result directory again and compare it with DIR/counts.csv, byte for byte, "
            "and with published figures if the experiment names any. Start it where the experiment was run."};

RtStatus rt_command_reproduce(int argc, char **argv, RtError *error) {
    Options o = {0};
    rt_cli_parse(&rt_reproduce_syntax, argc, argv, &o);
    return rt_cli_directory_work(o.directory, false, reproduce, &o, error);
}
