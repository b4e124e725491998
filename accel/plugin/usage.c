/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/plugin/usage.h"

#include "accel/remote.h"
#include "core/base/memory.h"
#include "core/base/words.h"

#include <dirent.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define MEGABYTE UINT64_C(1000000)

/* ---- notices ---- */

typedef enum Kind { HELD, PEAK, TRACED, THREADS, PROCESSES } Kind;

enum { MOST_NOTICES = 64 };
static struct Notice {
    char name[sizeof(((RtUsage *)0)->name)];
    Kind kind;
    char text[512];
} notices[MOST_NOTICES];
static size_t notice_count;
static pthread_mutex_t lock = PTHREAD_MUTEX_INITIALIZER;

const char *rt_remote_notice(size_t i) {
    pthread_mutex_lock(&lock);
    const char *text = i < notice_count ? notices[i].text : NULL;
    pthread_mutex_unlock(&lock);
    return text;
}

/* The first of each kind is kept. */
__attribute__((format(printf, 3, 4))) static void note(const RtUsage *usage, Kind kind, const char *what,
                                                       ...) {
    va_list arguments;
    pthread_mutex_lock(&lock);
    size_t i = 0;
    while (i < notice_count && (notices[i].kind != kind || strcmp(notices[i].name, usage->name) != 0)) i++;
    if (i == notice_count && i < MOST_NOTICES) {
        struct Notice *notice = &notices[notice_count++];
        *notice = (struct Notice){.kind = kind};
        strcpy(notice->name, usage->name);
        size_t length = (size_t)snprintf(notice->text, sizeof notice->text, "%s: ", usage->name);
        va_start(arguments, what);
        vsnprintf(notice->text + length, sizeof notice->text - length, what, arguments);
        va_end(arguments);
    }
    pthread_mutex_unlock(&lock);
}

/* ---- memory ---- */

/* Bytes of an entry of /proc/PID/status in kB, "RssAnon"; 0 if it is unknown. */
static uint64_t read_status(pid_t pid, const char *entry) {
    char path[64], line[256];
    uint64_t kilobytes = 0;
    const size_t length = strlen(entry);
    snprintf(path, sizeof path, "/proc/%d/status", (int)pid);
    FILE *file = fopen(path, "re");
    while (file && fgets(line, sizeof line, file)) {
        if (strncmp(line, entry, length) == 0 && line[length] == ':')
            kilobytes = strtoull(line + length + 1, NULL, 10);
    }
    if (file) fclose(file);
    return kilobytes * 1024;
}

static uint64_t more_than(uint64_t now, uint64_t before) {
    return now > before ? now - before : 0;
}

static double megabytes(uint64_t bytes) {
    return (double)bytes / (double)MEGABYTE;
}

/* The process begins with a copy of raytally's memory. */
void rt_usage_begin(RtUsage *usage, const char *name) {
    *usage = (RtUsage){.before = read_status(getpid(), "RssAnon"), .limit = rt_memory_current_limit()};
    snprintf(usage->name, sizeof usage->name, "%s", name);
}

static uint64_t peak(const RtUsage *usage, const RtProcess *process) {
    const uint64_t libraries = read_status(process->pid, "RssFile");
    return more_than(read_status(process->pid, "VmHWM"), usage->before + libraries);
}

bool rt_usage_exceeds_limit(const RtUsage *usage, const RtProcess *process, uint64_t *most) {
    if (usage->limit == UINT64_MAX) return false;
    *most = peak(usage, process);
    return *most > usage->limit;
}

/* Limits are wide: arenas of the C library, and large pages for the stacks of threads, are memory, too. */
void rt_usage_built(RtUsage *usage, const RtProcess *process, uint64_t bytes) {
    usage->built = read_status(process->pid, "RssAnon");
    const uint64_t held = more_than(usage->built, usage->before);
    const uint64_t most = peak(usage, process);
    if (held > 256 * MEGABYTE + 4 * bytes)
        note(
            usage, HELD,
            "its process holds %.0f MB of memory once it is built, and its `describe` says %.3g MB: the rest "
            "is not described, or never freed",
            megabytes(held), megabytes(bytes));
    else if (most > 1024 * MEGABYTE + 16 * bytes)
        note(usage, PEAK, "its build takes up to %.0f MB of memory, for a structure of %.3g MB",
             megabytes(most), megabytes(bytes));
}

void rt_usage_traced(const RtUsage *usage, const RtProcess *process) {
    const uint64_t kept = more_than(read_status(process->pid, "RssAnon"), usage->built);
    if (usage->built > 0 && kept > 256 * MEGABYTE)
        note(usage, TRACED, "its process holds %.0f MB more memory after tracing, which must allocate none",
             megabytes(kept));
}

/* ---- threads and processes ---- */

/* The number of threads of a process; *running gets how many of them do not sleep. */
static uint32_t count_threads(pid_t pid, uint32_t *running) {
    char path[64], line[512];
    uint32_t count = 0;
    const struct dirent *entry;
    *running = 0;
    snprintf(path, sizeof path, "/proc/%d/task", (int)pid);
    DIR *threads = opendir(path);
    while (threads && (entry = readdir(threads))) {
        if (*entry->d_name == '.') continue;
        snprintf(path, sizeof path, "/proc/%d/task/%.10s/stat", (int)pid, entry->d_name);
        FILE *file = fopen(path, "re");
        const char *name_end = file && fgets(line, sizeof line, file) ? strrchr(line, ')') : NULL;
        *running += name_end && strncmp(name_end, ") R", 3) == 0;
        if (file) fclose(file);
        count++;
    }
    if (threads) closedir(threads);
    return count;
}

/* Threads that sleep, such as those of a pool, disturb nothing, and are not reported. raytally's own two
 * threads sleep; those of queries may still be ending. */
void rt_usage_destroyed(const RtUsage *usage, const RtProcess *process) {
    enum { OWN_THREADS = 2, PAUSES = 3 };
    uint32_t least = UINT32_MAX, running;
    for (int i = 0; i < PAUSES && least > 0; i++) {
        if (count_threads(process->pid, &running) <= OWN_THREADS) return;
        if (running < least) least = running;
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    if (least > 0)
        note(usage, THREADS,
             "it left %u thread%s behind, still running after `destroy`, which may have slowed down what was "
             "measured; raytally ended %s",
             least, rt_plural(least), least == 1 ? "it" : "them");
}

void rt_usage_ended(const RtUsage *usage, const RtProcessEnd *end) {
    if (end->left > 0)
        note(usage, PROCESSES, "it left %u process%s behind (%s), which raytally ended", end->left,
             end->left == 1 ? "" : "es", end->left_name);
}
