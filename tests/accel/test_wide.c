/* SPDX-License-Identifier: Apache-2.0 */
/* accel/wide from the inside: its invariants, broken on purpose; counts that are the same by every way to
 * trace; memory. That it hits like brute is in test_wide_exact.c. */
#include "wide_testing.h"

#include "clock_testing.h"
#include "random_testing.h"

#include <sys/mman.h>

/* Unit right triangles in planes z = 0, in a row along x, `apart` from each other. */
static RtScene make_triangles(uint32_t count, float apart) {
    RtScene scene = begin_scene();
    for (uint32_t i = 0; i < count; i++) {
        float x = apart * (float)i;
        add_triangle(&scene, rt_vec3(x, 0, 0), rt_vec3(x + 1, 0, 0), rt_vec3(x, 1, 0));
    }
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

static RtWideNode *node_at(const RtWide *wide, RtWideRef ref) {
    return (RtWideNode *)(void *)(wide->trees[0].arena + (uint64_t)rt_wide_place(ref) * RT_WIDE_UNIT);
}

/* ---- invariants ---- */

/* Of a tree of single objects: the root, and its first child that is a node. */
static RtWideRef inner_child(const RtWide *wide, uint32_t *lane) {
    const RtWideNode *root = node_at(wide, 0);
    for (*lane = 0; *lane < root->count; ++*lane) {
        if (rt_wide_kind(root->child[*lane]) == RT_WIDE_NODE) return root->child[*lane];
    }
    fail_msg("the root has leaves only");
    return 0;
}

RT_TEST(validate_names_what_is_wrong_with_a_node) {
    uint32_t lane;
    OWNED_SCENE scene = make_triangles(60, 3);
    OWNED_ACCEL RtWide *wide = make_wide(&scene, BEST_SET, "max_leaf_size=1");
    const RtAccel *accel = &wide->base;
    RtWideTree *tree = &wide->trees[0];
    RtWideRef at = inner_child(wide, &lane),
              end = rt_wide_ref((uint32_t)(tree->bytes / RT_WIDE_UNIT), 0, false);
    RtWideNode *root = node_at(wide, 0), *node = node_at(wide, at), kept_root = *root;

    for (uint32_t plane = 0; plane < 2; plane++) { /* both along x, inward and outward of the parent */
        float outward = plane ? 1 : -1, *last = &node->plane[plane][plane ? node->count - 1 : 0];
        float *first = &node->plane[plane][0];
        assert_broken_by(accel, *last, *last + outward, "does not contain its child");
        assert_broken_by(accel, *first, *first - outward * 0.5f, "does not contain its object");
    }
    for (uint32_t plane = 0; plane < 6; plane++) {
        assert_broken_by(accel, node->plane[plane][1], NAN, "does not contain its");
        assert_broken_by(accel, root->plane[plane][lane], NAN, "does not contain its child");
    }

    const uint32_t counts[] = {0, 1, 9, UINT32_MAX};
    for (int i = 0; i < 4; i++) assert_broken_by(accel, node->count, counts[i], "children");
    assert_broken_by(accel, root->count, 1, "node 0 has 1 children");
    root->count = 1; /* a node, before what would be a leaf */
    root->child[0] = at;
    assert_broken_by(accel, root->child[1], RT_WIDE_DONE, "node 0 has 1 children");
    *root = kept_root;
    root->count--; /* a child left out */
    assert_broken(accel, "has a box and no child");
    for (int p = 0; p < 6; p++) root->plane[p][root->count] = p % 2 ? -INFINITY : INFINITY;
    assert_broken(accel, "nodes are in the tree");
    *root = kept_root;

    RtWideRef *child = &root->child[lane], *other = child + 1;
    assert_broken_by(accel, *child, 0, "has a child before it");
    assert_broken_by(accel, *child, end, "is not in the arena");
    assert_broken_by(accel, *child, end - (RT_WIDE_TAGS + 1),
                     "is not in the arena"); /* begins in it, ends behind */
    assert_broken_by(accel, *child, at | RT_WIDE_MORE, "is not in the arena");
    assert_broken_by(accel, *child, RT_WIDE_DONE, "is not in the arena");
    while (other < root->child + root->count && rt_wide_kind(*other) != RT_WIDE_NODE) other++;
    assert_true(other < root->child + root->count);
    assert_broken_by(accel, *other, at, "node"); /* one has two parents, or one has none */
    assert_broken_by(accel, tree->node_count, tree->node_count + 1, "nodes are in the tree");
    assert_broken_by(accel, tree->node_count, tree->node_count - 1, "has two parents");
    assert_ok(rt_accel_validate(accel, error));
}

/* Two blocks: five triangles that lie on each other in one leaf, the root's only child. */
RT_TEST(validate_names_what_is_wrong_with_a_leaf_of_triangles) {
    OWNED_SCENE scene = make_triangles(5, 0);
    OWNED_ACCEL RtWide *wide = make_wide(&scene, BEST_SET, "max_leaf_size=8,block_cost=0");
    const RtAccel *accel = &wide->base;
    RtWideNode *root = node_at(wide, 0);
    RtWideRef *leaf = &root->child[0];
    assert_int_equal(root->count, 1);
    assert_int_equal(rt_wide_kind(*leaf), RT_WIDE_TRIANGLES);
    assert_int_equal(rt_wide_count(&wide->trees[0], *leaf), 5);
    uint32_t place = rt_wide_place(*leaf);
    RtWideTriangles *blocks = (void *)node_at(wide, *leaf);

    float *y = &blocks[1].v[2][1][0];
    assert_broken_by(accel, *y, *y + 1, "is another triangle");
    assert_broken_by(accel, *y, NAN, "is another triangle");
    assert_broken_by(accel, blocks[1].v[0][0][1], 0, "is another triangle"); /* where no triangle is */
    assert_broken_by(accel, blocks[0].id[3], RT_NO_OBJECT, "holds no triangle in lane 3");
    assert_broken_by(accel, blocks[1].id[0], 5, "holds no triangle in lane 4");
    assert_broken_by(accel, blocks[1].id[1], 5, "holds no triangle in lane 5");
    assert_broken_by(accel, blocks[1].id[0], blocks[0].id[0], "is in 2 leaves");

    const RtWideTriangles kept = blocks[1];
    blocks[1].id[0] = RT_NO_OBJECT;
    for (int c = 0; c < 9; c++) blocks[1].v[c / 3][c % 3][0] = NAN;
    assert_broken(accel, "is empty");
    blocks[1] = kept;

    assert_broken_by(accel, *leaf, rt_wide_ref(place, RT_WIDE_TRIANGLES, false), "is in 0 leaves");
    assert_broken_by(accel, *leaf, rt_wide_ref(place + 1, RT_WIDE_TRIANGLES, true), "is not in the arena");
    assert_broken_by(accel, *leaf, rt_wide_ref(place, RT_WIDE_SPHERES, true), "that is no sphere");
}

RT_TEST(validate_names_what_is_wrong_with_a_leaf_of_one_sphere) {
    OWNED_SCENE scene = make_row(3, 0);
    OWNED_ACCEL RtWide *wide = make_wide(&scene, BEST_SET, "max_leaf_size=1");
    const RtAccel *accel = &wide->base;
    RtWideRef *leaf = &node_at(wide, 0)->child[0];
    assert_int_equal(rt_wide_kind(*leaf), RT_WIDE_SPHERES);
    assert_true(rt_wide_is_sphere(*leaf));
    RtWideSphere *only = (void *)node_at(wide, *leaf);
    assert_broken_by(accel, only->id, 3, "that is no sphere");
    assert_broken_by(accel, only->sphere.radius, only->sphere.radius * 2, "is another sphere");
    assert_broken_by(accel, *leaf, rt_wide_ref(rt_wide_place(*leaf), RT_WIDE_OBJECTS, false), "wide: ");
}

RT_TEST(validate_names_what_is_wrong_with_a_list) {
    OWNED_SCENE scene = make_row(3, 0);
    OWNED_ACCEL RtWide *wide = make_wide(&scene, BEST_SET, "max_leaf_size=8,block_cost=0");
    const RtAccel *accel = &wide->base;
    RtWideNode *root = node_at(wide, 0);
    RtWideRef *leaf = &root->child[0];
    assert_int_equal(rt_wide_kind(*leaf), RT_WIDE_SPHERES);
    uint32_t place = rt_wide_place(*leaf), *ids = ((RtWideList *)(void *)node_at(wide, *leaf))->id;
    assert_broken_by(accel, ids[1], ids[0], "is in 2 leaves");
    assert_broken_by(accel, ids[1], 3, "that is no sphere");
    assert_broken_by(accel, ids[7], 0, "has a gap between its objects");
    assert_broken_by(accel, *leaf, rt_wide_ref(place, RT_WIDE_SPHERES, false), "is no sphere");
    assert_broken_by(accel, *leaf, rt_wide_ref(place, RT_WIDE_TRIANGLES, false),
                     "wide: "); /* spheres are none */
    memset(ids, 0xff, sizeof(RtWideList));
    assert_broken(accel, "is empty");
    for (uint32_t i = 0; i < 3; i++) ids[i] = i;
    assert_broken_by(accel, root->plane[1][0], root->plane[1][0] - 1, "does not contain its object");
}

/* Node after node, each with a leaf and the next node: as many as there are, the last at depth 130. */
RT_TEST(validate_names_a_node_that_is_too_deep) {
    enum { CHAIN = RT_TREE_MAX_DEPTH + 3 };
    OWNED_SCENE scene = make_row(CHAIN, 0);
    OWNED_ACCEL RtWide *wide = make_wide(&scene, BEST_SET, "max_leaf_size=1");
    RtWideTree *tree = &wide->trees[0];
    const uint32_t nodes = CHAIN * sizeof(RtWideNode);
    RtBox box = scene.geometry.box;
    tree->bytes = nodes + (CHAIN + 1) * sizeof(RtWideList);
    tree->arena = rt_arena_alloc(&wide->base.memory, tree->bytes, 1);
    tree->node_count = CHAIN;
    for (uint32_t i = 0; i < CHAIN; i++) {
        const uint32_t units = sizeof(RtWideNode) / RT_WIDE_UNIT;
        const RtWideRef leaf = rt_wide_ref(CHAIN * units + i, RT_WIDE_OBJECTS, false);
        RtWideNode *node = node_at(wide, rt_wide_ref(i * units, RT_WIDE_NODE, false));
        RtWideList *list = (void *)(tree->arena + nodes + i * sizeof *list);
        memset(list, 0xff, sizeof *list);
        list->id[0] = i;
        node->count = 2;
        for (uint32_t k = 0; k < RT_WIDE; k++) {
            RtBox own = k < 2 ? box : RT_EMPTY_BOX;
            for (int p = 0; p < 6; p++) node->plane[p][k] = (p % 2 ? own.hi : own.lo).at[p / 2];
        }
        node->child[0] = leaf;
        node->child[1] = i + 1 < CHAIN ? rt_wide_ref((i + 1) * units, RT_WIDE_NODE, false) : leaf;
    }
    char says[64];
    snprintf(says, sizeof says, "node %u is too deep",
             (RT_TREE_MAX_DEPTH + 1) * (uint32_t)sizeof(RtWideNode) / RT_WIDE_UNIT);
    assert_broken(&wide->base, says);
}

/* By `whole`, any-hit rays have a tree of their own: it is looked at too. */
RT_TEST(validate_looks_at_both_trees) {
    OWNED_SCENE scene = make_triangles(60, 3);
    OWNED_ACCEL RtWide *wide = make_wide(&scene, BEST_SET, "build=spatial,whole=on");
    assert_ptr_equal(wide->occluded, &wide->trees[1]);
    ((RtWideNode *)(void *)wide->trees[1].arena)->count = 0;
    assert_broken(&wide->base, "node 0 has 0 children");
}

/* ---- the layout ---- */

/* By hand: eight triangles far apart, each a leaf of its own, are the children of the root, one visit; and a
 * random line through the root's box meets each with the odds of their areas. */
RT_TEST(eight_objects_far_apart_are_one_node_of_eight_leaves) {
    OWNED_SCENE scene = make_row(8, 10);
    RtDescription description = describe_spec(&scene, "wide:max_leaf_size=1,block_cost=2");
    assert_int_equal(description.interior, 1);
    assert_int_equal(description.leaves, 8);
    assert_int_equal(description.depth, 1);
    assert_int_equal(description.bytes, sizeof(RtWideNode) + 8 * sizeof(RtWideList));
    /* Root 72 x 2 x 2, half area 292; each sphere 12. */
    assert_true(fabs(description.predicted_cost - (1 + 8 * 2 * 12.0 / 292.0)) < 1e-9);
}

static void assert_same_arena(const RtWideTree *one, const RtWideTree *other) {
    assert_int_equal(one->bytes, other->bytes);
    assert_true(one->cost == other->cost);
    if (one->bytes) assert_memory_equal(one->arena, other->arena, one->bytes);
}

/* Large enough for many subtrees to be placed by threads; memory is not as another structure left it. */
RT_TEST(a_structure_is_the_same_byte_for_byte_on_any_number_of_threads) {
    const char *builds[] = {"binned,reinsertion=1", "sweep", "lbvh", "ploc,max_leaf_size=8",
                            "spatial,whole=on,max_leaf_size=8"};
    const char *scenes[] = {"random:n=20000,shape=mixed", "random:n=20000,shape=triangle,radius=3"};
    for (int b = 0; b < 10; b++) {
        char text[64];
        OWNED_ACCEL RtAccel *one = NULL;
        OWNED_SCENE scene = open_scene(scenes[b / 5]);
        for (int threads = 1; threads <= 5; threads++) {
            RtAccel *other;
            snprintf(text, sizeof text, "wide:build=%s,huge_pages=%s", builds[b % 5],
                     threads % 2 ? "on" : "off");
            Labour before = labour_so_far();
            assert_ok(rt_accel_open_on(text, &scene, threads, &other, error));
            Labour labour = labour_since(before);
            if (threads == 1) assert_true(labour.others < 0.05 * labour.own);
            if (!one) one = other;
            for (int t = 0; t < 2; t++)
                assert_same_arena(&((const RtWide *)one)->trees[t], &((const RtWide *)other)->trees[t]);
            if (other != one) rt_accel_destroy(other);
        }
    }
}

/* Only the pages of the root and of its leaf, of two blocks, are in memory. */
RT_TEST(a_leaf_at_the_end_of_the_largest_arena_is_hit) {
    enum { RAYS = 128, UNITS = 2 * sizeof(RtWideTriangles) / RT_WIDE_UNIT };
    const uint32_t last = (uint32_t)(RT_WIDE_MAX_BYTES / RT_WIDE_UNIT) - UNITS;
    const char *ways[] = {"in_flight=1", "packets=0", "sharing=0"};
    OWNED_SCENE scene = make_triangles(5, 0);
    RtRay rays[RAYS];
    RtHit hits[RAYS];
    for (int i = 0; i < RAYS; i++)
        rays[i] = (RtRay){{0.25f, 0.25f, -1}, 0, {0, 0, 1}, INFINITY, RT_RAY_PRIMARY, 0};
    for (int variant = 0; variant < 3 * INSTRUCTION_SETS; variant++) {
        char settings[64];
        snprintf(settings, sizeof settings, "max_leaf_size=8,block_cost=0,%s", ways[variant % 3]);
        OWNED_ACCEL RtWide *wide = make_wide(&scene, variant / 3, settings);
        if (!wide) continue;
        RtWideTree *tree = &wide->trees[0];
        char *own = tree->arena, *large = mmap(NULL, RT_WIDE_MAX_BYTES, PROT_READ | PROT_WRITE,
                                               MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        assert_true(large != MAP_FAILED);
        memcpy(large, own, sizeof(RtWideNode));
        memcpy(large + (uint64_t)last * RT_WIDE_UNIT, rt_wide_leaf_at(tree, node_at(wide, 0)->child[0]),
               2 * sizeof(RtWideTriangles));
        tree->arena = large;
        node_at(wide, 0)->child[0] = rt_wide_ref(last, RT_WIDE_TRIANGLES, true);
        {
            OWNED_QUERY query = open_query(&wide->base);
            rt_nearest(&query, rays, RAYS, hits, NULL);
        }
        for (int i = 0; i < RAYS; i++) assert_true(hits[i].t == 1 && hits[i].object == 0);
        tree->arena = own;
        munmap(large, RT_WIDE_MAX_BYTES);
    }
}

/* ---- counts ---- */

enum { COUNTED = 3000 };

static void make_counted_rays(RtRay *rays) {
    RtRandom random = rt_random(5, 0);
    for (uint32_t i = 0; i < COUNTED; i++) {
        RtVec3 from = rt_narrow(rt_scaled(rt_random_direction(&random), 3));
        RtVec3 to = rt_random_point(&random, 1);
        if (i / 128 % 2) from = rt_vec3(2, 2.5f, 3); /* so that some would make packets */
        rays[i] =
            (RtRay){from, 0, rt_sub(to, from), i % 3 ? INFINITY : 1, i / 16 % (uint32_t)RT_RAY_KIND_COUNT, 0};
    }
}

static void count_rays(const RtWide *wide, const RtRay *rays, size_t cut, bool any, RtTally *tallies) {
    RtHit hits[COUNTED];
    uint32_t occluders[COUNTED];
    OWNED_QUERY query = open_query(&wide->base);
    for (size_t i = 0, n; i < COUNTED; i += n) {
        n = COUNTED - i < cut ? COUNTED - i : cut;
        rt_trace_stream(query.accel, query.scratch, rays + i, n, any ? NULL : hits, occluders, tallies);
    }
}

RT_TEST(counts_are_the_same_by_any_instruction_set_and_however_a_stream_is_cut_or_in_flight) {
    const char *scenes[] = {"random:n=300,shape=triangle", "random:n=300,shape=mixed"};
    const char *builds[] = {"binned", "spatial,whole=on"};
    const char *ways[] = {"",           ",in_flight=1", ",in_flight=2", ",in_flight=64",
                          ",packets=0", ",sharing=0",   ",prefetch=off"};
    const size_t cuts[] = {1, 16, 17, 64, COUNTED};
    static RtRay rays[COUNTED];
    make_counted_rays(rays);
    for (int variant = 0; variant < 8; variant++) {
        bool any = variant & 4;
        RtTally first[RT_RAY_KIND_COUNT] = {0};
        OWNED_SCENE scene = open_scene(scenes[variant & 1]);
        for (int isa = FIRST_SET; isa < INSTRUCTION_SETS; isa++) {
            for (int way = 0; way < 7; way++) {
                char settings[96];
                snprintf(settings, sizeof settings, "build=%s%s", builds[variant >> 1 & 1], ways[way]);
                OWNED_ACCEL RtWide *wide = make_wide(&scene, isa, settings);
                for (int cut = 0; wide && cut < 5; cut++) {
                    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
                    count_rays(wide, rays, cuts[cut], any, tallies);
                    if (first[0].rays == 0) memcpy(first, tallies, sizeof first);
                    assert_memory_equal(first, tallies, sizeof first);
                }
            }
        }
        assert_true(first[0].rays > 0 && first[0].hits > 0 && first[0].extent_tests > first[0].steps);
    }
}

/* By hand: the root of two lone leaves takes a step and two tests, and the leaf that is met a step and four
 * tests of triangles, all of which are counted. */
RT_TEST(a_rays_counts_are_those_by_hand) {
    OWNED_SCENE scene = begin_scene();
    for (int i = 0; i < 8; i++) {
        float x = i < 4 ? 0 : 100;
        add_triangle(&scene, rt_vec3(x, 0, 0), rt_vec3(x + 1, 0, 0), rt_vec3(x, 1, 0));
    }
    assert_ok(rt_scene_finish(&scene, error));
    const RtRay rays[2] = {{{0.25f, 0.25f, -1}, 0, {0, 0, 1}, INFINITY, RT_RAY_PRIMARY, 0},
                           {{50, 0.25f, -1}, 0, {0, 0, 1}, INFINITY, RT_RAY_RANDOM, 0}};
    OWNED_ACCEL RtAccel *wide = open_valid(&scene, "wide");
    OWNED_QUERY query = open_query(wide);
    RtHit hits[2];
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    rt_nearest(&query, rays, 2, hits, tallies);
    assert_int_equal(hits[0].object, 0);
    assert_int_equal(hits[1].object, RT_NO_OBJECT);
    assert_tally("met", &tallies[RT_RAY_PRIMARY],
                 &(RtTally){.rays = 1,
                            .hits = 1,
                            .steps = 2,
                            .leaf_steps = 1,
                            .extent_tests = 2,
                            .object_tests = 4,
                            .object_hits = 4});
    assert_tally("missed", &tallies[RT_RAY_RANDOM], &(RtTally){.rays = 1, .steps = 1, .extent_tests = 2});
}

/* ---- memory ---- */

RT_TEST(every_allocation_may_fail) {
    OWNED_SCENE scene = open_scene("random:n=100,shape=triangle");
    assert_fails_cleanly(try_accel(&scene, "wide:build=spatial,whole=on,reinsertion=1", error), (void)0);
}

RT_TEST(what_would_take_too_much_is_refused_and_what_just_fits_is_not) {
    OWNED_SCENE scene = open_scene("random:n=1000,shape=triangle");
    RtWide *wide = make_wide(&scene, BEST_SET, "");
    RtSpec spec;
    RtAccel *accel;
    uint64_t bytes = wide->trees[0].bytes;
    rt_accel_destroy(&wide->base);
    assert_ok(rt_spec_parse("wide", &spec, error));
    const RtValue *values = spec.layers[0].values;
    assert_ok(build_within("wide", bytes, &scene, values, &accel, error));
    rt_accel_destroy(accel);
    assert_bad_input(build_within("wide", bytes - 1, &scene, values, &accel, error), "max_leaf_size");
}

RT_TESTS(wide, NULL, assert_nothing_is_kept)
