/* SPDX-License-Identifier: Apache-2.0 */
#include "results/distribution_tables.h"

#include "core/base/words.h"
#include "results/result_tables.h"

typedef RtDistributionRow Row;

/* ---- columns ---- */

#define COLUMNS(X)                                                                                           \
    X(scene, "scene", text, "", "the scene's label", r->results->experiment->workloads[r->workload].label)   \
    X(kind, "kind", text, "", "kind of the rays; empty: leaves of the structure",                            \
      r->quantity < RT_RAY_QUANTITY_COUNT ? rt_experiment_kind_name(r->results->experiment, r->kind) : NULL) \
    X(accel, "accel", text, "", "the accelerator's label",                                                   \
      rt_candidate_label(r->results->experiment, r->candidate))                                              \
    X(quantity, "quantity", text, "",                                                                        \
      "object_tests, extent_tests, steps: per ray, each traced alone; leaf_size, leaf_depth: objects in "    \
      "the list of a leaf or voxel, and its depth",                                                          \
      rt_quantity_name(r->quantity))                                                                         \
    X(spec, "spec", text, "", "the accelerator with every effective parameter",                              \
      rt_build_at(r->results, r->workload, r->candidate)->spec)                                              \
    X(count, "count", integer, "", "rays, or leaves", r->distribution->count)                                \
    X(mean, "mean", real6, "", "mean of the quantity",                                                       \
      (double)r->distribution->sum / (double)r->distribution->count)                                         \
    X(median, "median", integer, "", "the smallest value that half of them do not exceed",                   \
      r->distribution->median)                                                                               \
    X(p90, "p90", integer, "", "the smallest that 90 % do not exceed", r->distribution->p90)                 \
    X(p99, "p99", integer, "", "the smallest that 99 % do not exceed", r->distribution->p99)                 \
    X(p999, "p999", integer, "", "the smallest that 99.9 % do not exceed", r->distribution->p999)            \
    X(max, "max", integer, "", "the largest value", r->distribution->most)                                   \
    X(low, "low", integer, "", "smallest value of the bin", rt_histogram_low(r->bin))                        \
    X(end, "end", integer, "", "smallest value above the bin", rt_histogram_low(r->bin + 1))                 \
    X(values, "values", integer, "", "rays, or leaves, within it", r->distribution->bins[r->bin])            \
    X(part, "part", real6, "", "as a fraction of all",                                                       \
      (double)r->distribution->bins[r->bin] / (double)r->distribution->count)

RT_TABLE_COLUMNS(columns, COLUMNS)

static const RtColumnGroup distributions[] = {RT_FROM_TO(columns, scene, max)};
static const RtColumnGroup histograms[] = {RT_FROM_TO(columns, scene, quantity),
                                           RT_FROM_TO(columns, low, part)};

/* ---- rows ---- */

/* By workload, then accelerator, then the quantities over each kind of rays, then those over leaves. */
static const RtDistribution *find(Row *r, size_t i) {
    const RtExperiment *e = r->results->experiment;
    const size_t over_rays = (size_t)e->kind_count * RT_RAY_QUANTITY_COUNT;
    const size_t of_one = over_rays + RT_LEAF_QUANTITY_COUNT, at = i % of_one;
    r->candidate = (uint32_t)(i / of_one % e->candidate_count);
    r->workload = (uint32_t)(i / of_one / e->candidate_count);
    const RtBuildResult *build = rt_build_at(r->results, r->workload, r->candidate);
    if (!build->counts) return NULL;
    if (at >= over_rays) {
        r->quantity = RT_RAY_QUANTITY_COUNT + at - over_rays;
        return build->leaves ? &build->leaves[at - over_rays] : NULL;
    }
    r->quantity = at % RT_RAY_QUANTITY_COUNT;
    r->kind = e->kinds[at / RT_RAY_QUANTITY_COUNT];
    const RtCell *cell = rt_cell_at(r->results, r->workload, r->candidate, r->kind);
    return cell->distributions ? &cell->distributions[r->quantity] : NULL;
}

static const void *row_at(void *context, size_t i) {
    Row *r = context;
    bool bins = r->which == RT_HISTOGRAMS;
    r->bin = bins ? (uint32_t)(i % RT_HISTOGRAM_BINS) : 0;
    r->distribution = find(r, bins ? i / RT_HISTOGRAM_BINS : i);
    if (!r->distribution || r->distribution->count == 0) return NULL;
    return bins && r->distribution->bins[r->bin] == 0 ? NULL : r;
}

RtTable rt_distribution_table(RtDistributionTable which, RtDistributionRow *row) {
    const RtExperiment *e = row->results->experiment;
    size_t quantities = (size_t)e->kind_count * RT_RAY_QUANTITY_COUNT + RT_LEAF_QUANTITY_COUNT;
    size_t rows = (size_t)e->workload_count * e->candidate_count * quantities;
    row->which = which;
    if (which == RT_DISTRIBUTIONS)
        return (RtTable){RT_GROUPS(distributions), .row_count = rows, .row = row_at, .context = row};
    return (RtTable){RT_GROUPS(histograms), .row_count = rows * RT_HISTOGRAM_BINS, .row = row_at,
                     .context = row};
}

/* ---- to read ---- */

/* Plugins report only how many leaves there are (include/raytally/accel.h). */
static void print_unknown_leaves(const RtResults *results, uint32_t t, FILE *out) {
    for (uint32_t c = 0; c < results->experiment->candidate_count; c++) {
        const RtBuildResult *build = rt_build_at(results, t, c);
        char text[RT_MAX_LABEL + 128];
        if (build->structure.leaves == 0 || build->leaves) continue;
        snprintf(
            text, sizeof text,
            "Leaf size and depth of %s are unknown: plugins report the number of leaves, not their contents.",
            rt_candidate_label(results->experiment, c));
        rt_print_wrapped(text, out);
    }
}

void rt_print_distributions(const RtResults *results, FILE *out) {
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        if (!results->workloads[t].known) continue;
        fprintf(out, "\n%s, distributions of counts:\n", results->experiment->workloads[t].label);
        rt_print_wrapped("Medians, 99th percentiles and maxima over the rays, or the leaves.", out);
        rt_print_rows(results, RT_PERCENTILES, t, out);
        rt_print_rows(results, RT_LEAF_PERCENTILES, t, out);
        print_unknown_leaves(results, t, out);
    }
}
