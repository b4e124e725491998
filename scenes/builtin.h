/* SPDX-License-Identifier: Apache-2.0 */
/* Built-in scenes: generators, listed in scenes/builtin.c. */
#ifndef RT_SCENES_BUILTIN_H
#define RT_SCENES_BUILTIN_H

#include "scenes/build.h"

/* Memory that an object may take while a scene is built, including arrays that grow by doubling: a sphere,
 * a cone, a triangle or a polygon of four corners; and a triangle, where few have vertex normals. */
#define RT_BUILTIN_OBJECT_BYTES   256
#define RT_BUILTIN_TRIANGLE_BYTES 96

/* The parameter `seed` of random scenes. */
#define RT_BUILTIN_SEED "seed", RT_INT("1", 0, 1e15, "1"), "seed of the random numbers", "any"

/* The parameter `instances` of scenes that repeat themselves, and `parts`, how many different parts are made.
 */
#define RT_BUILTIN_INSTANCES                                                                                 \
    "instances", RT_CHOICE("off", "off|on|flattened"),                                                       \
        "on: a few parts, placed many times; flattened: the same scene with copies in their place",          \
        "the scene without repetition"
#define RT_BUILTIN_PARTS(what)                                                                               \
    "parts", RT_INT("8", 1, RT_MAX_BUILT_PARTS, "1|8"), "different " what ", unless instances=off",          \
        "enough to hide the repetition"

#define RT_SPD_SOURCE "SPD: E. Haines 1987, A Proposal for Standard Graphics Environments, IEEE CG&A 7(11)"

typedef struct RtBuiltin {
    const char *name, *summary, *source; /* source: the origin of the scene */
    const RtParam *params;               /* params[0]: the integer that sets the size, if there is one */
    size_t param_count;
    /* The number of objects, to check memory before anything is built, where there may be so many that
     * counting takes long; NULL: `generate` counts. */
    uint64_t (*object_count)(const RtValue *values);
    /* Bytes that each may take while the scene is built: where they depend on the values, or else the number
     * below; 0: RT_BUILTIN_OBJECT_BYTES. */
    uint64_t (*object_bytes)(const RtValue *values);
    uint64_t bytes_each;
    RtSceneGenerator *generate;
} RtBuiltin;

extern const RtBuiltin rt_builtin_balls, rt_builtin_city, rt_builtin_csg_field, rt_builtin_family,
    rt_builtin_forest, rt_builtin_gears, rt_builtin_hall, rt_builtin_jacks, rt_builtin_lattice,
    rt_builtin_mount, rt_builtin_random, rt_builtin_rings, rt_builtin_shells, rt_builtin_stadium,
    rt_builtin_teapot, rt_builtin_tetra, rt_builtin_thicket, rt_builtin_tree;

/* Scene `i` in the order of listing; NULL after the last. */
const RtBuiltin *rt_builtin_at(size_t i);

/* Finds the scene named by `spec` up to a colon; NULL if there is none. */
const RtBuiltin *rt_builtin_find(const char *spec);

/* The same, with an error that lists the scenes if the name is unknown. */
RtStatus rt_builtin_named(const char *spec, const RtBuiltin **builtin, RtError *error);

/* Opens "name[:key=value,...]" as a finished scene, named by the spec with all parameters. On failure
 * *scene is empty. A scene that does not fit into this machine's memory is rejected, with the size that
 * would fit. */
RtStatus rt_builtin_open(const char *spec, RtScene *scene, RtError *error);

/* The number of objects of such a spec, at least nearly, without building it. */
RtStatus rt_builtin_objects(const char *spec, uint64_t *count, RtError *error);

/* The number of objects for these values, those of a part once. */
uint64_t rt_builtin_object_count(const RtBuiltin *builtin, const RtValue *values);

/* Rejects values whose scene may need more than `bytes`, with the value of params[0] that would fit. */
RtStatus rt_builtin_check_memory(const RtBuiltin *builtin, const RtValue *values, uint64_t bytes,
                                 RtError *error);

/* Families of scenes that are hard on accelerators: objects that coincide, are flat, huge, tiny or far
 * away, slivers, shared edges, trees. Each is the built-in scene "family:kind=NAME,seed=N"; these
 * functions enumerate them. */
size_t rt_family_count(void);
const char *rt_family_name(size_t family);

/* The spec of scene number `seed` of a family, for rt_scene_open. */
void rt_family_spec(size_t family, uint64_t seed, char spec[RT_MAX_SPEC_CHARS]);

#endif
