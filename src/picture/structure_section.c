/* SPDX-License-Identifier: Apache-2.0 */
/* The section through a structure: boxes filled where the plane cuts them, objects outlined. */
#include "core/base/clamp.h"
#include "core/base/elementary.h"
#include "core/base/transform.h"
#include "picture/net.h"
#include "picture/section.h"
#include "picture/structure_parts.h"

static double x_of(const RtStructureDrawing *d, double at) {
    return (at - d->left) * d->scale;
}

static double y_of(const RtStructureDrawing *d, double at) {
    return (d->top - at) * d->scale;
}

static void fill_rectangle(const RtStructureDrawing *d, const RtBox *box, RtColor color, double opacity) {
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
static void line_between(const RtStructureDrawing *d, double x0, double y0, double x1, double y1,
                         RtColor color) {
    double a[2] = {x0, y0}, b[2] = {x1, y1}, hi[2] = {d->width - 1e-6, d->height - 1e-6};
    if (rt_section_clip(a, b, (double[2]){0, 0}, hi))
        rt_draw_line(d->image, a[0], a[1], b[0], b[1], color, 0.8);
}

/* Row by row, from the edge on the left to the edge on the right. */
static void fill_section(const RtStructureDrawing *d, const RtVec3d *corners, uint32_t count, RtColor color,
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
    const RtStructureDrawing *d = context;
    RtVec3d corners[RT_NET_CORNERS];
    if (!rt_structure_shows(d, view)) return;
    RtColor color = rt_structure_color(d, view);
    double opacity = view->leaf ? 0.18 : 0.05;
    if (rt_net_is_other(view))
        fill_section(d, corners, rt_net_section(view, d->options->axis, d->options->at, corners), color,
                     opacity);
    else
        fill_rectangle(d, view->box, color, opacity);
}

static void outline_sphere(const RtStructureDrawing *d, const RtSphere *sphere) {
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

static void outline_flat(const RtStructureDrawing *d, const RtVec3 *corners, uint32_t count) {
    RtVec3d on = {{0, 0, 0}}, normal = {{0, 0, 0}}, cut[2];
    on.at[d->options->axis] = d->options->at;
    normal.at[d->options->axis] = 1;
    if (!rt_section_flat(corners, count, on, normal, cut)) return;
    line_between(d, x_of(d, cut[0].at[d->across]), y_of(d, cut[0].at[d->up]), x_of(d, cut[1].at[d->across]),
                 y_of(d, cut[1].at[d->up]), RT_WHITE);
}

/* As much as the camera sees at its aim, or all that there is. */
static void choose_window(RtStructureDrawing *d) {
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

void rt_structure_draw_section(RtStructureDrawing *d) {
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
