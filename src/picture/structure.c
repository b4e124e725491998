/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes are drawn in the homogeneous coordinates of the view: (x, y, w) with w the distance along the axis
 * and the image -w <= x, y <= w, in which the near plane and the four sides of the view are planes to clip
 * with alike. */
#include "picture/structure.h"

#include "core/base/elementary.h"
#include "picture/net.h"
#include "picture/structure_parts.h"

#include <stdio.h>
#include <string.h>

enum { MARGIN = 6, LINE = 11 }; /* of the legend, dots */

/* ---- in perspective ---- */

static RtVec3d project(const RtView *view, RtVec3d point) {
    RtVec3d p = rt_subd(point, view->eye);
    return rt_vec3d(rt_dotd(p, view->right) / rt_dotd(view->right, view->right),
                    rt_dotd(p, view->down) / rt_dotd(view->down, view->down), rt_dotd(p, view->forward));
}

/* Distance of `p` to side `plane` of the visible space, negative outside. */
static double inside(const RtStructureDrawing *drawing, RtVec3d p, int plane) {
    switch (plane) {
    case 0: return p.z - drawing->near;
    case 1: return p.z - p.x;
    case 2: return p.z + p.x;
    case 3: return p.z - p.y;
    default: return p.z + p.y;
    }
}

/* Cuts the segment to what is visible; false if nothing is. */
static bool clip(const RtStructureDrawing *drawing, RtVec3d *a, RtVec3d *b) {
    for (int plane = 0; plane < 5; plane++) {
        double at_a = inside(drawing, *a, plane), at_b = inside(drawing, *b, plane);
        if (at_a < 0 && at_b < 0) return false;
        if (at_a >= 0 && at_b >= 0) continue;
        RtVec3d cut = rt_add_scaledd(*a, rt_subd(*b, *a), at_a / (at_a - at_b));
        *(at_a < 0 ? a : b) = cut;
    }
    return a->z > 0 && b->z > 0;
}

/* Is a point at depth `w` behind what the frame sees in a pixel? */
static bool is_hidden(const RtStructureDrawing *d, int x, int y, double w) {
    const RtSampling *s = &d->frame->sampling;
    if (x < 0 || y < 0 || (uint32_t)x >= s->width || (uint32_t)y >= s->height) return true;
    RtFootprint f = rt_pixel_footprint(s, (uint32_t)x, (uint32_t)y);
    size_t sample = (size_t)(f.row + f.span / 2) * s->columns + f.column + f.span / 2;
    return w > (double)d->frame->depth[sample] * (1 + 1e-4);
}

/* 1 / w is linear along the line on the image. */
static void draw_edge(void *context, RtVec3d from, RtVec3d to) {
    const RtStructureDrawing *d = context;
    RtVec3d a = project(&d->view, from), b = project(&d->view, to);
    if (!clip(d, &a, &b)) return;
    double x0 = (a.x / a.z + 1) / 2 * d->width, y0 = (a.y / a.z + 1) / 2 * d->height;
    double dx = (b.x / b.z + 1) / 2 * d->width - x0, dy = (b.y / b.z + 1) / 2 * d->height - y0;
    int steps = (int)ceil(fmax(fabs(dx), fabs(dy)));
    for (int i = 0; i <= steps; i++) {
        double at = steps ? (double)i / steps : 0;
        int x = (int)floor(x0 + at * dx), y = (int)floor(y0 + at * dy);
        double w = 1 / ((1 - at) / a.z + at / b.z);
        if (x < (int)d->width && y < (int)d->height)
            rt_draw_pixel(d->image, x, y, d->color, is_hidden(d, x, y, w) ? 0.06 * d->opacity : d->opacity);
    }
}

static void draw_box(void *context, const RtBoxView *view) {
    RtStructureDrawing *d = context;
    if (view->depth != d->level || !rt_structure_shows(d, view)) return;
    d->opacity = d->options->leaves ? 1 : fmax(0.25, 1 / (1 + 0.15 * (view->depth - d->first)));
    d->color = rt_structure_color(d, view);
    rt_net_lines(view, d->view.eye, (RtLineViewer){draw_edge, d});
}

static RtStatus draw_perspective(RtStructureDrawing *d, RtError *error) {
    const RtCamera *camera = &d->layer->scene->camera;
    RtSampling sampling;
    RT_TRY(rt_sampling_init(&sampling, (uint32_t)d->width, (uint32_t)d->height, 1, false, error));
    RT_TRY(rt_view_init(&d->view, camera, sampling, error));
    double distance = rt_lengthd(rt_subd(rt_widen(camera->at), d->view.eye));
    d->near = fmax(d->view.near, 1e-3 * distance);
    for (uint32_t y = 0; y < (uint32_t)d->height; y++) {
        uint8_t *row = d->image->rgb + (size_t)3 * y * d->image->width;
        for (size_t i = 0; i < (size_t)3 * (uint32_t)d->width; i++) row[i] = (uint8_t)(row[i] * 2 / 5);
    }
    /* The large boxes come last, over the small ones that share their edges. */
    for (d->level = d->last + 1; d->level-- > d->first;)
        d->layer->ops->each_box(d->layer, (RtBoxViewer){draw_box, d});
    return RT_OK;
}

/* ---- the legend ---- */

static int legend_height(uint32_t width) {
    return (2 * MARGIN + 3 * LINE) * rt_text_dot(width);
}

/* Squares with the colours of levels, every nth if they are many, or of sizes. */
static void draw_colors(const RtStructureDrawing *d, int x, int y, int dot) {
    enum { MOST = 7, SIZES = 5 };
    bool by_size = rt_structure_is_by_size(d);
    uint32_t levels = d->last - d->first + 1, count = by_size ? SIZES : levels < MOST ? levels : MOST;
    const char *what = by_size ? "size" : "level";
    rt_draw_text(d->image, x, y, dot, what, RT_WHITE);
    x += (rt_text_width(what) + MARGIN) * dot;
    for (uint32_t i = 0; i < count; i++) {
        double at = count > 1 ? (double)i / (count - 1) : 0, size = d->most;
        uint32_t level = d->first + (uint32_t)(at * (levels - 1) + 0.5);
        for (uint32_t k = 0; by_size && k < i; k++) size *= rt_power(d->least / d->most, 1.0 / (count - 1));
        char text[32];
        if (by_size)
            snprintf(text, sizeof text, "%.2g", size);
        else
            snprintf(text, sizeof text, "%u", level);
        RtColor color = by_size ? rt_structure_size_color(d, size) : rt_structure_level_color(d, level);
        rt_draw_rectangle(d->image, x, y, RT_TEXT_HEIGHT * dot, RT_TEXT_HEIGHT * dot, color);
        x += (RT_TEXT_HEIGHT + 2) * dot;
        rt_draw_text(d->image, x, y, dot, text, RT_WHITE);
        x += (rt_text_width(text) + MARGIN) * dot;
    }
}

static void draw_legend(const RtStructureDrawing *d) {
    static const char axes[] = "xyz";
    static const char *const names[RT_EXTENT_KIND_COUNT] = {"boxes", "spheres", "oriented boxes",
                                                            "bodies of slabs"};
    int dot = rt_text_dot(d->image->width), left = MARGIN * dot, y = (int)d->height + MARGIN * dot;
    char text[128];
    rt_draw_rectangle(d->image, 0, (int)d->height, (int)d->image->width, legend_height(d->image->width),
                      RT_BLACK);
    if (d->options->slice)
        snprintf(text, sizeof text, "%s  section %c=%.4g, %c up", d->layer->ops->name, axes[d->options->axis],
                 d->options->at, axes[d->up]);
    else
        snprintf(text, sizeof text, "%s", d->layer->ops->name);
    rt_draw_text(d->image, left, y, dot, text, RT_WHITE);
    snprintf(text, sizeof text, "%llu of %llu %s%s", (unsigned long long)d->drawn, (unsigned long long)d->all,
             names[d->kind], d->options->leaves ? ": leaves" : "");
    rt_draw_text(d->image, left, y + LINE * dot, dot, text, RT_WHITE);
    draw_colors(d, left, y + 2 * LINE * dot, dot);
}

/* ---- from outside ---- */

static bool has_picture(const RtAccelOps *ops) {
    return ops->each_box || ops->look_up;
}

static RtStatus refuse(const RtAccelOps *ops, RtError *error) {
    return rt_fail(
        error, RT_NOT_AVAILABLE,
        "there is no picture of %s, which has neither boxes nor cells: choose another, such as bvh or grid",
        ops->name);
}

/* Is this layer the one? `last`: there is none below. */
static RtStatus choose(const RtAccelOps *ops, const char *name, bool last, bool *chosen, RtError *error) {
    *chosen = name ? strcmp(ops->name, name) == 0 : has_picture(ops);
    if (*chosen && !has_picture(ops)) return refuse(ops, error);
    if (*chosen || !last) return RT_OK;
    return name ? rt_fail(error, RT_BAD_INPUT, "there is no layer '%s' in this accelerator", name)
                : refuse(ops, error);
}

RtStatus rt_structure_layer(const RtAccel *accel, const char *name, const RtAccel **layer, RtError *error) {
    bool chosen = false;
    for (; accel && !chosen; accel = accel->below) {
        RT_TRY(choose(accel->ops, name, !accel->below, &chosen, error));
        if (chosen) *layer = accel;
    }
    return RT_OK;
}

RtStatus rt_structure_available(const RtSpec *spec, const char *name, RtError *error) {
    bool chosen = false;
    for (uint32_t i = 0; i < spec->layer_count && !chosen; i++)
        RT_TRY(choose(spec->layers[i].ops, name, i + 1 == spec->layer_count, &chosen, error));
    return RT_OK;
}

/* The frame's picture, above room for the legend. */
static RtStatus make_image(RtImage *image, const RtFrame *frame, RtError *error) {
    RtImage picture;
    uint32_t width = frame->sampling.width, height = frame->sampling.height;
    RT_TRY(rt_image_from_frame(&picture, frame, error));
    RtStatus status =
        rt_image_init(image, width > 240 ? width : 240, height + (uint32_t)legend_height(width), error);
    for (uint32_t y = 0; status == RT_OK && y < height; y++)
        memcpy(image->rgb + (size_t)3 * y * image->width, picture.rgb + (size_t)3 * y * width,
               (size_t)3 * width);
    rt_image_clear(&picture);
    return status;
}

RtStatus rt_structure_image(RtImage *image, const RtAccel *layer, const RtFrame *frame,
                            const RtStructureOptions *options, RtError *error) {
    RtStructureDrawing d = {.image = image,
                            .frame = frame,
                            .layer = layer,
                            .options = options,
                            .width = frame->sampling.width,
                            .height = frame->sampling.height};
    const RtCamera *camera = &layer->scene->camera;
    layer->ops->each_box(layer, (RtBoxViewer){rt_structure_count, &d});
    RT_TRY(rt_accel_check(layer, error));
    /* The floor, which is larger than all that is seen, does not set the scale. */
    d.most =
        fmax(d.least, fmin(d.most, 2 * rt_lengthd(rt_subd(rt_widen(camera->at), rt_widen(camera->from)))));
    if (d.drawn == 0 && layer->scene->geometry.object_count > 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "none of the %llu boxes of %s is on the levels, or in the slice, that are asked for",
                       (unsigned long long)d.all, layer->ops->name);
    RT_TRY(make_image(image, frame, error));
    RtStatus status = RT_OK;
    if (options->slice)
        rt_structure_draw_section(&d);
    else
        status = draw_perspective(&d, error);
    if (status == RT_OK) status = rt_accel_check(layer, error);
    if (status == RT_OK) draw_legend(&d);
    if (status != RT_OK) rt_image_clear(image);
    return status;
}
