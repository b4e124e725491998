/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/precision.h"

#include "random_testing.h"

#include "core/base/memory.h"
#include "exact/border.h"
#include "exact/lattice.h"

#include <stdlib.h>

typedef enum Aim { AIM_BOX, AIM_GRAZING, AIM_BORDER, AIM_LATTICE, AIM_LEAVING } Aim;

typedef struct Case {
    const char *name, *meaning;
    Aim aim;
    int scale;    /* of all coordinates, as a power of two */
    int distance; /* of the origin, as a power of ten in sizes of an object */
    int stretch;  /* dir gets 2^-stretch..2^stretch times as long */
} Case;

static const Case cases[] = {
    {"ordinary", "towards a point of the object's box, from 3 sizes away", AIM_BOX, 0, 0, 0},
    {"grazing", "through a point of the surface, at an angle of 2^-1 to 2^-24 with it", AIM_GRAZING, 0, 0, 0},
    {"border", "at vertices, edges, circles, and along tangents", AIM_BORDER, 0, 0, 0},
    {"far", "from 3,000 sizes away", AIM_BOX, 0, 3, 0},
    {"farther", "from 300,000 sizes away", AIM_BOX, 0, 5, 0},
    {"tiny", "all coordinates times 2^-70", AIM_BOX, -70, 0, 0},
    {"huge", "all coordinates times 2^50", AIM_BOX, 50, 0, 0},
    {"lengths", "directions 2^-50 to 2^50 times as long", AIM_BOX, 0, 0, 50},
    {"lattice",
     "objects of small integers; from integer points along integer directions, through vertices, "
     "middles of edges, rims, and points of tangents",
     AIM_LATTICE, 0, 0, 0},
    {"leaving", "from a point of the surface, rounded, in any direction", AIM_LEAVING, 0, 0, 0},
};

const char *rt_subject_name(RtSubject subject) {
    static const char *const names[RT_SUBJECT_COUNT] = {
#define RT_SUBJECT_NAME(CONSTANT, name) #name,
        RT_SUBJECTS(RT_SUBJECT_NAME)
#undef RT_SUBJECT_NAME
    };
    return names[subject];
}

size_t rt_precision_case_count(void) {
    return sizeof cases / sizeof cases[0];
}

const char *rt_precision_case_name(size_t index) {
    return cases[index].name;
}

const char *rt_precision_case_meaning(size_t index) {
    return cases[index].meaning;
}

/* ---- objects ---- */

enum { OBJECTS = 40 };

/* Corners of a regular pentagon in a random plane, rounded: they lie in no plane. */
static RtStatus add_pentagon(RtGeometry *g, RtRandom *random, float scale, RtError *error) {
    static const double corners[5][2] = {
        {1, 0}, {0.30902, 0.95106}, {-0.80902, 0.58779}, {-0.80902, -0.58779}, {0.30902, -0.95106}};
    RtVec3d center = rt_widen(rt_random_point(random, 1)), u = rt_random_direction(random);
    RtVec3d v = rt_normalized(rt_crossd(u, rt_random_direction(random)));
    RtVec3 vertices[5];
    for (int i = 0; i < 5; i++) {
        RtVec3d corner = rt_add_scaledd(rt_add_scaledd(center, u, corners[i][0]), v, corners[i][1]);
        vertices[i] = rt_scale(rt_narrow(corner), scale);
    }
    return rt_geometry_add_polygon(g, vertices, 5, error);
}

/* An octahedron about three axes at right angles; with a dent its lower tip is above the middle. */
static RtStatus add_octahedron(RtCsgBuilder *b, RtRandom *random, RtVec3 center, float size, uint32_t *solid,
                               RtError *error) {
    RtVec3 tips[3][2];
    RtVec3d axes[3] = {rt_random_direction(random)};
    axes[1] = rt_normalized(rt_crossd(axes[0], rt_random_direction(random)));
    axes[2] = rt_crossd(axes[0], axes[1]);
    double lower = rt_random_below(random, 2) ? -1 : 0.25;
    for (int a = 0; a < 3; a++) {
        for (int side = 0; side < 2; side++) {
            double height = (double)size * (side == 0 ? 1 : a == 2 ? lower : -1);
            tips[a][side] = rt_narrow(rt_add_scaledd(rt_widen(center), axes[a], height));
        }
    }
    RtTriangle triangles[8];
    for (int i = 0; i < 8; i++) {
        int x = i & 1, y = i >> 1 & 1, z = i >> 2;
        bool turned = (x ^ y ^ z) != 0;
        RtVec3 second = tips[1][y], third = tips[2][z];
        triangles[i] = (RtTriangle){{tips[0][x], turned ? third : second, turned ? second : third}};
    }
    RtTransform still = rt_transform_identity();
    return rt_solid_add_mesh(&b->set, triangles, 8, &still, solid, error);
}

/* (a ball or a box), an octahedron or a ring, without a frustum that is long enough to pass through. */
static RtStatus make_tree(RtCsgBuilder *b, RtSubject subject, RtRandom *random, float scale, RtCsgTerm *root,
                          RtError *error) {
    uint32_t solid;
    RtCsgTerm drill, other;
    RtVec3 center = rt_scale(rt_random_point(random, 1), scale),
           lo = rt_scale(rt_random_point(random, 1), scale);
    float size = rt_random_between(random, 0.5f, 1) * scale,
          thick = rt_random_between(random, 0.1f, 0.4f) * scale;
    RtVec3 end = rt_scale(rt_random_point(random, 1), scale), far = rt_sub(rt_scale(center, 2), end);
    RtVec3 hi = rt_add(lo, rt_vec3(size, size, thick));
    RT_TRY(rt_solid_add_frustum(&b->set, end, thick, far, thick / 2, &solid, error));
    RT_TRY(rt_csg_solid(b, solid, 0, &drill, error));
    if (subject == RT_SUBJECT_MESH) {
        RT_TRY(add_octahedron(b, random, center, size, &solid, error));
        RT_TRY(rt_csg_solid(b, solid, 0, root, error));
    } else if (subject == RT_SUBJECT_TORUS) {
        RtVec3 axis = rt_narrow(rt_random_direction(random));
        RT_TRY(rt_solid_add_ring(&b->set, center, axis, size, thick, &solid, error));
        RT_TRY(rt_csg_solid(b, solid, 0, root, error));
    } else {
        RT_TRY(rt_solid_add_ellipsoid(&b->set, center, rt_vec3(size, size, size), &solid, error));
        RT_TRY(rt_csg_solid(b, solid, 0, root, error));
        RT_TRY(rt_solid_add_box(&b->set, lo, hi, &solid, error));
        RT_TRY(rt_csg_solid(b, solid, 0, &other, error));
        RT_TRY(rt_csg_combine(b, RT_CSG_UNION, *root, other, root, error));
    }
    return rt_csg_combine(b, RT_CSG_DIFFERENCE, *root, drill, root, error);
}

static RtStatus add_tree(RtGeometry *g, RtSubject subject, RtRandom *random, float scale, RtError *error) {
    RtCsgBuilder b = {0};
    RtCsgTerm root;
    RtStatus status = make_tree(&b, subject, random, scale, &root, error);
    if (status == RT_OK) status = rt_geometry_add_csg(g, &b, root, true, error);
    rt_csg_builder_clear(&b);
    return status;
}

static RtStatus add_object(RtGeometry *g, RtSubject subject, RtRandom *random, float scale, RtError *error) {
    if (subject == RT_SUBJECT_POLYGON) return add_pentagon(g, random, scale, error);
    if (subject >= RT_SUBJECT_CSG) return add_tree(g, subject, random, scale, error);
    RtVec3 v[3];
    for (int i = 0; i < 3; i++) v[i] = rt_scale(rt_random_point(random, 1), scale);
    float radius = rt_random_between(random, 0.1f, 1) * scale, other = rt_random_unit(random) * scale;
    if (subject == RT_SUBJECT_SPHERE) return rt_geometry_add_sphere(g, v[0], radius, error);
    if (subject == RT_SUBJECT_CONE) return rt_geometry_add_cone(g, v[0], radius, v[1], other, error);
    return rt_geometry_add_triangle(g, v, NULL, error);
}

/* Without a `lattice`, objects of random numbers. */
static RtStatus add_objects(RtGeometry *g, RtSubject subject, RtRandom *random, float scale,
                            RtLattice *lattice, RtError *error) {
    for (uint32_t i = 0; i < OBJECTS; i++)
        RT_TRY(lattice ? rt_lattice_add(&lattice[i], g, subject, random, error)
                       : add_object(g, subject, random, scale, error));
    return rt_geometry_finish(g, error);
}

/* ---- rays ---- */

typedef struct Range {
    RtSubject subject;
    const RtGeometry *geometry;
    const Case *how;
    RtRandom random;
    double distance;       /* of origins */
    RtCrossing *crossings; /* of hit functions */
    RtLattice lattice[OBJECTS];
} Range;

/* The ray towards `target` along `dir`, unit, as near as float32 can. */
static RtRay ray_towards(Range *r, RtVec3 target, RtVec3d dir) {
    RtRay ray = {.tmax = INFINITY, .kind = RT_RAY_RANDOM};
    ray.org = rt_narrow(rt_add_scaledd(rt_widen(target), dir, -r->distance));
    ray.dir = rt_sub(target, ray.org);
    if (r->how->stretch > 0) {
        int span = 2 * r->how->stretch + 1;
        int by = (int)rt_random_below(&r->random, (uint32_t)span) - r->how->stretch;
        ray.dir = rt_scale(ray.dir, ldexpf(1, by));
    }
    return ray;
}

static RtRay ray_to_box(Range *r, uint32_t id) {
    const RtBox *box = &r->geometry->boxes[id];
    RtVec3 target;
    for (int a = 0; a < 3; a++) target.at[a] = rt_random_between(&r->random, box->lo.at[a], box->hi.at[a]);
    return ray_towards(r, target, rt_random_direction(&r->random));
}

/* Through a point of the surface that an ordinary ray hits, by an angle with it; one of 0 makes a tangent. */
static RtRay ray_along_surface(Range *r, uint32_t id, double angle) {
    RtRay ray = ray_to_box(r, id);
    RtDecision decision = rt_decision_of(r->geometry, id, &ray, r->crossings);
    if (!decision.hit) return ray;
    RtVec3d normal = rt_object_normals(r->geometry, id, &ray, decision.t, r->crossings).geometric;
    RtVec3d tangent = rt_normalized(rt_crossd(normal, rt_random_direction(&r->random)));
    RtVec3 point = rt_narrow(rt_ray_point(&ray, decision.t));
    return ray_towards(r, point, rt_normalized(rt_add_scaledd(tangent, normal, angle)));
}

/* A vertex, or a point between two. */
static RtVec3 point_on_edge(RtRandom *random, const RtVec3 *vertices, uint32_t count) {
    uint32_t i = rt_random_below(random, count);
    RtVec3 a = vertices[i], b = vertices[(i + 1) % count];
    float part = rt_random_below(random, 2) ? 0 : rt_random_unit(random);
    return rt_add(a, rt_scale(rt_sub(b, a), part));
}

/* A triangle of the tree's mesh. */
static const RtTriangle *random_facet(Range *r, const RtCsg *tree) {
    const RtSolidSet *set = &r->geometry->forest.set;
    const RtSolid *solid = &set->solids[tree->first_solid];
    while (solid->kind != RT_SOLID_MESH) solid++;
    return &set->triangles[solid->first + rt_random_below(&r->random, solid->count)];
}

static RtRay ray_to_border(Range *r, uint32_t id) {
    const RtGeometry *g = r->geometry;
    uint32_t index = rt_ref_index(g->objects[id]);
    RtShape shape = rt_ref_shape(g->objects[id]);
    RtVec3d dir = rt_random_direction(&r->random);
    if (shape == RT_SHAPE_TRIANGLE)
        return ray_towards(r, point_on_edge(&r->random, g->triangles[index].v, 3), dir);
    if (shape == RT_SHAPE_POLYGON) {
        const RtPolygon *p = &g->polygons[index];
        return ray_towards(r, point_on_edge(&r->random, g->polygon_vertices + p->first, p->count), dir);
    }
    if (shape == RT_SHAPE_CONE && rt_random_below(&r->random, 2)) {
        const RtCone *c = &g->cones[index];
        RtVec3d out = rt_normalized(rt_crossd(c->axis, rt_random_direction(&r->random)));
        RtVec3d on = rt_add_scaledd(rt_widen(c->base), out, (double)c->base_radius);
        return ray_towards(r, rt_narrow(on), dir);
    }
    if (r->subject == RT_SUBJECT_MESH)
        return ray_towards(r, point_on_edge(&r->random, random_facet(r, &g->csgs[index])->v, 3), dir);
    return ray_along_surface(r, id, 0);
}

/* From where an ordinary ray hits the object, if it does. */
static RtRay ray_from_surface(Range *r, uint32_t id) {
    RtRay ray = ray_to_box(r, id);
    RtDecision decision = rt_decision_of(r->geometry, id, &ray, r->crossings);
    if (!decision.hit) return ray;
    ray.org = rt_narrow(rt_ray_point(&ray, decision.t));
    ray.dir = rt_narrow(rt_random_direction(&r->random));
    return ray;
}

static RtRay next_ray(Range *r, uint32_t id) {
    if (r->how->aim == AIM_LATTICE) return rt_lattice_ray(&r->lattice[id], &r->random);
    if (r->how->aim == AIM_LEAVING) return ray_from_surface(r, id);
    if (r->how->aim == AIM_BOX) return ray_to_box(r, id);
    if (r->how->aim == AIM_BORDER) return ray_to_border(r, id);
    return ray_along_surface(r, id, ldexp(1, -1 - (int)(rt_random_below(&r->random, 24))));
}

/* ---- measuring ---- */

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* How far from the surface a hit is that is `error` off along the ray, in units: an error along the surface
 * is none. */
static double off_surface(const Range *r, uint32_t id, const RtRay *ray, float t, double error) {
    const RtGeometry *g = r->geometry;
    RtWideRay line = rt_wide_ray(ray);
    double rate = rt_dotd(rt_object_normals(g, id, ray, t, r->crossings).geometric, line.dir);
    return fabs(error * rate) / rt_border_unit(g, id, &line);
}

/* `errors` has room for one more at out->hits. */
static RtStatus measure_ray(const Range *r, uint32_t id, const RtRay *ray, double *errors, RtPrecision *out,
                            RtError *error) {
    const RtGeometry *g = r->geometry;
    RtDecision ours = rt_decision_of(g, id, ray, r->crossings);
    long double off = 0, ulps = 0;
    RtExactResult exact = rt_referee_error(g, id, ray, ours.hit ? ours.t : 0, &off, &ulps);
    RtWideRay line = rt_wide_ray(ray);
    RtExactResult same = rt_decision_check(g, id, &line, ours);
    if (exact == RT_UNDECIDED || same == RT_UNDECIDED)
        return rt_fail_memory(error, "exact arithmetic on a CSG tree", 0);
    const double size = (double)fabsl(off), rounding = 0.501 * (double)rt_float_ulp((long double)ours.t);
    const double height = same == RT_HIT && exact == RT_HIT ? off_surface(r, id, ray, ours.t, size) : 0;
    if (same == RT_HIT && (height <= 2 || r->subject == RT_SUBJECT_TRIANGLE)) { /* else another crossing */
        if (exact != RT_HIT) return RT_OK;
        out->off = fmax(out->off, height);
        out->excess =
            fmax(out->excess, (size - rounding) * rt_lengthd(line.dir) / rt_border_unit(g, id, &line));
        errors[out->hits++] = (double)fabsl(ulps);
        return RT_OK;
    }
    if (!ours.hit)
        out->missed++;
    else if (exact == RT_MISSED)
        out->invented++;
    else
        out->elsewhere++;
    out->border = fmax(out->border, rt_border_distance(g, id, ray, ours));
    return RT_OK;
}

RtStatus rt_precision_measure(RtSubject subject, size_t index, uint64_t rays, RtPrecision *out,
                              RtError *error) {
    *out = (RtPrecision){.rays = rays};
    float scale = ldexpf(1, cases[index].scale);
    double *errors = rt_alloc(rays, sizeof(double));
    if (!errors) return rt_fail_memory(error, "errors of t", rays * sizeof(double));
    RtGeometry geometry = {0};
    Range range = {.subject = subject,
                   .geometry = &geometry,
                   .how = &cases[index],
                   .random = rt_random(6, (uint64_t)subject)};
    range.distance = 3 * (double)scale;
    for (int i = 0; i < cases[index].distance; i++) range.distance *= 10;
    RtStatus status = add_objects(&geometry, subject, &range.random, scale,
                                  range.how->aim == AIM_LATTICE ? range.lattice : NULL, error);
    if (status == RT_OK) status = rt_crossings_alloc(&geometry, &range.crossings, error);
    for (uint64_t i = 0; i < rays && status == RT_OK; i++) {
        uint32_t id = (uint32_t)(i % geometry.object_count);
        RtRay ray = next_ray(&range, id);
        status = measure_ray(&range, id, &ray, errors, out, error);
    }
    qsort(errors, out->hits, sizeof(double), by_size);
    if (out->hits > 0) {
        out->median = errors[out->hits / 2];
        out->most99 = errors[out->hits * 99 / 100];
        out->most = errors[out->hits - 1];
    }
    rt_free(range.crossings);
    rt_geometry_clear(&geometry);
    rt_free(errors);
    return status;
}
