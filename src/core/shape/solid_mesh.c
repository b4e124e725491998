/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of a closed triangle mesh: every directed edge is there as often as its reverse, so that the
 * surface has no border; more of it is entered than left, seen along any line, where the line is inside.
 *
 * A line meets a triangle by the winding number of its outline about the line (as seen along it: moved to the
 * origin and sheared until the ray is the z axis, as in core/shape/triangle.h). The number is counted on the
 * half line y = 0, x > 0: an edge from below (y < 0) to above that passes to the right of the origin gives 1,
 * its reverse gives -1, any other nothing. What an edge gives is computed from the lower end to the upper
 * one, whatever the direction: so it is the same bits, with the sign turned, for both triangles at the edge,
 * and what all triangles give adds up to 0 exactly, whatever the rounding. A line through an edge or a vertex
 * enters as often as it leaves, and crosses no triangle twice: one outline winds about the line once at most.
 *
 * Triangles lie in leaves of a binary tree of boxes (solid_mesh_make.c). A box that the thick ray misses is
 * farther from the line than rounding reaches, and holds none that winds about it.
 *
 * t is that of a point between two edges, which is on the triangle whatever its shape: slivers, those without
 * area too, and triangles seen edge-on are among those crossed. Faces along an axis are planes as those of
 * other solids are, and met at the same bits. */
#include "core/shape/solid_parts.h"

/* ---- crossings ---- */

/* A vertex seen along the ray. */
typedef struct Seen {
    double x, y, z;
} Seen;

static Seen seen_vertex(const RtSolidRay *ray, RtVec3 vertex) {
    const RtPreparedRay *r = &ray->thick;
    RtVec3d v = rt_subd(rt_widen(vertex), ray->org);
    double z = v.at[r->kz] / ray->dir.at[r->kz];
    return (Seen){v.at[r->kx] - ray->dir.at[r->kx] * z, v.at[r->ky] - ray->dir.at[r->ky] * z, z};
}

/* Does the edge from `lower` (y < 0) to `upper` (y >= 0) pass to the right of the origin? */
static bool right(const Seen *lower, const Seen *upper) {
    return lower->x * upper->y - upper->x * lower->y > 0;
}

static int winding(const Seen v[3]) {
    int number = 0;
    for (int i = 0; i < 3; i++) {
        const Seen *from = &v[i], *to = &v[(i + 1) % 3];
        if (from->y < 0 && to->y >= 0) number += right(from, to);
        if (from->y >= 0 && to->y < 0) number -= right(to, from);
    }
    return number;
}

/* Where the edge meets the plane y = 0, as a point of the edge: y may be off by rounding, x and z go with
 * it. */
static Seen at_level(const Seen *lower, const Seen *upper) {
    double part = lower->y / (lower->y - upper->y);
    return (Seen){lower->x + (upper->x - lower->x) * part, 0, lower->z + (upper->z - lower->z) * part};
}

/* The t of a triangle about whose outline the line winds: between the two edges that meet y = 0, at x = 0. */
static double depth_between_edges(const Seen v[3]) {
    Seen met[2] = {0};
    for (int i = 0, n = 0; i < 3 && n < 2; i++) {
        const Seen *from = &v[i], *to = &v[(i + 1) % 3];
        if ((from->y < 0) == (to->y < 0)) continue;
        met[n++] = from->y < 0 ? at_level(from, to) : at_level(to, from);
    }
    double part = met[0].x / (met[0].x - met[1].x);
    return met[0].z + (met[1].z - met[0].z) * (part > 0 ? fmin(part, 1) : 0);
}

static double depth_of(const RtTriangle *triangle, const RtSolidRay *ray, const Seen v[3]) {
    RtVec3d a = rt_widen(triangle->v[0]);
    RtVec3d normal = rt_crossd(rt_subd(rt_widen(triangle->v[1]), a), rt_subd(rt_widen(triangle->v[2]), a));
    int axis = rt_axis_of(normal);
    if (axis < 0 || ray->dir.at[axis] == 0) return depth_between_edges(v);
    return (a.at[axis] - ray->org.at[axis]) / ray->dir.at[axis];
}

/* Puts a crossing among those before it, by t and then by face. In `solid` stands whether the line enters. */
static void insert(RtCrossing *list, uint32_t count, RtCrossing crossing) {
    uint32_t i = count;
    for (; i > 0; i--) {
        const RtCrossing *before = &list[i - 1];
        if (before->t < crossing.t || (before->t == crossing.t && before->face < crossing.face)) break;
        list[i] = *before;
    }
    list[i] = crossing;
}

/* Puts in order those triangles of a leaf that the line crosses. */
static uint32_t collect_leaf(const RtTriangle *triangles, uint32_t first, uint32_t end, const RtSolidRay *ray,
                             float near, float far, RtCrossing *list, uint32_t found) {
    bool backward = ray->thick.negative[ray->thick.kz] != 0;
    for (uint32_t i = first; i < end; i++) {
        const RtTriangle *triangle = &triangles[i];
        const Seen v[3] = {seen_vertex(ray, triangle->v[0]), seen_vertex(ray, triangle->v[1]),
                           seen_vertex(ray, triangle->v[2])};
        int number = winding(v);
        if (number == 0) continue;
        double t = rt_clampd(depth_of(triangle, ray, v), (double)near, (double)far);
        bool enters = (number < 0) != backward;
        insert(list, found++, (RtCrossing){(float)t, enters, i});
    }
    return found;
}

/* All triangles that the line crosses. The tree is walked without a stack: the children of node n are 2n and
 * 2n + 1, so that after a node comes the brother of the last even one on the way up. */
static uint32_t collect(const RtSolidSet *set, const RtSolid *solid, const RtSolidRay *ray, float near,
                        float far, RtCrossing *list) {
    uint32_t found = 0, node = 1;
    while (node != 0) {
        float enter = -INFINITY, leave = INFINITY;
        rt_box_cut(&set->boxes[solid->first_box + node - 1], &ray->thick, &enter, &leave);
        if (enter <= leave && node < solid->leaves) {
            node *= 2;
            continue;
        }
        if (enter <= leave) {
            uint32_t first = (node - solid->leaves) * RT_SOLID_LEAF, end = first + RT_SOLID_LEAF;
            if (end > solid->count) end = solid->count;
            found = collect_leaf(set->triangles + solid->first, first, end, ray, near, far, list, found);
        }
        while (node & 1) node /= 2;
        if (node != 0) node++;
    }
    return found;
}

/* One place after the other: is the line inside before it, and after? The list shrinks where it stands. */
uint32_t rt_solid_mesh_crossings(const RtSolidSet *set, uint32_t index, const RtSolidRay *ray, float near,
                                 float far, RtCrossing *out) {
    const RtSolid *solid = &set->solids[index];
    uint32_t found = collect(set, solid, ray, near, far, out);
    uint32_t count = 0;
    int64_t depth = 0;
    for (uint32_t i = 0, next; i < found; i = next) {
        int64_t before = depth;
        RtCrossing entry = out[i], exit = out[i];
        for (next = i; next < found && out[next].t == entry.t; next++) {
            depth += out[next].solid ? 1 : -1;
            if (out[next].solid && !entry.solid) entry = out[next];
            if (!out[next].solid && exit.solid) exit = out[next];
        }
        if ((before > 0) == (depth > 0)) continue;
        out[count++] = (RtCrossing){entry.t, index, depth > 0 ? entry.face : exit.face};
    }
    return count;
}

RtVec3d rt_solid_mesh_normal(const RtSolidSet *set, const RtSolid *solid, uint32_t face, RtVec3d point) {
    (void)point;
    return rt_triangle_normal(&set->triangles[solid->first + face]);
}

/* ---- extents ---- */

double rt_solid_mesh_support(const RtSolidSet *set, const RtSolid *solid, RtVec3d direction) {
    double most = -INFINITY;
    for (uint32_t i = 0; i < solid->count; i++)
        most = fmax(most, rt_triangle_support(&set->triangles[solid->first + i], direction));
    return most;
}

/* About the middle of the box. */
RtBall rt_solid_mesh_ball(const RtSolidSet *set, const RtSolid *solid) {
    RtVec3d center = rt_widen(rt_box_center(solid->box));
    double most = 0;
    for (uint32_t i = 0; i < solid->count; i++) {
        for (int v = 0; v < 3; v++) {
            RtVec3d from = rt_subd(rt_widen(set->triangles[solid->first + i].v[v]), center);
            most = fmax(most, rt_dotd(from, from));
        }
    }
    return (RtBall){center, sqrt(most) * (1 + 0x1p-50)};
}
