/* SPDX-License-Identifier: Apache-2.0 */
/* glTF 2.0, as JSON (.gltf) or binary (.glb): the triangles of all nodes of the scene, nodes depth first,
 * each with its matrices. Materials, skins and animations are ignored. Files that need an extension for their
 * geometry, or store it sparsely, are rejected. */
#include "core/scene/mesh_gltf_data.h"

#include "core/base/memory.h"

#include <string.h>

enum { DEEPEST = 256 };

/* Extensions of materials, textures and lights do not change the geometry. */
static RtStatus check_extensions(const RtGltf *g) {
    static const char *const harmless[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_", "KHR_lights_"};
    const json_t *required = json_object_get(g->root, "extensionsRequired"), *one;
    size_t i;
    json_array_foreach(required, i, one) {
        const char *name = json_is_string(one) ? json_string_value(one) : "";
        bool ignored = false;
        for (size_t k = 0; k < 4; k++)
            ignored = ignored || strncmp(name, harmless[k], strlen(harmless[k])) == 0;
        if (!ignored)
            return rt_mesh_fail(
                g->mesh, "the file requires the extension '%.60s', which cannot be read: export it without",
                name);
    }
    return RT_OK;
}

/* ---- primitives ---- */

enum { TRIANGLES = 4, STRIP = 5, FAN = 6 };

static RtStatus add_triangle(const RtGltf *g, const RtGltfView *indices, const uint32_t corners[3]) {
    for (int k = 0; k < 3; k++)
        RT_TRY(rt_mesh_add_index(g->mesh, indices->data ? rt_gltf_index(indices, corners[k]) : corners[k]));
    return rt_mesh_add_polygon(g->mesh);
}

static RtStatus add_triangles(const RtGltf *g, uint64_t mode, const RtGltfView *indices) {
    const uint32_t count = indices->count;
    if (count < 3 || (mode == TRIANGLES && count % 3 != 0))
        return rt_mesh_fail(g->mesh, "a primitive of triangles has %u corners", count);
    for (uint32_t i = 0; i + 2 < count; i += mode == TRIANGLES ? 3 : 1) {
        const uint32_t odd = mode == STRIP ? i % 2 : 0; /* every other triangle of a strip is reversed */
        const uint32_t triangle[3] = {mode == FAN ? 0 : i, i + 1 + odd, i + 2 - odd};
        RT_TRY(add_triangle(g, indices, triangle));
    }
    return RT_OK;
}

static RtStatus add_vertices(const RtGltf *g, const json_t *attributes, RtGltfView *positions) {
    const json_t *normal = json_object_get(attributes, "NORMAL");
    RtGltfView normals;
    g->mesh->vertex_count = g->mesh->normal_count = 0;
    RT_TRY(rt_gltf_open_view(g, json_object_get(attributes, "POSITION"), 3, positions));
    for (uint32_t i = 0; i < positions->count; i++)
        RT_TRY(rt_mesh_add_vertex(g->mesh, rt_mesh_vector(positions->data + positions->stride * i)));
    if (!normal) return RT_OK;
    RT_TRY(rt_gltf_open_view(g, normal, 3, &normals));
    if (normals.count != positions->count)
        return rt_mesh_fail(g->mesh, "a primitive has %u positions and %u normals", positions->count,
                            normals.count);
    for (uint32_t i = 0; i < normals.count; i++)
        RT_TRY(rt_mesh_add_normal(g->mesh, rt_mesh_vector(normals.data + normals.stride * i)));
    return RT_OK;
}

/* Nodes may place a mesh many times, and primitives share vertices: a small file could take days. */
static RtStatus count_placed(RtGltf *g, uint64_t count) {
    enum { MOST = 1000 }; /* for each byte; a forest of 10,000 trees of 10,000 triangles has 400 */
    g->placed += count;
    if (g->placed / MOST <= g->size) return RT_OK;
    return rt_mesh_fail(g->mesh,
                        "its nodes place more than %d vertices and corners for each of its %zu bytes: divide "
                        "the file, or export it without the vertices that a primitive does not use",
                        MOST, g->size);
}

static RtStatus add_primitive(RtGltf *g, const RtGltfItem *mesh, json_t *primitive) {
    const RtGltfItem item = {mesh->list, mesh->index, primitive}; /* for messages: of this mesh */
    const json_t *reference = json_object_get(primitive, "indices");
    uint64_t mode;
    RtGltfView positions, indices;
    RT_TRY(count_placed(g, 1));
    RT_TRY(rt_gltf_integer(g, &item, "mode", 0, TRIANGLES, &mode));
    if (mode < TRIANGLES) return RT_OK; /* points and lines */
    if (mode > FAN) return rt_gltf_fail(g, &item, "expected mode, 0 to 6");
    RT_TRY(add_vertices(g, json_object_get(primitive, "attributes"), &positions));
    indices = (RtGltfView){.count = positions.count};
    if (reference) RT_TRY(rt_gltf_open_view(g, reference, 1, &indices));
    RT_TRY(count_placed(g, (uint64_t)positions.count + indices.count));
    return add_triangles(g, mode, &indices);
}

static RtStatus add_mesh(RtGltf *g, const json_t *reference) {
    RtGltfItem mesh;
    json_t *primitive;
    size_t i;
    RT_TRY(rt_gltf_find(g, "meshes", reference, "a node", &mesh));
    const json_t *primitives = json_object_get(mesh.object, "primitives");
    if (!json_is_array(primitives)) return rt_gltf_fail(g, &mesh, "expected primitives, a list");
    json_array_foreach(primitives, i, primitive) RT_TRY(add_primitive(g, &mesh, primitive));
    return RT_OK;
}

/* ---- nodes ---- */

/* From the translation, the rotation (a quaternion x y z w) and the scale of a node. */
static RtStatus get_steps(const RtGltf *g, const RtGltfItem *node, RtTransform *out) {
    double t[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    RT_TRY(rt_gltf_numbers(g, node, "translation", 3, t));
    RT_TRY(rt_gltf_numbers(g, node, "rotation", 4, q));
    RT_TRY(rt_gltf_numbers(g, node, "scale", 3, s));
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    *out = (RtTransform){
        {{(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - z * w) * s[1], 2 * (x * z + y * w) * s[2], t[0]},
         {2 * (x * y + z * w) * s[0], (1 - 2 * (x * x + z * z)) * s[1], 2 * (y * z - x * w) * s[2], t[1]},
         {2 * (x * z - y * w) * s[0], 2 * (y * z + x * w) * s[1], (1 - 2 * (x * x + y * y)) * s[2], t[2]}}};
    return RT_OK;
}

static RtStatus get_transform(const RtGltf *g, const RtGltfItem *node, RtTransform *out) {
    double columns[16];
    if (!json_object_get(node->object, "matrix")) return get_steps(g, node, out);
    RT_TRY(rt_gltf_numbers(g, node, "matrix", 16, columns));
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) out->m[row][column] = columns[4 * column + row];
    }
    return RT_OK;
}

/* Nodes are trees, so each is visited once. */
static RtStatus add_node(RtGltf *g, const json_t *reference, const char *by, const RtTransform *above,
                         int depth) {
    RtGltfItem node;
    RtTransform own, transform;
    const json_t *child;
    size_t i;
    RT_TRY(rt_gltf_find(g, "nodes", reference, by, &node));
    if (g->visited[node.index]) return rt_gltf_fail(g, &node, "it is named twice, but nodes form a tree");
    if (depth == DEEPEST) return rt_gltf_fail(g, &node, "it is more than %d levels deep", DEEPEST);
    g->visited[node.index] = true;
    RT_TRY(get_transform(g, &node, &own));
    transform = rt_transform_compose(&own, above);
    const json_t *mesh = json_object_get(node.object, "mesh");
    g->mesh->transform = transform;
    if (mesh) RT_TRY(add_mesh(g, mesh));
    json_array_foreach(json_object_get(node.object, "children"), i, child)
        RT_TRY(add_node(g, child, "a node", &transform, depth + 1));
    return RT_OK;
}

static RtStatus add_scene(RtGltf *g) {
    const RtTransform outer = g->mesh->transform;
    const json_t *number = json_object_get(g->root, "scene"), *node;
    const size_t nodes = json_array_size(json_object_get(g->root, "nodes"));
    RtGltfItem scene;
    size_t i;
    RT_TRY(number ? rt_gltf_find(g, "scenes", number, "the file", &scene)
                  : rt_gltf_at(g, "scenes", 0, "the file", &scene));
    g->visited = rt_alloc(nodes, sizeof *g->visited);
    if (!g->visited) return rt_fail_memory(g->mesh->text.error, "nodes of glTF", nodes);
    json_array_foreach(json_object_get(scene.object, "nodes"), i, node)
        RT_TRY(add_node(g, node, "the scene", &outer, 0));
    return RT_OK;
}

/* ---- the file ---- */

static RtStatus read_document(RtGltf *g, const char *text, size_t size) {
    const RtScanner *file = &g->mesh->text;
    json_error_t where;
    if (size > RT_MESH_MAX_JSON)
        return rt_mesh_fail(g->mesh, "its JSON has %zu bytes: the limit is %d", size, RT_MESH_MAX_JSON);
    g->root = json_loadb(text, size, JSON_REJECT_DUPLICATES, &where);
    if (!g->root && json_error_code(&where) == json_error_out_of_memory)
        return rt_fail_memory(file->error, "glTF", size);
    if (!g->root)
        return rt_fail_at(file->error, file->path, (size_t)where.line, (size_t)where.column, "%s",
                          where.text);
    const char *version = json_string_value(json_object_get(json_object_get(g->root, "asset"), "version"));
    if (!version || strncmp(version, "2.", 2) != 0)
        return rt_mesh_fail(g->mesh, "expected glTF 2.0, with {\"asset\": {\"version\": \"2.0\"}}");
    RT_TRY(check_extensions(g));
    RT_TRY(rt_gltf_load_buffers(g));
    return add_scene(g);
}

static RtStatus read_all(RtMeshReader *r, const char *text, size_t size, RtGltfBuffer chunk) {
    RtGltf g = {.mesh = r, .chunk = chunk, .size = size};
    RtStatus status = read_document(&g, text, size);
    for (size_t i = 0; i < g.buffer_count; i++) {
        if (g.buffers[i].data != chunk.data) rt_free(g.buffers[i].data);
    }
    rt_free(g.buffers);
    rt_free(g.visited);
    json_decref(g.root);
    return status;
}

RtStatus rt_mesh_read_gltf(RtMeshReader *r) {
    return read_all(r, r->text.at, (size_t)(r->text.end - r->text.at), (RtGltfBuffer){0});
}

enum { GLB_HEADER = 12, CHUNK_HEADER = 8 };

RtStatus rt_mesh_check_glb(const RtMeshHead *head, RtError *error) {
    const unsigned char *b = head->bytes;
    if (memcmp(b, "glTF", 4) != 0)
        return rt_fail_at(error, head->path, 0, 0, "this is no binary glTF: it does not begin with 'glTF'");
    if (rt_mesh_u32(b + 4) != 2)
        return rt_fail_at(error, head->path, 0, 0, "this is glTF %u: only 2 can be read", rt_mesh_u32(b + 4));
    if (rt_mesh_u32(b + 8) == head->size) return RT_OK;
    return rt_fail_at(error, head->path, 0, 0,
                      "the header declares %u bytes, but the file has %llu: it is cut off or damaged",
                      rt_mesh_u32(b + 8), (unsigned long long)head->size);
}

/* Takes a chunk, which must be of this type. */
static RtStatus take_chunk(RtMeshReader *r, const char type[4], RtGltfBuffer *chunk) {
    RtScanner *text = &r->text;
    const size_t left = (size_t)(text->end - text->at);
    if (left < CHUNK_HEADER || memcmp(text->at + 4, type, 4) != 0)
        return rt_mesh_fail(r, "expected a chunk %.4s at byte %zu before the end", type, left);
    chunk->size = rt_mesh_u32(text->at);
    if (chunk->size > left - CHUNK_HEADER)
        return rt_mesh_fail(r, "a chunk %.4s declares %zu bytes, but the file ends after %zu", type,
                            chunk->size, left - CHUNK_HEADER);
    text->at += CHUNK_HEADER;
    chunk->data = (char *)text->at;
    text->at += chunk->size;
    return RT_OK;
}

RtStatus rt_mesh_read_glb(RtMeshReader *r) {
    RtGltfBuffer json = {0}, binary = {0};
    if (r->text.end - r->text.at < GLB_HEADER) return rt_mesh_fail(r, "the file ends in its header");
    r->text.at += GLB_HEADER;
    RT_TRY(take_chunk(r, "JSON", &json));
    if (r->text.at < r->text.end) RT_TRY(take_chunk(r, "BIN", &binary)); /* other chunks may follow */
    return read_all(r, json.data, json.size, binary);
}
