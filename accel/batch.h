/* SPDX-License-Identifier: Apache-2.0 */
/* What the kernels of `brute` and `extents` share: the rays of a stream in batches, against records (objects
 * or boxes) in chunks, RT_LANES records in lanes against one ray.
 *
 * Layout: nothing outlives a query. A batch of rays is prepared. Then, chunk by chunk, records are copied to
 * blocks that fit into the first cache, coordinate by coordinate, a record per lane, and every active ray of
 * the batch is tested against the chunk. Lanes without a record hold NaN. */
#ifndef RT_ACCEL_BATCH_H
#define RT_ACCEL_BATCH_H

#include "accel/kernel.h"
#include "accel/sphere_prefilter.h"
#include "core/base/simd_across.h"

enum {
    RT_BATCH = 128,                                   /* rays */
    RT_CHUNK = 256,                                   /* records */
    RT_MOST_ROWS = sizeof(RtTriangle) / sizeof(float) /* of the longest record */
};

/* RT_LANES records: row i holds float i of each. */
typedef struct RtBlock {
    _Alignas(RtFloats) float row[RT_MOST_ROWS][RT_LANES];
} RtBlock;

typedef struct RtActiveRay {
    RtPreparedRay ray;
    RtSphereLine line; /* where there are spheres; set by `brute` */
    RtHit best;
    RtTally *tally; /* NULL in timed kernels */
} RtActiveRay;

typedef struct RtBatch {
    RtBlock chunk[RT_CHUNK / RT_LANES];
    RtActiveRay rays[RT_BATCH];
    uint32_t active[RT_BATCH], active_count; /* the rays whose search is not over */
} RtBatch;

/* ---- filling a chunk ---- */

/* Four floats of each of four records, which are `size` floats apart, to lanes of four rows. */
RT_KERNEL void rt_block_transpose(float row[][RT_LANES], size_t lane, const float *from, size_t size) {
    RtFloat4 columns[4];
    for (size_t i = 0; i < 4; i++) columns[i] = rt_loadu4(from + i * size);
    rt_transpose4(columns);
    for (size_t i = 0; i < 4; i++) rt_store(&row[i][lane], columns[i]);
}

/* `count` records, at least one, of `size` floats each; the first RT_LANES fill the block. */
RT_KERNEL void rt_fill_block(RtBlock *block, const float *from, size_t size, size_t count) {
    size_t lane = 0;
    for (; lane + 4 <= count && lane < RT_LANES; lane += 4) {
        const float *four = from + lane * size;
        size_t row = 0;
        for (; row + 4 <= size; row += 4) rt_block_transpose(block->row + row, lane, four + row, size);
        for (; row < size; row++) {
            for (size_t i = 0; i < 4; i++) block->row[row][lane + i] = four[i * size + row];
        }
    }
    for (; lane < RT_LANES; lane++) {
        for (size_t row = 0; row < size; row++)
            block->row[row][lane] = lane < count ? from[lane * size + row] : NAN;
    }
}

RT_KERNEL void rt_fill_chunk(RtBatch *batch, const float *from, size_t size, uint32_t count) {
    for (uint32_t i = 0; i < count; i += RT_LANES)
        rt_fill_block(&batch->chunk[i / RT_LANES], from + i * size, size, count - i);
}

/* ---- a stream ---- */

RT_KERNEL void rt_batch_begin(RtBatch *batch, const RtGeometry *g, const RtScratch *scratch,
                              const RtRay *rays, uint32_t count, RtTally *tallies) {
    for (uint32_t i = 0; i < count; i++) {
        RtActiveRay *a = &batch->rays[i];
        rt_hit_ray(&a->ray, g, &rays[i], scratch->crossings);
        a->best = RT_MISS;
        a->tally = tallies ? &tallies[rays[i].kind] : NULL;
        batch->active[i] = i;
    }
    batch->active_count = count;
}

/* The kernels and their table (accel/kernel.h) from
 *
 *     void test_all(RtBatch *batch, const RtGeometry *geometry, bool any, bool counted);
 *
 * which tests all objects against the active rays of a batch. */
#define RT_DEFINE_BATCH_KERNELS(name, test_all)                                                              \
    RT_KERNEL void trace_batches(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,          \
                                 size_t count, RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, \
                                 bool counted) {                                                             \
        const RtGeometry *geometry = &accel->scene->geometry;                                                \
        RtBatch *batch = scratch->own;                                                                       \
        for (size_t first = 0; first < count; first += RT_BATCH) {                                           \
            uint32_t n = (uint32_t)(count - first < RT_BATCH ? count - first : RT_BATCH);                    \
            rt_batch_begin(batch, geometry, scratch, rays + first, n, tallies);                              \
            test_all(batch, geometry, any, counted);                                                         \
            for (uint32_t i = 0; i < n; i++) {                                                               \
                const RtActiveRay *a = &batch->rays[i];                                                      \
                RT_COUNT(counted ? a->tally : NULL, rays, 1);                                                \
                RT_COUNT(counted ? a->tally : NULL, hits, a->best.object != RT_NO_OBJECT);                   \
                if (any)                                                                                     \
                    occluders[first + i] = a->best.object;                                                   \
                else                                                                                         \
                    hits[first + i] = a->best;                                                               \
            }                                                                                                \
        }                                                                                                    \
    }                                                                                                        \
    RT_DEFINE_STREAM_KERNELS(trace_batches)                                                                  \
    RT_DEFINE_KERNEL_TABLE(name, sizeof(RtBatch))

#endif
