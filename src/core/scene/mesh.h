/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle meshes, through Assimp: OBJ, PLY, STL, glTF and all other formats that it reads, except NFF, which
 * has its own reader.
 *
 * Triangles come in the order of Assimp's scene: nodes depth first, the meshes of a node, the faces of a
 * mesh. Polygons are triangulated; points and lines are skipped. Nothing is merged, removed or invented:
 * triangles without area stay (they are never hit), and only the file's own vertex normals are used.
 * Materials, cameras and lights of the file are ignored. */
#ifndef RT_SCENE_MESH_H
#define RT_SCENE_MESH_H

#include "core/base/transform.h"
#include "core/scene/scene.h"

#include <stdio.h>

/* True if Assimp reads files with this extension, given without its dot. */
bool rt_mesh_reads(const char *extension);

/* Adds the triangles of `path` to the scene with `material`, moved by `transform` (NULL: in place). After
 * a failure some may remain, and the scene must be cleared. Rejects files that Assimp cannot read (with
 * its message), files without triangles, and vertices that are not finite (with their index). */
RtStatus rt_mesh_append(RtScene *scene, const char *path, uint32_t material, const RtTransform *transform,
                        RtError *error);

/* Reads a mesh file into a scene from rt_scene_init: default material, +Y up. */
RtStatus rt_mesh_load(const char *path, RtScene *scene, RtError *error);

/* The extensions that rt_mesh_save writes, without dots; NULL after the last. */
const char *rt_mesh_written(size_t i);

/* Writes the triangles of a scene in the format of `extension`, without sharing vertices. Coordinates
 * survive bit for bit in ply and stl, within the rounding of Assimp's reader in obj, and in glb except
 * that Assimp's writer joins nearly equal vertices. stl has facet normals only. If only some triangles
 * have vertex normals, ply and glb use the geometric normal for the others. Rejects scenes with other
 * shapes and names formats that support them. Materials, lights and camera are not written. */
RtStatus rt_mesh_save(const RtScene *scene, const char *extension, FILE *file, RtError *error);

#endif
