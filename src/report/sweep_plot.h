/* SPDX-License-Identifier: Apache-2.0 */
/* Line plots of cost over each parameter that an experiment sweeps: what is drawn where it names no scripts.
 *
 * plots/sweep.gp is written for gnuplot, with the figures in it, to run after names.gp and style.gp. It draws
 * time, object tests and steps per ray, of all ray kinds together: over a parameter of scenes, a line for
 * each accelerator; over one of accelerators, a line for each that has the rest of its spec and of its label
 * in common, and for one that is not swept a line without markers; a figure for each scene. The legend has
 * the order of the lines at their right ends. */
#ifndef RT_REPORT_SWEEP_PLOT_H
#define RT_REPORT_SWEEP_PLOT_H

#include "experiment/results.h"

/* Whether there is anything to draw without scripts: something is swept, and the experiment names no plots.
 */
bool rt_sweep_plots_needed(const RtExperiment *experiment);

/* Writes sweep.gp, and the style.gp that it needs, to `directory`/plots, which exists. */
RtStatus rt_sweep_plots_write(const RtResults *results, const char *directory, RtError *error);

#endif
