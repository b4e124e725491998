/* SPDX-License-Identifier: Apache-2.0 */
#ifndef RT_TEXT_NUMBER_H
#define RT_TEXT_NUMBER_H

#include <stdbool.h>
#include <stddef.h>

/* Reads the whole of text[0..length), a decimal number such as -1, .5 or 2.5e-3, as the float32 nearest to
 * it, ties to even: the value of strtof. False if it is no such number, or overflows. text[length] must exist
 * and be neither a digit nor a letter. In the locale of C (library.h sees to that). */
bool rt_number_float(const char *text, size_t length, float *out);

#endif
