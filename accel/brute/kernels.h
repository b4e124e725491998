/* SPDX-License-Identifier: Apache-2.0 */
/* rt_test_all for many rays, sixteen objects at a time; included once for each instruction set
 * (accel/isa.h).
 *
 * Layout: nothing outlives a query. Of a stream a batch of rays is prepared; then, chunk by chunk, spheres
 * and triangles are copied to a desk that fits into the first cache, coordinate by coordinate, an object per
 * lane, and every ray of the batch is tested against the chunk. Lanes without an object hold NaN.
 *
 * The same bits: in lanes objects are only turned away, by the first operations of their hit functions; those
 * that are left are tested by the hit function itself. Of a triangle that is the signs of the edge functions
 * in float32, by the operations of rt_triangle_hit; where all three are numbers it is turned away by both or
 * by neither. Coordinates below RT_MAX_COORDINATE cannot overflow, so one is no number only where a shear is
 * infinite or none, of the shortest dir: then weights in double are infinite or NaN too, t is NaN, and the
 * triangle is not hit. Of spheres see accel/lanes.h.
 *
 * The same counts: a ray meets objects shape by shape in the order of RT_SHAPES, by ascending id, as in
 * rt_test_all, so it has tested all up to where it stops. */
#include "accel/brute/brute.h"
#include "accel/kernel.h"
#include "accel/lanes.h"
#include "accel/sieve.h"

enum {
    BATCH = 128, /* rays */
    LANES = 16,
    BLOCKS = 16, /* of a chunk */
    CHUNK = BLOCKS * LANES,
    SPHERE = sizeof(RtSphere) / sizeof(float),
    TRIANGLE = sizeof(RtTriangle) / sizeof(float)
};

_Static_assert(SPHERE == 4 && TRIANGLE == 9, "an object is its coordinates, without gaps");

/* Sixteen objects: of a sphere the centre and the radius, of a triangle x, y, z of each vertex. */
typedef struct Block {
    _Alignas(64) float row[TRIANGLE][LANES];
} Block;

typedef struct Asking {
    RtPreparedRay ray;
    RtSphereLine line; /* where there are spheres */
    RtHit best;
    RtTally *tally;
} Asking;

typedef struct Desk {
    Block chunk[BLOCKS];
    Asking asking[BATCH];
    uint32_t open[BATCH], open_count; /* whose search is not over */
} Desk;

/* ---- filling a chunk ---- */

/* Four floats of each of four objects, which are `size` floats apart, to lanes of four rows. */
RT_KERNEL void transpose(float row[][LANES], size_t lane, const float *from, size_t size) {
    RtFour columns[4];
    for (size_t i = 0; i < 4; i++) columns[i] = rt_four(from + i * size);
    rt_four_transpose(columns);
    for (size_t i = 0; i < 4; i++) memcpy(&row[i][lane], &columns[i], sizeof columns[i]);
}

/* `count` objects, 1..16, of `size` floats each. */
RT_KERNEL void fill_block(Block *block, const float *from, size_t size, size_t count) {
    size_t lane = 0;
    for (; lane + 4 <= count && lane < LANES; lane += 4) {
        const float *four = from + lane * size;
        size_t row = 0;
        for (; row + 4 <= size; row += 4) transpose(block->row + row, lane, four + row, size);
        for (; row < size; row++) {
            for (size_t i = 0; i < 4; i++) block->row[row][lane + i] = four[i * size + row];
        }
    }
    for (; lane < LANES; lane++) {
        for (size_t row = 0; row < size; row++)
            block->row[row][lane] = lane < count ? from[lane * size + row] : NAN;
    }
}

RT_KERNEL void fill_chunk(Block *chunk, const float *from, size_t size, uint32_t count) {
    for (uint32_t i = 0; i < count; i += LANES)
        fill_block(&chunk[i / LANES], from + i * size, size, count - i);
}

/* ---- a ray and a block ---- */

/* What a ray turns triangles away by. */
typedef struct Line {
    RtSieveLine lanes;
    int x, y, z; /* the ray's kx, ky and kz */
} Line;

RT_KERNEL void make_line(Line *line, const RtPreparedRay *ray) {
    line->x = ray->kx;
    line->y = ray->ky;
    line->z = ray->kz;
    line->lanes.org_x = rt_v16_all(ray->org.at[ray->kx]);
    line->lanes.org_y = rt_v16_all(ray->org.at[ray->ky]);
    line->lanes.org_z = rt_v16_all(ray->org.at[ray->kz]);
    line->lanes.shear_x = rt_v16_all(ray->shear_x);
    line->lanes.shear_y = rt_v16_all(ray->shear_y);
}

/* Bit i: the edge functions of triangle i are not of different signs. */
RT_KERNEL uint32_t sieve_triangles(const Block *block, const Line *line) {
    RtV16 x[3], y[3], z[3];
    for (size_t i = 0; i < 3; i++) {
        const float(*vertex)[LANES] = block->row + 3 * i;
        x[i] = rt_v16_load(vertex[line->x]);
        y[i] = rt_v16_load(vertex[line->y]);
        z[i] = rt_v16_load(vertex[line->z]);
    }
    rt_sieve_shear(&line->lanes, x, y, z);
    return rt_sieve(x, y);
}

/* ---- a batch and a shape ---- */

/* Objects of a shape. */
typedef struct Objects {
    const void *at;
    const uint32_t *ids;
    uint32_t count;
    RtShape shape;
} Objects;

/* Tells of the tests of objects first..end-1; gives end. */
RT_COLD static uint32_t observe_tests(const RtGeometry *g, const Objects *objects, uint32_t first,
                                      uint32_t end) {
    for (uint32_t i = first; i < end; i++) {
        uint32_t id = objects->ids[i];
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &g->boxes[id]});
    }
    return end;
}

/* Tests objects first..first+count-1, which are the chunk; true when the search is over. */
RT_KERNEL bool test_chunk(const Desk *desk, const RtGeometry *g, Asking *a, const Objects *objects,
                          uint32_t first, uint32_t count, bool any, RtTally *tally) {
    Line line;
    uint32_t told = first;
    make_line(&line, &a->ray);
    for (uint32_t i = 0; i < count; i += LANES) {
        const Block *block = &desk->chunk[i / LANES];
        uint32_t left = objects->shape == RT_SHAPE_SPHERE ? rt_spheres_left16(block->row[0], LANES, &a->line)
                                                          : sieve_triangles(block, &line);
        for (; left; left &= left - 1) {
            uint32_t index = first + i + (uint32_t)__builtin_ctz(left), id = objects->ids[index];
            float t;
            if (!rt_object_hit(g, id, &a->ray, &t, NULL)) continue;
            RT_COUNT(tally, object_hits, 1);
            if (RT_OBSERVED(tally)) told = observe_tests(g, objects, told, index + 1);
            RT_OBSERVE(tally, .kind = RT_TRACED_OBJECT_HIT, .index = id, .t = t);
            if (rt_hit_before(t, id, a->best)) a->best = (RtHit){t, id};
            if (!any) continue;
            RT_COUNT(tally, object_tests, index + 1);
            return true;
        }
    }
    if (RT_OBSERVED(tally)) observe_tests(g, objects, told, first + count);
    return false;
}

RT_KERNEL bool test_each(const RtGeometry *g, Asking *a, const Objects *objects, bool any, RtTally *tally) {
    for (uint32_t i = 0; i < objects->count; i++) {
        if (rt_test_object(g, objects->ids[i], &a->ray, any, &a->best, tally)) return true;
    }
    return false;
}

/* Tests all objects of a shape, chunk by chunk where there are lanes for it, and keeps the rays open whose
 * search is not over. */
RT_KERNEL void test_shape(Desk *desk, const RtGeometry *g, Objects objects, bool any, bool counted) {
    const size_t size = objects.shape == RT_SHAPE_SPHERE ? SPHERE : TRIANGLE;
    const bool in_lanes = objects.shape == RT_SHAPE_SPHERE || objects.shape == RT_SHAPE_TRIANGLE;
    for (uint32_t first = 0, count; first < objects.count && desk->open_count > 0; first += count) {
        uint32_t left = objects.count - first, kept = 0;
        count = in_lanes && left > CHUNK ? CHUNK : left;
        if (in_lanes) fill_chunk(desk->chunk, (const float *)objects.at + first * size, size, count);
        for (uint32_t i = 0; i < desk->open_count; i++) {
            Asking *a = &desk->asking[desk->open[i]];
            RtTally *tally = counted ? a->tally : NULL;
            bool over = in_lanes ? test_chunk(desk, g, a, &objects, first, count, any, tally)
                                 : test_each(g, a, &objects, any, tally);
            desk->open[kept] = desk->open[i];
            kept += !over;
        }
        desk->open_count = kept;
    }
    for (uint32_t i = 0; counted && in_lanes && i < desk->open_count; i++) {
        desk->asking[desk->open[i]].tally->object_tests += objects.count;
    }
}

/* ---- a stream ---- */

RT_KERNEL void begin(Desk *desk, const RtGeometry *g, const RtScratch *scratch, const RtRay *rays,
                     uint32_t count, RtTally *tallies) {
    for (uint32_t i = 0; i < count; i++) {
        Asking *a = &desk->asking[i];
        rt_hit_ray(&a->ray, g, &rays[i], scratch->room);
        if (g->sphere_count > 0) a->line = rt_sphere_line(&a->ray);
        a->best = RT_MISS;
        a->tally = tallies ? &tallies[rays[i].kind] : NULL;
        desk->open[i] = i;
    }
    desk->open_count = count;
}

RT_KERNEL void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     RtHit *hits, uint32_t *blockers, RtTally *tallies, bool any, bool counted) {
    const RtGeometry *g = &accel->scene->geometry;
    Desk *desk = scratch->own;
    for (size_t first = 0; first < count; first += BATCH) {
        uint32_t n = (uint32_t)(count - first < BATCH ? count - first : BATCH);
        begin(desk, g, scratch, rays + first, n, tallies);
#define TEST_SHAPE(CONSTANT, name, Type)                                                                     \
    test_shape(desk, g, (Objects){g->name##s, g->name##_ids, g->name##_count, RT_SHAPE_##CONSTANT}, any,     \
               counted);
        RT_SHAPES(TEST_SHAPE)
#undef TEST_SHAPE
        for (uint32_t i = 0; i < n; i++) {
            const Asking *a = &desk->asking[i];
            RT_COUNT(counted ? a->tally : NULL, rays, 1);
            RT_COUNT(counted ? a->tally : NULL, hits, a->best.object != RT_NO_OBJECT);
            if (any)
                blockers[first + i] = a->best.object;
            else
                hits[first + i] = a->best;
        }
    }
}

RT_DEFINE_STREAM_KERNELS(trace)
RT_DEFINE_KERNEL_TABLE(sizeof(Desk));
