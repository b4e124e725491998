/* SPDX-License-Identifier: Apache-2.0 */
/* raytally convert, as a user runs it: what it keeps, what it refuses. */
#include "command_testing.h"
#include "recentre_testing.h"

#include "core/base/file.h"
#include "measure/measure.h"

#define OUT RT_BINARY_DIR "/test_cmd_convert"

static int convert(const char *arguments) {
    return raytally_to("2>/dev/null", "convert %s", arguments);
}

RT_TEST(convert_keeps_the_scene_and_the_files_that_are_there) {
    remove(OUT ".yaml");
    assert_int_equal(convert("balls:size=1 " OUT ".yaml"), 0);
    RtScene made = open_scene("balls:size=1"), read = open_scene(OUT ".yaml");
    assert_true(rt_scene_fingerprint(&made) == rt_scene_fingerprint(&read));
    rt_scene_clear(&made);
    rt_scene_clear(&read);
    assert_int_equal(convert("balls:size=2 " OUT ".yaml"), 2);
    assert_int_equal(convert("balls:size=2 " OUT ".yaml --force"), 0);
}

RT_TEST(convert_keeps_textures_in_yaml_and_says_that_nff_loses_them) {
    static const char triangle[] =
        "materials: [{name: it's a globe, texture: {image: " RT_SOURCE_DIR "/scenes/globe.png}}]\n"
        "objects: [triangle: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], uv: [[0, 0], [1, 0], [0, 1]],\n"
        "  material: it's a globe}]\n";
    assert_ok(rt_file_write(OUT "-in.yaml", triangle, strlen(triangle), error));
    assert_said(raytally_to("2>" OUT ".txt", "convert --force %s", OUT "-in.yaml " OUT ".yaml"), 0,
                OUT ".txt", "");
    RtScene in = open_scene(OUT "-in.yaml"), out = open_scene(OUT ".yaml");
    assert_true(rt_scene_fingerprint(&in) == rt_scene_fingerprint(&out));
    assert_true(in.triangle_texture_count == 1 && out.triangle_texture_count == 1);
    rt_scene_clear(&in);
    rt_scene_clear(&out);
    static const char *const others[] = {"nff", "obj"};
    for (size_t i = 0; i < 2; i++)
        assert_said(raytally_to("2>" OUT ".txt", "convert --force " OUT "-in.yaml " OUT ".%s", others[i]), 0,
                    OUT ".txt", "the textures of 1 material are left out");
    assert_int_equal(convert("--force --strict " OUT "-in.yaml " OUT ".nff"), 2);
}

RT_TEST(convert_keeps_instances_in_yaml_and_says_that_others_get_copies) {
    static const char instances[] =
        "parts: [{name: leaf, objects: [triangle: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]]}]},\n"
        "  {name: twig, instances: [{part: leaf}, {part: leaf, transform: [{translate: [0, 0, 1]}]}]}]\n"
        "instances: [{part: twig}, {part: twig, transform: [{translate: [0, 0, 2]}]}]\n";
    assert_ok(rt_file_write(OUT "-in.yaml", instances, strlen(instances), error));
    assert_said(raytally_to("2>" OUT ".txt", "convert --force %s", OUT "-in.yaml " OUT ".yaml"), 0,
                OUT ".txt", "");
    OWNED_SCENE in = open_scene(OUT "-in.yaml"), out = open_scene(OUT ".yaml");
    assert_true(rt_scene_fingerprint(&in) == rt_scene_fingerprint(&out));
    assert_said(raytally_to(">" OUT ".txt", "info " OUT ".yaml"), 0, OUT ".txt",
                "parts: 2; instances: 4, nested in 2 levels; memory as copies: about 0.0 MB\n"
                "  leaf          1 object, 4 copies\n"
                "  twig          2 objects, 2 copies\n");
    assert_said(raytally_to(">" OUT ".txt", "info --json " OUT ".yaml"), 0, OUT ".txt",
                "\"instances\": 4,\n  \"nesting\": 2,\n");
    assert_said(raytally_to("2>" OUT ".txt", "convert --force " OUT ".yaml " OUT ".obj"), 0, OUT ".txt",
                "instances, which only .yaml keeps, become copies: 4 objects in all");
    assert_int_equal(convert("--force --strict " OUT ".yaml " OUT ".obj"), 2);
    assert_int_equal(convert("--force --strict --flatten " OUT ".yaml " OUT ".obj"), 0);
    assert_int_equal(convert("--force --flatten " OUT ".yaml " OUT "-flat.yaml"), 0);
    OWNED_SCENE flat = open_scene(OUT "-flat.yaml"), mesh = open_scene(OUT ".obj");
    assert_int_equal(flat.part_count, 0);
    assert_memory_equal(flat.geometry.triangles, mesh.geometry.triangles, 4 * sizeof(RtTriangle));
    for (int i = 0; i < 4; i++) assert_true(flat.geometry.triangles[i].v[0].z == (float)i);
}

RT_TEST(convert_refuses_and_leaves_nothing_behind) {
    remove(OUT ".ply");
    assert_int_equal(convert("balls:size=1"), 2);
    assert_int_equal(convert("nothing " OUT ".yaml"), 2);
    assert_int_equal(convert("balls:size=1 " OUT ".ply"), 2); /* spheres are no triangles */
    static const char cut[] = "OFF\n3 1 0\n0 0 0\n1 0 0\n";
    assert_ok(rt_file_write(OUT ".off", cut, strlen(cut), error));
    assert_int_equal(convert(OUT ".off " OUT ".ply"), 2);
    assert_not_written(OUT ".ply");
}

/* Runs convert, which says how far it moved. */
static void assert_moves(const char *arguments, const char *says) {
    assert_said(raytally_to(">" OUT ".txt 2>&1", "convert --force %s", arguments), 0, OUT ".txt", says);
}

/* Vertical rays on two triangles in a map, whose coordinates float32 happens to hold; the ground is 9 high.
 */
RT_TEST(rays_that_move_with_their_scene_hit_the_same) {
    static const RtVec3d corner = {{500000, 5400000, 9}};
    write_moved(OUT ".obj", "v <0 0 0>\nv <8 0 0>\nv <8 8 0>\nv <0 8 1>\nf 1 2 3\nf 1 3 4\n", corner, " ");
    RtRaySet rays, moved;
    assert_ok(rt_rayset_init(&rays, RT_RAY_RANDOM, 100, error));
    for (uint32_t i = 0; i < 100; i++)
        rays.rays[i] = (RtRay){.org = {{500000.5f + (float)(i % 10), 5400001 + (float)(i / 10), 64}},
                               .dir = {{0, 0, -1}},
                               .tmax = INFINITY};
    assert_ok(rt_rays_save(&rays, OUT ".npy", error));
    assert_moves("--recentre " OUT ".obj " OUT ".ply", "moved by -500004 -5400004 -10;");
    assert_moves(OUT ".npy " OUT ".moved.npy --recentre=500004,5400004,10", "");
    assert_ok(rt_rays_load(OUT ".moved.npy", RT_RAY_RANDOM, &moved, error));
    OWNED_SCENE before = open_scene(OUT ".obj"), after = open_scene(OUT ".ply");
    uint32_t hits = 0;
    for (uint32_t i = 0; i < 100; i++) {
        float t, u;
        const uint32_t id = first_hit(&before, &rays.rays[i], &t);
        assert_int_equal(first_hit(&after, &moved.rays[i], &u), id);
        assert_true(t == u);
        hits += id != RT_NO_OBJECT;
    }
    assert_int_equal(hits, 64);
    rt_rayset_clear(&rays);
    rt_rayset_clear(&moved);
}

/* What --strict refuses is what the result no longer has. */
RT_TEST(convert_recentres_what_is_refused_far_away) {
    write_moved(OUT ".obj", "v <0 0 0>\nv <8 0 0>\nv <0 8 0>\nf 1 2 3\n", far_away, " ");
    assert_int_equal(convert("--force --strict " OUT ".obj " OUT ".ply"), 2);
    assert_moves("--strict --recentre " OUT ".obj " OUT ".ply", "with --recentre=500004,5400004,100\n");
    assert_moves("--strict --recentre=500000,5.4e6,-0.5 " OUT ".obj " OUT ".ply", "-500000 -5400000 0.5;");
    static const char *const refused[] = {"--recentre=1,2", "--recentre=1,2,3,4", "--recentre=1,2,nan",
                                          "--recentre=1,2,1e30", "--recentre="};
    for (size_t i = 0; i < sizeof refused / sizeof refused[0]; i++) {
        char arguments[256];
        snprintf(arguments, sizeof arguments, "%s --force " OUT ".obj " OUT ".ply", refused[i]);
        assert_int_equal(convert(arguments), 2);
    }
    assert_int_equal(convert("--force --recentre " OUT ".npy " OUT ".moved.npy"),
                     2);                                                            /* its scene is unknown */
    assert_int_equal(convert("--recentre=1,2,3 " OUT ".npy " OUT ".moved.npy"), 2); /* it exists */
}

RT_TESTS(cmd_convert, NULL, NULL)
