/* Surfaces against boxes: a convex thing and a box are apart if their shadows on some axis are. For polygons
 * the axes that can tell are their normal, the box's, and the cross products of an edge of each (Akenine-
 * Möller 2001, "Fast 3D Triangle-Box Overlap Testing", JGT 6(1), from Gottschalk, Lin & Manocha 1996). Of
 * other shapes the support function gives the shadows on the axes of their frame. Everything is taken
 * relative to the centre of the box and in double, and the box is grown by the margin first. */
#include "shape/overlap.h"

/* Polygons of more vertices are judged by plane and box alone: the edges take the square of their number. */
enum { MAX_EDGES = 16 };

typedef struct Block {
    RtVec3d center, half;
} Block;

/* Is the block beyond [lo, hi] along `axis`, which may have any length? */
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

/* For a flat convex chain of points, relative to the block. */
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

static bool triangle_meets(const RtTriangle *triangle, const Block *block) {
    RtVec3d points[3];
    for (int i = 0; i < 3; i++) points[i] = rt_subd(rt_widen(triangle->v[i]), block->center);
    RtVec3d normal = rt_crossd(rt_subd(points[1], points[0]), rt_subd(points[2], points[0]));
    return chain_meets(block, points, 3, normal);
}

/* The polygon as it is hit: its vertices moved to its plane along the axis it is projected along. */
static bool polygon_meets(const RtPolygon *polygon, const RtVec3 *vertices, const Block *block) {
    RtVec3d points[MAX_EDGES], center = rt_subd(polygon->center, block->center), n = polygon->normal;
    uint32_t u = polygon->u, v = polygon->v, w = 3 - u - v;
    double plane = rt_dotd(n, center);
    if (polygon->count > MAX_EDGES) return !beyond(block, n, plane, plane);
    for (uint32_t i = 0; i < polygon->count; i++) {
        points[i] = rt_subd(rt_widen(vertices[i]), block->center);
        points[i].at[w] = center.at[w] - (n.at[u] * (points[i].at[u] - center.at[u]) +
                                          n.at[v] * (points[i].at[v] - center.at[v])) /
                                             n.at[w];
    }
    return chain_meets(block, points, polygon->count, n);
}

/* The nearest point of the block is within the ball, the farthest is not. */
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

static bool frame_meets(const RtGeometry *geometry, uint32_t id, const Block *block) {
    RtVec3d axes[3];
    rt_object_frame(geometry, id, axes);
    for (int a = 0; a < 3; a++) {
        double at = rt_dotd(axes[a], block->center);
        double hi = rt_object_support(geometry, id, axes[a]);
        double lo = -rt_object_support(geometry, id, rt_scaled(axes[a], -1));
        if (beyond(block, axes[a], lo - at, hi - at)) return false;
    }
    return true;
}

bool rt_object_meets_box(const RtGeometry *geometry, uint32_t id, const RtBox *box, double margin) {
    const RtBox *own = &geometry->boxes[id];
    Block block;
    for (int a = 0; a < 3; a++) {
        double lo = (double)box->lo.at[a], hi = (double)box->hi.at[a];
        if ((double)own->lo.at[a] - hi > margin || lo - (double)own->hi.at[a] > margin) return false;
        block.center.at[a] = lo / 2 + hi / 2;
        block.half.at[a] = (hi - lo) / 2 + margin;
    }
    uint32_t index = rt_ref_index(geometry->objects[id]);
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_TRIANGLE: return triangle_meets(&geometry->triangles[index], &block);
    case RT_SHAPE_SPHERE: return sphere_meets(&geometry->spheres[index], &block);
    case RT_SHAPE_POLYGON: {
        const RtPolygon *polygon = &geometry->polygons[index];
        return polygon_meets(polygon, geometry->polygon_vertices + polygon->first, &block);
    }
    default: return frame_meets(geometry, id, &block);
    }
}
