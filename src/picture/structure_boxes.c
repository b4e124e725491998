/* SPDX-License-Identifier: Apache-2.0 */
/* Which boxes of a structure are drawn, and in which colours. */
#include "core/base/elementary.h"
#include "picture/net.h"
#include "picture/structure_parts.h"

bool rt_structure_shows(const RtStructureDrawing *d, const RtBoxView *view) {
    const RtStructureOptions *o = d->options;
    const RtBox *box = view->box;
    RtVec3d corners[RT_NET_CORNERS];
    if (rt_box_is_empty(*box) || view->depth < o->first_level || view->depth > o->last_level ||
        (o->leaves && !view->leaf))
        return false;
    if (!o->slice) return true;
    if (rt_net_is_other(view)) return rt_net_section(view, o->axis, o->at, corners) > 0;
    return (double)box->lo.at[o->axis] <= o->at && o->at <= (double)box->hi.at[o->axis];
}

static double size_of(const RtBox *box) {
    return rt_lengthd(rt_subd(rt_widen(box->hi), rt_widen(box->lo)));
}

void rt_structure_count(void *context, const RtBoxView *view) {
    RtStructureDrawing *d = context;
    d->all++;
    if (!rt_structure_shows(d, view)) return;
    if (d->drawn++ == 0) d->first = d->last = view->depth;
    if (view->depth < d->first) d->first = view->depth;
    if (view->depth > d->last) d->last = view->depth;
    if (rt_net_is_other(view)) d->kind = view->extents->kind;
    double size = size_of(view->box);
    if (size > 0 && (d->most == 0 || size < d->least)) d->least = size;
    d->most = fmax(d->most, size);
}

RtColor rt_structure_level_color(const RtStructureDrawing *d, uint32_t depth) {
    double deep = d->last > d->first ? (double)(depth - d->first) / (d->last - d->first) : 0;
    return rt_color_scale(1 - 0.7 * deep);
}

bool rt_structure_is_by_size(const RtStructureDrawing *d) {
    return d->first == d->last && d->most > 1.5 * d->least;
}

RtColor rt_structure_size_color(const RtStructureDrawing *d, double size) {
    double small = rt_log(d->most / fmax(fmin(size, d->most), d->least)) / rt_log(d->most / d->least);
    return rt_color_scale(1 - 0.7 * small);
}

RtColor rt_structure_color(const RtStructureDrawing *d, const RtBoxView *view) {
    return rt_structure_is_by_size(d) ? rt_structure_size_color(d, size_of(view->box))
                                      : rt_structure_level_color(d, view->depth);
}
