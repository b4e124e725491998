/* SPDX-License-Identifier: Apache-2.0 */
/* The order in which a frame is traced: along a Z-order curve (Morton 1966, "A Computer Oriented Geodetic
 * Data Base and a New Technique in File Sequencing"). Consecutive rays are neighbours in the image in both
 * directions, and packets of 8, 16 or 64 are blocks of 4 x 2, 4 x 4 or 8 x 8 samples.
 *
 * The frame is cut into tiles of RT_TILE x RT_TILE samples. Tiles made of whole 8 x 8 blocks come first,
 * in the order of the curve, then those cut by the border. So each group of 64 consecutive samples is a
 * block until only the border is left. */
#ifndef RT_RENDER_TILES_H
#define RT_RENDER_TILES_H

#include "core/scene/camera.h"

#define RT_TILE       16
#define RT_TILE_BLOCK 64 /* samples of an aligned block of 8 x 8 */

/* A sample of the frame; the upper left one identifies a tile. */
typedef struct RtSample {
    uint32_t column, row;
} RtSample;

size_t rt_tile_count(const RtSampling *sampling);

/* Writes all tiles in order to tiles[0..rt_tile_count(sampling)). */
void rt_tiles_in_order(const RtSampling *sampling, RtSample *tiles);

/* Every other bit of `code`, from bit 0 on, compacted. */
static inline uint32_t rt_even_bits(uint32_t code) {
    uint32_t bits = 0;
    for (uint32_t i = 0; i < 16; i++) bits |= (code >> 2 * i & 1) << i;
    return bits;
}

/* Sample i, 0..RT_TILE * RT_TILE - 1, of the tile; it may lie outside the frame. */
static inline RtSample rt_tile_sample(RtSample tile, uint32_t i) {
    return (RtSample){tile.column + rt_even_bits(i), tile.row + rt_even_bits(i >> 1)};
}

/* The tile of a sample. */
static inline RtSample rt_tile_of(RtSample sample) {
    return (RtSample){sample.column - sample.column % RT_TILE, sample.row - sample.row % RT_TILE};
}

/* The place of a sample in its tile, row by row: 0..RT_TILE * RT_TILE - 1. */
static inline uint32_t rt_tile_place(RtSample sample) {
    return sample.row % RT_TILE * RT_TILE + sample.column % RT_TILE;
}

#endif
