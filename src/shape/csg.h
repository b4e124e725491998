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
 * The heavier operand of each operation comes first (Sethi & Ullman 1970), so that at most log2(solids) + 1
 * lists are on the stack at once.
 *
 * Extents. A union's box is that about both, an intersection's what both have in common, a difference's that
 * of its left side. A node whose box the ray misses, or meets outside [tmin, tmax] only, is empty for the ray
 * and skipped whole. That loses nothing, bit for bit: all boxes of a tree are tested on one thick ray,
 * crossings are clamped to the interval of their own solid's box, and both are monotone in the planes of the
 * boxes (base/ray.h). Trees are made with or without the tests of inner nodes; the answers are the same. */
#ifndef RT_SHAPE_CSG_H
#define RT_SHAPE_CSG_H

#include "base/tally.h"
#include "shape/solid.h"

typedef enum RtCsgOp { RT_CSG_UNION, RT_CSG_INTERSECTION, RT_CSG_DIFFERENCE } RtCsgOp;

/* ---- making a tree ---- */

/* A part of a tree under construction: a solid, or an operation on two others. A term may be used any number
 * of times, in one tree or several. */
typedef uint32_t RtCsgTerm;

typedef struct RtCsgNode {
    enum { RT_CSG_SOLID, RT_CSG_MOVE, RT_CSG_COMBINE } kind;
    RtCsgOp op;
    RtCsgTerm left, right; /* RT_CSG_SOLID: left is the index in `solids`; RT_CSG_MOVE: left */
    RtTransform move;
    uint64_t size; /* solids in the tree below, uses counted */
} RtCsgNode;

/* Owns its arrays; a zeroed struct is empty. */
typedef struct RtCsgBuilder {
    RtSolidSet set;
    uint32_t node_count, node_capacity;
    RtCsgNode *nodes;
} RtCsgBuilder;

void rt_csg_builder_clear(RtCsgBuilder *builder);

/* A solid just added to builder->set. */
RtStatus rt_csg_solid(RtCsgBuilder *builder, uint32_t solid, uint32_t material, RtCsgTerm *out,
                      RtError *error);
RtStatus rt_csg_combine(RtCsgBuilder *builder, RtCsgOp op, RtCsgTerm left, RtCsgTerm right, RtCsgTerm *out,
                        RtError *error);
/* `term` moved as a whole; what the term itself is stays where it was. */
RtStatus rt_csg_move(RtCsgBuilder *builder, RtCsgTerm term, const RtTransform *move, RtCsgTerm *out,
                     RtError *error);

/* A tree of more solids than this is refused: terms used again and again can make a short text an endless
 * tree. */
#define RT_CSG_MAX_SOLIDS (UINT32_C(1) << 24)

/* ---- trees that stand ---- */

typedef enum RtCsgOpcode {
    RT_CSG_TEST, /* a node begins: if the ray misses boxes[operand], push an empty list, go to `to` */
    RT_CSG_PUSH, /* push the crossings of solid `operand` */
    RT_CSG_SKIP_IF_EMPTY, /* if the top list is empty, go to `to`: the result is empty whatever comes */
    RT_CSG_UNITE,         /* pop two lists, push their union, ... */
    RT_CSG_INTERSECT,
    RT_CSG_SUBTRACT,          /* the lower list minus the top one */
    RT_CSG_SUBTRACT_REVERSED, /* the top list minus the lower one */
} RtCsgOpcode;

typedef struct RtCsgInstruction {
    uint8_t code;     /* RtCsgOpcode */
    uint8_t reversed; /* the top list is the left operand: it names the face */
    uint32_t operand;
    uint32_t to; /* counted from the tree's first instruction */
} RtCsgInstruction;

/* One object. */
typedef struct RtCsg {
    uint32_t first, count;             /* instructions */
    uint32_t first_solid, solid_count; /* in the set: a tree's solids lie together */
    uint32_t most_crossings; /* room that a ray may need, in crossings, over all lists on the stack */
    bool extents;            /* made with tests of inner nodes */
    RtBox box;               /* of the result; a point where the result is certainly empty */
    RtBox reach;             /* about all bounded solids: sets the thickness */
} RtCsg;

/* All trees of a geometry. Owns its arrays; a zeroed struct is empty. */
typedef struct RtCsgForest {
    RtSolidSet set;
    uint32_t instruction_count, instruction_capacity;
    RtCsgInstruction *instructions;
    uint32_t box_count, box_capacity;
    RtBox *boxes; /* of inner nodes */
} RtCsgForest;

void rt_csg_forest_clear(RtCsgForest *forest);
uint64_t rt_csg_forest_bytes(const RtCsgForest *forest);

/* Fills *out with the tree below `root`, its parts appended to `forest`. Refuses a tree without end (a
 * half-space that nothing bounds) and one of more than RT_CSG_MAX_SOLIDS solids, and then changes nothing. */
RtStatus rt_csg_plant(RtCsgForest *forest, const RtCsgBuilder *builder, RtCsgTerm root, bool extents,
                      RtCsg *out, RtError *error);

/* The same for a tree of another forest (or this one), moved by `move`, which may be NULL. */
RtStatus rt_csg_transplant(RtCsgForest *forest, const RtCsgForest *from, const RtCsg *tree,
                           const RtTransform *move, RtCsg *out, RtError *error);

/* ---- rays ---- */

/* The first crossing of the tree with t in [tmin, tmax] and within its box; false if there is none.
 * `tally` may be NULL: csg_tests counts the solids tested, extent_tests their boxes and those of inner nodes.
 * Where memory for a very long list cannot be had the ray misses, and rt_csg_ran_out_of_memory says so from
 * then on. */
bool rt_csg_hit(const RtCsgForest *forest, const RtCsg *tree, const RtPreparedRay *ray, float *t,
                RtTally *tally);

/* Has any rt_csg_hit of this process lacked memory? To be asked when frames and measurements are done. */
bool rt_csg_ran_out_of_memory(void);

/* What the ray meets at `t`, one of its hits: unit normal out of the tree, and the solid. */
typedef struct RtCsgFacet {
    RtVec3d normal;
    uint32_t solid; /* index in the set */
} RtCsgFacet;
RtCsgFacet rt_csg_facet(const RtCsgForest *forest, const RtCsg *tree, const RtPreparedRay *ray, float t);

/* Extents, as tight as the operations allow: an intersection reaches as far as the lesser of its operands, a
 * difference as its left side. */
double rt_csg_support(const RtCsgForest *forest, const RtCsg *tree, RtVec3d direction);
RtBall rt_csg_ball(const RtCsgForest *forest, const RtCsg *tree);

#endif
