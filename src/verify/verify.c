/* SPDX-License-Identifier: Apache-2.0 */
#include "verify/verify.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/versions.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "measure/machine.h"
#include "measure/measure.h"
#include "scenes/open.h"
#include "verify/verify_table.h"

#include <inttypes.h>
#include <string.h>
#include <xxhash.h>

#define FAILURES "verify-failures" /* default folder */

/* If everything fails, the same fault is not shrunk again and again, unless that is asked for. */
enum { MOST_SHRUNK = 8 };

typedef struct Run {
    const RtVerify *verify;
    const RtVerifyObserver *observer;
    RtVerifyProgress progress;
    RtLock lock;
    RtScene *scenes; /* [scene_count], each open until its turn is over */
    RtHit *recorded; /* [verify->rays.count] hits of the recorded spec, or NULL */
    json_t *header;  /* must be equal when a run is resumed */
    json_t *known;   /* the journal, or NULL */
    size_t next_known;
    json_t *rows;
    RtJsonLines journal;
    /* Of the current scene, by RtAccel.absolute; rays is UINT64_MAX where not yet counted. */
    RtCertain certain[2];
    bool skipped_inexact;
    RtError unsaved; /* why the replay file of the row could not be written, or empty */
} Run;

static void doing(Run *run, const char *what) {
    run->progress.what = what;
    run->observer->doing(run->observer->context, &run->progress);
}

/* ---- the journal ---- */

/* All scenes are opened first: a missing one should not stop a long run halfway. */
static RtStatus open_scenes(Run *run, RtError *error) {
    const RtVerify *v = run->verify;
    run->scenes = rt_alloc(v->scene_count, sizeof(RtScene));
    if (!run->scenes) return rt_fail_memory(error, "scenes", v->scene_count * sizeof(RtScene));
    for (uint32_t i = 0; i < v->scene_count; i++) {
        RT_TRY(rt_scene_open(v->scenes[i], &run->scenes[i], error));
        rt_warnings_tell(&run->scenes[i].warnings, run->observer->notice, run->observer->context);
    }
    return RT_OK;
}

static RtStatus load_recorded(Run *run, RtError *error) {
    const RtVerify *v = run->verify;
    for (uint32_t i = 0; i < v->spec_count; i++) {
        if (!v->specs[i].recorded) continue;
        RT_TRY(rt_hits_load(v->specs[i].spec, v->rays.count, rt_geometry_id_count(&run->scenes[0].geometry),
                            &run->recorded, error));
        for (uint64_t k = 0; k < v->rays.count; k++) {
            if (run->recorded[k].object != RT_UNNAMED_OBJECT) continue;
            run->observer->notice(run->observer->context,
                                  "the hits name no objects: they are judged by t alone");
            break;
        }
    }
    return RT_OK;
}

static json_t *header_json(const Run *run) {
    const RtVerify *v = run->verify;
    json_t *scenes = json_array(), *fingerprints = json_array(), *specs = json_array();
    for (uint32_t i = 0; i < v->scene_count; i++) {
        json_array_append_new(scenes, json_string(v->scenes[i]));
        json_array_append_new(fingerprints, rt_json_hex(rt_scene_fingerprint(&run->scenes[i])));
    }
    for (uint32_t i = 0; i < v->spec_count; i++) {
        json_array_append_new(specs, json_string(v->specs[i].spec));
    }
    json_t *given = v->rays.given ? rt_json_hex(v->rays.given->fingerprint) : json_null();
    json_t *hits =
        run->recorded ? rt_json_hex(XXH3_64bits(run->recorded, v->rays.count * sizeof(RtHit))) : json_null();
    return json_pack("{s:i, s:s, s:o, s:o, s:o, s:I, s:o, s:o, s:I, s:I}", "format", RT_FILE_FORMAT, "build",
                     rt_build_identity(), "scenes", scenes, "fingerprints", fingerprints, "accels", specs,
                     "rays", (json_int_t)v->rays.count, "rays_hash", given, "hits_hash", hits, "seed",
                     (json_int_t)v->rays.seed, "shrink", (json_int_t)v->shrink);
}

/* Records what was verified, and with what, in the folder's manifest.json. */
static RtStatus write_manifest(const Run *run, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(rt_path_join(run->verify->folder, RT_MANIFEST, path, error));
    json_t *manifest = json_copy(run->header);
    json_object_set_new(manifest, "date", rt_json_now());
    json_object_set_new(manifest, "machine", rt_machine_json());
    return rt_json_save(path, manifest, error);
}

static RtStatus load_known(Run *run, const char *path, RtError *error) {
    const char *key;
    json_t *value;
    RT_TRY(rt_json_lines_load(path, &run->known, error));
    run->next_known = 1;
    json_object_foreach(run->header, key, value) {
        if (json_equal(json_object_get(json_array_get(run->known, 0), key), value)) continue;
        return rt_fail(error, RT_BAD_INPUT,
                       "%s: this journal belongs to another verification, with different %s (see its first "
                       "line): start over and lose it with --force, or choose another --out",
                       path, key);
    }
    return RT_OK;
}

/* Locks the folder and examines its content, as soon as it exists. */
static RtStatus take_folder(Run *run, bool *resumed, RtError *error) {
    const char *folder = run->verify->folder;
    if (!folder || rt_lock_is_held(&run->lock)) return RT_OK;
    RT_TRY(rt_lock_take(&run->lock, folder, error));
    return rt_result_files_look(folder, RT_VERIFY_JOURNAL, run->verify->start, resumed, error);
}

static RtStatus open_journal(Run *run, bool resumed, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(rt_path_join(run->verify->folder, RT_VERIFY_JOURNAL, path, error));
    if (resumed) RT_TRY(load_known(run, path, error));
    if (!resumed) RT_TRY(rt_result_files_remove(run->verify->folder, RT_VERIFY_JOURNAL, error));
    return rt_json_lines_open(&run->journal, path, resumed ? NULL : run->header, error);
}

/* Nothing of an earlier run is touched before the journal. */
static RtStatus begin(Run *run, RtError *error) {
    bool resumed = false;
    RT_TRY(take_folder(run, &resumed, error));
    RT_TRY(open_scenes(run, error));
    RT_TRY(load_recorded(run, error));
    run->header = header_json(run);
    if (!run->header) return rt_fail_memory(error, "what is verified", 0);
    if (!run->verify->folder) return RT_OK;
    RT_TRY(rt_directory_create(run->verify->folder, error));
    RT_TRY(take_folder(run, &resumed, error));
    rt_outputs_remove_left(run->verify->folder);
    return open_journal(run, resumed, error);
}

static bool is_text(const json_t *row, const char *key, const char *text) {
    return strcmp(rt_json_text(row, key, ""), text) == 0;
}

/* The row of an earlier run, borrowed, or NULL. The journal has its rows in the order of the requests, so
 * the next one is this one or there is none. */
static json_t *known_row(Run *run, const char *scene, const char *spec) {
    json_t *row;
    while (json_is_null(row = json_array_get(run->known, run->next_known))) run->next_known++;
    if (!is_text(row, "scene", scene) || !is_text(row, "accel", spec)) return NULL;
    run->next_known++;
    return row;
}

/* Takes the reference. A row is shown even if it cannot be written. */
static RtStatus add_row(Run *run, json_t *row, RtError *error) {
    if (!row || json_array_append_new(run->rows, row) != 0) return rt_fail_memory(error, "a row", 0);
    run->observer->row(run->observer->context, row);
    if (*run->unsaved.message) run->observer->notice(run->observer->context, run->unsaved.message);
    *run->unsaved.message = '\0';
    return run->journal.file ? rt_json_lines_write(&run->journal, json_incref(row), error) : RT_OK;
}

/* ---- a wrong answer ---- */

static void on_tried(void *context, uint32_t left, uint32_t tries) {
    char what[64];
    snprintf(what, sizeof what, "reducing a scene: %u object%s left, try %u", left, rt_plural(left), tries);
    doing(context, what);
}

/* Makes the folder for FOLDER/NUMBER-SCENE-SPEC.ENDING; writes this name to path[0..RT_MAX_PATH). */
static RtStatus name_failure(const Run *run, const char *scene, const char *spec, const char *ending,
                             char *path, RtError *error) {
    const char *folder = run->verify->folder ? run->verify->folder : FAILURES;
    char text[160], name[sizeof text];
    snprintf(text, sizeof text, "%04zu-%.60s-%.50s.%s", json_array_size(run->rows) + 1, scene, spec, ending);
    rt_file_name(text, name, sizeof name);
    RT_TRY(rt_directory_create(folder, error));
    return rt_path_join(folder, name, path, error);
}

/* `path`: NULL if there is no file; `left`: the objects in it. */
static void add_file(json_t *row, const char *path, json_t *left, bool shrunk) {
    json_t *first = json_object_get(row, "first_wrong");
    json_object_set_new(first, "replay", path ? json_string(path) : json_null());
    json_object_set_new(first, "objects_left", left);
    json_object_set_new(first, "shrunk", json_boolean(shrunk));
}

/* The budget for shrinking a failure: by default half that of the one before, so that all take some seconds.
 * 0 if enough of this accelerator, or of all, have been shrunk. It depends on the rows alone, so that resumed
 * runs agree. */
static uint64_t shrink_budget(const Run *run, const char *spec) {
    const uint32_t most = run->verify->shrink > 0 ? run->verify->shrink : 1;
    size_t i, shrunk = 0, of_spec = 0;
    json_t *row;
    json_array_foreach(run->rows, i, row) {
        if (!json_is_true(json_object_get(json_object_get(row, "first_wrong"), "shrunk"))) continue;
        of_spec += is_text(row, "accel", spec);
        shrunk++;
    }
    if (of_spec >= most) return 0;
    if (most > 1) return RT_SHRINK_BUDGET;
    return shrunk < MOST_SHRUNK ? RT_SHRINK_BUDGET >> shrunk : 0;
}

/* Shrinks the failure within its budget, writes a replay file, and adds its name to the row: null if it
 * cannot be written. */
static RtStatus keep_failure(Run *run, const RtVerifyScene *scene, const RtVerifySpec *spec,
                             const RtWrongAnswer *wrong, json_t *row, RtError *error) {
    RtFailure failure;
    RtAnswer answer;
    RtShrunk shrunk = {.count = rt_geometry_id_count(&scene->scene.geometry)};
    const bool whole = scene->scene.geometry.instance_count > 0; /* objects of parts cannot be left out */
    uint64_t budget = whole ? 0 : shrink_budget(run, spec->spec);
    char path[RT_MAX_PATH];
    RT_TRY(rt_failure_of(&scene->reference, wrong, spec->spec, run->verify->rays.threads, &failure, &answer,
                         error));
    RtReplayRecord record = {scene->name, &scene->scene, &failure, &answer, NULL};
    if (answer.wrong && budget > 0) {
        RT_TRY(rt_shrink(&scene->scene, &failure, &answer, budget, on_tried, run, &shrunk, error));
        record.shrunk = &shrunk;
    }
    const bool saved = name_failure(run, scene->name, spec->spec, "json", path, &run->unsaved) == RT_OK &&
                       rt_replay_save(path, &record, &run->unsaved) == RT_OK;
    add_file(row, saved ? path : NULL, answer.wrong ? json_integer(shrunk.count) : json_null(),
             record.shrunk != NULL);
    rt_free(shrunk.ids);
    return RT_OK;
}

/* The same for a recorded answer: the objects near its ray. */
static void keep_near(Run *run, const RtVerifyScene *scene, const RtVerifySpec *spec,
                      const RtWrongAnswer *wrong, json_t *row) {
    char path[RT_MAX_PATH];
    uint32_t count = 0;
    const bool saved = name_failure(run, scene->name, spec->spec, "yaml", path, &run->unsaved) == RT_OK &&
                       rt_near_save(&scene->scene, wrong, path, &count, &run->unsaved) == RT_OK;
    add_file(row, saved && count > 0 ? path : NULL, json_integer(count), true);
}

/* ---- a row ---- */

/* Adds the number of certain rays to the row of answers that are not exact. With too few, `problem` says so,
 * unless it is already known. */
static RtStatus add_certain(Run *run, const RtVerifyScene *scene, bool absolute, json_t *row, char *problem,
                            size_t size, RtError *error) {
    const RtVerifyRays *rays = &run->verify->rays;
    RtCertain *certain = &run->certain[absolute];
    if (certain->rays == UINT64_MAX)
        RT_TRY(rt_reference_certain(&scene->reference, absolute, rays->threads, certain, error));
    json_object_set_new(row, "certain", json_integer((json_int_t)certain->certain));
    json_object_set_new(row, "must_hit", json_integer((json_int_t)certain->must_hit));
    json_object_set_new(row, "certain_of", json_integer((json_int_t)certain->rays));
    if (!*problem && !rt_certain_suffices(certain, rays->count, rays->given))
        rt_certain_undecided(certain, rays->count, rays->given, absolute, problem, size);
    return RT_OK;
}

/* The row of a result; accel NULL: of recorded answers. problem[0..sizeof error->message) is what is wrong
 * beside answers, or "". */
static RtStatus add_result(Run *run, const RtVerifyScene *scene, const RtVerifySpec *spec,
                           const RtAccel *accel, const RtEquivalence *result, char *problem, RtError *error) {
    const bool exact = accel && accel->exact;
    const RtWrongAnswer *wrong = &result->first_wrong;
    RtStatus status = RT_OK;
    json_t *row = rt_equivalence_json(result, scene->name, spec->spec, rt_accel_truth());
    json_object_set_new(row, "exact", json_boolean(exact));
    json_object_set_new(row, "refused", json_null());
    if (!accel) json_object_set_new(row, "occluded_wrong", json_null()); /* nothing is known */
    if (!exact)
        status =
            add_certain(run, scene, accel && accel->absolute, row, problem, sizeof error->message, error);
    json_object_set_new(row, "problem", *problem ? json_string(problem) : json_null());
    if (status == RT_OK && result->any_wrong && !accel) keep_near(run, scene, spec, wrong, row);
    if (status == RT_OK && result->any_wrong && accel)
        status = keep_failure(run, scene, spec, wrong, row, error);
    if (status == RT_OK) return add_row(run, row, error);
    json_decref(row);
    return status;
}

/* A broken structure is a problem, like a wrong answer; rays are traced through it all the same. */
static RtStatus check(Run *run, const RtVerifyScene *scene, RtAccel *accel, const RtVerifySpec *spec,
                      RtError *error) {
    char problem[sizeof error->message] = "";
    RtEquivalence result;
    RtStatus status = rt_accel_validate(accel, error);
    if (status == RT_MISMATCH) {
        memcpy(problem, error->message, sizeof problem);
    } else {
        RT_TRY(status);
    }
    RT_TRY(rt_equivalence_check(&scene->reference, accel, run->verify->rays.threads, &result, error));
    return add_result(run, scene, spec, accel, &result, problem, error);
}

static RtStatus judge_recorded(Run *run, const RtVerifyScene *scene, const RtVerifySpec *spec,
                               RtError *error) {
    char problem[sizeof error->message] = "";
    RtEquivalence result;
    RT_TRY(rt_equivalence_judge(&scene->reference, run->recorded, run->verify->rays.threads, &result, error));
    return add_result(run, scene, spec, NULL, &result, problem, error);
}

/* A plugin's accelerator broke before it answered all rays, or an accelerator refuses the scene: a row
 * without rays, with the reason. */
static RtStatus add_unanswered(Run *run, const RtVerifyScene *scene, const RtVerifySpec *spec, bool refused,
                               const char *why, RtError *error) {
    const RtEquivalence nothing = {0};
    json_t *row = rt_equivalence_json(&nothing, scene->name, spec->spec, rt_accel_truth());
    json_object_set_new(row, "exact", json_true());
    json_object_set_new(row, "problem", refused ? json_null() : json_string(why));
    json_object_set_new(row, "refused", refused ? json_string(why) : json_null());
    return add_row(run, row, error);
}

/* Said once. */
static void skip_inexact(Run *run, const char *spec) {
    char notice[RT_MAX_SPEC_CHARS + 128];
    snprintf(notice, sizeof notice,
             "%s has its own arithmetic, so it is not among `all`: name it to judge its answers", spec);
    if (!run->skipped_inexact) run->observer->notice(run->observer->context, notice);
    run->skipped_inexact = true;
}

static RtStatus verify_spec(Run *run, const RtVerifyScene *scene, const RtVerifySpec *spec, RtError *error) {
    RtAccel *accel = NULL;
    doing(run, spec->spec);
    if (spec->recorded) return judge_recorded(run, scene, spec, error);
    rt_memory_limit(run->verify->memory);
    RtStatus status = rt_memory_unlimit(
        rt_accel_open_on(spec->spec, &scene->scene, run->verify->rays.threads, &accel, error), error);
    if (status == RT_NOT_AVAILABLE && !spec->named) {
        char notice[sizeof error->message + RT_MAX_SPEC_CHARS + RT_MAX_SCENE_NAME];
        snprintf(notice, sizeof notice, "%s on %s is skipped: %s", spec->spec, scene->name, error->message);
        run->observer->notice(run->observer->context, notice);
        return RT_OK;
    }
    const bool refused = rt_accel_refuses(status);
    /* Only its own row fails. */
    const bool unbuilt = refused || (status != RT_OK && rt_spec_text_is_remote(spec->spec));
    if (status == RT_OK && !accel->exact && !spec->judged)
        skip_inexact(run, spec->spec);
    else if (status == RT_OK)
        status = check(run, scene, accel, spec, error);
    rt_accel_destroy(accel);
    if (status != RT_BROKEN && !unbuilt) return status;
    const RtError why = *error;
    return add_unanswered(run, scene, spec, refused, why.message, error);
}

/* ---- a scene ---- */

static RtStatus prepare_scene(Run *run, uint32_t i, RtVerifyScene *scene, RtError *error) {
    const RtVerify *v = run->verify;
    doing(run, "recording rays");
    RT_TRY(rt_verify_scene_init(scene, &run->scenes[i], &v->rays, error));
    doing(run, "answering them by brute force");
    scene->name = v->scenes[i];
    run->certain[0].rays = run->certain[1].rays = UINT64_MAX;
    return rt_reference_init(&scene->reference, scene->truth, scene->rays, v->rays.count, v->rays.threads,
                             error);
}

static RtStatus save_differing(const Run *run, const RtReference *reference, RtError *error) {
    const char *path = run->verify->differing_rays;
    char notice[RT_MAX_PATH + 64];
    RT_OWNED(RtRaySet, set, rt_rayset_clear);
    RT_TRY(rt_rayset_init(&set, RT_RAY_RANDOM, reference->count, error));
    set.count = 0;
    for (size_t i = 0; i < reference->count; i++) {
        if (reference->differs[i]) set.rays[set.count++] = reference->rays[i];
    }
    RT_TRY(rt_rays_save(&set, path, error));
    snprintf(notice, sizeof notice, "wrote %s: %" PRIu64 " ray%s that differ%s by more than a tie", path,
             set.count, rt_plural(set.count), set.count == 1 ? "s" : "");
    run->observer->notice(run->observer->context, notice);
    return RT_OK;
}

static RtStatus verify_scene(Run *run, uint32_t index, RtError *error) {
    const RtVerify *v = run->verify;
    const char *name = v->scenes[index];
    RtVerifyScene scene = {.truth = NULL};
    RtStatus status = RT_OK;
    for (uint32_t i = 0; i < v->spec_count && status == RT_OK; i++) {
        json_t *known = known_row(run, name, v->specs[i].spec);
        if (known) {
            json_array_append(run->rows, known);
            run->observer->row(run->observer->context, known);
            run->progress.all -= v->rays.count;
            continue;
        }
        if (!scene.reference.hits) status = prepare_scene(run, index, &scene, error);
        if (status == RT_OK) status = verify_spec(run, &scene, &v->specs[i], error);
        run->progress.done += v->rays.count;
    }
    if (status == RT_OK && v->differing_rays) status = save_differing(run, &scene.reference, error);
    rt_verify_scene_clear(&scene);
    rt_scene_clear(&run->scenes[index]);
    return status;
}

/* ---- the whole ---- */

RtStatus rt_verify_run(const RtVerify *verify, const RtVerifyObserver *observer, json_t **rows,
                       RtError *error) {
    Run run = {.verify = verify, .observer = observer, .lock = RT_NO_LOCK, .rows = json_array()};
    run.progress.all = (uint64_t)verify->scene_count * verify->spec_count * verify->rays.count;
    RtStatus status = begin(&run, error);
    for (uint32_t i = 0; i < verify->scene_count && status == RT_OK; i++) {
        run.progress.scene = i;
        status = verify_scene(&run, i, error);
    }
    if (status == RT_OK && verify->folder) status = rt_verify_write(run.rows, verify->folder, error);
    if (status == RT_OK && verify->folder) status = write_manifest(&run, error);
    rt_json_lines_close(&run.journal);
    for (uint32_t i = 0; run.scenes && i < verify->scene_count; i++) rt_scene_clear(&run.scenes[i]);
    rt_free(run.scenes);
    rt_free(run.recorded);
    rt_lock_release(&run.lock);
    json_decref(run.known);
    json_decref(run.header);
    *rows = run.rows;
    return status;
}

/* ---- the spread ---- */

/* Appends the trial's values except that of `param`, then param=value. */
static void add_values(const RtAccelOps *ops, const RtParam *param, const char *value, char *out) {
    const size_t name = strlen(param->name);
    char separator = ':';
    const char *each = ops->trial ? strchr(ops->trial, ':') : NULL;
    for (; each; each = strchr(each, ',')) {
        each++;
        if (strncmp(each, param->name, name) == 0 && each[name] == '=') continue;
        rt_append_text(out, RT_MAX_SPEC_CHARS, "%c%.*s", separator, (int)strcspn(each, ","), each);
        separator = ',';
    }
    rt_append_text(out, RT_MAX_SPEC_CHARS, "%c%s=%s", separator, param->name, value);
}

/* The `n`th test value over all parameters that is not a default. */
static bool try_value(const RtAccelOps *ops, size_t n, const RtParam **param, char *value, size_t size) {
    for (size_t i = 0; i < ops->param_count; i++) {
        *param = &ops->params[i];
        for (size_t k = 0; rt_param_try(*param, k, value, size); k++) {
            if (strcmp(value, (*param)->default_text) != 0 && n-- == 0) return true;
        }
    }
    return false;
}

bool rt_spread_spec(const RtAccelOps *ops, size_t n, char *out) {
    const RtParam *param;
    char value[RT_MAX_SPEC_CHARS / 2];
    size_t whole = ops->trial ? 2 : 1; /* specs that do not vary a parameter */
    snprintf(out, RT_MAX_SPEC_CHARS, "%s", n == 1 && ops->trial ? ops->trial : ops->name);
    if (n >= whole) {
        if (!try_value(ops, n - whole, &param, value, sizeof value)) return false;
        add_values(ops, param, value, out);
    }
    if (ops->kinds) rt_append_text(out, RT_MAX_SPEC_CHARS, "+%s", rt_accel_default());
    return true;
}

bool rt_trial_spec(const char *spec, char *out) {
    RtSpec parsed;
    RtError error;
    bool any = false;
    out[0] = '\0';
    if (strchr(spec, ':') || rt_spec_parse(spec, &parsed, &error) != RT_OK) return false;
    for (uint32_t i = 0; i < parsed.layer_count; i++) {
        const RtAccelOps *ops = parsed.layers[i].ops;
        rt_append_text(out, RT_MAX_SPEC_CHARS, "%s%s", i ? "+" : "", ops->trial ? ops->trial : ops->name);
        any |= ops->trial != NULL;
    }
    return any;
}
