/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of accelerators: structures that clear themselves, scenes, rays to lights, validation. */
#ifndef RT_TESTS_ACCEL_TESTING_H
#define RT_TESTS_ACCEL_TESTING_H

#include "scene_testing.h"

#include "accel/accel.h"

#define OWNED_QUERY OWNED(rt_query_clear) RtQuery
#define OWNED_ACCEL OWNED(destroy_owned)

/* pointer: to any struct that begins with an RtAccel. */
static inline void destroy_owned(void *pointer) {
    rt_accel_destroy(*(RtAccel **)pointer);
}

/* Builds a spec; the struct of the topmost layer. */
static inline void *open_accel(const RtScene *scene, const char *spec) {
    RtAccel *accel;
    assert_ok(rt_accel_open(spec, scene, &accel, error));
    return accel;
}

/* The same; NULL if this machine or this build cannot build it. */
static inline void *open_available(const RtScene *scene, const char *spec, int threads) {
    RtAccel *accel = NULL;
    RtError problem;
    RtStatus status = rt_accel_open_on(spec, scene, threads, &accel, &problem);
    if (status != RT_OK && status != RT_NOT_AVAILABLE)
        fail_msg("%s on %d threads: %s", spec, threads, problem.message);
    return accel;
}

/* The same, and asserts that the structure is valid. */
static inline void *open_valid(const RtScene *scene, const char *spec) {
    RtAccel *accel = open_accel(scene, spec);
    assert_ok(rt_accel_validate(accel, error));
    return accel;
}

static inline RtQuery open_query(const RtAccel *accel) {
    RtQuery query;
    assert_ok(rt_query_init(&query, accel, error));
    return query;
}

static inline RtDescription describe_spec(const RtScene *scene, const char *spec) {
    OWNED_ACCEL RtAccel *accel = open_valid(scene, spec);
    RtDescription description;
    rt_accel_describe(accel, &description);
    return description;
}

/* Builds and validates it, and allocates for rays; leaves nothing behind. */
static inline RtStatus try_accel(const RtScene *scene, const char *spec, RtError *error) {
    OWNED_ACCEL RtAccel *accel;
    RtQuery query;
    RT_TRY(rt_accel_open(spec, scene, &accel, error));
    RtStatus status = rt_accel_validate(accel, error);
    if (status == RT_OK) status = rt_query_init(&query, accel, error);
    if (status == RT_OK) rt_query_clear(&query);
    return status;
}

/* Asserts that validate of this layer refuses it with a message that contains `phrase`. */
static inline void assert_broken(const RtAccel *accel, const char *phrase) {
    assert_fails_with(accel->ops->validate(accel, error), RT_MISMATCH, phrase);
}

/* The same while `member` of its structure is `wrong`. */
#define assert_broken_by(accel, member, wrong, phrase)                                                       \
    do {                                                                                                     \
        __typeof__(member) rt_right = (member);                                                              \
        (member) = (wrong);                                                                                  \
        assert_broken(accel, phrase);                                                                        \
        (member) = rt_right;                                                                                 \
    } while (0)

/* Every counter is as by hand. */
static inline void assert_tally(const char *what, const RtTally *got, const RtTally *by_hand) {
    for (size_t c = 0; c < RT_TALLY_COUNTER_COUNT; c++) {
        if (rt_tally_get(got, c) == rt_tally_get(by_hand, c)) continue;
        fail_msg("%s: %s is %llu, by hand %llu", what, rt_tally_name(c),
                 (unsigned long long)rt_tally_get(got, c), (unsigned long long)rt_tally_get(by_hand, c));
    }
}

/* Builds one layer, which is refused above `limit` bytes. */
static inline RtStatus build_within(const char *name, uint64_t limit, const RtScene *scene,
                                    const RtValue *values, RtAccel **out, RtError *problem) {
    const RtAccelOps *ops;
    assert_ok(rt_accel_find(name, &ops, error));
    return rt_accel_build_layer(ops, &(RtBuild){scene, values, 1, limit, NULL}, NULL, out, problem);
}

/* Asserts that such a build is refused and leaves nothing behind. Returns the bytes that it would take;
 * *depth is the max_depth that would fit. */
static inline double refused_bytes(const char *name, uint64_t limit, const RtScene *scene,
                                   const RtValue *values, long *depth) {
    RtAccel *accel = NULL;
    RtError refusal = {RT_OK, ""};
    double gib;
    int64_t live = rt_alloc_live();
    assert_int_equal(build_within(name, limit, scene, values, &accel, &refusal), RT_BAD_INPUT);
    assert_int_equal(rt_alloc_live(), live);
    const char *about = strstr(refusal.message, "about "), *remedy = strstr(refusal.message, ": max_depth=");
    assert_true(about && remedy);
    assert_int_equal(sscanf(about, "about %lf GiB", &gib), 1);
    assert_int_equal(sscanf(remedy, ": max_depth=%ld", depth), 1);
    return gib * 0x1p30;
}

/* Whether it fits with this depth; *max_depth is one of the values. */
static inline bool fits_within(const char *name, uint64_t limit, const RtScene *scene, const RtValue *values,
                               RtValue *max_depth, long depth) {
    OWNED_ACCEL RtAccel *accel = NULL;
    RtError refusal;
    max_depth->i = depth;
    return build_within(name, limit, scene, values, &accel, &refusal) == RT_OK;
}

/* Unit cubes' worth of spheres of radius 1/2 on an nx x ny x nz lattice of spacing 1. */
static inline RtScene make_lattice(int nx, int ny, int nz) {
    RtScene scene = begin_scene();
    for (int x = 0; x < nx; x++) {
        for (int y = 0; y < ny; y++) {
            for (int z = 0; z < nz; z++) {
                RtVec3 center = {{(float)x, (float)y, (float)z}};
                assert_ok(rt_scene_add_sphere(&scene, 0, center, 0.5f, error));
            }
        }
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* `count` unit spheres in a row along x, `apart` from centre to centre. */
static inline RtScene make_row(uint32_t count, float apart) {
    RtScene scene = begin_scene();
    for (uint32_t i = 0; i < count; i++)
        assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(apart * (float)i, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* Two unit-diameter spheres, 0 about (0.5, 0.5, 0.5) and 1 about (3.5, 0.5, 0.5); not finished. */
static inline RtScene begin_two_spheres(void) {
    RtScene scene = begin_scene();
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0.5f, 0.5f, 0.5f), 0.5f, error));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(3.5f, 0.5f, 0.5f), 0.5f, error));
    return scene;
}

/* From a point to a light of the scene, as shading sends it. */
static inline RtRay shadow_ray(const RtScene *scene, RtVec3 from, uint32_t light) {
    return (RtRay){.org = from,
                   .dir = rt_sub(scene->lights[light].position, from),
                   .tmax = 1,
                   .kind = RT_RAY_SHADOW,
                   .source = light};
}

#endif
