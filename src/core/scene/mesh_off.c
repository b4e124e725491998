/* SPDX-License-Identifier: Apache-2.0 */
/* OFF, of Geomview: the numbers of vertices, polygons and edges, then a line for each vertex and each
 * polygon. NOFF has a normal behind each vertex. Colours, which end the lines of COFF, are skipped. */
#include "core/scene/mesh.h"

/* Nothing is allocated for a count: the file must have the elements. */
static RtStatus take_count(RtMeshReader *r, uint64_t *out) {
    const RtWord word = rt_scan_peek(&r->text);
    int64_t count = 0;
    if (word.length == 0) return rt_scan_fail(&r->text, word, "the numbers of vertices, faces and edges");
    rt_scan_take(&r->text, word);
    RT_TRY(rt_mesh_integer(r, word, &count));
    if (count < 0) return rt_scan_fail(&r->text, word, "a count of at least 0");
    *out = (uint64_t)count;
    return RT_OK;
}

static RtStatus read_vertex(RtMeshReader *r, bool has_normal) {
    RtVec3 vertex, normal;
    RT_TRY(rt_mesh_take_vector(r, true, "the x y z of a vertex", &vertex));
    if (has_normal) {
        RT_TRY(rt_mesh_take_vector(r, false, "the x y z of a normal", &normal));
        RT_TRY(rt_mesh_add_normal(r, normal));
    }
    rt_scan_skip_line(&r->text);
    return rt_mesh_add_vertex(r, vertex);
}

static RtStatus read_face(RtMeshReader *r) {
    RtWord word;
    int64_t count = 0, index = 0;
    RT_TRY(rt_mesh_take(r, true, "a number of corners", &word));
    RT_TRY(rt_mesh_integer(r, word, &count));
    for (int64_t i = 0; i < count; i++) {
        RT_TRY(rt_mesh_take(r, false, "the index of a vertex", &word));
        RT_TRY(rt_mesh_integer(r, word, &index));
        RT_TRY(rt_mesh_add_index(r, (double)index));
    }
    rt_scan_skip_line(&r->text);
    return rt_mesh_add_polygon(r);
}

RtStatus rt_mesh_read_off(RtMeshReader *r) {
    const RtWord word = rt_scan_peek(&r->text);
    const bool normals = rt_scan_is(word, "NOFF") || rt_scan_is(word, "CNOFF");
    uint64_t vertices = 0, faces = 0, edges = 0;
    if (!normals && !rt_scan_is(word, "OFF") && !rt_scan_is(word, "COFF"))
        return rt_scan_fail(&r->text, word, "OFF, COFF, NOFF or CNOFF");
    rt_scan_take(&r->text, word);
    RT_TRY(take_count(r, &vertices));
    RT_TRY(take_count(r, &faces));
    RT_TRY(take_count(r, &edges));
    for (uint64_t i = 0; i < vertices; i++) {
        if (rt_scan_peek(&r->text).length == 0) return rt_mesh_fail_short(r, i, vertices, "vertices");
        RT_TRY(read_vertex(r, normals));
    }
    for (uint64_t i = 0; i < faces; i++) {
        if (rt_scan_peek(&r->text).length == 0) return rt_mesh_fail_short(r, i, faces, "faces");
        RT_TRY(read_face(r));
    }
    return rt_mesh_end(r);
}
