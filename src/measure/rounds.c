/* SPDX-License-Identifier: Apache-2.0 */
/* Interleaved rounds; in a file of their own because tests/cli/compared.c puts other rounds in their place.
 */
#include "measure/measure.h"

#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/random.h"

#include <assert.h>
#include <math.h>

enum { MOST_REPEATS = 1000000 };

RtStatus rt_runner_time(const RtRunner *runner, uint32_t repeats, double *seconds, double *wall,
                        RtError *error) {
    if (runner->time) return runner->time(runner->context, repeats, seconds, wall, error);
    double processor_start = rt_thread_seconds(), wall_start = rt_wall_seconds();
    for (uint32_t i = 0; i < repeats; i++) RT_TRY(runner->run(runner->context, error));
    *wall = rt_wall_seconds() - wall_start;
    *seconds = runner->parallel ? *wall : rt_thread_seconds() - processor_start;
    return RT_OK;
}

uint32_t rt_runner_repeats(double seconds, double least) {
    return (uint32_t)fmin(fmax(ceil(least / fmax(seconds, 1e-9)), 1), MOST_REPEATS);
}

/* Takes a tenth of the least round, a hundredth of ten rounds, and extrapolates to a whole run. */
static RtStatus warm_one(const RtRunner *runner, double least, double *seconds, RtError *error) {
    double wall, part = 1, start = rt_thread_seconds();
    if (!runner->warm || runner->parallel) return rt_runner_time(runner, 1, seconds, &wall, error);
    RT_TRY(runner->warm(runner->context, 0.1 * least, &part, error));
    *seconds = (rt_thread_seconds() - start) / part;
    return RT_OK;
}

/* Whether a runner that returned `status` is excluded from now on. */
static bool becomes_broken(const RtRunner *runner, RtStatus status) {
    if (status != RT_BROKEN || !runner->broken) return false;
    *runner->broken = true;
    return true;
}

static bool is_excluded(const RtRunner *runner) {
    return runner->broken && *runner->broken;
}

/* Loads code and data into the caches, and finds how often each must run to last `least` seconds. */
static RtStatus warm_up(RtRunner *runners, size_t count, double least, RtError *error) {
    for (size_t i = 0; i < count; i++) {
        RtRunner *runner = &runners[i];
        if (is_excluded(runner)) continue;
        RtStatus status = warm_one(runner, least, &runner->once, error);
        if (becomes_broken(runner, status)) continue;
        RT_TRY(status);
        runner->repeats = rt_runner_repeats(runner->once, least);
    }
    return RT_OK;
}

/* The first of several runs in a round finds other data in the caches than the next ones, so runners that are
 * repeated more often would seem faster. Runs of `least` seconds before each round make all of them alike;
 * those that take twice as long find that out for themselves. */
static RtStatus settle(const RtRunner *runner, double least, RtError *error) {
    double seconds, wall, part;
    if (runner->once >= 2 * least) return RT_OK;
    if (runner->warm && !runner->parallel) return runner->warm(runner->context, least, &part, error);
    return rt_runner_time(runner, 1, &seconds, &wall, error);
}

static RtStatus run_round(RtRunner *runner, uint32_t round, double least, RtError *error) {
    const double work = runner->repeats * runner->work;
    double seconds, wall;
    RT_TRY(settle(runner, least, error));
    RT_TRY(rt_runner_time(runner, runner->repeats, &seconds, &wall, error));
    runner->once = seconds / runner->repeats;
    runner->seconds[round] = seconds / work;
    if (runner->wall) runner->wall[round] = wall / work;
    if (seconds < least) /* the extrapolation was wrong */
        runner->repeats = rt_runner_repeats(runner->once, least);
    return RT_OK;
}

RtStatus rt_rounds_run(RtRunner *runners, size_t count, const RtRounds *rounds, uint32_t *done,
                       RtError *error) {
    RT_ARENA(arena);
    RtRandom random = rt_random(rounds->seed, 0);
    size_t *order = rt_arena_alloc(&arena, count, sizeof(size_t));
    assert(rounds->rounds >= 1 && rounds->rounds <= rounds->most && rounds->most <= RT_MAX_ROUNDS);
    RT_TRY(rt_arena_check(&arena, "the rounds", error));
    for (size_t i = 0; i < count; i++) order[i] = i;
    RT_TRY(warm_up(runners, count, rounds->least, error));
    for (uint32_t round = 0; round < rounds->most; round++) {
        if (round >= rounds->rounds && (!rounds->enough || rounds->enough(rounds->context, round))) break;
        if (round > 0 && rounds->renew) RT_TRY(rounds->renew(rounds->renew_context, error));
        rt_random_shuffle(&random, order, count);
        for (size_t i = 0; i < count; i++) {
            RtRunner *runner = &runners[order[i]];
            if (is_excluded(runner)) continue;
            RtStatus status = run_round(runner, round, rounds->least, error);
            if (!becomes_broken(runner, status)) RT_TRY(status);
        }
        *done = round + 1;
    }
    return RT_OK;
}
