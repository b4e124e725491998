/* SPDX-License-Identifier: Apache-2.0 */
/* accel/wide against brute, bit for bit: rays that go the same way, so that they are traced as packets, and
 * rays that nearly do; by every instruction set of this machine and at every parameter, in streams of all
 * lengths; and nothing is allocated meanwhile. */
#include "bundles_testing.h"
#include "wide_testing.h"

/* ---- brute, and all of wide ---- */

typedef struct Bench {
    RtScene scene;
    RtRay rays[ALL]; /* those of the second half begin and end where those of the first hit */
    RtHit truth[ALL];
    RtHit hits[ALL];
    bool blocked[ALL];
} Bench;

static void note_box(void *context, const RtBoxView *view) {
    Target *target = context;
    if (target->box_count < sizeof target->boxes / sizeof target->boxes[0])
        target->boxes[target->box_count++] = *view->box;
}

static Target aim_at(const RtScene *scene, uint64_t seed) {
    Target target = {.scene = scene, .random = rt_random(seed, 3), .size = 1};
    RtWide *wide = make_wide(scene, BEST_SET, "build=spatial,alpha=0,budget=4,max_leaf_size=1");
    wide->isa.base.ops->each_box(&wide->isa.base, (RtBoxViewer){note_box, &target});
    rt_accel_destroy(&wide->isa.base);
    if (scene->geometry.object_count == 0) return target;
    target.middle = rt_box_center(scene->geometry.box);
    target.size = (float)rt_box_longest_side(scene->geometry.box);
    return target;
}

static void set_up(Bench *bench, uint64_t seed, Bundle *only) {
    Target target = aim_at(&bench->scene, seed);
    make_rays(&target, bench->rays, only);
    OWNED_ACCEL RtAccel *brute = open_accel(&bench->scene, "brute");
    OWNED_QUERY query = open_query(brute);
    rt_nearest(&query, bench->rays, RAYS, bench->truth, NULL);
    for (int i = 0; i < RAYS; i++) {
        RtRay *ray = &bench->rays[RAYS + i];
        *ray = bench->rays[i];
        if (bench->truth[i].object != RT_NO_OBJECT) ray->tmin = ray->tmax = bench->truth[i].t;
    }
    rt_nearest(&query, bench->rays + RAYS, RAYS, bench->truth + RAYS, NULL);
}

/* The rays again, the `cut`th way to cut them: in lengths that are no packets' in turn, in packets, in what
 * is tried before a way is chosen, or not at all. */
static size_t length_of(int cut, size_t turn) {
    static const size_t lengths[] = {1, 2, 15, 16, 17, 63, 64, 65};
    return cut == 0 ? lengths[turn % 8] : cut == 1 ? 16 : cut == 2 ? BUNDLE : ALL;
}

static void trace_all(RtQuery *query, Bench *bench, int cut, RtTally *tallies) {
    for (size_t i = 0, n, turn = 0; i < ALL; i += n, turn++) {
        n = length_of(cut, turn);
        if (n > ALL - i) n = ALL - i;
        rt_nearest(query, bench->rays + i, n, bench->hits + i, tallies);
        rt_occluded(query, bench->rays + i, n, bench->blocked + i, tallies);
    }
}

static void compare(const Bench *bench, const char *what, int cut) {
    for (size_t i = 0; i < ALL; i++) {
        const RtHit *right = &bench->truth[i], *got = &bench->hits[i];
        bool any = right->object != RT_NO_OBJECT;
        if (memcmp(right, got, sizeof *right) == 0 && bench->blocked[i] == any) continue;
        const RtRay *r = &bench->rays[i];
        fail_msg(
            "%s on %s, cut %d, ray %zu, bundle %zu: object %u at %a, blocked %d, not %u at %a; org %a %a %a, "
            "dir %a %a %a, t %a to %a",
            what, bench->scene.name, cut, i, i % RAYS / BUNDLE % BUNDLES, got->object, (double)got->t,
            bench->blocked[i], right->object, (double)right->t, (double)r->org.x, (double)r->org.y,
            (double)r->org.z, (double)r->dir.x, (double)r->dir.y, (double)r->dir.z, (double)r->tmin,
            (double)r->tmax);
    }
}

/* No allocation but that of the query: one that were made while tracing would fail. */
static void assert_like_brute(Bench *bench, const RtWide *wide, const char *what) {
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    OWNED_QUERY query = open_query(&wide->isa.base);
    for (int cut = 0; cut < 4; cut++) {
        rt_alloc_fail_at(1);
        trace_all(&query, bench, cut, NULL);
        assert_null(rt_alloc(1, 1)); /* the first one since */
        compare(bench, what, cut);
        if (cut != 0) continue;
        trace_all(&query, bench, cut, tallies);
        compare(bench, what, cut + 10);
    }
    rt_alloc_fail_at(0);
}

static const char *const settings[] = {"",
                                       "packets=0",
                                       "sharing=0",
                                       "packets=1,sharing=0,max_leaf_size=8",
                                       "packets=16,sharing=0,block_cost=1000",
                                       "in_flight=1",
                                       "in_flight=2",
                                       "in_flight=64",
                                       "order=off",
                                       "prefetch=off,huge_pages=off",
                                       "max_leaf_size=1",
                                       "max_leaf_size=8",
                                       "max_leaf_size=8,block_cost=0",
                                       "block_cost=1000",
                                       "reinsertion=3",
                                       "build=sweep",
                                       "build=lbvh",
                                       "build=ploc",
                                       "build=spatial",
                                       "build=spatial,alpha=0,budget=16,max_leaf_size=1,order=off",
                                       "build=spatial,alpha=0,budget=4,whole=on",
                                       "build=spatial,alpha=0,sharing=0",
                                       "build=spatial,alpha=0,budget=16,max_leaf_size=1,sharing=0",
                                       "build=spatial,alpha=0,in_flight=1"};
enum { SETTINGS = sizeof settings / sizeof settings[0], SPLIT = 6 /* the last */ };

/* Takes the scene. Of `only` alone, at the settings that split references; NULL: of everything, at all. */
static void check(RtScene scene, uint64_t seed, Bundle *only) {
    static Bench bench;
    bench.scene = scene;
    set_up(&bench, seed, only);
    for (int isa = FIRST_SET; isa < INSTRUCTION_SETS; isa++) {
        for (int s = only ? SETTINGS - SPLIT : 0; s < SETTINGS; s++) {
            char what[RT_MAX_SPEC_CHARS];
            OWNED_ACCEL RtWide *wide = make_wide(&bench.scene, isa, settings[s]);
            if (!wide) continue;
            snprintf(what, sizeof what, "wide:isa=%s,%s", instruction_sets[isa], settings[s]);
            assert_like_brute(&bench, wide, what);
        }
    }
    rt_scene_clear(&bench.scene);
}

/* ---- scenes ---- */

/* Triangles; slivers; a mesh far from the zero of coordinates; objects in planes of boxes; spheres, some the
 * same, alone and in lists; all shapes, tiny and huge; CSG trees. */
RT_TEST(objects_of_every_sort_are_hit_as_by_brute) {
    static const char *const specs[] = {"random:n=400,shape=triangle",
                                        "family:kind=slivers,seed=2",
                                        "family:kind=mesh-far,seed=3",
                                        "family:kind=axis-aligned,seed=1",
                                        "family:kind=duplicates,seed=1",
                                        "random:n=300,shape=sphere,distribution=clustered",
                                        "shells:size=2",
                                        "family:kind=mixed,seed=4",
                                        "family:kind=mixed-tiny,seed=1",
                                        "family:kind=mixed-huge,seed=1",
                                        "family:kind=csg,seed=1"};
    for (size_t i = 0; i < sizeof specs / sizeof specs[0]; i++) check(open_scene(specs[i]), 1, NULL);
}

RT_TEST(scenes_of_no_object_and_of_one_are_answered_as_by_brute) {
    RtScene none = begin_scene(), one = begin_scene();
    assert_ok(rt_scene_finish(&none, error));
    check(none, 1, NULL);
    add_triangle(&one, rt_vec3(0, 0, 1), rt_vec3(1, 0.25f, 1), rt_vec3(0.5f, 1, 2));
    assert_ok(rt_scene_finish(&one, error));
    check(one, 2, NULL);
}

/* Needs the thickness of rays, in streams and in packets. */
RT_TEST(rays_along_the_planes_that_cut_objects_are_answered_as_by_brute) {
    const char *specs[] = {"random:n=300,shape=triangle", "family:kind=slivers,seed=1",
                           "family:kind=slivers,seed=5", "family:kind=slivers-scaled,seed=3",
                           "family:kind=mesh-far,seed=1"};
    for (int i = 0; i < 5; i++) check(open_scene(specs[i]), (uint64_t)i, along_planes);
}

RT_TEST(rays_too_short_for_the_boxes_of_split_references_are_answered_as_by_brute) {
    check(open_scene("random:n=400,shape=triangle,radius=0.4"), 1, short_along_an_axis);
}

RT_TEST(hostile_rays_hit_split_slivers_as_by_brute) {
    const float scales[] = {1, 1, 1, 1e-20f, 1e16f, 0.01f}, offsets[] = {0, 1e6f, 1e5f, 0, 0, -3000};
    for (int i = 0; i < 6; i++)
        check(make_slivers(160, (uint64_t)i, scales[i], offsets[i]), (uint64_t)i, at_slivers);
}

/* Copies of triangles, in planes of boxes, and others that are lines and points. */
RT_TEST(triangles_without_area_and_copies_of_triangles_are_answered_as_by_brute) {
    RtScene scene = begin_scene();
    RtRandom random = rt_random(9, 9);
    for (int i = 0; i < 120; i++) {
        RtVec3 a = rt_random_point(&random, 1), b = rt_random_point(&random, 1),
               c = rt_random_point(&random, 1);
        a.z = b.z = c.z = (float)(i % 5) - 2;
        if (i % 4 == 1) c = b;
        if (i % 4 == 2) c = rt_add(a, rt_scale(rt_sub(b, a), 0.5f));
        if (i % 16 == 3) c = b = a;
        for (int copy = 0; copy <= i % 3; copy++) add_triangle(&scene, a, b, c);
    }
    assert_ok(rt_scene_finish(&scene, error));
    check(scene, 3, NULL);
}

/* Rays that miss all children of the root, so that the filter stays open, between rays that graze faces and
 * edges of objects' boxes by a few ulps, along an axis or not, or start inside. Then rays that all meet the
 * scene, which close the filter. */
static void graze_boxes(const RtScene *scene, RtRay *rays, int count, bool closes) {
    const RtGeometry *g = &scene->geometry;
    RtRandom random = rt_random(closes ? 7 : 8, 1);
    RtVec3 middle = rt_box_center(g->box);
    for (int i = 0; i < count; i++) {
        const RtBox *box = &g->boxes[rt_random_below(&random, g->object_count)];
        RtVec3 to, org = rt_random_point(&random, 30);
        for (int a = 0; a < 3; a++) {
            float at = (rt_random_below(&random, 2) ? box->hi : box->lo).at[a];
            for (uint32_t k = rt_random_below(&random, 7); k > 0; k--)
                at = nextafterf(at, k % 2 ? INFINITY : -INFINITY);
            to.at[a] = at * (1 + ((float)rt_random_below(&random, 65) - 32) * 0x1p-24f);
        }
        if (i % 8 == 1) org = middle;
        if (i % 8 == 2 || i % 8 == 3) org.at[i / 8 % 3] = to.at[i / 8 % 3]; /* in the plane of a face */
        if (i % 8 == 3) org.at[(i / 8 + 1) % 3] = to.at[(i / 8 + 1) % 3];   /* along an axis */
        RtVec3 dir = rt_sub(to, org);
        if (i % 8 > 3 && !closes) dir = rt_sub(org, middle); /* leaves */
        if (dir.x == 0 && dir.y == 0 && dir.z == 0) dir.x = 1;
        rays[i] = (RtRay){.org = org, .dir = dir, .tmax = i % 3 ? INFINITY : 1};
    }
}

RT_TEST(rays_that_graze_the_children_of_the_root_are_answered_as_by_brute_in_streams_of_1_to_300) {
    enum { COUNT = 4096, LONGEST = 300 };
    static RtRay rays[COUNT];
    static RtHit truth[COUNT], hits[LONGEST];
    static bool blocked[LONGEST];
    const char *const specs[] = {"family:kind=axis-aligned,seed=1", "random:n=60,shape=triangle"};
    const char *const ways[] = {"", "packets=0", "sharing=0", "build=spatial,alpha=0,budget=4"};
    for (int run = 0; run < 4; run++) {
        OWNED_SCENE scene = open_scene(specs[run / 2]);
        OWNED_ACCEL RtAccel *brute = open_accel(&scene, "brute");
        OWNED_QUERY right = open_query(brute);
        graze_boxes(&scene, rays, COUNT, run % 2);
        rt_nearest(&right, rays, COUNT, truth, NULL);
        for (int k = 0; k < 4 * INSTRUCTION_SETS; k++) {
            OWNED_ACCEL RtWide *wide = make_wide(&scene, k / 4, ways[k % 4]);
            if (!wide) continue;
            OWNED_QUERY query = open_query(&wide->isa.base);
            for (size_t n = 1, first = 0; n <= LONGEST; n++, first = (first + n) % (COUNT - LONGEST)) {
                rt_nearest(&query, rays + first, n, hits, NULL);
                rt_occluded(&query, rays + first, n, blocked, NULL);
                assert_memory_equal(hits, truth + first, n * sizeof *hits);
                for (size_t i = 0; i < n; i++)
                    assert_int_equal(blocked[i], truth[first + i].object != RT_NO_OBJECT);
            }
        }
    }
}

RT_TESTS(wide_exact, NULL, assert_nothing_is_kept)
