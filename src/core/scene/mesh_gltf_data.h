/* SPDX-License-Identifier: Apache-2.0 */
/* The document of a glTF file and the data of its accessors. Every member is checked where it is read; what a
 * view shows is inside its buffer. */
#ifndef RT_SCENE_MESH_GLTF_DATA_H
#define RT_SCENE_MESH_GLTF_DATA_H

#include "core/scene/mesh_reader.h"

#include <jansson.h>

typedef struct RtGltfBuffer {
    char *data;
    size_t size;
} RtGltfBuffer;

typedef struct RtGltf {
    RtMeshReader *mesh;
    json_t *root;
    RtGltfBuffer chunk; /* the binary chunk of a .glb, borrowed; a zeroed struct: none */
    size_t buffer_count;
    RtGltfBuffer *buffers; /* [buffer_count], owned, except `chunk` */
    size_t size;           /* bytes of the document and its buffers */
    uint64_t placed;       /* primitives, their vertices and corners, in all nodes so far */
    bool *visited;         /* [nodes], owned */
} RtGltf;

/* An entry of one of the document's lists. */
typedef struct RtGltfItem {
    const char *list;
    size_t index;
    json_t *object;
} RtGltfItem;

/* The elements of an accessor. */
typedef struct RtGltfView {
    const char *data;
    uint32_t count;
    uint64_t type; /* of a component, as the document says it */
    size_t stride;
} RtGltfView;

/* Fails at "FILE: LIST[INDEX]: ". */
__attribute__((format(printf, 3, 4))) RtStatus rt_gltf_fail(const RtGltf *g, const RtGltfItem *item,
                                                            const char *format, ...);

/* Finds object `index` of `list`, or the one whose index is `reference`; `by` says where that is. */
RtStatus rt_gltf_at(const RtGltf *g, const char *list, json_int_t index, const char *by, RtGltfItem *item);
RtStatus rt_gltf_find(const RtGltf *g, const char *list, const json_t *reference, const char *by,
                      RtGltfItem *item);

/* Gets the integer `key`, or `otherwise` if there is none. Rejects less than `least`, so an `otherwise` below
 * it makes the member mandatory; and more than 2^40. */
RtStatus rt_gltf_integer(const RtGltf *g, const RtGltfItem *item, const char *key, json_int_t least,
                         json_int_t otherwise, uint64_t *out);

/* Gets the list `key` of `count` numbers; out[] stays as it is if there is none. */
RtStatus rt_gltf_numbers(const RtGltf *g, const RtGltfItem *item, const char *key, size_t count, double *out);

/* Loads all buffers: the chunk, embedded ones, files beside the document. */
RtStatus rt_gltf_load_buffers(RtGltf *g);

/* Opens an accessor for `width` components: 3 of float32, or 1 of unsigned integers. */
RtStatus rt_gltf_open_view(const RtGltf *g, const json_t *reference, size_t width, RtGltfView *view);

/* Integer `i` of a view. */
uint32_t rt_gltf_index(const RtGltfView *view, uint32_t i);

#endif
