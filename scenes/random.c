/* SPDX-License-Identifier: Apache-2.0 */
/* random: n objects in the cube from -1 to 1, uniformly, in clusters, or where they are hard on accelerators:
 * all in one place, on a line, in a plane, huge beside tiny.
 *
 * Object i is made from the random numbers of stream i alone, so it does not depend on what came before.
 * Sizes are in units of the mean spacing (edge of the cube over the cube root of n): the density of the scene
 * stays the same for any n. In clusters, the distance from a centre along each axis is the sum of four
 * uniform numbers: nearly a normal distribution, without a logarithm. */
#include "core/base/random.h"
#include "core/base/elementary.h"
#include "scenes/builtin.h"
#include "scenes/studio.h"

enum { UNIFORM, CLUSTERED, COINCIDENT, LINE, PLANE, STADIUM };
enum { SPHERES, TRIANGLES, MIXED };

#define PARAMS(X)                                                                                            \
    X(N, "n", RT_INT("1000", 0, RT_MAX_OBJECTS, "0|1|2|100|5000"), "objects", "small enough to see")         \
    X(DISTRIBUTION, "distribution", RT_CHOICE("uniform", "uniform|clustered|coincident|line|plane|stadium"), \
      "where the objects are: coincident: all in one place and alike; line: in a row; plane: flat ones "     \
      "coplanar; stadium: tiny ones about the origin, and every eighth huge",                                \
      "the usual case")                                                                                      \
    X(SHAPE, "shape", RT_CHOICE("sphere", "sphere|triangle|mixed"),                                          \
      "what they are; mixed: spheres, polygons, triangles and cones in turn", "the simplest")                \
    X(SEED, RT_BUILTIN_SEED)                                                                                 \
    X(RADIUS, "radius", RT_FLOAT("0.25", 1e-6, 1e3, "0.25|2"), "mean radius of an object, in mean spacings", \
      "few objects overlap")                                                                                 \
    X(SPREAD, "spread", RT_FLOAT("0.5", 0, 0.999, "0|0.9"),                                                  \
      "radii differ from the mean by up to this part of it", "a ratio of 3 between largest and smallest")    \
    X(CLUSTERS, "clusters", RT_INT("16", 1, 1e6, "16"), "number of clusters, for distribution=clustered",    \
      "enough to leave empty space")                                                                         \
    X(WIDTH, "width", RT_FLOAT("0.1", 1e-6, 1, "0.1"),                                                       \
      "standard deviation of a cluster along each axis, for distribution=clustered",                         \
      "a twentieth of the cube")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

/* Streams of cluster centres lie beyond those of objects. */
#define CLUSTER_STREAM (UINT64_C(1) << 32)

static RtVec3d point_in_cube(RtRandom *random) {
    RtVec3d p;
    for (int a = 0; a < 3; a++) p.at[a] = 2 * (double)rt_random_unit(random) - 1;
    return p;
}

static RtVec3d point_in_cluster(RtRandom *random, const RtValue *values) {
    uint64_t chosen = rt_random_bits(random) % (uint64_t)values[CLUSTERS].i;
    RtRandom of_cluster = rt_random(random->seed, CLUSTER_STREAM + chosen);
    RtVec3d center = point_in_cube(&of_cluster);
    for (int a = 0; a < 3; a++) {
        double sum = -2; /* four uniform numbers: mean 2, variance 4 / 12 */
        for (int i = 0; i < 4; i++) sum += (double)rt_random_unit(random);
        center.at[a] += sum * sqrt(3) * values[WIDTH].f;
    }
    return center;
}

/* In a stadium every eighth object is huge, and the others are tiny. */
static const double stadium_scale[2] = {0x1p-10, 4};

static bool is_huge(uint64_t i) {
    return i % 8 == 0;
}

static RtVec3d center_of(uint64_t i, RtRandom *random, const RtValue *values) {
    RtVec3d p;
    switch (values[DISTRIBUTION].choice) {
    case CLUSTERED: return point_in_cluster(random, values);
    case COINCIDENT: return rt_vec3d(0.25, 0.5, -0.125);
    case LINE: return rt_vec3d((2 * (double)i + 1) / (double)values[N].i - 1, 0.5, -0.125);
    case PLANE: p = point_in_cube(random); return rt_vec3d(p.x, p.y, 0.5);
    case STADIUM: p = point_in_cube(random); return is_huge(i) ? p : rt_scaled(p, stadium_scale[0]);
    default: return point_in_cube(random);
    }
}

/* ---- objects ---- */

/* What an object is made of. */
typedef struct Maker {
    RtScene *scene;
    RtRandom random;
    uint32_t material;
    bool flat; /* in a plane of constant z */
    RtVec3d center;
    double radius;
} Maker;

static RtVec3d direction(Maker *m) {
    RtVec3d d = rt_random_direction(&m->random);
    return m->flat ? rt_normalized(rt_vec3d(d.x, d.y, 0)) : d;
}

static RtStatus add_triangle(Maker *m, RtError *error) {
    RtVec3 vertices[3];
    for (int i = 0; i < 3; i++) {
        vertices[i] = rt_narrow(rt_add_scaledd(m->center, direction(m), m->radius));
    }
    return rt_scene_add_triangle(m->scene, m->material, vertices, NULL, error);
}

/* An arrow head: concave, so that the test for being inside has something to do. */
static RtStatus add_polygon(Maker *m, RtError *error) {
    static const double u[4] = {1, -0.7, -0.2, -0.7}, v[4] = {0, 0.7, 0, -0.7};
    RtVec3d along = direction(m);
    RtVec3d other = rt_vec3d(0, 0, 0);
    other.at[m->flat ? 2 : rt_major_axis(rt_narrow(along)) == 0] = 1; /* an axis that `along` is not near */
    RtVec3d across = rt_normalized(rt_crossd(along, other));
    RtVec3 vertices[4];
    for (int i = 0; i < 4; i++) {
        RtVec3d on_axis = rt_add_scaledd(m->center, along, u[i] * m->radius);
        vertices[i] = rt_narrow(rt_add_scaledd(on_axis, across, v[i] * m->radius));
    }
    return rt_scene_add_polygon(m->scene, m->material, vertices, 4, error);
}

static RtStatus add_cone(Maker *m, RtError *error) {
    RtVec3d half = rt_scaled(direction(m), m->radius);
    float base_radius = (float)(m->radius / 2), apex_radius = base_radius * rt_random_unit(&m->random);
    return rt_scene_add_cone(m->scene, m->material, rt_narrow(rt_subd(m->center, half)), base_radius,
                             rt_narrow(rt_addd(m->center, half)), apex_radius, error);
}

/* Not all shapes there are: what this scene is must not change when there are more. */
static const RtShape mixed[] = {RT_SHAPE_SPHERE, RT_SHAPE_POLYGON, RT_SHAPE_TRIANGLE, RT_SHAPE_CONE};

static RtStatus add_object(RtScene *scene, uint64_t i, double mean_radius, const RtValue *values,
                           RtError *error) {
    uint32_t distribution = values[DISTRIBUTION].choice;
    Maker m = {.scene = scene,
               .random = rt_random((uint64_t)values[SEED].i, distribution == COINCIDENT ? 0 : i),
               .material = (uint32_t)(i / 4 % scene->material_count),
               .flat = distribution == PLANE};
    m.center = center_of(i, &m.random, values);
    double deviation = 2 * (double)rt_random_unit(&m.random) - 1;
    m.radius = mean_radius * (1 + values[SPREAD].f * deviation);
    if (distribution == STADIUM) m.radius *= stadium_scale[is_huge(i)];
    RtShape shape = values[SHAPE].choice == MIXED       ? mixed[i % (sizeof mixed / sizeof mixed[0])]
                    : values[SHAPE].choice == TRIANGLES ? RT_SHAPE_TRIANGLE
                                                        : RT_SHAPE_SPHERE;
    switch (shape) {
    case RT_SHAPE_POLYGON: return add_polygon(&m, error);
    case RT_SHAPE_TRIANGLE: return add_triangle(&m, error);
    case RT_SHAPE_CONE: return add_cone(&m, error);
    case RT_SHAPE_SPHERE:
    case RT_SHAPE_CSG:
    case RT_SHAPE_COUNT: break;
    }
    return rt_scene_add_sphere(scene, m.material, rt_narrow(m.center), (float)m.radius, error);
}

/* On a line of length 2, in a square or in a cube of that edge. */
static double mean_spacing(const RtValue *values) {
    double n = fmax((double)values[N].i, 1);
    switch (values[DISTRIBUTION].choice) {
    case LINE: return 2 / n;
    case PLANE: return 2 / sqrt(n);
    default: return 2 / rt_cube_root(n);
    }
}

static uint64_t object_count(const RtValue *values) {
    return (uint64_t)values[N].i;
}

static RtStatus generate(RtScene *scene, const RtValue *values, RtError *error) {
    static const RtStudioMaterial materials[RT_STUDIO_MATERIALS] = {RT_STUDIO_CLAY, RT_STUDIO_SLATE,
                                                                    RT_STUDIO_STEEL, RT_STUDIO_GLASS};
    RT_TRY(rt_studio(scene, materials, error));
    /* As a float32, which it was while the cube root was the library's, so that scenes stay what they are. */
    double mean_radius = (double)(float)(values[RADIUS].f * mean_spacing(values));
    for (uint64_t i = 0; i < (uint64_t)values[N].i; i++) {
        RT_TRY(add_object(scene, i, mean_radius, values, error));
    }
    return RT_OK;
}

const RtBuiltin rt_builtin_random = {
    .name = "random",
    .summary = "n random objects, uniform, in clusters or in awkward places, in four materials",
    .source = "made for tests",
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .generate = generate,
};
