/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/callgrind.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "core/base/process.h"
#include "core/base/words.h"
#include "core/text/json_lines.h"
#include "experiment/result_tables.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* ---- the folder ---- */

RtStatus rt_callgrind_init(RtCallgrind *callgrind, const RtExperiment *experiment, uint64_t most,
                           RtError *error) {
    const char *place = getenv("TMPDIR");
    *callgrind = (RtCallgrind){.experiment = experiment, .most = most};
    RT_TRY(rt_path_join(place && *place ? place : "/tmp", "raytally-callgrind-XXXXXX", callgrind->folder,
                        error));
    if (mkdtemp(callgrind->folder)) return RT_OK;
    RtStatus status = rt_fail(error, RT_IO, "%s: no temporary folder can be created: %s", callgrind->folder,
                              strerror(errno));
    callgrind->folder[0] = '\0';
    return status;
}

static void remove_file(void *context, const char *path) {
    (void)context;
    remove(path);
}

void rt_callgrind_clear(RtCallgrind *callgrind) {
    if (*callgrind->folder) {
        rt_directory_each(callgrind->folder, "", remove_file, NULL);
        rmdir(callgrind->folder);
    }
    rt_free(callgrind->cells);
    *callgrind = (RtCallgrind){0};
}

static RtStatus path_of(const RtCallgrind *callgrind, const char *name, char *path, RtError *error) {
    return rt_path_join(callgrind->folder, name, path, error);
}

/* ---- the child ---- */

static RtStatus run_valgrind(char *const *arguments, const char *out, const char *log, RtProcessEnd *end,
                             RtError *error) {
    const RtCommand command = {.arguments = arguments, .out = out, .log = log};
    RtStatus status = rt_process_run(&command, end, error);
    if (status != RT_NOT_AVAILABLE) return status;
    return rt_fail(error, status,
                   "valgrind is not installed: the package of that name (`apt install valgrind`) counts the "
                   "instructions of a ray where the processor's own counters are not available");
}

RtStatus rt_callgrind_check(RtError *error) {
    char valgrind[] = "valgrind", version[] = "--version", *arguments[] = {valgrind, version, NULL};
    RtProcessEnd end;
    RT_TRY(run_valgrind(arguments, "/dev/null", "/dev/null", &end, error));
    return end.code == 0 ? RT_OK : rt_fail(error, RT_NOT_AVAILABLE, "`valgrind --version` fails");
}

/* The end of the child's messages. */
static RtStatus fail_child(const char *log, RtError *error) {
    enum { MOST_BYTES = 1 << 24, MOST_SHOWN = 600 };
    char *text = NULL;
    size_t size = 0;
    RT_TRY(rt_file_read(log, MOST_BYTES, &text, &size, error));
    while (size > 0 && isspace((unsigned char)text[size - 1])) text[--size] = '\0';
    rt_fail(error, RT_NOT_AVAILABLE, "valgrind, or raytally in it, failed:\n%s",
            size > MOST_SHOWN ? text + size - MOST_SHOWN : text);
    rt_free(text);
    return RT_NOT_AVAILABLE;
}

/* ---- its results ---- */

/* Reads the sum of costs from file number `n` of callgrind, from 1. */
static RtStatus read_total(const RtCallgrind *callgrind, uint32_t n, uint64_t *total, RtError *error) {
    char path[RT_MAX_PATH], name[32], *text;
    size_t size;
    snprintf(name, sizeof name, "out.%" PRIu32, n);
    RT_TRY(path_of(callgrind, name, path, error));
    if (!rt_file_exists(path))
        return rt_fail(error, RT_NOT_AVAILABLE,
                       "callgrind counted nothing: is the program stripped of its symbols?");
    RT_TRY(rt_file_read(path, (size_t)1 << 30, &text, &size, error));
    const char *at = strstr(text, "\ntotals: ");
    bool found = at && sscanf(at, "\ntotals: %" SCNu64, total) == 1;
    rt_free(text);
    return found ? RT_OK : rt_fail(error, RT_NOT_AVAILABLE, "%s: callgrind wrote no sum of costs", path);
}

static void copy_text(char *out, size_t size, const json_t *line, const char *key) {
    const char *text = json_string_value(json_object_get(line, key));
    snprintf(out, size, "%s", text ? text : "");
}

/* Takes one cell; the last of its passes counts. */
static RtStatus take_line(RtCallgrind *callgrind, const json_t *line, uint32_t *passes, RtError *error) {
    const RtExperiment *e = callgrind->experiment;
    char scene[RT_MAX_LABEL], accel[RT_MAX_LABEL], kind[RT_MAX_LABEL];
    RtInstructions *cell = &callgrind->cells[callgrind->count];
    copy_text(scene, sizeof scene, line, "scene");
    copy_text(accel, sizeof accel, line, "accel");
    copy_text(kind, sizeof kind, line, "kind");
    copy_text(cell->spec, sizeof cell->spec, line, "spec");
    copy_text(cell->why, sizeof cell->why, line, "why");
    cell->workload = rt_workload_find(e, scene);
    cell->rays = (uint64_t)json_integer_value(json_object_get(line, "rays"));
    if (cell->workload == e->workload_count || rt_ray_kind_parse(kind, &cell->kind, NULL) != RT_OK)
        return rt_fail(error, RT_BAD_INPUT, "raytally under valgrind printed an unknown row");
    cell->candidate = rt_candidate_find(e, accel, cell->workload);
    *passes += (uint32_t)json_integer_value(json_object_get(line, "passes"));
    if (!*cell->why) {
        RT_TRY(read_total(callgrind, *passes, &cell->instructions, error));
    }
    callgrind->count +=
        cell->candidate < e->candidate_count; /* else a setting that only the child could build */
    return RT_OK;
}

static RtStatus take_lines(RtCallgrind *callgrind, const char *path, RtError *error) {
    json_t *lines;
    uint32_t passes = 0;
    RT_TRY(rt_json_lines_load(path, &lines, error));
    callgrind->cells = rt_alloc(json_array_size(lines), sizeof(RtInstructions));
    RtStatus status = callgrind->cells ? RT_OK : rt_fail_memory(error, "counts of instructions", 0);
    for (size_t i = 0; i < json_array_size(lines) && status == RT_OK; i++)
        status = take_line(callgrind, json_array_get(lines, i), &passes, error);
    json_decref(lines);
    return status;
}

RtStatus rt_callgrind_save_broken(const RtCallgrind *callgrind, const RtResults *results, RtError *error) {
    const RtExperiment *e = callgrind->experiment;
    const uint32_t count = e->workload_count * e->candidate_count * e->kind_count;
    char path[RT_MAX_PATH];
    RT_TRY(path_of(callgrind, RT_CALLGRIND_BROKEN, path, error));
    json_t *lines = json_array();
    for (uint32_t i = 0; i < count; i++) {
        const uint32_t t = i / e->kind_count / e->candidate_count, c = i / e->kind_count % e->candidate_count;
        const RtRayKind kind = e->kinds[i % e->kind_count];
        const RtBuildResult *build = rt_build_at(results, t, c);
        const RtCell *cell = rt_cell_at(results, t, c, kind);
        if (!build->broken && !cell->broken) continue;
        json_array_append_new(lines,
                              json_pack("{s:s, s:s, s:s, s:s}", "scene", e->workloads[t].label, "accel",
                                        e->candidates[c].label, "kind", rt_ray_kind_name(kind), "why",
                                        build->broken ? build->limit : cell->limit));
    }
    RtStatus status = json_array_size(lines) ? rt_json_lines_save(path, lines, error) : RT_OK;
    json_decref(lines);
    return status;
}

RtStatus rt_callgrind_run(RtCallgrind *callgrind, char *const *arguments, RtError *error) {
    char program[RT_MAX_PATH], rows[RT_MAX_PATH], log[RT_MAX_PATH], out[RT_MAX_PATH];
    char out_file[RT_MAX_PATH + 32], valgrind[] = "valgrind", tool[] = "--tool=callgrind";
    char off[] = "--collect-atstart=no", toggle[] = "--toggle-collect=rt_callgrind_pass";
    char dump[] = "--dump-after=rt_callgrind_pass";
    char *const options[] = {valgrind, tool, off, toggle, dump, out_file, program};
    const size_t option_count = sizeof options / sizeof options[0];
    size_t count = 0;
    RtProcessEnd end;
    ssize_t length = readlink("/proc/self/exe", program, sizeof program - 1);
    if (length < 0) return rt_fail(error, RT_IO, "/proc/self/exe: %s", strerror(errno));
    program[length] = '\0';
    RT_TRY(path_of(callgrind, "rows", rows, error));
    RT_TRY(path_of(callgrind, "log", log, error));
    RT_TRY(path_of(callgrind, "out", out, error));
    snprintf(out_file, sizeof out_file, "--callgrind-out-file=%s", out);
    while (arguments[count]) count++;
    char **all = rt_alloc(option_count + count + 1, sizeof(char *));
    if (!all) return rt_fail_memory(error, "arguments", count * sizeof(char *));
    memcpy(all, options, sizeof options);
    memcpy(all + option_count, arguments, count * sizeof(char *));
    RtStatus status = run_valgrind(all, rows, log, &end, error);
    rt_free(all);
    RT_TRY(status);
    return end.code == 0 ? take_lines(callgrind, rows, error) : fail_child(log, error);
}

/* ---- tables ---- */

typedef RtInstructionsRow Row;

static double a_ray(const Row *r) {
    return *r->cell->why ? (double)NAN : (double)r->cell->instructions / (double)r->cell->rays;
}

static RtField why_of(const Row *r) {
    return *r->cell->why ? rt_field_text(r->cell->why) : rt_field_missing();
}

static RtField isa_of(const Row *r) {
    const char *isa = strstr(r->cell->spec, "isa=");
    return isa ? rt_field_print("%.*s", (int)strcspn(isa + 4, ",+"), isa + 4) : rt_field_missing();
}

#define COLUMNS(X)                                                                                           \
    X(scene, "scene", text, "", "the scene's label",                                                         \
      r->callgrind->experiment->workloads[r->cell->workload].label)                                          \
    X(kind, "kind", text, "", "kind of the rays",                                                            \
      rt_experiment_kind_name(r->callgrind->experiment, r->cell->kind))                                      \
    X(accel, "accelerator", text, "", "the accelerator's label",                                             \
      rt_candidate_label(r->callgrind->experiment, r->cell->candidate))                                      \
    X(spec, "accel", text, "", "the accelerator as built under valgrind, which has no AVX-512",              \
      r->cell->spec)                                                                                         \
    X(rays, "rays", integer, "", "rays that were traced, of those recorded", r->cell->rays)                  \
    X(instructions, "instructions", integer, "", "instructions of all these rays, by callgrind: exact",      \
      *r->cell->why ? rt_field_missing() : rt_field_integer(r->cell->instructions))                          \
    X(instructions_per_ray, "instructions_per_ray", real6, "", "instructions per ray", a_ray(r))             \
    X(why, "why", text, "", "why instructions are unknown; else empty", why_of(r))                           \
    X(eye, "instr./ray", figure, "", "instructions per ray", a_ray(r))                                       \
    X(isa, "isa", text, "", "the instruction set, for accelerators that choose one", isa_of(r))

RT_TABLE_COLUMNS(columns, COLUMNS)

static const RtColumnGroup json_groups[] = {RT_FROM_TO(columns, scene, why)};
static const RtColumnGroup eye_groups[] = {RT_FROM_TO(columns, scene, accel), RT_ONE(columns, rays),
                                           RT_FROM_TO(columns, eye, isa)};

static const void *row_at(void *context, size_t i) {
    Row *r = context;
    r->cell = &r->callgrind->cells[i];
    return r;
}

RtTable rt_instructions_table(RtInstructionsRow *row) {
    return (RtTable){RT_GROUPS(json_groups), .row_count = row->callgrind->count, .row = row_at,
                     .context = row};
}

void rt_print_instructions(const RtCallgrind *callgrind, FILE *out) {
    Row row = {.callgrind = callgrind};
    const RtTable table = {RT_GROUPS(eye_groups), .row_count = callgrind->count, .row = row_at,
                           .context = &row};
    fputc('\n', out);
    rt_print_wrapped(
        "Instructions per ray, by valgrind's callgrind: exact, the same on every run. Valgrind has no "
        "AVX-512; the last column names the instruction set that was used.",
        out);
    fputc('\n', out);
    rt_table_text(&table, out);
    for (uint32_t i = 0; i < callgrind->count; i++) {
        const RtInstructions *cell = &callgrind->cells[i];
        char text[RT_MAX_LABEL + RT_MAX_WHY + 8];
        if (!*cell->why || (i > 0 && strcmp(cell->why, cell[-1].why) == 0)) continue;
        snprintf(text, sizeof text, "%s: %s", rt_candidate_label(callgrind->experiment, cell->candidate),
                 cell->why);
        rt_print_wrapped(text, out);
    }
}
