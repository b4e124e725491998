/* SPDX-License-Identifier: Apache-2.0 */
/* What a hall is furnished with, of triangles: each stands on (or hangs at) the origin of forms->place and
 * has forms->material. `size`, from 1, sets how fine they are: what is round has a few times as many sides.
 * Lengths are in metres. */
#ifndef RT_SCENES_ORNAMENTS_H
#define RT_SCENES_ORNAMENTS_H

#include "scenes/forms.h"

#define RT_COLUMN_HEIGHT 4.9

/* A column of RT_COLUMN_HEIGHT on a plinth of 1.24 by 1.24: mouldings, a fluted shaft (long thin triangles),
 * a capital with two rows of leaves. */
RtStatus rt_ornament_column(RtForms *forms, uint32_t size, RtError *error);

/* A vase 1.3 high, of one of the `kinds` there are. */
enum { RT_VASE_KINDS = 3 };
RtStatus rt_ornament_vase(RtForms *forms, uint32_t size, uint32_t kind, RtError *error);

/* A baluster, .8 high and .2 thick. */
RtStatus rt_ornament_baluster(RtForms *forms, uint32_t size, RtError *error);

/* A chandelier, 2.3 across and hanging by a chain of `links` of .12 each; the origin is in the middle of its
 * ring. */
RtStatus rt_ornament_chandelier(RtForms *forms, uint32_t size, uint32_t links, RtError *error);

#endif
