/* SPDX-License-Identifier: Apache-2.0 */
/* STL, binary or text. The normals of facets are ignored, because the order of the vertices,
 * counter-clockwise from outside, has the same information and is exact. */
#include "core/scene/mesh.h"

#include <inttypes.h>
#include <string.h>

enum { HEADER = 80, FACET = 50 };

static uint64_t binary_size(const void *bytes) {
    return RT_MESH_HEAD + (uint64_t)FACET * rt_mesh_u32((const char *)bytes + HEADER);
}

/* A binary file may begin with "solid", too: its size decides. */
RtStatus rt_mesh_check_stl(RtMeshReader *r, const RtMeshHead *head) {
    const bool zeros = memchr(head->bytes, 0, head->size < RT_MESH_HEAD ? (size_t)head->size : RT_MESH_HEAD);
    if (head->size >= RT_MESH_HEAD && head->size == binary_size(head->bytes)) return RT_OK;
    if (memcmp(head->bytes, "solid", 5) == 0 && !zeros) return RT_OK;
    if (head->size < RT_MESH_HEAD)
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

static RtStatus read_binary(RtMeshReader *r, const char *bytes) {
    const uint32_t count = rt_mesh_u32(bytes + HEADER);
    for (uint32_t i = 0; i < count; i++) {
        const char *facet = bytes + RT_MESH_HEAD + (size_t)FACET * i;
        for (size_t k = 0; k < 3; k++) RT_TRY(rt_mesh_add_vertex(r, rt_mesh_vector(facet + 12 + 12 * k)));
        RT_TRY(add_facet(r));
    }
    return RT_OK;
}

static RtStatus read_facet(RtMeshReader *r) {
    RtVec3 vertex;
    RtWord normal;
    RT_TRY(rt_mesh_expect(r, "facet"));
    RT_TRY(rt_mesh_expect(r, "normal"));
    for (int a = 0; a < 3; a++) RT_TRY(rt_mesh_take(r, false, "the x y z of a normal", &normal));
    RT_TRY(rt_mesh_expect(r, "outer"));
    RT_TRY(rt_mesh_expect(r, "loop"));
    for (int k = 0; k < 3; k++) {
        RT_TRY(rt_mesh_expect(r, "vertex"));
        RT_TRY(rt_mesh_take_vector(r, false, "the x y z of a vertex", &vertex));
        RT_TRY(rt_mesh_add_vertex(r, vertex));
    }
    RT_TRY(rt_mesh_expect(r, "endloop"));
    RT_TRY(rt_mesh_expect(r, "endfacet"));
    return add_facet(r);
}

static RtStatus read_solid(RtMeshReader *r) {
    RT_TRY(rt_mesh_expect(r, "solid"));
    rt_scan_skip_line(&r->text); /* its name */
    while (rt_scan_is(rt_scan_peek(&r->text), "facet")) RT_TRY(read_facet(r));
    RT_TRY(rt_mesh_expect(r, "endsolid"));
    rt_scan_skip_line(&r->text);
    return RT_OK;
}

RtStatus rt_mesh_read_stl(RtMeshReader *r) {
    const size_t size = (size_t)(r->text.end - r->text.at);
    r->text.last = 0;
    if (size >= RT_MESH_HEAD && size == binary_size(r->text.at)) return read_binary(r, r->text.at);
    const char *zero = memchr(r->text.at, 0, size);
    if (zero)
        return rt_mesh_fail(r, "byte %zu (counted from 0) is 0, in a text file: it is damaged",
                            (size_t)(zero - r->text.at));
    do RT_TRY(read_solid(r));
    while (rt_scan_peek(&r->text).length > 0);
    return RT_OK;
}
