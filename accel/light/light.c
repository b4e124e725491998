/* SPDX-License-Identifier: Apache-2.0 */
/* light: the light buffer of Haines & Greenberg 1986, an overlay for shadow rays.
 *
 * A ray to a light lies in one cell of the cube around it, and can be blocked by the objects in the list of
 * that cell alone, and of these by none that is deeper than the ray's origin. Lists end where one object
 * covers a cell, or where they would be too long: a ray that comes to such an end is passed on. So nothing
 * need be proved about covers, and lists may be cut anywhere.
 *
 * Every object is opaque: shadow rays are blocked by whatever they meet, transmission or not (rt_shadow_ray
 * in render/illumination.c and its caller attenuate nothing). So any shape that fills a cell can cover it.
 *
 * Exact: every object is tested by its own hit function, or the same in lanes; lists hold more than needed
 * rather than less (light_project.c). Passed on are also rays that are not exactly what a shadow ray is: from
 * inside the domain, dir = light - origin, tmax at most 1.
 *
 * This file builds it: margins; grids; whether it pays; then the lists. */
#include "accel/light/light.h"

#include "accel/raster/raster.h"
#include "core/base/parallel.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* ---- looking at it ---- */

static uint32_t cells_of(const RtLightGrid *grid) {
    return grid->columns * grid->rows;
}

static bool find_cell(const RtAccel *accel, const RtRay *ray, RtCellView *out) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    const int face = rt_light_face_of(ray->dir);
    const RtLightGrid *grids = buffer->cubes[ray->source].grids, *grid = &grids[face];
    uint32_t cell;
    if (!buffer->serves || !rt_light_cell_of(grid, face, ray->dir, &cell)) return false;
    const RtLightEntry *list = grid->entries + grid->first[cell];
    out->number = cell;
    for (int before = 0; before < face; before++) out->number += cells_of(&grids[before]);
    out->length = grid->first[cell + 1] - grid->first[cell];
    out->cut = out->length > 0 && list[out->length - 1].object == RT_LIGHT_BEYOND;
    out->length -= out->cut;
    out->object = out->length > 0 ? rt_raster_id(&accel->scene->geometry, list[0].object) : RT_NO_OBJECT;
    return true;
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    *out = (RtDescription){RT_NO_PREDICTION};
    out->bytes = accel->scene->light_count * sizeof(RtLightCube);
    if (!buffer->serves) return;
    for (uint32_t i = 0; i < 6 * accel->scene->light_count; i++) {
        const RtLightGrid *grid = &buffer->cubes[i / 6].grids[i % 6];
        uint32_t cells = cells_of(grid);
        if (cells == 0) continue;
        out->leaves += cells;
        out->references += grid->first[cells];
        for (uint32_t cell = 0; cell < cells; cell++)
            out->empty_leaves += grid->first[cell] == grid->first[cell + 1];
        out->bytes += (cells + (size_t)1) * sizeof(uint32_t) + grid->first[cells] * sizeof(RtLightEntry);
    }
}

static RtStatus check_order(const RtLightFace *on, uint32_t light, RtError *error) {
    const RtLightGrid *grid = on->grid;
    for (uint32_t cell = 0; cell < cells_of(grid); cell++) {
        const uint32_t first = grid->first[cell], end = grid->first[cell + 1];
        if (first > end)
            return rt_fail(error, RT_MISMATCH, "light: list %u of face %d of light %u ends before it begins",
                           cell, on->face, light);
        for (uint32_t i = first; i < end; i++) {
            const RtLightEntry *entry = &grid->entries[i];
            bool last = i + 1 == end, good = entry->depth >= 0;
            if (entry->object == RT_LIGHT_BEYOND)
                good = good && last;
            else
                good = good && rt_raster_id(on->geometry, entry->object) < on->geometry->object_count;
            if (good && (last || entry->depth <= entry[1].depth)) continue;
            return rt_fail(error, RT_MISMATCH, "light: list %u of face %d of light %u is not in order", cell,
                           on->face, light);
        }
    }
    return RT_OK;
}

/* Is the object in the list of a cell, not deeper than that, or was the list cut before? */
static bool is_listed(const RtLightGrid *grid, uint32_t cell, RtRef object, float depth) {
    for (uint32_t i = grid->first[cell]; i < grid->first[cell + 1]; i++) {
        const RtLightEntry *entry = &grid->entries[i];
        if (entry->depth > depth) return false;
        if (entry->object == object || entry->object == RT_LIGHT_BEYOND) return true;
    }
    return false;
}

static RtStatus check_object(const RtLightFace *on, uint32_t light, uint32_t id, RtError *error) {
    RtLightFootprint footprint;
    RtLightDepths depths;
    if (!rt_light_project(on, id, &footprint)) return RT_OK;
    for (uint32_t row = footprint.lo[1]; row <= footprint.hi[1]; row++) {
        for (uint32_t column = footprint.lo[0]; column <= footprint.hi[0]; column++) {
            const uint32_t cell = row * on->grid->columns + column;
            if (!rt_light_see(&footprint, column, row, &depths)) continue;
            if (is_listed(on->grid, cell, on->geometry->objects[id], depths.near)) continue;
            return rt_fail(error, RT_MISMATCH,
                           "light: the list of cell %u,%u of face %d of light %u lacks object %u at depth %g",
                           column, row, on->face, light, id, (double)depths.near);
        }
    }
    return RT_OK;
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const RtLightBuffer *buffer = (const RtLightBuffer *)accel;
    if (!buffer->serves) return RT_OK;
    for (uint32_t i = 0; i < 6 * accel->scene->light_count; i++) {
        const RtLightFace on = rt_light_face(buffer, i / 6, (int)(i % 6));
        RT_TRY(check_order(&on, i / 6, error));
        for (uint32_t id = 0; id < on.geometry->object_count; id++)
            RT_TRY(check_object(&on, i / 6, id, error));
    }
    return RT_OK;
}

/* ---- margins ---- */

static RtStatus make_cubes(RtLightBuffer *buffer, RtError *error) {
    const RtScene *scene = buffer->base.scene;
    buffer->cubes = rt_arena_alloc(&buffer->base.memory, scene->light_count, sizeof(RtLightCube));
    RT_TRY(rt_arena_check(&buffer->base.memory, "a light buffer", error));
    buffer->domain = scene->geometry.box;
    /* Secondary rays start a little off the surface, so the domain is wider than the scene. */
    if (scene->geometry.object_count > 0) {
        const RtBox *box = &scene->geometry.box;
        float grow = (float)(0x1p-8 * rt_box_longest_side(*box) + 0x1p-16 * rt_box_largest_coordinate(*box));
        for (int a = 0; a < 3; a++) {
            buffer->domain.lo.at[a] -= grow;
            buffer->domain.hi.at[a] += grow;
        }
    }
    for (uint32_t i = 0; i < scene->light_count; i++) {
        RtBox all = rt_box_add_point(buffer->domain, scene->lights[i].position);
        buffer->cubes[i].margin =
            0x1p-18 * rt_box_longest_side(all) + 0x1p-20 * rt_box_largest_coordinate(all);
    }
    return RT_OK;
}

/* ---- grids ---- */

/* An estimate of how many objects are seen on a face, by every kth of them. */
static double objects_on(const RtLightFace *on) {
    enum { SAMPLE = 2048 };
    const RtGeometry *g = on->geometry;
    uint32_t stride = g->object_count / SAMPLE + 1, seen = 0;
    RtLightView view;
    for (uint32_t id = 0; id < g->object_count; id += stride) seen += rt_light_view(on, &g->boxes[id], &view);
    return (double)seen * stride;
}

/* Cells are chosen to be so many for each object on the face. */
static const double CELLS_OF_OBJECT = 4;

/* How many cells there are along the longer edge of a view of this width and height. */
static double choose_cells(const RtLightFace *on, const RtLightView *view, double width, double height) {
    double longer = fmax(width, height);
    double cells = longer * sqrt(CELLS_OF_OBJECT * objects_on(on) / (width * height));
    /* At least 16 times as wide as what they grow by. */
    double narrowest = 16 * (RT_LIGHT_EDGE + 4 * on->cube->margin / (view->near + view->far));
    return fmin(fmin(fmax(cells, 1), fmax(longer / narrowest, 1)), RT_LIGHT_MOST_CELLS);
}

/* `cells` along the longer edge of the part of a face that sees the scene, or as many as its objects ask for
 * if that is 0. */
static void make_grid(const RtLightFace *on, double cells, RtLightGrid *grid) {
    RtLightView view;
    *grid = (RtLightGrid){.columns = 0};
    if (on->geometry->object_count == 0 || !rt_light_view(on, &on->geometry->box, &view)) return;
    double width = view.hi[0] - view.lo[0], height = view.hi[1] - view.lo[1];
    if (cells == 0) cells = choose_cells(on, &view, width, height);
    grid->u = rt_float_below(view.lo[0]);
    grid->w = rt_float_below(view.lo[1]);
    grid->scale = (float)(cells / fmax(width, height));
    /* Views have an EDGE to spare: what rounding adds does not make a cell more. */
    double scale = (double)grid->scale;
    grid->columns = (uint32_t)fmax(ceil((view.hi[0] - (double)grid->u) * scale - 0x1p-20), 1);
    grid->rows = (uint32_t)fmax(ceil((view.hi[1] - (double)grid->w) * scale - 0x1p-20), 1);
}

/* Sets the grids of all lights; returns the number of cells. */
static double make_grids(RtLightBuffer *buffer, double cells) {
    double all = 0;
    for (uint32_t light = 0; light < buffer->base.scene->light_count; light++) {
        for (int face = 0; face < 6; face++) {
            const RtLightFace on = rt_light_face(buffer, light, face);
            RtLightGrid *grid = &buffer->cubes[light].grids[face];
            make_grid(&on, cells, grid);
            all += cells_of(grid);
        }
    }
    return all;
}

/* ---- lists ---- */

/* The lists of the cells, face by face, on all threads. All objects are projected twice: first candidates are
 * counted, and the depth is found behind which an object covers a cell; then candidates that are not behind
 * that get their place. Each list is sorted, cut where it would be too long, and moved together with the
 * others. Threads put candidates in any order, but no two of a cell are equal, so sorted lists are the same.
 */

enum { CHUNK = 256 }; /* objects that a thread takes at a time */

/* A face while its lists are made. */
typedef struct Drawing {
    RtLightFace on;
    RtLightGrid *grid;
    uint32_t longest;
    atomic_uint *count; /* [cells] candidates, as many as are counted or in their place; then lengths */
    atomic_uint *cover; /* [cells] the bits of a depth >= 0, which are in its order; INFINITY; or NULL */
} Drawing;

static uint32_t bits_of(float a) {
    uint32_t bits;
    memcpy(&bits, &a, sizeof bits);
    return bits;
}

static float cover_of(const Drawing *d, uint32_t cell) {
    float depth = INFINITY;
    uint32_t bits = d->cover ? d->cover[cell] : bits_of(depth);
    memcpy(&depth, &bits, sizeof depth);
    return depth;
}

static void lower(atomic_uint *cover, float depth) {
    uint32_t bits = bits_of(depth), old = *cover;
    while (bits < old && !atomic_compare_exchange_weak(cover, &old, bits)) {
    }
}

/* Counts an object as a candidate of a cell, or gives it its place there. */
static void draw_in_cell(const Drawing *d, uint32_t id, uint32_t cell, RtLightDepths depths) {
    const RtLightGrid *grid = d->grid;
    if (!grid->entries) {
        atomic_fetch_add_explicit(&d->count[cell], 1, memory_order_relaxed);
        if (d->cover) lower(&d->cover[cell], depths.cover);
        return;
    }
    if (depths.near > cover_of(d, cell)) return;
    uint32_t place = atomic_fetch_add_explicit(&d->count[cell], 1, memory_order_relaxed);
    grid->entries[grid->first[cell] + place] = (RtLightEntry){depths.near, d->on.geometry->objects[id]};
}

static void draw_chunk(void *context, size_t item) {
    const Drawing *d = context;
    const uint32_t first = (uint32_t)item * CHUNK, objects = d->on.geometry->object_count;
    RtLightFootprint footprint;
    RtLightDepths depths;
    uint32_t column, last;
    for (uint32_t id = first; id < objects && id < first + CHUNK; id++) {
        if (!rt_light_project(&d->on, id, &footprint)) continue;
        for (uint32_t row = footprint.lo[1]; row <= footprint.hi[1]; row++) {
            if (!rt_light_columns(&footprint, row, &column, &last)) continue;
            for (; column <= last; column++) {
                if (rt_light_see(&footprint, column, row, &depths))
                    draw_in_cell(d, id, row * d->grid->columns + column, depths);
            }
        }
    }
}

static int compare_entries(const void *a, const void *b) {
    const RtLightEntry *x = a, *y = b;
    if (x->depth != y->depth) return x->depth < y->depth ? -1 : 1;
    return x->object < y->object ? -1 : x->object > y->object;
}

static void sort_list(RtLightEntry *list, uint32_t count) {
    if (count > 24) {
        qsort(list, count, sizeof *list, compare_entries);
        return;
    }
    for (uint32_t i = 1; i < count; i++) {
        RtLightEntry entry = list[i];
        uint32_t at = i;
        for (; at > 0 && compare_entries(&entry, &list[at - 1]) < 0; at--) list[at] = list[at - 1];
        list[at] = entry;
    }
}

/* Sorts and cuts the lists of a row; counts become lengths. A list that is cut has a candidate to spare for
 * its end. */
static void finish_row(void *context, size_t item) {
    const Drawing *d = context;
    const RtLightGrid *grid = d->grid;
    for (uint32_t cell = (uint32_t)item * grid->columns, end = cell + grid->columns; cell < end; cell++) {
        RtLightEntry *list = grid->entries + grid->first[cell];
        uint32_t placed = d->count[cell], kept = placed < d->longest ? placed : d->longest;
        sort_list(list, placed);
        if (kept == grid->first[cell + 1] - grid->first[cell]) continue;
        list[kept] = (RtLightEntry){kept < placed ? list[kept].depth : cover_of(d, cell), RT_LIGHT_BEYOND};
        d->count[cell] = kept + 1;
    }
}

/* Sets `first` to the sums of counts, and counts to 0; returns the sum. */
static uint64_t place_lists(const Drawing *d) {
    uint64_t sum = 0;
    for (uint32_t cell = 0; cell < cells_of(d->grid); cell++) {
        d->grid->first[cell] = (uint32_t)sum;
        sum += d->count[cell];
        d->count[cell] = 0;
    }
    d->grid->first[cells_of(d->grid)] = (uint32_t)sum;
    return sum;
}

/* Copies the lists, one after the other, to the memory of the structure. */
static RtStatus pack_lists(const Drawing *d, RtArena *memory, RtError *error) {
    RtLightGrid *grid = d->grid;
    const RtLightEntry *from = grid->entries;
    uint32_t sum = 0;
    for (uint32_t cell = 0; cell < cells_of(grid); cell++) sum += d->count[cell];
    grid->entries = rt_arena_alloc_unset(memory, sum, sizeof(RtLightEntry));
    RT_TRY(rt_arena_check(memory, "the lists of a light buffer", error));
    sum = 0;
    for (uint32_t cell = 0; cell < cells_of(grid); sum += d->count[cell++]) {
        memcpy(grid->entries + sum, from + grid->first[cell], d->count[cell] * sizeof(RtLightEntry));
        grid->first[cell] = sum;
    }
    grid->first[cells_of(grid)] = sum;
    return RT_OK;
}

/* *left: bytes for candidates and lists; what is made is subtracted, and all of it where they do not fit. */
static RtStatus draw_face(const Drawing *d, RtArena *memory, uint64_t *left, int threads, RtError *error) {
    RT_ARENA(work);
    RtLightGrid *grid = d->grid;
    const size_t chunks = (d->on.geometry->object_count + (size_t)CHUNK - 1) / CHUNK;
    RT_TRY(rt_parallel_each(chunks, threads, draw_chunk, (void *)d, error));
    uint64_t sum = place_lists(d);
    if (sum >= *left / sizeof(RtLightEntry) || sum > UINT32_MAX) {
        *left = 0;
        return RT_OK;
    }
    grid->entries = rt_arena_alloc_unset(&work, sum, sizeof(RtLightEntry));
    RT_TRY(rt_arena_check(&work, "the lists of a light buffer", error));
    RT_TRY(rt_parallel_each(chunks, threads, draw_chunk, (void *)d, error));
    RT_TRY(rt_parallel_each(grid->rows, threads, finish_row, (void *)d, error));
    RT_TRY(pack_lists(d, memory, error));
    *left -= grid->first[cells_of(grid)] * sizeof(RtLightEntry);
    return RT_OK;
}

static RtStatus make_face(RtLightBuffer *buffer, uint32_t light, int face, uint64_t *left, int threads,
                          RtError *error) {
    RtLightGrid *grid = &buffer->cubes[light].grids[face];
    Drawing d = {.on = rt_light_face(buffer, light, face), .grid = grid, .longest = buffer->longest};
    const uint32_t cells = cells_of(grid);
    if (cells == 0) return RT_OK;
    RT_ARENA(work);
    RtArena *memory = &buffer->base.memory;
    grid->first = rt_arena_alloc_unset(memory, cells + (size_t)1, sizeof(uint32_t));
    d.count = rt_arena_alloc(&work, cells, sizeof *d.count);
    if (buffer->full_occlusion) d.cover = rt_arena_alloc_unset(&work, cells, sizeof *d.cover);
    RT_TRY(rt_arena_check(memory, "the cells of a light buffer", error));
    RT_TRY(rt_arena_check(&work, "the cells of a light buffer", error));
    for (uint32_t cell = 0; d.cover && cell < cells; cell++) d.cover[cell] = bits_of(INFINITY);
    return draw_face(&d, memory, left, threads, error);
}

/* Makes the lists of all lights. The buffer serves unless they, or the candidates of a face, would take
 * `limit` bytes or more. */
static RtStatus make_lists(RtLightBuffer *buffer, uint64_t limit, int threads, RtError *error) {
    for (uint32_t light = 0; light < buffer->base.scene->light_count; light++) {
        for (int face = 0; face < 6 && limit > 0; face++)
            RT_TRY(make_face(buffer, light, face, &limit, threads, error));
    }
    buffer->serves = limit > 0;
    return RT_OK;
}

/* Frees them; the buffer no longer serves. */
static void drop_lists(RtLightBuffer *buffer) {
    for (uint32_t light = 0; light < buffer->base.scene->light_count; light++) {
        for (int face = 0; face < 6; face++) {
            RtLightGrid *grid = &buffer->cubes[light].grids[face];
            rt_arena_free(&buffer->base.memory, grid->first);
            rt_arena_free(&buffer->base.memory, grid->entries);
            grid->first = NULL;
            grid->entries = NULL;
        }
    }
    buffer->serves = false;
}

/* ---- whether lists pay ---- */

/* Probes are shadow rays from points that the camera sees. The buffer serves only if they cost less with
 * lists than in the layer below. A cost is a weighted sum of counts, so the choice is the same on every
 * machine. It is made only over structures whose counts are (RtAccel.counts). */

/* Nanoseconds, fitted to times of light+wide and wide on 16 scenes: a step of a hierarchy, and of a list; an
 * object test; the lookup of a ray's cell; cache misses, for each doubling of a structure beyond 4 MB; and
 * the bytes of an object in the structure below. */
static const double STEP = 4.3, ENTRY = 7, TEST = 3, LOOKUP = 10;
static const double MISSES = 10, CACHE_BYTES = 4e6, BYTES_BELOW = 70;

/* Lists are made if rays cost at least so much below, and kept if in them rays cost less by this factor. */
static const double WORTH_TRYING = 30, MARGIN = 1.15;

enum { EDGE = 32, PROBES = EDGE * EDGE, FEW_PROBES = 64 };

/* Where rays are slow fewer are traced: those of some 4 million steps and tests. */
enum { MOST_WORK = 1 << 22 };

typedef struct Probes {
    RtRay rays[PROBES];
    uint32_t count;
    double cost_below; /* of a ray, ns; 0 if there are few probes */
} Probes;

/* A step of wide tests eight extents; a structure that tests one by one takes a step for each eight. */
static double steps_of(const RtTally *tally) {
    return fmax((double)tally->steps, (double)tally->extent_tests / 8);
}

static bool is_too_much(const RtTally *tally) {
    return steps_of(tally) + (double)tally->object_tests > MOST_WORK;
}

/* A ray from a hit to the light; false if the surface is turned away from it. */
static bool make_probe(const RtScene *scene, const RtRay *ray, RtHit hit, uint32_t light,
                       RtHitMemory *hit_memory, RtRay *probe) {
    RtVec3d point = rt_ray_point(ray, hit.t), dir = rt_widen(ray->dir);
    RtPlace at;
    rt_scene_place(scene, hit.object, ray, &at);
    RtVec3d side = rt_object_normals(&at.scene->geometry, at.object, &at.ray, hit.t, hit_memory).geometric;
    if (at.scene != scene) side = rt_normalized(rt_transform_normald(&at.to_world, side));
    if (rt_dotd(side, dir) > 0) side = rt_scaled(side, -1);
    double reach = (double)hit.t * sqrt(rt_dotd(dir, dir)) + sqrt(rt_dotd(point, point));
    *probe = (RtRay){.org = rt_narrow(rt_add_scaledd(point, side, 0x1p-18 * reach)),
                     .tmax = 1,
                     .kind = RT_RAY_SHADOW,
                     .source = light};
    probe->dir = rt_sub(scene->lights[light].position, probe->org);
    return rt_dotd(side, rt_widen(probe->dir)) > 0 && rt_ray_is_valid(probe);
}

/* From every so many rows and columns of the image, in an order in which each part is a sample of the whole,
 * to one light after the other. */
static RtStatus find_probes(RtLightBuffer *buffer, Probes *p, RtError *error) {
    const RtScene *scene = buffer->base.scene;
    const RtCamera *camera = &scene->camera;
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    RtSampling sampling;
    RtView view;
    RtQuery query;
    RT_TRY(rt_sampling_init(&sampling, camera->width, camera->height, 1, false, error));
    RT_TRY(rt_view_init(&view, camera, sampling, error));
    RT_TRY(rt_query_init(&query, buffer->base.below, error));
    for (uint32_t i = 0; i < PROBES && !is_too_much(&tallies[RT_RAY_PRIMARY]); i++) {
        uint32_t at = i * 397 % PROBES, column = at % EDGE, row = at / EDGE;
        RtRay ray = rt_view_ray(&view, column * camera->width / EDGE, row * camera->height / EDGE);
        RtHit hit;
        rt_nearest(&query, &ray, 1, &hit, tallies);
        p->count += hit.object != RT_NO_OBJECT && make_probe(scene, &ray, hit, i % scene->light_count,
                                                             rt_query_hit_memory(&query), &p->rays[p->count]);
    }
    rt_query_clear(&query);
    rt_tally_add(&buffer->base.build_tally, &tallies[RT_RAY_PRIMARY]);
    return RT_OK;
}

/* The cost of a ray's cache misses in a structure of so many bytes. */
static double cost_of_misses(double bytes) {
    double ns = 0;
    while (bytes > CACHE_BYTES) {
        ns += MISSES * fmin(bytes / CACHE_BYTES - 1, 1);
        bytes /= 2;
    }
    return ns;
}

/* The mean cost of probes in a structure of so many bytes, whose steps cost `step`. */
static RtStatus cost(RtLightBuffer *buffer, const Probes *p, const RtAccel *accel, double step, double bytes,
                     double *ns, RtError *error) {
    enum { STREAM = 64 };
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    const RtTally *tally = &tallies[RT_RAY_SHADOW];
    RtQuery query;
    uint32_t count = 0;
    RT_TRY(rt_query_init(&query, accel, error));
    for (uint32_t n; count < p->count && !is_too_much(tally); count += n) {
        bool blocked[STREAM];
        n = p->count - count < STREAM ? p->count - count : STREAM;
        rt_occluded(&query, p->rays + count, n, blocked, tallies);
    }
    rt_query_clear(&query);
    rt_tally_add(&buffer->base.build_tally, tally);
    *ns = (step * steps_of(tally) + TEST * (double)tally->object_tests) / count + cost_of_misses(bytes);
    return RT_OK;
}

static RtStatus make_probes(RtLightBuffer *buffer, Probes *p, RtError *error) {
    const RtAccel *accel = &buffer->base;
    if (accel->scene->light_count > 0) RT_TRY(find_probes(buffer, p, error));
    if (p->count < FEW_PROBES) return RT_OK;
    return cost(buffer, p, accel->below, STEP, BYTES_BELOW * accel->scene->geometry.object_count,
                &p->cost_below, error);
}

/* Whether lists that were made cost less than the layer below. */
static RtStatus check_that_it_pays(RtLightBuffer *buffer, const Probes *p, bool *pays, RtError *error) {
    RtDescription description;
    double ns;
    describe(&buffer->base, &description);
    RT_TRY(cost(buffer, p, &buffer->base, ENTRY, (double)description.bytes, &ns, error));
    *pays = MARGIN * (LOOKUP + ns) <= p->cost_below;
    return RT_OK;
}

/* ---- build and destroy ---- */

/* A buffer must have room for so much: a list's place, and two entries. */
enum { LEAST_OF_CELL = sizeof(uint32_t) + 2 * sizeof(RtLightEntry) };

/* Serves if all lists fit. */
static RtStatus fill(RtLightBuffer *buffer, uint64_t limit, int threads, RtError *error) {
    double cells = make_grids(buffer, buffer->cells);
    if (cells * LEAST_OF_CELL > (double)limit) return RT_OK;
    RT_TRY(make_lists(buffer, limit - (uint64_t)cells * sizeof(uint32_t), threads, error));
    if (!buffer->serves) drop_lists(buffer);
    return RT_OK;
}

/* The cells that were asked for. */
static RtStatus fill_as_asked(RtLightBuffer *buffer, const RtBuild *what, RtError *error) {
    uint32_t fits = buffer->cells;
    RT_TRY(fill(buffer, what->limit, what->threads, error));
    if (buffer->serves) return RT_OK;
    while (fits > 1 && make_grids(buffer, fits) * LEAST_OF_CELL > (double)what->limit) fits--;
    if (fits == buffer->cells) fits = fits / 2 + 1; /* lists were too long */
    return rt_fail(error, RT_BAD_INPUT,
                   "a light buffer of %u cells along the edge of a face for %u lights would take more than "
                   "%.3g GiB: try cells=%u",
                   buffer->cells, buffer->base.scene->light_count, (double)what->limit / 0x1p30, fits);
}

/* Chosen cells take no more than so many bytes for each object and light. Where counts are unknown, they
 * serve scenes of many objects. */
enum { BYTES_OF_OBJECT = 1024, MANY_OBJECTS = 12000 };

/* As many cells as the objects ask for, if they pay. */
static RtStatus fill_if_it_pays(RtLightBuffer *buffer, const RtBuild *what, Probes *probes, RtError *error) {
    const RtScene *scene = what->scene;
    uint64_t limit = (uint64_t)BYTES_OF_OBJECT * scene->geometry.object_count * scene->light_count;
    const char **idle = &buffer->base.idle;
    bool pays = scene->geometry.object_count >= MANY_OBJECTS;
    if (probes) pays = probes->cost_below > WORTH_TRYING;
    *idle = !probes ? "there are fewer than 12,000 objects, and the layer below counts nothing"
            : probes->count < FEW_PROBES ? "few of the image's samples see a surface that faces a light"
                                         : "shadow rays cost little in the layer below";
    if (!pays) return RT_OK;
    RT_TRY(fill(buffer, limit < what->limit ? limit : what->limit, what->threads, error));
    *idle = buffer->serves ? NULL : "lists would take more than 1 KB for each object and light";
    if (!probes || !buffer->serves) return RT_OK;
    RT_TRY(check_that_it_pays(buffer, probes, &pays, error));
    if (pays) return RT_OK;
    drop_lists(buffer);
    *idle = "lists would save no time";
    return RT_OK;
}

#define PARAMS(X)                                                                                            \
    X(PARAM_CELLS, "cells", RT_INT("0", 0, RT_LIGHT_MOST_CELLS, "1|7|256"),                                  \
      "cells along the longer edge of the part of a face that sees the scene; 0: as fine as the objects",    \
      "this program; Haines & Greenberg 1986 use 20 to 200")                                                 \
    X(PARAM_FULL_OCCLUSION, "full_occlusion", RT_FLAG("on"),                                                 \
      "end a list at the depth where an object covers the whole cell", "Haines & Greenberg 1986")            \
    X(PARAM_LONGEST, "longest", RT_INT("64", 1, 65534, "2"),                                                 \
      "maximum number of entries in a list; rays that need deeper ones are passed on", "measured")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    RtLightBuffer *buffer = (RtLightBuffer *)accel;
    Probes probes = {.count = 0};
    buffer->cells = (uint32_t)what->values[PARAM_CELLS].i;
    buffer->longest = (uint32_t)what->values[PARAM_LONGEST].i;
    buffer->full_occlusion = what->values[PARAM_FULL_OCCLUSION].flag;
    rt_isa_use(accel, RT_KERNELS_FOR(light, rt_isa_best()));
    RT_TRY(make_cubes(buffer, error));
    if (buffer->cells > 0) return fill_as_asked(buffer, what, error);
    if (!accel->below->counts) return fill_if_it_pays(buffer, what, NULL, error);
    RT_TRY(make_probes(buffer, &probes, error));
    return fill_if_it_pays(buffer, what, &probes, error);
}

const RtAccelOps rt_light_ops = {
    .name = "light",
    .summary = "overlay: a cube of cells around each light, with the objects seen in each cell by depth",
    .paper = "Haines & Greenberg 1986, The Light Buffer: A Shadow-Testing Accelerator, CG&A 6(9)",
    RT_PARAMS_OF(params),
    RT_BEST("cells=0|256|512|1024"),
    .kinds = 1u << RT_RAY_SHADOW,
    .trial = "light:cells=100", /* a scene of few objects has no cells but those asked for */
    .bytes = sizeof(RtLightBuffer),
    .build = build,
    .describe = describe,
    .validate = validate,
    .find_cell = find_cell,
};
