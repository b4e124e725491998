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
 * This file builds it: margins; whether it pays (light_choice.c); grids; then the lists (light_lists.c). */
#include "accel/light/light.h"

#include "core/base/memory.h"

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
    for (uint32_t light = 0; light < buffer->isa.base.scene->light_count; light++) {
        for (int face = 0; face < 6; face++) {
            const RtLightFace on = rt_light_face(buffer, light, face);
            RtLightGrid *grid = &buffer->cubes[light].grids[face];
            make_grid(&on, cells, grid);
            all += (double)grid->columns * grid->rows;
        }
    }
    return all;
}

/* ---- build and destroy ---- */

/* A buffer must have room for so much: a list's place, and two entries. */
enum { LEAST_OF_CELL = sizeof(uint32_t) + 2 * sizeof(RtLightEntry) };

/* Serves if all lists fit. */
static RtStatus fill(RtLightBuffer *buffer, uint64_t limit, int threads, RtError *error) {
    double cells = make_grids(buffer, buffer->cells);
    if (cells * LEAST_OF_CELL > (double)limit) return RT_OK;
    RT_TRY(rt_light_make_lists(buffer, limit - (uint64_t)cells * sizeof(uint32_t), threads, error));
    if (!buffer->serves) rt_light_drop_lists(buffer);
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
                   buffer->cells, buffer->isa.base.scene->light_count, (double)what->limit / 0x1p30, fits);
}

/* Chosen cells take no more than so many bytes for each object and light. Where counts are unknown, they
 * serve scenes of many objects. */
enum { BYTES_OF_OBJECT = 1024, MANY_OBJECTS = 12000 };

/* As many cells as the objects ask for, if they pay. */
static RtStatus fill_if_it_pays(RtLightBuffer *buffer, const RtBuild *what, RtLightProbes *probes,
                                RtError *error) {
    const RtScene *scene = what->scene;
    uint64_t limit = (uint64_t)BYTES_OF_OBJECT * scene->geometry.object_count * scene->light_count;
    bool pays = scene->geometry.object_count >= MANY_OBJECTS;
    if (probes) pays = rt_light_may_pay(probes);
    if (!pays) return RT_OK;
    RT_TRY(fill(buffer, limit < what->limit ? limit : what->limit, what->threads, error));
    if (!probes || !buffer->serves) return RT_OK;
    RT_TRY(rt_light_pays(buffer, probes, &pays, error));
    if (!pays) rt_light_drop_lists(buffer);
    return RT_OK;
}

static void destroy(RtAccel *accel) {
    rt_light_drop_lists((RtLightBuffer *)accel);
    rt_free(((RtLightBuffer *)accel)->cubes);
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
    RtLightProbes *probes = NULL;
    buffer->cells = (uint32_t)what->values[PARAM_CELLS].i;
    buffer->longest = (uint32_t)what->values[PARAM_LONGEST].i;
    buffer->full_occlusion = what->values[PARAM_FULL_OCCLUSION].flag;
    rt_isa_use(accel, RT_KERNELS_FOR(light, rt_isa_best()));
    RT_TRY(make_cubes(buffer, error));
    if (buffer->cells > 0) return fill_as_asked(buffer, what, error);
    RtStatus status = accel->below->counts ? rt_light_make_probes(buffer, &probes, error) : RT_OK;
    if (status == RT_OK) status = fill_if_it_pays(buffer, what, probes, error);
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
