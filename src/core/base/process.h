/* SPDX-License-Identifier: Apache-2.0 */
/* Child processes: starting, watching and ending them. Two kinds: another program (rt_process_spawn), and a
 * copy of this process for code that raytally does not trust (rt_process_fork).
 *
 * raytally may be a library in a program that ignores SIGCHLD or waits for all of its children. Then the exit
 * code is lost, and the process id may belong to another process. So a child is referred to by a descriptor
 * (pidfd, Linux 5.4): it reports the end whoever waited for the child, and never refers to another process.
 */
#ifndef RT_BASE_PROCESS_H
#define RT_BASE_PROCESS_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <sys/types.h>

/* All zero: none. */
typedef struct RtProcess {
    pid_t pid;      /* of the child; 0 in the child itself, and after the child has ended */
    int descriptor; /* -1 where the kernel has no pidfd: the process id then has to do */
    bool group;     /* it leads a process group, which is killed when it ends */
} RtProcess;

/* How a process ended. */
typedef struct RtProcessEnd {
    int signal;         /* that killed it, or 0 */
    int code;           /* exit code; -1: unknown, because other code waited for it */
    uint32_t left;      /* processes of its group that still ran then, and were killed */
    char left_name[16]; /* the program of one of them */
} RtProcessEnd;

/* A program to run. Files are relative to `directory`; a stream without file or pipe is inherited, except
 * stdin, which is empty. */
typedef struct RtProcessCommand {
    char *const *arguments; /* NULL behind the last; [0] is the program, searched for in $PATH ... */
    const char *program;    /* ... unless this is its path */
    const char *directory;  /* to run it in; NULL: the current one */
    const char *out, *log;  /* files that stdout and stderr are written to, or NULL */
    FILE **to, **from; /* both or none: get a connection to its stdin and from its stdout. The caller's */
} RtProcessCommand;

/* Starts a program. RT_NOT_AVAILABLE if there is no such program, else RT_IO. */
RtStatus rt_process_spawn(RtProcess *process, const RtProcessCommand *command, RtError *error);

/* Runs a program to its end. RT_OK, whatever *end is, if it could be started. */
RtStatus rt_process_run(const RtProcessCommand *command, RtProcessEnd *end, RtError *error);

/* Forks: *process is the child or, in the child, has pid 0. The child has none of raytally's files open
 * except stderr, which also becomes its stdout, and the descriptor `keep` (-1: none), which becomes
 * RT_PROCESS_KEPT. It cannot send raytally signals, and everything it starts ends with it, because nothing
 * can leave its process group. RT_IO if it cannot be started. */
enum { RT_PROCESS_KEPT = 3 };
RtStatus rt_process_fork(RtProcess *process, int keep, RtError *error);

/* Sends it a signal, if it still runs. */
void rt_process_signal(const RtProcess *process, int number);

/* Waits for its end for at most so many milliseconds (below 0: without limit). False if it still runs; else
 * *process is zeroed. */
bool rt_process_wait(RtProcess *process, int milliseconds, RtProcessEnd *end);

/* The same, but kills it if it still runs then. */
void rt_process_end(RtProcess *process, int milliseconds);

/* The number in an entry of /proc/PID/status, "Threads"; sizes of memory are in kB. 0 if it is unknown. */
uint64_t rt_process_status(pid_t pid, const char *entry);

/* Kills all that run, up to 64; for handlers of signals that end this process. In other threads,
 * rt_process_wait does not return any more: nobody takes their end for a crash. */
void rt_processes_kill(void);

/* How it ended, to out[0..size): "it crashed (Segmentation fault)". `reported` is a signal that the process
 * itself recorded, or 0; it takes precedence over *end. `detail` follows the name of a signal. */
void rt_process_end_format(RtProcessEnd end, int reported, const char *detail, char *out, size_t size);

#endif
