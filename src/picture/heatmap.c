/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/heatmap.h"

#include "picture/draw.h"

#include <stdio.h>
#include <string.h>

enum { MARGIN = 4, LINE = 11, BARS = 24, LEAST_WIDTH = 240, GAP = 4 }; /* dots, dots, dots, pixels, pixels */

typedef struct Statistics {
    double most, mean;
} Statistics;

typedef struct Drawing {
    const RtHeatmapPanel *panels;
    const RtHeatmapOptions *options;
    uint32_t count;         /* of panels, without the difference */
    uint32_t width, height; /* of a panel's picture */
    uint32_t pitch;         /* from a panel to the next, pixels */
    int dot, top;           /* where pictures begin */
    RtScale scale, difference;
} Drawing;

static double cost(const Drawing *d, uint32_t panel, uint32_t x, uint32_t y) {
    return rt_frame_cost(d->panels[panel].frame, d->options->counter, x, y);
}

static double difference(const Drawing *d, uint32_t x, uint32_t y) {
    return cost(d, 0, x, y) - cost(d, 1, x, y);
}

static Statistics look_at(const Drawing *d, uint32_t panel) {
    Statistics found = {0};
    for (uint32_t y = 0; y < d->height; y++) {
        for (uint32_t x = 0; x < d->width; x++) {
            double value = cost(d, panel, x, y);
            found.most = fmax(found.most, value);
            found.mean += value / ((double)d->width * d->height);
        }
    }
    return found;
}

static void find_scales(Drawing *d) {
    double most = 0, mean = 0;
    for (uint32_t i = 0; i < d->count; i++) {
        Statistics panel = look_at(d, i);
        most = fmax(most, panel.most);
        mean += panel.mean / d->count;
    }
    bool skewed = mean < most / 8; /* a linear scale would be one dark field */
    d->scale = (RtScale){.most = d->options->most > 0 ? d->options->most : most,
                         .logarithmic = d->options->scale == RT_HEATMAP_LOG ||
                                        (d->options->scale == RT_HEATMAP_AUTO && skewed)};
    for (uint32_t i = 0; d->options->difference && i < d->width * d->height; i++)
        d->difference.most = fmax(d->difference.most, fabs(difference(d, i % d->width, i / d->width)));
    if (d->options->difference && d->options->most > 0) d->difference.most = d->options->most;
    d->difference.least = -d->difference.most;
}

static void put_pixel(RtImage *image, const Drawing *d, uint32_t panel, uint32_t x, uint32_t y,
                      RtColor color) {
    memcpy(image->rgb + 3 * (((size_t)y + (uint32_t)d->top) * image->width + (size_t)panel * d->pitch + x),
           color.rgb, 3);
}

/* As much of a text as fits into a panel, or, in a single one, into the image. */
static void put_text(RtImage *image, const Drawing *d, uint32_t panel, int y, const char *text) {
    char part[160];
    uint32_t room = d->options->difference || d->count > 1 ? d->pitch - GAP : image->width;
    size_t fits = (room - 2 * MARGIN * (uint32_t)d->dot) / (6 * (uint32_t)d->dot);
    snprintf(part, sizeof part, "%.*s", (int)(fits < sizeof part ? fits : sizeof part - 1), text);
    rt_draw_text(image, (int)(panel * d->pitch) + MARGIN * d->dot, y, d->dot, part, RT_WHITE);
}

static void draw_panel(RtImage *image, const Drawing *d, uint32_t panel) {
    Statistics found = look_at(d, panel);
    char text[160];
    for (uint32_t y = 0; y < d->height; y++) {
        for (uint32_t x = 0; x < d->width; x++)
            put_pixel(image, d, panel, x, y,
                      rt_color_scale(rt_scale_position(&d->scale, cost(d, panel, x, y))));
    }
    if (d->top > 0) put_text(image, d, panel, MARGIN * d->dot, d->panels[panel].label);
    snprintf(text, sizeof text, "mean %.4g  most %.4g", found.mean, found.most);
    put_text(image, d, panel, d->top + (int)d->height + MARGIN * d->dot, text);
}

static void draw_difference(RtImage *image, const Drawing *d) {
    double sum = 0;
    char text[160];
    for (uint32_t y = 0; y < d->height; y++) {
        for (uint32_t x = 0; x < d->width; x++) {
            double value = difference(d, x, y), most = d->difference.most;
            sum += value;
            put_pixel(image, d, 2, x, y, rt_color_difference(most > 0 ? value / most : 0));
        }
    }
    snprintf(text, sizeof text, "%s - %s", d->panels[0].label, d->panels[1].label);
    put_text(image, d, 2, MARGIN * d->dot, text);
    snprintf(text, sizeof text, "mean %.4g", sum / ((double)d->width * d->height));
    put_text(image, d, 2, d->top + (int)d->height + MARGIN * d->dot, text);
}

static void draw_legend(RtImage *image, const Drawing *d) {
    int top = d->top + (int)d->height + (MARGIN + LINE) * d->dot, left = MARGIN * d->dot;
    uint32_t width = d->options->difference ? 2 * d->pitch - GAP : image->width;
    char text[160];
    rt_draw_scale(image, left, top, (int)width - 2 * left, d->dot, &d->scale);
    if (d->options->difference)
        rt_draw_scale(image, (int)(2 * d->pitch) + left, top, (int)(d->pitch - GAP) - 2 * left, d->dot,
                      &d->difference);
    snprintf(text, sizeof text, "%s  %s  %s rays", rt_tally_name(d->options->counter),
             d->scale.logarithmic ? "log" : "linear", d->options->rays ? d->options->rays : "all");
    rt_draw_text(image, left, top + BARS * d->dot, d->dot, text, RT_WHITE);
}

RtStatus rt_heatmap(RtImage *image, const RtHeatmapPanel *panels, uint32_t count,
                    const RtHeatmapOptions *options, RtError *error) {
    const RtSampling *s = &panels[0].frame->sampling;
    uint32_t all = count + options->difference;
    uint32_t pitch = s->width + GAP > LEAST_WIDTH || all == 1 ? s->width + GAP : LEAST_WIDTH;
    uint32_t width = all * pitch - GAP > LEAST_WIDTH ? all * pitch - GAP : LEAST_WIDTH;
    int dot = rt_text_dot(all > 1 ? s->width : width);
    Drawing d = {.panels = panels,
                 .options = options,
                 .count = count,
                 .width = s->width,
                 .height = s->height,
                 .pitch = pitch,
                 .dot = dot,
                 .top = panels[0].label ? (MARGIN + LINE) * dot : 0};
    find_scales(&d);
    uint32_t below = (uint32_t)((2 * MARGIN + 2 * LINE + BARS) * dot);
    RT_TRY(rt_image_init(image, width, (uint32_t)d.top + s->height + below, error));
    for (uint32_t i = 0; i < count; i++) draw_panel(image, &d, i);
    if (options->difference) draw_difference(image, &d);
    draw_legend(image, &d);
    return RT_OK;
}
