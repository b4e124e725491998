/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text/npy.h"

#include "core/base/file.h"
#include "core/base/words.h"

#include <assert.h>
#include <ctype.h>
#include <inttypes.h>
#include <string.h>
#include <sys/stat.h>

enum {
    MAGIC_BYTES = 6,
    MOST_HEADER = 4096, /* bytes of text; an array of numbers needs about a hundred */
    MULTIPLE = 64       /* alignment of the numbers */
};
static const char MAGIC[MAGIC_BYTES + 1] = "\x93NUMPY";

/* ---- the dictionary ---- */

typedef struct Header {
    char text[MOST_HEADER + 1];
    const char *at; /* in the text */
    char descr[32]; /* the first characters; "" : not seen */
    bool c_order, ordered;
    bool shaped;
    uint64_t shape[2];
    uint32_t dimensions;
} Header;

static void skip_blanks(Header *h) {
    while (*h->at == ' ' || *h->at == '\n' || *h->at == '\t' || *h->at == '\r') h->at++;
}

/* Skips `c` and the blanks around it. */
static bool take(Header *h, char c) {
    skip_blanks(h);
    if (*h->at != c) return false;
    h->at++;
    skip_blanks(h);
    return true;
}

/* A quoted string, with quotes of either kind, without escapes. */
static bool take_text(Header *h, char *out, size_t size) {
    skip_blanks(h);
    char quote = *h->at;
    if (quote != '\'' && quote != '"') return false;
    const char *end = strchr(h->at + 1, quote);
    size_t length = end ? (size_t)(end - h->at - 1) : size;
    if (length >= size) return false;
    memcpy(out, h->at + 1, length);
    out[length] = '\0';
    h->at = end + 1;
    return !strchr(out, '\\');
}

static bool take_word(Header *h, const char *word) {
    skip_blanks(h);
    size_t length = strlen(word);
    if (strncmp(h->at, word, length) != 0 || isalnum((unsigned char)h->at[length])) return false;
    h->at += length;
    return true;
}

static bool take_number(Header *h, uint64_t *number) {
    skip_blanks(h);
    if (!isdigit((unsigned char)*h->at)) return false;
    for (*number = 0; isdigit((unsigned char)*h->at); h->at++) {
        uint64_t digit = (uint64_t)(*h->at - '0');
        if (*number > (UINT64_MAX - digit) / 10) return false;
        *number = 10 * *number + digit;
    }
    return true;
}

/* (), (7,), (7, 8), (7, 8, 9): the first two dimensions are kept. */
static bool take_shape(Header *h) {
    if (!take(h, '(')) return false;
    for (h->dimensions = 0; !take(h, ')'); h->dimensions++) {
        uint64_t number;
        if (!take_number(h, &number)) return false;
        if (h->dimensions < 2) h->shape[h->dimensions] = number;
        bool more = take(h, ',');
        if (!more && *h->at != ')') return false;
        if (!more && h->dimensions == 0) return false; /* (7) is a number */
    }
    return true;
}

/* A structured type is a list; its bracket suffices to reject it. */
static bool take_descr(Header *h) {
    if (*h->at != '[') return take_text(h, h->descr, sizeof h->descr);
    strcpy(h->descr, "[...]");
    return false;
}

static bool take_entry(Header *h) {
    char key[32];
    if (!take_text(h, key, sizeof key) || !take(h, ':')) return false;
    if (strcmp(key, "descr") == 0 && !*h->descr) return take_descr(h);
    if (strcmp(key, "fortran_order") == 0 && !h->ordered) {
        h->ordered = true;
        h->c_order = take_word(h, "False");
        return h->c_order || take_word(h, "True");
    }
    if (strcmp(key, "shape") == 0 && !h->shaped) return h->shaped = take_shape(h);
    return false;
}

/* {'descr': '<f4', 'fortran_order': False, 'shape': (7, 8), }, with keys in any order. */
static bool parse(Header *h) {
    h->at = h->text;
    if (!take(h, '{')) return false;
    while (!take(h, '}')) {
        if (!take_entry(h)) return false;
        if (!take(h, ',') && *h->at != '}') return false;
    }
    return *h->at == '\0' && *h->descr && h->ordered && h->shaped;
}

/* ---- reading ---- */

static RtStatus read_text(RtNpy *npy, Header *h, RtError *error) {
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
    if (fread(h->text, 1, length, npy->file) != length)
        return rt_fail(error, RT_BAD_INPUT, "%s: the file ends within its header", npy->path);
    h->text[length] = '\0';
    if (strlen(h->text) == length) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: the header contains a zero byte", npy->path);
}

static RtStatus check(RtNpy *npy, const Header *h, bool parsed, uint64_t most_rows, RtError *error) {
    uint32_t columns = npy->columns;
    if (*h->descr && strcmp(h->descr, "<f4") != 0) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: numbers of type %s: expected '<f4', as from array.astype('float32')", npy->path,
                       h->descr);
    }
    if (!parsed) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the header is not {'descr': ..., 'fortran_order': ..., 'shape': ...}: %.80s",
                       npy->path, h->text);
    }
    if (!h->c_order) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: the array is column-major: expected row-major, as from numpy.ascontiguousarray",
                       npy->path);
    }
    if (h->dimensions != 2 || h->shape[1] != columns) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: an array of %" PRIu32 " dimension%s, and rows of %" PRIu64
                       ": expected the shape (N, %" PRIu32 ")",
                       npy->path, h->dimensions, rt_plural(h->dimensions),
                       h->dimensions >= 2 ? h->shape[1] : 0, columns);
    }
    npy->rows = h->shape[0];
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
    Header header = {.descr = ""};
    *npy = (RtNpy){.path = path, .columns = columns};
    RT_TRY(rt_file_open(path, &npy->file, error));
    RT_TRY(read_text(npy, &header, error));
    bool parsed = parse(&header);
    RT_TRY(check(npy, &header, parsed, most_rows, error));
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
