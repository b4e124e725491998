/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of commands share: the program as a user runs it, and what it writes. */
#ifndef RT_TESTS_COMMAND_TESTING_H
#define RT_TESTS_COMMAND_TESTING_H

#include "testing.h"

#include <sys/wait.h>

/* Runs raytally with arguments as of printf, and these redirections; gives the exit code, or -1. */
__attribute__((format(printf, 2, 3))) static inline int raytally_to(const char *redirections,
                                                                    const char *arguments, ...) {
    char command[4096], text[3072];
    va_list args;
    va_start(args, arguments);
    vsnprintf(text, sizeof text, arguments, args);
    va_end(args);
    snprintf(command, sizeof command, "'%s' %s %s", RT_PROGRAM, text, redirections);
    int status = system(command);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* The text of a file, until the next call. */
static inline const char *text_of(const char *path) {
    static char text[1 << 18];
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    text[fread(text, 1, sizeof text - 1, file)] = '\0';
    fclose(file);
    return text;
}

/* The last run ended with this exit code, and the file says so. */
static inline void assert_said(int code, int expected, const char *path, const char *says) {
    if (code == expected && strstr(text_of(path), says)) return;
    fail_msg("exit code %d, expected %d with '%s': %s", code, expected, says, text_of(path));
}

#endif
