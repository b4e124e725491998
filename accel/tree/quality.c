/* SPDX-License-Identifier: Apache-2.0 */
/* Quality metrics of hierarchies beside the expected cost: end-point overlap and leaf-count variability
 * (Aila, Karras & Laine 2013, "On Quality Metrics of Bounding Volume Hierarchies").
 *
 * Both are means over samples. The samples are the same for every hierarchy over a scene, so the computation
 * is fast for any number of objects, and differences between hierarchies are more precise than the values.
 * End-point overlap is the area of the surface that lies in a node but does not belong to its subtree,
 * weighted by the cost of the node: the mean, over points of the surface, of the cost of all nodes that
 * contain the point but not its object. There is one point in each of POINTS parts of the surface of equal
 * area. The part of a split object that contains the point belongs to a node. Leaf-count variability is the
 * standard deviation of the number of leaves that a line meets, over those of LINES uniform lines that meet
 * the root. */
#include "accel/tree/hierarchy.h"

#include "core/base/random.h"

enum { POINTS = 4096, LINES = 8192, POINT_SEED = 1, LINE_SEED = 2 };

/* ---- end-point overlap ---- */

static bool lists(const RtHierarchy *self, const RtNode *leaf, uint32_t id) {
    for (uint32_t i = 0; i < rt_node_fanout(leaf); i++) {
        if (self->ids[leaf->first + i] == id) return true;
    }
    return false;
}

/* Whether a leaf below lists the object and contains the point; adds to *cost the cost of the nodes that
 * contain the point without such a leaf. */
static bool add_overlap(const RtHierarchy *self, uint32_t index, RtVec3 point, uint32_t id, double *cost) {
    const RtNode *node = &self->nodes[index];
    uint32_t fanout = rt_node_fanout(node);
    bool leaf = rt_node_is_leaf(node), below = leaf && lists(self, node, id);
    if (!rt_box_contains(node->box, (RtBox){point, point})) return false;
    for (uint32_t i = 0; i < fanout && !leaf; i++)
        below |= add_overlap(self, node->first + i, point, id, cost);
    if (!below) *cost += leaf ? (double)fanout : self->traversal_cost;
    return below;
}

static double area_of(const RtTriangle *triangle) {
    RtVec3d a = rt_widen(triangle->v[0]);
    RtVec3d u = rt_subd(rt_widen(triangle->v[1]), a), v = rt_subd(rt_widen(triangle->v[2]), a);
    return rt_lengthd(rt_crossd(u, v)) / 2;
}

/* Uniform on the triangle, and in its box. */
static RtVec3 point_of(const RtTriangle *triangle, const RtBox *box, RtRandom *random) {
    double u = (double)rt_random_unit(random), v = (double)rt_random_unit(random);
    RtVec3d a = rt_widen(triangle->v[0]);
    RtVec3d ab = rt_subd(rt_widen(triangle->v[1]), a), ac = rt_subd(rt_widen(triangle->v[2]), a);
    bool over = u + v > 1;
    RtVec3 p = rt_narrow(rt_add_scaledd(rt_add_scaledd(a, ab, over ? 1 - u : u), ac, over ? 1 - v : v));
    return rt_vec_max(box->lo, rt_vec_min(box->hi, p));
}

/* Triangles only. */
static double end_point_overlap(const RtHierarchy *self, const RtGeometry *g) {
    double total = 0, passed = 0, cost = 0;
    uint32_t points = 0, held = 0;
    if (g->triangle_count != g->object_count) return NAN;
    for (uint32_t i = 0; i < g->triangle_count; i++) total += area_of(&g->triangles[i]);
    RtRandom random = rt_random(POINT_SEED, 0);
    double next = (double)rt_random_unit(&random) * total / POINTS;
    for (uint32_t i = 0; i < g->triangle_count; i++) {
        passed += area_of(&g->triangles[i]);
        while (points < POINTS && next < passed) {
            double own = 0;
            RtVec3 point = point_of(&g->triangles[i], &g->boxes[i], &random);
            bool found =
                add_overlap(self, 0, point, i, &own); /* rounding may move it out of the box of a part */
            held += found;
            cost += found ? own : 0;
            random = rt_random(POINT_SEED, ++points);
            next = (points + (double)rt_random_unit(&random)) * total / POINTS;
        }
    }
    return held > 0 ? cost / held : NAN;
}

/* ---- leaf-count variability ---- */

static uint32_t leaves_met(const RtHierarchy *self, uint32_t index, const RtPreparedRay *line) {
    const RtNode *node = &self->nodes[index];
    float enter;
    uint32_t sum = 0;
    if (!rt_box_hit(&node->box, line, INFINITY, &enter)) return 0;
    if (rt_node_is_leaf(node)) return 1;
    for (uint32_t i = 0; i < node->count; i++) sum += leaves_met(self, node->first + i, line);
    return sum;
}

/* A line through two uniform points of the sphere around a box. */
static RtRay line_about(const RtBox *box, RtRandom *random) {
    RtVec3d lo = rt_widen(box->lo), half = rt_scaled(rt_subd(rt_widen(box->hi), lo), 0.5);
    RtVec3d center = rt_addd(lo, half);
    RtVec3d from = rt_scaled(rt_random_direction(random), rt_lengthd(half));
    RtVec3d to = rt_scaled(rt_random_direction(random), rt_lengthd(half));
    return (RtRay){.org = rt_narrow(rt_addd(center, from)),
                   .dir = rt_narrow(rt_subd(to, from)),
                   .tmax = INFINITY,
                   .kind = RT_RAY_RANDOM};
}

static double leaf_count_variability(const RtHierarchy *self, const RtGeometry *g) {
    double lines = 0, sum = 0, squares = 0;
    for (uint32_t i = 0; i < LINES; i++) {
        RtRandom random = rt_random(LINE_SEED, i);
        RtRay ray = line_about(&self->nodes[0].box, &random);
        if (!rt_ray_is_valid(&ray)) continue;
        RtPreparedRay line = rt_ray_prepare(&ray, &g->box);
        float enter;
        if (!rt_box_hit(&self->nodes[0].box, &line, INFINITY, &enter)) continue;
        double leaves = leaves_met(self, 0, &line);
        lines += 1;
        sum += leaves;
        squares += leaves * leaves;
    }
    return lines > 0 ? sqrt(fmax(squares * lines - sum * sum, 0)) / lines : NAN;
}

void rt_hierarchy_measure(const RtHierarchy *self, const RtGeometry *geometry, RtDescription *out) {
    if (self->node_count == 0) return;
    out->end_point_overlap = end_point_overlap(self, geometry);
    out->leaf_count_variability = leaf_count_variability(self, geometry);
}
