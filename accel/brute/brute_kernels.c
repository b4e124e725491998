/* SPDX-License-Identifier: Apache-2.0 */
/* rt_test_all for many rays, RT_LANES spheres or triangles at a time (accel/batch.h); compiled once for each
 * instruction set (accel/isa.h).
 *
 * The same bits: lanes only reject objects, by the first operations of their hit functions; the hit function
 * itself tests those that pass. Triangles are rejected by the signs of the edge functions in float32
 * (accel/watertight.h). If all three are numbers, rt_triangle_hit rejects the same triangles. Coordinates
 * below RT_MAX_COORDINATE cannot overflow, so one is NaN only if a shear is infinite or NaN, for the shortest
 * dir: then the weights in double are infinite or NaN too, t is NaN, and the triangle is not hit. For spheres
 * see accel/batch.h.
 *
 * The same counts: a ray meets objects shape by shape in the order of RT_SHAPES, by ascending id, as in
 * rt_test_all, so it has tested all objects up to the one at which it stops. */
#include "accel/batch.h"
#include "accel/isa.h"
#include "accel/watertight.h"

enum { SPHERE = sizeof(RtSphere) / sizeof(float), TRIANGLE = sizeof(RtTriangle) / sizeof(float) };

_Static_assert(SPHERE == 4 && TRIANGLE == 9, "an object is its coordinates, without gaps");

/* ---- a ray and a block ---- */

/* A ray, prepared for the edge-function prefilter. */
typedef struct Line {
    RtShear lanes;
    int x, y, z; /* the ray's kx, ky and kz */
} Line;

RT_KERNEL void make_line(Line *line, const RtPreparedRay *ray) {
    line->x = ray->kx;
    line->y = ray->ky;
    line->z = ray->kz;
    line->lanes.org_x = rt_all(ray->org[ray->kx]);
    line->lanes.org_y = rt_all(ray->org[ray->ky]);
    line->lanes.org_z = rt_all(ray->org[ray->kz]);
    line->lanes.shear_x = rt_all(ray->shear_x);
    line->lanes.shear_y = rt_all(ray->shear_y);
}

/* Bit i: triangle i passes the edge-function prefilter. */
RT_KERNEL uint32_t prefilter_triangles(const RtBlock *block, const Line *line) {
    RtSheared s;
    for (size_t i = 0; i < 3; i++) {
        const float(*vertex)[RT_LANES] = block->row + 3 * i;
        s.x[i] = rt_load(vertex[line->x]);
        s.y[i] = rt_load(vertex[line->y]);
        s.z[i] = rt_load(vertex[line->z]);
    }
    rt_shear(&line->lanes, &s);
    return rt_edge_prefilter(&s);
}

/* ---- a batch and a shape ---- */

/* Objects of a shape. */
typedef struct Objects {
    const void *at;
    const uint32_t *ids;
    uint32_t count;
    RtShape shape;
} Objects;

/* Reports the tests of objects first..end-1 to the observer; returns end. */
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
    const bool spheres = objects->shape == RT_SHAPE_SPHERE;
    const RtBlock *block = batch->chunk;
    const RtSphereLine sphere_line = spheres ? a->line : (RtSphereLine){0};
    Line line;
    uint32_t reported = first;
    make_line(&line, &a->ray);
    for (uint32_t i = 0; i < count; i += RT_LANES, block++) {
        uint32_t passed = spheres ? rt_sphere_prefilter(block->row[0], RT_LANES, &sphere_line)
                                  : prefilter_triangles(block, &line);
        for (; passed; passed &= passed - 1) {
            uint32_t index = first + i + (uint32_t)__builtin_ctz(passed), id = objects->ids[index];
            float t;
            if (!rt_object_hit(g, id, &a->ray, &t, NULL)) continue;
            RT_COUNT(tally, object_hits, 1);
            if (RT_OBSERVED(tally)) reported = observe_tests(g, objects, reported, index + 1);
            RT_OBSERVE(tally, .kind = RT_TRACED_OBJECT_HIT, .index = id, .t = t);
            if (rt_hit_before(t, id, a->best)) a->best = (RtHit){t, id};
            if (!any) continue;
            RT_COUNT(tally, object_tests, index + 1);
            return true;
        }
    }
    if (RT_OBSERVED(tally)) observe_tests(g, objects, reported, first + count);
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
    for (uint32_t i = 0; counted && in_lanes && i < batch->active_count; i++)
        RT_COUNT(batch->rays[batch->active[i]].tally, object_tests, objects.count);
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

RT_DEFINE_BATCH_KERNELS(brute, test_all);
