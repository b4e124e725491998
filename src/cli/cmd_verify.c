/* SPDX-License-Identifier: Apache-2.0 */
/* raytally verify: does every accelerator answer every ray like brute? With --replay: is an answer still
 * wrong? The command line of verify/verify.h and verify/failure.h. */
#include "cli/cli.h"
#include "cli/jobs.h"
#include "core/base/clock.h"
#include "core/base/memory.h"
#include "core/base/words.h"
#include "core/text/json.h"
#include "measure/measure.h"
#include "scenes/builtin.h"
#include "scenes/open.h"
#include "verify/verify.h"
#include "verify/verify_table.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* Rays for each scene and accelerator, by default and with --quick, which leaves out larger scenes. */
enum { MANY_RAYS = 20000, QUICK_RAYS = 2000, QUICK_OBJECTS = 100 };

enum { MOST_SCENES = 256, MOST_SPECS = 512 };

typedef struct Options {
    const char *given[MOST_SCENES], *accels[MOST_SPECS]; /* as given */
    uint32_t given_count, accel_count;
    bool spread, quick, json;
    RtVerify work; /* work.rays.count 0: the default */
    const char *replay, *rays_from, *hits_from;
    RtRaySet given_rays;             /* those of rays_from */
    const char *scenes[MOST_SCENES]; /* of `work`: given, or by default; some are in `families` */
    RtVerifySpec specs[MOST_SPECS];  /* of `work` */
    char families[MOST_SCENES][RT_MAX_SPEC_CHARS];
    uint32_t left_out;   /* default scenes that --quick leaves out */
    char go_on[1 << 16]; /* the command that continues */
} Options;

static void take_shrink(void *options, const char *text, struct argp_state *state) {
    RtVerify *work = &((Options *)options)->work;
    work->shrink = strcmp(text, "all") == 0
                       ? RT_SHRINK_ALL
                       : (uint32_t)rt_cli_integer(state, "--shrink", text, 1, RT_SHRINK_ALL - 1);
}

static void finish(void *options, struct argp_state *state) {
    const Options *o = options;
    if (o->replay && (o->given_count > 0 || o->accel_count > 0 || o->work.folder || o->json))
        argp_error(
            state,
            "--replay traces the ray in FILE and prints text: it takes no SCENE, --accel, --out or --json");
    if (o->rays_from && (o->quick || o->work.rays.count > 0 || o->replay || o->given_count == 0))
        argp_error(state, "--rays-from replaces the rays of one SCENE: name the SCENE, and leave out --rays, "
                          "--quick and --replay");
    if (o->hits_from && (!o->rays_from || o->given_count > 1))
        argp_error(state, "--hits-from are hits of the rays of --rays-from on one SCENE: give both");
    if (o->work.differing_rays && (o->given_count != 1 || o->work.start == RT_START_RESUME))
        argp_error(state, "--differing-rays writes rays of one SCENE, all in this run: no --resume");
    if (o->work.differing_rays && o->rays_from && strcmp(o->work.differing_rays, o->rays_from) == 0)
        argp_error(state, "'%s' is named twice: give each file its own name", o->rays_from);
    if (o->work.start != RT_START_FRESH && !o->work.folder)
        argp_error(state, "--resume and --force need the run's directory: --out DIR");
}

static const RtOption options[] = {
    {"accel", 'a', "SPEC", RT_TO_LIST(accels, accel_count),
     "An accelerator, or `all` that are exact (the default); may be repeated"},
    {"spread", 0, NULL, RT_TO_FLAG(spread),
     "Also try each parameter at every value worth testing, one parameter at a time"},
    {"quick", 0, NULL, RT_TO_FLAG(quick),
     "A short check of a few seconds: 2000 rays, and without a SCENE only scenes of up to 100 objects; the "
     "last line says what it left out"},
    {"rays", 'n', "N", RT_TO_INTEGER(work.rays.count, 1, 20000000),
     "Rays for each scene and accelerator (default 20000): a tenth from the camera; the others are chords "
     "and rays that graze, start and end on surfaces, and run along axes, edges and faces"},
    {"rays-from", 0, "FILE.npy", RT_TO_TEXT(rays_from),
     "Trace the rays of FILE instead: an array of float32 of shape (N, 8), as `raytally rays` writes it. "
     "Each ray is traced for its nearest hit and for any hit"},
    {"hits-from", 0, "FILE.npy", RT_TO_TEXT(hits_from),
     "Judge the hits of another program: those of --rays-from on SCENE, a row per ray with the fields t (in "
     "lengths of the direction) and object (-1 for a miss), as `raytally bench --hits` writes it, or in a "
     "text (.csv) with these columns; or float32, t alone (inf for a miss). No accelerator is verified "
     "unless --accel names one"},
    {"differing-rays", 0, "FILE.npy", RT_TO_PATH(work.differing_rays, RT_CLI_ROWS),
     "Write the rays whose answer is marginal or wrong to FILE, as --rays-from and `raytally trace --ray "
     "FILE.npy:0` read it"},
    {"seed", 's', "S", RT_TO_INTEGER(work.rays.seed, 0, INT64_MAX),
     "Seed of the random rays and of the families of scenes (default 1)"},
    {"threads", 't', "N", RT_TO_INTEGER(work.rays.threads, 0, 1024),
     "Threads; 0, the default, is all processors"},
    RT_MEMORY_OPTION(work.memory),
    RT_TIME_OPTION("; what is finished stays in --out DIR"),
    {"out", 'o', "DIR", RT_TO_TEXT(work.folder),
     "Write rows to DIR as they are finished, then tables (verify.csv, verify.md), and replay files of wrong "
     "answers"},
    {"resume", 0, NULL, RT_TO_SET(work.start, RT_START_RESUME), "Continue the interrupted run in --out DIR"},
    {"force", 0, NULL, RT_TO_SET(work.start, RT_START_ANEW),
     "Start over: the results in --out DIR are lost. The last of --resume and --force counts"},
    {"replay", 0, "FILE", RT_TO_TEXT(replay),
     "Trace the ray of a wrong answer again: exit code 1 if the answer is still wrong, 2 if the ray cannot "
     "be traced"},
    {"shrink", 0, "N", RT_TO_TAKE(take_shrink),
     "Reduce the scenes of the first N failures of each accelerator, or of `all`, which takes some seconds "
     "each (default 1, and at most 8 in total)"},
    RT_STRICT_OPTION,
    {"json", 'j', NULL, RT_TO_FLAG(json), "One JSON document on stdout"},
    {0}};

/* ---- what is verified ---- */

/* Verified by default, beside the families: their cameras see materials that reflect and transmit. */
static const char *const default_scenes[] = {"balls:size=2",
                                             "tetra:size=3",
                                             "random:n=0",
                                             "random:n=1",
                                             "random:n=2,shape=mixed",
                                             "random:n=200,shape=mixed",
                                             "random:n=500,shape=triangle",
                                             "random:n=500,distribution=clustered",
                                             "random:n=40,shape=mixed,distribution=coincident",
                                             "random:n=100,shape=mixed,distribution=line",
                                             "random:n=100,shape=mixed,distribution=plane",
                                             "random:n=200,shape=mixed,distribution=stadium"};

/* ---- the scenes ---- */

static RtStatus add_scene(Options *o, const char *spec, RtError *error) {
    if (o->work.scene_count == MOST_SCENES)
        return rt_fail(error, RT_BAD_INPUT, "more than %d scenes: verify fewer at a time", MOST_SCENES);
    o->scenes[o->work.scene_count++] = spec;
    return RT_OK;
}

static RtStatus add_families(Options *o, RtError *error) {
    for (size_t i = 0; i < rt_family_count() && i < MOST_SCENES; i++) {
        rt_family_spec(i, o->work.rays.seed, o->families[i]);
        RT_TRY(add_scene(o, o->families[i], error));
    }
    return RT_OK;
}

static RtStatus add_default(Options *o, RtError *error) {
    for (size_t i = 0; i < sizeof default_scenes / sizeof default_scenes[0]; i++)
        RT_TRY(add_scene(o, default_scenes[i], error));
    return add_families(o, error);
}

static RtStatus add_triangles(Options *o, RtError *error) {
    uint32_t kept = o->work.scene_count;
    RT_TRY(add_default(o, error));
    for (uint32_t i = kept; i < o->work.scene_count; i++) {
        RtScene scene;
        RT_TRY(rt_scene_open(o->scenes[i], &scene, error));
        if (scene.geometry.triangle_count == scene.geometry.object_count) o->scenes[kept++] = o->scenes[i];
        rt_scene_clear(&scene);
    }
    o->work.scene_count = kept;
    return RT_OK;
}

/* Sorts built-in scenes by number of objects; with --quick drops the large ones. */
static RtStatus sort_scenes(Options *o, RtError *error) {
    uint64_t objects[MOST_SCENES];
    uint32_t kept = 0;
    for (uint32_t i = 0; i < o->work.scene_count; i++) {
        const char *scene = o->scenes[i];
        uint64_t count;
        RT_TRY(rt_builtin_objects(scene, &count, error));
        if (o->quick && count > QUICK_OBJECTS) continue;
        uint32_t place = kept++;
        for (; place > 0 && objects[place - 1] > count; place--) {
            objects[place] = objects[place - 1];
            o->scenes[place] = o->scenes[place - 1];
        }
        objects[place] = count;
        o->scenes[place] = scene;
    }
    o->left_out = o->work.scene_count - kept;
    o->work.scene_count = kept;
    return RT_OK;
}

static RtStatus choose_scenes(Options *o, RtError *error) {
    for (uint32_t i = 0; i < o->given_count; i++) {
        const char *given = o->given[i];
        RT_TRY(strcmp(given, "families") == 0    ? add_families(o, error)
               : strcmp(given, "triangles") == 0 ? add_triangles(o, error)
                                                 : add_scene(o, given, error));
    }
    if (o->given_count > 0) return RT_OK;
    RT_TRY(add_default(o, error));
    return sort_scenes(o, error);
}

/* ---- the accelerators ---- */

static RtStatus add_spec(Options *o, const char *spec, bool named, bool judged, RtError *error) {
    if (o->work.spec_count == MOST_SPECS)
        return rt_fail(error, RT_BAD_INPUT, "more than %d accelerators: verify fewer at a time", MOST_SPECS);
    RtVerifySpec *added = &o->specs[o->work.spec_count++];
    *added = (RtVerifySpec){.named = named, .judged = judged};
    snprintf(added->spec, sizeof added->spec, "%s", spec);
    return RT_OK;
}

/* Adds its defaults and its trial, the first two of its spread, unless !`own` (it was named, and these are
 * there); with --spread the rest. */
static RtStatus add_registered(Options *o, const RtAccelOps *ops, bool own, RtError *error) {
    char spec[RT_MAX_SPEC_CHARS];
    size_t whole = ops->trial ? 2 : 1;
    for (size_t n = own ? 0 : whole; (n < whole || o->spread) && rt_spread_spec(ops, n, spec); n++)
        RT_TRY(add_spec(o, spec, false, !own, error));
    return RT_OK;
}

/* Also as its trial (rt_trial_spec). */
static RtStatus add_named(Options *o, const char *text, RtError *error) {
    RtSpec spec;
    char trial[RT_MAX_SPEC_CHARS];
    RT_TRY(rt_spec_parse(text, &spec, error));
    RT_TRY(add_spec(o, text, true, true, error));
    if (rt_trial_spec(text, trial)) RT_TRY(add_spec(o, trial, true, true, error));
    return add_registered(o, spec.layers[0].ops, false, error);
}

static RtStatus choose(Options *o, RtError *error) {
    RtVerifyRays *rays = &o->work.rays;
    if (o->accel_count == 0 && !o->hits_from) o->accels[o->accel_count++] = "all";
    if (rays->count == 0) rays->count = o->quick ? QUICK_RAYS : MANY_RAYS;
    o->work.scenes = o->scenes;
    o->work.specs = o->specs;
    RT_TRY(choose_scenes(o, error));
    for (uint32_t i = 0; i < o->accel_count; i++) {
        const bool all = strcmp(o->accels[i], "all") == 0;
        if (!all) RT_TRY(add_named(o, o->accels[i], error));
        for (size_t k = 0; all && k < rt_accel_count(); k++)
            RT_TRY(add_registered(o, rt_accel_at(k), true, error));
    }
    if (o->hits_from && strlen(o->hits_from) >= RT_MAX_SPEC_CHARS)
        return rt_fail(error, RT_BAD_INPUT, "%s: this name is too long", o->hits_from);
    if (o->hits_from) {
        RT_TRY(add_spec(o, o->hits_from, true, true, error));
        o->specs[o->work.spec_count - 1].recorded = true;
    }
    if (!o->rays_from) return RT_OK;
    RT_TRY(rt_rays_load(o->rays_from, RT_RAY_RANDOM, &o->given_rays, error));
    rays->given = &o->given_rays;
    rays->count = o->given_rays.count;
    return RT_OK;
}

/* ---- what is shown ---- */

typedef struct Show {
    const Options *options;
    int widths[RT_MAX_TABLE_COLUMNS]; /* of columns; 0: the header is not yet printed */
    bool failed;
    double start, drawn; /* wall seconds */
} Show;

/* Redrawn at most ten times a second. From the first call on, --out has the journal. */
static void on_doing(void *context, const RtVerifyProgress *p) {
    Show *show = context;
    const RtVerify *work = &show->options->work;
    double now = rt_wall_seconds(), passed = now - show->start;
    if (work->folder) rt_stop_continue(work->folder, show->options->go_on);
    if (!isatty(STDERR_FILENO) || now - show->drawn < 0.1) return;
    show->drawn = now;
    fprintf(stderr, "\r\033[Kverify: scene %u of %u, %s: %s", p->scene + 1, work->scene_count,
            work->scenes[p->scene], p->what);
    if (p->done > 0 && passed > 0) {
        char left[RT_MAX_DURATION];
        rt_format_duration(passed * (double)(p->all - p->done) / (double)p->done, left);
        fprintf(stderr, ", about %s left", left);
    }
    fflush(stderr);
}

static void widen(int *width, const char *text) {
    if ((int)strlen(text) > *width) *width = (int)strlen(text);
}

static const RtTable columns = {.groups = rt_verify_text, .group_count = RT_VERIFY_TEXT_GROUPS};

static void print_header(Show *show) {
    const RtVerify *work = &show->options->work;
    if (show->widths[0]) return;
    rt_table_widths(&columns, show->widths);
    for (uint32_t i = 0; i < work->scene_count; i++) widen(&show->widths[0], work->scenes[i]);
    for (uint32_t i = 0; i < work->spec_count; i++) widen(&show->widths[1], work->specs[i].spec);
    for (int i = 2; i < RT_MAX_TABLE_COLUMNS; i++) widen(&show->widths[i], "20000000"); /* the most rays */
    rt_table_line(&columns, show->widths, NULL, stdout);
}

static void print_replay(const json_t *wrong) {
    char plugins[1024] = "";
    const json_t *left = json_object_get(wrong, "objects_left");
    if (json_is_null(left)) {
        printf("    Traced again, the answer is right. ");
    } else if (json_is_true(json_object_get(wrong, "shrunk"))) {
        printf("    Reduced to %lld object%s. ", (long long)json_integer_value(left),
               rt_plural((uint64_t)json_integer_value(left)));
    } else {
        printf("    The scene is not reduced: only the first failures are (--shrink). ");
    }
    rt_cli_plugin_arguments(plugins, sizeof plugins);
    if (json_is_null(json_object_get(wrong, "replay")))
        puts("The replay file could not be written.");
    else
        printf("To repeat: raytally verify --replay '%s'%s\n", rt_json_text(wrong, "replay", ""), plugins);
}

/* Of a recorded answer: how to trace its ray, if there is no file in the whole scene. */
static void print_near(const json_t *wrong, const char *scene) {
    const json_t *org = json_object_get(wrong, "org"), *dir = json_object_get(wrong, "dir");
    const char *path = rt_json_text(wrong, "replay", "");
    const long long near = json_integer_value(json_object_get(wrong, "objects_left"));
    printf("    %lld object%s near the ray%s. To see it:\n    raytally trace '%s' --ray ", near,
           near == 1 ? " is" : "s are", *path ? ", kept in a scene where they are 0, 1, ..." : "",
           *path ? path : scene);
    for (size_t a = 0; a < 3; a++) printf("%s,", json_string_value(json_array_get(org, a)));
    for (size_t a = 0; a < 3; a++) printf("%s,", json_string_value(json_array_get(dir, a)));
    printf("%s,%s --svg ray.svg\n", rt_json_text(wrong, "tmin", ""), rt_json_text(wrong, "tmax", ""));
}

static void print_row(Show *show, const json_t *row) {
    const json_t *wrong = json_object_get(row, "first_wrong");
    print_header(show);
    rt_table_line(&columns, show->widths, row, stdout);
    if (!json_is_null(wrong)) {
        printf("    WRONG: %s\n", rt_json_text(wrong, "says", ""));
        if (json_is_null(json_object_get(wrong, "kernel")))
            print_near(wrong, rt_json_text(row, "scene", ""));
        else
            print_replay(wrong);
    }
    fflush(stdout);
}

static void on_row(void *context, const json_t *row) {
    Show *show = context;
    rt_progress_clear();
    if (!show->options->json) print_row(show, row);
    const bool refused = !json_is_null(json_object_get(row, "refused"));
    if (refused || !json_is_null(json_object_get(row, "problem")))
        fprintf(stderr, "raytally: %s on %s: %s%s\n", rt_json_text(row, "accel", ""),
                rt_json_text(row, "scene", ""), refused ? "refused: " : "",
                rt_json_text(row, refused ? "refused" : "problem", ""));
    show->failed |= rt_verify_row_fails(row);
}

/* How much could be seen of an accelerator with its own arithmetic, what is wrong with its wrong answers, and
 * which side is right where it differs by more than a tie. */
static void print_judged(const RtVerifySum *sum) {
    uint64_t differ = 0;
    const char *between = "; wrong: ";
    if (sum->judged == 0) return;
    printf("%s has its own arithmetic: %" PRIu64 " of %" PRIu64 " rays have a certain answer, %" PRIu64
           " must hit something",
           sum->name, sum->certain, sum->certain_of, sum->must_hit);
    for (int f = 0; f < RT_FAULT_COUNT; f++) {
        if (sum->faults[f] == 0) continue;
        printf("%s%s %" PRIu64, between, rt_fault_name((RtFault)f), sum->faults[f]);
        between = ", ";
    }
    if (sum->largest_off > 1e-3)
        printf("; t is off by up to %.2g %%, which rounding explains here", 100 * sum->largest_off);
    putchar('\n');
    for (int s = 0; s < RT_SIDE_COUNT; s++) differ += sum->sides[s];
    if (differ == 0) return;
    printf("%s: %" PRIu64 " answer%s to nearest differ%s by more than a tie; exactly right:", sum->name,
           differ, rt_plural(differ), differ == 1 ? "s" : "");
    for (int s = 0; s < RT_SIDE_COUNT; s++) {
        const char *name = s == RT_SIDE_EXPECTED ? rt_accel_truth() : rt_side_name((RtSide)s);
        printf("%s %s %" PRIu64, s ? "," : "", s == RT_SIDE_GOT ? sum->name : name, sum->sides[s]);
    }
    if (sum->missed > 0) printf("; exact hits missed: %" PRIu64, sum->missed);
    putchar('\n');
}

/* The wrong answers of the accelerators that are exact, or of the others. */
static void print_wrong(const RtVerifySum *sums, uint32_t count, bool exact) {
    uint64_t wrong = 0, occluded_wrong = 0, undecided = 0, failed = 0, missed = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (sums[i].exact != exact) continue;
        wrong += sums[i].verdicts[RT_WRONG];
        occluded_wrong += sums[i].occluded_wrong;
        undecided += sums[i].undecided;
        missed += sums[i].missed;
        failed += sums[i].failed;
    }
    if (failed == 0)
        fputs("nothing wrong", stdout);
    else
        printf("%" PRIu64 " wrong", wrong);
    if (missed > 0)
        printf("%s%" PRIu64 " exact hit%s missed", failed == 0 ? " but " : ", ", missed, rt_plural(missed));
    if (occluded_wrong > 0) printf(", %" PRIu64 " occluded wrong", occluded_wrong);
    if (undecided > 0) printf(", %" PRIu64 " row%s undecided", undecided, rt_plural(undecided));
}

static void print_total(const Options *o, const json_t *rows, const RtVerifySum *sums, uint32_t count) {
    RtVerifySum total = rt_verify_total(rows);
    const RtVerify *work = &o->work;
    printf("%u scene%s, %u accelerator%s, %" PRIu64 " ray%s, %" PRIu64 " comparison%s: ", work->scene_count,
           rt_plural(work->scene_count), work->spec_count, rt_plural(work->spec_count), work->rays.count,
           rt_plural(work->rays.count), total.pairs, rt_plural(total.pairs));
    const uint64_t exact = total.pairs - total.judged;
    if (exact > 0 && total.judged > 0) printf("%" PRIu64 " bit for bit, ", exact);
    if (exact > 0 || total.judged == 0) print_wrong(sums, count, true);
    if (exact > 0 && total.judged > 0) printf("; %" PRIu64 " ", total.judged);
    if (total.judged > 0) fputs("by verdicts, ", stdout);
    if (total.judged > 0) print_wrong(sums, count, false);
    const char *between = "; rows that fail: ";
    for (uint32_t i = 0; i < count; i++) {
        if (sums[i].failed == 0) continue;
        printf("%s%u of %s", between, sums[i].failed, sums[i].name);
        between = ", ";
    }
    if (total.refused > 0) printf("; %u row%s refused", total.refused, rt_plural(total.refused));
    putchar('\n');
}

static RtStatus print_totals(const Options *o, const json_t *rows, RtError *error) {
    const uint64_t rays = o->work.rays.count;
    RtVerifySum *sums;
    uint32_t count;
    RtStatus status = rt_verify_sums(rows, false, &sums, &count, error);
    for (uint32_t i = 0; i < count; i++) print_judged(&sums[i]);
    if (status == RT_OK) print_total(o, rows, sums, count);
    rt_free(sums);
    if (status != RT_OK || !o->quick) return status;
    printf("--quick used %" PRIu64 " ray%s per scene instead of %d", rays, rt_plural(rays), MANY_RAYS);
    if (o->left_out > 0) printf(", and left out %u larger scene%s", o->left_out, rt_plural(o->left_out));
    puts(". Omit it for the full check.");
    return RT_OK;
}

static RtStatus verify(const Options *o, bool *failed, RtError *error) {
    Show show = {.options = o, .start = rt_wall_seconds()};
    RtVerifyObserver observer = {on_doing, on_row, rt_progress_notice, &show};
    json_t *rows;
    RtStatus status = rt_verify_run(&o->work, &observer, &rows, error);
    rt_progress_clear();
    if (status == RT_OK && o->json)
        rt_cli_print_json(json_pack("{s:I, s:O}", "seed", (json_int_t)o->work.rays.seed, "rows", rows));
    if (status == RT_OK && !o->json) status = print_totals(o, rows, error);
    const RtVerifySum total = status == RT_OK ? rt_verify_total(rows) : (RtVerifySum){0};
    if (total.rows > 0 && total.refused == total.rows) /* refused rows are results, if there are others */
        status = rt_fail(error, RT_BAD_INPUT, "nothing was verified: every accelerator refuses the scene: %s",
                         rt_json_text(json_array_get(rows, 0), "refused", ""));
    json_decref(rows);
    *failed = show.failed;
    return status;
}

/* ---- replaying ---- */

static void print_answer(const char *where, const RtFailure *failure, const RtAnswer *answer) {
    RtWrongAnswer asked = {.index = failure->asked,
                           .occluded = failure->occluded,
                           .counted = failure->counted,
                           .stream = failure->stream,
                           .ray = failure->rays[failure->asked],
                           .expected = answer->expected,
                           .got = answer->got,
                           .blocked = answer->blocked};
    char says[512];
    rt_wrong_answer_format(&asked, says, sizeof says);
    printf("%s: %s: %s\n", where, answer->wrong ? "WRONG" : "right", says);
}

/* Traces the ray in the original scene and in the shrunk one; one of them suffices. */
static RtStatus replay(const Options *o, bool *failed, RtError *error) {
    RT_OWNED(RtReplay, file, rt_replay_clear);
    RtStatus status = RT_OK;
    RT_TRY(rt_replay_load(&file, o->replay, error));
    file.failure.threads = o->work.rays.threads;
    printf("%s on %s\n", file.failure.spec, file.scene_spec);
    uint32_t asked = 0;
    for (int shrunk = 0; shrunk < 2 && status == RT_OK; shrunk++) {
        RtAnswer answer;
        status = rt_replay_ask(&file, shrunk, &answer, error);
        if (status == RT_OK) {
            print_answer(shrunk ? "reduced" : "scene", &file.failure, &answer);
            *failed |= answer.wrong;
            asked++;
        } else if ((shrunk ? status == RT_NOT_AVAILABLE && !file.shrunk_yaml : file.shrunk_yaml != NULL) &&
                   status != RT_NO_MEMORY) {
            fprintf(stderr, "raytally: %s\n", error->message);
            status = RT_OK;
        }
    }
    if (status != RT_OK || asked > 0) return status;
    return rt_fail(error, RT_BAD_INPUT, "%s: the ray cannot be traced again", o->replay);
}

const RtSyntax rt_verify_syntax = {
    .options = options,
    .plugins = true,
    .arguments = "[SCENE...]\n--replay FILE",
    .argument = {.name = "SCENE", .value = RT_TO_LIST(given, given_count)},
    .finish = finish,
    .help =
        "Verify that each accelerator hits the same object as brute, with the same bits of t, for every ray "
        "of each SCENE, in the timed and the counted kernel, ray by ray and in streams. The default is some "
        "fifty small scenes that are hard for accelerators. SCENE may be `triangles`, those that consist of "
        "triangles only; `families`, those generated from a seed; or one of these, as in "
        "family:kind=slivers,seed=7 (`raytally scenes family` lists them).\v"
        "Accelerators with their own hit functions (Embree's native mode, libraries as plugins) are judged "
        "if they are named: equal, tie, marginal (explained by rounding) or wrong. If fewer than 1000 rays, "
        "or half of --rays-from, have an answer that rounding cannot change, the row is undecided, which is "
        "no success. raytally writes the first wrong answer of each row to a file (in --out DIR, or in "
        "verify-failures/), with the scene reduced to the objects that cause it; --replay traces it again. "
        "Exit code 1 if anything is wrong."};

RtStatus rt_command_verify(int argc, char **argv, RtError *error) {
    static Options o;
    o = (Options){.work.rays.seed = 1};
    rt_cli_parse(&rt_verify_syntax, argc, argv, &o);
    snprintf(o.go_on, sizeof o.go_on, "raytally verify --resume");
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--force") != 0 && strcmp(argv[i], "--resume") != 0)
            rt_append_argument(o.go_on, sizeof o.go_on, argv[i]);
    }
    bool failed = false;
    RtStatus status = o.replay ? replay(&o, &failed, error) : choose(&o, error);
    if (status == RT_OK && !o.replay) status = verify(&o, &failed, error);
    rt_rayset_clear(&o.given_rays);
    if (status != RT_OK || !failed) return status;
    *error = (RtError){RT_MISMATCH, ""};
    return RT_MISMATCH;
}
