/* SPDX-License-Identifier: Apache-2.0 */
/* Memory: one allocator for everything, so that a test can count allocations and make the nth one fail.
 * Blocks are 64-byte aligned (a cache line, an AVX-512 register). Nothing is allocated while tracing. */
#ifndef RT_BASE_MEMORY_H
#define RT_BASE_MEMORY_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define RT_CACHE_LINE 64

/* Allocates `count` elements of `size` bytes, set to zero; NULL if count * size overflows or memory is
 * short. A count of 0 returns a valid block. Large blocks use large pages where the system has them. Free
 * with rt_free. */
void *rt_alloc(size_t count, size_t size);

/* The same without initialisation: for large arrays, so that the threads which fill them touch them first. */
void *rt_alloc_unset(size_t count, size_t size);

/* Frees a block of rt_alloc or rt_alloc_unset; NULL is allowed. */
void rt_free(void *block);

/* Gives the large pages in [from, to), a part of a block, back to the system: their contents are lost.
 * Returns the end of the last one, or `from`. */
const char *rt_discard(const char *from, const char *to);

/* Blocks that fail and are freed together: a build's, a command's, or one function's. Starts as {0}; used by
 * one thread at a time. So that nobody asks after each block, an allocation that fails is remembered:
 * rt_arena_check, once before the first use of any block, reports it. */
typedef struct RtArena {
    void **blocks; /* [capacity], of which [0, count) are in use */
    uint32_t count, capacity;
    bool failed;
    size_t failed_bytes; /* of the first block that failed; 0: unknown */
} RtArena;

/* A variable, {0}, and an arena that `clear`, given the address, frees when the scope ends. */
#define RT_OWNED(Type, name, clear) __attribute__((cleanup(clear))) Type name = {0}
#define RT_ARENA(name)              RT_OWNED(RtArena, name, rt_arena_clear)

/* As rt_alloc and rt_alloc_unset, but the arena owns the block. NULL after a failure, also of an earlier
 * block. */
void *rt_arena_alloc(RtArena *arena, size_t count, size_t size);
void *rt_arena_alloc_unset(RtArena *arena, size_t count, size_t size);

/* RT_NO_MEMORY if a block since {0} failed; `what` names their use: "the lists of a grid". */
RtStatus rt_arena_check(const RtArena *arena, const char *what, RtError *error);

/* Frees one block before the others, to keep the peak low; NULL is allowed. The latest blocks are found
 * first. */
void rt_arena_free(RtArena *arena, void *block);

/* Frees all blocks; the arena is {0} again. */
void rt_arena_clear(RtArena *arena);

/* Grows an array to at least `needed` elements. `array` is the address of a pointer (of any type) to
 * `*capacity` elements of `size` bytes, or of NULL. Contents are kept; new elements are not initialised.
 * On failure nothing changes. */
RtStatus rt_reserve(void *array, uint32_t *capacity, uint64_t needed, size_t size, RtError *error);

/* Appends a copy of `element`, of `size` bytes, to a growing array of `*count` elements; otherwise like
 * rt_reserve. `element` must not lie in the array. */
static inline RtStatus rt_append(void *array, uint32_t *count, uint32_t *capacity, const void *element,
                                 size_t size, RtError *error) {
    char *elements;
    if (*count == *capacity) RT_TRY(rt_reserve(array, capacity, (uint64_t)*count + 1, size, error));
    memcpy(&elements, array, sizeof elements);
    memcpy(elements + (*count)++ * size, element, size);
    return RT_OK;
}

/* Shrinks such an array, of `count` elements, to its contents if much of it is unused. Leaves it as it is if
 * there is not enough memory for a copy. */
void rt_trim(void *array, uint32_t count, uint32_t *capacity, size_t size);

/* Bytes of memory in this machine, or that its control groups (a container, a job of Slurm) may use. */
uint64_t rt_memory_size(void);

/* The least limit of the control groups that the file `groups` lists (/proc/self/cgroup), of version 1 or 2,
 * whose file systems are in the folder `mounted`; UINT64_MAX without one. */
uint64_t rt_memory_of_groups(const char *groups, const char *mounted);

/* Limits further allocation to `bytes` more than now; 0 removes the limit. Memory of other libraries does
 * not count. */
void rt_memory_limit(uint64_t bytes);

/* Removes the limit and returns `status`. If it was reached, the message of RT_NO_MEMORY becomes the limit:
 * which allocation failed may depend on the number of threads. */
RtStatus rt_memory_unlimit(RtStatus status, RtError *error);

/* Whether an allocation since the last rt_memory_limit failed because of a limit. */
bool rt_memory_limit_was_reached(void);

/* The limit as it was given; UINT64_MAX without one. */
uint64_t rt_memory_current_limit(void);

/* The same for all memory that this process allocates here, beside the limit above. */
void rt_memory_limit_process(uint64_t bytes);
RtStatus rt_memory_unlimit_process(RtStatus status, RtError *error);

/* For tests: the allocation `n` calls from now fails (1 = the next); 0 switches this off. */
void rt_alloc_fail_at(uint64_t n);

/* Blocks allocated and not yet freed; tests assert that it returns to its earlier value. */
int64_t rt_alloc_live(void);

#endif
