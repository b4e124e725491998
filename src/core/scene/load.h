/* SPDX-License-Identifier: Apache-2.0 */
/* Scene files in any format that raytally reads or writes. */
#ifndef RT_SCENE_LOAD_H
#define RT_SCENE_LOAD_H

#include "core/scene/scene.h"

/* True if `spec` is the path of a file: the file exists, or the name has a folder or an extension. */
bool rt_scene_is_file(const char *spec);

/* Reads the file at `path`, in the format of its extension (.yaml .yml .nff, or those of mesh.h).
 * `open_named` opens scenes that a YAML file refers to by name. On success *scene is finished, has at least
 * one object, and belongs to the caller (rt_scene_clear); on failure it is empty. */
RtStatus rt_scene_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error);

/* Writes `scene` in the format of the extension of `path`, through a temporary file. `path` must not exist
 * unless `overwrite`. Fails if the format cannot represent an object of the scene. */
RtStatus rt_scene_save(const RtScene *scene, const char *path, bool overwrite, RtError *error);

#endif
