/* SPDX-License-Identifier: Apache-2.0 */
/* Forecast of the time that an experiment still needs: the number of times that each cell is timed, and the
 * times of the same accelerator on other rays; before it was timed at all, its tests and steps. */
#ifndef RT_RUN_FORECAST_H
#define RT_RUN_FORECAST_H

#include "run/workload.h"

typedef struct RtForecast {
    double known, left;       /* seconds: of finished measurements, and of missing ones */
    uint32_t cells, finished; /* to be measured, and of them finished */
    bool guessed;             /* nothing was timed yet: `left` is a lower bound */
} RtForecast;

/* Fills unknown `results` with counts and times of the run in `directory`, of another version of the
 * experiment or by another build: those of the same scenes, frames and accelerators, whatever their labels.
 * They are good for a forecast only. Nothing is filled in if this build cannot read the experiment of that
 * run. */
RtStatus rt_forecast_learn(const char *directory, RtResults *results, RtError *error);

/* Ignores kinds of rays that a recorded scene does not have. */
RtForecast rt_forecast(const RtResults *results, const RtWorkloadOptions *options);

/* Seconds left after `elapsed` seconds of a run that began with `before` seconds known. Scales the forecast
 * by the run's speed so far, since scenes, recording and other processes take time too. NAN if nothing was
 * finished since. */
double rt_forecast_left(const RtForecast *now, double before, double elapsed);

#endif
