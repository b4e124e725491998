/* shape/csg: the identities of sets, faces and materials, extents that change nothing, and trees of any
 * depth. Hits are compared by their bits, over random rays through random trees (experiments/random_tree). */
#include "testing.h"

#include "base/memory.h"
#include "experiments/random_tree.h"
#include "experiments/rayset.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

/* ---- helpers ---- */

#define MAX_HITS 512

/* Where the line of a ray goes in and out of a tree, for t >= tmin. */
typedef struct Hits {
    uint32_t count;
    float t[MAX_HITS];
} Hits;

static Hits hits_of(const RtCsgForest *forest, const RtCsg *tree, const RtRay *ray) {
    Hits hits = {.count = 0};
    RtRay rest = *ray;
    RtPreparedRay prepared = rt_ray_prepare(&rest, &tree->box);
    while (hits.count < MAX_HITS && rt_csg_hit(forest, tree, &prepared, &hits.t[hits.count], NULL)) {
        rest.tmin = nextafterf(hits.t[hits.count++], INFINITY);
        prepared = rt_ray_prepare(&rest, &tree->box);
    }
    return hits;
}

static bool same_hits(const Hits *a, const Hits *b) {
    return a->count == b->count && memcmp(a->t, b->t, a->count * sizeof(float)) == 0;
}

static RtCsg plant(RtCsgForest *forest, const RtCsgBuilder *builder, RtCsgTerm root) {
    RtCsg tree;
    assert_ok(rt_csg_plant(forest, builder, root, true, &tree, error));
    return tree;
}

static RtCsgTerm combine(RtCsgBuilder *builder, RtCsgOp op, RtCsgTerm left, RtCsgTerm right) {
    RtCsgTerm term;
    assert_ok(rt_csg_combine(builder, op, left, right, &term, error));
    return term;
}

static RtCsgTerm join(RtCsgBuilder *b, RtCsgTerm left, RtCsgTerm right) {
    return combine(b, RT_CSG_UNION, left, right);
}

static RtCsgTerm meet(RtCsgBuilder *b, RtCsgTerm left, RtCsgTerm right) {
    return combine(b, RT_CSG_INTERSECTION, left, right);
}

static RtCsgTerm cut(RtCsgBuilder *b, RtCsgTerm left, RtCsgTerm right) {
    return combine(b, RT_CSG_DIFFERENCE, left, right);
}

static RtCsgTerm box(RtCsgBuilder *builder, RtVec3 lo, RtVec3 hi, uint32_t material) {
    RtCsgTerm term;
    assert_ok(rt_add_box(builder, (RtBox){lo, hi}, material, &term, error));
    return term;
}

static RtCsgTerm ball(RtCsgBuilder *builder, RtVec3 center, float radius, uint32_t material) {
    RtTransform place = rt_transform_identity();
    uint32_t solid;
    RtCsgTerm term;
    assert_ok(rt_transform_scale(&place, rt_vec3(radius, radius, radius), error));
    assert_ok(rt_transform_translate(&place, center, error));
    assert_ok(rt_solid_add_sphere(&builder->set, &place, &solid, error));
    assert_ok(rt_csg_solid(builder, solid, material, &term, error));
    return term;
}

static RtCsgTerm random_term(RtCsgBuilder *builder, RtRandom *random, uint32_t most, bool coarse) {
    RtTreeRecipe recipe = {1 + rt_random_bits(random) % most, coarse};
    RtCsgTerm term;
    assert_ok(rt_random_tree(builder, random, &recipe, 4, &term, error));
    return term;
}

/* Boxes at halves, under random operations: all arithmetic on them is exact. */
static RtCsgTerm random_boxes(RtCsgBuilder *builder, RtRandom *random, uint32_t count) {
    RtCsgTerm term = 0;
    for (uint32_t i = 0; i < count; i++) {
        RtVec3 lo, hi;
        for (int a = 0; a < 3; a++) {
            lo.at[a] = 0.5f * (float)(rt_random_bits(random) % 8) - 3;
            hi.at[a] = lo.at[a] + 0.5f * (float)(1 + rt_random_bits(random) % 8);
        }
        RtCsgTerm next = box(builder, lo, hi, i);
        term = i == 0 ? next : combine(builder, (RtCsgOp)(rt_random_bits(random) % 3), term, next);
    }
    return term;
}

/* Random chords; every other one from a point and towards a point of a grid of halves, so that it meets edges
 * and corners, runs along faces, and starts on them or inside. */
static RtRay random_ray(RtRandom *random, uint32_t i) {
    const RtBall around = {{0, 0, 0}, 9};
    if (i % 2) return rt_sphere_chord(&around, random);
    RtRay ray = {.tmax = INFINITY};
    for (int a = 0; a < 3; a++) {
        ray.org.at[a] = 0.5f * (float)(rt_random_bits(random) % 25) - 6;
        ray.dir.at[a] = 0.5f * (float)(rt_random_bits(random) % 9) - 2;
    }
    if (ray.dir.x == 0 && ray.dir.y == 0 && ray.dir.z == 0) ray.dir.x = 1;
    return ray;
}

static RtRay ray_along(RtVec3 org, RtVec3 dir) {
    return (RtRay){.org = org, .dir = dir, .tmax = INFINITY};
}

static void assert_hits(const RtCsgForest *forest, const RtCsg *tree, RtRay ray, uint32_t count,
                        const float *t) {
    Hits hits = hits_of(forest, tree, &ray);
    assert_int_equal(hits.count, count);
    for (uint32_t i = 0; i < count; i++) {
        if (hits.t[i] != t[i]) fail_msg("hit %u: %.9g, not %.9g", i, (double)hits.t[i], (double)t[i]);
    }
}

static RtCsgFacet facet_at(const RtCsgForest *forest, const RtCsg *tree, const RtRay *ray, float t) {
    RtPreparedRay prepared = rt_ray_prepare(ray, &tree->box);
    return rt_csg_facet(forest, tree, &prepared, t);
}

static void clear(RtCsgForest *forest, RtCsgBuilder *builder) {
    rt_csg_forest_clear(forest);
    rt_csg_builder_clear(builder);
}

/* ---- by hand ---- */

static const RtVec3 along_x = {1, 0, 0};

static void each_operation_keeps_its_part_of_two_boxes(void **state) {
    (void)state;
    RtCsgBuilder b = {0};
    RtCsgForest forest = {0};
    RtCsgTerm left = box(&b, rt_vec3(0, 0, 0), rt_vec3(2, 1, 1), 0);
    RtCsgTerm right = box(&b, rt_vec3(1, 0, 0), rt_vec3(3, 1, 1), 1);
    RtRay ray = ray_along(rt_vec3(-1, 0.5f, 0.5f), along_x);
    RtCsg tree = plant(&forest, &b, join(&b, left, right));
    assert_hits(&forest, &tree, ray, 2, (float[]){1, 4});
    tree = plant(&forest, &b, meet(&b, left, right));
    assert_hits(&forest, &tree, ray, 2, (float[]){2, 3});
    tree = plant(&forest, &b, cut(&b, left, right));
    assert_hits(&forest, &tree, ray, 2, (float[]){1, 2});
    tree = plant(&forest, &b, cut(&b, right, left));
    assert_hits(&forest, &tree, ray, 2, (float[]){3, 4});
    clear(&forest, &b);
}

static void touching_boxes_are_joined_without_a_wall(void **state) {
    (void)state;
    RtCsgBuilder b = {0};
    RtCsgForest forest = {0};
    RtCsgTerm left = box(&b, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), 0);
    RtCsgTerm right = box(&b, rt_vec3(1, 0, 0), rt_vec3(2, 1, 1), 1);
    RtCsg joined = plant(&forest, &b, join(&b, left, right));
    assert_hits(&forest, &joined, ray_along(rt_vec3(-1, 0.5f, 0.25f), along_x), 2, (float[]){1, 3});
    assert_hits(&forest, &joined, ray_along(rt_vec3(0.25f, 0.5f, 0.25f), along_x), 1, (float[]){1.75f});
    RtCsg common = plant(&forest, &b, meet(&b, left, right));
    assert_hits(&forest, &common, ray_along(rt_vec3(-1, 0.5f, 0.25f), along_x), 0, NULL);
    RtCsg rest = plant(&forest, &b, cut(&b, left, right));
    assert_hits(&forest, &rest, ray_along(rt_vec3(-1, 0.5f, 0.25f), along_x), 2, (float[]){1, 2});
    clear(&forest, &b);
}

static void the_wall_of_a_drilled_hole_looks_into_the_hole(void **state) {
    (void)state;
    RtCsgBuilder b = {0};
    RtCsgForest forest = {0};
    RtCsgTerm plate = box(&b, rt_vec3(-2, -2, -1), rt_vec3(2, 2, 1), 1);
    RtCsg tree = plant(&forest, &b, cut(&b, plate, ball(&b, rt_vec3(0, 0, 0), 1, 2)));
    RtRay ray = ray_along(rt_vec3(-4, 0, 0), along_x);
    assert_hits(&forest, &tree, ray, 4, (float[]){2, 3, 5, 6});
    const double normals[4] = {-1, 1, -1, 1};
    const uint32_t materials[4] = {1, 2, 2, 1};
    for (int i = 0; i < 4; i++) {
        RtCsgFacet facet = facet_at(&forest, &tree, &ray, (float[]){2, 3, 5, 6}[i]);
        assert_true(facet.normal.x == normals[i] && facet.normal.y == 0 && facet.normal.z == 0);
        assert_int_equal(forest.set.solids[facet.solid].material, materials[i]);
    }
    clear(&forest, &b);
}

static void what_is_taken_from_what_is_taken_away_looks_outward_again(void **state) {
    (void)state;
    RtCsgBuilder b = {0};
    RtCsgForest forest = {0};
    RtCsgTerm hole = cut(&b, ball(&b, rt_vec3(0, 0, 0), 2, 2), ball(&b, rt_vec3(0, 0, 0), 1, 3));
    RtCsgTerm all = cut(&b, box(&b, rt_vec3(-4, -4, -4), rt_vec3(4, 4, 4), 1), hole);
    RtCsg tree = plant(&forest, &b, all);
    RtRay ray = ray_along(rt_vec3(0, 0, 0), along_x);
    assert_hits(&forest, &tree, ray, 3, (float[]){1, 2, 4});
    const double normals[3] = {1, -1, 1};
    for (int i = 0; i < 3; i++) {
        RtCsgFacet facet = facet_at(&forest, &tree, &ray, (float[]){1, 2, 4}[i]);
        assert_true(facet.normal.x == normals[i]);
        assert_int_equal(forest.set.solids[facet.solid].material, 3 - i);
    }
    clear(&forest, &b);
}

static void the_left_operand_names_a_face_that_both_have(void **state) {
    (void)state;
    RtCsgBuilder b = {0};
    RtCsgForest forest = {0};
    RtCsgTerm a = box(&b, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), 1);
    RtCsgTerm c = box(&b, rt_vec3(0, 0, 0), rt_vec3(2, 1, 1), 2);
    RtRay ray = ray_along(rt_vec3(-1, 0.5f, 0.5f), along_x);
    for (int op = 0; op < 2; op++) {
        for (int swapped = 0; swapped < 2; swapped++) {
            RtCsg tree = plant(&forest, &b, combine(&b, (RtCsgOp)op, swapped ? c : a, swapped ? a : c));
            RtCsgFacet facet = facet_at(&forest, &tree, &ray, 1);
            assert_int_equal(forest.set.solids[facet.solid].material, swapped ? 2 : 1);
            assert_true(facet.normal.x == -1);
        }
    }
    clear(&forest, &b);
}

static void an_empty_result_is_a_point_and_never_hit(void **state) {
    (void)state;
    RtCsgBuilder b = {0};
    RtCsgForest forest = {0};
    RtCsgTerm near = box(&b, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), 0);
    RtCsgTerm far = box(&b, rt_vec3(2, 0, 0), rt_vec3(3, 1, 1), 0);
    RtCsg tree = plant(&forest, &b, meet(&b, near, far));
    assert_true(memcmp(&tree.box.lo, &tree.box.hi, sizeof tree.box.lo) == 0);
    RtRay through = ray_along(rt_vec3(tree.box.lo.x - 1, tree.box.lo.y, tree.box.lo.z), along_x);
    assert_hits(&forest, &tree, through, 0, NULL);
    clear(&forest, &b);
}

static void a_ray_is_answered_within_its_interval_only(void **state) {
    (void)state;
    RtCsgBuilder b = {0};
    RtCsgForest forest = {0};
    RtCsg tree = plant(&forest, &b, box(&b, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), 0));
    RtRay ray = ray_along(rt_vec3(-1, 0.5f, 0.5f), along_x);
    ray.tmin = 1, ray.tmax = 1;
    assert_hits(&forest, &tree, ray, 1, (float[]){1});
    ray.tmin = 1.25f, ray.tmax = 1.75f;
    assert_hits(&forest, &tree, ray, 0, NULL);
    ray.tmin = 1.25f, ray.tmax = 2;
    assert_hits(&forest, &tree, ray, 1, (float[]){2});
    clear(&forest, &b);
}

static void a_tree_without_end_is_refused_and_leaves_nothing_behind(void **state) {
    (void)state;
    RtCsgBuilder b = {0};
    RtCsgForest forest = {0};
    RtTransform place = rt_transform_identity();
    RtPlane floor = {{0, 0, 1}, 0};
    uint32_t solid;
    RtCsgTerm half;
    assert_ok(rt_solid_add_polyhedron(&b.set, &floor, 1, &place, &solid, error));
    assert_ok(rt_csg_solid(&b, solid, 0, &half, error));
    RtCsgTerm unit = ball(&b, rt_vec3(0, 0, 0), 1, 0);
    RtCsg tree;
    RtError error;
    const RtCsgTerm endless[3] = {half, join(&b, unit, half), cut(&b, half, unit)};
    for (int i = 0; i < 3; i++) {
        assert_int_equal(rt_csg_plant(&forest, &b, endless[i], true, &tree, &error), RT_BAD_INPUT);
        assert_non_null(strstr(error.message, "no end"));
        assert_int_equal(forest.set.solid_count + forest.set.plane_count + forest.instruction_count, 0);
    }
    tree = plant(&forest, &b, meet(&b, unit, half));
    assert_hits(&forest, &tree, ray_along(rt_vec3(0, 0, 3), rt_vec3(0, 0, -1)), 2, (float[]){3, 4});
    assert_true(tree.box.hi.z == 0);
    tree = plant(&forest, &b, cut(&b, unit, half));
    assert_hits(&forest, &tree, ray_along(rt_vec3(0, 0, 3), rt_vec3(0, 0, -1)), 2, (float[]){2, 3});
    clear(&forest, &b);
}

static void a_tree_of_too_many_solids_is_refused(void **state) {
    (void)state;
    RtCsgBuilder b = {0};
    RtCsgTerm term = ball(&b, rt_vec3(0, 0, 0), 1, 0);
    RtError error;
    RtStatus status = RT_OK;
    for (int i = 0; i < 100 && status == RT_OK; i++) {
        status = rt_csg_combine(&b, RT_CSG_UNION, term, term, &term, &error);
    }
    assert_int_equal(status, RT_BAD_INPUT);
    assert_int_equal(b.nodes[term].size, RT_CSG_MAX_SOLIDS);
    assert_non_null(strstr(error.message, "at most 16777216"));
    rt_csg_builder_clear(&b);
}

/* ---- identities ---- */

typedef RtCsgTerm Side(RtCsgBuilder *b, const RtCsgTerm *terms, bool right_side);

/* Both sides of an identity, made of three random terms and a box about all of them, give the same hits. */
static void check_identity(Side *side, uint64_t seed) {
    RtRandom random = rt_random(seed, 0);
    for (uint32_t round = 0; round < 60; round++) {
        RtCsgBuilder b = {0};
        RtCsgForest forest = {0};
        RtCsgTerm terms[4];
        for (int i = 0; i < 3; i++) terms[i] = random_term(&b, &random, 6, round % 2);
        terms[3] = box(&b, rt_vec3(-9, -9, -9), rt_vec3(9, 9, 9), 0);
        RtCsg one = plant(&forest, &b, side(&b, terms, false)),
              other = plant(&forest, &b, side(&b, terms, true));
        for (uint32_t i = 0; i < 400; i++) {
            RtRay ray = random_ray(&random, i);
            Hits expected = hits_of(&forest, &one, &ray), found = hits_of(&forest, &other, &ray);
            if (!same_hits(&expected, &found)) fail_msg("round %u, ray %u", round, i);
        }
        clear(&forest, &b);
    }
}

static RtCsgTerm commuted_union(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    return right ? join(b, t[1], t[0]) : join(b, t[0], t[1]);
}

static RtCsgTerm commuted_intersection(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    return right ? meet(b, t[1], t[0]) : meet(b, t[0], t[1]);
}

static RtCsgTerm associated_union(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    return right ? join(b, join(b, t[0], t[1]), t[2]) : join(b, t[0], join(b, t[1], t[2]));
}

static RtCsgTerm associated_intersection(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    return right ? meet(b, meet(b, t[0], t[1]), t[2]) : meet(b, t[0], meet(b, t[1], t[2]));
}

static RtCsgTerm de_morgan(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    RtCsgTerm all = t[3];
    return right ? meet(b, cut(b, all, t[0]), cut(b, all, t[1])) : cut(b, all, join(b, t[0], t[1]));
}

static RtCsgTerm de_morgan_dual(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    RtCsgTerm all = t[3];
    return right ? join(b, cut(b, all, t[0]), cut(b, all, t[1])) : cut(b, all, meet(b, t[0], t[1]));
}

static RtCsgTerm distributed(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    return right ? join(b, meet(b, t[0], t[1]), meet(b, t[0], t[2])) : meet(b, t[0], join(b, t[1], t[2]));
}

static RtCsgTerm difference_by_complement(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    return right ? meet(b, t[0], cut(b, t[3], t[1])) : cut(b, t[0], t[1]);
}

static RtCsgTerm joined_with_itself(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    return right ? join(b, t[0], t[0]) : t[0];
}

static RtCsgTerm met_with_itself(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    return right ? meet(b, t[0], t[0]) : t[0];
}

static RtCsgTerm less_itself(RtCsgBuilder *b, const RtCsgTerm *t, bool right) {
    RtCsgTerm nothing =
        meet(b, box(b, rt_vec3(0, 0, 0), rt_vec3(1, 1, 1), 0), box(b, rt_vec3(2, 2, 2), rt_vec3(3, 3, 3), 0));
    return right ? cut(b, t[0], t[0]) : nothing;
}

static void identities_of_sets_hold_bit_for_bit(void **state) {
    (void)state;
    Side *const sides[] = {
        commuted_union,     commuted_intersection, associated_union, associated_intersection,
        de_morgan,          de_morgan_dual,        distributed,      difference_by_complement,
        joined_with_itself, met_with_itself,       less_itself};
    for (size_t i = 0; i < sizeof sides / sizeof *sides; i++) check_identity(sides[i], i);
}

/* ---- extents ---- */

static void tests_of_inner_nodes_change_no_bit(void **state) {
    (void)state;
    RtRandom random = rt_random(5, 0);
    RtTally with = {0}, without = {0};
    for (uint32_t round = 0; round < 200; round++) {
        RtCsgBuilder b = {0};
        RtCsgForest forest = {0};
        RtCsgTerm root = random_term(&b, &random, RT_MAX_RANDOM_TREE, round % 2);
        RtCsg tested, plain;
        assert_ok(rt_csg_plant(&forest, &b, root, true, &tested, error));
        assert_ok(rt_csg_plant(&forest, &b, root, false, &plain, error));
        for (uint32_t i = 0; i < 500; i++) {
            RtRay ray = random_ray(&random, i);
            if (i % 5 == 0) ray.tmin = 0.5f, ray.tmax = 1;
            RtPreparedRay prepared = rt_ray_prepare(&ray, &tested.box);
            float t = 0, expected = 0;
            bool hit = rt_csg_hit(&forest, &tested, &prepared, &t, &with);
            assert_int_equal(hit, rt_csg_hit(&forest, &plain, &prepared, &expected, &without));
            if (hit && t != expected) fail_msg("round %u, ray %u", round, i);
            if (!hit) continue;
            RtCsgFacet a = rt_csg_facet(&forest, &tested, &prepared, t);
            RtCsgFacet c = rt_csg_facet(&forest, &plain, &prepared, t);
            assert_int_equal(a.solid - tested.first_solid, c.solid - plain.first_solid);
        }
        clear(&forest, &b);
    }
    assert_true(with.csg_tests <= without.csg_tests && with.extent_tests < without.extent_tests);
}

static void a_tree_lies_within_its_extents(void **state) {
    (void)state;
    RtRandom random = rt_random(6, 0);
    for (uint32_t round = 0; round < 100; round++) {
        RtCsgBuilder b = {0};
        RtCsgForest forest = {0};
        RtCsg tree = plant(&forest, &b, random_term(&b, &random, 12, round % 2));
        RtBall about = rt_csg_ball(&forest, &tree);
        RtVec3d direction = rt_random_direction(&random);
        double reach = rt_csg_support(&forest, &tree, direction);
        for (uint32_t i = 0; i < 200; i++) {
            RtRay ray = random_ray(&random, i);
            Hits hits = hits_of(&forest, &tree, &ray);
            for (uint32_t h = 0; h < hits.count; h++) {
                RtVec3d p = rt_ray_point(&ray, hits.t[h]);
                assert_true(rt_lengthd(rt_subd(p, about.center)) <= about.radius + 1e-5);
                assert_true(rt_dotd(p, direction) <= reach + 1e-5);
            }
        }
        clear(&forest, &b);
    }
}

/* ---- transforms ---- */

static void a_tree_moved_by_powers_of_two_is_met_at_the_same_bits(void **state) {
    (void)state;
    RtRandom random = rt_random(7, 0);
    for (uint32_t round = 0; round < 60; round++) {
        RtCsgBuilder b = {0};
        RtCsgForest forest = {0};
        RtCsgTerm root = random_boxes(&b, &random, 8), moved;
        RtTransform move = rt_transform_identity();
        RtVec3 by = {16, -8, 4};
        assert_ok(rt_transform_translate(&move, by, error));
        assert_ok(rt_csg_move(&b, root, &move, &moved, error));
        RtCsg here = plant(&forest, &b, root), there = plant(&forest, &b, moved);
        for (uint32_t i = 0; i < 400; i += 2) {
            RtRay ray = random_ray(&random, i), same = ray;
            same.org = rt_add(ray.org, by);
            Hits expected = hits_of(&forest, &here, &ray), found = hits_of(&forest, &there, &same);
            if (!same_hits(&expected, &found)) fail_msg("round %u, ray %u", round, i);
        }
        clear(&forest, &b);
    }
}

/* A ray moved like the tree meets it at the same t, as far as the rounding of the ray goes. */
static void moving_the_tree_and_moving_the_ray_agree(void **state) {
    (void)state;
    RtRandom random = rt_random(8, 0);
    size_t hits = 0, agreed = 0;
    for (uint32_t round = 0; round < 100; round++) {
        RtCsgBuilder b = {0};
        RtCsgForest forest = {0};
        RtCsgTerm root = random_term(&b, &random, 10, false);
        RtTransform move = rt_transform_identity();
        RtVec3 axis = rt_narrow(rt_random_direction(&random));
        assert_ok(rt_transform_rotate(&move, axis, rt_random_betweend(&random, 0, 360), error));
        assert_ok(rt_transform_scale(&move, rt_vec3(1.5f, 0.5f, 2), error));
        assert_ok(rt_transform_translate(&move, rt_vec3(1, 2, 3), error));
        RtCsg here = plant(&forest, &b, root), there;
        assert_ok(rt_csg_transplant(&forest, &forest, &here, &move, &there, error));
        for (uint32_t i = 1; i < 400; i += 2) {
            RtRay ray = random_ray(&random, i), same = ray;
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
        clear(&forest, &b);
    }
    /* A ray by an edge may meet it or not. */
    if (agreed < hits - hits / 500) fail_msg("%zu of %zu hits agree", agreed, hits);
    assert_true(hits > 1000);
}

static void a_transplanted_tree_is_the_same_tree(void **state) {
    (void)state;
    RtRandom random = rt_random(9, 0);
    for (uint32_t round = 0; round < 50; round++) {
        RtCsgBuilder b = {0};
        RtCsgForest forest = {0}, other = {0};
        RtCsg tree = plant(&forest, &b, random_term(&b, &random, 30, round % 2)), copy;
        assert_ok(rt_csg_transplant(&other, &forest, &tree, NULL, &copy, error));
        assert_int_equal(copy.count, tree.count);
        assert_int_equal(copy.solid_count, tree.solid_count);
        assert_memory_equal(&copy.box, &tree.box, sizeof copy.box);
        for (uint32_t i = 0; i < tree.solid_count; i++) {
            const RtSolid *from = &forest.set.solids[tree.first_solid + i], *to = &other.set.solids[i];
            assert_true(from->material == to->material && from->subtracted == to->subtracted);
        }
        for (uint32_t i = 0; i < 100; i++) {
            RtRay ray = random_ray(&random, i);
            Hits expected = hits_of(&forest, &tree, &ray), found = hits_of(&other, &copy, &ray);
            assert_true(same_hits(&expected, &found));
        }
        rt_csg_forest_clear(&other);
        clear(&forest, &b);
    }
}

/* ---- deep trees ---- */

#define DEEP 10000

typedef enum DeepShape { LEFT_DEEP, RIGHT_DEEP, BALANCED } DeepShape;

/* Unit balls at x = 0, 1, 2, ...; with `drilled` each is what is left of it after another one. */
static RtCsgTerm deep_tree(RtCsgBuilder *b, DeepShape shape, RtCsgOp op) {
    static RtCsgTerm terms[DEEP];
    for (uint32_t i = 0; i < DEEP; i++) terms[i] = ball(b, rt_vec3((float)i, 0, 0), 1, 0);
    if (shape == BALANCED) {
        for (uint32_t count = DEEP; count > 1; count = (count + 1) / 2) {
            for (uint32_t i = 0; i < count / 2; i++) {
                terms[i] = combine(b, op, terms[2 * i], terms[2 * i + 1]);
            }
            if (count % 2) terms[count / 2] = terms[count - 1];
        }
        return terms[0];
    }
    RtCsgTerm term = terms[shape == LEFT_DEEP ? 0 : DEEP - 1];
    for (uint32_t i = 1; i < DEEP; i++) {
        term =
            shape == LEFT_DEEP ? combine(b, op, term, terms[i]) : combine(b, op, terms[DEEP - 1 - i], term);
    }
    return term;
}

static void check_deep(DeepShape shape, RtCsgOp op) {
    RtCsgBuilder b = {0};
    RtCsgForest forest = {0};
    RtCsg tree = plant(&forest, &b, deep_tree(&b, shape, op));
    assert_true(rt_csg_forest_bytes(&forest) < (uint64_t)DEEP * 2000);
    assert_int_equal(tree.most_crossings, 4 * DEEP);
    for (uint32_t i = 0; i < 20; i++) {
        RtRay across = ray_along(rt_vec3((float)(i * 499), 0, 3), rt_vec3(0, 0, -1));
        RtRay along = ray_along(rt_vec3(-3, 0, 0.75f), rt_vec3(1, 0, 0));
        Hits hits = hits_of(&forest, &tree, &across);
        if (op == RT_CSG_UNION) assert_int_equal(hits.count, 2);
        hits = hits_of(&forest, &tree, &along);
        if (op == RT_CSG_UNION) assert_int_equal(hits.count, 2);
    }
    clear(&forest, &b);
}

static void *check_all_deep(void *unused) {
    for (int shape = 0; shape < 3; shape++) {
        for (int op = 0; op < 3; op++) check_deep((DeepShape)shape, (RtCsgOp)op);
    }
    return unused;
}

static void a_tree_of_depth_10000_takes_little_memory_and_little_stack(void **state) {
    (void)state;
    pthread_attr_t attributes;
    pthread_t thread;
    assert_int_equal(pthread_attr_init(&attributes), 0);
    assert_int_equal(pthread_attr_setstacksize(&attributes, 64 * 1024), 0);
    assert_int_equal(pthread_create(&thread, &attributes, check_all_deep, NULL), 0);
    assert_int_equal(pthread_join(thread, NULL), 0);
    pthread_attr_destroy(&attributes);
}

/* ---- memory ---- */

static void planting_fails_cleanly_at_every_allocation(void **state) {
    (void)state;
    RtRandom random = rt_random(10, 0);
    RtCsgBuilder b = {0};
    RtCsgTerm root = random_term(&b, &random, RT_MAX_RANDOM_TREE, false);
    RtCsgForest forest = {0};
    RtCsg tree;
    RtStatus status = RT_NO_MEMORY;
    uint64_t n = 1;
    for (; n < 1000; n++) {
        rt_alloc_fail_at(n);
        status = rt_csg_plant(&forest, &b, root, true, &tree, NULL);
        rt_alloc_fail_at(0);
        if (status == RT_OK) break;
        assert_int_equal(status, RT_NO_MEMORY);
        assert_int_equal(forest.set.solid_count + forest.instruction_count + forest.box_count, 0);
    }
    assert_int_equal(status, RT_OK);
    assert_true(n > 5);
    clear(&forest, &b);
    assert_int_equal(rt_alloc_live(), 0);
}

static void a_ray_that_lacks_memory_is_counted(void **state) {
    (void)state;
    RtCsgBuilder b = {0};
    RtCsgForest forest = {0};
    RtCsgTerm term = ball(&b, rt_vec3(0, 0, 0), 1, 0);
    for (int i = 1; i < 200; i++) term = join(&b, ball(&b, rt_vec3(3 * (float)i, 0, 0), 1, 0), term);
    RtCsg tree = plant(&forest, &b, term);
    RtRay ray = ray_along(rt_vec3(-3, 0, 0), along_x);
    RtPreparedRay prepared = rt_ray_prepare(&ray, &tree.box);
    uint64_t before = rt_csg_shortages();
    float t;
    rt_alloc_fail_at(1);
    assert_false(rt_csg_hit(&forest, &tree, &prepared, &t, NULL));
    rt_alloc_fail_at(0);
    RtError error;
    assert_int_equal(rt_csg_check(before, &error), RT_NO_MEMORY);
    before = rt_csg_shortages();
    assert_true(rt_csg_hit(&forest, &tree, &prepared, &t, NULL));
    assert_int_equal(rt_csg_check(before, &error), RT_OK);
    clear(&forest, &b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_operation_keeps_its_part_of_two_boxes),
        cmocka_unit_test(touching_boxes_are_joined_without_a_wall),
        cmocka_unit_test(the_wall_of_a_drilled_hole_looks_into_the_hole),
        cmocka_unit_test(what_is_taken_from_what_is_taken_away_looks_outward_again),
        cmocka_unit_test(the_left_operand_names_a_face_that_both_have),
        cmocka_unit_test(an_empty_result_is_a_point_and_never_hit),
        cmocka_unit_test(a_ray_is_answered_within_its_interval_only),
        cmocka_unit_test(a_tree_without_end_is_refused_and_leaves_nothing_behind),
        cmocka_unit_test(a_tree_of_too_many_solids_is_refused),
        cmocka_unit_test(identities_of_sets_hold_bit_for_bit),
        cmocka_unit_test(tests_of_inner_nodes_change_no_bit),
        cmocka_unit_test(a_tree_lies_within_its_extents),
        cmocka_unit_test(a_tree_moved_by_powers_of_two_is_met_at_the_same_bits),
        cmocka_unit_test(moving_the_tree_and_moving_the_ray_agree),
        cmocka_unit_test(a_transplanted_tree_is_the_same_tree),
        cmocka_unit_test(a_tree_of_depth_10000_takes_little_memory_and_little_stack),
        cmocka_unit_test(planting_fails_cleanly_at_every_allocation),
        cmocka_unit_test(a_ray_that_lacks_memory_is_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
