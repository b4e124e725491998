/* SPDX-License-Identifier: Apache-2.0 */
/* Solids by the parameters of scene files. */
#include "core/base/memory.h"
#include "core/shape/solid_parts.h"

/* ---- polyhedra ---- */

RtStatus rt_solid_add_box(RtSolidSet *set, RtVec3 lo, RtVec3 hi, uint32_t *index, RtError *error) {
    RtPlane planes[3][2] = {0};
    for (int a = 0; a < 3; a++) {
        if (!(lo.at[a] < hi.at[a]))
            return rt_fail(error, RT_BAD_INPUT, "a box needs lo < hi on each axis; on %c they are %g and %g",
                           "xyz"[a], (double)lo.at[a], (double)hi.at[a]);
        planes[a][0].normal.at[a] = -1, planes[a][0].offset = -(double)lo.at[a];
        planes[a][1].normal.at[a] = 1, planes[a][1].offset = (double)hi.at[a];
    }
    return rt_solid_add_polyhedron(set, planes[0], 6, NULL, index, error);
}

RtStatus rt_solid_add_half_space(RtSolidSet *set, RtVec3 point, RtVec3 normal, uint32_t *index,
                                 RtError *error) {
    if (!rt_finite(point) || !rt_finite(normal) || rt_lengthd(rt_widen(normal)) == 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "a half-space needs a point and a normal of finite numbers, the normal not 0");
    RtPlane plane = rt_plane_through(rt_widen(point), rt_widen(normal));
    return rt_solid_add_polyhedron(set, &plane, 1, NULL, index, error);
}

/* ---- round solids ---- */

RtStatus rt_solid_add_ellipsoid(RtSolidSet *set, RtVec3 center, RtVec3 radii, uint32_t *index,
                                RtError *error) {
    if (!(radii.x > 0 && radii.y > 0 && radii.z > 0))
        return rt_fail(error, RT_BAD_INPUT, "the radii of an ellipsoid must be above 0; these are %g, %g, %g",
                       (double)radii.x, (double)radii.y, (double)radii.z);
    RtTransform to_world = rt_transform_identity();
    RT_TRY(rt_transform_scale(&to_world, radii, error));
    RT_TRY(rt_transform_translate(&to_world, center, error));
    return rt_solid_add_sphere(set, &to_world, index, error);
}

/* The transform whose z axis is `height` along `axis` and whose x and y axes are `radius` long, all
 * orthogonal. An axis along a world axis yields axes along world axes. */
static RtTransform transform_about(RtVec3d origin, RtVec3d axis, double radius, double height) {
    RtVec3d z = rt_normalized(axis), aside = {{0, 0, 0}};
    int least = 0;
    for (int a = 1; a < 3; a++) least = fabs(z.at[a]) < fabs(z.at[least]) ? a : least;
    aside.at[least] = 1;
    RtVec3d x = rt_normalized(rt_crossd(aside, z)), y = rt_crossd(z, x);
    const RtVec3d columns[4] = {rt_scaled(x, radius), rt_scaled(y, radius), rt_scaled(z, height), origin};
    RtTransform to_world;
    for (int row = 0; row < 3; row++) {
        for (int i = 0; i < 4; i++) to_world.m[row][i] = columns[i].at[row];
    }
    return to_world;
}

RtStatus rt_solid_add_frustum(RtSolidSet *set, RtVec3 base, float base_radius, RtVec3 apex, float apex_radius,
                              uint32_t *index, RtError *error) {
    RtCone checked;
    RT_TRY(rt_cone_init(&checked, base, base_radius, apex, apex_radius, error));
    if (apex_radius > base_radius)
        return rt_solid_add_frustum(set, apex, apex_radius, base, base_radius, index, error);
    RtVec3d axis = rt_subd(rt_widen(apex), rt_widen(base));
    RtTransform to_world = transform_about(rt_widen(base), axis, (double)base_radius, checked.height);
    return rt_solid_add_cone(set, (double)apex_radius / (double)base_radius, &to_world, index, error);
}

RtStatus rt_solid_add_ring(RtSolidSet *set, RtVec3 center, RtVec3 axis, float major, float minor,
                           uint32_t *index, RtError *error) {
    if (!(minor > 0 && minor < major))
        return rt_fail(
            error, RT_BAD_INPUT,
            "a torus needs 0 < minor < major, the radii of its tube and of the circle in it; these "
            "are %g and %g",
            (double)minor, (double)major);
    if (rt_lengthd(rt_widen(axis)) == 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "the axis of the torus has length 0: give a direction, as in [0, 0, 1]");
    RtTransform to_world = transform_about(rt_widen(center), rt_widen(axis), (double)major, (double)major);
    return rt_solid_add_torus(set, (double)minor / (double)major, &to_world, index, error);
}

/* ---- convex hulls ----
 *
 * Tries the plane of each three points. Most planes are discarded
 * at once, having a point on either side; the rest are faces. Each face is found once per triple of its
 * vertices, and kept once.
 *
 * Points have been rounded to float32, so four vertices of a face need not be coplanar: all points within
 * `close` of a plane belong to the face. Its plane is then that of the three of them that span the most,
 * so that a sliver does not tilt it, moved outward to contain all points. */

typedef struct Cloud {
    const RtVec3 *points;
    uint32_t count;
    double close; /* a few ulps of the largest coordinate: so near a plane, a point counts as in it */
} Cloud;

static RtVec3d point_of(const Cloud *cloud, uint32_t i) {
    return rt_widen(cloud->points[i]);
}

static double height_above(const RtPlane *plane, RtVec3d point) {
    return rt_dotd(plane->normal, point) - plane->offset;
}

/* The plane of three points; false if they are nearly collinear. */
static bool plane_of_three(const Cloud *cloud, const uint32_t at[3], RtPlane *plane) {
    RtVec3d a = point_of(cloud, at[0]), ab = rt_subd(point_of(cloud, at[1]), a),
            ac = rt_subd(point_of(cloud, at[2]), a), bc = rt_subd(ac, ab), normal = rt_crossd(ab, ac);
    double longest = sqrt(fmax(fmax(rt_dotd(ab, ab), rt_dotd(ac, ac)), rt_dotd(bc, bc)));
    if (!(rt_lengthd(normal) > cloud->close * longest)) return false;
    *plane = rt_plane_through(a, normal);
    return true;
}

/* Orients the plane so that no point is above it; false if there are points on both sides, or on neither. */
static bool turn_outward(const Cloud *cloud, RtPlane *plane) {
    bool above = false, below = false;
    for (uint32_t i = 0; i < cloud->count && !(above && below); i++) {
        double height = height_above(plane, point_of(cloud, i));
        above |= height > cloud->close;
        below |= height < -cloud->close;
    }
    if (above == below) return false;
    if (above) *plane = (RtPlane){rt_scaled(plane->normal, -1), -plane->offset};
    return true;
}

/* The point in the plane that is farthest from `from`, or with `to` from the line through both. */
static uint32_t farthest_in(const Cloud *cloud, const RtPlane *plane, RtVec3d from, const RtVec3d *to) {
    uint32_t best = 0;
    double most = -1;
    for (uint32_t i = 0; i < cloud->count; i++) {
        RtVec3d point = point_of(cloud, i), away = rt_subd(point, from);
        if (fabs(height_above(plane, point)) > cloud->close) continue;
        if (to) away = rt_crossd(away, rt_subd(*to, from));
        double squared = rt_dotd(away, away);
        if (squared > most) most = squared, best = i;
    }
    return best;
}

/* The plane of three points of the face that are far from each other, moved out to the highest point. */
static void settle(const Cloud *cloud, RtPlane *plane, uint32_t any) {
    RtPlane rough = *plane;
    uint32_t at[3] = {any};
    at[0] = farthest_in(cloud, &rough, point_of(cloud, any), NULL);
    RtVec3d a = point_of(cloud, at[0]);
    at[1] = farthest_in(cloud, &rough, a, NULL);
    RtVec3d b = point_of(cloud, at[1]);
    at[2] = farthest_in(cloud, &rough, a, &b);
    if (!plane_of_three(cloud, at, plane)) *plane = rough;
    if (rt_dotd(plane->normal, rough.normal) < 0) plane->normal = rt_scaled(plane->normal, -1);
    uint32_t highest = 0;
    for (uint32_t i = 1; i < cloud->count; i++) {
        double more = rt_dotd(plane->normal, rt_subd(point_of(cloud, i), point_of(cloud, highest)));
        highest = more > 0 ? i : highest;
    }
    *plane = rt_plane_through(point_of(cloud, highest), plane->normal);
}

/* Is there already a face with these three points? */
static bool is_known(const Cloud *cloud, const RtPlane *planes, uint32_t count, const uint32_t at[3]) {
    for (uint32_t i = 0; i < count; i++) {
        bool holds = true;
        for (int k = 0; k < 3; k++)
            holds &= fabs(height_above(&planes[i], point_of(cloud, at[k]))) <= 2 * cloud->close;
        if (holds) return true;
    }
    return false;
}

/* Finds the faces of the hull, at most `capacity`, and returns their number. */
static uint32_t find_faces(const Cloud *cloud, RtPlane *planes, uint32_t capacity) {
    uint32_t found = 0, at[3];
    for (at[0] = 0; at[0] < cloud->count; at[0]++) {
        for (at[1] = at[0] + 1; at[1] < cloud->count; at[1]++) {
            for (at[2] = at[1] + 1; at[2] < cloud->count && found < capacity; at[2]++) {
                RtPlane plane;
                if (!plane_of_three(cloud, at, &plane) || !turn_outward(cloud, &plane)) continue;
                if (is_known(cloud, planes, found, at)) continue;
                settle(cloud, &plane, at[0]);
                planes[found++] = plane;
            }
        }
    }
    return found;
}

RtStatus rt_solid_add_hull(RtSolidSet *set, const RtVec3 *vertices, uint32_t count, uint32_t *index,
                           RtError *error) {
    if (count < 4 || count > RT_SOLID_MAX_VERTICES)
        return rt_fail(error, RT_BAD_INPUT,
                       "a convex polyhedron of %u vertices: expected 4..%d; use a mesh for more", count,
                       RT_SOLID_MAX_VERTICES);
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) {
        if (!rt_finite(vertices[i]))
            return rt_fail(error, RT_BAD_INPUT, "vertex %u of the polyhedron is not finite", i);
        box = rt_box_add_point(box, vertices[i]);
    }
    Cloud cloud = {vertices, count, 0x1p-21 * rt_box_largest_coordinate(box)};
    RT_ARENA(memory);
    RtPlane *planes = rt_arena_alloc(&memory, RT_SOLID_MAX_FACES, sizeof *planes);
    RT_TRY(rt_arena_check(&memory, "the faces of a polyhedron", error));
    uint32_t faces = find_faces(&cloud, planes, RT_SOLID_MAX_FACES);
    if (faces < 4)
        return rt_fail(error, RT_BAD_INPUT,
                       "the %u vertices of the polyhedron are in one plane, or nearly so", count);
    return rt_solid_add_polyhedron(set, planes, faces, NULL, index, error);
}
