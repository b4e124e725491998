/* SPDX-License-Identifier: Apache-2.0 */
/* Colours, markers and dashes of accelerators: the same in every plot, table and experiment. */
#ifndef RT_REPORT_COLOR_H
#define RT_REPORT_COLOR_H

#include "experiment/experiment.h"

/* "#rrggbb" of a candidate: that of the topmost accelerator of its spec; further candidates with the same one
 * get shades of it, evenly from dark to light. The null run is grey. */
#define RT_COLOR_CHARS 8
void rt_candidate_color(const RtExperiment *experiment, uint32_t candidate, char color[RT_COLOR_CHARS]);

/* gnuplot's pointtype, and its dashtype, 1..5, of line `i`, or of candidate `i` in the order of the
 * experiment: for grey print no two of 50 share both. */
int rt_plot_marker(uint32_t i);
int rt_plot_dash(uint32_t i);

#endif
