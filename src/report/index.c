/* SPDX-License-Identifier: Apache-2.0 */
#include "report/index.h"

#include "core/base/memory.h"
#include "core/text/table.h"
#include "experiment/manifest.h"
#include "experiment/result_directory.h"
#include "report/page.h"

#include <inttypes.h>
#include <string.h>

typedef struct Index {
    FILE *out;
    const char *folder;
    RtExperiment *experiment;
    bool inner; /* in one of its folders */
    size_t count;
} Index;

/* ---- an experiment ---- */

static void put_size(FILE *out, const RtResults *results) {
    const RtExperiment *experiment = results->experiment;
    uint32_t scenes;
    uint64_t cells = rt_results_size(results, &scenes);
    fprintf(out,
            "<p class=\"meta\">Scenes: %" PRIu32 " &middot; accelerators: %" PRIu32
            " &middot; cells: %" PRIu64 "%s</p>\n",
            scenes, experiment->candidate_count, cells,
            experiment->count_only ? " &middot; counted only" : "");
}

static void put_paragraph(FILE *out, const char *title, const char *text) {
    if (!*text) return;
    fprintf(out, "<p><strong>%s</strong> ", title);
    rt_html_wrap(out, "", text, "</p>\n");
}

/* `name`: of the directory, seen from the page. */
static void put_title(const Index *index, const char *directory, const char *name, const char *title) {
    char report[RT_MAX_PATH];
    fputs("<section class=\"card\"><h2>", index->out);
    if (rt_file_exists_in(directory, "report.html") &&
        rt_path_join(name, "report.html", report, NULL) == RT_OK)
        rt_page_link(index->out, report, title);
    else
        rt_html_put(index->out, title);
    fputs("</h2>\n", index->out);
}

static void put_experiment(Index *index, const char *directory, const char *name) {
    FILE *out = index->out;
    RtResults results;
    RtError error = {RT_OK, ""};
    json_t *manifest = NULL;
    RtStatus status = rt_run_load(directory, index->experiment, &results, &error);
    if (status == RT_OK) status = rt_manifest_read(directory, &manifest, &error);
    put_title(index, directory, name, status == RT_OK ? index->experiment->name : name);
    if (status == RT_OK) {
        fputs("<p>", out);
        rt_page_verdict(out, &results);
        fputs("</p>\n", out);
        put_paragraph(out, "Question:", index->experiment->question);
        put_paragraph(out, "Finding:", index->experiment->finding);
        rt_page_provenance(out, manifest);
        put_size(out, &results);
    } else {
        put_paragraph(out, "Cannot be read:", error.message);
    }
    fputs("</section>\n", out);
    json_decref(manifest);
    rt_results_clear(&results);
    index->count++;
}

/* ---- all of them ---- */

/* Whether a folder holds an experiment.yaml and a manifest. */
static bool is_result(const char *directory) {
    return rt_file_exists_in(directory, "experiment.yaml") && rt_file_exists_in(directory, RT_MANIFEST);
}

/* ., .. and hidden folders. */
static bool is_hidden(const char *path) {
    return basename(path)[0] == '.';
}

static void visit(void *context, const char *path) {
    Index *index = context;
    if (is_hidden(path)) return;
    if (is_result(path)) {
        put_experiment(index, path, path + strlen(index->folder) + 1);
    } else if (!index->inner) {
        index->inner = true;
        rt_directory_each(path, "", visit, index);
        index->inner = false;
    }
}

RtStatus rt_index_write(const char *folder, size_t *count, RtError *error) {
    char plain[RT_MAX_PATH];
    RtOutput output;
    /* Without trailing slashes, for paths relative to it. */
    snprintf(plain, sizeof plain, "%s", *folder ? folder : ".");
    for (size_t size = strlen(plain); size > 1 && plain[size - 1] == '/'; size--) plain[size - 1] = '\0';
    *count = 0;
    RT_TRY(rt_output_open_in(&output, plain, "index.html", error));
    Index index = {.out = output.file, .folder = plain, .experiment = rt_alloc(1, sizeof(RtExperiment))};
    if (!index.experiment) {
        rt_output_discard(&output);
        return rt_fail_memory(error, "an experiment", sizeof(RtExperiment));
    }
    rt_page_begin(index.out, "Experiments");
    rt_directory_each(plain, "", visit, &index);
    rt_page_end(index.out);
    rt_free(index.experiment);
    *count = index.count;
    if (index.count) return rt_output_commit(&output, error);
    rt_output_discard(&output);
    return rt_fail(error, RT_BAD_INPUT, "%s holds no result directory", folder);
}
