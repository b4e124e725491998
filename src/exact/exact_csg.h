/* SPDX-License-Identifier: Apache-2.0 */
/* CSG trees in exact arithmetic: what one is, exactly, says exact_hit.h. */
#ifndef RT_EXACT_EXACT_CSG_H
#define RT_EXACT_EXACT_CSG_H

#include "core/shape/csg.h"
#include "exact/line.h"

/* Like rt_exact_hit. */
RtFinding rt_exact_csg_hit(RtExactArena *arena, const RtCsgForest *forest, const RtCsg *tree,
                           const RtExactLine *line, RtPlace *t);

#endif
