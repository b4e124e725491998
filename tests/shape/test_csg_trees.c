/* SPDX-License-Identifier: Apache-2.0 */
/* shape/csg: whole trees. Extents that change no hit, moves, trees of any depth, and lack of memory. */
#include "csg_testing.h"

#include <pthread.h>

/* ---- extents ---- */

RT_TEST(tests_of_inner_nodes_change_no_bit) {
    RtRandom random = rt_random(5, 0);
    RtTally with = {0}, without = {0};
    for (uint32_t round = 0; round < 200; round++) {
        OWNED_TREES(b, forest);
        RtCsgTerm root = random_term(&b, &random, RT_MAX_RANDOM_TREE, round % 2);
        RtCsg tested, plain;
        assert_ok(rt_csg_compile(&forest, &b, root, true, &tested, error));
        assert_ok(rt_csg_compile(&forest, &b, root, false, &plain, error));
        for (uint32_t i = 0; i < 500; i++) {
            RtRay ray = tree_ray(&random, i);
            if (i % 5 == 0) ray.tmin = 0.5f, ray.tmax = 1;
            RtPreparedRay prepared = prepare(&ray, &tested);
            float t = 0, expected = 0;
            bool hit = rt_csg_hit(&forest, &tested, &prepared, &t, &with);
            assert_int_equal(hit, rt_csg_hit(&forest, &plain, &prepared, &expected, &without));
            if (hit && t != expected) fail_msg("round %u, ray %u", round, i);
            if (!hit) continue;
            RtCsgFacet a = rt_csg_facet(&forest, &tested, &prepared, t);
            RtCsgFacet c = rt_csg_facet(&forest, &plain, &prepared, t);
            assert_int_equal(a.solid - tested.first_solid, c.solid - plain.first_solid);
        }
    }
    assert_true(with.csg_tests <= without.csg_tests && with.extent_tests < without.extent_tests);
}

RT_TEST(a_tree_lies_within_its_extents) {
    RtRandom random = rt_random(6, 0);
    for (uint32_t round = 0; round < 100; round++) {
        OWNED_TREES(b, forest);
        RtCsg tree = compile(&forest, &b, random_term(&b, &random, 12, round % 2));
        RtBall about = rt_csg_ball(&forest, &tree);
        RtVec3d direction = rt_random_direction(&random);
        double reach = rt_csg_support(&forest, &tree, direction);
        for (uint32_t i = 0; i < 200; i++) {
            RtRay ray = tree_ray(&random, i);
            Hits hits = hits_of(&forest, &tree, &ray);
            for (uint32_t h = 0; h < hits.count; h++) {
                RtVec3d p = rt_ray_point(&ray, hits.t[h]);
                assert_true(rt_lengthd(rt_subd(p, about.center)) <= about.radius + 1e-5);
                assert_true(rt_dotd(p, direction) <= reach + 1e-5);
            }
        }
    }
}

/* The reach of an intersection is the lesser of two, which may end before the box does where they do not
 * meet: a gap along the diagonal of boxes that overlap, and one between boxes. */
RT_TEST(a_tree_without_inside_reaches_into_its_box) {
    RtRandom random = rt_random(9, 0);
    static const float apart[2] = {1.3f, 3};
    for (uint32_t i = 0; i < 2; i++) {
        OWNED_TREES(b, forest);
        RtCsgTerm other = ball(&b, rt_vec3(apart[i], apart[i], 0), 0.5f, 0);
        RtCsg tree = compile(&forest, &b, meet(&b, ball(&b, rt_vec3(0, 0, 0), 1, 0), other));
        for (uint32_t k = 0; k < 100; k++) {
            RtVec3d direction = rt_random_direction(&random);
            double least = 0, most = 0, reach = rt_csg_support(&forest, &tree, direction);
            for (int a = 0; a < 3; a++) {
                double lo = direction.at[a] * (double)tree.box.lo.at[a];
                double hi = direction.at[a] * (double)tree.box.hi.at[a];
                least += fmin(lo, hi), most += fmax(lo, hi);
            }
            assert_true(least <= reach && reach <= most);
        }
    }
}

/* ---- transforms ---- */

/* A ball at x = 4 is turned to y = 4 and then moved to x = 8: not the other way round, to y = 12. */
RT_TEST(the_inner_move_comes_first) {
    RtTransform turn = rt_transform_identity(), shift = turn;
    assert_ok(rt_transform_rotate(&turn, rt_vec3(0, 0, 1), 90, error));
    assert_ok(rt_transform_translate(&shift, rt_vec3(8, 0, 0), error));
    for (int joined = 0; joined < 2; joined++) {
        OWNED_TREES(b, forest);
        RtCsgTerm term = ball(&b, rt_vec3(4, 0, 0), 1, 0);
        assert_ok(rt_csg_move(&b, term, &turn, &term, error));
        if (joined) term = join(&b, term, ball(&b, rt_vec3(0, -10, 0), 1, 0));
        assert_ok(rt_csg_move(&b, term, &shift, &term, error));
        RtCsg tree = compile(&forest, &b, term);
        assert_hits(&forest, &tree, ray_along(rt_vec3(0, 4, 0), along_x), 2, (float[]){7, 9});
    }
}

RT_TEST(a_tree_moved_by_powers_of_two_is_met_at_the_same_bits) {
    RtRandom random = rt_random(7, 0);
    for (uint32_t round = 0; round < 60; round++) {
        OWNED_TREES(b, forest);
        RtCsgTerm root = random_boxes(&b, &random, 8), moved;
        RtTransform move = rt_transform_identity();
        RtVec3 by = {16, -8, 4};
        assert_ok(rt_transform_translate(&move, by, error));
        assert_ok(rt_csg_move(&b, root, &move, &moved, error));
        RtCsg here = compile(&forest, &b, root), there = compile(&forest, &b, moved);
        for (uint32_t i = 0; i < 400; i += 2) {
            RtRay ray = tree_ray(&random, i), same = ray;
            same.org = rt_add(ray.org, by);
            Hits expected = hits_of(&forest, &here, &ray), found = hits_of(&forest, &there, &same);
            if (!same_hits(&expected, &found)) fail_msg("round %u, ray %u", round, i);
        }
    }
}

/* A ray moved like the tree meets it at the same t, as far as the rounding of the ray goes. */
RT_TEST(moving_the_tree_and_moving_the_ray_agree) {
    RtRandom random = rt_random(8, 0);
    size_t hits = 0, agreed = 0;
    for (uint32_t round = 0; round < 100; round++) {
        OWNED_TREES(b, forest);
        RtCsgTerm root = random_term(&b, &random, 10, false);
        RtTransform move = rt_transform_identity();
        RtVec3 axis = rt_narrow(rt_random_direction(&random));
        assert_ok(rt_transform_rotate(&move, axis, rt_random_betweend(&random, 0, 360), error));
        assert_ok(rt_transform_scale(&move, rt_vec3(1.5f, 0.5f, 2), error));
        assert_ok(rt_transform_translate(&move, rt_vec3(1, 2, 3), error));
        RtCsg here = compile(&forest, &b, root), there = copied(&forest, &forest, &here, &move);
        for (uint32_t i = 1; i < 400; i += 2) {
            RtRay ray = tree_ray(&random, i), same = ray;
            same.org = rt_transform_point(&move, ray.org);
            same.dir = rt_sub(rt_transform_point(&move, rt_add(ray.org, ray.dir)), same.org);
            Hits expected = hits_of(&forest, &here, &ray), found = hits_of(&forest, &there, &same);
            for (uint32_t h = 0; h < expected.count; h++) {
                bool near = found.count == expected.count &&
                            fabsf(found.t[h] - expected.t[h]) <= 2e-5f * (1 + expected.t[h]);
                hits++;
                agreed += near;
            }
        }
    }
    /* A ray by an edge may meet it or not. */
    if (agreed < hits - hits / 500) fail_msg("%zu of %zu hits agree", agreed, hits);
    assert_true(hits > 1000);
}

RT_TEST(a_copied_tree_is_the_same_tree) {
    RtRandom random = rt_random(9, 0);
    for (uint32_t round = 0; round < 50; round++) {
        OWNED_BUILDER b = {0};
        OWNED_FOREST forest = {0}, other = {0};
        RtCsg tree = compile(&forest, &b, random_term(&b, &random, 30, round % 2));
        RtCsg copy = copied(&other, &forest, &tree, NULL);
        assert_int_equal(copy.count, tree.count);
        assert_int_equal(copy.solid_count, tree.solid_count);
        assert_memory_equal(&copy.box, &tree.box, sizeof copy.box);
        for (uint32_t i = 0; i < tree.solid_count; i++) {
            const RtSolid *from = &forest.set.solids[tree.first_solid + i], *to = &other.set.solids[i];
            assert_true(from->material == to->material && from->subtracted == to->subtracted);
        }
        for (uint32_t i = 0; i < 100; i++) {
            RtRay ray = tree_ray(&random, i);
            Hits expected = hits_of(&forest, &tree, &ray), found = hits_of(&other, &copy, &ray);
            assert_true(same_hits(&expected, &found));
        }
    }
}

/* ---- deep trees ---- */

#define DEEP         10000
#define LITTLE_STACK ((size_t)128 * 1024) /* the least that 64-bit ARM admits */

typedef enum DeepShape { LEFT_DEEP, RIGHT_DEEP, BALANCED } DeepShape;

/* Unit balls at x = 0, 1, 2, ...; with `drilled`, the next one is subtracted from each. */
static RtCsgTerm deep_tree(RtCsgBuilder *b, DeepShape shape, RtCsgOp op) {
    static RtCsgTerm terms[DEEP];
    for (uint32_t i = 0; i < DEEP; i++) terms[i] = ball(b, rt_vec3((float)i, 0, 0), 1, 0);
    if (shape == BALANCED) {
        for (uint32_t count = DEEP; count > 1; count = (count + 1) / 2) {
            for (uint32_t i = 0; i < count / 2; i++)
                terms[i] = combine(b, op, terms[2 * i], terms[2 * i + 1]);
            if (count % 2) terms[count / 2] = terms[count - 1];
        }
        return terms[0];
    }
    RtCsgTerm term = terms[shape == LEFT_DEEP ? 0 : DEEP - 1];
    for (uint32_t i = 1; i < DEEP; i++)
        term =
            shape == LEFT_DEEP ? combine(b, op, term, terms[i]) : combine(b, op, terms[DEEP - 1 - i], term);
    return term;
}

static void check_deep(DeepShape shape, RtCsgOp op) {
    OWNED_TREES(b, forest);
    RtCsg tree = compile(&forest, &b, deep_tree(&b, shape, op));
    assert_true(rt_csg_forest_bytes(&forest) < (uint64_t)DEEP * 2000);
    assert_int_equal(tree.most_crossings, 4 * DEEP);
    /* A line that meets the first two balls, then many that meet one ball, and one that meets all. */
    RtRay ray = ray_along(rt_vec3(0.25f, 0, 3), rt_vec3(0, 0, -1));
    Hits hits = hits_of(&forest, &tree, &ray);
    assert_int_equal(hits.count, op == RT_CSG_UNION ? 2 : op == RT_CSG_DIFFERENCE ? 4 : 0);
    for (uint32_t i = 1; i < 20; i++) {
        ray.org.x = (float)(i * 499);
        hits = hits_of(&forest, &tree, &ray);
        assert_int_equal(hits.count, op == RT_CSG_UNION ? 2 : 0);
    }
    ray = ray_along(rt_vec3(-3, 0, 0.75f), along_x);
    hits = hits_of(&forest, &tree, &ray);
    assert_int_equal(hits.count, op == RT_CSG_INTERSECTION ? 0 : 2);
}

static void a_tree_of_depth_10000_takes_little_memory_and_little_stack(void **state) {
    (void)state;
    for (int shape = 0; shape < 3; shape++) {
        for (int op = 0; op < 3; op++) check_deep((DeepShape)shape, (RtCsgOp)op);
    }
}

/* Deep trees are tested by a thread with a stack of its own. */
static void *run_on_little_stack(void *failed) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tree_of_depth_10000_takes_little_memory_and_little_stack),
    };
    *(int *)failed = cmocka_run_group_tests_name("deep", tests, NULL, NULL);
    return NULL;
}

static int run_deep(void) {
    pthread_attr_t attributes;
    pthread_t thread;
    int failed = 1;
    if (pthread_attr_init(&attributes) != 0) return 1;
    if (pthread_attr_setstacksize(&attributes, LITTLE_STACK) == 0 &&
        pthread_create(&thread, &attributes, run_on_little_stack, &failed) == 0) {
        pthread_join(thread, NULL);
    }
    pthread_attr_destroy(&attributes);
    return failed;
}

/* ---- memory ---- */

static RtStatus compile_anew(const RtCsgBuilder *b, RtCsgTerm root, RtError *error) {
    OWNED_FOREST forest = {0};
    RtCsg tree;
    const RtStatus status = rt_csg_compile(&forest, b, root, true, &tree, error);
    if (status != RT_OK)
        assert_int_equal(forest.set.solid_count + forest.instruction_count + forest.box_count, 0);
    return status;
}

RT_TEST(compiling_fails_cleanly_at_every_allocation) {
    RtRandom random = rt_random(10, 0);
    OWNED_BUILDER b = {0};
    const RtCsgTerm root = random_term(&b, &random, RT_MAX_RANDOM_TREE, false);
    assert_fails_cleanly(compile_anew(&b, root, error), (void)0);
}

RT_TEST_GROUP(csg_trees) {
    return RT_RUN_TESTS("csg_trees", NULL, NULL) + run_deep();
}
