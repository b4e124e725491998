/* SPDX-License-Identifier: Apache-2.0 */
/* Files of a result directory that are cut off, or have a byte that no text has, or line ends of another
 * system: each is read or refused, and nothing is left. Arbitrary damage is tried by tests/fuzz.sh. */
#include "experiment_testing.h"

#include "results/result_directory.h"

static const char experiment_text[] =
    "name: small\nquestion: What is left?\nprediction: Nothing.\n"
    "scenes: [{scene: \"random:n=10\", label: cloud, size: 4x4, depth: 1}]\n"
    "accelerators: [{accel: bvh}, {accel: \"grid:density=1|4\", label: grid}]\n"
    "rays: [primary]\n"
    "expect: [object_tests of grid falls with density]\n"
    "count_only: yes\n";

static const char *const files[] = {"out/experiment.yaml", "out/cells.jsonl", "out/manifest.json"};
enum { FILES = sizeof files / sizeof files[0] };

static int make_places(void **state) {
    if (make_place_with(state, experiment_text) != 0) return -1;
    return raytally(*state, "run small.yaml --out out") > 1 ? -1 : 0;
}

/* Everything that is read of a result directory. */
static RtStatus read_all(const Place *place, RtError *error) {
    Path out = path_in(place, "out");
    RtResults results = {0};
    json_t *manifest = NULL;
    RtStatus status = rt_results_load(out.text, place->experiment, &results, error);
    if (status == RT_OK) status = rt_manifest_read(out.text, &manifest, error);
    json_decref(manifest);
    rt_results_clear(&results);
    return status;
}

/* The status of reading everything while `file` has these bytes. */
static RtStatus read_with(const Place *place, const char *file, const char *bytes, size_t size) {
    RtError problem = {RT_OK, ""};
    const int64_t live = rt_alloc_live();
    assert_ok(rt_file_write(path_in(place, file).text, bytes, size, error));
    const RtStatus status = read_all(place, &problem);
    assert_int_equal(rt_alloc_live(), live);
    if (status != RT_OK && status != RT_BAD_INPUT)
        fail_msg("%s: status %d: %s", file, status, problem.message);
    return status;
}

/* Some 300 places of each file. */
PLACE_TEST(a_file_that_is_cut_off_or_has_a_zero_byte_is_read_or_refused) {
    assert_ok(read_all(place, error));
    for (size_t i = 0; i < FILES; i++) {
        OWNED_MEMORY char *text = read_in(place, files[i]);
        const size_t size = strlen(text), step = size / RT_SHARE(300, 30) + 1;
        for (size_t at = 0; at < size; at += step) {
            const char byte = text[at];
            read_with(place, files[i], text, at);
            text[at] = '\0';
            read_with(place, files[i], text, size);
            text[at] = byte;
        }
        assert_int_equal(read_with(place, files[i], text, size), RT_OK);
    }
}

PLACE_TEST(line_ends_of_windows_change_nothing) {
    for (size_t i = 1; i < FILES; i++) {
        OWNED_MEMORY char *text = read_in(place, files[i]), *other = rt_alloc(2 * strlen(text) + 1, 1);
        char *to = other;
        assert_non_null(other);
        for (const char *c = text; *c; *to++ = *c++) {
            if (*c == '\n') *to++ = '\r';
        }
        assert_int_equal(read_with(place, files[i], other, strlen(other)), RT_OK);
    }
}

RT_TESTS(damaged_results, NULL, NULL)
