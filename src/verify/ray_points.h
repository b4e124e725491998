/* SPDX-License-Identifier: Apache-2.0 */
/* Points that hard rays start at and aim at: within boxes, and at the vertices, edges and surfaces of
 * objects. Each is drawn from random numbers; in an empty scene any point and any box will do. */
#ifndef RT_VERIFY_RAY_POINTS_H
#define RT_VERIFY_RAY_POINTS_H

#include "core/base/random.h"
#include "core/shape/geometry.h"

/* Where on an object. Of a sphere the vertices are the six points at which it touches its box, of a cone the
 * points of its two circles; of a CSG tree vertices and edges are those of the box of one of its solids. */
typedef enum RtWhere { RT_AT_VERTEX, RT_ON_EDGE, RT_ON_SURFACE } RtWhere;

RtVec3d rt_point_in_box(const RtBox *box, RtRandom *random);
RtVec3d rt_point_in_scene(const RtGeometry *geometry, RtRandom *random);

/* A point of an object, and the object's id, RT_NO_OBJECT where there is none; `room` is of rt_hit_room. */
RtVec3d rt_point_of_object(const RtGeometry *geometry, RtWhere where, RtRandom *random, RtCrossing *room,
                           uint32_t *id);

/* The box of some object, or that of the scene. */
const RtBox *rt_some_box(const RtGeometry *geometry, RtRandom *random);

#endif
