/* SPDX-License-Identifier: Apache-2.0 */
/* What scenes of random objects stand in: materials by which every kind of ray can be traced, and two
 * lights. */
#ifndef RT_SCENES_STUDIO_H
#define RT_SCENES_STUDIO_H

#include "core/scene/scene.h"

typedef enum RtStudioMaterial {
    RT_STUDIO_CLAY, /* matte, as are slate and moss */
    RT_STUDIO_SLATE,
    RT_STUDIO_MOSS,
    RT_STUDIO_STEEL, /* a mirror */
    RT_STUDIO_GLASS
} RtStudioMaterial;

#define RT_STUDIO_MATERIALS 4

/* Adds the lights, and the materials `chosen`, which become materials 0.. of the scene, empty before. */
RtStatus rt_studio(RtScene *scene, const RtStudioMaterial chosen[RT_STUDIO_MATERIALS], RtError *error);

#endif
