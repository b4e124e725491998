/* SPDX-License-Identifier: Apache-2.0 */
#include "report/plot.h"

#include "core/base/memory.h"
#include "core/base/process.h"
#include "core/base/words.h"
#include "report/color.h"
#include "report/sweep_data.h"

#include <ctype.h>
#include <errno.h>
#include <fnmatch.h>
#include <math.h>
#include <string.h>

enum { MOST_SCRIPTS = RT_MAX_PLOTS + 4 };

/* ---- variables ---- */

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

/* "SCENE/KIND=WEIGHT ...", for weight() of style.gp: the weight of each set of rays in sums over kinds. */
static void put_sets(const RtResults *results, FILE *out) {
    const RtExperiment *experiment = results->experiment;
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        for (uint32_t k = 0; k < experiment->kind_count; k++) {
            const RtRayKind kind = experiment->kinds[k];
            if (results->workloads[t].rays[kind])
                fprintf(out, "%s/%s=%.0f ", experiment->workloads[t].label,
                        rt_experiment_kind_name(experiment, kind), rt_results_weight(results, t, kind));
        }
    }
}

static void put_candidate(const RtExperiment *experiment, uint32_t c, const char *list, FILE *out) {
    char color[RT_COLOR_CHARS];
    rt_candidate_color(experiment, c, color);
    if (strcmp(list, "accels") == 0) fprintf(out, "%s ", experiment->candidates[c].label);
    if (strcmp(list, "colors") == 0) fprintf(out, "%s ", color);
    if (strcmp(list, "markers") == 0) fprintf(out, "%d ", rt_plot_marker(c));
    if (strcmp(list, "dashes") == 0) fprintf(out, "%d ", rt_plot_dash(c));
    if (strcmp(list, "groups") == 0) fprintf(out, "\\\"%s\\\" ", experiment->candidates[c].group);
}

/* What style.gp says; labels hold nothing that gnuplot's double quotes would interpret
 * (rt_experiment_check). */
static void put_variables(const RtResults *results, const char *shared, const char *format, bool column,
                          FILE *out) {
    static const char *const lists[] = {"accels", "colors", "markers", "dashes", "groups"};
    const RtExperiment *experiment = results->experiment;
    fprintf(out, "shared = \"%s\"; experiment = \"%s\"; format = \"%s\"; paper = \"%s\"; scenes = \"", shared,
            experiment->name, format, column ? "column" : "page");
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (results->workloads[t].known) fprintf(out, "%s ", experiment->workloads[t].label);
    }
    fputs("\"; files = \"", out);
    for (uint32_t t = 0; t < experiment->workload_count; t++) {
        if (results->workloads[t].known) fprintf(out, "%s ", experiment->workloads[t].file_name);
    }
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        fprintf(out, "\"; %s = \"", lists[i]);
        for (uint32_t c = 0; c < experiment->candidate_count; c++) {
            if (has_rows(results, c)) put_candidate(experiment, c, lists[i], out);
        }
    }
    fprintf(out, "\"; without = \"%s\"; among = \"%s\"; kinds = \"", experiment->frame.without,
            experiment->frame.among);
    for (uint32_t k = 0; k < experiment->kind_count; k++) {
        if (has_rays(results, experiment->kinds[k]))
            fprintf(out, "%s ", rt_ray_kind_name(experiment->kinds[k]));
    }
    fputs("\"; sets = \"", out);
    put_sets(results, out);
    fputs("\"", out);
}

/* ---- gnuplot ---- */

/* Gnuplot's messages, for rt_free(). */
static RtStatus read_log(const char *directory, char **log, size_t *size, RtError *error) {
    enum { MOST_BYTES = 1 << 24 };
    char path[RT_MAX_PATH];
    RT_TRY(rt_path_join(directory, "plots/gnuplot.log", path, error));
    return rt_file_read(path, MOST_BYTES, log, size, error);
}

/* Reports the end of gnuplot's log, which names the script and the line; if it is empty, the scripts. */
static RtStatus fail_drawing(char **arguments, const char *directory, RtError *error) {
    enum { MOST_SHOWN = 600 };
    char scripts[MOST_SHOWN] = "", *log = NULL;
    size_t size = 0;
    for (char **script = arguments + 4; *script; script++) /* without those that are always there */
        rt_append_text(scripts, sizeof scripts, " %s", *script);
    RT_TRY(read_log(directory, &log, &size, error));
    while (size > 0 && isspace((unsigned char)log[size - 1])) log[--size] = '\0';
    const char *last = size > MOST_SHOWN ? log + size - MOST_SHOWN : log;
    while (isspace((unsigned char)*last)) last++;
    rt_fail(error, RT_MISMATCH, "%s: gnuplot failed%s%s", directory,
            *last ? ":\n" : " without a message; its scripts:", *last ? last : scripts);
    rt_free(log);
    return RT_MISMATCH;
}

/* Whether gnuplot drew without a file that it could not open, of which it only warns. */
static bool lacks_data(const char *directory) {
    char *log = NULL;
    size_t size;
    if (read_log(directory, &log, &size, NULL) != RT_OK) return true;
    const bool lacks = strstr(log, "Cannot find or open file");
    rt_free(log);
    return lacks;
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
    return end.code == 0 && !lacks_data(directory) ? RT_OK : fail_drawing(arguments, directory, error);
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

/* What is drawn: the variables of all formats, and the paths of the scripts. */
typedef struct Drawing {
    const RtResults *results;
    const char *directory;
    bool column;
    RtMemoryFile sweeps, axes; /* of sweeps.gp */
    char shared[RT_MAX_PATH];
    char scripts[MOST_SCRIPTS][RT_MAX_PATH];
    uint32_t script_count;
} Drawing;

static RtStatus draw(const Drawing *drawing, const char *format, RtError *error) {
    char program[] = "gnuplot", option[] = "-e";
    char *arguments[MOST_SCRIPTS + 4] = {program, option};
    RtMemoryFile variables;
    RT_TRY(rt_memory_file_open(&variables, error));
    put_variables(drawing->results, drawing->shared, format, drawing->column, variables.file);
    fprintf(variables.file, "; sweeps = \"%s\"; axes = \"%s\"", drawing->sweeps.data, drawing->axes.data);
    RT_TRY(rt_memory_file_close(&variables, "variables of plots", error));
    arguments[2] = variables.data;
    for (uint32_t i = 0; i < drawing->script_count; i++) arguments[3 + i] = (char *)drawing->scripts[i];
    settle(drawing->directory, format, false, NULL); /* of an interrupted drawing */
    RtStatus status = run_gnuplot(arguments, drawing->directory, error);
    if (status == RT_OK) status = settle(drawing->directory, format, true, error);
    if (status != RT_OK) settle(drawing->directory, format, false, NULL);
    rt_free(variables.data);
    return status;
}

static void add_shipped(Drawing *drawing, const char *name) {
    if (rt_scripts_shipped(name, drawing->scripts[drawing->script_count])) drawing->script_count++;
}

/* Whether any accelerator beside the baseline has a ratio to it. */
static bool has_ratios(const RtResults *results) {
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) {
        if (at.cell->timed && at.cell->baseline != at.candidate && isfinite(at.cell->ratio.median))
            return true;
    }
    return false;
}

/* How many accelerators have rows in counts.csv. */
static uint32_t count_counted(const RtResults *results) {
    bool counted[RT_MAX_CANDIDATES + 1] = {false};
    uint32_t count = 0;
    for (RtCellCursor at = {0}; rt_results_next(results, &at);) {
        const bool exact = at.cell->counted && rt_build_at(results, at.workload, at.candidate)->counts;
        count += exact && !counted[at.candidate];
        counted[at.candidate] |= exact;
    }
    return count;
}

static RtStatus choose_scripts(Drawing *drawing, RtScripts allowed, RtError *error) {
    const RtResults *results = drawing->results;
    const RtExperiment *experiment = results->experiment;
    RT_TRY(rt_scripts_folder(drawing->shared, error));
    add_shipped(drawing, "style.gp");
    for (uint32_t i = 0; i < experiment->plot_count; i++)
        rt_scripts_path(experiment, i, drawing->directory, allowed,
                        drawing->scripts[drawing->script_count++]);
    if (experiment->plot_count == 0) {
        if (*drawing->sweeps.data) {
            add_shipped(drawing, "sweeps.gp");
        } else {
            if (has_ratios(results)) add_shipped(drawing, "relative-time.gp");
            if (count_counted(results) > 1) add_shipped(drawing, "relative-counts.gp");
        }
    }
    if (experiment->distributions) add_shipped(drawing, "histograms.gp");
    return RT_OK;
}

/* The files that sweeps.gp reads, and its variables; they are empty if the experiment has scripts of its own.
 */
static RtStatus write_sweeps(Drawing *drawing, RtError *error) {
    RtStatus status = rt_memory_file_open(&drawing->sweeps, error);
    if (status == RT_OK) status = rt_memory_file_open(&drawing->axes, error);
    if (status == RT_OK && drawing->results->experiment->plot_count == 0)
        status = rt_sweep_data_write(drawing->results, drawing->directory, drawing->sweeps.file,
                                     drawing->axes.file, error);
    RtMemoryFile *const files[] = {&drawing->sweeps, &drawing->axes};
    for (int i = 0; i < 2; i++) {
        if (!files[i]->file) continue;
        RtStatus closed = rt_memory_file_close(files[i], "sweeps", status == RT_OK ? error : NULL);
        if (status == RT_OK) status = closed;
    }
    return status;
}

static RtStatus draw_all(Drawing *drawing, RtScripts allowed, RtError *error) {
    RtError reason;
    RT_TRY(write_sweeps(drawing, error));
    RT_TRY(choose_scripts(drawing, allowed, error));
    if (drawing->script_count == 1) return RT_OK; /* style.gp alone */
    RT_TRY(draw(drawing, "svg", error));
    /* If only PDF fails, this gnuplot does not support it. */
    draw(drawing, "pdf", &reason);
    return RT_OK;
}

RtStatus rt_plots_draw(const RtResults *results, const char *directory, RtScripts allowed, bool column,
                       RtError *error) {
    Drawing *drawing = rt_alloc(1, sizeof *drawing);
    if (!drawing) return rt_fail_memory(error, "plots", sizeof *drawing);
    *drawing = (Drawing){.results = results, .directory = directory, .column = column};
    RtStatus status = draw_all(drawing, allowed, error);
    rt_free(drawing->sweeps.data);
    rt_free(drawing->axes.data);
    rt_free(drawing);
    return status;
}

/* ---- captions ---- */

typedef struct Caption {
    const char *name;
    char *text; /* [RT_MAX_CAPTION] */
} Caption;

/* Of the lines "#: NAME: text", continued in lines "#:   text". */
static void take_caption(const Caption *caption, const char *script) {
    bool ours = false;
    for (const char *line = script; *line; line += strcspn(line, "\n"), line += *line == '\n') {
        if (strncmp(line, "#:", 2) != 0) continue;
        const char *text = line + 2 + strspn(line + 2, " ");
        if (strncmp(line, "#:   ", 5) != 0) {
            char name[RT_MAX_LABEL];
            const size_t length = strcspn(text, ":\n");
            snprintf(name, sizeof name, "%.*s", (int)length, text);
            ours = text[length] == ':' && fnmatch(name, caption->name, 0) == 0;
            text += ours ? length + 1 + strspn(text + length + 1, " ") : 0;
        }
        if (ours)
            rt_append_text(caption->text, RT_MAX_CAPTION, "%s%.*s", *caption->text ? " " : "",
                           (int)strcspn(text, "\n"), text);
    }
}

static void look_for_caption(void *context, const char *path) {
    enum { MOST_BYTES = 1 << 24 };
    const Caption *caption = context;
    char *script;
    size_t size;
    if (*caption->text || rt_file_read(path, MOST_BYTES, &script, &size, NULL) != RT_OK) return;
    take_caption(caption, script);
    rt_free(script);
}

void rt_plot_caption(const RtExperiment *experiment, const char *directory, const char *name,
                     char text[RT_MAX_CAPTION]) {
    static const char *const standard[] = {"sweeps.gp", "relative-time.gp", "relative-counts.gp",
                                           "histograms.gp"};
    char path[RT_MAX_PATH];
    Caption caption = {name, text};
    *text = '\0';
    if (rt_path_join(directory, "plots", path, NULL) == RT_OK)
        rt_directory_each(path, ".gp", look_for_caption, &caption);
    for (uint32_t i = 0; i < experiment->plot_count; i++) {
        if (rt_scripts_shipped(rt_plot_name(experiment, i), path)) look_for_caption(&caption, path);
    }
    for (size_t i = 0; i < sizeof standard / sizeof standard[0]; i++) {
        if (rt_scripts_shipped(standard[i], path)) look_for_caption(&caption, path);
    }
}
