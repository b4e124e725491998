/* SPDX-License-Identifier: Apache-2.0 */
/* Words in messages: plurals, lists of names, and "did you mean". */
#ifndef RT_BASE_WORDS_H
#define RT_BASE_WORDS_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* The plural ending for `count` things, as in "%u ray%s". */
static inline const char *rt_plural(uint64_t count) {
    return count == 1 ? "" : "s";
}

/* Whether `text` ends in `end`. */
bool rt_ends_in(const char *text, const char *end);

/* The name nearest to `word` by edit distance, or NULL if none is near. */
const char *rt_nearest_name(const char *word, const char *const *names, size_t count);

#define RT_MAX_SUGGESTION 96

/* ": did you mean 'NAME'?" with the nearest name, "" if none is near. */
void rt_suggest(const char *word, const char *const *names, size_t count, char out[RT_MAX_SUGGESTION]);

/* Finds the format of a file by the extension of `path`, in upper or lower case: the i for which extension(i)
 * is that, without the dot. It returns NULL after the last, of 16 at most. RT_BAD_INPUT, with all extensions,
 * if there is none: "no format '.x' can be DONE". */
RtStatus rt_find_format(const char *path, const char *(*extension)(size_t i), const char *done, size_t *found,
                        RtError *error);

/* Writes "a, b, c" to out[0..size), truncated if it does not fit. */
void rt_join_names(const char *const *names, size_t count, char *out, size_t size);

/* Appends to the text in out[0..size), truncated if it does not fit. */
__attribute__((format(printf, 3, 4))) void rt_append_text(char *out, size_t size, const char *format, ...);

/* Appends a blank and `word` as a shell reads it: in quotes where it needs them. */
void rt_append_argument(char *out, size_t size, const char *word);

/* Writes names[i] to out[0..size) for a screen that has room for `width` characters: a longer name leaves out
 * parts that all names which begin alike have, "random:...,width=0.0125". Parts end at ':', ',' or '+'. What
 * differs is kept, even if it needs more room. */
void rt_shorten_name(const char *const *names, size_t count, size_t i, size_t width, char *out, size_t size);

/* Characters of a line of `out`: $COLUMNS, or as many as the terminal has; INT_MAX for a file. */
int rt_page_width(FILE *out);

/* Prints `text` and a newline, wrapped at blanks to 80 characters, or to the page if that is narrower. */
void rt_print_wrapped(const char *text, FILE *out);

#endif
