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

void rt_stop_clean(void) {
    if (getpid() != owner) return;
    rt_outputs_remove_open();
    rt_processes_kill();
}

int rt_stop_code(int number) {
    return number == SIGALRM ? RT_EXIT_BAD_INPUT : 128 + number;
}

const char *rt_stop_reason(int number) {
    return number == SIGALRM ? time_is_over : "interrupted";
}

void rt_stop_say(const char *text) {
    if (write(STDERR_FILENO, text, strlen(text)) < 0) return;
}

static void stop(int number) {
    if (number == SIGALRM) {
        rt_stop_say("raytally: ");
        rt_stop_say(time_is_over);
        rt_stop_say("\n");
    }
    rt_stop_clean();
    if (number == SIGALRM) _exit(rt_stop_code(number));
    raise(number); /* which ends the process once the handler returns */
}

static bool is_ignored(int number) {
    struct sigaction action;
    return sigaction(number, NULL, &action) == 0 && action.sa_handler == SIG_IGN;
}

void rt_stop_init(void) {
    static const int numbers[] = {SIGINT, SIGTERM, SIGHUP, SIGALRM, SIGABRT};
    owner = getpid();
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
