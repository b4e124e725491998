/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/turns.h"

#include "cli/cli.h"
#include "cli/progress.h"
#include "core/base/clock.h"
#include "core/base/words.h"

#include <errno.h>
#include <inttypes.h>
#include <signal.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static volatile sig_atomic_t taken;  /* the last signal; 0: none */
static volatile pid_t now;           /* the fork that has its turn; 0: between turns, and after the last */
static const char *volatile command; /* that continues */

/* Also in a handler of signals. */
static void say(const char *text) {
    if (write(STDERR_FILENO, text, strlen(text)) < 0) return;
}

_Noreturn static void leave(int number, bool told) {
    if (!told) say("raytally: interrupted. To continue:\n  ");
    if (!told) say(command);
    if (!told) say("\n");
    _exit(128 + number);
}

static void pass_on(int number) {
    taken = number;
    if (now == 0) leave(number, false);
    kill(now, number);
}

static void handle(void (*handler)(int)) {
    struct sigaction action = {.sa_handler = handler};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

/* With both signals blocked, so that each goes to the fork, whose handlers are the default ones. */
static RtStatus start(RtTurn *turn, RtError *error) {
    sigset_t signals, before;
    sigemptyset(&signals);
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
    fflush(NULL); /* or the fork would write it again */
    sigprocmask(SIG_BLOCK, &signals, &before);
    const pid_t child = fork();
    const int why = errno;
    turn->here = child == 0;
    now = child > 0 ? child : 0;
    handle(turn->here ? SIG_DFL : pass_on);
    sigprocmask(SIG_SETMASK, &before, NULL);
    return child >= 0 ? RT_OK : rt_fail(error, RT_IO, "a process for %s: %s", turn->name, strerror(why));
}

RtStatus rt_turn_take(RtTurn *turn, const char *go_on, RtError *error) {
    const double began = rt_wall_seconds();
    int how = 0;
    command = go_on;
    RT_TRY(start(turn, error));
    if (turn->here) return RT_OK;
    while (waitpid(now, &how, 0) < 0 && errno == EINTR) {
    }
    now = 0;
    turn->seconds = rt_wall_seconds() - began;
    turn->signal = WIFSIGNALED(how) ? WTERMSIG(how) : 0;
    turn->code = turn->signal ? RT_EXIT_BAD_INPUT : WEXITSTATUS(how);
    if (!taken) return RT_OK;
    fflush(NULL);
    leave(taken, turn->code == 128 + taken);
}

void rt_turns_print(const RtTurn *turns, uint32_t count, FILE *out) {
    fprintf(out, "\n%-32s %-24s %10s\n", "experiment", "state", "time");
    for (uint32_t i = 0; i < count; i++) {
        char state[64] = "finished", duration[RT_MAX_DURATION];
        if (turns[i].signal)
            snprintf(state, sizeof state, "ended by signal %d", turns[i].signal);
        else if (turns[i].code)
            snprintf(state, sizeof state, "failed, exit code %d", turns[i].code);
        rt_format_duration(turns[i].seconds, duration);
        fprintf(out, "%-32s %-24s %10s\n", turns[i].name, state, duration);
    }
}

RtStatus rt_turns_check(const RtTurn *turns, uint32_t count, RtError *error) {
    uint32_t failed = 0, first = 0;
    int worst = RT_EXIT_OK;
    for (uint32_t i = 0; i < count; i++) {
        if (turns[i].code == RT_EXIT_OK) continue;
        if (failed++ == 0) first = i;
        if (turns[i].code > worst) worst = turns[i].code;
    }
    if (failed == 0) return RT_OK;
    return rt_fail(error, worst == RT_EXIT_CHECK_FAILED ? RT_MISMATCH : RT_BAD_INPUT,
                   "%" PRIu32 " of %" PRIu32 " experiment%s failed, the first: %s", failed, count,
                   rt_plural(count), turns[first].name);
}
