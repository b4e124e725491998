/* SPDX-License-Identifier: Apache-2.0 */
/* teapot: Newell's teapot on a checkerboard: many small triangles with vertex normals, a few large quads.
 *
 * As in the Standard Procedural Databases (E. Haines 1987): 64 size^2 - 8 size triangles and a board of size
 * x size squares, all of them mirrors. The published tables are of size 12: 9264 objects.
 *
 * The teapot is that of Martin Newell (1975), with the bottom added later: 32 bicubic Bezier patches. They
 * are evaluated by de Casteljau's scheme with the weights n - i and i, so that a shared border has the same
 * bits in both patches, from either end, and coincident control points yield coincident points. 8 patches
 * have a border that is a single point, where n triangles collapse and are omitted. */
#include "scenes/builtin.h"

/* ---- control points ---- */

enum { RINGS = 6, SECTIONS = 4, PATCHES = 4 * RINGS + 2 * SECTIONS, COLLAPSED = 8 };

/* Surfaces of revolution, each of four patches of a quarter turn. A row is a ring: its radius, the other
 * coordinate of the two points between the axes, and its height. */
static const double rings[RINGS][4][3] = {
    {{1.4, 0.784, 2.4}, {1.3375, 0.749, 2.53125}, {1.4375, 0.805, 2.53125}, {1.5, 0.84, 2.4}}, /* rim */
    {{1.5, 0.84, 2.4}, {1.75, 0.98, 1.875}, {2, 1.12, 1.35}, {2, 1.12, 0.9}},                  /* body */
    {{2, 1.12, 0.9}, {2, 1.12, 0.45}, {1.5, 0.84, 0.225}, {1.5, 0.84, 0.15}},
    {{0, 0, 3.15}, {0.8, 0.45, 3.15}, {0, 0, 2.85}, {0.2, 0.112, 2.7}}, /* lid */
    {{0.2, 0.112, 2.7}, {0.4, 0.224, 2.55}, {1.3, 0.728, 2.55}, {1.3, 0.728, 2.4}},
    {{0, 0, 0}, {1.425, 0.798, 0}, {1.5, 0.84, 0.075}, {1.5, 0.84, 0.15}}, /* bottom */
};

/* The handle and the spout, each patch with its mirror image in y. A row goes from (x, z), on the plane of
 * symmetry, around to another (x, z) there, at the distance of the last number from it. */
static const double sections[SECTIONS][4][5] = {
    {{-1.6, 2.025, -1.5, 2.25, 0.3},
     {-2.3, 2.025, -2.5, 2.25, 0.3},
     {-2.7, 2.025, -3, 2.25, 0.3},
     {-2.7, 1.8, -3, 1.8, 0.3}},
    {{-2.7, 1.8, -3, 1.8, 0.3},
     {-2.7, 1.575, -3, 1.35, 0.3},
     {-2.5, 1.125, -2.65, 0.9375, 0.3},
     {-2, 0.9, -1.9, 0.6, 0.3}},
    {{1.7, 1.425, 1.7, 0.6, 0.66},
     {2.6, 1.425, 3.1, 0.825, 0.66},
     {2.3, 2.1, 2.4, 2.025, 0.25},
     {2.7, 2.4, 3.3, 2.4, 0.25}},
    {{2.7, 2.4, 3.3, 2.4, 0.25},
     {2.8, 2.475, 3.525, 2.49375, 0.25},
     {2.9, 2.475, 3.45, 2.5125, 0.15},
     {2.8, 2.4, 3.2, 2.4, 0.15}},
};

/* Point `i` of a ring, clockwise in quarter `quarter` of a turn. 0 - x, unlike -x, has no negative zero. */
static RtVec3d ring_point(const double ring[3], uint32_t i, uint32_t quarter) {
    double x = i < 2 ? ring[0] : i == 2 ? ring[1] : 0, y = 0 - (i == 0 ? 0 : i == 1 ? ring[1] : ring[0]);
    for (uint32_t turn = 0; turn < quarter; turn++) {
        const double turned = 0 - x;
        x = y;
        y = turned;
    }
    return rt_vec3d(x, y, ring[2]);
}

static RtVec3d section_point(const double row[5], uint32_t i, bool mirrored) {
    const uint32_t at = mirrored ? 3 - i : i, end = at < 2 ? 0 : 2;
    const double aside = at == 0 || at == 3 ? 0 : row[4];
    return rt_vec3d(row[end], mirrored ? aside : 0 - aside, row[end + 1]);
}

/* In the order of Newell's data: rim, body, handle, spout, lid, bottom, which faces down. */
static void set_patch(uint32_t patch, RtVec3d control[4][4]) {
    enum { FIRST = 12, END = FIRST + 2 * SECTIONS };
    const bool section = patch >= FIRST && patch < END;
    const uint32_t ring = (patch < FIRST ? patch : patch - 2 * SECTIONS) / 4;
    for (uint32_t k = 0; k < 4; k++) {
        for (uint32_t l = 0; l < 4; l++) {
            control[k][l] = section ? section_point(sections[(patch - FIRST) / 2][k], l, patch % 2)
                                    : ring_point(rings[ring][k], l, patch % 4);
            if (!section && ring == RINGS - 1) control[k][l].y = 0 - control[k][l].y;
        }
    }
}

/* ---- triangles ---- */

/* Between a at i = 0 and b at i = n. */
static RtVec3d mix(RtVec3d a, RtVec3d b, uint32_t i, uint32_t n) {
    RtVec3d p;
    for (int k = 0; k < 3; k++)
        p.at[k] = a.at[k] == b.at[k] ? a.at[k] : ((n - i) * a.at[k] + i * b.at[k]) / n;
    return p;
}

/* A point of the cubic through 4 control points, and where its tangent points (0 where there is none). */
static RtVec3d on_cubic(const RtVec3d control[4], uint32_t i, uint32_t n, RtVec3d *tangent) {
    RtVec3d ab = mix(control[0], control[1], i, n), bc = mix(control[1], control[2], i, n);
    RtVec3d cd = mix(control[2], control[3], i, n);
    RtVec3d abc = mix(ab, bc, i, n), bcd = mix(bc, cd, i, n);
    *tangent = rt_subd(bcd, abc);
    return mix(abc, bcd, i, n);
}

typedef struct Corner {
    RtVec3 point, normal;
} Corner;

/* At s = i / n along the rows of a patch, t = j / n along each. */
static Corner corner_of(const RtTransform *place, const RtVec3d patch[4][4], uint32_t i, uint32_t j,
                        uint32_t n) {
    RtVec3d rows[4], columns[4], along_s, along_t, unused;
    for (int k = 0; k < 4; k++) {
        const RtVec3d column[4] = {patch[0][k], patch[1][k], patch[2][k], patch[3][k]};
        rows[k] = on_cubic(patch[k], j, n, &unused);
        columns[k] = on_cubic(column, i, n, &unused);
    }
    RtVec3d point = on_cubic(rows, i, n, &along_s);
    on_cubic(columns, j, n, &along_t);
    RtVec3d normal = rt_crossd(along_t, along_s);
    /* At a cusp, on the axis, one tangent vanishes: up on the lid, down below. */
    if (rt_lengthd(normal) < 1e-9) normal = rt_vec3d(0, 0, point.z > 0 ? 1 : -1);
    return (Corner){rt_narrow(rt_transform_pointd(place, point)),
                    rt_narrow(rt_normalized(rt_transform_normald(place, normal)))};
}

static bool same(RtVec3 a, RtVec3 b) {
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static void add_half(RtSceneBuilder *b, const Corner *u, const Corner *v, const Corner *w) {
    if (b->status != RT_OK || same(u->point, v->point) || same(v->point, w->point)) return;
    const RtVec3 points[3] = {u->point, v->point, w->point}, normals[3] = {u->normal, v->normal, w->normal};
    b->status = rt_scene_add_triangle(b->scene, b->material, points, normals, b->error);
}

void rt_build_teapot(RtSceneBuilder *b, uint32_t n) {
    Corner rows[2][RT_TEAPOT_MAX_SIZE + 1];
    b->count += 2 * (uint64_t)PATCHES * n * n - (uint64_t)COLLAPSED * n;
    for (uint32_t patch = 0; patch < PATCHES && !b->counting; patch++) {
        RtVec3d control[4][4];
        set_patch(patch, control);
        for (uint32_t i = 0; i <= n; i++) {
            const Corner *before = rows[(i + 1) % 2];
            Corner *row = rows[i % 2];
            for (uint32_t j = 0; j <= n; j++)
                row[j] = corner_of(&b->transform, (const RtVec3d(*)[4])control, i, j, n);
            for (uint32_t j = 0; i > 0 && j < n; j++) {
                add_half(b, &before[j], &before[j + 1], &row[j + 1]);
                add_half(b, &row[j + 1], &row[j], &before[j]);
            }
        }
    }
}

/* ---- the scene ---- */

static const RtParam params[] = {
    {"size", RT_INT("12", 1, RT_TEAPOT_MAX_SIZE, "1|6"),
     "cells along each edge of a patch, and squares along the board: 65 size^2 - 8 size objects",
     "the published tables: 9264 objects"},
};

enum { CHINA, LIGHT_SQUARES, DARK_SQUARES };

static void generate(RtSceneBuilder *b, const RtValue *values) {
    static const RtVec3d lights[2] = {{-3.1f, 9.8f, 12.1f}, {11.3f, 5.1f, 8.8f}};
    uint32_t size = (uint32_t)values[0].i;
    rt_build_lights(b, lights, 2);
    b->scene->camera.from = rt_vec3(4.86f, 7.2f, 5.4f);
    rt_build_material(b, rt_nff_material("china", rt_vec3(1, 0.5f, 0.1f), 0.75f, 0.25f, 93, 0, 1));
    rt_build_material(b, rt_nff_material("light squares", rt_vec3(1, 0.9f, 0.8f), 0.5f, 0.5f, 300000, 0, 1));
    rt_build_material(b,
                      rt_nff_material("dark squares", rt_vec3(0.3f, 0.25f, 0.2f), 0.5f, 0.5f, 300000, 0, 1));
    b->transformed = true;
    b->material = CHINA;
    rt_build_teapot(b, size);
    double square = 8.0 / size;
    b->polygons = true;
    for (uint32_t row = 0; row < size; row++) {
        for (uint32_t column = 0; column < size; column++) {
            RtVec3d lo = {column * square - 4, row * square - 4, 0};
            RtVec3d hi = {(column + 1) * square - 4, (row + 1) * square - 4, 0};
            b->material = (row + column) % 2 ? DARK_SQUARES : LIGHT_SQUARES;
            rt_build_box(b, lo, hi, RT_SIDE_TOP);
        }
    }
}

const RtBuiltin rt_builtin_teapot = {
    .name = "teapot",
    .summary = "Newell's teapot on a checkerboard: small triangles with vertex normals, a few large quads",
    .source = RT_SPD_SOURCE,
    RT_PARAMS_OF(params),
    .generate = generate,
};
