/* SPDX-License-Identifier: Apache-2.0 */
/* raytally merge, plot and report: result directories joined from shards, and their plots, reports and index
 * made again. */
#include "claims/findings.h"
#include "cli/cli.h"
#include "core/base/file.h"
#include "core/base/words.h"
#include "report/plot.h"
#include "report/report.h"
#include "results/result_tables.h"
#include "run/run.h"

#include <stdio.h>
#include <string.h>

RtStatus rt_cli_directory_work(const char *directory, bool writes, RtDirectoryWork *work, const void *options,
                               RtError *error) {
    __attribute__((cleanup(rt_lock_release))) RtLock lock = RT_NO_LOCK;
    RT_OWNED(RtResults, results, rt_results_clear);
    static RtExperiment experiment;
    if (writes) RT_TRY(rt_lock_take(&lock, directory, error));
    RT_TRY(rt_results_load(directory, &experiment, &results, error));
    return work(directory, &results, options, error);
}

typedef struct Options {
    const char *directories[RT_MAX_SHARDS]; /* of `merge` the shards; else one */
    uint32_t count;
    RtRunOptions how;   /* of `merge`; of `plot` only the allowed scripts */
    bool column;        /* of `plot` */
    const char *folder; /* of `report`, or NULL */
    bool strict;        /* of `report` */
} Options;

#define ONE_DIRECTORY RT_ARGUMENT("DIR", directories[0], RT_DIRECTORY_MISSING)

/* ---- merge ---- */

static void finish_merge(void *options, struct argp_state *state) {
    if (!((Options *)options)->how.directory) argp_error(state, "the result directory is missing: -o DIR");
}

static const RtOption merge_options[] = {
    {"out", 'o', "DIR", RT_TO_TEXT(how.directory), "The result directory to write"},
    {"force", 0, NULL, RT_TO_SET(how.start, RT_START_ANEW), "Replace it: the results in DIR are lost"},
    RT_TRUST_OPTION(how.scripts),
    {0}};

const RtSyntax rt_merge_syntax = {
    .options = merge_options,
    .plugins = true,
    .arguments = "DIR...",
    .argument = {.name = "DIR",
                 .missing = "the directories of the shards are missing, as in results/NAME-*-of-4",
                 .value = RT_TO_LIST(directories, count)},
    .finish = finish_merge,
    .help =
        "Join the shards of a run (`raytally run --shard I/N`) into one result directory, with its tables, "
        "plots and report. counts.csv is the same, byte for byte, as after a run on one machine. times.csv "
        "names the machine that timed each row; one machine times all accelerators on a scene.\v"
        "Every shard must be finished and given once, and all must agree in experiment, build and "
        "number of --threads. Use the same build, in the directory in which the shards were started. "
        "Example:\n"
        "  raytally merge results/first-look-*-of-3 -o results/first-look"};

RtStatus rt_command_merge(int argc, char **argv, RtError *error) {
    Options o = {.how = {.report = rt_run_report, .workload.observer.notice = rt_progress_notice}};
    rt_cli_parse(&rt_merge_syntax, argc, argv, &o);
    RT_OWNED(RtResults, results, rt_results_clear);
    static RtExperiment experiment;
    RT_TRY(rt_merge(o.directories, o.count, &o.how, &experiment, &results, error));
    rt_print_summary(&results, o.how.directory, stdout);
    printf("\nReport: %s/report.html\n", o.how.directory);
    return RT_OK;
}

/* ---- plot ---- */

static RtStatus draw(const char *directory, RtResults *results, const void *options, RtError *error) {
    const Options *o = options;
    static RtExperiment experiment; /* with the scripts that were added later */
    experiment = *results->experiment;
    RT_TRY(rt_scripts_add_found(&experiment, directory, error));
    results->experiment = &experiment;
    RT_TRY(rt_scripts_check(results->experiment, directory, true, o->how.scripts, error));
    RtStatus status = rt_plots_draw(results, directory, o->how.scripts, o->column, error);
    if (status == RT_OK) printf("Plots: %s/plots\n", directory);
    if (status != RT_NOT_AVAILABLE) return status;
    fprintf(stderr, "raytally: %s\n", error->message);
    return RT_OK;
}

static void take_paper(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    o->column = strcmp(text, "column") == 0;
    if (o->column || strcmp(text, "page") == 0) return;
    argp_error(state, "--paper: invalid value '%s': expected column or page", text);
}

static const RtOption plot_options[] = {
    {"paper", 0, "WIDTH", RT_TO_TAKE(take_paper),
     "Lay out figures with several panels for one `column` of a paper (3.5 in), or for the `page` (7.16 in, "
     "the default)"},
    RT_TRUST_OPTION(how.scripts),
    {0}};
const RtSyntax rt_plot_syntax = {
    .options = plot_options,
    .plugins = true,
    .arguments = "DIR",
    .argument = ONE_DIRECTORY,
    .help =
        "Redraw the plots of a result directory from its CSV files, with the scripts that raytally ships "
        "and those in DIR/plots, also those put there later. A script in DIR/plots, your own or a changed "
        "copy of a shipped one, needs --trust: a gnuplot script can run any command. Exit code 1 if gnuplot "
        "fails; without gnuplot there is a note."};

RtStatus rt_command_plot(int argc, char **argv, RtError *error) {
    Options o = {0};
    rt_cli_parse(&rt_plot_syntax, argc, argv, &o);
    return rt_cli_directory_work(o.directories[0], true, draw, &o, error);
}

/* ---- report ---- */

static RtStatus report(const char *directory, RtResults *results, const void *options, RtError *error) {
    const Options *o = options;
    const char *warning = results->experiment->warning.message;
    if (*warning) fprintf(stderr, "raytally: %s\n", warning);
    RT_TRY(rt_report_write(results, directory, error));
    rt_claims_print(results, stdout);
    rt_findings_print(results, directory, stdout);
    printf("%sReport: %s/report.html\n", results->experiment->claim_count ? "\n" : "", directory);
    return o->strict ? rt_findings_check(results, directory, error) : RT_OK;
}

static void take_index(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    if (o->folder) argp_error(state, "one FOLDER at a time; '%s' is a second one", text);
    o->folder = text;
}

static void finish_report(void *options, struct argp_state *state) {
    const Options *o = options;
    if (o->folder && o->directories[0])
        argp_error(state, "--index FOLDER covers all directories in FOLDER, and takes no DIR");
    if (!o->folder && !o->directories[0]) argp_error(state, RT_DIRECTORY_MISSING);
}

static const RtOption report_options[] = {
    {"index", 'i', "FOLDER", RT_TO_TAKE(take_index),
     "Write FOLDER/index.html and FOLDER/index.md, which list all result directories in FOLDER, as in "
     "`--index results`"},
    {"strict", 0, NULL, RT_TO_FLAG(strict),
     "Exit code 1 if a claim, an expression of the finding or a verdict on a paper does not hold"},
    {0}};
const RtSyntax rt_report_syntax = {
    .options = report_options,
    .plugins = true,
    .arguments = "DIR\n--index FOLDER",
    .argument = RT_ARGUMENT("DIR", directories[0], NULL),
    .finish = finish_report,
    .help = "Rewrite DIR/report.html, tables.md and tables.tex from the results in DIR.\n"
            "With --index, write FOLDER/index.html and (for GitHub) FOLDER/index.md, which list all result "
            "directories in FOLDER and its subfolders by the `section` of their experiments."};

RtStatus rt_command_report(int argc, char **argv, RtError *error) {
    Options o = {0};
    rt_cli_parse(&rt_report_syntax, argc, argv, &o);
    if (o.folder) {
        size_t count;
        RT_TRY(rt_index_write(o.folder, &count, error));
        printf("Index: %s/index.html and index.md, of %zu experiment%s\n", o.folder, count, rt_plural(count));
        return RT_OK;
    }
    return rt_cli_directory_work(o.directories[0], true, report, &o, error);
}
