/* SPDX-License-Identifier: Apache-2.0 */
/* base/: files, tallies, parameters, memory, child processes, rounding, random numbers. */
#include "testing.h"

#include "core/base/box.h"
#include "core/base/elementary.h"
#include "core/base/file.h"
#include "core/base/param.h"
#include "core/base/process.h"
#include "core/base/random.h"
#include "core/base/tally.h"
#include "core/base/words.h"

#include <ftw.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>

RT_TEST(a_text_makes_a_portable_file_name) {
    static const char *const names[][2] = {
        {"balls", "balls"},
        {"bunny-69k_2.5", "bunny-69k_2.5"},
        {"balls:size=3", "balls-size-3"},
        {"n=1|2*3?<>\"\\/", "n-1-2-3------"},
        {"a b\tc", "a-b-c"},
        {"..", "_."},
        {".hidden", "_hidden"},
        {"-n", "_n"},
        {"", "_"},
        {"a name that is too long for its place", "a-name-that-is-3c5beb56"},
    };
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char name[24];
        rt_file_name(names[i][0], name, sizeof name);
        assert_string_equal(name, names[i][1]);
    }
}

RT_TEST(a_command_quotes_what_a_shell_would_read_otherwise) {
    char command[80] = "raytally run";
    const char *const words[] = {"a/b-1_2.yaml", "two words", "n=1|2", "it's", "", "$x"};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        rt_append_argument(command, sizeof command, words[i]);
    assert_string_equal(command, "raytally run a/b-1_2.yaml 'two words' 'n=1|2' 'it'\\''s' '' '$x'");
}

RT_TEST(rounding_outward_brackets_the_number) {
    double third = 1.0 / 3.0;
    assert_true((double)rt_float_below(third) < third);
    assert_true((double)rt_float_above(third) > third);
    assert_true(rt_float_below(0.5) == 0.5f && rt_float_above(0.5) == 0.5f);
}

static __attribute__((noinline)) void narrow_and_widen(const double *from, double *to) {
    float x = (float)from[0], y = (float)from[1];
    to[0] = (double)x;
    to[1] = (double)y;
}

RT_TEST(narrowing_rounds_also_where_widening_follows) {
    volatile double third = 1.0 / 3.0; /* volatile: not to be computed by the compiler */
    volatile float rounded = (float)third;
    const double from[2] = {third, 2 * third};
    double to[2];
    narrow_and_widen(from, to);
    assert_true(to[0] == (double)rounded && to[1] == 2 * (double)rounded);
}

RT_TEST(messages_are_text_whatever_they_quote) {
    RtError error;
    rt_fail(&error, RT_IO, "%s", "\xff caf\xc3\xa9 \xe2\x82\xac \x1b[31m \xed\xa0\x80 \xc0\xaf \xc3");
    assert_string_equal(error.message, "? caf\xc3\xa9 \xe2\x82\xac ?[31m ??? ?? ?");
    char letters[2 * sizeof error.message] = "";
    for (size_t i = 0; i + 2 < sizeof letters; i += 2) memcpy(letters + i, "\xc3\xa9", 2);
    rt_fail(&error, RT_IO, "%s", letters); /* the end is cut within a letter */
    assert_int_equal(strlen(error.message), sizeof error.message - 1);
    assert_string_equal(error.message + sizeof error.message - 4, "\xc3\xa9?");
    rt_fail_at(&error, "\xfe.yaml", 0, 0, "wrong");
    assert_string_equal(error.message, "?.yaml: wrong");
}

RT_TEST(tallies_add_counter_by_counter) {
    RtTally sum = {.rays = 1, .passed_on = 2}, part = {.rays = 10, .steps = 5};
    rt_tally_add(&sum, &part);
    assert_int_equal(sum.rays, 11);
    assert_int_equal(sum.steps, 5);
    assert_int_equal(sum.passed_on, 2);
    assert_string_equal(rt_tally_name(0), "rays");
    assert_int_equal(rt_tally_get(&sum, 0), 11);
}

/* Also when a sum is added to another, it never wraps around to a small number. */
RT_TEST(tallies_are_exact_up_to_2_63_and_say_that_they_have_reached_it) {
    const RtTally many = {.steps = UINT64_C(3) << 32}, most = {.steps = RT_TALLY_MOST, .rays = 7};
    RtTally sum = {0};
    for (int i = 0; i < 5; i++) rt_tally_add(&sum, &many);
    assert_true(sum.steps == UINT64_C(15) << 32);
    sum = (RtTally){.steps = RT_TALLY_MOST - 2};
    rt_tally_add(&sum, &(RtTally){.steps = 1});
    assert_true(sum.steps == RT_TALLY_MOST - 1 && !rt_tally_overflown(&sum));
    for (int i = 0; i < 5; i++) {
        rt_tally_add(&sum, &most);
        rt_tally_add(&sum, &(RtTally){.steps = UINT64_MAX});
        assert_true(sum.steps == RT_TALLY_MOST && sum.rays == 7 * ((uint64_t)i + 1));
        assert_string_equal(rt_tally_overflown(&sum), "steps");
    }
}

/* Opening a pipe would wait for its other end; renaming a file to a device would replace the device. */
RT_TEST(what_is_not_a_file_is_neither_read_nor_replaced) {
    static const char *const pipe = RT_BINARY_DIR "/test_base.pipe";
    remove(pipe);
    assert_int_equal(mkfifo(pipe, 0600), 0);
    const char *const paths[] = {pipe, "/dev/zero", RT_BINARY_DIR};
    for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
        RtOutput output;
        char *data;
        size_t size;
        assert_bad_input(rt_file_read(paths[i], 1 << 20, &data, &size, error), "not a file");
        assert_fails_with(rt_output_open(&output, paths[i], error), RT_IO, paths[i]);
    }
    remove(pipe);
}

/* ---- what is written ---- */

static char folder[32];

static int make_folder(void **state) {
    (void)state;
    strcpy(folder, "/tmp/raytally_base_XXXXXX");
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_path(const char *path, const struct stat *info, int type, struct FTW *at) {
    (void)info, (void)type, (void)at;
    return remove(path);
}

static int remove_folder(void **state) {
    (void)state;
    return nftw(folder, remove_path, 8, FTW_DEPTH | FTW_PHYS);
}

static void join_name(void *context, const char *path) {
    strcat(strcat(context, strrchr(path, '/')), " ");
}

/* "/a /b ", the names of all that is there, without . and .. */
static void assert_folder_has(const char *names) {
    char found[512] = "";
    rt_directory_each(folder, "", join_name, found);
    assert_memory_equal(found, "/. /.. ", 7);
    assert_string_equal(found + 7, names);
}

static const char *in_folder(const char *name) {
    static char paths[4][360];
    static int next;
    char *path = paths[next++ % 4];
    snprintf(path, sizeof paths[0], "%s/%s", folder, name);
    return path;
}

static void assert_has(const char *name, const char *expected) {
    OWNED_MEMORY char *text;
    size_t size;
    assert_ok(rt_file_read(in_folder(name), 1 << 20, &text, &size, error));
    assert_string_equal(text, expected);
}

#define RT_TEST_IN_FOLDER(name) RT_TEST_WITH(name, make_folder, remove_folder)

RT_TEST_IN_FOLDER(nothing_is_written_through_a_link_that_lies_where_a_file_is_written) {
    assert_ok(rt_file_write(in_folder("victim"), "safe", 4, error));
    assert_int_equal(symlink(in_folder("victim"), in_folder("out.tmp")), 0);
    assert_int_equal(symlink(in_folder("victim"), in_folder("out")), 0);
    assert_ok(rt_file_write(in_folder("out"), "new", 3, error));
    assert_has("victim", "safe");
    assert_has("out", "new");
    assert_folder_has("/out /out.tmp /victim ");
}

RT_TEST_IN_FOLDER(a_file_has_the_mode_that_the_umask_says) {
    struct stat info;
    mode_t before = umask(027);
    assert_ok(rt_file_write(in_folder("out"), "x", 1, error));
    umask(before);
    assert_int_equal(stat(in_folder("out"), &info), 0);
    assert_int_equal(info.st_mode & 0777, 0640);
}

RT_TEST_IN_FOLDER(a_file_that_is_given_up_or_cannot_get_its_name_leaves_nothing) {
    RtOutput output;
    assert_ok(rt_output_open(&output, in_folder("out"), error));
    rt_output_discard(&output);
    assert_folder_has("");
    assert_ok(rt_output_open(&output, in_folder("out"), error));
    assert_int_equal(mkdir(in_folder("out"), 0777), 0);
    assert_fails_with(rt_output_commit(&output, error), RT_IO, "");
    assert_folder_has("/out ");
}

RT_TEST_IN_FOLDER(files_that_change_together_are_whole_before_the_first_of_them_changes) {
    RtOutputs outputs = {0};
    RtOutput *output;
    assert_ok(rt_file_write(in_folder("a"), "old", 3, error));
    for (int turn = 0; turn < 2; turn++) {
        assert_ok(rt_outputs_add(&outputs, in_folder("b"), &output, error));
        fputs("new", output->file);
        assert_ok(rt_output_finish(output, error));
        assert_ok(rt_outputs_copy(&outputs, in_folder("a"), in_folder("c"), error));
        assert_bad_input(rt_outputs_copy(&outputs, in_folder("nowhere"), in_folder("a"), error), "");
        assert_int_equal(access(in_folder("b"), F_OK), -1);
        if (turn == 1) assert_ok(rt_outputs_commit(&outputs, error));
        rt_outputs_clear(&outputs);
        assert_folder_has(turn == 0 ? "/a " : "/a /b /c ");
    }
    assert_has("b", "new");
    assert_has("c", "old");
}

RT_TEST_IN_FOLDER(what_a_killed_process_was_writing_is_removed_and_nothing_else) {
    RtOutput output;
    assert_ok(rt_output_open(&output, in_folder("out"), error));
    fclose(output.file);
    assert_ok(rt_file_write(in_folder("mine.tmp"), "x", 1, error));
    assert_ok(rt_file_write(in_folder("mine-0123456789abcdef.tmp"), "x", 1, error));
    rt_outputs_remove_left(folder);
    assert_folder_has("/mine-0123456789abcdef.tmp /mine.tmp ");
}

RT_TEST_IN_FOLDER(a_signal_leaves_no_file_half_written) {
    RtOutput begun, committed;
    OWNED(rt_outputs_clear) RtOutputs others = {0};
    RtOutput *other;
    assert_ok(rt_output_open(&begun, in_folder("begun"), error));
    assert_ok(rt_output_open(&committed, in_folder("committed"), error));
    assert_ok(rt_output_commit(&committed, error));
    for (int i = 0; i < 100; i++) { /* more than are remembered at a time, but one after the other */
        assert_ok(rt_outputs_add(&others, in_folder("discarded"), &other, error));
        rt_outputs_clear(&others);
    }
    assert_ok(rt_outputs_add(&others, in_folder("finished"), &other, error));
    assert_ok(rt_output_finish(other, error));
    rt_outputs_remove_open();
    assert_folder_has("/committed ");
    rt_output_discard(&begun);
}

RT_TEST_IN_FOLDER(the_memory_of_a_container_is_the_least_of_its_groups) {
    static const char *const limits[][2] = {{"memory.max", "max\n"},
                                            {"job/memory.max", "4096000\n"},
                                            {"job/step/memory.max", "8192000\n"},
                                            {"memory/job/memory.limit_in_bytes", "2048000\n"}};
    static const struct {
        const char *groups;
        uint64_t limit;
    } cases[] = {{"0::/\n", UINT64_MAX},
                 {"0::/job/step\n", 4096000},
                 {"0::/job/other\n", 4096000},
                 {"3:cpu,cpuacct:/job\n7:memory:/job/step\n0::/\n", 2048000},
                 {"3:cpu,cpuacct:/job\n", UINT64_MAX},
                 {"", UINT64_MAX}};
    assert_ok(rt_directory_create(in_folder("job/step"), error));
    assert_ok(rt_directory_create(in_folder("memory/job"), error));
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++)
        assert_ok(rt_file_write(in_folder(limits[i][0]), limits[i][1], strlen(limits[i][1]), error));
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_ok(rt_file_write(in_folder("groups"), cases[i].groups, strlen(cases[i].groups), error));
        assert_int_equal(rt_memory_of_groups(in_folder("groups"), folder), cases[i].limit);
    }
}

static RtStatus write_much(RtMemoryFile *memory, RtError *error) {
    RT_TRY(rt_memory_file_open(memory, error));
    for (int i = 0; i < 9999; i++) fprintf(memory->file, "%04d\n", i);
    return rt_memory_file_close(memory, "numbers", error);
}

RT_TEST(a_file_in_memory_is_whole_or_reports_that_memory_is_short) {
    RtMemoryFile memory;
    assert_ok(write_much(&memory, error));
    assert_int_equal(memory.size, 5 * 9999);
    assert_int_equal(strlen(memory.data), memory.size);
    assert_string_equal(memory.data + memory.size - 5, "9998\n");
    rt_free(memory.data);
    assert_fails_cleanly(write_much(&memory, error), rt_free(memory.data));
}

RT_TEST_IN_FOLDER(a_file_may_have_the_longest_name_that_there_is) {
    char name[256] = "";
    memset(name, 'n', 255);
    assert_ok(rt_file_write(in_folder(name), "x", 1, error));
    assert_int_equal(remove(in_folder(name)), 0);
}

/* ---- parameters ---- */

static const RtParam table[] = {
    {.name = "width", .type = RT_PARAM_INT, .default_text = "4", .lo = 1, .hi = 64},
    {.name = "rule", .type = RT_PARAM_CHOICE, .default_text = "woo", .choices = "cubic|woo"},
    {.name = "resolution", .type = RT_PARAM_RESOLUTION, .default_text = "auto", .lo = 1, .hi = 512},
    {.name = "mailbox", .type = RT_PARAM_FLAG, .default_text = "on"},
};

RT_TEST(parameters_left_out_have_their_defaults) {
    RtValue v[4];
    char text[128];
    assert_ok(rt_params_parse(table, 4, "rule=cubic,resolution=46x46x3", "it", v, error));
    rt_params_format(table, 4, v, text, sizeof text);
    assert_string_equal(text, "width=4,rule=cubic,resolution=46x46x3,mailbox=on");
}

RT_TEST(wrong_parameters_are_refused_with_what_would_be_right) {
    const struct {
        const char *text, *says;
    } cases[] = {
        {"width=0", "1..64"},           {"width=1000000000", "1..64"},
        {"width=3.5", "whole number"},  {"wdith=3", "mean 'width'"},
        {"width", "key=value"},         {"width=2,width=3", "twice"},
        {"rule=grid", "cubic|woo"},     {"mailbox=yes", "on|off"},
        {"resolution=4x4", "NXxNYxNZ"}, {"resolution=-4x4x4", "NXxNYxNZ"},
        {"width=nan", "1..64"},         {"width=", "1..64"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtValue v[4];
        assert_bad_input(rt_params_parse(table, 4, cases[i].text, "it", v, error), cases[i].says);
    }
}

/* For any range in a table, including the limits of 64-bit integers. */
RT_TEST(whole_numbers_are_exact_or_refused) {
    static const RtParam any = {
        .name = "n", .type = RT_PARAM_INT, .default_text = "0", .lo = -1e30, .hi = 1e30};
    static const RtParam wide = {
        .name = "n", .type = RT_PARAM_RESOLUTION, .default_text = "auto", .lo = 1, .hi = 1e30};
    const struct {
        const char *text;
        int64_t is;
    } good[] = {{"n=9223372036854775807", INT64_MAX},
                {"n=-9223372036854775808", INT64_MIN},
                {"n=9007199254740993", INT64_C(9007199254740993)},
                {"n=9e18", INT64_C(9000000000000000000)},
                {"n=1e3", 1000}};
    const char *const bad[] = {"n=9223372036854775808", "n=-9223372036854775809", "n=1e19", "n=-1e19",
                               "n=99999999999999999999"};
    RtValue v;
    for (size_t i = 0; i < sizeof good / sizeof good[0]; i++) {
        assert_ok(rt_params_parse(&any, 1, good[i].text, "it", &v, error));
        assert_true(v.i == good[i].is);
    }
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        assert_bad_input(rt_params_parse(&any, 1, bad[i], "it", &v, error), "invalid value");
    assert_ok(rt_params_parse(&wide, 1, "n=4294967295x1x1", "it", &v, error));
    assert_bad_input(rt_params_parse(&wide, 1, "n=4294967297x1x1", "it", &v, error), "invalid value");
}

RT_TEST(the_nth_allocation_fails_when_told_to) {
    rt_alloc_fail_at(2);
    void *a = rt_alloc(1, 1), *b = rt_alloc(1, 1), *c = rt_alloc(1, 1);
    assert_non_null(a);
    assert_null(b);
    assert_non_null(c);
    rt_free(a);
    rt_free(c);
    assert_null(rt_alloc(SIZE_MAX, 2));
}

RT_TEST(an_arena_remembers_the_first_block_that_failed_and_frees_all) {
    const int64_t before = rt_alloc_live();
    for (uint64_t n = 1; n <= 4; n++) {
        RT_ARENA(arena);
        rt_alloc_fail_at(n); /* the blocks, and the list of them, which is allocated once */
        const uint32_t *zeros = rt_arena_alloc(&arena, 4, sizeof *zeros);
        void *unset = rt_arena_alloc_unset(&arena, 1, 1);
        rt_alloc_fail_at(0);
        assert_int_equal(rt_arena_check(&arena, "a test", NULL), n < 4 ? RT_NO_MEMORY : RT_OK);
        if (n < 4) assert_null(unset);
        if (n == 4) assert_int_equal(zeros[3], 0);
        rt_arena_free(&arena, unset);
        assert_int_equal(rt_alloc_live() - before, n < 3 ? 0 : 2);
    }
    assert_int_equal(rt_alloc_live(), before);
    RT_ARENA(huge);
    assert_null(rt_arena_alloc(&huge, SIZE_MAX, 2));
    assert_int_equal(rt_arena_check(&huge, "a test", NULL), RT_NO_MEMORY);
}

RT_TEST(whole_pages_of_a_part_of_a_block_are_given_back_and_no_others) {
    enum { PAGE = 1 << 21, PAGES = 4 };
    OWNED_MEMORY char *block = rt_alloc(PAGES, PAGE);
    memset(block, 1, (size_t)PAGES * PAGE);
    assert_ptr_equal(rt_discard(block + 1, block + 3 * PAGE - 1), block + 2 * PAGE);
    for (int i = 0; i < PAGES; i++) assert_int_equal(block[i * PAGE + 1], i != 1);
    assert_ptr_equal(rt_discard(block + 1, block + 2 * PAGE - 1), block + 1);
}

RT_TEST(a_trimmed_array_keeps_its_elements_and_no_unused_room) {
    enum { COUNT = 5 << 19 }; /* several large pages */
    OWNED_MEMORY uint32_t *array = NULL;
    uint32_t capacity = 0, count = 0;
    for (uint32_t i = 0; i <= COUNT; i++)
        assert_ok(rt_append(&array, &count, &capacity, &i, sizeof i, error));
    assert_true(capacity > count);
    const uint32_t before = capacity;
    rt_alloc_fail_at(1);
    rt_trim(&array, count, &capacity, sizeof *array);
    assert_int_equal(capacity, before);
    rt_trim(&array, count, &capacity, sizeof *array);
    assert_int_equal(capacity, count);
    for (uint32_t i = 0; i < count; i++) assert_int_equal(array[i], i);
    const uint32_t *kept = array;
    rt_trim(&array, count - 1, &capacity, sizeof *array); /* too little to copy for */
    assert_ptr_equal(array, kept);
    assert_int_equal(capacity, count);
}

RT_TEST(all_memory_of_a_process_is_limited_beside_that_of_a_step) {
    RtError error;
    OWNED_MEMORY void *block = rt_alloc(1, 1 << 19);
    rt_memory_limit_process(1 << 20);
    OWNED_MEMORY void *small = rt_alloc(1, 1 << 18);
    assert_true(block && small);
    rt_memory_limit(1 << 24);
    assert_null(rt_alloc(1, 1 << 19));
    rt_fail_memory(&error, "a block", 1 << 19);
    assert_int_equal(rt_memory_unlimit(RT_NO_MEMORY, &error), RT_NO_MEMORY);
    assert_int_equal(strncmp(error.message, "out of memory: 524288 bytes", 27), 0);
    assert_int_equal(rt_memory_unlimit_process(RT_NO_MEMORY, &error), RT_NO_MEMORY);
    assert_non_null(strstr(
        error.message, " MB of memory (that of --memory, or of this machine or container): out of memory"));
}

RT_TEST(random_numbers_depend_on_seed_stream_and_place_alone) {
    RtRandom a = rt_random(7, 1), b = rt_random(7, 1), c = rt_random(7, 2);
    bool differ = false;
    for (int i = 0; i < 9; i++) {
        uint32_t x = rt_random_bits(&a);
        assert_int_equal(x, rt_random_bits(&b));
        differ |= x != rt_random_bits(&c);
    }
    assert_true(differ);
}

RT_TEST_IN_FOLDER(files_are_listed_by_name_whatever_their_folder_is_called) {
    static const char *const names[] = {"a[1]*?/b.svg", "a[1]*?/a.svg", "a[1]*?/c.svg.tmp"};
    char found[64] = "";
    assert_ok(rt_directory_create(in_folder("a[1]*?"), error));
    for (int i = 0; i < 3; i++) assert_ok(rt_file_write(in_folder(names[i]), "x", 1, error));
    assert_int_equal(rt_directory_each(in_folder("a[1]*?"), ".svg", join_name, found), 2);
    assert_string_equal(found, "/a.svg /b.svg ");
    assert_int_equal(rt_directory_each(in_folder("nowhere"), "", join_name, found), 0);
}

/* Every other one of any size, the others near 1. */
static double number_of_any_size(RtRandom *random, int i, int sizes) {
    const int exponent = i % 2 ? 0 : (int)rt_random_below(random, 2 * (uint32_t)sizes) - sizes;
    return ldexp(rt_random_betweend(random, 0.5, 2), exponent);
}

RT_TEST(logarithms_are_within_a_unit_in_the_last_place_and_cube_roots_within_their_bound) {
    RtRandom random = rt_random(1, 0);
    for (int i = 0; i < 200000; i++) {
        double x = number_of_any_size(&random, i, 1000), computed = rt_log(x);
        double unit = nextafter(fabs(computed), INFINITY) - fabs(computed);
        assert_true(fabsl((long double)computed - logl((long double)x)) <= (long double)unit);
        long double root = cbrtl((long double)x);
        assert_true(fabsl((long double)rt_cube_root(x) - root) <= 4e-16L * root);
    }
    assert_true(rt_log(1) == 0 && rt_cube_root(1) == 1);
}

RT_TEST(sines_and_cosines_of_any_angle_are_within_their_bound) {
    for (int i = -72000; i <= 72000; i++) {
        double degrees = i * 0.0125; /* a double, so the angle is what it is */
        long double angle = (long double)degrees * 3.14159265358979323846264L / 180;
        RtTurn turn = rt_turn(degrees);
        assert_true(fabsl((long double)turn.sine - sinl(angle)) < 4e-16L);
        assert_true(fabsl((long double)turn.cosine - cosl(angle)) < 4e-16L);
        const int quarter = i / 7200 & 3; /* quarter turns are exact */
        static const double cosines[4] = {1, 0, -1, 0};
        if (i % 7200 == 0)
            assert_true(turn.cosine == cosines[quarter] && turn.sine == cosines[(quarter + 3) & 3]);
    }
    static const double far[] = {1e15, 0x1p60, 1e300, 0x1.fffffffffffffp1023};
    for (size_t i = 0; i < sizeof far / sizeof far[0]; i++) {
        const RtTurn turn = rt_turn(far[i]), near = rt_turn(fmod(far[i], 360));
        assert_true(turn.sine == near.sine && turn.cosine == near.cosine);
    }
}

RT_TEST(angles_of_points_are_within_their_bound_and_exact_on_the_axes) {
    for (int i = -36000; i <= 36000; i++) {
        const RtTurn turn = rt_turn(i * 0.005);
        const double length = ldexp(1 + (i & 7), i % 500), y = length * turn.sine, x = length * turn.cosine;
        const long double exact = atan2l((long double)y, (long double)x) * 180 / 3.14159265358979323846264L;
        assert_true(fabsl((long double)rt_angle(y, x) - exact) < 1e-13L || (y == 0 && x < 0));
    }
    assert_true(rt_angle(0, 3) == 0 && rt_angle(2, 0) == 90 && rt_angle(0, -1) == 180 &&
                rt_angle(-1e-300, 0) == -90);
    assert_true(rt_angle(0, 0) == 0);
}

/* Half the height of a view is the tangent of half its angle. */
RT_TEST(tangents_of_views_are_rounded_rightly_to_float32) {
    for (int i = 1; i < 180000; i++) {
        float degrees = (float)(i / 1000.0);
        RtTurn half = rt_turn((double)degrees / 2);
        long double tangent = tanl((long double)degrees * 3.14159265358979323846264L / 360);
        assert_true((float)(half.sine / half.cosine) == (float)tangent);
    }
}

RT_TEST(powers_are_within_their_bound) {
    RtRandom random = rt_random(3, 0);
    for (int i = 0; i < 200000; i++) {
        double x = number_of_any_size(&random, i, 100);
        double y = i % 4 < 2 ? rt_random_betweend(&random, -5, 5) : rt_random_betweend(&random, 0, 1000);
        long double exact = powl((long double)x, (long double)y), logarithm = logl(exact);
        if (logarithm < -708)
            assert_true(rt_power(x, y) == 0);
        else if (logarithm > 709)
            assert_true(rt_power(x, y) == HUGE_VAL);
        else
            assert_true(fabsl((long double)rt_power(x, y) - exact) <=
                        4e-16L * (1 + fabsl(logarithm)) * exact);
    }
    /* exact */
    assert_true(rt_power(1, 1e6) == 1 && rt_power(1, -0.3) == 1);
    assert_true(rt_power(1e-300, 0) == 1 && rt_power(0x1p-1074, 0) == 1);
    assert_true(rt_power(0x1p-1074, 1e6) == 0 && rt_power(1e300, 1e300) == HUGE_VAL);
}

RT_TEST(a_process_sees_the_end_of_its_input_while_others_run) {
    char *const arguments[] = {(char *)"cat", NULL};
    RtProcess processes[2];
    RtProcessEnd end;
    FILE *to[2], *from[2];
    for (int i = 0; i < 2; i++) {
        const RtProcessCommand command = {.arguments = arguments, .to = &to[i], .from = &from[i]};
        assert_ok(rt_process_spawn(&processes[i], &command, error));
    }
    for (int i = 0; i < 2; i++) {
        fclose(to[i]);
        fclose(from[i]);
        bool ended = rt_process_wait(&processes[i], 60000, &end);
        if (!ended) rt_process_end(&processes[i], 0);
        assert_true(ended);
    }
}

/* In a fork, which that ends; the program would hold the pipe open. */
RT_TEST(a_signal_ends_the_programs_that_were_started_and_nobody_takes_it_for_a_crash) {
    char *const arguments[] = {(char *)"sleep", (char *)"60", NULL};
    int ends[2], how;
    char byte;
    assert_int_equal(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) {
        RtProcess process, ended;
        RtProcessEnd end;
        const RtProcessCommand command = {.arguments = arguments};
        if (rt_process_spawn(&process, &command, NULL) != RT_OK) _exit(1);
        if (rt_process_spawn(&ended, &command, NULL) != RT_OK) _exit(1);
        rt_process_end(&ended, 0);
        rt_processes_kill();
        alarm(1);
        rt_process_wait(&process, -1, &end);
        _exit(0);
    }
    close(ends[1]);
    assert_int_equal(read(ends[0], &byte, 1), 0);
    close(ends[0]);
    assert_int_equal(waitpid(child, &how, 0), child);
    assert_true(WIFSIGNALED(how) && WTERMSIG(how) == SIGALRM);
}

RT_TESTS(base, NULL, NULL)
