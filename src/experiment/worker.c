/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/worker.h"
#include "accel/columns.h"

#include "core/base/memory.h"
#include "core/text/json.h"
#include "core/text/table.h"
#include "experiment/workload_state.h"
#include "measure/machine.h"
#include "measure/rounds.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <sched.h>
#include <signal.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MOST_LINE = 256 }; /* characters of a request, and of an answer that is a number */

/* ---- the worker ---- */

typedef struct Server {
    FILE *in, *out;
    bool gone; /* nobody asks any more */
} Server;

static void say(Server *server, json_t *line) {
    json_dumpf(line, server->out, JSON_COMPACT);
    fputc('\n', server->out);
    fflush(server->out);
    json_decref(line);
}

/* The candidates that are timed on these rays, with what they count. */
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

/* Keeps this thread on one of the processors that it may run on. */
static void pin(const cpu_set_t *allowed, uint32_t number) {
    cpu_set_t one;
    number %= (uint32_t)CPU_COUNT(allowed);
    CPU_ZERO(&one);
    for (size_t i = 0; i < CPU_SETSIZE; i++) {
        if (CPU_ISSET(i, allowed) && number-- == 0) CPU_SET(i, &one);
    }
    sched_setaffinity(0, sizeof one, &one);
}

static RtStatus answer_time(Server *server, const RtRunner *runner, uint32_t repeats, RtError *error) {
    double seconds, wall;
    RT_TRY(rt_runner_time(runner, repeats, &seconds, &wall, error));
    fprintf(server->out, "%.17g\n", seconds / (repeats * runner->work));
    fflush(server->out);
    return RT_OK;
}

static RtStatus serve_runners(Server *server, const RtRunner *runners, uint32_t count, RtError *error) {
    char line[MOST_LINE];
    cpu_set_t allowed;
    uint32_t number, repeats;
    RtStatus status = RT_OK;
    bool pinned = sched_getaffinity(0, sizeof allowed, &allowed) == 0;
    while (status == RT_OK) {
        server->gone = !fgets(line, sizeof line, server->in);
        if (server->gone) status = rt_fail(error, RT_IO, "nobody asks any more");
        if (server->gone || strcmp(line, "next\n") == 0) break;
        if (sscanf(line, "pin %" SCNu32, &number) == 1) {
            if (pinned) pin(&allowed, number);
        } else if (sscanf(line, "time %" SCNu32 " %" SCNu32, &number, &repeats) == 2 && number < count &&
                   repeats > 0) {
            status = answer_time(server, &runners[number], repeats, error);
        } else {
            status = rt_fail(error, RT_BAD_INPUT, "this is no request to a worker: %.40s", line);
        }
    }
    if (pinned) sched_setaffinity(0, sizeof allowed, &allowed);
    return status;
}

static RtStatus serve_kind(void *context, RtWorkloadState *workload, RtRayKind kind, RtError *error) {
    Server *server = context;
    RtRunner *runners = rt_alloc(workload->count, sizeof(RtRunner));
    if (!runners) return rt_fail_memory(error, "runners", workload->count * sizeof(RtRunner));
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
    rt_free(runners);
    return status;
}

RtStatus rt_worker_serve(const RtExperiment *experiment, const RtWorkloadOptions *options, FILE *in,
                         FILE *out, RtError *error) {
    Server server = {.in = in, .out = out};
    RtWorkloadOptions how = *options;
    RtResults results;
    how.timer = serve_kind;
    how.timer_context = &server;
    say(&server, json_pack("{s:i, s:s}", "worker", 1, "build", rt_build_identity()));
    RtStatus status = rt_results_init(&results, experiment, error);
    for (uint32_t t = 0; t < experiment->workload_count && status == RT_OK; t++) {
        status = rt_workload_run(&results, t, &how, error);
    }
    if (status == RT_OK) say(&server, json_pack("{s:b}", "done", 1));
    rt_results_clear(&results);
    return server.gone ? RT_OK : status;
}

/* ---- who has it work ---- */

static RtStatus fail_gone(const RtWorker *worker, RtError *error) {
    return rt_fail(error, RT_BAD_INPUT, "%s ended while it was compared; what it said is above",
                   worker->program);
}

static RtStatus spawn(RtWorker *worker, char *const *arguments, const int to[2], const int from[2],
                      RtError *error) {
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, to[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, from[1], STDOUT_FILENO);
    int failure = posix_spawn(&worker->pid, worker->program, &actions, NULL, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (failure == 0) return RT_OK;
    worker->pid = 0;
    return rt_fail(error, RT_BAD_INPUT, "%s: cannot be started: %s", worker->program, strerror(failure));
}

/* The ends of pipes that are for the worker alone are closed in any case. */
static RtStatus connect_worker(RtWorker *worker, char *const *arguments, RtError *error) {
    int to[2], from[2];
    if (pipe2(to, O_CLOEXEC) != 0) return rt_fail(error, RT_IO, "a pipe: %s", strerror(errno));
    if (pipe2(from, O_CLOEXEC) != 0) {
        close(to[0]);
        close(to[1]);
        return rt_fail(error, RT_IO, "a pipe: %s", strerror(errno));
    }
    RtStatus status = spawn(worker, arguments, to, from, error);
    close(to[0]);
    close(from[1]);
    worker->to = fdopen(to[1], "w");
    worker->from = fdopen(from[0], "r");
    if (!worker->to) close(to[1]);
    if (!worker->from) close(from[0]);
    if (status != RT_OK || (worker->to && worker->from)) return status;
    return rt_fail_memory(error, "a pipe", 0);
}

/* One line of JSON; the worker's own messages go to stderr. */
static RtStatus take_json(RtWorker *worker, json_t **document, RtError *error) {
    char *line = NULL;
    size_t room = 0;
    *document = NULL;
    if (getline(&line, &room, worker->from) > 0) *document = json_loads(line, 0, NULL);
    free(line);
    return *document ? RT_OK : fail_gone(worker, error);
}

RtStatus rt_worker_start(RtWorker *worker, const char *program, char *const *arguments, json_t **build,
                         RtError *error) {
    *worker = (RtWorker){.program = program};
    *build = NULL;
    signal(SIGPIPE, SIG_IGN); /* who has ended is noticed by what does not arrive */
    RT_TRY(connect_worker(worker, arguments, error));
    if (take_json(worker, build, error) == RT_OK &&
        json_integer_value(json_object_get(*build, "worker")) == 1)
        return RT_OK;
    json_decref(*build);
    *build = NULL;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s cannot be compared with: it has to be a raytally that has `compare`, as this one. Of "
                   "an older one, "
                   "compare result directories",
                   program);
}

RtStatus rt_worker_next(RtWorker *worker, json_t **section, RtError *error) {
    return take_json(worker, section, error);
}

static RtStatus ask(RtWorker *worker, const char *request, RtError *error) {
    return fputs(request, worker->to) >= 0 && fflush(worker->to) == 0 ? RT_OK : fail_gone(worker, error);
}

RtStatus rt_worker_pin(RtWorker *worker, uint32_t processor, RtError *error) {
    char request[MOST_LINE];
    snprintf(request, sizeof request, "pin %" PRIu32 "\n", processor);
    return ask(worker, request, error);
}

RtStatus rt_worker_time(RtWorker *worker, uint32_t cell, uint32_t repeats, double *seconds, RtError *error) {
    char line[MOST_LINE];
    snprintf(line, sizeof line, "time %" PRIu32 " %" PRIu32 "\n", cell, repeats);
    RT_TRY(ask(worker, line, error));
    if (!fgets(line, sizeof line, worker->from)) return fail_gone(worker, error);
    *seconds = strtod(line, NULL);
    return *seconds > 0 ? RT_OK : fail_gone(worker, error);
}

RtStatus rt_worker_go_on(RtWorker *worker, RtError *error) {
    return ask(worker, "next\n", error);
}

void rt_worker_end(RtWorker *worker) {
    if (worker->to) fclose(worker->to);
    if (worker->from) fclose(worker->from);
    if (worker->pid > 0) waitpid(worker->pid, NULL, 0);
    *worker = (RtWorker){0};
}
