/* SPDX-License-Identifier: Apache-2.0 */
/* The layout of `wide`: the room that was foreseen, blocks that are no emptier than they need be; and how
 * thick the rays are that it is traced with in lanes. */
#include "random_testing.h"
#include "tree_testing.h"

#include "accel/watertight.h"
#include "accel/wide/wide.h"

static const RtWideLayout plain = {
    .max_leaf_size = 4, .block_cost = 1, .huge_pages = true, .threads = 1, .limit = UINT64_MAX};

static const RtTreeOptions binned = {.method = RT_TREE_BINNED, .spatial.bins = 16};

/* Nodes and leaves, from `ref` on, in bytes. */
static uint64_t bytes_below(const RtWideTree *wide, RtWideRef ref) {
    uint32_t blocks = rt_wide_has_more(ref) ? 2 : 1;
    if (rt_wide_kind(ref) == RT_WIDE_TRIANGLES) return blocks * sizeof(RtWideTriangles);
    if (rt_wide_kind(ref) != RT_WIDE_NODE) return sizeof(RtWideList);
    const RtWideNode *node = rt_wide_node(wide, ref);
    uint64_t sum = sizeof(RtWideNode);
    for (uint32_t i = 0; i < node->count; i++) sum += bytes_below(wide, node->child[i]);
    return sum;
}

/* Without gaps. */
static RtWideTree lay_out(const RtScene *scene, RtTree *tree, RtArena *memory) {
    RtWideTree wide;
    assert_ok(rt_wide_lay_out(&wide, tree, &scene->geometry, &plain, memory, error));
    assert_ok(rt_wide_validate(&wide, &scene->geometry, error));
    assert_int_equal(bytes_below(&wide, 0), wide.bytes);
    return wide;
}

RT_TEST(a_leaf_is_next_to_its_node_or_another_leaf) {
    OWNED_SCENE scene = open_scene("random:n=5000,shape=mixed");
    OWNED_TREE tree = build_tree(scene.geometry.boxes, scene.geometry.object_count, binned, 1);
    RT_ARENA(memory);
    const RtWideTree wide = lay_out(&scene, &tree, &memory);
    const RtWideNode *root = rt_wide_node(&wide, 0);
    uint64_t end = sizeof(RtWideNode);
    for (int leaves = 1; leaves >= 0; leaves--) {
        for (uint32_t i = 0; i < root->count; i++) {
            if ((rt_wide_kind(root->child[i]) != RT_WIDE_NODE) != leaves) continue;
            assert_int_equal((uint64_t)rt_wide_place(root->child[i]) * RT_WIDE_UNIT, end);
            end += bytes_below(&wide, root->child[i]);
        }
    }
    assert_int_equal(end, wide.bytes);
}

/* Four triangles in a row, with gaps, share a block: halves of them have a little less area, and empty lanes.
 */
RT_TEST(a_block_is_filled_where_halves_have_hardly_less_area) {
    OWNED_SCENE scene = begin_scene();
    for (int i = 0; i < 16; i++) {
        float x = 1.1f * (float)i;
        const RtVec3 vertices[3] = {{x, 0, 0}, {x + 1, 0, 0}, {x, 1, 0}};
        assert_ok(rt_scene_add_triangle(&scene, 0, vertices, NULL, error));
    }
    assert_ok(rt_scene_finish(&scene, error));
    OWNED_TREE tree = build_tree(scene.geometry.boxes, 16, (RtTreeOptions){.method = RT_TREE_MEDIAN}, 1);
    RT_ARENA(memory);
    const RtWideTree wide = lay_out(&scene, &tree, &memory);
    assert_int_equal(wide.node_count, 1);
    assert_int_equal(wide.bytes, sizeof(RtWideNode) + 4 * sizeof(RtWideTriangles));
    assert_true(fabs(wide.cost - (1 + 4 * 4.3 / 17.5)) < 1e-5);
}

RT_TEST(one_object_is_a_leaf_below_a_root_and_what_takes_too_much_is_refused) {
    OWNED_SCENE scene = open_scene("random:n=1,shape=triangle");
    OWNED_TREE tree = build_tree(scene.geometry.boxes, 1, binned, 1);
    RtWideLayout how = plain;
    RT_ARENA(memory);
    RtWideTree wide = lay_out(&scene, &tree, &memory);
    assert_int_equal(wide.node_count, 1);
    assert_int_equal(wide.bytes, sizeof(RtWideNode) + sizeof(RtWideTriangles));
    how.limit = sizeof(RtWideNode) + sizeof(RtWideTriangles) - 1;
    RtError refusal;
    assert_int_equal(rt_wide_lay_out(&wide, &tree, &scene.geometry, &how, &memory, &refusal), RT_BAD_INPUT);
    assert_null(wide.arena);
}

/* Trees of each method number their nodes in another order. */
RT_TEST(a_tree_is_laid_out_alike_when_its_leaves_have_no_nodes) {
    OWNED_SCENE scene = open_scene("random:n=5000,shape=mixed");
    const RtTreeOptions methods[3] = {
        binned, {.method = RT_TREE_LBVH, .bits = 21}, {.method = RT_TREE_SWEEP}};
    RtBox *boxes = scene.geometry.boxes;
    for (uint32_t variant = 0; variant < 6; variant++) {
        uint32_t count = variant < 3 ? 5000 : variant - 2;
        OWNED_TREE tree = build_tree(boxes, count, methods[variant % 3], 1);
        RT_ARENA(memory);
        RtWideTree before, after;
        assert_ok(rt_wide_lay_out(&before, &tree, &scene.geometry, &plain, &memory, error));
        assert_ok(rt_tree_drop_leaves(&tree, boxes, error));
        assert_int_equal(tree.used, count - 1);
        assert_int_equal(rt_tree_leaf_count(&tree), count);
        assert_ok(rt_wide_lay_out(&after, &tree, &scene.geometry, &plain, &memory, error));
        assert_int_equal(before.bytes, after.bytes);
        assert_true(before.cost == after.cost);
        assert_memory_equal(before.arena, after.arena, before.bytes);
    }
}

RT_TEST(split_references_keep_their_nodes_and_so_does_a_tree_if_memory_is_short) {
    OWNED_SCENE scene = open_scene("random:n=200,shape=triangle,radius=3");
    const RtTreeOptions how = {
        .method = RT_TREE_SPATIAL,
        .spatial = {.bins = 16, .budget = 2, .max_leaf_size = 4, .traversal = 1, .limit = UINT64_MAX}};
    OWNED_TREE split = {0}, whole = build_tree(scene.geometry.boxes, 200, binned, 1);
    assert_ok(rt_tree_build(&split, &scene.geometry, &how, 1, error));
    const uint32_t used = split.used;
    assert_true(split.split_refs);
    assert_ok(rt_tree_drop_leaves(&split, scene.geometry.boxes, error));
    assert_int_equal(split.used, used);
    for (uint64_t n = 1; n <= 2; n++) {
        RtError refusal;
        rt_alloc_fail_at(n);
        assert_int_equal(rt_tree_drop_leaves(&whole, scene.geometry.boxes, &refusal), RT_NO_MEMORY);
        assert_tree(&whole);
    }
}

/* The largest trees at once: all nodes and the references while it is built; then the inner nodes, their plan
 * and the arena. */
RT_TEST(a_million_triangles_are_built_in_140_bytes_each_beside_80_of_the_scene) {
    OWNED_SCENE scene = open_scene("forest:n=1030");
    const uint64_t count = scene.geometry.object_count;
    OWNED_ACCEL RtAccel *accel;
    assert_true(count > 1 << 20);
    assert_true(rt_scene_bytes(&scene) < 80 * count);
    rt_memory_limit(140 * count);
    assert_ok(rt_memory_unlimit(rt_accel_open("wide", &scene, &accel, error), error));
}

RT_TEST(rays_in_lanes_are_as_thick_as_one_by_one) {
    RtRandom random = rt_random(31, 0);
    for (int i = 0; i < 1000; i++) {
        RtGeometry g = {.box = {rt_random_point(&random, 1), rt_random_point(&random, 1)}};
        RtVec3 at = rt_random_point(&random, i % 2 ? 1 : 1e4f);
        const RtFloats org[3] = {rt_all(at.x), rt_all(at.y), rt_all(at.z)};
        const RtRay ray = {.org = at, .dir = {{1, 1, 1}}, .tmax = INFINITY};
        RtPreparedRay prepared = rt_ray_prepare(&ray, &g.box);
        float lanes[RT_LANES];
        for (int a = 0; a < 3; a++) {
            rt_store(lanes, org[a] + rt_lanes_shift(rt_lanes_thickness(org, &g.box), org[a]));
            for (int k = 0; k < RT_LANES; k++) assert_true(lanes[k] == prepared.org_near[a]);
        }
    }
}

RT_TESTS(wide_layout, NULL, NULL)
