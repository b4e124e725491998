/* SPDX-License-Identifier: Apache-2.0 */
/* Two programs against each other: two workers (worker.h), started again for each round, that run in turns.
 */
#include "compare/compare.h"
#include "core/base/clock.h"
#include "core/base/random.h"
#include "core/text/json.h"
#include "measure/measure.h"
#include "run/callgrind.h"
#include "run/worker.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { BEFORE, AFTER };

/* A cell of a section that both workers have. */
typedef struct Pair {
    uint32_t number[2]; /* in each worker */
    uint32_t cell;      /* in the comparison */
    uint32_t repeats;
    double turns[RT_TURNS];
    double seconds[2][RT_TURNS];
} Pair;

typedef struct Run {
    const RtPrograms *programs;
    RtComparison *comparison;
    RtRandom random;
    uint32_t round, rounds; /* the current one, and how many are expected */
    double start;
    RtWorker workers[2];
} Run;

/* Seconds per ray of `repeats` runs of cell number `cell` of the section. */
static RtStatus ask_time(RtWorker *worker, uint32_t cell, uint32_t repeats, double *seconds, RtError *error) {
    json_t *answer;
    RT_TRY(rt_worker_ask(worker, &answer, error, "time %" PRIu32 " %" PRIu32 "\n", cell, repeats));
    *seconds = json_number_value(answer);
    json_decref(answer);
    return *seconds > 0
               ? RT_OK
               : rt_fail(error, RT_BAD_INPUT, "%s cannot be compared: it has no time for %" PRIu32 " runs",
                         worker->program, repeats);
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
        if (strcmp(rt_json_text(cell, "accel", ""), accel) == 0) return cell;
    }
    return NULL;
}

/* The cell of the comparison, with the counts of both; or a note that only one of them has it. */
static RtComparedCell *enter(Run *run, json_t *const sections[2], const json_t *before, const json_t *after) {
    const json_t *either = before ? before : after, *section = sections[before ? BEFORE : AFTER];
    RtComparedCell *cell =
        rt_comparison_cell(run->comparison, rt_json_text(section, "scene", ""),
                           rt_json_text(either, "accel", ""), rt_json_text(section, "kind", ""));
    if (!cell) return NULL;
    if (!cell->ratios) cell->ratios = rt_arena_alloc(&run->comparison->memory, RT_MAX_ROUNDS, sizeof(double));
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

static RtStatus find_pairs(Run *run, json_t *const sections[2], Pair *pairs, uint32_t *count,
                           RtError *error) {
    *count = 0;
    for (int who = BEFORE; who <= AFTER; who++) {
        const json_t *cells = json_object_get(sections[who], "cells");
        for (uint32_t i = 0; i < json_array_size(cells); i++) {
            Pair pair = {.number = {i, i}};
            const json_t *own = json_array_get(cells, i);
            const json_t *other = cell_of(sections[!who], rt_json_text(own, "accel", ""), &pair.number[!who]);
            if (who == AFTER && other) continue; /* it was entered above */
            RtComparedCell *cell =
                enter(run, sections, who == BEFORE ? own : other, who == BEFORE ? other : own);
            if (!cell) return rt_fail_memory(error, "a comparison", 0);
            pair.cell = (uint32_t)(cell - run->comparison->cells);
            if (other) pairs[(*count)++] = pair;
        }
    }
    return RT_OK;
}

/* Finds the number of repeats for which the faster program takes long enough. */
static RtStatus warm_up(Run *run, Pair *pair, RtError *error) {
    double rays = (double)run->comparison->cells[pair->cell].rays, least = INFINITY;
    for (int who = BEFORE; who <= AFTER; who++) {
        double seconds;
        RT_TRY(ask_time(&run->workers[who], pair->number[who], 1, &seconds, error));
        least = fmin(least, seconds * rays);
    }
    pair->repeats = rt_runner_repeats(least, run->programs->least);
    return RT_OK;
}

static RtStatus take_turn(Run *run, Pair *pair, uint32_t turn, RtError *error) {
    int first = (int)rt_random_below(&run->random, 2);
    for (int i = 0; i < 2; i++) {
        int who = i ? !first : first;
        RT_TRY(
            ask_time(&run->workers[who], pair->number[who], pair->repeats, &pair->seconds[who][turn], error));
    }
    pair->turns[turn] = pair->seconds[BEFORE][turn] / pair->seconds[AFTER][turn];
    return RT_OK;
}

static RtStatus time_pairs(Run *run, Pair *pairs, uint32_t count, RtError *error) {
    for (uint32_t i = 0; i < count; i++) RT_TRY(warm_up(run, &pairs[i], error));
    for (uint32_t turn = 0; turn < RT_TURNS; turn++) {
        for (uint32_t i = 0; i < count; i++) RT_TRY(take_turn(run, &pairs[i], turn, error));
    }
    for (uint32_t i = 0; i < count; i++) {
        RtComparedCell *cell = &run->comparison->cells[pairs[i].cell];
        if (cell->rounds > run->round) { /* ratios has room for one a round */
            return rt_fail(error, RT_BAD_INPUT, "%s cannot be compared: it lists %s on %s twice",
                           run->programs->before, cell->accel, cell->scene);
        }
        cell->ratios[cell->rounds++] = rt_median(pairs[i].turns, RT_TURNS);
        cell->before = rt_median(pairs[i].seconds[BEFORE], RT_TURNS);
        cell->after = rt_median(pairs[i].seconds[AFTER], RT_TURNS);
    }
    return RT_OK;
}

static RtStatus check_alike(const Run *run, json_t *const sections[2], RtError *error) {
    static const char *const keys[] = {"scene", "kind", "hash"};
    const char *texts[2][3];
    bool alike = true;
    for (int k = 0; k < 3; k++) {
        for (int who = BEFORE; who <= AFTER; who++) texts[who][k] = rt_json_text(sections[who], keys[k], "");
        alike &= strcmp(texts[BEFORE][k], texts[AFTER][k]) == 0;
    }
    if (alike) return RT_OK;
    return rt_fail(
        error, RT_BAD_INPUT,
        "%s and %s do not record the same rays (%s, %s), so times would not compare. Record the rays once "
        "with `raytally rays`, and measure each program on that file: `raytally bench --rays-from FILE`",
        run->programs->before, run->programs->after, texts[AFTER][0], texts[AFTER][1]);
}

static RtStatus compare_section(Run *run, json_t *const sections[2], RtError *error) {
    const RtPrograms *programs = run->programs;
    uint32_t count = (uint32_t)json_array_size(json_object_get(sections[BEFORE], "cells"));
    RT_TRY(check_alike(run, sections, error));
    if (programs->progress) {
        programs->progress(programs->context, run->round, run->rounds,
                           rt_json_text(sections[BEFORE], "scene", ""),
                           rt_json_text(sections[BEFORE], "kind", ""));
    }
    RT_ARENA(arena);
    Pair *pairs = rt_arena_alloc(&arena, count, sizeof(Pair));
    RT_TRY(rt_arena_check(&arena, "cells", error));
    RT_TRY(find_pairs(run, sections, pairs, &count, error));
    for (int who = BEFORE; who <= AFTER && programs->pinned; who++)
        RT_TRY(rt_worker_ask(&run->workers[who], NULL, error, "pin %" PRIu32 "\n", run->round));
    RT_TRY(time_pairs(run, pairs, count, error));
    for (int who = BEFORE; who <= AFTER; who++)
        RT_TRY(rt_worker_ask(&run->workers[who], NULL, error, "next\n"));
    return RT_OK;
}

/* ---- a round ---- */

static RtStatus compare_sections(Run *run, bool *more, RtError *error) {
    json_t *sections[2] = {NULL, NULL};
    RtStatus status = RT_OK;
    for (int who = BEFORE; who <= AFTER && status == RT_OK; who++) {
        status = rt_worker_take(&run->workers[who], &sections[who], error);
    }
    if (status == RT_OK) {
        *more = !json_object_get(sections[BEFORE], "done") || !json_object_get(sections[AFTER], "done");
        if (*more) status = compare_section(run, sections, error);
    }
    json_decref(sections[BEFORE]);
    json_decref(sections[AFTER]);
    return status;
}

static RtStatus start(Run *run, int who, RtError *error) {
    static const char *const command[] = {"raytally", "compare", "--worker", NULL};
    const bool after = who == AFTER;
    RtWorker *worker = &run->workers[who];
    json_t *hello = NULL;
    worker->program = after ? run->programs->after : run->programs->before;
    if (rt_worker_start(worker, command, run->programs->arguments, error) != RT_OK) return RT_BAD_INPUT;
    if (rt_worker_take(worker, &hello, error) != RT_OK ||
        json_integer_value(json_object_get(hello, "worker")) != 1) {
        json_decref(hello);
        return rt_fail(
            error, RT_BAD_INPUT,
            "%s cannot be compared: it must be a raytally that has the command `compare`. For an older "
            "one, compare result directories",
            worker->program);
    }
    snprintf(after ? run->comparison->after : run->comparison->before, sizeof run->comparison->before,
             "%s (%s)", after ? "this one" : worker->program, rt_json_text(hello, "build", ""));
    json_decref(hello);
    return RT_OK;
}

static RtStatus run_round(Run *run, RtError *error) {
    bool more = true;
    int first = (int)rt_random_below(&run->random, 2);
    RT_TRY(start(run, first, error));
    RT_TRY(start(run, !first, error));
    while (more) RT_TRY(compare_sections(run, &more, error));
    return RT_OK;
}

/* Computes the intervals after so many rounds; returns the width of the widest. */
static double estimate(RtComparison *comparison, uint32_t rounds) {
    double widest = 0;
    comparison->rounds = rounds;
    comparison->together = 0.95;
    comparison->all_accels = (double)NAN;
    comparison->timed = 0;
    for (uint32_t i = 0; i < comparison->count; i++) {
        RtComparedCell *cell = &comparison->cells[i];
        if (cell->timed && cell->rounds < rounds) {
            cell->timed = false; /* a time limit excluded it from some round */
            cell->change = RT_CHANGE_NOT_TIMED;
        }
        comparison->timed += cell->timed;
    }
    for (uint32_t i = 0; i < comparison->count; i++) {
        RtComparedCell *cell = &comparison->cells[i];
        if (!cell->timed) continue;
        cell->ratio = rt_estimate_at(cell->ratios, rounds, rt_coverage_of_each(comparison->timed));
        cell->change = rt_comparison_verdict(comparison, &cell->ratio);
        widest = fmax(widest, rt_estimate_width(&cell->ratio));
    }
    return widest;
}

/* At least as many rounds as the number of cells requires; then until the intervals are narrow. */
static bool is_enough(Run *run) {
    const RtPrograms *programs = run->programs;
    double width = estimate(run->comparison, run->round), passed = rt_wall_seconds() - run->start;
    uint32_t needed = rt_rounds_for(rt_coverage_of_each(run->comparison->timed));
    char message[160];
    run->comparison->seconds = passed;
    run->rounds = needed > programs->rounds ? needed : programs->rounds;
    if (run->round == RT_MAX_ROUNDS) return true;
    if (run->round < run->rounds) return false;
    if (programs->until <= 0 || width <= programs->until) return true;
    if (passed < programs->patience) return false;
    snprintf(message, sizeof message,
             "after %u rounds in %.0f s the intervals are within %.2g %%, not within %.2g %%", run->round,
             passed, 100 * width, 100 * programs->until);
    if (programs->notice) programs->notice(programs->context, message);
    return true;
}

RtStatus rt_compare_programs(const RtPrograms *programs, RtComparison *comparison, RtError *error) {
    Run run = {.programs = programs,
               .comparison = comparison,
               .random = rt_random(programs->seed, 0),
               .rounds = programs->rounds,
               .start = rt_wall_seconds()};
    RtStatus status = RT_OK;
    do {
        status = run_round(&run, error);
        rt_worker_end(&run.workers[BEFORE]);
        rt_worker_end(&run.workers[AFTER]);
        run.round++;
    } while (status == RT_OK && !is_enough(&run));
    return status;
}

/* ---- instructions ---- */

static void take_instructions(const RtCallgrind *callgrind, int who, RtComparison *comparison) {
    const RtExperiment *e = callgrind->experiment;
    for (uint32_t i = 0; i < callgrind->count; i++) {
        const RtInstructions *counted = &callgrind->cells[i];
        RtComparedCell *cell = rt_comparison_cell(comparison, e->workloads[counted->workload].label,
                                                  rt_candidate_label(e, counted->candidate),
                                                  rt_experiment_kind_name(e, counted->kind));
        if (!cell) continue;
        if (*counted->why)
            snprintf(cell->uncounted, sizeof cell->uncounted, "%s: %.*s", who == BEFORE ? "before" : "after",
                     RT_MAX_WHY - 10, counted->why);
        else
            cell->instructions[who] = (double)counted->instructions / (double)counted->rays;
    }
}

/* Records rays, by this program, which both then trace. */
static RtStatus count_both(RtCallgrind *callgrind, RtResults *results, const char *before,
                           char *const *arguments, RtComparison *comparison, RtError *error) {
    const RtWorkloadOptions how = {
        .count_only = true, .timing = 1, .rays = rt_callgrind_save_rays, .rays_context = callgrind};
    const char *const programs[] = {before, NULL};
    RT_TRY(rt_workloads_run(results, &how, error));
    for (int who = BEFORE; who <= AFTER; who++) {
        RT_TRY(rt_callgrind_run(callgrind, programs[who], results, arguments, error));
        take_instructions(callgrind, who, comparison);
    }
    return RT_OK;
}

RtStatus rt_compare_instructions(const RtExperiment *experiment, uint64_t most, const char *before,
                                 char *const *arguments, RtComparison *comparison, RtError *error) {
    RtCallgrind callgrind = {0};
    RtResults results;
    RtStatus status = rt_results_init(&results, experiment, error);
    if (status == RT_OK) status = rt_callgrind_init(&callgrind, experiment, most, error);
    if (status == RT_OK) status = count_both(&callgrind, &results, before, arguments, comparison, error);
    rt_callgrind_clear(&callgrind);
    rt_results_clear(&results);
    return status;
}
