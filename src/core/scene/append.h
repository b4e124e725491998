/* SPDX-License-Identifier: Apache-2.0 */
/* Puts the objects of one scene into another, or some of them into a scene of their own. */
#ifndef RT_SCENE_APPEND_H
#define RT_SCENE_APPEND_H

#include "core/base/transform.h"
#include "core/scene/scene.h"

/* Appends the objects of `from`, in their order and with their materials (one that `to` has already, name and
 * all, is shared), moved by `transform` or as they are if that is NULL. Lights and camera of `from` are left
 * behind. Spheres and cones are refused under a transform that scales unevenly; CSG trees take any. After a
 * failure `to` may hold a part of the objects. */
RtStatus rt_scene_append(RtScene *to, const RtScene *from, const RtTransform *transform, RtError *error);

/* Makes *to of the objects ids[0..count) of the finished scene `from`, in that order, with its lights, camera
 * and sampling: finished, owned by the caller. Their hits are those of `from`, bit for bit. */
RtStatus rt_scene_subset(const RtScene *from, const uint32_t *ids, uint32_t count, RtScene *to,
                         RtError *error);

#endif
