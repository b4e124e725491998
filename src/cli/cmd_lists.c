/* SPDX-License-Identifier: Apache-2.0 */
/* raytally accels and raytally scenes: the tables of accelerators and of built-in scenes. */
#include "accel/accel.h"
#include "cli/cli.h"
#include "scenes/builtin.h"

#include <stdio.h>

typedef struct Options {
    const char *name; /* NULL: all */
    bool json;
} Options;

static const RtOption options[] = {{"json", 'j', NULL, RT_TO_FLAG(json), "One JSON document on stdout"}, {0}};

static void print_params(const RtParam *table, size_t count) {
    for (size_t i = 0; i < count; i++) {
        char range[RT_MAX_SPEC_CHARS];
        rt_param_range(&table[i], range, sizeof range);
        printf("  %-12s %s\n  %-12s   default %s (%s); %s\n", table[i].name, table[i].meaning, "",
               table[i].default_text, table[i].source, range);
    }
}

static json_t *params_json(const RtParam *table, size_t count) {
    json_t *params = json_array();
    for (size_t i = 0; i < count; i++) {
        char range[RT_MAX_SPEC_CHARS];
        rt_param_range(&table[i], range, sizeof range);
        json_array_append_new(params, json_pack("{s:s, s:s, s:s, s:s, s:s}", "name", table[i].name, "default",
                                                table[i].default_text, "range", range, "meaning",
                                                table[i].meaning, "source", table[i].source));
    }
    return params;
}

/* Prints `list`, an array, under `key` with --json; else `syntax`, without a name. Takes the reference. */
static RtStatus finish(const Options *o, const char *key, json_t *list, const char *syntax) {
    if (o->json)
        rt_cli_print_json(json_pack("{s:O}", key, list));
    else if (!o->name)
        puts(syntax);
    json_decref(list);
    return RT_OK;
}

/* ---- accelerators ---- */

static void print_accelerator(const RtAccelOps *ops) {
    printf("%s: %s\n  %s\n", ops->name, ops->summary, ops->paper);
    if (ops->kinds) {
        fputs("  an overlay, OVERLAY+ACCELERATOR", stdout);
        if (ops->kinds != RT_ALL_RAY_KINDS) fputs(": answers only rays of kind", stdout);
        for (int kind = 0; kind < RT_RAY_KIND_COUNT && ops->kinds != RT_ALL_RAY_KINDS; kind++) {
            if (ops->kinds >> kind & 1) printf(" %s", rt_ray_kind_name((RtRayKind)kind));
        }
        putchar('\n');
    }
    print_params(ops->params, ops->param_count);
    for (size_t i = 0; i < ops->best_count; i++) {
        const RtBestOf *best = &ops->bests[i];
        printf("  %s:%s: %s (%s)\n", ops->name, best->name, best->meaning, best->settings);
    }
    putchar('\n');
}

static json_t *accelerator_json(const RtAccelOps *ops) {
    json_t *kinds = json_array();
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        if (ops->kinds && !(ops->kinds >> kind & 1)) continue;
        json_array_append_new(kinds, json_string(rt_ray_kind_name((RtRayKind)kind)));
    }
    json_t *bests = json_array();
    for (size_t i = 0; i < ops->best_count; i++) {
        const RtBestOf *best = &ops->bests[i];
        json_array_append_new(bests, json_pack("{s:s, s:s, s:s}", "name", best->name, "settings",
                                               best->settings, "meaning", best->meaning));
    }
    return json_pack("{s:s, s:s, s:s, s:b, s:o, s:o, s:o}", "name", ops->name, "summary", ops->summary,
                     "paper", ops->paper, "overlay", ops->kinds != 0, "kinds", kinds, "params",
                     params_json(ops->params, ops->param_count), "best_of", bests);
}

const RtSyntax rt_accels_syntax = {.options = options,
                                   .plugins = true,
                                   .arguments = "[NAME]",
                                   .argument = RT_ARGUMENT("NAME", name, NULL),
                                   .help = "List the accelerators, or explain the one called NAME: its "
                                           "parameters with defaults and ranges, and the paper it follows."};

RtStatus rt_command_accels(int argc, char **argv, RtError *error) {
    Options o = {0};
    rt_cli_parse(&rt_accels_syntax, argc, argv, &o);
    const RtAccelOps *only = NULL;
    if (o.name) RT_TRY(rt_accel_find(o.name, &only, error));
    json_t *list = json_array();
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        if (only && ops != only) continue;
        if (o.json)
            json_array_append_new(list, accelerator_json(ops));
        else
            print_accelerator(ops);
    }
    return finish(
        &o, "accelerators", list,
        "An accelerator is written NAME[:KEY=VALUE[,KEY=VALUE]...], as in grid:density=4; overlays\n"
        "come before it, as in OVERLAY+grid:density=4.");
}

/* ---- scenes ---- */

const RtSyntax rt_scenes_syntax = {.options = options,
                                   .arguments = "[NAME]",
                                   .argument = RT_ARGUMENT("NAME", name, NULL),
                                   .help = "List the built-in scenes, or explain the one called NAME: its "
                                           "parameters with defaults and ranges, and where it comes from."};

RtStatus rt_command_scenes(int argc, char **argv, RtError *error) {
    Options o = {0};
    rt_cli_parse(&rt_scenes_syntax, argc, argv, &o);
    const RtBuiltin *only = NULL;
    if (o.name) RT_TRY(rt_builtin_named(o.name, &only, error));
    json_t *list = json_array();
    const RtBuiltin *b;
    for (size_t i = 0; (b = rt_builtin_at(i)); i++) {
        if (only && b != only) continue;
        if (o.json) {
            json_t *params = params_json(b->params, b->param_count);
            json_array_append_new(list, json_pack("{s:s, s:s, s:s, s:o}", "name", b->name, "summary",
                                                  b->summary, "source", b->source, "params", params));
            continue;
        }
        printf("%s: %s\n  %s\n", b->name, b->summary, b->source);
        print_params(b->params, b->param_count);
        putchar('\n');
    }
    return finish(&o, "scenes", list,
                  "A built-in scene is written NAME[:KEY=VALUE[,KEY=VALUE]...], as in balls:size=5.");
}
