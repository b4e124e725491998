/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/ray_file.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/text/npy.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(offsetof(RtRay, org) == 0 && offsetof(RtRay, tmin) == 3 * sizeof(float) &&
                   offsetof(RtRay, dir) == 4 * sizeof(float) && offsetof(RtRay, tmax) == 7 * sizeof(float),
               "a ray begins with its row");

/* Rows read at a time. */
enum { BLOCK = 1024 };

/* ---- rays ---- */

RtStatus rt_rays_save(const RtRaySet *set, const char *path, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    rt_npy_begin(output.file, "'<f4'", set->count, RT_RAY_COLUMNS);
    for (uint64_t i = 0; i < set->count; i++) {
        fwrite(&set->rays[i], sizeof(float), RT_RAY_COLUMNS, output.file);
    }
    return rt_output_commit(&output, error);
}

/* The broken invariant of rt_ray_is_valid. */
static const char *fault_of(const RtRay *ray) {
    float size = rt_maxf(rt_maxf(fabsf(ray->org.x), fabsf(ray->org.y)), fabsf(ray->org.z));
    if (!rt_finite(ray->org) || size > RT_MAX_COORDINATE) return "its origin is not finite, or beyond 5e17";
    if (!rt_finite(ray->dir)) return "its direction is not finite";
    if (ray->dir.x == 0 && ray->dir.y == 0 && ray->dir.z == 0) return "its direction is zero";
    if (!(ray->tmin >= 0) || !isfinite(ray->tmin)) return "its tmin is negative or not finite";
    return "its tmax is less than its tmin, or not a number";
}

static RtStatus read_rays(RtNpy *npy, RtRaySet *set, RtError *error) {
    float rows[BLOCK][RT_RAY_COLUMNS];
    for (uint64_t first = 0; first < set->count; first += BLOCK) {
        uint64_t count = set->count - first < BLOCK ? set->count - first : BLOCK;
        RT_TRY(rt_npy_read(npy, count, rows[0], error));
        for (uint64_t i = 0; i < count; i++) {
            RtRay *ray = &set->rays[first + i];
            *ray = (RtRay){.kind = set->kind};
            memcpy(ray, rows[i], sizeof rows[i]);
            if (rt_ray_is_valid(ray)) continue;
            return rt_fail(error, RT_BAD_INPUT,
                           "%s: row %" PRIu64
                           " (the first is 0) is not a valid ray: %s. It has origin %.9g %.9g %.9g, tmin "
                           "%.9g, direction %.9g %.9g %.9g, tmax %.9g",
                           npy->path, first + i, fault_of(ray), (double)rows[i][0], (double)rows[i][1],
                           (double)rows[i][2], (double)rows[i][3], (double)rows[i][4], (double)rows[i][5],
                           (double)rows[i][6], (double)rows[i][7]);
        }
    }
    return RT_OK;
}

RtStatus rt_rays_load(const char *path, RtRayKind kind, RtRaySet *set, RtError *error) {
    RtNpy npy;
    *set = (RtRaySet){.kind = kind};
    RtStatus status = rt_npy_open(&npy, path, RT_RAY_COLUMNS, RT_MAX_RAYS_A_KIND, error);
    if (status == RT_OK && npy.rows == 0)
        status = rt_fail(error, RT_BAD_INPUT, "%s: it contains no rays", path);
    if (status == RT_OK) status = rt_rayset_init(set, kind, npy.rows, error);
    if (status == RT_OK) status = read_rays(&npy, set, error);
    rt_npy_close(&npy);
    if (status == RT_OK) {
        rt_rayset_seal(set);
    } else {
        rt_rayset_clear(set);
    }
    return status;
}

/* ---- answers and counts ---- */

void rt_hits_put(const RtRows *rows, FILE *out) {
    rt_npy_begin(out, rows->blocked ? "'|b1'" : "[('t', '<f4'), ('object', '<i8')]", rows->count, 0);
    if (rows->blocked) fwrite(rows->blocked, sizeof(bool), rows->count, out);
    for (uint64_t i = 0; rows->hits && i < rows->count; i++) {
        int64_t object = rows->hits[i].object == RT_NO_OBJECT ? -1 : (int64_t)rows->hits[i].object;
        fwrite(&rows->hits[i].t, sizeof(float), 1, out);
        fwrite(&object, sizeof object, 1, out);
    }
}

void rt_counts_put(const RtRows *rows, FILE *out) {
#define FIELD(name, meaning) "('" #name "', '<u8'), "
    rt_npy_begin(out, "[" RT_TALLY_COUNTERS(FIELD) "]", rows->count, 0);
    fwrite(rows->tallies, sizeof(RtTally), rows->count, out);
#undef FIELD
}
