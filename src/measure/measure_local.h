/* SPDX-License-Identifier: Apache-2.0 */
/* Runners of accelerators that live in this process. */
#ifndef RT_MEASURE_MEASURE_HERE_H
#define RT_MEASURE_MEASURE_HERE_H

#include "measure/measure.h"

/* What rt_runner_open and rt_runner_close do for them. */
RtStatus rt_runner_open_here(RtRunner *runner, const RtTimed *timed, int threads, RtError *error);
void rt_runner_close_here(RtRunner *runner);

#endif
