/* SPDX-License-Identifier: Apache-2.0 */
/* Line plots of cost over each swept parameter, for experiments that name no scripts.
 *
 * The generated plots/sweep.gp contains its data, and runs after names.gp and style.gp. It draws time, object
 * tests and steps per ray, over all ray kinds. Over a parameter of scenes there is a line for each
 * accelerator. Over a parameter of accelerators there is a figure for each scene, with a line for each group
 * of specs that differ only in the parameter, and a line without markers for each accelerator without it. The
 * legend has the order of the lines at their right ends. */
#ifndef RT_REPORT_SWEEP_PLOT_H
#define RT_REPORT_SWEEP_PLOT_H

#include "experiment/results.h"

/* Whether the experiment sweeps parameters and names no plots. */
bool rt_sweep_plots_needed(const RtExperiment *experiment);

/* Writes sweep.gp and style.gp to `directory`/plots, which exists. */
RtStatus rt_sweep_plots_write(const RtResults *results, const char *directory, RtError *error);

#endif
