/* raytally scenes: what the table of built-in scenes says. */
#include "cli/cli.h"
#include "scenes/builtin.h"

#include <argp.h>
#include <stdio.h>

static const struct argp_option options[] = {{"json", 'j', 0, 0, "One JSON document on stdout", 0}, {0}};

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    bool *json = state->input;
    (void)argument;
    if (key != 'j') return ARGP_ERR_UNKNOWN;
    *json = true;
    return 0;
}

static void print_scene(const RtBuiltin *builtin) {
    printf("%s: %s\n  %s\n", builtin->name, builtin->summary, builtin->source);
    rt_cli_print_params(builtin->params, builtin->param_count);
    putchar('\n');
}

static json_t *scene_json(const RtBuiltin *builtin) {
    return json_pack("{s:s, s:s, s:s, s:o}", "name", builtin->name, "summary", builtin->summary, "source",
                     builtin->source, "params", rt_cli_params_json(builtin->params, builtin->param_count));
}

int rt_command_scenes(int argc, char **argv) {
    const struct argp argp = {
        .options = options, .parser = parse_option, .doc = "List the built-in scenes and their parameters."};
    bool json = false;
    argp_parse(&argp, argc, argv, 0, 0, &json);
    json_t *list = json_array();
    for (size_t i = 0; i < rt_builtin_count(); i++) {
        if (json) {
            json_array_append_new(list, scene_json(rt_builtin_at(i)));
        } else {
            print_scene(rt_builtin_at(i));
        }
    }
    if (json) {
        rt_cli_print_json(json_pack("{s:O}", "scenes", list));
    } else {
        puts("A built-in scene is written NAME[:KEY=VALUE[,KEY=VALUE]...], as in balls:size=5.\n"
             "Scenes that are hard on accelerators are generated from a seed, as in family:slivers,seed=7;\n"
             "`raytally info family:` names their families.");
    }
    json_decref(list);
    return RT_EXIT_OK;
}
