/* SPDX-License-Identifier: Apache-2.0 */

#include "accel/accel.h"
#include "core/base/file.h"
#include "core/base/words.h"
#include "results/result_tables.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

/* ---- costs ---- */

static RtKinds kinds_of(RtFramePart part) {
    RtKinds kinds = 0;
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const RtFramePart own = k == RT_RAY_PRIMARY  ? RT_FRAME_PRIMARY
                                : k == RT_RAY_SHADOW ? RT_FRAME_SHADOW
                                                     : RT_FRAME_SECONDARY;
        if (rt_ray_kind_is_of_frame((RtRayKind)k) && (part == RT_FRAME_ALL || part == own)) kinds |= 1u << k;
    }
    return kinds;
}

static RtCost cost_of(const RtResults *results, uint32_t workload, uint32_t candidate, RtFramePart part) {
    RtCost sum = rt_results_total(results, workload, candidate, kinds_of(part));
    if (sum.whole && sum.weight > 0) return sum;
    sum.object_tests = (double)NAN;
    sum.seconds = rt_estimate_exactly((double)NAN);
    return sum;
}

static uint32_t without_of(const RtExperiment *experiment, uint32_t workload) {
    return rt_candidate_find(experiment, experiment->frame.without, workload);
}

static double tests_of(const RtResults *results, uint32_t workload, uint32_t candidate) {
    return cost_of(results, workload, candidate, RT_FRAME_ALL).object_tests;
}

static double seconds_of(const RtResults *results, uint32_t workload, uint32_t candidate) {
    return cost_of(results, workload, candidate, RT_FRAME_ALL).seconds.median;
}

static bool is_overlay(const RtExperiment *experiment, uint32_t candidate) {
    return strchr(experiment->candidates[candidate].spec, '+') != NULL;
}

/* Of the compared accelerators the one that takes least time, or fewest object tests if nothing was timed;
 * candidate_count if there is none. The yardstick is left out. */
static uint32_t winner_of(const RtResults *results, uint32_t workload) {
    const RtExperiment *experiment = results->experiment;
    uint32_t best = experiment->candidate_count;
    double least = INFINITY;
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        const RtCandidate *candidate = &experiment->candidates[c];
        const double own = (experiment->count_only ? tests_of : seconds_of)(results, workload, c);
        if (strcmp(candidate->group, experiment->frame.among) != 0 || is_overlay(experiment, c) ||
            candidate->tried || strcmp(candidate->spec, rt_accel_yardstick()) == 0 ||
            !rt_candidate_runs(experiment, c, workload) || !(own < least))
            continue;
        least = own;
        best = c;
    }
    return best;
}

/* ---- the table ---- */

typedef RtFrameRow Row;

static double faster(const Row *r, RtFramePart part) {
    return r->without[part].seconds.median / r->cost[part].seconds.median;
}

#define COLUMNS(X)                                                                                           \
    X(scene, "scene", text, "", "the scene's label", r->results->experiment->workloads[r->workload].label)   \
    X(accel, "accelerator", text, "", "the accelerator's label",                                             \
      rt_candidate_label(r->results->experiment, r->candidate))                                              \
    X(group, "group", text, "", "its group in the experiment",                                               \
      r->results->experiment->candidates[r->candidate].group)                                                \
    X(rays, "rays", integer, "", "rays of the whole frame", (uint64_t)r->cost[0].weight)                     \
    X(object_tests, "object_tests", real6, "", "object tests of the frame", r->cost[0].object_tests)         \
    X(times_fewer, "times_fewer", real6, "", "how many times fewer than without a structure",                \
      r->without[0].object_tests / r->cost[0].object_tests)                                                  \
    X(ms, "ms", real6, "ms", "time to trace the frame's rays, as the run timed it; sum of medians",          \
      1e3 * r->cost[0].seconds.median)                                                                       \
    X(ms_low, "ms_low", real6, "ms", "sum of the lower ends of the intervals", 1e3 * r->cost[0].seconds.low) \
    X(ms_high, "ms_high", real6, "ms", "sum of the upper ends", 1e3 * r->cost[0].seconds.high)               \
    X(times_faster, "times_faster", real6, "", "how many times faster than without a structure",             \
      faster(r, RT_FRAME_ALL))                                                                               \
    X(build_ms, "build_ms", real6, "ms", "time to build the structure",                                      \
      r->build->known ? 1e3 * r->build->seconds.median : (double)NAN)                                        \
    X(primary_faster, "primary_faster", real6, "", "times_faster of the primary rays alone",                 \
      faster(r, RT_FRAME_PRIMARY))                                                                           \
    X(shadow_faster, "shadow_faster", real6, "", "times_faster of the shadow rays alone",                    \
      faster(r, RT_FRAME_SHADOW))                                                                            \
    X(secondary_faster, "secondary_faster", real6, "",                                                       \
      "times_faster of reflection and transmission rays alone", faster(r, RT_FRAME_SECONDARY))               \
    X(winner, "winner", flag, "", "whether it is marked as the fastest of the compared group",               \
      rt_field_flag(r->candidate == r->winner))                                                              \
    X(eye_label, "  accelerator", text, "", "> marks the fastest of those compared", r->shown)               \
    X(mega_tests, "Mtests", figure, "million", "object tests of the frame", 1e-6 * r->cost[0].object_tests)  \
    X(fewer, "fewer", figure, "", "times fewer object tests than without a structure",                       \
      r->without[0].object_tests / r->cost[0].object_tests)                                                  \
    X(eye_ms, "ms", figure, "ms", "time of the frame", 1e3 * r->cost[0].seconds.median)                      \
    X(eye_faster, "faster", figure, "", "times faster than without a structure", faster(r, RT_FRAME_ALL))    \
    X(eye_build, "build", interval, "ms", "time to build the structure, in ms, with its interval",           \
      rt_build_ms(r->build))                                                                                 \
    X(primary, "primary", figure, "", "times faster for primary rays", faster(r, RT_FRAME_PRIMARY))          \
    X(shadow, "shadow", figure, "", "times faster for shadow rays", faster(r, RT_FRAME_SHADOW))              \
    X(secondary, "bounce", figure, "", "times faster for reflection and transmission rays",                  \
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
    const RtCandidate *candidate = &experiment->candidates[r->candidate];
    const bool chosen = candidate->member_count && !isnan(seconds_of(r->results, r->workload, r->candidate));
    r->build = rt_build_at(r->results, r->workload, r->candidate);
    if (candidate->tried || !rt_candidate_runs(experiment, r->candidate, r->workload) ||
        !(chosen || r->build->known))
        return NULL;
    const uint32_t without = without_of(experiment, r->workload);
    for (int part = 0; part < RT_FRAME_PARTS; part++) {
        r->cost[part] = cost_of(r->results, r->workload, r->candidate, (RtFramePart)part);
        r->without[part] = cost_of(r->results, r->workload, without, (RtFramePart)part);
    }
    r->winner = winner_of(r->results, r->workload);
    strcpy(r->shown, r->candidate == r->winner ? "> " : "  ");
    rt_candidate_show(experiment, r->candidate, r->shown + 2);
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

/* ---- to read ---- */

void rt_frame_title(const RtResults *results, uint32_t workload, char out[RT_MAX_FRAME_TEXT]) {
    const RtWorkloadResult *w = &results->workloads[workload];
    const RtWorkload *setup = &results->experiment->workloads[workload];
    const double samples = (double)(w->width + setup->corners) * (w->height + setup->corners);
    double rays[RT_RAY_KIND_COUNT];
    char part[RT_MAX_PART_TEXT];
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rays[k] = rt_results_weight(results, workload, (RtRayKind)k);
    rt_results_say_part(results, 1u << workload, kinds_of(RT_FRAME_ALL), part);
    snprintf(out, RT_MAX_FRAME_TEXT,
             "%" PRIu32 " object%s, %s frame of %" PRIu32 "x%" PRIu32
             ": %.0f primary, %.0f shadow and %.0f secondary rays; %s",
             w->objects, rt_plural(w->objects), rays[RT_RAY_PRIMARY] == samples ? "a" : "a part of a",
             w->width, w->height, rays[RT_RAY_PRIMARY], rays[RT_RAY_SHADOW],
             rays[RT_RAY_REFLECTION] + rays[RT_RAY_TRANSMISSION], part);
}

void rt_frame_legend(const RtExperiment *experiment, const char *mark, char out[RT_MAX_FRAME_TEXT]) {
    snprintf(out, RT_MAX_FRAME_TEXT,
             "Mtests: object tests of a whole frame, in millions; ms: time to trace it; build: ms to build, "
             "both on as many threads. fewer, faster: how many times, than %s; primary, shadow, bounce "
             "(reflection and transmission): how many times faster. -: no such rays, or not counted. "
             "%s: the %s of %s.",
             experiment->frame.without, mark, experiment->count_only ? "best" : "fastest",
             experiment->frame.among);
}

/* The group of the rows below, where it is another one. */
static void put_group(void *context, const void *current, FILE *out) {
    Row *r = context;
    const char *group = current ? r->results->experiment->candidates[r->candidate].group : "";
    if (current && strcmp(group, r->group) != 0) fprintf(out, "%s\n", group);
    r->group = group;
}

void rt_print_frames(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    char text[RT_MAX_FRAME_TEXT], title[RT_MAX_LABEL + RT_MAX_FRAME_TEXT];
    fputc('\n', out);
    rt_frame_legend(experiment, ">", text);
    rt_print_wrapped(text, out);
    if (*experiment->frame.note) rt_print_wrapped(experiment->frame.note, out);
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (!results->workloads[t].known) continue;
        rt_frame_title(results, t, text);
        snprintf(title, sizeof title, "%s: %s", experiment->workloads[t].label, text);
        fputc('\n', out);
        rt_print_wrapped(title, out);
        RtFrameRow row = {.results = results, .one = true, .workload = t};
        RtTable table = rt_frame_table(&row);
        table.groups = for_terminals;
        table.group_count = 1;
        table.above = put_group;
        fputc('\n', out);
        rt_table_text(&table, out);
    }
}
