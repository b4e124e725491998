/* SPDX-License-Identifier: Apache-2.0 */
#include "results/journal.h"

#include "core/base/versions.h"
#include "core/text/json.h"
#include "experiment/plugins_used.h"
#include "measure/machine.h"
#include "results/claims_changed.h"
#include "results/journal_lines.h"

#include <string.h>

static json_t *header_json(const RtExperiment *experiment, const RtSelection *only) {
    return json_pack("{s:i, s:s, s:o, s:b, s:s, s:i, s:i, s:o, s:o}", "format", RT_FILE_FORMAT, "experiment",
                     experiment->name, "hash", rt_json_hex(experiment->fingerprint), "quick",
                     experiment->quick, "build", rt_build_alone(), "shard", (int)only->shard, "shards",
                     (int)only->shards, "plugins", rt_plugins_used(experiment), "claims",
                     rt_claims_json(experiment));
}

/* ---- writing ---- */

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
    json_t *kept = json_array(), *line, *header = header_json(experiment, only);
    size_t i;
    json_t *first = json_object_get(json_array_get(lines, 0), "claims");
    if (first) json_object_set(header, "claims", first); /* those with which the run began */
    json_array_append_new(kept, header);
    json_array_foreach((json_t *)lines, i, line) {
        if (i > 0 && json_is_object(line) && !rt_journal_line_concerns(line, experiment, changed))
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

/* ---- reading ---- */

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
    bool baseline = false;
    for (uint32_t i = 0; i < experiment->baseline_count; i++)
        baseline |= rt_plugins_concern(changed, experiment, experiment->baseline + i);
    if (!baseline) return RT_OK;
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
        if (changed && rt_journal_line_concerns(line, experiment, changed)) continue;
        RtRecordReader reader = {path, i + 1, RT_OK, error};
        rt_journal_line_take(&reader, results, line);
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
