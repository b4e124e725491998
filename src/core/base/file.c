/* SPDX-License-Identifier: Apache-2.0 */
#include "core/base/file.h"

#include "core/base/memory.h"
#include "core/base/words.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#define XXH_INLINE_ALL
#include <xxhash.h>

#define TEMPORARY_END ".tmp"

static RtStatus fail_io(RtError *error, const char *doing, const char *path) {
    return rt_fail(error, RT_IO, "%s: %s failed: %s", path, doing, strerror(errno ? errno : EIO));
}

/* ---- temporary files ---- */

/* Those of this process, for a handler of signals: a name is whole while it is LISTED. What the handler takes
 * stays CHANGING, so that no thread overwrites the name as it is read. */
enum { MOST_LISTED = 64, UNUSED = 0, CHANGING, LISTED };
static struct {
    atomic_int state;
    char path[RT_MAX_PATH + 24];
} listed[MOST_LISTED];

static void list_temporary(RtOutput *output) {
    output->listed = -1;
    for (int i = 0; i < MOST_LISTED && output->listed < 0; i++) {
        int unused = UNUSED;
        if (atomic_compare_exchange_strong(&listed[i].state, &unused, CHANGING)) output->listed = i;
    }
    if (output->listed < 0) return;
    strcpy(listed[output->listed].path, output->temporary);
    atomic_store(&listed[output->listed].state, LISTED);
}

/* It is renamed or removed. */
static void forget_temporary(RtOutput *output) {
    int whole = LISTED;
    if (output->listed >= 0) atomic_compare_exchange_strong(&listed[output->listed].state, &whole, UNUSED);
    output->listed = -1;
    output->temporary[0] = '\0';
}

void rt_outputs_remove_open(void) {
    for (int i = 0; i < MOST_LISTED; i++) {
        int whole = LISTED;
        if (atomic_compare_exchange_strong(&listed[i].state, &whole, CHANGING)) unlink(listed[i].path);
    }
}

/* ---- writing ---- */

/* The name holds 64 random bits and must not exist, so nobody can plant a link or another file there. */
static RtStatus create_temporary(RtOutput *output, RtError *error) {
    /* File names have at most 255 bytes: cut long ones to leave room for the suffix. */
    const size_t most = 255 - strlen(".0123456789abcdef" TEMPORARY_END);
    const char *name = basename(output->path);
    const int kept = (int)(name - output->path) + (int)strnlen(name, most);
    uint64_t number = 0;
    int descriptor = -1;
    if (getrandom(&number, sizeof number, 0) == sizeof number) {
        snprintf(output->temporary, sizeof output->temporary, "%.*s.%016" PRIx64 TEMPORARY_END, kept,
                 output->path, number);
        list_temporary(output);
        descriptor = open(output->temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    }
    if (descriptor >= 0) output->file = fdopen(descriptor, "wb");
    if (output->file) return RT_OK;
    RtStatus status = fail_io(error, "creating the file", output->path);
    if (descriptor >= 0) {
        close(descriptor);
        remove(output->temporary);
    }
    forget_temporary(output);
    return status;
}

RtStatus rt_output_open(RtOutput *output, const char *path, RtError *error) {
    *output = (RtOutput){.listed = -1};
    if (strlen(path) >= RT_MAX_PATH)
        return rt_fail(error, RT_BAD_INPUT, "%.80s...: the path is too long", path);
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return rt_fail(error, RT_IO, "%s is a %s: give the name of a file", path,
                       S_ISDIR(info.st_mode) ? "folder" : "device or pipe, which a file would replace");
    strcpy(output->path, path);
    return create_temporary(output, error);
}

RtStatus rt_output_open_in(RtOutput *output, const char *folder, const char *name, RtError *error) {
    char path[RT_MAX_PATH];
    RT_TRY(rt_path_join(folder, name, path, error));
    return rt_output_open(output, path, error);
}

RtStatus rt_output_finish(RtOutput *output, RtError *error) {
    errno = 0;
    bool written = fflush(output->file) == 0 && !ferror(output->file) && fsync(fileno(output->file)) == 0;
    RtStatus status = written ? RT_OK : fail_io(error, "writing", output->path);
    bool closed = fclose(output->file) == 0;
    output->file = NULL;
    if (written && !closed) status = fail_io(error, "writing", output->path);
    if (status != RT_OK) rt_output_discard(output);
    return status;
}

RtStatus rt_output_commit(RtOutput *output, RtError *error) {
    if (output->file) RT_TRY(rt_output_finish(output, error));
    RtStatus status = RT_OK;
    if (rename(output->temporary, output->path) != 0) {
        status = fail_io(error, "writing", output->path);
        remove(output->temporary);
    }
    forget_temporary(output);
    return status;
}

void rt_output_discard(RtOutput *output) {
    if (output->file) fclose(output->file);
    output->file = NULL;
    if (!*output->temporary) return;
    remove(output->temporary);
    forget_temporary(output);
}

RtStatus rt_file_write(const char *path, const void *data, size_t size, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    fwrite(data, 1, size, output.file);
    return rt_output_commit(&output, error);
}

/* ---- several at once ---- */

RtStatus rt_outputs_add(RtOutputs *outputs, const char *path, RtOutput **output, RtError *error) {
    RT_TRY(rt_reserve(&outputs->list, &outputs->capacity, outputs->count + UINT64_C(1), sizeof *outputs->list,
                      error));
    *output = &outputs->list[outputs->count];
    RT_TRY(rt_output_open(*output, path, error));
    outputs->count++;
    return RT_OK;
}

RtStatus rt_outputs_copy(RtOutputs *outputs, const char *from, const char *to, RtError *error) {
    enum { MOST_BYTES = 1 << 24 };
    RtOutput *output;
    char *data;
    size_t size;
    RT_TRY(rt_file_read(from, MOST_BYTES, &data, &size, error));
    RtStatus status = rt_outputs_add(outputs, to, &output, error);
    if (status == RT_OK) {
        fwrite(data, 1, size, output->file);
        status = rt_output_finish(output, error);
    }
    rt_free(data);
    return status;
}

RtStatus rt_outputs_commit(RtOutputs *outputs, RtError *error) {
    for (uint32_t i = 0; i < outputs->count; i++) RT_TRY(rt_output_commit(&outputs->list[i], error));
    return RT_OK;
}

void rt_outputs_clear(RtOutputs *outputs) {
    for (uint32_t i = 0; i < outputs->count; i++) rt_output_discard(&outputs->list[i]);
    rt_free(outputs->list);
    *outputs = (RtOutputs){0};
}

/* "NAME.", 16 digits, ".tmp". */
static void remove_temporary(void *context, const char *path) {
    size_t length = strlen(path), tail = strlen(".0123456789abcdef" TEMPORARY_END);
    (void)context;
    if (length <= tail || path[length - tail] != '.') return;
    if (strspn(path + length - tail + 1, "0123456789abcdef") == 16) remove(path);
}

void rt_outputs_remove_left(const char *folder) {
    rt_directory_each(folder, TEMPORARY_END, remove_temporary, NULL);
}

/* ---- in memory ---- */

/* Leaves room for the 0 at the end. */
static ssize_t write_to_memory(void *cookie, const char *bytes, size_t count) {
    RtMemoryFile *memory = cookie;
    if (count >= memory->capacity - memory->size) {
        const size_t capacity = 2 * memory->capacity + count;
        char *grown = rt_alloc_unset(capacity, 1);
        if (!grown) return 0; /* an error, for the file */
        memcpy(grown, memory->data, memory->size);
        rt_free(memory->data);
        memory->data = grown;
        memory->capacity = capacity;
    }
    memcpy(memory->data + memory->size, bytes, count);
    memory->size += count;
    return (ssize_t)count;
}

RtStatus rt_memory_file_open(RtMemoryFile *memory, RtError *error) {
    enum { CAPACITY = 4096 };
    *memory = (RtMemoryFile){.data = rt_alloc_unset(CAPACITY, 1), .capacity = CAPACITY};
    if (memory->data)
        memory->file = fopencookie(memory, "w", (cookie_io_functions_t){.write = write_to_memory});
    if (memory->file) return RT_OK;
    rt_free(memory->data);
    memory->data = NULL;
    return rt_fail_memory(error, "a file in memory", CAPACITY);
}

RtStatus rt_memory_file_close(RtMemoryFile *memory, const char *what, RtError *error) {
    bool whole = fflush(memory->file) == 0 && !ferror(memory->file);
    fclose(memory->file);
    memory->file = NULL;
    memory->data[memory->size] = '\0';
    if (whole) return RT_OK;
    rt_free(memory->data);
    memory->data = NULL;
    return rt_fail_memory(error, what, 0);
}

/* ---- reading ---- */

RtStatus rt_file_fail_zero(const char *path, const char *text, const char *zero, RtError *error) {
    size_t line = 1;
    const char *start = text;
    for (const char *end; (end = memchr(start, '\n', (size_t)(zero - start))); start = end + 1) line++;
    return rt_fail_at(error, path, line, (size_t)(zero - start) + 1,
                      "there is a byte of 0: this is a binary or damaged file, not text");
}

/* Reads in pieces, so that a large file of zeros is rejected as text before it takes memory. */
static RtStatus read_pieces(FILE *file, const char *path, bool text, char *buffer, size_t bytes, size_t *size,
                            RtError *error) {
    enum { PIECE = 1 << 20 };
    for (size_t left = bytes; left > 0; left = bytes - *size) {
        errno = 0;
        const size_t got = fread(buffer + *size, 1, left < PIECE ? left : PIECE, file);
        if (ferror(file)) return fail_io(error, "reading", path);
        if (got == 0) break;
        const char *zero = text ? memchr(buffer + *size, '\0', got) : NULL;
        if (zero) return rt_file_fail_zero(path, buffer, zero, error);
        *size += got;
    }
    if (text && *size >= 3 && memcmp(buffer, "\xEF\xBB\xBF", 3) == 0) memmove(buffer, buffer + 3, *size -= 3);
    buffer[*size] = '\0';
    return RT_OK;
}

RtStatus rt_file_open(const char *path, FILE **file, RtError *error) {
    struct stat info;
    /* Checked before opening, because opening a pipe waits for a writer. */
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return rt_fail(error, RT_BAD_INPUT, "%s: this is not a file", path);
    *file = fopen(path, "rb");
    if (*file) return RT_OK;
    int reason = errno;
    if (rt_file_is_dead_link(path, error)) return RT_BAD_INPUT;
    return rt_fail(error, RT_BAD_INPUT, "%s: cannot be opened: %s", path, strerror(reason));
}

static RtStatus read_file(const char *path, bool text, size_t limit, char **data, size_t *size,
                          RtError *error) {
    struct stat info;
    FILE *file;
    RtStatus status;
    *data = NULL;
    *size = 0;
    RT_TRY(rt_file_open(path, &file, error));
    if (fstat(fileno(file), &info) != 0)
        status = fail_io(error, "reading", path);
    else if ((uint64_t)info.st_size > limit)
        status = rt_fail(error, RT_BAD_INPUT, "%s: %lld bytes are too many: the limit is %zu", path,
                         (long long)info.st_size, limit);
    else if (!(*data = rt_alloc_unset((size_t)info.st_size + 1, 1)))
        status = rt_fail_memory(error, path, (size_t)info.st_size + 1);
    else
        status = read_pieces(file, path, text, *data, (size_t)info.st_size, size, error);
    fclose(file);
    if (status == RT_OK) return RT_OK;
    rt_free(*data);
    *data = NULL;
    return status;
}

RtStatus rt_file_read(const char *path, size_t limit, char **data, size_t *size, RtError *error) {
    return read_file(path, false, limit, data, size, error);
}

RtStatus rt_file_read_text(const char *path, size_t limit, char **text, size_t *size, RtError *error) {
    return read_file(path, true, limit, text, size, error);
}

bool rt_file_exists(const char *path) {
    return access(path, R_OK) == 0;
}

bool rt_file_exists_in(const char *folder, const char *name) {
    char path[RT_MAX_PATH];
    return rt_path_join(folder, name, path, NULL) == RT_OK && rt_file_exists(path);
}

bool rt_file_is_dead_link(const char *path, RtError *error) {
    char target[RT_MAX_PATH];
    struct stat info;
    ssize_t length = readlink(path, target, sizeof target - 1);
    if (length < 0 || stat(path, &info) == 0 || errno == EACCES) return false;
    target[length] = '\0';
    rt_fail(error, RT_BAD_INPUT, "%s is a symbolic link to a missing file: its target is '%s'", path, target);
    return true;
}

/* ---- folders and names ---- */

RtStatus rt_directory_create(const char *path, RtError *error) {
    char part[RT_MAX_PATH];
    if (strlen(path) >= sizeof part)
        return rt_fail(error, RT_BAD_INPUT, "%.80s...: the path is too long", path);
    for (size_t i = 0; path[i]; i++) {
        part[i] = path[i];
        part[i + 1] = '\0';
        bool end = path[i + 1] == '/' || path[i + 1] == '\0';
        if (path[i] == '/' || !end) continue;
        if (mkdir(part, 0777) != 0 && errno != EEXIST) return fail_io(error, "creating the directory", part);
    }
    struct stat info;
    if (stat(path, &info) == 0 && S_ISDIR(info.st_mode)) return RT_OK;
    return rt_fail(error, RT_IO, "%s: this is not a directory", path);
}

size_t rt_directory_each(const char *folder, const char *suffix,
                         void (*visit)(void *context, const char *path), void *context) {
    struct dirent **entries;
    int count = scandir(folder, &entries, NULL, alphasort);
    if (count < 0) return 0;
    size_t visited = 0;
    for (int i = 0; i < count; i++) {
        char path[RT_MAX_PATH];
        const char *name = entries[i]->d_name;
        if (rt_ends_in(name, suffix) && rt_path_join(folder, name, path, NULL) == RT_OK) {
            if (visit) visit(context, path);
            visited++;
        }
        free(entries[i]);
    }
    free(entries);
    return visited;
}

static void remove_file(void *context, const char *path) {
    (void)context;
    remove(path);
}

void rt_directory_remove_files(const char *folder, const char *suffix) {
    rt_directory_each(folder, suffix, remove_file, NULL);
}

RtStatus rt_path_join(const char *folder, const char *name, char *out, RtError *error) {
    bool alone = name[0] == '/' || folder[0] == '\0';
    int length =
        alone ? snprintf(out, RT_MAX_PATH, "%s", name) : snprintf(out, RT_MAX_PATH, "%s/%s", folder, name);
    if (length >= 0 && length < RT_MAX_PATH) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%.80s...: the path is too long", name);
}

void rt_file_name(const char *text, char *out, size_t size) {
    enum { HASH_CHARS = 9 };
    static const char portable[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._-";
    const int length = snprintf(out, size, "%s", *text ? text : "_");
    if (length >= (int)size)
        snprintf(out + size - 1 - HASH_CHARS, HASH_CHARS + 1, "-%08" PRIx32,
                 (uint32_t)XXH3_64bits(text, strlen(text)));
    for (char *c = out; *c; c++) {
        if (!strchr(portable, *c)) *c = '-';
    }
    if (*out == '.' || *out == '-') *out = '_';
}

void rt_path_folder(const char *path, char *out) {
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) : 0;
    if (slash == path) length = 1;
    if (length >= RT_MAX_PATH) length = 0;
    memcpy(out, path, length);
    out[length] = '\0';
}

/* ---- locks ---- */

/* The lock of a killed process outlives it for a moment, in a child that has not started its program yet. */
enum { MOST_TRIES = 100 };

RtStatus rt_lock_take(RtLock *lock, const char *path, RtError *error) {
    *lock = RT_NO_LOCK;
    int descriptor = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC), failed = 0;
    if (descriptor < 0 && (errno == ENOENT || errno == ENOTDIR)) return RT_OK;
    if (descriptor < 0) return rt_fail(error, RT_IO, "%s: cannot be opened: %s", path, strerror(errno));
    for (int tries = 0; tries < MOST_TRIES; tries++) {
        failed = flock(descriptor, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
        if (failed != EWOULDBLOCK) break;
        nanosleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
    }
    if (failed == 0) lock->descriptor = descriptor;
    if (failed != 0) close(descriptor);
    if (failed != EWOULDBLOCK) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT,
                   "%s: another process is writing into this directory: wait until it has ended", path);
}

void rt_lock_release(RtLock *lock) {
    if (rt_lock_is_held(lock)) close(lock->descriptor);
    *lock = RT_NO_LOCK;
}
