/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/words.h"

#include <limits.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/ioctl.h>

bool rt_ends_in(const char *text, const char *end) {
    const size_t length = strlen(text), tail = strlen(end);
    return length >= tail && strcmp(text + length - tail, end) == 0;
}

/* Levenshtein distance, for words of up to 63 characters; two neighbours that are swapped count once. */
static size_t edit_distance(const char *a, const char *b) {
    size_t rows[3][64], n = strlen(b), i = 0;
    if (n > 63 || strlen(a) > 63) return 64;
    for (size_t j = 0; j <= n; j++) rows[0][j] = j;
    for (; a[i]; i++) {
        const size_t *above = rows[i % 3], *before = rows[(i + 2) % 3];
        size_t *row = rows[(i + 1) % 3];
        row[0] = i + 1;
        for (size_t j = 0; j < n; j++) {
            size_t least = above[j] + (a[i] != b[j]);
            if (above[j + 1] + 1 < least) least = above[j + 1] + 1;
            if (row[j] + 1 < least) least = row[j] + 1;
            const bool swapped = i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j];
            if (swapped && before[j - 1] + 1 < least) least = before[j - 1] + 1;
            row[j + 1] = least;
        }
    }
    return rows[i % 3][n];
}

const char *rt_nearest_name(const char *word, const char *const *names, size_t count) {
    const char *best = NULL;
    size_t least = strlen(word) / 2 + 1;
    for (size_t i = 0; i < count; i++) {
        size_t distance = edit_distance(word, names[i]);
        if (distance < least) {
            least = distance;
            best = names[i];
        }
    }
    return best;
}

void rt_suggest(const char *word, const char *const *names, size_t count, char out[RT_MAX_SUGGESTION]) {
    const char *near = rt_nearest_name(word, names, count);
    out[0] = '\0';
    if (near) snprintf(out, RT_MAX_SUGGESTION, ": did you mean '%s'?", near);
}

RtStatus rt_find_format(const char *path, const char *(*extension)(size_t i), const char *done, size_t *found,
                        RtError *error) {
    enum { MOST = 16 };
    const char *names[MOST], *dot = strrchr(basename(path), '.'), *own = dot ? dot + 1 : "";
    char list[256] = "";
    size_t count = 0;
    for (; count < MOST && (names[count] = extension(count)); count++) {
        *found = count;
        if (strcasecmp(names[count], own) == 0) return RT_OK;
        rt_append_text(list, sizeof list, " .%s", names[count]);
    }
    const char *near = rt_nearest_name(own, names, count);
    return rt_fail(error, RT_BAD_INPUT, "%s: no format '.%.40s' can be %s%s%s%s These can:%s", path, own,
                   done, near ? ": did you mean '." : "", near ? near : "", near ? "'?" : ".", list);
}

void rt_join_names(const char *const *names, size_t count, char *out, size_t size) {
    out[0] = '\0';
    for (size_t i = 0; i < count; i++) rt_append_text(out, size, "%s%s", i ? ", " : "", names[i]);
}

void rt_append_text(char *out, size_t size, const char *format, ...) {
    const size_t used = strlen(out);
    va_list args;
    va_start(args, format);
    /* clang-tidy 14 does not see va_start. NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized) */
    vsnprintf(out + used, size - used, format, args);
    va_end(args);
}

void rt_append_argument(char *out, size_t size, const char *word) {
    static const char plain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789%+,-./:=@_";
    if (*word && !word[strspn(word, plain)]) {
        rt_append_text(out, size, " %s", word);
        return;
    }
    rt_append_text(out, size, " '");
    for (; *word; word++) rt_append_text(out, size, *word == '\'' ? "'\\%c'" : "%c", *word);
    rt_append_text(out, size, "'");
}

/* ---- short names ---- */

/* A part without its end. */
static size_t part_length(const char *part) {
    return strcspn(part, ":,+");
}

static const char *next_part(const char *part) {
    part += part_length(part);
    return *part ? part + 1 : NULL;
}

static bool has_part(const char *name, const char *part) {
    const size_t length = part_length(part);
    while (name && (part_length(name) != length || strncmp(name, part, length) != 0)) name = next_part(name);
    return name != NULL;
}

/* Whether all names that begin with the same part as `name` have this one. */
static bool is_common(const char *part, const char *name, const char *const *names, size_t count) {
    const size_t first = part_length(name);
    for (size_t i = 0; i < count; i++) {
        const bool alike = part_length(names[i]) == first && strncmp(names[i], name, first) == 0;
        if (alike && !has_part(names[i], part)) return false;
    }
    return true;
}

/* Whether no other name has the same `head` characters at its start and `tail` at its end. */
static bool differs_at_ends(const char *name, const char *const *names, size_t count, size_t head,
                            size_t tail) {
    const char *end = name + strlen(name) - tail;
    for (size_t i = 0; i < count; i++) {
        const bool alike = strncmp(names[i], name, head) == 0 && rt_ends_in(names[i], end);
        if (alike && strcmp(names[i], name) != 0) return false;
    }
    return true;
}

void rt_shorten_name(const char *const *names, size_t count, size_t i, size_t width, char *out, size_t size) {
    const char *name = names[i], *gap = NULL; /* the part before, if it is left out */
    const size_t whole = strlen(name), head = width / 2, tail = width > head + 3 ? width - head - 3 : 0;
    bool shorter = false;
    *out = '\0';
    for (const char *part = name; part; part = next_part(part)) {
        const size_t length = part_length(part);
        if (part != name && whole > width && is_common(part, name, names, count)) {
            shorter = true;
            gap = part;
            continue;
        }
        if (gap) rt_append_text(out, size, "...%c", gap[part_length(gap)]);
        rt_append_text(out, size, "%.*s", (int)(length + (part[length] != '\0')), part);
        gap = NULL;
    }
    if (gap) rt_append_text(out, size, "...");
    if (whole > width && !shorter && differs_at_ends(name, names, count, head, tail))
        snprintf(out, size, "%.*s...%s", (int)head, name, name + whole - tail);
}

/* ---- pages ---- */

int rt_page_width(FILE *out) {
    enum { LEAST = 20 }; /* narrower ones are not believed */
    const char *columns = getenv("COLUMNS");
    struct winsize size;
    long width = columns ? strtol(columns, NULL, 10) : 0;
    if (width < LEAST && ioctl(fileno(out), TIOCGWINSZ, &size) == 0) width = size.ws_col;
    return width < LEAST || width > INT_MAX ? INT_MAX : (int)width;
}

void rt_print_wrapped(const char *text, FILE *out) {
    enum { WIDTH = 80 };
    const int page = rt_page_width(out);
    const size_t width = page < WIDTH ? (size_t)page : WIDTH;
    while (strlen(text) > width) {
        size_t end = width;
        while (end > 0 && text[end] != ' ') end--;
        if (end == 0) end = strcspn(text, " ");
        if (text[end] == '\0') break;
        fprintf(out, "%.*s\n", (int)end, text);
        text += end + 1;
    }
    fprintf(out, "%s\n", text);
}
