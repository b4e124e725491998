/* SPDX-License-Identifier: Apache-2.0 */
/* literature/published.h: how figures are judged, against tolerances, reasons and ours. */
#include "published_testing.h"

#include "core/text/csv.h"
#include "report/report.h"

/* Runs the experiment with these rows and reasons into DIR/out, and gives what the check says. */
static RtStatus run(const Place *place, const char *rows, const char *reasons, bool quick, RtError *error) {
    const RtRunOptions how = {.start = RT_START_ANEW, .report = &rt_run_report};
    write_figures(place, rows);
    write_reasons(place, reasons);
    return run_small(place, "out", quick, how, error);
}

static void assert_agrees(const Place *place, const char *rows, const char *reasons) {
    assert_ok(run(place, rows, reasons, false, error));
}

static void assert_differs(const Place *place, const char *rows, const char *reasons, bool quick,
                           const char *says) {
    assert_fails_with(run(place, rows, reasons, quick, error), RT_MISMATCH, says);
}

RT_TEST_IN_PLACE(a_figure_within_its_tolerance_is_taken_and_one_outside_is_not) {
    const Place *place = *state;
    assert_agrees(place, "balls,s,Loop,,all,ray,,11.2,\nballs,s,Grid,4x4x4,cells,,64,,\n", "");
    assert_in_file(place, "out/published.csv", "balls,s,Loop,,all,object_tests,ray,11.2,11,-1.79,3,yes,\n");
    assert_in_file(place, "out/published.csv", "balls,s,Grid,4x4x4,cells,leaves,,64,64,0.00,1,yes,\n");
    assert_differs(place, "balls,s,Loop,,all,ray,,11.2,\nballs,s,Loop,of 3,all,ray,,12.0,\n", "", false,
                   "object_tests of Loop of 3 on balls is 11, published is 12.0");
    assert_in_file(place, "out/published.csv",
                   "balls,s,Loop,of 3,all,object_tests,ray,12.0,11,-8.33,3,no,\n");
    assert_in_file(place, "out/report.html", "class=\"missed\"");
    assert_in_file(place, "out/published.md", "**11 (-8.3 %)**");
}

RT_TEST_IN_PLACE(half_a_unit_of_the_last_digit_is_within_but_not_of_a_whole_number) {
    const Place *place = *state;
    change_experiment(place, "object_tests: 3", "object_tests: 0.5");
    assert_agrees(place, "balls,s,Loop,,all,ray,,11.1,\n", ""); /* 0.1 <= 0.0555 + 0.05 */
    assert_differs(place, "balls,s,Loop,,all,ray,,11.10,\n", "", false, "published is 11.10");
    assert_agrees(place, "balls,s,Loop,,all,ray,,11,\n", "");
    assert_differs(place, "balls,s,Grid,4x4x4,cells,,65,,\n", "", false, "leaves");
}

RT_TEST_IN_PLACE(a_reason_excuses_what_it_is_about_and_a_stale_one_fails) {
    const Place *place = *state;
    const char *rows = "balls,s,Loop,,all,ray,,12.0,\nballs,s,Grid,,cells,,64,,\n";
    assert_agrees(place, rows, "b*,s,all,object_tests,\"he tests one more, twice\"\n");
    assert_in_file(place, "out/published.csv", ",no,\"he tests one more, twice\"\n");
    assert_in_file(place, "out/published.md", "he tests one more");
    assert_differs(place, rows, "balls,s,all,object_tests,why\nballs,s,cells,*,why\n", false,
                   "reasons.csv:3: no figure needs this reason");
    assert_differs(place, rows, "balls,other,all,*,why\n", false, "without a reason");
}

RT_TEST_IN_PLACE(tests_per_hit_are_divided_by_the_rays_that_hit) {
    const Place *place = *state;
    char rows[128];
    RtCsv counts;
    assert_agrees(place, "", "");
    assert_ok(rt_csv_read(&counts, path_in(place, "out/counts.csv").text, error));
    uint32_t last = counts.rows - 1; /* cells on cloud */
    assert_string_equal(rt_csv_field(&counts, last, rt_csv_find(&counts, "accel")), "cells");
    int hits = atoi(rt_csv_field(&counts, last, rt_csv_find(&counts, "hits")));
    int tests = atoi(rt_csv_field(&counts, last, rt_csv_find(&counts, "object_tests")));
    rt_csv_clear(&counts);
    assert_true(0 < hits && hits < 16 && tests > 0);
    snprintf(rows, sizeof rows, "cloud,s,Grid,,cells,hit,,%.4f,\n", (double)tests / hits);
    assert_agrees(place, rows, "");
    snprintf(rows, sizeof rows, "cloud,s,Grid,,cells,ray,,%.4f,\n", tests / 16.0);
    assert_agrees(place, rows, "");
    snprintf(rows, sizeof rows, "cloud,s,Grid,,cells,hit,,%.4f,\n", tests / 16.0);
    assert_differs(place, rows, "", false, "object_tests");
}

RT_TEST_IN_PLACE(rays_are_compared_where_a_table_has_no_accelerator) {
    const Place *place = *state;
    assert_agrees(place, "", "");
    change_experiment(place, "figures.csv", "numbers.csv");
    write_in(place, "numbers.csv", "scene,source,primary\nballs,s,64\ncloud,s,15\n");
    assert_differs(place, "", "", false, "primary of s on cloud is 16, published is 15");
    assert_in_file(place, "out/published.csv", "balls,s,,,,primary,,64,64,0.00,1,yes,\n");
}

RT_TEST_IN_PLACE(a_row_that_nothing_measures_is_shown_and_not_judged) {
    const Place *place = *state;
    assert_agrees(place, "balls,s,Tree,,,ray,,12.0,3.5\n", "");
    assert_in_file(place, "out/published.csv", "balls,s,Tree,,,object_tests,ray,12.0,,,3,,\n");
}

RT_TEST_IN_PLACE(the_quick_variant_judges_structures_alone) {
    const Place *place = *state;
    assert_ok(run(place, "balls,s,Loop,,all,ray,,12.0,\n", "*,*,*,*,stale\n", true, error));
    assert_differs(place, "balls,s,Grid,,cells,,60,,\n", "", true, "leaves");
}

RT_TEST_IN_PLACE(ours_must_need_less_than_every_published_row) {
    const Place *place = *state;
    change_experiment(place, "  reasons:", "  ours: [all]\n  reasons:");
    const char *ahead = "balls,s,Tree,deep,,ray,,12.0,3.5\nballs,s,Tree,flat,,ray,,13.0,1.5\n";
    assert_agrees(place, ahead, "");
    assert_in_file(place, "out/best.csv", "balls,object_tests,Tree deep,12,all,11,");
    assert_in_file(place, "out/best.csv", "balls,object_tests+steps,Tree flat,14.5,all,");
    /* A bar in a name is none of the table's. */
    assert_agrees(place, "balls,s,Tree|deep,,,ray,,12.0,3.5\n", "");
    assert_in_file(place, "out/published.md", "| balls | object_tests | Tree\\|deep | 12 | `all` |");
    /* Per hit it is less than 11 a ray. */
    assert_differs(place, "balls,s,Tree,deep,,hit,,11.0,3.5\n", "", false, "on balls none of ours is better");
}

/* bvh tests few objects and many extents, of which published rows count none. */
RT_TEST_IN_PLACE(ours_that_needs_more_with_its_extent_tests_is_said_to) {
    const Place *place = *state;
    change_experiment(place, "  reasons:", "  ours: [bvh]\n  reasons:");
    assert_agrees(place, "balls,s,Tree,,,ray,,3.0,30\n", "");
    assert_in_file(place, "out/published.md",
                   " | fewer, but **more with extent tests** |\n| balls | object_tests+steps |");
    assert_in_file(place, "out/report.html", "fewer, but <b>more with extent tests</b>");
    assert_in_file(place, "out/published.md", " | fewer, also with extent tests |\n");
}

RT_TESTS(published_figures, NULL, NULL)
