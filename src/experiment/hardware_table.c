/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/hardware_table.h"

#include "core/base/words.h"
#include "experiment/result_tables.h"

#include <math.h>

typedef RtHardwareRow Row;

#define EVENT(name) r->cell->hardware.counts.of[RT_HARDWARE_##name]
#define MACHINE     r->results->machines[r->cell->hardware.machine]

static double running_of(const Row *r) {
    return *r->cell->hardware.why ? (double)NAN : r->cell->hardware.counts.running;
}

static RtField why_of(const Row *r) {
    return *r->cell->hardware.why ? rt_field_text(r->cell->hardware.why) : rt_field_missing();
}

#define COLUMNS(X)                                                                                           \
    X(scene, "scene", text, "", "the scene's label in the experiment",                                       \
      r->results->experiment->workloads[r->workload].label)                                                  \
    X(kind, "kind", text, "", "kind of the rays", rt_experiment_kind_name(r->results->experiment, r->kind))  \
    X(accel, "accelerator", text, "", "the accelerator's label in the experiment",                           \
      rt_candidate_label(r->results->experiment, r->candidate))                                              \
    X(spec, "accel", text, "", "the accelerator with every effective parameter",                             \
      rt_build_at(r->results, r->workload, r->candidate)->spec)                                              \
    X(rays, "rays", integer, "", "rays measured", r->cell->tally.rays)                                       \
    X(threads, "threads", integer, "", "threads that traced them", (uint32_t)r->cell->hardware.threads)      \
    X(instructions, "instructions", real6, "", "instructions retired, per ray; median of 5 rounds",          \
      EVENT(instructions))                                                                                   \
    X(cycles, "cycles", real6, "", "cycles of the processor, per ray", EVENT(cycles))                        \
    X(cache_misses, "cache_misses", real6, "", "accesses that missed the last cache, per ray",               \
      EVENT(cache_misses))                                                                                   \
    X(branch_misses, "branch_misses", real6, "", "branches that were mispredicted, per ray",                 \
      EVENT(branch_misses))                                                                                  \
    X(instructions_per_cycle, "instructions_per_cycle", real6, "", "instructions a cycle",                   \
      EVENT(instructions) / EVENT(cycles))                                                                   \
    X(running, "running", real6, "",                                                                         \
      "least part of the time that an event was counted; below 1 they took turns, and were scaled",          \
      running_of(r))                                                                                         \
    X(why, "why", text, "", "why nothing could be counted; else empty", why_of(r))                           \
    X(host, "host", text, "", "the machine that counted", MACHINE.host)                                      \
    X(cpu, "cpu", text, "", "its processor", MACHINE.cpu)

RT_TABLE_COLUMNS(columns, COLUMNS)

static const RtColumnGroup hardware[] = {RT_ALL(columns)};

static const void *row_at(void *context, size_t i) {
    Row *r = context;
    const RtExperiment *e = r->results->experiment;
    r->kind = e->kinds[i % e->kind_count];
    r->candidate = (uint32_t)(i / e->kind_count % e->candidate_count);
    r->workload = (uint32_t)(i / e->kind_count / e->candidate_count);
    r->cell = rt_cell_at(r->results, r->workload, r->candidate, r->kind);
    return r->cell->hardware.known ? r : NULL;
}

RtTable rt_hardware_table(RtHardwareRow *row) {
    const RtExperiment *e = row->results->experiment;
    return (RtTable){RT_GROUPS(hardware),
                     .row_count = (size_t)e->workload_count * e->candidate_count * e->kind_count,
                     .row = row_at, .context = row};
}

/* ---- for the eye ---- */

/* The first reason; NULL where anything was counted. */
static const char *find_why(const RtResults *results) {
    RtHardwareRow row = {.results = results};
    RtTable table = rt_hardware_table(&row);
    const char *why = "no cell was measured";
    for (size_t i = table.row_count; i-- > 0;) {
        if (!table.row(table.context, i)) continue;
        if (!*row.cell->hardware.why) return NULL;
        why = row.cell->hardware.why;
    }
    return why;
}

void rt_print_hardware(const RtResults *results, FILE *out) {
    const char *why = find_why(results);
    char text[RT_MAX_SENTENCE];
    if (why) {
        snprintf(text, sizeof text, "Hardware counters: not available: %s.", why);
        fputc('\n', out);
        rt_print_wrapped(text, out);
        return;
    }
    for (uint32_t t = 0; t < results->experiment->workload_count; t++) {
        if (!results->workloads[t].known) continue;
        fprintf(out, "\n%s, what the machine did for a ray:\n", results->experiment->workloads[t].label);
        rt_print_rows(results, RT_MACHINE_CELLS, t, out);
    }
}
