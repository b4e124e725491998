/* SPDX-License-Identifier: Apache-2.0 */
/* Files of arrays: FILE.npz, any number of NumPy arrays by name, as numpy.savez writes them; any other path,
 * one array alone (core/text/npy.h).
 *
 * An .npz file is a ZIP archive of .npy files, here without compression, and always with the 64-bit fields of
 * ZIP64, since one array may have more than 4 GB (PKWARE's APPNOTE.TXT 6.3.10). The same arrays make the same
 * bytes: all dates are 1980-01-01. */
#ifndef RT_TEXT_NPZ_H
#define RT_TEXT_NPZ_H

#include "core/base/file.h"

#define RT_MAX_ARRAY_NAME 1200

typedef struct RtArrayEntry {
    char name[RT_MAX_ARRAY_NAME];
    uint32_t crc;
    uint64_t size, offset; /* bytes */
} RtArrayEntry;

/* {0} is closed. */
typedef struct RtArrayFile {
    RtOutput output;
    bool archive;          /* .npz */
    RtArrayEntry *entries; /* [count] owned; of an archive */
    uint32_t count, capacity;
} RtArrayFile;

/* Whether the path ends in .npz: it takes any number of arrays. */
bool rt_array_file_is_archive(const char *path);

/* Opens the file. Then commit it, or discard it. */
RtStatus rt_array_file_open(RtArrayFile *file, const char *path, RtError *error);

/* Appends an array: the `size` bytes of an .npy file. In an archive names differ, have fewer than
 * RT_MAX_ARRAY_NAME - 4 characters, and may contain '/'. */
RtStatus rt_array_file_add(RtArrayFile *file, const char *name, const void *array, size_t size,
                           RtError *error);

/* Finishes the file and renames it to its path; both free the entries, and do nothing to a closed file. */
RtStatus rt_array_file_commit(RtArrayFile *file, RtError *error);
void rt_array_file_discard(RtArrayFile *file);

#endif
