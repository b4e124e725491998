/* SPDX-License-Identifier: Apache-2.0 */
/* Timing tests of extents: see extents_table.h. */
#include "measure/extents_table.h"

#include "core/base/memory.h"
#include "rays/rayset.h"

#include <assert.h>

/* Objects whose extents are in the list, evenly spread over the population; lines that traverse it; rays for
 * object tests; attempts to draw those. */
enum { SAMPLE = 256, LINES = 64, CHORDS = 512, TRIES = 8192 };

typedef struct PreparedRays {
    uint32_t count;
    RtRay rays[CHORDS];
    RtPreparedRay prepared[CHORDS];
    uint32_t ids[CHORDS]; /* the object that each is for */
} PreparedRays;

/* What all runners share. */
typedef struct Bench {
    const RtGeometry *geometry;
    uint32_t count; /* objects sampled */
    uint32_t ids[SAMPLE];
    RtBox boxes[SAMPLE];
    uint32_t met[SAMPLE];  /* extents that the last line hit, which a search would visit next */
    PreparedRays lines;    /* through the scene */
    PreparedRays chords;   /* that meet the box of their object */
    RtCrossing *crossings; /* of hit functions */
} Bench;

/* The extents of one choice. */
typedef struct Extents {
    Bench *bench;
    RtExtentSet set;
} Extents;

/* ---- the timed work ---- */

RT_KERNEL void test_list(RtExtentKind kind, const Extents *extents) {
    Bench *bench = extents->bench;
    for (uint32_t k = 0; k < bench->lines.count; k++) {
        RtPreparedRay ray = rt_ray_prepare(&bench->lines.rays[k], &bench->geometry->box);
        RtLine line = rt_line(&extents->set, kind, &bench->geometry->box, &ray);
        uint32_t met = 0;
        for (uint32_t i = 0; i < bench->count; i++) {
            float enter;
            if (rt_extent_hit(&extents->set, kind, i, &bench->boxes[i], &ray, &line, ray.tmax, &enter)) {
                bench->met[met++] = i;
            }
        }
    }
}

static RtStatus run_extents(void *context, RtError *error) {
    (void)error;
    const Extents *extents = context;
    RT_BY_EXTENT_KIND(extents->set.kind, test_list, extents);
    return RT_OK;
}

static RtStatus run_objects(void *context, RtError *error) {
    (void)error;
    Bench *bench = context;
    uint32_t met = 0;
    for (uint32_t k = 0; k < bench->chords.count; k++) {
        RtHit hit = RT_MISS;
        const RtPreparedRay *ray = &bench->chords.prepared[k];
        met += rt_test_object(bench->geometry, bench->chords.ids[k], ray, true, &hit, NULL);
    }
    bench->met[0] = met;
    return RT_OK;
}

/* ---- preparing ---- */

static void add_ray(PreparedRays *to, const RtGeometry *geometry, const RtRay *ray, RtCrossing *crossings,
                    uint32_t id) {
    to->rays[to->count] = *ray;
    rt_hit_ray(&to->prepared[to->count], geometry, &to->rays[to->count], crossings);
    to->ids[to->count++] = id;
}

static void fill_bench(Bench *bench, const RtPopulation *population, uint64_t seed) {
    const RtGeometry *geometry = population->geometry;
    RtRandom random = rt_random(seed, 1);
    assert(population->count > 0);
    bench->geometry = geometry;
    bench->count = population->count < SAMPLE ? population->count : SAMPLE;
    for (uint32_t i = 0; i < bench->count; i++) {
        uint32_t id = population->ids[(uint64_t)i * population->count / bench->count];
        bench->ids[i] = id;
        bench->boxes[i] = geometry->boxes[id];
    }
    for (uint32_t k = 0; k < TRIES && bench->chords.count < CHORDS; k++) {
        uint32_t id = bench->ids[k % bench->count];
        RtBall sphere = rt_sphere_about_extents(geometry, id);
        RtRay ray = rt_sphere_chord(&sphere, &random);
        RtPreparedRay prepared = rt_ray_prepare(&ray, &geometry->box);
        float enter;
        bool met = rt_box_hit(&geometry->boxes[id], &prepared, prepared.tmax, &enter);
        if (met) add_ray(&bench->chords, geometry, &ray, bench->crossings, id);
    }
    for (uint32_t k = 0; k < LINES; k++) {
        RtRay ray = rt_random_chord(&geometry->box, &random);
        add_ray(&bench->lines, geometry, &ray, bench->crossings, RT_NO_OBJECT);
    }
}

static RtStatus fit_extents(Extents *extents, Bench *bench, RtExtentChoice choice, RtArena *memory,
                            RtError *error) {
    extents->bench = bench;
    RT_TRY(rt_extent_set_init(&extents->set, memory, choice.kind, choice.slabs, bench->count, error));
    for (uint32_t i = 0; i < bench->count; i++) {
        const RtGroup group = {bench->geometry, &bench->ids[i], 1, bench->boxes[i]};
        rt_extent_fit(&extents->set, i, &group);
    }
    return RT_OK;
}

/* ---- measuring ---- */

/* Times of the rounds: [count] rows of B, then one of I, then room for two of T. */
typedef struct Times {
    const RtRounds *rounds;
    double *seconds;
    size_t count;
} Times;

static double *row(const Times *times, size_t i) {
    return times->seconds + i * times->rounds->rounds;
}

/* T of one choice in every round, to `out`. */
static void weigh(const Times *times, size_t choice, double tests, double met, double *out) {
    for (uint32_t r = 0; r < times->rounds->rounds; r++) {
        out[r] = tests * row(times, choice)[r] + met * row(times, times->count)[r];
    }
}

static void conclude(const Times *times, const RtPopulation *population, const RtTightness *tightness,
                     RtExtentCost *out) {
    uint32_t rounds = times->rounds->rounds;
    double *first = row(times, times->count + 1), *own = row(times, times->count + 2);
    weigh(times, 0, population->count, tightness[0].met, first);
    for (size_t c = 0; c < times->count; c++) {
        weigh(times, c, population->count, tightness[c].met, own);
        out[c] = (RtExtentCost){rt_estimate(row(times, c), rounds), rt_estimate(own, rounds),
                                rt_estimate_ratio(own, first, rounds)};
    }
}

static RtStatus run(const Times *times, Bench *bench, Extents *extents, RtError *error) {
    RtRunner *runners = rt_alloc(times->count + 1, sizeof(RtRunner));
    if (!runners) return rt_fail_memory(error, "the rounds", (times->count + 1) * sizeof(RtRunner));
    for (size_t c = 0; c < times->count; c++) {
        runners[c] = (RtRunner){.run = run_extents,
                                .context = &extents[c],
                                .work = (double)bench->count * LINES,
                                .seconds = row(times, c)};
    }
    runners[times->count] = (RtRunner){.run = run_objects,
                                       .context = bench,
                                       .work = bench->chords.count,
                                       .seconds = row(times, times->count)};
    uint32_t done;
    RtStatus status =
        rt_rounds_run(runners, times->count + (bench->chords.count > 0), times->rounds, &done, error);
    rt_free(runners);
    return status;
}

RtStatus rt_extent_cost_time(const RtPopulation *population, const RtExtentChoice *choices, size_t count,
                             const RtTightness *tightness, const RtRounds *rounds, RtEstimate *object,
                             RtExtentCost *out, RtError *error) {
    RT_ARENA(arena);
    Bench *bench = rt_arena_alloc(&arena, 1, sizeof(Bench));
    Extents *extents = rt_arena_alloc(&arena, count, sizeof(Extents));
    Times times = {rounds, rt_arena_alloc(&arena, (count + 3) * rounds->rounds, sizeof(double)), count};
    RtStatus status = RT_OK;
    RT_TRY(rt_arena_check(&arena, "timing extents", error));
    RT_TRY(rt_crossings_alloc(population->geometry, &bench->crossings, error));
    fill_bench(bench, population, rounds->seed);
    for (size_t c = 0; status == RT_OK && c < count; c++) {
        status = fit_extents(&extents[c], bench, choices[c], &arena, error);
    }
    if (status == RT_OK) status = run(&times, bench, extents, error);
    if (status == RT_OK) {
        conclude(&times, population, tightness, out);
        *object = rt_estimate(row(&times, count), rounds->rounds);
        if (bench->chords.count == 0) *object = rt_estimate_exactly((double)NAN);
    }
    rt_free(bench->crossings);
    return status;
}
