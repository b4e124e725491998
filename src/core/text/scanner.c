/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text/scanner.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool is_blank(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* At LF, or at a CR without LF behind it. */
static bool ends_line(const char *at) {
    return *at == '\n' || (*at == '\r' && at[1] != '\n');
}

/* The length of a backslash with the line end behind it, or 0. */
static size_t joint(const RtScanner *s) {
    if (!s->joins || *s->at != '\\') return 0;
    size_t length = 1 + (s->at[1] == '\r');
    return s->at[length] == '\n' ? length + 1 : 0;
}

void rt_scan_begin(RtScanner *s, const char *text, size_t size) {
    s->at = text;
    s->end = text + size;
    s->line = 1;
    s->fresh = true;
}

RtWord rt_scan_peek(RtScanner *s) {
    while (s->at < s->end) {
        if (ends_line(s->at)) {
            s->line++;
            s->fresh = true;
        } else if (*s->at == '#') {
            while (s->at + 1 < s->end && !ends_line(s->at + 1)) s->at++;
        } else if (joint(s)) {
            s->line++;
            s->at += joint(s) - 1;
        } else if (!is_blank(*s->at)) {
            break;
        }
        s->at++;
    }
    const char *stop = s->at;
    while (stop < s->end && !is_blank(*stop) && *stop != '#') stop++;
    return (RtWord){s->at, (size_t)(stop - s->at), s->line, s->fresh};
}

void rt_scan_take(RtScanner *s, RtWord word) {
    s->at += word.length;
    s->last = word.line;
    s->fresh = false;
}

void rt_scan_skip_line(RtScanner *s) {
    for (RtWord word = rt_scan_peek(s); word.length > 0 && !word.first; word = rt_scan_peek(s))
        rt_scan_take(s, word);
}

bool rt_scan_is(RtWord word, const char *text) {
    return strlen(text) == word.length && strncmp(word.text, text, word.length) == 0;
}

bool rt_scan_float(RtWord word, float *out) {
    char *end;
    /* strtof also reads blanks, hexadecimal numbers, "inf" and "nan". */
    if (word.length == 0 || strspn(word.text, "+-.0123456789eE") < word.length) return false;
    *out = strtof(word.text, &end);
    return end == word.text + word.length && isfinite(*out);
}

const char *rt_scan_show(RtWord word, char out[RT_WORD_SHOWN]) {
    if (word.length == 0) return "the end of the file";
    size_t n = word.length < 32 ? word.length : 32;
    out[0] = '\'';
    for (size_t i = 0; i < n; i++)
        out[i + 1] = (char)(isprint((unsigned char)word.text[i]) ? word.text[i] : '?');
    strcpy(out + 1 + n, n < word.length ? "...'" : "'");
    return out;
}

RtStatus rt_scan_fail(const RtScanner *s, RtWord word, const char *wanted) {
    char text[RT_WORD_SHOWN];
    return rt_fail_at(s->error, s->path, word.line, 0, "expected %s, found %s", wanted,
                      rt_scan_show(word, text));
}

RtStatus rt_scan_place(const RtScanner *s, RtStatus status, size_t line, const char *what) {
    if (status != RT_BAD_INPUT) return status;
    const RtError inner = *s->error;
    return rt_fail_at(s->error, s->path, line, 0, "%s%s", what, inner.message);
}
