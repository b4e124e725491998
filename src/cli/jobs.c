/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/jobs.h"

#include "cli/cli.h"
#include "cli/progress.h"
#include "cli/stop.h"
#include "core/base/clock.h"
#include "core/base/words.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static volatile sig_atomic_t last_signal; /* 0: none */
static volatile pid_t running;            /* the fork; 0: none, as between two jobs and after the last */

/* Also in a handler of signals. */
_Noreturn static void leave(int number, bool told) {
    if (!told) rt_stop_say(number);
    _exit(rt_stop_code(number));
}

static void pass_on(int number) {
    last_signal = number;
    if (running == 0) leave(number, false);
    kill(running, number);
}

/* With these signals blocked, so that each goes to the fork, which stops as the command for one job does. */
static RtStatus start(RtJob *job, RtError *error) {
    const sigset_t signals = rt_stop_signals();
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

RtStatus rt_job_run(RtJob *job, const char *go_on, RtError *error) {
    const double began = rt_wall_seconds();
    int how = 0;
    rt_stop_continue(NULL, go_on);
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
    leave(last_signal, job->code == rt_stop_code(last_signal));
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
