/* SPDX-License-Identifier: Apache-2.0 */
/* An accelerator of a plugin as an RtAccel, in its own process: the host's side of include/raytally/accel.h.
 *
 * The plugin's numbers are checked before use, and failures take its message. Each query has a mapping of its
 * own: the answers and the plugin's memory, both between guard pages; known bytes (canaries) fill the rest of
 * their pages. Every answer is checked before anything else reads it: the object exists, and t is on the ray.
 * Object tests are counted here, whatever the plugin does with its counters, unless it has hit functions of
 * its own.
 *
 * To a plugin an instance is one object, which raytally tests; answers from below name instances, too. The
 * order of hits stays, since objects in an instance have consecutive ids. The final answer names the object
 * within: that of the last hit that the plugin was told of, or of a further test. */
#include "accel/kernel.h"
#include "accel/plugin/channel.h"
#include "accel/plugin/events.h"
#include "core/base/parallel.h"

#include <inttypes.h>
#include <pthread.h>
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

_Static_assert(sizeof(RtTriangle) == 9 * sizeof(float) && sizeof(RtSphere) == 4 * sizeof(float) &&
                   offsetof(RtSphere, radius) == 3 * sizeof(float),
               "triangles and spheres are arrays of floats");

typedef struct Plugin {
    RtAccel base;
    const raytally_accel_ops *table;
    void *self;
    size_t query_bytes;
    atomic_bool broken; /* `error` says why */
    pthread_mutex_t lock;
    RtError error;
} Plugin;

enum { GUARD = 64 * 1024, CANARY = 0xA5, CANARIES = 1024, MOST_ANSWERS = 4096, UNSET = 0xFE };

/* The plugin sees only the first member of the first. */
typedef struct PluginQuery {
    RtPluginNow now;
    Plugin *accel;
    const RtGeometry *geometry;
    char *memory;     /* [accel->query_bytes] or NULL */
    char *memory_end; /* of its pages */
    char *answers_end;
    const RtScratch *scratch; /* of this layer and those below */
    size_t rays;              /* of the stream */
    RtHit told[MOST_ANSWERS]; /* of each ray: the last hit in an instance */
    bool counting;
    /* In a stream that is counted: of object tests, and of the layers below. */
    RtTally tallies[RT_RAY_KIND_COUNT], below[RT_RAY_KIND_COUNT];
    RtPluginEvents events;
} PluginQuery;

/* ---- reports ---- */

enum { MOST_QUERIES = 2048 }; /* whose ray can be reported after a hang */
static _Atomic(PluginQuery *) open_queries[MOST_QUERIES];
static _Thread_local const RtPluginNow *now;

static void list_query(PluginQuery *from, PluginQuery *to) {
    for (int i = 0; i < MOST_QUERIES; i++) {
        PluginQuery *was = from;
        if (atomic_compare_exchange_strong(&open_queries[i], &was, to)) return;
    }
}

const RtPluginNow *rt_plugin_now(bool any_thread) {
    if (!any_thread) return now;
    for (int i = 0; i < MOST_QUERIES; i++) {
        const PluginQuery *query = atomic_load(&open_queries[i]);
        if (query && query->now.stream) return &query->now;
    }
    return NULL;
}

/* Marks it as broken, with a message as of printf. Only the first failure is kept. */
__attribute__((format(printf, 2, 3))) static void break_it(Plugin *accel, const char *what, ...) {
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

static void break_at_ray(Plugin *accel, const RtRay *ray, const char *what, uint32_t object) {
    char text[RT_RAY_TEXT];
    rt_ray_format(ray, text, sizeof text);
    break_it(accel, "%s, %u (the scene has %u objects), for the ray %s", what, object,
             accel->base.scene->geometry.object_count, text);
}

/* ---- what the plugin calls ---- */

/* Keeps the hit of a ray, if that is one of the stream. */
static void tell(PluginQuery *query, const RtRay *ray, RtHit hit) {
    const size_t i = ((uintptr_t)ray - (uintptr_t)query->now.stream) / sizeof *ray;
    if (i < query->rays && &query->now.stream[i] == ray) query->told[i] = hit;
}

/* rt_test_object, which names an instance rather than an object in it. */
RT_KERNEL bool test_object(PluginQuery *query, const RtPreparedRay *ray, uint32_t id, bool any, RtHit *best,
                           RtTally *tally) {
    if (!rt_is_instance(query->geometry, id))
        return rt_test_object(query->geometry, id, ray, any, best, tally);
    RtHit hit = {best->t, RT_NO_OBJECT};
    rt_test_object(query->geometry, id, ray, any, &hit, tally);
    now = &query->now;
    if (hit.object == RT_NO_OBJECT) return false;
    if (rt_hit_before(hit.t, id, *best)) {
        tell(query, (const RtRay *)ray->ray, hit);
        *best = (RtHit){hit.t, id};
    }
    return any;
}

static int other_hit(const raytally_prepared *ray, uint32_t id, float *t) {
    PluginQuery *query = (PluginQuery *)ray->query;
    RtHit hit = RT_MISS;
    if (!rt_is_instance(query->geometry, id)) return rt_rarer_hit(query->geometry, id, ray, t, NULL);
    test_object(query, ray, id, false, &hit, NULL);
    *t = hit.t;
    return hit.object != RT_NO_OBJECT;
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
        over = test_object(query, ray, ids[i], any, &hit, tally);
    }
    *best = (raytally_hit){hit.t, hit.object};
    return over;
}

static int object_hits(const raytally_prepared *ray, const uint32_t *ids, uint32_t count, int any,
                       raytally_hit *best, raytally_counters *counters) {
    PluginQuery *query = (PluginQuery *)ray->query;
    if (!query->counting) return hits_of(ray, ids, count, any, best, NULL);
    RtTally tally = {0};
    rt_plugin_report_counted(&query->events);
    int over = hits_of(ray, ids, count, any, best, &tally);
    query->events.best = (RtHit){best->t, best->object};
    rt_tally_add(&query->tallies[ray->ray->kind], &tally);
    if (!counters) return over;
    counters->at[RAYTALLY_OBJECT_TESTS] += tally.object_tests;
    counters->at[RAYTALLY_OBJECT_HITS] += tally.object_hits;
    counters->at[RAYTALLY_CSG_TESTS] += tally.csg_tests;
    tally.object_tests = tally.object_hits = tally.csg_tests = 0;
    rt_tally_add(&query->below[ray->ray->kind], &tally); /* of parts */
    return over;
}

/* The rays may be the plugin's own. They are checked only in counted streams, because it takes time. */
static bool can_pass_on(PluginQuery *query, const RtRay *rays, size_t count) {
    char text[RT_RAY_TEXT];
    if (!query->accel->base.below) {
        break_it(query->accel, "it passes rays on, but its `flags` lack RAYTALLY_OVERLAY");
        return false;
    }
    for (size_t i = 0; i < count && query->counting; i++) {
        if (rt_ray_is_valid(&rays[i]) && rays[i].kind < RT_RAY_KIND_COUNT) continue;
        rt_ray_format(&rays[i], text, sizeof text);
        break_it(query->accel, "it passed on a ray that is not valid, of kind %u, %s", rays[i].kind, text);
        return false;
    }
    return true;
}

/* Traces a stream in the layer below, which may be a plugin's, too. */
static void trace_below(PluginQuery *query, const RtRay *rays, size_t count, RtHit *hits,
                        uint32_t *occluders) {
    rt_plugin_report_counted(&query->events);
    if (can_pass_on(query, rays, count)) {
        rt_trace_stream(query->accel->base.below, query->scratch + 1, rays, count, hits, occluders,
                        query->counting ? query->below : NULL);
    } else {
        for (size_t i = 0; i < count; i++) rt_put_answer(&RT_MISS, i, !hits, hits, occluders, NULL);
    }
    now = &query->now;
    for (size_t i = 0; query->geometry->instance_count > 0 && i < count; i++) {
        uint32_t *object = hits ? &hits[i].object : &occluders[i];
        if (*object == RT_NO_OBJECT || *object == RT_UNNAMED_OBJECT) continue;
        tell(query, &rays[i], (RtHit){hits ? hits[i].t : 0, *object});
        *object = rt_geometry_holder(query->geometry, *object);
    }
}

static void nearest_below(raytally_query *face, const raytally_ray *rays, size_t count, raytally_hit *hits) {
    trace_below((PluginQuery *)face, (const RtRay *)rays, count, (RtHit *)hits, NULL);
}

static void occluded_below(raytally_query *face, const raytally_ray *rays, size_t count,
                           uint32_t *occluders) {
    trace_below((PluginQuery *)face, (const RtRay *)rays, count, NULL, occluders);
}

static void show(const raytally_prepared *ray, uint32_t counter, uint32_t number, const raytally_box *box) {
    rt_plugin_show(&((PluginQuery *)ray->query)->events, ray, counter, number, box);
}

#define HOST(show_or_null)                                                                                   \
    {                                                                                                        \
        RAYTALLY_ACCEL_ABI, sizeof(raytally_host), raytally_prepare, object_hits, other_hit, nearest_below,  \
            occluded_below, show_or_null                                                                     \
    }
static const raytally_host host = HOST(NULL), observed_host = HOST(show);

/* ---- memory between guard pages ---- */

static size_t round_up(size_t bytes, size_t unit) {
    return (bytes + unit - 1) / unit * unit;
}

/* All bytes are CANARY if the first is and each equals the one before. */
static bool canaries_are_intact(const char *from, const char *end) {
    size_t bytes = (size_t)(end - from);
    return bytes == 0 || ((unsigned char)*from == CANARY && memcmp(from, from + 1, bytes - 1) == 0);
}

/* One mapping: a guard, the plugin's memory, a guard, the answers, a guard. */
static RtStatus map_memory(PluginQuery *query, RtError *error) {
    const size_t page = (size_t)sysconf(_SC_PAGESIZE), wanted = query->accel->query_bytes;
    if (wanted > RT_ACCEL_MAX_BYTES)
        return rt_fail(error, RT_BROKEN, "its query_bytes asks for %zu bytes for each query", wanted);
    const size_t own = round_up(wanted, page);
    const size_t answers = round_up(CANARIES + MOST_ANSWERS * sizeof(RtHit), page);
    const size_t mapped = own + answers + 3 * (size_t)GUARD;
    char *mapping = mmap(NULL, mapped, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapping == MAP_FAILED) return rt_fail_memory(error, "the memory of a plugin's query", mapped);
    query->now.mapping = mapping;
    query->now.mapped = mapped;
    query->memory_end = mapping + GUARD + own;
    query->now.middle = query->memory_end + GUARD / 2;
    query->answers_end = mapping + mapped - GUARD;
    if ((own && mprotect(mapping + GUARD, own, PROT_READ | PROT_WRITE) != 0) ||
        mprotect(query->answers_end - answers, answers, PROT_READ | PROT_WRITE) != 0) {
        munmap(mapping, mapped);
        return rt_fail_memory(error, "the memory of a plugin's query", mapped);
    }
    if (wanted == 0) return RT_OK;
    char *memory = query->memory = query->memory_end - round_up(wanted, RT_CACHE_LINE);
    memset(mapping + GUARD, CANARY, (size_t)(memory - mapping) - GUARD);
    memset(memory + wanted, CANARY, (size_t)(query->memory_end - memory) - wanted);
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
                           .accel = (Plugin *)accel,
                           .geometry = geometry};
    memcpy(&query->now.face.box, &geometry->box, sizeof geometry->box);
    RT_TRY(map_memory(query, error));
    list_query(NULL, query);
    return RT_OK;
}

static void close_query(const RtAccel *accel, void *scratch) {
    (void)accel;
    PluginQuery *query = scratch;
    list_query(query, NULL);
    munmap(query->now.mapping, query->now.mapped);
}

static void begin(const RtAccel *accel, void *scratch) {
    const Plugin *self = (const Plugin *)accel;
    if (self->table->begin) self->table->begin(self->self, ((PluginQuery *)scratch)->memory);
}

/* ---- kernels ---- */

/* Before a stream: returns memory for `count` answers of `size` bytes, set to no valid answer. */
static void *enter(PluginQuery *query, const RtScratch *scratch, const RtRay *rays, size_t count,
                   size_t size) {
    char *answers = query->answers_end - count * size;
    memset(answers - CANARIES, CANARY, CANARIES);
    memset(answers, UNSET, count * size);
    query->now.face.host = query->counting && rt_trace_observer ? &observed_host : &host;
    query->now.face.crossings = scratch->hit_memory;
    query->scratch = scratch;
    /* Instances are tested here, up to the best hit. */
    query->now.face.object_count =
        query->counting ? 0 : query->geometry->object_count - query->geometry->instance_count;
    query->rays = count;
    for (size_t i = 0; query->geometry->instance_count > 0 && i < count; i++) query->told[i] = RT_MISS;
    query->now.face.ray = NULL;
    query->now.stream = rays;
    now = &query->now;
    return answers;
}

/* After a stream. */
static void leave(PluginQuery *query, const char *answers) {
    const char *memory = query->memory;
    query->now.stream = NULL;
    now = NULL;
    if (!canaries_are_intact(answers - CANARIES, answers))
        break_it(query->accel, "it wrote in front of its answers");
    if (memory && !(canaries_are_intact(query->now.mapping + GUARD, memory) &&
                    canaries_are_intact(memory + query->accel->query_bytes, query->memory_end)))
        break_it(query->accel, "it wrote past the %zu bytes of its query's memory, or in front of them",
                 query->accel->query_bytes);
}

static void break_at_object(Plugin *accel, const RtRay *ray, uint32_t object) {
    uint32_t unset;
    memset(&unset, UNSET, sizeof unset);
    break_at_ray(accel, ray,
                 object == unset ? "it wrote no answer" : "it answered with an object that does not exist",
                 object);
}

/* The hit of an answer, or if `any` an occluder, by the object that an instance contains. */
static RtHit name_hit(PluginQuery *query, const RtRay *ray, RtHit answer, RtHit told, bool any) {
    const RtGeometry *g = query->geometry;
    RtHit hit = any ? RT_MISS : (RtHit){answer.t, RT_NO_OBJECT};
    RtPreparedRay prepared;
    if (answer.object - (g->object_count - g->instance_count) >= g->instance_count) return answer; /* none */
    if (told.object != RT_NO_OBJECT && (any || told.t == answer.t) &&
        rt_geometry_holder(g, told.object) == answer.object)
        return told;
    rt_hit_ray(&prepared, g, ray, query->now.face.crossings);
    rt_test_object(g, answer.object, &prepared, any, &hit, NULL);
    if (hit.object == RT_NO_OBJECT) hit.object = rt_instance_of(g, answer.object)->first; /* it misses */
    return (RtHit){answer.t, hit.object};
}

static void take_hits(PluginQuery *query, const RtRay *rays, size_t count, const RtHit *theirs, RtHit *hits) {
    Plugin *accel = query->accel;
    memcpy(hits, theirs, count * sizeof *hits);
    for (size_t i = 0; i < count; i++) {
        const RtHit hit = hits[i];
        hits[i] = RT_MISS;
        if (rt_hit_is_possible(query->geometry->object_count, &rays[i], hit)) {
            hits[i] = name_hit(query, &rays[i], hit, query->told[i], false);
            continue;
        }
        if (hit.object < accel->base.scene->geometry.object_count || hit.object == RT_NO_OBJECT) {
            char text[RT_RAY_TEXT];
            rt_ray_format(&rays[i], text, sizeof text);
            break_it(accel, "it answered %s at t = %.9g, which is not on the ray %s",
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
        RtHit hit = RT_MISS;
        if (occluders[i] == RT_NO_OBJECT) continue;
        rt_hit_ray(&ray, query->geometry, &rays[i], query->now.face.crossings);
        if (rt_test_object(query->geometry, occluders[i], &ray, true, &hit, NULL)) continue;
        break_at_ray(query->accel, &rays[i], "it answered with an occluder that the ray does not hit",
                     occluders[i]);
    }
}

static void take_occluders(PluginQuery *query, const RtRay *rays, size_t count, const uint32_t *theirs,
                           uint32_t *occluders) {
    Plugin *accel = query->accel;
    for (size_t i = 0; i < count; i++) {
        occluders[i] = theirs[i];
        if (rt_occluder_is_possible(&accel->base, query->geometry->object_count, theirs[i])) continue;
        break_at_object(accel, &rays[i], theirs[i]);
        occluders[i] = RT_NO_OBJECT;
    }
    if (query->counting && accel->base.exact) test_occluders(query, rays, count, occluders);
    for (size_t i = 0; i < count; i++)
        occluders[i] = name_hit(query, &rays[i], (RtHit){0, occluders[i]}, query->told[i], true).object;
}

_Static_assert((int)RAYTALLY_COUNTERS_KNOWN == (int)RT_TALLY_COUNTER_COUNT &&
                   offsetof(RtTally, object_tests) == RAYTALLY_OBJECT_TESTS * sizeof(uint64_t) &&
                   offsetof(RtTally, csg_tests) == RAYTALLY_CSG_TESTS * sizeof(uint64_t) &&
                   offsetof(RtTally, passed_on) == RAYTALLY_PASSED_ON * sizeof(uint64_t),
               "a tally begins with the counters of the interface");

/* Checks the counts of a stream of so many rays, and adds them and those of the layers below, where rays and
 * hits count again. */
static void add_counters(PluginQuery *query, const raytally_counters *counted, size_t rays, uint32_t kinds,
                         RtTally *tallies) {
    const bool is_base = !query->accel->base.below,
               tests_here = !(query->accel->table->flags & RAYTALLY_OWN_HITS) && query->accel->base.counts;
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        RtTally theirs;
        memcpy(&theirs, counted[kind].at, sizeof theirs);
        theirs.rays = theirs.hits = 0; /* counted here */
        for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++) {
            const char *name = rt_tally_name(i), *of_kind = rt_ray_kind_name((RtRayKind)kind);
            const uint64_t count = rt_tally_get(&theirs, i), right = rt_tally_get(&query->tallies[kind], i);
            const bool test =
                i == RAYTALLY_OBJECT_TESTS || i == RAYTALLY_OBJECT_HITS || i == RAYTALLY_CSG_TESTS;
            if (!rt_count_is_possible(count, rays)) {
                break_it(query->accel, "it counted %" PRIu64 " %s for %s rays, more than possible", count,
                         name, of_kind);
                theirs = (RtTally){0};
            } else if (test && tests_here && count != right) {
                break_it(query->accel,
                         "its %s for %s rays add up to %" PRIu64 ", and were %" PRIu64
                         ": raytally_object_hits counts them, in the counters passed to it",
                         name, of_kind, count, right);
            }
        }
        if (is_base && !(kinds >> kind & 1)) continue; /* rays in a part have one tally */
        query->below[kind].rays = query->below[kind].hits = 0;
        rt_tally_add(&tallies[kind], &theirs);
        rt_tally_add(&tallies[kind], &query->below[kind]);
    }
}

static void start_counting(PluginQuery *query, raytally_counters *counters, uint32_t kind) {
    const RtAccel *accel = &query->accel->base;
    memset(counters, 0, RAYTALLY_RAY_KINDS * sizeof *counters);
    memset(query->tallies, 0, sizeof query->tallies);
    memset(query->below, 0, sizeof query->below);
    query->counting = true;
    query->events = (RtPluginEvents){
        .name = accel->ops->name, .counters = accel->counts ? &counters[kind] : NULL, .best = RT_MISS};
}

static void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                  RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    PluginQuery *query = scratch->own;
    const raytally_accel_ops *table = query->accel->table;
    void *self = query->accel->self;
    for (size_t first = 0; first < count; first += MOST_ANSWERS) {
        const size_t n = count - first < MOST_ANSWERS ? count - first : MOST_ANSWERS;
        const raytally_ray *stream = (const raytally_ray *)rays + first;
        raytally_counters counters[RAYTALLY_RAY_KINDS], *own = counted && accel->counts ? counters : NULL;
        if (counted) start_counting(query, counters, rays[first].kind);
        void *theirs = enter(query, scratch, rays + first, n, any ? sizeof(uint32_t) : sizeof(RtHit));
        if (any)
            table->occluded(self, query->memory, &query->now.face, stream, n, theirs, own);
        else
            table->nearest(self, query->memory, &query->now.face, stream, n, theirs, own);
        leave(query, theirs);
        if (any)
            take_occluders(query, rays + first, n, theirs, occluders + first);
        else
            take_hits(query, rays + first, n, theirs, hits + first);
        query->counting = false;
        if (counted) rt_plugin_report_counted(&query->events);
        uint32_t kinds = 0;
        for (size_t i = 0; counted && i < n; i++) kinds |= 1u << rays[first + i].kind;
        if (counted) add_counters(query, counters, n, kinds, tallies);
    }
    for (size_t i = 0; counted && i < count; i++)
        rt_count_answer((any ? occluders[i] : hits[i].object) != RT_NO_OBJECT, &tallies[rays[i].kind]);
}

RT_DEFINE_STREAM_KERNELS(trace, sizeof(PluginQuery))

static RtStatus check(const RtAccel *accel, RtError *error) {
    const Plugin *self = (const Plugin *)accel;
    return self->broken ? rt_fail(error, RT_BROKEN, "%s", self->error.message) : RT_OK;
}

/* ---- the structure ---- */

/* Without a table its build has failed. */
static void destroy(RtAccel *accel) {
    Plugin *self = (Plugin *)accel;
    if (!self->table) return;
    self->table->destroy(self->self);
    pthread_mutex_destroy(&self->lock);
}

/* Reports that `build` failed, with the plugin's message if it wrote one. */
static RtStatus refuse(const raytally_accel_ops *table, int result, const char *message, RtError *error) {
    if (result == RAYTALLY_BUILD_NO_MEMORY)
        return rt_fail(error, RT_NO_MEMORY, "%s: memory is short%s%s", table->name, *message ? ": " : "",
                       message);
    if (result != RAYTALLY_BUILD_REFUSED)
        return rt_fail(error, RT_BROKEN, "its `build` returned %d, which is not a valid result", result);
    return rt_fail(error, RT_BAD_INPUT, "%s: %s", table->name,
                   *message ? message : "it refuses this scene without giving a reason");
}

static void copy_values(const RtAccelOps *ops, const RtValue *from, raytally_value *values) {
    for (size_t i = 0; i < ops->param_count; i++) {
        const RtValue value = from[i];
        switch (ops->params[i].type) {
        case RT_PARAM_INT: values[i].integer = value.i; break;
        case RT_PARAM_FLOAT: values[i].number = value.f; break;
        case RT_PARAM_CHOICE: values[i].choice = value.choice; break;
        case RT_PARAM_FLAG: values[i].flag = value.flag; break;
        case RT_PARAM_RESOLUTION: break; /* plugins have none */
        }
    }
}

static RtStatus add_geometry(RtArena *memory, const RtGeometry *geometry, raytally_build_input *input,
                             RtError *error) {
    input->triangles = (const float *)geometry->triangles;
    input->triangle_objects = geometry->triangle_ids;
    input->triangle_count = geometry->triangle_count;
    input->spheres = (const float *)geometry->spheres;
    input->sphere_objects = geometry->sphere_ids;
    input->sphere_count = geometry->sphere_count;
    const uint32_t others = geometry->object_count - geometry->triangle_count - geometry->sphere_count;
    uint32_t *list = rt_arena_alloc_unset(memory, others, sizeof(uint32_t));
    RT_TRY(rt_arena_check(memory, "a list of objects", error));
    for (uint32_t id = 0; id < geometry->object_count; id++) {
        const RtShape shape = rt_ref_shape(geometry->objects[id]);
        if (shape != RT_SHAPE_TRIANGLE && shape != RT_SHAPE_SPHERE) list[input->other_count++] = id;
    }
    if (others > 0) input->other_objects = list;
    return RT_OK;
}

static RtStatus build(RtAccel *accel, const RtBuild *what, RtError *error) {
    Plugin *self = (Plugin *)accel;
    const raytally_accel_ops *table = &((const RtPluginOps *)accel->ops)->table;
    const RtGeometry *geometry = &what->scene->geometry;
    const uint64_t memory = rt_memory_current_limit();
    raytally_value values[RAYTALLY_MAX_PARAMS] = {0};
    char message[900] = "";
    copy_values(accel->ops, what->values, values);
    raytally_build_input input = {.size = sizeof input,
                                  .object_count = geometry->object_count,
                                  .boxes = rt_public_box(geometry->boxes),
                                  .values = values,
                                  .threads = rt_thread_count(what->threads),
                                  .byte_limit = memory < UINT64_MAX ? memory : what->limit,
                                  .message = message,
                                  .message_room = sizeof message - 1};
    memcpy(&input.box, &geometry->box, sizeof input.box);
    RT_TRY(add_geometry(&accel->memory, geometry, &input, error));
    int result = table->build(&input, &self->self);
    if (result != RAYTALLY_BUILD_OK) return refuse(table, result, message, error);
    self->table = table;
    accel->exact &= !(table->flags & RAYTALLY_OWN_HITS);
    accel->absolute |= (table->flags & RAYTALLY_ABSOLUTE_HITS) != 0;
    accel->counts &= !(table->flags & RAYTALLY_NO_COUNTS);
    self->query_bytes = table->query_bytes ? table->query_bytes(self->self) : 0;
    pthread_mutex_init(&self->lock, NULL);
    return RT_OK;
}

uint64_t rt_description_impossible(const RtDescription *d) {
    enum { SIZES = 6 };
    const uint64_t sizes[SIZES] = {d->interior,   d->leaves, d->empty_leaves,
                                   d->references, d->depth,  d->bytes};
    for (size_t i = 0; i < SIZES + RT_TALLY_COUNTER_COUNT; i++) {
        const uint64_t number = i < SIZES ? sizes[i] : rt_tally_get(&d->build, i - SIZES);
        if (number > UINT64_C(1) << 53) return number;
    }
    return 0;
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const Plugin *self = (const Plugin *)accel;
    raytally_description d = {.predicted_cost = NAN, .predicted_tests = NAN, .predicted_steps = NAN};
    if (self->table->describe) self->table->describe(self->self, &d);
    *out = (RtDescription){.interior = d.interior,
                           .leaves = d.leaves,
                           .empty_leaves = d.empty_leaves,
                           .references = d.references,
                           .depth = d.depth,
                           .bytes = d.bytes,
                           .predicted_cost = d.predicted_cost,
                           .predicted_tests = d.predicted_tests,
                           .predicted_steps = d.predicted_steps,
                           RT_NO_QUALITY};
    const uint64_t impossible = rt_description_impossible(out);
    if (impossible)
        break_it((Plugin *)accel, "its description has the impossible number %" PRIu64, impossible);
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const Plugin *self = (const Plugin *)accel;
    char message[900] = "";
    if (!self->table->validate || self->table->validate(self->self, message, sizeof message - 1) == 0)
        return RT_OK;
    return rt_fail(error, RT_MISMATCH, "%s: %s", self->table->name,
                   *message ? message : "it is not valid and gives no reason");
}

typedef struct Showing {
    Plugin *accel;
    RtBoxViewer viewer;
} Showing;

static void show_box(void *context, const raytally_box *theirs, uint32_t depth, int leaf) {
    const Showing *showing = context;
    RtBox box;
    if (!theirs) {
        break_it(showing->accel, "one of its boxes is NULL");
        return;
    }
    memcpy(&box, theirs, sizeof box);
    if (!rt_box_can_be_shown(&box, depth)) {
        break_it(showing->accel, "it showed a box at depth %u from (%g, %g, %g) to (%g, %g, %g)", depth,
                 (double)box.lo.x, (double)box.lo.y, (double)box.lo.z, (double)box.hi.x, (double)box.hi.y,
                 (double)box.hi.z);
        return;
    }
    showing->viewer.show(showing->viewer.context,
                         &(RtBoxView){.box = &box, .depth = depth, .leaf = leaf != 0});
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    Showing showing = {(Plugin *)accel, viewer};
    showing.accel->table->each_box(showing.accel->self, show_box, &showing);
}

/* ---- the table ---- */

void rt_plugin_ops_init(RtPluginOps *ops, const raytally_accel_ops *table) {
    static const RtParamType types[] = {[RAYTALLY_INT] = RT_PARAM_INT,
                                        [RAYTALLY_FLOAT] = RT_PARAM_FLOAT,
                                        [RAYTALLY_CHOICE] = RT_PARAM_CHOICE,
                                        [RAYTALLY_FLAG] = RT_PARAM_FLAG};
    for (uint32_t i = 0; i < table->param_count; i++) {
        const raytally_param *p = &table->params[i];
        ops->params[i] = (RtParam){p->name,    types[p->type], p->default_text, p->lo,    p->hi,
                                   p->choices, p->test_values, p->meaning,      p->source};
    }
    ops->ops = (RtAccelOps){.name = table->name,
                            .summary = table->summary,
                            .paper = table->paper,
                            .params = ops->params,
                            .param_count = table->param_count,
                            .kinds = table->flags & RAYTALLY_OVERLAY ? RT_ALL_RAY_KINDS : 0,
                            .remote = true,
                            .bytes = sizeof(Plugin),
                            .build = build,
                            .destroy = destroy,
                            .describe = describe,
                            .validate = validate,
                            .each_box = table->each_box ? each_box : NULL,
                            .kernels = &kernels,
                            .open = open_query,
                            .close = close_query,
                            .begin = begin,
                            .check = check};
}
