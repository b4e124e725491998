/* SPDX-License-Identifier: Apache-2.0 */
/* A test of the test: accelerators with a known pitfall are caught by the rays and scenes of `verify`
 * within a bounded number of rays, and their first failure shrinks to a few objects; the same code without
 * the fault is not caught. */
#include "equivalence_testing.h"
#include "mutants.h"

#include "verify/failure.h"

enum { RAYS_PER_FAMILY = 256, MOST_RAYS = 400000, MOST_OBJECTS_LEFT = 3 };

static const char *const names[] = {
#define MUTANT_NAME(CONSTANT, name, what) name,
    MUTANTS(MUTANT_NAME)
#undef MUTANT_NAME
};

static const char *spec_of(MutantKind kind, bool broken) {
    static char spec[RT_MAX_SPEC_CHARS];
    snprintf(spec, sizeof spec, "mutant:kind=%s,broken=%s", names[kind], broken ? "on" : "off");
    return spec;
}

static RtEquivalence check(const FamilyBench *bench, const char *spec) {
    RtEquivalence result;
    OWNED_ACCEL RtAccel *accel = open_accel(&bench->scene, spec);
    assert_ok(rt_equivalence_check(&bench->reference, accel, 0, &result, error));
    return result;
}

/* Not over parts in parts: a mutant tests an object once in every voxel, so that takes exponential time. */
static RtEquivalence check_unless_nested(const FamilyBench *bench, const char *spec) {
    return bench->scene.geometry.nesting > 0 ? (RtEquivalence){0} : check(bench, spec);
}

/* The failure shrinks to a few objects, of which none can be spared. */
static void shrink(const FamilyBench *bench, const char *spec, const RtWrongAnswer *wrong) {
    RtFailure failure;
    RtAnswer answer;
    RtShrunk shrunk;
    char says[512];
    assert_ok(rt_failure_of(&bench->reference, wrong, spec, 0, &failure, &answer, error));
    assert_true(answer.wrong);
    assert_int_equal(failure.count, 1);
    assert_ok(rt_shrink(&bench->scene, &failure, &answer, RT_SHRINK_BUDGET, NULL, NULL, &shrunk, error));
    rt_wrong_answer_format(wrong, says, sizeof says);
    print_message("%s: scene %s with %u objects, rays %s, %u objects left after %u tries: %s\n", spec,
                  bench->scene.name, bench->scene.geometry.object_count,
                  rt_ray_family_name(wrong->index / RAYS_PER_FAMILY), shrunk.count, shrunk.tries, says);
    assert_true(shrunk.minimal && shrunk.answer.wrong);
    assert_in_range(shrunk.count, 1, MOST_OBJECTS_LEFT);
    rt_free(shrunk.ids);
}

static void a_mutant_is_caught_and_its_failure_shrinks(void **state) {
    const char *spec = spec_of(*(const MutantKind *)*state, true);
    uint64_t rays = 0;
    for (size_t scene = 0; scene < rt_family_count() && rays < MOST_RAYS; scene++) {
        FamilyBench bench;
        set_up_family(&bench, scene, 1, RAYS_PER_FAMILY);
        RtEquivalence result = check_unless_nested(&bench, spec);
        /* One that fails where there is little to fail on would be no example. */
        bool caught = result.any_wrong && bench.scene.geometry.object_count > MOST_OBJECTS_LEFT;
        if (caught) shrink(&bench, spec, &result.first_wrong);
        rays += result.rays;
        tear_down_family(&bench);
        if (caught) return;
    }
    fail_msg("%s is not caught by %llu rays", spec, (unsigned long long)rays);
}

static void its_control_is_not_caught(void **state) {
    const char *spec = spec_of(*(const MutantKind *)*state, false);
    for (size_t scene = 0; scene < rt_family_count(); scene++) {
        FamilyBench bench;
        set_up_family(&bench, scene, 1, RAYS_PER_FAMILY);
        RtEquivalence result = check_unless_nested(&bench, spec);
        tear_down_family(&bench);
        if (!result.any_wrong) continue;
        char says[512];
        rt_wrong_answer_format(&result.first_wrong, says, sizeof says);
        fail_msg("%s fails on %s: %s", spec, rt_family_name(scene), says);
    }
}

/* Without a budget nothing is left out, and with a little of it no more than that allows. */
static void shrinking_ends_with_its_budget(void **state) {
    (void)state;
    const char *spec = spec_of(EARLY_EXIT, true);
    FamilyBench bench;
    set_up_family(&bench, scene_family("line"), 1, RAYS_PER_FAMILY);
    RtEquivalence result = check(&bench, spec);
    RtFailure failure;
    RtAnswer answer;
    assert_ok(rt_failure_of(&bench.reference, &result.first_wrong, spec, 0, &failure, &answer, error));
    assert_true(answer.wrong);
    for (uint64_t budget = 0; budget <= 2000; budget += 400) {
        RtShrunk shrunk;
        assert_ok(rt_shrink(&bench.scene, &failure, &answer, budget, NULL, NULL, &shrunk, error));
        assert_false(shrunk.minimal);
        assert_true(shrunk.answer.wrong && shrunk.tries <= budget / 32);
        if (budget == 0) assert_int_equal(shrunk.count, bench.scene.geometry.object_count);
        for (uint32_t i = 1; i < shrunk.count; i++) assert_true(shrunk.ids[i - 1] < shrunk.ids[i]);
        rt_free(shrunk.ids);
    }
    tear_down_family(&bench);
}

static int register_mutants(void **state) {
    (void)state;
    assert_ok(rt_accel_register(&mutant_ops, error));
    return 0;
}

RT_TEST_GROUP(mutants) {
    static MutantKind kinds[MUTANT_COUNT];
    static char titles[2 * MUTANT_COUNT][128];
    struct CMUnitTest tests[2 * MUTANT_COUNT + 1] = {[2 * MUTANT_COUNT] =
                                                         cmocka_unit_test(shrinking_ends_with_its_budget)};
    for (size_t i = 0; i < MUTANT_COUNT; i++) {
        kinds[i] = (MutantKind)i;
        snprintf(titles[2 * i], sizeof titles[0], "a_mutant_is_caught_and_its_failure_shrinks: %s", names[i]);
        snprintf(titles[2 * i + 1], sizeof titles[0], "its_control_is_not_caught: %s", names[i]);
        tests[2 * i] = (struct CMUnitTest){titles[2 * i], a_mutant_is_caught_and_its_failure_shrinks, NULL,
                                           NULL, &kinds[i]};
        tests[2 * i + 1] =
            (struct CMUnitTest){titles[2 * i + 1], its_control_is_not_caught, NULL, NULL, &kinds[i]};
    }
    return _cmocka_run_group_tests("mutants", tests, 2 * MUTANT_COUNT + 1, register_mutants, NULL);
}
