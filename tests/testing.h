/* What every test file includes: cmocka, in the order it wants, and a few helpers. */
#ifndef RT_TESTS_TESTING_H
#define RT_TESTS_TESTING_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdbool.h>

/* The tests of the file test_NAME.c: the body runs them and gives what cmocka_run_group_tests gives, or
 * RT_TEST_SKIPPED. tests/main.c calls it. */
#define RT_TEST_GROUP(name)                                                                                  \
    int test_##name(void);                                                                                   \
    int test_##name(void)

/* Exit code of a test executable that ctest reports as skipped. */
#define RT_TEST_SKIPPED 77

/* For calls that must succeed: fails the test with the message of `error`. */
#define assert_ok(expr)                                                                                      \
    do {                                                                                                     \
        RtError rt_ok_error = {RT_OK, ""};                                                                   \
        RtError *error = &rt_ok_error;                                                                       \
        if ((expr) != RT_OK) fail_msg("%s: %s", #expr, rt_ok_error.message);                                 \
    } while (0)

#endif
