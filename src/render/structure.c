/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes are drawn in the homogeneous coordinates of the view: (x, y, w) with w the distance along the axis
 * and the image -w <= x, y <= w, in which the near plane and the four sides of the view are planes to clip
 * with alike. */
#include "render/structure.h"

#include "base/clamp.h"
#include "base/elementary.h"
#include "base/transform.h"
#include "render/draw.h"
#include "render/net.h"
#include "render/section.h"

#include <stdio.h>
#include <string.h>

enum { MARGIN = 6, LINE = 11 }; /* of the legend, dots */

typedef struct Drawing {
    RtImage *image;
    const RtFrame *frame;
    const RtAccel *layer;
    const RtStructureOptions *options;
    double width, height; /* of what is drawn on: the image without its legend */
    RtView view;
    double near;
    uint32_t first, last; /* levels that are drawn */
    uint32_t level;       /* the one that is being drawn */
    RtColor color;        /* of the box that is */
    double opacity;
    RtExtentKind kind;   /* of what is drawn */
    uint64_t drawn, all; /* boxes */
    double least, most;  /* their sizes: lengths of diagonals, but for points */
    int across, up;      /* of a section: axes of the image */
    double left, top, scale;
} Drawing;

/* ---- which boxes ---- */

static bool is_asked_for(const Drawing *d, const RtBoxView *view) {
    const RtStructureOptions *o = d->options;
    const RtBox *box = view->box;
    RtVec3d corners[RT_NET_CORNERS];
    if (rt_box_is_empty(*box) || view->depth < o->first_level || view->depth > o->last_level ||
        (o->leaves && !view->leaf))
        return false;
    if (!o->slice) return true;
    if (rt_net_is_other(view)) return rt_net_section(view, o->axis, o->at, corners) > 0;
    return (double)box->lo.at[o->axis] <= o->at && o->at <= (double)box->hi.at[o->axis];
}

static double size_of(const RtBox *box) {
    return rt_lengthd(rt_subd(rt_widen(box->hi), rt_widen(box->lo)));
}

static void count_box(void *context, const RtBoxView *view) {
    Drawing *d = context;
    d->all++;
    if (!is_asked_for(d, view)) return;
    if (d->drawn++ == 0) d->first = d->last = view->depth;
    if (view->depth < d->first) d->first = view->depth;
    if (view->depth > d->last) d->last = view->depth;
    if (rt_net_is_other(view)) d->kind = view->extents->kind;
    double size = size_of(view->box);
    if (size > 0 && (d->most == 0 || size < d->least)) d->least = size;
    d->most = fmax(d->most, size);
}

static RtColor color_of_level(const Drawing *d, uint32_t depth) {
    double deep = d->last > d->first ? (double)(depth - d->first) / (d->last - d->first) : 0;
    return rt_color_scale(1 - 0.7 * deep);
}

/* Where levels tell nothing. */
static bool is_by_size(const Drawing *d) {
    return d->first == d->last && d->most > 1.5 * d->least;
}

static RtColor color_of_size(const Drawing *d, double size) {
    double small = rt_log(d->most / fmax(fmin(size, d->most), d->least)) / rt_log(d->most / d->least);
    return rt_color_scale(1 - 0.7 * small);
}

static RtColor color_of(const Drawing *d, const RtBoxView *view) {
    return is_by_size(d) ? color_of_size(d, size_of(view->box)) : color_of_level(d, view->depth);
}

/* ---- in perspective ---- */

static RtVec3d project(const RtView *view, RtVec3d point) {
    RtVec3d p = rt_subd(point, view->eye);
    return rt_vec3d(rt_dotd(p, view->right) / rt_dotd(view->right, view->right),
                    rt_dotd(p, view->down) / rt_dotd(view->down, view->down), rt_dotd(p, view->forward));
}

/* Distance of `p` to side `plane` of the visible space, negative outside. */
static double inside(const Drawing *drawing, RtVec3d p, int plane) {
    switch (plane) {
    case 0: return p.z - drawing->near;
    case 1: return p.z - p.x;
    case 2: return p.z + p.x;
    case 3: return p.z - p.y;
    default: return p.z + p.y;
    }
}

/* Cuts the segment to what is visible; false if nothing is. */
static bool clip(const Drawing *drawing, RtVec3d *a, RtVec3d *b) {
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
static bool is_hidden(const Drawing *d, int x, int y, double w) {
    const RtSampling *s = &d->frame->sampling;
    if (x < 0 || y < 0 || (uint32_t)x >= s->width || (uint32_t)y >= s->height) return true;
    RtFootprint f = rt_pixel_footprint(s, (uint32_t)x, (uint32_t)y);
    size_t sample = (size_t)(f.row + f.span / 2) * s->columns + f.column + f.span / 2;
    return w > (double)d->frame->depth[sample] * (1 + 1e-4);
}

/* 1 / w is linear along the line on the image. */
static void draw_edge(void *context, RtVec3d from, RtVec3d to) {
    const Drawing *d = context;
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
    Drawing *d = context;
    if (view->depth != d->level || !is_asked_for(d, view)) return;
    d->opacity = d->options->leaves ? 1 : fmax(0.25, 1 / (1 + 0.15 * (view->depth - d->first)));
    d->color = color_of(d, view);
    rt_net_lines(view, d->view.eye, (RtLineViewer){draw_edge, d});
}

static RtStatus draw_perspective(Drawing *d, RtError *error) {
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

/* ---- a section ---- */

static double x_of(const Drawing *d, double at) {
    return (at - d->left) * d->scale;
}

static double y_of(const Drawing *d, double at) {
    return (d->top - at) * d->scale;
}

static void fill_rectangle(const Drawing *d, const RtBox *box, RtColor color, double opacity) {
    double from = rt_clampd(x_of(d, (double)box->lo.at[d->across]), 0, d->width);
    double to = rt_clampd(x_of(d, (double)box->hi.at[d->across]), -1, d->width - 1);
    double top = rt_clampd(y_of(d, (double)box->hi.at[d->up]), 0, d->height);
    double bottom = rt_clampd(y_of(d, (double)box->lo.at[d->up]), -1, d->height - 1);
    for (int y = (int)top; y <= (int)bottom; y++) {
        for (int x = (int)from; x <= (int)to; x++) {
            bool edge = x == (int)from || x == (int)to || y == (int)top || y == (int)bottom;
            rt_draw_pixel(d->image, x, y, color, edge ? 0.9 : opacity);
        }
    }
}

/* Of a line what is over the section, whose last row and column end just before d->height and d->width. */
static void line_between(const Drawing *d, double x0, double y0, double x1, double y1, RtColor color) {
    double a[2] = {x0, y0}, b[2] = {x1, y1}, hi[2] = {d->width - 1e-6, d->height - 1e-6};
    if (rt_section_clip(a, b, (double[2]){0, 0}, hi))
        rt_draw_line(d->image, a[0], a[1], b[0], b[1], color, 0.8);
}

/* Row by row, from the edge on the left to the edge on the right. */
static void fill_section(const Drawing *d, const RtVec3d *corners, uint32_t count, RtColor color,
                         double opacity) {
    for (int y = 0; y < (int)d->height; y++) {
        double from = d->width, to = -1, row = y + 0.5;
        for (uint32_t i = 0; i < count; i++) {
            RtVec3d a = corners[i], b = corners[(i + 1) % count];
            double ya = y_of(d, a.at[d->up]), yb = y_of(d, b.at[d->up]);
            if ((ya < row) == (yb < row)) continue;
            double xa = x_of(d, a.at[d->across]), xb = x_of(d, b.at[d->across]);
            double x = xa + (xb - xa) * (row - ya) / (yb - ya);
            from = fmin(from, x), to = fmax(to, x);
        }
        int last = (int)rt_clampd(to, -1, d->width - 1);
        for (int x = (int)rt_clampd(from, 0, d->width); x <= last; x++)
            rt_draw_pixel(d->image, x, y, color, opacity);
    }
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d a = corners[i], b = corners[(i + 1) % count];
        line_between(d, x_of(d, a.at[d->across]), y_of(d, a.at[d->up]), x_of(d, b.at[d->across]),
                     y_of(d, b.at[d->up]), color);
    }
}

static void fill_box(void *context, const RtBoxView *view) {
    const Drawing *d = context;
    RtVec3d corners[RT_NET_CORNERS];
    if (!is_asked_for(d, view)) return;
    RtColor color = color_of(d, view);
    double opacity = view->leaf ? 0.18 : 0.05;
    if (rt_net_is_other(view))
        fill_section(d, corners, rt_net_section(view, d->options->axis, d->options->at, corners), color,
                     opacity);
    else
        fill_rectangle(d, view->box, color, opacity);
}

static void outline_sphere(const Drawing *d, const RtSphere *sphere) {
    enum { SIDES = 48 };
    double off = (double)sphere->center.at[d->options->axis] - d->options->at, r = (double)sphere->radius;
    if (fabs(off) >= r) return;
    double around = sqrt(r * r - off * off) * d->scale, x = x_of(d, (double)sphere->center.at[d->across]);
    double y = y_of(d, (double)sphere->center.at[d->up]);
    RtTurn from = rt_turn(0);
    for (int i = 1; i <= SIDES; i++) {
        RtTurn to = rt_turn(360.0 * i / SIDES);
        line_between(d, x + around * from.cosine, y + around * from.sine, x + around * to.cosine,
                     y + around * to.sine, RT_WHITE);
        from = to;
    }
}

static void outline_flat(const Drawing *d, const RtVec3 *corners, uint32_t count) {
    RtVec3d on = {{0, 0, 0}}, normal = {{0, 0, 0}}, cut[2];
    on.at[d->options->axis] = d->options->at;
    normal.at[d->options->axis] = 1;
    if (!rt_section_flat(corners, count, on, normal, cut)) return;
    line_between(d, x_of(d, cut[0].at[d->across]), y_of(d, cut[0].at[d->up]), x_of(d, cut[1].at[d->across]),
                 y_of(d, cut[1].at[d->up]), RT_WHITE);
}

/* As much as the camera sees at its aim, or all that there is. */
static void choose_window(Drawing *d) {
    const RtBox *box = &d->layer->scene->geometry.box;
    const RtCamera *camera = &d->layer->scene->camera;
    RtVec3d size = rt_subd(rt_widen(box->hi), rt_widen(box->lo)), center = rt_widen(rt_box_center(*box));
    double distance = rt_lengthd(rt_subd(rt_widen(camera->at), rt_widen(camera->from)));
    RtTurn half = rt_turn((double)camera->fov / 2);
    double seen = d->height / (2 * distance * half.sine / half.cosine);
    d->scale =
        0.96 * fmin(d->width / fmax(size.at[d->across], 1e-30), d->height / fmax(size.at[d->up], 1e-30));
    if (seen > d->scale) d->scale = seen, center = rt_widen(camera->at);
    d->left = center.at[d->across] - d->width / 2 / d->scale;
    d->top = center.at[d->up] + d->height / 2 / d->scale;
}

static void draw_section(Drawing *d) {
    const RtGeometry *g = &d->layer->scene->geometry;
    RtVec3 up = d->layer->scene->camera.up;
    up.at[d->options->axis] = 0;
    d->up = rt_major_axis(up) != d->options->axis ? rt_major_axis(up) : (d->options->axis + 1) % 3;
    d->across = 3 - d->up - d->options->axis;
    choose_window(d);
    rt_draw_rectangle(d->image, 0, 0, (int)d->width, (int)d->height, (RtColor){{20, 20, 24}});
    d->layer->ops->each_box(d->layer, (RtBoxViewer){fill_box, d});
    for (uint32_t i = 0; i < g->sphere_count; i++) outline_sphere(d, &g->spheres[i]);
    for (uint32_t i = 0; i < g->triangle_count; i++) outline_flat(d, g->triangles[i].v, 3);
    for (uint32_t i = 0; i < g->polygon_count; i++)
        outline_flat(d, g->polygon_vertices + g->polygons[i].first, g->polygons[i].count);
}

/* ---- the legend ---- */

static int legend_height(uint32_t width) {
    return (2 * MARGIN + 3 * LINE) * rt_text_dot(width);
}

/* Squares with the colours of levels, every nth if they are many, or of sizes. */
static void draw_colors(const Drawing *d, int x, int y, int dot) {
    enum { MOST = 7, SIZES = 5 };
    bool by_size = is_by_size(d);
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
        RtColor color = by_size ? color_of_size(d, size) : color_of_level(d, level);
        rt_draw_rectangle(d->image, x, y, RT_TEXT_HEIGHT * dot, RT_TEXT_HEIGHT * dot, color);
        x += (RT_TEXT_HEIGHT + 2) * dot;
        rt_draw_text(d->image, x, y, dot, text, RT_WHITE);
        x += (rt_text_width(text) + MARGIN) * dot;
    }
}

static void draw_legend(const Drawing *d) {
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
    Drawing d = {.image = image,
                 .frame = frame,
                 .layer = layer,
                 .options = options,
                 .width = frame->sampling.width,
                 .height = frame->sampling.height};
    const RtCamera *camera = &layer->scene->camera;
    layer->ops->each_box(layer, (RtBoxViewer){count_box, &d});
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
        draw_section(&d);
    else
        status = draw_perspective(&d, error);
    if (status == RT_OK) draw_legend(&d);
    if (status != RT_OK) rt_image_clear(image);
    return status;
}
