/* SPDX-License-Identifier: Apache-2.0 */
/* The table of targets, and what libFuzzer calls. $RT_FUZZ_TARGET names the target; without it, the names are
 * listed. */
#include "fuzz.h"

#include "core/base/memory.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Larger allocations are refused, as by --memory. */
#define MOST_MEMORY (UINT64_C(1) << 30)

static const struct Target {
    const char *name;
    const char *file; /* that the reader reads; NULL: none */
    Reader *read;
    Preparation *prepare; /* or NULL */
} targets[] = {
    {"yaml", "scene.yaml", fuzz_scene, NULL},
    {"nff", "scene.nff", fuzz_scene, NULL},
    {"obj", "mesh.obj", fuzz_scene, NULL},
    {"ply", "mesh.ply", fuzz_scene, NULL},
    {"stl", "mesh.stl", fuzz_scene, NULL},
    {"off", "mesh.off", fuzz_scene, NULL},
    {"gltf", "mesh.gltf", fuzz_scene, NULL},
    {"glb", "mesh.glb", fuzz_scene, NULL},
    {"trace", NULL, fuzz_trace, fuzz_prepare_trace},
    {"mtl", "library.mtl", fuzz_mtl, fuzz_prepare_mtl},
    {"rays", "rays.npy", fuzz_rays, NULL},
    {"ray-text", "rays.csv", fuzz_rays, NULL},
    {"hits", "hits.npy", fuzz_hits, NULL},
    {"hit-text", "hits.csv", fuzz_hits, NULL},
    {"replay", "replay.json", fuzz_replay, NULL},
    {"spec", NULL, fuzz_spec, NULL},
    {"experiment", "experiment.yaml", fuzz_experiment, NULL},
    {"claim", NULL, fuzz_claim, fuzz_prepare_claim},
    {"manifest", "manifest.json", fuzz_manifest, fuzz_prepare_results},
    {"journal", NULL, fuzz_journal, fuzz_prepare_journal},
    {"packed-journal", "cells.jsonl.gz", fuzz_packed_journal, NULL},
    {"verification", "rows.jsonl", fuzz_verification, NULL},
    {"csv", "verify.csv", fuzz_csv, NULL},
    {"plugin", NULL, fuzz_plugin, fuzz_prepare_plugin},
    {"worker", NULL, fuzz_worker, NULL},
};

static const struct Target *target;
static char folder[] = "/tmp/raytally-fuzz-XXXXXX";

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* ---- for the targets ---- */

const char *fuzz_path(const char *name) {
    static char path[RT_MAX_PATH];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

/* In place: a new file for each input would take most of the time. */
void fuzz_write(const char *name, const void *data, size_t size) {
    FILE *file = fopen(fuzz_path(name), "wb");
    if (!file || fwrite(data, 1, size, file) != size || fclose(file) != 0)
        fuzz_fail("%s cannot be written", fuzz_path(name));
}

FILE *fuzz_nowhere(void) {
    static FILE *nowhere;
    if (!nowhere) nowhere = fopen("/dev/null", "w");
    if (!nowhere) fuzz_fail("/dev/null cannot be written");
    return nowhere;
}

void fuzz_fail(const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
    abort();
}

bool fuzz_accepted(RtStatus status, const RtError *error) {
    if (status == RT_OK) return true;
    if (error->status != status || !*error->message)
        fuzz_fail("refused with status %d and the message '%s'", (int)status, error->message);
    return false;
}

/* ---- libFuzzer ---- */

static void remove_folder(void) {
    rt_directory_remove_files(folder, "");
    rmdir(folder);
}

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    (void)argc, (void)argv;
    const char *name = getenv("RT_FUZZ_TARGET");
    for (size_t i = 0; i < sizeof targets / sizeof targets[0]; i++) {
        if (!name) puts(targets[i].name);
        if (name && strcmp(targets[i].name, name) == 0) target = &targets[i];
    }
    if (!target) exit(name ? EXIT_FAILURE : EXIT_SUCCESS);
    if (!mkdtemp(folder)) fuzz_fail("%s cannot be created", folder);
    atexit(remove_folder);
    rt_memory_limit(MOST_MEMORY);
    if (target->prepare) target->prepare();
    return 0;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char path[sizeof folder + 64];
    const int64_t live = rt_alloc_live();
    if (target->file) {
        fuzz_write(target->file, data, size);
        snprintf(path, sizeof path, "%s/%s", folder, target->file);
    }
    target->read(&(Input){data, size, target->file ? path : NULL});
    CHECK(rt_alloc_live() == live);
    return 0;
}
