/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text/json.h"

#include "core/base/memory.h"
#include "core/base/versions.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>
#include <zlib.h>

static atomic_bool ran_out;

static void *allocate(size_t size) {
    void *block = malloc(size);
    if (!block && size > 0) atomic_store(&ran_out, true);
    return block;
}

void rt_json_watch_memory(void) {
    json_set_alloc_funcs(allocate, free);
}

RtStatus rt_json_check_memory(const char *what, RtError *error) {
    return atomic_load(&ran_out) ? rt_fail_memory(error, what, 0) : RT_OK;
}

json_t *rt_json_number(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

json_t *rt_json_hex(uint64_t value) {
    return json_sprintf("%016" PRIx64, value);
}

json_t *rt_json_now(void) {
    char date[32];
    time_t now = time(NULL);
    struct tm utc;
    strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", gmtime_r(&now, &utc));
    return json_string(date);
}

const char *rt_json_text(const json_t *object, const char *key, const char *otherwise) {
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : otherwise;
}

RtStatus rt_json_check_format(const json_t *document, const char *path, RtError *error) {
    const json_t *member = json_object_get(document, "format");
    const int64_t format = json_integer_value(member);
    if (!member || (format >= 1 && format <= RT_FILE_FORMAT)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: " RT_FORMAT_UNKNOWN, path, format, RT_FILE_FORMAT);
}

RtStatus rt_json_save(const char *path, json_t *document, RtError *error) {
    RtOutput output;
    RtStatus status = document ? rt_json_check_memory(path, error) : rt_fail_memory(error, path, 0);
    if (status == RT_OK) status = rt_output_open(&output, path, error);
    if (status == RT_OK) {
        bool whole = json_dumpf(document, output.file, JSON_INDENT(2) | JSON_REAL_PRECISION(9)) == 0;
        fputc('\n', output.file);
        /* A failed write is reported by the output; any other failure is short memory. */
        if (whole || ferror(output.file)) {
            status = rt_output_commit(&output, error);
        } else {
            rt_output_discard(&output);
            status = rt_fail_memory(error, path, 0);
        }
    }
    json_decref(document);
    return status;
}

json_t *rt_json_add(json_t *json, const char *key, json_t *value) {
    if (json_object_set_new(json, key, value) == 0) return json;
    json_decref(json);
    return NULL;
}

uint64_t rt_json_parse_hex(const json_t *value, bool *good) {
    const char *text = json_string_value(value);
    uint64_t number = 0;
    *good = text && strlen(text) == 16 && strspn(text, "0123456789abcdef") == 16 &&
            sscanf(text, "%16" SCNx64, &number) == 1;
    return *good ? number : 0;
}

/* ---- lines ---- */

enum { MOST_BYTES = 1 << 28 };

/* Removes an incomplete last line. */
static RtStatus trim(const char *path, RtError *error) {
    char *text;
    size_t size;
    RT_TRY(rt_file_read(path, MOST_BYTES, &text, &size, error));
    while (size > 0 && text[size - 1] != '\n') size--;
    rt_free(text);
    if (truncate(path, (off_t)size) == 0) return RT_OK;
    return rt_fail(error, RT_IO, "%s: truncating failed: %s", path, strerror(errno));
}

static bool put_line(const json_t *line, FILE *file) {
    return json_dumpf(line, file, JSON_COMPACT | JSON_REAL_PRECISION(17)) == 0 && fputc('\n', file) != EOF;
}

RtStatus rt_json_lines_put(RtOutput *output, const json_t *lines, RtError *error) {
    RtStatus status = rt_json_check_memory(output->path, error);
    bool put = status == RT_OK;
    for (size_t i = 0; put && i < json_array_size(lines); i++)
        put = put_line(json_array_get(lines, i), output->file);
    if (put) return RT_OK;
    if (status == RT_OK) status = rt_fail(error, RT_IO, "%s: writing failed", output->path);
    rt_output_discard(output);
    return status;
}

RtStatus rt_json_lines_save(const char *path, const json_t *lines, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    RT_TRY(rt_json_lines_put(&output, lines, error));
    return rt_output_commit(&output, error);
}

static RtStatus begin(const char *path, const json_t *first, RtError *error) {
    json_t *lines = json_pack("[O]", first);
    if (!lines) return rt_fail_memory(error, path, 0);
    RtStatus status = rt_json_lines_save(path, lines, error);
    json_decref(lines);
    return status;
}

RtStatus rt_json_lines_open(RtJsonLines *lines, const char *path, const json_t *first, RtError *error) {
    lines->file = NULL;
    snprintf(lines->path, sizeof lines->path, "%s", path);
    RT_TRY(first ? begin(path, first, error) : trim(path, error));
    lines->file = fopen(path, "ab");
    if (lines->file) return RT_OK;
    return rt_fail(error, RT_IO, "%s: cannot be written: %s", path, strerror(errno));
}

void rt_json_lines_close(RtJsonLines *lines) {
    if (lines->file) fclose(lines->file);
    lines->file = NULL;
}

RtStatus rt_json_lines_write(RtJsonLines *lines, json_t *line, RtError *error) {
    RtStatus status = line ? rt_json_check_memory(lines->path, error) : rt_fail_memory(error, lines->path, 0);
    bool put = status == RT_OK && put_line(line, lines->file);
    json_decref(line);
    if (status != RT_OK) return status;
    if (put && fflush(lines->file) == 0 && fdatasync(fileno(lines->file)) == 0) return RT_OK;
    return rt_fail(error, RT_IO, "%s: writing failed: %s", lines->path, strerror(errno));
}

/* Reads to the end. *text is for rt_free, also after a failure. */
static RtStatus unpack(gzFile file, const char *path, char **text, size_t *size, RtError *error) {
    enum { CHUNK = 1 << 16 };
    uint32_t capacity = 0;
    for (int got = CHUNK; got == CHUNK; *size += (size_t)got) {
        if (*size > MOST_BYTES) return rt_fail(error, RT_BAD_INPUT, "%s: it is too large", path);
        RT_TRY(rt_reserve(text, &capacity, *size + CHUNK, 1, error));
        got = gzread(file, *text + *size, CHUNK);
        if (got < 0) return rt_fail(error, RT_BAD_INPUT, "%s: it is damaged", path);
    }
    return RT_OK;
}

/* The file, or if it is missing the one that gzip has made of it. */
static RtStatus read_file(const char *path, char **text, size_t *size, RtError *error) {
    char packed[RT_MAX_PATH];
    snprintf(packed, sizeof packed, "%s.gz", path);
    if (rt_file_exists(path) || !rt_file_exists(packed))
        return rt_file_read(path, MOST_BYTES, text, size, error);
    gzFile file = gzopen(packed, "rb");
    *text = NULL;
    *size = 0;
    if (!file) return rt_fail(error, RT_BAD_INPUT, "%s: cannot be opened: %s", packed, strerror(errno));
    RtStatus status = unpack(file, packed, text, size, error);
    const bool whole = gzclose_r(file) == Z_OK;
    if (status == RT_OK && !whole) status = rt_fail(error, RT_BAD_INPUT, "%s: it is damaged", packed);
    if (status != RT_OK) rt_free(*text);
    return status;
}

RtStatus rt_json_lines_load(const char *path, json_t **lines, RtError *error) {
    char *text;
    size_t size;
    RT_TRY(read_file(path, &text, &size, error));
    *lines = json_array();
    for (const char *line = text, *end; (end = memchr(line, '\n', (size_t)(text + size - line)));
         line = end + 1) {
        json_t *object = json_loadb(line, (size_t)(end - line), 0, NULL);
        json_array_append_new(*lines, object ? object : json_null());
    }
    rt_free(text);
    RtStatus status = rt_json_check_memory(path, error);
    if (status == RT_OK && json_array_size(*lines) > 0) return RT_OK;
    json_decref(*lines);
    *lines = NULL;
    if (status != RT_OK) return status;
    return rt_fail(error, RT_BAD_INPUT, "%s: the journal is empty: start over with --force", path);
}
