/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/tree/fold.h"

#include "core/base/memory.h"
#include "core/base/parallel.h"

#include <string.h>

/* Weights of the top: two of each level wait for the node above. */
enum { WAITING = 2 * RT_FOLD_LEVELS };

typedef struct Folding {
    const RtTree *tree;
    const RtFold *fold;
    RtFoldParts *parts;
    uint8_t depth[RT_FOLD_MAX_PARTS]; /* of each part */
    bool too_deep[RT_FOLD_MAX_PARTS]; /* it reaches below RT_TREE_MAX_DEPTH */
    char *waiting;                    /* [WAITING] weights */
    uint32_t next;                    /* part */
} Folding;

static void list_parts(Folding *f, uint32_t index, uint32_t depth) {
    if (!rt_fold_is_top(f->tree, index, depth)) {
        f->depth[f->parts->count] = (uint8_t)depth;
        f->parts->index[f->parts->count++] = index;
        return;
    }
    const uint32_t *child = f->tree->nodes[index].child;
    for (int s = 0; s < 2; s++) list_parts(f, child[s], depth + 1);
}

static RtStatus weigh_part(void *context, size_t item, int thread, RtError *error) {
    Folding *f = context;
    (void)thread;
    (void)error;
    f->too_deep[item] =
        !f->fold->weigh(f->fold->context, f->parts->index[item], RT_TREE_MAX_DEPTH - (uint32_t)f->depth[item],
                        f->parts->weights + item * f->fold->size);
    return RT_OK;
}

/* Of the parts in turn. */
static void weigh_top(Folding *f, uint32_t index, uint32_t depth, void *weight) {
    size_t size = f->fold->size;
    if (!rt_fold_is_top(f->tree, index, depth)) {
        memcpy(weight, f->parts->weights + f->next++ * size, size);
        return;
    }
    const uint32_t *child = f->tree->nodes[index].child;
    char *sides[2] = {f->waiting + (size_t)2 * depth * size, f->waiting + ((size_t)2 * depth + 1) * size};
    for (int s = 0; s < 2; s++) weigh_top(f, child[s], depth + 1, sides[s]);
    f->fold->unite(f->fold->context, index, (const void *const[2]){sides[0], sides[1]}, weight);
}

/* Weighs the parts; to *too_deep whether any is. */
static RtStatus weigh_parts(Folding *f, int threads, bool *too_deep, RtError *error) {
    f->parts->count = 0;
    list_parts(f, f->tree->root, 0);
    RT_TRY(rt_parallel_for(f->parts->count, threads, weigh_part, f, error));
    *too_deep = false;
    for (uint32_t i = 0; i < f->parts->count; i++) *too_deep |= f->too_deep[i];
    return RT_OK;
}

RtStatus rt_tree_fold(RtTree *tree, const RtFold *fold, int threads, RtFoldParts *parts, void *whole,
                      RtError *error) {
    size_t most = RT_FOLD_MAX_PARTS + WAITING;
    *parts = (RtFoldParts){.weights = rt_alloc(most, fold->size)};
    if (!parts->weights) return rt_fail_memory(error, "the weights of subtrees", most * fold->size);
    Folding f = {.tree = tree,
                 .fold = fold,
                 .parts = parts,
                 .waiting = parts->weights + RT_FOLD_MAX_PARTS * fold->size};
    bool too_deep;
    RT_TRY(weigh_parts(&f, threads, &too_deep, error));
    if (too_deep) {
        RT_TRY(rt_tree_limit_depth(tree, error));
        RT_TRY(weigh_parts(&f, threads, &too_deep, error));
    }
    weigh_top(&f, tree->root, 0, whole);
    return RT_OK;
}

void rt_fold_parts_clear(RtFoldParts *parts) {
    rt_free(parts->weights);
    parts->weights = NULL;
}
