/* SPDX-License-Identifier: Apache-2.0 */
#include "report/paper_tables.h"

#include "core/base/file.h"
#include "core/base/words.h"
#include "core/text/table.h"
#include "results/result_tables.h"

#include <math.h>
#include <string.h>

/* Characters of `footnotesize` (8 points) that fit a column and a page of a two-column article. */
enum { COLUMN_WIDTH = 50, PAGE_WIDTH = 104 };

typedef enum Measure { TIME, OBJECT_TESTS, EXTENT_TESTS, STEPS, BUILD, RATIO } Measure;
static const char *const titles[] = {"Time per ray in ns", "Object tests per ray", "Extent tests per ray",
                                     "Steps per ray",      "Time to build in ms",  "Throughput relative to"};

/* A row per accelerator, a column per scene. */
typedef struct Pivot {
    const RtResults *results;
    Measure measure;
    RtRayKind kind; /* or RT_ALL_RAYS */
    bool intervals;
    bool unmarked;      /* only widths are wanted: looking for the best takes much longer */
    uint32_t candidate; /* of the row */
    uint32_t count;     /* of the columns, with that of accelerators */
    RtTableColumn columns[1 + RT_MAX_WORKLOADS];
    RtColumnGroup group;
} Pivot;

/* ---- cells ---- */

static RtEstimate in_units(const RtEstimate *seconds, double a_second) {
    return (RtEstimate){a_second * seconds->median, a_second * seconds->low, a_second * seconds->high, 0};
}

static uint32_t baseline_of(const RtResults *results) {
    return results->experiment->baseline_count > 1 ? RT_FASTEST_BASELINE : results->experiment->baseline;
}

static RtEstimate estimate_of(const Pivot *p, uint32_t workload, uint32_t candidate) {
    const RtCost cost = rt_results_cost(p->results, workload, candidate, p->kind);
    const RtBuildResult *build = rt_build_at(p->results, workload, candidate);
    switch (p->measure) {
    case TIME: return in_units(&cost.seconds, 1e9);
    case OBJECT_TESTS: return rt_estimate_exactly(cost.object_tests);
    case EXTENT_TESTS: return rt_estimate_exactly(cost.extent_tests);
    case STEPS: return rt_estimate_exactly(cost.steps);
    case RATIO:
        return rt_results_time_ratio(p->results, workload, baseline_of(p->results), candidate, p->kind, 0.95);
    default: return build->known ? in_units(&build->seconds, 1e3) : rt_estimate_exactly((double)NAN);
    }
}

/* Whether it is the least of the scene, or its interval overlaps with that of the least. Tables of extent
 * tests, of steps and of builds have no best: without a structure there are none. */
static bool is_best(const Pivot *p, uint32_t workload) {
    const bool time = p->measure == TIME || p->measure == RATIO;
    return (time || p->measure == OBJECT_TESTS) &&
           rt_standing_by(time, p->results, workload, p->candidate, p->kind) != RT_STANDING_BEHIND;
}

static RtField get_label(const void *row, const RtTableColumn *column) {
    const Pivot *p = row;
    (void)column;
    return rt_field_text(p->results->experiment->candidates[p->candidate].label);
}

static RtField get_cell(const void *row, const RtTableColumn *column) {
    const Pivot *p = row;
    const uint32_t workload = (uint32_t)column->key;
    const RtEstimate value = estimate_of(p, workload, p->candidate);
    if (isnan(value.median)) return rt_field_missing();
    const bool spread = p->intervals && value.low < value.high;
    RtField field =
        spread ? rt_field_interval(value.median, value.low, value.high) : rt_field_real(value.median);
    field.bold = !p->unmarked && is_best(p, workload);
    return field;
}

static const void *row_of(void *context, size_t i) {
    Pivot *p = context;
    p->candidate = (uint32_t)i;
    for (uint32_t c = 1; c < p->count; c++) {
        if (!isnan(estimate_of(p, (uint32_t)p->columns[c].key, p->candidate).median)) return p;
    }
    return NULL;
}

/* ---- columns ---- */

/* Scenes of one sweep have the value as their name, and a table of their own. */
static bool is_swept(const RtWorkload *workload) {
    return workload->swept.count > 0;
}

static bool same_table(const RtWorkload *a, const RtWorkload *b) {
    return is_swept(a) || is_swept(b) ? strcmp(a->stem, b->stem) == 0 : true;
}

static const char *name_of(const RtWorkload *workload) {
    const size_t stem = strlen(workload->stem);
    const bool value = is_swept(workload) && strncmp(workload->label, workload->stem, stem) == 0 &&
                       workload->label[stem] == ':';
    return workload->label + (value ? stem + 1 : 0);
}

static bool is_measured(const Pivot *p, uint32_t workload) {
    if (!p->results->workloads[workload].known) return false;
    for (uint32_t c = 0; c < p->results->experiment->candidate_count; c++) {
        if (!isnan(estimate_of(p, workload, c).median)) return true;
    }
    return false;
}

static void add_column(Pivot *p, const char *name, int key,
                       RtField (*get)(const void *row, const RtTableColumn *column)) {
    p->columns[p->count++] = (RtTableColumn){
        name, name,
        "",   titles[p->measure],
        get,  get == get_label ? RT_FORM_text : p->intervals ? RT_FORM_interval : RT_FORM_figure,
        key};
}

static RtTable table_of(Pivot *p) {
    p->group = (RtColumnGroup){NULL, p->columns, p->count, NULL};
    return (RtTable){&p->group, 1, .row_count = p->results->experiment->candidate_count, .row = row_of,
                     .context = p};
}

static uint32_t width_of(Pivot *p) {
    int widths[RT_MAX_TABLE_COLUMNS];
    const RtTable table = table_of(p);
    uint32_t width = 0;
    p->unmarked = true;
    rt_table_widths(&table, widths);
    p->unmarked = false;
    for (uint32_t c = 0; c < p->count; c++) width += (uint32_t)widths[c] + (c > 0 ? 2 : 0);
    return width;
}

/* Takes scenes from `first` on, as many as one table has room for; returns the first that it leaves. */
static uint32_t add_scenes(Pivot *p, uint32_t first) {
    const RtExperiment *experiment = p->results->experiment;
    const RtWorkload *before = NULL;
    p->count = 0;
    add_column(p, "accelerator", 0, get_label);
    for (uint32_t t = first; t < experiment->workload_count; t++) {
        const RtWorkload *workload = &experiment->workloads[t];
        if (!is_measured(p, t)) continue;
        if (before && !same_table(before, workload)) return t;
        add_column(p, name_of(workload), (int)t, get_cell);
        if (before && width_of(p) > PAGE_WIDTH) {
            p->count--;
            return t;
        }
        before = workload;
    }
    return experiment->workload_count;
}

/* ---- files ---- */

static bool has_intervals(Measure measure) {
    return measure == TIME || measure == BUILD || measure == RATIO;
}

static void put_table(Pivot *p, bool tex, FILE *out) {
    const RtExperiment *experiment = p->results->experiment;
    const RtWorkload *scene = &experiment->workloads[p->columns[1].key];
    char caption[2 * RT_MAX_LABEL + 192], part[RT_MAX_PART_TEXT];
    uint32_t scenes = 0;
    RtTable table = table_of(p);
    snprintf(caption, sizeof caption, "%s", titles[p->measure]);
    if (p->measure == RATIO)
        rt_append_text(caption, sizeof caption, " %s, paired by round", rt_baseline_label(experiment));
    if (p->measure != BUILD && p->kind == RT_ALL_RAYS) {
        for (uint32_t c = 1; c < p->count; c++) scenes |= 1u << p->columns[c].key;
        rt_results_say_part(p->results, scenes, rt_experiment_kinds(experiment), part);
        rt_append_text(caption, sizeof caption, ", all kinds of rays, %s", part);
    }
    if (p->measure != BUILD && p->kind != RT_ALL_RAYS)
        rt_append_text(caption, sizeof caption, ", %s rays", rt_experiment_kind_name(experiment, p->kind));
    rt_append_text(caption, sizeof caption, is_swept(scene) ? ", %s." : ".", scene->stem);
    table.caption = caption;
    table.wide = width_of(p) > COLUMN_WIDTH;
    if (tex) {
        fputc('\n', out);
        rt_table_tex(&table, out);
    } else {
        fprintf(out, "\n%s\n\n", caption);
        rt_table_markdown(&table, out);
    }
}

/* With intervals if a page has room for them beside all scenes. */
static void put_pivots(const RtResults *results, Measure measure, RtRayKind kind, bool tex, FILE *out) {
    const uint32_t scenes = results->experiment->workload_count;
    Pivot p = {.results = results, .measure = measure, .kind = kind};
    for (uint32_t first = 0; first < scenes;) {
        p.intervals = has_intervals(measure);
        const uint32_t with = add_scenes(&p, first);
        p.intervals = false;
        const uint32_t without = add_scenes(&p, first);
        p.intervals = with == without && has_intervals(measure);
        first = without;
        if (p.count > 1) put_table(&p, tex, out);
    }
}

static void put_head(const RtResults *results, bool tex, FILE *out) {
    char interval[RT_MAX_INTERVAL_TITLE];
    const char *lead = tex ? "% " : "";
    rt_interval_title(results->experiment, interval);
    fprintf(out,
            tex ? "%% %s, written by raytally. Needs \\usepackage{booktabs}.\n"
                : "# %s\n\nWritten by `raytally`.\n",
            results->experiment->name);
    fprintf(out, "%sBold: the fewest object tests%s.\n", lead,
            results->experiment->count_only
                ? ""
                : "; the least time, and times whose interval overlaps its interval");
    if (!results->experiment->count_only)
        fprintf(out, "%sIn brackets: %s intervals, where there is room for them.\n", lead, interval);
}

static RtStatus write_tables(const RtResults *results, const char *directory, const char *name, bool tex,
                             RtError *error) {
    const RtExperiment *experiment = results->experiment;
    const bool counts = experiment->count_only;
    const Measure lead = counts ? OBJECT_TESTS : TIME, last = counts ? STEPS : BUILD;
    const bool one = experiment->kind_count == 1;
    RtOutput output;
    RT_TRY(rt_output_open_in(&output, directory, name, error));
    put_head(results, tex, output.file);
    for (Measure m = lead; m <= last; m++)
        put_pivots(results, m, one ? experiment->kinds[0] : RT_ALL_RAYS, tex, output.file);
    for (uint32_t k = 0; !one && k < experiment->kind_count; k++)
        put_pivots(results, lead, experiment->kinds[k], tex, output.file);
    for (uint32_t k = 0; !counts && k < experiment->kind_count; k++)
        put_pivots(results, RATIO, experiment->kinds[k], tex, output.file);
    return rt_output_commit(&output, error);
}

RtStatus rt_paper_tables_write(const RtResults *results, const char *directory, RtError *error) {
    RT_TRY(write_tables(results, directory, "tables.md", false, error));
    return write_tables(results, directory, "tables.tex", true, error);
}
