/* SPDX-License-Identifier: Apache-2.0 */
#include "report/color.h"

#include "accel/accel.h"

#include <stdio.h>
#include <string.h>

/* In the order of the registry. The first seven and black are Okabe & Ito's (2008), told apart by
 * colour-blind readers too; the others differ from them in lightness. */
static const uint32_t colors[] = {0x7f7f7f, 0xd55e00, 0x0072b2, 0xcc79a7, 0xe69f00, 0x009e73, 0x56b4e9,
                                  0x5b4a9f, 0x222222, 0xa6761d, 0x66a61e, 0xb2182b, 0x7b3294, 0x17becf};
enum { COLOR_COUNT = sizeof colors / sizeof colors[0], NULL_RUN = 0xbbbbbb };

/* The name of the topmost accelerator of a spec. */
static size_t top_of(const char *spec) {
    return strcspn(spec, ":+");
}

static bool has_top(const char *spec, const char *name, size_t length) {
    return top_of(spec) == length && strncmp(spec, name, length) == 0;
}

static uint32_t family_color(const char *spec) {
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const char *name = rt_accel_at(i)->name;
        if (has_top(spec, name, strlen(name))) return colors[i % COLOR_COUNT];
    }
    return colors[rt_accel_count() % COLOR_COUNT]; /* a plugin that is not loaded */
}

/* 0, -1/2, 1/4, -1/4, 1/8, -3/8, ...: in (-1/2, 1/2], no number twice, and far from those before. */
static double spread(uint32_t k) {
    double sum = 0, part = 0.5;
    for (; k; k >>= 1, part /= 2) sum += k & 1 ? part : 0;
    return sum < 0.5 ? sum : sum - 1;
}

/* From black, -1, to white, 1. */
static uint32_t shaded(uint32_t color, double shade) {
    uint32_t out = 0;
    for (int shift = 16; shift >= 0; shift -= 8) {
        const double channel = color >> shift & 255, to = shade < 0 ? 0 : 255;
        const double size = shade < 0 ? -shade : shade;
        out = out << 8 | (uint32_t)(channel + size * (to - channel) + 0.5);
    }
    return out;
}

static RtLook look(uint32_t color, uint32_t i) {
    /* Filled and open circles, squares, triangles, diamonds, ... */
    static const int markers[] = {7, 5, 9, 11, 13, 6, 4, 8, 10, 12};
    RtLook look = {.marker = markers[i % 10], .dash = (int)(1 + i / 10 % 5)};
    snprintf(look.color, sizeof look.color, "#%06x", (unsigned)(color & 0xffffff));
    return look;
}

RtLook rt_candidate_look(const RtExperiment *experiment, uint32_t candidate) {
    if (candidate >= experiment->candidate_count) return look(NULL_RUN, candidate);
    const char *spec = experiment->candidates[candidate].spec;
    uint32_t earlier = 0;
    for (uint32_t c = 0; c < candidate; c++)
        earlier += has_top(experiment->candidates[c].spec, spec, top_of(spec));
    return look(shaded(family_color(spec), 0.9 * spread(earlier)), candidate);
}

RtLook rt_look(uint32_t i) {
    return look(shaded(colors[i % COLOR_COUNT], 0.9 * spread(i / COLOR_COUNT)), i);
}
