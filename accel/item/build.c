/* SPDX-License-Identifier: Apache-2.0 */
/* Building an item buffer, by threads, in two steps (Pineda 1988; sort-middle in Molnar et al. 1994): objects
 * are placed into the tiles of the image that they may be seen in; then each tile is drawn by one thread.
 * Objects that are in many tiles are kept apart, in a list that every tile goes through, first of all: so
 * that no list is long, and because large objects hide others.
 *
 * The samples do not depend on the number of threads, nor do the hit functions asked: the objects of a tile
 * come in the same order however they were dealt out. */
#include "accel/item/raster.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const RtParam rt_item_params[RT_ITEM_PARAM_COUNT] = {
    {"settle", RT_FLAG("on"),
     "ask hit functions while building, where the projection leaves a sample undecided",
     "this program; off is Weghorst, Hooper & Greenberg 1984"},
    {RT_ISA_PARAM},
};

enum {
    MANY_TILES = 64 /* of an object that is kept apart */
};

/* Kinds of places: triangles; those of them that are around the eye; all other objects. */
enum { TRIANGLES, AROUND, OTHERS, KINDS };

/* One share of the objects. */
typedef struct Share {
    RtItemPlace *places; /* [end[OTHERS]], kind after kind */
    size_t end[KINDS];
    uint32_t *around; /* triangles that are left to footprints */
    size_t around_count;
    size_t *tile; /* [tiles * RT_ITEM_CLASSES]: how many of its objects are there, then where they go */
} Share;

/* An object that is not flat, to be drawn front to back. */
typedef struct Curved {
    float near;
    uint32_t id;
} Curved;

/* What a thread that draws has beside its painter. */
typedef struct Easel {
    RtItemPainter painter;
    RtRef *large; /* of a tile, [large_count] */
    Curved *curved;
    uint32_t curved_room;
} Easel;

typedef struct Builder {
    RtItemBuffer *buffer;
    size_t tiles;
    int shares;
    Share *share;       /* [shares] */
    RtItemPlace *large; /* [large_count] */
    size_t large_count;
    size_t *first; /* [tiles + 1] into `entries` */
    RtRef *entries;
    Easel **easel; /* [shares], each of the thread that uses it */
    float nearer[RT_ITEM_CLASSES - 1];
} Builder;

/* ---- placing ---- */

/* Where share `i` of `n` begins among `count`. */
static size_t begin_of(size_t count, int i, int n) {
    return count * (size_t)i / (size_t)n;
}

static uint64_t tiles_of(const RtItemPlace *place) {
    return (uint64_t)(place->hi[0] - place->lo[0] + 1) * (uint64_t)(place->hi[1] - place->lo[1] + 1);
}

static void place_footprint(const RtItemBuffer *buffer, uint32_t id, RtItemPlace *places, size_t *placed) {
    RtItemFootprint at;
    if (!rt_item_footprint(buffer, id, &at)) return;
    RtItemPlace *to = &places[(*placed)++];
    to->object = buffer->isa.base.scene->geometry.objects[id];
    to->class = 0;
    for (int a = 0; a < 2; a++) {
        to->lo[a] = (uint16_t)(at.lo[a] / RT_ITEM_TILE);
        to->hi[a] = (uint16_t)(at.hi[a] / RT_ITEM_TILE);
    }
}

/* Tile after tile, class after class. */
static size_t slot_of(uint32_t across, uint32_t x, uint32_t y, const RtItemPlace *place) {
    return ((size_t)y * across + x) * RT_ITEM_CLASSES + place->class;
}

/* Is it kept apart? */
static bool is_large(const Share *share, size_t place) {
    return (place >= share->end[TRIANGLES] && place < share->end[AROUND]) ||
           tiles_of(&share->places[place]) > MANY_TILES;
}

/* For each object of a share that is not kept apart, and each tile of its place: counts it, or, where there
 * are entries, puts it where the number says. */
static void go_over_tiles(Builder *b, Share *share) {
    uint32_t across = rt_item_tiles_across(b->buffer);
    for (size_t i = 0; i < share->end[OTHERS]; i++) {
        const RtItemPlace *place = &share->places[i];
        if (is_large(share, i)) continue;
        for (uint32_t y = place->lo[1]; y <= place->hi[1]; y++) {
            for (uint32_t x = place->lo[0]; x <= place->hi[0]; x++) {
                size_t *number = &share->tile[slot_of(across, x, y, place)];
                if (b->entries) b->entries[*number] = place->object;
                ++*number;
            }
        }
    }
}

static bool is_triangle(const RtGeometry *g, size_t id) {
    return rt_ref_shape(g->objects[id]) == RT_SHAPE_TRIANGLE;
}

/* Places a share of the triangles, and of all other objects. */
static RtStatus place_share(void *context, size_t item, int thread, RtError *error) {
    (void)thread;
    Builder *b = context;
    const RtItemBuffer *buffer = b->buffer;
    const RtGeometry *g = &buffer->isa.base.scene->geometry;
    Share *share = &b->share[item];
    size_t first = begin_of(g->triangle_count, (int)item, b->shares);
    size_t end = begin_of(g->triangle_count, (int)item + 1, b->shares);
    bool mixed = g->triangle_count < g->object_count;
    size_t first_id = mixed ? begin_of(g->object_count, (int)item, b->shares) : 0;
    size_t end_id = mixed ? begin_of(g->object_count, (int)item + 1, b->shares) : 0;
    size_t most = end - first, placed = 0;
    for (size_t id = first_id; id < end_id; id++) most += !is_triangle(g, id);
    share->places = rt_alloc_unset(most, sizeof(RtItemPlace));
    share->around = rt_alloc_unset(end - first, sizeof(uint32_t));
    share->tile = rt_alloc(b->tiles * RT_ITEM_CLASSES, sizeof(size_t));
    if (!share->places || !share->around || !share->tile)
        return rt_fail_memory(error, "an item buffer", most * sizeof(RtItemPlace));
    if (end > first) {
        buffer->painting->place(buffer, (uint32_t)first, (uint32_t)(end - first), b->nearer, share->places,
                                &placed, share->around, &share->around_count);
    }
    share->end[TRIANGLES] = placed;
    for (size_t i = 0; i < share->around_count; i++)
        place_footprint(buffer, share->around[i], share->places, &placed);
    share->end[AROUND] = placed;
    for (size_t id = first_id; id < end_id; id++) {
        if (!is_triangle(g, id)) place_footprint(buffer, (uint32_t)id, share->places, &placed);
    }
    share->end[OTHERS] = placed;
    go_over_tiles(b, share);
    return RT_OK;
}

/* ---- lists of tiles ---- */

static size_t begin_of_kind(const Share *share, int kind) {
    return kind == 0 ? 0 : share->end[kind - 1];
}

/* Kind after kind, so that the order does not depend on the number of shares. */
static RtStatus collect_large(Builder *b, RtError *error) {
    for (int pass = 0; pass < 2; pass++) {
        b->large_count = 0;
        for (int kind = 0; kind < KINDS; kind++) {
            for (int k = 0; k < b->shares; k++) {
                const Share *share = &b->share[k];
                for (size_t i = begin_of_kind(share, kind); i < share->end[kind]; i++) {
                    if (!is_large(share, i)) continue;
                    if (b->large) b->large[b->large_count] = share->places[i];
                    b->large_count++;
                }
            }
        }
        if (!b->large) b->large = rt_alloc_unset(b->large_count, sizeof(RtItemPlace));
        if (!b->large) return rt_fail_memory(error, "an item buffer", b->large_count * sizeof(RtItemPlace));
    }
    return RT_OK;
}

/* Turns numbers of objects into where they go. */
static RtStatus number_entries(Builder *b, RtError *error) {
    size_t sum = 0;
    b->first = rt_alloc(b->tiles + 1, sizeof(size_t));
    if (!b->first) return rt_fail_memory(error, "an item buffer", b->tiles * sizeof(size_t));
    for (size_t slot = 0; slot < b->tiles * RT_ITEM_CLASSES; slot++) {
        if (slot % RT_ITEM_CLASSES == 0) b->first[slot / RT_ITEM_CLASSES] = sum;
        for (int k = 0; k < b->shares; k++) {
            size_t count = b->share[k].tile[slot];
            b->share[k].tile[slot] = sum;
            sum += count;
        }
    }
    b->first[b->tiles] = sum;
    b->entries = rt_alloc_unset(sum, sizeof(RtRef));
    return b->entries ? RT_OK : rt_fail_memory(error, "an item buffer", sum * sizeof(RtRef));
}

static RtStatus fill_share(void *context, size_t item, int thread, RtError *error) {
    (void)thread, (void)error;
    Builder *b = context;
    go_over_tiles(b, &b->share[item]);
    return RT_OK;
}

/* ---- classes of depth ---- */

static int compare_descending(const void *a, const void *b) {
    float x = *(const float *)a, y = *(const float *)b;
    return (x < y) - (x > y);
}

/* Divides triangles evenly, by some of them. */
static void choose_classes(Builder *b) {
    enum { SOME = 1024 };
    const RtItemBuffer *buffer = b->buffer;
    const RtGeometry *g = &buffer->isa.base.scene->geometry;
    float w[SOME];
    uint32_t count = 0;
    for (uint64_t i = 0; i < SOME && i < g->triangle_count; i++) {
        uint64_t at = g->triangle_count < SOME ? i : i * g->triangle_count / SOME;
        double depth = rt_dotd(rt_subd(rt_widen(g->triangles[at].v[0]), buffer->view.eye), buffer->aim.depth);
        if (depth > 0) w[count++] = (float)(1 / depth);
    }
    qsort(w, count, sizeof *w, compare_descending);
    for (uint32_t i = 0; i < RT_ITEM_CLASSES - 1; i++)
        b->nearer[i] = count > 0 ? w[(i + 1) * count / RT_ITEM_CLASSES] : 0;
}

/* ---- drawing ---- */

static RtStatus make_easel(const Builder *b, Easel **out, RtError *error) {
    Easel *easel = rt_alloc(1, sizeof *easel);
    *out = easel;
    if (!easel) return rt_fail_memory(error, "an item buffer", sizeof *easel);
    easel->painter.buffer = b->buffer;
    easel->large = rt_alloc_unset(b->large_count, sizeof(RtRef));
    if (!easel->large) return rt_fail_memory(error, "an item buffer", b->large_count * sizeof(RtRef));
    return rt_hit_room(&b->buffer->isa.base.scene->geometry, &easel->painter.room, error);
}

static void free_easel(Easel *easel) {
    if (!easel) return;
    rt_free(easel->large);
    rt_free(easel->curved);
    rt_free(easel->painter.room);
    rt_free(easel);
}

static uint32_t id_of(const RtGeometry *g, RtRef object) {
    uint32_t index = rt_ref_index(object);
    switch (rt_ref_shape(object)) {
#define ID_OF(CONSTANT, name, Type)                                                                          \
    case RT_SHAPE_##CONSTANT: return g->name##_ids[index];
        RT_SHAPES(ID_OF)
#undef ID_OF
    case RT_SHAPE_COUNT: break;
    }
    return RT_NO_OBJECT;
}

static RtStatus add_curved(Easel *easel, const RtRef *objects, size_t count, uint32_t *found,
                           RtError *error) {
    const RtItemBuffer *buffer = easel->painter.buffer;
    for (size_t i = 0; i < count; i++) {
        if (rt_ref_shape(objects[i]) == RT_SHAPE_TRIANGLE) continue;
        RtItemFootprint at;
        uint32_t id = id_of(&buffer->isa.base.scene->geometry, objects[i]);
        if (!rt_item_footprint(buffer, id, &at)) continue;
        RT_TRY(rt_reserve(&easel->curved, &easel->curved_room, *found + UINT64_C(1), sizeof(Curved), error));
        easel->curved[(*found)++] = (Curved){at.near, id};
    }
    return RT_OK;
}

static int compare_curved(const void *a, const void *b) {
    const Curved *x = a, *y = b;
    if (x->near != y->near) return x->near < y->near ? -1 : 1;
    return x->id < y->id ? -1 : x->id > y->id;
}

static RtStatus draw_tile(void *context, size_t item, int thread, RtError *error) {
    Builder *b = context;
    if (!b->easel[thread]) RT_TRY(make_easel(b, &b->easel[thread], error));
    Easel *easel = b->easel[thread];
    const RtItemPainting *painting = b->buffer->painting;
    const RtRef *own = b->entries + b->first[item];
    size_t across = rt_item_tiles_across(b->buffer), large = 0, count = b->first[item + 1] - b->first[item];
    uint32_t x = (uint32_t)(item % across), y = (uint32_t)(item / across), curved = 0;
    for (size_t i = 0; i < b->large_count; i++) {
        const RtItemPlace *place = &b->large[i];
        if (x < place->lo[0] || x > place->hi[0] || y < place->lo[1] || y > place->hi[1]) continue;
        easel->large[large++] = place->object;
    }
    rt_item_begin_tile(&easel->painter, item);
    painting->paint(&easel->painter, easel->large, large);
    painting->paint(&easel->painter, own, count);
    RT_TRY(add_curved(easel, easel->large, large, &curved, error));
    RT_TRY(add_curved(easel, own, count, &curved, error));
    if (curved > 0) qsort(easel->curved, curved, sizeof(Curved), compare_curved);
    for (uint32_t i = 0; i < curved; i++) rt_item_paint_curved(&easel->painter, easel->curved[i].id);
    rt_item_end_tile(&easel->painter);
    return RT_OK;
}

/* ---- all of it ---- */

static RtStatus draw_all(Builder *b, int threads, RtError *error) {
    b->share = rt_alloc((size_t)b->shares, sizeof(Share));
    b->easel = rt_alloc((size_t)b->shares, sizeof(Easel *));
    if (!b->share || !b->easel) return rt_fail_memory(error, "an item buffer", sizeof(Share));
    choose_classes(b);
    RT_TRY(rt_parallel_for((size_t)b->shares, threads, place_share, b, error));
    RT_TRY(collect_large(b, error));
    RT_TRY(number_entries(b, error));
    RT_TRY(rt_parallel_for((size_t)b->shares, threads, fill_share, b, error));
    RT_TRY(rt_parallel_for(b->tiles, threads, draw_tile, b, error));
    for (int k = 0; k < b->shares; k++) {
        if (b->easel[k]) rt_tally_add(&b->buffer->isa.base.build_tally, &b->easel[k]->painter.tally);
    }
    return RT_OK;
}

static void clear_builder(Builder *b) {
    for (int k = 0; k < b->shares; k++) {
        if (b->share) {
            rt_free(b->share[k].places);
            rt_free(b->share[k].around);
            rt_free(b->share[k].tile);
        }
        if (b->easel) free_easel(b->easel[k]);
    }
    rt_free(b->share);
    rt_free(b->easel);
    rt_free(b->large);
    rt_free(b->first);
    rt_free(b->entries);
}

static RtStatus refuse_size(const RtItemBuffer *buffer, RtError *error) {
    const RtSampling *s = &buffer->view.sampling;
    double a_sample = sizeof(uint32_t), most = (double)RT_ACCEL_MAX_BYTES;
    double rest = (double)buffer->isa.base.scene->geometry.object_count * sizeof(RtItemPlace) +
                  ((double)s->columns + s->rows) * sizeof(RtItemTerm);
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

/* As rt_view_ray makes directions, term by term. */
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
        buffer->columns[i] = (RtItemTerm){{term.x, term.y, term.z, INFINITY}};
    }
    for (uint32_t i = 0; i < s->rows; i++) {
        RtVec3d term = rt_scaled(view->down, rt_sample_position(i, s->rows, s->corners));
        buffer->rows[i] = (RtItemTerm){{term.x, term.y, term.z, 0}};
    }
    return RT_OK;
}

static RtStatus fill(RtItemBuffer *buffer, int threads, RtError *error) {
    RT_TRY(rt_view_init(&buffer->view, &buffer->isa.base.scene->camera, buffer->isa.base.scene->sampling,
                        error));
    RT_TRY(refuse_size(buffer, error));
    rt_item_aim(buffer);
    RT_TRY(make_terms(buffer, error));
    size_t count = rt_item_sample_count(buffer);
    buffer->samples = rt_alloc_unset(count, sizeof(uint32_t));
    if (!buffer->samples)
        return rt_fail_memory(error, "the samples of an item buffer", count * sizeof(uint32_t));
    Builder b = {.buffer = buffer,
                 .tiles = (size_t)rt_item_tiles_across(buffer) * rt_item_tiles_down(buffer),
                 .shares = rt_thread_count(threads)};
    RtStatus status = draw_all(&b, threads, error);
    clear_builder(&b);
    return status;
}

void rt_item_destroy(RtAccel *accel) {
    RtItemBuffer *buffer = (RtItemBuffer *)accel;
    rt_free(buffer->samples);
    rt_free(buffer->columns);
    rt_free(buffer->rows);
    rt_free(buffer);
}

RtStatus rt_item_build(const RtBuild *what, RtAccel **out, RtError *error) {
    RtAccel *accel;
    RT_TRY(rt_accel_new(what, sizeof(RtItemBuffer), &accel, error));
    RtItemBuffer *buffer = (RtItemBuffer *)accel;
    RtIsa isa = rt_isa_asked(what->values[RT_ITEM_ISA]);
    buffer->settle = what->values[RT_ITEM_SETTLE].flag;
    buffer->isa.kernels = RT_KERNELS_FOR(item, isa);
    buffer->painting = RT_KERNELS_FOR(item_painting, isa);
    return rt_accel_built(accel, fill(buffer, what->threads, error), out);
}
