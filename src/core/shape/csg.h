/* SPDX-License-Identifier: Apache-2.0 */
/* CSG trees (Requicha 1977; ray casting: Roth 1982, "Ray Casting for Modeling Solids", CGIP 18): solids
 * joined by union, intersection and difference. A tree is one object.
 *
 * A ray R meets a tree by R n (A op B) = (R n A) op (R n B): the spans of the solids are merged. Every
 * crossing carries its face, so normal and material of a hit are those of the solid there; on the right of a
 * difference, faces are turned inside out.
 *
 * The merging rule. All crossings at one float32 t form one place (see solid.h). The crossings of the tree
 * are exactly the places where its inside begins or ends. So coincident faces of A and B leave neither a skin
 * (A - A is empty, A | A is A) nor a gap, touching solids join without a wall, and parts without thickness
 * vanish. If both operands have a crossing in the direction of the result, the left one provides the face. A
 * ray that starts inside hits the far side.
 *
 * Layout. A tree is a program for a stack machine whose values are lists of crossings. The operand that can
 * make the other one unnecessary comes first (the left side of a difference, the smaller operand of an
 * intersection) while few lists are on the stack; otherwise the one that needs more lists (Sethi & Ullman
 * 1970, "The Generation of Optimal Code for Arithmetic Expressions", JACM 17): never more than
 * RT_CSG_MAX_LISTS.
 *
 * Extents. The box of a node is clipped to those of its ancestors. A node whose box the ray misses, or meets
 * only outside [tmin, tmax], is skipped. That loses no hit, bit for bit: all boxes of a tree are tested with
 * one thick ray, crossings are clamped to the interval of their own solid's box, and the interval of an
 * intersection of boxes is the intersection of their intervals (core/base/ray.h). Trees are compiled with or
 * without these tests. A node is tested where, by the ratio of areas, a test saves more than one solid per
 * line that meets the nearest tested box above. */
#ifndef RT_SHAPE_CSG_H
#define RT_SHAPE_CSG_H

#include "core/base/tally.h"
#include "core/shape/solid.h"

typedef enum RtCsgOp { RT_CSG_UNION, RT_CSG_INTERSECTION, RT_CSG_DIFFERENCE } RtCsgOp;

/* Is a point with these insides inside the result? */
static inline bool rt_csg_joined(RtCsgOp op, bool in_left, bool in_right) {
    if (op == RT_CSG_UNION) return in_left || in_right;
    return in_left && in_right == (op == RT_CSG_INTERSECTION);
}

/* ---- making a tree ---- */

/* A part of a tree under construction: a solid, or an operation on other terms. It may be used any number of
 * times. */
typedef uint32_t RtCsgTerm;

typedef struct RtCsgNode {
    enum { RT_CSG_SOLID, RT_CSG_MOVE, RT_CSG_COMBINE } kind;
    RtCsgOp op;
    RtCsgTerm left, right; /* RT_CSG_SOLID: `left` is an index in set.solids; RT_CSG_MOVE: `left` is the
                            * moved term */
    RtTransform move;
    uint32_t size; /* solids in the tree below, one per use */
} RtCsgNode;

/* Owns its arrays; a zeroed struct is empty. */
typedef struct RtCsgBuilder {
    RtSolidSet set;
    uint32_t node_count, node_capacity;
    RtCsgNode *nodes;
} RtCsgBuilder;

void rt_csg_builder_clear(RtCsgBuilder *builder);

/* The most solids of a tree, one per use: reused terms can make a short text an enormous tree. */
#define RT_CSG_MAX_SOLIDS (UINT32_C(1) << 24)

/* A term for a solid just added to builder->set, with its material. */
RtStatus rt_csg_solid(RtCsgBuilder *builder, uint32_t solid, uint32_t material, RtCsgTerm *out,
                      RtError *error);
/* Rejects a tree of more than RT_CSG_MAX_SOLIDS. */
RtStatus rt_csg_combine(RtCsgBuilder *builder, RtCsgOp op, RtCsgTerm left, RtCsgTerm right, RtCsgTerm *out,
                        RtError *error);
/* A moved copy of `term`, which itself does not change. */
RtStatus rt_csg_move(RtCsgBuilder *builder, RtCsgTerm term, const RtTransform *move, RtCsgTerm *out,
                     RtError *error);

/* ---- compiled trees ---- */

typedef enum RtCsgOpcode {
    RT_CSG_TEST, /* a node begins: if the ray misses boxes[operand], push an empty list and jump to `to` */
    RT_CSG_PUSH, /* push the crossings of solid `operand` */
    RT_CSG_SKIP_IF_EMPTY, /* if the top list is empty, jump to `to`: the result is empty in any case */
    RT_CSG_APPLY,         /* pop two lists, push the result of RtCsgOp `operand` */
} RtCsgOpcode;

typedef struct RtCsgInstruction {
    uint8_t code;  /* RtCsgOpcode */
    bool reversed; /* RT_CSG_APPLY: the top list is the left operand, not the lower one */
    uint32_t operand;
    uint32_t to; /* relative to the tree's first instruction */
} RtCsgInstruction;

/* The most lists on the stack: 16 with the operand order that saves tests, and one more each time the tree
 * doubles. */
#define RT_CSG_MAX_LISTS 40

/* One object. */
typedef struct RtCsg {
    uint32_t first, count;             /* instructions */
    uint32_t first_solid, solid_count; /* in the set, where a tree's solids are contiguous */
    uint32_t most_crossings;           /* crossings that a ray may need over all lists on the stack;
                                        * saturates at UINT32_MAX */
    bool extents;                      /* compiled with tests of inner nodes */
    RtBox box;   /* of the result; a point, which nothing hits, if the result is certainly empty */
    RtBall ball; /* around the result: rt_csg_ball */
    RtBox reach; /* around the finite sides of all solids' boxes: sets the thickness */
} RtCsg;

/* All compiled trees of a geometry. Owns its arrays; a zeroed struct is empty. */
typedef struct RtCsgForest {
    RtSolidSet set;
    uint32_t instruction_count, instruction_capacity;
    RtCsgInstruction *instructions;
    uint32_t box_count, box_capacity;
    RtBox *boxes; /* of inner nodes that are tested */
} RtCsgForest;

void rt_csg_forest_clear(RtCsgForest *forest);
uint64_t rt_csg_forest_bytes(const RtCsgForest *forest);

/* Compiles the tree below `root` into *out and appends its parts to `forest`: each use of a solid becomes a
 * moved copy, in the order of the text. Rejects an unbounded tree (a half-space that nothing limits), and
 * then changes nothing. */
RtStatus rt_csg_compile(RtCsgForest *forest, const RtCsgBuilder *builder, RtCsgTerm root, bool extents,
                        RtCsg *out, RtError *error);

/* Adds the terms of a compiled tree to an empty builder: compiling *root makes the same tree. */
RtStatus rt_csg_recover(RtCsgBuilder *builder, const RtCsgForest *from, const RtCsg *tree, RtCsgTerm *root,
                        RtError *error);

/* ---- rays ---- */

/* The memory of hit functions (rt_hit_memory_alloc). */
typedef struct RtHitMemory {
    struct RtQuery *parts;  /* a query in each part of the scene, for instances (accel/instance.c) */
    RtCrossing crossings[]; /* of a ray with the largest CSG tree */
} RtHitMemory;

/* The first crossing of the tree with t in [tmin, tmax] and within its box; false if there is none.
 * `tally` may be NULL: csg_tests counts the solids tested, extent_tests their boxes and those of inner
 * nodes. The ray's RtHitMemory must hold tree->most_crossings crossings: nothing is allocated. */
bool rt_csg_hit(const RtCsgForest *forest, const RtCsg *tree, const RtPreparedRay *ray, float *t,
                RtTally *tally);

/* The surface that the ray meets at `t`, one of its hits: unit normal out of the tree, and the solid. For
 * any other `t`, the nearest place on the ray's line; if there is none, the normal is 0 and the solid the
 * tree's first. Memory as above. */
typedef struct RtCsgFacet {
    RtVec3d normal;
    uint32_t solid; /* index in the set */
} RtCsgFacet;
RtCsgFacet rt_csg_facet(const RtCsgForest *forest, const RtCsg *tree, const RtPreparedRay *ray, float t);

/* Extents, as tight as the operations allow: an intersection reaches as far as the lesser of its operands,
 * a difference as far as its left side. The support never exceeds that of the box, and equals it where
 * disjoint solids leave nothing. */
double rt_csg_support(const RtCsgForest *forest, const RtCsg *tree, RtVec3d direction);
RtBall rt_csg_ball(const RtCsgForest *forest, const RtCsg *tree);

#endif
