/* SPDX-License-Identifier: Apache-2.0 */
/* raytally reproduce: counts a result directory again and compares its exact files byte for byte. */
#include "cli/cli.h"
#include "core/base/memory.h"
#include "core/base/versions.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_CSV_BYTES = 1 << 28, MOST_DIRECTORIES = 1024 };

typedef struct Options {
    const char *directories[MOST_DIRECTORIES];
    uint32_t count;
    const char *scene; /* label of the only scene to count, or of a sweep of scenes; NULL: all */
    bool quick;        /* only the scene that took least work */
} Options;

static void finish(void *options, struct argp_state *state) {
    const Options *o = options;
    if (o->quick && o->scene) argp_error(state, "--quick and --only both choose scenes: give one of them");
}

/* The label of the scene that took least work: objects to build from, tests and steps of all accelerators. */
static const char *cheapest_scene(const RtResults *results) {
    double work[RT_MAX_WORKLOADS] = {0};
    uint32_t best = RT_MAX_WORKLOADS;
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) {
        const RtTally *tally = &at.cell->tally;
        work[at.workload] += (double)results->workloads[at.workload].objects + (double)tally->object_tests +
                             (double)tally->extent_tests + (double)tally->steps;
    }
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        if (work[t] > 0 && (best == RT_MAX_WORKLOADS || work[t] < work[best])) best = t;
    }
    return best < RT_MAX_WORKLOADS ? results->experiment->workloads[best].label : NULL;
}

static RtStatus count_again(RtResults *results, const RtSelection *only, RtError *error) {
    RtWorkloadOptions options = {.timing = 1, .count_only = true, .only = *only};
    RtProgress progress;
    rt_progress_begin(&progress, &options);
    RtStatus status = rt_workloads_run(results, &options, error);
    rt_progress_end(&progress);
    return status;
}

static size_t line_length(const char *line) {
    size_t length = strcspn(line, "\n");
    return length + (line[length] != '\0');
}

static const char *end_of_line(const char *line) {
    if (*line == '\0') return "(nothing more)";
    return strchr(line, '\n') ? "" : " (without an end of line)";
}

typedef struct Again {
    const char *directory;
    const RtResults *results;
    RtSelection only;
    const char *scene;   /* the only one; NULL: all */
    const char *missing; /* a scene with rows in the directory whose file is missing here, or NULL */
    uint64_t compared;   /* lines */
} Again;

static bool is_left_out(Again *again, const char *row) {
    const RtExperiment *experiment = again->results->experiment;
    const char end = *row == '"' ? '"' : ',';
    row += end == '"';
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        const char *label = experiment->workloads[t].label;
        const size_t length = strlen(label);
        if (strncmp(row, label, length) != 0 || row[length] != end) continue;
        if (!rt_selection_has_scene(&again->only, experiment, t)) return true;
        if (!again->results->workloads[t].skipped) return false;
        again->missing = label;
        return true;
    }
    return false;
}

static RtStatus compare(Again *again, const char *path, const char *kept, const char *counted,
                        RtError *error) {
    for (size_t line = 1; *kept || *counted; line++) {
        const size_t length = line_length(kept);
        const bool left_out = line > 1 && *kept && is_left_out(again, kept); /* line 1 names the columns */
        if (!left_out && (length != line_length(counted) || memcmp(kept, counted, length) != 0))
            return rt_fail(error, RT_MISMATCH,
                           "%s:%zu: differs from the new counts:\n  there: %.*s%s\n  now:   %.*s%s", path,
                           line, (int)strcspn(kept, "\n"), kept, end_of_line(kept),
                           (int)strcspn(counted, "\n"), counted, end_of_line(counted));
        kept += length;
        if (left_out) continue;
        counted += length;
        again->compared++;
    }
    return RT_OK;
}

/* Writes the file as it would be now, and compares; without rows of refused accelerators if the kept one, of
 * an older version, has no column for them. */
static RtStatus compare_file(Again *again, RtResultFile file, RtError *error) {
    char path[RT_MAX_PATH], *kept;
    size_t size;
    RtMemoryFile counted = {0};
    RtResults results = *again->results;
    RT_TRY(rt_path_join(again->directory, rt_result_files[file], path, error));
    RT_TRY(rt_file_read(path, MOST_CSV_BYTES, &kept, &size, error));
    const char *column = strstr(kept, ",refused");
    results.refusals = !column || column > kept + strcspn(kept, "\n") ? -1 : 1;
    RtStatus status = rt_memory_file_open(&counted, error);
    if (status == RT_OK) rt_result_csv_write(file, &results, counted.file);
    if (status == RT_OK) status = rt_memory_file_close(&counted, "the counts", error);
    again->compared = 0;
    if (status == RT_OK) status = compare(again, path, kept, counted.data, error);
    if (status == RT_OK && (again->compared > 1 || !again->missing)) /* more than the names of the columns */
        printf("Reproduced: %s%s%s, byte for byte\n",
               again->scene     ? again->scene
               : again->missing ? "the other scenes"
                                : "",
               again->scene || again->missing ? " in " : "", path);
    rt_free(kept);
    rt_free(counted.data);
    return status;
}

static RtStatus compare_all(Again *again, RtError *error) {
    const RtExperiment *experiment = again->results->experiment;
    for (RtResultFile file = 0; file < RT_RESULT_FILE_COUNT; file++) {
        if (rt_result_file_sort(experiment, file) == RT_FILE_COUNTED)
            RT_TRY(compare_file(again, file, error));
    }
    if (!again->missing) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: '%s' was not compared, because its scene is missing here: get it first, as "
                   "`scenes/fetch.sh` does for the public meshes, or start raytally where it was measured",
                   again->directory, again->missing);
}

static void tell_version(const char *directory) {
    json_auto_t *manifest = NULL;
    if (rt_manifest_read(directory, &manifest, NULL) != RT_OK) return;
    const json_t *counts = json_object_get(manifest, "counts");
    if (counts && json_integer_value(counts) != RT_COUNTS_VERSION)
        fprintf(stderr,
                "raytally: %s has counts of version %" JSON_INTEGER_FORMAT
                ", and this raytally makes version %d: some may differ (tests/golden/CHANGES.md)\n",
                directory, json_integer_value(counts), RT_COUNTS_VERSION);
}

/* A scene that is another than it was is the reason for other counts. */
static RtStatus check_scenes(const Again *again, const RtWorkloadResult *then, RtError *error) {
    const RtExperiment *experiment = again->results->experiment;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        const RtWorkloadResult *now = &again->results->workloads[t];
        if (!now->known || !then[t].known || now->scene == then[t].scene) continue;
        return rt_fail(error, RT_MISMATCH,
                       "%s: the scene '%s' has changed: its fingerprint was %016" PRIx64
                       ", and is %016" PRIx64 " here",
                       again->directory, experiment->workloads[t].label, then[t].scene, now->scene);
    }
    return RT_OK;
}

static RtStatus reproduce(const char *directory, RtResults *results, const void *options, RtError *error) {
    const Options *o = options;
    const char *scene = o->quick ? cheapest_scene(results) : o->scene; /* a label of the loaded experiment */
    rt_cli_tell_plugins(directory, results->experiment);
    tell_version(directory);
    /* The original finds its scenes; the copy in the directory only those that are built in. */
    static RtExperiment original;
    static RtWorkloadResult then[RT_MAX_WORKLOADS];
    RtStatus status = rt_manifest_experiment(directory, true, &original, error);
    memcpy(then, results->workloads, results->experiment->workload_count * sizeof *then);
    rt_results_clear(results);
    Again again = {.directory = directory,
                   .results = results,
                   .only = {.parts[0].scene = scene, .part_count = 1},
                   .scene = scene};
    RT_TRY(status);
    RT_TRY(rt_selection_check(&again.only, &original, error));
    RT_TRY(rt_results_init(results, &original, error));
    RT_TRY(count_again(results, &again.only, error));
    RT_TRY(check_scenes(&again, then, error));
    return compare_all(&again, error);
}

static const RtOption options[] = {
    {"only", 0, "SCENE", RT_TO_TEXT(scene),
     "Count and compare only the rows of one scene, or of a sweep of scenes, by its label"},
    {"quick", 0, NULL, RT_TO_FLAG(quick), "The same for the cheapest scene of each directory"},
    RT_LIMIT_OPTIONS,
    {0}};
const RtSyntax rt_reproduce_syntax = {
    .options = options,
    .plugins = true,
    .arguments = "DIR...",
    .argument = {.name = "DIR", .missing = RT_DIRECTORY_MISSING, .value = RT_TO_LIST(directories, count)},
    .finish = finish,
    .help = "Count everything in a result directory again and compare it with DIR/counts.csv, byte for byte. "
            "Several directories are compared one after the other, and the worst exit code counts; "
            "verifications and plain files are skipped. "
            "Start it in the directory in which the experiment was started."};

/* Exit code 2 is worse than 1. */
static RtStatus reproduce_all(const Options *o, RtError *error) {
    RtStatus worst = RT_OK;
    uint32_t failed = 0;
    for (uint32_t i = 0; i < o->count; i++) {
        const char *path = o->directories[i];
        RtError why;
        if (rt_file_exists_in(path,
                              rt_result_files[RT_FILE_VERIFY_CSV]) || /* a verification, or a plain file */
            (rt_file_exists(path) && rt_directory_each(path, "", NULL, NULL) == 0))
            continue;
        RtStatus status = rt_cli_directory_work(path, false, reproduce, o, &why);
        if (status == RT_OK) continue;
        fprintf(stderr, "raytally: %s\n", why.message);
        if (worst == RT_OK || worst == RT_MISMATCH || worst == RT_BROKEN) worst = status;
        failed++;
    }
    if (failed == 0) return RT_OK;
    return rt_fail(error, worst, "%u of %u directories failed", failed, o->count);
}

RtStatus rt_command_reproduce(int argc, char **argv, RtError *error) {
    static Options o;
    rt_cli_parse(&rt_reproduce_syntax, argc, argv, &o);
    if (o.count == 1) return rt_cli_directory_work(o.directories[0], false, reproduce, &o, error);
    return reproduce_all(&o, error);
}
