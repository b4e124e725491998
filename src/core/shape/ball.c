/* SPDX-License-Identifier: Apache-2.0 */
/* Smallest enclosing balls, by few points that span one: as long as a point lies outside the smallest ball
 * about those, the farthest joins them, and those that the next ball does not need leave. The ball grows at
 * every step, so no choice comes back (an LP-type problem: Sharir & Welzl 1992). For coplanar points a ball
 * is spanned by two or by three of them, so that at most four are looked at together; three points are always
 * coplanar, and so are those of a planar polygon. */
#include "core/shape/ball.h"

static double distance_squared(RtVec3d a, RtVec3d b) {
    RtVec3d d = rt_subd(a, b);
    return rt_dotd(d, d);
}

/* The ball about `center` that holds all points, and no larger. */
static RtBall ball_about(RtVec3d center, const RtVec3 *points, size_t count) {
    double most = 0;
    for (size_t i = 0; i < count; i++) {
        double d = distance_squared(center, rt_widen(points[i]));
        most = d > most ? d : most;
    }
    return (RtBall){center, sqrt(most) * (1 + 0x1p-50)};
}

/* Circumcentre of a triangle; false if the points lie on a line. */
static bool circumcenter(RtVec3d a, RtVec3d b, RtVec3d c, RtVec3d *center) {
    RtVec3d ab = rt_subd(b, a), ac = rt_subd(c, a), n = rt_crossd(ab, ac);
    double nn = rt_dotd(n, n);
    if (!(nn > 0)) return false;
    RtVec3d offset =
        rt_addd(rt_scaled(rt_crossd(n, ab), rt_dotd(ac, ac)), rt_scaled(rt_crossd(ac, n), rt_dotd(ab, ab)));
    *center = rt_add_scaledd(a, offset, 1 / (2 * nn));
    return true;
}

/* Points that span a ball, and room for one more. */
typedef struct Span {
    RtVec3 points[4];
    size_t count;
} Span;

/* The ball about two or three of the points, if it holds all of `span` and is smaller than *best; then those
 * points are put to *least. `c` may be `b`. */
static void try_span(const Span *span, size_t a, size_t b, size_t c, RtBall *best, Span *least) {
    const RtVec3 *p = span->points;
    RtVec3d center = rt_scaled(rt_addd(rt_widen(p[a]), rt_widen(p[b])), 0.5);
    if (c != b && !circumcenter(rt_widen(p[a]), rt_widen(p[b]), rt_widen(p[c]), &center)) return;
    RtBall ball = ball_about(center, p, span->count);
    if (!(ball.radius < best->radius)) return;
    *best = ball;
    *least = (Span){{p[a], p[b], p[c]}, c == b ? 2 : 3};
}

/* The smallest ball about the points of `span`, which is left with those that span it. */
static RtBall spanned_ball(Span *span) {
    RtBall best = ball_about(rt_widen(span->points[0]), span->points, span->count);
    Span least = {{span->points[0]}, 1};
    for (size_t i = 0; i < span->count; i++) {
        for (size_t j = i + 1; j < span->count; j++) {
            for (size_t k = j; k < span->count; k++) try_span(span, i, j, k, &best, &least);
        }
    }
    *span = least;
    return best;
}

static size_t farthest(RtVec3d from, const RtVec3 *points, size_t count) {
    size_t best = 0;
    for (size_t i = 1; i < count; i++) {
        if (distance_squared(from, rt_widen(points[i])) > distance_squared(from, rt_widen(points[best])))
            best = i;
    }
    return best;
}

RtBall rt_ball_of_points(const RtVec3 *points, size_t count) {
    Span span = {{points[0]}, 1};
    RtBall best = ball_about(rt_widen(points[0]), points, count), ball = {best.center, 0};
    for (;;) {
        double before = ball.radius;
        span.points[span.count++] = points[farthest(ball.center, points, count)];
        ball = spanned_ball(&span);
        if (!(ball.radius > before)) return best;
        RtBall whole = ball_about(ball.center, points, count);
        if (whole.radius < best.radius) best = whole;
    }
}
