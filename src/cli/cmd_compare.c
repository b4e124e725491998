/* SPDX-License-Identifier: Apache-2.0 */
/* raytally compare: what a change made faster or slower, and which counts it changed; from two result
 * directories, or two programs that run in turns. */
#include "cli/cli.h"
#include "cli/recording.h"
#include "experiment/compare.h"
#include "experiment/manifest.h"
#include "experiment/plugins_used.h"
#include "experiment/result_directory.h"
#include "experiment/worker.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Runs of one build, one after the other, differ by less. */
static const double MARGIN_OF_DIRECTORIES = 0.05;

typedef struct Options {
    RtRecordingOptions recording;
    const char *subjects[2]; /* directories; or an experiment or a scene */
    int subject_count;
    const char *with;
    bool worker, quick, strict, json;
    uint32_t rounds;
    double until, patience, margin; /* margin < 0: not given */
    int threads;                    /* -1: one to time, all to count */
    int timing;
} Options;

static void take_subject(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    if (o->subject_count == 2) argp_error(state, "'%s' is one too many", text);
    o->subjects[o->subject_count++] = text;
}

static void take_accel(void *options, const char *text, struct argp_state *state) {
    rt_cli_add_accels(((Options *)options)->recording.experiment, text, state);
}

static void finish(void *options, struct argp_state *state) {
    Options *o = options;
    RtExperiment *e = o->recording.experiment;
    const bool programs = o->with || o->worker;
    if (!programs && o->subject_count != 2)
        argp_error(state, "give two result directories, or --with PROGRAM and an EXPERIMENT or a SCENE");
    if (programs && o->subject_count != 1)
        argp_error(state, "--with takes one EXPERIMENT.yaml, or one SCENE with --accel");
    if (!programs &&
        (e->candidate_count || o->recording.frame || o->recording.kinds || o->until > 0 || o->rounds))
        argp_error(state, "rays, --accel, --rounds and --until need --with PROGRAM: two result directories "
                          "are compared as they are");
    if (programs && !e->candidate_count && (o->recording.frame || o->recording.kinds))
        argp_error(state, "an EXPERIMENT defines its rays; for a SCENE give --accel");
    if (o->threads >= 0) o->timing = o->threads;
    rt_recording_finish(&o->recording, state);
}

static const RtOption options[] = {
    {"with", 0, "PROGRAM", RT_TO_TEXT(with),
     "Another raytally, such as ../old/build/release/raytally, as `before`; this one is `after`"},
    {"accel", 'a', "SPEC", RT_TO_TAKE(take_accel),
     "For a SCENE: an accelerator, or `all` of them; may be repeated"},
    {"strict", 0, NULL, RT_TO_FLAG(strict), "Exit code 1 if anything is slower"},
    {"margin", 0, "P%", RT_TO_PERCENT(margin),
     "Report only differences beyond P % (default: 0 with --with; 5% for directories, which are single "
     "runs)"},
    {"rounds", 0, "N", RT_TO_INTEGER(rounds, 1, RT_MAX_ROUNDS),
     "With --with: at least N rounds, each with both programs restarted (10; more if there are many cells)"},
    {"until", 0, "P%", RT_TO_PERCENT(until),
     "With --with: continue until all intervals are within P % of their medians, for at most 1000 rounds or "
     "--patience seconds"},
    {"patience", 0, "SECONDS", RT_TO_SECONDS(patience, 1, 86400),
     "With --until: at most this many seconds in total (600)"},
    {"quick", 0, NULL, RT_TO_FLAG(quick), "Run the smaller variant of the EXPERIMENT"},
    {"threads", 0, "N", RT_TO_INTEGER(threads, 0, 1024), "Threads, as in `raytally bench`"},
    {"json", 0, NULL, RT_TO_FLAG(json), "One JSON document on stdout instead of the table"},
    {"worker", 0, NULL, RT_TO_HIDDEN_FLAG(worker), NULL}, /* experiment/worker.h */
    {0}};

/* ---- two programs ---- */

/* The experiment of the YAML, or of a scene and accelerators, as `bench` measures them. */
static RtStatus load(Options *o, RtError *error) {
    RtExperiment *e = o->recording.experiment;
    char where[RT_MAX_LABEL];
    if (e->candidate_count == 0) return rt_experiment_load(e, o->subjects[0], o->quick, error);
    strcpy(e->name, "compare");
    RT_TRY(rt_experiment_add_scenes(e, &o->recording.like, o->subjects[0], "", error));
    return rt_experiment_check(e, where, error);
}

static RtStatus work(Options *o, RtError *error) {
    RtWorkloadOptions how = {.threads = o->threads >= 0 ? o->threads : 0, .timing = o->timing};
    RT_TRY(load(o, error));
    return rt_worker_serve(o->recording.experiment, &how, error);
}

static void on_progress(void *context, uint32_t round, uint32_t rounds, const char *scene, const char *kind) {
    const bool *terminal = context;
    if (!*terminal) return;
    fprintf(stderr, "\r\033[Kround %u of %u or more: %s %s", round + 1, rounds, scene, kind);
    fflush(stderr);
}

static void on_notice(void *context, const char *message) {
    const bool *terminal = context;
    fprintf(stderr, "%sraytally: %s\n", *terminal ? "\r\033[K" : "", message);
}

/* A worker gets the same arguments, so it measures the same. */
static RtStatus compare_programs(Options *o, char **argv, RtComparison *comparison, RtError *error) {
    bool terminal = isatty(STDERR_FILENO) == 1;
    RtStatus status = load(o, error); /* reports errors once */
    RtPrograms programs = {.before = o->with,
                           .after = "/proc/self/exe",
                           .arguments = argv + 1,
                           .rounds = o->rounds ? o->rounds : 10,
                           .until = o->until,
                           .patience = o->patience,
                           .least = 1e-3 * o->recording.experiment->milliseconds,
                           .pinned = o->timing == 1,
                           .seed = o->recording.experiment->seed,
                           .context = &terminal,
                           .progress = on_progress,
                           .notice = on_notice};
    if (status == RT_OK) status = rt_compare_programs(&programs, comparison, error);
    if (terminal) fputs("\r\033[K", stderr);
    return status;
}

/* ---- two directories ---- */

static RtStatus compare_plugins(const Options *o, const RtExperiment *experiments, RtComparison *comparison,
                                RtError *error) {
    json_t *used[2] = {NULL, NULL};
    RtStatus status = RT_OK;
    for (int i = 0; i < 2 && status == RT_OK; i++) {
        json_t *manifest;
        status = rt_manifest_read(o->subjects[i], &manifest, error);
        used[i] = rt_plugins_used_then(&experiments[i], manifest);
        json_decref(manifest);
    }
    comparison->plugins = rt_plugins_changed(used[0], used[1]);
    for (int i = 0; i < 2; i++) json_decref(used[i]);
    return status;
}

static RtStatus load_both(const Options *o, RtExperiment *experiments, RtResults *results,
                          RtComparison *comparison, RtError *error) {
    for (int i = 0; i < 2; i++) RT_TRY(rt_run_load(o->subjects[i], &experiments[i], &results[i], error));
    RT_TRY(compare_plugins(o, experiments, comparison, error));
    snprintf(comparison->before, sizeof comparison->before, "%s", o->subjects[0]);
    snprintf(comparison->after, sizeof comparison->after, "%s", o->subjects[1]);
    return rt_compare_results(&results[0], &results[1], comparison, error);
}

static RtStatus compare_directories(const Options *o, RtComparison *comparison, RtError *error) {
    static RtExperiment experiments[2];
    RtResults results[2] = {0};
    RtStatus status = load_both(o, experiments, results, comparison, error);
    for (int i = 0; i < 2; i++) rt_results_clear(&results[i]);
    return status;
}

/* ---- the command ---- */

static RtStatus compare(Options *o, char **argv, RtError *error) {
    RtComparison comparison = {.margin = o->margin >= 0 ? o->margin : o->with ? 0 : MARGIN_OF_DIRECTORIES};
    RtStatus status =
        o->with ? compare_programs(o, argv, &comparison, error) : compare_directories(o, &comparison, error);
    if (status == RT_OK && o->json) rt_cli_print_json(rt_comparison_json(&comparison));
    if (status == RT_OK && !o->json) rt_comparison_print(&comparison, stdout);
    if (status == RT_OK && o->strict && rt_comparison_count(&comparison, RT_CHANGE_SLOWER) > 0) {
        *error = (RtError){RT_MISMATCH, ""};
        status = RT_MISMATCH;
    }
    rt_comparison_clear(&comparison);
    return status;
}

const RtSyntax rt_compare_syntax = {
    .options = options,
    .shared = rt_recording_options,
    .shared_at = offsetof(Options, recording),
    .shared_group = 1,
    .plugins = true,
    .arguments = "BEFORE AFTER\nEXPERIMENT.yaml --with PROGRAM\nSCENE --accel SPEC --with PROGRAM",
    .argument = {.name = "BEFORE", .take = take_subject},
    .finish = finish,
    .help =
        "Report what is faster, slower or no different after a change, and which counts changed: from two "
        "result directories, or by alternating this raytally and another one on the same rays, which "
        "finds much smaller differences.\v"
        "Ratios are of throughput: above 1 means faster now. All intervals hold simultaneously with 95 % "
        "confidence, however many cells there are. Directories are single runs at different times; "
        "--margin allows for their systematic difference. Examples:\n"
        "  raytally compare balls --accel bvh --accel grid --with ../old/build/release/raytally\n"
        "  raytally compare experiments/first-look.yaml --quick --with ../old/build/release/raytally "
        "--until 1%\n"
        "  raytally compare results/last-month results/first-look --strict"};

RtStatus rt_command_compare(int argc, char **argv, RtError *error) {
    Options o = {.threads = -1, .timing = 1, .patience = 600, .margin = -1};
    rt_recording_init(&o.recording);
    rt_cli_parse(&rt_compare_syntax, argc, argv, &o);
    return o.worker ? work(&o, error) : compare(&o, argv, error);
}
