/* SPDX-License-Identifier: Apache-2.0 */
/* Claims and findings of an experiment, from its YAML to the report. */
#include "experiment_testing.h"

static const char claiming[] = "name: small\nquestion: Which density is best?\nprediction: Four.\n"
                               "scenes:\n"
                               "  - {scene: \"random:n=200\", size: 40x40}\n"
                               "accelerators:\n"
                               "  - {accel: bvh}\n"
                               "  - {accel: \"grid:density=1..16*4\"}\n"
                               "rays: [primary]\ncount_only: yes\nlimit: 1600\n"
                               "expect:\n"
                               "  - object_tests of grid falls with density\n"
                               "  - object_tests of bvh > 1000\n";

PLACES_WITH(claiming)

PLACE_TEST(a_false_claim_is_said_to_be_and_is_exit_code_1_if_strict) {
    assert_runs(place, "run small.yaml --out out --threads 1");
    assert_in_file(place, "output", "holds            object_tests of grid falls with density",
                   "does not hold    object_tests of bvh > 1000");
    assert_in_file(place, "out/report.html", "\"verdict\":\"does not hold\"");
    assert_ends(place, "run small.yaml --out out --threads 1 --resume --strict", 1,
                "1 of 2 claims do not hold, the first: object_tests of bvh > 1000");
    write_changed(place, "small.yaml", claiming, "bvh > 1000", "bvh < 1000");
    assert_runs(place, "run small.yaml --out out --threads 1 --resume --strict");
}

PLACE_TEST(a_figure_is_shown_with_the_claims_and_counted_with_none) {
    write_changed(place, "small.yaml", claiming, "object_tests of bvh > 1000",
                  "object_tests of bvh\n  - exponent of object_tests of grid in density");
    assert_runs(place, "run small.yaml --out out --threads 1 --strict");
    assert_in_file(place, "output", "figure           object_tests of bvh\n",
                   " over 3 values (grid on random:n=200)\n");
    assert_in_file(place, "out/report.html", "\"text\":\"object_tests of bvh\",\"verdict\":\"figure\"");
}

PLACE_TEST(a_claim_about_a_missing_plugin_has_no_measurements_and_is_no_failure) {
    write_changed(place, "missing.yaml", claiming, "bvh > 1000", "nobodys > 1000");
    OWNED_MEMORY char *text = read_in(place, "missing.yaml");
    write_changed(place, "small.yaml", text, "{accel: bvh}\n",
                  "{accel: bvh}\n  - {accel: nobodys, optional: yes}\n");
    assert_runs(place, "run small.yaml --out out --threads 1 --strict");
    assert_in_file(place, "output", "no measurements  object_tests of nobodys > 1000");
    assert_in_file(place, "out/report.html", "\"verdict\":\"no measurements\"");
}

PLACE_TEST(a_bad_claim_is_refused_with_its_line_when_the_yaml_is_read) {
    write_changed(place, "small.yaml", claiming, "bvh > 1000", "bhv > 1000");
    assert_bad_input(load_small(place, false, error),
                     ":14:5: expect[1]: 'bhv' is not the label of one of the accelerators: did you mean "
                     "'bvh'? choose one of bvh, grid, ");
}

/* What is found, and better claims, come after the run. */
PLACE_TEST(a_finding_section_and_papers_are_added_to_a_run_that_is_there_and_nothing_else_is) {
    assert_runs(place, "run small.yaml --out out --threads 1");
    write_changed(place, "small.yaml", claiming, "count_only",
                  "finding: >-\n  Four it is,\n  indeed.\nsection: papers\n"
                  "paper: {citation: \"A & B, 1988\", page: 19, quote: Four <is> best.}\ncount_only");
    assert_ends(place, "run small.yaml --out out --threads 1 --resume", 0, "nothing was left to measure");
    assert_in_file(place, "out/report.html", "<h2>Finding</h2><p>Four it is, indeed.",
                   "\"quote\":\"Four \\u003cis> best.\"");
    assert_in_file(place, "out/experiment.yaml", "section: papers");
    assert_runs(place, "report out");
    assert_runs(place, "reproduce out");
    write_changed(place, "small.yaml", claiming, "limit: 1600", "finding: Four.\nlimit: 1599");
    assert_int_equal(raytally(place, "run small.yaml --out out --threads 1 --resume"), 2);
    write_changed(place, "small.yaml", claiming, "prediction: Four.", "prediction: Five.");
    assert_int_equal(raytally(place, "run small.yaml --out out --threads 1 --resume"), 2);
}

/* One claim is new, one is gone, and one is as it was; a readout may come and go. */
PLACE_TEST(claims_that_change_after_a_run_are_shown_as_such_beside_the_original) {
    assert_runs(place, "run small.yaml --out out --threads 1");
    assert_in_file(place, "out/manifest.json", "\"object_tests of bvh > 1000\"");
    assert_not_in_file(place, "out/manifest.json", "claims_changed");
    write_changed(place, "small.yaml", claiming, "bvh > 1000", "bvh < 1000\n  - object_tests of bvh");
    assert_runs(place, "run small.yaml --out out --threads 1 --resume");
    assert_in_file(place, "output", "object_tests of bvh < 1000 [stated after the run began]",
                   "dropped since    object_tests of bvh > 1000", "object_tests of grid falls with density\n",
                   "figure           object_tests of bvh\n");
    assert_in_file(place, "out/report.html", "stated after the run began",
                   "\"dropped\":[\"object_tests of bvh > 1000\"]");
    assert_in_file(place, "out/manifest.json", "claims_changed", "\"object_tests of bvh > 1000\"");
    assert_runs(place, "report out");
    assert_in_file(place, "output", "[stated after the run began]");
    write_in(place, "small.yaml", claiming);
    assert_runs(place, "run small.yaml --out out --threads 1 --resume");
    assert_not_in_file(place, "out/manifest.json", "claims_changed");
    assert_not_in_file(place, "out/report.html", "stated after the run began");
    assert_in_file(place, "out/report.html", "\"dropped\":[]");
}

PLACE_TEST(plots_may_change_after_a_run_and_scripts_be_added_to_its_results) {
    assert_runs(place, "run small.yaml --out out --threads 1");
    write_in(place, "mine.gp", "set terminal svg\nset output \"plots/mine.svg.tmp\"\nplot 1\nunset output\n");
    write_in(place, "out/plots/later.gp",
             "set terminal svg\nset output \"plots/later.svg.tmp\"\nplot 2\nunset output\n");
    assert_int_equal(raytally(place, "plot out"), 2); /* a script of somebody */
    assert_in_file(place, "message", "later.gp: raytally does not ship this gnuplot script");
    write_changed(place, "small.yaml", claiming, "count_only", "plots: [mine.gp]\ncount_only");
    assert_ends(place, "run small.yaml --out out --threads 1 --resume", 0, "nothing was left to measure");
    assert_in_file(place, "out/plots/mine.gp", "plot 1");
    assert_runs(place, "reproduce out");
    assert_runs(place, "plot out --trust");
    if (system("gnuplot --version >/dev/null 2>&1") != 0) return;
    assert_in_file(place, "out/plots/mine.svg", "</svg>");
    assert_in_file(place, "out/plots/later.svg", "</svg>");
}

PLACE_TEST(a_bad_paper_is_refused_with_its_line) {
    static const struct {
        const char *key, *message;
    } cases[] = {
        {"paper: {citation: C, page: 1, quote: Q, verdict: partly}\n",
         ":12:50: paper.verdict: invalid value 'partly': expected confirmed, in part, not confirmed, "
         "true of its machine, not tested, or no claim"},
        {"paper: {citation: C, page: 1}\n", ":12:1: paper: 'quote' is missing"},
        {"paper: [{citation: C, page: 1, quote: Q, verdit: in part}]\n",
         ":12:42: paper[0]: unknown key 'verdit'"},
        {"paper: Glassner\n",
         ":12:8: paper: invalid value 'Glassner': expected a list of mappings with citation"},
        {"section: []\n", ":12:1: section: "},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char with[256];
        snprintf(with, sizeof with, "%sexpect:\n", cases[i].key);
        write_changed(place, "small.yaml", claiming, "expect:\n", with);
        assert_bad_input(load_small(place, false, error), cases[i].message);
    }
}

/* The finding refers to the results in `out`, which are beside these. */
PLACE_TEST(a_finding_is_filled_in_and_marked_where_it_does_not_hold) {
    assert_runs(place, "run small.yaml --out out --threads 1");
    write_changed(place, "small.yaml", claiming, "  - object_tests of bvh > 1000\n",
                  "finding: >-\n  A ray takes {object_tests of bvh as plain} tests,\n"
                  "  {as many: ratio of object_tests of bvh to bvh >= 1} as before\n"
                  "  ({from out: object_tests of bvh as plain}),\n"
                  "  and {never over a thousand: object_tests of grid > 1000}.\n"
                  "not_shown: Anything timed.\n");
    assert_runs(place, "run small.yaml --out again --threads 1");
    assert_in_file(place, "output", "\nFinding:\n", "does not hold    never over a thousand\n");
    assert_in_file(place, "again/report.html", "as many</span> as before",
                   "title=\"object_tests of grid &gt; 1000: does not hold, ",
                   "never over a thousand [does not hold]</span>",
                   "<h2>What it does not show</h2><p>Anything timed.</p>");
    assert_ends(place, "report again --strict", 1, "1 expression of the finding");
    assert_runs(place, "report again");
    assert_in_file(place, "output", "Finding:");
    assert_runs(place, "report --index .");
    assert_in_file(place, "index.md", "never over a thousand \\[does not hold\\].",
                   "Not shown: Anything timed.");
    assert_in_file(place, "index.html", "It does not show: Anything timed.");
    write_changed(place, "small.yaml", claiming, "  - object_tests of bvh > 1000\n",
                  "finding: It takes 3 tests.\n");
    assert_runs(place, "run small.yaml --out again --threads 1 --resume --strict");
    assert_in_file(place, "message", "small.yaml:14:10: finding: '3' stands outside braces");
}

PLACE_TEST(a_verdict_on_a_paper_that_its_claims_do_not_support_is_marked) {
    static const char paper[] = "paper:\n  citation: C\n  page: 1\n  quote: Q\n  verdict: confirmed\n"
                                "  modelled: as it is\n  expect: [object_tests of bvh > 1000]\ncount_only";
    write_changed(place, "small.yaml", claiming, "count_only", paper);
    OWNED_MEMORY char *text = read_in(place, "small.yaml");
    assert_runs(place, "run small.yaml --out out --threads 1");
    assert_in_file(place, "output", "not supported    'confirmed' for C: not all of its claims hold");
    assert_in_file(place, "out/report.html", "\"problem\":\"not all of its claims hold\"",
                   "\"modelled\":\"as it is\"");
    assert_int_equal(raytally(place, "report out --strict"), 1);
    write_changed(place, "small.yaml", text, "  modelled: as it is\n", "");
    assert_runs(place, "run small.yaml --out out --threads 1 --resume");
    assert_in_file(place, "message", "paper.verdict: 'confirmed' needs `modelled`");
    write_changed(place, "small.yaml", text, "page: 1", "page: unseen");
    assert_runs(place, "run small.yaml --dry-run");
    assert_in_file(place, "message", "paper.verdict: a paper that was not at hand");
    write_changed(place, "small.yaml", text, "  expect: [object_tests of bvh > 1000]\n", "");
    assert_runs(place, "run small.yaml --dry-run");
    assert_in_file(place, "message", "paper.verdict: this verdict needs `expect`");
    write_changed(place, "small.yaml", text, "[object_tests of bvh > 1000]", "[object_tests of bhv > 1000]");
    assert_bad_input(load_small(place, false, error), "paper.expect[0]: 'bhv' is not the label");
}

RT_TESTS(claims_run, NULL, NULL)
