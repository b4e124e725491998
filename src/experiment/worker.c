/* SPDX-License-Identifier: Apache-2.0 */
/* The worker: a raytally that another one starts to be timed against it (compare_programs.c). It has done
 * everything that is not timed (scene, rays, builds, counts) and waits for requests, so that runs of two
 * programs can alternate however short they are.
 *
 * The protocol is lines of text. The worker introduces itself: {"worker": 1, "build": ...}. For each workload
 * and kind of rays, in the order of the experiment, it lists its cells: {"scene", "kind", "rays", "hash",
 * "cells": [{"accel", "spec", "counts", "exact"}]}, and then waits. "time C N" runs cell number C of them N
 * times; the answer is the seconds per ray. "pin P" keeps it on processor number P of those it may use, until
 * "next", which goes on to the next kind of rays. The last line is {"done": true}. The end of its input ends
 * the worker. */
#include "accel/columns.h"
#include "experiment/compare.h"

#include "core/base/memory.h"
#include "core/text/json.h"
#include "experiment/workload_state.h"
#include "measure/machine.h"
#include "measure/rounds.h"

#include <inttypes.h>
#include <sched.h>
#include <string.h>

enum { MOST_LINE = 256 }; /* characters of a request */

typedef struct Server {
    FILE *in, *out;
    bool closed; /* the input has ended */
} Server;

static void say(Server *server, json_t *line) {
    json_dumpf(line, server->out, JSON_COMPACT);
    fputc('\n', server->out);
    fflush(server->out);
    json_decref(line);
}

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
        server->closed = !fgets(line, sizeof line, server->in);
        if (server->closed) status = rt_fail(error, RT_IO, "the input has ended");
        if (server->closed || strcmp(line, "next\n") == 0) break;
        if (sscanf(line, "pin %" SCNu32, &number) == 1) {
            if (pinned) pin(&allowed, number);
        } else if (sscanf(line, "time %" SCNu32 " %" SCNu32, &number, &repeats) == 2 && number < count &&
                   repeats > 0) {
            status = answer_time(server, &runners[number], repeats, error);
        } else {
            status = rt_fail(error, RT_BAD_INPUT, "not a request to a worker: %.40s", line);
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
    return server.closed ? RT_OK : status;
}
