/* SPDX-License-Identifier: Apache-2.0 */
/* The precision of our hit functions against exact arithmetic (exact/referee.h): rays of several cases are
 * aimed at random objects of one kind; the errors of t, and the decisions that differ. Prints a table and
 * checks that the rows of it in docs/precision.md are the same. */
#include "csg_testing.h"
#include "random_testing.h"
#include "testing.h"

#include "core/base/file.h"
#include "exact/border.h"

#include <stdlib.h>

enum { RAYS = 2000, OBJECTS = 40 };

/* The shapes in their order (core/shape/geometry.h), and trees of one kind of solid: of spheres and boxes; of
 * a mesh, which is an octahedron; and of a torus. */
typedef enum Subject { SPHERE, POLYGON, TRIANGLE, CONE, CSG, MESH, TORUS, SUBJECT_COUNT } Subject;

static const char *const names[SUBJECT_COUNT] = {"sphere", "polygon", "triangle", "cone",
                                                 "csg",    "mesh",    "torus"};

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

enum { CASES = sizeof cases / sizeof cases[0] };

/* For rays that both hit, the errors of t in ulps of float32; for the others, what differed and where. */
typedef struct Precision {
    uint64_t rays, hits;       /* hits: both say so, of the same place */
    double median, most99;     /* of |error|: half, and 99 of 100 hits, are no farther off */
    double most;               /* |error| */
    double off;                /* the farthest that org + t dir was from the surface, in units of border.h */
    double excess;             /* the most that |error| |dir| exceeds 0.501 ulp, in units of border.h */
    uint64_t missed, invented; /* only exact arithmetic, or only the hit function, finds a hit */
    uint64_t elsewhere;        /* both do, at different places of the object */
    double border;             /* the farthest that any of these was from a border, in units of border.h */
} Precision;

/* ---- trees ---- */

/* What a tree consists of: a ball and a box, an octahedron, or a ring; without a frustum that is long enough
 * to pass through. */
typedef struct Parts {
    RtVec3 center, axis, lo, hi; /* of all but the box, of the ring, and of the box */
    RtVec3 tips[3][2];           /* of the octahedron */
    float size, thick;
    RtVec3 from, to; /* of the frustum */
    float from_radius, to_radius;
} Parts;

static void add_parts(RtGeometry *g, Subject subject, const Parts *p) {
    OWNED_BUILDER b = {0};
    uint32_t solid;
    RtCsgTerm root;
    if (subject == MESH) {
        RtTriangle triangles[8];
        for (int i = 0; i < 8; i++) {
            int x = i & 1, y = i >> 1 & 1, z = i >> 2;
            bool turned = (x ^ y ^ z) != 0;
            RtVec3 second = p->tips[1][y], third = p->tips[2][z];
            triangles[i] = (RtTriangle){{p->tips[0][x], turned ? third : second, turned ? second : third}};
        }
        assert_ok(rt_solid_add_mesh(&b.set, triangles, 8, NULL, &solid, error));
        root = term_of(&b, solid);
    } else if (subject == TORUS) {
        assert_ok(rt_solid_add_ring(&b.set, p->center, p->axis, p->size, p->thick, &solid, error));
        root = term_of(&b, solid);
    } else {
        root = join(&b, ball(&b, p->center, p->size, 0), box(&b, p->lo, p->hi, 0));
    }
    assert_ok(rt_solid_add_frustum(&b.set, p->from, p->from_radius, p->to, p->to_radius, &solid, error));
    add_tree(g, &b, cut(&b, root, term_of(&b, solid)));
}

/* ---- random objects ---- */

/* Corners of a regular pentagon in a random plane, rounded: they lie in no plane. */
static void add_pentagon(RtGeometry *g, RtRandom *random, float scale) {
    static const double corners[5][2] = {
        {1, 0}, {0.30902, 0.95106}, {-0.80902, 0.58779}, {-0.80902, -0.58779}, {0.30902, -0.95106}};
    RtVec3d center = rt_widen(rt_random_point(random, 1)), u = rt_random_direction(random);
    RtVec3d v = rt_normalized(rt_crossd(u, rt_random_direction(random)));
    RtVec3 vertices[5];
    for (int i = 0; i < 5; i++) {
        RtVec3d corner = rt_add_scaledd(rt_add_scaledd(center, u, corners[i][0]), v, corners[i][1]);
        vertices[i] = rt_scale(rt_narrow(corner), scale);
    }
    assert_ok(rt_geometry_add_polygon(g, vertices, 5, error));
}

/* An octahedron about three axes at right angles; with a dent its lower tip is above the middle. */
static void make_tips(RtRandom *random, Parts *p) {
    RtVec3d axes[3] = {rt_random_direction(random)};
    axes[1] = rt_normalized(rt_crossd(axes[0], rt_random_direction(random)));
    axes[2] = rt_crossd(axes[0], axes[1]);
    double lower = rt_random_below(random, 2) ? -1 : 0.25;
    for (int a = 0; a < 3; a++) {
        for (int side = 0; side < 2; side++) {
            double height = (double)p->size * (side == 0 ? 1 : a == 2 ? lower : -1);
            p->tips[a][side] = rt_narrow(rt_add_scaledd(rt_widen(p->center), axes[a], height));
        }
    }
}

static void add_random_tree(RtGeometry *g, Subject subject, RtRandom *random, float scale) {
    Parts p = {.center = rt_scale(rt_random_point(random, 1), scale)};
    p.lo = rt_scale(rt_random_point(random, 1), scale);
    p.size = rt_random_between(random, 0.5f, 1) * scale;
    p.thick = rt_random_between(random, 0.1f, 0.4f) * scale;
    p.from = rt_scale(rt_random_point(random, 1), scale);
    p.to = rt_sub(rt_scale(p.center, 2), p.from);
    p.from_radius = p.thick;
    p.to_radius = p.thick / 2;
    p.hi = rt_add(p.lo, rt_vec3(p.size, p.size, p.thick));
    if (subject == MESH) make_tips(random, &p);
    if (subject == TORUS) p.axis = rt_narrow(rt_random_direction(random));
    add_parts(g, subject, &p);
}

static void add_random_object(RtGeometry *g, Subject subject, RtRandom *random, float scale) {
    if (subject == POLYGON) {
        add_pentagon(g, random, scale);
        return;
    }
    if (subject >= CSG) {
        add_random_tree(g, subject, random, scale);
        return;
    }
    RtVec3 v[3];
    for (int i = 0; i < 3; i++) v[i] = rt_scale(rt_random_point(random, 1), scale);
    float radius = rt_random_between(random, 0.1f, 1) * scale, other = rt_random_unit(random) * scale;
    if (subject == SPHERE) assert_ok(rt_geometry_add_sphere(g, v[0], radius, error));
    if (subject == CONE) assert_ok(rt_geometry_add_cone(g, v[0], radius, v[1], other, error));
    if (subject == TRIANGLE) assert_ok(rt_geometry_add_triangle(g, v, NULL, error));
}

/* ---- lattices ----
 *
 * Objects and rays whose numbers are small integers, or halves, so that rays pass exactly through vertices,
 * edges, rims and tip, or touch. */

/* Points of an object where a ray is decided at a border, or is easily. */
typedef struct Lattice {
    RtVec3 targets[32];
    uint32_t count;
} Lattice;

/* An integer in -most..most. */
static float whole(RtRandom *random, int most) {
    return (float)((int)rt_random_below(random, 2 * (uint32_t)most + 1) - most);
}

static RtVec3 whole_point(RtRandom *random, int most) {
    RtVec3 p;
    for (int a = 0; a < 3; a++) p.at[a] = whole(random, most);
    return p;
}

static void aim(Lattice *lattice, RtVec3 point) {
    lattice->targets[lattice->count++] = point;
}

/* The vertices, and the middles of the edges. */
static void aim_at_edges(Lattice *lattice, const RtVec3 *v, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        aim(lattice, v[i]);
        aim(lattice, rt_scale(rt_add(v[i], v[(i + 1) % count]), 0.5f));
    }
}

/* The axes are permuted, so that no axis is special. */
static RtVec3 turned(RtVec3 v, uint32_t by) {
    return rt_vec3(v.at[by], v.at[(by + 1) % 3], v.at[(by + 2) % 3]);
}

static void add_flat(Lattice *lattice, RtGeometry *g, RtRandom *random, bool pentagon) {
    static const float corners[5][2] = {{2, 0}, {1, 2}, {-1, 2}, {-2, 0}, {0, -2}};
    RtVec3 v[5], u, w;
    do {
        u = whole_point(random, 2);
        w = whole_point(random, 2);
    } while (rt_lengthd(rt_crossd(rt_widen(u), rt_widen(w))) == 0);
    const RtVec3 center = whole_point(random, 4);
    for (int i = 0; i < 5; i++)
        v[i] = rt_add(center, rt_add(rt_scale(u, corners[i][0]), rt_scale(w, corners[i][1])));
    aim_at_edges(lattice, v, pentagon ? 5 : 3);
    if (pentagon)
        assert_ok(rt_geometry_add_polygon(g, v, 5, error));
    else
        assert_ok(rt_geometry_add_triangle(g, v, NULL, error));
}

/* Radius 5, because 3^2 + 4^2 = 5^2. */
static void add_sphere(Lattice *lattice, RtGeometry *g, RtRandom *random) {
    const RtVec3 center = whole_point(random, 4);
    for (uint32_t i = 0; i < 3; i++) {
        aim(lattice, rt_add(center, turned(rt_vec3(0, 0, 5), i)));
        aim(lattice, rt_sub(center, turned(rt_vec3(3, -4, 0), i)));
    }
    assert_ok(rt_geometry_add_sphere(g, center, 5, error));
}

/* A cylinder along an axis, or along (3, 4, 0), or a cone. The points are on its rims, and on its side. */
static void add_cone(Lattice *lattice, RtGeometry *g, RtRandom *random) {
    static const RtVec3 across[2][4] = {{{{5, 0, 0}}, {{-3, 4, 0}}, {{0, -5, 0}}, {{4, 3, 0}}},
                                        {{{4, -3, 0}}, {{-4, 3, 0}}, {{0, 0, 5}}, {{0, 0, -5}}}};
    const bool oblique = rt_random_below(random, 2);
    const uint32_t turn = rt_random_below(random, 3), kind = rt_random_below(random, 3);
    const float length = 1 + (float)rt_random_below(random, 3), ratio = 0.5f * (float)kind;
    const RtVec3 axis = turned(oblique ? rt_vec3(3, 4, 0) : rt_vec3(0, 0, 5), turn);
    const RtVec3 base = whole_point(random, 4), apex = rt_add(base, rt_scale(axis, length));
    for (int i = 0; i < 4; i++) {
        const RtVec3 rim = rt_add(base, turned(across[oblique][i], turn));
        const RtVec3 other = rt_add(apex, rt_scale(turned(across[oblique][i], turn), ratio));
        aim(lattice, rim);
        aim(lattice, other);
        aim(lattice, rt_scale(rt_add(rim, other), 0.5f));
    }
    assert_ok(rt_geometry_add_cone(g, base, 5, apex, 5 * ratio, error));
}

static void add_lattice_tree(Lattice *lattice, RtGeometry *g, Subject subject, RtRandom *random) {
    const RtVec3 center = whole_point(random, 4);
    Parts p = {.center = center, .axis = rt_vec3(0, 0, 1), .size = 5, .thick = 2};
    p.lo = rt_sub(center, rt_vec3(6, 4, 3)), p.hi = rt_add(center, rt_vec3(6, 4, 3));
    p.from = rt_sub(center, rt_vec3(0, 0, 8)), p.to = rt_add(center, rt_vec3(0, 0, 8));
    p.from_radius = p.to_radius = 1;
    RtVec3 tips[6];
    for (uint32_t i = 0; i < 6; i++) {
        tips[i] = rt_add(center, turned(rt_vec3(i < 3 ? 5 : -5, 0, 0), (3 - i % 3) % 3));
        p.tips[i % 3][i / 3] = tips[i];
    }
    if (subject == MESH) {
        for (uint32_t z = 0; z < 2; z++) {
            for (uint32_t y = 0; y < 2; y++) {
                const RtVec3 second = tips[1 + 3 * y], third = tips[2 + 3 * z];
                const RtVec3 face[3] = {tips[0], y != z ? third : second, y != z ? second : third};
                aim_at_edges(lattice, face, 3);
            }
        }
    } else if (subject == TORUS) {
        for (uint32_t i = 0; i < 6; i++) aim(lattice, tips[i]);
        aim(lattice, rt_add(center, rt_vec3(3, 4, 2)));
        aim(lattice, rt_add(center, rt_vec3(0, 7, 0)));
        aim(lattice, rt_add(center, rt_vec3(-4, 3, -2)));
    } else {
        for (uint32_t i = 0; i < 8; i++)
            aim(lattice, rt_vec3(i & 1 ? p.lo.x : p.hi.x, i & 2 ? p.lo.y : p.hi.y, i & 4 ? p.lo.z : p.hi.z));
        for (uint32_t i = 0; i < 6; i++) aim(lattice, tips[i]);
        aim(lattice, rt_add(center, rt_vec3(4, 0, 3))); /* where ball and box meet */
        aim(lattice, rt_add(center, rt_vec3(-3, 4, 0)));
    }
    add_parts(g, subject, &p);
}

static void add_lattice_object(Lattice *lattice, RtGeometry *g, Subject subject, RtRandom *random) {
    if (subject == SPHERE) add_sphere(lattice, g, random);
    if (subject == POLYGON || subject == TRIANGLE) add_flat(lattice, g, random, subject == POLYGON);
    if (subject == CONE) add_cone(lattice, g, random);
    if (subject >= CSG) add_lattice_tree(lattice, g, subject, random);
}

/* Exactly through one of the points. */
static RtRay lattice_ray(const Lattice *lattice, RtRandom *random) {
    const RtVec3 target = lattice->targets[rt_random_below(random, lattice->count)];
    RtRay ray = {.tmax = INFINITY, .kind = RT_RAY_RANDOM};
    do ray.dir = whole_point(random, 3);
    while (rt_lengthd(rt_widen(ray.dir)) == 0);
    ray.org = rt_sub(target, rt_scale(ray.dir, (float)(1 + rt_random_below(random, 8))));
    return ray;
}

/* ---- rays ---- */

typedef struct Range {
    Subject subject;
    const RtGeometry *geometry;
    const Case *how;
    RtRandom random;
    double distance; /* of origins */
    Lattice lattice[OBJECTS];
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
    Decision decision = decision_of(r->geometry, id, &ray, hit_memory_of_tests());
    if (!decision.hit) return ray;
    RtVec3d normal = rt_object_normals(r->geometry, id, &ray, decision.t, hit_memory_of_tests()).geometric;
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
    if (r->subject == MESH)
        return ray_towards(r, point_on_edge(&r->random, random_facet(r, &g->csgs[index])->v, 3), dir);
    return ray_along_surface(r, id, 0);
}

/* From where an ordinary ray hits the object, if it does. */
static RtRay ray_from_surface(Range *r, uint32_t id) {
    RtRay ray = ray_to_box(r, id);
    Decision decision = decision_of(r->geometry, id, &ray, hit_memory_of_tests());
    if (!decision.hit) return ray;
    ray.org = rt_narrow(rt_ray_point(&ray, decision.t));
    ray.dir = rt_narrow(rt_random_direction(&r->random));
    return ray;
}

static RtRay next_ray(Range *r, uint32_t id) {
    if (r->how->aim == AIM_LATTICE) return lattice_ray(&r->lattice[id], &r->random);
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
    double rate = rt_dotd(rt_object_normals(g, id, ray, t, hit_memory_of_tests()).geometric, line.dir);
    return fabs(error * rate) / border_unit(g, id, &line);
}

/* `errors` has room for one more at out->hits. */
static void measure_ray(const Range *r, uint32_t id, const RtRay *ray, double *errors, Precision *out) {
    const RtGeometry *g = r->geometry;
    Decision ours = decision_of(g, id, ray, hit_memory_of_tests());
    long double off = 0, ulps = 0;
    RtExactResult exact = error_of_t(g, id, ray, ours.hit ? ours.t : 0, &off, &ulps);
    RtWideRay line = rt_wide_ray(ray);
    RtExactResult same = check_decision(g, id, &line, ours);
    assert_true(exact != RT_UNDECIDED && same != RT_UNDECIDED);
    const double size = (double)fabsl(off), rounding = 0.501 * (double)rt_float_ulp((long double)ours.t);
    const double height = same == RT_HIT && exact == RT_HIT ? off_surface(r, id, ray, ours.t, size) : 0;
    if (same == RT_HIT && (height <= 2 || r->subject == TRIANGLE)) { /* else another crossing */
        if (exact != RT_HIT) return;
        out->off = fmax(out->off, height);
        out->excess = fmax(out->excess, (size - rounding) * rt_lengthd(line.dir) / border_unit(g, id, &line));
        errors[out->hits++] = (double)fabsl(ulps);
        return;
    }
    if (!ours.hit)
        out->missed++;
    else if (exact == RT_MISSED)
        out->invented++;
    else
        out->elsewhere++;
    out->border = fmax(out->border, border_distance(g, id, ray, ours));
}

/* Aims RAYS rays of a case at such objects: the same on any machine. */
static Precision measured_case(Subject subject, size_t index) {
    Precision out = {.rays = RAYS};
    double errors[RAYS];
    float scale = ldexpf(1, cases[index].scale);
    OWNED_GEOMETRY g = {0};
    Range range = {
        .subject = subject, .geometry = &g, .how = &cases[index], .random = rt_random(6, (uint64_t)subject)};
    range.distance = 3 * (double)scale;
    for (int i = 0; i < cases[index].distance; i++) range.distance *= 10;
    for (uint32_t i = 0; i < OBJECTS; i++) {
        if (range.how->aim == AIM_LATTICE)
            add_lattice_object(&range.lattice[i], &g, subject, &range.random);
        else
            add_random_object(&g, subject, &range.random, scale);
    }
    assert_ok(rt_geometry_finish(&g, error));
    for (uint32_t i = 0; i < RAYS; i++) {
        RtRay ray = next_ray(&range, i % OBJECTS);
        measure_ray(&range, i % OBJECTS, &ray, errors, &out);
    }
    if (out.hits == 0) return out;
    qsort(errors, out.hits, sizeof(double), by_size);
    out.median = errors[out.hits / 2];
    out.most99 = errors[out.hits * 99 / 100];
    out.most = errors[out.hits - 1];
    return out;
}

static Precision measured[SUBJECT_COUNT][CASES];

static int measure(void **state) {
    (void)state;
    for (int subject = 0; subject < SUBJECT_COUNT; subject++) {
        for (size_t i = 0; i < CASES; i++) measured[subject][i] = measured_case((Subject)subject, i);
    }
    return 0;
}

/* ---- the table ---- */

static void format_row(Subject subject, size_t i, char *out, size_t size) {
    const Precision *p = &measured[subject][i];
    char most[32];
    snprintf(most, sizeof most, p->most < 1e9 ? "%.2f" : "%.3g", p->most);
    snprintf(out, size, "| %s | %s | %d | %.2f | %.2f | %s | %.2f | %d | %d | %d | %.3g |\n", names[subject],
             cases[i].name, (int)p->hits, p->median, p->most99, most, p->off, (int)p->missed,
             (int)p->invented, (int)p->elsewhere, p->border);
}

RT_TEST(the_rows_in_the_docs_are_what_is_measured) {
    OWNED_MEMORY char *text = NULL;
    size_t size = 0, stale = 0;
    assert_ok(rt_file_read(RT_SOURCE_DIR "/docs/precision.md", 1 << 20, &text, &size, error));
    for (size_t i = 0; i < CASES; i++) {
        char row[256];
        snprintf(row, sizeof row, "| %s | %s |\n", cases[i].name, cases[i].meaning);
        if (!strstr(text, row)) stale++;
    }
    for (int subject = 0; subject < SUBJECT_COUNT; subject++) {
        for (size_t i = 0; i < CASES; i++) {
            char row[256], start[64];
            format_row((Subject)subject, i, row, sizeof row);
            fputs(row, stdout);
            snprintf(start, sizeof start, "| %s | %s |", names[subject], cases[i].name);
            const char *shown = strstr(text, start);
            if (shown && strncmp(shown, row, strlen(row)) != 0) stale++;
        }
    }
    if (stale > 0)
        fail_msg("%zu rows of docs/precision.md are not those above, or its cases are others", stale);
}

/* ---- bounds ---- */

static bool is_case(size_t i, const char *name) {
    return strcmp(cases[i].name, name) == 0;
}

/* Rays that may start on the object: what is a rounding of doubles is any number of ulps of a t near 0. */
static bool starts_near(size_t i) {
    return is_case(i, "lattice") || is_case(i, "leaving");
}

/* Half an ulp is what rounding to float32 takes. What is computed in double takes no more, even along
 * tangents and from afar, but for 2^-46 of the distance to the far side of the box, 2^-22 units. A tangent of
 * a lattice has a double root, which takes half of the digits. */
RT_TEST(t_is_rounded_once_but_for_triangles) {
    for (int subject = 0; subject < SUBJECT_COUNT; subject++) {
        if (subject == TRIANGLE) continue;
        for (size_t i = 0; i < CASES; i++) {
            const Precision *p = &measured[subject][i];
            assert_true(p->hits > RAYS / 5);
            const double bound = is_case(i, "lattice") ? 1 : 0x1p-22;
            if (p->excess <= bound && (p->most <= 0.501 || starts_near(i))) continue;
            fail_msg("%s, %s: t is off by %g ulp, and by 0.501 ulp and %g units", names[subject],
                     cases[i].name, p->most, p->excess);
        }
    }
}

/* A triangle's vertices are moved by a rounded shear, half a unit along two axes and more: its surface is
 * uncertain by that, and seen edge on t is by any number of ulps. The others are off by half an ulp of t, at
 * most sqrt(3) units. */
RT_TEST(hits_are_on_the_surface_within_a_few_units) {
    for (int subject = 0; subject < SUBJECT_COUNT; subject++) {
        for (size_t i = 0; i < CASES; i++) {
            double bound = subject == TRIANGLE ? 4 : 1.74;
            if (measured[subject][i].off <= bound) continue;
            fail_msg("%s, %s: a hit is %g units off the surface", names[subject], cases[i].name,
                     measured[subject][i].off);
        }
    }
}

/* An edge is passed within 2 units, and so is the start of a ray. Aimed at exactly, by lattices, any border
 * may be missed; a line through the tip of a cone, or along its side, passes no border. A wall of a tree that
 * is thinner than an ulp of t, 2 units, is not there, and the edge of a sharp wedge is farther off than the
 * wedge is thick. */
RT_TEST(decisions_differ_from_exact_ones_at_borders_only) {
    for (int subject = 0; subject < SUBJECT_COUNT; subject++) {
        for (size_t i = 0; i < CASES; i++) {
            const Precision *p = &measured[subject][i];
            bool edges = subject == TRIANGLE || subject == MESH;
            bool aimed = (edges && is_case(i, "border")) || is_case(i, "lattice");
            bool tip = subject == CONE && is_case(i, "lattice");
            if ((tip || p->border <= (subject >= CSG ? 4 : 2)) &&
                (aimed || p->missed + p->invented + p->elsewhere < RAYS / 50)) {
                continue;
            }
            fail_msg("%s, %s: %d missed, %d invented, %d elsewhere, up to %g units from a border",
                     names[subject], cases[i].name, (int)p->missed, (int)p->invented, (int)p->elsewhere,
                     p->border);
        }
    }
}

/* Powers of two change no digit, unless numbers are lost at the ends of float32. */
RT_TEST(scale_makes_no_difference) {
    for (int subject = 0; subject < SUBJECT_COUNT; subject++) {
        const Precision *ordinary = &measured[subject][0];
        for (size_t i = 1; i < CASES; i++) {
            if (!is_case(i, "tiny") && !is_case(i, "huge")) continue;
            assert_memory_equal(ordinary, &measured[subject][i], sizeof *ordinary);
        }
    }
}

/* ---- needles ---- */

/* How far org + t dir is from the plane of the triangle, which may be passed beside it. */
static double off_plane(const RtVec3 v[3], const RtRay *ray, float t) {
    RtExactVec a = rt_exact_vec(rt_widen(v[0]));
    RtExactVec b = rt_exact_vec_sub(rt_exact_vec(rt_widen(v[1])), a);
    RtExactVec c = rt_exact_vec_sub(rt_exact_vec(rt_widen(v[2])), a);
    RtExactVec normal = rt_exact_cross(b, c), dir = rt_exact_vec(rt_widen(ray->dir));
    RtExactVec from = rt_exact_vec_sub(rt_exact_vec(rt_widen(ray->org)), a);
    RtExactVec point = rt_exact_vec_add_scaled(from, dir, rt_exact_of((double)t));
    long double height = rt_exact_value(rt_exact_dot(normal, point));
    long double length = sqrtl(rt_exact_value(rt_exact_dot(normal, normal)));
    rt_exact_rewind(0);
    return (double)fabsl(height / length);
}

/* A needle is thinner than the difference of float32 products, so that weights from those would put t
 * anywhere between its ends; but nothing is uncertain about where its plane is. */
RT_TEST(t_of_a_needle_is_that_of_its_plane) {
    RtRandom random = rt_random(11, 0);
    int hits = 0;
    for (int i = 0; i < 20000; i++) {
        RtVec3 v[3];
        for (int k = 0; k < 2; k++) v[k] = rt_random_point(&random, 1);
        float thin = rt_random_between(&random, 0x1p-20f, 0x1p-14f), along = rt_random_unit(&random);
        RtVec3 aside = rt_scale(rt_random_point(&random, 1), thin);
        v[2] = i % 2 ? rt_add(v[1], aside) : rt_add(rt_scale(rt_add(v[0], v[1]), 0.5f), aside);
        RtVec3 target = rt_add(v[0], rt_scale(rt_sub(v[1], v[0]), along));
        RtRay ray = {.org = rt_scale(rt_random_point(&random, 1), 3), .tmin = 0, .tmax = INFINITY};
        ray.dir = rt_sub(target, ray.org);
        OWNED_OBJECT(g, triangle, v, NULL);
        RtPreparedRay prepared;
        rt_hit_ray(&prepared, &g, &ray, NULL);
        float t;
        if (rt_object_hit(&g, 0, &prepared, &t, NULL)) {
            hits++;
            double off = off_plane(v, &ray, t);
            double most = 16 * 0x1p-4 * (double)rt_thickness(ray.org, &g.box);
            if (!(off <= most)) fail_msg("needle %d: t = %g is %g off its plane", i, (double)t, off);
        }
    }
    assert_true(hits > 1000);
}

RT_TESTS(precision, measure, NULL)
