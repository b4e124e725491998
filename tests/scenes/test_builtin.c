/* SPDX-License-Identifier: Apache-2.0 */
/* scenes/: random scenes, rejected specs, and memory; test_places.c tests what the others contain. */
#include "scene_testing.h"

#include "scenes/builtin.h"

#include <xxhash.h>

/* Instead of the library's: as if there were no memory for what it keeps. */
XXH3_state_t *XXH3_createState(void) {
    return NULL;
}

static RtVec3 extent_of(const RtScene *scene, uint32_t first, uint32_t count) {
    RtBox box = RT_EMPTY_BOX;
    for (uint32_t i = first; i < first + count; i++) box = rt_box_union(box, scene->geometry.boxes[i]);
    return rt_sub(box.hi, box.lo);
}

RT_TEST(random_objects_are_where_their_distribution_says) {
    OWNED_SCENE coincident = open_scene("random:n=16,distribution=coincident");
    const RtSphere *spheres = coincident.geometry.spheres;
    for (uint32_t i = 1; i < 16; i++) assert_memory_equal(&spheres[i], &spheres[0], sizeof(RtSphere));

    OWNED_SCENE line = open_scene("random:n=32,distribution=line,radius=0.1");
    RtVec3 extent = extent_of(&line, 0, 32);
    assert_true(extent.x > 1.9f && extent.y < 0.02f && extent.z < 0.02f);

    OWNED_SCENE plane = open_scene("random:n=32,distribution=plane,shape=triangle");
    assert_true(extent_of(&plane, 0, 32).z == 0);
    OWNED_SCENE mixed = open_scene("random:n=32,distribution=plane,shape=mixed");
    for (uint32_t i = 0; i < mixed.geometry.polygon_vertex_count; i++)
        assert_true(mixed.geometry.polygon_vertices[i].z == 0.5f);

    OWNED_SCENE stadium = open_scene("random:n=32,distribution=stadium");
    RtVec3 huge = extent_of(&stadium, 8, 1), tiny = extent_of(&stadium, 9, 7);
    assert_true(huge.x > 0.1f && tiny.x < 0.01f && tiny.x > 0);
}

/* Two triangles, of which number `with` has vertex normals. */
static uint64_t fingerprint_with_normals(uint32_t with) {
    static const RtVec3 vertices[2][3] = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                          {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}};
    static const RtVec3 normals[3] = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}};
    OWNED_SCENE scene = begin_scene();
    for (uint32_t i = 0; i < 2; i++)
        assert_ok(rt_scene_add_triangle(&scene, 0, vertices[i], i == with ? normals : NULL, error));
    assert_ok(rt_scene_finish(&scene, error));
    return rt_scene_fingerprint(&scene);
}

RT_TEST(a_fingerprint_needs_no_memory) {
    assert_null(XXH3_createState());
    assert_int_not_equal(fingerprint_with_normals(0), 0);
}

RT_TEST(a_fingerprint_tells_which_triangle_has_normals) {
    assert_int_not_equal(fingerprint_with_normals(0), fingerprint_with_normals(1));
    assert_int_equal(fingerprint_with_normals(1), fingerprint_with_normals(1));
}

RT_TEST(a_random_object_does_not_depend_on_those_before_it) {
    OWNED_SCENE few = open_scene("random:n=10"), many = open_scene("random:n=1000");
    assert_memory_equal(&few.geometry.spheres[9].center, &many.geometry.spheres[9].center, sizeof(RtVec3));
}

RT_TEST(one_narrow_cluster_lies_together) {
    OWNED_SCENE scene =
        open_scene("random:n=2000,distribution=clustered,clusters=1,width=0.001,radius=0.001");
    RtVec3 size = rt_box_size(scene.geometry.box);
    assert_true(rt_maxf(size.x, rt_maxf(size.y, size.z)) < 0.1f);
}

RT_TEST(wrong_names_are_refused_with_what_would_be_right) {
    const struct {
        const char *spec, *says;
    } cases[] = {
        {"bals", "did you mean 'balls'?"},
        {"", "Built-in scenes: balls, "},
        {"balls:size=0", "1..7"},
        {"balls:size=8", "1..7"},
        {"balls:size=1000000000", "1..7"},
        {"balls:sise=2", "did you mean 'size'?"},
        {"balls:4", "key=value"},
        {"random:n=-1", "0..268435456"},
        {"random:n=1000000000", "0..268435456"},
        {"random:n=nan", "0..268435456"},
        {"random:shape=cube", "sphere|triangle|mixed"},
        {"balls.nof", "'.nff'?"},
        {"tests/no_such_scene.nff", "there is no such file"},
        {"scenes/jewl.nff", "did you mean 'scenes/jewel.nff'?"},
        {"no_such_folder/a.nff", "nor a folder no_such_folder/"},
        {"scenes", "is a folder"},
        {"README.md", ".yaml .yml .nff .obj .ply .stl .glb .gltf .off"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        RtScene scene;
        assert_bad_input(rt_scene_open(cases[i].spec, &scene, error), cases[i].says);
        assert_int_equal(scene.geometry.object_count, 0);
    }
}

RT_TEST(too_large_a_scene_is_refused_with_the_size_that_fits) {
    const struct {
        const char *name;
        int64_t value;
        uint64_t objects; /* for which there is memory */
        const char *says;
    } cases[] = {
        {"random", 1000000, 1234, "n=1234 would fit"}, {"balls", 7, 7382, "size=4 would fit"},
        {"balls", 7, 7381, "size=3 would fit"},        {"tetra", 9, 65535, "size=7 would fit"},
        {"lattice", 400, 8281, "size=12 would fit"},   {"mount", 9, 8195, "size=5 would fit"},
        {"tree", 20, 8191, "size=11 would fit"},       {"gears", 100, 9344, "size=3 would fit"},
        {"jacks", 8, 657, "size=3 would fit"},         {"rings", 200, 8401, "size=7 would fit"},
        {"shells", 20, 5760, "size=4 would fit"},      {"csg-field", 1000000, 99, "n=99 would fit"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const RtBuiltin *builtin = rt_builtin_find(cases[i].name);
        RtValue values[RT_MAX_PARAMS];
        assert_ok(rt_params_parse(builtin->params, builtin->param_count, NULL, "it", values, error));
        values[0].i = cases[i].value;
        const uint64_t constant = builtin->bytes_each ? builtin->bytes_each : RT_BUILTIN_OBJECT_BYTES;
        const uint64_t each = builtin->object_bytes ? builtin->object_bytes(values) : constant;
        uint64_t bytes = cases[i].objects * each;
        assert_bad_input(rt_builtin_check_memory(builtin, values, bytes, error), cases[i].says);
    }
}

static uint32_t stored_objects(const RtScene *scene) {
    uint32_t count = scene->geometry.object_count;
    for (uint32_t i = 0; i < scene->part_count; i++) count += scene->parts[i]->geometry.object_count;
    return count;
}

/* It has as many objects, with those of its parts, as is told before it is made. */
static RtScene open_as_counted(const char *spec, const RtBuiltin **builtin, RtValue *values) {
    const char *colon = strchr(spec, ':');
    *builtin = rt_builtin_find(spec);
    assert_ok(rt_params_parse((*builtin)->params, (*builtin)->param_count, colon ? colon + 1 : NULL, "it",
                              values, error));
    RtScene scene = open_scene(spec);
    assert_int_equal(rt_builtin_object_count(*builtin, values), stored_objects(&scene));
    return scene;
}

/* At other values than the defaults, too. */
RT_TEST(objects_are_as_many_as_told_beforehand_and_take_no_more_memory_than_estimated) {
    static const char *const more[] = {"random:n=20000",
                                       "random:n=20000,shape=mixed",
                                       "csg-field:n=65,least=64",
                                       "teapot:size=3",
                                       "stadium:size=2",
                                       "hall:size=3",
                                       "forest:n=30,seed=5",
                                       "city:size=3,seed=9",
                                       "balls:instances=on",
                                       "balls:size=1,instances=on",
                                       "balls:instances=flattened",
                                       "city:size=3,instances=on",
                                       "city:instances=flattened",
                                       "city:size=1,instances=on,parts=1",
                                       "forest:n=300,instances=on",
                                       "forest:n=9,instances=flattened,parts=2",
                                       "forest:n=1,instances=on,parts=64",
                                       "thicket:n=9,instances=on",
                                       "thicket:n=9,instances=on,opened=2",
                                       "thicket:n=2,instances=flattened,opened=1"};
    enum { MORE = sizeof more / sizeof more[0] };
    for (size_t i = 0; i < MORE || rt_builtin_at(i - MORE); i++) {
        const char *spec = i < MORE ? more[i] : rt_builtin_at(i - MORE)->name;
        const RtBuiltin *builtin;
        RtValue values[RT_MAX_PARAMS];
        OWNED_SCENE scene = open_as_counted(spec, &builtin, values);
        const uint64_t too_few = rt_scene_bytes(&scene) - 1;
        assert_bad_input(rt_builtin_check_memory(builtin, values, too_few, error), "would fit");
    }
}

RT_TEST(the_count_of_objects_of_every_family_is_told_beforehand) {
    for (size_t i = 0; i < rt_family_count(); i++) {
        char spec[RT_MAX_SPEC_CHARS];
        const RtBuiltin *builtin;
        RtValue values[RT_MAX_PARAMS];
        rt_family_spec(i, 3, spec);
        OWNED_SCENE scene = open_as_counted(spec, &builtin, values);
        (void)scene;
    }
}

RT_TEST(every_failed_allocation_is_reported_and_leaves_nothing) {
    const RtBuiltin *builtin;
    for (size_t i = 0; (builtin = rt_builtin_at(i)); i++) { /* the smallest scene of each */
        char spec[RT_MAX_NAME + 32];
        snprintf(spec, sizeof spec, "%s:%s=%.0f", builtin->name, builtin->params[0].name,
                 builtin->params[0].lo);
        assert_failed_allocations_are_reported(spec);
    }
    assert_failed_allocations_are_reported("random:n=100,shape=mixed");
    assert_failed_allocations_are_reported("balls:size=1,instances=flattened");
    assert_failed_allocations_are_reported("city:size=1,instances=on,parts=1");
}

RT_TESTS(builtin, NULL, NULL)
