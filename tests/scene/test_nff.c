/* SPDX-License-Identifier: Apache-2.0 */
/* NFF: reading, writing, and the lines of rejected input. */
#include "scene_testing.h"

#include "core/base/random.h"
#include "core/scene/load.h"
#include "core/scene/nff.h"

#define FILE_NAME RT_BINARY_DIR "/test_nff_scene.nff"

static const char everything[] = "# a comment\n"
                                 "v\nfrom 1 2 3\nat 0 0 0\nup 0 0 1\nangle 30\nhither 0.5\nresolution 64 48\n"
                                 "b 0.1 0.2 0.3\n"
                                 "l 4 5 6\nl 1 2 3 .5 .25 1\n"
                                 "f 1 0.5 0.25 0.6 0.3 20 0.1 1.5 # trailing\n"
                                 "s 0 0 0 0.5\n"
                                 "c 0 0 0 1\n  0 0 2 0\n"
                                 "p 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
                                 "f 1 1 1 1 0 100000 0 0\n"
                                 "p 3\n0 0 0\n1 0 0\n0 1 0\n"
                                 "pp 4\n0 0 0 0 0 1\n1 0 0 0 0 2\n1 1 0 0 0 1\n0 1 0 0 1 0\n";

RT_TEST(every_statement_is_read) {
    OWNED_SCENE scene = scene_of(FILE_NAME, everything);
    const RtGeometry *g = &scene.geometry;
    assert_int_equal(g->object_count, 6);
    assert_int_equal(g->sphere_count, 1);
    assert_int_equal(g->cone_count, 1);
    assert_int_equal(g->polygon_count, 1);
    assert_int_equal(g->triangle_count, 3);
    assert_int_equal(g->vertex_normal_count, 2);
    assert_true(g->vertex_normals[0].n[1].z == 1);
    assert_true(g->vertex_normals[1].n[2].y == 1);

    const RtMaterial *m = &scene.materials[0];
    assert_true(m->color.x == 1 && m->color.z == 0.25f && m->diffuse == 0.6f && m->specular == 0.3f);
    assert_true(m->reflection == 0.3f && m->shine == 20 && m->transmission == 0.1f && m->ior == 1.5f);
    assert_true(m->ambient == RT_NFF_AMBIENT);
    assert_true(scene.materials[1].ior == 1);
    assert_int_equal(scene.material_of[2], 0);
    assert_int_equal(scene.material_of[3], 1);

    assert_true(scene.camera.from.y == 2 && scene.camera.fov == 30 && scene.camera.near == 0.5f);
    assert_int_equal(scene.camera.width, 64);
    assert_int_equal(scene.camera.height, 48);
    assert_true(scene.background.z == 0.3f);
    assert_int_equal(scene.light_count, 2);
    /* The suggested intensity: the first light has no colour. */
    assert_true(scene.lights[0].intensity.x == (float)(sqrt(2.0) / 4));
    assert_true(scene.lights[1].intensity.x == 0.5f && scene.lights[1].intensity.z == 1);
}

RT_TEST(repeated_materials_are_stored_once) {
    OWNED_SCENE scene =
        scene_of(FILE_NAME, "f 1 0 0 1 0 0 0 1\ns 0 0 0 1\nf 0 1 0 1 0 0 0 1\ns 1 0 0 1\nf 1 0 0 1 0 0 0 1\n"
                            "s 2 0 0 1\n");
    assert_int_equal(scene.material_count, 2);
    assert_int_equal(scene.material_of[2], 0);
}

RT_TEST(signs_of_radii_and_line_ends_do_not_matter) {
    OWNED_SCENE scene = scene_of(FILE_NAME, "s 0 0 0 -2\r\nc 0 0 0 -1 0 0 1 -1\r\n\r\n\ts\t1\n1\n1\n1");
    assert_int_equal(scene.geometry.object_count, 3);
    assert_true(scene.geometry.spheres[0].radius == 2);
}

RT_TEST(what_is_written_reads_back_bit_for_bit) {
    OWNED_SCENE scene = open_scene("random:n=400,shape=mixed");
    assert_ok(rt_scene_save(&scene, FILE_NAME, error));
    OWNED_SCENE again = open_scene(FILE_NAME);
    const RtGeometry *a = &scene.geometry, *b = &again.geometry;
    assert_int_equal(a->object_count, b->object_count);
    assert_memory_equal(a->objects, b->objects, a->object_count * sizeof *a->objects);
    assert_memory_equal(a->spheres, b->spheres, a->sphere_count * sizeof *a->spheres);
    assert_memory_equal(a->cones, b->cones, a->cone_count * sizeof *a->cones);
    assert_memory_equal(a->triangles, b->triangles, a->triangle_count * sizeof *a->triangles);
    assert_memory_equal(a->polygon_vertices, b->polygon_vertices,
                        a->polygon_vertex_count * sizeof *a->polygon_vertices);
    assert_memory_equal(&scene.camera, &again.camera, sizeof scene.camera);
    assert_memory_equal(scene.lights, again.lights, scene.light_count * sizeof *scene.lights);
}

RT_TEST(a_triangle_without_area_survives_being_written) {
    const RtVec3 point[3] = {{1, 2, 3}, {1, 2, 3}, {1, 2, 3}};
    OWNED_SCENE_OF(scene, triangle, point, NULL);
    assert_ok(rt_scene_save(&scene, FILE_NAME, error));
    OWNED_SCENE again = open_scene(FILE_NAME);
    assert_memory_equal(again.geometry.triangles[0].v, point, sizeof point);
}

RT_TEST(a_file_that_cannot_be_written_leaves_the_others) {
    RtError problem;
    OWNED_SCENE scene = scene_of(FILE_NAME, "s 0 0 0 1\n");
    assert_bad_input(rt_scene_save(&scene, RT_BINARY_DIR "/x.nfff", error), "did you mean '.nff'?");
    assert_int_not_equal(rt_scene_save(&scene, RT_BINARY_DIR "/no/such/folder/x.nff", &problem), RT_OK);
    OWNED_SCENE again = open_scene(FILE_NAME);
    assert_int_equal(again.geometry.object_count, 1);
}

RT_TEST(bad_files_are_refused_with_line_and_remedy) {
    const struct {
        const char *text, *line, *says;
    } cases[] = {
        {"", "", "at least one object"},
        {"# nothing\n\n", "", "at least one object"},
        {"s 0 0 0 1\nq 1 2 3\n", ":2:", "'q'"},
        {"s 0 0 0 1\nsphere 1 2 3\n", ":2:", "v b l f s c p pp"},
        {"s 0 0 0\n", ":1:", "the end of the file"},
        {"s 0 0 0\ns 1 1 1 1\n", ":1:", "float32, found 's'"},
        {"s 0 0 0 0\n", ":1:", "radius above 0"},
        {"\n\ns 0 0 nan 1\n", ":3:", "a finite number that fits float32, found 'nan'"},
        {"s 0 0 inf 1\n", ":1:", "a finite number"},
        {"s 0 0 1e30 1\n", ":1:", "exceeds"},
        {"s 0 0 0 1x\n", ":1:", "'1x'"},
        {"s 0 0 0 1 2\n", ":1:", "'2'"},
        {"c 0 0 0 1 0 0 0 1\n", ":1:", "same point"},
        {"c 0 0 0 0 0 0 1 0\n", ":1:", "above 0"},
        {"c 0 0 0 1\n0 0 1\n", ":2:", "apex.radius"},
        {"p 2\n0 0 0\n1 0 0\n", ":1:", "3..4294967295"},
        {"p 3.5\n0 0 0\n1 0 0\n0 1 0\n", ":1:", "whole number"},
        {"p 1000000000\n0 0 0\n1 0 0\n0 1 0\n", ":1:", "the rest of the file"},
        {"pp 4294967295\n0 0 0 0 0 1\n", ":1:", "the rest of the file"},
        {"p 4\n0 0 0\n1 0 0\n0 1 0\nf 1 1 1 1 0 0 0 1\n", ":4:", "'f'"},
        {"p 3\n0 0 0\n1 1 1\n2 2 2\n", ":1:", "no area"},
        {"s 0 0 0 1\np 4\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n", ":2:", "no area"},
        {"p 4\n0 0 0\n1 0 0\n1 1 1\n0 1 0\n", ":1:", "not planar"},
        {"pp 3\n0 0 0 0 0 0\n1 0 0 0 0 1\n0 1 0 0 0 1\n", ":1:", "normal"},
        {"pp 4\n-7 7 0 0 0 1\n-2 0 0 0 0 1\n-7 -7 0 0 0 1\n9 0 0 0 0 1\n", ":1:", "concave"},
        {"f 1 1 1 1 0 0 0\ns 0 0 0 1\n", ":1:", "Kd Ks shine T ior"},
        {"f -1 1 1 1 0 0 0 1\ns 0 0 0 1\n", ":1:", "red"},
        {"f 1 1 1 1 2 0 0 1\ns 0 0 0 1\n", ":1:", "reflection"},
        {"f 1 1 1 1 0 0 1 0\ns 0 0 0 1\n", ":1:", "ior"},
        {"b -1 0 0\ns 0 0 0 1\n", ":1:", "background"},
        {"l 1 2 3 -1 0 0\ns 0 0 0 1\n", ":1:", "negative"},
        {"l 1 2 3 1\ns 0 0 0 1\n", ":1:", "colour of a light"},
        {"v\nfrom 0 0 1\nat 0 0 0\nangle 45\ns 0 0 0 1\n", ":4:", "'up'"},
        {"v\nfrom 0 0 0\nat 0 0 0\nup 0 0 1\nangle 45\ns 0 0 0 1\n", ":1:", "no direction"},
        {"v\nfrom 0 0 1\nat 0 0 0\nup 0 0 1\nangle 45\ns 0 0 0 1\n", ":1:", "along its line of sight"},
        {"v\nfrom 0 0 1\nat 0 0 0\nup 0 1 0\nangle 180\ns 0 0 0 1\n", ":1:", "180"},
        {"v\nfrom 0 0 1\nat 0 0 0\nup 0 1 0\nangle 45\nhither -1\ns 0 0 0 1\n", ":1:", "hither"},
        {"v\nfrom 0 0 1\nat 0 0 0\nup 0 1 0\nangle 45\nresolution 0 9\n", ":6:", "1..32768"},
        {"\x89PNG\r\n", ":1:", "'?PNG'"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtScene scene;
        char place[256];
        snprintf(place, sizeof place, "%s%s", FILE_NAME, cases[i].line);
        assert_bad_input_at(open_bytes(FILE_NAME, cases[i].text, strlen(cases[i].text), &scene, error), place,
                            cases[i].says);
    }
}

RT_TEST(a_file_cut_anywhere_is_read_or_refused) {
    for (size_t size = 0; size < sizeof everything; size++)
        assert_read_or_refused(FILE_NAME, everything, size);
}

RT_TEST(a_file_with_any_bytes_changed_is_read_or_refused) {
    static const char bytes[] = "0123456789-+.eE \n#pscfvblnx\x01\xff";
    for (uint64_t run = 0; run < 2000; run++) {
        char text[sizeof everything];
        RtRandom random = rt_random(2, run);
        memcpy(text, everything, sizeof text);
        for (int i = 0; i < 4; i++) {
            char byte = bytes[rt_random_bits(&random) % (sizeof bytes - 1)];
            text[rt_random_bits(&random) % (sizeof text - 1)] = byte;
        }
        assert_read_or_refused(FILE_NAME, text, sizeof text - 1);
    }
}

RT_TEST(every_failed_allocation_is_reported_and_leaves_nothing) {
    write_text(FILE_NAME, everything);
    assert_failed_allocations_are_reported(FILE_NAME);
}

RT_TEST(the_jewel_is_whole) {
    assert_shape_counts(&(ShapeCounts){RT_SOURCE_DIR "/scenes/jewel.nff", 100, 274, 656, 107}, 1);
}

RT_TESTS(nff, NULL, NULL)
