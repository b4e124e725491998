/* SPDX-License-Identifier: Apache-2.0 */
/* light: the light buffer of Haines & Greenberg 1986, an overlay for shadow rays.
 *
 * A ray to a light lies in one cell of the cube around it, and can be blocked by the objects in the list of
 * that cell alone, and of these by none that is deeper than the ray's origin or not around the ray's place in
 * the cell. Lists end where a cell is likely to be covered, or where they would be too long: a ray that comes
 * to such an end is passed on. So nothing need be proved about covers, and lists may be cut anywhere.
 *
 * Every object is opaque: shadow rays are blocked by whatever they meet, transmission or not (rt_shadow_ray
 * in render/illumination.c and its caller attenuate nothing). So any shape that fills a cell can cover it.
 *
 * Exact: every object is tested by its own hit function, or the same in lanes (light_pairs.h); lists hold
 * more than needed rather than less (light_footprint.c). Passed on are also rays that are not exactly what a
 * shadow ray is: from inside the domain, dir = light - origin, tmax at most 1.
 *
 * This file builds it: margins; the lights that pay (light_choice.c); grids and their resolution, near lists;
 * then the lists, light by light (light_lists.c). */
#include "accel/light/light.h"

#include "core/base/memory.h"

#include <stdlib.h>

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

static RtStatus make_cubes(RtLightBuffer *buffer, RtError *error) {
    const RtScene *scene = buffer->isa.base.scene;
    buffer->cubes = rt_alloc(scene->light_count, sizeof(RtLightCube));
    if (!buffer->cubes)
        return rt_fail_memory(error, "a light buffer", scene->light_count * sizeof(RtLightCube));
    buffer->domain = choose_domain(scene);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        RtBox all = rt_box_add_point(buffer->domain, scene->lights[i].position);
        buffer->cubes[i].margin =
            0x1p-18 * rt_box_longest_side(all) + 0x1p-20 * rt_box_largest_coordinate(all);
    }
    return RT_OK;
}

/* ---- tiles ---- */

/* The part of a face that sees the scene, and an estimate of how many objects are seen there. */
typedef struct Seen {
    RtLightView view; /* far: 0 where nothing is seen */
    double objects;
} Seen;

/* By every kth object. */
static void look_at_objects(const RtLightBuffer *buffer, uint32_t light, Seen seen[6]) {
    enum { SAMPLE = 2048 };
    const RtGeometry *g = &buffer->isa.base.scene->geometry;
    uint32_t stride = g->object_count / SAMPLE + 1;
    for (int face = 0; g->object_count > 0 && face < 6; face++) {
        const RtLightFace on = rt_light_face(buffer, light, face);
        RtLightView view;
        if (!rt_light_view(&on, &g->box, &seen[face].view)) {
            seen[face].view.far = 0;
            continue;
        }
        for (uint32_t id = 0; id < g->object_count; id += stride)
            seen[face].objects += rt_light_view(&on, &g->boxes[id], &view) ? stride : 0;
    }
}

/* Tiles of about so many objects, of which a third may be in front. */
enum { OBJECTS_OF_TILE = 64, MOST_TILES = 256, CELLS_OF_TILE = 32 };

/* How many tiles there are along the longer edge, and their resolution at most. `cells`: how many are asked
 * for along it, or 0. */
static void divide(const Seen *o, double cells, double margin, RtLightGrid *grid) {
    double width = o->view.hi[0] - o->view.lo[0], height = o->view.hi[1] - o->view.lo[1];
    double longer = fmax(width, height), tiles;
    if (cells > 0) {
        tiles = ceil(cells / CELLS_OF_TILE);
        grid->max_resolution = (uint32_t)ceil(cells / tiles);
    } else {
        tiles = floor(longer * sqrt(o->objects / OBJECTS_OF_TILE / (width * height)));
        tiles = fmin(fmax(tiles, 1), MOST_TILES);
        /* Cells 16 times as wide as what they grow by. */
        double narrowest = 16 * (0x1p-18 + 8 * margin / (o->view.near + o->view.far));
        grid->max_resolution = (uint32_t)fmin(fmax(longer / tiles / narrowest, 1), RT_LIGHT_MAX_RESOLUTION);
    }
    grid->scale = (float)(tiles / longer);
}

static void make_grid(const Seen *o, double cells, double margin, RtLightGrid *grid) {
    *grid = (RtLightGrid){.columns = 0};
    if (o->view.far <= 0) return;
    divide(o, cells, margin, grid);
    grid->u = rt_float_below(o->view.lo[0]);
    grid->w = rt_float_below(o->view.lo[1]);
    /* Views have an EDGE to spare: what rounding adds does not make a tile more. */
    double scale = (double)grid->scale;
    grid->columns = (uint32_t)fmax(ceil((o->view.hi[0] - (double)grid->u) * scale - 0x1p-20), 1);
    grid->rows = (uint32_t)fmax(ceil((o->view.hi[1] - (double)grid->w) * scale - 0x1p-20), 1);
    double most = floor(sqrt((double)RT_LIGHT_FACE_CELLS / ((double)grid->columns * grid->rows)));
    if (grid->max_resolution > most)
        grid->max_resolution = (uint32_t)most; /* where there are more than a million objects */
    /* Two steps before the nearest object, so that what is before it has a lesser key. */
    grid->depth = rt_float_below(o->view.near - 2 * (o->view.far - o->view.near) / RT_LIGHT_DEPTHS);
    grid->depth_scale = (float)((RT_LIGHT_DEPTHS - 1) / (o->view.far - (double)grid->depth));
}

/* ---- how many fit ---- */

/* A buffer must have room for so much: a list's place, and two entries. */
enum { LEAST_OF_CELL = sizeof(uint32_t) + 2 * sizeof(RtLightEntry) };

/* Sets the grids of all lights for `cells` along the longer edge, 0 to choose; returns the most cells there
 * can be. */
static double make_grids(RtLightBuffer *buffer, const Seen *seen, double cells) {
    double all = 0;
    for (uint32_t light = 0; light < buffer->isa.base.scene->light_count; light++) {
        RtLightCube *cube = &buffer->cubes[light];
        double tiles = 0;
        for (uint32_t face = 0; face < 6; face++) {
            RtLightGrid *grid = &cube->grids[face];
            make_grid(&seen[6 * (size_t)light + face], cells, cube->margin, grid);
            grid->first_tile = (uint32_t)tiles;
            tiles += (double)grid->columns * grid->rows;
            all += (double)grid->columns * grid->rows * grid->max_resolution * grid->max_resolution;
        }
        cube->tile_count = (uint32_t)tiles;
    }
    return all;
}

/* Makes tiles less fine where they are chosen, so that all fit. */
static double make_coarser(RtLightBuffer *buffer, double part) {
    double all = 0;
    for (uint32_t light = 0; light < buffer->isa.base.scene->light_count; light++) {
        for (int face = 0; face < 6; face++) {
            RtLightGrid *grid = &buffer->cubes[light].grids[face];
            grid->max_resolution = (uint32_t)fmax(grid->max_resolution * sqrt(part), 1);
            all += (double)grid->columns * grid->rows * grid->max_resolution * grid->max_resolution;
        }
    }
    return all;
}

static RtStatus fit_grids(RtLightBuffer *buffer, const Seen *seen, double limit, double *cells,
                          RtError *error) {
    uint32_t fits = 0, too_many = buffer->cells;
    double most = limit / LEAST_OF_CELL;
    *cells = make_grids(buffer, seen, buffer->cells);
    if (*cells > most && buffer->cells == 0) *cells = make_coarser(buffer, most / *cells);
    if (*cells <= most) return RT_OK;
    while (too_many - fits > 1) {
        uint32_t n = fits + (too_many - fits) / 2;
        *(make_grids(buffer, seen, n) <= most ? &fits : &too_many) = n;
    }
    return rt_fail(
        error, RT_BAD_INPUT,
        "a light buffer of %u cells along the edge of a face for %u lights would take more than %.3g "
        "GiB: cells=%u would fit",
        buffer->cells, buffer->isa.base.scene->light_count, limit / 0x1p30, fits);
}

static RtStatus choose_grids(RtLightBuffer *buffer, double limit, double *cells, RtError *error) {
    const RtScene *scene = buffer->isa.base.scene;
    Seen *seen = rt_alloc(6 * (size_t)scene->light_count, sizeof(Seen));
    if (!seen) return rt_fail_memory(error, "a light buffer", 6 * (size_t)scene->light_count * sizeof(Seen));
    for (uint32_t i = 0; i < scene->light_count; i++) look_at_objects(buffer, i, seen + 6 * (size_t)i);
    RtStatus status = fit_grids(buffer, seen, limit, cells, error);
    rt_free(seen);
    return status;
}

/* ---- near lists ---- */

static RtStatus make_near_list(RtLightBuffer *buffer, uint32_t light, RtError *error) {
    const RtGeometry *g = &buffer->isa.base.scene->geometry;
    RtLightCube *cube = &buffer->cubes[light];
    uint32_t capacity = 0;
    const RtLightFace on = rt_light_face(buffer, light, 0);
    if (!rt_light_is_in(&on, &g->box)) return RT_OK;
    for (uint32_t id = 0; id < g->object_count; id++) {
        if (!rt_light_is_near(&on, id)) continue;
        RT_TRY(rt_reserve(&cube->near, &capacity, cube->near_count + UINT64_C(1), sizeof(uint32_t), error));
        cube->near[cube->near_count++] = id;
    }
    return RT_OK;
}

/* ---- build and destroy ---- */

static RtStatus make_lights(RtLightBuffer *buffer, const RtBuild *what, RtError *error) {
    const uint32_t lights = buffer->isa.base.scene->light_count;
    double cells = 0, limit = (double)what->limit;
    RT_TRY(choose_grids(buffer, limit, &cells, error));
    double entries = (limit - cells * (double)sizeof(uint32_t)) / sizeof(RtLightEntry), tiles = 1;
    for (uint32_t i = 0; i < lights; i++) tiles += buffer->cubes[i].tile_count;
    uint32_t most_of_tile = (uint32_t)(fmin(entries, 0x1p30) / tiles);
    for (uint32_t i = 0; i < lights; i++) {
        if (buffer->cubes[i].serves) RT_TRY(make_near_list(buffer, i, error));
    }
    return rt_light_make_lists(buffer, most_of_tile, what->threads, error);
}

static bool some_serve(const RtLightBuffer *buffer) {
    bool some = false;
    for (uint32_t i = 0; i < buffer->isa.base.scene->light_count; i++) some |= buffer->cubes[i].serves;
    return some;
}

/* *probes is to be freed. */
static RtStatus fill(RtLightBuffer *buffer, const RtBuild *what, RtLightProbes **probes, RtError *error) {
    RT_TRY(make_cubes(buffer, error));
    RT_TRY(rt_light_choose(buffer, probes, error));
    if (!(buffer->serves = some_serve(buffer))) return RT_OK;
    RT_TRY(make_lights(buffer, what, error));
    RT_TRY(rt_light_choose_again(buffer, *probes, error));
    buffer->serves = some_serve(buffer);
    return RT_OK;
}

static void destroy(RtAccel *accel) {
    RtLightBuffer *buffer = (RtLightBuffer *)accel;
    for (uint32_t i = 0; buffer->cubes && i < accel->scene->light_count; i++)
        rt_light_drop(&buffer->cubes[i]);
    rt_free(buffer->cubes);
}

#define PARAMS(X)                                                                                            \
    X(PARAM_CELLS, "cells", RT_INT("0", 0, 4096, "1|7|256"),                                                 \
      "cells along the longer edge of the part of a face that sees the scene; 0: as fine as the objects",    \
      "this program; Haines & Greenberg 1986 use 20 to 200")                                                 \
    X(PARAM_FULL_OCCLUSION, "full_occlusion", RT_FLAG("on"),                                                 \
      "end a list at the depth where objects probably cover the whole cell",                                 \
      "Haines & Greenberg 1986, of one object")                                                              \
    X(PARAM_EXTENTS, "extents", RT_FLAG("on"),                                                               \
      "skip objects that are not seen in the ray's sixteenth of the cell", "this program")                   \
    X(PARAM_LONGEST, "longest", RT_INT("64", 1, 65534, "2"),                                                 \
      "maximum number of entries in a list; rays that need deeper ones are passed on", "measured")

enum { PARAMS(RT_PARAM_INDEX) };
static const RtParam params[] = {PARAMS(RT_PARAM_ENTRY)};

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    const RtValue *values = what->values;
    RtLightBuffer *buffer = (RtLightBuffer *)accel;
    buffer->cells = (uint32_t)values[PARAM_CELLS].i;
    buffer->longest = (uint32_t)values[PARAM_LONGEST].i;
    buffer->full_occlusion = values[PARAM_FULL_OCCLUSION].flag;
    buffer->extents = values[PARAM_EXTENTS].flag;
    RtIsa isa = rt_isa_best();
    rt_isa_use(accel, RT_KERNELS_FOR(light, isa));
    buffer->raster = RT_KERNELS_FOR(light_raster, isa);
    RtLightProbes *probes = NULL;
    RtStatus status = fill(buffer, what, &probes, error);
    rt_free(probes);
    return status;
}

const RtAccelOps rt_light_ops = {
    .name = "light",
    .summary = "overlay: a cube of cells around each light, with the objects seen in each cell by depth",
    .paper = "Haines & Greenberg 1986, The Light Buffer: A Shadow-Testing Accelerator, CG&A 6(9)",
    RT_PARAMS_OF(params),
    .kinds = 1u << RT_RAY_SHADOW,
    .trial = "light:cells=100", /* a scene of few objects has no cells but those asked for */
    .bytes = sizeof(RtLightBuffer),
    .build = build,
    .destroy = destroy,
    RT_ISA_OPS,
    .describe = rt_light_describe,
    .validate = rt_light_validate,
    .find_cell = rt_light_find_cell,
};
