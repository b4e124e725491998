/* SPDX-License-Identifier: Apache-2.0 */
/* Formulas of CSG trees, as they stand in scene files: names joined by operators,
 *
 *   a | b    union            a & b    intersection            a - b    difference
 *
 * and parentheses. & binds before | and -, which are of one rank and taken from the left, as * does before +
 * and -: `a | b & c - d` is `(a | (b & c)) - d`. A name is a letter or '_' and then letters, digits and '_'.
 *
 * Read by two stacks (Dijkstra 1961, the shunting yard), so formulas nest as deeply as memory allows. */
#ifndef RT_SCENE_FORMULA_H
#define RT_SCENE_FORMULA_H

#include "core/shape/csg.h"

/* Gives the term that `name` stands for, or fails with a message without a place. */
typedef RtStatus RtFormulaLookup(void *context, const char *name, RtCsgTerm *term, RtError *error);

/* The longest name in a formula, with its '\0'. */
#define RT_FORMULA_MAX_NAME 64

/* Can `name` stand in a formula? */
bool rt_formula_is_name(const char *name);

/* Adds what `formula` says to `builder` and gives its term. Complaints say at which character of the
 * formula. */
RtStatus rt_formula_read(const char *formula, RtCsgBuilder *builder, RtFormulaLookup *lookup, void *context,
                         RtCsgTerm *term, RtError *error);

/* The formula of a tree, in which solid i of the forest's set is called s<i>. *formula is owned by the
 * caller: rt_free. Read again with the same solids it gives the same tree. */
RtStatus rt_formula_write(const RtCsgForest *forest, const RtCsg *tree, char **formula, RtError *error);

#endif
