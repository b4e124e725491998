/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/cells.h"

#include "core/base/memory.h"
#include "core/base/words.h"
#include "picture/draw.h"

#include <stdio.h>

enum { MARGIN = 6, LINE = 11, LEAST_WIDTH = 330 }; /* of the legend: dots, dots, pixels */

static const RtColor magenta = {{255, 0, 200}}, nowhere = {{60, 60, 60}}, red = {{230, 40, 40}};

static void put_line(RtImage *image, int top, int line, RtColor color, const char *text) {
    int dot = rt_text_dot(image->width), y = top + (MARGIN + line * LINE) * dot;
    rt_draw_rectangle(image, MARGIN * dot, y, RT_TEXT_HEIGHT * dot, RT_TEXT_HEIGHT * dot, color);
    rt_draw_text(image, (MARGIN + RT_TEXT_HEIGHT + 4) * dot, y, dot, text, RT_WHITE);
}

/* ---- samples of the image ---- */

static RtColor color_of_sample(const RtCellView *cell, uint32_t x, uint32_t y) {
    if (cell->object == RT_UNNAMED_OBJECT) return (x + y) % 4 ? magenta : RT_WHITE;
    return cell->object == RT_NO_OBJECT ? RT_BLACK : rt_color_of_number(cell->object);
}

static RtStatus image_of_samples(RtImage *image, const RtAccel *layer, RtError *error) {
    const RtSampling *s = &layer->scene->sampling;
    uint64_t named = 0, undecided = 0, samples = (uint64_t)s->columns * s->rows;
    uint32_t width = s->width > LEAST_WIDTH ? s->width : LEAST_WIDTH;
    RtCellView cell;
    RT_TRY(rt_image_init(image, width, s->height + (uint32_t)((2 * MARGIN + 4 * LINE) * rt_text_dot(width)),
                         error));
    for (uint32_t i = 0; i < samples; i++) {
        layer->ops->look_up(layer, &(RtRay){.source = i}, &cell);
        named += cell.object < RT_UNNAMED_OBJECT;
        undecided += cell.object == RT_UNNAMED_OBJECT;
    }
    for (uint32_t y = 0; y < s->height; y++) {
        for (uint32_t x = 0; x < s->width; x++) {
            RtFootprint f = rt_pixel_footprint(s, x, y);
            uint32_t sample = (f.row + f.span / 2) * s->columns + f.column + f.span / 2;
            layer->ops->look_up(layer, &(RtRay){.source = sample}, &cell);
            rt_draw_rectangle(image, (int)x, (int)y, 1, 1, color_of_sample(&cell, x, y));
        }
    }
    const struct {
        uint64_t count;
        RtColor color;
        const char *what;
    } lines[] = {{named, rt_color_of_number(1), "name an object: a colour each"},
                 {undecided, magenta, "are undecided: passed on"},
                 {samples - named - undecided, nowhere, "see nothing: black"}};
    char text[128];
    snprintf(text, sizeof text, "%s  %llu sample%s, of which", layer->ops->name, (unsigned long long)samples,
             rt_plural(samples));
    rt_draw_text(image, MARGIN * rt_text_dot(width), (int)s->height + MARGIN * rt_text_dot(width),
                 rt_text_dot(width), text, RT_WHITE);
    for (int i = 0; i < 3; i++) {
        snprintf(text, sizeof text, "%llu %s", (unsigned long long)lines[i].count, lines[i].what);
        put_line(image, (int)s->height, i + 1, lines[i].color, text);
    }
    return RT_OK;
}

/* ---- the cells around a light ---- */

/* A face of the cross: its place in a net of 4 x 3, and the directions of its middle, its right and its top,
 * as axes, up being axis 1: 1 + axis, negative for the other way. */
typedef struct Face {
    int column, row, middle, right, top;
} Face;

static const Face faces[6] = {{0, 1, -1, 3, 2},  {1, 1, 3, 1, 2},  {2, 1, 1, -3, 2},
                              {3, 1, -3, -1, 2}, {1, 0, 2, 1, -3}, {1, 2, -2, 1, 3}};

/* Numbers of cells that are none. */
#define NO_CELL UINT32_MAX

typedef struct Cube {
    const RtAccel *layer;
    uint32_t light, side; /* pixels along the edge of a face */
    int up;               /* the axis of the scene that is axis 1 */
    RtCellView *cells;    /* [4 side][3 side], number NO_CELL where there is none */
} Cube;

/* Axis `signed_axis` of a face as one of the scene. */
static int axis_of(const Cube *cube, int signed_axis) {
    int axis = (signed_axis < 0 ? -signed_axis : signed_axis) - 1;
    return (axis + cube->up + 2) % 3;
}

static void add_axis(const Cube *cube, int signed_axis, float amount, RtVec3 *direction) {
    direction->at[axis_of(cube, signed_axis)] += signed_axis < 0 ? -amount : amount;
}

/* From the light through the middle of a pixel of the face. */
static RtVec3 direction_of(const Cube *cube, const Face *face, uint32_t x, uint32_t y) {
    RtVec3 direction = {{0, 0, 0}};
    add_axis(cube, face->middle, 1, &direction);
    add_axis(cube, face->right, 2 * ((float)x + 0.5f) / (float)cube->side - 1, &direction);
    add_axis(cube, face->top, 1 - 2 * ((float)y + 0.5f) / (float)cube->side, &direction);
    return direction;
}

/* Rays go to the light. */
static void look_all_around(Cube *cube, uint32_t *longest) {
    *longest = 0;
    for (uint32_t i = 0; i < 12 * cube->side * cube->side; i++) cube->cells[i].number = NO_CELL;
    for (int f = 0; f < 6; f++) {
        for (uint32_t i = 0; i < cube->side * cube->side; i++) {
            uint32_t x = i % cube->side, y = i / cube->side;
            RtRay ray = {.dir = rt_scale(direction_of(cube, &faces[f], x, y), -1),
                         .kind = RT_RAY_SHADOW,
                         .source = cube->light};
            RtCellView *cell = &cube->cells[((uint32_t)faces[f].row * cube->side + y) * 4 * cube->side +
                                            (uint32_t)faces[f].column * cube->side + x];
            if (!cube->layer->ops->look_up(cube->layer, &ray, cell)) cell->number = NO_CELL;
            if (cell->number != NO_CELL && cell->length > *longest) *longest = cell->length;
        }
    }
}

static void draw_faces(RtImage *image, const Cube *cube, const RtScale *scale) {
    int side = (int)cube->side, dot = rt_text_dot(image->width);
    for (int f = 0; f < 6; f++) {
        int left = faces[f].column * side, top = faces[f].row * side;
        for (int y = top; y < top + side; y++) {
            for (int x = left; x < left + side; x++) {
                const RtCellView *cell = &cube->cells[y * 4 * side + x];
                RtColor color = cell->number == NO_CELL
                                    ? nowhere
                                    : rt_color_scale(rt_scale_position(scale, cell->length));
                if (cell->number != NO_CELL && cell->cut && x % 2 == 0 && y % 2 == 0) color = red;
                bool border = x == left || y == top || x == left + side - 1 || y == top + side - 1;
                rt_draw_rectangle(image, x, y, 1, 1, border ? RT_GREY : color);
            }
        }
        char name[3] = {faces[f].middle < 0 ? '-' : '+', "xyz"[axis_of(cube, faces[f].middle)], 0};
        rt_draw_rectangle(image, left + 2, top + 2, (rt_text_width(name) + 4) * dot,
                          (RT_TEXT_HEIGHT + 4) * dot, RT_BLACK);
        rt_draw_text(image, left + 2 + 2 * dot, top + 2 + 2 * dot, dot, name, RT_WHITE);
    }
}

/* Outlines a cell, and puts a ring around it. */
static void draw_mark(RtImage *image, const Cube *cube, uint32_t number) {
    int width = 4 * (int)cube->side, height = 3 * (int)cube->side, count = 0;
    double x_sum = 0, y_sum = 0;
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            if (cube->cells[y * width + x].number != number) continue;
            x_sum += x, y_sum += y, count++;
            bool inner = x > 0 && x + 1 < width && cube->cells[y * width + x - 1].number == number &&
                         cube->cells[y * width + x + 1].number == number && y > 0 && y + 1 < height &&
                         cube->cells[(y - 1) * width + x].number == number &&
                         cube->cells[(y + 1) * width + x].number == number;
            if (!inner) rt_draw_rectangle(image, x, y, 1, 1, RT_WHITE);
        }
    }
    if (count == 0) return;
    int radius = (int)sqrt(count) + 12;
    for (int y = -radius; y <= radius; y++) {
        for (int x = -radius; x <= radius; x++) {
            int off = x * x + y * y;
            if (off > radius * radius || off < (radius - 3) * (radius - 3)) continue;
            bool rim = off >= (radius - 2) * (radius - 2);
            rt_draw_rectangle(image, (int)(x_sum / count) + x, (int)(y_sum / count) + y, 1, 1,
                              rim ? RT_WHITE : RT_BLACK);
        }
    }
}

static void draw_cube_legend(RtImage *image, const Cube *cube, const RtScale *scale, const RtRay *marked) {
    int dot = rt_text_dot(image->width), top = 3 * (int)cube->side, left = MARGIN * dot;
    char text[160];
    RtCellView cell;
    snprintf(text, sizeof text, "%s  light %u: objects in the list of a cell, up to %g",
             cube->layer->ops->name, cube->light, scale->most);
    rt_draw_text(image, left, top + MARGIN * dot, dot, text, RT_WHITE);
    rt_draw_scale(image, left, top + (MARGIN + LINE) * dot, (int)image->width - 2 * left, dot, scale);
    put_line(image, top, 3, nowhere, "grey: nothing is seen there");
    put_line(image, top, 4, red, "red dots: the list was cut, rays may be passed on");
    if (!marked) return;
    if (cube->layer->ops->look_up(cube->layer, marked, &cell)) {
        snprintf(text, sizeof text, "ringed: the ray reads cell %u, with %u object%s%s", cell.number,
                 cell.length, rt_plural(cell.length), cell.cut ? ", cut" : "");
        draw_mark(image, cube, cell.number);
    } else {
        snprintf(text, sizeof text, "the ray reads no cell: it is lit");
    }
    put_line(image, top, 5, RT_WHITE, text);
}

static RtStatus image_of_cube(RtImage *image, const RtAccel *layer, uint32_t light, const RtRay *marked,
                              RtError *error) {
    enum { SIDE = 240 };
    const RtScene *scene = layer->scene;
    uint32_t longest;
    if (light >= scene->light_count)
        return rt_fail(error, RT_BAD_INPUT, "there is no light %u: the scene has %u, the first being 0",
                       light, scene->light_count);
    Cube cube = {.layer = layer, .light = light, .side = SIDE, .up = rt_major_axis(scene->camera.up)};
    cube.cells = rt_alloc((size_t)12 * SIDE * SIDE, sizeof(RtCellView));
    if (!cube.cells)
        return rt_fail_memory(error, "a picture of cells", (size_t)12 * SIDE * SIDE * sizeof(RtCellView));
    look_all_around(&cube, &longest);
    uint32_t seen = 0;
    for (uint32_t i = 0; i < 12 * SIDE * SIDE; i++) seen += cube.cells[i].number != NO_CELL;
    RtStatus status =
        seen > 0 ? rt_image_init(image, 4 * SIDE,
                                 3 * SIDE + (2 * MARGIN + 6 * LINE) * (uint32_t)rt_text_dot(4 * SIDE), error)
                 : rt_fail(error, RT_NOT_AVAILABLE,
                           "%s has no cells around light %u, and passes its rays on: ask for some, as in "
                           "light:cells=64",
                           layer->ops->name, light);
    if (status == RT_OK) {
        RtScale scale = {.most = longest, .logarithmic = true};
        draw_faces(image, &cube, &scale);
        draw_cube_legend(image, &cube, &scale, marked);
    }
    rt_free(cube.cells);
    return status;
}

RtStatus rt_cells_image(RtImage *image, const RtAccel *layer, uint32_t light, const RtRay *marked,
                        RtError *error) {
    bool of_image = layer->ops->kinds >> RT_RAY_PRIMARY & 1;
    return of_image ? image_of_samples(image, layer, error)
                    : image_of_cube(image, layer, light, marked, error);
}
