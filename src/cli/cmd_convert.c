/* SPDX-License-Identifier: Apache-2.0 */
/* raytally convert: a scene from one format to another. */
#include "cli/cli.h"
#include "core/scene/load.h"
#include "scenes/open.h"

#include <argp.h>

typedef struct Options {
    const char *in, *out;
    bool force;
} Options;

static const struct argp_option options[] = {
    {"force", 'f', 0, 0, "Write OUT even if there is a file of that name", 0}, {0}};

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    Options *o = state->input;
    switch (key) {
    case 'f': o->force = true; return 0;
    case ARGP_KEY_ARG:
        if (o->out) argp_error(state, "one scene IN and one file OUT; '%s' is one too many", argument);
        *(o->in ? &o->out : &o->in) = argument;
        return 0;
    case ARGP_KEY_END:
        if (!o->out) argp_error(state, "give a scene IN and a file OUT");
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

const struct argp rt_convert_argp = {
    .options = options,
    .parser = parse_option,
    .args_doc = "IN OUT",
    .doc = "Read the scene IN (a file or a built-in) and write it to OUT, in the format that the "
           "extension of OUT names.\vFor example:\n  raytally convert balls:size=2 balls.yaml\n"
           "  raytally convert bunny.obj bunny.ply"};

int rt_command_convert(int argc, char **argv) {
    Options o = {0};
    argp_parse(&rt_convert_argp, argc, argv, 0, 0, &o);
    RtError error;
    RtScene scene;
    if (rt_scene_open(o.in, &scene, &error) != RT_OK) return rt_cli_fail(&error);
    RtStatus status = rt_scene_save(&scene, o.out, o.force, &error);
    rt_scene_clear(&scene);
    return status == RT_OK ? RT_EXIT_OK : rt_cli_fail(&error);
}
