/* SPDX-License-Identifier: Apache-2.0 */
/* bench/workload_hardware.c and hardware_table.h: what the machine did for the rays of cells, here by events
 * of the kernel's own in place of the processor's. */
#include "testing.h"

#include "base/memory.h"
#include "bench/hardware_table.h"
#include "bench/workload.h"

#include <linux/perf_event.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define SOFTWARE(name)                                                                                       \
    { PERF_TYPE_SOFTWARE, PERF_COUNT_SW_##name }
#define NONE                                                                                                 \
    { UINT32_C(0xfffffff0), 0 }

/* Nanoseconds stand for instructions, by two clocks. */
static const RtHardwareEvent clocks[RT_HARDWARE_COUNT] = {SOFTWARE(TASK_CLOCK), SOFTWARE(TASK_CLOCK), NONE,
                                                          NONE};
static const RtHardwareEvent none[RT_HARDWARE_COUNT] = {NONE, NONE, NONE, NONE};

/* A cloud on which brute takes each third ray. */
static void measure(RtExperiment *e, RtResults *results, const RtHardwareEvent *events, int threads,
                    bool count_only) {
    const RtWorkload scene = {.depth = 2, .width = 64, .height = 64};
    const RtWorkloadOptions options = {
        .threads = 1, .timing = threads, .count_only = count_only, .events = events};
    char where[RT_MAX_LABEL];
    rt_experiment_init(e);
    strcpy(e->name, "machine");
    e->hardware = true;
    e->rounds = 6;
    e->milliseconds = 5;
    e->kind_count = 2; /* primary, shadow */
    e->candidate_count = 2;
    e->candidates[0] = (RtCandidate){.spec = "bvh", .label = "bvh", .ray_stride = 1};
    e->candidates[1] = (RtCandidate){.spec = "brute", .label = "brute", .ray_stride = 3};
    assert_ok(rt_experiment_add_scenes(e, &scene, "random:n=1000", "", error));
    assert_ok(rt_experiment_check(e, where, error));
    assert_ok(rt_results_init(results, e, error));
    assert_ok(rt_workload_run(results, 0, &options, error));
}

static char *text_of(const RtResults *results, bool csv) {
    RtHardwareRow row = {.results = results};
    RtTable table = rt_hardware_table(&row);
    char *text;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    if (csv) {
        rt_table_csv(&table, out);
    } else {
        rt_print_hardware(results, out);
    }
    fclose(out);
    return text;
}

/* The clock of the kernel's event and that of the timing tell of the same work, in other rounds. */
RT_TEST(counts_are_per_ray_of_the_work_that_is_timed) {
    RtExperiment *e = rt_alloc(1, sizeof(RtExperiment));
    RtHardware hardware;
    RtResults results;
    if (rt_hardware_open(&hardware, clocks, NULL) != RT_OK) skip();
    rt_hardware_close(&hardware);
    for (int threads = 1; threads <= 2; threads++) {
        measure(e, &results, clocks, threads, false);
        for (uint32_t c = 0; c < 2; c++) {
            const RtCell *cell = rt_cell_at(&results, 0, c, RT_RAY_PRIMARY);
            const RtCellHardware *hardware_of = &cell->hardware;
            double nanoseconds = hardware_of->counts.of[RT_HARDWARE_instructions];
            assert_true(hardware_of->known && !*hardware_of->why && hardware_of->threads == threads);
            assert_true(isnan(hardware_of->counts.of[RT_HARDWARE_cache_misses]));
            /* Of threads together, so not less than the time of the clock; twice, for a machine that is busy.
             */
            double timed = 1e9 * cell->seconds.least;
            assert_true(0.5 * timed < nanoseconds && nanoseconds < 6 * timed);
        }
        char *text = text_of(&results, true), *eye = text_of(&results, false);
        assert_non_null(strstr(text, ",brute,"));
        assert_non_null(strstr(eye, "instr./ray"));
        free(text);
        free(eye);
        rt_results_clear(&results);
    }
    rt_free(e);
}

RT_TEST(where_nothing_can_be_counted_cells_are_known_to_have_none_and_the_reason_is_shown) {
    RtExperiment *e = rt_alloc(1, sizeof(RtExperiment));
    RtResults results;
    measure(e, &results, none, 1, false);
    const RtCell *cell = rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY);
    assert_true(cell->timed && cell->hardware.known && *cell->hardware.why);
    RtWorkloadOptions options = {.threads = 1, .timing = 1, .events = none};
    assert_true(rt_workload_is_done(&results, 0, &options));
    char *text = text_of(&results, true), *eye = text_of(&results, false);
    assert_non_null(strstr(eye, "Hardware counters: not available: "));
    assert_non_null(strstr(text, ",,,,,")); /* nothing that could be taken for a figure */
    assert_non_null(strstr(text, cell->hardware.why));
    free(text);
    free(eye);
    rt_results_clear(&results);
    rt_free(e);
}

RT_TEST(where_nothing_is_timed_nothing_is_counted_by_the_machine) {
    RtExperiment *e = rt_alloc(1, sizeof(RtExperiment));
    RtResults results;
    measure(e, &results, clocks, 1, true);
    assert_false(rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY)->hardware.known);
    rt_results_clear(&results);
    rt_free(e);
}

RT_TESTS(machine_counts, NULL, NULL)
