/* SPDX-License-Identifier: Apache-2.0 */
/* CSV files with a header (RFC 4180): fields may be quoted, but none spans lines. Lines that begin with #
 * are comments. */
#ifndef RT_TEXT_CSV_H
#define RT_TEXT_CSV_H

#include "core/base/status.h"

#include <stdint.h>
#include <stdio.h>

typedef struct RtCsv {
    const char *path; /* borrowed */
    char *text;       /* owned; contains the fields */
    char **fields;    /* [rows + 1][columns], the header first */
    uint32_t *lines;  /* [rows], of the file, from 1 */
    uint32_t rows, columns;
} RtCsv;

/* Reads the file at `path`; the string `path` must outlive the table. Rejects an empty file, a row with
 * more or fewer fields than the header, an unclosed quote, and a zero byte. Clear with rt_csv_clear, also
 * after a failure. */
RtStatus rt_csv_read(RtCsv *csv, const char *path, RtError *error);
void rt_csv_clear(RtCsv *csv);

/* The column of that name, or csv->columns if there is none. */
uint32_t rt_csv_find(const RtCsv *csv, const char *name);

/* The name of a column, and a field; in column csv->columns every field is "". */
const char *rt_csv_name(const RtCsv *csv, uint32_t column);
const char *rt_csv_field(const RtCsv *csv, uint32_t row, uint32_t column);

/* Writes a field, quoted if necessary. */
void rt_csv_put(FILE *out, const char *field);

#endif
