/* SPDX-License-Identifier: Apache-2.0 */
/* The families of rays: one function per family generates one ray from its random numbers; then all rays of a
 * scene. */
#include "verify/verify_rays.h"

#include "core/base/memory.h"
#include "core/base/random.h"

#include <assert.h>
#include <string.h>

typedef struct Generator {
    RtQuery *query;
    const RtScene *scene;
    const RtGeometry *geometry; /* the scene's, or while something in an instance is chosen, its part's */
    /* The object of the last point, if that is in an instance: where it is, and which point there. */
    const RtGeometry *part; /* NULL: it is an object of the scene itself */
    uint32_t object;
    RtVec3d inside;
    RtTransform to_world;
    RtBox moved;    /* the last box in an instance */
    RtView view;    /* of its camera; no samples if the camera is invalid */
    RtVec3d center; /* of the scene's box */
    double size;    /* half its diagonal */
    RtRandom random;
    RtRandom shared; /* the same for RT_RAY_BUNDLE rays in a row */
} Generator;

static uint32_t below(Generator *m, uint32_t n) {
    return rt_random_below(&m->random, n);
}

static double between(Generator *m, double lo, double hi) {
    return rt_random_betweend(&m->random, lo, hi);
}

static RtVec3d direction(Generator *m) {
    return rt_random_direction(&m->random);
}

/* ---- points where rays start and aim; in an empty scene they are arbitrary ---- */

/* A part of an object. The vertices of a sphere are the six points where it touches its box, those of a
 * cone lie on its two circles; a CSG tree has the vertices and edges of the box of one of its solids. */
typedef enum Where { AT_VERTEX, ON_EDGE, ON_SURFACE } Where;

static RtVec3d point_in_box(Generator *m, const RtBox *box) {
    RtVec3d p;
    for (int a = 0; a < 3; a++) p.at[a] = between(m, (double)box->lo.at[a], (double)box->hi.at[a]);
    return p;
}

static RtVec3d point_in_scene(Generator *m) {
    if (m->geometry->object_count == 0) return direction(m);
    return point_in_box(m, &m->geometry->box);
}

/* The box of a random object, perhaps in an instance, or of the scene. */
static const RtBox *some_box(Generator *m) {
    const RtGeometry *g = m->geometry;
    static const RtBox unit = {{-1, -1, -1}, {1, 1, 1}};
    if (g->object_count == 0) return &unit;
    if (below(m, 4) == 0) return &g->box;
    const uint32_t id = below(m, g->object_count);
    if (!rt_is_instance(g, id) || below(m, 2)) return &g->boxes[id];
    const RtInstance *instance = rt_instance_of(g, id);
    m->geometry = instance->geometry;
    m->moved = rt_moved_box(some_box(m), &instance->to_world);
    m->geometry = g;
    return &m->moved;
}

/* A point of a cone's side, or of one of its circles if `rim`. */
static RtVec3d point_of_cone(Generator *m, const RtCone *cone, bool rim) {
    RtVec3d around = rt_normalized(rt_crossd(cone->axis, direction(m)));
    double s = rim ? (double)below(m, 2) : between(m, 0, 1);
    double radius = (double)cone->base_radius + cone->slope * cone->height * s;
    return rt_add_scaledd(rt_add_scaledd(rt_widen(cone->base), cone->axis, cone->height * s), around, radius);
}

static RtVec3d point_of_vertices(Generator *m, const RtVec3 *v, uint32_t count, Where where) {
    uint32_t i = below(m, count);
    RtVec3d a = rt_widen(v[i]), b = rt_widen(v[(i + 1) % count]), c = rt_widen(v[(i + 2) % count]);
    if (where == AT_VERTEX) return a;
    RtVec3d p = rt_add_scaledd(a, rt_subd(b, a), between(m, 0, 1));
    return where == ON_EDGE ? p : rt_add_scaledd(p, rt_subd(c, p), between(m, 0, 1));
}

/* One of the six points where a sphere touches its box, or any other. */
static RtVec3d point_of_sphere(Generator *m, const RtSphere *sphere, Where where) {
    RtVec3d out = direction(m);
    if (where == AT_VERTEX) {
        uint32_t pole = below(m, 6);
        out = rt_vec3d(0, 0, 0);
        out.at[pole / 2] = pole % 2 ? 1 : -1;
    }
    return rt_add_scaledd(rt_widen(sphere->center), out, (double)sphere->radius);
}

/* For a tree: a corner or an edge point of the box of one of its solids, or where a random line meets the
 * tree. */
static RtVec3d point_of_csg(Generator *m, uint32_t id, Where where) {
    const RtGeometry *g = m->geometry;
    const RtCsg *tree = &g->csgs[rt_ref_index(g->objects[id])];
    if (where == ON_SURFACE) {
        RtRay ray = rt_random_chord(&tree->box, &m->random);
        RtPreparedRay prepared = rt_ray_prepare(&ray, &tree->box);
        prepared.crossings = rt_query_hit_memory(m->query);
        float t;
        if (rt_object_hit(g, id, &prepared, &t, NULL)) return rt_ray_point(&ray, t);
    }
    const RtBox *box = &g->forest.set.solids[tree->first_solid + below(m, tree->solid_count)].box;
    if (!rt_finite(box->lo) || !rt_finite(box->hi)) box = &tree->box;
    RtVec3d p = point_in_box(m, box);
    uint32_t along = where == AT_VERTEX ? 3 : below(m, 3);
    for (uint32_t a = 0; a < 3; a++) {
        if (a != along) p.at[a] = (double)(below(m, 2) ? box->hi : box->lo).at[a];
    }
    return p;
}

static RtVec3d point_of_object(Generator *m, Where where, uint32_t *id);

static RtVec3d point_of_instance(Generator *m, const RtInstance *instance, Where where) {
    const RtGeometry *outside = m->geometry;
    uint32_t id;
    m->geometry = instance->geometry;
    const RtVec3d inside = point_of_object(m, where, &id);
    if (!m->part) {
        m->part = m->geometry;
        m->object = id;
        m->inside = inside;
        m->to_world = rt_transform_identity();
    }
    m->to_world = rt_transform_compose(&m->to_world, &instance->to_world);
    m->geometry = outside;
    return rt_transform_pointd(&instance->to_world, inside);
}

/* A point of a random object, and its id (RT_NO_OBJECT if there is none). */
static RtVec3d point_of_object(Generator *m, Where where, uint32_t *id) {
    const RtGeometry *g = m->geometry;
    m->part = NULL;
    *id = RT_NO_OBJECT;
    if (g->object_count == 0) return point_in_scene(m);
    *id = below(m, g->object_count);
    uint32_t index = rt_ref_index(g->objects[*id]);
    switch (rt_ref_shape(g->objects[*id])) {
    case RT_SHAPE_SPHERE: return point_of_sphere(m, &g->spheres[index], where);
    case RT_SHAPE_TRIANGLE: return point_of_vertices(m, g->triangles[index].v, 3, where);
    case RT_SHAPE_POLYGON:
        return point_of_vertices(m, rt_polygon_vertices(g, index), g->polygons[index].count, where);
    case RT_SHAPE_CONE: return point_of_cone(m, &g->cones[index], where != ON_SURFACE);
    case RT_SHAPE_CSG: return point_of_csg(m, *id, where);
    case RT_SHAPE_INSTANCE: return point_of_instance(m, &g->instances[index], where);
    case RT_SHAPE_COUNT: break;
    }
    return point_in_scene(m);
}

/* ---- rays ---- */

static RtVec3d some_point(Generator *m, Where where) {
    uint32_t id;
    return point_of_object(m, where, &id);
}

static RtRay ray_along(RtVec3d from, RtVec3d dir) {
    return (RtRay){.org = rt_narrow(from), .dir = rt_narrow(dir), .tmax = INFINITY, .kind = RT_RAY_RANDOM};
}

/* From a random point around or inside the scene through `target`. */
static RtRay ray_through(Generator *m, RtVec3d target) {
    RtVec3d from = below(m, 2) ? point_in_scene(m) : rt_add_scaledd(m->center, direction(m), 2 * m->size);
    return (RtRay){.org = rt_narrow(from),
                   .dir = rt_sub(rt_narrow(target), rt_narrow(from)),
                   .tmax = INFINITY,
                   .kind = RT_RAY_RANDOM};
}

/* ---- the families ---- */

static RtRay chord(Generator *m) {
    return rt_random_chord(&m->geometry->box, &m->random);
}

/* Parallel to an axis; the other components are +0 or -0. */
static RtRay along_axis(Generator *m) {
    RtVec3d p = point_in_scene(m), dir;
    int axis = (int)below(m, 3);
    for (int a = 0; a < 3; a++) dir.at[a] = below(m, 2) ? 0.0 : -0.0;
    dir.at[axis] = below(m, 2) ? 1 : -1;
    if (below(m, 2)) p.at[axis] = m->center.at[axis] - 2 * m->size * dir.at[axis];
    return ray_along(p, dir);
}

/* From points at simple fractions of a box in simple directions: through its corners, edges and midpoints,
 * and through the corners of a grid's voxels. */
static RtRay on_fractions(Generator *m) {
    const RtBox *box = some_box(m);
    RtVec3d from, to;
    for (int a = 0; a < 3; a++) {
        double lo = (double)box->lo.at[a], hi = (double)box->hi.at[a];
        from.at[a] = lo + (hi - lo) * ((double)below(m, 17) - 4) / 8;
        to.at[a] = lo + (hi - lo) * (double)below(m, 9) / 8;
    }
    RtVec3 dir = rt_sub(rt_narrow(to), rt_narrow(from));
    RtRay ray = ray_along(from, rt_vec3d(1, -1, 1));
    if (dir.x != 0 || dir.y != 0 || dir.z != 0) ray.dir = dir;
    return ray;
}

static RtRay from_surface(Generator *m) {
    RtVec3d p = some_point(m, ON_SURFACE);
    return ray_along(p, direction(m));
}

/* From a point on a face of a box, within the face or away from it. */
static RtRay from_box_face(Generator *m) {
    const RtBox *box = some_box(m);
    RtVec3d p = point_in_box(m, box), dir = direction(m);
    int axis = (int)below(m, 3);
    p.at[axis] = (double)(below(m, 2) ? box->hi : box->lo).at[axis];
    if (below(m, 2)) dir.at[axis] = below(m, 2) ? 0.0 : -0.0;
    if (dir.x == 0 && dir.y == 0 && dir.z == 0) dir.at[axis] = 1;
    return ray_along(p, dir);
}

/* Some end where they begin. */
static RtRay from_inside(Generator *m) {
    const RtBox *box = some_box(m);
    RtVec3d p = below(m, 2) ? rt_widen(rt_box_center(*box)) : point_in_box(m, box);
    RtRay ray = ray_along(p, direction(m));
    if (below(m, 16) == 0) ray.tmax = 0;
    return ray;
}

static RtRay at_vertex(Generator *m) {
    return ray_through(m, some_point(m, AT_VERTEX));
}

static RtRay at_edge(Generator *m) {
    return ray_through(m, some_point(m, ON_EDGE));
}

/* A random direction along the surface of an object at p, and its normal there; without an object just a
 * direction, and 0. */
static RtVec3d direction_along(Generator *m, uint32_t id, RtVec3d p, RtVec3d *normal) {
    RtVec3d dir = direction(m);
    *normal = rt_vec3d(0, 0, 0);
    if (id == RT_NO_OBJECT) return dir;
    const RtGeometry *g = m->part ? m->part : m->geometry;
    RtRay at = ray_along(m->part ? m->inside : p, dir);
    *normal = rt_object_normals(g, m->part ? m->object : id, &at, 0, rt_query_hit_memory(m->query)).geometric;
    if (m->part) *normal = rt_normalized(rt_transform_normald(&m->to_world, *normal));
    return rt_add_scaledd(dir, *normal, -rt_dotd(dir, *normal));
}

/* Touches an object: in the plane of a flat one, along the silhouette of a round one. */
static RtRay tangent(Generator *m) {
    uint32_t id;
    RtVec3d normal, p = point_of_object(m, below(m, 2) ? ON_SURFACE : AT_VERTEX, &id);
    RtVec3d dir = direction_along(m, id, p, &normal);
    return ray_along(rt_add_scaledd(p, dir, -m->size), dir);
}

/* From a distance of 10^3 to 10^7 scene sizes. */
static RtRay from_afar(Generator *m) {
    static const double sizes[] = {1e3, 1e4, 1e5, 1e6, 1e7};
    double distance = m->size * sizes[below(m, 5)];
    RtVec3d from = rt_add_scaledd(m->center, direction(m), distance);
    RtVec3d to = below(m, 2) ? point_in_scene(m) : some_point(m, ON_SURFACE);
    return ray_along(from, rt_normalized(rt_subd(to, from)));
}

/* A direction length between 1e-15 and 3e38, or one so great that float32 has few numbers for t within the
 * scene: boxes are entered and left at the same t, or at 0. */
static RtRay of_any_length(Generator *m) {
    static const double lengths[] = {1e-15, 1e-12, 1e-10, 1e-7, 1e-5, 1e-2, 1e2,
                                     1e5,   1e10,  1e15,  1e30, 1e37, 1e38, 3e38};
    RtRay ray = below(m, 2) ? chord(m) : at_vertex(m);
    double length = lengths[below(m, sizeof lengths / sizeof lengths[0])];
    if (below(m, 4) == 0) length = fmin(m->size * 0x1p149 / (1 << below(m, 12)), 3e38);
    ray.dir = rt_narrow(rt_scaled(rt_normalized(rt_widen(ray.dir)), length));
    return ray;
}

/* Starts or ends exactly at a hit, or one float beside it. */
static RtRay ends_at_hit(Generator *m) {
    uint32_t kind = below(m, 5);
    RtRay ray = kind < 2 ? chord(m) : kind < 4 ? at_vertex(m) : of_any_length(m);
    RtHit hit = RT_MISS;
    if (rt_ray_is_valid(&ray)) rt_nearest(m->query, &ray, 1, &hit, NULL);
    if (hit.object == RT_NO_OBJECT) return ray;
    float t = hit.t;
    uint32_t side = below(m, 3);
    if (side == 1) t = nextafterf(t, INFINITY);
    if (side == 2) t = rt_maxf(0, nextafterf(t, -INFINITY));
    uint32_t which = below(m, 3);
    if (which != 0) ray.tmin = t;
    if (which != 1) ray.tmax = t;
    return ray;
}

/* Starts clearly behind some hits of its line, often the last; may end clearly before the next. */
static RtRay past_hits(Generator *m) {
    static const float steps[] = {0x1p-10f, 0x1p-6f, 0x1p-3f, 0.5f};
    RtRay ray = below(m, 2) ? chord(m) : at_vertex(m);
    for (uint32_t left = 1 + below(m, 8); left > 0 && rt_ray_is_valid(&ray); left--) {
        RtHit hit;
        rt_nearest(m->query, &ray, 1, &hit, NULL);
        if (hit.object == RT_NO_OBJECT) return ray;
        const float step = steps[below(m, sizeof steps / sizeof steps[0])];
        if (left == 1 && below(m, 2))
            ray.tmax = hit.t * (1 - step);
        else
            ray.tmin = hit.t * (1 + step);
    }
    return ray;
}

/* A random direction, or one along an axis or diagonal, with components 0 or +-1. */
static RtVec3d free_direction(Generator *m) {
    if (below(m, 2)) return direction(m);
    RtVec3d dir;
    for (int a = 0; a < 3; a++) dir.at[a] = (double)below(m, 3) - 1;
    if (dir.x == 0 && dir.y == 0 && dir.z == 0) dir.at[below(m, 3)] = 1;
    return dir;
}

/* A voxel plane of a grid over the scene or a box, computed in float32 or rounded from double. */
static double voxel_plane(Generator *m, const RtBox *box, int axis, uint32_t voxels) {
    float lo = box->lo.at[axis], hi = box->hi.at[axis];
    uint32_t i = below(m, voxels + 1);
    if (below(m, 2)) return (double)(lo + (hi - lo) / (float)voxels * (float)i);
    return (double)lo + ((double)hi - (double)lo) * i / voxels;
}

static uint32_t some_resolution(Generator *m) {
    return below(m, 2) ? 1U << below(m, 7) : 1 + below(m, 50);
}

/* From a corner or an edge of a voxel. */
static RtRay from_voxel_corner(Generator *m) {
    const RtBox *box = below(m, 2) ? &m->geometry->box : some_box(m);
    if (m->geometry->object_count == 0) box = some_box(m);
    RtVec3d p = point_in_box(m, box);
    uint32_t voxels = some_resolution(m), along = below(m, 6);
    for (int a = 0; a < 3; a++) {
        if (a != (int)along) p.at[a] = voxel_plane(m, box, a, voxels);
    }
    return ray_along(p, free_direction(m));
}

/* Within a plane of voxels or a face of a box, from inside or outside. */
static RtRay in_plane(Generator *m) {
    const RtBox *box = some_box(m);
    int axis = (int)below(m, 3);
    RtVec3d p = point_in_box(m, box), dir = free_direction(m);
    p.at[axis] = voxel_plane(m, box, axis, below(m, 2) ? 1 : some_resolution(m));
    dir.at[axis] = below(m, 2) ? 0.0 : -0.0;
    if (dir.x == 0 && dir.y == 0 && dir.z == 0) dir.at[(axis + 1) % 3] = -1;
    if (below(m, 2)) p = rt_add_scaledd(p, dir, -2 * m->size);
    return ray_along(p, dir);
}

/* Along an edge, perhaps in instances: from a vertex, before it, or between two. */
static RtRay along_edge(Generator *m) {
    const RtGeometry *g = m->geometry;
    RtTransform to_world = rt_transform_identity();
    while (g->instance_count > 0 && (g->triangle_count + g->polygon_count == 0 || below(m, 4))) {
        const RtInstance *instance = &g->instances[below(m, g->instance_count)];
        to_world = rt_transform_compose(&instance->to_world, &to_world);
        g = instance->geometry;
    }
    if (g->triangle_count + g->polygon_count == 0) return along_axis(m);
    uint32_t i = below(m, g->triangle_count + g->polygon_count), count = 3;
    const RtVec3 *v;
    if (i < g->triangle_count) {
        v = g->triangles[i].v;
    } else {
        const RtPolygon *polygon = &g->polygons[i - g->triangle_count];
        v = g->polygon_vertices + polygon->first;
        count = polygon->count;
    }
    uint32_t first = below(m, count);
    const RtVec3d at = rt_transform_pointd(&to_world, rt_widen(v[first])),
                  next = rt_transform_pointd(&to_world, rt_widen(v[(first + 1) % count])),
                  dir = rt_widen(rt_sub(rt_narrow(next), rt_narrow(at)));
    static const double starts[] = {0, -1, -4, 0.5, 1};
    return ray_along(rt_add_scaledd(rt_widen(rt_narrow(at)), dir, starts[below(m, 5)]), dir);
}

/* Nearly parallel to a flat object or to the silhouette of a round one, by an angle of 1e-2 to 1e-8. */
static RtRay grazing(Generator *m) {
    static const double angles[] = {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8};
    uint32_t id;
    RtVec3d normal, p = point_of_object(m, ON_SURFACE, &id), dir = direction_along(m, id, p, &normal);
    if (id != RT_NO_OBJECT) {
        double angle = angles[below(m, 7)];
        dir = rt_add_scaledd(rt_normalized(dir), normal, below(m, 2) ? angle : -angle);
    }
    return ray_along(rt_add_scaledd(p, dir, -m->size * between(m, 0, 2)), dir);
}

/* Components that are denormal, the smallest normal number, 0 or -0, beside a regular one. */
static RtRay denormal(Generator *m) {
    static const float tiny[] = {0x1p-149f, -0x1p-149f, 0x1p-140f, -0x1p-130f, 0x1p-127f,
                                 0x1p-126f, -0x1p-126f, 0.0f,      -0.0f};
    RtRay ray = along_axis(m);
    if (below(m, 2)) {
        RtVec3d from = some_point(m, AT_VERTEX);
        ray = ray_along(from, free_direction(m));
    }
    int whole = (int)below(m, 3);
    for (int a = 0; a < 3; a++) {
        if (a != whole) ray.dir.at[a] = tiny[below(m, sizeof tiny / sizeof tiny[0])];
    }
    if (ray.dir.at[whole] == 0) ray.dir.at[whole] = 1;
    if (below(m, 2)) ray.org.at[whole] -= 2 * (float)m->size * ray.dir.at[whole];
    return ray;
}

/* A shadow ray, exactly or nearly as the renderer generates them: off a surface, on it, at an edge, or
 * from anywhere around; some with a wrong light, another tmax, or a slightly wrong direction. */
static RtRay to_light(Generator *m) {
    if (m->scene->light_count == 0) return chord(m);
    uint32_t light = below(m, m->scene->light_count);
    RtVec3d to = rt_widen(m->scene->lights[light].position), from;
    switch (below(m, 5)) {
    case 0: from = some_point(m, ON_SURFACE); break;
    case 1: from = some_point(m, ON_EDGE); break;
    case 2: from = point_in_scene(m); break;
    case 3: /* far away, past an edge, or behind the light */
        from = some_point(m, ON_EDGE);
        from = rt_add_scaledd(to, rt_subd(to, from), below(m, 2) ? 1 : -between(m, 1, 1e4));
        break;
    default: from = rt_add_scaledd(m->center, direction(m), 2 * m->size);
    }
    if (below(m, 2)) from = rt_add_scaledd(from, rt_subd(to, from), between(m, 0, 1e-4));
    RtRay ray = {.org = rt_narrow(from), .tmax = 1, .kind = RT_RAY_SHADOW, .source = light};
    ray.dir = rt_sub(m->scene->lights[light].position, ray.org);
    switch (below(m, 16)) {
    case 0: ray.source = below(m, m->scene->light_count + 2); break;
    case 1: ray.tmax = (float)between(m, 0, 2); break;
    case 2: ray.dir.at[below(m, 3)] *= 1 + 0x1p-20f; break;
    case 3: ray.tmax = INFINITY; break;
    default: break;
    }
    return ray;
}

/* A primary ray, exactly or nearly: some with the index of another sample, or not quite through their
 * sample. */
static RtRay through_sample(Generator *m) {
    const RtSampling *s = &m->scene->sampling;
    if (m->view.sampling.columns == 0) return chord(m);
    /* Not as arguments, whose order of evaluation C leaves open. */
    uint32_t row = below(m, s->rows), column = below(m, s->columns);
    RtRay ray = rt_view_ray(&m->view, column, row);
    switch (below(m, 16)) {
    case 0: ray.source = below(m, s->columns * s->rows + 2); break;
    case 1: ray.tmax = (float)between(m, 0, 2 * m->size); break;
    case 2: ray.dir.at[below(m, 3)] *= 1 + 0x1p-20f; break;
    case 3: ray.org.at[below(m, 3)] += (float)m->size * 0x1p-10f; break;
    default: break;
    }
    return ray;
}

/* One of a bundle of nearly equal rays: with a common origin, side by side, or both. In some bundles the
 * two largest components of dir are nearly equal. */
static RtRay in_bundle(Generator *m) {
    static const double sizes[] = {1e-7, 1e-4, 1e-2, 0.05};
    RtRandom own = m->random;
    m->random = m->shared;
    RtRay lead = below(m, 2) ? chord(m) : at_vertex(m);
    RtVec3d from = rt_widen(lead.org), dir = rt_normalized(rt_widen(lead.dir));
    double jitter = sizes[below(m, 4)];
    uint32_t how = below(m, 3);
    int major = rt_major_axis(lead.dir), other = (major + 1) % 3;
    bool diagonal = below(m, 4) == 0;
    m->random = own;
    if (how != 0) from = rt_add_scaledd(from, direction(m), jitter * m->size);
    if (how != 1) dir = rt_add_scaledd(dir, direction(m), jitter / 2);
    if (diagonal) dir.at[other] = copysign(dir.at[major] * (below(m, 2) ? 1 : 1 + 1e-6), dir.at[other]);
    return ray_along(from, dir);
}

static const struct {
    const char *name;
    RtRay (*make)(Generator *maker);
} families[] = {
    {"chord", chord},
    {"along-axis", along_axis},
    {"on-fractions", on_fractions},
    {"from-surface", from_surface},
    {"from-box-face", from_box_face},
    {"from-inside", from_inside},
    {"at-vertex", at_vertex},
    {"at-edge", at_edge},
    {"tangent", tangent},
    {"from-afar", from_afar},
    {"ends-at-hit", ends_at_hit},
    {"of-any-length", of_any_length},
    {"to-light", to_light},
    {"through-sample", through_sample},
    {"from-voxel-corner", from_voxel_corner},
    {"in-plane", in_plane},
    {"along-edge", along_edge},
    {"grazing", grazing},
    {"denormal", denormal},
    {"in-bundle", in_bundle},
    {"past-hits", past_hits},
};

size_t rt_ray_family_count(void) {
    return sizeof families / sizeof families[0];
}

const char *rt_ray_family_name(size_t family) {
    return families[family].name;
}

void rt_ray_family_fill(size_t family, RtQuery *query, uint64_t seed, uint64_t first, size_t count,
                        RtRay *rays) {
    Generator maker = {
        .query = query, .scene = query->accel->scene, .geometry = &query->accel->scene->geometry, .size = 1};
    rt_view_init(&maker.view, &maker.scene->camera, maker.scene->sampling, NULL);
    if (maker.geometry->object_count > 0) {
        const RtBox *box = &maker.geometry->box;
        maker.center = rt_widen(rt_box_center(*box));
        maker.size = rt_lengthd(rt_subd(rt_widen(box->hi), maker.center));
    }
    for (size_t i = 0; i < count; i++) {
        maker.random = rt_random(seed, (uint64_t)family << 56 | (first + i));
        maker.shared =
            rt_random(seed, (uint64_t)family << 56 | UINT64_C(1) << 55 | (first + i) / RT_RAY_BUNDLE);
        rays[i] = families[family].make(&maker);
        /* The target may equal the origin, or the direction may round to zero. */
        if (!rt_ray_is_valid(&rays[i])) rays[i] = chord(&maker);
        assert(rt_ray_is_valid(&rays[i]));
    }
}

/* ---- the rays of a scene ---- */

/* The levels of the camera's frame, and the share of its rays: one in CAMERA_PART. */
enum { FRAME_DEPTH = 4, CAMERA_PART = 10 };

/* At most half of the camera's rays are primary ones, in the shape of its image. */
static RtStatus sample(const RtVerifyRays *wanted, RtScene *scene, RtError *error) {
    if (wanted->given) return RT_OK;
    uint64_t primary = wanted->count / (UINT64_C(2) * CAMERA_PART);
    double samples = (double)primary;
    double aspect = (double)scene->camera.width / (double)scene->camera.height;
    double width = fmin(fmax(sqrt(samples * aspect), 1), RT_MAX_IMAGE_SIDE);
    double height = fmin(fmax(width / aspect, 1), RT_MAX_IMAGE_SIDE);
    return rt_scene_sample(scene, (uint32_t)width, (uint32_t)height, 1, false, error);
}

/* Appends an equal share of each kind of ray in the camera's frame, evenly spread over it. */
static RtStatus append_camera_rays(const RtVerifyRays *wanted, const RtAccel *oracle, RtRay *rays,
                                   uint64_t *count, RtError *error) {
    RtRecording recording = {.depth = FRAME_DEPTH, .seed = wanted->seed, .threads = wanted->threads};
    RtRaySet sets[RT_RAY_KIND_COUNT];
    RT_TRY(rt_rayset_record(sets, oracle, &recording, error));
    uint64_t kinds = 0;
    for (int kind = 0; kind < RT_RAY_RANDOM; kind++) kinds += sets[kind].count > 0;
    RtStatus status = RT_OK;
    for (int kind = 0; kind < RT_RAY_RANDOM && status == RT_OK; kind++) {
        RtRaySet thin;
        const uint64_t limit = sets[kind].count > 0 ? wanted->count / CAMERA_PART / kinds : 0;
        if (limit == 0) continue;
        status = rt_rayset_limit(&sets[kind], limit, 1, &thin, error);
        if (status != RT_OK) break;
        memcpy(rays + *count, thin.rays, thin.count * sizeof(RtRay));
        *count += thin.count;
        rt_rayset_clear(&thin);
    }
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_rayset_clear(&sets[kind]);
    return status;
}

/* Appends `count` rays of all families, in equal numbers to within one. Families alternate, so that no
 * thread gets all rays of a slow family and neighbouring rays differ. */
static void append_family_rays(RtQuery *query, uint64_t seed, RtRay *rays, uint64_t count) {
    const uint64_t all = rt_ray_family_count();
    uint64_t done = 0;
    for (uint64_t turn = 0; done < count; turn += RT_RAY_BUNDLE) {
        for (uint64_t f = 0; f < all; f++) {
            uint64_t share = count * (f + 1) / all - count * f / all;
            if (share <= turn) continue;
            uint64_t some = share - turn < RT_RAY_BUNDLE ? share - turn : RT_RAY_BUNDLE;
            rt_ray_family_fill((size_t)f, query, seed, turn, (size_t)some, rays + done);
            done += some;
        }
    }
}

/* The families get the rest. */
RtStatus rt_verify_rays(const RtVerifyRays *wanted, const RtAccel *oracle, RtRay *rays, RtError *error) {
    RtQuery query;
    uint64_t count = 0;
    if (wanted->given) {
        memcpy(rays, wanted->given->rays, wanted->count * sizeof(RtRay));
        return RT_OK;
    }
    RT_TRY(append_camera_rays(wanted, oracle, rays, &count, error));
    RT_TRY(rt_query_init(&query, oracle, error));
    append_family_rays(&query, wanted->seed, rays + count, wanted->count - count);
    rt_query_clear(&query);
    return rt_accel_check(oracle, error);
}

RtStatus rt_verify_scene_init(RtVerifyScene *scene, const RtScene *from, const RtVerifyRays *wanted,
                              RtError *error) {
    *scene = (RtVerifyScene){.scene = *from};
    RT_TRY(sample(wanted, &scene->scene, error));
    RT_TRY(rt_accel_open_on(rt_accel_truth(), &scene->scene, wanted->threads, &scene->truth, error));
    scene->rays = rt_alloc(wanted->count, sizeof(RtRay));
    if (!scene->rays) return rt_fail_memory(error, "rays", wanted->count * sizeof(RtRay));
    return rt_verify_rays(wanted, scene->truth, scene->rays, error);
}

void rt_verify_scene_clear(RtVerifyScene *scene) {
    rt_reference_clear(&scene->reference);
    rt_free(scene->rays);
    rt_accel_destroy(scene->truth);
    *scene = (RtVerifyScene){0};
}
