/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/draw.h"

#include "core/base/elementary.h"

#include <stdio.h>
#include <string.h>

/* ---- text ---- */

enum { GLYPH_WIDTH = 5, GLYPH_ADVANCE = GLYPH_WIDTH + 1, GLYPH_DOTS = GLYPH_WIDTH * RT_TEXT_HEIGHT };

/* Seven rows of five bits, from the upper left, the last dot being bit 0. */
static const struct {
    char character;
    uint64_t dots;
} glyphs[] = {
    {'0', 0x3a33ae62e}, {'1', 0x11842108e}, {'2', 0x3a213221f}, {'3', 0x78217043e}, {'4', 0x08ca97c42},
    {'5', 0x7e1e0862e}, {'6', 0x1910f462e}, {'7', 0x7c2222108}, {'8', 0x3a317462e}, {'9', 0x3a317844c},
    {'A', 0x3a31fc631}, {'B', 0x7a31f463e}, {'C', 0x3a308422e}, {'D', 0x7a318c63e}, {'E', 0x7e10f421f},
    {'F', 0x7e10f4210}, {'G', 0x3a30bc62e}, {'H', 0x4631fc631}, {'I', 0x38842108e}, {'J', 0x1c4210a4c},
    {'K', 0x4654c5251}, {'L', 0x42108421f}, {'M', 0x4775ac631}, {'N', 0x47359c631}, {'O', 0x3a318c62e},
    {'P', 0x7a31f4210}, {'Q', 0x3a318d64d}, {'R', 0x7a31f5251}, {'S', 0x3e107043e}, {'T', 0x7c8421084},
    {'U', 0x46318c62e}, {'V', 0x46318c544}, {'W', 0x4631ad771}, {'X', 0x462a22a31}, {'Y', 0x462a21084},
    {'Z', 0x7c222221f}, {'.', 0x00000018c}, {'_', 0x00000001f}, {'=', 0x001f07c00}, {':', 0x018c03180},
    {',', 0x000003088}, {'-', 0x0000f8000}, {'+', 0x0084f9080}, {'/', 0x042222210}, {'(', 0x088842082},
    {')', 0x208210888}, {'%', 0x672222273}, {'<', 0x088882082}, {'>', 0x208208888}};

static uint64_t glyph_of(char c) {
    if (c >= 'a' && c <= 'z') c = (char)(c - 'a' + 'A');
    for (size_t i = 0; i < sizeof glyphs / sizeof glyphs[0]; i++) {
        if (glyphs[i].character == c) return glyphs[i].dots;
    }
    return 0;
}

void rt_draw_text(RtImage *image, int x, int y, int dot, const char *text, RtColor color) {
    for (; *text; text++, x += GLYPH_ADVANCE * dot) {
        uint64_t glyph = glyph_of(*text);
        for (int i = 0; i < GLYPH_DOTS; i++) {
            if (!(glyph >> (GLYPH_DOTS - 1 - i) & 1)) continue;
            rt_draw_rectangle(image, x + i % GLYPH_WIDTH * dot, y + i / GLYPH_WIDTH * dot, dot, dot, color);
        }
    }
}

int rt_text_width(const char *text) {
    return (int)strlen(text) * GLYPH_ADVANCE - 1;
}

int rt_text_dot(uint32_t image_width) {
    return image_width < 480 ? 1 : 2 + (int)(image_width / 1200);
}

/* ---- colours ---- */

/* Between `count` colours that are equally far apart. */
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

RtColor rt_color_of_number(uint32_t number) {
    uint32_t mixed = (number + 1) * UINT32_C(2654435769);
    RtColor color;
    for (int c = 0; c < 3; c++) {
        mixed ^= mixed >> 15;
        mixed *= UINT32_C(2246822519);
        color.rgb[c] = (uint8_t)(60 + (mixed >> 24) * 180 / 255);
    }
    return color;
}

/* ---- shapes ---- */

void rt_draw_pixel(RtImage *image, int x, int y, RtColor color, double opacity) {
    if (x < 0 || y < 0 || (uint32_t)x >= image->width || (uint32_t)y >= image->height) return;
    uint8_t *pixel = image->rgb + 3 * ((size_t)y * image->width + (size_t)x);
    for (int c = 0; c < 3; c++) {
        pixel[c] = (uint8_t)(pixel[c] + (color.rgb[c] - pixel[c]) * opacity + 0.5);
    }
}

void rt_draw_rectangle(RtImage *image, int x, int y, int width, int height, RtColor color) {
    for (int row = y; row < y + height; row++) {
        for (int column = x; column < x + width; column++) rt_draw_pixel(image, column, row, color, 1);
    }
}

void rt_draw_line(RtImage *image, double x0, double y0, double x1, double y1, RtColor color, double opacity) {
    double dx = x1 - x0, dy = y1 - y0;
    int steps = (int)ceil(fmax(fabs(dx), fabs(dy)));
    for (int i = 0; i <= steps; i++) {
        double at = steps ? (double)i / steps : 0;
        rt_draw_pixel(image, (int)floor(x0 + at * dx), (int)floor(y0 + at * dy), color, opacity);
    }
}

/* ---- scales ---- */

enum { BAR = 10, MARK = 2, MOST_MARKS = 24 }; /* heights in dots; a number */

double rt_scale_position(const RtScale *scale, double value) {
    if (!(scale->most > scale->least)) return 0;
    if (scale->logarithmic) return rt_log(1 + value) / rt_log(1 + scale->most);
    return (value - scale->least) / (scale->most - scale->least);
}

static double power_of_ten(int n) {
    double power = 1;
    for (int i = 0; i < n; i++) power *= 10;
    return power;
}

/* Mark `i`: 0 and powers of ten, or steps of fifths to halves of the range, in round numbers. */
static double mark_value(const RtScale *scale, int i) {
    if (scale->logarithmic) return i > 0 ? power_of_ten(i - 1) : 0;
    double range = scale->most - scale->least, power = 1; /* of ten, the greatest up to half the range */
    if (!(range > 0)) return scale->least + i;
    while (10 * power <= range / 2) power *= 10;
    while (power > range / 2) power /= 10;
    double step = range / power >= 10 ? 5 * power : range / power >= 5 ? 2 * power : power;
    return (ceil(scale->least / step) + i) * step;
}

/* A number under the scale at a value, and a mark. Gives where the next may begin: the same, where there was
 * no room. */
static int put_number(RtImage *image, int x, int marks, int width, int dot, const RtScale *scale,
                      double value, int free_from, int free_to) {
    char text[32];
    snprintf(text, sizeof text, "%.10g", value);
    int at = x + (int)(rt_scale_position(scale, value) * (width - 1)), half = rt_text_width(text) * dot / 2;
    int from = at - half > x ? at - half : x;
    if (from + 2 * half > x + width) from = x + width - 2 * half;
    rt_draw_rectangle(image, at, marks, dot, MARK * dot, RT_WHITE);
    if (from < free_from || from + 2 * half > free_to) return free_from;
    rt_draw_text(image, from, marks + (MARK + 1) * dot, dot, text, RT_WHITE);
    return from + 2 * half + 6 * dot;
}

int rt_draw_scale(RtImage *image, int x, int y, int width, int dot, const RtScale *scale) {
    int marks = y + BAR * dot, free_from = x, free_to = x + width;
    for (int i = 0; i < width; i++) {
        double position = (double)i / (width - 1);
        RtColor color = scale->least < 0 ? rt_color_difference(2 * position - 1) : rt_color_scale(position);
        rt_draw_rectangle(image, x + i, y, 1, BAR * dot, color);
    }
    if (scale->logarithmic && scale->most == floor(scale->most)) { /* its end is hardly ever a power of ten */
        char text[32];
        put_number(image, x, marks, width, dot, scale, scale->most, free_from, free_to);
        snprintf(text, sizeof text, "%.10g", scale->most);
        free_to -= (rt_text_width(text) + 6) * dot;
    }
    for (int i = 0; i < MOST_MARKS; i++) { /* numbers that would run into another are left out */
        double value = mark_value(scale, i);
        if (value > scale->most || (scale->logarithmic && value == scale->most)) break;
        free_from = put_number(image, x, marks, width, dot, scale, value, free_from, free_to);
    }
    return (BAR + MARK + 1 + RT_TEXT_HEIGHT) * dot;
}
