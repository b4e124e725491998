/* SPDX-License-Identifier: Apache-2.0 */
/* raytally bench: one scene, a few accelerators, counted and timed at once. It is an experiment of one
 * workload that leaves no directory behind. */
#include "cli/bench_output.h"
#include "cli/cli.h"
#include "cli/plugins.h"
#include "cli/progress.h"
#include "cli/recording.h"
#include "core/base/memory.h"
#include "experiment/callgrind.h"
#include "verify/spread.h"

#include <argp.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

enum {
    OPT_ROUNDS = 256,
    OPT_BASELINE,
    OPT_THREADS,
    OPT_COUNT_ONLY,
    OPT_DISTRIBUTION,
    OPT_HARDWARE,
    OPT_CALLGRIND,
    OPT_CALLGRIND_CHILD,
    OPT_CSV,
    OPT_JSON,
    OPT_RAY_STRIDE,
    OPT_RAYS_FROM,
    OPT_HITS,
    OPT_COUNTS,
    OPT_UNTIL,
    OPT_PATIENCE
};

typedef struct Options {
    RtRecordingOptions recording;
    const char *scene, *baseline, *csv;
    RtWorkloadOptions workload;
    bool json;
    uint64_t callgrind; /* rays of a kind at most; 0: it is not asked for */
    const char *child;  /* of it: the folder that it serves */
    char *const *argv;  /* all arguments, NULL behind the last */
} Options;

static const struct argp_option options[] = {
    {"accel", 'a', "SPEC", 0,
     "An accelerator, NAME[:KEY=VALUE,...]; once per accelerator. `all`: every one, at "
     "its defaults. A VALUE may be a list, 1|4|16, or a range, 1..9+2 (in steps of 2) or 1..64*2 (each twice "
     "the one before): then it is an accelerator for each, of several such VALUEs each with each",
     0},
    {"ray-stride", OPT_RAY_STRIDE, "K", 0,
     "Measure the preceding --accel on every Kth ray only, for slow ones", 0},
    {"baseline", OPT_BASELINE, "SPEC", 0,
     "The accelerator that ratios refer to (the first that is not a plugin's); or NAME:best, the fastest of "
     "several settings for "
     "each "
     "kind, as in embree:best (`raytally accels NAME`)",
     0},
    {"rounds", OPT_ROUNDS, "N", 0,
     "Timing rounds, each in an order drawn anew (10); at least 6 for intervals of 95 %", 0},
    RT_UNTIL_OPTIONS(OPT_UNTIL, OPT_PATIENCE),
    {"threads", OPT_THREADS, "N", 0,
     "Threads, 0 for all processors. Left out: timing on one, by its processor time, and building and "
     "counting on all; on several, wall time is compared",
     0},
    {"count-only", OPT_COUNT_ONLY, 0, 0, "Count, do not time", 0},
    {"distribution", OPT_DISTRIBUTION, 0, 0,
     "Also show how object tests and steps are distributed over the rays, each asked by itself, and objects "
     "and "
     "depths over the leaves: medians, 99th percentiles, maxima. A mean hides the rays that cost a hundred "
     "times "
     "as much. With --json all percentiles and the histograms. An experiment has `distributions: yes`",
     0},
    {"hardware", OPT_HARDWARE, 0, 0,
     "Also show what the machine did for a ray, by the processor's counters: instructions, cycles, misses of "
     "the "
     "last cache, mispredicted branches. In rounds of their own, so that times do not change; not in the "
     "kernel. Where the machine or the kernel gives none, why. An experiment has `hardware: yes`",
     0},
    {"callgrind", OPT_CALLGRIND, "N", OPTION_ARG_OPTIONAL,
     "Also show instructions per ray, by valgrind's callgrind: exact, and the same on every run, also where "
     "--hardware "
     "has nothing. Builds each accelerator again under valgrind, where building takes many times as long, "
     "and "
     "asks it "
     "N of the rays of each kind (4096). Without AVX-512, which valgrind does not know",
     0},
    {"callgrind-child", OPT_CALLGRIND_CHILD, "DIR", OPTION_HIDDEN, NULL, 0}, /* experiment/callgrind.h */
    {"csv", OPT_CSV, "FILE", 0,
     "Also write a row per cell to FILE, in the columns of times.csv; with "
     "--count-only of counts.csv",
     0},
    {"hits", OPT_HITS, "FILE.npy", 0,
     "Also write what each ray met, for NumPy, a row per ray: t and object (inf and -1 for a miss); of "
     "shadow and "
     "occlusion rays whether anything lies on them. With one --accel and one kind of --rays",
     0},
    {"counts", OPT_COUNTS, "FILE.npy", 0,
     "Also write what each ray cost, a row per ray and a field per counter, each ray asked by itself: where "
     "rays "
     "share visits (wide) rows sum to more than the table shows",
     0},
    {"json", OPT_JSON, 0, 0, "One JSON document on stdout instead of the table", 0},
    {"rays-from", OPT_RAYS_FROM, "FILE.npy", 0,
     "Measure with the rays of FILE, an array of float32 of shape (N, 8) as `raytally rays` writes it, in "
     "place of "
     "recorded ones; --rays says what they ask for: nearest, or occlusion (any hit)",
     2},
    {0}};

/* ---- options ---- */

/* All that the spec stands for. */
static void add_accel(RtExperiment *experiment, const char *text, struct argp_state *state) {
    RtError error;
    RtCandidate like = {.entry = experiment->candidate_count, .ray_stride = 1};
    if (strlen(text) >= RT_MAX_SPEC_CHARS) {
        argp_error(state, "--accel: a spec has at most %d characters", RT_MAX_SPEC_CHARS - 1);
    }
    strcpy(like.spec, text);
    if (rt_experiment_add_accels(experiment, &like, &error) != RT_OK)
        argp_error(state, "--accel: %s", error.message);
}

void rt_cli_add_accels(RtExperiment *experiment, const char *text, struct argp_state *state) {
    if (strcmp(text, "all") != 0) {
        add_accel(experiment, text, state);
        return;
    }
    for (size_t i = 0; i < rt_accel_count(); i++) {
        char spec[RT_MAX_SPEC_CHARS];
        rt_spread_spec(rt_accel_at(i), 0, spec);
        add_accel(experiment, spec, state);
    }
}

/* Of all that the preceding --accel stands for. */
static void set_ray_stride(RtExperiment *experiment, uint64_t stride) {
    uint32_t last = experiment->candidate_count - 1, entry = experiment->candidates[last].entry;
    for (uint32_t c = 0; c <= last; c++) {
        if (experiment->candidates[c].entry == entry) experiment->candidates[c].ray_stride = stride;
    }
}

/* One that was not given is added. */
static void set_baseline(RtExperiment *experiment, const char *text, struct argp_state *state) {
    RtError error;
    uint32_t c = 0;
    while (c < experiment->candidate_count && strcmp(experiment->candidates[c].spec, text) != 0) c++;
    experiment->baseline = c;
    if (c < experiment->candidate_count) return;
    if (!rt_best_is(text)) {
        add_accel(experiment, text, state);
    } else if (rt_experiment_set_baseline(experiment, text, &error) != RT_OK) {
        argp_error(state, "--baseline: %s", error.message);
    }
}

/* Rows of rays belong to one accelerator and one kind, and no file is written over another. */
static void check_rows(const Options *o, struct argp_state *state) {
    const RtExperiment *e = o->recording.experiment;
    const char *const files[] = {o->workload.hits, o->workload.counts, o->csv,
                                 *e->rays_from ? e->rays_from : NULL};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < i; k++) {
            if (files[i] && files[k] && strcmp(files[i], files[k]) == 0)
                argp_error(state, "'%s' is named twice: each file needs a name of its own", files[i]);
        }
    }
    if (!o->workload.hits && !o->workload.counts) return;
    if (e->candidate_count != 1 || e->candidates[0].ray_stride != 1) {
        argp_error(state,
                   "--hits and --counts are of one accelerator: give one --accel, and no --ray-stride or "
                   "other --baseline");
    }
    if (e->kind_count != 1) argp_error(state, "--hits and --counts are of one kind of rays: --rays KIND");
}

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    Options *o = state->input;
    RtExperiment *e = o->recording.experiment;
    switch (key) {
    case ARGP_KEY_INIT: state->child_inputs[0] = &o->recording; return 0;
    case 'a': rt_cli_add_accels(e, argument, state); return 0;
    case OPT_RAY_STRIDE:
        if (!e->candidate_count) argp_error(state, "--ray-stride comes after the --accel that it applies to");
        set_ray_stride(
            e, (uint64_t)rt_cli_integer(state, "--ray-stride", argument, 1, (int64_t)RT_MAX_RAYS_A_KIND));
        return 0;
    case OPT_BASELINE: o->baseline = argument; return 0;
    case OPT_ROUNDS:
        e->rounds = (uint32_t)rt_cli_integer(state, "--rounds", argument, 1, RT_MAX_ROUNDS);
        return 0;
    case OPT_THREADS:
        o->workload.threads = o->workload.timing = (int)rt_cli_integer(state, "--threads", argument, 0, 1024);
        return 0;
    case OPT_RAYS_FROM:
        if (strlen(argument) >= RT_MAX_PATH) argp_error(state, "--rays-from: the path is too long");
        strcpy(e->rays_from, argument);
        return 0;
    case OPT_HITS: o->workload.hits = argument; return 0;
    case OPT_COUNTS: o->workload.counts = argument; return 0;
    case OPT_UNTIL: o->workload.until = rt_cli_percent(state, "--until", argument); return 0;
    case OPT_PATIENCE:
        o->workload.patience = (double)rt_cli_integer(state, "--patience", argument, 1, 86400);
        return 0;
    case OPT_COUNT_ONLY: o->workload.count_only = true; return 0;
    case OPT_HARDWARE: e->hardware = true; return 0;
    case OPT_CALLGRIND:
        o->callgrind = argument ? (uint64_t)rt_cli_integer(state, "--callgrind", argument, 1, 100000000)
                                : RT_CALLGRIND_RAYS;
        return 0;
    case OPT_CALLGRIND_CHILD: o->child = argument; return 0;
    case OPT_DISTRIBUTION: e->distributions = true; return 0;
    case OPT_CSV: o->csv = argument; return 0;
    case OPT_JSON: o->json = true; return 0;
    case ARGP_KEY_ARG:
        if (o->scene) argp_error(state, "one SCENE at a time; '%s' is a second one", argument);
        o->scene = argument;
        return 0;
    case ARGP_KEY_END:
        if (!o->scene)
            argp_error(state, "a SCENE is missing: a file, or a built-in as `raytally scenes` lists");
        if (!e->candidate_count) argp_error(state, "an accelerator is missing: --accel SPEC, or --accel all");
        if (o->baseline) set_baseline(e, o->baseline, state);
        if (!o->baseline) rt_experiment_set_baseline(e, NULL, NULL);
        if (o->workload.until > 0 && e->rounds < RT_FULL_ROUNDS) e->rounds = RT_FULL_ROUNDS;
        if (e->hardware && o->workload.count_only)
            argp_error(state,
                       "--hardware counts while rays are traced for their time: not with --count-only");
        rt_recording_finish(&o->recording, state);
        check_rows(o, state);
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

/* ---- instructions ---- */

static RtStatus save_rays(void *context, uint32_t workload, const RtRaySet *set, const RtAccel *exact,
                          RtError *error) {
    return rt_callgrind_save_rays(context, workload, set, exact, error);
}

/* The child is asked for by the same arguments, so that it has the same accelerators on the same scenes. */
static RtStatus count_instructions(RtCallgrind *callgrind, char *const *argv, RtError *error) {
    char command[] = "bench", child[RT_MAX_PATH + 32];
    size_t count = 0;
    snprintf(child, sizeof child, "--callgrind-child=%s", callgrind->folder);
    while (argv[count]) count++;
    char **arguments = rt_alloc(count + 2, sizeof(char *));
    if (!arguments) return rt_fail_memory(error, "arguments", 0);
    arguments[0] = command;
    arguments[1] = child;
    for (size_t i = 1; i < count; i++) arguments[i + 1] = argv[i];
    RtStatus status = rt_callgrind_run(callgrind, arguments, error);
    rt_free(arguments);
    return status;
}

/* What a plugin prints does not go between the rows that are printed for raytally. */
static RtStatus serve_callgrind(const Options *o, RtError *error) {
    int rows = dup(STDOUT_FILENO);
    FILE *out = rows >= 0 ? fdopen(rows, "w") : NULL;
    if (!out) return rt_fail(error, RT_IO, "stdout: %s", strerror(errno));
    dup2(STDERR_FILENO, STDOUT_FILENO);
    RtStatus status = rt_callgrind_serve(o->recording.experiment, o->child, out, error);
    fclose(out);
    return status;
}

/* ---- the command ---- */

/* Everything but the report. */
static RtStatus measure(Options *o, RtResults *results, RtCallgrind *callgrind, RtError *error) {
    const RtExperiment *experiment = o->recording.experiment;
    if (o->callgrind) {
        RT_TRY(rt_callgrind_check(error));
        RT_TRY(rt_callgrind_init(callgrind, experiment, o->callgrind, error));
        o->workload.rays = save_rays;
        o->workload.rays_context = callgrind;
    }
    RtProgress progress = rt_progress_begin(&o->workload);
    o->workload.observer = rt_progress_observer(&progress);
    RtStatus status = RT_OK;
    for (uint32_t t = 0; status == RT_OK && t < experiment->workload_count; t++)
        status = rt_workload_run(results, t, &o->workload, error);
    if (status == RT_OK && o->callgrind)
        o->workload.observer.notice(&progress,
                                    "instructions are counted under valgrind, which takes a while");
    rt_progress_end(&progress);
    if (status == RT_OK && o->callgrind) status = rt_callgrind_save_broken(callgrind, results, error);
    if (status == RT_OK && o->callgrind) status = count_instructions(callgrind, o->argv, error);
    return status;
}

static RtStatus bench(Options *o, RtError *error) {
    char where[RT_MAX_LABEL];
    RtExperiment *experiment = o->recording.experiment;
    RT_TRY(rt_experiment_add_scenes(experiment, &o->recording.like, o->scene, "", error));
    if (experiment->workload_count > 1 && (o->workload.hits || o->workload.counts))
        return rt_fail(error, RT_BAD_INPUT, "--hits and --counts are of one scene: '%s' is %u", o->scene,
                       experiment->workload_count);
    strcpy(experiment->name, "bench");
    RT_TRY(rt_experiment_check(experiment, where, error));
    if (o->child) return serve_callgrind(o, error);
    RtResults results;
    RtCallgrind callgrind = {0};
    RtStatus status = rt_results_init(&results, experiment, error);
    if (status == RT_OK) status = measure(o, &results, &callgrind, error);
    if (status == RT_OK)
        status = rt_bench_report(&results, &callgrind,
                                 &(RtBenchOutput){o->csv, o->json, o->workload.count_only}, error);
    if (status == RT_OK) status = rt_results_check_broken(&results, error);
    rt_callgrind_clear(&callgrind);
    rt_results_clear(&results);
    return status;
}

static const struct argp_child children[] = {
    {&rt_recording_argp, 0, NULL, 1}, {&rt_plugin_argp, 0, NULL, 0}, {0}};
const struct argp rt_bench_argp = {
    .options = options,
    .parser = parse_option,
    .args_doc = "SCENE",
    .doc = "Count and time accelerators on the rays of one scene, and compare them."
           "\vSCENE is a file or a built-in, as in balls:size=3, or several: random:n=1e2..1e5*10 (quote "
           "what "
           "your shell would take for its own: | and *). Every accelerator gets the "
           "same rays and must give the same answers (exit code 1 otherwise). Example:\n"
           "  raytally bench balls --accel bvh --accel grid --accel brute --ray-stride 100\n"
           "  raytally bench 'balls:size=2|3' --accel bvh --accel 'grid:density=1..16*4'\n"
           "  raytally bench balls --accel bvh --rays-from rays.npy --rays nearest --hits hits.npy",
    .children = children};

int rt_command_bench(int argc, char **argv) {
    Options o = {.workload = {.timing = 1, .patience = RT_PATIENCE}, .argv = argv};
    RtError error;
    if (rt_recording_init(&o.recording, &error) != RT_OK) return rt_cli_fail(&error);
    argp_parse(&rt_bench_argp, argc, argv, 0, 0, &o);
    RtStatus status = bench(&o, &error);
    rt_recording_clear(&o.recording);
    return status == RT_OK ? RT_EXIT_OK : rt_cli_fail(&error);
}
