/* SPDX-License-Identifier: Apache-2.0 */
/* core/text/csv.h: quoted fields, and files that are not tables. */
#include "experiment_testing.h"

#include "core/text/csv.h"

PLACES_WITH(NULL)

PLACE_TEST(a_csv_field_may_be_quoted_and_is_written_as_it_was_read) {
    const char text[] = "# told here: a, b\na,b,c\r\n1,\"x, \"\"y\"\"\",\n\n,2,3\n";
    char *written = NULL;
    size_t size;
    OWNED_CSV csv;
    write_in(place, "some.csv", text);
    assert_ok(rt_csv_read(&csv, path_in(place, "some.csv").text, error));
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
}

PLACE_TEST(a_field_that_would_read_as_a_comment_or_a_line_break_is_quoted) {
    static const char *const fields[] = {"#a", "b\r"};
    OWNED_CSV csv;
    FILE *out = fopen(path_in(place, "some.csv").text, "wb");
    assert_non_null(out);
    for (size_t i = 0; i < 4; i++) {
        rt_csv_put(out, fields[i % 2]);
        fputc(i % 2 ? '\n' : ',', out);
    }
    fclose(out);
    assert_ok(rt_csv_read(&csv, path_in(place, "some.csv").text, error));
    assert_int_equal(csv.rows, 1);
    assert_string_equal(rt_csv_field(&csv, 0, 0), fields[0]);
    assert_string_equal(rt_csv_field(&csv, 0, 1), fields[1]);
}

PLACE_TEST(a_csv_file_with_a_byte_0_is_refused_and_not_cut_off_there) {
    static const char text[] = "a,b\n1,2\n\0,3,4\n";
    OWNED_CSV csv;
    assert_ok(rt_file_write(path_in(place, "some.csv").text, text, sizeof text - 1, error));
    assert_bad_input(rt_csv_read(&csv, path_in(place, "some.csv").text, error), ":3:1: there is a byte of 0");
}

PLACE_TEST(a_csv_file_that_is_none_is_refused_with_its_line) {
    const char *const cases[][2] = {
        {"a,b\n1\n", ":2: there are fewer"}, {"a,b\n1,2\n1,2,3\n", ":3: there are more"},
        {"a,b\n\"1,2\n", ":2: a quote"},     {"a,b\n\"1\"x,2\n", ":2: a quote"},
        {"# nothing\n\n", "no header"},      {"", "no header"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        OWNED_CSV csv;
        write_in(place, "some.csv", cases[i][0]);
        assert_bad_input(rt_csv_read(&csv, path_in(place, "some.csv").text, error), cases[i][1]);
    }
}

/* As many columns as lines: rows of that many fields would fill 32 GiB. */
PLACE_TEST(a_csv_file_needs_memory_for_the_fields_that_it_has_not_for_lines_times_columns) {
    enum { COLUMNS = 1 << 16, MOST_BYTES = 1 << 21 };
    OWNED_CSV csv;
    OWNED_MEMORY char *text = rt_alloc(2 * COLUMNS + 1, 1);
    assert_non_null(text);
    memset(text, ',', COLUMNS);
    memset(text + COLUMNS, '\n', COLUMNS);
    text[2 * COLUMNS - 2] = 'x';
    write_in(place, "some.csv", text);
    rt_memory_limit(MOST_BYTES);
    assert_bad_input(rt_csv_read(&csv, path_in(place, "some.csv").text, error), ": there are fewer");
    rt_memory_limit(0);
}

RT_TESTS(csv, NULL, NULL)
