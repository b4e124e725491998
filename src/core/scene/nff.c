/* SPDX-License-Identifier: Apache-2.0 */
/* An NFF file is read whole and split into words; line ends matter only for the optional colour of
 * a light and for comments. Behind the file there is a 0, where strtof stops. Counts declared by the file are
 * checked against its remaining length before memory is allocated. */
#include "core/scene/nff.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/text/scanner.h"

#include <ctype.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

typedef struct Reader {
    RtScanner text;
    size_t statement; /* line of the keyword being read */
    RtScene *scene;
    uint32_t material; /* of what follows */
    uint32_t vertex_capacity, normal_capacity, plain_count, plain_capacity;
    RtVec3 *vertices, *normals; /* of one polygon */
    uint32_t *plain;            /* [plain_count] indices of lights without a colour */
} Reader;

#define NO_MATERIAL UINT32_MAX

/* Fails at the line of the statement. */
#define fail_statement(r, ...) rt_fail_at((r)->text.error, (r)->text.path, (r)->statement, 0, __VA_ARGS__)

/* ---- words ---- */

/* Inside a statement: if the next statement or the end comes too soon, the position is the end of the text
 * so far. */
static RtStatus fail_inside(Reader *r, RtWord word, const char *wanted) {
    bool too_soon = word.length == 0 || isalpha((unsigned char)word.text[0]);
    if (too_soon) r->text.line = r->text.last;
    return rt_scan_fail(&r->text, word, wanted);
}

/* Adds the line of the statement to a message of the scene. */
static RtStatus located(Reader *r, RtStatus status) {
    return rt_scan_place(&r->text, status, r->statement, "");
}

/* ---- numbers ---- */

/* Numbers, or rows of `places` x y z and a number, which lie in the scene. */
static RtStatus read_numbers(Reader *r, const char *what, int count, bool places, float *out) {
    char wanted[128];
    snprintf(wanted, sizeof wanted, "%s: a finite number that fits float32", what);
    for (int i = 0; i < count; i++) {
        const RtWord word = rt_scan_peek(&r->text);
        if (!rt_scan_float(word, &out[i])) return fail_inside(r, word, wanted);
        const double offset = places && i % 4 < 3 ? r->scene->offset.at[i % 4] : 0;
        if (offset != 0) out[i] = (float)(strtod(word.text, NULL) - offset);
        rt_scan_take(&r->text, word);
    }
    return RT_OK;
}

static RtStatus read_floats(Reader *r, const char *what, int count, float *out) {
    return read_numbers(r, what, count, false, out);
}

static RtStatus read_places(Reader *r, const char *what, int count, float *out) {
    return read_numbers(r, what, count, true, out);
}

static RtStatus read_count(Reader *r, const char *what, uint32_t lo, uint32_t hi, uint32_t *out) {
    const RtWord word = rt_scan_peek(&r->text);
    char wanted[128], *end;
    const unsigned long long number = strtoull(word.text, &end, 10); /* reads blanks and signs, too */
    snprintf(wanted, sizeof wanted, "%s: a whole number %u..%u", what, lo, hi);
    if (!isdigit((unsigned char)*word.text) || end != word.text + word.length || number < lo || number > hi)
        return fail_inside(r, word, wanted);
    rt_scan_take(&r->text, word);
    *out = (uint32_t)number;
    return RT_OK;
}

/* Is there another word on this line that might be a number? */
static bool number_follows(Reader *r) {
    RtWord word = rt_scan_peek(&r->text);
    return word.length > 0 && !r->text.fresh && strchr("+-.0123456789", word.text[0]) != NULL;
}

/* ---- camera, lights, materials ---- */

/* Rejects a camera that could make no rays here, where its line is known. */
static RtStatus check_camera(Reader *r, const RtCamera *camera) {
    RtSampling sampling;
    RtView view;
    RT_TRY(located(r, rt_sampling_init(&sampling, camera->width, camera->height, 1, false, r->text.error)));
    return located(r, rt_view_init(&view, camera, sampling, r->text.error));
}

static RtStatus read_camera(Reader *r) {
    enum { FROM, AT, UP, ANGLE, HITHER, RESOLUTION, WORDS, REQUIRED = HITHER };
    static const char *const words[WORDS] = {"from", "at", "up", "angle", "hither", "resolution"};
    RtCamera *camera = &r->scene->camera;
    bool given[WORDS] = {false};
    for (;;) {
        RtWord next = rt_scan_peek(&r->text);
        int word = 0;
        while (word < WORDS && !rt_scan_is(next, words[word])) word++;
        if (word == WORDS) break;
        rt_scan_take(&r->text, next);
        given[word] = true;
        switch (word) {
        case FROM: RT_TRY(read_places(r, "from x y z", 3, camera->from.at)); break;
        case AT: RT_TRY(read_places(r, "at x y z", 3, camera->at.at)); break;
        case UP: RT_TRY(read_floats(r, "up x y z", 3, camera->up.at)); break;
        case ANGLE: RT_TRY(read_floats(r, "angle in degrees", 1, &camera->fov)); break;
        case HITHER: RT_TRY(read_floats(r, "hither", 1, &camera->near)); break;
        case RESOLUTION:
            RT_TRY(read_count(r, "resolution x", 1, RT_MAX_IMAGE_SIDE, &camera->width));
            RT_TRY(read_count(r, "resolution y", 1, RT_MAX_IMAGE_SIDE, &camera->height));
            break;
        }
    }
    for (int i = 0; i < REQUIRED; i++) {
        char wanted[64];
        snprintf(wanted, sizeof wanted, "'%s' of the camera (v: from, at, up, angle)", words[i]);
        if (!given[i]) return fail_inside(r, rt_scan_peek(&r->text), wanted);
    }
    if (camera->near < 0) return fail_statement(r, "hither is %g: expected at least 0", (double)camera->near);
    return check_camera(r, camera);
}

static RtStatus read_light(Reader *r) {
    RtVec3 position, color = {0, 0, 0};
    RT_TRY(read_places(r, "l x y z, the position of a light", 3, position.at));
    bool plain = !number_follows(r);
    if (plain)
        RT_TRY(rt_append(&r->plain, &r->plain_count, &r->plain_capacity, &r->scene->light_count,
                         sizeof(uint32_t), r->text.error));
    else
        RT_TRY(read_floats(r, "l x y z r g b, the colour of a light", 3, color.at));
    return located(r, rt_scene_add_light(r->scene, position, color, r->text.error));
}

RtMaterial rt_nff_material(const char *name, RtVec3 color, float kd, float ks, float shine, float t,
                           float ior) {
    RtMaterial material = {.color = color,
                           .ambient = RT_NFF_AMBIENT,
                           .diffuse = kd,
                           .specular = ks,
                           .shine = shine,
                           .reflection = ks,
                           .transmission = t,
                           .ior = ior == 0 && t == 0 ? 1 : ior};
    snprintf(material.name, sizeof material.name, "%s", name);
    return material;
}

static bool same_material(const RtMaterial *a, const RtMaterial *b) {
    return a->color.x == b->color.x && a->color.y == b->color.y && a->color.z == b->color.z &&
           a->diffuse == b->diffuse && a->specular == b->specular && a->shine == b->shine &&
           a->transmission == b->transmission && a->ior == b->ior;
}

static RtStatus read_material(Reader *r) {
    float f[8];
    RT_TRY(read_floats(r, "a number of f r g b Kd Ks shine T ior", 8, f));
    char name[RT_MAX_NAME];
    snprintf(name, sizeof name, "line %zu", r->statement);
    RtMaterial material = rt_nff_material(name, rt_vec3_load(f), f[3], f[4], f[5], f[6], f[7]);

    /* Files often switch between a few materials, and repeat each in full. */
    uint32_t count = r->scene->material_count;
    for (uint32_t i = count; i > 0 && count - i < 64; i--) {
        if (!same_material(&r->scene->materials[i - 1], &material)) continue;
        r->material = i - 1;
        return RT_OK;
    }
    return located(r, rt_scene_add_material(r->scene, &material, &r->material, r->text.error));
}

/* The current material; the default if there was no `f` yet. */
static RtStatus use_material(Reader *r) {
    if (r->material != NO_MATERIAL) return RT_OK;
    RtMaterial material = rt_default_material();
    return rt_scene_add_material(r->scene, &material, &r->material, r->text.error);
}

/* ---- objects ---- */

static RtStatus read_sphere(Reader *r) {
    float s[4];
    RT_TRY(read_places(r, "a number of s x y z radius", 4, s));
    RT_TRY(use_material(r));
    return located(r,
                   rt_scene_add_sphere(r->scene, r->material, rt_vec3_load(s), fabsf(s[3]), r->text.error));
}

static RtStatus read_cone(Reader *r) {
    float c[8];
    RT_TRY(read_places(r, "a number of c base.x y z base.radius apex.x y z apex.radius", 8, c));
    RT_TRY(use_material(r));
    return located(r, rt_scene_add_cone(r->scene, r->material, rt_vec3_load(c), fabsf(c[3]),
                                        rt_vec3_load(c + 4), fabsf(c[7]), r->text.error));
}

/* Reads n and the n vertices of a polygon, or of a patch with their normals. */
static RtStatus read_vertices(Reader *r, bool patch, uint32_t *count) {
    const char *what =
        patch ? "a number of a vertex and its normal, x y z nx ny nz" : "a number of a vertex x y z";
    *count = 0;
    RT_TRY(read_count(r, "the number of vertices", 3, UINT32_MAX, count));
    size_t least = patch ? 12 : 6; /* bytes of the shortest vertex, with blanks */
    size_t size = (size_t)(r->text.end - r->text.at) / least + 1;
    if (*count > size)
        return fail_statement(
            r, "the statement declares %u vertices, but the rest of the file holds at most %zu", *count,
            size);
    RT_TRY(rt_reserve(&r->vertices, &r->vertex_capacity, *count, sizeof(RtVec3), r->text.error));
    if (patch) RT_TRY(rt_reserve(&r->normals, &r->normal_capacity, *count, sizeof(RtVec3), r->text.error));
    for (uint32_t i = 0; i < *count; i++) {
        RT_TRY(read_places(r, what, 3, r->vertices[i].at));
        if (patch) RT_TRY(read_floats(r, what, 3, r->normals[i].at));
    }
    return use_material(r);
}

static RtStatus read_polygon(Reader *r) {
    uint32_t count;
    RT_TRY(read_vertices(r, false, &count));
    if (count > 3)
        return located(r, rt_scene_add_polygon(r->scene, r->material, r->vertices, count, r->text.error));
    RtTriangle triangle = {{r->vertices[0], r->vertices[1], r->vertices[2]}};
    if (rt_lengthd(rt_triangle_normal(&triangle)) == 0)
        return fail_statement(r,
                              "the polygon has no area: its vertices lie on a line or in a point; remove it");
    return located(r, rt_scene_add_triangle(r->scene, r->material, r->vertices, NULL, r->text.error));
}

static RtVec3d fan_area(const RtVec3 *v, uint32_t i) {
    return rt_area_vector(rt_widen(v[0]), rt_widen(v[i]), rt_widen(v[i + 1]));
}

/* A fan around the first vertex; no triangle may be oriented against the whole. */
static RtStatus read_patch(Reader *r) {
    uint32_t count;
    RT_TRY(read_vertices(r, true, &count));
    const RtVec3 *v = r->vertices, *n = r->normals;
    RtVec3d whole = {0, 0, 0};
    for (uint32_t i = 1; i + 1 < count; i++) whole = rt_addd(whole, fan_area(v, i));
    for (uint32_t i = 1; i + 1 < count; i++) {
        if (rt_dotd(whole, fan_area(v, i)) < 0)
            return fail_statement(
                r,
                "the patch is concave: vertex %u cannot be seen from the first; split the patch "
                "into triangles",
                i + 2);
    }
    for (uint32_t i = 1; i + 1 < count; i++) {
        const RtVec3 vertices[3] = {v[0], v[i], v[i + 1]}, normals[3] = {n[0], n[i], n[i + 1]};
        RT_TRY(located(r, rt_scene_add_triangle(r->scene, r->material, vertices, normals, r->text.error)));
    }
    return RT_OK;
}

/* ---- the file ---- */

static RtStatus read_background(Reader *r) {
    RtVec3 color;
    RT_TRY(read_floats(r, "a number of b r g b", 3, color.at));
    if (color.x < 0 || color.y < 0 || color.z < 0)
        return fail_statement(r,
                              "the background has a negative colour: expected at least 0 for each of r g b");
    r->scene->background = color;
    return RT_OK;
}

static RtStatus read_statement(Reader *r) {
    static const struct {
        const char *word;
        RtStatus (*read)(Reader *r);
    } statements[] = {{"v", read_camera}, {"b", read_background}, {"l", read_light},   {"f", read_material},
                      {"s", read_sphere}, {"c", read_cone},       {"p", read_polygon}, {"pp", read_patch}};
    RtWord word = rt_scan_peek(&r->text);
    r->statement = r->text.line;
    for (size_t i = 0; i < sizeof statements / sizeof statements[0]; i++) {
        if (!rt_scan_is(word, statements[i].word)) continue;
        rt_scan_take(&r->text, word);
        return statements[i].read(r);
    }
    return rt_scan_fail(&r->text, word, "a statement of NFF (v b l f s c p pp, or a # comment)");
}

static RtStatus read_file(Reader *r) {
    while (rt_scan_peek(&r->text).length > 0) RT_TRY(read_statement(r));
    for (uint32_t i = 0; i < r->plain_count; i++)
        r->scene->lights[r->plain[i]].intensity = rt_nff_light_intensity(r->scene->light_count);
    return RT_OK;
}

RtVec3 rt_nff_light_intensity(uint32_t count) {
    float i = (float)(sqrt((double)count) / (2.0 * count));
    return rt_vec3(i, i, i);
}

RtStatus rt_nff_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error) {
    (void)open_named;
    char *text;
    size_t size;
    RT_TRY(rt_file_read_text(path, RT_NFF_MAX_BYTES, &text, &size, error));
    RtError own;
    Reader reader = {
        .text = {.path = path, .error = error ? error : &own}, .scene = scene, .material = NO_MATERIAL};
    rt_scan_begin(&reader.text, text, size);
    RtStatus status = read_file(&reader);
    rt_free(reader.vertices);
    rt_free(reader.normals);
    rt_free(reader.plain);
    rt_free(text);
    return status;
}

/* ---- writing: an `f` wherever the material changes ---- */

/* 9 digits restore every float32. */
static void put(FILE *file, float number) {
    fprintf(file, " %.9g", (double)number);
}

static void put_vector(FILE *file, const char *before, RtVec3 v) {
    fputs(before, file);
    for (int a = 0; a < 3; a++) put(file, v.at[a]);
}

static void save_header(const RtScene *scene, FILE *file) {
    const RtCamera *camera = &scene->camera;
    put_vector(file, "b", scene->background);
    put_vector(file, "\nv\nfrom", camera->from);
    put_vector(file, "\nat", camera->at);
    put_vector(file, "\nup", camera->up);
    fprintf(file, "\nangle %.9g\nhither %.9g\nresolution %u %u\n", (double)camera->fov, (double)camera->near,
            camera->width, camera->height);
    for (uint32_t i = 0; i < scene->light_count; i++) {
        put_vector(file, "l", scene->lights[i].position);
        put_vector(file, "", scene->lights[i].intensity);
        fprintf(file, "\n");
    }
}

static void save_material(const RtMaterial *material, FILE *file) {
    put_vector(file, "f", material->color);
    fprintf(file, " %.9g %.9g %.9g %.9g %.9g\n", (double)material->diffuse, (double)material->reflection,
            (double)material->shine, (double)material->transmission, (double)material->ior);
}

static void save_polygon(const RtGeometry *g, uint32_t index, FILE *file) {
    const RtPolygon *polygon = &g->polygons[index];
    fprintf(file, "p %u", polygon->count);
    for (uint32_t i = 0; i < polygon->count; i++)
        put_vector(file, "\n", g->polygon_vertices[polygon->first + i]);
}

static void save_triangle(const RtGeometry *g, uint32_t index, FILE *file) {
    static const RtVertexNormals any = {{{0, 0, 1}, {0, 0, 1}, {0, 0, 1}}};
    const RtTriangle *triangle = &g->triangles[index];
    uint32_t entry = g->triangle_normals ? g->triangle_normals[index] : RT_NO_NORMALS;
    const RtVertexNormals *normals = entry != RT_NO_NORMALS ? &g->vertex_normals[entry] : NULL;
    if (!normals && rt_lengthd(rt_triangle_normal(triangle)) == 0) normals = &any;
    fprintf(file, normals ? "pp 3" : "p 3");
    for (int i = 0; i < 3; i++) {
        put_vector(file, "\n", triangle->v[i]);
        if (normals) put_vector(file, "", normals->n[i]);
    }
}

static void save_object(const RtGeometry *g, RtRef ref, FILE *file) {
    uint32_t index = rt_ref_index(ref);
    switch (rt_ref_shape(ref)) {
    case RT_SHAPE_SPHERE:
        put_vector(file, "s", g->spheres[index].center);
        put(file, g->spheres[index].radius);
        break;
    case RT_SHAPE_CONE:
        put_vector(file, "c", g->cones[index].base);
        put(file, g->cones[index].base_radius);
        put_vector(file, "\n", g->cones[index].apex);
        put(file, g->cones[index].apex_radius);
        break;
    case RT_SHAPE_POLYGON: save_polygon(g, index, file); break;
    case RT_SHAPE_TRIANGLE: save_triangle(g, index, file); break;
    case RT_SHAPE_INSTANCE: /* flattened earlier */
    case RT_SHAPE_CSG:      /* rejected earlier */
    case RT_SHAPE_COUNT: break;
    }
    fprintf(file, "\n");
}

RtStatus rt_nff_save(const RtScene *scene, FILE *file, RtError *error) {
    if (scene->geometry.csg_count > 0)
        return rt_fail(error, RT_BAD_INPUT, "NFF has no CSG trees, and in this scene there are %u",
                       scene->geometry.csg_count);
    save_header(scene, file);
    for (uint32_t id = 0; id < scene->geometry.object_count; id++) {
        if (id == 0 || scene->material_of[id] != scene->material_of[id - 1])
            save_material(&scene->materials[scene->material_of[id]], file);
        save_object(&scene->geometry, scene->geometry.objects[id], file);
        if (ferror(file)) return rt_fail(error, RT_IO, "NFF could not be written: %s", strerror(errno));
    }
    return RT_OK;
}
