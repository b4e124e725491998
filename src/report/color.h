/* SPDX-License-Identifier: Apache-2.0 */
/* Colours, markers and dashes of accelerators: the same in every plot, table and experiment. */
#ifndef RT_REPORT_COLOR_H
#define RT_REPORT_COLOR_H

#include "experiment/experiment.h"

/* The colour belongs to the topmost accelerator of the spec; further candidates with the same one get darker
 * and lighter shades. Marker and dash follow the order in the experiment, for grey print: no two of 50
 * candidates share both. */
typedef struct RtLook {
    char color[8]; /* "#rrggbb" */
    int marker;    /* gnuplot's pointtype */
    int dash;      /* gnuplot's dashtype, 1..5 */
} RtLook;

/* `candidate` may be the null run, which is grey. */
RtLook rt_candidate_look(const RtExperiment *experiment, uint32_t candidate);

/* The look of line `i` of a plot of other lines. */
RtLook rt_look(uint32_t i);

#endif
