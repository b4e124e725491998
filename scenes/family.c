/* SPDX-License-Identifier: Apache-2.0 */
/* The families of scenes. One recipe a row: how many objects of which shapes, where, how large, and how the
 * whole is scaled and moved. */
#include "scenes/family.h"

#include "scenes/builtin.h"
#include "scenes/family_places.h"
#include "scenes/random_tree.h"

#include <inttypes.h>
#include <stdio.h>

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
    MAKE_COUNT
} Make;

/* How the whole is scaled and moved: scale * p + (offset, offset, offset). Or, where the seed draws it, by
 * 2^k for a k of -40..40; and then moved by 2^0..2^16 times its scale. */
typedef enum Scaling { GIVEN, DRAWN_SCALE, DRAWN_SCALE_AND_OFFSET } Scaling;

/* What stands around the objects; otherwise a camera that sees them all, with a light beside it. */
typedef enum Around { CAMERA, LIGHTS, EYE } Around;

typedef struct Recipe {
    const char *name;
    uint32_t count;
    Make make;
    RtPlacement *place;
    double scale, offset;
    Scaling scaling;
    Around around;
} Recipe;

/* ---- objects ---- */

typedef struct Builder {
    const Recipe *recipe;
    RtScene *scene;
    uint32_t material;
    RtRandom random;
    double scale, offset;
} Builder;

static RtVec3 placed(const Builder *b, RtVec3d p) {
    double o = b->offset;
    return rt_narrow(rt_add_scaledd(rt_vec3d(o, o, o), p, b->scale));
}

static RtStatus add_sphere(Builder *b, RtPlace at, RtError *error) {
    float radius = (float)(at.size * b->scale);
    return rt_scene_add_sphere(b->scene, b->material, placed(b, at.center), radius, error);
}

static RtStatus add_triangle(Builder *b, RtPlace at, RtError *error) {
    RtVec3 v[3];
    for (int i = 0; i < 3; i++) v[i] = placed(b, rt_add_scaledd(at.center, rt_in_cube(&b->random), at.size));
    return rt_scene_add_triangle(b->scene, b->material, v, NULL, error);
}

/* Slivers, needles and triangles without area, among whole ones. */
static RtStatus add_sliver(Builder *b, RtPlace at, uint32_t i, RtError *error) {
    static const double thin[] = {1e-3, 1e-5, 1e-7, 1e-9};
    RtVec3d p[3];
    for (int k = 0; k < 3; k++) p[k] = rt_add_scaledd(at.center, rt_in_cube(&b->random), at.size);
    RtVec3d along = rt_subd(p[1], p[0]), aside = rt_scaled(rt_in_cube(&b->random), at.size * thin[i / 6 % 4]);
    switch (i % 6) {
    case 0: p[2] = rt_addd(rt_add_scaledd(p[0], along, rt_random_betweend(&b->random, 0, 1)), aside); break;
    case 1: p[2] = rt_addd(p[1], aside); break;
    case 2: p[2] = rt_add_scaledd(p[0], along, 0.5); break; /* in a line, or nearly so */
    case 3: p[2] = p[1]; break;
    case 4: p[1] = p[2] = p[0]; break;
    default: break;
    }
    const RtVec3 v[3] = {placed(b, p[0]), placed(b, p[1]), placed(b, p[2])};
    return rt_scene_add_triangle(b->scene, b->material, v, NULL, error);
}

/* Triangles around one edge, like the leaves of a book, and around one vertex. */
static RtStatus add_shared(Builder *b, uint32_t i, RtError *error) {
    RtVec3d p[3] = {{0.1, -0.7, 0.3}, {-0.2, 0.6, 0.4}, rt_in_cube(&b->random)};
    if (i % 2) p[1] = rt_in_cube(&b->random);
    const RtVec3 v[3] = {placed(b, p[i % 3]), placed(b, p[(i + 1) % 3]), placed(b, p[(i + 2) % 3])};
    return rt_scene_add_triangle(b->scene, b->material, v, NULL, error);
}

/* An L in the plane of u and v: concave, six vertices. */
static RtStatus add_ell(Builder *b, RtPlace at, RtVec3d u, RtVec3d v, RtError *error) {
    static const double outline[6][2] = {{-1, -1}, {1, -1}, {1, 0}, {0, 0}, {0, 1}, {-1, 1}};
    RtVec3 vertices[6];
    for (int i = 0; i < 6; i++) {
        RtVec3d p = rt_add_scaledd(at.center, u, at.size * outline[i][0]);
        vertices[i] = placed(b, rt_add_scaledd(p, v, at.size * outline[i][1]));
    }
    return rt_scene_add_polygon(b->scene, b->material, vertices, 6, error);
}

static RtStatus add_polygon(Builder *b, RtPlace at, RtError *error) {
    /* In a plane that is exactly representable, so that offsets and scales do not warp it. */
    static const RtVec3d u[3] = {{1, 0, 0}, {0, 1, 0}, {1, 0, 0}};
    static const RtVec3d v[3] = {{0, 1, 0}, {0, 0, 1}, {0, 0, 1}};
    uint32_t plane = rt_random_below(&b->random, 3);
    return add_ell(b, at, u[plane], v[plane], error);
}

static RtStatus add_cone(Builder *b, RtPlace at, RtError *error) {
    RtVec3d axis = rt_random_direction(&b->random);
    double size = at.size * b->scale;
    float base = (float)(size * rt_random_betweend(&b->random, 0.2, 0.8));
    float apex = rt_random_below(&b->random, 2) ? base : 0; /* a cylinder or a full cone */
    return rt_scene_add_cone(b->scene, b->material, placed(b, at.center), base,
                             placed(b, rt_add_scaledd(at.center, axis, at.size)), apex, error);
}

/* A rectangle in a coordinate plane: as two triangles or as a polygon. */
static RtStatus add_axis_aligned(Builder *b, RtPlace at, uint32_t i, RtError *error) {
    int w = (int)(rt_random_below(&b->random, 3)), u = (w + 1) % 3, v = (w + 2) % 3;
    RtVec3 corner[4];
    for (int k = 0; k < 4; k++) {
        RtVec3d p = at.center;
        p.at[u] += k == 1 || k == 2 ? at.size : -at.size;
        p.at[v] += k >= 2 ? at.size : -at.size;
        corner[k] = placed(b, p);
    }
    if (i % 2) return rt_scene_add_polygon(b->scene, b->material, corner, 4, error);
    const RtVec3 halves[2][3] = {{corner[0], corner[1], corner[2]}, {corner[0], corner[2], corner[3]}};
    RT_TRY(rt_scene_add_triangle(b->scene, b->material, halves[0], NULL, error));
    return rt_scene_add_triangle(b->scene, b->material, halves[1], NULL, error);
}

/* Across the whole world, in turn near each axis: a triangle, or a cylinder. */
static RtStatus add_needle(Builder *b, RtPlace at, uint32_t i, RtError *error) {
    RtVec3d from = at.center, to = rt_add_scaledd(at.center, rt_in_cube(&b->random), at.size);
    from.at[i % 3] = -1;
    to.at[i % 3] = 1;
    float radius = (float)(at.size * b->scale / 64);
    if (i / 3 % 2) {
        return rt_scene_add_cone(b->scene, b->material, placed(b, from), radius, placed(b, to), radius,
                                 error);
    }
    RtVec3d aside = rt_add_scaledd(to, rt_in_cube(&b->random), at.size / 32);
    const RtVec3 v[3] = {placed(b, from), placed(b, to), placed(b, aside)};
    return rt_scene_add_triangle(b->scene, b->material, v, NULL, error);
}

static RtStatus add_round_or_flat(Builder *b, RtPlace at, uint32_t i, RtError *error) {
    switch (i % 4) {
    case 0: return add_sphere(b, at, error);
    case 1: return add_triangle(b, at, error);
    case 2: return add_polygon(b, at, error);
    default: return add_cone(b, at, error);
    }
}

/* A random CSG tree of up to 24 solids; the first of every eight is a lone one. With and without tests of
 * inner nodes by turns. RT_BAD_INPUT if one of its solids is flat where rounding puts it. */
static RtStatus try_tree(Builder *b, RtPlace at, uint32_t i, RtError *error) {
    RtTreeRecipe recipe = {i % 8 == 0 ? 1 : 2 + rt_random_below(&b->random, 23), i % 2};
    double o = b->offset, scale = b->scale, size = scale * at.size / 4;
    RtTransform move = {{{size, 0, 0, o + scale * at.center.x},
                         {0, size, 0, o + scale * at.center.y},
                         {0, 0, size, o + scale * at.center.z}}};
    RtCsgBuilder trees = {0};
    RtCsgTerm root;
    RtStatus status = rt_random_tree(&trees, &b->random, &recipe, 1, &root, error);
    if (status == RT_OK) status = rt_csg_move(&trees, root, &move, &root, error);
    if (status == RT_OK) status = rt_scene_add_csg(b->scene, &trees, root, i / 2 % 2 == 0, error);
    rt_csg_builder_clear(&trees);
    return status;
}

/* The next tree that is not flat. */
static RtStatus add_tree(Builder *b, RtPlace at, uint32_t i, RtError *error) {
    RtStatus status = RT_BAD_INPUT;
    for (int tries = 0; tries < 100 && status == RT_BAD_INPUT; tries++) status = try_tree(b, at, i, error);
    return status;
}

/* A closed mesh: an octahedron, each face cut into n x n triangles, its vertices pushed out to the sphere.
 * Neighbours share their vertices bit for bit. */
static RtStatus add_mesh(Builder *b, uint32_t n, RtError *error) {
    for (uint32_t face = 0; face < 8; face++) {
        RtVec3d sign = {face & 1 ? -1 : 1, face & 2 ? -1 : 1, face & 4 ? -1 : 1};
        for (uint32_t i = 0; i < n; i++) {
            for (uint32_t j = 0; j + i < n; j++) {
                const uint32_t at[4][2] = {{i, j}, {i + 1, j}, {i, j + 1}, {i + 1, j + 1}};
                RtVec3 v[4];
                for (int k = 0; k < 4; k++) {
                    double x = at[k][0], y = at[k][1], z = (double)n - x - y;
                    RtVec3d p = rt_normalized(rt_vec3d(x * sign.x, y * sign.y, z * sign.z));
                    v[k] = placed(b, p);
                }
                RT_TRY(rt_scene_add_triangle(b->scene, b->material, v, NULL, error));
                if (i + j + 1 == n) continue;
                RT_TRY(rt_scene_add_triangle(b->scene, b->material, v + 1, NULL, error));
            }
        }
    }
    return RT_OK;
}

static RtStatus add_object(Builder *b, uint32_t i, RtError *error) {
    RtPlace at = b->recipe->place(&b->random, i, b->recipe->count);
    switch (b->recipe->make) {
    case SPHERES: return add_sphere(b, at, error);
    case TRIANGLES: return add_triangle(b, at, error);
    case SLIVERS: return add_sliver(b, at, i, error);
    case SHARED: return add_shared(b, i, error);
    case ROUND_AND_FLAT: return add_round_or_flat(b, at, i, error);
    case AXIS_ALIGNED: return add_axis_aligned(b, at, i, error);
    case TREES: return add_tree(b, at, i, error);
    case NEEDLES: return add_needle(b, at, i, error);
    case MESH:
    case MAKE_COUNT: break;
    }
    return RT_OK;
}

/* ---- what stands around them ---- */

/* Lights within objects and on them, at vertices, among them, in a corner of the world and far from it. */
static RtStatus add_lights(Builder *b, RtError *error) {
    const RtGeometry *g = &b->scene->geometry;
    const RtSphere *sphere = &g->spheres[1];
    const RtVec3 at[] = {
        g->spheres[0].center, {{sphere->center.x + sphere->radius, sphere->center.y, sphere->center.z}},
        g->triangles[0].v[0], g->polygon_vertices[1],
        g->cones[0].base,     {{0, 0, 0}},
        {{1, -1, 1}},         {{-700, 300, 500}}};
    for (size_t i = 0; i < sizeof at / sizeof at[0]; i++) {
        RT_TRY(rt_scene_add_light(b->scene, at[i], (RtVec3){{0.2f, 0.2f, 0.2f}}, error));
    }
    return RT_OK;
}

/* The eye at the origin, with objects on all its sides. Of an odd number of columns or rows of samples the
 * middle one looks along a plane of coordinates. */
static RtStatus add_eye(Builder *b, RtError *error) {
    b->scene->camera.from = (RtVec3){{0, 0, 0}};
    b->scene->camera.at = (RtVec3){{0, 1, 0}};
    b->scene->camera.up = (RtVec3){{0, 0, 1}};
    return rt_scene_add_light(b->scene, (RtVec3){{0, 0, 0}}, (RtVec3){{1, 1, 1}}, error);
}

/* ---- the families ---- */

/* X(name, count, make, place, scale, offset, scaling, around): in the order of the streams of their random
 * numbers.
 */
#define RECIPES(X)                                                                                           \
    X("empty", 0, SPHERES, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                            \
    X("one-sphere", 1, SPHERES, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                       \
    X("one-triangle", 1, TRIANGLES, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                   \
    X("two", 2, ROUND_AND_FLAT, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                       \
    X("coincident", 33, SPHERES, rt_place_coincident, 1, 0, GIVEN, CAMERA)                                   \
    X("line", 64, ROUND_AND_FLAT, rt_place_on_a_line, 1, 0, GIVEN, CAMERA)                                   \
    X("plane", 96, AXIS_ALIGNED, rt_place_in_a_plane, 1, 0, GIVEN, CAMERA)                                   \
    X("huge-beside-tiny", 96, ROUND_AND_FLAT, rt_place_huge_beside_tiny, 1, 0, GIVEN, CAMERA)                \
    X("uniform", 150, SPHERES, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                        \
    X("clustered", 160, ROUND_AND_FLAT, rt_place_clustered, 1, 0, GIVEN, CAMERA)                             \
    X("mixed", 160, ROUND_AND_FLAT, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                   \
    X("soup", 200, TRIANGLES, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                         \
    X("duplicates", 120, SPHERES, rt_place_duplicated, 1, 0, GIVEN, CAMERA)                                  \
    X("axis-aligned", 100, AXIS_ALIGNED, rt_place_on_a_lattice, 1, 0, GIVEN, CAMERA)                         \
    X("csg", 48, TREES, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                               \
    X("csg-coincident", 12, TREES, rt_place_coincident, 1, 0, GIVEN, CAMERA)                                 \
    X("csg-tiny", 24, TREES, rt_place_uniform, 0x1p-30, 0, GIVEN, CAMERA)                                    \
    X("csg-far", 24, TREES, rt_place_uniform, 1, 1e5, GIVEN, CAMERA)                                         \
    X("mesh", 5, MESH, NULL, 1, 0, GIVEN, CAMERA)                                                            \
    X("mesh-far", 5, MESH, NULL, 1, 1e5, GIVEN, CAMERA)                                                      \
    X("mixed-tiny", 100, ROUND_AND_FLAT, rt_place_uniform, 0x1p-30, 0, GIVEN, CAMERA)                        \
    X("mixed-huge", 100, ROUND_AND_FLAT, rt_place_uniform, 0x1p30, 0, GIVEN, CAMERA)                         \
    X("mixed-far", 100, ROUND_AND_FLAT, rt_place_uniform, 1, 1e5, GIVEN, CAMERA)                             \
    X("slivers", 150, SLIVERS, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                        \
    X("shared", 100, SHARED, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                          \
    X("touching", 150, SPHERES, rt_place_touching, 1, 0, GIVEN, CAMERA)                                      \
    X("scaled", 100, ROUND_AND_FLAT, rt_place_uniform, 1, 0, DRAWN_SCALE, CAMERA)                            \
    X("scaled-far", 100, ROUND_AND_FLAT, rt_place_uniform, 1, 0, DRAWN_SCALE_AND_OFFSET, CAMERA)             \
    X("slivers-scaled", 100, SLIVERS, rt_place_uniform, 1, 0, DRAWN_SCALE, CAMERA)                           \
    X("needles", 60, NEEDLES, rt_place_uniform, 1, 0, GIVEN, CAMERA)                                         \
    X("progression", 60, ROUND_AND_FLAT, rt_place_in_progression, 1, 0, GIVEN, CAMERA)                       \
    X("concentric", 200, AXIS_ALIGNED, rt_place_concentric, 1, 0, GIVEN, CAMERA)                             \
    X("stacked", 40, AXIS_ALIGNED, rt_place_stacked, 1, 0, GIVEN, CAMERA)                                    \
    X("lit-within", 60, ROUND_AND_FLAT, rt_place_uniform, 1, 0, GIVEN, LIGHTS)                               \
    X("eye-within", 80, AXIS_ALIGNED, rt_place_around_the_origin, 1, 0, GIVEN, EYE)                          \
    X("eye-among", 80, ROUND_AND_FLAT, rt_place_around_the_origin, 1, 0, GIVEN, EYE)

#define AS_RECIPE(...)       {__VA_ARGS__},
#define AS_CHOICE(name, ...) "|" name
static const Recipe recipes[] = {RECIPES(AS_RECIPE)};

/* Of the choices without the first bar. */
#define PARAMS(X)                                                                                            \
    X(SEED, RT_BUILTIN_SEED)                                                                                 \
    X(KIND, "kind", RT_PARAM_CHOICE, "mixed", 0, 0, &RECIPES(AS_CHOICE)[1], "mixed",                         \
      "what is hard about it", "any")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

static RtStatus fill(Builder *b, RtError *error) {
    RtMaterial material = rt_default_material();
    RT_TRY(rt_scene_add_material(b->scene, &material, &b->material, error));
    if (b->recipe->make == MESH) {
        RT_TRY(add_mesh(b, b->recipe->count, error));
    } else {
        for (uint32_t i = 0; i < b->recipe->count; i++) RT_TRY(add_object(b, i, error));
    }
    if (b->recipe->around == LIGHTS) return add_lights(b, error);
    if (b->recipe->around == EYE) return add_eye(b, error);
    return RT_OK;
}

static void choose_scale(Builder *b) {
    const Recipe *recipe = b->recipe;
    b->scale = recipe->scale;
    b->offset = recipe->offset;
    if (recipe->scaling == GIVEN) return;
    b->scale = ldexp(1, (int)(rt_random_below(&b->random, 81)) - 40);
    if (recipe->scaling == DRAWN_SCALE_AND_OFFSET) {
        b->offset = ldexp(b->scale, (int)(rt_random_below(&b->random, 17)));
    }
}

static uint64_t object_count(const RtValue *values) {
    const Recipe *recipe = &recipes[values[KIND].choice];
    const uint64_t n = recipe->count;
    if (recipe->make == MESH) return 8 * n * n;
    return recipe->make == AXIS_ALIGNED ? n + (n + 1) / 2 : n; /* every other one is two triangles */
}

/* More than any takes: they are few, and trees and meshes are the largest. */
static uint64_t object_bytes(const RtValue *values) {
    (void)values;
    return UINT64_C(1) << 16;
}

static RtStatus generate(RtScene *scene, const RtValue *values, RtError *error) {
    uint32_t kind = values[KIND].choice;
    Builder builder = {
        .recipe = &recipes[kind], .scene = scene, .random = rt_random((uint64_t)values[SEED].i, kind)};
    choose_scale(&builder);
    scene->camera.width = 40;
    scene->camera.height = 30;
    return fill(&builder, error);
}

const RtBuiltin rt_builtin_family = {
    .name = "family",
    .summary = "small scenes that are hard on accelerators, an image of a thousand pixels each",
    .source = "random, each kind from a stream of its own: what rays graze, touch, or cannot tell apart",
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .object_bytes = object_bytes,
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
