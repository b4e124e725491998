/* SPDX-License-Identifier: Apache-2.0 */
#include "base/file.h"

#include "base/memory.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static RtStatus fail_io(RtError *error, const char *doing, const char *path) {
    return rt_fail(error, RT_IO, "%s: %s failed: %s", path, doing, strerror(errno));
}

RtStatus rt_output_open(RtOutput *output, const char *path, RtError *error) {
    output->file = NULL;
    if (strlen(path) >= RT_MAX_PATH)
        return rt_fail(error, RT_BAD_INPUT, "%.80s...: the path is too long", path);
    struct stat info;
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode)) {
        return rt_fail(error, RT_IO, "%s is a %s: give the name of a file", path,
                       S_ISDIR(info.st_mode) ? "folder" : "device or pipe, which a file would replace");
    }
    strcpy(output->path, path);
    snprintf(output->temporary, sizeof output->temporary, "%s.tmp", path);
    output->file = fopen(output->temporary, "wb");
    return output->file ? RT_OK : fail_io(error, "creating the file", output->temporary);
}

RtStatus rt_output_commit(RtOutput *output, RtError *error) {
    bool written = fflush(output->file) == 0 && !ferror(output->file) && fsync(fileno(output->file)) == 0;
    bool closed = fclose(output->file) == 0;
    output->file = NULL;
    if (written && closed && rename(output->temporary, output->path) == 0) return RT_OK;
    RtStatus status = fail_io(error, "writing", output->path);
    remove(output->temporary);
    return status;
}

void rt_output_discard(RtOutput *output) {
    if (!output->file) return;
    fclose(output->file);
    output->file = NULL;
    remove(output->temporary);
}

RtStatus rt_file_write(const char *path, const void *data, size_t size, RtError *error) {
    RtOutput output;
    RT_TRY(rt_output_open(&output, path, error));
    fwrite(data, 1, size, output.file);
    return rt_output_commit(&output, error);
}

RtStatus rt_file_copy(const char *from, const char *to, RtError *error) {
    enum { MOST_BYTES = 1 << 24 };
    char *data;
    size_t size;
    RT_TRY(rt_file_read(from, MOST_BYTES, &data, &size, error));
    RtStatus status = rt_file_write(to, data, size, error);
    rt_free(data);
    return status;
}

static RtStatus read_all(FILE *file, const char *path, size_t limit, char **data, size_t *size,
                         RtError *error) {
    struct stat info;
    if (fstat(fileno(file), &info) != 0) return fail_io(error, "reading", path);
    if ((uint64_t)info.st_size > limit) {
        return rt_fail(error, RT_BAD_INPUT, "%s: %lld bytes are too many: the limit is %zu", path,
                       (long long)info.st_size, limit);
    }
    char *buffer = rt_alloc((size_t)info.st_size + 1, 1);
    if (!buffer) return rt_fail_memory(error, path, (size_t)info.st_size + 1);
    *size = fread(buffer, 1, (size_t)info.st_size, file);
    if (ferror(file)) {
        rt_free(buffer);
        return fail_io(error, "reading", path);
    }
    buffer[*size] = '\0';
    *data = buffer;
    return RT_OK;
}

RtStatus rt_file_open(const char *path, FILE **file, RtError *error) {
    struct stat info;
    /* Before it is opened: opening a pipe waits for somebody to write to it. */
    if (stat(path, &info) == 0 && !S_ISREG(info.st_mode))
        return rt_fail(error, RT_BAD_INPUT, "%s: this is not a file", path);
    *file = fopen(path, "rb");
    if (*file) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%s: cannot be opened: %s", path, strerror(errno));
}

RtStatus rt_file_read(const char *path, size_t limit, char **data, size_t *size, RtError *error) {
    *data = NULL;
    *size = 0;
    FILE *file;
    RT_TRY(rt_file_open(path, &file, error));
    RtStatus status = read_all(file, path, limit, data, size, error);
    fclose(file);
    return status;
}

bool rt_file_exists(const char *path) {
    return access(path, R_OK) == 0;
}

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

static bool ends_in(const char *name, const char *suffix) {
    size_t length = strlen(name), tail = strlen(suffix);
    return length >= tail && strcmp(name + length - tail, suffix) == 0;
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
        if (ends_in(name, suffix) && rt_path_join(folder, name, path, NULL) == RT_OK) {
            visit(context, path);
            visited++;
        }
        free(entries[i]);
    }
    free(entries);
    return visited;
}

RtStatus rt_path_join(const char *folder, const char *name, char *out, RtError *error) {
    bool alone = name[0] == '/' || folder[0] == '\0';
    int length =
        alone ? snprintf(out, RT_MAX_PATH, "%s", name) : snprintf(out, RT_MAX_PATH, "%s/%s", folder, name);
    if (length >= 0 && length < RT_MAX_PATH) return RT_OK;
    return rt_fail(error, RT_BAD_INPUT, "%.80s...: the path is too long", name);
}

void rt_path_folder(const char *path, char *out) {
    const char *slash = strrchr(path, '/');
    size_t length = slash ? (size_t)(slash - path) : 0;
    if (slash == path) length = 1;
    if (length >= RT_MAX_PATH) length = 0;
    memcpy(out, path, length);
    out[length] = '\0';
}
