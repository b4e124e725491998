/* SPDX-License-Identifier: Apache-2.0 */
/* The process of a remote accelerator: see channel.h. */
#include "accel/plugin/channel.h"
#include "core/base/memory.h"
#include "core/base/observe.h"
#include "core/base/process.h"

#include <errno.h>
#include <fenv.h>
#include <limits.h>
#include <linux/futex.h>
#include <locale.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static struct Server {
    Shared *shared; /* NULL in raytally's own process */
    const RtSpec *spec;
    const RtScene *scene;
    int threads;
    RtAccel *accel;
    RtQuery queries[CHANNELS];
} server;

void rt_remote_progress(void) {
    if (server.shared) atomic_fetch_add_explicit(&server.shared->progress, 1, memory_order_relaxed);
}

void rt_futex_wait(atomic_uint *word, unsigned value, int milliseconds) {
    const struct timespec most = {milliseconds / 1000, milliseconds % 1000 * 1000000L};
    syscall(SYS_futex, word, FUTEX_WAIT, value, milliseconds < 0 ? NULL : &most, NULL, 0);
}

void rt_futex_set(atomic_uint *word, unsigned value) {
    atomic_store_explicit(word, value, memory_order_release);
    syscall(SYS_futex, word, FUTEX_WAKE, INT_MAX, NULL, NULL, 0);
}

/* ---- how it ends ---- */

/* Records the signal and the ray, using only what is safe in a signal handler. */
static void on_signal(int number, siginfo_t *info, void *unused) {
    (void)unused;
    Crash *crash = &server.shared->crash;
    const RtPluginNow *now = rt_plugin_now(number == SIGXCPU);
    const char *at = number == SIGSEGV || number == SIGBUS ? info->si_addr : NULL;
    crash->signal = number;
    if (now && now->stream) {
        if (at >= now->mapping && at < now->mapping + now->mapped) crash->out_of = at < now->middle ? 1 : 2;
        const void *ray = now->face.ray ? (const void *)now->face.ray : now->stream;
        memcpy(&crash->ray, ray, sizeof crash->ray);
        crash->traced = now->face.ray ? 2 : 1;
    }
    _exit(EXIT_FAILURE);
}

/* A plugin that calls exit must not run the exit handlers of raytally and its libraries. */
static void on_exit_called(int code, void *unused) {
    (void)unused;
    _exit(code);
}

/* A stack for signal handlers of this thread, because its own may have overflowed. All threads share it: the
 * first that crashes ends the process. */
static void set_signal_stack(void) {
    static char memory[64 * 1024];
    stack_t stack;
    if (sigaltstack(NULL, &stack) == 0 && !(stack.ss_flags & SS_DISABLE)) return; /* a sanitizer's */
    sigaltstack(&(stack_t){.ss_sp = memory, .ss_size = sizeof memory}, NULL);
}

static void watch_signals(void) {
    static const int numbers[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGXCPU};
    struct sigaction action = {.sa_flags = SA_SIGINFO | SA_ONSTACK};
    action.sa_sigaction = on_signal;
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) sigaction(numbers[i], &action, NULL);
    signal(SIGINT, SIG_IGN);  /* raytally handles it */
    signal(SIGTTOU, SIG_IGN); /* it may write to the terminal from the background */
    on_exit(on_exit_called, NULL);
    set_signal_stack();
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

/* Limits what the plugin can allocate, in case that it is faster than raytally, which watches it. */
static void limit_memory(const RtScene *scene) {
    const uint64_t limit = rt_memory_current_limit(), least = rt_accel_byte_limit(scene);
    const bool larger = limit > least && limit < UINT64_MAX;
    const rlim_t used = 1024 * rt_process_status(getpid(), "VmData");
    const rlim_t bytes = used + 2 * (rlim_t)(larger ? limit : least);
    if (used) setrlimit(RLIMIT_DATA, &(struct rlimit){bytes, bytes});
    setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0});
}

/* Waits for a debugger if RAYTALLY_PLUGIN_WAIT is set, before the library is loaded. */
static void wait_for_debugger(void) {
    if (!getenv("RAYTALLY_PLUGIN_WAIT")) return;
    fprintf(stderr, "raytally: the process of the plugin waits for a debugger: gdb -p %d\n", (int)getpid());
    while (rt_process_status(getpid(), "TracerPid") == 0)
        nanosleep(&(struct timespec){.tv_nsec = 100000000}, NULL);
}

/* ---- requests on channel 0 ---- */

RtStatus rt_server_build(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)query, (void)rays;
    Built *built = message;
    RT_TRY(rt_plugin_enter(server.spec, error));
    RT_TRY(rt_accel_build_here(server.spec, server.scene, server.threads, &server.accel, error));
    rt_memory_limit(0);
    built->exact = server.accel->exact;
    built->absolute = server.accel->absolute;
    built->counts = server.accel->counts;
    built->seconds = server.accel->build_seconds;
    rt_accel_describe(server.accel, &built->description);
    return rt_accel_check(server.accel, error); /* a description may have a number that no structure has */
}

RtStatus rt_server_validate(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)query, (void)rays, (void)message;
    return rt_accel_validate(server.accel, error);
}

RtStatus rt_server_check(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)query, (void)rays, (void)message;
    return rt_accel_check(server.accel, error);
}

RtStatus rt_server_destroy(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)query, (void)rays, (void)message, (void)error;
    rt_accel_destroy(server.accel);
    return RT_OK;
}

static void send_box(void *context, const RtBoxView *view) {
    Boxes *to = context;
    if (rt_accel_base(server.accel)->ops->shows_lists && view->leaf && view->objects == 0)
        return; /* an empty leaf */
    const uint64_t number = to->seen++;
    if (number < to->first || to->count == MOST_BOXES) return;
    to->boxes[to->count].box = *view->box;
    to->boxes[to->count].depth = view->depth;
    to->boxes[to->count++].leaf = view->leaf;
}

RtStatus rt_server_boxes(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)query, (void)rays, (void)error;
    Boxes *to = message;
    const RtAccel *base = rt_accel_base(server.accel);
    to->count = 0;
    to->seen = 0;
    if (base->ops->each_box) base->ops->each_box(base, (RtBoxViewer){send_box, to});
    return RT_OK;
}

/* ---- requests on channels of queries ---- */

RtStatus rt_server_trace(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)error;
    Stream *stream = message;
    rt_trace_stream(query->accel, query->scratch, rays, stream->count, stream->any ? NULL : stream->hits,
                    stream->occluders, stream->counted ? stream->tallies : NULL);
    return RT_OK;
}

/* The observer. */
static void send_event(void *context, const RtTraced *event) {
    Events *to = context;
    const uint64_t number = to->seen++;
    if (number < to->first || to->count == MOST_EVENTS) return;
    Event *out = &to->events[to->count++];
    *out = (Event){.kind = (uint32_t)event->kind,
                   .index = event->index,
                   .t = event->t,
                   .leaf = event->leaf,
                   .empty = event->empty,
                   .met = event->met,
                   .in_tree = event->in_tree,
                   .boxed = event->box != NULL,
                   .round = event->ball != NULL};
    if (event->box) out->box = *event->box;
    if (event->ball) out->ball = *event->ball;
    if (event->what) strncpy(out->what, event->what, sizeof out->what - 1);
}

RtStatus rt_server_events(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)error;
    Events *to = message;
    RtTally tallies[RT_RAY_KIND_COUNT] = {0};
    RtHit hit;
    bool blocked;
    to->count = 0;
    to->seen = 0;
    rt_trace_observer = &(RtTraceObserver){send_event, to};
    if (to->any)
        rt_occluded(query, rays, 1, &blocked, tallies);
    else
        rt_nearest(query, rays, 1, &hit, tallies);
    rt_trace_observer = NULL;
    return RT_OK;
}

/* ---- channels ---- */

/* Answers requests one after the other, until the channel is closed and its query is cleared. A plugin may
 * have changed the rounding mode or flushed denormals, which hit functions must not see. */
static void serve(Channel *channel, RtQuery *query) {
    unsigned asked, done = channel->answered;
    for (bool more = true; more; rt_futex_set(&channel->answered, ++done)) {
        while ((asked = atomic_load_explicit(&channel->asked, memory_order_acquire)) != done + 1)
            rt_futex_wait(&channel->asked, asked, -1);
        fesetenv(FE_DFL_ENV);
        more = channel->work != NULL;
        if (more && query && channel->begin) rt_query_begin(query);
        channel->begin = false;
        if (more)
            channel->status = channel->work(query, channel->rays, channel->message, &channel->error);
        else
            rt_query_clear(query);
        rt_remote_progress();
    }
}

static void *serve_query(void *channel) {
    set_signal_stack();
    serve(channel, &server.queries[(Channel *)channel - server.shared->channels]);
    return NULL;
}

/* Whatever a query lacks, the others do without this accelerator. */
RtStatus rt_server_open(RtQuery *query, const RtRay *rays, void *message, RtError *error) {
    (void)query, (void)rays;
    const uint32_t number = *(uint32_t *)message;
    RtQuery *own = &server.queries[number];
    pthread_t thread;
    if (rt_query_init(own, server.accel, error) != RT_OK) return RT_BROKEN;
    if (pthread_create(&thread, NULL, serve_query, &server.shared->channels[number]) == 0) {
        pthread_detach(thread);
        return RT_OK;
    }
    rt_query_clear(own);
    return rt_fail(error, RT_BROKEN, "there is no memory for a thread");
}

void rt_server_run(Shared *shared, const RtSpec *spec, const RtScene *scene, int threads) {
    pthread_t thread;
    server = (struct Server){.shared = shared, .spec = spec, .scene = scene, .threads = threads};
    madvise(shared, sizeof(Shared), MADV_DONTFORK); /* processes that the plugin forks must not have it */
    limit_memory(scene);
    watch_signals();
    setlocale(LC_ALL, "C"); /* the program that uses the library may have another one */
    if (pthread_create(&thread, NULL, watch_raytally, NULL) != 0)
        _exit(EXIT_FAILURE); /* it would outlive raytally */
    wait_for_debugger();
    serve(&shared->channels[0], NULL);
    _exit(EXIT_SUCCESS); /* raytally closes channel 0 by ending the process */
}
