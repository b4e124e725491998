/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle meshes: OBJ, PLY, STL, OFF and glTF 2.0, as other programs write them.
 *
 * Triangles come in the order of the file; of glTF, nodes depth first, then the primitives of a mesh.
 * Polygons are split into triangles; points and lines are left out. Nothing is merged, removed or invented:
 * triangles without area stay (they are never hit), and only the file's own vertex normals are used. Texture
 * coordinates (OBJ, PLY, glTF) are kept where the material has a texture. Materials, cameras and lights of
 * the file are ignored, except images in materials of OBJ (mesh_mtl.c).
 *
 * What is unused or redundant, or has one sensible reading, is read whatever it is like; what is left out or
 * guessed, and changes the picture or may be damage, is a warning of the scene (core/base/warnings.h). A file
 * whose geometry cannot be known is rejected with the place of the damage, in time and memory proportional to
 * its size. (glTF may place a mesh many times, but at most 1000 vertices and corners for each byte.) That is
 * why the readers are our own: Assimp 5 loads much of what is cut off or inconsistent, and crashes or hangs
 * on some files. A child process would end a crash, but its result would still need a check that reads every
 * number of the file again. */
#ifndef RT_SCENE_MESH_H
#define RT_SCENE_MESH_H

#include "core/base/transform.h"
#include "core/scene/scene.h"
#include "core/text/scanner.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The extension of format `i`, without the dot; NULL after the last. All can be read, and the first can be
 * written. */
enum { RT_MESH_WRITTEN = 4 };
const char *rt_mesh_extension(size_t i);

/* Adds the triangles of `path` to the scene with `material` (OBJ: or its own, with images), moved by
 * `transform` (NULL: in place). `whole`: nothing else is added, so there may be instances. After a failure
 * some may remain, and the scene must be cleared. Rejects damaged files, files without triangles, and faces
 * with vertices that are not finite. */
RtStatus rt_mesh_append(RtScene *scene, const char *path, uint32_t material, const RtTransform *transform,
                        bool whole, RtError *error);

/* Reads a mesh file into a scene from rt_scene_init: default material, +Y up. */
RtStatus rt_mesh_load(const char *path, RtScene *scene, RtError *error);

/* Writes the triangles of a scene in format `i`, without sharing vertices. Coordinates
 * survive bit for bit in ply, stl and glb, and within the rounding of the reader in obj. stl has facet
 * normals only. If only some triangles have vertex normals, ply and glb use the geometric normal for the
 * others. Rejects scenes with other shapes and names formats that support them. Materials, texture
 * coordinates, lights and camera are not written. */
RtStatus rt_mesh_save(const RtScene *scene, size_t i, FILE *file, RtError *error);

/* ---- what the readers share: mesh_reader.c ----
 *
 * A reader fills `vertices`, and `normals` if there are any, and for each polygon of the file adds its
 * corners and then the polygon. The readers trust nothing in the file: every index is checked, no count
 * allocates more than a small multiple of the file's size, and a file that declares counts must have as much.
 */

/* Longer files are rejected, and documents of glTF without its buffers, which take 30 times as much memory.
 */
#define RT_MESH_MAX_BYTES ((size_t)1 << 33)
enum { RT_MESH_MAX_JSON = 1 << 28 };

#define RT_MESH_NONE UINT32_MAX

typedef struct RtMeshCorner {
    uint32_t vertex;
    uint32_t normal; /* RT_MESH_NONE: none */
    uint32_t uv;     /* likewise */
} RtMeshCorner;

typedef struct RtMeshReader {
    RtScanner text; /* the whole file, with a 0 behind it; binary formats use path, at, end and error */
    const char *given_back; /* whole pages of the text up to here are not read again; NULL: all is kept */
    RtScene *scene;
    uint32_t material;
    RtTransform transform; /* of vertices and normals, less the offset of the scene */
    bool moves;            /* it does, so that coordinates are read as doubles and rounded behind it */
    bool whole;            /* the file is the whole scene, so that it may have instances */
    bool textured;         /* a material has a texture: texture coordinates are kept */
    uint32_t vertex_count, vertex_capacity, normal_count, normal_capacity, corner_count, corner_capacity;
    uint32_t uv_count, uv_capacity;
    RtVec3 *vertices;      /* [vertex_count] transformed */
    RtVec3 *normals;       /* [normal_count] likewise */
    RtUv *uvs;             /* [uv_count] texture coordinates */
    RtMeshCorner *corners; /* [corner_count] of the polygon being read */
    uint32_t face_count;   /* polygons added */
} RtMeshReader;

/* Begins with the whole file as text: without a byte-order mark, and without zeros and ^Z at its end, of
 * which it warns. Rejects zeros elsewhere. */
RtStatus rt_mesh_begin_text(RtMeshReader *r);

/* Fails at the line of the last word; for binary formats, where there is none, at the file. */
#define rt_mesh_fail(r, ...) rt_fail_at((r)->text.error, (r)->text.path, (r)->text.last, 0, __VA_ARGS__)
/* Warns there; the literal is the kind (rt_warn_at). */
#define rt_mesh_warn(r, ...)                                                                                 \
    rt_warn_at(&(r)->scene->warnings, (r)->text.path, (r)->text.last, (r)->text.error, __VA_ARGS__)

/* Adds the vertex at `place`, transformed. Warns of one that is not finite, which no face may use. */
RtStatus rt_mesh_add_vertex(RtMeshReader *r, RtVec3d place);
/* Accepts any numbers: a normal that is not finite, with a warning, or has no length is ignored where it is
 * used. */
RtStatus rt_mesh_add_normal(RtMeshReader *r, RtVec3 normal);

/* Adds texture coordinates, if the mesh is textured. Those that are not finite, with a warning, are ignored
 * where they are used. */
RtStatus rt_mesh_add_uv(RtMeshReader *r, RtUv uv);

/* Adds a corner; its indices must be valid. Rejects a vertex that is not finite. */
RtStatus rt_mesh_add_corner(RtMeshReader *r, RtMeshCorner corner);

/* Adds a corner with vertex `index`, counted from 0, and if there are normals or texture coordinates, those
 * of the same index. Rejects a vertex that does not exist. */
RtStatus rt_mesh_add_index(RtMeshReader *r, double index);

/* Adds the polygon of the corners as triangles, and removes the corners. Triangles have vertex normals if all
 * three corners do. */
RtStatus rt_mesh_add_polygon(RtMeshReader *r);

/* ---- text formats ---- */

/* Takes a word that must be the first of its line, or else must be on the line of the last one. */
RtStatus rt_mesh_take(RtMeshReader *r, bool first, const char *wanted, RtWord *word);
/* Takes a word if there is one more on the line. */
bool rt_mesh_more(RtMeshReader *r, RtWord *word);
/* Takes the word `text`, wherever it is, in upper or lower case. */
RtStatus rt_mesh_expect(RtMeshReader *r, const char *text);

/* The value of a word that must be an integer of at most 18 digits. */
RtStatus rt_mesh_integer(const RtMeshReader *r, RtWord word, int64_t *out);

/* The value of a word that must be a coordinate: the float32 nearest to it, or if the mesh moves, the double.
 * NaN if it is NaN or overflows, which unused vertices may. */
RtStatus rt_mesh_coordinate(const RtMeshReader *r, RtWord word, double *out);

/* Takes the three coordinates of a vertex from a line, the first as rt_mesh_take. */
RtStatus rt_mesh_take_vertex(RtMeshReader *r, bool first, RtVec3d *out);

/* Fails: the file ends after `count` of the `declared` things that its header declares. */
RtStatus rt_mesh_fail_short(const RtMeshReader *r, uint64_t count, uint64_t declared, const char *things);

/* Rejects further words; warns of a last line without a line break: its last number may have been cut off. */
RtStatus rt_mesh_end(RtMeshReader *r);

/* The same for a binary file: a few bytes more, less than a vertex, are a warning. */
enum { RT_MESH_FEW_BYTES = 12 };
RtStatus rt_mesh_end_binary(RtMeshReader *r);

/* ---- the formats ---- */

/* The first bytes of a binary file, and its size: what can be checked before the file is read. */
enum { RT_MESH_HEAD = 84 };
typedef struct RtMeshHead {
    unsigned char bytes[RT_MESH_HEAD + 1]; /* zeros behind the end of the file */
    uint64_t size;
} RtMeshHead;

/* Rejects a file that begins otherwise, or has another size, than its format says. */
RtStatus rt_mesh_check_ply(RtMeshReader *r, const RtMeshHead *head);
RtStatus rt_mesh_check_stl(RtMeshReader *r, const RtMeshHead *head);
RtStatus rt_mesh_check_glb(RtMeshReader *r, const RtMeshHead *head);

/* Each reads the whole file of r->text, and adds its triangles to r->scene. */
RtStatus rt_mesh_read_obj(RtMeshReader *r);
RtStatus rt_mesh_read_mtl(RtMeshReader *r, RtWord name, const RtMaterial *plain); /* for OBJ: mesh_mtl.c */
RtStatus rt_mesh_read_off(RtMeshReader *r);
RtStatus rt_mesh_read_ply(RtMeshReader *r);
RtStatus rt_mesh_read_stl(RtMeshReader *r);
RtStatus rt_mesh_read_gltf(RtMeshReader *r);
RtStatus rt_mesh_read_glb(RtMeshReader *r);

/* Each writes all triangles. */
void rt_mesh_write_obj(const RtGeometry *g, FILE *file);
void rt_mesh_write_ply(const RtGeometry *g, FILE *file);
void rt_mesh_write_stl(const RtGeometry *g, FILE *file);
void rt_mesh_write_glb(const RtGeometry *g, FILE *file);

/* A number of 4 bytes, low byte first, as in memory; and three float32. */
static inline uint32_t rt_mesh_u32(const void *at) {
    uint32_t number;
    memcpy(&number, at, sizeof number);
    return number;
}

static inline RtVec3 rt_mesh_vector(const void *at) {
    RtVec3 v;
    memcpy(&v, at, sizeof v);
    return v;
}

#endif
