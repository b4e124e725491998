/* SPDX-License-Identifier: Apache-2.0 */
/* A command that does several things one after the other, each in a process of its own: a fork that returns
 * from main as the command for that thing alone would. So each measures as it would alone, and a crash, or a
 * lack of memory, ends one of them and not the others. */
#ifndef RT_CLI_TURNS_H
#define RT_CLI_TURNS_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct RtTurn {
    const char *name; /* set before, for rt_turns_print; borrowed */
    bool here;        /* in the fork: this process takes the turn */
    int code;         /* its exit code, 2 after a signal */
    int signal;       /* that ended it, or 0 */
    double seconds;   /* wall time */
} RtTurn;

/* Forks, and waits for the end of the fork. Call it before anything starts threads. SIGINT and SIGTERM are
 * passed on to the fork, and end this process after it, with 128 + their number; if the fork was too young to
 * say how to continue, or there is none, as between two turns, this process prints `go_on`, borrowed. */
RtStatus rt_turn_take(RtTurn *turn, const char *go_on, RtError *error);

/* Prints how each of them ended, and how long it took. */
void rt_turns_print(const RtTurn *turns, uint32_t count, FILE *out);

/* The worst of their exit codes as a status, with the number of those that failed. */
RtStatus rt_turns_check(const RtTurn *turns, uint32_t count, RtError *error);

#endif
