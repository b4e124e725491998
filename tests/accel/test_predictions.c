/* SPDX-License-Identifier: Apache-2.0 */
/* Predictions for random lines against random lines: over objects so small that hardly any line hits one, no
 * hit ends a traversal, as the predictions assume. */
#include "accel_testing.h"

#include "rays/rayset.h"

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
    {"octree:split=cost,traversal=neighbours,mailbox=off", true},
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

RT_TESTS(predictions, NULL, NULL)
