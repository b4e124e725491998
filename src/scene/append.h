/* Puts the objects of one scene into another. */
#ifndef RT_SCENE_APPEND_H
#define RT_SCENE_APPEND_H

#include "base/transform.h"
#include "scene/scene.h"

/* Appends the objects of `from`, in their order and with their materials (one that `to` has already, name and
 * all, is shared), moved by `transform` or as they are if that is NULL. Lights and camera of `from` are left
 * behind. Spheres and cones are refused under a transform that scales unevenly; CSG trees take any. After a
 * failure `to` may hold a part of the objects. */
RtStatus rt_scene_append(RtScene *to, const RtScene *from, const RtTransform *transform, RtError *error);

#endif
