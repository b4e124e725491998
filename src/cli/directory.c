/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/directory.h"

#include "cli/cli.h"
#include "core/base/lock.h"
#include "core/base/memory.h"

int rt_cli_directory_work(const char *directory, bool writes, RtDirectoryWork *work) {
    RtError error;
    RtLock lock = RT_NO_LOCK;
    RtResults results = {0};
    RtExperiment *experiment = rt_alloc(1, sizeof *experiment);
    RtStatus status = experiment ? RT_OK : rt_fail_memory(&error, "an experiment", sizeof *experiment);
    if (status == RT_OK && writes) status = rt_lock_take(&lock, directory, &error);
    if (status == RT_OK) status = rt_run_load(directory, experiment, &results, &error);
    if (status == RT_OK) status = work(directory, experiment, &results, &error);
    rt_lock_release(&lock);
    rt_results_clear(&results);
    rt_free(experiment);
    return status == RT_OK ? RT_EXIT_OK : rt_cli_fail(&error);
}
