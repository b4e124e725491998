/* SPDX-License-Identifier: Apache-2.0 */
#include "core/text/npz.h"

#include "core/base/memory.h"
#include "core/base/words.h"

#include <assert.h>
#include <string.h>
#include <zlib.h>

/* Constants of the format. */
enum {
    VERSION = 45,                /* which knows ZIP64 */
    FIRST_DAY = 1 << 5 | 1,      /* 1980-01-01 */
    EXTRA_64 = 1,                /* the extra field with 64-bit sizes */
    LOCAL_EXTRA = 4 + 2 * 8,     /* its bytes in a local header */
    DIRECTORY_EXTRA = 4 + 3 * 8, /* and in the directory */
    END_64_REST = 44             /* bytes of the 64-bit end record after its length */
};
#define IN_64_BITS UINT32_MAX /* "see the 64-bit field" */

static void put(FILE *out, uint64_t value, int bytes) {
    for (int i = 0; i < bytes; i++) fputc((int)(value >> 8 * i & 255), out);
}

/* ---- records ---- */

/* What a local header and an entry of the directory have in common. */
static void put_entry(FILE *out, const RtArrayEntry *entry, int extra) {
    put(out, VERSION, 2);
    put(out, 0, 2); /* flags */
    put(out, 0, 2); /* stored, not compressed */
    put(out, 0, 2); /* midnight */
    put(out, FIRST_DAY, 2);
    put(out, entry->crc, 4);
    put(out, IN_64_BITS, 4); /* compressed */
    put(out, IN_64_BITS, 4); /* size */
    put(out, strlen(entry->name), 2);
    put(out, (uint64_t)extra, 2);
}

static void put_extra(FILE *out, const RtArrayEntry *entry, int extra) {
    put(out, EXTRA_64, 2);
    put(out, (uint64_t)extra - 4, 2);
    put(out, entry->size, 8);
    put(out, entry->size, 8); /* compressed */
    if (extra == DIRECTORY_EXTRA) put(out, entry->offset, 8);
}

static void put_local(FILE *out, const RtArrayEntry *entry) {
    put(out, 0x04034b50, 4);
    put_entry(out, entry, LOCAL_EXTRA);
    fputs(entry->name, out);
    put_extra(out, entry, LOCAL_EXTRA);
}

static void put_in_directory(FILE *out, const RtArrayEntry *entry) {
    put(out, 0x02014b50, 4);
    put(out, VERSION, 2);
    put_entry(out, entry, DIRECTORY_EXTRA);
    put(out, 0, 2 + 2 + 2);  /* comment, disk, attributes of the content */
    put(out, 0, 4);          /* attributes of the file */
    put(out, IN_64_BITS, 4); /* offset */
    fputs(entry->name, out);
    put_extra(out, entry, DIRECTORY_EXTRA);
}

/* The end of the directory that begins at `start` and ends at `end`: the 64-bit record, where it is, and the
 * record of old. */
static void put_end(FILE *out, uint32_t count, uint64_t start, uint64_t end) {
    put(out, 0x06064b50, 4);
    put(out, END_64_REST, 8);
    put(out, VERSION, 2);
    put(out, VERSION, 2);
    put(out, 0, 4 + 4); /* disks */
    put(out, count, 8);
    put(out, count, 8);
    put(out, end - start, 8);
    put(out, start, 8);
    put(out, 0x07064b50, 4);
    put(out, 0, 4);
    put(out, end, 8);
    put(out, 1, 4);
    put(out, 0x06054b50, 4);
    put(out, 0, 2 + 2);
    put(out, UINT16_MAX, 2);
    put(out, UINT16_MAX, 2);
    put(out, IN_64_BITS, 4);
    put(out, IN_64_BITS, 4);
    put(out, 0, 2); /* comment */
}

/* ---- files ---- */

bool rt_array_file_is_archive(const char *path) {
    return rt_ends_in(path, ".npz");
}

RtStatus rt_array_file_open(RtArrayFile *file, const char *path, RtError *error) {
    *file = (RtArrayFile){.archive = rt_array_file_is_archive(path)};
    return rt_output_open(&file->output, path, error);
}

RtStatus rt_array_file_add(RtArrayFile *file, const char *name, const void *array, size_t size,
                           RtError *error) {
    FILE *out = file->output.file;
    RtArrayEntry entry = {.size = size, .offset = (uint64_t)ftello(out)};
    assert(file->archive || entry.offset == 0);
    if (file->archive) {
        assert(strlen(name) + 4 < sizeof entry.name);
        snprintf(entry.name, sizeof entry.name, "%s.npy", name);
        entry.crc = (uint32_t)crc32_z(0, array, size);
        RT_TRY(rt_append(&file->entries, &file->count, &file->capacity, &entry, sizeof entry, error));
        put_local(out, &entry);
    }
    fwrite(array, 1, size, out);
    return RT_OK;
}

RtStatus rt_array_file_commit(RtArrayFile *file, RtError *error) {
    FILE *out = file->output.file;
    if (!out) return RT_OK;
    if (file->archive) {
        const uint64_t start = (uint64_t)ftello(out);
        for (uint32_t i = 0; i < file->count; i++) put_in_directory(out, &file->entries[i]);
        put_end(out, file->count, start, (uint64_t)ftello(out));
    }
    RtStatus status = rt_output_commit(&file->output, error);
    rt_array_file_discard(file);
    return status;
}

void rt_array_file_discard(RtArrayFile *file) {
    rt_output_discard(&file->output);
    rt_free(file->entries);
    *file = (RtArrayFile){0};
}
