/* SPDX-License-Identifier: Apache-2.0 */
/* raytally plot: the plots of a result directory, drawn again. */
#include "cli/cli.h"
#include "cli/directory.h"
#include "report/plot.h"
#include "report/scripts.h"

#include <stdio.h>

static RtStatus draw(const char *directory, RtResults *results, RtScripts allowed, RtError *error) {
    RT_TRY(rt_scripts_check(results->experiment, directory, true, allowed, error));
    RtStatus status = rt_plots_draw(results, directory, error);
    if (status == RT_OK) printf("Plots: %s/plots\n", directory);
    if (status != RT_NOT_AVAILABLE) return status;
    fprintf(stderr, "raytally: %s\n", error->message);
    return RT_OK;
}

static RtStatus draw_shipped(const char *directory, const RtExperiment *experiment, RtResults *results,
                             RtError *error) {
    (void)experiment;
    return draw(directory, results, RT_SCRIPTS_SHIPPED, error);
}

static RtStatus draw_all(const char *directory, const RtExperiment *experiment, RtResults *results,
                         RtError *error) {
    (void)experiment;
    return draw(directory, results, RT_SCRIPTS_ALL, error);
}

enum { OPT_TRUST = 256 };

typedef struct Options {
    const char *directory;
    bool trust;
} Options;

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    Options *o = state->input;
    (void)argument;
    switch (key) {
    case OPT_TRUST: o->trust = true; return 0;
    case ARGP_KEY_INIT: state->child_inputs[0] = &o->directory; return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

static const struct argp_option options[] = {RT_TRUST_OPTION(OPT_TRUST), {0}};
static const struct argp_child children[] = {{&rt_directory_argp, 0, NULL, 0}, {0}};
const struct argp rt_plot_argp = {
    .options = options,
    .parser = parse_option,
    .doc =
        "Draw the plots of a result directory again, from its CSV files and the scripts in DIR/plots. A "
        "script that raytally does not ship, your own or a changed one, is run with --trust alone: gnuplot "
        "runs any command that a script asks for. Exit code 1 where gnuplot fails; without gnuplot there "
        "is a note.",
    .children = children};

int rt_command_plot(int argc, char **argv) {
    Options o = {0};
    argp_parse(&rt_plot_argp, argc, argv, 0, 0, &o);
    return rt_cli_directory_work(o.directory, true, o.trust ? draw_all : draw_shipped);
}
