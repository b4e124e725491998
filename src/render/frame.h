/* SPDX-License-Identifier: Apache-2.0 */
/* Frames: one image of a scene, traced recursively with the standard illumination model, on any accelerator.
 *
 * A frame is cut into tiles, the work items of threads. Within a tile rays are traced
 * level by level: all primary rays as one stream, then all shadow rays of their hits, then all reflection
 * and transmission rays that they spawned, and so on, so that an accelerator sees streams. A level of more
 * than 1024 rays is cut into streams, each followed to the bottom before the next; shadow rays are traced
 * light by light. A counted frame traces one ray at a time, to attribute its cost to its sample. A tile
 * writes only to its own place, in an order that depends on the tile alone: the frame is byte-identical at
 * any number of threads. */
#ifndef RT_RENDER_FRAME_H
#define RT_RENDER_FRAME_H

#include "accel/accel.h"
#include "render/illumination.h"

/* ---- tiles ---- */

/* The order in which a frame is traced: along a Z-order curve (Morton 1966, "A Computer Oriented Geodetic
 * Data Base and a New Technique in File Sequencing"). Consecutive rays are neighbours in the image in both
 * directions, and packets of 8, 16 or 64 are blocks of 4 x 2, 4 x 4 or 8 x 8 samples.
 *
 * The frame is cut into tiles of RT_TILE x RT_TILE samples. Tiles made of whole 8 x 8 blocks come first,
 * in the order of the curve, then those cut by the border. So each group of 64 consecutive samples is a
 * block until only the border is left. */
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

/* ---- frames ---- */

#define RT_MAX_DEPTH     64
#define RT_DEFAULT_DEPTH 5 /* as in SPD */

/* Larger frames are rejected: 8192 x 8192 samples take 1.3 GB, counted 6.7 GB. */
#define RT_MAX_FRAME_SAMPLES (UINT32_C(1) << 26)

/* A ray of a sample, after it was traced. */
typedef struct RtFrameRay {
    const RtRay *ray;
    uint32_t parent;          /* number of the ray from whose hit it starts; RT_NO_RAY for the primary ray */
    float factor;             /* of its light in the sample's colour: the product of kr and kt on the way */
    RtHit hit;                /* RT_MISS for shadow rays */
    const RtSurface *surface; /* what it hit; NULL for a miss, and for shadow rays */
    bool occluded;            /* of a shadow ray */
    RtVec3 light; /* what it adds, without the factor: the surface's ambient light, the background, or that of
                   * the light that it sees */
} RtFrameRay;
#define RT_NO_RAY UINT32_MAX

/* Sees the rays of the samples of one tile. Those of a sample are numbered 0, 1, ... in the order in which
 * their light is added. */
typedef struct RtFrameObserver {
    RtSample tile; /* of rt_tile_of */
    const RtRay
        *given; /* NULL, or a valid ray to trace as the primary ray of the tile's first sample, alone */
    void (*see)(void *context, RtSample sample, const RtFrameRay *ray);
    void *context;
} RtFrameObserver;

typedef struct RtFrameOptions {
    uint32_t depth;          /* levels of the ray tree, 1..RT_MAX_DEPTH; the primary ray is the first */
    int threads;             /* 0 = all processors */
    bool counted;            /* fill tallies and costs; else the timed kernels run */
    uint32_t cost_kinds;     /* ray kinds that count towards a sample's cost, bits 1 << RtRayKind; 0: all */
    bool light_from_outside; /* light surfaces from outside, whichever side the ray comes from */
    bool keep_rays;          /* keep all traced rays */
    bool share;              /* fill `share`; reading the clock costs about 50 ns per stream of rays */
    const RtFrameObserver *observer; /* optional: trace only its tile */
    /* Optional: called by one thread at a time when a tile is finished. */
    void (*progress)(void *context, size_t tiles_done, size_t tiles);
    void *progress_context;
} RtFrameOptions;

/* Arrays of one value per sample, [rows * columns], row by row from the upper left. Owned. */
typedef struct RtFrame {
    RtSampling sampling;
    RtArena memory;   /* of the arrays but for rays */
    RtVec3 *color;    /* linear rgb */
    uint32_t *object; /* primary hit, RT_NO_OBJECT for none */
    float *depth;     /* t of the primary hit (distance along the camera's axis), INFINITY for none */
    RtTally *cost;    /* cost of the sample's ray tree, restricted to cost_kinds; NULL unless counted */
    RtTally tallies[RT_RAY_KIND_COUNT];    /* zero unless counted */
    uint64_t ray_count[RT_RAY_KIND_COUNT]; /* rays traced, by kind */
    /* [ray_count] with keep_rays, else NULL. Tile after tile; within a tile in the order of tracing: level
     * by level, stream by stream. */
    RtRay *rays[RT_RAY_KIND_COUNT];
    double seconds; /* wall time of the frame */
    double share;   /* of the threads' time, the part spent in queries, 0..1; 0 unless asked for */
} RtFrame;

/* Traces the frame of the accelerator's scene and sampling. Free with rt_frame_clear; after a failure it
 * is empty. */
RtStatus rt_frame_trace(RtFrame *frame, const RtAccel *accel, const RtFrameOptions *options, RtError *error);
void rt_frame_clear(RtFrame *frame);

/* ---- images: from samples to pixels and files, which are written completely or not at all ---- */

/* 8-bit sRGB, as in a PNG. Owns its pixels. */
typedef struct RtImage {
    uint32_t width, height;
    uint8_t *rgb; /* [height][width][3], from the upper left */
} RtImage;

/* A linear value as 8 bits of sRGB, clipped to 0..1. */
uint8_t rt_srgb(float linear);

/* A black image. Free with rt_image_clear. */
RtStatus rt_image_init(RtImage *image, uint32_t width, uint32_t height, RtError *error);
void rt_image_clear(RtImage *image);

/* The samples of one pixel: `span` x `span` of the frame's grid, from (column, row) on. N x N of its own,
 * or, for samples at corners, its 4 corners, shared with its neighbours. */
typedef struct RtFootprint {
    uint32_t column, row, span;
} RtFootprint;
RtFootprint rt_pixel_footprint(const RtSampling *sampling, uint32_t x, uint32_t y);

/* The mean colour of a pixel's samples, linear. */
RtVec3 rt_frame_pixel(const RtFrame *frame, uint32_t x, uint32_t y);

/* The mean of one counter over a pixel's samples; `counter` as in rt_tally_get, the frame counted. */
double rt_frame_cost(const RtFrame *frame, size_t counter, uint32_t x, uint32_t y);

/* The frame as an image: mean colours, clipped to 0..1. */
RtStatus rt_image_from_frame(RtImage *image, const RtFrame *frame, RtError *error);

/* That image: 8 bits a channel, sRGB. */
RtStatus rt_png_write(const RtFrame *frame, const char *path, RtError *error);

#endif
