#include "bench/json_lines.h"

#include "base/memory.h"

#include <errno.h>
#include <string.h>
#include <unistd.h>

enum { MOST_BYTES = 1 << 28 };

/* Cuts off what an interruption left behind the last whole line. */
static RtStatus trim(const char *path, RtError *error) {
    char *text;
    size_t size;
    RT_TRY(rt_file_read(path, MOST_BYTES, &text, &size, error));
    while (size > 0 && text[size - 1] != '\n') size--;
    rt_free(text);
    if (truncate(path, (off_t)size) == 0) return RT_OK;
    return rt_fail(error, RT_IO, "%s: truncating failed: %s", path, strerror(errno));
}

RtStatus rt_json_lines_open(RtJsonLines *lines, const char *path, bool append, RtError *error) {
    lines->file = NULL;
    snprintf(lines->path, sizeof lines->path, "%s", path);
    if (append) RT_TRY(trim(path, error));
    lines->file = fopen(path, append ? "ab" : "wb");
    if (lines->file) return RT_OK;
    return rt_fail(error, RT_IO, "%s: cannot be written: %s", path, strerror(errno));
}

void rt_json_lines_close(RtJsonLines *lines) {
    if (lines->file) fclose(lines->file);
    lines->file = NULL;
}

RtStatus rt_json_lines_write(RtJsonLines *lines, json_t *line, RtError *error) {
    if (!line) return rt_fail_memory(error, lines->path, 0);
    int failed = json_dumpf(line, lines->file, JSON_COMPACT | JSON_REAL_PRECISION(17));
    json_decref(line);
    if (!failed && fputc('\n', lines->file) != EOF && fflush(lines->file) == 0 &&
        fdatasync(fileno(lines->file)) == 0) {
        return RT_OK;
    }
    return rt_fail(error, RT_IO, "%s: writing failed: %s", lines->path, strerror(errno));
}

RtStatus rt_json_lines_load(const char *path, json_t **lines, RtError *error) {
    char *text;
    size_t size;
    RT_TRY(rt_file_read(path, MOST_BYTES, &text, &size, error));
    *lines = json_array();
    for (char *line = text, *end; (end = strchr(line, '\n')); line = end + 1) {
        json_t *object = json_loadb(line, (size_t)(end - line), 0, NULL);
        json_array_append_new(*lines, object ? object : json_null());
    }
    rt_free(text);
    if (json_array_size(*lines) > 0) return RT_OK;
    json_decref(*lines);
    *lines = NULL;
    return rt_fail(error, RT_BAD_INPUT, "%s: the journal is empty", path);
}
