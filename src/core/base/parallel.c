/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/parallel.h"

#include "core/base/memory.h"

#include <locale.h>
#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <string.h>

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

/* What a thread of its own begins with. */
typedef struct Start {
    pthread_t handle;
    void *(*run)(void *);
    void *of;
    locale_t locale; /* that of the thread which starts it: numbers are written alike on all */
} Start;

static void *start(void *argument) {
    const Start *own = argument;
    uselocale(own->locale);
    return own->run(own->of);
}

/* Calls run(of[i]) for the first of `count` values of `size` bytes on this thread, and for the others on
 * threads of their own. Threads that cannot be had are done without: the others take their work. */
static RtStatus run_all(void *(*run)(void *), void *of, size_t size, int count, RtError *error) {
    Start *starts = rt_alloc((size_t)count, sizeof(Start));
    if (!starts) return rt_fail_memory(error, "worker threads", (size_t)count * sizeof(Start));
    const locale_t locale = uselocale((locale_t)0);
    int started = 1;
    while (started < count) {
        Start *next = &starts[started];
        *next = (Start){.run = run, .of = (char *)of + (size_t)started * size, .locale = locale};
        if (pthread_create(&next->handle, NULL, start, next) != 0) break;
        started++;
    }
    run(of);
    for (int i = 1; i < started; i++) pthread_join(starts[i].handle, NULL);
    rt_free(starts);
    return RT_OK;
}

RtStatus rt_parallel_for(size_t items, int threads, RtWork work, void *context, RtError *error) {
    int count = rt_thread_count(threads);
    if ((size_t)count > items) count = items > 0 ? (int)items : 1;
    Pool pool = {.work = work, .context = context, .items = items, .status = RT_OK};
    Worker *workers = rt_alloc((size_t)count, sizeof(Worker));
    if (!workers) return rt_fail_memory(error, "worker threads", (size_t)count * sizeof(Worker));
    pthread_mutex_init(&pool.lock, NULL);
    for (int i = 0; i < count; i++) workers[i] = (Worker){&pool, i};
    RtStatus status = run_all(run_worker, workers, sizeof(Worker), count, error);
    pthread_mutex_destroy(&pool.lock);
    rt_free(workers);
    if (status != RT_OK) return status;
    if (pool.status != RT_OK && error) *error = pool.error;
    return pool.status;
}

typedef struct SureJob {
    RtSureWork work;
    void *context;
} SureJob;

static RtStatus run_sure(void *context, size_t item, int thread, RtError *error) {
    const SureJob *job = context;
    (void)thread, (void)error;
    job->work(job->context, item);
    return RT_OK;
}

RtStatus rt_parallel_each(size_t items, int threads, RtSureWork work, void *context, RtError *error) {
    return rt_parallel_for(items, threads, run_sure, &(SureJob){work, context}, error);
}

/* ---- tasks that make tasks ---- */

struct RtTasks {
    RtTaskWork work;
    void *context;
    size_t size;
    pthread_mutex_t lock; /* guards all below */
    pthread_cond_t changed;
    char *waiting; /* [end] values, of which those before `begin` were handed out */
    uint32_t begin, end, capacity;
    int running;
    RtStatus status;
    RtError error;
};

static RtStatus add_task(RtTasks *tasks, const void *task) {
    RtError error;
    RT_TRY(rt_reserve(&tasks->waiting, &tasks->capacity, (uint64_t)tasks->end + 1, tasks->size, &error));
    memcpy(tasks->waiting + tasks->end++ * tasks->size, task, tasks->size);
    return RT_OK;
}

bool rt_tasks_add(RtTasks *tasks, const void *task) {
    pthread_mutex_lock(&tasks->lock);
    bool added = add_task(tasks, task) == RT_OK;
    pthread_cond_signal(&tasks->changed);
    pthread_mutex_unlock(&tasks->lock);
    return added;
}

/* Takes the oldest task, waiting for one if need be. False where no more can come. */
static bool take_task(RtTasks *tasks, void *task) {
    while (tasks->status == RT_OK && tasks->begin == tasks->end && tasks->running > 0)
        pthread_cond_wait(&tasks->changed, &tasks->lock);
    if (tasks->status != RT_OK || tasks->begin == tasks->end) return false;
    memcpy(task, tasks->waiting + tasks->begin++ * tasks->size, tasks->size);
    tasks->running++;
    return true;
}

/* One thread's. */
typedef struct TaskWorker {
    RtTasks *tasks;
    void *task; /* room for one */
} TaskWorker;

static void *run_tasks(void *argument) {
    TaskWorker *worker = argument;
    RtTasks *tasks = worker->tasks;
    pthread_mutex_lock(&tasks->lock);
    while (take_task(tasks, worker->task)) {
        RtError error = {RT_OK, ""};
        pthread_mutex_unlock(&tasks->lock);
        RtStatus status = tasks->work(tasks->context, tasks, worker->task, &error);
        pthread_mutex_lock(&tasks->lock);
        tasks->running--;
        if (status != RT_OK && tasks->status == RT_OK) {
            tasks->status = status;
            tasks->error = error;
        }
    }
    pthread_cond_broadcast(&tasks->changed);
    pthread_mutex_unlock(&tasks->lock);
    return NULL;
}

static RtStatus start_tasks(RtTasks *tasks, const void *first, size_t count, int threads, RtError *error) {
    TaskWorker *workers = rt_alloc((size_t)threads, sizeof(TaskWorker));
    size_t room = (tasks->size + RT_CACHE_LINE - 1) / RT_CACHE_LINE * RT_CACHE_LINE;
    char *rooms = rt_alloc((size_t)threads, room);
    RtStatus status = workers && rooms ? RT_OK : RT_NO_MEMORY;
    for (size_t i = 0; i < count && status == RT_OK; i++)
        status = add_task(tasks, (const char *)first + i * tasks->size);
    if (status != RT_OK) rt_fail_memory(error, "tasks", (count + (size_t)threads) * tasks->size);
    for (int i = 0; i < threads && status == RT_OK; i++)
        workers[i] = (TaskWorker){tasks, rooms + (size_t)i * room};
    if (status == RT_OK) status = run_all(run_tasks, workers, sizeof(TaskWorker), threads, error);
    rt_free(workers);
    rt_free(rooms);
    return status;
}

RtStatus rt_parallel_tasks(const void *first, size_t count, size_t size, int threads, RtTaskWork work,
                           void *context, RtError *error) {
    RtTasks tasks = {.work = work, .context = context, .size = size, .status = RT_OK};
    pthread_mutex_init(&tasks.lock, NULL);
    pthread_cond_init(&tasks.changed, NULL);
    RtStatus status = start_tasks(&tasks, first, count, rt_thread_count(threads), error);
    pthread_cond_destroy(&tasks.changed);
    pthread_mutex_destroy(&tasks.lock);
    rt_free(tasks.waiting);
    if (status == RT_OK && tasks.status != RT_OK && error) *error = tasks.error;
    return status == RT_OK ? tasks.status : status;
}
