/* Scenes by name: a file in any format raytally reads, or a built-in with parameters ("balls:size=5"). */
#ifndef RT_SCENE_LOAD_H
#define RT_SCENE_LOAD_H

#include "scene/scene.h"

/* Opens `spec`: a name with a known extension (.yaml .yml .nff, or any mesh format of Assimp's) is a file,
 * all else a built-in, "name[:key=value,...]". On success *scene is finished, has at least one object, and is
 * owned by the caller (rt_scene_clear); on failure it is empty. */
RtStatus rt_scene_open(const char *spec, RtScene *scene, RtError *error);

/* Writes `scene` in the format that the extension of `path` names, to a temporary file that is then renamed.
 * `path` must not exist unless `overwrite`. Formats that cannot hold an object of the scene refuse it. */
RtStatus rt_scene_save(const RtScene *scene, const char *path, bool overwrite, RtError *error);

#endif
