/* SPDX-License-Identifier: Apache-2.0 */
#include "run/worker.h"

#include "accel/columns.h"
#include "accel/isa.h"
#include "accel/plugin.h"
#include "measure/measure.h"
#include "run/workload_state.h"

#include <ctype.h>
#include <errno.h>
#include <inttypes.h>
#include <sched.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <unistd.h>

/* ---- the program that starts it ---- */

RtStatus rt_worker_start(RtWorker *worker, const char *const *command, char *const *arguments,
                         RtError *error) {
    RT_ARENA(arena);
    size_t words = 0, count = 0;
    while (command[words]) words++;
    while (arguments[count]) count++;
    char **all = rt_arena_alloc(&arena, words + count + 1, sizeof(char *));
    RT_TRY(rt_arena_check(&arena, "arguments", error));
    memcpy(all, command, words * sizeof(char *));
    memcpy(all + words, arguments, count * sizeof(char *));
    const RtProcessCommand run = {.program = worker->program,
                                  .arguments = all,
                                  .log = worker->log,
                                  .to = &worker->to,
                                  .from = &worker->from};
    signal(SIGPIPE, SIG_IGN); /* a worker that has ended sends no answer */
    return rt_process_spawn(&worker->process, &run, error);
}

/* With the end of the log. */
static RtStatus fail_ended(RtWorker *worker, RtError *error) {
    enum { MOST_BYTES = 1 << 24, MOST_SHOWN = 600 };
    char how[160] = "it no longer answers", *text;
    size_t size;
    if (rt_process_wait(&worker->process, 1000, &worker->end))
        rt_process_end_format(worker->end, 0, "", how, sizeof how);
    if (!worker->log)
        return rt_fail(error, RT_BAD_INPUT, "%s cannot be compared: %s; its messages are above",
                       worker->program, how);
    RT_TRY(rt_file_read(worker->log, MOST_BYTES, &text, &size, error));
    while (size > 0 && isspace((unsigned char)text[size - 1])) text[--size] = '\0';
    rt_fail(error, RT_NOT_AVAILABLE, "%s: %s\n%s", worker->failure, how,
            size > MOST_SHOWN ? text + size - MOST_SHOWN : text);
    rt_free(text);
    return RT_NOT_AVAILABLE;
}

RtStatus rt_worker_take(RtWorker *worker, json_t **line, RtError *error) {
    char *text = NULL;
    size_t size = 0;
    *line = NULL;
    if (getline(&text, &size, worker->from) > 0) *line = json_loads(text, JSON_DECODE_ANY, NULL);
    free(text);
    return *line ? RT_OK : fail_ended(worker, error);
}

RtStatus rt_worker_ask(RtWorker *worker, json_t **answer, RtError *error, const char *request, ...) {
    va_list arguments;
    va_start(arguments, request);
    bool sent = vfprintf(worker->to, request, arguments) >= 0 && fflush(worker->to) == 0;
    va_end(arguments);
    if (!sent) return fail_ended(worker, error);
    return answer ? rt_worker_take(worker, answer, error) : RT_OK;
}

void rt_worker_end(RtWorker *worker) {
    enum { MILLISECONDS = 60000 }; /* to finish a run, and clear */
    if (worker->to) fclose(worker->to);
    if (worker->from) fclose(worker->from);
    rt_process_end(&worker->process, MILLISECONDS);
    *worker = (RtWorker){0};
}

/* ---- the worker: requests and answers ---- */

enum { MOST_LINE = RT_MAX_PATH + RT_MAX_LABEL + 256 }; /* characters of a request */

typedef struct Server {
    const RtExperiment *experiment;
    FILE *out;
    bool closed; /* the input has ended */
} Server;

static bool take_request(Server *server, char line[MOST_LINE]) {
    server->closed = !fgets(line, MOST_LINE, stdin);
    return !server->closed;
}

static RtStatus fail_request(const char *line, RtError *error) {
    return rt_fail(error, RT_BAD_INPUT, "not a request to a worker: %.40s", line);
}

static void say(Server *server, json_t *line) {
    json_dumpf(line, server->out, JSON_COMPACT);
    fputc('\n', server->out);
    fflush(server->out);
    json_decref(line);
}

/* ---- times ---- */

/* The candidates to be timed on these rays, with their counts. */
static json_t *section_json(const RtWorkloadState *workload, RtRayKind kind) {
    const RtExperiment *e = workload->experiment;
    const RtRaySet *set = &workload->sets[kind];
    json_t *cells = json_array();
    for (uint32_t c = 0; c < workload->count; c++) {
        if (!workload->accels[c]) continue;
        const RtCell *cell = rt_cell_at(workload->results, workload->index, c, kind);
        json_array_append_new(cells,
                              json_pack("{s:s, s:s, s:o, s:b}", "accel", rt_candidate_label(e, c), "spec",
                                        rt_build_at(workload->results, workload->index, c)->spec, "counts",
                                        rt_json_tally(&cell->tally), "exact", workload->accels[c]->counts));
    }
    return json_pack("{s:s, s:s, s:I, s:o, s:o}", "scene", e->workloads[workload->index].label, "kind",
                     rt_experiment_kind_name(e, kind), "rays", (json_int_t)set->count, "hash",
                     rt_json_hex(set->fingerprint), "cells", cells);
}

/* Keeps this thread on one of the processors it may use. */
static void pin(const cpu_set_t *allowed, uint32_t number) {
    cpu_set_t one;
    number %= (uint32_t)CPU_COUNT(allowed);
    CPU_ZERO(&one);
    for (size_t i = 0; i < CPU_SETSIZE; i++) {
        if (CPU_ISSET(i, allowed) && number-- == 0) CPU_SET(i, &one);
    }
    sched_setaffinity(0, sizeof one, &one);
}

static RtStatus serve_runners(Server *server, const RtRunner *runners, uint32_t count, RtError *error) {
    char line[MOST_LINE];
    cpu_set_t allowed;
    uint32_t number, repeats;
    double seconds, wall;
    RtStatus status = RT_OK;
    bool pinned = sched_getaffinity(0, sizeof allowed, &allowed) == 0;
    while (status == RT_OK) {
        if (!take_request(server, line)) status = rt_fail(error, RT_IO, "the input has ended");
        if (server->closed || strcmp(line, "next\n") == 0) break;
        if (sscanf(line, "pin %" SCNu32, &number) == 1) {
            if (pinned) pin(&allowed, number);
        } else if (sscanf(line, "time %" SCNu32 " %" SCNu32, &number, &repeats) == 2 && number < count &&
                   repeats > 0) {
            status = rt_runner_time(&runners[number], repeats, &seconds, &wall, error);
            if (status == RT_OK) fprintf(server->out, "%.17g\n", seconds / (repeats * runners[number].work));
            fflush(server->out);
        } else {
            status = fail_request(line, error);
        }
    }
    if (pinned) sched_setaffinity(0, sizeof allowed, &allowed);
    return status;
}

static RtStatus serve_kind(void *context, RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    Server *server = context;
    RtRunner runners[RT_MAX_MEASURED];
    RtStatus status = RT_OK;
    uint32_t count = 0;
    for (uint32_t c = 0; c < workload->count && status == RT_OK; c++) {
        RtTimed timed = {.accel = workload->accels[c], .set = &workload->shares[c].set};
        if (timed.accel) status = rt_runner_open(&runners[count++], &timed, workload->options->timing, error);
    }
    if (status == RT_OK) {
        say(server, section_json(workload, kind));
        status = serve_runners(server, runners, count, error);
    }
    for (uint32_t i = 0; i < count; i++) rt_runner_close(&runners[i]);
    return status;
}

static RtStatus serve_times(Server *server, const RtWorkloadOptions *options, RtError *error) {
    RtWorkloadOptions how = *options;
    RT_OWNED(RtResults, results, rt_results_clear);
    how.timer = serve_kind;
    how.timer_context = server;
    say(server, json_pack("{s:i, s:s}", "worker", 1, "build", rt_build_identity()));
    RtStatus status = rt_results_init(&results, server->experiment, error);
    if (status == RT_OK) status = rt_workloads_run(&results, &how, error);
    if (status == RT_OK) say(server, json_pack("{s:b}", "done", 1));
    return server->closed ? RT_OK : status;
}

/* ---- counts of instructions ---- */

enum { PASSES = 2 }; /* the first includes one-time work */

/* The function that callgrind counts, by its name. */
__attribute__((noinline, visibility("default"))) RtStatus rt_callgrind_pass(const RtRunner *runner,
                                                                            RtError *error);
RtStatus rt_callgrind_pass(const RtRunner *runner, RtError *error) {
    RtStatus status = runner->run(runner->context, error);
    __asm__ volatile("" ::: "memory"); /* no tail call: the function must end after the pass */
    return status;
}

/* Replaces instruction sets that are not available here, and `best`, by the name of the best one. */
static void settle_isa(RtSpec *spec) {
    const char *best = rt_isa_name(rt_isa_best());
    for (uint32_t i = 0; i < spec->layer_count; i++) {
        RtSpecLayer *layer = &spec->layers[i];
        for (size_t p = 0; p < layer->ops->param_count; p++) {
            const RtParam *param = &layer->ops->params[p];
            char text[RT_MAX_SPEC_CHARS];
            if (strcmp(param->name, "isa") != 0) continue;
            rt_param_format(param, layer->values[p], text, sizeof text);
            if (strcmp(text, "best") != 0 && strcmp(text, "default") != 0 && strcmp(text, "avx512") != 0)
                continue;
            for (uint32_t n = 0; rt_param_try(param, n, text, sizeof text); n++) {
                if (strcmp(text, best) == 0) layer->values[p].choice = n;
            }
        }
    }
}

/* The scene and the accelerator of the last request. */
typedef struct Counting {
    RtScene scene;
    RtAccel *accel;
    uint32_t workload, candidate; /* those of `scene` and `accel`; the experiment's counts: none */
} Counting;

static RtStatus open_scene(Counting *counting, const RtExperiment *e, uint32_t t, RtError *error) {
    const RtWorkload *setup = &e->workloads[t];
    if (counting->workload == t) return RT_OK;
    rt_accel_destroy(counting->accel);
    counting->accel = NULL;
    counting->workload = t;
    rt_scene_clear(&counting->scene);
    RT_TRY(rt_workload_open_scene(setup, &counting->scene, error));
    return rt_scene_sample(&counting->scene, setup->width, setup->height, 1, setup->corners, error);
}

/* Callgrind sees this process, so plugins run in it, too. */
static RtStatus open_accel(Counting *counting, const RtSpec *spec, uint32_t c, RtError *error) {
    if (counting->accel && counting->candidate == c) return RT_OK;
    rt_accel_destroy(counting->accel);
    counting->accel = NULL;
    counting->candidate = c;
    RT_TRY(rt_plugin_enter(spec, error));
    return rt_accel_build_here(spec, &counting->scene, 1, &counting->accel, error);
}

/* Answers a request about candidate `c` and the rays of a kind in the file at `path`. */
static RtStatus answer_count(Server *server, Counting *counting, uint32_t c, RtRayKind kind, const char *path,
                             RtError *error) {
    RtSpec spec = server->experiment->candidates[c].parsed;
    RtRunner runner = {0};
    char text[RT_MAX_SPEC_CHARS], *data;
    size_t size;
    int passes = 0;
    RtError why;
    RT_TRY(rt_file_read(path, SIZE_MAX / 2, &data, &size, error));
    const uint64_t count = size / (sizeof(RtRay) + sizeof(RtHit));
    const RtRaySet set = {.kind = kind, .count = count, .rays = (RtRay *)data};
    settle_isa(&spec);
    rt_spec_format(&spec, text);
    RtStatus status = open_accel(counting, &spec, c, &why);
    const RtTimed timed = {.accel = counting->accel, .set = &set};
    if (status == RT_OK)
        status = rt_accel_learn(counting->accel, set.rays, (const RtHit *)(set.rays + count), count, &why);
    if (status == RT_OK) status = rt_runner_open(&runner, &timed, 1, &why);
    for (; passes < PASSES && status == RT_OK; passes++) status = rt_callgrind_pass(&runner, &why);
    rt_runner_close(&runner);
    say(server, status == RT_OK
                    ? json_pack("{s:i, s:s, s:I}", "passes", passes, "spec", text, "rays", (json_int_t)count)
                    : json_pack("{s:i, s:s}", "passes", passes, "why", why.message));
    rt_free(data);
    return RT_OK;
}

static RtStatus serve_count(Server *server, Counting *counting, const char *line, RtError *error) {
    const RtExperiment *e = server->experiment;
    char name[RT_MAX_WORD], label[RT_MAX_LABEL], path[RT_MAX_PATH];
    uint32_t t;
    RtRayKind kind;
    if (sscanf(line, "count %" SCNu32 " %47s %511s %4095[^\n]", &t, name, label, path) != 4 ||
        t >= e->workload_count || rt_ray_kind_parse(name, &kind, NULL) != RT_OK)
        return fail_request(line, error);
    const uint32_t c = rt_candidate_find(e, label, t);
    RT_TRY(open_scene(counting, e, t, error));
    if (c < e->candidate_count) return answer_count(server, counting, c, kind, path, error);
    say(server, json_object());
    return RT_OK;
}

static RtStatus serve_counts(Server *server, RtError *error) {
    Counting counting = {.workload = server->experiment->workload_count};
    char line[MOST_LINE];
    RtStatus status = RT_OK;
    while (status == RT_OK && take_request(server, line))
        status = serve_count(server, &counting, line, error);
    rt_accel_destroy(counting.accel);
    rt_scene_clear(&counting.scene);
    return status;
}

/* Keeps what others print, a plugin say, out of the answers. */
RtStatus rt_worker_serve(const RtExperiment *experiment, const RtWorkloadOptions *times, RtError *error) {
    int answers = dup(STDOUT_FILENO);
    Server server = {.experiment = experiment, .out = answers >= 0 ? fdopen(answers, "w") : NULL};
    if (!server.out) return rt_fail(error, RT_IO, "stdout: %s", strerror(errno));
    dup2(STDERR_FILENO, STDOUT_FILENO);
    RtStatus status = times ? serve_times(&server, times, error) : serve_counts(&server, error);
    fclose(server.out);
    return status;
}
