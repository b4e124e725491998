/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text/scanner.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* At LF, or at a CR without LF behind it. */
static bool ends_line(const char *at) {
    return *at == '\n' || (*at == '\r' && at[1] != '\n');
}

/* The length of a backslash with the line end behind it, or 0. */
static size_t joint(const RtScanner *s, const char *at) {
    if (!s->joins || *at != '\\') return 0;
    size_t length = 1 + (at[1] == '\r');
    return at[length] == '\n' ? length + 1 : at[1] == '\r' ? length : 0;
}

/* Whether no word goes on here: at a blank, a '#', a joint or the end of the text. */
static inline bool ends_word(const RtScanner *s, const char *at) {
    enum { NO, YES, PERHAPS };
    static const unsigned char ends[256] = {
        [0] = PERHAPS, ['\\'] = PERHAPS, ['#'] = YES,  [' '] = YES, ['\t'] = YES,
        ['\n'] = YES,  ['\v'] = YES,     ['\f'] = YES, ['\r'] = YES};
    const unsigned char kind = ends[(unsigned char)*at];
    return kind != NO && (kind == YES || at >= s->end || joint(s, at));
}

void rt_scan_begin(RtScanner *s, const char *text, size_t size) {
    s->at = text;
    s->end = text + size;
    s->line = 1;
    s->fresh = true;
}

/* Goes to the next word. */
static void skip(RtScanner *s) {
    for (; s->at < s->end && ends_word(s, s->at); s->at++) {
        if (ends_line(s->at)) {
            s->line++;
            s->fresh = true;
        } else if (*s->at == '#') {
            while (s->at + 1 < s->end && !ends_line(s->at + 1)) s->at++;
        } else if (*s->at == '\\') {
            s->line++;
            s->at += joint(s, s->at) - 1;
        }
    }
}

RtWord rt_scan_peek(RtScanner *s) {
    while (*s->at == ' ') s->at++;
    if (ends_word(s, s->at)) skip(s);
    const char *at = s->at;
    while (!ends_word(s, at) || (*at == '#' && at > s->at && at[-1] == '.')) at++; /* 1.#QNAN of MSVC */
    return (RtWord){s->at, (size_t)(at - s->at)};
}

void rt_scan_skip_line(RtScanner *s) {
    for (RtWord word = rt_scan_peek(s); word.length > 0 && !s->fresh; word = rt_scan_peek(s))
        rt_scan_take(s, word);
}

bool rt_scan_is_like(RtWord word, const char *text) {
    return strlen(text) == word.length && strncasecmp(word.text, text, word.length) == 0;
}

enum { MOST_DIGITS = 18 }; /* that always fit int64_t */

/* Appends the digits at `at` to *value, which may overflow; returns their end. */
static inline const char *read_digits(const char *at, uint64_t *value) {
    uint64_t sum = *value;
    for (unsigned digit; (digit = (unsigned)*at - '0') <= 9; at++) sum = sum * 10 + digit;
    *value = sum;
    return at;
}

const char *rt_scan_integer(const char *text, int64_t *out) {
    uint64_t value = 0;
    const char *const first = text + (*text == '-' || *text == '+'), *const end = read_digits(first, &value);
    if (end == first || end - first > MOST_DIGITS) return text;
    *out = *text == '-' ? -(int64_t)value : (int64_t)value;
    return end;
}

/* Up to 15 digits and powers of ten up to 22 are exact in double, so that their product or quotient is
 * rounded once (Clinger 1990, "How to Read Floating Point Numbers Accurately", PLDI); rounding it again to
 * float32 is right unless it lies halfway between two of them. The rest is left to strtof. */
bool rt_scan_float(RtWord word, float *out) {
    enum { EXACT = 22 };
    static const double tens[EXACT + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                           1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                           1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const bool negative = *word.text == '-';
    const char *const first = word.text + (negative || *word.text == '+');
    uint64_t digits = 0, power = 0, bits;
    const char *const point = read_digits(first, &digits), *at = point;
    if (*point == '.') at = read_digits(point + 1, &digits);
    const ptrdiff_t count = at - first - (*point == '.');
    int64_t exponent = *point == '.' ? point + 1 - at : 0;
    if (*at == 'e' || *at == 'E') {
        const char *const sign = at + 1, *const digit = sign + (*sign == '-' || *sign == '+');
        at = read_digits(digit, &power);
        if (at == digit) return false;
        if (at - digit > MOST_DIGITS) power = UINT32_MAX;
        exponent += *sign == '-' ? -(int64_t)power : (int64_t)power;
    }
    if (count == 0 || at != word.text + word.length) return false;
    if (count <= MOST_DIGITS && digits <= 1000000000000000u && exponent >= -EXACT && exponent <= EXACT) {
        const double value =
            exponent < 0 ? (double)digits / tens[-exponent] : (double)digits * tens[exponent];
        memcpy(&bits, &value, sizeof bits);
        *out = (float)(negative ? -value : value);
        if (digits == 0 || ((bits & 0x1fffffff) != 0x10000000 && value >= FLT_MIN && value < FLT_MAX))
            return true;
    }
    *out = strtof(word.text, NULL);
    return isfinite(*out);
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
    return rt_fail_at(s->error, s->path, word.text < s->at ? s->last : s->line, 0, "expected %s, found %s",
                      wanted, rt_scan_show(word, text));
}

RtStatus rt_scan_place(const RtScanner *s, RtStatus status, size_t line, const char *what) {
    if (status != RT_BAD_INPUT) return status;
    const RtError inner = *s->error;
    return rt_fail_at(s->error, s->path, line, 0, "%s%s", what, inner.message);
}
