/* SPDX-License-Identifier: Apache-2.0 */
/* Mesh solids in exact arithmetic: what one is, exactly, says exact_hit.h. */
#ifndef RT_EXACT_EXACT_MESH_H
#define RT_EXACT_EXACT_MESH_H

#include "core/shape/solid.h"
#include "exact/line.h"

/* Where the whole line, whatever its interval, goes in and out of mesh solid `index`, by turns and in
 * ascending order; places beyond FLT_MAX may be left out. *places is the caller's, who frees it by rt_free;
 * the numbers are in the arena. */
RtStatus rt_exact_mesh_places(RtExactArena *arena, const RtSolidSet *set, uint32_t index,
                              const RtExactLine *line, RtRational **places, uint32_t *count, RtError *error);

#endif
