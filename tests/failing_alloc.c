/* SPDX-License-Identifier: Apache-2.0 */
/* Preloaded into raytally by tests/check_failures.sh: the nth allocation of one library fails.
 *
 * $RT_FAIL_IN names the library whose calls are counted, by a part of its file name, and $RT_FAIL_AT the one
 * that fails (none: 0). At its end the process appends to $RT_FAIL_LOG a line for each library, "calls NAME
 * COUNT", and "live COUNT": the blocks that raytally itself allocated and did not free. Such a block has its
 * own address, mixed with a constant, in its last bytes. Libraries that are loaded later are not told apart.
 */
#include <dlfcn.h>
#include <errno.h>
#include <link.h>
#include <malloc.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *block, size_t size);
void *__libc_memalign(size_t boundary, size_t size);
void __libc_free(void *block);

enum { MOST_LIBRARIES = 256 };
static struct {
    uintptr_t begin, end;
    const char *name;
    atomic_ullong calls;
    bool fails;
} libraries[MOST_LIBRARIES]; /* the first is the program */
static int library_count;    /* 0 until all is set up */
static unsigned long long fail_at;
static atomic_llong live;

static uintptr_t mark_of(const void *block) {
    return (uintptr_t)block ^ (uintptr_t)0x9E3779B97F4A7C15;
}

static uintptr_t *mark_at(void *block) {
    return (uintptr_t *)((char *)block + (malloc_usable_size(block) & ~(size_t)7)) - 1;
}

/* Counts a call; whether it is the one that fails. `own`: raytally itself called. */
static bool fails(const void *caller, bool *own) {
    int i = 0;
    *own = false;
    while (i < library_count &&
           !((uintptr_t)caller >= libraries[i].begin && (uintptr_t)caller < libraries[i].end))
        i++;
    if (i >= library_count) return false;
    *own = i == 0;
    const bool failed = atomic_fetch_add(&libraries[i].calls, 1) + 1 == fail_at && libraries[i].fails;
    if (failed) errno = ENOMEM;
    return failed;
}

static size_t with_mark(size_t size, bool own) {
    return own ? size + 2 * sizeof(uintptr_t) : size;
}

static void *marked(void *block, bool own) {
    if (!block || !own) return block;
    *mark_at(block) = mark_of(block);
    atomic_fetch_add(&live, 1);
    return block;
}

void free(void *block) {
    if (block && library_count && *mark_at(block) == mark_of(block)) {
        *mark_at(block) = 0;
        atomic_fetch_sub(&live, 1);
    }
    __libc_free(block);
}

#define CALLER __builtin_return_address(0)

void *malloc(size_t size) {
    bool own;
    return fails(CALLER, &own) ? NULL : marked(__libc_malloc(with_mark(size, own)), own);
}

void *calloc(size_t count, size_t size) {
    bool own;
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes)) return NULL;
    return fails(CALLER, &own) ? NULL : marked(__libc_calloc(1, with_mark(bytes, own)), own);
}

void *aligned_alloc(size_t boundary, size_t size) {
    bool own;
    return fails(CALLER, &own) ? NULL : marked(__libc_memalign(boundary, with_mark(size, own)), own);
}

int posix_memalign(void **out, size_t boundary, size_t size) {
    bool own;
    void *block = fails(CALLER, &own) ? NULL : marked(__libc_memalign(boundary, with_mark(size, own)), own);
    if (block) *out = block;
    return block ? 0 : ENOMEM;
}

void *realloc(void *block, size_t size) {
    bool own;
    return fails(CALLER, &own) ? NULL : __libc_realloc(block, size);
}

static int add_library(struct dl_phdr_info *info, size_t size, void *count) {
    int *const i = count;
    const char *slash = strrchr(info->dlpi_name, '/');
    (void)size;
    if (*i == MOST_LIBRARIES) return 1;
    libraries[*i].begin = UINTPTR_MAX;
    for (int h = 0; h < info->dlpi_phnum; h++) {
        const ElfW(Phdr) *header = &info->dlpi_phdr[h];
        const uintptr_t begin = info->dlpi_addr + header->p_vaddr, end = begin + header->p_memsz;
        if (header->p_type != PT_LOAD) continue;
        if (begin < libraries[*i].begin) libraries[*i].begin = begin;
        if (end > libraries[*i].end) libraries[*i].end = end;
    }
    libraries[*i].name = *i == 0 ? "raytally" : slash ? slash + 1 : info->dlpi_name;
    (*i)++;
    return 0;
}

__attribute__((constructor)) static void begin(void) {
    const char *in = getenv("RT_FAIL_IN"), *at = getenv("RT_FAIL_AT");
    int count = 0;
    if (strcmp(program_invocation_short_name, "raytally") != 0) return;
    dl_iterate_phdr(add_library, &count);
    for (int i = 0; i < count; i++) libraries[i].fails = in && strstr(libraries[i].name, in);
    fail_at = at ? strtoull(at, NULL, 10) : 0;
    library_count = count;
}

__attribute__((destructor)) static void end(void) {
    const char *path = getenv("RT_FAIL_LOG");
    const int count = library_count;
    library_count = 0;
    FILE *log = path && count ? fopen(path, "a") : NULL;
    if (!log) return;
    for (int i = 0; i < count; i++) {
        if (libraries[i].calls) fprintf(log, "calls %s %llu\n", libraries[i].name, libraries[i].calls);
    }
    fprintf(log, "live %lld\n", live);
    fclose(log);
}
