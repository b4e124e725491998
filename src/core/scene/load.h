/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes as files, in any format that raytally reads or writes. */
#ifndef RT_SCENE_LOAD_H
#define RT_SCENE_LOAD_H

#include "core/scene/scene.h"

/* Is `spec` the path of a file: of one that is there, or with a folder or an extension? */
bool rt_scene_is_file(const char *spec);

/* Reads the file at `path`, whose extension names its format (.yaml .yml .nff, or any mesh format of
 * Assimp's). Scenes that a YAML file names rather than describes are opened by `open_named`. On success
 * *scene is finished, has at least one object, and is owned by the caller (rt_scene_clear); on failure it is
 * empty. */
RtStatus rt_scene_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error);

/* Writes `scene` in the format that the extension of `path` names, to a temporary file that is then renamed.
 * `path` must not exist unless `overwrite`. Formats that cannot hold an object of the scene refuse it. */
RtStatus rt_scene_save(const RtScene *scene, const char *path, bool overwrite, RtError *error);

#endif
