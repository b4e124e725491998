/* SPDX-License-Identifier: Apache-2.0 */
/* accel/wide from the inside: its invariants, broken on purpose; counts that are the same by every way to
 * trace; memory. That it hits like brute is in test_wide_exact.c. */
#include "wide_testing.h"

#include "clock_testing.h"
#include "core/base/random.h"
#include "scenes/open.h"

#include <math.h>

/* Unit right triangles in planes z = 0, or unit spheres, in a row along x, `apart` from each other. */
static void make_row(RtScene *scene, uint32_t count, float apart, bool triangles) {
    begin_scene(scene);
    for (uint32_t i = 0; i < count; i++) {
        float x = apart * (float)i;
        if (triangles)
            add_triangle(scene, rt_vec3(x, 0, 0), rt_vec3(x + 1, 0, 0), rt_vec3(x, 1, 0));
        else
            assert_ok(rt_scene_add_sphere(scene, 0, rt_vec3(x, 0, 0), 1, error));
    }
    assert_ok(rt_scene_finish(scene, error));
}

static RtWideNode *node_at(const RtWide *wide, RtWideRef ref) {
    return (RtWideNode *)(void *)(wide->trees[0].arena + ref);
}

static void unmake(RtWide *wide, RtScene *scene) {
    rt_accel_destroy(&wide->isa.base);
    rt_scene_clear(scene);
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
    RtScene scene;
    uint32_t lane;
    make_row(&scene, 60, 3, true);
    RtWide *wide = make_wide(&scene, BEST_SET, "max_leaf_size=1");
    RtWideRef at = inner_child(wide, &lane);
    RtWideNode *root = node_at(wide, 0), *node = node_at(wide, at), kept_root = *root, kept = *node;

    for (uint32_t plane = 0; plane < 2; plane++) { /* both along x, inward and outward of the parent */
        float outward = plane ? 1 : -1;
        node->plane[plane][plane ? node->count - 1 : 0] += outward;
        assert_broken(&wide->isa.base, "does not contain its child");
        *node = kept;
        node->plane[plane][0] -= outward * 0.5f;
        assert_broken(&wide->isa.base, "does not contain its object");
        *node = kept;
    }
    for (uint32_t plane = 0; plane < 6; plane++) {
        node->plane[plane][1] = NAN;
        assert_broken(&wide->isa.base, "does not contain its");
        *node = kept;
        root->plane[plane][lane] = NAN;
        assert_broken(&wide->isa.base, "does not contain its child");
        *root = kept_root;
    }

    const uint32_t counts[] = {0, 1, 9, UINT32_MAX};
    for (int i = 0; i < 4; i++) {
        node->count = counts[i];
        assert_broken(&wide->isa.base, "children");
        *node = kept;
    }
    root->count = 1;
    assert_broken(&wide->isa.base, "node 0 has 1 children");
    *root = kept_root;
    root->count--; /* a child left out */
    assert_broken(&wide->isa.base, "has a box and no child");
    for (int p = 0; p < 6; p++) root->plane[p][root->count] = p % 2 ? -INFINITY : INFINITY;
    assert_broken(&wide->isa.base, "nodes are in the tree");
    *root = kept_root;

    root->child[lane] = 0;
    assert_broken(&wide->isa.base, "has a child before it");
    root->child[lane] = (RtWideRef)wide->trees[0].bytes;
    assert_broken(&wide->isa.base, "is not in the arena");
    root->child[lane] = (RtWideRef)wide->trees[0].bytes - RT_WIDE_UNIT; /* begins in it, ends behind */
    assert_broken(&wide->isa.base, "is not in the arena");
    root->child[lane] = at | 4; /* a node has no number of objects */
    assert_broken(&wide->isa.base, "is not in the arena");
    root->child[lane] = RT_WIDE_DONE;
    assert_broken(&wide->isa.base, "is not in the arena");
    *root = kept_root;
    uint32_t other = lane + 1;
    while (other < root->count && rt_wide_kind(root->child[other]) != RT_WIDE_NODE) other++;
    assert_true(other < root->count);
    root->child[other] = at;
    assert_broken(&wide->isa.base, "node"); /* one has two parents, or one has none */
    *root = kept_root;
    wide->trees[0].node_count++;
    assert_broken(&wide->isa.base, "nodes are in the tree");
    wide->trees[0].node_count -= 2;
    assert_broken(&wide->isa.base, "has two parents");
    wide->trees[0].node_count++;
    assert_ok(wide->isa.base.ops->validate(&wide->isa.base, error));
    unmake(wide, &scene);
}

/* Two blocks: five triangles that lie on each other in one leaf, the root's only child. */
RT_TEST(validate_names_what_is_wrong_with_a_leaf_of_triangles) {
    RtScene scene;
    make_row(&scene, 5, 0, true);
    RtWide *wide = make_wide(&scene, BEST_SET, "max_leaf_size=8,block_cost=0");
    RtWideNode *root = node_at(wide, 0);
    RtWideRef leaf = root->child[0];
    assert_int_equal(root->count, 1);
    assert_int_equal(rt_wide_kind(leaf), RT_WIDE_TRIANGLES);
    assert_int_equal(rt_wide_count(leaf), 5);
    RtWideTriangles *blocks = (void *)(wide->trees[0].arena + rt_wide_place(leaf)), kept[2];
    memcpy(kept, blocks, sizeof kept);

    blocks[1].v[2][1][0] += 1;
    assert_broken(&wide->isa.base, "is another triangle");
    blocks[1].v[2][1][0] = NAN;
    assert_broken(&wide->isa.base, "is another triangle");
    memcpy(blocks, kept, sizeof kept);
    blocks[1].v[0][0][1] = 0; /* where no triangle is */
    assert_broken(&wide->isa.base, "is another triangle");
    memcpy(blocks, kept, sizeof kept);
    blocks[1].id[0] = RT_NO_OBJECT;
    assert_broken(&wide->isa.base, "holds no triangle in lane 4");
    blocks[1].id[0] = 5;
    assert_broken(&wide->isa.base, "holds no triangle in lane 4");
    blocks[1].id[0] = blocks[0].id[0];
    assert_broken(&wide->isa.base, "is in 2 leaves");
    memcpy(blocks, kept, sizeof kept);

    root->child[0] = rt_wide_leaf(RT_WIDE_TRIANGLES, rt_wide_place(leaf), 6);
    assert_broken(&wide->isa.base, "holds no triangle in lane 5");
    root->child[0] = rt_wide_leaf(RT_WIDE_TRIANGLES, rt_wide_place(leaf), 4);
    assert_broken(&wide->isa.base, "is in 0 leaves");
    root->child[0] = rt_wide_leaf(RT_WIDE_TRIANGLES, rt_wide_place(leaf) + RT_WIDE_UNIT, 5);
    assert_broken(&wide->isa.base, "is not in the arena");
    root->child[0] = rt_wide_leaf(RT_WIDE_FINISHED, rt_wide_place(leaf), 5);
    assert_broken(&wide->isa.base, "is not in the arena");
    unmake(wide, &scene);
}

RT_TEST(validate_names_what_is_wrong_with_a_list) {
    RtScene scene;
    make_row(&scene, 3, 0, false);
    RtWide *wide = make_wide(&scene, BEST_SET, "max_leaf_size=8,block_cost=0");
    RtWideNode *root = node_at(wide, 0);
    RtWideRef leaf = root->child[0];
    assert_int_equal(rt_wide_kind(leaf), RT_WIDE_OBJECTS);
    RtWideList *list = (void *)(wide->trees[0].arena + rt_wide_place(leaf)), kept = *list;
    list->id[1] = list->id[0];
    assert_broken(&wide->isa.base, "is in 2 leaves");
    list->id[1] = 3;
    assert_broken(&wide->isa.base, "holds no object");
    *list = kept;
    list->id[7] = 0;
    assert_broken(&wide->isa.base, "holds more than its objects");
    *list = kept;
    root->child[0] = rt_wide_leaf(RT_WIDE_OBJECTS, rt_wide_place(leaf), 2);
    assert_broken(&wide->isa.base, "holds more than its objects");
    root->child[0] = rt_wide_leaf(RT_WIDE_TRIANGLES, rt_wide_place(leaf), 3); /* spheres are none */
    assert_broken(&wide->isa.base, "wide: ");
    root->child[0] = leaf;
    root->plane[1][0] -= 1;
    assert_broken(&wide->isa.base, "does not contain its object");
    unmake(wide, &scene);
}

/* Node after node, each with a leaf and the next node: as many as there are, the last at depth 130. */
RT_TEST(validate_names_a_node_that_is_too_deep) {
    enum { CHAIN = RT_TREE_MAX_DEPTH + 3 };
    RtScene scene;
    make_row(&scene, CHAIN, 0, false);
    RtWide *wide = make_wide(&scene, BEST_SET, "max_leaf_size=1");
    RtWideTree *tree = &wide->trees[0];
    const uint32_t nodes = CHAIN * sizeof(RtWideNode);
    RtBox box = scene.geometry.box;
    rt_free(tree->arena);
    tree->bytes = nodes + (CHAIN + 1) * sizeof(RtWideList);
    tree->arena = rt_alloc(tree->bytes, 1);
    tree->node_count = CHAIN;
    for (uint32_t i = 0; i < CHAIN; i++) {
        RtWideNode *node = node_at(wide, i * (uint32_t)sizeof *node);
        RtWideList *list = (void *)(tree->arena + nodes + i * sizeof *list);
        memset(list, 0xff, sizeof *list);
        list->id[0] = i;
        node->count = 2;
        for (uint32_t k = 0; k < RT_WIDE; k++) {
            RtBox own = k < 2 ? box : RT_EMPTY_BOX;
            for (int p = 0; p < 6; p++) node->plane[p][k] = (p % 2 ? own.hi : own.lo).at[p / 2];
        }
        node->child[0] = rt_wide_leaf(RT_WIDE_OBJECTS, nodes + i * (uint32_t)sizeof *list, 1);
        node->child[1] = i + 1 < CHAIN ? (i + 1) * (uint32_t)sizeof *node
                                       : rt_wide_leaf(RT_WIDE_OBJECTS, nodes + i * (uint32_t)sizeof *list, 1);
    }
    assert_broken(&wide->isa.base, "is too deep");
    unmake(wide, &scene);
}

/* By `whole`, any-hit rays have a tree of their own: it is looked at too. */
RT_TEST(validate_looks_at_both_trees) {
    RtScene scene;
    make_row(&scene, 60, 3, true);
    RtWide *wide = make_wide(&scene, BEST_SET, "build=spatial,whole=on");
    assert_ptr_equal(wide->occluded, &wide->trees[1]);
    ((RtWideNode *)(void *)wide->trees[1].arena)->count = 0;
    assert_broken(&wide->isa.base, "node 0 has 0 children");
    unmake(wide, &scene);
}

/* ---- the layout ---- */

/* By hand: eight triangles far apart, each a leaf of its own, are the children of the root, one visit; and a
 * random line through the root's box meets each with the odds of their areas. */
RT_TEST(eight_objects_far_apart_are_one_node_of_eight_leaves) {
    RtScene scene;
    make_row(&scene, 8, 10, false);
    RtWide *wide = make_wide(&scene, BEST_SET, "max_leaf_size=1,block_cost=2");
    RtDescription description;
    rt_accel_describe(&wide->isa.base, &description);
    assert_int_equal(description.interior, 1);
    assert_int_equal(description.leaves, 8);
    assert_int_equal(description.depth, 1);
    assert_int_equal(description.bytes, sizeof(RtWideNode) + 8 * sizeof(RtWideList));
    /* Root 72 x 2 x 2, half area 292; each sphere 12. */
    assert_true(fabs(description.predicted_cost - (1 + 8 * 2 * 12.0 / 292.0)) < 1e-9);
    unmake(wide, &scene);
}

RT_TEST(a_structure_is_the_same_byte_for_byte_on_any_number_of_threads) {
    const char *builds[] = {"binned", "sweep", "lbvh", "ploc", "spatial,whole=on"};
    RtScene scene;
    assert_ok(rt_scene_open("random:n=20000,shape=mixed", &scene, error));
    for (int b = 0; b < 5; b++) {
        RtAccel *accels[3];
        char text[64];
        snprintf(text, sizeof text, "wide:build=%s,huge_pages=%s", builds[b], b % 2 ? "on" : "off");
        for (int threads = 1; threads <= 3; threads++) {
            Labour before = labour_so_far();
            assert_ok(rt_accel_open_on(text, &scene, threads, &accels[threads - 1], error));
            Labour labour = labour_since(before);
            if (threads == 1) assert_true(labour.others < 0.05 * labour.own);
        }
        const RtWide *one = (const RtWide *)accels[0];
        for (int k = 1; k < 3; k++) {
            const RtWide *other = (const RtWide *)accels[k];
            for (int t = 0; t < 2; t++) {
                assert_int_equal(one->trees[t].bytes, other->trees[t].bytes);
                if (one->trees[t].bytes)
                    assert_memory_equal(one->trees[t].arena, other->trees[t].arena, one->trees[t].bytes);
            }
        }
        for (int k = 0; k < 3; k++) rt_accel_destroy(accels[k]);
    }
    rt_scene_clear(&scene);
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
    RtQuery query;
    RtHit hits[COUNTED];
    bool blocked[COUNTED];
    assert_ok(rt_query_init(&query, &wide->isa.base, error));
    for (size_t i = 0, n; i < COUNTED; i += n) {
        n = COUNTED - i < cut ? COUNTED - i : cut;
        if (any)
            rt_occluded(&query, rays + i, n, blocked, tallies);
        else
            rt_nearest(&query, rays + i, n, hits, tallies);
    }
    rt_query_clear(&query);
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
        RtScene scene;
        bool any = variant & 4;
        RtTally first[RT_RAY_KIND_COUNT] = {0};
        assert_ok(rt_scene_open(scenes[variant & 1], &scene, error));
        for (int isa = FIRST_SET; isa < INSTRUCTION_SETS; isa++) {
            for (int way = 0; way < 7; way++) {
                char settings[96];
                snprintf(settings, sizeof settings, "build=%s%s", builds[variant >> 1 & 1], ways[way]);
                RtWide *wide = make_wide(&scene, isa, settings);
                for (int cut = 0; wide && cut < 5; cut++) {
                    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
                    count_rays(wide, rays, cuts[cut], any, tallies);
                    if (first[0].rays == 0) memcpy(first, tallies, sizeof first);
                    assert_memory_equal(first, tallies, sizeof first);
                }
                rt_accel_destroy(wide ? &wide->isa.base : NULL);
            }
        }
        assert_true(first[0].rays > 0 && first[0].hits > 0 && first[0].extent_tests > first[0].steps);
        rt_scene_clear(&scene);
    }
}

/* By hand: the root of two lone leaves takes a step and two tests, and the leaf that is met a step and four
 * tests of triangles, all of which are counted. */
RT_TEST(a_rays_counts_are_those_by_hand) {
    RtScene scene;
    begin_scene(&scene);
    for (int i = 0; i < 8; i++) {
        float x = i < 4 ? 0 : 100;
        add_triangle(&scene, rt_vec3(x, 0, 0), rt_vec3(x + 1, 0, 0), rt_vec3(x, 1, 0));
    }
    assert_ok(rt_scene_finish(&scene, error));
    const RtRay rays[2] = {{{0.25f, 0.25f, -1}, 0, {0, 0, 1}, INFINITY, RT_RAY_PRIMARY, 0},
                           {{50, 0.25f, -1}, 0, {0, 0, 1}, INFINITY, RT_RAY_RANDOM, 0}};
    RtWide *wide = make_wide(&scene, BEST_SET, "");
    RtQuery query;
    RtHit hits[2];
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    assert_ok(rt_query_init(&query, &wide->isa.base, error));
    rt_nearest(&query, rays, 2, hits, tallies);
    const RtTally *met = &tallies[RT_RAY_PRIMARY], *missed = &tallies[RT_RAY_RANDOM];
    assert_int_equal(hits[0].object, 0);
    assert_int_equal(met->rays, 1);
    assert_int_equal(met->hits, 1);
    assert_int_equal(met->steps, 2);
    assert_int_equal(met->leaf_steps, 1);
    assert_int_equal(met->extent_tests, 2);
    assert_int_equal(met->object_tests, 4);
    assert_int_equal(met->object_hits, 4);
    assert_int_equal(hits[1].object, RT_NO_OBJECT);
    assert_int_equal(missed->steps, 1);
    assert_int_equal(missed->extent_tests, 2);
    assert_int_equal(missed->object_tests, 0);
    rt_query_clear(&query);
    unmake(wide, &scene);
}

/* ---- memory ---- */

RT_TEST(every_allocation_may_fail) {
    RtScene scene;
    assert_ok(rt_scene_open("random:n=100,shape=triangle", &scene, error));
    int64_t live = rt_alloc_live();
    RtStatus status = RT_NO_MEMORY;
    for (uint64_t n = 1; status != RT_OK; n++) {
        RtAccel *accel = NULL;
        RtQuery query = {0};
        RtError failure = {RT_OK, ""};
        rt_alloc_fail_at(n);
        status = rt_accel_open("wide:build=spatial,whole=on,reinsertion=1", &scene, &accel, &failure);
        if (status == RT_OK) status = rt_accel_validate(accel, &failure);
        if (status == RT_OK) status = rt_query_init(&query, accel, &failure);
        rt_alloc_fail_at(0);
        if (status == RT_OK) rt_query_clear(&query);
        if (status != RT_OK) assert_int_equal(status, RT_NO_MEMORY);
        rt_accel_destroy(accel);
        assert_int_equal(rt_alloc_live(), live);
        assert_in_range(n, 1, 60);
    }
    rt_scene_clear(&scene);
}

RT_TEST(what_would_take_too_much_is_refused_and_what_just_fits_is_not) {
    RtScene scene;
    assert_ok(rt_scene_open("random:n=1000,shape=triangle", &scene, error));
    RtWide *wide = make_wide(&scene, BEST_SET, "");
    RtSpec spec;
    RtAccel *accel;
    RtError refusal = {RT_OK, ""};
    uint64_t bytes = wide->trees[0].bytes;
    rt_accel_destroy(&wide->isa.base);
    assert_ok(rt_spec_parse("wide", &spec, error));
    const RtValue *values = spec.layers[0].values;
    assert_ok(build_within("wide", bytes, &scene, values, &accel, error));
    rt_accel_destroy(accel);
    assert_int_equal(build_within("wide", bytes - 1, &scene, values, &accel, &refusal), RT_BAD_INPUT);
    assert_non_null(strstr(refusal.message, "max_leaf_size"));
    rt_scene_clear(&scene);
}

RT_TEST(an_instruction_set_that_is_not_there_is_no_crash) {
    RtScene scene;
    make_row(&scene, 3, 2, true);
    for (int isa = 0; isa < INSTRUCTION_SETS; isa++) {
        RtWide *wide = make_wide(&scene, isa, "");
        if (isa == BEST_SET) assert_non_null(wide);
        if (!wide) print_message("skipped here: isa=%s\n", instruction_sets[isa]);
        rt_accel_destroy(wide ? &wide->isa.base : NULL);
    }
    rt_scene_clear(&scene);
}

RT_TESTS(wide, NULL, assert_nothing_is_kept)
