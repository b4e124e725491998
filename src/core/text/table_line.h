/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by the writers of tables (table.c: CSV, text, JSON; table_markup.c: Markdown, LaTeX): a row
 * with its fields, and the walk over all rows. */
#ifndef RT_TEXT_TABLE_LINE_H
#define RT_TEXT_TABLE_LINE_H

#include "core/text/table.h"

/* The fields of a row, in the order of the columns. */
typedef struct RtTableLine {
    size_t count;
    const RtTableColumn *columns[RT_MAX_TABLE_COLUMNS];
    RtField fields[RT_MAX_TABLE_COLUMNS];
} RtTableLine;

typedef struct RtTableWriter RtTableWriter;
struct RtTableWriter {
    const RtTable *table;
    void (*put)(RtTableWriter *writer, const RtTableLine *line, const void *row); /* `row` NULL: the header */
    FILE *out;
    int *widths;  /* of text */
    json_t *page; /* of rt_table_page */
};

/* Writes the header and then each row. */
void rt_table_walk(RtTableWriter writer);

/* True if the column's fields are numbers, which are right-aligned. */
bool rt_column_is_number(const RtTableColumn *column);

/* The same, or numbers with intervals. */
bool rt_column_is_measured(const RtTableColumn *column);

/* Field `i` as text; in `buffer` or the line. */
const char *rt_line_show(const RtTableLine *line, size_t i, char buffer[RT_MAX_FIELD]);

#endif
