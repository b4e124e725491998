/* SPDX-License-Identifier: Apache-2.0 */
/* Finding the plane of the least cost among all at which the part of an object begins, ends or lies: one pass
 * over the events of each axis, which counts what lies below and above.
 *
 * Papers: MacDonald & Booth 1990 (the cost); Wald & Havran 2006 (the sweep, objects in the plane to either
 * side, the bonus for cutting off empty space). */
#include "accel/kd/kd.h"

/* One axis of the cell that is swept; areas are halves of surfaces. */
typedef struct Sweep {
    double lo, hi, across, face; /* the area of a cell of this width is width * across + face */
    double visit;                /* cost of an inner node, times the area of the cell */
    double emptied;              /* factor for planes with nothing on one side */
    RtKdSplit best;
} Sweep;

static inline __attribute__((always_inline)) void consider(Sweep *s, float plane, int32_t below,
                                                           int32_t above, bool planar_upper) {
    double lower = ((double)plane - s->lo) * s->across + s->face;
    double upper = (s->hi - (double)plane) * s->across + s->face;
    double cost = s->visit + (below * lower + above * upper);
    if (below == 0 || above == 0) cost *= s->emptied;
    if (!(cost < s->best.cost)) return;
    s->best.cost = cost;
    s->best.plane = plane;
    s->best.planar_upper = planar_upper;
}

/* `planars` parts lie in the plane; `below` and `above` others. On a face of the cell only the plane's own
 * cell is cut off, and everything else is on the other side. */
static void consider_planars(Sweep *s, float plane, int32_t below, int32_t above, int32_t planars) {
    if ((double)plane == s->lo) {
        consider(s, plane, planars, above, false);
    } else if ((double)plane == s->hi) {
        consider(s, plane, below, planars, true);
    } else {
        consider(s, plane, below + planars, above, false);
        consider(s, plane, below, above + planars, true);
    }
}

/* Each end is passed before its plane is considered, each start after. Of several at one plane the last end
 * and the first start see all of them, and the others see more objects and cost no less. Starts and ends come
 * as if at random: they are counted without a branch. */
static void sweep(Sweep *s, const RtKdEvent *events, uint32_t count, uint32_t objects) {
    int32_t below = (int32_t)objects, above = (int32_t)objects;
    for (uint32_t i = 0; i < count; i++) below -= events[i].what >= RT_KD_PLANAR;
    for (uint32_t i = 0; i < count; i++) {
        RtKdEvent event = events[i];
        if (rt_kd_event_type(event) == RT_KD_PLANAR) {
            int32_t planars = 1;
            while (i + 1 < count && events[i + 1].plane == event.plane &&
                   rt_kd_event_type(events[i + 1]) == RT_KD_PLANAR) {
                planars++;
                i++;
            }
            above -= planars;
            consider_planars(s, event.plane, below, above, planars);
            below += planars;
        } else {
            bool start = event.what >= RT_KD_START;
            above -= !start;
            consider(s, event.plane, below, above, false);
            below += start;
        }
    }
}

RtKdSplit rt_kd_find_split(const RtKdBuilder *b, const RtKdCell *cell) {
    RtVec3d size = rt_subd(rt_widen(cell->box.hi), rt_widen(cell->box.lo));
    Sweep s = {.visit = b->kd->traversal_cost * rt_box_half_area(cell->box),
               .emptied = 1 - b->kd->empty_bonus,
               .best = {.cost = INFINITY}};
    for (uint32_t a = 0; a < 3; a++) {
        if (!(size.at[a] > 0)) continue;
        double least = s.best.cost;
        s.lo = (double)cell->box.lo.at[a];
        s.hi = (double)cell->box.hi.at[a];
        s.across = size.at[(a + 1) % 3] + size.at[(a + 2) % 3];
        s.face = size.at[(a + 1) % 3] * size.at[(a + 2) % 3];
        sweep(&s, b->events[a] + cell->events[a].from, cell->events[a].count, cell->ids.count);
        if (s.best.cost < least) s.best.axis = a;
    }
    return s.best;
}
