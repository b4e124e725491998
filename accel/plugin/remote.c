/* SPDX-License-Identifier: Apache-2.0 */
/* Remote accelerators in raytally's own process: an RtAccel that sends requests to the other process
 * (channel.h), watches it, and says how it failed. The first failure is kept; later ones follow from it.
 *
 * /proc shows what the process uses and leaves behind: whether its memory exceeds the limit, and what becomes
 * a notice (rt_remote_notice). Without /proc there are no notices and no limit. */
#include "accel/kernel.h"
#include "accel/plugin/channel.h"
#include "core/base/memory.h"
#include "core/base/observe.h"
#include "core/base/process.h"
#include "core/base/words.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

typedef struct Remote {
    RtAccel base;
    RtAccelOps ops;               /* remote_ops, with the name of the topmost plugin */
    char name[RT_MAX_SPEC_CHARS]; /* for messages */
    RtSpec spec;
    int threads; /* to build with */
    Shared *shared;
    RtProcess process;
    int pipe_end;             /* the process ends when this is closed */
    double time_limit;        /* seconds without progress after which it counts as hung */
    unsigned asked[CHANNELS]; /* number of the last request on each channel */
    pthread_mutex_t master;   /* of channel 0 */
    RtDescription description;
    double before, built; /* megabytes of memory that the process holds, at the fork and once it was built */
    double memory_limit;  /* the most megabytes that it may hold beyond `before` */
    pthread_mutex_t lock; /* of the following members */
    bool used[CHANNELS];  /* by queries; channel 0 by none */
    atomic_bool broken;   /* error says why */
    bool ended;
    RtError error; /* its status is RT_BROKEN; RT_BAD_INPUT if the structure exceeds the limit of memory */
} Remote;

static const RtAccelOps remote_ops;
static void destroy(RtAccel *accel);

static Remote *of(const RtAccel *accel) {
    return (Remote *)accel;
}

bool rt_accel_is_remote(const RtAccel *accel) {
    return accel->ops->destroy == destroy;
}

static double time_limit_of_user(void) {
    const char *text = getenv("RAYTALLY_PLUGIN_SECONDS");
    const double seconds = text ? strtod(text, NULL) : 0;
    if (getenv("RAYTALLY_PLUGIN_WAIT")) return INFINITY; /* for a debugger */
    return seconds > 0 && seconds < 1e6 ? seconds : 60;
}

/* ---- what it uses and leaves behind ---- */

enum { MOST_NOTICES = 64 };
static struct Notice {
    const char *name, *what; /* of the accelerator; the format */
    char text[512];
} notices[MOST_NOTICES];
static size_t notice_count;
static pthread_mutex_t notice_lock = PTHREAD_MUTEX_INITIALIZER;

const char *rt_remote_notice(size_t i) {
    pthread_mutex_lock(&notice_lock);
    const char *text = i < notice_count ? notices[i].text : NULL;
    pthread_mutex_unlock(&notice_lock);
    return text;
}

/* The first of each kind is kept for each accelerator. */
__attribute__((format(printf, 2, 3))) static void note(const Remote *remote, const char *what, ...) {
    const char *name = remote->ops.name;
    va_list arguments;
    pthread_mutex_lock(&notice_lock);
    size_t i = 0;
    while (i < notice_count && (notices[i].what != what || notices[i].name != name)) i++;
    if (i == notice_count && i < MOST_NOTICES) {
        struct Notice *notice = &notices[notice_count++];
        notice->name = name;
        notice->what = what;
        const int length = snprintf(notice->text, sizeof notice->text, "%s: ", name);
        va_start(arguments, what);
        vsnprintf(notice->text + length, sizeof notice->text - (size_t)length, what, arguments);
        va_end(arguments);
    }
    pthread_mutex_unlock(&notice_lock);
}

/* An entry of /proc/PID/status in megabytes; 0 if it is unknown. */
static double megabytes(pid_t pid, const char *entry) {
    return 1024e-6 * (double)rt_process_status(pid, entry);
}

/* The most that it ever held beyond what it began with, which is a copy of raytally's memory. */
static double peak_megabytes(const Remote *remote) {
    const pid_t pid = remote->process.pid;
    return megabytes(pid, "VmHWM") - megabytes(pid, "RssFile") - remote->before;
}

/* The limit is wide: arenas of the C library, and large pages for the stacks of threads, are memory, too. */
static void note_build(const Remote *remote) {
    const double held = remote->built - remote->before, described = 1e-6 * (double)remote->description.bytes;
    if (held > 256 + 4 * described)
        note(
            remote,
            "its process holds %.0f MB of memory once it is built, and its `describe` says %.3g MB: the rest "
            "is not described, or never freed",
            held, described);
}

/* Threads that sleep, such as those of a pool, disturb nothing, and are not reported. raytally's own two
 * threads sleep. */
static void note_threads(const Remote *remote) {
    enum { OWN_THREADS = 2, PAUSE = 50000000 /* ns */ };
    struct timespec start = {0}, end = {0};
    clockid_t clock;
    if (rt_process_status(remote->process.pid, "Threads") <= OWN_THREADS ||
        clock_getcpuclockid(remote->process.pid, &clock) != 0)
        return;
    clock_gettime(clock, &start);
    nanosleep(&(struct timespec){.tv_nsec = PAUSE}, NULL);
    clock_gettime(clock, &end);
    if ((end.tv_sec - start.tv_sec) * 1000000000 + end.tv_nsec - start.tv_nsec > PAUSE / 10)
        note(remote,
             "it left a thread behind, still running after `destroy`, which may have slowed down what "
             "was measured; raytally ended it");
}

static void note_processes(const Remote *remote, const RtProcessEnd *end) {
    if (end->left > 0)
        note(remote, "it left %u process%s behind (%s), which raytally ended", end->left,
             end->left == 1 ? "" : "es", end->left_name);
}

/* ---- how it fails ---- */

/* "NAME: WHAT[ while DOING][, at the ray ...]". Only the first failure is kept. */
static void set_broken(Remote *remote, const char *what, const char *doing) {
    static const char *const places[] = {"", "; its stream begins with the ray ", ", at the ray "};
    char text[RT_RAY_TEXT];
    const RtRay ray = remote->shared->crash.ray;
    const uint32_t traced = remote->shared->crash.traced, place = traced <= 2 ? traced : 0;
    if (remote->broken) return;
    rt_ray_format(&ray, text, sizeof text);
    rt_fail(&remote->error, RT_BROKEN, "%s: %s%s%s%s%s", remote->name, what, doing ? " while " : "",
            doing ? doing : "", places[place], place ? text : "");
    remote->broken = true;
}

void rt_remote_break(const RtAccel *accel, const char *what, const char *doing) {
    pthread_mutex_lock(&of(accel)->lock);
    set_broken(of(accel), what, doing);
    pthread_mutex_unlock(&of(accel)->lock);
}

static void report_end(Remote *remote, RtProcessEnd end, const char *doing) {
    static const char *const past[] = {"", ": it wrote or read past the memory of its query",
                                       ": it wrote or read past its answers"};
    const uint32_t out_of = remote->shared->crash.out_of;
    char what[160];
    const int signal = remote->shared->crash.signal;
    rt_process_end_format(end, signal, out_of <= 2 ? past[out_of] : "", what, sizeof what);
    note_processes(remote, &end);
    set_broken(remote, what, doing);
}

/* SIGXCPU makes a hung process record its ray. */
static void end_hung(Remote *remote, const char *doing) {
    char what[96];
    remote->shared->crash.traced = 0;
    rt_process_signal(&remote->process, SIGXCPU);
    rt_process_end(&remote->process, 1000);
    snprintf(what, sizeof what, "it made no progress for %g s (RAYTALLY_PLUGIN_SECONDS)", remote->time_limit);
    set_broken(remote, what, doing);
}

/* Whether a structure exceeds the limit as it is built is no fault; later it is. */
static void end_large(Remote *remote, const char *doing, double peak) {
    char what[128];
    rt_process_end(&remote->process, 0);
    snprintf(what, sizeof what, "its process used %.4g MB of memory, more than %.4g MB (--memory),", peak,
             remote->memory_limit);
    set_broken(remote, what, doing);
    if (remote->asked[0] == 1) remote->error.status = RT_BAD_INPUT;
}

/* Ends a process that overwrote shared memory, holds too much memory or hangs. Returns whether the
 * accelerator is broken. */
static bool check_process(Remote *remote, const char *doing, bool overwritten, double waited) {
    pthread_mutex_lock(&remote->lock);
    RtProcessEnd end;
    const double peak = remote->memory_limit < INFINITY ? peak_megabytes(remote) : 0;
    if (!remote->ended) {
        remote->ended = true;
        if (overwritten) {
            rt_process_end(&remote->process, 0);
            set_broken(remote, "it overwrote memory that it shares with raytally", doing);
        } else if (rt_process_wait(&remote->process, 0, &end)) {
            report_end(remote, end, doing);
        } else if (peak > remote->memory_limit) {
            end_large(remote, doing, peak);
        } else if (waited > remote->time_limit) {
            end_hung(remote, doing);
        } else {
            remote->ended = false;
        }
    }
    bool broken = remote->broken;
    pthread_mutex_unlock(&remote->lock);
    return broken;
}

/* ---- requests ---- */

/* Waits for the answer to the last request on a channel. False if none will come: then the accelerator is
 * broken, and its process has ended. Time is counted in pauses: both processes may have been stopped. */
static bool wait_for_answer(Remote *remote, uint32_t number, const char *doing) {
    enum { PAUSE = 50 /* ms */ };
    Channel *channel = &remote->shared->channels[number];
    const unsigned asked = remote->asked[number];
    /* A plugin may take memory in many short requests, too. */
    const bool checked = remote->memory_limit < INFINITY && (number == 0 || asked % 64 == 1);
    unsigned long progress = remote->shared->progress;
    for (double waited = 0;;) {
        const unsigned answered = atomic_load_explicit(&channel->answered, memory_order_acquire);
        const bool overwritten = channel->asked != asked || (answered != asked && answered != asked - 1);
        if (!overwritten && answered == asked) return !checked || !check_process(remote, doing, false, 0);
        if (!overwritten) rt_futex_wait(&channel->answered, answered, PAUSE);
        if (!overwritten && channel->answered != answered) continue;
        waited = progress == remote->shared->progress ? waited + PAUSE / 1000.0 : 0;
        progress = remote->shared->progress;
        if (check_process(remote, doing, overwritten, waited)) return false;
    }
}

static RtStatus fail_broken(const Remote *remote, RtError *error) {
    if (error) *error = remote->error;
    return remote->error.status;
}

/* Takes a failure from the process; RT_BROKEN and invalid ones break the accelerator. The text may lack its
 * end, or be missing. */
static RtStatus forward(Remote *remote, const Channel *channel, RtError *error) {
    const RtStatus status = channel->status;
    RtError why = channel->error;
    why.message[sizeof why.message - 1] = '\0';
    const char *reason = *why.message ? why.message : "it failed and sent no reason";
    if (status <= RT_OK || status > RT_IO || status == RT_BROKEN) {
        rt_remote_break(&remote->base, reason, NULL);
        return fail_broken(remote, error);
    }
    return rt_fail(error, status, "%s%s%s", *why.message ? "" : remote->name, *why.message ? "" : ": ",
                   reason);
}

/* Asks for `work` on the rays in the channel and on a copy of the message, which is copied back if there is
 * an answer. 0 bytes: the message, if any, lies in the channel. */
static RtStatus request(Remote *remote, uint32_t number, RtRemoteWork *work, void *message, size_t bytes,
                        const char *doing, RtError *error) {
    Channel *channel = &remote->shared->channels[number];
    if (remote->broken) return fail_broken(remote, error);
    if (bytes) memcpy(channel->message, message, bytes);
    channel->work = work;
    rt_futex_set(&channel->asked, ++remote->asked[number]);
    if (!wait_for_answer(remote, number, doing)) return fail_broken(remote, error);
    if (bytes) memcpy(message, channel->message, bytes);
    return channel->status == RT_OK ? RT_OK : forward(remote, channel, error);
}

static RtStatus request_master(Remote *remote, RtRemoteWork *work, void *message, size_t bytes,
                               const char *doing, RtError *error) {
    pthread_mutex_lock(&remote->master);
    RtStatus status = request(remote, 0, work, message, bytes, doing, error);
    pthread_mutex_unlock(&remote->master);
    return status;
}

RtStatus rt_remote_do(RtQuery *query, RtRemoteWork *work, const RtRay *rays, size_t count, void *message,
                      size_t bytes, RtError *error) {
    if (!rt_accel_is_remote(query->accel)) return work(query, rays, message, error);
    Remote *remote = of(query->accel);
    const uint32_t number = *(const uint32_t *)query->scratch[0].own;
    if (count) memcpy(remote->shared->channels[number].rays, rays, count * sizeof(RtRay));
    return request(remote, number, work, message, bytes, "it was traced", error);
}

/* ---- building ---- */

static RtStatus start(Remote *remote, RtError *error) {
    int ends[2];
    Shared *shared =
        mmap(NULL, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (shared == MAP_FAILED) return rt_fail_memory(error, "memory shared with a plugin", sizeof(Shared));
    remote->shared = shared;
    if (pipe2(ends, O_CLOEXEC) != 0) return rt_fail(error, RT_IO, "a pipe: %s", strerror(errno));
    remote->before = megabytes(getpid(), "RssAnon");
    RtStatus status = rt_process_fork(&remote->process, ends[0], error);
    if (status == RT_OK && remote->process.pid == 0)
        rt_server_run(shared, &remote->spec, remote->base.scene, remote->threads);
    madvise(shared, sizeof(Shared), MADV_DONTFORK); /* other plugins must not have it */
    close(ends[0]);
    remote->pipe_end = ends[1];
    return status;
}

static RtStatus take_built(Remote *remote, RtError *error) {
    char doing[96];
    Built built = {.seconds = 0};
    snprintf(doing, sizeof doing, "it was built over %u object%s", remote->base.scene->geometry.object_count,
             rt_plural(remote->base.scene->geometry.object_count));
    RT_TRY(request_master(remote, rt_server_build, &built, sizeof built, doing, error));
    /* The process has checked its description; an invalid one here was overwritten. */
    if (!(built.seconds >= 0 && built.seconds < INFINITY) || rt_description_impossible(&built.description)) {
        rt_remote_break(&remote->base, "it overwrote its description", doing);
        return fail_broken(remote, error);
    }
    remote->base.exact = built.exact != 0;
    remote->base.absolute = built.absolute != 0;
    remote->base.counts = built.counts != 0;
    remote->base.build_seconds = built.seconds;
    remote->base.build_tally = built.description.build;
    remote->description = built.description;
    remote->built = megabytes(remote->process.pid, "RssAnon");
    note_build(remote);
    return RT_OK;
}

RtStatus rt_remote_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                         RtError *error) {
    Remote *remote = rt_alloc(1, sizeof(Remote));
    const uint64_t limit = rt_memory_current_limit();
    *out = NULL;
    if (!remote) return rt_fail_memory(error, "an accelerator", sizeof(Remote));
    *remote = (Remote){.base = {.ops = &remote->ops,
                                .scene = scene,
                                .kernels = remote_ops.kernels,
                                .scratch_bytes = remote_ops.kernels->scratch_bytes},
                       .ops = remote_ops,
                       .spec = *spec,
                       .threads = threads,
                       .pipe_end = -1,
                       .memory_limit = limit < UINT64_MAX ? 1e-6 * (double)limit : INFINITY,
                       .time_limit = 10 * time_limit_of_user()};
    const RtSpecLayer *plugin = spec->layers;
    while (!plugin->ops->remote) plugin++;
    remote->ops.name = plugin->ops->name;
    pthread_mutex_init(&remote->lock, NULL);
    pthread_mutex_init(&remote->master, NULL);
    rt_spec_format(spec, remote->name);
    RtStatus status = start(remote, error);
    if (status == RT_OK) status = take_built(remote, error);
    remote->time_limit = time_limit_of_user();
    if (status == RT_OK) {
        *out = &remote->base;
    } else {
        remote->broken = true;
        rt_accel_destroy(&remote->base);
    }
    return status;
}

/* ---- a spec, in this process or in one of its own ---- */

RtStatus rt_accel_build(const RtSpec *spec, const RtScene *scene, int threads, RtAccel **out,
                        RtError *error) {
    return rt_spec_is_remote(spec) ? rt_remote_build(spec, scene, threads, out, error)
                                   : rt_accel_build_here(spec, scene, threads, out, error);
}

RtStatus rt_accel_open_on(const char *spec, const RtScene *scene, int threads, RtAccel **out,
                          RtError *error) {
    RtSpec parsed;
    *out = NULL;
    RT_TRY(rt_spec_parse(spec, &parsed, error));
    return rt_accel_build(&parsed, scene, threads, out, error);
}

RtStatus rt_accel_open(const char *spec, const RtScene *scene, RtAccel **out, RtError *error) {
    return rt_accel_open_on(spec, scene, 0, out, error);
}

/* ---- the end ---- */

static _Thread_local char exit_message[sizeof(((RtError *)0)->message)];

const char *rt_remote_exit_message(void) {
    return *exit_message ? exit_message : NULL;
}

/* A plugin may crash while it frees its memory. */
static void destroy(RtAccel *accel) {
    Remote *remote = of(accel);
    if (remote->process.pid > 0 && !remote->broken) {
        const double kept = megabytes(remote->process.pid, "RssAnon") - remote->built;
        if (remote->built > 0 && kept > 256)
            note(remote, "its process holds %.0f MB more memory after tracing, which must allocate none",
                 kept);
        if (request_master(remote, rt_server_destroy, NULL, 0, "it was destroyed", NULL) == RT_OK)
            note_threads(remote);
        if (remote->broken) snprintf(exit_message, sizeof exit_message, "%s", remote->error.message);
    }
    if (remote->process.pid > 0) {
        RtProcessEnd end;
        rt_process_signal(&remote->process, SIGKILL);
        rt_process_wait(&remote->process, -1, &end);
        note_processes(remote, &end);
    }
    if (remote->pipe_end >= 0) close(remote->pipe_end);
    if (remote->shared) munmap(remote->shared, sizeof(Shared));
    pthread_mutex_destroy(&remote->lock);
    pthread_mutex_destroy(&remote->master);
}

/* ---- queries ---- */

static void release_channel(Remote *remote, uint32_t channel) {
    pthread_mutex_lock(&remote->lock);
    remote->used[channel] = false;
    pthread_mutex_unlock(&remote->lock);
}

static RtStatus open_query(const RtAccel *accel, void *scratch, RtError *error) {
    Remote *remote = of(accel);
    uint32_t channel = 1;
    pthread_mutex_lock(&remote->lock);
    while (channel < CHANNELS && remote->used[channel]) channel++;
    if (channel < CHANNELS) remote->used[channel] = true;
    pthread_mutex_unlock(&remote->lock);
    if (channel == CHANNELS)
        return rt_fail(error, RT_BAD_INPUT, "%s: a plugin traces on at most %d threads", remote->name,
                       CHANNELS - 1);
    *(uint32_t *)scratch = channel;
    RtStatus status =
        request_master(remote, rt_server_open, &channel, sizeof channel, "a query was opened", error);
    if (status != RT_OK) release_channel(remote, channel);
    return status;
}

static void close_query(const RtAccel *accel, void *scratch) {
    const uint32_t channel = *(uint32_t *)scratch;
    request(of(accel), channel, NULL, NULL, 0, "a query was closed", NULL);
    release_channel(of(accel), channel);
}

static void begin(const RtAccel *accel, void *scratch) {
    of(accel)->shared->channels[*(uint32_t *)scratch].begin = true;
}

/* ---- kernels ---- */

/* Each layer may count as much for a ray as a plugin may. */
static void add_tallies(const RtAccel *accel, const RtTally *sent, size_t rays, RtTally *tallies) {
    for (int kind = 0; kind < RT_RAY_KIND_COUNT; kind++) {
        const RtTally counts = sent[kind];
        bool possible = true;
        for (size_t i = 0; i < RT_TALLY_COUNTER_COUNT; i++)
            possible &= rt_count_is_possible(rt_tally_get(&counts, i), rays * RT_MAX_LAYERS);
        if (possible)
            rt_tally_add(&tallies[kind], &counts);
        else
            rt_remote_break(accel, "it overwrote its counts", "it answered a stream");
    }
}

/* Traces at most RT_REMOTE_RAYS rays. One of `hits` and `occluders` is NULL. The process has checked its
 * answers; an invalid one here was overwritten. */
static void trace_part(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, uint32_t count,
                       RtHit *hits, uint32_t *occluders, RtTally *tallies) {
    const uint32_t number = *(uint32_t *)scratch->own;
    Channel *channel = &of(accel)->shared->channels[number];
    Stream *stream = (Stream *)channel->message;
    char doing[64];
    bool possible = true;
    const uint32_t objects = rt_geometry_id_count(&accel->scene->geometry);
    snprintf(doing, sizeof doing, "it answered a stream of %u ray%s", count, rt_plural(count));
    stream->count = count;
    stream->any = occluders != NULL;
    stream->counted = tallies != NULL;
    memset(stream->tallies, 0, sizeof stream->tallies);
    memcpy(channel->rays, rays, count * sizeof(RtRay));
    const bool answered = request(of(accel), number, rt_server_trace, NULL, 0, doing, NULL) == RT_OK;
    if (answered && tallies) add_tallies(accel, stream->tallies, count, tallies);
    for (uint32_t i = 0; i < count && occluders; i++) {
        occluders[i] = answered ? stream->occluders[i] : RT_NO_OBJECT;
        possible &= rt_occluder_is_possible(accel, objects, occluders[i]);
        if (!possible) occluders[i] = RT_NO_OBJECT;
    }
    for (uint32_t i = 0; i < count && hits; i++) {
        hits[i] = answered ? stream->hits[i] : RT_MISS;
        possible &= rt_hit_is_possible(objects, &rays[i], hits[i]);
        if (!possible) hits[i] = RT_MISS;
    }
    if (!possible) rt_remote_break(accel, "it overwrote its answers", "it answered a stream");
}

/* Reports an event that was sent, whatever it holds, to the observer of this thread. */
static void observe_event(Event e) {
    if (e.kind >= RT_TRACED_KIND_COUNT) return;
    for (size_t i = 0; i < sizeof e.what; i++) {
        if (e.what[i] && (e.what[i] < ' ' || e.what[i] > '~')) e.what[i] = '?';
    }
    e.what[sizeof e.what - 1] = '\0';
    const bool boxed = e.boxed && rt_finite(e.box.lo) && rt_finite(e.box.hi);
    rt_observe(&(RtTraced){.kind = (RtTracedKind)e.kind,
                           .what = *e.what ? e.what : NULL,
                           .index = e.index,
                           .box = boxed ? &e.box : NULL,
                           .ball = boxed && e.round ? &e.ball : NULL,
                           .leaf = e.leaf != 0,
                           .empty = e.empty != 0,
                           .met = e.met != 0,
                           .in_tree = e.in_tree != 0,
                           .t = e.t});
}

/* Traces a ray again for its events, as often as it takes to send them, to the observer of this thread. */
static void observe(const RtAccel *accel, const RtScratch *scratch, const RtRay *ray, bool any) {
    const uint32_t number = *(uint32_t *)scratch->own;
    Channel *channel = &of(accel)->shared->channels[number];
    Events *events = (Events *)channel->message;
    uint32_t count = MOST_EVENTS;
    for (uint64_t first = 0; count == MOST_EVENTS && first < UINT32_MAX; first += count) {
        events->first = first;
        events->any = any;
        channel->rays[0] = *ray;
        channel->begin = true;
        if (request(of(accel), number, rt_server_events, NULL, 0, "it traced a ray step by step", NULL) !=
            RT_OK)
            return;
        count = events->count;
        count = count < MOST_EVENTS ? count : MOST_EVENTS;
        for (uint32_t i = 0; i < count; i++) observe_event(events->events[i]);
    }
}

/* The process times itself, so here a timed kernel is a counted one without tallies. */
static void trace(const RtAccel *accel, const RtScratch *scratch, const RtRay *rays, size_t count,
                  RtHit *hits, uint32_t *occluders, RtTally *tallies, bool any, bool counted) {
    for (size_t first = 0; first < count; first += RT_REMOTE_RAYS) {
        const size_t left = count - first, some = left < RT_REMOTE_RAYS ? left : RT_REMOTE_RAYS;
        trace_part(accel, scratch, rays + first, (uint32_t)some, any ? NULL : hits + first,
                   any ? occluders + first : NULL, tallies);
    }
    for (size_t i = 0; counted && i < count && RT_OBSERVED(tallies); i++)
        observe(accel, scratch, &rays[i], any);
}

RT_DEFINE_STREAM_KERNELS(trace, sizeof(uint32_t))

/* ---- the structure ---- */

static void describe(const RtAccel *accel, RtDescription *out) {
    *out = of(accel)->description;
}

static RtStatus check(const RtAccel *accel, RtError *error) {
    return request_master(of(accel), rt_server_check, NULL, 0, "it was checked after tracing", error);
}

/* The accelerator breaks if not all boxes could be shown; rt_accel_check reports it. */
static void each_box(const RtAccel *accel, RtBoxViewer viewer) {
    static const char doing[] = "it showed its boxes";
    Boxes *some = rt_alloc(1, sizeof(Boxes));
    if (!some) rt_remote_break(accel, "there is no memory for all its boxes", doing);
    uint32_t count = MOST_BOXES;
    for (uint64_t first = 0; some && count == MOST_BOXES && first < UINT32_MAX; first += count) {
        some->first = first;
        if (request_master(of(accel), rt_server_boxes, some, sizeof *some, doing, NULL) != RT_OK) break;
        count = some->count < MOST_BOXES ? some->count : MOST_BOXES;
        for (uint32_t i = 0; i < count; i++) {
            const RtBoxView view = {
                .box = &some->boxes[i].box, .depth = some->boxes[i].depth, .leaf = some->boxes[i].leaf != 0};
            if (rt_box_can_be_shown(view.box, view.depth))
                viewer.show(viewer.context, &view);
            else
                rt_remote_break(accel, "it overwrote boxes", doing);
        }
    }
    rt_free(some);
}

static void ignore(void *context, const RtBoxView *view) {
    (void)context, (void)view;
}

/* The process checks the boxes as it shows them. */
static RtStatus validate(const RtAccel *accel, RtError *error) {
    RT_TRY(request_master(of(accel), rt_server_validate, NULL, 0, "it was validated", error));
    each_box(accel, (RtBoxViewer){ignore, NULL});
    return check(accel, error);
}

static const RtAccelOps remote_ops = {
    .name = "plugin",
    .summary = "represents an accelerator in another process",
    .paper = "",
    .destroy = destroy,
    .kernels = &kernels,
    .open = open_query,
    .close = close_query,
    .begin = begin,
    .describe = describe,
    .validate = validate,
    .each_box = each_box,
    .check = check,
};
