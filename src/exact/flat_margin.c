/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/margin.h"

RtUnitLine rt_unit_line(const RtWideRay *ray) {
    double length = rt_lengthd(ray->dir);
    return (RtUnitLine){ray->org, rt_scaled(ray->dir, 1 / length), length};
}

double rt_far_corner(const RtUnitLine *line, const RtBox *box) {
    RtVec3d far;
    for (int a = 0; a < 3; a++) {
        double org = line->org.at[a];
        far.at[a] = fmax(fabs((double)box->lo.at[a] - org), fabs((double)box->hi.at[a] - org));
    }
    return rt_lengthd(far);
}

bool rt_line_in_box(const RtUnitLine *line, const RtBox *box, double delta, double *lo, double *hi) {
    *lo = -HUGE_VAL;
    *hi = HUGE_VAL;
    for (int a = 0; a < 3; a++) {
        double org = line->org.at[a], dir = line->dir.at[a];
        double near = (double)box->lo.at[a] - org - delta, far = (double)box->hi.at[a] - org + delta;
        if (dir == 0) {
            if (near > 0 || far < 0) return false;
            continue;
        }
        *lo = fmax(*lo, (dir > 0 ? near : far) / dir);
        *hi = fmin(*hi, (dir > 0 ? far : near) / dir);
    }
    return *lo <= *hi;
}

bool rt_exceeds_float(double least, double most) {
    return least < 0x1p-100 || most > 0x1p124;
}

/* ---- flat shapes ---- */

typedef struct Flat {
    const RtVec3 *vertices;
    uint32_t count;
    RtVec3d normal, center; /* of length 1; relative to the line's origin */
    double longest;         /* side, or distance of a vertex from the first */
    double stretch;         /* longest^2 / (2 * area) */
    double uneven;          /* the largest distance of a vertex from the plane */
} Flat;

static RtVec3d from_origin(const RtUnitLine *line, RtVec3 vertex) {
    return rt_subd(rt_widen(vertex), line->org);
}

static Flat measure(const RtUnitLine *line, const RtVec3 *vertices, uint32_t count) {
    Flat f = {.vertices = vertices, .count = count};
    RtVec3d first = rt_widen(vertices[0]), last = rt_widen(vertices[count - 1]), sum = {0};
    double longest = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d v = rt_widen(vertices[i]), across = rt_subd(v, first), side = rt_subd(v, last);
        f.normal = rt_addd(f.normal, rt_crossd(rt_subd(last, first), across));
        sum = rt_addd(sum, across);
        longest = fmax(longest, fmax(rt_dotd(across, across), rt_dotd(side, side)));
        last = v;
    }
    f.longest = sqrt(longest);
    f.stretch = fmax(1, longest / rt_lengthd(f.normal)); /* infinite without an area */
    f.normal = rt_normalized(f.normal);
    f.center = rt_add_scaledd(from_origin(line, vertices[0]), sum, 1.0 / count);
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d v = from_origin(line, vertices[i]);
        f.uneven = fmax(f.uneven, fabs(rt_dotd(f.normal, rt_subd(v, f.center))));
    }
    return f;
}

/* The distance of a point from the segment a..b. */
static double segment_distance(RtVec3d point, RtVec3d a, RtVec3d b) {
    RtVec3d side = rt_subd(b, a), from = rt_subd(point, a);
    double square = rt_dotd(side, side);
    double part = square > 0 ? rt_clampd(rt_dotd(from, side) / square, 0, 1) : 0;
    return rt_lengthd(rt_add_scaledd(from, side, -part));
}

/* Is the point, in the plane, inside by the even-odd rule, and is it near an edge? `most` is the bound for
 * the longest edge. */
static bool inside(const Flat *f, const RtUnitLine *line, RtVec3d point, double most, double uneven,
                   bool *near) {
    int drop = rt_major_axis(rt_narrow(f->normal)), u = (drop + 1) % 3, v = (drop + 2) % 3;
    bool odd = false;
    *near = false;
    RtVec3d a = from_origin(line, f->vertices[f->count - 1]);
    for (uint32_t i = 0; i < f->count; i++) {
        RtVec3d b = from_origin(line, f->vertices[i]);
        double part = f->longest / rt_lengthd(rt_subd(b, a));
        *near |= segment_distance(point, a, b) <= most * fmin(part, f->stretch) + uneven;
        if ((a.at[v] > point.at[v]) != (b.at[v] > point.at[v])) {
            double at = a.at[u] + (b.at[u] - a.at[u]) * ((point.at[v] - a.at[v]) / (b.at[v] - a.at[v]));
            odd ^= point.at[u] < at;
        }
        a = b;
    }
    return odd;
}

RtFlatMargin rt_flat_margin(const RtUnitLine *line, const RtVec3 *vertices, uint32_t count, const RtBox *box,
                            double delta) {
    RtFlatMargin m = {0};
    if (!rt_line_in_box(line, box, delta, &m.lo, &m.hi)) return m;
    const Flat f = measure(line, vertices, count);
    double far = rt_far_corner(line, box), across = rt_dotd(f.normal, line->dir), cosine = fabs(across);
    double slack = (delta * f.stretch + f.uneven) / cosine;
    m.possible = true;
    double length = line->length, square = f.longest * f.longest;
    if (rt_exceeds_float(square * fmin(far, length), far * f.longest * fmax(f.longest, length)) ||
        rt_exceeds_float(length * length, length * length) ||
        rt_exceeds_float(square * far / length, square * far / length)) {
        m.lo = -HUGE_VAL;
        m.hi = HUGE_VAL;
        return m;
    }
    m.edge_on = !(slack < f.longest);
    if (m.edge_on) return m;
    bool near;
    double distance = rt_dotd(f.normal, f.center) / across;
    bool in = inside(&f, line, rt_scaled(line->dir, distance), delta / cosine, f.uneven / cosine, &near);
    m.lo = distance - slack;
    m.hi = distance + slack;
    m.possible = in || near;
    m.certain = in && !near;
    return m;
}
