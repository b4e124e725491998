/* SPDX-License-Identifier: Apache-2.0 */
/* What happens to a ray in a plugin's process, for `raytally trace`: its events, sent to the observer of
 * raytally's own process.
 *
 * Object tests and built-in layers report theirs, as everywhere (core/base/observe.h). A plugin counts its
 * steps and extent tests, and may show each (raytally_show); what it counts and does not show becomes an
 * event without a name and a box, before the next object test. */
#include "accel/kernel.h"
#include "accel/plugin/host.h"
#include "accel/plugin/wire.h"

#include <string.h>

/* ---- events of a plugin ---- */

/* Beyond that it counted below zero, and breaks. */
enum { MOST_EVENTS = 1 << 24 };

/* Whether the plugin counted something that was not shown yet; then it counts as shown. */
static bool take(RtPluginEvents *events, int counter) {
    const uint64_t counted = events->counters->at[counter];
    if (events->shown.at[counter] >= counted || counted > MOST_EVENTS) return false;
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

void rt_plugin_catch_up(RtPluginEvents *events) {
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

/* ---- sending them ---- */

/* The observer in the plugin's process. */
static void send_event(void *context, const RtTraced *event) {
    WireEvents *to = context;
    const uint64_t number = to->seen++;
    if (number < to->first || number - to->first >= WIRE_EVENTS) return;
    WireEvent *out = &to->events[to->count++];
    *out = (WireEvent){.kind = (uint32_t)event->kind,
                       .index = event->index,
                       .t = event->t,
                       .leaf = event->leaf,
                       .empty = event->empty,
                       .met = event->met,
                       .boxed = event->box != NULL,
                       .round = event->ball != NULL};
    if (event->box) out->box = *event->box;
    if (event->ball) out->ball = *event->ball;
    if (event->what) strncpy(out->what, event->what, sizeof out->what - 1);
}

void rt_wire_events(RtQuery *query, const RtRay *rays, void *message) {
    WireEvents *to = message;
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    RtHit hit;
    bool blocked;
    to->count = 0;
    to->seen = 0;
    rt_trace_observer = &(RtTraceObserver){send_event, to};
    if (to->any)
        rt_occluded(query, rays, 1, &blocked, tallies);
    else
        rt_nearest(query, rays, 1, &hit, tallies);
    rt_trace_observer = NULL;
}

void rt_wire_observe(const WireEvent *sent) {
    WireEvent e = *sent;
    if (e.kind >= RT_TRACED_KIND_COUNT) return;
    for (size_t i = 0; i < sizeof e.what; i++) {
        if (e.what[i] && (e.what[i] < ' ' || e.what[i] > '~')) e.what[i] = '?';
    }
    e.what[sizeof e.what - 1] = '\0';
    const bool boxed = e.boxed && rt_finite(e.box.lo) && rt_finite(e.box.hi);
    rt_observe(&(RtTraced){.kind = (RtTracedKind)e.kind,
                           .what = *e.what ? e.what : NULL,
                           .index = e.index,
                           .box = boxed ? &e.box : NULL,
                           .ball = boxed && e.round ? &e.ball : NULL,
                           .leaf = e.leaf != 0,
                           .empty = e.empty != 0,
                           .met = e.met != 0,
                           .t = e.t});
}
