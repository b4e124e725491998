/* SPDX-License-Identifier: Apache-2.0 */
/* Targets that read experiments, specs, claims, and the files of result directories. */
#include "fuzz.h"

#include "claims/findings.h"
#include "compare/compare.h"
#include "core/base/memory.h"
#include "core/text/json.h"
#include "experiment/experiment.h"
#include "report/page.h"
#include "report/report.h"
#include "results/journal.h"
#include "results/result_directory.h"
#include "results/result_tables.h"
#include "scenes/builtin.h"
#include "verify/verify_table.h"

#include <stdlib.h>
#include <string.h>

/* Everything that a result directory may have. */
static const char experiment_text[] =
    "name: fuzz\n"
    "question: q\n"
    "prediction: p\n"
    "scenes:\n"
    "  - {scene: \"random:n=10|20|40\", label: cloud, size: 8x8, depth: 2}\n"
    "  - {scene: \"balls:size=1\", label: balls, size: 8x8, depth: 2}\n"
    "accelerators:\n"
    "  - {accel: bvh}\n"
    "  - {accel: brute, label: all, group: loops}\n"
    "  - {accel: \"grid:density=1|4|16\", label: grid}\n"
    "baseline: bvh\n"
    "rays: [primary, shadow, reflection, transmission]\n"
    "rounds: 6\n"
    "builds: 2\n"
    "milliseconds: 0\n"
    "render: yes\n"
    "hardware: yes\n"
    "distributions: yes\n"
    "frame: {without: all, among: loops}\n"
    "expect:\n"
    "  - object_tests of grid falls with density\n"
    "  - ratio of time of grid:density=4 to bvh on balls > 5\n"
    "  - exponent of time of bvh in n < 0.5\n"
    "  - crossover of time of all and bvh in n > 1e4\n"
    "  - correlation of predicted_cost and time of all > 0.9\n"
    "  - break_even of grid\n"
    "  - render_time of all at largest n\n";

static RtExperiment experiment;
static RtResults results;

void fuzz_prepare_results(void) {
    RtError error;
    fuzz_write("experiment.yaml", experiment_text, strlen(experiment_text));
    if (rt_experiment_load(&experiment, fuzz_path("experiment.yaml"), false, NULL, &error) != RT_OK)
        fuzz_fail("%s", error.message);
}

static void copy_text(const Input *input, char *text, size_t size) {
    const size_t length = input->size < size - 1 ? input->size : size - 1;
    memcpy(text, input->bytes, length);
    text[length] = '\0';
}

/* ---- experiments ---- */

void fuzz_experiment(const Input *input) {
    static RtExperiment loaded;
    RtSweptKey keys[RT_MAX_SWEPT_KEYS];
    RtError error = {RT_OK, ""};
    for (int quick = 0; quick < 2; quick++) {
        if (!fuzz_accepted(rt_experiment_load(&loaded, input->path, quick, NULL, &error), &error)) return;
        CHECK(loaded.workload_count > 0 && loaded.candidate_count > 0 && loaded.kind_count > 0);
        rt_experiment_swept(&loaded, keys);
    }
}

void fuzz_spec(const Input *input) {
    char text[2 * RT_MAX_SPEC_CHARS], formatted[RT_MAX_SPEC_CHARS], again[RT_MAX_SPEC_CHARS];
    static char bests[RT_MAX_BEST][RT_MAX_SPEC_CHARS];
    RtSpec spec;
    RtError error = {RT_OK, ""};
    size_t count, all;
    uint64_t objects;
    copy_text(input, text, sizeof text);
    fuzz_accepted(rt_best_specs(text, bests, &count, &all, &error), &error);
    fuzz_accepted(rt_builtin_objects(text, &objects, &error), &error);
    if (!fuzz_accepted(rt_spec_parse(text, &spec, &error), &error)) return;
    rt_spec_format(&spec, formatted);
    if (rt_spec_parse(formatted, &spec, &error) != RT_OK) fuzz_fail("%s: %s", formatted, error.message);
    rt_spec_format(&spec, again);
    CHECK(strcmp(formatted, again) == 0);
}

/* ---- the journal ---- */

static char header[4096]; /* the first line of the journal, by which it belongs to the experiment */

static RtStatus read_journal(const void *lines, size_t size, RtError *error) {
    FILE *file = fopen(fuzz_path("cells.jsonl"), "wb");
    CHECK(file);
    fputs(header, file);
    fwrite(lines, 1, size, file);
    CHECK(fclose(file) == 0);
    CHECK(rt_results_init(&results, &experiment, error) == RT_OK);
    return rt_journal_load(fuzz_path("cells.jsonl"), &results, NULL, error);
}

void fuzz_prepare_journal(void) {
    const RtSelection all = {0};
    RtJsonLines journal;
    RtError error;
    char *text;
    size_t size;
    fuzz_prepare_results();
    CHECK(rt_journal_open(&journal, fuzz_path("cells.jsonl"), &experiment, &all, false, &error) == RT_OK);
    rt_json_lines_close(&journal);
    CHECK(rt_file_read(fuzz_path("cells.jsonl"), sizeof header - 1, &text, &size, &error) == RT_OK);
    strcpy(header, text);
    rt_free(text);
}

/* Everything that is made of results. */
static void use_results(void) {
    FILE *out = fuzz_nowhere();
    char sentence[RT_MAX_SENTENCE];
    RtComparison comparison = {0};
    RtError error = {RT_OK, ""};
    for (RtResultFile file = 0; file < RT_RESULT_FILE_COUNT; file++) {
        if (rt_result_file_sort(results.experiment, file) != RT_FILE_OTHER)
            rt_result_csv_write(file, &results, out);
    }
    rt_print_results(&results, RT_CELLS, out);
    rt_print_results(&results, RT_COUNTED_CELLS, out);
    rt_print_summary(&results, fuzz_path("."), out);
    rt_print_left_out(&results, out);
    rt_print_frames(&results, out);
    rt_print_distributions(&results, out);
    rt_null_sentence(&results, sentence);
    fuzz_accepted(rt_claims_check(&results, &error), &error);
    json_decref(rt_page_claims(&results));
    const RtResults both[2] = {results, results};
    CHECK(rt_compare_results(both, 1, &comparison, &error) == RT_OK);
    rt_comparison_print(&comparison, out);
    rt_comparison_clear(&comparison);
}

void fuzz_journal(const Input *input) {
    RtError error = {RT_OK, ""};
    if (fuzz_accepted(read_journal(input->bytes, input->size, &error), &error)) use_results();
    rt_results_clear(&results);
}

void fuzz_packed_journal(const Input *input) {
    json_t *lines;
    RtError error = {RT_OK, ""};
    CHECK(input->path);
    if (fuzz_accepted(rt_json_lines_load(fuzz_path("cells.jsonl"), &lines, &error), &error))
        json_decref(lines);
}

/* ---- claims ---- */

/* Any measurements that differ from cell to cell. */
void fuzz_prepare_claim(void) {
    RtError error;
    uint64_t number = 1;
    fuzz_prepare_results();
    CHECK(rt_results_init(&results, &experiment, &error) == RT_OK);
    for (RtCellCursor at = {0}; rt_results_next(&results, &at); number++) {
        const double seconds = 1e-7 * (double)(1 + number % 5);
        const RtEstimate estimate = {seconds, 0.9 * seconds, 1.1 * seconds, 0.9 * seconds};
        RtBuildResult *build = rt_build_at(&results, at.workload, at.candidate);
        results.workloads[at.workload].known = true;
        results.workloads[at.workload].objects = 10U << at.workload;
        results.workloads[at.workload].rays[at.kind] = 64;
        build->known = build->exact = build->counts = build->render.known = true;
        build->seconds = build->render.seconds = build->render.share = estimate;
        build->structure.predicted_cost = (double)number;
        build->structure.bytes = 100 * number;
        at.cell->counted = at.cell->timed = true;
        at.cell->tally =
            (RtTally){.rays = 64, .hits = 32, .object_tests = 64 * number, .steps = 100 * number};
        at.cell->rounds = 6;
        at.cell->seconds = at.cell->wall = estimate;
        at.cell->ratio = (RtEstimate){1e7 * seconds, 0.9e7 * seconds, 1.1e7 * seconds, 0.9e7 * seconds};
        at.cell->baseline = experiment.baseline;
    }
}

void fuzz_claim(const Input *input) {
    RtClaim claim;
    RtClaimResult judged;
    RtError error = {RT_OK, ""};
    copy_text(input, experiment.claims[0], RT_MAX_CLAIM);
    experiment.claim_count = 1;
    if (!fuzz_accepted(rt_claim_parse(&experiment, experiment.claims[0], &claim, &error), &error)) return;
    rt_claim_judge(&results, 0, &judged);
    CHECK(*rt_claim_verdict_name(judged.verdict));
    rt_claims_print(&results, fuzz_nowhere());
}

/* ---- the manifest ---- */

static const char *folder_of_files(void) {
    static char folder[RT_MAX_PATH];
    rt_path_folder(fuzz_path("manifest.json"), folder);
    return folder;
}

void fuzz_manifest(const Input *input) {
    static RtExperiment loaded;
    static RtCandidate candidate;
    json_t *manifest;
    RtError error = {RT_OK, ""};
    CHECK(input->path);
    if (!fuzz_accepted(rt_manifest_read(folder_of_files(), &manifest, &error), &error)) return;
    for (uint32_t i = 0; rt_manifest_candidate(manifest, i, &candidate); i++)
        rt_manifest_is_missing(manifest, i);
    rt_manifest_is_whole(manifest, "grid", "density");
    fuzz_accepted(rt_experiment_load(&loaded, fuzz_path("experiment.yaml"),
                                     json_is_true(json_object_get(manifest, "quick")), manifest, &error),
                  &error);
    json_decref(manifest);
}

/* ---- tables ---- */

/* As the index of all results reads it. */
void fuzz_csv(const Input *input) {
    static const char manifest[] = "{\"date\": \"2000-01-01\", \"machine\": {}}";
    size_t count;
    RtError error = {RT_OK, ""};
    (void)input;
    fuzz_write("manifest.json", manifest, strlen(manifest));
    fuzz_accepted(rt_index_write(folder_of_files(), &count, &error), &error);
}

/* Rows of a verification, without the header of their journal. A row counts only if its scene and its
 * accelerator are those that were asked for. */
void fuzz_verification(const Input *input) {
    json_t *rows, *known = json_array(), *row;
    size_t i;
    RtError error = {RT_OK, ""};
    if (fuzz_accepted(rt_json_lines_load(input->path, &rows, &error), &error)) {
        json_array_foreach(rows, i, row) {
            if (!json_is_object(row)) continue;
            json_object_set_new(row, "scene", json_string("balls"));
            json_object_set_new(row, "accel", json_string("light:cells=100+bvh"));
            json_array_append(known, row);
        }
        fuzz_accepted(rt_verify_write(known, folder_of_files(), &error), &error);
        json_decref(rows);
    }
    json_decref(known);
}
