/* SPDX-License-Identifier: Apache-2.0 */
/* raytally convert, as a user runs it: what it keeps, what it refuses. */
#include "command_testing.h"
#include "scene_testing.h"

#include "core/base/file.h"

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

RT_TESTS(cmd_convert, NULL, NULL)
