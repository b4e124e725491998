/* SPDX-License-Identifier: Apache-2.0 */
/* raytally verify: does every accelerator answer every ray like brute? And --replay: does one still answer
 * one ray wrong? What is done lies in verify/verify.h and verify/replay.h; this is its command
 * line. */
#include "base/clock.h"
#include "base/memory.h"
#include "bench/ray_file.h"
#include "cli/cli.h"
#include "cli/plugins.h"
#include "scenes/family.h"
#include "verify/replay.h"
#include "verify/spread.h"
#include "verify/verify.h"
#include "verify/verify_table.h"

#include <argp.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define MAX_SCENES    256
#define MAX_SPECS     512
#define FAMILY_OF_ALL "families" /* as a SCENE */

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

typedef struct Options {
    const char *scenes[MAX_SCENES];
    uint32_t scene_count;
    const char *accels[MAX_SPECS]; /* as given */
    int accel_count;
    bool spread, families, json;
    RtStart start;
    int threads;
    uint64_t rays, seed;
    const char *folder, *replay, *rays_from;
    bool counted_rays;             /* --rays was given */
    RtRaySet given;                /* those of rays_from */
    RtVerifySpec specs[MAX_SPECS]; /* what the accelerators stand for */
    uint32_t spec_count;
    char family_specs[MAX_SCENES][RT_MAX_SPEC_CHARS];
} Options;

enum { KEY_SPREAD = 256, KEY_FAMILIES, KEY_RESUME, KEY_FORCE, KEY_REPLAY, KEY_RAYS_FROM };

static const struct argp_option options[] = {
    {"accel", 'a', "SPEC", 0, "An accelerator, or `all` of them (the default); may be repeated", 0},
    {"spread", KEY_SPREAD, 0, 0, "Also try each parameter at every value worth testing, one at a time", 0},
    {"families", KEY_FAMILIES, 0, 0,
     "Instead of random chords, rays that graze, start and end on surfaces, run along axes, edges and faces; "
     "and, where no SCENE is given, also the families of scenes",
     0},
    {"rays", 'n', "N", 0, "Rays for each scene and accelerator (default 100000)", 0},
    {"rays-from", KEY_RAYS_FROM, "FILE.npy", 0,
     "The rays of FILE in place of all others: an array of float32 of shape (N, 8), as `raytally rays` "
     "writes it. Each "
     "is asked both for its nearest hit and for any",
     0},
    {"seed", 's', "S", 0, "Seed of the random rays and of `families` (default 1)", 0},
    {"threads", 't', "N", 0, "Threads; 0, the default, is all processors", 0},
    {"out", 'o', "DIR", 0,
     "Keep the rows in DIR as they are found, tables of them (verify.csv, verify.md), and what was wrong to "
     "be replayed",
     0},
    {"resume", KEY_RESUME, 0, 0, "Go on with the interrupted run in --out DIR", 0},
    {"force", KEY_FORCE, 0, 0,
     "Start over: the results in --out DIR are lost, which is refused without it. Of --resume and "
     "--force the last one counts",
     0},
    {"replay", KEY_REPLAY, "FILE", 0,
     "Ask again what was answered wrong: exit code 1 if it still is, 2 if it cannot be asked", 0},
    {"json", 'j', 0, 0, "One JSON document on stdout", 0},
    {0}};

static void add_scene(Options *o, const char *spec, struct argp_state *state) {
    if (o->scene_count == MAX_SCENES) argp_error(state, "more than %d scenes", MAX_SCENES);
    o->scenes[o->scene_count++] = spec;
}

/* Every family of scenes, of the seed that is known once all is parsed. */
static void add_families(Options *o, struct argp_state *state) {
    for (size_t i = 0; i < rt_family_count(); i++) {
        char *spec = o->family_specs[i];
        rt_family_spec(i, o->seed, spec);
        add_scene(o, spec, state);
    }
}

/* Without a scene the default ones; `families` stands for all of those. */
static void choose_scenes(Options *o, struct argp_state *state) {
    const char *given[MAX_SCENES];
    uint32_t count = o->scene_count;
    memcpy(given, o->scenes, sizeof given);
    o->scene_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(given[i], FAMILY_OF_ALL) == 0) {
            add_families(o, state);
        } else {
            add_scene(o, given[i], state);
        }
    }
    if (count > 0) return;
    for (size_t i = 0; i < sizeof default_scenes / sizeof default_scenes[0]; i++) {
        add_scene(o, default_scenes[i], state);
    }
    if (o->families) add_families(o, state);
}

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    Options *o = state->input;
    switch (key) {
    case 'a':
        if (o->accel_count == MAX_SPECS) argp_error(state, "more than %d accelerators", MAX_SPECS);
        o->accels[o->accel_count++] = argument;
        return 0;
    case KEY_SPREAD: o->spread = true; return 0;
    case KEY_FAMILIES: o->families = true; return 0;
    case KEY_RESUME: o->start = RT_START_RESUME; return 0;
    case KEY_FORCE: o->start = RT_START_ANEW; return 0;
    case KEY_REPLAY: o->replay = argument; return 0;
    case 'o': o->folder = argument; return 0;
    case KEY_RAYS_FROM: o->rays_from = argument; return 0;
    case 'n':
        o->counted_rays = true;
        o->rays = (uint64_t)rt_cli_integer(state, "--rays", argument, 1, 20000000);
        return 0;
    case 's': o->seed = (uint64_t)rt_cli_integer(state, "--seed", argument, 0, INT64_MAX); return 0;
    case 't': o->threads = (int)rt_cli_integer(state, "--threads", argument, 0, 1024); return 0;
    case 'j': o->json = true; return 0;
    case ARGP_KEY_ARG: add_scene(o, argument, state); return 0;
    case ARGP_KEY_END:
        if (o->replay && (o->scene_count > 0 || o->accel_count > 0 || o->folder || o->json)) {
            argp_error(state,
                       "--replay asks again what is in FILE and prints text: it takes no SCENE, --accel, "
                       "--out or --json");
        }
        if (o->rays_from && (o->families || o->counted_rays || o->replay || o->scene_count == 0)) {
            argp_error(state,
                       "--rays-from has all rays in it, and they belong to a SCENE: name that, and leave "
                       "--rays, --families and --replay out");
        }
        if (o->start != RT_START_FRESH && !o->folder) {
            argp_error(state, "--resume and --force are about the run in --out DIR: name it");
        }
        choose_scenes(o, state);
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

/* ---- which accelerators ---- */

static RtStatus add_spec(Options *o, const char *spec, bool named, RtError *error) {
    if (o->spec_count == MAX_SPECS) {
        return rt_fail(error, RT_BAD_INPUT, "more than %d accelerators: verify fewer at a time", MAX_SPECS);
    }
    RtVerifySpec *c = &o->specs[o->spec_count++];
    *c = (RtVerifySpec){.named = named};
    snprintf(c->spec, sizeof c->spec, "%s", spec);
    return RT_OK;
}

/* The defaults of an accelerator, or its whole spread. */
static RtStatus add_registered(Options *o, const RtAccelOps *ops, size_t first, RtError *error) {
    char spec[RT_MAX_SPEC_CHARS];
    for (size_t n = first; rt_spread_spec(ops, n, spec) && (n == 0 || o->spread); n++) {
        RT_TRY(add_spec(o, spec, false, error));
    }
    return RT_OK;
}

static RtStatus add_named(Options *o, const char *text, RtError *error) {
    RtSpec spec;
    RT_TRY(rt_spec_parse(text, &spec, error));
    RT_TRY(add_spec(o, text, true, error));
    return o->spread ? add_registered(o, spec.layers[0].ops, 1, error) : RT_OK;
}

static RtStatus choose_specs(Options *o, RtError *error) {
    if (o->accel_count == 0) o->accels[o->accel_count++] = "all";
    for (int i = 0; i < o->accel_count; i++) {
        if (strcmp(o->accels[i], "all") != 0) {
            RT_TRY(add_named(o, o->accels[i], error));
            continue;
        }
        for (size_t k = 0; k < rt_accel_count(); k++) {
            RT_TRY(add_registered(o, rt_accel_at(k), 0, error));
        }
    }
    return RT_OK;
}

/* ---- what is shown ---- */

typedef struct Show {
    const Options *options;
    int widths[RT_MAX_TABLE_COLUMNS]; /* of columns; 0: the header is not yet printed */
    bool failed, terminal;
    double start, drawn; /* wall seconds */
} Show;

static void clear_progress(const Show *show) {
    if (show->terminal) fputs("\r\033[K", stderr);
}

/* Redrawn ten times a second at most. */
static void on_doing(void *context, const RtVerifyProgress *p) {
    Show *show = context;
    const Options *o = show->options;
    double now = rt_wall_seconds(), passed = now - show->start;
    if (!show->terminal || now - show->drawn < 0.1) return;
    show->drawn = now;
    fprintf(stderr, "\r\033[Kverify: scene %u of %u, %s: %s", p->scene + 1, o->scene_count,
            o->scenes[p->scene], p->what);
    if (p->done > 0 && passed > 0) {
        double rate = (double)p->done / passed, left = (double)(p->all - p->done) / rate;
        fprintf(stderr, ", %.3g Mrays/s, about %.0f %s left", 1e-6 * rate, left < 120 ? left : left / 60,
                left < 120 ? "s" : "min");
    }
    fflush(stderr);
}

static void widen(int *width, const char *text) {
    if ((int)strlen(text) > *width) *width = (int)strlen(text);
}

static const RtTable columns = {.groups = rt_verify_text, .group_count = RT_VERIFY_TEXT_GROUPS};

static void print_header(Show *show) {
    const Options *o = show->options;
    if (show->widths[0]) return;
    rt_table_widths(&columns, show->widths);
    for (uint32_t i = 0; i < o->scene_count; i++) widen(&show->widths[0], o->scenes[i]);
    for (uint32_t i = 0; i < o->spec_count; i++) widen(&show->widths[1], o->specs[i].spec);
    for (int i = 2; i < RT_MAX_TABLE_COLUMNS; i++) widen(&show->widths[i], "20000000"); /* the most rays */
    rt_table_line(&columns, show->widths, NULL, stdout);
}

static const char *text(const json_t *object, const char *key) {
    const char *value = json_string_value(json_object_get(object, key));
    return value ? value : "";
}

static long long number(const json_t *row, const char *key) {
    return (long long)json_integer_value(json_object_get(row, key));
}

static void print_row(Show *show, const json_t *row) {
    const json_t *wrong = json_object_get(row, "first_wrong");
    print_header(show);
    rt_table_line(&columns, show->widths, row, stdout);
    if (!json_is_null(wrong)) {
        printf("    WRONG: %s\n", text(wrong, "says"));
        const json_t *left = json_object_get(wrong, "objects_left");
        if (json_is_integer(left)) {
            printf("    It takes %lld object%s of the scene. ", number(wrong, "objects_left"),
                   number(wrong, "objects_left") == 1 ? "" : "s");
        } else {
            printf("    Asked again, the answer is right. ");
        }
        printf("To repeat: raytally verify --replay '%s'\n", text(wrong, "replay"));
    }
    fflush(stdout);
}

static void on_row(void *context, const json_t *row) {
    Show *show = context;
    clear_progress(show);
    if (!show->options->json) print_row(show, row);
    if (!json_is_null(json_object_get(row, "problem"))) {
        fprintf(stderr, "raytally: %s on %s: %s\n", text(row, "accel"), text(row, "scene"),
                text(row, "problem"));
    }
    show->failed |= rt_verify_row_fails(row);
}

static void on_notice(void *context, const char *message) {
    clear_progress(context);
    fprintf(stderr, "raytally: %s\n", message);
}

/* Who is right where an accelerator that is not exact differs by more than a tie. */
static void print_sides(const RtVerifySum *sum) {
    uint64_t differ = 0;
    for (int s = 0; s < RT_SIDE_COUNT; s++) differ += sum->sides[s];
    if (differ == 0) return;
    printf("%s: %" PRIu64 " answers to nearest differ by more than a tie; exactly right:", sum->name, differ);
    for (int s = 0; s < RT_SIDE_COUNT; s++) {
        printf("%s %s %" PRIu64, s ? "," : "", rt_side_name((RtSide)s), sum->sides[s]);
    }
    putchar('\n');
}

static RtStatus print_totals(const json_t *rows, RtError *error) {
    RtVerifySum *sums;
    uint32_t count;
    RtStatus status = rt_verify_sums(rows, RT_BY_ACCEL, &sums, &count, error);
    if (status == RT_OK) {
        RtVerifySum total = rt_verify_total(sums, count);
        printf("%u row%s, %" PRIu64 " pairs of a ray and an accelerator: %" PRIu64 " wrong", total.rows,
               total.rows == 1 ? "" : "s", total.pairs, total.verdicts[RT_WRONG]);
        if (total.occluded_wrong > 0) printf(", %" PRIu64 " occluded wrong", total.occluded_wrong);
        if (total.failed > 0) printf("; rows that fail: %u", total.failed);
        putchar('\n');
        for (uint32_t i = 0; i < count; i++) print_sides(&sums[i]);
    }
    rt_free(sums);
    return status;
}

static RtStatus verify(const Options *o, bool *failed, RtError *error) {
    Show show = {.options = o, .terminal = isatty(STDERR_FILENO) == 1, .start = rt_wall_seconds()};
    RtVerifyObserver observer = {on_doing, on_row, on_notice, &show};
    RtVerify work = {.scenes = o->scenes,
                     .scene_count = o->scene_count,
                     .specs = o->specs,
                     .spec_count = o->spec_count,
                     .rays = {o->rays, o->seed, o->families, o->threads, o->rays_from ? &o->given : NULL},
                     .folder = o->folder,
                     .start = o->start};
    json_t *rows;
    RtStatus status = rt_verify_run(&work, &observer, &rows, error);
    clear_progress(&show);
    if (status == RT_OK && o->json) {
        rt_cli_print_json(json_pack("{s:I, s:O}", "seed", (json_int_t)o->seed, "rows", rows));
    }
    if (status == RT_OK && !o->json) status = print_totals(rows, error);
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

/* The scene as it was, and what was left of it. Where one cannot be asked any more the other will do. */
static RtStatus replay(const Options *o, bool *failed, RtError *error) {
    RtReplay file;
    RtStatus status = RT_OK;
    RT_TRY(rt_replay_load(&file, o->replay, error));
    RtMaker maker = rt_maker_of_spec(file.accel_spec);
    maker.threads = o->threads;
    printf("%s on %s\n", file.accel_spec, file.scene_spec);
    uint32_t asked = 0;
    for (int shrunk = 0; shrunk < 2 && status == RT_OK; shrunk++) {
        RtAnswer answer;
        status = rt_replay_ask(&file, maker, shrunk, &answer, error);
        if (status == RT_OK) {
            print_answer(shrunk ? "shrunk" : "scene", &file.failure, &answer);
            *failed |= answer.wrong;
            asked++;
        } else if ((shrunk ? status == RT_NOT_AVAILABLE && !file.shrunk_yaml : file.shrunk_yaml != NULL) &&
                   status != RT_NO_MEMORY) {
            fprintf(stderr, "raytally: %s\n", error->message);
            status = RT_OK;
        }
    }
    rt_replay_clear(&file);
    if (status != RT_OK || asked > 0) return status;
    return rt_fail(error, RT_BAD_INPUT, "%s: none of it can be asked again", o->replay);
}

static const struct argp_child children[] = {{&rt_plugin_argp, 0, NULL, 0}, {0}};
const struct argp rt_verify_argp = {
    .options = options,
    .parser = parse_option,
    .args_doc = "[SCENE...]\n--replay FILE",
    .doc = "Verify that accelerators answer every ray of each SCENE (a few small built-in ones if none is "
           "given) like brute: the same object and the same bits of t, timed and counted, singly and in "
           "streams. SCENE may be `families`, generated scenes that are hard on accelerators, or one of "
           "them, as in family:kind=slivers,seed=7 (`raytally scenes family` names them all).\v"
           "Those that compute in arithmetic of their own (Embree's native mode) get verdicts: equal, tie, "
           "marginal (explained by rounding) or wrong. The first wrong answer of each row is written to a "
           "file (in --out DIR, else in verify-failures/), with the scene shrunk to the objects that it "
           "takes; --replay asks it again. Exit code 1 if anything is wrong.",
    .children = children};

int rt_command_verify(int argc, char **argv) {
    static Options o;
    o = (Options){.rays = 100000, .seed = 1};
    argp_parse(&rt_verify_argp, argc, argv, 0, 0, &o);
    RtError error;
    bool failed = false;
    RtStatus status = o.replay ? replay(&o, &failed, &error) : choose_specs(&o, &error);
    if (status == RT_OK && o.rays_from) {
        status = rt_rays_load(o.rays_from, RT_RAY_RANDOM, &o.given, &error);
        o.rays = o.given.count;
    }
    if (status == RT_OK && !o.replay) status = verify(&o, &failed, &error);
    rt_rayset_clear(&o.given);
    if (status != RT_OK) return rt_cli_fail(&error);
    return failed ? RT_EXIT_CHECK_FAILED : RT_EXIT_OK;
}
