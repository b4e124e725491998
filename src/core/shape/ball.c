/* SPDX-License-Identifier: Apache-2.0 */
/* Smallest enclosing balls. A few points span the ball. While some point lies outside it, the farthest one
 * joins them, and points that the new ball does not need leave. The ball grows at every step, so the loop
 * ends (an LP-type problem: Sharir & Welzl 1992). Two or three coplanar points span a ball, so at most
 * four are examined together; the vertices of a triangle or a planar polygon are coplanar. */
#include "core/shape/ball.h"

static double distance_squared(RtVec3d a, RtVec3d b) {
    RtVec3d d = rt_subd(a, b);
    return rt_dotd(d, d);
}

/* The smallest ball around `center` that contains all points. */
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

/* The points that span a ball, and space for one more. */
typedef struct Span {
    RtVec3 points[4];
    size_t count;
} Span;

/* Tries the ball spanned by two or three of the points (`c` may equal `b`). If it contains all of `span`
 * and is smaller than *best, it replaces *best, and *least becomes its points. */
static void try_span(const Span *span, size_t a, size_t b, size_t c, RtBall *best, Span *least) {
    const RtVec3 *p = span->points;
    RtVec3d center = rt_scaled(rt_addd(rt_widen(p[a]), rt_widen(p[b])), 0.5);
    if (c != b && !circumcenter(rt_widen(p[a]), rt_widen(p[b]), rt_widen(p[c]), &center)) return;
    RtBall ball = ball_about(center, p, span->count);
    if (!(ball.radius < best->radius)) return;
    *best = ball;
    *least = (Span){{p[a], p[b], p[c]}, c == b ? 2 : 3};
}

/* The smallest ball around the points of `span`; keeps only those that span it. */
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
