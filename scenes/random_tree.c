/* SPDX-License-Identifier: Apache-2.0 */
#include "scenes/build.h"

#include <assert.h>

typedef struct Generator {
    RtCsgBuilder *builder;
    RtRandom *random;
    bool coarse;
    bool endless; /* some solid so far is unbounded */
    uint32_t materials;
    RtError *error;
} Generator;

static uint32_t choose(Generator *m, uint32_t count) {
    return rt_random_below(m->random, count);
}

/* In [lo, hi), both multiples of 1/2. */
static float number(Generator *m, float lo, float hi) {
    if (!m->coarse) return rt_random_between(m->random, lo, hi);
    return lo + 0.5f * (float)choose(m, (uint32_t)(2 * (hi - lo)));
}

static RtVec3 vector(Generator *m, float lo, float hi) {
    RtVec3 v;
    for (int a = 0; a < 3; a++) v.at[a] = number(m, lo, hi);
    return v;
}

/* A random scale between 1/2 and 2, uneven or not, rotation and position. */
static RtStatus random_place(Generator *m, RtTransform *place) {
    *place = rt_transform_identity();
    RtVec3 size = vector(m, 0.5f, 2);
    if (choose(m, 2)) size = rt_vec3(size.x, size.x, size.x);
    RT_TRY(rt_transform_scale(place, size, m->error));
    if (m->coarse) {
        RtVec3 axis = {0, 0, 0};
        axis.at[choose(m, 3)] = 1;
        RT_TRY(rt_transform_rotate(place, axis, 90 * (double)choose(m, 4), m->error));
    } else {
        RtVec3 axis = rt_narrow(rt_random_direction(m->random));
        RT_TRY(rt_transform_rotate(place, axis, rt_random_betweend(m->random, 0, 360), m->error));
    }
    return rt_transform_translate(place, vector(m, -2, 2), m->error);
}

RtStatus rt_add_box(RtCsgBuilder *builder, RtBox box, uint32_t material, RtCsgTerm *out, RtError *error) {
    uint32_t solid;
    RT_TRY(rt_solid_add_box(&builder->set, box.lo, box.hi, &solid, error));
    return rt_csg_solid(builder, solid, material, out, error);
}

static RtStatus add_box(Generator *m, RtCsgTerm *out) {
    RtBox box;
    box.lo = vector(m, -3, 2);
    box.hi = rt_add(box.lo, vector(m, 0.5f, 3));
    return rt_add_box(m->builder, box, choose(m, m->materials), out, m->error);
}

/* A cube cut by random planes, or one half-space. */
static RtStatus add_polyhedron(Generator *m, uint32_t *solid) {
    RtPlane planes[10];
    bool half_space = choose(m, 4) == 0;
    uint32_t count = half_space ? 1 : 6 + choose(m, 5);
    for (uint32_t i = 0; i < count; i++) {
        RtVec3d normal = rt_random_direction(m->random);
        if (!half_space && i < 6) normal = rt_vec3d(i / 2 == 0, i / 2 == 1, i / 2 == 2);
        if (!half_space && i < 6 && i % 2) normal = rt_scaled(normal, -1);
        planes[i] = (RtPlane){normal, 1};
    }
    m->endless |= half_space;
    RtTransform place;
    RT_TRY(random_place(m, &place));
    return rt_solid_add_polyhedron(&m->builder->set, planes, count, &place, solid, m->error);
}

/* An octahedron, half of its edges bent inward where it is dented. */
static RtStatus add_mesh(Generator *m, const RtTransform *place, uint32_t *solid) {
    RtTriangle triangles[8];
    float dent = choose(m, 2) ? 0.125f : 1;
    for (uint32_t i = 0; i < 8; i++) {
        float x = i & 1 ? -1 : 1, y = i & 2 ? -1 : 1, z = i & 4 ? -dent : 1;
        bool turned = (x < 0) != ((y < 0) != (z < 0));
        RtVec3 a = {x, 0, 0}, b = {0, y, 0}, c = {0, 0, z};
        triangles[i] = (RtTriangle){{a, turned ? c : b, turned ? b : c}};
    }
    return rt_solid_add_mesh(&m->builder->set, triangles, 8, place, solid, m->error);
}

static RtStatus add_solid(Generator *m, RtCsgTerm *out) {
    RtSolidSet *set = &m->builder->set;
    uint32_t solid, kind = choose(m, m->coarse ? 9 : 6);
    RtTransform place;
    RT_TRY(random_place(m, &place));
    switch (kind) {
    case 0: RT_TRY(rt_solid_add_sphere(set, &place, &solid, m->error)); break;
    case 1: RT_TRY(add_polyhedron(m, &solid)); break;
    case 2: RT_TRY(rt_solid_add_cone(set, choose(m, 5) / 4.0, &place, &solid, m->error)); break;
    case 3:
        RT_TRY(rt_solid_add_torus(set, 0.25 + (double)number(m, 0, 0.5f), &place, &solid, m->error));
        break;
    case 4: RT_TRY(add_mesh(m, &place, &solid)); break;
    default: return add_box(m, out);
    }
    return rt_csg_solid(m->builder, solid, choose(m, m->materials), out, m->error);
}

/* Occasionally moves a term. */
static RtStatus vary(Generator *m, RtCsgTerm *term) {
    RtTransform move = rt_transform_identity();
    if (choose(m, 4)) return RT_OK;
    if (!m->coarse) {
        RtVec3 axis = rt_narrow(rt_random_direction(m->random));
        RT_TRY(rt_transform_rotate(&move, axis, rt_random_betweend(m->random, 0, 360), m->error));
    }
    RT_TRY(rt_transform_translate(&move, vector(m, -1, 1), m->error));
    return rt_csg_move(m->builder, *term, &move, term, m->error);
}

RtStatus rt_random_tree(RtCsgBuilder *builder, RtRandom *random, const RtTreeRecipe *recipe,
                        uint32_t materials, RtCsgTerm *root, RtError *error) {
    assert(recipe->solids >= 1 && recipe->solids <= RT_MAX_RANDOM_TREE);
    Generator m = {builder, random, recipe->coarse, false, materials, error};
    RtCsgTerm terms[RT_MAX_RANDOM_TREE] = {0};
    uint32_t count = recipe->solids;
    for (uint32_t i = 0; i < count; i++) RT_TRY(add_solid(&m, &terms[i]));
    while (count > 1) {
        uint32_t left = choose(&m, count), right = choose(&m, count - 1);
        if (right >= left) right++;
        RtCsgOp op = (RtCsgOp)choose(&m, 3);
        RT_TRY(rt_csg_combine(builder, op, terms[left], terms[right], &terms[left], error));
        RT_TRY(vary(&m, &terms[left]));
        terms[right] = terms[--count];
    }
    *root = terms[0];
    if (!m.endless) return RT_OK;
    RtCsgTerm around;
    RtBox box = {{-4, -4, -4}, {4, 4, 4}};
    RT_TRY(rt_add_box(builder, box, choose(&m, materials), &around, error));
    return rt_csg_combine(builder, RT_CSG_INTERSECTION, *root, around, root, error);
}
