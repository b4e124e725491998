/* SPDX-License-Identifier: Apache-2.0 */
/* Logarithm, power, cube root, sine, cosine and their inverse from + - * / and sqrt alone. Libraries differ
 * in their last bits; these functions return the same bits with every compiler and library. Rays, hits,
 * counts and images use no others. */
#ifndef RT_BASE_ELEMENTARY_H
#define RT_BASE_ELEMENTARY_H

/* The natural logarithm of a finite x > 0, to within one unit in the last place. */
double rt_log(double x);

/* p = x^y for finite x > 0 and y, to within 4e-16 (1 + |log p|) p; exact if p is 1 because x is 1 or y is
 * 0. 0 where log p < -708, infinite where log p > 709. */
double rt_power(double x, double y);

/* The cube root of a normal number x > 0, to within a relative error of 4e-16. */
double rt_cube_root(double x);

typedef struct RtTurn {
    double cosine, sine;
} RtTurn;

/* Sine and cosine of any finite angle in degrees, each to within 4e-16; multiples of 90 degrees are exact. */
RtTurn rt_turn(double degrees);

/* The angle of the point (x, y) in degrees, -180..180, counter-clockwise from the x axis, to within 1e-13;
 * exact on the axes. 0 for the origin. */
double rt_angle(double y, double x);

#endif
