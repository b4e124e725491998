/* SPDX-License-Identifier: Apache-2.0 */
/* Footprints: the samples whose rays may hit an object, by projecting its box.
 *
 * Why they are complete. A hit at t means (core/base/ray.h) that the ray's point at t is in the object's box
 * but for the thickness, 2^-20 of the largest distance D between eye and box along an axis, 2^-23 of the
 * eye's coordinates, and three roundings of 2^-24 each of both. So it is in the box grown by
 *
 *     margin = 2^-19 D + 2^-21 |eye|,
 *
 * with room to spare for the double arithmetic of this file. That box, cut off where t would be below tmin,
 * is a convex body in front of the eye, and a projection of such a body is reached at its corners; where it
 * comes up to the plane of the eye it reaches to infinity, on the side on which it does (that is all that
 * clipping homogeneous coordinates at w = 0 comes to).
 *
 * A direction is rounded to float32: it is off by 2^-24 of its length, which moves its position in the image
 * by less than `blur`, and its component along the axis, 1, by less than that. */
#include "accel/item/item.h"

void rt_item_aim(RtItemBuffer *buffer) {
    const RtView *v = &buffer->view;
    double right = rt_lengthd(v->right), down = rt_lengthd(v->down);
    buffer->across = rt_scaled(v->right, 1 / (right * right));
    buffer->downward = rt_scaled(v->down, 1 / (down * down));
    /* Position i of n samples: (2 i + 1) / n - 1, or between corners 2 i / (n - 1) - 1. */
    const RtSampling *s = &v->sampling;
    double step[2] = {(s->corners ? s->columns - 1 : s->columns) * 0.5,
                      (s->corners ? s->rows - 1 : s->rows) * 0.5};
    double start[2] = {(s->columns - 1) * 0.5, (s->rows - 1) * 0.5};
    double longest = 1.001 + right + down;
    buffer->aim = (RtItemAim){
        .x = rt_add_scaledd(rt_scaled(buffer->across, step[0]), v->forward, start[0]),
        .y = rt_add_scaledd(rt_scaled(buffer->downward, step[1]), v->forward, start[1]),
        .depth = v->forward,
        .scale = {step[0] / right, step[1] / down},
        .longest = longest,
        .blur = 0x1p-22 * longest * (1 + 1 / right + 1 / down),
    };
}

/* A point relative to the eye: position times depth, and depth. */
typedef struct Projected {
    double x[2], w;
} Projected;

static Projected project(const RtItemBuffer *buffer, RtVec3d q) {
    return (Projected){{rt_dotd(q, buffer->across), rt_dotd(q, buffer->downward)},
                       rt_dotd(q, buffer->view.forward)};
}

/* What corners have in common; empty while lo > hi. */
typedef struct Bounds {
    double lo[2], hi[2], near;
    double zero; /* an x at w = 0 that is as good as 0 */
} Bounds;

static void include(Bounds *b, const Projected *p) {
    b->near = fmin(b->near, p->w);
    for (int i = 0; i < 2; i++) {
        if (p->w > 0) {
            b->lo[i] = fmin(b->lo[i], p->x[i] / p->w);
            b->hi[i] = fmax(b->hi[i], p->x[i] / p->w);
        } else {
            if (p->x[i] < b->zero) b->lo[i] = -INFINITY;
            if (p->x[i] > -b->zero) b->hi[i] = INFINITY;
        }
    }
}

/* Where the edge between two corners passes depth `cut`. */
static Projected at_depth(const Projected *a, const Projected *b, double cut) {
    double part = (cut - a->w) / (b->w - a->w);
    return (Projected){{a->x[0] + part * (b->x[0] - a->x[0]), a->x[1] + part * (b->x[1] - a->x[1])}, cut};
}

/* The projection of the part of a box, grown by the margin, that is not less deep than `cut` >= 0. */
static Bounds project_box(const RtItemBuffer *buffer, const RtBox *box, double cut) {
    RtVec3d ends[2] = {rt_subd(rt_widen(box->lo), buffer->view.eye),
                       rt_subd(rt_widen(box->hi), buffer->view.eye)};
    double reach = 0, eye = 0;
    for (int a = 0; a < 3; a++) {
        reach = fmax(reach, fmax(fabs(ends[0].at[a]), fabs(ends[1].at[a])));
        eye = fmax(eye, fabs(buffer->view.eye.at[a]));
    }
    double margin = 0x1p-19 * reach + 0x1p-21 * eye + 0x1p-120;
    Bounds bounds = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}, INFINITY, 0x1p-40 * (reach + margin)};
    Projected corners[8];
    for (int i = 0; i < 8; i++) {
        RtVec3d q;
        for (int a = 0; a < 3; a++) q.at[a] = i >> a & 1 ? ends[1].at[a] + margin : ends[0].at[a] - margin;
        corners[i] = project(buffer, q);
        if (corners[i].w >= cut) include(&bounds, &corners[i]);
    }
    for (int i = 0; i < 8; i++) {
        for (int a = 0; a < 3; a++) {
            int k = i | 1 << a;
            if (k == i || (corners[i].w < cut) == (corners[k].w < cut)) continue;
            Projected p = at_depth(&corners[i], &corners[k], cut);
            include(&bounds, &p);
        }
    }
    return bounds;
}

/* The samples of a row or column at positions lo..hi; false if there are none. */
static bool samples_between(double lo, double hi, uint32_t n, bool corners, uint32_t *first, uint32_t *last) {
    double step = corners ? (n - 1) * 0.5 : n * 0.5, start = corners ? 0 : -0.5;
    double from = ceil((lo + 1) * step + start), to = floor((hi + 1) * step + start);
    if (!(to >= 0 && from < n && from <= to)) return false;
    *first = from > 0 ? (uint32_t)from : 0;
    *last = to < n ? (uint32_t)to : n - 1;
    return true;
}

bool rt_item_footprint(const RtItemBuffer *buffer, uint32_t id, RtItemFootprint *footprint) {
    const RtSampling *s = &buffer->view.sampling;
    float tmin = (float)buffer->view.near;
    double blur = buffer->aim.blur;
    if (!(blur <= RT_ITEM_MOST_BLUR)) {
        *footprint = (RtItemFootprint){{0, 0}, {s->columns - 1, s->rows - 1}, tmin};
        return true;
    }
    Bounds b = project_box(buffer, &buffer->isa.base.scene->geometry.boxes[id], (double)tmin * (1 - blur));
    if (!samples_between(b.lo[0] - blur, b.hi[0] + blur, s->columns, s->corners, &footprint->lo[0],
                         &footprint->hi[0]) ||
        !samples_between(b.lo[1] - blur, b.hi[1] + blur, s->rows, s->corners, &footprint->lo[1],
                         &footprint->hi[1])) {
        return false;
    }
    footprint->near = rt_maxf(rt_float_below(b.near * (1 - blur)), tmin);
    return true;
}
