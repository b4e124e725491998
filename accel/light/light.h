/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of light: its data, shared by the files of this folder, and the geometry of cells.
 *
 * Around each light stands a cube of six faces, one per axis and direction: face 2 a + 1 looks from the light
 * along +a, 2 a along -a. A point at offset v from the light belongs to the face of its largest |v.at[a]|,
 * its depth, and lies on it at u = v.at[b] / depth, w = v.at[c] / depth, both in [-1, 1], with b, c the axes
 * after a. On each face lies a grid of square tiles, over the rectangle in which the scene is seen; what is
 * outside is lit. Tile (column, row) has u in grid.u + [column, column + 1] / grid.scale, w alike, and n x n
 * cells of equal width, n being as large as the objects seen there are small.
 *
 * Layout: tiles are face after face, row after row; tiles[k] is the number of the first cell of tile k,
 * counted from the first of its face, times 64, plus its n; a face has no more than RT_LIGHT_FACE_CELLS
 * cells, so that this fits into 32 bits. In a tile cells are row after row. The list of cell k of a light is
 * entries[first[k]..first[k + 1]), ascending by key, then by object. A key holds, from the highest bit: a 0;
 * 15 bits of depth, rounded down; and 16 bits for the 4 x 4 parts of the cell, row by row, that the object
 * may be seen in. A list that was cut ends in an entry RT_LIGHT_BEYOND: what is as deep or deeper may be
 * missing. Objects that touch a light are in its near list instead, because they would be in all cells.
 *
 * Invariant: an object that can block a ray from inside `domain` to the light is in the near list, or in the
 * list of the ray's cell, with a depth not above that of the ray and the part of the cell that the ray is in;
 * or the list was cut, at a depth not above that of the ray. Why rounding does not break it stands in
 * footprint.c. So cutting lists is free: it never changes an answer, but who gives it. */
#ifndef RT_ACCEL_LIGHT_LIGHT_H
#define RT_ACCEL_LIGHT_LIGHT_H

#include "accel/accel.h"
#include "accel/isa.h"

#include <assert.h>

#define RT_LIGHT_PARAMS(X)                                                                                   \
    X(RT_LIGHT_CELLS, "cells", RT_INT("0", 0, 4096, "1|7|256"),                                              \
      "cells along the longer edge of the part of a face that sees the scene; 0: as fine as the objects",    \
      "this program; Haines & Greenberg 1986 use 20 to 200")                                                 \
    X(RT_LIGHT_FULL_OCCLUSION, "full_occlusion", RT_FLAG("on"),                                              \
      "end a list where the whole cell is likely to be covered", "Haines & Greenberg 1986, of one object")   \
    X(RT_LIGHT_EXTENTS, "extents", RT_FLAG("on"),                                                            \
      "skip what is not seen in the part of the cell, a sixteenth, that the ray is in", "this program")      \
    X(RT_LIGHT_LONGEST, "longest", RT_INT("64", 1, 65534, "2"),                                              \
      "entries of a list; what lies deeper is passed on", "measured")

enum { RT_LIGHT_PARAMS(RT_PARAM_INDEX) RT_LIGHT_PARAM_COUNT };
extern const RtParam rt_light_params[RT_LIGHT_PARAM_COUNT];

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

/* The most cells along the edge of a tile, in a tile, and of a face. */
enum {
    RT_LIGHT_FINEST = 63,
    RT_LIGHT_TILE_CELLS = RT_LIGHT_FINEST * RT_LIGHT_FINEST,
    RT_LIGHT_FACE_CELLS = 1 << 26
};

typedef struct RtLightGrid {
    float u, w, scale;        /* the corner of tile (0, 0); tiles per 1 of u and w */
    float depth, depth_scale; /* the least depth there is, and steps of a key's depth per 1 */
    uint32_t columns, rows;   /* tiles; 0: nothing is seen on this face */
    uint32_t first_tile;      /* of the light's */
    uint32_t first_cell;      /* the same of cells */
    uint32_t finest; /* most cells along the edge of a tile; if `cells` are asked for, all have as many */
} RtLightGrid;

/* What one light sees. */
typedef struct RtLightCube {
    RtLightGrid grids[6];
    double margin;                   /* by which boxes grow: see footprint.c */
    bool serves;                     /* else all its rays are passed on, and there are no lists */
    uint32_t tile_count, cell_count; /* of all faces */
    uint32_t *tiles;                 /* [tile_count] */
    uint32_t *first;                 /* [cell_count + 1] */
    RtLightEntry *entries;           /* [first[cell_count]] */
    uint32_t near_count;
    uint32_t *near; /* [near_count] ids */
} RtLightCube;

typedef struct RtLightPainting RtLightPainting;

typedef struct RtLightBuffer {
    RtIsaAccel isa;
    const RtLightPainting *painting;
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

/* Cells along the edge of a tile, and its first cell, counted from that of its face; and from these a tile.
 */
static inline uint32_t rt_light_fineness(uint32_t tile) {
    return tile & 63;
}
static inline uint32_t rt_light_first_cell(uint32_t tile) {
    return tile >> 6;
}
static inline uint32_t rt_light_tile(uint32_t first_cell, uint32_t n) {
    assert(first_cell < RT_LIGHT_FACE_CELLS && n <= RT_LIGHT_FINEST);
    return first_cell << 6 | n;
}

/* A tile of a light. */
typedef struct RtLightTile {
    const RtLightBuffer *buffer;
    uint32_t light;
    int face;
    uint32_t column, row; /* in the grid of the face */
    uint32_t n;           /* cells along its edge */
} RtLightTile;

/* The id of an entry's object. */
static inline uint32_t rt_light_id_of(const RtGeometry *g, RtRef object) {
    switch (rt_ref_shape(object)) {
#define RT_LIGHT_ID(CONSTANT, name, Type)                                                                    \
    case RT_SHAPE_##CONSTANT: return g->name##_ids[rt_ref_index(object)];
        RT_SHAPES(RT_LIGHT_ID)
#undef RT_LIGHT_ID
    default: return RT_NO_OBJECT;
    }
}

/* ---- footprint.c ---- */

/* An offset from the light in the axes of a face: u, w, depth, the first two times depth. */
RtVec3d rt_light_offset(const RtLightBuffer *buffer, uint32_t light, int face, RtVec3d point);

/* Does a box, grown by the margin, hold the light? That of an object? */
bool rt_light_is_in(const RtLightBuffer *buffer, uint32_t light, const RtBox *box);
bool rt_light_is_near(const RtLightBuffer *buffer, uint32_t light, uint32_t id);

/* Where a box, grown by the margin, is seen on a face: u and w, cut at the borders of the face, and depth.
 * False if it is not. Not to be asked of boxes that hold the light. */
typedef struct RtLightView {
    double lo[2], hi[2], near, far;
} RtLightView;
bool rt_light_view(const RtLightBuffer *buffer, uint32_t light, int face, const RtBox *box,
                   RtLightView *view);

/* The tiles of a face that an object may be seen in from the light, columns lo[0]..hi[0] of rows
 * lo[1]..hi[1]. */
typedef struct RtLightFootprint {
    uint32_t lo[2], hi[2];
    float least[2], most[2]; /* the same in parts of tiles */
    float near, far;         /* depths, rounded outward */
} RtLightFootprint;

/* False if there are none. Not to be asked of objects that touch the light. */
bool rt_light_footprint(const RtLightBuffer *buffer, uint32_t light, int face, uint32_t id,
                        RtLightFootprint *footprint);

/* The cells of a footprint in a tile; none where lo > hi. And its parts of cells. */
typedef struct RtLightCells {
    int32_t lo[2], hi[2];
    int32_t part_lo[2], part_hi[2];
} RtLightCells;
RtLightCells rt_light_cells(const RtLightTile *tile, const RtLightFootprint *footprint);

#define RT_LIGHT_MAX_EDGES 8

/* What parts cells from an object: lines, and a plane of depths. x and y are columns and rows from the corner
 * of a tile. The object is not in the cell whose middle is (x, y) if parts[i] . (x, y, 1) < 0 for some i; not
 * in a part of a cell whose middle is (x, y) if that is below RT_LIGHT_NARROWER. Its
 * points there are no less deep than 1 / (slope . (x, y, 1)), unless that is above `far`, nor than `near`. */
#define RT_LIGHT_NARROWER 0.375f /* as |parts[i][0]| + |parts[i][1]| = 1, half a cell less half a part */
typedef struct RtLightOutline {
    uint32_t count;
    float parts[2 * RT_LIGHT_MAX_EDGES][3];
    float slope[3];
    bool covers; /* what is within inside[0..edges) is covered, at depth 1 / (face . (x, y, 1)) */
    uint32_t edges;
    float inside[RT_LIGHT_MAX_EDGES][3];
    float face[3];
} RtLightOutline;

/* Of a flat object, in cells of the tile; another has no parts, and its cells are to be asked about one by
 * one. */
void rt_light_outline(const RtLightTile *tile, uint32_t id, const RtLightFootprint *at,
                      RtLightOutline *outline);

/* Of an object that is not flat: may it be seen in a cell of the tile? And does it hide all that is behind it
 * in the direction of the lower corner of cell (column, row)? Then *depth is where. */
bool rt_light_touches(const RtLightTile *tile, uint32_t id, uint32_t column, uint32_t row);
bool rt_light_covers(const RtLightTile *tile, uint32_t id, uint32_t column, uint32_t row, float *depth);

/* ---- kernels.h and raster.h, for each instruction set ---- */

/* Where triangles are seen, in lanes. */
typedef struct RtLightPlace {
    uint32_t object;       /* RtRef, or index of a triangle */
    uint16_t lo[2], hi[2]; /* tiles */
    uint8_t face;
    bool drawn; /* can be drawn in lanes; else the footprint is to be asked for */
} RtLightPlace;

/* A small triangle has a footprint of at most so many cells squared. */
enum { RT_LIGHT_SMALL_CELLS = 8 };

/* A tile on its way: what the cells may see. */
typedef struct RtLightDesk {
    float corner[RT_LIGHT_FINEST + 5][RT_LIGHT_FINEST + 17]; /* depth that is covered there, or INFINITY */
    float cover[RT_LIGHT_FINEST + 5][RT_LIGHT_FINEST + 17];  /* depth beyond which a cell is covered */
    uint64_t cut[RT_LIGHT_FINEST + 5]; /* by row, bit by column: something deeper was left out */
    /* Candidates in runs of one object: cell of the tile, and key. */
    uint32_t *cell, *key;
    uint32_t count, cell_capacity, key_capacity;
    RtLightEntry *runs; /* key: how many */
    uint32_t run_count, run_capacity;
} RtLightDesk;

/* What a small triangle adds at most. */
enum { RT_LIGHT_SMALL_ROOM = RT_LIGHT_SMALL_CELLS * RT_LIGHT_SMALL_CELLS };

struct RtLightPainting {
    /* Triangles first..first+count-1 (at most 16): where they are seen, to `places`, at most six each; gives
     * how many that are. */
    uint32_t (*place)(const RtLightBuffer *buffer, uint32_t light, uint32_t first, uint32_t count,
                      RtLightPlace *places);
    /* Of up to sixteen triangles those that are small in the tile: the corners they cover; and their
     * candidates, for which there is room. Gives those that are not. */
    uint32_t (*cover)(const RtLightTile *tile, const uint32_t *triangles, uint32_t count, RtLightDesk *desk);
    uint32_t (*draw)(const RtLightTile *tile, const uint32_t *triangles, uint32_t count, RtLightDesk *desk);
    /* The same of one object by its outline: `room` for all cells of the tile. */
    void (*cover_outline)(const RtLightOutline *outline, const RtLightCells *at, RtLightDesk *desk);
    void (*draw_outline)(const RtLightTile *tile, const RtLightOutline *outline, const RtLightFootprint *from,
                         const RtLightCells *at, RtRef object, RtLightDesk *desk);
};

RT_DECLARE_KERNELS(light);
extern const RtLightPainting rt_light_painting_portable, rt_light_painting_avx2, rt_light_painting_avx512;

/* ---- bins.c ---- */

/* What falls into the tiles of a light: objects[first[k]..first[k + 1]) into tile k. */
#define RT_LIGHT_ALONE 0x80000000u /* of what is not drawn in lanes */
typedef struct RtLightBins {
    uint32_t *first;   /* [tiles + 1] */
    uint32_t *objects; /* [first[tiles]] RtRef and RT_LIGHT_ALONE */
} RtLightBins;

RtStatus rt_light_fill_bins(const RtLightBuffer *buffer, uint32_t light, int threads, RtLightBins *bins,
                            RtError *error);

/* ---- tile.c ---- */

/* Makes the lists of all lights, each tile's of no more than `most` entries. */
RtStatus rt_light_make_lists(RtLightBuffer *buffer, uint32_t most, int threads, RtError *error);

/* ---- build.c ---- */
RtStatus rt_light_build(const RtBuild *what, RtAccel **out, RtError *error);
void rt_light_destroy(RtAccel *accel);

/* stats.c */
bool rt_light_look_up(const RtAccel *accel, const RtRay *ray, RtCellView *cell);
void rt_light_describe(const RtAccel *accel, RtDescription *out);
RtStatus rt_light_validate(const RtAccel *accel, RtError *error);

#endif
