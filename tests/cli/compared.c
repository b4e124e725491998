/* SPDX-License-Identifier: Apache-2.0 */
/* Makes of raytally the two programs that tests/check_compare.sh compares: one that is the same, and one that
 * needs RT_SLOWER, 2, percent more time. The linker puts these functions in the place of the real ones.
 *
 * By default times are drawn, not taken, so that what is found depends on no machine: a process is faster or
 * slower by up to 1 % for all its life, each time by up to 1 % more, and one in twenty is an outlier. The
 * file that $RAYTALLY_TIMES_DRAWN names holds how many were drawn; programs that take turns share it, and
 * draw the same times in every test. Without it clocks say, and the slower program asks of each stream that
 * is timed the last fiftieth of the rays beforehand, too: by its turn the processor has forgotten how its
 * branches went.
 */
#include "accel/accel.h"
#include "core/base/random.h"
#include "measure/measure.h"

#include <stdio.h>
#include <stdlib.h>

static const char *draws(void) {
    return getenv("RAYTALLY_TIMES_DRAWN");
}

/* ---- times that are drawn ---- */

/* The next number, or 0 where there is no such file yet. */
static uint64_t take_number(const char *path) {
    unsigned long long number = 0;
    FILE *file = fopen(path, "r");
    if (file) {
        if (fscanf(file, "%llu", &number) != 1) abort();
        fclose(file);
    }
    file = fopen(path, "w");
    if (!file || fprintf(file, "%llu\n", number + 1) < 0 || fclose(file)) abort();
    return number;
}

static double draw_seconds(double pieces) {
    static double life; /* of this process; 0 before its first time */
    RtRandom random = rt_random(1, take_number(draws()));
    if (life == 0) life = rt_random_betweend(&random, 0.99, 1.01);
    double noise = rt_random_betweend(&random, 0.99, 1.01);
    if (rt_random_below(&random, 20) == 0) noise *= rt_random_betweend(&random, 1, 2);
    return pieces * 1e-7 * life * noise * (1 + 0.01 * RT_SLOWER);
}

RtStatus __real_rt_runner_time(const RtRunner *runner, uint32_t repeats, double *seconds, double *wall,
                               RtError *error);
RtStatus __wrap_rt_runner_time(const RtRunner *runner, uint32_t repeats, double *seconds, double *wall,
                               RtError *error);

RtStatus __wrap_rt_runner_time(const RtRunner *runner, uint32_t repeats, double *seconds, double *wall,
                               RtError *error) {
    RT_TRY(__real_rt_runner_time(runner, draws() ? 1 : repeats, seconds, wall, error));
    if (draws()) *seconds = *wall = draw_seconds(repeats * runner->work);
    return RT_OK;
}

/* `context` is the runner. */
static RtStatus draw_time(void *context, uint32_t repeats, double *seconds, double *wall, RtError *error) {
    const RtRunner *runner = context;
    (void)error;
    *seconds = *wall = draw_seconds(repeats * runner->work);
    return RT_OK;
}

RtStatus __real_rt_rounds_run(RtRunner *runners, size_t count, const RtRounds *rounds, uint32_t *done,
                              RtError *error);
RtStatus __wrap_rt_rounds_run(RtRunner *runners, size_t count, const RtRounds *rounds, uint32_t *done,
                              RtError *error);

/* The rounds of a run: their own calls of rt_runner_time are not the linker's to replace. */
RtStatus __wrap_rt_rounds_run(RtRunner *runners, size_t count, const RtRounds *rounds, uint32_t *done,
                              RtError *error) {
    enum { MOST = 64 };
    RtRunner drawn[MOST];
    if (!draws()) return __real_rt_rounds_run(runners, count, rounds, done, error);
    if (count > MOST) abort();
    for (size_t i = 0; i < count; i++) {
        drawn[i] = runners[i];
        drawn[i].time = draw_time;
        drawn[i].warm = NULL;
        drawn[i].context = &drawn[i];
    }
    RtStatus status = __real_rt_rounds_run(drawn, count, rounds, done, error);
    for (size_t i = 0; i < count; i++) runners[i].repeats = 1; /* no ray was traced, and none learnt */
    return status;
}

/* ---- rays that are asked twice ---- */

void __real_rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies);
void __wrap_rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies);
void __real_rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies);
void __wrap_rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies);

static size_t asked_twice(size_t count, const RtTally *tallies) {
    return tallies ? 0 : count * RT_SLOWER / 100;
}

void __wrap_rt_nearest(RtQuery *query, const RtRay *rays, size_t count, RtHit *hits, RtTally *tallies) {
    size_t twice = asked_twice(count, tallies);
    if (twice) __real_rt_nearest(query, rays + count - twice, twice, hits, NULL);
    __real_rt_nearest(query, rays, count, hits, tallies);
}

void __wrap_rt_occluded(RtQuery *query, const RtRay *rays, size_t count, bool *blocked, RtTally *tallies) {
    size_t twice = asked_twice(count, tallies);
    if (twice) __real_rt_occluded(query, rays + count - twice, twice, blocked, NULL);
    __real_rt_occluded(query, rays, count, blocked, tallies);
}
