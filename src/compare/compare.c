/* SPDX-License-Identifier: Apache-2.0 */
#include "compare/compare.h"

#include "accel/columns.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "experiment/plugins_used.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static const char *const change_names[] = {
#define NAME(CONSTANT, says) says,
    RT_CHANGES(NAME)
#undef NAME
};

void rt_comparison_clear(RtComparison *comparison) {
    rt_arena_clear(&comparison->memory);
    rt_free(comparison->cells);
    json_decref(comparison->plugins);
    *comparison = (RtComparison){0};
}

RtComparedCell *rt_comparison_cell(RtComparison *comparison, const char *scene, const char *accel,
                                   const char *kind) {
    for (uint32_t i = 0; i < comparison->count; i++) {
        RtComparedCell *cell = &comparison->cells[i];
        if (strcmp(cell->scene, scene) == 0 && strcmp(cell->accel, accel) == 0 &&
            strcmp(cell->kind, kind) == 0)
            return cell;
    }
    if (rt_reserve(&comparison->cells, &comparison->capacity, (uint64_t)comparison->count + 1,
                   sizeof(RtComparedCell), NULL) != RT_OK)
        return NULL;
    RtComparedCell *cell = &comparison->cells[comparison->count++];
    *cell = (RtComparedCell){.change = RT_CHANGE_NOT_TIMED};
    snprintf(cell->scene, sizeof cell->scene, "%s", scene);
    snprintf(cell->accel, sizeof cell->accel, "%s", accel);
    snprintf(cell->kind, sizeof cell->kind, "%s", kind);
    return cell;
}

/* ---- results ---- */

RtChange rt_comparison_verdict(const RtComparison *comparison, const RtEstimate *ratio) {
    const double margin = 1 + comparison->margin;
    return ratio->low > margin        ? RT_CHANGE_FASTER
           : ratio->high < 1 / margin ? RT_CHANGE_SLOWER
                                      : RT_CHANGE_NONE;
}

uint32_t rt_comparison_count(const RtComparison *comparison, RtChange change) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < comparison->count; i++) count += comparison->cells[i].change == change;
    for (uint32_t i = 0; i < comparison->accel_count; i++) count += comparison->accels[i].change == change;
    return count;
}

bool rt_compared_counts_differ(const RtComparedCell *cell) {
    return cell->counted && memcmp(&cell->counts_before, &cell->counts, sizeof(RtTally)) != 0;
}

uint32_t rt_comparison_changed(const RtComparison *comparison) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < comparison->count; i++)
        count += rt_compared_counts_differ(&comparison->cells[i]);
    return count;
}

/* ---- pairs of result directories: their cells ---- */

/* A pair of runs whose counts differ is kept in preference to one whose counts do not. */
static void take_counts(RtComparedCell *cell, const RtTally *before, const RtTally *after) {
    if (rt_compared_counts_differ(cell)) return;
    cell->counted = true;
    cell->counts_before = *before;
    cell->counts = *after;
}

static RtStatus take_times(RtComparison *comparison, RtComparedCell *cell, uint32_t pair, const RtCell *one,
                           const RtCell *other, RtError *error) {
    if (!cell->runs) cell->runs = rt_arena_alloc(&comparison->memory, comparison->pairs, sizeof *cell->runs);
    RT_TRY(rt_arena_check(&comparison->memory, "times", error));
    cell->runs[pair][0] = one;
    cell->runs[pair][1] = other;
    cell->timed = true;
    cell->before = one->seconds.median;
    cell->after = other->seconds.median;
    return RT_OK;
}

/* Whether the run's rays and scene are those of the cell. */
static bool is_of(const RtComparedCell *cell, const RtResults *results, uint32_t t, RtRayKind kind,
                  const RtCell *run) {
    return cell->scene_hash == results->workloads[t].scene &&
           cell->ray_hash == results->workloads[t].ray_fingerprints[kind] && cell->rays == run->tally.rays;
}

static RtStatus exclude_cell(RtComparedCell *cell) {
    cell->timed = cell->counted = false;
    cell->change = RT_CHANGE_OTHER_RAYS;
    return RT_OK;
}

/* What a pair of runs is compared with. */
typedef struct Pair {
    const RtResults *before, *after;
    uint32_t number;
    bool swapped; /* looks only for cells that are missing before */
} Pair;

static RtStatus compare_cell(const Pair *pair, const RtCellCursor *at, RtComparison *comparison,
                             RtError *error) {
    const RtResults *before = pair->before, *after = pair->after;
    const uint32_t t = at->workload, c = at->candidate;
    const RtRayKind kind = at->kind;
    const char *scene = before->experiment->workloads[t].label;
    const char *accel = before->experiment->candidates[c].label;
    const RtCell *one = at->cell;
    if (!rt_candidate_runs(before->experiment, c, t) || (!one->counted && !one->timed)) return RT_OK;
    RtComparedCell *cell = rt_comparison_cell(comparison, scene, accel, rt_ray_kind_name(kind));
    if (!cell) return rt_fail_memory(error, "a comparison", 0);
    const RtExperiment *e = after->experiment;
    const uint32_t t2 = rt_workload_find(e, scene);
    const uint32_t c2 = t2 < e->workload_count ? rt_candidate_find(e, accel, t2) : e->candidate_count;
    const RtCell *other = c2 < e->candidate_count ? rt_cell_at(after, t2, c2, kind) : NULL;
    if (cell->change == RT_CHANGE_OTHER_RAYS) return RT_OK;
    if (cell->rays == 0) {
        cell->rays = one->tally.rays;
        cell->scene_hash = before->workloads[t].scene;
        cell->ray_hash = before->workloads[t].ray_fingerprints[kind];
    }
    if (!is_of(cell, before, t, kind, one)) return exclude_cell(cell);
    if (!other || (!other->counted && !other->timed)) {
        cell->change = pair->swapped ? RT_CHANGE_ONLY_AFTER : RT_CHANGE_ONLY_BEFORE;
        return RT_OK;
    }
    if (pair->swapped) return RT_OK;
    if (!is_of(cell, after, t2, kind, other)) return exclude_cell(cell);
    if (one->counted && other->counted && rt_build_at(before, t, c)->counts &&
        rt_build_at(after, t2, c2)->counts)
        take_counts(cell, &one->tally, &other->tally);
    if (!one->round_times || !other->round_times || one->threads != other->threads) return RT_OK;
    return take_times(comparison, cell, pair->number, one, other, error);
}

/* ---- intervals of cells, over the rounds of these processes ---- */

/* All times of a cell on one side. */
static double *gather(const RtComparedCell *cell, int side, uint32_t pairs, RtArena *arena, uint32_t *count) {
    uint32_t all = 0;
    for (uint32_t p = 0; p < pairs; p++) all += cell->runs[p][side] ? cell->runs[p][side]->rounds : 0;
    double *times = rt_arena_alloc(arena, all, sizeof(double));
    *count = 0;
    for (uint32_t p = 0; p < pairs && times; p++) {
        const RtCell *run = cell->runs[p][side];
        if (!run) continue;
        memcpy(times + *count, rt_cell_round_times(run, RT_ROUND_SECONDS), run->rounds * sizeof(double));
        *count += run->rounds;
    }
    return times;
}

static RtStatus estimate_cell(RtComparison *comparison, RtComparedCell *cell, RtError *error) {
    RT_ARENA(arena);
    const double each = rt_coverage_of_each(comparison->timed);
    uint32_t rounds[2];
    const double *before = gather(cell, 0, comparison->pairs, &arena, &rounds[0]),
                 *after = gather(cell, 1, comparison->pairs, &arena, &rounds[1]);
    RT_TRY(rt_arena_check(&arena, "times", error));
    RT_TRY(rt_estimate_unpaired(before, rounds[0], after, rounds[1], each, &cell->ratio, error));
    const double covered = fmin(each, rt_unpaired_coverage(rounds[0], rounds[1]));
    comparison->together -= 1 - covered;
    comparison->coverage = fmin(comparison->coverage, covered);
    return RT_OK;
}

/* ---- verdicts of accelerators ---- */

/* The median of the cells of one accelerator on a scene in a pair of runs; its kinds of rays are not
 * independent, because they share a structure. NAN: there is no such cell. */
static double ratio_on(const RtComparison *comparison, const char *scene, const char *accel, uint32_t pair) {
    double ratios[RT_RAY_KIND_COUNT];
    uint32_t count = 0;
    for (uint32_t i = 0; i < comparison->count; i++) {
        const RtComparedCell *cell = &comparison->cells[i];
        if (!cell->timed || !cell->runs[pair][0] || strcmp(cell->scene, scene) != 0 ||
            strcmp(cell->accel, accel) != 0)
            continue;
        ratios[count++] = cell->runs[pair][0]->seconds.median / cell->runs[pair][1]->seconds.median;
    }
    return count > 0 ? rt_median(ratios, count) : (double)NAN;
}

static void find_accels(RtComparison *comparison) {
    for (uint32_t i = 0; i < comparison->count; i++) {
        uint32_t found = 0;
        if (!comparison->cells[i].timed) continue;
        while (found < comparison->accel_count &&
               strcmp(comparison->accels[found].accel, comparison->cells[i].accel) != 0)
            found++;
        if (found == comparison->accel_count)
            strcpy(comparison->accels[comparison->accel_count++].accel, comparison->cells[i].accel);
    }
}

/* Ratios of all accelerators on one scene in a pair of runs, each relative to their median; only where three
 * or more have one, since otherwise the median does not show which of them changed. */
typedef struct Groups {
    double *ratios;   /* [accel][most] */
    double *together; /* [count] the medians */
    uint32_t count;
    size_t most;
} Groups;

static void add_group(RtComparison *comparison, const char *scene, uint32_t pair, Groups *groups) {
    double all[RT_MAX_CANDIDATES];
    uint32_t count = 0;
    for (uint32_t a = 0; a < comparison->accel_count; a++) {
        double ratio = ratio_on(comparison, scene, comparison->accels[a].accel, pair);
        if (!isnan(ratio)) all[count++] = ratio;
    }
    if (count < RT_LEAST_ACCELS) return;
    const double median = groups->together[groups->count++] = rt_median(all, count);
    for (uint32_t a = 0; a < comparison->accel_count; a++) {
        RtComparedAccel *accel = &comparison->accels[a];
        double ratio = ratio_on(comparison, scene, accel->accel, pair);
        if (!isnan(ratio)) groups->ratios[a * groups->most + accel->groups++] = ratio / median;
    }
}

static void judge(RtComparison *comparison, const Groups *groups) {
    uint32_t judged = 0;
    for (uint32_t a = 0; a < comparison->accel_count; a++) judged += comparison->accels[a].groups >= 2;
    comparison->judged = judged;
    for (uint32_t a = 0; a < comparison->accel_count; a++) {
        RtComparedAccel *accel = &comparison->accels[a];
        accel->change = RT_CHANGE_NOT_JUDGED;
        if (accel->groups < 2) continue;
        accel->ratio = rt_estimate_student(&groups->ratios[a * groups->most], accel->groups,
                                           rt_coverage_of_each(judged));
        accel->change = rt_comparison_verdict(comparison, &accel->ratio);
    }
    comparison->all_accels = groups->count > 0 ? rt_median(groups->together, groups->count) : (double)NAN;
}

/* Scenes are those of the cells, each at its first one. */
static bool is_first_of_scene(const RtComparison *comparison, uint32_t cell) {
    for (uint32_t i = 0; i < cell; i++) {
        if (strcmp(comparison->cells[i].scene, comparison->cells[cell].scene) == 0) return false;
    }
    return true;
}

static RtStatus judge_accels(RtComparison *comparison, RtError *error) {
    RtArena *memory = &comparison->memory;
    const size_t most = (size_t)RT_MAX_WORKLOADS * comparison->pairs;
    comparison->accels = rt_arena_alloc(memory, comparison->count, sizeof(RtComparedAccel));
    Groups groups = {.ratios = rt_arena_alloc(memory, comparison->count * most, sizeof(double)),
                     .together = rt_arena_alloc(memory, most, sizeof(double)),
                     .most = most};
    RT_TRY(rt_arena_check(memory, "the comparison of accelerators", error));
    find_accels(comparison);
    for (uint32_t i = 0; i < comparison->count; i++) {
        if (!is_first_of_scene(comparison, i)) continue;
        for (uint32_t p = 0; p < comparison->pairs; p++)
            add_group(comparison, comparison->cells[i].scene, p, &groups);
    }
    judge(comparison, &groups);
    return RT_OK;
}

RtStatus rt_compare_results(const RtResults *results, uint32_t pairs, RtComparison *comparison,
                            RtError *error) {
    comparison->pairs = pairs;
    for (uint32_t p = 0; p < pairs; p++) {
        const RtResults *before = &results[(size_t)2 * p], *after = before + 1;
        const Pair both[] = {{before, after, p, false}, {after, before, p, true}};
        for (int k = 0; k < 2; k++) {
            for (RtCellCursor at = {0}; rt_results_next(both[k].before, &at);)
                RT_TRY(compare_cell(&both[k], &at, comparison, error));
        }
    }
    uint32_t shared = 0;
    for (uint32_t i = 0; i < comparison->count; i++) {
        const RtComparedCell *cell = &comparison->cells[i];
        comparison->timed += cell->timed;
        shared += cell->change != RT_CHANGE_ONLY_BEFORE && cell->change != RT_CHANGE_ONLY_AFTER;
    }
    if (shared == 0 && comparison->count > 0)
        return rt_fail(error, RT_BAD_INPUT,
                       "there is nothing to compare: no scene, accelerator and kind of rays is in both");
    comparison->together = comparison->coverage = 1;
    for (uint32_t i = 0; i < comparison->count; i++) {
        RtComparedCell *cell = &comparison->cells[i];
        if (!cell->timed) continue;
        RT_TRY(estimate_cell(comparison, cell, error));
        cell->change = RT_CHANGE_BY_ACCEL;
    }
    comparison->together = fmax(0, comparison->together);
    return judge_accels(comparison, error);
}

/* ---- instructions ---- */

/* Counts of one program differ by less between builds whose machine code is the same. */
static const double SAME_INSTRUCTIONS = 1e-3;

static double instructions_ratio(const RtComparedCell *cell) {
    return cell->instructions[0] > 0 && cell->instructions[1] > 0
               ? cell->instructions[1] / cell->instructions[0]
               : (double)NAN;
}

#define MAX_DISAGREEMENT 120

/* Where time and instructions disagree; else "". */
static const char *disagreement(const RtComparedCell *cell, char out[MAX_DISAGREEMENT]) {
    const double more = instructions_ratio(cell) - 1;
    const bool faster = cell->change == RT_CHANGE_FASTER, slower = cell->change == RT_CHANGE_SLOWER;
    out[0] = '\0';
    if (isnan(more) || !(faster || slower)) return out;
    if (fabs(more) < SAME_INSTRUCTIONS)
        snprintf(out, MAX_DISAGREEMENT, "instructions equal: the difference in time is due to %s",
                 "the placement of code or data, not to more or less work");
    else if (faster ? more > 0 : more < 0)
        snprintf(out, MAX_DISAGREEMENT, "%.2g %% %s instructions although it measured %s", 100 * fabs(more),
                 more > 0 ? "more" : "fewer", faster ? "faster" : "slower");
    return out;
}

/* ---- as tables ---- */

typedef RtComparedRow Row;

static RtField interval_of(bool known, const RtEstimate *ratio) {
    return known ? rt_field_interval(ratio->median, ratio->low, ratio->high) : rt_field_missing();
}

static RtField disagreement_of(const Row *r) {
    char text[MAX_DISAGREEMENT];
    return *disagreement(r->cell, text) ? rt_field_print("%s", text) : rt_field_missing();
}

static RtField instructions_ratio_of(const Row *r) {
    const double ratio = instructions_ratio(r->cell);
    return isnan(ratio) ? rt_field_missing() : rt_field_print("%.4f", ratio);
}

static const void *tally_before(const void *row) {
    const Row *r = row;
    return r->cell->counted ? &r->cell->counts_before : NULL;
}

static const void *tally_after(const void *row) {
    const Row *r = row;
    return r->cell->counted ? &r->cell->counts : NULL;
}

#define TIMED(value)        (r->cell->timed ? (value) : (double)NAN)
#define INSTRUCTIONS(which) (r->cell->instructions[which] > 0 ? r->cell->instructions[which] : (double)NAN)

#define COLUMNS(X)                                                                                           \
    X(accel, "accel", text, "", "the accelerator's label", r->cell->accel)                                   \
    X(scene, "scene", text, "", "the scene's label", r->cell->scene)                                         \
    X(eye_accel, "accelerator", text, "", "the accelerator's label", r->cell->accel)                         \
    X(kind, "kind", text, "", "kind of the rays", r->cell->kind)                                             \
    X(interval, "ratio", interval, "", "throughput after over that before",                                  \
      interval_of(r->cell->timed, &r->cell->ratio))                                                          \
    X(change, "time", text, "",                                                                              \
      "faster, slower, or why that is unknown; by accelerator: see `accelerators`",                          \
      change_names[r->cell->change])                                                                         \
    X(counts, "counts", text, "", "same or changed; null: unknown, or dependent on the machine",             \
      !r->cell->counted                    ? NULL                                                            \
      : rt_compared_counts_differ(r->cell) ? "changed"                                                       \
                                           : "same")                                                         \
    X(eye_before, "instr. before", figure, "", "instructions per ray before", INSTRUCTIONS(0))               \
    X(eye_after, "after", figure, "", "instructions per ray after", INSTRUCTIONS(1))                         \
    X(eye_ratio, "after/before", text, "", "the ratio of both", instructions_ratio_of(r))                    \
    X(rays, "rays", integer, "", "rays measured", r->cell->rays)                                             \
    X(ns_before, "ns_before", real6, "ns", "time per ray before; median", TIMED(1e9 * r->cell->before))      \
    X(ns_after, "ns_after", real6, "ns", "time per ray after; median", TIMED(1e9 * r->cell->after))          \
    X(ratio, "ratio", real6, "", "throughput after over that before; median", TIMED(r->cell->ratio.median))  \
    X(ratio_low, "ratio_low", end, "",                                                                       \
      "lower end of its interval; all intervals hold simultaneously with the confidence `together`",         \
      TIMED(r->cell->ratio.low))                                                                             \
    X(ratio_high, "ratio_high", end, "", "upper end of its interval", TIMED(r->cell->ratio.high))            \
    X(instructions_before, "instructions_before", real6, "",                                                 \
      "instructions per ray before, with --callgrind", INSTRUCTIONS(0))                                      \
    X(instructions_after, "instructions_after", real6, "", "instructions per ray after", INSTRUCTIONS(1))    \
    X(instructions_ratio, "instructions_ratio", real6, "", "instructions after over those before",           \
      instructions_ratio(r->cell))                                                                           \
    X(disagreement, "disagreement", text, "", "where time and instructions disagree; else null",             \
      disagreement_of(r))

RT_TABLE_COLUMNS(columns, COLUMNS)

static const RtColumnGroup for_the_eye[] = {RT_FROM_TO(columns, scene, counts),
                                            RT_FROM_TO(columns, eye_before, eye_ratio)};

static const RtColumnGroup in_full[] = {
    RT_ONE(columns, scene),
    RT_ONE(columns, accel),
    RT_ONE(columns, kind),
    RT_FROM_TO(columns, change, counts),
    RT_FROM_TO(columns, rays, disagreement),
    {"counts_before", rt_tally_columns, RT_TALLY_COUNTER_COUNT, tally_before},
    {"counts_after", rt_tally_columns, RT_TALLY_COUNTER_COUNT, tally_after},
};

static bool has_instructions(const RtComparison *comparison) {
    for (uint32_t i = 0; i < comparison->count; i++) {
        if (comparison->cells[i].instructions[0] > 0) return true;
    }
    return false;
}

#define JUDGED(value) (r->accel->groups >= 2 ? (value) : (double)NAN)

#define ACCEL_COLUMNS(X)                                                                                     \
    X(of_accel, "accel", text, "", "the accelerator's label", r->accel->accel)                               \
    X(eye_of, "accelerator", text, "", "the accelerator's label", r->accel->accel)                           \
    X(groups, "groups", integer, "", "scenes times pairs of runs that it is judged by", r->accel->groups)    \
    X(relative, "ratio", interval, "", "throughput after over before, relative to the median accelerator",   \
      interval_of(r->accel->groups >= 2, &r->accel->ratio))                                                  \
    X(verdict, "time", text, "", "faster, slower, no difference found, or not judged",                       \
      change_names[r->accel->change])                                                                        \
    X(mean, "ratio", real6, "",                                                                              \
      "throughput after over that before, relative to the median accelerator; mean of groups",               \
      JUDGED(r->accel->ratio.median))                                                                        \
    X(low, "ratio_low", end, "",                                                                             \
      "lower end of its interval; all accelerators' hold simultaneously with 95 % confidence",               \
      JUDGED(r->accel->ratio.low))                                                                           \
    X(high, "ratio_high", end, "", "upper end of its interval", JUDGED(r->accel->ratio.high))

RT_TABLE_COLUMNS(accel_columns, ACCEL_COLUMNS)

static const RtColumnGroup accels_for_the_eye[] = {RT_FROM_TO(accel_columns, eye_of, verdict)};
static const RtColumnGroup accels_in_full[] = {RT_ONE(accel_columns, of_accel), RT_ONE(accel_columns, groups),
                                               RT_FROM_TO(accel_columns, verdict, high)};

static const void *row_at(void *context, size_t i) {
    Row *r = context;
    r->cell = &r->comparison->cells[i];
    return r;
}

static const void *accel_at(void *context, size_t i) {
    Row *r = context;
    r->accel = &r->comparison->accels[i];
    return r;
}

RtTable rt_comparison_table(RtComparedRow *row, bool accels, bool all) {
    static const RtTable tables[2][2] = {{{RT_GROUPS(for_the_eye)}, {RT_GROUPS(in_full)}},
                                         {{RT_GROUPS(accels_for_the_eye)}, {RT_GROUPS(accels_in_full)}}};
    RtTable table = tables[accels][all];
    if (!accels && !all && !has_instructions(row->comparison)) table.group_count = 1;
    table.row_count = accels ? row->comparison->accel_count : row->comparison->count;
    table.row = accels ? accel_at : row_at;
    table.context = row;
    return table;
}

/* ---- text and JSON ---- */

static void print_changed_counts(const RtComparison *comparison, FILE *out) {
    for (uint32_t i = 0; i < comparison->count; i++) {
        const RtComparedCell *cell = &comparison->cells[i];
        if (!rt_compared_counts_differ(cell)) continue;
        fprintf(out, "%s %s %s:", cell->scene, cell->accel, cell->kind);
        for (size_t k = 0; k < RT_TALLY_COUNTER_COUNT; k++) {
            uint64_t before = rt_tally_get(&cell->counts_before, k), after = rt_tally_get(&cell->counts, k);
            if (before != after) fprintf(out, " %s %" PRIu64 " -> %" PRIu64, rt_tally_name(k), before, after);
        }
        fputc('\n', out);
    }
}

static void print_instructions(const RtComparison *comparison, FILE *out) {
    for (uint32_t i = 0; i < comparison->count; i++) {
        const RtComparedCell *cell = &comparison->cells[i];
        char why[MAX_DISAGREEMENT], text[512] = "";
        if (*disagreement(cell, why))
            rt_append_text(text, sizeof text, "%s %s %s: %s.", cell->scene, cell->accel, cell->kind, why);
        else if (*cell->uncounted)
            rt_append_text(text, sizeof text, "%s %s %s: instructions are not counted: %s", cell->scene,
                           cell->accel, cell->kind, cell->uncounted);
        if (*text) rt_print_wrapped(text, out);
    }
}

static void print_plugins(const RtComparison *comparison, FILE *out) {
    const char *name;
    json_t *change;
    json_object_foreach(comparison->plugins, name, change) {
        char sentence[RT_MAX_PLUGIN_CHANGE];
        rt_plugins_change_format(name, change, "before", "after", sentence);
        fprintf(out, "Note: %s.\n", sentence);
    }
}

static double widest_of(const RtComparison *comparison) {
    double widest = 0;
    for (uint32_t i = 0; i < comparison->count && !comparison->pairs; i++) {
        const RtComparedCell *cell = &comparison->cells[i];
        if (cell->timed) widest = fmax(widest, rt_estimate_width(&cell->ratio));
    }
    for (uint32_t i = 0; i < comparison->accel_count; i++) {
        const RtComparedAccel *accel = &comparison->accels[i];
        if (accel->groups >= 2) widest = fmax(widest, rt_estimate_width(&accel->ratio));
    }
    return widest;
}

/* The first words of what explains the verdicts; "" if there are none. */
static void explain_verdicts(const RtComparison *comparison, char *out, size_t size) {
    const uint32_t count = comparison->pairs ? comparison->judged : comparison->timed;
    const double widest = 100 * widest_of(comparison);
    out[0] = '\0';
    if (count == 0) return;
    rt_append_text(out, size, "Ratios are of throughput%s.",
                   comparison->pairs
                       ? "; those of accelerators, over scenes, are relative to the median accelerator"
                       : "");
    if (count == 1)
        rt_append_text(out, size, " The interval, +-%.3g %%, holds with 95 %% confidence.", widest);
    else
        rt_append_text(out, size,
                       " All %" PRIu32
                       " intervals hold simultaneously with 95 %% confidence; the widest is +-%.3g %%.",
                       count, widest);
    if (comparison->rounds)
        rt_append_text(out, size, " %" PRIu32 " round%s in %.0f s.", comparison->rounds,
                       rt_plural(comparison->rounds), comparison->seconds);
    if (comparison->margin > 0)
        rt_append_text(out, size, " Differences below %.3g %% are not reported.", 100 * comparison->margin);
}

/* What rounds cannot show, and what they do. */
static void explain_directories(const RtComparison *comparison, char *out, size_t size) {
    const double each = rt_coverage_of_each(comparison->timed);
    out[0] = '\0';
    if (comparison->judged == 0)
        rt_append_text(out, size,
                       "Times are not judged: runs of one build differ, and to estimate by how much takes %u "
                       "accelerators on two scenes, or in two pairs of runs. --with needs neither. ",
                       RT_LEAST_ACCELS);
    if (!isnan(comparison->all_accels))
        rt_append_text(out, size,
                       "The median accelerator: %.3f; a change in clock speed would have the same effect. ",
                       comparison->all_accels);
    rt_append_text(out, size,
                   "Intervals of cells cover the rounds of these processes only, not how processes differ: "
                   "each holds with %.*g %%, all %" PRIu32 " together with %.3g %% confidence.",
                   comparison->coverage > 0.9999 ? 6 : 4, /* never 100 % */
                   100 * comparison->coverage, comparison->timed, 100 * comparison->together);
    if (comparison->coverage < each)
        rt_append_text(out, size, " 95 %% together takes %" PRIu32 " rounds before and after.",
                       rt_unpaired_rounds(each));
}

void rt_comparison_print(const RtComparison *comparison, FILE *out) {
    RtComparedRow row = {.comparison = comparison};
    RtTable cells = rt_comparison_table(&row, false, false), accels = rt_comparison_table(&row, true, false);
    char text[800];
    fprintf(out, "before: %s\nafter:  %s\n\n", comparison->before, comparison->after);
    rt_table_text(&cells, out);
    if (comparison->accel_count) fputc('\n', out);
    if (comparison->accel_count) rt_table_text(&accels, out);
    uint32_t changed = rt_comparison_changed(comparison);
    if (changed) fprintf(out, "\nCounts that changed:\n");
    print_changed_counts(comparison, out);
    fprintf(out,
            "\n%" PRIu32 " faster, %" PRIu32 " slower, %" PRIu32
            " with no difference found; counts changed in %" PRIu32 ".\n",
            rt_comparison_count(comparison, RT_CHANGE_FASTER),
            rt_comparison_count(comparison, RT_CHANGE_SLOWER),
            rt_comparison_count(comparison, RT_CHANGE_NONE), changed);
    const uint32_t other_rays = rt_comparison_count(comparison, RT_CHANGE_OTHER_RAYS);
    if (other_rays)
        fprintf(out,
                "The rays of %" PRIu32
                " cell%s are not the same in all results, so %s counts and times are not "
                "compared.\n",
                other_rays, rt_plural(other_rays), other_rays == 1 ? "its" : "their");
    print_plugins(comparison, out);
    print_instructions(comparison, out);
    explain_verdicts(comparison, text, sizeof text);
    if (*text) rt_print_wrapped(text, out);
    if (comparison->pairs == 0 || comparison->timed == 0) return;
    explain_directories(comparison, text, sizeof text);
    rt_print_wrapped(text, out);
}

json_t *rt_comparison_json(const RtComparison *comparison) {
    RtComparedRow row = {.comparison = comparison};
    RtTable cells = rt_comparison_table(&row, false, true), accels = rt_comparison_table(&row, true, true);
    return json_pack("{s:s, s:s, s:I, s:I, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "before",
                     comparison->before, "after", comparison->after, "rounds", (json_int_t)comparison->rounds,
                     "pairs", (json_int_t)comparison->pairs, "intervals", (json_int_t)comparison->timed,
                     "together", rt_json_number(comparison->together), "margin",
                     rt_json_number(comparison->margin), "seconds", rt_json_number(comparison->seconds),
                     "plugins", comparison->plugins ? json_incref(comparison->plugins) : json_object(),
                     "median_accelerator", rt_json_number(comparison->all_accels), "accelerators",
                     rt_table_json(&accels), "cells", rt_table_json(&cells));
}
