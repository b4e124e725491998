/* SPDX-License-Identifier: Apache-2.0 */
/* Work in parallel: numbered items handed out to threads, in no fixed order. Results stay deterministic
 * because an item writes only to its own place. */
#ifndef RT_BASE_PARALLEL_H
#define RT_BASE_PARALLEL_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/* Processors this process may run on, at least 1. */
int rt_processor_count(void);

/* Calls work(context, item, thread) for each item in 0..items-1, on `threads` threads (0 = all processors),
 * but no more than there are items; the caller is one of them. thread is 0..threads-1. A status other than
 * RT_OK stops the handing out; the status and message of the lowest item that failed are returned. */
typedef RtStatus (*RtWork)(void *context, size_t item, int thread, RtError *error);
RtStatus rt_parallel_for(size_t items, int threads, RtWork work, void *context, RtError *error);

/* The same for work that cannot fail: only starting the threads can. */
typedef void (*RtSureWork)(void *context, size_t item);
RtStatus rt_parallel_each(size_t items, int threads, RtSureWork work, void *context, RtError *error);

/* Tasks that make tasks: values of one size, handed out oldest first. */
typedef struct RtTasks RtTasks;
typedef RtStatus (*RtTaskWork)(void *context, RtTasks *tasks, const void *task, RtError *error);

/* Calls work(context, tasks, task) for each of the `count` values of `size` bytes at `first`, and for each
 * that is added meanwhile, on `threads` threads (0 = all processors), the caller among them, until none is
 * left. A status other than RT_OK stops the handing out; that of the first failure is returned, with its
 * message. */
RtStatus rt_parallel_tasks(const void *first, size_t count, size_t size, int threads, RtTaskWork work,
                           void *context, RtError *error);

/* Adds a copy of a task, from within `work`. False, and nothing is added, where memory is short. */
bool rt_tasks_add(RtTasks *tasks, const void *task);

/* The number of threads that rt_parallel_for uses at most for `threads` (0 = all processors). */
int rt_thread_count(int threads);

#endif
