/* SPDX-License-Identifier: Apache-2.0 */
/* Results for a terminal of 80 columns. */
#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "results/result_tables.h"

#include <inttypes.h>
#include <string.h>

void rt_interval_title(const RtExperiment *experiment, char out[RT_MAX_INTERVAL_TITLE]) {
    double coverage = rt_interval_coverage(experiment->rounds);
    snprintf(out, RT_MAX_INTERVAL_TITLE, "%.3g %%",
             experiment->rounds >= RT_FULL_ROUNDS ? 95 : 100 * coverage);
}

/* ---- one workload ---- */

/* `totals`: of a table of all kinds of rays together. */
static void print_title(const RtResults *results, uint32_t t, bool totals, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    const RtWorkloadResult *workload = &results->workloads[t];
    fprintf(out, "\n%s: %" PRIu32 " object%s, ", experiment->workloads[t].label, workload->objects,
            rt_plural(workload->objects));
    if (*experiment->rays_from) {
        fprintf(out, "rays of %s", experiment->rays_from);
    } else {
        fprintf(out, "%" PRIu32 "x%" PRIu32 ", depth %" PRIu32 ", seed %" PRIu64, workload->width,
                workload->height, experiment->workloads[t].depth, experiment->seed);
    }
    char part[RT_MAX_PART_TEXT];
    rt_results_say_part(results, 1u << t, rt_experiment_kinds(experiment), part);
    if (totals) fprintf(out, "; %s", part);
    fputc('\n', out);
}

/* A blank line and the rows of one workload. */
static void print_rows(const RtResults *results, RtResultTable which, uint32_t workload, FILE *out) {
    RtResultRow row = {.results = results, .workload = workload};
    const RtTable table = rt_result_table(which, &row);
    fputc('\n', out);
    rt_table_text(&table, out);
}

/* The baseline of the ratios, and the coverage of the intervals. */
static void print_ratios(const RtResults *results, uint32_t least, uint32_t most, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    char title[RT_MAX_INTERVAL_TITLE], rounds[32], text[RT_MAX_SENTENCE];
    rt_interval_title(experiment, title);
    snprintf(rounds, sizeof rounds, least == most ? "%" PRIu32 : "%" PRIu32 " to %" PRIu32, least, most);
    snprintf(text, sizeof text,
             "Ratios are throughput relative to %s, paired within each of %s round%s, with %s confidence "
             "intervals.",
             rt_baseline_label(experiment), rounds, rt_plural(most), title);
    rt_print_wrapped(text, out);
}

/* Prints and frees a text; nothing for "" or NULL. */
static void print_text(char *text, FILE *out) {
    if (text && *text) fputc('\n', out);
    if (text && *text) rt_print_wrapped(text, out);
    rt_free(text);
}

/* "octree:best, chosen by other rays: octree-16 (primary, shadow), octree (diffuse)." */
static void say_choice(const RtResults *results, uint32_t t, uint32_t best, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    const RtCandidate *candidate = &experiment->candidates[best];
    bool any = false;
    for (uint32_t i = 0; i < candidate->member_count; i++) {
        const char *names[RT_RAY_KIND_COUNT];
        char list[128];
        uint32_t count = 0;
        for (uint32_t k = 0; k < experiment->kind_count; k++) {
            const RtCell *cell = rt_cell_at(results, t, best, experiment->kinds[k]);
            if (cell->chosen && cell->choice == candidate->members[i])
                names[count++] = rt_experiment_kind_name(experiment, experiment->kinds[k]);
        }
        if (count == 0) continue;
        rt_join_names(names, count, list, sizeof list);
        if (any)
            fputc(',', out);
        else
            fprintf(out, "%s, chosen by other rays:", candidate->label);
        fprintf(out, " %s (%s)", experiment->candidates[candidate->members[i]].label, list);
        any = true;
    }
    fputs(any ? ". " : "", out);
}

char *rt_choices_sentences(const RtResults *results, uint32_t workload) {
    RtMemoryFile memory;
    RtError ignored;
    if (rt_memory_file_open(&memory, &ignored) != RT_OK) return NULL;
    for (uint32_t c = 0; c < results->experiment->candidate_count; c++)
        say_choice(results, workload, c, memory.file);
    return rt_memory_file_close(&memory, "sentences", &ignored) == RT_OK ? memory.data : NULL;
}

/* Accelerators measured on a part of the rays: their ratios are not the quotients of the throughputs. */
static void print_strides(const RtResults *results, uint32_t t, bool timed, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    char text[RT_MAX_SENTENCE];
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        const RtCandidate *candidate = &experiment->candidates[c];
        if (candidate->ray_stride == 1 || !rt_candidate_runs(experiment, c, t)) continue;
        snprintf(text, sizeof text, "* %s is measured on one in %" PRIu64 " rays.", candidate->label,
                 candidate->ray_stride);
        if (timed)
            rt_append_text(text, sizeof text,
                           "  Its ratio compares it with %s on the same rays, so it is not the quotient of "
                           "the throughputs above.",
                           rt_baseline_label(experiment));
        rt_print_wrapped(text, out);
    }
}

/* The accelerator of candidate c, if its answers there are of its own arithmetic; else NULL. */
static const RtAccelOps *inexact_ops(const RtResults *results, uint32_t t, uint32_t c) {
    const RtBuildResult *build = rt_build_at(results, t, c);
    const RtSpec *spec = &results->experiment->candidates[c].parsed;
    return build->known && !build->exact ? spec->layers[spec->layer_count - 1].ops : NULL;
}

/* A sentence for each accelerator with its own arithmetic: of all its settings and kinds of rays the most
 * answers that differ. */
static void print_differing(const RtResults *results, uint32_t t, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        const RtAccelOps *ops = inexact_ops(results, t, c);
        bool told = !ops;
        uint64_t most = 0, rays = 0;
        for (uint32_t earlier = 0; earlier < c; earlier++) told |= inexact_ops(results, t, earlier) == ops;
        for (RtCellCursor at = {0}; !told && rt_results_next(results, &at);) {
            if (at.workload != t || inexact_ops(results, t, at.candidate) != ops || !at.cell->counted ||
                at.cell->differ < most)
                continue;
            most = at.cell->differ;
            rays = at.cell->tally.rays;
        }
        if (rays == 0) continue;
        char text[RT_MAX_SENTENCE];
        const RtCandidate *one = &experiment->candidates[c];
        const char *name =
            one->parsed.of_parts ? one->spec : ops->name; /* perhaps only that of the parts is */
        snprintf(
            text, sizeof text,
            "%s uses its own arithmetic. Answers that differ from the reference, if only in the last bits "
            "of t: at most %" PRIu64 " of %" PRIu64 " of a kind; `raytally verify --accel %s` judges them.",
            name, most, rays, name);
        rt_print_wrapped(text, out);
    }
}

/* ---- rays that are learnt ---- */

/* The workload and its kinds: "on balls, 72 primary rays (bvh 1.3), ..."; false if none. Of a kind, the
 * accelerator whose rays are learnt most. */
static bool say_learnt(const RtResults *results, uint32_t t, const char *before, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    bool any = false;
    for (uint32_t k = 0; results->workloads[t].known && k < experiment->kind_count; k++) {
        const RtCell *most = NULL;
        uint32_t accel = 0;
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            const RtCell *cell = rt_cell_at(results, t, c, experiment->kinds[k]);
            if (!rt_cell_is_learnt(cell) || (most && cell->learnt <= most->learnt)) continue;
            most = cell;
            accel = c;
        }
        if (!most) continue;
        if (any)
            fputc(',', out);
        else
            fprintf(out, "%s on %s,", before, experiment->workloads[t].label);
        fprintf(out, " %" PRIu64 " %s ray%s (%s %.2f times)", most->tally.rays,
                rt_experiment_kind_name(experiment, experiment->kinds[k]), rt_plural(most->tally.rays),
                rt_candidate_label(experiment, accel), most->learnt);
        any = true;
    }
    return any;
}

char *rt_learnt_sentence(const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    const char *before = "Too few rays. They take longer with other rays between their passes:";
    RtMemoryFile memory;
    RtError ignored;
    bool any = false;
    if (rt_memory_file_open(&memory, &ignored) != RT_OK) return NULL;
    for (uint32_t t = 0; t < experiment->workload_count; t++)
        any |= say_learnt(results, t, any ? ";" : before, memory.file);
    if (any)
        fprintf(memory.file,
                ". Caches and branch predictors have learnt them, so the times are too short. %s.",
                *experiment->rays_from ? "Give more rays" : "Record more (a larger size or limit)");
    return rt_memory_file_close(&memory, "a sentence", &ignored) == RT_OK ? memory.data : NULL;
}

/* ---- tables of a workload ---- */

/* How often the structures were built. */
static void print_builds(const RtResults *results, uint32_t t, FILE *out) {
    uint32_t least = UINT32_MAX, most = 0;
    char text[RT_MAX_SENTENCE];
    for (uint32_t c = 0; c < results->experiment->candidate_count; c++) {
        const RtBuildResult *build = rt_build_at(results, t, c);
        if (!build->known) continue;
        least = build->builds < least ? build->builds : least;
        most = build->builds > most ? build->builds : most;
    }
    if (most == 0) return;
    snprintf(text, sizeof text, "Build times are medians of %" PRIu32, least);
    if (least < most) rt_append_text(text, sizeof text, " to %" PRIu32, most);
    rt_append_text(text, sizeof text, " build%s%s", rt_plural(most),
                   most == 1                ? ", without an interval."
                   : least < RT_FULL_ROUNDS ? "; intervals of fewer than 6 cover less than 95 %."
                                            : ", with 95 % intervals.");
    if (results->experiment->kind_count > 1)
        rt_append_text(text, sizeof text, " Break-evens are over all kinds of rays together.");
    rt_print_wrapped(text, out);
}

static void print_cells(const RtResults *results, uint32_t t, FILE *out) {
    uint32_t least = 0, most = rt_results_rounds(results, t, &least);
    const bool timed = most > 0;
    rt_print_wrapped("Object tests, extent tests and steps are per ray.", out);
    if (timed) print_ratios(results, least, most, out);
    print_rows(results, timed ? RT_CELLS : RT_COUNTED_CELLS, t, out);
    print_text(rt_choices_sentences(results, t), out);
    print_strides(results, t, timed, out);
    print_differing(results, t, out);
    print_rows(results, timed ? RT_STRUCTURES : RT_COUNTED_STRUCTURES, t, out);
    if (timed) print_builds(results, t, out);
}

void rt_print_results(const RtResults *results, RtResultTable which, FILE *out) {
    bool explained = which == RT_CELLS;
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        RtResultRow row = {.results = results, .workload = t};
        RtTable table = rt_result_table(which, &row);
        if (!results->workloads[t].known) continue;
        print_title(results, t, which == RT_TOTALS, out);
        if (which == RT_CELLS) {
            print_cells(results, t, out);
        } else {
            uint32_t least = 0, most = explained ? 0 : rt_results_rounds(results, t, &least);
            if (most > 0) print_ratios(results, least, most, out);
            explained |= most > 0;
            rt_table_text(&table, out);
            print_text(rt_choices_sentences(results, t), out);
            print_differing(results, t, out);
        }
    }
    print_text(rt_learnt_sentence(results), out);
}

/* ---- distributions ---- */

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
        print_rows(results, RT_PERCENTILES, t, out);
        print_rows(results, RT_LEAF_PERCENTILES, t, out);
        print_unknown_leaves(results, t, out);
    }
}

/* ---- null runs ---- */

typedef struct NullRuns {
    uint32_t runs, straddling; /* and those whose interval contains 1 */
    uint32_t fewest;           /* rounds of one; --until may have given them different numbers */
    double chance;             /* that an interval misses the median, on average */
} NullRuns;

static NullRuns null_runs_of(const RtResults *results) {
    NullRuns null = {.fewest = RT_MAX_ROUNDS};
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
            const RtCell *cell = rt_cell_at(results, t, results->experiment->candidate_count, (RtRayKind)k);
            if (!cell->timed) continue;
            null.runs++;
            null.straddling += rt_estimate_holds(&cell->ratio, 1);
            null.chance += 1 - rt_interval_coverage(cell->rounds);
            null.fewest = cell->rounds < null.fewest ? cell->rounds : null.fewest;
        }
    }
    null.chance /= null.runs;
    return null;
}

void rt_null_sentence(const RtResults *results, char out[RT_MAX_SENTENCE]) {
    const RtExperiment *experiment = results->experiment;
    const NullRuns null = null_runs_of(results);
    const uint32_t misses = null.runs - null.straddling;
    out[0] = '\0';
    if (null.runs == 0) return;
    snprintf(out, RT_MAX_SENTENCE,
             "Null runs: %s is %s measured a second time, to show the noise; %" PRIu32 " of %" PRIu32
             " interval%s include%s 1",
             experiment->again,
             experiment->candidates[rt_candidate_built(experiment, experiment->candidate_count)].label,
             null.straddling, null.runs, rt_plural(null.runs), null.runs == 1 ? "s" : "");
    if (misses == 0)
        rt_append_text(out, RT_MAX_SENTENCE, ", as expected.");
    else if (rt_binomial_tail(misses, null.runs, null.chance) >= 0.05)
        rt_append_text(out, RT_MAX_SENTENCE, "; each misses it by chance in %.3g %% of all cases.",
                       100 * null.chance);
    else
        rt_append_text(out, RT_MAX_SENTENCE, ": the machine was busy; treat small differences as noise.");
    if (null.fewest >= RT_FULL_ROUNDS) return;
    rt_append_text(out, RT_MAX_SENTENCE,
                   " Rounds: %" PRIu32 ", too few for 95 %%; an interval spans all measurements and contains "
                   "the median with %.3g %% confidence. Use %d or more.",
                   null.fewest, 100 * rt_interval_coverage(null.fewest), RT_FULL_ROUNDS);
}

/* ---- the end of a run ---- */

void rt_print_outcome(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    const bool frames = *experiment->frame.without;
    if (frames)
        rt_print_frames(results, out);
    else
        rt_print_results(results, RT_TOTALS, out);
    for (uint32_t t = 0; frames && t < experiment->workload_count; t++)
        print_text(rt_choices_sentences(results, t), out);
    if (frames) print_text(rt_learnt_sentence(results), out);
    for (uint32_t t = 0; experiment->render && t < experiment->workload_count; t++) {
        if (!results->workloads[t].known) continue;
        fprintf(out, "\n%s, rendering the frame:\n", experiment->workloads[t].label);
        print_rows(results, RT_RENDER_ROWS, t, out);
    }
    rt_print_left_out(results, out);
}

void rt_print_null_runs(const RtResults *results, FILE *out) {
    char text[RT_MAX_SENTENCE];
    rt_null_sentence(results, text);
    fputc('\n', out);
    if (*text) rt_print_wrapped(text, out);
}
