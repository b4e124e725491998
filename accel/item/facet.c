/* SPDX-License-Identifier: Apache-2.0 */
/* Scan conversion of triangles and convex polygons by homogeneous edge functions (Olano & Greer 1997): a ray
 * passes an edge on the inside if dir . (V x W) has the sign of the inside, V and W being its ends relative
 * to the eye. Nothing is divided by depth, so that facets behind and around the eye need no clipping. The ray
 * is the very one that will be traced, rounded as it is.
 *
 * Why a miss is certain. A hit function computes in rounded arithmetic: a hit on a facet at t means that the
 * ray's point at t is q - e, with q a point of the facet and |e| <= thickness. (A triangle's vertices are off
 * by 7 * 2^-24 of the largest distance between eye and box, M, on two axes across the ray, which makes 0.62 *
 * 2^-20 M; a polygon computes in double.) With n the normal, E the edge's V x W towards the inside, q . E >=
 * 0 and n . q = height, so that
 *
 *     dir . E >= -thickness |E| / t      and      |t - height / (n . dir)| <= thickness |n| / |n . dir|.
 *
 * To both we add the rounding of our own double arithmetic. A polygon is taken for convex if no vertex is
 * farther than 2^-40 of its size on the outer side of any edge: then neither is what it encloses. */
#include "accel/item/item.h"

/* The plane of a facet is through `vertices` (relative to the eye), `normal` of any length, known to within
 * `normal_error`. False if it is not clear from which side the eye sees it. */
static bool make_facet(const RtItemBuffer *buffer, const RtBox *box, const RtVec3d *vertices, uint32_t count,
                       RtVec3d normal, double normal_error, RtItemFacet *facet) {
    RtVec3 org = rt_narrow(buffer->view.eye);
    double reach = 0, eye = rt_lengthd(buffer->view.eye);
    double thickness = (double)rt_thickness(org, box) + 0x1p-40 * eye + 0x1p-120;
    for (uint32_t i = 0; i < count; i++) reach = fmax(reach, rt_lengthd(vertices[i]));
    *facet = (RtItemFacet){.count = count,
                           .normal = normal,
                           .height = rt_dotd(normal, vertices[0]),
                           .slop = thickness * rt_lengthd(normal),
                           .height_error = normal_error * reach,
                           .approach_error = normal_error * buffer->longest};
    if (!(fabs(facet->height) > 2 * facet->height_error)) return false;
    double inward = facet->height > 0 ? 1 : -1;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d v = vertices[i], w = vertices[i + 1 < count ? i + 1 : 0];
        facet->edges[i] = rt_scaled(rt_crossd(v, w), inward);
        facet->slack[i] = thickness * rt_lengthd(facet->edges[i]) * (1 + 0x1p-18);
        facet->rounding[i] = 0x1p-48 * rt_lengthd(v) * rt_lengthd(w) * buffer->longest;
    }
    return true;
}

static bool make_triangle(const RtItemBuffer *buffer, const RtTriangle *triangle, const RtBox *box,
                          RtItemFacet *facet) {
    RtVec3d v[3];
    for (int i = 0; i < 3; i++) v[i] = rt_subd(rt_widen(triangle->v[i]), buffer->view.eye);
    RtVec3d a = rt_subd(v[1], v[0]), b = rt_subd(v[2], v[0]);
    double reach = rt_lengthd(v[0]) + rt_lengthd(v[1]) + rt_lengthd(v[2]);
    double error = 0x1p-48 * reach * (rt_lengthd(a) + rt_lengthd(b));
    return make_facet(buffer, box, v, 3, rt_crossd(a, b), error, facet);
}

/* Is no vertex on the outer side of any edge, in the plane of projection? */
static bool is_convex(const RtPolygon *polygon, const RtVec3 *vertices, double size) {
    uint32_t u = polygon->u, v = polygon->v, third = 3 - u - v;
    double turn = polygon->normal.at[third] > 0 ? 1 : -1;
    if ((third + 1) % 3 != u) turn = -turn;
    for (uint32_t i = 0; i < polygon->count; i++) {
        const float *a = vertices[i].at, *b = vertices[i + 1 < polygon->count ? i + 1 : 0].at;
        double du = (double)b[u] - (double)a[u], dv = (double)b[v] - (double)a[v];
        double most = 0x1p-40 * size * (fabs(du) + fabs(dv)) / 2;
        for (uint32_t k = 0; k < polygon->count; k++) {
            double pu = (double)vertices[k].at[u] - (double)a[u];
            double pv = (double)vertices[k].at[v] - (double)a[v];
            if (turn * (du * pv - dv * pu) < -most) return false;
        }
    }
    return true;
}

static bool make_polygon(const RtItemBuffer *buffer, const RtPolygon *polygon, const RtBox *box,
                         RtItemFacet *facet) {
    const RtVec3 *vertices = buffer->base.scene->geometry.polygon_vertices + polygon->first;
    RtVec3d lifted[RT_ITEM_MAX_EDGES];
    double size = rt_lengthd(rt_widen(rt_box_size(*box)));
    if (polygon->count > RT_ITEM_MAX_EDGES || !is_convex(polygon, vertices, size)) return false;
    /* The polygon that is hit is the vertices' projection along the third axis to the plane. */
    uint32_t third = 3 - polygon->u - polygon->v;
    for (uint32_t i = 0; i < polygon->count; i++) {
        RtVec3d p = rt_widen(vertices[i]);
        double above = rt_dotd(polygon->normal, rt_subd(p, polygon->center));
        p.at[third] -= above / polygon->normal.at[third];
        lifted[i] = rt_subd(p, buffer->view.eye);
    }
    if (!make_facet(buffer, box, lifted, polygon->count, polygon->normal, 0x1p-46, facet)) return false;
    facet->height = rt_dotd(polygon->normal, rt_subd(polygon->center, buffer->view.eye));
    return true;
}

bool rt_item_facet(const RtItemBuffer *buffer, uint32_t id, RtItemFacet *facet) {
    const RtGeometry *g = &buffer->base.scene->geometry;
    RtShape shape = rt_ref_shape(g->objects[id]);
    uint32_t index = rt_ref_index(g->objects[id]);
    if (shape == RT_SHAPE_TRIANGLE) return make_triangle(buffer, &g->triangles[index], &g->boxes[id], facet);
    if (shape == RT_SHAPE_POLYGON) return make_polygon(buffer, &g->polygons[index], &g->boxes[id], facet);
    return false;
}

bool rt_item_cross(const RtItemFacet *facet, const RtRay *ray, float near, RtItemSpan *span) {
    RtVec3d dir = rt_widen(ray->dir);
    double approach = rt_dotd(facet->normal, dir), least = (double)near;
    *span = (RtItemSpan){near, INFINITY, false};
    /* Seen edge-on: the depth says nothing. */
    bool clear = fabs(approach) > 4 * facet->approach_error;
    double t = clear ? facet->height / approach : 0, error = 0;
    if (clear) {
        error = 2 * (facet->slop + facet->height_error + fabs(t) * facet->approach_error) / fabs(approach) +
                0x1p-21 * fabs(t);
        if (t + error < (double)ray->tmin) return false;
        least = fmax(least, t - error);
    }
    bool inside = clear && t - error >= (double)ray->tmin;
    for (uint32_t i = 0; i < facet->count; i++) {
        double side = rt_dotd(facet->edges[i], dir), doubt = facet->slack[i] / least + facet->rounding[i];
        if (side < -doubt) return false;
        inside = inside && side > doubt;
    }
    span->lo = rt_maxf(rt_float_below(least), near);
    if (clear) span->hi = rt_maxf(rt_float_above(t + error), nextafterf(span->lo, INFINITY));
    span->certain = inside;
    return true;
}
