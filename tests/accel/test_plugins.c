/* SPDX-License-Identifier: Apache-2.0 */
/* Accelerators of plugins, which run in processes of their own: they answer, count and show boxes as they
 * would in this one, and one that breaks damages no other results. tests/check_plugins.sh tests what commands
 * report of them. */
#include "accel_testing.h"
#include "equivalence_testing.h"
#include "instances_testing.h"

#include "accel/plugin.h"
#include "core/base/clock.h"
#include "measure/measure.h"
#include "render/path.h"

#include <errno.h>
#include <float.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>

#define PLUGINS RT_BINARY_DIR "/plugins/"

static void load_all(void) {
    setenv("RAYTALLY_PLUGIN_SECONDS", "2", 1);
    static const char *const files[] = {"new-accel.so", "bvh_copy.so", "faulty.so", "own_hits.so",
                                        "shadow-cache.so"};
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        char path[sizeof PLUGINS + 32];
        snprintf(path, sizeof path, PLUGINS "%s", files[i]);
        assert_ok(rt_plugin_load(path, error));
    }
}

/* An accelerator of a plugin over a scene, and random chords with their right answers. */
typedef struct Stage {
    RtScene scene;
    RtRaySet set;
    RtAccel *bvh, *accel;
    RtHit *expected; /* [set.count] */
} Stage;

static void open_stage(Stage *stage, const char *spec, uint64_t count) {
    RtQuery query;
    load_all();
    assert_ok(rt_scene_open("random:n=300,shape=mixed", &stage->scene, error));
    assert_ok(rt_accel_open("bvh", &stage->scene, &stage->bvh, error));
    assert_ok(rt_query_init(&query, stage->bvh, error));
    assert_ok(rt_rayset_init(&stage->set, RT_RAY_RANDOM, count, error));
    rt_ray_family_fill(0, &query, 1, 0, count, stage->set.rays);
    for (uint64_t i = 0; i < count; i++) stage->set.rays[i].kind = RT_RAY_RANDOM;
    rt_query_clear(&query);
    stage->expected = rt_alloc(count, sizeof(RtHit));
    assert_ok(rt_measure_answers(stage->bvh, &stage->set, 2, stage->expected, error));
    assert_ok(rt_accel_open(spec, &stage->scene, &stage->accel, error));
}

static void close_stage(Stage *stage) {
    rt_accel_destroy(stage->accel);
    rt_accel_destroy(stage->bvh);
    rt_free(stage->expected);
    rt_rayset_clear(&stage->set);
    rt_scene_clear(&stage->scene);
}

static RtCount count_on(const Stage *stage, const RtAccel *accel, int threads) {
    RtCount count;
    assert_ok(rt_measure_count(accel, &stage->set, stage->expected, threads, &count, error));
    assert_int_equal(count.differ, 0);
    return count;
}

/* Traces all rays of the stage by its accelerator, which breaks, and every ray misses. */
static void break_by_tracing(const Stage *stage, RtQuery *query) {
    RtHit hits[2000];
    assert_ok(rt_query_init(query, stage->accel, error));
    rt_nearest(query, stage->set.rays, stage->set.count, hits, NULL);
    for (uint64_t i = 0; i < stage->set.count; i++) assert_int_equal(hits[i].object, RT_NO_OBJECT);
}

static void assert_it_broke(const RtAccel *accel, const char *says) {
    assert_fails_with(rt_accel_check(accel, error), RT_BROKEN, says);
}

RT_TEST(one_that_is_loaded_twice_is_there_once) {
    load_all();
    size_t plugins = rt_plugin_count(), accelerators = rt_accel_count();
    load_all();
    assert_int_equal(rt_plugin_count(), plugins);
    assert_int_equal(rt_accel_count(), accelerators);
}

RT_TEST(answers_are_those_of_brute_in_streams_of_every_length_on_several_threads) {
    static const char *const specs[] = {
        "my-accel",       "my-accel:boxes=off", "bvh_copy",
        "cache+bvh_copy", "shadow-cache+wide",  "shadow-cache:lights=1+light+shadow-cache+bvh_copy"};
    OWNED_BENCH bench;
    load_all();
    bench.scene = open_family(scene_family("slivers"), 3);
    set_up_rays(&bench, 5, 300);
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        RtEquivalence result;
        OWNED_ACCEL RtAccel *accel = open_accel(&bench.scene, specs[i]);
        assert_true(rt_accel_is_remote(accel));
        assert_ok(rt_accel_validate(accel, error));
        assert_ok(rt_equivalence_check(&bench.reference, accel, 3, &result, error));
        assert_int_equal(result.verdicts[RT_EQUAL], result.rays);
    }
}

RT_TEST(counts_are_the_same_on_any_number_of_threads) {
    OWNED(close_stage) Stage stage;
    open_stage(&stage, "bvh_copy", 20000);
    RtCount once = count_on(&stage, stage.accel, 1), again = count_on(&stage, stage.accel, 3);
    assert_memory_equal(&once.tally, &again.tally, sizeof once.tally);
    assert_int_equal(once.tally.rays, stage.set.count);
    assert_true(once.tally.object_tests > 0 && once.tally.steps > 0);
}

/* ---- instances ---- */

RT_TEST(to_a_plugin_an_instance_is_an_object_and_its_answers_name_those_within) {
    static const char *const specs[] = {"my-accel",        "bvh_copy",
                                        "bvh_copy/grid",   "shadow-cache+bvh",
                                        "faulty-over+bvh", "light:cells=20+item+shadow-cache+bvh_copy/bvh"};
    load_all();
    for (uint64_t seed = 1; seed <= RT_SHARE(4, 2); seed++) {
        OWNED_BENCH bench;
        set_up_family(&bench, scene_family(seed % 2 ? "instanced" : "instanced-far"), seed, 100);
        for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
            RtEquivalence result;
            OWNED_ACCEL RtAccel *accel = open_accel(&bench.scene, specs[i]);
            assert_true(rt_accel_is_remote(accel) && accel->exact);
            assert_ok(rt_equivalence_check(&bench.reference, accel, 2, &result, error));
            assert_int_equal(result.verdicts[RT_EQUAL], result.rays);
            assert_int_equal(result.occluded_wrong, 0);
        }
    }
}

RT_TEST(in_instances_a_plugin_counts_what_the_built_in_one_that_it_copies_counts) {
    static const char *const pairs[][2] = {
        {"bvh", "bvh_copy"}, {"bvh/grid", "bvh_copy/grid"}, {"cache+bvh/kd", "shadow-cache+bvh/kd"}};
    OWNED_BENCH bench;
    load_all();
    set_up_family(&bench, scene_family("instanced"), 1, 50);
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        RtTally tallies[2][RT_RAY_KIND_COUNT] = {{{0}}};
        for (int k = 0; k < 2; k++) {
            OWNED_ACCEL RtAccel *accel = open_accel(&bench.scene, pairs[i][k]);
            OWNED_QUERY query = open_query(accel);
            for (size_t ray = 0; ray < bench.reference.count; ray++) {
                RtHit hit;
                bool blocked;
                bench.rays[ray].kind = RT_RAY_SHADOW;
                bench.rays[ray].source = 0;
                if (i < 2) /* which of two objects in a leaf is tested first, the copy need not know */
                    rt_nearest(&query, &bench.rays[ray], 1, &hit, tallies[k]);
                else
                    rt_occluded(&query, &bench.rays[ray], 1, &blocked, tallies[k]);
            }
            assert_ok(rt_accel_check(accel, error));
        }
        assert_memory_equal(tallies[0], tallies[1], sizeof tallies[0]);
    }
}

RT_TEST(no_plugin_is_of_parts_alone) {
    RtSpec spec;
    load_all();
    assert_bad_input(rt_spec_parse("bvh/bvh_copy", &spec, error), "cannot stand after a '/'");
}

/* ---- overlays ---- */

/* Whether the rays are blocked, and the counts, in streams of several kinds of rays. */
static void trace_streams(const char *spec, const Stage *stage, bool *blocked, RtTally *tallies) {
    enum { STREAM = 37 };
    RtQuery query;
    OWNED_ACCEL RtAccel *accel = open_accel(&stage->scene, spec);
    assert_ok(rt_query_init(&query, accel, error));
    for (uint64_t i = 0; i < stage->set.count; i += STREAM) {
        const uint64_t left = stage->set.count - i;
        rt_occluded(&query, stage->set.rays + i, left < STREAM ? left : STREAM, blocked + i, tallies);
    }
    rt_query_clear(&query);
    assert_ok(rt_accel_check(accel, error));
}

RT_TEST(an_overlay_counts_what_the_built_in_one_counts_over_any_layer) {
    enum { RAYS = 2000 };
    static const char *const pairs[][2] = {{"cache+bvh", "shadow-cache+bvh"},
                                           {"cache+bvh", "shadow-cache+bvh_copy"},
                                           {"cache+cache+grid", "shadow-cache+cache+grid"},
                                           {"cache+cache+bvh", "shadow-cache+shadow-cache+bvh_copy"}};
    OWNED(close_stage) Stage stage;
    open_stage(&stage, "shadow-cache+bvh", RAYS);
    for (uint32_t i = 0; i < RAYS; i++) {
        stage.set.rays[i].kind = i % 3 ? RT_RAY_SHADOW : RT_RAY_DIFFUSE;
        stage.set.rays[i].source = i % stage.scene.light_count;
    }
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        RtTally built_in[RT_RAY_KIND_COUNT] = {0}, own[RT_RAY_KIND_COUNT] = {0};
        bool right[RAYS], blocked[RAYS];
        trace_streams(pairs[i][0], &stage, right, built_in);
        trace_streams(pairs[i][1], &stage, blocked, own);
        assert_memory_equal(right, blocked, sizeof right);
        assert_memory_equal(built_in, own, sizeof own);
        assert_true(own[RT_RAY_SHADOW].passed_on > 0 && own[RT_RAY_DIFFUSE].passed_on == 0);
    }
}

RT_TEST(an_overlay_is_described_with_the_layers_below) {
    OWNED(close_stage) Stage stage;
    RtDescription alone, both;
    open_stage(&stage, "shadow-cache+bvh", 1);
    rt_accel_describe(stage.bvh, &alone);
    rt_accel_describe(stage.accel, &both);
    assert_true(stage.accel->exact && stage.accel->counts);
    assert_int_equal(both.bytes, alone.bytes);
    assert_int_equal(both.leaves, alone.leaves);
    assert_true(both.predicted_cost == alone.predicted_cost);
}

/* ---- the path of a ray ---- */

static RtPath path_of(RtAccel *accel, const RtRay *ray) {
    RtPath path;
    RtTally counted[RT_RAY_KIND_COUNT] = {0};
    RtHit hit;
    uint32_t occluder;
    assert_ok(rt_path_trace(&path, accel, ray, error));
    OWNED_QUERY query = open_query(accel);
    rt_trace_stream(accel, query.scratch, ray, 1, path.any ? NULL : &hit, &occluder, counted);
    assert_memory_equal(&path.tally, &counted[ray->kind], sizeof path.tally);
    return path;
}

static void assert_same_path(RtAccel *accel, RtAccel *other, const RtRay *ray) {
    OWNED(rt_path_clear) RtPath path = path_of(accel, ray), same = path_of(other, ray);
    assert_int_equal(path.count, same.count);
    assert_memory_equal(&path.hit, &same.hit, sizeof path.hit);
    for (uint32_t i = 0; i < path.count; i++) {
        const RtPathRow *a = &path.rows[i], *b = &same.rows[i];
        assert_true(a->kind == b->kind && a->index == b->index && a->leaf == b->leaf && a->met == b->met &&
                    a->t == b->t && a->boxed == b->boxed && a->enter == b->enter && a->leave == b->leave);
        assert_string_equal(a->what, b->what);
    }
}

RT_TEST(its_path_is_that_of_the_built_in_one_that_it_copies_alone_and_in_a_stack) {
    static const char *const pairs[][2] = {
        {"bvh", "bvh_copy"}, {"cache+bvh", "cache+bvh_copy"}, {"grid", "faulty-over+grid"}};
    OWNED(close_stage) Stage stage;
    open_stage(&stage, "bvh", 300);
    for (size_t p = 0; p < sizeof pairs / sizeof pairs[0]; p++) {
        OWNED_ACCEL RtAccel *accel = open_accel(&stage.scene, pairs[p][0]);
        OWNED_ACCEL RtAccel *other = open_accel(&stage.scene, pairs[p][1]);
        for (uint32_t i = 0; i < stage.set.count; i++) {
            RtRay ray = stage.set.rays[i];
            ray.kind = i % 4 || p == 2 ? RT_RAY_DIFFUSE : RT_RAY_SHADOW;
            assert_same_path(accel, other, &ray);
        }
    }
}

RT_TEST(a_path_of_more_events_than_a_message_holds_is_whole) {
    OWNED(close_stage) Stage stage;
    open_stage(&stage, "bvh", 1);
    OWNED_SCENE scene = open_scene("random:n=3000");
    OWNED_ACCEL RtAccel *brute = open_accel(&scene, "brute");
    OWNED_ACCEL RtAccel *over = open_accel(&scene, "faulty-over+brute");
    assert_same_path(brute, over, stage.set.rays);
}

RT_TEST(what_it_does_not_show_is_in_its_path_without_a_name_and_what_it_passes_on_with_its_own) {
    OWNED(close_stage) Stage stage;
    open_stage(&stage, "faulty-shows", 1);
    OWNED(rt_path_clear) RtPath path = path_of(stage.accel, stage.set.rays);
    assert_int_equal(path.count, 600); /* a step and a test of each object */
    for (uint32_t i = 0; i < path.count; i++) {
        assert_int_equal(path.rows[i].kind, i < 300 ? RT_TRACED_STEP : RT_TRACED_OBJECT_TEST);
        assert_true(i >= 300 || (!path.rows[i].boxed && !*path.rows[i].what));
    }
    rt_path_clear(&path);
    stage.set.rays[0].kind = RT_RAY_SHADOW;
    OWNED_ACCEL RtAccel *cache = open_accel(&stage.scene, "shadow-cache+bvh");
    path = path_of(cache, stage.set.rays);
    assert_int_equal(path.rows[0].kind, RT_TRACED_PASSED_ON);
    assert_string_equal(path.rows[0].what, "shadow-cache");
}

/* ---- hit functions of their own ---- */

/* The verdicts on rays of every family through a scene, by a new accelerator *accel. */
static RtEquivalence verdicts_on(const char *scene, const char *spec, FamilyBench *bench, RtAccel **accel) {
    RtEquivalence result;
    load_all();
    assert_ok(rt_scene_open(scene, &bench->scene, error));
    set_up_rays(bench, 5, 300);
    *accel = open_accel(&bench->scene, spec);
    assert_ok(rt_equivalence_check(&bench->reference, *accel, 2, &result, error));
    return result;
}

RT_TEST(one_with_its_own_hit_functions_gets_the_geometry_and_is_judged_by_verdicts) {
    static const char *const scenes[] = {
        "random:n=200,shape=mixed", "random:n=200,shape=triangle", "random:n=200", "random:n=0",
        "csg-field:n=30",           "balls:size=2,instances=on"};
    for (size_t i = 0; i < sizeof scenes / sizeof scenes[0]; i++) {
        OWNED_BENCH bench;
        OWNED_ACCEL RtAccel *accel;
        RtEquivalence result = verdicts_on(scenes[i], "own-hits", &bench, &accel);
        assert_true(!accel->exact && accel->counts);
        assert_int_equal(result.verdicts[RT_WRONG] + result.occluded_wrong, 0);
        assert_true(result.rays > 0 && result.verdicts[RT_EQUAL] > result.rays / 2);
    }
}

RT_TEST(an_occluder_that_a_part_does_not_name_blocks_all_the_same) {
    load_all();
    OWNED_SCENE scene = begin_balls();
    add_ball(&scene, 0, 0, -9, 1);
    for (int i = 0; i < 2; i++) place(&scene, &scene, 0, moved(4 * i, 0, 0)); /* ids 1 and 2 */
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "own-unnamed");
    OWNED_QUERY query = open_query(accel);
    for (int i = 0; i < 2; i++) {
        const RtRay ray = {.org = rt_vec3(4 * (float)i, 0, 5), .dir = rt_vec3(0, 0, -1), .tmax = 8};
        uint32_t occluder;
        rt_trace_stream(accel, query.scratch, &ray, 1, NULL, &occluder, NULL);
        assert_int_equal(occluder, RT_UNNAMED_OBJECT);
    }
}

RT_TEST(answers_with_other_bits_are_counted_and_so_are_its_own_object_tests) {
    OWNED(close_stage) Stage stage;
    RtCount count;
    open_stage(&stage, "own-hits", 1000);
    assert_ok(rt_measure_count(stage.accel, &stage.set, stage.expected, 2, &count, error));
    assert_true(count.differ > 0 && count.differ < count.tally.hits);
    assert_int_equal(count.tally.object_tests, 1000 * stage.scene.geometry.object_count);
}

RT_TEST(one_without_counts_gets_no_counters_and_need_not_name_occluders_below_a_cache_either) {
    static const char *const specs[] = {"own-unnamed", "cache+own-unnamed", "shadow-cache+own-unnamed"};
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) {
        OWNED_BENCH bench;
        OWNED_ACCEL RtAccel *accel;
        RtEquivalence result = verdicts_on("balls:size=1", specs[i], &bench, &accel);
        assert_true(!accel->exact && !accel->counts);
        assert_int_equal(result.verdicts[RT_WRONG] + result.occluded_wrong, 0);
    }
}

RT_TEST(the_answers_that_differ_are_those_of_the_timed_kernel_if_it_is_worse) {
    OWNED(close_stage) Stage stage;
    RtCount count;
    open_stage(&stage, "faulty-own-lazy", 1000);
    assert_ok(rt_measure_count(stage.accel, &stage.set, stage.expected, 1, &count, error));
    assert_true(count.timed_kernel && count.differ == count.tally.hits);
}

static void count_box(void *context, const RtBoxView *view) {
    uint64_t *boxes = context;
    boxes[view->leaf]++;
    assert_true(view->box->lo.x <= view->box->hi.x);
}

RT_TEST(its_boxes_are_those_that_it_describes) {
    OWNED_SCENE scene;
    RtDescription shape;
    uint64_t boxes[2] = {0, 0};
    load_all();
    assert_ok(rt_scene_open("random:n=9000", &scene, error)); /* more boxes than a message holds */
    OWNED_ACCEL RtAccel *copy = open_accel(&scene, "bvh_copy");
    rt_accel_describe(copy, &shape);
    copy->ops->each_box(copy, (RtBoxViewer){count_box, boxes});
    assert_int_equal(boxes[0], shape.interior);
    assert_int_equal(boxes[1], shape.leaves);
}

/* Times the stage's accelerator, which breaks, and bvh, which does not. */
static void time_broken(const Stage *stage) {
    enum { ROUNDS = 3 };
    double seconds[2][ROUNDS], wall[2][ROUNDS];
    bool broken[2] = {false, false};
    uint32_t done = 0;
    RtTimed timed[2];
    for (int i = 0; i < 2; i++)
        timed[i] = (RtTimed){.accel = i == 0 ? stage->accel : stage->bvh,
                             .set = &stage->set,
                             .seconds = seconds[i],
                             .wall = wall[i],
                             .broken = &broken[i]};
    RtTiming timing = {.rounds = {.rounds = ROUNDS, .most = ROUNDS, .seed = 1}, .threads = 1};
    assert_ok(rt_measure_time(timed, 2, &timing, &done, error));
    assert_int_equal(done, ROUNDS);
    assert_true(broken[0] && !broken[1]);
    for (int i = 0; i < ROUNDS; i++) assert_true(seconds[1][i] > 0);
}

RT_TEST(one_that_breaks_among_those_timed_is_left_out_and_the_others_are_timed) {
    OWNED(close_stage) Stage stage;
    open_stage(&stage, "faulty-crash-timed", 500);
    time_broken(&stage);
    assert_it_broke(stage.accel, "faulty-crash-timed: it crashed (Segmentation fault)");
}

RT_TEST(one_that_broke_before_it_is_timed_is_left_out) {
    OWNED(close_stage) Stage stage;
    RtQuery query;
    open_stage(&stage, "faulty-killed", 100);
    break_by_tracing(&stage, &query);
    rt_query_clear(&query);
    time_broken(&stage);
}

RT_TEST(one_that_breaks_as_it_traces_ray_by_ray_has_no_rows) {
    OWNED(close_stage) Stage stage;
    RtRows rows;
    open_stage(&stage, "faulty-crash-alone", 100);
    assert_int_equal(rt_measure_rows(stage.accel, &stage.set, 1, &rows, NULL), RT_BROKEN);
    rt_rows_clear(&rows);
}

RT_TEST(one_that_writes_to_shared_memory_damages_no_other) {
    OWNED(close_stage) Stage stage;
    RtAccel *faulty;
    RtCount count;
    open_stage(&stage, "bvh_copy", 100);
    assert_fails_with(rt_accel_open("faulty-scribble", &stage.scene, &faulty, error), RT_BROKEN,
                      "it overwrote memory that it shares with raytally while it was bu");
    count_on(&stage, stage.accel, 1);
    assert_ok(rt_accel_open("faulty-scribbled", &stage.scene, &faulty, error));
    assert_fails_with(rt_measure_count(faulty, &stage.set, stage.expected, 1, &count, error), RT_BROKEN,
                      "it overwrote memory that it shares with raytally while it answered");
    count_on(&stage, stage.accel, 1);
    rt_accel_destroy(faulty);
}

RT_TEST(a_broken_one_misses_everything_says_why_and_takes_no_more_queries) {
    OWNED(close_stage) Stage stage;
    RtQuery query, another;
    open_stage(&stage, "faulty-abort", 200);
    break_by_tracing(&stage, &query);
    assert_it_broke(stage.accel, "(Aborted) while it answered a stream of 200 rays, at the ray org");
    assert_fails_with(rt_query_init(&another, stage.accel, error), RT_BROKEN, "Aborted");
    rt_query_clear(&query);
}

/* As tests/plugins/faulty.c chooses a ray of 256. */
static bool is_rare(const RtRay *ray) {
    uint32_t bits;
    memcpy(&bits, &ray->dir.y, sizeof bits);
    return bits * 2654435761U >> 24 == 7;
}

RT_TEST(a_crash_names_the_ray_prepared_last_or_the_first_of_the_stream) {
    static const char *const specs[] = {"faulty-crash-rare", "faulty-own-unprepared"};
    for (size_t k = 0; k < 2; k++) {
        OWNED(close_stage) Stage stage;
        RtQuery query;
        char text[RT_RAY_TEXT], at[RT_RAY_TEXT + 64];
        uint64_t ray = 0;
        open_stage(&stage, specs[k], 2000);
        while (k == 0 && !is_rare(&stage.set.rays[ray])) ray++;
        rt_ray_format(&stage.set.rays[ray], text, sizeof text);
        snprintf(at, sizeof at, "%s the ray %s", k == 0 ? ", at" : "; its stream begins with", text);
        break_by_tracing(&stage, &query);
        assert_it_broke(stage.accel, at);
        rt_query_clear(&query);
    }
}

RT_TEST(one_that_does_not_survive_its_build_leaves_nothing_behind) {
    RtAccel *accel;
    RtError why;
    load_all();
    OWNED_SCENE scene = open_scene("random:n=300,shape=mixed");
    int64_t live = rt_alloc_live();
    assert_fails_with(rt_accel_open("faulty-crash-build", &scene, &accel, error), RT_BROKEN,
                      "while it was built over 300 objects");
    assert_int_equal(rt_accel_open("cache+faulty-refused", &scene, &accel, &why), RT_BAD_INPUT);
    assert_int_equal(rt_alloc_live(), live);
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

RT_TEST(a_rejected_library_registers_nothing) {
    static const char *const kinds[] = {"EMPTY", "ABI",      "SIZE",       "NAME",    "TAKEN",
                                        "TWICE", "FUNCTION", "PARAMETERS", "DEFAULT", "CONSTRUCTOR",
                                        "ENTRY", "MANY",     "CHOICES",    "FLAGS"};
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

/* Reports of a plugin that crashes must not depend on who waits for children. */
static void crash_where_children_are(void (*handled)(int)) {
    Stage stage;
    RtQuery query;
    open_stage(&stage, "bvh", 1);
    rt_accel_destroy(stage.accel);
    void (*before)(int) = signal(SIGCHLD, handled);
    double began = rt_wall_seconds();
    assert_ok(rt_accel_open("faulty-abort", &stage.scene, &stage.accel, error));
    break_by_tracing(&stage, &query);
    assert_it_broke(stage.accel, "it crashed (Aborted) while it answered a stream of 1 ray, at the ray");
    assert_bad_input(rt_plugin_load(PLUGINS "unloadable-CONSTRUCTOR.so", error), "loading it failed: it ");
    assert_true(rt_wall_seconds() - began < 1.5); /* less than it may hang */
    rt_query_clear(&query);
    rt_accel_destroy(stage.accel);
    signal(SIGCHLD, before);
    stage.accel = NULL;
    close_stage(&stage);
}

RT_TEST(a_crash_is_reported_where_children_are_ignored_and_where_other_code_waits_for_them) {
    crash_where_children_are(SIG_IGN);
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
