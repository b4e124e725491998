/* SPDX-License-Identifier: Apache-2.0 */
/* The rasteriser: tiles of the image, and flat objects drawn into them, sixteen samples at a time.
 *
 * Coordinates. A point q relative to the eye is P = (x . q, y . q, depth . q) of RtItemAim: seen at column
 * P.x / P.z, row P.y / P.z, at t = P.z. So the plane through an edge and the eye is linear in column and row,
 * and so is 1 / t on a plane (Olano & Greer 1997): nothing is divided by depth, and facets behind and around
 * the eye need no clipping. With P, Q the ends of an edge, D = Q - P, N the product of two edges:
 *
 *     edge(s) = (P x D) . (s, 1)      w(s) = 1 / t = N . (s, 1) / (N . P)          s = (column, row)
 *
 * Why a miss is certain, and depths are right. A hit function computes in rounded arithmetic: a hit at t
 * means that the ray's point at t is q - e, q a point of the facet. For edges |e| <= 0.65 * 2^-20 M, M the
 * largest distance along an axis from the eye (a triangle's vertices are off by 7 * 2^-24 M on two axes
 * across the ray, a polygon computes in double); for depths, which are brought into the facet's box, |e| <=
 * 2^-19 M. The ray's dir is off by b = 2^-24 of its length, so e is longer by t b. Moving a point by e moves
 * it by |e| g / t at most, in units of slope, where g is the largest length of dir; and what is linear in s
 * by its gradient G (per unit of slope) times that. Hence, w being known to within d,
 *
 *     edge(s) / |gradient| >= -g (0.65 * 2^-20 M (w + d) + b) * 1.25
 *     d <= 2 (e w + b) (w + G)            with e = 2^-19 M, as long as d <= w / 2
 *
 * to which we add the rounding of our own double arithmetic before, and of float32 within a tile. Where d is
 * more than w / 2 the depth says nothing: the facet is anywhere behind its nearest point. */
#ifndef RT_ACCEL_ITEM_RASTER_H
#define RT_ACCEL_ITEM_RASTER_H

#include "accel/item/item.h"

enum {
    RT_ITEM_TILE = 32,                                              /* samples along an edge of a tile */
    RT_ITEM_BLOCK = 4,                                              /* and of a block, which is a vector */
    RT_ITEM_LANES = RT_ITEM_BLOCK * RT_ITEM_BLOCK,                  /* samples of a block */
    RT_ITEM_BLOCKS = RT_ITEM_TILE * RT_ITEM_TILE / (RT_ITEM_LANES), /* of a tile */
    RT_ITEM_MAX_EDGES = 16,                                         /* of a facet */
    RT_ITEM_FACETS = 16,                                            /* made at once */
    RT_ITEM_CLASSES = 8                                             /* of depth, drawn near ones first */
};

/* What is known of each sample of a tile, while it is drawn: block after block, row after row in a block.
 * Depths are inverse, w = 1 / t, so that what is nearer is more. */
typedef struct RtItemTile {
    _Alignas(64) uint32_t id[RT_ITEM_BLOCKS][RT_ITEM_LANES]; /* of the nearest, RT_NO_OBJECT for none */
    float lo[RT_ITEM_BLOCKS][RT_ITEM_LANES];                 /* where it is hit, lo <= w <= hi; none: -1 */
    float hi[RT_ITEM_BLOCKS][RT_ITEM_LANES];
    float t[RT_ITEM_BLOCKS][RT_ITEM_LANES];     /* its t, where a hit function was asked, else -1 */
    float other[RT_ITEM_BLOCKS][RT_ITEM_LANES]; /* no other is hit at a w above; -1 for nowhere */
    _Alignas(64) float least[RT_ITEM_BLOCKS];   /* of lo in the block */
} RtItemTile;

/* A thread that draws tiles. */
typedef struct RtItemPainter {
    RtItemTile tile;
    const RtItemBuffer *buffer;
    uint32_t column, row;   /* the tile's upper left sample */
    uint32_t columns, rows; /* of it that are in the image */
    RtCrossing *room;       /* of hit functions */
    RtTally tally;          /* what they are asked */
    float nearest;          /* 1 / tmin: nothing is hit at a w above */
} RtItemPainter;

/* Facets in lanes: the coefficients of functions of (1, column, row), counted from the tile's corner. */
typedef struct RtItemFacets {
    _Alignas(64) float edge[RT_ITEM_MAX_EDGES][3][RT_ITEM_FACETS]; /* over their gradients: >= 0 inside */
    float depth[3][RT_ITEM_FACETS];                                /* w */
    float spread[3][RT_ITEM_FACETS]; /* d as a polynomial of w; infinite where nothing is known */
    float doubt[2][RT_ITEM_FACETS];  /* of edges: [0] + w [1] */
    float most[RT_ITEM_FACETS];      /* no w is above */
    int32_t lo[2][RT_ITEM_FACETS],
        hi[2][RT_ITEM_FACETS]; /* columns, rows where it may be seen, of the tile */
    uint32_t id[RT_ITEM_FACETS];
} RtItemFacets;

/* An object and the tiles that it may be seen in. */
typedef struct RtItemPlace {
    RtRef object;
    uint16_t lo[2], hi[2];
    uint16_t class; /* 0..RT_ITEM_CLASSES - 1, the nearest first */
} RtItemPlace;

/* paint.c */

/* Begins tile `at` of the image. */
void rt_item_begin_tile(RtItemPainter *painter, size_t at);

/* Object `id` may be hit, or is `certain` to be, at lo <= w <= hi by the ray of a sample. */
void rt_item_doubt(RtItemPainter *painter, uint32_t block, uint32_t lane, uint32_t id, float lo, float hi,
                   bool certain);

/* Draws objects that have curves or are concave. */
void rt_item_paint_curved(RtItemPainter *painter, uint32_t id);

/* Writes the tile into the image. */
void rt_item_end_tile(RtItemPainter *painter);

static inline uint32_t rt_item_tiles_across(const RtItemBuffer *buffer) {
    return (buffer->view.sampling.columns + RT_ITEM_TILE - 1) / RT_ITEM_TILE;
}

static inline uint32_t rt_item_tiles_down(const RtItemBuffer *buffer) {
    return (buffer->view.sampling.rows + RT_ITEM_TILE - 1) / RT_ITEM_TILE;
}

/* facet.c */

/* A flat convex polygon as a facet in lane 0, of *count edges; false for one that is not, has too many edges,
 * or is seen too flat. `footprint` is its own. */
bool rt_item_polygon(const RtItemPainter *painter, uint32_t id, const RtItemFootprint *footprint,
                     RtItemFacets *facets, uint32_t *count);

/* kernels.h, once for each instruction set */
struct RtItemPainting {
    /* The places of triangles first..first + count - 1 that may be seen, to places[*placed..); *placed is
     * brought forward. Those around the eye are left to rt_item_footprint: to around[0..*left). `nearer`
     * [RT_ITEM_CLASSES - 1], descending, divides them into classes by their w. */
    void (*place)(const RtItemBuffer *buffer, uint32_t first, uint32_t count, const float *nearer,
                  RtItemPlace *places, size_t *placed, uint32_t *around, size_t *left);
    /* Draws those of objects[0..count) that are triangles. */
    void (*paint)(RtItemPainter *painter, const RtRef *objects, size_t count);
    /* Draws a facet of lane 0. */
    void (*paint_facet)(RtItemPainter *painter, const RtItemFacets *facets, uint32_t edges);
};

extern const RtItemPainting rt_item_painting_portable, rt_item_painting_avx2, rt_item_painting_avx512;

#endif
