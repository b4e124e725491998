/* SPDX-License-Identifier: Apache-2.0 */
/* raytally convert: a scene from one format to another. */
#include "cli/cli.h"
#include "core/scene/load.h"
#include "scenes/open.h"

typedef struct Options {
    const char *in, *out;
    bool force;
} Options;

static void take_file(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    if (o->out) argp_error(state, "one scene IN and one file OUT; '%s' is one too many", text);
    *(o->in ? &o->out : &o->in) = text;
}

static void finish(void *options, struct argp_state *state) {
    if (!((Options *)options)->out) argp_error(state, "give a scene IN and a file OUT");
}

static const RtOption options[] = {{"force", 'f', NULL, RT_TO_FLAG(force), "Replace OUT if it exists"},
                                   RT_STRICT_OPTION,
                                   RT_LIMIT_OPTIONS,
                                   {0}};

const RtSyntax rt_convert_syntax = {.options = options,
                                    .arguments = "IN OUT",
                                    .argument = {.name = "IN", .value = RT_TO_TAKE(take_file)},
                                    .finish = finish,
                                    .help = "Read the scene IN (a file or a built-in) and write it to OUT, "
                                            "in the format that the extension of OUT names.\v"
                                            "For example:\n"
                                            "  raytally convert balls:size=2 balls.yaml\n"
                                            "  raytally convert bunny.obj bunny.ply"};

RtStatus rt_command_convert(int argc, char **argv, RtError *error) {
    Options o = {0};
    RT_OWNED(RtScene, scene, rt_scene_clear);
    rt_cli_parse(&rt_convert_syntax, argc, argv, &o);
    RT_TRY(rt_cli_open_scene(o.in, &scene, error));
    return rt_scene_save(&scene, o.out, o.force, error);
}
