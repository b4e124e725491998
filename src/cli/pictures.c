/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/pictures.h"

#include "cli/cli.h"
#include "core/base/words.h"
#include "picture/buffers.h"
#include "render/path.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    RtPictureOptions *o = options;
    const char **slot = &o->heatmaps[counter_by_name(state, counter)];
    if (state->next >= state->argc) argp_error(state, "--heatmap: a FILE.png is needed after the counter");
    char option[64];
    snprintf(option, sizeof option, "--heatmap %s", counter);
    rt_cli_set_path(state, option, slot, state->argv[state->next++], RT_CLI_PICTURES);
}

/* "3" or "2..5" */
static void take_level(void *options, const char *text, struct argp_state *state) {
    RtStructureOptions *boxes = &((RtPictureOptions *)options)->boxes;
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
    RtPictureOptions *o = options;
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
    RtPictureOptions *o = options;
    RtRayKind kind = rt_cli_image_ray_kind(state, "--heatmap-rays", text);
    o->kinds = 1u << kind;
    o->heat.rays = rt_ray_kind_name(kind);
}

static void take_max(void *options, const char *text, struct argp_state *state) {
    RtPictureOptions *o = options;
    char *end;
    o->heat.most = strtod(text, &end);
    if (end == text || *end || !(o->heat.most > 0) || !isfinite(o->heat.most))
        argp_error(state, "--heatmap-max: invalid value '%s': expected a number above 0", text);
}

static void take_scale(void *options, const char *text, struct argp_state *state) {
    RtPictureOptions *o = options;
    bool linear = strcmp(text, "linear") == 0;
    if (!linear && strcmp(text, "log") != 0)
        argp_error(state, "--heatmap-scale: invalid value '%s': expected linear or log", text);
    o->heat.scale = linear ? RT_HEATMAP_LINEAR : RT_HEATMAP_LOG;
}

#define Options RtPictureOptions
const RtOption rt_picture_options[] = {
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
#undef Options

void rt_pictures_finish(RtPictureOptions *o, uint32_t accels, struct argp_state *state) {
    bool heats = rt_pictures_any_heatmap(o);
    const char *structural = o->layer ? "layer" : o->of_boxes ? o->of_boxes : o->of_light;
    if (structural && !o->structure)
        argp_error(state, "--%s needs a picture of a structure: --structure FILE.png", structural);
    if (o->thermal && !heats)
        argp_error(state, "--%s needs a heatmap: --heatmap COUNTER FILE.png", o->thermal);
    if (o->heat.difference && accels != 2)
        argp_error(state, "--heatmap-difference needs two accelerators: give --accel twice");
    if (accels > 1 && !heats)
        argp_error(state, "only --heatmap takes several accelerators: give one --accel");
}

bool rt_pictures_any_heatmap(const RtPictureOptions *o) {
    size_t i = 0;
    while (i < RT_TALLY_COUNTER_COUNT && !o->heatmaps[i]) i++;
    return i < RT_TALLY_COUNTER_COUNT;
}

size_t rt_pictures_list(const RtPictureOptions *o, const char **paths, size_t count) {
    if (o->structure) paths[count++] = o->structure;
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        if (o->heatmaps[i]) paths[count++] = o->heatmaps[i];
    }
    return count;
}

/* ---- writing ---- */

/* Overlays for shadow rays that look rays up in cells. */
static bool has_cells_of_lights(const RtAccel *layer) {
    return layer->ops->find_cell && layer->ops->kinds >> RT_RAY_SHADOW & 1;
}

RtStatus rt_pictures_check(const RtPictureOptions *o, const RtAccel *accel, RtError *error) {
    const RtAccel *layer;
    if (!o->structure) return RT_OK;
    RT_TRY(rt_structure_layer(accel, o->layer, &layer, error));
    if (o->of_boxes && layer->ops->find_cell)
        return rt_fail(error, RT_BAD_INPUT,
                       "--%s needs a layer that has boxes, such as bvh or grid, but the picture shows %s: "
                       "leave it out, or choose another --layer",
                       o->of_boxes, layer->ops->name);
    if (o->of_light && !has_cells_of_lights(layer))
        return rt_fail(error, RT_BAD_INPUT,
                       "--%s needs the cells around a light, which only the layer light has, but the picture "
                       "shows %s: leave it out, or draw light, as in --accel light:cells=64+bvh",
                       o->of_light, layer->ops->name);
    return RT_OK;
}

bool rt_pictures_need_frame(const RtPictureOptions *o, const RtAccel *accel) {
    RtError error;
    const RtAccel *layer;
    return rt_structure_layer(accel, o->layer, &layer, &error) == RT_OK && !layer->ops->find_cell;
}

static RtStatus draw_cells(const RtPictureOptions *o, const RtAccel *accel, const RtAccel *layer,
                           RtError *error) {
    RtRay ray;
    const RtSampling *s = &accel->scene->sampling;
    if (o->pixel.given) RT_TRY(rt_cli_check_pixel(s, o->pixel, error));
    if (o->pixel.given && o->light < accel->scene->light_count) {
        RtFootprint f = rt_pixel_footprint(s, o->pixel.x, o->pixel.y);
        RT_TRY(rt_path_ray(accel, RT_RAY_SHADOW, f.column + f.span / 2, f.row + f.span / 2, o->light, &ray,
                           error));
    }
    return rt_buffer_draw(o->structure, layer, o->light, o->pixel.given ? &ray : NULL, error);
}

RtStatus rt_pictures_structure(const RtPictureOptions *o, const RtAccel *accel, const RtFrame *frame,
                               RtError *error) {
    const RtAccel *layer;
    RtStructureOptions boxes = o->boxes;
    RT_TRY(rt_structure_layer(accel, o->layer, &layer, error));
    if (layer->ops->find_cell) return draw_cells(o, accel, layer, error);
    if (o->in_middle) boxes.at = (double)rt_box_center(accel->scene->geometry.box).at[boxes.axis];
    return rt_structure_draw(o->structure, layer, frame, &boxes, error);
}

RtStatus rt_pictures_heatmaps(const RtPictureOptions *o, const RtHeatmapPanel *panels, uint32_t count,
                              RtError *error) {
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        RtHeatmapOptions heat = o->heat;
        heat.counter = i;
        if (o->heatmaps[i]) RT_TRY(rt_heatmap_draw(o->heatmaps[i], panels, count, &heat, error));
    }
    return RT_OK;
}
