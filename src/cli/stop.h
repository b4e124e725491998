/* SPDX-License-Identifier: Apache-2.0 */
/* What ends a command early: SIGINT, SIGTERM, SIGHUP, SIGABRT, and --time. Temporary files and child
 * processes go with it, so that nothing half-written is left and nothing runs on. */
#ifndef RT_CLI_STOP_H
#define RT_CLI_STOP_H

#include <signal.h>

/* From now on these signals, unless they are ignored, and SIGALRM clean up before they end the process. Call
 * it first, and again in a fork, which then cleans up its own files and processes alone and continues
 * nothing. */
void rt_stop_init(void);

/* From now on one that stops this process says how to go on: by `command`; `folder` has what is finished, or
 * is NULL. Both are borrowed. */
void rt_stop_continue(const char *folder, const char *command);

/* The signals that a command with several jobs takes itself: SIGINT, SIGTERM and SIGALRM, unless they are
 * ignored. */
sigset_t rt_stop_signals(void);

/* The exit code after a signal: 128 + its number; after SIGALRM that of too little time. */
int rt_stop_code(int number);

/* Says on stderr "interrupted", or "stopped after 60 s (--time)", and what rt_stop_continue has set. In a
 * handler, too. */
void rt_stop_say(int number);

/* --time: sends SIGALRM after so many seconds. */
void rt_stop_after(unsigned seconds);

#endif
