/* SPDX-License-Identifier: Apache-2.0 */
/* Targets that read scenes and rays, and one that makes both of the bytes and traces them. */
#include "fuzz.h"

#include "core/base/memory.h"
#include "core/scene/load.h"
#include "measure/measure.h"
#include "verify/verify.h"

#include <stdlib.h>
#include <string.h>

/* What other scenes a file may name. */
static RtStatus open_named(const char *spec, RtScene *scene, RtError *error) {
    RtMaterial material = rt_default_material();
    uint32_t index;
    if (strncmp(spec, "balls", 5) != 0) return rt_fail(error, RT_BAD_INPUT, "there is no scene '%s'", spec);
    rt_scene_init(scene);
    RtStatus status = rt_scene_add_material(scene, &material, &index, error);
    if (status == RT_OK) status = rt_scene_add_sphere(scene, index, rt_vec3(1, 2, 3), 1, error);
    if (status == RT_OK) status = rt_scene_finish(scene, error);
    if (status != RT_OK) rt_scene_clear(scene);
    return status;
}

/* ---- answers ---- */

enum { MOST_RAYS = 64, SAMPLES = 8 };

/* Asserts that the accelerator answers the rays like brute; it may refuse the scene. */
static void check_answers(const RtScene *scene, const RtAccel *brute, const RtRay *rays, size_t count,
                          const char *spec) {
    RtReference reference;
    RtEquivalence result;
    RtAccel *accel;
    RtError error = {RT_OK, ""};
    if (!fuzz_accepted(rt_accel_open_on(spec, scene, 1, &accel, &error), &error)) return;
    if (rt_accel_validate(accel, &error) != RT_OK) fuzz_fail("%s: %s", spec, error.message);
    if (!accel->exact) { /* it is judged by verdicts: raytally verify */
        rt_accel_destroy(accel);
        return;
    }
    CHECK(rt_reference_init(&reference, brute, rays, count, 1, &error) == RT_OK);
    CHECK(rt_equivalence_check(&reference, accel, 1, &result, &error) == RT_OK);
    if (result.any_wrong) {
        char text[512];
        rt_wrong_answer_format(&result.first_wrong, text, sizeof text);
        fuzz_fail("%s: %s", spec, text);
    }
    rt_reference_clear(&reference);
    rt_accel_destroy(accel);
}

/* Rays of one family to rays[0..count). */
static void fill_family(const RtAccel *accel, size_t family, uint64_t seed, size_t count, RtRay *rays) {
    RtQuery query;
    RtError error;
    CHECK(rt_query_init(&query, accel, &error) == RT_OK);
    rt_ray_family_fill(family, &query, seed, 0, count, rays);
    rt_query_clear(&query);
}

/* ---- files ---- */

/* A scene that can be read can be written, and is then the same. */
static void check_saving(const RtScene *scene) {
    RtScene again;
    RtError error = {RT_OK, ""};
    char *text = NULL;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    CHECK(file && rt_yaml_save(scene, file, &error) == RT_OK && fclose(file) == 0);
    rt_scene_init(&again);
    if (rt_yaml_load_text("again.yaml", text, open_named, &again, &error) != RT_OK ||
        rt_scene_finish(&again, &error) != RT_OK)
        fuzz_fail("%s\n%s", error.message, text);
    CHECK(rt_scene_fingerprint(&again) == rt_scene_fingerprint(scene));
    rt_scene_clear(&again);
    free(text);
}

void fuzz_scene(const Input *input) {
    enum { MOST_OBJECTS = 200, EACH = 8 };
    RtScene scene;
    RtAccel *brute;
    RtRay rays[2 * EACH];
    RtError error = {RT_OK, ""};
    RtVec3d offset = {{input->size % 4 ? 0 : NAN, 0, 0}}; /* NaN: one is found */
    if (!fuzz_accepted(rt_scene_load(input->path, open_named, &offset, &scene, &error), &error)) return;
    if (scene.geometry.object_count <= MOST_OBJECTS &&
        rt_scene_sample(&scene, SAMPLES, SAMPLES, 1, false, &error) == RT_OK) {
        check_saving(&scene);
        CHECK(rt_accel_open_on(rt_accel_truth(), &scene, 1, &brute, &error) == RT_OK);
        fill_family(brute, 0, 1, EACH, rays);
        fill_family(brute, input->size % rt_ray_family_count(), 1, EACH, rays + EACH);
        check_answers(&scene, brute, rays, 2 * EACH, rt_accel_default());
        rt_accel_destroy(brute);
    }
    rt_scene_clear(&scene);
}

static const char of_library[] = "mtllib library.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                 "usemtl one\nf 1/1 2/2 3/3\nusemtl two words\nf 1/1 2/2 3/3\n";

/* An image to name, from the working folder of tests/fuzz.sh, and a mesh that names the library. */
void fuzz_prepare_mtl(void) {
    RtError error;
    char *png;
    size_t size;
    if (rt_file_read("scenes/globe.png", 1 << 24, &png, &size, &error) != RT_OK)
        fuzz_fail("%s", error.message);
    fuzz_write("image.png", png, size);
    fuzz_write("mesh.obj", of_library, strlen(of_library));
    rt_free(png);
}

void fuzz_mtl(const Input *input) {
    (void)input;
    RtScene scene;
    RtError error = {RT_OK, ""};
    CHECK(rt_scene_load(fuzz_path("mesh.obj"), open_named, NULL, &scene, &error) == RT_OK);
    CHECK(scene.geometry.triangle_count == 2);
    for (uint32_t i = 0; i < scene.material_count; i++) CHECK(rt_finite(scene.materials[i].color));
    rt_scene_clear(&scene);
}

void fuzz_hits(const Input *input) {
    enum { RAYS = 5, OBJECTS = 7 };
    RtHit *hits;
    RtError error = {RT_OK, ""};
    if (!fuzz_accepted(rt_hits_load(input->path, RAYS, OBJECTS, &hits, &error), &error)) return;
    for (int i = 0; i < RAYS; i++) CHECK(hits[i].object < OBJECTS || hits[i].object >= RT_UNNAMED_OBJECT);
    rt_free(hits);
}

void fuzz_rays(const Input *input) {
    RtRaySet set;
    RtError error = {RT_OK, ""};
    if (!fuzz_accepted(rt_rays_load(input->path, RT_RAY_RANDOM, &set, &error), &error)) return;
    for (uint64_t i = 0; i < set.count; i++) CHECK(rt_ray_is_valid(&set.rays[i]));
    rt_rayset_clear(&set);
}

void fuzz_replay(const Input *input) {
    RtReplay replay;
    RtError error = {RT_OK, ""};
    if (!fuzz_accepted(rt_replay_load(&replay, input->path, &error), &error)) return;
    for (size_t i = 0; i < replay.failure.count; i++) CHECK(rt_ray_is_valid(&replay.failure.rays[i]));
    CHECK(replay.failure.asked < replay.failure.count && replay.failure.stream > 0);
    rt_replay_clear(&replay);
}

/* ---- scenes and rays made of the bytes ---- */

typedef struct Bytes {
    const uint8_t *at;
    size_t left;
    float last; /* number taken */
} Bytes;

static uint8_t take_byte(Bytes *bytes) {
    return bytes->left > 0 ? bytes->left--, *bytes->at++ : 0;
}

static uint32_t take_word(Bytes *bytes) {
    uint32_t word = 0;
    for (int i = 0; i < 4; i++) word = word << 8 | take_byte(bytes);
    return word;
}

/* Small multiples of 1/8, which meet each other exactly; the last number again, its opposite and its
 * neighbours; any bits; and numbers at the limits. */
static float take_number(Bytes *bytes) {
    static const float limits[] = {
        0,        -0.0f,    1,          0x1p-149f,         -0x1p-149f,         0x1p-126f,
        0x1p-75f, 1e-20f,   16777216,   RT_MAX_COORDINATE, -RT_MAX_COORDINATE, 6e17f,
        1e38f,    -FLT_MAX, (float)NAN, (float)INFINITY};
    const uint8_t how = take_byte(bytes);
    uint32_t word;
    switch (how % 8) {
    case 0: bytes->last = limits[how / 8 % (sizeof limits / sizeof limits[0])]; break;
    case 1: break;
    case 2: bytes->last = nextafterf(bytes->last, how & 8 ? (float)INFINITY : (float)-INFINITY); break;
    case 3: bytes->last = -bytes->last; break;
    case 4:
        word = take_word(bytes);
        memcpy(&bytes->last, &word, sizeof word);
        break;
    default: bytes->last = (float)((int)take_byte(bytes) - 128) / 8; break;
    }
    return bytes->last;
}

static RtVec3 take_point(Bytes *bytes) {
    RtVec3 p;
    for (int a = 0; a < 3; a++) p.at[a] = take_number(bytes);
    return p;
}

/* Flat, across an axis. */
static RtStatus add_polygon(RtScene *scene, Bytes *bytes, RtError *error) {
    enum { MOST_CORNERS = 9 };
    RtVec3 corners[MOST_CORNERS];
    const uint8_t how = take_byte(bytes);
    const uint32_t axis = how % 3, count = 3 + how / 3 % (MOST_CORNERS - 2);
    const float plane = take_number(bytes);
    for (uint32_t i = 0; i < count; i++) {
        corners[i].at[axis] = plane;
        corners[i].at[(axis + 1) % 3] = take_number(bytes);
        corners[i].at[(axis + 2) % 3] = take_number(bytes);
    }
    return rt_scene_add_polygon(scene, 0, corners, count, error);
}

static RtStatus add_solid(RtSolidSet *set, Bytes *bytes, uint32_t *index, RtError *error) {
    const RtVec3 a = take_point(bytes), b = take_point(bytes);
    const float r = take_number(bytes), s = take_number(bytes);
    switch (take_byte(bytes) % 5) {
    case 0: return rt_solid_add_box(set, a, b, index, error);
    case 1: return rt_solid_add_half_space(set, a, b, index, error);
    case 2: return rt_solid_add_ellipsoid(set, a, b, index, error);
    case 3: return rt_solid_add_frustum(set, a, r, b, s, index, error);
    default: return rt_solid_add_ring(set, a, b, r, s, index, error);
    }
}

static RtStatus add_term(RtCsgBuilder *builder, Bytes *bytes, RtCsgTerm *term, RtError *error) {
    uint32_t solid;
    RT_TRY(add_solid(&builder->set, bytes, &solid, error));
    return rt_csg_solid(builder, solid, 0, term, error);
}

/* One solid, or several from left to right. */
static RtStatus add_tree(RtScene *scene, Bytes *bytes, RtError *error) {
    RtCsgBuilder builder = {0};
    RtCsgTerm tree, right;
    const uint8_t how = take_byte(bytes);
    RtStatus status = add_term(&builder, bytes, &tree, error);
    for (uint32_t i = 0; i < how % 4u && status == RT_OK; i++) {
        const RtCsgOp op = (RtCsgOp)(take_byte(bytes) % 3);
        status = add_term(&builder, bytes, &right, error);
        if (status == RT_OK) status = rt_csg_combine(&builder, op, tree, right, &tree, error);
    }
    if (status == RT_OK) status = rt_scene_add_csg(scene, &builder, tree, how & 4, error);
    rt_csg_builder_clear(&builder);
    return status;
}

static RtStatus add_object(RtScene *scene, Bytes *bytes, RtError *error) {
    RtVec3 p[3];
    float r;
    switch (take_byte(bytes) % 6) {
    case 0: p[0] = take_point(bytes); return rt_scene_add_sphere(scene, 0, p[0], take_number(bytes), error);
    case 1: return add_polygon(scene, bytes, error);
    case 2:
        p[0] = take_point(bytes);
        r = take_number(bytes);
        p[1] = take_point(bytes);
        return rt_scene_add_cone(scene, 0, p[0], r, p[1], take_number(bytes), error);
    case 3: return add_tree(scene, bytes, error);
    default:
        for (int i = 0; i < 3; i++) p[i] = take_point(bytes);
        return rt_scene_add_triangle(scene, 0, p, NULL, error);
    }
}

/* Some of families, and some of the bytes, as far as they are valid. */
static size_t make_rays(const RtAccel *brute, Bytes *bytes, RtRay rays[MOST_RAYS]) {
    enum { EACH = 8, FAMILIES = 4 };
    size_t count = 0;
    for (int i = 0; i < FAMILIES; i++, count += EACH)
        fill_family(brute, take_byte(bytes) % rt_ray_family_count(), take_byte(bytes), EACH, rays + count);
    while (count < MOST_RAYS && bytes->left > 0) {
        RtRay ray = {.kind = RT_RAY_RANDOM};
        ray.org = take_point(bytes);
        ray.dir = take_point(bytes);
        ray.tmin = take_byte(bytes) % 2 ? take_number(bytes) : 0;
        ray.tmax = take_byte(bytes) % 2 ? take_number(bytes) : (float)INFINITY;
        if (rt_ray_is_valid(&ray)) rays[count++] = ray;
    }
    return count;
}

/* The spread of every accelerator. */
static char (*specs)[RT_MAX_SPEC_CHARS];
static uint32_t spec_count, spec_capacity;

void fuzz_prepare_trace(void) {
    char spec[RT_MAX_SPEC_CHARS];
    for (size_t i = 0; i < rt_accel_count(); i++) {
        for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++)
            CHECK(rt_append(&specs, &spec_count, &spec_capacity, spec, sizeof spec, NULL) == RT_OK);
    }
}

/* The first bytes are the spec, so that mutations of the others keep it. */
void fuzz_trace(const Input *input) {
    enum { MOST_OBJECTS = 24 };
    Bytes bytes = {.at = input->bytes, .left = input->size};
    RtError error = {RT_OK, ""};
    RtMaterial material = rt_default_material();
    uint32_t index = (uint32_t)(take_byte(&bytes) << 8);
    RtScene scene;
    RtAccel *brute;
    RtRay rays[MOST_RAYS];
    index = (index | take_byte(&bytes)) % spec_count;
    uint32_t objects = take_byte(&bytes) % (MOST_OBJECTS + 1), made;
    rt_scene_init(&scene);
    CHECK(rt_scene_add_material(&scene, &material, &made, &error) == RT_OK);
    for (uint32_t i = 0; i < objects; i++) fuzz_accepted(add_object(&scene, &bytes, &error), &error);
    if (fuzz_accepted(rt_scene_finish(&scene, &error), &error) &&
        rt_scene_sample(&scene, SAMPLES, SAMPLES, 1, false, &error) == RT_OK) {
        CHECK(rt_accel_open_on(rt_accel_truth(), &scene, 1, &brute, &error) == RT_OK);
        size_t count = make_rays(brute, &bytes, rays);
        check_answers(&scene, brute, rays, count, specs[index]);
        rt_accel_destroy(brute);
    }
    rt_scene_clear(&scene);
}
