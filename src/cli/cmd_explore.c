/* SPDX-License-Identifier: Apache-2.0 */
/* raytally explore: a page on which to click a pixel, and to step its rays through accelerators. */
#include "cli/cli.h"
#include "render/path.h"
#include "render/ray_tree.h"
#include "report/explore.h"
#include "scenes/open.h"

#include <stdio.h>

typedef struct Options {
    const char *scene, *page, *ray;
    const char *accels[RT_MAX_EXPLORED];
    uint32_t accel_count, size[2], depth, megabytes;
} Options;

static void finish(void *options, struct argp_state *state) {
    Options *o = options;
    if (!o->page) argp_error(state, "the page is missing: -o FILE.html");
    if (o->accel_count == 0) o->accels[o->accel_count++] = rt_accel_default();
}

static const RtOption options[] = {
    {"accel", 'a', "SPEC", RT_TO_LIST(accels, accel_count),
     "Accelerator (default bvh), up to 4 times; `raytally accels` lists them"},
    {"output", 'o', "FILE.html", RT_TO_PATH(page, ".html"), "The page"},
    {"size", 's', "WxH", RT_TO_SIZE(size), "Size of the image in pixels (default 160x120)"},
    {"ray", 'r', RT_RAY_OPERAND, RT_TO_TEXT(ray),
     "Show this ray first, with its own ray tree, beside those of pixels: " RT_RAY_HELP},
    {"depth", 'd', "N", RT_TO_INTEGER(depth, 1, RT_MAX_DEPTH),
     "Levels of the ray tree, the primary ray being the first, 1..64 (default 4)"},
    {"megabytes", 0, "N", RT_TO_INTEGER(megabytes, 1, 100),
     "Size limit for recorded rays, 1..100 (default 6). If the rays of all pixels need more, one pixel in "
     "2 x 2 is recorded, or in 3 x 3, and so on"},
    RT_STRICT_OPTION,
    RT_LIMIT_OPTIONS,
    {0}};

/* Builds all; those that refuse the scene are removed from the options. */
static RtStatus build(RtAccel **accels, RtExploredSpec *specs, char (*texts)[RT_MAX_SPEC_CHARS], Options *o,
                      const RtScene *scene, RtError *error) {
    for (uint32_t i = 0; i < o->accel_count; i++) {
        RtSpec spec;
        RT_TRY(rt_spec_parse(o->accels[i], &spec, error));
        rt_spec_format(&spec, texts[i]);
        const RtStatus status = rt_accel_build(&spec, scene, 0, &accels[i], error);
        if (rt_cli_leave_out(status, o->accels, &o->accel_count, i, error)) {
            i--;
            continue;
        }
        RT_TRY(status);
        rt_cli_tell_idle(o->accels[i], accels[i]);
        RT_TRY(rt_path_available(accels[i], texts[i], error));
        specs[i] = (RtExploredSpec){o->accels[i], texts[i]};
    }
    return RT_OK;
}

static RtStatus run(Options *o, RtError *error) {
    RtRay given;
    const RtExploreOptions how = {
        .depth = o->depth, .given = o->ray ? &given : NULL, .bytes = o->megabytes * 1000000};
    RtAccel *accels[RT_MAX_EXPLORED] = {NULL};
    RtExploredSpec specs[RT_MAX_EXPLORED];
    char texts[RT_MAX_EXPLORED][RT_MAX_SPEC_CHARS];
    RT_OWNED(RtScene, scene, rt_scene_clear);
    uint32_t stride;
    RT_TRY(rt_explore_available(error));
    RT_TRY(rt_cli_check_json_name(o->scene, error));
    if (o->ray) RT_TRY(rt_cli_ray(o->ray, &given, error));
    RT_TRY(rt_cli_open_scene(o->scene, &scene, error));
    RtStatus status = rt_scene_sample(&scene, o->size[0], o->size[1], 1, false, error);
    if (status == RT_OK) status = build(accels, specs, texts, o, &scene, error);
    if (status == RT_OK)
        status = rt_explore_write(o->page, scene.name[0] ? scene.name : o->scene, accels, specs,
                                  o->accel_count, &how, &stride, error);
    if (status == RT_OK && stride == 1) printf("wrote %s, with the rays of all pixels\n", o->page);
    if (status == RT_OK && stride > 1)
        printf("wrote %s, with the rays of one pixel in %u x %u\n", o->page, stride, stride);
    for (uint32_t i = 0; i < o->accel_count; i++) rt_accel_destroy(accels[i]);
    return status;
}

const RtSyntax rt_explore_syntax = {
    .options = options,
    .plugins = true,
    RT_ONE_SCENE,
    .finish = finish,
    .help =
        "Write a web page that shows how accelerators trace a scene: the image beside the structures in 3-D. "
        "Click a pixel to see its ray tree, then step a ray through the accelerators, side by side, and "
        "watch the counters.\v"
        "The page is one file that works without a network: all paths are recorded in advance, as `raytally "
        "trace` prints them. It needs a browser from 2023 or later; without WebGL only the 3-D view is "
        "missing. Examples:\n"
        "  raytally explore balls:size=2 --accel bvh --accel grid -o walk.html\n"
        "  raytally explore balls:size=2 --accel item+light:cells=20+octree \\\n"
        "    -o buffers.html"};

RtStatus rt_command_explore(int argc, char **argv, RtError *error) {
    Options o = {.size = {160, 120}, .depth = 4, .megabytes = 6};
    rt_cli_parse(&rt_explore_syntax, argc, argv, &o);
    return run(&o, error);
}
