/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/stroke.h"

void rt_paint_path(cairo_t *cairo, RtStroke stroke) {
    const double dashes[] = {stroke.dash, stroke.dash};
    rt_set_color(cairo, stroke.color, stroke.opacity);
    cairo_fill_preserve(cairo);
    rt_set_color(cairo, stroke.color, 1);
    cairo_set_line_width(cairo, stroke.width);
    cairo_set_dash(cairo, dashes, stroke.dash > 0 ? 2 : 0, 0);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_BUTT);
    if (stroke.width > 0) cairo_stroke(cairo);
    cairo_new_path(cairo);
}

void rt_draw_disc(cairo_t *cairo, RtPoint center, double radius, RtColor color) {
    rt_add_circle(cairo, center, radius);
    rt_paint_path(cairo, (RtStroke){color, 0, 1, 0});
}

void rt_draw_arrow(cairo_t *cairo, RtPoint from, RtPoint to, RtStroke stroke, double head) {
    double dx = to.x - from.x, dy = to.y - from.y, length = sqrt(dx * dx + dy * dy);
    rt_add_line(cairo, from, to);
    rt_paint_path(cairo, stroke);
    if (!(length > 0)) return;
    dx *= head / length, dy *= head / length;
    const RtPoint corners[] = {
        to, {to.x - dx - dy / 2, to.y - dy + dx / 2}, {to.x - dx + dy / 2, to.y - dy - dx / 2}};
    rt_add_polygon(cairo, corners, 3);
    rt_paint_path(cairo, (RtStroke){stroke.color, 0, 1, 0});
}
