/* SPDX-License-Identifier: Apache-2.0 */
/* rt_test_all for many rays, sixteen spheres or triangles at a time (accel/batch.h); included once for each
 * instruction set (accel/isa.h).
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
#include "accel/batch.h"
#include "accel/brute/brute.h"
#include "accel/sieve.h"

enum { SPHERE = sizeof(RtSphere) / sizeof(float), TRIANGLE = sizeof(RtTriangle) / sizeof(float) };

_Static_assert(SPHERE == 4 && TRIANGLE == 9, "an object is its coordinates, without gaps");

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
RT_KERNEL uint32_t sieve_triangles(const RtBlock *block, const Line *line) {
    RtV16 x[3], y[3], z[3];
    for (size_t i = 0; i < 3; i++) {
        const float(*vertex)[RT_BLOCK_LANES] = block->row + 3 * i;
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
RT_KERNEL bool test_chunk(const RtBatch *batch, const RtGeometry *g, RtActiveRay *a, const Objects *objects,
                          uint32_t first, uint32_t count, bool any, RtTally *tally) {
    Line line;
    uint32_t told = first;
    make_line(&line, &a->ray);
    for (uint32_t i = 0; i < count; i += RT_BLOCK_LANES) {
        const RtBlock *block = &batch->chunk[i / RT_BLOCK_LANES];
        uint32_t left = objects->shape == RT_SHAPE_SPHERE
                            ? rt_spheres_left16(block->row[0], RT_BLOCK_LANES, &a->line)
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

RT_KERNEL bool test_each(const RtGeometry *g, RtActiveRay *a, const Objects *objects, bool any,
                         RtTally *tally) {
    for (uint32_t i = 0; i < objects->count; i++) {
        if (rt_test_object(g, objects->ids[i], &a->ray, any, &a->best, tally)) return true;
    }
    return false;
}

/* Tests all objects of a shape, chunk by chunk where there are lanes for it, and keeps the rays active whose
 * search is not over. */
RT_KERNEL void test_shape(RtBatch *batch, const RtGeometry *g, Objects objects, bool any, bool counted) {
    const size_t size = objects.shape == RT_SHAPE_SPHERE ? SPHERE : TRIANGLE;
    const bool in_lanes = objects.shape == RT_SHAPE_SPHERE || objects.shape == RT_SHAPE_TRIANGLE;
    for (uint32_t first = 0, count; first < objects.count && batch->active_count > 0; first += count) {
        uint32_t left = objects.count - first, kept = 0;
        count = in_lanes && left > RT_CHUNK ? RT_CHUNK : left;
        if (in_lanes) rt_fill_chunk(batch, (const float *)objects.at + first * size, size, count);
        for (uint32_t i = 0; i < batch->active_count; i++) {
            RtActiveRay *a = &batch->rays[batch->active[i]];
            RtTally *tally = counted ? a->tally : NULL;
            bool over = in_lanes ? test_chunk(batch, g, a, &objects, first, count, any, tally)
                                 : test_each(g, a, &objects, any, tally);
            batch->active[kept] = batch->active[i];
            kept += !over;
        }
        batch->active_count = kept;
    }
    for (uint32_t i = 0; counted && in_lanes && i < batch->active_count; i++) {
        batch->rays[batch->active[i]].tally->object_tests += objects.count;
    }
}

RT_KERNEL void test_all(RtBatch *batch, const RtGeometry *g, bool any, bool counted) {
    for (uint32_t i = 0; g->sphere_count > 0 && i < batch->active_count; i++)
        batch->rays[i].line = rt_sphere_line(&batch->rays[i].ray);
#define TEST_SHAPE(CONSTANT, name, Type)                                                                     \
    test_shape(batch, g, (Objects){g->name##s, g->name##_ids, g->name##_count, RT_SHAPE_##CONSTANT}, any,    \
               counted);
    RT_SHAPES(TEST_SHAPE)
#undef TEST_SHAPE
}

RT_DEFINE_BATCH_KERNELS(test_all);
