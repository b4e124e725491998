/* SPDX-License-Identifier: Apache-2.0 */
/* Building a light buffer: objects in order of depth, the covers of cells, and the lists in two passes.
 *
 * Why the lists are complete. A hit on an object at t means (base/ray.h) that the ray's point at t is in the
 * object's box but for the thickness and a few roundings: 2^-20 of the distance from the ray's origin, 2^-22
 * of the length of dir, 2^-22 of the coordinates. dir is the difference of light and origin in float32, so
 * the ray's point is off the true segment by another 2^-24 of its length. For origins inside `domain` all of
 * these are below
 *
 *     margin = 2^-18 * reach + 2^-20 * farthest,
 *
 * with reach the largest side of the box around domain and light, and farthest its largest coordinate. So the
 * true segment meets the box grown by the margin, at a depth between 0 and that of the origin, and in the
 * cell of the segment's direction, whose u and w are known to 2^-22. A sphere's hit function computes in
 * double: the distance of the line from its centre is at most its radius + 2^-24 of the distance from the
 * origin. */
#include "accel/light/light.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

const RtParam rt_light_params[RT_LIGHT_PARAM_COUNT] = {RT_LIGHT_PARAMS(RT_PARAM_ENTRY)};

static int compare_entries(const void *a, const void *b) {
    const RtLightEntry *x = a, *y = b;
    if (x->depth != y->depth) return x->depth < y->depth ? -1 : 1;
    return x->id < y->id ? -1 : x->id > y->id;
}

uint32_t rt_light_order(const RtLightBuffer *buffer, uint32_t light, int face, RtLightEntry *order) {
    uint32_t count = 0;
    for (uint32_t id = 0; id < buffer->base.scene->geometry.object_count; id++) {
        RtLightFootprint footprint;
        if (rt_light_is_near(buffer, light, id)) continue;
        if (!rt_light_footprint(buffer, light, face, id, &footprint)) continue;
        order[count++] = (RtLightEntry){footprint.depth, id};
    }
    qsort(order, count, sizeof *order, compare_entries);
    return count;
}

/* ---- margins ---- */

/* Secondary rays start a little off the surface, so the domain is wider than the scene. */
static RtBox choose_domain(const RtScene *scene) {
    RtBox box = scene->geometry.box;
    if (scene->geometry.object_count == 0) return box;
    float grow = (float)(0x1p-8 * rt_box_longest_side(box) + 0x1p-16 * rt_box_largest_coordinate(box));
    for (int a = 0; a < 3; a++) {
        box.lo.at[a] -= grow;
        box.hi.at[a] += grow;
    }
    return box;
}

static RtStatus make_margins(RtLightBuffer *buffer, RtError *error) {
    const RtScene *scene = buffer->base.scene;
    buffer->margin = rt_alloc(scene->light_count, sizeof(double));
    if (!buffer->margin) return rt_fail_memory(error, "a light buffer", scene->light_count * sizeof(double));
    buffer->domain = choose_domain(scene);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        RtBox all = rt_box_add_point(buffer->domain, scene->lights[i].position);
        buffer->margin[i] = 0x1p-18 * rt_box_longest_side(all) + 0x1p-20 * rt_box_largest_coordinate(all);
    }
    return RT_OK;
}

/* ---- lists ---- */

/* One face of one light, its objects in order. */
typedef struct Face {
    RtLightBuffer *buffer;
    uint32_t light;
    int face;
    size_t first_cell;
    const RtLightEntry *order;
    uint32_t count;
} Face;

static void cover_cells(const Face *f) {
    RtLightBuffer *buffer = f->buffer;
    for (uint32_t i = 0; i < f->count; i++) {
        uint32_t id = f->order[i].id;
        RtLightFootprint at;
        rt_light_footprint(buffer, f->light, f->face, id, &at);
        for (uint32_t row = at.lo[1]; row <= at.hi[1]; row++) {
            for (uint32_t column = at.lo[0]; column <= at.hi[0]; column++) {
                RtLightCover *cover = &buffer->covers[f->first_cell + (size_t)row * buffer->n + column];
                float depth;
                if (cover->depth <= at.depth) continue;
                if (!rt_light_covers(buffer, f->light, f->face, id, column, row, &depth)) continue;
                if (depth < cover->depth) *cover = (RtLightCover){depth, id};
            }
        }
    }
}

/* Adds 1 to slot[k] for every cell k of the face that an object belongs to; where there are entries, stores
 * the object at the slot before. Called twice: to count the lists, and to fill them. */
static void scatter(const Face *f, uint32_t *slot, uint64_t *sum) {
    RtLightBuffer *buffer = f->buffer;
    for (uint32_t i = 0; i < f->count; i++) {
        RtLightEntry entry = f->order[i];
        RtLightFootprint at;
        rt_light_footprint(buffer, f->light, f->face, entry.id, &at);
        for (uint32_t row = at.lo[1]; row <= at.hi[1]; row++) {
            for (uint32_t column = at.lo[0]; column <= at.hi[0]; column++) {
                size_t cell = f->first_cell + (size_t)row * buffer->n + column;
                if (buffer->covers && entry.depth > buffer->covers[cell].depth) continue;
                if (!rt_light_touches(buffer, f->light, f->face, entry.id, column, row)) continue;
                if (buffer->entries) buffer->entries[slot[cell]] = entry;
                slot[cell]++;
                ++*sum;
            }
        }
    }
}

typedef enum Pass { COVER, COUNT, FILL } Pass;

static uint64_t go_over_faces(RtLightBuffer *buffer, RtLightEntry *order, Pass pass) {
    uint64_t sum = 0;
    for (uint32_t light = 0; light < buffer->base.scene->light_count; light++) {
        for (int face = 0; face < 6; face++) {
            Face f = {buffer, light, face, rt_light_face(buffer, light, face), order, 0};
            f.count = rt_light_order(buffer, light, face, order);
            if (pass == COVER) {
                cover_cells(&f);
            } else {
                scatter(&f, buffer->first, &sum);
            }
        }
    }
    return sum;
}

/* Sums over all footprints, from one pass over the objects. */
typedef struct Extent {
    double cells, sides, count; /* width * height, width + height, 1; in cells */
    double near;                /* entries of near lists */
} Extent;

static Extent measure_footprints(const RtLightBuffer *buffer) {
    const RtScene *scene = buffer->base.scene;
    Extent sum = {0};
    for (uint32_t light = 0; light < scene->light_count; light++) {
        for (uint32_t id = 0; id < scene->geometry.object_count; id++) {
            RtLightFootprint at;
            bool near = rt_light_is_near(buffer, light, id);
            sum.near += near;
            for (int face = 0; !near && face < 6; face++) {
                if (!rt_light_footprint(buffer, light, face, id, &at)) continue;
                double width = at.hi[0] - at.lo[0] + 1.0, height = at.hi[1] - at.lo[1] + 1.0;
                sum.cells += width * height;
                sum.sides += width + height;
                sum.count += 1;
            }
        }
    }
    return sum;
}

/* At least as many list entries as there will be with n cells along an edge, at most as many as asked for:
 * what is within k cells is within k n / asked of the wider ones, and these may be cut at both ends. */
static double bound_references(const RtLightBuffer *buffer, const Extent *sum, uint32_t n) {
    double part = (double)n / buffer->n, cut = n < buffer->n ? 2 : 0;
    return sum->near + part * part * sum->cells + part * cut * sum->sides + cut * cut * sum->count;
}

/* Bytes of the arrays, and of one query's memory; infinite if list entries cannot be numbered. */
static double bound_bytes(const RtLightBuffer *buffer, const Extent *sum, uint32_t n) {
    double references = bound_references(buffer, sum, n);
    size_t a_cell = sizeof(uint32_t) + (buffer->full_occlusion ? sizeof(RtLightCover) : 0) +
                    (buffer->cache ? sizeof(RtLightMemory) : 0);
    if (!(references < UINT32_MAX)) return INFINITY;
    return 6.0 * n * n * buffer->base.scene->light_count * (double)a_cell +
           references * (double)sizeof(RtLightEntry);
}

/* Before anything is made or gone over: a cell too many costs time as well. */
static RtStatus refuse_size(const RtLightBuffer *buffer, RtError *error) {
    const double most = (double)RT_ACCEL_MAX_BYTES;
    Extent sum = measure_footprints(buffer);
    if (bound_bytes(buffer, &sum, buffer->n) <= most) return RT_OK;
    uint32_t fits = 1, too_many = buffer->n;
    while (too_many - fits > 1) {
        uint32_t n = fits + (too_many - fits) / 2;
        *(bound_bytes(buffer, &sum, n) <= most ? &fits : &too_many) = n;
    }
    return rt_fail(
        error, RT_BAD_INPUT,
        "a light buffer of %u x %u cells a face for %u lights with up to %.3g list entries would take "
        "more than %.0f GiB: cells=%u would fit",
        buffer->n, buffer->n, buffer->base.scene->light_count, bound_references(buffer, &sum, buffer->n),
        most / 0x1p30, fits);
}

static RtStatus make_near_lists(RtLightBuffer *buffer, RtError *error) {
    const RtScene *scene = buffer->base.scene;
    buffer->near_first = rt_alloc(scene->light_count + (size_t)1, sizeof(uint32_t));
    if (!buffer->near_first)
        return rt_fail_memory(error, "a light buffer", scene->light_count * sizeof(uint32_t));
    for (int fill = 0; fill < 2; fill++) {
        uint64_t count = 0;
        for (uint32_t light = 0; light < scene->light_count; light++) {
            for (uint32_t id = 0; id < scene->geometry.object_count; id++) {
                if (!rt_light_is_near(buffer, light, id)) continue;
                if (fill) buffer->near[count] = id;
                count++;
            }
            buffer->near_first[light + 1] = (uint32_t)count;
        }
        if (fill) break;
        buffer->near = rt_alloc(count, sizeof(uint32_t));
        if (!buffer->near)
            return rt_fail_memory(error, "the lists of a light buffer", count * sizeof(uint32_t));
    }
    return RT_OK;
}

static RtStatus make_lists(RtLightBuffer *buffer, RtLightEntry *order, RtError *error) {
    size_t cells = rt_light_cell_count(buffer);
    buffer->first = rt_alloc(cells + 1, sizeof(uint32_t));
    if (buffer->full_occlusion) buffer->covers = rt_alloc(cells, sizeof(RtLightCover));
    if (!buffer->first || (buffer->full_occlusion && !buffer->covers)) {
        return rt_fail_memory(error, "the cells of a light buffer", cells * (4 + sizeof(RtLightCover)));
    }
    if (buffer->covers) {
        for (size_t i = 0; i < cells; i++) buffer->covers[i] = (RtLightCover){INFINITY, RT_NO_OBJECT};
        go_over_faces(buffer, order, COVER);
    }
    uint64_t references = go_over_faces(buffer, order, COUNT);
    buffer->entries = rt_alloc(references, sizeof(RtLightEntry));
    if (!buffer->entries) {
        return rt_fail_memory(error, "the lists of a light buffer", references * sizeof(RtLightEntry));
    }
    /* Ends of lists; the fill pass, after which first[k] is the end of list k: shift by one. */
    uint32_t sum = 0;
    for (size_t i = 0; i <= cells; i++) {
        uint32_t length = buffer->first[i];
        buffer->first[i] = sum;
        sum += length;
    }
    go_over_faces(buffer, order, FILL);
    memmove(buffer->first + 1, buffer->first, cells * sizeof(uint32_t));
    buffer->first[0] = 0;
    return RT_OK;
}

/* ---- build and destroy ---- */

void rt_light_destroy(RtAccel *accel) {
    RtLightBuffer *buffer = (RtLightBuffer *)accel;
    rt_free(buffer->margin);
    rt_free(buffer->first);
    rt_free(buffer->entries);
    rt_free(buffer->covers);
    rt_free(buffer->near_first);
    rt_free(buffer->near);
    rt_free(buffer);
}

RtStatus rt_light_build(const RtBuild *what, RtAccel **out, RtError *error) {
    const RtValue *values = what->values;
    RtAccel *accel;
    RT_TRY(rt_accel_new(what, sizeof(RtLightBuffer), &accel, error));
    RtLightBuffer *buffer = (RtLightBuffer *)accel;
    buffer->n = (uint32_t)values[RT_LIGHT_CELLS].i;
    buffer->full_occlusion = values[RT_LIGHT_FULL_OCCLUSION].flag;
    buffer->extents = values[RT_LIGHT_EXTENTS].flag;
    buffer->cache = values[RT_LIGHT_CACHE].flag;
    uint32_t objects = what->scene->geometry.object_count;
    RtLightEntry *order = rt_alloc(objects, sizeof *order);
    RtStatus status = order ? RT_OK : rt_fail_memory(error, "a light buffer", objects * sizeof *order);
    if (status == RT_OK) status = make_margins(buffer, error);
    if (status == RT_OK) status = refuse_size(buffer, error);
    if (status == RT_OK) status = make_near_lists(buffer, error);
    if (status == RT_OK) status = make_lists(buffer, order, error);
    rt_free(order);
    return rt_accel_built(accel, status, out);
}
