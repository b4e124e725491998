/* SPDX-License-Identifier: Apache-2.0 */
/* raytally's own scene format; see docs/scenes.md. */
#ifndef RT_SCENE_YAML_H
#define RT_SCENE_YAML_H

#include "core/scene/scene.h"

#include <stdio.h>

/* X(name): the coefficients of a material, keys of the file and fields of RtMaterial alike. */
#define RT_YAML_COEFFICIENTS(X)                                                                              \
    X(ambient) X(diffuse) X(specular) X(shine) X(reflection) X(transmission) X(ior)

/* Reads the file at `path` into `scene`, initialised by rt_scene_init; the caller then finishes it, or
 * clears it after a failure. Mesh paths are relative to the file; `open_named` opens scenes that it names.
 * The scene's name does not change. */
RtStatus rt_yaml_load(const char *path, RtSceneOpener *open_named, RtScene *scene, RtError *error);

/* The same for a text in memory; `name` stands for the path. */
RtStatus rt_yaml_load_text(const char *name, const char *text, RtSceneOpener *open_named, RtScene *scene,
                           RtError *error);

/* Writes a finished scene, one object per line; reading it back yields the same fingerprint. Meshes and
 * built-ins are written as their objects. Materials keep their names if all are valid and different;
 * otherwise they are called m0, m1 ... */
RtStatus rt_yaml_save(const RtScene *scene, FILE *out, RtError *error);

#endif
