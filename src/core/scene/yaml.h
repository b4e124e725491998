/* SPDX-License-Identifier: Apache-2.0 */
/* raytally's own scene format, described with examples in docs/scenes.md. */
#ifndef RT_SCENE_YAML_H
#define RT_SCENE_YAML_H

#include "core/scene/scene.h"

#include <stdio.h>

/* Adds what the file at `path` describes to `scene`, initialised by rt_scene_init; the caller then finishes
 * it, or clears it after a failure. Meshes are looked for beside the file, other scenes that it names are
 * opened by `open_named`. The scene's name is not touched. */
RtStatus rt_yaml_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error);

/* The same of a text in memory; `name` stands for the path. */
RtStatus rt_yaml_load_text(const char *name, const char *text, RtSceneOpener *open_named, RtScene *scene,
                           RtError *error);

/* Writes a finished scene, one object a line; read again it has the same fingerprint. Meshes and built-ins
 * are written out as the objects they are. Materials keep their names if these are all there and all
 * different, and are called m0, m1 ... otherwise. */
RtStatus rt_yaml_save(const RtScene *scene, FILE *out, RtError *error);

#endif
