/* SPDX-License-Identifier: Apache-2.0 */
/* glTF 2.0, as JSON (.gltf) or binary (.glb): the triangles of all nodes of the scene, nodes depth first,
 * each with its matrices, at rest: morph targets with the weights of the file, skins in the pose of their
 * nodes. Instances (EXT_mesh_gpu_instancing) become copies. Materials are ignored, animations with a warning.
 * Files that need another extension for their geometry are rejected. Every member is checked where it is
 * read; what is read of a buffer is inside it. */
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/scene/mesh.h"

#include <jansson.h>
#include <math.h>
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
    Buffer *buffers;   /* [buffer_count], their data owned, except `chunk` */
    size_t size;       /* bytes of the document and its buffers */
    uint64_t placed;   /* primitives, their vertices and corners, in all nodes so far */
    RtTransform outer; /* of the whole file */
    size_t node_count;
    uint32_t *parents; /* [node_count] NO_NODE: a root */
    bool *visited;     /* [node_count] */
    RtArena memory;
} Gltf;

/* An entry of one of the document's lists. */
typedef struct Item {
    const char *list;
    size_t index;
    json_t *object;
} Item;

/* The elements of an accessor, decoded. */
typedef struct Values {
    uint32_t count;
    size_t width; /* numbers of an element */
    double *at;   /* [count * width] */
} Values;

/* The transforms of a skin's joints at rest, from the mesh to the scene. */
typedef struct Skin {
    size_t count;
    RtTransform *joints; /* [count] */
} Skin;

enum { NO_INDEX = -1, DEEPEST = 256 };
#define NO_NODE UINT32_MAX

#define MOST_INTEGER 0x1p40 /* sums, and products with 2^20, fit 64 bits */

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

/* A whole number, which may be written as 3.0; -1 if it is none, or too large; `otherwise` without a member.
 */
static json_int_t whole_of(const json_t *member, json_int_t otherwise) {
    const double value = json_number_value(member);
    if (!member) return otherwise;
    return json_is_number(member) && value == floor(value) && fabs(value) <= MOST_INTEGER ? (json_int_t)value
                                                                                          : -1;
}

/* Finds the object of `list` whose index is `reference`, which stands in `by`; without one, `otherwise`. */
static RtStatus find_item(const Gltf *g, const char *list, const json_t *reference, json_int_t otherwise,
                          const char *by, Item *item) {
    const json_t *all = json_object_get(g->root, list);
    const json_int_t index = whole_of(reference, otherwise);
    if (!json_is_number(reference) && (reference || otherwise == NO_INDEX))
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
    const json_int_t value = whole_of(json_object_get(item->object, key), otherwise);
    if (value < least)
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

typedef enum Component { INT8 = 5120, UINT8, INT16, UINT16, UINT32 = 5125, FLOAT32 } Component;

static size_t component_size(uint64_t type) {
    return type == INT8 || type == UINT8       ? 1
           : type == INT16 || type == UINT16   ? 2
           : type == UINT32 || type == FLOAT32 ? 4
                                               : 0;
}

/* A number of a buffer. Normalised integers are parts of the largest one. */
static double component_at(uint64_t type, bool normalised, const char *at) {
    const double scale = normalised ? type == INT8    ? 127
                                      : type == UINT8 ? 255
                                      : type == INT16 ? 32767
                                                      : 65535
                                    : 1;
    int16_t wide;
    uint16_t wide_unsigned;
    float number;
    double value;
    switch (type) {
    case INT8: value = *(const signed char *)at; break;
    case UINT8: value = *(const unsigned char *)at; break;
    case INT16:
        memcpy(&wide, at, sizeof wide);
        value = wide;
        break;
    case UINT16:
        memcpy(&wide_unsigned, at, sizeof wide_unsigned);
        value = wide_unsigned;
        break;
    case UINT32: return rt_mesh_u32(at);
    default: memcpy(&number, at, sizeof number); return (double)number;
    }
    return normalised ? fmax(value / scale, -1) : value;
}

/* Finds `count` elements of `size` bytes behind byte `skip` of the view that `owner` names. */
static RtStatus find_bytes(const Gltf *g, const Item *owner, const json_t *reference, uint64_t skip,
                           uint64_t count, size_t size, const char **data, uint64_t *stride) {
    Item range = {0}, buffer = {0};
    uint64_t begin = 0, length = 0;
    RT_TRY(find_item(g, "bufferViews", reference, NO_INDEX, "an accessor", &range));
    RT_TRY(read_integer(g, &range, "byteOffset", 0, 0, &begin));
    RT_TRY(read_integer(g, &range, "byteLength", 1, 0, &length));
    RT_TRY(read_integer(g, &range, "byteStride", (json_int_t)size, (json_int_t)size, stride));
    RT_TRY(
        find_item(g, "buffers", json_object_get(range.object, "buffer"), NO_INDEX, "a bufferView", &buffer));
    if (begin + length > g->buffers[buffer.index].size)
        return fail_item(g, &range, "it ends at byte %llu of a buffer of %zu bytes",
                         (unsigned long long)begin + length, g->buffers[buffer.index].size);
    if (*stride > 252 || skip + *stride * (count - 1) + size > length)
        return fail_item(g, owner, "its %llu elements do not fit into the %llu bytes of bufferViews[%zu]",
                         (unsigned long long)count, (unsigned long long)length, range.index);
    *data = g->buffers[buffer.index].data + begin + skip;
    return RT_OK;
}

/* Replaces the elements that the member `sparse` lists. */
static RtStatus read_sparse(const Gltf *g, const Item *accessor, json_t *sparse, uint64_t type,
                            bool normalised, Values *out) {
    const Item list = {accessor->list, accessor->index, sparse};
    const Item indices = {accessor->list, accessor->index, json_object_get(sparse, "indices")},
               values = {accessor->list, accessor->index, json_object_get(sparse, "values")};
    const size_t size = component_size(type) * out->width;
    const char *places, *data;
    uint64_t count = 0, skip = 0, index_type = 0, index_stride = 0, stride = 0;
    RT_TRY(read_integer(g, &list, "count", 1, 0, &count));
    if (count > out->count) return fail_item(g, accessor, "it replaces more elements than it has");
    RT_TRY(read_integer(g, &indices, "componentType", UINT8, 0, &index_type));
    RT_TRY(read_integer(g, &indices, "byteOffset", 0, 0, &skip));
    if (index_type != UINT8 && index_type != UINT16 && index_type != UINT32)
        return fail_item(g, accessor, "expected unsigned integers as its sparse indices");
    RT_TRY(find_bytes(g, accessor, json_object_get(indices.object, "bufferView"), skip, count,
                      component_size(index_type), &places, &index_stride));
    RT_TRY(read_integer(g, &values, "byteOffset", 0, 0, &skip));
    RT_TRY(find_bytes(g, accessor, json_object_get(values.object, "bufferView"), skip, count, size, &data,
                      &stride));
    for (uint64_t i = 0; i < count; i++) {
        const double place = component_at(index_type, false, places + index_stride * i);
        if (place >= out->count)
            return fail_item(g, accessor, "it replaces element %.0f, but has %u", place, out->count);
        for (size_t k = 0; k < out->width; k++)
            out->at[(size_t)place * out->width + k] =
                component_at(type, normalised, data + stride * i + component_size(type) * k);
    }
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

/* Reads an accessor of `width` numbers an element; `whole`: of unsigned integers. */
static RtStatus read_accessor(Gltf *g, const json_t *reference, size_t width, bool whole, RtArena *memory,
                              Values *out) {
    const char *const name = width == 1 ? "SCALAR" : width == 3 ? "VEC3" : width == 4 ? "VEC4" : "MAT4";
    Item accessor = {0};
    uint64_t type = 0, count = 0, skip = 0, stride = 0;
    const char *data = NULL;
    RT_TRY(find_item(g, "accessors", reference, NO_INDEX, "a primitive", &accessor));
    RT_TRY(read_integer(g, &accessor, "componentType", 0, -1, &type));
    RT_TRY(read_integer(g, &accessor, "count", 1, 0, &count));
    RT_TRY(read_integer(g, &accessor, "byteOffset", 0, 0, &skip));
    const size_t size = component_size(type) * width;
    const char *shape = json_string_value(json_object_get(accessor.object, "type"));
    const bool is_whole = type == UINT8 || type == UINT16 || type == UINT32;
    if (size == 0 || (whole && !is_whole) || !shape || strcmp(shape, name) != 0)
        return fail_item(g, &accessor, "expected the type %s of %s", name,
                         whole ? "unsigned integers" : "numbers");
    const json_t *view = json_object_get(accessor.object, "bufferView");
    json_t *sparse = json_object_get(accessor.object, "sparse");
    const bool normalised = json_is_true(json_object_get(accessor.object, "normalized"));
    if (count > UINT32_MAX) return fail_item(g, &accessor, "it has too many elements");
    if (!view && !sparse) return fail_item(g, &accessor, "it has no data: neither bufferView nor sparse");
    if (view) RT_TRY(find_bytes(g, &accessor, view, skip, count, size, &data, &stride));
    RT_TRY(count_placed(g, count));
    *out = (Values){(uint32_t)count, width, rt_arena_alloc(memory, count * width, sizeof(double))};
    RT_TRY(rt_arena_check(memory, "an accessor of glTF", g->mesh->text.error));
    for (size_t i = 0; view && i < count * width; i++)
        out->at[i] =
            component_at(type, normalised, data + stride * (i / width) + component_size(type) * (i % width));
    return sparse ? read_sparse(g, &accessor, sparse, type, normalised, out) : RT_OK;
}

static RtVec3d value_at(const Values *values, uint32_t i) {
    const double *at = values->at + i * values->width;
    return rt_vec3d(at[0], at[1], at[2]);
}

/* ---- extensions ---- */

/* Extensions that concern the picture alone do not change the geometry. */
static RtStatus check_extensions(const Gltf *g) {
    static const char *const harmless[] = {"material",
                                           "texture",
                                           "light",
                                           "KHR_xmp",
                                           "KHR_animation",
                                           "KHR_mesh_quantization",
                                           "EXT_mesh_gpu_instancing"};
    static const char *const compressed[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                             "KHR_meshopt_compression"};
    const json_t *required = json_object_get(g->root, "extensionsRequired"), *one;
    size_t i;
    json_array_foreach(required, i, one) {
        const char *name = json_is_string(one) ? json_string_value(one) : "";
        bool ignored = false;
        for (size_t k = 0; k < 3; k++) {
            if (strcmp(name, compressed[k]) == 0)
                return rt_mesh_fail(
                    g->mesh,
                    "its geometry is compressed by %s, which cannot be read: export it without "
                    "compression, or decompress it with a tool such as gltf-transform",
                    name);
        }
        for (size_t k = 0; k < sizeof harmless / sizeof *harmless; k++)
            ignored = ignored || strstr(name, harmless[k]);
        if (!ignored)
            return rt_mesh_fail(
                g->mesh, "the file requires the extension '%.60s', which cannot be read: export it without",
                name);
    }
    if (json_array_size(json_object_get(g->root, "animations")) > 0)
        RT_TRY(rt_mesh_warn(g->mesh, "its animations are left out: everything is at rest"));
    return RT_OK;
}

/* ---- primitives ---- */

enum { TRIANGLES = 4, STRIP = 5, FAN = 6 };

static RtStatus add_triangles(const Gltf *g, uint64_t mode, uint32_t count, const Values *indices) {
    if (count < 3 || (mode == TRIANGLES && count % 3 != 0))
        return rt_mesh_fail(g->mesh, "a primitive of triangles has %u corners", count);
    for (uint32_t i = 0; i + 2 < count; i += mode == TRIANGLES ? 3 : 1) {
        const uint32_t odd = mode == STRIP ? i % 2 : 0; /* every other triangle of a strip is reversed */
        const uint32_t corners[3] = {mode == FAN ? 0 : i, i + 1 + odd, i + 2 - odd};
        for (int k = 0; k < 3; k++)
            RT_TRY(rt_mesh_add_index(g->mesh, indices->at ? indices->at[corners[k]] : corners[k]));
        RT_TRY(rt_mesh_add_polygon(g->mesh));
    }
    return RT_OK;
}

/* Reads an attribute, of as many elements as there are positions. */
static RtStatus read_attribute(Gltf *g, const json_t *reference, uint32_t count, size_t width,
                               RtArena *memory, Values *out) {
    RT_TRY(read_accessor(g, reference, width, false, memory, out));
    if (out->count == count) return RT_OK;
    return rt_mesh_fail(g->mesh, "a primitive has %u positions and %u of another attribute", count,
                        out->count);
}

/* Adds the targets of a primitive to its positions or normals. */
static RtStatus morph(Gltf *g, const json_t *primitive, const json_t *weights, const char *attribute,
                      RtArena *memory, Values *values) {
    const json_t *target;
    size_t i;
    json_array_foreach(json_object_get(primitive, "targets"), i, target) {
        const double weight = json_number_value(json_array_get(weights, i));
        const json_t *reference = json_object_get(target, attribute);
        Values deltas;
        if (weight == 0 || !reference) continue;
        RT_TRY(read_attribute(g, reference, values->count, 3, memory, &deltas));
        for (size_t k = 0; k < (size_t)values->count * 3; k++) values->at[k] += weight * deltas.at[k];
    }
    return RT_OK;
}

/* Adds to each blended[vertex] the weighted transforms of the joints of one set of attributes, and to
 * sums[vertex] the weights. */
static RtStatus blend(Gltf *g, const json_t *attributes, int set, const Skin *skin, uint32_t count,
                      RtArena *memory, RtTransform *blended, double *sums) {
    char name[24];
    Values joints, weights;
    snprintf(name, sizeof name, "JOINTS_%d", set);
    RT_TRY(read_attribute(g, json_object_get(attributes, name), count, 4, memory, &joints));
    snprintf(name, sizeof name, "WEIGHTS_%d", set);
    RT_TRY(read_attribute(g, json_object_get(attributes, name), count, 4, memory, &weights));
    for (size_t i = 0; i < (size_t)count * 4; i++) {
        if (weights.at[i] == 0) continue;
        if (!(joints.at[i] >= 0 && joints.at[i] < skin->count))
            return rt_mesh_fail(g->mesh, "a vertex names joint %g, but its skin has %zu", joints.at[i],
                                skin->count);
        const RtTransform *joint = &skin->joints[(size_t)joints.at[i]];
        for (int k = 0; k < 12; k++) blended[i / 4].m[k / 4][k % 4] += weights.at[i] * joint->m[k / 4][k % 4];
        sums[i / 4] += weights.at[i];
    }
    return RT_OK;
}

/* Moves positions and normals (of no width: none) by the joints of a skin. */
static RtStatus apply_skin(Gltf *g, const json_t *attributes, const Skin *skin, RtArena *memory,
                           Values *positions, Values *normals) {
    RtTransform *blended = rt_arena_alloc(memory, positions->count, sizeof *blended);
    double *sums = rt_arena_alloc(memory, positions->count, sizeof *sums);
    char name[24];
    RT_TRY(rt_arena_check(memory, "a skin of glTF", g->mesh->text.error));
    for (int set = 0; snprintf(name, sizeof name, "JOINTS_%d", set), json_object_get(attributes, name); set++)
        RT_TRY(blend(g, attributes, set, skin, positions->count, memory, blended, sums));
    for (uint32_t i = 0; i < positions->count; i++) {
        if (!(sums[i] > 0)) continue; /* bound to no joint: it stays */
        for (int k = 0; k < 12; k++) blended[i].m[k / 4][k % 4] /= sums[i];
        const RtVec3d place = rt_transform_pointd(&blended[i], value_at(positions, i));
        memcpy(positions->at + 3 * (size_t)i, &place, sizeof place);
        if (normals->width == 0) continue;
        const RtVec3d normal = rt_transform_normald(&blended[i], value_at(normals, i));
        memcpy(normals->at + 3 * (size_t)i, &normal, sizeof normal);
    }
    return RT_OK;
}

/* What a node adds to its mesh. */
typedef struct Pose {
    const json_t *weights; /* of morph targets */
    const Skin *skin;      /* or NULL */
} Pose;

static RtStatus add_vertices(Gltf *g, const json_t *primitive, const Pose *pose, RtArena *memory,
                             uint32_t *count) {
    const json_t *attributes = json_object_get(primitive, "attributes"),
                 *normal = json_object_get(attributes, "NORMAL");
    Values positions, normals = {0};
    g->mesh->vertex_count = g->mesh->normal_count = 0;
    RT_TRY(read_accessor(g, json_object_get(attributes, "POSITION"), 3, false, memory, &positions));
    if (normal) RT_TRY(read_attribute(g, normal, positions.count, 3, memory, &normals));
    RT_TRY(morph(g, primitive, pose->weights, "POSITION", memory, &positions));
    if (normal) RT_TRY(morph(g, primitive, pose->weights, "NORMAL", memory, &normals));
    if (pose->skin) RT_TRY(apply_skin(g, attributes, pose->skin, memory, &positions, &normals));
    for (uint32_t i = 0; i < positions.count; i++)
        RT_TRY(rt_mesh_add_vertex(g->mesh, value_at(&positions, i)));
    for (uint32_t i = 0; i < normals.count; i++)
        RT_TRY(rt_mesh_add_normal(g->mesh, rt_narrow(value_at(&normals, i))));
    *count = positions.count;
    return RT_OK;
}

static RtStatus add_primitive(Gltf *g, const Item *mesh, json_t *primitive, const Pose *pose) {
    RT_ARENA(memory);
    const Item item = {mesh->list, mesh->index, primitive}; /* for messages: of this mesh */
    const json_t *reference = json_object_get(primitive, "indices");
    uint64_t mode = 0;
    uint32_t count = 0;
    Values indices = {0};
    RT_TRY(count_placed(g, 1));
    RT_TRY(read_integer(g, &item, "mode", 0, TRIANGLES, &mode));
    if (mode < TRIANGLES) return rt_mesh_warn(g->mesh, "points and lines are left out");
    if (mode > FAN) return fail_item(g, &item, "expected mode, 0 to 6");
    RT_TRY(add_vertices(g, primitive, pose, &memory, &count));
    if (reference) RT_TRY(read_accessor(g, reference, 1, true, &memory, &indices));
    return add_triangles(g, mode, reference ? indices.count : count, &indices);
}

static RtStatus add_mesh(Gltf *g, const Item *mesh, const Pose *pose) {
    json_t *primitive;
    size_t i;
    const json_t *primitives = json_object_get(mesh->object, "primitives");
    if (!json_is_array(primitives)) return fail_item(g, mesh, "expected primitives, a list");
    json_array_foreach(primitives, i, primitive) RT_TRY(add_primitive(g, mesh, primitive, pose));
    return RT_OK;
}

/* ---- nodes ---- */

/* Moves by t, after the quaternion q (x y z w) has turned what s has scaled. */
static RtTransform place(const double t[3], const double q[4], const double s[3]) {
    const double x = q[0], y = q[1], z = q[2], w = q[3];
    return (RtTransform){
        {{(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - z * w) * s[1], 2 * (x * z + y * w) * s[2], t[0]},
         {2 * (x * y + z * w) * s[0], (1 - 2 * (x * x + z * z)) * s[1], 2 * (y * z - x * w) * s[2], t[1]},
         {2 * (x * z - y * w) * s[0], 2 * (y * z + x * w) * s[1], (1 - 2 * (x * x + y * y)) * s[2], t[2]}}};
}

/* Of the 16 numbers of a matrix, column by column. */
static RtTransform transform_of(const double columns[16]) {
    RtTransform out;
    for (int i = 0; i < 12; i++) out.m[i % 3][i / 3] = columns[i / 3 * 4 + i % 3];
    return out;
}

/* A matrix, or translation, rotation and scale. */
static RtStatus get_transform(const Gltf *g, const Item *node, RtTransform *out) {
    double t[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1}, columns[16];
    const bool matrix = json_object_get(node->object, "matrix");
    if (matrix) RT_TRY(read_numbers(g, node, "matrix", 16, columns));
    RT_TRY(read_numbers(g, node, "translation", 3, t));
    RT_TRY(read_numbers(g, node, "rotation", 4, q));
    RT_TRY(read_numbers(g, node, "scale", 3, s));
    *out = matrix ? transform_of(columns) : place(t, q, s);
    return RT_OK;
}

/* The transform of a node, with those of all above it. */
static RtStatus get_whole_transform(const Gltf *g, const Item *node, RtTransform *out) {
    Item at = *node;
    RT_TRY(get_transform(g, node, out));
    for (int depth = 0; g->parents[at.index] != NO_NODE; depth++) {
        RtTransform above;
        if (depth == DEEPEST) return fail_item(g, node, "it is more than %d levels deep", DEEPEST);
        at.index = g->parents[at.index];
        at.object = json_array_get(json_object_get(g->root, "nodes"), at.index);
        RT_TRY(get_transform(g, &at, &above));
        *out = rt_transform_compose(out, &above);
    }
    return RT_OK;
}

static RtStatus read_skin(Gltf *g, const json_t *reference, RtArena *memory, Skin *skin) {
    Item item = {0}, node = {0};
    Values inverse = {0};
    RT_TRY(find_item(g, "skins", reference, NO_INDEX, "a node", &item));
    const json_t *joints = json_object_get(item.object, "joints"),
                 *matrices = json_object_get(item.object, "inverseBindMatrices");
    skin->count = json_array_size(joints);
    skin->joints = rt_arena_alloc(memory, skin->count, sizeof *skin->joints);
    RT_TRY(rt_arena_check(memory, "a skin of glTF", g->mesh->text.error));
    if (matrices) RT_TRY(read_accessor(g, matrices, 16, false, memory, &inverse));
    if (matrices && inverse.count < skin->count)
        return fail_item(g, &item, "it has %zu joints, but %u matrices", skin->count, inverse.count);
    RT_TRY(count_placed(g, skin->count));
    for (size_t i = 0; i < skin->count; i++) {
        RtTransform joint;
        RT_TRY(find_item(g, "nodes", json_array_get(joints, i), NO_INDEX, "a skin", &node));
        RT_TRY(get_whole_transform(g, &node, &joint));
        const RtTransform bind = matrices ? transform_of(inverse.at + 16 * i) : rt_transform_identity();
        skin->joints[i] = rt_transform_compose(&bind, &joint);
    }
    return RT_OK;
}

/* The transforms of a node's instances: *count of them, and 0 if it has none. */
static RtStatus read_instances(Gltf *g, const Item *node, RtArena *memory, uint32_t *count,
                               RtTransform **out) {
    static const char *const names[3] = {"TRANSLATION", "ROTATION", "SCALE"};
    static const double rest[3][4] = {{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}};
    const json_t *extension =
                     json_object_get(json_object_get(node->object, "extensions"), "EXT_mesh_gpu_instancing"),
                 *attributes = json_object_get(extension, "attributes");
    Values parts[3] = {0};
    *count = 0;
    for (int i = 0; i < 3; i++) {
        const json_t *reference = json_object_get(attributes, names[i]);
        if (!reference) continue;
        RT_TRY(read_accessor(g, reference, i == 1 ? 4 : 3, false, memory, &parts[i]));
        if (*count > 0 && parts[i].count != *count)
            return fail_item(g, node, "its instances differ in number");
        *count = parts[i].count;
    }
    *out = rt_arena_alloc(memory, *count, sizeof **out);
    RT_TRY(rt_arena_check(memory, "instances of glTF", g->mesh->text.error));
    for (uint32_t k = 0; k < *count; k++) {
        const double *at[3];
        for (int i = 0; i < 3; i++) at[i] = parts[i].at ? parts[i].at + parts[i].width * k : rest[i];
        (*out)[k] = place(at[0], at[1], at[2]);
    }
    return RT_OK;
}

/* Adds the mesh of a node: skinned, in each of its instances, or once. */
static RtStatus add_mesh_of(Gltf *g, const Item *node, const RtTransform *whole) {
    RT_ARENA(memory);
    const json_t *skin_reference = json_object_get(node->object, "skin"),
                 *weights = json_object_get(node->object, "weights");
    Item mesh = {0};
    Skin skin = {0};
    RtTransform *instances = NULL;
    uint32_t count;
    RT_TRY(find_item(g, "meshes", json_object_get(node->object, "mesh"), NO_INDEX, "a node", &mesh));
    if (skin_reference) RT_TRY(read_skin(g, skin_reference, &memory, &skin));
    const Pose pose = {weights ? weights : json_object_get(mesh.object, "weights"),
                       skin_reference ? &skin : NULL};
    RT_TRY(read_instances(g, node, &memory, &count, &instances));
    if (count > 0) RT_TRY(rt_mesh_warn(g->mesh, "instances (EXT_mesh_gpu_instancing) become copies"));
    for (uint32_t i = 0; i < (count > 0 ? count : 1); i++) {
        g->mesh->transform = skin_reference ? g->outer
                             : count > 0    ? rt_transform_compose(&instances[i], whole)
                                            : *whole;
        RT_TRY(add_mesh(g, &mesh, &pose));
    }
    return RT_OK;
}

/* Nodes are trees, so each is visited once. */
static RtStatus add_node(Gltf *g, const json_t *reference, const char *by, const RtTransform *above,
                         int depth) {
    Item node;
    RtTransform own, whole;
    const json_t *child;
    size_t i;
    RT_TRY(find_item(g, "nodes", reference, NO_INDEX, by, &node));
    if (g->visited[node.index]) return fail_item(g, &node, "it is named twice, but nodes form a tree");
    if (depth == DEEPEST) return fail_item(g, &node, "it is more than %d levels deep", DEEPEST);
    g->visited[node.index] = true;
    RT_TRY(get_transform(g, &node, &own));
    whole = rt_transform_compose(&own, above);
    if (json_object_get(node.object, "mesh")) RT_TRY(add_mesh_of(g, &node, &whole));
    json_array_foreach(json_object_get(node.object, "children"), i, child)
        RT_TRY(add_node(g, child, "a node", &whole, depth + 1));
    return RT_OK;
}

/* Notes the parent of each node, which skins climb to. */
static RtStatus find_parents(Gltf *g) {
    const json_t *nodes = json_object_get(g->root, "nodes"), *node, *child;
    size_t i, k;
    g->node_count = json_array_size(nodes);
    g->visited = rt_arena_alloc(&g->memory, g->node_count, sizeof *g->visited);
    g->parents = rt_arena_alloc_unset(&g->memory, g->node_count, sizeof *g->parents);
    RT_TRY(rt_arena_check(&g->memory, "nodes of glTF", g->mesh->text.error));
    for (i = 0; i < g->node_count; i++) g->parents[i] = NO_NODE;
    json_array_foreach(nodes, i, node) {
        json_array_foreach(json_object_get(node, "children"), k, child) {
            const json_int_t index = whole_of(child, NO_INDEX);
            if (index >= 0 && (size_t)index < g->node_count) g->parents[index] = (uint32_t)i;
        }
    }
    return RT_OK;
}

static RtStatus add_scene(Gltf *g) {
    const json_t *node;
    Item scene = {0};
    size_t i;
    RT_TRY(find_item(g, "scenes", json_object_get(g->root, "scene"), 0, "the file", &scene));
    RT_TRY(find_parents(g));
    json_array_foreach(json_object_get(scene.object, "nodes"), i, node)
        RT_TRY(add_node(g, node, "the scene", &g->outer, 0));
    return RT_OK;
}

/* ---- the file ---- */

static RtStatus read_document(Gltf *g, const char *text, size_t size) {
    const RtScanner *file = &g->mesh->text;
    json_error_t where;
    if (size > RT_MESH_MAX_JSON)
        return rt_mesh_fail(g->mesh, "its JSON has %zu bytes: the limit is %d", size, RT_MESH_MAX_JSON);
    while (size > 0 && text[size - 1] == 0) size--; /* a chunk's padding should be blanks */
    g->root =
        json_loadb(text, size, JSON_REJECT_DUPLICATES | JSON_ALLOW_NUL | JSON_DECODE_INT_AS_REAL, &where);
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
    Gltf g = {.mesh = r, .chunk = chunk, .size = size, .outer = r->transform};
    const RtVec3d origin = rt_transform_pointd(&r->transform, rt_scaled(r->offset, -1));
    for (int a = 0; a < 3; a++) g.outer.m[a][3] = origin.at[a];
    r->offset = rt_vec3d(0, 0, 0); /* of the scene: it is subtracted behind the transforms of the nodes */
    RtStatus status = read_document(&g, text, size);
    for (size_t i = 0; i < g.buffer_count; i++) {
        if (g.buffers[i].data != chunk.data) rt_free(g.buffers[i].data);
    }
    rt_arena_clear(&g.memory);
    json_decref(g.root);
    return status;
}

RtStatus rt_mesh_read_gltf(RtMeshReader *r) {
    RT_TRY(rt_mesh_begin_text(r));
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
