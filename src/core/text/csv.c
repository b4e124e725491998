/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text/csv.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <string.h>

enum { MOST_BYTES = 1 << 24 };

/* Terminates the field that begins at `field`, removes its quotes, and returns the start of the next
 * field, or NULL after the last one of the line. Sets *bad if a quote is not closed or text follows it. */
static char *cut_field(char *field, bool *bad) {
    char *to = field, *from = field;
    if (*from == '"') {
        for (from++; *from && !(from[0] == '"' && from[1] != '"'); *to++ = *from++) from += *from == '"';
        *bad |= *from != '"' || (from[1] && from[1] != ',');
        from += *from == '"';
    } else {
        to = from += strcspn(from, ",");
    }
    char *next = *from == ',' ? from + 1 : NULL;
    *to = '\0';
    return next;
}

static uint32_t count_of(const char *text, char c) {
    uint32_t count = 0;
    for (; *text; text++) count += *text == c;
    return count;
}

/* Splits a line into the fields of row `csv->rows`; the header comes before all rows. */
static RtStatus take_line(RtCsv *csv, char *line, uint32_t number, bool header, RtError *error) {
    bool bad = false;
    uint32_t count = 0;
    char **fields = csv->fields + (header ? 0 : (size_t)(csv->rows + 1) * csv->columns);
    for (char *field = line, *next; field && count < csv->columns; field = next) {
        fields[count++] = field;
        next = cut_field(field, &bad);
        if (next && count == csv->columns) count++, next = NULL;
    }
    if (bad) return rt_fail_at(error, csv->path, number, 0, "a quote is not closed, or text follows it");
    if (count != csv->columns) {
        return rt_fail_at(error, csv->path, number, 0, "there are %s fields than in the header, which has %u",
                          count < csv->columns ? "fewer" : "more", csv->columns);
    }
    if (!header) csv->lines[csv->rows++] = number;
    return RT_OK;
}

static RtStatus take_text(RtCsv *csv, RtError *error) {
    /* An accepted row has as many fields as the header, and at most one more than it has commas. So the file
     * bounds the fields; its lines times its columns may be far more. */
    uint32_t number = 1, lines = count_of(csv->text, '\n') + 1, fields = lines + count_of(csv->text, ',');
    bool header = true;
    for (char *line = csv->text, *next; *line; line = next, number++) {
        size_t length = strcspn(line, "\n");
        next = line + length + (line[length] == '\n');
        line[length] = '\0';
        if (length && line[length - 1] == '\r') line[length - 1] = '\0';
        if (!*line || *line == '#') continue;
        if (header) {
            csv->columns = count_of(line, ',') + 1;
            csv->fields = rt_alloc(fields, sizeof(char *));
            csv->lines = rt_alloc(lines, sizeof(uint32_t));
            if (!csv->fields || !csv->lines) return rt_fail_memory(error, csv->path, 0);
        }
        RT_TRY(take_line(csv, line, number, header, error));
        header = false;
    }
    return header ? rt_fail(error, RT_BAD_INPUT, "%s: there is no header", csv->path) : RT_OK;
}

RtStatus rt_csv_read(RtCsv *csv, const char *path, RtError *error) {
    size_t size;
    *csv = (RtCsv){.path = path};
    RT_TRY(rt_file_read_text(path, MOST_BYTES, &csv->text, &size, error));
    return take_text(csv, error);
}

void rt_csv_clear(RtCsv *csv) {
    rt_free(csv->text);
    rt_free(csv->fields);
    rt_free(csv->lines);
    *csv = (RtCsv){0};
}

uint32_t rt_csv_find(const RtCsv *csv, const char *name) {
    uint32_t column = 0;
    while (column < csv->columns && strcmp(csv->fields[column], name) != 0) column++;
    return column;
}

const char *rt_csv_name(const RtCsv *csv, uint32_t column) {
    return csv->fields[column];
}

const char *rt_csv_field(const RtCsv *csv, uint32_t row, uint32_t column) {
    return column < csv->columns ? csv->fields[(size_t)(row + 1) * csv->columns + column] : "";
}

void rt_csv_put(FILE *out, const char *field) {
    /* A line that begins with # would be a comment; a carriage return before a line break belongs to that. */
    if (!strpbrk(field, ",\"\r\n") && *field != '#') {
        fputs(field, out);
        return;
    }
    fputc('"', out);
    for (; *field; field++) fprintf(out, *field == '"' ? "\"\"" : "%c", *field);
    fputc('"', out);
}
