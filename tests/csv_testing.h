/* SPDX-License-Identifier: Apache-2.0 */
/* CSV files with a header, as the program writes them: fields may be quoted, but none spans lines. */
#ifndef RT_TESTS_CSV_TESTING_H
#define RT_TESTS_CSV_TESTING_H

#include "testing.h"

#include "core/base/file.h"
#include "core/base/memory.h"

typedef struct Csv {
    char *text;    /* contains the fields */
    char **fields; /* [rows + 1][columns], the header first */
    uint32_t rows, columns;
} Csv;

static inline void clear_csv(Csv *csv) {
    rt_free(csv->text);
    rt_free(csv->fields);
}

#define OWNED_CSV OWNED(clear_csv) Csv

static inline void read_csv(Csv *csv, const char *path) {
    size_t size, count = 0;
    assert_ok(rt_file_read(path, 1 << 24, &csv->text, &size, error));
    csv->fields = rt_alloc(size, sizeof(char *));
    csv->columns = csv->rows = 0;
    for (char *at = csv->text, *to; *at; at++) {
        csv->fields[count++] = to = at;
        for (bool quoted = false; *at && (quoted || !strchr(",\n", *at)); at++) {
            if (*at == '"') quoted = !quoted;
            if (*at != '"' || (!quoted && at[1] == '"')) *to++ = *at;
        }
        if (*at != ',' && csv->columns == 0) csv->columns = (uint32_t)count;
        csv->rows += *at != ',';
        *to = '\0';
    }
    assert_int_equal(count, (size_t)csv->rows-- * csv->columns);
}

static inline const char *csv_name(const Csv *csv, uint32_t column) {
    return csv->fields[column];
}

static inline uint32_t csv_find(const Csv *csv, const char *name) {
    uint32_t column = 0;
    while (column < csv->columns && strcmp(csv->fields[column], name) != 0) column++;
    return column;
}

static inline const char *csv_field(const Csv *csv, uint32_t row, uint32_t column) {
    return column < csv->columns ? csv->fields[(size_t)(row + 1) * csv->columns + column] : "";
}

#endif
