/* SPDX-License-Identifier: Apache-2.0 */
/* The documents say what the program says: accelerators in README.md, parameters in docs/accelerators; and
 * the tests that they name are there. */
#include "testing.h"

#include "accel/accel.h"

#include <glob.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct Text {
    char chars[16384];
    size_t length;
} Text;

__attribute__((format(printf, 2, 3))) static void append(Text *text, const char *format, ...) {
    va_list args;
    va_start(args, format);
    size_t size = sizeof text->chars - text->length;
    int n = vsnprintf(text->chars + text->length, size, format, args);
    va_end(args);
    assert_true(n >= 0 && (size_t)n < size);
    text->length += (size_t)n;
}

/* A cell of a Markdown table: its bars are escaped. */
static void append_cell(Text *text, const char *cell) {
    append(text, "| ");
    for (; *cell; cell++) append(text, "%s%c", *cell == '|' ? "\\" : "", *cell);
    append(text, " ");
}

/* The table of parameters, as a page has it. */
static void write_parameters(Text *text, const RtAccelOps *ops) {
    if (ops->param_count == 0) return;
    append(text, "\n\n## Parameters\n\n| parameter | default | range | meaning | source of the default |\n");
    append(text, "| --- | --- | --- | --- | --- |\n");
    for (size_t i = 0; i < ops->param_count; i++) {
        const RtParam *p = &ops->params[i];
        char range[RT_MAX_SPEC_CHARS];
        rt_param_range(p, range, sizeof range);
        append(text, "| `%s` ", p->name);
        append_cell(text, p->default_text);
        append_cell(text, range);
        append_cell(text, p->meaning);
        append_cell(text, p->source);
        append(text, "|\n");
    }
}

/* A file of the source tree, for free(). */
static char *read_document(const char *name) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", RT_SOURCE_DIR, name);
    FILE *file = fopen(path, "rb");
    if (!file) fail_msg("%s cannot be read", path);
    enum { ROOM = 1 << 20 };
    char *text = malloc(ROOM);
    assert_non_null(text);
    size_t length = fread(text, 1, ROOM - 1, file);
    text[length] = '\0';
    fclose(file);
    return text;
}

/* The papers without their titles: of each, what stands before the first comma behind a year. */
static void append_papers(Text *text, const char *papers) {
    for (const char *paper = papers; paper; paper = strstr(paper, "; ") ? strstr(paper, "; ") + 2 : NULL) {
        size_t length = strcspn(paper, ";"), end = length;
        for (size_t i = 4; i <= length && end == length; i++)
            if (strspn(paper + i - 4, "0123456789") == 4) end = i;
        append(text, "%s%.*s", paper == papers ? "" : "; ", (int)end, paper);
    }
}

RT_TEST(the_readme_lists_every_accelerator) {
    char *readme = read_document("README.md");
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        char file[1024];
        snprintf(file, sizeof file, "%s/accel/%s.c", RT_SOURCE_DIR, ops->name);
        const char *extension = access(file, F_OK) == 0 ? ".c" : "";
        Text row = {.length = 0};
        append(&row, "\n| [`%s`](docs/accelerators/%s.md) | %s | ", ops->name, ops->name, ops->summary);
        append_papers(&row, ops->paper);
        append(&row, " | [accel/%s%s](accel/%s%s) |", ops->name, extension, ops->name, extension);
        if (!strstr(readme, row.chars)) fail_msg("the table of README.md lacks a row%s", row.chars);
    }
    free(readme);
}

RT_TEST(every_accelerator_has_a_page_with_its_parameters_as_they_are) {
    char *index = read_document("docs/accelerators/README.md");
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        char path[96], entry[96];
        snprintf(path, sizeof path, "docs/accelerators/%s.md", ops->name);
        snprintf(entry, sizeof entry, "\n| [%s](%s.md) |", ops->name, ops->name);
        if (!strstr(index, entry)) fail_msg("the table of docs/accelerators/README.md lacks a row%s", entry);
        char *page = read_document(path);
        Text table = {.length = 0};
        write_parameters(&table, ops);
        if (!strstr(page, table.chars)) fail_msg("%s lacks:%s", path, table.chars);
        free(page);
    }
    free(index);
}

/* Extent tests stand beside object tests. */
RT_TEST(pictures_show_what_is_said_of_them) {
    char *picture = read_document("results/reference/havran-1999/plots/3-best.svg");
    char *page = read_document("results/reference/havran-1999/best.csv");
    assert_non_null(
        strstr(page, "\nballs,object_tests,Octree93-A depth=7,6.59771,item+light+bvh,1.12005,8.81136,"));
    assert_non_null(strstr(picture, "1.1 + 8.8  item+light+bvh"));
    free(picture);
    free(page);
}

static bool is_name(const char *code) {
    return code[strspn(code, "abcdefghijklmnopqrstuvwxyz0123456789_.")] == '\0' && strchr(code, '_');
}

/* A name behind `tests/FILE` is in that file; dots stand for how it begins. How many files are named. */
static size_t check_line(const char *document, char *line) {
    size_t files = 0;
    char *tests = NULL;
    strsep(&line, "`");
    for (char *code; (code = strsep(&line, "`")); strsep(&line, "`")) {
        if (strncmp(code, "tests/", 6) == 0 && !strchr(code, '*')) {
            free(tests);
            code[strcspn(code, " ")] = '\0'; /* its arguments */
            tests = read_document(code);
            files++;
        } else if (tests && is_name(code) && !strstr(tests, code + strspn(code, "."))) {
            fail_msg("%s names %s, which is not there", document, code);
        }
    }
    free(tests);
    return files;
}

RT_TEST(tests_that_documents_name_are_there) {
    glob_t found;
    size_t files = 0;
    assert_int_equal(glob("*.md", 0, NULL, &found), 0);
    assert_int_equal(glob("*/*.md", GLOB_APPEND, NULL, &found), 0);
    assert_int_equal(glob("*/*/*.md", GLOB_APPEND, NULL, &found), 0);
    for (size_t i = 0; i < found.gl_pathc; i++) {
        char *text = read_document(found.gl_pathv[i]), *rest = text;
        while (rest) files += check_line(found.gl_pathv[i], strsep(&rest, "\n"));
        free(text);
    }
    assert_true(files >= 20);
    globfree(&found);
}

RT_TESTS(docs, NULL, NULL)
