/* SPDX-License-Identifier: Apache-2.0 */
/* raytally run: experiments, from their YAML to result directories. */
#include "claims/findings.h"
#include "cli/cli.h"
#include "cli/jobs.h"
#include "core/base/words.h"
#include "measure/result_files.h"
#include "report/report.h"
#include "results/result_tables.h"
#include "run/run.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

enum { MOST_EXPERIMENTS = 256, MOST_COMMAND = 1 << 16 };

typedef struct Options {
    const char *paths[MOST_EXPERIMENTS];
    uint32_t count, current; /* paths; the one that is loaded or run */
    const char *out;         /* as given: of one experiment the directory, of several the folder; or NULL */
    RtRunOptions how;
    char directory[RT_MAX_PATH]; /* of this run: results/NAME, or of several FOLDER/NAME */
    bool quick, strict, dry, resume, force;
    bool found;                                 /* the experiment comes from a manifest */
    char parts[RT_MAX_PARTS][3 * RT_MAX_LABEL]; /* texts of how.workload.only */
    uint64_t memory;                            /* bytes for each accelerator; 0: the experiment's limit */
    int threads;                                /* -1: one to time, all to build and count */
} Options;

static void take_only(void *options, const char *text, struct argp_state *state) {
    Options *o = options;
    RtSelection *only = &o->how.workload.only;
    if (only->part_count == RT_MAX_PARTS) argp_error(state, "--only: more than %d parts", RT_MAX_PARTS);
    if (strlen(text) >= sizeof o->parts[0]) argp_error(state, "--only: '%s' is too long", text);
    char *scene = strcpy(o->parts[only->part_count], text);
    char *accel = strchr(scene, '/'), *kind = accel ? strchr(accel + 1, '/') : NULL;
    if (accel) *accel++ = '\0';
    if (kind) *kind++ = '\0';
    only->parts[only->part_count++] = (RtPart){scene, accel, kind};
}

static void take_shard(void *options, const char *text, struct argp_state *state) {
    RtSelection *only = &((Options *)options)->how.workload.only;
    unsigned shard, shards;
    int end = 0;
    bool fine = sscanf(text, "%3u/%3u%n", &shard, &shards, &end) == 2 && !text[end];
    if (!fine || shard < 1 || shard > shards)
        argp_error(state, "--shard: invalid value '%s': expected I/N, 1 <= I <= N, as in 2/4", text);
    only->shard = shard;
    only->shards = shards;
}

static void finish_options(void *options, struct argp_state *state) {
    const Options *o = options;
    if (o->count == 1) return;
    if (o->how.workload.only.part_count || o->how.workload.only.shards)
        argp_error(state, "--only and --shard take one experiment");
}

static const RtOption options[] = {
    {"out", 'o', "DIR", RT_TO_TEXT(out),
     "The result directory (results/NAME); for several experiments, the folder of their directories DIR/NAME "
     "(results)"},
    {"resume", 0, NULL, RT_TO_FLAG(resume),
     "Keep what is finished and measure the rest, and again the cells of plugins that have changed. If "
     "nothing is left to measure, write tables and plots anew"},
    {"force", 0, NULL, RT_TO_FLAG(force),
     "Start over: the results in DIR are lost; with --resume, only results that cannot be resumed, as of "
     "another build or another version of the YAML"},
    RT_GONE("renew", "--resume measures the cells of changed plugins again"),
    RT_GONE("update", "use --resume, and --resume --force to start over what another build measured"),
    RT_TRUST_OPTION(how.scripts),
    {"threads", 't', "N", RT_TO_INTEGER(threads, 0, 1024), RT_THREADS_HELP},
    RT_MEMORY_OPTION(memory),
    RT_TIME_OPTION("; what is measured stays, for --resume"),
    RT_UNTIL_OPTIONS(how.workload.until, how.workload.patience),
    {"quick", 0, NULL, RT_TO_FLAG(quick), "The smaller variant that the YAML describes under `quick`"},
    {"strict", 0, NULL, RT_TO_FLAG(strict),
     "Exit code 1 if a claim of the experiment (`expect`, `finding`, `paper`) does not hold, and 2 if the "
     "file of a scene is odd"},
    {"dry-run", 0, NULL, RT_TO_FLAG(dry), "Measure nothing: list the cells, and which of them are finished"},
    {"only", 0, "SCENE[/ACCEL[/KIND]]", RT_TO_TAKE(take_only),
     "Measure only the baseline and one scene, one accelerator on it, or one kind of rays, given by labels; "
     "may be repeated. --resume without --only measures the rest"},
    {"shard", 0, "I/N", RT_TO_TAKE(take_shard),
     "Measure every Nth scene from the Ith on with all accelerators (into results/NAME-I-of-N), to split a "
     "run across N machines. `raytally merge` joins the directories"},
    {0}};

/* ---- before ---- */

static void print_cell(const RtResults *results, const RtCellCursor *at) {
    const RtExperiment *e = results->experiment;
    const RtWorkloadResult *workload = &results->workloads[at->workload];
    const RtBuildResult *build = rt_build_at(results, at->workload, at->candidate);
    const char *left_out = *at->cell->left_out ? at->cell->left_out : build->left_out;
    const bool finished = at->cell->counted && (at->cell->timed || e->count_only);
    if (workload->known && !workload->rays[at->kind]) return;
    const char *state = *left_out ? left_out : finished ? "finished" : "";
    printf("%-24s %-28s %-*s%s%s\n", e->workloads[at->workload].label, rt_candidate_label(e, at->candidate),
           *state ? 12 : 0, rt_ray_kind_name(at->kind), *state ? " " : "", state);
}

/* Opens no scenes: what is finished is in the journal. */
static RtStatus dry_run(RtResults *results, const RtRunOptions *how, bool list, RtError *error) {
    const RtExperiment *e = results->experiment;
    const RtSelection *only = &how->workload.only;
    char path[RT_MAX_PATH];
    RT_TRY(rt_path_join(how->directory, RT_RUN_JOURNAL, path, error));
    if (how->start != RT_START_ANEW && rt_file_exists(path))
        RT_TRY(rt_journal_load(path, results, only, error));
    for (RtCellCursor at = {0}; list && rt_results_next(results, &at);) {
        if (rt_candidate_runs(e, at.candidate, at.workload) &&
            rt_selection_has(only, e, at.workload, at.candidate, at.kind))
            print_cell(results, &at);
    }
    const RtCellCount count = rt_count_cells(results, &how->workload);
    printf("%u cell%s, %u of them finished\n", count.cells, rt_plural(count.cells), count.finished);
    return RT_OK;
}

static const char *folder_of(const Options *o) {
    return o->out ? o->out : "results";
}

static void go_on(const Options *o, const RtExperiment *e, char out[MOST_COMMAND]) {
    const RtWorkloadOptions *how = &o->how.workload;
    const size_t size = MOST_COMMAND;
    snprintf(out, size, "raytally run");
    for (uint32_t i = 0; i < o->count; i++)
        rt_append_argument(out, size, o->count == 1 ? e->path : o->paths[i]);
    rt_append_text(out, size, " --out");
    rt_append_argument(out, size, o->count == 1 ? o->how.directory : folder_of(o));
    if (o->count == 1 ? e->quick : o->quick) rt_append_text(out, size, " --quick");
    if (o->strict) rt_append_text(out, size, " --strict");
    if (o->threads >= 0) rt_append_text(out, size, " --threads %d", o->threads);
    if (o->memory) rt_append_text(out, size, " --memory %" PRIu64, o->memory);
    if (how->only.shards) rt_append_text(out, size, " --shard %u/%u", how->only.shard, how->only.shards);
    if (how->until > 0)
        rt_append_text(out, size, " --until %g%% --patience %g", 100 * how->until, how->patience);
    rt_cli_plugin_arguments(out, size);
    rt_append_text(out, size, "%s --resume", o->how.scripts == RT_SCRIPTS_ALL ? " --trust" : "");
    if (o->force && (o->resume || o->count > 1)) rt_append_text(out, size, " --force");
}

static RtStatus measure(Options *o, RtResults *results, RtError *error) {
    RtRunOptions *how = &o->how;
    static char command[MOST_COMMAND];
    RtProgress progress;
    rt_progress_begin(&progress, &how->workload);
    if (o->count > 1)
        snprintf(progress.title, sizeof progress.title, "%s, %" PRIu32 " of %" PRIu32 ": ",
                 results->experiment->name, o->current + 1, o->count);
    go_on(o, results->experiment, command);
    rt_stop_continue(how->directory, command);
    RtStatus status = rt_run_experiment(results, how, error);
    rt_progress_end(&progress);
    if (status != RT_OK) return status;
    rt_print_summary(results, o->how.directory, stdout);
    if (!how->workload.only.part_count && !how->workload.only.shards)
        printf("\nReport: %s/report.html\n", how->directory);
    RT_TRY(rt_results_check(results, error));
    return o->strict ? rt_findings_check(results, how->directory, error) : RT_OK;
}

static RtStatus load(Options *o, RtExperiment *experiment, RtError *error) {
    const char *path = o->paths[o->current];
    char folder[RT_MAX_PATH];
    o->found = rt_ends_in(path, RT_MANIFEST);
    if (!o->found) return rt_experiment_load(experiment, path, o->quick, NULL, error);
    if (o->quick)
        return rt_fail(error, RT_BAD_INPUT, "--quick: %s says which variant it was; leave --quick out", path);
    rt_path_folder(path, folder);
    RtStatus status = rt_manifest_experiment(folder, false, experiment, error);
    rt_cli_tell_plugins(folder, experiment); /* even if loading failed for lack of a plugin */
    return status;
}

static RtStatus choose_directory(Options *o, const RtExperiment *experiment, RtError *error) {
    const RtSelection *only = &o->how.workload.only;
    char name[RT_MAX_WORD + 8];
    o->how.directory = o->count == 1 && o->out ? o->out : o->directory;
    rt_file_name(experiment->name, name, sizeof name);
    RT_TRY(rt_path_join(folder_of(o), name, o->directory, error));
    if (only->shards && !o->out)
        rt_append_text(o->directory, sizeof o->directory, "-%u-of-%u", only->shard, only->shards);
    return RT_OK;
}

/* With --resume and --force, says what cannot be resumed, and starts it over. */
static RtStatus choose_start(Options *o, const RtExperiment *experiment, RtError *error) {
    RT_OWNED(RtResults, results, rt_results_clear);
    RtRunOptions *how = &o->how;
    bool goes_on;
    char path[RT_MAX_PATH];
    how->start = o->resume ? RT_START_RESUME : o->force ? RT_START_ANEW : RT_START_FRESH;
    if (!o->resume || !o->force) return RT_OK;
    RT_TRY(rt_path_join(how->directory, RT_RUN_JOURNAL, path, error));
    RtStatus status = rt_result_files_look(how->directory, RT_RUN_JOURNAL, how->start, &goes_on, error);
    if (status == RT_OK && goes_on) {
        status = rt_results_init(&results, experiment, error);
        if (status == RT_OK) status = rt_journal_load(path, &results, &how->workload.only, error);
    }
    if (status != RT_BAD_INPUT) return status;
    fprintf(stderr, "raytally: %s; --force starts %s over\n", error->message, how->directory);
    how->start = RT_START_ANEW;
    return RT_OK;
}

static RtStatus run(Options *o, RtExperiment *experiment, RtError *error) {
    RtRunOptions *how = &o->how;
    RT_OWNED(RtResults, results, rt_results_clear);
    RT_TRY(load(o, experiment, error));
    if (*experiment->warning.message) fprintf(stderr, "raytally: %s\n", experiment->warning.message);
    RT_TRY(rt_selection_check(&how->workload.only, experiment, error));
    if (how->workload.only.shards > experiment->workload_count)
        return rt_fail(error, RT_BAD_INPUT, "--shard: %u scene%s: too few for %u shards",
                       experiment->workload_count, rt_plural(experiment->workload_count),
                       how->workload.only.shards);
    if (how->workload.until > 0 && experiment->rounds < RT_FULL_ROUNDS) experiment->rounds = RT_FULL_ROUNDS;
    if (o->memory) experiment->limit_bytes = o->memory;
    RT_TRY(choose_directory(o, experiment, error));
    RT_TRY(choose_start(o, experiment, error));
    how->workload.timing = o->threads >= 0 ? o->threads : (int)experiment->threads;
    if (o->threads >= 0) how->workload.threads = o->threads;
    if (!o->found && how->scripts == RT_SCRIPTS_SHIPPED) how->scripts = RT_SCRIPTS_OWN;
    RT_TRY(rt_results_init(&results, experiment, error));
    return o->dry ? dry_run(&results, how, o->count == 1, error) : measure(o, &results, error);
}

/* ---- several ---- */

/* Parses all experiments before the first is measured. One that this build or machine cannot measure fails
 * when it is run. */
static RtStatus parse_all(Options *o, RtExperiment *experiment, char (*names)[RT_MAX_WORD], RtError *error) {
    static char files[MOST_EXPERIMENTS][RT_MAX_WORD + 8];
    for (o->current = 0; o->current < o->count; o->current++) {
        char *name = names[o->current], *file = files[o->current];
        RtStatus status = load(o, experiment, error);
        if (status != RT_OK && status != RT_NOT_AVAILABLE) return status;
        memcpy(name, experiment->name, RT_MAX_WORD);
        rt_file_name(name, file, sizeof files[0]);
        for (uint32_t i = 0; i < o->current; i++) {
            if (strcasecmp(files[i], file) != 0) continue;
            return rt_fail(error, RT_BAD_INPUT,
                           "%s ('%s') and %s ('%s') would share the directory %s/%s: give one of them "
                           "another `name`",
                           o->paths[i], names[i], o->paths[o->current], name, folder_of(o), file);
        }
    }
    return RT_OK;
}

static RtStatus run_all(Options *o, RtExperiment *experiment, RtError *error) {
    static char names[MOST_EXPERIMENTS][RT_MAX_WORD], command[MOST_COMMAND];
    static RtJob jobs[MOST_EXPERIMENTS];
    RtError why;
    size_t indexed;
    RT_TRY(parse_all(o, experiment, names, error));
    go_on(o, experiment, command);
    for (o->current = 0; o->current < o->count; o->current++) {
        RtJob *job = &jobs[o->current];
        job->name = names[o->current];
        printf("%s== %s, %" PRIu32 " of %" PRIu32 "\n", o->current ? "\n" : "", job->name, o->current + 1,
               o->count);
        RT_TRY(rt_job_run(job, command, error));
        if (job->here) return run(o, experiment, error);
    }
    rt_jobs_print(jobs, o->count, stdout);
    const RtStatus status = o->dry ? RT_OK : rt_index_write(folder_of(o), &indexed, &why);
    if (!o->dry && status == RT_OK) printf("\nIndex: %s/index.html and index.md\n", folder_of(o));
    RT_TRY(rt_jobs_check(jobs, o->count, error));
    return status == RT_OK ? RT_OK : rt_fail(error, status, "there is no index: %s", why.message);
}

const RtSyntax rt_run_syntax = {
    .options = options,
    .plugins = true,
    .arguments = "EXPERIMENT.yaml|DIR/manifest.json...",
    .argument = {.name = "EXPERIMENT",
                 .missing = "an EXPERIMENT is missing, as in experiments/first-look.yaml",
                 .value = RT_TO_LIST(paths, count)},
    .finish = finish_options,
    .help =
        "Run an experiment and write its result directory: counts.csv, times.csv, manifest.json, plots, "
        "images and report.html. Several run one after the other, each in a separate process; one that fails "
        "does not stop the others, the worst exit code counts, and an index lists all results in the folder. "
        "Given a manifest, run its experiment again; start it in the same working directory as the first "
        "run. A directory that has results, finished or not, needs --resume or --force. Only one process at "
        "a time may write to a directory. After Ctrl-C, finished cells are kept.\v"
        "Times per ray are in ns/ray, over all kinds of rays, on one thread unless --threads says otherwise; "
        "`raytally bench` prints them by kind, as throughput: Mrays/s = 1000 / (ns/ray).\n\n"
        "Exit code 1 if an accelerator returns a wrong answer, gnuplot fails (without gnuplot there is a "
        "note), or with --strict a claim does not hold. experiments/README.md describes how to write an "
        "experiment."};

RtStatus rt_command_run(int argc, char **argv, RtError *error) {
    Options o = {.threads = -1,
                 .how = {.report = rt_run_report, .workload = {.timing = 1, .patience = RT_PATIENCE}}};
    rt_cli_parse(&rt_run_syntax, argc, argv, &o);
    if (o.strict) rt_warnings_refuse();
    static RtExperiment experiment;
    return o.count == 1 ? run(&o, &experiment, error) : run_all(&o, &experiment, error);
}
