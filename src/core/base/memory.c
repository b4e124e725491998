/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/memory.h"

#include <inttypes.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

static _Atomic uint64_t fail_countdown;
static _Atomic int64_t live_blocks, live_bytes;

typedef struct Limit {
    _Atomic int64_t most; /* live bytes */
    uint64_t given;       /* UINT64_MAX: none */
    atomic_bool reached;
} Limit;
static atomic_bool was_reached; /* any limit, since the last rt_memory_limit */
static Limit limit_now = {.most = INT64_MAX, .given = UINT64_MAX},
             limit_of_process = {.most = INT64_MAX, .given = UINT64_MAX};

static bool fails_on_purpose(void) {
    uint64_t left = atomic_load(&fail_countdown);
    while (left > 0) {
        if (atomic_compare_exchange_weak(&fail_countdown, &left, left - 1)) return left == 1;
    }
    return false;
}

static bool exceeds(Limit *limit, int64_t bytes) {
    if (bytes <= atomic_load(&limit->most)) return false;
    atomic_store(&limit->reached, true);
    atomic_store(&was_reached, true);
    return true;
}

/* Blocks of LARGE_BLOCK bytes or more use pages of this size. */
enum { LARGE_PAGE = 1 << 21, LARGE_BLOCK = 2 * LARGE_PAGE };

/* *padded becomes the size, rounded up to the next cache line or page. */
static void *allocate(size_t count, size_t size, size_t *padded) {
    const bool large = size != 0 && count >= LARGE_BLOCK / size;
    const size_t boundary = large ? LARGE_PAGE : RT_CACHE_LINE;
    if (size != 0 && count > (SIZE_MAX - boundary) / size) return NULL;
    if (fails_on_purpose()) return NULL;
    *padded = (count * size + boundary) / boundary * boundary;
    if (*padded > (uint64_t)INT64_MAX / 2) return NULL;
    const int64_t bytes = atomic_load(&live_bytes) + (int64_t)*padded;
    if (exceeds(&limit_now, bytes) || exceeds(&limit_of_process, bytes)) return NULL;
    void *block = aligned_alloc(boundary, *padded);
    if (!block) return NULL;
    atomic_fetch_add(&live_blocks, 1);
    atomic_fetch_add(&live_bytes, (int64_t)malloc_usable_size(block));
    if (large) madvise(block, *padded, MADV_HUGEPAGE); /* a hint: it may fail */
    return block;
}

void *rt_alloc(size_t count, size_t size) {
    size_t padded;
    void *block = allocate(count, size, &padded);
    if (block) memset(block, 0, padded);
    return block;
}

void *rt_alloc_unset(size_t count, size_t size) {
    size_t padded;
    return allocate(count, size, &padded);
}

void rt_free(void *block) {
    if (!block) return;
    atomic_fetch_sub(&live_blocks, 1);
    atomic_fetch_sub(&live_bytes, (int64_t)malloc_usable_size(block));
    free(block);
}

const char *rt_discard(const char *from, const char *to) {
    const size_t skipped = -(uintptr_t)from % LARGE_PAGE;
    if ((size_t)(to - from) < skipped + LARGE_PAGE) return from;
    const size_t bytes = ((size_t)(to - from) - skipped) / LARGE_PAGE * LARGE_PAGE;
    madvise((char *)from + skipped, bytes, MADV_DONTNEED); /* a hint: it may fail */
    return from + skipped + bytes;
}

static void set_limit(Limit *limit, uint64_t bytes, int64_t before) {
    const bool none = bytes == 0 || bytes > (uint64_t)INT64_MAX / 2;
    limit->given = bytes ? bytes : UINT64_MAX;
    atomic_store(&limit->reached, false);
    atomic_store(&limit->most, none ? INT64_MAX : before + (int64_t)bytes);
}

/* Removes the limit, and reports it if it was reached. */
static RtStatus unlimit(Limit *limit, const char *origin, RtStatus status, const char *why, RtError *error) {
    const uint64_t given = limit->given;
    const bool reached = atomic_load(&limit->reached);
    set_limit(limit, 0, 0);
    if (status != RT_NO_MEMORY || !reached) return status;
    return rt_fail(error, status, "it needs more than %.4g MB of memory (%s)%s%s", 1e-6 * (double)given,
                   origin, *why ? ": " : "", why);
}

void rt_memory_limit(uint64_t bytes) {
    atomic_store(&was_reached, false);
    set_limit(&limit_now, bytes, atomic_load(&live_bytes));
}

RtStatus rt_memory_unlimit(RtStatus status, RtError *error) {
    return unlimit(&limit_now, "--memory", status, "", error);
}

bool rt_memory_limit_was_reached(void) {
    return atomic_load(&was_reached);
}

uint64_t rt_memory_current_limit(void) {
    return limit_now.given;
}

void rt_memory_limit_process(uint64_t bytes) {
    set_limit(&limit_of_process, bytes, 0);
}

RtStatus rt_memory_unlimit_process(RtStatus status, RtError *error) {
    const RtError why = error ? *error : (RtError){0};
    return unlimit(&limit_of_process, "that of --memory, or of this machine or container", status,
                   why.message, error);
}

/* Moves `kept` elements of an array to a new block of `room` elements, in pieces that are given back at once
 * to keep the peak low; false if there is no memory for it. The caller's pointer is no char pointer, so it is
 * read and written as bytes. */
static bool move(void *array, uint32_t kept, uint32_t room, size_t size) {
    const size_t bytes = kept * size;
    char *old, *block = rt_alloc_unset(room, size);
    if (!block) return false;
    memcpy(&old, array, sizeof old);
    for (size_t done = 0, piece; done < bytes; done += piece) {
        piece = bytes - done < LARGE_BLOCK ? bytes - done : LARGE_BLOCK;
        memcpy(block + done, old + done, piece);
        rt_discard(old + done, old + done + piece);
    }
    rt_free(old);
    memcpy(array, &block, sizeof block);
    return true;
}

RtStatus rt_reserve(void *array, uint32_t *capacity, uint64_t needed, size_t size, RtError *error) {
    if (needed <= *capacity) return RT_OK;
    if (needed > UINT32_MAX)
        return rt_fail(error, RT_BAD_INPUT, "more than %u elements are needed: split the scene", UINT32_MAX);
    uint64_t grown = (uint64_t)*capacity * 2;
    if (grown < needed) grown = needed;
    if (grown < 16) grown = 16;
    if (grown > UINT32_MAX) grown = UINT32_MAX;
    if (move(array, *capacity, (uint32_t)grown, size)) {
        *capacity = (uint32_t)grown;
        return RT_OK;
    }
    return rt_fail_memory(error, "a growing array", (size_t)grown * size);
}

void rt_trim(void *array, uint32_t count, uint32_t *capacity, size_t size) {
    enum { MUCH = 1 << 16 }; /* bytes */
    const bool trims = (size_t)(*capacity - count) * size >= MUCH;
    if (trims && move(array, count, count, size)) *capacity = count;
}

/* Takes over `block`, of count * size bytes; NULL is a failure. */
static void *keep(RtArena *arena, void *block, size_t count, size_t size) {
    if (block &&
        rt_append(&arena->blocks, &arena->count, &arena->capacity, &block, sizeof block, NULL) == RT_OK)
        return block;
    rt_free(block);
    arena->failed = true;
    arena->failed_bytes = size != 0 && count > SIZE_MAX / size ? 0 : count * size;
    return NULL;
}

void *rt_arena_alloc(RtArena *arena, size_t count, size_t size) {
    return arena->failed ? NULL : keep(arena, rt_alloc(count, size), count, size);
}

void *rt_arena_alloc_unset(RtArena *arena, size_t count, size_t size) {
    return arena->failed ? NULL : keep(arena, rt_alloc_unset(count, size), count, size);
}

RtStatus rt_arena_check(const RtArena *arena, const char *what, RtError *error) {
    return arena->failed ? rt_fail_memory(error, what, arena->failed_bytes) : RT_OK;
}

void rt_arena_free(RtArena *arena, void *block) {
    for (uint32_t i = arena->count; block && i-- > 0;) {
        if (arena->blocks[i] != block) continue;
        arena->blocks[i] = arena->blocks[--arena->count];
        rt_free(block);
        return;
    }
}

void rt_arena_clear(RtArena *arena) {
    for (uint32_t i = 0; i < arena->count; i++) rt_free(arena->blocks[i]);
    rt_free(arena->blocks);
    *arena = (RtArena){0};
}

/* Lines are "0::/GROUP" (version 2) or "NUMBER:CONTROLLER,...:/GROUP". All groups around one limit it. */
uint64_t rt_memory_of_groups(const char *groups, const char *mounted) {
    char line[4096], path[sizeof line + 4096];
    uint64_t least = UINT64_MAX;
    FILE *file = fopen(groups, "re");
    while (file && fgets(line, sizeof line, file)) {
        char *controllers = strchr(line, ':'), *group = controllers ? strchr(controllers + 1, ':') : NULL;
        if (!group) continue;
        *group++ = '\0';
        group[strcspn(group, "\n")] = '\0';
        const bool second = controllers[1] == '\0';
        if (!second && !strstr(controllers, "memory")) continue;
        for (bool more = true; more;) {
            snprintf(path, sizeof path, second ? "%s%s/memory.max" : "%s/memory%s/memory.limit_in_bytes",
                     mounted, group);
            uint64_t limit;
            FILE *limits = fopen(path, "re"); /* it may say "max" */
            if (limits && fscanf(limits, "%" SCNu64, &limit) == 1 && limit < least) least = limit;
            if (limits) fclose(limits);
            char *last = strrchr(group, '/');
            more = last != NULL;
            if (more) *last = '\0';
        }
    }
    if (file) fclose(file);
    return least;
}

uint64_t rt_memory_size(void) {
    const uint64_t machine = (uint64_t)sysconf(_SC_PHYS_PAGES) * (uint64_t)sysconf(_SC_PAGESIZE);
    const uint64_t container = rt_memory_of_groups("/proc/self/cgroup", "/sys/fs/cgroup");
    return container < machine ? container : machine;
}

void rt_alloc_fail_at(uint64_t n) {
    atomic_store(&fail_countdown, n);
}

int64_t rt_alloc_live(void) {
    return atomic_load(&live_blocks);
}
