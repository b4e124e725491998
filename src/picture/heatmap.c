/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/pictures.h"

#include "picture/canvas.h"

enum { LEAST_WIDTH = 240, GAP = 4 }; /* pixels */

typedef struct Statistics {
    double most, mean;
} Statistics;

typedef struct Drawing {
    cairo_t *cairo;
    const RtHeatmapPanel *panels;
    const RtHeatmapOptions *options;
    uint32_t count;         /* of panels, without the difference */
    uint32_t columns, rows; /* pixels of a panel */
    uint32_t width;         /* of the whole picture */
    uint32_t pitch;         /* from a panel to the next, pixels */
    double em, pad, top;    /* the font size; around text; where panels begin */
    RtScale scale, difference;
} Drawing;

/* The value of a pixel; panel `count` is the difference. */
static double value_of(const Drawing *d, uint32_t panel, uint32_t x, uint32_t y) {
    if (panel == d->count) return value_of(d, 0, x, y) - value_of(d, 1, x, y);
    return rt_frame_cost(d->panels[panel].frame, d->options->counter, x, y);
}

static Statistics statistics_of(const Drawing *d, uint32_t panel) {
    Statistics found = {0};
    for (uint32_t y = 0; y < d->rows; y++) {
        for (uint32_t x = 0; x < d->columns; x++) {
            double value = value_of(d, panel, x, y);
            found.most = fmax(found.most, fabs(value));
            found.mean += value / ((double)d->columns * d->rows);
        }
    }
    return found;
}

static void find_scales(Drawing *d) {
    double most = 0, mean = 0;
    for (uint32_t i = 0; i < d->count; i++) {
        Statistics panel = statistics_of(d, i);
        most = fmax(most, panel.most);
        mean += panel.mean / d->count;
    }
    bool skewed = mean < most / 8; /* a linear scale would be almost all dark */
    d->scale = (RtScale){.most = d->options->most > 0 ? d->options->most : most,
                         .logarithmic = d->options->scale == RT_HEATMAP_LOG ||
                                        (d->options->scale == RT_HEATMAP_AUTO && skewed)};
    if (!d->options->difference) return;
    d->difference.most = d->options->most > 0 ? d->options->most : statistics_of(d, d->count).most;
    d->difference.least = -d->difference.most;
}

typedef struct Panel {
    const Drawing *drawing;
    uint32_t number;
} Panel;

static RtColor color_at(const void *panel, uint32_t x, uint32_t y) {
    const Panel *p = panel;
    const Drawing *d = p->drawing;
    const double value = value_of(d, p->number, x, y);
    if (p->number < d->count) return rt_color_scale(rt_scale_position(&d->scale, value));
    return rt_color_difference(d->difference.most > 0 ? value / d->difference.most : 0);
}

static RtStatus draw_panel(const Drawing *d, uint32_t panel, RtError *error) {
    Statistics found = statistics_of(d, panel);
    char label[256], text[160];
    bool only = d->count + d->options->difference == 1;
    double left = panel * d->pitch, room = (only ? d->width : d->pitch - GAP) - 2 * d->pad;
    const RtPixels pixels = {d->columns, d->rows, color_at, &(Panel){d, panel}};
    RT_TRY(rt_paint_pixels(d->cairo, pixels, left, d->top, error));
    if (panel < d->count) {
        snprintf(label, sizeof label, "%s", d->panels[panel].label ? d->panels[panel].label : "");
        snprintf(text, sizeof text, "mean %.4g, max %.4g", found.mean, found.most);
    } else {
        snprintf(label, sizeof label, "%s - %s", d->panels[0].label, d->panels[1].label);
        snprintf(text, sizeof text, "mean %.4g", found.mean);
    }
    rt_draw_text_within(d->cairo, left + d->pad, d->pad + d->em, room, RT_BLACK, label);
    rt_draw_text_within(d->cairo, left + d->pad, d->top + d->rows + d->pad + d->em, room, RT_BLACK, text);
    return RT_OK;
}

static void draw_legend(const Drawing *d) {
    double top = d->top + d->rows + d->pad + RT_LINE * d->em;
    double width = d->options->difference ? 2 * d->pitch - GAP : d->width;
    rt_draw_scale(d->cairo, d->pad, top, width - 2 * d->pad, &d->scale);
    if (d->options->difference)
        rt_draw_scale(d->cairo, 2 * d->pitch + d->pad, top, d->pitch - GAP - 2 * d->pad, &d->difference);
    rt_draw_text(d->cairo, d->pad, top + RT_SCALE_HEIGHT * d->em + d->em, RT_BLACK, "%s, %s, %s rays",
                 rt_tally_name(d->options->counter), d->scale.logarithmic ? "log" : "linear",
                 d->options->rays ? d->options->rays : "all");
}

RtStatus rt_heatmap_draw(const char *file, const RtHeatmapPanel *panels, uint32_t count,
                         const RtHeatmapOptions *options, RtError *error) {
    const RtSampling *s = &panels[0].frame->sampling;
    RtCanvas canvas;
    Drawing d = {
        .panels = panels, .options = options, .count = count, .columns = s->width, .rows = s->height};
    uint32_t all = count + options->difference;
    d.pitch = s->width + GAP > LEAST_WIDTH || all == 1 ? s->width + GAP : LEAST_WIDTH;
    d.width = all * d.pitch - GAP > LEAST_WIDTH ? all * d.pitch - GAP : LEAST_WIDTH;
    d.em = rt_font_size(all > 1 ? s->width : d.width);
    d.pad = 0.5 * d.em;
    d.top = panels[0].label ? ceil((RT_LINE + 0.3) * d.em) : 0;
    double below = ceil(2 * d.pad + 2 * RT_LINE * d.em + RT_SCALE_HEIGHT * d.em);
    find_scales(&d);
    RT_TRY(rt_canvas_open(&canvas, file, d.width, d.top + s->height + below, d.em, error));
    d.cairo = canvas.cairo;
    RtStatus status = RT_OK;
    for (uint32_t i = 0; i < all && status == RT_OK; i++) status = draw_panel(&d, i, error);
    draw_legend(&d);
    return rt_canvas_close(&canvas, status, error);
}
