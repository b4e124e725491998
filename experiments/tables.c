#include "experiments/tables.h"

#include "experiments/csv.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- CSV ---- */

/* Columns that say which cell it is; the same in both files. */
static const char identity[] = "scene,scene_spec,objects,scene_hash,width,height,corners,depth,kind,set_rays,"
                               "set_hash,accel,spec,every,rays";

static void put_text(FILE *out, const char *text) {
    rt_csv_put(out, text);
    fputc(',', out);
}

static void put_identity(FILE *out, const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind) {
    const RtTrial *setup = &results->experiment->trials[t];
    const RtTrialResult *trial = &results->trials[t];
    uint32_t origin = c < results->experiment->contender_count ? c : results->experiment->baseline;
    put_text(out, setup->label);
    put_text(out, setup->spec);
    fprintf(out,
            "%" PRIu32 ",%016" PRIx64 ",%" PRIu32 ",%" PRIu32 ",%s,%" PRIu32 ",%s,%" PRIu64 ",%016" PRIx64
            ",",
            trial->objects, trial->scene, trial->width, trial->height, setup->corners ? "yes" : "no",
            setup->depth, rt_ray_kind_name(kind), trial->rays[kind], trial->ray_fingerprints[kind]);
    put_text(out, rt_contender_label(results->experiment, c));
    put_text(out, rt_build_at(results, t, c)->spec);
    fprintf(out, "%" PRIu64 ",%" PRIu64, results->experiment->contenders[origin].every,
            rt_cell_at(results, t, c, kind)->tally.rays);
}

typedef void PutRow(FILE *out, const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind);

/* Calls `put` for every cell in the order of the experiment; null runs come last. */
static void each_cell(FILE *out, const RtResults *results, PutRow put) {
    const RtExperiment *experiment = results->experiment;
    for (uint32_t t = 0; t < experiment->trial_count; t++) {
        for (uint32_t c = 0; c <= experiment->contender_count; c++) {
            for (uint32_t k = 0; k < experiment->kind_count; k++)
                put(out, results, t, c, experiment->kinds[k]);
        }
    }
}

#define PREDICTION_NAME(name, meaning) "," #name
static const char prediction_names[] = RT_PREDICTIONS(PREDICTION_NAME) "\n";
#undef PREDICTION_NAME

/* The last columns of a row. */
static void put_predictions(FILE *out, const RtDescription *d) {
#define PUT_PREDICTION(name, meaning) fprintf(out, isfinite(d->name) ? ",%.9g" : ",", d->name);
    RT_PREDICTIONS(PUT_PREDICTION)
#undef PUT_PREDICTION
    fputc('\n', out);
}

static void put_counts(FILE *out, const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind) {
    const RtCell *cell = rt_cell_at(results, t, c, kind);
    const RtBuildResult *build = rt_build_at(results, t, c);
    const RtDescription *d = &build->shape;
    if (!cell->counted || !build->counts) return;
    put_identity(out, results, t, c, kind);
    for (size_t i = 1; i < RT_TALLY_COUNTER_COUNT; i++) {
        fprintf(out, ",%" PRIu64, rt_tally_get(&cell->tally, i));
    }
    fprintf(out, ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64 ",%" PRIu64, d->interior,
            d->leaves, d->empty_leaves, d->references, d->depth, d->bytes);
    put_predictions(out, d);
}

void rt_counts_csv(const RtResults *results, FILE *out) {
    fputs(identity, out);
    for (size_t i = 1; i < RT_TALLY_COUNTER_COUNT; i++) fprintf(out, ",%s", rt_tally_name(i));
    fputs(",interior,leaves,empty_leaves,references,structure_depth,bytes", out);
    fputs(prediction_names, out);
    each_cell(out, results, put_counts);
}

static void put_estimate(FILE *out, const RtEstimate *e, double scale) {
    fprintf(out, ",%.6g,%.6g,%.6g", scale * e->median, scale * e->low, scale * e->high);
}

/* An end of a ratio's interval is not shown as 1 if it is not 1. */
static void put_ratio_end(FILE *out, double end) {
    char text[32];
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, end);
        if (end == 1 || strtod(text, NULL) != 1) break;
    }
    fprintf(out, ",%s", text);
}

/* A counter, or nothing where it is not known. */
static void put_known(FILE *out, const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind,
                      uint64_t counter) {
    fputc(',', out);
    if (!isnan(rt_cell_per_ray(results, t, c, kind, counter))) fprintf(out, "%" PRIu64, counter);
}

static void put_times(FILE *out, const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind) {
    const RtCell *cell = rt_cell_at(results, t, c, kind);
    const RtBuildResult *build = rt_build_at(results, t, c);
    if (!cell->timed) return;
    put_identity(out, results, t, c, kind);
    fprintf(out, ",%d,%" PRIu32 ",%.6g", cell->threads, cell->rounds, rt_interval_coverage(cell->rounds));
    put_estimate(out, &cell->seconds, 1e9);
    fprintf(out, ",%.6g", 1e9 * cell->seconds.least);
    put_estimate(out, &cell->wall, 1e9);
    fprintf(out, ",%.6g", 1e-6 / cell->seconds.median);
    fprintf(out, ",%.6g", cell->ratio.median);
    put_ratio_end(out, cell->ratio.low);
    put_ratio_end(out, cell->ratio.high);
    fprintf(out, ",%.6g,%" PRIu64, build->seconds, build->shape.bytes);
    put_known(out, results, t, c, kind, cell->tally.object_tests);
    put_known(out, results, t, c, kind, cell->tally.extent_tests);
    put_known(out, results, t, c, kind, cell->tally.steps);
    fprintf(out, ",%" PRIu64, cell->differ);
    put_predictions(out, &build->shape);
}

void rt_times_csv(const RtResults *results, FILE *out) {
    fputs(identity, out);
    fputs(",threads,rounds,coverage,ns,ns_low,ns_high,ns_least,wall_ns,wall_ns_low,wall_ns_high,mrays_per_s,"
          "ratio,ratio_low,ratio_high,build_seconds,bytes,object_tests,extent_tests,steps,differ",
          out);
    fputs(prediction_names, out);
    each_cell(out, results, put_times);
}

/* ---- for the eye ---- */

void rt_format_figure(double value, char *out) {
    double size = fabs(value);
    int digits = size >= 99.95 ? 0 : size >= 9.995 ? 1 : size >= 0.9995 ? 2 : size >= 0.0995 ? 3 : 4;
    if (isnan(value)) {
        strcpy(out, "-");
    } else if (value == 0) {
        strcpy(out, "0");
    } else if (size < 0.00095 || size >= 1e7) {
        snprintf(out, 16, "%.1e", value);
    } else {
        snprintf(out, 16, "%.*f", digits, value);
    }
}

void rt_format_amount(double value, char *out) {
    if (value > 0 && value < 0.00095) {
        strcpy(out, "<0.001");
    } else {
        rt_format_figure(value, out);
    }
}

void rt_format_ratio(const RtEstimate *ratio, RtRatioText *out) {
    rt_format_figure(ratio->median, out->median);
    rt_format_figure(ratio->low, out->low);
    rt_format_figure(ratio->high, out->high);
    if (rt_estimate_holds(ratio, 1)) return;
    /* The end that is nearer to 1 says how many decimals all three get. */
    const char *nearer = ratio->low > 1 ? out->low : out->high;
    for (int decimals = 3; decimals <= 17 && strtod(nearer, NULL) == 1; decimals++) {
        snprintf(out->median, sizeof out->median, "%.*f", decimals, ratio->median);
        snprintf(out->low, sizeof out->low, "%.*f", decimals, ratio->low);
        snprintf(out->high, sizeof out->high, "%.*f", decimals, ratio->high);
    }
}

static void print_figure(FILE *out, int width, double value) {
    char text[16];
    rt_format_figure(value, text);
    fprintf(out, " %*s", width, text);
}

/* Width of the column of labels. */
static int label_width(const RtExperiment *experiment) {
    size_t width = 11;
    for (uint32_t c = 0; c < experiment->contender_count; c++) {
        size_t length = strlen(experiment->contenders[c].label);
        if (length > width) width = length;
    }
    return (int)width;
}

static void print_build(FILE *out, const RtBuildResult *build) {
    char milliseconds[16], megabytes[16];
    rt_format_amount(1e3 * build->seconds, milliseconds);
    rt_format_amount(1e-6 * (double)build->shape.bytes, megabytes);
    fprintf(out, " %8s %8s\n", milliseconds, megabytes);
}

static void print_scene(FILE *out, const RtResults *results, uint32_t t) {
    const RtTrialResult *trial = &results->trials[t];
    fprintf(out, "\n%s: %" PRIu32 " objects, %" PRIu32 "x%" PRIu32 ", depth %" PRIu32 "\n",
            results->experiment->trials[t].label, trial->objects, trial->width, trial->height,
            results->experiment->trials[t].depth);
}

static void print_cell(FILE *out, const RtResults *results, uint32_t t, uint32_t c, RtRayKind kind) {
    const RtCell *cell = rt_cell_at(results, t, c, kind);
    fprintf(out, "%-*s  %-12s %9" PRIu64, label_width(results->experiment),
            rt_contender_label(results->experiment, c), rt_ray_kind_name(kind), cell->tally.rays);
    print_figure(out, 9, rt_cell_per_ray(results, t, c, kind, cell->tally.object_tests));
    print_figure(out, 9, rt_cell_per_ray(results, t, c, kind, cell->tally.extent_tests));
    print_figure(out, 9, rt_cell_per_ray(results, t, c, kind, cell->tally.steps));
    if (cell->timed) {
        RtRatioText ratio;
        char interval[sizeof ratio];
        rt_format_ratio(&cell->ratio, &ratio);
        snprintf(interval, sizeof interval, "[%s, %s]", ratio.low, ratio.high);
        print_figure(out, 8, 1e-6 / cell->seconds.median);
        fprintf(out, " %7s %-16s", ratio.median, interval);
    } else {
        fprintf(out, " %8s %7s %-16s", "-", "-", "");
    }
    print_build(out, rt_build_at(results, t, c));
}

void rt_interval_title(const RtExperiment *experiment, char out[RT_MAX_INTERVAL_TITLE]) {
    double coverage = rt_interval_coverage(experiment->rounds);
    snprintf(out, RT_MAX_INTERVAL_TITLE, "%.3g %%",
             experiment->rounds >= RT_FULL_ROUNDS ? 95 : 100 * coverage);
}

void rt_print_cells(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    char interval[RT_MAX_INTERVAL_TITLE], title[RT_MAX_INTERVAL_TITLE + 2];
    rt_interval_title(experiment, interval);
    snprintf(title, sizeof title, "[%s]", interval);
    for (uint32_t t = 0; t < experiment->trial_count; t++) {
        if (!results->trials[t].known) continue;
        print_scene(out, results, t);
        fprintf(out, "%-*s  %-12s %9s %9s %9s %9s %8s %7s %-16s %8s %8s\n", label_width(experiment),
                "accelerator", "kind", "rays", "tests/ray", "ext./ray", "steps/ray", "Mrays/s", "ratio",
                title, "build ms", "MB");
        for (uint32_t k = 0; k < experiment->kind_count; k++) {
            RtRayKind kind = experiment->kinds[k];
            for (uint32_t c = 0; c <= experiment->contender_count; c++) {
                const RtCell *cell = rt_cell_at(results, t, c, kind);
                if (cell->counted || cell->timed) print_cell(out, results, t, c, kind);
            }
        }
    }
}

void rt_print_totals(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    for (uint32_t t = 0; t < experiment->trial_count; t++) {
        if (!results->trials[t].known) continue;
        print_scene(out, results, t);
        fprintf(out, "%-*s %9s %9s %9s %9s %9s %8s %8s %8s\n", label_width(experiment), "accelerator", "rays",
                "tests/ray", "ext./ray", "steps/ray", "ns/ray", "ratio", "build ms", "MB");
        for (uint32_t c = 0; c < experiment->contender_count; c++) {
            RtTotal total = rt_results_total(results, t, c);
            if (!rt_build_at(results, t, c)->known) continue;
            fprintf(out, "%-*s %9" PRIu64, label_width(experiment), experiment->contenders[c].label,
                    total.rays);
            print_figure(out, 9, total.object_tests);
            print_figure(out, 9, total.extent_tests);
            print_figure(out, 9, total.steps);
            print_figure(out, 9, 1e9 * total.seconds);
            print_figure(out, 8, total.ratio);
            print_build(out, rt_build_at(results, t, c));
        }
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
