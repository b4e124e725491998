/* SPDX-License-Identifier: Apache-2.0 */
/* What the measurements were made with: the machine, the compiler, the version. */
#ifndef RT_MEASURE_MACHINE_H
#define RT_MEASURE_MACHINE_H

#include <jansson.h>

/* Where cells were timed. */
#define RT_MAX_MACHINES 256
typedef struct RtMachine {
    char host[64], cpu[128]; /* "": not known */
} RtMachine;

/* {"cpu", "clock_mhz" (the highest of the first processor, or what it has just now), "governor", "simd",
 * "processors", "os", "compiler", "flags", "version", "commit", "dirty", "program" (the hash of the one that
 * runs)}, "plugins" where any are loaded, and
 * by the name of each accelerator that a library does the work of, its version; what cannot be found out is
 * null. NULL where memory is short; the caller owns the reference. */
json_t *rt_machine_json(void);

/* [{"file", "hash", "accelerators": [NAME, ...]}, ...]: the plugins that are loaded; the caller's, as well.
 */
json_t *rt_plugins_json(void);

/* Version, commit, compiler and flags in one line, and where the sources are no commit, the hash of the
 * program: only what was measured by one and the same build may be mixed. rt_build_identity has every plugin
 * that is loaded, too. */
const char *rt_build_alone(void);
const char *rt_build_identity(void);

/* This machine. */
RtMachine rt_machine_here(void);

#endif
