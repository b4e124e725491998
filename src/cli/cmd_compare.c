/* SPDX-License-Identifier: Apache-2.0 */
/* raytally compare: what a change made faster or slower, and which counts it changed; from two result
 * directories, or two programs that run in turns. */
#include "cli/cli.h"
#include "cli/experiment_options.h"
#include "compare/compare.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "experiment/plugins_used.h"
#include "run/callgrind.h"
#include "run/worker.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* If one accelerator of four changes, the median of all moves by less. */
static const double MARGIN_OF_DIRECTORIES = 0.02;

enum { MAX_SUBJECTS = 64 };

typedef struct Options {
    RtExperimentOptions shared;
    const char *subjects[MAX_SUBJECTS]; /* directories; or an experiment or a scene */
    uint32_t subject_count;
    const char *with;
    bool worker, quick, strict, json;
    uint32_t rounds;
    double until, patience, margin; /* margin < 0: not given */
    int threads;                    /* -1: one to time, all to count */
    int timing;
} Options;

static void finish(void *options, struct argp_state *state) {
    Options *o = options;
    RtExperiment *e = &o->shared.experiment;
    const bool programs = o->with || o->worker;
    if (!programs && (o->subject_count == 0 || o->subject_count % 2 != 0))
        argp_error(state, "give two result directories, or pairs of them, BEFORE AFTER BEFORE AFTER; or "
                          "--with PROGRAM and an EXPERIMENT or a SCENE");
    if (programs && o->subject_count != 1)
        argp_error(state, "--with takes one EXPERIMENT.yaml, or one SCENE with --accel");
    if (!programs && (e->candidate_count || o->shared.frame || o->shared.kinds || o->until > 0 || o->rounds ||
                      o->shared.callgrind))
        argp_error(state, "rays, --accel, --rounds, --until and --callgrind need --with PROGRAM: result "
                          "directories are compared as they are");
    if (o->shared.callgrind && !e->candidate_count)
        argp_error(state, "--callgrind takes a SCENE with --accel, as `bench` does, and no EXPERIMENT");
    if (programs && !e->candidate_count && (o->shared.frame || o->shared.kinds))
        argp_error(state, "an EXPERIMENT defines its rays; for a SCENE give --accel");
    if (o->threads >= 0) o->timing = o->threads;
    rt_experiment_options_finish(&o->shared, state);
}

static const RtOption options[] = {
    {"with", 0, "PROGRAM", RT_TO_TEXT(with),
     "Another raytally, such as ../old/build/release/raytally, as `before`; this one is `after`"},
    {"accel", 'a', "SPEC", RT_TO_TAKE(rt_take_accel),
     "For a SCENE: an accelerator, or `all` of them; may be repeated"},
    {"strict", 0, NULL, RT_TO_FLAG(strict), "Exit code 1 if anything is slower"},
    {"margin", 0, "P%", RT_TO_PERCENT(margin),
     "Report only differences beyond P % (default: 0 with --with; 2% for directories)"},
    {"rounds", 0, "N", RT_TO_INTEGER(rounds, 1, RT_MAX_ROUNDS),
     "With --with: at least N rounds, each with both programs restarted (10; more if there are many cells)"},
    {"until", 0, "P%", RT_TO_PERCENT(until),
     "With --with: continue until all intervals are within P % of their medians, for at most 1000 rounds or "
     "--patience seconds"},
    {"patience", 0, "SECONDS", RT_TO_SECONDS(patience, 1, 86400),
     "With --until: at most this many seconds in total (600)"},
    {"callgrind", 0, "N", RT_TO_TAKE_OPTIONAL(rt_take_callgrind),
     "With --with and a SCENE: also compare instructions per ray of both programs, on N rays of each kind "
     "(4096), as `bench --callgrind` does. Equal counts mean that code only moved"},
    {"quick", 0, NULL, RT_TO_FLAG(quick), "Run the smaller variant of the EXPERIMENT"},
    {"threads", 0, "N", RT_TO_INTEGER(threads, 0, 1024), "Threads, as in `raytally bench`"},
    RT_LIMIT_OPTIONS,
    {"json", 0, NULL, RT_TO_FLAG(json), "One JSON document on stdout instead of the table"},
    {"worker", 0, NULL, RT_TO_HIDDEN_FLAG(worker), NULL}, /* run/worker.h */
    {0}};

/* ---- two programs ---- */

/* The experiment of the YAML, or of a scene and accelerators, as `bench` measures them. */
static RtStatus load(Options *o, RtError *error) {
    RtExperiment *e = &o->shared.experiment;
    char where[RT_MAX_LABEL];
    if (e->candidate_count == 0) return rt_experiment_load(e, o->subjects[0], o->quick, NULL, error);
    strcpy(e->name, "compare");
    RT_TRY(rt_experiment_add_scenes(e, &o->shared.like, o->subjects[0], "", error));
    return rt_experiment_check(e, where, error);
}

static void on_progress(void *context, uint32_t round, uint32_t rounds, const char *scene, const char *kind) {
    (void)context;
    if (!isatty(STDERR_FILENO)) return;
    fprintf(stderr, "\r\033[Kround %u of %u or more: %s %s", round + 1, rounds, scene, kind);
    fflush(stderr);
}

/* The arguments of argv without some options, in a new array of the arena, NULL behind the last. The names of
 * those that have a value, which may be the next argument, end in '='. */
static char **arguments_without(const char *const *left_out, char **argv, RtArena *arena) {
    int count = 0, used = 0;
    while (argv[count]) count++;
    char **arguments = rt_arena_alloc(arena, (size_t)count + 1, sizeof(char *));
    for (int i = 1; arguments && i < count; i++) {
        const char *name = strncmp(argv[i], "--", 2) == 0 ? argv[i] + 2 : "";
        const size_t length = strcspn(name, "="); /* argp takes any unique beginning of a name */
        const char *const *out = left_out;
        while (*out && (length == 0 || strncmp(name, *out, length) != 0)) out++;
        if (!*out) arguments[used++] = argv[i];
        if (*out && strchr(*out, '=') && name[length] != '=') i++;
    }
    return arguments;
}

/* A worker gets the same arguments, so it measures the same; older ones do not know these. */
static RtStatus compare_programs(Options *o, char **argv, RtComparison *comparison, RtError *error) {
    static const char *const left_out[] = {"callgrind", "memory=", "time=", NULL};
    RT_ARENA(arena);
    RT_TRY(load(o, error)); /* reports errors once */
    if (*o->shared.experiment.warning.message) rt_progress_notice(NULL, o->shared.experiment.warning.message);
    RtPrograms programs = {.before = o->with,
                           .after = "/proc/self/exe",
                           .arguments = arguments_without(left_out, argv, &arena),
                           .rounds = o->rounds ? o->rounds : 10,
                           .until = o->until,
                           .patience = o->patience,
                           .least = 1e-3 * o->shared.experiment.milliseconds,
                           .pinned = o->timing == 1,
                           .seed = o->shared.experiment.seed,
                           .progress = on_progress,
                           .notice = rt_progress_notice};
    RT_TRY(rt_arena_check(&arena, "arguments", error));
    RtStatus status = rt_compare_programs(&programs, comparison, error);
    rt_progress_clear();
    return status;
}

/* ---- instructions ---- */

static RtStatus compare_instructions(const Options *o, char **argv, RtComparison *comparison,
                                     RtError *error) {
    /* `bench` lacks them, or its --memory is for each accelerator. */
    static const char *const left_out[] = {"with=", "margin=", "strict", "quick", "memory=", "time=", NULL};
    RT_ARENA(arena);
    char **arguments = arguments_without(left_out, argv, &arena);
    RT_TRY(rt_arena_check(&arena, "arguments", error));
    rt_progress_notice(NULL, "counting instructions under valgrind, which takes a while");
    return rt_compare_instructions(&o->shared.experiment, o->shared.callgrind, o->with, arguments, comparison,
                                   error);
}

/* ---- directories ---- */

static RtStatus compare_plugins(const char *const *directories, const RtExperiment *experiments,
                                RtComparison *comparison, RtError *error) {
    json_t *used[2] = {NULL, NULL};
    RtStatus status = RT_OK;
    for (int i = 0; i < 2 && status == RT_OK; i++) {
        json_t *manifest;
        status = rt_manifest_read(directories[i], &manifest, error);
        used[i] = rt_plugins_used_then(&experiments[i], manifest);
        json_decref(manifest);
    }
    json_t *changed = rt_plugins_changed(used[0], used[1]);
    if (!comparison->plugins) comparison->plugins = json_object();
    json_object_update(comparison->plugins, changed);
    json_decref(changed);
    for (int i = 0; i < 2; i++) json_decref(used[i]);
    return status;
}

/* A run that one side has twice would count as two that agree. */
static RtStatus check_given_once(const Options *o, RtError *error) {
    char one[PATH_MAX], other[PATH_MAX];
    for (uint32_t i = 0; i < o->subject_count; i++) {
        for (uint32_t k = i % 2; k < i; k += 2) {
            if (!realpath(o->subjects[i], one) || !realpath(o->subjects[k], other)) continue;
            if (strcmp(one, other) == 0)
                return rt_fail(error, RT_BAD_INPUT,
                               "%s is given twice %s: each pair takes two runs of its own", o->subjects[i],
                               i % 2 ? "as AFTER" : "as BEFORE");
        }
    }
    return RT_OK;
}

static RtStatus compare_loaded(const Options *o, RtExperiment *experiments, RtResults *results,
                               RtComparison *comparison, RtError *error) {
    const char *names[2][MAX_SUBJECTS / 2];
    const uint32_t pairs = o->subject_count / 2;
    RT_TRY(check_given_once(o, error));
    for (uint32_t i = 0; i < o->subject_count; i++) {
        RT_TRY(rt_results_load(o->subjects[i], &experiments[i], &results[i], error));
        names[i % 2][i / 2] = o->subjects[i];
    }
    for (size_t p = 0; p < pairs; p++)
        RT_TRY(compare_plugins(&o->subjects[2 * p], &experiments[2 * p], comparison, error));
    rt_join_names(names[0], pairs, comparison->before, sizeof comparison->before);
    rt_join_names(names[1], pairs, comparison->after, sizeof comparison->after);
    return rt_compare_results(results, pairs, comparison, error);
}

static RtStatus compare_directories(const Options *o, RtComparison *comparison, RtError *error) {
    static RtResults results[MAX_SUBJECTS]; /* megabytes */
    RT_ARENA(arena);
    RtExperiment *experiments = rt_arena_alloc(&arena, o->subject_count, sizeof(RtExperiment));
    RT_TRY(rt_arena_check(&arena, "experiments", error));
    RtStatus status = compare_loaded(o, experiments, results, comparison, error);
    for (uint32_t i = 0; i < o->subject_count; i++) rt_results_clear(&results[i]);
    return status;
}

/* ---- the command ---- */

static RtStatus compare(Options *o, char **argv, RtError *error) {
    RT_OWNED(RtComparison, comparison, rt_comparison_clear);
    comparison.margin = o->margin >= 0 ? o->margin : o->with ? 0 : MARGIN_OF_DIRECTORIES;
    if (o->shared.callgrind) RT_TRY(rt_callgrind_check(error));
    RT_TRY(o->with ? compare_programs(o, argv, &comparison, error)
                   : compare_directories(o, &comparison, error));
    if (o->shared.callgrind) RT_TRY(compare_instructions(o, argv, &comparison, error));
    if (o->json)
        rt_cli_print_json(rt_comparison_json(&comparison));
    else
        rt_comparison_print(&comparison, stdout);
    if (!o->strict || rt_comparison_count(&comparison, RT_CHANGE_SLOWER) == 0) return RT_OK;
    *error = (RtError){RT_MISMATCH, ""};
    return RT_MISMATCH;
}

const RtSyntax rt_compare_syntax = {
    .options = options,
    .shared = rt_experiment_options,
    .shared_at = offsetof(Options, shared),
    .shared_group = 1,
    .plugins = true,
    .arguments =
        "BEFORE AFTER [BEFORE AFTER]...\nEXPERIMENT.yaml --with PROGRAM\nSCENE --accel SPEC --with PROGRAM",
    .argument = {.name = "BEFORE", .value = RT_TO_LIST(subjects, subject_count)},
    .finish = finish,
    .help =
        "Report what is faster, slower or no different after a change, and which counts changed: from two "
        "result directories, or by alternating this raytally and another one on the same rays, which "
        "finds much smaller differences.\v"
        "Ratios are of throughput: above 1 means faster now. All intervals hold simultaneously with 95 % "
        "confidence, however many cells there are. Directories are single runs at different times, so "
        "verdicts are on accelerators, over several scenes or pairs of runs, relative to the median "
        "accelerator. Examples:\n"
        "  raytally compare balls --accel bvh --accel grid \\\n"
        "    --with ../old/build/release/raytally\n"
        "  raytally compare experiments/first-look.yaml --quick \\\n"
        "    --with ../old/build/release/raytally --until 1%\n"
        "  raytally compare balls --accel bvh --callgrind \\\n"
        "    --with ../old/build/release/raytally\n"
        "  raytally compare results/last-month results/first-look --strict"};

RtStatus rt_command_compare(int argc, char **argv, RtError *error) {
    static Options o;
    o.threads = -1;
    o.margin = -1;
    o.timing = 1;
    o.patience = 600;
    rt_experiment_options_init(&o.shared);
    rt_cli_parse(&rt_compare_syntax, argc, argv, &o);
    if (!o.worker) return compare(&o, argv, error);
    const RtWorkloadOptions how = {.threads = o.threads >= 0 ? o.threads : 0, .timing = o.timing};
    RT_TRY(load(&o, error));
    return rt_worker_serve(&o.shared.experiment, &how, error);
}
