/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/failure.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/versions.h"
#include "core/scene/load.h"
#include "core/text/json.h"
#include "scenes/builtin.h"
#include "scenes/open.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* The accelerators, and memory for the answers. */
typedef struct Session {
    RtAccel *brute, *accel;
    RtQuery truth, query;
    RtArena memory;
    RtHit *expected, *got; /* [count] */
    bool *blocked;         /* [count] */
} Session;

static RtStatus open_session(Session *s, const RtFailure *failure, const RtScene *scene, RtError *error) {
    size_t count = failure->count;
    s->expected = rt_arena_alloc(&s->memory, count, sizeof(RtHit));
    s->got = rt_arena_alloc(&s->memory, count, sizeof(RtHit));
    s->blocked = rt_arena_alloc(&s->memory, count, sizeof(bool));
    RT_TRY(rt_arena_check(&s->memory, "answers", error));
    RT_TRY(rt_accel_open(rt_accel_truth(), scene, &s->brute, error));
    RT_TRY(rt_query_init(&s->truth, s->brute, error));
    rt_nearest(&s->truth, failure->rays, count, s->expected, NULL);
    RT_TRY(rt_accel_open_on(failure->spec, scene, failure->threads, &s->accel, error));
    RT_TRY(rt_accel_learn(s->accel, failure->rays, s->expected, count, error));
    return rt_query_init(&s->query, s->accel, error);
}

static void close_session(Session *s) {
    rt_query_clear(&s->query);
    rt_query_clear(&s->truth);
    rt_accel_destroy(s->accel);
    rt_accel_destroy(s->brute);
    rt_arena_clear(&s->memory);
}

static RtStatus ask(Session *s, const RtFailure *failure, RtAnswer *answer, RtError *error) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0}, *counted = failure->counted ? tallies : NULL;
    for (size_t first = 0; first < failure->count; first += failure->stream) {
        size_t left = failure->count - first, n = left < failure->stream ? left : failure->stream;
        rt_nearest(&s->query, failure->rays + first, n, s->got + first, counted);
        rt_occluded(&s->query, failure->rays + first, n, s->blocked + first, counted);
    }
    const size_t i = failure->asked;
    const RtWrongAnswer asked = {.occluded = failure->occluded,
                                 .ray = failure->rays[i],
                                 .expected = s->expected[i],
                                 .got = s->got[i],
                                 .blocked = s->blocked[i]};
    RtVerdict verdict;
    *answer = (RtAnswer){.expected = s->expected[i], .got = s->got[i], .blocked = s->blocked[i]};
    RT_TRY(rt_answer_verdict(&s->query, &asked, &verdict, error));
    answer->wrong = verdict == RT_WRONG;
    return RT_OK;
}

RtStatus rt_failure_ask(const RtFailure *failure, const RtScene *scene, RtAnswer *answer, RtError *error) {
    Session session = {0};
    RtStatus status = open_session(&session, failure, scene, error);
    if (status == RT_OK) status = ask(&session, failure, answer, error);
    if (status == RT_OK) status = rt_accel_check(session.accel, error);
    close_session(&session);
    return status;
}

RtStatus rt_failure_of(const RtReference *reference, const RtWrongAnswer *wrong, const char *spec,
                       int threads, RtFailure *failure, RtAnswer *answer, RtError *error) {
    *failure = (RtFailure){.spec = spec,
                           .threads = threads,
                           .rays = reference->rays + wrong->index,
                           .count = 1,
                           .stream = 1,
                           .occluded = wrong->occluded,
                           .counted = wrong->counted};
    RT_TRY(rt_failure_ask(failure, reference->scene, answer, error));
    if (answer->wrong) return RT_OK;
    size_t first;
    rt_wrong_answer_context(reference, wrong, &first, &failure->count);
    failure->rays = reference->rays + first;
    failure->asked = wrong->index - first;
    failure->stream = wrong->stream;
    return rt_failure_ask(failure, reference->scene, answer, error);
}

/* ---- recorded answers ---- */

enum { MOST_OBJECTS = 20000 }; /* of a scene that is stored in a file, or copied from instances */

static RtStatus find_near(const RtScene *scene, const RtWrongAnswer *wrong, uint32_t *ids, uint32_t *count,
                          RtError *error) {
    const RtJudge judge = rt_judge(&scene->geometry, &wrong->ray, false);
    for (uint32_t id = 0; id < rt_geometry_id_count(&scene->geometry); id++) {
        RtMargin margin;
        RT_TRY(rt_margin_of(&judge.margin, judge.geometry, id, NAN, &margin, error));
        if (margin.possible || id == wrong->expected.object || id == wrong->got.object) ids[(*count)++] = id;
    }
    return RT_OK;
}

RtStatus rt_near_save(const RtScene *scene, const RtWrongAnswer *wrong, const char *path, uint32_t *count,
                      RtError *error) {
    RT_ARENA(memory);
    RT_OWNED(RtScene, flat, rt_scene_clear);
    RT_OWNED(RtScene, part, rt_scene_clear);
    RtOutput output;
    char says[512];
    const uint32_t all = rt_geometry_id_count(&scene->geometry);
    const bool copied = scene->geometry.instance_count > 0;
    *count = 0;
    if (copied && (all > MOST_OBJECTS || rt_scene_flatten(scene, &flat, NULL) != RT_OK)) return RT_OK;
    uint32_t *ids = rt_arena_alloc(&memory, all, sizeof(uint32_t));
    RT_TRY(rt_arena_check(&memory, "ids of objects", error));
    RT_TRY(find_near(scene, wrong, ids, count, error));
    if (*count == 0) return RT_OK;
    RT_TRY(rt_scene_subset(copied ? &flat : scene, ids, *count, &part, error));
    RT_TRY(rt_output_open(&output, path, error));
    rt_wrong_answer_format(wrong, says, sizeof says);
    fprintf(output.file, "# %s\n# Objects near the ray:", says);
    for (uint32_t i = 0; i < *count; i++) fprintf(output.file, " %" PRIu32, ids[i]);
    fputs("; here they are 0, 1, ...\n", output.file);
    const RtStatus status = rt_yaml_save(&part, output.file, error);
    if (status == RT_OK) return rt_output_commit(&output, error);
    rt_output_discard(&output);
    return status;
}

/* ---- shrinking ---- */

/* The fixed cost of a try, in objects. */
#define TRY_COST 32

typedef struct Shrinking {
    const RtScene *scene;
    const RtFailure *failure;
    RtShrinkTried *tried;
    void *context;
    uint64_t left;  /* remaining budget */
    uint32_t *part; /* [object_count] the objects of the current try */
    RtShrunk *out;
    RtError *error;
} Shrinking;

/* Repeats the query over s->part[0..count); if the answer is still wrong, those objects remain. */
static RtStatus try_part(Shrinking *s, uint32_t count, bool *shrunk) {
    RtScene scene;
    RtAnswer answer = {.wrong = false};
    uint64_t cost = (uint64_t)count + TRY_COST;
    *shrunk = false;
    s->left = cost < s->left ? s->left - cost : 0;
    if (s->left == 0) return RT_OK;
    RT_TRY(rt_scene_subset(s->scene, s->part, count, &scene, s->error));
    RtStatus status = rt_failure_ask(s->failure, &scene, &answer, s->error);
    rt_scene_clear(&scene);
    if (status != RT_OK && status != RT_BAD_INPUT) return status;
    s->out->tries++;
    if (answer.wrong) {
        memcpy(s->out->ids, s->part, count * sizeof *s->part);
        s->out->count = count;
        s->out->answer = answer;
        *shrunk = true;
    }
    if (s->tried) s->tried(s->context, s->out->count, s->out->tries);
    return RT_OK;
}

/* Copies to s->part the remaining objects first..end-1, or all others. */
static uint32_t choose(Shrinking *s, uint32_t first, uint32_t end, bool others) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < s->out->count; i++) {
        if ((i >= first && i < end) != others) s->part[count++] = s->out->ids[i];
    }
    return count;
}

/* Tries each of `pieces` equal pieces of the remaining objects, or the complement of each if `others`. */
static RtStatus try_pieces(Shrinking *s, uint32_t pieces, bool others, bool *shrunk) {
    uint64_t count = s->out->count;
    *shrunk = false;
    for (uint64_t i = 0; i < pieces && !*shrunk && s->left > 0; i++) {
        uint32_t first = (uint32_t)(count * i / pieces), end = (uint32_t)(count * (i + 1) / pieces);
        RT_TRY(try_part(s, choose(s, first, end, others), shrunk));
    }
    return RT_OK;
}

/* Most failures involve just the two objects of the answers. */
static RtStatus try_those_named(Shrinking *s, const RtAnswer *answer) {
    const uint32_t a = answer->expected.object, objects = s->out->count;
    const uint32_t b = s->failure->occluded ? RT_NO_OBJECT : answer->got.object;
    const uint32_t first = a < b ? a : b, second = a < b ? b : a;
    uint32_t count = 0;
    bool shrunk;
    if (first < objects) s->part[count++] = first;
    if (second < objects && second != first) s->part[count++] = second;
    return count > 0 && count < objects ? try_part(s, count, &shrunk) : RT_OK;
}

static RtStatus shrink(Shrinking *s, const RtAnswer *answer) {
    RT_TRY(try_those_named(s, answer));
    uint32_t pieces = 2;
    while (s->out->count > 1 && s->left > 0) {
        bool shrunk;
        if (pieces > s->out->count) pieces = s->out->count;
        RT_TRY(try_pieces(s, pieces, false, &shrunk));
        if (shrunk) {
            pieces = 2;
            continue;
        }
        /* The complement of one half is the other half. */
        if (pieces > 2) RT_TRY(try_pieces(s, pieces, true, &shrunk));
        if (shrunk) {
            pieces = pieces > 3 ? pieces - 1 : 2;
        } else if (pieces == s->out->count) {
            break;
        } else {
            pieces *= 2;
        }
    }
    s->out->minimal = s->left > 0;
    return RT_OK;
}

RtStatus rt_shrink(const RtScene *scene, const RtFailure *failure, const RtAnswer *answer, uint64_t budget,
                   RtShrinkTried *tried, void *context, RtShrunk *out, RtError *error) {
    RT_ARENA(memory);
    uint32_t count = scene->geometry.object_count;
    *out = (RtShrunk){.ids = rt_alloc(count, sizeof(uint32_t)), .count = count, .answer = *answer};
    Shrinking s = {.scene = scene,
                   .failure = failure,
                   .tried = tried,
                   .context = context,
                   .left = budget,
                   .part = rt_arena_alloc(&memory, count, sizeof(uint32_t)),
                   .out = out,
                   .error = error};
    RtStatus status =
        out->ids && s.part ? RT_OK : rt_fail_memory(error, "ids of objects", count * sizeof(uint32_t));
    for (uint32_t i = 0; i < count && status == RT_OK; i++) out->ids[i] = i;
    if (status == RT_OK) status = shrink(&s, answer);
    if (status == RT_OK) return RT_OK;
    rt_free(out->ids);
    out->ids = NULL;
    return status;
}

/* ---- replay files: to JSON ---- */

enum {
    MOST_BYTES = 1 << 30, /* of a replay file */
    NUMBERS = 8           /* of a ray: org, dir, tmin, tmax */
};

static json_t *float_json(float x) {
    char text[32];
    snprintf(text, sizeof text, "%a", (double)x);
    return json_string(text);
}

static json_t *ray_json(const RtRay *ray) {
    const float numbers[NUMBERS] = {ray->org.x, ray->org.y, ray->org.z, ray->dir.x,
                                    ray->dir.y, ray->dir.z, ray->tmin,  ray->tmax};
    json_t *list = json_array();
    for (int i = 0; i < NUMBERS; i++) json_array_append_new(list, float_json(numbers[i]));
    return json_pack("{s:s, s:I, s:o}", "kind", rt_ray_kind_name((RtRayKind)ray->kind), "source",
                     (json_int_t)ray->source, "org_dir_tmin_tmax", list);
}

static json_t *hit_json(RtHit hit) {
    if (hit.object == RT_NO_OBJECT) return json_null();
    return json_pack("{s:I, s:o}", "object", (json_int_t)hit.object, "t", float_json(hit.t));
}

static json_t *got_json(const RtFailure *failure, const RtAnswer *answer) {
    return failure->occluded ? json_boolean(answer->blocked) : hit_json(answer->got);
}

/* The scene as YAML, or NULL if memory is short. */
static json_t *yaml_json(const RtScene *scene) {
    RtMemoryFile text;
    RtError error;
    json_t *json = NULL;
    if (rt_memory_file_open(&text, &error) != RT_OK) return NULL;
    RtStatus saved = rt_yaml_save(scene, text.file, &error);
    RtStatus closed = rt_memory_file_close(&text, "a scene", &error);
    if (saved == RT_OK && closed == RT_OK) json = json_stringn(text.data, text.size);
    rt_free(text.data);
    return json;
}

static json_t *shrunk_json(const RtReplayRecord *r, RtError *error) {
    const RtShrunk *shrunk = r->shrunk;
    RtScene part;
    if (rt_scene_subset(r->scene, shrunk->ids, shrunk->count, &part, error) != RT_OK) return NULL;
    json_t *ids = json_array();
    for (uint32_t i = 0; i < shrunk->count; i++) json_array_append_new(ids, json_integer(shrunk->ids[i]));
    json_t *object = json_pack("{s:o, s:b, s:o, s:o, s:o}", "objects", ids, "minimal", shrunk->minimal,
                               "expected", hit_json(shrunk->answer.expected), "got",
                               got_json(r->failure, &shrunk->answer), "yaml", yaml_json(&part));
    rt_scene_clear(&part);
    return object;
}

static json_t *record_json(const RtReplayRecord *r, RtError *error) {
    const RtFailure *q = r->failure;
    json_t *rays = json_array();
    for (size_t i = 0; i < q->count; i++) json_array_append_new(rays, ray_json(&q->rays[i]));
    const RtGeometry *g = &r->scene->geometry;
    bool whole = !rt_builtin_find(r->scene_spec) && g->object_count <= MOST_OBJECTS && g->instance_count == 0;
    return json_pack(
        "{s:i, s:s, s:o, s:o, s:[I, I], s:s, s:s, s:s, s:I, s:I, s:o, s:o, s:o, s:o}", "format",
        RT_FILE_FORMAT, "scene", r->scene_spec, "fingerprint", rt_json_hex(rt_scene_fingerprint(r->scene)),
        "yaml", whole ? yaml_json(r->scene) : json_null(), "sampling", (json_int_t)r->scene->sampling.columns,
        (json_int_t)r->scene->sampling.rows, "accel", q->spec, "query", q->occluded ? "occluded" : "nearest",
        "kernel", q->counted ? "counted" : "timed", "stream", (json_int_t)q->stream, "asked",
        (json_int_t)q->asked, "rays", rays, "expected", hit_json(r->answer->expected), "got",
        got_json(q, r->answer), "shrunk", r->shrunk ? shrunk_json(r, error) : json_null());
}

RtStatus rt_replay_save(const char *path, const RtReplayRecord *record, RtError *error) {
    return rt_json_save(path, record_json(record, error), error);
}

/* ---- replay files: from JSON ---- */

static bool get_float(const json_t *list, size_t i, float *out) {
    const char *text = json_string_value(json_array_get(list, i));
    char *end = NULL;
    if (!text) return false;
    *out = strtof(text, &end);
    return end != text && *end == '\0';
}

static bool get_count(const json_t *object, const char *key, uint64_t most, uint64_t *out) {
    const json_t *value = json_object_get(object, key);
    *out = (uint64_t)json_integer_value(value);
    return json_is_integer(value) && json_integer_value(value) >= 0 && *out <= most;
}

static bool get_word(const json_t *object, const char *key, const char *no, const char *yes, bool *out) {
    const char *word = json_string_value(json_object_get(object, key));
    *out = word && strcmp(word, yes) == 0;
    return word && (*out || strcmp(word, no) == 0);
}

static bool get_ray(const json_t *object, RtRay *ray) {
    const json_t *list = json_object_get(object, "org_dir_tmin_tmax");
    const char *kind_name = json_string_value(json_object_get(object, "kind"));
    RtRayKind kind;
    float x[NUMBERS];
    uint64_t source;
    for (size_t i = 0; i < NUMBERS; i++) {
        if (!get_float(list, i, &x[i])) return false;
    }
    if (!kind_name || rt_ray_kind_parse(kind_name, &kind, NULL) != RT_OK) return false;
    if (!get_count(object, "source", UINT32_MAX, &source)) return false;
    *ray = (RtRay){.org = {{x[0], x[1], x[2]}},
                   .dir = {{x[3], x[4], x[5]}},
                   .tmin = x[6],
                   .tmax = x[7],
                   .kind = (uint32_t)kind,
                   .source = (uint32_t)source};
    return rt_ray_is_valid(ray);
}

/* All members but the rays; returns the name of the first that is wrong, or NULL. */
static const char *take_members(RtReplay *r) {
    const json_t *d = r->document, *sampling = json_object_get(d, "sampling");
    RtFailure *q = &r->failure;
    uint64_t stream, asked;
    const char *hex = json_string_value(json_object_get(d, "fingerprint"));
    r->scene_spec = json_string_value(json_object_get(d, "scene"));
    q->spec = json_string_value(json_object_get(d, "accel"));
    r->yaml = json_string_value(json_object_get(d, "yaml"));
    r->shrunk_yaml = json_string_value(json_object_get(json_object_get(d, "shrunk"), "yaml"));
    r->columns = (uint32_t)json_integer_value(json_array_get(sampling, 0));
    r->rows = (uint32_t)json_integer_value(json_array_get(sampling, 1));
    q->count = json_array_size(json_object_get(d, "rays"));
    if (!r->scene_spec) return "scene";
    if (!q->spec) return "accel";
    if (!hex || sscanf(hex, "%" SCNx64, &r->fingerprint) != 1) return "fingerprint";
    if (json_array_size(sampling) != 2) return "sampling";
    if (!get_word(d, "query", "nearest", "occluded", &q->occluded)) return "query";
    if (!get_word(d, "kernel", "timed", "counted", &q->counted)) return "kernel";
    if (!get_count(d, "stream", UINT32_MAX, &stream) || stream == 0) return "stream";
    if (q->count == 0) return "rays";
    if (!get_count(d, "asked", q->count - 1, &asked)) return "asked";
    q->stream = stream;
    q->asked = asked;
    return NULL;
}

static RtStatus take(RtReplay *r, const char *path, RtError *error) {
    const char *wrong = take_members(r);
    size_t count = r->failure.count;
    if (!wrong && !(r->failure.rays = r->rays = rt_alloc(count, sizeof(RtRay))))
        return rt_fail_memory(error, "rays", count * sizeof(RtRay));
    for (size_t i = 0; !wrong && i < count; i++) {
        if (!get_ray(json_array_get(json_object_get(r->document, "rays"), i), &r->rays[i])) wrong = "rays";
    }
    if (!wrong) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: this is not a replay file: '%s' is missing or invalid", path,
                   wrong);
}

RtStatus rt_replay_load(RtReplay *replay, const char *path, RtError *error) {
    *replay = (RtReplay){0};
    char *text;
    size_t size;
    json_error_t at;
    RT_TRY(rt_file_read(path, MOST_BYTES, &text, &size, error));
    replay->document = json_loadb(text, size, 0, &at);
    rt_free(text);
    if (!replay->document) {
        return rt_fail_at(error, path, (size_t)(at.line > 0 ? at.line : 0), 0, "this is not JSON: %s",
                          at.text);
    }
    RtStatus status = rt_json_check_format(replay->document, path, error);
    if (status == RT_OK) status = take(replay, path, error);
    if (status != RT_OK) rt_replay_clear(replay);
    return status;
}

void rt_replay_clear(RtReplay *replay) {
    rt_free(replay->rays);
    json_decref(replay->document);
    *replay = (RtReplay){0};
}

/* ---- replay files: repeating the query ---- */

static RtStatus open_text(const char *text, RtScene *scene, RtError *error) {
    rt_scene_init(scene);
    RtStatus status = rt_yaml_load_text("the scene of the replay file", text, rt_builtin_open, scene, error);
    if (status == RT_OK) status = rt_scene_finish(scene, error);
    if (status != RT_OK) rt_scene_clear(scene);
    return status;
}

static RtStatus open_scene(const RtReplay *r, bool shrunk, RtScene *scene, RtError *error) {
    if (shrunk && !r->shrunk_yaml) return rt_fail(error, RT_NOT_AVAILABLE, "the scene was not reduced");
    if (shrunk) return open_text(r->shrunk_yaml, scene, error);
    RT_TRY(r->yaml ? open_text(r->yaml, scene, error) : rt_scene_open(r->scene_spec, scene, error));
    if (rt_scene_fingerprint(scene) == r->fingerprint) return RT_OK;
    rt_scene_clear(scene);
    return rt_fail(error, RT_BAD_INPUT, "%s has changed since the replay file was written", r->scene_spec);
}

RtStatus rt_replay_ask(const RtReplay *replay, bool shrunk, RtAnswer *answer, RtError *error) {
    RtScene scene;
    RT_TRY(open_scene(replay, shrunk, &scene, error));
    RtStatus status = rt_scene_sample(&scene, replay->columns, replay->rows, 1, false, error);
    if (status == RT_OK) status = rt_failure_ask(&replay->failure, &scene, answer, error);
    rt_scene_clear(&scene);
    return status;
}
