/* Holding accelerators against brute on a family of scenes, by rays of every family: for what the spread of
 * the conformance test leaves out, parameters together. */
#ifndef RT_TESTS_EQUIVALENCE_TESTING_H
#define RT_TESTS_EQUIVALENCE_TESTING_H

#include "testing.h"

#include "accel/accel.h"
#include "base/memory.h"
#include "experiments/equivalence.h"
#include "experiments/families.h"

typedef struct FamilyBench {
    RtScene scene;
    RtAccel *brute;
    RtRay *rays;
    RtReference reference;
} FamilyBench;

/* `rays` of each family of rays. */
static inline void set_up_family(FamilyBench *bench, size_t scene_family, uint64_t seed, size_t rays) {
    RtQuery query;
    size_t families = rt_ray_family_count();
    assert_ok(rt_scene_family_build(scene_family, seed, &bench->scene, error));
    assert_ok(rt_accel_open("brute", &bench->scene, &bench->brute, error));
    assert_ok(rt_query_init(&query, bench->brute, error));
    bench->rays = rt_alloc(families * rays, sizeof(RtRay));
    assert_non_null(bench->rays);
    for (size_t f = 0; f < families; f++) {
        rt_ray_family_fill(f, &query, seed, 0, rays, bench->rays + f * rays);
    }
    rt_query_clear(&query);
    assert_ok(rt_reference_init(&bench->reference, bench->brute, bench->rays, families * rays, 0, error));
}

static inline void tear_down_family(FamilyBench *bench) {
    rt_reference_clear(&bench->reference);
    rt_free(bench->rays);
    rt_accel_destroy(bench->brute);
    rt_scene_clear(&bench->scene);
}

/* An accelerator of this spec is valid and answers like brute, bit for bit. */
static inline void assert_answers_like_brute(const FamilyBench *bench, const char *spec) {
    RtAccel *accel;
    RtEquivalence result = {0};
    assert_ok(rt_accel_open(spec, &bench->scene, &accel, error));
    assert_ok(rt_accel_validate(accel, error));
    assert_ok(rt_equivalence_check(&bench->reference, accel, 0, &result, error));
    if (result.any_wrong) fail_msg("%s is wrong on %s", spec, bench->scene.name);
    rt_accel_destroy(accel);
}

#endif
