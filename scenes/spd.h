/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by scenes of the Standard Procedural Databases. Objects come in the order of the package's files.
 * They are computed in double with + - * / sqrt and core/base/elementary.h alone and rounded once, so that
 * every compiler and library produces the same float32. */
#ifndef RT_SCENES_SPD_H
#define RT_SCENES_SPD_H

#include "core/base/elementary.h"
#include "scenes/build.h"

#define RT_SPD_SOURCE "SPD: E. Haines 1987, A Proposal for Standard Graphics Environments, IEEE CG&A 7(11)"

#define RT_SPD_LATER_SOURCE "SPD: E. Haines, Standard Procedural Databases 3, later than the paper of 1987"

/* Adds white lights with SPD's intensity (rt_nff_light_intensity). */
void rt_spd_lights(RtSceneBuilder *b, const RtVec3d *positions, uint32_t count);

/* `v` rotated around the unit vector `axis`, counter-clockwise seen against it (Rodrigues). */
RtVec3d rt_spd_rotate(RtVec3d v, RtVec3d axis, RtTurn turn);

/* `v` under the shortest rotation that takes +Z to the unit vector `towards`. */
RtVec3d rt_spd_rotate_from_z(RtVec3d v, RtVec3d towards);

#endif
