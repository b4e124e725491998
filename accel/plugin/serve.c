/* SPDX-License-Identifier: Apache-2.0 */
/* The process of a remote accelerator: see wire.h. */
#include "accel/plugin.h"
#include "accel/plugin/host.h"
#include "accel/plugin/wire.h"
#include "core/base/process.h"

#include "core/base/memory.h"

#include <fenv.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

static struct Served {
    Wire *wire;
    RtAccel *accel;
} served;

void rt_remote_progress(void) {
    if (served.wire) atomic_fetch_add_explicit(&served.wire->progress, 1, memory_order_relaxed);
}

/* ---- how it ends ---- */

/* Copies the stream. The plugin may have overwritten what the query is doing. */
static void record_stream(Crash *crash, const RtPluginNow *now) {
    const size_t count = now->count < WIRE_RAYS ? now->count : WIRE_RAYS;
    const size_t ray = (size_t)((const RtRay *)now->face.ray - now->stream);
    memcpy(crash->rays, now->stream, count * sizeof(RtRay));
    crash->ray = ray < count ? (uint32_t)ray : 0;
    crash->any = now->any;
    crash->counted = now->counted;
    crash->layers = now->layers;
    crash->count = (uint32_t)count;
}

/* Records the signal and the rays, using only what is safe in a signal handler. */
static void on_signal(int number, siginfo_t *info, void *unused) {
    (void)unused;
    Crash *crash = &served.wire->crash;
    const RtPluginNow *now = number == SIGXCPU ? rt_plugin_busy() : rt_plugin_now();
    if (now && now->face.ray) {
        record_stream(crash, now);
        const char *at = number == SIGSEGV || number == SIGBUS ? info->si_addr : NULL;
        for (uint32_t i = 0; at && i < RT_GUARD_COUNT; i++) {
            const RtGuarded *guarded = &now->guarded[i];
            if (at >= guarded->mapping && at < guarded->mapping + guarded->mapped) crash->out_of = i + 1;
        }
    }
    crash->signal = number;
    _exit(EXIT_FAILURE);
}

/* A plugin that calls exit must not run the exit handlers of raytally and its libraries. */
static void on_exit_called(int code, void *unused) {
    (void)unused;
    _exit(code);
}

/* Sets up a stack for signal handlers of the thread, because its own may have overflowed. */
static void *add_signal_stack(void) {
    stack_t stack;
    if (sigaltstack(NULL, &stack) == 0 && !(stack.ss_flags & SS_DISABLE)) return NULL; /* a sanitizer's */
    stack = (stack_t){.ss_size = (size_t)64 * 1024};
    stack.ss_sp = malloc(stack.ss_size);
    if (stack.ss_sp) sigaltstack(&stack, NULL);
    return stack.ss_sp;
}

static void remove_signal_stack(void *stack) {
    if (stack) sigaltstack(&(stack_t){.ss_flags = SS_DISABLE}, NULL);
    free(stack);
}

static void watch_signals(void) {
    static const int numbers[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU};
    struct sigaction action = {.sa_flags = SA_SIGINFO | SA_ONSTACK};
    action.sa_sigaction = on_signal;
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) sigaction(numbers[i], &action, NULL);
    signal(SIGINT, SIG_IGN);  /* raytally handles it */
    signal(SIGTTOU, SIG_IGN); /* it may write to the terminal from the background */
    on_exit(on_exit_called, NULL);
    add_signal_stack();
}

/* Ends the process when raytally ends, whatever the plugin is doing. A plugin may close all files; then
 * another parent shows that raytally has ended. */
static void *watch_raytally(void *unused) {
    const pid_t raytally = getppid();
    char byte;
    while (read(RT_PROCESS_KEPT, &byte, 1) < 0 && getppid() == raytally)
        nanosleep(&(struct timespec){.tv_nsec = 50000000}, NULL);
    (void)unused;
    if (getpgrp() == getpid()) kill(0, SIGKILL); /* and everything it started */
    _exit(EXIT_FAILURE);
}

/* Bytes that count for RLIMIT_DATA; 0 if they are unknown. */
static rlim_t data_bytes(void) {
    unsigned long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%*u %*u %*u %*u %*u %lu", &pages) != 1) pages = 0;
    if (file) fclose(file);
    return (rlim_t)pages * (rlim_t)sysconf(_SC_PAGESIZE);
}

/* Limits what the plugin can allocate, in case that it is faster than raytally, which watches it. */
static void limit_memory(const RtScene *scene) {
    const uint64_t limit = rt_memory_current_limit(), least = rt_accel_byte_limit(scene);
    const bool larger = limit > least && limit < UINT64_MAX;
    const rlim_t used = data_bytes(), bytes = used + 2 * (rlim_t)(larger ? limit : least);
    if (used) setrlimit(RLIMIT_DATA, &(struct rlimit){bytes, bytes});
    setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
}

static bool is_debugged(void) {
    int tracer = 0;
    char line[128];
    FILE *file = fopen("/proc/self/status", "r");
    while (file && tracer == 0 && fgets(line, sizeof line, file)) sscanf(line, "TracerPid: %d", &tracer);
    if (file) fclose(file);
    return tracer != 0;
}

/* Waits for a debugger if RAYTALLY_PLUGIN_WAIT is set, before the library is loaded. */
static void wait_for_debugger(void) {
    if (!getenv("RAYTALLY_PLUGIN_WAIT")) return;
    fprintf(stderr, "raytally: the process of the plugin waits for a debugger: gdb -p %d\n", (int)getpid());
    while (!is_debugged()) nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
}

/* ---- requests ---- */

void rt_wire_validate(RtQuery *query, const RtRay *rays, void *message) {
    (void)query, (void)rays;
    WireChecked *checked = message;
    checked->status = rt_accel_validate(served.accel, &checked->error);
}

void rt_wire_check(RtQuery *query, const RtRay *rays, void *message) {
    (void)query, (void)rays;
    WireChecked *checked = message;
    checked->status = rt_accel_check(served.accel, &checked->error);
}

void rt_wire_destroy(RtQuery *query, const RtRay *rays, void *message) {
    (void)query, (void)rays, (void)message;
    rt_accel_destroy(served.accel);
    served.accel = NULL;
}

static void ignore(void *context, const RtBoxView *view) {
    (void)context, (void)view;
}

/* Shows all boxes to a viewer that ignores them: host.c checks them. */
void rt_wire_show(RtQuery *query, const RtRay *rays, void *message) {
    const RtAccel *base = rt_accel_base(served.accel);
    if (base->ops->each_box) base->ops->each_box(base, (RtBoxViewer){ignore, NULL});
    rt_wire_check(query, rays, message);
}

/* All boxes of the structure, from the request for the first until the last are sent. */
static struct Shown {
    WireBox *boxes; /* [capacity] */
    uint32_t count, capacity;
    bool complete;
} shown;

static void forget_shown(void) {
    rt_free(shown.boxes);
    shown = (struct Shown){0};
}

static void record(void *context, const RtBoxView *view) {
    (void)context;
    if (rt_accel_base(served.accel)->ops->shows_lists && view->leaf && view->objects == 0)
        return; /* an empty leaf */
    if (shown.complete)
        shown.complete = rt_reserve(&shown.boxes, &shown.capacity, (uint64_t)shown.count + 1, sizeof(WireBox),
                                    NULL) == RT_OK;
    if (!shown.complete) return;
    shown.boxes[shown.count++] = (WireBox){*view->box, view->depth, view->leaf};
}

void rt_wire_boxes(RtQuery *query, const RtRay *rays, void *message) {
    (void)query, (void)rays;
    WireBoxes *to = message;
    const RtAccel *base = rt_accel_base(served.accel);
    if (to->first == 0) {
        forget_shown();
        shown.complete = true;
        if (base->ops->each_box) base->ops->each_box(base, (RtBoxViewer){record, NULL});
    }
    uint64_t left = to->first < shown.count ? shown.count - to->first : 0;
    to->complete = shown.complete;
    to->count = (uint32_t)(left < WIRE_BOXES ? left : WIRE_BOXES);
    if (to->count > 0) memcpy(to->boxes, shown.boxes + to->first, to->count * sizeof(WireBox));
    if (left <= WIRE_BOXES) forget_shown();
}

/* Occluders are written over the first hits, and then expanded to hits at tmin. */
static void trace_occluded(RtQuery *query, WireRays *asked, const RtRay *rays) {
    const RtAccelOps *ops = query->accel->ops;
    uint32_t *occluders = (uint32_t *)asked->hits;
    if (asked->counted)
        ops->occluded_counted(query->accel, query->scratch, rays, asked->count, occluders, asked->tallies);
    else
        ops->occluded(query->accel, query->scratch, rays, asked->count, occluders);
    for (uint32_t i = asked->count; i-- > 0;) {
        uint32_t occluder;
        memcpy(&occluder, (const char *)asked->hits + i * sizeof occluder, sizeof occluder);
        asked->hits[i] = (RtHit){rays[i].tmin, occluder};
    }
}

void rt_wire_trace(RtQuery *query, const RtRay *rays, void *message) {
    WireRays *asked = message;
    if (asked->any)
        trace_occluded(query, asked, rays);
    else
        rt_nearest(query, rays, asked->count, asked->hits, asked->counted ? asked->tallies : NULL);
}

void rt_wire_trace_alone(RtQuery *query, const RtRay *rays, void *message) {
    const WireAlone *stream = message;
    for (uint32_t i = 0; i < stream->count; i++) {
        RtTally tallies[RT_RAY_KIND_COUNT] = {0};
        RtHit hit;
        bool blocked;
        served.wire->crash.alone = i;
        if (stream->any)
            rt_occluded(query, &rays[i], 1, &blocked, stream->counted ? tallies : NULL);
        else
            rt_nearest(query, &rays[i], 1, &hit, stream->counted ? tallies : NULL);
    }
}

/* ---- channels ---- */

/* Answers requests one after the other, on copies in this process's own memory, until the channel is closed
 * (then the query is cleared) or the accelerator is destroyed (channel 0). `done` is the number of the last
 * request answered before. A plugin may have changed the rounding mode or flushed denormals, which hit
 * functions must not see. */
static void serve_channel(Channel *channel, unsigned done, RtQuery *query) {
    char *message = rt_alloc_unset(MESSAGE_BYTES, 1);
    if (!message) _exit(EXIT_FAILURE);
    for (bool more = true; more;) {
        unsigned asked;
        while ((asked = atomic_load_explicit(&channel->asked, memory_order_acquire)) != done + 1)
            rt_futex_wait(&channel->asked, asked, NULL);
        RtRemoteWork *work = channel->work;
        size_t bytes = channel->bytes;
        if (work) {
            RtRay *rays = rt_wire_rays(message, bytes);
            memcpy(message, channel->message, bytes);
            memcpy(rays, rt_wire_rays(channel->message, bytes), channel->rays * sizeof(RtRay));
            fesetenv(FE_DFL_ENV);
            if (query && channel->begin) rt_query_begin(query);
            work(query, rays, message);
            memcpy(channel->message, message, bytes);
        } else if (query) {
            rt_query_clear(query);
        }
        more = work && served.accel;
        rt_remote_progress();
        rt_futex_set(&channel->answered, ++done);
    }
    rt_free(message);
}

typedef struct Opening {
    Channel *channel;
    unsigned done;
    RtQuery query;
} Opening;

static void *serve_query(void *context) {
    Opening opening = *(Opening *)context;
    free(context);
    void *stack = add_signal_stack();
    serve_channel(opening.channel, opening.done, &opening.query);
    remove_signal_stack(stack);
    return NULL;
}

void rt_wire_open(RtQuery *query, const RtRay *rays, void *message) {
    (void)query, (void)rays;
    WireChecked *checked = message;
    pthread_t thread;
    pthread_attr_t detached;
    Opening *opening = malloc(sizeof *opening);
    checked->status = opening ? rt_query_init(&opening->query, served.accel, &checked->error)
                              : rt_fail_memory(&checked->error, "a query", sizeof *opening);
    if (checked->status != RT_OK) {
        free(opening);
        return;
    }
    opening->channel = &served.wire->channels[checked->channel];
    opening->done = checked->done;
    pthread_attr_init(&detached);
    pthread_attr_setdetachstate(&detached, PTHREAD_CREATE_DETACHED);
    if (pthread_create(&thread, &detached, serve_query, opening) != 0) {
        rt_query_clear(&opening->query);
        free(opening);
        checked->status = rt_fail_memory(&checked->error, "a thread", 0);
    }
    pthread_attr_destroy(&detached);
}

/* ---- the process ---- */

/* A description with a number that no structure has breaks the plugin. */
static RtStatus describe(const RtSpec *spec, WireBuilt *built) {
    char name[RT_MAX_SPEC_CHARS];
    RtError why;
    rt_accel_describe(served.accel, &built->description);
    const RtStatus status = rt_accel_check(served.accel, &why);
    rt_spec_format(spec, name);
    return status == RT_OK ? RT_OK : rt_fail(&built->error, status, "%s: %s", name, why.message);
}

static void build(const RtSpec *spec, const RtScene *scene, int threads) {
    WireBuilt built = {.status = rt_plugin_enter(spec, &built.error)};
    if (built.status == RT_OK)
        built.status = rt_accel_build_here(spec, scene, threads, &served.accel, &built.error);
    rt_memory_limit(0);
    if (built.status == RT_OK) {
        built.exact = served.accel->exact;
        built.absolute = served.accel->absolute;
        built.counts = served.accel->counts;
        built.seconds = served.accel->build_seconds;
        built.status = describe(spec, &built);
    }
    memcpy(served.wire->channels[0].message, &built, sizeof built);
    rt_futex_set(&served.wire->channels[0].answered, WIRE_BUILD);
}

void rt_wire_serve(Wire *wire, const RtSpec *spec, const RtScene *scene, int threads) {
    pthread_t thread;
    served = (struct Served){.wire = wire};
    madvise(wire, sizeof(Wire), MADV_DONTFORK); /* processes that the plugin forks must not have it */
    limit_memory(scene);
    watch_signals();
    setlocale(LC_ALL, "C"); /* the program that uses the library may have another one */
    fesetenv(FE_DFL_ENV);
    if (pthread_create(&thread, NULL, watch_raytally, NULL) != 0)
        _exit(EXIT_FAILURE); /* it would outlive raytally */
    wait_for_debugger();
    build(spec, scene, threads);
    if (served.accel) serve_channel(&wire->channels[0], WIRE_BUILD, NULL);
    for (;;) pause(); /* until raytally has looked at what is left */
}
