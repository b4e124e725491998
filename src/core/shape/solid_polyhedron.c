/* SPDX-License-Identifier: Apache-2.0 */
/* Convex polyhedra: the points behind all of `count` planes in world space, bounded or not. A line is clipped
 * by one plane after another.
 *
 * Everything else follows from the edges: the line of each two planes, clipped by all others. A polyhedron
 * in three dimensions has a point if and only if it has an edge or all its planes are parallel; and if it
 * has a corner, it reaches as far as its edges do. To be safe from rounding, the planes are moved outward
 * for extents, and inward to check that the inside is not flat. About count^2 / 2 lines are tried; a few
 * planes clip most of them away. */
#include "core/base/memory.h"
#include "core/shape/solid_parts.h"

#include <string.h>

/* Anything below this, relative to 1, is rounding noise. */
#define NOISE 0x1p-40

uint32_t rt_solid_polyhedron_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray,
                                       float near, float far, RtCrossing *out) {
    const RtSolid *solid = &set->solids[index];
    RtSpan span = {-INFINITY, INFINITY, 0, 0};
    for (uint32_t i = 0; i < solid->count && span.open < span.close; i++)
        rt_span_cut(&span, &set->planes[solid->first + i], i, ray);
    return rt_span_put(&span, index, near, far, out, 0);
}

RtVec3d rt_solid_polyhedron_normal(const RtSolidSet *set, const RtSolid *solid, uint32_t face,
                                   RtVec3d point) {
    (void)point;
    return set->planes[solid->first + face].normal;
}

/* ---- edges ---- */

/* Planes, each moved outward by `grow`. */
typedef struct Faces {
    const RtPlane *planes;
    uint32_t count;
    double grow;
} Faces;

/* The points from + s dir, lo <= s <= hi. */
typedef struct Edge {
    RtVec3d from, dir; /* dir of length 1 */
    double lo, hi;     /* possibly infinite */
} Edge;

/* A polyhedron thinner than this counts as flat; 1, for want of a size, if all planes go through the
 * origin. */
static double least_width(const RtPlane *planes, uint32_t count) {
    double most = 0;
    for (uint32_t i = 0; i < count; i++) most = fmax(most, fabs(planes[i].offset));
    return most > 0 ? NOISE * most : 1;
}

/* The line in which two planes meet; false if they are parallel. */
static bool line_of(const Faces *faces, uint32_t i, uint32_t j, Edge *edge) {
    const RtPlane *a = &faces->planes[i], *b = &faces->planes[j];
    RtVec3d along = rt_crossd(a->normal, b->normal);
    double squared = rt_dotd(along, along);
    if (!(squared > NOISE * NOISE)) return false;
    RtVec3d from = rt_scaled(rt_crossd(b->normal, along), (a->offset + faces->grow) / squared);
    from = rt_add_scaledd(from, rt_crossd(along, a->normal), (b->offset + faces->grow) / squared);
    *edge = (Edge){from, rt_scaled(along, 1 / sqrt(squared)), -INFINITY, INFINITY};
    return true;
}

/* Clips the line of planes i and j by all others; false if nothing is left. */
static bool cut_line(const Faces *faces, uint32_t i, uint32_t j, Edge *edge) {
    for (uint32_t k = 0; k < faces->count && edge->lo <= edge->hi; k++) {
        if (k == i || k == j) continue;
        const RtPlane *plane = &faces->planes[k];
        double gap = plane->offset + faces->grow - rt_dotd(plane->normal, edge->from);
        double rate = rt_dotd(plane->normal, edge->dir);
        if (fabs(rate) < NOISE) {
            if (gap < 0) return false;
        } else if (rate < 0) {
            edge->lo = fmax(edge->lo, gap / rate);
        } else {
            edge->hi = fmin(edge->hi, gap / rate);
        }
    }
    return edge->lo <= edge->hi;
}

/* The next edge after that of planes *i and *j > *i (0 and 0 to begin with); false if there is none. */
static bool next_edge(const Faces *faces, uint32_t *i, uint32_t *j, Edge *edge) {
    for (; *i < faces->count; *j = ++*i) {
        while (++*j < faces->count) {
            if (line_of(faces, *i, *j, edge) && cut_line(faces, *i, *j, edge)) return true;
        }
    }
    return false;
}

/* Are all planes parallel? Then *lo and *hi, along the normal of the first, bound the polyhedron. */
static bool is_slab(const Faces *faces, double *lo, double *hi) {
    RtVec3d normal = faces->planes[0].normal;
    *lo = -INFINITY, *hi = INFINITY;
    for (uint32_t i = 0; i < faces->count; i++) {
        const RtPlane *plane = &faces->planes[i];
        double offset = plane->offset + faces->grow;
        RtVec3d across = rt_crossd(normal, plane->normal);
        if (rt_dotd(across, across) > NOISE * NOISE) return false;
        if (rt_dotd(normal, plane->normal) > 0)
            *hi = fmin(*hi, offset);
        else
            *lo = fmax(*lo, -offset);
    }
    return true;
}

/* ---- extents ---- */

static Faces grown_faces(const RtSolidSet *set, const RtSolid *solid) {
    const RtPlane *planes = set->planes + solid->first;
    return (Faces){planes, solid->count, least_width(planes, solid->count)};
}

/* Like rt_solid_polyhedron_support, for a polyhedron without a corner, whose normals lie in a plane. With
 * direction = l a.normal + m b.normal, l and m at least 0, the planes a and b alone bound it (duality of
 * linear programs); b may equal a. */
static double flat_support(const Faces *faces, RtVec3d direction) {
    double least = INFINITY, length = rt_lengthd(direction);
    for (uint32_t i = 0; i < faces->count * faces->count; i++) {
        const RtPlane *a = &faces->planes[i / faces->count], *b = &faces->planes[i % faces->count];
        RtVec3d along = rt_crossd(a->normal, b->normal);
        double squared = rt_dotd(along, along), l = rt_dotd(a->normal, direction), m = 0;
        if (squared > NOISE * NOISE) {
            l = rt_dotd(rt_crossd(direction, b->normal), along) / squared;
            m = rt_dotd(rt_crossd(a->normal, direction), along) / squared;
        }
        RtVec3d rest = rt_add_scaledd(rt_add_scaledd(direction, a->normal, -l), b->normal, -m);
        if (!(l >= 0 && m >= 0 && rt_lengthd(rest) <= NOISE * length)) continue;
        least = fmin(least, l * (a->offset + faces->grow) + m * (b->offset + faces->grow));
    }
    return least;
}

/* The largest dot product of `direction` with a point of the edge. At an infinite end, a direction that is
 * perpendicular up to noise counts as perpendicular. */
static double edge_support(const Edge *edge, RtVec3d direction) {
    double base = rt_dotd(edge->from, direction), rate = rt_dotd(edge->dir, direction);
    double end = rate > 0 ? edge->hi : edge->lo, start = rate > 0 ? edge->lo : edge->hi;
    if (isinf(end) && fabs(rate) <= NOISE * rt_lengthd(direction)) end = start;
    return base + rate * end;
}

double rt_solid_polyhedron_support(const RtSolidSet *set, const RtSolid *solid, RtVec3d direction) {
    Faces faces = grown_faces(set, solid);
    double most = -INFINITY;
    Edge edge;
    for (uint32_t i = 0, j = 0; next_edge(&faces, &i, &j, &edge);) {
        if (isinf(edge.lo) && isinf(edge.hi)) return flat_support(&faces, direction);
        most = fmax(most, edge_support(&edge, direction));
    }
    return most == -INFINITY ? flat_support(&faces, direction) : most;
}

/* Around the centre of the box. */
RtBall rt_solid_polyhedron_ball(const RtSolidSet *set, const RtSolid *solid) {
    RtVec3d center = rt_widen(rt_box_center(solid->box));
    if (!isfinite(rt_lengthd(center))) return (RtBall){{{0, 0, 0}}, INFINITY};
    Faces faces = grown_faces(set, solid);
    double most = 0;
    Edge edge;
    for (uint32_t i = 0, j = 0; next_edge(&faces, &i, &j, &edge);) {
        RtVec3d from = rt_subd(edge.from, center);
        most = fmax(most, rt_lengthd(rt_add_scaledd(from, edge.dir, edge.lo)));
        most = fmax(most, rt_lengthd(rt_add_scaledd(from, edge.dir, edge.hi)));
    }
    return (RtBall){center, most};
}

/* ---- making ---- */

static RtStatus check_plane(const RtPlane *plane, uint32_t i, RtError *error) {
    RtVec3d n = plane->normal;
    double squared = rt_dotd(n, n);
    if (isfinite(squared) && isfinite(plane->offset) && squared > 0) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "plane %u of the polyhedron, normal (%g, %g, %g), offset %g, must have finite numbers and "
                   "a normal other than 0",
                   i, n.x, n.y, n.z, plane->offset);
}

RtStatus rt_solid_check_inside(const RtPlane *planes, uint32_t count, RtError *error) {
    Faces shrunk = {planes, count, -least_width(planes, count)};
    double lo, hi;
    Edge edge;
    uint32_t i = 0, j = 0;
    if (is_slab(&shrunk, &lo, &hi) ? lo < hi : next_edge(&shrunk, &i, &j, &edge)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "the %u planes of the polyhedron enclose nothing: normals point outward, and the inside "
                   "is where normal . p <= offset",
                   count);
}

/* Keeps a plane with a unit normal bit for bit, so that solids survive saving and loading. */
static RtPlane unit_plane(const RtPlane *plane) {
    RtVec3d n = plane->normal;
    double squared = rt_dotd(n, n);
    if (fabs(squared - 1) <= 0x1p-50) return *plane;
    return rt_plane_through(rt_scaled(n, plane->offset / squared), n);
}

RtStatus rt_solid_add_polyhedron(RtSolidSet *set, const RtPlane *planes, uint32_t count,
                                 const RtTransform *to_world, uint32_t *index, RtError *error) {
    if (count == 0 || count > RT_SOLID_MAX_FACES)
        return rt_fail(error, RT_BAD_INPUT, "a polyhedron of %u planes: expected 1..%d", count,
                       RT_SOLID_MAX_FACES);
    const RtTransform here = rt_transform_identity();
    if (!to_world) to_world = &here;
    RT_TRY(rt_solid_check_transform(to_world, error));
    RT_TRY(rt_reserve(&set->planes, &set->plane_capacity, (uint64_t)set->plane_count + count, sizeof(RtPlane),
                      error));
    RtPlane *own = set->planes + set->plane_count;
    bool stays = memcmp(to_world, &here, sizeof here) == 0;
    for (uint32_t i = 0; i < count; i++) {
        RT_TRY(check_plane(&planes[i], i, error));
        RtPlane standing = unit_plane(&planes[i]);
        own[i] = stays ? standing : rt_plane_moved(&standing, to_world);
        if (!(fabs(own[i].offset) <= (double)RT_MAX_COORDINATE))
            return rt_fail(error, RT_BAD_INPUT,
                           "plane %u of the polyhedron is %g from the origin: at most %g", i,
                           fabs(own[i].offset), (double)RT_MAX_COORDINATE);
    }
    RT_TRY(rt_solid_check_inside(own, count, error));
    RtSolid solid = {
        .kind = RT_SOLID_POLYHEDRON, .first = set->plane_count, .count = count, .to_world = here};
    return rt_solid_finish(set, &solid, rt_solid_polyhedron_support, index, error);
}
