/* SPDX-License-Identifier: Apache-2.0 */
/* measure/hardware.h, by events of the kernel's own, which there are on machines without counters, too:
 * what is opened, counted, scaled and closed is the same code. */
#include "testing.h"

#include "core/base/clock.h"
#include "core/base/parallel.h"
#include "measure/hardware.h"

#include <fcntl.h>
#include <linux/perf_event.h>
#include <math.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define SOFTWARE(name)                                                                                       \
    { PERF_TYPE_SOFTWARE, PERF_COUNT_SW_##name }
#define NONE                                                                                                 \
    { UINT32_C(0xfffffff0), 0 } /* no type of the kernel's */

enum { CLOCK, FAULTS, MISSING }; /* nanoseconds of all threads, page faults, and one that cannot be had */
static const RtHardwareEvent events[RT_HARDWARE_COUNT] = {SOFTWARE(TASK_CLOCK), SOFTWARE(PAGE_FAULTS), NONE,
                                                          NONE};

/* False, and the test is to be skipped, where a kernel forbids even these. */
static bool open_events(RtHardware *hardware) {
    return rt_hardware_open(hardware, events, NULL) == RT_OK;
}

static void spin(double seconds) {
    double start = rt_thread_seconds();
    while (rt_thread_seconds() - start < seconds) continue;
}

static void touch_pages(size_t count) {
    size_t page = (size_t)sysconf(_SC_PAGESIZE);
    volatile char *pages =
        mmap(NULL, count * page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    assert_true((void *)pages != MAP_FAILED);
    madvise((void *)pages, count * page, MADV_NOHUGEPAGE);
    for (size_t i = 0; i < count; i++) pages[i * page] = 1;
    munmap((void *)pages, count * page);
}

RT_TEST(what_is_done_between_start_and_stop_is_counted_and_nothing_else) {
    RtHardware hardware;
    if (!open_events(&hardware)) RT_SKIP("a kernel that allows perf_event_open");
    touch_pages(5000);
    RtHardwareStart start = rt_hardware_start(&hardware);
    touch_pages(100);
    RtHardwareCounts first = rt_hardware_stop(&hardware, &start);
    touch_pages(5000);
    start = rt_hardware_start(&hardware);
    touch_pages(300);
    RtHardwareCounts second = rt_hardware_stop(&hardware, &start);
    rt_hardware_close(&hardware);
    assert_true(100 <= first.of[FAULTS] && first.of[FAULTS] < 4000); /* sanitizers touch pages of their own */
    assert_true(300 <= second.of[FAULTS] && second.of[FAULTS] < 4000);
    assert_true(first.running == 1 && second.running == 1);
}

static RtStatus spin_and_touch(void *context, size_t item, int thread, RtError *error) {
    (void)context, (void)item, (void)thread, (void)error;
    touch_pages(100);
    spin(0.02);
    return RT_OK;
}

/* Threads end within: what they counted must not be lost, nor be counted again with the next. */
RT_TEST(threads_that_are_started_meanwhile_are_counted_each_time_once) {
    OWNED(rt_hardware_close) RtHardware hardware;
    if (!open_events(&hardware)) RT_SKIP("a kernel that allows perf_event_open");
    double first = 0;
    for (int threads = 1; threads <= 4; threads++) {
        RtHardwareStart start = rt_hardware_start(&hardware);
        assert_ok(rt_parallel_for(8, threads, spin_and_touch, NULL, error));
        RtHardwareCounts counts = rt_hardware_stop(&hardware, &start);
        if (threads == 1) first = counts.of[FAULTS];
        assert_true(800 <= counts.of[FAULTS] && counts.of[FAULTS] < 1.5 * first + 200);
        assert_true(0.15e9 < counts.of[CLOCK] && counts.of[CLOCK] < 0.5e9);
    }
}

RT_TEST(an_event_that_cannot_be_had_is_not_known_and_the_others_are) {
    RtHardware hardware;
    if (!open_events(&hardware)) RT_SKIP("a kernel that allows perf_event_open");
    RtHardwareStart start = rt_hardware_start(&hardware);
    spin(0.001);
    RtHardwareCounts counts = rt_hardware_stop(&hardware, &start);
    rt_hardware_close(&hardware);
    assert_true(isnan(counts.of[MISSING]) && !isnan(counts.of[CLOCK]));
}

RT_TEST(where_no_event_can_be_had_there_is_a_reason_and_nothing_is_left_open) {
    static const RtHardwareEvent none[RT_HARDWARE_COUNT] = {NONE, NONE, NONE, NONE};
    RtHardware hardware;
    RtError error;
    int before = open("/dev/null", O_RDONLY | O_CLOEXEC);
    close(before);
    assert_int_equal(rt_hardware_open(&hardware, none, &error), RT_NOT_AVAILABLE);
    assert_true(strlen(error.message) > 10);
    rt_hardware_close(&hardware);
    if (open_events(&hardware)) rt_hardware_close(&hardware);
    int after = open("/dev/null", O_RDONLY | O_CLOEXEC);
    close(after);
    assert_int_equal(before, after);
}

RT_TEST(what_was_counted_in_a_part_of_the_time_is_scaled_to_all_of_it) {
    assert_true(rt_hardware_scale(1000, 500, 500) == 1000);
    assert_true(rt_hardware_scale(1000, 500, 125) == 4000);
    assert_true(isnan(rt_hardware_scale(0, 500, 0)));
}

/* Either they count something, or there is a reason. */
RT_TEST(counters_of_the_processor_count_or_say_why_not) {
    OWNED(rt_hardware_close) RtHardware hardware;
    RtError error = {RT_OK, ""};
    RtStatus status = rt_hardware_open(&hardware, rt_hardware_events, &error);
    if (status == RT_OK) {
        RtHardwareStart start = rt_hardware_start(&hardware);
        spin(0.001);
        RtHardwareCounts counts = rt_hardware_stop(&hardware, &start);
        double instructions = counts.of[RT_HARDWARE_instructions];
        assert_true(isnan(instructions) || instructions > 1000);
    } else {
        assert_int_equal(status, RT_NOT_AVAILABLE);
        assert_true(*error.message);
    }
}

RT_TESTS(hardware, NULL, NULL)
