/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/plugin/guard.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { GUARD = 64 * 1024, CANARY = 0xA5 };

RtStatus rt_guarded_map(RtGuarded *guarded, size_t bytes, RtError *error) {
    size_t page = (size_t)sysconf(_SC_PAGESIZE), pages = (bytes + page - 1) / page * page;
    size_t mapped = pages + 2 * (size_t)GUARD;
    char *mapping = mmap(NULL, mapped, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapping != MAP_FAILED && mprotect(mapping + GUARD, pages, PROT_READ | PROT_WRITE) == 0) {
        *guarded = (RtGuarded){mapping, mapped, mapping + GUARD, mapping + GUARD + pages};
        return RT_OK;
    }
    if (mapping != MAP_FAILED) munmap(mapping, mapped);
    return rt_fail_memory(error, "the memory of a plugin's query", bytes);
}

void rt_guarded_unmap(RtGuarded *guarded) {
    if (guarded->mapping) munmap(guarded->mapping, guarded->mapped);
    *guarded = (RtGuarded){0};
}

void rt_canaries_lay(char *from, const char *end) {
    memset(from, CANARY, (size_t)(end - from));
}

/* All bytes are CANARY if the first is and each equals the one before. */
bool rt_canaries_are_intact(const char *from, const char *end) {
    size_t bytes = (size_t)(end - from);
    return bytes == 0 || ((unsigned char)*from == CANARY && memcmp(from, from + 1, bytes - 1) == 0);
}
