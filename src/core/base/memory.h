/* SPDX-License-Identifier: Apache-2.0 */
/* Memory: one allocator for everything, so that a test can count allocations and make the nth one fail.
 * Blocks are 64-byte aligned (a cache line, an AVX-512 register). No allocation happens while tracing. */
#ifndef RT_BASE_MEMORY_H
#define RT_BASE_MEMORY_H

#include "core/base/status.h"

#include <stddef.h>
#include <stdint.h>

#define RT_CACHE_LINE 64

/* `count` elements of `size` bytes, set to zero; NULL where count * size overflows or memory is short. A
 * count of 0 gives a valid block that may be freed. Free with rt_free. */
void *rt_alloc(size_t count, size_t size);

/* The same, but nothing is set: for large arrays that are filled anyway, so that the threads that fill them
 * touch them first. Large blocks are of large pages where the system gives them. */
void *rt_alloc_unset(size_t count, size_t size);

/* Frees a block of rt_alloc or rt_alloc_unset; NULL is allowed. */
void rt_free(void *block);

/* Makes room for `needed` elements in a growing array. `array` is the address of a pointer, of any type, to
 * `*capacity` elements of `size` bytes each (or of NULL); the block is replaced by a larger one with the same
 * contents; nothing beyond them is set. On failure nothing changes. */
RtStatus rt_reserve(void *array, uint32_t *capacity, uint64_t needed, size_t size, RtError *error);

/* Bytes of memory in this machine. */
uint64_t rt_memory_size(void);

/* From now on at most `bytes` more are handed out than are now; 0: as many as there are. What other libraries
 * allocate is not counted. */
void rt_memory_limit(uint64_t bytes);

/* For tests: the allocation `n` calls from now fails (1 = the next); 0 switches this off. */
void rt_alloc_fail_at(uint64_t n);

/* Blocks handed out and not yet freed; a test asserts that it returns to where it was. */
int64_t rt_alloc_live(void);

#endif
