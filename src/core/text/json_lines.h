/* SPDX-License-Identifier: Apache-2.0 */
/* Files of one JSON object a line, each on the disk before the next is found out: what an interrupted run
 * goes on from. A last line that was cut off is none. */
#ifndef RT_TEXT_JSON_LINES_H
#define RT_TEXT_JSON_LINES_H

#include "core/base/file.h"

#include <jansson.h>

typedef struct RtJsonLines {
    FILE *file;
    char path[RT_MAX_PATH];
} RtJsonLines;

/* Opens the file at `path` for writing, behind what is there. With `first`, which is borrowed, that line
 * alone takes the place of all that was there: a failure, or an end of the process at any time, leaves the
 * one or the other whole. Close with rt_json_lines_close, also after a failure. */
RtStatus rt_json_lines_open(RtJsonLines *lines, const char *path, const json_t *first, RtError *error);
void rt_json_lines_close(RtJsonLines *lines);

/* Writes all lines of an array, borrowed, to a file that is open; a failure discards it. */
RtStatus rt_json_lines_put(RtOutput *output, const json_t *lines, RtError *error);

/* The lines of an array, borrowed, take the place of all that was there, as above. */
RtStatus rt_json_lines_save(const char *path, const json_t *lines, RtError *error);

/* Writes one line; it is on the disk when this returns. Takes the reference; NULL is memory that is short. */
RtStatus rt_json_lines_write(RtJsonLines *lines, json_t *line, RtError *error);

/* All lines of the file, those that are not JSON as null, as a new array. Refuses a file without any. */
RtStatus rt_json_lines_load(const char *path, json_t **lines, RtError *error);

#endif
