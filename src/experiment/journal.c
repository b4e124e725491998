/* SPDX-License-Identifier: Apache-2.0 */
#include "experiment/journal.h"

#include "accel/columns.h"
#include "core/text/json.h"
#include "experiment/journal_state.h"
#include "experiment/plugins_used.h"
#include "measure/machine.h"

#include <math.h>
#include <string.h>

const char *const rt_journal_each_names[RT_EACH_COUNT] = {"each_seconds", "each_wall", "each_baseline"};

/* ---- to JSON ---- */

static json_t *header_json(const RtExperiment *experiment, const RtOnly *only) {
    return json_pack("{s:s, s:o, s:b, s:s, s:i, s:i, s:o}", "experiment", experiment->name, "hash",
                     rt_json_hex(experiment->fingerprint), "quick", experiment->quick, "build",
                     rt_build_alone(), "shard", (int)only->shard, "shards", (int)only->shards, "plugins",
                     rt_plugins_used(experiment));
}

static json_t *workload_json(const RtWorkloadResult *workload) {
    json_t *sets = json_object();
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) {
        json_object_set_new(sets, rt_ray_kind_name((RtRayKind)k),
                            json_pack("{s:I, s:o}", "rays", (json_int_t)workload->rays[k], "hash",
                                      rt_json_hex(workload->ray_fingerprints[k])));
    }
    return json_pack("{s:I, s:I, s:I, s:o, s:o}", "objects", (json_int_t)workload->objects, "width",
                     (json_int_t)workload->width, "height", (json_int_t)workload->height, "hash",
                     rt_json_hex(workload->scene), "sets", sets);
}

static json_t *build_json(const RtBuildResult *build) {
    json_t *object = rt_json_structure(&build->shape);
    json_t *run =
        json_pack("{s:s, s:b, s:b, s:f, s:I}", "spec", build->spec, "exact", build->exact, "counts",
                  build->counts, "seconds", build->seconds, "bytes", (json_int_t)build->shape.bytes);
    if (json_object_update_new(object, run) != 0) {
        json_decref(object);
        return NULL;
    }
    if (build->leaves)
        json_object_set_new(
            object, "distributions",
            rt_distributions_json(build->leaves, RT_RAY_QUANTITY_COUNT, RT_LEAF_QUANTITY_COUNT));
    return object;
}

static json_t *count_json(const RtCell *cell) {
    json_t *object = rt_json_tally(&cell->tally);
    if (json_object_set_new(object, "differ", json_integer((json_int_t)cell->differ)) == 0) return object;
    json_decref(object);
    return NULL;
}

static json_t *estimate_json(const RtEstimate *e) {
    return json_pack("[f, f, f, f]", e->median, e->low, e->high, e->least);
}

static json_t *rounds_json(const RtCell *cell, RtEach each) {
    json_t *list = json_array();
    for (uint32_t r = 0; r < cell->rounds; r++) {
        json_array_append_new(list, json_real(rt_cell_rounds(cell, each)[r]));
    }
    return list;
}

static json_t *time_json(const RtResults *results, const RtCell *cell) {
    const RtMachine *machine = &results->machines[cell->machine];
    json_t *object = json_pack(
        "{s:I, s:I, s:i, s:o, s:o, s:o, s:s, s:s, s:s}", "rays", (json_int_t)cell->tally.rays, "rounds",
        (json_int_t)cell->rounds, "threads", cell->threads, "seconds", estimate_json(&cell->seconds), "wall",
        estimate_json(&cell->wall), "ratio", estimate_json(&cell->ratio), "baseline",
        rt_candidate_label(results->experiment, cell->baseline), "host", machine->host, "cpu", machine->cpu);
    for (int i = 0; i < RT_EACH_COUNT && cell->each; i++) {
        json_object_set_new(object, rt_journal_each_names[i], rounds_json(cell, (RtEach)i));
    }
    return object;
}

/* What is not known is null. */
static json_t *hardware_json(const RtResults *results, const RtCell *cell) {
    const RtCellHardware *hardware = &cell->hardware;
    const RtMachine *machine = &results->machines[hardware->machine];
    json_t *object =
        json_pack("{s:i, s:f, s:s, s:s, s:s}", "threads", hardware->threads, "running",
                  hardware->counts.running, "why", hardware->why, "host", machine->host, "cpu", machine->cpu);
    for (size_t i = 0; i < RT_HARDWARE_COUNT; i++) {
        double count = *hardware->why ? (double)NAN : hardware->counts.of[i];
        json_object_set_new(object, rt_hardware_name(i), isnan(count) ? json_null() : json_real(count));
    }
    return object;
}

static json_t *event_json(const RtResults *results, const RtEvent *event) {
    const RtExperiment *experiment = results->experiment;
    const RtCell *cell = rt_cell_at(results, event->workload, event->candidate, event->kind);
    const RtBuildResult *build = rt_build_at(results, event->workload, event->candidate);
    const char *scene = experiment->workloads[event->workload].label;
    const char *accel = rt_candidate_label(experiment, event->candidate);
    const char *kind = rt_ray_kind_name(event->kind);
    switch (event->what) {
    case RT_EVENT_WORKLOAD:
        return json_pack("{s:s, s:o}", "scene", scene, "workload",
                         workload_json(&results->workloads[event->workload]));
    case RT_EVENT_BUILD:
        return json_pack("{s:s, s:s, s:o}", "scene", scene, "accel", accel, "built", build_json(build));
    case RT_EVENT_COUNT:
        return json_pack("{s:s, s:s, s:s, s:o}", "scene", scene, "accel", accel, "kind", kind, "counted",
                         count_json(cell));
    case RT_EVENT_DISTRIBUTION:
        return json_pack("{s:s, s:s, s:s, s:o}", "scene", scene, "accel", accel, "kind", kind, "distributed",
                         rt_distributions_json(cell->distributions, 0, RT_RAY_QUANTITY_COUNT));
    case RT_EVENT_TIME:
        return json_pack("{s:s, s:s, s:s, s:o}", "scene", scene, "accel", accel, "kind", kind, "timed",
                         time_json(results, cell));
    case RT_EVENT_HARDWARE:
        return json_pack("{s:s, s:s, s:s, s:o}", "scene", scene, "accel", accel, "kind", kind, "hardware",
                         hardware_json(results, cell));
    case RT_EVENT_TOO_LARGE:
    case RT_EVENT_BROKEN_BUILD:
        return json_pack("{s:s, s:s, s:s, s:b}", "scene", scene, "accel", accel, "too_large", build->limit,
                         "broken", build->broken);
    case RT_EVENT_TOO_LONG:
    case RT_EVENT_BROKEN:
        return json_pack("{s:s, s:s, s:s, s:s, s:b}", "scene", scene, "accel", accel, "kind", kind,
                         "too_long", cell->limit, "broken", cell->broken);
    }
    return NULL;
}

/* ---- writing ---- */

RtStatus rt_journal_open(RtJsonLines *journal, const char *path, const RtExperiment *experiment,
                         const RtOnly *only, bool resume, RtError *error) {
    json_t *header = resume ? NULL : header_json(experiment, only);
    if (!resume && !header) return rt_fail_memory(error, path, 0);
    RtStatus status = rt_json_lines_open(journal, path, header, error);
    json_decref(header);
    return status;
}

bool rt_journal_line_concerns(const json_t *line, const RtExperiment *experiment, const json_t *plugins) {
    const char *scene = json_string_value(json_object_get(line, "scene"));
    const char *accel = json_string_value(json_object_get(line, "accel"));
    uint32_t workload = scene ? rt_workload_find(experiment, scene) : experiment->workload_count;
    if (!accel || workload == experiment->workload_count) return false;
    uint32_t candidate = rt_candidate_find(experiment, accel, workload);
    return candidate <= experiment->candidate_count && rt_plugins_concern(plugins, experiment, candidate);
}

/* Behind a new header, all lines but those of accelerators whose plugin has changed. */
static json_t *lines_without(const json_t *lines, const RtExperiment *experiment, const RtOnly *only) {
    json_t *kept = json_array(), *line, *header = header_json(experiment, only);
    json_t *changed = rt_plugins_changed(json_object_get(json_array_get(lines, 0), "plugins"),
                                         json_object_get(header, "plugins"));
    size_t i;
    json_array_append_new(kept, header);
    json_array_foreach((json_t *)lines, i, line) {
        if (i > 0 && json_is_object(line) && !rt_journal_line_concerns(line, experiment, changed))
            json_array_append(kept, line);
    }
    json_decref(changed);
    return kept;
}

RtStatus rt_journal_renew(const char *path, const RtExperiment *experiment, const RtOnly *only,
                          RtError *error) {
    json_t *lines;
    RT_TRY(rt_json_lines_load(path, &lines, error));
    json_t *kept = lines_without(lines, experiment, only);
    RtStatus status = rt_json_lines_save(path, kept, error);
    json_decref(kept);
    json_decref(lines);
    return status;
}

RtStatus rt_journal_add(RtOutputs *outputs, const char *path, const RtExperiment *experiment,
                        const RtOnly *only, const json_t *lines, RtError *error) {
    RtOutput *output;
    json_t *all = json_pack("[o]", header_json(experiment, only));
    RtStatus status =
        all && json_array_extend(all, (json_t *)lines) == 0 ? RT_OK : rt_fail_memory(error, path, 0);
    if (status == RT_OK) status = rt_outputs_add(outputs, path, &output, error);
    if (status == RT_OK) status = rt_json_lines_put(output, all, error);
    if (status == RT_OK) status = rt_output_finish(output, error);
    json_decref(all);
    return status;
}

RtStatus rt_journal_append(RtJsonLines *journal, const RtResults *results, const RtEvent *event,
                           RtError *error) {
    return rt_json_lines_write(journal, event_json(results, event), error);
}
