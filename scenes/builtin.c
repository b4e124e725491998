/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/builtin.h"

#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/scene/load.h"
#include "scenes/open.h"

#include <stdio.h>
#include <string.h>

/* In the order of listing: the Standard Procedural Databases, then others. */
static const RtBuiltin *const builtins[] = {
    &rt_builtin_balls,  &rt_builtin_gears,     &rt_builtin_jacks,   &rt_builtin_lattice, &rt_builtin_mount,
    &rt_builtin_rings,  &rt_builtin_shells,    &rt_builtin_teapot,  &rt_builtin_tetra,   &rt_builtin_tree,
    &rt_builtin_random, &rt_builtin_csg_field, &rt_builtin_stadium, &rt_builtin_hall,    &rt_builtin_forest,
    &rt_builtin_city,   &rt_builtin_thicket,   &rt_builtin_family,
};

enum { BUILTIN_COUNT = sizeof builtins / sizeof builtins[0] };

const RtBuiltin *rt_builtin_at(size_t i) {
    return i < BUILTIN_COUNT ? builtins[i] : NULL;
}

const RtBuiltin *rt_builtin_find(const char *spec) {
    size_t length = strcspn(spec, ":");
    for (size_t i = 0; i < BUILTIN_COUNT; i++) {
        const char *name = builtins[i]->name;
        if (strlen(name) == length && strncmp(name, spec, length) == 0) return builtins[i];
    }
    return NULL;
}

RtStatus rt_builtin_named(const char *spec, const RtBuiltin **builtin, RtError *error) {
    *builtin = rt_builtin_find(spec);
    if (*builtin) return RT_OK;
    const char *names[BUILTIN_COUNT];
    char list[256], name[RT_MAX_NAME], suggestion[RT_MAX_SUGGESTION];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(spec, ":"), spec);
    for (size_t i = 0; i < BUILTIN_COUNT; i++) names[i] = builtins[i]->name;
    rt_join_names(names, BUILTIN_COUNT, list, sizeof list);
    rt_suggest(name, names, BUILTIN_COUNT, suggestion);
    return rt_fail(error, RT_BAD_INPUT,
                   "there is no built-in scene '%s'%s%s Built-in scenes: %s; a file needs its extension",
                   name, suggestion, *suggestion ? "" : ".", list);
}

uint64_t rt_builtin_object_count(const RtBuiltin *builtin, const RtValue *values) {
    return builtin->object_count ? builtin->object_count(values) : rt_build_count(builtin->generate, values);
}

static uint64_t bytes_each(const RtBuiltin *builtin, const RtValue *values) {
    if (builtin->object_bytes) return builtin->object_bytes(values);
    return builtin->bytes_each ? builtin->bytes_each : RT_BUILTIN_OBJECT_BYTES;
}

static bool fits(const RtBuiltin *builtin, const RtValue *values, uint64_t bytes) {
    const uint64_t count = rt_builtin_object_count(builtin, values);
    return count <= RT_MAX_OBJECTS && count * bytes_each(builtin, values) <= bytes;
}

RtStatus rt_builtin_check_memory(const RtBuiltin *builtin, const RtValue *values, uint64_t bytes,
                                 RtError *error) {
    if (fits(builtin, values, bytes)) return RT_OK;
    RtValue tried[RT_MAX_PARAMS];
    memcpy(tried, values, builtin->param_count * sizeof *values);
    const RtParam *size = &builtin->params[0];
    int64_t fitting = (int64_t)size->lo, too_large = values[0].i;
    while (fitting + 1 < too_large) { /* bisection: the count grows with the value */
        tried[0].i = fitting + (too_large - fitting) / 2;
        if (fits(builtin, tried, bytes))
            fitting = tried[0].i;
        else
            too_large = tried[0].i;
    }
    uint64_t objects = rt_builtin_object_count(builtin, values);
    return rt_fail(error, RT_BAD_INPUT,
                   "scene %s: %s=%lld makes %llu objects, which may take %.1f GB, but only %.1f GB are "
                   "available: %s=%lld would fit",
                   builtin->name, size->name, (long long)values[0].i, (unsigned long long)objects,
                   (double)(objects * bytes_each(builtin, values)) / 1e9, (double)bytes / 1e9, size->name,
                   (long long)fitting);
}

/* A built-in with a value for each of its parameters. */
static RtStatus parse(const char *spec, const RtBuiltin **builtin, RtValue *values, RtError *error) {
    RT_TRY(rt_builtin_named(spec, builtin, error));
    const RtBuiltin *b = *builtin;
    const char *colon = strchr(spec, ':');
    char what[RT_MAX_NAME + 16];
    snprintf(what, sizeof what, "scene %s", b->name);
    return rt_params_parse(b->params, b->param_count, colon ? colon + 1 : NULL, what, values, error);
}

RtStatus rt_builtin_objects(const char *spec, uint64_t *count, RtError *error) {
    const RtBuiltin *builtin;
    RtValue values[RT_MAX_PARAMS];
    RT_TRY(parse(spec, &builtin, values, error));
    *count = rt_builtin_object_count(builtin, values);
    return RT_OK;
}

RtStatus rt_builtin_open(const char *spec, RtScene *scene, RtError *error) {
    *scene = (RtScene){0};
    const RtBuiltin *builtin;
    RtValue values[RT_MAX_PARAMS];
    RT_TRY(parse(spec, &builtin, values, error));
    /* Half of the memory is left for accelerators. */
    RT_TRY(rt_builtin_check_memory(builtin, values, rt_memory_size() / 2, error));

    rt_scene_init(scene);
    int used = snprintf(scene->name, sizeof scene->name, "%s:", builtin->name);
    rt_params_format(builtin->params, builtin->param_count, values, scene->name + used,
                     sizeof scene->name - (size_t)used);
    RtStatus status = rt_build_scene(scene, builtin->generate, values, error);
    if (status != RT_OK) rt_scene_clear(scene);
    return status;
}

/* A spec that is neither a file nor a built-in is rejected with the list of built-ins. */
RtStatus rt_scene_open(const char *spec, RtScene *scene, RtError *error) {
    bool builtin = rt_builtin_find(spec) || !rt_scene_is_file(spec);
    return builtin ? rt_builtin_open(spec, scene, error)
                   : rt_scene_load(spec, rt_builtin_open, NULL, scene, error);
}
