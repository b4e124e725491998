/* SPDX-License-Identifier: Apache-2.0 */
/* Commands that work on a result directory: their common command line, `raytally COMMAND DIR`. */
#ifndef RT_CLI_DIRECTORY_H
#define RT_CLI_DIRECTORY_H

#include "report/result_directory.h"

#include <argp.h>

/* Their options, without what explains each of them; the input is a const char *, the directory, NULL at
 * first. */
extern const struct argp rt_directory_argp;

/* What such a command does with the directory once experiment and results are loaded from it. */
typedef RtStatus RtDirectoryWork(const char *directory, const RtExperiment *experiment, RtResults *results,
                                 RtError *error);

/* Parses the arguments, loads, works; gives the exit code. `help` explains the command. One that writes into
 * the directory has it to itself. */
int rt_cli_directory(int argc, char **argv, const char *help, bool writes, RtDirectoryWork *work);

/* The same for a command that has parsed its arguments, by rt_directory_argp and options of its own. */
int rt_cli_directory_work(const char *directory, bool writes, RtDirectoryWork *work);

#endif
