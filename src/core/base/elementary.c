/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/elementary.h"

#include <assert.h>
#include <math.h>

/* log 2 in two parts; the first is a multiple of 2^-32, so its multiples by exponents are exact */
static const double log2_high = 0x1.62e42feep-1, log2_low = 0x1.a39ef35793c76p-33;

/* x = m 2^e with m = 1 + f between sqrt(1/2) and sqrt(2), and s = f / (2 + f). Then log m = 2 artanh s =
 * 2s + s R with R = 2 (s^2/3 + s^4/5 + ...), and 2s = f - s f: the leading term f is exact, and the
 * rounding of s affects only the small rest. Since s^2 < 0.0295, the omitted terms are below 2^-64 of the
 * sum. */
double rt_log(double x) {
    assert(isfinite(x) && x > 0);
    int exponent;
    double m = frexp(x, &exponent);
    if (m < 0.70710678118654752) {
        m *= 2;
        exponent--;
    }
    double f = m - 1, s = f / (2 + f), s2 = s * s, rest = 0;
    for (int k = 12; k >= 1; k--) rest = s2 * (rest + 2.0 / (2 * k + 1));
    return exponent * log2_high + (f - (s * (f - rest) - exponent * log2_low));
}

/* p = 2^n e^r with |r| <= log 2 / 2; the first omitted Taylor term is below 1e-17. */
double rt_power(double x, double y) {
    assert(isfinite(x) && x > 0 && isfinite(y));
    double exponent = y * rt_log(x);
    if (exponent < -708) return 0;
    if (exponent > 709) return INFINITY;
    double n = floor(exponent / log2_high + 0.5), r = exponent - n * log2_high - n * log2_low, sum = 1;
    for (int k = 13; k >= 1; k--) sum = 1 + r / k * sum;
    return ldexp(sum, (int)n);
}

/* Taylor series on -45..45 degrees; the first omitted terms are below 1e-18. */
static RtTurn small_turn(double degrees) {
    double x = degrees * 0.017453292519943295769, x2 = x * x, sine = 1, cosine = 1;
    for (int k = 16; k >= 2; k -= 2) {
        sine = 1 - x2 / (k * (k + 1)) * sine;
        cosine = 1 - x2 / (k * (k - 1)) * cosine;
    }
    return (RtTurn){.cosine = cosine, .sine = x * sine};
}

RtTurn rt_turn(double degrees) {
    assert(isfinite(degrees));
    double within = fmod(degrees, 360),
           quarters = floor((within + 45) / 90); /* both exact in every library */
    RtTurn t = small_turn(within - 90 * quarters);
    switch ((int)quarters & 3) {
    case 0: return t;
    case 1: return (RtTurn){.cosine = -t.sine, .sine = t.cosine};
    case 2: return (RtTurn){.cosine = -t.cosine, .sine = -t.sine};
    default: return (RtTurn){.cosine = t.sine, .sine = -t.cosine};
    }
}

/* Halving it twice makes the angle, of at most 45 degrees, at most 11.25; then the first omitted term of the
 * series is below 1e-19. */
double rt_angle(double y, double x) {
    const double less = fmin(fabs(x), fabs(y)), more = fmax(fabs(x), fabs(y));
    double tangent = more > 0 ? less / more : 0, sum = 0;
    for (int halves = 0; halves < 2; halves++) tangent /= 1 + sqrt(1 + tangent * tangent);
    for (int k = 13; k >= 0; k--) sum = 1.0 / (2 * k + 1) - tangent * tangent * sum;
    double degrees = 4 * tangent * sum * 57.295779513082320877;
    if (fabs(y) > fabs(x)) degrees = 90 - degrees;
    if (x < 0) degrees = 180 - degrees;
    return y < 0 ? -degrees : degrees;
}

/* Newton's method from above: every step but the last comes nearer. */
double rt_cube_root(double x) {
    assert(isnormal(x) && x > 0);
    double root = fmax(x, 1), last;
    do {
        last = root;
        root = (2 * root + x / (root * root)) / 3;
    } while (root < last);
    return root;
}
