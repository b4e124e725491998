/* SPDX-License-Identifier: Apache-2.0 */
/* Decimal numbers to float32, rounded once. W. D. Clinger, "How to read floating point numbers accurately",
 * 1990: an integer times or divided by an exact power of ten. Here the product is a double that may be off by
 * 3 units in its last place; it is rounded to float32 unless the tie between two float32 is that near. strtof
 * decides those cases, and numbers out of the range of the powers. */
#include "core/text/number.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_DIGITS = 19, MOST_POWER = 22 }; /* below 2^64; 10^22 is the largest power that a double holds */

/* The first significant digits are an integer; `exponent` is the power of ten of its last digit. */
typedef struct Decimal {
    uint64_t digits;
    int64_t exponent;
    int count; /* of the digits used */
    bool some; /* at least one digit, be it 0 */
} Decimal;

static const char *take_digits(const char *at, int fraction, Decimal *d) {
    for (; *at >= '0' && *at <= '9'; at++) {
        const bool used = d->count < MOST_DIGITS;
        if (used) d->digits = d->digits * 10 + (uint64_t)(*at - '0');
        d->count += used && d->digits > 0;
        d->exponent += !used - fraction;
        d->some = true;
    }
    return at;
}

/* NULL if no digit follows the letter. */
static const char *take_exponent(const char *at, Decimal *d) {
    enum { MOST = 100000000 };
    const bool negative = at[1] == '-';
    const char *first = at + 1 + (at[1] == '-' || at[1] == '+');
    int64_t value = 0;
    for (at = first; *at >= '0' && *at <= '9'; at++) {
        if (value < MOST) value = value * 10 + (*at - '0');
    }
    d->exponent += negative ? -value : value;
    return at == first ? NULL : at;
}

/* The digits and their product are rounded by half a unit each, and dropped digits are less than a 64th.
 * False if the float32 is not certain. */
static bool round_product(const Decimal *d, float *out) {
    static const double powers[MOST_POWER + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                  1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                  1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    enum { DROPPED = (1 << 29) - 1, TIE = 1 << 28, UNSURE = 4 }; /* of the 52 bits of a double */
    uint64_t bits;
    if (d->exponent < -MOST_POWER || d->exponent > MOST_POWER) return false;
    const double product =
        d->exponent < 0 ? (double)d->digits / powers[-d->exponent] : (double)d->digits * powers[d->exponent];
    memcpy(&bits, &product, sizeof bits);
    const int from_tie = (int)(bits & DROPPED) - TIE;
    if (from_tie >= -UNSURE && from_tie <= UNSURE) return false;
    if (product >= 0x1p127) return false; /* may overflow; what is not 0 is above 10^-22, never subnormal */
    *out = (float)product;
    return true;
}

bool rt_number_float(const char *text, size_t length, float *out) {
    const bool negative = *text == '-';
    Decimal d = {0};
    float value;
    const char *at = take_digits(text + (negative || *text == '+'), 0, &d);
    if (*at == '.') at = take_digits(at + 1, 1, &d);
    if (d.some && (*at == 'e' || *at == 'E')) at = take_exponent(at, &d);
    if (!d.some || at != text + length) return false;
    if (!round_product(&d, &value)) {
        *out = strtof(text, NULL);
        return (bool)isfinite(*out);
    }
    *out = negative ? -value : value;
    return true;
}
