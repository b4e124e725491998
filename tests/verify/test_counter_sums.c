/* SPDX-License-Identifier: Apache-2.0 */
/* Counters are the same on any number of threads and in streams of any length, and plausible relative to
 * each other, for every accelerator at every setting of the sweep. */
#include "equivalence_testing.h"

#include "core/base/parallel.h"
#include "verify/verify.h"

enum { RAYS = RT_SHARE(3000, 600), PIECE = RAYS / 6 };

typedef struct Stage {
    RtScene scene;
    RtAccel *brute;
    RtRay rays[RAYS]; /* of all kinds in turn */
    RtHit hits[RAYS];
    uint64_t hits_by_kind[RT_RAY_KIND_COUNT];
} Stage;

typedef struct Count {
    const Stage *stage;
    const RtAccel *accel;
    size_t stream;
    bool backwards;                                                        /* the last piece first */
    RtQuery queries[3];                                                    /* a thread */
    RtTally nearest[3][RT_RAY_KIND_COUNT], occluded[3][RT_RAY_KIND_COUNT]; /* a thread and kind */
} Count;

static int set_up(void **state) {
    static Stage stage;
    stage.scene = open_family(scene_family("mixed"), 1);
    assert_ok(rt_accel_open("brute", &stage.scene, &stage.brute, error));
    RtQuery query;
    assert_ok(rt_query_init(&query, stage.brute, error));
    for (size_t i = 0; i < RAYS; i++) {
        rt_ray_family_fill(i % rt_ray_family_count(), &query, 1, i, 1, &stage.rays[i]);
        stage.rays[i].kind = (uint32_t)(i / 7 % RT_RAY_KIND_COUNT);
    }
    rt_nearest(&query, stage.rays, RAYS, stage.hits, NULL);
    for (size_t i = 0; i < RAYS; i++) {
        stage.hits_by_kind[stage.rays[i].kind] += stage.hits[i].object != RT_NO_OBJECT;
    }
    rt_query_clear(&query);
    *state = &stage;
    return 0;
}

static int tear_down(void **state) {
    Stage *stage = *state;
    rt_accel_destroy(stage->brute);
    rt_scene_clear(&stage->scene);
    return rt_alloc_live() == 0 ? 0 : -1;
}

static RtStatus count_piece(void *context, size_t piece, int thread, RtError *error) {
    (void)error;
    Count *count = context;
    if (count->backwards) piece = RAYS / PIECE - 1 - piece;
    const RtRay *piece_rays = count->stage->rays + piece * PIECE;
    RtHit hits[PIECE];
    bool blocked[PIECE];
    rt_query_begin(&count->queries[thread]);
    for (size_t first = 0; first < PIECE; first += count->stream) {
        size_t n = PIECE - first < count->stream ? PIECE - first : count->stream;
        rt_nearest(&count->queries[thread], piece_rays + first, n, hits, count->nearest[thread]);
        rt_occluded(&count->queries[thread], piece_rays + first, n, blocked, count->occluded[thread]);
    }
    return RT_OK;
}

/* Sums over `threads` threads go to the place of thread 0. */
static void count_all(Count *count, int threads) {
    for (int i = 0; i < threads; i++) assert_ok(rt_query_init(&count->queries[i], count->accel, error));
    assert_ok(rt_parallel_for(RAYS / PIECE, threads, count_piece, count, error));
    for (int i = 0; i < threads; i++) {
        rt_query_clear(&count->queries[i]);
        for (int kind = 0; i > 0 && kind < RT_RAY_KIND_COUNT; kind++) {
            rt_tally_add(&count->nearest[0][kind], &count->nearest[i][kind]);
            rt_tally_add(&count->occluded[0][kind], &count->occluded[i][kind]);
        }
    }
}

static void assert_plausible(const char *spec, const Stage *stage, const Count *count) {
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        const RtTally *both[2] = {&count->nearest[0][kind], &count->occluded[0][kind]};
        uint64_t rays_of_kind = 0;
        for (size_t i = 0; i < RAYS; i++) rays_of_kind += stage->rays[i].kind == (uint32_t)kind;
        for (int k = 0; k < 2; k++) {
            const RtTally *t = both[k];
            if (t->rays != rays_of_kind) fail_msg("%s: rays", spec);
            if (count->accel->exact && t->hits != stage->hits_by_kind[kind]) fail_msg("%s: hits", spec);
            if (!count->accel->counts) continue;
            if (t->object_hits > t->object_tests) fail_msg("%s: more object hits than tests", spec);
            if (t->object_hits < t->hits) fail_msg("%s: fewer object hits than hits", spec);
            if (t->leaf_steps > t->steps) fail_msg("%s: more leaves visited than steps", spec);
            if (t->empty_steps > t->leaf_steps) fail_msg("%s: more empty leaves than leaves", spec);
        }
    }
}

RT_TEST(counts_do_not_depend_on_threads_or_streams) {
    const Stage *stage = *state;
    const struct {
        int threads;
        size_t stream;
        bool backwards;
    } ways[] = {{2, 1, false}, {3, PIECE, false}, {2, 7, false}, {1, 64, true}};
    for (size_t i = 0; i < rt_accel_count(); i++) {
        char spec[RT_MAX_SPEC_CHARS];
        for (size_t n = 0; rt_spread_spec(rt_accel_at(i), n, spec); n++) {
            OWNED_ACCEL RtAccel *accel = open_available(&stage->scene, spec, 0);
            if (!accel) continue;
            assert_ok(rt_accel_learn(accel, stage->rays, stage->hits, RAYS, error));
            static Count first, other;
            first = (Count){.stage = stage, .accel = accel, .stream = 1};
            count_all(&first, 1);
            assert_plausible(spec, stage, &first);
            for (size_t w = 0; accel->counts && w < sizeof ways / sizeof ways[0]; w++) {
                other = (Count){
                    .stage = stage, .accel = accel, .stream = ways[w].stream, .backwards = ways[w].backwards};
                count_all(&other, ways[w].threads);
                if (memcmp(first.nearest[0], other.nearest[0], sizeof first.nearest[0]) != 0 ||
                    memcmp(first.occluded[0], other.occluded[0], sizeof first.occluded[0]) != 0) {
                    fail_msg("%s: other counts on %d threads in streams of %zu", spec, ways[w].threads,
                             ways[w].stream);
                }
            }
        }
    }
}

RT_TESTS(counter_sums, set_up, tear_down)
