/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/extent_outline.h"

#include "core/base/elementary.h"

/* The points p with normal . (p - middle) <= at. */
typedef struct Side {
    RtVec3d normal;
    double at;
} Side;

/* A convex polytope: the intersection of its sides, in opposite pairs. */
typedef struct Polytope {
    Side sides[2 * RT_MAX_SLABS];
    uint32_t count;
    RtVec3d middle;
    double reach; /* the largest distance of a point from the middle */
} Polytope;

static void add_sides(Polytope *p, RtVec3d normal, double lo, double hi) {
    p->sides[p->count++] = (Side){normal, hi};
    p->sides[p->count++] = (Side){rt_scaled(normal, -1), -lo};
}

static void add_oriented(Polytope *p, const RtOrientedBox *box) {
    p->middle = box->center;
    p->reach = rt_lengthd(rt_vec3d(box->half[0], box->half[1], box->half[2]));
    for (int a = 0; a < 3; a++) add_sides(p, box->axes[a], -box->half[a], box->half[a]);
}

/* The first three slabs are those of the axes. */
static void add_slabs(Polytope *p, const RtSlab *slabs, uint32_t count) {
    RtVec3d half;
    for (int a = 0; a < 3; a++) {
        p->middle.at[a] = ((double)slabs[a].lo + (double)slabs[a].hi) / 2;
        half.at[a] = ((double)slabs[a].hi - (double)slabs[a].lo) / 2;
    }
    p->reach = rt_lengthd(half);
    for (uint32_t i = 0; i < count; i++) {
        double middle = rt_dotd(p->middle, rt_slab_normals[i]);
        add_sides(p, rt_slab_normals[i], (double)slabs[i].lo - middle, (double)slabs[i].hi - middle);
    }
}

static Polytope polytope_of(const RtBoxView *view) {
    const RtExtentSet *set = view->extents;
    Polytope p = {.count = 0};
    if (set->kind == RT_EXTENT_OBB)
        add_oriented(&p, &set->oriented[view->extent]);
    else
        add_slabs(&p, set->slabs + (size_t)view->extent * set->slabs_each, set->slabs_each);
    return p;
}

RtExtentKind rt_outline_kind(const RtBoxView *view) {
    return view->extents ? view->extents->kind : RT_EXTENT_BOX;
}

/* Shorter lengths are rounding: a side may touch the polytope only in an edge or a corner. */
static double tolerance(const Polytope *p) {
    return 1e-6 * (p->reach + rt_lengthd(p->middle));
}

/* ---- lines ---- */

/* Emits the line in which sides i and j meet, clipped by the other sides. */
static void show_edge(const Polytope *p, uint32_t i, uint32_t j, RtLineViewer viewer) {
    const Side *a = &p->sides[i], *b = &p->sides[j];
    RtVec3d along = rt_crossd(a->normal, b->normal);
    double squared = rt_dotd(along, along), from = -2 * p->reach, to = 2 * p->reach;
    if (squared < 1e-12) return;
    RtVec3d at = rt_scaled(rt_crossd(b->normal, along), a->at / squared);
    at = rt_add_scaledd(at, rt_crossd(along, a->normal), b->at / squared);
    along = rt_scaled(along, 1 / sqrt(squared));
    for (uint32_t k = 0; k < p->count; k++) {
        const Side *side = &p->sides[k];
        double speed = rt_dotd(side->normal, along);
        double room = side->at + tolerance(p) - rt_dotd(side->normal, at);
        if (k == i || k == j) continue;
        if (fabs(speed) < 1e-9 && room < 0) return;
        if (speed >= 1e-9) to = fmin(to, room / speed);
        if (speed <= -1e-9) from = fmax(from, room / speed);
    }
    if (to - from <= 8 * tolerance(p)) return; /* a corner */
    at = rt_add_scaledd(at, p->middle, 1);
    viewer.line(viewer.context, rt_add_scaledd(at, along, from), rt_add_scaledd(at, along, to));
}

/* Point `i` of RT_OUTLINE_CORNERS on the circle about `center` through center + u and center + v. */
static RtVec3d on_circle(RtVec3d center, RtVec3d u, RtVec3d v, uint32_t i) {
    RtTurn turn = rt_turn(360.0 * i / RT_OUTLINE_CORNERS);
    return rt_add_scaledd(rt_add_scaledd(center, u, turn.cosine), v, turn.sine);
}

/* Slightly enlarged, so that its chords lie outside: the extent may be the visible sphere itself. */
static void show_circle(RtVec3d center, RtVec3d u, RtVec3d v, RtLineViewer viewer) {
    const double wider = 1.003;
    u = rt_scaled(u, wider), v = rt_scaled(v, wider);
    for (uint32_t i = 0; i < RT_OUTLINE_CORNERS; i++)
        viewer.line(viewer.context, on_circle(center, u, v, i), on_circle(center, u, v, i + 1));
}

static RtVec3d axis_of_length(int axis, double length) {
    RtVec3d v = {{0, 0, 0}};
    v.at[axis] = length;
    return v;
}

/* Lines of sight touch a sphere in a circle nearer than its centre. */
static void show_silhouette(const RtBall *ball, RtVec3d eye, RtLineViewer viewer) {
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
    show_silhouette(ball, eye, viewer);
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

static void show_polytope(const Polytope *p, RtLineViewer viewer) {
    for (uint32_t i = 0; i < p->count; i++) {
        for (uint32_t j = i + 1; j < p->count; j++) show_edge(p, i, j, viewer);
    }
}

void rt_outline_edges(const RtBoxView *view, RtVec3d eye, RtLineViewer viewer) {
    RtExtentKind kind = rt_outline_kind(view);
    if (kind == RT_EXTENT_BOX) {
        show_box(view->box, viewer);
    } else if (kind == RT_EXTENT_SPHERE) {
        show_ball(&view->extents->balls[view->extent], eye, viewer);
    } else {
        const Polytope p = polytope_of(view);
        show_polytope(&p, viewer);
    }
}

/* ---- sections ---- */

/* A rectangle around `middle`, `half` to either side. */
static uint32_t rectangle(RtVec3d middle, RtVec3d half, RtSectionPlane plane, RtPoint *corners) {
    for (int i = 0; i < 4; i++) {
        int right = i == 1 || i == 2 ? 1 : -1, top = i >= 2 ? 1 : -1;
        corners[i].x = middle.at[plane.across] + right * half.at[plane.across];
        corners[i].y = middle.at[plane.up] + top * half.at[plane.up];
    }
    return 4;
}

static uint32_t section_of_box(const RtBox *box, RtSectionPlane plane, RtPoint *corners) {
    RtVec3d lo = rt_widen(box->lo), hi = rt_widen(box->hi);
    if (plane.at < lo.at[plane.axis] || plane.at > hi.at[plane.axis]) return 0;
    return rectangle(rt_scaled(rt_addd(lo, hi), 0.5), rt_scaled(rt_subd(hi, lo), 0.5), plane, corners);
}

static uint32_t section_of_ball(const RtBall *ball, RtSectionPlane plane, RtPoint *corners) {
    double off = plane.at - ball->center.at[plane.axis], squared = ball->radius * ball->radius - off * off;
    if (!(squared > 0)) return 0;
    for (int i = 0; i < RT_OUTLINE_CORNERS; i++) {
        RtTurn turn = rt_turn(360.0 * i / RT_OUTLINE_CORNERS);
        corners[i].x = ball->center.at[plane.across] + sqrt(squared) * turn.cosine;
        corners[i].y = ball->center.at[plane.up] + sqrt(squared) * turn.sine;
    }
    return RT_OUTLINE_CORNERS;
}

uint32_t rt_outline_section(const RtBoxView *view, RtSectionPlane plane,
                            RtPoint corners[RT_OUTLINE_CORNERS]) {
    RtExtentKind kind = rt_outline_kind(view);
    if (kind == RT_EXTENT_BOX) return section_of_box(view->box, plane, corners);
    if (kind == RT_EXTENT_SPHERE) return section_of_ball(&view->extents->balls[view->extent], plane, corners);
    const Polytope p = polytope_of(view);
    RtVec3d around = rt_vec3d(2 * p.reach, 2 * p.reach, 2 * p.reach);
    uint32_t count = rectangle(p.middle, around, plane, corners); /* each side adds a corner at most */
    for (uint32_t k = 0; k < p.count && count > 0; k++) {
        RtVec3d normal = p.sides[k].normal;
        double room =
            p.sides[k].at + tolerance(&p) + rt_dotd(normal, p.middle) - normal.at[plane.axis] * plane.at;
        count = rt_polygon_cut(corners, count, (RtPoint){normal.at[plane.across], normal.at[plane.up]}, room);
    }
    return count;
}

bool rt_outline_cut_flat(const RtVec3 *corners, uint32_t count, RtVec3d on, RtVec3d normal, RtVec3d cut[2]) {
    int crossings = 0;
    for (uint32_t i = 0; i < count && crossings < 2; i++) {
        RtVec3d a = rt_widen(corners[i]), b = rt_widen(corners[(i + 1) % count]);
        double at_a = rt_dotd(rt_subd(a, on), normal), at_b = rt_dotd(rt_subd(b, on), normal);
        if ((at_a < 0) != (at_b < 0))
            cut[crossings++] = rt_add_scaledd(a, rt_subd(b, a), at_a / (at_a - at_b));
    }
    return crossings == 2;
}
