/* SPDX-License-Identifier: Apache-2.0 */
/* render/: images, read back from their files. */
#include "render_testing.h"

#include <png.h>
#include <xxhash.h>

#define PNG_FILE RT_BINARY_DIR "/test_image.png"

/* A sphere of radius 1 with id 1 before a wall at z = -2 with id 0, seen from (0, 0, 10); matte red under
 * white ambient light, so that colours are 1, 0, 0 on objects and 0, 0, 1 beside them. */
static RtFrame trace_red(uint32_t width, uint32_t height) {
    OWNED_SCENE scene = start_scene((RtMaterial){.color = {1, 0, 0}, .ambient = 1, .ior = 1});
    scene.background = rt_vec3(0, 0, 1);
    scene.camera.fov = 45;
    add_square(&scene, 3, -2);
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    RtFrameOptions options = options_for(&scene, width, height, false);
    options.counted = true;
    return trace(&scene, &options);
}

RT_TEST(a_png_reads_back_as_the_image) {
    OWNED_FRAME frame = trace_red(40, 30);
    OWNED(rt_image_clear) RtImage image;
    assert_ok(rt_image_from_frame(&image, &frame, error));
    assert_ok(rt_png_write(&frame, PNG_FILE, error));
    png_image png = {.version = PNG_IMAGE_VERSION};
    assert_true(png_image_begin_read_from_file(&png, PNG_FILE));
    assert_int_equal(png.width, 40);
    assert_int_equal(png.height, 30);
    png.format = PNG_FORMAT_RGB;
    uint8_t pixels[40 * 30 * 3];
    assert_true(png_image_finish_read(&png, NULL, pixels, 0, NULL));
    assert_memory_equal(pixels, image.rgb, sizeof pixels);
    const uint8_t sky[3] = {0, 0, 255}, red[3] = {255, 0, 0};
    assert_memory_equal(pixels, sky, 3);
    assert_memory_equal(pixels + 3 * (15 * 40 + 20), red, 3);
    unlink(PNG_FILE);
    assert_not_written(PNG_FILE);
}

RT_TEST(linear_halves_are_written_as_srgb_188) {
    RtVec3 color[3] = {{0.5f, 0, 2}, {0, 1, -1}, {0.001f, NAN, 0.25f}};
    RtFrame frame = {.color = color};
    assert_ok(rt_sampling_init(&frame.sampling, 3, 1, 1, false, error));
    OWNED(rt_image_clear) RtImage image;
    assert_ok(rt_image_from_frame(&image, &frame, error));
    const uint8_t expected[9] = {188, 0, 255, 0, 255, 0, 3, 0, 137};
    assert_memory_equal(image.rgb, expected, 9);
}

/* Also next to where the byte changes, be the power off by some 1e-12. */
RT_TEST(every_byte_of_srgb_begins_where_it_should) {
    RtVec3 color[255];
    RtFrame frame = {.color = color};
    for (int i = 0; i < 255; i++) {
        long double border = (i + 0.5L) / 255;
        border = border <= 0.04045L ? border / 12.92L : powl((border + 0.055L) / 1.055L, 2.4L);
        float above = (float)border;
        if ((long double)above < border) above = nextafterf(above, 1);
        color[i] = rt_vec3(nextafterf(above, 0), above, nextafterf(above, 1));
    }
    assert_ok(rt_sampling_init(&frame.sampling, 255, 1, 1, false, error));
    OWNED(rt_image_clear) RtImage image;
    assert_ok(rt_image_from_frame(&image, &frame, error));
    for (int i = 0; i < 255; i++) {
        const uint8_t expected[3] = {(uint8_t)i, (uint8_t)(i + 1), (uint8_t)(i + 1)};
        assert_memory_equal(image.rgb + 3 * i, expected, 3);
    }
}

/* A change of shading changes these, too. */
RT_TEST(a_picture_of_mirrors_and_glass_has_the_same_bits_everywhere) {
    OWNED_FRAME frame;
    OWNED(rt_image_clear) RtImage image;
    RtFrameOptions options = {.depth = 5};
    OWNED_SCENE scene = open_scene(RT_SOURCE_DIR "/scenes/lecture.yaml");
    assert_ok(rt_scene_sample(&scene, 96, 64, 1, false, error));
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "bvh");
    assert_ok(rt_frame_trace(&frame, accel, &options, error));
    assert_ok(rt_image_from_frame(&image, &frame, error));
    assert_int_equal(XXH3_64bits(frame.color, sizeof *frame.color * 96 * 64), UINT64_C(0x970bed9dfa2e0bd0));
    assert_int_equal(XXH3_64bits(image.rgb, (size_t)3 * 96 * 64), UINT64_C(0x421a2f9d9d632117));
}

RT_TEST(a_pixel_is_the_mean_of_its_samples_or_of_its_corners) {
    RtVec3 color[16];
    RtFrame frame = {.color = color};
    for (int i = 0; i < 16; i++) color[i] = rt_vec3((float)i, 0, 0);
    assert_ok(rt_sampling_init(&frame.sampling, 2, 2, 2, false, error)); /* 4 x 4 samples */
    assert_true(rt_frame_pixel(&frame, 1, 0).x == (2 + 3 + 6 + 7) / 4.0f);
    assert_true(rt_frame_pixel(&frame, 0, 1).x == (8 + 9 + 12 + 13) / 4.0f);
    assert_ok(rt_sampling_init(&frame.sampling, 3, 3, 1, true, error)); /* 4 x 4 corners */
    assert_true(rt_frame_pixel(&frame, 0, 0).x == (0 + 1 + 4 + 5) / 4.0f);
    assert_true(rt_frame_pixel(&frame, 2, 2).x == (10 + 11 + 14 + 15) / 4.0f);
}

RT_TEST(a_counted_frame_has_the_object_and_the_cost_of_each_sample) {
    enum { W = 37, H = 41, MIDDLE = H / 2 * W + W / 2 };
    OWNED_FRAME frame = trace_red(W, H);
    assert_int_equal(frame.object[0], RT_NO_OBJECT);
    assert_true(isinf(frame.depth[0]));
    assert_int_equal(frame.object[MIDDLE], 1);
    assert_true(fabsf(frame.depth[MIDDLE] - 9) < 0.01f);
    assert_int_equal(frame.cost[0].object_tests, 2); /* brute, two objects, a miss: no shadow ray */
}

RT_TEST(a_file_that_cannot_be_written_is_a_status_and_leaves_nothing) {
    OWNED_FRAME frame = trace_red(4, 4);
    int64_t live = rt_alloc_live();
    const char *const folders[] = {RT_BINARY_DIR "/no such folder/a", RT_BINARY_DIR};
    for (int i = 0; i < 2; i++) assert_fails_with(rt_png_write(&frame, folders[i], error), RT_IO, folders[i]);
    assert_int_equal(rt_alloc_live(), live);
}

RT_TESTS(image, NULL, NULL)
