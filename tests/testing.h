/* SPDX-License-Identifier: Apache-2.0 */
/* What every test file includes: cmocka, in the order it wants, and a few helpers. */
#ifndef RT_TESTS_TESTING_H
#define RT_TESTS_TESTING_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/base/memory.h"

#include <glob.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#if !defined(RT_SANITIZED) /* CMakeLists.txt: 1 with a sanitizer */
#define RT_SANITIZED 0
#endif

/* `work`, or with a sanitizer the smaller share `sanitized`: that takes 3 to 30 times as long, and finds
 * errors of the code, for which less work is enough. */
#define RT_SHARE(work, sanitized) (RT_SANITIZED ? (sanitized) : (work))

/* ---- tests ----
 *
 * RT_TEST(its_name_is_a_sentence) { ... } in tests/DIRECTORY/test_NAME.c is a test, and RT_TESTS(NAME, setup,
 * teardown) at the end of the file makes a group of all of them, in their order, for tests/main.c to run.
 * What is set up for the group, or for one test by RT_TEST_WITH, is *state. */

typedef struct RtTests {
    size_t count;
    int lines[64];
    struct CMUnitTest all[64];
} RtTests;

static RtTests rt_tests __attribute__((unused)); /* of this file */

/* Compilers call constructors in any order: tests go by their lines. */
static inline void rt_test_add(int line, struct CMUnitTest test) {
    size_t i = rt_tests.count++;
    if (i == sizeof rt_tests.lines / sizeof rt_tests.lines[0]) abort(); /* more than a file should have */
    for (; i > 0 && rt_tests.lines[i - 1] > line; i--) {
        rt_tests.lines[i] = rt_tests.lines[i - 1];
        rt_tests.all[i] = rt_tests.all[i - 1];
    }
    rt_tests.lines[i] = line;
    rt_tests.all[i] = test;
}

#define RT_TEST_WITH(name, setup, teardown)                                                                  \
    static void name(void **state);                                                                          \
    __attribute__((constructor)) static void add_##name(void) {                                              \
        rt_test_add(__LINE__, (struct CMUnitTest){#name, name, setup, teardown, NULL});                      \
    }                                                                                                        \
    static void name(__attribute__((unused)) void **state)

#define RT_TEST(name) RT_TEST_WITH(name, NULL, NULL)

#define RT_RUN_TESTS(name, setup, teardown)                                                                  \
    _cmocka_run_group_tests(name, rt_tests.all, rt_tests.count, setup, teardown)

/* A group that has more to do than to run its tests: the body gives what cmocka gives, or RT_TEST_SKIPPED. */
#define RT_TEST_GROUP(name)                                                                                  \
    int test_##name(void);                                                                                   \
    int test_##name(void)

#define RT_TESTS(name, setup, teardown)                                                                      \
    RT_TEST_GROUP(name) {                                                                                    \
        return RT_RUN_TESTS(#name, setup, teardown);                                                         \
    }

/* The teardown of a group that leaves nothing behind. */
static inline int assert_nothing_is_kept(void **state) {
    (void)state;
    return rt_alloc_live() == 0 ? 0 : -1;
}

/* Ends a test that cannot be done here, which ./test.sh lists with what would bring it in. */
#define RT_SKIP(needs)                                                                                       \
    do {                                                                                                     \
        print_message("skipped: needs %s\n", needs);                                                         \
        skip();                                                                                              \
    } while (0)

/* Owned variables clear themselves at the end of their scope, the last declared first. */
#define OWNED(clear)   __attribute__((cleanup(clear)))
#define OWNED_MEMORY   OWNED(free_owned)
#define OWNED_GEOMETRY OWNED(rt_geometry_clear) RtGeometry
#define OWNED_SCENE    OWNED(rt_scene_clear) RtScene
#define OWNED_FRAME    OWNED(rt_frame_clear) RtFrame
#define OWNED_IMAGE    OWNED(rt_image_clear) RtImage
#define OWNED_RESULTS  OWNED(rt_results_clear) RtResults
#define OWNED_SOLIDS   OWNED(rt_solid_set_clear) RtSolidSet
#define OWNED_BUILDER  OWNED(rt_csg_builder_clear) RtCsgBuilder
#define OWNED_FOREST   OWNED(rt_csg_forest_clear) RtCsgForest

/* The geometry `g` of one object: OWNED_OBJECT(g, sphere, center, radius). */
#define OWNED_OBJECT(g, shape, ...)                                                                          \
    OWNED_GEOMETRY g = {0};                                                                                  \
    assert_ok(rt_geometry_add_##shape(&(g), __VA_ARGS__, error));                                            \
    assert_ok(rt_geometry_finish(&(g), error))

static inline void free_owned(void *pointer) {
    rt_free(*(void **)pointer);
}

/* Exit code of a test executable that ctest reports as skipped. */
#define RT_TEST_SKIPPED 77

/* For calls that must succeed: fails the test with the message of `error`. */
#define assert_ok(expr)                                                                                      \
    do {                                                                                                     \
        RtError rt_ok_error = {RT_OK, ""};                                                                   \
        RtError *error = &rt_ok_error;                                                                       \
        if ((expr) != RT_OK) fail_msg("%s: %s", #expr, rt_ok_error.message);                                 \
    } while (0)

/* For calls that must fail: with this status, and a message that begins with `place` and contains `phrase`.
 */
#define assert_fails_at(expr, status, place, phrase)                                                         \
    do {                                                                                                     \
        RtError rt_failed = {RT_OK, ""};                                                                     \
        RtError *error = &rt_failed;                                                                         \
        if ((expr) != (status) || strncmp(rt_failed.message, place, strlen(place)) != 0 ||                   \
            !strstr(rt_failed.message, phrase))                                                              \
            fail_msg("%s: '%s' is not " #status " at '%s' with '%s'", #expr, rt_failed.message, place,       \
                     phrase);                                                                                \
    } while (0)

#define assert_fails_with(expr, status, phrase)  assert_fails_at(expr, status, "", phrase)
#define assert_bad_input_at(expr, place, phrase) assert_fails_at(expr, RT_BAD_INPUT, place, phrase)
#define assert_bad_input(expr, phrase)           assert_fails_at(expr, RT_BAD_INPUT, "", phrase)

/* Tries `call`, which gives a status, with the first allocation failing, then the second, and so on until
 * none does; then `undo` undoes it. Every failure is RT_NO_MEMORY, and nothing is left behind. */
#define assert_fails_cleanly(call, undo)                                                                     \
    do {                                                                                                     \
        RtStatus rt_tried = RT_NO_MEMORY;                                                                    \
        int64_t rt_live = rt_alloc_live();                                                                   \
        for (uint64_t rt_n = 1; rt_tried != RT_OK; rt_n++) {                                                 \
            RtError rt_failure = {RT_OK, ""};                                                                \
            RtError *error = &rt_failure;                                                                    \
            rt_alloc_fail_at(rt_n);                                                                          \
            rt_tried = (call);                                                                               \
            rt_alloc_fail_at(0);                                                                             \
            if (rt_tried == RT_OK)                                                                           \
                undo;                                                                                        \
            else if (rt_tried != RT_NO_MEMORY)                                                               \
                fail_msg("allocation %d: %s", (int)rt_n, rt_failure.message);                                \
            assert_int_equal(rt_alloc_live(), rt_live);                                                      \
            assert_in_range(rt_n, 1, 10000);                                                                 \
        }                                                                                                    \
    } while (0)

/* Neither the file `path` is there nor a temporary file that was to become it (rt_output_open). */
#define assert_not_written(path)                                                                             \
    do {                                                                                                     \
        glob_t rt_left;                                                                                      \
        assert_int_equal(access(path, F_OK), -1);                                                            \
        assert_int_equal(glob(path ".*.tmp", 0, NULL, &rt_left), GLOB_NOMATCH);                              \
    } while (0)

#endif
