/* SPDX-License-Identifier: Apache-2.0 */
/* Embree's device: opened for one instruction set. It records errors instead of printing them, and counts the
 * bytes that it allocates. It ignores configuration files in the home or the program's folder, so the spec
 * alone determines its behaviour. */
#include "accel/embree/embree.h"

#include <stdatomic.h>
#include <stdio.h>
#include <string.h>

enum { ISA_DEFAULT, ISA_SSE2, ISA_SSE42, ISA_AVX, ISA_AVX2, ISA_AVX512, ISA_COUNT };

static const char *const isa_names[ISA_COUNT] = {"default", "sse2", "sse4.2", "avx", "avx2", "avx512"};

/* Only the default is available on other processors than x86. */
static bool processor_has(uint32_t isa) {
    switch (isa) {
    case ISA_DEFAULT: return true;
#if defined(__x86_64__)
    case ISA_SSE2: return __builtin_cpu_supports("sse2");
    case ISA_SSE42: return __builtin_cpu_supports("sse4.2");
    case ISA_AVX: return __builtin_cpu_supports("avx");
    case ISA_AVX2: return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    case ISA_AVX512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("avx512vl");
#endif
    default: return false;
    }
}

static void note_error(void *device, enum RTCError code, const char *message) {
    RtEmbreeDevice *d = device;
    int none = RTC_ERROR_NONE;
    if (!atomic_compare_exchange_strong(&d->code, &none, (int)code)) return;
    snprintf(d->message, sizeof d->message, "%s", message ? message : "no message");
}

static bool note_memory(void *device, ssize_t bytes, bool done) {
    (void)done;
    RtEmbreeDevice *d = device;
    atomic_fetch_add(&d->bytes, bytes);
    return true;
}

static RtStatus fail(int code, const char *message, RtError *error) {
    RtStatus status = code == RTC_ERROR_OUT_OF_MEMORY     ? RT_NO_MEMORY
                      : code == RTC_ERROR_UNSUPPORTED_CPU ? RT_NOT_AVAILABLE
                                                          : RT_MISMATCH;
    return rt_fail(error, status, "Embree reports error %d: %s", code, message);
}

RtStatus rt_embree_isa_check(uint32_t isa, RtError *error) {
    if (processor_has(isa)) return RT_OK;
    return rt_fail(error, RT_NOT_AVAILABLE,
                   "accelerator embree: this processor has no %s; choose a smaller isa, or isa=default",
                   isa_names[isa]);
}

RtStatus rt_embree_device_open(RtEmbreeDevice *device, uint32_t isa, int threads, RtError *error) {
    char config[64];
    int length = snprintf(config, sizeof config, "ignore_config_files=1,threads=%d", threads);
    if (isa != ISA_DEFAULT)
        snprintf(config + length, sizeof config - (size_t)length, ",isa=%s", isa_names[isa]);
    *device = (RtEmbreeDevice){.device = rtcNewDevice(config)};
    if (!device->device) return fail((int)rtcGetDeviceError(NULL), "no device can be opened", error);
    rtcSetDeviceErrorFunction(device->device, note_error, device);
    rtcSetDeviceMemoryMonitorFunction(device->device, note_memory, device);
    return RT_OK;
}

RtStatus rt_embree_device_check(const RtEmbreeDevice *device, RtError *error) {
    int code = atomic_load(&device->code);
    return code == RTC_ERROR_NONE ? RT_OK : fail(code, device->message, error);
}

void rt_embree_device_close(RtEmbreeDevice *device) {
    if (device->device) rtcReleaseDevice(device->device);
    device->device = NULL;
}

bool rt_embree_library(char *out, size_t size) {
    if (size > 0) out[0] = '\0';
    RtEmbreeDevice device;
    if (rt_embree_device_open(&device, ISA_DEFAULT, 0, NULL) != RT_OK) return false;
    long version = (long)rtcGetDeviceProperty(device.device, RTC_DEVICE_PROPERTY_VERSION);
    uint32_t isa = ISA_COUNT - 1;
    while (isa > ISA_DEFAULT && !processor_has(isa)) isa--;
    snprintf(out, size, "%ld.%ld.%ld %s", version / 10000, version / 100 % 100, version % 100,
             isa_names[isa]);
    rt_embree_device_close(&device);
    return true;
}
