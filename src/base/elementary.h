/* Logarithm, cube root, sine and cosine from + - * / alone: libraries differ in their last bits, these are
 * the same with every compiler and library. For what is computed once, such as built-in scenes. */
#ifndef RT_BASE_ELEMENTARY_H
#define RT_BASE_ELEMENTARY_H

/* The natural logarithm of a normal number x > 0, to within one unit in the last place. */
double rt_log(double x);

/* The cube root of a normal number x > 0, to within 4e-16 of itself. */
double rt_cube_root(double x);

typedef struct RtTurn {
    double cosine, sine;
} RtTurn;

/* Of an angle in degrees, at most 1e15, each to within 4e-16; multiples of 90 degrees are exact. */
RtTurn rt_turn(double degrees);

#endif
