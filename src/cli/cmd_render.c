/* SPDX-License-Identifier: Apache-2.0 */
/* raytally render: a picture of a scene, and its cost. The timed kernels make the picture; the counted
 * kernels trace a second frame if counts are needed. */
#include "accel/columns.h"
#include "cli/cli.h"
#include "core/base/clock.h"
#include "core/base/parallel.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "picture/pictures.h"
#include "rays/rayset.h"
#include "render/frame.h"
#include "render/path.h"
#include "scenes/open.h"
#include "verify/equivalence.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { MOST_OUTPUTS = RT_TALLY_COUNTER_COUNT + 3 };

typedef struct Options {
    const char *scene;
    const char *accels[RT_MAX_PANELS]; /* the first makes the image; all are counted for heatmaps */
    uint32_t accel_count;
    uint32_t size[2]; /* width, height; 0: the camera's */
    uint32_t samples, depth;
    int threads;
    bool corners, check;
    const char *png, *stats;                      /* paths, or NULL */
    const char *structure, *layer;                /* a path or NULL; a name or NULL */
    const char *heatmaps[RT_TALLY_COUNTER_COUNT]; /* paths, by counter */
    RtStructureOptions boxes;
    bool in_middle; /* the slice is in the middle of the scene; boxes.at is not set */
    RtHeatmapOptions heat;
    uint32_t kinds; /* of rays, bits; 0: all */
    uint32_t light; /* of an overlay for shadow rays */
    RtPixel pixel;  /* of the marked ray */
    /* The name of the last given option, or NULL, that needs a picture of boxes, a picture of a light's
     * cells, or --heatmap. */
    const char *of_boxes, *of_light, *thermal;
    const char *outputs[MOST_OUTPUTS]; /* the files to be written; by finish */
    uint32_t output_count, heatmap_count;
} Options;

static void finish(void *options, struct argp_state *state) {
    Options *o = options;
    const char *const others[] = {o->png, o->stats, o->structure};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        if (others[i]) o->outputs[o->output_count++] = others[i];
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        o->heatmap_count += o->heatmaps[i] != NULL;
        if (o->heatmaps[i]) o->outputs[o->output_count++] = o->heatmaps[i];
    }
    if (o->accel_count == 0) o->accels[o->accel_count++] = rt_accel_default();
    if (o->output_count == 0 && !o->check)
        argp_error(state, "nothing to do: give -o FILE.png, or --heatmap, --structure, --stats or --check");
    for (uint32_t i = 0; i < o->output_count; i++) {
        for (uint32_t k = 0; k < i; k++) {
            if (strcmp(o->outputs[k], o->outputs[i]) != 0) continue;
            argp_error(state, "'%s' would be written twice: give each output its own file", o->outputs[i]);
        }
    }
    const char *structural = o->layer ? "layer" : o->of_boxes ? o->of_boxes : o->of_light;
    if (structural && !o->structure)
        argp_error(state, "--%s needs a picture of a structure: --structure FILE.png", structural);
    if (o->thermal && !o->heatmap_count)
        argp_error(state, "--%s needs a heatmap: --heatmap COUNTER FILE.png", o->thermal);
    if (o->heat.difference && o->accel_count != 2)
        argp_error(state, "--heatmap-difference needs two accelerators: give --accel twice");
    if (o->accel_count > 1 && !o->heatmap_count)
        argp_error(state, "only --heatmap takes several accelerators: give one --accel");
}

static size_t counter_by_name(struct argp_state *state, const char *name) {
    const char *names[RT_TALLY_COUNTER_COUNT];
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        names[i] = rt_tally_name(i);
        if (strcmp(names[i], name) == 0) return i;
    }
    char list[256], suggestion[RT_MAX_SUGGESTION];
    rt_join_names(names, RT_TALLY_COUNTER_COUNT, list, sizeof list);
    rt_suggest(name, names, RT_TALLY_COUNTER_COUNT, suggestion);
    argp_error(state, "--heatmap: there is no counter '%s'%s%s%s", name, suggestion,
               *suggestion ? " The counters are: " : ": the counters are ", list);
    return 0;
}

static void take_heatmap(void *options, const char *counter, struct argp_state *state) {
    Options *o = options;
    const char **slot = &o->heatmaps[counter_by_name(state, counter)];
    if (state->next >= state->argc) argp_error(state, "--heatmap: a FILE.png is needed after the counter");
    char option[64];
    snprintf(option, sizeof option, "--heatmap %s", counter);
    rt_cli_set_path(state, option, slot, state->argv[state->next++], RT_CLI_PICTURES);
}

/* "3" or "2..5" */
static void take_level(void *options, const char *text, struct argp_state *state) {
    RtStructureOptions *boxes = &((Options *)options)->boxes;
    const char *at = text;
    bool good = rt_cli_digits(&at, &boxes->first_level);
    boxes->last_level = boxes->first_level;
    if (good && strncmp(at, "..", 2) == 0) {
        at += 2;
        good = rt_cli_digits(&at, &boxes->last_level);
    }
    if (!good || *at || boxes->first_level > boxes->last_level)
        argp_error(state, "--level: invalid value '%s': expected a level or a range, as in 3 or 2..5", text);
}

/* "y" or "y=0.5" */
static void take_slice(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    const char *axis = strchr("xyz", text[0]);
    char *end = NULL;
    o->boxes.slice = true;
    o->in_middle = text[0] && text[1] == 0;
    if (text[0] && text[1] == '=') o->boxes.at = strtod(text + 2, &end);
    bool number = end && end > text + 2 && *end == 0 && isfinite(o->boxes.at);
    if (!text[0] || !axis || (!o->in_middle && !number))
        argp_error(
            state,
            "--slice: invalid value '%s': expected an axis, or an axis and a position, as in z or z=0.5",
            text);
    o->boxes.axis = (int)(axis - "xyz");
}

static void take_rays(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    RtRayKind kind = rt_cli_image_ray_kind(state, "--heatmap-rays", text);
    o->kinds = 1u << kind;
    o->heat.rays = rt_ray_kind_name(kind);
}

static void take_max(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    char *end;
    o->heat.most = strtod(text, &end);
    if (end == text || *end || !(o->heat.most > 0) || !isfinite(o->heat.most))
        argp_error(state, "--heatmap-max: invalid value '%s': expected a number above 0", text);
}

static void take_scale(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    bool linear = strcmp(text, "linear") == 0;
    if (!linear && strcmp(text, "log") != 0)
        argp_error(state, "--heatmap-scale: invalid value '%s': expected linear or log", text);
    o->heat.scale = linear ? RT_HEATMAP_LINEAR : RT_HEATMAP_LOG;
}

static const RtOption options[] = {
    {"accel", 'a', "SPEC", RT_TO_LIST(accels, accel_count),
     "Accelerator (default bvh); `raytally accels` lists them. With --heatmap up to 8 times, to compare"},
    {"size", 's', "WxH", RT_TO_SIZE(size), "Size of the image in pixels (default: the camera's)"},
    {"corners", 0, NULL, RT_TO_FLAG(corners),
     "Sample the corners of pixels, (W+1) x (H+1) rays, as the SPD scenes require"},
    {"samples", 'n', "N", RT_TO_INTEGER(samples, 1, 64), "N x N samples per pixel, 1..64 (default 1)"},
    {"depth", 'd', "N", RT_TO_INTEGER(depth, 1, RT_MAX_DEPTH),
     "Levels of the ray tree, the primary ray being the first, 1..64 (default 5)"},
    {"threads", 't', "N", RT_TO_INTEGER(threads, 1, 1024), "Threads (default: all processors)"},
    RT_STRICT_OPTION,
    RT_LIMIT_OPTIONS,
    {"output", 'o', "FILE.png", RT_TO_PATH(png, ".png"), "The image"},
    {"stats", 0, "FILE.json", RT_TO_PATH(stats, ".json"),
     "Counts by ray kind, sizes and build times of each --accel; the image's time with the first"},
    {"check", 0, NULL, RT_TO_FLAG(check),
     "Compare the answer to every ray, and the frame, with those of brute; exit code 1 if one differs. brute "
     "is slow: try a small --size first"},
    {NULL, 0, NULL, {0}, "Pictures of a structure:"},
    {"structure", 0, "FILE", RT_TO_PATH(structure, RT_CLI_PICTURES),
     "Draw the accelerator's boxes over the image; for item the objects in its samples, for light the "
     "lengths of its lists on an unfolded cube. PNG, SVG or PDF, by the file name"},
    {"layer", 0, "NAME", RT_TO_TEXT(layer),
     "For overlays: the layer to draw (default: the topmost that can be drawn)"},
    {"level", 0, "A[..B]", RT_MARKING(of_boxes, RT_CALLS(take_level)),
     "Draw only the boxes of this level, or of these levels; the root is level 0"},
    {"leaves", 0, NULL, RT_MARKING(of_boxes, RT_SETS_FLAG(boxes.leaves)),
     "Draw only leaves: boxes that list objects"},
    {"slice", 0, "AXIS[=AT]", RT_MARKING(of_boxes, RT_CALLS(take_slice)),
     "Draw the section at x, y or z = AT (default: the middle of the scene), with the boxes and objects that "
     "it cuts"},
    {"light", 0, "N", RT_MARKING(of_light, RT_SETS_INTEGER(light, 0, UINT32_MAX)),
     "For light: the light whose cells are drawn (default 0)"},
    {"pixel", 0, "X,Y", RT_MARKING(of_light, RT_SETS_PIXEL(pixel)),
     "For light: mark the cell that the shadow ray of this pixel reads"},
    {NULL, 0, NULL, {0}, "Heatmaps, the cost of each pixel:"},
    {"heatmap", 0, "COUNTER FILE", RT_TO_TAKE(take_heatmap),
     "object_tests, extent_tests, steps, or any other counter; may be repeated. Several --accel are drawn "
     "side by side on one scale"},
    {"heatmap-max", 0, "VALUE", RT_MARKING(thermal, RT_CALLS(take_max)),
     "Values of VALUE and above get the brightest colour (default: the maximum)"},
    {"heatmap-scale", 0, "linear|log", RT_MARKING(thermal, RT_CALLS(take_scale)),
     "How values map to colours (default: log if the mean is below an eighth of the maximum)"},
    {"heatmap-rays", 0, "KIND", RT_MARKING(thermal, RT_CALLS(take_rays)),
     "Count only primary, shadow, reflection or transmission rays"},
    {"heatmap-difference", 0, NULL, RT_MARKING(thermal, RT_SETS_FLAG(heat.difference)),
     "For two --accel: also draw the first minus the second, red where the first costs more"},
    {0}};

/* ---- the frames ---- */

static RtStatus check_layer(const Options *o, const RtAccel *layer, RtError *error) {
    const bool of_lights = layer->ops->find_cell && layer->ops->kinds >> RT_RAY_SHADOW & 1;
    if (o->of_boxes && layer->ops->find_cell)
        return rt_fail(error, RT_BAD_INPUT,
                       "--%s needs a layer that has boxes, such as bvh or grid, but the picture shows %s: "
                       "leave it out, or choose another --layer",
                       o->of_boxes, layer->ops->name);
    if (o->of_light && !of_lights)
        return rt_fail(error, RT_BAD_INPUT,
                       "--%s needs the cells around a light, which only the layer light has, but the picture "
                       "shows %s: leave it out, or draw light, as in --accel light:cells=64+bvh",
                       o->of_light, layer->ops->name);
    return RT_OK;
}

typedef struct Built {
    char spec[RT_MAX_SPEC_CHARS];
    double build_seconds;
    RtDescription description;
    RtFrame counted;
} Built;

typedef struct Run {
    Options *options; /* accelerators that refuse the scene are removed */
    RtScene scene;
    RtAccel *accel;       /* the first */
    const RtAccel *layer; /* of it, drawn as the structure */
    RtFrameOptions frame_options;
    RtFrame timed;              /* by it */
    Built built[RT_MAX_PANELS]; /* [accel_count] */
    bool by_default; /* only the picture of the structure is made: the default accelerator draws its
                        background */
} Run;

static void show_progress(void *context, size_t tiles_done, size_t tiles) {
    size_t percent = tiles_done * 100 / tiles;
    if (tiles_done > 1 && percent == (tiles_done - 1) * 100 / tiles) return;
    fprintf(stderr, "\r%s %3zu %%", (const char *)context, percent);
    if (tiles_done == tiles) fprintf(stderr, "\r%*s\r", (int)strlen(context) + 6, "");
}

static RtStatus build(Run *run, uint32_t i, RtAccel **accel, RtError *error) {
    Built *built = &run->built[i];
    RtSpec spec;
    RT_TRY(rt_spec_parse(run->options->accels[i], &spec, error));
    rt_spec_format(&spec, built->spec);
    double start = rt_wall_seconds();
    RT_TRY(rt_accel_build(&spec, &run->scene, run->options->threads, accel, error));
    built->build_seconds = rt_wall_seconds() - start;
    rt_cli_tell_idle(run->options->accels[i], *accel);
    rt_accel_describe(*accel, &built->description);
    return RT_OK;
}

/* Whether the command goes on without accelerator `i`, which ended its build with `status`. The difference of
 * two heatmaps needs both. */
static bool leave_out(Options *o, RtStatus status, uint32_t i, const RtError *why) {
    return !o->heat.difference && rt_cli_leave_out(status, o->accels, &o->accel_count, i, why);
}

static RtStatus trace_frames(Run *run, RtError *error) {
    const Options *o = run->options;
    RtFrameOptions *f = &run->frame_options;
    *f = (RtFrameOptions){.depth = o->depth, .threads = o->threads};
    if (isatty(STDERR_FILENO)) f->progress = show_progress;
    f->progress_context = "tracing";
    bool alone = o->structure && o->output_count == 1 && !o->check;
    if (alone && run->layer->ops->find_cell) return RT_OK; /* cells are drawn without an image */
    run->by_default = alone && run->accel->exact;
    if (run->by_default) { /* the same image bit for bit */
        RT_OWNED(RtAccel *, quick, rt_accel_destroy_at);
        RT_TRY(rt_accel_open_on(rt_accel_default(), &run->scene, f->threads, &quick, error));
        return rt_frame_trace(&run->timed, quick, f, error);
    }
    RT_TRY(rt_frame_trace(&run->timed, run->accel, f, error));
    if (!o->stats && !o->heatmap_count) return RT_OK;
    f->progress_context = "counting";
    f->counted = true;
    f->cost_kinds = o->kinds;
    RT_TRY(rt_frame_trace(&run->built[0].counted, run->accel, f, error));
    for (uint32_t i = 1; i < o->accel_count; i++) {
        RtAccel *accel = NULL;
        RtStatus status = build(run, i, &accel, error);
        if (status == RT_OK) status = rt_frame_trace(&run->built[i].counted, accel, f, error);
        rt_accel_destroy(accel);
        if (leave_out(run->options, status, i, error))
            i--;
        else
            RT_TRY(status);
    }
    return RT_OK;
}

static RtStatus prepare(Run *run, RtError *error) {
    const Options *o = run->options;
    RtSpec spec;
    for (uint32_t i = o->accel_count; i-- > 0;) RT_TRY(rt_spec_parse(o->accels[i], &spec, error));
    if (o->structure) RT_TRY(rt_structure_available(&spec, o->layer, error));
    if (o->stats) RT_TRY(rt_cli_check_json_name(o->scene, error));
    RT_TRY(rt_cli_open_scene(o->scene, &run->scene, error));
    RT_TRY(rt_scene_sample(&run->scene, o->size[0], o->size[1], o->samples, o->corners, error));
    RtStatus status = build(run, 0, &run->accel, error);
    while (leave_out(run->options, status, 0, error)) status = build(run, 0, &run->accel, error);
    RT_TRY(status);
    if (!o->structure) return RT_OK;
    RT_TRY(rt_structure_layer(run->accel, o->layer, &run->layer, error));
    return check_layer(o, run->layer, error);
}

/* ---- what is written ---- */

static RtStatus draw_structure(const Run *run, RtError *error) {
    const Options *o = run->options;
    const RtSampling *s = &run->scene.sampling;
    RtStructureOptions boxes = o->boxes;
    RtRay ray;
    if (o->in_middle) boxes.at = (double)rt_box_center(run->scene.geometry.box).at[boxes.axis];
    if (!run->layer->ops->find_cell)
        return rt_structure_draw(o->structure, run->layer, &run->timed, &boxes, error);
    if (o->pixel.given) RT_TRY(rt_cli_check_pixel(s, o->pixel, error));
    if (o->pixel.given && o->light < run->scene.light_count) {
        RtFootprint f = rt_pixel_footprint(s, o->pixel.x, o->pixel.y);
        RT_TRY(rt_path_ray(run->accel, RT_RAY_SHADOW, f.column + f.span / 2, f.row + f.span / 2, o->light,
                           &ray, error));
    }
    return rt_buffer_draw(o->structure, run->layer, o->light, o->pixel.given ? &ray : NULL, error);
}

static RtStatus write_heatmaps(const Run *run, RtError *error) {
    const Options *o = run->options;
    RtHeatmapPanel panels[RT_MAX_PANELS];
    for (uint32_t i = 0; i < o->accel_count; i++)
        panels[i] = (RtHeatmapPanel){&run->built[i].counted, o->accel_count > 1 ? o->accels[i] : NULL};
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        RtHeatmapOptions heat = o->heat;
        heat.counter = i;
        if (o->heatmaps[i]) RT_TRY(rt_heatmap_draw(o->heatmaps[i], panels, o->accel_count, &heat, error));
    }
    return RT_OK;
}

static uint64_t total_rays(const RtFrame *frame) {
    uint64_t sum = 0;
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) sum += frame->ray_count[kind];
    return sum;
}

static json_t *kinds_json(const RtFrame *counted) {
    json_t *kinds = json_object();
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        if (counted->ray_count[kind])
            json_object_set_new(kinds, rt_ray_kind_name((RtRayKind)kind),
                                rt_json_tally(&counted->tallies[kind]));
    }
    return kinds;
}

static json_t *compared_json(const Run *run) {
    json_t *list = json_array();
    for (uint32_t i = 1; i < run->options->accel_count; i++) {
        const Built *b = &run->built[i];
        json_array_append_new(list, json_pack("{s:s, s:s, s:f, s:I, s:o, s:o}", "accel",
                                              run->options->accels[i], "spec", b->spec, "build_seconds",
                                              b->build_seconds, "bytes", (json_int_t)b->description.bytes,
                                              "structure", rt_json_structure(&b->description), "kinds",
                                              kinds_json(&b->counted)));
    }
    return list;
}

static json_t *stats_json(const Run *run) {
    const RtSampling *s = &run->timed.sampling;
    const Options *o = run->options;
    const Built *b = &run->built[0];
    uint64_t rays = total_rays(&run->timed);
    double mrays = run->timed.seconds > 0 ? (double)rays * 1e-6 / run->timed.seconds : 0;
    return json_pack(
        "{s:s, s:s, s:s, s:I, s:I, s:i, s:i, s:i, s:b, s:i, s:i, s:f, s:I, s:o, s:I, s:f, s:f, s:o, s:o}",
        "scene", run->scene.name, "accel", o->accels[0], "spec", b->spec, "objects",
        (json_int_t)rt_geometry_id_count(&run->scene.geometry), "lights", (json_int_t)run->scene.light_count,
        "width", (int)s->width, "height", (int)s->height, "samples", (int)s->samples, "corners",
        (int)s->corners, "depth", (int)o->depth, "threads", rt_thread_count(o->threads), "build_seconds",
        b->build_seconds, "bytes", (json_int_t)b->description.bytes, "structure",
        rt_json_structure(&b->description), "rays", (json_int_t)rays, "seconds", run->timed.seconds,
        "mrays_per_s", mrays, "kinds", kinds_json(&b->counted), "compared", compared_json(run));
}

static void print_rays(const Run *run) {
    uint64_t rays = total_rays(&run->timed);
    int threads = rt_thread_count(run->options->threads);
    printf(", %u level%s: ", run->options->depth, rt_plural(run->options->depth));
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        if (run->timed.ray_count[kind])
            printf("%llu %s, ", (unsigned long long)run->timed.ray_count[kind],
                   rt_ray_kind_name((RtRayKind)kind));
    }
    printf("%llu ray%s in %.3g s on %d thread%s: %.3g Mrays/s.", (unsigned long long)rays, rt_plural(rays),
           run->timed.seconds, threads, rt_plural((uint64_t)threads),
           (double)rays * 1e-6 / fmax(run->timed.seconds, 1e-9));
}

/* The counters of the heatmaps, per ray over all kinds. */
static void print_counts(const Run *run, const char *spec, const RtFrame *counted) {
    const char *separator = ": ";
    const uint64_t rays = total_rays(counted);
    fputs(spec, stdout);
    for (size_t c = 0; c < RT_TALLY_COUNTER_COUNT; c++) {
        double sum = 0;
        if (!run->options->heatmaps[c]) continue;
        for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++)
            sum += (double)rt_tally_get(&counted->tallies[kind], c);
        printf("%s%.4g %s", separator, sum / (double)(rays ? rays : 1), rt_tally_name(c));
        separator = ", ";
    }
    puts(" a ray.");
}

static void print_summary(const Run *run) {
    const Options *o = run->options;
    const uint32_t objects = rt_geometry_id_count(&run->scene.geometry);
    const RtSampling *s = &run->scene.sampling;
    const Built *b = &run->built[0];
    printf("%s: %u object%s, %u light%s. %s: built in %.3g s, %.3g MB. %u x %u pixels%s",
           run->scene.name[0] ? run->scene.name : o->scene, objects, rt_plural(objects),
           run->scene.light_count, rt_plural(run->scene.light_count), b->spec, b->build_seconds,
           (double)b->description.bytes * 1e-6, s->width, s->height, s->corners ? " at their corners" : "");
    if (run->by_default) /* its speed says nothing about this one */
        printf(", drawn over an image by %s.", rt_accel_default());
    else if (total_rays(&run->timed) > 0)
        print_rays(run);
    else
        printf(", not traced: the picture shows only cells.");
    for (uint32_t i = 0; i < o->output_count; i++) printf("%s%s", i ? ", " : " Wrote ", o->outputs[i]);
    puts(o->output_count ? "." : "");
    for (uint32_t i = 0; o->accel_count > 1 && i < o->accel_count; i++)
        print_counts(run, o->accels[i], &run->built[i].counted);
}

/* ---- the check ---- */

static RtStatus check_kind(const Run *run, const RtAccel *brute, const RtRaySet *set, RtError *error) {
    RT_OWNED(RtReference, reference, rt_reference_clear);
    RtEquivalence result;
    int threads = run->options->threads;
    RT_TRY(rt_reference_init(&reference, brute, set->rays, (size_t)set->count, threads, error));
    RT_TRY(rt_equivalence_check(&reference, run->accel, threads, &result, error));
    if (!result.any_wrong && result.occluded_wrong == 0) {
        printf("%s: the hits of all %llu %s rays equal brute's.\n", run->built[0].spec,
               (unsigned long long)set->count, rt_ray_kind_name(set->kind));
        return RT_OK;
    }
    char says[512];
    rt_wrong_answer_format(&result.first_wrong, says, sizeof says);
    return rt_fail(error, RT_MISMATCH, "%s differs from brute on %s rays, first on: %s", run->built[0].spec,
                   rt_ray_kind_name(set->kind), says);
}

static RtStatus check_frame(const Run *run, const RtAccel *brute, RtError *error) {
    const RtFrame *got = &run->timed;
    RT_OWNED(RtFrame, right, rt_frame_clear);
    RtFrameOptions plain = {.depth = run->options->depth, .threads = run->options->threads};
    if (!run->accel->exact) return RT_OK;
    RT_TRY(rt_frame_trace(&right, brute, &plain, error));
    size_t i = 0, samples = (size_t)got->sampling.columns * got->sampling.rows;
    while (i < samples && memcmp(&got->object[i], &right.object[i], sizeof *got->object) == 0 &&
           memcmp(&got->depth[i], &right.depth[i], sizeof *got->depth) == 0 &&
           memcmp(&got->color[i], &right.color[i], sizeof *got->color) == 0) {
        i++;
    }
    if (i < samples)
        return rt_fail(error, RT_MISMATCH,
                       "%s: the frame differs from brute's in column %zu, row %zu of samples",
                       run->built[0].spec, i % got->sampling.columns, i / got->sampling.columns);
    printf("%s: the frame equals brute's, bit for bit.\n", run->built[0].spec);
    return RT_OK;
}

static RtStatus check_rays(const Run *run, RtError *error) {
    RtRaySet sets[RT_RAY_KIND_COUNT] = {0};
    RtRecording recording = {.depth = run->options->depth, .threads = run->options->threads};
    RT_OWNED(RtAccel *, brute, rt_accel_destroy_at);
    RT_TRY(rt_accel_open(rt_accel_truth(), &run->scene, &brute, error));
    RtStatus status = rt_rayset_record(sets, run->accel, &recording, error);
    for (int kind = 0; kind < RT_RAY_KIND_COUNT && status == RT_OK; kind++) {
        if (run->timed.ray_count[kind] > 0) status = check_kind(run, brute, &sets[kind], error);
    }
    if (status == RT_OK) status = check_frame(run, brute, error);
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_rayset_clear(&sets[kind]);
    return status;
}

static const char help[] =
    "Trace SCENE, a file or a built-in (as in balls:size=4), under the standard illumination model.\v"
    "For example:\n"
    "  raytally render balls -o balls.png\n"
    "  raytally render balls --accel octree --structure leaves.png --leaves \\\n"
    "    --level 0..6\n"
    "  raytally render balls --accel grid --structure section.png --slice z\n"
    "  raytally render balls --accel item+bvh --structure samples.png\n"
    "  raytally render balls --accel light:cells=64+bvh --structure cells.png \\\n"
    "    --pixel 256,400\n"
    "  raytally render balls --accel grid --accel kd \\\n"
    "    --heatmap object_tests tests.png --heatmap-difference\n\n"
    "`raytally trace` follows a single ray. docs/columns.md explains the counters.";
const RtSyntax rt_render_syntax = {
    .options = options, .plugins = true, RT_ONE_SCENE, .finish = finish, .help = help};

RtStatus rt_command_render(int argc, char **argv, RtError *error) {
    Options o = {.samples = 1, .depth = RT_DEFAULT_DEPTH, .boxes = RT_ALL_LEVELS};
    rt_cli_parse(&rt_render_syntax, argc, argv, &o);
    Run run = {.options = &o};
    RtStatus status = prepare(&run, error);
    if (status == RT_OK) status = trace_frames(&run, error);
    if (status == RT_OK && o.png) status = rt_png_write(&run.timed, o.png, error);
    if (status == RT_OK && o.structure) status = draw_structure(&run, error);
    if (status == RT_OK && o.heatmap_count) status = write_heatmaps(&run, error);
    if (status == RT_OK && o.stats) status = rt_json_save(o.stats, stats_json(&run), error);
    if (status == RT_OK) print_summary(&run);
    if (status == RT_OK && o.check) status = check_rays(&run, error);
    rt_frame_clear(&run.timed);
    for (uint32_t i = 0; i < o.accel_count; i++) rt_frame_clear(&run.built[i].counted);
    rt_accel_destroy(run.accel);
    rt_scene_clear(&run.scene);
    return status;
}
