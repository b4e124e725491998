/* Specs, "name:key=value,key=value", and what is common to all accelerators: building, queries, destroying.
 */
#include "accel/accel.h"

#include "base/memory.h"

#include <stdio.h>
#include <string.h>

RtStatus rt_spec_parse(const char *text, RtSpec *spec, RtError *error) {
    char name[RT_MAX_NAME];
    size_t length = strcspn(text, ":");
    if (length == 0 || length >= sizeof name) {
        return rt_fail(error, RT_BAD_INPUT,
                       "'%.80s' is no spec of an accelerator: write NAME[:KEY=VALUE,...]", text);
    }
    memcpy(name, text, length);
    name[length] = '\0';
    spec->ops = rt_accel_find(name, error);
    if (!spec->ops) return RT_BAD_INPUT;
    char what[RT_MAX_NAME + 16];
    snprintf(what, sizeof what, "accelerator %s", name);
    const char *params = text[length] == ':' ? text + length + 1 : NULL;
    return rt_params_parse(spec->ops->params, spec->ops->param_count, params, what, spec->values, error);
}

void rt_spec_format(const RtSpec *spec, char *out) {
    int n = snprintf(out, RT_MAX_SPEC_CHARS, "%s%s", spec->ops->name, spec->ops->param_count ? ":" : "");
    rt_params_format(spec->ops->params, spec->ops->param_count, spec->values, out + n,
                     RT_MAX_SPEC_CHARS - (size_t)n);
}

RtStatus rt_accel_build(const RtSpec *spec, const RtScene *scene, RtAccel **out, RtError *error) {
    *out = NULL;
    return spec->ops->build(scene, spec->values, out, error);
}

RtStatus rt_accel_open(const char *spec, const RtScene *scene, RtAccel **out, RtError *error) {
    RtSpec parsed;
    *out = NULL;
    RT_TRY(rt_spec_parse(spec, &parsed, error));
    return rt_accel_build(&parsed, scene, out, error);
}

void rt_accel_destroy(RtAccel *accel) {
    if (accel) accel->ops->destroy(accel);
}

RtStatus rt_query_init(RtQuery *query, const RtAccel *accel, RtError *error) {
    *query = (RtQuery){accel, NULL};
    if (!accel->ops->scratch_bytes) return RT_OK;
    size_t bytes = accel->ops->scratch_bytes(accel);
    query->scratch = rt_alloc(bytes, 1);
    return query->scratch ? RT_OK : rt_fail_memory(error, "the scratch memory of a query", bytes);
}

void rt_query_clear(RtQuery *query) {
    rt_free(query->scratch);
    *query = (RtQuery){NULL, NULL};
}

void rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies) {
    const RtAccelOps *ops = query->accel->ops;
    if (tallies) {
        ops->nearest_counted(query->accel, query->scratch, rays, count, hits, tallies);
    } else {
        ops->nearest(query->accel, query->scratch, rays, count, hits);
    }
}

void rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies) {
    const RtAccelOps *ops = query->accel->ops;
    if (tallies) {
        ops->occluded_counted(query->accel, query->scratch, rays, count, blocked, tallies);
    } else {
        ops->occluded(query->accel, query->scratch, rays, count, blocked);
    }
}
