/* SPDX-License-Identifier: Apache-2.0 */
/* Writing meshes: every triangle with three vertices of its own. */
#include "core/scene/mesh.h"

#include <inttypes.h>

/* As they lie in memory: rt_mesh_u32. */
static void put_u32(FILE *file, uint32_t value) {
    fwrite(&value, sizeof value, 1, file);
}

static void put_vector(FILE *file, RtVec3 v) {
    fwrite(&v, sizeof v, 1, file);
}

/* The file's own normal of a vertex, else that of the triangle. */
static RtVec3 normal_of(const RtGeometry *g, uint32_t triangle, int vertex) {
    const uint32_t entry = g->triangle_normals[triangle];
    return entry == RT_NO_NORMALS ? rt_narrow(rt_triangle_normal(&g->triangles[triangle]))
                                  : g->vertex_normals[entry].n[vertex];
}

void rt_mesh_write_stl(const RtGeometry *g, FILE *file) {
    fprintf(file, "%-80s", "binary STL");
    put_u32(file, g->triangle_count);
    for (uint32_t i = 0; i < g->triangle_count; i++) {
        put_vector(file, rt_narrow(rt_triangle_normal(&g->triangles[i])));
        for (int k = 0; k < 3; k++) put_vector(file, g->triangles[i].v[k]);
        fwrite("\0", 1, 2, file); /* no attributes */
    }
}

void rt_mesh_write_ply(const RtGeometry *g, FILE *file) {
    const bool normals = g->vertex_normal_count > 0;
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\nelement vertex %u\n"
            "property float x\nproperty float y\nproperty float z\n%s"
            "element face %u\nproperty list uchar uint vertex_indices\nend_header\n",
            3 * g->triangle_count, normals ? "property float nx\nproperty float ny\nproperty float nz\n" : "",
            g->triangle_count);
    for (uint32_t i = 0; i < g->triangle_count; i++) {
        for (int k = 0; k < 3; k++) {
            put_vector(file, g->triangles[i].v[k]);
            if (normals) put_vector(file, normal_of(g, i, k));
        }
    }
    for (uint32_t i = 0; i < g->triangle_count; i++) {
        fputc(3, file);
        for (uint32_t k = 0; k < 3; k++) put_u32(file, 3 * i + k);
    }
}

static void put_line(FILE *file, const char *word, RtVec3 v) {
    fprintf(file, "%s %.9g %.9g %.9g\n", word, (double)v.x, (double)v.y, (double)v.z);
}

/* Negative indices count from the end: -1 is the latest. */
void rt_mesh_write_obj(const RtGeometry *g, FILE *file) {
    for (uint32_t i = 0; i < g->triangle_count; i++) {
        uint32_t entry = g->triangle_normals ? g->triangle_normals[i] : RT_NO_NORMALS;
        for (int k = 0; k < 3; k++) {
            put_line(file, "v", g->triangles[i].v[k]);
            if (entry != RT_NO_NORMALS) put_line(file, "vn", g->vertex_normals[entry].n[k]);
        }
        fprintf(file, entry != RT_NO_NORMALS ? "f -3//-3 -2//-2 -1//-1\n" : "f -3 -2 -1\n");
    }
}

/* ---- glTF ---- */

enum { MOST_DOCUMENT = 2048 };

/* One mesh in one buffer of parts of `part` bytes: the positions of all vertices, then their normals if there
 * are any. Returns the length. */
static uint32_t format_document(const RtGeometry *g, uint64_t part, bool normals, char out[MOST_DOCUMENT]) {
    const uint32_t vertices = 3 * g->triangle_count;
    const RtVec3 lo = g->box.lo, hi = g->box.hi;
    char accessor[128] = "", view[128] = "";
    if (normals) {
        snprintf(accessor, sizeof accessor,
                 ",{\"bufferView\":1,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\"}", vertices);
        snprintf(view, sizeof view, ",{\"buffer\":0,\"byteOffset\":%" PRIu64 ",\"byteLength\":%" PRIu64 "}",
                 part, part);
    }
    return (uint32_t)snprintf(
        out, MOST_DOCUMENT,
        "{\"asset\":{\"version\":\"2.0\",\"generator\":\"raytally\"},"
        "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{"
        "\"attributes\":{\"POSITION\":0%s}}]}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":%u,\"type\":\"VEC3\","
        "\"min\":[%.9g,%.9g,%.9g],\"max\":[%.9g,%.9g,%.9g]}%s],\"bufferViews\":[{\"buffer\":0,\"byteLength\":"
        "%" PRIu64 "}%s],\"buffers\":[{\"byteLength\":%" PRIu64 "}]}",
        normals ? ",\"NORMAL\":1" : "", vertices, (double)lo.x, (double)lo.y, (double)lo.z, (double)hi.x,
        (double)hi.y, (double)hi.z, accessor, part, view, normals ? 2 * part : part);
}

void rt_mesh_write_glb(const RtGeometry *g, FILE *file) {
    enum { HEADER = 12, CHUNK_HEADER = 8 };
    const bool normals = g->vertex_normal_count > 0;
    const uint64_t part = (uint64_t)g->triangle_count * sizeof(RtTriangle), data = (normals ? 2 : 1) * part;
    char json[MOST_DOCUMENT];
    const uint32_t length = (format_document(g, part, normals, json) + 3) / 4 * 4; /* padded with blanks */
    fputs("glTF", file);
    put_u32(file, 2);
    put_u32(file, HEADER + 2 * CHUNK_HEADER + length + (uint32_t)data);
    put_u32(file, length);
    fprintf(file, "JSON%-*s", (int)length, json);
    put_u32(file, (uint32_t)data);
    fwrite("BIN", 1, 4, file);
    for (int part_number = 0; part_number < (normals ? 2 : 1); part_number++) {
        for (uint32_t i = 0; i < g->triangle_count; i++) {
            for (int k = 0; k < 3; k++)
                put_vector(file, part_number ? normal_of(g, i, k) : g->triangles[i].v[k]);
        }
    }
}
