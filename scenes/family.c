/* SPDX-License-Identifier: Apache-2.0 */
/* The families of scenes. One row per recipe: how many objects of which shapes, where, how large, and how
 * the whole is scaled and moved. */
#include "scenes/builtin.h"

#include <inttypes.h>
#include <stdio.h>

/* ---- places: position and size of an object, in a world of about [-1, 1]^3 ---- */

typedef struct Placement {
    RtVec3d center;
    double size;
} Placement;

typedef enum Place {
    UNIFORM,
    COINCIDENT,
    ON_A_LINE,
    IN_A_PLANE,
    HUGE_BESIDE_TINY,
    CLUSTERED,        /* eight clusters, each a hundredth of the world */
    DUPLICATED,       /* groups of four are identical */
    ON_A_LATTICE,     /* corners and edges on multiples of 1/4, on the planes of a grid */
    TOUCHING,         /* spheres of diameter 1/4 on multiples of 1/4: neighbours touch. Some are half as
                       * large, and touch one from inside */
    IN_PROGRESSION,   /* each half as large as the one before, and half as far from the origin */
    CONCENTRIC,       /* nested: no plane separates them */
    STACKED,          /* as large as the world, in planes that many share */
    AROUND_THE_ORIGIN /* the lattice, and by turns the lattice moved by half its width: one has edges
                       * in the coordinate planes, which meet at the origin, the next lies in them */
} Place;

/* Multiples of 1/4 from -most / 4 on, below most / 4. */
static RtVec3d on_quarters(RtRandom *random, double most) {
    RtVec3d p;
    for (int a = 0; a < 3; a++) p.at[a] = floor(rt_random_betweend(random, -most, most)) / 4;
    return p;
}

static Placement of_any_size(RtVec3d center, RtRandom *random) {
    return (Placement){center, rt_random_betweend(random, 0.02, 0.2)};
}

/* Of object `i` of `count`. */
static Placement placement_of(Place place, RtRandom *random, uint32_t i, uint32_t count) {
    const RtVec3d aside = {0.25, 0.5, -0.125}, half = {0.125, 0.125, 0.125};
    const double size = ldexp(1, -(int)i);
    RtRandom shared = rt_random(11, i / 4);
    RtVec3d p;
    switch (place) {
    case UNIFORM: return of_any_size(rt_random_in_cube(random), random);
    case COINCIDENT: return (Placement){aside, 0.5};
    case ON_A_LINE: return (Placement){{-1 + 2.0 * i / count, 0, 0}, 1.0 / count};
    case IN_A_PLANE: p = rt_random_in_cube(random); return of_any_size(rt_vec3d(p.x, p.y, 0.5), random);
    case HUGE_BESIDE_TINY:
        p = rt_random_in_cube(random);
        return i % 8 == 0 ? (Placement){rt_scaled(p, 3), 2} : (Placement){rt_scaled(p, 1e-3), 1e-4};
    case CLUSTERED:
        p = rt_vec3d(i & 1 ? 0.75 : -0.75, i & 2 ? 0.75 : -0.75, i & 4 ? 0.75 : -0.75);
        p = rt_add_scaledd(p, rt_random_in_cube(random), 0.01);
        return (Placement){p, rt_random_betweend(random, 0.001, 0.005)};
    case DUPLICATED: return placement_of(UNIFORM, &shared, i, count);
    case ON_A_LATTICE: return (Placement){rt_addd(on_quarters(random, 4), half), 0.125};
    case TOUCHING:
        p = on_quarters(random, 3);
        if (i % 4 > 0) return (Placement){p, 0.125};
        p.at[i / 4 % 3] += 0.0625;
        return (Placement){p, 0.0625};
    case IN_PROGRESSION: return (Placement){{size, size, size}, size / 4};
    case CONCENTRIC: return (Placement){aside, (i + 1.0) / count};
    case STACKED: p = on_quarters(random, 2); return (Placement){p, 0.5 + 0.25 * rt_random_below(random, 3)};
    case AROUND_THE_ORIGIN:
        p = rt_addd(on_quarters(random, 4), half);
        return (Placement){i / 2 % 2 ? rt_subd(p, half) : p, 0.125};
    }
    return (Placement){aside, 0.5};
}

/* ---- recipes ---- */

typedef enum Make {
    SPHERES,
    TRIANGLES,
    SLIVERS,
    SHARED,
    ROUND_AND_FLAT,
    AXIS_ALIGNED,
    TREES,
    MESH,
    NEEDLES,
    INSTANCED
} Make;

/* The scale and offset of the whole: scale * p + (offset, offset, offset). If drawn from the seed, the
 * scale is 2^k for a k in -40..40, and the offset 2^0..2^16 times the scale. */
typedef enum Scaling { GIVEN, DRAWN_SCALE, DRAWN_SCALE_AND_OFFSET } Scaling;

/* Lights, or an eye, placed among the objects; otherwise a camera that sees them all, with a light beside
 * it. */
typedef enum Around { CAMERA, LIGHTS, EYE } Around;

typedef struct Recipe {
    const char *name;
    uint32_t count;
    Make make;
    Place place;
    double scale, offset;
    Scaling scaling;
    Around around;
} Recipe;

/* ---- objects ---- */

typedef struct Family {
    const Recipe *recipe;
    RtSceneBuilder *b; /* its transform is the recipe's scale and offset */
    RtRandom random;
} Family;

static void add_triangle(Family *f, Placement at) {
    RtVec3d v[3];
    for (int i = 0; i < 3; i++) v[i] = rt_add_scaledd(at.center, rt_random_in_cube(&f->random), at.size);
    rt_build_triangle(f->b, v[0], v[1], v[2]);
}

/* Slivers, needles and degenerate triangles, among ordinary ones. */
static void add_sliver(Family *f, Placement at, uint32_t i) {
    static const double thin[] = {1e-3, 1e-5, 1e-7, 1e-9};
    RtVec3d p[3];
    for (int k = 0; k < 3; k++) p[k] = rt_add_scaledd(at.center, rt_random_in_cube(&f->random), at.size);
    RtVec3d along = rt_subd(p[1], p[0]),
            aside = rt_scaled(rt_random_in_cube(&f->random), at.size * thin[i / 6 % 4]);
    switch (i % 6) {
    case 0: p[2] = rt_addd(rt_add_scaledd(p[0], along, rt_random_betweend(&f->random, 0, 1)), aside); break;
    case 1: p[2] = rt_addd(p[1], aside); break;
    case 2: p[2] = rt_add_scaledd(p[0], along, 0.5); break; /* collinear, or nearly so */
    case 3: p[2] = p[1]; break;
    case 4: p[1] = p[2] = p[0]; break;
    default: break;
    }
    rt_build_triangle(f->b, p[0], p[1], p[2]);
}

/* Triangles around one edge, like the pages of a book, or around one vertex. */
static void add_shared(Family *f, uint32_t i) {
    RtVec3d p[3] = {{0.1, -0.7, 0.3}, {-0.2, 0.6, 0.4}, rt_random_in_cube(&f->random)};
    if (i % 2) p[1] = rt_random_in_cube(&f->random);
    rt_build_triangle(f->b, p[i % 3], p[(i + 1) % 3], p[(i + 2) % 3]);
}

/* A concave L of six vertices in a coordinate plane, which offsets and scales do not warp. */
static void add_polygon(Family *f, Placement at) {
    static const double outline[6][2] = {{-1, -1}, {1, -1}, {1, 0}, {0, 0}, {0, 1}, {-1, 1}};
    uint32_t plane = rt_random_below(&f->random, 3);
    RtVec3d vertices[6];
    for (int i = 0; i < 6; i++) {
        vertices[i] = at.center;
        vertices[i].at[plane == 1] += at.size * outline[i][0];
        vertices[i].at[plane == 0 ? 1 : 2] += at.size * outline[i][1];
    }
    rt_build_polygon(f->b, vertices, 6);
}

static void add_cone(Family *f, Placement at) {
    RtVec3d axis = rt_random_direction(&f->random);
    double base = at.size * rt_random_betweend(&f->random, 0.2, 0.8);
    double apex = rt_random_below(&f->random, 2) ? base : 0; /* a cylinder or a full cone */
    rt_build_cone(f->b, at.center, base, rt_add_scaledd(at.center, axis, at.size), apex);
}

/* A rectangle in a coordinate plane, by turns as two triangles and as a polygon. */
static void add_axis_aligned(Family *f, Placement at, uint32_t i) {
    int w = (int)(rt_random_below(&f->random, 3)), u = (w + 1) % 3, v = (w + 2) % 3;
    RtVec3d c[4];
    for (int k = 0; k < 4; k++) {
        c[k] = at.center;
        c[k].at[u] += k == 1 || k == 2 ? at.size : -at.size;
        c[k].at[v] += k >= 2 ? at.size : -at.size;
    }
    if (i % 2) {
        rt_build_polygon(f->b, c, 4);
    } else {
        rt_build_triangle(f->b, c[0], c[1], c[2]);
        rt_build_triangle(f->b, c[0], c[2], c[3]);
    }
}

/* Across the whole scene near each axis in turn: a triangle, or a cylinder. */
static void add_needle(Family *f, Placement at, uint32_t i) {
    RtVec3d from = at.center, to = rt_add_scaledd(at.center, rt_random_in_cube(&f->random), at.size);
    from.at[i % 3] = -1;
    to.at[i % 3] = 1;
    if (i / 3 % 2)
        rt_build_cone(f->b, from, at.size / 64, to, at.size / 64);
    else
        rt_build_triangle(f->b, from, to, rt_add_scaledd(to, rt_random_in_cube(&f->random), at.size / 32));
}

static void add_mixed(Family *f, Placement at, uint32_t i) {
    switch (i % 4) {
    case 0: rt_build_sphere(f->b, at.center, at.size); break;
    case 1: add_triangle(f, at); break;
    case 2: add_polygon(f, at); break;
    default: add_cone(f, at);
    }
}

/* A random CSG tree of up to 24 solids; the first of every eight is a single solid. Every other tree tests
 * inner nodes. RT_BAD_INPUT if rounding flattens one of its solids. */
static RtStatus try_tree(Family *f, Placement at, uint32_t i, RtError *error) {
    RtTreeRecipe recipe = {i % 8 == 0 ? 1 : 2 + rt_random_below(&f->random, 23), i % 2};
    double o = f->b->transform.m[0][3], scale = f->b->transform.m[0][0], size = scale * at.size / 4;
    RtTransform move = {{{size, 0, 0, o + scale * at.center.x},
                         {0, size, 0, o + scale * at.center.y},
                         {0, 0, size, o + scale * at.center.z}}};
    RtCsgBuilder trees = {0};
    RtCsgTerm root;
    RtStatus status = rt_random_tree(&trees, &f->random, &recipe, 1, &root, error);
    if (status == RT_OK) status = rt_csg_move(&trees, root, &move, &root, error);
    if (status == RT_OK) status = rt_scene_add_csg(f->b->scene, &trees, root, i / 2 % 2 == 0, error);
    rt_csg_builder_clear(&trees);
    return status;
}

/* Adds the next tree that is not flat. */
static void add_tree(Family *f, Placement at, uint32_t i) {
    RtStatus status = f->b->status == RT_OK ? RT_BAD_INPUT : f->b->status;
    for (int tries = 0; tries < 100 && status == RT_BAD_INPUT; tries++)
        status = try_tree(f, at, i, f->b->error);
    rt_build_check(f->b, status);
}

/* A closed mesh: an octahedron, each face cut into n x n triangles, its vertices moved to the unit sphere.
 * Neighbours share their vertices bit for bit. */
static void add_mesh(Family *f, uint32_t n) {
    for (uint32_t face = 0; face < 8; face++) {
        RtVec3d sign = {face & 1 ? -1 : 1, face & 2 ? -1 : 1, face & 4 ? -1 : 1};
        for (uint32_t i = 0; i < n; i++) {
            for (uint32_t j = 0; j + i < n; j++) {
                const uint32_t at[4][2] = {{i, j}, {i + 1, j}, {i, j + 1}, {i + 1, j + 1}};
                RtVec3d v[4];
                for (int k = 0; k < 4; k++) {
                    double x = at[k][0], y = at[k][1], z = (double)n - x - y;
                    v[k] = rt_normalized(rt_vec3d(x * sign.x, y * sign.y, z * sign.z));
                }
                rt_build_triangle(f->b, v[0], v[1], v[2]);
                if (i + j + 1 < n) rt_build_triangle(f->b, v[1], v[2], v[3]);
            }
        }
    }
}

static void add_object(Family *f, uint32_t i) {
    Placement at = placement_of(f->recipe->place, &f->random, i, f->recipe->count);
    switch (f->recipe->make) {
    case SPHERES: rt_build_sphere(f->b, at.center, at.size); break;
    case TRIANGLES: add_triangle(f, at); break;
    case SLIVERS: add_sliver(f, at, i); break;
    case SHARED: add_shared(f, i); break;
    case ROUND_AND_FLAT: add_mixed(f, at, i); break;
    case AXIS_ALIGNED: add_axis_aligned(f, at, i); break;
    case TREES: add_tree(f, at, i); break;
    case NEEDLES: add_needle(f, at, i); break;
    case INSTANCED: add_mixed(f, at, i); break;
    case MESH: break;
    }
}

/* ---- instances ---- */

/* What a family has of them, by its place: parts, objects in a part, instances in a later part and in the
 * scene. */
typedef struct Instancing {
    uint32_t parts, own, inner, instances;
} Instancing;

enum { COINCIDENT_COUNT = 8 };

static Instancing instancing(const Recipe *recipe) {
    switch (recipe->place) {
    case ON_A_LATTICE: return (Instancing){1, 0, 0, 27};
    case COINCIDENT: return (Instancing){3, 4, 0, 3 * COINCIDENT_COUNT};
    case HUGE_BESIDE_TINY: return (Instancing){3, 4, 0, 16};
    case CONCENTRIC: return (Instancing){8, 1, 0, 2}; /* the costs of levels may multiply */
    default: return (Instancing){6, 4, 2, 16};
    }
}

/* The objects of part `k`, without those of a cube, and its instances. */
static uint32_t own_of(const Recipe *recipe, uint32_t k) {
    return k == 0 || k == 5 ? recipe->place == CONCENTRIC : instancing(recipe).own;
}

static uint32_t inner_of(const Recipe *recipe, uint32_t k) {
    if (recipe->place == CONCENTRIC) return k == 0 ? 0 : 1 + k % 2;
    return k > 2 ? instancing(recipe).inner : 0;
}

/* Scaled by factors near RT_MAX_STRETCH, between turns; or sheared. */
static RtTransform near_singular(Family *f, uint32_t i) {
    static const float factors[][3] = {{4e-6f, 1, 1},    {1, 1, 2.5e5f}, {2e-6f, 2e-6f, 2e-6f},
                                       {1, 2e-3f, 5e2f}, {1, 1, 4e-6f},  {1, 0.01f, 0.1f}};
    RtTransform t = rt_transform_identity();
    const float *by = factors[i % 6];
    if (i % 7 == 6) t.m[0][1] = 998;
    for (int turn = 0; turn < 2 && i % 7 < 6; turn++) {
        const double degrees = i < 6 ? 0 : rt_random_betweend(&f->random, 0, 360);
        const RtVec3 axis = rt_narrow(rt_random_direction(&f->random));
        rt_build_check(f->b, rt_transform_rotate(&t, axis, degrees, f->b->error));
        if (turn > 0) break;
        rt_build_check(f->b, rt_transform_scale(&t, rt_vec3(by[0], by[1], by[2]), f->b->error));
    }
    return t;
}

/* By turns on the lattice, with quarter turns, where faces are shared and instances coincide; turned and
 * scaled unevenly; sheared; and small. Far ones are also scaled by up to 2^8, and moved by up to 2^10 times
 * that. */
static RtTransform some_matrix(Family *f, uint32_t i) {
    RtRandom *r = &f->random;
    RtTransform t = rt_transform_identity();
    if (f->recipe->place == HUGE_BESIDE_TINY) return near_singular(f, i);
    RtRandom shared = rt_random(12, i);
    if (f->recipe->place == COINCIDENT) r = &shared;
    RtVec3d to = i % 4 == 0 ? on_quarters(r, 2) : rt_scaled(rt_random_in_cube(r), 0.5);
    RtVec3 axis = {{0, 0, 0}}, factors;
    axis.at[i % 3] = 1;
    const bool far = f->recipe->offset > 0;
    const double scale = far ? ldexp(1, (int)rt_random_below(r, 17) - 8) : 1;
    if (i % 4 == 1) axis = rt_narrow(rt_random_direction(r));
    for (int a = 0; a < 3; a++) {
        factors.at[a] = i % 4 == 1 ? rt_random_between(r, 0.125f, 1) : i % 4 == 3 ? 0.5f : 1;
        if (i % 4 == 2) t.m[a][(a + 1) % 3] = rt_random_betweend(r, 0, 1);
    }
    rt_build_check(f->b, rt_transform_scale(&t, factors, f->b->error));
    rt_build_check(
        f->b, rt_transform_rotate(&t, axis, 90.0 * rt_random_below(r, 4) + (i % 4 == 1) * 17, f->b->error));
    if (far) to = rt_scaled(to, ldexp(1, (int)rt_random_below(r, 11)));
    for (int a = 0; a < 3; a++) {
        for (int column = 0; column < 3; column++) t.m[a][column] *= scale;
        t.m[a][3] = scale * to.at[a];
    }
    return t;
}

/* Side by side: they share all faces, and corners. */
static RtTransform in_a_row(uint32_t i) {
    RtTransform t = rt_transform_identity();
    for (uint32_t a = 0; a < 3; a++) t.m[a][3] = (double)(i / (a == 0 ? 1 : a == 1 ? 3 : 9) % 3) / 4;
    return t;
}

/* Every third is painted; around the origin all mirror. Places beyond the largest coordinate are refused. */
static void add_instance(Family *f, RtScene *to, const RtScene *of, uint32_t i) {
    RtStatus status = f->b->status == RT_OK ? RT_BAD_INPUT : f->b->status;
    const Place place = f->recipe->place;
    for (int tries = 0; tries < 100 && status == RT_BAD_INPUT; tries++) {
        const uint32_t turn = place == COINCIDENT ? i / COINCIDENT_COUNT : i;
        RtTransform at = place == ON_A_LATTICE ? in_a_row(i) : some_matrix(f, turn);
        for (int c = 0; c < 4 && place == AROUND_THE_ORIGIN; c++) at.m[i % 3][c] *= -1;
        if (to == of) at = rt_transform_compose(&at, &f->b->transform);
        const uint32_t part = place == CONCENTRIC   ? of->part_count - 1
                              : place == COINCIDENT ? turn
                                                    : rt_random_below(&f->random, of->part_count);
        status = rt_scene_add_instance(to, of, part, &at, i % 3 ? RT_OWN_MATERIALS : 0, f->b->error);
    }
    rt_build_check(f->b, status);
}

/* A mirror, which is number 0, for painted instances; and grey for objects. */
static void add_materials(RtSceneBuilder *b) {
    const RtMaterial mirror = RT_MATERIAL("mirror", 0.5f, 0.5f, 0.5f, 0.1f, 0.5f, 0, 1, 0.5f);
    rt_build_material(b, mirror);
    rt_build_material(b, rt_default_material());
}

/* A cube, whose copies on the lattice share faces; shapes; trees; and parts of shapes and earlier parts. */
static void add_part(Family *f, uint32_t k) {
    const RtScene *whole = f->b->scene;
    const RtTransform moved = f->b->transform;
    const uint32_t own = own_of(f->recipe, k), inner = inner_of(f->recipe, k);
    rt_build_begin_part(f->b);
    f->b->transform = rt_transform_identity();
    add_materials(f->b);
    if (k == 0)
        rt_build_box(f->b, rt_vec3d(-0.125, -0.125, -0.125), rt_vec3d(0.125, 0.125, 0.125), RT_SIDES_ALL);
    for (uint32_t i = 0; i < own; i++) {
        Placement at = placement_of(UNIFORM, &f->random, i, own);
        at.size *= 4;
        if (k == 2 && f->recipe->place != CONCENTRIC)
            add_tree(f, at, i);
        else
            add_mixed(f, at, i);
    }
    for (uint32_t i = 0; i < inner; i++) add_instance(f, f->b->scene, whole, i);
    f->b->transform = moved;
    rt_build_end_part(f->b);
}

/* ---- lights and cameras ---- */

/* Lights inside objects and on them, at vertices, between them, in a corner of the scene and far away. */
static void add_lights(RtSceneBuilder *b) {
    const RtGeometry *g = &b->scene->geometry;
    if (b->status != RT_OK) return;
    const RtSphere *sphere = &g->spheres[1];
    const RtVec3 at[] = {
        g->spheres[0].center, {{sphere->center.x + sphere->radius, sphere->center.y, sphere->center.z}},
        g->triangles[0].v[0], g->polygon_vertices[1],
        g->cones[0].base,     {{0, 0, 0}},
        {{1, -1, 1}},         {{-700, 300, 500}}};
    for (size_t i = 0; i < sizeof at / sizeof at[0]; i++)
        rt_build_light(b, rt_widen(at[i]), rt_vec3(0.2f, 0.2f, 0.2f));
}

/* The eye at the origin, with objects on all sides. With an odd number of sample columns or rows, the
 * middle one looks along a coordinate plane. */
static void add_eye(RtSceneBuilder *b) {
    b->scene->camera.from = rt_vec3(0, 0, 0);
    b->scene->camera.at = rt_vec3(0, 1, 0);
    b->scene->camera.up = rt_vec3(0, 0, 1);
    rt_build_light(b, rt_vec3d(0, 0, 0), rt_vec3(1, 1, 1));
}

/* ---- the families ---- */

/* X(name, count, make, place, scale, offset, scaling, around), in the order of the random streams. */
#define RECIPES(X)                                                                                           \
    X("empty", 0, SPHERES, UNIFORM, 1, 0, GIVEN, CAMERA)                                                     \
    X("one-sphere", 1, SPHERES, UNIFORM, 1, 0, GIVEN, CAMERA)                                                \
    X("one-triangle", 1, TRIANGLES, UNIFORM, 1, 0, GIVEN, CAMERA)                                            \
    X("two", 2, ROUND_AND_FLAT, UNIFORM, 1, 0, GIVEN, CAMERA)                                                \
    X("coincident", 33, SPHERES, COINCIDENT, 1, 0, GIVEN, CAMERA)                                            \
    X("line", 64, ROUND_AND_FLAT, ON_A_LINE, 1, 0, GIVEN, CAMERA)                                            \
    X("plane", 96, AXIS_ALIGNED, IN_A_PLANE, 1, 0, GIVEN, CAMERA)                                            \
    X("huge-beside-tiny", 96, ROUND_AND_FLAT, HUGE_BESIDE_TINY, 1, 0, GIVEN, CAMERA)                         \
    X("uniform", 150, SPHERES, UNIFORM, 1, 0, GIVEN, CAMERA)                                                 \
    X("clustered", 160, ROUND_AND_FLAT, CLUSTERED, 1, 0, GIVEN, CAMERA)                                      \
    X("mixed", 160, ROUND_AND_FLAT, UNIFORM, 1, 0, GIVEN, CAMERA)                                            \
    X("soup", 200, TRIANGLES, UNIFORM, 1, 0, GIVEN, CAMERA)                                                  \
    X("duplicates", 120, SPHERES, DUPLICATED, 1, 0, GIVEN, CAMERA)                                           \
    X("axis-aligned", 100, AXIS_ALIGNED, ON_A_LATTICE, 1, 0, GIVEN, CAMERA)                                  \
    X("csg", 48, TREES, UNIFORM, 1, 0, GIVEN, CAMERA)                                                        \
    X("csg-coincident", 12, TREES, COINCIDENT, 1, 0, GIVEN, CAMERA)                                          \
    X("csg-tiny", 24, TREES, UNIFORM, 0x1p-30, 0, GIVEN, CAMERA)                                             \
    X("csg-far", 24, TREES, UNIFORM, 1, 1e5, GIVEN, CAMERA)                                                  \
    X("mesh", 5, MESH, UNIFORM, 1, 0, GIVEN, CAMERA)                                                         \
    X("mesh-far", 5, MESH, UNIFORM, 1, 1e5, GIVEN, CAMERA)                                                   \
    X("mixed-tiny", 100, ROUND_AND_FLAT, UNIFORM, 0x1p-30, 0, GIVEN, CAMERA)                                 \
    X("mixed-huge", 100, ROUND_AND_FLAT, UNIFORM, 0x1p30, 0, GIVEN, CAMERA)                                  \
    X("mixed-far", 100, ROUND_AND_FLAT, UNIFORM, 1, 1e5, GIVEN, CAMERA)                                      \
    X("slivers", 150, SLIVERS, UNIFORM, 1, 0, GIVEN, CAMERA)                                                 \
    X("shared", 100, SHARED, UNIFORM, 1, 0, GIVEN, CAMERA)                                                   \
    X("touching", 150, SPHERES, TOUCHING, 1, 0, GIVEN, CAMERA)                                               \
    X("scaled", 100, ROUND_AND_FLAT, UNIFORM, 1, 0, DRAWN_SCALE, CAMERA)                                     \
    X("scaled-far", 100, ROUND_AND_FLAT, UNIFORM, 1, 0, DRAWN_SCALE_AND_OFFSET, CAMERA)                      \
    X("slivers-scaled", 100, SLIVERS, UNIFORM, 1, 0, DRAWN_SCALE, CAMERA)                                    \
    X("needles", 60, NEEDLES, UNIFORM, 1, 0, GIVEN, CAMERA)                                                  \
    X("progression", 60, ROUND_AND_FLAT, IN_PROGRESSION, 1, 0, GIVEN, CAMERA)                                \
    X("concentric", 200, AXIS_ALIGNED, CONCENTRIC, 1, 0, GIVEN, CAMERA)                                      \
    X("stacked", 40, AXIS_ALIGNED, STACKED, 1, 0, GIVEN, CAMERA)                                             \
    X("lit-within", 60, ROUND_AND_FLAT, UNIFORM, 1, 0, GIVEN, LIGHTS)                                        \
    X("eye-within", 80, AXIS_ALIGNED, AROUND_THE_ORIGIN, 1, 0, GIVEN, EYE)                                   \
    X("eye-among", 80, ROUND_AND_FLAT, AROUND_THE_ORIGIN, 1, 0, GIVEN, EYE)                                  \
    X("instanced", 8, INSTANCED, UNIFORM, 1, 0, GIVEN, CAMERA)                                               \
    X("instanced-far", 8, INSTANCED, UNIFORM, 1, 1e5, GIVEN, CAMERA)                                         \
    X("instanced-side-by-side", 0, INSTANCED, ON_A_LATTICE, 1, 0, GIVEN, CAMERA)                             \
    X("instanced-coincident", 8, INSTANCED, COINCIDENT, 1, 0, GIVEN, CAMERA)                                 \
    X("instanced-nested", 2, INSTANCED, CONCENTRIC, 1, 0, GIVEN, CAMERA)                                     \
    X("instanced-stretched", 4, INSTANCED, HUGE_BESIDE_TINY, 1, 0, GIVEN, CAMERA)                            \
    X("instanced-mirrored", 8, INSTANCED, AROUND_THE_ORIGIN, 1, 0, GIVEN, CAMERA)

#define AS_RECIPE(...)       {__VA_ARGS__},
#define AS_CHOICE(name, ...) "|" name
static const Recipe recipes[] = {RECIPES(AS_RECIPE)};

/* The choices without the first bar. */
#define PARAMS(X)                                                                                            \
    X(SEED, RT_BUILTIN_SEED)                                                                                 \
    X(KIND, "kind", RT_PARAM_CHOICE, "mixed", 0, 0, &RECIPES(AS_CHOICE)[1], "mixed", "why it is hard", "any")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

static void set_transform(Family *f) {
    const Recipe *recipe = f->recipe;
    double scale = recipe->scale, o = recipe->offset;
    if (recipe->scaling != GIVEN) scale = ldexp(1, (int)(rt_random_below(&f->random, 81)) - 40);
    if (recipe->scaling == DRAWN_SCALE_AND_OFFSET) o = ldexp(scale, (int)(rt_random_below(&f->random, 17)));
    f->b->transformed = true;
    f->b->transform = (RtTransform){{{scale, 0, 0, o}, {0, scale, 0, o}, {0, 0, scale, o}}};
}

static uint64_t object_count(const RtValue *values) {
    const Recipe *recipe = &recipes[values[KIND].choice];
    const uint64_t n = recipe->count;
    if (recipe->make == MESH) return 8 * n * n;
    if (recipe->make == INSTANCED) {
        const Instancing of = instancing(recipe);
        uint64_t all = n + 12 + of.instances; /* with the cube's triangles */
        for (uint32_t k = 0; k < of.parts; k++) all += own_of(recipe, k) + inner_of(recipe, k);
        return all;
    }
    return recipe->make == AXIS_ALIGNED ? n + (n + 1) / 2 : n; /* every other one is two triangles */
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    uint32_t kind = values[KIND].choice;
    const Recipe *recipe = &recipes[kind];
    Family f = {.recipe = recipe, .b = b, .random = rt_random((uint64_t)values[SEED].i, kind)};
    set_transform(&f);
    b->scene->camera.width = 40;
    b->scene->camera.height = 30;
    if (recipe->make == INSTANCED)
        add_materials(b);
    else
        rt_build_material(b, rt_default_material());
    const Instancing of = recipe->make == INSTANCED ? instancing(recipe) : (Instancing){0};
    for (uint32_t k = 0; k < of.parts; k++) add_part(&f, k);
    if (recipe->make == MESH) add_mesh(&f, recipe->count);
    for (uint32_t i = 0; recipe->make != MESH && i < recipe->count; i++) add_object(&f, i);
    for (uint32_t i = 0; i < of.instances; i++) add_instance(&f, b->scene, b->scene, i);
    if (recipe->around == LIGHTS) add_lights(b);
    if (recipe->around == EYE) add_eye(b);
}

const RtBuiltin rt_builtin_family = {
    .name = "family",
    .summary = "small scenes that are hard for accelerators, each with an image of a thousand pixels",
    .source = "random, each kind with its own random numbers: surfaces that rays graze, touch or cannot "
              "distinguish",
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .bytes_each = 1 << 16, /* generous: there are few objects, but trees and meshes are large */
    .generate = generate,
};

/* ---- all of them ---- */

size_t rt_family_count(void) {
    return sizeof recipes / sizeof recipes[0];
}

const char *rt_family_name(size_t family) {
    return recipes[family].name;
}

void rt_family_spec(size_t family, uint64_t seed, char spec[RT_MAX_SPEC_CHARS]) {
    snprintf(spec, RT_MAX_SPEC_CHARS, "family:kind=%s,seed=%" PRIu64, recipes[family].name, seed);
}
