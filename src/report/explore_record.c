/* SPDX-License-Identifier: Apache-2.0 */
#include "report/explore_record.h"

#include "core/base/elementary.h"
#include "core/base/memory.h"
#include "report/page.h"

#include <string.h>
#include <xxhash.h>
#include <zlib.h>

/* ---- bytes ---- */

_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "numbers are written as they lie in memory");

void rt_bytes_clear(RtBytes *bytes) {
    rt_free(bytes->data);
    *bytes = (RtBytes){0};
}

/* Grows by doubling (rt_reserve). */
void rt_bytes_put(RtBytes *bytes, const void *data, size_t size) {
    if (size == 0) return; /* `data` may be NULL */
    if (bytes->status == RT_OK)
        bytes->status = rt_reserve(&bytes->data, &bytes->capacity, bytes->count + (uint64_t)size, 1, NULL);
    if (bytes->status != RT_OK) return;
    memcpy(bytes->data + bytes->count, data, size);
    bytes->count += (uint32_t)size;
}

static void put_float(RtBytes *bytes, float value) {
    rt_bytes_put(bytes, &value, sizeof value);
}

static void put_vector(RtBytes *bytes, RtVec3 v) {
    rt_bytes_put(bytes, v.at, 3 * sizeof(float));
}

/* lo, then hi: six floats. */
static void put_box(RtBytes *bytes, const RtBox *box) {
    put_vector(bytes, box->lo);
    put_vector(bytes, box->hi);
}

void rt_bytes_put_number(RtBytes *bytes, uint64_t value) {
    uint8_t out[10];
    size_t size = 0;
    for (; value >= 128; value >>= 7) out[size++] = (uint8_t)(value | 128);
    out[size++] = (uint8_t)value;
    rt_bytes_put(bytes, out, size);
}

/* Appends four bytes, to be filled in by end_length with the number of bytes that follow them. Returns their
 * place. */
static uint32_t begin_length(RtBytes *bytes) {
    uint32_t place = bytes->count, length = 0;
    rt_bytes_put(bytes, &length, sizeof length);
    return place;
}

static void end_length(RtBytes *bytes, uint32_t place) {
    const uint32_t length = bytes->count - place - (uint32_t)sizeof(uint32_t);
    if (bytes->status == RT_OK) memcpy(bytes->data + place, &length, sizeof length);
}

RtStatus rt_bytes_compress(RtBytes *bytes, RtError *error) {
    uLongf size = compressBound(bytes->count);
    uint8_t *data = bytes->status == RT_OK ? rt_alloc_unset(size, 1) : NULL;
    if (!data || compress(data, &size, bytes->data, bytes->count) != Z_OK || size > UINT32_MAX) {
        rt_free(data);
        return rt_fail_memory(error, "the data of a page", size);
    }
    rt_bytes_clear(bytes);
    *bytes = (RtBytes){.data = data, .count = (uint32_t)size, .capacity = (uint32_t)size};
    return RT_OK;
}

void rt_bytes_embed(const RtBytes *bytes, const char *name, FILE *out) {
    fprintf(out, "<script type=\"text/plain\" id=\"part-%s\">", name);
    rt_page_data_url(out, "application/zlib", bytes->data, bytes->count);
    fputs("</script>\n", out);
}

/* ---- objects ---- */

enum { CORNERS = 16 }; /* of a cone's circles */

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
    put_vector(out, a);
    put_vector(out, b);
    put_vector(out, c);
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

static void put_drawn(Shapes *shapes, uint32_t object) {
    const RtGeometry *g = &shapes->scene->geometry;
    uint32_t i = rt_ref_index(g->objects[object]);
    switch (rt_ref_shape(g->objects[object])) {
    case RT_SHAPE_SPHERE:
        put_vector(&shapes->parts[SPHERES], g->spheres[i].center);
        put_float(&shapes->parts[SPHERES], g->spheres[i].radius);
        end_part(shapes, SPHERES, object);
        break;
    case RT_SHAPE_POLYGON:
        put_polygon(shapes, object, rt_polygon_vertices(g, i), g->polygons[i].count);
        break;
    case RT_SHAPE_TRIANGLE: put_polygon(shapes, object, g->triangles[i].v, 3); break;
    case RT_SHAPE_CONE: put_cone(shapes, object, &g->cones[i]); break;
    case RT_SHAPE_INSTANCE: /* what is drawn has none */
    case RT_SHAPE_CSG:
        put_box(&shapes->parts[BOXES], &g->boxes[object]);
        end_part(shapes, BOXES, object);
        break;
    case RT_SHAPE_COUNT: break;
    }
}

uint32_t rt_explore_objects(const RtScene *scene, RtBytes *out) {
    uint32_t count = scene->geometry.object_count;
    Shapes shapes = {.scene = scene, .every = 1 + (count > 0 ? (count - 1) / RT_MAX_SHOWN_OBJECTS : 0)};
    for (uint32_t i = 0; i < count; i += shapes.every) put_drawn(&shapes, i);
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

static void put_shown_box(void *context, const RtBoxView *view) {
    Levels *levels = context;
    RtShownBoxes *result = levels->result;
    uint32_t level = level_of(view), number = levels->seen[level]++;
    bool left_out = level > result->level || (level == result->level && number % result->every != 0);
    if (left_out || rt_box_is_empty(*view->box)) return;
    put_box(levels->out, view->box);
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
    accel->ops->each_box(accel, (RtBoxViewer){put_shown_box, &levels});
    return result;
}

/* ---- cells ---- */

/* The topmost layer of `accel` that looks rays of a kind up in cells, or NULL. */
static const RtAccel *cell_layer(const RtAccel *accel, uint32_t kind) {
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
    const RtAccel *layer = cell_layer(accel, RT_RAY_SHADOW);
    for (uint32_t light = 0; layer && light < accel->scene->light_count; light++) {
        for (int side = 0; side < 6; side++) put_side(layer, light, side, out);
    }
}

/* ---- events ---- */

enum { MOST_CANDIDATES = 16, RAW_PER_BYTE = 3 }; /* base64 of compressed data is a third of it, or less */

static bool same_form(const RtPathRow *a, const RtPathRow *b) {
    return a->kind == b->kind && strcmp(a->what, b->what) == 0 && a->leaf == b->leaf &&
           a->empty == b->empty && a->met == b->met && a->round == b->round && a->level == b->level;
}

static RtStatus find_form(RtRecordedPaths *to, const RtPathRow *row, uint32_t *form, RtError *error) {
    for (*form = 0; *form < to->form_count; ++*form) {
        if (same_form(&to->forms[*form], row)) return RT_OK;
    }
    return rt_append(&to->forms, &to->form_count, &to->form_capacity, row, sizeof *row, error);
}

/* The slot of the event, or the free one where it belongs. */
static uint32_t *find_slot(const RtRecordedPaths *to, const RtEvent *event) {
    uint32_t mask = to->slot_count - 1, at = (uint32_t)XXH3_64bits(event, sizeof *event) & mask;
    while (to->slots[at] && memcmp(&to->events[to->slots[at] - 1], event, sizeof *event) != 0)
        at = (at + 1) & mask;
    return &to->slots[at];
}

/* The table stays at most half full. */
static RtStatus grow_slots(RtRecordedPaths *to, RtError *error) {
    if (to->slot_count > 2 * to->event_count) return RT_OK;
    uint32_t count = to->slot_count ? 2 * to->slot_count : 1024;
    uint32_t *slots = rt_alloc(count, sizeof *slots);
    if (!slots) return rt_fail_memory(error, "the events of paths", count * sizeof *slots);
    rt_free(to->slots);
    to->slots = slots;
    to->slot_count = count;
    for (uint32_t i = 0; i < to->event_count; i++) *find_slot(to, &to->events[i]) = i + 1;
    return RT_OK;
}

static RtStatus find_event(RtRecordedPaths *to, const RtPath *path, const RtPathRow *row, uint32_t *index,
                           RtError *error) {
    const RtPathPlace *place = &path->places[row->place];
    RtEvent event;
    memset(&event, 0, sizeof event);
    RT_TRY(find_form(to, row, &event.form, error));
    event.index = rt_path_row_index(path, row);
    event.boxed = row->boxed;
    if (row->boxed) event.box = row->level ? rt_moved_box(&row->box, &place->to_world) : row->box;
    RT_TRY(grow_slots(to, error));
    uint32_t *slot = find_slot(to, &event);
    if (*slot == 0) {
        RT_TRY(rt_append(&to->events, &to->event_count, &to->event_capacity, &event, sizeof event, error));
        *slot = to->event_count;
    }
    *index = *slot - 1;
    return RT_OK;
}

static bool is_hit(const RtPathRow *row) {
    return row->kind == RT_TRACED_OBJECT_TEST && row->met;
}

static json_t *counts_of(const RtPathRow *row) {
    RtTally tally = {0};
    rt_traced_count(&(RtTraced){.kind = row->kind, .leaf = row->leaf, .empty = row->empty}, &tally);
    tally.object_hits += is_hit(row) && !row->instance;
    json_t *names = json_array();
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
        if (rt_tally_get(&tally, i)) json_array_append_new(names, json_string(rt_tally_name(i)));
    }
    return names;
}

json_t *rt_recorded_forms(const RtRecordedPaths *paths) {
    json_t *forms = json_array();
    for (uint32_t i = 0; i < paths->form_count; i++) {
        const RtPathRow *row = &paths->forms[i];
        json_array_append_new(forms,
                              json_pack("{s:s, s:s, s:i, s:o, s:b, s:b, s:o}", "name", rt_path_row_name(row),
                                        "of", row->what, "level", (int)row->level, "met",
                                        rt_path_row_answers(row) ? json_boolean(row->met) : json_null(),
                                        "hit", is_hit(row), "round", row->round, "counts", counts_of(row)));
    }
    return forms;
}

void rt_recorded_events(const RtRecordedPaths *paths, RtBytes *out) {
    for (uint32_t i = 0; i < paths->event_count; i++) {
        const RtEvent *event = &paths->events[i];
        rt_bytes_put_number(out, event->form);
        rt_bytes_put_number(out, event->index);
        rt_bytes_put_number(out, event->boxed);
        if (event->boxed) put_box(out, &event->box);
    }
}

/* ---- paths ---- */

static void put_object(RtBytes *out, uint32_t object) {
    rt_bytes_put_number(out, object == RT_NO_OBJECT        ? 0
                             : object == RT_UNNAMED_OBJECT ? 1
                                                           : (uint64_t)object + 2);
}

static void put_cell(RtBytes *out, const RtAccel *accel, const RtRay *ray) {
    RtCellView cell;
    accel = cell_layer(accel, ray->kind);
    if (!accel || !accel->ops->find_cell(accel, ray, &cell)) {
        rt_bytes_put_number(out, 0);
        return;
    }
    rt_bytes_put_number(out, (uint64_t)cell.number + 1);
    rt_bytes_put_number(out, cell.length);
    put_object(out, cell.object);
    rt_bytes_put_number(out, cell.cut);
}

static RtStatus put_path(RtRecordedPixels *recording, RtRecordedPaths *to, const RtPath *path,
                         RtError *error) {
    uint32_t kept = path->count < RT_MAX_RECORDED_ROWS ? path->count : RT_MAX_RECORDED_ROWS;
    put_object(&to->paths, path->hit.object);
    put_float(&to->paths, path->hit.t);
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++)
        rt_bytes_put_number(&to->paths, rt_tally_get(&path->tally, i));
    put_cell(&to->paths, to->accel, &path->ray);
    rt_bytes_put_number(&to->paths, path->count);
    rt_bytes_put_number(&to->paths, kept);
    recording->cut_count += kept < path->count;
    for (uint32_t i = 0; i < kept; i++) {
        uint32_t event;
        RT_TRY(find_event(to, path, &path->rows[i], &event, error));
        rt_bytes_put_number(&to->paths, event);
        if (is_hit(&path->rows[i])) put_float(&to->paths, path->rows[i].t);
    }
    return RT_OK;
}

/* ---- ray trees ---- */

/* Along the primary ray, behind one hit after the other, in the accelerator below all overlays. */
static RtStatus put_candidates(RtBytes *out, const RtAccel *base, RtRay ray, RtError *error) {
    RtHit hits[MOST_CANDIDATES], hit;
    RtQuery query;
    uint32_t count = 0;
    RT_TRY(rt_query_init(&query, base, error));
    while (count < MOST_CANDIDATES) {
        rt_nearest(&query, &ray, 1, &hit, NULL);
        if (hit.object == RT_NO_OBJECT) break;
        uint32_t known = 0;
        while (known < count && hits[known].object != hit.object) known++;
        if (known == count) hits[count++] = hit;
        ray.tmin = nextafterf(hit.t, INFINITY);
    }
    rt_query_clear(&query);
    rt_bytes_put_number(out, count);
    for (uint32_t i = 0; i < count; i++) {
        put_object(out, hits[i].object);
        put_float(out, hits[i].t);
    }
    return RT_OK;
}

static RtStatus put_ray(RtRecordedPixels *recording, const RtTreeRay *ray, RtError *error) {
    RtBytes *out = &recording->rays;
    const RtAccel *first = recording->of[0].accel;
    bool looked_up = false;
    for (uint32_t i = 0; i < recording->count; i++)
        looked_up |= cell_layer(recording->of[i].accel, RT_RAY_PRIMARY) != NULL;
    rt_bytes_put_number(out, ray->ray.kind);
    rt_bytes_put_number(out, ray->level);
    rt_bytes_put_number(out, ray->parent == RT_NO_RAY ? 0 : (uint64_t)ray->parent + 1);
    rt_bytes_put_number(out, ray->ray.source);
    rt_bytes_put_number(out, (uint64_t)ray->total + 2 * (uint64_t)ray->cut);
    put_vector(out, ray->ray.org);
    put_vector(out, ray->ray.dir);
    put_float(out, ray->ray.tmax);
    put_object(out, ray->hit.object);
    put_float(out, ray->hit.t);
    put_vector(out, ray->added);
    if (ray->ray.kind == RT_RAY_SHADOW) put_vector(out, rt_narrow(ray->terms[RT_TERM_DIFFUSE]));
    if (ray->ray.kind != RT_RAY_PRIMARY) return RT_OK;
    if (looked_up) return put_candidates(out, rt_accel_base(first), ray->ray, error);
    rt_bytes_put_number(out, 0);
    return RT_OK;
}

static uint32_t begin_pixel(RtBytes *bytes, uint32_t number) {
    rt_bytes_put_number(bytes, number);
    return begin_length(bytes);
}

static RtStatus record_tree(RtRecordedPixels *recording, uint32_t number, const RtRayTree *tree,
                            RtError *error) {
    uint32_t place = begin_pixel(&recording->rays, number), places[RT_MAX_EXPLORED] = {0};
    for (uint32_t i = 0; i < recording->count; i++) places[i] = begin_pixel(&recording->of[i].paths, number);
    for (uint32_t k = 0; k < tree->count; k++) {
        RT_TRY(put_ray(recording, &tree->rays[k], error));
        for (uint32_t i = 0; i < recording->count; i++) {
            RtPath path;
            RT_TRY(rt_path_trace(&path, recording->of[i].accel, &tree->rays[k].ray, error));
            RtStatus status = put_path(recording, &recording->of[i], &path, error);
            rt_path_clear(&path);
            RT_TRY(status);
        }
    }
    end_length(&recording->rays, place);
    for (uint32_t i = 0; i < recording->count; i++) end_length(&recording->of[i].paths, places[i]);
    recording->ray_count += tree->count;
    return RT_OK;
}

/* ---- all pixels ---- */

static uint64_t bytes_of(const RtRecordedPixels *recording) {
    uint64_t bytes = recording->rays.count;
    for (uint32_t i = 0; i < recording->count; i++)
        bytes += recording->of[i].paths.count + recording->of[i].event_count * (uint64_t)sizeof(RtEvent);
    return bytes;
}

/* Pixels in places stride / 2, stride / 2 + stride, ... below `side`. */
static uint32_t places_in(uint32_t side, uint32_t stride) {
    return side > stride / 2 ? (side - stride / 2 + stride - 1) / stride : 0;
}

/* The recorded pixels of a tile, and the number of each; returns how many. */
static uint32_t pixels_of_tile(const RtRecordedPixels *recording, RtSample tile, RtSample *pixels,
                               uint32_t *numbers) {
    const uint32_t stride = recording->stride, columns = recording->columns, rows = recording->rows;
    const uint32_t right = places_in(tile.column + RT_TILE, stride);
    const uint32_t below = places_in(tile.row + RT_TILE, stride);
    uint32_t count = 0;
    for (uint32_t row = places_in(tile.row, stride); row < below && row < rows; row++) {
        for (uint32_t column = places_in(tile.column, stride); column < right && column < columns; column++) {
            numbers[count] = row * columns + column;
            pixels[count++] = (RtSample){column * stride + stride / 2, row * stride + stride / 2};
        }
    }
    return count;
}

static RtStatus record_tile(RtRecordedPixels *recording, RtSample tile, uint32_t depth, RtError *error) {
    RtSample pixels[RT_TILE * RT_TILE];
    uint32_t numbers[RT_TILE * RT_TILE], count = pixels_of_tile(recording, tile, pixels, numbers);
    RtRayTree trees[RT_TILE * RT_TILE];
    if (count == 0) return RT_OK;
    RT_TRY(rt_ray_trees_trace(trees, recording->of[0].accel, pixels, count, depth, error));
    RtStatus status = RT_OK;
    for (uint32_t i = 0; i < count; i++) {
        if (status == RT_OK) status = record_tree(recording, numbers[i], &trees[i], error);
        rt_ray_tree_clear(&trees[i]);
    }
    return status;
}

static RtStatus record_given(RtRecordedPixels *recording, const RtExploreOptions *options, RtError *error) {
    RT_OWNED(RtRayTree, tree, rt_ray_tree_clear);
    if (!options->given) return RT_OK;
    RT_TRY(rt_ray_tree_trace_given(&tree, recording->of[0].accel, options->given, options->depth, error));
    return record_tree(recording, recording->rows * recording->columns, &tree, error);
}

static RtStatus record_pixels(RtRecordedPixels *recording, const RtExploreOptions *options, bool *fits,
                              RtError *error) {
    const RtSampling *s = &recording->of[0].accel->scene->sampling;
    RT_TRY(record_given(recording, options, error));
    for (uint32_t row = 0; row < s->height; row += RT_TILE) {
        for (uint32_t column = 0; column < s->width; column += RT_TILE) {
            RT_TRY(record_tile(recording, (RtSample){column, row}, options->depth, error));
            *fits = bytes_of(recording) <= (uint64_t)options->bytes * RAW_PER_BYTE;
            if (!*fits) return RT_OK;
        }
    }
    RT_TRY(rt_bytes_compress(&recording->rays, error));
    for (uint32_t i = 0; i < recording->count; i++) RT_TRY(rt_bytes_compress(&recording->of[i].paths, error));
    return RT_OK;
}

RtStatus rt_recorded_pixels_make(RtRecordedPixels *recording, RtAccel *const *accels, uint32_t count,
                                 const RtExploreOptions *options, RtError *error) {
    const RtSampling *s = &accels[0]->scene->sampling;
    RtStatus status = RT_OK;
    bool fits = false;
    for (uint32_t stride = 1; status == RT_OK && !fits; stride++) {
        *recording = (RtRecordedPixels){.stride = stride,
                                        .columns = places_in(s->width, stride),
                                        .rows = places_in(s->height, stride),
                                        .count = count};
        if (recording->columns == 0 || recording->rows == 0)
            return rt_fail(error, RT_BAD_INPUT,
                           "the paths of a single pixel do not fit on the page: leave out an accelerator");
        for (uint32_t i = 0; i < count; i++) recording->of[i].accel = accels[i];
        status = record_pixels(recording, options, &fits, error);
        if (status != RT_OK || !fits) rt_recorded_pixels_clear(recording);
    }
    return status;
}

void rt_recorded_pixels_clear(RtRecordedPixels *recording) {
    rt_bytes_clear(&recording->rays);
    for (uint32_t i = 0; i < recording->count; i++) {
        RtRecordedPaths *of = &recording->of[i];
        rt_bytes_clear(&of->paths);
        rt_free(of->forms);
        rt_free(of->events);
        rt_free(of->slots);
    }
    *recording = (RtRecordedPixels){0};
}
