/* SPDX-License-Identifier: Apache-2.0 */
/* Colours of accelerators, the same in plots and tables. */
#ifndef RT_REPORT_COLOR_H
#define RT_REPORT_COLOR_H

#include <stdint.h>

/* The colour of a candidate, "#rrggbb". */
const char *rt_candidate_color(uint32_t candidate);

#endif
