/* SPDX-License-Identifier: Apache-2.0 */
#include "render/ray_tree.h"

#include "core/base/words.h"

#include <stdio.h>

typedef struct Recorder {
    RtRayTree *of[RT_TILE * RT_TILE]; /* the tree of each sample of the tile; NULL: none */
    RtStatus status;
    RtError *error;
} Recorder;

/* ---- while the frame is traced ---- */

static void record(void *context, RtSample sample, const RtFrameRay *seen) {
    Recorder *recorder = context;
    RtRayTree *tree = recorder->of[rt_tile_place(sample)];
    if (!tree || recorder->status != RT_OK) return;
    const bool shadow = seen->ray->kind == RT_RAY_SHADOW;
    RtTreeRay ray = {.ray = *seen->ray,
                     .level = 1,
                     .parent = seen->parent,
                     .child = RT_NO_RAY,
                     .next = RT_NO_RAY,
                     .factor = seen->factor,
                     .hit = seen->occluded ? (RtHit){INFINITY, RT_UNNAMED_OBJECT} : seen->hit,
                     .added = rt_scale(seen->light, seen->factor)};
    if (seen->surface) ray.surface = *seen->surface;
    if (seen->parent != RT_NO_RAY) ray.level = tree->rays[seen->parent].level + !shadow;
    tree->color = rt_add(tree->color, ray.added);
    recorder->status =
        rt_append(&tree->rays, &tree->count, &tree->capacity, &ray, sizeof ray, recorder->error);
}

/* ---- afterwards ---- */

static void find_occluders(RtRayTree *tree, RtQuery *query) {
    for (uint32_t i = 0; i < tree->count; i++) {
        RtTreeRay *ray = &tree->rays[i];
        if (ray->hit.object != RT_UNNAMED_OBJECT) continue;
        RtHit nearest;
        rt_nearest(query, &ray->ray, 1, &nearest, NULL);
        if (nearest.object != RT_NO_OBJECT) ray->hit = nearest;
    }
}

/* Sets the terms that the ray itself adds. The highlight is what the light is more than its diffuse part, so
 * that together they are what the frame added. */
static void set_own_terms(const RtRayTree *tree, const RtScene *scene, RtTreeRay *ray) {
    if (ray->ray.kind == RT_RAY_SHADOW) {
        if (ray->hit.object != RT_NO_OBJECT) return;
        const RtVec3 diffuse = rt_diffuse_light(scene, &tree->rays[ray->parent].surface, ray->ray.source);
        ray->terms[RT_TERM_DIFFUSE] = rt_widen(rt_scale(diffuse, ray->factor));
        ray->terms[RT_TERM_SPECULAR] = rt_subd(rt_widen(ray->added), ray->terms[RT_TERM_DIFFUSE]);
    } else if (ray->hit.object == RT_NO_OBJECT) {
        ray->light = rt_widen(ray->added);
    } else {
        ray->terms[RT_TERM_AMBIENT] = rt_widen(ray->added);
    }
}

/* Adds the light of a finished ray to the terms of its parent, and puts the ray before its siblings. */
static void join_parent(RtTreeRay *parent, RtTreeRay *ray, uint32_t index) {
    RtVec3d *terms = parent->terms;
    ray->next = parent->child;
    parent->child = index;
    if (ray->ray.kind == RT_RAY_SHADOW) {
        for (int t = RT_TERM_DIFFUSE; t <= RT_TERM_SPECULAR; t++) terms[t] = rt_addd(terms[t], ray->terms[t]);
        return;
    }
    const bool through = ray->ray.kind == RT_RAY_TRANSMISSION;
    const RtTerm term = through ? RT_TERM_TRANSMITTED : RT_TERM_REFLECTED;
    terms[term] = rt_addd(terms[term], ray->light);
    ray->total = !through && ray->factor > parent->factor * parent->surface.material->reflection;
}

/* Children follow their parents, so a ray's terms are complete when its turn comes. */
static void finish(RtRayTree *tree, const RtScene *scene) {
    for (uint32_t i = tree->count; i-- > 0;) {
        RtTreeRay *ray = &tree->rays[i];
        const RtMaterial *m = ray->surface.material;
        set_own_terms(tree, scene, ray);
        for (int t = 0; t < RT_TERM_COUNT; t++) ray->light = rt_addd(ray->light, ray->terms[t]);
        ray->cut = m && ray->level == tree->depth && (m->reflection > 0 || m->transmission > 0);
        if (ray->level > tree->levels) tree->levels = ray->level;
        if (ray->parent != RT_NO_RAY) join_parent(&tree->rays[ray->parent], ray, i);
    }
    uint32_t number = 0;
    for (uint32_t i = 0; number < tree->count; i = rt_ray_tree_next(tree, i)) tree->rays[i].number = ++number;
}

static RtStatus finish_all(RtRayTree *trees, const RtAccel *accel, uint32_t count, RtError *error) {
    RT_OWNED(RtQuery, query, rt_query_clear);
    RT_TRY(rt_query_init(&query, accel, error));
    for (uint32_t i = 0; i < count; i++) {
        find_occluders(&trees[i], &query);
        finish(&trees[i], accel->scene);
    }
    return rt_accel_check(accel, error);
}

static RtStatus trace(RtRayTree *trees, const RtAccel *accel, const RtSample *samples, uint32_t count,
                      const RtRay *given, uint32_t depth, RtError *error) {
    RT_OWNED(RtFrame, frame, rt_frame_clear);
    Recorder recorder = {.status = RT_OK, .error = error};
    for (uint32_t i = 0; i < count; i++) {
        trees[i] = (RtRayTree){.depth = depth};
        recorder.of[rt_tile_place(samples[i])] = &trees[i];
    }
    const RtFrameObserver observer = {rt_tile_of(samples[0]), given, record, &recorder};
    const RtFrameOptions options = {.depth = depth, .threads = 1, .observer = &observer};
    RtStatus status = rt_frame_trace(&frame, accel, &options, error);
    if (status == RT_OK) status = recorder.status;
    if (status == RT_OK) status = finish_all(trees, accel, count, error);
    for (uint32_t i = 0; i < count && status != RT_OK; i++) rt_ray_tree_clear(&trees[i]);
    return status;
}

RtStatus rt_ray_trees_trace(RtRayTree *trees, const RtAccel *accel, const RtSample *samples, uint32_t count,
                            uint32_t depth, RtError *error) {
    return trace(trees, accel, samples, count, NULL, depth, error);
}

RtStatus rt_ray_tree_trace_given(RtRayTree *tree, const RtAccel *accel, const RtRay *given, uint32_t depth,
                                 RtError *error) {
    RtRay ray = *given;
    ray.kind = RT_RAY_PRIMARY;
    ray.source = RT_NO_RAY;
    return trace(tree, accel, &(RtSample){0, 0}, 1, &ray, depth, error);
}

void rt_ray_tree_clear(RtRayTree *tree) {
    rt_free(tree->rays);
    *tree = (RtRayTree){0};
}

uint32_t rt_ray_tree_next(const RtRayTree *tree, uint32_t index) {
    if (tree->rays[index].child != RT_NO_RAY) return tree->rays[index].child;
    while (index != RT_NO_RAY && tree->rays[index].next == RT_NO_RAY) index = tree->rays[index].parent;
    return index == RT_NO_RAY ? RT_NO_RAY : tree->rays[index].next;
}

void rt_tree_ray_name(const RtTreeRay *ray, char name[RT_TREE_RAY_TEXT]) {
    const RtRayKind kind = (RtRayKind)ray->ray.kind;
    if (kind == RT_RAY_SHADOW)
        snprintf(name, RT_TREE_RAY_TEXT, "shadow to light %u", ray->ray.source);
    else
        snprintf(name, RT_TREE_RAY_TEXT, "%s",
                 ray->total ? "total internal reflection" : rt_ray_kind_name(kind));
}

void rt_tree_ray_hit(const RtTreeRay *ray, const RtScene *scene, char out[RT_TREE_HIT_TEXT]) {
    const bool shadow = ray->ray.kind == RT_RAY_SHADOW;
    const uint32_t object = ray->hit.object;
    if (object == RT_NO_OBJECT) {
        snprintf(out, RT_TREE_HIT_TEXT, "%s", shadow ? "nothing: lit" : "nothing: background");
        return;
    }
    if (object == RT_UNNAMED_OBJECT) {
        snprintf(out, RT_TREE_HIT_TEXT, "an object: in shadow");
        return;
    }
    const RtMaterial *m = ray->surface.material;
    snprintf(out, RT_TREE_HIT_TEXT, "object %u, %s", object,
             rt_shape_name(rt_geometry_shape(&scene->geometry, object)));
    if (shadow) rt_append_text(out, RT_TREE_HIT_TEXT, ": in shadow");
    if (m && m->name[0]) rt_append_text(out, RT_TREE_HIT_TEXT, ", %s", m->name);
    if (m && !ray->surface.entering) rt_append_text(out, RT_TREE_HIT_TEXT, ", from inside");
}

const char *rt_term_name(RtTerm term) {
    static const char *const names[] = {
#define RT_TERM_NAME(CONSTANT, name) #name,
        RT_TERMS(RT_TERM_NAME)
#undef RT_TERM_NAME
    };
    return names[term];
}
