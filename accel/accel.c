/* SPDX-License-Identifier: Apache-2.0 */
/* Stacks of accelerators, overlays over a base: their layers, and what is asked of the whole; and what
 * accelerators share: the test of all objects, and sums over boxes. */
#include "accel/kernel.h"

#include <assert.h>

/* ---- layers ---- */

uint64_t rt_accel_byte_limit(const RtScene *scene) {
    const uint64_t bytes = scene->geometry.object_count * RT_ACCEL_OBJECT_BYTES;
    return bytes > RT_ACCEL_MAX_BYTES ? bytes : RT_ACCEL_MAX_BYTES;
}

static void destroy_layer(RtAccel *accel) {
    if (accel->ops->destroy) accel->ops->destroy(accel);
    rt_accel_destroy_parts(accel->parts, accel->scene);
    rt_arena_clear(&accel->memory);
    rt_free(accel);
}

RtStatus rt_accel_build_layer(const RtAccelOps *ops, const RtBuild *what, RtAccel *below, RtAccel **out,
                              RtError *error) {
    assert(ops->bytes >= sizeof(RtAccel));
    RtAccel *accel = rt_alloc(1, ops->bytes);
    if (!accel) return rt_fail_memory(error, ops->name, ops->bytes);
    *accel = (RtAccel){.ops = ops,
                       .scene = what->scene,
                       .below = below,
                       .kernels = ops->kernels,
                       .scratch_bytes = ops->kernels ? ops->kernels->scratch_bytes : 0,
                       .exact = !below || below->exact,
                       .absolute = below && below->absolute,
                       .counts = !below || below->counts};
    RtStatus status = ops->build ? ops->build(accel, what, error) : RT_OK;
    if (status == RT_OK) status = rt_arena_check(&accel->memory, ops->name, error);
    if (status == RT_OK)
        *out = accel;
    else
        destroy_layer(accel);
    return status;
}

void rt_accel_destroy_parts(RtAccel **parts, const RtScene *scene) {
    for (uint32_t i = 0; parts && i < scene->part_count; i++) rt_accel_destroy(parts[i]);
    rt_free(parts);
}

bool rt_accel_refuses(RtStatus status) {
    return status == RT_BAD_INPUT || (status == RT_NO_MEMORY && rt_memory_limit_was_reached());
}

void rt_accel_destroy(RtAccel *accel) {
    while (accel) {
        RtAccel *below = accel->below;
        destroy_layer(accel);
        accel = below;
    }
}

/* ---- the whole stack ---- */

const RtAccel *rt_accel_base(const RtAccel *accel) {
    while (accel->below) accel = accel->below;
    return accel;
}

static void add_sizes(const RtDescription *own, const RtTally *build, RtDescription *out) {
    out->interior += own->interior;
    out->leaves += own->leaves;
    out->empty_leaves += own->empty_leaves;
    out->references += own->references;
    out->bytes += own->bytes;
    rt_tally_add(&out->build, build);
    if (own->depth > out->depth) out->depth = own->depth;
}

/* Adds the parts, each once, however many instances share it. What is predicted for a level says nothing of
 * the whole. */
static void add_parts(const RtAccel *base, RtDescription *out) {
    for (uint32_t i = 0; i < base->scene->part_count; i++) {
        RtDescription part;
        rt_accel_describe(base->parts[i], &part);
        add_sizes(&part, &part.build, out);
    }
#define UNKNOWN(name, meaning) out->name = NAN;
    RT_PREDICTIONS(UNKNOWN)
    RT_QUALITIES(UNKNOWN)
#undef UNKNOWN
}

void rt_accel_describe(const RtAccel *accel, RtDescription *out) {
    const RtAccel *base = rt_accel_base(accel);
    accel->ops->describe(accel, out);
    out->build = accel->build_tally;
    while ((accel = accel->below)) {
        RtDescription own;
        accel->ops->describe(accel, &own);
        add_sizes(&own, &accel->build_tally, out);
#define COPY_PREDICTION(name, meaning) out->name = own.name;
        RT_PREDICTIONS(COPY_PREDICTION)
        RT_QUALITIES(COPY_PREDICTION)
#undef COPY_PREDICTION
    }
    if (base->parts) add_parts(base, out);
}

RtStatus rt_accel_validate(const RtAccel *accel, RtError *error) {
    for (; accel; accel = accel->below) {
        if (accel->ops->validate) RT_TRY(accel->ops->validate(accel, error));
        for (uint32_t i = 0; accel->parts && i < accel->scene->part_count; i++)
            RT_TRY(rt_accel_validate(accel->parts[i], error));
    }
    return RT_OK;
}

RtStatus rt_accel_check(const RtAccel *accel, RtError *error) {
    for (; accel; accel = accel->below) {
        if (accel->ops->check) RT_TRY(accel->ops->check(accel, error));
        for (uint32_t i = 0; accel->parts && i < accel->scene->part_count; i++)
            RT_TRY(rt_accel_check(accel->parts[i], error));
    }
    return RT_OK;
}

RtStatus rt_accel_learn(RtAccel *accel, const RtRay *rays, const RtHit *hits, size_t count, RtError *error) {
    for (; accel; accel = accel->below) {
        if (accel->ops->learn) RT_TRY(accel->ops->learn(accel, rays, hits, count, error));
    }
    return RT_OK;
}

/* ---- queries ---- */

/* Closes the layers above `end`. */
static void close_layers(const RtQuery *query, const RtAccel *end) {
    const RtScratch *scratch = query->scratch;
    for (const RtAccel *layer = query->accel; layer != end; layer = layer->below, scratch++) {
        if (layer->ops->close) layer->ops->close(layer, scratch->own);
    }
}

/* Bytes of the scratch memory of a layer: whole cache lines. */
static size_t scratch_stride(const RtAccel *layer) {
    return (layer->scratch_bytes + RT_CACHE_LINE - 1) / RT_CACHE_LINE * RT_CACHE_LINE;
}

/* On failure nothing is left of the query. */
static RtStatus open_layers(RtQuery *query, RtError *error) {
    const RtScratch *scratch = query->scratch;
    for (const RtAccel *layer = query->accel; layer; layer = layer->below, scratch++) {
        RtStatus status = layer->ops->open ? layer->ops->open(layer, scratch->own, error) : RT_OK;
        if (status == RT_OK) continue;
        close_layers(query, layer);
        query->accel = NULL;
        rt_query_clear(query);
        return status;
    }
    return RT_OK;
}

/* Opens a query in each part of the scene; all of them share the array. */
static RtStatus open_parts(RtQuery *query, RtError *error) {
    const RtAccel *base = rt_accel_base(query->accel);
    const uint32_t count = base->parts ? base->scene->part_count : 0;
    if (count == 0) return RT_OK;
    query->parts = rt_alloc(count, sizeof(RtQuery));
    if (!query->parts) return rt_fail_memory(error, "queries of parts", count * sizeof(RtQuery));
    query->part_count = count;
    if (query->scratch[0].hit_memory) query->scratch[0].hit_memory->parts = query->parts;
    for (uint32_t i = 0; i < count; i++) {
        RT_TRY(rt_query_init(&query->parts[i], base->parts[i], error));
        RtHitMemory *own = query->parts[i].scratch[0].hit_memory;
        if (own) own->parts = query->parts;
    }
    return RT_OK;
}

RtStatus rt_query_init(RtQuery *query, const RtAccel *accel, RtError *error) {
    RtScratch scratch = {NULL, NULL};
    size_t bytes = 0;
    *query = (RtQuery){0};
    RT_TRY(rt_hit_memory_alloc(&accel->scene->geometry, &scratch.hit_memory, error));
    for (const RtAccel *layer = accel; layer; layer = layer->below) bytes += scratch_stride(layer);
    if (bytes > 0 && !(scratch.own = rt_alloc(bytes, 1))) {
        rt_free(scratch.hit_memory);
        return rt_fail_memory(error, "the scratch memory of a query", bytes);
    }
    query->accel = accel;
    uint32_t layers = 0;
    for (const RtAccel *layer = accel; layer; layer = layer->below) {
        query->scratch[layers++] = scratch;
        if (scratch.own) scratch.own = (char *)scratch.own + scratch_stride(layer);
    }
    RT_TRY(open_layers(query, error));
    const RtStatus status = open_parts(query, error);
    if (status != RT_OK)
        rt_query_clear(query);
    else if (bytes > 0)
        rt_query_begin(query);
    return status;
}

void rt_query_clear(RtQuery *query) {
    close_layers(query, NULL);
    for (uint32_t i = 0; i < query->part_count; i++) rt_query_clear(&query->parts[i]);
    rt_free(query->parts);
    rt_free(query->scratch[0].own);
    rt_free(query->scratch[0].hit_memory);
    *query = (RtQuery){0};
}

void rt_query_begin(RtQuery *query) {
    const RtScratch *scratch = query->scratch;
    for (const RtAccel *layer = query->accel; layer; layer = layer->below, scratch++) {
        if (layer->ops->begin) layer->ops->begin(layer, scratch->own);
    }
    for (uint32_t i = 0; i < query->part_count; i++) rt_query_begin(&query->parts[i]);
}

void rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies) {
    rt_trace_stream(query->accel, query->scratch, rays, count, hits, NULL, tallies);
}

void rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies) {
    enum { STREAM = 1024 };
    uint32_t occluders[STREAM];
    for (size_t first = 0; first < count; first += STREAM) {
        size_t n = count - first < STREAM ? count - first : STREAM;
        rt_trace_stream(query->accel, query->scratch, rays + first, n, NULL, occluders, tallies);
        for (size_t i = 0; i < n; i++) blocked[first + i] = occluders[i] != RT_NO_OBJECT;
    }
}

/* ---- what accelerators share ---- */

RT_KERNEL bool test_all(const RtGeometry *geometry, const RtPreparedRay *ray, bool any, RtHit *best,
                        RtTally *tally) {
#define LIST(CONSTANT, name, Type) {geometry->name##_ids, geometry->name##_count},
    const struct {
        const uint32_t *ids;
        uint32_t count;
    } lists[] = {RT_SHAPES(LIST)};
#undef LIST
    for (size_t shape = 0; shape < RT_SHAPE_COUNT; shape++) {
        for (uint32_t i = 0; i < lists[shape].count; i++) {
            if (rt_test_object(geometry, lists[shape].ids[i], ray, any, best, tally)) return true;
        }
    }
    return false;
}

bool rt_test_all_timed(const RtGeometry *geometry, const RtPreparedRay *ray, bool any, RtHit *best) {
    return test_all(geometry, ray, any, best, NULL);
}

bool rt_test_all_counted(const RtGeometry *geometry, const RtPreparedRay *ray, bool any, RtHit *best,
                         RtTally *tally) {
    return test_all(geometry, ray, any, best, tally);
}

void rt_box_sums_add(void *context, const RtBoxView *view) {
    RtBoxSums *sums = context;
    RtDescription *out = sums->out;
    double area = rt_box_half_area(*view->box);
    if (view->depth > out->depth) out->depth = view->depth;
    if (view->leaf) {
        out->leaves++;
        out->empty_leaves += view->objects == 0;
        out->references += view->objects;
        sums->leaves += area;
        sums->tests += area * view->objects;
    } else {
        out->interior++;
        sums->inner += area;
    }
}

void rt_box_sums_predict(const RtBoxSums *sums, const RtBox *root, double traversal_cost) {
    double area = rt_box_half_area(*root);
    if (!(area > 0)) return;
    sums->out->predicted_tests = sums->tests / area;
    sums->out->predicted_steps = (sums->inner + sums->leaves) / area;
    sums->out->predicted_cost = (sums->tests + traversal_cost * sums->inner) / area;
}
