/* SPDX-License-Identifier: Apache-2.0 */
/* Polygons are split into a fan around their first corner if it sees all others, else by cutting off ears
 * (Meisters 1975): corners whose triangle is inside the polygon. */
#include "core/scene/mesh.h"

#include "core/base/memory.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

RtStatus rt_mesh_fail_short(const RtMeshReader *r, uint64_t count, uint64_t declared, const char *things) {
    return rt_mesh_fail(r, "the file ends after %" PRIu64 " of the %" PRIu64 " %s that its header declares",
                        count, declared, things);
}

/* ---- vertices ---- */

RtStatus rt_mesh_add_vertex(RtMeshReader *r, RtVec3 vertex) {
    if (!rt_finite(vertex))
        return rt_mesh_fail(r, "vertex %u (counted from 0) is not finite: (%g, %g, %g)", r->vertex_count,
                            (double)vertex.x, (double)vertex.y, (double)vertex.z);
    return rt_append(&r->vertices, &r->vertex_count, &r->vertex_capacity, &vertex, sizeof vertex,
                     r->text.error);
}

RtStatus rt_mesh_add_normal(RtMeshReader *r, RtVec3 normal) {
    return rt_append(&r->normals, &r->normal_count, &r->normal_capacity, &normal, sizeof normal,
                     r->text.error);
}

RtStatus rt_mesh_add_corner(RtMeshReader *r, RtMeshCorner corner) {
    return rt_append(&r->corners, &r->corner_count, &r->corner_capacity, &corner, sizeof corner,
                     r->text.error);
}

RtStatus rt_mesh_add_index(RtMeshReader *r, double index) {
    if (!(index >= 0 && index < r->vertex_count && index == floor(index)))
        return rt_mesh_fail(r, "face %u names vertex %.15g, but there are %u vertices (all counted from 0)",
                            r->face_count, index, r->vertex_count);
    const uint32_t vertex = (uint32_t)index;
    return rt_mesh_add_corner(r, (RtMeshCorner){vertex, r->normal_count ? vertex : RT_NO_NORMAL});
}

/* ---- polygons ---- */

/* True if the transform turns the surface inside out: then the order of vertices is reversed and normals,
 * which transform by cofactors, change sign. */
static bool is_mirror(const RtTransform *t) {
    RtVec3d x = rt_transform_column(t, 0), y = rt_transform_column(t, 1), z = rt_transform_column(t, 2);
    return rt_dotd(rt_crossd(x, y), z) < 0;
}

static RtStatus add_triangle(RtMeshReader *r, const RtMeshCorner corners[3]) {
    RtVec3 vertices[3], normals[3];
    const bool mirror = is_mirror(&r->transform);
    bool has_normals = true;
    for (int i = 0; i < 3; i++) {
        const RtMeshCorner corner = corners[mirror ? 2 - i : i];
        vertices[i] = rt_transform_point(&r->transform, r->vertices[corner.vertex]);
        has_normals = has_normals && corner.normal != RT_NO_NORMAL;
        if (!has_normals) continue;
        const RtVec3 normal = r->normals[corner.normal];
        normals[i] = rt_transform_normal(&r->transform, mirror ? rt_scale(normal, -1) : normal);
        has_normals = rt_finite(normals[i]) && rt_lengthd(rt_widen(normals[i])) > 0;
    }
    const RtStatus status =
        rt_scene_add_triangle(r->scene, r->material, vertices, has_normals ? normals : NULL, r->text.error);
    if (status == RT_OK) return RT_OK;
    char face[48];
    snprintf(face, sizeof face, "face %u (counted from 0): ", r->face_count);
    return rt_scan_place(&r->text, status, r->text.last, face);
}

static RtVec3d vertex_of(const RtMeshReader *r, uint32_t corner) {
    return rt_widen(r->vertices[r->corners[corner].vertex]);
}

/* Twice the area of a triangle of three corners, as a vector. */
static RtVec3d twice_area(const RtMeshReader *r, uint32_t a, uint32_t b, uint32_t c) {
    return rt_area_vector(vertex_of(r, a), vertex_of(r, b), vertex_of(r, c));
}

/* Whether no triangle of the fan around the first corner has the wrong orientation; all have no area if the
 * whole has none. */
static bool first_sees_all(const RtMeshReader *r, RtVec3d whole) {
    const bool flat = rt_dotd(whole, whole) == 0;
    for (uint32_t i = 1; i + 1 < r->corner_count; i++) {
        const RtVec3d area = twice_area(r, 0, i, i + 1);
        if (flat ? rt_dotd(area, area) > 0 : rt_dotd(whole, area) < 0) return false;
    }
    return true;
}

/* Whether corner `i` lies in the triangle or on its edge. Keyhole polygons visit a point twice, so the points
 * of the triangle itself do not count. */
static bool is_inside(const RtMeshReader *r, RtVec3d whole, const uint32_t triangle[3], uint32_t i) {
    const RtVec3 v = r->vertices[r->corners[i].vertex];
    for (int k = 0; k < 3; k++) {
        const RtVec3 at = r->vertices[r->corners[triangle[k]].vertex];
        if (v.x == at.x && v.y == at.y && v.z == at.z) return false;
        if (rt_dotd(whole, twice_area(r, triangle[k], triangle[(k + 1) % 3], i)) < 0) return false;
    }
    return true;
}

/* Whether corner `i` and its neighbours are an ear; or, with `flat`, a triangle of either orientation that is
 * a millionth of the polygon at most. */
static bool is_ear(const RtMeshReader *r, RtVec3d whole, uint32_t i, bool flat) {
    const uint32_t n = r->corner_count, ear[3] = {(i + n - 1) % n, i, (i + 1) % n};
    const double area = rt_dotd(whole, twice_area(r, ear[0], ear[1], ear[2]));
    if (flat) return fabs(area) <= 1e-6 * rt_dotd(whole, whole);
    if (area <= 0) return false;
    for (uint32_t other = 0; other < n; other++) {
        if (other != ear[0] && other != ear[1] && other != ear[2] && is_inside(r, whole, ear, other))
            return false;
    }
    return true;
}

static bool find_ear(const RtMeshReader *r, RtVec3d whole, uint32_t *ear) {
    const bool none = rt_dotd(whole, whole) == 0; /* the polygon crosses itself: its parts cancel out */
    for (int flat = 0; flat < 2 && !none; flat++) {
        for (*ear = 0; *ear < r->corner_count; ++*ear) {
            if (is_ear(r, whole, *ear, flat)) return true;
        }
    }
    return false;
}

static RtStatus cut_ears(RtMeshReader *r, RtVec3d whole) {
    enum { MOST = 1000 }; /* the time grows with the cube of the number, at worst */
    if (r->corner_count > MOST)
        return rt_mesh_fail(r,
                            "face %u (counted from 0) is concave and has %u corners, more than %d: split it",
                            r->face_count, r->corner_count, MOST);
    while (r->corner_count >= 3) {
        const uint32_t n = r->corner_count;
        uint32_t i;
        if (!find_ear(r, whole, &i))
            return rt_mesh_fail(r, "face %u (counted from 0) crosses itself: split it into triangles",
                                r->face_count);
        const RtMeshCorner ear[3] = {r->corners[(i + n - 1) % n], r->corners[i], r->corners[(i + 1) % n]};
        RT_TRY(add_triangle(r, ear));
        r->corner_count--;
        memmove(&r->corners[i], &r->corners[i + 1], (n - 1 - i) * sizeof *r->corners);
    }
    return RT_OK;
}

RtStatus rt_mesh_add_polygon(RtMeshReader *r) {
    if (r->corner_count < 3)
        return rt_mesh_fail(r, "face %u (counted from 0) has %u vertices: a polygon has at least 3",
                            r->face_count, r->corner_count);
    RtVec3d whole = {0, 0, 0};
    for (uint32_t i = 1; i + 1 < r->corner_count; i++) whole = rt_addd(whole, twice_area(r, 0, i, i + 1));
    if (!first_sees_all(r, whole)) RT_TRY(cut_ears(r, whole));
    for (uint32_t i = 1; i + 1 < r->corner_count; i++) {
        const RtMeshCorner triangle[3] = {r->corners[0], r->corners[i], r->corners[i + 1]};
        RT_TRY(add_triangle(r, triangle));
    }
    r->corner_count = 0;
    r->face_count++;
    return RT_OK;
}

/* ---- text formats ---- */

RtStatus rt_mesh_take(RtMeshReader *r, bool first, const char *wanted, RtWord *word) {
    *word = rt_scan_peek(&r->text);
    if (word->length == 0 || (word->first && !first))
        return rt_mesh_fail(r, "expected %s, found the end of the %s", wanted,
                            word->length ? "line" : "file");
    if (first && !word->first) return rt_scan_fail(&r->text, *word, "the end of the line");
    rt_scan_take(&r->text, *word);
    return RT_OK;
}

bool rt_mesh_more(RtMeshReader *r, RtWord *word) {
    *word = rt_scan_peek(&r->text);
    const bool more = word->length > 0 && !word->first;
    if (more) rt_scan_take(&r->text, *word);
    return more;
}

RtStatus rt_mesh_expect(RtMeshReader *r, const char *text) {
    const RtWord word = rt_scan_peek(&r->text);
    char wanted[64];
    snprintf(wanted, sizeof wanted, "'%s'", text);
    if (!rt_scan_is(word, text)) return rt_scan_fail(&r->text, word, wanted);
    rt_scan_take(&r->text, word);
    return RT_OK;
}

RtStatus rt_mesh_float(const RtMeshReader *r, RtWord word, float *out) {
    if (rt_scan_float(word, out)) return RT_OK;
    return rt_scan_fail(&r->text, word, "a finite number that fits float32");
}

RtStatus rt_mesh_integer(const RtMeshReader *r, RtWord word, int64_t *out) {
    enum { MOST = 18 };
    const size_t sign = *word.text == '-' || *word.text == '+';
    int64_t value = 0;
    if (word.length == sign || word.length - sign > MOST) return rt_scan_fail(&r->text, word, "an integer");
    for (size_t i = sign; i < word.length; i++) {
        if (word.text[i] < '0' || word.text[i] > '9') return rt_scan_fail(&r->text, word, "an integer");
        value = value * 10 + (word.text[i] - '0');
    }
    *out = *word.text == '-' ? -value : value;
    return RT_OK;
}

RtStatus rt_mesh_take_vector(RtMeshReader *r, bool first, const char *wanted, RtVec3 *out) {
    RtWord word;
    for (int a = 0; a < 3; a++) {
        RT_TRY(rt_mesh_take(r, first && a == 0, wanted, &word));
        RT_TRY(rt_mesh_float(r, word, &out->at[a]));
    }
    return RT_OK;
}

RtStatus rt_mesh_end(RtMeshReader *r) {
    const RtWord word = rt_scan_peek(&r->text);
    if (word.length > 0) return rt_scan_fail(&r->text, word, "the end of the file");
    if (word.first) return RT_OK;
    return rt_mesh_fail(r,
                        "the last line has no line break, so its end may be missing: add a line break if the "
                        "file is complete");
}
