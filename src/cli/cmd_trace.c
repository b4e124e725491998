/* SPDX-License-Identifier: Apache-2.0 */
/* raytally trace: one ray's path through an accelerator, step by step, or the ray tree of a pixel. */
#include "accel/columns.h"
#include "cli/cli.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "picture/pictures.h"
#include "render/ray_tree.h"
#include "scenes/open.h"

#include <stdio.h>
#include <string.h>

typedef struct Options {
    const char *scene, *accel, *svg, *ray; /* the last: NULL, or in place of the pixel */
    RtPixel pixel;
    RtRay given; /* of `ray` */
    uint32_t size[2], light, depth;
    int64_t rows;
    RtRayKind kind;
    bool json;
} Options;

enum { DEFAULT_ROWS = 200 };

static void take_kind(void *options, const char *text, struct argp_state *state) {
    ((Options *)options)->kind = rt_cli_image_ray_kind(state, "--rays", text);
}

static void finish(void *options, struct argp_state *state) {
    const Options *o = options;
    const bool any_hit = o->kind == RT_RAY_SHADOW;
    if (o->pixel.given == (o->ray != NULL))
        argp_error(state, "give one of --pixel X,Y and --ray OX,OY,OZ,DX,DY,DZ");
    if (o->ray && (o->light > 0 || (o->kind != RT_RAY_PRIMARY && !any_hit)))
        argp_error(state,
                   "--ray is the whole ray: leave out --light, and --rays except for shadow (any hit)");
    if (o->depth > 0 && (o->kind != RT_RAY_PRIMARY || o->light > 0))
        argp_error(state, "--depth follows all rays of the pixel: leave out --rays and --light");
}

static const RtOption options[] = {
    {"pixel", 'p', "X,Y", RT_TO_PIXEL(pixel),
     "The ray through the middle of this pixel; 0,0 is the upper left"},
    {"ray", 'r', RT_RAY_OPERAND, RT_TO_TEXT(ray), "This ray instead: " RT_RAY_HELP},
    {"accel", 'a', "SPEC", RT_TO_TEXT(accel), "Accelerator (default bvh); `raytally accels` lists them"},
    {"size", 's', "WxH", RT_TO_SIZE(size), "Size of the image in pixels (default: the camera's)"},
    {"rays", 'k', "KIND", RT_TO_TAKE(take_kind),
     "primary (default), or the shadow, reflection or transmission ray that starts where the primary ray "
     "hits; with --ray, shadow asks for any hit"},
    {"light", 0, "N", RT_TO_INTEGER(light, 0, UINT32_MAX),
     "The light that the shadow ray goes to (default 0)"},
    {"depth", 'd', "N", RT_TO_INTEGER(depth, 1, RT_MAX_DEPTH),
     "Follow the whole ray tree of the pixel, N levels, instead of one ray; the primary ray is the first "
     "level"},
    {"svg", 0, "FILE.svg", RT_TO_PATH(svg, RT_CLI_PICTURES),
     "Draw the path: a section through the scene along the ray, with each step and test; with --depth, the "
     "ray tree in a section that contains the primary ray"},
    {"rows", 0, "N", RT_TO_INTEGER(rows, 0, UINT32_MAX),
     "Print at most N rows, 0 for all (200); rows of hits are always printed"},
    RT_STRICT_OPTION,
    RT_LIMIT_OPTIONS,
    {"json", 'j', NULL, RT_TO_FLAG(json), "One JSON document on stdout, with all rows"},
    {0}};

/* ---- in words ---- */

/* A t; "-" for INFINITY. */
static void print_t(double t) {
    if (t < (double)INFINITY)
        printf("  %9.6g", t);
    else
        printf("  %9s", "-");
}

static const char *shape_of(const RtGeometry *g, uint32_t id) {
    return id < rt_geometry_id_count(g) ? rt_shape_name(rt_geometry_shape(g, id)) : "of unknown id";
}

/* Interval `i`, or "-" twice. */
static void print_span(const RtPath *path, const RtPathRow *row, uint32_t i) {
    double enter = (double)INFINITY, leave = (double)INFINITY;
    if (i < rt_path_row_spans(row)) rt_path_row_span(path, row, i, &enter, &leave);
    print_t(enter);
    print_t(leave);
}

/* Where the ray meets the plane of a polygon, in the projection, and the edges that a half-line from there
 * crosses. */
static void print_projection(const RtRay *ray, const RtPolygon *polygon, const RtVec3 *vertices) {
    const RtVec3d org = rt_widen(ray->org), dir = rt_widen(ray->dir);
    const double at = rt_dotd(polygon->normal, rt_subd(polygon->center, org)) / rt_dotd(polygon->normal, dir);
    if (!isfinite(at)) return;
    const RtVec3d point = rt_add_scaledd(org, dir, at);
    const uint32_t crossed = rt_polygon_crossings(polygon, vertices, point);
    printf("%23s  its plane at t = %.6g; projected to %c, %c: (%.6g, %.6g), ", "", at, "xyz"[polygon->u],
           "xyz"[polygon->v], point.at[polygon->u], point.at[polygon->v]);
    if (crossed == RT_ON_EDGE)
        puts("on an edge");
    else
        printf("%u edge%s crossed\n", crossed, rt_plural(crossed));
}

static void print_roots(const RtRay *ray, const RtSphere *sphere) {
    double roots[2];
    const int count = raytally_sphere_roots((const float *)sphere, ray->org.at, ray->dir.at, roots);
    printf("%23s  its equation has ", "");
    if (count == 0) puts("no root");
    if (count == 1) printf("the root t = %.6g\n", roots[0]);
    if (count == 2) printf("the roots t = %.6g and %.6g\n", roots[0], roots[1]);
}

/* How the hit function of a sphere or polygon finds its answer, if the ray meets the object's box. */
static void print_test(const RtPath *path, const RtPathRow *row) {
    const RtPathPlace *place = &path->places[row->place];
    const RtGeometry *g = &place->scene->geometry;
    if (row->kind != RT_TRACED_OBJECT_TEST || row->index >= g->object_count || rt_path_row_spans(row) == 0)
        return;
    const uint32_t index = rt_ref_index(g->objects[row->index]);
    const RtShape shape = rt_ref_shape(g->objects[row->index]);
    if (shape == RT_SHAPE_SPHERE) print_roots(&place->ray, &g->spheres[index]);
    if (shape == RT_SHAPE_POLYGON)
        print_projection(&place->ray, &g->polygons[index], rt_polygon_vertices(g, index));
}

static void print_row(const RtPath *path, uint32_t index, int width) {
    const RtPathRow *row = &path->rows[index];
    const RtPathPlace *place = &path->places[row->place];
    const int indent = 2 * (int)row->level;
    char of[RT_MAX_NAME + 32] = "";
    if (row->kind == RT_TRACED_OBJECT_TEST && !row->instance)
        snprintf(of, sizeof of, "%s %u, %s", row->what, rt_path_row_index(path, row),
                 shape_of(&place->scene->geometry, row->index));
    else if (row->kind == RT_TRACED_PASSED_ON)
        snprintf(of, sizeof of, "by %s", row->what);
    else if (*row->what)
        snprintf(of, sizeof of, "%s %u", row->what, rt_path_row_index(path, row));
    printf("%5u  %*s%-*s  %-24s", index + 1, indent, "", width - indent, rt_path_row_name(row), of);
    print_span(path, row, 0);
    if (!rt_path_row_answers(row))
        printf("  %-18s", row->listed && row->end_count == 0 ? "empty" : "");
    else if (row->kind == RT_TRACED_OBJECT_TEST && row->met)
        printf("  hit at %-11.6g", (double)row->t);
    else
        printf("  %-18s", row->met ? "hit" : "missed");
    print_t((double)row->nearest);
    putchar('\n');
    for (uint32_t i = 1; i < rt_path_row_spans(row); i++) {
        printf("%5s  %*s  %-24s", "", width, "", "  and");
        print_span(path, row, i);
        putchar('\n');
    }
    print_test(path, row);
}

static void print_rows(const RtPath *path, const Options *o) {
    uint32_t left_out = 0, joined = 0;
    /* Columns of the first word of a row, which is indented by the instances around it. */
    const int width = 14 + 2 * (int)path->places[0].scene->geometry.nesting;
    printf("\n%5s  %*s  %-24s  %-20s  %-18s  %9s\n", "", width, "", "", " in box or solid, t", "",
           "nearest t");
    for (uint32_t i = 0, run; i < path->count; i += run) {
        const RtPathRow *row = &path->rows[i];
        bool hits = row->kind == RT_TRACED_OBJECT_TEST && row->met;
        run = o->rows > 0 ? rt_path_run(path, i) : 1;
        joined += run - 1;
        if (o->rows > 0 && (int64_t)i >= o->rows && !hits) {
            left_out += run;
        } else if (run == 1) {
            print_row(path, i, width);
        } else {
            const int indent = 2 * (int)row->level;
            printf("%5u  %*s%-*s  %u objects, to row %-41u  %-18s", i + 1, indent, "", width - indent,
                   "object tests", run, i + run, "all missed");
            print_t((double)row->nearest);
            putchar('\n');
        }
    }
    if (left_out) printf("       and %u more row%s\n", left_out, rt_plural(left_out));
    if (joined + left_out > 0) puts("       --rows 0 prints each");
}

static void print_answer(const RtPath *path, const RtGeometry *g) {
    if (path->hit.object == RT_NO_OBJECT) {
        puts(path->any ? "nothing blocks it" : "it hits nothing");
        return;
    }
    if (path->hit.object == RT_UNNAMED_OBJECT) {
        puts("it is blocked");
        return;
    }
    RtVec3d p = rt_ray_point(&path->ray, path->hit.t);
    printf("%s object %u, %s", path->any ? "it is blocked by" : "its nearest hit is", path->hit.object,
           shape_of(g, path->hit.object));
    if (isfinite(path->hit.t))
        printf(", at t = %.9g, (%.6g, %.6g, %.6g)", (double)path->hit.t, p.x, p.y, p.z);
    putchar('\n');
}

static void print_path(const RtPath *path, const Options *o, const char *title, const RtGeometry *g) {
    bool any = false;
    char ray[RT_RAY_TEXT];
    rt_ray_format(&path->ray, ray, sizeof ray);
    printf("%s\n%s\n", title, ray);
    print_rows(path, o);
    printf("\ntotal:");
    for (size_t i = 2; i < RT_TALLY_COUNTER_COUNT; i++) { /* without rays and hits */
        if (rt_tally_get(&path->tally, i) == 0) continue;
        printf(" %llu %s,", (unsigned long long)rt_tally_get(&path->tally, i), rt_tally_name(i));
        any = true;
    }
    puts(any ? " as in the counted kernel" : " nothing is counted");
    print_answer(path, g);
}

/* ---- the ray tree in words ---- */

enum { PAGE = 100, LEAST_HIT = 16 }; /* characters: of a line, and of the column of objects */

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

/* A line per channel: the terms that a ray can have, of a shadow ray diffuse and specular, and the light that
 * is their sum. Of all rays except shadow rays that end at an occluder: those bring no light. */
static void print_light(const RtRayTree *tree, uint32_t rows) {
    static const char *const channels[] = {"red", "green", "blue"};
    int width[RT_TERM_COUNT];
    printf("\n%5s  %-5s", "ray", "");
    for (int t = 0; t < RT_TERM_COUNT; t++) {
        width[t] = (int)fmax((double)strlen(rt_term_name((RtTerm)t)), 6);
        printf("  %*s", width[t], rt_term_name((RtTerm)t));
    }
    printf("  %6s\n", "light");
    for (uint32_t i = 0, left = rows; left > 0; i = rt_ray_tree_next(tree, i), left--) {
        const RtTreeRay *ray = &tree->rays[i];
        const bool shadow = ray->ray.kind == RT_RAY_SHADOW;
        for (int c = 0; c < 3 && !(shadow && ray->hit.object != RT_NO_OBJECT); c++) {
            printf("%5.0u  %-5s", c == 0 ? ray->number : 0, channels[c]);
            for (int t = 0; t < RT_TERM_COUNT; t++) {
                const bool can =
                    shadow ? t == RT_TERM_DIFFUSE || t == RT_TERM_SPECULAR : ray->surface.material != NULL;
                if (can)
                    printf("  %*.4f", width[t], ray->terms[t].at[c]);
                else
                    printf("  %*s", width[t], "-");
            }
            printf("  %6.4f\n", ray->light.at[c]);
        }
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
    printf("colour: red %.6g, green %.6g, blue %.6g, the sum over the rays\n", (double)tree->color.x,
           (double)tree->color.y, (double)tree->color.z);
}

/* Prints at most `rows` rays, all for 0, depth first and indented; the light that each brings, and its terms;
 * and sums: in 100 columns, unless rays are more than about 12 levels deep. */
static void print_tree(const RtRayTree *tree, const RtTally *costs, const RtScene *scene, int64_t rows) {
    const uint32_t shown = rows > 0 && rows < (int64_t)tree->count ? (uint32_t)rows : tree->count;
    const uint32_t left = tree->count - shown;
    print_rays(tree, costs, scene, shown);
    if (left > 0) printf("       and %u more ray%s\n       --rows 0 prints each\n", left, rt_plural(left));
    print_light(tree, shown);
    print_sums(tree, costs);
}

/* ---- as JSON ---- */

static json_t *row_json(const RtPath *path, const RtPathRow *row) {
    bool is_in = row->boxed && row->enter <= row->leave;
    json_t *json = json_pack(
        "{s:s, s:s?, s:I, s:I, s:o, s:o, s:o, s:o, s:o}", "event", rt_path_row_name(row), "of",
        *row->what ? row->what : NULL, "index", (json_int_t)rt_path_row_index(path, row), "level",
        (json_int_t)row->level, "met",
        row->kind == RT_TRACED_EXTENT_TEST && !rt_path_row_answers(row) ? json_null()
                                                                        : json_boolean(row->met),
        "enter", rt_json_number(is_in ? row->enter : (double)NAN), "leave",
        rt_json_number(is_in ? row->leave : (double)NAN), "t",
        rt_json_number(row->kind == RT_TRACED_OBJECT_TEST && row->met ? (double)row->t : (double)NAN),
        "nearest", rt_json_number((double)row->nearest));
    if (row->boxed)
        json_object_set_new(
            json, "box",
            json_pack("[o, o]", rt_cli_vector_json(row->box.lo), rt_cli_vector_json(row->box.hi)));
    json_t *intervals = row->listed ? json_array() : NULL;
    for (uint32_t i = 0; intervals && i < rt_path_row_spans(row); i++) {
        double enter, leave;
        rt_path_row_span(path, row, i, &enter, &leave);
        json_array_append_new(intervals, json_pack("[o, o]", rt_json_number(enter), rt_json_number(leave)));
    }
    if (intervals) json_object_set_new(json, "intervals", intervals);
    return json;
}

/* null for --ray */
static json_t *pixel_json(const Options *o) {
    return o->ray ? json_null() : json_pack("[i, i]", (int)o->pixel.x, (int)o->pixel.y);
}

/* `object` is null if none is hit, or if the occluder is unknown; `blocked` is null for nearest-hit rays. */
static json_t *path_json(const RtPath *path, const Options *o, const char *spec) {
    const RtRay *r = &path->ray;
    json_t *rows = json_array();
    for (uint32_t i = 0; i < path->count; i++) json_array_append_new(rows, row_json(path, &path->rows[i]));
    return json_pack("{s:s, s:s, s:s, s:o, s:s, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "scene",
                     o->scene, "accel", o->accel, "spec", spec, "pixel", pixel_json(o), "kind",
                     o->ray && o->kind == RT_RAY_PRIMARY ? "nearest" : rt_ray_kind_name((RtRayKind)r->kind),
                     "org", rt_cli_vector_json(r->org), "dir", rt_cli_vector_json(r->dir), "tmin",
                     rt_json_number((double)r->tmin), "tmax", rt_json_number((double)r->tmax), "rows", rows,
                     "counts", rt_json_tally(&path->tally), "object",
                     path->hit.object >= RT_UNNAMED_OBJECT ? json_null() : json_integer(path->hit.object),
                     "blocked", path->any ? json_boolean(path->hit.object != RT_NO_OBJECT) : json_null(), "t",
                     rt_json_number((double)path->hit.t));
}

static json_t *color_json(RtVec3d color) {
    return json_pack("[f, f, f]", color.x, color.y, color.z);
}

/* Without the rays that start at its hit. */
static json_t *ray_json(const RtTreeRay *ray, const RtTally *cost, const RtScene *scene) {
    char name[RT_TREE_RAY_TEXT];
    const uint32_t object = ray->hit.object;
    const bool named = object < RT_UNNAMED_OBJECT, shadow = ray->ray.kind == RT_RAY_SHADOW;
    const RtSurface *surface = &ray->surface;
    json_t *terms = json_object(), *met = json_null();
    rt_tree_ray_name(ray, name);
    for (int t = 0; t < RT_TERM_COUNT; t++)
        json_object_set_new(terms, rt_term_name((RtTerm)t), color_json(ray->terms[t]));
    if (surface->material)
        met = json_pack("{s:o, s:o, s:b, s:s}", "point", color_json(surface->point), "normal",
                        color_json(surface->normal), "from_inside", !surface->entering, "material",
                        surface->material->name);
    return json_pack(
        "{s:i, s:s, s:s, s:o, s:i, s:o, s:o, s:o, s:o, s:s?, s:o, s:o, s:f, s:b, s:b, s:o, s:o, s:o, s:o}",
        "number", (int)ray->number, "ray", name, "kind", rt_ray_kind_name((RtRayKind)ray->ray.kind),
        "to_light", shadow ? json_integer(ray->ray.source) : json_null(), "level", (int)ray->level, "org",
        rt_cli_vector_json(ray->ray.org), "dir", rt_cli_vector_json(ray->ray.dir), "t",
        rt_json_number((double)ray->hit.t), "object", named ? json_integer(object) : json_null(), "shape",
        named ? rt_shape_name(rt_geometry_shape(&scene->geometry, object)) : NULL, "blocked",
        shadow ? json_boolean(object != RT_NO_OBJECT) : json_null(), "surface", met, "factor",
        (double)ray->factor, "total_internal_reflection", ray->total, "cut", ray->cut, "terms", terms,
        "light", color_json(ray->light), "counts", rt_json_tally(cost), "rays", json_array());
}

/* `nodes` has room for the rays. "tree" is the primary ray, with the rays that start at its hit as its member
 * "rays", and so on; null for an empty tree. */
static json_t *tree_json(const RtRayTree *tree, const RtTally *costs, json_t **nodes, const RtScene *scene,
                         const Options *o, const char *spec) {
    for (uint32_t i = 0; i < tree->count; i++) { /* parents come first */
        const uint32_t parent = tree->rays[i].parent;
        nodes[i] = ray_json(&tree->rays[i], &costs[i], scene);
        if (parent != RT_NO_RAY) json_array_append_new(json_object_get(nodes[parent], "rays"), nodes[i]);
    }
    return json_pack("{s:s, s:s, s:s, s:o, s:i, s:i, s:o, s:o}", "scene", o->scene, "accel", o->accel, "spec",
                     spec, "pixel", pixel_json(o), "depth", (int)tree->depth, "levels", (int)tree->levels,
                     "color", rt_cli_vector_json(tree->color), "tree",
                     tree->count > 0 ? nodes[0] : json_null());
}

/* ---- the command ---- */

/* `what` it is of the pixel, or "" for the ray of --ray itself: "ray tree", "primary ray". */
static void make_title(const Options *o, const RtScene *scene, const char *what, char *title, size_t size) {
    const char *name = scene->name[0] ? scene->name : o->scene;
    if (o->ray)
        snprintf(title, size, "%s: %s%sray %s", name, *what ? "the " : "", what, o->ray);
    else
        snprintf(title, size, "%s: the %s of pixel %u,%u of %u x %u", name, what, o->pixel.x, o->pixel.y,
                 scene->sampling.width, scene->sampling.height);
}

static RtStatus show_tree(const Options *o, const RtScene *scene, const RtRayTree *tree, const RtTally *costs,
                          json_t **nodes, const char *spec, RtError *error) {
    char title[512], what[64];
    snprintf(what, sizeof what, "ray tree, %u level%s,%s", o->depth, rt_plural(o->depth),
             o->ray ? " of " : "");
    make_title(o, scene, what, title, sizeof title);
    if (o->svg) RT_TRY(rt_ray_tree_draw(tree, scene, title, o->svg, error));
    if (o->json) {
        rt_cli_print_json(tree_json(tree, costs, nodes, scene, o, spec));
        return RT_OK;
    }
    printf("%s\n%s\n", spec, title);
    print_tree(tree, costs, scene, o->rows);
    if (o->svg) printf("wrote %s\n", o->svg);
    return RT_OK;
}

/* The counts of each ray of the tree are those of the ray traced on its own. */
static RtStatus trace_tree(const Options *o, const RtScene *scene, RtAccel *accel, const char *spec,
                           RtError *error) {
    RT_OWNED(RtRayTree, tree, rt_ray_tree_clear);
    RT_ARENA(arena);
    RT_TRY(o->ray
               ? rt_ray_tree_trace_given(&tree, accel, &o->given, o->depth, error)
               : rt_ray_trees_trace(&tree, accel, &(RtSample){o->pixel.x, o->pixel.y}, 1, o->depth, error));
    RtTally *costs = rt_arena_alloc(&arena, tree.count, sizeof(RtTally));
    json_t **nodes = rt_arena_alloc(&arena, tree.count, sizeof(void *));
    RT_TRY(rt_arena_check(&arena, "the counts of rays", error));
    for (uint32_t i = 0; i < tree.count; i++) {
        RT_OWNED(RtPath, path, rt_path_clear);
        RT_TRY(rt_path_trace(&path, accel, &tree.rays[i].ray, error));
        costs[i] = path.tally;
    }
    return show_tree(o, scene, &tree, costs, nodes, spec, error);
}

static RtStatus trace_path(const Options *o, const RtScene *scene, RtAccel *accel, const char *spec,
                           RtError *error) {
    char title[512], what[64] = "";
    RtRay ray = o->given;
    RT_OWNED(RtPath, path, rt_path_clear);
    if (!o->ray) RT_TRY(rt_path_ray(accel, o->kind, o->pixel.x, o->pixel.y, o->light, &ray, error));
    RT_TRY(rt_path_trace(&path, accel, &ray, error));
    if (!o->ray) snprintf(what, sizeof what, "%s ray", rt_ray_kind_name(o->kind));
    make_title(o, scene, what, title, sizeof title);
    if (o->svg) RT_TRY(rt_path_draw(&path, scene, title, o->accel, o->svg, error));
    if (o->json) {
        rt_cli_print_json(path_json(&path, o, spec));
        return RT_OK;
    }
    printf("%s\n", spec);
    print_path(&path, o, title, &scene->geometry);
    if (o->svg) printf("wrote %s\n", o->svg);
    return RT_OK;
}

static RtStatus run(Options *o, RtError *error) {
    RtSpec spec;
    char text[RT_MAX_SPEC_CHARS];
    RT_OWNED(RtScene, scene, rt_scene_clear);
    RT_OWNED(RtAccel *, accel, rt_accel_destroy_at);
    RT_TRY(rt_spec_parse(o->accel, &spec, error));
    rt_spec_format(&spec, text);
    if (o->json) RT_TRY(rt_cli_check_json_name(o->scene, error));
    RT_TRY(rt_cli_open_scene(o->scene, &scene, error));
    RT_TRY(rt_scene_sample(&scene, o->size[0], o->size[1], 1, false, error));
    if (o->pixel.given) RT_TRY(rt_cli_check_pixel(&scene.sampling, o->pixel, error));
    if (o->ray) RT_TRY(rt_cli_ray(o->ray, &o->given, error));
    if (o->kind == RT_RAY_SHADOW) o->given.kind = RT_RAY_OCCLUSION;
    RT_TRY(rt_accel_build(&spec, &scene, 0, &accel, error));
    rt_cli_tell_idle(o->accel, accel);
    RT_TRY(rt_path_available(accel, text, error));
    return (o->depth > 0 ? trace_tree : trace_path)(o, &scene, accel, text, error);
}

const RtSyntax rt_trace_syntax = {
    .options = options,
    .plugins = true,
    RT_ONE_SCENE,
    .finish = finish,
    .help =
        "Follow one ray through an accelerator: each step, extent test and object test, in order. With "
        "--depth, follow the whole ray tree of a pixel.\v"
        "A row shows what was visited or tested, the interval of t in which the ray is inside its box (if it "
        "has one), whether the ray hit the extent or the object, and the t of the nearest hit so far. An "
        "extent that the ray enters beyond that hit counts as missed. A step is a visit to a node, voxel, "
        "sample or list entry; docs/guide/tables.md explains the other terms. A csg test shows all intervals "
        "of t in which the ray is inside the solid, a csg result those of an operation, which joins the last "
        "two lists (through a plugin they are not seen); the row of the tree follows. A line below the test "
        "of a polygon shows where its plane is met, in the coordinate plane of the projection, and how many "
        "edges a half-line from there along the first axis crosses: if odd, it is a hit. The rows come from "
        "the counted kernel itself; raytally checks that they add up to its tally.\n\n"
        "The upper part of the drawing is a section along the ray and one axis of the scene; it shows boxes "
        "where the ray passes through them, pale if not tested or visited. It is enlarged where objects are "
        "tested; an inset shows the whole path. The bars below show where the ray is in each box, in the "
        "order of the rows.\n\n"
        "The ray tree has the primary ray, and for each hit a shadow ray to every light that shines on that "
        "side of the surface, a reflection and a transmission ray. A row shows the t and the object of its "
        "hit; factor, the product of the coefficients kr and kt on the way from the eye; and the "
        "accelerator's counts. A second table shows the light that each ray contributes to the pixel's "
        "colour, and the five terms of the illumination model that add up to it. The drawing shows the rays "
        "in a section that contains the primary ray and lies as close to the others as possible.\n\n"
        "Examples:\n"
        "  raytally trace balls --pixel 256,256\n"
        "  raytally trace balls --pixel 256,256 --accel grid:density=1 --svg path.svg\n"
        "  raytally trace balls --pixel 256,400 --accel light:cells=40+octree \\\n"
        "    --rays shadow --light 1\n"
        "  raytally trace scenes/lecture.yaml --pixel 279,366 --depth 4 --svg tree.svg\n"
        "  raytally trace balls --ray 2,2,2,-1,-1,-1.5 --accel grid\n\n"
        "embree counts no steps, so none are shown; with mode=user object tests are. A plugin's steps and "
        "extent tests have boxes only if it calls raytally_show (raytally/accel.h)."};

RtStatus rt_command_trace(int argc, char **argv, RtError *error) {
    Options o = {.accel = rt_accel_default(), .rows = DEFAULT_ROWS};
    rt_cli_parse(&rt_trace_syntax, argc, argv, &o);
    return run(&o, error);
}
