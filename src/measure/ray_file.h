/* SPDX-License-Identifier: Apache-2.0 */
/* Ray sets as NumPy arrays (.npy): rays may come from any other renderer, and answers and counts
 * may go to any other program. docs/guide/own-rays.md describes the files. */
#ifndef RT_MEASURE_RAY_FILE_H
#define RT_MEASURE_RAY_FILE_H

#include "measure/measure.h"

#include <stdio.h>

/* Floats per row: origin, tmin, direction, tmax. */
#define RT_RAY_COLUMNS 8

/* Writes the rays, whole or not at all: float32, one row each. */
RtStatus rt_rays_save(const RtRaySet *set, const char *path, RtError *error);

/* Reads rays; they get the kind `kind` and source 0. Rejects an empty file, and an invalid ray
 * (rt_ray_is_valid) by its row. Free with rt_rayset_clear. */
RtStatus rt_rays_load(const char *path, RtRayKind kind, RtRaySet *set, RtError *error);

/* Writes an array of the hit of each ray: fields t (float32; inf for a miss) and object (int64; -1 for a
 * miss); for any-hit kinds, an array of bool. */
void rt_hits_put(const RtRows *rows, FILE *out);

/* Writes an array of the cost of each ray: a field of uint64 for each counter. */
void rt_counts_put(const RtRows *rows, FILE *out);

#endif
