/* SPDX-License-Identifier: Apache-2.0 */
#include "report/explore.h"

#include "core/base/file.h"
#include "explore_css.h"
#include "explore_html.h"
#include "explore_js.h"
#include "picture/canvas.h"
#include "report/explore_record.h"
#include "report/page.h"

enum { SCALE_COLORS = 16, MOST_COPIES = 1000000, MOST_IDS = 100000000 };

RtStatus rt_explore_available(RtError *error) {
    if (explore_js[0]) return RT_OK;
    return rt_fail(
        error, RT_NOT_AVAILABLE,
        "this raytally was built without the explorer: npm was missing, or could not fetch three.js "
        "and esbuild. Install npm (Debian: apt-get install npm), connect to the network once, and "
        "build again; docs/components.md says more");
}

/* ---- what the page knows, as JSON ---- */

static json_t *vector_json(RtVec3 v) {
    return json_pack("[f, f, f]", (double)v.x, (double)v.y, (double)v.z);
}

static json_t *counters_json(void) {
    json_t *list = json_array();
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++)
        json_array_append_new(
            list, json_pack("{s:s, s:s}", "name", rt_tally_name(i), "meaning", rt_tally_meaning(i)));
    return list;
}

#define NAME(CONSTANT, name, ...) #name,
static const char *const kinds[] = {RT_RAY_KINDS(NAME)}, *const shapes[] = {RT_SHAPES(NAME)};

static json_t *names_json(const char *const *names, size_t count) {
    json_t *list = json_array();
    for (size_t i = 0; i < count; i++) json_array_append_new(list, json_string(names[i]));
    return list;
}

static json_t *scale_json(void) {
    json_t *list = json_array();
    for (int i = 0; i < SCALE_COLORS; i++) {
        RtColor c = rt_color_scale((double)i / (SCALE_COLORS - 1));
        json_array_append_new(list, json_pack("[i, i, i]", c.rgb[0], c.rgb[1], c.rgb[2]));
    }
    return list;
}

static json_t *scene_json(const RtScene *scene, const char *name, uint32_t every) {
    const RtCamera *camera = &scene->camera;
    json_t *materials = json_array(), *lights = json_array();
    for (uint32_t i = 0; i < scene->material_count; i++)
        json_array_append_new(materials, vector_json(scene->materials[i].color));
    for (uint32_t i = 0; i < scene->light_count; i++)
        json_array_append_new(lights, vector_json(scene->lights[i].position));
    return json_pack("{s:s, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:f, s:o}", "name", name, "objects",
                     (json_int_t)scene->geometry.object_count, "shown_every", (json_int_t)every, "lo",
                     vector_json(scene->geometry.box.lo), "hi", vector_json(scene->geometry.box.hi),
                     "materials", materials, "lights", lights, "from", vector_json(camera->from), "at",
                     vector_json(camera->at), "up", vector_json(camera->up), "fov", (double)camera->fov,
                     "shapes", names_json(shapes, RT_SHAPE_COUNT));
}

static json_t *accelerator_json(const RtRecordedPaths *paths, const RtExploredSpec *spec,
                                const RtShownBoxes *boxes) {
    const bool all = boxes->level == UINT32_MAX;
    return json_pack("{s:s, s:s, s:o, s:s?, s:I, s:I, s:o, s:o}", "accel", spec->text, "spec",
                     spec->parameters, "forms", rt_recorded_forms(paths), "boxes_of",
                     boxes->layer ? boxes->layer->ops->name : NULL, "boxes_shown", (json_int_t)boxes->shown,
                     "boxes", (json_int_t)boxes->all, "thinned_level",
                     all ? json_null() : json_integer(boxes->level), "thinned_every",
                     all || boxes->every == UINT32_MAX ? json_null() : json_integer(boxes->every));
}

/* Takes both references. */
static json_t *page_json(const RtScene *scene, const RtRecordedPixels *recording,
                         const RtExploreOptions *options, json_t *scene_data, json_t *accelerators) {
    const RtSampling *s = &scene->sampling;
    return json_pack("{s:b, s:i, s:i, s:i, s:i, s:i, s:I, s:I, s:i, s:i, s:i, s:o, s:o, s:o, s:o, s:o}",
                     "given", options->given != NULL, "width", (int)s->width, "height", (int)s->height,
                     "stride", (int)recording->stride, "columns", (int)recording->columns, "rows",
                     (int)recording->rows, "rays", (json_int_t)recording->ray_count, "cut",
                     (json_int_t)recording->cut_count, "cell_map", RT_CELL_MAP, "most_rows",
                     RT_MAX_RECORDED_ROWS, "depth", (int)options->depth, "counters", counters_json(), "kinds",
                     names_json(kinds, RT_RAY_KIND_COUNT), "scale", scale_json(), "scene", scene_data,
                     "accelerators", accelerators);
}

/* ---- the parts ---- */

/* Compresses and embeds the bytes, and frees them. */
static RtStatus embed(RtBytes *bytes, const char *name, FILE *out, RtError *error) {
    RtStatus status = rt_bytes_compress(bytes, error);
    if (status == RT_OK) rt_bytes_embed(bytes, name, out);
    rt_bytes_clear(bytes);
    return status;
}

static RtStatus embed_image(RtAccel *accel, uint32_t depth, FILE *out, RtError *error) {
    RtFrame frame;
    RtImage image;
    RtBytes bytes = {0};
    RT_TRY(rt_frame_trace(&frame, accel, &(RtFrameOptions){.depth = depth}, error));
    RtStatus status = rt_image_from_frame(&image, &frame, error);
    rt_frame_clear(&frame);
    RT_TRY(status);
    rt_bytes_put(&bytes, image.rgb, (size_t)image.width * image.height * 3);
    rt_image_clear(&image);
    return embed(&bytes, "image", out, error);
}

/* A byte each: the shape of object 0, 1, ... */
static RtStatus embed_shapes(const RtGeometry *g, FILE *out, RtError *error) {
    RtBytes bytes = {0};
    for (uint32_t i = 0; i < rt_geometry_id_count(g); i++)
        rt_bytes_put_number(&bytes, (uint64_t)rt_geometry_shape(g, i));
    return embed(&bytes, "shapes", out, error);
}

static RtStatus embed_accelerator(const RtRecordedPaths *paths, uint32_t number, RtShownBoxes *shown,
                                  FILE *out, RtError *error) {
    char name[32];
    RtBytes events = {0}, boxes = {0}, cells = {0};
    snprintf(name, sizeof name, "paths-%u", number);
    rt_bytes_embed(&paths->paths, name, out);
    rt_recorded_events(paths, &events);
    snprintf(name, sizeof name, "events-%u", number);
    RT_TRY(embed(&events, name, out, error));
    rt_explore_cells(paths->accel, &cells);
    snprintf(name, sizeof name, "cells-%u", number);
    RT_TRY(embed(&cells, name, out, error));
    *shown = rt_explore_boxes(paths->accel, &boxes);
    snprintf(name, sizeof name, "boxes-%u", number);
    return embed(&boxes, name, out, error);
}

static RtStatus write_page(FILE *out, const char *name, const RtRecordedPixels *recording,
                           const RtExploredSpec *specs, const RtExploreOptions *options, RtError *error) {
    const RtScene *whole = recording->of[0].accel->scene, *scene = whole;
    RT_OWNED(RtScene, copies, rt_scene_clear);
    /* Instances that cannot be copied, or are too many, are shown as boxes. */
    if (whole->geometry.instance_count > 0 && rt_geometry_id_count(&whole->geometry) <= MOST_COPIES &&
        rt_scene_flatten(whole, &copies, NULL) == RT_OK) {
        copies.sampling = whole->sampling;
        scene = &copies;
    }
    json_t *accelerators = json_array();
    RtBytes objects = {0};
    RtStatus status = RT_OK;
    char title[RT_MAX_SCENE_NAME + 16];
    snprintf(title, sizeof title, "Explorer: %s", name);
    rt_page_begin(out, title, false);
    fputs("<style>\n", out);
    rt_page_lines(out, explore_css);
    fputs("</style>\n", out);
    rt_page_lines(out, explore_html);
    for (uint32_t i = 0; i < recording->count && status == RT_OK; i++) {
        RtShownBoxes shown;
        status = embed_accelerator(&recording->of[i], i, &shown, out, error);
        if (status == RT_OK)
            json_array_append_new(accelerators, accelerator_json(&recording->of[i], &specs[i], &shown));
    }
    uint32_t every = rt_explore_objects(scene, &objects);
    if (status == RT_OK)
        status = rt_page_data(
            page_json(scene, recording, options, scene_json(scene, name, every), accelerators), out, error);
    else
        json_decref(accelerators);
    rt_bytes_embed(&recording->rays, "rays", out);
    if (status == RT_OK) status = embed_image(recording->of[0].accel, options->depth, out, error);
    if (status == RT_OK) status = embed_shapes(&whole->geometry, out, error);
    if (status == RT_OK) status = embed(&objects, "objects", out, error);
    rt_bytes_clear(&objects);
    fputs("</main>\n<script type=\"module\">\n", out);
    rt_page_lines(out, explore_js);
    fputs("</script></body></html>\n", out);
    return status;
}

RtStatus rt_explore_write(const char *path, const char *name, RtAccel *const *accels,
                          const RtExploredSpec *specs, uint32_t count, const RtExploreOptions *options,
                          uint32_t *stride, RtError *error) {
    RtRecordedPixels recording;
    RtOutput output;
    RT_TRY(rt_explore_available(error));
    if (rt_geometry_id_count(&accels[0]->scene->geometry) > MOST_IDS) /* a byte each, before compression */
        return rt_fail(error, RT_BAD_INPUT, "a page holds at most %d objects, with copies", MOST_IDS);
    RT_TRY(rt_output_open(&output, path, error));
    RtStatus status = rt_recorded_pixels_make(&recording, accels, count, options, error);
    if (status == RT_OK) {
        *stride = recording.stride;
        status = write_page(output.file, name, &recording, specs, options, error);
        rt_recorded_pixels_clear(&recording);
    }
    if (status == RT_OK) return rt_output_commit(&output, error);
    rt_output_discard(&output);
    return status;
}
