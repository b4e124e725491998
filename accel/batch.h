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
#include "core/base/simd_across.h"

/* ---- the sphere prefilter ---- */

/* Which of RT_LANES spheres may a ray hit? rt_sphere_hit rejects all others.
 *
 * A ray from org along the unit vector u passes a centre at o from org at the distance |o x u|. In float32
 * the error of this distance is less than 2^-21 |o|: in units of 2^-24 |o| rounding o and rounding u add one
 * each, the products sqrt(2), their differences one. rt_sphere_hit computes it in double, with an error below
 * 2^-48 |o|, and rejects the ray if it is greater than the radius. So a ray that it does not reject has
 *
 *     |o x u| <= r + 2^-21 |o|,  and hence  |o x u|^2 <= (1 + 2^-10) r^2 + (1 + 2^10) 2^-42 |o|^2,
 *
 * for 2ab <= 2^-10 a^2 + 2^10 b^2. The prefilter passes a lane if |o x u|^2 <= (1 + 2^-9) r^2 + 2^-31 |o|^2 +
 * 2^-120: its first two terms exceed those above by more than the rounding of both sides, 2^-20 of them; its
 * third exceeds all that underflow in products can lose. Nothing overflows, since coordinates stay below
 * RT_MAX_COORDINATE. Spheres that pass needlessly are small and far away, r < 2^-15 |o|, or nearly hit.
 *
 * A lane that holds a NaN does not pass. */

/* A ray, prepared for the prefilter once. */
typedef struct RtSphereLine {
    RtVec3 org, dir; /* dir: unit */
} RtSphereLine;

static inline RtSphereLine rt_sphere_line(const RtPreparedRay *ray) {
    return (RtSphereLine){rt_vec3_load(ray->org), rt_narrow(rt_normalized(rt_widen(rt_vec3_load(ray->dir))))};
}

/* Bit i: the ray may hit sphere i, 0 <= i < RT_LANES. Its centre is spheres[i], spheres[stride + i] and
 * spheres[2 * stride + i], its radius spheres[3 * stride + i]; they need not be aligned. */
static inline uint32_t rt_sphere_prefilter(const float *spheres, size_t stride, const RtSphereLine *line) {
    const RtVec3 u = line->dir;
    RtFloats x = rt_loadu(spheres) - line->org.x, y = rt_loadu(spheres + stride) - line->org.y;
    RtFloats z = rt_loadu(spheres + 2 * stride) - line->org.z, r = rt_loadu(spheres + 3 * stride);
    RtFloats a = y * u.z - z * u.y, b = z * u.x - x * u.z, c = x * u.y - y * u.x;
    RtFloats passed = a * a + b * b + c * c, far = x * x + y * y + z * z;
    return rt_le_bits(passed, r * r * (1 + 0x1p-9f) + (far * 0x1p-31f + 0x1p-120f));
}

/* ---- batches ---- */

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
        rt_hit_ray(&a->ray, g, &rays[i], scratch->hit_memory);
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
                rt_put_answer(&a->best, first + i, any, hits, occluders, counted ? a->tally : NULL);         \
            }                                                                                                \
        }                                                                                                    \
    }                                                                                                        \
    RT_DEFINE_STREAM_KERNELS(trace_batches, sizeof(RtBatch))                                                 \
    RT_DEFINE_KERNEL_TABLE(name)

#endif
