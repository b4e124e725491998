/* SPDX-License-Identifier: Apache-2.0 */
/* How long what is left of an experiment will take, by what is known of it: how often and how long each cell
 * is timed, by the times of the same accelerator on other rays. */
#ifndef RT_EXPERIMENT_FORECAST_H
#define RT_EXPERIMENT_FORECAST_H

#include "experiment/workload.h"

typedef struct RtForecast {
    double known, left;       /* seconds: of what is in the results, and of what is not yet */
    uint32_t cells, finished; /* how many are to be measured, and of them are */
    bool guessed;             /* nothing was timed yet: left is the least that it can be */
} RtForecast;

/* Kinds of which a scene that was recorded has no rays have no cells. */
RtForecast rt_forecast(const RtResults *results, const RtWorkloadOptions *options);

/* Seconds that are left after `elapsed`, when the forecast was made that has `before` known at the beginning:
 * it is off by a factor, that of what scenes, recording and other processes take. NAN where nothing was
 * finished since. */
double rt_forecast_left(const RtForecast *now, double before, double elapsed);

#endif
