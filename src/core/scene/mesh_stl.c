/* SPDX-License-Identifier: Apache-2.0 */
/* STL, binary or text. The normals of facets are ignored, because the order of the vertices,
 * counter-clockwise from outside, has the same information and is exact. */
#include "core/scene/mesh.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { HEADER = 80, FACET = 50 };

static uint64_t binary_size(const void *bytes) {
    return RT_MESH_HEAD + (uint64_t)FACET * rt_mesh_u32((const char *)bytes + HEADER);
}

/* The first word of a text, behind blanks and a byte-order mark. */
static bool begins_with_solid(const unsigned char *bytes) {
    if (memcmp(bytes, "\xEF\xBB\xBF", 3) == 0) bytes += 3;
    while (*bytes == ' ' || (*bytes >= '\t' && *bytes <= '\r')) bytes++;
    return strncasecmp((const char *)bytes, "solid", 5) == 0;
}

/* A binary file may begin with "solid", too: its size decides. A few bytes may follow. */
static bool is_binary(const void *bytes, uint64_t size) {
    return size >= RT_MESH_HEAD && size >= binary_size(bytes) &&
           size - binary_size(bytes) < RT_MESH_FEW_BYTES;
}

RtStatus rt_mesh_check_stl(RtMeshReader *r, const RtMeshHead *head) {
    const bool zeros = memchr(head->bytes, 0, head->size < RT_MESH_HEAD ? (size_t)head->size : RT_MESH_HEAD);
    if (is_binary(head->bytes, head->size)) return RT_OK;
    if (begins_with_solid(head->bytes) && (!zeros || head->size < RT_MESH_HEAD)) return RT_OK;
    if (head->size < RT_MESH_HEAD || !zeros)
        return rt_mesh_fail(r,
                            "this is no STL file: it does not begin with 'solid', and has no binary header");
    return rt_mesh_fail(r,
                        "the header declares %u triangles, which take %" PRIu64
                        " bytes, but the file has %" PRIu64 ": it is cut off or damaged",
                        rt_mesh_u32(head->bytes + HEADER), binary_size(head->bytes), head->size);
}

/* Adds the triangle of the last three vertices, and removes them. */
static RtStatus add_facet(RtMeshReader *r) {
    for (int k = 0; k < 3; k++) RT_TRY(rt_mesh_add_index(r, k));
    RT_TRY(rt_mesh_add_polygon(r));
    r->vertex_count = 0;
    return RT_OK;
}

static RtStatus read_binary(RtMeshReader *r) {
    uint32_t left = rt_mesh_u32(r->text.at + HEADER);
    for (r->text.at += RT_MESH_HEAD; left > 0; left--) {
        for (size_t k = 0; k < 3; k++)
            RT_TRY(rt_mesh_add_vertex(r, rt_widen(rt_mesh_vector(r->text.at + 12 + 12 * k))));
        r->text.at += FACET;
        RT_TRY(add_facet(r));
    }
    return rt_mesh_end_binary(r);
}

/* "endloop", or "end loop" */
static RtStatus expect_end(RtMeshReader *r, const char *of) {
    char whole[16];
    snprintf(whole, sizeof whole, "end%s", of);
    const bool apart = rt_scan_is_like(rt_scan_peek(&r->text), "end");
    if (apart) RT_TRY(rt_mesh_expect(r, "end"));
    return rt_mesh_expect(r, apart ? of : whole);
}

static RtStatus read_facet(RtMeshReader *r) {
    RtVec3d vertex;
    RtWord normal;
    RT_TRY(rt_mesh_expect(r, "facet"));
    RT_TRY(rt_mesh_expect(r, "normal"));
    for (int a = 0; a < 3; a++) RT_TRY(rt_mesh_take(r, false, "the x y z of a normal", &normal));
    RT_TRY(rt_mesh_expect(r, "outer"));
    RT_TRY(rt_mesh_expect(r, "loop"));
    for (int k = 0; k < 3; k++) {
        RT_TRY(rt_mesh_expect(r, "vertex"));
        RT_TRY(rt_mesh_take_vertex(r, false, &vertex));
        RT_TRY(rt_mesh_add_vertex(r, vertex));
    }
    RT_TRY(expect_end(r, "loop"));
    RT_TRY(expect_end(r, "facet"));
    return add_facet(r);
}

static RtStatus read_solid(RtMeshReader *r) {
    RT_TRY(rt_mesh_expect(r, "solid"));
    rt_scan_skip_line(&r->text); /* its name */
    while (rt_scan_is_like(rt_scan_peek(&r->text), "facet")) RT_TRY(read_facet(r));
    RT_TRY(expect_end(r, "solid"));
    rt_scan_skip_line(&r->text);
    return RT_OK;
}

RtStatus rt_mesh_read_stl(RtMeshReader *r) {
    const size_t size = (size_t)(r->text.end - r->text.at);
    r->text.last = 0;
    r->given_back = r->text.at;
    if (is_binary(r->text.at, size)) return read_binary(r);
    RT_TRY(rt_mesh_begin_text(r));
    do RT_TRY(read_solid(r));
    while (rt_scan_peek(&r->text).length > 0);
    return RT_OK;
}
