/* SPDX-License-Identifier: Apache-2.0 */
/* Two programs against one another: two workers (experiment/worker.h), started anew for each round, that run
 * by turns. */
#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/random.h"
#include "experiment/compare.h"
#include "experiment/worker.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BEFORE, AFTER };

/* One cell of a section: its numbers in both workers. */
typedef struct Pair {
    uint32_t number[2];
    uint32_t cell; /* in the comparison */
    uint32_t repeats;
    double turns[RT_TURNS];
    double seconds[2][RT_TURNS];
} Pair;

typedef struct Match {
    const RtPrograms *programs;
    RtComparison *comparison;
    RtRandom random;
    uint32_t round, rounds; /* the one at hand, and how many there will be as far as is known */
    double start;
    RtWorker workers[2];
} Match;

static const char *text_of(const json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    return text ? text : "";
}

/* ---- a section: a scene and a kind of rays ---- */

static void take_counts(RtTally *tally, const json_t *counts) {
#define TAKE(name, meaning) tally->name = (uint64_t)json_integer_value(json_object_get(counts, #name));
    RT_TALLY_COUNTERS(TAKE)
#undef TAKE
}

static const json_t *cell_of(const json_t *section, const char *accel, uint32_t *number) {
    const json_t *cells = json_object_get(section, "cells");
    for (*number = 0; *number < json_array_size(cells); ++*number) {
        const json_t *cell = json_array_get(cells, *number);
        if (strcmp(text_of(cell, "accel"), accel) == 0) return cell;
    }
    return NULL;
}

/* The cell of the comparison, with what both count; one that only one of them has is noted as such. */
static RtComparedCell *enter(Match *match, const json_t *const sections[2], const json_t *before,
                             const json_t *after) {
    const json_t *either = before ? before : after, *section = sections[before ? BEFORE : AFTER];
    RtComparedCell *cell = rt_comparison_cell(match->comparison, text_of(section, "scene"),
                                              text_of(either, "accel"), text_of(section, "kind"));
    if (!cell) return NULL;
    if (!cell->ratios) cell->ratios = rt_alloc(RT_MAX_ROUNDS, sizeof(double));
    if (!cell->ratios) return NULL;
    cell->timed = before && after;
    if (!cell->timed) {
        cell->change = before ? RT_CHANGE_ONLY_BEFORE : RT_CHANGE_ONLY_AFTER;
        return cell;
    }
    take_counts(&cell->counts_before, json_object_get(before, "counts"));
    take_counts(&cell->counts, json_object_get(after, "counts"));
    cell->counted =
        json_is_true(json_object_get(before, "exact")) && json_is_true(json_object_get(after, "exact"));
    cell->rays = cell->counts.rays;
    return cell;
}

static RtStatus find_pairs(Match *match, const json_t *const sections[2], Pair *pairs, uint32_t *count,
                           RtError *error) {
    *count = 0;
    for (int who = BEFORE; who <= AFTER; who++) {
        const json_t *cells = json_object_get(sections[who], "cells");
        for (uint32_t i = 0; i < json_array_size(cells); i++) {
            Pair pair = {.number = {i, i}};
            const json_t *own = json_array_get(cells, i);
            const json_t *other = cell_of(sections[!who], text_of(own, "accel"), &pair.number[!who]);
            if (who == AFTER && other) continue; /* it was met before */
            RtComparedCell *cell =
                enter(match, sections, who == BEFORE ? own : other, who == BEFORE ? other : own);
            if (!cell) return rt_fail_memory(error, "a comparison", 0);
            pair.cell = (uint32_t)(cell - match->comparison->cells);
            if (other) pairs[(*count)++] = pair;
        }
    }
    return RT_OK;
}

/* As often as lets the faster one take long enough. */
static RtStatus warm_up(Match *match, Pair *pair, RtError *error) {
    double rays = (double)match->comparison->cells[pair->cell].rays, least = INFINITY;
    for (int who = BEFORE; who <= AFTER; who++) {
        double seconds;
        RT_TRY(rt_worker_time(&match->workers[who], pair->number[who], 1, &seconds, error));
        least = fmin(least, seconds * rays);
    }
    pair->repeats = rt_runner_repeats(least, match->programs->least);
    return RT_OK;
}

static RtStatus take_turn(Match *match, Pair *pair, uint32_t turn, RtError *error) {
    int first = (int)rt_random_below(&match->random, 2);
    for (int i = 0; i < 2; i++) {
        int who = i ? !first : first;
        RT_TRY(rt_worker_time(&match->workers[who], pair->number[who], pair->repeats,
                              &pair->seconds[who][turn], error));
    }
    pair->turns[turn] = pair->seconds[BEFORE][turn] / pair->seconds[AFTER][turn];
    return RT_OK;
}

static RtStatus time_pairs(Match *match, Pair *pairs, uint32_t count, RtError *error) {
    for (uint32_t i = 0; i < count; i++) RT_TRY(warm_up(match, &pairs[i], error));
    for (uint32_t turn = 0; turn < RT_TURNS; turn++) {
        for (uint32_t i = 0; i < count; i++) RT_TRY(take_turn(match, &pairs[i], turn, error));
    }
    for (uint32_t i = 0; i < count; i++) {
        RtComparedCell *cell = &match->comparison->cells[pairs[i].cell];
        cell->ratios[cell->rounds++] = rt_median(pairs[i].turns, RT_TURNS);
        cell->before = rt_median(pairs[i].seconds[BEFORE], RT_TURNS);
        cell->after = rt_median(pairs[i].seconds[AFTER], RT_TURNS);
    }
    return RT_OK;
}

static RtStatus check_alike(const Match *match, const json_t *const sections[2], RtError *error) {
    const char *scene = text_of(sections[AFTER], "scene"), *kind = text_of(sections[AFTER], "kind");
    bool same_place = strcmp(text_of(sections[BEFORE], "scene"), scene) == 0 &&
                      strcmp(text_of(sections[BEFORE], "kind"), kind) == 0;
    if (same_place && strcmp(text_of(sections[BEFORE], "hash"), text_of(sections[AFTER], "hash")) == 0)
        return RT_OK;
    return rt_fail(
        error, RT_BAD_INPUT,
        "%s and %s do not record the same rays (%s, %s): times would not compare. Record the rays once with "
        "`raytally rays`, and measure each program on that file: `raytally bench --rays-from FILE`",
        match->programs->before, match->programs->after, scene, kind);
}

static RtStatus compare_section(Match *match, const json_t *const sections[2], RtError *error) {
    const RtPrograms *programs = match->programs;
    uint32_t count = (uint32_t)json_array_size(json_object_get(sections[BEFORE], "cells"));
    RT_TRY(check_alike(match, sections, error));
    if (programs->progress) {
        programs->progress(programs->context, match->round, match->rounds, text_of(sections[BEFORE], "scene"),
                           text_of(sections[BEFORE], "kind"));
    }
    Pair *pairs = rt_alloc(count, sizeof(Pair));
    if (!pairs) return rt_fail_memory(error, "cells", count * sizeof(Pair));
    RtStatus status = find_pairs(match, sections, pairs, &count, error);
    for (int who = BEFORE; who <= AFTER && status == RT_OK && programs->pinned; who++) {
        status = rt_worker_pin(&match->workers[who], match->round, error);
    }
    if (status == RT_OK) status = time_pairs(match, pairs, count, error);
    for (int who = BEFORE; who <= AFTER && status == RT_OK; who++) {
        status = rt_worker_go_on(&match->workers[who], error);
    }
    rt_free(pairs);
    return status;
}

/* ---- a round ---- */

static RtStatus compare_sections(Match *match, bool *more, RtError *error) {
    json_t *sections[2] = {NULL, NULL};
    RtStatus status = RT_OK;
    for (int who = BEFORE; who <= AFTER && status == RT_OK; who++) {
        status = rt_worker_next(&match->workers[who], &sections[who], error);
    }
    if (status == RT_OK) {
        bool done[2];
        for (int who = BEFORE; who <= AFTER; who++)
            done[who] = json_object_get(sections[who], "done") != NULL;
        *more = !(done[BEFORE] && done[AFTER]);
        const json_t *const both[2] = {sections[BEFORE], sections[AFTER]};
        if (*more) status = compare_section(match, both, error);
    }
    json_decref(sections[BEFORE]);
    json_decref(sections[AFTER]);
    return status;
}

static void name(char *out, size_t room, const char *program, const json_t *build) {
    snprintf(out, room, "%s (%s)", program, text_of(build, "build"));
}

static RtStatus start(Match *match, int who, RtError *error) {
    json_t *build;
    const char *program = who == BEFORE ? match->programs->before : match->programs->after;
    RT_TRY(rt_worker_start(&match->workers[who], program, match->programs->arguments, &build, error));
    if (who == AFTER) program = "this one";
    char *out = who == BEFORE ? match->comparison->before : match->comparison->after;
    name(out, sizeof match->comparison->before, program, build);
    json_decref(build);
    return RT_OK;
}

static RtStatus run_round(Match *match, RtError *error) {
    bool more = true;
    int first = (int)rt_random_below(&match->random, 2);
    RT_TRY(start(match, first, error));
    RT_TRY(start(match, !first, error));
    while (more) RT_TRY(compare_sections(match, &more, error));
    return RT_OK;
}

/* Intervals of what there is after so many rounds; how wide the widest is. */
static double estimate(RtComparison *comparison, uint32_t rounds) {
    double widest = 0;
    for (uint32_t i = 0; i < comparison->count; i++) {
        RtComparedCell *cell = &comparison->cells[i];
        if (!cell->timed || cell->rounds == rounds) continue;
        cell->timed = false; /* a limit of time left it out in some round */
        cell->change = RT_CHANGE_NOT_TIMED;
    }
    rt_comparison_judge(comparison);
    for (uint32_t i = 0; i < comparison->count; i++) {
        RtComparedCell *cell = &comparison->cells[i];
        if (!cell->timed) continue;
        cell->ratio = rt_estimate_at(cell->ratios, rounds, rt_coverage_of_each(comparison->timed));
        widest = fmax(widest, rt_estimate_width(&cell->ratio));
    }
    comparison->rounds = rounds;
    rt_comparison_judge(comparison);
    return widest;
}

/* At least as many as so many cells ask for; then as `until` says. */
static bool is_enough(Match *match) {
    const RtPrograms *programs = match->programs;
    double width = estimate(match->comparison, match->round), passed = rt_wall_seconds() - match->start;
    uint32_t needed = rt_rounds_for(rt_coverage_of_each(match->comparison->timed));
    char message[160];
    match->comparison->seconds = passed;
    match->rounds = needed > programs->rounds ? needed : programs->rounds;
    if (match->round == RT_MAX_ROUNDS) return true;
    if (match->round < match->rounds) return false;
    if (programs->until <= 0 || width <= programs->until) return true;
    if (passed < programs->patience) return false;
    snprintf(message, sizeof message, "after %u rounds in %.0f s intervals are within %.2g %%, not %.2g %%",
             match->round, passed, 100 * width, 100 * programs->until);
    if (programs->notice) programs->notice(programs->context, message);
    return true;
}

RtStatus rt_compare_programs(const RtPrograms *programs, RtComparison *comparison, RtError *error) {
    Match match = {.programs = programs,
                   .comparison = comparison,
                   .random = rt_random(programs->seed, 0),
                   .rounds = programs->rounds,
                   .start = rt_wall_seconds()};
    RtStatus status = RT_OK;
    do {
        status = run_round(&match, error);
        rt_worker_end(&match.workers[BEFORE]);
        rt_worker_end(&match.workers[AFTER]);
        match.round++;
    } while (status == RT_OK && !is_enough(&match));
    return status;
}
