/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/process.h"

#include "core/base/clock.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { BY_DESCRIPTOR = 3 /* P_PIDFD, which some C libraries lack */, PAUSE = 10 /* ms */ };

/* ---- those that run ---- */

/* For rt_processes_kill: process ids, of groups below 0; 0: none. */
enum { MOST_LISTED = 64 };
static _Atomic pid_t listed[MOST_LISTED];
static atomic_bool stopping; /* they were killed, and this process is about to end */

static void relist(pid_t from, pid_t to) {
    for (int i = 0; i < MOST_LISTED; i++) {
        pid_t was = from;
        if (atomic_compare_exchange_strong(&listed[i], &was, to)) return;
    }
}

static pid_t listed_id(const RtProcess *process) {
    return process->group ? -process->pid : process->pid;
}

void rt_processes_kill(void) {
    atomic_store(&stopping, true);
    for (int i = 0; i < MOST_LISTED; i++) {
        const pid_t id = atomic_load(&listed[i]);
        if (id != 0) kill(id, SIGKILL);
    }
}

/* ---- copies of this process ---- */

/* The child starts work once the parent has its descriptor: until then it runs, and keeps its process id. */
static void await_go(int go) {
    char byte;
    ssize_t got;
    do got = read(go, &byte, 1);
    while (got < 0 && errno == EINTR);
    if (got != 1) _exit(EXIT_FAILURE);
}

/* Closes all of raytally's files except stderr and `keep`. */
static void close_inherited(int keep) {
    int nothing = open("/dev/null", O_RDONLY);
    if (nothing >= 0) dup2(nothing, STDIN_FILENO);
    dup2(STDERR_FILENO, STDOUT_FILENO);
    if (keep >= 0) dup2(keep, RT_PROCESS_KEPT);
    close_range((unsigned)RT_PROCESS_KEPT + (keep >= 0), ~0U, 0);
}

/* The kernel refuses (EPERM) system calls that would end or stop raytally: signals to it, to its process
 * group, to all processes, and by descriptor; and those that leave the child's own process group. A kernel
 * without seccomp refuses nothing. */
static void protect(pid_t raytally, pid_t group) {
    if (group == 0)
        group = raytally; /* its leader is outside of this process namespace: it has no number here */
    enum { ALWAYS = -1 };
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
                   {SYS_pidfd_send_signal, ALWAYS, 0},
                   {SYS_prlimit64, 0, raytally},
                   {SYS_ptrace, 1, raytally},
                   {SYS_process_vm_writev, 0, raytally},
                   {SYS_setpgid, ALWAYS, 0},
                   {SYS_setsid, ALWAYS, 0}};
    const size_t rules = sizeof refused / sizeof refused[0];
    enum { A_RULE = 5 };
    struct sock_filter filter[sizeof refused / sizeof refused[0] * A_RULE + 1];
    const size_t low = __BYTE_ORDER == __BIG_ENDIAN ? 4 : 0; /* half of an argument */
    for (size_t i = 0; i < rules; i++) {
        const bool always = refused[i].argument == ALWAYS; /* every argument is at least 0 */
        const size_t number = always ? 0 : (size_t)refused[i].argument;
        const size_t argument = offsetof(struct seccomp_data, args) + 8 * number + low;
        const struct sock_filter rule[A_RULE] = {
            BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr)),
            BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (uint32_t)refused[i].call, 0, 3),
            BPF_STMT(BPF_LD | BPF_W | BPF_ABS, (uint32_t)argument),
            BPF_JUMP(BPF_JMP | (always ? BPF_JGE : BPF_JEQ) | BPF_K, (uint32_t)refused[i].value, 0, 1),
            BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ERRNO | EPERM)};
        memcpy(filter + i * A_RULE, rule, sizeof rule);
    }
    filter[rules * A_RULE] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    const struct sock_fprog program = {sizeof filter / sizeof filter[0], filter};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0) /* the flag keeps timings unchanged */
        syscall(SYS_seccomp, SECCOMP_SET_MODE_FILTER, SECCOMP_FILTER_FLAG_SPEC_ALLOW, &program);
}

RtStatus rt_process_fork(RtProcess *process, int keep, RtError *error) {
    const pid_t raytally = getpid(), group = getpgrp();
    int go[2];
    *process = (RtProcess){.descriptor = -1, .group = true};
    if (pipe2(go, O_CLOEXEC) != 0) return rt_fail(error, RT_IO, "a pipe: %s", strerror(errno));
    fflush(NULL); /* or buffered output would be written twice */
    process->pid = fork();
    int why = errno;
    if (process->pid == 0) {
        close(go[1]);
        await_go(go[0]);
        setpgid(0, 0); /* so that what it starts can be ended with it */
        close_inherited(keep);
        protect(raytally, group);
        return RT_OK;
    }
    if (process->pid > 0) {
        process->descriptor = (int)syscall(SYS_pidfd_open, process->pid, 0);
        while (write(go[1], "", 1) < 0 && errno == EINTR) {
        }
        relist(0, listed_id(process));
    }
    close(go[0]);
    close(go[1]);
    if (process->pid > 0) return RT_OK;
    *process = (RtProcess){0};
    return rt_fail(error, RT_IO, "a process for a plugin: %s", strerror(why));
}

/* ---- other programs ---- */

/* `talk`: its end of a connection to its stdin and from its stdout, or -1. */
static int spawn(RtProcess *process, const RtProcessCommand *command, int talk) {
    enum { WRITE = O_WRONLY | O_CREAT | O_TRUNC, MODE = 0666 };
    posix_spawn_file_actions_t actions;
    if (posix_spawn_file_actions_init(&actions) != 0) return ENOMEM;
    if (command->directory) posix_spawn_file_actions_addchdir_np(&actions, command->directory);
    if (talk >= 0) {
        posix_spawn_file_actions_adddup2(&actions, talk, STDIN_FILENO);
        posix_spawn_file_actions_adddup2(&actions, talk, STDOUT_FILENO);
    } else {
        posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    }
    if (command->out) posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, command->out, WRITE, MODE);
    if (command->log) posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, command->log, WRITE, MODE);
    int failed =
        command->program
            ? posix_spawn(&process->pid, command->program, &actions, NULL, command->arguments, environ)
            : posix_spawnp(&process->pid, command->arguments[0], &actions, NULL, command->arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    return failed;
}

RtStatus rt_process_spawn(RtProcess *process, const RtProcessCommand *command, RtError *error) {
    int ends[2] = {-1, -1};
    *process = (RtProcess){.descriptor = -1};
    if (command->to && socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) {
        *command->to = *command->from = NULL;
        return rt_fail(error, RT_IO, "a connection to a process: %s", strerror(errno));
    }
    int failed = spawn(process, command, ends[1]);
    if (command->to) {
        close(ends[1]);
        /* Another child that inherited this end would keep this child from seeing the end of its input. */
        *command->to = fdopen(fcntl(ends[0], F_DUPFD_CLOEXEC, 0), "w");
        *command->from = fdopen(ends[0], "r");
    }
    if (failed) {
        *process = (RtProcess){0};
        return rt_fail(error, failed == ENOENT ? RT_NOT_AVAILABLE : RT_IO, "%s: cannot be started: %s",
                       command->program ? command->program : command->arguments[0], strerror(failed));
    }
    process->descriptor = (int)syscall(SYS_pidfd_open, process->pid, 0);
    relist(0, listed_id(process));
    if (!command->to || (*command->to && *command->from)) return RT_OK;
    return rt_fail_memory(error, "a connection to a process", 0);
}

RtStatus rt_process_run(const RtProcessCommand *command, RtProcessEnd *end, RtError *error) {
    RtProcess process;
    RT_TRY(rt_process_spawn(&process, command, error));
    rt_process_wait(&process, -1, end);
    return RT_OK;
}

/* ---- watching and ending ---- */

void rt_process_signal(const RtProcess *process, int number) {
    if (process->pid <= 0) return;
    if (process->descriptor >= 0)
        syscall(SYS_pidfd_send_signal, process->descriptor, number, NULL, 0);
    else
        kill(process->pid, number);
}

/* With WNOWAIT as `more`, a process that has ended keeps its id. */
static bool has_ended(const RtProcess *process, int more, RtProcessEnd *end) {
    struct pollfd ended = {.fd = process->descriptor, .events = POLLIN};
    bool held = process->descriptor >= 0;
    idtype_t type = held ? (idtype_t)BY_DESCRIPTOR : P_PID;
    id_t id = (id_t)(held ? process->descriptor : process->pid);
    siginfo_t about = {0};
    int got;
    if (held && poll(&ended, 1, 0) != 1) return false;
    do got = waitid(type, id, &about, WEXITED | WNOHANG | more);
    while (got != 0 && errno == EINTR);
    if (got != 0) return true; /* ECHILD: other code waited for it */
    if (about.si_pid == 0) return held;
    if (about.si_code == CLD_EXITED) end->code = about.si_status;
    if (about.si_code == CLD_KILLED || about.si_code == CLD_DUMPED) end->signal = about.si_status;
    return true;
}

/* Whether /proc/PID/stat shows a process of the group that is no zombie; its program goes to name[16]. */
static bool is_of_group(const char *pid, pid_t group, char *name) {
    char path[64], line[512] = "", state;
    int of;
    snprintf(path, sizeof path, "/proc/%.10s/stat", pid);
    FILE *file = fopen(path, "re");
    if (file && !fgets(line, sizeof line, file)) *line = '\0';
    if (file) fclose(file);
    const char *program = strchr(line, '('), *end = strrchr(line, ')');
    if (!program || !end || sscanf(end + 1, " %c %*d %d", &state, &of) != 2 || of != group || state == 'Z')
        return false;
    snprintf(name, 16, "%.*s", (int)(end - program - 1), program + 1);
    return true;
}

uint64_t rt_process_status(pid_t pid, const char *entry) {
    char path[64], line[256];
    uint64_t number = 0;
    const size_t length = strlen(entry);
    snprintf(path, sizeof path, "/proc/%d/status", (int)pid);
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof line, file)) {
        if (strncmp(line, entry, length) == 0 && line[length] == ':')
            number = strtoull(line + length + 1, NULL, 10);
    }
    if (file) fclose(file);
    return number;
}

/* Counts and kills what a process that has ended leaves behind. */
static void end_group(pid_t group, RtProcessEnd *end) {
    const struct dirent *entry;
    if (kill(-group, 0) != 0) return;
    DIR *all = opendir("/proc");
    while (all && (entry = readdir(all))) {
        if (*entry->d_name >= '1' && *entry->d_name <= '9')
            end->left += is_of_group(entry->d_name, group, end->left_name);
    }
    if (all) closedir(all);
    kill(-group, SIGKILL);
}

bool rt_process_wait(RtProcess *process, int milliseconds, RtProcessEnd *end) {
    const double until = milliseconds < 0 ? INFINITY : rt_wall_seconds() + milliseconds / 1000.0;
    *end = (RtProcessEnd){.code = -1};
    if (process->pid <= 0) return true;
    while (!has_ended(process, WNOWAIT, end)) {
        double left = until - rt_wall_seconds();
        if (left <= 0) return false;
        const int pause = (int)(fmin(left, process->descriptor >= 0 ? 60 : 1e-3 * PAUSE) * 1000) + 1;
        poll(&(struct pollfd){.fd = process->descriptor, .events = POLLIN}, 1, pause);
    }
    while (atomic_load(&stopping)) pause();
    relist(listed_id(process), 0); /* before its id may become another's */
    has_ended(process, 0, end);
    if (process->group) end_group(process->pid, end);
    if (process->descriptor >= 0) close(process->descriptor);
    *process = (RtProcess){0};
    return true;
}

void rt_process_end(RtProcess *process, int milliseconds) {
    RtProcessEnd end;
    if (process->pid <= 0 || rt_process_wait(process, milliseconds, &end)) return;
    rt_process_signal(process, SIGKILL);
    rt_process_wait(process, -1, &end);
}

void rt_process_end_format(RtProcessEnd end, int reported, const char *detail, char *out, size_t size) {
    int number = reported ? reported : end.signal;
    const char *name = sigdescr_np(number);
    if (number)
        snprintf(out, size, "it crashed (%s%s)", name ? name : "an unknown signal", detail);
    else if (end.code >= 0)
        snprintf(out, size, "it ended its process (exit code %d)", end.code);
    else
        snprintf(out, size, "it ended its process");
}
