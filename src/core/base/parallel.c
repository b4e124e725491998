/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/parallel.h"

#include "core/base/memory.h"

#include <assert.h>
#include <locale.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <string.h>

typedef struct Pool {
    RtWork work;     /* or */
    RtSureWork sure; /* which cannot fail */
    void *context;
    size_t items;
    atomic_size_t next;
    atomic_bool stop;
    pthread_mutex_t lock; /* guards the three below */
    size_t failed_item;
    RtStatus status;
    RtError error;
} Pool;

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

/* A new thread. */
typedef struct Thread {
    pthread_t handle;
    void (*run)(void *shared, int thread);
    void *shared;
    int number;
    locale_t locale; /* of the starting thread: numbers are printed alike on all threads */
} Thread;

static void *start(void *argument) {
    const Thread *thread = argument;
    uselocale(thread->locale);
    thread->run(thread->shared, thread->number);
    return NULL;
}

/* Calls run(shared, i) for i < count, each on its own thread; 0 is the calling thread. If a thread cannot be
 * created, the others take its work. */
static RtStatus run_all(void (*run)(void *shared, int thread), void *shared, int count, RtError *error) {
    Thread *threads = rt_alloc((size_t)count, sizeof(Thread));
    if (!threads) return rt_fail_memory(error, "worker threads", (size_t)count * sizeof(Thread));
    const locale_t locale = uselocale((locale_t)0);
    int started = 1;
    for (; started < count; started++) {
        Thread *next = &threads[started];
        *next = (Thread){.run = run, .shared = shared, .number = started, .locale = locale};
        if (pthread_create(&next->handle, NULL, start, next) != 0) break;
    }
    run(shared, 0);
    for (int i = 1; i < started; i++) pthread_join(threads[i].handle, NULL);
    rt_free(threads);
    return RT_OK;
}

static void run_items(void *shared, int thread) {
    Pool *pool = shared;
    while (!atomic_load(&pool->stop)) {
        size_t item = atomic_fetch_add(&pool->next, 1);
        if (item >= pool->items) break;
        RtError error = {RT_OK, ""};
        RtStatus status = RT_OK;
        if (pool->sure)
            pool->sure(pool->context, item);
        else
            status = pool->work(pool->context, item, thread, &error);
        if (status != RT_OK) record_failure(pool, item, status, &error);
    }
}

static RtStatus run_pool(Pool *pool, int threads, RtError *error) {
    int count = rt_thread_count(threads);
    if ((size_t)count > pool->items) count = pool->items > 0 ? (int)pool->items : 1;
    pthread_mutex_init(&pool->lock, NULL);
    RtStatus status = run_all(run_items, pool, count, error);
    pthread_mutex_destroy(&pool->lock);
    if (status != RT_OK) return status;
    if (pool->status != RT_OK && error) *error = pool->error;
    return pool->status;
}

RtStatus rt_parallel_for(size_t items, int threads, RtWork work, void *context, RtError *error) {
    return run_pool(&(Pool){.work = work, .context = context, .items = items}, threads, error);
}

RtStatus rt_parallel_each(size_t items, int threads, RtSureWork work, void *context, RtError *error) {
    return run_pool(&(Pool){.sure = work, .context = context, .items = items}, threads, error);
}

/* ---- tasks that create tasks ---- */

struct RtTasks {
    RtTaskWork work;
    void *context;
    size_t size;
    pthread_mutex_t lock; /* guards all below */
    pthread_cond_t changed;
    char *waiting; /* [end] values; those before `begin` were handed out */
    uint32_t begin, end, capacity;
    int running;
    RtStatus status;
    RtError error;
};

static RtStatus add_task(RtTasks *tasks, const void *task, RtError *error) {
    return rt_append(&tasks->waiting, &tasks->end, &tasks->capacity, task, tasks->size, error);
}

bool rt_tasks_add(RtTasks *tasks, const void *task) {
    pthread_mutex_lock(&tasks->lock);
    bool added = add_task(tasks, task, NULL) == RT_OK;
    pthread_cond_signal(&tasks->changed);
    pthread_mutex_unlock(&tasks->lock);
    return added;
}

/* Takes the oldest task, waiting for one if necessary; false when no more can come. */
static bool take_task(RtTasks *tasks, void *task) {
    while (tasks->status == RT_OK && tasks->begin == tasks->end && tasks->running > 0)
        pthread_cond_wait(&tasks->changed, &tasks->lock);
    if (tasks->status != RT_OK || tasks->begin == tasks->end) return false;
    memcpy(task, tasks->waiting + tasks->begin++ * tasks->size, tasks->size);
    tasks->running++;
    return true;
}

static void run_tasks(void *shared, int thread) {
    RtTasks *tasks = shared;
    _Alignas(RT_CACHE_LINE) char task[RT_MAX_TASK_BYTES]; /* a copy: adding a task may move the array */
    (void)thread;
    pthread_mutex_lock(&tasks->lock);
    while (take_task(tasks, task)) {
        RtError error = {RT_OK, ""};
        pthread_mutex_unlock(&tasks->lock);
        RtStatus status = tasks->work(tasks->context, tasks, task, &error);
        pthread_mutex_lock(&tasks->lock);
        tasks->running--;
        if (status != RT_OK && tasks->status == RT_OK) {
            tasks->status = status;
            tasks->error = error;
        }
    }
    pthread_cond_broadcast(&tasks->changed);
    pthread_mutex_unlock(&tasks->lock);
}

RtStatus rt_parallel_tasks(const void *first, size_t count, size_t size, int threads, RtTaskWork work,
                           void *context, RtError *error) {
    assert(size <= RT_MAX_TASK_BYTES);
    RtTasks tasks = {.work = work, .context = context, .size = size, .status = RT_OK};
    RtStatus status = RT_OK;
    for (size_t i = 0; i < count && status == RT_OK; i++)
        status = add_task(&tasks, (const char *)first + i * size, error);
    pthread_mutex_init(&tasks.lock, NULL);
    pthread_cond_init(&tasks.changed, NULL);
    if (status == RT_OK) status = run_all(run_tasks, &tasks, rt_thread_count(threads), error);
    pthread_cond_destroy(&tasks.changed);
    pthread_mutex_destroy(&tasks.lock);
    rt_free(tasks.waiting);
    if (status == RT_OK && tasks.status != RT_OK && error) *error = tasks.error;
    return status == RT_OK ? tasks.status : status;
}
