/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/ray.h"

#include "core/base/words.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

static const char *const kind_names[RT_RAY_KIND_COUNT] = {
#define NAME(CONSTANT, name, meaning) #name,
    RT_RAY_KINDS(NAME)
#undef NAME
};

const char *rt_ray_kind_name(RtRayKind kind) {
    assert(kind < RT_RAY_KIND_COUNT);
    return kind_names[kind];
}

RtStatus rt_ray_kind_parse(const char *name, RtRayKind *kind, RtError *error) {
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
        if (strcmp(kind_names[k], name) != 0) continue;
        *kind = (RtRayKind)k;
        return RT_OK;
    }
    char list[256];
    rt_join_names(kind_names, RT_RAY_KIND_COUNT, list, sizeof list);
    return rt_fail(error, RT_BAD_INPUT, "there is no ray kind '%.40s'; the kinds are %s", name, list);
}

void rt_ray_format(const RtRay *ray, char *out, size_t size) {
    snprintf(out, size, "org (%.9g, %.9g, %.9g) dir (%.9g, %.9g, %.9g) t in [%.9g, %.9g]", (double)ray->org.x,
             (double)ray->org.y, (double)ray->org.z, (double)ray->dir.x, (double)ray->dir.y,
             (double)ray->dir.z, (double)ray->tmin, (double)ray->tmax);
}
