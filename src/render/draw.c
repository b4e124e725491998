/* SPDX-License-Identifier: Apache-2.0 */
#include "render/draw.h"

#include <string.h>

enum { GLYPH_WIDTH = 3, GLYPH_ADVANCE = GLYPH_WIDTH + 1 };

/* Five octal digits a glyph, one a row from the top; in a digit 4 is the left dot, 1 the right one. */
static const uint16_t digit_glyphs[10] = {075557, 026227, 071747, 071717, 055711,
                                          074717, 074757, 071122, 075757, 075717};
static const uint16_t letter_glyphs[26] = {
    025755, 065656, 034443, 065556, 074647, 074644, 034553, 055755, 072227, 011152, 055655, 044447, 057755,
    065555, 025552, 065644, 025563, 065655, 034216, 072222, 055557, 055552, 055775, 055255, 055222, 071247};

static uint16_t glyph_of(char c) {
    if (c >= '0' && c <= '9') return digit_glyphs[c - '0'];
    if (c >= 'a' && c <= 'z') return letter_glyphs[c - 'a'];
    if (c >= 'A' && c <= 'Z') return letter_glyphs[c - 'A'];
    if (c == '.') return 000002;
    if (c == '_') return 000007;
    if (c == '=') return 007070;
    return 0;
}

RtColor rt_color_scale(double position) {
    static const uint8_t stops[9][3] = {{68, 1, 84},    {71, 44, 122},  {59, 81, 139},
                                        {44, 113, 142}, {33, 144, 141}, {39, 173, 129},
                                        {92, 200, 99},  {170, 220, 50}, {253, 231, 37}};
    double at = 8 * (position > 0 ? fmin(position, 1) : 0);
    int below = at < 8 ? (int)at : 7;
    RtColor color;
    for (int c = 0; c < 3; c++) {
        double a = stops[below][c], b = stops[below + 1][c];
        color.rgb[c] = (uint8_t)(a + (b - a) * (at - below) + 0.5);
    }
    return color;
}

static void blend(RtImage *image, int x, int y, RtColor color, double opacity) {
    if (x < 0 || y < 0 || (uint32_t)x >= image->width || (uint32_t)y >= image->height) return;
    uint8_t *pixel = image->rgb + 3 * ((size_t)y * image->width + (size_t)x);
    for (int c = 0; c < 3; c++) {
        pixel[c] = (uint8_t)(pixel[c] + (color.rgb[c] - pixel[c]) * opacity + 0.5);
    }
}

void rt_draw_rectangle(RtImage *image, int x, int y, int width, int height, RtColor color) {
    for (int row = y; row < y + height; row++) {
        for (int column = x; column < x + width; column++) blend(image, column, row, color, 1);
    }
}

void rt_draw_line(RtImage *image, double x0, double y0, double x1, double y1, RtColor color, double opacity) {
    double dx = x1 - x0, dy = y1 - y0;
    int steps = (int)ceil(fmax(fabs(dx), fabs(dy)));
    for (int i = 0; i <= steps; i++) {
        double at = steps ? (double)i / steps : 0;
        blend(image, (int)floor(x0 + at * dx), (int)floor(y0 + at * dy), color, opacity);
    }
}

void rt_draw_text(RtImage *image, int x, int y, int dot, const char *text, RtColor color) {
    for (; *text; text++, x += GLYPH_ADVANCE * dot) {
        uint16_t glyph = glyph_of(*text);
        for (int i = 0; i < RT_TEXT_HEIGHT * GLYPH_WIDTH; i++) {
            if (!(glyph >> (RT_TEXT_HEIGHT * GLYPH_WIDTH - 1 - i) & 1)) continue;
            rt_draw_rectangle(image, x + i % GLYPH_WIDTH * dot, y + i / GLYPH_WIDTH * dot, dot, dot, color);
        }
    }
}

int rt_text_width(const char *text) {
    return (int)strlen(text) * GLYPH_ADVANCE - 1;
}
