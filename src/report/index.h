/* SPDX-License-Identifier: Apache-2.0 */
/* The page over all experiments of a folder. */
#ifndef RT_REPORT_INDEX_H
#define RT_REPORT_INDEX_H

#include "core/base/status.h"

#include <stddef.h>

/* Writes `folder`/index.html: for each result directory in it, or in a folder of it, verdict, question and
 * finding, and a link to its report where that is there. One that cannot be read is named with the reason.
 * Their number goes to *count; RT_BAD_INPUT where there is none. */
RtStatus rt_index_write(const char *folder, size_t *count, RtError *error);

#endif
