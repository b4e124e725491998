/* SPDX-License-Identifier: Apache-2.0 */
/* Parts are numbered in the order of a depth-first walk. The top is reduced in the same order, so its pending
 * values form a stack, two for each level. */
#include "accel/tree/reduction.h"

#include "core/base/parallel.h"

#include <string.h>

/* Values of the top: two of each level are pending at a time. */
enum { PENDING = 2 * RT_REDUCTION_LEVELS };

typedef struct Job {
    const RtTree *tree;
    const RtReduction *reduction;
    RtReducedParts *parts;
    uint8_t depth[RT_REDUCTION_MAX_PARTS]; /* of each part */
    bool too_deep[RT_REDUCTION_MAX_PARTS]; /* it reaches below RT_TREE_MAX_DEPTH */
    char *pending;                         /* [PENDING] values */
    uint32_t next;                         /* part */
} Job;

static void list_parts(Job *job, uint32_t index, uint32_t depth) {
    if (!rt_reduction_is_top(job->tree, index, depth)) {
        job->depth[job->parts->count] = (uint8_t)depth;
        job->parts->index[job->parts->count++] = index;
        return;
    }
    const uint32_t *child = job->tree->nodes[index].child;
    for (int s = 0; s < 2; s++) list_parts(job, child[s], depth + 1);
}

static void reduce_part(void *context, size_t item) {
    Job *job = context;
    job->too_deep[item] = !job->reduction->reduce(job->reduction->context, job->parts->index[item],
                                                  RT_TREE_MAX_DEPTH - (uint32_t)job->depth[item],
                                                  job->parts->values + item * job->reduction->size);
}

/* Takes the values of the parts in order. */
static void reduce_top(Job *job, uint32_t index, uint32_t depth, void *value) {
    size_t size = job->reduction->size;
    if (!rt_reduction_is_top(job->tree, index, depth)) {
        memcpy(value, job->parts->values + job->next++ * size, size);
        return;
    }
    const uint32_t *child = job->tree->nodes[index].child;
    char *values[2] = {job->pending + (size_t)2 * depth * size,
                       job->pending + ((size_t)2 * depth + 1) * size};
    for (int s = 0; s < 2; s++) reduce_top(job, child[s], depth + 1, values[s]);
    job->reduction->combine(job->reduction->context, index, (const void *const[2]){values[0], values[1]},
                            value);
}

/* Reduces the parts; *too_deep: some leaf is below RT_TREE_MAX_DEPTH. */
static RtStatus reduce_parts(Job *job, int threads, bool *too_deep, RtError *error) {
    job->parts->count = 0;
    list_parts(job, job->tree->root, 0);
    RT_TRY(rt_parallel_each(job->parts->count, threads, reduce_part, job, error));
    *too_deep = false;
    for (uint32_t i = 0; i < job->parts->count; i++) *too_deep |= job->too_deep[i];
    return RT_OK;
}

RtStatus rt_tree_reduce(RtTree *tree, const RtReduction *reduction, RtArena *memory, int threads,
                        RtReducedParts *parts, void *whole, RtError *error) {
    parts->values = rt_arena_alloc(memory, RT_REDUCTION_MAX_PARTS + PENDING, reduction->size);
    RT_TRY(rt_arena_check(memory, "a reduction over a tree", error));
    Job job = {.tree = tree,
               .reduction = reduction,
               .parts = parts,
               .pending = parts->values + RT_REDUCTION_MAX_PARTS * reduction->size};
    bool too_deep;
    RT_TRY(reduce_parts(&job, threads, &too_deep, error));
    if (too_deep) {
        RT_TRY(rt_tree_limit_depth(tree, error));
        RT_TRY(reduce_parts(&job, threads, &too_deep, error));
    }
    reduce_top(&job, tree->root, 0, whole);
    return RT_OK;
}
