/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/plugin/query.h"

#include "accel/kernel.h"
#include "accel/plugin/guard.h"
#include "accel/plugin/now.h"
#include "core/base/memory.h"

#include <inttypes.h>
#include <string.h>

/* The layouts that both sides have in common. */
_Static_assert(sizeof(raytally_ray) == sizeof(RtRay) && offsetof(raytally_ray, dir) == offsetof(RtRay, dir) &&
                   offsetof(raytally_ray, source) == offsetof(RtRay, source) &&
                   (int)RAYTALLY_RAY_KINDS == (int)RT_RAY_KIND_COUNT,
               "rays");
_Static_assert(sizeof(raytally_hit) == sizeof(RtHit) && RAYTALLY_NO_OBJECT == RT_NO_OBJECT, "hits");
_Static_assert(sizeof(raytally_box) == sizeof(RtBox), "boxes");
_Static_assert(sizeof(RtPreparedRay) <= sizeof(((raytally_prepared *)0)->own), "a prepared ray fits");

/* What a query has. The plugin sees the first member alone. */
typedef struct PluginQuery {
    raytally_query face;
    RtPluginNow now;
    RtPluginAccel *accel;
    const RtGeometry *geometry;
    RtCrossing *room;
    RtGuarded own;     /* of `memory` */
    RtGuarded answers; /* of a stream of at most MOST_ANSWERS */
    void *memory;      /* [accel->query_bytes] or NULL */
    bool counting;
    RtTally tallies[RT_RAY_KIND_COUNT]; /* of object tests, in a stream that is counted */
} PluginQuery;

/* ---- what is said of one that went wrong ---- */

enum { MOST_QUERIES = 2048 }; /* of which the ray of a crash is known */
static _Atomic(PluginQuery *) open_queries[MOST_QUERIES];
static _Thread_local const RtPluginNow *now;

const RtPluginNow *rt_plugin_now(void) {
    return now;
}

const RtPluginNow *rt_plugin_busy(void) {
    for (int i = 0; i < MOST_QUERIES; i++) {
        const PluginQuery *query = atomic_load(&open_queries[i]);
        if (query && query->now.ray) return &query->now;
    }
    return NULL;
}

void rt_plugin_say(RtPluginAccel *accel, const RtError *what) {
    pthread_mutex_lock(&accel->lock);
    if (!accel->nonsense) accel->said = *what;
    accel->nonsense = true;
    pthread_mutex_unlock(&accel->lock);
}

static void say_of_ray(RtPluginAccel *accel, const RtRay *ray, const char *what, uint32_t object) {
    RtError said;
    char text[RT_RAY_TEXT];
    rt_ray_format(ray, text, sizeof text);
    rt_fail(&said, RT_BROKEN, "%s, %u (the scene has %u objects), for the ray %s", what, object,
            accel->base.scene->geometry.object_count, text);
    rt_plugin_say(accel, &said);
}

/* ---- what the plugin calls ---- */

static void prepare(raytally_query *face, const raytally_ray *ray, raytally_prepared *out) {
    PluginQuery *query = (PluginQuery *)face;
    RtPreparedRay *own = (RtPreparedRay *)out->own;
    query->now.ray = (const RtRay *)ray;
    rt_hit_ray(own, query->geometry, (const RtRay *)ray, query->room);
    out->tmin = own->tmin;
    out->tmax = own->tmax;
    memcpy(out->org, &own->org, 3 * sizeof(float));
    memcpy(out->dir, &own->dir, 3 * sizeof(float));
    out->org[3] = out->dir[3] = 0;
    memcpy(out->inv, own->inv, sizeof out->inv);
    memcpy(out->org_near, own->org_near, sizeof out->org_near);
    memcpy(out->org_far, own->org_far, sizeof out->org_far);
    memcpy(out->negative, own->negative, sizeof out->negative);
    memcpy(out->first, own->first, sizeof out->first);
    memcpy(out->last, own->last, sizeof out->last);
    out->ray = ray;
    out->query = face;
}

RT_KERNEL int hits_of(const raytally_prepared *ray, const uint32_t *ids, uint32_t count, bool any,
                      raytally_hit *best, RtTally *tally) {
    PluginQuery *query = (PluginQuery *)ray->query;
    const RtGeometry *geometry = query->geometry;
    const RtPreparedRay *own = (const RtPreparedRay *)ray->own;
    RtHit hit = {best->t, best->object};
    bool over = false;
    for (uint32_t i = 0; i < count && !over; i++) {
        if (ids[i] >= geometry->object_count) {
            say_of_ray(query->accel, own->original, "it asked for a test of an object that there is not",
                       ids[i]);
            break;
        }
        over = rt_test_object(geometry, ids[i], own, any, &hit, tally);
    }
    *best = (raytally_hit){hit.t, hit.object};
    return over;
}

static int object_hits(const raytally_prepared *ray, const uint32_t *ids, uint32_t count, int any,
                       raytally_hit *best, raytally_counters *counters) {
    PluginQuery *query = (PluginQuery *)ray->query;
    if (!query->counting) return hits_of(ray, ids, count, any, best, NULL);
    RtTally tally = {0};
    int over = hits_of(ray, ids, count, any, best, &tally);
    rt_tally_add(&query->tallies[ray->ray->kind], &tally);
    if (!counters) return over;
    counters->at[RAYTALLY_OBJECT_TESTS] += tally.object_tests;
    counters->at[RAYTALLY_OBJECT_HITS] += tally.object_hits;
    counters->at[RAYTALLY_CSG_TESTS] += tally.csg_tests;
    return over;
}

static const raytally_host host = {RAYTALLY_ACCEL_ABI, sizeof(raytally_host), prepare, object_hits};

/* ---- queries ---- */

enum { CANARIES = 1024, MOST_ANSWERS = 4096, UNSET = 0xFE };

/* Around the memory of a query, to the ends of its pages. */
static void lay_canaries(const PluginQuery *query) {
    char *memory = query->memory, *begin = query->own.begin, *end = memory + query->accel->query_bytes;
    rt_canaries_lay(begin, memory);
    rt_canaries_lay(end, query->own.end);
}

static bool wrote_beside_memory(const PluginQuery *query) {
    const char *memory = query->memory;
    if (!memory) return false;
    return !rt_canaries_live(query->own.begin, memory) ||
           !rt_canaries_live(memory + query->accel->query_bytes, query->own.end);
}

static RtStatus map_memory(PluginQuery *query, RtError *error) {
    size_t wanted = query->accel->query_bytes;
    if (wanted > RT_ACCEL_MAX_BYTES)
        return rt_fail(error, RT_BROKEN, "its query_bytes asks for %zu bytes for each query", wanted);
    size_t used = (wanted + RT_CACHE_LINE - 1) / RT_CACHE_LINE * RT_CACHE_LINE;
    RT_TRY(rt_guarded_map(&query->answers, CANARIES + MOST_ANSWERS * sizeof(RtHit),
                          &query->now.guards[RT_GUARD_ANSWERS], error));
    if (wanted == 0) return RT_OK;
    RtStatus status = rt_guarded_map(&query->own, used, &query->now.guards[RT_GUARD_QUERY], error);
    if (status != RT_OK) {
        rt_guarded_unmap(&query->answers);
        return status;
    }
    query->memory = query->own.end - used;
    lay_canaries(query);
    return RT_OK;
}

static RtStatus open_query(const RtAccel *accel, void *scratch, RtError *error) {
    PluginQuery *query = scratch;
    *query = (PluginQuery){
        .face.host = &host, .accel = (RtPluginAccel *)accel, .geometry = &accel->scene->geometry};
    RT_TRY(map_memory(query, error));
    for (int i = 0; i < MOST_QUERIES; i++) {
        PluginQuery *none = NULL;
        if (atomic_compare_exchange_strong(&open_queries[i], &none, query)) break;
    }
    return RT_OK;
}

static void close_query(const RtAccel *accel, void *scratch) {
    (void)accel;
    PluginQuery *query = scratch;
    for (int i = 0; i < MOST_QUERIES; i++) {
        PluginQuery *own = query;
        atomic_compare_exchange_strong(&open_queries[i], &own, NULL);
    }
    rt_guarded_unmap(&query->own);
    rt_guarded_unmap(&query->answers);
}

static void begin(const RtAccel *accel, void *scratch) {
    const RtPluginAccel *self = rt_plugin_of(accel);
    if (self->table->begin) self->table->begin(self->self, ((PluginQuery *)scratch)->memory);
}

/* ---- kernels ---- */

/* Before a stream: where its answers go, [count] of `size` bytes, none of which is one yet. */
static void *enter(PluginQuery *query, const RtScratch *scratch, const RtRay *rays, size_t count,
                   size_t size) {
    char *answers = query->answers.end - count * size;
    rt_canaries_lay(answers - CANARIES, answers);
    memset(answers, UNSET, count * size);
    query->room = scratch->room;
    query->now.ray = rays;
    now = &query->now;
    return answers;
}

/* Behind it. */
static void leave(PluginQuery *query, const char *answers) {
    RtError said;
    query->now.ray = NULL;
    now = NULL;
    if (!rt_canaries_live(answers - CANARIES, answers)) {
        rt_fail(&said, RT_BROKEN, "it wrote in front of its answers");
        rt_plugin_say(query->accel, &said);
    }
    if (wrote_beside_memory(query)) {
        rt_fail(&said, RT_BROKEN, "it wrote past the %zu bytes of its query's memory, or in front of them",
                query->accel->query_bytes);
        rt_plugin_say(query->accel, &said);
    }
}

/* An object that there is not. */
static void say_of_object(RtPluginAccel *accel, const RtRay *ray, uint32_t object) {
    uint32_t unset;
    memset(&unset, UNSET, sizeof unset);
    say_of_ray(accel, ray,
               object == unset ? "it wrote no answer" : "it answered with an object that there is not",
               object);
}

static void look_at_hits(PluginQuery *query, const RtRay *rays, size_t count, RtHit *hits) {
    RtPluginAccel *accel = query->accel;
    const uint32_t objects = accel->base.scene->geometry.object_count;
    for (size_t i = 0; i < count; i++) {
        RtHit hit = hits[i];
        bool miss = hit.object == RT_NO_OBJECT && hit.t == INFINITY;
        if (miss || (hit.object < objects && hit.t >= rays[i].tmin && hit.t <= rays[i].tmax)) continue;
        hits[i] = RT_MISS;
        if (hit.object < objects || hit.object == RT_NO_OBJECT) {
            RtError said;
            char text[RT_RAY_TEXT];
            rt_ray_format(&rays[i], text, sizeof text);
            rt_fail(&said, RT_BROKEN, "it answered %s at t = %.9g, which is not on the ray %s",
                    hit.object == RT_NO_OBJECT ? "no object" : "an object", (double)hit.t, text);
            rt_plugin_say(accel, &said);
        } else {
            say_of_object(accel, &rays[i], hit.object);
        }
    }
}

/* Whether each occluder is on its ray, by its exact hit: where there is time for it, in streams that are
 * counted. */
static void test_occluders(PluginQuery *query, const RtRay *rays, size_t count, const uint32_t *occluders) {
    for (size_t i = 0; i < count; i++) {
        RtPreparedRay ray;
        float t;
        if (occluders[i] == RT_NO_OBJECT) continue;
        rt_hit_ray(&ray, query->geometry, &rays[i], query->room);
        if (rt_object_hit(query->geometry, occluders[i], &ray, &t, NULL)) continue;
        say_of_ray(query->accel, &rays[i],
                   "it answered that an object is in the way that the ray does not hit", occluders[i]);
    }
}

static void look_at_occluders(PluginQuery *query, const RtRay *rays, size_t count, uint32_t *occluders) {
    RtPluginAccel *accel = query->accel;
    const uint32_t objects = accel->base.scene->geometry.object_count;
    for (size_t i = 0; i < count; i++) {
        if (occluders[i] < objects || occluders[i] == RT_NO_OBJECT) continue;
        say_of_object(accel, &rays[i], occluders[i]);
        occluders[i] = RT_NO_OBJECT;
    }
    if (query->counting) test_occluders(query, rays, count, occluders);
}

/* The counters of a plugin's own, and those that object_hits counts. Rays and hits are counted here, and an
 * overlay, which passes rays on, no plugin is. X(CONSTANT, name) */
#define OWN_COUNTERS(X)                                                                                      \
    X(EXTENT_TESTS, extent_tests)                                                                            \
    X(STEPS, steps)                                                                                          \
    X(LEAF_STEPS, leaf_steps)                                                                                \
    X(EMPTY_STEPS, empty_steps)                                                                              \
    X(REPEATS_AVOIDED, repeats_avoided)
#define OBJECT_COUNTERS(X)                                                                                   \
    X(OBJECT_TESTS, object_tests)                                                                            \
    X(OBJECT_HITS, object_hits)                                                                              \
    X(CSG_TESTS, csg_tests)

#define ONE(CONSTANT, name) +1
_Static_assert(2 OWN_COUNTERS(ONE) OBJECT_COUNTERS(ONE) + 1 == RT_TALLY_COUNTER_COUNT,
               "a counter is a plugin's, or counted here");

/* No ray costs so much: what is beyond has been counted backwards, or is of memory that was never set. */
#define MOST_A_RAY (UINT64_C(1) << 32)

static void say_of_excess(RtPluginAccel *accel, RtRayKind kind, const char *what, uint64_t counted) {
    RtError said;
    rt_fail(&said, RT_BROKEN, "it counted %" PRIu64 " %s for %s rays, more than there can be", counted, what,
            rt_ray_kind_name(kind));
    rt_plugin_say(accel, &said);
}

static void say_of_counts(RtPluginAccel *accel, RtRayKind kind, const char *what, uint64_t counted,
                          uint64_t right) {
    RtError said;
    rt_fail(&said, RT_BROKEN,
            "its %s for %s rays add up to %" PRIu64 ", and were %" PRIu64
            ": raytally_object_hits counts them, in the counters that it is given",
            what, rt_ray_kind_name(kind), counted, right);
    rt_plugin_say(accel, &said);
}

/* Of a stream of so many rays. */
static void add_counters(PluginQuery *query, const raytally_counters *counted, size_t rays,
                         RtTally *tallies) {
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        const uint64_t *at = counted[kind].at;
        const RtTally *right = &query->tallies[kind];
#define ADD_OWN(CONSTANT, name)                                                                              \
    if (at[RAYTALLY_##CONSTANT] <= rays * MOST_A_RAY)                                                        \
        tallies[kind].name += at[RAYTALLY_##CONSTANT];                                                       \
    else                                                                                                     \
        say_of_excess(query->accel, (RtRayKind)kind, #name, at[RAYTALLY_##CONSTANT]);
#define ADD_RIGHT(CONSTANT, name)                                                                            \
    tallies[kind].name += right->name;                                                                       \
    if (at[RAYTALLY_##CONSTANT] != right->name)                                                              \
        say_of_counts(query->accel, (RtRayKind)kind, #name, at[RAYTALLY_##CONSTANT], right->name);
        OWN_COUNTERS(ADD_OWN)
        OBJECT_COUNTERS(ADD_RIGHT)
    }
}

static void count_from_here(PluginQuery *query) {
    query->counting = true;
    memset(query->tallies, 0, sizeof query->tallies);
}

/* The two kernels of a question, whose answers are of type Answer, or Theirs as the plugin calls it. */
#define DEFINE_KERNELS(question, Answer, Theirs, look_at, is_hit)                                            \
    static void question##_some(PluginQuery *query, const RtScratch *scratch, const RtRay *rays,             \
                                size_t count, Answer *answers, raytally_counters *counters) {                \
        RtPluginAccel *accel = query->accel;                                                                 \
        Answer *theirs = enter(query, scratch, rays, count, sizeof(Answer));                                 \
        accel->table->question(accel->self, query->memory, &query->face, (const raytally_ray *)rays, count,  \
                               (Theirs *)theirs, counters);                                                  \
        leave(query, (const char *)theirs);                                                                  \
        look_at(query, rays, count, theirs);                                                                 \
        memcpy(answers, theirs, count * sizeof(Answer));                                                     \
    }                                                                                                        \
    static void ask_##question(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,            \
                               size_t count, Answer *answers) {                                              \
        (void)accel;                                                                                         \
        for (size_t first = 0; first < count; first += MOST_ANSWERS) {                                       \
            size_t n = count - first < MOST_ANSWERS ? count - first : MOST_ANSWERS;                          \
            question##_some(scratch->own, scratch, rays + first, n, answers + first, NULL);                  \
        }                                                                                                    \
    }                                                                                                        \
    static void count_##question(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,          \
                                 size_t count, Answer *answers, RtTally *tallies) {                          \
        (void)accel;                                                                                         \
        PluginQuery *query = scratch->own;                                                                   \
        for (size_t first = 0; first < count; first += MOST_ANSWERS) {                                       \
            size_t n = count - first < MOST_ANSWERS ? count - first : MOST_ANSWERS;                          \
            raytally_counters counters[RAYTALLY_RAY_KINDS] = {0};                                            \
            count_from_here(query);                                                                          \
            question##_some(query, scratch, rays + first, n, answers + first, counters);                     \
            query->counting = false;                                                                         \
            add_counters(query, counters, n, tallies);                                                       \
        }                                                                                                    \
        for (size_t i = 0; i < count; i++) {                                                                 \
            tallies[rays[i].kind].rays++;                                                                    \
            tallies[rays[i].kind].hits += (is_hit);                                                          \
        }                                                                                                    \
    }
DEFINE_KERNELS(nearest, RtHit, raytally_hit, look_at_hits, answers[i].object != RT_NO_OBJECT)
DEFINE_KERNELS(occluded, uint32_t, uint32_t, look_at_occluders, answers[i] != RT_NO_OBJECT)

static RtStatus check(const RtAccel *accel, RtError *error) {
    const RtPluginAccel *self = rt_plugin_of(accel);
    return self->nonsense ? rt_fail(error, RT_BROKEN, "%s", self->said.message) : RT_OK;
}

static size_t scratch_bytes(const RtAccel *accel) {
    (void)accel;
    return sizeof(PluginQuery);
}

void rt_plugin_query_ops(RtAccelOps *ops) {
    ops->nearest = ask_nearest;
    ops->occluded = ask_occluded;
    ops->nearest_counted = count_nearest;
    ops->occluded_counted = count_occluded;
    ops->scratch_bytes = scratch_bytes;
    ops->open = open_query;
    ops->close = close_query;
    ops->begin = begin;
    ops->check = check;
}
