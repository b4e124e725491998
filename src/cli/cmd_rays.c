/* SPDX-License-Identifier: Apache-2.0 */
/* raytally rays: writes the rays that `bench` records as a NumPy array. */
#include "cli/cli.h"
#include "cli/experiment_options.h"
#include "core/base/words.h"
#include "measure/measure.h"

#include <inttypes.h>
#include <stdio.h>

typedef struct Options {
    RtExperimentOptions shared;
    const char *scene, *out;
    int threads;
} Options;

static void finish(void *options, struct argp_state *state) {
    Options *o = options;
    if (!o->out) argp_error(state, "the output file is missing: -o FILE.npy");
    rt_experiment_options_finish(&o->shared, state);
}

static const RtOption options[] = {
    {"out", 'o', "FILE.npy", RT_TO_TEXT(out), "The file to write; as text if it ends in .csv"},
    {"threads", 't', "N", RT_TO_INTEGER(threads, 0, 1024),
     "Threads, 0 for all processors (0); the rays do not depend on them"},
    RT_STRICT_OPTION,
    RT_LIMIT_OPTIONS,
    {0}};

static RtStatus save(const Options *o, const RtRaySet *set, RtError *error) {
    const char *kind = rt_ray_kind_name(set->kind);
    if (set->count == 0)
        return rt_fail(error, RT_BAD_INPUT, "%s has no %s rays: choose another --rays", o->scene, kind);
    RT_TRY(rt_rays_save(set, o->out, error));
    printf("%s: %" PRIu64 " %s ray%s\n", o->out, set->count, kind, rt_plural(set->count));
    return RT_OK;
}

static RtStatus record(Options *o, RtError *error) {
    RtExperiment *e = &o->shared.experiment;
    RT_OWNED(RtScene, scene, rt_scene_clear);
    RT_OWNED(RtAccel *, reference, rt_accel_destroy_at);
    RtRaySet sets[RT_RAY_KIND_COUNT] = {0};
    uint64_t whole_rays[RT_RAY_KIND_COUNT];
    RT_TRY(rt_experiment_add_scenes(e, &o->shared.like, o->scene, "", error));
    if (e->workload_count > 1)
        return rt_fail(error, RT_BAD_INPUT, "one SCENE at a time: '%s' stands for %u", o->scene,
                       e->workload_count);
    RT_TRY(rt_workload_open_scene(&e->workloads[0], &scene, error));
    rt_cli_tell_warnings(&scene);
    RtStatus status = rt_workload_record(e, 0, o->threads, &scene, &reference, sets, NULL, whole_rays, error);
    if (status == RT_OK) status = save(o, &sets[e->kinds[0]], error);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&sets[k]);
    return status;
}

const RtSyntax rt_rays_syntax = {
    .options = options,
    .shared = rt_experiment_options,
    .shared_at = offsetof(Options, shared),
    RT_ONE_SCENE,
    .finish = finish,
    .help = "Write the rays that `raytally bench` measures to a file for NumPy, or to a CSV file.\v"
            "Each row of the array, float32 of shape (N, 8), is a ray: origin x y z, tmin, direction x y z "
            "(of any length, the unit of t), tmax. `raytally bench --rays-from` and `raytally verify "
            "--rays-from` read such files, from any renderer, and CSV files with the columns "
            "ox,oy,oz,tmin,dx,dy,dz,tmax. Example:\n"
            "  raytally rays balls --rays diffuse -o rays.npy\n"
            "  raytally bench balls --accel bvh --rays-from rays.npy --rays nearest \\\n"
            "    --hits hits.npy\n"
            "  python3 -c \"import numpy; print(numpy.load('hits.npy')['object'])\""};

RtStatus rt_command_rays(int argc, char **argv, RtError *error) {
    static Options o;
    o.shared.one_kind = true;
    rt_experiment_options_init(&o.shared);
    rt_cli_parse(&rt_rays_syntax, argc, argv, &o);
    return record(&o, error);
}
