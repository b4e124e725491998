/* SPDX-License-Identifier: Apache-2.0 */
#include "report/explore_bytes.h"

#include "core/base/memory.h"
#include "report/page.h"

#include <string.h>
#include <zlib.h>

void rt_bytes_clear(RtBytes *bytes) {
    rt_free(bytes->data);
    *bytes = (RtBytes){0};
}

/* Grows by doubling (rt_reserve). */
void rt_bytes_put(RtBytes *bytes, const void *data, size_t size) {
    if (size == 0) return; /* `data` may be NULL */
    if (bytes->status == RT_OK)
        bytes->status = rt_reserve(&bytes->data, &bytes->capacity, bytes->count + (uint64_t)size, 1, NULL);
    if (bytes->status != RT_OK) return;
    memcpy(bytes->data + bytes->count, data, size);
    bytes->count += (uint32_t)size;
}

static void store_u32(uint8_t out[4], uint32_t value) {
    for (int i = 0; i < 4; i++) out[i] = (uint8_t)(value >> 8 * i);
}

void rt_bytes_put_float(RtBytes *bytes, float value) {
    uint32_t bits;
    uint8_t out[4];
    memcpy(&bits, &value, sizeof bits);
    store_u32(out, bits);
    rt_bytes_put(bytes, out, sizeof out);
}

void rt_bytes_put_vector(RtBytes *bytes, RtVec3 v) {
    for (int a = 0; a < 3; a++) rt_bytes_put_float(bytes, v.at[a]);
}

void rt_bytes_put_box(RtBytes *bytes, const RtBox *box) {
    rt_bytes_put_vector(bytes, box->lo);
    rt_bytes_put_vector(bytes, box->hi);
}

void rt_bytes_put_number(RtBytes *bytes, uint64_t value) {
    uint8_t out[10];
    size_t size = 0;
    for (; value >= 128; value >>= 7) out[size++] = (uint8_t)(value | 128);
    out[size++] = (uint8_t)value;
    rt_bytes_put(bytes, out, size);
}

uint32_t rt_bytes_begin(RtBytes *bytes) {
    uint32_t place = bytes->count;
    rt_bytes_put(bytes, (uint8_t[4]){0}, 4);
    return place;
}

void rt_bytes_end(RtBytes *bytes, uint32_t place) {
    if (bytes->status == RT_OK) store_u32(bytes->data + place, bytes->count - place - 4);
}

RtStatus rt_bytes_compress(RtBytes *bytes, RtError *error) {
    uLongf size = compressBound(bytes->count);
    uint8_t *data = bytes->status == RT_OK ? rt_alloc_unset(size, 1) : NULL;
    if (!data || compress(data, &size, bytes->data, bytes->count) != Z_OK || size > UINT32_MAX) {
        rt_free(data);
        return rt_fail_memory(error, "the data of a page", size);
    }
    rt_bytes_clear(bytes);
    *bytes = (RtBytes){.data = data, .count = (uint32_t)size, .capacity = (uint32_t)size};
    return RT_OK;
}

void rt_bytes_embed(const RtBytes *bytes, const char *name, FILE *out) {
    fprintf(out, "<script type=\"text/plain\" id=\"part-%s\">", name);
    rt_page_data_url(out, "application/zlib", bytes->data, bytes->count);
    fputs("</script>\n", out);
}
