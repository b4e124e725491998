/* SPDX-License-Identifier: Apache-2.0 */
/* Scenes of the embedding interface: opened, or made from arrays; and the camera. */
#include "core/base/memory.h"
#include "library/library.h"
#include "scenes/open.h"

#include <inttypes.h>
#include <string.h>

/* ---- making ---- */

/* Makes *out with `fill`, which gets a zeroed scene. */
static RtStatus make(RtStatus (*fill)(RtScene *scene, const void *what, RtError *error), const void *what,
                     raytally_scene **out, RtError *error) {
    raytally_scene *made = rt_alloc(1, sizeof *made);
    if (!made) return rt_fail_memory(error, "a scene", sizeof *made);
    RtStatus status = fill(&made->scene, what, error);
    if (status == RT_OK) {
        *out = made;
    } else {
        rt_scene_clear(&made->scene);
        rt_free(made);
    }
    return status;
}

static RtStatus fill_by_spec(RtScene *scene, const void *spec, RtError *error) {
    return rt_scene_open(spec, scene, error);
}

raytally_status raytally_scene_open(const char *spec, raytally_scene **out, raytally_error *error) {
    *out = NULL;
    RT_C_LOCALE;
    return (raytally_status)make(fill_by_spec, spec, out, rt_error_of(error));
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
        if (corner >= objects->vertex_count) {
            return rt_fail(error, RT_BAD_INPUT, "corner %zu is vertex %" PRIu32 ", and there are %" PRIu32, k,
                           corner, objects->vertex_count);
        }
        memcpy(&vertices[k], objects->vertices + 3 * (size_t)corner, sizeof vertices[k]);
    }
    return rt_scene_add_triangle(scene, material, vertices, NULL, error);
}

static RtStatus add_sphere(RtScene *scene, const raytally_objects *objects, uint32_t i, uint32_t material,
                           RtError *error) {
    const float *at = objects->spheres + 4 * (size_t)i;
    return rt_scene_add_sphere(scene, material, rt_vec3(at[0], at[1], at[2]), at[3], error);
}

static RtStatus fill_by_objects(RtScene *scene, const void *what, RtError *error) {
    const raytally_objects *objects = what;
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
        if (add_sphere(scene, objects, i, material, &why) != RT_OK)
            return fail_object(&why, "sphere", i, error);
    }
    return rt_scene_finish(scene, error);
}

raytally_status raytally_scene_from_objects(const raytally_objects *objects, raytally_scene **out,
                                            raytally_error *error) {
    raytally_objects own = RAYTALLY_OBJECTS;
    *out = NULL;
    RT_C_LOCALE;
    RtStatus status = rt_options_take(&own, offsetof(raytally_objects, reserved), objects, "raytally_objects",
                                      rt_error_of(error));
    if (status == RT_OK) status = make(fill_by_objects, &own, out, rt_error_of(error));
    return (raytally_status)status;
}

void raytally_scene_free(raytally_scene *scene) {
    if (!scene) return;
    rt_scene_clear(&scene->scene);
    rt_free(scene);
}

/* ---- size ---- */

uint32_t raytally_scene_object_count(const raytally_scene *scene) {
    return scene->scene.geometry.object_count;
}

void raytally_scene_bounds(const raytally_scene *scene, float low[3], float high[3]) {
    const RtBox *box = &scene->scene.geometry.box;
    memcpy(low, &box->lo, sizeof box->lo);
    memcpy(high, &box->hi, sizeof box->hi);
}

void raytally_scene_size(const raytally_scene *scene, uint32_t *width, uint32_t *height) {
    *width = scene->scene.sampling.width;
    *height = scene->scene.sampling.height;
}

/* ---- camera and sampling ---- */

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
