/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/plugin/process.h"

#include "core/base/clock.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <poll.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { BY_DESCRIPTOR = 3 /* P_PIDFD, which is younger than other things of waitid */, PAUSE = 10 /* ms */ };

/* The child begins when its number has become a descriptor: until then it lives, and has the number. */
static void await_go(int go) {
    char byte;
    ssize_t got;
    do got = read(go, &byte, 1);
    while (got < 0 && errno == EINTR);
    if (got != 1) _exit(EXIT_FAILURE);
}

/* Closes all that raytally has open but its messages to the user, and `keep`. */
static void close_inherited(int keep) {
    int nothing = open("/dev/null", O_RDONLY);
    if (nothing >= 0) dup2(nothing, STDIN_FILENO);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    if (keep >= 0) dup2(keep, RT_PROCESS_KEPT);
    close_range((unsigned)RT_PROCESS_KEPT + (keep >= 0), ~0U, 0);
}

/* Has the kernel refuse (EPERM) what would end raytally or stop it: signals to it, to its process group and
 * to all processes. Where the kernel cannot do that, nothing is refused. */
static void protect(pid_t raytally, pid_t group) {
    if (group == 0)
        group = raytally; /* its leader is outside of this process namespace: nobody can name it */
    const struct {
        long call;
        int argument;
        pid_t value;
    } refused[] = {{SYS_kill, 0, raytally},
                   {SYS_kill, 0, -group},
                   {SYS_kill, 0, -1},
                   {SYS_tkill, 0, raytally},
                   {SYS_tgkill, 0, raytally},
                   {SYS_rt_sigqueueinfo, 0, raytally},
                   {SYS_rt_tgsigqueueinfo, 0, raytally},
                   {SYS_pidfd_open, 0, raytally},
                   {SYS_prlimit64, 0, raytally},
                   {SYS_ptrace, 1, raytally},
                   {SYS_process_vm_writev, 0, raytally},
                   {SYS_setpgid, 1, group}};
    const size_t rules = sizeof refused / sizeof refused[0];
    enum { A_RULE = 5 };
    struct sock_filter filter[sizeof refused / sizeof refused[0] * A_RULE + 1];
    const size_t low = __BYTE_ORDER == __BIG_ENDIAN ? 4 : 0; /* half of an argument */
    for (size_t i = 0; i < rules; i++) {
        const size_t argument = offsetof(struct seccomp_data, args) + 8 * (size_t)refused[i].argument + low;
        const struct sock_filter rule[A_RULE] = {
            BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
            BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)refused[i].call, 0, 3),
            BPF_STMT(BPF_LD | BPF_W | BPF_ABS, (uint32_t)argument),
            BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)refused[i].value, 0, 1),
            BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM)};
        memcpy(filter + i * A_RULE, rule, sizeof rule);
    }
    filter[rules * A_RULE] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    const struct sock_fprog program = {sizeof filter / sizeof filter[0], filter};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) /* the flag: it costs what is timed nothing */
        syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_SPEC_ALLOW, &program);
}

RtStatus rt_process_start(RtProcess *process, int keep, RtError *error) {
    const pid_t raytally = getpid(), group = getpgrp();
    int go[2];
    *process = (RtProcess){.descriptor = -1};
    if (pipe2(go, O_CLOEXEC) != 0) return rt_fail(error, RT_IO, "a pipe: %s", strerror(errno));
    fflush(NULL); /* or what waits to be written is written twice */
    process->pid = fork();
    int why = errno;
    if (process->pid == 0) {
        close(go[1]);
        await_go(go[0]);
        setpgid(0, 0); /* what it starts goes with it */
        close_inherited(keep);
        protect(raytally, group);
        return RT_OK;
    }
    if (process->pid > 0) {
        process->descriptor = (int)syscall(SYS_pidfd_open, process->pid, 0);
        while (write(go[1], "", 1) < 0 && errno == EINTR) {
        }
    }
    close(go[0]);
    close(go[1]);
    if (process->pid > 0) return RT_OK;
    *process = (RtProcess){0};
    return rt_fail(error, RT_IO, "a process for a plugin: %s", strerror(why));
}

void rt_process_signal(const RtProcess *process, int number) {
    if (process->pid <= 0) return;
    if (process->descriptor >= 0) {
        syscall(SYS_pidfd_send_signal, process->descriptor, number, NULL, 0);
    } else {
        kill(process->pid, number);
    }
}

/* ---- its end ---- */

/* Has it ended? If so, what is known of that. */
static bool has_ended(const RtProcess *process, RtProcessEnd *end) {
    struct pollfd ended = {.fd = process->descriptor, .events = POLLIN};
    bool held = process->descriptor >= 0;
    idtype_t type = held ? (idtype_t)BY_DESCRIPTOR : P_PID;
    id_t id = (id_t)(held ? process->descriptor : process->pid);
    siginfo_t about = {0};
    int got;
    if (held && poll(&ended, 1, 0) != 1) return false;
    do got = waitid(type, id, &about, WEXITED | WNOHANG);
    while (got != 0 && errno == EINTR);
    if (got != 0) return true; /* ECHILD: somebody else waited for it */
    if (about.si_pid == 0) return held;
    if (about.si_code == CLD_EXITED) end->code = about.si_status;
    if (about.si_code == CLD_KILLED || about.si_code == CLD_DUMPED) end->signal = about.si_status;
    return true;
}

static void nap(const RtProcess *process, int milliseconds) {
    struct pollfd ended = {.fd = process->descriptor, .events = POLLIN};
    poll(&ended, 1, milliseconds < PAUSE || process->descriptor >= 0 ? milliseconds : PAUSE);
}

bool rt_process_wait(RtProcess *process, int milliseconds, RtProcessEnd *end) {
    double until = rt_wall_seconds() + milliseconds / 1000.0;
    *end = (RtProcessEnd){0, -1};
    if (process->pid <= 0) return true;
    while (!has_ended(process, end)) {
        double left = until - rt_wall_seconds();
        if (left <= 0) return false;
        nap(process, (int)(left * 1000) + 1);
    }
    kill(-process->pid, SIGKILL); /* what it started, if that is still there */
    if (process->descriptor >= 0) close(process->descriptor);
    *process = (RtProcess){0};
    return true;
}

void rt_process_end(RtProcess *process, int milliseconds) {
    RtProcessEnd end;
    if (process->pid <= 0 || rt_process_wait(process, milliseconds, &end)) return;
    rt_process_signal(process, SIGKILL);
    while (!rt_process_wait(process, 1000, &end)) {
    }
}

void rt_process_end_format(RtProcessEnd end, int said, const char *detail, char *out, size_t room) {
    int number = said ? said : end.signal;
    const char *name = sigdescr_np(number);
    if (number) {
        snprintf(out, room, "it crashed (%s%s)", name ? name : "an unknown signal", detail);
    } else if (end.code >= 0) {
        snprintf(out, room, "it ended its process (exit code %d)", end.code);
    } else {
        snprintf(out, room, "it ended its process");
    }
}
