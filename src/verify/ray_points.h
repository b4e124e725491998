/* SPDX-License-Identifier: Apache-2.0 */
/* Random points where hard rays start and aim: in boxes, and at the vertices, edges and surfaces of
 * objects. In an empty scene they are arbitrary. */
#ifndef RT_VERIFY_RAY_POINTS_H
#define RT_VERIFY_RAY_POINTS_H

#include "core/base/random.h"
#include "core/shape/geometry.h"

/* A part of an object. The vertices of a sphere are the six points where it touches its box, those of a
 * cone lie on its two circles; a CSG tree has the vertices and edges of the box of one of its solids. */
typedef enum RtWhere { RT_AT_VERTEX, RT_ON_EDGE, RT_ON_SURFACE } RtWhere;

RtVec3d rt_point_in_box(const RtBox *box, RtRandom *random);
RtVec3d rt_point_in_scene(const RtGeometry *geometry, RtRandom *random);

/* A point of a random object, and its id (RT_NO_OBJECT if there is none); `crossings` comes from
 * rt_crossings_alloc. */
RtVec3d rt_point_of_object(const RtGeometry *geometry, RtWhere where, RtRandom *random, RtCrossing *crossings,
                           uint32_t *id);

/* The box of a random object, or of the scene. */
const RtBox *rt_some_box(const RtGeometry *geometry, RtRandom *random);

#endif
