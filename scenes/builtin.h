/* SPDX-License-Identifier: Apache-2.0 */
/* Built-in scenes: one generator a file, listed in scenes/builtin.c. */
#ifndef RT_SCENES_BUILTIN_H
#define RT_SCENES_BUILTIN_H

#include "scenes/build.h"

/* What an object may take while a scene is made, arrays that grow by doubling included: a sphere, a cone, a
 * triangle or a polygon of four corners. */
#define RT_BUILTIN_OBJECT_BYTES 256

/* The parameter `seed` of scenes that are made from random numbers. */
#define RT_BUILTIN_SEED "seed", RT_INT("1", 0, 1e15, "1"), "of the random numbers", "any"

typedef struct RtBuiltin {
    const char *name, *summary, *source; /* source: where the scene comes from */
    const RtParam *params;               /* params[0]: the whole number that sets the size, where one does */
    size_t param_count;
    /* The number of objects, to check against memory before anything is made; NULL: `generate` counts. */
    uint64_t (*object_count)(const RtValue *values);
    /* Bytes that each of them may take while the scene is made; NULL: RT_BUILTIN_OBJECT_BYTES. */
    uint64_t (*object_bytes)(const RtValue *values);
    RtSceneGenerator *generate;
} RtBuiltin;

/* Each in its own file. */
extern const RtBuiltin rt_builtin_balls, rt_builtin_city, rt_builtin_csg_field, rt_builtin_family,
    rt_builtin_forest, rt_builtin_gears, rt_builtin_hall, rt_builtin_jacks, rt_builtin_lattice,
    rt_builtin_mount, rt_builtin_random, rt_builtin_rings, rt_builtin_shells, rt_builtin_stadium,
    rt_builtin_teapot, rt_builtin_tetra, rt_builtin_tree;

size_t rt_builtin_count(void);
const RtBuiltin *rt_builtin_at(size_t i);

/* By the name that `spec` begins with, up to its end or a colon; NULL if there is none. */
const RtBuiltin *rt_builtin_find(const char *spec);

/* The same to *builtin; an unknown one is refused with the list of those there are. */
RtStatus rt_builtin_named(const char *spec, const RtBuiltin **builtin, RtError *error);

/* "name[:key=value,...]" to a finished scene, whose name is the spec with every parameter. On failure *scene
 * is empty. A scene for which this machine has not the memory is refused, with the size that would fit. */
RtStatus rt_builtin_open(const char *spec, RtScene *scene, RtError *error);

/* How many objects the scene of such a spec has, or nearly so, without making it. */
RtStatus rt_builtin_objects(const char *spec, uint64_t *count, RtError *error);

/* The number of objects for these values. */
uint64_t rt_builtin_object_count(const RtBuiltin *builtin, const RtValue *values);

/* What the scene may take while it is made. */
uint64_t rt_builtin_bytes(const RtBuiltin *builtin, const RtValue *values);

/* Refuses values whose scene may need more than `bytes`, with the value of params[0] that would fit. */
RtStatus rt_builtin_check_memory(const RtBuiltin *builtin, const RtValue *values, uint64_t bytes,
                                 RtError *error);

#endif
