/* SPDX-License-Identifier: Apache-2.0 */
/* The upper part is a section through a plane that contains the primary ray, turned about it so that the rays
 * that follow lie as close to it as they can: those of a ball lie in it. Rays that leave it are projected
 * onto it. The window shows the hits. The lower part has a row for each ray. */
#include "picture/pictures.h"

#include "core/base/memory.h"
#include "core/base/words.h"
#include "picture/section.h"

#include <stdio.h>

enum { WIDTH = 1000, MARGIN = 12, TOP = 60, LEAST = 260, MOST = 560, ROW = 17, MOST_ROWS = 60 };
enum { FONT_SIZE = 12, TITLE_SIZE = 16, KEYS = 40, INDENT = 16 };
enum { BESIDE = 6 };             /* pixels from the plane */
static const double slant = 0.1; /* sine of the angle with the plane */
enum { CONTEXT = 20000 };        /* objects up to which those that no ray hits are drawn, too */

typedef struct Drawing {
    const RtRayTree *tree;
    const RtScene *scene;
    cairo_t *cairo;
    RtSection section;
    RtHitMemory *hit_memory;
    double width, height; /* of the section, pixels */
} Drawing;

static const RtColor dark = {{85, 85, 85}}, pale = {{205, 205, 205}};

/* Colours that colour-blind readers can tell apart (Okabe & Ito 2008). */
enum { PRIMARY, REFLECTION, TRANSMISSION, LIT, BLOCKED, NORMAL, STYLES };
static const struct {
    RtStyle style;
    const char *text;
} styles[STYLES] = {{{{{0, 0, 0}}, 2, 0, false}, "primary ray"},
                    {{{{0, 114, 178}}, 2, 0, false}, "reflection"},
                    {{{{0, 158, 115}}, 2, 0, false}, "transmission"},
                    {{{{230, 159, 0}}, 1.5, 0, true}, "shadow ray, lit"},
                    {{{{213, 94, 0}}, 1.5, 0, true}, "shadow ray, blocked"},
                    {{{{120, 120, 120}}, 1, 0, false}, "normal"}};

static int style_of(const RtTreeRay *ray) {
    if (ray->ray.kind == RT_RAY_SHADOW) return ray->hit.object == RT_NO_OBJECT ? LIT : BLOCKED;
    return ray->ray.kind == RT_RAY_REFLECTION     ? REFLECTION
           : ray->ray.kind == RT_RAY_TRANSMISSION ? TRANSMISSION
                                                  : PRIMARY;
}

/* ---- the plane ---- */

static RtVec3d direction_of(const RtTreeRay *ray) {
    return rt_normalized(rt_widen(ray->ray.dir));
}

/* Where the ray ends; of one that hits nothing, its origin. */
static RtVec3d end_of(const RtTreeRay *ray) {
    return rt_ray_point(&ray->ray, isfinite((double)ray->hit.t) ? ray->hit.t : 0);
}

static RtVec3d across(RtVec3d along, RtVec3d wish) {
    RtVec3d rest = rt_add_scaledd(wish, along, -rt_dotd(wish, along));
    if (rt_lengthd(rest) > 1e-3) return rt_normalized(rest);
    RtVec3d axis = {{0, 0, 0}};
    axis.at[fabs(along.x) < 0.7 ? 0 : 1] = 1;
    return across(along, axis);
}

/* The normal, across the primary ray, to which the directions of the other rays are closest to perpendicular:
 * least squares, weighted by how much each matters. */
static RtVec3d choose_normal(const Drawing *d, RtVec3d along, RtVec3d up) {
    const RtVec3d v = across(along, up), u = rt_crossd(along, v);
    double uu = 0, uv = 0, vv = 0;
    for (uint32_t i = 1; i < d->tree->count; i++) {
        const RtTreeRay *ray = &d->tree->rays[i];
        double weight = (double)ray->factor / ((double)ray->level * ray->level);
        if (ray->ray.kind == RT_RAY_SHADOW) weight /= 100;
        double x = rt_dotd(direction_of(ray), u), y = rt_dotd(direction_of(ray), v);
        uu += weight * x * x, uv += weight * x * y, vv += weight * y * y;
    }
    /* The eigenvector of the smaller eigenvalue. */
    double half = (uu - vv) / 2, root = sqrt(half * half + uv * uv);
    double x = half <= 0 ? root - half : -uv, y = half <= 0 ? -uv : root + half;
    if (!(root > 1e-12)) return u;
    return rt_normalized(rt_addd(rt_scaled(u, x), rt_scaled(v, y)));
}

static void choose_plane(Drawing *d) {
    const RtTreeRay *primary = &d->tree->rays[0];
    RtVec3d along = direction_of(primary), up = rt_widen(d->scene->camera.up);
    RtSection *s = &d->section;
    s->on = end_of(primary);
    s->normal = choose_normal(d, along, up);
    s->up = across(s->normal,
                   fabs(rt_dotd(rt_normalized(up), s->normal)) < 0.9 ? up : rt_crossd(s->normal, along));
    s->right = rt_crossd(s->up, s->normal);
    if (rt_dotd(s->right, along) >= 0) return;
    s->right = rt_scaled(s->right, -1);
    s->normal = rt_scaled(s->normal, -1);
}

/* ---- the window ---- */

typedef struct Window { /* in units of the scene, downward like pixels */
    double left, right, top, bottom;
} Window;

static void include(Window *window, RtPoint p, double around) {
    window->left = fmin(window->left, p.x - around), window->right = fmax(window->right, p.x + around);
    window->top = fmin(window->top, p.y - around), window->bottom = fmax(window->bottom, p.y + around);
}

static double span_of(const Window *w) {
    return fmax(w->right - w->left, w->bottom - w->top);
}

/* A hit that the window should hold: light comes from it. */
static bool matters(const RtTreeRay *ray) {
    return ray->surface.material && (ray->factor >= 0.1f || ray->level == 1);
}

/* Of a ray that hits nothing: it and the scene. */
static Window window_of_miss(const Drawing *d) {
    const RtBox *box = &d->scene->geometry.box;
    const RtVec3d lo = rt_widen(box->lo), hi = rt_widen(box->hi);
    Window window = {0, 0, 0, 0};
    include(&window, rt_section_point(&d->section, rt_scaled(rt_addd(lo, hi), 0.5)),
            rt_lengthd(rt_subd(hi, lo)) / 2);
    return window;
}

/* Holds the hits, objects there of the size of their region, and a part of the primary ray. */
static Window find_window(const Drawing *d) {
    const RtTreeRay *primary = &d->tree->rays[0];
    if (primary->hit.object == RT_NO_OBJECT) return window_of_miss(d);
    const double far = (double)primary->hit.t * rt_lengthd(rt_widen(primary->ray.dir));
    Window window = {0, 0, 0, 0}; /* the end of the primary ray */
    for (uint32_t i = 0; i < d->tree->count; i++) {
        if (matters(&d->tree->rays[i]))
            include(&window, rt_section_point(&d->section, end_of(&d->tree->rays[i])), 0);
    }
    const double most = span_of(&window) > 1e-4 * far ? 2 * span_of(&window) : far / 4;
    for (uint32_t i = 0; i < d->tree->count; i++) {
        const uint32_t id = d->tree->rays[i].hit.object;
        if (!matters(&d->tree->rays[i])) continue;
        const RtShape shape = rt_ref_shape(d->scene->geometry.objects[id]);
        const RtBall ball = rt_object_ball(&d->scene->geometry, id);
        if (shape != RT_SHAPE_POLYGON && shape != RT_SHAPE_TRIANGLE && ball.radius <= most)
            include(&window, rt_section_point(&d->section, ball.center), ball.radius);
    }
    const double span = span_of(&window) > 1e-4 * far ? span_of(&window) : far / 4;
    const RtVec3d before = rt_add_scaledd(d->section.on, direction_of(primary), -span / 2);
    include(&window, rt_section_point(&d->section, before), 0);
    include(&window, (RtPoint){0, 0}, span / 8);
    return window;
}

static void choose_window(Drawing *d) {
    d->section.scale = 1;
    const Window w = find_window(d);
    const double across = 1.1 * (w.right - w.left), down = 1.1 * (w.bottom - w.top);
    d->width = WIDTH - 2 * MARGIN;
    d->height = rt_clampd(d->width * down / across, LEAST, MOST);
    d->section.scale = fmin(d->width / across, d->height / down);
    d->section.origin.x = MARGIN + d->width / 2 - (w.left + w.right) / 2 * d->section.scale;
    d->section.origin.y = TOP + d->height / 2 - (w.top + w.bottom) / 2 * d->section.scale;
}

/* ---- objects ---- */

static RtColor color_of(RtVec3 linear) {
    return (RtColor){{rt_srgb(linear.x), rt_srgb(linear.y), rt_srgb(linear.z)}};
}

static void draw_object(const Drawing *d, uint32_t id, bool met) {
    const RtScene *scene = d->scene;
    rt_section_add_object(&d->section, d->cairo, &scene->geometry, id, d->hit_memory);
    if (met) {
        RtColor color = color_of(scene->materials[scene->material_of[id]].color);
        cairo_path_t *outline = cairo_copy_path(d->cairo);
        rt_paint(d->cairo, (RtStyle){color, 0, 0.3, false});
        cairo_append_path(d->cairo, outline);
        cairo_path_destroy(outline);
    }
    rt_paint(d->cairo, met ? (RtStyle){dark, 2, 0, false} : (RtStyle){pale, 1, 0, false});
}

/* Those that rays hit over the others. */
static RtStatus draw_objects(const Drawing *d, RtError *error) {
    RT_ARENA(arena);
    const uint32_t count = d->scene->geometry.object_count;
    bool *met = rt_arena_alloc(&arena, count, sizeof(bool));
    RT_TRY(rt_arena_check(&arena, "the objects of a drawing", error));
    for (uint32_t i = 0; i < d->tree->count; i++) {
        if (d->tree->rays[i].hit.object < count) met[d->tree->rays[i].hit.object] = true;
    }
    for (int pass = count <= CONTEXT ? 0 : 1; pass < 2; pass++) {
        for (uint32_t id = 0; id < count; id++) {
            if (met[id] == (pass == 1)) draw_object(d, id, met[id]);
        }
    }
    return RT_OK;
}

/* ---- rays ---- */

/* Cuts the line to the window (Liang & Barsky 1984); false if it lies outside. *whole: `to` lies inside. */
static bool cut_line(const Drawing *d, RtPoint *from, RtPoint *to, bool *whole) {
    const double dx = to->x - from->x, dy = to->y - from->y;
    const double speed[4] = {-dx, dx, -dy, dy};
    const double room[4] = {from->x - MARGIN, MARGIN + d->width - from->x, from->y - TOP,
                            TOP + d->height - from->y};
    double first = 0, last = 1;
    for (int side = 0; side < 4; side++) {
        if (speed[side] == 0 && room[side] < 0) return false;
        if (speed[side] < 0) first = fmax(first, room[side] / speed[side]);
        if (speed[side] > 0) last = fmin(last, room[side] / speed[side]);
    }
    if (!(first < last)) return false;
    *whole = last == 1;
    *to = (RtPoint){from->x + last * dx, from->y + last * dy};
    *from = (RtPoint){from->x + first * dx, from->y + first * dy};
    return true;
}

/* Where the drawing of the ray ends: at its hit, at the light, or far outside the window. */
static RtVec3d drawn_end(const Drawing *d, const RtTreeRay *ray) {
    if (isfinite((double)ray->hit.t)) return end_of(ray);
    if (ray->ray.kind == RT_RAY_SHADOW) return rt_ray_point(&ray->ray, ray->ray.tmax);
    return rt_add_scaledd(rt_widen(ray->ray.org), direction_of(ray),
                          2 * (d->width + d->height) / d->section.scale);
}

static void draw_number(const Drawing *d, const RtTreeRay *ray, RtPoint from, RtPoint to, RtColor color) {
    const double dx = to.x - from.x, dy = to.y - from.y, length = sqrt(dx * dx + dy * dy);
    char text[16];
    if (length < 26) return;
    snprintf(text, sizeof text, "%u", ray->number);
    double x = (from.x + to.x) / 2 - 10 * dy / length - rt_text_width(d->cairo, text) / 2;
    double y = (from.y + to.y) / 2 + 10 * dx / length + 4;
    rt_draw_text(d->cairo, x, y, color, "%s", text);
}

/* A line with a head at `to`, `head` long. */
static void draw_arrow(const Drawing *d, RtPoint from, RtPoint to, RtStyle style, double head) {
    cairo_move_to(d->cairo, from.x, from.y); /* an open line: dashes do not come back over the gaps */
    cairo_line_to(d->cairo, to.x, to.y);
    rt_paint(d->cairo, style);
    rt_draw_arrow_head(d->cairo, from, to, head, style.color);
}

static void draw_ray(const Drawing *d, const RtTreeRay *ray) {
    const bool shadow = ray->ray.kind == RT_RAY_SHADOW, ends = isfinite((double)ray->hit.t);
    RtPoint from = rt_section_point(&d->section, rt_widen(ray->ray.org));
    RtPoint to = rt_section_point(&d->section, drawn_end(d, ray));
    RtStyle style = styles[style_of(ray)].style;
    bool whole;
    if (!cut_line(d, &from, &to, &whole)) return;
    if (!shadow) style.width = 0.8 + 1.4 * sqrt((double)ray->factor);
    /* Shadow rays nearly always leave the plane: lights are elsewhere. */
    RtVec3d from_plane = rt_subd(rt_widen(ray->ray.org), d->section.on);
    const double beside = fabs(rt_dotd(from_plane, d->section.normal)) * d->section.scale;
    const bool leaves = beside > BESIDE || fabs(rt_dotd(direction_of(ray), d->section.normal)) > slant;
    for (int c = 0; c < 3 && !shadow && leaves; c++)
        style.color.rgb[c] = (uint8_t)(127 + style.color.rgb[c] / 2); /* paler */
    draw_arrow(d, from, to, style, shadow ? 8 : 11);
    if (d->tree->count <= MOST_ROWS) draw_number(d, ray, from, to, style.color);
    if (!whole || !ends) return;
    if (!shadow) {
        rt_draw_disc(d->cairo, to, 4, style.color);
        return;
    }
    rt_add_line(d->cairo, (RtPoint){to.x - 5, to.y - 5}, (RtPoint){to.x + 5, to.y + 5});
    rt_add_line(d->cairo, (RtPoint){to.x - 5, to.y + 5}, (RtPoint){to.x + 5, to.y - 5});
    rt_paint(d->cairo, (RtStyle){style.color, 2, 0, false});
}

static void draw_normal(const Drawing *d, const RtTreeRay *ray) {
    if (!ray->surface.material) return;
    RtVec3d tip = rt_add_scaledd(ray->surface.point, ray->surface.normal, 40 / d->section.scale);
    RtPoint from = rt_section_point(&d->section, ray->surface.point), to = rt_section_point(&d->section, tip);
    bool whole;
    if (cut_line(d, &from, &to, &whole)) draw_arrow(d, from, to, styles[NORMAL].style, 6);
}

static RtStatus draw_section(const Drawing *d, RtError *error) {
    cairo_save(d->cairo);
    cairo_rectangle(d->cairo, MARGIN, TOP, d->width, d->height);
    cairo_clip(d->cairo);
    rt_fill_rectangle(d->cairo, MARGIN, TOP, d->width, d->height, (RtColor){{250, 250, 250}});
    RtStatus status = draw_objects(d, error);
    for (uint32_t i = 0; i < d->tree->count; i++) draw_normal(d, &d->tree->rays[i]);
    for (uint32_t i = d->tree->count; i-- > 0;) draw_ray(d, &d->tree->rays[i]);
    cairo_restore(d->cairo);
    cairo_rectangle(d->cairo, MARGIN + 0.5, TOP + 0.5, d->width - 1, d->height - 1);
    rt_paint(d->cairo, (RtStyle){pale, 1, 0, false});
    return status;
}

/* ---- below ---- */

static void draw_keys(const Drawing *d, double y) {
    double x = MARGIN;
    for (int i = 0; i < STYLES; i++) {
        draw_arrow(d, (RtPoint){x, y - 4}, (RtPoint){x + 28, y - 4}, styles[i].style, 8);
        x += 34 + rt_draw_text(d->cairo, x + 34, y, RT_BLACK, "%s", styles[i].text) + 22;
    }
    rt_draw_text(d->cairo, x, y, dark, "pale: leaves the plane");
}

enum { HIT = 300, T = 610, FACTOR = 690, LIGHT = 770 }; /* columns */

static void draw_row(const Drawing *d, const RtTreeRay *ray, double y) {
    char text[RT_TREE_HIT_TEXT];
    const double x = MARGIN + INDENT * (ray->level - (ray->ray.kind != RT_RAY_SHADOW));
    rt_fill_rectangle(d->cairo, x, y - 10, 4, 12, styles[style_of(ray)].style.color);
    const double name_at = x + 15 + rt_draw_text(d->cairo, x + 9, y, RT_BLACK, "%u", ray->number);
    rt_tree_ray_name(ray, text);
    rt_draw_text_within(d->cairo, name_at, y, HIT - name_at - 6, RT_BLACK, text);
    rt_tree_ray_hit(ray, d->scene, text);
    rt_draw_text_within(d->cairo, HIT, y, T - HIT - 10, RT_BLACK, text);
    if (isfinite((double)ray->hit.t)) rt_draw_text(d->cairo, T, y, RT_BLACK, "%.4g", (double)ray->hit.t);
    rt_draw_text(d->cairo, FACTOR, y, RT_BLACK, "%.3g", (double)ray->factor);
    rt_fill_rectangle(d->cairo, LIGHT, y - 10, 22, 12, color_of(rt_narrow(ray->light)));
    rt_draw_text(d->cairo, LIGHT + 30, y, RT_BLACK, "%.3f  %.3f  %.3f", ray->light.x, ray->light.y,
                 ray->light.z);
}

static void draw_rows(const Drawing *d, double y, uint32_t rows) {
    static const struct {
        double x;
        const char *text;
    } heads[] = {
        {MARGIN, "ray"}, {HIT, "hits"}, {T, "t"}, {FACTOR, "factor"}, {LIGHT, "light: red, green, blue"}};
    for (size_t i = 0; i < sizeof heads / sizeof heads[0]; i++)
        rt_draw_text(d->cairo, heads[i].x, y, dark, "%s", heads[i].text);
    for (uint32_t i = 0, row = 0; row < rows; i = rt_ray_tree_next(d->tree, i), row++)
        draw_row(d, &d->tree->rays[i], y += ROW);
    const uint32_t left = d->tree->count - rows;
    if (left > 0)
        rt_draw_text(d->cairo, MARGIN, y + ROW, RT_BLACK, "and %u more ray%s", left, rt_plural(left));
}

static RtStatus draw(Drawing *d, const char *title, const char *file, RtError *error) {
    RtCanvas canvas;
    const uint32_t rows = d->tree->count < MOST_ROWS ? d->tree->count : MOST_ROWS;
    choose_plane(d);
    choose_window(d);
    const double below = TOP + d->height, height = below + KEYS + ROW * (rows + 2.0) + MARGIN;
    RT_TRY(rt_canvas_open(&canvas, file, WIDTH, height, TITLE_SIZE, error));
    d->cairo = canvas.cairo;
    rt_draw_text_within(d->cairo, MARGIN, 24, WIDTH - 2 * MARGIN, RT_BLACK, title);
    cairo_set_font_size(d->cairo, FONT_SIZE);
    RtVec3d up = d->section.up;
    rt_draw_text(d->cairo, MARGIN, 46, dark,
                 "a section that contains the primary ray; upward is (%.2f, %.2f, %.2f); numbers as below",
                 up.x, up.y, up.z);
    RtStatus status = draw_section(d, error);
    draw_keys(d, below + 22);
    draw_rows(d, below + KEYS + ROW, rows);
    return rt_canvas_close(&canvas, status, error);
}

RtStatus rt_ray_tree_draw(const RtRayTree *tree, const RtScene *scene, const char *title, const char *file,
                          RtError *error) {
    RT_OWNED(RtScene, copies, rt_scene_clear);
    if (tree->count == 0) return rt_fail(error, RT_BAD_INPUT, "the pixel has no ray to draw");
    if (scene->geometry.instance_count > 0) { /* copies have the same ids */
        RT_TRY(rt_scene_flatten(scene, &copies, error));
        scene = &copies;
    }
    Drawing d = {.tree = tree, .scene = scene};
    RT_TRY(rt_hit_memory_alloc(&scene->geometry, &d.hit_memory, error));
    RtStatus status = draw(&d, title, file, error);
    rt_free(d.hit_memory);
    return status;
}
