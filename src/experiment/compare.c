/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/compare.h"
#include "accel/columns.h"

#include "core/base/memory.h"
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
    for (uint32_t i = 0; i < comparison->count; i++) rt_free(comparison->cells[i].ratios);
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

/* ---- two directories ---- */

/* The candidate of `other` with the label of candidate `c`, on workload `t`; its candidate_count if there is
 * none. */
static uint32_t find_candidate(const RtResults *results, uint32_t c, const RtResults *other, uint32_t t) {
    const RtExperiment *e = other->experiment;
    uint32_t found = t == e->workload_count
                         ? e->candidate_count
                         : rt_candidate_find(e, results->experiment->candidates[c].label, t);
    return found < e->candidate_count ? found : e->candidate_count;
}

/* `swapped`: only looks for cells that are missing before. */
static RtStatus compare_cell(const RtResults *before, uint32_t t, uint32_t c, const RtResults *after,
                             RtRayKind kind, bool swapped, RtComparison *comparison, RtError *error) {
    const char *scene = before->experiment->workloads[t].label;
    const char *accel = before->experiment->candidates[c].label;
    const RtCell *one = rt_cell_at(before, t, c, kind);
    if (!one->counted && !one->timed) return RT_OK;
    RtComparedCell *cell = rt_comparison_cell(comparison, scene, accel, rt_ray_kind_name(kind));
    if (!cell) return rt_fail_memory(error, "a comparison", 0);
    uint32_t t2 = rt_workload_find(after->experiment, scene), c2 = find_candidate(before, c, after, t2);
    const RtCell *other = c2 < after->experiment->candidate_count ? rt_cell_at(after, t2, c2, kind) : NULL;
    cell->rays = one->tally.rays;
    if (!other || (!other->counted && !other->timed)) {
        cell->change = swapped ? RT_CHANGE_ONLY_AFTER : RT_CHANGE_ONLY_BEFORE;
        return RT_OK;
    }
    if (swapped) return RT_OK;
    if (before->workloads[t].ray_fingerprints[kind] != after->workloads[t2].ray_fingerprints[kind] ||
        before->workloads[t].scene != after->workloads[t2].scene || one->tally.rays != other->tally.rays) {
        cell->change = RT_CHANGE_OTHER_RAYS;
        return RT_OK;
    }
    cell->counted = one->counted && other->counted && rt_build_at(before, t, c)->counts &&
                    rt_build_at(after, t2, c2)->counts;
    cell->counts_before = one->tally;
    cell->counts = other->tally;
    if (!one->round_times || !other->round_times || one->threads != other->threads) return RT_OK;
    cell->timed = true;
    cell->cells[0] = one;
    cell->cells[1] = other;
    cell->before = one->seconds.median;
    cell->after = other->seconds.median;
    return RT_OK;
}

static RtStatus compare_all(const RtResults *before, const RtResults *after, bool swapped,
                            RtComparison *comparison, RtError *error) {
    const RtExperiment *e = before->experiment;
    for (uint32_t t = 0; t < e->workload_count; t++) {
        for (uint32_t c = 0; c < e->candidate_count; c++) {
            for (uint32_t k = 0; k < e->kind_count && rt_candidate_runs(e, c, t); k++) {
                RT_TRY(compare_cell(before, t, c, after, e->kinds[k], swapped, comparison, error));
            }
        }
    }
    return RT_OK;
}

RtStatus rt_compare_results(const RtResults *before, const RtResults *after, RtComparison *comparison,
                            RtError *error) {
    uint32_t timed = 0;
    RT_TRY(compare_all(before, after, false, comparison, error));
    RT_TRY(compare_all(after, before, true, comparison, error));
    for (uint32_t i = 0; i < comparison->count; i++) timed += comparison->cells[i].timed;
    for (uint32_t i = 0; i < comparison->count; i++) {
        RtComparedCell *cell = &comparison->cells[i];
        const RtCell *one = cell->cells[0], *other = cell->cells[1];
        if (!cell->timed) continue;
        RT_TRY(rt_estimate_unpaired(rt_cell_round_times(one, RT_ROUND_SECONDS), one->rounds,
                                    rt_cell_round_times(other, RT_ROUND_SECONDS), other->rounds,
                                    rt_coverage_of_each(timed), &cell->ratio, error));
    }
    rt_comparison_judge(comparison);
    return RT_OK;
}

/* ---- results ---- */

void rt_comparison_judge(RtComparison *comparison) {
    const double margin = 1 + comparison->margin;
    comparison->timed = 0;
    for (uint32_t i = 0; i < comparison->count; i++) {
        RtComparedCell *cell = &comparison->cells[i];
        if (!cell->timed) continue;
        comparison->timed++;
        cell->change = cell->ratio.low > margin        ? RT_CHANGE_FASTER
                       : cell->ratio.high < 1 / margin ? RT_CHANGE_SLOWER
                                                       : RT_CHANGE_NONE;
    }
}

uint32_t rt_comparison_count(const RtComparison *comparison, RtChange change) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < comparison->count; i++) count += comparison->cells[i].change == change;
    return count;
}

static bool counts_changed(const RtComparedCell *cell) {
    return cell->counted && memcmp(&cell->counts_before, &cell->counts, sizeof(RtTally)) != 0;
}

uint32_t rt_comparison_changed(const RtComparison *comparison) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < comparison->count; i++) count += counts_changed(&comparison->cells[i]);
    return count;
}

/* ---- as a table ---- */

typedef RtComparedRow Row;

#define TIMED(figure) (r->cell->timed ? (figure) : (double)NAN)

static RtField interval_of(const Row *r) {
    if (!r->cell->timed) return rt_field_missing();
    return rt_field_interval(r->cell->ratio.median, r->cell->ratio.low, r->cell->ratio.high);
}

static const void *tally_before(const void *row) {
    const Row *r = row;
    return r->cell->counted ? &r->cell->counts_before : NULL;
}

static const void *tally_after(const void *row) {
    const Row *r = row;
    return r->cell->counted ? &r->cell->counts : NULL;
}

#define COLUMNS(X)                                                                                           \
    X(scene, "scene", text, "", "the scene's label", r->cell->scene)                                         \
    X(accel, "accelerator", text, "", "the accelerator's label", r->cell->accel)                             \
    X(kind, "kind", text, "", "kind of the rays", r->cell->kind)                                             \
    X(interval, "ratio", interval, "", "throughput after over that before", interval_of(r))                  \
    X(change, "time", text, "", "faster, slower, or why that is unknown", change_names[r->cell->change])     \
    X(counts, "counts", text, "", "same or changed; null: unknown, or dependent on the machine",             \
      !r->cell->counted         ? NULL                                                                       \
      : counts_changed(r->cell) ? "changed"                                                                  \
                                : "same")                                                                    \
    X(rays, "rays", integer, "", "rays measured", r->cell->rays)                                             \
    X(ns_before, "ns_before", real6, "ns", "time per ray before; median", TIMED(1e9 * r->cell->before))      \
    X(ns_after, "ns_after", real6, "ns", "time per ray after; median", TIMED(1e9 * r->cell->after))          \
    X(ratio, "ratio", real6, "", "throughput after over that before; median", TIMED(r->cell->ratio.median))  \
    X(ratio_low, "ratio_low", end, "",                                                                       \
      "lower end of its interval; all intervals hold simultaneously with 95 % confidence",                   \
      TIMED(r->cell->ratio.low))                                                                             \
    X(ratio_high, "ratio_high", end, "", "upper end of its interval", TIMED(r->cell->ratio.high))

RT_TABLE_COLUMNS(columns, COLUMNS)

static const RtColumnGroup for_the_eye[] = {RT_FROM_TO(columns, scene, counts)};

static const RtColumnGroup in_full[] = {
    RT_FROM_TO(columns, scene, kind),
    RT_FROM_TO(columns, change, ratio_high),
    {"counts_before", rt_tally_columns, RT_TALLY_COUNTER_COUNT, tally_before},
    {"counts_after", rt_tally_columns, RT_TALLY_COUNTER_COUNT, tally_after},
};

static const void *row_at(void *context, size_t i) {
    Row *r = context;
    r->cell = &r->comparison->cells[i];
    return r;
}

RtTable rt_comparison_table(RtComparedRow *row, bool all) {
    RtTable table = all ? (RtTable){RT_GROUPS(in_full)} : (RtTable){RT_GROUPS(for_the_eye)};
    table.row_count = row->comparison->count;
    table.row = row_at;
    table.context = row;
    return table;
}

/* ---- text and JSON ---- */

static void print_changed_counts(const RtComparison *comparison, FILE *out) {
    for (uint32_t i = 0; i < comparison->count; i++) {
        const RtComparedCell *cell = &comparison->cells[i];
        if (!counts_changed(cell)) continue;
        fprintf(out, "%s %s %s:", cell->scene, cell->accel, cell->kind);
        for (size_t k = 0; k < RT_TALLY_COUNTER_COUNT; k++) {
            uint64_t before = rt_tally_get(&cell->counts_before, k), after = rt_tally_get(&cell->counts, k);
            if (before != after) fprintf(out, " %s %" PRIu64 " -> %" PRIu64, rt_tally_name(k), before, after);
        }
        fputc('\n', out);
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
    for (uint32_t i = 0; i < comparison->count; i++) {
        const RtComparedCell *cell = &comparison->cells[i];
        if (cell->timed) widest = fmax(widest, rt_estimate_width(&cell->ratio));
    }
    return widest;
}

void rt_comparison_print(const RtComparison *comparison, FILE *out) {
    RtComparedRow row = {.comparison = comparison};
    RtTable table = rt_comparison_table(&row, false);
    fprintf(out, "before: %s\nafter:  %s\n\n", comparison->before, comparison->after);
    rt_table_text(&table, out);
    uint32_t changed = rt_comparison_changed(comparison);
    if (changed) fprintf(out, "\nCounts that changed:\n");
    print_changed_counts(comparison, out);
    fprintf(out,
            "\n%" PRIu32 " faster, %" PRIu32 " slower, %" PRIu32 " no difference; counts changed in %" PRIu32
            ".\n",
            rt_comparison_count(comparison, RT_CHANGE_FASTER),
            rt_comparison_count(comparison, RT_CHANGE_SLOWER),
            rt_comparison_count(comparison, RT_CHANGE_NONE), changed);
    print_plugins(comparison, out);
    if (comparison->timed == 0) return;
    fprintf(out,
            "Ratios are of throughput. All %" PRIu32
            " intervals hold simultaneously with 95 %% confidence;\nthe widest is +-%.2g %%.",
            comparison->timed, 100 * widest_of(comparison));
    if (comparison->rounds)
        fprintf(out, " %" PRIu32 " round%s in %.0f s.", comparison->rounds, rt_plural(comparison->rounds),
                comparison->seconds);
    if (comparison->margin > 0)
        fprintf(out, " Smaller differences than %.3g %% are not reported.", 100 * comparison->margin);
    fputc('\n', out);
}

json_t *rt_comparison_json(const RtComparison *comparison) {
    RtComparedRow row = {.comparison = comparison};
    RtTable table = rt_comparison_table(&row, true);
    return json_pack("{s:s, s:s, s:I, s:I, s:o, s:o, s:o, s:o, s:o}", "before", comparison->before, "after",
                     comparison->after, "rounds", (json_int_t)comparison->rounds, "intervals",
                     (json_int_t)comparison->timed, "together", rt_json_number(0.95), "margin",
                     rt_json_number(comparison->margin), "seconds", rt_json_number(comparison->seconds),
                     "plugins", comparison->plugins ? json_incref(comparison->plugins) : json_object(),
                     "cells", rt_table_json(&table));
}
