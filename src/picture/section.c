/* SPDX-License-Identifier: Apache-2.0 */
#include "picture/section.h"

#include "picture/extent_outline.h"

enum { SPACING = 3, MOST_CROSSINGS = 64 }; /* pixels between lines; of one line */

bool rt_section_add_ball(const RtSection *section, cairo_t *cairo, RtVec3d center, double radius) {
    double off = rt_dotd(rt_subd(center, section->on), section->normal);
    if (fabs(off) >= radius) return false;
    rt_add_circle(cairo, rt_section_point(section, center),
                  sqrt(radius * radius - off * off) * section->scale);
    return true;
}

static void add_flat(const RtSection *section, cairo_t *cairo, const RtVec3 *corners, uint32_t count) {
    RtVec3d cut[2];
    if (rt_outline_cut_flat(corners, count, section->on, section->normal, cut))
        rt_add_line(cairo, rt_section_point(section, cut[0]), rt_section_point(section, cut[1]));
}

/* The outline around a crossing: a line along the surface, within the plane. `along`: the direction of the
 * line that crosses; another one, across it, draws surfaces that are nearly parallel to this one. */
static void add_tangent(const RtSection *section, cairo_t *cairo, RtVec3d at, RtVec3d normal, RtVec3d along) {
    RtVec3d tangent = rt_crossd(normal, section->normal);
    double length = rt_lengthd(tangent), slant = fabs(rt_dotd(normal, along));
    if (!(length > 1e-6) || slant < 0.6 * length) return;
    RtVec3d half = rt_scaled(tangent, (double)SPACING / section->scale / length);
    RtPoint from = rt_section_point(section, rt_subd(at, half)),
            to = rt_section_point(section, rt_addd(at, half));
    cairo_move_to(cairo, from.x, from.y);
    cairo_line_to(cairo, to.x, to.y);
}

/* Follows one line of the plane through the object. */
static void add_crossings(const RtSection *section, cairo_t *cairo, const RtGeometry *g, uint32_t id,
                          RtVec3d from, RtVec3d along, RtCrossing *crossings) {
    RtRay ray = {.org = rt_narrow(from), .dir = rt_narrow(along), .tmax = INFINITY};
    RtPreparedRay prepared;
    float t;
    for (int i = 0; i < MOST_CROSSINGS; i++) {
        rt_hit_ray(&prepared, g, &ray, crossings);
        if (!rt_object_hit(g, id, &prepared, &t, NULL)) return;
        RtNormals normals = rt_object_normals(g, id, &ray, t, crossings);
        add_tangent(section, cairo, rt_ray_point(&ray, t), normals.geometric, along);
        ray.tmin = nextafterf(t, INFINITY);
    }
}

/* The part of the line through `middle` in direction `across`, `right` or `up`, that the drawing shows. */
static void visible(const RtSection *section, cairo_t *cairo, RtVec3d middle, RtVec3d across, double *from,
                    double *to) {
    double left, top, right, bottom, x = rt_dotd(across, section->right), y = rt_dotd(across, section->up);
    RtPoint at = rt_section_point(section, middle);
    cairo_clip_extents(cairo, &left, &top, &right, &bottom);
    *from = (x * (left - at.x) + y * (at.y - bottom)) / section->scale;
    *to = (x * (right - at.x) + y * (at.y - top)) / section->scale;
}

/* Lines over the object's ball, in direction `along`, side by side in direction `across`. */
static void scan(const RtSection *section, cairo_t *cairo, const RtGeometry *g, uint32_t id, RtVec3d along,
                 RtVec3d across, RtCrossing *crossings) {
    const RtBall ball = rt_object_ball(g, id);
    double off = rt_dotd(rt_subd(ball.center, section->on), section->normal);
    if (fabs(off) >= ball.radius) return;
    const double radius = sqrt(ball.radius * ball.radius - off * off), step = SPACING / section->scale;
    double from, to;
    RtVec3d middle = rt_add_scaledd(ball.center, section->normal, -off);
    RtVec3d start = rt_add_scaledd(middle, along, -1.1 * radius);
    visible(section, cairo, middle, across, &from, &to);
    from = fmax(from, -radius), to = fmin(to, radius);
    for (int i = 0; from + i * step <= to; i++)
        add_crossings(section, cairo, g, id, rt_add_scaledd(start, across, from + i * step), along,
                      crossings);
}

void rt_section_add_object(const RtSection *section, cairo_t *cairo, const RtGeometry *geometry, uint32_t id,
                           RtCrossing *crossings) {
    const uint32_t index = rt_ref_index(geometry->objects[id]);
    switch (rt_ref_shape(geometry->objects[id])) {
    case RT_SHAPE_SPHERE:
        rt_section_add_ball(section, cairo, rt_widen(geometry->spheres[index].center),
                            (double)geometry->spheres[index].radius);
        break;
    case RT_SHAPE_TRIANGLE: add_flat(section, cairo, geometry->triangles[index].v, 3); break;
    case RT_SHAPE_POLYGON:
        add_flat(section, cairo, rt_polygon_vertices(geometry, index), geometry->polygons[index].count);
        break;
    case RT_SHAPE_CONE:
    case RT_SHAPE_CSG:
        scan(section, cairo, geometry, id, section->right, section->up, crossings);
        scan(section, cairo, geometry, id, section->up, section->right, crossings);
        break;
    case RT_SHAPE_COUNT: break;
    }
}
