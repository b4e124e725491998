/* SPDX-License-Identifier: Apache-2.0 */
/* raytally convert: a scene from one format to another, or moved; rays that move with it. */
#include "cli/cli.h"
#include "core/base/file.h"
#include "core/base/words.h"
#include "core/scene/load.h"
#include "measure/measure.h"
#include "scenes/builtin.h"
#include "scenes/open.h"

typedef struct Options {
    const char *in, *out;
    bool force, flatten, recentre;
    RtVec3d offset; /* x is NaN: the centre of the scene */
} Options;

static void take_file(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    if (o->out) argp_error(state, "one scene IN and one file OUT; '%s' is one too many", text);
    *(o->in ? &o->out : &o->in) = text;
}

static void take_offset(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    double *at = o->offset.at;
    int used = 0;
    o->recentre = true;
    if (!text) return;
    bool good = sscanf(text, "%lf,%lf,%lf%n", &at[0], &at[1], &at[2], &used) == 3 && !text[used];
    for (int a = 0; a < 3 && good; a++) good = fabs(at[a]) <= (double)RT_MAX_COORDINATE;
    if (!good)
        argp_error(state, "--recentre: invalid value '%s': expected X,Y,Z, as in 500000,5400000,0", text);
}

static void finish(void *options, struct argp_state *state) {
    Options *o = options;
    if (!o->out) argp_error(state, "give a scene IN and a file OUT");
    if (rt_ends_in(o->in, ".npy") != rt_ends_in(o->out, ".npy"))
        argp_error(state, "rays (.npy) become rays, and scenes scenes");
    if (rt_ends_in(o->in, ".npy") && isnan(o->offset.x))
        argp_error(state, "rays move by the offset of their scene: give --recentre=X,Y,Z");
    if (o->recentre && !rt_ends_in(o->in, ".npy") && !rt_scene_is_file(o->in))
        argp_error(state, "--recentre is for files: '%s' is built in", o->in);
}

static const RtOption options[] = {
    {"force", 'f', NULL, RT_TO_FLAG(force), "Replace OUT if it exists"},
    {"flatten", 0, NULL, RT_TO_FLAG(flatten), "Write instances as copies of their parts' objects"},
    {"recentre", 0, "X,Y,Z", RT_TO_TAKE_OPTIONAL(take_offset),
     "Subtract X,Y,Z, or the centre of the scene, rounded to few bits, from all "
     "coordinates before they are rounded to float32"},
    RT_STRICT_OPTION,
    RT_LIMIT_OPTIONS,
    {0}};

const RtSyntax rt_convert_syntax = {
    .options = options,
    .arguments = "IN OUT",
    .argument = {.name = "IN", .value = RT_TO_TAKE(take_file)},
    .finish = finish,
    .help = "Read the scene IN (a file or a built-in) and write it to OUT, "
            "in the format that the extension of OUT names. With --recentre=X,Y,Z "
            "IN and OUT may also be rays (.npy).\v"
            "For example:\n"
            "  raytally convert balls:size=2 balls.yaml\n"
            "  raytally convert bunny.obj bunny.ply\n"
            "  raytally convert --recentre utm.obj city.yaml"};

static RtStatus move_rays(const Options *o, RtError *error) {
    RtRaySet set;
    RT_TRY(rt_rays_load(o->in, RT_RAY_RANDOM, &set, error));
    for (uint64_t i = 0; i < set.count; i++)
        set.rays[i].org = rt_narrow(rt_subd(rt_widen(set.rays[i].org), o->offset));
    RtStatus status = rt_rays_save(&set, o->out, error);
    rt_rayset_clear(&set);
    return status;
}

/* Textures and instances are YAML's alone. */
static RtStatus warn_losses(RtScene *scene, const char *out, RtError *error) {
    uint32_t textures = 0, ids = rt_geometry_id_count(&scene->geometry);
    for (uint32_t i = 0; i < scene->material_count; i++)
        textures += scene->materials[i].texture.kind != RT_TEXTURE_NONE;
    if (rt_scene_keeps_instances(out)) return RT_OK;
    scene->warnings.first = scene->warnings.count;
    if (scene->geometry.instance_count > 0)
        RT_TRY(rt_warn_at(&scene->warnings, out, 0, error,
                          "instances, which only .yaml keeps, become copies: %u object%s in all", ids,
                          rt_plural(ids)));
    if (textures == 0) return RT_OK;
    return rt_warn_at(&scene->warnings, out, 0, error,
                      "the textures of %u material%s are left out, which only .yaml keeps", textures,
                      rt_plural(textures));
}

static RtStatus flatten(RtScene *scene, RtError *error) {
    RtScene flat;
    RT_TRY(rt_scene_flatten(scene, &flat, error));
    flat.warnings = scene->warnings;
    scene->warnings = (RtWarnings){0};
    rt_scene_clear(scene);
    *scene = flat;
    return RT_OK;
}

RtStatus rt_command_convert(int argc, char **argv, RtError *error) {
    Options o = {.offset = {{NAN, NAN, NAN}}};
    const double *by = o.offset.at;
    RT_OWNED(RtScene, scene, rt_scene_clear);
    rt_cli_parse(&rt_convert_syntax, argc, argv, &o);
    if (!o.force && rt_file_exists(o.out))
        return rt_fail(error, RT_BAD_INPUT,
                       "%s already exists: remove it, choose another name, or convert with --force", o.out);
    if (rt_ends_in(o.in, ".npy")) return move_rays(&o, error);
    RT_TRY(o.recentre ? rt_scene_load(o.in, rt_builtin_open, &o.offset, &scene, error)
                      : rt_scene_open(o.in, &scene, error));
    if (o.flatten) RT_TRY(flatten(&scene, error));
    RT_TRY(warn_losses(&scene, o.out, error));
    rt_cli_tell_warnings(&scene);
    RT_TRY(rt_scene_save(&scene, o.out, error));
    if (o.recentre)
        printf("%s: moved by %.17g %.17g %.17g; convert its rays, and what belongs to it, with "
               "--recentre=%.17g,%.17g,%.17g\n",
               o.out, 0 - by[0], 0 - by[1], 0 - by[2], by[0], by[1], by[2]);
    return RT_OK;
}
