/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/jobs.h"

#include "cli/cli.h"
#include "core/base/clock.h"
#include "core/base/file.h"
#include "core/base/process.h"
#include "core/base/words.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

/* ---- what ends a command early ---- */

static pid_t owner; /* of the files and processes: plugins run in forks that have the same handlers */
static char time_is_over[64] = "stopped by an alarm";
static const char *volatile keeps, *volatile go_on; /* NULL: nothing is kept, or continues */

/* The exit code after a signal: after SIGALRM that of too little time. */
static int code_of(int number) {
    return number == SIGALRM ? RT_EXIT_BAD_INPUT : 128 + number;
}

void rt_stop_continue(const char *folder, const char *command) {
    keeps = folder;
    go_on = command;
}

static void say(const char *text) {
    if (write(STDERR_FILENO, text, strlen(text)) < 0) return;
}

/* "interrupted", or "stopped after 60 s (--time)", and what rt_stop_continue has set. In a handler, too. */
static void say_stopped(int number) {
    say(isatty(STDERR_FILENO) == 1 ? "\r\033[Kraytally: " : "raytally: ");
    say(number == SIGALRM ? time_is_over : "interrupted");
    if (keeps) say("; what is finished is kept in ");
    if (keeps) say(keeps);
    if (go_on) say(". To continue:\n  ");
    if (go_on) say(go_on);
    say("\n");
}

static void stop(int number) {
    const bool own = getpid() == owner, tells = go_on && number != SIGABRT;
    if (own && (tells || number == SIGALRM)) say_stopped(number);
    if (own) {
        rt_outputs_remove_open();
        rt_processes_kill();
    }
    if ((own && tells) || number == SIGALRM) _exit(code_of(number));
    raise(number); /* which ends the process once the handler returns */
}

static bool is_ignored(int number) {
    struct sigaction action;
    return sigaction(number, NULL, &action) == 0 && action.sa_handler == SIG_IGN;
}

void rt_stop_init(void) {
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGALRM, SIGABRT};
    owner = getpid();
    rt_stop_continue(NULL, NULL);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        struct sigaction action = {.sa_handler = stop, .sa_flags = (int)SA_RESETHAND};
        sigemptyset(&action.sa_mask);
        if (!is_ignored(numbers[i])) sigaction(numbers[i], &action, NULL);
    }
}

/* The signals that a command with several jobs takes itself, unless they are ignored. */
static sigset_t signals_of_jobs(void) {
    static const int numbers[] = {SIGINT, SIGTERM, SIGALRM};
    sigset_t signals;
    sigemptyset(&signals);
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++)
        if (!is_ignored(numbers[i])) sigaddset(&signals, numbers[i]);
    return signals;
}

void rt_stop_after(unsigned seconds) {
    snprintf(time_is_over, sizeof time_is_over, "stopped after %u s (--time)", seconds);
    alarm(seconds);
}

/* ---- several jobs ---- */

static volatile sig_atomic_t last_signal; /* 0: none */
static volatile pid_t running;            /* the fork; 0: none, as between two jobs and after the last */

/* Also in a handler of signals. */
_Noreturn static void leave(int number, bool told) {
    if (!told) say_stopped(number);
    _exit(code_of(number));
}

static void pass_on(int number) {
    last_signal = number;
    if (running == 0) leave(number, false);
    kill(running, number);
}

/* With these signals blocked, so that each goes to the fork, which stops as the command for one job does. */
static RtStatus start(RtJob *job, RtError *error) {
    const sigset_t signals = signals_of_jobs();
    sigset_t before;
    fflush(NULL); /* or the fork would write it again */
    sigprocmask(SIG_BLOCK, &signals, &before);
    const pid_t child = fork();
    const int why = errno;
    job->here = child == 0;
    running = child > 0 ? child : 0;
    const struct sigaction action = {.sa_handler = pass_on, .sa_mask = signals};
    if (job->here) rt_stop_init();
    for (int number = 1; number < _NSIG && !job->here; number++)
        if (sigismember(&signals, number) == 1) sigaction(number, &action, NULL);
    sigprocmask(SIG_SETMASK, &before, NULL);
    return child >= 0 ? RT_OK : rt_fail(error, RT_IO, "a process for %s: %s", job->name, strerror(why));
}

RtStatus rt_job_run(RtJob *job, const char *command, RtError *error) {
    const double began = rt_wall_seconds();
    int how = 0;
    rt_stop_continue(NULL, command);
    RT_TRY(start(job, error));
    if (job->here) return RT_OK;
    pid_t ended;
    while ((ended = waitpid(running, &how, 0)) < 0 && errno == EINTR) {
    }
    running = 0;
    if (ended < 0) return rt_fail(error, RT_IO, "waiting for %s: %s", job->name, strerror(errno));
    job->seconds = rt_wall_seconds() - began;
    job->signal = WIFSIGNALED(how) ? WTERMSIG(how) : 0;
    job->code = job->signal ? RT_EXIT_BAD_INPUT : WEXITSTATUS(how);
    if (!last_signal) return RT_OK;
    fflush(NULL);
    leave(last_signal, job->code == code_of(last_signal));
}

void rt_jobs_print(const RtJob *jobs, uint32_t count, FILE *out) {
    fprintf(out, "\n%-32s %-24s %10s\n", "experiment", "state", "time");
    for (uint32_t i = 0; i < count; i++) {
        char state[64] = "finished", duration[RT_MAX_DURATION];
        if (jobs[i].signal)
            snprintf(state, sizeof state, "ended by signal %d", jobs[i].signal);
        else if (jobs[i].code)
            snprintf(state, sizeof state, "failed, exit code %d", jobs[i].code);
        rt_format_duration(jobs[i].seconds, duration);
        fprintf(out, "%-32s %-24s %10s\n", jobs[i].name, state, duration);
    }
}

RtStatus rt_jobs_check(const RtJob *jobs, uint32_t count, RtError *error) {
    uint32_t failed = 0, first = 0;
    int worst = RT_EXIT_OK;
    for (uint32_t i = 0; i < count; i++) {
        if (jobs[i].code == RT_EXIT_OK) continue;
        if (failed++ == 0) first = i;
        if (jobs[i].code > worst) worst = jobs[i].code;
    }
    if (failed == 0) return RT_OK;
    return rt_fail(error, worst == RT_EXIT_CHECK_FAILED ? RT_MISMATCH : RT_BAD_INPUT,
                   "%" PRIu32 " of %" PRIu32 " experiment%s failed, the first: %s", failed, count,
                   rt_plural(count), jobs[first].name);
}
