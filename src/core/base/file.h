/* SPDX-License-Identifier: Apache-2.0 */
/* Files: read whole, and written so that nothing half-written remains: output goes to PATH.RANDOM.tmp,
 * whose name nobody can predict, and is renamed to PATH when complete. */
#ifndef RT_BASE_FILE_H
#define RT_BASE_FILE_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define RT_MAX_PATH 4096

/* A file being written. Write to `file`; then rt_output_commit, or rt_output_discard. */
typedef struct RtOutput {
    FILE *file;                                          /* NULL when not open */
    char path[RT_MAX_PATH], temporary[RT_MAX_PATH + 24]; /* "": no temporary file */
    int listed;                                          /* for rt_outputs_remove_open; -1: it is not */
} RtOutput;

/* Rejects a `path` that exists and is not a regular file: renaming would replace /dev/null, say. */
RtStatus rt_output_open(RtOutput *output, const char *path, RtError *error);

/* The same for the file `name` in `folder` (rt_path_join). */
RtStatus rt_output_open_in(RtOutput *output, const char *folder, const char *name, RtError *error);

/* Flushes to disk and closes; only the rename is left, for rt_output_commit. Reports any failed write
 * since the file was opened, and then discards the file. */
RtStatus rt_output_finish(RtOutput *output, RtError *error);

/* Finishes if necessary, and renames. */
RtStatus rt_output_commit(RtOutput *output, RtError *error);

/* Closes and removes the temporary file, if there is one. */
void rt_output_discard(RtOutput *output);

/* Writes `size` bytes to `path` in this way. */
RtStatus rt_file_write(const char *path, const void *data, size_t size, RtError *error);

/* Files that change together: all are on disk before the first is renamed. {0} is empty; rt_outputs_clear
 * discards those that were not committed. */
typedef struct RtOutputs {
    RtOutput *list;
    uint32_t count, capacity;
} RtOutputs;

/* Opens another file, to be written and finished; *output is valid until the next is added. */
RtStatus rt_outputs_add(RtOutputs *outputs, const char *path, RtOutput **output, RtError *error);

/* Adds a copy of the file `from`, of 16 MiB at most. */
RtStatus rt_outputs_copy(RtOutputs *outputs, const char *from, const char *to, RtError *error);

/* Renames all of them, in the order in which they were added. */
RtStatus rt_outputs_commit(RtOutputs *outputs, RtError *error);
void rt_outputs_clear(RtOutputs *outputs);

/* Removes temporary files that killed processes left in `folder`. Call it only while nobody else writes
 * there. */
void rt_outputs_remove_left(const char *folder);

/* Removes the temporary files of all outputs that are open, up to 64; for handlers of signals that end the
 * process. */
void rt_outputs_remove_open(void);

/* A file in memory. Unlike open_memstream, which may lose data without an error, it fails if memory is short.
 * Write to `file`; the struct must not be moved until it is closed. */
typedef struct RtMemoryFile {
    FILE *file; /* NULL when not open */
    char *data; /* once it is closed: complete, followed by a 0; for rt_free */
    size_t size, capacity;
} RtMemoryFile;
RtStatus rt_memory_file_open(RtMemoryFile *memory, RtError *error);

/* After a failure there are no data. `what` it is, for the message. */
RtStatus rt_memory_file_close(RtMemoryFile *memory, const char *what, RtError *error);

/* Opens a regular file for reading; rejects folders, devices and pipes. */
RtStatus rt_file_open(const char *path, FILE **file, RtError *error);

/* Reads the whole file and appends a 0; rejects more than `limit` bytes. Free with rt_free. */
RtStatus rt_file_read(const char *path, size_t limit, char **data, size_t *size, RtError *error);

/* The same for text: rejects a byte of 0, with its place, and leaves out a byte-order mark (UTF-8). */
RtStatus rt_file_read_text(const char *path, size_t limit, char **text, size_t *size, RtError *error);

/* Fails at the place of a byte of 0 in the text of a file. */
RtStatus rt_file_fail_zero(const char *path, const char *text, const char *zero, RtError *error);

bool rt_file_exists(const char *path);
bool rt_file_exists_in(const char *folder, const char *name);

/* True, with a message, if `path` is a symbolic link whose target does not exist. */
bool rt_file_is_dead_link(const char *path, RtError *error);

/* Creates the directory and missing parents. */
RtStatus rt_directory_create(const char *path, RtError *error);

/* Calls visit(context, path), unless it is NULL, for every file of the folder whose name ends in `suffix`,
 * sorted by name. Returns their number, 0 if the folder cannot be read. */
size_t rt_directory_each(const char *folder, const char *suffix,
                         void (*visit)(void *context, const char *path), void *context);

/* Removes them. */
void rt_directory_remove_files(const char *folder, const char *suffix);

/* A lock on a directory that one process at a time writes into. It is the kernel's lock on the directory
 * itself: it leaves no file behind and ends with its process, however that ends. RT_NO_LOCK holds nothing and
 * may be released. */
typedef struct RtLock {
    int descriptor; /* of the directory, or -1 */
} RtLock;

#define RT_NO_LOCK ((RtLock){-1})

static inline bool rt_lock_is_held(const RtLock *lock) {
    return lock->descriptor >= 0;
}

/* Locks the directory at `path`, or fails if another process holds the lock for a second. Succeeds without a
 * lock if there is no such directory or its file system has no locks. */
RtStatus rt_lock_take(RtLock *lock, const char *path, RtError *error);

void rt_lock_release(RtLock *lock);

/* Writes "FOLDER/name" to out[0..RT_MAX_PATH); just the name if it is absolute or the folder is empty.
 * Rejects a path that is too long. */
RtStatus rt_path_join(const char *folder, const char *name, char *out, RtError *error);

/* Makes a file name from `text`. POSIX's portable characters (letters, digits, '.', '_', '-') stay, others
 * become '-'; it has no '.' or '-' at the start. One that does not fit `size`, 16 bytes or more, ends in a
 * hash of the text. Different texts that fit may get the same name. */
void rt_file_name(const char *text, char *out, size_t size);

/* Writes the folder of `path` ("" if it has none) to out[0..RT_MAX_PATH). */
void rt_path_folder(const char *path, char *out);

#endif
