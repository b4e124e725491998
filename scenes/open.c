/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/open.h"

#include "core/scene/load.h"
#include "scenes/builtin.h"

RtStatus rt_scene_open(const char *spec, RtScene *scene, RtError *error) {
    bool builtin =
        rt_builtin_find(spec) || !rt_scene_is_file(spec); /* unknown names are refused by the list */
    return builtin ? rt_builtin_open(spec, scene, error) : rt_scene_load(spec, rt_builtin_open, scene, error);
}
