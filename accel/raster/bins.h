/* SPDX-License-Identifier: Apache-2.0 */
/* Which objects may be seen in which tile (the sort-middle of Molnar et al. 1994): objects are projected by
 * threads, each a contiguous part of them, and counted by tile; sums over tiles and parts say where each
 * goes. A tile's objects come in one order, triangles first, whatever the number of threads. */
#ifndef RT_ACCEL_RASTER_BINS_H
#define RT_ACCEL_RASTER_BINS_H

#include "accel/raster/raster.h"

/* Tile (column, row) of a layer has list first + column * column_stride + row * row_stride. */
typedef struct RtTileLayer {
    uint32_t first, column_stride, row_stride;
} RtTileLayer;

enum {
    RT_TILE_LAYERS = 8,
    RT_TILE_APART = RT_TILE_LAYERS, /* the layer of a range that is in no list */
    RT_TILE_TRIANGLES = 256,        /* placed in one call */
    RT_TILE_MOST_RANGES = 6         /* of an object */
};

/* What is to be sorted. Both functions write the ranges of objects that may be seen, and return how many. */
typedef struct RtBinning {
    const RtGeometry *geometry;
    const char *what; /* the structure, for messages */
    const void *view; /* for the functions */
    uint32_t (*place_triangles)(const void *view, uint32_t first, uint32_t count, RtTileRange *to);
    uint32_t (*place_object)(const void *view, uint32_t id, RtTileRange *to); /* no triangle */
    size_t lists;
    RtTileLayer layers[RT_TILE_LAYERS];
    uint32_t most_tiles; /* ranges of more are kept apart */
} RtBinning;

/* List k is objects[first[k]..first[k + 1]). */
typedef struct RtBins {
    size_t *first; /* [lists + 1] */
    uint32_t *objects;
    RtTileRange *large; /* [large_count] kept apart: those of many tiles, and then those of no layer */
    size_t large_count;
} RtBins;

/* Clear with rt_bins_clear, also where this fails. */
RtStatus rt_bins_fill(const RtBinning *what, int threads, RtBins *bins, RtError *error);
void rt_bins_clear(RtBins *bins);

#endif
