/* SPDX-License-Identifier: Apache-2.0 */
/* Wavefront OBJ: vertices, vertex normals and polygons. Texture coordinates are counted only, to check their
 * indices. Statements about names, materials, points and lines are skipped. Others are rejected: they are
 * curved surfaces, or damage. The format has no end mark and no counts, so a file that was cut off behind a
 * line break cannot be told from a whole one. */
#include "core/scene/mesh.h"

#include <inttypes.h>

/* Takes what is left of the line, which must be numbers; *last is the last of them. */
static RtStatus take_numbers(RtMeshReader *r, uint32_t *count, float *last) {
    *count = 0;
    for (RtWord word; rt_mesh_more(r, &word); ++*count) RT_TRY(rt_mesh_float(r, word, last));
    return RT_OK;
}

/* A fourth number is a weight, which must be 1; more are a colour. */
static RtStatus read_vertex(RtMeshReader *r) {
    RtVec3 vertex;
    uint32_t more;
    float last;
    RT_TRY(rt_mesh_take_vector(r, false, "the x y z of a vertex", &vertex));
    RT_TRY(take_numbers(r, &more, &last));
    if (more == 1 && last != 1)
        return rt_mesh_fail(r, "the vertex has a weight of %g: only 1 can be read", (double)last);
    return rt_mesh_add_vertex(r, vertex);
}

static RtStatus read_normal(RtMeshReader *r) {
    RtVec3 normal;
    uint32_t more;
    float last;
    RT_TRY(rt_mesh_take_vector(r, false, "the x y z of a normal", &normal));
    RT_TRY(take_numbers(r, &more, &last));
    if (more > 0) return rt_mesh_fail(r, "a normal has 3 numbers, this one has %u", 3 + more);
    return rt_mesh_add_normal(r, normal);
}

static RtStatus read_texture(RtMeshReader *r) {
    uint32_t count;
    float last;
    r->texture_count++;
    return take_numbers(r, &count, &last);
}

/* Positive indices count from 1, negative ones from the latest, which is -1. */
static RtStatus resolve(const RtMeshReader *r, RtWord part, const char *what, uint32_t count, uint32_t *out) {
    int64_t index = 0;
    RT_TRY(rt_mesh_integer(r, part, &index));
    const int64_t from_start = index < 0 ? count + index : index - 1;
    if (from_start < 0 || from_start >= count)
        return rt_mesh_fail(r, "the face names %s %" PRId64 ", but there are %u so far", what, index, count);
    *out = (uint32_t)from_start;
    return RT_OK;
}

/* "v", "v/vt", "v//vn" or "v/vt/vn". */
static RtStatus read_corner(RtMeshReader *r, RtWord word) {
    const uint32_t counts[3] = {r->vertex_count, r->texture_count, r->normal_count};
    static const char *const names[3] = {"vertex", "texture coordinate", "normal"};
    uint32_t index[3] = {0, 0, RT_NO_NORMAL};
    const char *at = word.text, *end = at + word.length;
    for (int field = 0; field < 3; field++) {
        RtWord part = {.text = at, .line = word.line};
        while (at < end && *at != '/') at++;
        part.length = (size_t)(at - part.text);
        if (part.length > 0)
            RT_TRY(resolve(r, part, names[field], counts[field], &index[field]));
        else if (field != 1 || at == end)
            break;
        if (at == end) return rt_mesh_add_corner(r, (RtMeshCorner){index[0], index[2]});
        at++;
    }
    return rt_scan_fail(&r->text, word, "v, v/vt, v//vn or v/vt/vn");
}

static RtStatus read_face(RtMeshReader *r) {
    for (RtWord word; rt_mesh_more(r, &word);) RT_TRY(read_corner(r, word));
    return rt_mesh_add_polygon(r);
}

static RtStatus read_statement(RtMeshReader *r, RtWord word) {
    static const char *const skipped[] = {"o",        "g",        "s",  "mg",         "usemtl",   "mtllib",
                                          "usemap",   "maplib",   "p",  "l",          "bevel",    "lod",
                                          "c_interp", "d_interp", "vp", "shadow_obj", "trace_obj"};
    if (rt_scan_is(word, "v")) return read_vertex(r);
    if (rt_scan_is(word, "vn")) return read_normal(r);
    if (rt_scan_is(word, "vt")) return read_texture(r);
    if (rt_scan_is(word, "f")) return read_face(r);
    for (size_t i = 0; i < sizeof skipped / sizeof skipped[0]; i++) {
        if (!rt_scan_is(word, skipped[i])) continue;
        rt_scan_skip_line(&r->text);
        return RT_OK;
    }
    return rt_scan_fail(&r->text, word, "a statement of a polygon mesh (v vn vt f g o s usemtl ...)");
}

RtStatus rt_mesh_read_obj(RtMeshReader *r) {
    r->text.joins = true;
    for (;;) {
        const RtWord word = rt_scan_peek(&r->text);
        if (word.length == 0) return rt_mesh_end(r);
        rt_scan_take(&r->text, word); /* the first of its line, because statements take whole lines */
        RT_TRY(read_statement(r, word));
    }
}
