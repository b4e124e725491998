/* SPDX-License-Identifier: Apache-2.0 */
/* Forms: what the larger built-in scenes are made of (boxes, tubes, curved sheets, surfaces of revolution),
 * as triangles or polygons.
 *
 * Every form can be made or only counted: without a scene nothing is made, and `count` still grows. So the
 * count of objects of a scene is that of its generator, run without a scene, and cannot differ from it.
 * Points are computed in double by + - * / sqrt alone, moved by `place` and rounded to float32 once; what two
 * forms share bit for bit in double they share in the scene. */
#ifndef RT_SCENES_FORMS_H
#define RT_SCENES_FORMS_H

#include "core/base/param.h"
#include "core/base/transform.h"
#include "core/scene/scene.h"

typedef struct RtForms {
    RtScene *scene;    /* borrowed; NULL: count only */
    uint32_t material; /* of the forms that come next */
    bool polygons;     /* a quad is one polygon; else two triangles */
    RtTransform place; /* of the forms that come next; spheres and cones need one that scales evenly */
    uint64_t count;    /* objects so far */
    uint32_t room;     /* points there is room for in `points` */
    RtVec3 *points;    /* owned: what sheets are made in */
} RtForms;

/* Material 0, triangles, no transform, none made yet. */
RtForms rt_forms(RtScene *scene);

/* Frees what it holds itself; the scene stays. */
void rt_forms_clear(RtForms *forms);

/* The part of a generator that makes objects, by forms alone. */
typedef RtStatus RtFormsMaker(RtForms *forms, const RtValue *values, RtError *error);

/* Has `make` add its objects to the scene. */
RtStatus rt_forms_make(RtScene *scene, RtFormsMaker *make, const RtValue *values, RtError *error);

/* How many objects `make` would add. */
uint64_t rt_forms_count(RtFormsMaker *make, const RtValue *values);

/* Gives the scene these materials, which get the indices from 0 in a scene that has none. */
RtStatus rt_forms_materials(const RtForms *forms, const RtMaterial *materials, uint32_t count,
                            RtError *error);

/* A material of this color, as it stands in a table. */
#define RT_MATERIAL(what, red, green, blue, ka, kd, ks, exponent, kr)                                        \
    {                                                                                                        \
        .name = what, .color = {red, green, blue}, .ambient = ka, .diffuse = kd, .specular = ks,             \
        .shine = exponent, .reflection = kr, .ior = 1                                                        \
    }
#define RT_MATTE(what, red, green, blue) RT_MATERIAL(what, red, green, blue, 0.12f, 0.8f, 0, 1, 0)

/* Places what comes next with the origin at `at`, turned about z by `quarters` of 90 degrees, exactly. */
void rt_forms_at(RtForms *forms, RtVec3d at, int quarters);

/* Point `i` of `n` on the unit circle, (cos, sin, 0) of i / n of a turn: the same bits everywhere, and exact
 * at quarters of a turn. */
RtVec3d rt_on_circle(uint32_t i, uint32_t n);

/* The smooth curve through points[0..count), count >= 2, at `step` of `steps` between the first and the last,
 * evenly in number of points (Catmull & Rom 1974; at either end the neighbour that is missing is
 * mirrored). */
RtVec3d rt_curve_point(const RtVec3d *points, uint32_t count, uint32_t step, uint32_t steps);

RtStatus rt_forms_triangle(RtForms *forms, RtVec3d a, RtVec3d b, RtVec3d c, RtError *error);

/* Four corners, planar, counter-clockwise from the front. */
RtStatus rt_forms_quad(RtForms *forms, const RtVec3d corners[4], RtError *error);

/* A polygon whatever `polygons` says: `count` corners, 3 to 64. */
RtStatus rt_forms_polygon(RtForms *forms, const RtVec3d *corners, uint32_t count, RtError *error);

/* The level polygon of `sides`, 3 to 64, about `center`. */
RtStatus rt_forms_disc(RtForms *forms, RtVec3d center, double radius, uint32_t sides, RtError *error);

RtStatus rt_forms_sphere(RtForms *forms, RtVec3d center, double radius, RtError *error);
RtStatus rt_forms_cone(RtForms *forms, RtVec3d base, double base_radius, RtVec3d apex, double apex_radius,
                       RtError *error);

/* Sides of a box, to be left out or made. */
enum {
    RT_SIDE_LEFT = 1, /* at lo.x */
    RT_SIDE_RIGHT = 2,
    RT_SIDE_FRONT = 4, /* at lo.y */
    RT_SIDE_BACK = 8,
    RT_SIDE_BELOW = 16,
    RT_SIDE_TOP = 32,
    RT_SIDES_ALL = 63,
    RT_SIDES_STANDING = 47 /* all but the one below */
};

/* The quads of a box that `sides` names. */
RtStatus rt_forms_box(RtForms *forms, RtVec3d lo, RtVec3d hi, unsigned sides, RtError *error);

/* An open prism or pyramid stump with `sides` flat sides, 2 * sides triangles whatever `polygons` says; a
 * pyramid of `sides` triangles where `to_radius` is 0. */
RtStatus rt_forms_tube(RtForms *forms, RtVec3d from, double from_radius, RtVec3d to, double to_radius,
                       uint32_t sides, RtError *error);

/* A curved sheet of columns x rows cells, two triangles each. Seen from the front, columns go right and rows
 * go up. */
typedef struct RtSheet {
    uint32_t columns, rows;
    bool wrapped;               /* the last column of points is the first again */
    bool first_pole, last_pole; /* row 0, row `rows` is a single point: no triangle along it */
    bool smooth;                /* vertex normals, the means of those of the triangles about */
    RtVec3d (*point)(const void *of, uint32_t column, uint32_t row); /* column <= columns, row <= rows */
    const void *of;
} RtSheet;

uint64_t rt_sheet_count(const RtSheet *sheet);
RtStatus rt_forms_sheet(RtForms *forms, const RtSheet *sheet, RtError *error);

/* The surface of revolution about the vertical through `center` of the curve through profile[0..count), x the
 * radius and z the height, upwards for normals that point out: smooth through all, or straight from one to
 * the next with `steps` = count - 1. Where the first or last radius is 0 it is closed there. */
typedef struct RtLathe {
    RtVec3d center;
    const RtVec3d *profile;
    uint32_t count;
    uint32_t steps; /* rows of cells */
    uint32_t sides; /* columns */
    double scale;   /* of the profile */
} RtLathe;

RtStatus rt_forms_lathe(RtForms *forms, const RtLathe *lathe, RtError *error);

/* A ring about the line through `center` along axis 0, 1 or 2: 2 * around * sides triangles. */
typedef struct RtTorus {
    RtVec3d center;
    int axis;
    double radius, tube; /* of the ring, and of its own section */
    uint32_t around, sides;
} RtTorus;

RtStatus rt_forms_torus(RtForms *forms, const RtTorus *torus, RtError *error);

#endif
