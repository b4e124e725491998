/* SPDX-License-Identifier: Apache-2.0 */
/* raytally scenes: the table of built-in scenes. */
#include "cli/cli.h"
#include "scenes/builtin.h"

#include <stdio.h>

static void print_scene(const RtBuiltin *builtin) {
    printf("%s: %s\n  %s\n", builtin->name, builtin->summary, builtin->source);
    rt_cli_print_params(builtin->params, builtin->param_count);
    putchar('\n');
}

static json_t *scene_json(const RtBuiltin *builtin) {
    return json_pack("{s:s, s:s, s:s, s:o}", "name", builtin->name, "summary", builtin->summary, "source",
                     builtin->source, "params", rt_cli_params_json(builtin->params, builtin->param_count));
}

const RtSyntax rt_scenes_syntax = {.options = rt_list_options,
                                   .arguments = "[NAME]",
                                   .argument = RT_LIST_ARGUMENT,
                                   .help = "List the built-in scenes, or explain the one called NAME: its "
                                           "parameters with defaults and ranges, and where it comes from."};

RtStatus rt_command_scenes(int argc, char **argv, RtError *error) {
    RtListOptions o = {0};
    rt_cli_parse(&rt_scenes_syntax, argc, argv, &o);
    const RtBuiltin *only = NULL;
    if (o.name) RT_TRY(rt_builtin_named(o.name, &only, error));
    json_t *list = json_array();
    for (size_t i = 0; i < rt_builtin_count(); i++) {
        if (only && rt_builtin_at(i) != only) continue;
        if (o.json) {
            json_array_append_new(list, scene_json(rt_builtin_at(i)));
        } else {
            print_scene(rt_builtin_at(i));
        }
    }
    rt_list_finish(&o, "scenes", list,
                   "A built-in scene is written NAME[:KEY=VALUE[,KEY=VALUE]...], as in balls:size=5.");
    return RT_OK;
}
