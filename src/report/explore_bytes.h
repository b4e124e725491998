/* SPDX-License-Identifier: Apache-2.0 */
/* Growing arrays of bytes that go into a page: little-endian numbers, compressed, in base64. */
#ifndef RT_REPORT_EXPLORE_BYTES_H
#define RT_REPORT_EXPLORE_BYTES_H

#include "core/base/box.h"
#include "core/base/status.h"

#include <stdint.h>
#include <stdio.h>

/* Zero is empty. After a failure nothing more is appended, and `status` is not RT_OK. */
typedef struct RtBytes {
    uint8_t *data;
    uint32_t count, capacity;
    RtStatus status;
} RtBytes;

void rt_bytes_clear(RtBytes *bytes);

void rt_bytes_put(RtBytes *bytes, const void *data, size_t size);
void rt_bytes_put_float(RtBytes *bytes, float value);
void rt_bytes_put_vector(RtBytes *bytes, RtVec3 v);
void rt_bytes_put_box(RtBytes *bytes, const RtBox *box); /* lo, then hi: six floats */

/* LEB128: seven bits a byte, the lowest first; all but the last byte have the highest bit set. */
void rt_bytes_put_number(RtBytes *bytes, uint64_t value);

/* Appends four bytes, to be filled in by rt_bytes_end with the number of bytes that follow them. Returns
 * their place. */
uint32_t rt_bytes_begin(RtBytes *bytes);
void rt_bytes_end(RtBytes *bytes, uint32_t place);

/* Replaces the contents by the same compressed (zlib's format); *bytes stays as it is on failure. */
RtStatus rt_bytes_compress(RtBytes *bytes, RtError *error);

/* Writes compressed contents as a <script> element of id "part-NAME", a data URL. */
void rt_bytes_embed(const RtBytes *bytes, const char *name, FILE *out);

#endif
