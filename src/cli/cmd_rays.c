/* SPDX-License-Identifier: Apache-2.0 */
/* raytally rays: the rays that `bench` records, as an array of NumPy. */
#include "cli/cli.h"
#include "cli/recording.h"
#include "core/base/words.h"
#include "experiment/workload.h"
#include "measure/ray_file.h"

#include <argp.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

typedef struct Options {
    RtRecordingOptions recording;
    const char *scene, *out;
    int threads;
} Options;

static const struct argp_option options[] = {
    {"out", 'o', "FILE.npy", 0, "Where the rays go", 0},
    {"threads", 't', "N", 0, "Threads, 0 for all processors (0); the rays do not depend on them", 0},
    {0}};

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    Options *o = state->input;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = &o->recording; return 0;
    case 'o': o->out = argument; return 0;
    case 't': o->threads = (int)rt_cli_integer(state, "--threads", argument, 0, 1024); return 0;
    case ARGP_KEY_ARG:
        if (o->scene) argp_error(state, "one SCENE at a time; '%s' is a second one", argument);
        o->scene = argument;
        return 0;
    case ARGP_KEY_END:
        if (!o->scene)
            argp_error(state, "a SCENE is missing: a file, or a built-in as `raytally scenes` lists");
        if (!o->out) argp_error(state, "say where the rays go: -o FILE.npy");
        rt_recording_finish(&o->recording, state);
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

static RtStatus save(const Options *o, const RtRaySet *set, RtError *error) {
    const char *kind = rt_ray_kind_name(set->kind);
    if (set->count == 0)
        return rt_fail(error, RT_BAD_INPUT, "%s has no %s rays: choose another --rays", o->scene, kind);
    RT_TRY(rt_rays_save(set, o->out, error));
    printf("%s: %" PRIu64 " %s ray%s\n", o->out, set->count, kind, rt_plural(set->count));
    return RT_OK;
}

static RtStatus record(const Options *o, RtError *error) {
    RtExperiment *e = o->recording.experiment;
    RtScene scene;
    RtAccel *reference = NULL;
    RtRaySet sets[RT_RAY_KIND_COUNT] = {0};
    RT_TRY(rt_experiment_add_scenes(e, &o->recording.like, o->scene, "", error));
    if (e->workload_count > 1)
        return rt_fail(error, RT_BAD_INPUT, "one SCENE at a time: '%s' is %u", o->scene, e->workload_count);
    RT_TRY(rt_workload_open_scene(&e->workloads[0], &scene, error));
    RtStatus status = rt_workload_record(e, 0, o->threads, &scene, &reference, sets, error);
    if (status == RT_OK) status = save(o, &sets[e->kinds[0]], error);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&sets[k]);
    rt_accel_destroy(reference);
    rt_scene_clear(&scene);
    return status;
}

static const struct argp_child children[] = {{&rt_recording_argp, 0, NULL, 0}, {0}};
const struct argp rt_rays_argp = {
    .options = options,
    .parser = parse_option,
    .args_doc = "SCENE",
    .doc = "Write rays of a scene, those that `raytally bench` measures with, to a file that NumPy reads."
           "\vEach row of the array, float32 of shape (N, 8), is a ray: origin x y z, tmin, direction x y z "
           "(of any length: t counts in it), tmax. `raytally bench --rays-from` and `raytally verify "
           "--rays-from` take such a file from any renderer. Example:\n"
           "  raytally rays balls --rays diffuse -o rays.npy\n"
           "  raytally bench balls --accel bvh --rays-from rays.npy --rays nearest --hits hits.npy\n"
           "  python3 -c \"import numpy; print(numpy.load('hits.npy')['object'])\"",
    .children = children};

int rt_command_rays(int argc, char **argv) {
    RtError error;
    Options o = {.recording = {.one_kind = true}};
    if (rt_recording_init(&o.recording, &error) != RT_OK) return rt_cli_fail(&error);
    argp_parse(&rt_rays_argp, argc, argv, 0, 0, &o);
    RtStatus status = record(&o, &error);
    rt_recording_clear(&o.recording);
    return status == RT_OK ? RT_EXIT_OK : rt_cli_fail(&error);
}
