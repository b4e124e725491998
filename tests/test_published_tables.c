/* experiments/published.h: published figures beside measured ones, and what is made of their differences. The
 * experiment counts on balls:size=1, ten spheres and a polygon, of which brute tests all 11 for each of the
 * 64 primary rays; the grid has 64 voxels. */
#include "testing.h"

#include "base/memory.h"
#include "experiments/csv.h"
#include "experiments/run.h"
#include "experiments/tables.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char experiment_text[] =
    "name: small\n"
    "question: b\n"
    "prediction: c\n"
    "scenes:\n"
    "  - {scene: \"balls:size=1\", label: balls, size: 8x8, depth: 1}\n"
    "  - {scene: \"random:n=20\", label: cloud, size: 4x4, depth: 1}\n"
    "accelerators:\n"
    "  - {accel: bvh}\n"
    "  - {accel: brute, label: all, scenes: [balls]}\n"
    "  - {accel: \"grid:resolution=4x4x4\", label: cells, scenes: [balls]}\n"
    "  - {accel: \"grid:resolution=2x2x2\", label: cells, scenes: [cloud]}\n"
    "published:\n"
    "  tables: [figures.csv]\n"
    "  reasons: reasons.csv\n"
    "  tolerance: {leaves: 1, object_tests: 3, primary: 1}\n"
    "rays: [primary]\n"
    "count_only: yes\n"
    "quick: {size: 4x4}\n";

static const char head[] =
    "# a comment\nscene,source,structure,parameters,accel,tests_per,leaves,object_tests,steps\n";
static const char reasons_head[] = "scene,source,accel,column,reason\n";

/* ---- a folder with an experiment, a table and reasons ---- */

typedef struct Place {
    char folder[64];
    RtExperiment *experiment;
    RtResults results;
    RtPublished published;
} Place;

static void write_in(const Place *place, const char *name, const char *first, const char *second) {
    char path[128], text[4096];
    snprintf(path, sizeof path, "%s/%s", place->folder, name);
    snprintf(text, sizeof text, "%s%s", first, second);
    assert_ok(rt_file_write(path, text, strlen(text), error));
}

/* The experiment with `to` in the place of `from`. */
static void write_yaml(const Place *place, const char *from, const char *to) {
    char text[2048];
    const char *at = strstr(experiment_text, from);
    assert_non_null(at);
    snprintf(text, sizeof text, "%.*s%s", (int)(at - experiment_text), experiment_text, to);
    write_in(place, "small.yaml", text, at + strlen(from));
}

static char *read_in(const Place *place, const char *name) {
    char path[128], *text = NULL;
    size_t size;
    snprintf(path, sizeof path, "%s/%s", place->folder, name);
    assert_ok(rt_file_read(path, 1 << 20, &text, &size, error));
    return text;
}

static int make_place(void **state) {
    static Place place;
    strcpy(place.folder, "/tmp/raytally-test-XXXXXX");
    if (!mkdtemp(place.folder)) return -1;
    place.experiment = rt_alloc(1, sizeof(RtExperiment));
    if (!place.experiment) return -1;
    write_in(&place, "small.yaml", experiment_text, "");
    write_in(&place, "reasons.csv", reasons_head, "");
    *state = &place;
    return 0;
}

static int remove_place(void **state) {
    Place *place = *state;
    char command[128];
    rt_free(place->experiment);
    snprintf(command, sizeof command, "rm -rf '%s'", place->folder);
    return system(command);
}

static RtStatus load(Place *place, bool quick, RtError *error) {
    char path[128];
    snprintf(path, sizeof path, "%s/small.yaml", place->folder);
    RT_TRY(rt_experiment_load(place->experiment, path, quick, error));
    return rt_published_load(&place->published, place->experiment, error);
}

/* Runs the experiment with these rows and reasons into DIR/out, and gives what the check says. */
static RtStatus run(Place *place, const char *rows, const char *reasons, bool quick, RtError *error) {
    char path[128], out[128];
    write_in(place, "figures.csv", head, rows);
    write_in(place, "reasons.csv", reasons_head, reasons);
    snprintf(path, sizeof path, "%s/small.yaml", place->folder);
    snprintf(out, sizeof out, "%s/out", place->folder);
    RT_TRY(rt_experiment_load(place->experiment, path, quick, error));
    RT_TRY(rt_results_init(&place->results, place->experiment, error));
    const RtRunOptions options = {.directory = out, .trial = {.threads = 1, .timing = 1}};
    RtStatus status = rt_run(&place->results, &options, error);
    rt_results_clear(&place->results);
    return status;
}

static void assert_in_file(const Place *place, const char *name, const char *part) {
    char *text = read_in(place, name);
    if (!strstr(text, part)) fail_msg("%s has no '%s':\n%s", name, part, text);
    rt_free(text);
}

static void assert_refused(RtStatus status, RtStatus expected, const RtError *error, const char *says) {
    if (status != expected || !strstr(error->message, says)) {
        fail_msg("status %d, expected %d with '%s': %s", status, expected, says, error->message);
    }
}

static void assert_agrees(Place *place, const char *rows, const char *reasons) {
    assert_ok(run(place, rows, reasons, false, error));
}

static void assert_fails(Place *place, const char *rows, const char *reasons, bool quick, const char *says) {
    RtError error = {RT_OK, ""};
    RtStatus status = run(place, rows, reasons, quick, &error);
    assert_refused(status, RT_MISMATCH, &error, says);
}

/* ---- CSV ---- */

static void a_csv_field_may_be_quoted_and_is_written_as_it_was_read(void **state) {
    Place *place = *state;
    const char text[] = "# told here: a, b\na,b,c\r\n1,\"x, \"\"y\"\"\",\n\n,2,3\n";
    char path[128], *written = NULL;
    size_t size;
    RtCsv csv;
    write_in(place, "some.csv", text, "");
    snprintf(path, sizeof path, "%s/some.csv", place->folder);
    assert_ok(rt_csv_read(&csv, path, error));
    assert_int_equal(csv.rows, 2);
    assert_int_equal(csv.lines[1], 5);
    assert_string_equal(rt_csv_field(&csv, 0, rt_csv_find(&csv, "b")), "x, \"y\"");
    assert_string_equal(rt_csv_field(&csv, 0, 2), "");
    assert_string_equal(rt_csv_field(&csv, 1, 2), "3");
    assert_string_equal(rt_csv_field(&csv, 1, rt_csv_find(&csv, "none")), "");
    FILE *out = open_memstream(&written, &size);
    rt_csv_put(out, rt_csv_field(&csv, 0, 1));
    fclose(out);
    assert_string_equal(written, "\"x, \"\"y\"\"\"");
    free(written);
    rt_csv_clear(&csv);
}

static void a_csv_file_with_a_byte_0_is_refused_and_not_cut_off_there(void **state) {
    Place *place = *state;
    static const char text[] = "a,b\n1,2\n\0,3,4\n";
    char path[128];
    RtCsv csv;
    snprintf(path, sizeof path, "%s/some.csv", place->folder);
    assert_ok(rt_file_write(path, text, sizeof text - 1, error));
    RtError error = {RT_OK, ""};
    RtStatus status = rt_csv_read(&csv, path, &error);
    rt_csv_clear(&csv);
    assert_refused(status, RT_BAD_INPUT, &error, ":3: there is a byte 0");
}

static void a_csv_file_that_is_none_is_refused_with_its_line(void **state) {
    Place *place = *state;
    const char *const cases[][2] = {
        {"a,b\n1\n", ":2: there are fewer"}, {"a,b\n1,2\n1,2,3\n", ":3: there are more"},
        {"a,b\n\"1,2\n", ":2: a quote"},     {"a,b\n\"1\"x,2\n", ":2: a quote"},
        {"# nothing\n\n", "no header"},      {"", "no header"}};
    char path[128];
    snprintf(path, sizeof path, "%s/some.csv", place->folder);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtCsv csv;
        RtError error = {RT_OK, ""};
        write_in(place, "some.csv", cases[i][0], "");
        RtStatus status = rt_csv_read(&csv, path, &error);
        rt_csv_clear(&csv);
        assert_refused(status, RT_BAD_INPUT, &error, cases[i][1]);
    }
}

/* ---- tables ---- */

static void what_a_published_table_or_a_reason_says_wrongly_is_told_with_its_line(void **state) {
    Place *place = *state;
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
        {"figures.csv", "scene,source,accel,object_tests\nballs,s,all,1\n", ":2: tests_per: ''"},
        {"figures.csv", "scene,source,accel,tests_per,object_tests\nballs,s,all,day,1\n",
         ":2: tests_per: 'day'"},
        {"figures.csv", "scene,source,steps\nballs,s,1\n", ":2: steps: the table needs a column accel"},
        {"figures.csv", "scene,source,accel,primary\nballs,s,all,1\n",
         ":2: primary: the row has an accelerator"},
        {"reasons.csv", "scene,source,accel,reason\n", "the column 'column' is missing"},
        {"reasons.csv", "scene,source,accel,column,reason\n*,*,*,*, \n",
         "reasons.csv:2: the reason is missing"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtError error = {RT_OK, ""};
        write_in(place, "figures.csv", head, "");
        write_in(place, "reasons.csv", reasons_head, "");
        write_in(place, cases[i].file, cases[i].text, "");
        RtStatus status = load(place, false, &error);
        rt_published_clear(&place->published);
        assert_refused(status, RT_BAD_INPUT, &error, cases[i].says);
    }
}

static void what_the_experiment_says_wrongly_about_published_figures_is_told_with_its_line(void **state) {
    Place *place = *state;
    const char *const cases[][3] = {
        {"scenes: [balls]", "scenes: [ball]", ":9:"},
        {"scenes: [cloud]", "scenes: [cloud, balls]", ":11:"}, /* 'cells' twice on balls */
        {"[figures.csv]", "[../figures.csv]", ":12:"},
        {"[figures.csv]", "[/figures.csv]", ":12:"},
        {"leaves: 1", "leaves: -1", ":12:"},
        {"leaves: 1", "leafs: 1", ":15:"},
        {"count_only: yes", "count_only: perhaps", ":17:"},
        {"  reasons: reasons.csv\n", "  ours: [bvh, kd]\n", ":14:"},
        {"count_only: yes", "baseline: all", ":17:"}, /* not on every scene */
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtError error = {RT_OK, ""};
        write_yaml(place, cases[i][0], cases[i][1]);
        write_in(place, "figures.csv", head, "");
        RtStatus status = load(place, false, &error);
        rt_published_clear(&place->published);
        assert_refused(status, RT_BAD_INPUT, &error, cases[i][2]);
    }
}

static void a_published_table_that_does_not_fit_into_memory_is_refused(void **state) {
    Place *place = *state;
    write_in(place, "figures.csv", head, "balls,s,t,u,all,ray,,11,\n");
    write_in(place, "reasons.csv", reasons_head, "*,*,*,*,why\n");
    int64_t live = rt_alloc_live();
    for (uint64_t n = 1, failed = 1; failed; n++) {
        RtError error = {RT_OK, ""};
        rt_alloc_fail_at(n);
        RtStatus status = load(place, false, &error);
        rt_alloc_fail_at(0);
        failed = status != RT_OK;
        rt_published_clear(&place->published);
        if (failed) assert_refused(status, RT_NO_MEMORY, &error, "");
        assert_int_equal(rt_alloc_live(), live);
    }
}

/* ---- judging ---- */

static void a_figure_within_its_tolerance_is_taken_and_one_outside_is_not(void **state) {
    Place *place = *state;
    assert_agrees(place, "balls,s,Loop,,all,ray,,11.2,\nballs,s,Grid,4x4x4,cells,,64,,\n", "");
    assert_in_file(place, "out/published.csv", "balls,s,Loop,,all,object_tests,ray,11.2,11,-1.79,3,yes,\n");
    assert_in_file(place, "out/published.csv", "balls,s,Grid,4x4x4,cells,leaves,,64,64,0.00,1,yes,\n");
    assert_fails(place, "balls,s,Loop,,all,ray,,11.2,\nballs,s,Loop,of 3,all,ray,,12.0,\n", "", false,
                 "object_tests of Loop of 3 on balls is 11, published is 12.0");
    assert_in_file(place, "out/published.csv",
                   "balls,s,Loop,of 3,all,object_tests,ray,12.0,11,-8.33,3,no,\n");
    assert_in_file(place, "out/report.html", "class=\"missed\"");
    assert_in_file(place, "out/published.md", "**11 (-8.3 %)**");
}

static void half_a_unit_of_the_last_digit_is_within_but_not_of_a_whole_number(void **state) {
    Place *place = *state;
    write_yaml(place, "object_tests: 3", "object_tests: 0.5");
    assert_agrees(place, "balls,s,Loop,,all,ray,,11.1,\n", ""); /* 0.1 <= 0.0555 + 0.05 */
    assert_fails(place, "balls,s,Loop,,all,ray,,11.10,\n", "", false, "published is 11.10");
    assert_agrees(place, "balls,s,Loop,,all,ray,,11,\n", "");
    assert_fails(place, "balls,s,Grid,4x4x4,cells,,65,,\n", "", false, "leaves");
}

static void a_reason_excuses_what_it_is_about_and_a_stale_one_fails(void **state) {
    Place *place = *state;
    const char *rows = "balls,s,Loop,,all,ray,,12.0,\nballs,s,Grid,,cells,,64,,\n";
    assert_agrees(place, rows, "b*,s,all,object_tests,\"he tests one more, twice\"\n");
    assert_in_file(place, "out/published.csv", ",no,\"he tests one more, twice\"\n");
    assert_in_file(place, "out/published.md", "he tests one more");
    assert_fails(place, rows, "balls,s,all,object_tests,why\nballs,s,cells,*,why\n", false,
                 "reasons.csv:3: no figure needs this reason");
    assert_fails(place, rows, "balls,other,all,*,why\n", false, "nobody says why");
}

static void tests_per_hit_are_divided_by_the_rays_that_hit(void **state) {
    Place *place = *state;
    char path[128], rows[128];
    RtCsv counts;
    assert_agrees(place, "", "");
    snprintf(path, sizeof path, "%s/out/counts.csv", place->folder);
    assert_ok(rt_csv_read(&counts, path, error));
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
    assert_fails(place, rows, "", false, "object_tests");
}

static void rays_are_compared_where_a_table_has_no_accelerator(void **state) {
    Place *place = *state;
    assert_agrees(place, "", "");
    write_yaml(place, "figures.csv", "numbers.csv");
    write_in(place, "numbers.csv", "scene,source,primary\n", "balls,s,64\ncloud,s,15\n");
    assert_fails(place, "", "", false, "primary of s on cloud is 16, published is 15");
    assert_in_file(place, "out/published.csv", "balls,s,,,,primary,,64,64,0.00,1,yes,\n");
}

static void a_row_that_nothing_measures_is_shown_and_not_judged(void **state) {
    Place *place = *state;
    assert_agrees(place, "balls,s,Tree,,,ray,,12.0,3.5\n", "");
    assert_in_file(place, "out/published.csv", "balls,s,Tree,,,object_tests,ray,12.0,,,3,,\n");
}

static void the_quick_variant_judges_structures_alone(void **state) {
    Place *place = *state;
    assert_ok(run(place, "balls,s,Loop,,all,ray,,12.0,\n", "*,*,*,*,stale\n", true, error));
    assert_fails(place, "balls,s,Grid,,cells,,60,,\n", "", true, "leaves");
}

static void ours_must_need_less_than_every_published_row(void **state) {
    Place *place = *state;
    write_yaml(place, "  reasons:", "  ours: [all]\n  reasons:");
    const char *ahead = "balls,s,Tree,deep,,ray,,12.0,3.5\nballs,s,Tree,flat,,ray,,13.0,1.5\n";
    assert_agrees(place, ahead, "");
    assert_in_file(place, "out/least.csv", "balls,object_tests,Tree deep,12,all,11,");
    assert_in_file(place, "out/least.csv", "balls,object_tests+steps,Tree flat,14.5,all,");
    /* A bar in a name is none of the table's. */
    assert_agrees(place, "balls,s,Tree|deep,,,ray,,12.0,3.5\n", "");
    assert_in_file(place, "out/published.md", "| balls | object_tests | Tree\\|deep | 12 | `all` |");
    /* Per hit it is less than 11 a ray. */
    assert_fails(place, "balls,s,Tree,deep,,hit,,11.0,3.5\n", "", false, "on balls none of ours needs less");
}

/* ---- directories ---- */

static int raytally(const Place *place, const char *arguments) {
    char command[512];
    snprintf(command, sizeof command, "cd '%s' && '%s' %s >output 2>message", place->folder, RT_PROGRAM,
             arguments);
    return WEXITSTATUS(system(command));
}

static void reproduce_compares_published_figures_and_checks_them(void **state) {
    Place *place = *state;
    const char *rows = "balls,s,Loop,,all,ray,,11.0,\n";
    write_in(place, "figures.csv", head, rows);
    assert_int_equal(raytally(place, "run small.yaml --out out"), 0);
    assert_int_equal(raytally(place, "reproduce out"), 0);
    assert_in_file(place, "output", "out/published.csv");
    assert_int_equal(raytally(place, "report out"), 0);
    assert_int_equal(raytally(place, "run small.yaml --out out --resume"), 0);

    write_in(place, "figures.csv", head, "balls,s,Loop,,all,ray,,11.1,\n");
    assert_int_equal(raytally(place, "reproduce out"), 1);
    assert_in_file(place, "message", "published.csv:2: differs");

    write_in(place, "figures.csv", head, "balls,s,Loop,,all,ray,,21.0,\n");
    assert_int_equal(raytally(place, "run small.yaml --out out"), 1);
    assert_in_file(place, "message", "nobody says why");
    assert_int_equal(raytally(place, "reproduce out"), 1);
    write_in(place, "figures.csv", head, "balls,s,Loop,,any,ray,,21.0,\n");
    assert_int_equal(raytally(place, "run small.yaml --out out"), 2);
}

static void a_contender_is_counted_on_its_scenes_alone_and_one_label_serves_on_several(void **state) {
    Place *place = *state;
    write_in(place, "figures.csv", head, "");
    assert_int_equal(raytally(place, "run small.yaml --out out"), 0);
    char *counts = read_in(place, "out/counts.csv"), *journal = read_in(place, "out/cells.jsonl");
    assert_null(strstr(strstr(counts, "\ncloud,"), ",all,"));
    assert_non_null(strstr(counts, ",cells,\"grid:rule=cubic,density=4,resolution=4x4x4"));
    assert_non_null(strstr(counts, ",cells,\"grid:rule=cubic,density=4,resolution=2x2x2"));
    assert_null(strstr(journal, "\"null\"")); /* nothing is timed */
    assert_int_equal(raytally(place, "run small.yaml --out out --resume"), 0);
    char *again = read_in(place, "out/cells.jsonl");
    assert_string_equal(journal, again);
    rt_free(counts);
    rt_free(journal);
    rt_free(again);
    char path[128];
    snprintf(path, sizeof path, "%s/out/times.csv", place->folder);
    assert_false(rt_file_exists(path));
}

#define IN_PLACE(test) cmocka_unit_test_setup_teardown(test, make_place, remove_place)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_PLACE(a_csv_field_may_be_quoted_and_is_written_as_it_was_read),
        IN_PLACE(a_csv_file_with_a_byte_0_is_refused_and_not_cut_off_there),
        IN_PLACE(a_csv_file_that_is_none_is_refused_with_its_line),
        IN_PLACE(what_a_published_table_or_a_reason_says_wrongly_is_told_with_its_line),
        IN_PLACE(what_the_experiment_says_wrongly_about_published_figures_is_told_with_its_line),
        IN_PLACE(a_published_table_that_does_not_fit_into_memory_is_refused),
        IN_PLACE(a_figure_within_its_tolerance_is_taken_and_one_outside_is_not),
        IN_PLACE(half_a_unit_of_the_last_digit_is_within_but_not_of_a_whole_number),
        IN_PLACE(a_reason_excuses_what_it_is_about_and_a_stale_one_fails),
        IN_PLACE(tests_per_hit_are_divided_by_the_rays_that_hit),
        IN_PLACE(rays_are_compared_where_a_table_has_no_accelerator),
        IN_PLACE(a_row_that_nothing_measures_is_shown_and_not_judged),
        IN_PLACE(the_quick_variant_judges_structures_alone),
        IN_PLACE(ours_must_need_less_than_every_published_row),
        IN_PLACE(reproduce_compares_published_figures_and_checks_them),
        IN_PLACE(a_contender_is_counted_on_its_scenes_alone_and_one_label_serves_on_several),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
