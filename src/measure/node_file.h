/* SPDX-License-Identifier: Apache-2.0 */
/* The nodes of a structure as a table, for analyses in other programs. */
#ifndef RT_MEASURE_NODE_FILE_H
#define RT_MEASURE_NODE_FILE_H

#include "accel/accel.h"

/* Writes a row for each node or voxel of the topmost layer that has any to `path` (CSV with a header line):
 * its number, that of its parent, its level below the root, whether it is a leaf, the number of its children,
 * the length of a leaf's list, and the two corners of its box. Cells are empty where there is no parent, no
 * list, or no box, or a plugin does not tell. *count is the number of rows. RT_BAD_INPUT if no layer shows
 * boxes. */
RtStatus rt_nodes_save(const RtAccel *accel, const char *path, uint32_t *count, RtError *error);

#endif
