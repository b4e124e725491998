/* SPDX-License-Identifier: Apache-2.0 */
/* The embedding interface without measuring (measuring.c): versions, names, scenes, accelerators, tracers,
 * sets of rays, pictures; and checks that the plain types of the interface have the layout of raytally's own.
 */
#include "accel/plugin.h"
#include "core/base/memory.h"
#include "library/library.h"
#include "measure/measure.h"
#include "render/frame.h"
#include "scenes/open.h"

#include <inttypes.h>
#include <string.h>

#define SAME_PLACE(Public, Own, member)                                                                      \
    _Static_assert(offsetof(Public, member) == offsetof(Own, member) &&                                      \
                       sizeof((Public){0}.member) == sizeof((Own){0}.member),                                \
                   #Public " is laid out as " #Own)
SAME_PLACE(raytally_ray, RtRay, org);
SAME_PLACE(raytally_ray, RtRay, tmin);
SAME_PLACE(raytally_ray, RtRay, dir);
SAME_PLACE(raytally_ray, RtRay, tmax);
SAME_PLACE(raytally_ray, RtRay, kind);
SAME_PLACE(raytally_ray, RtRay, source);
SAME_PLACE(raytally_hit, RtHit, t);
SAME_PLACE(raytally_hit, RtHit, object);
SAME_PLACE(raytally_error, RtError, status);
SAME_PLACE(raytally_error, RtError, message);
_Static_assert(sizeof(raytally_ray) == sizeof(RtRay) && sizeof(raytally_hit) == sizeof(RtHit) &&
                   sizeof(raytally_error) == sizeof(RtError),
               "arrays of them are laid out alike");

#define SAME_KIND(CONSTANT, name, meaning)                                                                   \
    _Static_assert((int)RAYTALLY_##CONSTANT == (int)RT_RAY_##CONSTANT, #name);
RT_RAY_KINDS(SAME_KIND)
_Static_assert((int)RAYTALLY_RAY_KINDS == (int)RT_RAY_KIND_COUNT, "kinds of rays are the same");

/* Each counter has the offset of the tally's member of its name: rt_counters_add copies them. */
#define SAME_COUNTER(CONSTANT, name)                                                                         \
    _Static_assert(RAYTALLY_##CONSTANT * sizeof(uint64_t) == offsetof(RtTally, name), #name);
SAME_COUNTER(RAYS, rays)
SAME_COUNTER(HITS, hits)
SAME_COUNTER(OBJECT_TESTS, object_tests)
SAME_COUNTER(OBJECT_HITS, object_hits)
SAME_COUNTER(EXTENT_TESTS, extent_tests)
SAME_COUNTER(STEPS, steps)
SAME_COUNTER(LEAF_STEPS, leaf_steps)
SAME_COUNTER(EMPTY_STEPS, empty_steps)
SAME_COUNTER(CSG_TESTS, csg_tests)
SAME_COUNTER(REPEATS_AVOIDED, repeats_avoided)
SAME_COUNTER(PASSED_ON, passed_on)
SAME_COUNTER(INSTANCES_ENTERED, instances_entered)
_Static_assert((int)RAYTALLY_COUNTERS_KNOWN == (int)RT_TALLY_COUNTER_COUNT, "none is left out");

/* The room in structs of results is part of the binary interface. */
_Static_assert(RAYTALLY_MAX_RAY_KINDS == 16 && RAYTALLY_COUNTERS == 32 && RAYTALLY_STATISTICS == 32 &&
                   sizeof(raytally_verify_result) == 128 && sizeof(raytally_estimate) == 64 &&
                   sizeof(raytally_time) == 192,
               "the size of results does not change");
_Static_assert((int)RAYTALLY_RAY_KINDS <= (int)RAYTALLY_MAX_RAY_KINDS &&
                   (int)RAYTALLY_COUNTERS_KNOWN <= (int)RAYTALLY_COUNTERS &&
                   (int)RAYTALLY_STATISTICS_KNOWN <= (int)RAYTALLY_STATISTICS,
               "and is large enough");

/* A member that a later header adds to options must lie beyond their size here, not in padding, which an
 * older program leaves unset. */
#define ENDS_WITH(Options, member)                                                                           \
    _Static_assert(sizeof(Options) == offsetof(Options, member) + sizeof((Options){0}.member),               \
                   #Options " has no padding at its end")
ENDS_WITH(raytally_objects, reserved);
ENDS_WITH(raytally_record_options, limit);
/* NOLINTNEXTLINE(bugprone-sizeof-expression): the size of a pointer is meant */
ENDS_WITH(raytally_verify_options, given);
ENDS_WITH(raytally_time_options, seed);

_Static_assert(RAYTALLY_NO_OBJECT == RT_NO_OBJECT, "a miss is the same");
_Static_assert(RAYTALLY_SPEC_CHARS == RT_MAX_SPEC_CHARS, "specs are as long");

#define SAME_STATUS(name) ((int)RAYTALLY_##name == (int)RT_##name)
_Static_assert(SAME_STATUS(OK) && SAME_STATUS(MISMATCH) && SAME_STATUS(BROKEN) && SAME_STATUS(BAD_INPUT) &&
                   SAME_STATUS(NOT_AVAILABLE) && SAME_STATUS(NO_MEMORY) && SAME_STATUS(IO),
               "a status is the same");

int raytally_abi_version(void) {
    return RAYTALLY_ABI_VERSION;
}

const char *raytally_version(void) {
    return RT_VERSION;
}

const char *raytally_counter_name(enum raytally_counter counter) {
    return (unsigned)counter < RT_TALLY_COUNTER_COUNT ? rt_tally_name((size_t)counter) : NULL;
}

const char *raytally_ray_kind_name(enum raytally_ray_kind kind) {
    return (unsigned)kind < RT_RAY_KIND_COUNT ? rt_ray_kind_name((RtRayKind)kind) : NULL;
}

/* More than the options of any version: a larger size was never set. */
enum { MOST_OPTION_BYTES = 4096 };

RtStatus rt_options_take(void *own, size_t size, const void *given, const char *what, RtError *error) {
    size_t given_size;
    if (!given) return RT_OK;
    memcpy(&given_size, given, sizeof given_size);
    if (given_size < sizeof given_size || given_size > MOST_OPTION_BYTES)
        return rt_fail(error, RT_BAD_INPUT, "%s: its size cannot be %zu bytes: initialise it first", what,
                       given_size);
    for (size_t i = size; i < given_size; i++) {
        if (((const unsigned char *)given)[i] == 0) continue;
        return rt_fail(error, RT_NOT_AVAILABLE,
                       "%s: byte %zu is set, but raytally " RT_VERSION " knows only %zu bytes", what, i,
                       size);
    }
    memcpy(own, given, given_size < size ? given_size : size);
    return RT_OK;
}

RtStatus rt_threads_check(int threads, RtError *error) {
    if (threads >= 0 && threads <= 1024) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%d threads: expected 1..1024, or 0 for all processors", threads);
}

void rt_counters_add(raytally_counters *sum, const RtTally *part) {
    uint64_t at[RT_TALLY_COUNTER_COUNT];
    memcpy(at, part, sizeof at);
    for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) sum->at[i] += at[i];
}

/* ---- scenes ---- */

/* Moves the scene to a new *out if `status` is RT_OK; else frees it. */
static raytally_status keep_scene(RtScene *made, RtStatus status, raytally_scene **out, RtError *error) {
    *out = status == RT_OK ? rt_alloc(1, sizeof **out) : NULL;
    if (status == RT_OK && !*out) status = rt_fail_memory(error, "a scene", sizeof **out);
    if (status == RT_OK)
        (*out)->scene = *made;
    else
        rt_scene_clear(made);
    return (raytally_status)status;
}

raytally_status raytally_scene_open(const char *spec, raytally_scene **out, raytally_error *error) {
    RtScene made = {0};
    RT_C_LOCALE;
    return keep_scene(&made, rt_scene_open(spec, &made, rt_error_of(error)), out, rt_error_of(error));
}

/* Reports the failure `why` of adding object number `i`. */
static RtStatus fail_object(const RtError *why, const char *what, uint32_t i, RtError *error) {
    return rt_fail(error, why->status, "%s %" PRIu32 " (the first is 0): %.900s", what, i, why->message);
}

static RtStatus add_triangle(RtScene *scene, const raytally_objects *objects, uint32_t i, uint32_t material,
                             RtError *error) {
    RtVec3 vertices[3];
    for (size_t k = 0; k < 3; k++) {
        uint32_t corner = objects->corners[3 * (size_t)i + k];
        if (corner >= objects->vertex_count)
            return rt_fail(error, RT_BAD_INPUT, "corner %zu is vertex %" PRIu32 ", and there are %" PRIu32, k,
                           corner, objects->vertex_count);
        memcpy(&vertices[k], objects->vertices + 3 * (size_t)corner, sizeof vertices[k]);
    }
    return rt_scene_add_triangle(scene, material, vertices, NULL, error);
}

static RtStatus fill(RtScene *scene, const raytally_objects *objects, RtError *error) {
    RtMaterial grey = rt_default_material();
    uint32_t material;
    RtError why;
    rt_scene_init(scene);
    RT_TRY(rt_scene_add_material(scene, &grey, &material, error));
    for (uint32_t i = 0; i < objects->triangle_count; i++) {
        if (add_triangle(scene, objects, i, material, &why) != RT_OK)
            return fail_object(&why, "triangle", i, error);
    }
    for (uint32_t i = 0; i < objects->sphere_count; i++) {
        const float *at = objects->spheres + 4 * (size_t)i;
        if (rt_scene_add_sphere(scene, material, rt_vec3(at[0], at[1], at[2]), at[3], &why) != RT_OK)
            return fail_object(&why, "sphere", i, error);
    }
    return rt_scene_finish(scene, error);
}

raytally_status raytally_scene_from_objects(const raytally_objects *objects, raytally_scene **out,
                                            raytally_error *error) {
    raytally_objects own = RAYTALLY_OBJECTS;
    RtScene made = {0};
    RT_C_LOCALE;
    RtStatus status = rt_options_take(&own, offsetof(raytally_objects, reserved), objects, "raytally_objects",
                                      rt_error_of(error));
    if (status == RT_OK) status = fill(&made, &own, rt_error_of(error));
    return keep_scene(&made, status, out, rt_error_of(error));
}

void raytally_scene_free(raytally_scene *scene) {
    if (!scene) return;
    rt_scene_clear(&scene->scene);
    rt_free(scene);
}

uint32_t raytally_scene_object_count(const raytally_scene *scene) {
    return rt_geometry_id_count(&scene->scene.geometry);
}

void raytally_scene_bounds(const raytally_scene *scene, float low[3], float high[3]) {
    const RtBox *box = &scene->scene.geometry.box;
    memcpy(low, &box->lo, sizeof box->lo);
    memcpy(high, &box->hi, sizeof box->hi);
}

bool raytally_scene_warning(const raytally_scene *scene, uint32_t i, char out[RAYTALLY_WARNING_CHARS]) {
    _Static_assert((int)RT_WARNING_TEXT == RAYTALLY_WARNING_CHARS, "the text fits");
    const RtWarnings *warnings = &scene->scene.warnings;
    out[0] = '\0';
    if (i < warnings->count) rt_warning_text(&warnings->list[i], out);
    return i < warnings->count;
}

void raytally_scene_size(const raytally_scene *scene, uint32_t *width, uint32_t *height) {
    *width = scene->scene.sampling.width;
    *height = scene->scene.sampling.height;
}

/* Accelerators know the samples of the image (item), so a scene must not change once one is built over it. */
static RtStatus check_free(raytally_scene *scene, RtError *error) {
    unsigned count = atomic_load(&scene->accelerators);
    if (count == 0) return RT_OK;
    return rt_fail(
        error, RT_BAD_INPUT,
        "the camera of a scene cannot change once accelerators are built over it: free them first (%u)",
        count);
}

static bool is_place(RtVec3 p) {
    return rt_finite(p) && fabsf(p.x) <= RT_MAX_COORDINATE && fabsf(p.y) <= RT_MAX_COORDINATE &&
           fabsf(p.z) <= RT_MAX_COORDINATE;
}

static RtStatus look(raytally_scene *scene, const raytally_camera *camera, RtError *error) {
    RtCamera looking = scene->scene.camera;
    RtView view;
    memcpy(&looking.from, camera->from, sizeof looking.from);
    memcpy(&looking.at, camera->at, sizeof looking.at);
    memcpy(&looking.up, camera->up, sizeof looking.up);
    looking.fov = camera->fov;
    looking.near = 0;
    RT_TRY(check_free(scene, error));
    if (!(is_place(looking.from) && is_place(looking.at) && is_place(looking.up)))
        return rt_fail(error, RT_BAD_INPUT, "a camera has a coordinate that is not finite, or beyond 5e17");
    RT_TRY(rt_view_init(&view, &looking, scene->scene.sampling, error));
    scene->scene.camera = looking;
    return RT_OK;
}

raytally_status raytally_scene_set_camera(raytally_scene *scene, const raytally_camera *camera,
                                          raytally_error *error) {
    RT_C_LOCALE;
    return (raytally_status)look(scene, camera, rt_error_of(error));
}

raytally_status raytally_scene_set_sampling(raytally_scene *scene, uint32_t width, uint32_t height,
                                            uint32_t samples, raytally_error *error) {
    RT_C_LOCALE;
    RtStatus status = check_free(scene, rt_error_of(error));
    if (status == RT_OK)
        status = rt_scene_sample(&scene->scene, width, height, samples, false, rt_error_of(error));
    return (raytally_status)status;
}

/* ---- accelerators ---- */

size_t raytally_accelerator_count(void) {
    return rt_accel_count();
}

const char *raytally_accelerator_name(size_t i) {
    return rt_accel_at(i)->name;
}

raytally_status raytally_spec_format(const char *spec, char out[RAYTALLY_SPEC_CHARS], raytally_error *error) {
    RtSpec parsed;
    RT_C_LOCALE;
    RtStatus status = rt_spec_parse(spec, &parsed, rt_error_of(error));
    if (status == RT_OK) rt_spec_format(&parsed, out);
    return (raytally_status)status;
}

raytally_status raytally_plugin_load(const char *path, raytally_error *error) {
    RT_C_LOCALE;
    return (raytally_status)rt_plugin_load(path, rt_error_of(error));
}

raytally_status raytally_accelerator_build(const raytally_scene *scene, const char *spec, int threads,
                                           raytally_accelerator **out, raytally_error *error) {
    RtSpec parsed;
    RtAccel *accel = NULL;
    RT_C_LOCALE;
    *out = NULL;
    RtStatus status = rt_threads_check(threads, rt_error_of(error));
    if (status == RT_OK) status = rt_spec_parse(spec, &parsed, rt_error_of(error));
    if (status == RT_OK) status = rt_accel_build(&parsed, &scene->scene, threads, &accel, rt_error_of(error));
    raytally_accelerator *made = status == RT_OK ? rt_alloc(1, sizeof *made) : NULL;
    if (status == RT_OK && !made) {
        rt_accel_destroy(accel);
        status = rt_fail_memory(rt_error_of(error), "an accelerator", sizeof *made);
    }
    if (status != RT_OK) return (raytally_status)status;
    made->accel = accel;
    made->scene = (raytally_scene *)scene; /* it counts its accelerators */
    rt_spec_format(&parsed, made->spec);
    atomic_fetch_add(&made->scene->accelerators, 1);
    *out = made;
    return RAYTALLY_OK;
}

void raytally_accelerator_free(raytally_accelerator *accelerator) {
    if (!accelerator) return;
    RT_C_LOCALE;
    rt_accel_destroy(accelerator->accel);
    atomic_fetch_sub(&accelerator->scene->accelerators, 1);
    rt_free(accelerator);
}

const char *raytally_accelerator_spec(const raytally_accelerator *accelerator) {
    return accelerator->spec;
}

bool raytally_accelerator_exact(const raytally_accelerator *accelerator) {
    return accelerator->accel->exact;
}

raytally_status raytally_accelerator_check(const raytally_accelerator *accelerator, raytally_error *error) {
    RT_C_LOCALE;
    return (raytally_status)rt_accel_check(accelerator->accel, rt_error_of(error));
}

void raytally_accelerator_describe(const raytally_accelerator *accelerator, raytally_statistics *out) {
    RtDescription d;
    RT_C_LOCALE;
    rt_accel_describe(accelerator->accel, &d);
    *out = (raytally_statistics){.at = {
                                     [RAYTALLY_INTERIOR] = (double)d.interior,
                                     [RAYTALLY_LEAVES] = (double)d.leaves,
                                     [RAYTALLY_EMPTY_LEAVES] = (double)d.empty_leaves,
                                     [RAYTALLY_REFERENCES] = (double)d.references,
                                     [RAYTALLY_DEPTH] = (double)d.depth,
                                     [RAYTALLY_BYTES] = (double)d.bytes,
                                     [RAYTALLY_PREDICTED_COST] = d.predicted_cost,
                                     [RAYTALLY_PREDICTED_TESTS] = d.predicted_tests,
                                     [RAYTALLY_PREDICTED_STEPS] = d.predicted_steps,
                                 }};
}

/* ---- tracers ---- */

bool raytally_ray_is_valid(const raytally_ray *ray) {
    return rt_ray_is_valid((const RtRay *)ray) && ray->kind < RAYTALLY_RAY_KINDS;
}

raytally_status raytally_tracer_new(const raytally_accelerator *accelerator, raytally_tracer **out,
                                    raytally_error *error) {
    RT_C_LOCALE;
    raytally_tracer *made = *out = rt_alloc(1, sizeof *made);
    if (!made) return (raytally_status)rt_fail_memory(rt_error_of(error), "a tracer", sizeof *made);
    RtStatus status = rt_query_init(&made->query, accelerator->accel, rt_error_of(error));
    if (status == RT_OK) return RAYTALLY_OK;
    rt_free(made);
    *out = NULL;
    return (raytally_status)status;
}

void raytally_tracer_free(raytally_tracer *tracer) {
    if (!tracer) return;
    RT_C_LOCALE;
    rt_query_clear(&tracer->query);
    rt_free(tracer);
}

void raytally_tracer_begin(raytally_tracer *tracer) {
    RT_C_LOCALE;
    rt_query_begin(&tracer->query);
}

static void add_tallies(raytally_counters *counters, const RtTally *tallies) {
    for (size_t kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_counters_add(&counters[kind], &tallies[kind]);
}

void raytally_nearest(raytally_tracer *tracer, const raytally_ray *rays, size_t count, raytally_hit *hits,
                      raytally_counters *counters) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    RT_C_LOCALE;
    rt_nearest(&tracer->query, (const RtRay *)rays, count, (RtHit *)hits, counters ? tallies : NULL);
    if (counters) add_tallies(counters, tallies);
}

void raytally_occluded(raytally_tracer *tracer, const raytally_ray *rays, size_t count, bool *blocked,
                       raytally_counters *counters) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    RT_C_LOCALE;
    rt_occluded(&tracer->query, (const RtRay *)rays, count, blocked, counters ? tallies : NULL);
    if (counters) add_tallies(counters, tallies);
}

/* ---- sets of rays: recorded, or copied from the caller ---- */

static RtStatus check_kind(enum raytally_ray_kind kind, RtError *error) {
    if ((unsigned)kind < RT_RAY_KIND_COUNT) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "no kind of rays has the number %d", (int)kind);
}

static RtStatus check_recording(const raytally_record_options *how, const RtAccel *accel, RtError *error) {
    RT_TRY(rt_threads_check(how->threads, error));
    if (how->limit < 1 || how->limit > RT_MAX_RAYS_A_KIND)
        return rt_fail(error, RT_BAD_INPUT, "a limit of %llu rays: expected 1..%llu",
                       (unsigned long long)how->limit, (unsigned long long)RT_MAX_RAYS_A_KIND);
    if (accel->exact) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s is not exact: record rays by another accelerator, such as %s",
                   accel->ops->name, rt_accel_default());
}

static RtStatus record(const RtAccel *accel, enum raytally_ray_kind kind, const raytally_record_options *how,
                       RtRaySet *out, RtError *error) {
    RtRaySet sets[RT_RAY_KIND_COUNT] = {0};
    RT_TRY(check_kind(kind, error));
    RT_TRY(check_recording(how, accel, error));
    RtRecording recording = {.depth = how->depth,
                             .seed = how->seed,
                             .random = kind == RAYTALLY_RANDOM ? how->limit : 0,
                             .threads = how->threads};
    RtStatus status = rt_rayset_record(sets, accel, &recording, error);
    if (status == RT_OK) status = rt_rayset_limit(&sets[kind], how->limit, RT_COHERENT_RUN, out, error);
    for (int k = 0; k < RT_RAY_KIND_COUNT; k++) rt_rayset_clear(&sets[k]);
    return status;
}

static RtStatus copy(enum raytally_ray_kind kind, const raytally_ray *rays, size_t count, RtRaySet *out,
                     RtError *error) {
    RT_TRY(check_kind(kind, error));
    RT_TRY(rt_rayset_init(out, (RtRayKind)kind, count, error));
    if (count > 0) memcpy(out->rays, rays, count * sizeof *rays);
    for (size_t i = 0; i < count; i++) {
        out->rays[i].kind = (uint32_t)kind;
        if (rt_ray_is_valid(&out->rays[i])) continue;
        return rt_fail(error, RT_BAD_INPUT, "ray %zu (the first is 0) is not valid: %s", i,
                       rt_ray_fault(&out->rays[i]));
    }
    rt_rayset_seal(out);
    return RT_OK;
}

/* The same for rays. */
static raytally_status keep_rays(RtRaySet *made, RtStatus status, raytally_rays **out, RtError *error) {
    *out = status == RT_OK ? rt_alloc(1, sizeof **out) : NULL;
    if (status == RT_OK && !*out) status = rt_fail_memory(error, "rays", sizeof **out);
    if (status == RT_OK)
        (*out)->set = *made;
    else
        rt_rayset_clear(made);
    return (raytally_status)status;
}

raytally_status raytally_rays_record(const raytally_accelerator *accelerator, enum raytally_ray_kind kind,
                                     const raytally_record_options *how, raytally_rays **out,
                                     raytally_error *error) {
    RtRaySet made = {0};
    raytally_record_options own = RAYTALLY_RECORD_DEFAULTS;
    RT_C_LOCALE;
    RtStatus status = rt_options_take(&own, sizeof own, how, "raytally_record_options", rt_error_of(error));
    if (status == RT_OK) status = record(accelerator->accel, kind, &own, &made, rt_error_of(error));
    return keep_rays(&made, status, out, rt_error_of(error));
}

raytally_status raytally_rays_copy(enum raytally_ray_kind kind, const raytally_ray *rays, size_t count,
                                   raytally_rays **out, raytally_error *error) {
    RtRaySet made = {0};
    RT_C_LOCALE;
    return keep_rays(&made, copy(kind, rays, count, &made, rt_error_of(error)), out, rt_error_of(error));
}

void raytally_rays_free(raytally_rays *rays) {
    if (!rays) return;
    rt_rayset_clear(&rays->set);
    rt_free(rays);
}

size_t raytally_rays_count(const raytally_rays *rays) {
    return (size_t)rays->set.count;
}

const raytally_ray *raytally_rays_data(const raytally_rays *rays) {
    return (const raytally_ray *)rays->set.rays;
}

uint64_t raytally_rays_fingerprint(const raytally_rays *rays) {
    return rays->set.fingerprint;
}

/* ---- pictures ---- */

raytally_status raytally_render(const raytally_accelerator *accelerator, uint32_t depth, int threads,
                                const char *png, float *rgb, raytally_error *error) {
    RT_OWNED(RtFrame, frame, rt_frame_clear);
    RtFrameOptions options = {.depth = depth ? depth : RT_DEFAULT_DEPTH, .threads = threads};
    RT_C_LOCALE;
    RtStatus status = rt_threads_check(threads, rt_error_of(error));
    if (status == RT_OK) status = rt_frame_trace(&frame, accelerator->accel, &options, rt_error_of(error));
    if (status == RT_OK && png) status = rt_png_write(&frame, png, rt_error_of(error));
    for (uint32_t y = 0; status == RT_OK && rgb && y < frame.sampling.height; y++) {
        for (uint32_t x = 0; x < frame.sampling.width; x++, rgb += 3) {
            const RtVec3 color = rt_frame_pixel(&frame, x, y);
            memcpy(rgb, &color, sizeof color);
        }
    }
    return (raytally_status)status;
}
