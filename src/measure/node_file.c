/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes come depth first or level by level (RtAccelOps.each_box). In both orders the parent of one is the
 * first of the level above that still lacks children. */
#include "measure/node_file.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <inttypes.h>

#define NONE UINT32_MAX

typedef struct Node {
    uint32_t number, next; /* the next of its level, or NONE */
    uint32_t lacks;        /* children that have not come yet */
} Node;

/* The first and the last node of a level that may lack children. */
typedef struct Level {
    uint32_t first, last;
} Level;

typedef struct Nodes {
    Node *nodes;   /* [count] those that have children */
    Level *levels; /* [level_count] */
    uint32_t count, capacity, level_count, level_capacity, written;
    bool lists; /* the lengths of leaves are known */
    FILE *file;
    RtStatus status;
    RtError *error;
} Nodes;

/* Takes a child from the first node of the level that lacks one; NONE if there is none. */
static uint32_t take_parent(Nodes *nodes, uint32_t level) {
    if (level >= nodes->level_count) return NONE;
    uint32_t *first = &nodes->levels[level].first;
    while (*first != NONE && nodes->nodes[*first].lacks == 0) *first = nodes->nodes[*first].next;
    if (*first == NONE) return NONE;
    nodes->nodes[*first].lacks--;
    return nodes->nodes[*first].number;
}

/* Adds a node with children to the end of its level. */
static RtStatus add_parent(Nodes *nodes, const RtBoxView *view) {
    const Level none = {NONE, NONE};
    const Node node = {nodes->written, NONE, view->children};
    while (nodes->level_count <= view->depth)
        RT_TRY(rt_append(&nodes->levels, &nodes->level_count, &nodes->level_capacity, &none, sizeof none,
                         nodes->error));
    Level *level = &nodes->levels[view->depth];
    if (level->first == NONE)
        level->first = nodes->count;
    else
        nodes->nodes[level->last].next = nodes->count;
    level->last = nodes->count;
    return rt_append(&nodes->nodes, &nodes->count, &nodes->capacity, &node, sizeof node, nodes->error);
}

static void write_node(void *context, const RtBoxView *view) {
    Nodes *nodes = context;
    const RtBox *box = view->box;
    const uint32_t parent = view->depth > 0 ? take_parent(nodes, view->depth - 1) : NONE;
    if (nodes->status == RT_OK && view->children > 0) nodes->status = add_parent(nodes, view);
    fprintf(nodes->file, "%" PRIu32 ",", nodes->written++);
    if (parent != NONE) fprintf(nodes->file, "%" PRIu32, parent);
    fprintf(nodes->file, ",%" PRIu32 ",%s,%" PRIu32 ",", view->depth, view->leaf ? "true" : "false",
            view->children);
    if (view->leaf && nodes->lists) fprintf(nodes->file, "%" PRIu32, view->objects);
    for (int i = 0; i < 6; i++) {
        fputc(',', nodes->file);
        if (!rt_box_is_empty(*box))
            fprintf(nodes->file, "%.9g", (double)(i < 3 ? box->lo : box->hi).at[i % 3]);
    }
    fputc('\n', nodes->file);
}

RtStatus rt_nodes_save(const RtAccel *accel, const char *path, uint32_t *count, RtError *error) {
    RtOutput output;
    Nodes nodes = {.error = error};
    const char *name = accel->ops->name;
    while (accel && !accel->ops->each_box) accel = accel->below;
    if (!accel) return rt_fail(error, RT_BAD_INPUT, "%s has no nodes or voxels to write", name);
    RT_TRY(rt_output_open(&output, path, error));
    nodes.file = output.file;
    nodes.lists = accel->ops->shows_lists;
    fputs("node,parent,level,leaf,children,objects,lo_x,lo_y,lo_z,hi_x,hi_y,hi_z\n", output.file);
    accel->ops->each_box(accel, (RtBoxViewer){write_node, &nodes});
    if (nodes.status == RT_OK)
        nodes.status = rt_output_commit(&output, error);
    else
        rt_output_discard(&output);
    *count = nodes.written;
    rt_free(nodes.nodes);
    rt_free(nodes.levels);
    return nodes.status;
}
