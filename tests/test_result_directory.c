/* A result directory: what is in it is not lost, whoever runs into it, whatever fails, whenever a run is
 * killed. */
#include "experiment_testing.h"

#include <unistd.h>

static const char small_experiment[] = "name: small\n"
                                       "question: Which is cheaper?\n"
                                       "prediction: The hierarchy.\n"
                                       "scenes:\n"
                                       "  - {scene: \"balls:size=1\", size: 12x12, depth: 2}\n"
                                       "  - {scene: \"random:n=50\", label: cloud, size: 8x8, depth: 2}\n"
                                       "  - {scene: \"balls:size=1\", label: again, size: 8x8, depth: 1}\n"
                                       "accelerators: [{accel: bvh}, {accel: grid}]\n"
                                       "rays: [primary, shadow]\n"
                                       "count_only: yes\n"
                                       "limit: 100\n"
                                       "quick: {limit: 50}\n";

static int make_small(void **state) {
    if (make_place(state) != 0) return -1;
    write_in(*state, "small.yaml", small_experiment);
    return 0;
}

/* Runs raytally, which must end with this exit code and say this on standard error. */
static void assert_ends(const Place *place, const char *arguments, int code, const char *says) {
    int ended = raytally(place, arguments);
    char *message = read_in(place, "message");
    if (ended != code || !strstr(message, says)) {
        fail_msg("raytally %s: exit code %d, expected %d with '%s': %s", arguments, ended, code, says,
                 message);
    }
    rt_free(message);
}

/* ---- plots ---- */

static void a_script_that_lies_elsewhere_is_copied_into_the_directory(void **state) {
    const Place *place = *state;
    assert_ok(rt_directory_create(path_in(place, "here").text, error));
    assert_ok(rt_directory_create(path_in(place, "there/deep").text, error));
    write_in(place, "x.gp", "print 1\n");
    write_in(place, "there/deep/y.gp", "print 2\n");
    write_changed(place, "here/small.yaml", small_experiment, "limit: 100\n",
                  "limit: 100\nplots: [../x.gp, ../there/deep/y.gp]\n");
    assert_ends(place, "run here/small.yaml --out out/deep", 0, "");
    assert_in_file(place, "out/deep/plots/x.gp", "print 1");
    assert_in_file(place, "out/deep/plots/y.gp", "print 2");
    assert_false(rt_file_exists(path_in(place, "out/deep/x.gp").text));
    assert_ends(place, "plot out/deep", 0, "");
}

static void two_scripts_of_one_name_are_refused_with_their_line(void **state) {
    const Place *place = *state;
    const char *const lists[] = {"[x.gp,\n  ../x.gp]", "[x.gp,\n  names.gp]", "[x.gp,\n  there/]",
                                 "[x.gp,\n  ..]"};
    for (size_t i = 0; i < sizeof lists / sizeof lists[0]; i++) {
        char plots[64];
        RtError error = {RT_OK, ""};
        snprintf(plots, sizeof plots, "limit: 100\nplots: %s\n", lists[i]);
        write_changed(place, "small.yaml", small_experiment, "limit: 100\n", plots);
        assert_refused(load_small(place, false, &error), RT_BAD_INPUT, &error, "small.yaml:13:3:");
    }
}

static void an_experiment_that_is_named_like_a_folder_above_is_refused(void **state) {
    const Place *place = *state;
    RtError error = {RT_OK, ""};
    write_changed(place, "small.yaml", small_experiment, "name: small", "name: ..");
    assert_refused(load_small(place, false, &error), RT_BAD_INPUT, &error, "small.yaml:1:");
}

#define IN_PLACE(test) cmocka_unit_test_setup_teardown(test, make_small, remove_place)

int main(void) {
    const struct CMUnitTest tests[] = {
        IN_PLACE(a_script_that_lies_elsewhere_is_copied_into_the_directory),
        IN_PLACE(two_scripts_of_one_name_are_refused_with_their_line),
        IN_PLACE(an_experiment_that_is_named_like_a_folder_above_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
