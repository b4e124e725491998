/* SPDX-License-Identifier: Apache-2.0 */
#include "run/merge.h"

#include "core/base/words.h"
#include "core/text/json.h"
#include "experiment/plugins_used.h"
#include "measure/machine.h"
#include "results/journal.h"
#include "results/result_directory.h"

#include <string.h>

/* ---- the shards ---- */

typedef struct Merge {
    const char *const *directories;
    uint32_t count;
    json_t *journals[RT_MAX_SHARDS];
} Merge;

static const json_t *header_of(const Merge *merge, uint32_t i) {
    return json_array_get(merge->journals[i], 0);
}

static uint32_t number_of(const Merge *merge, uint32_t i, const char *key) {
    return (uint32_t)json_integer_value(json_object_get(header_of(merge, i), key));
}

static RtStatus load_journals(Merge *merge, RtError *error) {
    for (uint32_t i = 0; i < merge->count; i++) {
        char path[RT_MAX_PATH];
        json_t *manifest;
        RT_TRY(rt_path_join(merge->directories[i], RT_RUN_JOURNAL, path, error));
        if (!rt_file_exists(path)) {
            return rt_fail(error, RT_BAD_INPUT, "%s is not the directory of a run: it has no %s",
                           merge->directories[i], RT_RUN_JOURNAL);
        }
        if (rt_manifest_read(merge->directories[i], &manifest, NULL) != RT_OK) {
            return rt_fail(error, RT_BAD_INPUT,
                           "%s is not finished: finish it with raytally run ... --resume",
                           merge->directories[i]);
        }
        json_decref(manifest);
        RT_TRY(rt_json_lines_load(path, &merge->journals[i], error));
        if (number_of(merge, i, "shards") > 0) continue;
        return rt_fail(error, RT_BAD_INPUT, "%s is not a shard: it was not run with --shard",
                       merge->directories[i]);
    }
    return RT_OK;
}

static RtStatus check_alike(const Merge *merge, RtError *error) {
    static const char *const keys[] = {"hash", "quick", "build", "shards"};
    static const char *const what[] = {"experiments, or versions of one", "variants (--quick)",
                                       "builds of raytally", "numbers of shards"};
    for (uint32_t i = 1; i < merge->count; i++) {
        for (int k = 0; k < 4; k++) {
            const json_t *a = json_object_get(header_of(merge, 0), keys[k]);
            const json_t *b = json_object_get(header_of(merge, i), keys[k]);
            if (json_equal(a, b)) continue;
            return rt_fail(error, RT_BAD_INPUT, "%s and %s have different %s", merge->directories[0],
                           merge->directories[i], what[k]);
        }
    }
    const char *build = rt_json_text(header_of(merge, 0), "build", "unknown");
    if (strcmp(build, rt_build_alone()) == 0) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s was measured by another build of raytally (%s; this is %s): merge with that one",
                   merge->directories[0], build, rt_build_alone());
}

/* The number of threads that timed the shards, 1 if nothing was timed. It must be the same for all: times on
 * one thread are processor times, times on several are wall times. */
static RtStatus check_threads(const Merge *merge, int *threads, RtError *error) {
    uint32_t first = merge->count;
    *threads = 1;
    for (uint32_t i = 0; i < merge->count; i++) {
        for (size_t line = 1; line < json_array_size(merge->journals[i]); line++) {
            const json_t *timed = json_object_get(json_array_get(merge->journals[i], line), "timed");
            int here = (int)json_integer_value(json_object_get(timed, "threads"));
            if (!timed || (first < merge->count && here == *threads)) continue;
            if (first < merge->count) {
                return rt_fail(error, RT_BAD_INPUT,
                               "%s was timed on %d thread%s, and %s on %d: their times are not comparable. "
                               "Run one of them again with the --threads of the other, and --force",
                               merge->directories[first], *threads, rt_plural((uint64_t)*threads),
                               merge->directories[i], here);
            }
            first = i;
            *threads = here;
        }
    }
    return RT_OK;
}

/* The shards must have used the plugins that are loaded here, which the manifest will name. */
static RtStatus check_plugins(const Merge *merge, const RtExperiment *experiment, RtError *error) {
    RtStatus status = RT_OK;
    for (uint32_t i = 0; i < merge->count && status == RT_OK; i++) {
        json_t *changed =
            rt_plugins_changed_since(json_object_get(header_of(merge, i), "plugins"), experiment);
        const char *name = json_object_iter_key(json_object_iter(changed));
        char sentence[RT_MAX_PLUGIN_CHANGE];
        if (name) {
            rt_plugins_change_format(name, json_object_get(changed, name), "there", "here", sentence);
            status = rt_fail(error, RT_BAD_INPUT, "%s: %s: load that one", merge->directories[i], sentence);
        }
        json_decref(changed);
    }
    return status;
}

static RtStatus check_whole(const Merge *merge, RtError *error) {
    uint32_t shards = number_of(merge, 0, "shards");
    for (uint32_t shard = 1; shard <= shards; shard++) {
        uint32_t found = merge->count;
        for (uint32_t i = 0; i < merge->count; i++) {
            if (number_of(merge, i, "shard") != shard) continue;
            if (found < merge->count) {
                return rt_fail(error, RT_BAD_INPUT, "shard %u of %u is given twice: %s and %s", shard, shards,
                               merge->directories[found], merge->directories[i]);
            }
            found = i;
        }
        if (found == merge->count)
            return rt_fail(error, RT_BAD_INPUT, "shard %u of %u is missing", shard, shards);
    }
    return RT_OK;
}

/* Loads the experiment, which must not have changed. */
static RtStatus load_experiment(const Merge *merge, RtExperiment *experiment, RtError *error) {
    RtStatus status = rt_manifest_experiment(merge->directories[0], true, experiment, error);
    if (status != RT_MISMATCH) return status;
    return rt_fail(error, RT_BAD_INPUT, "%s has changed since the shards were made from it",
                   experiment->path);
}

/* ---- the joined directory ---- */

/* All lines, shard by shard, after a header without a shard. */
static RtStatus add_journal(const Merge *merge, const RtExperiment *experiment, const char *directory,
                            RtOutputs *files, RtError *error) {
    static const RtSelection all = {0};
    char path[RT_MAX_PATH];
    RT_TRY(rt_path_join(directory, RT_RUN_JOURNAL, path, error));
    json_t *lines = json_array();
    for (uint32_t i = 0; i < merge->count; i++) {
        for (size_t line = 1; line < json_array_size(merge->journals[i]); line++) {
            json_t *object = json_array_get(merge->journals[i], line);
            if (json_is_object(object)) json_array_append(lines, object);
        }
    }
    RtStatus status = rt_journal_add(files, path, experiment, &all, lines, error);
    json_decref(lines);
    return status;
}

/* For RtRunJoin. */
static RtStatus add_files(const void *context, const RtExperiment *experiment, const char *directory,
                          RtOutputs *files, RtError *error) {
    const Merge *merge = context;
    for (uint32_t i = 0; i < merge->count; i++) {
        for (uint32_t t = 0; t < experiment->workload_count; t++) {
            char from[RT_MAX_PATH], to[RT_MAX_PATH];
            RT_TRY(rt_results_image_path(merge->directories[i], experiment, t, from, error));
            RT_TRY(rt_results_image_path(directory, experiment, t, to, error));
            if (rt_file_exists(from)) RT_TRY(rt_outputs_copy(files, from, to, error));
        }
    }
    return add_journal(merge, experiment, directory, files, error);
}

static RtStatus merge_all(Merge *merge, RtRunOptions options, RtExperiment *experiment, RtResults *results,
                          RtError *error) {
    const RtRunJoin join = {.shards = merge->count, .context = merge, .add = add_files};
    options.join = &join;
    RT_TRY(load_journals(merge, error));
    RT_TRY(check_alike(merge, error));
    RT_TRY(check_whole(merge, error));
    RT_TRY(check_threads(merge, &options.workload.timing, error));
    RT_TRY(load_experiment(merge, experiment, error));
    RT_TRY(check_plugins(merge, experiment, error));
    RT_TRY(rt_results_init(results, experiment, error));
    return rt_run_experiment(results, &options, error);
}

RtStatus rt_merge(const char *const *directories, uint32_t count, const RtRunOptions *options,
                  RtExperiment *experiment, RtResults *results, RtError *error) {
    Merge merge = {.directories = directories, .count = count};
    *results = (RtResults){0};
    RtStatus status = merge_all(&merge, *options, experiment, results, error);
    for (uint32_t i = 0; i < count; i++) json_decref(merge.journals[i]);
    return status;
}
