/* SPDX-License-Identifier: Apache-2.0 */
/* base/parallel: also run under ThreadSanitizer. */
#include "testing.h"

#include "core/base/parallel.h"

enum { ITEMS = 1000 };

typedef struct Count {
    uint32_t visits[ITEMS];
    int threads;
    size_t fails_from; /* items from here on fail */
} Count;

static RtStatus visit(void *context, size_t item, int thread, RtError *error) {
    Count *count = context;
    count->visits[item]++;
    if (thread < 0 || thread >= count->threads) return rt_fail(error, RT_MISMATCH, "thread %d", thread);
    if (item >= count->fails_from) return rt_fail(error, RT_BAD_INPUT, "item %zu", item);
    return RT_OK;
}

RT_TEST(every_item_is_worked_on_once_by_any_number_of_threads) {
    const int threads[] = {1, 2, 7, 64};
    for (size_t i = 0; i < sizeof threads / sizeof threads[0]; i++) {
        Count count = {.threads = threads[i], .fails_from = ITEMS};
        assert_ok(rt_parallel_for(ITEMS, threads[i], visit, &count, error));
        for (size_t k = 0; k < ITEMS; k++) assert_int_equal(count.visits[k], 1);
        count.fails_from = 0;
        assert_ok(rt_parallel_for(0, threads[i], visit, &count, error));
    }
}

/* Observed through memory: a thread allocates before it starts. */
RT_TEST(more_threads_than_items_are_not_started) {
    Count count = {.threads = 1, .fails_from = ITEMS};
    RtError one, many;
    for (size_t items = 0; items <= 1; items++) {
        rt_alloc_fail_at(1);
        assert_int_equal(rt_parallel_for(items, 1, visit, &count, &one), RT_NO_MEMORY);
        rt_alloc_fail_at(1);
        assert_int_equal(rt_parallel_for(items, 64, visit, &count, &many), RT_NO_MEMORY);
        assert_string_equal(many.message, one.message);
    }
    assert_ok(rt_parallel_for(1, 64, visit, &count, error));
}

RT_TEST(zero_threads_stand_for_all_processors) {
    assert_int_equal(rt_thread_count(0), rt_processor_count());
    assert_true(rt_processor_count() >= 1);
    assert_int_equal(rt_thread_count(3), 3);
}

/* Items are handed out in ascending order, so the first that fails is always among those begun. */
RT_TEST(the_lowest_item_that_fails_is_the_one_reported) {
    for (int threads = 1; threads <= 8; threads *= 2) {
        Count count = {.threads = threads, .fails_from = 100};
        RtError error;
        assert_int_equal(rt_parallel_for(ITEMS, threads, visit, &count, &error), RT_BAD_INPUT);
        assert_string_equal(error.message, "item 100");
        assert_int_equal(count.visits[ITEMS - 1], 0);
    }
}

/* ---- tasks that create tasks ---- */

/* A range is halved until it is one item. */
typedef struct Range {
    uint32_t first, count;
} Range;

static RtStatus halve(void *context, RtTasks *tasks, const void *task, RtError *error) {
    Count *count = context;
    Range range = *(const Range *)task;
    while (range.count > 1) {
        Range half = {range.first + range.count / 2, range.count - range.count / 2};
        if (!rt_tasks_add(tasks, &half)) return rt_fail_memory(error, "half a range", sizeof half);
        range.count /= 2;
    }
    if (range.first >= count->fails_from) return rt_fail(error, RT_BAD_INPUT, "item %u", range.first);
    count->visits[range.first]++;
    return RT_OK;
}

static RtStatus halve_all(Count *count, int threads, RtError *error) {
    const Range ranges[2] = {{0, ITEMS / 3}, {ITEMS / 3, ITEMS - ITEMS / 3}};
    return rt_parallel_tasks(ranges, 2, sizeof(Range), threads, halve, count, error);
}

RT_TEST(tasks_and_what_they_make_are_worked_on_once_by_any_number_of_threads) {
    const int threads[] = {0, 1, 2, 7, 64};
    for (size_t i = 0; i < sizeof threads / sizeof threads[0]; i++) {
        Count count = {.fails_from = ITEMS};
        assert_ok(halve_all(&count, threads[i], error));
        for (size_t k = 0; k < ITEMS; k++) assert_int_equal(count.visits[k], 1);
        count.fails_from = 0;
        assert_ok(rt_parallel_tasks(NULL, 0, sizeof(Range), threads[i], halve, &count, error));
    }
}

RT_TEST(a_task_that_fails_stops_the_others_and_is_reported) {
    for (int threads = 1; threads <= 8; threads *= 2) {
        Count count = {.fails_from = ITEMS / 2};
        RtError error;
        assert_int_equal(halve_all(&count, threads, &error), RT_BAD_INPUT);
        assert_memory_equal(error.message, "item ", 5);
        for (size_t k = ITEMS / 2; k < ITEMS; k++) assert_int_equal(count.visits[k], 0);
    }
}

/* With one thread the order is defined: the oldest first. */
static RtStatus list_order(void *context, RtTasks *tasks, const void *task, RtError *error) {
    Count *count = context;
    uint32_t item = *(const uint32_t *)task, more = 2 * item + 2;
    (void)error;
    count->visits[count->threads++] = item;
    for (uint32_t next = more - 1; next <= more && more < 100; next++)
        assert_true(rt_tasks_add(tasks, &next));
    return RT_OK;
}

RT_TEST(the_oldest_task_comes_first) {
    Count count = {.threads = 0};
    uint32_t root = 0;
    assert_ok(rt_parallel_tasks(&root, 1, sizeof root, 1, list_order, &count, error));
    assert_int_equal(count.threads, 99);
    for (uint32_t i = 0; i < 99; i++) assert_int_equal(count.visits[i], i);
}

RT_TEST(memory_that_cannot_be_had_is_a_status) {
    Count count = {.threads = 2, .fails_from = ITEMS};
    assert_fails_cleanly(rt_parallel_for(ITEMS, 2, visit, &count, error), (void)0);
    assert_fails_cleanly(halve_all(&count, 2, error), (void)0);
}

RT_TESTS(parallel, NULL, NULL)
