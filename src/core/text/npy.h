/* SPDX-License-Identifier: Apache-2.0 */
/* Arrays of NumPy in files (.npy; NumPy Enhancement Proposal 1): magic bytes, a version, the length of a
 * header, the header, which is a dictionary of Python in text, and the numbers as they lie in memory.
 *
 * What is read comes from elsewhere and is trusted in nothing: the version is 1.0, 2.0 or 3.0, the dictionary
 * has the three keys of the format and no other, and the file is as long as it says. */
#ifndef RT_TEXT_NPY_H
#define RT_TEXT_NPY_H

#include "core/base/status.h"

#include <stdint.h>
#include <stdio.h>

/* Numbers lie in files with their least byte first, as they do in memory on every machine that is known to be
 * asked. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "arrays are written as they lie in memory");

/* An array that is read row by row. */
typedef struct RtNpy {
    const char *path; /* borrowed */
    FILE *file;       /* at the row that is next */
    uint64_t rows;
    uint32_t columns;
} RtNpy;

/* Opens an array of float32 (`<f4`), in C order, of shape (rows, columns), of at most `most_rows`. All else
 * is RT_BAD_INPUT, with what would be right. Close with rt_npy_close, also after a failure. */
RtStatus rt_npy_open(RtNpy *npy, const char *path, uint32_t columns, uint64_t most_rows, RtError *error);

/* The next `rows` rows, of which there are as many: values[rows][columns]. */
RtStatus rt_npy_read(RtNpy *npy, uint64_t rows, float *values, RtError *error);

void rt_npy_close(RtNpy *npy);

/* Writes what comes before the numbers: of version 1.0, padded to a multiple of 64 bytes. `descr` is the type
 * as Python writes it, with its quotes or brackets: "'<f4'", "[('t', '<f4')]", 300 characters at most;
 * columns 0: of one dimension. A failed write is seen by whoever closes the file. */
void rt_npy_begin(FILE *out, const char *descr, uint64_t rows, uint32_t columns);

#endif
