/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/canvas.h"

#include "core/base/elementary.h"
#include "core/base/words.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <jansson.h>
#include <stdarg.h>
#include <string.h>

/* ---- colours ---- */

static RtColor between(const uint8_t stops[][3], int count, double position) {
    double at = (count - 1) * (position > 0 ? fmin(position, 1) : 0);
    int below = at < count - 1 ? (int)at : count - 2;
    RtColor color;
    for (int c = 0; c < 3; c++) {
        double a = stops[below][c], b = stops[below + 1][c];
        color.rgb[c] = (uint8_t)(a + (b - a) * (at - below) + 0.5);
    }
    return color;
}

RtColor rt_color_scale(double position) {
    static const uint8_t stops[9][3] = {{68, 1, 84},    {71, 44, 122},  {59, 81, 139},
                                        {44, 113, 142}, {33, 144, 141}, {39, 173, 129},
                                        {92, 200, 99},  {170, 220, 50}, {253, 231, 37}};
    return between(stops, 9, position);
}

RtColor rt_color_difference(double position) {
    static const uint8_t stops[5][3] = {
        {5, 48, 97}, {67, 147, 195}, {247, 247, 247}, {214, 96, 77}, {103, 0, 31}};
    return between(stops, 5, (position + 1) / 2);
}

RtColor rt_color_of_id(uint32_t id) {
    uint32_t mixed = (id + 1) * UINT32_C(2654435769);
    RtColor color;
    for (int c = 0; c < 3; c++) {
        mixed ^= mixed >> 15;
        mixed *= UINT32_C(2246822519);
        color.rgb[c] = (uint8_t)(60 + (mixed >> 24) * 180 / 255);
    }
    return color;
}

/* ---- the file ---- */

static cairo_status_t write_bytes(void *file, const unsigned char *bytes, unsigned count) {
    return fwrite(bytes, 1, count, file) == count ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

static cairo_surface_t *create_surface(RtCanvas *canvas, const char *name, double width, double height) {
    cairo_surface_t *surface;
    FILE *file = canvas->output.file;
    if (rt_ends_in(name, ".svg")) {
        surface = cairo_svg_surface_create_for_stream(write_bytes, file, width, height);
        cairo_svg_surface_set_document_unit(surface, CAIRO_SVG_UNIT_PX);
    } else if (rt_ends_in(name, ".pdf")) {
        surface = cairo_pdf_surface_create_for_stream(write_bytes, file, width, height);
        /* A fixed date: the same picture is the same file. */
        cairo_pdf_surface_set_metadata(surface, CAIRO_PDF_METADATA_CREATE_DATE, "2000-01-01T00:00:00Z");
    } else {
        canvas->png = true;
        surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
    }
    return surface;
}

static RtStatus fail(cairo_status_t status, const char *file, RtError *error) {
    RtStatus kind = status == CAIRO_STATUS_NO_MEMORY ? RT_NO_MEMORY : RT_IO;
    return rt_fail(error, kind, "%s: drawing the picture failed: %s", file, cairo_status_to_string(status));
}

static void set_font(cairo_t *cairo, double size) {
    cairo_font_options_t *options = cairo_font_options_create();
    cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
    cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
    cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
    cairo_set_font_options(cairo, options);
    cairo_font_options_destroy(options);
    cairo_select_font_face(cairo, "DejaVu Sans", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
    cairo_set_font_size(cairo, size);
}

RtStatus rt_canvas_open(RtCanvas *canvas, const char *file, double width, double height, double font_size,
                        RtError *error) {
    *canvas = (RtCanvas){.cairo = NULL};
    RT_TRY(rt_output_open(&canvas->output, file, error));
    cairo_surface_t *surface = create_surface(canvas, file, width, height);
    canvas->cairo = cairo_create(surface);
    cairo_surface_destroy(surface); /* the context has a reference */
    rt_set_color(canvas->cairo, RT_WHITE, 1);
    cairo_paint(canvas->cairo);
    set_font(canvas->cairo, font_size);
    cairo_set_line_width(canvas->cairo, 1);
    cairo_set_line_cap(canvas->cairo, CAIRO_LINE_CAP_SQUARE);
    cairo_status_t status = cairo_status(canvas->cairo);
    if (status == CAIRO_STATUS_SUCCESS) return RT_OK;
    if (status == CAIRO_STATUS_INVALID_SIZE)
        rt_fail(error, RT_BAD_INPUT,
                "%s: a picture of %.0f x %.0f pixels is too large: choose a smaller image", file, width,
                height);
    else
        fail(status, file, error);
    return rt_canvas_close(canvas, error->status, error);
}

RtStatus rt_canvas_close(RtCanvas *canvas, RtStatus drawn, RtError *error) {
    cairo_surface_t *surface = cairo_surface_reference(cairo_get_target(canvas->cairo));
    cairo_status_t status = cairo_status(canvas->cairo);
    cairo_destroy(canvas->cairo);
    if (drawn == RT_OK && status == CAIRO_STATUS_SUCCESS && canvas->png)
        status = cairo_surface_write_to_png_stream(surface, write_bytes, canvas->output.file);
    cairo_surface_finish(surface);
    if (status == CAIRO_STATUS_SUCCESS) status = cairo_surface_status(surface);
    cairo_surface_destroy(surface);
    if (drawn == RT_OK && (status == CAIRO_STATUS_SUCCESS || status == CAIRO_STATUS_WRITE_ERROR))
        return rt_output_commit(&canvas->output, error); /* which reports a failed write */
    if (drawn == RT_OK) drawn = fail(status, canvas->output.path, error);
    rt_output_discard(&canvas->output);
    return drawn;
}

/* ---- drawing ---- */

void rt_set_color(cairo_t *cairo, RtColor color, double opacity) {
    cairo_set_source_rgba(cairo, color.rgb[0] / 255.0, color.rgb[1] / 255.0, color.rgb[2] / 255.0, opacity);
}

void rt_fill_rectangle(cairo_t *cairo, double x, double y, double width, double height, RtColor color) {
    rt_set_color(cairo, color, 1);
    cairo_rectangle(cairo, x, y, width, height);
    cairo_fill(cairo);
}

RtStatus rt_paint_pixels(cairo_t *cairo, RtPixels pixels, double x, double y, RtError *error) {
    const uint32_t width = pixels.width, height = pixels.height;
    cairo_surface_t *surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)width, (int)height);
    unsigned char *bytes = cairo_image_surface_get_data(surface);
    size_t stride = (size_t)cairo_image_surface_get_stride(surface);
    for (uint32_t row = 0; bytes && row < height; row++) {
        for (uint32_t column = 0; column < width; column++) {
            const RtColor c = pixels.color(pixels.context, column, row);
            uint32_t pixel = (uint32_t)c.rgb[0] << 16 | (uint32_t)c.rgb[1] << 8 | c.rgb[2];
            memcpy(bytes + row * stride + column * sizeof pixel, &pixel, sizeof pixel);
        }
    }
    cairo_surface_mark_dirty(surface);
    cairo_set_source_surface(cairo, surface, x, y);
    cairo_pattern_set_filter(cairo_get_source(cairo), CAIRO_FILTER_NEAREST);
    cairo_rectangle(cairo, x, y, width, height);
    cairo_fill(cairo);
    cairo_set_source_rgb(cairo, 0, 0, 0); /* drops the surface */
    cairo_surface_destroy(surface);
    return bytes ? RT_OK : rt_fail_memory(error, "an image", (size_t)4 * width * height);
}

uint32_t rt_polygon_cut(RtPoint *points, uint32_t count, RtPoint normal, double limit) {
    RtPoint from[RT_MAX_CORNERS];
    uint32_t left = 0;
    memcpy(from, points, count * sizeof *points);
    for (uint32_t i = 0; i < count; i++) {
        RtPoint a = from[i], b = from[(i + 1) % count];
        double room_a = limit - normal.x * a.x - normal.y * a.y;
        double room_b = limit - normal.x * b.x - normal.y * b.y, at = room_a / (room_a - room_b);
        if (room_a >= 0) points[left++] = a;
        if ((room_a < 0) != (room_b < 0))
            points[left++] = (RtPoint){a.x + (b.x - a.x) * at, a.y + (b.y - a.y) * at};
    }
    return left;
}

void rt_add_polygon(cairo_t *cairo, const RtPoint *points, uint32_t count) {
    RtPoint near[RT_MAX_CORNERS];
    double left, top, right, bottom;
    cairo_clip_extents(cairo, &left, &top, &right, &bottom);
    double width = right - left, height = bottom - top;
    memcpy(near, points, count * sizeof *points);
    count = rt_polygon_cut(near, count, (RtPoint){-1, 0}, width - left);
    count = rt_polygon_cut(near, count, (RtPoint){1, 0}, right + width);
    count = rt_polygon_cut(near, count, (RtPoint){0, -1}, height - top);
    count = rt_polygon_cut(near, count, (RtPoint){0, 1}, bottom + height);
    cairo_new_sub_path(cairo);
    for (uint32_t i = 0; i < count; i++) cairo_line_to(cairo, near[i].x, near[i].y);
    if (count > 0) cairo_close_path(cairo);
}

void rt_add_line(cairo_t *cairo, RtPoint from, RtPoint to) {
    rt_add_polygon(cairo, (RtPoint[]){from, to}, 2);
}

void rt_add_circle(cairo_t *cairo, RtPoint center, double radius) {
    const double most = 1e6, pi = 3.14159265358979323846;
    double left, top, right, bottom;
    cairo_clip_extents(cairo, &left, &top, &right, &bottom);
    double dx = center.x - (left + right) / 2, dy = center.y - (top + bottom) / 2;
    double distance = sqrt(dx * dx + dy * dy), reach = 2 * (right - left + bottom - top);
    if (radius > most || distance > most) {
        double moved = fmin(radius, most) + rt_clampd(distance - radius, -reach, reach) - distance;
        center.x += distance > 0 ? dx / distance * moved : 0;
        center.y += distance > 0 ? dy / distance * moved : 0;
        radius = fmin(radius, most);
    }
    cairo_new_sub_path(cairo);
    cairo_arc(cairo, center.x, center.y, radius, 0, 2 * pi);
    cairo_close_path(cairo);
}

void rt_paint(cairo_t *cairo, RtStyle style) {
    const double dashes[] = {3, 3};
    rt_set_color(cairo, style.color, style.opacity);
    if (style.opacity > 0) cairo_fill_preserve(cairo);
    rt_set_color(cairo, style.color, 1);
    cairo_set_line_width(cairo, style.width);
    cairo_set_dash(cairo, dashes, style.dashed ? 2 : 0, 0);
    cairo_set_line_cap(cairo, CAIRO_LINE_CAP_BUTT);
    if (style.width > 0) cairo_stroke(cairo);
    cairo_new_path(cairo);
}

void rt_draw_disc(cairo_t *cairo, RtPoint center, double radius, RtColor color) {
    rt_add_circle(cairo, center, radius);
    rt_paint(cairo, (RtStyle){color, 0, 1, false});
}

void rt_draw_arrow_head(cairo_t *cairo, RtPoint from, RtPoint to, double size, RtColor color) {
    double dx = to.x - from.x, dy = to.y - from.y, length = sqrt(dx * dx + dy * dy);
    if (!(length > 0)) return;
    dx *= size / length, dy *= size / length;
    const RtPoint corners[] = {
        to, {to.x - dx - dy / 2, to.y - dy + dx / 2}, {to.x - dx + dy / 2, to.y - dy - dx / 2}};
    rt_add_polygon(cairo, corners, 3);
    rt_paint(cairo, (RtStyle){color, 0, 1, false});
}

/* ---- text ---- */

enum { MAX_TEXT = 512 };

static void make_utf8(const char *text, char out[MAX_TEXT]) {
    snprintf(out, MAX_TEXT, "%s", text);
    json_t *valid = json_string(out);
    for (char *c = out; !valid && *c; c++) {
        if ((unsigned char)*c > 127) *c = '?';
    }
    json_decref(valid);
}

double rt_font_size(double width) {
    return fmax(11, floor(10 + width / 160));
}

double rt_text_width(cairo_t *cairo, const char *text) {
    char utf8[MAX_TEXT];
    cairo_text_extents_t extents;
    make_utf8(text, utf8);
    cairo_text_extents(cairo, utf8, &extents);
    return extents.x_advance;
}

double rt_draw_text(cairo_t *cairo, double x, double y, RtColor color, const char *format, ...) {
    char text[MAX_TEXT], utf8[MAX_TEXT];
    double end;
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    make_utf8(text, utf8);
    rt_set_color(cairo, color, 1);
    cairo_move_to(cairo, x, y);
    cairo_show_text(cairo, utf8);
    cairo_get_current_point(cairo, &end, &y);
    cairo_new_path(cairo);
    return end - x;
}

void rt_draw_text_within(cairo_t *cairo, double x, double y, double room, RtColor color, const char *text) {
    char part[MAX_TEXT];
    int length = (int)strlen(text);
    do snprintf(part, sizeof part, "%.*s%s", length, text, text[length] ? "..." : "");
    while (rt_text_width(cairo, part) > room && length-- > 0);
    rt_draw_text(cairo, x, y, color, "%s", part);
}

static double font_size(cairo_t *cairo) {
    cairo_matrix_t matrix;
    cairo_get_font_matrix(cairo, &matrix);
    return matrix.xx;
}

void rt_draw_key(cairo_t *cairo, double x, double y, RtColor color, const char *format, ...) {
    double em = font_size(cairo), side = floor(0.75 * em);
    char text[MAX_TEXT];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    rt_fill_rectangle(cairo, floor(x), floor(y) - side, side, side, color);
    rt_set_color(cairo, RT_GREY, 1);
    cairo_rectangle(cairo, floor(x) + 0.5, floor(y) - side + 0.5, side - 1, side - 1);
    cairo_stroke(cairo);
    rt_draw_text(cairo, x + 1.1 * em, y, RT_BLACK, "%s", text);
}

/* ---- scales ---- */

double rt_scale_position(const RtScale *scale, double value) {
    if (!(scale->most > scale->least)) return 0;
    if (scale->logarithmic) return rt_log(1 + value) / rt_log(1 + scale->most);
    return (value - scale->least) / (scale->most - scale->least);
}

/* Mark `i`: 0 and powers of ten, or round steps of a fifth to a half of the range. */
static double mark_value(const RtScale *scale, int i) {
    double range = scale->most - scale->least, power = 1; /* the largest power of ten up to half the range */
    if (scale->logarithmic) {
        for (int k = 1; k < i; k++) power *= 10;
        return i > 0 ? power : 0;
    }
    if (!(range > 0)) return scale->least + i;
    while (10 * power <= range / 2) power *= 10;
    while (power > range / 2) power /= 10;
    double step = range / power >= 10 ? 5 * power : range / power >= 5 ? 2 * power : power;
    return (ceil(scale->least / step) + i) * step;
}

/* The bar, and the space that numbers leave free. */
typedef struct Bar {
    cairo_t *cairo;
    const RtScale *scale;
    double x, y, width, em, free_from, free_to;
} Bar;

/* Marks a value below the bar, with its number if it fits; returns the left end of the number. */
static double put_mark(Bar *bar, double value) {
    char text[32];
    snprintf(text, sizeof text, "%.10g", value);
    double at = bar->x + rt_scale_position(bar->scale, value) * (bar->width - 1), mark = floor(at) + 0.5;
    double width = rt_text_width(bar->cairo, text);
    double from = rt_clampd(at - width / 2, bar->x, bar->x + bar->width - width);
    cairo_move_to(bar->cairo, mark, bar->y + bar->em);
    cairo_line_to(bar->cairo, mark, bar->y + 1.2 * bar->em);
    cairo_stroke(bar->cairo);
    if (from < bar->free_from || from + width > bar->free_to) return from;
    rt_draw_text(bar->cairo, from, bar->y + 2.1 * bar->em, RT_BLACK, "%s", text);
    bar->free_from = from + width + 0.5 * bar->em;
    return from;
}

void rt_draw_scale(cairo_t *cairo, double x, double y, double width, const RtScale *scale) {
    enum { STOPS = 8, MOST_MARKS = 24 };
    double em = font_size(cairo);
    cairo_pattern_t *colors = cairo_pattern_create_linear(x, 0, x + width, 0);
    for (int i = 0; i <= STOPS; i++) {
        double at = (double)i / STOPS;
        RtColor c = scale->least < 0 ? rt_color_difference(2 * at - 1) : rt_color_scale(at);
        cairo_pattern_add_color_stop_rgb(colors, at, c.rgb[0] / 255.0, c.rgb[1] / 255.0, c.rgb[2] / 255.0);
    }
    cairo_set_source(cairo, colors);
    cairo_pattern_destroy(colors);
    cairo_rectangle(cairo, x, y, width, floor(em));
    cairo_fill(cairo);
    rt_set_color(cairo, RT_BLACK, 1);
    Bar bar = {cairo, scale, x, y, width, em, x, x + width};
    if (scale->logarithmic && scale->most == floor(scale->most)) { /* its end is hardly ever a power of ten */
        bar.free_to = put_mark(&bar, scale->most) - 0.5 * em;
        bar.free_from = x;
    }
    for (int i = 0; i < MOST_MARKS; i++) { /* numbers that would run into another are left out */
        double value = mark_value(scale, i);
        if (value > scale->most || (scale->logarithmic && value == scale->most)) break;
        put_mark(&bar, value);
    }
}

#if defined(RT_SANITIZED)
/* fontconfig keeps its fonts until the process ends. */
__attribute__((visibility("default"))) const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void) {
    return "leak:libfontconfig\n";
}
#endif
