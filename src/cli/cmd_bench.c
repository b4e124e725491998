/* SPDX-License-Identifier: Apache-2.0 */
/* raytally bench: counts and times accelerators on the rays of one scene, as an experiment without a
 * directory. */
#include "cli/cli.h"
#include "cli/experiment_options.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "measure/machine.h"
#include "results/result_tables.h"
#include "run/callgrind.h"
#include "run/worker.h"

#include <stdio.h>
#include <string.h>

typedef struct Options {
    RtExperimentOptions shared;
    const char *scene, *baseline, *csv;
    RtWorkloadOptions workload;
    bool json;
    int threads;       /* -1: one to time, all to build and count */
    bool worker;       /* it counts instructions for another one (run/worker.h) */
    char *const *argv; /* all arguments, NULL behind the last */
} Options;

/* ---- options ---- */

/* Adds an accelerator that was not given. */
static void set_baseline(RtExperiment *experiment, const char *text, struct argp_state *state) {
    uint32_t c = 0;
    while (c < experiment->candidate_count && strcmp(experiment->candidates[c].spec, text) != 0) c++;
    experiment->baseline = c;
    if (c == experiment->candidate_count) rt_add_accel(experiment, text, state);
}

static void check_names(const Options *o, struct argp_state *state) {
    const RtExperiment *e = &o->shared.experiment;
    const char *const files[] = {o->workload.hits, o->csv, *e->rays_from ? e->rays_from : NULL};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < i; k++) {
            if (files[i] && files[k] && strcmp(files[i], files[k]) == 0)
                argp_error(state, "'%s' is named twice: give each file its own name", files[i]);
        }
    }
}

/* Of all accelerators of the preceding --accel. */
static void take_ray_stride(void *options, const char *text, struct argp_state *state) {
    RtExperiment *e = &((Options *)options)->shared.experiment;
    if (!e->candidate_count) argp_error(state, "--ray-stride comes after the --accel that it applies to");
    const int64_t stride = rt_cli_integer(state, "--ray-stride", text, 1, (int64_t)RT_MAX_RAYS_A_KIND);
    const uint32_t last = e->candidate_count - 1, entry = e->candidates[last].entry;
    for (uint32_t c = 0; c <= last; c++) {
        if (e->candidates[c].entry == entry) e->candidates[c].ray_stride = (uint64_t)stride;
    }
}

static void take_rays_from(void *options, const char *text, struct argp_state *state) {
    RtExperiment *e = &((Options *)options)->shared.experiment;
    if (strlen(text) >= RT_MAX_PATH) argp_error(state, "--rays-from: the path is too long");
    strcpy(e->rays_from, text);
}

static void finish(void *options, struct argp_state *state) {
    Options *o = options;
    RtExperiment *e = &o->shared.experiment;
    if (!e->candidate_count) argp_error(state, "an accelerator is missing: --accel SPEC, or --accel all");
    if (o->baseline) set_baseline(e, o->baseline, state);
    if (!o->baseline) rt_experiment_set_baseline(e, NULL);
    if (o->threads >= 0) o->workload.threads = o->workload.timing = o->threads;
    if (o->workload.until > 0 && e->rounds < RT_FULL_ROUNDS) e->rounds = RT_FULL_ROUNDS;
    rt_experiment_options_finish(&o->shared, state);
    check_names(o, state);
}

static const RtOption options[] = {
    {"accel", 'a', "SPEC", RT_TO_TAKE(rt_take_accel),
     "An accelerator, NAME[:KEY=VALUE,...]; repeat the option for several. `all`: every accelerator at its "
     "defaults. A VALUE may be a list, 1|4|16, or a range, 1..9+2 (steps of 2) or 1..64*2 (doubling): "
     "raytally then measures an accelerator for each value, or combination of values"},
    {"ray-stride", 0, "K", RT_TO_TAKE(take_ray_stride),
     "Measure the preceding --accel on every Kth ray only, for slow accelerators"},
    {"baseline", 0, "SPEC", RT_TO_TEXT(baseline),
     "The accelerator that ratios are relative to (default: the first that is not a plugin)"},
    {"milliseconds", 0, "N", RT_TO_INTEGER(shared.experiment.milliseconds, 0, RT_MAX_MILLISECONDS),
     "Repeat a short set of rays within a round until N milliseconds have passed (20); 0: run it once"},
    {"rounds", 0, "N", RT_TO_INTEGER(shared.experiment.rounds, 1, RT_MAX_ROUNDS),
     "Timing rounds, each in a new random order (10); 95 % intervals need 6 or more"},
    {"builds", 0, "N", RT_TO_INTEGER(shared.experiment.builds, 1, RT_MAX_ROUNDS),
     "Time at most N builds of each accelerator, in rounds too, after a warm-up (20); fewer if they take "
     "longer than 0.15 s times N. --count-only builds once"},
    RT_UNTIL_OPTIONS(workload.until, workload.patience),
    {"threads", 0, "N", RT_TO_INTEGER(threads, 0, 1024), RT_THREADS_HELP},
    RT_MEMORY_OPTION(shared.experiment.limit_bytes),
    RT_TIME_OPTION(""),
    {"count-only", 0, NULL, RT_TO_FLAG(workload.count_only), "Count, do not time"},
    {"distribution", 0, NULL, RT_TO_FLAG(shared.experiment.distributions),
     "Also show distributions: object tests and steps over the rays, each ray traced alone, and objects and "
     "depths over the leaves. Medians, 99th percentiles and maxima reveal the few rays that cost a hundred "
     "times the mean. --json adds all percentiles and the histograms. In an experiment: `distributions: "
     "yes`"},
    RT_GONE("hardware", "run raytally under `perf stat`, see docs/guide/faq.md, or use --callgrind"),
    {"callgrind", 0, "N", RT_TO_TAKE_OPTIONAL(rt_take_callgrind),
     "Also show instructions per ray, counted by valgrind's callgrind: exact, and the same on every run. "
     "raytally builds each accelerator again under valgrind, which is many times slower, and traces N rays "
     "of each kind (4096), without AVX-512, which valgrind lacks"},
    {"worker", 0, NULL, RT_TO_HIDDEN_FLAG(worker), NULL}, /* run/worker.h */
    {"csv", 0, "FILE", RT_TO_TEXT(csv),
     "Also write a row per cell to FILE, in the columns of times.csv, or of counts.csv with --count-only"},
    {"hits", 0, "FILE.npy", RT_TO_PATH(workload.hits, RT_CLI_ROWS),
     "Also write each ray's hit, of one scene, accelerator and kind of rays, for NumPy, or as text to "
     "FILE.csv, a row per ray: t and object (inf and -1 for a miss); for shadow and occlusion rays whether "
     "the ray is blocked"},
    RT_STRICT_OPTION,
    {"json", 0, NULL, RT_TO_FLAG(json), "One JSON document on stdout instead of the table"},
    {"rays-from", 0, "FILE.npy", RT_TO_TAKE(take_rays_from),
     "Measure the rays of FILE instead of recorded ones: an array of float32 of shape (N, 8), or text "
     "(.csv), as `raytally rays` writes it. --rays chooses the query: nearest, or occlusion (any hit)"},
    {0}};

/* ---- the report ---- */

static void extend(json_t *array, const RtResults *results, RtResultTable which, uint32_t workload) {
    RtResultRow row = {.results = results, .workload = workload};
    RtTable table = rt_result_table(which, &row);
    json_auto_t *rows = rt_table_json(&table);
    json_array_extend(array, rows);
}

static json_t *scene_json(const RtResults *results, uint32_t workload) {
    const RtExperiment *e = results->experiment;
    const RtWorkload *setup = &e->workloads[workload];
    const RtWorkloadResult *scene = &results->workloads[workload];
    const bool given = *e->rays_from;
    json_t *rays = given ? json_pack("{s:s}", "from", e->rays_from)
                         : json_pack("{s:I, s:I, s:b, s:I, s:I, s:I}", "width", (json_int_t)scene->width,
                                     "height", (json_int_t)scene->height, "corners", setup->corners, "depth",
                                     (json_int_t)setup->depth, "limit", (json_int_t)e->limit, "coherent_run",
                                     (json_int_t)e->coherent_run);
    return json_pack("{s:s, s:s, s:I, s:o, s:o}", "scene", setup->label, "scene_spec", setup->spec, "objects",
                     (json_int_t)scene->objects, "scene_hash", rt_json_hex(scene->scene), "recorded", rays);
}

static void print_json(const RtResults *results, const RtCallgrind *callgrind) {
    const RtExperiment *e = results->experiment;
    json_t *scenes = json_array(), *rows = json_array(), *nulls = json_array();
    for (uint32_t t = 0; t < e->workload_count; t++) {
        json_array_append_new(scenes, scene_json(results, t));
        extend(rows, results, RT_BENCH, t);
        extend(nulls, results, RT_NULL_RUNS, t);
    }
    json_t *all = json_pack("{s:o, s:o, s:I, s:I, s:s, s:o, s:o}", "machine", rt_machine_json(), "scenes",
                            scenes, "seed", (json_int_t)e->seed, "rounds", (json_int_t)e->rounds, "baseline",
                            rt_baseline_label(e), "rows", rows, "null_runs", nulls);
    RtInstructionsRow instructions = {.callgrind = callgrind};
    RtResultRow row = {.results = results};
    if (e->distributions) {
        const RtTable table = rt_result_table(RT_DISTRIBUTIONS, &row);
        json_object_set_new(all, "distributions", rt_table_json(&table));
        const RtTable bins = rt_result_table(RT_HISTOGRAMS, &row);
        json_object_set_new(all, "histograms", rt_table_json(&bins));
    }
    const RtTable counted = rt_instructions_table(&instructions);
    if (callgrind->count) json_object_set_new(all, "instructions", rt_table_json(&counted));
    rt_cli_print_json(all);
}

static RtStatus report(const Options *o, const RtResults *results, const RtCallgrind *callgrind,
                       RtError *error) {
    const RtExperiment *e = results->experiment;
    char sentence[RT_MAX_SENTENCE];
    RtOutput output;
    RtResultRow row = {.results = results};
    const RtTable table = rt_result_table(o->workload.count_only ? RT_COUNTS : RT_TIMES, &row);
    if (o->csv) {
        RT_TRY(rt_output_open(&output, o->csv, error));
        rt_table_csv(&table, output.file);
        RT_TRY(rt_output_commit(&output, error));
    }
    if (o->json) {
        print_json(results, callgrind);
        return RT_OK;
    }
    rt_print_results(results, RT_CELLS, stdout);
    rt_print_left_out(results, stdout);
    if (callgrind->count) rt_print_instructions(callgrind, stdout);
    if (e->distributions) rt_print_distributions(results, stdout);
    rt_null_sentence(results, sentence);
    if (*sentence) putchar('\n');
    if (*sentence) rt_print_wrapped(sentence, stdout);
    if (o->csv || o->workload.hits) putchar('\n');
    if (o->csv) printf("wrote %s\n", o->csv);
    if (o->workload.hits) printf("wrote %s\n", o->workload.hits);
    return RT_OK;
}

/* ---- the command ---- */

static RtStatus check_path(const char *path, RtError *error) {
    RtOutput output;
    if (!path) return RT_OK;
    RT_TRY(rt_output_open(&output, path, error));
    rt_output_discard(&output);
    return RT_OK;
}

static RtStatus measure(Options *o, RtResults *results, RtCallgrind *callgrind, RtError *error) {
    RT_TRY(check_path(o->workload.hits, error));
    if (o->shared.callgrind) {
        RT_TRY(rt_callgrind_check(error));
        RT_TRY(rt_callgrind_init(callgrind, results->experiment, o->shared.callgrind, error));
        o->workload.rays = rt_callgrind_save_rays;
        o->workload.rays_context = callgrind;
    }
    RtProgress progress;
    rt_progress_begin(&progress, &o->workload);
    RtStatus status = rt_workloads_run(results, &o->workload, error);
    if (status == RT_OK && o->shared.callgrind)
        rt_notify(&o->workload.observer, "counting instructions under valgrind, which takes a while");
    rt_progress_end(&progress);
    if (status == RT_OK && o->shared.callgrind)
        status = rt_callgrind_run(callgrind, NULL, results, o->argv + 1, error);
    return status;
}

static RtStatus bench(Options *o, RtError *error) {
    char where[RT_MAX_LABEL];
    RtExperiment *experiment = &o->shared.experiment;
    RT_TRY(rt_experiment_add_scenes(experiment, &o->shared.like, o->scene, "", error));
    strcpy(experiment->name, "bench");
    RT_TRY(rt_experiment_check(experiment, where, error));
    if (o->workload.hits &&
        experiment->workload_count * experiment->candidate_count * experiment->kind_count > 1)
        return rt_fail(error, RT_BAD_INPUT,
                       "--hits: give one scene, one accelerator and one kind of rays; docs/guide/python.md "
                       "has them all");
    if (o->worker) return rt_worker_serve(experiment, NULL, error);
    RT_OWNED(RtResults, results, rt_results_clear);
    RT_OWNED(RtCallgrind, callgrind, rt_callgrind_clear);
    RT_TRY(rt_results_init(&results, experiment, error));
    RT_TRY(measure(o, &results, &callgrind, error));
    RT_TRY(report(o, &results, &callgrind, error));
    return rt_results_check(&results, error);
}

const RtSyntax rt_bench_syntax = {
    .options = options,
    .shared = rt_experiment_options,
    .shared_at = offsetof(Options, shared),
    .shared_group = 1,
    .plugins = true,
    RT_ONE_SCENE,
    .finish = finish,
    .help =
        "Count and time accelerators on the rays of one scene, and compare them.\v"
        "SCENE is a file or a built-in, as in balls:size=3, or several: random:n=1e2..1e5*10 (quote what "
        "your shell would interpret: | and *). Every accelerator traces the same rays and must return "
        "the same answers, or the exit code is 1; those with their own hit functions (Embree's native "
        "mode, libraries as plugins) are measured whatever they answer, and differences are counted. "
        "Mrays/s are millions of rays per second, on one thread unless --threads says otherwise; `raytally "
        "run` prints the time per ray instead: ns/ray = 1000 / (Mrays/s). Examples:\n"
        "  raytally bench balls --accel bvh --accel grid --accel brute --ray-stride 100\n"
        "  raytally bench 'balls:size=2|3' --accel bvh --accel 'grid:density=1..16*4'\n"
        "  raytally bench balls --accel bvh --rays-from rays.npy --rays nearest \\\n"
        "    --hits hits.npy"};

RtStatus rt_command_bench(int argc, char **argv, RtError *error) {
    static Options o;
    o.threads = -1;
    o.workload.timing = 1;
    o.workload.patience = RT_PATIENCE;
    o.argv = argv;
    rt_experiment_options_init(&o.shared);
    rt_cli_parse(&rt_bench_syntax, argc, argv, &o);
    return bench(&o, error);
}
