/* SPDX-License-Identifier: Apache-2.0 */
/* Structured input: objects and rays whose numbers are small integers, or halves, so that rays pass exactly
 * through vertices, edges, rims and tip, or touch. */
#ifndef RT_TESTS_EXACT_LATTICE_H
#define RT_TESTS_EXACT_LATTICE_H

#include "core/base/random.h"
#include "core/base/status.h"
#include "core/shape/geometry.h"
#include "exact/precision.h"

/* Points of an object where a ray is decided at a border, or is easily. */
typedef struct RtLattice {
    RtVec3 targets[32];
    uint32_t count;
} RtLattice;

/* Adds an object to the geometry, and its points to `lattice`. */
RtStatus rt_lattice_add(RtLattice *lattice, RtGeometry *geometry, RtSubject subject, RtRandom *random,
                        RtError *error);

/* Exactly through one of the points. */
RtRay rt_lattice_ray(const RtLattice *lattice, RtRandom *random);

#endif
