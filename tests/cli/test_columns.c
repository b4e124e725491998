/* SPDX-License-Identifier: Apache-2.0 */
/* docs/columns.md is generated from the columns of all tables; the test says where the current page is. The
 * committed files have these columns. Every accelerator has a page with its parameters and their defaults. */
#include "csv_testing.h"
#include "testing.h"

#include "compare/compare.h"
#include "core/base/file.h"
#include "core/base/memory.h"
#include "measure/extents_table.h"
#include "results/result_tables.h"
#include "run/callgrind.h"
#include "verify/verify_table.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- what there is ---- */

static RtExperiment experiment; /* of nothing */
static const RtResults results = {.experiment = &experiment};

static RtTable of_results(RtResultTable which) {
    static RtResultRow row = {.results = &results};
    return rt_result_table(which, &row);
}

static RtTable of_frames(void) {
    static RtFrameRow row = {.results = &results};
    return rt_frame_table(&row);
}

static RtTable of_instructions(void) {
    static const RtCallgrind callgrind = {0};
    static RtInstructionsRow row = {.callgrind = &callgrind};
    return rt_instructions_table(&row);
}

static RtTable of_comparison(bool accels) {
    static const RtComparison comparison = {0};
    static RtComparedRow row = {.comparison = &comparison};
    return rt_comparison_table(&row, accels, true);
}

typedef struct Section {
    const char *title;
    bool csv;
    const char *example; /* a CSV file that has these columns, or NULL */
    RtTable table;
    bool swept; /* has a column for each swept parameter, too */
} Section;

#define RESULTS(which) .table = of_results(which), .swept = rt_result_table_sweeps(which)

enum { SECTIONS = 16 };
static void list(Section sections[SECTIONS]) {
    const RtTable verify_csv = {.groups = rt_verify_csv, .group_count = RT_VERIFY_CSV_GROUPS};
    const RtTable verify_json = {.groups = rt_verify_json, .group_count = RT_VERIFY_JSON_GROUPS};
    const RtTable extents = {.groups = rt_extents_json, .group_count = 1};
    const Section all[SECTIONS] = {
        {"counts.csv", true, "tests/golden/counts.csv", RESULTS(RT_COUNTS)},
        {"times.csv", true, NULL, RESULTS(RT_TIMES)},
        {"rounds.csv", true, NULL, RESULTS(RT_ROUNDS)},
        {"frame.csv", true, NULL, .table = of_frames()},
        {"render.csv", true, NULL, RESULTS(RT_RENDERED)},
        {"distributions.csv", true, NULL, RESULTS(RT_DISTRIBUTIONS)},
        {"histograms.csv", true, NULL, RESULTS(RT_HISTOGRAMS)},
        {"verify.csv", true, "results/reference/verify/verify.csv", .table = verify_csv},
        {"bench --json: rows", false, NULL, RESULTS(RT_BENCH)},
        {"bench --json: null_runs", false, NULL, RESULTS(RT_NULL_RUNS)},
        {"bench --json --distribution: distributions", false, NULL, RESULTS(RT_DISTRIBUTIONS)},
        {"bench --json --callgrind: instructions", false, NULL, .table = of_instructions()},
        {"compare --json: cells", false, NULL, .table = of_comparison(false)},
        {"compare --json: accelerators", false, NULL, .table = of_comparison(true)},
        {"verify --json: rows", false, NULL, .table = verify_json},
        {"info --extents --json: extents.rows", false, NULL, .table = extents},
    };
    memcpy(sections, all, sizeof all);
}

/* ---- the document ---- */

/* A column of a section, found anew for each row of its description. */
typedef struct Row {
    const Section *sections; /* all; the row's is sections[number] */
    size_t number;
    const char *group;
    const RtTableColumn *column;
} Row;

static RtField name_of(const Row *r) {
    bool csv = r->sections[r->number].csv;
    const char *name = csv ? r->column->id : r->column->name;
    bool in_group = r->group && !csv;
    return rt_field_print("`%s%s%s`", in_group ? r->group : "", in_group ? "." : "", name);
}

static RtField form_of(const Row *r) {
    const char *unit = r->column->unit;
    return rt_field_print("%s%s%s", rt_form_name(r->column->form), *unit ? ", " : "", unit);
}

#define COLUMNS(X)                                                                                           \
    X(column, "column", markup, "", "", name_of(r))                                                          \
    X(form, "form, unit", markup, "", "", form_of(r))                                                        \
    X(meaning, "meaning", text, "", "", r->column->meaning)
RT_TABLE_COLUMNS(columns, COLUMNS)

static size_t column_count(const Section *section) {
    size_t count = 0;
    for (size_t g = 0; g < section->table.group_count; g++) count += section->table.groups[g].count;
    return count;
}

static void find_column(Row *r, size_t i) {
    const RtColumnGroup *group = r->sections[r->number].table.groups;
    for (; i >= group->count; group++) i -= group->count;
    r->group = group->name;
    r->column = &group->columns[i];
}

/* Whether column i of the section is described before it, in this section or in an earlier one. */
static bool is_described(const Row *r, size_t i) {
    for (size_t s = 0; s <= r->number; s++) {
        Row other = {.sections = r->sections, .number = s};
        size_t count = s == r->number ? i : column_count(&r->sections[s]);
        for (size_t k = 0; k < count; k++) {
            find_column(&other, k);
            if (strcmp(other.column->id, r->column->id) == 0 &&
                strcmp(other.column->meaning, r->column->meaning) == 0)
                return true;
        }
    }
    return false;
}

static const void *new_column_at(void *context, size_t i) {
    Row *r = context;
    find_column(r, i);
    return is_described(r, i) ? NULL : r;
}

/* Lists the columns that are described before; a group of them by its name. Returns how many there are. */
static size_t print_above(Row *r, FILE *out) {
    const RtTable *table = &r->sections[r->number].table;
    size_t above = 0;
    for (size_t g = 0, first = 0; g < table->group_count; first += table->groups[g++].count) {
        const RtColumnGroup *group = &table->groups[g];
        size_t known = 0;
        for (size_t i = 0; i < group->count; i++) known += !new_column_at(r, first + i);
        bool whole = group->name && known == group->count && !r->sections[r->number].csv;
        for (size_t i = 0; i < group->count; i++) {
            if (new_column_at(r, first + i) || (whole && i > 0)) continue;
            fputs(above++ ? ", " : "As above: ", out);
            if (whole)
                fprintf(out, "`%s.*`", group->name);
            else
                fputs(name_of(r).buffer, out);
        }
        above += whole ? known - 1 : 0;
    }
    return above;
}

static void print_section(Row *r, FILE *out) {
    static const RtColumnGroup groups[] = {RT_ALL(columns)};
    const Section *section = &r->sections[r->number];
    fprintf(out, "\n## %s\n\n", section->title);
    size_t count = column_count(section), above = print_above(r, out);
    if (above) fputs(above < count ? ".\n\n" : ".\n", out);
    if (above < count)
        rt_table_markdown(&(RtTable){RT_GROUPS(groups), count, new_column_at, .context = r}, out);
}

static void print_document(FILE *out) {
    Section sections[SECTIONS];
    list(sections);
    fputs("# Columns\n\n"
          "All columns of the CSV files and all members of the JSON documents. Each is described where it\n"
          "occurs first. `build/release/test_cli columns` generates this page from the program's tables; if\n"
          "the page is out of date, the test writes the current one and says where. An unknown value is\n"
          "empty in CSV and null in JSON. In JSON, a dot in a name separates an object from its member\n"
          "(`counts.*`: all members of `counts`), yes is true, no is false, and an interval is an object of\n"
          "three numbers.\n\n",
          out);
    for (size_t i = 0, named = 0; i < SECTIONS; i++) {
        if (sections[i].swept) fprintf(out, "%s`%s`", named++ ? ", " : "", sections[i].title);
    }
    fputs("\nend with a column for each parameter that the experiment sweeps: `scene.KEY` or\n"
          "`accel.KEY`, as in `accel.density`, empty where a row has no such parameter. If an accelerator\n"
          "refuses a scene, a column `refused` before them says why; its rows have no measurements.\n",
          out);
    for (size_t i = 0; i < SECTIONS; i++) print_section(&(Row){.sections = sections, .number = i}, out);
}

RT_TEST(the_document_says_what_the_columns_say) {
    char *text, *committed;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    print_document(out);
    fclose(out);
    assert_ok(rt_file_read(RT_SOURCE_DIR "/docs/columns.md", 1 << 20, &committed, &size, error));
    if (strcmp(text, committed) != 0) {
        FILE *right = fopen(RT_BINARY_DIR "/columns.md", "w");
        assert_non_null(right);
        fputs(text, right);
        fclose(right);
        fail_msg("docs/columns.md is out of date: copy " RT_BINARY_DIR "/columns.md to it");
    }
    free(text);
    rt_free(committed);
}

RT_TEST(every_column_has_a_meaning_and_a_name_of_its_own) {
    Section sections[SECTIONS];
    list(sections);
    for (size_t i = 0; i < SECTIONS; i++) {
        Row row = {.sections = sections, .number = i}, other = row;
        size_t count = column_count(&sections[i]);
        assert_true(count <= RT_MAX_TABLE_COLUMNS);
        for (size_t k = 0; k < count; k++) {
            find_column(&row, k);
            assert_true(*row.column->meaning);
            for (size_t earlier = 0; earlier < k; earlier++) {
                find_column(&other, earlier);
                if (strcmp(name_of(&row).buffer, name_of(&other).buffer) == 0)
                    fail_msg("%s has two columns %s", sections[i].title, row.column->name);
            }
        }
    }
}

RT_TEST(the_files_that_are_kept_have_these_columns) {
    Section sections[SECTIONS];
    list(sections);
    for (size_t i = 0; i < SECTIONS; i++) {
        Row row = {.sections = sections, .number = i};
        Csv csv;
        if (!sections[i].example) continue;
        read_csv(&csv, sections[i].example);
        assert_int_equal(csv.columns, column_count(&sections[i]));
        for (uint32_t c = 0; c < csv.columns; c++) {
            find_column(&row, c);
            assert_string_equal(csv_name(&csv, c), row.column->id);
        }
        clear_csv(&csv);
    }
}

/* ---- pages of accelerators ---- */

/* A file of the source tree, for rt_free. */
static char *read_document(const char *name) {
    char path[1024], *text;
    size_t size;
    snprintf(path, sizeof path, "%s/%s", RT_SOURCE_DIR, name);
    assert_ok(rt_file_read_text(path, 1 << 20, &text, &size, error));
    return text;
}

RT_TEST(every_accelerator_has_a_page_with_its_parameters) {
    OWNED_MEMORY char *index = read_document("docs/accelerators/README.md");
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        char path[96], row[1024];
        snprintf(row, sizeof row, "\n| [%s](%s.md) |", ops->name, ops->name);
        if (!strstr(index, row)) fail_msg("docs/accelerators/README.md lacks a row%s", row);
        snprintf(path, sizeof path, "docs/accelerators/%s.md", ops->name);
        OWNED_MEMORY char *page = read_document(path);
        for (size_t k = 0; k < ops->param_count; k++) {
            snprintf(row, sizeof row, "\n| `%s` | %s |", ops->params[k].name, ops->params[k].default_text);
            if (!strstr(page, row)) fail_msg("%s lacks a row%s", path, row);
        }
    }
}

RT_TESTS(columns, NULL, NULL)
