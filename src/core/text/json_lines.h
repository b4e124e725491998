/* SPDX-License-Identifier: Apache-2.0 */
/* Files with one JSON object per line, each flushed to disk before the next result is computed, so that an
 * interrupted run can resume. An incomplete last line is ignored. */
#ifndef RT_TEXT_JSON_LINES_H
#define RT_TEXT_JSON_LINES_H

#include "core/base/file.h"

#include <jansson.h>

typedef struct RtJsonLines {
    FILE *file;
    char path[RT_MAX_PATH];
} RtJsonLines;

/* Opens the file at `path` for appending. With `first` (borrowed), that line replaces the whole file: if
 * this fails, or the process dies at any time, either the old or the new content is complete. Close with
 * rt_json_lines_close, also after a failure. */
RtStatus rt_json_lines_open(RtJsonLines *lines, const char *path, const json_t *first, RtError *error);
void rt_json_lines_close(RtJsonLines *lines);

/* Writes all lines of an array (borrowed) to an open file; a failure discards the file. */
RtStatus rt_json_lines_put(RtOutput *output, const json_t *lines, RtError *error);

/* Replaces the whole file by the lines of an array (borrowed), as above. */
RtStatus rt_json_lines_save(const char *path, const json_t *lines, RtError *error);

/* Writes one line, which is on disk when this returns. Takes the reference; NULL counts as short memory. */
RtStatus rt_json_lines_write(RtJsonLines *lines, json_t *line, RtError *error);

/* Reads all lines of the file, or of `path`.gz if there is only that, into a new array; lines that are not
 * JSON become null. Rejects a file without lines. RT_BAD_INPUT if `path`.gz is damaged. */
RtStatus rt_json_lines_load(const char *path, json_t **lines, RtError *error);

#endif
