/* SPDX-License-Identifier: Apache-2.0 */
/* A plugin of faults: an accelerator for each, all others of its functions being in order. What raytally is
 * to say of each of them is in tests/check_plugins.sh. */
#include <raytally/accel.h>

#include <math.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* ---- in order ---- */

typedef struct List {
    const raytally_box *boxes;
    uint32_t *ids; /* [count] */
    uint32_t count;
} List;

static void destroy(void *self) {
    if (self) free(((List *)self)->ids);
    free(self);
}

static int build(const raytally_build_input *from, void **self) {
    List *list = malloc(sizeof *list);
    uint32_t *ids = malloc((from->object_count + 1) * sizeof *ids);
    if (!list || !ids) {
        free(list);
        free(ids);
        return RAYTALLY_BUILD_NO_MEMORY;
    }
    for (uint32_t i = 0; i < from->object_count; i++) ids[i] = i;
    *list = (List){from->boxes, ids, from->object_count};
    *self = list;
    return RAYTALLY_BUILD_OK;
}

RAYTALLY_INLINE void search(const List *list, void *memory, const raytally_prepared *ray, int any,
                            raytally_hit *best, raytally_counters *counters) {
    (void)memory;
    RAYTALLY_COUNT(counters, RAYTALLY_STEPS, list->count);
    raytally_object_hits(ray, list->ids, list->count, any, best, counters);
}
RAYTALLY_DEFINE_KERNELS(List, search)

/* ---- what can go wrong anywhere ---- */

static int *volatile nowhere;
static volatile int zero;

static void crash(void) {
    *nowhere = 1;
}

static void loop(void) {
    while (zero == 0) {
    }
}

static int recurse(const volatile int *from) {
    volatile int here[256];
    here[0] = *from + 1;
    return *from < 0 ? 0 : recurse(here) + here[0];
}

static void free_twice(void) {
    void *volatile block = malloc(16);
    free(block);
    free(block);
}

/* ---- while it builds ---- */

static int build_crash(const raytally_build_input *from, void **self) {
    crash();
    return build(from, self);
}

static int build_loop(const raytally_build_input *from, void **self) {
    loop();
    return build(from, self);
}

static int build_refused(const raytally_build_input *from, void **self) {
    (void)self;
    snprintf(from->message, from->message_room, "scenes of %u objects are beneath it", from->object_count);
    return RAYTALLY_BUILD_REFUSED;
}

static int build_nonsense(const raytally_build_input *from, void **self) {
    (void)from;
    (void)self;
    return 42;
}

/* Takes all the memory that it is given, and much more than that if nobody stops it. */
static int build_memory(const raytally_build_input *from, void **self) {
    enum { BLOCKS = 64, BLOCK = 1 << 30 };
    for (int i = 0; i < BLOCKS; i++) {
        if (mmap(NULL, BLOCK, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0) ==
            MAP_FAILED)
            return RAYTALLY_BUILD_NO_MEMORY;
    }
    return build(from, self);
}

static int build_print(const raytally_build_input *from, void **self) {
    puts("{ faulty-print is built");
    fflush(stdout);
    return build(from, self);
}

/* Writes to all memory that it shares with others, to the first of it where there is much. */
static void scribble(void) {
    enum { MOST = 1 << 21 };
    char line[512], how[5];
    unsigned long begin, end;
    FILE *maps = fopen("/proc/self/maps", "r");
    while (maps && fgets(line, sizeof line, maps)) {
        if (sscanf(line, "%lx-%lx %4s", &begin, &end, how) == 3 && strcmp(how, "rw-s") == 0)
            memset((void *)begin, 0xEE, end - begin < MOST ? end - begin : MOST);
    }
    if (maps) fclose(maps);
}

static int build_scribble(const raytally_build_input *from, void **self) {
    scribble();
    return build(from, self);
}

static int build_kill(const raytally_build_input *from, void **self) {
    kill(getppid(), SIGKILL);
    return build(from, self);
}

static int build_close(const raytally_build_input *from, void **self) {
    for (int descriptor = 0; descriptor < 64; descriptor++) close(descriptor);
    return build(from, self);
}

/* Leaves a process behind, for a while, that belongs to nobody. */
static int build_daemon(const raytally_build_input *from, void **self) {
    if (fork() == 0) {
        setsid();
        sleep(2);
        _exit(0);
    }
    return build(from, self);
}

/* A structure may be NULL: this one knows no object, and answers so. It is wrong, but no crash. */
static int build_null(const raytally_build_input *from, void **self) {
    (void)from;
    *self = NULL;
    return RAYTALLY_BUILD_OK;
}

RAYTALLY_INLINE void none(const List *list, void *memory, const raytally_prepared *ray, int any,
                          raytally_hit *best, raytally_counters *counters) {
    (void)list, (void)memory, (void)ray, (void)any, (void)best, (void)counters;
}
RAYTALLY_DEFINE_KERNELS(List, none)

/* ---- while it traces ---- */

/* The search NAME, which does what `search` does and then something else. */
#define SEARCH(name, ...)                                                                                    \
    RAYTALLY_INLINE void name(const List *list, void *memory, const raytally_prepared *ray, int any,         \
                              raytally_hit *best, raytally_counters *counters) {                             \
        search(list, memory, ray, any, best, counters);                                                      \
        __VA_ARGS__                                                                                          \
    }                                                                                                        \
    RAYTALLY_DEFINE_KERNELS(List, name)

/* One ray of 256. */
static int is_rare(const raytally_ray *ray) {
    uint32_t bits;
    memcpy(&bits, &ray->dir[1], sizeof bits);
    return bits * 2654435761U >> 24 == 7;
}

SEARCH(crash_nearest, if (!any) crash();)
SEARCH(crash_timed, if (!counters) crash();)
SEARCH(crash_rare, if (is_rare(ray->ray)) crash();)
SEARCH(loop_nearest, if (!any) loop();)
SEARCH(loop_timed, if (!counters) loop();)
SEARCH(call_abort, abort();)
SEARCH(call_exit, exit(0);)
SEARCH(killed, kill(getpid(), SIGKILL);)
SEARCH(scribbled, scribble();)
SEARCH(divide, zero = 7 / zero;)
SEARCH(overflow, zero = recurse(&zero) & 0;)
SEARCH(freed_twice, free_twice();)
SEARCH(
    print, if (is_rare(ray->ray)) {
        puts("{ faulty-print is asked");
        fflush(stdout);
    })

/* Into what is not its own: `memory` has MEMORY bytes. */
enum { MEMORY = 48, FEW = 4, PAGE = 4096 };
static size_t query_bytes(const void *self) {
    (void)self;
    return MEMORY;
}
SEARCH(past_memory, memset(memory, 1, MEMORY + FEW);)
SEARCH(past_page, memset(memory, 1, MEMORY + PAGE);)
SEARCH(into_boxes, if (list->count)((raytally_box *)(uintptr_t)list->boxes)->lo[0] = 7;)
static size_t query_bytes_huge(const void *self) {
    (void)self;
    return SIZE_MAX / 2;
}

/* Answers. */
SEARCH(no_such_object, if (best->object != RAYTALLY_NO_OBJECT) best->object = list->count + 5;)
SEARCH(not_a_number, if (best->object != RAYTALLY_NO_OBJECT) best->t = NAN;)
SEARCH(farther, if (isinf(ray->ray->tmax)) best->t = nextafterf(best->t, INFINITY);)

/* A plain mistake: its list ends one too early. */
RAYTALLY_INLINE void forgetful(const List *list, void *memory, const raytally_prepared *ray, int any,
                               raytally_hit *best, raytally_counters *counters) {
    (void)memory;
    raytally_object_hits(ray, list->ids, list->count ? list->count - 1 : 0, any, best, counters);
}
RAYTALLY_DEFINE_KERNELS(List, forgetful)

/* Right, but never the same count twice. */
static atomic_uint calls;
SEARCH(moody, RAYTALLY_COUNT(counters, RAYTALLY_EXTENT_TESTS, atomic_fetch_add(&calls, 1));)

/* The right answers only where they are counted. */
RAYTALLY_INLINE void lazy(const List *list, void *memory, const raytally_prepared *ray, int any,
                          raytally_hit *best, raytally_counters *counters) {
    if (counters) search(list, memory, ray, any, best, counters);
}
RAYTALLY_DEFINE_KERNELS(List, lazy)

/* Counts that are not right. */
RAYTALLY_INLINE void uncounted(const List *list, void *memory, const raytally_prepared *ray, int any,
                               raytally_hit *best, raytally_counters *counters) {
    (void)memory;
    RAYTALLY_COUNT(counters, RAYTALLY_STEPS, 1);
    raytally_object_hits(ray, list->ids, list->count, any, best, NULL);
}
RAYTALLY_DEFINE_KERNELS(List, uncounted)
SEARCH(counted_twice, RAYTALLY_COUNT(counters, RAYTALLY_OBJECT_TESTS, list->count);)
SEARCH(backwards, RAYTALLY_COUNT(counters, RAYTALLY_STEPS, -1000000);)

/* What is no answer, or beside them. */
static void occluded_by_first(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                              size_t count, uint32_t *occluders, raytally_counters *counters) {
    search_occluded(self, memory, query, rays, count, occluders, counters);
    for (size_t i = 0; i < count; i++) occluders[i] = occluders[i] == RAYTALLY_NO_OBJECT ? occluders[i] : 0;
}

static void all_but_one(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                        size_t count, raytally_hit *hits, raytally_counters *counters) {
    search_nearest(self, memory, query, rays, count - 1, hits, counters);
}

static void crash_alone(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                        size_t count, raytally_hit *hits, raytally_counters *counters) {
    search_nearest(self, memory, query, rays, count, hits, counters);
    if (count == 1) crash();
}

static void one_too_many(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                         size_t count, raytally_hit *hits, raytally_counters *counters) {
    search_nearest(self, memory, query, rays, count, hits, counters);
    hits[count] = hits[count - 1];
}

static void one_too_early(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                          size_t count, raytally_hit *hits, raytally_counters *counters) {
    search_nearest(self, memory, query, rays, count, hits, counters);
    *(hits - 1) = hits[0];
}

static void shorten_rays(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,
                         size_t count, raytally_hit *hits, raytally_counters *counters) {
    search_nearest(self, memory, query, rays, count, hits, counters);
    raytally_ray *own = (raytally_ray *)(uintptr_t)rays;
    for (size_t i = 0; i < count; i++) own[i].tmax = hits[i].t < own[i].tmax ? hits[i].t : own[i].tmax;
}

/* ---- beside that ---- */

static void show_none(const void *self, raytally_box_visitor *show, void *viewer) {
    (void)self;
    show(viewer, NULL, 0, 1);
}

static void show_deep(const void *self, raytally_box_visitor *show, void *viewer) {
    const List *list = self;
    if (list->count > 0) show(viewer, list->boxes, UINT32_MAX, 1);
}

static void show_crash(const void *self, raytally_box_visitor *show, void *viewer) {
    (void)self, (void)show, (void)viewer;
    crash();
}

static int build_mumble(const raytally_build_input *from, void **self) {
    (void)self;
    for (size_t i = 0; i + 1 < from->message_room; i++) from->message[i] = i % 7 ? '\xe9' : '\x1b';
    return RAYTALLY_BUILD_REFUSED;
}

static void destroy_crash(void *self) {
    destroy(self);
    crash();
}

static void describe_crash(const void *self, raytally_description *out) {
    (void)self;
    (void)out;
    crash();
}

static void describe_debts(const void *self, raytally_description *out) {
    (void)self;
    out->bytes = (uint64_t)-1;
}

static int validate_broken(const void *self, char *message, size_t room) {
    (void)self;
    snprintf(message, room, "node 3 is its own parent");
    return 1;
}

/* ---- the tables ---- */

#define KERNELS(name) .nearest = name##_nearest, .occluded = name##_occluded

/* What is not set is in order. */
static raytally_accel_ops tables[] = {
    {.name = "faulty-not", .summary = "is in order"},
    {.name = "faulty-crash-build", .summary = "crashes while it builds", .build = build_crash},
    {.name = "faulty-crash-nearest", .summary = "crashes at the first ray", KERNELS(crash_nearest)},
    {.name = "faulty-crash-timed", .summary = "crashes where nothing is counted", KERNELS(crash_timed)},
    {.name = "faulty-crash-rare", .summary = "crashes at a ray of 256", KERNELS(crash_rare)},
    {.name = "faulty-crash-destroy", .summary = "crashes when it is done", .destroy = destroy_crash},
    {.name = "faulty-crash-describe", .summary = "crashes when described", .describe = describe_crash},
    {.name = "faulty-loop-build", .summary = "builds for ever", .build = build_loop},
    {.name = "faulty-loop-nearest", .summary = "traces for ever", KERNELS(loop_nearest)},
    {.name = "faulty-loop-timed", .summary = "traces for ever where nothing is counted", KERNELS(loop_timed)},
    {.name = "faulty-abort", .summary = "aborts", KERNELS(call_abort)},
    {.name = "faulty-exit", .summary = "ends its process, without an error", KERNELS(call_exit)},
    {.name = "faulty-killed", .summary = "is killed, as where memory is short", KERNELS(killed)},
    {.name = "faulty-crash-alone",
     .summary = "crashes when asked for a ray by itself",
     .nearest = crash_alone},
    {.name = "faulty-scribble", .summary = "writes to shared memory as it builds", .build = build_scribble},
    {.name = "faulty-scribbled", .summary = "writes to shared memory at each ray", KERNELS(scribbled)},
    {.name = "faulty-kill", .summary = "kills its parent", .build = build_kill},
    {.name = "faulty-close", .summary = "closes every file", .build = build_close},
    {.name = "faulty-daemon", .summary = "leaves a process behind", .build = build_daemon},
    {.name = "faulty-divide", .summary = "divides by zero", KERNELS(divide)},
    {.name = "faulty-recursion", .summary = "recurses for ever", KERNELS(overflow)},
    {.name = "faulty-free", .summary = "frees a block twice", KERNELS(freed_twice)},
    {.name = "faulty-object", .summary = "answers with an object that there is not", KERNELS(no_such_object)},
    {.name = "faulty-nan", .summary = "answers with a t that is no number", KERNELS(not_a_number)},
    {.name = "faulty-farther", .summary = "answers with a t a little too large", KERNELS(farther)},
    {.name = "faulty-wrong", .summary = "forgets the last object", KERNELS(forgetful)},
    {.name = "faulty-null",
     .summary = "has no structure, which it may, and finds nothing, which it may not",
     .build = build_null,
     KERNELS(none)},
    {.name = "faulty-memory",
     .summary = "writes past the memory of its query, a little",
     .query_bytes = query_bytes,
     KERNELS(past_memory)},
    {.name = "faulty-page",
     .summary = "writes past the memory of its query, by a page",
     .query_bytes = query_bytes,
     KERNELS(past_page)},
    {.name = "faulty-huge", .summary = "asks for all memory for a query", .query_bytes = query_bytes_huge},
    {.name = "faulty-boxes", .summary = "writes into the boxes that it borrows", KERNELS(into_boxes)},
    {.name = "faulty-greedy", .summary = "takes all memory while it builds", .build = build_memory},
    {.name = "faulty-refused", .summary = "refuses every scene", .build = build_refused},
    {.name = "faulty-nonsense", .summary = "builds, and says nonsense", .build = build_nonsense},
    {.name = "faulty-validate", .summary = "is invalid", .validate = validate_broken},
    {.name = "faulty-moody", .summary = "counts otherwise each time", KERNELS(moody)},
    {.name = "faulty-lazy", .summary = "finds nothing where nothing is counted", KERNELS(lazy)},
    {.name = "faulty-uncounted", .summary = "keeps its counters to itself", KERNELS(uncounted)},
    {.name = "faulty-twice", .summary = "counts object tests that are counted", KERNELS(counted_twice)},
    {.name = "faulty-backwards", .summary = "counts below zero", KERNELS(backwards)},
    {.name = "faulty-occluder", .summary = "names any occluder", .occluded = occluded_by_first},
    {.name = "faulty-silent", .summary = "leaves the last ray unanswered", .nearest = all_but_one},
    {.name = "faulty-beyond", .summary = "writes an answer too many", .nearest = one_too_many},
    {.name = "faulty-before", .summary = "writes in front of its answers", .nearest = one_too_early},
    {.name = "faulty-rays", .summary = "shortens the rays that it is lent", .nearest = shorten_rays},
    {.name = "faulty-debts", .summary = "takes less than no memory", .describe = describe_debts},
    {.name = "faulty-box", .summary = "shows a box that is none", .each_box = show_none},
    {.name = "faulty-deep", .summary = "shows a box at a depth that is none", .each_box = show_deep},
    {.name = "faulty-show", .summary = "crashes when it shows its boxes", .each_box = show_crash},
    {.name = "faulty-mumble", .summary = "refuses every scene in no language", .build = build_mumble},
    {.name = "faulty-print", .summary = "prints, but is right", .build = build_print, KERNELS(print)},
};

RAYTALLY_PLUGIN {
    if (index >= sizeof tables / sizeof tables[0]) return NULL;
    raytally_accel_ops *table = &tables[index];
    table->abi = RAYTALLY_ACCEL_ABI;
    table->size = sizeof *table;
    table->paper = "none";
    if (!table->build) table->build = build;
    if (!table->destroy) table->destroy = destroy;
    if (!table->nearest) table->nearest = search_nearest;
    if (!table->occluded) table->occluded = search_occluded;
    return table;
}
