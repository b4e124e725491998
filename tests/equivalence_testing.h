/* SPDX-License-Identifier: Apache-2.0 */
/* Compares accelerators with brute on rays of every family, over a scene of a family or any other; both
 * kernels, in streams of several lengths. */
#ifndef RT_TESTS_EQUIVALENCE_TESTING_H
#define RT_TESTS_EQUIVALENCE_TESTING_H

#include "accel_testing.h"

#include "scenes/builtin.h"
#include "verify/equivalence.h"
#include "verify/verify_rays.h"

/* The number of the family of scenes that is called so. */
static inline size_t scene_family(const char *name) {
    size_t family = 0;
    while (strcmp(rt_family_name(family), name) != 0) assert_true(++family < rt_family_count());
    return family;
}

/* Scene number `seed` of a family. */
static inline RtScene open_family(size_t family, uint64_t seed) {
    char spec[RT_MAX_SPEC_CHARS];
    rt_family_spec(family, seed, spec);
    return open_scene(spec);
}

typedef struct FamilyBench {
    RtScene scene;
    RtAccel *brute;
    RtRay *rays;
    RtReference reference;
} FamilyBench;

/* `rays` of each family of rays, over the scene that is there. */
static inline void set_up_rays(FamilyBench *bench, uint64_t seed, size_t rays) {
    size_t families = rt_ray_family_count();
    bench->brute = open_accel(&bench->scene, "brute");
    OWNED_QUERY query = open_query(bench->brute);
    bench->rays = rt_alloc(families * rays, sizeof(RtRay));
    assert_non_null(bench->rays);
    for (size_t f = 0; f < families; f++) {
        rt_ray_family_fill(f, &query, seed, 0, rays, bench->rays + f * rays);
    }
    assert_ok(rt_reference_init(&bench->reference, bench->brute, bench->rays, families * rays, 0, error));
}

/* The same over a scene of a family. */
static inline void set_up_family(FamilyBench *bench, size_t scene_family, uint64_t seed, size_t rays) {
    bench->scene = open_family(scene_family, seed);
    set_up_rays(bench, seed, rays);
}

static inline void tear_down_family(FamilyBench *bench) {
    rt_reference_clear(&bench->reference);
    rt_free(bench->rays);
    rt_accel_destroy(bench->brute);
    rt_scene_clear(&bench->scene);
}

#define OWNED_BENCH OWNED(tear_down_family) FamilyBench

/* Asserts that the accelerator of this spec is valid and returns the answers of the reference, bit for
 * bit. */
static inline void assert_gives(const RtReference *reference, const char *spec) {
    RtEquivalence result = {0};
    OWNED_ACCEL RtAccel *accel = open_valid(reference->scene, spec);
    assert_ok(rt_equivalence_check(reference, accel, 0, &result, error));
    if (result.any_wrong) {
        char text[512];
        rt_wrong_answer_format(&result.first_wrong, text, sizeof text);
        fail_msg("%s on %s: %s", spec, reference->scene->name, text);
    }
}

/* Checks one spec; tells what is wrong and returns false if anything is. What is refused with this phrase,
 * unless it is NULL, conforms. */
static inline bool conforms(const FamilyBench *bench, const char *spec, const char *may_refuse) {
    RtError error = {RT_OK, ""};
    OWNED_ACCEL RtAccel *accel;
    const char *scene = bench->scene.name;
    RtStatus status = rt_accel_open(spec, &bench->scene, &accel, &error);
    if (status == RT_NOT_AVAILABLE) {
        print_message("%s on %s is skipped: %s\n", spec, scene, error.message);
        return true;
    }
    if (status == RT_BAD_INPUT && may_refuse && strstr(error.message, may_refuse)) return true;
    if (status != RT_OK) {
        print_error("%s on %s cannot be built: %s\n", spec, scene, error.message);
        return false;
    }
    RtEquivalence result = {0};
    bool good = true;
    if (rt_accel_validate(accel, &error) != RT_OK) {
        print_error("%s on %s is not valid: %s\n", spec, scene, error.message);
        good = false;
    }
    /* Other arithmetic in instances takes long to judge: tests/verify/test_instances_judged.c. */
    if (!accel->exact && bench->scene.geometry.instance_count > 0) return good;
    if (rt_equivalence_check(&bench->reference, accel, 0, &result, &error) != RT_OK) {
        print_error("%s on %s cannot be checked: %s\n", spec, scene, error.message);
        good = false;
    }
    if (result.any_wrong && accel->exact) { /* others have faults: tests/check_verdicts.sh */
        char text[512];
        size_t each_family = bench->reference.count / rt_ray_family_count();
        rt_wrong_answer_format(&result.first_wrong, text, sizeof text);
        print_error("%s on %s: %llu of %llu wrong, %llu occluded wrong; family %s, %s\n", spec, scene,
                    (unsigned long long)result.verdicts[RT_WRONG], (unsigned long long)result.rays,
                    (unsigned long long)result.occluded_wrong,
                    rt_ray_family_name(result.first_wrong.index / each_family), text);
        good = false;
    }
    return good;
}

#endif
