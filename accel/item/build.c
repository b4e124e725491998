/* SPDX-License-Identifier: Apache-2.0 */
/* Building an item buffer: a z-buffer that remembers two depths, that of the nearest object and the least of
 * all others.
 *
 * Objects are drawn front to back, by the nearest that each can be. Where a sample shows an object that is
 * certainly nearer, a new one is only noted in `other`. Else it is scan-converted (facet.c), which says that
 * it is missed, or hit within a span of t; what has curves or is concave may be hit anywhere in its
 * footprint. With `settle`, wherever that leaves open what is nearest the objects' own hit functions are
 * asked, with the very ray that will be traced: their t is exact. Without, such samples stay undecided, as in
 * 1984. */
#include "accel/item/item.h"
#include "accel/kernel.h"

#include "base/memory.h"

#include <stdio.h>
#include <stdlib.h>

const RtParam rt_item_params[RT_ITEM_PARAM_COUNT] = {
    {"settle", RT_FLAG("on"),
     "ask hit functions while building, where the projection leaves a sample undecided",
     "this program; off is Weghorst, Hooper & Greenberg 1984"},
};

typedef struct Entry {
    float near;
    uint32_t id;
} Entry;

typedef struct Builder {
    RtItemBuffer *buffer;
    RtItemSpan *spans; /* [samples] of the object that the sample names */
    RtCrossing *room;  /* of hit functions */
} Builder;

/* ---- one sample ---- */

static bool is_exact(const RtItemSpan *span) {
    return span->lo == span->hi;
}

/* Makes a span exact; false if the ray misses the object. */
static bool ask(const Builder *b, uint32_t id, const RtRay *ray, RtItemSpan *span) {
    RtAccel *base = &b->buffer->base;
    if (is_exact(span)) return true;
    RtPreparedRay prepared;
    rt_hit_ray(&prepared, &base->scene->geometry, ray, b->room);
    RtHit hit = RT_MISS;
    rt_test_object(&base->scene->geometry, id, &prepared, false, &hit, &base->build_tally);
    *span = (RtItemSpan){hit.t, hit.t, true};
    return hit.object != RT_NO_OBJECT;
}

static void note_other(RtItemSample *sample, float t) {
    sample->other = rt_minf(t, sample->other);
}

/* Two objects are certainly hit: names one of them, and notes the other. */
static void choose(RtItemSample *sample, RtItemSpan *seen, uint32_t id, const RtItemSpan *span) {
    bool tie = is_exact(seen) && is_exact(span) && seen->lo == span->lo;
    bool better = span->hi < seen->hi || (span->hi == seen->hi && id < sample->id);
    float loser = better ? seen->lo : span->lo;
    note_other(sample, tie ? nextafterf(loser, INFINITY) : loser);
    if (better) {
        sample->id = id;
        *seen = *span;
    }
}

/* A sample's ray may hit object `id` somewhere in `span`. */
static void draw_sample(const Builder *b, size_t at, uint32_t id, const RtRay *ray, RtItemSpan span) {
    RtItemSample *sample = &b->buffer->samples[at];
    RtItemSpan *seen = &b->spans[at];
    bool settle = b->buffer->settle;
    if (!span.certain && settle && !ask(b, id, ray, &span)) return;
    if (!span.certain || (sample->id != RT_NO_OBJECT && span.lo > seen->hi)) {
        note_other(sample, span.lo);
        return;
    }
    if (sample->id != RT_NO_OBJECT && settle && span.hi >= seen->lo) {
        if (!ask(b, sample->id, ray, seen)) sample->id = RT_NO_OBJECT;
        if (!ask(b, id, ray, &span)) return;
    }
    if (sample->id != RT_NO_OBJECT) {
        choose(sample, seen, id, &span);
    } else {
        sample->id = id;
        *seen = span;
    }
}

/* ---- one object ---- */

static void draw(const Builder *b, uint32_t id) {
    const RtItemBuffer *buffer = b->buffer;
    RtItemFootprint at;
    RtItemFacet facet;
    if (!rt_item_footprint(buffer, id, &at)) return;
    bool flat = rt_item_facet(buffer, id, &facet);
    for (uint32_t row = at.lo[1]; row <= at.hi[1]; row++) {
        for (uint32_t column = at.lo[0]; column <= at.hi[0]; column++) {
            size_t i = (size_t)row * buffer->view.sampling.columns + column;
            RtItemSample *sample = &buffer->samples[i];
            bool named = sample->id != RT_NO_OBJECT;
            if (named && at.near > b->spans[i].hi) {
                note_other(sample, at.near);
                continue;
            }
            RtRay ray = rt_view_ray(&buffer->view, column, row);
            RtItemSpan span = {at.near, INFINITY, false};
            if (flat && !rt_item_cross(&facet, &ray, at.near, &span)) continue;
            if (named && span.lo > b->spans[i].hi) {
                note_other(sample, span.lo);
                continue;
            }
            draw_sample(b, i, id, &ray, span);
        }
    }
}

static int compare_entries(const void *a, const void *b) {
    const Entry *x = a, *y = b;
    if (x->near != y->near) return x->near < y->near ? -1 : 1;
    return x->id < y->id ? -1 : x->id > y->id;
}

/* ---- all of them ---- */

static RtStatus draw_all(const Builder *b, RtError *error) {
    uint32_t objects = b->buffer->base.scene->geometry.object_count, count = 0;
    Entry *order = rt_alloc(objects, sizeof *order);
    if (!order) return rt_fail_memory(error, "an item buffer", objects * sizeof *order);
    for (uint32_t id = 0; id < objects; id++) {
        RtItemFootprint at;
        if (rt_item_footprint(b->buffer, id, &at)) order[count++] = (Entry){at.near, id};
    }
    qsort(order, count, sizeof *order, compare_entries);
    for (uint32_t i = 0; i < count; i++) draw(b, order[i].id);
    rt_free(order);
    return RT_OK;
}

/* Where the nearest object is not known for certain, it becomes one of the others. */
static void mark_undecided(const Builder *b) {
    for (size_t i = 0; i < rt_item_sample_count(b->buffer); i++) {
        RtItemSample *sample = &b->buffer->samples[i];
        bool nearest =
            sample->id == RT_NO_OBJECT ? sample->other == INFINITY : b->spans[i].hi < sample->other;
        if (nearest) continue;
        if (sample->id != RT_NO_OBJECT) note_other(sample, b->spans[i].lo);
        sample->id = RT_ITEM_UNDECIDED;
    }
}

static RtStatus refuse_size(const RtItemBuffer *buffer, RtError *error) {
    const RtSampling *s = &buffer->view.sampling;
    double a_sample = sizeof(RtItemSample) + sizeof(RtItemSpan), most = (double)RT_ACCEL_MAX_BYTES;
    double rest = (double)buffer->base.scene->geometry.object_count * sizeof(Entry);
    double bytes = (double)s->columns * s->rows * a_sample;
    if (bytes + rest <= most) return RT_OK;
    double part = sqrt((most - rest) / bytes);
    char remedy[96];
    if (part * s->samples >= 1 && s->samples > 1) {
        snprintf(remedy, sizeof remedy, "%.0f samples along the side of a pixel", floor(part * s->samples));
    } else {
        snprintf(remedy, sizeof remedy, "an image of %.0f x %.0f pixels", fmax(floor(part * s->width) - 1, 1),
                 fmax(floor(part * s->height) - 1, 1));
    }
    return rt_fail(
        error, RT_BAD_INPUT,
        "an item buffer of %u x %u samples takes %.1f GiB to build, more than %.0f GiB: %s would fit",
        s->columns, s->rows, (bytes + rest) / 0x1p30, most / 0x1p30, remedy);
}

static RtStatus fill(RtItemBuffer *buffer, RtError *error) {
    RT_TRY(rt_view_init(&buffer->view, &buffer->base.scene->camera, buffer->base.scene->sampling, error));
    RT_TRY(refuse_size(buffer, error));
    rt_item_aim(buffer);
    size_t count = rt_item_sample_count(buffer);
    Builder b = {buffer, rt_alloc(count, sizeof(RtItemSpan)), NULL};
    buffer->samples = rt_alloc(count, sizeof(RtItemSample));
    RtStatus status = b.spans && buffer->samples ? RT_OK
                                                 : rt_fail_memory(error, "the samples of an item buffer",
                                                                  count * sizeof(RtItemSample));
    for (size_t i = 0; status == RT_OK && i < count; i++) {
        buffer->samples[i] = (RtItemSample){RT_NO_OBJECT, INFINITY};
    }
    if (status == RT_OK) status = rt_hit_room(&buffer->base.scene->geometry, &b.room, error);
    if (status == RT_OK) status = draw_all(&b, error);
    if (status == RT_OK) mark_undecided(&b);
    rt_free(b.spans);
    rt_free(b.room);
    return status;
}

void rt_item_destroy(RtAccel *accel) {
    RtItemBuffer *buffer = (RtItemBuffer *)accel;
    rt_free(buffer->samples);
    rt_free(buffer);
}

RtStatus rt_item_build(const RtBuild *what, RtAccel **out, RtError *error) {
    RtAccel *accel;
    RT_TRY(rt_accel_new(what, sizeof(RtItemBuffer), &accel, error));
    RtItemBuffer *buffer = (RtItemBuffer *)accel;
    buffer->settle = what->values[RT_ITEM_SETTLE].flag;
    return rt_accel_built(accel, fill(buffer, error), out);
}
