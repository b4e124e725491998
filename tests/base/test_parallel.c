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

static void every_item_is_worked_on_once_by_any_number_of_threads(void **state) {
    (void)state;
    const int threads[] = {1, 2, 7, 64};
    for (size_t i = 0; i < sizeof threads / sizeof threads[0]; i++) {
        Count count = {.threads = threads[i], .fails_from = ITEMS};
        assert_ok(rt_parallel_for(ITEMS, threads[i], visit, &count, error));
        for (size_t k = 0; k < ITEMS; k++) assert_int_equal(count.visits[k], 1);
    }
}

static void no_items_are_no_work(void **state) {
    (void)state;
    Count count = {.threads = 2, .fails_from = 0};
    assert_ok(rt_parallel_for(0, 2, visit, &count, error));
}

/* Seen by what is asked for: a thread takes memory before it starts. */
static void more_threads_than_items_are_not_started(void **state) {
    (void)state;
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

static void zero_threads_stand_for_all_processors(void **state) {
    (void)state;
    assert_int_equal(rt_thread_count(0), rt_processor_count());
    assert_true(rt_processor_count() >= 1);
    assert_int_equal(rt_thread_count(3), 3);
}

/* Items are handed out in ascending order, so the first that fails is always among those begun. */
static void the_lowest_item_that_fails_is_the_one_reported(void **state) {
    (void)state;
    for (int threads = 1; threads <= 8; threads *= 2) {
        Count count = {.threads = threads, .fails_from = 100};
        RtError error;
        assert_int_equal(rt_parallel_for(ITEMS, threads, visit, &count, &error), RT_BAD_INPUT);
        assert_string_equal(error.message, "item 100");
        assert_int_equal(count.visits[ITEMS - 1], 0);
    }
}

static void memory_that_cannot_be_had_is_a_status(void **state) {
    (void)state;
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

RT_TEST_GROUP(parallel) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_item_is_worked_on_once_by_any_number_of_threads),
        cmocka_unit_test(no_items_are_no_work),
        cmocka_unit_test(more_threads_than_items_are_not_started),
        cmocka_unit_test(zero_threads_stand_for_all_processors),
        cmocka_unit_test(the_lowest_item_that_fails_is_the_one_reported),
        cmocka_unit_test(memory_that_cannot_be_had_is_a_status),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
