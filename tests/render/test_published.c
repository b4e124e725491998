/* SPDX-License-Identifier: Apache-2.0 */
/* Structures, tests and steps on the Standard Procedural Databases against published ones, 513 x 513 rays
 * through the corners of pixels, 5 levels deep, no mailbox: Havran & Sixta 1999 (grids, RTN 12(1)) and Havran
 * 1999 (octrees, RTN 12(2)). Cells are to be the published ones exactly, references, too, or within 3 %,
 * tests and steps per ray within 3 %. The column of tests is over all rays in the article on grids; the one
 * on octrees fits only if its sums were divided by the rays that hit something (docs/accelerators/octree.md).
 */
#include "testing.h"

#include "render/frame.h"
#include "scenes/open.h"

typedef enum Per { PER_RAY, PER_HIT } Per;

typedef struct Row {
    const char *scene, *spec;
    uint64_t interior, leaves, empty, references;
    bool exact;          /* references are the published ones, too */
    double tests, steps; /* 0: not compared */
    Per per;             /* of tests */
} Row;

#define GRID(resolution, margin) "grid:resolution=" resolution ",margin=" margin ",mailbox=off"
#define OCTREE(depth, rest)      "octree:max_depth=" depth ",max_leaf_size=1,mailbox=off,cut_filled=on" rest
#define POINTS                   ",traversal=points"
#define TREE                     ",flat=0.0165,slack=0.00115"

static const Row rows[] = {
    {"balls", GRID("46x46x3", "0.0001"), 0, 6348, 4208, 10240, false, 358.66, 5.69, PER_RAY},
    {"lattice", GRID("20x20x20", "0.0001"), 0, 8000, 0, 32152, true, 0, 0, PER_RAY},
    {"lattice", GRID("44x44x44", "0.0022"), 0, 85184, 38016, 90368, true, 0, 0, PER_RAY},
    {"tetra", GRID("16x16x16", "0.0001"), 0, 4096, 3104, 12556, true, 20.64, 7.43, PER_RAY},
    {"tetra", GRID("35x35x35", "0.0001"), 0, 42875, 37311, 35936, true, 10.01, 15.97, PER_RAY},
    {"tetra", GRID("40x40x40", "0.0001"), 0, 64000, 56696, 44696, true, 9.17, 18.24, PER_RAY},
    {"tree", GRID("52x52x3", "0.0001"), 0, 8112, 5400, 11102, false, 0, 0, PER_RAY},
    {"tree", GRID("117x118x5", "0.0001"), 0, 69030, 55191, 22407, false, 0, 0, PER_RAY},
    {"tree", GRID("60x60x60", "0.0001"), 0, 216000, 212179, 14322, false, 0, 0, PER_RAY},
    {"balls", OCTREE("4", ",flat=0.02052"), 57, 400, 300, 9171, true, 1794, 20.58, PER_HIT},
    {"balls", OCTREE("5", ",flat=0.02052"), 117, 820, 570, 10946, false, 0, 0, PER_HIT},
    {"balls", OCTREE("6", ",flat=0.02052"), 304, 2129, 1038, 15611, false, 0, 0, PER_HIT},
    {"balls", OCTREE("7", ",flat=0.02052"), 1108, 7757, 2905, 27288, false, 0, 0, PER_HIT},
    {"balls", OCTREE("4", ",flat=0.02052,split=cost"), 131, 918, 214, 10160, false, 0, 0, PER_HIT},
    {"lattice", OCTREE("4", ",margin=0.0001,split=cost"), 585, 4096, 0, 18768, true, 0, 0, PER_HIT},
    {"tetra", OCTREE("4", ",margin=0.0001,split=cost"), 325, 2276, 1116, 13792, true, 0, 0, PER_HIT},
    {"lattice", OCTREE("4", ",margin=0.0001" POINTS), 585, 4096, 0, 22112, true, 28.60, 22.03, PER_HIT},
    {"lattice", OCTREE("5", ",margin=0.0001" POINTS), 4681, 32768, 7744, 49600, true, 13.80, 47.88, PER_HIT},
    {"tetra", OCTREE("4", ",margin=0.0001" POINTS), 305, 2136, 1072, 13312, true, 120, 21.54, PER_HIT},
    {"tetra", OCTREE("5", ",margin=0.0001" POINTS), 1369, 9584, 4764, 32768, true, 63.58, 32.08, PER_HIT},
    {"tetra", OCTREE("6", ",margin=0.0001" POINTS), 6189, 43324, 21100, 110592, true, 46.77, 44.09, PER_HIT},
    {"tetra", OCTREE("7", ",margin=0.0001" POINTS), 28413, 198892, 80444, 512000, true, 47.07, 58.09,
     PER_HIT},
    {"tetra", OCTREE("4", ",margin=0.0001,traversal=neighbours"), 305, 2136, 1072, 13312, true, 120.9, 17.75,
     PER_HIT},
    {"tetra", OCTREE("7", ",margin=0.0001,traversal=neighbours"), 28413, 198892, 80444, 512000, true, 47.35,
     36.54, PER_HIT},
    {"tetra", OCTREE("4", ",margin=0.0001"), 305, 2136, 1072, 13312, true, 117.2, 9.59, PER_HIT},
    {"tree", OCTREE("4", TREE), 53, 372, 278, 9029, false, 0, 0, PER_HIT},
    {"tree", OCTREE("5", TREE), 101, 708, 556, 9670, false, 0, 0, PER_HIT},
    {"tree", OCTREE("6", TREE), 186, 1303, 1054, 10915, false, 0, 0, PER_HIT},
    {"tree", OCTREE("7", TREE), 352, 2465, 1801, 13725, false, 0, 0, PER_HIT},
};

static bool near(double measured, double published) {
    return fabs(measured / published - 1) <= 0.03;
}

static void assert_costs(const Row *row, const RtAccel *accel) {
    const RtFrameOptions options = {.depth = 5, .counted = true};
    RtTally sum = {0};
    RtFrame frame;
    assert_ok(rt_frame_trace(&frame, accel, &options, error));
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) rt_tally_add(&sum, &frame.tallies[kind]);
    rt_frame_clear(&frame);
    double tests = (double)sum.object_tests / (double)(row->per == PER_RAY ? sum.rays : sum.hits);
    double steps = (double)sum.steps / (double)sum.rays;
    print_message("%s on %s: %.2f tests, published %.2f; %.2f steps, published %.2f\n", row->spec, row->scene,
                  tests, row->tests, steps, row->steps);
    assert_true(near(tests, row->tests));
    assert_true(row->steps == 0 || near(steps, row->steps));
}

static void structure_and_costs_are_the_published_ones(void **state) {
    const Row *row = *state;
    OWNED_SCENE scene;
    RtAccel *accel;
    RtDescription d;
    assert_ok(rt_scene_open(row->scene, &scene, error));
    assert_ok(rt_scene_sample(&scene, 512, 512, 1, true, error));
    assert_ok(rt_accel_open(row->spec, &scene, &accel, error));
    rt_accel_describe(accel, &d);
    assert_int_equal(d.interior, row->interior);
    assert_int_equal(d.leaves, row->leaves);
    assert_int_equal(d.empty_leaves, row->empty);
    if (row->exact) assert_int_equal(d.references, row->references);
    assert_true(near((double)d.references, (double)row->references));
    if (row->tests > 0) assert_costs(row, accel);
    rt_accel_destroy(accel);
}

RT_TEST_GROUP(published) {
    enum { COUNT = sizeof rows / sizeof rows[0] };
    struct CMUnitTest tests[COUNT];
    for (size_t i = 0; i < COUNT; i++) {
        tests[i] = (struct CMUnitTest)cmocka_unit_test_prestate(structure_and_costs_are_the_published_ones,
                                                                (void *)&rows[i]);
        tests[i].name = rows[i].spec;
    }
    return cmocka_run_group_tests(tests, NULL, NULL);
}
