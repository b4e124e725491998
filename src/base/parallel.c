/* SPDX-License-Identifier: Apache-2.0 */
#include "base/parallel.h"

#include "base/memory.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdbool.h>

typedef struct Pool {
    RtWork work;
    void *context;
    size_t items;
    atomic_size_t next;
    atomic_bool stop;
    pthread_mutex_t lock; /* guards the three below */
    size_t failed_item;
    RtStatus status;
    RtError error;
} Pool;

typedef struct Worker {
    Pool *pool;
    int thread;
} Worker;

int rt_processor_count(void) {
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) != 0) return 1;
    int count = CPU_COUNT(&set);
    return count > 0 ? count : 1;
}

int rt_thread_count(int threads) {
    return threads > 0 ? threads : rt_processor_count();
}

static void record_failure(Pool *pool, size_t item, RtStatus status, const RtError *error) {
    pthread_mutex_lock(&pool->lock);
    if (pool->status == RT_OK || item < pool->failed_item) {
        pool->failed_item = item;
        pool->status = status;
        pool->error = *error;
    }
    pthread_mutex_unlock(&pool->lock);
    atomic_store(&pool->stop, true);
}

static void *run_worker(void *argument) {
    Worker *worker = argument;
    Pool *pool = worker->pool;
    while (!atomic_load(&pool->stop)) {
        size_t item = atomic_fetch_add(&pool->next, 1);
        if (item >= pool->items) break;
        RtError error = {RT_OK, ""};
        RtStatus status = pool->work(pool->context, item, worker->thread, &error);
        if (status != RT_OK) record_failure(pool, item, status, &error);
    }
    return NULL;
}

RtStatus rt_parallel_for(size_t items, int threads, RtWork work, void *context, RtError *error) {
    int count = rt_thread_count(threads);
    if ((size_t)count > items) count = items > 0 ? (int)items : 1;
    Pool pool = {.work = work, .context = context, .items = items, .status = RT_OK};
    Worker *workers = rt_alloc((size_t)count, sizeof(Worker));
    pthread_t *handles = rt_alloc((size_t)count, sizeof(pthread_t));
    if (!workers || !handles) {
        rt_free(workers);
        rt_free(handles);
        return rt_fail_memory(error, "worker threads", (size_t)count * (sizeof(Worker) + sizeof(pthread_t)));
    }
    pthread_mutex_init(&pool.lock, NULL);
    /* Threads that cannot be had are done without: the caller takes their items. */
    int started = 1;
    for (int i = 0; i < count; i++) workers[i] = (Worker){&pool, i};
    while (started < count && pthread_create(&handles[started], NULL, run_worker, &workers[started]) == 0) {
        started++;
    }
    run_worker(&workers[0]);
    for (int i = 1; i < started; i++) pthread_join(handles[i], NULL);
    pthread_mutex_destroy(&pool.lock);
    rt_free(workers);
    rt_free(handles);
    if (pool.status != RT_OK && error) *error = pool.error;
    return pool.status;
}
