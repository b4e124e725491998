/* SPDX-License-Identifier: Apache-2.0 */
#include "render/path.h"

#include "accel/plugin.h"
#include "render/illumination.h"

#include <stdio.h>

/* ---- recording ---- */

typedef struct Recorder {
    RtPath *path;
    uint32_t place; /* where the ray is: index in path->places */
    RtStatus status;
    RtError *error;
} Recorder;

/* The interval of the exact ray in the box, within tmin..tmax ... */
static void find_span(const RtRay *ray, RtPathRow *row) {
    row->enter = (double)ray->tmin, row->leave = (double)ray->tmax;
    for (int a = 0; a < 3; a++) {
        double org = (double)ray->org.at[a], dir = (double)ray->dir.at[a];
        double lo = (double)row->box.lo.at[a], hi = (double)row->box.hi.at[a];
        if (dir == 0) {
            if (org < lo || org > hi) row->leave = -(double)INFINITY;
            continue;
        }
        double first = (lo - org) / dir, second = (hi - org) / dir;
        row->enter = fmax(row->enter, fmin(first, second));
        row->leave = fmin(row->leave, fmax(first, second));
    }
}

/* ... or in the ball. */
static void find_span_of_ball(const RtRay *ray, RtPathRow *row) {
    RtVec3d dir = rt_widen(ray->dir), offset = rt_subd(row->ball.center, rt_widen(ray->org));
    double squared = rt_dotd(dir, dir), nearest = rt_dotd(offset, dir) / squared;
    RtVec3d across = rt_add_scaledd(offset, dir, -nearest);
    double inside = row->ball.radius * row->ball.radius - rt_dotd(across, across);
    double half = sqrt(fmax(inside, 0) / squared);
    row->enter = inside < 0 ? (double)INFINITY : fmax((double)ray->tmin, nearest - half);
    row->leave = inside < 0 ? -(double)INFINITY : fmin((double)ray->tmax, nearest + half);
}

static void note_hit(RtPath *path, uint32_t place, const RtTraced *event) {
    for (uint32_t i = path->count; i-- > 0;) {
        RtPathRow *row = &path->rows[i];
        if (row->kind != RT_TRACED_OBJECT_TEST || row->place != place || row->index != event->index ||
            row->met)
            continue;
        row->met = true;
        row->t = event->t;
        return;
    }
}

static RtStatus note_crossings(RtPath *path, const RtTraced *event, RtPathRow *row, RtError *error) {
    row->listed = true;
    row->first_end = path->end_count;
    row->end_count = event->crossing_count;
    RT_TRY(rt_reserve(&path->ends, &path->end_capacity, (uint64_t)path->end_count + row->end_count,
                      sizeof *path->ends, error));
    for (uint32_t i = 0; i < row->end_count; i++) path->ends[path->end_count++] = event->crossings[i].t;
    return RT_OK;
}

/* The row of its object test is the one before. A plugin's events may be anything. */
static RtStatus enter(Recorder *recorder, uint32_t object) {
    RtPath *path = recorder->path;
    const RtPathPlace *outside = &path->places[recorder->place];
    const RtGeometry *g = &outside->scene->geometry;
    if (object >= g->object_count || !rt_is_instance(g, object) || path->count == 0) return RT_OK;
    const RtInstance *instance = rt_instance_of(g, object);
    RtPathPlace inside = {
        .scene = path->places[0].scene->parts[instance->part],
        .to_world = rt_transform_compose(&instance->to_world, &outside->to_world),
        .first = outside->first + instance->first,
        .part = instance->part,
        .level = outside->level + 1,
        .test = path->count - 1,
    };
    rt_instance_enter(instance, &outside->ray, &inside.ray);
    recorder->place = path->place_count;
    return rt_append(&path->places, &path->place_count, &path->place_capacity, &inside, sizeof inside,
                     recorder->error);
}

/* The row of the instance's test tells what was found in it. */
static void leave(Recorder *recorder, const RtTraced *event) {
    if (recorder->place == 0) return;
    RtPathRow *row = &recorder->path->rows[recorder->path->places[recorder->place].test];
    recorder->place = row->place;
    row->met = event->met;
    row->t = event->t;
}

static void record(void *context, const RtTraced *event) {
    Recorder *recorder = context;
    RtPath *path = recorder->path;
    if (recorder->status != RT_OK) return;
    rt_traced_count(event, &path->tally);
    switch (event->kind) {
    case RT_TRACED_OBJECT_HIT: note_hit(path, recorder->place, event); return;
    case RT_TRACED_LEFT: leave(recorder, event); return;
    case RT_TRACED_ENTERED: recorder->status = enter(recorder, event->index); break;
    default: break;
    }
    if (recorder->status != RT_OK) return;
    recorder->status = rt_reserve(&path->rows, &path->capacity, (uint64_t)path->count + 1, sizeof *path->rows,
                                  recorder->error);
    if (recorder->status != RT_OK) return;
    RtPathRow *row = &path->rows[path->count++];
    if (event->in_tree && row > path->rows && row[-1].kind == RT_TRACED_OBJECT_TEST) {
        row[0] = row[-1]; /* the object's row, which follows its parts */
        row--;
    }
    *row = (RtPathRow){.kind = event->kind,
                       .place = recorder->place,
                       .level = path->places[recorder->place].level,
                       .index = event->index,
                       .leaf = event->leaf,
                       .empty = event->empty,
                       .met = event->met,
                       .boxed = event->box && !rt_box_is_empty(*event->box),
                       .enter = INFINITY,
                       .leave = -INFINITY};
    if (event->kind == RT_TRACED_ENTERED) row->index = path->places[row->place].part;
    const RtGeometry *g = &path->places[row->place].scene->geometry;
    row->object = event->kind == RT_TRACED_OBJECT_TEST ||
                  (event->kind == RT_TRACED_REPEAT_AVOIDED && event->index != RT_NO_OBJECT);
    row->instance = row->object && row->index < g->object_count && rt_is_instance(g, row->index);
    snprintf(row->what, sizeof row->what, "%s",
             row->instance                      ? "instance"
             : row->object                      ? "object"
             : event->kind == RT_TRACED_ENTERED ? "part"
             : event->what                      ? event->what
                                                : "");
    if (event->crossings) recorder->status = note_crossings(path, event, row, recorder->error);
    if (!event->box || !row->boxed) return;
    row->box = *event->box;
    const RtRay *ray = &path->places[row->place].ray;
    find_span(ray, row);
    row->round = event->ball;
    if (!row->round) return;
    row->ball = *event->ball;
    find_span_of_ball(ray, row);
}

static void find_nearest(RtPath *path) {
    float nearest = INFINITY;
    for (uint32_t i = 0; i < path->count; i++) {
        RtPathRow *row = &path->rows[i];
        if (row->kind == RT_TRACED_OBJECT_TEST && row->met && !row->instance)
            nearest = rt_minf(row->t, nearest);
        row->nearest = nearest;
    }
    if (path->any && path->hit.object != RT_NO_OBJECT) path->hit.t = nearest;
}

/* ---- tracing ---- */

/* Accelerators that replay answers learn what the ray hits. */
static RtStatus teach(RtAccel *accel, RtQuery *query, const RtRay *ray, RtError *error) {
    RtHit hit = RT_MISS;
    RT_TRY(rt_accel_learn(accel, ray, &hit, 0, error)); /* forget an earlier ray that lay at this address */
    rt_nearest(query, ray, 1, &hit, NULL);
    return rt_accel_learn(accel, ray, &hit, 1, error);
}

static RtStatus compare(RtPath *path, const RtTally *counted, bool remote, RtError *error) {
    path->tally.rays = counted->rays;
    path->tally.hits = counted->hits;
    if (remote) { /* a plugin may count a leaf after it has left it */
        path->tally.leaf_steps = counted->leaf_steps;
        path->tally.empty_steps = counted->empty_steps;
    }
    const size_t i = rt_tally_difference(&path->tally, counted);
    if (i == RT_TALLY_COUNTER_COUNT) return RT_OK;
    return rt_fail(error, RT_MISMATCH, "the path has %llu %s where the kernel counted %llu",
                   (unsigned long long)rt_tally_get(&path->tally, i), rt_tally_name(i),
                   (unsigned long long)rt_tally_get(counted, i));
}

RtStatus rt_path_available(const RtAccel *accel, const char *spec, RtError *error) {
    if (!rt_accel_is_remote(accel) || (accel->exact && accel->counts)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: raytally cannot follow a ray through a plugin that has hit functions of its own "
                   "or counts nothing",
                   spec);
}

RtStatus rt_path_trace(RtPath *path, RtAccel *accel, const RtRay *ray, RtError *error) {
    RT_OWNED(RtQuery, query, rt_query_clear);
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    *path = (RtPath){
        .ray = *ray, .accel = accel, .any = rt_ray_kind_is_any_hit((RtRayKind)ray->kind), .hit = RT_MISS};
    RT_TRY(rt_query_init(&query, accel, error));
    const RtPathPlace whole = {.ray = *ray, .scene = accel->scene, .to_world = rt_transform_identity()};
    RtStatus status =
        rt_append(&path->places, &path->place_count, &path->place_capacity, &whole, sizeof whole, error);
    if (status == RT_OK) status = teach(accel, &query, &path->ray, error);
    if (status == RT_OK) {
        Recorder recorder = {path, 0, RT_OK, error};
        rt_query_begin(&query);
        rt_trace_observer = &(RtTraceObserver){record, &recorder};
        /* Not rt_occluded, which does not name the occluder. */
        rt_trace_stream(accel, query.scratch, &path->ray, 1, path->any ? NULL : &path->hit, &path->hit.object,
                        tallies);
        rt_trace_observer = NULL;
        status = recorder.status;
    }
    if (status == RT_OK) status = rt_accel_check(accel, error);
    if (status == RT_OK) status = compare(path, &tallies[ray->kind], rt_accel_is_remote(accel), error);
    if (status == RT_OK) find_nearest(path);
    if (status != RT_OK) rt_path_clear(path);
    return status;
}

void rt_path_clear(RtPath *path) {
    rt_free(path->rows);
    rt_free(path->places);
    rt_free(path->ends);
    *path = (RtPath){0};
}

uint32_t rt_path_row_index(const RtPath *path, const RtPathRow *row) {
    const RtPathPlace *place = &path->places[row->place];
    const RtGeometry *g = &place->scene->geometry;
    if (row->instance) return rt_ref_index(g->objects[row->index]);
    return row->object ? place->first + row->index : row->index;
}

bool rt_path_row_answers(const RtPathRow *row) {
    return row->kind == RT_TRACED_OBJECT_TEST || (row->kind == RT_TRACED_EXTENT_TEST && *row->what);
}

uint32_t rt_path_row_spans(const RtPathRow *row) {
    return row->listed ? row->end_count / 2 : row->boxed && row->enter <= row->leave;
}

void rt_path_row_span(const RtPath *path, const RtPathRow *row, uint32_t i, double *enter, double *leave) {
    const float *ends = row->listed ? path->ends + row->first_end + (size_t)2 * i : NULL;
    *enter = ends ? (double)ends[0] : row->enter;
    *leave = ends ? (double)ends[1] : row->leave;
}

const char *rt_path_row_name(const RtPathRow *row) {
    static const char *const names[RT_TRACED_KIND_COUNT] = {[RT_TRACED_EXTENT_TEST] = "extent test",
                                                            [RT_TRACED_OBJECT_TEST] = "object test",
                                                            [RT_TRACED_CSG_TEST] = "csg test",
                                                            [RT_TRACED_CSG_RESULT] = "csg result",
                                                            [RT_TRACED_REPEAT_AVOIDED] = "repeat avoided",
                                                            [RT_TRACED_PASSED_ON] = "passed on",
                                                            [RT_TRACED_ENTERED] = "entered"};
    if (row->kind != RT_TRACED_STEP) return names[row->kind];
    return row->empty ? "step, empty" : row->leaf ? "step, leaf" : "step";
}

uint32_t rt_path_run(const RtPath *path, uint32_t first) {
    uint32_t end = first;
    while (end < path->count && path->rows[end].kind == RT_TRACED_OBJECT_TEST && !path->rows[end].met &&
           path->rows[end].place == path->rows[first].place)
        end++;
    return end - first >= 4 ? end - first : 1;
}

/* ---- which ray ---- */

static RtStatus spawn(const RtAccel *accel, RtRayKind kind, uint32_t light, RtRay *ray,
                      RtHitMemory *hit_memory, RtHit hit, RtError *error) {
    const RtScene *scene = accel->scene;
    RtRay spawned[RT_MAX_SPAWN];
    float factors[RT_MAX_SPAWN];
    RtVec3 arrives;
    if (hit.object == RT_NO_OBJECT)
        return rt_fail(error, RT_BAD_INPUT,
                       "the primary ray hits nothing, so no %s ray follows: choose another pixel",
                       rt_ray_kind_name(kind));
    RtSurface surface = rt_surface(scene, ray, hit, hit_memory);
    if (kind == RT_RAY_SHADOW) {
        if (light >= scene->light_count)
            return rt_fail(error, RT_BAD_INPUT, "there is no light %u: the scene has %u, numbered from 0",
                           light, scene->light_count);
        if (rt_shadow_ray(scene, &surface, light, ray, &arrives)) return RT_OK;
        return rt_fail(
            error, RT_BAD_INPUT,
            "object %u faces away from light %u there, so there is no shadow ray: choose another pixel "
            "or light",
            hit.object, light);
    }
    for (uint32_t i = 0, n = rt_spawn_rays(&surface, spawned, factors); i < n; i++) {
        if (spawned[i].kind != (uint32_t)kind) continue;
        *ray = spawned[i];
        return RT_OK;
    }
    return rt_fail(error, RT_BAD_INPUT, "the primary ray hits object %u, which spawns no %s ray", hit.object,
                   rt_ray_kind_name(kind));
}

RtStatus rt_path_ray(const RtAccel *accel, RtRayKind kind, uint32_t column, uint32_t row, uint32_t light,
                     RtRay *ray, RtError *error) {
    RtView view;
    RT_OWNED(RtQuery, query, rt_query_clear);
    RtHit hit;
    RT_TRY(rt_view_init(&view, &accel->scene->camera, accel->scene->sampling, error));
    *ray = rt_view_ray(&view, column, row);
    if (kind == RT_RAY_PRIMARY) return RT_OK;
    RT_TRY(rt_query_init(&query, accel, error));
    rt_nearest(&query, ray, 1, &hit, NULL);
    return spawn(accel, kind, light, ray, rt_query_hit_memory(&query), hit, error);
}
