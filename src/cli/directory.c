/* SPDX-License-Identifier: Apache-2.0 */
#include "cli/directory.h"

#include "core/base/file.h"

RtStatus rt_cli_directory_work(const char *directory, bool writes, RtDirectoryWork *work, const void *options,
                               RtError *error) {
    RtLock lock = RT_NO_LOCK;
    RtResults results = {0};
    static RtExperiment experiment;
    RtStatus status = writes ? rt_lock_take(&lock, directory, error) : RT_OK;
    if (status == RT_OK) status = rt_results_load(directory, &experiment, &results, error);
    if (status == RT_OK) status = work(directory, &results, options, error);
    rt_lock_release(&lock);
    rt_results_clear(&results);
    return status;
}
