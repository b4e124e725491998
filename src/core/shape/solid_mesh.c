/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of a closed triangle mesh: every directed edge occurs as often as its reverse, so the surface
 * has no border. A line is inside where it has entered more of the surface than it has left.
 *
 * Whether a line crosses a triangle is decided by the winding number of the triangle's outline about the
 * line, seen along it: moved to the origin and sheared until the ray is the z axis, as in
 * raytally/hit.h. The number is counted on the half line y = 0, x > 0: an edge from below (y < 0) to
 * above that passes to the right of the origin counts 1, its reverse -1, any other 0. An edge's contribution
 * is computed from its lower end to its upper one, whatever its direction. So both triangles at an edge
 * compute the same bits with opposite signs, and the contributions of all triangles add up to 0 exactly,
 * however they round. A line through an edge or a vertex enters as often as it leaves, and crosses no
 * triangle twice.
 *
 * Triangles lie in the leaves of a binary tree of boxes, complete, RT_SOLID_LEAF per leaf: the half of the
 * triangles that is lower along the longest side of their box goes left. So a moved copy needs new boxes but
 * no new order. If the thick ray misses a box, no outline in it winds about the line, however it rounds.
 *
 * t is computed for a point between two edges, which lies on the triangle whatever its shape: slivers,
 * triangles without area and triangles seen edge-on can be crossed. Faces across an axis are planes, as in
 * other solids, and are met at the same bits. */
#include "core/base/memory.h"
#include "core/shape/solid_parts.h"

#include <stdlib.h>

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

/* The point of the edge at y = 0; y may be off by rounding, and x and z with it. */
static Seen at_level(const Seen *lower, const Seen *upper) {
    double part = lower->y / (lower->y - upper->y);
    return (Seen){lower->x + (upper->x - lower->x) * part, 0, lower->z + (upper->z - lower->z) * part};
}

/* The t of a crossed triangle: between its two edges that meet y = 0, at x = 0. */
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
    RtVec3d normal = rt_area_vector(a, rt_widen(triangle->v[1]), rt_widen(triangle->v[2]));
    int axis = rt_axis_of(normal);
    if (axis < 0 || ray->dir.at[axis] == 0) return depth_between_edges(v);
    return (a.at[axis] - ray->org.at[axis]) / ray->dir.at[axis];
}

/* Inserts a crossing by t and then by face. Its `solid` says whether the line enters. */
static void insert(RtCrossing *list, uint32_t count, RtCrossing crossing) {
    uint32_t i = count;
    for (; i > 0; i--) {
        const RtCrossing *before = &list[i - 1];
        if (before->t < crossing.t || (before->t == crossing.t && before->face < crossing.face)) break;
        list[i] = *before;
    }
    list[i] = crossing;
}

/* Inserts the triangles of a leaf that the line crosses. */
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

/* All triangles that the line crosses. The tree is walked without a stack: the children of node n are 2n
 * and 2n + 1, so the node after a subtree is the sibling of the last even node on the way up. */
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

/* For each place: is the line inside before it, and after? The list shrinks in place. */
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

/* Around the centre of the box. */
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

/* ---- making: is it closed? ---- */

/* An edge with its ends in order; `turned` is 1 if the triangle has them in this order, -1 otherwise. */
typedef struct Edge {
    RtVec3 ends[2];
    int turned;
} Edge;

static int compare_points(RtVec3 a, RtVec3 b) {
    for (int i = 0; i < 3; i++) {
        if (a.at[i] != b.at[i]) return a.at[i] < b.at[i] ? -1 : 1;
    }
    return 0;
}

static int compare_edges(const void *a, const void *b) {
    const Edge *e = a, *f = b;
    int order = compare_points(e->ends[0], f->ends[0]);
    return order ? order : compare_points(e->ends[1], f->ends[1]);
}

static Edge edge_of(RtVec3 from, RtVec3 to) {
    return compare_points(from, to) <= 0 ? (Edge){{from, to}, 1} : (Edge){{to, from}, -1};
}

/* Sorts the edges and examines equal ones together. An edge from a point to itself does not count. */
static RtStatus check_edges(Edge *edges, size_t count, RtError *error) {
    qsort(edges, count, sizeof *edges, compare_edges);
    for (size_t i = 0, next; i < count; i = next) {
        int64_t sum = 0;
        for (next = i; next < count && compare_edges(&edges[i], &edges[next]) == 0; next++)
            sum += edges[next].turned;
        RtVec3 a = edges[i].ends[0], b = edges[i].ends[1];
        if (sum == 0 || compare_points(a, b) == 0) continue;
        return rt_fail(
            error, RT_BAD_INPUT,
            "the mesh is not closed: at the edge from (%g, %g, %g) to (%g, %g, %g) triangles on one side "
            "have no neighbour with the same winding; close the hole or reverse the triangles",
            (double)a.x, (double)a.y, (double)a.z, (double)b.x, (double)b.y, (double)b.z);
    }
    return RT_OK;
}

static RtStatus check_closed(const RtTriangle *triangles, uint32_t count, RtError *error) {
    RT_ARENA(memory);
    size_t edge_count = 3 * (size_t)count;
    Edge *edges = rt_arena_alloc(&memory, edge_count, sizeof *edges);
    RT_TRY(rt_arena_check(&memory, "the edges of a mesh", error));
    for (uint32_t i = 0; i < count; i++) {
        const RtVec3 *v = triangles[i].v;
        for (uint32_t k = 0; k < 3; k++) edges[3 * (size_t)i + k] = edge_of(v[k], v[(k + 1) % 3]);
    }
    return check_edges(edges, edge_count, error);
}

/* The volume is the sum of the tetrahedra from one vertex to all triangles. */
RtStatus rt_solid_check_volume(const RtTriangle *triangles, uint32_t count, RtError *error) {
    RtVec3d origin = rt_widen(triangles[0].v[0]);
    double volume = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d v[3];
        for (int k = 0; k < 3; k++) v[k] = rt_subd(rt_widen(triangles[i].v[k]), origin);
        volume += rt_dotd(v[0], rt_crossd(v[1], v[2])) / 6;
    }
    if (volume > 0) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "the volume of the mesh is %g: expected a value above 0; if the mesh is inside out, "
                   "reverse its triangles (counter-clockwise seen from outside)",
                   volume);
}

/* ---- order and boxes ---- */

/* A triangle with its position along an axis, and its number to break ties. */
typedef struct Placed {
    float place;
    uint32_t number;
    RtTriangle triangle;
} Placed;

static int compare_placed(const void *a, const void *b) {
    const Placed *p = a, *q = b;
    if (p->place != q->place) return p->place < q->place ? -1 : 1;
    return p->number < q->number ? -1 : 1;
}

static RtBox box_about(const RtTriangle *triangles, uint32_t count) {
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) box = rt_box_union(box, rt_triangle_box(&triangles[i]));
    return box;
}

/* Sorts the triangles of a node with that many leaves. */
static void put_in_order(RtTriangle *triangles, uint32_t count, uint32_t leaves, Placed *scratch) {
    if (count <= RT_SOLID_LEAF) return;
    uint32_t left = leaves / 2 * RT_SOLID_LEAF;
    if (left < count) {
        int axis = rt_major_axis(rt_box_size(box_about(triangles, count)));
        for (uint32_t i = 0; i < count; i++) {
            float place = rt_box_center(rt_triangle_box(&triangles[i])).at[axis];
            scratch[i] = (Placed){place, i, triangles[i]};
        }
        qsort(scratch, count, sizeof *scratch, compare_placed);
        for (uint32_t i = 0; i < count; i++) triangles[i] = scratch[i].triangle;
        put_in_order(triangles + left, count - left, leaves / 2, scratch);
    }
    put_in_order(triangles, left < count ? left : count, leaves / 2, scratch);
}

static uint32_t leaves_for(uint32_t count) {
    uint32_t leaves = 1;
    while ((uint64_t)leaves * RT_SOLID_LEAF < count) leaves *= 2;
    return leaves;
}

RtStatus rt_solid_mesh_boxes(RtSolidSet *set, RtSolid *solid, RtError *error) {
    uint32_t leaves = leaves_for(solid->count);
    RT_TRY(rt_reserve(&set->boxes, &set->box_capacity, (uint64_t)set->box_count + 2 * (uint64_t)leaves - 1,
                      sizeof(RtBox), error));
    RtBox *boxes = set->boxes + set->box_count;
    for (uint32_t i = 0; i < leaves; i++) {
        uint32_t first = i * RT_SOLID_LEAF, last = first + RT_SOLID_LEAF;
        if (last > solid->count) last = solid->count;
        boxes[leaves - 1 + i] = RT_EMPTY_BOX;
        if (first < last)
            boxes[leaves - 1 + i] = box_about(set->triangles + solid->first + first, last - first);
    }
    for (size_t node = leaves - 1; node > 0; node--)
        boxes[node - 1] = rt_box_union(boxes[2 * node - 1], boxes[2 * node]);
    solid->first_box = set->box_count;
    solid->leaves = leaves;
    return RT_OK;
}

/* ---- adding ---- */

static RtStatus check_and_order(RtTriangle *triangles, uint32_t count, RtError *error) {
    RT_TRY(check_closed(triangles, count, error));
    RT_TRY(rt_solid_check_volume(triangles, count, error));
    RT_ARENA(memory);
    Placed *scratch = rt_arena_alloc(&memory, count, sizeof *scratch);
    RT_TRY(rt_arena_check(&memory, "the order of a mesh", error));
    put_in_order(triangles, count, leaves_for(count), scratch);
    return RT_OK;
}

RtStatus rt_solid_add_mesh(RtSolidSet *set, const RtTriangle *triangles, uint32_t count,
                           const RtTransform *to_world, uint32_t *index, RtError *error) {
    if (count < 4)
        return rt_fail(error, RT_BAD_INPUT, "a closed mesh needs at least 4 triangles, this one has %u",
                       count);
    const RtTransform here = rt_transform_identity();
    if (!to_world) to_world = &here;
    RT_TRY(rt_solid_check_transform(to_world, error));
    RT_TRY(rt_reserve(&set->triangles, &set->triangle_capacity, (uint64_t)set->triangle_count + count,
                      sizeof(RtTriangle), error));
    RtTriangle *own = set->triangles + set->triangle_count;
    for (uint32_t i = 0; i < count; i++) {
        for (int v = 0; v < 3; v++) {
            own[i].v[v] = rt_transform_point(to_world, triangles[i].v[v]);
            if (!rt_finite(own[i].v[v]))
                return rt_fail(error, RT_BAD_INPUT, "vertex %d of triangle %u of the mesh is not finite", v,
                               i);
        }
    }
    RT_TRY(check_and_order(own, count, error));
    RtSolid solid = {.kind = RT_SOLID_MESH, .first = set->triangle_count, .count = count, .to_world = here};
    RT_TRY(rt_solid_mesh_boxes(set, &solid, error));
    return rt_solid_finish(set, &solid, rt_solid_mesh_support, index, error);
}
