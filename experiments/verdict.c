#include "experiments/verdict.h"

#define SHIFT     0x1p-21
#define TOLERANCE 0x1p-18

enum { PROBES = 27 }; /* unmoved first */

/* One ray, moved by the error bound, with its interval widened and narrowed. */
typedef struct Probes {
    RtPreparedRay wide[PROBES], narrow[PROBES];
    double shift;     /* of the origin along an axis */
    double tolerance; /* of t */
} Probes;

/* What the probes say about one object. */
typedef struct Margin {
    bool possible, certain;
    double lo[2], hi[2]; /* range of t where a probe meets a front [0] and a back [1]; empty is lo > hi */
} Margin;

const char *rt_verdict_name(RtVerdict verdict) {
    static const char *const names[RT_VERDICT_COUNT] = {"equal", "tie", "marginal", "wrong"};
    return names[verdict];
}

/* ---- probes ---- */

static double largest_coordinate(const RtGeometry *g, const RtRay *ray) {
    float most = 0;
    for (int a = 0; a < 3; a++) {
        most = rt_maxf(fabsf(ray->org.at[a]), most);
        if (g->object_count == 0) continue;
        most = rt_maxf(fabsf(g->box.lo.at[a]), rt_maxf(fabsf(g->box.hi.at[a]), most));
    }
    return (double)most;
}

static double tolerance_of(const RtGeometry *g, const RtRay *ray) {
    return TOLERANCE * largest_coordinate(g, ray) / rt_lengthd(rt_widen(ray->dir));
}

static bool within(double a, double b, double tolerance) {
    return fabs(a - b) <= tolerance;
}

static void make_probes(Probes *p, const RtGeometry *g, const RtRay *ray) {
    p->shift = SHIFT * largest_coordinate(g, ray);
    p->tolerance = tolerance_of(g, ray);
    double tmin = (double)ray->tmin, tmax = (double)ray->tmax;
    for (int i = 0; i < PROBES; i++) {
        /* 13, the middle of the 3 x 3 x 3 places, comes first. */
        int place = i == 0 ? 13 : i <= 13 ? i - 1 : i;
        int x = place % 3, y = place / 3 % 3, z = place / 9;
        RtVec3d to = {x - 1, y - 1, z - 1};
        RtRay moved = *ray;
        moved.org = rt_narrow(rt_add_scaledd(rt_widen(ray->org), to, p->shift));
        moved.tmin = (float)fmax(tmin - p->tolerance, 0);
        moved.tmax = (float)(tmax + p->tolerance);
        p->wide[i] = rt_ray_prepare(&moved, &g->box);
        moved.tmin = (float)(tmin + p->tolerance);
        moved.tmax = (float)(tmax - p->tolerance);
        p->narrow[i] = rt_ray_prepare(&moved, &g->box);
    }
}

/* Can a probe meet the object at all? Its box, grown by the shift, is asked once for all of them. */
static bool in_reach(const RtGeometry *g, uint32_t id, const Probes *p) {
    RtBox box = g->boxes[id];
    for (int a = 0; a < 3; a++) {
        box.lo.at[a] = rt_float_below((double)box.lo.at[a] - 2 * p->shift);
        box.hi.at[a] = rt_float_above((double)box.hi.at[a] + 2 * p->shift);
    }
    float enter;
    return rt_box_hit(&box, &p->wide[0], p->wide[0].tmax, &enter);
}

/* Does the ray meet the object's front, seen along its normal, or its back? */
static int side_met(const RtGeometry *g, uint32_t id, const RtPreparedRay *ray, float t) {
    RtVec3d dir = rt_widen(ray->dir);
    RtVec3d point = rt_add_scaledd(rt_widen(ray->org), dir, (double)t);
    return rt_dotd(rt_object_normals(g, id, point).geometric, dir) > 0;
}

static Margin margin_of(const RtGeometry *g, uint32_t id, const Probes *p) {
    Margin m = {.certain = true, .lo = {HUGE_VAL, HUGE_VAL}, .hi = {-HUGE_VAL, -HUGE_VAL}};
    for (int i = 0; i < PROBES; i++) {
        const RtPreparedRay *rays[2] = {&p->wide[i], &p->narrow[i]};
        for (int k = 0; k < 2; k++) {
            float t;
            if (!rt_object_hit(g, id, rays[k], &t)) {
                m.certain = false;
                continue;
            }
            int side = side_met(g, id, rays[k], t);
            m.possible = true;
            m.lo[side] = fmin(m.lo[side], (double)t);
            m.hi[side] = fmax(m.hi[side], (double)t);
        }
    }
    return m;
}

static bool in_margin(const Margin *m, double t, double tolerance) {
    for (int side = 0; side < 2; side++) {
        if (t >= m->lo[side] - tolerance && t <= m->hi[side] + tolerance) return true;
    }
    return false;
}

/* ---- verdicts ---- */

static bool is_marginal(const RtGeometry *g, const RtRay *ray, RtHit answer) {
    Probes probes;
    make_probes(&probes, g, ray);
    double nearest_certain = HUGE_VAL;
    bool named = answer.object == RT_NO_OBJECT;
    for (uint32_t id = 0; id < g->object_count; id++) {
        if (!in_reach(g, id, &probes)) continue;
        Margin m = margin_of(g, id, &probes);
        if (m.certain) nearest_certain = fmin(nearest_certain, fmax(m.hi[0], m.hi[1]));
        if (id == answer.object) named = in_margin(&m, (double)answer.t, probes.tolerance);
    }
    if (answer.object == RT_NO_OBJECT) return nearest_certain == HUGE_VAL;
    return named && (double)answer.t <= nearest_certain + probes.tolerance;
}

static bool is_tie(const RtGeometry *g, const RtRay *ray, RtHit expected, RtHit answer, double tolerance) {
    float t;
    RtPreparedRay prepared = rt_ray_prepare(ray, &g->box);
    return rt_object_hit(g, answer.object, &prepared, &t) &&
           within((double)t, (double)expected.t, tolerance) &&
           within((double)answer.t, (double)expected.t, tolerance);
}

RtVerdict rt_verdict_nearest(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit answer) {
    double tolerance = tolerance_of(geometry, ray);
    if (answer.object == RT_NO_OBJECT) {
        if (expected.object == RT_NO_OBJECT) return RT_EQUAL;
    } else {
        if (answer.object >= geometry->object_count) return RT_WRONG;
        bool near = within((double)answer.t, (double)expected.t, tolerance);
        if (answer.object == expected.object && near) return RT_EQUAL;
        if (is_tie(geometry, ray, expected, answer, tolerance)) return RT_TIE;
    }
    return is_marginal(geometry, ray, answer) ? RT_MARGINAL : RT_WRONG;
}

RtVerdict rt_verdict_occluded(const RtGeometry *geometry, const RtRay *ray, bool expected, bool answer) {
    if (answer == expected) return RT_EQUAL;
    Probes probes;
    make_probes(&probes, geometry, ray);
    bool possible = false, certain = false;
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        if (!in_reach(geometry, id, &probes)) continue;
        Margin m = margin_of(geometry, id, &probes);
        possible |= m.possible;
        certain |= m.certain;
    }
    return (answer ? possible : !certain) ? RT_MARGINAL : RT_WRONG;
}
