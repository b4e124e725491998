/* SPDX-License-Identifier: Apache-2.0 */
/* raytally rays, and what takes its files: bench and verify --rays-from, bench --hits. */
#include "command_testing.h"

#include "core/base/file.h"
#include "core/base/tally.h"

#include <jansson.h>

#define OUT  RT_BINARY_DIR "/test_cmd_rays"
#define RAYS OUT ".npy"

#define run(...) raytally_to("> '" OUT ".out' 2> '" OUT ".err'", __VA_ARGS__)

typedef struct Bytes {
    char *data;
    size_t size;
} Bytes;

static void free_bytes(Bytes *bytes) {
    rt_free(bytes->data);
}

#define OWNED_BYTES OWNED(free_bytes) Bytes

static Bytes bytes_of(const char *path) {
    Bytes bytes;
    assert_ok(rt_file_read(path, 1 << 28, &bytes.data, &bytes.size, error));
    return bytes;
}

static void assert_same_bytes(const char *one, const char *other) {
    OWNED_BYTES a = bytes_of(one), b = bytes_of(other);
    assert_int_equal(a.size, b.size);
    assert_memory_equal(a.data, b.data, a.size);
}

/* The numbers behind the header of version 1.0. */
static const char *numbers_of(const Bytes *bytes) {
    const unsigned char *header = (const unsigned char *)bytes->data;
    return bytes->data + 10 + header[8] + 256 * header[9];
}

/* Counts of the only row of the document that the last run printed. */
static json_t *counts_of_run(void) {
    json_auto_t *document = json_load_file(OUT ".out", 0, NULL);
    assert_non_null(document);
    json_t *row = json_array_get(json_object_get(document, "rows"), 0);
    return json_incref(json_object_get(row, "counts"));
}

#define SMALL "--size 40x40 --limit 1000"

/* Rows, columns and sums, for a kind that is asked for the nearest hit and one that is asked for any. */
RT_TEST(recorded_rays_that_are_read_back_meet_and_cost_the_same) {
    const char *const kinds[][2] = {{"primary", "nearest"}, {"diffuse", "nearest"}, {"shadow", "occlusion"}};
    const char *const specs[] = {"bvh", "grid", "brute"};
    for (size_t i = 0; i < 9; i++) {
        const char *kind = kinds[i / 3][0], *given = kinds[i / 3][1], *spec = specs[i % 3];
        assert_int_equal(run("rays balls:size=2 %s --rays %s -o '%s'", SMALL, kind, RAYS), 0);
        assert_int_equal(
            run("bench balls:size=2 %s --accel %s --rays %s --count-only --json --hits '%s.h1.npy'", SMALL,
                spec, kind, OUT),
            0);
        json_auto_t *recorded = counts_of_run();
        assert_int_equal(
            run("bench balls:size=2 --accel %s --rays-from '%s' --rays %s --count-only --json --hits "
                "'%s.h2.npy' --threads 2",
                spec, RAYS, given, OUT),
            0);
        json_auto_t *read = counts_of_run();
        assert_true(json_equal(recorded, read));
        assert_same_bytes(OUT ".h1.npy", OUT ".h2.npy");
    }
}

RT_TEST(rows_of_hits_sum_to_the_hits) {
    assert_int_equal(
        run("bench balls:size=2 %s --accel octree --rays diffuse --count-only --json --hits '%s.h.npy'",
            SMALL, OUT),
        0);
    json_auto_t *counts = counts_of_run();
    OWNED_BYTES hits = bytes_of(OUT ".h.npy");
    json_int_t hit = 0, all = 0;
    for (const char *at = numbers_of(&hits); at < hits.data + hits.size;
         at += sizeof(float) + sizeof(int64_t)) {
        float t;
        int64_t object;
        memcpy(&t, at, sizeof t);
        memcpy(&object, at + sizeof t, sizeof object);
        assert_true((object == -1) == (t == INFINITY) && object >= -1);
        hit += object >= 0;
        all++;
    }
    assert_int_equal(hit, json_integer_value(json_object_get(counts, "hits")));
    assert_int_equal(all, json_integer_value(json_object_get(counts, "rays")));
    assert_true(0 < hit && hit < all);
}

RT_TEST(occlusion_rays_say_whether_anything_lies_on_them) {
    assert_int_equal(
        run("bench balls:size=2 %s --accel bvh --rays shadow --count-only --json --hits '%s.h.npy'", SMALL,
            OUT),
        0);
    json_auto_t *counts = counts_of_run();
    OWNED_BYTES hits = bytes_of(OUT ".h.npy");
    assert_non_null(strstr(hits.data + 10, "'|b1'"));
    json_int_t hit = 0;
    for (const char *at = numbers_of(&hits); at < hits.data + hits.size; at++) hit += *at;
    assert_int_equal(hit, json_integer_value(json_object_get(counts, "hits")));
}

/* Lines of a text, without the first. */
static uint64_t rows_of_text(const char *path) {
    uint64_t rows = 0;
    for (const char *at = text_of(path); (at = strchr(at, '\n')); at++) rows++;
    return rows - 1;
}

RT_TEST(rays_and_hits_as_text_are_those_of_arrays) {
    const char *const bench =
        "bench balls:size=2 --accel grid --rays %s --count-only --rays-from '%s.%s' --hits "
        "'%s.h.%s'";
    for (int text = 0; text < 2; text++) {
        const char *ending = text ? "csv" : "npy";
        assert_int_equal(run("rays balls:size=2 %s --rays diffuse -o '%s.%s'", SMALL, OUT, ending), 0);
        assert_int_equal(run(bench, "occlusion", OUT, ending, OUT, ending), 0);
        if (text) assert_int_equal(strncmp(text_of(OUT ".h.csv"), "blocked\n0\n", 10), 0);
        assert_int_equal(run(bench, "nearest", OUT, ending, OUT, ending), 0);
    }
    OWNED_BYTES hits = bytes_of(OUT ".h.npy");
    assert_int_equal(rows_of_text(OUT ".h.csv"), (hits.data + hits.size - numbers_of(&hits)) / 12);
    for (int text = 0; text < 2; text++)
        assert_said(run("verify balls:size=2 --rays-from '%s.csv' --hits-from '%s.h.%s'", OUT, OUT,
                        text ? "csv" : "npy"),
                    0, OUT ".out", "by verdicts, nothing wrong");
}

RT_TEST(verify_asks_the_rays_of_a_file_and_is_gone_on_with_only_by_the_same) {
    assert_int_equal(run("rays balls:size=1 %s --rays random -o '%s'", SMALL, RAYS), 0);
    assert_said(
        run("verify balls:size=1 --accel bvh --accel grid --rays-from '%s' --out '%s.d' --force", RAYS, OUT),
        0, OUT ".out", "2000 comparisons: nothing wrong");
    for (int seed = 1; seed <= 2; seed++) {
        assert_int_equal(run("rays balls:size=1 %s --rays random --seed %d -o '%s'", SMALL, seed, RAYS), 0);
        const int code = run(
            "verify balls:size=1 --accel bvh --accel grid --rays-from '%s' --out '%s.d' --resume", RAYS, OUT);
        if (seed == 1) assert_said(code, 0, OUT ".out", "2000 comparisons: nothing wrong");
        if (seed == 2) assert_said(code, 2, OUT ".err", "with different rays_hash");
    }
}

/* Puts `value` into a column of row 7. */
static void damage(uint32_t column, float value) {
    assert_int_equal(run("rays balls:size=1 %s -o '%s'", SMALL, RAYS), 0);
    OWNED_BYTES bytes = bytes_of(RAYS);
    size_t at = (size_t)(numbers_of(&bytes) - bytes.data) + (7 * 8 + column) * sizeof(float);
    memcpy(bytes.data + at, &value, sizeof value);
    if (column == 4) memset(bytes.data + at, 0, 3 * sizeof value);
    assert_ok(rt_file_write(RAYS, bytes.data, bytes.size, error));
}

RT_TEST(a_ray_that_is_none_is_refused_by_its_row) {
    const struct {
        uint32_t column;
        float value;
        const char *says;
    } cases[] = {{1, NAN, "origin is not finite"},
                 {0, 1e18f, "beyond 5e17"},
                 {5, INFINITY, "direction is not finite"},
                 {4, 0, "direction is zero"},
                 {3, -1, "tmin is negative"},
                 {3, INFINITY, "tmin is negative or not finite"},
                 {7, -1, "less than its tmin"},
                 {7, NAN, "less than its tmin"},
                 {3, NAN, "tmin is negative"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        damage(cases[i].column, cases[i].value);
        for (int verify = 0; verify < 2; verify++) {
            int code = verify ? run("verify balls:size=1 --accel bvh --rays-from '%s'", RAYS)
                              : run("bench balls:size=1 --accel bvh --rays nearest --rays-from '%s'", RAYS);
            assert_said(code, 2, OUT ".err", "row 7 (the first is 0)");
            assert_said(code, 2, OUT ".err", cases[i].says);
        }
    }
}

RT_TEST(what_does_not_go_together_is_refused_and_leaves_no_file) {
    const char *const cases[][2] = {
        {"bench balls:size=1 --accel bvh --rays-from x.npy", "--rays nearest, or --rays occlusion"},
        {"bench balls:size=1 --accel bvh --rays-from x.npy --rays diffuse", "not 'diffuse'"},
        {"bench balls:size=1 --accel bvh --rays-from x.npy --rays nearest,occlusion", "one kind at a time"},
        {"bench balls:size=1 --accel bvh --rays-from x.npy --rays nearest --size 8x8",
         "--size applies to recorded rays"},
        {"bench balls:size=1 --accel bvh --rays-from x.npy --rays nearest", "x.npy: cannot be opened"},
        {"bench balls:size=1 --accel bvh --rays-from /dev/null --rays nearest", "this is not a file"},
        {"bench balls:size=1 --accel bvh --hits y.npz", "expected a file name that ends in .npy"},
        {"bench balls:size=1 --accel bvh --accel grid --rays primary --hits y.npy", "one accelerator"},
        {"bench balls:size=1 --accel bvh --rays nearest --rays-from y.npy --hits y.npy", "named twice"},
        {"bench balls:size=1 --accel bvh --rays primary --size 8x8 --count-only --hits no/y.npy",
         "No such file"},
        {"rays balls:size=1", "-o FILE.npy"},
        {"rays balls:size=1 -o y.npy --rays primary,shadow", "one kind at a time"},
        {"rays balls:size=1 -o y.npy --rays transmission", "has no transmission rays"},
        {"rays nope.nff -o y.npy", "there is no such file"},
        {"rays balls:size=1 --size 8x8 -o no/y.npy", "No such file"},
        {"verify --accel bvh --rays-from x.npy", "the rays of one SCENE"},
        {"verify balls:size=1 --rays 10 --rays-from x.npy", "leave out --rays"},
        {"verify balls:size=1 --quick --rays-from x.npy", "leave out --rays, --quick"}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_said(run("%s", cases[i][0]), 2, OUT ".err", cases[i][1]);
        assert_not_written("y.npy");
    }
}

RT_TESTS(cmd_rays, NULL, NULL)
