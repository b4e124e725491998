/* SPDX-License-Identifier: Apache-2.0 */
/* Scene files in any format that raytally reads or writes. */
#ifndef RT_SCENE_LOAD_H
#define RT_SCENE_LOAD_H

#include "core/scene/scene.h"

#include <stdio.h>

/* True if `spec` is the path of a file: the file exists, or the name has a folder or an extension. */
bool rt_scene_is_file(const char *spec);

/* Reads the file at `path`, in the format of its extension (.yaml .yml .nff, or those of mesh.h).
 * `open_named` opens scenes that a YAML file refers to by name. Subtracts *offset (NULL: none) from
 * everything that has a place (RtScene); if it is NaN, it becomes the centre of the scene, rounded to few
 * bits, for which the file is read twice. On success *scene is finished, has at least one object, and belongs
 * to the caller (rt_scene_clear); on failure it is empty. */
RtStatus rt_scene_load(const char *path, RtSceneOpener *open_named, RtVec3d *offset, RtScene *scene,
                       RtError *error);

/* Writes `scene` in the format of the extension of `path`, through a temporary file. Fails if the format
 * cannot represent an object of the scene. */
RtStatus rt_scene_save(const RtScene *scene, const char *path, RtError *error);

/* True for YAML: other formats get instances as copies, and no textures. */
bool rt_scene_keeps_instances(const char *path);

/* ---- raytally's own format (docs/scenes.md): yaml_read.c and yaml_write.c ---- */

/* X(name): the coefficients of a material, keys of the file and fields of RtMaterial alike. */
#define RT_YAML_COEFFICIENTS(X)                                                                              \
    X(ambient) X(diffuse) X(specular) X(shine) X(reflection) X(transmission) X(ior)

/* Reads the file at `path` into `scene`, initialised by rt_scene_init; the caller then finishes it, or
 * clears it after a failure. Paths of meshes and images are relative to the file; `open_named` opens scenes
 * that it names. The scene's name does not change. */
RtStatus rt_yaml_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error);

/* The same for a text in memory; `name` stands for the path. */
RtStatus rt_yaml_load_text(const char *name, const char *text, RtSceneOpener *open_named, RtScene *scene,
                           RtError *error);

/* Writes a finished scene, one object per line; reading it back yields the same fingerprint. Meshes and
 * built-ins are written as their objects, images of textures as absolute paths. Materials keep their names if
 * all are valid and different; otherwise they are called m0, m1 ..., and parts likewise p0, p1 ... */
RtStatus rt_yaml_save(const RtScene *scene, FILE *out, RtError *error);

#endif
