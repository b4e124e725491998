/* SPDX-License-Identifier: Apache-2.0 */
#include "render/tiles.h"

typedef struct Walk {
    const RtSampling *sampling;
    uint32_t across, down; /* tiles */
    bool whole;            /* visit whole or cut tiles */
    RtSample *next;
} Walk;

static uint32_t tiles_along(uint32_t samples) {
    return (samples + RT_TILE - 1) / RT_TILE;
}

size_t rt_tile_count(const RtSampling *sampling) {
    return (size_t)tiles_along(sampling->columns) * tiles_along(sampling->rows);
}

/* Does the part of the tile inside the frame consist of whole 8 x 8 blocks? */
static bool is_whole(const RtSampling *sampling, RtSample tile) {
    uint32_t right = sampling->columns - tile.column, below = sampling->rows - tile.row;
    return (right >= RT_TILE || right % 8 == 0) && (below >= RT_TILE || below % 8 == 0);
}

/* Visits the square of side x side tiles from that column and row of tiles on. */
static void walk_square(Walk *walk, uint32_t column, uint32_t row, uint32_t side) {
    if (column >= walk->across || row >= walk->down) return;
    if (side == 1) {
        RtSample tile = {column * RT_TILE, row * RT_TILE};
        if (is_whole(walk->sampling, tile) == walk->whole) *walk->next++ = tile;
        return;
    }
    side /= 2;
    for (uint32_t quarter = 0; quarter < 4; quarter++)
        walk_square(walk, column + (quarter & 1) * side, row + (quarter >> 1) * side, side);
}

void rt_tiles_in_order(const RtSampling *sampling, RtSample *tiles) {
    Walk walk = {sampling, tiles_along(sampling->columns), tiles_along(sampling->rows), true, tiles};
    uint32_t side = 1;
    while (side < walk.across || side < walk.down) side *= 2;
    walk_square(&walk, 0, 0, side);
    walk.whole = false;
    walk_square(&walk, 0, 0, side);
}
