/* SPDX-License-Identifier: Apache-2.0 */
/* Pictures of overlays that look rays up in cells. */
#include "core/base/memory.h"
#include "core/base/words.h"
#include "picture/canvas.h"
#include "picture/pictures.h"

#include <stdio.h>

enum { LEAST_WIDTH = 330 }; /* of a legend, pixels */

static const RtColor unseen = {{225, 225, 225}}, red = {{230, 40, 40}};

/* The baseline of a legend line below `top`, and the height of `lines` lines. */
static double baseline(double top, int line, double em) {
    return top + (1.5 + RT_LINE * line) * em;
}

static double legend_height(int lines, double em) {
    return ceil(baseline(0, lines - 1, em) + 0.7 * em);
}

/* ---- the item buffer ---- */

static RtColor color_of_sample(const void *context, uint32_t x, uint32_t y) {
    const RtAccel *layer = context;
    const RtSampling *s = &layer->scene->sampling;
    RtFootprint f = rt_pixel_footprint(s, x, y);
    uint32_t sample = (f.row + f.span / 2) * s->columns + f.column + f.span / 2;
    RtCellView cell;
    layer->ops->find_cell(layer, &(RtRay){.source = sample}, &cell);
    return cell.object == RT_NO_OBJECT ? RT_WHITE : rt_color_of_id(cell.object);
}

static RtStatus draw_samples(cairo_t *cairo, const RtAccel *layer, double em, RtError *error) {
    const RtSampling *s = &layer->scene->sampling;
    uint64_t named = 0, samples = (uint64_t)s->columns * s->rows;
    RtCellView cell;
    for (uint32_t i = 0; i < samples; i++) {
        layer->ops->find_cell(layer, &(RtRay){.source = i}, &cell);
        named += cell.object != RT_NO_OBJECT;
    }
    RT_TRY(rt_paint_pixels(cairo, (RtPixels){s->width, s->height, color_of_sample, layer}, 0, 0, error));
    rt_draw_text(cairo, 0.5 * em, baseline(s->height, 0, em), RT_BLACK, "%s: %llu sample%s", layer->ops->name,
                 (unsigned long long)samples, rt_plural(samples));
    rt_draw_key(cairo, 0.5 * em, baseline(s->height, 1, em), rt_color_of_id(1),
                "%llu name an object (a colour each)", (unsigned long long)named);
    rt_draw_key(cairo, 0.5 * em, baseline(s->height, 2, em), RT_WHITE, "%llu see nothing",
                (unsigned long long)(samples - named));
    return RT_OK;
}

static RtStatus draw_item_buffer(const char *file, const RtAccel *layer, RtError *error) {
    const RtSampling *s = &layer->scene->sampling;
    uint32_t width = s->width > LEAST_WIDTH ? s->width : LEAST_WIDTH;
    double em = rt_font_size(width);
    RtCanvas canvas;
    RT_TRY(rt_canvas_open(&canvas, file, width, s->height + legend_height(3, em), em, error));
    return rt_canvas_close(&canvas, draw_samples(canvas.cairo, layer, em, error), error);
}

/* ---- the light buffer ---- */

/* A face of the unfolded cube map: its position among 4 x 3 squares, and the directions of its middle,
 * right and top as 1 + axis, negative for the opposite direction. Axis 1 is up. */
typedef struct Face {
    int column, row, middle, right, top;
} Face;

static const Face faces[6] = {{0, 1, -1, 3, 2},  {1, 1, 3, 1, 2},  {2, 1, 1, -3, 2},
                              {3, 1, -3, -1, 2}, {1, 0, 2, 1, -3}, {1, 2, -2, 1, 3}};

enum { SIDE = 240, WIDTH = 4 * SIDE, HEIGHT = 3 * SIDE }; /* pixels of a face and of the map */
enum { LEGEND_LINES = 6 };

#define NO_CELL UINT32_MAX

typedef struct CubeMap {
    cairo_t *cairo;
    const RtAccel *layer;
    uint32_t light;
    int up;            /* the scene's axis for axis 1 */
    RtCellView *cells; /* [HEIGHT][WIDTH], number NO_CELL if there is none */
    uint32_t marked;   /* the cell to be outlined, or NO_CELL */
    RtScale scale;     /* of lengths */
    double em;
} CubeMap;

static int axis_of(const CubeMap *map, int signed_axis) {
    int axis = (signed_axis < 0 ? -signed_axis : signed_axis) - 1;
    return (axis + map->up + 2) % 3;
}

static void add_axis(const CubeMap *map, int signed_axis, float amount, RtVec3 *direction) {
    direction->at[axis_of(map, signed_axis)] += signed_axis < 0 ? -amount : amount;
}

static RtVec3 direction_of(const CubeMap *map, const Face *face, int x, int y) {
    RtVec3 direction = {{0, 0, 0}};
    add_axis(map, face->middle, 1, &direction);
    add_axis(map, face->right, 2 * ((float)x + 0.5f) / SIDE - 1, &direction);
    add_axis(map, face->top, 1 - 2 * ((float)y + 0.5f) / SIDE, &direction);
    return direction;
}

/* Looks up all directions; returns whether any has a cell. */
static bool find_cells(CubeMap *map) {
    bool any = false;
    for (int i = 0; i < WIDTH * HEIGHT; i++) map->cells[i].number = NO_CELL;
    for (int i = 0; i < 6 * SIDE * SIDE; i++) {
        const Face *face = &faces[i / (SIDE * SIDE)];
        int x = i % SIDE, y = i / SIDE % SIDE;
        RtRay ray = {.dir = rt_scale(direction_of(map, face, x, y), -1), /* shadow rays point at the light */
                     .kind = RT_RAY_SHADOW,
                     .source = map->light};
        RtCellView *cell = &map->cells[(face->row * SIDE + y) * WIDTH + face->column * SIDE + x];
        if (!map->layer->ops->find_cell(map->layer, &ray, cell)) cell->number = NO_CELL;
        if (cell->number == NO_CELL) continue;
        map->scale.most = fmax(map->scale.most, cell->length);
        any = true;
    }
    return any;
}

static RtColor color_of_cell(const CubeMap *map, int x, int y) {
    const RtCellView *cell = &map->cells[y * WIDTH + x];
    int u = x % SIDE, v = y % SIDE;
    if (u == 0 || v == 0 || u == SIDE - 1 || v == SIDE - 1) return RT_GREY; /* of the face */
    if (cell->number == NO_CELL) return unseen;
    if (cell->cut && x % 6 < 3 && y % 6 < 3) return red;
    return rt_color_scale(rt_scale_position(&map->scale, cell->length));
}

static bool is_marked(const CubeMap *map, int x, int y) {
    return x >= 0 && y >= 0 && x < WIDTH && y < HEIGHT && map->cells[y * WIDTH + x].number == map->marked;
}

/* The faces, on white, and the outline of the marked cell. */
static RtColor color_at(const void *context, uint32_t column, uint32_t row) {
    const CubeMap *map = context;
    const int x = (int)column, y = (int)row;
    int face = 0;
    while (face < 6 && (faces[face].column != x / SIDE || faces[face].row != y / SIDE)) face++;
    if (face == 6) return RT_WHITE;
    bool inner = is_marked(map, x - 1, y) && is_marked(map, x + 1, y) && is_marked(map, x, y - 1) &&
                 is_marked(map, x, y + 1);
    bool outline = map->marked != NO_CELL && is_marked(map, x, y) && !inner;
    return outline ? RT_WHITE : color_of_cell(map, x, y);
}

static void draw_face_names(const CubeMap *map) {
    for (int f = 0; f < 6; f++) {
        char name[3] = {faces[f].middle < 0 ? '-' : '+', "xyz"[axis_of(map, faces[f].middle)], 0};
        double x = faces[f].column * SIDE + 2, y = faces[f].row * SIDE + 2, em = map->em;
        rt_fill_rectangle(map->cairo, x, y, ceil(rt_text_width(map->cairo, name) + 0.6 * em), ceil(1.3 * em),
                          RT_WHITE);
        rt_draw_text(map->cairo, x + 0.3 * em, y + em, RT_BLACK, "%s", name);
    }
}

static void draw_ring(const CubeMap *map) {
    int count = 0;
    int64_t x_sum = 0, y_sum = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        if (map->cells[i].number == map->marked) x_sum += i % WIDTH, y_sum += i / WIDTH, count++;
    }
    for (int pass = 0; count > 0 && pass < 2; pass++) {
        rt_set_color(map->cairo, pass ? RT_WHITE : RT_BLACK, 1);
        cairo_set_line_width(map->cairo, pass ? 2 : 4);
        rt_add_circle(map->cairo, (RtPoint){(double)x_sum / count, (double)y_sum / count}, sqrt(count) + 12);
        cairo_stroke(map->cairo);
    }
}

static void draw_legend(const CubeMap *map, const RtRay *marked, const RtCellView *cell) {
    double em = map->em, left = 0.5 * em;
    rt_draw_text(map->cairo, left, baseline(HEIGHT, 0, em), RT_BLACK,
                 "%s, light %u: objects in the list of a cell, up to %g", map->layer->ops->name, map->light,
                 map->scale.most);
    rt_draw_scale(map->cairo, left, floor(baseline(HEIGHT, 0, em) + 0.6 * em), WIDTH - 2 * left, &map->scale);
    rt_draw_key(map->cairo, left, baseline(HEIGHT, 3, em), unseen, "nothing is seen there");
    rt_draw_key(map->cairo, left, baseline(HEIGHT, 4, em), red,
                "red dots: the list was cut, rays may be passed on");
    if (!marked) return;
    const double y = baseline(HEIGHT, 5, em);
    if (cell->number == NO_CELL)
        rt_draw_key(map->cairo, left, y, RT_WHITE, "the ray reads no cell: it is lit");
    else
        rt_draw_key(map->cairo, left, y, RT_WHITE, "ringed: the ray reads cell %u, with %u object%s%s",
                    cell->number, cell->length, rt_plural(cell->length), cell->cut ? ", cut" : "");
}

static RtStatus draw_cube_map(CubeMap *map, const char *file, const RtRay *marked, RtError *error) {
    RtCanvas canvas;
    RtCellView cell = {.number = NO_CELL};
    if (!find_cells(map))
        return rt_fail(
            error, RT_NOT_AVAILABLE,
            "%s has no cells around light %u, and passes its rays on: choose a number, as in light:cells=64",
            map->layer->ops->name, map->light);
    if (marked && !map->layer->ops->find_cell(map->layer, marked, &cell)) cell.number = NO_CELL;
    RT_TRY(
        rt_canvas_open(&canvas, file, WIDTH, HEIGHT + legend_height(LEGEND_LINES, map->em), map->em, error));
    map->cairo = canvas.cairo;
    map->marked = cell.number;
    RtStatus status = rt_paint_pixels(map->cairo, (RtPixels){WIDTH, HEIGHT, color_at, map}, 0, 0, error);
    draw_face_names(map);
    if (cell.number != NO_CELL) draw_ring(map);
    cairo_set_line_width(map->cairo, 1);
    draw_legend(map, marked, &cell);
    return rt_canvas_close(&canvas, status, error);
}

static RtStatus draw_light_buffer(const char *file, const RtAccel *layer, uint32_t light, const RtRay *marked,
                                  RtError *error) {
    const RtScene *scene = layer->scene;
    if (light >= scene->light_count)
        return rt_fail(error, RT_BAD_INPUT, "there is no light %u: the scene has %u, numbered from 0", light,
                       scene->light_count);
    RT_ARENA(arena);
    CubeMap map = {.layer = layer,
                   .light = light,
                   .up = rt_major_axis(scene->camera.up),
                   .cells = rt_arena_alloc(&arena, (size_t)WIDTH * HEIGHT, sizeof(RtCellView)),
                   .scale = {.logarithmic = true},
                   .em = rt_font_size(WIDTH)};
    RT_TRY(rt_arena_check(&arena, "a picture of cells", error));
    return draw_cube_map(&map, file, marked, error);
}

RtStatus rt_buffer_draw(const char *file, const RtAccel *layer, uint32_t light, const RtRay *marked,
                        RtError *error) {
    bool primary = layer->ops->kinds >> RT_RAY_PRIMARY & 1;
    return primary ? draw_item_buffer(file, layer, error)
                   : draw_light_buffer(file, layer, light, marked, error);
}
