/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/path_section.h"

#include "core/base/memory.h"
#include "picture/extent_outline.h"
#include "picture/section.h"

enum { FAR = 1000 }; /* pixels beyond a window at which lines may end */

/* An interval of t. */
typedef struct Part {
    double first, last;
} Part;

/* ---- the plane ---- */

/* The plane as the window shows it. */
static RtSection plane_of(const RtPathSection *s) {
    const RtPathWindow *w = s->window;
    RtSection plane = {.on = rt_add_scaledd(s->org, s->along, w->s0),
                       .right = s->along,
                       .normal = s->normal,
                       .origin = {w->x, w->y},
                       .scale = w->scale};
    plane.on.at[s->axis] = w->v0;
    plane.up.at[s->axis] = 1;
    return plane;
}

static void add_ball(const RtPathSection *s, RtVec3d center, double radius) {
    const RtSection plane = plane_of(s);
    rt_section_add_ball(&plane, s->cairo, center, radius);
}

static void add_object(const RtPathSection *s, uint32_t id) {
    const RtSection plane = plane_of(s);
    rt_section_add_object(&plane, s->cairo, s->geometry, id, s->crossings);
}

static double x_of(const RtPathSection *s, double distance) {
    return s->window->x + (distance - s->window->s0) * s->window->scale;
}

static double y_of(const RtPathSection *s, double v) {
    return s->window->y + (s->window->v0 - v) * s->window->scale;
}

static RtPoint point_on_ray(const RtPathSection *s, double t) {
    return (RtPoint){x_of(s, t * s->speed),
                     y_of(s, s->org.at[s->axis] + t * (double)s->path->ray.dir.at[s->axis])};
}

static void choose_plane(RtPathSection *s) {
    RtVec3d dir = rt_widen(s->path->ray.dir);
    s->org = rt_widen(s->path->ray.org);
    s->axis = 0;
    for (int a = 1; a < 3; a++) {
        if (fabs(dir.at[a]) <= fabs(dir.at[s->axis])) s->axis = a;
    }
    RtVec3d up = {{0, 0, 0}};
    up.at[s->axis] = 1;
    dir.at[s->axis] = 0;
    s->speed = rt_lengthd(dir);
    s->along = rt_scaled(dir, 1 / s->speed);
    s->normal = rt_crossd(s->along, up);
}

/* The interval of s in which the plane is inside the box, at any height; false if there is none. */
static bool section_of_box(const RtPathSection *s, const RtBox *box, double *from, double *to) {
    *from = -(double)INFINITY, *to = (double)INFINITY;
    for (int a = 0; a < 3; a++) {
        double lo = (double)box->lo.at[a] - s->org.at[a], hi = (double)box->hi.at[a] - s->org.at[a];
        if (a == s->axis) continue;
        if (s->along.at[a] == 0) {
            if (lo > 0 || hi < 0) return false;
            continue;
        }
        *from = fmax(*from, fmin(lo / s->along.at[a], hi / s->along.at[a]));
        *to = fmin(*to, fmax(lo / s->along.at[a], hi / s->along.at[a]));
    }
    return *from <= *to;
}

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

/* Sets what a window shows: the part in its middle, and as much around it as fits. */
static void aim(const RtPathSection *s, Part part, RtPathWindow *window) {
    double slope = (double)s->path->ray.dir.at[s->axis], length = part.last - part.first;
    double middle = (part.first + part.last) / 2;
    window->scale = window->width / (length * s->speed);
    if (slope != 0) window->scale = fmin(window->scale, 0.8 * window->height / (length * fabs(slope)));
    window->s0 = middle * s->speed - window->width / 2 / window->scale;
    window->v0 = s->org.at[s->axis] + slope * middle + window->height / 2 / window->scale;
}

/* The detail shows the tests and half of their length around them, but no less than a thirtieth of the path;
 * it shows the whole path if that is not much more. */
static void choose_windows(RtPathSection *s) {
    Part whole = find_whole(s->path), tests = find_tests(s->path), part = whole;
    double length = fmax(tests.last - tests.first, (whole.last - whole.first) / 60);
    s->farthest = whole.last;
    if (tests.first <= tests.last && 2 * length < 0.6 * (whole.last - whole.first)) {
        double middle = (tests.first + tests.last) / 2;
        part = (Part){middle - length, middle + length};
        aim(s, whole, &s->overview);
    } else {
        s->overview.width = 0;
    }
    aim(s, part, &s->detail);
}

void rt_path_section_init(RtPathSection *section, const RtPath *path, const RtGeometry *geometry) {
    section->path = path;
    section->geometry = geometry;
    choose_plane(section);
    choose_windows(section);
}

double rt_path_section_x(const RtPathSection *s, double t) {
    return s->detail.x + (t * s->speed - s->detail.s0) * s->detail.scale;
}

/* ---- shapes ---- */

RtColor rt_path_row_color(const RtPath *path, uint32_t row) {
    return rt_color_scale(path->count > 1 ? 0.8 * row / (path->count - 1) : 0);
}

/* Adds the rectangle in which the plane cuts a box, which may be infinite. */
static void add_box(const RtPathSection *s, const RtBox *box) {
    double from, to;
    if (!section_of_box(s, box, &from, &to)) return;
    double left = rt_clampd(x_of(s, from), -FAR, 2 * FAR), right = rt_clampd(x_of(s, to), -FAR, 2 * FAR);
    double top = rt_clampd(y_of(s, (double)box->hi.at[s->axis]), -FAR, 2 * FAR);
    double bottom = rt_clampd(y_of(s, (double)box->lo.at[s->axis]), -FAR, 2 * FAR);
    cairo_rectangle(s->cairo, left, top, right - left, bottom - top);
}

bool rt_path_row_is_missed(const RtPathRow *row) {
    return row->kind == RT_TRACED_EXTENT_TEST && !row->met;
}

static void draw_extent(const RtPathSection *s, uint32_t i) {
    const RtPathRow *row = &s->path->rows[i];
    bool leaf = row->kind == RT_TRACED_STEP && row->leaf;
    if (row->round)
        add_ball(s, row->ball.center, row->ball.radius);
    else
        add_box(s, &row->box);
    if (rt_path_row_is_missed(row))
        rt_paint(s->cairo, (RtStyle){RT_PATH_LIGHT, 1, 0, true});
    else
        rt_paint(s->cairo, (RtStyle){rt_path_row_color(s->path, i), leaf ? 1.5 : 1, leaf ? 0.12 : 0, false});
}

static void draw_object(const RtPathSection *s, const RtPathRow *row) {
    if (row->index >= s->geometry->object_count) return;
    add_object(s, row->index);
    rt_paint(s->cairo,
             row->met ? (RtStyle){RT_PATH_HIT, 2, 0.25, false} : (RtStyle){RT_PATH_DARK, 1, 0.1, false});
}

/* ---- what the ray does not visit ---- */

/* Does the plane cut the box in the window, in more than `least` pixels? */
static bool is_seen(const RtPathSection *s, const RtBox *box, double least) {
    const RtPathWindow *w = s->window;
    double from, to;
    if (!section_of_box(s, box, &from, &to)) return false;
    double left = x_of(s, from), right = x_of(s, to);
    double top = y_of(s, (double)box->hi.at[s->axis]), bottom = y_of(s, (double)box->lo.at[s->axis]);
    return fmax(right - left, bottom - top) > least && right > w->x && left < w->x + w->width &&
           bottom > w->y && top < w->y + w->height;
}

static void add_leaf(void *context, const RtBoxView *view) {
    const RtPathSection *s = context;
    const double least = 5; /* smaller ones would only darken the picture */
    if (!view->leaf || !is_seen(s, view->box, least)) return;
    if (rt_outline_kind(view) == RT_EXTENT_SPHERE)
        add_ball(s, view->extents->balls[view->extent].center, view->extents->balls[view->extent].radius);
    else
        add_box(s, view->box);
}

/* The layer whose boxes a ray visits, or NULL. */
static const RtAccel *layer_of(const RtPath *path) {
    const RtAccel *layer = path->accel;
    while (layer && !layer->ops->each_box &&
           (path->tally.passed_on > 0 || !(layer->ops->kinds >> path->ray.kind & 1)))
        layer = layer->below;
    return layer && layer->ops->each_box ? layer : NULL;
}

static void draw_surroundings(const RtPathSection *s) {
    const RtAccel *layer = layer_of(s->path);
    for (uint32_t id = 0; id < s->geometry->object_count; id++) {
        if (is_seen(s, &s->geometry->boxes[id], 0.5)) add_object(s, id);
    }
    rt_paint(s->cairo, RT_PATH_UNTESTED);
    if (!layer) return;
    layer->ops->each_box(layer, (RtBoxViewer){add_leaf, (void *)s});
    rt_paint(s->cairo, RT_PATH_UNVISITED);
}

/* ---- the windows ---- */

static void draw_arrow(const RtPathSection *s, RtPoint from, RtPoint to) {
    rt_add_line(s->cairo, from, to);
    rt_paint(s->cairo, (RtStyle){RT_BLACK, 1.5, 0, false});
    rt_draw_arrow_head(s->cairo, from, to, 12, RT_BLACK);
}

static void draw_ray(const RtPathSection *s) {
    const RtRay *ray = &s->path->ray;
    double from = fmax((double)ray->tmin, s->window->s0 / s->speed), hit = (double)s->path->hit.t;
    double to = fmin(fmin((double)ray->tmax, s->farthest), hit);
    draw_arrow(s, point_on_ray(s, from), point_on_ray(s, to));
    if (ray->kind != RT_RAY_PRIMARY) rt_draw_disc(s->cairo, point_on_ray(s, 0), 4, RT_BLACK);
    if (!isfinite(hit)) return;
    rt_draw_disc(s->cairo, point_on_ray(s, hit), 5.5, RT_WHITE);
    rt_draw_disc(s->cairo, point_on_ray(s, hit), 4.5, RT_PATH_HIT);
}

static void draw_section(const RtPathSection *s) {
    const RtPath *path = s->path;
    const RtPathWindow *w = s->window;
    cairo_save(s->cairo);
    cairo_rectangle(s->cairo, w->x, w->y, w->width, w->height);
    cairo_clip(s->cairo);
    draw_surroundings(s);
    for (uint32_t i = 0; i < path->count; i++) {
        if (path->rows[i].boxed && path->rows[i].kind != RT_TRACED_OBJECT_TEST) draw_extent(s, i);
    }
    for (uint32_t i = 0; i < path->count; i++) {
        if (path->rows[i].kind == RT_TRACED_OBJECT_TEST) draw_object(s, &path->rows[i]);
    }
    draw_ray(s);
    cairo_restore(s->cairo);
    cairo_rectangle(s->cairo, w->x + 0.5, w->y + 0.5, w->width - 1, w->height - 1);
    rt_paint(s->cairo, (RtStyle){RT_PATH_LIGHT, 1, 0, false});
}

/* Both windows, after what they need has been allocated. */
static void draw_windows(RtPathSection *section) {
    const RtPathWindow *detail = &section->detail;
    cairo_t *cairo = section->cairo;
    section->window = detail;
    draw_section(section);
    if (section->overview.width == 0) return;
    section->window = &section->overview;
    draw_section(section);
    const RtPathWindow *w = &section->overview;
    double size = w->scale / detail->scale, x = x_of(section, detail->s0), y = y_of(section, detail->v0);
    double left = fmax(x, w->x), top = fmax(y, w->y);
    cairo_rectangle(cairo, left, top, fmin(x + detail->width * size, w->x + w->width) - left,
                    fmin(y + detail->height * size, w->y + w->height) - top);
    rt_paint(cairo, (RtStyle){RT_BLACK, 1.5, 0, false});
}

RtStatus rt_path_section_draw(RtPathSection *section, cairo_t *cairo, RtError *error) {
    section->cairo = cairo;
    RT_TRY(rt_crossings_alloc(section->geometry, &section->crossings, error));
    draw_windows(section);
    rt_free(section->crossings);
    return section->path->accel ? rt_accel_check(section->path->accel, error) : RT_OK;
}
