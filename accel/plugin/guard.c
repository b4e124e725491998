/* SPDX-License-Identifier: Apache-2.0 */
#include "accel/plugin/guard.h"

#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { GUARD = 64 * 1024, CANARY = 0xA5 };

RtStatus rt_guarded_map(RtGuarded *guarded, size_t bytes, RtPluginGuard *guard, RtError *error) {
    size_t page = (size_t)sysconf(_SC_PAGESIZE), room = (bytes + page - 1) / page * page;
    size_t mapped = room + 2 * (size_t)GUARD;
    char *mapping = mmap(NULL, mapped, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (mapping != MAP_FAILED && mprotect(mapping + GUARD, room, PROT_READ | PROT_WRITE) == 0) {
        *guarded = (RtGuarded){mapping, mapped, mapping + GUARD, mapping + GUARD + room};
        *guard = (RtPluginGuard){mapping, mapping + mapped};
        return RT_OK;
    }
    if (mapping != MAP_FAILED) munmap(mapping, mapped);
    return rt_fail_memory(error, "what a plugin's query writes to", bytes);
}

void rt_guarded_unmap(RtGuarded *guarded) {
    if (guarded->mapping) munmap(guarded->mapping, guarded->mapped);
    *guarded = (RtGuarded){0};
}

/* All bytes are that of the first where each is that of the one before. */
bool rt_canaries_live(const char *from, const char *end) {
    size_t bytes = (size_t)(end - from);
    return bytes == 0 || ((unsigned char)*from == CANARY && memcmp(from, from + 1, bytes - 1) == 0);
}

void rt_canaries_lay(char *from, const char *end) {
    memset(from, CANARY, (size_t)(end - from));
}
