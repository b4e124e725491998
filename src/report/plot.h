/* SPDX-License-Identifier: Apache-2.0 */
/* Plots of a result directory, drawn by gnuplot from its CSV files.
 *
 * The experiment's scripts are copied into DIR/plots and run there in one process, in the order of the YAML,
 * after DIR/plots/names.gp, which defines `experiment`, and the lists of words `scenes`, `accels`, `colors`
 * (one for each accelerator, the same in every figure) and `kinds` in the CSV files, and `paper`, "column" or
 * "page", the width that figures with several panels are laid out for; and weight(0), the weight of the ray
 * set of the row at hand in sums over ray kinds (rt_results_weight). Scripts run in DIR and write
 * plots/NAME.svg.tmp; these files are renamed when all are done. `raytally plot DIR` runs edited copies
 * again. experiment/scripts.h decides which scripts may run. */
#ifndef RT_REPORT_PLOT_H
#define RT_REPORT_PLOT_H

#include "results/results.h"

/* Draws with the experiment's scripts; with a generated one if it names none and sweeps parameters
 * (sweep_plot.h); and with experiments/histograms.gp if it has distributions. RT_NOT_AVAILABLE if gnuplot is
 * not installed; RT_MISMATCH, with its message, if it fails: the old plots then stay. `column`: laid out for
 * one column of a paper, not for the page. */
RtStatus rt_plots_draw(const RtResults *results, const char *directory, bool column, RtError *error);

#endif
