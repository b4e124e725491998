/* SPDX-License-Identifier: Apache-2.0 */
/* docs/columns.md is generated from the columns of all tables; the test says where the current page is. The
 * committed files have these columns. */
#include "testing.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/text/csv.h"
#include "experiment/callgrind.h"
#include "experiment/compare.h"
#include "experiment/distribution_tables.h"
#include "experiment/frame_table.h"
#include "experiment/result_tables.h"
#include "measure/extents_table.h"
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

static RtTable of_distributions(RtDistributionTable which) {
    static RtDistributionRow rows[2] = {{.results = &results}, {.results = &results}};
    return rt_distribution_table(which, &rows[which]);
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

static RtTable of_comparison(RtTable (*table)(RtComparedRow *row, bool all)) {
    static const RtComparison comparison = {0};
    static RtComparedRow row = {.comparison = &comparison};
    return table(&row, true);
}

typedef struct Section {
    const char *title;
    bool csv;
    const char *example; /* a CSV file that has these columns, or NULL */
    RtTable table;
    bool swept; /* has a column for each swept parameter, too */
} Section;

#define RESULTS(which) .table = of_results(which), .swept = rt_result_table_sweeps(which)

enum { SECTIONS = 18 };
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
        {"hardware.csv", true, NULL, RESULTS(RT_HARDWARE)},
        {"distributions.csv", true, NULL, .table = of_distributions(RT_DISTRIBUTIONS)},
        {"histograms.csv", true, NULL, .table = of_distributions(RT_HISTOGRAMS)},
        {"verify.csv", true, "results/reference/verify/verify.csv", .table = verify_csv},
        {"bench --json: rows", false, NULL, RESULTS(RT_BENCH)},
        {"bench --json: null_runs", false, NULL, RESULTS(RT_NULL_RUNS)},
        {"bench --json --hardware: hardware", false, NULL, RESULTS(RT_HARDWARE)},
        {"bench --json --distribution: distributions", false, NULL,
         .table = of_distributions(RT_DISTRIBUTIONS)},
        {"bench --json --callgrind: instructions", false, NULL, .table = of_instructions()},
        {"compare --json: cells", false, NULL, .table = of_comparison(rt_comparison_table)},
        {"compare --json: accelerators", false, NULL, .table = of_comparison(rt_compared_accels_table)},
        {"verify --json: rows", false, NULL, .table = verify_json},
        {"info --extents --json: extents.rows", false, NULL, .table = extents},
    };
    memcpy(sections, all, sizeof all);
}

/* ---- the document ---- */

/* A column of the table that is described; it is found anew for each row. */
typedef struct Row {
    const Section *section;
    const char *group;
    const RtTableColumn *column;
} Row;

static RtField name_of(const Row *r) {
    const char *name = r->section->csv ? r->column->id : r->column->name;
    bool in_group = r->group && !r->section->csv;
    return rt_field_print("`%s%s%s`", in_group ? r->group : "", in_group ? "." : "", name);
}

#define COLUMNS(X)                                                                                           \
    X(column, "column", markup, "", "", name_of(r))                                                          \
    X(form, "form", text, "", "", rt_form_name(r->column->form))                                             \
    X(unit, "unit", text, "", "", r->column->unit)                                                           \
    X(meaning, "meaning", text, "", "", r->column->meaning)
RT_TABLE_COLUMNS(columns, COLUMNS)

static const void *column_at(void *context, size_t i) {
    Row *r = context;
    const RtColumnGroup *group = r->section->table.groups;
    for (; i >= group->count; group++) i -= group->count;
    r->group = group->name;
    r->column = &group->columns[i];
    return r;
}

static size_t column_count(const RtTable *table) {
    size_t count = 0;
    for (size_t g = 0; g < table->group_count; g++) count += table->groups[g].count;
    return count;
}

static void print_document(FILE *out) {
    static const RtColumnGroup groups[] = {RT_ALL(columns)};
    Section sections[SECTIONS];
    list(sections);
    fputs("# Columns\n\n"
          "The columns of all CSV files and the members of all JSON documents: name, form, unit and\n"
          "meaning. The page is generated from the program's tables: if it is out of date,\n"
          "`build/release/test_cli columns` fails and writes the current page, to be copied here. An\n"
          "unknown value is empty in CSV and null in JSON. In JSON a dot in a name separates an object\n"
          "from its member; yes is true, no is false, and an interval is an object of three numbers.\n"
          "CSV and JSON call the same thing alike: `scene` and `accel` are labels, whole however long,\n"
          "`scene_spec` the scene as it is opened, `spec` the accelerator with every effective parameter.\n"
          "\n"
          "If an experiment sweeps parameters, these have one more column for each of them, at the end:\n",
          out);
    for (size_t i = 0, named = 0; i < SECTIONS; i++) {
        if (sections[i].swept) fprintf(out, "%s`%s`", named++ ? ", " : "", sections[i].title);
    }
    fputs(
        ".\n`scene.KEY` is a parameter of scenes, `accel.KEY` one of accelerators, as in `accel.density`. "
        "It is\n"
        "empty if the row has no such parameter. Before them stands `refused` if an accelerator refuses a\n"
        "scene: its rows say there why, and have no measurements. All other columns are the same for every\n"
        "experiment.\n",
        out);
    for (size_t i = 0; i < SECTIONS; i++) {
        Row row = {.section = &sections[i]};
        const RtTable table = {RT_GROUPS(groups), .row_count = column_count(&sections[i].table),
                               .row = column_at, .context = &row};
        fprintf(out, "\n## %s\n\n", sections[i].title);
        rt_table_markdown(&table, out);
    }
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
        Row row = {.section = &sections[i]}, other = row;
        size_t count = column_count(&sections[i].table);
        assert_true(count <= RT_MAX_TABLE_COLUMNS);
        for (size_t k = 0; k < count; k++) {
            column_at(&row, k);
            assert_true(*row.column->meaning);
            for (size_t earlier = 0; earlier < k; earlier++) {
                column_at(&other, earlier);
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
        Row row = {.section = &sections[i]};
        RtCsv csv;
        if (!sections[i].example) continue;
        assert_ok(rt_csv_read(&csv, sections[i].example, error));
        assert_int_equal(csv.columns, column_count(&sections[i].table));
        for (uint32_t c = 0; c < csv.columns; c++) {
            column_at(&row, c);
            assert_string_equal(rt_csv_name(&csv, c), row.column->id);
        }
        rt_csv_clear(&csv);
    }
}

/* A new counter has a column in each of these but the times, a new prediction or quality in each. */
RT_TEST(every_counter_prediction_and_quality_is_in_counts_times_and_bench) {
    static const RtResultTable all[] = {RT_COUNTS, RT_BENCH, RT_TIMES};
    for (size_t i = 0; i < 3; i++) {
        char *text;
        size_t size;
        FILE *out = open_memstream(&text, &size);
        RtTable table = of_results(all[i]);
        rt_table_csv(&table, out);
        fclose(out);
#define IN_TABLE(name, meaning) assert_non_null(strstr(text, #name));
        if (all[i] != RT_TIMES) {
            RT_TALLY_COUNTERS(IN_TABLE)
        }
        RT_PREDICTIONS(IN_TABLE)
        RT_QUALITIES(IN_TABLE)
        free(text);
    }
}

RT_TESTS(columns, NULL, NULL)
