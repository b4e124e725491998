/* SPDX-License-Identifier: Apache-2.0 */
/* Boxes come depth first or level by level (RtAccelOps.each_box). In both orders the parent of one is the
 * first of the level above that still lacks children. */
#include "measure/node_file.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <inttypes.h>

#define NONE UINT32_MAX

enum { MOST_LEVELS = 256 }; /* deeper nodes have no parent */

/* A node with children. */
typedef struct Parent {
    uint32_t number, level, lacks; /* lacks: children that have not come yet */
} Parent;

typedef struct Nodes {
    Parent *parents; /* [count] in the order of the file */
    uint32_t count, capacity, written;
    uint32_t next[MOST_LEVELS]; /* of each level: no parent before this one lacks a child */
    bool lists;                 /* the lengths of leaves are known */
    FILE *file;
    RtStatus status;
    RtError *error;
} Nodes;

/* The first node of the level that lacks a child, which it gets; NONE if there is none. */
static uint32_t take_parent(Nodes *nodes, uint32_t level) {
    for (uint32_t *at = &nodes->next[level]; *at < nodes->count; ++*at) {
        Parent *parent = &nodes->parents[*at];
        if (parent->level != level || parent->lacks == 0) continue;
        parent->lacks--;
        return parent->number;
    }
    return NONE;
}

static void write_node(void *context, const RtBoxView *view) {
    Nodes *nodes = context;
    const RtBox *box = view->box;
    const Parent own = {nodes->written, view->depth, view->children};
    const bool known = view->depth > 0 && view->depth <= MOST_LEVELS;
    const uint32_t parent = known ? take_parent(nodes, view->depth - 1) : NONE;
    if (nodes->status == RT_OK && own.lacks > 0)
        nodes->status =
            rt_append(&nodes->parents, &nodes->count, &nodes->capacity, &own, sizeof own, nodes->error);
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
    rt_free(nodes.parents);
    return nodes.status;
}
