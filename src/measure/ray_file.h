/* SPDX-License-Identifier: Apache-2.0 */
/* Ray sets as arrays of NumPy (core/text/npy.h), so that rays may come from any other renderer, and answers
 * and counts may go to any other program. experiments/README.md says what each column is. */
#ifndef RT_MEASURE_RAY_FILE_H
#define RT_MEASURE_RAY_FILE_H

#include "measure/measure.h"

/* Floats a row: origin, tmin, direction, tmax. */
#define RT_RAY_COLUMNS 8

/* Writes the rays, whole or not at all: float32, a row each. */
RtStatus rt_rays_save(const RtRaySet *set, const char *path, RtError *error);

/* Reads rays and makes them of `kind`, with source 0. Refuses a file without any, and the first ray that is
 * not valid (rt_ray_is_valid), by its row. Free with rt_rayset_clear. */
RtStatus rt_rays_load(const char *path, RtRayKind kind, RtRaySet *set, RtError *error);

/* Writes what each ray met: fields t (float32; inf for a miss) and object (int64; -1 for a miss); where the
 * kind of `rows` is asked for any hit, whether it met something, an array of bool. */
RtStatus rt_hits_save(const RtRows *rows, const char *path, RtError *error);

/* Writes what each ray cost: a field of uint64 for each counter. */
RtStatus rt_counts_save(const RtRows *rows, const char *path, RtError *error);

#endif
