/* SPDX-License-Identifier: Apache-2.0 */
/* The drawing of a path. Its upper part is a section through the plane of the ray and that axis of the scene
 * which the ray runs least along: boxes are upright rectangles in it, spheres circles, exactly those that the
 * ray goes through are crossed by it, and what is to the right comes later. The lower part has a row for each
 * row of the path, a bar where the ray is in its box: a place on the ray is at the same x in both. */
#include "core/base/clamp.h"
#include "core/base/file.h"
#include "core/base/words.h"
#include "core/text/table.h"
#include "picture/draw.h"
#include "picture/section.h"
#include "render/path.h"

enum { WIDTH = 1000, LEFT = 250, PLOT = WIDTH - LEFT - 20 }; /* of the common x axis, pixels */
enum { FAR = 1000000 };                                      /* the largest radius, pixels */
enum { TOP = 64, SECTION = 330, GAP = 46, ROW = 14, MOST_ROWS = 90, MOST_TICKS = 20 };

/* Across the picture goes s, world units along the ray without what it does along `axis`; up goes `axis`. */
typedef struct Drawing {
    const RtPath *path;
    const RtGeometry *geometry;
    FILE *out;
    RtVec3d org, along, normal; /* unit: along s; of the plane */
    int axis;
    double speed;    /* of s per t */
    double s0, v0;   /* the upper left of the section is at s0, v0 ... */
    double scale;    /* pixels per unit */
    double farthest; /* t to which it is worth drawing */
} Drawing;

/* ---- the plane ---- */

static double x_of(const Drawing *d, double s) {
    return LEFT + (s - d->s0) * d->scale;
}

static double y_of(const Drawing *d, double v) {
    return TOP + (d->v0 - v) * d->scale;
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

/* Where the plane, followed without end along the ray's s, is in the box; false where it is not. */
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

/* What is to be seen: the ray from where it first enters something, or from the surface that it leaves, to
 * where it last leaves something, or hits. */
static void choose_window(Drawing *d) {
    const RtPath *path = d->path;
    double first = (double)INFINITY, last = 0;
    for (uint32_t i = 0; i < path->count; i++) {
        const RtPathRow *row = &path->rows[i];
        if (!row->boxed || !(row->enter <= row->leave)) continue;
        first = fmin(first, row->enter);
        double end = row->round ? row->enter : row->leave; /* large balls end far behind what is in them */
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

/* Order of the rows as a colour. */
static void put_color(const Drawing *d, uint32_t row) {
    RtColor c = rt_color_scale(d->path->count > 1 ? 0.92 * row / (d->path->count - 1) : 0);
    fprintf(d->out, "#%02x%02x%02x", c.rgb[0], c.rgb[1], c.rgb[2]);
}

/* Numbers that viewers do not like, of a circle that is far larger than the picture or far outside, become a
 * circle's of up to radius FAR: it goes by the middle of the picture on the same side and as near, where its
 * arc is within a tenth of a pixel as straight. */
static void limit_circle(double *x, double *y, double *r) {
    double middle[2] = {LEFT + PLOT / 2.0, TOP + SECTION / 2.0}, dx = *x - middle[0], dy = *y - middle[1];
    double away = sqrt(dx * dx + dy * dy), radius = fmin(*r, FAR);
    if (*r <= FAR && away <= FAR) return;
    double moved = radius + rt_clampd(away - *r, -2 * WIDTH, 2 * WIDTH);
    *x = middle[0] + (away > 0 ? dx / away * moved : 0);
    *y = middle[1] + (away > 0 ? dy / away * moved : 0);
    *r = radius;
}

/* The start of a circle's element: false where the plane passes by the ball. */
static bool draw_circle(const Drawing *d, RtVec3d at, double r) {
    RtVec3d center = rt_subd(at, d->org);
    double off = rt_dotd(center, d->normal);
    if (!(fabs(off) < r)) return false;
    double x = x_of(d, rt_dotd(center, d->along)), y = y_of(d, at.at[d->axis]);
    double around = sqrt(r * r - off * off) * d->scale;
    limit_circle(&x, &y, &around);
    fprintf(d->out, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" ", x, y, around);
    return true;
}

/* The start of the element of a box. */
static bool draw_rectangle(const Drawing *d, const RtBox *box) {
    double from, to;
    if (!section_of_box(d, box, &from, &to)) return false;
    /* What is far outside would be numbers that viewers do not like. */
    double left = rt_clampd(x_of(d, from), -WIDTH, 2 * WIDTH),
           right = rt_clampd(x_of(d, to), -WIDTH, 2 * WIDTH);
    double top = rt_clampd(y_of(d, (double)box->hi.at[d->axis]), -WIDTH, 2 * WIDTH);
    double bottom = rt_clampd(y_of(d, (double)box->lo.at[d->axis]), -WIDTH, 2 * WIDTH);
    fprintf(d->out, "<rect x=\"%.2f\" y=\"%.2f\" width=\"%.2f\" height=\"%.2f\" ", left, top, right - left,
            bottom - top);
    return true;
}

static void draw_extent(const Drawing *d, uint32_t i, bool fill) {
    const RtPathRow *row = &d->path->rows[i];
    bool missed = row->kind == RT_TRACED_EXTENT_TEST && !row->met;
    if (row->round ? !draw_circle(d, row->ball.center, row->ball.radius) : !draw_rectangle(d, &row->box))
        return;
    if (missed) {
        fputs("fill=\"none\" stroke=\"#999\" stroke-dasharray=\"3 3\"", d->out);
    } else {
        fputs("stroke=\"", d->out);
        put_color(d, i);
        fputs(fill ? "\" fill=\"" : "\" fill=\"none\"", d->out);
        if (fill) {
            put_color(d, i);
            fputs("\" fill-opacity=\"0.12\" stroke-width=\"1.5\"", d->out);
        }
    }
    fprintf(d->out, "><title>%u: %s</title></%s>\n", i + 1, rt_path_row_name(row),
            row->round ? "circle" : "rect");
}

static void draw_sphere(const Drawing *d, const RtSphere *sphere, const char *style) {
    if (draw_circle(d, rt_widen(sphere->center), (double)sphere->radius)) fprintf(d->out, "%s/>\n", style);
}

/* The plane cuts a flat shape in a line: from where it crosses one edge to where it crosses another. */
static void draw_flat(const Drawing *d, const RtVec3 *corners, uint32_t count, const char *style) {
    RtVec3d cut[2];
    if (!rt_section_flat(corners, count, d->org, d->normal, cut)) return;
    double ends[2][2], lo[2] = {-WIDTH, -WIDTH}, hi[2] = {2 * WIDTH, 2 * WIDTH};
    for (int i = 0; i < 2; i++) {
        ends[i][0] = x_of(d, rt_dotd(rt_subd(cut[i], d->org), d->along));
        ends[i][1] = y_of(d, cut[i].at[d->axis]);
    }
    if (!rt_section_clip(ends[0], ends[1], lo, hi)) return;
    fprintf(d->out, "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" %s/>\n", ends[0][0], ends[0][1],
            ends[1][0], ends[1][1], style);
}

static void draw_object(const Drawing *d, const RtPathRow *row) {
    const char *style = row->met ? "stroke=\"#c00\" stroke-width=\"2\" fill=\"#c00\" fill-opacity=\"0.25\""
                                 : "stroke=\"#555\" stroke-width=\"1\" fill=\"#000\" fill-opacity=\"0.06\"";
    const RtGeometry *g = d->geometry;
    if (row->index >= g->object_count) return;
    uint32_t index = rt_ref_index(g->objects[row->index]);
    switch (rt_ref_shape(g->objects[row->index])) {
    case RT_SHAPE_SPHERE: draw_sphere(d, &g->spheres[index], style); return;
    case RT_SHAPE_TRIANGLE: draw_flat(d, g->triangles[index].v, 3, style); return;
    case RT_SHAPE_POLYGON:
        draw_flat(d, g->polygon_vertices + g->polygons[index].first, g->polygons[index].count, style);
        return;
    case RT_SHAPE_CONE: /* by its box alone, a row of its own */
    case RT_SHAPE_CSG:
    case RT_SHAPE_COUNT: return;
    }
}

static void draw_ray(const Drawing *d) {
    const RtRay *ray = &d->path->ray;
    double until = fmin((double)ray->tmax, d->farthest), from = fmax((double)ray->tmin, d->s0 / d->speed);
    double hit = (double)d->path->hit.t, slope = (double)ray->dir.at[d->axis], v = d->org.at[d->axis];
    fprintf(d->out,
            "<line x1=\"%.2f\" y1=\"%.2f\" x2=\"%.2f\" y2=\"%.2f\" stroke=\"#000\" stroke-width=\"1.5\" "
            "marker-end=\"url(#arrow)\"/>\n",
            x_of(d, from * d->speed), y_of(d, v + slope * from), x_of(d, fmin(until, hit) * d->speed),
            y_of(d, v + slope * fmin(until, hit)));
    if (ray->kind != RT_RAY_PRIMARY)
        fprintf(d->out, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"4\"/>\n", x_of(d, 0), y_of(d, v));
    if (!isfinite(hit)) return;
    fprintf(d->out, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"5\" fill=\"#c00\" stroke=\"#fff\"/>\n",
            x_of(d, hit * d->speed), y_of(d, v + slope * hit));
}

static void draw_section(const Drawing *d) {
    const RtPath *path = d->path;
    fprintf(d->out,
            "<svg x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" viewBox=\"%d %d %d %d\">\n"
            "<rect x=\"%d\" y=\"%d\" width=\"%d\" height=\"%d\" fill=\"#fafafa\" stroke=\"#ccc\"/>\n",
            LEFT, TOP, PLOT, SECTION, LEFT, TOP, PLOT, SECTION, LEFT, TOP, PLOT, SECTION);
    for (uint32_t i = 0; i < path->count; i++) {
        const RtPathRow *row = &path->rows[i];
        if (row->boxed && row->kind != RT_TRACED_OBJECT_TEST)
            draw_extent(d, i, row->kind == RT_TRACED_STEP && row->leaf);
    }
    for (uint32_t i = 0; i < path->count; i++) {
        if (path->rows[i].kind == RT_TRACED_OBJECT_TEST) draw_object(d, &path->rows[i]);
    }
    draw_ray(d);
    fputs("</svg>\n", d->out);
}

/* ---- the rows ---- */

static void draw_bar(const Drawing *d, uint32_t i, double y) {
    const RtPathRow *row = &d->path->rows[i];
    double from = rt_clampd(x_of(d, row->enter * d->speed), LEFT, LEFT + PLOT);
    double to = rt_clampd(x_of(d, row->leave * d->speed), LEFT, LEFT + PLOT);
    bool leaf = row->kind == RT_TRACED_STEP && row->leaf;
    bool missed = row->kind == RT_TRACED_EXTENT_TEST && !row->met;
    if (!row->boxed || !(row->enter <= row->leave)) return;
    fprintf(d->out, "<rect x=\"%.2f\" y=\"%.1f\" width=\"%.2f\" height=\"%d\" stroke=\"", from, y + 3,
            fmax(to - from, 1), ROW - 6);
    if (missed || row->kind == RT_TRACED_OBJECT_TEST)
        fputs(missed ? "#999\" stroke-dasharray=\"3 3" : "#555", d->out);
    else
        put_color(d, i);
    fputs("\" fill=\"", d->out);
    if (row->kind == RT_TRACED_STEP)
        put_color(d, i);
    else
        fputs("none", d->out);
    fprintf(d->out, "\" fill-opacity=\"%s\"/>\n", leaf ? "0.7" : "0.25");
}

/* Object tests that all missed, as one row. */
static void draw_run(const Drawing *d, uint32_t first, uint32_t run, double y) {
    fprintf(d->out, "<text x=\"12\" y=\"%.1f\">%u to %u  object tests, %u objects: missed</text>\n",
            y + ROW - 3, first + 1, first + run, run);
    for (uint32_t i = first; i < first + run; i++) draw_bar(d, i, y);
}

static void draw_row(const Drawing *d, uint32_t i, double y) {
    const RtPathRow *row = &d->path->rows[i];
    bool tests = row->kind == RT_TRACED_EXTENT_TEST || row->kind == RT_TRACED_OBJECT_TEST;
    fprintf(d->out, "<text x=\"12\" y=\"%.1f\">%u  %s", y + ROW - 3, i + 1, rt_path_row_name(row));
    if (row->kind == RT_TRACED_PASSED_ON)
        fprintf(d->out, " by %s", row->what);
    else if (row->what)
        fprintf(d->out, ", %s %u", row->what, row->index);
    if (tests)
        fputs(row->met ? (row->kind == RT_TRACED_OBJECT_TEST ? ": hit" : ": met") : ": missed", d->out);
    fputs("</text>\n", d->out);
    draw_bar(d, i, y);
    if (row->kind == RT_TRACED_OBJECT_TEST && row->met)
        fprintf(d->out, "<circle cx=\"%.2f\" cy=\"%.1f\" r=\"4\" fill=\"#c00\"/>\n",
                x_of(d, (double)row->t * d->speed), y + ROW / 2.0);
}

static void draw_nearest(const Drawing *d, const RtPathRow *row, double y) {
    if (!isfinite((double)row->nearest)) return;
    double x = x_of(d, (double)row->nearest * d->speed);
    fprintf(d->out,
            "<line x1=\"%.2f\" y1=\"%.1f\" x2=\"%.2f\" y2=\"%.1f\" stroke=\"#c00\" stroke-width=\"1.5\"/>\n",
            x, y, x, y + ROW);
}

/* A round number of ticks. */
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
        double t = (first + i) * step + 0.0, x = x_of(d, t * d->speed);
        fprintf(d->out,
                "<line x1=\"%.2f\" y1=\"%.1f\" x2=\"%.2f\" y2=\"%.1f\" stroke=\"#ddd\"/>"
                "<text x=\"%.2f\" y=\"%.1f\" text-anchor=\"middle\" fill=\"#555\">t = %.6g</text>\n",
                x, y, x, bottom, x, y - 4, t);
    }
}

static void draw_legend(const Drawing *d) {
    static const char axes[] = "xyz";
    const RtTally *t = &d->path->tally;
    static const struct {
        const char *style, *text;
    } marks[] = {{"stroke=\"#3b528b\" fill=\"none\"", "extent met, or inner node"},
                 {"stroke=\"#999\" fill=\"none\" stroke-dasharray=\"3 3\"", "extent missed"},
                 {"stroke=\"#21918c\" fill=\"#21918c\" fill-opacity=\"0.4\"", "step, leaf"},
                 {"stroke=\"#555\" fill=\"#000\" fill-opacity=\"0.06\"", "object tested"},
                 {"stroke=\"#c00\" fill=\"#c00\" fill-opacity=\"0.25\"", "object hit"},
                 {"stroke=\"none\" fill=\"#c00\"", "nearest t so far"}};
    double y = TOP + 6;
    for (size_t i = 0; i < sizeof marks / sizeof marks[0]; i++, y += 20) {
        bool line = i + 1 == sizeof marks / sizeof marks[0];
        fprintf(
            d->out,
            "<rect x=\"12\" y=\"%.1f\" width=\"%d\" height=\"12\" %s/><text x=\"38\" y=\"%.1f\">%s</text>\n",
            y, line ? 2 : 18, marks[i].style, y + 10, marks[i].text);
    }
    fprintf(d->out, "<text x=\"12\" y=\"%.1f\">colours: order, dark comes first</text>\n", y + 12);
    fprintf(d->out, "<text x=\"12\" y=\"%.1f\">%c is up</text>\n", y + 28, axes[d->axis]);
    fprintf(d->out,
            "<text x=\"12\" y=\"%.1f\">%llu step%s, of leaves %llu</text><text x=\"12\" y=\"%.1f\">%llu "
            "extent test%s</text><text x=\"12\" y=\"%.1f\">%llu object test%s, hits %llu</text>\n",
            y + 56, (unsigned long long)t->steps, rt_plural(t->steps), (unsigned long long)t->leaf_steps,
            y + 72, (unsigned long long)t->extent_tests, rt_plural(t->extent_tests), y + 88,
            (unsigned long long)t->object_tests, rt_plural(t->object_tests),
            (unsigned long long)t->object_hits);
}

/* Lines of the lower part: where `draw`, to d->out. Gives their number, MOST_ROWS at most, and to *left how
 * many rows of the path are not in them. */
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

static void draw_all(const Drawing *d, const char *title, const char *spec) {
    uint32_t left;
    double bars = TOP + SECTION + GAP, bottom = bars + ROW * draw_rows(d, bars, false, &left);
    fprintf(
        d->out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%.0f\" font-family=\"sans-serif\" "
        "font-size=\"11\">\n<defs><marker id=\"arrow\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" "
        "markerWidth=\"8\" "
        "markerHeight=\"8\" orient=\"auto\"><path d=\"M0 0 L8 4 L0 8 z\"/></marker></defs>\n"
        "<rect width=\"100%%\" height=\"100%%\" fill=\"#fff\"/>\n<text x=\"12\" y=\"24\" font-size=\"16\">",
        WIDTH, bottom + 30);
    rt_html_put(d->out, title);
    fputs("</text>\n<text x=\"12\" y=\"44\" fill=\"#555\">", d->out);
    rt_html_put(d->out, spec);
    fputs("</text>\n", d->out);
    draw_legend(d);
    draw_section(d);
    draw_axis(d, bars - 4, bottom);
    draw_rows(d, bars, true, &left);
    if (left > 0)
        fprintf(d->out, "<text x=\"12\" y=\"%.1f\">and %u more row%s</text>\n", bottom + 18, left,
                rt_plural(left));
    fputs("</svg>\n", d->out);
}

RtStatus rt_path_draw(const RtPath *path, const RtScene *scene, const char *title, const char *spec,
                      const char *file, RtError *error) {
    RtOutput output;
    Drawing drawing = {.path = path, .geometry = &scene->geometry};
    choose_plane(&drawing);
    choose_window(&drawing);
    RT_TRY(rt_output_open(&output, file, error));
    drawing.out = output.file;
    draw_all(&drawing, title, spec);
    return rt_output_commit(&output, error);
}
