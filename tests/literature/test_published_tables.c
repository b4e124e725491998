/* SPDX-License-Identifier: Apache-2.0 */
/* literature/published.h: tables and reasons that are refused, and what is written to a result directory. */
#include "published_testing.h"

#include "literature/published.h"

/* ---- tables ---- */

/* Loads the experiment and what it names, and clears what is loaded. */
static RtStatus load(const Place *place, RtError *error) {
    RtPublished published;
    RT_TRY(load_small(place, false, error));
    RtStatus status = rt_published_load(&published, place->experiment, error);
    rt_published_clear(&published);
    return status;
}

RT_TEST_IN_PLACE(what_a_published_table_or_a_reason_says_wrongly_is_told_with_its_line) {
    const Place *place = *state;
    const struct {
        const char *file, *text, *says;
    } cases[] = {
        {"figures.csv", "scene,source,accel,tests_per,stpes\n",
         "no such column 'stpes': did you mean 'steps'"},
        {"figures.csv", "scene,source,accel,steps,steps\n", "more than one column 'steps'"},
        {"figures.csv", "scene,steps\n", "columns scene and source"},
        {"figures.csv", "scene,source,accel,steps\nball,s,all,1\n",
         "figures.csv:2: small has no scene with the label 'ball'"},
        {"figures.csv", "scene,source,accel,steps\n\ncloud,s,all,1\n",
         "figures.csv:3: small has no accelerator with the label 'all' on the scene cloud"},
        {"figures.csv", "scene,source,accel,steps\nballs,s,null,1\n", "label 'null'"},
        {"figures.csv", "scene,source,accel,steps\nballs,s,all,-1\n", ":2: steps: '-1' is not a figure"},
        {"figures.csv", "scene,source,accel,steps\nballs,s,all,1e5\n", "'1e5' is not a figure"},
        {"figures.csv", "scene,source,accel,steps\nballs,s,all,1.2.3\n", "'1.2.3' is not a figure"},
        {"figures.csv", "scene,source,accel,object_tests\nballs,s,all,1\n",
         ":2: tests_per: invalid value ''"},
        {"figures.csv", "scene,source,accel,tests_per,object_tests\nballs,s,all,day,1\n",
         ":2: tests_per: invalid value 'day'"},
        {"figures.csv", "scene,source,steps\nballs,s,1\n", ":2: steps: the table needs a column accel"},
        {"figures.csv", "scene,source,accel,primary\nballs,s,all,1\n",
         ":2: primary: a row with an accelerator"},
        {"reasons.csv", "scene,source,accel,reason\n", "the column 'column' is missing"},
        {"reasons.csv", "scene,source,accel,column,reason\n*,*,*,*, \n",
         "reasons.csv:2: the reason is missing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_figures(place, "");
        write_reasons(place, "");
        write_in(place, cases[i].file, cases[i].text);
        assert_bad_input(load(place, error), cases[i].says);
    }
}

RT_TEST_IN_PLACE(what_the_experiment_says_wrongly_about_published_figures_is_told_with_its_line) {
    const Place *place = *state;
    const char *const cases[][3] = {
        {"scenes: [balls]", "scenes: [ball]", ":9:"},
        {"scenes: [cloud]", "scenes: [cloud, balls]", ":11:"}, /* 'cells' twice on balls */
        {"[figures.csv]", "[../figures.csv]", ":12:"},
        {"[figures.csv]", "[published.csv]", ":12:"}, /* which the run would write over */
        {"[figures.csv]", "[/figures.csv]", ":12:"},
        {"leaves: 1", "leaves: -1", ":15:23: published.tolerance.leaves: invalid value '-1'"},
        {"leaves: 1", "leafs: 1", ":15:"},
        {"count_only: yes", "count_only: perhaps", ":17:"},
        {"  reasons: reasons.csv\n", "  ours: [bvh, kd]\n", ":14:"},
        {"count_only: yes", "baseline: all", ":17:"}, /* not on every scene */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        change_experiment(place, cases[i][0], cases[i][1]);
        write_figures(place, "");
        assert_bad_input(load(place, error), cases[i][2]);
    }
}

RT_TEST_IN_PLACE(a_published_table_that_does_not_fit_into_memory_is_refused) {
    const Place *place = *state;
    write_figures(place, "balls,s,t,u,all,ray,,11,\n");
    write_reasons(place, "*,*,*,*,why\n");
    assert_fails_cleanly(load(place, error), (void)0);
}

/* ---- directories ---- */

RT_TEST_IN_PLACE(reproduce_compares_published_figures_and_checks_them) {
    const Place *place = *state;
    const char *rows = "balls,s,Loop,,all,ray,,11.0,\n";
    write_figures(place, rows);
    assert_int_equal(raytally(place, "run small.yaml --out out"), 0);
    assert_int_equal(raytally(place, "reproduce out"), 0);
    assert_in_file(place, "output", "out/published.csv");
    assert_int_equal(raytally(place, "report out"), 0);
    assert_int_equal(raytally(place, "run small.yaml --out out --resume"), 0);

    write_figures(place, "balls,s,Loop,,all,ray,,11.1,\n");
    assert_ends(place, "reproduce out", 1, "published.csv:2: differs");

    write_figures(place, "balls,s,Loop,,all,ray,,21.0,\n");
    assert_ends(place, "run small.yaml --out out --force", 1, "without a reason");
    assert_int_equal(raytally(place, "reproduce out"), 1);
    write_figures(place, "balls,s,Loop,,any,ray,,21.0,\n");
    assert_int_equal(raytally(place, "run small.yaml --out out --force"), 2);
}

RT_TEST_IN_PLACE(a_candidate_is_counted_on_its_scenes_alone_and_one_label_serves_on_several) {
    const Place *place = *state;
    write_figures(place, "");
    assert_int_equal(raytally(place, "run small.yaml --out out"), 0);
    char *counts = read_in(place, "out/counts.csv"), *journal = read_in(place, "out/cells.jsonl");
    assert_null(strstr(strstr(counts, "\ncloud,"), ",all,"));
    assert_non_null(strstr(counts, ",cells,\"grid:rule=cubic,density=4,resolution=4x4x4"));
    assert_non_null(strstr(counts, ",cells,\"grid:rule=cubic,density=4,resolution=2x2x2"));
    assert_null(strstr(journal, "\"null\"")); /* nothing is timed */
    assert_int_equal(raytally(place, "run small.yaml --out out --resume"), 0);
    assert_same_file(place, "out/cells.jsonl", journal);
    rt_free(counts);
    rt_free(journal);
    assert_false(rt_file_exists(path_in(place, "out/times.csv").text));
}

RT_TESTS(published_tables, NULL, NULL)
