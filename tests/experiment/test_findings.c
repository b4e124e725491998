/* SPDX-License-Identifier: Apache-2.0 */
/* Findings, whose expressions are filled in from results that are made by hand, and verdicts on papers. */
#include "claims_testing.h"

#include "claims/findings.h"

static RtFinding filled;

static void fill(const char *finding) {
    rt_finding_clear(&filled);
    strcpy(e->finding, finding);
    assert_ok(rt_finding_check(e, e->finding, error));
    assert_ok(rt_finding_fill(&results, "nowhere", &filled, error));
}

static void reads(const char *finding, const char *text) {
    fill(finding);
    OWNED_MEMORY char *found = rt_finding_text(&filled);
    assert_string_equal(found, text);
}

static int tear_down_findings(void **state) {
    rt_finding_clear(&filled);
    return tear_down(state);
}

RT_TEST(figures_are_filled_into_a_finding) {
    set_all();
    reads("On n=10 bvh takes {time of bvh on random:n=10 for primary rays}, the grids "
          "{object_tests of grid for primary rays as plain} tests.",
          "On n=10 bvh takes 102 [100, 104] ns, the grids 3.30 to 10.0 tests.");
    assert_int_equal(filled.count, 5);
    assert_int_equal(filled.segments[1].mark, RT_FINDING_FIGURE);
    assert_string_equal(
        filled.segments[1].note,
        "time of bvh on random:n=10 for primary rays: figure, 102 [100, 104] ns (bvh on random:n=10)");
    reads("{\"16 of 1987\"} and no more", "16 of 1987 and no more");
    reads("It is {fastest on random:n=10}, in {count of bvh is fastest} cells",
          "It is bvh, in 2 of 8, 2 undecided cells");
    reads("", "");
}

RT_TEST(words_whose_claim_does_not_hold_or_is_undecided_are_marked) {
    set_all();
    reads("The grid is {always dearer: ratio of object_tests of grid to bvh > 1}.",
          "The grid is always dearer.");
    assert_int_equal(filled.segments[1].mark, RT_FINDING_UPHELD);
    reads("It {never wins: ratio of time of bvh to grid:density=1 < 1}!", "It never wins [does not hold]!");
    assert_int_equal(filled.broken, 1);
    assert_non_null(strstr(filled.segments[1].note, "< 1: does not hold, "));
    reads("It {may win: time of bvh on random:n=10 < 103}", "It may win [undecided]");
    assert_non_null(strstr(filled.segments[1].note, ": undecided, "));
    assert_int_equal(rt_findings_check(&results, "nowhere", NULL), RT_MISMATCH);
    reads("It {wins on random: time of bvh on random < 500}", "It wins on random");
    assert_ok(rt_findings_check(&results, "nowhere", error));
}

RT_TEST(a_figure_of_what_is_less_is_marked_where_it_may_be_more) {
    set_all();
    reads("{ratio of object_tests of bvh to grid:density=1 on balls for primary rays as percent less} tests",
          "77.0 % less tests");
    reads("{ratio of object_tests of bvh to grid:density=1 on balls for primary rays as percent more}",
          "-77.0 % more [not surely so]");
    fill("{ratio of time of bvh to grid:density=1 on random:n=100 for primary rays as percent less}");
    assert_int_equal(filled.broken, 1); /* 200 to 208 ns of 200 to 215 */
}

RT_TEST(what_was_not_measured_is_said_and_breaks_nothing) {
    set_all();
    for (uint32_t k = 0; k < 2; k++) *rt_cell_at(&results, 3, 0, (RtRayKind)k) = (RtCell){0};
    reads("{steps of bvh on balls} steps, {few on balls: object_tests of bvh on balls < 3}",
          "unknown [no measurements] steps, few on balls [no measurements]");
    assert_int_equal(filled.broken, 0);
    reads("{object_tests of bvh}", "2.00 to 2.20 [values missing]"); /* some are unknown */
    assert_int_equal(filled.broken, 1);
    reads("{from nobody: time of bvh} and {from nobody: less: time of bvh < 3}",
          "unknown [no results] and less [no results]");
}

RT_TEST(the_claims_of_a_finding_count_in_the_correction_for_many) {
    uint32_t count;
    set_all();
    strcpy(e->finding,
           "{a: time of bvh > 1} {b: steps of bvh > 1} {time of grid} {from x: c: time of bvh > 1} "
           "{d: bvh is fastest on balls} {count of time of bvh on balls > 1}");
    e->claim_count = 0;
    rt_claims_coverage(&results, &count);
    assert_int_equal(count, 4 * 2 + 3 * 2 + 2); /* scenes or other accelerators, kinds of rays */
}

RT_TEST(an_expression_that_is_none_or_is_narrower_than_its_words_is_refused) {
    static const char *const cases[][2] = {
        {"a {time of bvh", "'{time of bvh': braces do not match"},
        {"a} b", "'} b': braces do not match"},
        {"{a {time of bvh}}", "they cannot be nested"},
        {"{\"12}", "a quotation mark is missing"},
        {"{from prediction time of bvh}", "expected {from NAME: ...}"},
        {"{from ../x: time of bvh}", "'../x' is not the name of an experiment"},
        {"{time of bhv}", "did you mean 'bvh'?"},
        {"{fast: time of bvh}", "'time of bvh' is a figure, which has no words: write {time of bvh}"},
        {"{time of bvh < 5}", "'time of bvh < 5' is a claim: write {WORDS: time of bvh < 5}"},
        {"{bvh is always fastest: bvh is fastest on balls}",
         "the words 'bvh is always fastest' are general, and the claim is only about 'balls': name it in the "
         "words"},
        {"{Never: time of bvh for shadow rays > 5}", "only about 'shadow'"},
        {"{everywhere, on balls: time of bvh on balls at n=10 > 5}", "only about 'n'"},
        {"{nothing: ratio of time of bvh on balls to bvh on random:n=10 > 1}", "only about 'balls'"},
        {"{5 times: ratio of time of bvh to grid:density=1 > 6}", "'5' is not the number of the claim"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        assert_bad_input(rt_finding_check(e, cases[i][0], error), cases[i][1]);
    assert_ok(rt_finding_check(
        e, "{never on balls for shadow rays: time of bvh on balls for shadow rays > 1}", error));
    assert_ok(rt_finding_check(e, "{always at n=10: time of bvh at n=10 > 1}", error));
    assert_ok(rt_finding_check(e, "{faster: time of bvh on balls > 1}", error)); /* claims nothing general */
    assert_ok(rt_finding_check(e, "{6 times: ratio of time of bvh to grid:density=1 > 6}", error));
    assert_ok(rt_finding_check(e, "{always: time of bvh for all rays > 1}", error));
}

RT_TEST(numbers_and_general_words_stand_in_braces) {
    static const char *const cases[][2] = {
        {"It takes 1.4 times as long.", "'1.4' stands outside braces: write the figure as an expression"},
        {"It grows as n^0.87.", "'n^0.87'"},
        {"a (43 %)", "'43'"},
        {"a ({time of bvh}), and 5", "'5'"},
        {"in 1988", "'1988'"},
        {"It is always so.", "'always' stands outside braces: write {WORDS: CLAIM}"},
        {"Nothing, and \"Everywhere\"", "'Nothing'"},
        {"The `octree` is fastest:", "'fastest'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        assert_bad_input(rt_finding_check_bound(cases[i][0], error), cases[i][1]);
    assert_ok(rt_finding_check_bound(
        "With AVX-512 on x86-64, `octree:max_leaf=16` and n=1000 (Goldsmith, 1987; 2003) "
        "take {time of bvh on random:n=10}, {\"3 times\"}, {always: time of bvh > 1}.",
        error));
}

RT_TEST(a_verdict_on_a_paper_rests_on_its_claims) {
    RtPaper *paper = &e->papers[0];
    set_all();
    *e->finding = '\0';
    e->paper_count = 1;
    *paper = (RtPaper){.verdict = RT_PAPER_CONFIRMED};
    assert_string_equal(rt_paper_problem(&results, paper), "it names no claims that it rests on");
    strcpy(e->claims[0], "time of bvh > 1");
    strcpy(e->claims[1], "time of bvh < 1");
    e->claim_count = 2;
    paper->claim_count = 1;
    assert_string_equal(rt_paper_problem(&results, paper), "");
    paper->verdict = RT_PAPER_IN_PART;
    assert_string_equal(rt_paper_problem(&results, paper), "all of its claims hold");
    paper->claim_count = 2;
    assert_string_equal(rt_paper_problem(&results, paper), "");
    paper->verdict = RT_PAPER_CONFIRMED;
    assert_string_equal(rt_paper_problem(&results, paper), "not all of its claims hold");
    paper->verdict = RT_PAPER_NOT_CONFIRMED;
    assert_string_equal(rt_paper_problem(&results, paper), "");
    paper->verdict = RT_PAPER_IN_PART;
    paper->first_claim = paper->claim_count = 1;
    assert_string_equal(rt_paper_problem(&results, paper), "none of its claims holds");
    paper->verdict = RT_PAPER_NOT_TESTED;
    assert_string_equal(rt_paper_problem(&results, paper), "");
    e->paper_count = 0;
}

RT_TESTS(findings, set_up, tear_down_findings)
