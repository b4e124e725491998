/* SPDX-License-Identifier: Apache-2.0 */
/* Plots of a result directory, drawn by gnuplot from its CSV files.
 *
 * The experiment's scripts are copied into DIR/plots and run there in one process, in the order of the YAML,
 * after DIR/plots/names.gp, which defines `experiment`, and the lists of words `scenes`, `accels`, `colors`
 * (one for each accelerator, the same in every figure) and `kinds`: what the CSV files have rows of. Scripts
 * run in DIR and write plots/NAME.svg.tmp; what they wrote is renamed when all is done. So a person redraws
 * with raytally plot DIR after changing the copies. Which of them may be run: report/scripts.h. */
#ifndef RT_REPORT_PLOT_H
#define RT_REPORT_PLOT_H

#include "experiment/results.h"

/* Draws, by the experiment's scripts; where it names none and sweeps parameters, by one that is written
 * (sweep_plot.h); and where it asks for distributions, by experiments/histograms.gp, too. RT_NOT_AVAILABLE
 * where gnuplot is not installed; RT_MISMATCH, with what it says, where it fails: then the plots are what
 * they were before. */
RtStatus rt_plots_draw(const RtResults *results, const char *directory, RtError *error);

#endif
