/* SPDX-License-Identifier: Apache-2.0 */
/* raytally plot: the plots of a result directory, drawn again. */
#include "cli/cli.h"
#include "cli/directory.h"
#include "report/plot.h"

#include <stdio.h>

static RtStatus plot(const char *directory, const RtExperiment *experiment, RtResults *results,
                     RtError *error) {
    (void)experiment;
    RtStatus status = rt_plots_draw(results, directory, error);
    if (status == RT_OK) printf("Plots: %s/plots\n", directory);
    if (status != RT_NOT_AVAILABLE) return status;
    fprintf(stderr, "raytally: %s\n", error->message);
    return RT_OK;
}

int rt_command_plot(int argc, char **argv) {
    return rt_cli_directory(
        argc, argv,
        "Draw the plots of a result directory again, from its CSV files and the scripts in "
        "DIR/plots. Exit code 1 where gnuplot fails; without gnuplot there is a note.",
        true, plot);
}
