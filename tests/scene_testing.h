/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of scenes: opening a scene, its objects by shape, and failing allocations. */
#ifndef RT_TESTS_SCENE_TESTING_H
#define RT_TESTS_SCENE_TESTING_H

#include "testing.h"

#include "scenes/open.h"

#include <png.h>

static inline RtScene open_scene(const char *spec) {
    RtScene scene;
    assert_ok(rt_scene_open(spec, &scene, error));
    return scene;
}

/* A scene without objects, and a grey material, which is number 0. */
static inline RtScene begin_scene(void) {
    RtScene scene;
    uint32_t material;
    RtMaterial grey = rt_default_material();
    rt_scene_init(&scene);
    assert_ok(rt_scene_add_material(&scene, &grey, &material, error));
    return scene;
}

/* A scene of one object: OWNED_SCENE_OF(scene, sphere, center, radius). */
#define OWNED_SCENE_OF(scene, shape, ...)                                                                    \
    OWNED_SCENE scene = begin_scene();                                                                       \
    assert_ok(rt_scene_add_##shape(&(scene), 0, __VA_ARGS__, error));                                        \
    assert_ok(rt_scene_finish(&(scene), error))

/* A new file: closing one that was emptied would wait for the disk, as rt_file_write does. */
static inline void write_bytes(const char *path, const void *bytes, size_t count) {
    remove(path);
    FILE *out = fopen(path, "wb");
    assert_non_null(out);
    assert_int_equal(fwrite(bytes, 1, count, out), count);
    assert_int_equal(fclose(out), 0);
}

static inline void write_text(const char *path, const char *text) {
    write_bytes(path, text, strlen(text));
}

/* Opens the file, whose name says its format, with these bytes. */
static inline RtStatus open_bytes(const char *path, const void *bytes, size_t count, RtScene *scene,
                                  RtError *error) {
    write_bytes(path, bytes, count);
    return rt_scene_open(path, scene, error);
}

/* A PNG file of these pixels, `width` a row, from the upper left. */
static inline void write_png(const char *path, uint32_t width, uint32_t height, const void *rgb) {
    png_image png = {
        .version = PNG_IMAGE_VERSION, .width = width, .height = height, .format = PNG_FORMAT_RGB};
    assert_true(png_image_write_to_file(&png, path, 0, rgb, 0, NULL));
}

static inline RtScene scene_of(const char *path, const char *text) {
    write_text(path, text);
    return open_scene(path);
}

/* The bytes are read or refused, and leave nothing behind. */
static inline void assert_read_or_refused(const char *path, const void *bytes, size_t count) {
    const int64_t live = rt_alloc_live();
    RtScene scene;
    RtError error;
    const RtStatus status = open_bytes(path, bytes, count, &scene, &error);
    assert_true(status == RT_OK || status == RT_BAD_INPUT);
    if (status == RT_OK) rt_scene_clear(&scene);
    assert_int_equal(rt_alloc_live(), live);
}

/* The text with the line ends of Windows; returns its length. */
static inline size_t as_in_windows(const char *text, char *out) {
    size_t size = 0;
    for (; *text; out[size++] = *text++) {
        if (*text == '\n') out[size++] = '\r';
    }
    return size;
}

typedef struct ShapeCounts {
    const char *spec;
    uint32_t spheres, polygons, triangles, cones;
} ShapeCounts;

/* Each scene has as many objects of each shape as its row says. */
static inline void assert_shape_counts(const ShapeCounts *rows, size_t count) {
    for (size_t i = 0; i < count; i++) {
        OWNED_SCENE scene = open_scene(rows[i].spec);
        assert_int_equal(scene.geometry.sphere_count, rows[i].spheres);
        assert_int_equal(scene.geometry.polygon_count, rows[i].polygons);
        assert_int_equal(scene.geometry.triangle_count, rows[i].triangles);
        assert_int_equal(scene.geometry.cone_count, rows[i].cones);
    }
}

static inline void assert_failed_allocations_are_reported(const char *spec) {
    RtScene scene;
    assert_fails_cleanly(rt_scene_open(spec, &scene, error), rt_scene_clear(&scene));
}

#endif
