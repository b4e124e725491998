/* SPDX-License-Identifier: Apache-2.0 */
#include "report/plot.h"

#include "core/base/memory.h"
#include "core/base/process.h"
#include "core/base/words.h"
#include "histograms_gp.h"
#include "report/color.h"
#include "report/page.h"
#include "report/sweep_plot.h"
#include "style_gp.h"

#include <ctype.h>
#include <errno.h>
#include <string.h>

enum { MOST_ARGUMENTS = RT_MAX_PLOTS + 4 };

#define HISTOGRAM_SCRIPT "histograms.gp"

/* ---- generated scripts ---- */

/* Whether the CSV files have rows of the candidate, and it is the first of its label. */
static bool has_rows(const RtResults *results, uint32_t candidate) {
    const RtCandidate *candidates = results->experiment->candidates;
    for (uint32_t c = 0; c < candidate; c++) {
        if (strcmp(candidates[c].label, candidates[candidate].label) == 0) return false;
    }
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        for (uint32_t k = 0; k < RT_RAY_KIND_COUNT; k++) {
            const RtCell *cell = rt_cell_at(results, t, candidate, (RtRayKind)k);
            if (cell->counted || cell->timed) return true;
        }
    }
    return false;
}

static bool has_rays(const RtResults *results, RtRayKind kind) {
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        if (results->workloads[t].rays[kind]) return true;
    }
    return false;
}

/* The weight of each set of rays, and weight(0), that of the row at hand in counts.csv or times.csv. */
static void write_sets(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    fprintf(out, "sets = \"");
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t k = 0; k < experiment->kind_count; k++) {
            const RtRayKind kind = experiment->kinds[k];
            if (results->workloads[t].rays[kind])
                fprintf(out, "%s/%s=%.0f ", experiment->workloads[t].label,
                        rt_experiment_kind_name(experiment, kind), rt_results_weight(results, t, kind));
        }
    }
    fprintf(out,
            "\"\n"
            "whole_rays(scene, kind) = (at_ = strstrt(' '.sets, ' '.scene.'/'.kind.'='), at_ == 0 ? 0 : \\\n"
            "  real(word(sets[at_ + strlen(scene) + strlen(kind) + 2 : *], 1)))\n"
            "weight(unused) = whole_rays(strcol('scene'), strcol('kind'))\n");
}

/* Labels hold nothing that gnuplot's double quotes would interpret (rt_experiment_check). */
static RtStatus write_names(const RtResults *results, const char *directory, const char *format, bool column,
                            RtError *error) {
    const RtExperiment *experiment = results->experiment;
    RtOutput output;
    RT_TRY(rt_output_open_in(&output, directory, "plots/names.gp", error));
    FILE *out = output.file;
    fprintf(out,
            "# What counts.csv and times.csv have rows of, in the order of the experiment.\n"
            "experiment = \"%s\"\nformat = \"%s\"\npaper = \"%s\"\nscenes = \"",
            experiment->name, format, column ? "column" : "page");
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (results->workloads[t].known) fprintf(out, "%s ", experiment->workloads[t].label);
    }
    fprintf(out, "\"\nfiles = \"");
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (results->workloads[t].known) fprintf(out, "%s ", experiment->workloads[t].file_name);
    }
    fprintf(out, "\"\naccels = \"");
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        if (has_rows(results, c)) fprintf(out, "%s ", experiment->candidates[c].label);
    }
    static const char *const lists[] = {"colors", "markers", "dashes"};
    for (int i = 0; i < 3; i++) {
        fprintf(out, "\"\n%s = \"", lists[i]);
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            char color[RT_COLOR_CHARS];
            rt_candidate_color(experiment, c, color);
            if (!has_rows(results, c)) continue;
            if (i == 0) fprintf(out, "%s ", color);
            if (i > 0) fprintf(out, "%d ", i == 1 ? rt_plot_marker(c) : rt_plot_dash(c));
        }
    }
    fprintf(out, "\"\ngroups = \"");
    for (uint32_t c = 0; c < experiment->candidate_count; c++) {
        if (has_rows(results, c)) fprintf(out, "\\\"%s\\\" ", experiment->candidates[c].group);
    }
    fprintf(out, "\"\nwithout = \"%s\"\namong = \"%s\"\nkinds = \"", experiment->frame.without,
            experiment->frame.among);
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        if (has_rays(results, experiment->kinds[k]))
            fprintf(out, "%s ", rt_ray_kind_name(experiment->kinds[k]));
    }
    fprintf(out, "\"\n");
    write_sets(results, out);
    return rt_output_commit(&output, error);
}

/* The script that draws histograms.csv, with the style that it needs. */
static RtStatus write_histograms(const RtResults *results, const char *directory, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open_in(&output, directory, "plots/" HISTOGRAM_SCRIPT, error));
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        const RtWorkload *workload = &results->experiment->workloads[t];
        fprintf(
            output.file,
            "#: histograms-%s: Object tests and steps of each ray on %s, and sizes and depths of leaves, as\n"
            "#:   fractions per doubling of the value. Both axes are logarithmic; 0 is drawn at 1/2.\n",
            workload->file_name, workload->label);
    }
    fputs("reset session\nload \"plots/names.gp\"\n", output.file);
    rt_page_lines(output.file, style_gp);
    rt_page_lines(output.file, histograms_gp);
    return rt_output_commit(&output, error);
}

/* ---- gnuplot ---- */

/* Reports the end of gnuplot's log, which names the script and the line; if it is empty, the scripts. */
static RtStatus fail_drawing(char **arguments, const char *directory, RtError *error) {
    enum { MOST_BYTES = 1 << 24, MOST_SHOWN = 600 };
    char path[RT_MAX_PATH], scripts[MOST_SHOWN] = "", *log = NULL;
    size_t size = 0;
    RT_TRY(rt_path_join(directory, "plots/gnuplot.log", path, error));
    for (char **script = arguments + 1; *script; script++)
        rt_append_text(scripts, sizeof scripts, " %s", *script);
    RT_TRY(rt_file_read(path, MOST_BYTES, &log, &size, error));
    while (size > 0 && isspace((unsigned char)log[size - 1])) log[--size] = '\0';
    const char *last = size > MOST_SHOWN ? log + size - MOST_SHOWN : log;
    while (isspace((unsigned char)*last)) last++;
    rt_fail(error, RT_MISMATCH, "%s: gnuplot failed%s%s", directory,
            *last ? ":\n" : " without a message; its scripts:", *last ? last : scripts);
    rt_free(log);
    return RT_MISMATCH;
}

/* Runs gnuplot in `directory` with the scripts as arguments, its messages going to plots/gnuplot.log. */
static RtStatus run_gnuplot(char **arguments, const char *directory, RtError *error) {
    const RtProcessCommand command = {
        .arguments = arguments, .directory = directory, .out = "/dev/null", .log = "plots/gnuplot.log"};
    RtProcessEnd end;
    RtStatus status = rt_process_run(&command, &end, error);
    if (status == RT_NOT_AVAILABLE)
        return rt_fail(
            error, status,
            "gnuplot is not installed, so no plots were drawn; `raytally plot %s` draws them later",
            directory);
    RT_TRY(status);
    return end.code == 0 ? RT_OK : fail_drawing(arguments, directory, error);
}

/* gnuplot does not say when the disk is full: whether the file ends as files in its format do. */
static bool is_whole(const char *path) {
    char tail[16] = "";
    FILE *file = fopen(path, "re");
    if (!file) return false;
    const bool end =
        fseek(file, -(long)(sizeof tail - 1), SEEK_END) == 0 && fread(tail, 1, sizeof tail - 1, file) > 0;
    fclose(file);
    return end && (strstr(tail, "</svg>") || strstr(tail, "%%EOF"));
}

/* Renames the files that the scripts wrote, or removes them if drawing failed. */
typedef struct Settling {
    bool keep;
    RtStatus status;
    RtError *error;
} Settling;

static void settle_file(void *context, const char *path) {
    Settling *settling = context;
    char name[RT_MAX_PATH];
    snprintf(name, sizeof name, "%.*s", (int)(strlen(path) - strlen(".tmp")), path);
    if (!settling->keep)
        remove(path);
    else if (!is_whole(path))
        settling->status =
            rt_fail(settling->error, RT_IO, "%s: gnuplot wrote only a part of it: is the disk full?", name);
    else if (rename(path, name) != 0)
        settling->status = rt_fail(settling->error, RT_IO, "%s: renaming failed: %s", path, strerror(errno));
}

/* Those in a format, "svg" or "pdf". */
static RtStatus settle(const char *directory, const char *format, bool keep, RtError *error) {
    char plots[RT_MAX_PATH], end[16];
    Settling settling = {keep, RT_OK, error};
    snprintf(end, sizeof end, ".%s.tmp", format);
    RT_TRY(rt_path_join(directory, "plots", plots, error));
    errno = 0;
    const size_t count = rt_directory_each(plots, end, settle_file, &settling);
    if (count > 0 || errno == 0) return settling.status;
    return rt_fail(error, RT_IO, "%s: reading the folder failed: %s", plots, strerror(errno));
}

static RtStatus draw(const RtResults *results, const char *directory, const char *format, bool column,
                     char **arguments, RtError *error) {
    settle(directory, format, false, NULL); /* of an interrupted drawing */
    RtStatus status = write_names(results, directory, format, column, error);
    if (status == RT_OK) status = run_gnuplot(arguments, directory, error);
    if (status == RT_OK) status = settle(directory, format, true, error);
    if (status != RT_OK) settle(directory, format, false, NULL);
    return status;
}

RtStatus rt_plots_draw(const RtResults *results, const char *directory, bool column, RtError *error) {
    const RtExperiment *experiment = results->experiment;
    char paths[RT_MAX_PLOTS + 1][RT_MAX_WORD + 8];
    char program[] = "gnuplot", sweep_script[] = "plots/sweep.gp",
         histogram_script[] = "plots/" HISTOGRAM_SCRIPT;
    char *arguments[MOST_ARGUMENTS] = {program};
    const bool sweeps = rt_sweep_plots_needed(experiment);
    if (experiment->plot_count == 0 && !sweeps && !experiment->distributions) return RT_OK;
    if (sweeps) RT_TRY(rt_sweep_plots_write(results, directory, column, error));
    for (uint32_t i = 0; i <= experiment->plot_count; i++) {
        snprintf(paths[i], sizeof paths[i], "plots/%s", i ? rt_plot_name(experiment, i - 1) : "names.gp");
        arguments[i + 1] = paths[i];
    }
    if (sweeps) arguments[1] = sweep_script;
    if (experiment->distributions) {
        RT_TRY(write_histograms(results, directory, error));
        arguments[experiment->plot_count + 2] = histogram_script;
    }
    RT_TRY(draw(results, directory, "svg", column, arguments, error));
    /* If only PDF fails, this gnuplot does not support it. */
    RtError reason;
    draw(results, directory, "pdf", column, arguments, &reason);
    return write_names(results, directory, "svg", column, error); /* as it is kept */
}
