/* SPDX-License-Identifier: Apache-2.0 */
/* The upper part is a section along the ray, of the part where objects are tested; if that is small, an inset
 * at the left shows the whole path. The lower part has a line for each row of the path, with a bar where the
 * ray is in its box. Section and bars share the x axis. */
#include "picture/path_picture.h"

#include "core/base/words.h"
#include "picture/path_section.h"

enum { WIDTH = 1000, LEFT = 250, MARGIN = 12, PLOT = WIDTH - LEFT - 20 }; /* of the common x axis, pixels */
enum { TOP = 64, SECTION = 450, INSET = 160, GAP = 46, ROW = 14, MOST_ROWS = 90, MOST_TICKS = 20 };
enum { FONT_SIZE = 11, TITLE_SIZE = 16 };

typedef struct Drawing {
    const RtPath *path;
    cairo_t *cairo;
    RtPathSection section;
} Drawing;

/* ---- the rows ---- */

/* A mark at the edge on the side where the bar would be. */
static void draw_beyond(const Drawing *d, double y, bool right, RtColor color) {
    double tip = right ? LEFT + PLOT - 1 : LEFT + 1, base = right ? tip - 5 : tip + 5, middle = y + ROW / 2.0;
    rt_add_polygon(d->cairo, (RtPoint[]){{tip, middle}, {base, middle - 3}, {base, middle + 3}}, 3);
    rt_paint(d->cairo, (RtStyle){color, 0, 1, false});
}

/* A bar that goes on beyond the axis is open there. */
static void draw_bar(const Drawing *d, uint32_t i, double y) {
    const RtPathRow *row = &d->path->rows[i];
    if (!row->boxed || !(row->enter <= row->leave)) return;
    const double end = LEFT + PLOT, top = y + 3, bottom = y + ROW - 3;
    double from = rt_path_section_x(&d->section, row->enter),
           to = fmax(rt_path_section_x(&d->section, row->leave), from + 1);
    RtStyle style = {rt_path_row_color(d->path, i), 1, 0, rt_path_row_is_missed(row)};
    if (rt_path_row_is_missed(row)) style.color = RT_PATH_LIGHT;
    if (row->kind == RT_TRACED_OBJECT_TEST) style.color = RT_PATH_DARK;
    if (row->kind == RT_TRACED_STEP) style.opacity = row->leaf ? 0.7 : 0.25;
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

static void draw_row(const Drawing *d, uint32_t i, double y) {
    const RtPathRow *row = &d->path->rows[i];
    bool object = row->kind == RT_TRACED_OBJECT_TEST;
    char of[128] = "";
    if (row->kind == RT_TRACED_PASSED_ON)
        snprintf(of, sizeof of, " by %s", row->what);
    else if (*row->what)
        snprintf(of, sizeof of, ", %s %u", row->what, row->index);
    const char *result = !rt_path_row_answers(row) ? "" : row->met ? ": hit" : ": missed";
    rt_draw_text(d->cairo, MARGIN, y + ROW - 3, RT_BLACK, "%u  %s%s%s", i + 1, rt_path_row_name(row), of,
                 result);
    draw_bar(d, i, y);
    if (object && row->met)
        rt_draw_disc(d->cairo, (RtPoint){rt_path_section_x(&d->section, (double)row->t), y + ROW / 2.0}, 4,
                     RT_PATH_HIT);
}

/* Draws consecutive object tests that missed as one row. */
static void draw_run(const Drawing *d, uint32_t first, uint32_t run, double y) {
    rt_draw_text(d->cairo, MARGIN, y + ROW - 3, RT_BLACK, "%u to %u  %u object tests: missed", first + 1,
                 first + run, run);
    for (uint32_t i = first; i < first + run; i++) draw_bar(d, i, y);
}

static void draw_nearest(const Drawing *d, const RtPathRow *row, double y) {
    if (!isfinite((double)row->nearest)) return;
    double x = rt_path_section_x(&d->section, (double)row->nearest);
    if (x < LEFT || x > LEFT + PLOT) return;
    rt_add_line(d->cairo, (RtPoint){x, y}, (RtPoint){x, y + ROW});
    rt_paint(d->cairo, (RtStyle){RT_PATH_HIT, 1.5, 0, false});
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
    const RtPathWindow *w = &d->section.detail;
    double speed = d->section.speed, from = w->s0 / speed, to = (w->s0 + PLOT / w->scale) / speed, step = 1;
    while (step > (to - from) / 5) step /= 10;
    while (step * 10 < (to - from) / 5) step *= 10;
    if (5 * step < (to - from) / 3)
        step *= 5;
    else if (2 * step < (to - from) / 4)
        step *= 2;
    double first = ceil(from / step);
    for (int i = 0; i < MOST_TICKS && (first + i) * step <= to; i++) {
        double t = (first + i) * step + 0.0, x = floor(rt_path_section_x(&d->section, t)) + 0.5;
        char text[32];
        snprintf(text, sizeof text, "t = %.6g", t);
        rt_add_line(d->cairo, (RtPoint){x, y}, (RtPoint){x, bottom});
        rt_paint(d->cairo, (RtStyle){{{221, 221, 221}}, 1, 0, false});
        rt_draw_text(d->cairo, x - rt_text_width(d->cairo, text) / 2, y - 4, RT_PATH_DARK, "%s", text);
    }
}

/* ---- the legend ---- */

static void draw_legend(const Drawing *d) {
    const struct {
        RtStyle style;
        const char *text;
    } keys[] = {{{{{59, 82, 139}}, 1, 0, false}, "extent hit, or inner node"},
                {{RT_PATH_LIGHT, 1, 0, true}, "extent missed"},
                {{{{33, 145, 140}}, 1, 0.4, false}, "step, leaf"},
                {{RT_PATH_DARK, 1, 0.1, false}, "object tested"},
                {{RT_PATH_HIT, 1, 0.25, false}, "object hit"},
                {{RT_PATH_HIT, 0, 1, false}, "nearest t so far"},
                {RT_PATH_UNTESTED, "object not tested"},
                {RT_PATH_UNVISITED, "leaf not visited"}};
    enum { COUNT = sizeof keys / sizeof keys[0] };
    const RtTally *t = &d->path->tally;
    double y = TOP;
    for (int i = 0; i < COUNT; i++, y += 18) {
        cairo_rectangle(d->cairo, MARGIN + 0.5, y + 0.5, keys[i].style.width > 0 ? 18 : 2, 11);
        rt_paint(d->cairo, keys[i].style);
        rt_draw_text(d->cairo, MARGIN + 26, y + 10, RT_BLACK, "%s", keys[i].text);
    }
    rt_draw_text(d->cairo, MARGIN, y + 10, RT_BLACK, "dark: visited first, light: last");
    rt_draw_text(d->cairo, MARGIN, y + 26, RT_BLACK, "%c is up", "xyz"[d->section.axis]);
    rt_draw_text(d->cairo, MARGIN, y + 48, RT_BLACK, "%llu step%s, %llu of them in leaves",
                 (unsigned long long)t->steps, rt_plural(t->steps), (unsigned long long)t->leaf_steps);
    rt_draw_text(d->cairo, MARGIN, y + 64, RT_BLACK, "%llu extent test%s",
                 (unsigned long long)t->extent_tests, rt_plural(t->extent_tests));
    rt_draw_text(d->cairo, MARGIN, y + 80, RT_BLACK, "%llu object test%s, %llu hit%s",
                 (unsigned long long)t->object_tests, rt_plural(t->object_tests),
                 (unsigned long long)t->object_hits, rt_plural(t->object_hits));
    if (d->section.overview.width > 0)
        rt_draw_text(d->cairo, MARGIN, d->section.overview.y - 6, RT_BLACK,
                     "the whole path; framed: the part drawn");
}

RtStatus rt_path_draw(const RtPath *path, const RtScene *scene, const char *title, const char *spec,
                      const char *file, RtError *error) {
    RtCanvas canvas;
    uint32_t left;
    Drawing d = {.path = path,
                 .section = {.detail = {LEFT, TOP, PLOT, SECTION, 0, 0, 0},
                             .overview = {MARGIN, TOP + SECTION - INSET, LEFT - 2 * MARGIN, INSET, 0, 0, 0}}};
    rt_path_section_init(&d.section, path, &scene->geometry);
    double bars = TOP + SECTION + GAP, bottom = bars + ROW * draw_rows(&d, bars, false, &left);
    RT_TRY(rt_canvas_open(&canvas, file, WIDTH, bottom + 30, TITLE_SIZE, error));
    d.cairo = canvas.cairo;
    rt_draw_text_within(d.cairo, MARGIN, 24, WIDTH - 2 * MARGIN, RT_BLACK, title);
    cairo_set_font_size(d.cairo, FONT_SIZE);
    rt_draw_text_within(d.cairo, MARGIN, 44, WIDTH - 2 * MARGIN, RT_PATH_DARK, spec);
    draw_legend(&d);
    RtStatus status = rt_path_section_draw(&d.section, d.cairo, error);
    draw_axis(&d, bars - 4, bottom);
    draw_rows(&d, bars, true, &left);
    if (left > 0)
        rt_draw_text(d.cairo, MARGIN, bottom + 18, RT_BLACK, "and %u more row%s", left, rt_plural(left));
    return rt_canvas_close(&canvas, status, error);
}
