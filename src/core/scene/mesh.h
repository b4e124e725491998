/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle meshes: OBJ, PLY, STL, OFF and glTF 2.0.
 *
 * Triangles come in the order of the file; of glTF, nodes depth first, then the primitives of a mesh.
 * Polygons are split into triangles; points and lines are skipped. Nothing is merged, removed or invented:
 * triangles without area stay (they are never hit), and only the file's own vertex normals are used.
 * Materials, cameras and lights of the file are ignored.
 *
 * A damaged file is rejected with the place of the damage, in time and memory proportional to its size. (glTF
 * may place a mesh many times, but at most 1000 vertices and corners for each byte.) That is why the readers
 * are our own (mesh_reader.h): Assimp 5 loads much of what is cut off or inconsistent, and crashes or hangs
 * on some files. A child process would end a crash, but its result would still need a check that reads every
 * number of the file again. */
#ifndef RT_SCENE_MESH_H
#define RT_SCENE_MESH_H

#include "core/base/transform.h"
#include "core/scene/scene.h"

#include <stdio.h>

/* The extension of format `i`, without the dot; NULL after the last. All can be read, and the first can be
 * written. */
enum { RT_MESH_WRITTEN = 4 };
const char *rt_mesh_extension(size_t i);

/* Adds the triangles of `path` to the scene with `material`, moved by `transform` (NULL: in place). After
 * a failure some may remain, and the scene must be cleared. Rejects damaged files, files without triangles,
 * vertices that are not finite, and polygons that cross themselves. */
RtStatus rt_mesh_append(RtScene *scene, const char *path, uint32_t material, const RtTransform *transform,
                        RtError *error);

/* Reads a mesh file into a scene from rt_scene_init: default material, +Y up. */
RtStatus rt_mesh_load(const char *path, RtScene *scene, RtError *error);

/* Writes the triangles of a scene in format `i`, without sharing vertices. Coordinates
 * survive bit for bit in ply, stl and glb, and within the rounding of the reader in obj. stl has facet
 * normals only. If only some triangles have vertex normals, ply and glb use the geometric normal for the
 * others. Rejects scenes with other shapes and names formats that support them. Materials, lights and camera
 * are not written. */
RtStatus rt_mesh_save(const RtScene *scene, size_t i, FILE *file, RtError *error);

#endif
