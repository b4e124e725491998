/* SPDX-License-Identifier: Apache-2.0 */
#include "measure/result_files.h"

#include "core/base/file.h"
#include "core/base/memory.h"

#include <stdio.h>
#include <string.h>

const char *const rt_result_files[RT_RESULT_FILE_COUNT] = {
#define NAME(ID, name) name,
    RT_RESULT_FILES(NAME)
#undef NAME
};

/* Files that are removed: all except the last, the copy of the experiment. */
enum { RESULTS = RT_FILE_EXPERIMENT };

/* The journal of results that are being removed. */
static const char given_up[] = "{\"given_up\": true}\n";

static bool is_given_up(const char *directory, const char *journal) {
    char path[RT_MAX_PATH], *text;
    size_t size;
    if (rt_path_join(directory, journal, path, NULL) != RT_OK) return false;
    if (rt_file_read(path, sizeof given_up - 1, &text, &size, NULL) != RT_OK) return false;
    bool same = strcmp(text, given_up) == 0;
    rt_free(text);
    return same;
}

static const char *find_result(const char *directory) {
    for (int i = 0; i < RESULTS; i++) {
        if (rt_file_exists_in(directory, rt_result_files[i])) return rt_result_files[i];
    }
    return NULL;
}

RtStatus rt_result_files_look(const char *directory, const char *journal, RtStart start, bool *goes_on,
                              RtError *error) {
    const char *result = find_result(directory);
    bool whole = rt_file_exists_in(directory, journal), removed = is_given_up(directory, journal);
    bool finished = rt_file_exists_in(directory, RT_MANIFEST) && !removed;
    *goes_on = whole && !removed && start == RT_START_RESUME;
    if (!result || *goes_on || start == RT_START_ANEW) return RT_OK;
    if (removed && start == RT_START_RESUME) return RT_OK;
    if (whole) {
        return rt_fail(
            error, RT_BAD_INPUT,
            "%s holds %s run: use --resume to %s, --force to start over and lose it, or another --out",
            directory, finished ? "a finished" : "an unfinished",
            finished ? "rewrite its tables" : "continue it");
    }
    if (strcmp(result, rt_result_files[RT_FILE_PACKED_JOURNAL]) == 0) {
        return rt_fail(
            error, RT_BAD_INPUT,
            "%s/%s is packed, and a packed journal is read-only: unpack it with gunzip to continue, use "
            "--force to start over and lose it, or another --out",
            directory, result);
    }
    return rt_fail(error, RT_BAD_INPUT,
                   "%s holds results of another kind, or without their journal (%s, but no %s), which cannot "
                   "be resumed: start over and lose them with --force, or give another --out",
                   directory, result, journal);
}

static void remove_each(const char *directory, const char *folder, const char *suffix) {
    char path[RT_MAX_PATH];
    if (rt_path_join(directory, folder, path, NULL) == RT_OK) rt_directory_remove_files(path, suffix);
}

RtStatus rt_result_files_remove(const char *directory, const char *journal, RtError *error) {
    char path[RT_MAX_PATH];
    if (!find_result(directory)) return RT_OK;
    RT_TRY(rt_path_join(directory, journal, path, error));
    RT_TRY(rt_file_write(path, given_up, sizeof given_up - 1, error));
    for (int i = 0; i < RESULTS; i++) {
        if (strcmp(rt_result_files[i], journal) == 0) continue;
        if (rt_path_join(directory, rt_result_files[i], path, NULL) == RT_OK) remove(path);
    }
    remove_each(directory, "plots", ".svg");
    remove_each(directory, "plots", ".pdf");
    remove_each(directory, "images", ".png");
    return RT_OK;
}
