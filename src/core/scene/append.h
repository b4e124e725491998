/* SPDX-License-Identifier: Apache-2.0 */
/* Copies the objects of one scene into another, or some of them into a scene of their own. */
#ifndef RT_SCENE_APPEND_H
#define RT_SCENE_APPEND_H

#include "core/base/transform.h"
#include "core/scene/scene.h"

/* Appends the objects of `from` in order, moved by `transform` (NULL: in place), with their materials; a
 * material that `to` already has, name included, is shared. Lights and camera are not copied. Spheres and
 * cones are rejected under a transform that scales unevenly; CSG trees accept any. After a failure `to`
 * may contain some of the objects. */
RtStatus rt_scene_append(RtScene *to, const RtScene *from, const RtTransform *transform, RtError *error);

/* Creates the finished scene *to from the objects ids[0..count) of the finished scene `from`, in that
 * order, with its lights, camera and sampling. The caller owns it. Its hits are those of `from`, bit for
 * bit. */
RtStatus rt_scene_subset(const RtScene *from, const uint32_t *ids, uint32_t count, RtScene *to,
                         RtError *error);

#endif
