/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/plugin/events.h"

#include "accel/kernel.h"

/* Beyond that it counted below zero, and breaks. */
enum { MOST_COUNTED = 1 << 24 };

/* Whether the plugin counted something that was not shown yet; then it counts as shown. */
static bool take(RtPluginEvents *events, int counter) {
    const uint64_t counted = events->counters->at[counter];
    if (events->shown.at[counter] >= counted || counted > MOST_COUNTED) return false;
    events->shown.at[counter]++;
    return true;
}

static RtTraced next_step(RtPluginEvents *events) {
    const bool leaf = take(events, RAYTALLY_LEAF_STEPS), empty = take(events, RAYTALLY_EMPTY_STEPS);
    return (RtTraced){.kind = RT_TRACED_STEP, .leaf = leaf, .empty = empty};
}

/* All events except those of `but`. */
static void catch_up(RtPluginEvents *events, int but) {
    static const struct {
        int counter;
        RtTracedKind kind;
    } others[] = {{RAYTALLY_EXTENT_TESTS, RT_TRACED_EXTENT_TEST},
                  {RAYTALLY_REPEATS_AVOIDED, RT_TRACED_REPEAT_AVOIDED},
                  {RAYTALLY_PASSED_ON, RT_TRACED_PASSED_ON}};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        const char *what = others[i].kind == RT_TRACED_PASSED_ON ? events->name : NULL;
        while (others[i].counter != but && take(events, others[i].counter))
            rt_observe(&(RtTraced){.kind = others[i].kind, .what = what, .index = RT_NO_OBJECT});
    }
    while (but != RAYTALLY_STEPS && take(events, RAYTALLY_STEPS)) {
        const RtTraced step = next_step(events);
        rt_observe(&step);
    }
}

void rt_plugin_report_counted(RtPluginEvents *events) {
    if (rt_trace_observer && events->counters) catch_up(events, RAYTALLY_COUNTERS);
}

void rt_plugin_show(RtPluginEvents *events, const raytally_prepared *ray, uint32_t counter, uint32_t number,
                    const raytally_box *theirs) {
    RtBox box;
    RtTraced event = {.kind = RT_TRACED_EXTENT_TEST};
    float enter;
    if (!events->counters || !(counter == RAYTALLY_STEPS || (counter == RAYTALLY_EXTENT_TESTS && theirs)))
        return;
    catch_up(events, (int)counter);
    if (!take(events, (int)counter)) return;
    if (counter == RAYTALLY_STEPS) event = next_step(events);
    event.what = "node";
    event.index = number;
    if (theirs) {
        memcpy(&box, theirs, sizeof box);
        event.box = &box;
        event.met = counter == RAYTALLY_EXTENT_TESTS &&
                    raytally_box_hit(theirs, ray, rt_limit(ray, &events->best), &enter);
    }
    rt_observe(&event);
}
