/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/trace_tree.h"

#include "accel/columns.h"
#include "cli/cli.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/json.h"

#include <stdio.h>
#include <string.h>

/* ---- in words ---- */

enum { PAGE = 100, LEAST_HIT = 16 }; /* characters: of a line, and of the column of objects */

/* A row of the tree as text. */
enum { NUMBER, RAY, T, HIT, FACTOR, COLUMNS };
typedef struct Row {
    char of[COLUMNS][2 * RT_MAX_DEPTH + RT_TREE_HIT_TEXT];
} Row;

static Row row_of(const RtTreeRay *ray, const RtScene *scene) {
    static const char object[] = "object "; /* the column's name says it */
    const uint32_t indent = 2 * (ray->level - (ray->ray.kind != RT_RAY_SHADOW));
    const size_t size = sizeof(((Row *)0)->of[0]);
    Row row = {.of[T] = "-"};
    char name[RT_TREE_RAY_TEXT], hit[RT_TREE_HIT_TEXT];
    rt_tree_ray_name(ray, name);
    rt_tree_ray_hit(ray, scene, hit);
    snprintf(row.of[NUMBER], size, "%u", ray->number);
    snprintf(row.of[RAY], size, "%*s%s", (int)indent, "", name);
    if (isfinite((double)ray->hit.t)) snprintf(row.of[T], size, "%.5g", (double)ray->hit.t);
    strcpy(row.of[HIT], hit + (strncmp(hit, object, strlen(object)) == 0 ? strlen(object) : 0));
    snprintf(row.of[FACTOR], size, "%.4g", (double)ray->factor);
    return row;
}

/* Widens the columns for all rows that are printed; that of objects is as wide as it needs, or as fits. */
static void measure(const RtRayTree *tree, const RtScene *scene, uint32_t rows, int w[COLUMNS]) {
    for (uint32_t i = 0, left = rows; left > 0; i = rt_ray_tree_next(tree, i), left--) {
        const Row row = row_of(&tree->rays[i], scene);
        for (int c = 0; c < COLUMNS; c++)
            if ((int)strlen(row.of[c]) > w[c]) w[c] = (int)strlen(row.of[c]);
    }
    const int fits = PAGE - (w[NUMBER] + w[RAY] + w[T] + w[FACTOR] + 5 + 4 + 5 + 2 * 7);
    if (w[HIT] > fits) w[HIT] = fits > LEAST_HIT ? fits : LEAST_HIT;
}

static void print_rays(const RtRayTree *tree, const RtTally *costs, const RtScene *scene, uint32_t rows) {
    int w[COLUMNS] = {2, 3, 1, 6, 6};
    measure(tree, scene, rows, w);
    printf("\n%*s  %-*s  %*s  %-*s  %*s  %5s  %4s  %5s\n", w[NUMBER], "", w[RAY], "ray", w[T], "t", w[HIT],
           "object", w[FACTOR], "factor", "tests", "ext.", "steps");
    for (uint32_t i = 0, left = rows; left > 0; i = rt_ray_tree_next(tree, i), left--) {
        Row row = row_of(&tree->rays[i], scene);
        if ((int)strlen(row.of[HIT]) > w[HIT]) strcpy(row.of[HIT] + w[HIT] - 3, "...");
        printf("%*s  %-*s  %*s  %-*s  %*s  %5llu  %4llu  %5llu\n", w[NUMBER], row.of[NUMBER], w[RAY],
               row.of[RAY], w[T], row.of[T], w[HIT], row.of[HIT], w[FACTOR], row.of[FACTOR],
               (unsigned long long)costs[i].object_tests, (unsigned long long)costs[i].extent_tests,
               (unsigned long long)costs[i].steps);
    }
}

/* Whether the light of a ray can have the term: of a hit any, of a shadow ray diffuse and specular. */
static bool has_term(const RtTreeRay *ray, RtTerm term) {
    if (ray->ray.kind == RT_RAY_SHADOW) return term == RT_TERM_DIFFUSE || term == RT_TERM_SPECULAR;
    return ray->surface.material != NULL;
}

static int term_width(RtTerm term) {
    const int name = (int)strlen(rt_term_name(term));
    return name > 6 ? name : 6;
}

/* A line per channel: the terms, and the light that is their sum. */
static void print_light_of(const RtTreeRay *ray) {
    static const char *const channels[] = {"red", "green", "blue"};
    for (int c = 0; c < 3; c++) {
        if (c == 0)
            printf("%5u  %-5s", ray->number, channels[c]);
        else
            printf("%5s  %-5s", "", channels[c]);
        for (int t = 0; t < RT_TERM_COUNT; t++) {
            if (has_term(ray, (RtTerm)t))
                printf("  %*.4f", term_width((RtTerm)t), ray->terms[t].at[c]);
            else
                printf("  %*s", term_width((RtTerm)t), "-");
        }
        printf("  %6.4f\n", ray->light.at[c]);
    }
}

/* Of all rays except shadow rays that end at an occluder: those bring no light. */
static void print_light(const RtRayTree *tree, uint32_t rows) {
    printf("\n%5s  %-5s", "ray", "");
    for (int t = 0; t < RT_TERM_COUNT; t++) printf("  %*s", term_width((RtTerm)t), rt_term_name((RtTerm)t));
    printf("  %6s\n", "light");
    for (uint32_t i = 0, left = rows; left > 0; i = rt_ray_tree_next(tree, i), left--) {
        const RtTreeRay *ray = &tree->rays[i];
        if (ray->ray.kind != RT_RAY_SHADOW || ray->hit.object == RT_NO_OBJECT) print_light_of(ray);
    }
}

static void print_sums(const RtRayTree *tree, const RtTally *costs) {
    RtTally sum = {0};
    uint32_t cut = 0;
    for (uint32_t i = 0; i < tree->count; i++) {
        rt_tally_add(&sum, &costs[i]);
        cut += tree->rays[i].cut;
    }
    printf("\ntotal: %u ray%s in %u level%s, %llu object_tests, %llu extent_tests, %llu steps\n", tree->count,
           rt_plural(tree->count), tree->levels, rt_plural(tree->levels),
           (unsigned long long)sum.object_tests, (unsigned long long)sum.extent_tests,
           (unsigned long long)sum.steps);
    if (cut > 0)
        printf("%u hit%s would reflect or transmit, but the depth is reached\n", cut, rt_plural(cut));
    printf("colour: red %.6g, green %.6g, blue %.6g, the sum over the rays, as in the image\n",
           (double)tree->color.x, (double)tree->color.y, (double)tree->color.z);
}

void rt_cli_print_tree(const RtRayTree *tree, const RtTally *costs, const RtScene *scene, int64_t rows) {
    const uint32_t shown = rows > 0 && rows < (int64_t)tree->count ? (uint32_t)rows : tree->count;
    const uint32_t left = tree->count - shown;
    print_rays(tree, costs, scene, shown);
    if (left > 0) printf("       and %u more ray%s\n       --rows 0 prints each\n", left, rt_plural(left));
    print_light(tree, shown);
    print_sums(tree, costs);
}

/* ---- as JSON ---- */

static json_t *color_json(RtVec3d color) {
    return json_pack("[f, f, f]", color.x, color.y, color.z);
}

static json_t *terms_json(const RtTreeRay *ray) {
    json_t *terms = json_object();
    for (int t = 0; terms && t < RT_TERM_COUNT; t++) {
        if (json_object_set_new(terms, rt_term_name((RtTerm)t), color_json(ray->terms[t])) == 0) continue;
        json_decref(terms);
        return NULL;
    }
    return terms;
}

static json_t *surface_json(const RtSurface *s) {
    if (!s->material) return json_null();
    return json_pack("{s:o, s:o, s:b, s:s}", "point", color_json(s->point), "normal", color_json(s->normal),
                     "from_inside", !s->entering, "material", s->material->name);
}

/* Without the rays that start at its hit. */
static json_t *ray_json(const RtTreeRay *ray, const RtTally *cost, const RtScene *scene) {
    char name[RT_TREE_RAY_TEXT];
    const uint32_t object = ray->hit.object;
    const bool named = object < RT_UNNAMED_OBJECT, shadow = ray->ray.kind == RT_RAY_SHADOW;
    rt_tree_ray_name(ray, name);
    return json_pack(
        "{s:i, s:s, s:s, s:o, s:i, s:o, s:o, s:o, s:o, s:s?, s:o, s:o, s:f, s:b, s:b, s:o, s:o, s:o, s:o}",
        "number", (int)ray->number, "ray", name, "kind", rt_ray_kind_name((RtRayKind)ray->ray.kind),
        "to_light", shadow ? json_integer(ray->ray.source) : json_null(), "level", (int)ray->level, "org",
        rt_cli_vector_json(ray->ray.org), "dir", rt_cli_vector_json(ray->ray.dir), "t",
        rt_json_number((double)ray->hit.t), "object", named ? json_integer(object) : json_null(), "shape",
        named ? rt_shape_name(rt_ref_shape(scene->geometry.objects[object])) : NULL, "blocked",
        shadow ? json_boolean(object != RT_NO_OBJECT) : json_null(), "surface", surface_json(&ray->surface),
        "factor", (double)ray->factor, "total_internal_reflection", ray->total, "cut", ray->cut, "terms",
        terms_json(ray), "light", color_json(ray->light), "counts", rt_json_tally(cost), "rays",
        json_array());
}

json_t *rt_cli_tree_json(const RtRayTree *tree, const RtTally *costs, const RtScene *scene) {
    json_t **nodes = rt_alloc(tree->count, sizeof(json_t *)), *root = NULL;
    if (tree->count == 0 || !nodes) {
        rt_free(nodes);
        return nodes ? json_null() : NULL;
    }
    bool made = true;
    for (uint32_t i = 0; made && i < tree->count; i++) { /* parents come first */
        const uint32_t parent = tree->rays[i].parent;
        nodes[i] = ray_json(&tree->rays[i], &costs[i], scene);
        if (parent == RT_NO_RAY) root = nodes[i];
        made = nodes[i] && (parent == RT_NO_RAY ||
                            json_array_append_new(json_object_get(nodes[parent], "rays"), nodes[i]) == 0);
    }
    rt_free(nodes);
    if (made) return root;
    json_decref(root);
    return NULL;
}
