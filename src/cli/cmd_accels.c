/* SPDX-License-Identifier: Apache-2.0 */
/* raytally accels: the table of accelerators. */
#include "accel/accel.h"
#include "cli/cli.h"

#include <stdio.h>

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
    rt_cli_print_params(ops->params, ops->param_count);
    for (size_t i = 0; i < ops->best_count; i++) {
        const RtBestOf *best = &ops->bests[i];
        printf("  as a baseline, %s:%s: %s (%s)\n", ops->name, best->name, best->meaning, best->settings);
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
                     rt_cli_params_json(ops->params, ops->param_count), "best_of", bests);
}

const RtSyntax rt_accels_syntax = {.options = rt_list_options,
                                   .plugins = true,
                                   .arguments = "[NAME]",
                                   .argument = RT_LIST_ARGUMENT,
                                   .help = "List the accelerators, or explain the one called NAME: its "
                                           "parameters with defaults and ranges, and the paper it follows."};

RtStatus rt_command_accels(int argc, char **argv, RtError *error) {
    RtListOptions o = {0};
    rt_cli_parse(&rt_accels_syntax, argc, argv, &o);
    const RtAccelOps *only = NULL;
    if (o.name) RT_TRY(rt_accel_find(o.name, &only, error));
    json_t *list = json_array();
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        if (only && ops != only) continue;
        if (o.json) {
            json_array_append_new(list, accelerator_json(ops));
        } else {
            print_accelerator(ops);
        }
    }
    rt_list_finish(
        &o, "accelerators", list,
        "An accelerator is written NAME[:KEY=VALUE[,KEY=VALUE]...], as in grid:density=4; overlays\n"
        "come before it, as in OVERLAY+grid:density=4.");
    return RT_OK;
}
