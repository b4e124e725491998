/* SPDX-License-Identifier: Apache-2.0 */
/* accel/embree: an empty scene, a scene that outgrows its structure, memory, and the version. Skipped without
 * Embree. */
#include "embree_testing.h"

#ifdef RT_WITH_EMBREE
#include "accel/embree/embree.h"
#endif

RT_TEST(an_empty_scene_is_hit_by_nothing) {
    static const char *const specs[] = {"embree", "embree:query=16", "embree:query=stream",
                                        "embree:mode=user", "embree:mode=user,query=8"};
    OWNED_SCENE scene;
    rt_scene_init(&scene);
    assert_ok(rt_scene_finish(&scene, error));
    RtRay ray = {.dir = {1, 0, 0}, .tmax = INFINITY};
    compare_with_brute(&scene, (Rays){&ray, 1}, specs, sizeof specs / sizeof specs[0]);
}

RT_TEST(a_scene_that_outgrows_its_structure_is_noticed_in_user_mode) {
    OWNED_SCENE scene = make_soup(40, 1, 10);
    OWNED_ACCEL RtAccel *accel = open_valid(&scene, "embree:mode=user");
    scene.geometry.box.hi.y += 1;
    assert_broken(accel, "bounds do not contain");
}

RT_TEST(building_ten_times_leaks_nothing) {
    OWNED_SCENE scene = make_soup(60, 1, 10);
    int64_t before = rt_alloc_live();
    for (int i = 0; i < 10; i++) {
        RtDescription description;
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, i % 2 ? "embree" : "embree:mode=user");
        accel->ops->describe(accel, &description);
        assert_true(description.bytes > 1000 && description.bytes < 1000000);
        assert_int_equal(description.references, 60);
    }
    for (uint64_t nth = 1; nth <= 2; nth++) {
        RtAccel *accel;
        rt_alloc_fail_at(nth);
        assert_fails_with(rt_accel_open("embree", &scene, &accel, error), RT_NO_MEMORY, "out of memory");
    }
    rt_alloc_fail_at(0);
    assert_int_equal(rt_alloc_live(), before);
}

#ifdef RT_WITH_EMBREE

RT_TEST(an_error_of_the_device_is_known_after_tracing) {
    OWNED_SCENE scene = make_soup(40, 1, 10);
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "cache+embree");
    assert_ok(rt_accel_check(accel, error));
    RTCDevice device = ((const RtEmbree *)accel->below)->device.device;
    rtcSetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION, 1);
    assert_fails_with(rt_accel_check(accel, error), RT_MISMATCH, "Embree reports error 2");
}

/* The count of its memory monitor, and our indices of triangles if there are triangles. */
RT_TEST(its_bytes_are_what_it_has_allocated_and_our_arrays) {
    static const char *const specs[] = {"embree", "embree:mode=user"};
    OWNED_SCENE scene = make_soup(60, 1, 10);
    assert_int_equal(scene.geometry.triangle_count, 12);
    for (int i = 0; i < 2; i++) {
        RtDescription description;
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, specs[i]);
        rt_accel_describe(accel, &description);
        uint64_t counted = (uint64_t)((const RtEmbree *)accel)->device.bytes;
        assert_true(counted > 1000);
        assert_int_equal(description.bytes, counted + (i == 0 ? 12 * 3 * sizeof(uint32_t) : 0));
    }
}

#endif

RT_TEST(the_library_names_a_version_and_an_isa) {
    char text[64];
    const RtAccelOps *ops;
    assert_ok(rt_accel_find("embree", &ops, error));
    assert_true(ops->library(text, sizeof text));
    int major, minor, patch;
    char isa[16];
    assert_int_equal(sscanf(text, "%d.%d.%d %15s", &major, &minor, &patch, isa), 4);
    assert_true(major >= 3);
}

RT_TEST_GROUP(embree) {
    if (!embree_is_built_in()) return RT_TEST_SKIPPED;
    return RT_RUN_TESTS("embree", NULL, NULL);
}
