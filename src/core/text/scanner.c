/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text/scanner.h"

#include <ctype.h>
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool is_blank(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}

/* At LF, or at a CR without LF behind it. */
static bool ends_line(const char *at) {
    return *at == '\n' || (*at == '\r' && at[1] != '\n');
}

/* The length of a backslash with the line end behind it, or 0. */
static size_t joint(const RtScanner *s, const char *at) {
    if (!s->joins || *at != '\\') return 0;
    size_t length = 1 + (at[1] == '\r');
    return at[length] == '\n' ? length + 1 : 0;
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
        } else if (joint(s, s->at)) {
            s->line++;
            s->at += joint(s, s->at) - 1;
        } else if (!is_blank(*s->at)) {
            break;
        }
        s->at++;
    }
    const char *stop = s->at;
    while (stop < s->end && !is_blank(*stop) && *stop != '#' && !joint(s, stop)) stop++;
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

bool rt_scan_is_like(RtWord word, const char *text) {
    return strlen(text) == word.length && strncasecmp(word.text, text, word.length) == 0;
}

static bool is_digit(const char *at, const char *end) {
    return at < end && *at >= '0' && *at <= '9';
}

/* Up to 15 digits and powers of ten up to 22 are exact in double, so that their product or quotient is
 * rounded once (Clinger 1990, "How to Read Floating Point Numbers Accurately", PLDI); rounding it again to
 * float32 is right unless it lies halfway between two of them. The rest is left to strtof. */
bool rt_scan_float(RtWord word, float *out) {
    enum { EXACT = 22, MOST = 9999 };
    static const double tens[EXACT + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                           1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                           1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const char *at = word.text, *const end = at + word.length;
    const bool negative = word.length > 0 && *at == '-';
    uint64_t digits = 0, bits;
    int exponent = 0, power = 0;
    bool any = false;
    if (word.length > 0 && (*at == '-' || *at == '+')) at++;
    for (bool fraction = false;; fraction = true, at++) {
        for (; is_digit(at, end); at++, any = true) {
            digits = digits < 10000000000000000u ? digits * 10 + (uint64_t)(*at - '0') : UINT64_MAX;
            exponent -= fraction;
        }
        if (fraction || at == end || *at != '.') break;
    }
    if (any && at < end && (*at == 'e' || *at == 'E')) {
        const bool below = at + 1 < end && at[1] == '-';
        at += at + 1 < end && (at[1] == '-' || at[1] == '+') ? 2 : 1;
        any = is_digit(at, end);
        for (; is_digit(at, end); at++) power = power < MOST ? power * 10 + (*at - '0') : MOST;
        exponent += below ? -power : power;
    }
    if (!any || at != end) return false;
    if (digits <= 1000000000000000u && abs(exponent) <= EXACT) {
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
    return rt_fail_at(s->error, s->path, word.line, 0, "expected %s, found %s", wanted,
                      rt_scan_show(word, text));
}

RtStatus rt_scan_place(const RtScanner *s, RtStatus status, size_t line, const char *what) {
    if (status != RT_BAD_INPUT) return status;
    const RtError inner = *s->error;
    return rt_fail_at(s->error, s->path, line, 0, "%s%s", what, inner.message);
}
