/* SPDX-License-Identifier: Apache-2.0 */
#include "bench/journal.h"

#include "accel/structure_json.h"
#include "base/json.h"
#include "base/memory.h"
#include "bench/machine.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

static const char *const each_names[RT_EACH_COUNT] = {"each_seconds", "each_wall", "each_baseline"};

/* ---- to JSON ---- */

static json_t *header_json(const RtExperiment *experiment, const RtOnly *only) {
    return json_pack("{s:s, s:o, s:b, s:s, s:i, s:i}", "experiment", experiment->name, "hash",
                     rt_json_hex(experiment->fingerprint), "quick", experiment->quick, "build",
                     rt_build_identity(), "shard", (int)only->shard, "shards", (int)only->shards);
}

static json_t *workload_json(const RtWorkloadResult *workload) {
    json_t *sets = json_object();
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        json_object_set_new(sets, rt_ray_kind_name((RtRayKind)k),
                            json_pack("{s:I, s:o}", "rays", (json_int_t)workload->rays[k], "hash",
                                      rt_json_hex(workload->ray_fingerprints[k])));
    }
    return json_pack("{s:I, s:I, s:I, s:o, s:o}", "objects", (json_int_t)workload->objects, "width",
                     (json_int_t)workload->width, "height", (json_int_t)workload->height, "hash",
                     rt_json_hex(workload->scene), "sets", sets);
}

static json_t *build_json(const RtBuildResult *build) {
    json_t *object = rt_json_structure(&build->shape);
    json_t *run =
        json_pack("{s:s, s:b, s:b, s:f, s:I}", "spec", build->spec, "exact", build->exact, "counts",
                  build->counts, "seconds", build->seconds, "bytes", (json_int_t)build->shape.bytes);
    if (json_object_update_new(object, run) != 0) {
        json_decref(object);
        return NULL;
    }
    if (build->leaves)
        json_object_set_new(
            object, "distributions",
            rt_distributions_json(build->leaves, RT_RAY_QUANTITY_COUNT, RT_LEAF_QUANTITY_COUNT));
    return object;
}

static json_t *count_json(const RtCell *cell) {
    json_t *object = rt_json_tally(&cell->tally);
    if (json_object_set_new(object, "differ", json_integer((json_int_t)cell->differ)) == 0) return object;
    json_decref(object);
    return NULL;
}

static json_t *estimate_json(const RtEstimate *e) {
    return json_pack("[f, f, f, f]", e->median, e->low, e->high, e->least);
}

static json_t *rounds_json(const RtCell *cell, RtEach each) {
    json_t *list = json_array();
    for (uint32_t r = 0; r < cell->rounds; r++) {
        json_array_append_new(list, json_real(rt_cell_rounds(cell, each)[r]));
    }
    return list;
}

static json_t *time_json(const RtResults *results, const RtCell *cell) {
    const RtMachine *machine = &results->machines[cell->machine];
    json_t *object = json_pack(
        "{s:I, s:I, s:i, s:o, s:o, s:o, s:s, s:s, s:s}", "rays", (json_int_t)cell->tally.rays, "rounds",
        (json_int_t)cell->rounds, "threads", cell->threads, "seconds", estimate_json(&cell->seconds), "wall",
        estimate_json(&cell->wall), "ratio", estimate_json(&cell->ratio), "baseline",
        rt_candidate_label(results->experiment, cell->baseline), "host", machine->host, "cpu", machine->cpu);
    for (int i = 0; i < RT_EACH_COUNT && cell->each; i++) {
        json_object_set_new(object, each_names[i], rounds_json(cell, (RtEach)i));
    }
    return object;
}

/* What is not known is null. */
static json_t *hardware_json(const RtResults *results, const RtCell *cell) {
    const RtCellHardware *hardware = &cell->hardware;
    const RtMachine *machine = &results->machines[hardware->machine];
    json_t *object =
        json_pack("{s:i, s:f, s:s, s:s, s:s}", "threads", hardware->threads, "running",
                  hardware->counts.running, "why", hardware->why, "host", machine->host, "cpu", machine->cpu);
    for (size_t i = 0; i < RT_HARDWARE_COUNT; i++) {
        double count = *hardware->why ? (double)NAN : hardware->counts.of[i];
        json_object_set_new(object, rt_hardware_name(i), isnan(count) ? json_null() : json_real(count));
    }
    return object;
}

static json_t *event_json(const RtResults *results, const RtEvent *event) {
    const RtExperiment *experiment = results->experiment;
    const RtCell *cell = rt_cell_at(results, event->workload, event->candidate, event->kind);
    const RtBuildResult *build = rt_build_at(results, event->workload, event->candidate);
    const char *scene = experiment->workloads[event->workload].label;
    const char *accel = rt_candidate_label(experiment, event->candidate);
    const char *kind = rt_ray_kind_name(event->kind);
    switch (event->what) {
    case RT_EVENT_WORKLOAD:
        return json_pack("{s:s, s:o}", "scene", scene, "workload",
                         workload_json(&results->workloads[event->workload]));
    case RT_EVENT_BUILD:
        return json_pack("{s:s, s:s, s:o}", "scene", scene, "accel", accel, "built", build_json(build));
    case RT_EVENT_COUNT:
        return json_pack("{s:s, s:s, s:s, s:o}", "scene", scene, "accel", accel, "kind", kind, "counted",
                         count_json(cell));
    case RT_EVENT_DISTRIBUTION:
        return json_pack("{s:s, s:s, s:s, s:o}", "scene", scene, "accel", accel, "kind", kind, "distributed",
                         rt_distributions_json(cell->distributions, 0, RT_RAY_QUANTITY_COUNT));
    case RT_EVENT_TIME:
        return json_pack("{s:s, s:s, s:s, s:o}", "scene", scene, "accel", accel, "kind", kind, "timed",
                         time_json(results, cell));
    case RT_EVENT_HARDWARE:
        return json_pack("{s:s, s:s, s:s, s:o}", "scene", scene, "accel", accel, "kind", kind, "hardware",
                         hardware_json(results, cell));
    case RT_EVENT_TOO_LARGE:
    case RT_EVENT_BROKEN_BUILD:
        return json_pack("{s:s, s:s, s:s, s:b}", "scene", scene, "accel", accel, "too_large", build->limit,
                         "broken", build->broken);
    case RT_EVENT_TOO_LONG:
    case RT_EVENT_BROKEN:
        return json_pack("{s:s, s:s, s:s, s:s, s:b}", "scene", scene, "accel", accel, "kind", kind,
                         "too_long", cell->limit, "broken", cell->broken);
    }
    return NULL;
}

/* ---- writing ---- */

RtStatus rt_journal_open(RtJsonLines *journal, const char *path, const RtExperiment *experiment,
                         const RtOnly *only, bool resume, RtError *error) {
    json_t *header = resume ? NULL : header_json(experiment, only);
    if (!resume && !header) return rt_fail_memory(error, path, 0);
    RtStatus status = rt_json_lines_open(journal, path, header, error);
    json_decref(header);
    return status;
}

RtStatus rt_journal_append(RtJsonLines *journal, const RtResults *results, const RtEvent *event,
                           RtError *error) {
    return rt_json_lines_write(journal, event_json(results, event), error);
}

/* ---- from JSON ---- */

/* Members that are missing or of another type read as 0, which no journal of ours has. */
static uint64_t get_integer(const json_t *object, const char *key) {
    return (uint64_t)json_integer_value(json_object_get(object, key));
}

static uint64_t get_hex(const json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    uint64_t value = 0;
    return text && sscanf(text, "%" SCNx64, &value) == 1 ? value : 0;
}

static double get_number(const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

static RtEstimate get_estimate(const json_t *object, const char *key) {
    const json_t *list = json_object_get(object, key);
    return (RtEstimate){
        json_number_value(json_array_get(list, 0)), json_number_value(json_array_get(list, 1)),
        json_number_value(json_array_get(list, 2)), json_number_value(json_array_get(list, 3))};
}

static void take_workload(RtWorkloadResult *workload, const json_t *object) {
    const json_t *sets = json_object_get(object, "sets");
    workload->known = true;
    workload->objects = (uint32_t)get_integer(object, "objects");
    workload->width = (uint32_t)get_integer(object, "width");
    workload->height = (uint32_t)get_integer(object, "height");
    workload->scene = get_hex(object, "hash");
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const json_t *set = json_object_get(sets, rt_ray_kind_name((RtRayKind)k));
        workload->rays[k] = get_integer(set, "rays");
        workload->ray_fingerprints[k] = get_hex(set, "hash");
    }
}

static void take_tally(RtTally *tally, const json_t *object) {
#define TAKE(name, meaning) tally->name = get_integer(object, #name);
    RT_TALLY_COUNTERS(TAKE)
#undef TAKE
}

/* Makes room for `count` distributions, from number `first` on, and fills it; without them *out stays as it
 * is, and they are found once more. */
static RtStatus take_distributions(RtDistribution **out, size_t first, size_t count, const json_t *object,
                                   RtError *error) {
    if (!object || *out) return RT_OK;
    *out = rt_alloc(count, sizeof(RtDistribution));
    if (!*out) return rt_fail_memory(error, "distributions", count * sizeof(RtDistribution));
    if (rt_distributions_take(*out, first, count, object)) return RT_OK;
    rt_free(*out);
    *out = NULL;
    return RT_OK;
}

static RtStatus take_build(RtBuildResult *build, const json_t *object, RtError *error) {
    const char *spec = json_string_value(json_object_get(object, "spec"));
    build->known = true;
    build->exact = json_is_true(json_object_get(object, "exact"));
    build->counts = json_is_true(json_object_get(object, "counts"));
    snprintf(build->spec, sizeof build->spec, "%s", spec ? spec : "");
    build->seconds = get_number(object, "seconds");
    build->shape = (RtDescription){.interior = get_integer(object, "interior"),
                                   .leaves = get_integer(object, "leaves"),
                                   .empty_leaves = get_integer(object, "empty_leaves"),
                                   .references = get_integer(object, "references"),
                                   .depth = get_integer(object, "depth"),
                                   .bytes = get_integer(object, "bytes")};
#define TAKE_PREDICTION(name, meaning) build->shape.name = get_number(object, #name);
    RT_PREDICTIONS(TAKE_PREDICTION)
    RT_QUALITIES(TAKE_PREDICTION)
#undef TAKE_PREDICTION
    take_tally(&build->shape.build, json_object_get(object, "build"));
    return take_distributions(&build->leaves, RT_RAY_QUANTITY_COUNT, RT_LEAF_QUANTITY_COUNT,
                              json_object_get(object, "distributions"), error);
}

static void take_count(RtCell *cell, const json_t *object) {
    cell->counted = true;
    cell->differ = get_integer(object, "differ");
    take_tally(&cell->tally, object);
}

/* Journals of earlier versions have no times of rounds. */
static RtStatus take_rounds(RtCell *cell, const json_t *object, RtError *error) {
    for (int i = 0; i < RT_EACH_COUNT; i++) {
        size_t count = json_array_size(json_object_get(object, each_names[i]));
        if (count != cell->rounds || count == 0 || count > RT_MAX_ROUNDS) return RT_OK;
    }
    RT_TRY(rt_cell_make_rounds(cell, error));
    for (int i = 0; i < RT_EACH_COUNT; i++) {
        const json_t *list = json_object_get(object, each_names[i]);
        for (uint32_t r = 0; r < cell->rounds; r++) {
            rt_cell_rounds(cell, (RtEach)i)[r] = json_number_value(json_array_get(list, r));
        }
    }
    return RT_OK;
}

static void take_text(char *out, size_t room, const json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    snprintf(out, room, "%s", text ? text : "");
}

static uint32_t take_machine(RtResults *results, const json_t *object) {
    RtMachine machine;
    take_text(machine.host, sizeof machine.host, object, "host");
    take_text(machine.cpu, sizeof machine.cpu, object, "cpu");
    return rt_results_machine(results, &machine);
}

static void take_hardware(RtResults *results, RtCell *cell, const json_t *object) {
    RtCellHardware *hardware = &cell->hardware;
    hardware->known = true;
    hardware->threads = (int)get_integer(object, "threads");
    hardware->machine = take_machine(results, object);
    hardware->counts.running = get_number(object, "running");
    take_text(hardware->why, sizeof hardware->why, object, "why");
    for (size_t i = 0; i < RT_HARDWARE_COUNT; i++)
        hardware->counts.of[i] = get_number(object, rt_hardware_name(i));
}

static RtStatus take_time(RtResults *results, uint32_t workload, RtCell *cell, const json_t *object,
                          RtError *error) {
    const RtExperiment *experiment = results->experiment;
    cell->machine = take_machine(results, object);
    const char *baseline = json_string_value(json_object_get(object, "baseline"));
    uint32_t c = rt_candidate_find(experiment, baseline ? baseline : "", workload);
    cell->baseline = c < experiment->candidate_count ? c : experiment->baseline;
    cell->timed = true;
    cell->tally.rays = get_integer(object, "rays");
    cell->rounds = (uint32_t)get_integer(object, "rounds");
    cell->threads = (int)get_integer(object, "threads");
    cell->seconds = get_estimate(object, "seconds");
    cell->wall = get_estimate(object, "wall");
    cell->ratio = get_estimate(object, "ratio");
    return take_rounds(cell, object, error);
}

static void take_limit(const char *text, bool is_broken, char *limit, bool *broken) {
    snprintf(limit, RT_MAX_LIMIT, "%s", text);
    *broken = is_broken;
}

/* Places a line where its labels say; lines about what the experiment does not have are passed over. */
static RtStatus take_line(RtResults *results, const json_t *line, RtError *error) {
    const RtExperiment *experiment = results->experiment;
    const char *scene = json_string_value(json_object_get(line, "scene"));
    const char *accel = json_string_value(json_object_get(line, "accel"));
    const char *kind_name = json_string_value(json_object_get(line, "kind"));
    const json_t *object;
    RtRayKind kind = RT_RAY_PRIMARY;
    uint32_t workload = scene ? rt_workload_find(experiment, scene) : experiment->workload_count;
    if (workload == experiment->workload_count) return RT_OK;
    if ((object = json_object_get(line, "workload"))) take_workload(&results->workloads[workload], object);
    if (!accel) return RT_OK;
    uint32_t candidate = rt_candidate_find(experiment, accel, workload);
    if (candidate > experiment->candidate_count) return RT_OK;
    if ((object = json_object_get(line, "built")))
        RT_TRY(take_build(rt_build_at(results, workload, candidate), object, error));
    bool broken = json_is_true(json_object_get(line, "broken"));
    const char *limit = json_string_value(json_object_get(line, "too_large"));
    RtBuildResult *build = rt_build_at(results, workload, candidate);
    if (limit) take_limit(limit, broken, build->limit, &build->broken);
    if (!kind_name || rt_ray_kind_parse(kind_name, &kind, NULL) != RT_OK) return RT_OK;
    RtCell *cell = rt_cell_at(results, workload, candidate, kind);
    if ((object = json_object_get(line, "counted"))) take_count(cell, object);
    RT_TRY(take_distributions(&cell->distributions, 0, RT_RAY_QUANTITY_COUNT,
                              json_object_get(line, "distributed"), error));
    limit = json_string_value(json_object_get(line, "too_long"));
    if (limit) take_limit(limit, broken, cell->limit, &cell->broken);
    if ((object = json_object_get(line, "hardware"))) take_hardware(results, cell, object);
    object = json_object_get(line, "timed");
    return object ? take_time(results, workload, cell, object, error) : RT_OK;
}

static RtStatus check_header(const char *path, const json_t *line, const RtExperiment *experiment,
                             const RtOnly *only, RtError *error) {
    const char *build = json_string_value(json_object_get(line, "build"));
    const char *name = json_string_value(json_object_get(line, "experiment"));
    bool quick = json_is_true(json_object_get(line, "quick"));
    if (get_hex(line, "hash") != experiment->fingerprint) {
        return rt_fail(
            error, RT_BAD_INPUT,
            "%s: this is a run of another experiment, or of another version of it ('%s'): start over "
            "and lose it with --force, or give another --out",
            path, name ? name : "");
    }
    if (quick != experiment->quick) {
        return rt_fail(
            error, RT_BAD_INPUT,
            "%s: this is a run %s --quick: start over and lose it with --force, or give another --out", path,
            quick ? "with" : "without");
    }
    uint64_t shard = get_integer(line, "shard"), shards = get_integer(line, "shards");
    if (only && (shard != only->shard || shards != only->shards)) {
        return rt_fail(
            error, RT_BAD_INPUT,
            "%s: this is a run with another --shard (%d/%d): start over and lose it with --force, or "
            "give another --out",
            path, (int)shard, (int)shards);
    }
    if (!only || (build && strcmp(build, rt_build_identity()) == 0)) return RT_OK;
    return rt_fail(
        error, RT_BAD_INPUT,
        "%s: this run was begun by another build (%s; this is %s): start over and lose it with --force, or "
        "give another --out",
        path, build ? build : "unknown", rt_build_identity());
}

RtStatus rt_journal_load(const char *path, RtResults *results, const RtOnly *only, RtError *error) {
    json_t *lines;
    RT_TRY(rt_json_lines_load(path, &lines, error));
    RtStatus status = check_header(path, json_array_get(lines, 0), results->experiment, only, error);
    for (size_t i = 1; status == RT_OK && i < json_array_size(lines); i++) {
        status = take_line(results, json_array_get(lines, i), error);
    }
    json_decref(lines);
    return status;
}
