/* SPDX-License-Identifier: Apache-2.0 */
/* Surfaces against boxes, by separating axes: two convex sets are disjoint if their projections on some axis
 * are. For polygons these axes are the polygon's normal, the box's, and the cross products of their edges
 * (Akenine-Möller 2001, "Fast 3D Triangle-Box Overlap Testing", JGT 6(1), from Gottschalk, Lin & Manocha
 * 1996). For other shapes the support function provides the projections on the axes of their frame.
 * Everything is computed in double relative to the centre of the box, which is grown by the margin first.
 *
 * The part of a surface within a box: polygons are clipped by one plane of the box after another
 * (Sutherland & Hodgman 1974, "Reentrant Polygon Clipping"), spheres and cones are cut along their axes of
 * symmetry. Rounding can lose only points within rounding of the faces of the grown box, far from the box
 * itself. */
#include "core/shape/overlap.h"

/* Larger polygons are tested by plane and box alone: edge tests take time quadratic in the vertices. */
enum { MAX_EDGES = 16 };

typedef struct Block {
    RtVec3d center, half;
} Block;

static Block grown_block(const RtBox *box, double margin) {
    Block block;
    for (int a = 0; a < 3; a++) {
        double lo = (double)box->lo.at[a], hi = (double)box->hi.at[a];
        block.center.at[a] = lo / 2 + hi / 2;
        block.half.at[a] = (hi - lo) / 2 + margin;
    }
    return block;
}

/* Is the block outside [lo, hi] along `axis`, which may have any length? */
static bool beyond(const Block *block, RtVec3d axis, double lo, double hi) {
    double reach = fabs(axis.x) * block->half.x + fabs(axis.y) * block->half.y + fabs(axis.z) * block->half.z;
    return lo > reach || hi < -reach;
}

static bool points_beyond(const Block *block, const RtVec3d *points, uint32_t count, RtVec3d axis) {
    double lo = INFINITY, hi = -INFINITY;
    for (uint32_t i = 0; i < count; i++) {
        double at = rt_dotd(points[i], axis);
        lo = fmin(lo, at);
        hi = fmax(hi, at);
    }
    return beyond(block, axis, lo, hi);
}

/* For a flat convex polygon, relative to the block. */
static bool chain_meets(const Block *block, const RtVec3d *points, uint32_t count, RtVec3d normal) {
    if (points_beyond(block, points, count, normal)) return false;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d e = rt_subd(points[(i + 1) % count], points[i]);
        const RtVec3d axes[3] = {{0, e.z, -e.y}, {-e.z, 0, e.x}, {e.y, -e.x, 0}};
        for (int a = 0; a < 3; a++) {
            if (points_beyond(block, points, count, axes[a])) return false;
        }
    }
    return true;
}

static void triangle_points(const RtTriangle *triangle, const Block *block, RtVec3d points[3]) {
    for (int i = 0; i < 3; i++) points[i] = rt_subd(rt_widen(triangle->v[i]), block->center);
}

static bool triangle_meets(const RtTriangle *triangle, const Block *block) {
    RtVec3d points[3];
    triangle_points(triangle, block, points);
    RtVec3d normal = rt_area_vector(points[0], points[1], points[2]);
    return chain_meets(block, points, 3, normal);
}

/* The polygon as it is hit: its vertices moved to its plane along the axis of projection. */
static void polygon_points(const RtPolygon *polygon, const RtVec3 *vertices, const Block *block,
                           RtVec3d points[MAX_EDGES]) {
    RtVec3d center = rt_subd(polygon->center, block->center), n = polygon->normal;
    uint32_t u = polygon->u, v = polygon->v, w = 3 - u - v;
    for (uint32_t i = 0; i < polygon->count; i++) {
        points[i] = rt_subd(rt_widen(vertices[i]), block->center);
        points[i].at[w] = center.at[w] - (n.at[u] * (points[i].at[u] - center.at[u]) +
                                          n.at[v] * (points[i].at[v] - center.at[v])) /
                                             n.at[w];
    }
}

static bool polygon_meets(const RtPolygon *polygon, const RtVec3 *vertices, const Block *block) {
    RtVec3d points[MAX_EDGES];
    double plane = rt_dotd(polygon->normal, rt_subd(polygon->center, block->center));
    if (polygon->count > MAX_EDGES) return !beyond(block, polygon->normal, plane, plane);
    polygon_points(polygon, vertices, block, points);
    return chain_meets(block, points, polygon->count, polygon->normal);
}

/* The surface meets the block if its nearest point is inside the sphere and its farthest is not. */
static bool sphere_meets(const RtSphere *sphere, const Block *block) {
    RtVec3d offset = rt_subd(rt_widen(sphere->center), block->center);
    double radius = (double)sphere->radius, nearest = 0, farthest = 0;
    for (int a = 0; a < 3; a++) {
        double near = fmax(fabs(offset.at[a]) - block->half.at[a], 0);
        double far = fabs(offset.at[a]) + block->half.at[a];
        nearest += near * near;
        farthest += far * far;
    }
    return nearest <= radius * radius && farthest >= radius * radius;
}

static bool frame_meets(const RtOutline *outline, const Block *block) {
    for (int a = 0; a < 3; a++) {
        double at = rt_dotd(outline->axes[a], block->center);
        if (beyond(block, outline->axes[a], outline->lo[a] - at, outline->hi[a] - at)) return false;
    }
    return true;
}

RtOutline rt_object_outline(const RtGeometry *geometry, uint32_t id) {
    RtOutline outline = {.geometry = geometry, .id = id};
    RtShape shape = rt_ref_shape(geometry->objects[id]);
    if (shape != RT_SHAPE_CONE && shape != RT_SHAPE_CSG) return outline;
    rt_object_frame(geometry, id, outline.axes);
    for (int a = 0; a < 3; a++) {
        outline.lo[a] = -rt_object_support(geometry, id, rt_scaled(outline.axes[a], -1));
        outline.hi[a] = rt_object_support(geometry, id, outline.axes[a]);
    }
    return outline;
}

bool rt_outline_meets_box(const RtOutline *outline, const RtBox *box, double margin) {
    const RtGeometry *geometry = outline->geometry;
    uint32_t id = outline->id;
    const RtBox *own = &geometry->boxes[id];
    Block block = grown_block(box, margin);
    bool held = true;
    for (int a = 0; a < 3; a++) {
        double lo = (double)box->lo.at[a], hi = (double)box->hi.at[a];
        double own_lo = (double)own->lo.at[a], own_hi = (double)own->hi.at[a];
        if (own_lo - hi > margin || lo - own_hi > margin) return false;
        held &= lo - own_lo <= margin && own_hi - hi <= margin;
    }
    if (held) return true; /* an object entirely inside the grown box meets it */
    uint32_t index = rt_ref_index(geometry->objects[id]);
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_TRIANGLE: return triangle_meets(&geometry->triangles[index], &block);
    case RT_SHAPE_SPHERE: return sphere_meets(&geometry->spheres[index], &block);
    case RT_SHAPE_POLYGON:
        return polygon_meets(&geometry->polygons[index], rt_polygon_vertices(geometry, index), &block);
    case RT_SHAPE_INSTANCE: return true;
    default: return frame_meets(outline, &block);
    }
}

/* ---- parts ---- */

/* Each plane cuts each edge at most once, and at most half the edges. */
enum { MAX_CLIPPED = 192 };

/* Projections on the axes. */
typedef struct Bounds {
    double lo[3], hi[3];
} Bounds;

/* Clips a polygon to within `half` of the block's centre along an axis, on the side of `sign`; returns the
 * number of points. */
static uint32_t clip_chain(const RtVec3d *in, uint32_t count, int axis, double sign, double half,
                           RtVec3d *out) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d from = in[i], to = in[(i + 1) % count];
        double before = half - sign * from.at[axis], after = half - sign * to.at[axis];
        if (before >= 0) out[n++] = from;
        if ((before < 0) == (after < 0)) continue;
        out[n] = rt_add_scaledd(from, rt_subd(to, from), before / (before - after));
        out[n++].at[axis] = sign * half;
    }
    return n;
}

static bool chain_part(const Block *block, RtVec3d *points, uint32_t count, Bounds *bounds) {
    RtVec3d clipped[MAX_CLIPPED];
    for (int a = 0; a < 3; a++) {
        count = clip_chain(points, count, a, 1, block->half.at[a], clipped);
        count = clip_chain(clipped, count, a, -1, block->half.at[a], points);
    }
    for (int a = 0; a < 3; a++) {
        bounds->lo[a] = INFINITY;
        bounds->hi[a] = -INFINITY;
        for (uint32_t i = 0; i < count; i++) {
            bounds->lo[a] = fmin(bounds->lo[a], block->center.at[a] + points[i].at[a]);
            bounds->hi[a] = fmax(bounds->hi[a], block->center.at[a] + points[i].at[a]);
        }
    }
    return count > 0;
}

/* Along an axis the sphere reaches as far as the point of the block that is nearest to its centre along
 * the other axes allows. */
static bool sphere_part(const RtSphere *sphere, const Block *block, Bounds *bounds) {
    double square = (double)sphere->radius * (double)sphere->radius * (1 + 0x1p-40), apart[3];
    if (!sphere_meets(sphere, block)) return false;
    for (int a = 0; a < 3; a++)
        apart[a] = fmax(fabs((double)sphere->center.at[a] - block->center.at[a]) - block->half.at[a], 0);
    for (int a = 0; a < 3; a++) {
        double b = apart[(a + 1) % 3], c = apart[(a + 2) % 3];
        double reach = sqrt(fmax(square - b * b - c * c, 0)), center = (double)sphere->center.at[a];
        bounds->lo[a] = center - reach;
        bounds->hi[a] = center + reach;
    }
    return true;
}

/* Clips [*from, *to] to where value + slope * s <= limit. */
static void keep_below(double value, double slope, double limit, double *from, double *to) {
    if (slope > 0) *to = fmin(*to, (limit - value) / slope);
    if (slope < 0) *from = fmax(*from, (limit - value) / slope);
}

/* Along an axis, the circle at height s extends between two linear functions of s. The block limits these,
 * which leaves an interval of heights. */
static bool cone_part(const RtCone *cone, const Block *block, Bounds *bounds) {
    double from = -cone->height / 2, to = cone->height / 2, value[3][2], slope[3][2];
    double radius = (double)cone->base_radius + cone->slope * cone->height / 2;
    for (int a = 0; a < 3; a++) {
        double tilt = sqrt(fmax(1 - cone->axis.at[a] * cone->axis.at[a], 0)) * (1 + 0x1p-40);
        double middle = cone->middle.at[a] - block->center.at[a], half = block->half.at[a];
        for (int side = 0; side < 2; side++) {
            double reach = side == 0 ? -tilt : tilt;
            value[a][side] = middle + reach * radius;
            slope[a][side] = cone->axis.at[a] + reach * cone->slope;
        }
        keep_below(value[a][0], slope[a][0], half, &from, &to);
        keep_below(-value[a][1], -slope[a][1], half, &from, &to);
    }
    if (from > to) return false;
    for (int a = 0; a < 3; a++) {
        double center = block->center.at[a];
        bounds->lo[a] = center + value[a][0] + fmin(slope[a][0] * from, slope[a][0] * to);
        bounds->hi[a] = center + value[a][1] + fmax(slope[a][1] * from, slope[a][1] * to);
    }
    return true;
}

/* False if there is none. `bounds` is initially the own box and may remain unchanged. */
static bool surface_part(const RtGeometry *geometry, uint32_t id, const RtBox *box, double margin,
                         Bounds *bounds) {
    RtVec3d points[MAX_CLIPPED];
    Block block = grown_block(box, margin);
    uint32_t index = rt_ref_index(geometry->objects[id]);
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_TRIANGLE:
        triangle_points(&geometry->triangles[index], &block, points);
        return chain_part(&block, points, 3, bounds);
    case RT_SHAPE_SPHERE: return sphere_part(&geometry->spheres[index], &block, bounds);
    case RT_SHAPE_CONE: return cone_part(&geometry->cones[index], &block, bounds);
    case RT_SHAPE_POLYGON: {
        const RtPolygon *polygon = &geometry->polygons[index];
        if (polygon->count > MAX_EDGES) break;
        polygon_points(polygon, rt_polygon_vertices(geometry, index), &block, points);
        return chain_part(&block, points, polygon->count, bounds);
    }
    default: break;
    }
    RtOutline outline = rt_object_outline(geometry, id);
    return rt_outline_meets_box(&outline, box, margin);
}

bool rt_object_part(const RtGeometry *geometry, uint32_t id, const RtBox *box, double margin, RtBox *out) {
    const RtBox *own = &geometry->boxes[id];
    Bounds bounds;
    for (int a = 0; a < 3; a++) {
        bounds.lo[a] = (double)own->lo.at[a];
        bounds.hi[a] = (double)own->hi.at[a];
    }
    if (!surface_part(geometry, id, box, margin, &bounds)) return false;
    for (int a = 0; a < 3; a++) {
        out->lo.at[a] = rt_maxf(rt_float_below(bounds.lo[a] - margin), rt_maxf(own->lo.at[a], box->lo.at[a]));
        out->hi.at[a] = rt_minf(rt_float_above(bounds.hi[a] + margin), rt_minf(own->hi.at[a], box->hi.at[a]));
    }
    return !rt_box_is_empty(*out);
}
