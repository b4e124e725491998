/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of light: its data, shared by the files of this folder, and the geometry of cells.
 *
 * Around each light stands a cube of six faces, one per axis and direction: face 2 a + 1 looks from the light
 * along +a, 2 a along -a. A point at offset v from the light belongs to the face of its largest |v.at[a]|,
 * which is its depth, and lies on it at u = v.at[b] / depth, w = v.at[c] / depth, both in [-1, 1], with b, c
 * the axes after a. On each face lies a grid of square cells over the rectangle in which the scene is seen;
 * outside of it everything is lit. Cell (column, row) has u in grid.u + [column, column + 1] / grid.scale, w
 * alike.
 *
 * Layout: cells are row after row. The list of cell k of a face is entries[first[k]..first[k + 1]), ascending
 * by depth, then by object. A list that was cut ends in an entry RT_LIGHT_BEYOND: objects as deep or deeper
 * may be missing. An object whose box holds the light is in all cells of all faces, at depth 0.
 *
 * Invariant: an object that can occlude a ray from inside `domain` to the light is in the list of the ray's
 * cell, with a depth not above that of the ray's origin; or the list was cut, at a depth not above that of
 * the origin. light_project.c proves it. So cutting lists never changes an answer, only which layer finds
 * it. */
#ifndef RT_ACCEL_LIGHT_LIGHT_H
#define RT_ACCEL_LIGHT_LIGHT_H

#include "accel/accel.h"
#include "accel/isa.h"

/* An object of a list, or RT_LIGHT_BEYOND. */
typedef struct RtLightEntry {
    float depth; /* of no point of the object in the cell less */
    RtRef object;
} RtLightEntry;

#define RT_LIGHT_BEYOND UINT32_MAX

enum { RT_LIGHT_MOST_CELLS = 4096 }; /* along the edge of a face */

typedef struct RtLightGrid {
    float u, w, scale;      /* the corner of cell (0, 0); cells per 1 of u and w */
    uint32_t columns, rows; /* cells; 0: nothing is seen on this face */
    uint32_t *first;        /* [columns * rows + 1] */
    RtLightEntry *entries;  /* [first[columns * rows]] */
} RtLightGrid;

/* What one light sees. */
typedef struct RtLightCube {
    RtLightGrid grids[6];
    double margin; /* E, by which boxes grow: see light_project.c */
} RtLightCube;

typedef struct RtLightBuffer {
    RtAccel base;
    uint32_t cells; /* as asked for */
    uint32_t longest;
    bool full_occlusion;
    bool serves;        /* else all rays are passed on, and there are no lists */
    RtBox domain;       /* where rays start that are answered; empty without objects */
    RtLightCube *cubes; /* [lights] */
} RtLightBuffer;

/* By how much cells grow in u and w on all sides: more than u can be wrong by where a ray is looked up. */
#define RT_LIGHT_EDGE 0x1p-20

/* The face that a ray with this direction comes to a light through. */
static inline int rt_light_face_of(RtVec3 dir) {
    int axis = rt_major_axis(dir);
    return 2 * axis + (dir.at[axis] < 0); /* it is seen from the light the other way */
}

/* The cell of that face; false if there is none: then nothing is in the way. */
static inline bool rt_light_cell_of(const RtLightGrid *grid, int face, RtVec3 dir, uint32_t *cell) {
    const int axis = face / 2;
    const float inv = -1 / fabsf(dir.at[axis]);
    float column = (dir.at[(axis + 1) % 3] * inv - grid->u) * grid->scale;
    float row = (dir.at[(axis + 2) % 3] * inv - grid->w) * grid->scale;
    if (!(column >= 0 && row >= 0 && column < (float)grid->columns && row < (float)grid->rows)) return false;
    *cell = (uint32_t)row * grid->columns + (uint32_t)column;
    return true;
}

/* A face of a light's cube. */
typedef struct RtLightFace {
    const RtGeometry *geometry;
    const RtLightCube *cube;
    const RtLightGrid *grid;
    RtVec3 position; /* of the light */
    int face;
} RtLightFace;

static inline RtLightFace rt_light_face(const RtLightBuffer *buffer, uint32_t light, int face) {
    const RtScene *scene = buffer->base.scene;
    const RtLightCube *cube = &buffer->cubes[light];
    return (RtLightFace){&scene->geometry, cube, &cube->grids[face], scene->lights[light].position, face};
}

/* ---- light_project.c ---- */

/* Where a box, grown by the margin, is seen on a face: u and w, cut at the borders of the face, and depth.
 * False if it is not seen there. */
typedef struct RtLightView {
    double lo[2], hi[2], near, far; /* near >= 0 */
} RtLightView;
bool rt_light_view(const RtLightFace *on, const RtBox *box, RtLightView *view);

#define RT_LIGHT_MAX_EDGES 8

/* A line through the projection of an edge: `line` . (u, w, 1) >= 0 on the object's side. */
typedef struct RtLightEdge {
    RtVec3d line;
    double outside; /* a cell does not see the object if at its middle the line is below this, */
    double inside;  /* and is all inside of the line if it is not below this */
} RtLightEdge;

/* An object, projected. */
typedef struct RtLightFootprint {
    double corner[2], width; /* of the grid; of a cell */
    uint32_t lo[2], hi[2];   /* it may be seen in columns lo[0]..hi[0] of rows lo[1]..hi[1] */
    double near, far;        /* depths */
    /* Of a flat object: a point of its plane at (u, w) has depth 1 / (plane . (u, w, 1)). */
    RtLightEdge edges[RT_LIGHT_MAX_EDGES];
    uint32_t edge_count;
    RtVec3d plane;
    double plane_across; /* by how much that changes from the middle of a cell to its borders */
    double nearer;       /* depths of hits there are at least those of the plane, times this */
    /* Of another one: the ball around it. Its radius is 0 if the object is flat. */
    RtVec3d center;
    double radius;
    bool covers; /* whether it covers cells that it fills: triangles, convex polygons, spheres */
} RtLightFootprint;

/* False if no cell can see the object. */
bool rt_light_project(const RtLightFace *on, uint32_t id, RtLightFootprint *footprint);

/* The columns *first..*last of a row beyond which rt_light_see is false; false if there are none. */
bool rt_light_columns(const RtLightFootprint *footprint, uint32_t row, uint32_t *first, uint32_t *last);

/* What a cell sees of it: nothing that a ray may hit is less deep than `near`, and if the object fills the
 * cell, it is nowhere deeper than `cover`, which is INFINITY otherwise. False if it sees nothing. `cover` is
 * a guess: rounding may let rays through. */
typedef struct RtLightDepths {
    float near, cover;
} RtLightDepths;
bool rt_light_see(const RtLightFootprint *footprint, uint32_t column, uint32_t row, RtLightDepths *depths);

/* ---- light_kernels.c, for each instruction set ---- */

RT_DECLARE_KERNELS(light);

#endif
