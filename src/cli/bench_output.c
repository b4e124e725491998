/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/bench_output.h"

#include "cli/cli.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "experiment/distribution_tables.h"
#include "experiment/result_tables.h"
#include "measure/machine.h"

/* Appends the rows of one scene. */
static void extend(json_t *array, const RtResults *results, RtResultTable which, uint32_t workload) {
    RtResultRow row = {.results = results, .workload = workload};
    RtTable table = rt_result_table(which, &row);
    json_t *rows = rt_table_json(&table);
    json_array_extend(array, rows);
    json_decref(rows);
}

/* One scene, and what was recorded of it. */
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
    return json_pack("{s:s, s:I, s:o, s:o}", "scene", setup->spec, "objects", (json_int_t)scene->objects,
                     "scene_hash", rt_json_hex(scene->scene), "recorded", rays);
}

static json_t *distributions_json(const RtResults *results, RtDistributionTable which) {
    RtDistributionRow row = {.results = results};
    RtTable table = rt_distribution_table(which, &row);
    return rt_table_json(&table);
}

static json_t *instructions_json(const RtCallgrind *callgrind) {
    RtInstructionsRow row = {.callgrind = callgrind};
    RtTable table = rt_instructions_table(&row);
    return rt_table_json(&table);
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
    if (e->distributions) {
        json_object_set_new(all, "distributions", distributions_json(results, RT_DISTRIBUTIONS));
        json_object_set_new(all, "histograms", distributions_json(results, RT_HISTOGRAMS));
    }
    if (e->hardware) {
        RtResultRow row = {.results = results};
        RtTable table = rt_result_table(RT_HARDWARE, &row);
        json_object_set_new(all, "hardware", rt_table_json(&table));
    }
    if (callgrind->count) json_object_set_new(all, "instructions", instructions_json(callgrind));
    rt_cli_print_json(all);
}

static RtStatus write_csv(const RtResults *results, const RtBenchOutput *how, RtError *error) {
    RtOutput output;
    RtResultRow row = {.results = results};
    RtTable table = rt_result_table(how->count_only ? RT_COUNTS : RT_TIMES, &row);
    RT_TRY(rt_output_open(&output, how->csv, error));
    rt_table_csv(&table, output.file);
    return rt_output_commit(&output, error);
}

RtStatus rt_bench_report(const RtResults *results, const RtCallgrind *callgrind, const RtBenchOutput *how,
                         RtError *error) {
    if (how->csv) RT_TRY(write_csv(results, how, error));
    if (how->json) {
        print_json(results, callgrind);
    } else {
        char sentence[RT_MAX_SENTENCE];
        rt_print_results(results, RT_CELLS, stdout);
        if (results->experiment->hardware) rt_print_hardware(results, stdout);
        if (callgrind->count) rt_print_instructions(callgrind, stdout);
        if (results->experiment->distributions) rt_print_distributions(results, stdout);
        rt_null_sentence(results, sentence);
        if (!sentence[0]) return RT_OK;
        putchar('\n');
        rt_print_wrapped(sentence, stdout);
    }
    return RT_OK;
}
