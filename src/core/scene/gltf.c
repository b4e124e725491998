/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/gltf.h"

#include "core/base/file.h"

#include <ctype.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define MOST_INTEGER 0x1p40 /* sums fit 64 bits */

/* ---- the document ---- */

RtStatus rt_gltf_fail(const RtGltf *g, const RtGltfItem *item, const char *format, ...) {
    char message[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return rt_mesh_fail(g->mesh, "%s[%zu]: %s", item->list, item->index, message);
}

RtGltfItem rt_gltf_inside(const RtGltfItem *item, json_t *object) {
    return (RtGltfItem){item->list, item->index, object};
}

double rt_gltf_number(const json_t *member) {
    return json_is_number(member) ? json_number_value(member) : -1;
}

bool rt_gltf_is_index(double value, double count) {
    return value >= 0 && value < count && value == floor(value);
}

RtStatus rt_gltf_find(const RtGltf *g, const RtGltfItem *owner, const json_t *reference, const char *list,
                      RtGltfItem *item) {
    const json_t *all = json_object_get(g->root, list);
    const size_t count = json_array_size(all);
    if (!rt_gltf_is_index(rt_gltf_number(reference), (double)count))
        return rt_gltf_fail(g, owner, "expected the index of one of the %zu %s (counted from 0)", count,
                            list);
    const size_t index = (size_t)json_number_value(reference);
    *item = (RtGltfItem){list, index, json_array_get(all, index)};
    return json_is_object(item->object) ? RT_OK : rt_gltf_fail(g, item, "expected an object");
}

RtStatus rt_gltf_integer(const RtGltf *g, const RtGltfItem *item, const char *key, double least,
                         double otherwise, uint64_t *out) {
    const json_t *member = json_object_get(item->object, key);
    const double value = member ? rt_gltf_number(member) : otherwise;
    if (value < least || !rt_gltf_is_index(value, MOST_INTEGER))
        return rt_gltf_fail(g, item, "expected %s, an integer of at least %.0f", key, least);
    *out = (uint64_t)value;
    return RT_OK;
}

RtStatus rt_gltf_numbers(const RtGltf *g, const RtGltfItem *item, const char *key, size_t count,
                         double *out) {
    const json_t *list = json_object_get(item->object, key);
    if (!list) return RT_OK;
    for (size_t i = 0; i < count; i++) {
        const json_t *number = json_array_get(list, i);
        if (!json_is_number(number) || json_array_size(list) != count)
            return rt_gltf_fail(g, item, "expected %s, a list of %zu numbers", key, count);
        out[i] = json_number_value(number);
    }
    return RT_OK;
}

/* ---- extensions ---- */

static bool has_part(const char *name, const char *const parts[]) {
    while (*parts && !strstr(name, *parts)) parts++;
    return *parts;
}

RtStatus rt_gltf_check_extensions(const RtGltf *g, const char *list, bool matters) {
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

static RtStatus load_file(const RtGltf *g, const RtGltfItem *item, const char *uri, RtGltfBuffer *buffer) {
    const size_t limit = g->size < RT_MESH_MAX_BYTES ? RT_MESH_MAX_BYTES - g->size : 0; /* of all together */
    char folder[RT_MAX_PATH], name[RT_MAX_PATH], path[RT_MAX_PATH];
    if (strstr(uri, "://")) return rt_gltf_fail(g, item, "its uri '%.60s' is not a file", uri);
    decode_path(uri, name);
    rt_path_folder(g->mesh->text.path, folder);
    RT_TRY(rt_path_join(folder, name, path, g->mesh->text.error));
    return rt_file_read(path, limit, &buffer->data, &buffer->size, g->mesh->text.error);
}

/* Reads a buffer: the chunk, embedded, or a file beside the document. */
static RtStatus load_buffer(RtGltf *g, const RtGltfItem *item, RtGltfBuffer *buffer) {
    static const char base64[] = ";base64,";
    const json_t *member = json_object_get(item->object, "uri");
    const char *uri = json_string_value(member), *data = uri ? strstr(uri, base64) : NULL;
    uint64_t length = 0;
    RT_TRY(rt_gltf_integer(g, item, "byteLength", 1, 0, &length));
    if (!member && item->index == 0 && g->chunk.data) {
        *buffer = g->chunk;
    } else if (!uri) {
        return rt_gltf_fail(g, item, "expected uri, the data or the name of a file");
    } else if (strncmp(uri, "data:", 5) != 0) {
        RT_TRY(load_file(g, item, uri, buffer));
    } else if (!data) {
        return rt_gltf_fail(g, item, "its data is not in base64");
    } else {
        buffer->data = rt_alloc_unset(strlen(data), 1);
        if (!buffer->data) return rt_fail_memory(g->mesh->text.error, "a buffer of glTF", strlen(data));
        buffer->size = decode_base64(data + strlen(base64), buffer->data);
        if (buffer->size == SIZE_MAX) return rt_gltf_fail(g, item, "its base64 is damaged");
    }
    g->size += buffer->size;
    if (buffer->size >= length) return RT_OK;
    return rt_gltf_fail(g, item, "it declares %llu bytes, but has %zu: it is cut off",
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

static RtStatus alloc_values(const RtGltf *g, RtArena *memory, uint64_t count, size_t width,
                             RtGltfValues *out) {
    *out = (RtGltfValues){(uint32_t)count, {rt_arena_alloc(memory, count * width, sizeof *out->at)}};
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
static RtStatus decode(RtGltf *g, const RtGltfItem *item, const RtGltfItem *typed, size_t width,
                       uint64_t count, RtArena *memory, RtGltfValues *out) {
    const bool normalised = json_is_true(json_object_get(typed->object, "normalized"));
    RtGltfItem view = {0}, buffer = {0};
    uint64_t code = 0, skip = 0, begin = 0, length = 0, stride = 0;
    RT_TRY(rt_gltf_integer(g, typed, "componentType", FIRST_TYPE, -1, &code));
    RT_TRY(rt_gltf_find(g, item, json_object_get(item->object, "bufferView"), "bufferViews", &view));
    RT_TRY(rt_gltf_find(g, &view, json_object_get(view.object, "buffer"), "buffers", &buffer));
    RT_TRY(rt_gltf_integer(g, item, "byteOffset", 0, 0, &skip));
    RT_TRY(rt_gltf_integer(g, &view, "byteOffset", 0, 0, &begin));
    RT_TRY(rt_gltf_integer(g, &view, "byteLength", 1, 0, &length));
    RT_TRY(rt_gltf_integer(g, &view, "byteStride", 0, 0, &stride));
    RtGltfBuffer *bytes = &g->buffers[buffer.index];
    if (!bytes->data) RT_TRY(load_buffer(g, &buffer, bytes));
    const size_t type = code - FIRST_TYPE, part = type < TYPES ? types[type].size : 0, size = part * width;
    if (part == 0) return rt_gltf_fail(g, typed, "expected componentType, 5120 to 5126 without 5124");
    if (begin + length > bytes->size)
        return rt_gltf_fail(g, &view, "it ends at byte %llu of a buffer of %zu bytes",
                            (unsigned long long)begin + length, bytes->size);
    if (stride == 0) stride = size;
    if (stride < size || skip + size > length || (length - skip - size) / stride < count - 1)
        return rt_gltf_fail(g, item, "its %llu elements do not fit into the %llu bytes of bufferViews[%zu]",
                            (unsigned long long)count, (unsigned long long)length, view.index);
    RT_TRY(alloc_values(g, memory, count, width, out));
    const char *first = bytes->data + begin + skip;
    for (uint64_t i = 0; i < count; i++) {
        for (size_t k = 0; k < width; k++)
            out->at[i * width + k] = number_at(first + stride * i + part * k, type, normalised);
    }
    return RT_OK;
}

RtStatus rt_gltf_count_placed(RtGltf *g, uint64_t count) {
    g->placed += count;
    if (g->placed / RT_GLTF_MOST_PLACED <= g->size) return RT_OK;
    return rt_mesh_fail(g->mesh,
                        "its nodes place more than %d vertices and corners for each of its %zu bytes: divide "
                        "the file, or export it without the vertices that a primitive does not use",
                        RT_GLTF_MOST_PLACED, g->size);
}

/* Replaces the elements that the member `sparse` lists. */
static RtStatus replace_elements(RtGltf *g, const RtGltfItem *accessor, size_t width, RtGltfValues *out) {
    RT_ARENA(memory);
    const RtGltfItem sparse = rt_gltf_inside(accessor, json_object_get(accessor->object, "sparse")),
                     indices = rt_gltf_inside(accessor, json_object_get(sparse.object, "indices")),
                     elements = rt_gltf_inside(accessor, json_object_get(sparse.object, "values"));
    RtGltfValues places, values;
    uint64_t count = 0;
    RT_TRY(rt_gltf_integer(g, &sparse, "count", 1, 0, &count));
    if (count > out->count) return rt_gltf_fail(g, accessor, "it replaces more elements than it has");
    RT_TRY(decode(g, &indices, &indices, 1, count, &memory, &places));
    RT_TRY(decode(g, &elements, accessor, width, count, &memory, &values));
    for (size_t i = 0; i < count; i++) {
        if (!rt_gltf_is_index(places.at[i], out->count))
            return rt_gltf_fail(g, accessor, "it replaces element %g, but has %u", places.at[i], out->count);
        memcpy(out->at + (size_t)places.at[i] * width, values.at + i * width, width * sizeof *out->at);
    }
    return RT_OK;
}

RtStatus rt_gltf_accessor(RtGltf *g, const RtGltfItem *owner, const char *key, size_t width,
                          uint32_t expected, RtArena *memory, RtGltfValues *out) {
    const char *const name = width == 1   ? "SCALAR"
                             : width == 2 ? "VEC2"
                             : width == 3 ? "VEC3"
                             : width == 4 ? "VEC4"
                                          : "MAT4";
    const json_t *reference = json_object_get(owner->object, key);
    RtGltfItem item = {0};
    uint64_t count = 0;
    *out = (RtGltfValues){0};
    if (!reference) return RT_OK;
    RT_TRY(rt_gltf_find(g, owner, reference, "accessors", &item));
    RT_TRY(rt_gltf_integer(g, &item, "count", 1, 0, &count));
    const json_t *sparse = json_object_get(item.object, "sparse");
    const char *type = json_string_value(json_object_get(item.object, "type"));
    if (!type || strcmp(type, name) != 0)
        return rt_gltf_fail(g, &item, "expected the type %s, for %s", name, key);
    if (count > UINT32_MAX || (expected && count != expected))
        return rt_gltf_fail(g, owner, "expected %u elements of %s, found %llu", expected, key,
                            (unsigned long long)count);
    if (json_object_get(item.object, "bufferView")) {
        RT_TRY(decode(g, &item, &item, width, count, memory, out));
    } else { /* zeros */
        if (!sparse) RT_TRY(rt_gltf_check_extensions(g, "extensionsUsed", true));
        if (count > g->size)
            return rt_gltf_fail(g, &item, "it has more elements, without data, than the file has bytes");
        RT_TRY(alloc_values(g, memory, count, width, out));
    }
    RT_TRY(rt_gltf_count_placed(g, count));
    return sparse ? replace_elements(g, &item, width, out) : RT_OK;
}
