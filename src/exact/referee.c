/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/referee.h"

const char *rt_side_name(RtSide side) {
    static const char *const names[RT_SIDE_COUNT] = {
#define RT_SIDE_NAME(CONSTANT, name, meaning) #name,
        RT_SIDES(RT_SIDE_NAME)
#undef RT_SIDE_NAME
    };
    return names[side];
}

long double rt_float_ulp(long double x) {
    int exponent;
    frexpl(x, &exponent);
    return ldexpl(1, x == 0 || exponent < FLT_MIN_EXP ? FLT_MIN_EXP - FLT_MANT_DIG : exponent - FLT_MANT_DIG);
}

/* ---- the nearest ---- */

typedef struct Search {
    RtRoot best;
    RtExactAnswer nearest;
    double open; /* the smallest t at which an undecided object may be met */
} Search;

/* Numbers of objects that are not the nearest are discarded at once. */
static void consider(Search *s, const RtGeometry *g, uint32_t object, const RtExactLine *line, uint32_t id,
                     double soonest) {
    size_t mark = rt_exact_mark();
    RtRoot t;
    RtExactResult result = rt_exact_hit(g, object, line, &t);
    if (result == RT_UNDECIDED) s->open = fmin(s->open, soonest);
    int order = -1;
    if (result == RT_HIT && s->nearest.tied > 0) order = rt_root_compare(&t, &s->best);
    if (result != RT_HIT || order >= 0) {
        if (result == RT_HIT && order == 0) s->nearest.tied++;
        rt_exact_rewind(mark);
        return;
    }
    s->best = t;
    s->nearest =
        (RtExactAnswer){.result = RT_HIT, .object = id, .tied = 1, .t = rt_root_value(&t, line->zero)};
}

/* The box of an object; that of an instance with what double rounds its corners by. */
static RtBox whole_box(const RtGeometry *g, uint32_t object) {
    RtBox box = g->boxes[object];
    for (int a = 0; a < 3 && rt_is_instance(g, object); a++) {
        const double *m = rt_instance_of(g, object)->to_world.m[a];
        const double part = (double)rt_box_largest_coordinate(rt_instance_of(g, object)->geometry->box);
        const double off = 0x1p-50 * ((fabs(m[0]) + fabs(m[1]) + fabs(m[2])) * part + fabs(m[3]));
        box.lo.at[a] = rt_float_below((double)box.lo.at[a] - off);
        box.hi.at[a] = rt_float_above((double)box.hi.at[a] + off);
    }
    return box;
}

/* The objects of a geometry, whose ids begin at `first`, and the line moved there. */
static void search(Search *s, const RtGeometry *g, const RtExactLine *line, uint32_t first) {
    for (uint32_t object = 0; object < g->object_count; object++) {
        const RtBox box = whole_box(g, object);
        double soonest;
        if (!rt_line_may_meet(&line->wide, &box, &soonest)) continue;
        if ((long double)soonest * (1 - RT_LINE_SLACK) > s->nearest.t) continue;
        if (!rt_is_instance(g, object)) {
            consider(s, g, object, line, first + object, soonest);
            continue;
        }
        const RtInstance *instance = rt_instance_of(g, object);
        const uint32_t before = s->nearest.object;
        size_t mark = rt_exact_mark();
        RtExactLine inside;
        if (rt_exact_enter(line, instance, &inside))
            search(s, instance->geometry, &inside, first + instance->first);
        if (s->nearest.object == before) rt_exact_rewind(mark);
    }
}

RtExactAnswer rt_referee_nearest(const RtGeometry *geometry, const RtRay *ray) {
    size_t mark = rt_exact_mark();
    const RtWideRay wide = rt_wide_ray(ray);
    const RtExactLine line = rt_exact_line(&wide);
    Search s = {.nearest = {.result = RT_MISSED, .object = RT_NO_OBJECT, .t = HUGE_VALL}, .open = HUGE_VAL};
    search(&s, geometry, &line, 0);
    if (s.open < HUGE_VAL && (long double)s.open <= s.nearest.t) s.nearest.result = RT_UNDECIDED;
    rt_exact_rewind(mark);
    return s.nearest;
}

/* ---- judging ---- */

/* RT_HIT if the answer is right. */
static RtExactResult is_right(const RtGeometry *geometry, const RtRay *ray, const RtExactAnswer *nearest,
                              RtHit answer, double tolerance) {
    if (answer.object == RT_NO_OBJECT) return nearest->result == RT_MISSED ? RT_HIT : RT_MISSED;
    if (nearest->result == RT_MISSED || answer.object >= rt_geometry_id_count(geometry)) return RT_MISSED;
    RtWideRay line = rt_wide_ray(ray);
    long double t;
    RtExactResult own = rt_referee_hit(geometry, answer.object, &line, &t);
    if (own != RT_HIT) return own;
    long double most = fmaxl((long double)tolerance, rt_float_ulp(nearest->t));
    bool right = t - nearest->t <= most && fabsl((long double)answer.t - t) <= most;
    return right ? RT_HIT : RT_MISSED;
}

RtExactAnswer rt_referee_judge(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit got,
                               double tolerance) {
    RtExactAnswer nearest = rt_referee_nearest(geometry, ray);
    nearest.side = RT_SIDE_UNDECIDED;
    if (nearest.result == RT_UNDECIDED) return nearest;
    RtExactResult one = is_right(geometry, ray, &nearest, expected, tolerance);
    RtExactResult other = is_right(geometry, ray, &nearest, got, tolerance);
    if (one == RT_UNDECIDED || other == RT_UNDECIDED) return nearest;
    nearest.side = one == RT_HIT ? (other == RT_HIT ? RT_SIDE_BOTH : RT_SIDE_EXPECTED)
                                 : (other == RT_HIT ? RT_SIDE_GOT : RT_SIDE_NEITHER);
    return nearest;
}

/* ---- one or two objects ---- */

RtExactResult rt_referee_hit(const RtGeometry *geometry, uint32_t id, const RtWideRay *line, long double *t) {
    size_t mark = rt_exact_mark();
    RtExactLine exact = rt_exact_line(line);
    RtRoot at;
    RtExactResult result = rt_exact_hit(geometry, id, &exact, &at);
    if (result == RT_HIT) *t = rt_root_value(&at, exact.zero);
    rt_exact_rewind(mark);
    return result;
}

RtExactResult rt_referee_order(const RtGeometry *geometry, uint32_t a, uint32_t b, const RtRay *ray,
                               int *order, long double *apart) {
    size_t mark = rt_exact_mark();
    RtWideRay line = rt_wide_ray(ray);
    RtExactLine exact = rt_exact_line(&line);
    RtRoot at[2];
    RtExactResult result = rt_exact_hit(geometry, a, &exact, &at[0]);
    if (result == RT_HIT) result = rt_exact_hit(geometry, b, &exact, &at[1]);
    if (result == RT_HIT) {
        *order = rt_root_compare(&at[0], &at[1]);
        long double first = rt_root_value(&at[0], exact.zero);
        *apart = *order == 0 ? 0 : fabsl(first - rt_root_value(&at[1], exact.zero));
    }
    rt_exact_rewind(mark);
    return result;
}
