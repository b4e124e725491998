/* SPDX-License-Identifier: Apache-2.0 */
/* JSON helpers: numbers that may be unknown, fingerprints, dates, and documents as files. */
#ifndef RT_TEXT_JSON_H
#define RT_TEXT_JSON_H

#include "core/base/file.h"

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

/* If memory is short, json_object_set_new and others leave out a part of the document without an error. A
 * program that calls rt_json_watch_memory before it uses jansson does not write such a document: once memory
 * was short, rt_json_check_memory returns RT_NO_MEMORY for `what`. */
void rt_json_watch_memory(void);
RtStatus rt_json_check_memory(const char *what, RtError *error);

/* Each of these returns a new reference, or NULL if memory is short; json_pack then returns NULL, too. */

/* The number; null for NAN and infinities. */
json_t *rt_json_number(double value);

/* A fingerprint: 16 hexadecimal digits. */
json_t *rt_json_hex(uint64_t value);

/* Adds one value to `json`. Takes both references; returns `json`, or NULL if one of them is NULL or memory
 * is short. */
json_t *rt_json_add(json_t *json, const char *key, json_t *value);

/* The current date and time, UTC: "2001-04-30T12:00:00Z". */
json_t *rt_json_now(void);

/* The text of a member, borrowed; `otherwise` if there is none. */
const char *rt_json_text(const json_t *object, const char *key, const char *otherwise);

/* The fingerprint that rt_json_hex wrote; *good false if `value` is none. */
uint64_t rt_json_parse_hex(const json_t *value, bool *good);

/* Rejects the document of the file `path` if its member `format` is not a format that this version reads.
 * Without the member it is of format 1, as 0.1 wrote. */
RtStatus rt_json_check_format(const json_t *document, const char *path, RtError *error);

/* Writes `document`, indented, to `path`, completely or not at all. NULL counts as short memory. Takes the
 * reference. */
RtStatus rt_json_save(const char *path, json_t *document, RtError *error);

/* ---- lines ---- */

/* Files with one JSON object per line, each flushed to disk before the next result is computed, so that an
 * interrupted run can resume. An incomplete last line is ignored. */
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
