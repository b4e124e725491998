/* SPDX-License-Identifier: Apache-2.0 */
/* Labels of any length: whole in files, shortened on a screen without what all have in common, unique as
 * names of files. */
#include "experiment_testing.h"

#include "core/base/words.h"

#include <strings.h>

#define SCENE "random:n=50,distribution=clustered,shape=triangle,width="
#define SPEC  "kd:traversal_cost=0.3,empty_bonus=0.2,max_leaf_size=0,max_depth="

static void add_scenes(const Place *place, const char *spec) {
    assert_ok(rt_experiment_add_scenes(place->experiment, &(RtWorkload){.depth = 1}, spec, "", error));
}

static void add_accels(const Place *place, const char *spec) {
    RtCandidate like = {.ray_stride = 1};
    strcpy(like.spec, spec);
    assert_ok(rt_experiment_add_accels(place->experiment, &like, error));
}

/* The experiment of the place, with a baseline. */
static RtExperiment *begin(const Place *place) {
    RtExperiment *e = place->experiment;
    rt_experiment_init(e);
    strcpy(e->name, "labels");
    return e;
}

static void check(RtExperiment *e) {
    char where[RT_MAX_LABEL];
    rt_experiment_set_baseline(e, NULL);
    assert_ok(rt_experiment_check(e, where, error));
}

PLACES_WITH(NULL)

PLACE_TEST(a_sweep_of_a_long_spec_has_labels_that_are_whole_and_differ) {
    RtExperiment *e = begin(place);
    add_scenes(place, SCENE "0.0125|0.025");
    add_accels(place, SPEC "10|12");
    check(e);
    assert_string_equal(e->workloads[0].label, SCENE "0.0125");
    assert_string_equal(e->workloads[1].label, SCENE "0.025");
    assert_string_equal(e->candidates[0].label, SPEC "10");
    assert_string_equal(e->candidates[1].label, SPEC "12");
    assert_string_equal(e->candidates[1].shown, "kd:...,max_depth=12");
}

PLACE_TEST(a_label_that_is_too_long_with_its_swept_values_is_refused) {
    RtCandidate like = {.ray_stride = 1, .spec = "grid:density=1|2"};
    memset(like.label, 'l', RT_MAX_LABEL - 8);
    assert_bad_input(rt_experiment_add_accels(begin(place), &like, error), "give a short `label`");
}

PLACE_TEST(files_have_whole_labels_and_csv_and_json_call_them_alike) {
    static const char row[] = "\"" SCENE "0.025\",\"" SCENE "0.025\",50,";
    assert_runs(place, "bench '" SCENE "0.0125|0.025' -a '" SPEC
                       "10|12' --rays random --limit 50 --count-only --csv counts.csv --json");
    assert_in_file(place, "counts.csv", row, ",\"" SPEC "12\",\"" SPEC "12,");
    assert_in_file(place, "output", "\"scene\": \"" SCENE "0.025\"", "\"scene_spec\": \"" SCENE "0.025\"",
                   "\"accel\": \"" SPEC "12\"", "\"spec\": \"" SPEC "12,");
    assert_runs(place, "render balls --accel grid --size 4x4 -o a.png --stats stats.json");
    assert_in_file(place, "stats.json", "\"accel\": \"grid\"", "\"spec\": \"grid:rule=");
    assert_runs(place, "trace balls --pixel 1,1 --size 4x4 --accel grid --json");
    assert_in_file(place, "output", "\"accel\": \"grid\"", "\"spec\": \"grid:rule=");
}

static const char two_files[] =
    "name: small\nquestion: q\nprediction: p\n"
    "scenes: [{scene: \"" SCENE "0.0125|0.025\", size: 4x4},\n"
    "  {scene: \"s\xc3\xa4.off\", size: 4x4}, {scene: \"s\xc3\xb6.off\", size: 4x4}]\n"
    "accelerators: [{accel: \"" SPEC "10|12\"}]\n"
    "rays: [primary]\ncount_only: yes\n";

static void run_files(const Place *place) {
    static const char triangle[] = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
    write_in(place, "s\xc3\xa4.off", triangle);
    write_in(place, "s\xc3\xb6.off", triangle);
    write_in(place, "small.yaml", two_files);
    assert_runs(place, "run small.yaml --out out");
}

PLACE_TEST(a_run_with_long_labels_writes_them_whole_and_reads_them_again) {
    run_files(place);
    assert_in_file(place, "out/cells.jsonl", "\"scene\":\"" SCENE "0.025\",\"accel\":\"" SPEC "12\"");
    assert_in_file(place, "out/manifest.json", "\"accel\": \"" SPEC "12\"", "\"spec\": \"" SPEC "12\"",
                   "\"scene_spec\": \"" SCENE "0.025\"");
    assert_in_file(place, "out/counts.csv", "\"" SPEC "12\"");
    assert_in_file(place, "out/report.html", SPEC "12");
    assert_in_file(place, "output", "kd:...,max_depth=12");
    assert_runs(place, "report out");
    assert_runs(place, "reproduce out");
    assert_runs(place, "run small.yaml --out out --resume");
}

/* Each letter outside ASCII is two bytes. */
PLACE_TEST(files_whose_names_differ_in_letters_outside_ascii_have_labels_and_files_of_their_own) {
    run_files(place);
    assert_in_file(place, "out/counts.csv", "\ns__,s\xc3\xa4.off,", "\ns__-2,s\xc3\xb6.off,");
    assert_true(rt_file_exists(path_in(place, "out/images/s__.png").text));
    assert_true(rt_file_exists(path_in(place, "out/images/s__-2.png").text));
}

PLACE_TEST(names_of_files_are_short_enough_and_differ) {
    RtExperiment *e = begin(place);
    RtWorkload like = {.depth = 1};
    for (int i = 0; i < 2; i++) {
        memset(like.label, 'l', 300);
        strcpy(like.label + 300, i ? "one" : "two");
        assert_ok(rt_experiment_add_scenes(e, &like, "balls", "", error));
    }
    strcpy(like.label, "a:b");
    assert_ok(rt_experiment_add_scenes(e, &like, "balls", "", error));
    strcpy(like.label, "A*B");
    assert_ok(rt_experiment_add_scenes(e, &like, "balls", "", error));
    add_accels(place, "bvh");
    check(e);
    for (uint32_t t = 0; t < 4; t++) {
        assert_true(strlen(e->workloads[t].file_name) <= 200);
        for (uint32_t other = 0; other < t; other++)
            assert_int_not_equal(strcasecmp(e->workloads[t].file_name, e->workloads[other].file_name), 0);
    }
}

/* ---- on a screen ---- */

static void expect_short(const char *const *names, size_t count, size_t width, const char *const *wanted) {
    for (size_t i = 0; i < count; i++) {
        char text[256];
        rt_shorten_name(names, count, i, width, text, sizeof text);
        assert_string_equal(text, wanted[i]);
    }
}

RT_TEST(a_screen_shows_what_differs_and_leaves_out_what_is_common) {
    const char *const names[] = {"grid", "kd:cost=1,depth=10,mailbox=on", "kd:cost=1,depth=10,mailbox=off",
                                 "kd:cost=1,depth=12,mailbox=on", "item+kd:cost=1,depth=12,mailbox=on"};
    const char *const wanted[] = {"grid", "kd:...,depth=10,mailbox=on", "kd:...,depth=10,mailbox=off",
                                  "kd:...,depth=12,mailbox=on", "item+..."};
    expect_short(names, 5, 20, wanted);
    expect_short(names, 5, 40, names);
}

RT_TEST(a_long_name_without_parts_is_cut_in_the_middle_unless_it_differs_there) {
    const char *const names[] = {"abcdefghijklmnopqrstuvwxyz", "abcdefghijkl1mnopqrstuvwxyz0"};
    const char *const wanted[] = {"abcde...yz", "abcde...z0"};
    const char *const same[] = {"abcdefghijkl1nopqrstuvwxyz", "abcdefghijkl2nopqrstuvwxyz"};
    expect_short(names, 2, 10, wanted);
    expect_short(same, 2, 10, same);
}

/* ---- results of version 1.0 ---- */

PLACE_TEST(labels_that_version_1_0_cut_are_found) {
    RtExperiment *e = begin(place);
    char cut[RT_MAX_LABEL];
    add_scenes(place, "balls");
    add_scenes(place, SCENE "0.025");
    add_accels(place, SPEC "10|12");
    check(e);
    snprintf(cut, sizeof cut, "%.47s", SCENE "0.025");
    assert_int_equal(rt_workload_find(e, cut), 1);
    snprintf(cut, sizeof cut, "%.47s", SPEC "10");
    assert_int_equal(rt_candidate_find(e, cut, 0), 0);
    snprintf(cut, sizeof cut, "%.40s...2", SPEC "12");
    assert_int_equal(rt_candidate_find(e, cut, 0), 1);
    snprintf(cut, sizeof cut, "%.40s...3", SPEC "12");
    assert_int_equal(rt_candidate_find(e, cut, 0), 3);
    assert_int_equal(rt_candidate_find(e, SPEC "12", 0), 1);
}

RT_TEST(the_manifest_of_version_1_0_names_labels_and_specs_otherwise) {
    static const char *const texts[] = {
        "{\"accelerators\": [{\"label\": \"mine\", \"accel\": \"grid:density=4\"}]}",
        "{\"accelerators\": [{\"accel\": \"mine\", \"spec\": \"grid:density=4\"}]}"};
    for (int i = 0; i < 2; i++) {
        RtCandidate candidate = {0};
        json_auto_t *manifest = json_loads(texts[i], 0, NULL);
        assert_true(rt_manifest_candidate(manifest, 0, &candidate));
        assert_string_equal(candidate.label, "mine");
        assert_string_equal(candidate.spec, "grid:density=4");
        assert_true(rt_manifest_is_whole(manifest, "grid", "density"));
    }
}

RT_TESTS(labels, NULL, NULL)
