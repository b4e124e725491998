/* SPDX-License-Identifier: Apache-2.0 */
/* The journal of a run: a line of JSON for each measurement, on the disk before the next one starts.
 * Interrupted runs resume from it; the tables and the report are made from it.
 *
 * The first line names the experiment (the fingerprint of its YAML), the variant (quick or not), the build,
 * and the plugins that the experiment uses. A journal of another experiment or build is rejected. A truncated
 * last line is ignored; any other invalid line is rejected by its number. */
#ifndef RT_RESULTS_JOURNAL_H
#define RT_RESULTS_JOURNAL_H

#include "core/text/json.h"
#include "experiment/experiment.h"
#include "results/results.h"

/* ---- what a run tells while it fills the results ---- */

typedef enum RtEventKind {
    RT_EVENT_WORKLOAD,     /* results->workloads[workload] is known */
    RT_EVENT_BUILD,        /* the build of `candidate` is known */
    RT_EVENT_COUNT,        /* the cell is counted */
    RT_EVENT_DISTRIBUTION, /* the cell has its distributions */
    RT_EVENT_CHOICE,       /* the best-of has its choice */
    RT_EVENT_TIME,         /* the cell is timed */
    RT_EVENT_RENDER,       /* rendering with `candidate` is timed */
    RT_EVENT_NO_BUILD,     /* `candidate` is left out: it refuses the scene, took too long, or broke */
    RT_EVENT_NO_CELL /* the cell is left out: it would exceed a limit, or `candidate` broke on its rays */
} RtEventKind;

/* The part of the results that was just filled. */
typedef struct RtEvent {
    RtEventKind what;
    uint32_t workload, candidate;
    RtRayKind kind;
} RtEvent;

/* Whether the candidate or the cell is left out because it broke. */
bool rt_event_is_broken(const RtResults *results, const RtEvent *event);

/* Callbacks, called on the thread that runs the workload; each may be NULL. A status other than RT_OK ends
 * the workload with that status. */
typedef struct RtRunObserver {
    void *context;
    RtStatus (*event)(void *context, const RtResults *results, const RtEvent *event, RtError *error);
    void (*notice)(void *context, const char *message);
} RtRunObserver;

/* Formats a notice like printf, and passes it to the observer. */
__attribute__((format(printf, 2, 3))) void rt_notify(const RtRunObserver *observer, const char *format, ...);

/* ---- the journal ---- */

/* Opens the journal at `path` for appending: with `resume` the existing one, else a new one, which records
 * its shard (`only`). Close with rt_json_lines_close, also after a failure. */
RtStatus rt_journal_open(RtJsonLines *journal, const char *path, const RtExperiment *experiment,
                         const RtSelection *only, bool resume, RtError *error);

/* Adds a whole journal to files that are replaced together: a header as above, then `lines`, borrowed. */
RtStatus rt_journal_add(RtOutputs *outputs, const char *path, const RtExperiment *experiment,
                        const RtSelection *only, const json_t *lines, RtError *error);

/* Fills `results` from the journal at `path`. Rejects a journal of another experiment; with `only`, to resume
 * it, also of another build or another shard. A plugin of the experiment that has changed loses its lines; if
 * it is the baseline, the journal is rejected. A journal whose results are given up (measure/result_files.h)
 * is empty. */
RtStatus rt_journal_load(const char *path, RtResults *results, const RtSelection *only, RtError *error);

/* Rewrites the journal at `path`, which was loaded, without the lines of changed plugins, and says which they
 * are; if none has changed, it stays. At any time the old or the new journal is whole. */
RtStatus rt_journal_drop_changed(const char *path, const RtExperiment *experiment, const RtSelection *only,
                                 const RtRunObserver *observer, RtError *error);

/* The line of an event: a new reference, NULL if memory is short. */
json_t *rt_journal_line(const RtResults *results, const RtEvent *event);

/* The ray set of a kind: how many rays it has, and had before the limit, and its hash; likewise. */
json_t *rt_ray_set_json(const RtWorkloadResult *workload, RtRayKind kind);

#endif
