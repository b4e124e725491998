/* SPDX-License-Identifier: Apache-2.0 */
/* NumPy arrays in files (.npy; NumPy Enhancement Proposal 1): magic bytes, a version, the length of the
 * header, the header (a Python dictionary as text), and the numbers as they lie in memory.
 *
 * Input is not trusted: the version must be 1.0, 2.0 or 3.0, the dictionary must have exactly the three
 * keys of the format, and the file must be as long as it says. */
#ifndef RT_TEXT_NPY_H
#define RT_TEXT_NPY_H

#include "core/base/status.h"

#include <stdint.h>
#include <stdio.h>

/* The files are little-endian, like the memory of all machines that this program supports. */
_Static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "arrays are written as they lie in memory");

/* An array read row by row. */
typedef struct RtNpy {
    const char *path; /* borrowed */
    FILE *file;       /* at the next row */
    uint64_t rows;
    uint32_t columns;
} RtNpy;

/* Opens an array of float32 (`<f4`) in C order, of shape (rows, columns), with at most `most_rows` rows.
 * Anything else is RT_BAD_INPUT, with what would be right. Close with rt_npy_close, also after a failure. */
RtStatus rt_npy_open(RtNpy *npy, const char *path, uint32_t columns, uint64_t most_rows, RtError *error);

/* Reads the next `rows` rows, which must exist: values[rows][columns]. */
RtStatus rt_npy_read(RtNpy *npy, uint64_t rows, float *values, RtError *error);

void rt_npy_close(RtNpy *npy);

/* Writes the header: version 1.0, padded to a multiple of 64 bytes. `descr` is the type as Python writes
 * it, with its quotes or brackets ("'<f4'", "[('t', '<f4')]"), at most 300 characters; columns 0 means one
 * dimension. A failed write is reported when the file is closed. */
void rt_npy_begin(FILE *out, const char *descr, uint64_t rows, uint32_t columns);

#endif
