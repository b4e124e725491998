/* SPDX-License-Identifier: Apache-2.0 */
/* Runners of accelerators that live in a process of their own (accel/remote.h): the rays are taken there
 * once, and passes over them run there, timed by the clocks there. Nothing that crosses over is timed. */
#ifndef RT_MEASURE_MEASURE_AWAY_H
#define RT_MEASURE_MEASURE_AWAY_H

#include "measure/measure.h"

/* What rt_runner_open and rt_runner_close do for them. */
RtStatus rt_runner_open_away(RtRunner *runner, const RtTimed *timed, int threads, RtError *error);
void rt_runner_close_away(RtRunner *runner);

#endif
