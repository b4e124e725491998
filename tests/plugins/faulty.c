/* SPDX-License-Identifier: Apache-2.0 */
/* A plugin of faults: an accelerator for each fault, whose other functions are correct.
 * tests/check_plugins.sh tests what raytally reports of each. */
#include <raytally/accel.h>

#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <unistd.h>

/* ---- correct functions ---- */

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

/* ---- faults ---- */

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

/* The function NAME, which does something and then builds as `build` does. */
#define BUILD(name, ...)                                                                                     \
    static int name(const raytally_build_input *from, void **self) {                                         \
        __VA_ARGS__                                                                                          \
        return build(from, self);                                                                            \
    }

BUILD(build_crash, crash();)
BUILD(build_loop, loop();)
BUILD(build_refused,
      snprintf(from->message, from->message_room, "scenes of %u objects are beneath it", from->object_count);
      if (zero == 0) return RAYTALLY_BUILD_REFUSED;)
BUILD(build_nonsense, if (zero == 0) return 42;)

/* Takes all the memory that it gets, and much more if nothing limits it. */
static int take_memory(void) {
    enum { BLOCKS = 64, BLOCK = 1 << 30 };
    for (int i = 0; i < BLOCKS; i++) {
        if (mmap(NULL, BLOCK, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0) ==
            MAP_FAILED)
            return 0;
    }
    return 1;
}

/* Takes memory, writes to it, and forgets it. */
static void *volatile lost;
static int leak(void) {
    enum { BYTES = 300 << 20 };
    lost = mmap(NULL, BYTES, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (lost != MAP_FAILED) memset(lost, 1, BYTES);
    return lost != MAP_FAILED;
}
BUILD(build_leak, if (!leak()) return RAYTALLY_BUILD_NO_MEMORY;)
BUILD(build_memory, if (!take_memory()) return RAYTALLY_BUILD_NO_MEMORY;)

static void print_line(const char *line) {
    puts(line);
    fflush(stdout);
}
BUILD(build_print, print_line("{ faulty-print is built");)

/* Overwrites all shared memory, or the first of it if it is large. */
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

/* Leaves behind a process without a parent that runs for a while. */
static void start_daemon(void) {
    if (fork() != 0) return;
    setsid();
    sleep(2);
    _exit(0);
}

/* Kills its parent by a descriptor instead of a process id. */
static void kill_by_descriptor(void) {
    char path[64];
    snprintf(path, sizeof path, "/proc/%d", (int)getppid());
    syscall(SYS_pidfd_send_signal, open(path, O_RDONLY | O_DIRECTORY), SIGKILL, NULL, 0);
}

static void start_thread(void *(*run)(void *)) {
    pthread_t thread;
    pthread_create(&thread, NULL, run, NULL);
}

static void *run_for_ever(void *unused) {
    loop();
    return unused;
}

static void *sleep_for_ever(void *unused) {
    while (zero == 0) pause();
    return unused;
}

BUILD(build_scribble, scribble();)
BUILD(build_kill, kill(getppid(), SIGKILL);)
BUILD(build_descriptor, kill_by_descriptor();)
BUILD(build_trace, ptrace(PTRACE_ATTACH, getppid(), NULL, NULL);)
BUILD(build_thread, start_thread(run_for_ever);)
BUILD(build_pool, start_thread(sleep_for_ever);)
BUILD(build_close, for (int descriptor = 0; descriptor < 64; descriptor++) close(descriptor);)
BUILD(build_daemon, start_daemon();)

/* A structure may be NULL. */
BUILD(build_null, *self = NULL; if (zero == 0) return RAYTALLY_BUILD_OK;)

/* ---- while it traces ---- */

/* The search NAME, which does as it says. */
#define SEARCH_ALONE(name, ...)                                                                              \
    RAYTALLY_INLINE void name(const List *list, void *memory, const raytally_prepared *ray, int any,         \
                              raytally_hit *best, raytally_counters *counters) {                             \
        (void)list, (void)memory, (void)ray, (void)any, (void)best, (void)counters;                          \
        __VA_ARGS__                                                                                          \
    }                                                                                                        \
    RAYTALLY_DEFINE_KERNELS(List, name)

/* The search NAME, which does what `search` does and then something else. */
#define SEARCH(name, ...) SEARCH_ALONE(name, search(list, memory, ray, any, best, counters); __VA_ARGS__)

SEARCH_ALONE(none, )

/* As plugins did that were compiled when raytally_prepare and raytally_object_hits only called raytally. */
SEARCH_ALONE(by_calls, raytally_prepared own; ray->query->host->prepare(ray->query, ray->ray, &own);
             ray->query->host->object_hits(&own, list->ids, list->count, any, best, counters);)

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

/* Valgrind loads a library of its own first. */
static int is_in_valgrind(void) {
    const char *loaded = getenv("LD_PRELOAD");
    return loaded && strstr(loaded, "vgpreload");
}
/* At the first ray. */
static atomic_flag leaked = ATOMIC_FLAG_INIT;
SEARCH(leaking, if (!atomic_flag_test_and_set(&leaked)) leak();)

SEARCH(illegal, if (is_in_valgrind()) raise(SIGILL);)

SEARCH(print, if (is_rare(ray->ray)) print_line("{ faulty-print is asked");)

/* Writing outside its own memory, which has MEMORY bytes. */
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

/* Wrong answers. */
SEARCH(no_such_object, if (best->object != RAYTALLY_NO_OBJECT) best->object = list->count + 5;)
SEARCH(not_a_number, if (best->object != RAYTALLY_NO_OBJECT) best->t = NAN;)
SEARCH(farther, if (isinf(ray->ray->tmax)) best->t = nextafterf(best->t, INFINITY);)

SEARCH(endless, if (best->object != RAYTALLY_NO_OBJECT && isinf(ray->ray->tmax)) best->t = INFINITY;)
SEARCH(early, if (best->object != RAYTALLY_NO_OBJECT && ray->ray->tmin > 0) best->t = 0;)

/* A plain mistake: its list ends one too early. */
SEARCH_ALONE(forgetful,
             raytally_object_hits(ray, list->ids, list->count ? list->count - 1 : 0, any, best, counters);)

/* Right, but with different counts each time. */
static atomic_uint calls;
SEARCH(moody, RAYTALLY_COUNT(counters, RAYTALLY_EXTENT_TESTS, atomic_fetch_add(&calls, 1));)

/* Right only if rays are counted. */
SEARCH_ALONE(lazy, if (counters) search(list, memory, ray, any, best, counters);)

/* Shows a step that it has not counted, and one of no counter: neither is an event. */
SEARCH_ALONE(shows, raytally_show(ray, RAYTALLY_STEPS, 7, list->boxes, counters);
             raytally_show(ray, RAYTALLY_COUNTERS, 7, NULL, counters);
             search(list, memory, ray, any, best, counters);)

/* Wrong counts. */
SEARCH_ALONE(uncounted, RAYTALLY_COUNT(counters, RAYTALLY_STEPS, 1);
             raytally_object_hits(ray, list->ids, list->count, any, best, NULL);)
SEARCH(counted_twice, RAYTALLY_COUNT(counters, RAYTALLY_OBJECT_TESTS, list->count);)
SEARCH(backwards, RAYTALLY_COUNT(counters, RAYTALLY_STEPS, -1000000);)

/* Invalid answers, and writing beside them. */
#define OCCLUDED_BY(name, object)                                                                            \
    static void name(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,        \
                     size_t count, uint32_t *occluders, raytally_counters *counters) {                       \
        search_occluded(self, memory, query, rays, count, occluders, counters);                              \
        for (size_t i = 0; i < count; i++)                                                                   \
            occluders[i] = occluders[i] == RAYTALLY_NO_OBJECT ? occluders[i] : (object);                     \
    }
OCCLUDED_BY(occluded_by_first, 0)
OCCLUDED_BY(occluded_by_some, RAYTALLY_UNNAMED_OBJECT)
OCCLUDED_BY(occluded_by_none_such, ((const List *)self)->count)

/* The kernel NAME, which answers all rays but `left`, and then does something else. */
#define NEAREST(name, left, ...)                                                                             \
    static void name(const void *self, void *memory, raytally_query *query, const raytally_ray *rays,        \
                     size_t count, raytally_hit *hits, raytally_counters *counters) {                        \
        search_nearest(self, memory, query, rays, count - (left), hits, counters);                           \
        __VA_ARGS__                                                                                          \
    }

static void shorten(raytally_ray *rays, size_t count, const raytally_hit *hits) {
    for (size_t i = 0; i < count; i++) rays[i].tmax = hits[i].t < rays[i].tmax ? hits[i].t : rays[i].tmax;
}

NEAREST(all_but_one, 1, )
NEAREST(crash_alone, 0, if (count == 1) crash();)
NEAREST(crash_together, 0, if (count > 1) crash();)
NEAREST(one_too_many, 0, hits[count] = hits[count - 1];)
NEAREST(one_too_early, 0, *(hits - 1) = hits[0];)
NEAREST(shorten_rays, 0, shorten((raytally_ray *)(uintptr_t)rays, count, hits);)

/* Never calls raytally_prepare, finds nothing, and crashes at one ray of 256. */
static void unprepared_nearest(const void *self, void *memory, raytally_query *query,
                               const raytally_ray *rays, size_t count, raytally_hit *hits,
                               raytally_counters *counters) {
    (void)self, (void)memory, (void)query, (void)counters;
    for (size_t i = 0; i < count; i++) {
        if (is_rare(&rays[i])) crash();
        hits[i] = (raytally_hit){INFINITY, RAYTALLY_NO_OBJECT};
    }
}

/* The kernel NAME_nearest of an overlay, which does something to each ray, passes it on, and does something
 * else. */
#define OVERLAY(name, before, after)                                                                         \
    static void name##_nearest(const void *self, void *memory, raytally_query *query,                        \
                               const raytally_ray *rays, size_t count, raytally_hit *hits,                   \
                               raytally_counters *counters) {                                                \
        (void)self, (void)memory, (void)counters;                                                            \
        for (size_t i = 0; i < count; i++) {                                                                 \
            raytally_ray ray = rays[i];                                                                      \
            before;                                                                                          \
            raytally_nearest_below(query, &ray, 1, &hits[i]);                                                \
            after;                                                                                           \
        }                                                                                                    \
    }
OVERLAY(pass_on, , )
OVERLAY(pass_on_crash, , if (is_rare(&ray)) crash())
OVERLAY(pass_on_nan, ray.dir[1] = NAN, )
OVERLAY(pass_on_kind, ray.kind = 77, )

/* ---- other functions ---- */

static void show_none(const void *self, raytally_box_visitor *visit, void *context) {
    (void)self;
    visit(context, NULL, 0, 1);
}

static void show_deep(const void *self, raytally_box_visitor *visit, void *context) {
    const List *list = self;
    if (list->count > 0) visit(context, list->boxes, UINT32_MAX, 1);
}

static void show_crash(const void *self, raytally_box_visitor *visit, void *context) {
    (void)self, (void)visit, (void)context;
    crash();
}

static void mumble(const raytally_build_input *from) {
    for (size_t i = 0; i + 1 < from->message_room; i++) from->message[i] = i % 7 ? '\xe9' : '\x1b';
}
BUILD(build_mumble, mumble(from); if (zero == 0) return RAYTALLY_BUILD_REFUSED;)

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

static int validate_broken(const void *self, char *message, size_t size) {
    (void)self;
    snprintf(message, size, "node 3 is its own parent");
    return 1;
}

/* ---- the tables ---- */

#define KERNELS(name) .nearest = name##_nearest, .occluded = name##_occluded

#define FAULTY(what, does, ...)                                                                              \
    { .name = "faulty-" what, .summary = does, __VA_ARGS__ }

/* One that answers by hit functions of its own, or says so; and an overlay. */
#define OWN(what, does, ...)                                                                                 \
    FAULTY("own-" what, "has its own hit functions, and " does, .flags = RAYTALLY_OWN_HITS, __VA_ARGS__)
#define OVER(what, does, kernel)                                                                             \
    FAULTY("over" what, "is an overlay, and " does, .nearest = kernel, .flags = RAYTALLY_OVERLAY)

/* Members that are not set get the correct functions. */
static raytally_accel_ops tables[] = {
    {.name = "faulty-not", .summary = "is in order"},
    FAULTY("crash-build", "crashes while it builds", .build = build_crash),
    FAULTY("crash-nearest", "crashes at the first ray", KERNELS(crash_nearest)),
    FAULTY("crash-timed", "crashes where nothing is counted", KERNELS(crash_timed)),
    FAULTY("crash-rare", "crashes at a ray of 256", KERNELS(crash_rare)),
    FAULTY("crash-destroy", "crashes when it is done", .destroy = destroy_crash),
    FAULTY("crash-describe", "crashes when described", .describe = describe_crash),
    FAULTY("loop-build", "builds for ever", .build = build_loop),
    FAULTY("loop-nearest", "traces for ever", KERNELS(loop_nearest)),
    FAULTY("loop-timed", "traces for ever where nothing is counted", KERNELS(loop_timed)),
    FAULTY("abort", "aborts", KERNELS(call_abort)),
    FAULTY("exit", "ends its process, without an error", KERNELS(call_exit)),
    FAULTY("killed", "is killed, as where memory is short", KERNELS(killed)),
    FAULTY("crash-alone", "crashes when asked for a ray by itself", .nearest = crash_alone),
    FAULTY("crash-together", "crashes when asked for more than a ray", .nearest = crash_together),
    FAULTY("scribble", "writes to shared memory as it builds", .build = build_scribble),
    FAULTY("scribbled", "writes to shared memory at each ray", KERNELS(scribbled)),
    FAULTY("kill", "kills its parent", .build = build_kill),
    FAULTY("descriptor", "kills its parent otherwise", .build = build_descriptor),
    FAULTY("trace", "traces its parent", .build = build_trace),
    FAULTY("thread", "leaves a thread that runs", .build = build_thread),
    FAULTY("pool", "leaves a thread that sleeps", .build = build_pool),
    FAULTY("leak", "loses memory as it builds", .build = build_leak),
    FAULTY("leaking", "loses memory as it traces", KERNELS(leaking)),
    FAULTY("close", "closes every file", .build = build_close),
    FAULTY("daemon", "leaves a process behind", .build = build_daemon),
    FAULTY("divide", "divides by zero", KERNELS(divide)),
    FAULTY("recursion", "recurses for ever", KERNELS(overflow)),
    FAULTY("free", "frees a block twice", KERNELS(freed_twice)),
    FAULTY("object", "answers with an object that does not exist", KERNELS(no_such_object)),
    FAULTY("nan", "answers with a t that is no number", KERNELS(not_a_number)),
    FAULTY("farther", "answers with a t a little too large", KERNELS(farther)),
    FAULTY("wrong", "forgets the last object", KERNELS(forgetful)),
    FAULTY("null", "has no structure, which it may, and finds nothing, which it may not", .build = build_null,
           KERNELS(none)),
    FAULTY("memory", "writes past the memory of its query, a little", .query_bytes = query_bytes,
           KERNELS(past_memory)),
    FAULTY("page", "writes past the memory of its query, by a page", .query_bytes = query_bytes,
           KERNELS(past_page)),
    FAULTY("huge", "asks for all memory for a query", .query_bytes = query_bytes_huge),
    FAULTY("boxes", "writes into the boxes that it borrows", KERNELS(into_boxes)),
    FAULTY("greedy", "takes all memory while it builds", .build = build_memory),
    FAULTY("refused", "refuses every scene", .build = build_refused),
    FAULTY("nonsense", "builds, and says nonsense", .build = build_nonsense),
    FAULTY("validate", "is invalid", .validate = validate_broken),
    FAULTY("moody", "counts otherwise each time", KERNELS(moody)),
    FAULTY("lazy", "finds nothing where nothing is counted", KERNELS(lazy)),
    FAULTY("uncounted", "keeps its counters to itself", KERNELS(uncounted)),
    FAULTY("twice", "counts object tests that are counted", KERNELS(counted_twice)),
    FAULTY("backwards", "counts below zero", KERNELS(backwards)),
    FAULTY("occluder", "names any occluder", .occluded = occluded_by_first),
    FAULTY("unnamed", "names no occluder", .occluded = occluded_by_some),
    FAULTY("silent", "leaves the last ray unanswered", .nearest = all_but_one),
    FAULTY("beyond", "writes an answer too many", .nearest = one_too_many),
    FAULTY("before", "writes in front of its answers", .nearest = one_too_early),
    FAULTY("rays", "shortens the rays that it is lent", .nearest = shorten_rays),
    FAULTY("debts", "takes less than no memory", .describe = describe_debts),
    FAULTY("box", "shows a box that is none", .each_box = show_none),
    FAULTY("deep", "shows a box at a depth that is none", .each_box = show_deep),
    FAULTY("show", "crashes when it shows its boxes", .each_box = show_crash),
    FAULTY("shows", "shows a step that it has not counted", KERNELS(shows)),
    FAULTY("mumble", "refuses every scene in no language", .build = build_mumble),
    FAULTY("illegal", "has an instruction that valgrind does not know", KERNELS(illegal)),
    FAULTY("older",
           "is in order, and of the first version: its table ends before these flags, it tests by calls",
           KERNELS(by_calls), .size = offsetof(raytally_accel_ops, flags),
           .flags = RAYTALLY_OWN_HITS | RAYTALLY_NO_COUNTS),
    OWN("unprepared", "crashes at a ray of 256", .nearest = unprepared_nearest),
    OWN("object", "answers with an object that does not exist", KERNELS(no_such_object)),
    OWN("nan", "answers with a t that is no number", KERNELS(not_a_number)),
    OWN("endless", "answers with a t at infinity", KERNELS(endless)),
    OWN("early", "answers with a t before the ray", KERNELS(early)),
    OWN("occluder", "answers with an occluder that does not exist", .occluded = occluded_by_none_such),
    OWN("moody", "counts otherwise each time", KERNELS(moody)),
    OWN("farther", "answers with a t a little too large", KERNELS(farther)),
    OWN("uncounted", "keeps its counters to itself", KERNELS(uncounted)),
    OWN("unnamed", "names no occluder", .occluded = occluded_by_some),
    OWN("wrong", "forgets the last object", KERNELS(forgetful)),
    OWN("lazy", "finds nothing where nothing is counted", KERNELS(lazy)),
    OVER("", "in order", pass_on_nearest),
    OVER("-crash", "crashes at a ray of 256", pass_on_crash_nearest),
    OVER("-nan", "passes on rays that are not valid", pass_on_nan_nearest),
    OVER("-kind", "passes on rays of no kind", pass_on_kind_nearest),
    FAULTY("base", "passes rays on, and is no overlay", .nearest = pass_on_nearest),
    FAULTY("print", "prints, but is right", .build = build_print, KERNELS(print)),
};

RAYTALLY_PLUGIN {
    if (index >= sizeof tables / sizeof tables[0]) return NULL;
    raytally_accel_ops *table = &tables[index];
    table->abi = RAYTALLY_ACCEL_ABI;
    if (table->size == 0) table->size = sizeof *table;
    table->paper = "none";
    if (!table->build) table->build = build;
    if (!table->destroy) table->destroy = destroy;
    if (!table->nearest) table->nearest = search_nearest;
    if (!table->occluded) table->occluded = search_occluded;
    return table;
}
