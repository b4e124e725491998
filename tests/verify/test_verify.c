/* SPDX-License-Identifier: Apache-2.0 */
/* Verification as a whole: a failure is kept in a replay file that reproduces it until the fault is fixed;
 * an interrupted run resumes to the same table. */
#include "mutants.h"
#include "testing.h"

#include "core/base/file.h"
#include "core/text/json.h"
#include "scenes/open.h"
#include "verify/verify.h"
#include "verify/verify_table.h"

#define OUT RT_BINARY_DIR "/test_verify.out"

static const char *const scenes[] = {"family:kind=plane,seed=1", "random:n=30,shape=mixed"};

static int rows_seen, scenes_worked_on;

static void on_doing(void *context, const RtVerifyProgress *progress) {
    (void)context;
    scenes_worked_on += strcmp(progress->what, "recording rays") == 0;
}

static void on_row(void *context, const json_t *row) {
    (void)context, (void)row;
    rows_seen++;
}

static void on_notice(void *context, const char *message) {
    (void)context;
    print_message("%s\n", message);
}

/* Linked so that calls of rt_scene_open come here, to be counted. */
RtStatus __real_rt_scene_open(const char *spec, RtScene *scene, RtError *error);
RtStatus __wrap_rt_scene_open(const char *spec, RtScene *scene, RtError *error);
static int scenes_opened;

RtStatus __wrap_rt_scene_open(const char *spec, RtScene *scene, RtError *error) {
    scenes_opened++;
    return __real_rt_scene_open(spec, scene, error);
}

static const RtVerifyObserver observer = {on_doing, on_row, on_notice, NULL};

static uint32_t shrink; /* RtVerify.shrink */

/* Verifies `work`, to which this adds; the rows are the caller's. */
static json_t *verify_as(RtVerify work, uint64_t rays, int threads, const char *folder) {
    json_t *rows;
    work.rays = (RtVerifyRays){rays, 1, threads, NULL};
    work.shrink = shrink;
    work.folder = folder;
    rows_seen = scenes_worked_on = scenes_opened = 0;
    assert_ok(rt_verify_run(&work, &observer, &rows, error));
    return rows;
}

/* Verifies grid and a mutant on both scenes. */
static json_t *verify(const char *folder, int threads, RtStart start) {
    static const RtVerifySpec specs[] = {{"grid", true, true, false}, {UNPADDED, true, true, false}};
    const RtVerify work = {
        .scenes = scenes, .scene_count = 2, .specs = specs, .spec_count = 2, .start = start};
    return verify_as(work, 6000, threads, folder);
}

/* Verifies one spec on `count` scenes. */
static json_t *verify_spec(const RtVerifySpec *spec, const char *const *names, uint32_t count, uint64_t rays,
                           int threads, const char *folder) {
    const RtVerify work = {
        .scenes = names, .scene_count = count, .specs = spec, .spec_count = 1, .start = RT_START_ANEW};
    return verify_as(work, rays, threads, folder);
}

static char *text_of(const char *folder, const char *name) {
    char path[RT_MAX_PATH], *text;
    size_t size;
    assert_ok(rt_path_join(folder, name, path, error));
    assert_ok(rt_file_read(path, 1 << 24, &text, &size, error));
    return text;
}

static void assert_same_file(const char *name, const char *a, const char *b) {
    OWNED_MEMORY char *x = text_of(a, name), *y = text_of(b, name);
    assert_string_equal(x, y);
}

static const char *replay_of(const json_t *row) {
    const char *path = json_string_value(json_object_get(json_object_get(row, "first_wrong"), "replay"));
    assert_non_null(path);
    return path;
}

RT_TEST(a_failure_can_be_replayed_until_it_is_mended) {
    json_auto_t *rows = verify(OUT "/a", 0, RT_START_ANEW);
    assert_int_equal(json_array_size(rows), 4);
    assert_false(rt_verify_row_fails(json_array_get(rows, 0)));
    assert_true(rt_verify_row_fails(json_array_get(rows, 1)));
    OWNED(rt_replay_clear) RtReplay replay;
    assert_ok(rt_replay_load(&replay, replay_of(json_array_get(rows, 1)), error));
    assert_string_equal(replay.scene_spec, scenes[0]);
    assert_string_equal(replay.failure.spec, UNPADDED);
    for (int shrunk = 0; shrunk < 2; shrunk++) {
        RtAnswer broken, mended;
        RtReplay other = replay;
        other.failure.spec = PADDED;
        assert_ok(rt_replay_ask(&replay, shrunk, &broken, error));
        assert_ok(rt_replay_ask(&other, shrunk, &mended, error));
        assert_true(broken.wrong);
        assert_false(mended.wrong);
    }
}

/* The columns that docs/columns.md documents for `verify --json`. */
RT_TEST(a_row_has_the_members_that_its_columns_name) {
    json_auto_t *rows = verify(OUT "/a", 0, RT_START_ANEW);
    const json_t *row = json_array_get(rows, 1);
    size_t members = 0; /* of the row itself */
    for (size_t g = 0; g < RT_VERIFY_JSON_GROUPS; g++) {
        const RtColumnGroup *group = &rt_verify_json[g];
        const json_t *object = group->name ? json_object_get(row, group->name) : row;
        members += group->name ? 1 : group->count;
        if (group->name) assert_int_equal(json_object_size(object), group->count);
        for (size_t i = 0; i < group->count; i++) {
            if (!json_object_get(object, group->columns[i].name))
                fail_msg("there is no member %s", group->columns[i].name);
        }
    }
    assert_int_equal(json_object_size(row), members);
}

RT_TEST(threads_and_interruptions_change_no_byte) {
    json_decref(verify(OUT "/a", 1, RT_START_ANEW));
    assert_true(scenes_worked_on == 2 && scenes_opened == 2);
    json_decref(verify(OUT "/b", 2, RT_START_ANEW));
    OWNED_MEMORY char *journal = text_of(OUT "/b", "rows.jsonl");
    /* The header, two rows, and a part of the third: as if the power had failed then. */
    char *end = journal;
    for (int line = 0; line < 3; line++) end = strchr(end, '\n') + 1;
    assert_ok(rt_file_write(OUT "/b/rows.jsonl", journal, (size_t)(end - journal) + 7, error));
    assert_int_equal(unlink(OUT "/b/verify.csv"), 0);
    json_decref(verify(OUT "/b", 0, RT_START_RESUME));
    assert_int_equal(rows_seen, 4);
    assert_int_equal(scenes_worked_on, 1);
    OWNED_MEMORY char *a = text_of(OUT "/a", "verify.csv"), *b = text_of(OUT "/b", "verify.csv");
    /* They differ in the folder of the replay files alone. */
    for (char *at; (at = strstr(a, OUT "/a"));) at[strlen(OUT) + 1] = 'b';
    assert_string_equal(a, b);
    assert_same_file("0002-family-kind-plane-seed-1-mutant-kind-unpadded-boxes.json", OUT "/a", OUT "/b");
    json_decref(verify(OUT "/b", 0, RT_START_RESUME));
    assert_int_equal(scenes_worked_on, 0);
}

static int threads_of_build;

static RtStatus build_noting_threads(RtAccel *accel, const RtBuild *what, RtError *error) {
    (void)accel, (void)error;
    threads_of_build = what->threads;
    return RT_OK;
}

RT_TEST(accelerators_are_built_on_the_threads_of_the_run) {
    const RtVerifySpec spec = {"noting", true, true, false};
    for (int threads = 1; threads <= 3; threads += 2) {
        json_decref(verify_spec(&spec, scenes, 1, 100, threads, NULL));
        assert_int_equal(threads_of_build, threads);
    }
}

RT_TEST(another_run_is_not_gone_on_with) {
    json_decref(verify(OUT "/c", 0, RT_START_ANEW));
    RtVerify work = {.scenes = scenes, .scene_count = 1, .folder = OUT "/c", .start = RT_START_RESUME};
    json_auto_t *rows;
    assert_bad_input(rt_verify_run(&work, &observer, &rows, error), "another verification");
}

static int notices;

static void count_notice(void *context, const char *message) {
    (void)context;
    assert_non_null(strstr(message, OUT "/u/0001-"));
    assert_int_equal(rows_seen, 1);
    notices++;
}

RT_TEST(a_wrong_answer_is_shown_though_its_replay_file_cannot_be_written) {
    const RtVerifySpec spec = {UNPADDED, true, true, false};
    const RtVerifyObserver counting = {on_doing, on_row, count_notice, NULL};
    const RtVerify work = {.scenes = scenes,
                           .scene_count = 1,
                           .specs = &spec,
                           .spec_count = 1,
                           .rays = {6000, 1, 0, NULL},
                           .folder = OUT "/u",
                           .start = RT_START_ANEW};
    json_auto_t *rows;
    assert_ok(
        rt_directory_create(OUT "/u/0001-family-kind-plane-seed-1-mutant-kind-unpadded-boxes.json", error));
    rows_seen = notices = 0;
    assert_ok(rt_verify_run(&work, &counting, &rows, error));
    const json_t *row = json_array_get(rows, 0);
    assert_true(rt_verify_row_fails(row));
    assert_true(json_is_null(json_object_get(json_object_get(row, "first_wrong"), "replay")));
    assert_int_equal(notices, 1);
}

/* By default the first alone; the others are kept with their whole scenes. */
RT_TEST(an_accelerator_has_as_many_failures_shrunk_as_are_asked_for) {
    static const char *const three[] = {"family:kind=plane,seed=1", "family:kind=axis-aligned,seed=1",
                                        "family:kind=axis-aligned,seed=2"};
    static const uint32_t wanted[] = {0, 2, RT_SHRINK_ALL};
    const RtVerifySpec spec = {UNPADDED, true, true, false};
    for (size_t w = 0; w < 3; w++) {
        shrink = wanted[w];
        json_auto_t *rows = verify_spec(&spec, three, 3, 6000, 0, OUT "/s");
        for (uint32_t i = 0; i < 3; i++) {
            OWNED(rt_replay_clear) RtReplay replay;
            RtAnswer answer;
            const bool shrunk = i == 0 || i < wanted[w];
            const json_t *wrong = json_object_get(json_array_get(rows, i), "first_wrong");
            const json_int_t left = json_integer_value(json_object_get(wrong, "objects_left"));
            assert_true(json_is_true(json_object_get(wrong, "shrunk")) == shrunk);
            assert_true(shrunk ? left <= 3 : left == 150);
            assert_ok(rt_replay_load(&replay, replay_of(json_array_get(rows, i)), error));
            assert_true((replay.shrunk_yaml != NULL) == shrunk);
            assert_ok(rt_replay_ask(&replay, false, &answer, error));
            assert_true(answer.wrong);
        }
    }
    shrink = 0;
}

/* Loses the last ray of every stream that is not too short. */
static size_t shortest_losing;

static void lose_last(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                      RtHit *hits, uint32_t *occluders, RtTally *tallies) {
    nearest_timed(accel, scratch, rays, count, hits, occluders, tallies);
    if (count >= shortest_losing) hits[count - 1] = RT_MISS;
}

RT_TEST(a_failure_that_takes_its_neighbours_is_kept_with_them) {
    const RtVerifySpec spec = {"losing", true, true, false};
    OWNED(rt_replay_clear) RtReplay replay;
    RtAnswer answer;
    shortest_losing = 2;
    json_auto_t *rows = verify_spec(&spec, scenes, 1, 4000, 0, OUT "/d");
    assert_ok(rt_replay_load(&replay, replay_of(json_array_get(rows, 0)), error));
    assert_true(replay.failure.count > 1 && replay.failure.stream > 1);
    assert_int_equal((replay.failure.asked + 1) % replay.failure.stream, 0);
    for (int shrunk = 0; shrunk < 2; shrunk++) {
        assert_ok(rt_replay_ask(&replay, shrunk, &answer, error));
        assert_true(answer.wrong);
    }
}

/* Including the camera's rays, which come first: they form packets. */
RT_TEST(the_first_rays_are_asked_in_long_streams_as_well_as_alone) {
    const RtVerifySpec spec = {"losing", true, true, false};
    shortest_losing = 64;
    json_auto_t *rows = verify_spec(&spec, scenes + 1, 1, 1000, 0, OUT "/h");
    assert_true(rt_verify_row_fails(json_array_get(rows, 0)));
}

RT_TEST(the_spread_has_the_trial_and_that_beside_each_value) {
    const RtAccelOps *light;
    char spec[RT_MAX_SPEC_CHARS];
    bool combined = false;
    assert_ok(rt_accel_find("light", &light, error));
    assert_true(rt_spread_spec(light, 0, spec));
    assert_string_equal(spec, "light+bvh");
    assert_true(rt_spread_spec(light, 1, spec));
    assert_string_equal(spec, "light:cells=100+bvh");
    for (size_t n = 2; rt_spread_spec(light, n, spec); n++) {
        assert_non_null(strstr(spec, "light:cells="));
        assert_null(strstr(strstr(spec, "cells=") + 1, "cells="));
        combined |= strcmp(spec, "light:cells=100,longest=2+bvh") == 0;
    }
    assert_true(combined);
    assert_true(rt_trial_spec("cache+light+wide", spec));
    assert_string_equal(spec, "cache+light:cells=100+wide:sharing=0");
    assert_false(rt_trial_spec("light:longest=2+bvh", spec));
    assert_false(rt_trial_spec("item+bvh", spec));
}

/* A scene from a file is stored in the replay file and restored to the last bit. */
RT_TEST(a_replay_file_needs_no_other_file) {
    const char *path = OUT "/lecture.json";
    OWNED_SCENE scene;
    uint32_t ids[] = {1};
    RtAnswer answer = {.expected = {1, 0}, .got = RT_MISS, .wrong = true}, again;
    RtShrunk shrunk = {.ids = ids, .count = 1, .answer = answer, .minimal = true};
    RtRay ray = {.org = {{0x1.234567p-140f, -0.0f, 0x1.fffffep+9f}},
                 .tmin = 0x1p-149f,
                 .dir = {{-0.0f, 0x1p-149f, -1}},
                 .tmax = INFINITY,
                 .kind = RT_RAY_SHADOW,
                 .source = UINT32_MAX};
    RtFailure failure = {
        .spec = "bvh", .rays = &ray, .count = 1, .stream = 1, .occluded = true, .counted = true};
    assert_ok(rt_directory_create(OUT, error));
    assert_ok(rt_scene_open(RT_SOURCE_DIR "/scenes/csg-lecture.yaml", &scene, error));
    RtReplayRecord record = {"moved-away.yaml", &scene, &failure, &answer, &shrunk};
    assert_ok(rt_replay_save(path, &record, error));
    OWNED(rt_replay_clear) RtReplay replay;
    assert_ok(rt_replay_load(&replay, path, error));
    assert_memory_equal(&replay.rays[0], &ray, sizeof ray);
    assert_true(replay.failure.occluded && replay.failure.counted);
    assert_int_equal(replay.fingerprint, rt_scene_fingerprint(&scene));
    for (int part = 0; part < 2; part++) {
        assert_ok(rt_replay_ask(&replay, part, &again, error));
        assert_false(again.wrong);
    }
    replay.fingerprint ^= 1;
    assert_bad_input(rt_replay_ask(&replay, false, &again, error), "");
}

RT_TEST(a_replay_file_of_a_later_format_is_refused_by_its_number) {
    RtReplay replay;
    assert_ok(rt_directory_create(OUT, error));
    assert_ok(rt_json_save(OUT "/later.json", json_pack("{s:i}", "format", 2), error));
    assert_bad_input(rt_replay_load(&replay, OUT "/later.json", error), "its format is 2");
}

RT_TEST(what_is_no_replay_file_is_refused) {
    const char *const members[] = {"scene",  "fingerprint", "sampling", "accel", "query",
                                   "kernel", "stream",      "rays",     "asked"};
    const char *path = OUT "/broken.json";
    json_auto_t *rows = verify(OUT "/a", 0, RT_START_ANEW);
    RtReplay replay;
    for (size_t i = 0; i < sizeof members / sizeof members[0]; i++) {
        json_auto_t *document = json_load_file(replay_of(json_array_get(rows, 1)), 0, NULL);
        json_object_set_new(document, members[i], json_real(0.5));
        assert_int_equal(json_dump_file(document, path, 0), 0);
        assert_bad_input(rt_replay_load(&replay, path, error), members[i]);
    }
    assert_ok(rt_file_write(path, "{\n\"a\": nan}", 11, error));
    assert_bad_input(rt_replay_load(&replay, path, error), "broken.json:2");
}

static json_t *row_of(const char *scene, const char *accel, bool exact, int marginal) {
    return json_pack("{s:s, s:s, s:s, s:b, s:i, s:i, s:i, s:i, s:i, s:i, s:n, s:n, s:{s:i, s:i}}", "scene",
                     scene, "accel", accel, "against", "brute", "exact", exact, "rays", 100, "equal",
                     100 - marginal, "tie", 0, "marginal", marginal, "wrong", 0, "occluded_wrong", 0,
                     "first_wrong", "problem", "exactly_right", "both", marginal - marginal / 2, "got",
                     marginal / 2);
}

RT_TEST(rows_add_up_over_the_parameters_of_an_accelerator) {
    json_auto_t *rows =
        json_pack("[o, o, o, o, o]", row_of("balls", "item:facets=on+bvh:max_leaf_size=1,bits=6", true, 0),
                  row_of("balls", "item+bvh", true, 0), row_of("balls", "embree", false, 7),
                  row_of("tetra", "item+bvh", true, 0), row_of("tetra", "embree", true, 0));
    json_object_set_new(json_array_get(rows, 1), "problem", json_string("a leaf is not reached"));
    json_object_set_new(json_array_get(rows, 3), "occluded_wrong", json_integer(5));
    RtVerifySum *sums;
    uint32_t count;
    assert_ok(rt_verify_sums(rows, false, &sums, &count, error));
    assert_int_equal(count, 3);
    assert_string_equal(sums[0].name, "item+bvh");
    assert_int_equal(sums[0].rows, 3);
    assert_int_equal(sums[0].failed, 1);
    assert_int_equal(sums[0].pairs, 300);
    assert_true(sums[0].exact && !sums[1].exact && sums[2].exact);
    assert_int_equal(sums[1].verdicts[RT_EQUAL], 93);
    assert_int_equal(sums[1].verdicts[RT_MARGINAL], 7);
    assert_int_equal(sums[1].sides[RT_SIDE_BOTH], 4);
    assert_int_equal(sums[1].sides[RT_SIDE_GOT], 3);
    assert_int_equal(sums[0].occluded_wrong, 5);
    assert_int_equal(rt_verify_total(rows).pairs, 500);
    assert_int_equal(rt_verify_total(rows).occluded_wrong, 5);
    rt_free(sums);
    assert_ok(rt_verify_sums(rows, true, &sums, &count, error));
    assert_int_equal(count, 2);
    assert_string_equal(sums[1].name, "tetra");
    assert_int_equal(sums[1].pairs, 200);
    rt_free(sums);
    assert_ok(rt_directory_create(OUT "/e", error));
    assert_ok(rt_verify_write(rows, OUT "/e", error));
    OWNED_MEMORY char *table = text_of(OUT "/e", "verify.md");
    assert_non_null(strstr(table, "\n| `item+bvh` | 3 | 300 | 300 | 0 | 0 | 0 | 5 | 1 |\n"));
    assert_non_null(strstr(table, "\n| `embree` * | 1 | 100 | 93 | 0 | 7 | 0 | 0 | 0 |\n"));
    assert_non_null(strstr(table, "\n| `embree` | 4 | 0 | 3 | 0 | 0 |\n"));
    assert_non_null(strstr(table, "\n| `tetra` | 2 | 200 | 200 | 0 | 0 | 0 | 5 | 0 |\n"));
}

static int register_accelerators(void **state) {
    static RtAccelOps noting, losing;
    static RtKernels losing_kernels;
    (void)state;
    noting = losing = mutant_ops;
    noting.name = "noting";
    noting.build = build_noting_threads;
    losing.name = "losing";
    losing.build = NULL; /* padded boxes */
    losing_kernels = kernels;
    losing_kernels.nearest = lose_last;
    losing.kernels = &losing_kernels;
    assert_ok(rt_accel_register(&mutant_ops, error));
    assert_ok(rt_accel_register(&noting, error));
    assert_ok(rt_accel_register(&losing, error));
    return 0;
}

RT_TESTS(verify, register_accelerators, assert_nothing_is_kept)
