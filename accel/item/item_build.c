/* SPDX-License-Identifier: Apache-2.0 */
/* item: the item buffer of Weghorst, Hooper & Greenberg 1984, an overlay for primary rays.
 *
 * Each sample of the image knows which object its ray meets first, found once by drawing all objects. A ray
 * through a sample tests that one object, RT_LANES rays at a time where they are triangles; where the sample
 * sees nothing, none.
 *
 * Exact: the object's own hit function says whether and where it is hit, and no other object is hit before.
 * Rays of samples that are undecided, or whose object is missed, and rays that are not bit for bit those of
 * the samples are passed on.
 *
 * It is built in two steps: objects are sorted into the tiles of the image that they may be seen in
 * (accel/raster/bins.h), then each tile is drawn by one thread. Objects that are in many tiles are kept in a
 * list of their own, which every tile draws first: so no list is long, and large objects hide others.
 *
 * Neither the samples nor the hit functions asked depend on the number of threads. */
#include "accel/item/item.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <stdio.h>
#include <stdlib.h>

enum { PARAM_SETTLE, PARAM_ISA };
static const RtParam params[] = {
    {"settle", RT_FLAG("on"),
     "call hit functions while building, for samples that the projection leaves undecided",
     "this program; off is Weghorst, Hooper & Greenberg 1984"},
    {RT_ISA_PARAM},
};

enum { MANY_TILES = 64 }; /* of an object that is kept apart */

/* An object that is no triangle, to be drawn front to back. */
typedef struct Other {
    float near;
    uint32_t id;
} Other;

/* A thread that draws tiles. */
typedef struct Worker {
    RtItemDrawing drawing;
    RtRef *large; /* of a tile, [bins.large_count] */
    Other *others;
    uint32_t other_capacity;
} Worker;

typedef struct Builder {
    RtItemPlacing placing;
    RtBins bins;
    int worker_count;
    Worker **workers; /* [worker_count], each made by the thread that uses it */
} Builder;

/* ---- classes of depth ---- */

static int compare_descending(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x < y) - (x > y);
}

/* Each class gets as many triangles, by a sample of them. */
static void choose_classes(RtItemPlacing *placing) {
    enum { SOME = 1024 };
    const RtItemBuffer *buffer = placing->buffer;
    const RtGeometry *g = rt_item_geometry(buffer);
    float w[SOME];
    uint32_t count = 0;
    for (uint64_t i = 0; i < SOME && i < g->triangle_count; i++) {
        uint64_t at = g->triangle_count < SOME ? i : i * g->triangle_count / SOME;
        double depth =
            rt_dotd(rt_subd(rt_widen(g->triangles[at].v[0]), buffer->view.eye), buffer->projection.depth);
        if (depth > 0) w[count++] = (float)(1 / depth);
    }
    qsort(w, count, sizeof *w, compare_descending);
    for (uint32_t i = 0; i < RT_ITEM_CLASSES - 1; i++)
        placing->nearer[i] = count > 0 ? w[(i + 1) * count / RT_ITEM_CLASSES] : 0;
}

/* ---- drawing ---- */

static RtStatus make_worker(const Builder *b, Worker **out, RtError *error) {
    Worker *worker = rt_alloc(1, sizeof *worker);
    *out = worker;
    if (!worker) return rt_fail_memory(error, "an item buffer", sizeof *worker);
    worker->drawing.buffer = b->placing.buffer;
    worker->large = rt_alloc_unset(b->bins.large_count, sizeof(RtRef));
    if (!worker->large) return rt_fail_memory(error, "an item buffer", b->bins.large_count * sizeof(RtRef));
    return rt_crossings_alloc(rt_item_geometry(b->placing.buffer), &worker->drawing.crossings, error);
}

static void free_worker(Worker *worker) {
    if (!worker) return;
    rt_free(worker->large);
    rt_free(worker->others);
    rt_free(worker->drawing.crossings);
    rt_free(worker);
}

static RtStatus add_others(Worker *worker, const RtRef *objects, size_t count, uint32_t *found,
                           RtError *error) {
    const RtItemBuffer *buffer = worker->drawing.buffer;
    for (size_t i = 0; i < count; i++) {
        if (rt_raster_is_triangle(objects[i])) continue;
        RtItemFootprint at;
        uint32_t id = rt_raster_id(rt_item_geometry(buffer), objects[i]);
        if (!rt_item_footprint(buffer, id, &at)) continue;
        RT_TRY(
            rt_reserve(&worker->others, &worker->other_capacity, *found + UINT64_C(1), sizeof(Other), error));
        worker->others[(*found)++] = (Other){at.near, id};
    }
    return RT_OK;
}

static int compare_others(const void *a, const void *b) {
    const Other *x = a, *y = b;
    if (x->near != y->near) return x->near < y->near ? -1 : 1;
    return x->id < y->id ? -1 : x->id > y->id;
}

static RtStatus draw_tile(void *context, size_t item, int thread, RtError *error) {
    Builder *b = context;
    const RtBins *bins = &b->bins;
    if (!b->workers[thread]) RT_TRY(make_worker(b, &b->workers[thread], error));
    Worker *worker = b->workers[thread];
    const RtItemRaster *raster = b->placing.buffer->raster;
    const size_t *first = &bins->first[item * RT_ITEM_CLASSES];
    const RtRef *own = bins->objects + first[0];
    size_t across = rt_item_tiles(b->placing.buffer->view.sampling.columns);
    size_t count = first[RT_ITEM_CLASSES] - first[0], large = 0;
    uint32_t x = (uint32_t)(item % across), y = (uint32_t)(item / across), others = 0;
    for (size_t i = 0; i < bins->large_count; i++) {
        const RtTileRange *range = &bins->large[i];
        if (x < range->lo[0] || x > range->hi[0] || y < range->lo[1] || y > range->hi[1]) continue;
        worker->large[large++] = range->object;
    }
    rt_item_begin_tile(&worker->drawing, item);
    raster->draw(&worker->drawing, worker->large, large);
    raster->draw(&worker->drawing, own, count);
    RT_TRY(add_others(worker, worker->large, large, &others, error));
    RT_TRY(add_others(worker, own, count, &others, error));
    if (others > 0) qsort(worker->others, others, sizeof(Other), compare_others);
    for (uint32_t i = 0; i < others; i++) rt_item_draw_object(&worker->drawing, worker->others[i].id);
    rt_item_end_tile(&worker->drawing);
    return RT_OK;
}

/* ---- all of it ---- */

static uint32_t place_other(const void *view, uint32_t id, RtTileRange *to) {
    return rt_item_place_footprint(((const RtItemPlacing *)view)->buffer, id, 0, to);
}

static RtStatus draw_all(Builder *b, int threads, RtError *error) {
    RtItemBuffer *buffer = b->placing.buffer;
    uint32_t across = rt_item_tiles(buffer->view.sampling.columns);
    size_t tiles = (size_t)across * rt_item_tiles(buffer->view.sampling.rows);
    RtBinning binning = {.geometry = rt_item_geometry(buffer),
                         .what = "an item buffer",
                         .view = &b->placing,
                         .place_triangles = buffer->raster->place,
                         .place_object = place_other,
                         .lists = tiles * RT_ITEM_CLASSES,
                         .most_tiles = MANY_TILES};
    for (uint32_t i = 0; i < RT_ITEM_CLASSES; i++)
        binning.layers[i] = (RtTileLayer){i, RT_ITEM_CLASSES, RT_ITEM_CLASSES * across};
    b->workers = rt_alloc((size_t)b->worker_count, sizeof(Worker *));
    if (!b->workers) return rt_fail_memory(error, "an item buffer", sizeof(Worker *));
    choose_classes(&b->placing);
    RT_TRY(rt_bins_fill(&binning, threads, &b->bins, error));
    RT_TRY(rt_parallel_for(tiles, threads, draw_tile, b, error));
    for (int k = 0; k < b->worker_count; k++) {
        if (b->workers[k]) rt_tally_add(&buffer->isa.base.build_tally, &b->workers[k]->drawing.tally);
    }
    return RT_OK;
}

static RtStatus refuse_size(const RtItemBuffer *buffer, RtError *error) {
    const RtSampling *s = &buffer->view.sampling;
    double a_sample = sizeof(uint32_t), most = (double)RT_ACCEL_MAX_BYTES;
    double rest = (double)rt_item_geometry(buffer)->object_count * sizeof(RtTileRange) +
                  ((double)s->columns + s->rows) * sizeof(RtItemTerm);
    double bytes = (double)s->columns * s->rows * a_sample;
    if (bytes + rest <= most) return RT_OK;
    double part = sqrt((most - rest) / bytes);
    char remedy[96];
    if (part * s->samples >= 1 && s->samples > 1)
        snprintf(remedy, sizeof remedy, "%.0f samples along the side of a pixel", floor(part * s->samples));
    else
        snprintf(remedy, sizeof remedy, "an image of %.0f x %.0f pixels", fmax(floor(part * s->width) - 1, 1),
                 fmax(floor(part * s->height) - 1, 1));
    return rt_fail(
        error, RT_BAD_INPUT,
        "an item buffer of %u x %u samples takes %.1f GiB to build, more than %.0f GiB: %s would fit",
        s->columns, s->rows, (bytes + rest) / 0x1p30, most / 0x1p30, remedy);
}

/* The terms that rt_view_ray adds to make directions. */
static RtStatus make_terms(RtItemBuffer *buffer, RtError *error) {
    const RtView *view = &buffer->view;
    const RtSampling *s = &view->sampling;
    buffer->columns = rt_alloc(s->columns, sizeof(RtItemTerm));
    buffer->rows = rt_alloc(s->rows, sizeof(RtItemTerm));
    if (!buffer->columns || !buffer->rows)
        return rt_fail_memory(error, "an item buffer", s->columns * sizeof(RtItemTerm));
    for (uint32_t i = 0; i < s->columns; i++) {
        double at = rt_sample_position(i, s->columns, s->corners);
        RtVec3d term = rt_add_scaledd(view->forward, view->right, at);
        buffer->columns[i] = (RtItemTerm){term.x, term.y, term.z, INFINITY};
    }
    for (uint32_t i = 0; i < s->rows; i++) {
        RtVec3d term = rt_scaled(view->down, rt_sample_position(i, s->rows, s->corners));
        buffer->rows[i] = (RtItemTerm){term.x, term.y, term.z, 0};
    }
    return RT_OK;
}

static RtStatus available(const RtValue *values, RtError *error) {
    return rt_isa_available(values[PARAM_ISA], error);
}

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    RtItemBuffer *buffer = (RtItemBuffer *)accel;
    RtIsa isa = rt_isa_asked(what->values[PARAM_ISA]);
    buffer->settle = what->values[PARAM_SETTLE].flag;
    rt_isa_use(accel, RT_KERNELS_FOR(item, isa));
    buffer->raster = RT_KERNELS_FOR(item_raster, isa);
    RT_TRY(rt_view_init(&buffer->view, &what->scene->camera, what->scene->sampling, error));
    RT_TRY(refuse_size(buffer, error));
    buffer->projection = rt_item_projection(&buffer->view);
    RT_TRY(make_terms(buffer, error));
    size_t count = rt_item_sample_count(buffer);
    buffer->samples = rt_alloc_unset(count, sizeof(uint32_t));
    if (!buffer->samples)
        return rt_fail_memory(error, "the samples of an item buffer", count * sizeof(uint32_t));
    Builder b = {.placing.buffer = buffer, .worker_count = rt_thread_count(what->threads)};
    RtStatus status = draw_all(&b, what->threads, error);
    for (int k = 0; b.workers && k < b.worker_count; k++) free_worker(b.workers[k]);
    rt_free(b.workers);
    rt_bins_clear(&b.bins);
    return status;
}

static void destroy(RtAccel *accel) {
    RtItemBuffer *buffer = (RtItemBuffer *)accel;
    rt_free(buffer->samples);
    rt_free(buffer->columns);
    rt_free(buffer->rows);
}

const RtAccelOps rt_item_ops = {
    .name = "item",
    .summary =
        "overlay: the object that is seen at each sample of the image, found by projecting all objects",
    .paper = "Weghorst, Hooper & Greenberg 1984, Improved Computational Methods for Ray Tracing, TOG 3(1)",
    RT_PARAMS_OF(params),
    .kinds = 1u << RT_RAY_PRIMARY,
    .bytes = sizeof(RtItemBuffer),
    .build = build,
    .destroy = destroy,
    RT_ISA_OPS,
    .describe = rt_item_describe,
    .validate = rt_item_validate,
    .find_cell = rt_item_find_cell,
    .available = available,
};
