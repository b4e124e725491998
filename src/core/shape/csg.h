/* SPDX-License-Identifier: Apache-2.0 */
/* CSG trees (Requicha 1977; ray casting: Roth 1982, "Ray Casting for Modeling Solids", CGIP 18): solids
 * joined by union, intersection and difference. A tree is one object.
 *
 * A ray R meets a tree by in-order traversal, R n (A op B) = (R n A) op (R n B): the spans of the solids are
 * merged span by span. Every crossing carries the face that it lies on, so that normal and material of a hit
 * are those of the solid that was met; on the right of a difference surfaces are turned inside out.
 *
 * The one rule. On an open interval of t between places (crossings at one float32 t, see solid.h) a point is
 * inside or outside of each solid, and so of the tree. A place where the inside of the tree begins or ends is
 * a crossing of the tree; there is no other. So coincident faces of A and B neither leave a skin (A - A is
 * empty, A | A is A) nor a gap, touching solids are joined without a wall, and what has no thickness is not
 * there. Where both operands have a crossing at that place that goes the result's way, the left one names the
 * face.
 *
 * Hits are all places where the line enters or leaves: a ray that starts inside meets the far side.
 *
 * Layout. A tree is a program for a machine with a stack of lists of crossings: no recursion, at any depth.
 * First comes the operand that may spare the other one, the left side of a difference and the smaller operand
 * of an intersection, as long as few lists are on the stack; else the one that needs more of them (Sethi &
 * Ullman 1970, "The Generation of Optimal Code for Arithmetic Expressions", JACM 17). So there are never more
 * than RT_CSG_MAX_LISTS.
 *
 * Extents. A union's box is that about both, an intersection's what both have in common, a difference's that
 * of its left side. A node matters within the boxes of the nodes around it only: its own is cut down to what
 * it has in common with them. A node whose box the ray misses, or meets outside [tmin, tmax] only, is empty
 * for the ray and skipped whole. That loses nothing, bit for bit: all boxes of a tree are tested on one thick
 * ray, crossings are clamped to the interval of their own solid's box, so a node has none outside of its own,
 * and the interval of what boxes have in common is what their intervals have in common (core/base/ray.h).
 * Trees are made with or without the tests of inner nodes; the answers are the same. Tests stand where they
 * spare more than one solid to the lines that meet the nearest tested box around, by the ratio of areas. */
#ifndef RT_SHAPE_CSG_H
#define RT_SHAPE_CSG_H

#include "core/base/tally.h"
#include "core/shape/solid.h"

typedef enum RtCsgOp { RT_CSG_UNION, RT_CSG_INTERSECTION, RT_CSG_DIFFERENCE } RtCsgOp;

/* ---- making a tree ---- */

/* A part of a tree under construction: a solid, or an operation on two others. A term may be used any number
 * of times, in one tree or several. */
typedef uint32_t RtCsgTerm;

typedef struct RtCsgNode {
    enum { RT_CSG_SOLID, RT_CSG_MOVE, RT_CSG_COMBINE } kind;
    RtCsgOp op;
    RtCsgTerm left, right; /* RT_CSG_SOLID: left is the index in set.solids; RT_CSG_MOVE: left */
    RtTransform move;
    uint32_t size; /* solids in the tree below, uses counted */
} RtCsgNode;

/* Owns its arrays; a zeroed struct is empty. */
typedef struct RtCsgBuilder {
    RtSolidSet set;
    uint32_t node_count, node_capacity;
    RtCsgNode *nodes;
} RtCsgBuilder;

void rt_csg_builder_clear(RtCsgBuilder *builder);

/* A tree of more solids than this is refused: terms used again and again can make a short text an endless
 * tree. */
#define RT_CSG_MAX_SOLIDS (UINT32_C(1) << 24)

/* A solid just added to builder->set, and its material. */
RtStatus rt_csg_solid(RtCsgBuilder *builder, uint32_t solid, uint32_t material, RtCsgTerm *out,
                      RtError *error);
/* Refuses a tree of more than RT_CSG_MAX_SOLIDS solids, uses counted. */
RtStatus rt_csg_combine(RtCsgBuilder *builder, RtCsgOp op, RtCsgTerm left, RtCsgTerm right, RtCsgTerm *out,
                        RtError *error);
/* `term` moved as a whole; what the term itself is stays where it was. */
RtStatus rt_csg_move(RtCsgBuilder *builder, RtCsgTerm term, const RtTransform *move, RtCsgTerm *out,
                     RtError *error);

/* ---- trees that stand ---- */

typedef enum RtCsgOpcode {
    RT_CSG_TEST, /* a node begins: if the ray misses boxes[operand], push an empty list, go to `to` */
    RT_CSG_PUSH, /* push the crossings of solid `operand` */
    RT_CSG_SKIP_IF_EMPTY, /* if the top list is empty, go to `to`: the result is empty whatever comes */
    RT_CSG_APPLY,         /* pop two lists, push what RtCsgOp `operand` makes of them */
} RtCsgOpcode;

typedef struct RtCsgInstruction {
    uint8_t code;  /* RtCsgOpcode */
    bool reversed; /* RT_CSG_APPLY: the top list is the left operand, not the lower one */
    uint32_t operand;
    uint32_t to; /* counted from the tree's first instruction */
} RtCsgInstruction;

/* The most lists that are ever on the stack: 16 where operands are ordered to be spared, and one more each
 * time the tree doubles. */
#define RT_CSG_MAX_LISTS 40

/* One object. */
typedef struct RtCsg {
    uint32_t first, count;             /* instructions */
    uint32_t first_solid, solid_count; /* in the set: a tree's solids lie together */
    uint32_t most_crossings;           /* room that a ray may need, in crossings, over all lists on the stack;
                                          UINT32_MAX stands for more, too */
    bool extents;                      /* made with tests of inner nodes */
    RtBox box;   /* of the result; a point where the result is certainly empty; then nothing hits it */
    RtBall ball; /* about the result: rt_csg_ball */
    RtBox reach; /* about the boxes of all solids, infinite sides left out: sets the thickness */
} RtCsg;

/* All trees of a geometry. Owns its arrays; a zeroed struct is empty. */
typedef struct RtCsgForest {
    RtSolidSet set;
    uint32_t instruction_count, instruction_capacity;
    RtCsgInstruction *instructions;
    uint32_t box_count, box_capacity;
    RtBox *boxes; /* of inner nodes that are tested */
} RtCsgForest;

void rt_csg_forest_clear(RtCsgForest *forest);
uint64_t rt_csg_forest_bytes(const RtCsgForest *forest);

/* Fills *out with the tree below `root`, its parts appended to `forest`: each use of a solid becomes a solid
 * of its own, in the order of the text, moved to where it is. Takes memory in proportion to their number.
 * Refuses a tree without end (a half-space that nothing bounds), and then changes nothing. */
RtStatus rt_csg_compile(RtCsgForest *forest, const RtCsgBuilder *builder, RtCsgTerm root, bool extents,
                        RtCsg *out, RtError *error);

/* The same for a tree of another forest (or this one), moved by `move`, which may be NULL. */
RtStatus rt_csg_copy(RtCsgForest *forest, const RtCsgForest *from, const RtCsg *tree, const RtTransform *move,
                     RtCsg *out, RtError *error);

/* ---- rays ---- */

/* The first crossing of the tree with t in [tmin, tmax] and within its box; false if there is none.
 * `tally` may be NULL: csg_tests counts the solids tested, extent_tests their boxes and those of inner nodes.
 * ray->room has tree->most_crossings crossings at least: nothing is allocated. */
bool rt_csg_hit(const RtCsgForest *forest, const RtCsg *tree, const RtPreparedRay *ray, float *t,
                RtTally *tally);

/* What the ray, with as much room, meets at `t`, one of its hits: unit normal out of the tree, and the solid.
 * At a `t` that is none it is the nearest place of the ray's line; where there is no such place at all the
 * normal is 0, the solid the tree's first. */
typedef struct RtCsgFacet {
    RtVec3d normal;
    uint32_t solid; /* index in the set */
} RtCsgFacet;
RtCsgFacet rt_csg_facet(const RtCsgForest *forest, const RtCsg *tree, const RtPreparedRay *ray, float t);

/* Extents, as tight as the operations allow: an intersection reaches as far as the lesser of its operands, a
 * difference as its left side. Never beyond the box, nor short of it where solids that do not meet leave
 * nothing. */
double rt_csg_support(const RtCsgForest *forest, const RtCsg *tree, RtVec3d direction);
RtBall rt_csg_ball(const RtCsgForest *forest, const RtCsg *tree); /* found anew; tree->ball is at hand */

#endif
