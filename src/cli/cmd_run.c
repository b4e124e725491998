/* SPDX-License-Identifier: Apache-2.0 */
/* raytally run: an experiment, from its YAML to a result directory. */
#include "base/memory.h"
#include "bench/result_tables.h"
#include "cli/cli.h"
#include "cli/progress.h"
#include "report/result_directory.h"

#include <argp.h>
#include <stdio.h>
#include <string.h>

enum { OPT_RESUME = 256, OPT_FORCE, OPT_QUICK, OPT_UNTIL, OPT_PATIENCE };

typedef struct Options {
    const char *path, *out;
    RtStart start;
    bool quick;
    int threads, timing;
    double until, patience;
} Options;

static const struct argp_option options[] = {
    {"out", 'o', "DIR", 0, "The result directory (results/NAME)", 0},
    {"resume", OPT_RESUME, 0, 0,
     "Go on where an interrupted run stopped; what it measured is kept. Of a finished one, write tables and "
     "plots again",
     0},
    {"force", OPT_FORCE, 0, 0,
     "Start over: the results in DIR are lost. Of --resume and --force the last one counts", 0},
    {"threads", 't', "N", 0,
     "Threads, 0 for all processors. Left out: timing on one, by its processor time, and building and "
     "counting on all; on several, wall time is compared",
     0},
    RT_UNTIL_OPTIONS(OPT_UNTIL, OPT_PATIENCE),
    {"quick", OPT_QUICK, 0, 0, "The smaller variant that the YAML describes under `quick`", 0},
    {0}};

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    Options *o = state->input;
    switch (key) {
    case 'o': o->out = argument; return 0;
    case OPT_RESUME: o->start = RT_START_RESUME; return 0;
    case OPT_FORCE: o->start = RT_START_ANEW; return 0;
    case 't': o->threads = o->timing = (int)rt_cli_integer(state, "--threads", argument, 0, 1024); return 0;
    case OPT_UNTIL: o->until = rt_cli_percent(state, "--until", argument); return 0;
    case OPT_PATIENCE:
        o->patience = (double)rt_cli_integer(state, "--patience", argument, 1, 86400);
        return 0;
    case OPT_QUICK: o->quick = true; return 0;
    case ARGP_KEY_ARG:
        if (o->path) argp_error(state, "one EXPERIMENT at a time; '%s' is a second one", argument);
        o->path = argument;
        return 0;
    case ARGP_KEY_END:
        if (!o->path) argp_error(state, "an EXPERIMENT is missing, as in experiments/first-look.yaml");
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

static RtStatus run(const Options *o, RtExperiment *experiment, RtError *error) {
    char directory[RT_MAX_PATH], sentence[RT_MAX_SENTENCE];
    RtResults results;
    RT_TRY(rt_experiment_load(experiment, o->path, o->quick, error));
    if (o->until > 0 && experiment->rounds < RT_FULL_ROUNDS) experiment->rounds = RT_FULL_ROUNDS;
    snprintf(directory, sizeof directory, "results/%s", experiment->name);
    RtProgress progress = rt_progress_begin(experiment, experiment->count_only ? 1 : 2);
    RtRunOptions how = {.directory = o->out ? o->out : directory,
                        .start = o->start,
                        .workload = {.threads = o->threads,
                                     .timing = o->timing,
                                     .until = o->until,
                                     .patience = o->patience,
                                     .observer = rt_progress_observer(&progress)}};
    RtStatus status = rt_results_init(&results, experiment, error);
    if (status == RT_OK) status = rt_run_experiment(&results, &how, error);
    rt_progress_end(&progress);
    if (status == RT_OK) {
        rt_print_results(&results, RT_TOTALS, stdout);
        rt_null_sentence(&results, sentence);
        printf("\n%s%sReport: %s/report.html\n", sentence, *sentence ? "\n" : "", how.directory);
    }
    rt_results_clear(&results);
    return status;
}

int rt_command_run(int argc, char **argv) {
    Options o = {.timing = 1, .patience = RT_PATIENCE};
    const struct argp argp = {.options = options,
                              .parser = parse_option,
                              .args_doc = "EXPERIMENT.yaml",
                              .doc =
                                  "Run an experiment and write its result directory: counts.csv, times.csv, "
                                  "manifest.json, plots, images and report.html. A directory with results, "
                                  "finished or not, is refused without --resume or --force; so is one that "
                                  "another process writes into."
                                  "\vExit code 1 if an accelerator answers wrong, gnuplot fails (without "
                                  "gnuplot there is a note), or a published figure is missed. "
                                  "experiments/README.md says how to write an experiment."};
    argp_parse(&argp, argc, argv, 0, 0, &o);
    RtError error;
    RtExperiment *experiment = rt_alloc(1, sizeof *experiment);
    RtStatus status = experiment ? run(&o, experiment, &error)
                                 : rt_fail_memory(&error, "an experiment", sizeof *experiment);
    rt_free(experiment);
    return status == RT_OK ? RT_EXIT_OK : rt_cli_fail(&error);
}
