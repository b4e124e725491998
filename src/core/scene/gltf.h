/* SPDX-License-Identifier: Apache-2.0 */
/* The document of a glTF file, its buffers, and the numbers in them, of which mesh_gltf.c makes meshes. Every
 * member is checked where it is read. A buffer is read at its first use, and what is read of it is inside it.
 */
#ifndef RT_SCENE_GLTF_H
#define RT_SCENE_GLTF_H

#include "core/base/memory.h"
#include "core/scene/mesh.h"

#include <jansson.h>

typedef struct RtGltfBuffer {
    char *data; /* NULL: not read */
    size_t size;
} RtGltfBuffer;

typedef struct RtGltf {
    RtMeshReader *mesh;
    json_t *root;
    RtGltfBuffer chunk;    /* the binary chunk of a .glb, borrowed; a zeroed struct: none */
    RtGltfBuffer *buffers; /* one for each of the document's, their data owned, except `chunk` */
    size_t size;           /* bytes of the document and the buffers read so far */
    uint64_t placed;       /* nodes, primitives, and elements of their accessors so far */
    RtArena memory;
} RtGltf;

/* An entry of one of the document's lists, or an object inside it. */
typedef struct RtGltfItem {
    const char *list;
    size_t index;
    json_t *object;
} RtGltfItem;

RtGltfItem rt_gltf_inside(const RtGltfItem *item, json_t *object);

/* Fails at "FILE: LIST[INDEX]: ". */
__attribute__((format(printf, 3, 4))) RtStatus rt_gltf_fail(const RtGltf *g, const RtGltfItem *item,
                                                            const char *format, ...);

/* Finds the object of `list` whose index is `reference`, which stands in `owner`. */
RtStatus rt_gltf_find(const RtGltf *g, const RtGltfItem *owner, const json_t *reference, const char *list,
                      RtGltfItem *item);

/* A number, which may be written as 3.0, or -1; and whether it is an integer from 0 to below `count`. */
double rt_gltf_number(const json_t *member);
bool rt_gltf_is_index(double value, double count);

/* Gets the integer `key`, or `otherwise` if there is none. Rejects less than `least`, so an `otherwise` below
 * it makes the member mandatory; and more than 2^40. */
RtStatus rt_gltf_integer(const RtGltf *g, const RtGltfItem *item, const char *key, double least,
                         double otherwise, uint64_t *out);

/* Gets the list `key` of `count` numbers; out[] stays as it is if there is none. */
RtStatus rt_gltf_numbers(const RtGltf *g, const RtGltfItem *item, const char *key, size_t count, double *out);

/* Rejects compressed geometry, if it `matters` and the document lists its extension in `list`. Of the others,
 * which are neither read nor concern the picture alone, rejects those that it requires, and warns of those
 * that it uses. */
RtStatus rt_gltf_check_extensions(const RtGltf *g, const char *list, bool matters);

/* Nodes may place a mesh many times, and primitives share vertices: a small file could take days.
 * RT_GLTF_MOST_PLACED: for each byte of the file; a forest of 10,000 trees of 10,000 triangles has 400. */
enum { RT_GLTF_MOST_PLACED = 1000 };
RtStatus rt_gltf_count_placed(RtGltf *g, uint64_t count);

/* The elements of an accessor, decoded. */
typedef struct RtGltfValues {
    uint32_t count; /* 0: there is no accessor */
    union {
        double *at;       /* [count * width] */
        RtVec3d *vectors; /* [count], of width 3 */
    };
} RtGltfValues;

/* Reads the accessor that `owner` names as `key`, with `width` numbers an element and, unless `expected` is
 * 0, so many elements. Without one, *out is zeroed. */
RtStatus rt_gltf_accessor(RtGltf *g, const RtGltfItem *owner, const char *key, size_t width,
                          uint32_t expected, RtArena *memory, RtGltfValues *out);

#endif
