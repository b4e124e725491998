/* SPDX-License-Identifier: Apache-2.0 */
/* Convex polygons as facets (item.h), one by one: there are few. A polygon is taken for convex if no vertex
 * is farther than 2^-40 of its size on the outer side of any edge: then neither is what it encloses. */
#include "accel/item/item.h"

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

/* The polygon that is hit is the vertices' projection along the third axis to the plane. */
static RtVec3d lift(const RtPolygon *polygon, RtVec3 vertex) {
    uint32_t third = 3 - polygon->u - polygon->v;
    RtVec3d p = rt_widen(vertex);
    double above = rt_dotd(polygon->normal, rt_subd(p, polygon->center));
    p.at[third] -= above / polygon->normal.at[third];
    return p;
}

static RtVec3d project(const RtItemProjection *projection, RtVec3d q) {
    return rt_vec3d(rt_dotd(projection->x, q), rt_dotd(projection->y, q), rt_dotd(projection->depth, q));
}

static double gradient(const RtItemProjection *projection, RtVec3d of) {
    return fabs(of.x) * projection->scale[0] + fabs(of.y) * projection->scale[1];
}

/* `of` times `scale`, as coefficients of (1, column, row) from the corner of the tile. */
static void put_function(float to[3][RT_ITEM_FACETS], const RtItemDrawing *d, RtVec3d of, double scale) {
    to[0][0] = (float)((of.x * d->column + of.y * d->row + of.z) * scale);
    to[1][0] = (float)(of.x * scale);
    to[2][0] = (float)(of.y * scale);
}

static bool put_edges(const RtItemDrawing *d, const RtVec3d *vertices, uint32_t count, double side,
                      double far, RtItemFacets *facet) {
    const RtItemProjection *projection = &d->buffer->projection;
    const double g = projection->longest, product = projection->scale[0] * projection->scale[1] * g * g;
    double rounding = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d u = vertices[i], along = rt_subd(vertices[i + 1 < count ? i + 1 : 0], u);
        RtVec3d edge = rt_crossd(project(projection, u), project(projection, along));
        double scale = 1 / gradient(projection, edge);
        put_function(facet->edge[i], d, edge, copysign(scale, side));
        rounding = fmax(rounding, 0x1p-40 * product * rt_lengthd(along) * far * scale);
    }
    double b = 0x1.01p-24 * g, coarse = 1 / fmin(projection->scale[0], projection->scale[1]);
    facet->edge_error[0][0] = (float)(rounding + 1.25 * g * b + 0x1p-14 * coarse);
    facet->edge_error[1][0] = (float)(1.25 * g * 0.65 * 0x1p-20 * far);
    return isfinite(rounding);
}

/* w = normal . dir / height, dir being linear in column and row. */
static bool put_depth(const RtItemDrawing *d, RtVec3d normal, double height, double far,
                      RtItemFacets *facet) {
    const RtItemProjection *projection = &d->buffer->projection;
    const RtView *view = &d->buffer->view;
    double g = projection->longest, b = 0x1.01p-24 * g,
           coarse = 1 / fmin(projection->scale[0], projection->scale[1]);
    double size = rt_lengthd(normal), rough = 0x1p-40 * size * far * g / fabs(height);
    double right = rt_dotd(normal, view->right) / rt_lengthd(view->right);
    double down = rt_dotd(normal, view->down) / rt_lengthd(view->down);
    RtVec3d of = rt_vec3d(right / projection->scale[0], down / projection->scale[1], 0);
    const RtSampling *s = &view->sampling;
    of.z = rt_dotd(normal, projection->depth) - of.x * 0.5 * (s->columns - 1) - of.y * 0.5 * (s->rows - 1);
    put_function(facet->depth, d, of, 1 / height);
    double slope = gradient(projection, of) / fabs(height) * g, e = 0x1p-19 * far;
    facet->depth_error[0][0] = (float)(slope * (2 * b + 0x1p-13 * coarse) + 4 * rough / far);
    facet->depth_error[1][0] = (float)(2 * (e * slope + b) + 4 * rough + 0x1p-19);
    facet->depth_error[2][0] = (float)(2 * e);
    return rough < 0x1p-4;
}

void rt_item_place_facet(const RtItemDrawing *d, const RtItemFootprint *at, RtItemFacets *f, uint32_t lane) {
    const uint32_t corner[2] = {d->column, d->row};
    for (int a = 0; a < 2; a++) {
        f->lo[a][lane] = at->lo[a] > corner[a] ? (int32_t)(at->lo[a] - corner[a]) : 0;
        f->hi[a][lane] =
            (int32_t)(at->hi[a] - corner[a] < RT_ITEM_TILE ? at->hi[a] - corner[a] : RT_ITEM_TILE - 1);
    }
    f->most[lane] = rt_float_above(1 / (double)at->near);
    if (!(f->edge_error[1][lane] * f->most[lane] < 0x1p-4f)) f->most[lane] = INFINITY;
}

bool rt_item_polygon(const RtItemDrawing *d, uint32_t id, const RtItemFootprint *footprint,
                     RtItemFacets *facet, uint32_t *count) {
    const RtGeometry *g = rt_item_geometry(d->buffer);
    if (rt_ref_shape(g->objects[id]) != RT_SHAPE_POLYGON) return false;
    const RtPolygon *polygon = &g->polygons[rt_ref_index(g->objects[id])];
    const RtVec3 *vertices = g->polygon_vertices + polygon->first;
    double size = rt_lengthd(rt_widen(rt_box_size(g->boxes[id])));
    if (polygon->count > RT_ITEM_MAX_EDGES || !is_convex(polygon, vertices, size)) return false;
    RtVec3d lifted[RT_ITEM_MAX_EDGES], eye = d->buffer->view.eye;
    double far = 0;
    for (uint32_t i = 0; i < polygon->count; i++) {
        lifted[i] = rt_subd(lift(polygon, vertices[i]), eye);
        for (int a = 0; a < 3; a++) far = fmax(far, fabs(lifted[i].at[a]));
    }
    far = far * (1 + 0x1p-10) + 0x1p-120;
    double height = rt_dotd(polygon->normal, rt_subd(polygon->center, eye));
    if (!put_depth(d, polygon->normal, height, far, facet)) return false;
    /* right x down looks from the image to the eye or away, as the camera was made. */
    RtVec3d turn = rt_crossd(d->buffer->projection.x, d->buffer->projection.y);
    double side = height * rt_dotd(turn, d->buffer->projection.depth);
    if (!put_edges(d, lifted, polygon->count, side, far, facet)) return false;
    rt_item_place_facet(d, footprint, facet, 0);
    facet->id[0] = id;
    *count = polygon->count;
    return true;
}
