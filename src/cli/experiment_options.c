/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/experiment_options.h"

#include "cli/cli.h"
#include "run/callgrind.h"
#include "verify/verify.h"

#include <stdio.h>
#include <string.h>

#define Options RtExperimentOptions
const RtOption rt_experiment_options[] = {
    {NULL, 0, NULL, {0}, "The rays:"},
    {"rays", 0, "KIND,...", RT_TO_TEXT(kinds),
     "Kinds of rays: primary, shadow, reflection, transmission, diffuse, random, and occlusion, the diffuse "
     "rays as any-hit queries (default: all but occlusion; primary where only one kind is possible)"},
    {"limit", 0, "N", RT_MARKING(frame, RT_SETS_INTEGER(experiment.limit, 1, RT_MAX_RAYS_A_KIND)),
     "At most N rays of a kind; a larger set is thinned evenly (100000)"},
    {"coherent-run", 0, "N",
     RT_MARKING(frame, RT_SETS_INTEGER(experiment.coherent_run, 1, RT_MAX_RAYS_A_KIND)),
     "Thin a set in runs of N neighbouring rays, for packets and caches (256)"},
    {"seed", 0, "S", RT_TO_INTEGER(experiment.seed, 0, INT64_MAX),
     "Seed of diffuse and random rays and of the order of timing (1)"},
    {"size", 0, "WxH", RT_MARKING(frame, .form = RT_OPTION_SIZE, RT_AT(like.width)),
     "Size of the frame whose rays are recorded (the camera's)"},
    {"corners", 0, NULL, RT_MARKING(frame, RT_SETS_FLAG(like.corners)),
     "Sample pixel corners, (W+1) x (H+1) rays"},
    {"depth", 0, "N", RT_MARKING(frame, RT_SETS_INTEGER(like.depth, 1, RT_MAX_DEPTH)),
     "Levels of the ray tree, the primary ray being the first (5)"},
    {0}};
#undef Options

void rt_experiment_options_init(RtExperimentOptions *o) {
    rt_experiment_init(&o->experiment);
    o->like.depth = RT_DEFAULT_DEPTH;
}

static void parse_kinds(RtExperiment *experiment, const char *text, struct argp_state *state) {
    experiment->kind_count = 0;
    for (size_t length; *text; text += length + (text[length] == ',')) {
        char name[RT_MAX_NAME];
        RtError error;
        length = strcspn(text, ",");
        snprintf(name, sizeof name, "%.*s", (int)length, text);
        if (experiment->kind_count == RT_RAY_KIND_COUNT) argp_error(state, "--rays: a kind is given twice");
        RtRayKind *kind = &experiment->kinds[experiment->kind_count++];
        RtStatus status = *experiment->rays_from ? rt_given_kind_parse(name, kind, &error)
                                                 : rt_ray_kind_parse(name, kind, &error);
        if (status != RT_OK) argp_error(state, "--rays: %s", error.message);
    }
    if (!experiment->kind_count) argp_error(state, "--rays: give at least one kind");
}

void rt_experiment_options_finish(RtExperimentOptions *o, struct argp_state *state) {
    RtExperiment *e = &o->experiment;
    const bool given = *e->rays_from, one = given || o->one_kind;
    if (given && o->frame)
        argp_error(state, "--%s applies to recorded rays; --rays-from measures all rays of its file",
                   o->frame);
    if (given && !o->kinds)
        argp_error(
            state,
            "choose the query for the rays of --rays-from: --rays nearest, or --rays occlusion (any hit)");
    if (o->kinds) {
        parse_kinds(e, o->kinds, state);
    } else if (one) {
        e->kinds[0] = RT_RAY_PRIMARY;
        e->kind_count = 1;
    }
    if (one && e->kind_count > 1) argp_error(state, "--rays: one kind at a time");
}

void rt_take_callgrind(void *options, const char *text, struct argp_state *state) {
    RtExperimentOptions *o = options;
    o->callgrind = RT_CALLGRIND_RAYS;
    if (text) o->callgrind = (uint64_t)rt_cli_integer(state, "--callgrind", text, 1, 100000000);
}

void rt_add_accel(RtExperiment *experiment, const char *text, struct argp_state *state) {
    RtError error;
    RtCandidate like = {.entry = experiment->candidate_count, .ray_stride = 1};
    if (strlen(text) >= RT_MAX_SPEC_CHARS)
        argp_error(state, "--accel: a spec has at most %d characters", RT_MAX_SPEC_CHARS - 1);
    strcpy(like.spec, text);
    if (rt_experiment_add_accels(experiment, &like, &error) != RT_OK)
        argp_error(state, "--accel: %s", error.message);
}

void rt_take_accel(void *options, const char *text, struct argp_state *state) {
    RtExperiment *experiment = &((RtExperimentOptions *)options)->experiment;
    if (strcmp(text, "all") != 0) {
        rt_add_accel(experiment, text, state);
        return;
    }
    for (size_t i = 0; i < rt_accel_count(); i++) {
        char spec[RT_MAX_SPEC_CHARS];
        rt_spread_spec(rt_accel_at(i), 0, spec);
        rt_add_accel(experiment, spec, state);
    }
}
