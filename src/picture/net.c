/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/net.h"

#include "core/base/elementary.h"

/* The points p with normal . (p - middle) <= at. */
typedef struct Side {
    RtVec3d normal;
    double at;
} Side;

/* What the sides, in opposite pairs, have in common. */
typedef struct Body {
    Side sides[2 * RT_MAX_SLABS];
    uint32_t count;
    RtVec3d middle;
    double reach; /* from the middle: no point is farther */
} Body;

static void add_sides(Body *body, RtVec3d normal, double lo, double hi) {
    body->sides[body->count++] = (Side){normal, hi};
    body->sides[body->count++] = (Side){rt_scaled(normal, -1), -lo};
}

static void add_oriented(Body *body, const RtOrientedBox *box) {
    body->middle = box->center;
    body->reach = rt_lengthd(rt_vec3d(box->half[0], box->half[1], box->half[2]));
    for (int a = 0; a < 3; a++) add_sides(body, box->axes[a], -box->half[a], box->half[a]);
}

/* The first three sets are those of the axes. */
static void add_slabs(Body *body, const RtSlab *slabs, uint32_t count) {
    RtVec3d half;
    for (int a = 0; a < 3; a++) {
        body->middle.at[a] = ((double)slabs[a].lo + (double)slabs[a].hi) / 2;
        half.at[a] = ((double)slabs[a].hi - (double)slabs[a].lo) / 2;
    }
    body->reach = rt_lengthd(half);
    for (uint32_t i = 0; i < count; i++) {
        double middle = rt_dotd(body->middle, rt_slab_normals[i]);
        add_sides(body, rt_slab_normals[i], (double)slabs[i].lo - middle, (double)slabs[i].hi - middle);
    }
}

static Body body_of(const RtBoxView *view) {
    const RtExtentSet *set = view->extents;
    Body body = {.count = 0};
    if (set->kind == RT_EXTENT_OBB)
        add_oriented(&body, &set->oriented[view->extent]);
    else
        add_slabs(&body, set->slabs + (size_t)view->extent * set->slabs_each, set->slabs_each);
    return body;
}

bool rt_net_is_other(const RtBoxView *view) {
    return view->extents && view->extents->kind != RT_EXTENT_BOX;
}

/* Lengths that are nothing: sides may touch the body in an edge or a corner alone, but for rounding. */
static double tolerance(const Body *body) {
    return 1e-6 * (body->reach + rt_lengthd(body->middle));
}

/* ---- lines ---- */

/* Where sides i and j meet, as far as the others allow. */
static void show_edge(const Body *body, uint32_t i, uint32_t j, RtLineViewer viewer) {
    const Side *a = &body->sides[i], *b = &body->sides[j];
    RtVec3d along = rt_crossd(a->normal, b->normal);
    double squared = rt_dotd(along, along), from = -2 * body->reach, to = 2 * body->reach;
    if (squared < 1e-12) return;
    RtVec3d at = rt_scaled(rt_crossd(b->normal, along), a->at / squared);
    at = rt_add_scaledd(at, rt_crossd(along, a->normal), b->at / squared);
    along = rt_scaled(along, 1 / sqrt(squared));
    for (uint32_t k = 0; k < body->count; k++) {
        const Side *side = &body->sides[k];
        double speed = rt_dotd(side->normal, along);
        double room = side->at + tolerance(body) - rt_dotd(side->normal, at);
        if (k == i || k == j) continue;
        if (fabs(speed) < 1e-9 && room < 0) return;
        if (speed >= 1e-9) to = fmin(to, room / speed);
        if (speed <= -1e-9) from = fmax(from, room / speed);
    }
    if (to - from <= 8 * tolerance(body)) return; /* a corner */
    at = rt_add_scaledd(at, body->middle, 1);
    viewer.line(viewer.context, rt_add_scaledd(at, along, from), rt_add_scaledd(at, along, to));
}

/* Point `i` of RT_NET_CORNERS on the circle about `center` through center + u and center + v. */
static RtVec3d on_circle(RtVec3d center, RtVec3d u, RtVec3d v, uint32_t i) {
    RtTurn turn = rt_turn(360.0 * i / RT_NET_CORNERS);
    return rt_add_scaledd(rt_add_scaledd(center, u, turn.cosine), v, turn.sine);
}

/* A little wider, so that its chords lie outside: extents of spheres are the spheres that are seen. */
static void show_circle(RtVec3d center, RtVec3d u, RtVec3d v, RtLineViewer viewer) {
    const double wider = 1.003;
    u = rt_scaled(u, wider), v = rt_scaled(v, wider);
    for (uint32_t i = 0; i < RT_NET_CORNERS; i++)
        viewer.line(viewer.context, on_circle(center, u, v, i), on_circle(center, u, v, i + 1));
}

static RtVec3d axis_of_length(int axis, double length) {
    RtVec3d v = {{0, 0, 0}};
    v.at[axis] = length;
    return v;
}

/* Lines of sight touch it in a circle that is nearer than its centre. */
static void show_outline(const RtBall *ball, RtVec3d eye, RtLineViewer viewer) {
    RtVec3d away = rt_subd(ball->center, eye);
    double squared = rt_dotd(away, away), r = ball->radius;
    if (squared <= r * r) return;
    RtVec3d center = rt_add_scaledd(ball->center, away, -r * r / squared);
    double around = r * sqrt(1 - r * r / squared);
    RtVec3d u = rt_crossd(away, axis_of_length(fabs(away.x) < fabs(away.y) ? 0 : 1, 1));
    RtVec3d v = rt_crossd(away, u);
    show_circle(center, rt_scaled(u, around / rt_lengthd(u)), rt_scaled(v, around / rt_lengthd(v)), viewer);
}

static void show_ball(const RtBall *ball, RtVec3d eye, RtLineViewer viewer) {
    for (int a = 0; a < 3; a++)
        show_circle(ball->center, axis_of_length((a + 1) % 3, ball->radius),
                    axis_of_length((a + 2) % 3, ball->radius), viewer);
    show_outline(ball, eye, viewer);
}

static void show_box(const RtBox *box, RtLineViewer viewer) {
    RtVec3d corners[8]; /* bit a of the index: lo or hi along axis a */
    for (int i = 0; i < 8; i++) {
        for (int a = 0; a < 3; a++) corners[i].at[a] = (double)(i >> a & 1 ? box->hi : box->lo).at[a];
    }
    for (int i = 0; i < 8; i++) {
        for (int a = 0; a < 3; a++) {
            if (!(i >> a & 1)) viewer.line(viewer.context, corners[i], corners[i | 1 << a]);
        }
    }
}

static void show_body(const Body *body, RtLineViewer viewer) {
    for (uint32_t i = 0; i < body->count; i++) {
        for (uint32_t j = i + 1; j < body->count; j++) show_edge(body, i, j, viewer);
    }
}

void rt_net_lines(const RtBoxView *view, RtVec3d eye, RtLineViewer viewer) {
    if (!rt_net_is_other(view)) {
        show_box(view->box, viewer);
    } else if (view->extents->kind == RT_EXTENT_SPHERE) {
        show_ball(&view->extents->balls[view->extent], eye, viewer);
    } else {
        const Body body = body_of(view);
        show_body(&body, viewer);
    }
}

/* ---- sections ---- */

/* What is left of a polygon inside of a side (Sutherland & Hodgman 1974). */
static uint32_t cut_off(const Body *body, const Side *side, const RtVec3d *from, uint32_t count,
                        RtVec3d *to) {
    uint32_t left = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d a = from[i], b = from[(i + 1) % count];
        double at_a = side->at + tolerance(body) - rt_dotd(side->normal, rt_subd(a, body->middle));
        double at_b = side->at + tolerance(body) - rt_dotd(side->normal, rt_subd(b, body->middle));
        if (at_a >= 0) to[left++] = a;
        if ((at_a < 0) != (at_b < 0)) to[left++] = rt_add_scaledd(a, rt_subd(b, a), at_a / (at_a - at_b));
    }
    return left;
}

uint32_t rt_net_section(const RtBoxView *view, int axis, double at, RtVec3d corners[RT_NET_CORNERS]) {
    int across = (axis + 1) % 3, up = (axis + 2) % 3;
    if (view->extents->kind == RT_EXTENT_SPHERE) {
        const RtBall *ball = &view->extents->balls[view->extent];
        RtVec3d center = ball->center;
        double off = at - center.at[axis], around = ball->radius * ball->radius - off * off;
        if (!(around > 0)) return 0;
        center.at[axis] = at;
        for (uint32_t i = 0; i < RT_NET_CORNERS; i++)
            corners[i] =
                on_circle(center, axis_of_length(across, sqrt(around)), axis_of_length(up, sqrt(around)), i);
        return RT_NET_CORNERS;
    }
    Body body = body_of(view);
    RtVec3d other[RT_NET_CORNERS];
    uint32_t count = 4;
    for (uint32_t i = 0; i < count; i++) { /* a square around all of it; each side adds a corner at most */
        corners[i] = body.middle;
        corners[i].at[axis] = at;
        corners[i].at[across] += i == 0 || i == 3 ? -2 * body.reach : 2 * body.reach;
        corners[i].at[up] += i < 2 ? -2 * body.reach : 2 * body.reach;
    }
    for (uint32_t k = 0; k < body.count && count > 0; k++) {
        count = cut_off(&body, &body.sides[k], corners, count, other);
        for (uint32_t i = 0; i < count; i++) corners[i] = other[i];
    }
    return count;
}
