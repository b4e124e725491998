/* SPDX-License-Identifier: Apache-2.0 */
/* raytally merge: one result directory from those of the shards of an experiment. */
#include "cli/cli.h"
#include "cli/plugins.h"
#include "cli/summary.h"
#include "core/base/memory.h"
#include "report/merge.h"

#include <argp.h>
#include <stdio.h>

enum { OPT_FORCE = 256, OPT_TRUST };

typedef struct Options {
    char *directories[RT_MAX_SHARDS];
    uint32_t count;
    const char *out;
    RtStart start;
    bool trust;
} Options;

static const struct argp_option options[] = {{"out", 'o', "DIR", 0, "The result directory that is made", 0},
                                             {"force", OPT_FORCE, 0, 0, "Results that are in it are lost", 0},
                                             RT_TRUST_OPTION(OPT_TRUST),
                                             {0}};

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    Options *o = state->input;
    switch (key) {
    case 'o': o->out = argument; return 0;
    case OPT_FORCE: o->start = RT_START_ANEW; return 0;
    case OPT_TRUST: o->trust = true; return 0;
    case ARGP_KEY_ARG:
        if (o->count == RT_MAX_SHARDS) argp_error(state, "at most %d shards can be joined", RT_MAX_SHARDS);
        o->directories[o->count++] = argument;
        return 0;
    case ARGP_KEY_END:
        if (!o->count)
            argp_error(state, "the directories of the shards are missing, as in results/NAME-*-of-4");
        if (!o->out) argp_error(state, "say where to: -o DIR");
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

static void on_notice(void *context, const char *message) {
    (void)context;
    fprintf(stderr, "raytally: %s\n", message);
}

static const struct argp_child children[] = {{&rt_plugin_argp, 0, NULL, 0}, {0}};
const struct argp rt_merge_argp = {
    .children = children,
    .options = options,
    .parser = parse_option,
    .args_doc = "DIR...",
    .doc = "Join what `raytally run --shard I/N` measured on several machines into the "
           "result directory of one run, with its tables, plots and report. counts.csv "
           "is the same, byte for byte, as that of one machine; times.csv says which "
           "machine timed each row, all accelerators on a scene by the same one."
           "\vShards of different experiments, builds or numbers of --threads, and one that is missing, not "
           "finished, or there twice, are refused. Run it with the same build, from "
           "where the shards were run. Example:\n"
           "  raytally merge results/first-look-*-of-3 -o results/first-look"};

int rt_command_merge(int argc, char **argv) {
    Options o = {.start = RT_START_FRESH};
    argp_parse(&rt_merge_argp, argc, argv, 0, 0, &o);
    RtError error;
    RtResults results = {0};
    const RtObserver observer = {.notice = on_notice};
    RtExperiment *experiment = rt_alloc(1, sizeof *experiment);
    RtStatus status = experiment ? rt_merge(o.directories, o.count, o.out, o.start, o.trust, experiment,
                                            &results, &observer, &error)
                                 : rt_fail_memory(&error, "an experiment", sizeof *experiment);
    if (status == RT_OK) {
        rt_cli_print_summary(&results, stdout);
        printf("\nReport: %s/report.html\n", o.out);
    }
    rt_results_clear(&results);
    rt_free(experiment);
    return status == RT_OK ? RT_EXIT_OK : rt_cli_fail(&error);
}
