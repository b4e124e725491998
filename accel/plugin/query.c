/* SPDX-License-Identifier: Apache-2.0 */
/* Queries of a plugin's accelerator. Each has a mapping of its own: the answers and the plugin's memory, both
 * between guard pages. Each answer is checked before anything else reads it. */
#include "accel/plugin/host.h"

#include "accel/kernel.h"
#include "accel/remote.h"
#include "core/base/memory.h"
#include "core/base/observe.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* Types of the interface have the layout of raytally's own. */
_Static_assert(sizeof(raytally_ray) == sizeof(RtRay) && offsetof(raytally_ray, dir) == offsetof(RtRay, dir) &&
                   offsetof(raytally_ray, source) == offsetof(RtRay, source) &&
                   (int)RAYTALLY_RAY_KINDS == (int)RT_RAY_KIND_COUNT,
               "rays");
_Static_assert(sizeof(raytally_hit) == sizeof(RtHit) && RAYTALLY_NO_OBJECT == RT_NO_OBJECT, "hits");
_Static_assert((uint64_t)RAYTALLY_UNNAMED_OBJECT == RT_UNNAMED_OBJECT, "occluders");
_Static_assert(sizeof(raytally_box) == sizeof(RtBox), "boxes");
_Static_assert((int)RAYTALLY_SHAPE_SPHERE == (int)RT_SHAPE_SPHERE &&
                   (int)RAYTALLY_SHAPE_TRIANGLE == (int)RT_SHAPE_TRIANGLE &&
                   (int)RAYTALLY_INDEX_BITS == (int)RT_REF_INDEX_BITS,
               "references to objects");

typedef struct Events {
    const char *name;                  /* of the accelerator */
    const raytally_counters *counters; /* of the ray's kind, which the plugin counts in; NULL: none */
    raytally_counters shown;           /* so many of them became events */
    RtHit best;                        /* so far */
} Events;

/* The plugin sees only the first member of the first. */
typedef struct PluginQuery {
    RtPluginNow now;
    RtPluginAccel *accel;
    const RtGeometry *geometry;
    void *memory;             /* [accel->query_bytes] or NULL */
    const RtScratch *scratch; /* of this layer and those below */
    bool counting;
    /* In a stream that is counted: of object tests, and of the layers below. */
    RtTally tallies[RT_RAY_KIND_COUNT], below[RT_RAY_KIND_COUNT];
    Events events;
} PluginQuery;

/* ---- reports ---- */

enum { MOST_QUERIES = 2048 }; /* whose ray can be reported after a hang */
static _Atomic(PluginQuery *) open_queries[MOST_QUERIES];
static _Thread_local const RtPluginNow *now;

const RtPluginNow *rt_plugin_now(void) {
    return now;
}

const RtPluginNow *rt_plugin_busy(void) {
    for (int i = 0; i < MOST_QUERIES; i++) {
        const PluginQuery *query = atomic_load(&open_queries[i]);
        if (query && query->now.face.ray) return &query->now;
    }
    return NULL;
}

void rt_plugin_break(RtPluginAccel *accel, const char *what, ...) {
    char text[sizeof accel->error.message];
    va_list arguments;
    va_start(arguments, what);
    vsnprintf(text, sizeof text, what, arguments);
    va_end(arguments);
    pthread_mutex_lock(&accel->lock);
    if (!accel->broken) rt_fail(&accel->error, RT_BROKEN, "%s", text);
    accel->broken = true;
    pthread_mutex_unlock(&accel->lock);
}

static void break_at_ray(RtPluginAccel *accel, const RtRay *ray, const char *what, uint32_t object) {
    char text[RT_RAY_TEXT];
    rt_ray_format(ray, text, sizeof text);
    rt_plugin_break(accel, "%s, %u (the scene has %u objects), for the ray %s", what, object,
                    accel->base.scene->geometry.object_count, text);
}

/* ---- the events of a ray that is traced for an observer ---- */

/* Object tests and built-in layers report theirs, as everywhere (core/base/observe.h). A plugin counts its
 * steps and extent tests, and may show each (raytally_show); what it counts and does not show becomes an
 * event without a name and a box, before the next object test. */

/* Beyond that it counted below zero, and breaks. */
enum { MOST_COUNTED = 1 << 24 };

/* Whether the plugin counted something that was not shown yet; then it counts as shown. */
static bool take(Events *events, int counter) {
    const uint64_t counted = events->counters->at[counter];
    if (events->shown.at[counter] >= counted || counted > MOST_COUNTED) return false;
    events->shown.at[counter]++;
    return true;
}

static RtTraced next_step(Events *events) {
    const bool leaf = take(events, RAYTALLY_LEAF_STEPS), empty = take(events, RAYTALLY_EMPTY_STEPS);
    return (RtTraced){.kind = RT_TRACED_STEP, .leaf = leaf, .empty = empty};
}

/* All events except those of `but`. */
static void catch_up(Events *events, int but) {
    static const struct {
        int counter;
        RtTracedKind kind;
    } others[] = {{RAYTALLY_EXTENT_TESTS, RT_TRACED_EXTENT_TEST},
                  {RAYTALLY_REPEATS_AVOIDED, RT_TRACED_REPEAT_AVOIDED},
                  {RAYTALLY_PASSED_ON, RT_TRACED_PASSED_ON}};
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++) {
        const char *what = others[i].kind == RT_TRACED_PASSED_ON ? events->name : NULL;
        while (others[i].counter != but && take(events, others[i].counter))
            rt_observe(&(RtTraced){.kind = others[i].kind, .what = what, .index = RT_NO_OBJECT});
    }
    while (but != RAYTALLY_STEPS && take(events, RAYTALLY_STEPS)) {
        const RtTraced step = next_step(events);
        rt_observe(&step);
    }
}

static void report_counted(Events *events) {
    if (rt_trace_observer && events->counters) catch_up(events, RAYTALLY_COUNTERS);
}

/* ---- what the plugin calls ---- */

static void prepare(raytally_query *query, const raytally_ray *ray, raytally_prepared *out) {
    raytally_prepare(query, ray, out);
}

static int other_hit(const raytally_prepared *ray, uint32_t id, float *t) {
    return rt_rarer_hit(((PluginQuery *)ray->query)->geometry, id, ray, t, NULL);
}

RT_KERNEL int hits_of(const raytally_prepared *ray, const uint32_t *ids, uint32_t count, bool any,
                      raytally_hit *best, RtTally *tally) {
    PluginQuery *query = (PluginQuery *)ray->query;
    const RtGeometry *geometry = query->geometry;
    RtHit hit = {best->t, best->object};
    bool over = false;
    for (uint32_t i = 0; i < count && !over; i++) {
        if (ids[i] >= geometry->object_count) {
            break_at_ray(query->accel, (const RtRay *)ray->ray, "it tested an object that does not exist",
                         ids[i]);
            break;
        }
        over = rt_test_object(geometry, ids[i], ray, any, &hit, tally);
    }
    *best = (raytally_hit){hit.t, hit.object};
    return over;
}

static int object_hits(const raytally_prepared *ray, const uint32_t *ids, uint32_t count, int any,
                       raytally_hit *best, raytally_counters *counters) {
    PluginQuery *query = (PluginQuery *)ray->query;
    if (!query->counting) return hits_of(ray, ids, count, any, best, NULL);
    RtTally tally = {0};
    report_counted(&query->events);
    int over = hits_of(ray, ids, count, any, best, &tally);
    query->events.best = (RtHit){best->t, best->object};
    rt_tally_add(&query->tallies[ray->ray->kind], &tally);
    if (!counters) return over;
    counters->at[RAYTALLY_OBJECT_TESTS] += tally.object_tests;
    counters->at[RAYTALLY_OBJECT_HITS] += tally.object_hits;
    counters->at[RAYTALLY_CSG_TESTS] += tally.csg_tests;
    return over;
}

/* The rays may be the plugin's own. They are checked only in counted streams, because it takes time. */
static bool can_pass_on(PluginQuery *query, const RtRay *rays, size_t count) {
    char text[RT_RAY_TEXT];
    if (!query->accel->base.below) {
        rt_plugin_break(query->accel, "it passes rays on, but its `flags` lack RAYTALLY_OVERLAY");
        return false;
    }
    for (size_t i = 0; i < count && query->counting; i++) {
        if (rt_ray_is_valid(&rays[i]) && rays[i].kind < RT_RAY_KIND_COUNT) continue;
        rt_ray_format(&rays[i], text, sizeof text);
        rt_plugin_break(query->accel, "it passed on a ray that is not valid, of kind %u, %s", rays[i].kind,
                        text);
        return false;
    }
    return true;
}

/* Traces a stream in the layer below, which may be a plugin's, too. */
#define DEFINE_BELOW(question, Answer, Theirs, miss)                                                         \
    static void question##_below(raytally_query *face, const raytally_ray *rays, size_t count,               \
                                 Theirs *answers) {                                                          \
        PluginQuery *query = (PluginQuery *)face;                                                            \
        const RtRay *stream = (const RtRay *)rays;                                                           \
        Answer *out = (Answer *)answers;                                                                     \
        report_counted(&query->events);                                                                      \
        if (can_pass_on(query, stream, count)) {                                                             \
            rt_hand_down_##question(&query->accel->base, query->scratch, stream, count, out,                 \
                                    query->counting ? query->below : NULL);                                  \
        } else {                                                                                             \
            for (size_t i = 0; i < count; i++) out[i] = miss;                                                \
        }                                                                                                    \
        now = &query->now;                                                                                   \
    }
DEFINE_BELOW(nearest, RtHit, raytally_hit, RT_MISS)
DEFINE_BELOW(occluded, uint32_t, uint32_t, RT_NO_OBJECT)

static void show(const raytally_prepared *ray, uint32_t counter, uint32_t number,
                 const raytally_box *theirs) {
    Events *events = &((PluginQuery *)ray->query)->events;
    RtBox box;
    RtTraced event = {.kind = RT_TRACED_EXTENT_TEST};
    float enter;
    if (!events->counters || !(counter == RAYTALLY_STEPS || (counter == RAYTALLY_EXTENT_TESTS && theirs)))
        return;
    catch_up(events, (int)counter);
    if (!take(events, (int)counter)) return;
    if (counter == RAYTALLY_STEPS) event = next_step(events);
    event.what = "node";
    event.index = number;
    if (theirs) {
        memcpy(&box, theirs, sizeof box);
        event.box = &box;
        event.met = counter == RAYTALLY_EXTENT_TESTS &&
                    raytally_box_hit(theirs, ray, rt_limit(ray, &events->best), &enter);
    }
    rt_observe(&event);
}

#define HOST(show_or_null)                                                                                   \
    {                                                                                                        \
        RAYTALLY_ACCEL_ABI, sizeof(raytally_host), prepare, object_hits, other_hit, nearest_below,           \
            occluded_below, show_or_null                                                                     \
    }
static const raytally_host host = HOST(NULL), observed_host = HOST(show);

/* ---- memory between guard pages ---- */

enum { GUARD = 64 * 1024, CANARY = 0xA5, CANARIES = 1024, MOST_ANSWERS = 4096, UNSET = 0xFE };

/* Maps at least `bytes`, set to zero. */
static RtStatus map_guarded(RtGuarded *guarded, size_t bytes, RtError *error) {
    size_t page = (size_t)sysconf(_SC_PAGESIZE), pages = (bytes + page - 1) / page * page;
    size_t mapped = pages + 2 * (size_t)GUARD;
    char *mapping = mmap(NULL, mapped, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapping != MAP_FAILED && mprotect(mapping + GUARD, pages, PROT_READ | PROT_WRITE) == 0) {
        *guarded = (RtGuarded){mapping, mapped, mapping + GUARD, mapping + GUARD + pages};
        return RT_OK;
    }
    if (mapping != MAP_FAILED) munmap(mapping, mapped);
    return rt_fail_memory(error, "the memory of a plugin's query", bytes);
}

static void unmap_guarded(RtGuarded *guarded) {
    if (guarded->mapping) munmap(guarded->mapping, guarded->mapped);
    *guarded = (RtGuarded){0};
}

static void lay_canaries(char *from, const char *end) {
    memset(from, CANARY, (size_t)(end - from));
}

/* All bytes are CANARY if the first is and each equals the one before. */
static bool canaries_are_intact(const char *from, const char *end) {
    size_t bytes = (size_t)(end - from);
    return bytes == 0 || ((unsigned char)*from == CANARY && memcmp(from, from + 1, bytes - 1) == 0);
}

static void unmap_memory(PluginQuery *query) {
    for (int i = 0; i < RT_GUARD_COUNT; i++) unmap_guarded(&query->now.guarded[i]);
}

static bool wrote_beside_memory(const PluginQuery *query) {
    const char *memory = query->memory;
    const RtGuarded *own = &query->now.guarded[RT_GUARD_QUERY];
    return memory && !(canaries_are_intact(own->begin, memory) &&
                       canaries_are_intact(memory + query->accel->query_bytes, own->end));
}

static RtStatus map_memory(PluginQuery *query, RtError *error) {
    const size_t wanted = query->accel->query_bytes;
    RtGuarded *own = &query->now.guarded[RT_GUARD_QUERY];
    if (wanted > RT_ACCEL_MAX_BYTES)
        return rt_fail(error, RT_BROKEN, "its query_bytes asks for %zu bytes for each query", wanted);
    RT_TRY(
        map_guarded(&query->now.guarded[RT_GUARD_ANSWERS], CANARIES + MOST_ANSWERS * sizeof(RtHit), error));
    if (wanted == 0) return RT_OK;
    const size_t used = (wanted + RT_CACHE_LINE - 1) / RT_CACHE_LINE * RT_CACHE_LINE;
    RT_TRY(map_guarded(own, used, error));
    char *memory = query->memory = own->end - used;
    lay_canaries(own->begin, memory);
    lay_canaries(memory + wanted, own->end);
    return RT_OK;
}

/* ---- queries ---- */

static RtStatus open_query(const RtAccel *accel, void *scratch, RtError *error) {
    PluginQuery *query = scratch;
    const RtGeometry *geometry = &accel->scene->geometry;
    *query = (PluginQuery){.now.face = {.boxes = rt_public_box(geometry->boxes),
                                        .triangles = (const float *)geometry->triangles,
                                        .spheres = (const float *)geometry->spheres,
                                        .objects = geometry->objects},
                           .accel = (RtPluginAccel *)accel,
                           .geometry = geometry};
    memcpy(&query->now.face.box, &geometry->box, sizeof geometry->box);
    for (const RtAccel *layer = accel; layer; layer = layer->below) query->now.layers++;
    RtStatus status = map_memory(query, error);
    if (status != RT_OK) {
        unmap_memory(query);
        return status;
    }
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
    unmap_memory(query);
}

static void begin(const RtAccel *accel, void *scratch) {
    const RtPluginAccel *self = rt_plugin_of(accel);
    if (self->table->begin) self->table->begin(self->self, ((PluginQuery *)scratch)->memory);
}

/* ---- kernels ---- */

/* Before a stream: returns memory for `count` answers of `size` bytes, set to no valid answer. */
static void *enter(PluginQuery *query, const RtScratch *scratch, const RtRay *rays, size_t count,
                   size_t size) {
    char *answers = query->now.guarded[RT_GUARD_ANSWERS].end - count * size;
    lay_canaries(answers - CANARIES, answers);
    memset(answers, UNSET, count * size);
    query->now.stream = rays;
    query->now.count = count;
    query->now.any = size != sizeof(RtHit);
    query->now.counted = query->counting;
    query->now.face.host = query->counting && rt_trace_observer ? &observed_host : &host;
    query->now.face.crossings = scratch->crossings;
    query->scratch = scratch;
    query->now.face.object_count = query->counting ? 0 : query->geometry->object_count;
    query->now.face.ray = (const raytally_ray *)rays;
    now = &query->now;
    return answers;
}

/* After a stream. */
static void leave(PluginQuery *query, const char *answers) {
    query->now.face.ray = NULL;
    now = NULL;
    if (!canaries_are_intact(answers - CANARIES, answers))
        rt_plugin_break(query->accel, "it wrote in front of its answers");
    if (wrote_beside_memory(query))
        rt_plugin_break(query->accel,
                        "it wrote past the %zu bytes of its query's memory, or in front of them",
                        query->accel->query_bytes);
}

static void break_at_object(RtPluginAccel *accel, const RtRay *ray, uint32_t object) {
    uint32_t unset;
    memset(&unset, UNSET, sizeof unset);
    break_at_ray(accel, ray,
                 object == unset ? "it wrote no answer" : "it answered with an object that does not exist",
                 object);
}

/* Copies the answers; returns whether all are possible. Four at a time: the plugin is charged for it. */
static bool copy_hits(const RtAccel *accel, const RtRay *rays, size_t count, const RtHit *theirs,
                      RtHit *hits) {
    const RtInt4 objects = rt_all_ints4((int32_t)accel->scene->geometry.object_count);
    RtInt4 possible = rt_all_ints4(-1);
    size_t i = 0;
    for (; i + 4 <= count; i += 4) {
        const RtRay *four = &rays[i];
        RtFloat4 tmin = {four[0].tmin, four[1].tmin, four[2].tmin, four[3].tmin};
        RtFloat4 tmax = {four[0].tmax, four[1].tmax, four[2].tmax, four[3].tmax};
        RtFloat4 a = rt_loadu4(&theirs[i]), b = rt_loadu4(&theirs[i + 2]);
        rt_store(&hits[i], a);
        rt_store(&hits[i + 2], b);
        RtFloat4 t = __builtin_shufflevector(a, b, 0, 2, 4, 6);
        RtInt4 object = (RtInt4)__builtin_shufflevector(a, b, 1, 3, 5, 7);
        RtInt4 miss = (object == (int32_t)RT_NO_OBJECT) & (t == INFINITY);
        RtInt4 exists = (object >= 0) & (object < objects);
        possible &= miss | (exists & (t >= tmin) & (t <= tmax) & (t < INFINITY));
    }
    bool all = rt_bits(possible) == 15;
    for (; i < count; i++) {
        hits[i] = theirs[i];
        all &= rt_hit_is_possible(accel, &rays[i], hits[i]);
    }
    return all;
}

static void take_hits(PluginQuery *query, const RtRay *rays, size_t count, const RtHit *theirs, RtHit *hits) {
    RtPluginAccel *accel = query->accel;
    const uint32_t objects = accel->base.scene->geometry.object_count;
    if (copy_hits(&accel->base, rays, count, theirs, hits)) return;
    for (size_t i = 0; i < count; i++) {
        RtHit hit = hits[i];
        if (rt_hit_is_possible(&accel->base, &rays[i], hit)) continue;
        hits[i] = RT_MISS;
        if (hit.object < objects || hit.object == RT_NO_OBJECT) {
            char text[RT_RAY_TEXT];
            rt_ray_format(&rays[i], text, sizeof text);
            rt_plugin_break(accel, "it answered %s at t = %.9g, which is not on the ray %s",
                            hit.object == RT_NO_OBJECT ? "no object" : "an object", (double)hit.t, text);
        } else {
            break_at_object(accel, &rays[i], hit.object);
        }
    }
}

/* Tests each occluder by its exact hit function; only in counted streams, because it takes time. */
static void test_occluders(PluginQuery *query, const RtRay *rays, size_t count, const uint32_t *occluders) {
    for (size_t i = 0; i < count; i++) {
        RtPreparedRay ray;
        float t;
        if (occluders[i] == RT_NO_OBJECT) continue;
        rt_hit_ray(&ray, query->geometry, &rays[i], query->now.face.crossings);
        if (rt_object_hit(query->geometry, occluders[i], &ray, &t, NULL)) continue;
        break_at_ray(query->accel, &rays[i], "it answered with an occluder that the ray does not hit",
                     occluders[i]);
    }
}

static void take_occluders(PluginQuery *query, const RtRay *rays, size_t count, const uint32_t *theirs,
                           uint32_t *occluders) {
    RtPluginAccel *accel = query->accel;
    bool all = true;
    for (size_t i = 0; i < count; i++) {
        occluders[i] = theirs[i];
        all &= rt_occluder_is_possible(&accel->base, theirs[i]);
    }
    for (size_t i = 0; i < count && !all; i++) {
        if (rt_occluder_is_possible(&accel->base, occluders[i])) continue;
        break_at_object(accel, &rays[i], occluders[i]);
        occluders[i] = RT_NO_OBJECT;
    }
    if (query->counting && accel->base.exact) test_occluders(query, rays, count, occluders);
}

/* Counters that the plugin counts, and those that object_hits counts, which a plugin with its own hit
 * functions adds to. Rays and hits are counted here. X(CONSTANT, name) */
#define OWN_COUNTERS(X)                                                                                      \
    X(EXTENT_TESTS, extent_tests)                                                                            \
    X(STEPS, steps)                                                                                          \
    X(LEAF_STEPS, leaf_steps)                                                                                \
    X(EMPTY_STEPS, empty_steps)                                                                              \
    X(REPEATS_AVOIDED, repeats_avoided)                                                                      \
    X(PASSED_ON, passed_on)
#define OBJECT_COUNTERS(X)                                                                                   \
    X(OBJECT_TESTS, object_tests)                                                                            \
    X(OBJECT_HITS, object_hits)                                                                              \
    X(CSG_TESTS, csg_tests)

#define ONE(CONSTANT, name) +1
_Static_assert(2 OWN_COUNTERS(ONE) OBJECT_COUNTERS(ONE) == RT_TALLY_COUNTER_COUNT,
               "a counter is a plugin's, or counted here");

/* Adds the counts of a stream of so many rays, and of the layers below, where rays and hits count again. */
static void add_counters(PluginQuery *query, const raytally_counters *counted, size_t rays,
                         RtTally *tallies) {
    const bool checked = !(query->accel->table->flags & RAYTALLY_OWN_HITS) && query->accel->base.counts;
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        const uint64_t *at = counted[kind].at;
        const RtTally *right = &query->tallies[kind];
#define ADD_OWN(CONSTANT, name)                                                                              \
    if (rt_count_is_possible(at[RAYTALLY_##CONSTANT], rays))                                                 \
        tallies[kind].name += at[RAYTALLY_##CONSTANT];                                                       \
    else                                                                                                     \
        rt_plugin_break(query->accel, "it counted %" PRIu64 " " #name " for %s rays, more than possible",    \
                        at[RAYTALLY_##CONSTANT], rt_ray_kind_name((RtRayKind)kind));
#define ADD_RIGHT(CONSTANT, name)                                                                            \
    ADD_OWN(CONSTANT, name)                                                                                  \
    if (checked && at[RAYTALLY_##CONSTANT] != right->name)                                                   \
        rt_plugin_break(query->accel,                                                                        \
                        "its " #name " for %s rays add up to %" PRIu64 ", and were %" PRIu64                 \
                        ": raytally_object_hits counts them, in the counters passed to it",                  \
                        rt_ray_kind_name((RtRayKind)kind), at[RAYTALLY_##CONSTANT], right->name);
        OWN_COUNTERS(ADD_OWN)
        OBJECT_COUNTERS(ADD_RIGHT)
        query->below[kind].rays = query->below[kind].hits = 0;
        rt_tally_add(&tallies[kind], &query->below[kind]);
    }
}

/* The two kernels of a question. Answers have the type Answer, which the plugin calls Theirs. */
#define DEFINE_KERNELS(question, Answer, Theirs, take, is_hit)                                               \
    static void question##_some(PluginQuery *query, const RtScratch *scratch, const RtRay *rays,             \
                                size_t count, Answer *answers, raytally_counters *counters) {                \
        RtPluginAccel *accel = query->accel;                                                                 \
        Answer *theirs = enter(query, scratch, rays, count, sizeof(Answer));                                 \
        accel->table->question(accel->self, query->memory, &query->now.face, (const raytally_ray *)rays,     \
                               count, (Theirs *)theirs, counters);                                           \
        leave(query, (const char *)theirs);                                                                  \
        take(query, rays, count, theirs, answers);                                                           \
    }                                                                                                        \
    static void time_##question(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,           \
                                size_t count, Answer *answers) {                                             \
        (void)accel;                                                                                         \
        for (size_t first = 0; first < count; first += MOST_ANSWERS) {                                       \
            size_t n = count - first < MOST_ANSWERS ? count - first : MOST_ANSWERS;                          \
            question##_some(scratch->own, scratch, rays + first, n, answers + first, NULL);                  \
        }                                                                                                    \
    }                                                                                                        \
    static void count_##question(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,          \
                                 size_t count, Answer *answers, RtTally *tallies) {                          \
        PluginQuery *query = scratch->own;                                                                   \
        for (size_t first = 0; first < count; first += MOST_ANSWERS) {                                       \
            size_t n = count - first < MOST_ANSWERS ? count - first : MOST_ANSWERS;                          \
            raytally_counters counters[RAYTALLY_RAY_KINDS] = {0};                                            \
            query->counting = true;                                                                          \
            memset(query->tallies, 0, sizeof query->tallies);                                                \
            memset(query->below, 0, sizeof query->below);                                                    \
            query->events = (Events){.name = accel->ops->name,                                               \
                                     .counters = accel->counts ? &counters[rays[first].kind] : NULL,         \
                                     .best = RT_MISS};                                                       \
            question##_some(query, scratch, rays + first, n, answers + first,                                \
                            accel->counts ? counters : NULL);                                                \
            query->counting = false;                                                                         \
            report_counted(&query->events);                                                                  \
            add_counters(query, counters, n, tallies);                                                       \
        }                                                                                                    \
        for (size_t i = 0; i < count; i++) {                                                                 \
            tallies[rays[i].kind].rays++;                                                                    \
            tallies[rays[i].kind].hits += (is_hit);                                                          \
        }                                                                                                    \
    }
DEFINE_KERNELS(nearest, RtHit, raytally_hit, take_hits, answers[i].object != RT_NO_OBJECT)
DEFINE_KERNELS(occluded, uint32_t, uint32_t, take_occluders, answers[i] != RT_NO_OBJECT)

static RtStatus check(const RtAccel *accel, RtError *error) {
    const RtPluginAccel *self = rt_plugin_of(accel);
    return self->broken ? rt_fail(error, RT_BROKEN, "%s", self->error.message) : RT_OK;
}

void rt_plugin_query_init(RtPluginAccel *self) {
    self->base.scratch_bytes = sizeof(PluginQuery);
    self->query_bytes = self->table->query_bytes ? self->table->query_bytes(self->self) : 0;
    pthread_mutex_init(&self->lock, NULL);
}

void rt_plugin_query_ops(RtAccelOps *ops) {
    ops->nearest = time_nearest;
    ops->occluded = time_occluded;
    ops->nearest_counted = count_nearest;
    ops->occluded_counted = count_occluded;
    ops->open = open_query;
    ops->close = close_query;
    ops->begin = begin;
    ops->check = check;
}
