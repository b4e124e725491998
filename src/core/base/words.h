/* SPDX-License-Identifier: Apache-2.0 */
/* Words in messages: plurals, lists of the names there are, and the one that was probably meant. */
#ifndef RT_BASE_WORDS_H
#define RT_BASE_WORDS_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* What a word that stands for `count` things ends in: "" for 1, else "s", as in "%u ray%s". */
static inline const char *rt_plural(uint64_t count) {
    return count == 1 ? "" : "s";
}

/* Of `names[0..count)` the one that `word` most likely meant, or NULL if none is near (edit distance). */
const char *rt_nearest_name(const char *word, const char *const *names, size_t count);

#define RT_MAX_SUGGESTION 96

/* ": did you mean 'NAME'?" with the nearest name, "" if none is near. */
void rt_suggest(const char *word, const char *const *names, size_t count, char out[RT_MAX_SUGGESTION]);

/* "a, b, c" to out[0..room), cut where there is too little room. */
void rt_join_names(const char *const *names, size_t count, char *out, size_t room);

/* Prints `text` and an end of line, with lines broken at blanks so that none has more than 80 characters,
 * unless a word has. */
void rt_print_wrapped(const char *text, FILE *out);

#endif
