/* SPDX-License-Identifier: Apache-2.0 */
/* Patches are evaluated by de Casteljau's scheme with the weights n - i and i, so that a shared border has
 * the same bits in both patches, from either end, and coincident control points yield coincident points. 8
 * patches have a border that is a single point, where n triangles collapse and are omitted. */
#include "scenes/teapot_mesh.h"

#include "scenes/teapot_patches.h"

enum { COLLAPSED = 8 };

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
static Corner corner_of(const RtTransform *place, const unsigned short patch[16], uint32_t i, uint32_t j,
                        uint32_t n) {
    RtVec3d rows[4], columns[4], control[4], along_s, along_t, unused;
    for (int k = 0; k < 4; k++) {
        for (int l = 0; l < 4; l++) {
            const double *p = teapot_points[patch[4 * k + l]];
            control[l] = rt_vec3d(p[0], p[1], p[2]);
        }
        rows[k] = on_cubic(control, j, n, &unused);
    }
    for (int l = 0; l < 4; l++) {
        for (int k = 0; k < 4; k++) {
            const double *p = teapot_points[patch[4 * k + l]];
            control[k] = rt_vec3d(p[0], p[1], p[2]);
        }
        columns[l] = on_cubic(control, i, n, &unused);
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

static void add_patch(RtSceneBuilder *b, const unsigned short patch[16], uint32_t n) {
    Corner rows[2][RT_TEAPOT_MAX_SIZE + 1];
    for (uint32_t i = 0; i <= n; i++) {
        const Corner *before = rows[(i + 1) % 2];
        Corner *row = rows[i % 2];
        for (uint32_t j = 0; j <= n; j++) row[j] = corner_of(&b->transform, patch, i, j, n);
        for (uint32_t j = 0; i > 0 && j < n; j++) {
            add_half(b, &before[j], &before[j + 1], &row[j + 1]);
            add_half(b, &row[j + 1], &row[j], &before[j]);
        }
    }
}

void rt_teapot(RtSceneBuilder *b, uint32_t n) {
    b->count += 2 * (uint64_t)TEAPOT_PATCHES * n * n - (uint64_t)COLLAPSED * n;
    for (int i = 0; i < TEAPOT_PATCHES && !b->counting; i++) add_patch(b, teapot_patches[i], n);
}
