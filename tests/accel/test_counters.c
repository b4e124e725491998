/* SPDX-License-Identifier: Apache-2.0 */
/* Counters: what each of them counts, pinned by a scene counted by hand.
 *
 * The scene: two unit-diameter spheres, 0 about (0.5, 0.5, 0.5) and 1 about (3.5, 0.5, 0.5). Their boxes are
 * [0,1] x [0,1] x [0,1] and [3,4] x [0,1] x [0,1]; the scene's box is [0,4] x [0,1] x [0,1].
 *
 * The rays all run along +x from x = -1:
 *   THROUGH  at y = z = 0.5: meets sphere 0 at t = 1, sphere 1 at t = 4;
 *   BETWEEN  at y = z = 0.95: crosses both boxes near an edge and misses both spheres;
 *   BESIDE   at y = 5: misses all boxes. */
#include "accel_testing.h"

enum { THROUGH, BETWEEN, BESIDE, RAY_COUNT };

static const RtRay rays[RAY_COUNT] = {
    {{-1, 0.5f, 0.5f}, 0, {1, 0, 0}, INFINITY, RT_RAY_RANDOM, 0},
    {{-1, 0.95f, 0.95f}, 0, {1, 0, 0}, INFINITY, RT_RAY_RANDOM, 0},
    {{-1, 5, 0.5f}, 0, {1, 0, 0}, INFINITY, RT_RAY_RANDOM, 0},
};
static const RtHit answers[RAY_COUNT] = {{1, 0}, {INFINITY, RT_NO_OBJECT}, {INFINITY, RT_NO_OBJECT}};

typedef struct Row {
    const char *spec;
    int ray;
    bool occluded; /* the query */
    RtTally expected;
} Row;

/* The query. */
#define NEAREST false
#define ANY     true

/* One ray that hits every object it tests; one that misses; what it visits. */
#define HITS(tests)                    .rays = 1, .hits = 1, .object_tests = (tests), .object_hits = (tests)
#define MISSES(tests)                  .rays = 1, .object_tests = (tests)
#define VISITS(extents, nodes, leaves) .extent_tests = (extents), .steps = (nodes), .leaf_steps = (leaves)

static const Row rows[] = {
    /* brute: every object is tested; occlusion ends with the first that is hit. */
    {"brute", THROUGH, NEAREST, {HITS(2)}},
    {"brute", THROUGH, ANY, {HITS(1)}},
    {"brute", BETWEEN, NEAREST, {MISSES(2)}},
    {"brute", BETWEEN, ANY, {MISSES(2)}},
    {"brute", BESIDE, NEAREST, {MISSES(2)}},

    /* ideal, which recorded the answers: one test for a hit, none for a miss. */
    {"ideal", THROUGH, NEAREST, {HITS(1)}},
    {"ideal", THROUGH, ANY, {HITS(1)}},
    {"ideal", BETWEEN, NEAREST, {MISSES(0)}},
    {"ideal", BESIDE, ANY, {MISSES(0)}},

    /* item: whatever is not a primary ray is handed down untouched; test_item counts those that are not. */
    {"item+brute", THROUGH, NEAREST, {HITS(2)}},
    {"item+brute", BESIDE, ANY, {MISSES(2)}},

    /* bvh: an extent test per box, the root's included; a step per node visited. With max_leaf_size=1 a root
     * and two leaves, of which leaf_steps counts the visited ones: THROUGH visits the root and the near leaf,
     * and drops the far one, which begins at t = 4. */
    {"bvh:max_leaf_size=1", THROUGH, NEAREST, {HITS(1), VISITS(3, 2, 1)}},
    {"bvh:max_leaf_size=1", THROUGH, ANY, {HITS(1), VISITS(3, 2, 1)}},
    {"bvh:max_leaf_size=1", BETWEEN, NEAREST, {MISSES(2), VISITS(3, 3, 2)}},
    {"bvh:max_leaf_size=1", BETWEEN, ANY, {MISSES(2), VISITS(3, 3, 2)}},
    {"bvh:max_leaf_size=1", BESIDE, NEAREST, {MISSES(0), .extent_tests = 1}},
    /* A visit that costs ten object tests never pays here: the root is a leaf of two. */
    {"bvh:traversal_cost=10", THROUGH, NEAREST, {HITS(2), VISITS(1, 1, 1)}},
    {"bvh:traversal_cost=10", THROUGH, ANY, {HITS(1), VISITS(1, 1, 1)}},
    /* Every build makes a root and two leaves. */
    {"bvh:max_leaf_size=1,build=sweep", THROUGH, NEAREST, {HITS(1), VISITS(3, 2, 1)}},
    {"bvh:max_leaf_size=1,build=lbvh", THROUGH, NEAREST, {HITS(1), VISITS(3, 2, 1)}},
    {"bvh:max_leaf_size=1,build=spatial", THROUGH, NEAREST, {HITS(1), VISITS(3, 2, 1)}},
    {"bvh:max_leaf_size=1,build=ploc", THROUGH, NEAREST, {HITS(1), VISITS(3, 2, 1)}},

    /* clusters: a step per node visited. A root and two leaves, as of bvh; with traversal_order=fixed an
     * extent is tested when its turn comes, so `occluded` has never asked for the second leaf's. BETWEEN
     * enters the ball about both spheres, but neither's own; the slabs about both reject it at once. */
    {"clusters", THROUGH, NEAREST, {HITS(1), VISITS(3, 2, 1)}},
    {"clusters:extent=sphere", THROUGH, NEAREST, {HITS(1), VISITS(3, 2, 1)}},
    {"clusters:method=sah", THROUGH, ANY, {HITS(1), VISITS(3, 2, 1)}},
    {"clusters:traversal_order=fixed", THROUGH, NEAREST, {HITS(1), VISITS(3, 2, 1)}},
    {"clusters:traversal_order=fixed", THROUGH, ANY, {HITS(1), VISITS(2, 2, 1)}},
    {"clusters:extent=box", BETWEEN, NEAREST, {MISSES(2), VISITS(3, 3, 2)}},
    {"clusters:extent=sphere", BETWEEN, ANY, {MISSES(0), .extent_tests = 3, .steps = 1}},
    {"clusters:traversal_order=fixed,extent=box", BETWEEN, NEAREST, {MISSES(2), VISITS(3, 3, 2)}},
    {"clusters:traversal_order=fixed,extent=sphere",
     BETWEEN,
     ANY,
     {MISSES(0), .extent_tests = 3, .steps = 1}},
    {"clusters:extent=slabs,slabs=13", BETWEEN, NEAREST, {MISSES(0), .extent_tests = 1}},
    {"clusters", BESIDE, NEAREST, {MISSES(0), .extent_tests = 1}},

    /* grid: an extent test for its box; a step per voxel. Three voxels along x, of width 4/3: sphere 0 in the
     * first, none in the second, sphere 1 in the third, which THROUGH does not reach. */
    {"grid:resolution=3x1x1", THROUGH, NEAREST, {HITS(1), VISITS(1, 1, 1)}},
    {"grid:resolution=3x1x1", BETWEEN, NEAREST, {MISSES(2), VISITS(1, 3, 3), .empty_steps = 1}},
    {"grid:resolution=3x1x1", BETWEEN, ANY, {MISSES(2), VISITS(1, 3, 3), .empty_steps = 1}},
    {"grid:resolution=3x1x1", BESIDE, NEAREST, {MISSES(0), .extent_tests = 1}},
    /* Eight voxels of width 1/2. A voxel holds its lower planes, so sphere 0 is in three of them, up to the
     * one that only touches it at x = 1; sphere 1 is in two; three are empty. The mailbox saves the later
     * tests. */
    {"grid:resolution=8x1x1",
     BETWEEN,
     NEAREST,
     {MISSES(2), VISITS(1, 8, 8), .empty_steps = 3, .repeats_avoided = 3}},
    {"grid:resolution=8x1x1,mailbox=off", BETWEEN, NEAREST, {MISSES(5), VISITS(1, 8, 8), .empty_steps = 3}},

    /* Nested grids: a step for each grid, too. The one voxel holds both spheres and so a grid of 5 x 1 x 1,
     * voxels of width 4/5: sphere 0 in the first two, none in the third, sphere 1 in the last two. THROUGH
     * reaches the first only. */
    {"grid:resolution=1x1x1,depth=2,nest=1,density=3", THROUGH, NEAREST, {HITS(1), VISITS(1, 3, 1)}},
    {"grid:resolution=1x1x1,depth=2,nest=1,density=3",
     BETWEEN,
     ANY,
     {MISSES(2), VISITS(1, 7, 5), .empty_steps = 1, .repeats_avoided = 2}},
    {"grid:resolution=1x1x1,depth=2,nest=1,density=3", BESIDE, ANY, {MISSES(0), .extent_tests = 1}},
    /* Nothing has more than two objects: no grid is nested, and none counts a step. */
    {"grid:resolution=1x1x1,depth=2,nest=2", BETWEEN, NEAREST, {MISSES(2), VISITS(1, 1, 1)}},
    /* Two voxels that hold grids of 2 x 1 x 1. By the slack sphere 0 reaches up to x = 2.2 and sphere 1 down
     * to 1.8, so their four voxels list 1, 2, 2 and 1 of them; one mailbox serves all grids. */
    {"grid:resolution=2x1x1,depth=2,nest=1,density=1,slack=1.2",
     BETWEEN,
     NEAREST,
     {MISSES(2), VISITS(1, 7, 4), .repeats_avoided = 4}},
    {"grid:resolution=2x1x1,depth=2,nest=1,density=1,slack=1.2,mailbox=off",
     BETWEEN,
     NEAREST,
     {MISSES(6), VISITS(1, 7, 4)}},

    /* octree: an extent test for the box of the root; a step per node visited. The root is cut at (2, 0.5,
     * 0.5) into eight leaves, four of which hold sphere 0, four sphere 1. THROUGH runs in two of the planes,
     * so beside the root it visits all four of sphere 0; those of sphere 1 begin beyond the hit. */
    {"octree:max_leaf_size=1,traversal=parametric",
     THROUGH,
     NEAREST,
     {HITS(1), VISITS(1, 5, 4), .repeats_avoided = 3}},
    {"octree:max_leaf_size=1,traversal=points",
     THROUGH,
     NEAREST,
     {HITS(1), VISITS(1, 5, 4), .repeats_avoided = 3}},
    {"octree:max_leaf_size=1,traversal=neighbours,mailbox=off", THROUGH, NEAREST, {HITS(4), VISITS(1, 5, 4)}},
    {"octree:max_leaf_size=1,traversal=points", THROUGH, ANY, {HITS(1), VISITS(1, 2, 1)}},
    /* The root and two leaves; sought from the root, or from their common ancestor, the root counts twice.
     * Who goes by neighbours learns at the root that there is none behind the second: a third time. */
    {"octree:max_leaf_size=1,traversal=parametric", BETWEEN, NEAREST, {MISSES(2), VISITS(1, 3, 2)}},
    {"octree:max_leaf_size=1,traversal=points", BETWEEN, ANY, {MISSES(2), VISITS(1, 4, 2)}},
    {"octree:max_leaf_size=1,traversal=neighbours", BETWEEN, NEAREST, {MISSES(2), VISITS(1, 5, 2)}},
    {"octree:max_leaf_size=1", BESIDE, NEAREST, {MISSES(0), .extent_tests = 1}},

    /* kd: an extent test for the cell of the root; a step per node visited. The root is cut at x = 1, sphere
     * 0 being the lower leaf; what is above is cut at x = 3 into an empty leaf and that of sphere 1. */
    {"kd:traversal_cost=0.3", THROUGH, NEAREST, {HITS(1), VISITS(1, 2, 1)}},
    {"kd:traversal_cost=0.3", BETWEEN, NEAREST, {MISSES(2), VISITS(1, 5, 3), .empty_steps = 1}},
    {"kd:traversal_cost=0.3,overlap=exact", BETWEEN, ANY, {MISSES(2), VISITS(1, 5, 3), .empty_steps = 1}},
    {"kd:max_leaf_size=1", BETWEEN, NEAREST, {MISSES(2), VISITS(1, 3, 2)}},
    /* A visit that costs ten object tests saves nothing here: the root is a leaf of two, or its children are
     * leaves if one split need not. */
    {"kd:traversal_cost=10,failures=0", THROUGH, NEAREST, {HITS(2), VISITS(1, 1, 1)}},
    {"kd:traversal_cost=10,failures=1", BETWEEN, ANY, {MISSES(2), VISITS(1, 3, 2)}},
    {"kd:traversal_cost=0.3", BESIDE, NEAREST, {MISSES(0), .extent_tests = 1}},

    /* extents: a step and an extent test per object, until the search is over; sphere 1 begins beyond the hit
     * on sphere 0. BETWEEN is inside the boxes, but 0.64 from the centres of the spheres; of slabs, the three
     * of the axes are the box again, and the diagonals of a cube's faces reject the ray. */
    {"extents:kind=box", THROUGH, NEAREST, {HITS(1), .extent_tests = 2, .steps = 2}},
    {"extents:kind=box", THROUGH, ANY, {HITS(1), .extent_tests = 1, .steps = 1}},
    {"extents:kind=box", BETWEEN, NEAREST, {MISSES(2), .extent_tests = 2, .steps = 2}},
    {"extents:kind=obb", BETWEEN, NEAREST, {MISSES(2), .extent_tests = 2, .steps = 2}},
    {"extents:kind=sphere", BETWEEN, NEAREST, {MISSES(0), .extent_tests = 2, .steps = 2}},
    {"extents:kind=slabs,slabs=3", BETWEEN, ANY, {MISSES(2), .extent_tests = 2, .steps = 2}},
    {"extents:kind=slabs,slabs=13", BETWEEN, ANY, {MISSES(0), .extent_tests = 2, .steps = 2}},
    {"extents:kind=box", BESIDE, NEAREST, {MISSES(0), .extent_tests = 2, .steps = 2}},
};

RT_TEST(counters_are_what_was_counted_by_hand) {
    OWNED_SCENE scene = begin_two_spheres();
    assert_ok(rt_scene_finish(&scene, error));
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        const Row *row = &rows[i];
        RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, row->spec);
        assert_ok(rt_accel_learn(accel, rays, answers, RAY_COUNT, error));
        OWNED_QUERY query = open_query(accel);
        RtHit hit;
        bool blocked;
        if (row->occluded) {
            rt_occluded(&query, &rays[row->ray], 1, &blocked, tallies);
            assert_true(blocked == (answers[row->ray].object != RT_NO_OBJECT));
        } else {
            rt_nearest(&query, &rays[row->ray], 1, &hit, tallies);
            assert_memory_equal(&hit, &answers[row->ray], sizeof hit);
        }
        char what[RT_MAX_SPEC_CHARS + 32];
        snprintf(what, sizeof what, "%s, ray %d, %s", row->spec, row->ray,
                 row->occluded ? "occluded" : "nearest");
        assert_tally(what, &tallies[RT_RAY_RANDOM], &row->expected);
        for (int kind = 0; kind < RT_RAY_RANDOM; kind++) assert_int_equal(tallies[kind].rays, 0);
    }
}

RT_TEST(ideal_is_broken_by_answers_that_are_no_objects) {
    OWNED_SCENE scene = begin_two_spheres();
    assert_ok(rt_scene_finish(&scene, error));
    RtHit told[RAY_COUNT];
    for (size_t i = 0; i < RAY_COUNT; i++) told[i] = RT_MISS;
    OWNED_ACCEL RtAccel *accel = open_accel(&scene, "cache+ideal");
    assert_ok(rt_accel_learn(accel, rays, told, RAY_COUNT, error));
    assert_ok(rt_accel_validate(accel, error));
    told[1].object = scene.geometry.object_count;
    assert_ok(rt_accel_learn(accel, rays, told, RAY_COUNT, error));
    assert_fails_with(rt_accel_validate(accel, error), RT_MISMATCH, "ideal: the recorded answer of ray 1");
    told[0].object = scene.geometry.object_count;
    assert_ok(rt_accel_learn(accel, rays, told, RAY_COUNT, error));
    assert_fails_with(rt_accel_validate(accel, error), RT_MISMATCH, "ideal: the recorded answer of ray 0");
}

RT_TESTS(counters, NULL, assert_nothing_is_kept)
