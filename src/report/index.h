/* SPDX-License-Identifier: Apache-2.0 */
/* The pages over all experiments of a folder: index.html for a browser, index.md for GitHub. */
#ifndef RT_REPORT_INDEX_H
#define RT_REPORT_INDEX_H

#include "core/base/status.h"

#include <stddef.h>

/* Writes both for the result directories in `folder` or in its folders, grouped by the sections of their
 * experiments: question, answer, verdict and plot of each experiment, the sentences of the literature that
 * they test, and the sums of verifications. index.md is a table of questions and answers. They say which
 * builds and machines measured what, if there are several, and name directories that cannot be read, with the
 * reason. *count gets the number of directories; RT_BAD_INPUT if there is none. */
RtStatus rt_index_write(const char *folder, size_t *count, RtError *error);

#endif
