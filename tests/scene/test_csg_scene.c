/* SPDX-License-Identifier: Apache-2.0 */
/* CSG trees as objects of a scene: materials of solids, refraction within a tree, copies of scenes, the
 * fingerprint, counting, and lack of memory while one is added. */
#include "accel_testing.h"
#include "csg_testing.h"

#include "render/illumination.h"

/* ---- helpers ---- */

static uint32_t add_glass(RtScene *scene, const char *name, float ior) {
    RtMaterial material = rt_default_material();
    uint32_t index;
    strcpy(material.name, name);
    material.transmission = 1;
    material.ior = ior;
    assert_ok(rt_scene_add_material(scene, &material, &index, error));
    return index;
}

/* A glass cube from -2 to 2 with a bubble of radius 1 in its middle, whose wall is of another material. */
static RtScene make_bubble(void) {
    RtScene scene;
    OWNED_BUILDER b = {0};
    rt_scene_init(&scene);
    uint32_t glass = add_glass(&scene, "glass", 1.5f), wall = add_glass(&scene, "wall", 1.25f);
    RtCsgTerm cube = box(&b, rt_vec3(-2, -2, -2), rt_vec3(2, 2, 2), glass);
    RtCsgTerm tree = cut(&b, cube, ball(&b, rt_vec3(0, 0, 0), 1, wall));
    assert_ok(rt_scene_add_csg(&scene, &b, tree, true, error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

static RtSurface surface_at(const RtScene *scene, const RtRay *ray, float t) {
    return rt_surface(scene, ray, (RtHit){t, 0}, hit_memory_of_tests());
}

/* A random tree as the only object. */
static RtScene make_random(uint64_t seed, bool extents) {
    RtScene scene;
    RtRandom random = rt_random(31, seed);
    OWNED_BUILDER b = {0};
    rt_scene_init(&scene);
    for (int i = 0; i < 4; i++) add_glass(&scene, (const char *[]){"a", "b", "c", "d"}[i], 1);
    RtCsgTerm root = random_term(&b, &random, 20, seed % 2);
    assert_ok(rt_scene_add_csg(&scene, &b, root, extents, error));
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

/* ---- materials and refraction ---- */

RT_TEST(a_surface_has_the_material_of_its_solid) {
    OWNED_SCENE scene = make_bubble();
    RtRay ray = ray_along(rt_vec3(-4, 0, 0), along_x);
    const char *const names[4] = {"glass", "wall", "wall", "glass"};
    for (int i = 0; i < 4; i++) {
        RtSurface surface = surface_at(&scene, &ray, (float[]){2, 3, 5, 6}[i]);
        assert_string_equal(surface.material->name, names[i]);
        assert_true(surface.entering == (i % 2 == 0));
        assert_true(surface.side.x == -1);
    }
    assert_int_equal(scene.material_of[0], 0);
}

/* Snell's law: out of the glass and into the bubble the ray bends away from the normal of the bubble's
 * wall. */
RT_TEST(light_is_refracted_out_of_the_tree_where_a_bubble_begins) {
    OWNED_SCENE scene = make_bubble();
    RtRay ray = ray_along(rt_vec3(-4, 0.5f, 0), along_x), rays[RT_MAX_SPAWN];
    float factors[RT_MAX_SPAWN], t = (float)(4 - sqrt(0.75));
    RtSurface surface = surface_at(&scene, &ray, t);
    assert_false(surface.entering);
    assert_int_equal(rt_spawn_rays(&surface, rays, factors), 1);
    assert_int_equal(rays[0].kind, RT_RAY_TRANSMISSION);
    RtVec3d out = rt_normalized(rt_widen(rays[0].dir)), across = rt_crossd(out, surface.side);
    assert_true(fabs(rt_lengthd(across) - 0.5 * 1.25) < 1e-6);
}

/* ---- copies ---- */

RT_TEST(a_tree_may_be_appended_under_any_transform) {
    RtTransform uneven = rt_transform_identity();
    assert_ok(rt_transform_rotate(&uneven, rt_vec3(1, 2, 3), 30, error));
    assert_ok(rt_transform_scale(&uneven, rt_vec3(2, 1, 0.5f), error));
    RtRandom random = rt_random(32, 0);
    for (uint64_t seed = 0; seed < 20; seed++) {
        OWNED_SCENE from = make_random(seed, true), to;
        rt_scene_init(&to);
        add_glass(&to, "other", 1);
        assert_ok(rt_scene_append(&to, &from, &uneven, error));
        assert_ok(rt_scene_append(&to, &from, NULL, error));
        assert_ok(rt_scene_finish(&to, error));
        const RtGeometry *g = &to.geometry;
        assert_int_equal(g->csg_count, 2);
        for (uint32_t i = 0; i < from.geometry.forest.set.solid_count; i++) {
            uint32_t material = from.geometry.forest.set.solids[i].material + 1;
            assert_int_equal(g->forest.set.solids[i].material, material);
            assert_int_equal(g->forest.set.solids[g->csgs[1].first_solid + i].material, material);
        }
        OWNED_FOREST forest = {0};
        RtCsg moved = copied(&forest, &from.geometry.forest, from.geometry.csgs, &uneven);
        for (uint32_t i = 0; i < 200; i++) {
            RtRay ray = tree_ray(&random, i);
            Hits first = hits_of(&g->forest, &g->csgs[0], &ray), wanted = hits_of(&forest, &moved, &ray);
            assert_true(same_hits(&first, &wanted));
            Hits second = hits_of(&g->forest, &g->csgs[1], &ray);
            wanted = hits_of(&from.geometry.forest, from.geometry.csgs, &ray);
            assert_true(same_hits(&second, &wanted));
        }
    }
}

/* ---- the fingerprint ---- */

RT_TEST(the_fingerprint_sees_trees_but_not_their_extents) {
    OWNED_SCENE scene = make_random(3, true), plain = make_random(3, false);
    uint64_t before = rt_scene_fingerprint(&scene);
    assert_true(before == rt_scene_fingerprint(&plain));
    RtCsgForest *forest = &scene.geometry.forest;

    forest->set.solids[0].material++;
    assert_true(before != rt_scene_fingerprint(&scene));
    forest->set.solids[0].material--;
    forest->set.solids[0].subtracted = !forest->set.solids[0].subtracted;
    assert_true(before != rt_scene_fingerprint(&scene));
    forest->set.solids[0].subtracted = !forest->set.solids[0].subtracted;
    forest->set.solids[0].to_world.m[0][3] += 1;
    assert_true(before != rt_scene_fingerprint(&scene));
    forest->set.solids[0].to_world.m[0][3] -= 1;
    uint32_t last = forest->instruction_count - 1;
    assert_int_equal(forest->instructions[last].code, RT_CSG_APPLY);
    forest->instructions[last].operand = (forest->instructions[last].operand + 1) % 3;
    assert_true(before != rt_scene_fingerprint(&scene));
}

/* ---- counting ---- */

static RtTally counted(const RtScene *scene, RtRay ray) {
    RtHit hit;
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    OWNED_ACCEL RtAccel *brute = open_accel(scene, "brute");
    OWNED_QUERY query = open_query(brute);
    rt_nearest(&query, &ray, 1, &hit, tallies);
    return tallies[ray.kind];
}

RT_TEST(solids_and_boxes_are_counted_as_they_are_tested) {
    OWNED_SCENE scene = make_bubble();
    /* Through both; past the box of the ball; past the tree. */
    const RtVec3 origins[3] = {{-4, 0, 0}, {-4, 1.5f, 0}, {-4, 3, 0}};
    const uint64_t solids[3] = {2, 1, 0}, boxes[3] = {2, 2, 0};
    for (int i = 0; i < 3; i++) {
        RtTally tally = counted(&scene, ray_along(origins[i], along_x));
        assert_int_equal(tally.object_tests, 1);
        assert_int_equal(tally.csg_tests, solids[i]);
        assert_int_equal(tally.extent_tests, boxes[i]);
    }
}

/* Two clusters of four balls each: the ray meets the box of one of them. */
RT_TEST(a_node_that_is_missed_costs_one_test) {
    OWNED_SCENE scene;
    OWNED_BUILDER b = {0};
    RtCsgTerm clusters[2];
    rt_scene_init(&scene);
    add_glass(&scene, "glass", 1);
    for (int c = 0; c < 2; c++) {
        clusters[c] = ball(&b, rt_vec3(0, 20 * (float)c, 0), 1, 0);
        for (int i = 1; i < 4; i++)
            clusters[c] = join(&b, clusters[c], ball(&b, rt_vec3(3 * (float)i, 20 * (float)c, 0), 1, 0));
    }
    assert_ok(rt_scene_add_csg(&scene, &b, join(&b, clusters[0], clusters[1]), true, error));
    assert_ok(rt_scene_finish(&scene, error));
    RtTally tally = counted(&scene, ray_along(rt_vec3(0, 0, -5), rt_vec3(0, 0, 1)));
    assert_int_equal(tally.csg_tests, 1);
    /* Both clusters; in the first, which is met, what its three left balls have in common; and its balls. */
    assert_true(tally.extent_tests <= 2 + 1 + 4);
}

/* ---- memory ---- */

static RtStatus add_anew(const RtCsgBuilder *b, RtCsgTerm root, RtError *error) {
    OWNED_SCENE scene;
    rt_scene_init(&scene);
    RtMaterial material = rt_default_material();
    for (uint32_t i = 0, index; i < 4; i++) RT_TRY(rt_scene_add_material(&scene, &material, &index, error));
    const RtStatus status = rt_scene_add_csg(&scene, b, root, true, error);
    if (status != RT_OK)
        assert_int_equal(scene.geometry.object_count + scene.geometry.forest.instruction_count, 0);
    return status;
}

RT_TEST(adding_a_tree_fails_cleanly_at_every_allocation) {
    RtRandom random = rt_random(33, 0);
    OWNED_BUILDER b = {0};
    const RtCsgTerm root = random_term(&b, &random, 10, true);
    assert_fails_cleanly(add_anew(&b, root, error), (void)0);
}

RT_TESTS(csg_scene, NULL, NULL)
