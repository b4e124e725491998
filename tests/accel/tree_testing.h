/* SPDX-License-Identifier: Apache-2.0 */
/* Shared by tests of trees of references: boxes to build them from, and validation. */
#ifndef RT_TESTS_TREE_TESTING_H
#define RT_TESTS_TREE_TESTING_H

#include "accel_testing.h"

#include "accel/tree/tree.h"
#include "core/base/random.h"

#define OWNED_TREE OWNED(rt_tree_clear) RtTree

/* `count` small boxes about a few centres. */
static inline RtBox *make_boxes(uint32_t count, uint64_t seed) {
    RtBox *boxes = rt_alloc(count, sizeof(RtBox));
    RtRandom random = rt_random(seed, 0);
    RtVec3 at = {0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++) {
            if (i % 25 == 0) at.at[a] = rt_random_between(&random, -100, 100);
            boxes[i].lo.at[a] = at.at[a] + rt_random_between(&random, -5, 5);
            boxes[i].hi.at[a] = boxes[i].lo.at[a] + rt_random_between(&random, 0.1f, 2);
        }
    }
    return boxes;
}

static inline RtTree build_tree(RtBox *boxes, uint32_t count, RtTreeOptions options, int threads) {
    const RtGeometry geometry = {.boxes = boxes, .object_count = count};
    RtTree tree;
    assert_ok(rt_tree_build(&tree, &geometry, &options, threads, error));
    return tree;
}

/* Marks the nodes from `at` down, checks boxes, and returns the height. */
static inline uint32_t height_of(const RtTree *tree, uint32_t at, uint32_t *seen) {
    const RtTreeNode *node = &tree->nodes[at];
    seen[at]++;
    if (rt_tree_is_leaf(tree, at)) return 0;
    uint32_t height = 0;
    for (int s = 0; s < 2; s++) {
        uint32_t below = height_of(tree, node->child[s], seen) + 1;
        height = below > height ? below : height;
        assert_true(rt_box_contains(node->box, tree->nodes[node->child[s]].box));
    }
    return height;
}

/* Every node is in the tree once, every object a leaf; returns the height. */
static inline uint32_t assert_tree(const RtTree *tree) {
    OWNED_MEMORY uint32_t *seen = rt_alloc(tree->used, sizeof(uint32_t));
    assert_int_equal(tree->used, tree->capacity);
    uint32_t height = height_of(tree, tree->root, seen);
    for (uint32_t i = 0; i < tree->used; i++) assert_int_equal(seen[i], 1);
    return height;
}

#endif
