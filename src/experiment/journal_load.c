/* SPDX-License-Identifier: Apache-2.0 */
/* Reading a journal back. */
#include "core/base/memory.h"
#include "experiment/journal.h"
#include "experiment/journal_state.h"
#include "experiment/plugins_used.h"
#include "measure/machine.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <string.h>

/* ---- from JSON ---- */

/* The line that is read. The first thing that is wrong with it is kept: what is read from then on is of no
 * use to anybody, and is within its range. */
typedef struct Reader {
    const char *path;
    size_t line; /* from 1 */
    RtStatus status;
    RtError *error;
} Reader;

static void reject(Reader *reader, const char *key, const char *wanted) {
    if (reader->status != RT_OK) return;
    reader->status =
        rt_fail_at(reader->error, reader->path, reader->line, 0,
                   "'%s' is not %s: the journal is damaged, or of another version of raytally. Remove "
                   "this line, and --resume measures anew what it said",
                   key, wanted);
}

static uint64_t get_integer(Reader *reader, const json_t *object, const char *key, uint64_t least,
                            uint64_t most) {
    const json_t *value = json_object_get(object, key);
    const json_int_t number = json_integer_value(value);
    if (json_is_integer(value) && number >= 0 && (uint64_t)number >= least && (uint64_t)number <= most)
        return (uint64_t)number;
    char wanted[96];
    snprintf(wanted, sizeof wanted, "a whole number from %" PRIu64 " to %" PRIu64, least, most);
    reject(reader, key, wanted);
    return least;
}

/* Counts of anything, which JSON has as signed numbers. */
static uint64_t get_count(Reader *reader, const json_t *object, const char *key) {
    return get_integer(reader, object, key, 0, INT64_MAX);
}

static uint64_t parse_hex(const json_t *value, bool *good) {
    const char *text = json_string_value(value);
    uint64_t number = 0;
    *good = text && strlen(text) == 16 && strspn(text, "0123456789abcdef") == 16 &&
            sscanf(text, "%16" SCNx64, &number) == 1;
    return *good ? number : 0;
}

static uint64_t get_hex(Reader *reader, const json_t *object, const char *key) {
    bool good;
    uint64_t number = parse_hex(json_object_get(object, key), &good);
    if (!good) reject(reader, key, "a hash of 16 hexadecimal digits");
    return number;
}

/* NAN where it is null or missing: it was not known, or is of a later version. */
static double get_number(Reader *reader, const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    if (value && !json_is_null(value) && !json_is_number(value)) reject(reader, key, "a number");
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

/* Times and ratios. */
static double take_positive(Reader *reader, const json_t *value, const char *key) {
    const double number = json_number_value(value);
    if (json_is_number(value) && number >= 0) return number;
    reject(reader, key, "made of numbers from 0 on");
    return 0;
}

static RtEstimate get_estimate(Reader *reader, const json_t *object, const char *key) {
    const json_t *list = json_object_get(object, key);
    double of[4];
    for (size_t i = 0; i < 4; i++) of[i] = take_positive(reader, json_array_get(list, i), key);
    return (RtEstimate){of[0], of[1], of[2], of[3]};
}

static bool get_flag(Reader *reader, const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    if (!json_is_boolean(value)) reject(reader, key, "true or false");
    return json_is_true(value);
}

/* NULL where it is missing. */
static const char *find_text(Reader *reader, const json_t *object, const char *key) {
    const json_t *value = json_object_get(object, key);
    if (value && !json_is_string(value)) reject(reader, key, "a text");
    return json_string_value(value);
}

static void take_text(Reader *reader, char *out, size_t room, const json_t *object, const char *key) {
    const char *text = find_text(reader, object, key);
    snprintf(out, room, "%s", text ? text : "");
}

static void take_workload(Reader *reader, RtWorkloadResult *workload, const json_t *object) {
    const json_t *sets = json_object_get(object, "sets");
    workload->known = true;
    workload->objects = (uint32_t)get_integer(reader, object, "objects", 0, UINT32_MAX);
    workload->width = (uint32_t)get_integer(reader, object, "width", 0, UINT32_MAX);
    workload->height = (uint32_t)get_integer(reader, object, "height", 0, UINT32_MAX);
    workload->scene = get_hex(reader, object, "hash");
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        const json_t *set = json_object_get(sets, rt_ray_kind_name((RtRayKind)k));
        workload->rays[k] = get_count(reader, set, "rays");
        workload->ray_fingerprints[k] = get_hex(reader, set, "hash");
    }
}

static void take_tally(Reader *reader, RtTally *tally, const json_t *object) {
#define TAKE(name, meaning) tally->name = get_count(reader, object, #name);
    RT_TALLY_COUNTERS(TAKE)
#undef TAKE
}

/* Makes room for `count` distributions, from number `first` on, and fills it; without them *out stays as it
 * is, and they are found once more. */
static void take_distributions(Reader *reader, RtDistribution **out, size_t first, size_t count,
                               const json_t *object) {
    if (!object || *out) return;
    *out = rt_alloc(count, sizeof(RtDistribution));
    if (!*out)
        reader->status = rt_fail_memory(reader->error, "distributions", count * sizeof(RtDistribution));
    if (!*out || rt_distributions_take(*out, first, count, object)) return;
    rt_free(*out);
    *out = NULL;
}

static void take_build(Reader *reader, RtBuildResult *build, const json_t *object) {
    build->known = true;
    build->exact = get_flag(reader, object, "exact");
    build->counts = get_flag(reader, object, "counts");
    take_text(reader, build->spec, sizeof build->spec, object, "spec");
    build->seconds = take_positive(reader, json_object_get(object, "seconds"), "seconds");
    build->shape = (RtDescription){.interior = get_count(reader, object, "interior"),
                                   .leaves = get_count(reader, object, "leaves"),
                                   .empty_leaves = get_count(reader, object, "empty_leaves"),
                                   .references = get_count(reader, object, "references"),
                                   .depth = get_count(reader, object, "depth"),
                                   .bytes = get_count(reader, object, "bytes")};
#define TAKE_PREDICTION(name, meaning) build->shape.name = get_number(reader, object, #name);
    RT_PREDICTIONS(TAKE_PREDICTION)
    RT_QUALITIES(TAKE_PREDICTION)
#undef TAKE_PREDICTION
    take_tally(reader, &build->shape.build, json_object_get(object, "build"));
    take_distributions(reader, &build->leaves, RT_RAY_QUANTITY_COUNT, RT_LEAF_QUANTITY_COUNT,
                       json_object_get(object, "distributions"));
}

static void take_count(Reader *reader, RtCell *cell, const json_t *object) {
    cell->counted = true;
    cell->differ = get_count(reader, object, "differ");
    take_tally(reader, &cell->tally, object);
}

/* Journals of earlier versions have no times of rounds. */
static void take_rounds(Reader *reader, RtCell *cell, const json_t *object) {
    bool any = false;
    rt_free(cell->each); /* of a line before, which may have had another number of them */
    cell->each = NULL;
    for (int i = 0; i < RT_EACH_COUNT; i++) any |= json_object_get(object, rt_journal_each_names[i]) != NULL;
    for (int i = 0; i < RT_EACH_COUNT && any; i++) {
        if (json_array_size(json_object_get(object, rt_journal_each_names[i])) != cell->rounds)
            reject(reader, rt_journal_each_names[i], "a list of as many times as there were rounds");
    }
    if (!any || reader->status != RT_OK) return;
    reader->status = rt_cell_make_rounds(cell, reader->error);
    for (int i = 0; i < RT_EACH_COUNT && cell->each; i++) {
        const json_t *list = json_object_get(object, rt_journal_each_names[i]);
        for (uint32_t r = 0; r < cell->rounds; r++)
            rt_cell_rounds(cell, (RtEach)i)[r] =
                take_positive(reader, json_array_get(list, r), rt_journal_each_names[i]);
    }
}

static uint32_t take_machine(Reader *reader, RtResults *results, const json_t *object) {
    RtMachine machine;
    take_text(reader, machine.host, sizeof machine.host, object, "host");
    take_text(reader, machine.cpu, sizeof machine.cpu, object, "cpu");
    return rt_results_machine(results, &machine);
}

static void take_hardware(Reader *reader, RtResults *results, RtCell *cell, const json_t *object) {
    RtCellHardware *hardware = &cell->hardware;
    hardware->known = true;
    hardware->threads = (int)get_integer(reader, object, "threads", 0, INT_MAX);
    hardware->machine = take_machine(reader, results, object);
    hardware->counts.running = get_number(reader, object, "running");
    take_text(reader, hardware->why, sizeof hardware->why, object, "why");
    for (size_t i = 0; i < RT_HARDWARE_COUNT; i++)
        hardware->counts.of[i] = get_number(reader, object, rt_hardware_name(i));
}

static void take_time(Reader *reader, RtResults *results, uint32_t workload, RtCell *cell,
                      const json_t *object) {
    const RtExperiment *experiment = results->experiment;
    const char *baseline = find_text(reader, object, "baseline");
    uint32_t c = baseline ? rt_candidate_find(experiment, baseline, workload) : experiment->baseline;
    if (c >= experiment->candidate_count || !rt_candidate_is_baseline(experiment, c))
        reject(reader, "baseline", "a baseline of the experiment");
    cell->machine = take_machine(reader, results, object);
    cell->baseline = c < experiment->candidate_count ? c : experiment->baseline;
    cell->timed = true;
    cell->tally.rays = get_integer(reader, object, "rays", 1, INT64_MAX);
    cell->rounds = (uint32_t)get_integer(reader, object, "rounds", 1, RT_MAX_ROUNDS);
    cell->threads = (int)get_integer(reader, object, "threads", 1, INT_MAX);
    cell->seconds = get_estimate(reader, object, "seconds");
    cell->wall = get_estimate(reader, object, "wall");
    cell->ratio = get_estimate(reader, object, "ratio");
    take_rounds(reader, cell, object);
}

/* Where the line says which limit was gone beyond, or what broke. */
static void take_limit(Reader *reader, const json_t *line, const char *key, char *limit, bool *broken) {
    const char *text = find_text(reader, line, key);
    if (!text) return;
    snprintf(limit, RT_MAX_LIMIT, "%s", text);
    *broken = json_object_get(line, "broken") && get_flag(reader, line, "broken");
}

/* Whether the line says something by one of such keys (NULL behind the last). */
static bool has_any(const json_t *line, const char *const *keys) {
    for (; *keys; keys++) {
        if (json_object_get(line, *keys)) return true;
    }
    return false;
}

static void take_cell(Reader *reader, RtResults *results, const json_t *line, uint32_t workload,
                      uint32_t candidate, RtRayKind kind) {
    RtCell *cell = rt_cell_at(results, workload, candidate, kind);
    const json_t *object;
    if ((object = json_object_get(line, "counted"))) take_count(reader, cell, object);
    take_distributions(reader, &cell->distributions, 0, RT_RAY_QUANTITY_COUNT,
                       json_object_get(line, "distributed"));
    take_limit(reader, line, "too_long", cell->limit, &cell->broken);
    if ((object = json_object_get(line, "hardware"))) take_hardware(reader, results, cell, object);
    if ((object = json_object_get(line, "timed"))) take_time(reader, results, workload, cell, object);
}

/* Places a line where its labels say; lines about what the experiment does not have are passed over. */
static void take_line(Reader *reader, RtResults *results, const json_t *line) {
    static const char *const of_cells[] = {"counted", "distributed", "timed", "hardware", "too_long", NULL};
    static const char *const of_builds[] = {"built", "too_large", NULL};
    const RtExperiment *experiment = results->experiment;
    const char *scene = find_text(reader, line, "scene"), *accel = find_text(reader, line, "accel");
    const char *kind_name = find_text(reader, line, "kind");
    const json_t *object;
    RtRayKind kind = RT_RAY_PRIMARY;
    const bool of_cell = has_any(line, of_cells), of_build = has_any(line, of_builds);
    if (!json_is_object(line)) reject(reader, "this line", "a JSON object");
    if (!scene) reject(reader, "scene", "there");
    if (!accel && (of_cell || of_build)) reject(reader, "accel", "there");
    if (of_cell && (!kind_name || rt_ray_kind_parse(kind_name, &kind, NULL) != RT_OK))
        reject(reader, "kind", "a kind of rays");
    if (reader->status != RT_OK) return;
    uint32_t workload = rt_workload_find(experiment, scene);
    if (workload == experiment->workload_count) return;
    if ((object = json_object_get(line, "workload")))
        take_workload(reader, &results->workloads[workload], object);
    if (!accel) return;
    uint32_t candidate = rt_candidate_find(experiment, accel, workload);
    if (candidate > experiment->candidate_count) return;
    RtBuildResult *build = rt_build_at(results, workload, candidate);
    if ((object = json_object_get(line, "built"))) take_build(reader, build, object);
    take_limit(reader, line, "too_large", build->limit, &build->broken);
    if (of_cell) take_cell(reader, results, line, workload, candidate, kind);
}

/* ---- what the journal is of ---- */

static RtStatus check_experiment(const char *path, const json_t *header, const RtExperiment *experiment,
                                 RtError *error) {
    const char *name = json_string_value(json_object_get(header, "experiment"));
    bool quick = json_is_true(json_object_get(header, "quick"));
    bool good;
    if (parse_hex(json_object_get(header, "hash"), &good) != experiment->fingerprint || !good) {
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
    json_int_t shard = json_integer_value(json_object_get(header, "shard")),
               shards = json_integer_value(json_object_get(header, "shards"));
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
    if (json_is_true(json_object_get(header, "given_up"))) return RT_OK; /* rt_previous_results_remove */
    RT_TRY(check_experiment(path, header, experiment, error));
    if (only) RT_TRY(check_build(path, header, only, error));
    json_t *used = only ? rt_plugins_used(experiment) : NULL;
    json_t *changed = only ? rt_plugins_changed(json_object_get(header, "plugins"), used) : NULL;
    RtStatus status = only ? check_plugins(path, experiment, changed, renew, error) : RT_OK;
    for (size_t i = 1; status == RT_OK && i < json_array_size(lines); i++) {
        const json_t *line = json_array_get(lines, i);
        if (changed && rt_journal_line_concerns(line, experiment, changed)) continue;
        Reader reader = {path, i + 1, RT_OK, error};
        take_line(&reader, results, line);
        status = reader.status;
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
