/* SPDX-License-Identifier: Apache-2.0 */
/* Commands that work on a result directory: `raytally COMMAND DIR`. */
#ifndef RT_CLI_DIRECTORY_H
#define RT_CLI_DIRECTORY_H

#include "results/result_directory.h"

#define RT_DIRECTORY_MISSING  "a result DIR is missing, as in results/first-look"
#define RT_DIRECTORY_ARGUMENT RT_ARGUMENT("DIR", directory, RT_DIRECTORY_MISSING)

/* What such a command does with the directory once its results are loaded; `options` are the command's. */
typedef RtStatus RtDirectoryWork(const char *directory, RtResults *results, const void *options,
                                 RtError *error);

/* Loads the directory and works on it. A command that writes into the directory locks it. */
RtStatus rt_cli_directory_work(const char *directory, bool writes, RtDirectoryWork *work, const void *options,
                               RtError *error);

#endif
