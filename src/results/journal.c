/* SPDX-License-Identifier: Apache-2.0 */
/* Structs become JSON objects and are read back by one list of members each (Record). */
#include "results/journal.h"

#include "core/base/memory.h"
#include "core/base/versions.h"
#include "core/text/json.h"
#include "experiment/plugins_used.h"
#include "measure/machine.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

bool rt_event_is_broken(const RtResults *results, const RtEvent *event) {
    if (event->what == RT_EVENT_NO_BUILD)
        return rt_build_at(results, event->workload, event->candidate)->broken;
    return event->what == RT_EVENT_NO_CELL &&
           rt_cell_at(results, event->workload, event->candidate, event->kind)->broken;
}

void rt_notify(const RtRunObserver *observer, const char *format, ...) {
    char message[RT_MAX_PATH + 1024];
    va_list args;
    if (!observer->notice) return;
    va_start(args, format);
    /* clang-tidy 14 does not see va_start. NOLINTNEXTLINE(clang-analyzer-valist.Uninitialized) */
    vsnprintf(message, sizeof message, format, args);
    va_end(args);
    observer->notice(observer->context, message);
}

/* ---- records ---- */

/* The C type of a member, and its JSON. */
typedef enum MemberForm {
    MEMBER_FLAG,        /* bool: true or false */
    MEMBER_U32,         /* uint32_t: an integer */
    MEMBER_ADDED,       /* the same; 0: missing, as in journals of older versions */
    MEMBER_ADDED_COUNT, /* uint64_t, likewise */
    MEMBER_INT,         /* int: an integer, 0 or more */
    MEMBER_COUNT,       /* uint64_t: an integer, up to INT64_MAX */
    MEMBER_HASH,        /* uint64_t: 16 hexadecimal digits */
    MEMBER_TEXT,        /* char[]: a string; missing: "" */
    MEMBER_NUMBER,      /* double: a number; NAN: null, or missing */
    MEMBER_ESTIMATE,    /* RtEstimate: [median, low, high, least], each 0 or more; or one number for all */
    MEMBER_RATIO,       /* the same; NAN: null */
    MEMBER_OBJECT       /* members of the same struct, as an object of their own */
} MemberForm;

typedef struct Record Record;
typedef struct Member {
    const char *name;
    MemberForm form;
    size_t offset, size;  /* in the struct */
    uint64_t least, most; /* of an integer; most 0: all that its type holds */
    const Record *object; /* of MEMBER_OBJECT */
} Member;

struct Record {
    const Member *members;
    size_t count;
};

#define MEMBER_RANGE(Type, form, name, field, least, most)                                                   \
    { name, MEMBER_##form, offsetof(Type, field), sizeof((Type *)0)->field, least, most, NULL }
#define MEMBER(Type, form, name, field) MEMBER_RANGE(Type, form, name, field, 0, 0)
#define MEMBER_OF(name, object)                                                                              \
    { name, MEMBER_OBJECT, 0, 0, 0, 0, object }
#define RECORD(members)                                                                                      \
    { members, sizeof(members) / sizeof *(members) }

static json_t *record_json(const Record *record, const void *from);

static json_t *member_json(const Member *m, const void *from) {
    const void *at = (const char *)from + m->offset;
    const RtEstimate *e = at;
    switch (m->form) {
    case MEMBER_FLAG: return json_boolean(*(const bool *)at);
    case MEMBER_ADDED:
    case MEMBER_U32: return json_integer(*(const uint32_t *)at);
    case MEMBER_INT: return json_integer(*(const int *)at);
    case MEMBER_ADDED_COUNT:
    case MEMBER_COUNT: return json_integer(*(const int64_t *)at);
    case MEMBER_HASH: return rt_json_hex(*(const uint64_t *)at);
    case MEMBER_TEXT: return json_string(at);
    case MEMBER_NUMBER: return rt_json_number(*(const double *)at);
    case MEMBER_RATIO:
        if (isnan(e->median)) return json_null();
        __attribute__((fallthrough));
    case MEMBER_ESTIMATE: return json_pack("[f, f, f, f]", e->median, e->low, e->high, e->least);
    case MEMBER_OBJECT: return record_json(m->object, from);
    }
    return NULL;
}

/* The struct as a new object; NULL if memory is short. */
static json_t *record_json(const Record *record, const void *from) {
    json_t *json = json_object();
    for (size_t i = 0; json && i < record->count; i++)
        json = rt_json_add(json, record->members[i].name, member_json(&record->members[i], from));
    return json;
}

/* Reads a line of a journal. The first fault is reported; values read after it are within their ranges and
 * otherwise meaningless. */
typedef struct Reader {
    const char *path;
    size_t line; /* from 1 */
    RtStatus status;
    RtError *error;
} Reader;

/* Reports that `key` is not what was wanted. */
static void reject(Reader *reader, const char *key, const char *wanted) {
    if (reader->status != RT_OK) return;
    reader->status = rt_fail_at(reader->error, reader->path, reader->line, 0,
                                "'%s' is not %s: the journal is damaged, or from another version of "
                                "raytally. Remove this line; --resume then measures its cells again",
                                key, wanted);
}

static uint64_t take_integer(Reader *reader, const Member *m, const json_t *value) {
    const uint64_t all = m->form == MEMBER_U32 ? UINT32_MAX : m->form == MEMBER_INT ? INT_MAX : INT64_MAX;
    const uint64_t most = m->most ? m->most : all;
    const json_int_t number = json_integer_value(value);
    if (json_is_integer(value) && number >= 0 && (uint64_t)number >= m->least && (uint64_t)number <= most)
        return (uint64_t)number;
    char wanted[96];
    snprintf(wanted, sizeof wanted, "a whole number from %" PRIu64 " to %" PRIu64, m->least, most);
    reject(reader, m->name, wanted);
    return m->least;
}

/* A number, 0 or more. */
static double take_seconds(Reader *reader, const json_t *value, const char *key) {
    const double number = json_number_value(value);
    if (json_is_number(value) && number >= 0) return number;
    reject(reader, key, "a number, 0 or more");
    return 0;
}

/* NULL if it is missing. */
static const char *take_text(Reader *reader, const json_t *json, const char *key) {
    const json_t *value = json_object_get(json, key);
    if (value && !json_is_string(value)) reject(reader, key, "a text");
    return json_string_value(value);
}

static void take_record(Reader *reader, const Record *record, void *to, const json_t *json);

static void take_member(Reader *reader, const Member *m, void *to, const json_t *json) {
    const json_t *value = json_object_get(json, m->name);
    void *at = (char *)to + m->offset;
    const char *text;
    bool good;
    switch (m->form) {
    case MEMBER_FLAG:
        if (!json_is_boolean(value)) reject(reader, m->name, "true or false");
        *(bool *)at = json_is_true(value);
        return;
    case MEMBER_ADDED: *(uint32_t *)at = value ? (uint32_t)take_integer(reader, m, value) : 0; return;
    case MEMBER_U32: *(uint32_t *)at = (uint32_t)take_integer(reader, m, value); return;
    case MEMBER_INT: *(int *)at = (int)take_integer(reader, m, value); return;
    case MEMBER_ADDED_COUNT: *(uint64_t *)at = value ? take_integer(reader, m, value) : 0; return;
    case MEMBER_COUNT: *(uint64_t *)at = take_integer(reader, m, value); return;
    case MEMBER_HASH:
        *(uint64_t *)at = rt_json_parse_hex(value, &good);
        if (!good) reject(reader, m->name, "a hash of 16 hexadecimal digits");
        return;
    case MEMBER_TEXT:
        text = take_text(reader, json, m->name);
        snprintf(at, m->size, "%s", text ? text : "");
        return;
    case MEMBER_NUMBER:
        if (value && !json_is_null(value) && !json_is_number(value)) reject(reader, m->name, "a number");
        *(double *)at = json_is_number(value) ? json_number_value(value) : (double)NAN;
        return;
    case MEMBER_RATIO:
        *(RtEstimate *)at = rt_estimate_exactly((double)NAN);
        if (json_is_null(value)) return;
        __attribute__((fallthrough));
    case MEMBER_ESTIMATE: {
        RtEstimate *e = at;
        double *const parts[] = {&e->median, &e->low, &e->high, &e->least};
        for (size_t i = 0; i < 4; i++)
            *parts[i] =
                take_seconds(reader, json_is_array(value) ? json_array_get(value, i) : value, m->name);
        return;
    }
    case MEMBER_OBJECT: take_record(reader, m->object, to, value); return;
    }
}

/* Fills the members of the struct at `to`. */
static void take_record(Reader *reader, const Record *record, void *to, const json_t *json) {
    for (size_t i = 0; i < record->count; i++) take_member(reader, &record->members[i], to, json);
}

/* ---- members ---- */

#define SET(CONSTANT, name, meaning)                                                                         \
    static const Member name##_members[] = {                                                                 \
        MEMBER(RtWorkloadResult, COUNT, "rays", rays[RT_RAY_##CONSTANT]),                                    \
        MEMBER(RtWorkloadResult, ADDED_COUNT, "whole_rays", whole_rays[RT_RAY_##CONSTANT]),                  \
        MEMBER(RtWorkloadResult, HASH, "hash", ray_fingerprints[RT_RAY_##CONSTANT])};
RT_RAY_KINDS(SET)

#define SET_RECORD(CONSTANT, name, meaning) RECORD(name##_members),
static const Record ray_sets[RT_RAY_KIND_COUNT] = {RT_RAY_KINDS(SET_RECORD)};

#define SET_MEMBER(CONSTANT, name, meaning) MEMBER_OF(#name, &ray_sets[RT_RAY_##CONSTANT]),
static const Member sets_members[] = {RT_RAY_KINDS(SET_MEMBER)};
static const Record sets = RECORD(sets_members);

static const Member workload_members[] = {
    MEMBER(RtWorkloadResult, U32, "objects", objects),    MEMBER(RtWorkloadResult, U32, "width", width),
    MEMBER(RtWorkloadResult, U32, "height", height),      MEMBER(RtWorkloadResult, HASH, "hash", scene),
    MEMBER(RtWorkloadResult, TEXT, "warnings", warnings), MEMBER_OF("sets", &sets)};

#define COST_OF_BUILD(name, meaning) MEMBER(RtBuildResult, COUNT, #name, structure.build.name),
#define ADDED_COST(name, meaning)    MEMBER(RtBuildResult, ADDED_COUNT, #name, structure.build.name),
static const Member build_tally_members[] = {RT_FIRST_TALLY_COUNTERS(COST_OF_BUILD)
                                                 RT_ADDED_TALLY_COUNTERS(ADDED_COST)};
static const Record build_tally = RECORD(build_tally_members);

#define EXPECTED(name, meaning) MEMBER(RtBuildResult, NUMBER, #name, structure.name),
static const Member build_members[] = {MEMBER(RtBuildResult, COUNT, "interior", structure.interior),
                                       MEMBER(RtBuildResult, COUNT, "leaves", structure.leaves),
                                       MEMBER(RtBuildResult, COUNT, "empty_leaves", structure.empty_leaves),
                                       MEMBER(RtBuildResult, COUNT, "references", structure.references),
                                       MEMBER(RtBuildResult, COUNT, "depth", structure.depth),
                                       RT_PREDICTIONS(EXPECTED) RT_QUALITIES(EXPECTED)
                                           MEMBER_OF("build", &build_tally),
                                       MEMBER(RtBuildResult, TEXT, "spec", spec),
                                       MEMBER(RtBuildResult, FLAG, "exact", exact),
                                       MEMBER(RtBuildResult, FLAG, "counts", counts),
                                       MEMBER(RtBuildResult, ESTIMATE, "seconds", seconds),
                                       MEMBER(RtBuildResult, COUNT, "bytes", structure.bytes),
                                       MEMBER_RANGE(RtBuildResult, ADDED, "builds", builds, 0, RT_MAX_ROUNDS),
                                       MEMBER_RANGE(RtBuildResult, ADDED, "threads", threads, 0, 1024)};

#define COUNTER(name, meaning)       MEMBER(RtCell, COUNT, #name, tally.name),
#define ADDED_COUNTER(name, meaning) MEMBER(RtCell, ADDED_COUNT, #name, tally.name),
static const Member count_members[] = {RT_FIRST_TALLY_COUNTERS(COUNTER) RT_ADDED_TALLY_COUNTERS(ADDED_COUNTER)
                                           MEMBER(RtCell, COUNT, "differ", differ)};

static const Member time_members[] = {MEMBER_RANGE(RtCell, COUNT, "rays", tally.rays, 1, 0),
                                      MEMBER_RANGE(RtCell, U32, "rounds", rounds, 1, RT_MAX_ROUNDS),
                                      MEMBER(RtCell, NUMBER, "repeats", repeats),
                                      MEMBER_RANGE(RtCell, ADDED, "structures", structures, 0, RT_MAX_ROUNDS),
                                      MEMBER(RtCell, NUMBER, "learnt", learnt),
                                      MEMBER_RANGE(RtCell, INT, "threads", threads, 1, 0),
                                      MEMBER(RtCell, ESTIMATE, "seconds", seconds),
                                      MEMBER(RtCell, ESTIMATE, "wall", wall),
                                      MEMBER(RtCell, RATIO, "ratio", ratio)};

static const Member render_members[] = {
    MEMBER_RANGE(RtBuildResult, U32, "rounds", render.rounds, 1, RT_MAX_ROUNDS),
    MEMBER_RANGE(RtBuildResult, INT, "threads", render.threads, 1, 0),
    MEMBER(RtBuildResult, ESTIMATE, "seconds", render.seconds),
    MEMBER(RtBuildResult, ESTIMATE, "share", render.share)};

static const Member machine_members[] = {MEMBER(RtMachine, TEXT, "host", host),
                                         MEMBER(RtMachine, TEXT, "cpu", cpu)};
static const Record of_machine = RECORD(machine_members);

/* The lists of the times of each round. */
static const char *const round_time_names[RT_ROUND_TIME_COUNT] = {"each_seconds", "each_wall",
                                                                  "each_baseline"};

/* ---- parts ---- */

/* What an event adds to the line of its scene, accelerator and kind of rays. */
typedef enum Place { OF_WORKLOAD, OF_BUILD, OF_CELL } Place;
static const struct Part {
    const char *key;
    Place place;
    Record record; /* of the workload's, the build's or the cell's result */
} parts[] = {[RT_EVENT_WORKLOAD] = {"workload", OF_WORKLOAD, RECORD(workload_members)},
             [RT_EVENT_BUILD] = {"built", OF_BUILD, RECORD(build_members)},
             [RT_EVENT_COUNT] = {"counted", OF_CELL, RECORD(count_members)},
             [RT_EVENT_DISTRIBUTION] = {"distributed", OF_CELL, {NULL, 0}},
             [RT_EVENT_CHOICE] = {"chosen", OF_CELL, {NULL, 0}},
             [RT_EVENT_TIME] = {"timed", OF_CELL, RECORD(time_members)},
             [RT_EVENT_RENDER] = {"rendered", OF_BUILD, RECORD(render_members)},
             [RT_EVENT_NO_BUILD] = {"too_large", OF_BUILD, {NULL, 0}},
             [RT_EVENT_NO_CELL] = {"too_long", OF_CELL, {NULL, 0}}};

/* ---- writing a line ---- */

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
    json_t *json = record_json(&parts[RT_EVENT_BUILD].record, build);
    if (!build->leaves) return json;
    return rt_json_add(json, "distributions",
                       rt_distributions_json(build->leaves, RT_RAY_QUANTITY_COUNT, RT_LEAF_QUANTITY_COUNT));
}

static json_t *time_json(const RtResults *results, const RtCell *cell) {
    json_t *json = record_json(&parts[RT_EVENT_TIME].record, cell);
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
    const Record *record = &parts[event->what].record;
    switch (event->what) {
    case RT_EVENT_WORKLOAD: return record_json(record, &results->workloads[event->workload]);
    case RT_EVENT_BUILD: return build_json(build);
    case RT_EVENT_COUNT: return record_json(record, cell);
    case RT_EVENT_DISTRIBUTION: return rt_distributions_json(cell->distributions, 0, RT_RAY_QUANTITY_COUNT);
    case RT_EVENT_CHOICE: return json_string(rt_candidate_label(results->experiment, cell->choice));
    case RT_EVENT_TIME: return time_json(results, cell);
    case RT_EVENT_RENDER: return add_machine(record_json(record, build), results, build->render.machine);
    case RT_EVENT_NO_BUILD: return json_string(build->left_out);
    case RT_EVENT_NO_CELL: return json_string(cell->left_out);
    }
    return NULL;
}

json_t *rt_ray_set_json(const RtWorkloadResult *workload, RtRayKind kind) {
    return record_json(&ray_sets[kind], workload);
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

/* ---- reading a line ---- */

/* Makes room for `count` distributions, from number `first` on, and fills it; if they are missing, *out stays
 * as it is, and they are measured again. */
static void take_distributions(Reader *reader, RtDistribution **out, size_t first, size_t count,
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
static void take_rounds(Reader *reader, RtCell *cell, const json_t *json) {
    bool any = false;
    rt_free(cell->round_times); /* of an earlier line, which may have had another number of rounds */
    cell->round_times = NULL;
    for (int i = 0; i < RT_ROUND_TIME_COUNT; i++) any |= json_object_get(json, round_time_names[i]) != NULL;
    for (int i = 0; i < RT_ROUND_TIME_COUNT && any; i++) {
        if (json_array_size(json_object_get(json, round_time_names[i])) != cell->rounds)
            reject(reader, round_time_names[i], "a list of as many times as there were rounds");
    }
    if (!any || reader->status != RT_OK) return;
    reader->status = rt_cell_make_round_times(cell, reader->error);
    for (int i = 0; i < RT_ROUND_TIME_COUNT && cell->round_times; i++) {
        const json_t *list = json_object_get(json, round_time_names[i]);
        const bool unknown = i == RT_ROUND_BASELINE && isnan(cell->ratio.median); /* no baseline */
        for (uint32_t r = 0; r < cell->rounds; r++)
            rt_cell_round_times(cell, (RtRoundTime)i)[r] =
                unknown ? (double)NAN : take_seconds(reader, json_array_get(list, r), round_time_names[i]);
    }
}

static uint32_t take_machine(Reader *reader, RtResults *results, const json_t *json) {
    RtMachine machine;
    take_record(reader, &of_machine, &machine, json);
    return rt_results_machine(results, &machine);
}

static void take_baseline(Reader *reader, const RtExperiment *experiment, uint32_t workload, RtCell *cell,
                          const json_t *json) {
    const char *baseline = take_text(reader, json, "baseline");
    uint32_t c = baseline ? rt_candidate_find(experiment, baseline, workload) : experiment->baseline;
    if (c >= experiment->candidate_count || !rt_candidate_is_baseline(experiment, c))
        reject(reader, "baseline", "a baseline of the experiment");
    cell->baseline = c < experiment->candidate_count ? c : experiment->baseline;
}

static void choose(RtResults *results, uint32_t workload, uint32_t best, RtRayKind kind, uint32_t choice) {
    RtCell *cell = rt_cell_at(results, workload, best, kind);
    cell->chosen = true;
    cell->choice = choice;
}

static void take_choice(Reader *reader, const json_t *line, RtResults *results, uint32_t workload,
                        uint32_t candidate, RtRayKind kind) {
    const char *label = take_text(reader, line, parts[RT_EVENT_CHOICE].key);
    if (!label) return;
    const uint32_t c = rt_candidate_find(results->experiment, label, workload);
    if (rt_candidate_is_member(results->experiment, candidate, c))
        choose(results, workload, candidate, kind, c);
    else
        reject(reader, parts[RT_EVENT_CHOICE].key, "a setting of this accelerator");
}

/* A flag that journals of older versions lack. */
static bool take_added_flag(Reader *reader, const json_t *line, const char *key) {
    const json_t *flag = json_object_get(line, key);
    if (flag && !json_is_boolean(flag)) reject(reader, key, "true or false");
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
static const json_t *take_part(Reader *reader, const json_t *line, RtEventKind what, void *to) {
    const json_t *json = json_object_get(line, parts[what].key);
    if (json) take_record(reader, &parts[what].record, to, json);
    return json;
}

static void take_build(Reader *reader, const json_t *line, RtResults *results, uint32_t workload,
                       uint32_t candidate) {
    RtBuildResult *build = rt_build_at(results, workload, candidate);
    const json_t *built = take_part(reader, line, RT_EVENT_BUILD, build);
    build->known |= built != NULL;
    take_distributions(reader, &build->leaves, RT_RAY_QUANTITY_COUNT, RT_LEAF_QUANTITY_COUNT,
                       json_object_get(built, "distributions"));
    const json_t *rendered = take_part(reader, line, RT_EVENT_RENDER, build);
    build->render.known |= rendered != NULL;
    if (rendered) build->render.machine = take_machine(reader, results, rendered);
    const char *why = take_text(reader, line, parts[RT_EVENT_NO_BUILD].key);
    if (why)
        rt_results_leave_out(results, workload, candidate, why, take_added_flag(reader, line, "refused"),
                             take_added_flag(reader, line, "broken"));
}

static void take_cell(Reader *reader, const json_t *line, RtResults *results, uint32_t workload,
                      uint32_t candidate, RtRayKind kind) {
    const RtExperiment *experiment = results->experiment;
    RtCell *cell = rt_cell_at(results, workload, candidate, kind);
    take_choice(reader, line, results, workload, candidate, kind);
    cell->counted |= take_part(reader, line, RT_EVENT_COUNT, cell) != NULL;
    take_distributions(reader, &cell->distributions, 0, RT_RAY_QUANTITY_COUNT,
                       json_object_get(line, "distributed"));
    const char *why = take_text(reader, line, parts[RT_EVENT_NO_CELL].key);
    if (why) {
        snprintf(cell->left_out, sizeof cell->left_out, "%s", why);
        cell->broken = take_added_flag(reader, line, "broken");
    }
    const json_t *timed = take_part(reader, line, RT_EVENT_TIME, cell);
    cell->timed |= timed != NULL;
    if (!timed) return;
    take_baseline(reader, experiment, workload, cell, timed);
    /* Version 1.0 chose among the settings of the baseline alone, and kept no choice of its own. */
    if (candidate < experiment->candidate_count && cell->baseline != experiment->baseline)
        choose(results, workload, experiment->baseline, kind, cell->baseline);
    cell->machine = take_machine(reader, results, timed);
    take_rounds(reader, cell, timed);
}

/* Fills the results with what the line says. Ignores scenes and accelerators that the experiment does not
 * have. */
static void take_line(Reader *reader, RtResults *results, const json_t *line) {
    const RtExperiment *experiment = results->experiment;
    const char *scene = take_text(reader, line, "scene"), *accel = take_text(reader, line, "accel");
    const char *kind_name = take_text(reader, line, "kind");
    const bool of_cell = has_part(line, OF_CELL), of_build_too = of_cell || has_part(line, OF_BUILD);
    RtRayKind kind = RT_RAY_PRIMARY;
    if (!json_is_object(line)) reject(reader, "this line", "a JSON object");
    if (!scene) reject(reader, "scene", "there");
    if (!accel && of_build_too) reject(reader, "accel", "there");
    if (of_cell && (!kind_name || rt_ray_kind_parse(kind_name, &kind, NULL) != RT_OK))
        reject(reader, "kind", "a kind of rays");
    if (reader->status != RT_OK) return;
    const uint32_t workload = rt_workload_find(experiment, scene);
    if (workload == experiment->workload_count) return;
    RtWorkloadResult *scene_result = &results->workloads[workload];
    scene_result->known |= take_part(reader, line, RT_EVENT_WORKLOAD, scene_result) != NULL;
    if (!accel) return;
    const uint32_t candidate = rt_candidate_find(experiment, accel, workload);
    if (candidate > experiment->candidate_count) return;
    take_build(reader, line, results, workload, candidate);
    if (of_cell) take_cell(reader, line, results, workload, candidate, kind);
}

/* Whether a line is about a candidate that has a layer of one of `plugins` (experiment/plugins_used.h). */
static bool line_concerns(const json_t *line, const RtExperiment *experiment, const json_t *plugins) {
    const char *scene = json_string_value(json_object_get(line, "scene"));
    const char *accel = json_string_value(json_object_get(line, "accel"));
    const uint32_t workload = scene ? rt_workload_find(experiment, scene) : experiment->workload_count;
    if (!accel || workload == experiment->workload_count) return false;
    const uint32_t candidate = rt_candidate_find(experiment, accel, workload);
    return candidate <= experiment->candidate_count && rt_plugins_concern(plugins, experiment, candidate);
}

/* ---- the header ---- */

static json_t *header_json(const RtExperiment *experiment, const RtSelection *only) {
    return json_pack("{s:i, s:s, s:o, s:b, s:s, s:i, s:i, s:o, s:o}", "format", RT_FILE_FORMAT, "experiment",
                     experiment->name, "hash", rt_json_hex(experiment->fingerprint), "quick",
                     experiment->quick, "build", rt_build_alone(), "shard", (int)only->shard, "shards",
                     (int)only->shards, "plugins", rt_plugins_used(experiment), "claims",
                     rt_claims_json(experiment));
}

/* ---- writing the file ---- */

RtStatus rt_journal_open(RtJsonLines *journal, const char *path, const RtExperiment *experiment,
                         const RtSelection *only, bool resume, RtError *error) {
    json_t *header = resume ? NULL : header_json(experiment, only);
    if (!resume && !header) return rt_fail_memory(error, path, 0);
    RtStatus status = rt_json_lines_open(journal, path, header, error);
    json_decref(header);
    return status;
}

/* A new header, then all lines except those of `changed` plugins. */
static json_t *lines_without(const json_t *lines, const RtExperiment *experiment, const RtSelection *only,
                             const json_t *changed) {
    json_t *line, *header = header_json(experiment, only), *kept = json_pack("[o]", header);
    size_t i;
    json_t *first = json_object_get(json_array_get(lines, 0), "claims");
    if (first) json_object_set(header, "claims", first); /* those with which the run began */
    json_array_foreach((json_t *)lines, i, line) {
        if (i > 0 && json_is_object(line) && !line_concerns(line, experiment, changed))
            json_array_append(kept, line);
    }
    return kept;
}

static void format_change(const json_t *changed, void *at, char sentence[RT_MAX_PLUGIN_CHANGE]) {
    const char *name = json_object_iter_key(at);
    rt_plugins_change_format(name, json_object_get(changed, name), "when this run began", "now", sentence);
}

RtStatus rt_journal_drop_changed(const char *path, const RtExperiment *experiment, const RtSelection *only,
                                 const RtRunObserver *observer, RtError *error) {
    json_t *lines;
    char sentence[RT_MAX_PLUGIN_CHANGE];
    RT_TRY(rt_json_lines_load(path, &lines, error));
    json_t *plugins = json_object_get(json_array_get(lines, 0), "plugins");
    json_t *changed = rt_plugins_changed_since(plugins, experiment);
    for (void *at = json_object_iter(changed); at; at = json_object_iter_next(changed, at)) {
        format_change(changed, at, sentence);
        rt_notify(observer, "%s: its cells are measured again", sentence);
    }
    RtStatus status = RT_OK;
    if (json_object_size(changed) > 0) {
        json_t *kept = lines_without(lines, experiment, only, changed);
        status = rt_json_lines_save(path, kept, error);
        json_decref(kept);
    }
    json_decref(changed);
    json_decref(lines);
    return status;
}

RtStatus rt_journal_add(RtOutputs *outputs, const char *path, const RtExperiment *experiment,
                        const RtSelection *only, const json_t *lines, RtError *error) {
    RtOutput *output;
    json_t *all = json_pack("[o]", header_json(experiment, only));
    RtStatus status =
        all && json_array_extend(all, (json_t *)lines) == 0 ? RT_OK : rt_fail_memory(error, path, 0);
    if (status == RT_OK) status = rt_outputs_add(outputs, path, &output, error);
    if (status == RT_OK) status = rt_json_lines_put(output, all, error);
    if (status == RT_OK) status = rt_output_finish(output, error);
    json_decref(all);
    return status;
}

/* ---- reading the file ---- */

static RtStatus check_experiment(const char *path, const json_t *header, const RtExperiment *experiment,
                                 RtError *error) {
    bool quick = json_is_true(json_object_get(header, "quick"));
    if (!rt_experiment_has_hash(experiment, json_object_get(header, "hash"))) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: this is a run of another experiment, or of another version of it ('%s'): replace "
                       "it with --force, or choose another --out",
                       path, rt_json_text(header, "experiment", ""));
    }
    if (quick == experiment->quick) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: this is a run %s --quick: replace it with --force, or choose another --out", path,
                   quick ? "with" : "without");
}

static bool is_of_shard(const json_t *header, const RtSelection *only) {
    return json_integer_value(json_object_get(header, "shard")) == only->shard &&
           json_integer_value(json_object_get(header, "shards")) == only->shards;
}

static RtStatus check_build(const char *path, const json_t *header, const RtSelection *only, RtError *error) {
    const char *build = rt_json_text(header, "build", "unknown");
    if (!is_of_shard(header, only)) {
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: this is a run with another --shard (%d/%d): replace it with --force, or choose "
                       "another --out",
                       path, (int)json_integer_value(json_object_get(header, "shard")),
                       (int)json_integer_value(json_object_get(header, "shards")));
    }
    if (strcmp(build, rt_build_alone()) == 0) return RT_OK;
    return rt_fail(
        error, RT_BAD_INPUT,
        "%s: another build began this run (%s; this is %s): replace it with --force, or choose another --out",
        path, build, rt_build_alone());
}

/* A changed baseline invalidates the whole run. */
static RtStatus check_baseline(const char *path, const RtExperiment *experiment, json_t *changed,
                               RtError *error) {
    char sentence[RT_MAX_PLUGIN_CHANGE];
    if (!rt_plugins_concern(changed, experiment, experiment->baseline)) return RT_OK;
    format_change(changed, json_object_iter(changed), sentence);
    return rt_fail(
        error, RT_BAD_INPUT,
        "%s: %s; this changes the baseline: replace this run with --force, or choose another --out", path,
        sentence);
}

static RtStatus take_lines(const char *path, RtResults *results, const json_t *lines, const RtSelection *only,
                           RtError *error) {
    const RtExperiment *experiment = results->experiment;
    const json_t *header = json_array_get(lines, 0);
    if (json_is_true(json_object_get(header, "given_up"))) return RT_OK; /* rt_result_files_remove */
    RT_TRY(rt_json_check_format(header, path, error));
    RT_TRY(check_experiment(path, header, experiment, error));
    if (only) RT_TRY(check_build(path, header, only, error));
    json_decref(results->first_claims);
    results->first_claims = json_incref(json_object_get(header, "claims"));
    json_t *changed = only ? rt_plugins_changed_since(json_object_get(header, "plugins"), experiment) : NULL;
    RtStatus status = only ? check_baseline(path, experiment, changed, error) : RT_OK;
    for (size_t i = 1; status == RT_OK && i < json_array_size(lines); i++) {
        const json_t *line = json_array_get(lines, i);
        if (changed && line_concerns(line, experiment, changed)) continue;
        Reader reader = {path, i + 1, RT_OK, error};
        take_line(&reader, results, line);
        status = reader.status;
    }
    json_decref(changed);
    return status;
}

RtStatus rt_journal_load(const char *path, RtResults *results, const RtSelection *only, RtError *error) {
    json_t *lines;
    RT_TRY(rt_json_lines_load(path, &lines, error));
    RtStatus status = take_lines(path, results, lines, only, error);
    json_decref(lines);
    return status;
}
