/* SPDX-License-Identifier: Apache-2.0 */
/* measure/measure.h and workload.h: counts are sums over threads and are compared with right answers; thinned
 * candidates are timed against the baseline on their own rays. */
#include "experiment_testing.h"

#include "core/base/clock.h"
#include "measure/measure.h"
#include "results/result_tables.h"
#include "run/workload.h"
#include "scenes/open.h"

/* A scene, accelerators over it, and the rays that the first of them recorded. */
typedef struct Stage {
    RtScene scene;
    RtAccel *accels[2];
    RtRaySet sets[RT_RAY_KIND_COUNT];
} Stage;

static void open_stage(Stage *stage, const char *scene, uint32_t size, uint64_t random, const char *spec,
                       const char *other) {
    RtRecording recording = {.depth = 1, .seed = 1, .random = random, .threads = 1};
    *stage = (Stage){.accels = {NULL, NULL}};
    assert_ok(rt_scene_open(scene, &stage->scene, error));
    assert_ok(rt_scene_sample(&stage->scene, size, size, 1, false, error));
    assert_ok(rt_accel_open(spec, &stage->scene, &stage->accels[0], error));
    if (other) assert_ok(rt_accel_open(other, &stage->scene, &stage->accels[1], error));
    assert_ok(rt_rayset_record(stage->sets, stage->accels[0], &recording, error));
}

static void close_stage(Stage *stage) {
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&stage->sets[k]);
    for (int i = 0; i < 2; i++) rt_accel_destroy(stage->accels[i]);
    rt_scene_clear(&stage->scene);
}

static RtKernel *count_below;
static uint64_t enormous_steps;

static void count_enormously(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                             RtHit *hits, uint32_t *occluders, RtTally *tallies) {
    count_below(accel, scratch, rays, count, hits, occluders, tallies);
    tallies[rays->kind].steps = enormous_steps;
}

RT_TEST(counts_of_2_63_or_more_are_refused_and_never_wrap_around) {
    OWNED(close_stage) Stage stage;
    RtCount count;
    open_stage(&stage, "balls:size=1", 8, 100, "brute", NULL);
    const RtRaySet *set = &stage.sets[RT_RAY_RANDOM];
    OWNED_MEMORY RtHit *expected = rt_alloc(set->count, sizeof(RtHit));
    assert_ok(rt_measure_answers(stage.accels[0], set, 1, expected, error));
    RtKernels enormous = *stage.accels[0]->kernels;
    count_below = enormous.nearest_counted;
    enormous.nearest_counted = count_enormously;
    stage.accels[0]->kernels = &enormous;
    enormous_steps = INT64_MAX - 1;
    assert_ok(rt_measure_count(stage.accels[0], set, expected, 1, &count, error));
    assert_true(count.tally.steps == INT64_MAX - 1);
    enormous_steps = UINT64_MAX - 1;
    assert_bad_input(rt_measure_count(stage.accels[0], set, expected, 1, &count, error),
                     "brute: it counts 2^63 steps or more");
}

/* The spheres of balls:size=1 are 10, and one polygon; brute tests each for every ray. */
RT_TEST(a_count_is_the_sum_over_threads_and_finds_wrong_answers) {
    OWNED(close_stage) Stage stage;
    open_stage(&stage, "balls:size=1", 8, 10000, "brute", NULL);
    const RtRaySet *set = &stage.sets[RT_RAY_RANDOM];
    OWNED_MEMORY RtHit *expected = rt_alloc(set->count, sizeof(RtHit));
    RtCount count;
    assert_ok(rt_measure_answers(stage.accels[0], set, 2, expected, error));
    for (int threads = 1; threads <= 3; threads++) {
        assert_ok(rt_measure_count(stage.accels[0], set, expected, threads, &count, error));
        assert_int_equal(count.tally.rays, 10000);
        assert_int_equal(count.tally.object_tests, 10000u * stage.scene.geometry.object_count);
        assert_int_equal(count.differ, 0);
    }
    expected[42].object ^= 1;
    expected[4242].t += 1;
    assert_ok(rt_measure_count(stage.accels[0], set, expected, 2, &count, error));
    assert_int_equal(count.differ, expected[4242].object == RT_NO_OBJECT ? 1 : 2);
    assert_int_equal(count.first, 42);
}

/* For `occluded`, t does not matter, and a ray that hits is done before every object was tested. */
RT_TEST(shadow_and_occlusion_rays_are_traced_for_any_hit) {
    OWNED(close_stage) Stage stage;
    open_stage(&stage, "balls:size=1", 16, 100, "brute", NULL);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtRaySet *set = &stage.sets[k];
        RtCount count;
        uint64_t hits = 0, tests = set->count * stage.scene.geometry.object_count;
        OWNED_MEMORY RtHit *expected = rt_alloc(set->count, sizeof(RtHit));
        assert_ok(rt_measure_answers(stage.accels[0], set, 1, expected, error));
        for (uint64_t i = 0; i < set->count; i++) {
            hits += expected[i].object != RT_NO_OBJECT;
            expected[i].t = -1;
        }
        assert_ok(rt_measure_count(stage.accels[0], set, expected, 1, &count, error));
        bool any = k == RT_RAY_SHADOW || k == RT_RAY_OCCLUSION;
        assert_int_equal(count.tally.hits, hits);
        assert_int_equal(count.differ, any ? 0 : set->count);
        assert_true((count.tally.object_tests < tests) == (any && hits > 0));
    }
}

/* ---- workloads ---- */

/* An experiment with primary rays, of one or two specs. */
static RtExperiment *experiment_of(const char *one, const char *other) {
    RtExperiment *e = primary_experiment("measured");
    for (const char *spec = one; spec; spec = spec == one ? other : NULL) {
        RtCandidate *candidate = &e->candidates[e->candidate_count++];
        *candidate = (RtCandidate){.ray_stride = 1};
        strcpy(candidate->spec, spec);
        strcpy(candidate->label, spec);
    }
    return e;
}

/* The second is measured on every `stride`th ray, and has a label of its own. */
static RtExperiment *experiment_thinned(const char *spec, uint32_t stride) {
    RtExperiment *e = experiment_of(spec, "");
    strcpy(e->candidates[1].spec, spec);
    strcpy(e->candidates[1].label, "some");
    e->candidates[1].ray_stride = stride;
    return e;
}

static void add_scene(RtExperiment *e, const char *scene, uint32_t size) {
    const RtWorkload like = {.depth = 1, .width = size, .height = size};
    char where[RT_MAX_LABEL];
    assert_ok(rt_experiment_add_scenes(e, &like, scene, "", error));
    assert_ok(rt_experiment_check(e, where, error));
}

/* Times `spec` on every 64th primary ray of a cloud against itself on all, and returns the cell. In a frame
 * of 8 x 8 that is the ray of the upper left corner, which misses everything. */
static RtCell time_thinned(const char *spec) {
    const RtWorkloadOptions options = {.threads = 1, .timing = 1};
    OWNED_MEMORY RtExperiment *e = experiment_thinned(spec, 64);
    OWNED_RESULTS results;
    add_scene(e, "random:n=300", 8);
    assert_ok(rt_results_init(&results, e, error));
    assert_ok(rt_workloads_run(&results, &options, error));
    RtCell cell = *rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY);
    assert_true(fabs(rt_results_cost(&results, 0, 1, RT_ALL_RAYS).ratio.median / cell.ratio.median - 1) <
                1e-9);
    return cell;
}

/* The hierarchy needs 1 extent test for this ray and 10 for one of all: on all rays the ratio would be 4 and
 * more. ideal knows rays by their addresses; a ray that it does not know costs it 300 tests. */
RT_TEST(a_thinned_candidate_is_compared_with_the_baseline_on_its_own_rays_which_that_has_learnt) {
    const RtCell bvh = time_thinned("bvh"), ideal = time_thinned("ideal");
    assert_int_equal(bvh.tally.rays, 1);
    assert_int_equal(bvh.tally.extent_tests, 1);
    assert_true(0.5 < bvh.ratio.median && bvh.ratio.median < 2);
    assert_int_equal(ideal.tally.object_tests, ideal.tally.hits);
    assert_true(0.2 < ideal.ratio.median && ideal.ratio.median < 5);
}

/* ---- builds ---- */

/* What the builds of a workload take: the first of the grid, its others (`step` more each time), and all of
 * the hierarchy, the baseline, which is built for the null run too. `made` has a letter for each build. */
static struct {
    double first, then, step, baseline;
    char made[256];
    uint32_t count, grids;
} takes;

RtStatus __real_rt_accel_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                               RtError *error);
RtStatus __wrap_rt_accel_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                               RtError *error);

RtStatus __wrap_rt_accel_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                               RtError *error) {
    const bool grid = strcmp(spec->layers[0].ops->name, "grid") == 0;
    RT_TRY(__real_rt_accel_build(spec, scene, threads, out, error));
    if (takes.baseline == 0) return RT_OK;
    (*out)->build_seconds = !grid              ? takes.baseline
                            : takes.grids == 0 ? takes.first
                                               : takes.then + takes.step * (takes.grids - 1);
    takes.grids += grid;
    takes.made[takes.count++] = grid ? 'g' : 'b';
    return RT_OK;
}

/* Builds, of which the experiment asks for nine, and times a hierarchy and a grid. The grid's result; `known`
 * is the one that it has before. */
static RtBuildResult build_with(double first, double then, double step, double limit, bool count_only,
                                RtBuildResult known) {
    const RtWorkloadOptions options = {.threads = 1, .timing = 1, .count_only = count_only};
    OWNED_MEMORY RtExperiment *e = experiment_of("bvh", "grid");
    OWNED_RESULTS results;
    e->builds = 9;
    e->limit_seconds = limit;
    e->rounds = 1;
    add_scene(e, "random:n=20", 8);
    assert_ok(rt_results_init(&results, e, error));
    *rt_build_at(&results, 0, 1) = known;
    memset(&takes, 0, sizeof takes);
    takes.first = first;
    takes.then = then;
    takes.step = step;
    takes.baseline = 0.001;
    assert_ok(rt_workloads_run(&results, &options, error));
    takes.baseline = 0;
    return *rt_build_at(&results, 0, 1);
}

static const RtBuildResult unknown;

RT_TEST(a_build_time_is_the_median_of_builds_without_the_warm_up_with_its_interval) {
    const RtBuildResult grid = build_with(0.345, 0.01, 0.01, 0, false, unknown);
    assert_int_equal(grid.builds, 9);
    assert_true(fabs(grid.seconds.median - 0.05) < 1e-9 && fabs(grid.seconds.least - 0.01) < 1e-9);
    assert_true(fabs(grid.seconds.low - 0.02) < 1e-9 && fabs(grid.seconds.high - 0.08) < 1e-9);
}

/* Two hierarchies and a grid: the warm-up in order, then nine rounds, not all of the same order. */
RT_TEST(every_round_of_builds_has_each_structure_once_in_a_new_order) {
    bool differ = false;
    build_with(0.001, 0.001, 0, 0, false, unknown);
    assert_int_equal(takes.count, 30);
    assert_memory_equal(takes.made, "bgb", 3);
    for (int round = 1; round < 10; round++) {
        const char *made = takes.made + (size_t)3 * (size_t)round;
        assert_int_equal((made[0] == 'g') + (made[1] == 'g') + (made[2] == 'g'), 1);
        differ |= memcmp(made, takes.made + 3, 3) != 0;
    }
    assert_true(differ);
}

/* Nine builds may take 1.35 s together. */
RT_TEST(a_dear_structure_is_built_less_often_and_one_that_spends_the_budget_once) {
    const RtBuildResult some = build_with(0.5, 0.5, 0, 0, false, unknown);
    assert_int_equal(some.builds, 2);
    const RtBuildResult once = build_with(20, 1, 0, 0, false, unknown);
    assert_int_equal(once.builds, 1);
    assert_int_equal(takes.grids, 1);
    assert_true(once.seconds.median == 20 && once.seconds.low == 20 && once.seconds.high == 20);
}

RT_TEST(a_structure_whose_build_time_is_known_or_not_asked_for_is_built_once) {
    const RtBuildResult known = {.known = true, .builds = 7, .seconds = {3, 2, 4, 1}};
    const RtBuildResult kept = build_with(0.001, 0.001, 0, 0, false, known);
    assert_int_equal(takes.grids, 1);
    assert_true(kept.builds == 7 && kept.seconds.low == 2);
    build_with(0.001, 0.001, 0, 0, true, unknown);
    assert_int_equal(takes.count, 2);
}

RT_TEST(a_structure_is_left_out_if_its_median_build_exceeds_the_limit) {
    assert_string_equal(build_with(0.345, 0.01, 0, 0.3, false, unknown).left_out, "");
    assert_string_equal(build_with(0.01, 0.345, 0, 0.3, false, unknown).left_out,
                        "building takes 0.345 s, more than 0.3 s");
    const RtBuildResult known = {.known = true, .builds = 7, .seconds = {0.2, 0.2, 0.2, 0.2}};
    assert_string_equal(build_with(0.345, 0.345, 0, 0.3, false, known).left_out, ""); /* resumed */
}

/* ---- break-even ---- */

/* An estimate of a true value that is within `error` of it, as a part; the median errs by a third of that. */
static RtEstimate measured(double exact, double error) {
    return (RtEstimate){exact * (1 + error / 3), exact * (1 - error), exact * (1 + error), exact};
}

static char shown[1024]; /* the table of structures of the last break_even */

static void show_structures(const RtResults *results) {
    RtResultRow row = {.results = results};
    const RtTable table = rt_result_table(RT_STRUCTURES, &row);
    FILE *out = fmemopen(shown, sizeof shown, "w");
    assert_non_null(out);
    rt_table_csv(&table, out);
    fclose(out);
}

static uint32_t build_threads = 1; /* of ours; all else is of one thread */

/* Two structures with given times, to within `error`: seconds to build, nanoseconds per ray. */
static RtBreakEven break_even(double theirs, double their_ray, double ours, double our_ray, double error_of) {
    OWNED_MEMORY RtExperiment *e = experiment_of("theirs", "ours");
    OWNED_RESULTS results;
    e->workload_count = 1;
    assert_ok(rt_results_init(&results, e, error));
    results.workloads[0].rays[RT_RAY_PRIMARY] = 1000;
    *rt_build_at(&results, 0, 0) =
        (RtBuildResult){.known = true, .builds = 7, .threads = 1, .seconds = measured(theirs, error_of)};
    *rt_build_at(&results, 0, 1) = (RtBuildResult){
        .known = true, .builds = 6, .threads = build_threads, .seconds = measured(ours, error_of)};
    *rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY) = (RtCell){.timed = true,
                                                           .counted = true,
                                                           .threads = 1,
                                                           .baseline = 0,
                                                           .wall = measured(1e-9 * our_ray, error_of),
                                                           .ratio = measured(their_ray / our_ray, error_of)};
    const RtBreakEven even = rt_results_break_even(&results, 0, 1);
    assert_true(isnan(rt_results_break_even(&results, 0, 0).rays.median));
    show_structures(&results);
    if (!isnan(even.rays.median)) assert_int_equal(even.builds, 6);
    return even;
}

static bool is_at(RtBreakEven even, double rays) {
    return even.rays.median == rays || fabs(even.rays.median / rays - 1) < 1e-9;
}

RT_TEST(a_build_pays_off_after_as_many_rays_as_save_what_it_takes_more) {
    const RtBreakEven from = break_even(1, 300, 3, 200, 0), up_to = break_even(3, 200, 1, 300, 0);
    const RtBreakEven always = break_even(1, 300, 1, 200, 0), never = break_even(1, 200, 2, 300, 0);
    assert_true(is_at(from, 2e7) && !from.up_to);
    assert_true(is_at(up_to, 2e7) && up_to.up_to);
    assert_true(is_at(always, 0) && !always.up_to);
    assert_true(is_at(never, 0) && never.up_to);
    assert_true(from.rays.low == from.rays.high && never.rays.low == never.rays.high);
}

RT_TEST(a_build_on_other_threads_than_the_rays_has_no_break_even) {
    build_threads = 2;
    assert_true(isnan(break_even(1, 300, 3, 200, 0).rays.median));
    build_threads = 0; /* unknown, as in results of version 1.0 */
    assert_true(isnan(break_even(1, 300, 3, 200, 0).rays.median));
    build_threads = 1;
}

/* Break-evens of times at the ends of their intervals: bit i of `ends` chooses one. */
static void assert_contains(const RtBreakEven *even, const double times[4], double error_of, unsigned ends) {
    double at[4];
    for (unsigned i = 0; i < 4; i++) at[i] = 1 + (ends >> i & 1 ? error_of : -error_of);
    const double more = times[2] * at[0] - times[0] * at[1];
    const double saved = (times[1] / times[3] * at[2] - 1) * 1e-9 * times[3] * at[3];
    if ((even->up_to ? -more : more) <= 0 || (even->up_to ? -saved : saved) <= 0) return;
    assert_true(even->rays.low <= more / saved * (1 + 1e-9));
    assert_true(even->rays.high >= more / saved * (1 - 1e-9));
}

/* Of times with errors of up to 30 %, and so at times of unknown order. */
RT_TEST(the_interval_of_a_break_even_contains_those_of_all_times_within_theirs) {
    static const double times[][4] = {
        {1, 300, 3, 200}, {3, 200, 1, 300}, {1, 300, 1.1, 200}, {1, 300, 3, 290}, {3, 280, 1, 300}};
    for (size_t i = 0; i < sizeof times / sizeof times[0]; i++) {
        const double *t = times[i];
        double width = 0;
        for (double error_of = 0.001; error_of < 0.3; error_of *= 3) {
            const RtBreakEven even = break_even(t[0], t[1], t[2], t[3], error_of);
            assert_int_equal(even.up_to, t[2] < t[0]);
            for (unsigned ends = 0; ends < 16; ends++) assert_contains(&even, t, error_of, ends);
            assert_true(even.rays.low <= even.rays.median && even.rays.median <= even.rays.high);
            assert_true(even.rays.high - even.rays.low >= width);
            width = even.rays.high - even.rays.low;
        }
    }
}

RT_TEST(a_break_even_is_shown_as_far_as_the_intervals_decide_and_without_infinity) {
    static const struct {
        double theirs, their_ray, ours, our_ray, error_of;
        const char *says, *silent;
    } cases[] = {{1, 300, 1.01, 299, 0.1, "undecided", NULL}, /* any number, as both may be equal */
                 {1, 300, 3, 310, 0.05, "perhaps from ", NULL},
                 {3, 310, 1, 300, 0.05, "", "perhaps"},
                 {3, 200, 1, 300, 0.001, "faster up to ", NULL},
                 {3, 200, 1, 200, 0.001, "faster, at least up to ", "inf"},
                 {1, 300, 1, 200, 0.001, " at the latest", "inf"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const RtBreakEven even = break_even(cases[i].theirs, cases[i].their_ray, cases[i].ours,
                                            cases[i].our_ray, cases[i].error_of);
        if (i == 0) assert_true(even.rays.low == 0 && isinf(even.rays.high));
        if (!strstr(shown, cases[i].says) || (cases[i].silent && strstr(shown, cases[i].silent)))
            fail_msg("case %zu: %s", i, shown);
    }
}

/* The first counting pass: its rays, and which of the eight parts of a frame of 64 rows they cover. */
static uint64_t first_count;
static unsigned first_parts;

RtStatus __real_rt_measure_count(const RtAccel *accel, const RtRaySet *set, const RtHit *expected,
                                 int threads, RtCount *count, RtError *error);
RtStatus __wrap_rt_measure_count(const RtAccel *accel, const RtRaySet *set, const RtHit *expected,
                                 int threads, RtCount *count, RtError *error);

RtStatus __wrap_rt_measure_count(const RtAccel *accel, const RtRaySet *set, const RtHit *expected,
                                 int threads, RtCount *count, RtError *error) {
    for (uint64_t i = 0; i < set->count && first_count == 0; i++)
        first_parts |= 1u << set->rays[i].source / (8 * 64);
    if (first_count == 0) first_count = set->count;
    return __real_rt_measure_count(accel, set, expected, threads, count, error);
}

RT_TEST(a_time_is_foretold_from_rays_of_all_parts_of_the_image) {
    const RtWorkloadOptions options = {.threads = 1, .timing = 1, .count_only = true};
    OWNED_MEMORY RtExperiment *e = experiment_of("ideal", NULL);
    OWNED_RESULTS results;
    e->limit_seconds = 1e9;
    add_scene(e, "balls:size=1", 64);
    assert_ok(rt_results_init(&results, e, error));
    first_count = first_parts = 0;
    assert_ok(rt_workloads_run(&results, &options, error));
    assert_in_range(first_count, 128, 256);
    assert_int_equal(first_parts, 0xff);
    const RtTally *tally = &rt_cell_at(&results, 0, 0, RT_RAY_PRIMARY)->tally;
    assert_int_equal(tally->rays, 64 * 64);
    assert_int_equal(tally->object_tests, tally->hits);
}

/* ---- overhead of timing ---- */

/* The set takes longer than a round must, so each round is one pass, and `seconds` is all of it; the rest is
 * memory, warm-up and work between passes. It is processor time, which other programs do not change, and the
 * best of some attempts, because they do change the caches. */
RT_TEST(of_the_time_that_timing_takes_ninety_eight_percent_are_rounds) {
    enum { ROUNDS = 10 };
    double seconds[2][ROUNDS], wall[2][ROUNDS], best = 0;
    const RtTiming timing = {.rounds = {.rounds = ROUNDS, .most = ROUNDS, .least = 2e-3, .seed = 1},
                             .threads = 1};
    OWNED(close_stage) Stage stage;
    open_stage(&stage, "balls:size=3", 8, 20000, "brute", "extents");
    for (int attempt = 0; attempt < 5 && best < 0.98; attempt++) {
        const RtRaySet *set = &stage.sets[RT_RAY_RANDOM];
        RtTimed timed[2] = {{.accel = stage.accels[0], .set = set, .seconds = seconds[0], .wall = wall[0]},
                            {.accel = stage.accels[1], .set = set, .seconds = seconds[1], .wall = wall[1]}};
        uint32_t done;
        double rounds = 0, start = rt_thread_seconds();
        assert_ok(rt_measure_time(timed, 2, &timing, &done, error));
        double all = rt_thread_seconds() - start;
        for (int i = 0; i < 2 * ROUNDS; i++) rounds += seconds[i / ROUNDS][i % ROUNDS] * (double)set->count;
        if (rounds / all > best) best = rounds / all;
    }
    if (best < 0.98) fail_msg("rounds are %.2f %% of the time", 100 * best);
}

static RtStatus spin_a_millisecond(void *context, RtError *error) {
    double start = rt_thread_seconds();
    (void)context, (void)error;
    while (rt_thread_seconds() - start < 1e-3) continue;
    return RT_OK;
}

/* Ten times slower than all of it is. */
static RtStatus warm_wrongly(void *context, double seconds, double *part, RtError *error) {
    (void)seconds;
    *part = 0.1;
    return spin_a_millisecond(context, error);
}

RT_TEST(what_was_told_wrong_from_a_part_of_the_work_is_repeated_often_enough_from_the_second_round_on) {
    double seconds[3], wall[3];
    uint32_t done;
    const RtRounds rounds = {.rounds = 3, .most = 3, .least = 10e-3, .seed = 1};
    RtRunner runner = {
        .run = spin_a_millisecond, .warm = warm_wrongly, .work = 1, .seconds = seconds, .wall = wall};
    assert_ok(rt_rounds_run(&runner, 1, &rounds, &done, error));
    assert_true(9 <= runner.repeats && runner.repeats <= 11);
    for (int r = 0; r < 3; r++) assert_true(0.9e-3 < seconds[r] && seconds[r] < 2e-3);
}

/* ---- rounds are independent, and alike for all ---- */

/* Processor caches: a run takes a millisecond, and a third more if another runner ran before it. */
typedef struct Cached {
    const struct Cached **last;
    uint32_t runs;
} Cached;

static RtStatus run_cached(void *context, uint32_t repeats, double *seconds, double *wall, RtError *error) {
    Cached *cached = context;
    const bool cold = *cached->last != cached;
    (void)error;
    *cached->last = cached;
    cached->runs += repeats;
    *seconds = *wall = 1e-3 * (repeats + (cold ? 0.33 : 0));
    return RT_OK;
}

/* The second has twice as many units of work, and is told to run for as long, so half as often. */
RT_TEST(how_often_a_runner_is_repeated_in_a_round_does_not_change_its_time) {
    enum { ROUNDS = 6 };
    const Cached *last = NULL;
    Cached cached[2] = {{&last, 0}, {&last, 0}};
    double seconds[2][ROUNDS];
    uint32_t done;
    RtRunner runners[2];
    for (int i = 0; i < 2; i++)
        runners[i] = (RtRunner){.time = run_cached, .context = &cached[i], .work = 1, .seconds = seconds[i]};
    RtRounds rounds = {.rounds = ROUNDS, .most = ROUNDS, .least = 1.2e-3, .seed = 1};
    assert_ok(rt_rounds_run(runners, 2, &rounds, &done, error));
    for (int r = 0; r < ROUNDS; r++)
        assert_true(fabs(seconds[0][r] - 1e-3) < 1e-9 && fabs(seconds[1][r] - 1e-3) < 1e-9);
    rounds.least = 0.4e-3; /* runs that take much longer than a round must are not run in vain */
    cached[0].runs = 0;
    assert_ok(rt_rounds_run(runners, 2, &rounds, &done, error));
    assert_int_equal(cached[0].runs, 1 + ROUNDS);
}

/* Structures that change places, the last of them one that cannot be built any more. */
typedef struct Renewals {
    RtAccel *accels[2];
    uint32_t count;
} Renewals;

static RtStatus renew_accels(void *context, RtTimed *timed, size_t count, RtError *error) {
    Renewals *renewals = context;
    (void)error;
    renewals->count++;
    assert_int_equal(count, 2);
    timed[0].accel = renewals->accels[renewals->count % 2];
    if (renewals->count == 3) timed[1].accel = NULL;
    return RT_OK;
}

RT_TEST(each_round_but_the_first_times_structures_that_were_renewed_before_it) {
    enum { ROUNDS = 6 };
    double seconds[2][ROUNDS] = {{0}}, wall[2][ROUNDS];
    bool broken[2] = {false, false};
    uint32_t done;
    OWNED(close_stage) Stage stage;
    open_stage(&stage, "balls:size=3", 8, 2000, "brute", "bvh");
    Renewals renewals = {{stage.accels[0], stage.accels[1]}, 0};
    const RtTiming timing = {.rounds = {.rounds = ROUNDS, .most = ROUNDS, .seed = 1, .context = &renewals},
                             .renew = renew_accels,
                             .threads = 1};
    RtTimed timed[2];
    for (int i = 0; i < 2; i++)
        timed[i] = (RtTimed){.accel = stage.accels[i],
                             .set = &stage.sets[RT_RAY_RANDOM],
                             .seconds = seconds[i],
                             .wall = wall[i],
                             .broken = &broken[i]};
    assert_ok(rt_measure_time(timed, 2, &timing, &done, error));
    assert_int_equal(renewals.count, ROUNDS - 1);
    assert_true(!broken[0] && broken[1]);
    assert_true(seconds[1][2] > 0 && seconds[1][3] == 0);
    for (int r = 0; r + 1 < ROUNDS; r++) /* brute takes many times as long as bvh */
        assert_true(r % 2 == 0 ? seconds[0][r] > seconds[0][r + 1] : seconds[0][r] < seconds[0][r + 1]);
}

/* ---- until the intervals are narrow ---- */

static RtStatus do_nothing(void *context, RtError *error) {
    (void)error;
    ++*(int *)context;
    return RT_OK;
}

static bool five_will_do(void *context, uint32_t rounds) {
    ++*(int *)context;
    return rounds >= 5;
}

RT_TEST(rounds_go_on_until_they_will_do_and_no_longer_than_they_may) {
    const uint32_t cases[][3] = {{3, 9, 5}, {3, 4, 4}, {7, 9, 7}, {9, 9, 9}}; /* at least, at most, done */
    for (int i = 0; i < 4; i++) {
        int runs = 0, asked = 0;
        double seconds[9];
        uint32_t done;
        RtRunner runner = {.run = do_nothing, .context = &runs, .work = 1, .seconds = seconds};
        RtRounds rounds = {
            .rounds = cases[i][0], .most = cases[i][1], .enough = five_will_do, .context = &asked};
        assert_ok(rt_rounds_run(&runner, 1, &rounds, &done, error));
        assert_int_equal(done, cases[i][2]);
        assert_int_equal(runs, done + 1); /* one to warm up */
        assert_int_equal(asked, i == 0 ? 3 : i == 1 || i == 2 ? 1 : 0);
    }
}

static void note(void *context, const char *message) {
    snprintf(context, 256, "%s", message);
}

/* If set, the wall clock advances by a millisecond each time it is read. */
static bool wall_ticks;

int __real_clock_gettime(clockid_t clock, struct timespec *now);
int __wrap_clock_gettime(clockid_t clock, struct timespec *now);

int __wrap_clock_gettime(clockid_t clock, struct timespec *now) {
    static long looks;
    if (!wall_ticks || clock != CLOCK_MONOTONIC) return __real_clock_gettime(clock, now);
    looks++;
    *now = (struct timespec){.tv_sec = looks / 1000, .tv_nsec = looks % 1000 * 1000000};
    return 0;
}

/* Times bvh until its null run is as narrow as `until`, and returns the rounds; `says` gets the notice. */
static uint32_t rounds_until(double until, double patience, char says[256]) {
    RtWorkloadOptions options = {.threads = 1, .timing = 1, .until = until, .patience = patience};
    OWNED_MEMORY RtExperiment *e = experiment_of("bvh", NULL);
    OWNED_RESULTS results;
    says[0] = '\0';
    options.observer = (RtRunObserver){says, NULL, note};
    e->rounds = 6;
    add_scene(e, "random:n=300", 16);
    assert_ok(rt_results_init(&results, e, error));
    wall_ticks = true;
    assert_ok(rt_workloads_run(&results, &options, error));
    wall_ticks = false;
    const RtCell *null = rt_cell_at(&results, 0, 1, RT_RAY_PRIMARY);
    uint32_t rounds = null->rounds;
    assert_true((rt_estimate_width(&null->ratio) <= until) == (says[0] == '\0'));
    assert_non_null(null->round_times);
    assert_int_equal(null->structures, rounds); /* each round timed another build */
    return rounds;
}

RT_TEST(timing_goes_on_until_the_intervals_of_ratios_are_narrow_or_says_that_they_are_not) {
    char says[256];
    assert_int_equal(rounds_until(100, 60, says), 6);
    assert_string_equal(says, "");
    assert_true(rounds_until(1e-12, 0.2, says) > 6);
    assert_non_null(strstr(says, "primary rays on random:n=300: after "));
    assert_non_null(strstr(says, "the widest is that of bvh (again)"));
    assert_int_equal(rounds_until(1e-12, 600, says), RT_MAX_ROUNDS);
    assert_non_null(strstr(says, "after 1000 rounds"));
}

RT_TESTS(measure, NULL, NULL)
