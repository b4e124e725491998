/* SPDX-License-Identifier: Apache-2.0 */
/* Colours of accelerators, and plots of a result directory, drawn by gnuplot from its CSV files.
 *
 * style.gp and the experiment's scripts run in one process, in the order of the YAML, where the result
 * directory is the current one. They get variables (gnuplot -e), which experiments/style.gp lists, and write
 * plots/NAME.svg.tmp; these files are renamed when all are done. experiment/scripts.h says where scripts are,
 * and which may run. */
#ifndef RT_REPORT_PLOT_H
#define RT_REPORT_PLOT_H

#include "experiment/scripts.h"
#include "results/results.h"

/* "#rrggbb" of a candidate: that of the topmost accelerator of its spec; further candidates with the same one
 * get shades of it, evenly from dark to light. The null run is grey. */
#define RT_COLOR_CHARS 8
void rt_candidate_color(const RtExperiment *experiment, uint32_t candidate, char color[RT_COLOR_CHARS]);

/* Draws with the experiment's scripts; if it names none, with sweeps.gp if it sweeps parameters, else with
 * relative-time.gp and relative-counts.gp; and with histograms.gp if it has distributions. RT_NOT_AVAILABLE
 * if gnuplot or the shipped scripts are not installed; RT_MISMATCH, with its message, if gnuplot fails: the
 * old plots then stay. `column`: laid out for one column of a paper, not for the page. */
RtStatus rt_plots_draw(const RtResults *results, const char *directory, RtScripts allowed, bool column,
                       RtError *error);

/* What a script of the directory or the shipped one says of plot `name` (style.gp has the format); "" if
 * nothing. */
#define RT_MAX_CAPTION 1024
void rt_plot_caption(const RtExperiment *experiment, const char *directory, const char *name,
                     char text[RT_MAX_CAPTION]);

#endif
