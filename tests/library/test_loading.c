/* SPDX-License-Identifier: Apache-2.0 */
/* Loading plugins through the library. */
#include "library_testing.h"

#define PLUGIN(name) RT_BINARY_DIR "/plugins/" name ".so"

RT_TEST(a_plugin_is_loaded_with_and_without_room_for_a_message) {
    raytally_error said = {RAYTALLY_IO, "as it was"};
    size_t before = raytally_accelerator_count();
    assert_int_equal(raytally_plugin_load(PLUGIN("new-accel"), &said), RAYTALLY_OK);
    assert_int_equal(raytally_plugin_load(PLUGIN("bvh_copy"), NULL), RAYTALLY_OK);
    assert_int_equal(raytally_accelerator_count(), before + 2);
    assert_string_equal(raytally_accelerator_name(before), "my-accel");
    assert_string_equal(raytally_accelerator_name(before + 1), "bvh_copy");
    assert_int_equal(raytally_plugin_load(PLUGIN("new-accel"), &said), RAYTALLY_OK); /* it is there already */
    assert_int_equal(raytally_plugin_load(PLUGIN("bvh_copy"), NULL), RAYTALLY_OK);
    assert_int_equal(raytally_accelerator_count(), before + 2);
    assert_int_equal(said.status, RAYTALLY_IO); /* on success nothing is said */
    assert_string_equal(said.message, "as it was");
}

RT_TEST(an_accelerator_that_no_loaded_plugin_has_needs_a_function_of_the_library_and_no_option) {
    char spec[RAYTALLY_SPEC_CHARS];
    raytally_error why;
    assert_int_equal(raytally_spec_format("own_hits", spec, &why), RAYTALLY_BAD_INPUT);
    assert_non_null(strstr(why.message, "an accelerator of a plugin needs raytally_plugin_load"));
    assert_null(strstr(why.message, "--"));
}

RT_TEST(what_is_no_plugin_is_refused_with_and_without_room_for_a_message) {
    static const struct {
        const char *path, *says;
    } none[] = {{"no/such/plugin.so", "no/such/plugin.so"},
                {PLUGIN("unloadable-ABI"), "version"},
                {PLUGIN("unloadable-CONSTRUCTOR"), "loading it failed"}};
    size_t before = raytally_accelerator_count();
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        assert_refused(raytally_plugin_load(none[i].path, error), none[i].says);
        assert_int_equal(raytally_plugin_load(none[i].path, NULL), RAYTALLY_BAD_INPUT);
    }
    assert_int_equal(raytally_accelerator_count(), before);
}

RT_TEST(accelerators_of_a_plugin_are_verified_like_others) {
    raytally_objects objects = two_objects();
    raytally_scene *scene;
    raytally_verify_options how = RAYTALLY_VERIFY_DEFAULTS;
    raytally_verify_result found;
    how.rays = 500;
    assert_fine(raytally_plugin_load(PLUGIN("new-accel"), error));
    assert_fine(raytally_scene_from_objects(&objects, &scene, error));
    assert_fine(raytally_verify(scene, "my-accel", &how, &found, error));
    assert_int_equal(found.equal, 500);
    raytally_scene_free(scene);
}

RT_TESTS(loading, NULL, NULL)
