/* SPDX-License-Identifier: Apache-2.0 */
/* The words of a text file: what lies between blanks. Lines end with LF, CR LF or CR; a '#' begins a comment
 * that ends with its line. */
#ifndef RT_TEXT_SCANNER_H
#define RT_TEXT_SCANNER_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stdint.h>
#include <string.h>

typedef struct RtWord {
    const char *text; /* into the file; not terminated */
    size_t length;    /* 0 at the end of the file */
} RtWord;

/* Initialise path and error, then rt_scan_begin. */
typedef struct RtScanner {
    const char *path;
    const char *at, *end;
    size_t line; /* of `at`, which is the next word after rt_scan_peek; counted from 1 */
    size_t last; /* line of the last word taken */
    bool fresh;  /* no word of the current line was taken */
    bool joins;  /* a backslash at the end of a line joins it with the next one */
    RtError *error;
} RtScanner;

/* Begins with text[0..size), behind which must be a 0. */
void rt_scan_begin(RtScanner *scanner, const char *text, size_t size);

/* The next word, without taking it. */
RtWord rt_scan_peek(RtScanner *scanner);
static inline void rt_scan_take(RtScanner *scanner, RtWord word) {
    scanner->at += word.length;
    scanner->last = scanner->line;
    scanner->fresh = false;
}
/* Takes what is left of the line of the last word. */
void rt_scan_skip_line(RtScanner *scanner);

static inline bool rt_scan_is(RtWord word, const char *text) {
    return strlen(text) == word.length && memcmp(word.text, text, word.length) == 0;
}
/* The same in upper or lower case. */
bool rt_scan_is_like(RtWord word, const char *text);

/* Reads an integer of at most 18 digits, with a sign or without, at the beginning of `text`. Returns its end,
 * or `text` if there is none. */
const char *rt_scan_integer(const char *text, int64_t *out);

/* Reads the whole word, a decimal number such as -1, .5 or 2.5e-3, as the float32 nearest to it, ties to
 * even. False if it is no such number, or overflows. In the locale of C (library.h sees to that). */
bool rt_scan_float(RtWord word, float *out);

/* Fails at the line of the word, the next or the last one: "expected WANTED, found 'WORD'". */
RtStatus rt_scan_fail(const RtScanner *scanner, RtWord word, const char *wanted);

/* Puts the line, and `what` the message is about, in front of a message of RT_BAD_INPUT; returns `status`. */
RtStatus rt_scan_place(const RtScanner *scanner, RtStatus status, size_t line, const char *what);

/* Writes the word to `out` for a message: in quotes, truncated, with only printable characters. Returns out,
 * or "the end of the file". */
enum { RT_WORD_SHOWN = 48 };
const char *rt_scan_show(RtWord word, char out[RT_WORD_SHOWN]);

#endif
