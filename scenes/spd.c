/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/spd.h"

void rt_spd_lights(RtSceneBuilder *b, const RtVec3d *positions, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) rt_build_light(b, positions[i], rt_nff_light_intensity(count));
}

RtVec3d rt_spd_rotate(RtVec3d v, RtVec3d axis, RtTurn turn) {
    RtVec3d turned = rt_add_scaledd(rt_scaled(v, turn.cosine), rt_crossd(axis, v), turn.sine);
    return rt_add_scaledd(turned, axis, rt_dotd(axis, v) * (1 - turn.cosine));
}

RtVec3d rt_spd_rotate_from_z(RtVec3d v, RtVec3d towards) {
    double cosine = towards.z;
    if (cosine >= 0.9999) return v;
    if (cosine <= -0.9999) return rt_vec3d(-v.x, v.y, -v.z);
    RtTurn turn = {.cosine = cosine, .sine = sqrt(1 - cosine * cosine)};
    return rt_spd_rotate(v, rt_normalized(rt_vec3d(-towards.y, towards.x, 0)), turn);
}
