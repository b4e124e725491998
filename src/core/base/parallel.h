/* SPDX-License-Identifier: Apache-2.0 */
/* Work in parallel: numbered items handed out to threads in no fixed order. Results stay deterministic
 * because each item writes only to its own place. */
#ifndef RT_BASE_PARALLEL_H
#define RT_BASE_PARALLEL_H

#include "core/base/status.h"

#include <stdbool.h>
#include <stddef.h>

/* Processors this process may run on, at least 1. */
int rt_processor_count(void);

/* Calls work(context, item, thread) for each item 0..items-1 on `threads` threads (0 = all processors,
 * never more than items), of which the caller is one; thread is 0..threads-1. A status other than RT_OK
 * stops the distribution; the status and message of the lowest failed item are returned. */
typedef RtStatus (*RtWork)(void *context, size_t item, int thread, RtError *error);
RtStatus rt_parallel_for(size_t items, int threads, RtWork work, void *context, RtError *error);

/* The same for work that cannot fail: only starting the threads can. */
typedef void (*RtSureWork)(void *context, size_t item);
RtStatus rt_parallel_each(size_t items, int threads, RtSureWork work, void *context, RtError *error);

/* Tasks that create tasks: values of one size, RT_MAX_TASK_BYTES at most, processed oldest first. */
#define RT_MAX_TASK_BYTES 64
typedef struct RtTasks RtTasks;
typedef RtStatus (*RtTaskWork)(void *context, RtTasks *tasks, const void *task, RtError *error);

/* Calls work(context, tasks, task) for each of the `count` values of `size` bytes at `first`, and for each
 * task added meanwhile, on `threads` threads (0 = all processors), the caller among them. A status other
 * than RT_OK stops the distribution; the first failure is returned with its message. */
RtStatus rt_parallel_tasks(const void *first, size_t count, size_t size, int threads, RtTaskWork work,
                           void *context, RtError *error);

/* Adds a copy of a task, from within `work`. Returns false, adding nothing, if memory is short. */
bool rt_tasks_add(RtTasks *tasks, const void *task);

/* The threads that rt_parallel_for uses at most for `threads` (0 = all processors). */
int rt_thread_count(int threads);

#endif
