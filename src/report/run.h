/* Running an experiment into a result directory, and working on one that is there.
 *
 *   cells.jsonl      the journal: everything found, line by line as it was found
 *   experiment.yaml  a copy of what was run
 *   manifest.json    with what it was run: seed, fingerprints, version, compiler, machine, date
 *   counts.csv       exact columns; byte-identical wherever the same version is run
 *   times.csv        measured columns, where anything is timed
 *   published.csv, least.csv, published.md
 *                    published figures beside measured ones, where the experiment names any; exact, too
 *   published/       or what folder they come from: copies of the published tables
 *   plots/ images/   the scripts and what they drew; a picture of each scene
 *   report.html      all of it in one page */
#ifndef RT_REPORT_RUN_H
#define RT_REPORT_RUN_H

#include "bench/earlier.h"
#include "bench/trial.h"
#include "literature/published.h"

typedef struct RtRunOptions {
    const char *directory; /* created where missing */
    RtStart start;         /* what becomes of what an earlier run in it has found */
    RtTrialOptions trial;  /* its observer is told after the journal */
} RtRunOptions;

/* Runs what is not yet known, and writes everything. `results` is initialised for the experiment, and filled.
 *
 * No other process writes into the directory meanwhile. What an earlier run has left there is touched only
 * once all that may be refused has been looked at, every scene been opened: each once, to be kept until its
 * trial is over. Whenever the process ends, however, its journal or the one before it is whole.
 *
 * Without gnuplot there is a notice, and a report without plots. RT_MISMATCH, with everything written, where
 * gnuplot fails, or published figures are missed (rt_published_check). */
RtStatus rt_run(RtResults *results, const RtRunOptions *options, RtError *error);

/* Loads experiment and results of a result directory. `results` is initialised here: rt_results_clear. */
RtStatus rt_run_load(const char *directory, RtExperiment *experiment, RtResults *results, RtError *error);

/* The files that are byte-identical wherever they are made, from what was found. */
typedef struct RtExactFile {
    const char *name;
    bool published; /* only where the experiment names published figures */
    void (*write)(const RtResults *results, const RtPublished *published, FILE *out);
} RtExactFile;

#define RT_EXACT_FILES 4
extern const RtExactFile rt_exact_files[RT_EXACT_FILES];

#endif
