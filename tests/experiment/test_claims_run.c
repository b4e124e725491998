/* SPDX-License-Identifier: Apache-2.0 */
/* Claims and findings of an experiment, from its YAML to the report. */
#include "experiment_testing.h"

static const char claiming[] = "name: small\n"
                               "question: Which density is best?\n"
                               "prediction: Four.\n"
                               "scenes:\n"
                               "  - {scene: \"random:n=200\", size: 12x12}\n"
                               "accelerators:\n"
                               "  - {accel: bvh}\n"
                               "  - {accel: \"grid:density=1..16*4\"}\n"
                               "rays: [primary]\n"
                               "count_only: yes\n"
                               "limit: 100\n"
                               "expect:\n"
                               "  - object_tests of grid falls with density\n"
                               "  - object_tests of bvh > 1000\n";

static int make_claiming(void **state) {
    return make_place_with(state, claiming);
}

#define RT_TEST_IN_PLACE(name) RT_TEST_WITH(name, make_claiming, remove_place)

RT_TEST_IN_PLACE(a_false_claim_is_said_to_be_and_is_exit_code_1_if_strict) {
    const Place *place = *state;
    assert_int_equal(raytally(place, "run small.yaml --out out --threads 1"), 0);
    assert_in_file(place, "output", "holds            object_tests of grid falls with density");
    assert_in_file(place, "output", "does not hold    object_tests of bvh > 1000");
    assert_in_file(place, "out/report.html", "does not hold");
    assert_ends(place, "run small.yaml --out out --threads 1 --resume --strict", 1,
                "1 of 2 claims do not hold, the first: object_tests of bvh > 1000");
    write_changed(place, "small.yaml", claiming, "bvh > 1000", "bvh < 1000");
    assert_int_equal(raytally(place, "run small.yaml --out out --threads 1 --resume --strict"), 0);
}

RT_TEST_IN_PLACE(a_figure_is_shown_with_the_claims_and_counted_with_none) {
    const Place *place = *state;
    write_changed(place, "small.yaml", claiming, "object_tests of bvh > 1000",
                  "object_tests of bvh\n  - exponent of object_tests of grid in density");
    assert_int_equal(raytally(place, "run small.yaml --out out --threads 1 --strict"), 0);
    assert_in_file(place, "output", "figure           object_tests of bvh\n");
    assert_in_file(place, "output", " over 3 values (grid on random:n=200)\n");
    assert_in_file(place, "out/report.html",
                   "<span class=\"verdict readout\">figure</span> object_tests of bvh");
    assert_in_file(place, "out/report.html", "\"verdict holds\">1 of 1 claim holds</span>");
}

RT_TEST_IN_PLACE(a_claim_about_a_missing_plugin_has_no_measurements_and_is_no_failure) {
    const Place *place = *state;
    write_changed(place, "missing.yaml", claiming, "bvh > 1000", "nobodys > 1000");
    char *text = read_in(place, "missing.yaml");
    write_changed(place, "small.yaml", text, "{accel: bvh}\n",
                  "{accel: bvh}\n  - {accel: nobodys, optional: yes}\n");
    rt_free(text);
    assert_int_equal(raytally(place, "run small.yaml --out out --threads 1 --strict"), 0);
    assert_in_file(place, "output", "no measurements  object_tests of nobodys > 1000");
    assert_in_file(place, "out/report.html", "1 of 2 claims hold, 1 without measurements");
}

RT_TEST_IN_PLACE(a_bad_claim_is_refused_with_its_line_when_the_yaml_is_read) {
    const Place *place = *state;
    write_changed(place, "small.yaml", claiming, "bvh > 1000", "bhv > 1000");
    assert_bad_input(
        load_small(place, false, error),
        ":14:5: expect[1]: 'bhv' is not the label of one of the accelerators: choose one of bvh, grid, ");
}

/* What is found, and better claims, come after the run. */
RT_TEST_IN_PLACE(a_finding_is_added_to_a_run_that_is_there_and_nothing_else_is) {
    const Place *place = *state;
    assert_int_equal(raytally(place, "run small.yaml --out out --threads 1"), 0);
    write_changed(place, "small.yaml", claiming, "count_only",
                  "finding: >-\n  Four it is,\n  indeed.\ncount_only");
    assert_ends(place, "run small.yaml --out out --threads 1 --resume", 0, "nothing was left to measure");
    assert_in_file(place, "out/report.html", "<h2>Finding</h2><p>Four it is, indeed.");
    assert_int_equal(raytally(place, "report out"), 0);
    assert_int_equal(raytally(place, "reproduce out"), 0);
    write_changed(place, "small.yaml", claiming, "limit: 100", "finding: Four.\nlimit: 99");
    assert_int_equal(raytally(place, "run small.yaml --out out --threads 1 --resume"), 2);
    write_changed(place, "small.yaml", claiming, "prediction: Four.", "prediction: Five.");
    assert_int_equal(raytally(place, "run small.yaml --out out --threads 1 --resume"), 2);
}

RT_TESTS(claims_run, NULL, NULL)
