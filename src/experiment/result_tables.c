/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/result_tables.h"

#include "accel/columns.h"
#include "experiment/standing.h"

#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

typedef RtResultRow Row;

/* ---- fields ---- */

/* How often a candidate is measured; the null run is the baseline once more. */
static uint64_t ray_stride_of(const Row *r) {
    const RtExperiment *e = r->results->experiment;
    return e->candidates[r->candidate < e->candidate_count ? r->candidate : e->baseline].ray_stride;
}

static RtField label_of(const Row *r) {
    RtField field = rt_field_text(rt_candidate_label(r->results->experiment, r->candidate));
    if (ray_stride_of(r) > 1) field.note = "measured on a part of the rays";
    return field;
}

static const char *kind_of(const Row *r) {
    return rt_experiment_kind_name(r->results->experiment, r->kind);
}

/* A label that is too long to stand beside figures stands on a line before them. */
static RtField short_label_of(const Row *r) {
    char label[RT_MAX_EYE_LABEL];
    rt_result_eye_label(r, label);
    return rt_field_print("%s", strlen(label) > RT_EYE_WIDTH ? " " : label);
}

static RtField ratio_of(const Row *r) {
    bool ends = r->which != RT_TOTALS && r->which != RT_TOTALS_MORE;
    return rt_field_interval(r->all.ratio, ends ? r->cell->ratio.low : (double)NAN,
                             ends ? r->cell->ratio.high : (double)NAN);
}

static RtField pay_off_of(const Row *r) {
    double rays = rt_results_pay_off(r->results, r->workload, r->candidate);
    return isnan(rays)   ? rt_field_missing()
           : isinf(rays) ? rt_field_text("never")
           : rays == 0   ? rt_field_text("always")
                         : rt_field_print(rays > 0 ? "from %.3g" : "to %.3g", 1e-6 * fabs(rays));
}

static RtField ns_of(const Row *r) {
    const bool total = r->which == RT_TOTALS_MORE;
    return rt_field_interval(1e9 * r->all.seconds, 1e9 * (total ? r->all.seconds_low : r->cell->seconds.low),
                             1e9 * (total ? r->all.seconds_high : r->cell->seconds.high));
}

static RtField baseline_of(const Row *r) {
    if (!r->cell->timed) return rt_field_missing();
    return rt_field_text(rt_candidate_label(r->results->experiment, r->cell->baseline));
}

void rt_result_eye_label(const RtResultRow *r, char out[RT_MAX_EYE_LABEL]) {
    snprintf(out, RT_MAX_EYE_LABEL, "%s%s", rt_candidate_label(r->results->experiment, r->candidate),
             ray_stride_of(r) > 1 ? " *" : "");
}

/* A counter, unless it is not known how often it counted a ray. */
static RtField known(uint64_t counter, double a_ray) {
    return isnan(a_ray) ? rt_field_missing() : rt_field_integer(counter);
}

static const void *tally_of(const void *row) {
    return &((const Row *)row)->cell->tally;
}

static const void *known_tally_of(const void *row) {
    return isnan(((const Row *)row)->all.object_tests) ? NULL : tally_of(row);
}

static const void *structure_of(const void *row) {
    return &((const Row *)row)->build->shape;
}

static const void *build_of(const void *row) {
    return &((const Row *)row)->build->shape.build;
}

static double each_ns(const Row *r, RtEach each) {
    return 1e9 * rt_cell_rounds(r->cell, each)[r->round];
}

/* ---- columns ---- */

#define SPREAD(quantity) (&r->cell->distributions[RT_QUANTITY_##quantity])
#define LEAVES(quantity) (&r->build->leaves[RT_QUANTITY_##quantity])
#define MACHINE(name)    (r->cell->hardware.counts.of[RT_HARDWARE_##name])
#define TIMED(figure)    (r->cell->timed ? (figure) : (double)NAN)

#define COLUMNS(X)                                                                                           \
    X(scene, "scene", text, "", "the scene's label in the experiment", r->setup->label)                      \
    X(scene_spec, "scene", text, "", "the scene as it is opened: a file, or a built-in", r->setup->spec)     \
    X(objects, "objects", integer, "", "objects in the scene", r->scene->objects)                            \
    X(scene_hash, "scene_hash", hash, "", "fingerprint of the scene", r->scene->scene)                       \
    X(width, "width", integer, "pixels", "width of the frame whose rays are recorded", r->scene->width)      \
    X(height, "height", integer, "pixels", "height of the frame", r->scene->height)                          \
    X(corners, "corners", flag, "", "samples at pixel corners, not centres", r->setup->corners)              \
    X(depth, "depth", integer, "", "levels of the ray tree, the primary ray being one", r->setup->depth)     \
    X(kind, "kind", text, "", "kind of the rays", kind_of(r))                                                \
    X(set_rays, "set_rays", integer, "", "rays in the set, after the limit", r->scene->rays[r->kind])        \
    X(set_hash, "set_hash", hash, "", "fingerprint of the set", r->scene->ray_fingerprints[r->kind])         \
    X(accel, "accelerator", text, "", "the accelerator's label in the experiment; (again): a null run",      \
      label_of(r))                                                                                           \
    X(spec, "accel", text, "", "the accelerator with every effective parameter", r->build->spec)             \
    X(ray_stride, "ray_stride", integer, "", "k, where only each kth ray of the set is measured",            \
      ray_stride_of(r))                                                                                      \
    X(rays, "rays", integer, "", "rays measured", r->all.rays)                                               \
    X(hits, "hits", integer, "", "of them, those that hit an object", r->cell->tally.hits)                   \
    X(build_seconds, "build_seconds", real6, "s", "time to build; median of up to 3", r->build->seconds)     \
    X(bytes, "bytes", integer, "bytes", "memory of the structure's arrays", r->build->shape.bytes)           \
    X(threads, "threads", integer, "", "threads of the timing", (uint32_t)r->cell->threads)                  \
    X(rounds, "rounds", integer, "", "how often it was timed", r->cell->rounds)                              \
    X(coverage, "ratio_coverage", real6, "", "probability with which intervals hold the median",             \
      TIMED(rt_interval_coverage(r->cell->rounds)))                                                          \
    X(ns, "ns", real6, "ns", "processor time per ray, by the clock on several threads; median",              \
      1e9 * r->cell->seconds.median)                                                                         \
    X(ns_low, "ns_low", real6, "ns", "lower end of its interval", 1e9 * r->cell->seconds.low)                \
    X(ns_high, "ns_high", real6, "ns", "upper end of its interval", 1e9 * r->cell->seconds.high)             \
    X(ns_min, "ns_min", real6, "ns", "the smallest such time", 1e9 * r->cell->seconds.least)                 \
    X(wall_ns, "wall_ns", real6, "ns", "time per ray by the clock; median", 1e9 * r->cell->wall.median)      \
    X(wall_ns_low, "wall_ns_low", real6, "ns", "lower end of its interval", 1e9 * r->cell->wall.low)         \
    X(wall_ns_high, "wall_ns_high", real6, "ns", "upper end of its interval", 1e9 * r->cell->wall.high)      \
    X(mrays_per_s, "mrays_per_s", real6, "million/s", "rays a second, by the median", 1e-6 / r->all.seconds) \
    X(baseline, "baseline", text, "", "the accelerator that the ratio refers to", baseline_of(r))            \
    X(ratio, "ratio", real6, "", "throughput over the baseline's, paired by rounds; median", r->all.ratio)   \
    X(ratio_low, "ratio_low", end, "", "lower end of its interval", TIMED(r->cell->ratio.low))               \
    X(ratio_high, "ratio_high", end, "", "upper end of its interval", TIMED(r->cell->ratio.high))            \
    X(straddles_1, "straddles_1", flag, "", "whether 1 is between them, as it should be in a null run",      \
      rt_field_flag(rt_estimate_holds(&r->cell->ratio, 1)))                                                  \
    X(object_tests, "object_tests", integer, "", "object tests counted here; empty: not known",              \
      known(r->cell->tally.object_tests, r->all.object_tests))                                               \
    X(extent_tests, "extent_tests", integer, "", "extent tests counted here; empty: not known",              \
      known(r->cell->tally.extent_tests, r->all.extent_tests))                                               \
    X(steps, "steps", integer, "", "steps counted here; empty: not known",                                   \
      known(r->cell->tally.steps, r->all.steps))                                                             \
    X(differ, "differ", integer, "", "answers unlike the baseline's; 0 if exact", r->cell->differ)           \
    X(host, "host", text, "", "the machine that timed it", r->results->machines[r->cell->machine].host)      \
    X(cpu, "cpu", text, "", "its processor", r->results->machines[r->cell->machine].cpu)                     \
    X(tests_a_ray, "tests/ray", figure, "", "object tests per ray", r->all.object_tests)                     \
    X(extents_a_ray, "ext./ray", figure, "", "extent tests per ray", r->all.extent_tests)                    \
    X(steps_a_ray, "steps/ray", figure, "", "steps per ray", r->all.steps)                                   \
    X(ns_a_ray, "ns/ray", figure, "ns", "median time per ray", 1e9 * r->all.seconds)                         \
    X(ns_interval, "ns/ray", interval, "ns", "median time per ray, with its interval", ns_of(r))             \
    X(mrays, "Mrays/s", figure, "million/s", "throughput", 1e-6 / r->all.seconds)                            \
    X(interval, "ratio", interval, "", "throughput over the baseline's", ratio_of(r))                        \
    X(build_ms, "build ms", amount, "ms", "time to build the structure", 1e3 * r->build->seconds)            \
    X(mb, "MB", amount, "MB", "memory of the structure", 1e-6 * (double)r->build->shape.bytes)               \
    X(pay_off, "ahead, Mrays", text, "million",                                                              \
      "for how many rays, with both builds, it takes less time than the baseline", pay_off_of(r))            \
    X(min_ns, "min ns", figure, "ns", "smallest time per ray", TIMED(1e9 * r->cell->seconds.least))          \
    X(msteps_per_s, "msteps_per_s", real6, "million/s", "steps a second: mrays_per_s by steps per ray",      \
      1e-6 * r->all.steps / r->all.seconds)                                                                  \
    X(mtests_per_s, "mtests_per_s", real6, "million/s",                                                      \
      "object tests a second: mrays_per_s by object tests per ray",                                          \
      1e-6 * r->all.object_tests / r->all.seconds)                                                           \
    X(eye_label, "accelerator", text, "", "the label, where there is room", short_label_of(r))               \
    X(eye_tests, "tests", figure, "", "object tests per ray", r->all.object_tests)                           \
    X(eye_extents, "ext.", figure, "", "extent tests per ray", r->all.extent_tests)                          \
    X(eye_steps, "steps", figure, "", "steps per ray", r->all.steps)                                         \
    X(eye_mrays, "Mrays/s", figure, "million/s", "throughput", 1e-6 / r->all.seconds)                        \
    X(eye_ratio, "ratio", interval, "", "throughput over the baseline's", ratio_of(r))                       \
    X(tests_median, "tests: 50 %", integer, "", "object tests that half of the rays do not exceed",          \
      SPREAD(object_tests)->median)                                                                          \
    X(tests_p99, "99 %", integer, "", "that 99 % do not exceed", SPREAD(object_tests)->p99)                  \
    X(tests_most, "most", integer, "", "of the ray that has most", SPREAD(object_tests)->most)               \
    X(steps_median, "steps: 50 %", integer, "", "the same of steps", SPREAD(steps)->median)                  \
    X(steps_p99, "99 %", integer, "", "that 99 % do not exceed", SPREAD(steps)->p99)                         \
    X(steps_most, "most", integer, "", "of the ray that has most", SPREAD(steps)->most)                      \
    X(size_median, "leaf size: 50 %", integer, "", "objects that half of the leaves do not exceed",          \
      LEAVES(leaf_size)->median)                                                                             \
    X(size_p99, "99 %", integer, "", "that 99 % do not exceed", LEAVES(leaf_size)->p99)                      \
    X(size_most, "most", integer, "", "of the largest", LEAVES(leaf_size)->most)                             \
    X(depth_median, "depth: 50 %", integer, "", "the same of depths", LEAVES(leaf_depth)->median)            \
    X(depth_p99, "99 %", integer, "", "that 99 % do not exceed", LEAVES(leaf_depth)->p99)                    \
    X(depth_most, "most", integer, "", "of the deepest", LEAVES(leaf_depth)->most)                           \
    X(eye_instructions, "instr./ray", figure, "", "instructions", MACHINE(instructions))                     \
    X(eye_cycles, "cycles/ray", figure, "", "cycles", MACHINE(cycles))                                       \
    X(eye_ipc, "instr./cycle", figure, "", "instructions a cycle", MACHINE(instructions) / MACHINE(cycles))  \
    X(eye_cache, "cache m.", figure, "", "cache misses a ray", MACHINE(cache_misses))                        \
    X(eye_branch, "branch m.", figure, "", "mispredicted branches a ray", MACHINE(branch_misses))            \
    X(round, "round", integer, "", "number of the round, from 1", r->round + 1)                              \
    X(round_ns, "ns", real6, "ns", "processor time per ray in it, by the clock on several threads",          \
      each_ns(r, RT_EACH_SECONDS))                                                                           \
    X(round_wall_ns, "wall_ns", real6, "ns", "time per ray by the clock", each_ns(r, RT_EACH_WALL))          \
    X(round_baseline_ns, "baseline_ns", real6, "ns",                                                         \
      "the baseline's in this round, on the same rays, as round_ns; over that, the ratio",                   \
      each_ns(r, RT_EACH_BASELINE))

RT_TABLE_COLUMNS(columns, COLUMNS)

static const RtColumnGroup counts[] = {
    RT_FROM_TO(columns, scene, rays),
    {NULL, rt_tally_columns + 1, RT_TALLY_COUNTER_COUNT - 1, tally_of},
    {NULL, rt_structure_columns, RT_SHAPE_COLUMNS, structure_of},
    RT_ONE(columns, bytes),
    {NULL, rt_structure_columns + RT_SHAPE_COLUMNS, RT_PREDICTION_COLUMNS, structure_of},
};

static const RtColumnGroup times[] = {
    RT_FROM_TO(columns, scene, rays),
    RT_FROM_TO(columns, threads, ratio_high),
    RT_FROM_TO(columns, build_seconds, bytes),
    RT_FROM_TO(columns, object_tests, differ),
    {NULL, rt_structure_columns + RT_SHAPE_COLUMNS, RT_PREDICTION_COLUMNS, structure_of},
    RT_FROM_TO(columns, host, cpu),
};

static const RtColumnGroup each_round[] = {
    RT_ONE(columns, scene),
    RT_ONE(columns, kind),
    RT_ONE(columns, accel),
    RT_ONE(columns, baseline),
    RT_FROM_TO(columns, round, round_baseline_ns),
};

static const RtColumnGroup bench[] = {
    RT_ONE(columns, scene_spec),
    RT_FROM_TO(columns, accel, ray_stride),
    RT_ONE(columns, kind),
    RT_FROM_TO(columns, rays, bytes),
    {"structure", rt_structure_columns, RT_STRUCTURE_COLUMNS, structure_of},
    {"structure.build", rt_tally_columns, RT_TALLY_COUNTER_COUNT, build_of},
    {"counts", rt_tally_columns, RT_TALLY_COUNTER_COUNT, known_tally_of},
    RT_FROM_TO(columns, threads, mrays_per_s),
    RT_FROM_TO(columns, msteps_per_s, mtests_per_s),
    RT_FROM_TO(columns, baseline, ratio_high),
};

static const RtColumnGroup null_runs[] = {RT_ONE(columns, scene_spec), RT_ONE(columns, kind),
                                          RT_FROM_TO(columns, accel, spec), RT_ONE(columns, rays),
                                          RT_FROM_TO(columns, build_seconds, straddles_1)};

static const RtColumnGroup for_the_eye[] = {RT_FROM_TO(columns, eye_label, eye_ratio)};

static const RtColumnGroup for_papers[] = {RT_ONE(columns, accel), RT_FROM_TO(columns, eye_tests, eye_ratio)};

static const RtColumnGroup counted_for_papers[] = {RT_ONE(columns, accel),
                                                   RT_FROM_TO(columns, eye_tests, eye_steps)};

static const RtColumnGroup structures[] = {RT_ONE(columns, eye_label),
                                           RT_FROM_TO(columns, build_ms, pay_off)};

static const RtColumnGroup counted_cells[] = {RT_FROM_TO(columns, eye_label, eye_steps)};

static const RtColumnGroup counted_structures[] = {
    RT_ONE(columns, eye_label),
    RT_ONE(columns, mb),
    {NULL, rt_structure_columns, RT_SHAPE_COLUMNS, structure_of},
};

static const RtColumnGroup cells[] = {
    RT_ONE(columns, accel),       RT_ONE(columns, kind),
    RT_ONE(columns, rays),        RT_FROM_TO(columns, tests_a_ray, steps_a_ray),
    RT_ONE(columns, ns_interval), RT_FROM_TO(columns, mrays, interval),
    RT_ONE(columns, min_ns),      RT_ONE(columns, differ)};

static const RtColumnGroup totals[] = {RT_ONE(columns, accel), RT_ONE(columns, rays),
                                       RT_FROM_TO(columns, tests_a_ray, ns_a_ray),
                                       RT_FROM_TO(columns, interval, pay_off)};

static const RtColumnGroup spreads[] = {RT_ONE(columns, eye_label),
                                        RT_FROM_TO(columns, tests_median, steps_most)};

static const RtColumnGroup leaf_spreads[] = {RT_ONE(columns, eye_label),
                                             RT_FROM_TO(columns, size_median, depth_most)};

static const RtColumnGroup machine_cells[] = {RT_ONE(columns, eye_label),
                                              RT_FROM_TO(columns, eye_instructions, eye_branch)};

static const RtColumnGroup totals_more[] = {
    RT_ONE(columns, accel), RT_ONE(columns, rays), RT_FROM_TO(columns, tests_a_ray, steps_a_ray),
    RT_ONE(columns, ns_interval), RT_FROM_TO(columns, interval, pay_off)};

/* ---- rows ---- */

/* A workload after the other, in each an accelerator after the other, the null run last, in each all
 * kinds; for the eye and bench, of one workload, a kind after the other. */
static bool is_by_workload(RtResultTable which) {
    return which <= RT_ROUNDS;
}

static void find(Row *r, size_t i) {
    const RtExperiment *e = r->results->experiment;
    const size_t kinds = e->kind_count, candidates = e->candidate_count + 1;
    bool by_workload = is_by_workload(r->which);
    if (r->which == RT_ROUNDS) {
        r->round = (uint32_t)(i % RT_MAX_ROUNDS);
        i /= RT_MAX_ROUNDS;
    }
    r->kind = e->kinds[by_workload ? i % kinds : i / candidates];
    r->candidate = (uint32_t)((by_workload ? i / kinds : i) % candidates);
    if (by_workload) r->workload = (uint32_t)(i / kinds / candidates);
    r->setup = &e->workloads[r->workload];
    r->scene = &r->results->workloads[r->workload];
    r->build = rt_build_at(r->results, r->workload, r->candidate);
    r->cell = rt_cell_at(r->results, r->workload, r->candidate, r->kind);
}

static double per_ray(const Row *r, uint64_t counter) {
    return rt_cell_per_ray(r->results, r->workload, r->candidate, r->kind, counter);
}

static RtTotal all_of(const Row *r) {
    const RtTally *tally = &r->cell->tally;
    if (r->which == RT_TOTALS || r->which == RT_TOTALS_MORE)
        return rt_results_total(r->results, r->workload, r->candidate);
    return (RtTotal){.rays = tally->rays,
                     .object_tests = per_ray(r, tally->object_tests),
                     .extent_tests = per_ray(r, tally->extent_tests),
                     .steps = per_ray(r, tally->steps),
                     .seconds = TIMED(r->cell->seconds.median),
                     .ratio = TIMED(r->cell->ratio.median)};
}

/* One of the baseline's candidates that is not the fastest of them on these rays. */
static bool is_lost(const Row *r, const RtCell *cell) {
    return cell->timed && r->candidate < r->results->experiment->candidate_count &&
           rt_candidate_is_baseline(r->results->experiment, r->candidate) && cell->baseline != r->candidate;
}

/* Whether any of the candidate's cells is for the eye. */
static bool is_shown(const Row *r) {
    for (uint32_t k = 0; k < r->results->experiment->kind_count; k++) {
        const RtCell *cell =
            rt_cell_at(r->results, r->workload, r->candidate, r->results->experiment->kinds[k]);
        if ((cell->counted || cell->timed) && !is_lost(r, cell)) return true;
    }
    return false;
}

static const void *row_at(void *context, size_t i) {
    Row *r = context;
    find(r, i);
    const bool null = r->candidate == r->results->experiment->candidate_count;
    const bool counted = r->cell->counted, timed = r->cell->timed;
    const bool there[RT_RESULT_TABLE_COUNT] = {
        [RT_COUNTS] = counted && r->build->counts,
        [RT_TIMES] = timed,
        [RT_ROUNDS] = timed && r->cell->each && r->round < r->cell->rounds,
        [RT_BENCH] = counted && !null,
        [RT_NULL_RUNS] = timed && null,
        [RT_CELLS] = (counted || timed) && !is_lost(r, r->cell),
        [RT_CELLS_PAPER] = (counted || timed) && !null && !is_lost(r, r->cell),
        [RT_COUNTED_PAPER] = counted && !null,
        [RT_STRUCTURES] = is_shown(r) && !null && i < r->results->experiment->candidate_count,
        [RT_COUNTED_CELLS] = r->cell->counted,
        [RT_COUNTED_STRUCTURES] = is_shown(r) && i < r->results->experiment->candidate_count,
        [RT_CELLS_MORE] = counted || timed,
        [RT_TOTALS] = r->build->known && !null && i < r->results->experiment->candidate_count,
        [RT_SPREADS] = r->cell->distributions && !isnan(per_ray(r, r->cell->tally.object_tests)),
        [RT_LEAF_SPREADS] = r->build->leaves && !null && i < r->results->experiment->candidate_count,
        [RT_MACHINE_CELLS] = r->cell->hardware.known && !*r->cell->hardware.why,
        [RT_TOTALS_MORE] = r->build->known && !null && i < r->results->experiment->candidate_count,
    };
    if (!there[r->which]) return NULL;
    r->all = all_of(r);
    return r;
}

static RtStanding standing_of(const void *row) {
    const Row *r = row;
    const bool total = r->which == RT_TOTALS || r->which == RT_TOTALS_MORE;
    return rt_standing(r->results, r->workload, r->candidate, total ? RT_RAY_KIND_COUNT : r->kind);
}

/* ---- what is swept ---- */

static RtField get_swept(const void *row, const RtTableColumn *column) {
    const Row *r = row;
    const RtSweptKey *key = &r->swept[column->key];
    const char *value = rt_swept_of(r->results->experiment, key, r->workload, r->candidate);
    double number;
    if (!value || !key->number) return rt_field_text(value);
    return rt_swept_number(value, &number) ? rt_field_real(number) : rt_field_missing();
}

/* A column for each swept parameter at the end, where those of all experiments are alike up to there. */
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
    if (!row->swept_count) return;
    assert(table->group_count < RT_MAX_RESULT_GROUPS);
    memcpy(row->groups, table->groups, table->group_count * sizeof *row->groups);
    row->groups[table->group_count++] = (RtColumnGroup){NULL, row->swept_columns, row->swept_count, NULL};
    table->groups = row->groups;
}

RtTable rt_result_table(RtResultTable which, RtResultRow *row) {
    static const RtTable tables[RT_RESULT_TABLE_COUNT] = {
        [RT_COUNTS] = {RT_GROUPS(counts)},
        [RT_TIMES] = {RT_GROUPS(times)},
        [RT_ROUNDS] = {RT_GROUPS(each_round)},
        [RT_BENCH] = {RT_GROUPS(bench)},
        [RT_NULL_RUNS] = {RT_GROUPS(null_runs)},
        [RT_CELLS] = {RT_GROUPS(for_the_eye)},
        [RT_STRUCTURES] = {RT_GROUPS(structures)},
        [RT_COUNTED_CELLS] = {RT_GROUPS(counted_cells)},
        [RT_COUNTED_STRUCTURES] = {RT_GROUPS(counted_structures)},
        [RT_SPREADS] = {RT_GROUPS(spreads)},
        [RT_LEAF_SPREADS] = {RT_GROUPS(leaf_spreads)},
        [RT_MACHINE_CELLS] = {RT_GROUPS(machine_cells)},
        [RT_CELLS_PAPER] = {RT_GROUPS(for_papers)},
        [RT_COUNTED_PAPER] = {RT_GROUPS(counted_for_papers)},
        [RT_CELLS_MORE] = {RT_GROUPS(cells)},
        [RT_TOTALS] = {RT_GROUPS(totals)},
        [RT_TOTALS_MORE] = {RT_GROUPS(totals_more)},
    };
    const RtExperiment *e = row->results->experiment;
    const size_t workloads = is_by_workload(which) ? e->workload_count : 1;
    RtTable table = tables[which];
    table.row_count = workloads * (e->candidate_count + 1) * e->kind_count;
    if (which == RT_ROUNDS) table.row_count *= RT_MAX_ROUNDS;
    table.row = row_at;
    table.context = row;
    table.standing = which >= RT_CELLS_PAPER ? standing_of : NULL;
    row->which = which;
    if (which <= RT_BENCH) add_swept(&table, row);
    return table;
}
