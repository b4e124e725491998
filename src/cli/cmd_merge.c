/* SPDX-License-Identifier: Apache-2.0 */
/* raytally merge: joins the shards of an experiment. */
#include "claims/claims.h"
#include "cli/cli.h"
#include "cli/progress.h"
#include "report/report.h"
#include "results/result_tables.h"
#include "run/run.h"

#include <stdio.h>

typedef struct Options {
    const char *directories[RT_MAX_SHARDS];
    uint32_t count;
    RtRunOptions how;
} Options;

static void finish(void *options, struct argp_state *state) {
    if (!((Options *)options)->how.directory) argp_error(state, "the result directory is missing: -o DIR");
}

static const RtOption options[] = {
    {"out", 'o', "DIR", RT_TO_TEXT(how.directory), "The result directory to write"},
    {"force", 0, NULL, RT_TO_SET(how.start, RT_START_ANEW), "Replace it: the results in DIR are lost"},
    RT_TRUST_OPTION(how.scripts),
    {0}};

const RtSyntax rt_merge_syntax = {
    .options = options,
    .plugins = true,
    .arguments = "DIR...",
    .argument = {.name = "DIR",
                 .missing = "the directories of the shards are missing, as in results/NAME-*-of-4",
                 .value = RT_TO_LIST(directories, count)},
    .finish = finish,
    .help =
        "Join the shards of a run (`raytally run --shard I/N`) into one result directory, with its tables, "
        "plots and report. counts.csv is the same, byte for byte, as after a run on one machine. times.csv "
        "names the machine that timed each row; one machine times all accelerators on a scene.\v"
        "Every shard must be finished and given once, and all must agree in experiment, build and number of "
        "--threads. Use the same build, in the directory in which the shards were started. Example:\n"
        "  raytally merge results/first-look-*-of-3 -o results/first-look"};

RtStatus rt_command_merge(int argc, char **argv, RtError *error) {
    Options o = {.how = {.report = rt_run_report, .workload.observer.notice = rt_progress_notice}};
    rt_cli_parse(&rt_merge_syntax, argc, argv, &o);
    RtResults results = {0};
    static RtExperiment experiment;
    RtStatus status = rt_merge(o.directories, o.count, &o.how, &experiment, &results, error);
    if (status == RT_OK) {
        rt_print_summary(&results, stdout);
        printf("\nReport: %s/report.html\n", o.how.directory);
    }
    rt_results_clear(&results);
    return status;
}
