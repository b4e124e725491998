/* SPDX-License-Identifier: Apache-2.0 */
/* glTF 2.0, as JSON (.gltf) or binary (.glb): the triangles of all nodes of the scene, nodes depth first,
 * each with its matrices. Materials, skins and animations are ignored. Files that need an extension for their
 * geometry, or store it sparsely, are rejected. Every member is checked where it is read; what a view shows
 * is inside its buffer. */
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/scene/mesh.h"

#include <jansson.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct Buffer {
    char *data;
    size_t size;
} Buffer;

typedef struct Gltf {
    RtMeshReader *mesh;
    json_t *root;
    Buffer chunk; /* the binary chunk of a .glb, borrowed; a zeroed struct: none */
    size_t buffer_count;
    Buffer *buffers; /* [buffer_count], their data owned, except `chunk` */
    size_t size;     /* bytes of the document and its buffers */
    uint64_t placed; /* primitives, their vertices and corners, in all nodes so far */
    bool *visited;   /* [nodes] */
    RtArena memory;
} Gltf;

/* An entry of one of the document's lists. */
typedef struct Item {
    const char *list;
    size_t index;
    json_t *object;
} Item;

/* The elements of an accessor. */
typedef struct View {
    const char *data;
    uint32_t count;
    uint64_t type; /* of a component, as the document says it */
    size_t stride;
} View;

enum { NO_INDEX = -1, UINT8 = 5121, UINT16 = 5123, UINT32 = 5125, FLOAT32 = 5126 };

#define MOST_INTEGER ((json_int_t)1 << 40) /* sums, and products with 2^20, fit 64 bits */

/* ---- the document ---- */

/* Fails at "FILE: LIST[INDEX]: ". */
__attribute__((format(printf, 3, 4))) static RtStatus fail_item(const Gltf *g, const Item *item,
                                                                const char *format, ...) {
    char message[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return rt_mesh_fail(g->mesh, "%s[%zu]: %s", item->list, item->index, message);
}

/* Finds the object of `list` whose index is `reference`, which stands in `by`; without one, `otherwise`. */
static RtStatus find_item(const Gltf *g, const char *list, const json_t *reference, json_int_t otherwise,
                          const char *by, Item *item) {
    const json_t *all = json_object_get(g->root, list);
    const json_int_t index = json_is_integer(reference) ? json_integer_value(reference) : otherwise;
    if (!json_is_integer(reference) && (reference || otherwise == NO_INDEX))
        return rt_mesh_fail(g->mesh, "%s lacks the index of one of the %s", by, list);
    if (index < 0 || (uint64_t)index >= json_array_size(all))
        return rt_mesh_fail(g->mesh, "%s names %s[%lld], but there are %zu (counted from 0)", by, list,
                            (long long)index, json_array_size(all));
    *item = (Item){list, (size_t)index, json_array_get(all, (size_t)index)};
    return json_is_object(item->object) ? RT_OK : fail_item(g, item, "expected an object");
}

/* Gets the integer `key`, or `otherwise` if there is none. Rejects less than `least`, so an `otherwise` below
 * it makes the member mandatory; and more than 2^40. */
static RtStatus read_integer(const Gltf *g, const Item *item, const char *key, json_int_t least,
                             json_int_t otherwise, uint64_t *out) {
    const json_t *member = json_object_get(item->object, key);
    const json_int_t value = json_is_integer(member) ? json_integer_value(member) : member ? -1 : otherwise;
    if (value < least || value > MOST_INTEGER)
        return fail_item(g, item, "expected %s, an integer of at least %lld", key, (long long)least);
    *out = (uint64_t)value;
    return RT_OK;
}

/* Gets the list `key` of `count` numbers; out[] stays as it is if there is none. */
static RtStatus read_numbers(const Gltf *g, const Item *item, const char *key, size_t count, double *out) {
    const json_t *list = json_object_get(item->object, key);
    if (!list) return RT_OK;
    for (size_t i = 0; i < count; i++) {
        const json_t *number = json_array_get(list, i);
        if (!json_is_number(number) || json_array_size(list) != count)
            return fail_item(g, item, "expected %s, a list of %zu numbers", key, count);
        out[i] = json_number_value(number);
    }
    return RT_OK;
}

/* ---- buffers ---- */

/* Decodes base64 to out[0..strlen(text)); returns the number of bytes, or SIZE_MAX if it is damaged. */
static size_t decode(const char *text, char *out) {
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t length = strlen(text), written = 0;
    while (length > 0 && text[length - 1] == '=') length--;
    uint32_t bits = 0;
    for (size_t i = 0; i < length; i++) {
        const char *digit = strchr(digits, text[i]);
        if (!digit) return SIZE_MAX;
        bits = bits << 6 | (uint32_t)(digit - digits);
        if (i % 4 != 0) out[written++] = (char)(bits >> (6 - i % 4 * 2));
    }
    return written;
}

static RtStatus load_embedded(const Gltf *g, const Item *item, const char *text, Buffer *buffer) {
    buffer->data = rt_alloc_unset(strlen(text) + 1, 1);
    if (!buffer->data) return rt_fail_memory(g->mesh->text.error, "a buffer of glTF", strlen(text));
    buffer->size = decode(text, buffer->data);
    return buffer->size == SIZE_MAX ? fail_item(g, item, "its base64 is damaged") : RT_OK;
}

/* Decodes "%20" and the like. */
static void decode_path(const char *uri, char out[RT_MAX_PATH]) {
    size_t length = 0;
    for (; *uri && length + 1 < RT_MAX_PATH; uri++) {
        unsigned code;
        int used = 0;
        if (*uri == '%' && sscanf(uri + 1, "%2x%n", &code, &used) == 1 && used == 2 && code != 0) {
            out[length++] = (char)code;
            uri += 2;
        } else {
            out[length++] = *uri;
        }
    }
    out[length] = '\0';
}

static RtStatus load_file(const Gltf *g, const Item *item, const char *uri, size_t limit, Buffer *buffer) {
    char folder[RT_MAX_PATH], name[RT_MAX_PATH], path[RT_MAX_PATH];
    if (strstr(uri, "://")) return fail_item(g, item, "its uri '%.60s' is not a file", uri);
    decode_path(uri, name);
    rt_path_folder(g->mesh->text.path, folder);
    RT_TRY(rt_path_join(folder, name, path, g->mesh->text.error));
    return rt_file_read(path, limit, &buffer->data, &buffer->size, g->mesh->text.error);
}

static RtStatus load_buffer(const Gltf *g, const Item *item, size_t limit, Buffer *buffer) {
    static const char embedded[] = "data:";
    const json_t *member = json_object_get(item->object, "uri");
    const char *uri = json_string_value(member), *data = uri ? strstr(uri, ";base64,") : NULL;
    uint64_t length = 0;
    RT_TRY(read_integer(g, item, "byteLength", 1, 0, &length));
    if (!uri && !member && item->index == 0 && g->chunk.data)
        *buffer = g->chunk;
    else if (!uri)
        return fail_item(g, item, "expected uri, the data or the name of a file");
    else if (strncmp(uri, embedded, strlen(embedded)) != 0)
        RT_TRY(load_file(g, item, uri, limit, buffer));
    else if (data)
        RT_TRY(load_embedded(g, item, data + strlen(";base64,"), buffer));
    else
        return fail_item(g, item, "its data is not in base64");
    if (buffer->size >= length) return RT_OK;
    return fail_item(g, item, "it declares %llu bytes, but has %zu: it is cut off",
                     (unsigned long long)length, buffer->size);
}

/* Loads all buffers: the chunk, embedded ones, files beside the document. */
static RtStatus load_buffers(Gltf *g) {
    const json_t *list = json_object_get(g->root, "buffers");
    const size_t count = json_array_size(list);
    size_t left = RT_MESH_MAX_BYTES; /* for files, together: a document may name one many times */
    g->buffers = rt_arena_alloc(&g->memory, count, sizeof *g->buffers);
    RT_TRY(rt_arena_check(&g->memory, "buffers of glTF", g->mesh->text.error));
    g->buffer_count = count;
    for (size_t i = 0; i < count; i++) {
        const Item item = {"buffers", i, json_array_get(list, i)};
        RT_TRY(load_buffer(g, &item, left, &g->buffers[i]));
        left -= g->buffers[i].size < left ? g->buffers[i].size : left;
        g->size += g->buffers[i].size;
    }
    return RT_OK;
}

/* ---- accessors ---- */

static size_t component_size(uint64_t type) {
    return type == UINT8 ? 1 : type == UINT16 ? 2 : type == UINT32 || type == FLOAT32 ? 4 : 0;
}

/* Opens an accessor for `width` components: 3 of float32, or 1 of unsigned integers. */
static RtStatus open_view(const Gltf *g, const json_t *reference, size_t width, View *view) {
    static const char *const names[] = {"", "SCALAR", "VEC2", "VEC3"};
    Item accessor = {0}, range = {0}, buffer = {0};
    uint64_t type = 0, count = 0, skip = 0, begin = 0, length = 0, stride = 0;
    RT_TRY(find_item(g, "accessors", reference, NO_INDEX, "a primitive", &accessor));
    if (json_object_get(accessor.object, "sparse"))
        return fail_item(g, &accessor, "it is sparse: cannot be read");
    RT_TRY(read_integer(g, &accessor, "componentType", 0, -1, &type));
    RT_TRY(read_integer(g, &accessor, "count", 1, 0, &count));
    RT_TRY(read_integer(g, &accessor, "byteOffset", 0, 0, &skip));
    const size_t size = component_size(type) * width;
    const char *shape = json_string_value(json_object_get(accessor.object, "type"));
    if (size == 0 || (type == FLOAT32) != (width == 3) || !shape || strcmp(shape, names[width]) != 0)
        return fail_item(g, &accessor, "expected the type %s of %s", names[width],
                         width == 3 ? "float32" : "unsigned integers");
    RT_TRY(find_item(g, "bufferViews", json_object_get(accessor.object, "bufferView"), NO_INDEX,
                     "an accessor", &range));
    RT_TRY(read_integer(g, &range, "byteOffset", 0, 0, &begin));
    RT_TRY(read_integer(g, &range, "byteLength", 1, 0, &length));
    RT_TRY(read_integer(g, &range, "byteStride", (json_int_t)size, (json_int_t)size, &stride));
    RT_TRY(
        find_item(g, "buffers", json_object_get(range.object, "buffer"), NO_INDEX, "a bufferView", &buffer));
    if (begin + length > g->buffers[buffer.index].size)
        return fail_item(g, &range, "it ends at byte %llu of a buffer of %zu bytes",
                         (unsigned long long)begin + length, g->buffers[buffer.index].size);
    if (count > UINT32_MAX || stride > 252 || skip + stride * (count - 1) + size > length)
        return fail_item(g, &accessor, "its %llu elements do not fit into the %llu bytes of bufferViews[%zu]",
                         (unsigned long long)count, (unsigned long long)length, range.index);
    *view = (View){g->buffers[buffer.index].data + begin + skip, (uint32_t)count, type, (size_t)stride};
    return RT_OK;
}

/* Integer `i` of a view. */
static uint32_t index_at(const View *view, uint32_t i) {
    uint32_t index = 0;
    memcpy(&index, view->data + view->stride * i, component_size(view->type));
    return index;
}

/* ---- extensions ---- */

enum { DEEPEST = 256 };

/* Extensions of materials, textures and lights do not change the geometry. */
static RtStatus check_extensions(const Gltf *g) {
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

static RtStatus add_triangles(const Gltf *g, uint64_t mode, const View *indices) {
    const uint32_t count = indices->count;
    if (count < 3 || (mode == TRIANGLES && count % 3 != 0))
        return rt_mesh_fail(g->mesh, "a primitive of triangles has %u corners", count);
    for (uint32_t i = 0; i + 2 < count; i += mode == TRIANGLES ? 3 : 1) {
        const uint32_t odd = mode == STRIP ? i % 2 : 0; /* every other triangle of a strip is reversed */
        const uint32_t corners[3] = {mode == FAN ? 0 : i, i + 1 + odd, i + 2 - odd};
        for (int k = 0; k < 3; k++)
            RT_TRY(rt_mesh_add_index(g->mesh, indices->data ? index_at(indices, corners[k]) : corners[k]));
        RT_TRY(rt_mesh_add_polygon(g->mesh));
    }
    return RT_OK;
}

static RtStatus add_vertices(const Gltf *g, const json_t *attributes, View *positions) {
    const json_t *normal = json_object_get(attributes, "NORMAL");
    View normals = {0};
    g->mesh->vertex_count = g->mesh->normal_count = 0;
    RT_TRY(open_view(g, json_object_get(attributes, "POSITION"), 3, positions));
    for (uint32_t i = 0; i < positions->count; i++)
        RT_TRY(rt_mesh_add_vertex(g->mesh, rt_mesh_vector(positions->data + positions->stride * i)));
    if (!normal) return RT_OK;
    RT_TRY(open_view(g, normal, 3, &normals));
    if (normals.count != positions->count)
        return rt_mesh_fail(g->mesh, "a primitive has %u positions and %u normals", positions->count,
                            normals.count);
    for (uint32_t i = 0; i < normals.count; i++)
        RT_TRY(rt_mesh_add_normal(g->mesh, rt_mesh_vector(normals.data + normals.stride * i)));
    return RT_OK;
}

/* Nodes may place a mesh many times, and primitives share vertices: a small file could take days. */
static RtStatus count_placed(Gltf *g, uint64_t count) {
    enum { MOST = 1000 }; /* for each byte; a forest of 10,000 trees of 10,000 triangles has 400 */
    g->placed += count;
    if (g->placed / MOST <= g->size) return RT_OK;
    return rt_mesh_fail(g->mesh,
                        "its nodes place more than %d vertices and corners for each of its %zu bytes: divide "
                        "the file, or export it without the vertices that a primitive does not use",
                        MOST, g->size);
}

static RtStatus add_primitive(Gltf *g, const Item *mesh, json_t *primitive) {
    const Item item = {mesh->list, mesh->index, primitive}; /* for messages: of this mesh */
    const json_t *reference = json_object_get(primitive, "indices");
    uint64_t mode = 0;
    View positions = {0}, indices;
    RT_TRY(count_placed(g, 1));
    RT_TRY(read_integer(g, &item, "mode", 0, TRIANGLES, &mode));
    if (mode < TRIANGLES) return RT_OK; /* points and lines */
    if (mode > FAN) return fail_item(g, &item, "expected mode, 0 to 6");
    RT_TRY(add_vertices(g, json_object_get(primitive, "attributes"), &positions));
    indices = (View){.count = positions.count};
    if (reference) RT_TRY(open_view(g, reference, 1, &indices));
    RT_TRY(count_placed(g, (uint64_t)positions.count + indices.count));
    return add_triangles(g, mode, &indices);
}

static RtStatus add_mesh(Gltf *g, const json_t *reference) {
    Item mesh = {0};
    json_t *primitive;
    size_t i;
    RT_TRY(find_item(g, "meshes", reference, NO_INDEX, "a node", &mesh));
    const json_t *primitives = json_object_get(mesh.object, "primitives");
    if (!json_is_array(primitives)) return fail_item(g, &mesh, "expected primitives, a list");
    json_array_foreach(primitives, i, primitive) RT_TRY(add_primitive(g, &mesh, primitive));
    return RT_OK;
}

/* ---- nodes ---- */

/* A matrix, or translation, rotation (a quaternion x y z w) and scale. */
static RtStatus get_transform(const Gltf *g, const Item *node, RtTransform *out) {
    double t[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1}, columns[16];
    if (json_object_get(node->object, "matrix")) {
        RT_TRY(read_numbers(g, node, "matrix", 16, columns));
        for (int i = 0; i < 12; i++) out->m[i % 3][i / 3] = columns[i / 3 * 4 + i % 3];
        return RT_OK;
    }
    RT_TRY(read_numbers(g, node, "translation", 3, t));
    RT_TRY(read_numbers(g, node, "rotation", 4, q));
    RT_TRY(read_numbers(g, node, "scale", 3, s));
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    *out = (RtTransform){
        {{(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - z * w) * s[1], 2 * (x * z + y * w) * s[2], t[0]},
         {2 * (x * y + z * w) * s[0], (1 - 2 * (x * x + z * z)) * s[1], 2 * (y * z - x * w) * s[2], t[1]},
         {2 * (x * z - y * w) * s[0], 2 * (y * z + x * w) * s[1], (1 - 2 * (x * x + y * y)) * s[2], t[2]}}};
    return RT_OK;
}

/* Nodes are trees, so each is visited once. */
static RtStatus add_node(Gltf *g, const json_t *reference, const char *by, const RtTransform *above,
                         int depth) {
    Item node;
    RtTransform own, transform;
    const json_t *child;
    size_t i;
    RT_TRY(find_item(g, "nodes", reference, NO_INDEX, by, &node));
    if (g->visited[node.index]) return fail_item(g, &node, "it is named twice, but nodes form a tree");
    if (depth == DEEPEST) return fail_item(g, &node, "it is more than %d levels deep", DEEPEST);
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

static RtStatus add_scene(Gltf *g) {
    const RtTransform outer = g->mesh->transform;
    const json_t *node;
    const size_t nodes = json_array_size(json_object_get(g->root, "nodes"));
    Item scene = {0};
    size_t i;
    RT_TRY(find_item(g, "scenes", json_object_get(g->root, "scene"), 0, "the file", &scene));
    g->visited = rt_arena_alloc(&g->memory, nodes, sizeof *g->visited);
    RT_TRY(rt_arena_check(&g->memory, "nodes of glTF", g->mesh->text.error));
    json_array_foreach(json_object_get(scene.object, "nodes"), i, node)
        RT_TRY(add_node(g, node, "the scene", &outer, 0));
    return RT_OK;
}

/* ---- the file ---- */

static RtStatus read_document(Gltf *g, const char *text, size_t size) {
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
    RT_TRY(load_buffers(g));
    return add_scene(g);
}

static RtStatus read_all(RtMeshReader *r, const char *text, size_t size, Buffer chunk) {
    Gltf g = {.mesh = r, .chunk = chunk, .size = size};
    RtStatus status = read_document(&g, text, size);
    for (size_t i = 0; i < g.buffer_count; i++) {
        if (g.buffers[i].data != chunk.data) rt_free(g.buffers[i].data);
    }
    rt_arena_clear(&g.memory);
    json_decref(g.root);
    return status;
}

RtStatus rt_mesh_read_gltf(RtMeshReader *r) {
    return read_all(r, r->text.at, (size_t)(r->text.end - r->text.at), (Buffer){0});
}

enum { GLB_HEADER = 12, CHUNK_HEADER = 8 };

RtStatus rt_mesh_check_glb(RtMeshReader *r, const RtMeshHead *head) {
    const unsigned char *b = head->bytes;
    if (memcmp(b, "glTF", 4) != 0)
        return rt_mesh_fail(r, "this is no binary glTF: it does not begin with 'glTF'");
    if (rt_mesh_u32(b + 4) != 2)
        return rt_mesh_fail(r, "this is glTF %u: only 2 can be read", rt_mesh_u32(b + 4));
    if (rt_mesh_u32(b + 8) == head->size) return RT_OK;
    return rt_mesh_fail(r, "the header declares %u bytes, but the file has %llu: it is cut off or damaged",
                        rt_mesh_u32(b + 8), (unsigned long long)head->size);
}

/* Takes a chunk, which must be of this type. */
static RtStatus take_chunk(RtMeshReader *r, const char type[4], Buffer *chunk) {
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
    Buffer json = {0}, binary = {0};
    if (r->text.end - r->text.at < GLB_HEADER) return rt_mesh_fail(r, "the file ends in its header");
    r->text.at += GLB_HEADER;
    RT_TRY(take_chunk(r, "JSON", &json));
    if (r->text.at < r->text.end) RT_TRY(take_chunk(r, "BIN", &binary)); /* other chunks may follow */
    return read_all(r, json.data, json.size, binary);
}
