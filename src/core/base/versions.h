/* SPDX-License-Identifier: Apache-2.0 */
/* The numbers of what raytally promises to keep, beside those of its interfaces (include/raytally).
 * docs/interface.md says what each covers, and what raises it. */
#ifndef RT_BASE_VERSIONS_H
#define RT_BASE_VERSIONS_H

#include <inttypes.h>

#define RT_FILE_FORMAT    1 /* the newest that is read, and the one that is written: `format` in files */
#define RT_COUNTS_VERSION 2 /* `counts` in manifests */

/* A message about a file of another format; takes that format, an int64_t, and RT_FILE_FORMAT. */
#define RT_FORMAT_UNKNOWN                                                                                    \
    "its format is %" PRId64 ", and raytally " RT_VERSION                                                    \
    " reads formats 1..%d: use the raytally that wrote it, or a newer one"

#endif
