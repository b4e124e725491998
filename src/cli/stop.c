/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/stop.h"

#include "cli/cli.h"
#include "core/base/file.h"
#include "core/base/process.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static pid_t owner; /* of the files and processes: plugins run in forks that have the same handlers */
static char time_is_over[64] = "stopped by an alarm";
static const char *volatile keeps, *volatile go_on; /* NULL: nothing is kept, or continues */

int rt_stop_code(int number) {
    return number == SIGALRM ? RT_EXIT_BAD_INPUT : 128 + number;
}

void rt_stop_continue(const char *folder, const char *command) {
    keeps = folder;
    go_on = command;
}

static void say(const char *text) {
    if (write(STDERR_FILENO, text, strlen(text)) < 0) return;
}

void rt_stop_say(int number) {
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
    if (own && (tells || number == SIGALRM)) rt_stop_say(number);
    if (own) {
        rt_outputs_remove_open();
        rt_processes_kill();
    }
    if ((own && tells) || number == SIGALRM) _exit(rt_stop_code(number));
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

sigset_t rt_stop_signals(void) {
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
