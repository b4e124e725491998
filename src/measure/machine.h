/* SPDX-License-Identifier: Apache-2.0 */
/* The origin of measurements: machine, compiler, version. */
#ifndef RT_MEASURE_MACHINE_H
#define RT_MEASURE_MACHINE_H

#include <jansson.h>
#include <stddef.h>

/* Where cells were timed. */
#define RT_MAX_MACHINES 256
typedef struct RtMachine {
    char host[64], cpu[128]; /* "": unknown */
} RtMachine;

/* {"cpu", "clock_mhz" (the highest of the first processor, or its current one), "governor", "simd",
 * "processors", "os", "compiler", "flags", "version", "commit", "dirty", "program" (the hash of the running
 * one)}, "plugins" if any are loaded, and under the name of each accelerator that uses a library, its
 * version. Unknown values are null. NULL if memory is short; the caller owns the reference. */
json_t *rt_machine_json(void);

/* Appends the libraries that accelerators use, "NAME VERSION" each after `before`, to a text of `size` chars.
 */
void rt_machine_libraries(const json_t *machine, const char *before, char *text, size_t size);

/* The loaded plugins, [{"file", "hash", "accelerators": [NAME, ...]}, ...]; the caller owns the reference. */
json_t *rt_plugins_json(void);

/* Version, commit, compiler and flags in one line, and the hash of the program if its sources are not a
 * commit: only measurements of one build may be mixed. rt_build_identity also has every loaded plugin. */
const char *rt_build_alone(void);
const char *rt_build_identity(void);

/* This machine. */
RtMachine rt_machine_here(void);

#endif
