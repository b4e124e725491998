/* SPDX-License-Identifier: Apache-2.0 */
/* item: its parameters, its memory, and the check of its invariant; item_draw.c draws all objects.
 *
 * Exact: a sample names what its ray hits first. Rays that are not bit for bit those of the samples are
 * passed on. */
#include "accel/item/item.h"

#include <stdio.h>

/* Validating asks hit functions at most about this often. */
#define MOST_TESTS (UINT64_C(1) << 24)

enum { PARAM_ISA };
static const RtParam params[] = {
    {RT_ISA_PARAM},
};

/* ---- build ---- */

static RtStatus refuse_size(const RtItemBuffer *buffer, RtError *error) {
    const RtSampling *s = &buffer->view.sampling;
    double a_sample = sizeof(uint32_t), most = (double)RT_ACCEL_MAX_BYTES;
    double rest = (double)rt_item_geometry(buffer)->object_count * sizeof(RtItemRange) +
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
static void make_terms(RtItemBuffer *buffer) {
    const RtView *view = &buffer->view;
    const RtSampling *s = &view->sampling;
    for (uint32_t i = 0; i < rt_item_tiles(s->columns) * RT_ITEM_TILE; i++) {
        double at = rt_sample_position(i, s->columns, s->corners);
        RtVec3d term = rt_add_scaledd(view->forward, view->right, at);
        buffer->columns[i] = (RtItemTerm){term.x, term.y, term.z, INFINITY};
    }
    for (uint32_t i = 0; i < rt_item_tiles(s->rows) * RT_ITEM_TILE; i++) {
        RtVec3d term = rt_scaled(view->down, rt_sample_position(i, s->rows, s->corners));
        buffer->rows[i] = (RtItemTerm){term.x, term.y, term.z, 0};
    }
}

static RtStatus available(const RtValue *values, RtError *error) {
    return rt_isa_available(values[PARAM_ISA], error);
}

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    RtItemBuffer *buffer = (RtItemBuffer *)accel;
    RtIsa isa = rt_isa_asked(what->values[PARAM_ISA]);
    rt_isa_use(accel, RT_KERNELS_FOR(item, isa));
    buffer->raster = RT_KERNELS_FOR(item_raster, isa);
    RT_TRY(rt_view_init(&buffer->view, &what->scene->camera, what->scene->sampling, error));
    RT_TRY(refuse_size(buffer, error));
    const RtSampling *s = &buffer->view.sampling;
    RtArena *memory = &accel->memory;
    buffer->columns =
        rt_arena_alloc(memory, (size_t)rt_item_tiles(s->columns) * RT_ITEM_TILE, sizeof(RtItemTerm));
    buffer->rows = rt_arena_alloc(memory, (size_t)rt_item_tiles(s->rows) * RT_ITEM_TILE, sizeof(RtItemTerm));
    buffer->samples = rt_arena_alloc_unset(memory, rt_item_sample_count(buffer), sizeof(uint32_t));
    RT_TRY(rt_arena_check(memory, "an item buffer", error));
    buffer->projection = rt_item_projection(&buffer->view);
    make_terms(buffer);
    return rt_item_draw_all(buffer, what->threads, error);
}

static bool find_cell(const RtAccel *accel, const RtRay *ray, RtCellView *cell) {
    if (ray->source >= rt_item_sample_count((const RtItemBuffer *)accel)) return false;
    uint32_t named = ((const RtItemBuffer *)accel)->samples[ray->source];
    *cell = (RtCellView){ray->source, named != RT_NO_OBJECT, named, false};
    return true;
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const RtItemBuffer *buffer = (const RtItemBuffer *)accel;
    size_t samples = rt_item_sample_count(buffer);
    size_t terms = (size_t)buffer->view.sampling.columns + buffer->view.sampling.rows;
    *out = (RtDescription){.leaves = samples,
                           .bytes = samples * sizeof(uint32_t) + terms * sizeof(RtItemTerm),
                           RT_NO_PREDICTION};
    for (size_t i = 0; i < samples; i++) out->empty_leaves += buffer->samples[i] == RT_NO_OBJECT;
    out->references = samples - out->empty_leaves;
}

/* Every object is asked. */
static RtStatus check_sample(const RtItemBuffer *buffer, size_t i, const RtQuery *query, RtError *error) {
    const RtGeometry *g = rt_item_geometry(buffer);
    uint32_t columns = buffer->view.sampling.columns, named = buffer->samples[i];
    RtRay ray = rt_view_ray(&buffer->view, (uint32_t)(i % columns), (uint32_t)(i / columns));
    RtPreparedRay prepared;
    RtHit first = RT_MISS;
    char names[48] = "no object";
    rt_hit_ray(&prepared, g, &ray, rt_query_hit_memory(query));
    for (uint32_t id = 0; id < g->object_count; id++) rt_test_object(g, id, &prepared, false, &first, NULL);
    if (first.object == named) return RT_OK;
    if (named != RT_NO_OBJECT) snprintf(names, sizeof names, "object %u", named);
    if (first.object == RT_NO_OBJECT)
        return rt_fail(error, RT_MISMATCH, "item: sample %u,%u names %s, but its ray hits nothing",
                       ray.source % columns, ray.source / columns, names);
    return rt_fail(error, RT_MISMATCH, "item: sample %u,%u names %s, but its ray hits object %u first, at %g",
                   ray.source % columns, ray.source / columns, names, first.object, (double)first.t);
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtItemBuffer *buffer = (const RtItemBuffer *)accel;
    size_t samples = rt_item_sample_count(buffer);
    uint64_t every = (uint64_t)samples * accel->scene->geometry.object_count / MOST_TESTS + 1;
    RtQuery query;
    RT_TRY(rt_query_init(&query, accel->below, error));
    RtStatus status = RT_OK;
    for (size_t i = 0; i < samples && status == RT_OK; i += every)
        status = check_sample(buffer, i, &query, error);
    rt_query_clear(&query);
    return status;
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
    .describe = describe,
    .validate = validate,
    .find_cell = find_cell,
    .available = available,
};
