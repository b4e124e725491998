/* SPDX-License-Identifier: Apache-2.0 */
/* Which accelerators are best on a scene. */
#ifndef RT_EXPERIMENT_STANDING_H
#define RT_EXPERIMENT_STANDING_H

#include "core/text/table.h"
#include "experiment/results.h"

/* How a candidate stands among those that were measured on the workload: for all kinds of rays together where
 * kind is RT_RAY_KIND_COUNT. By time where any was timed, else by object tests per ray. The best has the
 * least median; level with it is whose interval overlaps its own. Null runs and the yardstick
 * (rt_accel_yardstick) do not take part. */
RtStanding rt_standing(const RtResults *results, uint32_t workload, uint32_t candidate, RtRayKind kind);

#endif
