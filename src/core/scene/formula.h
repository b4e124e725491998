/* SPDX-License-Identifier: Apache-2.0 */
/* Formulas of CSG trees in scene files: names joined by operators,
 *
 *   a | b    union            a & b    intersection            a - b    difference
 *
 * and parentheses. & binds tighter than | and -, which have equal precedence and are left-associative, as *
 * and +, - do: `a | b & c - d` is `(a | (b & c)) - d`. A name is a letter or '_', then letters, digits and
 * '_'.
 *
 * Parsed with two stacks (Dijkstra 1961, the shunting yard), so formulas may nest as deeply as memory
 * allows. */
#ifndef RT_SCENE_FORMULA_H
#define RT_SCENE_FORMULA_H

#include "core/shape/csg.h"

/* Returns the term named `name`, or fails with a message without a position. */
typedef RtStatus RtFormulaLookup(void *context, const char *name, RtCsgTerm *term, RtError *error);

/* Size of the longest name in a formula, with its '\0'. */
#define RT_FORMULA_MAX_NAME 64

/* True if `name` is valid in a formula. */
bool rt_formula_is_name(const char *name);

/* Adds the terms of `formula` to `builder` and returns the whole. Messages name the character of the
 * formula. */
RtStatus rt_formula_read(const char *formula, RtCsgBuilder *builder, RtFormulaLookup *lookup, void *context,
                         RtCsgTerm *term, RtError *error);

/* The formula of a tree; solid i of the forest's set is called s<first + i>. The caller owns *formula
 * (rt_free). Parsing it with the same solids makes the same tree. */
RtStatus rt_formula_write(const RtCsgForest *forest, const RtCsg *tree, uint32_t first, char **formula,
                          RtError *error);

#endif
