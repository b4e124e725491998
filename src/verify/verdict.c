/* SPDX-License-Identifier: Apache-2.0 */
/* Verdicts by the margins that the header defines. An answer that is neither equal nor a tie goes to the
 * referee. If it is not exactly right, each object gets its margin, the t at which it may be hit
 * (triangle_margin, sphere_margin, probed_margin). The answer is marginal if it is in that of its object, and
 * no object that is certainly hit is clearly before it. */
#include "verify/verdict.h"

/* Times the largest coordinate: the error of a place, the shift of a probe, the tolerance of t |dir|. */
#define ERROR     0x1p-20
#define SHIFT     (ERROR / 2)
#define TOLERANCE (4 * ERROR)

/* Sums of a few products of this size may overflow float32. */
#define OVERFLOW_SIZE 0x1p124

enum { PROBES = 28 }; /* unmoved first, straightened last */

/* One ray, displaced by the error bound, with its interval widened and narrowed. */
typedef struct Probes {
    RtPreparedRay wide[PROBES], narrow[PROBES];
    double shift;     /* of the origin along an axis */
    double error;     /* of a place, as float32 arithmetic finds it */
    double tolerance; /* of t */
} Probes;

/* Where one object may be hit. */
typedef struct Margin {
    bool possible, certain;
    double lo[2], hi[2]; /* possible t, in up to two ranges; empty is lo > hi */
    double latest;       /* if certain: an upper bound of its t */
} Margin;

static const Margin impossible = {.lo = {HUGE_VAL, HUGE_VAL}, .hi = {-HUGE_VAL, -HUGE_VAL}};

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
    /* For the longest directions t is below the resolution of float32. */
    return fmax(TOLERANCE * largest_coordinate(g, ray) / rt_lengthd(rt_widen(ray->dir)), 0x1p-149);
}

static bool within(double a, double b, double tolerance) {
    return fabs(a - b) <= tolerance;
}

/* The direction without components below its rounding, as Embree receives it. */
static RtVec3 straightened(RtVec3 dir) {
    float least = 0x1p-24f * fabsf(dir.at[rt_major_axis(dir)]);
    for (int a = 0; a < 3; a++) {
        if (fabsf(dir.at[a]) < least) dir.at[a] = 0;
    }
    return dir;
}

static void make_probes(Probes *p, const RtGeometry *g, const RtRay *ray, RtCrossing *crossings) {
    p->shift = SHIFT * largest_coordinate(g, ray);
    p->error = ERROR * largest_coordinate(g, ray);
    p->tolerance = tolerance_of(g, ray);
    double tmin = (double)ray->tmin, tmax = (double)ray->tmax;
    for (int i = 0; i < PROBES; i++) {
        /* 13, the centre of the 3 x 3 x 3 positions, comes first. */
        bool last = i == PROBES - 1;
        int place = i == 0 || last ? 13 : i <= 13 ? i - 1 : i;
        int x = place % 3, y = place / 3 % 3, z = place / 9;
        RtVec3d to = {x - 1, y - 1, z - 1};
        RtRay moved = *ray;
        if (last) moved.dir = straightened(ray->dir);
        moved.org = rt_narrow(rt_add_scaledd(rt_widen(ray->org), to, p->shift));
        moved.tmin = (float)fmax(tmin - p->tolerance, 0);
        moved.tmax = (float)(tmax + p->tolerance);
        rt_hit_ray(&p->wide[i], g, &moved, crossings);
        moved.tmin = (float)(tmin + p->tolerance);
        moved.tmax = (float)(tmax - p->tolerance);
        rt_hit_ray(&p->narrow[i], g, &moved, crossings);
    }
}

/* Can any probe meet the object? Tests its box, grown by the shift, once for all probes. */
static bool in_reach(const RtGeometry *g, uint32_t id, const Probes *p) {
    RtBox box = g->boxes[id];
    for (int a = 0; a < 3; a++) {
        box.lo.at[a] = rt_float_below((double)box.lo.at[a] - 2 * p->shift);
        box.hi.at[a] = rt_float_above((double)box.hi.at[a] + 2 * p->shift);
    }
    float enter;
    return rt_box_hit(&box, &p->wide[0], p->wide[0].tmax, &enter);
}

/* Does the ray hit the object's front, seen along its normal (0), or its back (1)? */
static int side_met(const RtGeometry *g, uint32_t id, const RtPreparedRay *ray, float t) {
    RtVec3 org = rt_vec3_load(ray->org), dir = rt_vec3_load(ray->dir);
    RtRay again = {.org = org, .tmin = ray->tmin, .dir = dir, .tmax = ray->tmax};
    return rt_dotd(rt_object_normals(g, id, &again, t, ray->crossings).geometric, rt_widen(dir)) > 0;
}

/* Shapes that only our hit functions test: from the probes. */
static Margin probed_margin(const RtGeometry *g, uint32_t id, const Probes *p) {
    Margin m = impossible;
    m.certain = true;
    for (int i = 0; i < PROBES; i++) {
        const RtPreparedRay *rays[2] = {&p->wide[i], &p->narrow[i]};
        for (int k = 0; k < 2; k++) {
            float t;
            if (!rt_object_hit(g, id, rays[k], &t, NULL)) {
                m.certain = false;
                continue;
            }
            int side = side_met(g, id, rays[k], t);
            m.possible = true;
            m.lo[side] = fmin(m.lo[side], (double)t);
            m.hi[side] = fmax(m.hi[side], (double)t);
        }
    }
    m.latest = fmax(m.hi[0], m.hi[1]);
    return m;
}

/* ---- shapes that Embree tests with its own arithmetic: its errors, in double ---- */

/* Is t in lo..hi possibly, or certainly, inside the ray's interval? */
static bool may_count(const Probes *p, const RtRay *ray, double lo, double hi) {
    return hi >= (double)ray->tmin - p->tolerance && lo <= (double)ray->tmax + p->tolerance;
}

static bool must_count(const Probes *p, const RtRay *ray, double lo, double hi) {
    return lo >= (double)ray->tmin + p->tolerance && hi <= (double)ray->tmax - p->tolerance;
}

/* The edge functions, their sum and the height above the plane are triple products of vectors with an
 * error of `error` each, and of 2 `error` for a side, a difference of two vectors that is up to twice as
 * long. A plane seen edge-on may be hit anywhere along the ray, and so may one whose products overflow. */
static Margin triangle_margin(const RtTriangle *triangle, const RtRay *ray, const Probes *p) {
    RtVec3d dir = rt_widen(ray->dir), from[3], side[3];
    double longest = 0, least = HUGE_VAL, most = -HUGE_VAL, sum = 0;
    for (int i = 0; i < 3; i++) from[i] = rt_subd(rt_widen(triangle->v[i]), rt_widen(ray->org));
    for (int i = 0; i < 3; i++) {
        side[i] = rt_subd(from[(i + 1) % 3], from[i]);
        longest = fmax(longest, rt_lengthd(side[i]));
        double edge = rt_dotd(rt_crossd(from[i], side[i]), dir);
        least = fmin(least, edge);
        most = fmax(most, edge);
        sum += edge;
    }
    Margin m = impossible;
    double error = 4 * p->error * longest * rt_lengthd(dir);
    double farthest = fmax(rt_lengthd(from[0]), fmax(rt_lengthd(from[1]), rt_lengthd(from[2])));
    bool overflows = farthest * longest * fmax(longest, rt_lengthd(dir)) > OVERFLOW_SIZE;
    if (!overflows && least < -error && most > error) return m;
    if (overflows || fabs(sum) <= 3 * error) {
        return (Margin){.possible = true, .lo = {-HUGE_VAL, HUGE_VAL}, .hi = {HUGE_VAL, -HUGE_VAL}};
    }
    double t = rt_dotd(rt_crossd(side[0], side[1]), from[0]) / sum;
    double slack = 3 * p->error * longest * longest / fabs(sum);
    m.lo[0] = t - slack;
    m.hi[0] = m.latest = t + slack;
    m.possible = may_count(p, ray, m.lo[0], m.hi[0]);
    m.certain = (least >= error || most <= -error) && must_count(p, ray, m.lo[0], m.hi[0]);
    return m;
}

/* The distance of the line from the centre has the error `error`; near the silhouette half the chord, and
 * with it t, has a much larger one. */
static Margin sphere_margin(const RtSphere *sphere, const RtRay *ray, const Probes *p) {
    RtVec3d dir = rt_widen(ray->dir), org = rt_subd(rt_widen(ray->org), rt_widen(sphere->center));
    double dd = rt_dotd(dir, dir), radius = (double)sphere->radius;
    double closest = -rt_dotd(org, dir) / dd;
    RtVec3d across = rt_add_scaledd(org, dir, closest);
    double ll = rt_dotd(across, across), outer = radius + p->error, inner = fmax(radius - p->error, 0);
    Margin m = impossible;
    if (ll > outer * outer) return m;
    double longest = sqrt((outer * outer - ll) / dd);
    double shortest = inner * inner > ll ? sqrt((inner * inner - ll) / dd) : 0;
    const double lo[2] = {closest - longest, closest + shortest};
    const double hi[2] = {closest - shortest, closest + longest};
    bool front_may = may_count(p, ray, lo[0], hi[0]), front_must = must_count(p, ray, lo[0], hi[0]);
    bool back_may = may_count(p, ray, lo[1], hi[1]), back_must = must_count(p, ray, lo[1], hi[1]);
    for (int k = 0; k < 2; k++) {
        if (k == 0 ? !front_may : !back_may || (front_must && shortest > 0)) continue;
        m.lo[k] = lo[k];
        m.hi[k] = hi[k];
    }
    m.possible = front_may || back_may;
    m.certain = shortest > 0 && (front_must || back_must);
    m.latest = front_must ? hi[0] : hi[1];
    return m;
}

static Margin margin_of(const RtGeometry *g, uint32_t id, const RtRay *ray, const Probes *p) {
    uint32_t index = rt_ref_index(g->objects[id]);
    RtShape shape = rt_ref_shape(g->objects[id]);
    /* A needle seen edge-on may be hit beside its box, too. */
    if (shape != RT_SHAPE_TRIANGLE && !in_reach(g, id, p)) return impossible;
    switch (shape) {
    case RT_SHAPE_TRIANGLE: return triangle_margin(&g->triangles[index], ray, p);
    case RT_SHAPE_SPHERE: return sphere_margin(&g->spheres[index], ray, p);
    default: return probed_margin(g, id, p);
    }
}

static bool in_margin(const Margin *m, double t, double tolerance) {
    for (int side = 0; side < 2; side++) {
        if (t >= m->lo[side] - tolerance && t <= m->hi[side] + tolerance) return true;
    }
    return false;
}

/* ---- verdicts ---- */

static bool is_marginal(const RtGeometry *g, const RtRay *ray, RtHit answer, RtCrossing *crossings) {
    Probes probes;
    make_probes(&probes, g, ray, crossings);
    double nearest_certain = HUGE_VAL;
    bool named = answer.object == RT_NO_OBJECT;
    for (uint32_t id = 0; id < g->object_count; id++) {
        Margin m = margin_of(g, id, ray, &probes);
        if (m.certain) nearest_certain = fmin(nearest_certain, m.latest);
        if (id == answer.object) named = in_margin(&m, (double)answer.t, probes.tolerance);
    }
    if (answer.object == RT_NO_OBJECT) return nearest_certain == HUGE_VAL;
    return named && (double)answer.t <= nearest_certain + probes.tolerance;
}

static RtStatus lack_memory(RtError *error) {
    return rt_fail_memory(error, "exact arithmetic on a CSG tree", 0);
}

/* Does the ray exactly meet both objects, at t's within the tolerance? Our hit function is quick and comes
 * first. */
static RtStatus is_tie(const RtGeometry *g, const RtRay *ray, RtHit expected, RtHit answer,
                       RtCrossing *crossings, bool *tie, RtError *error) {
    float t;
    int order;
    long double apart;
    double tolerance = tolerance_of(g, ray);
    *tie = false;
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, g, ray, crossings);
    if (!within((double)answer.t, (double)expected.t, tolerance)) return RT_OK;
    if (!rt_object_hit(g, answer.object, &prepared, &t, NULL)) return RT_OK;
    if (!within((double)t, (double)expected.t, tolerance)) return RT_OK;
    RtExactResult result = rt_referee_order(g, expected.object, answer.object, ray, &order, &apart);
    if (result == RT_UNDECIDED) return lack_memory(error);
    *tie = result == RT_HIT && apart <= (long double)tolerance;
    return RT_OK;
}

RtStatus rt_verdict_side(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit answer,
                         RtSide *side, RtError *error) {
    *side = rt_referee_judge(geometry, ray, expected, answer, tolerance_of(geometry, ray)).side;
    return *side == RT_SIDE_UNDECIDED ? lack_memory(error) : RT_OK;
}

RtStatus rt_verdict_nearest(const RtGeometry *geometry, const RtRay *ray, RtHit expected, RtHit answer,
                            RtCrossing *crossings, RtVerdict *verdict, RtError *error) {
    RtSide side;
    *verdict = RT_EQUAL;
    if (answer.object == RT_NO_OBJECT) {
        if (expected.object == RT_NO_OBJECT) return RT_OK;
    } else {
        bool near = within((double)answer.t, (double)expected.t, tolerance_of(geometry, ray)), tie = false;
        if (answer.object == expected.object && near) return RT_OK;
        *verdict = RT_WRONG;
        if (answer.object >= geometry->object_count) return RT_OK;
        if (expected.object != RT_NO_OBJECT) {
            RT_TRY(is_tie(geometry, ray, expected, answer, crossings, &tie, error));
        }
        *verdict = RT_TIE;
        if (tie) return RT_OK;
    }
    RT_TRY(rt_verdict_side(geometry, ray, expected, answer, &side, error));
    bool right = side == RT_SIDE_GOT || side == RT_SIDE_BOTH;
    *verdict = right || is_marginal(geometry, ray, answer, crossings) ? RT_MARGINAL : RT_WRONG;
    return RT_OK;
}

RtStatus rt_verdict_occluded(const RtGeometry *geometry, const RtRay *ray, bool expected, bool answer,
                             RtCrossing *crossings, RtVerdict *verdict, RtError *error) {
    *verdict = RT_EQUAL;
    if (answer == expected) return RT_OK;
    RtExactResult exact = rt_referee_occluded(geometry, ray);
    if (exact == RT_UNDECIDED) return lack_memory(error);
    *verdict = RT_MARGINAL;
    if (exact == (answer ? RT_HIT : RT_MISSED)) return RT_OK;
    Probes probes;
    make_probes(&probes, geometry, ray, crossings);
    bool possible = false, certain = false;
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        Margin m = margin_of(geometry, id, ray, &probes);
        possible |= m.possible;
        certain |= m.certain;
    }
    *verdict = (answer ? possible : !certain) ? RT_MARGINAL : RT_WRONG;
    return RT_OK;
}
