/* SPDX-License-Identifier: Apache-2.0 */
/* Building and compiling trees (csg.h). To compile, the tree is written out as an array of parts in
 * preorder, one per use of a term: the left operand follows its part at once, the right one after all of
 * the left. A pass from the back sees operands before operations. Nothing here is recursive; the stacks
 * are no higher than the tree is deep. */
#include "core/shape/csg.h"

#include "core/base/memory.h"

#include <assert.h>

/* ---- terms: nodes in a growing array, operands before operations ---- */

void rt_csg_builder_clear(RtCsgBuilder *builder) {
    rt_solid_set_clear(&builder->set);
    rt_free(builder->nodes);
    *builder = (RtCsgBuilder){0};
}

static RtStatus add_node(RtCsgBuilder *builder, const RtCsgNode *node, RtCsgTerm *out, RtError *error) {
    *out = builder->node_count;
    return rt_append(&builder->nodes, &builder->node_count, &builder->node_capacity, node, sizeof *node,
                     error);
}

RtStatus rt_csg_solid(RtCsgBuilder *builder, uint32_t solid, uint32_t material, RtCsgTerm *out,
                      RtError *error) {
    assert(solid < builder->set.solid_count);
    RtCsgNode node = {.kind = RT_CSG_SOLID, .left = solid, .size = 1};
    RT_TRY(add_node(builder, &node, out, error));
    builder->set.solids[solid].material = material;
    return RT_OK;
}

RtStatus rt_csg_combine(RtCsgBuilder *builder, RtCsgOp op, RtCsgTerm left, RtCsgTerm right, RtCsgTerm *out,
                        RtError *error) {
    assert(left < builder->node_count && right < builder->node_count);
    uint32_t size = builder->nodes[left].size + builder->nodes[right].size;
    if (size > RT_CSG_MAX_SOLIDS)
        return rt_fail(error, RT_BAD_INPUT,
                       "a tree of %u solids, counting each use of a named part: the limit is %u", size,
                       RT_CSG_MAX_SOLIDS);
    RtCsgNode node = {.kind = RT_CSG_COMBINE, .op = op, .left = left, .right = right, .size = size};
    return add_node(builder, &node, out, error);
}

/* Consecutive moves are composed, so that a tree has at most twice as many moves as solids. */
RtStatus rt_csg_move(RtCsgBuilder *builder, RtCsgTerm term, const RtTransform *move, RtCsgTerm *out,
                     RtError *error) {
    assert(term < builder->node_count);
    const RtCsgNode *moved = &builder->nodes[term];
    RtCsgNode node = {.kind = RT_CSG_MOVE, .left = term, .move = *move, .size = moved->size};
    if (moved->kind == RT_CSG_MOVE) {
        node.left = moved->left;
        node.move = rt_transform_compose(&moved->move, move);
    }
    return add_node(builder, &node, out, error);
}

/* ---- from terms to programs ---- */

#define NONE UINT32_MAX

/* Up to this many lists, operands are ordered to save tests; beyond, to need few lists. */
#define FEW_LISTS 16

typedef struct Part {
    RtBox box;
    RtCsgTerm term;           /* never a move */
    uint32_t right;           /* operation: its right operand */
    uint32_t solid;           /* leaf: in the forest's set */
    uint32_t crossings, room; /* most in its list, and on the stack while it is computed; saturates */
    uint8_t lists;            /* most on the stack while it is computed */
    bool right_first;
} Part;

/* A term still to be written out. */
typedef struct Use {
    RtCsgTerm term;
    uint32_t move;     /* index, or NONE */
    uint32_t right_of; /* part, or NONE */
    bool subtracted;
} Use;

/* An operation whose instructions are partly written. */
typedef struct Frame {
    uint32_t part;
    uint32_t operands;   /* done */
    uint32_t test, skip; /* instructions that jump to its end, or NONE */
    RtBox box;           /* its clipped box; before the first operand, that of the operation above */
    double tested_area;  /* half the area of the nearest tested box above */
} Frame;

typedef struct Compiler {
    RtCsgForest *forest;
    const RtCsgBuilder *builder;
    uint32_t first; /* instruction */
    uint32_t part_count;
    Part *parts;
    uint32_t move_count, move_capacity;
    RtTransform *moves;
    uint32_t use_count, use_capacity;
    Use *uses;
    uint32_t frame_count, frame_capacity;
    Frame *frames;
    RtError *error;
} Compiler;

/* ---- writing out ---- */

static RtStatus push_use(Compiler *p, Use use) {
    return rt_append(&p->uses, &p->use_count, &p->use_capacity, &use, sizeof use, p->error);
}

/* Composes `move` with the move *index (or NONE); *index becomes the result. */
static RtStatus add_move(Compiler *p, const RtTransform *move, uint32_t *index) {
    const RtTransform whole = *index == NONE ? *move : rt_transform_compose(move, &p->moves[*index]);
    *index = p->move_count;
    return rt_append(&p->moves, &p->move_count, &p->move_capacity, &whole, sizeof whole, p->error);
}

static RtStatus write_part(Compiler *p, Use use) {
    const RtCsgNode *node = &p->builder->nodes[use.term];
    uint32_t at = p->part_count++;
    Part *part = &p->parts[at];
    part->term = use.term;
    if (use.right_of != NONE) p->parts[use.right_of].right = at;
    if (node->kind == RT_CSG_SOLID) {
        const RtTransform *move = use.move == NONE ? NULL : &p->moves[use.move];
        RtSolidSet *set = &p->forest->set;
        RT_TRY(rt_solid_add_moved(set, &p->builder->set, node->left, move, &part->solid, p->error));
        set->solids[part->solid].subtracted = use.subtracted;
        return RT_OK;
    }
    bool turned = use.subtracted != (node->op == RT_CSG_DIFFERENCE);
    RT_TRY(push_use(p, (Use){node->right, use.move, at, turned}));
    return push_use(p, (Use){node->left, use.move, NONE, use.subtracted});
}

static RtStatus write_out(Compiler *p, RtCsgTerm root) {
    RT_TRY(push_use(p, (Use){root, NONE, NONE, false}));
    while (p->use_count > 0) {
        Use use = p->uses[--p->use_count];
        const RtCsgNode *node = &p->builder->nodes[use.term];
        if (node->kind == RT_CSG_MOVE) {
            RT_TRY(add_move(p, &node->move, &use.move));
            use.term = node->left;
        }
        RT_TRY(write_part(p, use));
    }
    return RT_OK;
}

/* ---- measuring ---- */

static uint32_t saturating_sum(uint32_t a, uint32_t b) {
    return a > UINT32_MAX - b ? UINT32_MAX : a + b;
}

static uint32_t max_of(uint32_t a, uint32_t b) {
    return a > b ? a : b;
}

static uint32_t lists_in_order(const Part *first, const Part *second) {
    return max_of(first->lists, second->lists + 1u);
}

/* Which operand comes first (csg.h)? */
static bool is_right_first(const Compiler *p, RtCsgOp op, const Part *left, const Part *right) {
    const RtCsgNode *nodes = p->builder->nodes;
    bool smaller = nodes[right->term].size < nodes[left->term].size;
    bool right_spares = op == RT_CSG_INTERSECTION && smaller;
    uint32_t lists = right_spares ? lists_in_order(right, left) : lists_in_order(left, right);
    if (op != RT_CSG_UNION && lists <= FEW_LISTS) return right_spares;
    return right->lists > left->lists;
}

static void measure_operation(const Compiler *p, Part *part) {
    RtCsgOp op = p->builder->nodes[part->term].op;
    const Part *left = part + 1, *right = &p->parts[part->right];
    part->box = op == RT_CSG_UNION          ? rt_box_union(left->box, right->box)
                : op == RT_CSG_INTERSECTION ? rt_box_common(left->box, right->box)
                                            : left->box;
    part->right_first = is_right_first(p, op, left, right);
    const Part *first = part->right_first ? right : left, *second = part->right_first ? left : right;
    part->lists = (uint8_t)lists_in_order(first, second);
    part->crossings = saturating_sum(left->crossings, right->crossings);
    /* While two lists are merged, both and the result are there. */
    part->room = max_of(first->room, saturating_sum(first->crossings, second->room));
    part->room = max_of(part->room, saturating_sum(part->crossings, part->crossings));
}

static void measure(const Compiler *p) {
    for (uint32_t i = p->part_count; i-- > 0;) {
        Part *part = &p->parts[i];
        if (p->builder->nodes[part->term].kind == RT_CSG_COMBINE) {
            measure_operation(p, part);
            continue;
        }
        const RtSolid *solid = &p->forest->set.solids[part->solid];
        part->box = solid->box;
        part->lists = 1;
        part->crossings = part->room = rt_solid_most_crossings(solid);
    }
}

/* ---- instructions ---- */

static RtStatus emit(Compiler *p, RtCsgInstruction instruction, uint32_t *at) {
    RtCsgForest *f = p->forest;
    *at = f->instruction_count;
    return rt_append(&f->instructions, &f->instruction_count, &f->instruction_capacity, &instruction,
                     sizeof instruction, p->error);
}

/* `box`: that of the operation above. */
static RtStatus push_frame(Compiler *p, uint32_t part, RtBox box, double tested_area) {
    const Frame frame = {part, 0, NONE, NONE, box, tested_area};
    return rt_append(&p->frames, &p->frame_count, &p->frame_capacity, &frame, sizeof frame, p->error);
}

static RtStatus emit_test(Compiler *p, Frame *frame) {
    RtCsgForest *f = p->forest;
    double area = rt_box_half_area(frame->box);
    double spared = (1 - area / frame->tested_area) * p->builder->nodes[p->parts[frame->part].term].size;
    if (!(spared > 1)) return RT_OK;
    RtCsgInstruction test = {.code = RT_CSG_TEST, .operand = f->box_count};
    RT_TRY(rt_append(&f->boxes, &f->box_count, &f->box_capacity, &frame->box, sizeof(RtBox), p->error));
    frame->tested_area = area;
    return emit(p, test, &frame->test);
}

/* Emits the instructions before, between or after the operands of an operation. */
static RtStatus advance(Compiler *p, bool extents) {
    Frame *frame = &p->frames[p->frame_count - 1];
    const Part *part = &p->parts[frame->part];
    const RtCsgNode *node = &p->builder->nodes[part->term];
    uint32_t left = frame->part + 1, at;
    if (node->kind == RT_CSG_SOLID) {
        p->frame_count--;
        return emit(p, (RtCsgInstruction){.code = RT_CSG_PUSH, .operand = part->solid}, &at);
    }
    switch (frame->operands++) {
    case 0:
        frame->box = rt_box_common(frame->box, part->box);
        if (extents) RT_TRY(emit_test(p, frame));
        return push_frame(p, part->right_first ? part->right : left, frame->box, frame->tested_area);
    case 1:
        if (node->op == RT_CSG_INTERSECTION || (node->op == RT_CSG_DIFFERENCE && !part->right_first))
            RT_TRY(emit(p, (RtCsgInstruction){.code = RT_CSG_SKIP_IF_EMPTY}, &frame->skip));
        return push_frame(p, part->right_first ? left : part->right, frame->box, frame->tested_area);
    default: break;
    }
    RtCsgInstruction apply = {RT_CSG_APPLY, part->right_first, (uint32_t)node->op, 0};
    RT_TRY(emit(p, apply, &at));
    RtCsgInstruction *instructions = p->forest->instructions;
    if (frame->test != NONE) instructions[frame->test].to = at + 1 - p->first;
    if (frame->skip != NONE) instructions[frame->skip].to = at + 1 - p->first;
    p->frame_count--;
    return RT_OK;
}

static RtStatus write_program(Compiler *p, bool extents) {
    RtBox box = p->parts[0].box;
    RT_TRY(push_frame(p, 0, box, rt_box_half_area(box)));
    while (p->frame_count > 0) RT_TRY(advance(p, extents));
    return RT_OK;
}

/* ---- trees ---- */

/* The box around the finite sides of the boxes of solids[0..count). */
static RtBox reach_of(const RtSolid *solids, uint32_t count) {
    RtBox reach = RT_EMPTY_BOX;
    for (uint32_t i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++) {
            const float sides[2] = {solids[i].box.lo.at[a], solids[i].box.hi.at[a]};
            for (int s = 0; s < 2; s++) {
                if (!isfinite(sides[s])) continue;
                reach.lo.at[a] = rt_minf(reach.lo.at[a], sides[s]);
                reach.hi.at[a] = rt_maxf(reach.hi.at[a], sides[s]);
            }
        }
    }
    for (int a = 0; a < 3; a++) {
        if (reach.lo.at[a] > reach.hi.at[a]) reach.lo.at[a] = reach.hi.at[a] = 0;
    }
    return reach;
}

/* No inside fits into such a box. */
static bool is_flat(RtBox box) {
    return !(box.lo.x < box.hi.x && box.lo.y < box.hi.y && box.lo.z < box.hi.z);
}

static RtStatus check_end(RtBox box, RtError *error) {
    if (rt_finite(box.lo) && rt_finite(box.hi)) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "the tree is unbounded, as far as the boxes of its solids show: intersect it with a "
                   "bounded solid, or combine its half-spaces into one polyhedron");
}

static RtStatus compile(Compiler *p, RtCsgTerm root, bool extents, RtCsg *out) {
    RtCsgForest *f = p->forest;
    RtCsg tree = {.first = f->instruction_count, .first_solid = f->set.solid_count, .extents = extents};
    p->first = tree.first;
    uint64_t most_parts = 2 * (uint64_t)p->builder->nodes[root].size - 1;
    p->parts = rt_alloc(most_parts, sizeof(Part));
    if (!p->parts) return rt_fail_memory(p->error, "a CSG tree", most_parts * sizeof(Part));
    RT_TRY(write_out(p, root));
    assert(p->part_count == most_parts);
    measure(p);
    assert(p->parts[0].lists <= RT_CSG_MAX_LISTS);

    tree.solid_count = f->set.solid_count - tree.first_solid;
    tree.most_crossings = p->parts[0].room;
    tree.reach = reach_of(f->set.solids + tree.first_solid, tree.solid_count);
    tree.box = p->parts[0].box;
    if (is_flat(tree.box)) tree.box.lo = tree.box.hi = rt_box_center(tree.reach);
    RT_TRY(check_end(tree.box, p->error));
    RT_TRY(write_program(p, extents));
    tree.count = f->instruction_count - tree.first;
    tree.ball = rt_csg_ball(f, &tree);
    *out = tree;
    return RT_OK;
}

RtStatus rt_csg_compile(RtCsgForest *forest, const RtCsgBuilder *builder, RtCsgTerm root, bool extents,
                        RtCsg *out, RtError *error) {
    assert(root < builder->node_count);
    const RtCsgForest before = *forest;
    Compiler p = {.forest = forest, .builder = builder, .error = error};
    RtStatus status = compile(&p, root, extents, out);
    if (status != RT_OK) {
        forest->set.solid_count = before.set.solid_count;
        forest->set.plane_count = before.set.plane_count;
        forest->set.triangle_count = before.set.triangle_count;
        forest->instruction_count = before.instruction_count;
        forest->box_count = before.box_count;
    }
    rt_free(p.parts);
    rt_free(p.moves);
    rt_free(p.uses);
    rt_free(p.frames);
    return status;
}

RtStatus rt_csg_recover(RtCsgBuilder *builder, const RtCsgForest *from, const RtCsg *tree, RtCsgTerm *root,
                        RtError *error) {
    RtCsgTerm terms[RT_CSG_MAX_LISTS];
    uint32_t count = 0, solid;
    for (uint32_t i = 0; i < tree->count; i++) {
        RtCsgInstruction instruction = from->instructions[tree->first + i];
        if (instruction.code == RT_CSG_PUSH) {
            RT_TRY(rt_solid_add_moved(&builder->set, &from->set, instruction.operand, NULL, &solid, error));
            uint32_t material = from->set.solids[instruction.operand].material;
            RT_TRY(rt_csg_solid(builder, solid, material, &terms[count], error));
            count++;
        } else if (instruction.code == RT_CSG_APPLY) {
            count--;
            RtCsgTerm lower = terms[count - 1], top = terms[count];
            RT_TRY(rt_csg_combine(builder, (RtCsgOp)instruction.operand, instruction.reversed ? top : lower,
                                  instruction.reversed ? lower : top, &terms[count - 1], error));
        }
    }
    assert(count == 1);
    *root = terms[0];
    return RT_OK;
}

/* ---- forests ---- */

void rt_csg_forest_clear(RtCsgForest *forest) {
    rt_solid_set_clear(&forest->set);
    rt_free(forest->instructions);
    rt_free(forest->boxes);
    *forest = (RtCsgForest){0};
}

uint64_t rt_csg_forest_bytes(const RtCsgForest *forest) {
    return rt_solid_set_bytes(&forest->set) +
           (uint64_t)forest->instruction_capacity * sizeof(RtCsgInstruction) +
           (uint64_t)forest->box_capacity * sizeof(RtBox);
}
