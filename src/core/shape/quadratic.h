/* SPDX-License-Identifier: Apache-2.0 */
/* Real roots of a t^2 + 2 b t + c = 0, in double, without cancellation (q = -(b + sign(b) sqrt(d)), t = q / a
 * and c / q: Press et al., Numerical Recipes, section 5.6). */
#ifndef RT_SHAPE_QUADRATIC_H
#define RT_SHAPE_QUADRATIC_H

#include <math.h>

/* Writes the real roots in ascending order and returns their number: 0, 1 (a = 0) or 2 (equal if the
 * discriminant is 0). The caller passes `discriminant` = b^2 - a c, because it may compute it more
 * precisely. */
static inline int rt_quadratic_roots(double a, double half_b, double c, double discriminant,
                                     double roots[2]) {
    if (!(discriminant >= 0)) return 0;
    double root = sqrt(discriminant);
    double q = half_b > 0 ? -(half_b + root) : root - half_b;
    if (a == 0) {
        if (half_b == 0) return 0;
        roots[0] = -c / (2 * half_b);
        return 1;
    }
    /* For a double root c / q is the ratio of two rounding errors; near 0 it could be anything. */
    double first = q / a, second = discriminant > 0 ? c / q : first;
    roots[0] = first < second ? first : second;
    roots[1] = first < second ? second : first;
    return 2;
}

#endif
