/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/studio.h"

#include "core/scene/nff.h"

static RtMaterial make(RtStudioMaterial material) {
    switch (material) {
    case RT_STUDIO_CLAY: return rt_nff_material("clay", rt_vec3(0.9f, 0.5f, 0.3f), 0.9f, 0, 1, 0, 1);
    case RT_STUDIO_SLATE: return rt_nff_material("slate", rt_vec3(0.3f, 0.4f, 0.6f), 0.9f, 0, 1, 0, 1);
    case RT_STUDIO_MOSS: return rt_nff_material("moss", rt_vec3(0.4f, 0.6f, 0.3f), 0.9f, 0, 1, 0, 1);
    case RT_STUDIO_STEEL: return rt_nff_material("steel", rt_vec3(0.8f, 0.8f, 0.8f), 0.4f, 0.5f, 50, 0, 1);
    case RT_STUDIO_GLASS: break;
    }
    return rt_nff_material("glass", rt_vec3(0.9f, 1, 0.9f), 0.1f, 0.1f, 100, 0.8f, 1.3f);
}

RtStatus rt_studio(RtScene *scene, const RtStudioMaterial chosen[RT_STUDIO_MATERIALS], RtError *error) {
    for (int i = 0; i < RT_STUDIO_MATERIALS; i++) {
        RtMaterial material = make(chosen[i]);
        uint32_t index;
        RT_TRY(rt_scene_add_material(scene, &material, &index, error));
    }
    RT_TRY(rt_scene_add_light(scene, rt_vec3(4, 3, 6), rt_vec3(0.6f, 0.6f, 0.6f), error));
    return rt_scene_add_light(scene, rt_vec3(5, -6, 2), rt_vec3(0.4f, 0.4f, 0.4f), error);
}
