/* SPDX-License-Identifier: Apache-2.0 */
/* In perspective, boxes are drawn in homogeneous view coordinates: (x, y, w) with w the distance along the
 * axis and -w <= x, y <= w inside the image, so that the near plane and the sides of the view clip alike.
 * In section, boxes and objects are cut by a plane.
 *
 * In perspective, boxes of the structures of parts are drawn in each instance, as the instance distorts them,
 * unless they are too many; their levels are those of their own structure. */
#include "picture/pictures.h"

#include "core/base/elementary.h"
#include "core/base/memory.h"
#include "picture/section.h"

#include <stdio.h>
#include <string.h>

enum { LEAST_WIDTH = 300, LINES = 3 }; /* of the legend */
enum { MOST_IN_PARTS = 200000 };       /* boxes in instances */

static const RtColor object_color = {{130, 130, 130}};

typedef struct Drawing {
    cairo_t *cairo;
    const RtFrame *frame;
    const RtAccel *layer;
    const RtStructureOptions *options;
    double width, height; /* of the picture without its legend */
    double em;            /* the font size */
    RtView view;
    double near;
    RtSection section;    /* the slice */
    int across, up;       /* its axes */
    uint32_t first, last; /* range of drawn levels */
    uint32_t level;       /* current level */
    bool hidden;          /* draw hidden or visible edges */
    bool parts;           /* those of parts are drawn, too */
    uint64_t most_boxes;  /* with those, if so */
    RtTransform to_world; /* of the boxes being drawn */
    RtVec3d eye;          /* the eye among them */
    RtExtentKind kind;    /* of what is drawn */
    uint64_t drawn, all;  /* boxes */
    double least, most;   /* their sizes: lengths of diagonals, points left out */
} Drawing;

/* ---- which boxes, in which lines ---- */

static bool is_empty_leaf(const Drawing *d, const RtBoxView *view) {
    return d->layer->ops->shows_lists && view->leaf && view->objects == 0;
}

/* Empty leaves would hide what is behind them; in a section they hide nothing. */
static bool is_left_out(const Drawing *d, const RtBoxView *view) {
    return is_empty_leaf(d, view) && (!d->options->slice || d->options->leaves);
}

static bool is_shown(const Drawing *d, const RtBoxView *view) {
    const RtStructureOptions *o = d->options;
    if (rt_box_is_empty(*view->box) || view->depth < o->first_level || view->depth > o->last_level ||
        (o->leaves && !view->leaf) || is_left_out(d, view))
        return false;
    return !o->slice || rt_section_add_extent(&d->section, NULL, view);
}

static double size_of(const RtBox *box) {
    return rt_lengthd(rt_subd(rt_widen(box->hi), rt_widen(box->lo)));
}

static void count_box(void *context, const RtBoxView *view) {
    Drawing *d = context;
    d->all += !is_left_out(d, view);
    if (!is_shown(d, view)) return;
    if (d->drawn++ == 0) d->first = d->last = view->depth;
    if (view->depth < d->first) d->first = view->depth;
    if (view->depth > d->last) d->last = view->depth;
    if (rt_outline_kind(view) != RT_EXTENT_BOX) d->kind = rt_outline_kind(view);
    double size = size_of(view->box);
    if (size > 0 && (d->most == 0 || size < d->least)) d->least = size;
    d->most = fmax(d->most, size);
}

/* If all boxes are on one level, lines show sizes. */
static bool is_by_size(const Drawing *d) {
    return d->first == d->last && d->most > 1.5 * d->least;
}

/* The place of a level, or of a size, between the first, 0, and the last, 1. */
static double place_of_level(const Drawing *d, uint32_t level) {
    return d->last > d->first ? (double)(level - d->first) / (d->last - d->first) : 0;
}

static double place_of_box(const Drawing *d, const RtBoxView *view) {
    if (!is_by_size(d)) return place_of_level(d, view->depth);
    return rt_log(d->most / fmax(fmin(size_of(view->box), d->most), d->least)) / rt_log(d->most / d->least);
}

/* Dark and thick at 0, lighter and thinner towards 1. */
static void set_line(const Drawing *d, double place, double opacity) {
    rt_set_color(d->cairo, rt_color_scale(0.7 * place), opacity);
    cairo_set_line_width(d->cairo, 2 - 1.2 * place);
}

/* ---- boxes in instances ---- */

static void show_parts(Drawing *d, const RtGeometry *g, void (*show)(void *, const RtBoxView *)) {
    const RtTransform outside = d->to_world;
    const RtVec3d eye = d->eye;
    for (uint32_t i = 0; i < g->instance_count && d->all <= d->most_boxes; i++) {
        const RtInstance *instance = &g->instances[i];
        const RtAccel *part = d->layer->parts[instance->part];
        d->to_world = rt_transform_compose(&instance->to_world, &outside);
        for (int row = 0; row < 3; row++)
            d->eye.at[row] = instance->columns[0][row] * eye.x + instance->columns[1][row] * eye.y +
                             instance->columns[2][row] * eye.z + instance->columns[3][row];
        part->ops->each_box(part, (RtBoxViewer){show, d});
        show_parts(d, instance->geometry, show);
    }
    d->to_world = outside;
    d->eye = eye;
}

static void each_box(Drawing *d, void (*show)(void *, const RtBoxView *)) {
    d->to_world = rt_transform_identity();
    d->eye = d->view.eye;
    d->layer->ops->each_box(d->layer, (RtBoxViewer){show, d});
    if (d->parts) show_parts(d, &d->layer->scene->geometry, show);
}

/* ---- in perspective ---- */

static RtVec3d project(const RtView *view, RtVec3d point) {
    RtVec3d p = rt_subd(point, view->eye);
    return rt_vec3d(rt_dotd(p, view->right) / rt_dotd(view->right, view->right),
                    rt_dotd(p, view->down) / rt_dotd(view->down, view->down), rt_dotd(p, view->forward));
}

/* Distance of `p` to side `plane` of the view frustum, negative outside. */
static double inside(const Drawing *d, RtVec3d p, int plane) {
    switch (plane) {
    case 0: return p.z - d->near;
    case 1: return p.z - p.x;
    case 2: return p.z + p.x;
    case 3: return p.z - p.y;
    default: return p.z + p.y;
    }
}

static bool clip(const Drawing *d, RtVec3d *a, RtVec3d *b) {
    for (int plane = 0; plane < 5; plane++) {
        double at_a = inside(d, *a, plane), at_b = inside(d, *b, plane);
        if (at_a < 0 && at_b < 0) return false;
        if (at_a >= 0 && at_b >= 0) continue;
        RtVec3d cut = rt_add_scaledd(*a, rt_subd(*b, *a), at_a / (at_a - at_b));
        *(at_a < 0 ? a : b) = cut;
    }
    return a->z > 0 && b->z > 0;
}

static size_t sample_of(const Drawing *d, uint32_t x, uint32_t y) {
    RtFootprint f = rt_pixel_footprint(&d->frame->sampling, x, y);
    return (size_t)(f.row + f.span / 2) * d->frame->sampling.columns + f.column + f.span / 2;
}

/* Is a point at depth `w` behind the surface that the frame shows there? */
static bool is_hidden(const Drawing *d, double x, double y, double w) {
    size_t sample = sample_of(d, (uint32_t)fmin(x, d->width - 1), (uint32_t)fmin(y, d->height - 1));
    return w > (double)d->frame->depth[sample] * (1 + 2e-3);
}

/* Walks along the line pixel by pixel and adds its hidden or visible parts to the path. 1 / w is linear
 * along it. */
static void add_edge(void *context, RtVec3d from, RtVec3d to) {
    const Drawing *d = context;
    RtVec3d a = project(&d->view, rt_transform_pointd(&d->to_world, from)),
            b = project(&d->view, rt_transform_pointd(&d->to_world, to));
    if (!clip(d, &a, &b)) return;
    double x = (a.x / a.z + 1) / 2 * d->width, y = (a.y / a.z + 1) / 2 * d->height;
    double dx = (b.x / b.z + 1) / 2 * d->width - x, dy = (b.y / b.z + 1) / 2 * d->height - y;
    int steps = (int)fmax(ceil(fmax(fabs(dx), fabs(dy))), 1);
    bool hidden = is_hidden(d, x, y, a.z);
    cairo_move_to(d->cairo, x, y);
    for (int i = 1; i <= steps; i++) {
        double at = (double)i / steps;
        bool next = is_hidden(d, x + at * dx, y + at * dy, 1 / ((1 - at) / a.z + at / b.z));
        if (next == hidden && i < steps) continue;
        (hidden == d->hidden ? cairo_line_to : cairo_move_to)(d->cairo, x + at * dx, y + at * dy);
        hidden = next;
    }
}

static void draw_box(void *context, const RtBoxView *view) {
    Drawing *d = context;
    if (view->depth != d->level || !is_shown(d, view)) return;
    for (int pass = 0; pass < 2; pass++) {
        d->hidden = pass == 0;
        rt_outline_edges(view, d->eye, (RtLineViewer){add_edge, d});
        set_line(d, place_of_box(d, view), d->hidden ? 0.12 : 1);
        cairo_stroke(d->cairo);
    }
}

static RtColor pale_color(const void *drawing, uint32_t x, uint32_t y) {
    const Drawing *d = drawing;
    const RtVec3 seen = rt_frame_pixel(d->frame, x, y);
    RtColor color = RT_WHITE;
    if (d->frame->object[sample_of(d, x, y)] == RT_NO_OBJECT) return color;
    for (int c = 0; c < 3; c++) color.rgb[c] = (uint8_t)(255 - (255 - rt_srgb(seen.at[c])) * 2 / 5);
    return color;
}

static RtStatus draw_perspective(Drawing *d, RtError *error) {
    const RtCamera *camera = &d->layer->scene->camera;
    RtSampling sampling;
    RT_TRY(rt_sampling_init(&sampling, (uint32_t)d->width, (uint32_t)d->height, 1, false, error));
    RT_TRY(rt_view_init(&d->view, camera, sampling, error));
    const RtPixels image = {(uint32_t)d->width, (uint32_t)d->height, pale_color, d};
    RtStatus status = rt_paint_pixels(d->cairo, image, 0, 0, error);
    d->near = fmax(d->view.near, 1e-3 * rt_lengthd(rt_subd(rt_widen(camera->at), d->view.eye)));
    /* Small boxes are drawn last, in the middle of the thick lines of large ones that share their edges. */
    for (d->level = d->first; status == RT_OK && d->level <= d->last; d->level++) each_box(d, draw_box);
    return status;
}

/* ---- in section ---- */

static void fill_box(void *context, const RtBoxView *view) {
    const Drawing *d = context;
    if (!is_shown(d, view)) return;
    rt_section_add_extent(&d->section, d->cairo, view);
    if (view->leaf && !is_empty_leaf(d, view)) {
        set_line(d, place_of_box(d, view), 0.12);
        cairo_fill_preserve(d->cairo);
    }
    set_line(d, place_of_box(d, view), 1);
    cairo_stroke(d->cairo);
}

/* The region that the camera sees at its target, or the whole scene if that is smaller. */
static void choose_section(Drawing *d) {
    const RtBox *box = &d->layer->scene->geometry.box;
    const RtCamera *camera = &d->layer->scene->camera;
    const int axis = d->options->axis;
    RtVec3 up = camera->up;
    up.at[axis] = 0;
    d->up = rt_major_axis(up) != axis ? rt_major_axis(up) : (axis + 1) % 3;
    d->across = 3 - d->up - axis;
    RtVec3d size = rt_subd(rt_widen(box->hi), rt_widen(box->lo)), center = rt_widen(rt_box_center(*box));
    double distance = rt_lengthd(rt_subd(rt_widen(camera->at), rt_widen(camera->from)));
    RtTurn half = rt_turn((double)camera->fov / 2);
    double seen = d->height / (2 * distance * half.sine / half.cosine);
    double scale =
        0.96 * fmin(d->width / fmax(size.at[d->across], 1e-30), d->height / fmax(size.at[d->up], 1e-30));
    if (seen > scale) scale = seen, center = rt_widen(camera->at);
    d->section = (RtSection){.on = center, .origin = {d->width / 2, d->height / 2}, .scale = scale};
    d->section.on.at[axis] = d->options->at;
    d->section.right.at[d->across] = 1;
    d->section.up.at[d->up] = 1;
    d->section.normal.at[axis] = 1;
}

static RtStatus draw_section(Drawing *d, RtError *error) {
    const RtGeometry *g = &d->layer->scene->geometry;
    RtHitMemory *hit_memory;
    RT_TRY(rt_hit_memory_alloc(g, &hit_memory, error));
    for (uint32_t id = 0; id < g->object_count; id++) {
        if (rt_section_add_extent(&d->section, NULL, &(RtBoxView){.box = &g->boxes[id]}))
            rt_section_add_object(&d->section, d->cairo, g, id, hit_memory);
    }
    rt_free(hit_memory);
    rt_set_color(d->cairo, object_color, 0.35);
    cairo_fill_preserve(d->cairo);
    rt_set_color(d->cairo, object_color, 1);
    cairo_stroke(d->cairo);
    d->layer->ops->each_box(d->layer, (RtBoxViewer){fill_box, d});
    cairo_set_line_width(d->cairo, 1);
    return RT_OK;
}

/* ---- the legend ---- */

/* Samples of the lines of levels, of some if there are many, or of sizes; then of objects in a section. */
static void draw_keys(const Drawing *d, double x, double y) {
    enum { MOST = 6, SIZES = 5 };
    bool by_size = is_by_size(d);
    uint32_t levels = d->last - d->first + 1, count = by_size ? SIZES : levels < MOST ? levels : MOST;
    x += rt_draw_text(d->cairo, x, y, RT_BLACK, by_size ? "size" : "level") + 0.8 * d->em;
    for (uint32_t i = 0; i < count; i++) {
        double at = count > 1 ? (double)i / (count - 1) : 0;
        uint32_t level = d->first + (uint32_t)(at * (levels - 1) + 0.5);
        char text[32];
        if (by_size)
            snprintf(text, sizeof text, "%.2g", d->most * rt_power(d->least / d->most, at));
        else
            snprintf(text, sizeof text, "%u", level);
        set_line(d, by_size ? at : place_of_level(d, level), 1);
        cairo_move_to(d->cairo, x, floor(y - 0.35 * d->em) + 0.5);
        cairo_line_to(d->cairo, x + d->em, floor(y - 0.35 * d->em) + 0.5);
        cairo_stroke(d->cairo);
        x += 1.4 * d->em;
        x += rt_draw_text(d->cairo, x, y, RT_BLACK, "%s", text) + 0.6 * d->em;
    }
    cairo_set_line_width(d->cairo, 1);
    if (d->options->slice) rt_draw_key(d->cairo, x, y, object_color, "object");
}

static void draw_legend(const Drawing *d) {
    static const char axes[] = "xyz";
    static const char *const names[RT_EXTENT_KIND_COUNT] = {"boxes", "spheres", "oriented boxes",
                                                            "slab polytopes"};
    double left = 0.5 * d->em, y = d->height + 1.5 * d->em;
    if (d->options->slice)
        rt_draw_text(d->cairo, left, y, RT_BLACK, "%s, section at %c = %.4g, %c up", d->layer->ops->name,
                     axes[d->options->axis], d->options->at, axes[d->up]);
    else
        rt_draw_text(d->cairo, left, y, RT_BLACK, "%s", d->layer->ops->name);
    rt_draw_text(d->cairo, left, y + RT_LINE * d->em, RT_BLACK, "%llu of %llu %s%s",
                 (unsigned long long)d->drawn, (unsigned long long)d->all, names[d->kind],
                 d->options->leaves ? ", leaves only" : "");
    draw_keys(d, left, y + 2 * RT_LINE * d->em);
}

/* ---- from outside ---- */

/* Is this the layer to draw? `last`: no layer below. */
static RtStatus choose(const RtAccelOps *ops, const char *name, bool last, bool *chosen, RtError *error) {
    const bool can = ops->each_box || ops->find_cell;
    *chosen = name ? strcmp(ops->name, name) == 0 : can;
    if (*chosen ? can : !last) return RT_OK;
    if (name && !*chosen)
        return rt_fail(error, RT_BAD_INPUT, "there is no layer '%s' in this accelerator", name);
    return rt_fail(
        error, RT_NOT_AVAILABLE,
        "there is no picture of %s, which has neither boxes nor cells: choose another, such as bvh or grid; "
        "a plugin shows its boxes by `each_box`",
        ops->name);
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

static RtStatus draw(Drawing *d, RtError *error) {
    cairo_save(d->cairo);
    cairo_rectangle(d->cairo, 0, 0, d->width, d->height);
    cairo_clip(d->cairo);
    RtStatus status = d->options->slice ? draw_section(d, error) : draw_perspective(d, error);
    cairo_restore(d->cairo);
    RT_TRY(status);
    draw_legend(d);
    return rt_accel_check(d->layer, error);
}

RtStatus rt_structure_draw(const char *file, const RtAccel *layer, const RtFrame *frame,
                           const RtStructureOptions *options, RtError *error) {
    const RtSampling *s = &frame->sampling;
    const RtCamera *camera = &layer->scene->camera;
    uint32_t width = s->width > LEAST_WIDTH ? s->width : LEAST_WIDTH;
    RtCanvas canvas;
    Drawing d = {.frame = frame,
                 .layer = layer,
                 .options = options,
                 .width = s->width,
                 .height = s->height,
                 .em = rt_font_size(width)};
    choose_section(&d);
    each_box(&d, count_box);
    if (!options->slice && layer->parts && layer->parts[0]->ops->each_box) {
        const Drawing alone = d;
        d.most_boxes = d.all + MOST_IN_PARTS;
        show_parts(&d, &layer->scene->geometry, count_box);
        d.parts = d.all <= d.most_boxes;
        if (!d.parts) d = alone;
    }
    RT_TRY(rt_accel_check(layer, error));
    /* A floor much larger than the view should not determine the scale. */
    double view = rt_lengthd(rt_subd(rt_widen(camera->at), rt_widen(camera->from)));
    d.most = fmax(d.least, fmin(d.most, 2 * view));
    if (d.drawn == 0 && layer->scene->geometry.object_count > 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "none of the %llu boxes of %s is on the requested levels or in the slice",
                       (unsigned long long)d.all, layer->ops->name);
    RT_TRY(
        rt_canvas_open(&canvas, file, width, s->height + ceil((0.9 + RT_LINE * LINES) * d.em), d.em, error));
    d.cairo = canvas.cairo;
    return rt_canvas_close(&canvas, draw(&d, error), error);
}
