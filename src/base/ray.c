#include "base/ray.h"

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
    char list[256] = "";
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
        if (strcmp(kind_names[k], name) == 0) {
            *kind = (RtRayKind)k;
            return RT_OK;
        }
        size_t used = strlen(list);
        snprintf(list + used, sizeof list - used, "%s%s", k ? ", " : "", kind_names[k]);
    }
    return rt_fail(error, RT_BAD_INPUT, "there is no ray kind '%.40s'; the kinds are %s", name, list);
}
