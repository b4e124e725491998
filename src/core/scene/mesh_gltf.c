/* SPDX-License-Identifier: Apache-2.0 */
/* glTF 2.0, as JSON (.gltf) or binary (.glb): the triangles of all nodes of the scene, nodes depth first,
 * each with its matrices, at rest: morph targets with the weights of the file, skins in the pose of their
 * joints. A mesh of PART_TRIANGLES or more that is placed several times, by nodes or by
 * EXT_mesh_gpu_instancing, becomes a part and instances of it, where it needs no skin and no mirror, and the
 * file is the whole scene; else copies. Materials are ignored, animations with a warning. Files that need
 * another extension for their geometry are rejected.
 *
 * First all nodes are placed, because a skin needs the places of its joints; then come their meshes. Every
 * member is checked where it is read. A buffer is read when it is first used, and what is read of it is
 * inside it. */
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/scene/mesh.h"

#include <ctype.h>
#include <jansson.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

typedef struct Buffer {
    char *data; /* NULL: not read */
    size_t size;
} Buffer;

/* An entry of one of the document's lists, or an object inside it. */
typedef struct Item {
    const char *list;
    size_t index;
    json_t *object;
} Item;

/* A node where the scene places it, and its mesh; a zeroed struct: it has none. */
typedef struct Place {
    Item node, mesh;
    RtTransform transform;
} Place;

/* A mesh that may be placed several times. */
typedef struct Shared {
    uint64_t places; /* nodes that do */
    uint32_t part;   /* of the scene, plus 1; 0: not tried; NO_PART: too small */
} Shared;

typedef struct Instance {
    uint32_t part;
    RtTransform to_world;
} Instance;

typedef struct Gltf {
    RtMeshReader *mesh;
    json_t *root;
    Buffer chunk;      /* the binary chunk of a .glb, borrowed; a zeroed struct: none */
    Buffer *buffers;   /* one for each of the document's, their data owned, except `chunk` */
    size_t size;       /* bytes of the document and the buffers read so far */
    uint64_t placed;   /* nodes, primitives, and elements of their accessors so far */
    uint32_t *last_of; /* one for each of the document's nodes: 1 + its last place; 0: not in the scene */
    Place *places;     /* [place_count] */
    uint32_t place_count, place_capacity;
    Shared *shared;      /* one for each of the document's meshes */
    Instance *instances; /* [instance_count], to be added after all triangles */
    uint32_t instance_count, instance_capacity;
    RtArena memory;
} Gltf;

/* The elements of an accessor, decoded. */
typedef struct Values {
    uint32_t count; /* 0: there is no accessor */
    union {
        double *at;       /* [count * width] */
        RtVec3d *vectors; /* [count], of width 3 */
    };
} Values;

/* What a node adds to its mesh. */
typedef struct Pose {
    const json_t *weights; /* of morph targets */
    size_t joint_count;
    RtTransform *joints;   /* [joint_count], from the mesh to the scene; NULL: no skin */
    RtTransform transform; /* of what has no skin */
} Pose;

/* MOST_PLACED: for each byte of the file; a forest of 10,000 trees of 10,000 triangles has 400. */
enum { DEEPEST = 256, MOST_PLACED = 1000 };

/* Below it a ray would take longer to enter an instance than to test copies. */
enum { PART_TRIANGLES = 100 };
#define NO_PART UINT32_MAX

#define MOST_INTEGER 0x1p40 /* sums fit 64 bits */

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

static Item inside(const Item *item, json_t *object) {
    return (Item){item->list, item->index, object};
}

/* A number may be written as 3.0; -1 is none. */
static double number_of(const json_t *member) {
    return json_is_number(member) ? json_number_value(member) : -1;
}

static bool is_index(double value, double count) {
    return value >= 0 && value < count && value == floor(value);
}

/* Finds the object of `list` whose index is `reference`, which stands in `owner`. */
static RtStatus find_item(const Gltf *g, const Item *owner, const json_t *reference, const char *list,
                          Item *item) {
    const json_t *all = json_object_get(g->root, list);
    const size_t count = json_array_size(all);
    if (!is_index(number_of(reference), (double)count))
        return fail_item(g, owner, "expected the index of one of the %zu %s (counted from 0)", count, list);
    const size_t index = (size_t)json_number_value(reference);
    *item = (Item){list, index, json_array_get(all, index)};
    return json_is_object(item->object) ? RT_OK : fail_item(g, item, "expected an object");
}

/* Gets the integer `key`, or `otherwise` if there is none. Rejects less than `least`, so an `otherwise` below
 * it makes the member mandatory; and more than 2^40. */
static RtStatus read_integer(const Gltf *g, const Item *item, const char *key, double least, double otherwise,
                             uint64_t *out) {
    const json_t *member = json_object_get(item->object, key);
    const double value = member ? number_of(member) : otherwise;
    if (value < least || !is_index(value, MOST_INTEGER))
        return fail_item(g, item, "expected %s, an integer of at least %.0f", key, least);
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

/* ---- extensions ---- */

static bool has_part(const char *name, const char *const parts[]) {
    while (*parts && !strstr(name, *parts)) parts++;
    return *parts;
}

/* Rejects compressed geometry, if it `matters` and the document lists its extension in `list`. Of the others,
 * which are neither read nor concern the picture alone, rejects those that it requires, and warns of those
 * that it uses. */
static RtStatus check_extensions(const Gltf *g, const char *list, bool matters) {
    static const char *const compressed[] = {"draco", "meshopt", NULL};
    static const char *const known[] = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing", NULL};
    static const char *const picture[] = {"material", "texture",   "technique", "light",
                                          "KHR_xmp",  "animation", NULL};
    const bool required = strcmp(list, "extensionsRequired") == 0;
    const json_t *one;
    size_t i;
    json_array_foreach(json_object_get(g->root, list), i, one) {
        const char *name = json_is_string(one) ? json_string_value(one) : "";
        const bool packed = has_part(name, compressed);
        if (packed && matters)
            return rt_mesh_fail(
                g->mesh,
                "its geometry is compressed by %.60s, which cannot be read: export it without "
                "compression, or decompress it with a tool such as gltf-transform",
                name);
        if (packed || has_part(name, known) || has_part(name, picture)) continue;
        if (required)
            return rt_mesh_fail(
                g->mesh, "it requires the extension '%.60s', which cannot be read: export it without", name);
        if (!matters) RT_TRY(rt_mesh_warn(g->mesh, "the extension '%.60s' is ignored", name));
    }
    return RT_OK;
}

/* ---- buffers ---- */

/* Decodes base64 to out[0..strlen(text)); returns the number of bytes, or SIZE_MAX if it is damaged. */
static size_t decode_base64(const char *text, char *out) {
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

/* Decodes "%20" and the like. */
static void decode_path(const char *uri, char out[RT_MAX_PATH]) {
    size_t length = 0;
    for (; *uri && length + 1 < RT_MAX_PATH; uri++) {
        unsigned code = (unsigned char)*uri;
        if (*uri == '%' && isxdigit((unsigned char)uri[1]) && isxdigit((unsigned char)uri[2])) {
            sscanf(uri + 1, "%2x", &code);
            uri += 2;
        }
        out[length++] = (char)code;
    }
    out[length] = '\0';
}

static RtStatus load_file(const Gltf *g, const Item *item, const char *uri, Buffer *buffer) {
    const size_t limit = g->size < RT_MESH_MAX_BYTES ? RT_MESH_MAX_BYTES - g->size : 0; /* of all together */
    char folder[RT_MAX_PATH], name[RT_MAX_PATH], path[RT_MAX_PATH];
    if (strstr(uri, "://")) return fail_item(g, item, "its uri '%.60s' is not a file", uri);
    decode_path(uri, name);
    rt_path_folder(g->mesh->text.path, folder);
    RT_TRY(rt_path_join(folder, name, path, g->mesh->text.error));
    return rt_file_read(path, limit, &buffer->data, &buffer->size, g->mesh->text.error);
}

/* Reads a buffer: the chunk, embedded, or a file beside the document. */
static RtStatus load_buffer(Gltf *g, const Item *item, Buffer *buffer) {
    static const char base64[] = ";base64,";
    const json_t *member = json_object_get(item->object, "uri");
    const char *uri = json_string_value(member), *data = uri ? strstr(uri, base64) : NULL;
    uint64_t length = 0;
    RT_TRY(read_integer(g, item, "byteLength", 1, 0, &length));
    if (!member && item->index == 0 && g->chunk.data) {
        *buffer = g->chunk;
    } else if (!uri) {
        return fail_item(g, item, "expected uri, the data or the name of a file");
    } else if (strncmp(uri, "data:", 5) != 0) {
        RT_TRY(load_file(g, item, uri, buffer));
    } else if (!data) {
        return fail_item(g, item, "its data is not in base64");
    } else {
        buffer->data = rt_alloc_unset(strlen(data), 1);
        if (!buffer->data) return rt_fail_memory(g->mesh->text.error, "a buffer of glTF", strlen(data));
        buffer->size = decode_base64(data + strlen(base64), buffer->data);
        if (buffer->size == SIZE_MAX) return fail_item(g, item, "its base64 is damaged");
    }
    g->size += buffer->size;
    if (buffer->size >= length) return RT_OK;
    return fail_item(g, item, "it declares %llu bytes, but has %zu: it is cut off",
                     (unsigned long long)length, buffer->size);
}

/* ---- accessors ---- */

/* Component types, from 5120 to 5126. All but the last are integers. */
enum { FIRST_TYPE = 5120, FLOAT32 = 6, TYPES };
static const struct {
    size_t size;    /* bytes */
    double largest; /* of an integer; one that seems to be larger is negative */
} types[TYPES] = {{1, INT8_MAX}, {1, UINT8_MAX},  {2, INT16_MAX}, {2, UINT16_MAX},
                  {0, 0},        {4, UINT32_MAX}, {4, 0}};

static RtStatus alloc_values(const Gltf *g, RtArena *memory, uint64_t count, size_t width, Values *out) {
    *out = (Values){(uint32_t)count, {rt_arena_alloc(memory, count * width, sizeof *out->at)}};
    return rt_arena_check(memory, "an accessor of glTF", g->mesh->text.error);
}

static double number_at(const char *at, size_t type, bool normalised) {
    const double largest = types[type].largest;
    uint32_t bits = 0;
    float number;
    memcpy(&bits, at, types[type].size);
    memcpy(&number, &bits, sizeof number);
    if (type == FLOAT32) return (double)number;
    const double value = bits <= largest ? bits : bits - ldexp(1, (int)types[type].size * 8);
    return normalised ? fmax(value / largest, -1) : value;
}

/* Decodes `count` elements of `width` numbers from the bufferView that `item` names, an accessor or a part of
 * its `sparse`. Their type stands in `typed`. */
static RtStatus decode(Gltf *g, const Item *item, const Item *typed, size_t width, uint64_t count,
                       RtArena *memory, Values *out) {
    const bool normalised = json_is_true(json_object_get(typed->object, "normalized"));
    Item view = {0}, buffer = {0};
    uint64_t code = 0, skip = 0, begin = 0, length = 0, stride = 0;
    RT_TRY(read_integer(g, typed, "componentType", FIRST_TYPE, -1, &code));
    RT_TRY(find_item(g, item, json_object_get(item->object, "bufferView"), "bufferViews", &view));
    RT_TRY(find_item(g, &view, json_object_get(view.object, "buffer"), "buffers", &buffer));
    RT_TRY(read_integer(g, item, "byteOffset", 0, 0, &skip));
    RT_TRY(read_integer(g, &view, "byteOffset", 0, 0, &begin));
    RT_TRY(read_integer(g, &view, "byteLength", 1, 0, &length));
    RT_TRY(read_integer(g, &view, "byteStride", 0, 0, &stride));
    Buffer *bytes = &g->buffers[buffer.index];
    if (!bytes->data) RT_TRY(load_buffer(g, &buffer, bytes));
    const size_t type = code - FIRST_TYPE, part = type < TYPES ? types[type].size : 0, size = part * width;
    if (part == 0) return fail_item(g, typed, "expected componentType, 5120 to 5126 without 5124");
    if (begin + length > bytes->size)
        return fail_item(g, &view, "it ends at byte %llu of a buffer of %zu bytes",
                         (unsigned long long)begin + length, bytes->size);
    if (stride == 0) stride = size;
    if (stride < size || skip + size > length || (length - skip - size) / stride < count - 1)
        return fail_item(g, item, "its %llu elements do not fit into the %llu bytes of bufferViews[%zu]",
                         (unsigned long long)count, (unsigned long long)length, view.index);
    RT_TRY(alloc_values(g, memory, count, width, out));
    const char *first = bytes->data + begin + skip;
    for (uint64_t i = 0; i < count; i++) {
        for (size_t k = 0; k < width; k++)
            out->at[i * width + k] = number_at(first + stride * i + part * k, type, normalised);
    }
    return RT_OK;
}

/* Nodes may place a mesh many times, and primitives share vertices: a small file could take days. */
static RtStatus count_placed(Gltf *g, uint64_t count) {
    g->placed += count;
    if (g->placed / MOST_PLACED <= g->size) return RT_OK;
    return rt_mesh_fail(g->mesh,
                        "its nodes place more than %d vertices and corners for each of its %zu bytes: divide "
                        "the file, or export it without the vertices that a primitive does not use",
                        MOST_PLACED, g->size);
}

/* Replaces the elements that the member `sparse` lists. */
static RtStatus replace_elements(Gltf *g, const Item *accessor, size_t width, Values *out) {
    RT_ARENA(memory);
    const Item sparse = inside(accessor, json_object_get(accessor->object, "sparse")),
               indices = inside(accessor, json_object_get(sparse.object, "indices")),
               elements = inside(accessor, json_object_get(sparse.object, "values"));
    Values places, values;
    uint64_t count = 0;
    RT_TRY(read_integer(g, &sparse, "count", 1, 0, &count));
    if (count > out->count) return fail_item(g, accessor, "it replaces more elements than it has");
    RT_TRY(decode(g, &indices, &indices, 1, count, &memory, &places));
    RT_TRY(decode(g, &elements, accessor, width, count, &memory, &values));
    for (size_t i = 0; i < count; i++) {
        if (!is_index(places.at[i], out->count))
            return fail_item(g, accessor, "it replaces element %g, but has %u", places.at[i], out->count);
        memcpy(out->at + (size_t)places.at[i] * width, values.at + i * width, width * sizeof *out->at);
    }
    return RT_OK;
}

/* Reads the accessor that `owner` names as `key`, with `width` numbers an element and, unless `expected` is
 * 0, so many elements. Without one, *out is zeroed. */
static RtStatus read_accessor(Gltf *g, const Item *owner, const char *key, size_t width, uint32_t expected,
                              RtArena *memory, Values *out) {
    const char *const name = width == 1   ? "SCALAR"
                             : width == 2 ? "VEC2"
                             : width == 3 ? "VEC3"
                             : width == 4 ? "VEC4"
                                          : "MAT4";
    const json_t *reference = json_object_get(owner->object, key);
    Item item = {0};
    uint64_t count = 0;
    *out = (Values){0};
    if (!reference) return RT_OK;
    RT_TRY(find_item(g, owner, reference, "accessors", &item));
    RT_TRY(read_integer(g, &item, "count", 1, 0, &count));
    const json_t *sparse = json_object_get(item.object, "sparse");
    const char *type = json_string_value(json_object_get(item.object, "type"));
    if (!type || strcmp(type, name) != 0)
        return fail_item(g, &item, "expected the type %s, for %s", name, key);
    if (count > UINT32_MAX || (expected && count != expected))
        return fail_item(g, owner, "expected %u elements of %s, found %llu", expected, key,
                         (unsigned long long)count);
    if (json_object_get(item.object, "bufferView")) {
        RT_TRY(decode(g, &item, &item, width, count, memory, out));
    } else { /* zeros */
        if (!sparse) RT_TRY(check_extensions(g, "extensionsUsed", true));
        if (count > g->size)
            return fail_item(g, &item, "it has more elements, without data, than the file has bytes");
        RT_TRY(alloc_values(g, memory, count, width, out));
    }
    RT_TRY(count_placed(g, count));
    return sparse ? replace_elements(g, &item, width, out) : RT_OK;
}

/* ---- primitives ---- */

enum { TRIANGLES = 4, STRIP = 5, FAN = 6 };

static RtStatus add_triangles(const Gltf *g, uint64_t mode, uint32_t count, const double *indices) {
    if (count < 3) return rt_mesh_warn(g->mesh, "primitives of one or two corners are left out");
    if (mode == TRIANGLES && count % 3 != 0)
        return rt_mesh_fail(g->mesh, "a primitive of triangles has %u corners", count);
    for (uint32_t i = 0; i + 2 < count; i += mode == TRIANGLES ? 3 : 1) {
        const uint32_t odd = mode == STRIP ? i % 2 : 0; /* every other triangle of a strip is reversed */
        const uint32_t corners[3] = {mode == FAN ? 0 : i, i + 1 + odd, i + 2 - odd};
        for (int k = 0; k < 3; k++)
            RT_TRY(rt_mesh_add_index(g->mesh, indices ? indices[corners[k]] : corners[k]));
        RT_TRY(rt_mesh_add_polygon(g->mesh));
    }
    return RT_OK;
}

/* Adds the weighted targets of a primitive to its positions or normals. */
static RtStatus morph(Gltf *g, const Item *primitive, const json_t *weights, const char *key,
                      Values *values) {
    const json_t *targets = json_object_get(primitive->object, "targets");
    json_t *target;
    size_t i;
    RT_TRY(count_placed(g, json_array_size(targets)));
    json_array_foreach(targets, i, target) {
        RT_ARENA(memory);
        const Item item = inside(primitive, target);
        const json_t *member = json_array_get(weights, i);
        const double weight = json_number_value(member);
        Values deltas = {0};
        if (member && !json_is_number(member)) return fail_item(g, primitive, "expected weights, numbers");
        if (weight != 0) RT_TRY(read_accessor(g, &item, key, 3, values->count, &memory, &deltas));
        for (size_t k = 0; deltas.at && k < 3 * (size_t)values->count; k++)
            values->at[k] += weight * deltas.at[k];
    }
    return RT_OK;
}

/* Moves positions and normals by the joints of a skin, into the scene; the node says only, by mirroring,
 * which side is the front. */
static RtStatus apply_skin(Gltf *g, const Item *attributes, const Pose *pose, Values *positions,
                           Values *normals) {
    RT_ARENA(memory);
    const size_t count = positions->count;
    RtTransform *blended = rt_arena_alloc(&memory, count, sizeof *blended);
    double *sums = rt_arena_alloc(&memory, count, sizeof *sums);
    const double sign = rt_mesh_is_mirror(&pose->transform) ? -1 : 1;
    char joints_key[24] = "JOINTS_0", weights_key[24] = "WEIGHTS_0";
    RT_TRY(rt_arena_check(&memory, "a skin of glTF", g->mesh->text.error));
    for (int set = 1; json_object_get(attributes->object, joints_key); set++) {
        RT_ARENA(of_set);
        Values joints, weights;
        RT_TRY(read_accessor(g, attributes, joints_key, 4, positions->count, &of_set, &joints));
        RT_TRY(read_accessor(g, attributes, weights_key, 4, positions->count, &of_set, &weights));
        for (size_t i = 0; weights.at && i < 4 * count; i++) {
            if (weights.at[i] == 0) continue;
            if (!is_index(joints.at[i], (double)pose->joint_count))
                return fail_item(g, attributes, "a vertex names joint %g, but its skin has %zu", joints.at[i],
                                 pose->joint_count);
            const RtTransform *joint = &pose->joints[(size_t)joints.at[i]];
            for (int k = 0; k < 12; k++)
                blended[i / 4].m[k / 4][k % 4] += weights.at[i] * joint->m[k / 4][k % 4];
            sums[i / 4] += weights.at[i];
        }
        snprintf(joints_key, sizeof joints_key, "JOINTS_%d", set);
        snprintf(weights_key, sizeof weights_key, "WEIGHTS_%d", set);
    }
    for (size_t i = 0; i < count; i++) {
        if (fabs(sums[i] - 1) > 0.01)
            RT_TRY(rt_mesh_warn(
                g->mesh,
                "the joint weights of a vertex add up to %g: they are scaled to 1, or if 0, it stays",
                sums[i]));
        if (sums[i] == 0) blended[i] = pose->transform;
        for (int k = 0; k < 12; k++) blended[i].m[k / 4][k % 4] *= sign / (sums[i] == 0 ? 1 : sums[i]);
        positions->vectors[i] = rt_transform_pointd(&blended[i], positions->vectors[i]);
        if (normals->at) normals->vectors[i] = rt_transform_normald(&blended[i], normals->vectors[i]);
    }
    g->mesh->transform = rt_transform_identity();
    for (int a = 0; a < 3; a++) g->mesh->transform.m[a][a] = sign;
    return RT_OK;
}

static RtStatus add_primitive(Gltf *g, const Item *mesh, json_t *object, const Pose *pose) {
    RT_ARENA(memory);
    RtMeshReader *r = g->mesh;
    const Item primitive = inside(mesh, object),
               attributes = inside(mesh, json_object_get(object, "attributes"));
    uint64_t mode = 0;
    Values positions, normals, uvs = {0}, indices;
    RT_TRY(count_placed(g, 1));
    RT_TRY(read_integer(g, &primitive, "mode", 0, TRIANGLES, &mode));
    if (mode > FAN) return fail_item(g, &primitive, "expected mode, 0 to 6");
    if (mode < TRIANGLES) return rt_mesh_warn(r, "points and lines are left out");
    RT_TRY(read_accessor(g, &attributes, "POSITION", 3, 0, &memory, &positions));
    if (!positions.at) return rt_mesh_warn(r, "primitives without positions are left out");
    RT_TRY(read_accessor(g, &attributes, "NORMAL", 3, positions.count, &memory, &normals));
    if (r->textured) RT_TRY(read_accessor(g, &attributes, "TEXCOORD_0", 2, positions.count, &memory, &uvs));
    RT_TRY(read_accessor(g, &primitive, "indices", 1, 0, &memory, &indices));
    RT_TRY(morph(g, &primitive, pose->weights, "POSITION", &positions));
    RT_TRY(morph(g, &primitive, pose->weights, "NORMAL", &normals));
    r->transform = pose->transform;
    if (pose->joints && json_object_get(attributes.object, "JOINTS_0"))
        RT_TRY(apply_skin(g, &attributes, pose, &positions, &normals));
    r->vertex_count = r->normal_count = r->uv_count = 0;
    for (uint32_t i = 0; i < positions.count; i++) RT_TRY(rt_mesh_add_vertex(r, positions.vectors[i]));
    for (uint32_t i = 0; i < normals.count; i++) RT_TRY(rt_mesh_add_normal(r, rt_narrow(normals.vectors[i])));
    for (size_t i = 0; i < uvs.count; i++) /* v grows downward */
        RT_TRY(rt_mesh_add_uv(r, (RtUv){(float)uvs.at[2 * i], (float)(1 - uvs.at[2 * i + 1])}));
    return add_triangles(g, mode, indices.at ? indices.count : positions.count, indices.at);
}

/* ---- nodes ---- */

/* Moves by t, after the quaternion q (x y z w) has turned what s has scaled. */
static RtTransform compose_steps(const double t[3], const double q[4], const double s[3]) {
    const double x = q[0], y = q[1], z = q[2], w = q[3], square = x * x + y * y + z * z + w * w,
                 n = square > 0 ? 2 / square : 0; /* stored in few bits, its length is not quite 1 */
    return (RtTransform){
        {{(1 - n * (y * y + z * z)) * s[0], n * (x * y - z * w) * s[1], n * (x * z + y * w) * s[2], t[0]},
         {n * (x * y + z * w) * s[0], (1 - n * (x * x + z * z)) * s[1], n * (y * z - x * w) * s[2], t[1]},
         {n * (x * z - y * w) * s[0], n * (y * z + x * w) * s[1], (1 - n * (x * x + y * y)) * s[2], t[2]}}};
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
    RT_TRY(read_numbers(g, node, "matrix", 16, columns));
    RT_TRY(read_numbers(g, node, "translation", 3, t));
    RT_TRY(read_numbers(g, node, "rotation", 4, q));
    RT_TRY(read_numbers(g, node, "scale", 3, s));
    *out = matrix ? transform_of(columns) : compose_steps(t, q, s);
    return RT_OK;
}

static RtStatus place_node(Gltf *g, const Item *node, const RtTransform *above, int depth) {
    Place place = {.node = *node};
    RtTransform own;
    Item below = {0};
    const json_t *mesh = json_object_get(node->object, "mesh"), *child;
    size_t i;
    if (depth == DEEPEST)
        return fail_item(g, node, "it is more than %d levels deep, or below itself", DEEPEST);
    RT_TRY(count_placed(g, MOST_PLACED)); /* a place takes memory; a node has a byte at least */
    RT_TRY(get_transform(g, node, &own));
    place.transform = rt_transform_compose(&own, above);
    if (mesh) RT_TRY(find_item(g, node, mesh, "meshes", &place.mesh));
    if (mesh) g->shared[place.mesh.index].places++;
    if (g->last_of[node->index])
        RT_TRY(rt_mesh_warn(g->mesh, "nodes[%zu] has several parents: it is placed below each", node->index));
    RT_TRY(rt_append(&g->places, &g->place_count, &g->place_capacity, &place, sizeof place,
                     g->mesh->text.error));
    g->last_of[node->index] = g->place_count;
    json_array_foreach(json_object_get(node->object, "children"), i, child) {
        RT_TRY(find_item(g, node, child, "nodes", &below));
        RT_TRY(place_node(g, &below, &place.transform, depth + 1));
    }
    return RT_OK;
}

/* Places the nodes of the scene; without a scene, all. */
static RtStatus place_nodes(Gltf *g) {
    const json_t *scenes = json_object_get(g->root, "scenes"), *reference = json_object_get(g->root, "scene"),
                 *nodes = json_object_get(g->root, "nodes"), *child;
    const size_t count = json_array_size(nodes);
    Item scene = {"scenes", 0, json_array_get(scenes, 0)};
    json_t *one;
    size_t i, k;
    bool *is_child = rt_arena_alloc(&g->memory, count, sizeof *is_child);
    g->last_of = rt_arena_alloc(&g->memory, count, sizeof *g->last_of);
    RT_TRY(rt_arena_check(&g->memory, "nodes of glTF", g->mesh->text.error));
    json_array_foreach(nodes, i, one) {
        json_array_foreach(json_object_get(one, "children"), k, child) {
            if (is_index(number_of(child), (double)count)) is_child[(size_t)number_of(child)] = true;
        }
    }
    if (reference) RT_TRY(find_item(g, &scene, reference, "scenes", &scene));
    if (!scene.object && !nodes)
        return rt_mesh_fail(g->mesh, "expected scenes, or nodes that place its meshes");
    if (!scene.object) RT_TRY(rt_mesh_warn(g->mesh, "it has no scene: all its nodes are read"));
    if (json_array_size(scenes) > 1) RT_TRY(rt_mesh_warn(g->mesh, "it has several scenes: only one is read"));
    json_array_foreach(scene.object ? json_object_get(scene.object, "nodes") : nodes, i, one) {
        Item node = {"nodes", i, one};
        if (scene.object) RT_TRY(find_item(g, &scene, one, "nodes", &node));
        if (scene.object && is_child[node.index])
            return fail_item(g, &scene, "its nodes[%zu] is also below another node", node.index);
        if (!is_child[node.index]) RT_TRY(place_node(g, &node, &g->mesh->transform, 0));
    }
    return RT_OK;
}

/* ---- meshes ---- */

static RtStatus read_skin(Gltf *g, const Item *node, RtArena *memory, Pose *pose) {
    const json_t *reference = json_object_get(node->object, "skin");
    Item skin = {0}, joint = {0};
    Values inverse;
    if (!reference) return RT_OK;
    RT_TRY(find_item(g, node, reference, "skins", &skin));
    const json_t *joints = json_object_get(skin.object, "joints");
    pose->joint_count = json_array_size(joints);
    pose->joints = rt_arena_alloc(memory, pose->joint_count, sizeof *pose->joints);
    RT_TRY(rt_arena_check(memory, "a skin of glTF", g->mesh->text.error));
    RT_TRY(read_accessor(g, &skin, "inverseBindMatrices", 16, 0, memory, &inverse));
    if (inverse.at && inverse.count < pose->joint_count)
        return fail_item(g, &skin, "it has %zu joints, but %u matrices", pose->joint_count, inverse.count);
    RT_TRY(count_placed(g, pose->joint_count));
    for (size_t i = 0; i < pose->joint_count; i++) {
        RT_TRY(find_item(g, &skin, json_array_get(joints, i), "nodes", &joint));
        if (!g->last_of[joint.index])
            return fail_item(g, &skin, "its joint nodes[%zu] is not in the scene", joint.index);
        const RtTransform bind = inverse.at ? transform_of(inverse.at + 16 * i) : rt_transform_identity();
        pose->joints[i] = rt_transform_compose(&bind, &g->places[g->last_of[joint.index] - 1].transform);
    }
    return RT_OK;
}

static RtStatus add_primitives(Gltf *g, const Item *mesh, const Pose *pose) {
    json_t *primitive;
    size_t k;
    json_array_foreach(json_object_get(mesh->object, "primitives"), k, primitive)
        RT_TRY(add_primitive(g, mesh, primitive, pose));
    return RT_OK;
}

/* Makes a part of the mesh, as if it were a scene of its own, and adds that to the scene. */
static RtStatus make_part(Gltf *g, const Item *mesh, const Pose *pose, Shared *shared) {
    RT_OWNED(RtScene, part, rt_scene_clear);
    RtMeshReader *r = g->mesh;
    RtScene *scene = r->scene;
    const uint32_t material = r->material;
    Pose unmoved = *pose;
    unmoved.transform = rt_transform_identity();
    rt_scene_init(&part);
    RT_TRY(rt_scene_share_material(&part, &scene->materials[material], &r->material, r->text.error));
    part.warnings = scene->warnings;
    r->scene = &part;
    const RtStatus status = add_primitives(g, mesh, &unmoved);
    r->scene = scene;
    r->material = material;
    scene->warnings = part.warnings;
    part.warnings = (RtWarnings){0};
    shared->part = NO_PART;
    if (status != RT_OK || part.geometry.triangle_count < PART_TRIANGLES) return status;
    shared->part = scene->part_count + 1;
    return rt_scene_add_part(scene, &part, r->text.error);
}

/* *done: the mesh in this pose is an instance, and has no triangles of its own. */
static RtStatus place_instance(Gltf *g, const Item *mesh, const Pose *pose, bool *done) {
    Shared *shared = &g->shared[mesh->index];
    RtTransform inverse;
    *done = false;
    if (rt_transform_invert(&pose->transform, &inverse, NULL) != RT_OK) return RT_OK;
    if (shared->part == 0) RT_TRY(make_part(g, mesh, pose, shared));
    if (shared->part == NO_PART) return RT_OK;
    const Instance instance = {shared->part - 1, pose->transform};
    *done = true;
    return rt_append(&g->instances, &g->instance_count, &g->instance_capacity, &instance, sizeof instance,
                     g->mesh->text.error);
}

static RtStatus add_instances(const Gltf *g) {
    RtScene *scene = g->mesh->scene;
    for (uint32_t i = 0; i < g->instance_count; i++)
        RT_TRY(rt_scene_add_instance(scene, scene, g->instances[i].part, &g->instances[i].to_world,
                                     RT_OWN_MATERIALS, g->mesh->text.error));
    return RT_OK;
}

/* Adds the mesh of a node, if it has one: skinned, in each of its instances, or once. */
static RtStatus add_mesh_at(Gltf *g, const Place *place) {
    static const double t[3] = {0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    RT_ARENA(memory);
    const Item *node = &place->node, *mesh = &place->mesh;
    const json_t *weights = json_object_get(node->object, "weights"),
                 *extensions = json_object_get(node->object, "extensions"),
                 *instancing = json_object_get(extensions, "EXT_mesh_gpu_instancing");
    const Item attributes = inside(node, json_object_get(instancing, "attributes"));
    Pose pose = {.weights = weights ? weights : json_object_get(mesh->object, "weights")};
    Values moves, turns, scales;
    if (!mesh->object) return RT_OK;
    if (!json_is_array(json_object_get(mesh->object, "primitives")))
        return fail_item(g, mesh, "expected primitives, a list");
    RT_TRY(read_skin(g, node, &memory, &pose));
    RT_TRY(read_accessor(g, &attributes, "TRANSLATION", 3, 0, &memory, &moves));
    RT_TRY(read_accessor(g, &attributes, "ROTATION", 4, moves.count, &memory, &turns));
    RT_TRY(read_accessor(g, &attributes, "SCALE", 3, moves.at ? moves.count : turns.count, &memory, &scales));
    const uint32_t count = moves.at ? moves.count : turns.at ? turns.count : scales.count;
    const bool repeats =
        g->mesh->whole && !pose.joints && !weights && (count > 1 || g->shared[mesh->index].places > 1);
    if (count > 0 && pose.joints) return fail_item(g, node, "expected a skin or instances, found both");
    for (size_t i = 0; i < (count > 0 ? count : 1); i++) {
        const RtTransform instance =
            compose_steps(moves.at ? moves.at + 3 * i : t, turns.at ? turns.at + 4 * i : q,
                          scales.at ? scales.at + 3 * i : s);
        pose.transform = rt_transform_compose(&instance, &place->transform);
        bool placed = false;
        if (repeats) RT_TRY(place_instance(g, mesh, &pose, &placed));
        if (!placed && count > 0)
            RT_TRY(rt_mesh_warn(g->mesh, "instances (EXT_mesh_gpu_instancing) become copies"));
        if (!placed) RT_TRY(add_primitives(g, mesh, &pose));
    }
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
    g->buffers =
        rt_arena_alloc(&g->memory, json_array_size(json_object_get(g->root, "buffers")), sizeof *g->buffers);
    g->shared =
        rt_arena_alloc(&g->memory, json_array_size(json_object_get(g->root, "meshes")), sizeof *g->shared);
    RT_TRY(rt_arena_check(&g->memory, "buffers of glTF", file->error));
    RT_TRY(check_extensions(g, "extensionsRequired", true));
    RT_TRY(check_extensions(g, "extensionsUsed", false));
    if (json_array_size(json_object_get(g->root, "animations")) > 0)
        RT_TRY(rt_mesh_warn(g->mesh, "its animations are left out: everything is at rest"));
    RT_TRY(place_nodes(g));
    for (uint32_t i = 0; i < g->place_count; i++) RT_TRY(add_mesh_at(g, &g->places[i]));
    return add_instances(g);
}

static RtStatus read_all(RtMeshReader *r, const char *text, size_t size, Buffer chunk) {
    Gltf g = {.mesh = r, .chunk = chunk, .size = size};
    RtStatus status = read_document(&g, text, size);
    for (size_t i = 0; g.buffers && i < json_array_size(json_object_get(g.root, "buffers")); i++) {
        if (g.buffers[i].data != chunk.data) rt_free(g.buffers[i].data);
    }
    rt_arena_clear(&g.memory);
    rt_free(g.places);
    rt_free(g.instances);
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
    if (rt_mesh_u32(b + 4) == 2) return RT_OK;
    return rt_mesh_fail(r, "this is glTF %u: only 2 can be read", rt_mesh_u32(b + 4));
}

/* Chunks of other types are ignored. */
RtStatus rt_mesh_read_glb(RtMeshReader *r) {
    RtScanner *text = &r->text;
    const ptrdiff_t size = text->end - text->at, declared = size < GLB_HEADER ? 0 : rt_mesh_u32(text->at + 8);
    Buffer json = {0}, binary = {0};
    if (declared < GLB_HEADER || declared > size)
        return rt_mesh_fail(r, "the header declares %td bytes, but the file has %td: cut off", declared,
                            size);
    const char *end = text->at + declared;
    text->at += GLB_HEADER;
    while (end - text->at >= CHUNK_HEADER) {
        const Buffer chunk = {(char *)text->at + CHUNK_HEADER, rt_mesh_u32(text->at)};
        const size_t left = (size_t)(end - chunk.data);
        if (chunk.size > left)
            return rt_mesh_fail(r, "a chunk declares %zu bytes, but has %zu", chunk.size, left);
        if (!json.data && memcmp(text->at + 4, "JSON", 4) == 0) json = chunk;
        if (!binary.data && memcmp(text->at + 4, "BIN", 4) == 0) binary = chunk;
        text->at = chunk.data + chunk.size;
    }
    if (!json.data) return rt_mesh_fail(r, "it has no chunk JSON");
    RT_TRY(rt_mesh_end_binary(r));
    return read_all(r, json.data, json.size, binary);
}
