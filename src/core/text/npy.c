/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text/npy.h"

#include "core/base/file.h"

#include <assert.h>
#include <inttypes.h>
#include <jansson.h>
#include <string.h>
#include <sys/stat.h>

enum {
    MAGIC_BYTES = 6,
    MOST_HEADER = 4096, /* bytes of text; an array of numbers needs about a hundred */
    MULTIPLE = 64       /* alignment of the numbers */
};
static const char MAGIC[MAGIC_BYTES + 1] = "\x93NUMPY";

/* ---- reading ---- */

/* The text of the header, terminated. */
static RtStatus read_text(RtNpy *npy, char text[MOST_HEADER + 1], RtError *error) {
    unsigned char start[MAGIC_BYTES + 2], size[4] = {0};
    if (fread(start, 1, sizeof start, npy->file) != sizeof start || memcmp(start, MAGIC, MAGIC_BYTES) != 0) {
        return rt_fail(error, RT_BAD_INPUT, "%s: this is not a NumPy array: write it with numpy.save",
                       npy->path);
    }
    unsigned major = start[MAGIC_BYTES], minor = start[MAGIC_BYTES + 1];
    if (major < 1 || major > 3 || minor != 0) {
        return rt_fail(error, RT_BAD_INPUT, "%s: unknown format version %u.%u: expected 1.0, 2.0 or 3.0",
                       npy->path, major, minor);
    }
    size_t bytes = major == 1 ? 2 : 4;
    if (fread(size, 1, bytes, npy->file) != bytes)
        return rt_fail(error, RT_BAD_INPUT, "%s: the file ends within its header", npy->path);
    uint32_t length = size[0] | (uint32_t)size[1] << 8 | (uint32_t)size[2] << 16 | (uint32_t)size[3] << 24;
    if (length > MOST_HEADER) {
        return rt_fail(error, RT_BAD_INPUT, "%s: a header of %" PRIu32 " bytes: at most %d are read",
                       npy->path, length, MOST_HEADER);
    }
    if (fread(text, 1, length, npy->file) != length)
        return rt_fail(error, RT_BAD_INPUT, "%s: the file ends within its header", npy->path);
    text[length] = '\0';
    if (strlen(text) == length) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: the header contains a zero byte", npy->path);
}

/* {'descr': '<f4', 'fortran_order': False, 'shape': (7, 8), } as JSON: brackets instead of parentheses,
 * double quotes, `false`, and no comma before a bracket. */
static void write_json(const char *text, char *out) {
    char quote = '\0'; /* that began the string around `text` */
    for (; *text; text++) {
        const char next = text[1 + strspn(text + 1, " \t\r\n")];
        if (quote ? *text == quote : *text == '\'' || *text == '"') {
            quote = quote ? '\0' : *text;
            *out++ = '"';
        } else if (quote || *text != ',' || (next != ')' && next != '}')) {
            const char *change = quote ? NULL : strchr("([)]TtFf", *text);
            *out++ = change && strchr("()TF", *text) ? change[1] : *text;
        }
    }
    *out = '\0';
}

static RtStatus check(RtNpy *npy, const json_t *header, const char *text, uint64_t most_rows,
                      RtError *error) {
    const json_t *descr = json_object_get(header, "descr"), *order = json_object_get(header, "fortran_order");
    const json_t *shape = json_object_get(header, "shape"), *rows = json_array_get(shape, 0);
    if (json_object_size(header) != 3 || !descr || !json_is_boolean(order) || !json_is_array(shape))
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the header is not {'descr': ..., 'fortran_order': ..., 'shape': ...}: %.80s",
                       npy->path, text);
    if (!json_is_string(descr) || strcmp(json_string_value(descr), "<f4") != 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: expected '<f4', as from array.astype('float32'), found %.80s", npy->path, text);
    if (json_is_true(order))
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the array is column-major: expected row-major, as from numpy.ascontiguousarray",
                       npy->path);
    if (json_array_size(shape) != 2 || json_integer_value(json_array_get(shape, 1)) != npy->columns ||
        !json_is_integer(rows) || json_integer_value(rows) < 0)
        return rt_fail(error, RT_BAD_INPUT, "%s: expected the shape (N, %" PRIu32 "), found %.80s", npy->path,
                       npy->columns, text);
    npy->rows = (uint64_t)json_integer_value(rows);
    if (npy->rows <= most_rows) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: %" PRIu64 " rows: at most %" PRIu64 " are read", npy->path,
                   npy->rows, most_rows);
}

/* rows * columns cannot overflow: both were checked. */
static RtStatus check_length(const RtNpy *npy, RtError *error) {
    struct stat info;
    long start = ftell(npy->file);
    if (start < 0 || fstat(fileno(npy->file), &info) != 0)
        return rt_fail(error, RT_IO, "%s: its length is unknown", npy->path);
    uint64_t wanted = npy->rows * npy->columns * sizeof(float),
             there = (uint64_t)info.st_size - (uint64_t)start;
    if (wanted == there) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: %" PRIu64 " rows of %" PRIu32 " numbers are %" PRIu64 " bytes, but %" PRIu64
                   " follow the header: was the file cut off?",
                   npy->path, npy->rows, npy->columns, wanted, there);
}

RtStatus rt_npy_open(RtNpy *npy, const char *path, uint32_t columns, uint64_t most_rows, RtError *error) {
    assert(most_rows <= UINT64_MAX / sizeof(float) / columns);
    char text[MOST_HEADER + 1], json[MOST_HEADER + 1];
    json_error_t problem;
    *npy = (RtNpy){.path = path, .columns = columns};
    RT_TRY(rt_file_open(path, &npy->file, error));
    RT_TRY(read_text(npy, text, error));
    write_json(text, json);
    json_auto_t *header = json_loads(json, JSON_REJECT_DUPLICATES, &problem);
    if (!header && json_error_code(&problem) == json_error_out_of_memory)
        return rt_fail_memory(error, path, 0);
    RT_TRY(check(npy, header, text, most_rows, error));
    return check_length(npy, error);
}

RtStatus rt_npy_read(RtNpy *npy, uint64_t rows, float *values, RtError *error) {
    size_t count = (size_t)rows * npy->columns;
    if (fread(values, sizeof(float), count, npy->file) == count) return RT_OK;
    return rt_fail(error, RT_IO, "%s: reading failed before the last row", npy->path);
}

void rt_npy_close(RtNpy *npy) {
    if (npy->file) fclose(npy->file);
    npy->file = NULL;
}

/* ---- writing ---- */

void rt_npy_begin(FILE *out, const char *descr, uint64_t rows, uint32_t columns) {
    char text[512], shape[64];
    snprintf(shape, sizeof shape, columns ? "(%" PRIu64 ", %" PRIu32 ")" : "(%" PRIu64 ",)", rows, columns);
    int length =
        snprintf(text, sizeof text, "{'descr': %s, 'fortran_order': False, 'shape': %s, }", descr, shape);
    assert(length > 0 && (size_t)length < sizeof text);
    /* Magic, version, two bytes of length, the text, padding, a newline. */
    int before = MAGIC_BYTES + 4, all = (before + length + 1 + MULTIPLE - 1) / MULTIPLE * MULTIPLE;
    int header = all - before;
    fwrite(MAGIC, 1, MAGIC_BYTES, out);
    const unsigned char rest[4] = {1, 0, (unsigned char)(header & 255), (unsigned char)(header >> 8)};
    fwrite(rest, 1, sizeof rest, out);
    fprintf(out, "%-*s\n", header - 1, text);
}
