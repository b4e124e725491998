/* SPDX-License-Identifier: Apache-2.0 */
/* Answering shadow rays in streams; compiled once for each instruction set (accel/isa.h).
 *
 * A stream is answered in blocks of rays, so that the memory each ray needs next is on its way while others
 * are worked on. First each ray finds the list of its cell. Then rays walk through their lists in rounds. In
 * a round each ray that is left comes to its next entry that is not deeper than its origin, which makes a
 * pair of a ray and an object. Pairs with triangles are tested in lanes. A ray drops out when it is occluded
 * or at the end of its list. No ray depends on another, so counts are the same in streams of any length. Rays
 * at the end of a list that was cut, and rays that are not exactly a shadow ray, are passed on together. A
 * step is an entry that makes a pair. */
#include "accel/light/light.h"

#include "accel/kernel.h"
#include "accel/raster/raster.h"
#include "accel/sphere_pairs.h"

enum { BLOCK = 1024 }; /* rays */

/* Where a ray is in its list. */
typedef struct Cursor {
    const RtLightEntry *next, *end;
    float depth;  /* of the ray's origin, or more */
    uint32_t ray; /* number in the block */
} Cursor;

typedef struct Cell {
    const RtLightGrid *grid;
    uint32_t number;
} Cell;

typedef struct Stream {
    Cell cells[BLOCK];
    Cursor cursors[BLOCK];
    uint32_t cursor_count;
    uint32_t pair_ray[BLOCK];
    RtRef pair_triangle[BLOCK];
    uint32_t pair_count;
    SpherePair spheres[BLOCK];
    float sphere_t[BLOCK];
    uint32_t sphere_count;
    uint32_t passed[BLOCK], passed_count;
    uint32_t passed_occluders[BLOCK];
    RtRay passed_rays[BLOCK];
} Stream;

/* A block of rays. */
typedef struct RayBatch {
    const RtLightBuffer *self;
    const RtScratch *scratch;
    Stream *stream;
    const RtRay *rays;
    uint32_t *occluders;
    RtTally *tally;
} RayBatch;

/* ---- from rays to lists ---- */

/* Whether the lists are made for the ray. */
RT_KERNEL bool is_served(const RtLightBuffer *self, const RtRay *ray) {
    const RtScene *scene = self->base.scene;
    if (ray->source >= scene->light_count) return false;
    const RtVec3 to_light = rt_sub(scene->lights[ray->source].position, ray->org);
    bool good = ray->tmax <= 1;
    for (int a = 0; a < 3; a++) {
        good &= to_light.at[a] == ray->dir.at[a];
        good &= self->domain.lo.at[a] <= ray->org.at[a] && ray->org.at[a] <= self->domain.hi.at[a];
    }
    return good;
}

RT_KERNEL void find_lists(const RayBatch *batch, uint32_t count) {
    Stream *stream = batch->stream;
    for (uint32_t i = 0; i < count; i++) {
        const RtRay *ray = &batch->rays[i];
        uint32_t cell;
        if (!is_served(batch->self, ray)) {
            stream->passed[stream->passed_count++] = i;
            continue;
        }
        const int face = rt_light_face_of(ray->dir);
        const RtLightGrid *grid = &batch->self->cubes[ray->source].grids[face];
        if (!rt_light_cell_of(grid, face, ray->dir, &cell)) continue;
        const float depth = fabsf(ray->dir.at[face / 2]);
        __builtin_prefetch(&grid->first[cell]);
        stream->cells[stream->cursor_count] = (Cell){grid, cell};
        stream->cursors[stream->cursor_count++] = (Cursor){.depth = depth + depth * 0x1p-22f, .ray = i};
    }
    for (uint32_t i = 0; i < stream->cursor_count; i++) {
        const Cell *cell = &stream->cells[i];
        const uint32_t *first = &cell->grid->first[cell->number];
        stream->cursors[i].next = cell->grid->entries + first[0];
        stream->cursors[i].end = cell->grid->entries + first[1];
        __builtin_prefetch(stream->cursors[i].next);
    }
}

/* ---- a round ---- */

/* Moves on by an entry, and returns its object, or RT_NO_OBJECT if the ray is at its end. */
RT_KERNEL RtRef next_object(const RayBatch *batch, Cursor *cursor) {
    if (cursor->next == cursor->end || cursor->next->depth > cursor->depth) return RT_NO_OBJECT;
    if (cursor->next->object == RT_LIGHT_BEYOND) {
        batch->stream->passed[batch->stream->passed_count++] = cursor->ray;
        return RT_NO_OBJECT;
    }
    RT_COUNT(batch->tally, steps, 1);
    RT_OBSERVE(batch->tally, .kind = RT_TRACED_STEP, .what = "entry of object",
               .index = rt_raster_id(&batch->self->base.scene->geometry, cursor->next->object));
    return cursor->next++->object;
}

RT_KERNEL void test_one(const RayBatch *batch, uint32_t ray, uint32_t id) {
    const RtGeometry *g = &batch->self->base.scene->geometry;
    RtPreparedRay prepared;
    RtHit hit = RT_MISS;
    rt_hit_ray(&prepared, g, &batch->rays[ray], batch->scratch->hit_memory);
    if (rt_test_object(g, id, &prepared, true, &hit, batch->tally)) batch->occluders[ray] = hit.object;
}

/* Rays and triangles of pairs first..first+count-1 to lanes. */
RT_KERNEL void load_pairs(const RayBatch *batch, uint32_t first, uint32_t count, RtRayTriangles *pairs) {
    const float *org[RT_LANES], *dir[RT_LANES];
    RtFloats four[4];
    for (uint32_t i = 0; i < RT_LANES; i++) {
        const RtRay *ray = &batch->rays[batch->stream->pair_ray[first + (i < count ? i : 0)]];
        org[i] = ray->org.at;
        dir[i] = ray->dir.at;
    }
    rt_load_columns(org, four);
    for (int a = 0; a < 3; a++) pairs->org[a] = four[a];
    pairs->tmin = four[3];
    rt_load_columns(dir, four);
    for (int a = 0; a < 3; a++) pairs->dir[a] = four[a];
    pairs->tmax = four[3];
    rt_raster_gather(&batch->self->base.scene->geometry, batch->stream->pair_triangle + first, count,
                     pairs->v);
}

RT_KERNEL void test_triangles(const RayBatch *batch) {
    const RtGeometry *g = &batch->self->base.scene->geometry;
    const Stream *stream = batch->stream;
    for (uint32_t first = 0; first < stream->pair_count; first += RT_LANES) {
        uint32_t count = stream->pair_count - first < RT_LANES ? stream->pair_count - first : RT_LANES;
        _Alignas(RtFloats) float t[RT_LANES];
        RtFloats at = rt_all(NAN);
        RtRayTriangles pairs;
        load_pairs(batch, first, count, &pairs);
        uint32_t hit = rt_edge_prefilter_pairs(&pairs);
        if (hit) hit = rt_hit_pairs(&pairs, &at);
        rt_store(t, at);
        for (uint32_t i = 0; i < count; i++) {
            RtHit best = RT_MISS;
            uint32_t id = g->triangle_ids[rt_ref_index(stream->pair_triangle[first + i])];
            if (rt_take_test(g, id, hit >> i & 1 ? t[i] : NAN, true, &best, batch->tally))
                batch->occluders[stream->pair_ray[first + i]] = id;
        }
    }
}

RT_KERNEL void test_spheres(const RayBatch *batch) {
    const RtGeometry *g = &batch->self->base.scene->geometry;
    Stream *stream = batch->stream;
    hit_sphere_pairs(g, stream->spheres, stream->sphere_count, stream->sphere_t);
    for (uint32_t i = 0; i < stream->sphere_count; i++) {
        const SpherePair *pair = &stream->spheres[i];
        RtHit best = RT_MISS;
        if (rt_take_test(g, pair->id, stream->sphere_t[i], true, &best, batch->tally))
            batch->occluders[pair->ray - batch->rays] = pair->id;
    }
}

/* A round of all rays in lists. */
RT_KERNEL void take_round(const RayBatch *batch) {
    const RtGeometry *g = &batch->self->base.scene->geometry;
    Stream *stream = batch->stream;
    uint32_t left = 0;
    stream->pair_count = stream->sphere_count = 0;
    for (uint32_t i = 0; i < stream->cursor_count; i++) {
        Cursor cursor = stream->cursors[i];
        if (batch->occluders[cursor.ray] != RT_NO_OBJECT) continue;
        RtRef object = next_object(batch, &cursor);
        if (object == RT_NO_OBJECT) continue;
        stream->cursors[left++] = cursor;
        if (rt_raster_is_triangle(object)) {
            stream->pair_ray[stream->pair_count] = cursor.ray;
            stream->pair_triangle[stream->pair_count++] = object;
            const RtTriangle *triangle = &g->triangles[rt_ref_index(object)];
            __builtin_prefetch(triangle);
            __builtin_prefetch((const char *)(triangle + 1) - 1); /* it may lie on two cache lines */
            __builtin_prefetch(&g->triangle_ids[rt_ref_index(object)]);
        } else if (rt_ref_shape(object) == RT_SHAPE_SPHERE) {
            uint32_t index = rt_ref_index(object);
            stream->spheres[stream->sphere_count++] =
                (SpherePair){&batch->rays[cursor.ray], &g->spheres[index], g->sphere_ids[index]};
            __builtin_prefetch(&g->spheres[index]);
        } else {
            test_one(batch, cursor.ray, rt_raster_id(g, object));
        }
    }
    stream->cursor_count = left;
    test_triangles(batch);
    test_spheres(batch);
}

/* ---- streams ---- */

RT_KERNEL void pass_on(const RayBatch *batch, RtTally *tallies) {
    Stream *stream = batch->stream;
    uint32_t count = stream->passed_count;
    if (count == 0) return;
    RT_COUNT(batch->tally, passed_on, count);
    RT_OBSERVE(batch->tally, .kind = RT_TRACED_PASSED_ON, .what = "light");
    for (uint32_t i = 0; i < count; i++) stream->passed_rays[i] = batch->rays[stream->passed[i]];
    rt_hand_down(&batch->self->base, batch->scratch, stream->passed_rays, count, NULL,
                 stream->passed_occluders, tallies);
    for (uint32_t i = 0; i < count; i++) batch->occluders[stream->passed[i]] = stream->passed_occluders[i];
}

/* A block of shadow rays. */
RT_KERNEL void shade_block(const RayBatch *batch, uint32_t count, RtTally *tallies) {
    Stream *stream = batch->stream;
    stream->cursor_count = stream->passed_count = 0;
    for (uint32_t i = 0; i < count; i++) batch->occluders[i] = RT_NO_OBJECT;
    find_lists(batch, count);
    while (stream->cursor_count > 0) take_round(batch);
    for (uint32_t i = 0; batch->tally && i < count; i++)
        RT_COUNT(batch->tally, hits, batch->occluders[i] != RT_NO_OBJECT);
    RT_COUNT(batch->tally, rays, count - stream->passed_count);
    pass_on(batch, tallies);
}

/* Where the buffer does not serve: hands down all at once, because packets are made of rays that come
 * together. */
RT_KERNEL void pass_all(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                        uint32_t *occluders, RtTally *tallies) {
    for (size_t i = 0; tallies && i < count; i++) {
        if (rays[i].kind != RT_RAY_SHADOW) continue;
        RT_COUNT(&tallies[RT_RAY_SHADOW], passed_on, 1);
        RT_OBSERVE(&tallies[RT_RAY_SHADOW], .kind = RT_TRACED_PASSED_ON, .what = "light");
    }
    rt_hand_down(accel, scratch, rays, count, NULL, occluders, tallies);
}

RT_KERNEL void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    const RtLightBuffer *self = (const RtLightBuffer *)accel;
    (void)counted;
    if (!any) {
        rt_hand_down(accel, scratch, rays, count, hits, NULL, tallies);
        return;
    }
    if (!self->serves) {
        pass_all(accel, scratch, rays, count, occluders, tallies);
        return;
    }
    for (size_t i = 0, next; i < count; i = next) {
        for (next = i; next < count && rays[next].kind != RT_RAY_SHADOW; next++) {
        }
        if (next > i) rt_hand_down(accel, scratch, rays + i, next - i, NULL, occluders + i, tallies);
        i = next;
        while (next < count && next - i < BLOCK && rays[next].kind == RT_RAY_SHADOW) next++;
        if (next == i) continue;
        const RayBatch batch = {self,     scratch,       scratch->own,
                                rays + i, occluders + i, tallies ? &tallies[RT_RAY_SHADOW] : NULL};
        shade_block(&batch, (uint32_t)(next - i), tallies);
    }
}

RT_DEFINE_STREAM_KERNELS(trace, sizeof(Stream))
RT_DEFINE_KERNEL_TABLE(light);
