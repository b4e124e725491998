/* SPDX-License-Identifier: Apache-2.0 */
/* CSV files with a header (RFC 4180): fields quoted where commas or quotes ask for it, none across lines.
 * Lines that begin with # are comments. */
#ifndef RT_TEXT_CSV_H
#define RT_TEXT_CSV_H

#include "core/base/status.h"

#include <stdint.h>
#include <stdio.h>

typedef struct RtCsv {
    const char *path; /* borrowed */
    char *text;       /* owned; the fields lie in it */
    char **fields;    /* [rows + 1][columns], the header first */
    uint32_t *lines;  /* [rows], of the file, from 1 */
    uint32_t rows, columns;
} RtCsv;

/* Reads the file at `path`, which has to stay as long as the table. Refuses an empty one, a row with more or
 * fewer fields than the header, a quote that is not closed, and a byte 0. Clear with rt_csv_clear, also after
 * a failure. */
RtStatus rt_csv_read(RtCsv *csv, const char *path, RtError *error);
void rt_csv_clear(RtCsv *csv);

/* The column of that name; csv->columns where there is none. */
uint32_t rt_csv_find(const RtCsv *csv, const char *name);

/* Name of a column, and a field; that of the column csv->columns is "". */
const char *rt_csv_name(const RtCsv *csv, uint32_t column);
const char *rt_csv_field(const RtCsv *csv, uint32_t row, uint32_t column);

/* Writes a field, quoted where it has to be. */
void rt_csv_put(FILE *out, const char *field);

#endif
