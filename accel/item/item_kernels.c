/* SPDX-License-Identifier: Apache-2.0 */
/* The kernels of item, compiled once for each instruction set (accel/isa.h). Triangles, RT_LANES at a time in
 * float32: the samples that may see them, and their tiles; and drawing one into a tile, at the samples of a
 * block at once. And answering primary rays from the samples that they belong to: rays of triangles are
 * tested RT_LANES at a time; rays that are not those of samples are passed on. */
#include "accel/instance.h"
#include "accel/item/item.h"

/* ---- pairs of a ray from the eye and a triangle, tested together ---- */

enum { RT_ITEM_PENDING = 16 }; /* whatever the number of lanes: when they are tested changes what is drawn */

typedef struct PendingTests {
    const RtTriangle *triangle[RT_ITEM_PENDING];
    const float *dir[RT_ITEM_PENDING]; /* four */
    uint32_t id[RT_ITEM_PENDING];      /* of the triangle */
    uint32_t place[RT_ITEM_PENDING];   /* where the answer goes */
    uint32_t count;
} PendingTests;

RT_KERNEL void add_pending(PendingTests *p, const RtGeometry *g, uint32_t triangle, const float *dir,
                           uint32_t place) {
    p->triangle[p->count] = &g->triangles[triangle];
    p->dir[p->count] = dir;
    p->id[p->count] = g->triangle_ids[triangle];
    p->place[p->count++] = place;
}

/* The hits, a bit each, and t of each. */
RT_KERNEL uint32_t test_pending(const RtItemBuffer *buffer, PendingTests *p, float t[RT_ITEM_PENDING]) {
    uint32_t hits = 0;
    for (uint32_t k = p->count; k % RT_LANES; k++) {
        p->triangle[k] = p->triangle[0];
        p->dir[k] = p->dir[0];
    }
    for (uint32_t k = 0; k < p->count; k += RT_LANES) {
        RtFloats dir[4], at;
        RtRayTriangles pairs = {.tmin = rt_all((float)buffer->view.near), .tmax = rt_all(INFINITY)};
        rt_load_columns(&p->dir[k], dir);
        for (int a = 0; a < 3; a++) {
            pairs.org[a] = rt_all((float)buffer->view.eye.at[a]);
            pairs.dir[a] = dir[a];
        }
        rt_load_triangles(&p->triangle[k], pairs.v);
        hits |= rt_hit_pairs(&pairs, &at) << k;
        rt_store(&t[k], at);
    }
    return hits & (0xffffu >> (RT_ITEM_PENDING - p->count));
}

/* ---- projection ---- */

/* RtItemProjection in lanes. */
typedef struct LaneProjection {
    const RtItemBuffer *buffer;
    RtFloats eye[3], x[3], y[3], depth[3];
    RtFloats reach[2];     /* how far an error of 1 in a direction reaches, in samples */
    RtFloats last[2];      /* the last column and row */
    RtFloats nearer;       /* t may be less by this part of |q| / depth */
    RtFloats most_oblique; /* |q| / depth, up to which a triangle is projected here */
} LaneProjection;

/* For triangles seen more obliquely, or behind the eye, their boxes are projected instead. */
#define MOST_OBLIQUE 256

RT_KERNEL void make_lane_projection(LaneProjection *to, const RtItemBuffer *buffer) {
    const RtItemProjection *from = &buffer->projection;
    const RtSampling *s = &buffer->view.sampling;
    to->buffer = buffer;
    for (int a = 0; a < 3; a++) {
        to->eye[a] = rt_all((float)buffer->view.eye.at[a]);
        to->x[a] = rt_all((float)from->x.at[a]);
        to->y[a] = rt_all((float)from->y.at[a]);
        to->depth[a] = rt_all((float)from->depth.at[a]);
    }
    to->reach[0] = rt_all((float)((from->scale[0] + s->columns) * from->longest));
    to->reach[1] = rt_all((float)((from->scale[1] + s->rows) * from->longest));
    to->last[0] = rt_all((float)(s->columns - 1));
    to->last[1] = rt_all((float)(s->rows - 1));
    to->nearer = rt_all((float)(0x1p-16 * from->longest));
    to->most_oblique = rt_all(from->direction_error <= RT_ITEM_MAX_DIRECTION_ERROR ? MOST_OBLIQUE : -1);
}

RT_KERNEL RtFloats dot(const RtFloats a[3], const RtFloats b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Columns and rows of triangles, whole numbers, and the least t of each; bit i where they are known. With |q|
 * the sum of its coordinates, x . q and y . q are off by 2^-21 of `reach` times |q|, in samples by as much of
 * |q| / depth, and by 2^-22 of the square of that for the error of the depth; the error of a hit function
 * moves it by less than 2^-18 of it. So a hit is seen within a `pad` of the hull of the vertices. */
typedef struct Bounds {
    RtFloats lo[2], hi[2], near;
    RtFloats edge[3][3];    /* functions of (1, column, row): below 0 outside of the hull */
    uint32_t known, behind; /* the eye: never seen */
} Bounds;

/* From where vertices are seen. Rounding is less than a tenth of the margin, 1.25 times the pads, because a
 * pad is at least 2^-17 of each coordinate. A triangle turned the wrong way by rounding is as thin as that.
 */
RT_KERNEL void make_edges(RtFloats at[3][2], const RtFloats pad[2], RtFloats edge[3][3]) {
    RtFloats along[3][2];
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 2; a++) along[i][a] = at[(i + 1) % 3][a] - at[i][a];
    }
    RtFloats area = along[0][0] * along[1][1] - along[0][1] * along[1][0];
    RtFloats turn = rt_select(area < 0, rt_all(-1), rt_all(1));
    for (int i = 0; i < 3; i++) {
        RtFloats margin = (rt_abs(along[i][0]) * pad[1] + rt_abs(along[i][1]) * pad[0]) * 1.25f;
        edge[i][1] = -along[i][1] * turn;
        edge[i][2] = along[i][0] * turn;
        edge[i][0] = margin - edge[i][1] * at[i][0] - edge[i][2] * at[i][1];
    }
}

RT_KERNEL void bound(const LaneProjection *l, RtFloats v[3][3], Bounds *b) {
    const RtFloats zero = rt_all(0), most = rt_all(INFINITY), least = rt_all(-INFINITY);
    RtFloats oblique = zero, at[3][2], pad[2];
    *b = (Bounds){.lo = {most, most}, .hi = {least, least}, .near = most, .known = ~0u, .behind = ~0u};
    for (int i = 0; i < 3; i++) {
        RtFloats q[3];
        for (int a = 0; a < 3; a++) q[a] = v[i][a] - l->eye[a];
        RtFloats depth = dot(l->depth, q), w = 1 / depth;
        RtFloats size = rt_abs(q[0]) + rt_abs(q[1]) + rt_abs(q[2]);
        at[i][0] = dot(l->x, q) * w;
        at[i][1] = dot(l->y, q) * w;
        b->behind &= rt_le_bits(depth, size * -0x1p-10f);
        size = size * w;
        b->known &= rt_bits((size >= 0) & (size <= l->most_oblique));
        oblique = rt_max(oblique, size);
        for (int a = 0; a < 2; a++) {
            b->lo[a] = rt_min(b->lo[a], at[i][a]);
            b->hi[a] = rt_max(b->hi[a], at[i][a]);
        }
        b->near = rt_min(b->near, depth);
    }
    b->near = rt_max(b->near * (1 - oblique * l->nearer), zero);
    RtFloats part = (0x1p-17f + oblique * 0x1p-20f) * oblique;
    for (int a = 0; a < 2; a++) {
        pad[a] = l->reach[a] * part;
        b->lo[a] = rt_max(rt_ceil(b->lo[a] - pad[a]), zero);
        b->hi[a] = rt_min(rt_floor(b->hi[a] + pad[a]), l->last[a]);
    }
    make_edges(at, pad, b->edge);
}

/* The triangles that may hold a sample: those seen at more than two columns or rows, and of the others those
 * whose hull holds one. */
RT_KERNEL uint32_t holding_samples(const Bounds *b) {
    uint32_t some = rt_bits((b->hi[0] - b->lo[0] > 1) | (b->hi[1] - b->lo[1] > 1));
    for (int k = 0; k < 4; k++) {
        RtFloats column = k & 1 ? b->hi[0] : b->lo[0], row = k & 2 ? b->hi[1] : b->lo[1];
        uint32_t out = 0;
        for (int i = 0; i < 3; i++)
            out |= rt_lt_bits(b->edge[i][0] + b->edge[i][1] * column + b->edge[i][2] * row, rt_all(0));
        some |= ~out;
    }
    return some;
}

/* Triangles that may be seen: where, and the edges of their hulls, 0 for those projected by their boxes. */
typedef struct Projected {
    RtItemFootprint at[RT_LANES];
    float edge[3][3][RT_LANES];
    uint32_t by_box; /* a bit each */
} Projected;

/* Projects up to RT_LANES triangles; bit i if the ith may be seen. */
RT_KERNEL uint32_t project(const LaneProjection *l, const RtRef *triangles, uint32_t count, Projected *to) {
    const RtGeometry *g = rt_item_geometry(l->buffer);
    int32_t lo[2][RT_LANES], hi[2][RT_LANES];
    float near[RT_LANES];
    RtFloats v[3][3];
    Bounds b;
    rt_raster_gather(g, triangles, count, v);
    bound(l, v, &b);
    uint32_t there = (count < RT_LANES ? 1u << count : 1u << RT_LANES) - 1, seen = there & b.known;
    rt_store(near, b.near);
    for (int a = 0; a < 2; a++) {
        seen &= rt_le_bits(b.lo[a], b.hi[a]);
        rt_store(lo[a], rt_to_ints(b.lo[a]));
        rt_store(hi[a], rt_to_ints(b.hi[a]));
    }
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) rt_store(to->edge[i][a], b.edge[i][a]);
    }
    if (seen) seen &= holding_samples(&b);
    for (uint32_t lanes = seen; lanes; lanes &= lanes - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(lanes);
        for (int a = 0; a < 2; a++) {
            to->at[k].lo[a] = (uint32_t)lo[a][k];
            to->at[k].hi[a] = (uint32_t)hi[a][k];
        }
        to->at[k].near = near[k];
    }
    to->by_box = there & ~(b.known | b.behind);
    for (uint32_t lanes = to->by_box; lanes; lanes &= lanes - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(lanes);
        uint32_t id = g->triangle_ids[rt_ref_index(triangles[k])];
        if (rt_item_footprint(l->buffer, id, &to->at[k])) seen |= 1u << k;
        for (int i = 0; i < 3; i++) to->edge[i][0][k] = to->edge[i][1][k] = to->edge[i][2][k] = 0;
    }
    return seen;
}

static uint32_t place(const RtItemBuffer *buffer, uint32_t first, uint32_t count, RtItemRange *to) {
    LaneProjection projection;
    uint32_t placed = 0;
    make_lane_projection(&projection, buffer);
    for (const uint32_t end = first + count; first < end; first += RT_LANES) {
        RtRef triangles[RT_LANES];
        Projected projected;
        for (uint32_t k = 0; k < RT_LANES; k++) triangles[k] = rt_ref(RT_SHAPE_TRIANGLE, first + k);
        uint32_t seen = project(&projection, triangles, end - first, &projected);
        for (; seen; seen &= seen - 1) {
            uint32_t k = (uint32_t)__builtin_ctz(seen);
            to[placed++] = rt_item_range(buffer, triangles[k], &projected.at[k]);
        }
    }
    return placed;
}

/* ---- drawing ---- */

/* Tests the pending pairs, and keeps the nearest hits. */
RT_KERNEL void flush_drawn(RtItemTile *tile, PendingTests *p) {
    float t[RT_ITEM_PENDING];
    uint64_t changed = 0; /* blocks, a bit each */
    uint32_t hits = test_pending(tile->buffer, p, t);
    tile->tally.object_tests += p->count;
    tile->tally.object_hits += (uint32_t)__builtin_popcount(hits);
    for (; hits; hits &= hits - 1) {
        uint32_t k = (uint32_t)__builtin_ctz(hits), i = p->place[k];
        if (!rt_hit_before(t[k], p->id[k], (RtHit){tile->t[i], tile->id[i]})) continue;
        tile->t[i] = t[k];
        tile->id[i] = p->id[k];
        changed |= UINT64_C(1) << i / RT_ITEM_BLOCK_SAMPLES;
    }
    for (; changed; changed &= changed - 1) rt_item_update_farthest(tile, (uint32_t)__builtin_ctzll(changed));
    p->count = 0;
}

RT_KERNEL RtFloats edge_at(const RtFloat4 edge[3], int i, RtFloats column, RtFloats row) {
    return edge[0][i] + edge[1][i] * column + edge[2][i] * row;
}

/* The samples of the block at (column, row) of the image that are inside the edges and have no hit before
 * `near`, a bit each. */
RT_KERNEL uint32_t samples_of(const float *t, float near, const RtFloat4 edge[3], uint32_t column,
                              uint32_t row) {
    /* Four columns, RT_GROUPS rows. */
    const RtFloats columns = rt_to_floats(rt_lane_numbers() & 3) + (float)column;
    uint32_t samples = 0;
    for (uint32_t i = 0; i < RT_ITEM_BLOCK_SAMPLES; i += RT_LANES) {
        const uint32_t first_row = row + i / RT_ITEM_BLOCK;
        const RtFloats rows = rt_to_floats(rt_lane_numbers() >> 2) + (float)first_row;
        uint32_t lanes = rt_le_bits(rt_all(near), rt_load(t + i));
        for (int k = 0; k < 3; k++) lanes &= ~rt_lt_bits(edge_at(edge, k, columns, rows), rt_all(0));
        samples |= lanes << i;
    }
    return samples;
}

/* Tests samples of the block from `first` on, a bit each, against one triangle, and keeps the nearest hits.
 */
RT_KERNEL void draw_block(RtItemTile *tile, uint32_t first, uint32_t samples, uint32_t triangle) {
    const RtGeometry *g = rt_item_geometry(tile->buffer);
    const uint32_t id = g->triangle_ids[triangle];
    RtRayTriangles pairs = {.tmin = rt_all((float)tile->buffer->view.near), .tmax = rt_all(INFINITY)};
    bool nearer = false;
    for (int a = 0; a < 3; a++) {
        pairs.org[a] = rt_all((float)tile->buffer->view.eye.at[a]);
        for (int i = 0; i < 3; i++) pairs.v[i][a] = rt_all(g->triangles[triangle].v[i].at[a]);
    }
    tile->tally.object_tests += (uint32_t)__builtin_popcount(samples);
    for (uint32_t i = 0; i < RT_ITEM_BLOCK_SAMPLES; i += RT_LANES) {
        const float *from[RT_LANES];
        float t[RT_LANES];
        RtFloats dir[4], at;
        uint32_t lanes = samples >> i & ((1u << RT_LANES) - 1);
        if (!lanes) continue;
        for (uint32_t k = 0; k < RT_LANES; k++) from[k] = tile->dir[first + i + k];
        rt_load_columns(from, dir);
        for (int a = 0; a < 3; a++) pairs.dir[a] = dir[a];
        lanes &= rt_hit_pairs(&pairs, &at);
        rt_store(t, at);
        tile->tally.object_hits += (uint32_t)__builtin_popcount(lanes);
        for (; lanes; lanes &= lanes - 1) {
            const uint32_t k = (uint32_t)__builtin_ctz(lanes), sample = first + i + k;
            if (!rt_hit_before(t[k], id, (RtHit){tile->t[sample], tile->id[sample]})) continue;
            tile->t[sample] = t[k];
            tile->id[sample] = id;
            nearer = true;
        }
    }
    if (nearer) rt_item_update_farthest(tile, first / RT_ITEM_BLOCK_SAMPLES);
}

/* The block of the tile that holds a sample of the image, along one axis. */
RT_KERNEL uint32_t block_in(uint32_t sample, uint32_t corner) {
    uint32_t at = sample > corner ? sample - corner : 0;
    return (at < RT_ITEM_TILE ? at : RT_ITEM_TILE - 1) / RT_ITEM_BLOCK;
}

/* The blocks of a footprint that do not hide what is not nearer than `near`, a bit each. */
RT_KERNEL uint64_t open_blocks(const RtItemTile *tile, const RtItemFootprint *at) {
    const uint32_t left = block_in(at->lo[0], tile->column), right = block_in(at->hi[0], tile->column);
    const uint32_t top = block_in(at->lo[1], tile->row), bottom = block_in(at->hi[1], tile->row);
    uint64_t open = 0;
    for (uint32_t y = top; y <= bottom; y++) {
        for (uint32_t x = left; x <= right; x++) {
            const uint32_t block = y * RT_ITEM_ACROSS + x;
            open |= (uint64_t)(at->near <= tile->farthest[block]) << block;
        }
    }
    return open;
}

enum { MANY_SAMPLES = 4 }; /* of a block, which are tested at once, not with those of other blocks */

/* Draws triangle k of those projected. An edge is largest in a block at the corner on its inner side. */
RT_KERNEL void draw_triangle(RtItemTile *tile, uint32_t triangle, const Projected *projected, uint32_t k,
                             PendingTests *pending) {
    const RtGeometry *g = rt_item_geometry(tile->buffer);
    const RtFloat4 zero = rt_all4(0);
    const float near = projected->at[k].near;
    uint64_t open = open_blocks(tile, &projected->at[k]);
    RtFloat4 edge[3];
    if (!open) return;
    for (int a = 0; a < 3; a++)
        edge[a] = (RtFloat4){projected->edge[0][a][k], projected->edge[1][a][k], projected->edge[2][a][k], 0};
    const RtFloat4 most = edge[0] + (rt_max(edge[1], zero) + rt_max(edge[2], zero)) * (RT_ITEM_BLOCK - 1);
    for (; open; open &= open - 1) {
        const uint32_t block = (uint32_t)__builtin_ctzll(open), first = block * RT_ITEM_BLOCK_SAMPLES;
        const uint32_t column = tile->column + block % RT_ITEM_ACROSS * RT_ITEM_BLOCK;
        const uint32_t row = tile->row + block / RT_ITEM_ACROSS * RT_ITEM_BLOCK;
        if (rt_lt_bits(most + edge[1] * (float)column + edge[2] * (float)row, zero)) continue;
        uint32_t samples = samples_of(&tile->t[first], near, edge, column, row);
        if (__builtin_popcount(samples) >= MANY_SAMPLES) {
            draw_block(tile, first, samples, triangle);
            continue;
        }
        for (; samples; samples &= samples - 1) {
            uint32_t i = first + (uint32_t)__builtin_ctz(samples);
            add_pending(pending, g, triangle, tile->dir[i], i);
            if (pending->count == RT_ITEM_PENDING) flush_drawn(tile, pending);
        }
    }
}

static void draw(RtItemTile *tile, const RtRef *objects, size_t count) {
    const RtGeometry *g = rt_item_geometry(tile->buffer);
    Projected projected;
    PendingTests pending = {.count = 0};
    LaneProjection projection;
    make_lane_projection(&projection, tile->buffer);
    for (size_t i = 0; i < count;) {
        uint32_t some = 0;
        while (some < RT_LANES && i + some < count && rt_raster_is_triangle(objects[i + some])) some++;
        if (some == 0) {
            rt_item_draw_object(tile, rt_raster_id(g, objects[i++]));
            continue;
        }
        uint32_t seen = project(&projection, &objects[i], some, &projected);
        for (; seen; seen &= seen - 1) {
            uint32_t k = (uint32_t)__builtin_ctz(seen);
            draw_triangle(tile, rt_ref_index(objects[i + k]), &projected, k, &pending);
        }
        i += some;
    }
    if (pending.count > 0) flush_drawn(tile, &pending);
}

/* ---- answering ---- */

enum {
    PREFETCH = 64, /* rays ahead */
    RUN = 256 /* rays whose kinds are looked at before they are answered: they are read from memory once */
};

/* A run of primary rays. */
typedef struct RayRun {
    const RtItemBuffer *buffer;
    const RtScratch *scratch;
    const RtRay *rays;
    RtHit *hits;
    double rows_per_sample; /* 1 / columns */
    PendingTests pending;
} RayRun;

RT_KERNEL void pass_on(const RayRun *run, size_t i, RtTally *tallies) {
    if (tallies) tallies[RT_RAY_PRIMARY].passed_on++;
    RT_OBSERVE(tallies, .kind = RT_TRACED_PASSED_ON, .what = "item");
    rt_hand_down(&run->buffer->base, run->scratch, &run->rays[i], 1, &run->hits[i], NULL, tallies);
}

RT_COLD static void observe_pending(const RtGeometry *g, const PendingTests *p, const float *t) {
    for (uint32_t k = 0; k < p->count; k++) {
        uint32_t id = p->id[k];
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_TEST, .index = id, .box = &g->boxes[id]});
        rt_observe(&(RtTraced){.kind = RT_TRACED_OBJECT_HIT, .index = id, .t = t[k]});
    }
}

/* All hit: these are the rays for which the samples were drawn. */
RT_KERNEL void flush_pending(RayRun *run, RtTally *tallies) {
    PendingTests *p = &run->pending;
    RtTally *tally = tallies ? &tallies[RT_RAY_PRIMARY] : NULL;
    float t[RT_ITEM_PENDING];
    uint32_t hits = test_pending(run->buffer, p, t);
    RT_COUNT(tally, object_tests, p->count);
    RT_COUNT(tally, object_hits, (uint32_t)__builtin_popcount(hits));
    if (RT_OBSERVED(tallies)) observe_pending(rt_item_geometry(run->buffer), p, t);
    for (uint32_t k = 0; k < p->count; k++)
        rt_put_answer(&(RtHit){t[k], p->id[k]}, p->place[k], false, run->hits, NULL, tally);
    p->count = 0;
}

/* Is a ray, bit for bit, the ray of its sample? */
RT_KERNEL bool is_of_sample(const RtItemBuffer *self, const RtRay *ray, RtFloat4 org,
                            double rows_per_sample) {
    if (ray->source >= rt_item_sample_count(self)) return false;
    /* The half is more than the product's rounding can lose or add. */
    uint32_t row = (uint32_t)((ray->source + 0.5) * rows_per_sample);
    uint32_t column = ray->source - row * self->view.sampling.columns;
    RtFloat4 dir = rt_round4(self->columns[column] + self->rows[row]);
    RtInt4 same = ((RtInt4)dir == rt_load_ints4(&ray->dir)) & ((RtInt4)org == rt_load_ints4(&ray->org));
    return rt_bits(same) == 15;
}

/* The nearest hit of a ray, which is on the object with this id. In instances, their parts need not be asked.
 */
RT_KERNEL void hit_object(const RtGeometry *g, uint32_t id, const RtRay *ray, RtHitMemory *hit_memory,
                          RtHit *hit, RtTally *tally) {
    const RtHit none = RT_MISS;
    RtEntry entries[RT_MAX_NESTING];
    RtRay inside[RT_MAX_NESTING];
    RtPreparedRay prepared;
    uint32_t levels = 0, object = id, at;
    rt_hit_ray(&prepared, g, ray, hit_memory);
    while (rt_is_instance(g, at = rt_geometry_holder(g, object)) &&
           rt_enter_begin(g, at, &prepared, &none, &entries[levels], &inside[levels], tally)) {
        const RtInstance *instance = rt_instance_of(g, at);
        object -= instance->first;
        g = instance->geometry;
        rt_hit_ray(&prepared, g, &inside[levels++], hit_memory);
    }
    if (!rt_is_instance(g, at)) rt_test_object(g, object, &prepared, false, hit, tally);
    const bool met = hit->object != RT_NO_OBJECT;
    while (levels-- > 0) {
        hit->t = rt_clamp_entry(&entries[levels], hit->t);
        RT_OBSERVE(tally, .kind = RT_TRACED_LEFT, .met = met, .t = hit->t);
    }
    *hit = met ? (RtHit){hit->t, id} : RT_MISS;
}

/* If it is, *triangle is its index. */
RT_KERNEL bool is_triangle(const RtGeometry *g, uint32_t id, uint32_t *triangle) {
    if (id >= g->object_count - g->instance_count) return false;
    *triangle = rt_ref_index(g->objects[id]);
    return rt_raster_is_triangle(g->objects[id]);
}

RT_KERNEL void answer_run(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                          RtHit *hits, RtTally *tallies) {
    const RtItemBuffer *self = (const RtItemBuffer *)accel;
    const RtGeometry *g = &accel->scene->geometry;
    RtTally *tally = tallies ? &tallies[RT_RAY_PRIMARY] : NULL;
    RayRun run;
    run.buffer = self;
    run.scratch = scratch;
    run.rays = rays;
    run.hits = hits;
    run.rows_per_sample = 1.0 / self->view.sampling.columns;
    run.pending.count = 0;
    const bool mixed = g->triangle_count < g->object_count;
    const RtFloat4 org = {(float)self->view.eye.x, (float)self->view.eye.y, (float)self->view.eye.z,
                          (float)self->view.near};
    for (size_t i = 0; i < count; i++) {
        const RtRay *ray = &rays[i];
        if (!is_of_sample(self, ray, org, run.rows_per_sample)) {
            pass_on(&run, i, tallies);
            continue;
        }
        uint32_t id = self->samples[ray->source], triangle = id;
        RT_COUNT(tally, steps, 1);
        RT_OBSERVE(tally, .kind = RT_TRACED_STEP, .what = "sample", .index = ray->source);
        __builtin_prefetch(ray + PREFETCH);
        if (id == RT_NO_OBJECT) {
            rt_put_answer(&RT_MISS, i, false, hits, NULL, tally);
        } else if (mixed ? is_triangle(g, id, &triangle) : true) {
            __builtin_prefetch(&g->triangles[triangle]);
            __builtin_prefetch(&g->triangles[triangle].v[2].z);
            add_pending(&run.pending, g, triangle, ray->dir.at, (uint32_t)i);
            if (run.pending.count == RT_ITEM_PENDING) flush_pending(&run, tallies);
        } else {
            RtHit hit = RT_MISS;
            hit_object(g, id, ray, scratch->hit_memory, &hit, tally);
            rt_put_answer(&hit, i, false, hits, NULL, tally);
        }
    }
    if (run.pending.count > 0) flush_pending(&run, tallies);
}

/* Nearest hits of primary rays; runs of others, and queries for occluders, are handed down. */
RT_KERNEL void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                     RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    (void)counted;
    if (any) rt_hand_down(accel, scratch, rays, count, NULL, occluders, tallies);
    for (size_t i = 0, next; !any && i < count; i = next) {
        bool own = rays[i].kind == RT_RAY_PRIMARY;
        for (next = i + 1; next < count && (!own || next - i < RUN); next++) {
            if ((rays[next].kind == RT_RAY_PRIMARY) != own) break;
        }
        if (own)
            answer_run(accel, scratch, rays + i, next - i, hits + i, tallies);
        else
            rt_hand_down(accel, scratch, rays + i, next - i, hits + i, NULL, tallies);
    }
}

RT_DEFINE_STREAM_KERNELS(trace, 0)
RT_DEFINE_KERNEL_TABLE(item);
static const RtItemRaster raster = {place, draw};
const RtItemRaster *const RT_OF_ISA(item_raster) = &raster;
