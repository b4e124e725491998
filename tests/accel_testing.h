/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of accelerators share: scenes that several of them stand on, rays to lights, and what validate
 * says. */
#ifndef RT_TESTS_ACCEL_TESTING_H
#define RT_TESTS_ACCEL_TESTING_H

#include "testing.h"

#include "accel/accel.h"
#include "core/base/memory.h"

#include <string.h>

/* Asserts that validate of this layer refuses it with a message that holds `phrase`. */
static inline void assert_broken(const RtAccel *accel, const char *phrase) {
    RtError error = {RT_OK, ""};
    assert_int_equal(accel->ops->validate(accel, &error), RT_MISMATCH);
    if (!strstr(error.message, phrase)) fail_msg("'%s' does not say '%s'", error.message, phrase);
}

/* Builds one layer that is refused above `limit` bytes. */
static inline RtStatus build_within(const char *name, uint64_t limit, const RtScene *scene,
                                    const RtValue *values, RtAccel **out, RtError *problem) {
    const RtAccelOps *ops;
    assert_ok(rt_accel_find(name, &ops, error));
    return ops->build(&(RtBuild){ops, scene, values, 1, limit}, out, problem);
}

/* A scene without objects, and a grey material, which is number 0. */
static inline void begin_scene(RtScene *scene) {
    uint32_t material;
    RtMaterial grey = rt_default_material();
    rt_scene_init(scene);
    assert_ok(rt_scene_add_material(scene, &grey, &material, error));
}

/* Unit cubes' worth of spheres of radius 1/2 on an nx x ny x nz lattice of spacing 1. */
static inline void make_lattice(RtScene *scene, int nx, int ny, int nz) {
    begin_scene(scene);
    for (int x = 0; x < nx; x++) {
        for (int y = 0; y < ny; y++) {
            for (int z = 0; z < nz; z++) {
                RtVec3 center = {{(float)x, (float)y, (float)z}};
                assert_ok(rt_scene_add_sphere(scene, 0, center, 0.5f, error));
            }
        }
    }
    assert_ok(rt_scene_finish(scene, error));
}

/* From a point to a light of the scene, as shading sends it. */
static inline RtRay shadow_ray(const RtScene *scene, RtVec3 from, uint32_t light) {
    return (RtRay){.org = from,
                   .dir = rt_sub(scene->lights[light].position, from),
                   .tmax = 1,
                   .kind = RT_RAY_SHADOW,
                   .source = light};
}

/* For groups of tests that leave nothing behind. */
static inline int assert_nothing_is_kept(void **state) {
    (void)state;
    return rt_alloc_live() == 0 ? 0 : -1;
}

#endif
