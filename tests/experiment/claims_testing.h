/* SPDX-License-Identifier: Apache-2.0 */
/* Results made by hand, for tests of claims. */
#ifndef RT_TESTS_CLAIMS_TESTING_H
#define RT_TESTS_CLAIMS_TESTING_H

#include "testing.h"

#include "claims/claims.h"
#include "results/result_tables.h"

/* Scenes random:n=10, 100, 1000 and balls; accelerators bvh (the baseline), grid:density=1, 2, 4. */
static RtExperiment *e;
static RtResults results;

/* Empty results of the experiment as it is now. */
static inline void start_results(void) {
    rt_results_clear(&results);
    assert_ok(rt_results_init(&results, e, error));
    for (uint32_t t = 0; t < 4; t++) results.workloads[t].rays[0] = results.workloads[t].rays[1] = 1000;
}

static inline int set_up(void **state) {
    (void)state;
    RtCandidate bvh = {.spec = "bvh", .ray_stride = 1},
                grid = {.spec = "grid:density=1..4*2", .ray_stride = 1};
    RtWorkload scene = {.depth = 1};
    char where[RT_MAX_LABEL];
    e = rt_alloc(1, sizeof *e);
    if (!e) return -1;
    rt_experiment_init(e);
    strcpy(e->name, "claims");
    e->kind_count = 2; /* primary, shadow */
    assert_ok(rt_experiment_add_scenes(e, &scene, "random:n=10..1000*10", "", error));
    assert_ok(rt_experiment_add_scenes(e, &scene, "balls", "", error));
    assert_ok(rt_experiment_add_accels(e, &bvh, error));
    assert_ok(rt_experiment_add_accels(e, &grid, error));
    assert_ok(rt_experiment_check(e, where, error));
    start_results();
    return 0;
}

static inline int tear_down(void **state) {
    (void)state;
    rt_results_clear(&results);
    rt_free(e);
    return 0;
}

/* Both kinds of rays: `tests` in each 10 of 1000 rays, and nanoseconds from low to high, the median between
 * them. */
static inline void set(uint32_t t, uint32_t c, uint64_t tests, double low, double high) {
    for (uint32_t k = 0; k < 2; k++) {
        RtCell *cell = rt_cell_at(&results, t, c, (RtRayKind)k);
        RtEstimate ns = {0.5e-9 * (low + high), 1e-9 * low, 1e-9 * high, 1e-9 * low};
        *cell = (RtCell){.counted = true,
                         .timed = true,
                         .rounds = 6,
                         .tally = {.rays = 1000, .object_tests = 100 * tests},
                         .seconds = ns};
    }
}

static inline void set_all(void) {
    for (uint32_t t = 0; t < 4; t++) {
        set(t, 0, 20 + t, 100 * pow(2, t), 104 * pow(2, t));
        for (uint32_t c = 1; c < 4; c++) set(t, c, 100 / c, 200, 210 + 5 * c);
    }
}

static inline void expect(RtClaimVerdict verdict, const char *claim, const char *figures) {
    RtClaimResult result;
    RtClaim parsed;
    assert_ok(rt_claim_parse(e, claim, &parsed, error));
    strcpy(e->claims[0], claim);
    e->claim_count = 1;
    rt_claim_judge(&results, 0, &result);
    if (result.verdict == verdict && strstr(result.figures, figures)) return;
    fail_msg("%s: %s, %s", claim, rt_claim_verdict_name(result.verdict), result.figures);
}

#define holds(claim, figures)        expect(RT_CLAIM_HOLDS, claim, figures)
#define is_false(claim, figures)     expect(RT_CLAIM_FALSE, claim, figures)
#define is_undecided(claim, figures) expect(RT_CLAIM_UNDECIDED, claim, figures)
#define shows(claim, figures)        expect(RT_CLAIM_FIGURE, claim, figures)

#endif
