/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/plugin/host.h"

#include "accel/kernel.h"
#include "accel/plugin/now.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* The layouts that both sides have in common. */
_Static_assert(sizeof(raytally_ray) == sizeof(RtRay) && offsetof(raytally_ray, dir) == offsetof(RtRay, dir) &&
                   offsetof(raytally_ray, source) == offsetof(RtRay, source) &&
                   (int)RAYTALLY_RAY_KINDS == (int)RT_RAY_KIND_COUNT,
               "rays");
_Static_assert(sizeof(raytally_hit) == sizeof(RtHit) && RAYTALLY_NO_OBJECT == RT_NO_OBJECT, "hits");
_Static_assert(sizeof(raytally_box) == sizeof(RtBox), "boxes");
_Static_assert(sizeof(RtPreparedRay) <= sizeof(((raytally_prepared *)0)->own), "a prepared ray fits");

typedef struct PluginAccel {
    RtAccel base;
    const raytally_accel_ops *table;
    void *self;
    size_t query_bytes;
    atomic_bool nonsense; /* what it was is in `said` */
    pthread_mutex_t lock;
    RtError said;
} PluginAccel;

/* What a query has. The plugin sees the first member alone. */
typedef struct PluginQuery {
    raytally_query face;
    RtPluginNow now;
    PluginAccel *accel;
    const RtGeometry *geometry;
    RtCrossing *room;
    char *mapping; /* [mapped] the plugin's memory, and pages around it that nobody may touch */
    size_t mapped;
    void *memory; /* [accel->query_bytes] or NULL */
} PluginQuery;

static const PluginAccel *of(const RtAccel *accel) {
    return (const PluginAccel *)accel;
}

/* ---- what is said of one that went wrong ---- */

enum { MOST_QUERIES = 256 };
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

/* The first thing counts. */
static void say(PluginAccel *accel, const RtError *what) {
    pthread_mutex_lock(&accel->lock);
    if (!accel->nonsense) accel->said = *what;
    accel->nonsense = true;
    pthread_mutex_unlock(&accel->lock);
}

static void say_of_ray(PluginAccel *accel, const RtRay *ray, const char *what, uint32_t object) {
    RtError said;
    char text[RT_RAY_TEXT];
    rt_ray_format(ray, text, sizeof text);
    rt_fail(&said, RT_BROKEN, "%s, %u (the scene has %u objects), for the ray %s", what, object,
            accel->base.scene->geometry.object_count, text);
    say(accel, &said);
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
    if (!counters) return hits_of(ray, ids, count, any, best, NULL);
    RtTally tally = {0};
    int over = hits_of(ray, ids, count, any, best, &tally);
    counters->at[RAYTALLY_OBJECT_TESTS] += tally.object_tests;
    counters->at[RAYTALLY_OBJECT_HITS] += tally.object_hits;
    counters->at[RAYTALLY_CSG_TESTS] += tally.csg_tests;
    return over;
}

static const raytally_host host = {RAYTALLY_ACCEL_ABI, sizeof(raytally_host), prepare, object_hits};

/* ---- queries ---- */

enum { GUARD = 64 * 1024, CANARY = 0xA5 };

/* Behind the memory, to the end of its page. */
static char *canary_of(const PluginQuery *query) {
    return (char *)query->memory + query->accel->query_bytes;
}

static size_t canary_bytes(const PluginQuery *query) {
    return (size_t)(query->mapping + query->mapped - GUARD - canary_of(query));
}

static RtStatus map_memory(PluginQuery *query, RtError *error) {
    size_t page = (size_t)sysconf(_SC_PAGESIZE), wanted = query->accel->query_bytes;
    size_t used = (wanted + RT_CACHE_LINE - 1) / RT_CACHE_LINE * RT_CACHE_LINE;
    size_t room = (used + page - 1) / page * page;
    if (wanted == 0) return RT_OK;
    query->mapped = room + 2 * (size_t)GUARD;
    query->mapping = mmap(NULL, query->mapped, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (query->mapping == MAP_FAILED || mprotect(query->mapping + GUARD, room, PROT_READ | PROT_WRITE) != 0) {
        if (query->mapping != MAP_FAILED) munmap(query->mapping, query->mapped);
        query->mapping = NULL;
        return rt_fail_memory(error, "the memory of a plugin's query", wanted);
    }
    query->memory = query->mapping + GUARD + room - used;
    query->now.guard = query->mapping + GUARD + room;
    query->now.behind = query->now.guard + GUARD;
    memset(canary_of(query), CANARY, canary_bytes(query));
    return RT_OK;
}

static RtStatus open_query(const RtAccel *accel, void *scratch, RtError *error) {
    PluginQuery *query = scratch;
    *query =
        (PluginQuery){.face.host = &host, .accel = (PluginAccel *)accel, .geometry = &accel->scene->geometry};
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
    if (query->mapping) munmap(query->mapping, query->mapped);
}

static void begin(const RtAccel *accel, void *scratch) {
    const PluginAccel *self = of(accel);
    if (self->table->begin) self->table->begin(self->self, ((PluginQuery *)scratch)->memory);
}

/* ---- kernels ---- */

/* Before a stream, and behind it. */
static PluginQuery *enter(const RtScratch *scratch, const RtRay *rays) {
    PluginQuery *query = scratch->own;
    query->room = scratch->room;
    query->now.ray = rays;
    now = &query->now;
    return query;
}

static void leave(PluginQuery *query) {
    query->now.ray = NULL;
    now = NULL;
    if (!query->memory) return;
    const unsigned char *canary = (const unsigned char *)canary_of(query);
    for (size_t i = 0, n = canary_bytes(query); i < n; i++) {
        if (canary[i] == CANARY) continue;
        RtError said;
        rt_fail(&said, RT_BROKEN, "it wrote past the %zu bytes of its query's memory",
                query->accel->query_bytes);
        say(query->accel, &said);
        return;
    }
}

static void look_at_hits(PluginAccel *accel, const RtRay *rays, size_t count, RtHit *hits) {
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
            say(accel, &said);
        } else {
            say_of_ray(accel, &rays[i], "it answered with an object that there is not", hit.object);
        }
    }
}

static void look_at_blockers(PluginAccel *accel, const RtRay *rays, size_t count, uint32_t *blockers) {
    const uint32_t objects = accel->base.scene->geometry.object_count;
    for (size_t i = 0; i < count; i++) {
        if (blockers[i] < objects || blockers[i] == RT_NO_OBJECT) continue;
        say_of_ray(accel, &rays[i], "it answered with an object that there is not", blockers[i]);
        blockers[i] = RT_NO_OBJECT;
    }
}

/* Which counter is which; rays and hits are counted here, and what object tests count by object_hits. */
static void add_counters(const raytally_counters *counters, RtTally *tally) {
    tally->object_tests += counters->at[RAYTALLY_OBJECT_TESTS];
    tally->object_hits += counters->at[RAYTALLY_OBJECT_HITS];
    tally->extent_tests += counters->at[RAYTALLY_EXTENT_TESTS];
    tally->steps += counters->at[RAYTALLY_STEPS];
    tally->leaf_steps += counters->at[RAYTALLY_LEAF_STEPS];
    tally->empty_steps += counters->at[RAYTALLY_EMPTY_STEPS];
    tally->csg_tests += counters->at[RAYTALLY_CSG_TESTS];
    tally->repeats_avoided += counters->at[RAYTALLY_REPEATS_AVOIDED];
}

/* The two kernels of a question, whose answers are of type Answer, or Theirs as the plugin calls it. */
#define DEFINE_KERNELS(question, Answer, Theirs, look_at, is_hit)                                            \
    static void ask_##question(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,            \
                               size_t count, Answer *answers) {                                              \
        PluginQuery *query = enter(scratch, rays);                                                           \
        query->accel->table->question(of(accel)->self, query->memory, &query->face,                          \
                                      (const raytally_ray *)rays, count, (Theirs *)answers, NULL);           \
        leave(query);                                                                                        \
        look_at(query->accel, rays, count, answers);                                                         \
    }                                                                                                        \
    static void count_##question(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays,          \
                                 size_t count, Answer *answers, RtTally *tallies) {                          \
        PluginQuery *query = enter(scratch, rays);                                                           \
        raytally_counters counters[RAYTALLY_RAY_KINDS] = {0};                                                \
        query->accel->table->question(of(accel)->self, query->memory, &query->face,                          \
                                      (const raytally_ray *)rays, count, (Theirs *)answers, counters);       \
        leave(query);                                                                                        \
        look_at(query->accel, rays, count, answers);                                                         \
        for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) add_counters(&counters[kind], &tallies[kind]);  \
        for (size_t i = 0; i < count; i++) {                                                                 \
            tallies[rays[i].kind].rays++;                                                                    \
            tallies[rays[i].kind].hits += (is_hit);                                                          \
        }                                                                                                    \
    }
DEFINE_KERNELS(nearest, RtHit, raytally_hit, look_at_hits, answers[i].object != RT_NO_OBJECT)
DEFINE_KERNELS(occluded, uint32_t, uint32_t, look_at_blockers, answers[i] != RT_NO_OBJECT)

static RtStatus check(const RtAccel *accel, RtError *error) {
    const PluginAccel *self = of(accel);
    return self->nonsense ? rt_fail(error, RT_BROKEN, "%s", self->said.message) : RT_OK;
}

/* ---- the structure ---- */

static void destroy(RtAccel *accel) {
    PluginAccel *self = (PluginAccel *)accel;
    self->table->destroy(self->self);
    pthread_mutex_destroy(&self->lock);
    rt_free(self);
}

/* What the plugin says of a failure, or that it says nothing. */
static RtStatus refuse(const raytally_accel_ops *table, int result, const char *message, RtError *error) {
    if (result == RAYTALLY_MEMORY)
        return rt_fail(error, RT_NO_MEMORY, "%s: memory is short%s%s", table->name, *message ? ": " : "",
                       message);
    if (result != RAYTALLY_REFUSED)
        return rt_fail(error, RT_BROKEN, "%s: its `build` returned %d, which means nothing", table->name,
                       result);
    return rt_fail(error, RT_BAD_INPUT, "%s: %s", table->name,
                   *message ? message : "it refuses this scene and does not say why");
}

static void take_values(const RtBuild *what, raytally_value *values) {
    for (size_t i = 0; i < what->ops->param_count; i++) {
        const RtValue value = what->values[i];
        switch (what->ops->params[i].type) {
        case RT_PARAM_INT: values[i].integer = value.i; break;
        case RT_PARAM_FLOAT: values[i].number = value.f; break;
        case RT_PARAM_CHOICE: values[i].choice = value.choice; break;
        case RT_PARAM_FLAG: values[i].flag = value.flag; break;
        case RT_PARAM_RESOLUTION: break; /* no parameter of a plugin is one */
        }
    }
}

static RtStatus build(const RtBuild *what, RtAccel **out, RtError *error) {
    const raytally_accel_ops *table = ((const RtPluginOps *)what->ops)->table;
    const RtGeometry *geometry = &what->scene->geometry;
    raytally_value values[RAYTALLY_MAX_PARAMS] = {0};
    char message[900] = "";
    take_values(what, values);
    raytally_build asked = {.size = sizeof asked,
                            .object_count = geometry->object_count,
                            .boxes = (const raytally_box *)geometry->boxes,
                            .values = values,
                            .threads = rt_thread_count(what->threads),
                            .byte_limit = what->limit,
                            .message = message,
                            .message_room = sizeof message - 1};
    memcpy(&asked.box, &geometry->box, sizeof asked.box);
    RT_TRY(rt_accel_new(what, sizeof(PluginAccel), out, error));
    PluginAccel *self = (PluginAccel *)*out;
    int result = table->build(&asked, &self->self);
    if (result != RAYTALLY_BUILT) {
        rt_free(self);
        return refuse(table, result, message, error);
    }
    self->table = table;
    self->query_bytes = table->query_bytes ? table->query_bytes(self->self) : 0;
    pthread_mutex_init(&self->lock, NULL);
    return RT_OK;
}

static size_t scratch_bytes(const RtAccel *accel) {
    (void)accel;
    return sizeof(PluginQuery);
}

static void describe(const RtAccel *accel, RtDescription *out) {
    const PluginAccel *self = of(accel);
    raytally_description said = {.predicted_cost = NAN, .predicted_tests = NAN, .predicted_steps = NAN};
    if (self->table->describe) self->table->describe(self->self, &said);
    *out = (RtDescription){.interior = said.interior,
                           .leaves = said.leaves,
                           .empty_leaves = said.empty_leaves,
                           .references = said.references,
                           .depth = said.depth,
                           .bytes = said.bytes,
                           .predicted_cost = said.predicted_cost,
                           .predicted_tests = said.predicted_tests,
                           .predicted_steps = said.predicted_steps,
                           RT_NO_QUALITY};
}

static RtStatus validate(const RtAccel *accel, RtError *error) {
    const PluginAccel *self = of(accel);
    char message[900] = "";
    if (!self->table->validate || self->table->validate(self->self, message, sizeof message - 1) == 0)
        return RT_OK;
    return rt_fail(error, RT_MISMATCH, "%s: %s", self->table->name,
                   *message ? message : "it is not valid and does not say why");
}

static void show_box(void *context, const raytally_box *theirs, uint32_t depth, int leaf) {
    const RtBoxViewer *viewer = context;
    RtBox box;
    memcpy(&box, theirs, sizeof box);
    viewer->show(viewer->context, &(RtBoxView){.box = &box, .depth = depth, .leaf = leaf != 0});
}

static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    of(accel)->table->each_box(of(accel)->self, show_box, &viewer);
}

/* ---- the table ---- */

void rt_plugin_ops_init(RtPluginOps *ops, const raytally_accel_ops *table) {
    static const RtParamType types[] = {[RAYTALLY_INT] = RT_PARAM_INT,
                                        [RAYTALLY_FLOAT] = RT_PARAM_FLOAT,
                                        [RAYTALLY_CHOICE] = RT_PARAM_CHOICE,
                                        [RAYTALLY_FLAG] = RT_PARAM_FLAG};
    for (uint32_t i = 0; i < table->param_count; i++) {
        const raytally_param *p = &table->params[i];
        ops->params[i] = (RtParam){p->name,    types[p->type], p->standard, p->lo,    p->hi,
                                   p->choices, p->test_values, p->meaning,  p->source};
    }
    ops->table = table;
    ops->ops = (RtAccelOps){.name = table->name,
                            .summary = table->summary,
                            .paper = table->paper,
                            .params = ops->params,
                            .param_count = table->param_count,
                            .away = true,
                            .build = build,
                            .destroy = destroy,
                            .nearest = ask_nearest,
                            .occluded = ask_occluded,
                            .nearest_counted = count_nearest,
                            .occluded_counted = count_occluded,
                            .scratch_bytes = scratch_bytes,
                            .open = open_query,
                            .close = close_query,
                            .begin = begin,
                            .describe = describe,
                            .validate = validate,
                            .each_box = table->each_box ? each_box : NULL,
                            .check = check};
}
