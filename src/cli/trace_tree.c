/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/trace_tree.h"

#include "accel/columns.h"
#include "cli/cli.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/json.h"

#include <stdio.h>

/* ---- in words ---- */

static uint32_t indent_of(const RtTreeRay *ray) {
    return 2 * (ray->level - (ray->ray.kind != RT_RAY_SHADOW));
}

static void print_color(RtVec3d color) {
    printf("  %6.4f %6.4f %6.4f", color.x, color.y, color.z);
}

static void print_ray(const RtTreeRay *ray, const RtTally *cost, const RtScene *scene) {
    char name[RT_TREE_RAY_TEXT], hit[RT_TREE_HIT_TEXT];
    const int indent = (int)indent_of(ray);
    rt_tree_ray_name(ray, name);
    rt_tree_ray_hit(ray, scene, hit);
    printf("%5u  %*s%-*s", ray->number, indent, "", indent < 32 ? 32 - indent : 0, name);
    if (isfinite((double)ray->hit.t))
        printf("  %9.6g", (double)ray->hit.t);
    else
        printf("  %9s", "-");
    printf("  %-36s  %7.4g", hit, (double)ray->factor);
    print_color(ray->light);
    printf("  %5llu  %5llu  %5llu\n", (unsigned long long)cost->object_tests,
           (unsigned long long)cost->extent_tests, (unsigned long long)cost->steps);
}

static void print_rays(const RtRayTree *tree, const RtTally *costs, const RtScene *scene, uint32_t rows) {
    printf("\n%5s  %-32s  %9s  %-36s  %7s  %6s %6s %6s  %5s  %5s  %5s\n", "", "ray", "t", "hits", "factor",
           "red", "green", "blue", "tests", "ext.", "steps");
    for (uint32_t i = 0, printed = 0; printed < rows; i = rt_ray_tree_next(tree, i), printed++)
        print_ray(&tree->rays[i], &costs[i], scene);
}

static void print_terms(const RtRayTree *tree, uint32_t rows) {
    printf("\n%5s", "");
    for (int t = 0; t < RT_TERM_COUNT; t++)
        printf("  %-*s", t + 1 < RT_TERM_COUNT ? 20 : 0, rt_term_name((RtTerm)t));
    putchar('\n');
    for (uint32_t i = 0, printed = 0; printed < rows; i = rt_ray_tree_next(tree, i), printed++) {
        const RtTreeRay *ray = &tree->rays[i];
        if (!ray->surface.material) continue;
        printf("%5u", ray->number);
        for (int t = 0; t < RT_TERM_COUNT; t++) print_color(ray->terms[t]);
        putchar('\n');
    }
}

static void print_sums(const RtRayTree *tree, const RtTally *costs) {
    RtTally sum = {0};
    uint32_t cut = 0;
    for (uint32_t i = 0; i < tree->count; i++) {
        rt_tally_add(&sum, &costs[i]);
        cut += tree->rays[i].cut;
    }
    printf("\nin all: %u ray%s in %u level%s, %llu object_tests, %llu extent_tests, %llu steps\n",
           tree->count, rt_plural(tree->count), tree->levels, rt_plural(tree->levels),
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
    print_terms(tree, shown);
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
