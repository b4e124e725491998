/* SPDX-License-Identifier: Apache-2.0 */
#include "core/scene/mesh_gltf_data.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { UINT8 = 5121, UINT16 = 5123, UINT32 = 5125, FLOAT32 = 5126 };

#define MOST ((json_int_t)1 << 40) /* sums, and products with 2^20, fit 64 bits */

/* ---- the document ---- */

RtStatus rt_gltf_fail(const RtGltf *g, const RtGltfItem *item, const char *format, ...) {
    char message[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof message, format, arguments);
    va_end(arguments);
    return rt_mesh_fail(g->mesh, "%s[%zu]: %s", item->list, item->index, message);
}

RtStatus rt_gltf_at(const RtGltf *g, const char *list, json_int_t index, const char *by, RtGltfItem *item) {
    const json_t *all = json_object_get(g->root, list);
    if (index < 0 || (uint64_t)index >= json_array_size(all))
        return rt_mesh_fail(g->mesh, "%s names %s[%lld], but there are %zu (counted from 0)", by, list,
                            (long long)index, json_array_size(all));
    *item = (RtGltfItem){list, (size_t)index, json_array_get(all, (size_t)index)};
    return json_is_object(item->object) ? RT_OK : rt_gltf_fail(g, item, "expected an object");
}

RtStatus rt_gltf_find(const RtGltf *g, const char *list, const json_t *reference, const char *by,
                      RtGltfItem *item) {
    if (json_is_integer(reference)) return rt_gltf_at(g, list, json_integer_value(reference), by, item);
    return rt_mesh_fail(g->mesh, "%s lacks the index of one of the %s", by, list);
}

RtStatus rt_gltf_integer(const RtGltf *g, const RtGltfItem *item, const char *key, json_int_t least,
                         json_int_t otherwise, uint64_t *out) {
    const json_t *member = json_object_get(item->object, key);
    const json_int_t value = json_is_integer(member) ? json_integer_value(member) : member ? -1 : otherwise;
    if (value < least || value > MOST)
        return rt_gltf_fail(g, item, "expected %s, an integer of at least %lld", key, (long long)least);
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

static RtStatus load_embedded(const RtGltf *g, const RtGltfItem *item, const char *text,
                              RtGltfBuffer *buffer) {
    buffer->data = rt_alloc_unset(strlen(text) + 1, 1);
    if (!buffer->data) return rt_fail_memory(g->mesh->text.error, "a buffer of glTF", strlen(text));
    buffer->size = decode(text, buffer->data);
    return buffer->size == SIZE_MAX ? rt_gltf_fail(g, item, "its base64 is damaged") : RT_OK;
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

static RtStatus load_file(const RtGltf *g, const RtGltfItem *item, const char *uri, size_t limit,
                          RtGltfBuffer *buffer) {
    char folder[RT_MAX_PATH], name[RT_MAX_PATH], path[RT_MAX_PATH];
    if (strstr(uri, "://")) return rt_gltf_fail(g, item, "its uri '%.60s' is not a file", uri);
    decode_path(uri, name);
    rt_path_folder(g->mesh->text.path, folder);
    RT_TRY(rt_path_join(folder, name, path, g->mesh->text.error));
    return rt_file_read(path, limit, &buffer->data, &buffer->size, g->mesh->text.error);
}

static RtStatus load_buffer(const RtGltf *g, const RtGltfItem *item, size_t limit, RtGltfBuffer *buffer) {
    static const char embedded[] = "data:";
    const json_t *member = json_object_get(item->object, "uri");
    const char *uri = json_string_value(member), *data = uri ? strstr(uri, ";base64,") : NULL;
    uint64_t length = 0;
    RT_TRY(rt_gltf_integer(g, item, "byteLength", 1, 0, &length));
    if (!uri && !member && item->index == 0 && g->chunk.data)
        *buffer = g->chunk;
    else if (!uri)
        return rt_gltf_fail(g, item, "expected uri, the data or the name of a file");
    else if (strncmp(uri, embedded, strlen(embedded)) != 0)
        RT_TRY(load_file(g, item, uri, limit, buffer));
    else if (data)
        RT_TRY(load_embedded(g, item, data + strlen(";base64,"), buffer));
    else
        return rt_gltf_fail(g, item, "its data is not in base64");
    if (buffer->size >= length) return RT_OK;
    return rt_gltf_fail(g, item, "it declares %llu bytes, but has %zu: it is cut off",
                        (unsigned long long)length, buffer->size);
}

RtStatus rt_gltf_load_buffers(RtGltf *g) {
    const json_t *list = json_object_get(g->root, "buffers");
    const size_t count = json_array_size(list);
    size_t left = RT_MESH_MAX_BYTES; /* for files, together: a document may name one many times */
    g->buffers = rt_alloc(count, sizeof *g->buffers);
    if (!g->buffers)
        return rt_fail_memory(g->mesh->text.error, "buffers of glTF", count * sizeof *g->buffers);
    g->buffer_count = count;
    for (size_t i = 0; i < count; i++) {
        const RtGltfItem item = {"buffers", i, json_array_get(list, i)};
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

RtStatus rt_gltf_open_view(const RtGltf *g, const json_t *reference, size_t width, RtGltfView *view) {
    static const char *const names[] = {"", "SCALAR", "VEC2", "VEC3"};
    RtGltfItem accessor = {0}, range = {0}, buffer = {0};
    uint64_t type = 0, count = 0, skip = 0, begin = 0, length = 0, stride = 0;
    RT_TRY(rt_gltf_find(g, "accessors", reference, "a primitive", &accessor));
    if (json_object_get(accessor.object, "sparse"))
        return rt_gltf_fail(g, &accessor, "it is sparse: cannot be read");
    RT_TRY(rt_gltf_integer(g, &accessor, "componentType", 0, -1, &type));
    RT_TRY(rt_gltf_integer(g, &accessor, "count", 1, 0, &count));
    RT_TRY(rt_gltf_integer(g, &accessor, "byteOffset", 0, 0, &skip));
    const size_t size = component_size(type) * width;
    const char *shape = json_string_value(json_object_get(accessor.object, "type"));
    if (size == 0 || (type == FLOAT32) != (width == 3) || !shape || strcmp(shape, names[width]) != 0)
        return rt_gltf_fail(g, &accessor, "expected the type %s of %s", names[width],
                            width == 3 ? "float32" : "unsigned integers");
    RT_TRY(rt_gltf_find(g, "bufferViews", json_object_get(accessor.object, "bufferView"), "an accessor",
                        &range));
    RT_TRY(rt_gltf_integer(g, &range, "byteOffset", 0, 0, &begin));
    RT_TRY(rt_gltf_integer(g, &range, "byteLength", 1, 0, &length));
    RT_TRY(rt_gltf_integer(g, &range, "byteStride", (json_int_t)size, (json_int_t)size, &stride));
    RT_TRY(rt_gltf_find(g, "buffers", json_object_get(range.object, "buffer"), "a bufferView", &buffer));
    if (begin + length > g->buffers[buffer.index].size)
        return rt_gltf_fail(g, &range, "it ends at byte %llu of a buffer of %zu bytes",
                            (unsigned long long)begin + length, g->buffers[buffer.index].size);
    if (count > UINT32_MAX || stride > 252 || skip + stride * (count - 1) + size > length)
        return rt_gltf_fail(g, &accessor,
                            "its %llu elements do not fit into the %llu bytes of bufferViews[%zu]",
                            (unsigned long long)count, (unsigned long long)length, range.index);
    *view = (RtGltfView){g->buffers[buffer.index].data + begin + skip, (uint32_t)count, type, (size_t)stride};
    return RT_OK;
}

uint32_t rt_gltf_index(const RtGltfView *view, uint32_t i) {
    const unsigned char *at = (const unsigned char *)view->data + view->stride * i;
    return view->type == UINT8    ? at[0]
           : view->type == UINT16 ? at[0] | (uint32_t)at[1] << 8
                                  : rt_mesh_u32(at);
}
