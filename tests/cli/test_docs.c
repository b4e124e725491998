/* SPDX-License-Identifier: Apache-2.0 */
/* Every accelerator has a page with its parameters and their defaults; tests that documents name are there.
 */
#include "testing.h"

#include "accel/accel.h"

#include <glob.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

RT_TEST(every_accelerator_has_a_page_with_its_parameters) {
    char *index = read_document("docs/accelerators/README.md");
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        char path[96], row[1024];
        snprintf(row, sizeof row, "\n| [%s](%s.md) |", ops->name, ops->name);
        if (!strstr(index, row)) fail_msg("docs/accelerators/README.md lacks a row%s", row);
        snprintf(path, sizeof path, "docs/accelerators/%s.md", ops->name);
        char *page = read_document(path);
        for (size_t k = 0; k < ops->param_count; k++) {
            snprintf(row, sizeof row, "\n| `%s` | %s |", ops->params[k].name, ops->params[k].default_text);
            if (!strstr(page, row)) fail_msg("%s lacks a row%s", path, row);
        }
        free(page);
    }
    free(index);
}

static bool is_name(const char *code) {
    return code[strspn(code, "abcdefghijklmnopqrstuvwxyz0123456789_.")] == '\0' && strchr(code, '_');
}

/* A name behind `tests/FILE` is in that file; dots stand for how it begins. Returns how many files are named.
 */
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
