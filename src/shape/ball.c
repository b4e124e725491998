/* Smallest enclosing balls. For few points every ball that is spanned by two or by three of them is tried,
 * and the smallest that holds all is the answer: a minimal ball of coplanar points is always of that kind
 * (and three points are always coplanar; for a planar polygon so are all). */
#include "shape/ball.h"

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

static void keep_smaller(RtBall *best, RtVec3d center, const RtVec3 *points, size_t count) {
    RtBall ball = ball_about(center, points, count);
    if (ball.radius < best->radius) *best = ball;
}

static RtBall exact_ball(const RtVec3 *points, size_t count) {
    RtBall best = ball_about(rt_widen(points[0]), points, count);
    for (size_t i = 0; i < count; i++) {
        for (size_t j = i + 1; j < count; j++) {
            RtVec3d a = rt_widen(points[i]), b = rt_widen(points[j]);
            keep_smaller(&best, rt_scaled(rt_addd(a, b), 0.5), points, count);
            for (size_t k = j + 1; k < count; k++) {
                RtVec3d center;
                if (circumcenter(a, b, rt_widen(points[k]), &center))
                    keep_smaller(&best, center, points, count);
            }
        }
    }
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

/* Ritter 1990, "An Efficient Bounding Sphere": start from two distant points, grow towards each point
 * outside. */
static RtBall ritter_ball(const RtVec3 *points, size_t count) {
    RtVec3d a = rt_widen(points[farthest(rt_widen(points[0]), points, count)]);
    RtVec3d b = rt_widen(points[farthest(a, points, count)]);
    RtBall ball = {rt_scaled(rt_addd(a, b), 0.5), sqrt(distance_squared(a, b)) / 2};
    for (size_t i = 0; i < count; i++) {
        RtVec3d p = rt_widen(points[i]);
        double d = sqrt(distance_squared(ball.center, p));
        if (d <= ball.radius) continue;
        double radius = (ball.radius + d) / 2;
        ball.center = rt_add_scaledd(ball.center, rt_subd(p, ball.center), (d - radius) / d);
        ball.radius = radius;
    }
    return ball_about(ball.center, points, count);
}

RtBall rt_ball_of_points(const RtVec3 *points, size_t count) {
    return count <= RT_BALL_EXACT_POINTS ? exact_ball(points, count) : ritter_ball(points, count);
}
