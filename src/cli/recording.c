/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/recording.h"

#include "cli/cli.h"
#include "core/base/memory.h"
#include "render/frame.h"

#include <stdio.h>
#include <string.h>

enum { OPT_RAYS = 256, OPT_LIMIT, OPT_COHERENT_RUN, OPT_SEED, OPT_SIZE, OPT_CORNERS, OPT_DEPTH };

static const struct argp_option options[] = {
    {0, 0, 0, 0, "The rays:", 1},
    {"rays", OPT_RAYS, "KIND,...", 0,
     "Kinds of rays: primary, shadow, reflection, transmission, diffuse, random, and occlusion, the diffuse "
     "rays as any-hit queries (default: all but occlusion; primary where only one kind is possible)",
     0},
    {"limit", OPT_LIMIT, "N", 0, "At most N rays of a kind; a larger set is thinned evenly (100000)", 0},
    {"coherent-run", OPT_COHERENT_RUN, "N", 0,
     "Thin a set in runs of N neighbouring rays, for packets and caches (256)", 0},
    {"seed", OPT_SEED, "S", 0, "Seed of diffuse and random rays and of the order of timing (1)", 0},
    {"size", OPT_SIZE, "WxH", 0, "Size of the frame whose rays are recorded (the camera's)", 0},
    {"corners", OPT_CORNERS, 0, 0, "Sample pixel corners, (W+1) x (H+1) rays", 0},
    {"depth", OPT_DEPTH, "N", 0, "Levels of the ray tree, the primary ray being the first (5)", 0},
    {0}};

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    RtRecordingOptions *o = state->input;
    RtExperiment *e = o->experiment;
    const int64_t most = (int64_t)RT_MAX_RAYS_A_KIND;
    switch (key) {
    case OPT_RAYS: o->kinds = argument; return 0;
    case OPT_SEED: e->seed = (uint64_t)rt_cli_integer(state, "--seed", argument, 0, INT64_MAX); return 0;
    case OPT_LIMIT:
        o->frame = "--limit";
        e->limit = (uint64_t)rt_cli_integer(state, o->frame, argument, 1, most);
        return 0;
    case OPT_COHERENT_RUN:
        o->frame = "--coherent-run";
        e->coherent_run = (uint64_t)rt_cli_integer(state, o->frame, argument, 1, most);
        return 0;
    case OPT_SIZE:
        o->frame = "--size";
        rt_cli_size(state, argument, &o->like.width, &o->like.height);
        return 0;
    case OPT_CORNERS:
        o->frame = "--corners";
        o->like.corners = true;
        return 0;
    case OPT_DEPTH:
        o->frame = "--depth";
        o->like.depth = (uint32_t)rt_cli_integer(state, o->frame, argument, 1, RT_MAX_DEPTH);
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

const struct argp rt_recording_argp = {.options = options, .parser = parse_option};

RtStatus rt_recording_init(RtRecordingOptions *o, RtError *error) {
    o->experiment = rt_alloc(1, sizeof(RtExperiment));
    if (!o->experiment) return rt_fail_memory(error, "an experiment", sizeof(RtExperiment));
    rt_experiment_init(o->experiment);
    o->experiment->coherent_run = 256;
    o->like.depth = RT_DEFAULT_DEPTH;
    return RT_OK;
}

void rt_recording_clear(RtRecordingOptions *o) {
    rt_free(o->experiment);
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

void rt_recording_finish(const RtRecordingOptions *o, struct argp_state *state) {
    RtExperiment *e = o->experiment;
    const bool given = *e->rays_from, one = given || o->one_kind;
    if (given && o->frame)
        argp_error(state, "%s applies to recorded rays; --rays-from measures all rays of its file", o->frame);
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
