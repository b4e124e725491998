/* SPDX-License-Identifier: Apache-2.0 */
#include "run/callgrind.h"

#include "core/base/words.h"
#include "measure/measure.h"
#include "results/result_tables.h"
#include "run/worker.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
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

void rt_callgrind_clear(RtCallgrind *callgrind) {
    if (*callgrind->folder) {
        rt_directory_remove_files(callgrind->folder, "");
        rmdir(callgrind->folder);
    }
    rt_free(callgrind->cells);
    *callgrind = (RtCallgrind){0};
}

RtStatus rt_callgrind_check(RtError *error) {
    char valgrind[] = "valgrind", version[] = "--version", *arguments[] = {valgrind, version, NULL};
    const RtProcessCommand command = {.arguments = arguments, .out = "/dev/null", .log = "/dev/null"};
    RtProcessEnd end;
    RtStatus status = rt_process_run(&command, &end, error);
    if (status == RT_NOT_AVAILABLE)
        return rt_fail(error, status,
                       "valgrind is not installed: the package of that name (`apt install valgrind`) counts "
                       "the instructions of a ray where the processor's own counters are not available");
    RT_TRY(status);
    return end.code == 0 ? RT_OK : rt_fail(error, RT_NOT_AVAILABLE, "`valgrind --version` fails");
}

/* ---- rays for the worker ---- */

static RtStatus rays_path(const RtCallgrind *callgrind, uint32_t workload, RtRayKind kind, char *path,
                          RtError *error) {
    char name[64];
    snprintf(name, sizeof name, "%" PRIu32 "-%s.rays", workload, rt_ray_kind_name(kind));
    return rt_path_join(callgrind->folder, name, path, error);
}

RtStatus rt_callgrind_save_rays(void *context, uint32_t workload, const RtRaySet *set, const RtAccel *exact,
                                RtError *error) {
    enum { RUN = 64 }; /* neighbours, so that packets are coherent */
    const RtCallgrind *callgrind = context;
    RT_ARENA(arena);
    char path[RT_MAX_PATH];
    RT_OWNED(RtRaySet, some, rt_rayset_clear);
    RtOutput output;
    RT_TRY(rays_path(callgrind, workload, set->kind, path, error));
    RT_TRY(rt_rayset_limit(set, callgrind->most, RUN, &some, error));
    RtHit *hits = rt_arena_alloc(&arena, some.count, sizeof(RtHit));
    RT_TRY(rt_arena_check(&arena, "answers", error));
    RT_TRY(rt_measure_answers(exact, &some, 1, hits, error));
    RT_TRY(rt_output_open(&output, path, error));
    fwrite(some.rays, sizeof(RtRay), some.count, output.file);
    fwrite(hits, sizeof(RtHit), some.count, output.file);
    return rt_output_commit(&output, error);
}

/* ---- counting ---- */

/* Reads the sum of costs from file number `n` of callgrind, from 1. */
static RtStatus read_total(const RtCallgrind *callgrind, uint32_t n, uint64_t *total, RtError *error) {
    char path[RT_MAX_PATH], name[32], *text;
    size_t size;
    snprintf(name, sizeof name, "out.%" PRIu32, n);
    RT_TRY(rt_path_join(callgrind->folder, name, path, error));
    if (!rt_file_exists(path))
        return rt_fail(error, RT_NOT_AVAILABLE,
                       "callgrind counted nothing: is the program stripped of its symbols?");
    RT_TRY(rt_file_read(path, (size_t)1 << 30, &text, &size, error));
    remove(path); /* another program writes a file of that name, too */
    const char *at = strstr(text, "\ntotals: ");
    bool found = at && sscanf(at, "\ntotals: %" SCNu64, total) == 1;
    rt_free(text);
    return found ? RT_OK : rt_fail(error, RT_NOT_AVAILABLE, "%s: callgrind wrote no sum of costs", path);
}

/* Takes the answer about one cell; the last of its passes counts. */
static RtStatus take_answer(RtCallgrind *callgrind, const json_t *answer, RtInstructions cell,
                            uint32_t *passes, RtError *error) {
    if (json_object_size(answer) == 0) return RT_OK; /* a setting that cannot be built under valgrind */
    snprintf(cell.spec, sizeof cell.spec, "%s", rt_json_text(answer, "spec", ""));
    snprintf(cell.why, sizeof cell.why, "%s", rt_json_text(answer, "why", ""));
    cell.rays = (uint64_t)json_integer_value(json_object_get(answer, "rays"));
    *passes += (uint32_t)json_integer_value(json_object_get(answer, "passes"));
    if (!*cell.why) RT_TRY(read_total(callgrind, *passes, &cell.instructions, error));
    callgrind->cells[callgrind->count++] = cell;
    return RT_OK;
}

/* A run of the worker, and what starts it again. */
typedef struct Session {
    RtCallgrind *callgrind;
    char *const *arguments;
    bool other; /* not this program */
    char program[RT_MAX_PATH], log[RT_MAX_PATH], out_file[RT_MAX_PATH + 32];
    RtWorker worker;
    uint32_t passes; /* of this worker so far */
} Session;

static RtStatus start(Session *session, RtError *error) {
    const char *const command[] = {"valgrind",
                                   "--tool=callgrind",
                                   "--collect-atstart=no",
                                   "--toggle-collect=rt_callgrind_pass",
                                   "--dump-after=rt_callgrind_pass",
                                   session->out_file,
                                   session->program,
                                   "bench",
                                   "--worker",
                                   NULL};
    session->passes = 0;
    session->worker = (RtWorker){
        .log = session->log,
        .failure = session->other
                       ? "the other program cannot count instructions: it must be a raytally whose `bench` "
                         "has --callgrind and the options given here"
                       : "valgrind, or raytally in it, failed"};
    return rt_worker_start(&session->worker, command, session->arguments, error);
}

/* A plugin has ended the worker, in whose process it runs: only its own cell is lost. */
static RtStatus go_on_without(Session *session, RtInstructions cell, RtError *error) {
    snprintf(cell.why, sizeof cell.why, "%s",
             session->worker.end.signal == SIGILL
                 ? "it has instructions that valgrind lacks, such as AVX-512: compile it without them"
                 : "it crashed under valgrind");
    session->callgrind->cells[session->callgrind->count++] = cell;
    rt_worker_end(&session->worker);
    return start(session, error);
}

/* An accelerator that is left out is not built again: it may have broken, and would end the worker. */
static RtStatus count_cell(Session *session, const RtResults *results, const RtCellCursor *at,
                           RtError *error) {
    RtCallgrind *callgrind = session->callgrind;
    const RtExperiment *e = callgrind->experiment;
    const RtCandidate *candidate = &e->candidates[at->candidate];
    const RtBuildResult *build = rt_build_at(results, at->workload, at->candidate);
    RtInstructions cell = {.workload = at->workload, .candidate = at->candidate, .kind = at->kind};
    char path[RT_MAX_PATH];
    json_auto_t *answer = NULL;
    RT_TRY(rays_path(callgrind, at->workload, at->kind, path, error));
    if (!rt_candidate_runs(e, at->candidate, at->workload) || !rt_file_exists(path)) return RT_OK;
    if (*build->left_out || *at->cell->left_out) {
        snprintf(cell.why, sizeof cell.why, "%.*s", RT_MAX_WHY - 1,
                 *build->left_out ? build->left_out : at->cell->left_out);
        callgrind->cells[callgrind->count++] = cell;
        return RT_OK;
    }
    RtError failure;
    RtStatus status = rt_worker_ask(&session->worker, &answer, &failure, "count %" PRIu32 " %s %s %s\n",
                                    at->workload, rt_ray_kind_name(at->kind), candidate->label, path);
    if (status != RT_OK && rt_spec_is_remote(&candidate->parsed)) return go_on_without(session, cell, error);
    if (status != RT_OK) return rt_fail(error, status, "%s", failure.message);
    return take_answer(callgrind, answer, cell, &session->passes, error);
}

RtStatus rt_callgrind_run(RtCallgrind *callgrind, const char *program, const RtResults *results,
                          char *const *arguments, RtError *error) {
    const RtExperiment *e = callgrind->experiment;
    const size_t cells = (size_t)e->workload_count * e->candidate_count * e->kind_count;
    char out[RT_MAX_PATH];
    Session session = {.callgrind = callgrind, .arguments = arguments, .other = program != NULL};
    if (!program) program = "/proc/self/exe"; /* valgrind has its own */
    if (!realpath(program, session.program)) return rt_fail(error, RT_IO, "%s: %s", program, strerror(errno));
    RT_TRY(rt_path_join(callgrind->folder, "log", session.log, error));
    RT_TRY(rt_path_join(callgrind->folder, "out", out, error));
    snprintf(session.out_file, sizeof session.out_file, "--callgrind-out-file=%s", out);
    rt_free(callgrind->cells);
    callgrind->count = 0;
    callgrind->cells = rt_alloc(cells, sizeof(RtInstructions));
    if (!callgrind->cells) return rt_fail_memory(error, "counts of instructions", 0);
    RtStatus status = start(&session, error);
    for (RtCellCursor at = {0}; status == RT_OK && rt_results_next(results, &at);)
        status = count_cell(&session, results, &at, error);
    rt_worker_end(&session.worker);
    return status;
}

/* ---- tables ---- */

typedef RtInstructionsRow Row;

static double a_ray(const Row *r) {
    return *r->cell->why ? (double)NAN : (double)r->cell->instructions / (double)r->cell->rays;
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
    X(eye_accel, "accelerator", text, "", "the accelerator's label",                                         \
      rt_candidate_label(r->callgrind->experiment, r->cell->candidate))                                      \
    X(accel, "accel", text, "", "the accelerator's label",                                                   \
      rt_candidate_label(r->callgrind->experiment, r->cell->candidate))                                      \
    X(spec, "spec", text, "", "the accelerator as built under valgrind, which has no AVX-512",               \
      r->cell->spec)                                                                                         \
    X(rays, "rays", integer, "", "rays that were traced, of those recorded", r->cell->rays)                  \
    X(instructions, "instructions", integer, "", "instructions of all these rays, by callgrind: exact",      \
      *r->cell->why ? rt_field_missing() : rt_field_integer(r->cell->instructions))                          \
    X(instructions_per_ray, "instructions_per_ray", real6, "", "instructions per ray", a_ray(r))             \
    X(why, "why", text, "", "why instructions are unknown; else empty", *r->cell->why ? r->cell->why : NULL) \
    X(eye, "instr./ray", figure, "", "instructions per ray", a_ray(r))                                       \
    X(isa, "isa", text, "", "the instruction set, for accelerators that choose one", isa_of(r))

RT_TABLE_COLUMNS(columns, COLUMNS)

static const RtColumnGroup json_groups[] = {RT_FROM_TO(columns, scene, kind),
                                            RT_FROM_TO(columns, accel, why)};
static const RtColumnGroup eye_groups[] = {RT_FROM_TO(columns, scene, eye_accel), RT_ONE(columns, rays),
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
