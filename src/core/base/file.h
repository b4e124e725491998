/* SPDX-License-Identifier: Apache-2.0 */
/* Files: reading one whole, and writing one so that nothing half-written remains: to PATH.RANDOM.tmp, a new
 * file whose name cannot be foreseen, renamed to PATH when complete. */
#ifndef RT_BASE_FILE_H
#define RT_BASE_FILE_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#define RT_MAX_PATH 4096

/* A file being written. Write to `file`; then rt_output_commit, or rt_output_discard. */
typedef struct RtOutput {
    FILE *file;                                          /* NULL: not, or no longer, open */
    char path[RT_MAX_PATH], temporary[RT_MAX_PATH + 24]; /* "": there is no temporary file */
} RtOutput;

/* Refuses a `path` that is there and not a regular file: renaming would replace /dev/null, say. */
RtStatus rt_output_open(RtOutput *output, const char *path, RtError *error);

/* The same for the file `name` in `folder` (rt_path_join). */
RtStatus rt_output_open_in(RtOutput *output, const char *folder, const char *name, RtError *error);

/* Flushes to the disk and closes: only the name is left to be given, by rt_output_commit. A failed write of
 * any time before is reported here, and discards. */
RtStatus rt_output_finish(RtOutput *output, RtError *error);

/* Finishes, unless that is done, and renames. */
RtStatus rt_output_commit(RtOutput *output, RtError *error);

/* Closes and removes the temporary file, if there still is one. */
void rt_output_discard(RtOutput *output);

/* Writes `size` bytes to `path`, in this way. */
RtStatus rt_file_write(const char *path, const void *data, size_t size, RtError *error);

/* Files that change together: all are on the disk before the first gets its name. {0} has none; release it
 * with rt_outputs_clear, which discards those that have not got their names. */
typedef struct RtOutputs {
    RtOutput *list;
    uint32_t count, capacity;
} RtOutputs;

/* Opens one more, to be written and finished; *output is valid until the next is added. */
RtStatus rt_outputs_add(RtOutputs *outputs, const char *path, RtOutput **output, RtError *error);

/* Adds a copy of the file `from`, of 16 MiB at most. */
RtStatus rt_outputs_copy(RtOutputs *outputs, const char *from, const char *to, RtError *error);

/* Gives all of them their names, in the order in which they were added. */
RtStatus rt_outputs_commit(RtOutputs *outputs, RtError *error);
void rt_outputs_clear(RtOutputs *outputs);

/* Removes the temporary files in `folder` of processes that were killed: to be called where nobody else
 * writes into the folder. */
void rt_outputs_remove_left(const char *folder);

/* Opens a regular file for reading; anything else (a folder, a device, a pipe that nobody writes to) is
 * refused. */
RtStatus rt_file_open(const char *path, FILE **file, RtError *error);

/* The whole file, with a 0 after its last byte; refuses more than `limit` bytes. Free with rt_free. */
RtStatus rt_file_read(const char *path, size_t limit, char **data, size_t *size, RtError *error);

bool rt_file_exists(const char *path);

/* Whether `path` is a symbolic link that leads to no file, and the message about it. */
bool rt_file_is_dead_link(const char *path, RtError *error);

/* Creates the directory and its parents where they are missing. */
RtStatus rt_directory_create(const char *path, RtError *error);

/* Calls visit(context, path) for every file of the folder whose name ends in `suffix`, in the order of names,
 * and gives their number: 0 also where the folder cannot be read. */
size_t rt_directory_each(const char *folder, const char *suffix,
                         void (*visit)(void *context, const char *path), void *context);

/* "FOLDER/name" to out[0..RT_MAX_PATH); an absolute name, or an empty folder, gives the name alone. Refuses
 * what is too long. */
RtStatus rt_path_join(const char *folder, const char *name, char *out, RtError *error);

/* The folder of `path`, "" where it names none, to out[0..RT_MAX_PATH). */
void rt_path_folder(const char *path, char *out);

#endif
