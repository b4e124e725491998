/* SPDX-License-Identifier: Apache-2.0 */
/* Triangle meshes, through Assimp: OBJ, PLY, STL, glTF and what else it reads. Scenes in NFF and YAML have
 * readers of their own.
 *
 * Triangles come in the order of the file as Assimp gives it: its nodes depth first, the meshes of a node,
 * the faces of a mesh. Polygons are cut into triangles, points and lines left out. Nothing is merged, removed
 * or made up: triangles without area stay (they are never hit), and there are vertex normals only where the
 * file has them. Materials, cameras and lights of the file are not taken over. */
#ifndef RT_SCENE_MESH_H
#define RT_SCENE_MESH_H

#include "core/base/transform.h"
#include "core/scene/scene.h"

#include <stdio.h>

/* Does Assimp read files with this extension, given without its dot? */
bool rt_mesh_reads(const char *extension);

/* Adds the triangles of `path` to the scene, all of `material`, moved by `transform` (NULL: left in place).
 * A failure may leave some of them in the scene, which is then to be cleared. Refuses files that Assimp
 * cannot read (with its message), that hold no triangle, or a vertex that is not finite (with its index). */
RtStatus rt_mesh_append(RtScene *scene, const char *path, uint32_t material, const RtTransform *transform,
                        RtError *error);

/* Reads a bare mesh into a scene that rt_scene_init has made: the default material, +Y up. */
RtStatus rt_mesh_load(const char *path, RtScene *scene, RtError *error);

/* The extensions that rt_mesh_save writes, without dots; NULL after the last. */
const char *rt_mesh_written(size_t i);

/* Writes the triangles of a scene in the format that belongs to `extension`, without sharing vertices.
 * Coordinates come back bit for bit from ply and stl; from obj within the rounding of Assimp's reader; from
 * glb but for vertices of nearly the same place, which Assimp's writer joins. stl has facet normals alone.
 * Where some triangles have vertex normals, ply and glb give the others their geometric normal. Refuses
 * scenes with objects of other shapes, naming formats that hold them. Materials, lights and camera are not
 * written. */
RtStatus rt_mesh_save(const RtScene *scene, const char *extension, FILE *file, RtError *error);

#endif
