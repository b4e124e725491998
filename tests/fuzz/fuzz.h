/* SPDX-License-Identifier: Apache-2.0 */
/* Fuzzing: what every target shares. A target hands arbitrary bytes to one reader of raytally, as libFuzzer
 * makes them from files of the repository (tests/fuzz.sh). It must refuse them with a message or take them;
 * then what was read is used. AddressSanitizer and UndefinedBehaviorSanitizer watch, and so does the count of
 * allocated blocks. */
#ifndef RT_TESTS_FUZZ_H
#define RT_TESTS_FUZZ_H

#include "core/base/file.h"
#include "experiment/experiment.h"

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

typedef struct Input {
    const uint8_t *bytes;
    size_t size;
    const char *path; /* of the target's file, which has these bytes; NULL if the target has none */
} Input;

/* Each target is declared here, and listed in fuzz.c. */
typedef void Reader(const Input *input);
typedef void Preparation(void); /* once, before the first input; what it allocates stays */
Reader fuzz_scene, fuzz_mtl, fuzz_trace, fuzz_rays, fuzz_hits, fuzz_replay;
Reader fuzz_experiment, fuzz_claim, fuzz_spec, fuzz_manifest, fuzz_journal, fuzz_packed_journal, fuzz_csv,
    fuzz_verification;
Reader fuzz_plugin, fuzz_worker;
Preparation fuzz_prepare_mtl, fuzz_prepare_trace, fuzz_prepare_results, fuzz_prepare_journal,
    fuzz_prepare_claim, fuzz_prepare_plugin;

/* The folder of this process, for other files that a target needs: its path with `name`, valid until the next
 * call. */
const char *fuzz_path(const char *name);
void fuzz_write(const char *name, const void *data, size_t size);

/* A stream that forgets what is written. */
FILE *fuzz_nowhere(void);

/* Ends the process with a message; libFuzzer then keeps the input. */
_Noreturn __attribute__((format(printf, 1, 2))) void fuzz_fail(const char *format, ...);

#define CHECK(condition)                                                                                     \
    ((condition) ? (void)0 : fuzz_fail("%s:%d: %s does not hold", __FILE__, __LINE__, #condition))

/* Whether the input was accepted. A refusal must have a message for the user. */
bool fuzz_accepted(RtStatus status, const RtError *error);

#endif
