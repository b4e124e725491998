/* SPDX-License-Identifier: Apache-2.0 */
#include "exact/lattice.h"

/* An integer in -most..most. */
static float whole(RtRandom *random, int most) {
    return (float)((int)rt_random_below(random, 2 * (uint32_t)most + 1) - most);
}

static RtVec3 whole_point(RtRandom *random, int most) {
    RtVec3 p;
    for (int a = 0; a < 3; a++) p.at[a] = whole(random, most);
    return p;
}

static void aim(RtLattice *lattice, RtVec3 point) {
    lattice->targets[lattice->count++] = point;
}

/* The vertices, and the middles of the edges. */
static void aim_at_edges(RtLattice *lattice, const RtVec3 *v, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        aim(lattice, v[i]);
        aim(lattice, rt_scale(rt_add(v[i], v[(i + 1) % count]), 0.5f));
    }
}

/* The axes are permuted, so that no axis is special. */
static RtVec3 turned(RtVec3 v, uint32_t by) {
    return rt_vec3(v.at[by], v.at[(by + 1) % 3], v.at[(by + 2) % 3]);
}

static RtStatus add_flat(RtLattice *lattice, RtGeometry *g, RtRandom *random, bool pentagon, RtError *error) {
    static const float corners[5][2] = {{2, 0}, {1, 2}, {-1, 2}, {-2, 0}, {0, -2}};
    RtVec3 v[5], u, w;
    do {
        u = whole_point(random, 2);
        w = whole_point(random, 2);
    } while (rt_lengthd(rt_crossd(rt_widen(u), rt_widen(w))) == 0);
    const RtVec3 center = whole_point(random, 4);
    for (int i = 0; i < 5; i++)
        v[i] = rt_add(center, rt_add(rt_scale(u, corners[i][0]), rt_scale(w, corners[i][1])));
    aim_at_edges(lattice, v, pentagon ? 5 : 3);
    return pentagon ? rt_geometry_add_polygon(g, v, 5, error) : rt_geometry_add_triangle(g, v, NULL, error);
}

/* Radius 5, because 3^2 + 4^2 = 5^2. */
static RtStatus add_sphere(RtLattice *lattice, RtGeometry *g, RtRandom *random, RtError *error) {
    const RtVec3 center = whole_point(random, 4);
    for (uint32_t i = 0; i < 3; i++) {
        aim(lattice, rt_add(center, turned(rt_vec3(0, 0, 5), i)));
        aim(lattice, rt_sub(center, turned(rt_vec3(3, -4, 0), i)));
    }
    return rt_geometry_add_sphere(g, center, 5, error);
}

/* A cylinder along an axis, or along (3, 4, 0), or a cone. The points are on its rims, and on its side. */
static RtStatus add_cone(RtLattice *lattice, RtGeometry *g, RtRandom *random, RtError *error) {
    static const RtVec3 across[2][4] = {{{{5, 0, 0}}, {{-3, 4, 0}}, {{0, -5, 0}}, {{4, 3, 0}}},
                                        {{{4, -3, 0}}, {{-4, 3, 0}}, {{0, 0, 5}}, {{0, 0, -5}}}};
    const bool oblique = rt_random_below(random, 2);
    const uint32_t turn = rt_random_below(random, 3), kind = rt_random_below(random, 3);
    const float length = 1 + (float)rt_random_below(random, 3), ratio = 0.5f * (float)kind;
    const RtVec3 axis = turned(oblique ? rt_vec3(3, 4, 0) : rt_vec3(0, 0, 5), turn);
    const RtVec3 base = whole_point(random, 4), apex = rt_add(base, rt_scale(axis, length));
    for (int i = 0; i < 4; i++) {
        const RtVec3 rim = rt_add(base, turned(across[oblique][i], turn));
        const RtVec3 other = rt_add(apex, rt_scale(turned(across[oblique][i], turn), ratio));
        aim(lattice, rim);
        aim(lattice, other);
        aim(lattice, rt_scale(rt_add(rim, other), 0.5f));
    }
    return rt_geometry_add_cone(g, base, 5, apex, 5 * ratio, error);
}

/* An octahedron, or a ring, or a ball with a box, without a cylinder through the middle. */
static RtStatus make_tree(RtLattice *lattice, RtCsgBuilder *b, RtSubject subject, RtRandom *random,
                          RtCsgTerm *root, RtError *error) {
    const RtVec3 center = whole_point(random, 4);
    const RtVec3 lo = rt_sub(center, rt_vec3(6, 4, 3)), hi = rt_add(center, rt_vec3(6, 4, 3));
    const RtTransform still = rt_transform_identity();
    RtVec3 tips[6];
    RtTriangle faces[8];
    uint32_t solid;
    RtCsgTerm drill, other;
    RT_TRY(rt_solid_add_frustum(&b->set, rt_sub(center, rt_vec3(0, 0, 8)), 1,
                                rt_add(center, rt_vec3(0, 0, 8)), 1, &solid, error));
    RT_TRY(rt_csg_solid(b, solid, 0, &drill, error));
    for (uint32_t i = 0; i < 6; i++)
        tips[i] = rt_add(center, turned(rt_vec3(i < 3 ? 5 : -5, 0, 0), (3 - i % 3) % 3));
    for (uint32_t i = 0; i < 8; i++) {
        const uint32_t x = i & 1, y = i >> 1 & 1, z = i >> 2, flip = x ^ y ^ z;
        faces[i] = (RtTriangle){
            {tips[3 * x], tips[flip ? 2 + 3 * z : 1 + 3 * y], tips[flip ? 1 + 3 * y : 2 + 3 * z]}};
    }
    if (subject == RT_SUBJECT_MESH) {
        for (int i = 0; i < 4; i++) aim_at_edges(lattice, faces[2 * i].v, 3);
        RT_TRY(rt_solid_add_mesh(&b->set, faces, 8, &still, &solid, error));
        RT_TRY(rt_csg_solid(b, solid, 0, root, error));
    } else if (subject == RT_SUBJECT_TORUS) {
        for (uint32_t i = 0; i < 6; i++) aim(lattice, tips[i]);
        aim(lattice, rt_add(center, rt_vec3(3, 4, 2)));
        aim(lattice, rt_add(center, rt_vec3(0, 7, 0)));
        aim(lattice, rt_add(center, rt_vec3(-4, 3, -2)));
        RT_TRY(rt_solid_add_ring(&b->set, center, rt_vec3(0, 0, 1), 5, 2, &solid, error));
        RT_TRY(rt_csg_solid(b, solid, 0, root, error));
    } else {
        for (uint32_t i = 0; i < 8; i++)
            aim(lattice, rt_vec3(i & 1 ? lo.x : hi.x, i & 2 ? lo.y : hi.y, i & 4 ? lo.z : hi.z));
        for (uint32_t i = 0; i < 6; i++) aim(lattice, tips[i]);
        aim(lattice, rt_add(center, rt_vec3(4, 0, 3))); /* where ball and box meet */
        aim(lattice, rt_add(center, rt_vec3(-3, 4, 0)));
        RT_TRY(rt_solid_add_ellipsoid(&b->set, center, rt_vec3(5, 5, 5), &solid, error));
        RT_TRY(rt_csg_solid(b, solid, 0, root, error));
        RT_TRY(rt_solid_add_box(&b->set, lo, hi, &solid, error));
        RT_TRY(rt_csg_solid(b, solid, 0, &other, error));
        RT_TRY(rt_csg_combine(b, RT_CSG_UNION, *root, other, root, error));
    }
    return rt_csg_combine(b, RT_CSG_DIFFERENCE, *root, drill, root, error);
}

static RtStatus add_tree(RtLattice *lattice, RtGeometry *g, RtSubject subject, RtRandom *random,
                         RtError *error) {
    RtCsgBuilder b = {0};
    RtCsgTerm root;
    RtStatus status = make_tree(lattice, &b, subject, random, &root, error);
    if (status == RT_OK) status = rt_geometry_add_csg(g, &b, root, true, error);
    rt_csg_builder_clear(&b);
    return status;
}

RtStatus rt_lattice_add(RtLattice *lattice, RtGeometry *geometry, RtSubject subject, RtRandom *random,
                        RtError *error) {
    lattice->count = 0;
    switch (subject) {
    case RT_SUBJECT_SPHERE: return add_sphere(lattice, geometry, random, error);
    case RT_SUBJECT_POLYGON: return add_flat(lattice, geometry, random, true, error);
    case RT_SUBJECT_TRIANGLE: return add_flat(lattice, geometry, random, false, error);
    case RT_SUBJECT_CONE: return add_cone(lattice, geometry, random, error);
    default: return add_tree(lattice, geometry, subject, random, error);
    }
}

RtRay rt_lattice_ray(const RtLattice *lattice, RtRandom *random) {
    const RtVec3 target = lattice->targets[rt_random_below(random, lattice->count)];
    RtRay ray = {.tmax = INFINITY, .kind = RT_RAY_RANDOM};
    do ray.dir = whole_point(random, 3);
    while (rt_lengthd(rt_widen(ray.dir)) == 0);
    ray.org = rt_sub(target, rt_scale(ray.dir, (float)(1 + rt_random_below(random, 8))));
    return ray;
}
