/* SPDX-License-Identifier: Apache-2.0 */
/* Reading the journal of a run, which somebody else may have written. */
#include "experiment_testing.h"

static const char small_experiment[] =
    "name: small\nquestion: What does it say?\nprediction: What was measured.\n"
    "scenes:\n"
    "  - {scene: \"random:n=50\", size: 16x16, depth: 2}\n"
    "accelerators:\n"
    "  - {accel: grid}\n"
    "  - {accel: bvh}\n"
    "baseline: bvh\nrounds: 3\nmilliseconds: 1\n";

static char written[1 << 16]; /* the journal of out/, as the run left it */

static int make_places(void **state) {
    if (make_place_with(state, small_experiment) != 0) return -1;
    assert_ok(load_small(*state, false, error));
    if (raytally(*state, "run small.yaml --out out") != 0) return -1;
    OWNED_MEMORY char *text = read_in(*state, "out/cells.jsonl");
    assert_true(strlen(text) < sizeof written);
    strcpy(written, text);
    return 0;
}

/* Reads the journal of out/ as `text`. */
static RtStatus read_journal(const Place *place, const char *text, RtResults *results, RtError *error) {
    write_in(place, "out/cells.jsonl", text);
    return rt_results_load(path_in(place, "out").text, place->experiment, results, error);
}

PLACE_TEST(a_journal_without_the_times_of_rounds_is_read) {
    OWNED_RESULTS results;
    for (char *at = written; (at = strstr(at, "\"each_")) != NULL;) memcpy(at, "\"EACH_", 6);
    assert_ok(read_journal(place, written, &results, error));
    const RtCell *cell = rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY);
    assert_true(cell->timed && cell->rounds == 3 && !cell->round_times);
}

/* They gave the median of up to three builds. */
PLACE_TEST(a_journal_with_one_time_for_each_structure_is_read_as_builds_of_unknown_number) {
    OWNED_RESULTS results;
    for (char *at = written; (at = strstr(at, "\"builds\"")) != NULL;) memcpy(at, "\"BUILDS\"", 8);
    for (char *at = strstr(written, "\"built\""); at; at = strstr(at, "\"built\"")) {
        char *list = strstr(at, "\"seconds\":[") + 10, *end = strchr(list, ']');
        memset(list, ' ', (size_t)(end - list) + 1);
        memcpy(list, "0.25", 4);
        at = end;
    }
    assert_ok(read_journal(place, written, &results, error));
    const RtBuildResult *build = rt_build_at(&results, 0, 0);
    assert_true(build->known && build->builds == 0);
    assert_true(build->seconds.median == 0.25 && build->seconds.low == 0.25 && build->seconds.high == 0.25);
}

/* The last line, and so some measurements, are missing. */
PLACE_TEST(a_resumed_run_keeps_the_builds_and_their_intervals) {
    char *last = strrchr(written, '{');
    const char *built = strstr(written, "\"built\"");
    static char line[sizeof written];
    snprintf(line, sizeof line, "%.*s", (int)strcspn(built, "\n"), built);
    assert_true(strstr(line, "\"builds\":20") && strstr(line, "\"seconds\":["));
    *last = '\0';
    write_in(place, "out/cells.jsonl", written);
    assert_runs(place, "run small.yaml --out out --resume");
    OWNED_MEMORY char *journal = read_in(place, "out/cells.jsonl");
    assert_non_null(strstr(journal, line));
    assert_null(strstr(strstr(journal, line) + strlen(line), line));
    assert_in_file(place, "out/times.csv", ",build_seconds,build_low,build_high,builds,build_threads,bytes,", ",20,");
}

/* Of two lines about a cell the second counts: the times of the first are not those of its rounds. */
PLACE_TEST(a_line_of_more_rounds_without_their_times_takes_the_place_of_one_with_them) {
    OWNED_RESULTS results;
    static char both[2 * sizeof written];
    char *again = both + strlen(written);
    strcpy(both, written);
    strcpy(again, strstr(written, "{\"scene\""));
    for (char *at = again; (at = strstr(at, "\"each_")) != NULL;) memcpy(at, "\"EACH_", 6);
    for (char *at = again; (at = strstr(at, "\"rounds\":3")) != NULL;) memcpy(at, "\"rounds\":9", 10);
    assert_ok(read_journal(place, both, &results, error));
    const RtCell *cell = rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY);
    assert_true(cell->timed && cell->rounds == 9 && !cell->round_times);
}

PLACE_TEST(a_count_of_2_63_less_1_is_read_as_it_was_written) {
    OWNED_RESULTS results;
    write_changed(place, "out/cells.jsonl", written, "\"differ\":0", "\"differ\":9223372036854775807");
    assert_ok(rt_results_load(path_in(place, "out").text, place->experiment, &results, error));
    uint64_t most = 0;
    for (RtCellCursor at = {0}; rt_results_next(&results, &at);)
        if (at.cell->differ > most) most = at.cell->differ;
    assert_true(most == INT64_MAX);
}

PLACE_TEST(a_line_that_no_journal_has_is_refused_by_its_number) {
    static const char *const cases[][3] = {
        {"\"rounds\":3", "\"rounds\":5", "'each_seconds' is not a list of as many times"},
        {"\"rounds\":3", "\"rounds\":1001", "'rounds' is not a whole number from 1 to 1000"},
        {"\"rounds\":3", "\"rounds\":-1", "'rounds' is not a whole number from 1 to 1000"},
        {"\"each_wall\"", "\"EACH_wall\"", "'each_wall' is not a list"},
        {"\"each_wall\":[", "\"each_wall\":[null,", "'each_wall' is not a list"},
        {"\"differ\":0", "\"differ\":-1", "'differ' is not a whole number"},
        {"\"differ\":0", "\"differ\":9223372036854775808", "'this line' is not a JSON object"},
        {"\"object_tests\":", "\"OBJECT_tests\":", "'object_tests' is not a whole number"},
        {"\"exact\":true", "\"exact\":1", "'exact' is not true or false"},
        {"\"baseline\":\"bvh", "\"baseline\":\"grid", "'baseline' is not a baseline"},
        {"\"kind\":\"primary\"", "\"kind\":\"first\"", "'kind' is not a kind of rays"},
        {"\"accel\":", "\"ACCEL\":", "'accel' is not there"},
        {"\"hash\":\"", "\"hash\":\"x", "'hash' is not a hash"},
        {"{\"scene\"", "{\"scene", "'this line' is not a JSON object"},
    };
    RtResults results = {0};
    static char changed[2 * sizeof written];
    char place_of[128];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *at = strstr(strstr(written, "{\"scene\""), cases[i][0]);
        size_t number = 1;
        assert_non_null(at);
        for (const char *c = written; c < at; c++) number += *c == '\n';
        snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - written), written, cases[i][1],
                 at + strlen(cases[i][0]));
        snprintf(place_of, sizeof place_of, "%s/out/cells.jsonl:%zu: ", place->folder, number);
        assert_bad_input_at(read_journal(place, changed, &results, error), place_of, cases[i][2]);
        rt_results_clear(&results);
    }
}

PLACE_TEST(a_journal_that_gzip_has_packed_can_be_read_but_not_continued) {
    char command[300];
    snprintf(command, sizeof command, "gzip '%s'", path_in(place, "out/cells.jsonl").text);
    assert_int_equal(system(command), 0);
    assert_runs(place, "report out");
    assert_runs(place, "compare out out");
    assert_ends(place, "run small.yaml --out out --resume", 2, "unpack it with gunzip");
    assert_ends(place, "run small.yaml --out out", 2, "out");
    write_in(place, "out/cells.jsonl.gz", "\x1f\x8b\x08 no gzip");
    assert_ends(place, "report out", 2, "cells.jsonl.gz: it is damaged");
}

RT_TESTS(journal, NULL, NULL)
