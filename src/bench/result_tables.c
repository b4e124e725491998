#include "bench/result_tables.h"

#include "accel/structure_json.h"

#include <inttypes.h>
#include <math.h>

typedef RtResultRow Row;

/* ---- what a row is about ---- */

static const RtExperiment *experiment_of(const Row *r) {
    return r->results->experiment;
}

static const RtTrial *setup_of(const Row *r) {
    return &experiment_of(r)->trials[r->trial];
}

static const RtTrialResult *trial_of(const Row *r) {
    return &r->results->trials[r->trial];
}

static const RtBuildResult *build_of(const Row *r) {
    return rt_build_at(r->results, r->trial, r->contender);
}

static const RtCell *cell_of(const Row *r) {
    return rt_cell_at(r->results, r->trial, r->contender, r->kind);
}

/* How often a contender is measured; the null run is the baseline once more. */
static uint64_t every_of(const Row *r) {
    const RtExperiment *e = experiment_of(r);
    return e->contenders[r->contender < e->contender_count ? r->contender : e->baseline].every;
}

static double per_ray(const Row *r, uint64_t counter) {
    return rt_cell_per_ray(r->results, r->trial, r->contender, r->kind, counter);
}

/* A counter, unless it is not known. */
static RtField known(const Row *r, uint64_t counter) {
    return isnan(per_ray(r, counter)) ? rt_field_missing() : rt_field_integer(counter);
}

/* A figure of the timing. */
static double timed(const Row *r, double figure) {
    return cell_of(r)->timed ? figure : (double)NAN;
}

static RtField label(const Row *r) {
    RtField field = rt_field_text(rt_contender_label(experiment_of(r), r->contender));
    if (every_of(r) > 1) field.note = "measured on a part of the rays";
    return field;
}

static RtField ratio(const Row *r) {
    const RtEstimate *e = &cell_of(r)->ratio;
    return rt_field_interval(timed(r, e->median), e->low, e->high);
}

static const void *tally_of(const void *row) {
    return &cell_of(row)->tally;
}

static const void *known_tally_of(const void *row) {
    return isfinite(per_ray(row, cell_of(row)->tally.object_tests)) ? tally_of(row) : NULL;
}

static const void *structure_of(const void *row) {
    return &build_of(row)->shape;
}

/* ---- columns ---- */

#define COLUMNS(X)                                                                                           \
    X(scene, "scene", text, "", "the scene's label in the experiment", setup_of(r)->label)                   \
    X(scene_spec, "scene", text, "", "the scene as it is opened: a file, or a built-in", setup_of(r)->spec)  \
    X(objects, "objects", integer, "", "objects in the scene", trial_of(r)->objects)                         \
    X(scene_hash, "scene_hash", hash, "", "fingerprint of the scene", trial_of(r)->scene)                    \
    X(width, "width", integer, "pixels", "width of the frame whose rays are recorded", trial_of(r)->width)   \
    X(height, "height", integer, "pixels", "height of the frame", trial_of(r)->height)                       \
    X(corners, "corners", flag, "", "samples at pixel corners, not centres", setup_of(r)->corners)           \
    X(depth, "depth", integer, "", "levels of the ray tree, the primary ray being one", setup_of(r)->depth)  \
    X(kind, "kind", text, "", "kind of the rays", rt_ray_kind_name(r->kind))                                 \
    X(set_rays, "set_rays", integer, "", "rays in the set, after the limit", trial_of(r)->rays[r->kind])     \
    X(set_hash, "set_hash", hash, "", "fingerprint of the set", trial_of(r)->ray_fingerprints[r->kind])      \
    X(accel, "accelerator", text, "", "the accelerator's label in the experiment; null: a null run",         \
      label(r))                                                                                              \
    X(spec, "accel", text, "", "the accelerator with every effective parameter", build_of(r)->spec)          \
    X(every, "every", integer, "", "k, where only each kth ray of the set is measured", every_of(r))         \
    X(rays, "rays", integer, "", "rays measured", cell_of(r)->tally.rays)                                    \
    X(hits, "hits", integer, "", "of them, those that hit an object", cell_of(r)->tally.hits)                \
    X(build_seconds, "build_seconds", real6, "s", "time to build the structure, the median of up to three",  \
      build_of(r)->seconds)                                                                                  \
    X(bytes, "bytes", integer, "bytes", "memory of the structure's arrays", build_of(r)->shape.bytes)        \
    X(threads, "threads", integer, "", "threads of the timing", (uint32_t)cell_of(r)->threads)               \
    X(rounds, "rounds", integer, "", "how often it was timed", cell_of(r)->rounds)                           \
    X(coverage, "ratio_coverage", real6, "", "probability with which the intervals hold the median",         \
      timed(r, rt_interval_coverage(cell_of(r)->rounds)))                                                    \
    X(ns, "ns", real6, "ns", "time a ray: of the processor on one thread, by the clock on several; median",  \
      1e9 * cell_of(r)->seconds.median)                                                                      \
    X(ns_low, "ns_low", real6, "ns", "lower end of its interval", 1e9 * cell_of(r)->seconds.low)             \
    X(ns_high, "ns_high", real6, "ns", "upper end of its interval", 1e9 * cell_of(r)->seconds.high)          \
    X(ns_least, "ns_least", real6, "ns", "the smallest time a ray", 1e9 * cell_of(r)->seconds.least)         \
    X(wall_ns, "wall_ns", real6, "ns", "time a ray by the clock; median", 1e9 * cell_of(r)->wall.median)     \
    X(wall_ns_low, "wall_ns_low", real6, "ns", "lower end of its interval", 1e9 * cell_of(r)->wall.low)      \
    X(wall_ns_high, "wall_ns_high", real6, "ns", "upper end of its interval", 1e9 * cell_of(r)->wall.high)   \
    X(mrays_per_s, "mrays_per_s", real6, "million rays a second", "throughput, from the median time",        \
      timed(r, 1e-6 / cell_of(r)->seconds.median))                                                           \
    X(ratio, "ratio", real6, "", "throughput over the baseline's, paired round by round; median",            \
      timed(r, cell_of(r)->ratio.median))                                                                    \
    X(ratio_low, "ratio_low", real6, "", "lower end of its interval", timed(r, cell_of(r)->ratio.low))       \
    X(ratio_high, "ratio_high", real6, "", "upper end of its interval", timed(r, cell_of(r)->ratio.high))    \
    X(straddles_1, "straddles_1", flag, "", "the interval of the ratio holds 1, as a null run's should",     \
      rt_field_flag(cell_of(r)->ratio.low <= 1 && 1 <= cell_of(r)->ratio.high))                              \
    X(object_tests, "object_tests", integer, "",                                                             \
      "object tests counted here; empty where they are not known", known(r, cell_of(r)->tally.object_tests)) \
    X(extent_tests, "extent_tests", integer, "", "extent tests, as well",                                    \
      known(r, cell_of(r)->tally.extent_tests))                                                              \
    X(steps, "steps", integer, "", "steps, as well", known(r, cell_of(r)->tally.steps))                      \
    X(differ, "differ", integer, "", "answers unlike the baseline's; none of an exact accelerator",          \
      cell_of(r)->differ)                                                                                    \
    X(tests_a_ray, "tests/ray", figure, "", "object tests a ray",                                            \
      per_ray(r, cell_of(r)->tally.object_tests))                                                            \
    X(extents_a_ray, "ext./ray", figure, "", "extent tests a ray",                                           \
      per_ray(r, cell_of(r)->tally.extent_tests))                                                            \
    X(steps_a_ray, "steps/ray", figure, "", "steps a ray", per_ray(r, cell_of(r)->tally.steps))              \
    X(mrays, "Mrays/s", figure, "", "throughput", timed(r, 1e-6 / cell_of(r)->seconds.median))               \
    X(interval, "ratio, interval", interval, "", "throughput over the baseline's", ratio(r))                 \
    X(total_rays, "rays", integer, "", "rays measured", r->total.rays)                                       \
    X(total_tests, "tests/ray", figure, "", "object tests a ray", r->total.object_tests)                     \
    X(total_extents, "ext./ray", figure, "", "extent tests a ray", r->total.extent_tests)                    \
    X(total_steps, "steps/ray", figure, "", "steps a ray", r->total.steps)                                   \
    X(total_ns, "ns/ray", figure, "ns", "median time a ray", 1e9 * r->total.seconds)                         \
    X(total_ratio, "ratio", figure, "", "throughput over the baseline's", r->total.ratio)                    \
    X(build_ms, "build ms", amount, "ms", "time to build the structure", 1e3 * build_of(r)->seconds)         \
    X(mb, "MB", amount, "MB", "memory of the structure", 1e-6 * (double)build_of(r)->shape.bytes)            \
    X(ns_a_ray, "ns/ray", figure, "ns", "median time a ray", timed(r, 1e9 * cell_of(r)->seconds.median))     \
    X(least, "least", figure, "ns", "smallest time a ray", timed(r, 1e9 * cell_of(r)->seconds.least))

RT_TABLE_COLUMNS(columns, COLUMNS)

#define SHAPE (RT_STRUCTURE_COLUMNS - RT_PREDICTION_COUNT)
#define PREDICTIONS                                                                                          \
    { NULL, rt_structure_columns + SHAPE, RT_PREDICTION_COUNT, structure_of }

static const RtColumnGroup counts[] = {
    RT_FROM_TO(columns, scene, rays),
    {NULL, rt_tally_columns + 1, RT_TALLY_COUNTER_COUNT - 1, tally_of},
    {NULL, rt_structure_columns, SHAPE, structure_of},
    RT_ONE(columns, bytes),
    PREDICTIONS,
};

static const RtColumnGroup times[] = {
    RT_FROM_TO(columns, scene, rays),
    RT_FROM_TO(columns, threads, ratio_high),
    RT_FROM_TO(columns, build_seconds, bytes),
    RT_FROM_TO(columns, object_tests, differ),
    PREDICTIONS,
};

static const RtColumnGroup bench[] = {
    RT_ONE(columns, scene_spec),
    RT_ONE(columns, spec),
    RT_ONE(columns, kind),
    RT_FROM_TO(columns, rays, bytes),
    {"structure", rt_structure_columns, RT_STRUCTURE_COLUMNS, structure_of},
    {"counts", rt_tally_columns, RT_TALLY_COUNTER_COUNT, known_tally_of},
    RT_FROM_TO(columns, mrays_per_s, ratio_high),
    RT_ONE(columns, coverage),
};

static const RtColumnGroup null_runs[] = {RT_ONE(columns, kind), RT_FROM_TO(columns, ratio, straddles_1),
                                          RT_ONE(columns, coverage)};

static const RtColumnGroup cells[] = {RT_ONE(columns, accel),
                                      RT_ONE(columns, kind),
                                      RT_ONE(columns, rays),
                                      RT_FROM_TO(columns, tests_a_ray, interval),
                                      RT_FROM_TO(columns, build_ms, mb),
                                      RT_FROM_TO(columns, ns_a_ray, least),
                                      RT_ONE(columns, differ)};

static const RtColumnGroup totals[] = {RT_ONE(columns, accel), RT_FROM_TO(columns, total_rays, mb)};

/* ---- rows ---- */

/* A trial after the other, in each an accelerator after the other, the null run last, in each all kinds. */
static Row *by_trial(void *context, size_t i) {
    Row *r = context;
    const RtExperiment *e = experiment_of(r);
    r->kind = e->kinds[i % e->kind_count];
    r->contender = (uint32_t)(i / e->kind_count % (e->contender_count + 1));
    r->trial = (uint32_t)(i / e->kind_count / (e->contender_count + 1));
    return r;
}

/* Of the trial that is set, a kind after the other. */
static Row *by_kind(void *context, size_t i) {
    Row *r = context;
    const RtExperiment *e = experiment_of(r);
    r->kind = e->kinds[i / (e->contender_count + 1)];
    r->contender = (uint32_t)(i % (e->contender_count + 1));
    return r;
}

static bool is_null(const Row *r) {
    return r->contender == experiment_of(r)->contender_count;
}

static const void *counts_row(void *context, size_t i) {
    const Row *r = by_trial(context, i);
    return cell_of(r)->counted && build_of(r)->counts ? r : NULL;
}

static const void *times_row(void *context, size_t i) {
    const Row *r = by_trial(context, i);
    return cell_of(r)->timed ? r : NULL;
}

static const void *bench_row(void *context, size_t i) {
    const Row *r = by_kind(context, i);
    return cell_of(r)->counted && !is_null(r) ? r : NULL;
}

static const void *null_row(void *context, size_t i) {
    const Row *r = by_kind(context, i);
    return cell_of(r)->timed && is_null(r) ? r : NULL;
}

static const void *cells_row(void *context, size_t i) {
    const Row *r = by_kind(context, i);
    return cell_of(r)->counted || cell_of(r)->timed ? r : NULL;
}

static const void *totals_row(void *context, size_t i) {
    Row *r = by_kind(context, i);
    if (i > experiment_of(r)->contender_count || is_null(r) || !build_of(r)->known) return NULL;
    r->total = rt_results_total(r->results, r->trial, r->contender);
    return r;
}

#define GROUPS(array) array, sizeof(array) / sizeof *(array)
static const RtTable tables[RT_RESULT_TABLE_COUNT] = {
    [RT_COUNTS] = {GROUPS(counts), .row = counts_row},
    [RT_TIMES] = {GROUPS(times), .row = times_row},
    [RT_BENCH] = {GROUPS(bench), .row = bench_row},
    [RT_NULL_RUNS] = {GROUPS(null_runs), .row = null_row},
    [RT_CELLS] = {cells, sizeof cells / sizeof *cells - 2, .row = cells_row},
    [RT_CELLS_MORE] = {GROUPS(cells), .row = cells_row},
    [RT_TOTALS] = {GROUPS(totals), .row = totals_row},
};

RtTable rt_result_table(RtResultTable which, RtResultRow *row) {
    RtTable table = tables[which];
    const RtExperiment *e = row->results->experiment;
    size_t a_trial = (size_t)(e->contender_count + 1) * e->kind_count;
    table.row_count = a_trial * (which <= RT_TIMES ? e->trial_count : 1);
    table.context = row;
    return table;
}

/* ---- for the eye ---- */

void rt_interval_title(const RtExperiment *experiment, char out[RT_MAX_INTERVAL_TITLE]) {
    double coverage = rt_interval_coverage(experiment->rounds);
    snprintf(out, RT_MAX_INTERVAL_TITLE, "%.3g %%",
             experiment->rounds >= RT_FULL_ROUNDS ? 95 : 100 * coverage);
}

void rt_print_results(const RtResults *results, RtResultTable which, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    char title[RT_MAX_INTERVAL_TITLE];
    for (uint32_t t = 0; t < experiment->trial_count; t++) {
        const RtTrialResult *trial = &results->trials[t];
        RtResultRow row = {.results = results, .trial = t};
        RtTable table = rt_result_table(which, &row);
        if (!trial->known) continue;
        fprintf(out, "\n%s: %" PRIu32 " objects, %" PRIu32 "x%" PRIu32 ", depth %" PRIu32,
                experiment->trials[t].label, trial->objects, trial->width, trial->height,
                experiment->trials[t].depth);
        if (which == RT_CELLS && rt_cell_at(results, t, experiment->baseline, experiment->kinds[0])->timed) {
            rt_interval_title(experiment, title);
            fprintf(out, "; intervals of %s", title);
        }
        fputc('\n', out);
        rt_table_text(&table, out);
    }
}

void rt_null_sentence(const RtResults *results, char out[RT_MAX_SENTENCE]) {
    const size_t room = RT_MAX_SENTENCE;
    uint32_t runs, straddling;
    rt_null_verdict(results, &runs, &straddling);
    out[0] = '\0';
    if (runs == 0) return;
    int n =
        snprintf(out, room, "Null runs (%s against itself): %" PRIu32 " of %" PRIu32 " intervals straddle 1",
                 results->experiment->contenders[results->experiment->baseline].label, straddling, runs);
    uint32_t misses = runs - straddling, rounds = results->experiment->rounds;
    double coverage = rt_interval_coverage(rounds), chance = 1 - coverage;
    if (misses == 0) {
        n += snprintf(out + n, room - (size_t)n, ", as they should.");
    } else if (misses <= 1 + 2 * chance * runs) {
        n += snprintf(out + n, room - (size_t)n, "; %.2g %% of all may miss by chance.", 100 * chance);
    } else {
        n += snprintf(out + n, room - (size_t)n,
                      ": this machine was not quiet; take small differences for noise.");
    }
    if (rounds >= RT_FULL_ROUNDS) return;
    snprintf(out + n, room - (size_t)n,
             " Rounds: %" PRIu32
             ", too few for 95 %%; an interval is all that was measured and holds the median in "
             "%.3g %%. Take %d or more.",
             rounds, 100 * coverage, RT_FULL_ROUNDS);
}
