/* SPDX-License-Identifier: Apache-2.0 */
/* The toolkit of scene generators: materials, lights, and objects from single spheres to boxes, meshes and
 * surfaces of revolution.
 *
 * The builder keeps the first error and adds nothing after it, so generators need not check each call. A
 * counting builder adds nothing and counts the objects, so the object count of a scene follows from its
 * generator. Points are computed in double with + - * / sqrt alone, transformed, and rounded to float32
 * once: points that are equal in double stay equal in the scene. */
#ifndef RT_SCENES_BUILD_H
#define RT_SCENES_BUILD_H

#include "core/base/param.h"
#include "core/base/random.h"
#include "core/base/transform.h"
#include "core/scene/nff.h"

/* What stands in a scene that repeats itself: separate objects; instances of a few parts; or copies of these
 * parts, moved by the same matrices (rt_scene_flatten). */
enum { RT_INSTANCES_OFF, RT_INSTANCES_ON, RT_INSTANCES_FLATTENED };

#define RT_MAX_BUILT_PARTS 64

typedef struct RtSceneBuilder {
    RtScene *scene;        /* that objects are added to; camera and background are set here */
    bool counting;         /* count instead of adding */
    uint32_t material;     /* of the next objects */
    bool polygons;         /* a quad becomes one polygon; else two triangles */
    bool transformed;      /* else points are used as they are */
    RtTransform transform; /* of the next objects; spheres and cones need a uniform scale */
    uint64_t count;        /* objects so far; those of a part once */
    RtScene *whole;        /* borrowed: the scene, which has the parts */
    RtScene part;          /* owned: what is between rt_build_begin_part and rt_build_end_part */
    bool flattened;        /* set by the generator: instances become copies, and count as such */
    uint32_t part_count;
    uint64_t part_sizes[RT_MAX_BUILT_PARTS], count_before; /* objects in each part, and before this one */
    uint32_t point_capacity;
    RtVec3 *points; /* owned: for grid meshes */
    RtStatus status;
    RtError *error; /* borrowed */
} RtSceneBuilder;

typedef void RtSceneGenerator(RtSceneBuilder *b, const RtValue *values);

/* Runs the generator on an initialised scene and finishes it. */
RtStatus rt_build_scene(RtScene *scene, RtSceneGenerator *generate, const RtValue *values, RtError *error);

/* The number of objects that the generator adds. */
uint64_t rt_build_count(RtSceneGenerator *generate, const RtValue *values);

/* Records an error of another function, if it is the first. */
void rt_build_check(RtSceneBuilder *b, RtStatus status);

/* Add materials and lights; a single material applies to the next objects. */
void rt_build_material(RtSceneBuilder *b, RtMaterial material);
void rt_build_materials(RtSceneBuilder *b, const RtMaterial *materials, uint32_t count);
void rt_build_light(RtSceneBuilder *b, RtVec3d position, RtVec3 intensity);

/* Adds white lights with the intensity of NFF (rt_nff_light_intensity). */
void rt_build_lights(RtSceneBuilder *b, const RtVec3d *positions, uint32_t count);

/* For scenes of random objects: two lights and RT_STUDIO_MATERIALS materials, numbers 0 to 3: matte ones,
 * a mirror (steel), and glass or a third matte one. */
#define RT_STUDIO_MATERIALS 4
void rt_build_studio(RtSceneBuilder *b, bool glass);

/* An initialiser for tables of materials. */
#define RT_MATERIAL(what, red, green, blue, ka, kd, ks, exponent, kr)                                        \
    {                                                                                                        \
        .name = what, .color = {red, green, blue}, .ambient = ka, .diffuse = kd, .specular = ks,             \
        .shine = exponent, .reflection = kr, .ior = 1                                                        \
    }
#define RT_MATTE(what, red, green, blue) RT_MATERIAL(what, red, green, blue, 0.12f, 0.8f, 0, 1, 0)

/* Sets the transform: `quarters` exact turns of 90 degrees about z, then a move of the origin to `at`. */
void rt_build_origin(RtSceneBuilder *b, RtVec3d at, int quarters);

/* Point `i` of `n` on the unit circle, (cos, sin, 0) of i / n of a turn: the same bits everywhere, exact
 * at quarter turns. */
RtVec3d rt_on_circle(uint32_t i, uint32_t n);

/* What is added between them is the next part of the scene, with materials of its own. */
void rt_build_begin_part(RtSceneBuilder *b);
void rt_build_end_part(RtSceneBuilder *b);

/* Adds an instance of a finished part to the scene or part; b->transform does not move it. */
void rt_build_instance(RtSceneBuilder *b, uint32_t part, const RtTransform *to_world);

void rt_build_sphere(RtSceneBuilder *b, RtVec3d center, double radius);
void rt_build_cone(RtSceneBuilder *b, RtVec3d base, double base_radius, RtVec3d apex, double apex_radius);
void rt_build_triangle(RtSceneBuilder *b, RtVec3d v0, RtVec3d v1, RtVec3d v2);

/* One polygon of 3 to 144 corners. */
void rt_build_polygon(RtSceneBuilder *b, const RtVec3d *corners, uint32_t count);

/* Four coplanar corners, counter-clockwise seen from the front. */
void rt_build_quad(RtSceneBuilder *b, const RtVec3d corners[4]);

/* A horizontal regular polygon about `center`. */
void rt_build_disc(RtSceneBuilder *b, RtVec3d center, double radius, uint32_t sides);

/* Sides of a box. */
enum {
    RT_SIDE_FRONT = 4, /* at lo.y */
    RT_SIDE_TOP = 32,
    RT_SIDES_ALL = 63,
    RT_SIDES_STANDING = 47 /* all but the bottom */
};

/* Adds the sides of a box selected by `sides`. */
void rt_build_box(RtSceneBuilder *b, RtVec3d lo, RtVec3d hi, unsigned sides);

/* An open prism or truncated pyramid of 2 * sides triangles, or a pyramid of `sides` triangles if
 * `to_radius` is 0. */
void rt_build_prism(RtSceneBuilder *b, RtVec3d from, double from_radius, RtVec3d to, double to_radius,
                    uint32_t sides);

/* A point of a mesh: column <= columns, row <= rows. */
typedef RtVec3d RtGridPoint(const void *of, uint32_t column, uint32_t row);

/* A curved mesh of columns x rows cells, two triangles each. Seen from the front, columns go right and rows
 * go up. */
typedef struct RtGridMesh {
    uint32_t columns, rows;
    bool wrapped;               /* the columns wrap around */
    bool first_pole, last_pole; /* row 0, row `rows` is a single point, so it has no triangles along it */
    bool smooth;                /* vertex normals: means over the adjacent triangles */
    RtGridPoint *point;
    const void *of;
} RtGridMesh;

void rt_build_grid_mesh(RtSceneBuilder *b, const RtGridMesh *grid);

/* The surface of revolution of the curve through profile[0..count), x the radius and z the height, around
 * the vertical through `center`. Upward profiles have outward normals. With `steps` = count - 1 it is
 * straight between the points. It is closed if the first or last radius is 0. */
typedef struct RtLathe {
    RtVec3d center;
    const RtVec3d *profile;
    uint32_t count;
    uint32_t steps; /* rows of cells */
    uint32_t sides; /* columns */
} RtLathe;

void rt_build_lathe(RtSceneBuilder *b, const RtLathe *lathe);

/* A torus around the line through `center` along axis 0, 1 or 2: 2 * around * sides triangles. */
typedef struct RtTorus {
    RtVec3d center;
    int axis;
    double radius, tube;
    uint32_t around, sides;
} RtTorus;

void rt_build_torus(RtSceneBuilder *b, const RtTorus *torus);

/* Newell's teapot: 64 n^2 - 8 n triangles with vertex normals (32 patches of n x n cells, 1 <= n <=
 * RT_TEAPOT_MAX_SIZE), 3.15 high and 6.43 long, on z = 0 about the z axis, its spout towards +x (teapot.c).
 */
#define RT_TEAPOT_MAX_SIZE 1000
void rt_build_teapot(RtSceneBuilder *b, uint32_t n);

/* ---- random CSG trees, for testing accelerators and the trees themselves: random_tree.c ---- */

#define RT_MAX_RANDOM_TREE 64

typedef struct RtTreeRecipe {
    uint32_t solids; /* 1..RT_MAX_RANDOM_TREE; a half-space adds one more */
    bool coarse;     /* coordinates are multiples of 1/2 and turns of 90 degrees: many faces coincide */
} RtTreeRecipe;

/* A term of random solids of every kind with random operations and moves, within about 4 of the origin
 * along each axis; its inside may be empty. The solids get materials below `materials`. */
RtStatus rt_random_tree(RtCsgBuilder *builder, RtRandom *random, const RtTreeRecipe *recipe,
                        uint32_t materials, RtCsgTerm *root, RtError *error);

/* An axis-aligned box, with exactly these planes. */
RtStatus rt_add_box(RtCsgBuilder *builder, RtBox box, uint32_t material, RtCsgTerm *out, RtError *error);

#endif
