/* SPDX-License-Identifier: Apache-2.0 */
/* Targets that read what other processes send: a plugin's, through shared memory, and a worker's. No process
 * is started. */
#include "accel/forged_testing.h"
#include "fuzz.h"

#include "compare/compare.h"
#include "core/base/observe.h"

#include <stdlib.h>
#include <string.h>

/* ---- a plugin ---- */

static RtScene scene;

void fuzz_prepare_plugin(void) {
    RtMaterial material = rt_default_material();
    uint32_t index;
    RtError error;
    rt_scene_init(&scene);
    CHECK(rt_scene_add_material(&scene, &material, &index, &error) == RT_OK);
    for (int i = 0; i < 4; i++)
        CHECK(rt_scene_add_sphere(&scene, index, rt_vec3(3 * (float)i, 0, 0), 1, &error) == RT_OK);
    CHECK(rt_scene_finish(&scene, &error) == RT_OK);
}

static void check_event(void *context, const RtTraced *event) {
    (void)context;
    CHECK(event->kind < RT_TRACED_KIND_COUNT);
    if (event->what) CHECK(strlen(event->what) < RT_MAX_NAME);
}

static void check_box(void *context, const RtBoxView *view) {
    (void)context;
    CHECK(rt_finite(view->box->lo) && rt_finite(view->box->hi) && view->depth <= MOST_DEPTH);
}

/* Answers must be possible, whatever was sent. */
static void check_rays(const RtAccel *accel, RtQuery *query) {
    enum { COUNT = 3 };
    RtRay rays[COUNT];
    RtHit hits[COUNT];
    bool blocked[COUNT];
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    const RtTraceObserver observer = {check_event, NULL};
    const uint32_t ids = rt_geometry_id_count(&accel->scene->geometry);
    for (int i = 0; i < COUNT; i++)
        rays[i] = (RtRay){.org = {{-9, 0, (float)i}}, .dir = {{1, 0, 0}}, .tmin = 1, .tmax = 100};
    rt_nearest(query, rays, COUNT, hits, NULL);
    for (int i = 0; i < COUNT; i++) CHECK(rt_hit_is_possible(ids, &rays[i], hits[i]));
    rt_occluded(query, rays, COUNT, blocked, tallies);
    rt_nearest(query, rays, COUNT, hits, tallies);
    for (int i = 0; i < COUNT; i++) CHECK(rt_hit_is_possible(ids, &rays[i], hits[i]));
    rt_trace_observer = &observer;
    rt_nearest(query, rays, 1, hits, tallies);
    rt_trace_observer = NULL;
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++)
            CHECK(rt_tally_get(&tallies[kind], i) <= UINT64_C(1) << 40);
    }
}

void fuzz_plugin(const Input *input) {
    RtAccel *accel;
    RtQuery query;
    RtDescription description;
    RtError error = {RT_OK, ""};
    if (fuzz_accepted(open_forged(&scene, input->bytes, input->size, &accel, &error), &error)) {
        rt_accel_describe(accel, &description);
        CHECK(!rt_description_impossible(&description) && accel->build_seconds >= 0);
        if (fuzz_accepted(rt_query_init(&query, accel, &error), &error)) {
            check_rays(accel, &query);
            rt_query_clear(&query);
        }
        accel->ops->each_box(accel, (RtBoxViewer){check_box, NULL});
        fuzz_accepted(rt_accel_validate(accel, &error), &error);
        fuzz_accepted(rt_accel_check(accel, &error), &error);
        close_forged(accel);
    }
}

/* ---- a worker ---- */

static const Input *said;

RtStatus __wrap_rt_process_spawn(RtProcess *process, const RtProcessCommand *command, RtError *error);

/* A worker that says all of the input, whatever it is asked. */
RtStatus __wrap_rt_process_spawn(RtProcess *process, const RtProcessCommand *command, RtError *error) {
    (void)error;
    *process = (RtProcess){0};
    *command->to = fopen("/dev/null", "w");
    *command->from =
        said->size > 0 ? fmemopen((void *)said->bytes, said->size, "r") : fopen("/dev/null", "r");
    CHECK(*command->to && *command->from);
    return RT_OK;
}

void fuzz_worker(const Input *input) {
    const RtPrograms programs = {
        .before = "before", .after = "after", .arguments = (char *[]){NULL}, .rounds = 1, .seed = 1};
    RtComparison comparison = {0};
    RtError error = {RT_OK, ""};
    said = input;
    if (fuzz_accepted(rt_compare_programs(&programs, &comparison, &error), &error))
        rt_comparison_print(&comparison, fuzz_nowhere());
    rt_comparison_clear(&comparison);
}
