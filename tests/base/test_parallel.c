/* SPDX-License-Identifier: Apache-2.0 */
/* base/parallel: also run under ThreadSanitizer. */
#include "testing.h"

#include "base/memory.h"
#include "base/parallel.h"

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
    }
}

RT_TEST(no_items_are_no_work) {
    Count count = {.threads = 2, .fails_from = 0};
    assert_ok(rt_parallel_for(0, 2, visit, &count, error));
}

/* Seen by what is asked for: a thread takes memory before it starts. */
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

RT_TEST(memory_that_cannot_be_had_is_a_status) {
    Count count = {.threads = 2, .fails_from = ITEMS};
    int64_t live = rt_alloc_live();
    for (uint64_t n = 1; n <= 2; n++) {
        RtError error;
        rt_alloc_fail_at(n);
        assert_int_equal(rt_parallel_for(ITEMS, 2, visit, &count, &error), RT_NO_MEMORY);
    }
    rt_alloc_fail_at(0);
    assert_int_equal(rt_alloc_live(), live);
}

RT_TESTS(parallel, NULL, NULL)
