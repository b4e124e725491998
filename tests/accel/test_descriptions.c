/* SPDX-License-Identifier: Apache-2.0 */
/* What structures describe: the leaves that they show; predictions for random lines against random lines,
 * over objects so small that hardly any line hits one, so that no hit ends a traversal, as the predictions
 * assume; and end-point overlap and leaf-count variability of hierarchies small enough to compute them by
 * hand. */
#include "accel_testing.h"

#include "rays/rayset.h"
#include "verify/verify.h"

/* ---- leaves ---- */

typedef struct Sums {
    uint64_t leaves, empty, references, depth;
} Sums;

static void add_leaf(void *context, const RtBoxView *view) {
    Sums *sums = context;
    if (!view->leaf) return;
    sums->leaves++;
    sums->empty += view->objects == 0;
    sums->references += view->objects;
    if (view->depth > sums->depth) sums->depth = view->depth;
}

static void check_leaves(const char *spec, const RtScene *scene) {
    OWNED_ACCEL RtAccel *accel = open_available(scene, spec, 1);
    RtDescription d;
    Sums sums = {0};
    if (!accel) return; /* an instruction set */
    rt_accel_describe(accel, &d);
    accel->ops->each_box(accel, (RtBoxViewer){add_leaf, &sums});
    if (sums.leaves != d.leaves || sums.empty != d.empty_leaves || sums.references != d.references ||
        sums.depth != d.depth) {
        fail_msg("%s: %d leaves, %d empty, %d references, depth %d, not %d, %d, %d, %d", spec,
                 (int)sums.leaves, (int)sums.empty, (int)sums.references, (int)sums.depth, (int)d.leaves,
                 (int)d.empty_leaves, (int)d.references, (int)d.depth);
    }
}

RT_TEST(the_leaves_shown_are_those_described_at_every_setting) {
    const char *const scenes[] = {"balls:size=1", "random:n=0", "random:n=1", "random:n=100"};
    uint32_t shown = 0;
    for (size_t s = 0; s < 4; s++) {
        OWNED_SCENE scene = open_scene(scenes[s]);
        for (size_t i = 0; i < rt_accel_count(); i++) {
            char spec[RT_MAX_SPEC_CHARS];
            if (!rt_accel_at(i)->shows_lists) continue;
            shown++;
            for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++) check_leaves(spec, &scene);
        }
    }
    assert_true(shown >= 4 * 6); /* bvh, clusters, grid, kd, octree, wide, and newer ones */
}

/* ---- predictions ---- */

enum { LINES = 20000 };

/* Uniform lines through the scene's box. */
static void make_lines(const RtBox *box, RtRay rays[LINES]) {
    RtRandom random = rt_random(1, 0);
    for (int i = 0; i < LINES;) {
        rays[i] = rt_random_chord(box, &random);
        RtPreparedRay line = rt_ray_prepare(&rays[i], box);
        float enter;
        i += rt_box_hit(box, &line, rays[i].tmax, &enter);
    }
}

static RtTally count(const RtAccel *accel, const RtRay *rays) {
    static RtHit hits[LINES];
    RtTally tallies[RT_RAY_KIND_COUNT] = {{0}};
    OWNED_QUERY query = open_query(accel);
    rt_nearest(&query, rays, LINES, hits, tallies);
    return tallies[RT_RAY_RANDOM];
}

static void assert_close(const char *spec, const char *what, double measured, double predicted) {
    if (fabs(measured / predicted - 1) <= 0.02) return;
    fail_msg("%s: %s: %g measured, %g predicted", spec, what, measured, predicted);
}

/* Every structure over the same points. Tests are left out where a leaf is no larger than its object: a ray
 * is thicker than those. */
static const struct {
    const char *spec;
    bool tests;
} rows[] = {
    {"bvh", false},
    {"bvh:max_leaf_size=1,traversal_cost=0", false},
    {"clusters", false},
    {"clusters:method=rubin-whitted,width=8", false},
    {"grid:mailbox=off", true},
    {"grid:resolution=5x9x13,margin=0.01,mailbox=off", true},
    {"grid:density=0.3,depth=2,nest=3,mailbox=off", true},
    {"grid:density=1,depth=3,nest=1,mailbox=off", true},
    {"octree:traversal=parametric,mailbox=off", true},
    {"octree:traversal=points,mailbox=off", true},
    {"octree:traversal=neighbours,mailbox=off", true},
    {"octree:max_leaf_size=1,split=cost,traversal=neighbours,mailbox=off", true},
    {"kd:mailbox=off", false},
    {"kd:mailbox=off,overlap=exact,traversal_cost=3,failures=9", false},
    {"kd:mailbox=off,max_leaf_size=6", true},
    {"brute", true},
};

RT_TEST(lines_take_the_tests_and_steps_that_were_predicted) {
    static RtRay rays[LINES];
    OWNED_SCENE scene = open_scene("random:n=500,radius=0.002");
    make_lines(&scene.geometry.box, rays);
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        RtDescription d;
        OWNED_ACCEL RtAccel *accel = open_accel(&scene, rows[i].spec);
        rt_accel_describe(accel, &d);
        RtTally tally = count(accel, rays);
        assert_true(tally.hits < LINES / 1000);
        if (rows[i].tests)
            assert_close(rows[i].spec, "tests", (double)tally.object_tests / LINES, d.predicted_tests);
        if (d.predicted_steps > 0)
            assert_close(rows[i].spec, "steps", (double)tally.steps / LINES, d.predicted_steps);
    }
}

/* ---- quality ---- */

/* Three standard errors of 4096 points and 8192 lines. */
static const double CLOSE = 0.03;

/* A triangle whose box is a unit cube from x on: the part of it below x + 1/2 is a quarter. */
static void add_triangle(RtScene *scene, float x) {
    const RtVec3 vertices[3] = {{x, 0, 0}, {x + 1, 1, 0}, {x + 1, 0, 1}};
    assert_ok(rt_scene_add_triangle(scene, 0, vertices, NULL, error));
}

/* Two of them. */
static RtScene make_pair(float x0, float x1) {
    RtScene scene = begin_scene();
    add_triangle(&scene, x0);
    add_triangle(&scene, x1);
    assert_ok(rt_scene_finish(&scene, error));
    return scene;
}

static const char *const hierarchies[] = {"bvh:max_leaf_size=1", "clusters:method=ploc",
                                          "wide:max_leaf_size=1"};

RT_TEST(overlap_is_the_cost_of_leaves_that_hold_a_point_of_another_object) {
    static const struct {
        float at;
        double overlap;
    } cases[] = {{5, 0}, {0, 1}, {0.5f, 0.5 * 0.75 + 0.5 * 0.25}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        OWNED_SCENE scene = make_pair(0, cases[i].at);
        for (size_t s = 0; s < sizeof hierarchies / sizeof hierarchies[0]; s++) {
            double overlap = describe_spec(&scene, hierarchies[s]).end_point_overlap;
            assert_true(fabs(overlap - cases[i].overlap) < (i == 2 ? CLOSE : 1e-9));
        }
        assert_true(describe_spec(&scene, "wide").end_point_overlap < 1e-9 || cases[i].at > 0);
    }
}

/* Of four in one place, halved twice, a point is in one inner node that is not above its object, and in three
 * leaves. */
RT_TEST(an_inner_node_overlaps_at_its_own_cost) {
    OWNED_SCENE scene = begin_scene();
    for (int i = 0; i < 4; i++) add_triangle(&scene, 0);
    assert_ok(rt_scene_finish(&scene, error));
    double overlap = describe_spec(&scene, "bvh:max_leaf_size=1,traversal_cost=7").end_point_overlap;
    assert_true(fabs(overlap - (7 + 3)) < 1e-9);
    rt_scene_clear(&scene);

    scene = begin_scene(); /* the last one is a speck, whose leaf hardly any point is in */
    for (int i = 0; i < 3; i++) add_triangle(&scene, 0);
    const float lo = 0.5f - 0x1p-20f, hi = 0.5f + 0x1p-20f;
    const RtVec3 speck[3] = {{lo, lo, lo}, {hi, hi, lo}, {hi, lo, hi}};
    assert_ok(rt_scene_add_triangle(&scene, 0, speck, NULL, error));
    assert_ok(rt_scene_finish(&scene, error));
    overlap = describe_spec(&scene, "bvh:max_leaf_size=1,traversal_cost=7").end_point_overlap;
    assert_true(fabs(overlap - (7 + 2)) < CLOSE);
}

/* Two cubes side by side: of the lines that meet their box, 3/5 meet each and 1/5 both, so that a line meets
 * 6/5 of them on average, and the variance is 4/5 + 4 * 1/5 - 36/25. */
RT_TEST(leaves_met_vary_as_the_areas_of_two_cubes_say) {
    OWNED_SCENE scene = make_pair(0, 1);
    for (size_t s = 0; s < sizeof hierarchies / sizeof hierarchies[0]; s++)
        assert_true(fabs(describe_spec(&scene, hierarchies[s]).leaf_count_variability - 0.4) < CLOSE);
    assert_true(describe_spec(&scene, "bvh:max_leaf_size=8,traversal_cost=100").leaf_count_variability <
                1e-9);
}

RT_TEST(what_is_no_triangle_has_no_overlap_and_what_is_no_hierarchy_no_quality) {
    OWNED_SCENE scene = make_row(2, 9);
    RtDescription description = describe_spec(&scene, "bvh:max_leaf_size=1");
    assert_true(isnan(description.end_point_overlap));
    assert_true(description.leaf_count_variability > 0);
    const char *others[] = {"brute", "grid", "kd", "octree", "extents"};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        description = describe_spec(&scene, others[i]);
        assert_true(isnan(description.end_point_overlap));
        assert_true(isnan(description.leaf_count_variability));
    }
}

RT_TESTS(descriptions, NULL, assert_nothing_is_kept)
