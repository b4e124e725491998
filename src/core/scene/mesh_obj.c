/* SPDX-License-Identifier: Apache-2.0 */
/* Wavefront OBJ: vertices, vertex normals and polygons. Texture coordinates are read if the mesh is textured,
 * else counted, to check their indices. A material counts if it has an image (mesh_mtl.c). Names are skipped;
 * points, lines, curves, surfaces and unknown words with a warning. Faces may stand before their vertices:
 * the first that does has all later vertices read. The format has no end mark and no counts, so a file that
 * was cut off behind a line break cannot be told from a whole one. */
#include "core/scene/mesh.h"

#include <inttypes.h>

typedef enum List { VERTEX, TEXTURE, NORMAL, LISTS } List;

typedef struct Obj {
    RtMeshReader *mesh;
    bool ahead;             /* all vertices and normals have been read */
    uint32_t before[LISTS]; /* how many stand before the current line, from which negative indices count */
    uint32_t textures;      /* in the file so far, or with `ahead` in all of it */
    uint32_t plain;         /* the material of what has none with an image */
    uint32_t own;           /* the first of the file's own */
} Obj;

static uint32_t count_of(const Obj *obj, List list) {
    return list == VERTEX    ? obj->mesh->vertex_count
           : list == TEXTURE ? obj->textures
                             : obj->mesh->normal_count;
}

/* Takes what is left of the line; *count is the number of its words, *last the last of them. */
static void take_rest(RtMeshReader *r, uint32_t *count, RtWord *last) {
    *count = 0;
    for (RtWord word; rt_mesh_more(r, &word); ++*count) *last = word;
}

/* A fourth number is a weight; more are a colour. */
static RtStatus read_vertex(RtMeshReader *r) {
    RtVec3d vertex;
    RtWord last;
    uint32_t more;
    float weight;
    RT_TRY(rt_mesh_take_vertex(r, false, &vertex));
    take_rest(r, &more, &last);
    if (more == 1 && !(rt_scan_float(last, &weight) && weight == 1))
        RT_TRY(rt_mesh_warn(r, "a vertex has a weight, which only curves use: it is ignored"));
    return rt_mesh_add_vertex(r, vertex);
}

/* A number that is not finite makes the normal unusable. */
static RtStatus read_normal(RtMeshReader *r) {
    RtVec3 normal;
    RtWord word;
    uint32_t more;
    for (int a = 0; a < 3; a++) {
        RT_TRY(rt_mesh_take(r, false, "the x y z of a normal", &word));
        if (!rt_scan_float(word, &normal.at[a])) normal.at[a] = NAN;
    }
    take_rest(r, &more, &word);
    if (more > 0) RT_TRY(rt_mesh_warn(r, "a normal has more than 3 numbers: the others are ignored"));
    return rt_mesh_add_normal(r, normal);
}

static RtStatus read_uv(RtMeshReader *r) {
    RtUv uv = {NAN, 0};
    RtWord word;
    if (!rt_mesh_more(r, &word) || !rt_scan_float(word, &uv.u)) uv.u = NAN;
    if (rt_mesh_more(r, &word) && !rt_scan_float(word, &uv.v)) uv.v = NAN;
    rt_scan_skip_line(&r->text);
    return rt_mesh_add_uv(r, uv);
}

static RtStatus read_listed(Obj *obj, List list) {
    obj->before[list]++;
    obj->textures += list == TEXTURE && !obj->ahead;
    if (obj->ahead || (list == TEXTURE && !obj->mesh->textured)) {
        rt_scan_skip_line(&obj->mesh->text);
        return RT_OK;
    }
    return list == VERTEX    ? read_vertex(obj->mesh)
           : list == TEXTURE ? read_uv(obj->mesh)
                             : read_normal(obj->mesh);
}

/* Reads the vertices and normals of the rest of the file, for a face that stands before them. */
static RtStatus read_ahead(Obj *obj) {
    const RtScanner here = obj->mesh->text;
    Obj later = {.mesh = obj->mesh, .textures = obj->textures};
    for (RtWord word = rt_scan_peek(&obj->mesh->text); word.length > 0;
         word = rt_scan_peek(&obj->mesh->text)) {
        const bool first = obj->mesh->text.fresh;
        rt_scan_take(&obj->mesh->text, word);
        if (first && rt_scan_is(word, "v"))
            RT_TRY(read_listed(&later, VERTEX));
        else if (first && rt_scan_is(word, "vn"))
            RT_TRY(read_listed(&later, NORMAL));
        else if (first && rt_scan_is(word, "vt"))
            RT_TRY(read_listed(&later, TEXTURE));
        else
            rt_scan_skip_line(&obj->mesh->text);
    }
    obj->textures = later.textures;
    obj->ahead = true;
    obj->mesh->text = here;
    return RT_OK;
}

/* Positive indices count from 1, negative ones from the latest, which is -1. Textures and normals may be
 * missing. */
static RtStatus resolve(Obj *obj, int64_t index, List list, uint32_t *out) {
    static const char *const names[LISTS] = {"vertex", "texture coordinate", "normal"};
    RtMeshReader *r = obj->mesh;
    const int64_t from_start = index < 0 ? obj->before[list] + index : index - 1;
    if (from_start >= count_of(obj, list) && !obj->ahead) RT_TRY(read_ahead(obj));
    if (from_start >= 0 && from_start < count_of(obj, list)) {
        *out = (uint32_t)from_start;
        return RT_OK;
    }
    if (list == VERTEX)
        return rt_mesh_fail(r, "the face names %s %" PRId64 ", but there are %u (counted from 1)",
                            names[list], index, count_of(obj, list));
    *out = RT_MESH_NONE;
    return rt_mesh_warn(r,
                        "a face names a normal or texture coordinate that does not exist (%s %" PRId64
                        "): it goes without",
                        names[list], index);
}

/* "v", "v/vt", "v//vn" or "v/vt/vn"; a slash behind the first two is nothing. */
static RtStatus read_corner(Obj *obj, RtWord word) {
    uint32_t indices[LISTS] = {0, RT_MESH_NONE, RT_MESH_NONE};
    const char *const end = word.text + word.length;
    RtWord part = {.text = word.text};
    for (List list = VERTEX; list < LISTS; list++) {
        int64_t index;
        const char *at = rt_scan_integer(part.text, &index);
        if (at < end && *at != '/') {
            while (part.text + part.length < end && part.text[part.length] != '/') part.length++;
            return rt_scan_fail(&obj->mesh->text, part, "an integer");
        }
        if (at > part.text)
            RT_TRY(resolve(obj, index, list, &indices[list]));
        else if (list == VERTEX)
            break;
        if (at == end) {
            const RtMeshCorner corner = {indices[VERTEX], indices[NORMAL], indices[TEXTURE]};
            return rt_mesh_add_corner(obj->mesh, corner);
        }
        part.text = at + 1;
    }
    return rt_scan_fail(&obj->mesh->text, word, "v, v/vt, v//vn or v/vt/vn");
}

static RtStatus read_face(Obj *obj) {
    for (RtWord word; rt_mesh_more(obj->mesh, &word);) RT_TRY(read_corner(obj, word));
    return rt_mesh_add_polygon(obj->mesh);
}

/* Takes what is left of the line, blanks in it included. */
static RtWord take_line(RtScanner *text) {
    RtWord line = {.text = text->at};
    while (*line.text == ' ' || *line.text == '\t') line.text++;
    line.length = strcspn(line.text, "\r\n");
    text->at = line.text + line.length;
    while (line.length > 0 && strchr(" \t", line.text[line.length - 1])) line.length--;
    return line;
}

/* Reads the materials, unless the scene gives the mesh a texture. */
static RtStatus read_library(Obj *obj) {
    RtMeshReader *r = obj->mesh;
    const RtMaterial plain = r->scene->materials[obj->plain];
    const RtWord name = take_line(&r->text);
    if (plain.texture.kind != RT_TEXTURE_NONE) return RT_OK;
    RT_TRY(rt_mesh_read_mtl(r, name, &plain));
    if (r->textured && obj->textures > r->uv_count)
        RT_TRY(rt_mesh_warn(r, "mtllib stands behind texture coordinates: its images are left out"));
    r->textured = r->textured && obj->textures == r->uv_count;
    return RT_OK;
}

/* Only those with an image are in the scene. */
static void use_material(Obj *obj) {
    RtMeshReader *r = obj->mesh;
    const RtWord line = take_line(&r->text);
    char name[RT_MAX_NAME];
    snprintf(name, sizeof name, "%.*s", (int)(line.length < RT_MAX_NAME ? line.length : RT_MAX_NAME),
             line.text);
    r->material = obj->plain;
    for (uint32_t i = obj->own; i < r->scene->material_count && r->textured; i++)
        if (strcmp(r->scene->materials[i].name, name) == 0) r->material = i;
}

static bool is_among(RtWord word, const char *const *names) {
    while (*names && !rt_scan_is(word, *names)) names++;
    return *names != NULL;
}

static RtStatus read_statement(Obj *obj, RtWord word) {
    static const char *const names[] = {"o", "g", "usemap", "maplib", NULL};
    static const char *const unused[] = {"s", "mg", "lod", "bevel", "c_interp", "d_interp", "vp", NULL};
    static const char *const lines[] = {"p", "l", NULL};
    static const char *const curved[] = {"cstype", "deg",  "bmat",  "step",       "curv",      "curv2",
                                         "surf",   "parm", "trim",  "hole",       "scrv",      "sp",
                                         "end",    "con",  "ctech", "stech",      "bsp",       "bzp",
                                         "cdc",    "cdp",  "res",   "shadow_obj", "trace_obj", NULL};
    RtMeshReader *r = obj->mesh;
    char shown[RT_WORD_SHOWN];
    if (rt_scan_is(word, "v")) return read_listed(obj, VERTEX);
    if (rt_scan_is(word, "vn")) return read_listed(obj, NORMAL);
    if (rt_scan_is(word, "vt")) return read_listed(obj, TEXTURE);
    if (rt_scan_is(word, "f") || rt_scan_is(word, "fo")) return read_face(obj);
    if (rt_scan_is(word, "mtllib")) return read_library(obj);
    if (rt_scan_is(word, "usemtl")) {
        use_material(obj);
        return RT_OK;
    }
    if (is_among(word, lines))
        RT_TRY(rt_mesh_warn(r, "points and lines are left out"));
    else if (is_among(word, curved))
        RT_TRY(rt_mesh_warn(r, "curves and curved surfaces are left out (%.*s): export them as polygons",
                            (int)word.length, word.text));
    else if (!is_among(word, names) && !is_among(word, unused))
        RT_TRY(
            rt_mesh_warn(r, "a statement that is not of meshes is left out: %s", rt_scan_show(word, shown)));
    r->text.joins = !is_among(word, names); /* they may be paths of Windows, and end in a backslash */
    rt_scan_skip_line(&r->text);
    r->text.joins = true;
    return RT_OK;
}

RtStatus rt_mesh_read_obj(RtMeshReader *r) {
    Obj obj = {.mesh = r, .plain = r->material, .own = r->scene->material_count};
    r->text.joins = true;
    r->given_back = r->text.at;
    RT_TRY(rt_mesh_begin_text(r));
    for (;;) {
        const RtWord word = rt_scan_peek(&r->text);
        if (word.length == 0) return rt_mesh_end(r);
        rt_scan_take(&r->text, word); /* the first of its line, because statements take whole lines */
        RT_TRY(read_statement(&obj, word));
    }
}
