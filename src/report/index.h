/* SPDX-License-Identifier: Apache-2.0 */
/* The page over all experiments of a folder. */
#ifndef RT_REPORT_INDEX_H
#define RT_REPORT_INDEX_H

#include "core/base/status.h"

#include <stddef.h>

/* Writes `folder`/index.html: verdict, question, finding, and a link to the report of each result directory
 * in it or in its folders. Names directories that cannot be read, with the reason. *count gets their number;
 * RT_BAD_INPUT if there is none. */
RtStatus rt_index_write(const char *folder, size_t *count, RtError *error);

#endif
