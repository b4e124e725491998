/* SPDX-License-Identifier: Apache-2.0 */
/* item: the item buffer of Weghorst, Hooper & Greenberg 1984, an overlay for primary rays: its data, shared
 * by the files of this folder.
 *
 * All objects are drawn into a z-buffer of object ids, the items. A primary ray then tests the one object
 * that its sample names, or none. Samples lie row after row from the upper left, as the sources of primary
 * rays count them.
 *
 * Invariant: a sample names the object that its ray hits first, by (t, id), or RT_NO_OBJECT.
 *
 * A z-buffer that interpolated depths would round otherwise than a ray tracer. This one has no arithmetic of
 * its own: at each sample that an object may be seen at, the object's hit function tells coverage and depth,
 * for the very ray that will be traced. Only where an object cannot be seen (item_draw.c,
 * item_kernels.c), or is behind all that is drawn already, is it not asked. */
#ifndef RT_ACCEL_ITEM_ITEM_H
#define RT_ACCEL_ITEM_ITEM_H

#include "accel/accel.h"
#include "accel/isa.h"
#include "accel/raster/raster.h"
#include "core/base/simd.h"

RT_DECLARE_KERNELS(item);

typedef struct RtItemRaster RtItemRaster;

enum {
    RT_ITEM_TILE = 32,                             /* samples along an edge of a tile */
    RT_ITEM_BLOCK = 4,                             /* and of a block */
    RT_ITEM_ACROSS = RT_ITEM_TILE / RT_ITEM_BLOCK, /* blocks along an edge of a tile */
    RT_ITEM_BLOCK_SAMPLES = RT_ITEM_BLOCK * RT_ITEM_BLOCK,
    RT_ITEM_BLOCKS = RT_ITEM_ACROSS * RT_ITEM_ACROSS,
    RT_ITEM_TILE_SAMPLES = RT_ITEM_TILE * RT_ITEM_TILE,
    RT_ITEM_CLASSES = 8 /* of depth: near ones are drawn first, to hide others */
};

/* A vector in double, and a fourth component. */
typedef RtDouble4 RtItemTerm;

/* Homogeneous coordinates in samples: a point q relative to the eye is seen at column x . q / z, row
 * y . q / z, at t = z, with z = depth . q. */
typedef struct RtItemProjection {
    RtVec3d x, y, depth;
    double scale[2];        /* samples per unit of slope: along x and y */
    double longest;         /* |dir| of all rays is below this */
    double direction_error; /* of positions in the image, -1..1, from rounding dir to float32 */
} RtItemProjection;

typedef struct RtItemBuffer {
    RtAccel base;
    const RtItemRaster *raster;
    RtView view;
    uint32_t *samples; /* [rows * columns]: object ids, also of those in instances */
    /* The dir of a sample's ray is columns[column] + rows[row], rounded to float32; the fourth component is
     * its tmax. Up to whole tiles, beyond the image. */
    RtItemTerm *columns, *rows;
    RtItemProjection projection;
    float farther[RT_ITEM_CLASSES - 1]; /* class i + 1 of depth holds objects from this t on */
} RtItemBuffer;

static inline uint32_t rt_item_tiles(uint32_t samples) {
    return (samples + RT_ITEM_TILE - 1) / RT_ITEM_TILE;
}

static inline size_t rt_item_sample_count(const RtItemBuffer *buffer) {
    return (size_t)buffer->view.sampling.columns * buffer->view.sampling.rows;
}

static inline const RtGeometry *rt_item_geometry(const RtItemBuffer *buffer) {
    return &buffer->base.scene->geometry;
}

/* ---- item_draw.c ---- */

/* Needs the view. */
RtItemProjection rt_item_projection(const RtView *view);

/* In views so wide that direction_error is larger everything is seen everywhere. */
#define RT_ITEM_MAX_DIRECTION_ERROR 0x1p-10

/* Samples lo[0]..hi[0] of rows lo[1]..hi[1]; no ray hits the object at a t below `near`. */
typedef struct RtItemFootprint {
    uint32_t lo[2], hi[2];
    float near;
} RtItemFootprint;

/* The samples whose rays may hit an object, from its box; false if there are none. */
bool rt_item_footprint(const RtItemBuffer *buffer, uint32_t id, RtItemFootprint *footprint);

/* The tiles that an object may be seen in: columns lo[0]..hi[0] of rows lo[1]..hi[1]; and its class of
 * depth. */
typedef struct RtItemRange {
    RtRef object;
    uint16_t lo[2], hi[2];
    uint16_t depth;
} RtItemRange;

RtItemRange rt_item_range(const RtItemBuffer *buffer, RtRef object, const RtItemFootprint *at);

/* The z-buffer of a tile, one for each thread: block after block, row after row in a block. */
typedef struct RtItemTile {
    _Alignas(64) float dir[RT_ITEM_TILE_SAMPLES][4]; /* of the ray, and its tmax */
    float t[RT_ITEM_TILE_SAMPLES];     /* of the nearest hit; INFINITY for none, -1 beside the image */
    uint32_t id[RT_ITEM_TILE_SAMPLES]; /* its object, or RT_NO_OBJECT */
    float farthest[RT_ITEM_BLOCKS];    /* t of a block */
    const RtItemBuffer *buffer;
    uint32_t column, row;   /* of its upper left sample */
    uint32_t columns, rows; /* of it that are in the image */
    RtQuery query;          /* of the layer below, for hit functions in parts */
    RtTally tally;          /* of the hit functions asked */
} RtItemTile;

/* Draws an object that is no triangle. */
void rt_item_draw_object(RtItemTile *tile, uint32_t id);

/* To be called for a block whose samples have changed. */
void rt_item_update_farthest(RtItemTile *tile, uint32_t block);

/* Fills in the samples. */
RtStatus rt_item_draw_all(RtItemBuffer *buffer, int threads, RtError *error);

/* ---- item_kernels.c, for each instruction set ---- */

struct RtItemRaster {
    /* Writes the ranges of those of the triangles first..first + count - 1 that may be seen; their number. */
    uint32_t (*place)(const RtItemBuffer *buffer, uint32_t first, uint32_t count, RtItemRange *to);
    void (*draw)(RtItemTile *tile, const RtRef *objects, size_t count);
};

extern const RtItemRaster *const rt_item_raster_portable, *const rt_item_raster_avx2,
                                                              *const rt_item_raster_avx512;

#endif
