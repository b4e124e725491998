/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/machine.h"

#include "accel/plugin.h"
#include "build_info.h"
#include "core/base/parallel.h"
#include "core/base/words.h"
#include "core/text/json.h"

#include <fcntl.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/utsname.h>
#include <unistd.h>
#include <xxhash.h>

/* What follows `key` and a colon in the first line of a file of the kernel that begins with it, or "". */
static void read_value(const char *path, const char *key, char *out, size_t size) {
    char line[512];
    out[0] = '\0';
    FILE *file = fopen(path, "r");
    while (file && !out[0] && fgets(line, sizeof line, file)) {
        const char *value = line + strlen(key);
        if (strncmp(line, key, strlen(key)) != 0) continue;
        line[strcspn(line, "\n")] = '\0';
        snprintf(out, size, "%s", value + strspn(value, " \t:"));
    }
    if (file) fclose(file);
}

#define CPUINFO "/proc/cpuinfo"
#define CPUFREQ "/sys/devices/system/cpu/cpu0/cpufreq/"

static json_t *clock_mhz(void) {
    char text[64];
    read_value(CPUFREQ "cpuinfo_max_freq", "", text, sizeof text);
    double mhz = 1e-3 * strtod(text, NULL);
    if (!(mhz > 0)) {
        read_value(CPUINFO, "cpu MHz", text, sizeof text);
        mhz = strtod(text, NULL);
    }
    return mhz > 0 ? json_real(mhz) : json_null();
}

static const char *simd_level(void) {
#if defined(__x86_64__)
    return __builtin_cpu_supports("avx512f") ? "AVX-512"
           : __builtin_cpu_supports("avx2")  ? "AVX2"
           : __builtin_cpu_supports("avx")   ? "AVX"
                                             : "SSE2";
#elif defined(__aarch64__)
    return "NEON";
#else
    return "";
#endif
}

static json_t *text_or_null(const char *text) {
    return *text ? json_string(text) : json_null();
}

json_t *rt_plugins_json(void) {
    json_t *list = json_array();
    for (size_t i = 0; i < rt_plugin_count(); i++) {
        const RtPlugin *plugin = rt_plugin_at(i);
        json_t *names = json_array();
        for (uint32_t n = 0; n < plugin->count; n++)
            json_array_append_new(names, json_string(plugin->names[n]));
        json_array_append_new(list, json_pack("{s:s, s:o, s:o}", "file", plugin->path, "hash",
                                              rt_json_hex(plugin->fingerprint), "accelerators", names));
    }
    return list;
}

/* Hash of the running program; 0 if it cannot be read. */
static uint64_t program_hash(void) {
    static uint64_t hash;
    struct stat info;
    int file = hash ? -1 : open("/proc/self/exe", O_RDONLY | O_CLOEXEC);
    if (file < 0) return hash;
    size_t size = fstat(file, &info) == 0 ? (size_t)info.st_size : 0;
    void *bytes = mmap(NULL, size, PROT_READ, MAP_PRIVATE, file, 0);
    if (bytes != MAP_FAILED) {
        hash = XXH3_64bits(bytes, size);
        munmap(bytes, size);
    }
    close(file);
    return hash;
}

json_t *rt_machine_json(void) {
    char cpu[256], governor[64], system[256] = "";
    struct utsname name;
    read_value(CPUINFO, "model name", cpu, sizeof cpu);
    read_value(CPUFREQ "scaling_governor", "", governor, sizeof governor);
    if (uname(&name) == 0) {
        snprintf(system, sizeof system, "%.64s %.64s %.64s", name.sysname, name.release, name.machine);
    }
    json_t *machine =
        json_pack("{s:o, s:o, s:o, s:o, s:i, s:o, s:s, s:s, s:s, s:s, s:b, s:o}", "cpu", text_or_null(cpu),
                  "clock_mhz", clock_mhz(), "governor", text_or_null(governor), "simd",
                  text_or_null(simd_level()), "processors", rt_processor_count(), "os", text_or_null(system),
                  "compiler", RT_COMPILER, "flags", RT_FLAGS, "version", RT_VERSION, "commit", RT_COMMIT,
                  "dirty", RT_DIRTY, "program", rt_json_hex(program_hash()));
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        char library[64];
        if (!ops->library) continue;
        ops->library(library, sizeof library);
        json_object_set_new(machine, ops->name, text_or_null(library));
    }
    if (rt_plugin_count() > 0) json_object_set_new(machine, "plugins", rt_plugins_json());
    return machine;
}

void rt_machine_libraries(const json_t *machine, const char *before, char *text, size_t size) {
    for (size_t i = 0; i < rt_accel_count(); i++) {
        const RtAccelOps *ops = rt_accel_at(i);
        if (!ops->library) continue;
        rt_append_text(text, size, "%s%s %s", before, ops->name, rt_json_text(machine, ops->name, "unknown"));
    }
}

/* Programs of one clean commit differ only by paths, and by compiler and flags, which are included. */
const char *rt_build_alone(void) {
    static char identity[1024];
    char program[64] = "";
    if (!RT_CLEAN)
        snprintf(program, sizeof program, "%s (program %016" PRIx64 ")", RT_DIRTY ? " with changes" : "",
                 program_hash());
    snprintf(identity, sizeof identity, "%s %s%s, %s, %s", RT_VERSION, RT_COMMIT, program, RT_COMPILER,
             RT_FLAGS);
    return identity;
}

const char *rt_build_identity(void) {
    static char identity[4096];
    snprintf(identity, sizeof identity, "%s", rt_build_alone());
    for (size_t i = 0; i < rt_plugin_count(); i++)
        rt_append_text(identity, sizeof identity, ", plugin of %s %016" PRIx64, rt_plugin_at(i)->names[0],
                       rt_plugin_at(i)->fingerprint);
    return identity;
}

RtMachine rt_machine_here(void) {
    RtMachine machine = {"", ""};
    read_value(CPUINFO, "model name", machine.cpu, sizeof machine.cpu);
    if (gethostname(machine.host, sizeof machine.host - 1) != 0) machine.host[0] = '\0';
    return machine;
}
