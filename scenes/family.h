/* SPDX-License-Identifier: Apache-2.0 */
/* Families of scenes that are hard on accelerators: objects that coincide, are flat, huge, tiny or far
 * away, slivers, shared edges, trees. Each is the built-in scene "family:kind=NAME,seed=N"; these
 * functions enumerate them. */
#ifndef RT_SCENES_FAMILY_H
#define RT_SCENES_FAMILY_H

#include "core/base/param.h"

size_t rt_family_count(void);
const char *rt_family_name(size_t family);

/* The spec of scene number `seed` of a family, for rt_scene_open. */
void rt_family_spec(size_t family, uint64_t seed, char spec[RT_MAX_SPEC_CHARS]);

#endif
