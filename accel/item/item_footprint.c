/* SPDX-License-Identifier: Apache-2.0 */
/* The samples whose rays may hit an object, by projecting its box.
 *
 * The box is grown by E = 2^-19 M + 2^-21 |eye| (accel/raster/raster.h, 1). A hit is off the object's box by
 * the thickness, 2^-20 M, by 2^-23 of the eye's coordinates, and by three roundings of 2^-24 of both; what is
 * left covers the double arithmetic of this file. The part below tmin is cut off.
 *
 * A direction rounded to float32 is off by 2^-24 of its length, which moves its position in the image by less
 * than `direction_error`, and its component along the axis, which is 1, by less than that. */
#include "accel/item/item.h"

RtItemProjection rt_item_projection(const RtView *v) {
    double right = rt_lengthd(v->right), down = rt_lengthd(v->down);
    RtVec3d across = rt_scaled(v->right, 1 / (right * right));
    RtVec3d downward = rt_scaled(v->down, 1 / (down * down));
    /* Position i of n samples: (2 i + 1) / n - 1, or between corners 2 i / (n - 1) - 1. */
    const RtSampling *s = &v->sampling;
    double step[2] = {(s->corners ? s->columns - 1 : s->columns) * 0.5,
                      (s->corners ? s->rows - 1 : s->rows) * 0.5};
    double longest = 1.001 + right + down;
    return (RtItemProjection){
        .x = rt_add_scaledd(rt_scaled(across, step[0]), v->forward, (s->columns - 1) * 0.5),
        .y = rt_add_scaledd(rt_scaled(downward, step[1]), v->forward, (s->rows - 1) * 0.5),
        .depth = v->forward,
        .scale = {step[0] / right, step[1] / down},
        .longest = longest,
        .direction_error = 0x1p-22 * longest * (1 + 1 / right + 1 / down),
    };
}

/* A point relative to the eye: column and row times depth, and depth. */
typedef struct Projected {
    double x[2], w;
} Projected;

/* Bounds of columns, rows and depths; empty while lo > hi. */
typedef struct Bounds {
    double lo[2], hi[2], near;
    double zero[2]; /* an x at w = 0 that is as good as 0 */
} Bounds;

static void include(Bounds *b, const Projected *p) {
    b->near = fmin(b->near, p->w);
    for (int i = 0; i < 2; i++) {
        if (p->w > 0) {
            b->lo[i] = fmin(b->lo[i], p->x[i] / p->w);
            b->hi[i] = fmax(b->hi[i], p->x[i] / p->w);
        } else {
            if (p->x[i] < b->zero[i]) b->lo[i] = -INFINITY;
            if (p->x[i] > -b->zero[i]) b->hi[i] = INFINITY;
        }
    }
}

/* Where the edge between two corners passes depth `cut`. */
static Projected at_depth(const Projected *a, const Projected *b, double cut) {
    double part = (cut - a->w) / (b->w - a->w);
    return (Projected){{a->x[0] + part * (b->x[0] - a->x[0]), a->x[1] + part * (b->x[1] - a->x[1])}, cut};
}

/* The projection of the part of the grown box that is not less deep than `cut` >= 0. */
static Bounds project_box(const RtItemBuffer *buffer, const RtBox *box, double cut) {
    const RtItemProjection *to = &buffer->projection;
    RtVec3d ends[2] = {rt_subd(rt_widen(box->lo), buffer->view.eye),
                       rt_subd(rt_widen(box->hi), buffer->view.eye)};
    double reach = 0, eye = 0;
    for (int a = 0; a < 3; a++) {
        reach = fmax(reach, fmax(fabs(ends[0].at[a]), fabs(ends[1].at[a])));
        eye = fmax(eye, fabs(buffer->view.eye.at[a]));
    }
    double margin = 0x1p-19 * reach + 0x1p-21 * eye + 0x1p-120;
    Bounds bounds = {.lo = {INFINITY, INFINITY}, .hi = {-INFINITY, -INFINITY}, .near = INFINITY};
    bounds.zero[0] = 0x1p-40 * (reach + margin) * (to->scale[0] + buffer->view.sampling.columns);
    bounds.zero[1] = 0x1p-40 * (reach + margin) * (to->scale[1] + buffer->view.sampling.rows);
    Projected corners[8];
    for (int i = 0; i < 8; i++) {
        RtVec3d q;
        for (int a = 0; a < 3; a++) q.at[a] = i >> a & 1 ? ends[1].at[a] + margin : ends[0].at[a] - margin;
        corners[i] = (Projected){{rt_dotd(q, to->x), rt_dotd(q, to->y)}, rt_dotd(q, to->depth)};
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

bool rt_item_footprint(const RtItemBuffer *buffer, uint32_t id, RtItemFootprint *footprint) {
    const RtSampling *s = &buffer->view.sampling;
    const uint32_t count[2] = {s->columns, s->rows};
    float tmin = (float)buffer->view.near;
    double error = buffer->projection.direction_error;
    if (!(error <= RT_ITEM_MAX_DIRECTION_ERROR)) {
        *footprint = (RtItemFootprint){{0, 0}, {s->columns - 1, s->rows - 1}, tmin};
        return true;
    }
    Bounds b = project_box(buffer, &rt_item_geometry(buffer)->boxes[id], (double)tmin * (1 - error));
    for (int a = 0; a < 2; a++) {
        double grow = error * count[a] / 2, first = ceil(b.lo[a] - grow), last = floor(b.hi[a] + grow);
        if (!(last >= 0 && first < count[a] && first <= last)) return false;
        footprint->lo[a] = first > 0 ? (uint32_t)first : 0;
        footprint->hi[a] = last < count[a] ? (uint32_t)last : count[a] - 1;
    }
    footprint->near = rt_maxf(rt_float_below(b.near * (1 - error)), tmin);
    return true;
}
