/* raytally bench: one scene, a few accelerators, counted and timed at once. It is an experiment of one trial
 * that leaves no directory behind. */
#include "base/memory.h"
#include "cli/cli.h"
#include "cli/progress.h"
#include "experiments/json.h"
#include "experiments/machine.h"
#include "experiments/spread.h"
#include "experiments/tables.h"
#include "render/frame.h"

#include <argp.h>
#include <math.h>
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
    OPT_TOGETHER,
    OPT_EVERY
};

typedef struct Options {
    RtExperiment *experiment;
    const char *scene, *baseline, *csv;
    RtTrialOptions trial;
    bool json;
} Options;

static const struct argp_option options[] = {
    {"accel", 'a', "SPEC", 0,
     "An accelerator, NAME[:KEY=VALUE,...]; once per accelerator. `all`: every one, at "
     "its defaults",
     0},
    {"every", OPT_EVERY, "K", 0, "Measure the --accel before this on every Kth ray only: for slow ones", 0},
    {"rays", OPT_RAYS, "KIND,...", 0,
     "Ray kinds: primary, shadow, reflection, transmission, diffuse, random (all)", 0},
    {"limit", OPT_LIMIT, "N", 0, "Rays of a kind at most; a larger set is thinned evenly (100000)", 0},
    {"together", OPT_TOGETHER, "N", 0,
     "Neighbouring rays that are kept together where a set is thinned, for packets and caches (256)", 0},
    {"baseline", OPT_BASELINE, "SPEC", 0, "The accelerator that ratios refer to (the first)", 0},
    {"rounds", OPT_ROUNDS, "N", 0,
     "Times each is timed, in an order drawn anew (10); 6 at least for intervals of 95 %", 0},
    {"seed", OPT_SEED, "S", 0, "Seed of diffuse and random rays and of orders (1)", 0},
    {"threads", OPT_THREADS, "N", 0,
     "Threads, 0 for all processors. Left out: timing on one, by its processor time, and building and "
     "counting on "
     "all; on several, wall time is compared",
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

static void add_accel(RtExperiment *experiment, const char *text, struct argp_state *state) {
    if (experiment->contender_count == RT_MAX_CONTENDERS) {
        argp_error(state, "--accel: there may be %d at most", RT_MAX_CONTENDERS);
    }
    if (strlen(text) >= RT_MAX_SPEC_CHARS) {
        argp_error(state, "--accel: a spec has at most %d characters", RT_MAX_SPEC_CHARS - 1);
    }
    RtContender *contender = &experiment->contenders[experiment->contender_count++];
    contender->every = 1;
    strcpy(contender->spec, text);
    if (strlen(text) < RT_MAX_LABEL) {
        strcpy(contender->label, text);
    } else {
        snprintf(contender->label, RT_MAX_LABEL, "%.*s...%u", RT_MAX_LABEL - 8, text,
                 experiment->contender_count);
    }
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
    if (!experiment->kind_count) argp_error(state, "--rays: give one kind at least");
}

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    Options *o = state->input;
    RtExperiment *e = o->experiment;
    switch (key) {
    case 'a': add_accels(e, argument, state); return 0;
    case OPT_EVERY:
        if (!e->contender_count) argp_error(state, "--every stands behind the --accel that it is for");
        e->contenders[e->contender_count - 1].every =
            (uint64_t)rt_cli_integer(state, "--every", argument, 1, (int64_t)RT_MAX_RAYS_A_KIND);
        return 0;
    case OPT_RAYS: parse_kinds(e, argument, state); return 0;
    case OPT_LIMIT:
        e->limit = (uint64_t)rt_cli_integer(state, "--limit", argument, 1, (int64_t)RT_MAX_RAYS_A_KIND);
        return 0;
    case OPT_TOGETHER:
        e->together = (uint64_t)rt_cli_integer(state, "--together", argument, 1, (int64_t)RT_MAX_RAYS_A_KIND);
        return 0;
    case OPT_BASELINE: o->baseline = argument; return 0;
    case OPT_ROUNDS:
        e->rounds = (uint32_t)rt_cli_integer(state, "--rounds", argument, 1, RT_MAX_ROUNDS);
        return 0;
    case OPT_SEED: e->seed = (uint64_t)rt_cli_integer(state, "--seed", argument, 0, INT64_MAX); return 0;
    case OPT_THREADS:
        o->trial.threads = o->trial.timing = (int)rt_cli_integer(state, "--threads", argument, 0, 1024);
        return 0;
    case OPT_SIZE: rt_cli_size(state, argument, &e->trials[0].width, &e->trials[0].height); return 0;
    case OPT_CORNERS: e->trials[0].corners = true; return 0;
    case OPT_DEPTH:
        e->trials[0].depth = (uint32_t)rt_cli_integer(state, "--depth", argument, 1, RT_MAX_DEPTH);
        return 0;
    case OPT_COUNT_ONLY: o->trial.count_only = true; return 0;
    case OPT_CSV: o->csv = argument; return 0;
    case OPT_JSON: o->json = true; return 0;
    case ARGP_KEY_ARG:
        if (o->scene) argp_error(state, "one SCENE at a time; '%s' is a second one", argument);
        o->scene = argument;
        return 0;
    case ARGP_KEY_END:
        if (!o->scene)
            argp_error(state, "a SCENE is missing: a file, or a built-in as `raytally scenes` lists");
        if (!e->contender_count) argp_error(state, "an accelerator is missing: --accel SPEC, or --accel all");
        if (o->baseline) {
            e->baseline = 0;
            while (e->baseline < e->contender_count &&
                   strcmp(e->contenders[e->baseline].spec, o->baseline) != 0) {
                e->baseline++;
            }
            if (e->baseline == e->contender_count) add_accel(e, o->baseline, state);
        }
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

/* ---- output ---- */

static json_t *row_json(const RtResults *results, uint32_t c, RtRayKind kind) {
    const RtCell *cell = rt_cell_at(results, 0, c, kind);
    const RtBuildResult *build = rt_build_at(results, 0, c);
    bool counted = isfinite(rt_cell_per_ray(results, 0, c, kind, cell->tally.object_tests));
    double unknown = cell->timed ? 1 : (double)NAN;
    return json_pack("{s:s, s:s, s:s, s:I, s:I, s:f, s:I, s:o, s:o, s:o, s:o, s:o, s:o, s:o}", "scene",
                     results->experiment->trials[0].spec, "accel", build->spec, "kind",
                     rt_ray_kind_name(kind), "rays", (json_int_t)cell->tally.rays, "hits",
                     (json_int_t)cell->tally.hits, "build_seconds", build->seconds, "bytes",
                     (json_int_t)build->shape.bytes, "structure", rt_json_structure(&build->shape), "counts",
                     counted ? rt_json_tally(&cell->tally) : json_null(), "mrays_per_s",
                     rt_json_number(unknown * 1e-6 / cell->seconds.median), "ratio",
                     rt_json_number(unknown * cell->ratio.median), "ratio_low",
                     rt_json_ratio_end(unknown * cell->ratio.low), "ratio_high",
                     rt_json_ratio_end(unknown * cell->ratio.high), "ratio_coverage",
                     cell->timed ? json_real(rt_interval_coverage(cell->rounds)) : json_null());
}

static json_t *null_json(const RtCell *cell, RtRayKind kind) {
    return json_pack("{s:s, s:f, s:o, s:o, s:f, s:b}", "kind", rt_ray_kind_name(kind), "ratio",
                     cell->ratio.median, "ratio_low", rt_json_ratio_end(cell->ratio.low), "ratio_high",
                     rt_json_ratio_end(cell->ratio.high), "ratio_coverage",
                     rt_interval_coverage(cell->rounds), "straddles_1", rt_estimate_holds(&cell->ratio, 1));
}

static void print_json(const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    json_t *rows = json_array(), *nulls = json_array();
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        RtRayKind kind = experiment->kinds[k];
        const RtCell *null = rt_cell_at(results, 0, experiment->contender_count, kind);
        for (uint32_t c = 0; c < experiment->contender_count; c++) {
            if (rt_cell_at(results, 0, c, kind)->counted)
                json_array_append_new(rows, row_json(results, c, kind));
        }
        if (null->timed) json_array_append_new(nulls, null_json(null, kind));
    }
    rt_cli_print_json(
        json_pack("{s:o, s:o, s:o}", "machine", rt_machine_json(), "rows", rows, "null_runs", nulls));
}

static RtStatus write_csv(const RtResults *results, const Options *o, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open(&output, o->csv, error));
    if (o->trial.count_only) {
        rt_counts_csv(results, output.file);
    } else {
        rt_times_csv(results, output.file);
    }
    return rt_output_commit(&output, error);
}

static RtStatus report(const RtResults *results, const Options *o, RtError *error) {
    if (o->csv) RT_TRY(write_csv(results, o, error));
    if (o->json) {
        print_json(results);
    } else {
        char sentence[RT_MAX_SENTENCE];
        rt_print_cells(results, stdout);
        rt_null_sentence(results, sentence);
        if (sentence[0]) printf("\n%s\n", sentence);
    }
    return RT_OK;
}

/* ---- the command ---- */

static RtStatus bench(Options *o, RtError *error) {
    char where[RT_MAX_LABEL];
    RtExperiment *experiment = o->experiment;
    RT_TRY(rt_trial_set_scene(&experiment->trials[0], o->scene, "", error));
    strcpy(experiment->name, "bench");
    RT_TRY(rt_experiment_check(experiment, where, error));
    RtProgress progress = rt_progress_begin(experiment, o->trial.count_only ? 1 : 2);
    o->trial.observer = rt_progress_observer(&progress);
    RtResults results;
    RtStatus status = rt_results_init(&results, experiment, error);
    if (status == RT_OK) status = rt_trial_run(&results, 0, &o->trial, error);
    rt_progress_end(&progress);
    if (status == RT_OK) status = report(&results, o, error);
    rt_results_clear(&results);
    return status;
}

int rt_command_bench(int argc, char **argv) {
    Options o = {.experiment = rt_alloc(1, sizeof(RtExperiment)), .trial = {.timing = 1}};
    RtError error;
    if (!o.experiment) {
        rt_fail_memory(&error, "an experiment", sizeof(RtExperiment));
        return rt_cli_fail(&error);
    }
    rt_experiment_init(o.experiment);
    o.experiment->trial_count = 1;
    o.experiment->together = 256;
    o.experiment->trials[0].depth = RT_DEFAULT_DEPTH;
    const struct argp argp = {
        .options = options,
        .parser = parse_option,
        .args_doc = "SCENE",
        .doc = "Count and time accelerators on the rays of one scene, and compare them."
               "\vSCENE is a file or a built-in, as in balls:size=3. Every accelerator gets the "
               "same rays and must give the same answers (exit code 1 otherwise). Example:\n"
               "  raytally bench balls --accel bvh --accel grid --accel brute --every 100"};
    argp_parse(&argp, argc, argv, 0, 0, &o);
    RtStatus status = bench(&o, &error);
    rt_free(o.experiment);
    return status == RT_OK ? RT_EXIT_OK : rt_cli_fail(&error);
}
