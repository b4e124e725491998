/* SPDX-License-Identifier: Apache-2.0 */
/* The ray tree that raytally trace shows with --depth, in words and as JSON. */
#ifndef RT_CLI_TRACE_TREE_H
#define RT_CLI_TRACE_TREE_H

#include "render/ray_tree.h"

#include <jansson.h>

/* Both take the cost of each ray, in the order of tree->rays. */

/* Prints at most `rows` rays, all for 0, depth first and indented; the light that each brings, and its terms;
 * and sums: in 100 columns, unless rays are more than about 12 levels deep. */
void rt_cli_print_tree(const RtRayTree *tree, const RtTally *costs, const RtScene *scene, int64_t rows);

/* The primary ray, with the rays that start at its hit as its member "rays", and so on; null for an empty
 * tree. A new reference, or NULL if memory is short. */
json_t *rt_cli_tree_json(const RtRayTree *tree, const RtTally *costs, const RtScene *scene);

#endif
