/* SPDX-License-Identifier: Apache-2.0 */
/* The events of a ray that a plugin traces for an observer.
 *
 * Object tests and built-in layers report theirs, as everywhere (core/base/observe.h). A plugin counts its
 * steps and extent tests, and may show each (raytally_show); what it counts and does not show becomes an
 * event without a name and a box, before the next object test. */
#ifndef RT_ACCEL_PLUGIN_EVENTS_H
#define RT_ACCEL_PLUGIN_EVENTS_H

#include "core/base/ray.h"

#include <raytally/accel.h>

typedef struct RtPluginEvents {
    const char *name;                  /* of the accelerator */
    const raytally_counters *counters; /* of the ray's kind, which the plugin counts in; NULL: none */
    raytally_counters shown;           /* so many of them became events */
    RtHit best;                        /* so far */
} RtPluginEvents;

/* Reports what was counted and not shown. */
void rt_plugin_report_counted(RtPluginEvents *events);

/* See raytally_show. */
void rt_plugin_show(RtPluginEvents *events, const raytally_prepared *ray, uint32_t counter, uint32_t number,
                    const raytally_box *theirs);

#endif
