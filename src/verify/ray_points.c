/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/ray_points.h"

#include "rays/rayset.h"

RtVec3d rt_point_in_box(const RtBox *box, RtRandom *random) {
    RtVec3d p;
    for (int a = 0; a < 3; a++)
        p.at[a] = rt_random_betweend(random, (double)box->lo.at[a], (double)box->hi.at[a]);
    return p;
}

RtVec3d rt_point_in_scene(const RtGeometry *g, RtRandom *random) {
    if (g->object_count == 0) return rt_random_direction(random);
    return rt_point_in_box(&g->box, random);
}

const RtBox *rt_some_box(const RtGeometry *g, RtRandom *random) {
    static const RtBox unit = {{-1, -1, -1}, {1, 1, 1}};
    if (g->object_count == 0) return &unit;
    if (rt_random_below(random, 4) == 0) return &g->box;
    return &g->boxes[rt_random_below(random, g->object_count)];
}

/* A point of a cone's side, or of one of its circles if `rim`. */
static RtVec3d point_of_cone(const RtCone *cone, bool rim, RtRandom *random) {
    RtVec3d around = rt_normalized(rt_crossd(cone->axis, rt_random_direction(random)));
    double s = rim ? (double)rt_random_below(random, 2) : rt_random_betweend(random, 0, 1);
    double radius = (double)cone->base_radius + cone->slope * cone->height * s;
    return rt_add_scaledd(rt_add_scaledd(rt_widen(cone->base), cone->axis, cone->height * s), around, radius);
}

static RtVec3d point_of_vertices(const RtVec3 *v, uint32_t count, RtWhere where, RtRandom *random) {
    uint32_t i = rt_random_below(random, count);
    RtVec3d a = rt_widen(v[i]), b = rt_widen(v[(i + 1) % count]), c = rt_widen(v[(i + 2) % count]);
    if (where == RT_AT_VERTEX) return a;
    RtVec3d p = rt_add_scaledd(a, rt_subd(b, a), rt_random_betweend(random, 0, 1));
    return where == RT_ON_EDGE ? p : rt_add_scaledd(p, rt_subd(c, p), rt_random_betweend(random, 0, 1));
}

/* One of the six points where a sphere touches its box, or any other. */
static RtVec3d point_of_sphere(const RtSphere *sphere, RtWhere where, RtRandom *random) {
    RtVec3d out = rt_random_direction(random);
    if (where == RT_AT_VERTEX) {
        uint32_t pole = rt_random_below(random, 6);
        out = rt_vec3d(0, 0, 0);
        out.at[pole / 2] = pole % 2 ? 1 : -1;
    }
    return rt_add_scaledd(rt_widen(sphere->center), out, (double)sphere->radius);
}

/* For a tree: a corner or an edge point of the box of one of its solids, or where a random line meets the
 * tree. */
static RtVec3d point_of_csg(const RtGeometry *g, uint32_t id, RtWhere where, RtRandom *random,
                            RtCrossing *crossings) {
    const RtCsg *tree = &g->csgs[rt_ref_index(g->objects[id])];
    if (where == RT_ON_SURFACE) {
        RtRay ray = rt_random_chord(&tree->box, random);
        RtPreparedRay prepared = rt_ray_prepare(&ray, &tree->box);
        prepared.crossings = crossings;
        float t;
        if (rt_object_hit(g, id, &prepared, &t, NULL)) return rt_ray_point(&ray, t);
    }
    const RtBox *box =
        &g->forest.set.solids[tree->first_solid + rt_random_below(random, tree->solid_count)].box;
    if (!rt_finite(box->lo) || !rt_finite(box->hi)) box = &tree->box;
    RtVec3d p = rt_point_in_box(box, random);
    uint32_t along = where == RT_AT_VERTEX ? 3 : rt_random_below(random, 3);
    for (uint32_t a = 0; a < 3; a++) {
        if (a != along) p.at[a] = (double)(rt_random_below(random, 2) ? box->hi : box->lo).at[a];
    }
    return p;
}

RtVec3d rt_point_of_object(const RtGeometry *g, RtWhere where, RtRandom *random, RtCrossing *crossings,
                           uint32_t *id) {
    *id = RT_NO_OBJECT;
    if (g->object_count == 0) return rt_point_in_scene(g, random);
    *id = rt_random_below(random, g->object_count);
    uint32_t index = rt_ref_index(g->objects[*id]);
    switch (rt_ref_shape(g->objects[*id])) {
    case RT_SHAPE_SPHERE: return point_of_sphere(&g->spheres[index], where, random);
    case RT_SHAPE_TRIANGLE: return point_of_vertices(g->triangles[index].v, 3, where, random);
    case RT_SHAPE_POLYGON: {
        const RtPolygon *polygon = &g->polygons[index];
        return point_of_vertices(rt_polygon_vertices(g, index), polygon->count, where, random);
    }
    case RT_SHAPE_CONE: return point_of_cone(&g->cones[index], where != RT_ON_SURFACE, random);
    case RT_SHAPE_CSG: return point_of_csg(g, *id, where, random, crossings);
    case RT_SHAPE_COUNT: break;
    }
    return rt_point_in_scene(g, random);
}
