/* SPDX-License-Identifier: Apache-2.0 */
/* accel/wide against brute, bit for bit: rays that go the same way, so that they are traced as packets, and
 * rays that nearly do; by every instruction set of this machine and at every parameter, in streams of all
 * lengths; and nothing is allocated meanwhile. */
#include "wide_testing.h"

#include "random_testing.h"

/* ---- bundles of rays ---- */

/* As many rays as a packet holds, and how many bundles of each sort there are. A sanitizer looks at what is
 * read and written, which is the same in each round. */
enum { BUNDLE = 64, ROUNDS = RT_SHARE(3, 1) };

/* What rays are aimed at: a scene, and the boxes that a structure has of it. */
typedef struct Target {
    const RtScene *scene;
    RtRandom random;
    RtVec3 middle;
    float size;
    RtBox boxes[512];
    uint32_t box_count;
} Target;

/* A point of an object's box: of a triangle also a vertex, or a point of an edge. */
static RtVec3 point_on(Target *target, uint32_t id) {
    const RtGeometry *g = &target->scene->geometry;
    RtRandom *random = &target->random;
    if (g->object_count == 0) return rt_random_point(random, 1);
    RtVec3 p;
    const RtBox *own = &g->boxes[id];
    for (int a = 0; a < 3; a++)
        p.at[a] = own->lo.at[a] + (own->hi.at[a] - own->lo.at[a]) * rt_random_unit(random);
    if (rt_ref_shape(g->objects[id]) != RT_SHAPE_TRIANGLE) return p;
    const RtVec3 *v = g->triangles[rt_ref_index(g->objects[id])].v;
    uint32_t pick = rt_random_below(random, 4);
    float u = pick ? rt_random_unit(random) : 0, w = pick > 1 ? (1 - u) * rt_random_unit(random) : 0;
    for (int a = 0; a < 3; a++) p.at[a] = v[0].at[a] * (1 - u - w) + v[1].at[a] * u + v[2].at[a] * w;
    return p;
}

static RtVec3 any_point(Target *target) {
    uint32_t count = target->scene->geometry.object_count;
    return point_on(target, count ? rt_random_below(&target->random, count) : 0);
}

static RtVec3 outside(Target *target, float sizes) {
    return rt_add(target->middle,
                  rt_narrow(rt_scaled(rt_random_direction(&target->random), (double)(sizes * target->size))));
}

/* From a point, towards what is seen in a small window about another. */
static void pinhole(Target *target, RtRay *rays, RtVec3 eye, float window) {
    RtVec3 middle = any_point(target);
    for (int i = 0; i < BUNDLE; i++) {
        RtVec3 at = rt_add(middle, rt_random_point(&target->random, window * target->size));
        rays[i] = (RtRay){eye, 0, rt_sub(at, eye), INFINITY, RT_RAY_PRIMARY, 0};
    }
}

static void from_outside(Target *target, RtRay *rays) {
    pinhole(target, rays, outside(target, 3), 0.02f);
}

static void from_within(Target *target, RtRay *rays) {
    pinhole(target, rays, any_point(target), 0.1f);
}

static void over_the_whole(Target *target, RtRay *rays) { /* signs or the major axis may change */
    pinhole(target, rays, outside(target, 0.8f), 0.5f);
}

static void from_far_away(Target *target, RtRay *rays) {
    pinhole(target, rays, outside(target, 1e5f), 0.01f);
}

static void at_exact_points(Target *target, RtRay *rays) {
    pinhole(target, rays, outside(target, 2), 1e-7f);
}

static void parallel(Target *target, RtRay *rays) {
    RtVec3 eye = outside(target, 3), dir = rt_sub(any_point(target), eye);
    for (int i = 0; i < BUNDLE; i++) {
        RtVec3 from = rt_add(eye, rt_random_point(&target->random, 0.1f * target->size));
        rays[i] = (RtRay){from, 0, dir, INFINITY, RT_RAY_RANDOM, 0};
    }
}

static void all_the_same(Target *target, RtRay *rays) {
    RtVec3 eye = outside(target, 2);
    for (int i = 0; i < BUNDLE; i++)
        rays[i] = (RtRay){eye, 0, rt_sub(target->middle, eye), INFINITY, RT_RAY_RANDOM, 0};
}

/* Into one octant, but each its own way. */
static void scattered(Target *target, RtRay *rays) {
    for (int i = 0; i < BUNDLE; i++) {
        RtVec3 at = any_point(target), from = at;
        for (int a = 0; a < 3; a++) from.at[a] -= target->size * (0.01f + rt_random_unit(&target->random));
        from.x -= target->size; /* x is the major axis */
        rays[i] = (RtRay){from, 0, rt_sub(at, from), INFINITY, RT_RAY_DIFFUSE, 0};
    }
}

static void to_a_light(Target *target, RtRay *rays) {
    RtVec3 light = outside(target, 1.5f), middle = any_point(target);
    for (int i = 0; i < BUNDLE; i++) {
        RtVec3 from = rt_add(middle, rt_random_point(&target->random, 0.05f * target->size));
        rays[i] = (RtRay){from, 0, rt_sub(light, from), 1, RT_RAY_SHADOW, 0};
    }
}

/* With intervals of t that begin or end within the scene. */
static void bounded(Target *target, RtRay *rays) {
    pinhole(target, rays, outside(target, 1.2f), 0.05f);
    for (int i = 0; i < BUNDLE; i++) {
        rays[i].tmin = rt_random_between(&target->random, 0, 1);
        rays[i].tmax = rays[i].tmin + rt_random_between(&target->random, 0, 1);
    }
}

/* One component is 0, or -0, of all or of one in a packet; the rays start in a plane of a box. */
static void with_a_zero(Target *target, RtRay *rays) {
    uint32_t axis = rt_random_below(&target->random, 3), some = rt_random_bits(&target->random);
    const RtBox *box = target->box_count ? &target->boxes[rt_random_below(&target->random, target->box_count)]
                                         : &target->scene->geometry.box;
    RtVec3 eye = outside(target, 2);
    if (target->box_count) eye.at[axis] = (some & 1 ? box->lo : box->hi).at[axis];
    pinhole(target, rays, eye, 0.02f);
    bool negative = signbit(rays[0].dir.at[axis]);
    for (int i = 0; i < BUNDLE; i++) {
        if (some & 2 && i % 16 != (int)(some >> 8 & 15)) continue;
        rays[i].dir.at[axis] = negative != ((some & 4) != 0) ? -0.0f : 0.0f;
    }
}

/* A point of a triangle, or of its edge, in a plane across an axis; false where none was found. */
static bool point_in_plane(Target *target, int axis, float plane, RtVec3 *at) {
    const RtGeometry *g = &target->scene->geometry;
    for (int tries = 0; tries < 64 && g->triangle_count; tries++) {
        const RtVec3 *v = g->triangles[rt_random_below(&target->random, g->triangle_count)].v;
        RtVec3 ends[3];
        int count = 0;
        for (int i = 0; i < 3; i++) {
            RtVec3 a = v[i], b = v[(i + 1) % 3];
            float u = (plane - a.at[axis]) / (b.at[axis] - a.at[axis]);
            if (u >= 0 && u <= 1) ends[count++] = rt_add(a, rt_scale(rt_sub(b, a), u));
        }
        if (count < 2) continue;
        float w = tries % 2 ? rt_random_unit(&target->random) : 0;
        *at = rt_add(ends[0], rt_scale(rt_sub(ends[1], ends[0]), w));
        at->at[axis] = plane;
        return true;
    }
    return false;
}

/* All but in the planes that cut objects, where these are: a packet each. */
static void along_planes(Target *target, RtRay *rays) {
    from_outside(target, rays); /* where there is no better */
    for (int packet = 0; packet < BUNDLE && target->box_count; packet += 16) {
        int axis = (int)rt_random_below(&target->random, 3);
        uint32_t some = rt_random_bits(&target->random);
        const RtBox *box = &target->boxes[rt_random_below(&target->random, target->box_count)];
        RtVec3 at, from;
        float plane = (some & 1 ? box->lo : box->hi).at[axis];
        if (!point_in_plane(target, axis, plane, &at)) continue;
        from = rt_add(at, rt_random_point(&target->random, (some & 2 ? 1.0f : 100.0f) * target->size));
        if (some & 4) from = rt_vec3(0, 0, 0); /* where rounding the origin makes no ray thicker */
        from.at[axis] = plane;
        RtVec3 dir = rt_sub(at, from);
        for (int i = packet; i < packet + 16; i++) {
            rays[i] = (RtRay){from, 0, dir, INFINITY, RT_RAY_RANDOM, 0};
            for (int a = 0; a < 3; a++)
                rays[i].dir.at[a] *= 1 + rt_random_between(&target->random, 0, 0x1p-20f);
            rays[i].dir.at[axis] = (some & 8 ? 1e-12f : -1e-12f) * target->size;
        }
    }
}

/* As slivers ask for: each by itself, and a packet of each, for which it may have no zero. */
static void at_slivers(Target *target, RtRay *rays) {
    bool packets = rt_random_below(&target->random, 2);
    for (int i = 0; i < BUNDLE; i++) {
        const RtBox *box = &target->boxes[rt_random_below(&target->random, target->box_count)];
        if (packets && i % 16) {
            rays[i] = rays[i - 1];
            rays[i].dir.at[i % 3] *= 1 + 0x1p-22f;
            continue;
        }
        aim_at_slivers(&target->random, target->scene, box, &rays[i]);
        float *dir = rays[i].dir.at, tiny = 1e-12f * dir[rt_major_axis(rays[i].dir)];
        for (int a = 0; a < 3 && packets; a++) dir[a] = dir[a] == 0 ? tiny : dir[a];
    }
}

/* So long, or short, that float32 is nearly out of exponents, or that 1 / dir is infinite. */
static void odd_lengths(Target *target, RtRay *rays) {
    static const float factors[] = {0x1p-63f, 0x1p-70f, 0x1p-120f, 0x1p-140f, 0x1p63f, 0x1p70f, 0x1p100f};
    float factor = factors[rt_random_below(&target->random, 7)];
    pinhole(target, rays, outside(target, 2), 0.02f);
    for (int i = 0; i < BUNDLE; i++) rays[i].dir = rt_scale(rays[i].dir, factor);
}

/* Nearly along an axis, and so short that 1 / dir is infinite along the others, though the ray moves along
 * them too; and that some of the t are. A tree that divides objects has them elsewhere than such rays look.
 */
static void short_along_an_axis(Target *target, RtRay *rays) {
    RtRandom *random = &target->random;
    uint32_t axis = rt_random_below(random, 3);
    float length = target->size * (rt_random_below(random, 4) ? 0.3f : 6);
    for (int i = 0; i < BUNDLE; i++) {
        RtVec3 at = any_point(target), dir;
        for (uint32_t a = 0; a < 3; a++) dir.at[a] = a == axis ? 1 : rt_random_between(random, 0.01f, 0.2f);
        rays[i] = (RtRay){
            rt_sub(at, rt_scale(dir, length)), 0, rt_scale(dir, 0x1p-126f), INFINITY, RT_RAY_RANDOM, 0};
    }
}

/* Sixteen at a time whose first has one longest component and the others another that is as long. */
static void with_ties_of_axes(Target *target, RtRay *rays) {
    RtRandom *random = &target->random;
    for (int i = 0; i < BUNDLE; i++) {
        uint32_t axis = (uint32_t)(i / 16) % 3, other = (axis + 1 + rt_random_below(random, 2)) % 3;
        RtVec3 at = any_point(target), dir;
        for (int a = 0; a < 3; a++) dir.at[a] = target->size * rt_random_between(random, 0.1f, 0.9f);
        dir.at[axis] = target->size;
        if (i % 16) dir.at[other] = target->size;
        rays[i] = (RtRay){rt_sub(at, dir), 0, dir, INFINITY, RT_RAY_RANDOM, 0};
    }
}

typedef void Bundle(Target *target, RtRay *rays);
static Bundle *const bundles[] = {
    from_outside, from_within,  over_the_whole, from_far_away,       at_exact_points,
    parallel,     all_the_same, scattered,      to_a_light,          bounded,
    with_a_zero,  along_planes, odd_lengths,    short_along_an_axis, with_ties_of_axes};
enum { BUNDLES = sizeof bundles / sizeof bundles[0], RAYS = BUNDLES * ROUNDS * BUNDLE, ALL = 2 * RAYS };

/* Rays that are not valid, where a scene is tiny or huge, become one that is. */
static void make_rays(Target *target, RtRay *rays, Bundle *only) {
    for (size_t i = 0; i < RAYS; i += BUNDLE) (only ? only : bundles[i / BUNDLE % BUNDLES])(target, rays + i);
    for (int i = 0; i < RAYS; i++) {
        if (!rt_ray_is_valid(&rays[i]))
            rays[i] = (RtRay){target->middle, 0, {{1, 1, 1}}, INFINITY, RT_RAY_RANDOM, 0};
    }
}

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
    wide->base.ops->each_box(&wide->base, (RtBoxViewer){note_box, &target});
    rt_accel_destroy(&wide->base);
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
    OWNED_QUERY query = open_query(&wide->base);
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
                                       "in_flight=1",
                                       "build=spatial",
                                       "build=spatial,alpha=0,budget=16,max_leaf_size=1,order=off",
                                       "build=spatial,alpha=0,budget=4,whole=on",
                                       "build=spatial,alpha=0,sharing=0",
                                       "build=spatial,alpha=0,budget=16,max_leaf_size=1,sharing=0",
                                       "build=spatial,alpha=0,in_flight=1"};
enum { SETTINGS = sizeof settings / sizeof settings[0], HARD = 7 /* the last */ };

/* Takes the scene. Of `only` alone, at the settings that split references or fuse box tests; NULL: of
 * everything, at all. */
static void check(RtScene scene, uint64_t seed, Bundle *only) {
    static Bench bench;
    bench.scene = scene;
    set_up(&bench, seed, only);
    for (int isa = FIRST_SET; isa < INSTRUCTION_SETS; isa++) {
        for (int s = only ? SETTINGS - HARD : 0; s < SETTINGS; s++) {
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

/* Some scenes are just within, and just beyond, the limits of fused box tests. */
RT_TEST(hostile_rays_hit_slivers_as_by_brute) {
    const float scales[] = {1, 1, 1, 1e-20f, 1e16f, 0.01f, 2e-9f, 1e-9f},
                offsets[] = {0, 1e6f, 1e5f, 0, 0, -3000, 0, 0};
    for (int i = 0; i < 8; i++)
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
            OWNED_QUERY query = open_query(&wide->base);
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
