/* SPDX-License-Identifier: Apache-2.0 */
/* Textures in the illumination model, against colours known by hand. */
#include "accel_testing.h"
#include "render_testing.h"

#define RED   rt_vec3(0.75f, 0.25f, 0.125f)
#define OTHER rt_vec3(0.125f, 0.5f, 1)

static void assert_color(RtVec3 got, RtVec3 expected) {
    if (got.x != expected.x || got.y != expected.y || got.z != expected.z)
        fail_msg("%g %g %g, not %g %g %g", (double)got.x, (double)got.y, (double)got.z, (double)expected.x,
                 (double)expected.y, (double)expected.z);
}

/* Only ambient light, of 1: the pixels are the colours. */
static RtMaterial checker(float size) {
    return (RtMaterial){.color = {0.75f, 0.25f, 0.125f},
                        .ambient = 1,
                        .ior = 1,
                        .texture = {.kind = RT_TEXTURE_CHECKER, .size = size, .color = OTHER}};
}

/* A scene with the camera of start_scene, which sees `half` to every side of the origin. */
static RtScene start_view(RtMaterial material, double half) {
    RtScene scene = start_scene(material);
    scene.camera.fov = (float)(2 * atan(half / 10) * 180 / acos(-1));
    return scene;
}

/* The image of 2 x 2 pixels: red and white above green and blue. */
static RtMaterial image(void) {
    static const uint8_t pixels[] = {255, 0, 0, 255, 255, 255, 0, 128, 0, 10, 20, 200};
    RtMaterial material = {.color = {1, 1, 0.5f}, .ambient = 1, .ior = 1};
    material.texture = (RtTexture){.kind = RT_TEXTURE_IMAGE, .size = 1};
    write_png(RT_BINARY_DIR "/test_texture.png", 2, 2, pixels);
    assert_ok(rt_texels_load(RT_BINARY_DIR "/test_texture.png", &material.texture.texels, error));
    return material;
}

static RtVec3 linear(const RtMaterial *m, int r, int g, int b) {
    const float *of = m->texture.texels->linear;
    return rt_mul(m->color, rt_vec3(of[r], of[g], of[b]));
}

RT_TEST(a_square_with_a_checker_has_its_two_colours_in_turn) {
    OWNED_SCENE scene = start_view(checker(1), 2);
    add_square(&scene, 3, 0);
    assert_ok(rt_scene_finish(&scene, error));
    RtFrameOptions options = options_for(&scene, 4, 4, false);
    OWNED_FRAME frame = trace(&scene, &options);
    /* The square (0, 0), right above the middle, has the material's colour: column 2, row 1. */
    for (int i = 0; i < 16; i++) assert_color(frame.color[i], (i % 4 + i / 4) % 2 ? RED : OTHER);
}

RT_TEST(the_origin_moves_a_projected_checker) {
    RtMaterial moved = checker(1);
    moved.texture.origin = rt_vec3(1, 0, 7);
    OWNED_SCENE scene = start_view(moved, 2);
    add_square(&scene, 3, 0);
    assert_ok(rt_scene_finish(&scene, error));
    RtFrameOptions options = options_for(&scene, 4, 4, false);
    OWNED_FRAME frame = trace(&scene, &options);
    for (int i = 0; i < 16; i++) assert_color(frame.color[i], (i % 4 + i / 4) % 2 ? OTHER : RED);
}

RT_TEST(an_image_of_four_pixels_lies_on_a_square_as_it_is_and_repeats) {
    RtMaterial material = image();
    material.texture.size = 2;
    OWNED_SCENE scene = start_view(material, 2);
    rt_texels_release(material.texture.texels);
    add_square(&scene, 3, 0);
    assert_ok(rt_scene_finish(&scene, error));
    RtFrameOptions options = options_for(&scene, 4, 4, false);
    OWNED_FRAME frame = trace(&scene, &options);
    const RtVec3 texels[2][2] = {{linear(&material, 255, 0, 0), linear(&material, 255, 255, 255)},
                                 {linear(&material, 0, 128, 0), linear(&material, 10, 20, 200)}};
    for (int i = 0; i < 16; i++) assert_color(frame.color[i], texels[i / 4 % 2][i % 4 % 2]);
    assert_true(texels[0][1].x == 1 && texels[0][1].z == 0.5f);
    assert_near(texels[1][0].y, 0.21586, 1e-5); /* 128 in sRGB */
}

RT_TEST(texels_become_the_bytes_that_they_were) {
    RtMaterial material = image();
    for (int byte = 0; byte < 256; byte++)
        assert_int_equal(rt_srgb(material.texture.texels->linear[byte]), byte);
    rt_texels_release(material.texture.texels);
}

/* The colour of the only object where a ray from 10 times this direction to the origin hits it. */
static RtVec3 color_towards(const RtScene *scene, RtVec3d from) {
    const RtVec3 org = rt_narrow(rt_scaled(from, 10));
    return surface_of(scene, org, rt_scale(org, -1), 0.9f).color;
}

static RtVec3d direction(double longitude, double latitude) {
    const double turn = acos(-1) / 180, across = cos(latitude * turn);
    return rt_vec3d(across * cos(longitude * turn), across * sin(longitude * turn), sin(latitude * turn));
}

RT_TEST(a_checker_of_an_eighth_has_eight_fields_around_a_sphere_and_eight_from_pole_to_pole) {
    OWNED_SCENE scene = start_scene(checker(0.125f));
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    for (int column = 0; column < 8; column++) {
        for (int row = 0; row < 8; row++) {
            const RtVec3d from = direction(-180 + 45 * (column + 0.5), -90 + 22.5 * (row + 0.5));
            assert_color(color_towards(&scene, from), (column + row) % 2 ? OTHER : RED);
        }
    }
    assert_color(color_towards(&scene, rt_vec3d(0, 0, 1)), color_towards(&scene, direction(0, 89)));
}

RT_TEST(a_sphere_shows_an_image_upright_and_not_mirrored_with_its_middle_towards_x) {
    RtMaterial material = image();
    OWNED_SCENE scene = start_scene(material);
    rt_texels_release(material.texture.texels);
    assert_ok(rt_scene_add_sphere(&scene, 0, rt_vec3(0, 0, 0), 1, error));
    assert_ok(rt_scene_finish(&scene, error));
    assert_color(color_towards(&scene, direction(-1, 1)), linear(&material, 255, 0, 0));
    assert_color(color_towards(&scene, direction(1, 1)), linear(&material, 255, 255, 255));
    assert_color(color_towards(&scene, direction(-179, -80)), linear(&material, 0, 128, 0));
    assert_color(color_towards(&scene, direction(179, -1)), linear(&material, 10, 20, 200));
}

RT_TEST(a_triangle_interpolates_its_coordinates_or_is_projected) {
    const RtVec3 corners[3] = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}};
    const RtUv uvs[3] = {{0, 0}, {2, 0}, {0, 2}};
    for (int with = 0; with < 2; with++) {
        OWNED_SCENE scene = start_scene(checker(1));
        assert_ok(rt_scene_add_triangle(&scene, 0, corners, NULL, error));
        if (with) assert_ok(rt_scene_set_triangle_texture(&scene, uvs, error));
        assert_ok(rt_scene_finish(&scene, error));
        /* Their coordinates are (1.25, 0.25), (0.75, 0.75) and (0.25, 0.75). */
        const RtVec3 points[3] = {{1.5f, -0.5f, 1}, {0.5f, 0.5f, 1}, {-0.5f, 0.5f, 1}};
        const bool others[2][3] = {{false, false, true}, {true, false, false}};
        for (int i = 0; i < 3; i++)
            assert_color(surface_of(&scene, points[i], rt_vec3(0, 0, -1), 1).color,
                         others[with][i] ? OTHER : RED);
    }
}

RT_TEST(what_stands_upright_is_projected_along_its_normal) {
    OWNED_SCENE scene = start_scene(checker(1));
    assert_ok(rt_scene_add_cone(&scene, 0, rt_vec3(0, 0, 0), 2, rt_vec3(0, 0, 4), 2, error));
    assert_ok(rt_scene_finish(&scene, error));
    for (int z = 0; z < 4; z++) { /* from +x: (y, z); from +y: (x, z) */
        const RtVec3 from_x = {10, 0.5f, (float)z + 0.5f}, from_y = {-0.5f, 10, (float)z + 0.5f};
        const float way = 10 - sqrtf(3.75f);
        assert_color(surface_of(&scene, from_x, rt_vec3(-1, 0, 0), way).color, z % 2 ? OTHER : RED);
        assert_color(surface_of(&scene, from_y, rt_vec3(0, -1, 0), way).color, z % 2 ? RED : OTHER);
    }
}

RT_TEST(the_diffuse_term_has_the_textures_colour_too) {
    RtMaterial material = checker(1);
    material.ambient = 0;
    material.diffuse = 0.5f;
    OWNED_SCENE scene = start_scene(material);
    add_square(&scene, 3, 0);
    assert_ok(rt_scene_add_light(&scene, rt_vec3(1.5f, 0.5f, 9), rt_vec3(1, 1, 1), error));
    assert_ok(rt_scene_finish(&scene, error));
    RtSurface surface = surface_of(&scene, rt_vec3(1.5f, 0.5f, 10), rt_vec3(0, 0, -1), 10);
    assert_color(rt_diffuse_light(&scene, &surface, 0), rt_scale(OTHER, 0.5f));
}

RT_TEST(a_textured_frame_is_the_same_on_one_thread_and_on_three) {
    OWNED_SCENE scene = open_scene(RT_SOURCE_DIR "/scenes/textures.yaml");
    RtFrameOptions options = options_for(&scene, 80, 60, false);
    OWNED_FRAME one = trace(&scene, &options);
    options.threads = 3;
    OWNED_FRAME three = trace(&scene, &options);
    assert_memory_equal(one.color, three.color, sizeof *one.color * 80 * 60);
}

RT_TEST(textures_change_no_ray) {
    OWNED_SCENE scene = open_scene(RT_SOURCE_DIR "/scenes/textures.yaml");
    RtFrameOptions options = options_for(&scene, 80, 60, false);
    options.counted = true;
    OWNED_FRAME with = trace(&scene, &options);
    for (uint32_t i = 0; i < scene.material_count; i++) scene.materials[i].texture.kind = RT_TEXTURE_NONE;
    OWNED_FRAME without = trace(&scene, &options);
    assert_memory_equal(with.tallies, without.tallies, sizeof with.tallies);
    assert_memory_not_equal(with.color, without.color, sizeof *with.color * 80 * 60);
}

RT_TESTS(texture, NULL, assert_nothing_is_kept)
