/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/frame_table.h"

#include "accel/accel.h"
#include "core/base/words.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* ---- costs ---- */

static bool is_in_part(RtRayKind kind, RtFramePart part) {
    const RtFramePart own = kind == RT_RAY_PRIMARY  ? RT_FRAME_PRIMARY
                            : kind == RT_RAY_SHADOW ? RT_FRAME_SHADOW
                                                    : RT_FRAME_SECONDARY;
    return rt_ray_kind_is_of_frame(kind) && (part == RT_FRAME_ALL || part == own);
}

static RtFrameCost cost_of(const RtResults *results, uint32_t workload, uint32_t candidate,
                           RtFramePart part) {
    const double unknown = (double)NAN;
    RtFrameCost sum = {0};
    for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const uint64_t rays = results->workloads[workload].rays[k];
        if (rays == 0 || !is_in_part((RtRayKind)k, part)) continue;
        const RtCost cost = rt_results_cost(results, workload, candidate, (RtRayKind)k);
        const double weight = (double)rays;
        sum.rays += rays;
        sum.object_tests += weight * cost.object_tests;
        sum.seconds += weight * cost.seconds.median;
        sum.low += weight * cost.seconds.low;
        sum.high += weight * cost.seconds.high;
    }
    if (sum.rays == 0) return (RtFrameCost){0, unknown, unknown, unknown, unknown};
    return sum;
}

static uint32_t without_of(const RtExperiment *experiment, uint32_t workload) {
    return rt_candidate_find(experiment, experiment->frame.without, workload);
}

/* The accelerator below an overlay, if it is measured too; else candidate_count. */
static uint32_t below_of(const RtResults *results, uint32_t workload, uint32_t candidate) {
    const RtExperiment *experiment = results->experiment;
    const char *plus = strchr(rt_build_at(results, workload, candidate)->spec, '+');
    uint32_t c = plus ? 0 : experiment->candidate_count;
    while (c < experiment->candidate_count && strcmp(rt_build_at(results, workload, c)->spec, plus + 1) != 0)
        c++;
    return c;
}

static double tests_of(const RtFrameCost *cost) {
    return cost->object_tests;
}

static double seconds_of(const RtFrameCost *cost) {
    return cost->seconds;
}

static double factor_of(const RtResults *results, uint32_t workload, uint32_t candidate,
                        double (*of)(const RtFrameCost *cost)) {
    const RtExperiment *experiment = results->experiment;
    const bool overlay = strchr(experiment->candidates[candidate].spec, '+') != NULL;
    uint32_t base = below_of(results, workload, candidate);
    if (base == experiment->candidate_count && overlay) return (double)NAN;
    if (base == experiment->candidate_count) base = without_of(experiment, workload);
    const RtFrameCost own = cost_of(results, workload, candidate, RT_FRAME_ALL);
    const RtFrameCost other = cost_of(results, workload, base, RT_FRAME_ALL);
    return of(&other) / of(&own);
}

/* By time, or by object tests if nothing was timed. */
static double gain_of(const RtResults *results, uint32_t workload, uint32_t candidate) {
    return factor_of(results, workload, candidate, results->experiment->count_only ? tests_of : seconds_of);
}

static bool is_compared(const RtExperiment *experiment, uint32_t candidate) {
    const RtCandidate *c = &experiment->candidates[candidate];
    const char *among = experiment->frame.among;
    return strncmp(c->group, among, strlen(among)) == 0 && strcmp(c->spec, rt_accel_yardstick()) != 0;
}

static uint32_t winner_of(const RtResults *results, uint32_t workload) {
    const RtExperiment *experiment = results->experiment;
    uint32_t best = experiment->candidate_count;
    double most = 0;
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        if (!is_compared(experiment, c) || !rt_candidate_runs(experiment, c, workload)) continue;
        const double gain = gain_of(results, workload, c);
        if (!(gain > most)) continue;
        most = gain;
        best = c;
    }
    return best;
}

/* ---- the table ---- */

typedef RtFrameRow Row;

static double faster(const Row *r, RtFramePart part) {
    return r->without[part].seconds / r->cost[part].seconds;
}

static RtField label_of(const Row *r) {
    return rt_field_print("%s %s", r->candidate == r->winner ? ">" : " ",
                          rt_candidate_label(r->results->experiment, r->candidate));
}

static const char *below_label(const Row *r) {
    const uint32_t below = below_of(r->results, r->workload, r->candidate);
    const RtExperiment *experiment = r->results->experiment;
    return below < experiment->candidate_count ? rt_candidate_label(experiment, below) : NULL;
}

#define COLUMNS(X)                                                                                           \
    X(scene, "scene", text, "", "the scene's label in the experiment",                                       \
      r->results->experiment->workloads[r->workload].label)                                                  \
    X(accel, "accelerator", text, "", "the accelerator's label in the experiment",                           \
      rt_candidate_label(r->results->experiment, r->candidate))                                              \
    X(group, "group", text, "", "its group in the experiment",                                               \
      r->results->experiment->candidates[r->candidate].group)                                                \
    X(rays, "rays", integer, "", "rays of the frame", r->cost[RT_FRAME_ALL].rays)                            \
    X(object_tests, "object_tests", real6, "", "object tests of the frame", r->cost[0].object_tests)         \
    X(times_fewer, "times_fewer", real6, "", "how many times fewer than without a structure",                \
      r->without[0].object_tests / r->cost[0].object_tests)                                                  \
    X(ms, "ms", real6, "ms", "time to trace the frame's rays, as the run timed it; sum of medians",          \
      1e3 * r->cost[0].seconds)                                                                              \
    X(ms_low, "ms_low", real6, "ms", "sum of the lower ends of the intervals", 1e3 * r->cost[0].low)         \
    X(ms_high, "ms_high", real6, "ms", "sum of the upper ends", 1e3 * r->cost[0].high)                       \
    X(times_faster, "times_faster", real6, "", "how many times faster than without a structure",             \
      faster(r, RT_FRAME_ALL))                                                                               \
    X(build_ms, "build_ms", real6, "ms", "time to build the structure",                                      \
      1e3 * rt_build_at(r->results, r->workload, r->candidate)->seconds)                                     \
    X(primary_faster, "primary_faster", real6, "", "times_faster of the primary rays alone",                 \
      faster(r, RT_FRAME_PRIMARY))                                                                           \
    X(shadow_faster, "shadow_faster", real6, "", "of the shadow rays", faster(r, RT_FRAME_SHADOW))           \
    X(secondary_faster, "secondary_faster", real6, "", "of reflection and transmission rays",                \
      faster(r, RT_FRAME_SECONDARY))                                                                         \
    X(below, "below", text, "", "for an overlay: the accelerator below it, if that is measured too",         \
      below_label(r))                                                                                        \
    X(gain, "gain", real6, "", "times_faster; for an overlay, relative to the accelerator below it",         \
      r->gain)                                                                                               \
    X(tests_gain, "tests_gain", real6, "", "the same for times_fewer", r->tests_gain)                        \
    X(winner, "winner", flag, "", "whether its gain is the largest of the compared accelerators",            \
      rt_field_flag(r->candidate == r->winner))                                                              \
    X(eye_label, "  accelerator", text, "", "> marks the one that helps most", label_of(r))                  \
    X(mega_tests, "Mtests", figure, "million", "object tests of the frame", 1e-6 * r->cost[0].object_tests)  \
    X(fewer, "fewer", figure, "", "times fewer object tests than without a structure",                       \
      r->without[0].object_tests / r->cost[0].object_tests)                                                  \
    X(eye_ms, "ms", figure, "ms", "time of the frame", 1e3 * r->cost[0].seconds)                             \
    X(eye_faster, "faster", figure, "", "times faster than without a structure", faster(r, RT_FRAME_ALL))    \
    X(eye_build, "build", amount, "ms", "time to build the structure, in ms",                                \
      1e3 * rt_build_at(r->results, r->workload, r->candidate)->seconds)                                     \
    X(primary, "primary", figure, "", "times faster for primary rays", faster(r, RT_FRAME_PRIMARY))          \
    X(shadow, "shadow", figure, "", "times faster for shadow rays", faster(r, RT_FRAME_SHADOW))              \
    X(secondary, "second", figure, "", "times faster for reflection and transmission rays",                  \
      faster(r, RT_FRAME_SECONDARY))

RT_TABLE_COLUMNS(columns, COLUMNS)

static const RtColumnGroup frame_csv[] = {RT_FROM_TO(columns, scene, winner)};
static const RtColumnGroup for_the_eye[] = {RT_ONE(columns, accel),
                                            RT_FROM_TO(columns, mega_tests, secondary)};
static const RtColumnGroup for_terminals[] = {RT_FROM_TO(columns, eye_label, secondary)};

static const void *row_at(void *context, size_t i) {
    Row *r = context;
    const RtExperiment *experiment = r->results->experiment;
    r->candidate = (uint32_t)(i % experiment->candidate_count);
    if (!r->one) r->workload = (uint32_t)(i / experiment->candidate_count);
    if (!rt_candidate_runs(experiment, r->candidate, r->workload) ||
        !rt_build_at(r->results, r->workload, r->candidate)->known)
        return NULL;
    const uint32_t without = without_of(experiment, r->workload);
    for (int part = 0; part < RT_FRAME_PARTS; part++) {
        r->cost[part] = cost_of(r->results, r->workload, r->candidate, (RtFramePart)part);
        r->without[part] = cost_of(r->results, r->workload, without, (RtFramePart)part);
    }
    r->gain = factor_of(r->results, r->workload, r->candidate, seconds_of);
    r->tests_gain = factor_of(r->results, r->workload, r->candidate, tests_of);
    r->winner = winner_of(r->results, r->workload);
    return r;
}

static RtStanding standing_of(const void *row) {
    const Row *r = row;
    return r->candidate == r->winner ? RT_STANDING_BEST : RT_STANDING_BEHIND;
}

RtTable rt_frame_table(RtFrameRow *row) {
    const RtExperiment *experiment = row->results->experiment;
    RtTable csv = {RT_GROUPS(frame_csv)}, eye = {RT_GROUPS(for_the_eye)}, table = row->one ? eye : csv;
    table.row_count = (size_t)experiment->candidate_count * (row->one ? 1 : experiment->workload_count);
    table.row = row_at;
    table.context = row;
    table.standing = standing_of;
    return table;
}

/* ---- in words ---- */

#define SAY(out, ...) rt_append_text(out, RT_MAX_FRAME_SENTENCE, __VA_ARGS__)

static const char *figure(double value, char size[16]) {
    rt_format_figure(value, size);
    return size;
}

/* The compared candidate on top of `below` with the next smaller gain after `previous`; candidate_count
 * before the first and after the last. */
static uint32_t next_of(const RtResults *results, uint32_t t, uint32_t below, uint32_t previous) {
    const uint32_t none = results->experiment->candidate_count;
    const double least = previous == none ? 0 : gain_of(results, t, previous);
    double most = 0;
    uint32_t best = none;
    for (uint32_t c = 0; c < none; c++) {
        if (!is_compared(results->experiment, c) || !rt_candidate_runs(results->experiment, c, t)) continue;
        const double gain = gain_of(results, t, c);
        const bool after = previous == none || gain < least || (gain == least && c > previous);
        if (below_of(results, t, c) != below || !after || !(gain > most)) continue;
        most = gain;
        best = c;
    }
    return best;
}

/* Whether the intervals of two timed frames overlap. */
static bool is_level(const RtResults *results, uint32_t t, uint32_t winner, uint32_t other) {
    const double low = cost_of(results, t, other, RT_FRAME_ALL).low;
    return !results->experiment->count_only && low <= cost_of(results, t, winner, RT_FRAME_ALL).high;
}

/* "octree follows with 230 times, grid with 122." All that are no overlays, without the winner. A winning
 * overlay has another base. */
static void say_followers(char *out, const RtResults *results, uint32_t t, uint32_t winner) {
    const RtExperiment *experiment = results->experiment;
    const uint32_t none = experiment->candidate_count;
    const bool overlay = below_of(results, t, winner) != none;
    char number[16];
    bool any = false;
    for (uint32_t c = overlay ? none : winner; (c = next_of(results, t, none, c)) != none; any = true) {
        if (!any && overlay) SAY(out, " Compared with %s,", experiment->frame.without);
        SAY(out, "%s %s %s%s%s%s", any ? "," : "", rt_candidate_label(experiment, c),
            any       ? "with "
            : overlay ? "comes with "
                      : "follows with ",
            figure(gain_of(results, t, c), number), any ? "" : " times",
            !overlay && is_level(results, t, winner, c) ? " (level: the intervals overlap)" : "");
    }
    SAY(out, "%s", any ? "." : "");
}

/* "Compared with wide alone, item+wide is 1.12 times as fast, and light+wide 1.00 times." Without the winner.
 */
static void say_overlays(char *out, const RtResults *results, uint32_t t, uint32_t winner) {
    const RtExperiment *experiment = results->experiment;
    const uint32_t none = experiment->candidate_count, told = below_of(results, t, winner);
    for (uint32_t below = 0; below < none; below++) {
        char number[16];
        bool any = false;
        for (uint32_t c = told == below ? winner : none; (c = next_of(results, t, below, c)) != none;
             any = true) {
            if (!any) SAY(out, " Compared with %s alone,", rt_candidate_label(experiment, below));
            SAY(out, "%s %s %s%s times%s", any ? ", and" : "", rt_candidate_label(experiment, c),
                any ? "" : "is ", figure(gain_of(results, t, c), number),
                any                      ? ""
                : experiment->count_only ? " better"
                                         : " as fast");
        }
        SAY(out, "%s", any ? "." : "");
    }
}

/* The fastest of all except the yardstick. */
static void say_fastest(char *out, const RtResults *results, uint32_t t, const RtFrameCost *without) {
    const RtExperiment *experiment = results->experiment;
    uint32_t best = experiment->candidate_count;
    double least = INFINITY;
    char number[16];
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        const RtFrameCost cost = cost_of(results, t, c, RT_FRAME_ALL);
        if (strcmp(experiment->candidates[c].spec, rt_accel_yardstick()) == 0) continue;
        if (!rt_candidate_runs(experiment, c, t) || !(cost.seconds < least)) continue;
        least = cost.seconds;
        best = c;
    }
    if (best == experiment->candidate_count) return;
    SAY(out, " The fastest structure is %s: %s times as fast as %s.", rt_candidate_label(experiment, best),
        figure(without->seconds / least, number), experiment->frame.without);
}

void rt_frame_sentence(const RtResults *results, uint32_t workload, char out[RT_MAX_FRAME_SENTENCE]) {
    const RtExperiment *experiment = results->experiment;
    const uint32_t winner = winner_of(results, workload), below = below_of(results, workload, winner);
    char number[16], tests[16];
    out[0] = '\0';
    if (winner == experiment->candidate_count) return;
    const bool overlay = below != experiment->candidate_count;
    const RtFrameCost cost = cost_of(results, workload, winner, RT_FRAME_ALL);
    const RtFrameCost without = cost_of(results, workload, without_of(experiment, workload), RT_FRAME_ALL);
    const RtFrameCost other = overlay ? cost_of(results, workload, below, RT_FRAME_ALL) : without;
    const double gain = gain_of(results, workload, winner);
    const char *than = overlay ? rt_candidate_label(experiment, below) : experiment->frame.without;
    SAY(out, "On %s, %s helps most of %s: ", experiment->workloads[workload].label,
        rt_candidate_label(experiment, winner), experiment->frame.among);
    if (!experiment->count_only) SAY(out, "%s times as fast, with ", figure(gain, number));
    SAY(out, "%s times fewer object tests than %s.", figure(other.object_tests / cost.object_tests, tests),
        than);
    say_followers(out, results, workload, winner);
    say_overlays(out, results, workload, winner);
    if (!experiment->count_only) say_fastest(out, results, workload, &without);
}

void rt_frame_title(const RtResults *results, uint32_t workload, char out[RT_MAX_FRAME_SENTENCE]) {
    const RtWorkloadResult *w = &results->workloads[workload];
    const RtWorkload *setup = &results->experiment->workloads[workload];
    const uint64_t samples = (uint64_t)(w->width + setup->corners) * (w->height + setup->corners);
    out[0] = '\0';
    SAY(out, "%" PRIu32 " object%s, %s frame of %" PRIu32 "x%" PRIu32 ": ", w->objects, rt_plural(w->objects),
        w->rays[RT_RAY_PRIMARY] == samples ? "a" : "a part of a", w->width, w->height);
    SAY(out, "%" PRIu64 " primary, %" PRIu64 " shadow and %" PRIu64 " secondary rays",
        w->rays[RT_RAY_PRIMARY], w->rays[RT_RAY_SHADOW],
        w->rays[RT_RAY_REFLECTION] + w->rays[RT_RAY_TRANSMISSION]);
}

/* ---- to read ---- */

void rt_frame_legend(const RtExperiment *experiment, char out[RT_MAX_FRAME_SENTENCE]) {
    snprintf(out, RT_MAX_FRAME_SENTENCE,
             "A whole frame: object tests in millions, time and build time in ms; how many times fewer "
             "tests, and how many times faster, than %s; then the same by kind of ray (second: reflection "
             "and transmission). > helps most of %s.",
             experiment->frame.without, experiment->frame.among);
}

static void print_rows(const RtResults *results, uint32_t workload, FILE *out) {
    RtFrameRow row = {.results = results, .one = true, .workload = workload};
    RtTable table = rt_frame_table(&row);
    table.groups = for_terminals;
    table.group_count = 1;
    int widths[RT_MAX_TABLE_COLUMNS];
    const char *group = "";
    rt_table_widths(&table, widths);
    rt_table_line(&table, widths, NULL, out);
    for (size_t i = 0; i < table.row_count; i++) {
        if (!table.row(table.context, i)) continue;
        const char *own = results->experiment->candidates[row.candidate].group;
        if (strcmp(own, group) != 0) fprintf(out, "%s\n", own);
        group = own;
        rt_table_line(&table, widths, &row, out);
    }
}

void rt_print_frames(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    char text[RT_MAX_FRAME_SENTENCE];
    fputc('\n', out);
    rt_frame_legend(experiment, text);
    rt_print_wrapped(text, out);
    if (*experiment->frame.note) rt_print_wrapped(experiment->frame.note, out);
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (!results->workloads[t].known) continue;
        rt_frame_title(results, t, text);
        fprintf(out, "\n%s: %s\n\n", experiment->workloads[t].label, text);
        print_rows(results, t, out);
    }
}
