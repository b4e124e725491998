/* SPDX-License-Identifier: Apache-2.0 */
/* Every accelerator has a page with its parameters and their defaults. */
#include "testing.h"

#include "accel/accel.h"
#include "core/base/file.h"

#include <stdio.h>
#include <string.h>

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

RT_TESTS(docs, NULL, NULL)
