/* SPDX-License-Identifier: Apache-2.0 */
/* What experiments/sweeps.gp draws of a swept parameter: the cost of accelerators over its values, in a block
 * for each group of scenes that differ only in the parameter, and there a line for each accelerator. */
#ifndef RT_REPORT_SWEEP_DATA_H
#define RT_REPORT_SWEEP_DATA_H

#include "results/results.h"

/* Writes DIR/plots/sweep-KEY.tsv for each swept parameter that varies in the results, over all kinds of rays,
 * and appends "KEY KEY ..." to `keys`, and "log", "linear" or "words" for each to `axes`. Columns of a file,
 * which has no header: group of scenes, line, colour as a number, marker (0: the line lacks the parameter and
 * spans the axis), place of the value on the axis, the value, ns per ray with its interval, object tests and
 * steps per ray. A blank line is between lines, two are between groups. */
RtStatus rt_sweep_data_write(const RtResults *results, const char *directory, FILE *keys, FILE *axes,
                             RtError *error);

#endif
