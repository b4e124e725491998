/* SPDX-License-Identifier: Apache-2.0 */
/* What accelerators look like: the same in every plot, table and experiment. */
#ifndef RT_REPORT_COLOR_H
#define RT_REPORT_COLOR_H

#include "experiment/experiment.h"

/* A colour is that of the registered accelerator on top of the spec; of several candidates with the same one
 * the first has it as it is, the others are darker and lighter. Markers and dashes go by the place in the
 * experiment, so that they differ between neighbours and in grey print: no two of 50 candidates have both. */
typedef struct RtLook {
    char color[8]; /* "#rrggbb" */
    int marker;    /* gnuplot's pointtype */
    int dash;      /* gnuplot's dashtype, 1..5 */
} RtLook;

/* `candidate` may be the null run, which is grey. */
RtLook rt_candidate_look(const RtExperiment *experiment, uint32_t candidate);

/* That of number `i` of any other lines. */
RtLook rt_look(uint32_t i);

#endif
