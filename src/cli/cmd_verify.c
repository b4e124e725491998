/* raytally verify: does every accelerator answer every ray like brute?
 *
 * Half of the rays come from a small frame of the scene's camera, in equal shares of primary, shadow,
 * reflection, transmission and diffuse rays as far as the scene produces them. The others are random chords
 * or, with --families, rays of every family that is hard on accelerators, in equal shares. */
#include "base/memory.h"
#include "cli/cli.h"
#include "experiments/equivalence.h"
#include "experiments/families.h"
#include "experiments/rayset.h"
#include "experiments/spread.h"
#include "scene/load.h"

#include <argp.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define MAX_SCENES  64
#define MAX_SPECS   512
#define FRAME_DEPTH 4

/* More marginal answers than this part of all rays are too many to be called margins; rays of the families
 * are aimed at the margins, and may have any number. */
#define MARGINAL_PART 0.01

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

/* One accelerator to verify. Those that were not asked for by name may be missing on this machine. */
typedef struct Contender {
    char spec[RT_MAX_SPEC_CHARS];
    bool named;
} Contender;

typedef struct Options {
    const char *scenes[MAX_SCENES];
    int scene_count;
    const char *accels[MAX_SPECS]; /* as given */
    int accel_count;
    bool spread, families, json;
    int threads;
    uint64_t rays, seed;
    Contender contenders[MAX_SPECS]; /* what they stand for */
    int contender_count;
} Options;

enum { KEY_SPREAD = 256, KEY_FAMILIES };

static const struct argp_option options[] = {
    {"accel", 'a', "SPEC", 0, "An accelerator, or `all` of them (the default); may be repeated", 0},
    {"spread", KEY_SPREAD, 0, 0, "Also each parameter of each at every value worth testing, one at a time",
     0},
    {"families", KEY_FAMILIES, 0, 0,
     "Instead of random chords, rays that graze, start and end on surfaces, run along axes, edges and faces",
     0},
    {"rays", 'n', "N", 0, "Rays for each scene and accelerator (default 100000)", 0},
    {"seed", 's', "S", 0, "Of the random rays (default 1)", 0},
    {"threads", 't', "N", 0, "Threads; 0, the default, is all processors", 0},
    {"json", 'j', 0, 0, "One JSON document on stdout", 0},
    {0}};

static error_t parse_option(int key, char *argument, struct argp_state *state) {
    Options *o = state->input;
    switch (key) {
    case 'a':
        if (o->accel_count == MAX_SPECS) argp_error(state, "more than %d accelerators", MAX_SPECS);
        o->accels[o->accel_count++] = argument;
        return 0;
    case KEY_SPREAD: o->spread = true; return 0;
    case KEY_FAMILIES: o->families = true; return 0;
    case 'n': o->rays = (uint64_t)rt_cli_integer(state, "--rays", argument, 1, 20000000); return 0;
    case 's': o->seed = (uint64_t)rt_cli_integer(state, "--seed", argument, 0, INT64_MAX); return 0;
    case 't': o->threads = (int)rt_cli_integer(state, "--threads", argument, 0, 1024); return 0;
    case 'j': o->json = true; return 0;
    case ARGP_KEY_ARG:
        if (o->scene_count == MAX_SCENES) argp_error(state, "more than %d scenes", MAX_SCENES);
        o->scenes[o->scene_count++] = argument;
        return 0;
    default: return ARGP_ERR_UNKNOWN;
    }
}

/* ---- which accelerators ---- */

static RtStatus add_contender(Options *o, const char *spec, bool named, RtError *error) {
    if (o->contender_count == MAX_SPECS) {
        return rt_fail(error, RT_BAD_INPUT, "more than %d accelerators: verify fewer at a time", MAX_SPECS);
    }
    Contender *c = &o->contenders[o->contender_count++];
    snprintf(c->spec, sizeof c->spec, "%s", spec);
    c->named = named;
    return RT_OK;
}

/* The defaults of an accelerator, or its whole spread. */
static RtStatus add_registered(Options *o, const RtAccelOps *ops, size_t first, RtError *error) {
    char spec[RT_MAX_SPEC_CHARS];
    for (size_t n = first; rt_spread_spec(ops, n, spec) && (n == 0 || o->spread); n++) {
        RT_TRY(add_contender(o, spec, false, error));
    }
    return RT_OK;
}

static RtStatus add_named(Options *o, const char *text, RtError *error) {
    RtSpec spec;
    RT_TRY(rt_spec_parse(text, &spec, error));
    RT_TRY(add_contender(o, text, true, error));
    return o->spread ? add_registered(o, spec.layers[0].ops, 1, error) : RT_OK;
}

static RtStatus choose_contenders(Options *o, RtError *error) {
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

/* ---- which rays ---- */

/* Has the scene sampled by about `samples` samples in the shape of the camera's image. */
static RtStatus sample_sparsely(RtScene *scene, uint64_t samples, RtError *error) {
    double aspect = (double)scene->camera.width / (double)scene->camera.height;
    double width = fmin(fmax(sqrt((double)samples * aspect), 1), RT_MAX_IMAGE_SIDE);
    double height = fmin(fmax(width / aspect, 1), RT_MAX_IMAGE_SIDE);
    return rt_scene_sample(scene, (uint32_t)width, (uint32_t)height, 1, false, error);
}

/* Appends at most `limit` rays of `set`, evenly spread. */
static RtStatus append(RtRay *rays, uint64_t *count, const RtRaySet *set, uint64_t limit, RtError *error) {
    RtRaySet thin;
    if (limit == 0) return RT_OK;
    RT_TRY(rt_rayset_limit(set, limit, 1, &thin, error));
    memcpy(rays + *count, thin.rays, thin.count * sizeof(RtRay));
    *count += thin.count;
    rt_rayset_clear(&thin);
    return RT_OK;
}

/* Appends the share of each kind of ray that the camera's frame produces in half of all. */
static RtStatus append_camera_rays(const Options *o, const RtAccel *brute, RtRay *rays, uint64_t *count,
                                   RtError *error) {
    RtRecording recording = {.depth = FRAME_DEPTH, .seed = o->seed, .threads = o->threads};
    RtRaySet sets[RT_RAY_KIND_COUNT];
    RT_TRY(rt_rayset_record(sets, brute, &recording, error));
    uint64_t kinds = 0;
    for (int kind = 0; kind < RT_RAY_RANDOM; kind++) kinds += sets[kind].count > 0;
    RtStatus status = RT_OK;
    for (int kind = 0; kind < RT_RAY_RANDOM && status == RT_OK; kind++) {
        if (sets[kind].count > 0) status = append(rays, count, &sets[kind], o->rays / 2 / kinds, error);
    }
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_rayset_clear(&sets[kind]);
    return status;
}

/* Fills rays[0..o->rays): what the camera's kinds leave of their half goes to the families, the first of
 * which is the chords. */
static RtStatus make_rays(const Options *o, const RtAccel *brute, RtRay *rays, RtError *error) {
    RtQuery query;
    uint64_t count = 0, families = o->families ? rt_ray_family_count() : 1;
    RT_TRY(append_camera_rays(o, brute, rays, &count, error));
    RT_TRY(rt_query_init(&query, brute, error));
    uint64_t left = o->rays - count;
    for (uint64_t f = 0; f < families; f++) {
        uint64_t first = left * f / families, end = left * (f + 1) / families;
        rt_ray_family_fill((size_t)f, &query, o->seed, 0, (size_t)(end - first), rays + count + first);
    }
    rt_query_clear(&query);
    return RT_OK;
}

/* ---- verifying ---- */

typedef struct Run {
    const Options *options;
    json_t *rows;
    int scene;                   /* index, for progress */
    int scene_width, spec_width; /* of the columns */
    bool header_printed, failed, progress;
} Run;

static void show_progress(const Run *run, const char *scene, const char *what) {
    if (!run->progress) return;
    fprintf(stderr, "\r\033[Kverify: scene %d of %d, %s: %s", run->scene + 1, run->options->scene_count,
            scene, what);
}

static void clear_progress(const Run *run) {
    if (run->progress) fputs("\r\033[K", stderr);
}

static void widen(int *width, const char *text) {
    if ((int)strlen(text) > *width) *width = (int)strlen(text);
}

static void print_header(Run *run) {
    const Options *o = run->options;
    if (run->header_printed) return;
    run->header_printed = true;
    run->scene_width = (int)strlen("scene");
    for (int i = 0; i < o->scene_count; i++) widen(&run->scene_width, o->scenes[i]);
    run->spec_width = (int)strlen("accelerator");
    for (int i = 0; i < o->contender_count; i++) widen(&run->spec_width, o->contenders[i].spec);
    printf("%-*s %-*s %10s %10s %8s %8s %8s %8s\n", run->scene_width, "scene", run->spec_width, "accelerator",
           "rays", "equal", "tie", "marginal", "wrong", "occluded");
}

static void print_row(const Run *run, const RtEquivalence *r, const char *scene, const char *spec) {
    printf("%-*s %-*s %10llu %10llu %8llu %8llu %8llu %8llu\n", run->scene_width, scene, run->spec_width,
           spec, (unsigned long long)r->rays, (unsigned long long)r->verdicts[RT_EQUAL],
           (unsigned long long)r->verdicts[RT_TIE], (unsigned long long)r->verdicts[RT_MARGINAL],
           (unsigned long long)r->verdicts[RT_WRONG], (unsigned long long)r->occluded_wrong);
    if (r->any_wrong) {
        char text[512];
        rt_witness_format(&r->first_wrong, text, sizeof text);
        printf("    WRONG: %s\n", text);
    }
}

static void report(Run *run, const RtEquivalence *result, const char *scene, const char *spec) {
    bool too_marginal = !run->options->families &&
                        (double)result->verdicts[RT_MARGINAL] > MARGINAL_PART * (double)result->rays;
    clear_progress(run);
    if (run->options->json) {
        json_array_append_new(run->rows, rt_equivalence_json(result, scene, spec, "brute"));
    } else {
        print_header(run);
        print_row(run, result, scene, spec);
        fflush(stdout);
    }
    if (too_marginal) {
        fprintf(stderr, "raytally: %s on %s: more than %g %% of the answers are marginal\n", spec, scene,
                MARGINAL_PART * 100);
    }
    run->failed |= result->any_wrong || too_marginal;
}

/* A broken structure is reported like a wrong answer; rays are traced through it all the same. */
static RtStatus verify_built(Run *run, const RtReference *reference, RtAccel *accel, const char *scene,
                             const char *spec, RtError *error) {
    RtStatus status = rt_accel_validate(accel, error);
    if (status == RT_MISMATCH) {
        clear_progress(run);
        fprintf(stderr, "raytally: %s on %s: %s\n", spec, scene, error->message);
        run->failed = true;
    } else {
        RT_TRY(status);
    }
    RtEquivalence result;
    RT_TRY(rt_equivalence_check(reference, accel, run->options->threads, &result, error));
    report(run, &result, scene, spec);
    return RT_OK;
}

static RtStatus verify_contender(Run *run, const RtReference *reference, const char *scene,
                                 const Contender *contender, RtError *error) {
    RtAccel *accel;
    show_progress(run, scene, contender->spec);
    RtStatus status = rt_accel_open(contender->spec, reference->scene, &accel, error);
    if (status == RT_NOT_AVAILABLE && !contender->named) {
        clear_progress(run);
        fprintf(stderr, "raytally: %s is skipped: %s\n", contender->spec, error->message);
        return RT_OK;
    }
    RT_TRY(status);
    status = verify_built(run, reference, accel, scene, contender->spec, error);
    rt_accel_destroy(accel);
    return status;
}

static RtStatus verify_with(Run *run, const RtAccel *brute, RtRay *rays, const char *name, RtError *error) {
    const Options *o = run->options;
    RtReference reference;
    show_progress(run, name, "recording rays");
    RT_TRY(make_rays(o, brute, rays, error));
    show_progress(run, name, "answering them by brute force");
    RT_TRY(rt_reference_init(&reference, brute, rays, o->rays, o->threads, error));
    RtStatus status = RT_OK;
    for (int i = 0; i < o->contender_count && status == RT_OK; i++) {
        status = verify_contender(run, &reference, name, &o->contenders[i], error);
    }
    rt_reference_clear(&reference);
    return status;
}

static RtStatus verify_scene(Run *run, const char *name, RtError *error) {
    RtScene scene;
    RtAccel *brute = NULL;
    RT_TRY(rt_scene_open(name, &scene, error));
    RtStatus status = sample_sparsely(&scene, run->options->rays / 4, error);
    if (status == RT_OK) status = rt_accel_open("brute", &scene, &brute, error);
    if (status == RT_OK) {
        RtRay *rays = rt_alloc(run->options->rays, sizeof(RtRay));
        status = rays ? verify_with(run, brute, rays, name, error)
                      : rt_fail_memory(error, "rays", run->options->rays * sizeof(RtRay));
        rt_free(rays);
    }
    rt_accel_destroy(brute);
    rt_scene_clear(&scene);
    return status;
}

static RtStatus verify_all(Run *run, RtError *error) {
    const Options *o = run->options;
    for (run->scene = 0; run->scene < o->scene_count; run->scene++) {
        RT_TRY(verify_scene(run, o->scenes[run->scene], error));
    }
    clear_progress(run);
    return RT_OK;
}

int rt_command_verify(int argc, char **argv) {
    static Options o;
    o = (Options){.rays = 100000, .seed = 1};
    const struct argp argp = {
        .options = options,
        .parser = parse_option,
        .args_doc = "[SCENE...]",
        .doc =
            "Verify that accelerators answer every ray of each SCENE (a few small built-in ones if none is "
            "given) like brute: the same object and the same bits of t, timed and counted, singly and in "
            "streams.\v"
            "Those that compute in arithmetic of their own (Embree's native mode) get verdicts: equal, tie, "
            "marginal (explained by rounding) or wrong. Exit code 1 if anything is wrong."};
    argp_parse(&argp, argc, argv, 0, 0, &o);
    if (o.scene_count == 0) {
        o.scene_count = sizeof default_scenes / sizeof default_scenes[0];
        memcpy(o.scenes, default_scenes, sizeof default_scenes);
    }
    RtError error;
    Run run = {.options = &o, .rows = json_array(), .progress = isatty(STDERR_FILENO)};
    RtStatus status = choose_contenders(&o, &error);
    if (status == RT_OK) status = verify_all(&run, &error);
    if (status == RT_OK && o.json) {
        rt_cli_print_json(json_pack("{s:I, s:O}", "seed", (json_int_t)o.seed, "rows", run.rows));
    }
    json_decref(run.rows);
    if (status != RT_OK) {
        clear_progress(&run);
        return rt_cli_fail(&error);
    }
    return run.failed ? RT_EXIT_CHECK_FAILED : RT_EXIT_OK;
}
