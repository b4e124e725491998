/* SPDX-License-Identifier: Apache-2.0 */
/* raytally plot: draws the plots of a result directory again. */
#include "cli/cli.h"
#include "cli/directory.h"
#include "experiment/scripts.h"
#include "report/plot.h"

#include <stdio.h>
#include <string.h>

typedef struct Options {
    const char *directory;
    RtScripts allowed;
    bool column;
} Options;

static RtStatus draw(const char *directory, RtResults *results, const void *options, RtError *error) {
    const Options *o = options;
    static RtExperiment experiment; /* with the scripts that were added later */
    experiment = *results->experiment;
    RT_TRY(rt_scripts_add_found(&experiment, directory, error));
    results->experiment = &experiment;
    RT_TRY(rt_scripts_check(results->experiment, directory, true, o->allowed, error));
    RtStatus status = rt_plots_draw(results, directory, o->allowed, o->column, error);
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

static const RtOption options[] = {
    {"paper", 0, "WIDTH", RT_TO_TAKE(take_paper),
     "Lay out figures with several panels for one `column` of a paper (3.5 in), or for the `page` (7.16 in, "
     "the default)"},
    RT_TRUST_OPTION(allowed),
    {0}};
const RtSyntax rt_plot_syntax = {
    .options = options,
    .plugins = true,
    .arguments = "DIR",
    .argument = RT_DIRECTORY_ARGUMENT,
    .help =
        "Redraw the plots of a result directory from its CSV files, with the scripts that raytally ships "
        "and those in DIR/plots, also those put there later. A script in DIR/plots, your own or a changed "
        "copy of a shipped one, needs --trust: a gnuplot script can run any command. Exit code 1 if gnuplot "
        "fails; without gnuplot there is a note."};

RtStatus rt_command_plot(int argc, char **argv, RtError *error) {
    Options o = {0};
    rt_cli_parse(&rt_plot_syntax, argc, argv, &o);
    return rt_cli_directory_work(o.directory, true, draw, &o, error);
}
