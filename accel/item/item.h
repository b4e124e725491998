/* SPDX-License-Identifier: Apache-2.0 */
/* The inside of item: its data, shared by the files of this folder.
 *
 * A sample of the image names the object that is seen there by its id, or is RT_NO_OBJECT where the ray of
 * the sample hits nothing, or RT_ITEM_UNDECIDED. Samples lie row after row from the upper left, as the
 * sources of primary rays count them.
 *
 * Invariant: the exact ray of a sample that names an object hits no other object before that one, by (t, id),
 * if it hits that one at all; the ray of a sample that is RT_NO_OBJECT hits nothing. Whether the named object
 * is hit need not be known: its hit function is called.
 *
 * Flat objects are drawn as facets, with the projection and the bounds of accel/raster/raster.h. Nothing is
 * divided by depth, so facets around the eye need no clipping. With P = (x . q, y . q, depth . q) for a point
 * q, D the difference of the two ends of an edge, N the product of two edges, and s = (column, row):
 *
 *     edge(s) = (P x D) . (s, 1)      w(s) = 1 / t = N . (s, 1) / (N . P)
 *
 * How far a hit can be from where these say. For edges E is 0.65 * 2^-20 M, because a triangle's vertices are
 * off by 7 * 2^-24 M on two axes across the ray and a polygon is computed in double; for depths, which are
 * clamped to the facet's box, E is 2^-19 M. The ray's direction is off by b = 2^-24 of its length, which adds
 * t b to E. Let g be the largest length of a direction. A point that moves by E moves by at most E g / t in
 * slope, and a function linear in s changes by that times its gradient G. With d the error of w:
 *
 *     edge(s) / |gradient| >= -g (0.65 * 2^-20 M (w + d) + b) * 1.25
 *     d <= 2 (e w + b) (w + G)            with e = 2^-19 M, as long as d <= w / 2
 *
 * To this comes the rounding of double arithmetic before a tile is drawn, and of float32 within it. Where d
 * exceeds w / 2 nothing is known but that the facet lies behind its nearest point. */
#ifndef RT_ACCEL_ITEM_ITEM_H
#define RT_ACCEL_ITEM_ITEM_H

#include "accel/accel.h"
#include "accel/isa.h"
#include "accel/raster/bins.h"
#include "core/base/simd_across.h"

RT_DECLARE_KERNELS(item);

#define RT_ITEM_UNDECIDED (UINT32_MAX - 1)

typedef struct RtItemRaster RtItemRaster;

/* A vector in double, and a fourth component. */
typedef RtDouble4 RtItemTerm;

/* Homogeneous coordinates in samples: a point q relative to the eye is seen at column x . q / z, row
 * y . q / z, at t = z, with z = depth . q. */
typedef struct RtItemProjection {
    RtVec3d x, y, depth;
    double scale[2];        /* samples per unit of slope: along x and y */
    double longest;         /* |dir| of all rays is below this */
    double direction_error; /* of positions in the image, -1..1, from rounding dir to float32 */
    RtVec3d across, down;   /* q . across / z and q . down / z are positions in -1..1 */
} RtItemProjection;

typedef struct RtItemBuffer {
    RtIsaAccel isa;
    const RtItemRaster *raster;
    RtView view;
    bool settle;
    uint32_t *samples; /* [rows * columns] */
    /* The dir of a sample's ray is columns[column] + rows[row], rounded to float32; the fourth component is
     * its tmax. */
    RtItemTerm *columns, *rows;
    RtItemProjection projection;
} RtItemBuffer;

static inline size_t rt_item_sample_count(const RtItemBuffer *buffer) {
    return (size_t)buffer->view.sampling.columns * buffer->view.sampling.rows;
}

static inline const RtGeometry *rt_item_geometry(const RtItemBuffer *buffer) {
    return &buffer->isa.base.scene->geometry;
}

/* ---- item_footprint.c ---- */

/* In views so wide that direction_error is larger everything is seen everywhere. */
#define RT_ITEM_MAX_DIRECTION_ERROR 0x1p-10

/* Needs the view. */
RtItemProjection rt_item_projection(const RtView *view);

/* Samples lo[0]..hi[0] of rows lo[1]..hi[1]; no ray hits the object at a t below `near`. */
typedef struct RtItemFootprint {
    uint32_t lo[2], hi[2];
    float near;
} RtItemFootprint;

/* The samples whose rays may hit an object, from its box; false if there are none. */
bool rt_item_footprint(const RtItemBuffer *buffer, uint32_t id, RtItemFootprint *footprint);

/* Its tiles, to *to; returns how many ranges these are, 0 or 1. */
uint32_t rt_item_place_footprint(const RtItemBuffer *buffer, uint32_t id, uint16_t layer, RtTileRange *to);

/* ---- tiles ---- */

enum {
    RT_ITEM_TILE = 32,                             /* samples along an edge of a tile */
    RT_ITEM_BLOCK = 4,                             /* and of a block */
    RT_ITEM_ACROSS = RT_ITEM_TILE / RT_ITEM_BLOCK, /* blocks along an edge of a tile */
    RT_ITEM_BLOCK_SAMPLES = RT_ITEM_BLOCK * RT_ITEM_BLOCK,
    RT_ITEM_BLOCKS = RT_ITEM_ACROSS * RT_ITEM_ACROSS,
    RT_ITEM_TILE_SAMPLES = RT_ITEM_TILE * RT_ITEM_TILE,
    RT_ITEM_MAX_EDGES = 16, /* of a facet */
    RT_ITEM_FACETS = 16,    /* made at once, at most; RT_LANES are */
    RT_ITEM_CLASSES = 8     /* of depth, the layers of tiles: near ones are drawn first */
};

/* The depth buffer of a tile: block after block, row after row in a block. Depths are inverse, w = 1 / t, so
 * that nearer is more. */
typedef struct RtItemTile {
    _Alignas(64) uint32_t id[RT_ITEM_TILE_SAMPLES]; /* of the nearest, RT_NO_OBJECT for none */
    float lo[RT_ITEM_TILE_SAMPLES];                 /* where it is hit, lo <= w <= hi; none: -1 */
    float hi[RT_ITEM_TILE_SAMPLES];
    float t[RT_ITEM_TILE_SAMPLES];            /* its t, if a hit function was asked, else -1 */
    float other[RT_ITEM_TILE_SAMPLES];        /* no other is hit at a w above; -1 for nowhere */
    _Alignas(64) float least[RT_ITEM_BLOCKS]; /* of lo in the block */
} RtItemTile;

/* A thread that draws tiles. */
typedef struct RtItemDrawing {
    RtItemTile tile;
    const RtItemBuffer *buffer;
    uint32_t column, row;   /* the tile's upper left sample */
    uint32_t columns, rows; /* of it that are in the image */
    RtCrossing *crossings;  /* of hit functions */
    RtTally tally;          /* of the hit functions asked */
    float nearest;          /* 1 / tmin: nothing is hit at a w above */
} RtItemDrawing;

/* Facets in lanes: the coefficients of functions of (1, column, row), counted from the tile's corner. */
typedef struct RtItemFacets {
    _Alignas(64) float edge[RT_ITEM_MAX_EDGES][3][RT_ITEM_FACETS]; /* over their gradients: >= 0 inside */
    float depth[3][RT_ITEM_FACETS];                                /* w */
    float depth_error[3][RT_ITEM_FACETS]; /* d as a polynomial of w; infinite where nothing is known */
    float edge_error[2][RT_ITEM_FACETS];  /* [0] + w [1] */
    float most[RT_ITEM_FACETS];           /* no w is above */
    int32_t lo[2][RT_ITEM_FACETS],
        hi[2][RT_ITEM_FACETS]; /* columns, rows of the tile, where it may be seen */
    uint32_t id[RT_ITEM_FACETS];
} RtItemFacets;

static inline uint32_t rt_item_tiles(uint32_t samples) {
    return (samples + RT_ITEM_TILE - 1) / RT_ITEM_TILE;
}

/* ---- item_tile.c ---- */

/* Begins tile `at` of the image. */
void rt_item_begin_tile(RtItemDrawing *drawing, size_t at);

/* The ray of a sample may hit object `id`, or is `certain` to, at lo <= w <= hi: decides which is nearest. */
void rt_item_resolve(RtItemDrawing *drawing, uint32_t sample, uint32_t id, float lo, float hi, bool certain);

/* Draws an object that is no triangle. */
void rt_item_draw_object(RtItemDrawing *drawing, uint32_t id);

/* Writes the tile into the image. */
void rt_item_end_tile(RtItemDrawing *drawing);

/* ---- item_polygon.c ---- */

/* Sets lane `lane` of *f to the place and depth of a footprint. */
void rt_item_place_facet(const RtItemDrawing *d, const RtItemFootprint *at, RtItemFacets *f, uint32_t lane);

/* A flat convex polygon as a facet in lane 0, of *count edges; false for an object that is none, has too many
 * edges, or is seen too obliquely. `footprint` is its own. */
bool rt_item_polygon(const RtItemDrawing *drawing, uint32_t id, const RtItemFootprint *footprint,
                     RtItemFacets *facets, uint32_t *count);

/* ---- item_kernels.c, for each instruction set ---- */

/* What placing triangles needs. */
typedef struct RtItemPlacing {
    RtItemBuffer *buffer;
    float nearer[RT_ITEM_CLASSES - 1]; /* a triangle is in the first class i with a largest w >= nearer[i] */
} RtItemPlacing;

struct RtItemRaster {
    /* For RtBinning. */
    uint32_t (*place)(const void *placing, uint32_t first, uint32_t count, RtTileRange *to);
    /* Draws the triangles among `objects`. */
    void (*draw)(RtItemDrawing *drawing, const RtRef *objects, size_t count);
    /* Draws the facet of lane 0. */
    void (*draw_facet)(RtItemDrawing *drawing, const RtItemFacets *facets, uint32_t edges);
};

extern const RtItemRaster rt_item_raster_portable, rt_item_raster_avx2, rt_item_raster_avx512;

/* ---- item_stats.c ---- */

bool rt_item_find_cell(const RtAccel *accel, const RtRay *ray, RtCellView *cell);
void rt_item_describe(const RtAccel *accel, RtDescription *out);
RtStatus rt_item_validate(const RtAccel *accel, RtError *error);

#endif
