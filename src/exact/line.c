/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/line.h"

RtWideRay rt_wide_ray(const RtRay *ray) {
    return (RtWideRay){rt_widen(ray->org), rt_widen(ray->dir), (double)ray->tmin, (double)ray->tmax};
}

bool rt_line_may_meet(const RtWideRay *line, const RtBox *box, double *soonest) {
    double near = line->tmin, far = fmin(line->tmax, (double)FLT_MAX);
    for (int a = 0; a < 3; a++) {
        double org = line->org.at[a], dir = line->dir.at[a];
        double most = fmax(fabs((double)box->lo.at[a]), fabs((double)box->hi.at[a]));
        double slack = RT_LINE_SLACK * (fabs(org) + most);
        double lo = (double)box->lo.at[a] - org - slack, hi = (double)box->hi.at[a] - org + slack;
        if (dir == 0) {
            if (lo > 0 || hi < 0) return false;
            continue;
        }
        double first = (dir > 0 ? lo : hi) / dir, second = (dir > 0 ? hi : lo) / dir;
        near = fmax(near, first - RT_LINE_SLACK * fabs(first));
        far = fmin(far, second + RT_LINE_SLACK * fabs(second));
    }
    *soonest = near;
    return near <= far;
}

RtExactLine rt_exact_line(RtExactArena *arena, const RtWideRay *line) {
    return (RtExactLine){.wide = *line,
                         .org = rt_exact_vec(arena, line->org),
                         .dir = rt_exact_vec(arena, line->dir),
                         .zero = rt_exact_of(arena, 0),
                         .tmin = rt_exact_of(arena, line->tmin),
                         .tmax = rt_exact_of(arena, fmin(line->tmax, (double)FLT_MAX))};
}

bool rt_exact_counts(RtExactArena *arena, const RtExactLine *line, const RtRoot *t) {
    size_t mark = rt_exact_arena_mark(arena);
    RtRoot first = rt_root_of(arena, line->tmin), last = rt_root_of(arena, line->tmax);
    bool counts = rt_root_compare(arena, t, &first) >= 0 && rt_root_compare(arena, t, &last) <= 0;
    rt_exact_arena_rewind(arena, mark);
    return counts;
}
