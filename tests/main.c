/* SPDX-License-Identifier: Apache-2.0 */
/* The main function of each room's tests: runs the groups that are named, or all, in the order of
 * CMakeLists.txt, whose list is RT_TEST_GROUPS. Exit code 1 where a test failed, 77 where every group was
 * skipped, 2 for a name that is none. */
#include "testing.h"

#define X(name) int test_##name(void);
RT_TEST_GROUPS
#undef X

static const struct {
    const char *name;
    int (*run)(void);
} groups[] = {
#define X(name) {#name, test_##name},
    RT_TEST_GROUPS
#undef X
};

enum { GROUP_COUNT = sizeof groups / sizeof groups[0] };

static bool is_known(const char *name) {
    for (size_t i = 0; i < GROUP_COUNT; i++) {
        if (strcmp(groups[i].name, name) == 0) return true;
    }
    fprintf(stderr, "there is no group of tests '%s' here; there are:", name);
    for (size_t i = 0; i < GROUP_COUNT; i++) fprintf(stderr, " %s", groups[i].name);
    fputc('\n', stderr);
    return false;
}

static bool is_wanted(const char *name, int argc, char **argv) {
    bool wanted = argc < 2;
    for (int i = 1; i < argc; i++) wanted |= strcmp(name, argv[i]) == 0;
    return wanted;
}

int main(int argc, char **argv) {
    bool failed = false, skipped = true;
    unsetenv("COLUMNS"); /* tables would be printed in parts */
    for (int i = 1; i < argc; i++) {
        if (!is_known(argv[i])) return 2;
    }
    for (size_t i = 0; i < GROUP_COUNT; i++) {
        if (!is_wanted(groups[i].name, argc, argv)) continue;
        int result = groups[i].run();
        skipped &= result == RT_TEST_SKIPPED;
        failed |= result != RT_TEST_SKIPPED && result != 0;
    }
    return failed ? 1 : skipped ? RT_TEST_SKIPPED : 0;
}
