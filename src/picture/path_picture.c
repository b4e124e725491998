/* SPDX-License-Identifier: Apache-2.0 */
/* The upper part is a section through the plane of the ray and the scene axis along which it moves least:
 * boxes are upright rectangles, spheres are circles, and the ray crosses exactly those that it passes
 * through, from left to right. It shows where objects are tested, and as much around it; if that is small, an
 * inset at the left shows the whole path. Objects that the ray does not test and leaves that it does not
 * visit are pale.
 *
 * What lies in the part of an instance is cut by the same plane there, and the drawing of that is distorted
 * as the instance is (enter_place).
 *
 * The lower part has a line for each row of the path, with bars where the ray is in its box, or in the solid
 * or part of a CSG tree. Section and bars share the x axis. */
#include "picture/pictures.h"

#include "core/base/memory.h"
#include "core/base/words.h"
#include "picture/section.h"

#include <float.h>

enum { WIDTH = 1000, LEFT = 250, MARGIN = 12, PLOT = WIDTH - LEFT - 20 }; /* of the common x axis, pixels */
enum { TOP = 64, SECTION = 450, INSET = 160, GAP = 46, ROW = 14, MOST_ROWS = 90, MOST_TICKS = 20 };
enum { FONT_SIZE = 11, TITLE_SIZE = 16 };

/* A rectangle of the picture that shows a part of the section around a point of the ray, in its middle. */
typedef struct Window {
    double x, y, width, height; /* pixels */
    RtSection section;
    double t; /* of section.on, on the ray */
} Window;

typedef struct Drawing {
    const RtPath *path;
    const RtGeometry *geometry;
    cairo_t *cairo;
    int axis;                /* of the scene, upright in the section */
    double speed;            /* of the ray to the right, units per t */
    double farthest;         /* the largest t that is drawn */
    Window detail, overview; /* overview.width is 0 if the detail shows the whole path */
    const Window *window;    /* being drawn: one of these */
    RtHitMemory *hit_memory;
} Drawing;

static const RtColor dark = {{85, 85, 85}}, light = {{153, 153, 153}}, hit_color = {{204, 0, 0}};
static const RtStyle untested = {{{170, 170, 170}}, 1, 0.2, false},
                     unvisited = {{{200, 200, 200}}, 0.6, 0, false};

/* ---- the section ---- */

static RtPoint point_at(const Drawing *d, const Window *window, double t) {
    const RtRay *ray = &d->path->ray;
    return rt_section_point(&window->section, rt_add_scaledd(rt_widen(ray->org), rt_widen(ray->dir), t));
}

static double x_of(const Drawing *d, double t) {
    return point_at(d, &d->detail, t).x;
}

static void choose_plane(Drawing *d) {
    RtSection plane = {.scale = 1};
    RtVec3d dir = rt_widen(d->path->ray.dir);
    for (int a = 1; a < 3; a++) {
        if (fabs(dir.at[a]) <= fabs(dir.at[d->axis])) d->axis = a;
    }
    plane.up.at[d->axis] = 1;
    dir.at[d->axis] = 0;
    d->speed = rt_lengthd(dir);
    plane.right = rt_scaled(dir, 1 / d->speed);
    plane.normal = rt_crossd(plane.right, plane.up);
    d->detail.section = d->overview.section = plane;
}

typedef struct Part {
    double first, last;
} Part;

static void include(Part *part, double t) {
    part->first = fmin(part->first, t);
    part->last = fmax(part->last, t);
}

#define NO_PART ((Part){(double)INFINITY, -(double)INFINITY})

/* From where the ray first enters anything, or from its origin on a surface, to where it last leaves
 * anything, or hits. */
static Part find_whole(const RtPath *path) {
    Part whole = NO_PART;
    for (uint32_t i = 0; i < path->count; i++) {
        const RtPathRow *row = &path->rows[i];
        if (!row->boxed || !(row->enter <= row->leave)) continue;
        include(&whole, row->enter);
        double end = row->round ? row->enter : row->leave; /* large balls extend far beyond their content */
        if (isfinite(end)) whole.last = fmax(whole.last, end);
    }
    if (isfinite((double)path->hit.t)) include(&whole, (double)path->hit.t);
    if (!(whole.first <= whole.last)) {
        whole.first = (double)path->ray.tmin;
        whole.last = isfinite((double)path->ray.tmax) ? (double)path->ray.tmax : whole.first + 1;
    }
    if (path->ray.kind != RT_RAY_PRIMARY) whole.first = fmin(whole.first, 0);
    double length = whole.last - whole.first;
    if (length <= 1e-6 * fabs(whole.last)) length = fmax(1e-3, 1e-3 * whole.first); /* room for ticks */
    return (Part){whole.first - 0.06 * length, whole.first + 1.04 * length};
}

/* The leaves in which objects are tested, and hits; tests outside leaves where the ray is in the object's
 * box. */
static Part find_tests(const RtPath *path) {
    Part tests = NO_PART;
    const RtPathRow *leaf = NULL; /* the last step, if it is one */
    for (uint32_t i = 0; i < path->count; i++) {
        const RtPathRow *row = &path->rows[i];
        if (row->kind == RT_TRACED_STEP) leaf = row->leaf && row->boxed ? row : NULL;
        if (row->kind != RT_TRACED_OBJECT_TEST) continue;
        if (row->met) include(&tests, (double)row->t);
        const RtPathRow *place = leaf ? leaf : row;
        if (place->boxed && place->enter <= place->leave) {
            include(&tests, place->enter);
            include(&tests, place->leave);
        }
    }
    return tests;
}

/* Shows the part in the middle of a window, and as much around it as fits. */
static void aim(const Drawing *d, Part part, Window *window) {
    const RtRay *ray = &d->path->ray;
    const double slope = fabs((double)ray->dir.at[d->axis]), length = part.last - part.first;
    RtSection *section = &window->section;
    section->scale = window->width / (length * d->speed);
    if (slope != 0) section->scale = fmin(section->scale, 0.8 * window->height / (length * slope));
    window->t = (part.first + part.last) / 2;
    section->on = rt_add_scaledd(rt_widen(ray->org), rt_widen(ray->dir), window->t);
    section->origin = (RtPoint){window->x + window->width / 2, window->y + window->height / 2};
}

/* The detail shows the tests and half of their length around them, but no less than a thirtieth of the path;
 * it shows the whole path if that is not much more. */
static void choose_windows(Drawing *d) {
    Part whole = find_whole(d->path), tests = find_tests(d->path), part = whole;
    double length = fmax(tests.last - tests.first, (whole.last - whole.first) / 60);
    d->farthest = whole.last;
    if (tests.first <= tests.last && 2 * length < 0.6 * (whole.last - whole.first)) {
        double middle = (tests.first + tests.last) / 2;
        part = (Part){middle - length, middle + length};
        aim(d, whole, &d->overview);
    } else {
        d->overview.width = 0;
    }
    aim(d, part, &d->detail);
}

/* ---- shapes ---- */

static RtColor row_color(const RtPath *path, uint32_t row) {
    return rt_color_scale(path->count > 1 ? 0.8 * row / (path->count - 1) : 0);
}

static bool is_missed(const RtPathRow *row) {
    return row->kind == RT_TRACED_EXTENT_TEST && !row->met;
}

/* Sets *section to the plane in the place's own coordinates, through the same point of the ray, and cairo's
 * matrix to how that looks from outside. Undo with cairo_restore. */
static void enter_place(const Drawing *d, const RtPathPlace *place, RtSection *section) {
    const RtSection *outside = &d->window->section;
    const RtTransform *m = &place->to_world;
    cairo_save(d->cairo);
    *section = *outside;
    if (place->level == 0) return;
    RtVec3d normal; /* of a plane: by the transposed matrix */
    for (int a = 0; a < 3; a++) normal.at[a] = rt_dotd(outside->normal, rt_transform_column(m, a));
    section->normal = rt_normalized(normal);
    section->right = rt_normalized(rt_widen(place->ray.dir));
    section->up = rt_crossd(section->normal, section->right);
    section->on = rt_add_scaledd(rt_widen(place->ray.org), rt_widen(place->ray.dir), d->window->t);
    section->origin = (RtPoint){0, 0};
    const RtVec3d zero = rt_transform_column(m, 3),
                  right = rt_subd(rt_transform_pointd(m, section->right), zero),
                  up = rt_subd(rt_transform_pointd(m, section->up), zero);
    const double size = rt_lengthd(right), by = outside->scale / (section->scale = outside->scale * size);
    cairo_transform(d->cairo,
                    &(cairo_matrix_t){rt_dotd(right, outside->right) * by, -rt_dotd(right, outside->up) * by,
                                      -rt_dotd(up, outside->right) * by, rt_dotd(up, outside->up) * by,
                                      outside->origin.x, outside->origin.y});
}

static void draw_extent(const Drawing *d, uint32_t i) {
    const RtPathRow *row = &d->path->rows[i];
    RtSection inside, *section = &inside;
    enter_place(d, &d->path->places[row->place], section);
    bool leaf = row->kind == RT_TRACED_STEP && row->leaf;
    if (row->round)
        rt_section_add_ball(section, d->cairo, row->ball.center, row->ball.radius);
    else
        rt_section_add_extent(section, d->cairo, &(RtBoxView){.box = &row->box});
    cairo_restore(d->cairo);
    if (is_missed(row))
        rt_paint(d->cairo, (RtStyle){light, 1, 0, true});
    else
        rt_paint(d->cairo, (RtStyle){row_color(d->path, i), leaf ? 1.5 : 1, leaf ? 0.12 : 0, false});
}

static void draw_object(const Drawing *d, const RtPathRow *row) {
    const RtPathPlace *place = &d->path->places[row->place];
    const RtGeometry *g = &place->scene->geometry;
    RtSection section;
    if (row->index >= g->object_count) return;
    enter_place(d, place, &section);
    rt_section_add_object(&section, d->cairo, g, row->index, d->hit_memory);
    cairo_restore(d->cairo);
    RtStyle style = row->met ? (RtStyle){hit_color, 2, 0.25, false} : (RtStyle){dark, 1, 0.1, false};
    if (rt_is_instance(g, row->index)) style.opacity = 0; /* more is drawn inside */
    rt_paint(d->cairo, style);
}

/* ---- what the ray does not visit ---- */

/* Does the plane cut the box in the window, in more than `least` pixels? */
static bool is_seen(const Drawing *d, const RtBox *box, double least) {
    const Window *w = d->window;
    RtPoint corners[RT_MAX_CORNERS], lo = {(double)INFINITY, (double)INFINITY}, hi = {-lo.x, -lo.y};
    const uint32_t count = rt_section_cut(&w->section, &(RtBoxView){.box = box}, corners);
    for (uint32_t i = 0; i < count; i++) {
        lo = (RtPoint){fmin(lo.x, corners[i].x), fmin(lo.y, corners[i].y)};
        hi = (RtPoint){fmax(hi.x, corners[i].x), fmax(hi.y, corners[i].y)};
    }
    return fmax(hi.x - lo.x, hi.y - lo.y) > least && hi.x > w->x && lo.x < w->x + w->width && hi.y > w->y &&
           lo.y < w->y + w->height;
}

/* As rows show it: a sphere, or a box. */
static void add_leaf(void *context, const RtBoxView *view) {
    const Drawing *d = context;
    const double least = 5; /* smaller ones would only darken the picture */
    RtBoxView shown = *view;
    if (!view->leaf || !is_seen(d, view->box, least)) return;
    if (rt_outline_kind(view) != RT_EXTENT_SPHERE) shown.extents = NULL;
    rt_section_add_extent(&d->window->section, d->cairo, &shown);
}

/* The layer whose boxes a ray visits, or NULL. */
static const RtAccel *layer_of(const RtPath *path) {
    const RtAccel *layer = path->accel;
    while (layer && !layer->ops->each_box &&
           (path->tally.passed_on > 0 || !(layer->ops->kinds >> path->ray.kind & 1)))
        layer = layer->below;
    return layer && layer->ops->each_box ? layer : NULL;
}

static void draw_surroundings(const Drawing *d) {
    const RtAccel *layer = layer_of(d->path);
    for (uint32_t id = 0; id < d->geometry->object_count; id++) {
        if (is_seen(d, &d->geometry->boxes[id], 0.5))
            rt_section_add_object(&d->window->section, d->cairo, d->geometry, id, d->hit_memory);
    }
    rt_paint(d->cairo, untested);
    if (!layer) return;
    layer->ops->each_box(layer, (RtBoxViewer){add_leaf, (void *)d});
    rt_paint(d->cairo, unvisited);
}

/* ---- the windows ---- */

static void draw_ray(const Drawing *d) {
    const RtRay *ray = &d->path->ray;
    const Window *w = d->window;
    const double left = (w->x - point_at(d, w, 0).x) / (w->section.scale * d->speed); /* t at the left side */
    const double hit = (double)d->path->hit.t, last = fmin(fmin((double)ray->tmax, d->farthest), hit);
    const RtPoint from = point_at(d, w, fmax((double)ray->tmin, left)), to = point_at(d, w, last);
    const double dx = from.x - to.x, dy = from.y - to.y;
    const double back = isfinite(hit) ? fmin(5.5 / sqrt(dx * dx + dy * dy), 1) : 0; /* the dot's rim */
    const RtPoint tip = {to.x + back * dx, to.y + back * dy};
    rt_add_line(d->cairo, from, tip);
    rt_paint(d->cairo, (RtStyle){RT_BLACK, 1.5, 0, false});
    rt_draw_arrow_head(d->cairo, from, tip, d->window == &d->detail ? 12 : 7, RT_BLACK);
    if (ray->kind != RT_RAY_PRIMARY) rt_draw_disc(d->cairo, point_at(d, w, 0), 4, RT_BLACK);
    if (!isfinite(hit)) return;
    rt_draw_disc(d->cairo, to, 5.5, RT_WHITE);
    rt_draw_disc(d->cairo, to, 4.5, hit_color);
}

static void draw_window(Drawing *d, const Window *w) {
    const RtPath *path = d->path;
    d->window = w;
    cairo_save(d->cairo);
    cairo_rectangle(d->cairo, w->x, w->y, w->width, w->height);
    cairo_clip(d->cairo);
    draw_surroundings(d);
    for (uint32_t i = 0; i < path->count; i++) {
        if (path->rows[i].boxed && path->rows[i].kind != RT_TRACED_OBJECT_TEST) draw_extent(d, i);
    }
    for (uint32_t i = 0; i < path->count; i++) {
        if (path->rows[i].kind == RT_TRACED_OBJECT_TEST) draw_object(d, &path->rows[i]);
    }
    draw_ray(d);
    cairo_restore(d->cairo);
    cairo_rectangle(d->cairo, w->x + 0.5, w->y + 0.5, w->width - 1, w->height - 1);
    rt_paint(d->cairo, (RtStyle){light, 1, 0, false});
}

/* The whole path, with the outline of the detail. */
static void draw_overview(Drawing *d) {
    const Window *w = &d->overview, *detail = &d->detail;
    const double size = w->section.scale / detail->section.scale;
    const RtPoint middle = rt_section_point(&w->section, detail->section.on);
    draw_window(d, w);
    const double left = fmax(middle.x - detail->width / 2 * size, w->x);
    const double right = fmin(middle.x + detail->width / 2 * size, w->x + w->width);
    const double top = fmax(middle.y - detail->height / 2 * size, w->y);
    const double bottom = fmin(middle.y + detail->height / 2 * size, w->y + w->height);
    cairo_rectangle(d->cairo, left, top, right - left, bottom - top);
    rt_paint(d->cairo, (RtStyle){RT_BLACK, 1.5, 0, false});
}

/* ---- the rows ---- */

/* A mark at the edge on the side where the bar would be. */
static void draw_beyond(const Drawing *d, double y, bool right, RtColor color) {
    double tip = right ? LEFT + PLOT - 1 : LEFT + 1, base = right ? tip - 5 : tip + 5, middle = y + ROW / 2.0;
    rt_add_polygon(d->cairo, (RtPoint[]){{tip, middle}, {base, middle - 3}, {base, middle + 3}}, 3);
    rt_paint(d->cairo, (RtStyle){color, 0, 1, false});
}

/* Interval `span` of row `i`. A bar that goes on beyond the axis is open there. */
static void draw_bar(const Drawing *d, uint32_t i, uint32_t span, double y) {
    const RtPathRow *row = &d->path->rows[i];
    const double end = LEFT + PLOT, top = y + 3, bottom = y + ROW - 3;
    double enter, leave;
    rt_path_row_span(d->path, row, span, &enter, &leave);
    enter = fmax(enter, (double)d->path->ray.tmin), leave = fmin(leave, (double)FLT_MAX);
    if (!(enter <= leave)) return;
    double from = x_of(d, enter), to = fmax(x_of(d, leave), from + 1);
    RtStyle style = {row_color(d->path, i), 1, 0, is_missed(row)};
    if (is_missed(row)) style.color = light;
    if (row->kind == RT_TRACED_OBJECT_TEST) style.color = dark;
    if (row->kind == RT_TRACED_STEP) style.opacity = row->leaf ? 0.7 : 0.25;
    if (row->listed) style.opacity = row->kind == RT_TRACED_CSG_RESULT ? 0.7 : 0.25;
    if (to < LEFT || from > end) {
        draw_beyond(d, y, from > end, style.color);
        return;
    }
    bool starts = from >= LEFT, ends = to <= end;
    from = fmax(from, LEFT), to = fmin(to, end);
    cairo_rectangle(d->cairo, from, top, to - from, bottom - top);
    rt_paint(d->cairo, (RtStyle){style.color, 0, style.opacity, false});
    cairo_move_to(d->cairo, from, bottom);
    (starts ? cairo_line_to : cairo_move_to)(d->cairo, from, top);
    cairo_line_to(d->cairo, to, top);
    (ends ? cairo_line_to : cairo_move_to)(d->cairo, to, bottom);
    cairo_line_to(d->cairo, from, bottom);
    style.opacity = 0;
    rt_paint(d->cairo, style);
}

static void draw_bars(const Drawing *d, uint32_t i, double y) {
    for (uint32_t span = 0; span < rt_path_row_spans(&d->path->rows[i]); span++) draw_bar(d, i, span, y);
}

static void draw_row(const Drawing *d, uint32_t i, double y) {
    const RtPathRow *row = &d->path->rows[i];
    bool object = row->kind == RT_TRACED_OBJECT_TEST;
    char of[128] = "";
    if (row->kind == RT_TRACED_PASSED_ON)
        snprintf(of, sizeof of, " by %s", row->what);
    else if (*row->what)
        snprintf(of, sizeof of, ", %s %u", row->what, rt_path_row_index(d->path, row));
    const char *result = row->listed && row->end_count == 0 ? ": empty"
                         : !rt_path_row_answers(row)        ? ""
                         : row->met                         ? ": hit"
                                                            : ": missed";
    const int indent = 3 * (int)row->level;
    rt_draw_text(d->cairo, MARGIN, y + ROW - 3, RT_BLACK, "%u  %*s%s%s%s", i + 1, indent, "",
                 rt_path_row_name(row), of, result);
    draw_bars(d, i, y);
    if (object && row->met)
        rt_draw_disc(d->cairo, (RtPoint){x_of(d, (double)row->t), y + ROW / 2.0}, 4, hit_color);
}

static void draw_run(const Drawing *d, uint32_t first, uint32_t run, double y) {
    rt_draw_text(d->cairo, MARGIN, y + ROW - 3, RT_BLACK, "%u to %u  %u object tests: missed", first + 1,
                 first + run, run);
    for (uint32_t i = first; i < first + run; i++) draw_bars(d, i, y);
}

static void draw_nearest(const Drawing *d, const RtPathRow *row, double y) {
    if (!isfinite((double)row->nearest)) return;
    double x = x_of(d, (double)row->nearest);
    if (x < LEFT || x > LEFT + PLOT) return;
    rt_add_line(d->cairo, (RtPoint){x, y}, (RtPoint){x, y + ROW});
    rt_paint(d->cairo, (RtStyle){hit_color, 1.5, 0, false});
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

static void draw_axis(const Drawing *d, double y, double bottom) {
    const double per_t = d->detail.section.scale * d->speed; /* pixels */
    double from = (LEFT - x_of(d, 0)) / per_t, to = from + PLOT / per_t, step = 1;
    while (step > (to - from) / 5) step /= 10;
    while (step * 10 < (to - from) / 5) step *= 10;
    if (5 * step < (to - from) / 3)
        step *= 5;
    else if (2 * step < (to - from) / 4)
        step *= 2;
    double first = ceil(from / step);
    for (int i = 0; i < MOST_TICKS && (first + i) * step <= to; i++) {
        double t = (first + i) * step + 0.0, x = floor(x_of(d, t)) + 0.5;
        char text[32];
        snprintf(text, sizeof text, "t = %.6g", t);
        rt_add_line(d->cairo, (RtPoint){x, y}, (RtPoint){x, bottom});
        rt_paint(d->cairo, (RtStyle){{{221, 221, 221}}, 1, 0, false});
        rt_draw_text(d->cairo, x - rt_text_width(d->cairo, text) / 2, y - 4, dark, "%s", text);
    }
}

/* ---- the legend ---- */

static void draw_legend(const Drawing *d) {
    const struct {
        RtStyle style;
        const char *text;
    } keys[] = {{{{{59, 82, 139}}, 1, 0, false}, "extent hit, or inner node"},
                {{light, 1, 0, true}, "extent missed"},
                {{{{33, 145, 140}}, 1, 0.4, false}, "step, leaf"},
                {{dark, 1, 0.1, false}, "object tested"},
                {{hit_color, 1, 0.25, false}, "object hit"},
                {{hit_color, 0, 1, false}, "nearest t so far"},
                {untested, "object not tested"},
                {unvisited, "leaf not visited"}};
    enum { COUNT = sizeof keys / sizeof keys[0] };
    const RtTally *t = &d->path->tally;
    double y = TOP;
    for (int i = 0; i < COUNT; i++, y += 18) {
        cairo_rectangle(d->cairo, MARGIN + 0.5, y + 0.5, keys[i].style.width > 0 ? 18 : 2, 11);
        rt_paint(d->cairo, keys[i].style);
        rt_draw_text(d->cairo, MARGIN + 26, y + 10, RT_BLACK, "%s", keys[i].text);
    }
    rt_draw_text(d->cairo, MARGIN, y + 10, RT_BLACK, "dark: visited first, light: last");
    rt_draw_text(d->cairo, MARGIN, y + 26, RT_BLACK, "%c is up", "xyz"[d->axis]);
    rt_draw_text(d->cairo, MARGIN, y + 48, RT_BLACK, "%llu step%s, %llu of them in leaves",
                 (unsigned long long)t->steps, rt_plural(t->steps), (unsigned long long)t->leaf_steps);
    rt_draw_text(d->cairo, MARGIN, y + 64, RT_BLACK, "%llu extent test%s",
                 (unsigned long long)t->extent_tests, rt_plural(t->extent_tests));
    rt_draw_text(d->cairo, MARGIN, y + 80, RT_BLACK, "%llu object test%s, %llu hit%s",
                 (unsigned long long)t->object_tests, rt_plural(t->object_tests),
                 (unsigned long long)t->object_hits, rt_plural(t->object_hits));
    if (d->overview.width > 0)
        rt_draw_text(d->cairo, MARGIN, d->overview.y - 6, RT_BLACK, "the whole path; framed: the part drawn");
}

static void draw(Drawing *d, const char *title, const char *spec, double bars, double bottom) {
    uint32_t left;
    rt_draw_text_within(d->cairo, MARGIN, 24, WIDTH - 2 * MARGIN, RT_BLACK, title);
    cairo_set_font_size(d->cairo, FONT_SIZE);
    rt_draw_text_within(d->cairo, MARGIN, 44, WIDTH - 2 * MARGIN, dark, spec);
    draw_legend(d);
    draw_window(d, &d->detail);
    if (d->overview.width > 0) draw_overview(d);
    draw_axis(d, bars - 4, bottom);
    draw_rows(d, bars, true, &left);
    if (left > 0)
        rt_draw_text(d->cairo, MARGIN, bottom + 18, RT_BLACK, "and %u more row%s", left, rt_plural(left));
}

RtStatus rt_path_draw(const RtPath *path, const RtScene *scene, const char *title, const char *spec,
                      const char *file, RtError *error) {
    RtCanvas canvas;
    uint32_t left;
    Drawing d = {.path = path,
                 .geometry = &scene->geometry,
                 .detail = {LEFT, TOP, PLOT, SECTION, {.scale = 1}, 0},
                 .overview = {MARGIN, TOP + SECTION - INSET, LEFT - 2 * MARGIN, INSET, {.scale = 1}, 0}};
    choose_plane(&d);
    choose_windows(&d);
    const double bars = TOP + SECTION + GAP, bottom = bars + ROW * draw_rows(&d, bars, false, &left);
    RT_TRY(rt_canvas_open(&canvas, file, WIDTH, bottom + 30, TITLE_SIZE, error));
    d.cairo = canvas.cairo;
    RtStatus status = rt_hit_memory_alloc(d.geometry, &d.hit_memory, error);
    if (status == RT_OK) draw(&d, title, spec, bars, bottom);
    if (status == RT_OK && path->accel) status = rt_accel_check(path->accel, error);
    rt_free(d.hit_memory);
    return rt_canvas_close(&canvas, status, error);
}
