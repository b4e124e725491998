/* SPDX-License-Identifier: Apache-2.0 */
#include "report/explore_shapes.h"

#include "core/base/elementary.h"

enum { CORNERS = 16 }; /* of a cone's circles */

/* ---- objects ---- */

typedef struct Shapes {
    const RtScene *scene;
    uint32_t every; /* kth object */
    uint32_t counts[3];
    RtBytes parts[3]; /* spheres, triangles, boxes */
} Shapes;

enum { SPHERES, TRIANGLES, BOXES };

static void end_part(Shapes *shapes, int part, uint32_t object) {
    rt_bytes_put_number(&shapes->parts[part], shapes->scene->material_of[object]);
    shapes->counts[part]++;
}

static void put_triangle(Shapes *shapes, uint32_t object, RtVec3 a, RtVec3 b, RtVec3 c) {
    RtBytes *out = &shapes->parts[TRIANGLES];
    rt_bytes_put_vector(out, a);
    rt_bytes_put_vector(out, b);
    rt_bytes_put_vector(out, c);
    end_part(shapes, TRIANGLES, object);
}

/* A fan, which is exact for convex ones. */
static void put_polygon(Shapes *shapes, uint32_t object, const RtVec3 *vertices, uint32_t count) {
    for (uint32_t i = 2; i < count; i++)
        put_triangle(shapes, object, vertices[0], vertices[i - 1], vertices[i]);
}

/* The point of a circle around the axis, in direction cosine * u + sine * v. */
static RtVec3 on_circle(RtVec3 center, float radius, RtVec3d u, RtVec3d v, uint32_t corner) {
    const RtTurn turn = rt_turn(360.0 * corner / CORNERS);
    RtVec3d out = rt_add_scaledd(rt_scaled(u, turn.cosine), v, turn.sine);
    return rt_narrow(rt_add_scaledd(rt_widen(center), out, (double)radius));
}

static void put_cone(Shapes *shapes, uint32_t object, const RtCone *cone) {
    RtVec3d frame[3];
    RtVec3d aside = {{0, 0, 0}};
    int least = 0;
    for (int a = 1; a < 3; a++) {
        if (fabs(cone->axis.at[a]) < fabs(cone->axis.at[least])) least = a;
    }
    aside.at[least] = 1;
    frame[0] = rt_normalized(rt_crossd(cone->axis, aside));
    frame[1] = rt_crossd(cone->axis, frame[0]);
    for (uint32_t i = 0; i < CORNERS; i++) {
        RtVec3 a = on_circle(cone->base, cone->base_radius, frame[0], frame[1], i);
        RtVec3 b = on_circle(cone->base, cone->base_radius, frame[0], frame[1], i + 1);
        RtVec3 c = on_circle(cone->apex, cone->apex_radius, frame[0], frame[1], i);
        RtVec3 d = on_circle(cone->apex, cone->apex_radius, frame[0], frame[1], i + 1);
        put_triangle(shapes, object, a, b, d);
        put_triangle(shapes, object, a, d, c);
    }
}

static void put_object(Shapes *shapes, uint32_t object) {
    const RtGeometry *g = &shapes->scene->geometry;
    uint32_t i = rt_ref_index(g->objects[object]);
    switch (rt_ref_shape(g->objects[object])) {
    case RT_SHAPE_SPHERE:
        rt_bytes_put_vector(&shapes->parts[SPHERES], g->spheres[i].center);
        rt_bytes_put_float(&shapes->parts[SPHERES], g->spheres[i].radius);
        end_part(shapes, SPHERES, object);
        break;
    case RT_SHAPE_POLYGON:
        put_polygon(shapes, object, rt_polygon_vertices(g, i), g->polygons[i].count);
        break;
    case RT_SHAPE_TRIANGLE: put_polygon(shapes, object, g->triangles[i].v, 3); break;
    case RT_SHAPE_CONE: put_cone(shapes, object, &g->cones[i]); break;
    case RT_SHAPE_CSG:
        rt_bytes_put_box(&shapes->parts[BOXES], &g->boxes[object]);
        end_part(shapes, BOXES, object);
        break;
    case RT_SHAPE_COUNT: break;
    }
}

uint32_t rt_explore_objects(const RtScene *scene, RtBytes *out) {
    uint32_t count = scene->geometry.object_count;
    Shapes shapes = {.scene = scene, .every = 1 + (count > 0 ? (count - 1) / RT_MAX_SHOWN_OBJECTS : 0)};
    for (uint32_t i = 0; i < count; i += shapes.every) put_object(&shapes, i);
    for (int part = 0; part < 3; part++) {
        const RtBytes *bytes = &shapes.parts[part];
        rt_bytes_put_number(out, shapes.counts[part]);
        rt_bytes_put(out, bytes->data, bytes->count);
        if (bytes->status != RT_OK) out->status = bytes->status;
        rt_bytes_clear(&shapes.parts[part]);
    }
    return shapes.every;
}

/* ---- boxes ---- */

enum { MOST_LEVELS = 256 };

typedef struct Levels {
    uint32_t count[MOST_LEVELS], seen[MOST_LEVELS]; /* boxes of a level; the last has all deeper ones, too */
    RtShownBoxes *result;
    RtBytes *out;
} Levels;

static uint32_t level_of(const RtBoxView *view) {
    return view->depth < MOST_LEVELS ? view->depth : MOST_LEVELS - 1;
}

static void count_box(void *context, const RtBoxView *view) {
    ((Levels *)context)->count[level_of(view)]++;
}

static void put_box(void *context, const RtBoxView *view) {
    Levels *levels = context;
    RtShownBoxes *result = levels->result;
    uint32_t level = level_of(view), number = levels->seen[level]++;
    bool left_out = level > result->level || (level == result->level && number % result->every != 0);
    if (left_out || rt_box_is_empty(*view->box)) return;
    rt_bytes_put_box(levels->out, view->box);
    rt_bytes_put_number(levels->out, view->depth);
    rt_bytes_put_number(levels->out, view->leaf ? 1 + (uint64_t)view->objects : 0);
    result->shown++;
}

RtShownBoxes rt_explore_boxes(const RtAccel *accel, RtBytes *out) {
    while (accel && !accel->ops->each_box) accel = accel->below;
    RtShownBoxes result = {.layer = accel, .level = UINT32_MAX, .every = 1};
    Levels levels = {.result = &result, .out = out};
    if (!accel) return result;
    accel->ops->each_box(accel, (RtBoxViewer){count_box, &levels});
    for (uint32_t i = 0; i < MOST_LEVELS; i++) {
        uint32_t room = RT_MAX_SHOWN_BOXES - (result.level == UINT32_MAX ? result.all : 0);
        result.all += levels.count[i];
        if (result.level != UINT32_MAX || levels.count[i] <= room) continue;
        result.level = i;
        result.every = room ? 1 + (levels.count[i] - 1) / room : UINT32_MAX;
    }
    accel->ops->each_box(accel, (RtBoxViewer){put_box, &levels});
    return result;
}

/* ---- cells ---- */

const RtAccel *rt_cell_layer(const RtAccel *accel, uint32_t kind) {
    while (accel && !(accel->ops->find_cell && accel->ops->kinds >> kind & 1)) accel = accel->below;
    return accel;
}

static void put_side(const RtAccel *layer, uint32_t light, int side, RtBytes *out) {
    const int axis = side / 2;
    for (int i = 0; i < RT_CELL_MAP * RT_CELL_MAP; i++) {
        const int column = i % RT_CELL_MAP, row = i / RT_CELL_MAP;
        RtRay ray = {.kind = RT_RAY_SHADOW, .source = light};
        RtCellView cell;
        ray.dir.at[axis] = side % 2 ? -1 : 1; /* shadow rays point at the light */
        ray.dir.at[(axis + 1) % 3] = 1 - 2 * ((float)column + 0.5f) / RT_CELL_MAP;
        ray.dir.at[(axis + 2) % 3] = 1 - 2 * ((float)row + 0.5f) / RT_CELL_MAP;
        const bool found = layer->ops->find_cell(layer, &ray, &cell);
        rt_bytes_put_number(out, found ? (uint64_t)cell.number + 1 : 0);
        rt_bytes_put_number(out, found ? cell.length : 0);
    }
}

void rt_explore_cells(const RtAccel *accel, RtBytes *out) {
    const RtAccel *layer = rt_cell_layer(accel, RT_RAY_SHADOW);
    for (uint32_t light = 0; layer && light < accel->scene->light_count; light++) {
        for (int side = 0; side < 6; side++) put_side(layer, light, side, out);
    }
}
