/* SPDX-License-Identifier: Apache-2.0 */
/* raytally bench: one scene, a few accelerators, counted and timed at once. It is an experiment of one
 * workload that leaves no directory behind. */
#include "base/memory.h"
#include "bench/machine.h"
#include "bench/result_tables.h"
#include "cli/cli.h"
#include "cli/progress.h"
#include "render/frame.h"
#include "verify/spread.h"

#include <argp.h>
#include <stdio.h>
#include <string.h>

enum {
    OPT_RAYS = 256,
    OPT_ROUNDS,
    OPT_BASELINE,
    OPT_THREADS,
    OPT_SIZE,
    OPT_CORNERS,
    OPT_DEPTH,
    OPT_COUNT_ONLY,
    OPT_CSV,
    OPT_JSON,
    OPT_SEED,
    OPT_LIMIT,
    OPT_COHERENT_RUN,
    OPT_RAY_STRIDE
};

typedef struct Options {
    RtExperiment *experiment;
    const char *scene, *baseline, *csv;
    RtWorkload like; /* for all that the scene stands for */
    RtWorkloadOptions workload;
    bool json;
} Options;

static const struct argp_option options[] = {
    {"accel", 'a', "SPEC", 0,
     "An accelerator, NAME[:KEY=VALUE,...]; once per accelerator. `all`: every one, at "
     "its defaults. A VALUE may be a list, 1|4|16, or a range, 1..9+2 (in steps of 2) or 1..64*2 (each twice "
     "the one before): then it is an accelerator for each, of several such VALUEs each with each",
     0},
    {"ray-stride", OPT_RAY_STRIDE, "K", 0,
     "Measure the preceding --accel on every Kth ray only, for slow ones", 0},
    {"rays", OPT_RAYS, "KIND,...", 0,
     "Ray kinds: primary, shadow, reflection, transmission, diffuse, random; and occlusion, the diffuse rays "
     "asked for any hit (all but occlusion)",
     0},
    {"limit", OPT_LIMIT, "N", 0, "At most N rays of a kind; a larger set is thinned evenly (100000)", 0},
    {"coherent-run", OPT_COHERENT_RUN, "N", 0,
     "Neighbouring rays kept together where a set is thinned, for packets and caches (256)", 0},
    {"baseline", OPT_BASELINE, "SPEC", 0,
     "The accelerator that ratios refer to (the first); or NAME:best, the fastest of several settings for "
     "each "
     "kind, as in embree:best (`raytally accels NAME`)",
     0},
    {"rounds", OPT_ROUNDS, "N", 0,
     "Timing rounds, each in an order drawn anew (10); at least 6 for intervals of 95 %", 0},
    {"seed", OPT_SEED, "S", 0, "Seed of diffuse and random rays and of orders (1)", 0},
    {"threads", OPT_THREADS, "N", 0,
     "Threads, 0 for all processors. Left out: timing on one, by its processor time, and building and "
     "counting on all; on several, wall time is compared",
     0},
    {"size", OPT_SIZE, "WxH", 0, "Size of the frame whose rays are recorded (the camera's)", 0},
    {"corners", OPT_CORNERS, 0, 0, "Sample pixel corners, (W+1) x (H+1) rays", 0},
    {"depth", OPT_DEPTH, "N", 0, "Levels of the ray tree, the primary ray being the first (5)", 0},
    {"count-only", OPT_COUNT_ONLY, 0, 0, "Count, do not time", 0},
    {"csv", OPT_CSV, "FILE", 0,
     "Also write a row per cell to FILE, in the columns of times.csv; with "
     "--count-only of counts.csv",
     0},
    {"json", OPT_JSON, 0, 0, "One JSON document on stdout instead of the table", 0},
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

static void add_accels(RtExperiment *experiment, const char *text, struct argp_state *state) {
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

static void parse_kinds(RtExperiment *experiment, const char *text, struct argp_state *state) {
    experiment->kind_count = 0;
    for (size_t length; *text; text += length + (text[length] == ',')) {
        char name[RT_MAX_NAME];
        RtError error;
        length = strcspn(text, ",");
        snprintf(name, sizeof name, "%.*s", (int)length, text);
        if (experiment->kind_count == RT_RAY_KIND_COUNT) argp_error(state, "--rays: a kind is given twice");
        RtRayKind *kind = &experiment->kinds[experiment->kind_count++];
        if (rt_ray_kind_parse(name, kind, &error) != RT_OK) argp_error(state, "--rays: %s", error.message);
    }
    if (!experiment->kind_count) argp_error(state, "--rays: give at least one kind");
}

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    Options *o = state->input;
    RtExperiment *e = o->experiment;
    switch (key) {
    case 'a': add_accels(e, argument, state); return 0;
    case OPT_RAY_STRIDE:
        if (!e->candidate_count) argp_error(state, "--ray-stride comes after the --accel that it applies to");
        set_ray_stride(
            e, (uint64_t)rt_cli_integer(state, "--ray-stride", argument, 1, (int64_t)RT_MAX_RAYS_A_KIND));
        return 0;
    case OPT_RAYS: parse_kinds(e, argument, state); return 0;
    case OPT_LIMIT:
        e->limit = (uint64_t)rt_cli_integer(state, "--limit", argument, 1, (int64_t)RT_MAX_RAYS_A_KIND);
        return 0;
    case OPT_COHERENT_RUN:
        e->coherent_run =
            (uint64_t)rt_cli_integer(state, "--coherent-run", argument, 1, (int64_t)RT_MAX_RAYS_A_KIND);
        return 0;
    case OPT_BASELINE: o->baseline = argument; return 0;
    case OPT_ROUNDS:
        e->rounds = (uint32_t)rt_cli_integer(state, "--rounds", argument, 1, RT_MAX_ROUNDS);
        return 0;
    case OPT_SEED: e->seed = (uint64_t)rt_cli_integer(state, "--seed", argument, 0, INT64_MAX); return 0;
    case OPT_THREADS:
        o->workload.threads = o->workload.timing = (int)rt_cli_integer(state, "--threads", argument, 0, 1024);
        return 0;
    case OPT_SIZE: rt_cli_size(state, argument, &o->like.width, &o->like.height); return 0;
    case OPT_CORNERS: o->like.corners = true; return 0;
    case OPT_DEPTH:
        o->like.depth = (uint32_t)rt_cli_integer(state, "--depth", argument, 1, RT_MAX_DEPTH);
        return 0;
    case OPT_COUNT_ONLY: o->workload.count_only = true; return 0;
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
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

/* ---- output ---- */

/* Appends the rows of one scene. */
static void extend(json_t *array, const RtResults *results, RtResultTable which, uint32_t workload) {
    RtResultRow row = {.results = results, .workload = workload};
    RtTable table = rt_result_table(which, &row);
    json_t *rows = rt_table_json(&table);
    json_array_extend(array, rows);
    json_decref(rows);
}

static void print_json(const RtResults *results) {
    json_t *rows = json_array(), *nulls = json_array();
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        extend(rows, results, RT_BENCH, t);
        extend(nulls, results, RT_NULL_RUNS, t);
    }
    rt_cli_print_json(
        json_pack("{s:o, s:o, s:o}", "machine", rt_machine_json(), "rows", rows, "null_runs", nulls));
}

static RtStatus write_csv(const RtResults *results, const Options *o, RtError *error) {
    RtOutput output;
    RtResultRow row = {.results = results};
    RtTable table = rt_result_table(o->workload.count_only ? RT_COUNTS : RT_TIMES, &row);
    RT_TRY(rt_output_open(&output, o->csv, error));
    rt_table_csv(&table, output.file);
    return rt_output_commit(&output, error);
}

static RtStatus report(const RtResults *results, const Options *o, RtError *error) {
    if (o->csv) RT_TRY(write_csv(results, o, error));
    if (o->json) {
        print_json(results);
    } else {
        char sentence[RT_MAX_SENTENCE];
        rt_print_results(results, RT_CELLS, stdout);
        rt_null_sentence(results, sentence);
        if (sentence[0]) printf("\n%s\n", sentence);
    }
    return RT_OK;
}

/* ---- the command ---- */

static RtStatus bench(Options *o, RtError *error) {
    char where[RT_MAX_LABEL];
    RtExperiment *experiment = o->experiment;
    RT_TRY(rt_experiment_add_scenes(experiment, &o->like, o->scene, "", error));
    strcpy(experiment->name, "bench");
    RT_TRY(rt_experiment_check(experiment, where, error));
    RtProgress progress = rt_progress_begin(&o->workload);
    o->workload.observer = rt_progress_observer(&progress);
    RtResults results;
    RtStatus status = rt_results_init(&results, experiment, error);
    for (uint32_t t = 0; status == RT_OK && t < experiment->workload_count; t++)
        status = rt_workload_run(&results, t, &o->workload, error);
    rt_progress_end(&progress);
    if (status == RT_OK) status = report(&results, o, error);
    rt_results_clear(&results);
    return status;
}

int rt_command_bench(int argc, char **argv) {
    Options o = {.experiment = rt_alloc(1, sizeof(RtExperiment)), .workload = {.timing = 1}};
    RtError error;
    if (!o.experiment) {
        rt_fail_memory(&error, "an experiment", sizeof(RtExperiment));
        return rt_cli_fail(&error);
    }
    rt_experiment_init(o.experiment);
    o.experiment->coherent_run = 256;
    o.like.depth = RT_DEFAULT_DEPTH;
    const struct argp argp = {
        .options = options,
        .parser = parse_option,
        .args_doc = "SCENE",
        .doc = "Count and time accelerators on the rays of one scene, and compare them."
               "\vSCENE is a file or a built-in, as in balls:size=3, or several: random:n=1e2..1e5*10 (quote "
               "what "
               "your shell would take for its own: | and *). Every accelerator gets the "
               "same rays and must give the same answers (exit code 1 otherwise). Example:\n"
               "  raytally bench balls --accel bvh --accel grid --accel brute --ray-stride 100\n"
               "  raytally bench 'balls:size=2|3' --accel bvh --accel 'grid:density=1..16*4'"};
    argp_parse(&argp, argc, argv, 0, 0, &o);
    RtStatus status = bench(&o, &error);
    rt_free(o.experiment);
    return status == RT_OK ? RT_EXIT_OK : rt_cli_fail(&error);
}
