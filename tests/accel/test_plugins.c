/* SPDX-License-Identifier: Apache-2.0 */
/* Accelerators of plugins, which live in processes of their own: they answer, count and show what they would
 * here, and of one that breaks nobody else takes harm. What commands make of them is in
 * tests/check_plugins.sh. */
#include "accel_testing.h"
#include "equivalence_testing.h"

#include "accel/plugin.h"
#include "accel/remote.h"
#include "core/base/clock.h"
#include "measure/measure.h"

#include <errno.h>
#include <float.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>

#define PLUGINS RT_BINARY_DIR "/plugins/"

static void load_all(void) {
    setenv("RAYTALLY_PLUGIN_SECONDS", "2", 1);
    assert_ok(rt_plugin_load_all(PLUGINS "new-accel.so:" PLUGINS "bvh_copy.so:" PLUGINS "faulty.so", error));
}

static void open_random(RtScene *scene) {
    load_all();
    assert_ok(rt_scene_open("random:n=300,shape=mixed", scene, error));
}

/* Random chords of a scene. */
static void open_chords(const RtScene *scene, uint64_t count, RtRaySet *set, RtAccel **bvh) {
    RtQuery query;
    assert_ok(rt_accel_open("bvh", scene, bvh, error));
    assert_ok(rt_query_init(&query, *bvh, error));
    assert_ok(rt_rayset_init(set, RT_RAY_RANDOM, count, error));
    rt_ray_family_fill(0, &query, 1, 0, count, set->rays);
    for (uint64_t i = 0; i < count; i++) set->rays[i].kind = RT_RAY_RANDOM;
    rt_query_clear(&query);
}

RT_TEST(one_that_is_loaded_twice_is_there_once) {
    load_all();
    size_t plugins = rt_plugin_count(), accelerators = rt_accel_count();
    load_all();
    assert_int_equal(rt_plugin_count(), plugins);
    assert_int_equal(rt_accel_count(), accelerators);
}

RT_TEST(answers_are_those_of_brute_in_streams_of_every_length_on_several_threads) {
    static const char *const specs[] = {"my-accel", "my-accel:boxes=off", "bvh_copy", "cache+bvh_copy"};
    FamilyBench bench;
    load_all();
    open_family(scene_family("slivers"), 3, &bench.scene);
    set_up_rays(&bench, 5, 300);
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        RtAccel *accel;
        RtEquivalence result;
        assert_ok(rt_accel_open(specs[i], &bench.scene, &accel, error));
        assert_true(rt_accel_is_remote(accel));
        assert_ok(rt_accel_validate(accel, error));
        assert_ok(rt_equivalence_check(&bench.reference, accel, 3, &result, error));
        assert_int_equal(result.verdicts[RT_EQUAL], result.rays);
        rt_accel_destroy(accel);
    }
    tear_down_family(&bench);
}

RT_TEST(counts_are_the_same_on_any_number_of_threads) {
    RtScene scene;
    RtRaySet set;
    RtAccel *bvh, *copy;
    open_random(&scene);
    open_chords(&scene, 20000, &set, &bvh);
    assert_ok(rt_accel_open("bvh_copy", &scene, &copy, error));
    RtHit *expected = rt_alloc(set.count, sizeof(RtHit));
    RtCount once, again;
    assert_ok(rt_measure_answers(bvh, &set, 2, expected, error));
    assert_ok(rt_measure_count(copy, &set, expected, 1, &once, error));
    assert_ok(rt_measure_count(copy, &set, expected, 3, &again, error));
    assert_int_equal(once.differ, 0);
    assert_memory_equal(&once, &again, offsetof(RtCount, seconds));
    assert_int_equal(once.tally.rays, set.count);
    assert_true(once.tally.object_tests > 0 && once.tally.steps > 0);
    rt_free(expected);
    rt_accel_destroy(copy);
    rt_accel_destroy(bvh);
    rt_rayset_clear(&set);
    rt_scene_clear(&scene);
}

static void count_box(void *context, const RtBoxView *view) {
    uint64_t *boxes = context;
    boxes[view->leaf]++;
    assert_true(view->box->lo.x <= view->box->hi.x);
}

RT_TEST(its_boxes_are_those_that_it_describes) {
    RtScene scene;
    RtAccel *copy;
    RtDescription shape;
    uint64_t boxes[2] = {0, 0};
    load_all();
    assert_ok(rt_scene_open("random:n=9000", &scene, error)); /* more boxes than a message holds */
    assert_ok(rt_accel_open("bvh_copy", &scene, &copy, error));
    rt_accel_describe(copy, &shape);
    copy->ops->each_box(copy, (RtBoxViewer){count_box, boxes});
    assert_int_equal(boxes[0], shape.interior);
    assert_int_equal(boxes[1], shape.leaves);
    rt_accel_destroy(copy);
    rt_scene_clear(&scene);
}

RT_TEST(one_that_breaks_among_those_timed_is_left_out_and_the_others_are_timed) {
    RtScene scene;
    RtRaySet set;
    RtAccel *bvh, *faulty;
    double seconds[2][3], wall[2][3];
    bool broken[2] = {false, false};
    uint32_t done = 0;
    open_random(&scene);
    open_chords(&scene, 500, &set, &bvh);
    assert_ok(rt_accel_open("faulty-crash-timed", &scene, &faulty, error));
    RtTimed timed[2] = {{faulty, &set, seconds[0], wall[0], &broken[0]},
                        {bvh, &set, seconds[1], wall[1], &broken[1]}};
    RtTiming timing = {.rounds = {.rounds = 3, .most = 3, .seed = 1}, .threads = 1};
    assert_ok(rt_measure_time(timed, 2, &timing, &done, error));
    assert_int_equal(done, 3);
    assert_true(broken[0] && !broken[1]);
    RtError why;
    assert_int_equal(rt_accel_check(faulty, &why), RT_BROKEN);
    assert_non_null(strstr(why.message, "faulty-crash-timed: it crashed (Segmentation fault)"));
    for (int i = 0; i < 3; i++) assert_true(seconds[1][i] > 0);
    rt_accel_destroy(faulty);
    rt_accel_destroy(bvh);
    rt_rayset_clear(&set);
    rt_scene_clear(&scene);
}

RT_TEST(one_that_broke_before_it_is_timed_is_left_out) {
    RtScene scene;
    RtRaySet set;
    RtAccel *bvh, *faulty;
    RtQuery query;
    RtHit hit;
    double seconds[2][2], wall[2][2];
    bool broken[2] = {false, false};
    uint32_t done = 0;
    open_random(&scene);
    open_chords(&scene, 100, &set, &bvh);
    assert_ok(rt_accel_open("faulty-killed", &scene, &faulty, error));
    assert_ok(rt_query_init(&query, faulty, error));
    rt_nearest(&query, set.rays, 1, &hit, NULL);
    rt_query_clear(&query);
    RtTimed timed[2] = {{faulty, &set, seconds[0], wall[0], &broken[0]},
                        {bvh, &set, seconds[1], wall[1], &broken[1]}};
    RtTiming timing = {.rounds = {.rounds = 2, .most = 2, .seed = 1}, .threads = 1};
    assert_ok(rt_measure_time(timed, 2, &timing, &done, error));
    assert_int_equal(done, 2);
    assert_true(broken[0] && !broken[1]);
    rt_accel_destroy(faulty);
    rt_accel_destroy(bvh);
    rt_rayset_clear(&set);
    rt_scene_clear(&scene);
}

RT_TEST(one_that_breaks_as_it_is_asked_ray_by_ray_has_no_rows) {
    RtScene scene;
    RtRaySet set;
    RtAccel *bvh, *faulty;
    RtRows rows;
    open_random(&scene);
    open_chords(&scene, 100, &set, &bvh);
    assert_ok(rt_accel_open("faulty-crash-alone", &scene, &faulty, error));
    assert_int_equal(rt_measure_rows(faulty, &set, 1, &rows, NULL), RT_BROKEN);
    rt_rows_clear(&rows);
    rt_accel_destroy(faulty);
    rt_accel_destroy(bvh);
    rt_rayset_clear(&set);
    rt_scene_clear(&scene);
}

RT_TEST(one_that_writes_to_shared_memory_harms_nobody_else) {
    RtScene scene;
    RtRaySet set;
    RtAccel *bvh, *copy, *faulty;
    RtHit expected[100];
    RtCount count;
    RtError why;
    open_random(&scene);
    open_chords(&scene, 100, &set, &bvh);
    assert_ok(rt_measure_answers(bvh, &set, 1, expected, error));
    assert_ok(rt_accel_open("bvh_copy", &scene, &copy, error));
    assert_int_equal(rt_accel_open("faulty-scribble", &scene, &faulty, &why), RT_BROKEN);
    assert_non_null(strstr(why.message, "it overwrote memory that it shares with raytally while it was bu"));
    assert_ok(rt_measure_count(copy, &set, expected, 1, &count, error));
    assert_int_equal(count.differ, 0);
    assert_ok(rt_accel_open("faulty-scribbled", &scene, &faulty, error));
    assert_int_equal(rt_measure_count(faulty, &set, expected, 1, &count, &why), RT_BROKEN);
    assert_non_null(
        strstr(why.message, "it overwrote memory that it shares with raytally while it answered"));
    assert_ok(rt_measure_count(copy, &set, expected, 1, &count, error));
    assert_int_equal(count.differ, 0);
    rt_accel_destroy(faulty);
    rt_accel_destroy(copy);
    rt_accel_destroy(bvh);
    rt_rayset_clear(&set);
    rt_scene_clear(&scene);
}

RT_TEST(a_broken_one_misses_everything_says_why_and_takes_no_more_queries) {
    RtScene scene;
    RtRaySet set;
    RtAccel *bvh, *faulty;
    RtQuery query, another;
    RtError why;
    RtHit hits[200];
    open_random(&scene);
    open_chords(&scene, 200, &set, &bvh);
    assert_ok(rt_accel_open("faulty-abort", &scene, &faulty, error));
    assert_ok(rt_query_init(&query, faulty, error));
    rt_nearest(&query, set.rays, set.count, hits, NULL);
    for (int i = 0; i < 200; i++) assert_int_equal(hits[i].object, RT_NO_OBJECT);
    assert_int_equal(rt_accel_check(faulty, &why), RT_BROKEN);
    assert_non_null(strstr(why.message, "(Aborted) while it answered a stream of 200 rays, at the ray org"));
    assert_int_equal(rt_query_init(&another, faulty, &why), RT_BROKEN);
    rt_query_clear(&query);
    rt_accel_destroy(faulty);
    rt_accel_destroy(bvh);
    rt_rayset_clear(&set);
    rt_scene_clear(&scene);
}

RT_TEST(one_that_does_not_survive_its_build_leaves_nothing_behind) {
    RtScene scene;
    RtAccel *accel;
    RtError why;
    open_random(&scene);
    int64_t live = rt_alloc_live();
    assert_int_equal(rt_accel_open("faulty-crash-build", &scene, &accel, &why), RT_BROKEN);
    assert_non_null(strstr(why.message, "while it was built over 300 objects"));
    assert_int_equal(rt_accel_open("cache+faulty-refused", &scene, &accel, &why), RT_BAD_INPUT);
    assert_int_equal(rt_alloc_live(), live);
    rt_scene_clear(&scene);
}

RT_TEST(one_that_is_loaded_leaves_the_processor_and_the_error_as_they_were) {
    volatile float least = FLT_MIN;
    RtError why = {RT_OK, "untouched"};
    assert_int_equal(rt_plugin_load(PLUGINS "odd-FLUSHING.so", &why), RT_OK);
    assert_string_equal(why.message, "untouched");
    assert_true(least / 2 > 0);
}

RT_TEST(loading_needs_no_error) {
    assert_int_equal(rt_plugin_load(PLUGINS "unloadable-ENTRY.so", NULL), RT_BAD_INPUT);
    assert_int_equal(rt_plugin_load(PLUGINS "odd-LONGER.so", NULL), RT_OK);
    assert_int_equal(rt_plugin_load(PLUGINS "odd-LONGER.so", NULL), RT_OK);
}

RT_TEST(of_a_library_that_is_refused_nothing_is_registered) {
    static const char *const kinds[] = {"EMPTY", "ABI",      "SIZE",       "NAME",     "TAKEN",
                                        "TWICE", "FUNCTION", "PARAMETERS", "STANDARD", "CONSTRUCTOR",
                                        "ENTRY", "MANY",     "CHOICES"};
    const RtAccelOps *found;
    load_all();
    size_t plugins = rt_plugin_count(), accelerators = rt_accel_count();
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        char path[sizeof PLUGINS + 64];
        snprintf(path, sizeof path, PLUGINS "unloadable-%s.so", kinds[i]);
        assert_int_equal(rt_plugin_load(path, NULL), RT_BAD_INPUT);
        assert_int_equal(rt_plugin_count(), plugins);
        assert_int_equal(rt_accel_count(), accelerators);
        assert_int_equal(rt_accel_find("unloadable-first", &found, NULL), RT_BAD_INPUT);
    }
}

static void wait_for_all(int number) {
    int before = errno;
    (void)number;
    while (waitpid(-1, NULL, WNOHANG) > 0) {
    }
    errno = before;
}

/* What is said of a plugin that crashes must not depend on who waits for children. */
static void crash_where_children_are(void (*handled)(int)) {
    RtScene scene;
    RtRaySet set;
    RtAccel *bvh, *faulty;
    RtQuery query;
    RtError why;
    RtHit hit;
    open_random(&scene);
    open_chords(&scene, 1, &set, &bvh);
    void (*before)(int) = signal(SIGCHLD, handled);
    double began = rt_wall_seconds();
    assert_ok(rt_accel_open("faulty-abort", &scene, &faulty, error));
    assert_ok(rt_query_init(&query, faulty, error));
    rt_nearest(&query, set.rays, 1, &hit, NULL);
    assert_int_equal(rt_accel_check(faulty, &why), RT_BROKEN);
    assert_non_null(
        strstr(why.message, "it crashed (Aborted) while it answered a stream of 1 ray, at the ray"));
    assert_int_equal(rt_plugin_load(PLUGINS "unloadable-CONSTRUCTOR.so", &why), RT_BAD_INPUT);
    assert_non_null(strstr(why.message, "it does not survive loading: it "));
    assert_true(rt_wall_seconds() - began < 1.5); /* less than it may hang */
    rt_query_clear(&query);
    rt_accel_destroy(faulty);
    signal(SIGCHLD, before);
    rt_accel_destroy(bvh);
    rt_rayset_clear(&set);
    rt_scene_clear(&scene);
}

RT_TEST(a_crash_is_told_where_children_are_ignored) {
    crash_where_children_are(SIG_IGN);
}

RT_TEST(a_crash_is_told_where_somebody_else_waits_for_children) {
    crash_where_children_are(wait_for_all);
}

RT_TEST(a_name_is_a_letter_and_then_letters_digits_and_two_more) {
    static const char *const good[] = {"x", "my-grid", "Grid_2",
                                       "free-for-63-letters-and-not-one-more-than-that-xxxxxxxxxxxxxxxx"};
    static const char *const bad[] = {"",
                                      "9lives",
                                      "-x",
                                      "_x",
                                      "a b",
                                      "a:b",
                                      "a+b",
                                      "gr\374n",
                                      "all",
                                      "grid",
                                      "free-for-63-letters-and-not-one-more-than-that-xxxxxxxxxxxxxxxxx"};
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++)
        assert_ok(rt_accel_name_is_free(good[i], error));
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_int_equal(rt_accel_name_is_free(bad[i], NULL), RT_BAD_INPUT);
}

RT_TESTS(plugins, NULL, NULL)
