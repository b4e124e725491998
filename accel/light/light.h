/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of light: its data, shared by the files of this folder, and the geometry of cells.
 *
 * Around each light stands a cube of six faces, one per axis and direction: face 2 a + 1 looks from the light
 * along +a, 2 a along -a. A point at offset v from the light belongs to the face of its largest |v.at[a]|,
 * which is its depth, and lies on it at u = v.at[b] / depth, w = v.at[c] / depth, both in [-1, 1], with b, c
 * the axes after a. On each face lies a grid of square tiles over the rectangle in which the scene is seen;
 * outside of it everything is lit. Tile (column, row) has u in grid.u + [column, column + 1] / grid.scale, w
 * alike, and n x n cells of equal width: the smaller the objects there, the more.
 *
 * Layout: tiles are face after face, row after row; tiles[k] is the number of the first cell of tile k,
 * counted from the first of its face, times 64, plus its n; a face has at most RT_LIGHT_FACE_CELLS cells, so
 * that this fits into 32 bits. In a tile cells are row after row. The list of cell k of a light is
 * entries[first[k]..first[k + 1]), ascending by key, then by object. A key holds, from the highest bit: a 0;
 * 15 bits of depth, rounded down; and 16 bits for the 4 x 4 parts of the cell, row by row, that the object
 * may be seen in. A list that was cut ends in an entry RT_LIGHT_BEYOND: objects as deep or deeper may be
 * missing. Objects that touch a light would be in all cells; they are in its near list instead.
 *
 * Invariant: an object that can occlude a ray from inside `domain` to the light is in the near list, or in
 * the list of the ray's cell, with a depth not above that of the ray's origin and the part of the cell that
 * the ray is in; or the list was cut, at a depth not above that of the origin. light_footprint.c proves it.
 * So cutting lists never changes an answer, only which layer finds it. */
#ifndef RT_ACCEL_LIGHT_LIGHT_H
#define RT_ACCEL_LIGHT_LIGHT_H

#include "accel/accel.h"
#include "accel/isa.h"
#include "accel/raster/bins.h"

#include <assert.h>

/* An object of a list, or RT_LIGHT_BEYOND. */
typedef struct RtLightEntry {
    uint32_t key;
    RtRef object;
} RtLightEntry;

#define RT_LIGHT_BEYOND UINT32_MAX

/* What a key can hold. */
#define RT_LIGHT_DEPTHS 32768
#define RT_LIGHT_PARTS  0xffffu
enum { RT_LIGHT_PART = 4 }; /* parts along the edge of a cell */

/* The most cells along the edge of a tile (its resolution), in a tile, and of a face. */
enum {
    RT_LIGHT_MAX_RESOLUTION = 63,
    RT_LIGHT_TILE_CELLS = RT_LIGHT_MAX_RESOLUTION * RT_LIGHT_MAX_RESOLUTION,
    RT_LIGHT_FACE_CELLS = 1 << 26
};

typedef struct RtLightGrid {
    float u, w, scale;        /* the corner of tile (0, 0); tiles per 1 of u and w */
    float depth, depth_scale; /* the least depth there is, and steps of a key's depth per 1 */
    uint32_t columns, rows;   /* tiles; 0: nothing is seen on this face */
    uint32_t first_tile;      /* of the light's */
    uint32_t first_cell;      /* the same of cells */
    uint32_t max_resolution;  /* of its tiles; if `cells` are asked for, all have as many */
} RtLightGrid;

/* What one light sees. */
typedef struct RtLightCube {
    RtLightGrid grids[6];
    double margin;                   /* E, by which boxes grow: see light_footprint.c */
    bool serves;                     /* else all its rays are passed on, and there are no lists */
    uint32_t tile_count, cell_count; /* of all faces */
    uint32_t *tiles;                 /* [tile_count] */
    uint32_t *first;                 /* [cell_count + 1] */
    RtLightEntry *entries;           /* [first[cell_count]] */
    uint32_t near_count;
    uint32_t *near; /* [near_count] ids */
} RtLightCube;

typedef struct RtLightRaster RtLightRaster;

typedef struct RtLightBuffer {
    RtIsaAccel isa;
    const RtLightRaster *raster;
    uint32_t cells; /* as asked for */
    uint32_t longest;
    bool full_occlusion, extents;
    bool serves;        /* whether some light does */
    RtBox domain;       /* where rays start that are answered; empty without objects */
    RtLightCube *cubes; /* [lights] */
} RtLightBuffer;

/* By how much cells grow in u and w on all sides: more than u can be wrong by where a ray is looked up. */
#define RT_LIGHT_EDGE 0x1p-20

/* The depth of a key; it does not fall where `depth` rises. */
static inline uint32_t rt_light_depth_key(const RtLightGrid *grid, float depth) {
    float step = (depth - grid->depth) * grid->depth_scale;
    return step > 0 ? (step < RT_LIGHT_DEPTHS - 1 ? (uint32_t)step : RT_LIGHT_DEPTHS - 1) : 0;
}

/* The resolution of a tile, its first cell, counted from that of its face, and a tile from these. */
static inline uint32_t rt_light_resolution(uint32_t tile) {
    return tile & 63;
}
static inline uint32_t rt_light_first_cell(uint32_t tile) {
    return tile >> 6;
}
static inline uint32_t rt_light_tile(uint32_t first_cell, uint32_t n) {
    assert(first_cell < RT_LIGHT_FACE_CELLS && n <= RT_LIGHT_MAX_RESOLUTION);
    return first_cell << 6 | n;
}

/* A face of a light's cube. */
typedef struct RtLightFace {
    const RtLightBuffer *buffer;
    const RtGeometry *geometry;
    const RtLightCube *cube;
    const RtLightGrid *grid;
    RtVec3 position; /* of the light */
    int face;
} RtLightFace;

static inline RtLightFace rt_light_face(const RtLightBuffer *buffer, uint32_t light, int face) {
    const RtScene *scene = buffer->isa.base.scene;
    const RtLightCube *cube = &buffer->cubes[light];
    return (RtLightFace){buffer, &scene->geometry, cube, &cube->grids[face], scene->lights[light].position,
                         face};
}

/* A tile of a face. */
typedef struct RtLightTile {
    RtLightFace on;
    uint32_t column, row; /* in the grid of the face */
    uint32_t n;           /* its resolution */
} RtLightTile;

/* ---- light_footprint.c ---- */

/* Does a box, grown by the margin, hold the light? */
bool rt_light_is_in(const RtLightFace *on, const RtBox *box);

/* Does the box of an object? */
static inline bool rt_light_is_near(const RtLightFace *on, uint32_t id) {
    return rt_light_is_in(on, &on->geometry->boxes[id]);
}

/* Where a box, grown by the margin, is seen on a face: u and w, cut at the borders of the face, and depth.
 * False if it is not seen there. For boxes that do not hold the light. */
typedef struct RtLightView {
    double lo[2], hi[2], near, far;
} RtLightView;
bool rt_light_view(const RtLightFace *on, const RtBox *box, RtLightView *view);

/* The tiles of a face that an object may be seen in, columns lo[0]..hi[0] of rows lo[1]..hi[1]. */
typedef struct RtLightFootprint {
    uint32_t lo[2], hi[2];
    float least[2], most[2]; /* the same in parts of tiles */
    float near, far;         /* depths, rounded outward */
} RtLightFootprint;

/* False if there are none. For objects that do not touch the light. */
bool rt_light_footprint(const RtLightFace *on, uint32_t id, RtLightFootprint *footprint);

/* The tiles of an object that is not drawn in lanes, to to[0]; returns how many ranges these are, 0 or 1. */
uint32_t rt_light_place(const RtLightFace *on, uint32_t id, RtTileRange *to);

/* The cells of a footprint in a tile; none where lo > hi. And its parts of cells. */
typedef struct RtLightCells {
    int32_t lo[2], hi[2];
    int32_t part_lo[2], part_hi[2];
} RtLightCells;
RtLightCells rt_light_cells(const RtLightTile *tile, const RtLightFootprint *footprint);

#define RT_LIGHT_MAX_EDGES 8

/* Lines that separate cells from an object, and a plane of depths. x and y are columns and rows from the
 * corner of a tile. The object is not in the cell whose middle is (x, y) if parts[i] . (x, y, 1) < 0 for some
 * i; not in a part of a cell whose middle is (x, y) if that is below RT_LIGHT_NARROWER. Its points there are
 * no less deep than 1 / (slope . (x, y, 1)), unless that is above `far`, nor than `near`. */
#define RT_LIGHT_NARROWER 0.375f /* as |parts[i][0]| + |parts[i][1]| = 1, half a cell less half a part */
typedef struct RtLightOutline {
    uint32_t count;
    float parts[2 * RT_LIGHT_MAX_EDGES][3];
    float slope[3];
    bool covers; /* it covers what is within inside[0..edges), at depth 1 / (face . (x, y, 1)) */
    uint32_t edges;
    float inside[RT_LIGHT_MAX_EDGES][3];
    float face[3];
} RtLightOutline;

static inline bool rt_light_is_flat(RtRef object) {
    return rt_ref_shape(object) == RT_SHAPE_TRIANGLE || rt_ref_shape(object) == RT_SHAPE_POLYGON;
}

/* Of a flat object, in cells of the tile. */
void rt_light_outline(const RtLightTile *tile, uint32_t id, const RtLightFootprint *at,
                      RtLightOutline *outline);

/* Of an object that is not flat: may it be seen in a cell of the tile? And does it cover the lower corner of
 * cell (column, row)? Then *depth is where. */
bool rt_light_touches(const RtLightTile *tile, uint32_t id, uint32_t column, uint32_t row);
bool rt_light_covers(const RtLightTile *tile, uint32_t id, uint32_t column, uint32_t row, float *depth);

/* ---- light_kernels.c, for each instruction set ---- */

/* Set in the objects of tiles that are drawn by their footprint, not in lanes. */
#define RT_LIGHT_BY_FOOTPRINT 0x80000000u

/* A small triangle has a footprint of at most so many cells squared. */
enum { RT_LIGHT_SMALL_CELLS = 8, RT_LIGHT_SMALL_ROOM = RT_LIGHT_SMALL_CELLS * RT_LIGHT_SMALL_CELLS };

/* A tile while its lists are made. */
typedef struct RtLightDraft {
    float corner[RT_LIGHT_MAX_RESOLUTION + 5]
                [RT_LIGHT_MAX_RESOLUTION + 17]; /* depth that is covered there, or INFINITY */
    float cover[RT_LIGHT_MAX_RESOLUTION + 5]
               [RT_LIGHT_MAX_RESOLUTION + 17]; /* depth beyond which a cell is covered */
    uint64_t cut[RT_LIGHT_MAX_RESOLUTION + 5]; /* by row, bit by column: something deeper was left out */
    /* Candidates in runs of one object: cell of the tile, and key. */
    uint32_t *cell, *key;
    uint32_t count, cell_capacity, key_capacity;
    RtLightEntry *runs; /* key: how many */
    uint32_t run_count, run_capacity;
} RtLightDraft;

struct RtLightRaster {
    /* For RtBinning; the layers are the faces. */
    uint32_t (*place)(const void *faces, uint32_t first, uint32_t count, RtTileRange *to);
    /* The small ones of up to sixteen triangles: the corners they cover, and their candidates, for which
     * there is room. Both return those that are not small. */
    uint32_t (*cover)(const RtLightTile *tile, const RtRef *triangles, uint32_t count, RtLightDraft *draft);
    uint32_t (*draw)(const RtLightTile *tile, const RtRef *triangles, uint32_t count, RtLightDraft *draft);
    /* The same of one object by its outline, with room for all cells of the tile. */
    void (*cover_outline)(const RtLightOutline *outline, const RtLightCells *at, RtLightDraft *draft);
    void (*draw_outline)(const RtLightTile *tile, const RtLightOutline *outline, const RtLightFootprint *from,
                         const RtLightCells *at, RtRef object, RtLightDraft *draft);
};

RT_DECLARE_KERNELS(light);
extern const RtLightRaster rt_light_raster_portable, rt_light_raster_avx2, rt_light_raster_avx512;

/* ---- light_lists.c ---- */

/* Makes the lists of all lights, each tile's of no more than `most` entries. */
RtStatus rt_light_make_lists(RtLightBuffer *buffer, uint32_t most, int threads, RtError *error);

/* Frees the lists of a light, which no longer serves. */
void rt_light_drop(RtLightCube *cube);

/* ---- light_choice.c ---- */

typedef struct RtLightProbes RtLightProbes;

/* Before lists are made: chooses the lights that may serve. Those of `cells` all do. *out: probes for the
 * second choice, to be freed with rt_free; NULL if there is none. */
RtStatus rt_light_choose(RtLightBuffer *buffer, RtLightProbes **out, RtError *error);

/* After lists are made: drops the lists of lights that cost more with than without them. */
RtStatus rt_light_choose_again(RtLightBuffer *buffer, RtLightProbes *p, RtError *error);

/* ---- light_stats.c ---- */
uint64_t rt_light_bytes(const RtLightCube *cube);
bool rt_light_find_cell(const RtAccel *accel, const RtRay *ray, RtCellView *cell);
void rt_light_describe(const RtAccel *accel, RtDescription *out);
RtStatus rt_light_validate(const RtAccel *accel, RtError *error);

#endif
