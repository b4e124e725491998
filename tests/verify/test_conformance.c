/* SPDX-License-Identifier: Apache-2.0 */
/* Conformance: every registered accelerator, at every value worth testing of each of its parameters, on every
 * family of scenes, answers every ray of every family like brute, bit for bit (or, where it is not exact,
 * without a wrong verdict); and so it does, over few objects or none, at the least and the greatest value of
 * each number, beside every choice of the other parameters. No accelerator is named here: a new one is
 * covered once it is registered.
 *
 * RT_SEED=N in the environment tries other scenes and rays of the same families (the default is 1), RT_RAYS=N
 * as many rays of each family (the default is 64; AddressSanitizer in ./test.sh --all takes 16). */
#include "equivalence_testing.h"

#include "verify/verify.h"

#include <xxhash.h>

enum { MAX_SCENES = 64 };

static uint64_t seed = 1;
static size_t rays_per_family = 64;

/* What would take too much memory is refused, with a value that fits. */
static const char too_large[] = "would fit";

/* Neither Embree's own nor lists without a mailbox have more than one level. */
static const char nested[] = "instances in instances need";

static void every_accelerator_answers_like_brute(void **state) {
    FamilyBench bench;
    set_up_family(&bench, *(const size_t *)*state, seed, rays_per_family);
    const bool instances = bench.scene.geometry.instance_count > 0;
    size_t failures = 0;
    for (size_t i = 0; i < rt_accel_count(); i++) {
        char spec[RT_MAX_SPEC_CHARS];
        for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++) {
            failures += !conforms(&bench, spec, instances ? nested : NULL);
        }
    }
    tear_down_family(&bench);
    assert_int_equal(failures, 0);
}

/* ---- extreme values ---- */

/* More than this of anything changes nothing over few objects, but the time it takes. They are small and
 * apart, so that even the deepest octree is no large one. */
#define ENOUGH 64

/* The `n`th extreme value of a number or a resolution, to out[0..64); false when there are no more. */
static bool extreme_value(const RtParam *param, size_t n, char *out) {
    double lo = param->lo, hi = param->hi;
    switch (param->type) {
    case RT_PARAM_INT:
    case RT_PARAM_FLOAT: snprintf(out, 64, "%.17g", n ? fmin(hi, ENOUGH) : lo); return n < 2;
    case RT_PARAM_RESOLUTION:
        snprintf(out, 64, "%gx%gx%g", n == 1 ? hi : lo, lo, n == 2 ? hi : lo);
        return n < 3;
    case RT_PARAM_CHOICE:
    case RT_PARAM_FLAG: break;
    }
    return false;
}

/* Parameter `p` at `value`, alone and beside each choice of the others. */
static size_t failures_at(const FamilyBench *bench, const RtAccelOps *ops, size_t p, const char *value) {
    char spec[RT_MAX_SPEC_CHARS], choice[64], below[RT_MAX_NAME + 1] = "";
    if (ops->kinds) snprintf(below, sizeof below, "+%s", rt_accel_default());
    snprintf(spec, sizeof spec, "%s:%s=%s%s", ops->name, ops->params[p].name, value, below);
    size_t failures = !conforms(bench, spec, too_large);
    for (size_t c = 0; c < ops->param_count; c++) {
        const RtParam *other = &ops->params[c];
        if (other->type != RT_PARAM_CHOICE && other->type != RT_PARAM_FLAG) continue;
        for (size_t k = 0; rt_param_try(other, k, choice, sizeof choice); k++) {
            if (strcmp(choice, other->default_text) == 0) continue;
            snprintf(spec, sizeof spec, "%s:%s=%s,%s=%s%s", ops->name, ops->params[p].name, value,
                     other->name, choice, below);
            failures += !conforms(bench, spec, too_large);
        }
    }
    return failures;
}

static void extreme_values_answer_like_brute(void **state) {
    FamilyBench bench;
    char value[64];
    size_t failures = 0;
    assert_ok(rt_builtin_open(*state, &bench.scene, error));
    set_up_rays(&bench, seed, rays_per_family / 16);
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        for (size_t p = 0; p < ops->param_count; p++) {
            for (size_t n = 0; extreme_value(&ops->params[p], n, value); n++) {
                failures += failures_at(&bench, ops, p, value);
            }
        }
    }
    tear_down_family(&bench);
    assert_int_equal(failures, 0);
}

/* ---- memory ---- */

/* Embree allocates by itself and is not under our control. */
static bool allocates_elsewhere(const RtAccelOps *ops) {
    return strcmp(ops->name, "embree") == 0;
}

static void every_allocation_of_a_build_may_fail(void **state) {
    (void)state;
    FamilyBench bench;
    set_up_family(&bench, scene_family("mixed"), seed, 8);
    for (size_t i = 0; i < rt_accel_count(); i++) {
        char spec[RT_MAX_SPEC_CHARS];
        if (allocates_elsewhere(rt_accel_at(i))) continue;
        for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++) {
            int64_t live = rt_alloc_live();
            RtStatus status = RT_NO_MEMORY;
            for (uint64_t nth = 1; status != RT_OK; nth++) {
                RtError error = {RT_OK, ""};
                RtAccel *accel = NULL;
                rt_alloc_fail_at(nth);
                status = rt_accel_open(spec, &bench.scene, &accel, &error);
                rt_alloc_fail_at(0);
                if (status == RT_OK) rt_accel_destroy(accel);
                if (status == RT_NOT_AVAILABLE) {
                    print_message("%s is skipped: %s\n", spec, error.message);
                    break;
                }
                if (status != RT_OK && status != RT_NO_MEMORY) {
                    fail_msg("%s, allocation %llu: status %d, %s", spec, (unsigned long long)nth, status,
                             error.message);
                }
                if (rt_alloc_live() != live) {
                    fail_msg("%s, allocation %llu: %lld blocks leaked", spec, (unsigned long long)nth,
                             (long long)(rt_alloc_live() - live));
                }
            }
        }
    }
    tear_down_family(&bench);
}

/* ---- the rays ---- */

static void every_ray_of_every_family_is_valid_and_repeatable(void **state) {
    (void)state;
    for (size_t s = 0; s < rt_family_count(); s++) {
        FamilyBench bench;
        set_up_family(&bench, s, seed, 64);
        RtQuery query;
        assert_ok(rt_query_init(&query, bench.brute, error));
        for (size_t f = 0; f < rt_ray_family_count(); f++) {
            for (size_t i = 0; i < 64; i++) {
                RtRay again;
                rt_ray_family_fill(f, &query, seed, i, 1, &again);
                assert_true(rt_ray_is_valid(&again));
                assert_memory_equal(&again, &bench.rays[f * 64 + i], sizeof again);
            }
        }
        rt_query_clear(&query);
        tear_down_family(&bench);
    }
}

/* Of an order of evaluation that C leaves open, or of a function of the library, rays would tell here. */
static void rays_of_a_family_are_the_same_by_every_compiler(void **state) {
    (void)state;
    FamilyBench bench;
    set_up_family(&bench, scene_family("mixed"), 1, 64);
    assert_int_equal(XXH3_64bits(bench.rays, bench.reference.count * sizeof(RtRay)),
                     UINT64_C(0x731b7d7628d3a629));
    tear_down_family(&bench);
}

#define extremes_test(scene)                                                                                 \
    { "extreme_values_answer_like_brute on " scene, extreme_values_answer_like_brute, NULL, NULL, scene }

enum { FIXED_TESTS = 9 };

RT_TEST_GROUP(conformance) {
    static size_t families[MAX_SCENES];
    static char names[MAX_SCENES][128];
    struct CMUnitTest tests[MAX_SCENES + FIXED_TESTS] = {
        cmocka_unit_test(every_ray_of_every_family_is_valid_and_repeatable),
        cmocka_unit_test(rays_of_a_family_are_the_same_by_every_compiler),
        cmocka_unit_test(every_allocation_of_a_build_may_fail),
        extremes_test("random:n=0"),
        extremes_test("random:n=1"),
        extremes_test("random:n=2,shape=mixed"),
        extremes_test("random:n=40,shape=mixed,radius=0.02"),
        extremes_test("random:n=40,distribution=coincident"),
        extremes_test("random:n=40,shape=mixed,distribution=stadium,radius=0.02"),
    };
    size_t count = FIXED_TESTS;
    const char *other_seed = getenv("RT_SEED"), *other_rays = getenv("RT_RAYS");
    if (other_seed) seed = strtoull(other_seed, NULL, 10);
    if (other_rays) rays_per_family = strtoull(other_rays, NULL, 10);
    if (rays_per_family < 16) return EXIT_FAILURE;
    if (rt_family_count() > MAX_SCENES) return EXIT_FAILURE;
    for (size_t i = 0; i < rt_family_count(); i++) {
        families[i] = i;
        snprintf(names[i], sizeof names[i], "every_accelerator_answers_like_brute on %s", rt_family_name(i));
        tests[count++] =
            (struct CMUnitTest){names[i], every_accelerator_answers_like_brute, NULL, NULL, &families[i]};
    }
    return _cmocka_run_group_tests("conformance", tests, count, NULL, NULL);
}
