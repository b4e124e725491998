/* SPDX-License-Identifier: Apache-2.0 */
/* A table is a list of groups of columns, and a function that returns its row of a number. Columns are listed
 * by macros, X(id, form, title, meaning, value), the value being an expression of the row; groups that
 * several tables have in common are written once. */
#include "results/result_tables.h"

#include "accel/columns.h"
#include "core/base/words.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

typedef RtResultRow Row;

/* ---- fields ---- */

static const RtCandidate *candidate_of(const Row *r) {
    const RtExperiment *e = r->results->experiment;
    return &e->candidates[rt_candidate_built(e, r->candidate)];
}

static uint64_t ray_stride_of(const Row *r) {
    return candidate_of(r)->ray_stride;
}

static RtField label_of(const Row *r) {
    RtField field = rt_field_text(rt_candidate_label(r->results->experiment, r->candidate));
    if (candidate_of(r)->member_count > 0) field.note = r->build->spec;
    if (ray_stride_of(r) > 1) field.note = "measured on a part of the rays";
    return field;
}

/* In tables to read, with a star if it is measured on a part of the rays. */
static RtField eye_label_of(const Row *r) {
    return rt_field_print("%s%s", r->shown, ray_stride_of(r) > 1 ? " *" : "");
}

/* A label too long to fit beside the figures is printed on a line before them. */
static bool is_long(const RtField *label) {
    enum { EYE_WIDTH = 24 };
    return strlen(label->buffer) > EYE_WIDTH;
}

static RtField short_label_of(const Row *r) {
    const RtField label = eye_label_of(r);
    return is_long(&label) ? rt_field_text(" ") : label;
}

static RtField estimate(const RtEstimate *e, double unit) {
    return rt_field_interval(e->median / unit, e->low / unit, e->high / unit);
}

RtField rt_build_ms(const RtBuildResult *build) {
    if (!build->known) return rt_field_missing();
    if (build->builds < 2) return rt_field_real(1e3 * build->seconds.median);
    return estimate(&build->seconds, 1e-3);
}

static RtField break_even_of(const Row *r) {
    const RtBreakEven even = rt_results_break_even(r->results, r->workload, r->candidate);
    const RtEstimate *rays = &even.rays;
    const bool rough = even.builds < 2, certain = rough || rays->low == rays->high;
    char text[RT_MAX_FIELD];
    if (isnan(rays->median)) return rt_field_missing();
    if (certain && (rays->median == 0 || isinf(rays->median)))
        return rt_field_text((rays->median == 0) == even.up_to ? "never faster" : "always faster");
    if (!rough && rays->low == 0 && isinf(rays->high)) return rt_field_text("undecided");
    /* By the medians always; so the ends of the intervals that say less. */
    if (even.up_to && isinf(rays->median)) {
        rt_format_rough(rays->low, text);
        return rt_field_print("faster, at least up to %s", text);
    }
    if (!even.up_to && rays->median == 0) {
        rt_format_rough(rays->high, text);
        return rt_field_print("faster from %s at the latest", text);
    }
    const bool doubtful = even.up_to ? rays->median == 0 : isinf(rays->median); /* not by the medians */
    if (doubtful)
        rt_format_rough(even.up_to ? rays->high : rays->low, text);
    else if (rough)
        rt_format_rough(rays->median, text);
    else
        rt_format_interval(rays->median, rays->low, rays->high, text);
    return rt_field_print("%s %s %.100s", doubtful ? "perhaps" : "faster", even.up_to ? "up to" : "from",
                          text);
}

/* A counter; missing if its value per ray is unknown. */
static RtField known(uint64_t counter, double a_ray) {
    return isnan(a_ray) ? rt_field_missing() : rt_field_integer(counter);
}

/* NULL of a row of a refused accelerator. */
static const void *measured_of(const void *row) {
    return ((const Row *)row)->cell->counted || ((const Row *)row)->cell->timed ? row : NULL;
}

static const void *tally_of(const void *row) {
    return measured_of(row) ? &((const Row *)row)->cell->tally : NULL;
}

static const void *known_tally_of(const void *row) {
    return isnan(((const Row *)row)->cost.object_tests) ? NULL : tally_of(row);
}

static const void *structure_of(const void *row) {
    const RtBuildResult *build = ((const Row *)row)->build;
    return build->known ? &build->structure : NULL;
}

static const void *build_of(const void *row) {
    const RtBuildResult *build = ((const Row *)row)->build;
    return build->known ? &build->structure.build : NULL;
}

/* Frames have their own rounds, and so their own machine and threads. */
static const RtMachine *machine_of(const Row *r) {
    return &r->results->machines[r->which == RT_RENDERED ? r->build->render.machine : r->cell->machine];
}

static uint32_t threads_of(const Row *r) {
    return (uint32_t)(r->which == RT_RENDERED ? r->build->render.threads : r->cell->threads);
}

/* NULL of leaves. */
static const char *kind_of(const Row *r) {
    return r->quantity < RT_RAY_QUANTITY_COUNT ? rt_experiment_kind_name(r->results->experiment, r->kind)
                                               : NULL;
}

static double count_of(const Row *r) {
    return (double)r->distribution->count;
}

static double ns_of_round(const Row *r, RtRoundTime which) {
    return 1e9 * rt_cell_round_times(r->cell, which)[r->round];
}

/* ---- columns ---- */

#define OVER_RAYS(quantity)   (&r->cell->distributions[RT_QUANTITY_##quantity])
#define OVER_LEAVES(quantity) (&r->build->leaves[RT_QUANTITY_##quantity])
#define RENDER(part)          (r->build->render.part)
#define TIMED(figure)         (r->cell->timed ? (figure) : (double)NAN)

/* What a distribution shows. */
#define VALUES(X, id, title, half, most_of, of)                                                              \
    X(id##_median, title ": 50 %", integer, "", half, (of)->median)                                          \
    X(id##_p99, "99 %", integer, "", "that 99 % do not exceed", (of)->p99)                                   \
    X(id##_most, "max", integer, "", most_of, (of)->most)

/* A measurement with its interval, in three columns. */
#define ESTIMATE(X, id, unit, meaning, factor, e)                                                            \
    X(id, #id, real6, unit, meaning "; median", (factor) * (e).median)                                       \
    X(id##_low, #id "_low", real6, unit, "lower end of its interval", (factor) * (e).low)                    \
    X(id##_high, #id "_high", real6, unit, "upper end of its interval", (factor) * (e).high)

#define COLUMNS(X)                                                                                           \
    X(scene, "scene", text, "", "the scene's label", r->setup->label)                                        \
    X(scene_spec, "scene_spec", text, "", "the scene as it is opened: a file, or a built-in",                \
      r->setup->spec)                                                                                        \
    X(objects, "objects", integer, "", "objects in the scene", r->scene->objects)                            \
    X(scene_hash, "scene_hash", hash, "", "fingerprint of the scene", r->scene->scene)                       \
    X(width, "width", integer, "pixels", "width of the frame whose rays are recorded", r->scene->width)      \
    X(height, "height", integer, "pixels", "height of the frame", r->scene->height)                          \
    X(corners, "corners", flag, "", "samples at pixel corners, not centres", r->setup->corners)              \
    X(depth, "depth", integer, "", "levels of the ray tree; the primary ray is the first", r->setup->depth)  \
    X(kind, "kind", text, "", "kind of the rays", kind_of(r))                                                \
    X(set_rays, "set_rays", integer, "", "rays in the set, after the limit", r->scene->rays[r->kind])        \
    X(set_hash, "set_hash", hash, "", "fingerprint of the set", r->scene->ray_fingerprints[r->kind])         \
    X(accel, "accel", text, "", "the accelerator's label; (again): a null run", label_of(r))                 \
    X(spec, "spec", text, "", "the accelerator with every effective parameter", r->build->spec)              \
    X(ray_stride, "ray_stride", integer, "", "k, if only every kth ray of the set is measured",              \
      ray_stride_of(r))                                                                                      \
    X(rays, "rays", integer, "", "rays measured", r->cost.rays)                                              \
    X(hits, "hits", integer, "", "those that hit an object", r->cell->tally.hits)                            \
    X(build_seconds, "build_seconds", real6, "s", "time to build; median", r->build->seconds.median)         \
    X(build_low, "build_low", real6, "s", "lower end of its interval", r->build->seconds.low)                \
    X(build_high, "build_high", real6, "s", "upper end of its interval", r->build->seconds.high)             \
    X(builds, "builds", integer, "",                                                                         \
      "builds timed, after a warm-up; fewer than 6 have no interval of 95 %, one has none; 0: unknown",      \
      r->build->builds)                                                                                      \
    X(build_threads, "build_threads", integer, "", "threads of the builds; 0: unknown", r->build->threads)   \
    X(bytes, "bytes", integer, "bytes", "memory of the structure's arrays", r->build->structure.bytes)       \
    X(threads, "threads", integer, "", "threads of the timing", threads_of(r))                               \
    X(rounds, "rounds", integer, "", "timing rounds", r->cell->rounds)                                       \
    X(repeats, "repeats", real6, "", "passes over the rays in a round", TIMED(r->cell->repeats))             \
    X(structures, "structures", integer, "",                                                                 \
      "structures built anew that its rounds timed in turns; 0: unknown", r->cell->structures)               \
    X(learnt, "learnt", real6, "",                                                                           \
      "time with other rays between its passes, over time without; above 1.05, caches and branch "           \
      "predictors have learnt the rays; empty: not checked",                                                 \
      TIMED(r->cell->learnt))                                                                                \
    X(coverage, "coverage", real6, "", "probability that an interval contains the median",                   \
      TIMED(rt_interval_coverage(r->cell->rounds)))                                                          \
    ESTIMATE(X, ns, "ns", "processor time per ray (wall time on several threads)", 1e9, r->cell->seconds)    \
    X(ns_min, "ns_min", real6, "ns", "smallest time", 1e9 * r->cell->seconds.least)                          \
    ESTIMATE(X, wall_ns, "ns", "wall time per ray", 1e9, r->cell->wall)                                      \
    X(mrays_per_s, "mrays_per_s", real6, "million/s", "rays per second, by the median",                      \
      1e-6 / r->cost.seconds.median)                                                                         \
    X(baseline, "baseline", text, "", "the accelerator that the ratio refers to",                            \
      r->cell->timed ? rt_candidate_label(r->results->experiment, r->cell->baseline) : NULL)                 \
    X(ratio, "ratio", real6, "", "throughput over the baseline's, paired by round; median",                  \
      r->cost.ratio.median)                                                                                  \
    X(ratio_low, "ratio_low", end, "", "lower end of its interval", r->cost.ratio.low)                       \
    X(ratio_high, "ratio_high", end, "", "upper end of its interval", r->cost.ratio.high)                    \
    X(straddles_1, "straddles_1", flag, "", "whether the interval contains 1, as it should in a null run",   \
      rt_field_flag(rt_estimate_holds(&r->cell->ratio, 1)))                                                  \
    X(object_tests, "object_tests", integer, "", "object tests counted here; empty: not known",              \
      known(r->cell->tally.object_tests, r->cost.object_tests))                                              \
    X(extent_tests, "extent_tests", integer, "", "extent tests counted here; empty: not known",              \
      known(r->cell->tally.extent_tests, r->cost.extent_tests))                                              \
    X(steps, "steps", integer, "", "steps counted here; empty: not known",                                   \
      known(r->cell->tally.steps, r->cost.steps))                                                            \
    X(differ, "differ", integer, "", "answers that differ from the reference; 0 if exact", r->cell->differ)  \
    X(refused, "refused", text, "",                                                                          \
      "why the accelerator refuses the scene (memory, a limit of its own); empty: it does not. The row "     \
      "then "                                                                                                \
      "has no rays",                                                                                         \
      r->build->refused ? r->build->left_out : NULL)                                                         \
    X(host, "host", text, "", "host of the measurement", machine_of(r)->host)                                \
    X(cpu, "cpu", text, "", "its processor", machine_of(r)->cpu)                                             \
    X(render_rounds, "rounds", integer, "", "frames rendered for the times", RENDER(rounds))                 \
    ESTIMATE(X, render_ms, "ms",                                                                             \
             "time to render the frame: rays, queries and illumination; processor time (wall time on "       \
             "several threads)",                                                                             \
             1e3, RENDER(seconds))                                                                           \
    ESTIMATE(X, query_share, "", "part of it spent in queries of the accelerator", 1, RENDER(share))         \
    X(eye_render, "ms/frame", interval, "ms", "time to render the frame", estimate(&RENDER(seconds), 1e-3))  \
    X(eye_share, "% in queries", interval, "%", "part of it spent in queries",                               \
      estimate(&RENDER(share), 1e-2))                                                                        \
    X(tests_a_ray, "tests/ray", figure, "", "object tests per ray", r->cost.object_tests)                    \
    X(extents_a_ray, "ext./ray", figure, "", "extent tests per ray", r->cost.extent_tests)                   \
    X(steps_a_ray, "steps/ray", figure, "", "steps per ray", r->cost.steps)                                  \
    X(ns_a_ray, "ns/ray", figure, "ns", "median time per ray", 1e9 * r->cost.seconds.median)                 \
    X(ns_interval, "ns/ray", interval, "ns", "median time per ray, with its interval",                       \
      estimate(&r->cost.seconds, 1e-9))                                                                      \
    X(label, "accelerator", text, "", "the label", label_of(r))                                              \
    X(shown, "accelerator", text, "", "the label, shortened if it is long", r->shown)                        \
    X(eye_label, "accelerator", text, "", "the label, if there is room", short_label_of(r))                  \
    X(eye_tests, "tests", figure, "", "object tests per ray", r->cost.object_tests)                          \
    X(eye_extents, "ext.", figure, "", "extent tests per ray", r->cost.extent_tests)                         \
    X(eye_steps, "steps", figure, "", "steps per ray", r->cost.steps)                                        \
    X(mrays, "Mrays/s", figure, "million/s", "throughput", 1e-6 / r->cost.seconds.median)                    \
    X(interval, "ratio", interval, "", "throughput over the baseline's", estimate(&r->cost.ratio, 1))        \
    X(build_ms, "build ms", interval, "ms", "time to build the structure, with its interval",                \
      rt_build_ms(r->build))                                                                                 \
    X(mb, "MB", amount, "MB", "memory of the structure",                                                     \
      r->build->known ? 1e-6 * (double)r->build->structure.bytes : (double)NAN)                              \
    X(break_even, "break-even (rays)", text, "rays",                                                         \
      "the number of rays, with its interval, for which it takes less time than the baseline, including "    \
      "both builds",                                                                                         \
      break_even_of(r))                                                                                      \
    X(min_ns, "min ns", figure, "ns", "smallest time per ray", 1e9 * r->cost.seconds.least)                  \
    X(msteps_per_s, "msteps_per_s", real6, "million/s", "steps per second: mrays_per_s times steps per ray", \
      1e-6 * r->cost.steps / r->cost.seconds.median)                                                         \
    X(mtests_per_s, "mtests_per_s", real6, "million/s",                                                      \
      "object tests per second: mrays_per_s times object tests per ray",                                     \
      1e-6 * r->cost.object_tests / r->cost.seconds.median)                                                  \
    VALUES(X, tests, "tests", "object tests that half of the rays do not exceed",                            \
           "of the ray that has most", OVER_RAYS(object_tests))                                              \
    VALUES(X, steps, "steps", "steps that half of the rays do not exceed", "of the ray that has most",       \
           OVER_RAYS(steps))                                                                                 \
    VALUES(X, size, "leaf size", "objects that half of the leaves do not exceed", "of the largest",          \
           OVER_LEAVES(leaf_size))                                                                           \
    VALUES(X, depth, "depth", "depth that half of the leaves do not exceed", "of the deepest",               \
           OVER_LEAVES(leaf_depth))                                                                          \
    X(round, "round", integer, "", "number of the round, from 1", r->round + 1)                              \
    X(round_ns, "ns", real6, "ns", "processor time per ray in this round (wall time on several threads)",    \
      ns_of_round(r, RT_ROUND_SECONDS))                                                                      \
    X(round_wall_ns, "wall_ns", real6, "ns", "wall time per ray", ns_of_round(r, RT_ROUND_WALL))             \
    X(round_baseline_ns, "baseline_ns", real6, "ns",                                                         \
      "time per ray of the baseline in this round, on the same rays; divided by round_ns it is the ratio",   \
      ns_of_round(r, RT_ROUND_BASELINE))                                                                     \
    X(quantity, "quantity", text, "",                                                                        \
      "object_tests, extent_tests, steps: per ray, each traced alone; leaf_size, leaf_depth, without a "     \
      "kind: objects in "                                                                                    \
      "the list of a leaf or voxel, and its depth",                                                          \
      rt_quantity_name(r->quantity))                                                                         \
    X(count, "count", integer, "", "rays, or leaves", r->distribution->count)                                \
    X(mean, "mean", real6, "", "mean of the quantity", (double)r->distribution->sum / count_of(r))           \
    X(median, "median", integer, "", "the smallest value that half of them do not exceed",                   \
      r->distribution->median)                                                                               \
    X(p90, "p90", integer, "", "the smallest that 90 % do not exceed", r->distribution->p90)                 \
    X(p99, "p99", integer, "", "the smallest that 99 % do not exceed", r->distribution->p99)                 \
    X(p999, "p999", integer, "", "the smallest that 99.9 % do not exceed", r->distribution->p999)            \
    X(max, "max", integer, "", "the largest value", r->distribution->most)                                   \
    X(low, "low", integer, "", "smallest value of the bin", rt_histogram_low(r->bin))                        \
    X(end, "end", integer, "", "smallest value above the bin", rt_histogram_low(r->bin + 1))                 \
    X(values, "values", integer, "", "rays, or leaves, within it", r->distribution->bins[r->bin])            \
    X(part, "part", real6, "", "as a fraction of all", (double)r->distribution->bins[r->bin] / count_of(r))

RT_TABLE_COLUMNS(columns, COLUMNS)

/* ---- tables ---- */

#define FROM_TO(first, last) RT_FROM_TO(columns, first, last)
#define ONE(id)              RT_ONE(columns, id)
#define MEASURED(first, last)                                                                                \
    { NULL, &columns[AT_##first], AT_##last - AT_##first + 1, measured_of }

/* What tables are and have. */
enum {
    ALL_SCENES = 1, /* by workload, then accelerator with the null run last, then kind; else one workload, by
                       kind, then accelerator */
    ALL_KINDS = 2,  /* a row is of all kinds of rays together */
    SWEPT = 4,      /* a column for each swept parameter */
    BEST = 8,       /* marks of the best */
    REFUSED = 16,   /* a column that says why rows are refused, if any are */
    QUANTITIES = 32 /* by workload, then accelerator, then the quantities over each kind of rays, then those
                       over leaves */
};

/* X(TABLE, what it is and has, which rows it has, its columns...) */
#define TABLES(X)                                                                                            \
    X(COUNTS, ALL_SCENES | SWEPT | REFUSED, !best && ((counted && r->build->counts) || refused),             \
      FROM_TO(scene, ray_stride), MEASURED(rays, rays),                                                      \
      {NULL, rt_tally_columns + 1, RT_TALLY_COUNTER_COUNT - 1, tally_of},                                    \
      {NULL, rt_structure_columns, RT_STRUCTURE_COUNTS, structure_of}, MEASURED(bytes, bytes),               \
      {NULL, rt_structure_columns + RT_STRUCTURE_COUNTS, RT_PREDICTION_COLUMNS, structure_of})               \
    X(TIMES, ALL_SCENES | SWEPT | REFUSED, timed || refused, FROM_TO(scene, ray_stride),                     \
      MEASURED(rays, rays), MEASURED(threads, ratio_high), MEASURED(build_seconds, bytes),                   \
      MEASURED(object_tests, differ),                                                                        \
      {NULL, rt_structure_columns + RT_STRUCTURE_COUNTS, RT_PREDICTION_COLUMNS, structure_of},               \
      MEASURED(host, cpu))                                                                                   \
    X(ROUNDS, ALL_SCENES | SWEPT, !best && timed && r->cell->round_times && r->round < r->cell->rounds,      \
      ONE(scene), ONE(kind), ONE(accel), ONE(baseline), FROM_TO(round, round_baseline_ns))                   \
    X(RENDERED, ALL_SCENES | SWEPT, !best && r->build->render.known && r->kind == e->kinds[0],               \
      FROM_TO(scene, objects), FROM_TO(width, depth), FROM_TO(accel, spec), ONE(threads),                    \
      FROM_TO(render_rounds, query_share_high), FROM_TO(host, cpu))                                          \
    X(DISTRIBUTIONS, QUANTITIES, !best, ONE(scene), ONE(kind), ONE(accel), ONE(quantity), ONE(spec),         \
      FROM_TO(count, max))                                                                                   \
    X(HISTOGRAMS, QUANTITIES, !best, ONE(scene), ONE(kind), ONE(accel), ONE(quantity), FROM_TO(low, part))   \
    X(BENCH, SWEPT, (counted && !null) || refused, FROM_TO(scene, scene_spec), FROM_TO(accel, ray_stride),   \
      ONE(kind), ONE(refused), MEASURED(rays, bytes),                                                        \
      {"structure", rt_structure_columns, RT_STRUCTURE_COLUMNS, structure_of},                               \
      {"structure.build", rt_tally_columns, RT_TALLY_COUNTER_COUNT, build_of},                               \
      {"counts", rt_tally_columns, RT_TALLY_COUNTER_COUNT, known_tally_of}, MEASURED(differ, differ),        \
      MEASURED(threads, mrays_per_s), MEASURED(msteps_per_s, mtests_per_s), MEASURED(baseline, ratio_high))  \
    X(NULL_RUNS, 0, (timed && null), FROM_TO(scene, scene_spec), ONE(kind), FROM_TO(accel, spec), ONE(rays), \
      FROM_TO(build_seconds, straddles_1))                                                                   \
    X(CELLS, 0, (counted || timed) && !is_tried(r, r->cell), FROM_TO(eye_label, interval))                   \
    X(STRUCTURES, 0, (first && is_shown(r)), ONE(eye_label), FROM_TO(build_ms, break_even))                  \
    X(COUNTED_CELLS, 0, counted, FROM_TO(eye_label, eye_steps))                                              \
    X(COUNTED_STRUCTURES, 0, (first && is_shown(r)), ONE(eye_label), ONE(mb),                                \
      {NULL, rt_structure_columns, RT_STRUCTURE_COUNTS, structure_of})                                       \
    X(PERCENTILES, 0, !best && r->cell->distributions && !isnan(r->cost.object_tests), ONE(eye_label),       \
      FROM_TO(tests_median, steps_most))                                                                     \
    X(LEAF_PERCENTILES, 0, first && !best && r->build->leaves, ONE(eye_label),                               \
      FROM_TO(size_median, depth_most))                                                                      \
    X(RENDER_ROWS, 0, (first && !best && r->build->render.known), ONE(eye_label),                            \
      FROM_TO(eye_render, eye_share))                                                                        \
    X(CELLS_MORE, BEST, (counted || timed) && !is_tried(r, r->cell), ONE(label), ONE(kind), ONE(rays),       \
      FROM_TO(tests_a_ray, steps_a_ray), ONE(ns_interval), FROM_TO(mrays, interval), ONE(min_ns),            \
      ONE(differ))                                                                                           \
    X(TOTALS, ALL_KINDS | BEST, first && has_total(r), ONE(shown), ONE(rays),                                \
      FROM_TO(tests_a_ray, ns_a_ray), FROM_TO(interval, break_even))                                         \
    X(TOTALS_MORE, ALL_KINDS | BEST, first && has_total(r), ONE(label), ONE(rays),                           \
      FROM_TO(tests_a_ray, steps_a_ray), ONE(ns_interval), FROM_TO(interval, break_even))

static const struct {
    int has;
    RtTable table;
} tables[] = {
#define GROUPS(...) ((const RtColumnGroup[]){__VA_ARGS__})
#define TABLE(id, has, rows, ...)                                                                            \
    [RT_##id] = {has,                                                                                        \
                 {.groups = GROUPS(__VA_ARGS__),                                                             \
                  .group_count = sizeof(GROUPS(__VA_ARGS__)) / sizeof(RtColumnGroup)}},
    TABLES(TABLE)
#undef TABLE
};

/* ---- rows ---- */

/* Rows of RT_DISTRIBUTIONS for one candidate. */
static size_t quantities_of(const RtExperiment *e) {
    return (size_t)e->kind_count * RT_RAY_QUANTITY_COUNT + RT_LEAF_QUANTITY_COUNT;
}

/* Of quantities: false if the row has no values. */
static bool find_quantity(Row *r, size_t i) {
    const RtExperiment *e = r->results->experiment;
    const size_t over_rays = quantities_of(e) - RT_LEAF_QUANTITY_COUNT, at = i % quantities_of(e);
    const bool of_rays = at < over_rays, bins = r->which == RT_HISTOGRAMS;
    r->quantity = of_rays ? at % RT_RAY_QUANTITY_COUNT : RT_RAY_QUANTITY_COUNT + at - over_rays;
    const RtDistribution *list = of_rays ? r->cell->distributions : r->build->leaves;
    r->distribution = list ? &list[of_rays ? r->quantity : at - over_rays] : NULL;
    if (!r->build->counts || !r->distribution || r->distribution->count == 0) return false;
    return !bins || r->distribution->bins[r->bin] > 0;
}

static bool find(Row *r, size_t i) {
    const RtExperiment *e = r->results->experiment;
    const int has = tables[r->which].has;
    const size_t kinds = e->kind_count, candidates = e->candidate_count + !(has & QUANTITIES);
    if (r->which == RT_ROUNDS) {
        r->round = (uint32_t)(i % r->most_rounds);
        i /= r->most_rounds;
    }
    if (r->which == RT_HISTOGRAMS) {
        r->bin = (uint32_t)(i % RT_HISTOGRAM_BINS);
        i /= RT_HISTOGRAM_BINS;
    }
    size_t kind = i / candidates, candidate = i;
    if (has & (ALL_SCENES | QUANTITIES)) {
        const size_t rows = has & QUANTITIES ? quantities_of(e) : kinds;
        kind = has & QUANTITIES ? i % rows / RT_RAY_QUANTITY_COUNT : i % rows;
        candidate = i / rows;
        r->workload = (uint32_t)(candidate / candidates);
    }
    r->kind = e->kinds[kind < kinds ? kind : 0];
    r->candidate = (uint32_t)(candidate % candidates);
    r->setup = &e->workloads[r->workload];
    r->scene = &r->results->workloads[r->workload];
    const uint32_t chosen =
        has & ALL_KINDS ? r->candidate : rt_results_candidate(r->results, r->workload, r->candidate, r->kind);
    r->build = rt_build_at(r->results, r->workload, chosen);
    r->cell = rt_cell_at(r->results, r->workload, chosen, r->kind);
    return !(has & QUANTITIES) || find_quantity(r, i);
}

/* Whether the candidate is only a member of a best-of, whose row shows what was chosen. */
static bool is_tried(const Row *r, const RtCell *cell) {
    return cell->timed && candidate_of(r)->tried && r->candidate < r->results->experiment->candidate_count;
}

/* Whether any cell of the candidate is shown. */
static bool is_shown(const Row *r) {
    if (candidate_of(r)->member_count > 0) return false;
    for (uint32_t k = 0; k < r->results->experiment->kind_count; k++) {
        const RtCell *cell =
            rt_cell_at(r->results, r->workload, r->candidate, r->results->experiment->kinds[k]);
        if ((cell->counted || cell->timed) && !is_tried(r, cell)) return true;
    }
    return false;
}

/* Of a best-of each kind of rays has its own structure. */
static bool has_total(const Row *r) {
    return candidate_of(r)->member_count > 0 ? !isnan(r->cost.seconds.median)
                                             : r->build->known && !candidate_of(r)->tried;
}

/* The kinds of rays that the costs of a row are of. */
static RtRayKind kinds_of(const Row *r) {
    return tables[r->which].has & ALL_KINDS ? RT_ALL_RAYS : r->kind;
}

static const void *row_at(void *context, size_t i) {
    Row *r = context;
    if (!find(r, i)) return NULL;
    const RtExperiment *e = r->results->experiment;
    const bool null = r->candidate == e->candidate_count, first = i < e->candidate_count;
    const bool counted = r->cell->counted, timed = r->cell->timed;
    const bool best = candidate_of(r)->member_count > 0;
    const bool refused = !null && r->build->refused && r->results->refusals >= 0 && r->scene->rays[r->kind];
    r->cost = rt_results_cost(r->results, r->workload, r->candidate, kinds_of(r));
    rt_candidate_show(e, r->candidate, r->shown);
    const bool there[] = {
#define ROWS(id, has, rows, ...) [RT_##id] = rows,
        TABLES(ROWS)
#undef ROWS
    };
    return there[r->which] ? r : NULL;
}

static RtStanding standing_of(const void *row) {
    const Row *r = row;
    return rt_standing(r->results, r->workload, r->candidate, kinds_of(r));
}

/* ---- columns that depend on the results ---- */

static void add_group(RtTable *table, Row *row, RtColumnGroup group) {
    assert(table->group_count < RT_MAX_RESULT_GROUPS);
    memmove(row->groups, table->groups, table->group_count * sizeof *row->groups);
    row->groups[table->group_count++] = group;
    table->groups = row->groups;
}

static RtField get_swept(const void *row, const RtTableColumn *column) {
    const Row *r = row;
    const RtSweptKey *key = &r->swept[column->key];
    const char *value = rt_swept_of(r->results->experiment, key, r->workload, r->candidate);
    double number;
    if (!value || !key->number) return rt_field_text(value);
    return rt_swept_number(value, &number) ? rt_field_real(number) : rt_field_missing();
}

/* Appends a column for each swept parameter; the columns before are the same in all experiments. */
static void add_swept(RtTable *table, Row *row) {
    row->swept_count = rt_experiment_swept(row->results->experiment, row->swept);
    for (uint32_t i = 0; i < row->swept_count; i++) {
        const RtSweptKey *key = &row->swept[i];
        char *name = row->swept_names[i];
        snprintf(name, sizeof row->swept_names[i], "%s.%s", key->scene ? "scene" : "accel", key->key);
        row->swept_columns[i] = (RtTableColumn){.id = name,
                                                .name = name,
                                                .unit = "",
                                                .meaning = "the swept parameter",
                                                .get = get_swept,
                                                .form = key->number ? RT_FORM_real9 : RT_FORM_text,
                                                .key = (int)i};
    }
    if (row->swept_count)
        add_group(table, row, (RtColumnGroup){NULL, row->swept_columns, row->swept_count, NULL});
}

/* Appends the column of reasons if there are any: files without are those of version 1.0. */
static void add_refused(RtTable *table, Row *row) {
    const RtExperiment *e = row->results->experiment;
    bool any = row->results->refusals > 0;
    for (uint32_t t = 0; t < e->workload_count; t++) {
        for (uint32_t c = 0; c < e->candidate_count; c++) any |= rt_build_at(row->results, t, c)->refused;
    }
    if (any && row->results->refusals >= 0) add_group(table, row, (RtColumnGroup)ONE(refused));
}

/* Of any cell. */
static uint32_t most_rounds(const RtResults *results) {
    uint32_t most = 0, least;
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        const uint32_t rounds = rt_results_rounds(results, t, &least);
        most = rounds > most ? rounds : most;
    }
    return most;
}

bool rt_result_table_sweeps(RtResultTable which) {
    return tables[which].has & SWEPT;
}

/* A heading before the rows of each kind of rays, and long labels on their own lines. */
static void put_above(void *context, const void *current, FILE *out) {
    Row *r = context;
    const bool by_kind = r->which == RT_CELLS || r->which == RT_COUNTED_CELLS || r->which == RT_PERCENTILES;
    const RtField label = eye_label_of(r);
    if (!current) r->headed = 0;
    if (!current) return;
    if (by_kind && r->headed != 1 + (uint32_t)r->kind) {
        const uint64_t rays = r->scene->rays[r->kind];
        fprintf(out, "  %s, %" PRIu64 " ray%s\n", rt_experiment_kind_name(r->results->experiment, r->kind),
                rays, rt_plural(rays));
        r->headed = 1 + (uint32_t)r->kind;
    }
    if (is_long(&label)) fprintf(out, "%s\n", label.buffer);
}

RtTable rt_result_table(RtResultTable which, RtResultRow *row) {
    const RtExperiment *e = row->results->experiment;
    const int has = tables[which].has;
    RtTable table = tables[which].table;
    table.row_count = has & QUANTITIES ? e->candidate_count * quantities_of(e)
                                       : ((size_t)e->candidate_count + 1) * e->kind_count;
    if (has & (ALL_SCENES | QUANTITIES)) table.row_count *= e->workload_count;
    if (which == RT_ROUNDS) row->most_rounds = most_rounds(row->results);
    if (which == RT_ROUNDS) table.row_count *= row->most_rounds;
    if (which == RT_HISTOGRAMS) table.row_count *= RT_HISTOGRAM_BINS;
    table.row = row_at;
    table.above = table.groups->columns == &columns[AT_eye_label] ? put_above : NULL;
    table.context = row;
    table.standing = has & BEST ? standing_of : NULL;
    row->which = which;
    if (has & REFUSED) add_refused(&table, row);
    if (has & SWEPT) add_swept(&table, row);
    return table;
}
