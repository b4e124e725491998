/* SPDX-License-Identifier: Apache-2.0 */
/* The upper part is a section through the plane of the ray and the scene axis along which the ray moves
 * least: boxes are upright rectangles, spheres are circles, and the ray crosses exactly those that it
 * passes through, from left to right. The lower part has a line for each row of the path, with a bar where
 * the ray is in its box. Both parts share the x axis. */
#include "picture/path_picture.h"

#include "core/base/words.h"
#include "picture/extent_outline.h"

enum {
    WIDTH = 1000,
    LEFT = 250,
    PLOT = WIDTH - LEFT - 20,
    MARGIN = 12
}; /* PLOT: the common x axis, pixels */
enum { TOP = 64, SECTION = 330, GAP = 46, ROW = 14, MOST_ROWS = 90, MOST_TICKS = 20 };
enum { FONT_SIZE = 11, TITLE_SIZE = 16 };

/* x shows s, the distance along the ray's projection perpendicular to `axis`, in world units; y shows
 * `axis`. */
typedef struct Drawing {
    const RtPath *path;
    const RtGeometry *geometry;
    cairo_t *cairo;
    RtVec3d org, along, normal; /* unit: along s; of the plane */
    int axis;
    double speed;    /* of s per t */
    double s0, v0;   /* the upper left of the section */
    double scale;    /* pixels per unit */
    double farthest; /* the largest t that is drawn */
} Drawing;

/* How a shape is drawn. */
typedef struct Style {
    RtColor color;
    double width;   /* of its outline, 0: none */
    double opacity; /* of its filling, 0: none */
    bool dashed;
} Style;

static const RtColor dark = {{85, 85, 85}}, light = {{153, 153, 153}}, hit_color = {{204, 0, 0}};

/* ---- the plane ---- */

static double x_of(const Drawing *d, double s) {
    return LEFT + (s - d->s0) * d->scale;
}

static double y_of(const Drawing *d, double v) {
    return TOP + (d->v0 - v) * d->scale;
}

static RtPoint point_of(const Drawing *d, RtVec3d p) {
    return (RtPoint){x_of(d, rt_dotd(rt_subd(p, d->org), d->along)), y_of(d, p.at[d->axis])};
}

static RtPoint point_on_ray(const Drawing *d, double t) {
    return (RtPoint){x_of(d, t * d->speed),
                     y_of(d, d->org.at[d->axis] + t * (double)d->path->ray.dir.at[d->axis])};
}

static void choose_plane(Drawing *d) {
    RtVec3d dir = rt_widen(d->path->ray.dir);
    d->org = rt_widen(d->path->ray.org);
    d->axis = 0;
    for (int a = 1; a < 3; a++) {
        if (fabs(dir.at[a]) <= fabs(dir.at[d->axis])) d->axis = a;
    }
    RtVec3d up = {{0, 0, 0}};
    up.at[d->axis] = 1;
    dir.at[d->axis] = 0;
    d->speed = rt_lengthd(dir);
    d->along = rt_scaled(dir, 1 / d->speed);
    d->normal = rt_crossd(d->along, up);
}

/* The interval of s in which the plane is inside the box, at any height; false if there is none. */
static bool section_of_box(const Drawing *d, const RtBox *box, double *from, double *to) {
    *from = -(double)INFINITY, *to = (double)INFINITY;
    for (int a = 0; a < 3; a++) {
        double lo = (double)box->lo.at[a] - d->org.at[a], hi = (double)box->hi.at[a] - d->org.at[a];
        if (a == d->axis) continue;
        if (d->along.at[a] == 0) {
            if (lo > 0 || hi < 0) return false;
            continue;
        }
        *from = fmax(*from, fmin(lo / d->along.at[a], hi / d->along.at[a]));
        *to = fmin(*to, fmax(lo / d->along.at[a], hi / d->along.at[a]));
    }
    return *from <= *to;
}

/* Shows the ray from where it first enters anything, or from its origin on a surface, to where it last
 * leaves anything, or hits. */
static void choose_window(Drawing *d) {
    const RtPath *path = d->path;
    double first = (double)INFINITY, last = 0;
    for (uint32_t i = 0; i < path->count; i++) {
        const RtPathRow *row = &path->rows[i];
        if (!row->boxed || !(row->enter <= row->leave)) continue;
        first = fmin(first, row->enter);
        double end = row->round ? row->enter : row->leave; /* large balls extend far beyond their content */
        if (isfinite(end)) last = fmax(last, end);
    }
    if (isfinite((double)path->hit.t))
        last = fmax(last, (double)path->hit.t), first = fmin(first, (double)path->hit.t);
    if (!(first <= last))
        first = (double)path->ray.tmin,
        last = isfinite((double)path->ray.tmax) ? (double)path->ray.tmax : first + 1;
    if (path->ray.kind != RT_RAY_PRIMARY) first = fmin(first, 0);
    if (last - first <= 1e-6 * fabs(last)) last = first + fmax(1e-3, 1e-3 * first); /* room for ticks */
    d->farthest = last + 0.04 * (last - first);
    double from = (first - 0.06 * (last - first)) * d->speed, to = d->farthest * d->speed;
    d->scale = PLOT / (to - from);
    d->s0 = from;
    double slope = (double)path->ray.dir.at[d->axis],
           middle = d->org.at[d->axis] + slope * (first + last) / 2;
    d->v0 = middle + SECTION / 2.0 / d->scale;
}

/* ---- shapes ---- */

/* Fills and outlines the path. */
static void paint(cairo_t *cairo, Style style) {
    const double dashes[] = {3, 3};
    rt_set_color(cairo, style.color, style.opacity);
    cairo_fill_preserve(cairo);
    rt_set_color(cairo, style.color, 1);
    cairo_set_line_width(cairo, style.width);
    cairo_set_dash(cairo, dashes, style.dashed ? 2 : 0, 0);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_BUTT);
    if (style.width > 0) cairo_stroke(cairo);
    cairo_new_path(cairo);
}

static void draw_text(const Drawing *d, double x, double y, RtColor color, const char *text) {
    rt_set_color(d->cairo, color, 1);
    rt_draw_text(d->cairo, x, y, text);
}

/* The order of rows as a colour. */
static RtColor color_of_row(const Drawing *d, uint32_t row) {
    return rt_color_scale(d->path->count > 1 ? 0.92 * row / (d->path->count - 1) : 0);
}

/* Adds the circle in which the plane cuts a ball. */
static void add_ball(const Drawing *d, RtVec3d center, double r) {
    double off = rt_dotd(rt_subd(center, d->org), d->normal);
    if (fabs(off) < r) rt_add_circle(d->cairo, point_of(d, center), sqrt(r * r - off * off) * d->scale);
}

/* Adds the rectangle in which the plane cuts a box, which may be infinite. */
static void add_box(const Drawing *d, const RtBox *box) {
    double from, to;
    if (!section_of_box(d, box, &from, &to)) return;
    double left = rt_clampd(x_of(d, from), -WIDTH, 2 * WIDTH),
           right = rt_clampd(x_of(d, to), -WIDTH, 2 * WIDTH);
    double top = rt_clampd(y_of(d, (double)box->hi.at[d->axis]), -WIDTH, 2 * WIDTH);
    double bottom = rt_clampd(y_of(d, (double)box->lo.at[d->axis]), -WIDTH, 2 * WIDTH);
    cairo_rectangle(d->cairo, left, top, right - left, bottom - top);
}

static bool is_missed(const RtPathRow *row) {
    return row->kind == RT_TRACED_EXTENT_TEST && !row->met;
}

static void draw_extent(const Drawing *d, uint32_t i) {
    const RtPathRow *row = &d->path->rows[i];
    bool leaf = row->kind == RT_TRACED_STEP && row->leaf;
    if (row->round)
        add_ball(d, row->ball.center, row->ball.radius);
    else
        add_box(d, &row->box);
    if (is_missed(row))
        paint(d->cairo, (Style){light, 1, 0, true});
    else
        paint(d->cairo, (Style){color_of_row(d, i), leaf ? 1.5 : 1, leaf ? 0.12 : 0, false});
}

/* Adds the line in which the plane cuts a flat object. */
static void add_flat(const Drawing *d, const RtVec3 *corners, uint32_t count) {
    RtVec3d cut[2];
    if (rt_outline_cut_flat(corners, count, d->org, d->normal, cut))
        rt_add_line(d->cairo, point_of(d, cut[0]), point_of(d, cut[1]));
}

/* Cones and CSG trees appear only as boxes, in rows of their own. */
static void draw_object(const Drawing *d, const RtPathRow *row) {
    const RtGeometry *g = d->geometry;
    if (row->index >= g->object_count) return;
    uint32_t index = rt_ref_index(g->objects[row->index]);
    RtShape shape = rt_ref_shape(g->objects[row->index]);
    if (shape == RT_SHAPE_SPHERE)
        add_ball(d, rt_widen(g->spheres[index].center), (double)g->spheres[index].radius);
    else if (shape == RT_SHAPE_TRIANGLE)
        add_flat(d, g->triangles[index].v, 3);
    else if (shape == RT_SHAPE_POLYGON)
        add_flat(d, rt_polygon_vertices(g, index), g->polygons[index].count);
    paint(d->cairo, row->met ? (Style){hit_color, 2, 0.25, false} : (Style){dark, 1, 0.1, false});
}

static void draw_disc(const Drawing *d, RtPoint center, double radius, RtColor color) {
    rt_add_circle(d->cairo, center, radius);
    paint(d->cairo, (Style){color, 0, 1, false});
}

static void draw_arrow(const Drawing *d, RtPoint from, RtPoint to) {
    double dx = to.x - from.x, dy = to.y - from.y, length = sqrt(dx * dx + dy * dy);
    rt_add_line(d->cairo, from, to);
    paint(d->cairo, (Style){RT_BLACK, 1.5, 0, false});
    if (!(length > 0)) return;
    dx *= 12 / length, dy *= 12 / length;
    const RtPoint head[] = {
        to, {to.x - dx - dy / 2, to.y - dy + dx / 2}, {to.x - dx + dy / 2, to.y - dy - dx / 2}};
    rt_add_polygon(d->cairo, head, 3);
    paint(d->cairo, (Style){RT_BLACK, 0, 1, false});
}

static void draw_ray(const Drawing *d) {
    const RtRay *ray = &d->path->ray;
    double from = fmax((double)ray->tmin, d->s0 / d->speed), hit = (double)d->path->hit.t;
    double to = fmin(fmin((double)ray->tmax, d->farthest), hit);
    draw_arrow(d, point_on_ray(d, from), point_on_ray(d, to));
    if (ray->kind != RT_RAY_PRIMARY) draw_disc(d, point_on_ray(d, 0), 4, RT_BLACK);
    if (!isfinite(hit)) return;
    draw_disc(d, point_on_ray(d, hit), 5.5, RT_WHITE);
    draw_disc(d, point_on_ray(d, hit), 4.5, hit_color);
}

static void draw_section(const Drawing *d) {
    const RtPath *path = d->path;
    cairo_save(d->cairo);
    cairo_rectangle(d->cairo, LEFT, TOP, PLOT, SECTION);
    cairo_clip(d->cairo);
    rt_fill_rectangle(d->cairo, LEFT, TOP, PLOT, SECTION, (RtColor){{250, 250, 250}});
    for (uint32_t i = 0; i < path->count; i++) {
        if (path->rows[i].boxed && path->rows[i].kind != RT_TRACED_OBJECT_TEST) draw_extent(d, i);
    }
    for (uint32_t i = 0; i < path->count; i++) {
        if (path->rows[i].kind == RT_TRACED_OBJECT_TEST) draw_object(d, &path->rows[i]);
    }
    draw_ray(d);
    cairo_restore(d->cairo);
    cairo_rectangle(d->cairo, LEFT + 0.5, TOP + 0.5, PLOT - 1, SECTION - 1);
    paint(d->cairo, (Style){{{204, 204, 204}}, 1, 0, false});
}

/* ---- the rows ---- */

static void draw_bar(const Drawing *d, uint32_t i, double y) {
    const RtPathRow *row = &d->path->rows[i];
    if (!row->boxed || !(row->enter <= row->leave)) return;
    double from = rt_clampd(x_of(d, row->enter * d->speed), LEFT, LEFT + PLOT);
    double to = rt_clampd(x_of(d, row->leave * d->speed), LEFT, LEFT + PLOT);
    Style style = {color_of_row(d, i), 1, 0, is_missed(row)};
    if (is_missed(row)) style.color = light;
    if (row->kind == RT_TRACED_OBJECT_TEST) style.color = dark;
    if (row->kind == RT_TRACED_STEP) style.opacity = row->leaf ? 0.7 : 0.25;
    cairo_rectangle(d->cairo, from, y + 3, fmax(to - from, 1), ROW - 6);
    paint(d->cairo, style);
}

static void draw_row(const Drawing *d, uint32_t i, double y) {
    const RtPathRow *row = &d->path->rows[i];
    bool object = row->kind == RT_TRACED_OBJECT_TEST;
    char of[128] = "", text[256];
    if (row->kind == RT_TRACED_PASSED_ON)
        snprintf(of, sizeof of, " by %s", row->what);
    else if (*row->what)
        snprintf(of, sizeof of, ", %s %u", row->what, row->index);
    const char *result = !rt_path_row_answers(row) ? "" : row->met ? ": hit" : ": missed";
    snprintf(text, sizeof text, "%u  %s%s%s", i + 1, rt_path_row_name(row), of, result);
    draw_text(d, MARGIN, y + ROW - 3, RT_BLACK, text);
    draw_bar(d, i, y);
    if (object && row->met)
        draw_disc(d, (RtPoint){x_of(d, (double)row->t * d->speed), y + ROW / 2.0}, 4, hit_color);
}

/* Draws consecutive object tests that missed as one row. */
static void draw_run(const Drawing *d, uint32_t first, uint32_t run, double y) {
    char text[128];
    snprintf(text, sizeof text, "%u to %u  %u object tests: missed", first + 1, first + run, run);
    draw_text(d, MARGIN, y + ROW - 3, RT_BLACK, text);
    for (uint32_t i = first; i < first + run; i++) draw_bar(d, i, y);
}

static void draw_nearest(const Drawing *d, const RtPathRow *row, double y) {
    if (!isfinite((double)row->nearest)) return;
    double x = x_of(d, (double)row->nearest * d->speed);
    rt_add_line(d->cairo, (RtPoint){x, y}, (RtPoint){x, y + ROW});
    paint(d->cairo, (Style){hit_color, 1.5, 0, false});
}

/* Draws the rows if `draw`; returns their number, at most MOST_ROWS, and in *left the number of omitted
 * rows. */
static uint32_t draw_rows(const Drawing *d, double top, bool draw, uint32_t *left) {
    uint32_t line = 0, i = 0;
    for (uint32_t run; i < d->path->count && line < MOST_ROWS; i += run, line++) {
        double y = top + ROW * line;
        run = rt_path_run(d->path, i);
        if (!draw) continue;
        if (run > 1)
            draw_run(d, i, run, y);
        else
            draw_row(d, i, y);
        draw_nearest(d, &d->path->rows[i], y);
    }
    *left = d->path->count - i;
    return line;
}

/* Ticks at round values of t. */
static void draw_axis(const Drawing *d, double y, double bottom) {
    double from = d->s0 / d->speed, to = (d->s0 + PLOT / d->scale) / d->speed, step = 1;
    while (step > (to - from) / 5) step /= 10;
    while (step * 10 < (to - from) / 5) step *= 10;
    if (5 * step < (to - from) / 3)
        step *= 5;
    else if (2 * step < (to - from) / 4)
        step *= 2;
    double first = ceil(from / step);
    for (int i = 0; i < MOST_TICKS && (first + i) * step <= to; i++) {
        double t = (first + i) * step + 0.0, x = floor(x_of(d, t * d->speed)) + 0.5;
        char text[32];
        snprintf(text, sizeof text, "t = %.6g", t);
        rt_add_line(d->cairo, (RtPoint){x, y}, (RtPoint){x, bottom});
        paint(d->cairo, (Style){{{221, 221, 221}}, 1, 0, false});
        draw_text(d, x - rt_text_width(d->cairo, text) / 2, y - 4, dark, text);
    }
}

/* ---- the legend ---- */

static double put_line(const Drawing *d, double y, const char *text) {
    draw_text(d, MARGIN, y, RT_BLACK, text);
    return y + 16;
}

static void draw_legend(const Drawing *d) {
    static const struct {
        Style style;
        const char *text;
    } keys[] = {{{{{59, 82, 139}}, 1, 0, false}, "extent hit, or inner node"},
                {{{{153, 153, 153}}, 1, 0, true}, "extent missed"},
                {{{{33, 145, 140}}, 1, 0.4, false}, "step, leaf"},
                {{{{85, 85, 85}}, 1, 0.1, false}, "object tested"},
                {{{{204, 0, 0}}, 1, 0.25, false}, "object hit"},
                {{{{204, 0, 0}}, 0, 1, false}, "nearest t so far"}};
    enum { COUNT = sizeof keys / sizeof keys[0] };
    const RtTally *t = &d->path->tally;
    char text[128];
    double y = TOP + 6;
    for (int i = 0; i < COUNT; i++, y += 20) {
        cairo_rectangle(d->cairo, MARGIN + 0.5, y + 0.5, i + 1 == COUNT ? 2 : 18, 11);
        paint(d->cairo, keys[i].style);
        draw_text(d, MARGIN + 26, y + 10, RT_BLACK, keys[i].text);
    }
    y = put_line(d, y + 12, "colours: order, from dark to light");
    snprintf(text, sizeof text, "%c is up", "xyz"[d->axis]);
    y = put_line(d, y, text) + 12;
    snprintf(text, sizeof text, "%llu step%s, %llu of them in leaves", (unsigned long long)t->steps,
             rt_plural(t->steps), (unsigned long long)t->leaf_steps);
    y = put_line(d, y, text);
    snprintf(text, sizeof text, "%llu extent test%s", (unsigned long long)t->extent_tests,
             rt_plural(t->extent_tests));
    y = put_line(d, y, text);
    snprintf(text, sizeof text, "%llu object test%s, %llu hit%s", (unsigned long long)t->object_tests,
             rt_plural(t->object_tests), (unsigned long long)t->object_hits, rt_plural(t->object_hits));
    put_line(d, y, text);
}

RtStatus rt_path_draw(const RtPath *path, const RtScene *scene, const char *title, const char *spec,
                      const char *file, RtError *error) {
    RtCanvas canvas;
    uint32_t left;
    char text[64];
    Drawing d = {.path = path, .geometry = &scene->geometry};
    choose_plane(&d);
    choose_window(&d);
    double bars = TOP + SECTION + GAP, bottom = bars + ROW * draw_rows(&d, bars, false, &left);
    RT_TRY(rt_canvas_open(&canvas, file, WIDTH, bottom + 30, RT_WHITE, TITLE_SIZE, error));
    d.cairo = canvas.cairo;
    rt_set_color(d.cairo, RT_BLACK, 1);
    rt_draw_text_within(d.cairo, MARGIN, 24, WIDTH - 2 * MARGIN, title);
    cairo_set_font_size(d.cairo, FONT_SIZE);
    rt_set_color(d.cairo, dark, 1);
    rt_draw_text_within(d.cairo, MARGIN, 44, WIDTH - 2 * MARGIN, spec);
    draw_legend(&d);
    draw_section(&d);
    draw_axis(&d, bars - 4, bottom);
    draw_rows(&d, bars, true, &left);
    snprintf(text, sizeof text, "and %u more row%s", left, rt_plural(left));
    if (left > 0) put_line(&d, bottom + 18, text);
    return rt_canvas_close(&canvas, RT_OK, error);
}
