/* SPDX-License-Identifier: Apache-2.0 */
/* Building a light buffer: margins, grids and how fine they are, near lists; then light by light what falls
 * into the tiles (bins.c) and their lists (tile.c). */
#include "accel/light/light.h"

#include "base/memory.h"

#include <stdlib.h>

const RtParam rt_light_params[RT_LIGHT_PARAM_COUNT] = {RT_LIGHT_PARAMS(RT_PARAM_ENTRY)};

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
    const RtScene *scene = buffer->base.scene;
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

/* ---- how fine ---- */

/* The part of a face that sees the scene, and what is known of the objects seen there. */
typedef struct Outlook {
    RtLightView view;
    double objects, sides, areas; /* sums of 1, width + height, and width * height, in u and w */
} Outlook;

enum { SAMPLE = 4096 };

/* From every kth object. */
static void look_at_objects(const RtLightBuffer *buffer, uint32_t light, Outlook outlooks[6]) {
    const RtGeometry *g = &buffer->base.scene->geometry;
    uint32_t stride = g->object_count / SAMPLE + 1;
    for (uint32_t id = 0; id < g->object_count; id += stride) {
        if (rt_light_is_near(buffer, light, id)) continue;
        for (int face = 0; face < 6; face++) {
            Outlook *o = &outlooks[face];
            RtLightView v;
            if (o->view.far <= 0 || !rt_light_view(buffer, light, face, &g->boxes[id], &v)) continue;
            double width = v.hi[0] - v.lo[0], height = v.hi[1] - v.lo[1];
            o->objects += stride;
            o->sides += stride * (width + height);
            o->areas += stride * width * height;
        }
    }
}

/* Cells per 1 of u and w. An object of width x and height y is in about
 *
 *     (x scale + 1) (y scale + 1)
 *
 * cells, of which x y scale^2 are the share of its area: what is above that, in relation to it, is what fine
 * cells bring down, and memory and time of the build what they cost. */
static double choose_scale(const Outlook *o, double margin) {
    const double surplus = 1.5, most_cells = 0x1p22, cells_an_object = 8;
    double width = o->view.hi[0] - o->view.lo[0], height = o->view.hi[1] - o->view.lo[1];
    double fine = 0x1p-6 / (0x1p-19 + 4 * margin / fmax(o->view.far, margin)); /* cells 64 times as wide as errors */
    double longer = fmax(width, height), scale = 64 / longer;
    if (o->areas > 0) {
        double a = surplus * o->areas;
        scale = (o->sides + sqrt(o->sides * o->sides + 4 * a * o->objects)) / (2 * a);
    }
    double most = fmin(most_cells, 4096 + cells_an_object * o->objects);
    scale = fmin(scale, sqrt(most / (width * height)));
    scale = fmin(scale, fine);
    scale = fmin(scale, 4095 / longer);
    return fmax(scale, 1 / longer);
}

static void make_grid(const RtLightBuffer *buffer, const Outlook *o, double cells, double margin,
                      RtLightGrid *grid) {
    *grid = (RtLightGrid){.columns = 0};
    if (o->view.far <= 0) return;
    double width = o->view.hi[0] - o->view.lo[0], height = o->view.hi[1] - o->view.lo[1];
    double scale = cells > 0 ? cells / fmax(width, height) : choose_scale(o, margin);
    (void)buffer;
    grid->u = rt_float_below(o->view.lo[0]);
    grid->w = rt_float_below(o->view.lo[1]);
    grid->scale = (float)scale;
    /* Never a cell too few: what rounding adds is less than half of one. */
    grid->columns = (uint32_t)fmax(ceil((o->view.hi[0] - (double)grid->u) * (double)grid->scale - 0x1p-8), 1);
    grid->rows = (uint32_t)fmax(ceil((o->view.hi[1] - (double)grid->w) * (double)grid->scale - 0x1p-8), 1);
    grid->across = (grid->columns + RT_LIGHT_TILE - 1) / RT_LIGHT_TILE;
    grid->depth = rt_float_below(o->view.near);
    grid->depth_scale = (float)((RT_LIGHT_DEPTHS - 1) / (o->view.far - (double)grid->depth));
}

static double tiles_of(const RtLightGrid *grid) {
    return (double)grid->across * ((grid->rows + RT_LIGHT_TILE - 1) / RT_LIGHT_TILE);
}

/* Sets the grids of a light for `cells` along the longer edge, 0 to choose; gives the number of tiles. */
static double make_grids(RtLightBuffer *buffer, uint32_t light, const Outlook outlooks[6], double cells) {
    RtLightCube *cube = &buffer->cubes[light];
    double tiles = 0;
    for (int face = 0; face < 6; face++) {
        RtLightGrid *grid = &cube->grids[face];
        make_grid(buffer, &outlooks[face], cells, cube->margin, grid);
        grid->first_tile = (uint32_t)tiles;
        tiles += grid->columns > 0 ? tiles_of(grid) : 0;
    }
    cube->tile_count = (uint32_t)tiles;
    return tiles;
}

/* ---- how many fit ---- */

/* A buffer must have room for so much: a list's place, and two entries. */
enum { LEAST_OF_CELL = sizeof(uint32_t) + 2 * sizeof(RtLightEntry) };

static double make_all_grids(RtLightBuffer *buffer, const Outlook *outlooks, double cells) {
    double tiles = 0;
    for (uint32_t i = 0; i < buffer->base.scene->light_count; i++)
        tiles += make_grids(buffer, i, outlooks + 6 * (size_t)i, cells);
    return tiles * RT_LIGHT_TILE_CELLS;
}

/* Grids of all lights; where they are to be chosen, as many cells as there is room for. */
static RtStatus fit_grids(RtLightBuffer *buffer, const Outlook *outlooks, double limit, double *cells,
                          RtError *error) {
    uint32_t lights = buffer->base.scene->light_count, fits = 0, too_many = 4097;
    *cells = make_all_grids(buffer, outlooks, buffer->cells);
    if (*cells * LEAST_OF_CELL <= limit) return RT_OK;
    if (buffer->cells > 0) too_many = buffer->cells;
    while (too_many - fits > 1) {
        uint32_t n = fits + (too_many - fits) / 2;
        *(make_all_grids(buffer, outlooks, n) * LEAST_OF_CELL <= limit ? &fits : &too_many) = n;
    }
    if (buffer->cells == 0 && fits > 0) {
        *cells = make_all_grids(buffer, outlooks, fits);
        return RT_OK;
    }
    return rt_fail(error, RT_BAD_INPUT,
                   "a light buffer of %u cells along the edge of a face for %u lights would take more than %.3g "
                   "GiB: cells=%u would fit",
                   buffer->cells, lights, limit / 0x1p30, fits);
}

static RtStatus choose_grids(RtLightBuffer *buffer, double limit, double *cells, RtError *error) {
    const RtScene *scene = buffer->base.scene;
    Outlook *outlooks = rt_alloc(6 * (size_t)scene->light_count, sizeof(Outlook));
    if (!outlooks) return rt_fail_memory(error, "a light buffer", 6 * scene->light_count * sizeof(Outlook));
    for (uint32_t i = 0; scene->geometry.object_count > 0 && i < scene->light_count; i++) {
        for (int face = 0; face < 6; face++) {
            RtLightView *view = &outlooks[6 * i + (uint32_t)face].view;
            if (!rt_light_view(buffer, i, face, &scene->geometry.box, view)) view->far = 0;
        }
        look_at_objects(buffer, i, outlooks + 6 * (size_t)i);
    }
    RtStatus status = fit_grids(buffer, outlooks, limit, cells, error);
    rt_free(outlooks);
    return status;
}

/* ---- near lists ---- */

static RtStatus make_near_list(RtLightBuffer *buffer, uint32_t light, RtError *error) {
    const RtGeometry *g = &buffer->base.scene->geometry;
    RtLightCube *cube = &buffer->cubes[light];
    uint32_t capacity = 0;
    for (uint32_t id = 0; id < g->object_count; id++) {
        if (!rt_light_is_near(buffer, light, id)) continue;
        RT_TRY(rt_reserve(&cube->near, &capacity, cube->near_count + UINT64_C(1), sizeof(uint32_t), error));
        cube->near[cube->near_count++] = id;
    }
    return RT_OK;
}

/* ---- build and destroy ---- */

static RtStatus make_light(RtLightBuffer *buffer, uint32_t light, uint32_t most_of_tile, int threads,
                           RtError *error) {
    RtLightBins bins = {NULL, NULL};
    RtStatus status = make_near_list(buffer, light, error);
    if (status == RT_OK) status = rt_light_fill_bins(buffer, light, threads, &bins, error);
    if (status == RT_OK) status = rt_light_make_lists(buffer, light, &bins, most_of_tile, threads, error);
    rt_free(bins.first);
    rt_free(bins.objects);
    buffer->cubes[light].serves = status == RT_OK;
    return status;
}

static RtStatus make_lights(RtLightBuffer *buffer, const RtBuild *what, RtError *error) {
    double cells = 0, limit = (double)what->limit;
    RT_TRY(choose_grids(buffer, limit, &cells, error));
    double most = (limit - cells * (double)sizeof(uint32_t)) / sizeof(RtLightEntry);
    most = fmin(most, 0x1p30) * RT_LIGHT_TILE_CELLS / fmax(cells, 1);
    uint32_t most_of_tile = (uint32_t)fmin(most, 0x1p30);
    for (uint32_t i = 0; i < buffer->base.scene->light_count; i++)
        RT_TRY(make_light(buffer, i, most_of_tile, what->threads, error));
    return RT_OK;
}

void rt_light_destroy(RtAccel *accel) {
    RtLightBuffer *buffer = (RtLightBuffer *)accel;
    for (uint32_t i = 0; buffer->cubes && i < accel->scene->light_count; i++) {
        rt_free(buffer->cubes[i].first);
        rt_free(buffer->cubes[i].entries);
        rt_free(buffer->cubes[i].near);
    }
    rt_free(buffer->cubes);
    rt_free(buffer);
}

RtStatus rt_light_build(const RtBuild *what, RtAccel **out, RtError *error) {
    const RtValue *values = what->values;
    RtAccel *accel;
    RT_TRY(rt_accel_new(what, sizeof(RtLightBuffer), &accel, error));
    RtLightBuffer *buffer = (RtLightBuffer *)accel;
    buffer->cells = (uint32_t)values[RT_LIGHT_CELLS].i;
    buffer->longest = (uint32_t)values[RT_LIGHT_LONGEST].i;
    buffer->full_occlusion = values[RT_LIGHT_FULL_OCCLUSION].flag;
    buffer->extents = values[RT_LIGHT_EXTENTS].flag;
    buffer->kernels = rt_light_kernels(rt_isa_best());
    RtStatus status = make_cubes(buffer, error);
    if (status == RT_OK) status = make_lights(buffer, what, error);
    return rt_accel_built(accel, status, out);
}
