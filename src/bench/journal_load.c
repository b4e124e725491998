/* SPDX-License-Identifier: Apache-2.0 */
/* Reading a journal back. */
#include "base/memory.h"
#include "bench/journal.h"
#include "bench/journal_state.h"
#include "bench/machine.h"
#include "bench/plugins_used.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

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
        size_t count = json_array_size(json_object_get(object, rt_journal_each_names[i]));
        if (count != cell->rounds || count == 0 || count > RT_MAX_ROUNDS) return RT_OK;
    }
    RT_TRY(rt_cell_make_rounds(cell, error));
    for (int i = 0; i < RT_EACH_COUNT; i++) {
        const json_t *list = json_object_get(object, rt_journal_each_names[i]);
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

/* ---- what the journal is of ---- */

static RtStatus check_experiment(const char *path, const json_t *header, const RtExperiment *experiment,
                                 RtError *error) {
    const char *name = json_string_value(json_object_get(header, "experiment"));
    bool quick = json_is_true(json_object_get(header, "quick"));
    if (get_hex(header, "hash") != experiment->fingerprint) {
        return rt_fail(
            error, RT_BAD_INPUT,
            "%s: this is a run of another experiment, or of another version of it ('%s'): start over "
            "and lose it with --force, or give another --out",
            path, name ? name : "");
    }
    if (quick == experiment->quick) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: this is a run %s --quick: start over and lose it with --force, or give another --out",
                   path, quick ? "with" : "without");
}

static RtStatus check_build(const char *path, const json_t *header, const RtOnly *only, RtError *error) {
    const char *build = json_string_value(json_object_get(header, "build"));
    uint64_t shard = get_integer(header, "shard"), shards = get_integer(header, "shards");
    if (shard != only->shard || shards != only->shards) {
        return rt_fail(
            error, RT_BAD_INPUT,
            "%s: this is a run with another --shard (%d/%d): start over and lose it with --force, or "
            "give another --out",
            path, (int)shard, (int)shards);
    }
    if (build && strcmp(build, rt_build_alone()) == 0) return RT_OK;
    return rt_fail(
        error, RT_BAD_INPUT,
        "%s: this run was begun by another build (%s; this is %s): start over and lose it with --force, or "
        "give another --out",
        path, build ? build : "unknown", rt_build_alone());
}

/* Where ratios refer to an accelerator of the plugin, nothing of the run would stay. */
static RtStatus check_plugins(const char *path, const RtExperiment *experiment, const json_t *changed,
                              bool renew, RtError *error) {
    char sentence[RT_MAX_PLUGIN_CHANGE];
    bool baseline = false;
    if (json_object_size(changed) == 0) return RT_OK;
    for (uint32_t i = 0; i < experiment->baseline_count; i++)
        baseline |= rt_plugins_concern(changed, experiment, experiment->baseline + i);
    if (renew && !baseline) return RT_OK;
    const char *name = json_object_iter_key(json_object_iter((json_t *)changed));
    rt_plugins_change_format(name, json_object_get(changed, name), "when this run was begun", "now",
                             sentence);
    if (baseline)
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: %s, and so is the baseline: start over and lose this run with --force, or give "
                       "another --out",
                       path, sentence);
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: %s: measure its cells again and keep all others with --renew, start over and lose "
                   "all with --force, or give another --out",
                   path, sentence);
}

static RtStatus take_lines(const char *path, RtResults *results, const json_t *lines, const RtOnly *only,
                           bool renew, RtError *error) {
    const RtExperiment *experiment = results->experiment;
    const json_t *header = json_array_get(lines, 0);
    if (json_is_true(json_object_get(header, "given_up"))) return RT_OK; /* rt_earlier_remove */
    RT_TRY(check_experiment(path, header, experiment, error));
    if (only) RT_TRY(check_build(path, header, only, error));
    json_t *used = only ? rt_plugins_used(experiment) : NULL;
    json_t *changed = only ? rt_plugins_changed(json_object_get(header, "plugins"), used) : NULL;
    RtStatus status = only ? check_plugins(path, experiment, changed, renew, error) : RT_OK;
    for (size_t i = 1; status == RT_OK && i < json_array_size(lines); i++) {
        const json_t *line = json_array_get(lines, i);
        if (!changed || !rt_journal_line_concerns(line, experiment, changed))
            status = take_line(results, line, error);
    }
    json_decref(changed);
    json_decref(used);
    return status;
}

RtStatus rt_journal_load(const char *path, RtResults *results, const RtOnly *only, bool renew,
                         RtError *error) {
    json_t *lines;
    RT_TRY(rt_json_lines_load(path, &lines, error));
    RtStatus status = take_lines(path, results, lines, only, renew, error);
    json_decref(lines);
    return status;
}
