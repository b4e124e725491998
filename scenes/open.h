/* SPDX-License-Identifier: Apache-2.0 */
/* Opens scenes by name: a file in any format that raytally reads, or a built-in with parameters
 * ("balls:size=5"). */
#ifndef RT_SCENES_OPEN_H
#define RT_SCENES_OPEN_H

#include "core/scene/scene.h"

/* Opens `spec`: "name[:key=value,...]" of a built-in, or the path of a file (rt_scene_is_file). On success
 * *scene is finished and owned by the caller (rt_scene_clear); on failure it is empty. */
RtStatus rt_scene_open(const char *spec, RtScene *scene, RtError *error);

#endif
