/* SPDX-License-Identifier: Apache-2.0 */
/* random: n objects in the cube from -1 to 1, uniformly, in clusters, or placed to be hard on accelerators:
 * all in one place, on a line, in a plane, huge beside tiny.
 *
 * Object i depends only on random stream i, not on earlier objects. Sizes are in units of the mean spacing
 * (edge of the cube over the cube root of n), so the density of the scene is the same for any n. In
 * clusters, the distance from a centre along each axis is the sum of four uniform numbers: nearly a normal
 * distribution, without a logarithm. */
#include "core/base/elementary.h"
#include "scenes/builtin.h"

enum { UNIFORM, CLUSTERED, COINCIDENT, LINE, PLANE, STADIUM };
enum { SPHERES, TRIANGLES, MIXED };

#define PARAMS(X)                                                                                            \
    X(N, "n", RT_INT("1000", 0, RT_MAX_OBJECTS, "0|1|2|100|5000"), "objects", "small enough to see")         \
    X(DISTRIBUTION, "distribution", RT_CHOICE("uniform", "uniform|clustered|coincident|line|plane|stadium"), \
      "placement of the objects; coincident: all equal and in one place; line: in a row; plane: flat "       \
      "objects coplanar; stadium: tiny objects around the origin, every eighth huge",                        \
      "the usual case")                                                                                      \
    X(SHAPE, "shape", RT_CHOICE("sphere", "sphere|triangle|mixed"),                                          \
      "their shape; mixed: spheres, polygons, triangles and cones in turn", "the simplest")                  \
    X(SEED, RT_BUILTIN_SEED)                                                                                 \
    X(RADIUS, "radius", RT_FLOAT("0.25", 1e-6, 1e3, "0.25|2"), "mean radius of an object, in mean spacings", \
      "few objects overlap")                                                                                 \
    X(SPREAD, "spread", RT_FLOAT("0.5", 0, 0.999, "0|0.9"),                                                  \
      "radii differ from the mean by up to this fraction of it",                                             \
      "a ratio of 3 between largest and smallest")                                                           \
    X(CLUSTERS, "clusters", RT_INT("16", 1, 1e6, "16"), "number of clusters, for distribution=clustered",    \
      "enough to leave empty space")                                                                         \
    X(WIDTH, "width", RT_FLOAT("0.1", 1e-6, 1, "0.1"),                                                       \
      "standard deviation of a cluster along each axis, for distribution=clustered",                         \
      "a twentieth of the cube")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

/* Streams of cluster centres follow those of objects. */
#define CLUSTER_STREAM (UINT64_C(1) << 32)

static RtVec3d point_in_cluster(RtRandom *random, const RtValue *values) {
    uint64_t chosen = rt_random_bits(random) % (uint64_t)values[CLUSTERS].i;
    RtRandom of_cluster = rt_random(random->seed, CLUSTER_STREAM + chosen);
    RtVec3d center = rt_random_in_cube(&of_cluster);
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
    case PLANE: p = rt_random_in_cube(random); return rt_vec3d(p.x, p.y, 0.5);
    case STADIUM: p = rt_random_in_cube(random); return is_huge(i) ? p : rt_scaled(p, stadium_scale[0]);
    default: return rt_random_in_cube(random);
    }
}

/* ---- objects ---- */

typedef struct Object {
    RtSceneBuilder *b;
    RtRandom random;
    bool flat; /* in a plane of constant z */
    RtVec3d center;
    double radius;
} Object;

static RtVec3d direction(Object *o) {
    RtVec3d d = rt_random_direction(&o->random);
    return o->flat ? rt_normalized(rt_vec3d(d.x, d.y, 0)) : d;
}

static void add_triangle(Object *o) {
    RtVec3d v[3];
    for (int i = 0; i < 3; i++) v[i] = rt_add_scaledd(o->center, direction(o), o->radius);
    rt_build_triangle(o->b, v[0], v[1], v[2]);
}

/* A concave arrow head. */
static void add_polygon(Object *o) {
    static const double u[4] = {1, -0.7, -0.2, -0.7}, v[4] = {0, 0.7, 0, -0.7};
    RtVec3d along = direction(o), other = {0, 0, 0};
    other.at[o->flat ? 2 : rt_major_axis(rt_narrow(along)) == 0] = 1; /* an axis that `along` is not near */
    RtVec3d across = rt_normalized(rt_crossd(along, other)), vertices[4];
    for (int i = 0; i < 4; i++) {
        RtVec3d on_axis = rt_add_scaledd(o->center, along, u[i] * o->radius);
        vertices[i] = rt_add_scaledd(on_axis, across, v[i] * o->radius);
    }
    rt_build_polygon(o->b, vertices, 4);
}

static void add_cone(Object *o) {
    RtVec3d half = rt_scaled(direction(o), o->radius);
    float base_radius = (float)(o->radius / 2), apex_radius = base_radius * rt_random_unit(&o->random);
    rt_build_cone(o->b, rt_subd(o->center, half), (double)base_radius, rt_addd(o->center, half),
                  (double)apex_radius);
}

static void add_object(RtSceneBuilder *b, uint64_t i, double mean_radius, const RtValue *values) {
    uint32_t distribution = values[DISTRIBUTION].choice, shape = values[SHAPE].choice;
    Object o = {.b = b,
                .random = rt_random((uint64_t)values[SEED].i, distribution == COINCIDENT ? 0 : i),
                .flat = distribution == PLANE};
    o.center = center_of(i, &o.random, values);
    double deviation = 2 * (double)rt_random_unit(&o.random) - 1;
    o.radius = mean_radius * (1 + values[SPREAD].f * deviation);
    if (distribution == STADIUM) o.radius *= stadium_scale[is_huge(i)];
    b->material = (uint32_t)(i / 4 % RT_STUDIO_MATERIALS);
    if (shape == SPHERES || (shape == MIXED && i % 4 == 0)) rt_build_sphere(b, o.center, o.radius);
    if (shape == MIXED && i % 4 == 1) add_polygon(&o);
    if (shape == TRIANGLES || (shape == MIXED && i % 4 == 2)) add_triangle(&o);
    if (shape == MIXED && i % 4 == 3) add_cone(&o);
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

static uint64_t object_bytes(const RtValue *values) {
    return values[SHAPE].choice == TRIANGLES ? RT_BUILTIN_TRIANGLE_BYTES : RT_BUILTIN_OBJECT_BYTES;
}

static void generate(RtSceneBuilder *b, const RtValue *values) {
    rt_build_studio(b, true);
    /* Rounded to float32, because published counts were made with these sizes. */
    double mean_radius = (double)(float)(values[RADIUS].f * mean_spacing(values));
    for (uint64_t i = 0; i < (uint64_t)values[N].i && b->status == RT_OK; i++)
        add_object(b, i, mean_radius, values);
}

const RtBuiltin rt_builtin_random = {
    .name = "random",
    .summary = "n random objects, uniform, clustered or degenerate, in four materials",
    .source = "made for tests",
    RT_PARAMS_OF(params),
    .object_count = object_count,
    .object_bytes = object_bytes,
    .generate = generate,
};
