/* SPDX-License-Identifier: Apache-2.0 */
/* Line plots of cost over each swept parameter, for experiments that name no scripts.
 *
 * The generated plots/sweep.gp contains its data, and runs after names.gp and style.gp. For each parameter it
 * draws three figures: time, object tests and steps per ray, over all ray kinds. A figure has a panel for
 * each scene, or for each group of scenes that differ only in the parameter, all with the same axes.
 * Accelerators that differ only in the parameter are one line; one without it is a line without markers. The
 * legend has the order of the lines at their right ends. The axes do not extend to `ideal` if it lies far
 * below. */
#ifndef RT_REPORT_SWEEP_PLOT_H
#define RT_REPORT_SWEEP_PLOT_H

#include "results/results.h"

/* Whether the experiment sweeps parameters and names no plots. */
bool rt_sweep_plots_needed(const RtExperiment *experiment);

/* Writes sweep.gp and style.gp to `directory`/plots, which exists. `column`: as wide as a column of a paper,
 * also with several scenes. */
RtStatus rt_sweep_plots_write(const RtResults *results, const char *directory, bool column, RtError *error);

#endif
