/* SPDX-License-Identifier: Apache-2.0 */
#include "results/journal_lines.h"

#include "core/base/memory.h"
#include "core/text/json.h"
#include "experiment/plugins_used.h"

#include <math.h>

/* ---- members ---- */

#define SET(CONSTANT, name, meaning)                                                                         \
    static const RtMember name##_members[] = {                                                               \
        RT_MEMBER(RtWorkloadResult, COUNT, "rays", rays[RT_RAY_##CONSTANT]),                                 \
        RT_MEMBER(RtWorkloadResult, ADDED_COUNT, "whole_rays", whole_rays[RT_RAY_##CONSTANT]),               \
        RT_MEMBER(RtWorkloadResult, HASH, "hash", ray_fingerprints[RT_RAY_##CONSTANT])};
RT_RAY_KINDS(SET)

#define SET_RECORD(CONSTANT, name, meaning) RT_RECORD(name##_members),
const RtRecord rt_ray_set_records[RT_RAY_KIND_COUNT] = {RT_RAY_KINDS(SET_RECORD)};

#define SET_MEMBER(CONSTANT, name, meaning) RT_MEMBER_OF(#name, &rt_ray_set_records[RT_RAY_##CONSTANT]),
static const RtMember sets_members[] = {RT_RAY_KINDS(SET_MEMBER)};
static const RtRecord sets = RT_RECORD(sets_members);

static const RtMember workload_members[] = {
    RT_MEMBER(RtWorkloadResult, U32, "objects", objects), RT_MEMBER(RtWorkloadResult, U32, "width", width),
    RT_MEMBER(RtWorkloadResult, U32, "height", height), RT_MEMBER(RtWorkloadResult, HASH, "hash", scene),
    RT_MEMBER_OF("sets", &sets)};

#define COST_OF_BUILD(name, meaning) RT_MEMBER(RtBuildResult, COUNT, #name, structure.build.name),
static const RtMember build_tally_members[] = {RT_TALLY_COUNTERS(COST_OF_BUILD)};
static const RtRecord build_tally = RT_RECORD(build_tally_members);

#define EXPECTED(name, meaning) RT_MEMBER(RtBuildResult, NUMBER, #name, structure.name),
static const RtMember build_members[] = {
    RT_MEMBER(RtBuildResult, COUNT, "interior", structure.interior),
    RT_MEMBER(RtBuildResult, COUNT, "leaves", structure.leaves),
    RT_MEMBER(RtBuildResult, COUNT, "empty_leaves", structure.empty_leaves),
    RT_MEMBER(RtBuildResult, COUNT, "references", structure.references),
    RT_MEMBER(RtBuildResult, COUNT, "depth", structure.depth),
    RT_PREDICTIONS(EXPECTED) RT_QUALITIES(EXPECTED) RT_MEMBER_OF("build", &build_tally),
    RT_MEMBER(RtBuildResult, TEXT, "spec", spec),
    RT_MEMBER(RtBuildResult, FLAG, "exact", exact),
    RT_MEMBER(RtBuildResult, FLAG, "counts", counts),
    RT_MEMBER(RtBuildResult, ESTIMATE, "seconds", seconds),
    RT_MEMBER(RtBuildResult, COUNT, "bytes", structure.bytes),
    RT_MEMBER_RANGE(RtBuildResult, ADDED, "builds", builds, 0, RT_MAX_ROUNDS)};

#define COUNTER(name, meaning) RT_MEMBER(RtCell, COUNT, #name, tally.name),
static const RtMember count_members[] = {RT_TALLY_COUNTERS(COUNTER)
                                             RT_MEMBER(RtCell, COUNT, "differ", differ)};

static const RtMember time_members[] = {
    RT_MEMBER_RANGE(RtCell, COUNT, "rays", tally.rays, 1, 0),
    RT_MEMBER_RANGE(RtCell, U32, "rounds", rounds, 1, RT_MAX_ROUNDS),
    RT_MEMBER(RtCell, NUMBER, "repeats", repeats),
    RT_MEMBER_RANGE(RtCell, ADDED, "structures", structures, 0, RT_MAX_ROUNDS),
    RT_MEMBER_RANGE(RtCell, INT, "threads", threads, 1, 0),
    RT_MEMBER(RtCell, ESTIMATE, "seconds", seconds),
    RT_MEMBER(RtCell, ESTIMATE, "wall", wall),
    RT_MEMBER(RtCell, RATIO, "ratio", ratio)};

static const RtMember render_members[] = {
    RT_MEMBER_RANGE(RtBuildResult, U32, "rounds", render.rounds, 1, RT_MAX_ROUNDS),
    RT_MEMBER_RANGE(RtBuildResult, INT, "threads", render.threads, 1, 0),
    RT_MEMBER(RtBuildResult, ESTIMATE, "seconds", render.seconds),
    RT_MEMBER(RtBuildResult, ESTIMATE, "share", render.share)};

static const RtMember machine_members[] = {RT_MEMBER(RtMachine, TEXT, "host", host),
                                           RT_MEMBER(RtMachine, TEXT, "cpu", cpu)};
static const RtRecord of_machine = RT_RECORD(machine_members);

/* The lists of the times of each round. */
static const char *const round_time_names[RT_ROUND_TIME_COUNT] = {"each_seconds", "each_wall",
                                                                  "each_baseline"};

/* ---- parts ---- */

/* What an event adds to the line of its scene, accelerator and kind of rays. */
typedef enum Place { OF_WORKLOAD, OF_BUILD, OF_CELL } Place;
static const struct Part {
    const char *key;
    Place place;
    RtRecord record; /* of the workload's, the build's or the cell's result */
} parts[] = {[RT_EVENT_WORKLOAD] = {"workload", OF_WORKLOAD, RT_RECORD(workload_members)},
             [RT_EVENT_BUILD] = {"built", OF_BUILD, RT_RECORD(build_members)},
             [RT_EVENT_COUNT] = {"counted", OF_CELL, RT_RECORD(count_members)},
             [RT_EVENT_DISTRIBUTION] = {"distributed", OF_CELL, {NULL, 0}},
             [RT_EVENT_TIME] = {"timed", OF_CELL, RT_RECORD(time_members)},
             [RT_EVENT_RENDER] = {"rendered", OF_BUILD, RT_RECORD(render_members)},
             [RT_EVENT_NO_BUILD] = {"too_large", OF_BUILD, {NULL, 0}},
             [RT_EVENT_NO_CELL] = {"too_long", OF_CELL, {NULL, 0}}};

/* ---- writing ---- */

static json_t *rounds_json(const RtCell *cell, RtRoundTime which) {
    json_t *list = json_array();
    for (uint32_t r = 0; r < cell->rounds; r++)
        json_array_append_new(list, rt_json_number(rt_cell_round_times(cell, which)[r]));
    return list;
}

static json_t *add_machine(json_t *json, const RtResults *results, uint32_t machine) {
    json = rt_json_add(json, "host", json_string(results->machines[machine].host));
    return rt_json_add(json, "cpu", json_string(results->machines[machine].cpu));
}

static json_t *build_json(const RtBuildResult *build) {
    json_t *json = rt_record_json(&parts[RT_EVENT_BUILD].record, build);
    if (!build->leaves) return json;
    return rt_json_add(json, "distributions",
                       rt_distributions_json(build->leaves, RT_RAY_QUANTITY_COUNT, RT_LEAF_QUANTITY_COUNT));
}

static json_t *time_json(const RtResults *results, const RtCell *cell) {
    json_t *json = rt_record_json(&parts[RT_EVENT_TIME].record, cell);
    json =
        rt_json_add(json, "baseline", json_string(rt_candidate_label(results->experiment, cell->baseline)));
    json = add_machine(json, results, cell->machine);
    for (int i = 0; i < RT_ROUND_TIME_COUNT && cell->round_times; i++)
        json = rt_json_add(json, round_time_names[i], rounds_json(cell, (RtRoundTime)i));
    return json;
}

static json_t *part_json(const RtResults *results, const RtEvent *event) {
    const RtCell *cell = rt_cell_at(results, event->workload, event->candidate, event->kind);
    const RtBuildResult *build = rt_build_at(results, event->workload, event->candidate);
    const RtRecord *record = &parts[event->what].record;
    switch (event->what) {
    case RT_EVENT_WORKLOAD: return rt_record_json(record, &results->workloads[event->workload]);
    case RT_EVENT_BUILD: return build_json(build);
    case RT_EVENT_COUNT: return rt_record_json(record, cell);
    case RT_EVENT_DISTRIBUTION: return rt_distributions_json(cell->distributions, 0, RT_RAY_QUANTITY_COUNT);
    case RT_EVENT_TIME: return time_json(results, cell);
    case RT_EVENT_RENDER: return add_machine(rt_record_json(record, build), results, build->render.machine);
    case RT_EVENT_NO_BUILD: return json_string(build->left_out);
    case RT_EVENT_NO_CELL: return json_string(cell->left_out);
    }
    return NULL;
}

json_t *rt_journal_line(const RtResults *results, const RtEvent *event) {
    const RtExperiment *experiment = results->experiment;
    const Place place = parts[event->what].place;
    const char *accel = rt_candidate_label(experiment, event->candidate);
    json_t *line = json_pack("{s:s}", "scene", experiment->workloads[event->workload].label);
    if (place >= OF_BUILD) line = rt_json_add(line, "accel", json_string(accel));
    if (place == OF_CELL) line = rt_json_add(line, "kind", json_string(rt_ray_kind_name(event->kind)));
    line = rt_json_add(line, parts[event->what].key, part_json(results, event));
    const bool left_out = event->what == RT_EVENT_NO_BUILD || event->what == RT_EVENT_NO_CELL;
    if (left_out) line = rt_json_add(line, "broken", json_boolean(rt_event_is_broken(results, event)));
    if (event->what != RT_EVENT_NO_BUILD) return line;
    const RtBuildResult *build = rt_build_at(results, event->workload, event->candidate);
    return rt_json_add(line, "refused", json_boolean(build->refused));
}

/* ---- reading ---- */

/* Makes room for `count` distributions, from number `first` on, and fills it; if they are missing, *out stays
 * as it is, and they are measured again. */
static void take_distributions(RtRecordReader *reader, RtDistribution **out, size_t first, size_t count,
                               const json_t *json) {
    if (!json || *out) return;
    *out = rt_alloc(count, sizeof(RtDistribution));
    if (!*out)
        reader->status = rt_fail_memory(reader->error, "distributions", count * sizeof(RtDistribution));
    if (!*out || rt_distributions_take(*out, first, count, json)) return;
    rt_free(*out);
    *out = NULL;
}

/* Journals of older versions have no times of rounds. */
static void take_rounds(RtRecordReader *reader, RtCell *cell, const json_t *json) {
    bool any = false;
    rt_free(cell->round_times); /* of an earlier line, which may have had another number of rounds */
    cell->round_times = NULL;
    for (int i = 0; i < RT_ROUND_TIME_COUNT; i++) any |= json_object_get(json, round_time_names[i]) != NULL;
    for (int i = 0; i < RT_ROUND_TIME_COUNT && any; i++) {
        if (json_array_size(json_object_get(json, round_time_names[i])) != cell->rounds)
            rt_record_reject(reader, round_time_names[i], "a list of as many times as there were rounds");
    }
    if (!any || reader->status != RT_OK) return;
    reader->status = rt_cell_make_round_times(cell, reader->error);
    for (int i = 0; i < RT_ROUND_TIME_COUNT && cell->round_times; i++) {
        const json_t *list = json_object_get(json, round_time_names[i]);
        const bool unknown = i == RT_ROUND_BASELINE && isnan(cell->ratio.median); /* no baseline */
        for (uint32_t r = 0; r < cell->rounds; r++)
            rt_cell_round_times(cell, (RtRoundTime)i)[r] =
                unknown ? (double)NAN
                        : rt_record_seconds(reader, json_array_get(list, r), round_time_names[i]);
    }
}

static uint32_t take_machine(RtRecordReader *reader, RtResults *results, const json_t *json) {
    RtMachine machine;
    rt_record_take(reader, &of_machine, &machine, json);
    return rt_results_machine(results, &machine);
}

static void take_baseline(RtRecordReader *reader, const RtExperiment *experiment, uint32_t workload,
                          RtCell *cell, const json_t *json) {
    const char *baseline = rt_record_text(reader, json, "baseline");
    uint32_t c = baseline ? rt_candidate_find(experiment, baseline, workload) : experiment->baseline;
    if (c >= experiment->candidate_count || !rt_candidate_is_baseline(experiment, c))
        rt_record_reject(reader, "baseline", "a baseline of the experiment");
    cell->baseline = c < experiment->candidate_count ? c : experiment->baseline;
}

/* A flag that journals of older versions lack. */
static bool take_added_flag(RtRecordReader *reader, const json_t *line, const char *key) {
    const json_t *flag = json_object_get(line, key);
    if (flag && !json_is_boolean(flag)) rt_record_reject(reader, key, "true or false");
    return json_is_true(flag);
}

/* Whether the line has a part for this place. */
static bool has_part(const json_t *line, Place place) {
    for (size_t i = 0; i < sizeof parts / sizeof parts[0]; i++) {
        if (parts[i].place == place && json_object_get(line, parts[i].key)) return true;
    }
    return false;
}

/* The part of an event, if the line has it. */
static const json_t *take_part(RtRecordReader *reader, const json_t *line, RtEventKind what, void *to) {
    const json_t *json = json_object_get(line, parts[what].key);
    if (json) rt_record_take(reader, &parts[what].record, to, json);
    return json;
}

static void take_build(RtRecordReader *reader, const json_t *line, RtResults *results, uint32_t workload,
                       uint32_t candidate) {
    RtBuildResult *build = rt_build_at(results, workload, candidate);
    const json_t *built = take_part(reader, line, RT_EVENT_BUILD, build);
    build->known |= built != NULL;
    take_distributions(reader, &build->leaves, RT_RAY_QUANTITY_COUNT, RT_LEAF_QUANTITY_COUNT,
                       json_object_get(built, "distributions"));
    const json_t *rendered = take_part(reader, line, RT_EVENT_RENDER, build);
    build->render.known |= rendered != NULL;
    if (rendered) build->render.machine = take_machine(reader, results, rendered);
    const char *why = rt_record_text(reader, line, parts[RT_EVENT_NO_BUILD].key);
    if (why)
        rt_results_leave_out(results, workload, candidate, why, take_added_flag(reader, line, "refused"),
                             take_added_flag(reader, line, "broken"));
}

static void take_cell(RtRecordReader *reader, const json_t *line, RtResults *results, uint32_t workload,
                      RtCell *cell) {
    cell->counted |= take_part(reader, line, RT_EVENT_COUNT, cell) != NULL;
    take_distributions(reader, &cell->distributions, 0, RT_RAY_QUANTITY_COUNT,
                       json_object_get(line, "distributed"));
    const char *why = rt_record_text(reader, line, parts[RT_EVENT_NO_CELL].key);
    if (why) {
        snprintf(cell->left_out, sizeof cell->left_out, "%s", why);
        cell->broken = take_added_flag(reader, line, "broken");
    }
    const json_t *timed = take_part(reader, line, RT_EVENT_TIME, cell);
    cell->timed |= timed != NULL;
    if (!timed) return;
    take_baseline(reader, results->experiment, workload, cell, timed);
    cell->machine = take_machine(reader, results, timed);
    take_rounds(reader, cell, timed);
}

void rt_journal_line_take(RtRecordReader *reader, RtResults *results, const json_t *line) {
    const RtExperiment *experiment = results->experiment;
    const char *scene = rt_record_text(reader, line, "scene"), *accel = rt_record_text(reader, line, "accel");
    const char *kind_name = rt_record_text(reader, line, "kind");
    const bool of_cell = has_part(line, OF_CELL), of_build_too = of_cell || has_part(line, OF_BUILD);
    RtRayKind kind = RT_RAY_PRIMARY;
    if (!json_is_object(line)) rt_record_reject(reader, "this line", "a JSON object");
    if (!scene) rt_record_reject(reader, "scene", "there");
    if (!accel && of_build_too) rt_record_reject(reader, "accel", "there");
    if (of_cell && (!kind_name || rt_ray_kind_parse(kind_name, &kind, NULL) != RT_OK))
        rt_record_reject(reader, "kind", "a kind of rays");
    if (reader->status != RT_OK) return;
    const uint32_t workload = rt_workload_find(experiment, scene);
    if (workload == experiment->workload_count) return;
    RtWorkloadResult *scene_result = &results->workloads[workload];
    scene_result->known |= take_part(reader, line, RT_EVENT_WORKLOAD, scene_result) != NULL;
    if (!accel) return;
    const uint32_t candidate = rt_candidate_find(experiment, accel, workload);
    if (candidate > experiment->candidate_count) return;
    take_build(reader, line, results, workload, candidate);
    if (of_cell) take_cell(reader, line, results, workload, rt_cell_at(results, workload, candidate, kind));
}

bool rt_journal_line_concerns(const json_t *line, const RtExperiment *experiment, const json_t *plugins) {
    const char *scene = json_string_value(json_object_get(line, "scene"));
    const char *accel = json_string_value(json_object_get(line, "accel"));
    const uint32_t workload = scene ? rt_workload_find(experiment, scene) : experiment->workload_count;
    if (!accel || workload == experiment->workload_count) return false;
    const uint32_t candidate = rt_candidate_find(experiment, accel, workload);
    return candidate <= experiment->candidate_count && rt_plugins_concern(plugins, experiment, candidate);
}
