/* SPDX-License-Identifier: Apache-2.0 */
/* The Standard Procedural Databases: E. Haines, "A Proposal for Standard Graphics Environments", IEEE CG&A
 * 7(11), 1987, and its third release, which added jacks, lattice and shells; teapot.c has the teapot. Each
 * has one parameter, `size`. Colours, which the paper does not specify, and the order of objects are those of
 * the package's files. Points are computed in double with + - * / sqrt and core/base/elementary.h alone and
 * rounded once, so that every compiler and library produces the same float32. */
#include "core/base/elementary.h"
#include "scenes/builtin.h"

#define SPD_LATER_SOURCE "SPD: E. Haines, Standard Procedural Databases 3, later than the paper of 1987"

/* `v` rotated around the unit vector `axis`, counter-clockwise seen against it (Rodrigues). */
static RtVec3d rotate(RtVec3d v, RtVec3d axis, RtTurn turn) {
    RtVec3d turned = rt_add_scaledd(rt_scaled(v, turn.cosine), rt_crossd(axis, v), turn.sine);
    return rt_add_scaledd(turned, axis, rt_dotd(axis, v) * (1 - turn.cosine));
}

/* `v` under the shortest rotation that takes +Z to the unit vector `towards`. */
static RtVec3d rotate_from_z(RtVec3d v, RtVec3d towards) {
    double cosine = towards.z;
    if (cosine >= 0.9999) return v;
    if (cosine <= -0.9999) return rt_vec3d(-v.x, v.y, -v.z);
    RtTurn turn = {.cosine = cosine, .sine = sqrt(1 - cosine * cosine)};
    return rotate(v, rt_normalized(rt_vec3d(-towards.y, towards.x, 0)), turn);
}

/* Defines the built-in of generate_NAME; `most` is the largest size, `count` and `bytes` are object_count and
 * bytes_each. */
#define SPD_SCENE(scene, what, origin, count, bytes, standard, most, tested, meaning, why)                   \
    static const RtParam scene##_params[] = {{"size", RT_INT(standard, 1, most, tested), meaning, why}};     \
    const RtBuiltin rt_builtin_##scene = {.name = #scene,                                                    \
                                          .summary = what,                                                   \
                                          .source = origin,                                                  \
                                          RT_PARAMS_OF(scene##_params),                                      \
                                          .object_count = count,                                             \
                                          .bytes_each = bytes,                                               \
                                          .generate = generate_##scene};

/* balls: the sphereflake over a floor, 9^0 + ... + 9^size spheres and one polygon. Every sphere carries nine
 * of a third of its radius: six around its equator and three towards its tip. The root's tip is +Z, a child's
 * the direction in which it sits. Objects come depth first. As instances, a sphere and nine instances of the
 * level below are a part: it has as many spheres, but most of their directions differ, since the rotations
 * of the levels add up to other turns about them. All angles have known sines and cosines, so only
 * + - * / sqrt are used. */
enum { BALL_CHILDREN = 9 };

/* Unit directions of the children of a sphere that points to +Z. */
static void set_offsets(RtVec3d offsets[BALL_CHILDREN]) {
    double d = sqrt(0.5);
    const RtVec3d trio[3] = {{d, d, 0}, {d, 0, -d}, {0, d, -d}};
    const RtVec3d axis = {d, -d, 0}, z = {0, 0, 1};
    const RtTurn tilt = {.cosine = sqrt(1.0 / 3), .sine = sqrt(2.0 / 3)};
    const RtTurn thirds[3] = {{1, 0}, {-0.5, sqrt(0.75)}, {-0.5, -sqrt(0.75)}};
    for (int i = 0; i < BALL_CHILDREN; i++)
        offsets[i] = rotate(rotate(trio[i % 3], axis, tilt), z, thirds[i / 3]);
}

static void add_flake(RtSceneBuilder *b, const RtVec3d offsets[BALL_CHILDREN], RtVec3d center, double radius,
                      RtVec3d direction, int64_t levels) {
    rt_build_sphere(b, center, radius);
    for (int i = 0; levels > 0 && i < BALL_CHILDREN; i++) {
        RtVec3d towards = rotate_from_z(offsets[i], direction);
        RtVec3d child = rt_add_scaledd(center, towards, radius * (1 + 1.0 / 3));
        add_flake(b, offsets, child, radius / 3, towards, levels - 1);
    }
}

/* Part `level` is a flake of that many levels around the origin. */
static void make_flakes(RtSceneBuilder *b, const RtVec3d offsets[BALL_CHILDREN], RtMaterial material,
                        uint32_t levels) {
    const double radius = 0.5;
    for (uint32_t level = 0; level <= levels; level++) {
        rt_build_begin_part(b);
        rt_build_material(b, material);
        rt_build_sphere(b, rt_vec3d(0, 0, 0), radius);
        for (int i = 0; level > 0 && i < BALL_CHILDREN; i++) {
            RtTransform to_world;
            for (int a = 0; a < 3; a++) {
                RtVec3d axis = {a == 0, a == 1, a == 2}, image = rotate_from_z(axis, offsets[i]);
                for (int r = 0; r < 3; r++) to_world.m[r][a] = image.at[r] / 3;
                to_world.m[a][3] = offsets[i].at[a] * radius * (1 + 1.0 / 3);
            }
            rt_build_instance(b, level - 1, &to_world);
        }
        rt_build_end_part(b);
    }
}

enum { BALLS_SIZE, BALLS_INSTANCES };

static void generate_balls(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[3] = {{4, 3, 2}, {1, -4, 4}, {-3, 1, 5}};
    static const RtVec3d floor[4] = {{12, 12, -0.5}, {-12, 12, -0.5}, {-12, -12, -0.5}, {12, -12, -0.5}};
    RtVec3d offsets[BALL_CHILDREN];
    set_offsets(offsets);
    rt_build_lights(b, lights, 3);
    b->scene->camera.from = rt_vec3(2.1f, 1.3f, 1.7f);
    b->scene->camera.near = 0.01f;
    rt_build_material(b, rt_nff_material("floor", rt_vec3(1, 0.75f, 0.33f), 0.8f, 0, 100000, 0, 1));
    rt_build_polygon(b, floor, 4);
    const RtMaterial shiny = rt_nff_material("balls", rt_vec3(1, 0.9f, 0.7f), 0.5f, 0.5f, 3.0827f, 0, 1);
    const RtTransform identity = rt_transform_identity();
    const int64_t levels = values[BALLS_SIZE].i;
    b->flattened = values[BALLS_INSTANCES].choice == RT_INSTANCES_FLATTENED;
    rt_build_material(b, shiny);
    if (values[BALLS_INSTANCES].choice == RT_INSTANCES_OFF) {
        add_flake(b, offsets, rt_vec3d(0, 0, 0), 0.5, rt_vec3d(0, 0, 1), levels);
    } else {
        make_flakes(b, offsets, shiny, (uint32_t)levels);
        rt_build_instance(b, (uint32_t)levels, &identity);
    }
}

/* Parts have few objects, but all their arrays. */
static uint64_t balls_bytes(const RtValue *values) {
    return values[BALLS_INSTANCES].choice == RT_INSTANCES_ON ? 2048 : RT_BUILTIN_OBJECT_BYTES;
}

static const RtParam balls_params[] = {[BALLS_SIZE] = {"size", RT_INT("4", 1, 7, "1|3"),
                                                       "levels below the root: (9^(size+1) - 1) / 8 spheres",
                                                       "SPD: 7381 spheres"},
                                       [BALLS_INSTANCES] = {RT_BUILTIN_INSTANCES}};

const RtBuiltin rt_builtin_balls = {
    .name = "balls",
    .summary = "a sphereflake over a floor: reflective spheres of very different sizes, touching",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(balls_params),
    .object_bytes = balls_bytes,
    .generate = generate_balls,
};

/* gears: size^3 gears that mesh, some of glass, above a mirror. A gear has two faces, which are concave
 * polygons of four corners per tooth, and a rectangle under each edge between them. Angles are whole tenths
 * of a degree, so both faces have the same corners, bit for bit. */
enum { TEETH = 36, GEAR_CORNERS = 4 * TEETH, TOOTH = 3600 / TEETH }; /* TOOTH in tenths of a degree */

typedef struct Gear {
    RtVec3d center;
    int turn; /* tenths of a degree */
    double outer, inner, thickness;
} Gear;

static uint64_t gears_count(const RtValue *values) {
    uint64_t size = (uint64_t)values[0].i;
    return size * size * size * (GEAR_CORNERS + 2) + 1;
}

/* Counter-clockwise at the upper face, clockwise (`sense` -1) at the lower one. Each tooth has two corners at
 * its tip and two in the gap that follows. */
static void set_face(const Gear *gear, int sense, RtVec3d face[GEAR_CORNERS]) {
    static const int tenths[4] = {-19, 19, 30, 70};
    for (int i = 0; i < GEAR_CORNERS; i++) {
        int angle = gear->turn + sense * (i / 4 * TOOTH + tenths[i % 4]);
        RtTurn turn = rt_turn((angle + 3600) % 3600 / 10.0);
        double radius = i % 4 < 2 ? gear->outer : gear->inner;
        RtVec3d corner = {radius * turn.cosine, radius * turn.sine, sense < 0 ? -gear->thickness : 0};
        face[i] = rt_addd(corner, gear->center);
    }
}

static void add_gear(RtSceneBuilder *b, const Gear *gear) {
    RtVec3d upper[GEAR_CORNERS], lower[GEAR_CORNERS];
    set_face(gear, 1, upper);
    set_face(gear, -1, lower);
    rt_build_polygon(b, upper, GEAR_CORNERS);
    const double bottom = lower[0].z;
    for (int i = 0; i < GEAR_CORNERS; i++) {
        RtVec3d v = upper[i], w = upper[(i + 1) % GEAR_CORNERS];
        const RtVec3d side[4] = {v, {v.x, v.y, bottom}, {w.x, w.y, bottom}, w};
        rt_build_polygon(b, side, 4);
    }
    rt_build_polygon(b, lower, GEAR_CORNERS);
}

/* A varying hue whose largest component is 1. */
static RtVec3 gear_color(int64_t x, int64_t y, int64_t z) {
    double red = 0.01 + (double)((3 * x + 2 * y + z + 1) * 5 % 7) / 7;
    double green = 0.01 + (double)((3 * y + 2 * z + x + 1) * 3 % 7) / 7;
    double blue = 0.01 + (double)((3 * z + 2 * x + y + 1) * 2 % 7) / 7;
    double most = fmax(red, fmax(green, blue));
    return rt_narrow(rt_vec3d(red / most, green / most, blue / most));
}

static RtMaterial gear_material(int64_t x, int64_t y, int64_t z) {
    RtVec3 color = gear_color(x, y, z);
    if ((4 * x + 2 * y + z) % 5 != 0) return rt_nff_material("gear", color, 1, 0, 100000, 0, 1);
    RtMaterial glass = rt_nff_material("glass", color, 0.2f, 0, 100000, 0.8f, 1.1f);
    glass.reflection = 0.0023f; /* Fresnel's at normal incidence: ((1.1 - 1) / (1.1 + 1))^2 */
    return glass;
}

static void generate_gears(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[5] = {
        {2, 4, 4}, {-2, 4, 3}, {2, -2.5, 2.5}, {-1, -4, 2}, {-1.111f, -2.121f, 2.626f}};
    static const RtVec3d ground[4] = {{2, 2, 0}, {-2, 2, 0}, {-2, -2, 0}, {2, -2, 0}};
    rt_build_lights(b, lights, 5);
    b->scene->camera.from = rt_vec3(-1.1f, -2.1f, 2.6f);
    b->scene->camera.near = 1;
    rt_build_material(b, rt_nff_material("ground", rt_vec3(1, 0.85f, 0.7f), 0.3f, 0.6f, 3.0827f, 0, 1));
    rt_build_polygon(b, ground, 4);

    const int64_t size = values[0].i;
    const double count = (double)size, radius = 1 / (count - (count - 1) * 0.05);
    Gear gear = {.outer = 0.995 * radius, .inner = 0.9 * radius, .thickness = fmin(0.1, 1 / (2 * count))};
    for (int64_t i = 0; i < size * size * size; i++) {
        int64_t x = i % size, y = i / size % size, z = i / size / size;
        rt_build_material(b, gear_material(x, y, z));
        gear.center = rt_vec3d(radius - 1 + 1.9 * radius * (double)x, radius - 1 + 1.9 * radius * (double)y,
                               1 - (double)z / count);
        gear.turn = (x + y + z) % 2 == 1 ? TOOTH / 2 : 0;
        add_gear(b, &gear);
    }
}

SPD_SCENE(gears, "gears of concave polygons with 144 corners, some of glass, above a mirror", RT_SPD_SOURCE,
          gears_count, 384 /* a 73rd of them are faces of 144 corners */, "4", 100, "1|2",
          "gears along an edge: 146 size^3 + 1 polygons", "SPD: 9345 polygons")

/* jacks: jacks (three crossed cylinders with a sphere at each end) that carry smaller jacks between their
 * arms. Arms are 0.75 long; a jack has eight children of half its size, at the corners of the axis-aligned
 * cube with edges of 1 around it. Inferred from the numbers of the database: the axes are rotated by -20
 * degrees about Y and by -30 about X; all lengths; and the order of the files: depth first, cylinders before
 * spheres. */
#define JACK_ARM   0.75
#define ROD_RADIUS 0.075
#define END_RADIUS 0.15

/* Three cylinders, then six spheres at their ends. */
static void add_arms(RtSceneBuilder *b, const RtVec3d axes[3], RtVec3d center, double scale) {
    RtVec3d ends[2][3]; /* along the axes, and against them */
    for (int i = 0; i < 6; i++)
        ends[i / 3][i % 3] =
            rt_add_scaledd(center, axes[i % 3], i < 3 ? JACK_ARM * scale : -JACK_ARM * scale);
    for (int a = 0; a < 3; a++)
        rt_build_cone(b, ends[1][a], ROD_RADIUS * scale, ends[0][a], ROD_RADIUS * scale);
    for (int i = 0; i < 6; i++) rt_build_sphere(b, ends[i / 3][i % 3], END_RADIUS * scale);
}

static void add_jack(RtSceneBuilder *b, const RtVec3d axes[3], RtVec3d center, double scale, int64_t levels) {
    add_arms(b, axes, center, scale);
    for (int corner = 0; levels > 1 && corner < 8; corner++) {
        RtVec3d child = center;
        for (int a = 0; a < 3; a++)
            child = rt_add_scaledd(child, axes[a], corner >> (2 - a) & 1 ? scale / 2 : -scale / 2);
        add_jack(b, axes, child, scale / 2, levels - 1);
    }
}

static void generate_jacks(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[1] = {{-10, 3, -20}}, axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    RtCamera *camera = &b->scene->camera;
    rt_build_lights(b, lights, 1);
    b->scene->background = rt_vec3(0.2f, 0.05f, 0.2f);
    camera->from = rt_vec3(0, 0, -8);
    camera->up = rt_vec3(0, 1, 0);
    camera->fov = 25;
    camera->near = 0.001f;
    camera->width = camera->height = 256;
    rt_build_material(b,
                      rt_nff_material("jack", rt_vec3(0.737f, 0.561f, 0.561f), 0.7f, 0.7f, 11.1434f, 0, 1));
    RtVec3d turned[3];
    for (int a = 0; a < 3; a++) {
        turned[a] = rotate(axes[a], axes[1], rt_turn(-20));
        turned[a] = rotate(turned[a], axes[0], rt_turn(-30));
    }
    add_jack(b, turned, rt_vec3d(0, 0, 0), 1, values[0].i);
}

SPD_SCENE(jacks, "crossed cylinders with spheres at their ends, among smaller ones: mirrors that touch",
          SPD_LATER_SOURCE, NULL, 0, "3", 8, "1|2",
          "levels: (8^size - 1) / 7 jacks of 3 cylinders and 6 spheres", "SPD: 219 cylinders, 438 spheres")

/* lattice: a cube of (size + 1)^3 spheres, joined along the edges of the lattice by cylinders. The cube is
 * that from 0 to 1; the eye is half a spacing below its upper side. Cylinders reach from inside one sphere to
 * inside the next. A sphere comes before the cylinders to its upper neighbours. */
enum { JOINT, RODS }; /* materials; a rod has that of its axis */

static uint64_t lattice_count(const RtValue *values) {
    uint64_t size = (uint64_t)values[0].i, nodes = size + 1;
    return nodes * nodes * nodes + 3 * size * nodes * nodes;
}

static void add_node(RtSceneBuilder *b, const int64_t node[3], int64_t size) {
    const double spacing = 1 / (double)size, radius = 0.25 * spacing, rod_radius = 0.0625 * spacing;
    const double inset = 0.495 * radius; /* from a sphere's centre to where its cylinders begin */
    RtVec3d center;
    for (int a = 0; a < 3; a++) center.at[a] = (double)node[a] / (double)size;
    b->material = JOINT;
    rt_build_sphere(b, center, radius);
    for (uint32_t a = 0; a < 3; a++) {
        if (node[a] == size) continue;
        RtVec3d base = center, apex = center;
        base.at[a] += inset;
        apex.at[a] += spacing - inset;
        b->material = RODS + a;
        rt_build_cone(b, base, rod_radius, apex, rod_radius);
    }
}

static void generate_lattice(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[6] = {{2, 0.5, 0.5},  {-1, 0.5, 0.5}, {0.5, 2, 0.5},
                                      {0.5, -1, 0.5}, {0.5, 0.5, 2},  {0.5, 0.5, -1}};
    const int64_t size = values[0].i, nodes = size + 1;
    const double half = 0.5 / (double)size;
    RtCamera *camera = &b->scene->camera;
    rt_build_lights(b, lights, 6);
    camera->from = rt_narrow(rt_vec3d(0.5 + half, 1, 1 - half));
    camera->at = rt_narrow(rt_vec3d(0.5 + half, -1, -1 - half));
    camera->up = rt_vec3(0.2f, 1, 0);
    camera->fov = 60;
    rt_build_material(b, rt_nff_material("joint", rt_vec3(0.9f, 0.9f, 0.9f), 0.5f, 0.5f, 3.0827f, 0, 1));
    rt_build_material(b, rt_nff_material("rod x", rt_vec3(0.9f, 0.1f, 0.1f), 0.99f, 0, 100000, 0, 1));
    rt_build_material(b, rt_nff_material("rod y", rt_vec3(0.1f, 0.9f, 0.1f), 0.99f, 0, 100000, 0, 1));
    rt_build_material(b, rt_nff_material("rod z", rt_vec3(0.1f, 0.1f, 0.9f), 0.99f, 0, 100000, 0, 1));
    for (int64_t i = 0; i < nodes * nodes * nodes; i++)
        add_node(b, (const int64_t[3]){i / nodes / nodes, i / nodes % nodes, i % nodes}, size);
}

SPD_SCENE(lattice, "spheres at the points of a cubic lattice, and the cylinders between them",
          SPD_LATER_SOURCE, lattice_count, 0, "12", 400, "1|3",
          "cells along an edge: (size+1)^3 spheres, 3 size (size+1)^2 cylinders",
          "SPD: 2197 spheres, 6084 cylinders")

/* mount: a fractal mountain of 2 * 4^size triangles, seen through four spheres of glass; midpoint
 * displacement after A. Fournier, D. Fussell and L. Carpenter, CACM 25(6), 1982. Each level divides a square
 * into four; a new corner has the mean height of its neighbours plus a normal random number that depends on
 * its lattice position alone, so that adjacent squares fit. Above size 7 the random numbers of the database
 * are undefined (a shift by a negative amount); here the lattice coordinate is shifted the other way. */
/* A corner of a square: its place in the lattice of 2^size by 2^size squares, and its height. */
typedef struct MountCorner {
    uint32_t x, y;
    double z;
} MountCorner;

typedef struct Mount {
    RtSceneBuilder *b;
    uint32_t size;
} Mount;

/* A normal random number that `seed` determines: Marsaglia's polar method over a linear congruential
 * generator. No two numbers of that generator in a row are 0, so `square` is not. */
static double normal_random(uint32_t seed) {
    uint32_t number = seed;
    double v[2], square;
    do {
        for (int i = 0; i < 2; i++) {
            number = (28411 + 8121 * number) % 134456;
            v[i] = 2 * (double)number / 134456 - 1;
        }
        square = v[0] * v[0] + v[1] * v[1];
    } while (square >= 1);
    return v[0] * sqrt(-2 * rt_log(square) / square);
}

static double mount_displacement(const Mount *mount, uint32_t x, uint32_t y) {
    uint32_t size = mount->size;
    uint32_t low = size <= 7 ? x << (7 - size) : x >> (size - 7);
    return normal_random(21 + (((x << (23 - size)) + (y << (15 - size)) + low) & 0xffff));
}

static RtVec3d mount_place(const Mount *mount, MountCorner corner) {
    double step = 2 / (double)(1u << mount->size);
    return rt_vec3d(corner.x * step - 1, corner.y * step - 1, corner.z);
}

/* The square between corners in counter-clockwise order, the first being the lower left; `half` its side. */
static void add_square(const Mount *mount, const MountCorner corners[4], double half, uint32_t levels) {
    for (int i = 0; levels == 0 && i < 4; i += 2)
        rt_build_triangle(mount->b, mount_place(mount, corners[i]), mount_place(mount, corners[i + 1]),
                          mount_place(mount, corners[(i + 2) % 4]));
    if (levels == 0) return;
    const double root2 = 1.4142136,
                 roughness = half * sqrt(1.2599210498948731648 - 1); /* the cube root of 2 */
    MountCorner middle = {.x = (corners[0].x + corners[2].x) / 2, .y = (corners[0].y + corners[2].y) / 2};
    middle.z = (corners[0].z + corners[1].z + corners[2].z + corners[3].z) / 4 +
               roughness * root2 * mount_displacement(mount, middle.x, middle.y);
    MountCorner sides[4];
    for (int i = 0; i < 4; i++) {
        const MountCorner *v = &corners[i], *w = &corners[(i + 1) % 4];
        sides[i] = (MountCorner){.x = (v->x + w->x) / 2, .y = (v->y + w->y) / 2, .z = (v->z + w->z) / 2};
        sides[i].z += roughness * mount_displacement(mount, sides[i].x, sides[i].y);
    }
    for (int i = 0; i < 4; i++) {
        /* Each quarter keeps its own corner where the square has it. */
        MountCorner quarter[4];
        quarter[i] = corners[i];
        quarter[(i + 1) % 4] = sides[i];
        quarter[(i + 2) % 4] = middle;
        quarter[(i + 3) % 4] = sides[(i + 3) % 4];
        add_square(mount, quarter, half / 2, levels - 1);
    }
}

/* One over the mountain, and three below it, on the edges of a regular tetrahedron. */
static void add_glass(RtSceneBuilder *b) {
    const double radius = 0.17;
    const RtVec3d center = {-0.8, 0.8, 1}, diagonal = {sqrt(0.5), sqrt(0.5), 0}, z = {0, 0, 1};
    const RtVec3d up = {0, 0, radius * sqrt(1.5)};
    const RtTurn tetrahedral = {.cosine = -1.0 / 3, .sine = sqrt(8.0 / 9)};
    rt_build_material(b, rt_nff_material("glass", rt_vec3(1, 1, 1), 0.1f, 0.1f, 101.148f, 0.9f, 1.5f));
    rt_build_sphere(b, rt_addd(center, up), radius);
    for (int i = 0; i < 3; i++) {
        RtVec3d offset = rotate(rotate(up, diagonal, tetrahedral), z, rt_turn(120.0 * i));
        rt_build_sphere(b, rt_addd(center, offset), radius);
    }
}

static void generate_mount(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[1] = {{-100, -100, 100}};
    rt_build_lights(b, lights, 1);
    b->scene->camera.from = rt_vec3(-1.6f, 1.6f, 1.7f);
    b->scene->camera.near = 0.01f;
    add_glass(b);
    rt_build_material(b, rt_nff_material("rock", rt_vec3(0.5f, 0.45f, 0.35f), 1, 0, 100000, 0, 1));
    Mount mount = {.b = b, .size = (uint32_t)values[0].i};
    uint32_t side = 1u << mount.size;
    const MountCorner corners[4] = {{0, 0, 0}, {side, 0, 0}, {side, side, 0}, {0, side, 0}};
    add_square(&mount, corners, 1, mount.size);
}

SPD_SCENE(mount, "a fractal mountain of triangles of one size, seen through spheres of glass", RT_SPD_SOURCE,
          NULL, 0, "6", 9, "1|3", "levels: 2 * 4^size triangles", "SPD: 8192 triangles")

/* rings: a pyramid of objects made of six interlocked rings, seen from its tip in front of a wall. A ring is
 * a pentagon of five cylinders, with spheres where they meet. The six pass through the midpoints of the edges
 * of a dodecahedron, five each; cylinders of RING_RADIUS around pentagons of circumradius 1 would just touch.
 * Here the pentagons are smaller by the factor 1 + RING_RADIUS, and the radius is not, so that cylinders of
 * different rings overlap slightly. Layer n of the pyramid is n by n objects. */
enum { RINGS = 6, RING_CORNERS = 5 };

#define RING_RADIUS 0.07412

typedef RtVec3d Knot[RINGS][RING_CORNERS];

static uint64_t rings_count(const RtValue *values) {
    uint64_t size = (uint64_t)values[0].i;
    return 10 * size * (size + 1) * (2 * size + 1) + 1;
}

/* One pentagon lies in the plane of X and Y, the others in planes normal to axes of a dodecahedron next to Z,
 * at the angle whose cosine is 1 / sqrt 5. */
static void set_knot(Knot knot) {
    const RtVec3d x = {1, 0, 0}, z = {0, 0, 1};
    const RtTurn tilt = {.cosine = sqrt(1.0 / 5), .sine = sqrt(4.0 / 5)};
    for (int i = 0; i < RING_CORNERS; i++) {
        RtTurn turn = rt_turn(72.0 * i);
        knot[0][i] = rt_scaled(rt_vec3d(turn.cosine, turn.sine, 0), 1 / (1 + RING_RADIUS));
        RtVec3d tilted = rotate(knot[0][i], x, tilt);
        for (int ring = 1; ring < RINGS; ring++) knot[ring][i] = rotate(tilted, z, rt_turn(72.0 * ring - 36));
    }
}

static void add_knot(RtSceneBuilder *b, const Knot knot, RtVec3d center) {
    for (uint32_t ring = 0; ring < RINGS; ring++) {
        b->material = ring;
        for (int i = 0; i < RING_CORNERS; i++) {
            RtVec3d corner = rt_addd(center, knot[ring][i]);
            RtVec3d last = rt_addd(center, knot[ring][(i + RING_CORNERS - 1) % RING_CORNERS]);
            rt_build_cone(b, corner, RING_RADIUS, last, RING_RADIUS);
            rt_build_sphere(b, corner, RING_RADIUS);
        }
    }
}

/* Materials of the rings, in their order, and then of the wall. */
static void add_ring_materials(RtSceneBuilder *b) {
    static const RtVec3 colors[RINGS] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}, {1, 0, 1}, {1, 1, 0}};
    static const char *const names[RINGS] = {"red", "green", "blue", "cyan", "magenta", "yellow"};
    for (int i = 0; i < RINGS; i++)
        rt_build_material(b, rt_nff_material(names[i], colors[i], 0.5f, 0.2f, 3.0827f, 0, 1));
    rt_build_material(b, rt_nff_material("wall", rt_vec3(1, 1, 1), 1, 0, 100000, 0, 1));
}

/* Square, centred before the eye, and a hundredth larger than the picture. */
static void add_wall(RtSceneBuilder *b, RtVec3d eye, double y) {
    RtTurn half_view = rt_turn(22.5);
    double half = 1.01 * (y - eye.y) * (half_view.sine / half_view.cosine);
    const double x[4] = {1, -1, -1, 1}, z[4] = {1, 1, -1, -1};
    RtVec3d corners[4];
    for (int i = 0; i < 4; i++) corners[i] = rt_vec3d(eye.x + half * x[i], y, eye.z + half * z[i]);
    rt_build_polygon(b, corners, 4);
}

static void generate_rings(RtSceneBuilder *b, const RtValue *values) {
    const int64_t size = values[0].i;
    const double spacing = 1 / rt_turn(22.5).sine; /* from layer to layer: the pyramid fills the view */
    const RtVec3d eye = {-1, -spacing, 0.5};
    const RtVec3d lights[3] = {{3, -spacing, 3}, {-4, -spacing, 1}, {2, -spacing, -4}};
    rt_build_lights(b, lights, 3);
    b->scene->camera.from = rt_narrow(eye);
    b->scene->camera.at = rt_narrow(rt_vec3d(eye.x, eye.y + 1, eye.z));
    b->scene->camera.near = 1;
    add_ring_materials(b);
    add_wall(b, eye, spacing * (double)(size + 1));
    Knot knot;
    set_knot(knot);
    for (int64_t layer = 1; layer <= size; layer++) {
        for (int64_t i = 0; i < layer * layer; i++) {
            const int64_t x = 2 * (i % layer) - layer + 1, z = 2 * (i / layer) - layer + 1;
            RtVec3d center = {(double)x, spacing * (double)layer, (double)z};
            add_knot(b, (const RtVec3d(*)[RING_CORNERS])knot, center);
        }
    }
}

SPD_SCENE(rings, "a pyramid of interlocked rings of cylinders and spheres, mirrors, before a wall",
          RT_SPD_SOURCE, rings_count, 0, "7", 200, "1|2",
          "layers: 5 size (size+1) (2 size+1) spheres and as many cylinders",
          "SPD: 4200 spheres and cylinders")

/* shells: a sea shell of 180 * 2^size + 1 spheres, nearly all of which overlap their neighbours; after
 * C. Pickover, "A Short Recipe for Seashell Synthesis", IEEE CG&A 9(6), 1989; "tends to bring ray tracers to
 * their knees". The spheres lie on a spiral of nine turns on a cone; the radius of each is its distance from
 * the axis: at the angle a, from -12 pi to 6 pi, the radius is r = e^(0.15 a) and the centre (r sin a, r cos
 * a, -2 r). These numbers were inferred from the files of the database, smallest sphere first. */
enum { ARCS = 180 }; /* of 18 degrees, each of 2^size spheres */

static uint64_t shells_count(const RtValue *values) {
    return ((uint64_t)ARCS << values[0].i) + 1;
}

static void add_shell_sphere(RtSceneBuilder *b, double degrees, double radius) {
    RtTurn turn = rt_turn(degrees);
    rt_build_sphere(b, rt_vec3d(radius * turn.sine, radius * turn.cosine, -2 * radius), radius);
}

static void generate_shells(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[1] = {{-100, -100, 100}};
    rt_build_lights(b, lights, 1);
    b->scene->camera.from = rt_vec3(-6, -60, 35);
    b->scene->camera.at = rt_vec3(0, 8, -15);
    b->scene->camera.near = 0.5f;
    rt_build_material(b, rt_nff_material("shell", rt_vec3(1, 0.8f, 0.4f), 0.8f, 0.2f, 45.2776f, 0, 1));

    const double arc_growth = 1.0482518687537468114; /* e^(0.015 pi) */
    const int64_t spheres = INT64_C(1) << values[0].i;
    double growth = arc_growth, radius = 0.0035004393966670334; /* e^(-1.8 pi) */
    for (int64_t halving = 0; halving < values[0].i; halving++) growth = sqrt(growth);
    for (int arc = 0; arc < ARCS; arc++) {
        double within = radius; /* multiplied within an arc only: rounding errors do not add up */
        for (int64_t i = 0; i < spheres; i++) {
            add_shell_sphere(b, 18 * (arc + (double)i / (double)spheres), within);
            within *= growth;
        }
        radius *= arc_growth;
    }
    add_shell_sphere(b, 0, radius);
}

SPD_SCENE(shells, "a sea shell of spheres that overlap, many of them tiny", SPD_LATER_SOURCE, shells_count, 0,
          "5", 20, "1|3", "doublings of the number of spheres, 180 * 2^size + 1, over the same nine turns",
          "SPD: 5761 spheres")

/* tetra: a Sierpinski tetrahedron of 4^size triangles. A cube holds a regular tetrahedron at the four corners
 * whose signs have a product of +1; each level replaces it by four of half its size in those corners. Objects
 * come depth first. All coordinates are exact. */
/* The corner of the cube about `center` at the signs (x, y, x * y). */
static RtVec3d cube_corner(RtVec3d center, double half, double x, double y) {
    return rt_addd(center, rt_vec3d(x * half, y * half, x * y * half));
}

static void add_tetra(RtSceneBuilder *b, RtVec3d center, double half, int64_t levels) {
    static const double face_x[4] = {-1, 1, 1, -1}, face_y[4] = {-1, 1, -1, 1};
    for (int i = 0; i < 4; i++) {
        if (levels == 1) {
            double x = face_x[i], y = face_y[i];
            rt_build_triangle(b, cube_corner(center, half, x, y), cube_corner(center, half, x, -y),
                              cube_corner(center, half, -x, y));
        } else {
            add_tetra(b, cube_corner(center, half / 2, i / 2 ? 1 : -1, i % 2 ? 1 : -1), half / 2, levels - 1);
        }
    }
}

static void generate_tetra(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[1] = {{2, -18, -5}};
    rt_build_lights(b, lights, 1);
    b->scene->camera.from = rt_vec3(1.022846f, -3.177154f, -2.174512f);
    b->scene->camera.at = rt_vec3(-0.004103f, -0.004103f, 0.216539f);
    b->scene->camera.up = rt_vec3(-0.816497f, -0.816497f, 0.816497f);
    b->scene->camera.near = 1;
    rt_build_material(b, rt_nff_material("red", rt_vec3(1, 0.2f, 0.2f), 1, 0, 100000, 0, 1));
    add_tetra(b, rt_vec3d(0, 0, 0), 1, values[0].i);
}

SPD_SCENE(tetra, "a Sierpinski tetrahedron of triangles, mostly empty space", RT_SPD_SOURCE, NULL, 0, "6", 9,
          "1|3", "levels: 4^size triangles", "SPD: 4096 triangles")

/* tree: a binary tree of 2^(size+1) - 1 branches, each a cone with a sphere at its tip, on a field. The trunk
 * goes from the origin to (0, 0, 1). A branch has two children: smaller copies of it, rotated and moved to
 * its tip, with a separate factor for radii. Objects come depth first. */
#define TRUNK_RADIUS 0.15
#define TAPER        0.67 /* of radii, from a branch to the next */

/* Turns and scales: where a unit vector along each axis goes. */
typedef struct Frame {
    RtVec3d axis[3];
} Frame;

/* A vector of a frame, seen from outside it. */
static RtVec3d outward(const Frame *frame, RtVec3d v) {
    RtVec3d sum = rt_scaled(frame->axis[0], v.x);
    return rt_add_scaledd(rt_add_scaledd(sum, frame->axis[1], v.y), frame->axis[2], v.z);
}

/* A child within the frame of its parent: turned about X by `tilt` degrees, then about Z by `around`, and
 * scaled. */
static Frame child_frame(double tilt, double around, double scale) {
    static const RtVec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Frame frame;
    for (int a = 0; a < 3; a++) {
        RtVec3d tilted = rotate(axes[a], axes[0], rt_turn(tilt));
        frame.axis[a] = rt_scaled(rotate(tilted, axes[2], rt_turn(around)), scale);
    }
    return frame;
}

static void add_branch(RtSceneBuilder *b, const Frame children[2], RtVec3d base, const Frame *frame,
                       double radius, int64_t levels) {
    RtVec3d tip = rt_addd(base, frame->axis[2]);
    rt_build_cone(b, base, radius, tip, radius * TAPER);
    rt_build_sphere(b, tip, radius * TAPER);
    for (int i = 0; levels > 0 && i < 2; i++) {
        Frame child;
        for (int a = 0; a < 3; a++) child.axis[a] = outward(frame, children[i].axis[a]);
        add_branch(b, children, tip, &child, radius * TAPER, levels - 1);
    }
}

static void generate_tree(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[7] = {{-5, 5, 50},   {30, -30, 30}, {-40, -30, 20}, {10, 30, 40},
                                      {-30, 40, 10}, {50, 25, 20},  {-10, -60, 30}};
    static const RtVec3d field[4] = {{50, 50, 0}, {-50, 50, 0}, {-50, -50, 0}, {50, -50, 0}};
    static const Frame upright = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const Frame children[2] = {child_frame(40, 90, 0.65), child_frame(25, 230, 0.7)};
    rt_build_lights(b, lights, 7);
    b->scene->camera.from = rt_vec3(4.5f, 0.4f, 2);
    b->scene->camera.at = rt_vec3(0, 0, 1.5f);
    b->scene->camera.near = 1;
    rt_build_material(b, rt_nff_material("field", rt_vec3(0.2f, 0.7f, 0.2f), 1, 0, 100000, 0, 1));
    rt_build_polygon(b, field, 4);
    rt_build_material(b, rt_nff_material("bark", rt_vec3(0.55f, 0.4f, 0.2f), 1, 0, 100000, 0, 1));
    add_branch(b, children, rt_vec3d(0, 0, 0), &upright, TRUNK_RADIUS, values[0].i);
}

SPD_SCENE(tree, "a tree of cones and spheres that get smaller and smaller, alone on a large field",
          RT_SPD_SOURCE, NULL, 0, "11", 20, "1|3",
          "levels above the trunk: 2^(size+1) - 1 cones and as many spheres", "SPD: 4095 cones and spheres")
