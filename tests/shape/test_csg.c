/* SPDX-License-Identifier: Apache-2.0 */
/* shape/csg: the result of each operation, faces and materials, rejected trees, and the identities of
 * sets. Hits are compared bit for bit, over random rays through random trees. */
#include "csg_testing.h"

#include "core/scene/formula.h"

/* ---- by hand ---- */

RT_TEST(each_operation_keeps_its_part_of_two_boxes) {
    OWNED_TREES(b, forest);
    RtCsgTerm left = box(&b, rt_vec3(0, 0, 0), rt_vec3(2, 1, 1), 0);
    RtCsgTerm right = box(&b, rt_vec3(1, 0, 0), rt_vec3(3, 1, 1), 1);
    RtRay ray = ray_along(rt_vec3(-1, 0.5f, 0.5f), along_x);
    RtCsg tree = compile(&forest, &b, join(&b, left, right));
    assert_hits(&forest, &tree, ray, 2, (float[]){1, 4});
    tree = compile(&forest, &b, meet(&b, left, right));
    assert_hits(&forest, &tree, ray, 2, (float[]){2, 3});
    tree = compile(&forest, &b, cut(&b, left, right));
    assert_hits(&forest, &tree, ray, 2, (float[]){1, 2});
    tree = compile(&forest, &b, cut(&b, right, left));
    assert_hits(&forest, &tree, ray, 2, (float[]){3, 4});
}

RT_TEST(touching_boxes_are_joined_without_a_wall) {
    OWNED_TREES(b, forest);
    RtCsgTerm left = box(&b, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), 0);
    RtCsgTerm right = box(&b, rt_vec3(1, 0, 0), rt_vec3(2, 1, 1), 1);
    RtCsg joined = compile(&forest, &b, join(&b, left, right));
    assert_hits(&forest, &joined, ray_along(rt_vec3(-1, 0.5f, 0.25f), along_x), 2, (float[]){1, 3});
    assert_hits(&forest, &joined, ray_along(rt_vec3(0.25f, 0.5f, 0.25f), along_x), 1, (float[]){1.75f});
    RtCsg common = compile(&forest, &b, meet(&b, left, right));
    assert_hits(&forest, &common, ray_along(rt_vec3(-1, 0.5f, 0.25f), along_x), 0, NULL);
    RtCsg rest = compile(&forest, &b, cut(&b, left, right));
    assert_hits(&forest, &rest, ray_along(rt_vec3(-1, 0.5f, 0.25f), along_x), 2, (float[]){1, 2});
}

/* Where the ray along x meets the tree, with the normals along x and the materials there. */
static void assert_faces(const RtCsgForest *forest, const RtCsg *tree, RtRay ray, uint32_t count,
                         const float *t, const double *normals, const uint32_t *materials) {
    assert_hits(forest, tree, ray, count, t);
    for (uint32_t i = 0; i < count; i++) {
        RtCsgFacet facet = facet_at(forest, tree, &ray, t[i]);
        assert_true(facet.normal.x == normals[i] && facet.normal.y == 0 && facet.normal.z == 0);
        assert_int_equal(forest->set.solids[facet.solid].material, materials[i]);
    }
}

RT_TEST(the_wall_of_a_drilled_hole_looks_into_the_hole) {
    OWNED_TREES(b, forest);
    RtCsgTerm plate = box(&b, rt_vec3(-2, -2, -1), rt_vec3(2, 2, 1), 1);
    RtCsg tree = compile(&forest, &b, cut(&b, plate, ball(&b, rt_vec3(0, 0, 0), 1, 2)));
    assert_faces(&forest, &tree, ray_along(rt_vec3(-4, 0, 0), along_x), 4, (float[]){2, 3, 5, 6},
                 (double[]){-1, 1, -1, 1}, (uint32_t[]){1, 2, 2, 1});
}

RT_TEST(what_is_taken_from_what_is_taken_away_looks_outward_again) {
    OWNED_TREES(b, forest);
    RtCsgTerm hole = cut(&b, ball(&b, rt_vec3(0, 0, 0), 2, 2), ball(&b, rt_vec3(0, 0, 0), 1, 3));
    RtCsgTerm all = cut(&b, box(&b, rt_vec3(-4, -4, -4), rt_vec3(4, 4, 4), 1), hole);
    RtCsg tree = compile(&forest, &b, all);
    assert_faces(&forest, &tree, ray_along(rt_vec3(0, 0, 0), along_x), 3, (float[]){1, 2, 4},
                 (double[]){1, -1, 1}, (uint32_t[]){3, 2, 1});
}

RT_TEST(the_left_operand_names_a_face_that_both_have) {
    OWNED_TREES(b, forest);
    RtCsgTerm a = box(&b, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), 1);
    RtCsgTerm c = box(&b, rt_vec3(0, 0, 0), rt_vec3(2, 1, 1), 2);
    RtRay ray = ray_along(rt_vec3(-1, 0.5f, 0.5f), along_x);
    for (int op = 0; op < 2; op++) {
        for (int swapped = 0; swapped < 2; swapped++) {
            RtCsg tree = compile(&forest, &b, combine(&b, (RtCsgOp)op, swapped ? c : a, swapped ? a : c));
            ray.tmax = 1;
            assert_faces(&forest, &tree, ray, 1, (float[]){1}, (double[]){-1}, (uint32_t[]){swapped ? 2 : 1});
        }
    }
}

RT_TEST(an_empty_result_is_a_point_and_never_hit) {
    OWNED_TREES(b, forest);
    RtCsgTerm near = box(&b, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), 0);
    RtCsgTerm far = box(&b, rt_vec3(2, 0, 0), rt_vec3(3, 1, 1), 0);
    RtCsg tree = compile(&forest, &b, meet(&b, near, far));
    assert_true(memcmp(&tree.box.lo, &tree.box.hi, sizeof tree.box.lo) == 0);
    RtRay through = ray_along(rt_vec3(tree.box.lo.x - 1, tree.box.lo.y, tree.box.lo.z), along_x);
    assert_hits(&forest, &tree, through, 0, NULL);
}

RT_TEST(a_ray_is_answered_within_its_interval_only) {
    OWNED_TREES(b, forest);
    RtCsg tree = compile(&forest, &b, box(&b, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), 0));
    RtRay ray = ray_along(rt_vec3(-1, 0.5f, 0.5f), along_x);
    ray.tmin = 1, ray.tmax = 1;
    assert_hits(&forest, &tree, ray, 1, (float[]){1});
    ray.tmin = 1.25f, ray.tmax = 1.75f;
    assert_hits(&forest, &tree, ray, 0, NULL);
    ray.tmin = 1.25f, ray.tmax = 2;
    assert_hits(&forest, &tree, ray, 1, (float[]){2});
}

RT_TEST(a_tree_without_end_is_refused_and_leaves_nothing_behind) {
    OWNED_TREES(b, forest);
    RtPlane floor = {{0, 0, 1}, 0};
    uint32_t solid;
    RtCsgTerm half;
    assert_ok(rt_solid_add_polyhedron(&b.set, &floor, 1, NULL, &solid, error));
    assert_ok(rt_csg_solid(&b, solid, 0, &half, error));
    RtCsgTerm unit = ball(&b, rt_vec3(0, 0, 0), 1, 0);
    RtCsg tree;
    const RtCsgTerm endless[3] = {half, join(&b, unit, half), cut(&b, half, unit)};
    for (int i = 0; i < 3; i++) {
        assert_bad_input(rt_csg_compile(&forest, &b, endless[i], true, &tree, error), "unbounded");
        assert_int_equal(forest.set.solid_count + forest.set.plane_count + forest.instruction_count, 0);
    }
    tree = compile(&forest, &b, meet(&b, unit, half));
    assert_hits(&forest, &tree, ray_along(rt_vec3(0, 0, 3), rt_vec3(0, 0, -1)), 2, (float[]){3, 4});
    assert_true(tree.box.hi.z == 0);
    tree = compile(&forest, &b, cut(&b, unit, half));
    assert_hits(&forest, &tree, ray_along(rt_vec3(0, 0, 3), rt_vec3(0, 0, -1)), 2, (float[]){2, 3});
}

RT_TEST(a_tree_of_too_many_solids_is_refused) {
    OWNED_BUILDER b = {0};
    RtCsgTerm term = ball(&b, rt_vec3(0, 0, 0), 1, 0);
    RtError error;
    RtStatus status = RT_OK;
    for (int i = 0; i < 100 && status == RT_OK; i++)
        status = rt_csg_combine(&b, RT_CSG_UNION, term, term, &term, &error);
    assert_int_equal(status, RT_BAD_INPUT);
    assert_int_equal(b.nodes[term].size, RT_CSG_MAX_SOLIDS);
    assert_non_null(strstr(error.message, "the limit is 16777216"));
}

/* ---- identities ---- */

/* Three random terms, a box around them all, and an empty set. */
enum { A, B, C, U, O, TERMS };
static const char names[] = "abcuo";

static const char *const identities[][2] = {
    {"a | b", "b | a"},
    {"a & b", "b & a"},
    {"a | (b | c)", "(a | b) | c"},
    {"a & (b & c)", "(a & b) & c"},
    {"u - (a | b)", "(u - a) & (u - b)"}, /* De Morgan */
    {"u - (a & b)", "(u - a) | (u - b)"},
    {"a & (b | c)", "(a & b) | (a & c)"},
    {"a - b", "a & (u - b)"},
    {"a", "a | a"},
    {"a", "a & a"},
    {"o", "a - a"},
};

static RtStatus find_term(void *terms, const char *name, RtCsgTerm *term, RtError *error) {
    (void)error;
    *term = ((const RtCsgTerm *)terms)[strchr(names, *name) - names];
    return RT_OK;
}

static RtCsg compile_formula(RtCsgForest *forest, RtCsgBuilder *b, RtCsgTerm terms[TERMS],
                             const char *formula) {
    RtCsgTerm root;
    assert_ok(rt_formula_read(formula, b, find_term, terms, &root, error));
    return compile(forest, b, root);
}

/* Both sides have the same hits. */
static void check_identity(const char *const sides[2], uint64_t seed) {
    RtRandom random = rt_random(seed, 0);
    for (uint32_t round = 0; round < 60; round++) {
        OWNED_TREES(b, forest);
        RtCsgTerm terms[TERMS];
        for (int i = A; i <= C; i++) terms[i] = random_term(&b, &random, 6, round % 2);
        terms[U] = box(&b, rt_vec3(-9, -9, -9), rt_vec3(9, 9, 9), 0);
        terms[O] = meet(&b, box(&b, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), 0),
                        box(&b, rt_vec3(2, 2, 2), rt_vec3(3, 3, 3), 0));
        RtCsg one = compile_formula(&forest, &b, terms, sides[0]);
        RtCsg other = compile_formula(&forest, &b, terms, sides[1]);
        for (uint32_t i = 0; i < 400; i++) {
            RtRay ray = tree_ray(&random, i);
            Hits expected = hits_of(&forest, &one, &ray), found = hits_of(&forest, &other, &ray);
            if (!same_hits(&expected, &found))
                fail_msg("%s = %s, round %u, ray %u", sides[0], sides[1], round, i);
        }
    }
}

RT_TEST(identities_of_sets_hold_bit_for_bit) {
    for (size_t i = 0; i < sizeof identities / sizeof *identities; i++) check_identity(identities[i], i);
}

RT_TESTS(csg, NULL, NULL)
