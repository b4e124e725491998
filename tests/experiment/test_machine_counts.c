/* SPDX-License-Identifier: Apache-2.0 */
/* run/workload_hardware.c: what the machine did for the rays of cells. Where a
 * test asks for it the linker's wrappers count rays in the place of the processor's events, so that what is
 * expected depends on no machine, its load or its kernel. */
#include "testing.h"

#include "accel/plugin.h"
#include "core/base/memory.h"
#include "results/result_tables.h"
#include "run/workload.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

#define NONE                                                                                                 \
    { UINT32_C(0xfffffff0), 0 }

static const RtHardwareEvent none[RT_HARDWARE_COUNT] = {NONE, NONE, NONE, NONE};

/* ---- rays for instructions; nothing for the other events ---- */

static bool counting_rays;
static atomic_uint_fast64_t rays_asked;

RtStatus __real_rt_hardware_open(RtHardware *hardware, const RtHardwareEvent events[RT_HARDWARE_COUNT],
                                 RtError *error);
RtStatus __wrap_rt_hardware_open(RtHardware *hardware, const RtHardwareEvent events[RT_HARDWARE_COUNT],
                                 RtError *error);
RtHardwareStart __wrap_rt_hardware_start(const RtHardware *hardware);
RtHardwareCounts __wrap_rt_hardware_stop(const RtHardware *hardware, const RtHardwareStart *start);
void __real_rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies);
void __wrap_rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies);
void __real_rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies);
void __wrap_rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies);

RtStatus __wrap_rt_hardware_open(RtHardware *hardware, const RtHardwareEvent events[RT_HARDWARE_COUNT],
                                 RtError *error) {
    if (!counting_rays) return __real_rt_hardware_open(hardware, events, error);
    for (int i = 0; i < RT_HARDWARE_COUNT; i++) hardware->files[i] = -1;
    return RT_OK;
}

RtHardwareStart __wrap_rt_hardware_start(const RtHardware *hardware) {
    (void)hardware;
    return (RtHardwareStart){.read = {[RT_HARDWARE_instructions] = {atomic_load(&rays_asked)}}};
}

RtHardwareCounts __wrap_rt_hardware_stop(const RtHardware *hardware, const RtHardwareStart *start) {
    (void)hardware;
    RtHardwareCounts counts = {.running = 1};
    for (int i = 0; i < RT_HARDWARE_COUNT; i++) counts.of[i] = (double)NAN;
    counts.of[RT_HARDWARE_instructions] =
        (double)(atomic_load(&rays_asked) - start->read[RT_HARDWARE_instructions][0]);
    return counts;
}

void __wrap_rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies) {
    atomic_fetch_add(&rays_asked, count);
    __real_rt_nearest(query, rays, count, hits, tallies);
}

void __wrap_rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies) {
    atomic_fetch_add(&rays_asked, count);
    __real_rt_occluded(query, rays, count, blocked, tallies);
}

/* ---- cells ---- */

/* A cloud on which brute takes each third ray. The plugin counts in its own process. */
static void measure(RtExperiment *e, RtResults *results, const RtHardwareEvent *events, int threads,
                    bool count_only) {
    const RtWorkload scene = {.depth = 2, .width = 64, .height = 64};
    const RtWorkloadOptions options = {
        .threads = 1, .timing = threads, .count_only = count_only, .events = events};
    char where[RT_MAX_LABEL];
    assert_ok(rt_plugin_load(RT_BINARY_DIR "/plugins/bvh_copy.so", error));
    rt_experiment_init(e);
    strcpy(e->name, "machine");
    e->hardware = true;
    e->rounds = 6;
    e->milliseconds = 5;
    e->kind_count = 2; /* primary, shadow */
    e->candidate_count = 3;
    e->candidates[0] = (RtCandidate){.spec = "bvh", .label = "bvh", .ray_stride = 1};
    e->candidates[1] = (RtCandidate){.spec = "brute", .label = "brute", .ray_stride = 3};
    e->candidates[2] = (RtCandidate){.spec = "bvh_copy", .label = "plugin", .ray_stride = 1};
    assert_ok(rt_experiment_add_scenes(e, &scene, "random:n=1000", "", error));
    assert_ok(rt_experiment_check(e, where, error));
    assert_ok(rt_results_init(results, e, error));
    assert_ok(rt_workloads_run(results, &options, error));
}

static char *text_of(const RtResults *results, bool csv) {
    RtResultRow row = {.results = results};
    RtTable table = rt_result_table(RT_HARDWARE, &row);
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

RT_TEST(counts_are_per_ray_of_the_work_that_is_timed) {
    OWNED_MEMORY RtExperiment *e = rt_alloc(1, sizeof(RtExperiment));
    RtResults results;
    for (int threads = 1; threads <= 2; threads++) {
        counting_rays = true;
        measure(e, &results, NULL, threads, false);
        counting_rays = false;
        for (uint32_t i = 0; i < 6; i++) {
            const RtCell *cell = rt_cell_at(&results, 0, i / 2, i % 2 ? RT_RAY_SHADOW : RT_RAY_PRIMARY);
            const RtCellHardware *hardware = &cell->hardware;
            assert_true(hardware->known && !*hardware->why && hardware->threads == threads);
            assert_true(hardware->counts.of[RT_HARDWARE_instructions] == 1);
            assert_true(isnan(hardware->counts.of[RT_HARDWARE_cache_misses]));
        }
        char *text = text_of(&results, true), *eye = text_of(&results, false);
        assert_non_null(strstr(text, ",brute,"));
        assert_non_null(strstr(eye, "instr./ray"));
        free(text);
        free(eye);
        rt_results_clear(&results);
    }
}

RT_TEST(where_nothing_can_be_counted_cells_are_known_to_have_none_and_the_reason_is_shown) {
    OWNED_MEMORY RtExperiment *e = rt_alloc(1, sizeof(RtExperiment));
    OWNED_RESULTS results;
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
}

RT_TEST(where_nothing_is_timed_nothing_is_counted_by_the_machine) {
    OWNED_MEMORY RtExperiment *e = rt_alloc(1, sizeof(RtExperiment));
    OWNED_RESULTS results;
    measure(e, &results, none, 1, true);
    assert_false(rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY)->hardware.known);
}

RT_TESTS(machine_counts, NULL, NULL)
