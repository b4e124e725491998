/* SPDX-License-Identifier: Apache-2.0 */
#include "report/color.h"

#include "accel/accel.h"

#include <stdio.h>

/* How far from its colour candidate `k` of `count` with the same one is drawn: the only one not at all,
 * several evenly from dark to light in the order of the experiment. No part of a dark colour is darker. */
static double shade(uint32_t color, uint32_t k, uint32_t count) {
    const bool dark = (color & 0xff) < 0x40 && (color >> 8 & 0xff) < 0x40 && color >> 16 < 0x40;
    const double darkest = dark ? 0 : -0.6, lightest = dark ? 0.65 : 0.5;
    return count == 1 ? 0 : darkest + (lightest - darkest) * k / (count - 1);
}

/* From black, -1, to white, 1. */
static uint32_t shaded(uint32_t color, double part) {
    uint32_t out = 0;
    for (int shift = 16; shift >= 0; shift -= 8) {
        const double channel = color >> shift & 255, to = part < 0 ? 0 : 255;
        const double size = part < 0 ? -part : part;
        out = out << 8 | (uint32_t)(channel + size * (to - channel) + 0.5);
    }
    return out;
}

void rt_candidate_color(const RtExperiment *experiment, uint32_t candidate, char color[RT_COLOR_CHARS]) {
    enum { NULL_RUN = 0xbbbbbb };
    uint32_t out = NULL_RUN;
    if (candidate < experiment->candidate_count) {
        const uint32_t own = rt_accel_color(experiment->candidates[candidate].spec);
        uint32_t earlier = 0, all = 0;
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            bool same = rt_accel_color(experiment->candidates[c].spec) == own;
            earlier += same && c < candidate;
            all += same;
        }
        out = shaded(own, shade(own, earlier, all));
    }
    snprintf(color, RT_COLOR_CHARS, "#%06x", (unsigned)(out & 0xffffff));
}

int rt_plot_marker(uint32_t i) {
    /* Filled and open circles, squares, triangles, diamonds, ... */
    static const int markers[] = {7, 5, 9, 11, 13, 6, 4, 8, 10, 12};
    return markers[i % 10];
}

int rt_plot_dash(uint32_t i) {
    return (int)(1 + i / 10 % 5);
}
