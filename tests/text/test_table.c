/* SPDX-License-Identifier: Apache-2.0 */
/* core/text/table.h: one small table with every type of field, in every format. */
#include "testing.h"

#include "core/text/table.h"

#include <inttypes.h>

typedef struct Part {
    uint64_t rays;
} Part;

typedef struct Row {
    const char *name;
    uint64_t hits;
    double seconds;
    bool exact;
    const Part *part;
} Row;

static RtField seconds_of(const Row *r) {
    RtField field = rt_field_real(r->seconds);
    field.bold = r->seconds > 1;
    field.note = field.bold ? "a \"slow\" one" : NULL;
    return field;
}

#define COLUMNS(X)                                                                                           \
    X(name, "name", markup, "", "what it is called", r->name)                                                \
    X(hits, "hit count", integer, "", "hits", r->hits)                                                       \
    X(seconds, "seconds", real6, "s", "how long it took", seconds_of(r))                                     \
    X(exact, "exact", flag, "", "whether it is exact", r->exact)                                             \
    X(range, "range", interval, "s", "how long it may take",                                                 \
      rt_field_interval(r->seconds, r->seconds / 2, 2 * r->seconds))
RT_TABLE_COLUMNS(columns, COLUMNS)

static const void *part_of(const void *row) {
    return ((const Row *)row)->part;
}

static RtField rays_of(const void *row, const RtTableColumn *column) {
    (void)column;
    return rt_field_integer(((const Part *)row)->rays);
}
static const RtTableColumn part_columns[] = {
    {"rays", "rays", "", "rays traced", rays_of, RT_FORM_integer, 0}};

static const Part part = {7};
static const Row things[] = {{"a|b, `c` **d**", 12, 1.5, true, &part},
                             {NULL, 0, 0, false, NULL}, /* left out */
                             {"<x>", 3456, NAN, false, NULL}};
static const RtColumnGroup groups[] = {RT_ALL(columns), {"tally", part_columns, 1, part_of}};

static const void *thing_at(void *context, size_t i) {
    (void)context;
    return things[i].name ? &things[i] : NULL;
}

static const RtTable table = {RT_GROUPS(groups), .row_count = 3, .row = thing_at};

static void assert_written(const RtTable *what, void (*write)(const RtTable *, FILE *),
                           const char *expected) {
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    write(what, out);
    fclose(out);
    assert_string_equal(text, expected);
    free(text);
}

RT_TEST(csv_quotes_and_leaves_empty_what_is_missing) {
    assert_written(&table, rt_table_csv,
                   "name,hits,seconds,exact,range,rays\n"
                   "\"a|b, `c` **d**\",12,1.5,yes,\"1.5 [0.8, 3.0]\",7\n"
                   "<x>,3456,,no,,\n");
}

RT_TEST(text_is_aligned_and_has_a_dash_for_what_is_missing) {
    assert_written(&table, rt_table_text,
                   "name            hit count  seconds  exact  range           rays\n"
                   "a|b, `c` **d**         12      1.5  yes    1.5 [0.8, 3.0]     7\n"
                   "<x>                  3456        -  no     -                  -\n");
}

RT_TEST(markdown_escapes_bars_and_aligns_numbers) {
    assert_written(&table, rt_table_markdown,
                   "| name | hit count | seconds | exact | range | rays |\n"
                   "| --- | ---: | ---: | --- | ---: | ---: |\n"
                   "| a\\|b, `c` **d** | 12 | **1.5** | yes | 1.5 [0.8, 3.0] | 7 |\n"
                   "| <x> | 3456 | | no | | |\n");
}

static RtStanding first_is_best(const void *row) {
    return row == things ? RT_STANDING_BEST : RT_STANDING_BEHIND;
}

static RtTable first_columns(void) {
    static const RtColumnGroup first[] = {RT_FROM_TO(columns, name, seconds)};
    RtTable narrow = table;
    narrow.groups = first;
    narrow.group_count = 1;
    return narrow;
}

RT_TEST(latex_has_bold_fields_and_escapes_what_it_must) {
    RtTable marked = first_columns();
    marked.caption = "50 % of {a_b}";
    marked.wide = true;
    assert_written(&marked, rt_table_tex,
                   "\\begin{table*}\n\\footnotesize\\centering\\setlength{\\tabcolsep}{3pt}\n"
                   "\\caption{50 \\% of \\{a\\_b\\}}\\smallskip\n\\begin{tabular}{@{}lrr@{}}\n\\toprule\n"
                   "name & hit count & seconds \\\\\n\\midrule\n"
                   "a\\textbar{}b, `c` **d** & 12 & \\textbf{1.5} \\\\\n"
                   "\\textless{}x\\textgreater{} & 3456 & -- \\\\\n\\bottomrule\n\\end{tabular}\n"
                   "\\end{table*}\n");
}

RT_TEST(a_page_gets_columns_texts_with_their_numbers_notes_and_marks) {
    RtTable narrow = first_columns();
    narrow.caption = "a & b";
    narrow.standing = first_is_best;
    json_t *page = rt_table_page(&narrow);
    json_t *expected =
        json_pack("{s:s, s:[{s:s, s:s, s:s, s:b}, {s:s, s:s, s:s, s:b}, {s:s, s:s, s:s, s:b}], s:[{s:s, "
                  "s:[s, [s, i], [s, f, s]]}, {s:s, s:[s, [s, i], [s, n]]}]}",
                  "title", "a & b", "columns", "id", "name", "name", "name", "meaning", "what it is called",
                  "number", 0, "id", "hits", "name", "hit count", "meaning", "hits", "number", 1, "id",
                  "seconds", "name", "seconds", "meaning", "how long it took", "number", 1, "rows",
                  "standing", "best", "fields", "a|b, `c` **d**", "12", 12, "1.5", 1.5, "a \"slow\" one",
                  "standing", "", "fields", "<x>", "3456", 3456, "");
    assert_non_null(expected);
    assert_true(json_equal(page, expected));
    json_decref(expected);
    json_decref(page);
}

RT_TEST(json_has_an_object_a_row_and_null_for_what_is_missing) {
    json_auto_t *rows = rt_table_json(&table);
    json_auto_t *expected = json_pack(
        "[{s:s, s:i, s:f, s:b, s:{s:f, s:f, s:f}, s:{s:i}}, {s:s, s:i, s:n, s:b, s:{s:n, s:n, s:n}, s:n}]",
        "name", "a|b, `c` **d**", "hit count", 12, "seconds", 1.5, "exact", 1, "range", "value", 1.5, "low",
        0.75, "high", 3.0, "tally", "rays", 7, "name", "<x>", "hit count", 3456, "seconds", "exact", 0,
        "range", "value", "low", "high", "tally");
    assert_non_null(expected);
    assert_true(json_equal(rows, expected));
}

RT_TEST(lines_one_by_one_are_those_of_the_whole_table) {
    int widths[RT_MAX_TABLE_COLUMNS];
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    rt_table_widths(&table, widths);
    rt_table_line(&table, widths, NULL, out);
    rt_table_line(&table, widths, &things[0], out);
    rt_table_line(&table, widths, &things[2], out);
    fclose(out);
    assert_written(&table, rt_table_text, text);
    free(text);
}

RT_TEST(a_table_that_is_wider_than_the_page_is_printed_in_parts_that_repeat_the_first_column) {
    setenv("COLUMNS", "38", 1);
    assert_written(&table, rt_table_text,
                   "name            hit count  seconds\n"
                   "a|b, `c` **d**         12      1.5\n"
                   "<x>                  3456        -\n"
                   "\n"
                   "name            exact  range\n"
                   "a|b, `c` **d**  yes    1.5 [0.8, 3.0]\n"
                   "<x>             no     -\n"
                   "\n"
                   "name            rays\n"
                   "a|b, `c` **d**     7\n"
                   "<x>                -\n");
    unsetenv("COLUMNS");
}

RT_TEST(figures_are_about_four_characters) {
    const struct {
        double value;
        const char *text;
    } cases[] = {{0, "0"},        {0.00341, "0.0034"}, {0.341, "0.341"},  {1.239, "1.24"},
                 {12.39, "12.4"}, {123.9, "124"},      {69666, "69666"},  {0.00012, "1.2e-04"},
                 {NAN, "-"},      {9.999, "10.0"},     {1.5e8, "1.5e+08"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char text[16];
        rt_format_figure(cases[i].value, text);
        assert_string_equal(text, cases[i].text);
    }
}

static double ratio_end;

static RtField get_ratio_end(const void *row, const RtTableColumn *column) {
    (void)row, (void)column;
    return rt_field_real(ratio_end);
}

/* The end of a ratio's interval as JSON has it, in nine digits. */
static double nine_digits(double end) {
    static const RtTableColumn column = {"end", "end", "", "an end", get_ratio_end, RT_FORM_end, 0};
    char text[64];
    ratio_end = end;
    json_auto_t *object = rt_row_json(&(RtColumnGroup){NULL, &column, 1, NULL}, 1, &ratio_end);
    size_t length = json_dumpb(json_object_get(object, "end"), text, sizeof text - 1,
                               JSON_ENCODE_ANY | JSON_REAL_PRECISION(9));
    text[length] = '\0';
    return strtod(text, NULL);
}

RT_TEST(an_interval_is_seen_not_to_hold_1_if_it_does_not) {
    static const double ends[] = {0.5,         0.98,     0.9951, 0.9994, 0.9996, 1 - 1e-7, 1 - 0x1p-53, 1,
                                  1 + 0x1p-52, 1 + 1e-7, 1.0004, 1.0031, 1.0049, 1.02,     2.5};
    enum { ENDS = sizeof ends / sizeof ends[0] };
    char buffer[RT_MAX_FIELD];
    for (int i = 0; i < ENDS; i++) {
        const RtField end = rt_field_real(ends[i]);
        assert_int_equal(strtod(rt_field_show(RT_FORM_end, &end, buffer), NULL) == 1, ends[i] == 1);
        for (int k = i; k < ENDS; k++) {
            const RtField field = rt_field_interval(0.5 * (ends[i] + ends[k]), ends[i], ends[k]);
            const bool holds = ends[i] <= 1 && 1 <= ends[k];
            double value, low, high;
            const char *text = rt_field_show(RT_FORM_interval, &field, buffer);
            assert_int_equal(sscanf(text, "%lf [%lf, %lf]", &value, &low, &high), 3);
            assert_int_equal(low <= 1 && 1 <= high, holds);
            assert_true(low <= value && value <= high);
            assert_int_equal(nine_digits(ends[i]) <= 1 && 1 <= nine_digits(ends[k]), holds);
        }
    }
    const RtField usual = rt_field_interval(1.0134, 1.0061, 1.0279),
                  close = rt_field_interval(1.0041, 1.0031, 1.0279);
    assert_string_equal(rt_field_show(RT_FORM_interval, &usual, buffer), "1.01 [1.01, 1.03]");
    assert_string_equal(rt_field_show(RT_FORM_interval, &close, buffer), "1.004 [1.003, 1.028]");
}

static void expect_interval(double value, double low, double high, const char *text) {
    char shown[RT_MAX_FIELD];
    rt_format_interval(value, low, high, shown);
    assert_string_equal(shown, text);
}

RT_TEST(an_interval_has_no_more_digits_than_it_supports) {
    expect_interval(0.5312, 0.27, 7.99, "0.5 [0.3, 8.0]");
    expect_interval(4.8012, 4.7981, 4.8031, "4.80 [4.80, 4.80]");
    expect_interval(345.4, 177.2, 402, "300 [200, 400]");
    expect_interval(123456, 91234, 161234, "1.2e5 [0.9e5, 1.6e5]");
    expect_interval(123456, 123400, 123500, "1.23e5 [1.23e5, 1.24e5]");
    expect_interval(0.00045678, 0.0004, 0.0005, "4.6e-4 [4.0e-4, 5.0e-4]");
    expect_interval(0.307, (double)NAN, (double)NAN, "0.307");
    expect_interval(2120, 1490, INFINITY, "2100 [1500, inf]");
    expect_interval(INFINITY, 1490, INFINITY, "inf [1500, inf]");
    expect_interval(0, 0, 1490, "0 [0, 1500]");
    expect_interval(-0.52, -0.61, -0.4, "-0.5 [-0.6, -0.4]");
    expect_interval(INFINITY, INFINITY, INFINITY, "inf [inf, inf]"); /* a ratio to a time of 0 */
    expect_interval(INFINITY, INFINITY, (double)NAN, "inf");
    expect_interval(0, -INFINITY, INFINITY, "0 [-inf, inf]");
}

RT_TEST(a_number_of_unknown_error_has_two_digits) {
    static const struct {
        double value;
        const char *text;
    } cases[] = {{0, "0"},         {0.3456, "0.35"},  {12.34, "12"},         {345.6, "350"},
                 {12345, "12000"}, {123456, "1.2e5"}, {0.00012345, "1.2e-4"}};
    char text[32];
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        rt_format_rough(cases[i].value, text);
        assert_string_equal(text, cases[i].text);
    }
}

RT_TEST(counts_keep_all_their_digits_up_to_the_last_that_json_has) {
    static const uint64_t counts[] = {UINT64_C(1) << 32, (UINT64_C(1) << 53) + 1, INT64_MAX};
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        const Row row = {"many", counts[i], 0, false, NULL};
        const RtField field = rt_field_integer(counts[i]);
        char buffer[RT_MAX_FIELD], expected[32];
        snprintf(expected, sizeof expected, "%" PRIu64, counts[i]);
        assert_string_equal(rt_field_show(RT_FORM_integer, &field, buffer), expected);
        json_auto_t *written = rt_row_json(groups, 1, &row);
        char *text = json_dumps(written, JSON_COMPACT);
        json_auto_t *read = json_loads(text, 0, NULL);
        assert_true((uint64_t)json_integer_value(json_object_get(read, "hit count")) == counts[i]);
        free(text);
    }
}

RT_TESTS(table, NULL, NULL)
