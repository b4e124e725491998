/* SPDX-License-Identifier: Apache-2.0 */
#include "render/heatmap.h"

#include "base/elementary.h"
#include "render/draw.h"

#include <stdio.h>
#include <string.h>

enum { MARGIN = 4, BAR_HEIGHT = 8, LEGEND_HEIGHT = 34, LEGEND_WIDTH = 200 }; /* in dots */
enum { MOST_MARKS = 24 };

static const RtColor black = {{0, 0, 0}}, white = {{255, 255, 255}};

/* How values become positions on the colour scale. */
typedef struct Scale {
    double most, mean;
    bool logarithmic;
} Scale;

static Scale find_scale(const RtFrame *frame, size_t counter) {
    Scale scale = {0};
    uint32_t width = frame->sampling.width, height = frame->sampling.height;
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            double value = rt_frame_cost(frame, counter, x, y);
            scale.most = fmax(scale.most, value);
            scale.mean += value;
        }
    }
    scale.mean /= (double)width * height;
    scale.logarithmic = scale.mean < scale.most / 8;
    return scale;
}

static double position(const Scale *scale, double value) {
    if (!(scale->most > 0)) return 0;
    return scale->logarithmic ? rt_log(1 + value) / rt_log(1 + scale->most) : value / scale->most;
}

static double power_of_ten(int n) {
    double power = 1;
    for (int i = 0; i < n; i++) power *= 10;
    return power;
}

/* The value of mark `i`: 0 and powers of ten, or steps of fifths to halves of the range in round numbers. */
static double mark_value(const Scale *scale, int i) {
    if (scale->logarithmic) return i > 0 ? power_of_ten(i - 1) : 0;
    if (!(scale->most > 0)) return i;
    double power = 1; /* of ten, the greatest up to half the range */
    while (10 * power <= scale->most / 2) power *= 10;
    while (power > scale->most / 2) power /= 10;
    double step = scale->most / power >= 10 ? 5 * power : scale->most / power >= 5 ? 2 * power : power;
    return i * step;
}

static void draw_legend(RtImage *image, const Scale *scale, const char *name, int top, int dot) {
    int left = MARGIN * dot, width = (int)image->width - 2 * left;
    int marks = top + (MARGIN + BAR_HEIGHT) * dot, numbers = marks + 3 * dot;
    for (int x = 0; x < width; x++) {
        RtColor color = rt_color_scale((double)x / (width - 1));
        rt_draw_rectangle(image, left + x, top + MARGIN * dot, 1, BAR_HEIGHT * dot, color);
    }
    int free_from = 0; /* numbers that would run into the one before are left out */
    for (int i = 0; i < MOST_MARKS; i++) {
        double value = mark_value(scale, i);
        if (value > scale->most) break;
        char text[32];
        snprintf(text, sizeof text, "%.10g", value);
        int x = left + (int)(position(scale, value) * (width - 1)), half = rt_text_width(text) * dot / 2;
        rt_draw_rectangle(image, x, marks, dot, 2 * dot, white);
        int from = x - half > left ? x - half : left;
        if (from < free_from || from + 2 * half > (int)image->width) continue;
        rt_draw_text(image, from, numbers, dot, text, white);
        free_from = from + 2 * half + 4 * dot;
    }
    char title[128];
    snprintf(title, sizeof title, "%s  mean %.4g  most %.4g  %s", name, scale->mean, scale->most,
             scale->logarithmic ? "log" : "linear");
    rt_draw_text(image, left, numbers + (RT_TEXT_HEIGHT + MARGIN) * dot, dot, title, white);
}

RtStatus rt_heatmap(RtImage *image, const RtFrame *frame, size_t counter, RtError *error) {
    uint32_t width = frame->sampling.width, height = frame->sampling.height;
    uint32_t dot = width / LEGEND_WIDTH > 1 ? width / LEGEND_WIDTH : 1;
    uint32_t full_width = width > LEGEND_WIDTH * dot ? width : LEGEND_WIDTH * dot;
    RT_TRY(rt_image_init(image, full_width, height + LEGEND_HEIGHT * dot, error));
    rt_draw_rectangle(image, 0, 0, (int)image->width, (int)image->height, black);
    Scale scale = find_scale(frame, counter);
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++) {
            RtColor color = rt_color_scale(position(&scale, rt_frame_cost(frame, counter, x, y)));
            memcpy(image->rgb + 3 * ((size_t)y * image->width + x), color.rgb, 3);
        }
    }
    draw_legend(image, &scale, rt_tally_name(counter), (int)height, (int)dot);
    return RT_OK;
}
