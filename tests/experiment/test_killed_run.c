/* SPDX-License-Identifier: Apache-2.0 */
/* Runs and merges that are killed, at each of their calls that change a file: nothing is lost, and no mixture
 * of old and new is left.
 *
 * Linked so that calls of the functions wrapped below come here. */
#include "small_run_testing.h"

#include "report/report.h"
#include "run/run.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>

static RtStatus run_shard(const Place *place, const char *directory, uint32_t shard, RtStart start,
                          RtError *error) {
    RtRunOptions how = {.start = start, .report = rt_run_report};
    if (shard) how.workload.only = (RtSelection){.shard = shard, .shards = 2};
    return run_small(place, directory, false, how, error);
}

static RtStatus run(const Place *place, const char *directory, RtStart start, RtError *error) {
    return run_shard(place, directory, 0, start, error);
}

/* The shards in s1 and s2. */
static RtStatus merge(const Place *place, const char *directory, RtStart start, RtError *error) {
    OWNED_RESULTS results;
    Path shards[] = {path_in(place, "s1"), path_in(place, "s2")}, out = path_in(place, directory);
    const char *const directories[] = {shards[0].text, shards[1].text};
    const RtRunOptions options = {.directory = out.text, .start = start, .report = rt_run_report};
    RtStatus status = rt_merge(directories, 2, &options, place->experiment, &results, error);
    rt_results_clear(&results);
    return status;
}

/* ---- calls that come here ---- */

int __real_rename(const char *from, const char *to);
int __wrap_rename(const char *from, const char *to);
int __real_remove(const char *path);
int __wrap_remove(const char *path);
int __real_mkdir(const char *path, mode_t mode);
int __wrap_mkdir(const char *path, mode_t mode);
int __wrap_fsync(int file);
int __wrap_fdatasync(int file);
int __real_open(const char *path, int flags, ...);
int __wrap_open(const char *path, int flags, ...);
FILE *__real_fopen(const char *path, const char *mode);
FILE *__wrap_fopen(const char *path, const char *mode);

static int changes, last_change; /* of files, and the one at which to be killed; 0: never */

/* Whether this is the moment to be killed. */
static bool is_last_change(void) {
    return ++changes == last_change;
}

static void killed_here(void) {
    if (is_last_change()) kill(getpid(), SIGKILL);
}

int __wrap_rename(const char *from, const char *to) {
    killed_here();
    return __real_rename(from, to);
}

int __wrap_remove(const char *path) {
    killed_here();
    return __real_remove(path);
}

int __wrap_mkdir(const char *path, mode_t mode) {
    killed_here();
    return __real_mkdir(path, mode);
}

int __wrap_open(const char *path, int flags, ...) {
    va_list more;
    va_start(more, flags);
    mode_t mode = flags & O_CREAT ? va_arg(more, mode_t) : 0;
    va_end(more);
    if (flags & O_CREAT) killed_here();
    return __real_open(path, flags, mode);
}

FILE *__wrap_fopen(const char *path, const char *mode) {
    killed_here();
    return __real_fopen(path, mode);
}

/* What is written outlives the process without it: the disk is spared. */
int __wrap_fsync(int file) {
    (void)file;
    killed_here();
    return 0;
}

/* Behind a line of the journal, of which only a part may have got there. */
int __wrap_fdatasync(int file) {
    struct stat info;
    if (is_last_change()) {
        if (fstat(file, &info) == 0 && info.st_size > 9)
            assert_int_equal(ftruncate(file, info.st_size - 9), 0);
        kill(getpid(), SIGKILL);
    }
    return 0;
}

/* ---- the end at any moment ---- */

typedef RtStatus Work(const Place *place, const char *directory, RtStart start, RtError *error);

/* Works in a process of its own that is killed at this change of a file; whether it was. */
static bool killed_at(const Place *place, int change, Work *work, const char *directory, RtStart start) {
    int status;
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        changes = 0;
        last_change = change;
        _exit(work(place, directory, start, NULL) == RT_OK ? 0 : 1);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    if (WIFEXITED(status)) assert_int_equal(WEXITSTATUS(status), 0);
    return WIFSIGNALED(status);
}

static void assert_no_temporary(const Place *place, const char *directory) {
    char command[256];
    snprintf(command, sizeof command, "test -z \"$(find '%s/%s' -name '*.tmp')\"", place->folder, directory);
    assert_int_equal(system(command), 0);
}

enum { MOMENTS = 24 };

PLACE_TEST(a_run_that_is_killed_at_any_moment_resumes_to_the_same_counts) {
    changes = 0;
    assert_ok(run(place, "whole", RT_START_FRESH, error));
    int all = changes;
    assert_true(all > MOMENTS);
    OWNED_MEMORY char *whole = read_in(place, "whole/counts.csv");
    for (int i = 0; i <= MOMENTS; i++) {
        char directory[32], counts[64], cells[64];
        snprintf(directory, sizeof directory, "part-%d", i);
        snprintf(counts, sizeof counts, "%s/counts.csv", directory);
        snprintf(cells, sizeof cells, "%s/cells.jsonl", directory);
        assert_true(killed_at(place, 1 + i * (all - 1) / MOMENTS, run, directory, RT_START_FRESH));
        /* And once more while it goes on. */
        killed_at(place, 1 + 2 * i, run, directory, RT_START_RESUME);
        assert_ok(run(place, directory, RT_START_RESUME, error));
        assert_same_file(place, counts, whole);
        assert_no_temporary(place, directory);
        /* The journal has all of it: nothing is measured once more. */
        OWNED_MEMORY char *journal = read_in(place, cells);
        assert_ok(run(place, directory, RT_START_RESUME, error));
        assert_same_file(place, cells, journal);
    }
}

/* The last two have dates in them. */
static const char *const kept_files[] = {"experiment.yaml", "counts.csv", "images/cloud.png", "report.html",
                                         "manifest.json"};

enum { KEPT_FILES = 5, UNDATED_FILES = 3 };

static bool is_same_file(const Place *place, const char *a, const char *b, const char *name) {
    char *texts[2] = {NULL, NULL};
    size_t sizes[2] = {0};
    for (int i = 0; i < 2; i++) {
        char path[64];
        snprintf(path, sizeof path, "%s/%s", i ? b : a, name);
        if (rt_file_read(path_in(place, path).text, 1 << 24, &texts[i], &sizes[i], NULL) != RT_OK) break;
    }
    bool same = texts[0] && texts[1] && sizes[0] == sizes[1] && memcmp(texts[0], texts[1], sizes[0]) == 0;
    rt_free(texts[0]);
    rt_free(texts[1]);
    return same;
}

static void assert_same_results(const Place *place, const char *a, const char *b) {
    for (int i = 0; i < UNDATED_FILES; i++) {
        if (!is_same_file(place, a, b, kept_files[i]))
            fail_msg("%s: %s is not that of %s", a, kept_files[i], b);
    }
}

static void copy_folder(const Place *place, const char *from, const char *to) {
    char command[256];
    snprintf(command, sizeof command, "cd '%s' && rm -rf '%s' && cp -r '%s' '%s'", place->folder, to, from,
             to);
    assert_int_equal(system(command), 0);
}

/* Nothing has been lost of what was copied to out from `old`. */
static bool is_untouched(const Place *place, const char *old) {
    if (!is_same_file(place, "out", old, "cells.jsonl")) return false;
    for (int i = 0; i < KEPT_FILES; i++) {
        if (!is_same_file(place, "out", old, kept_files[i])) fail_msg("%s was lost", kept_files[i]);
    }
    return true;
}

/* Kills `work` over a copy of `old` at every other change of a file, and then goes on: what is untouched is
 * `old`, and all else becomes `new`, whose pictures and counts differ. */
static void kill_often(const Place *place, Work *work, int last) {
    int untouched = 0, begun = 0;
    for (int moment = 1; moment <= last; moment += 2) {
        copy_folder(place, "old", "out");
        assert_true(killed_at(place, moment, work, "out", RT_START_ANEW));
        if (is_untouched(place, "old")) {
            untouched++;
            continue;
        }
        assert_ok(work == merge && moment % 4 == 1 ? merge(place, "out", RT_START_ANEW, error)
                                                   : run(place, "out", RT_START_RESUME, error));
        assert_same_results(place, "out", "new");
        if (work == run) assert_no_temporary(place, "out");
        begun++;
    }
    assert_true(untouched > 3 && begun > 3);
}

PLACE_TEST(a_run_that_begins_anew_and_is_killed_leaves_the_old_one_whole_or_the_new_one_to_be_resumed) {
    assert_ok(run(place, "old", RT_START_FRESH, error));
    write_changed(place, "small.yaml", small_experiment, "cloud, size: 8x8", "cloud, size: 10x8");
    assert_ok(run(place, "new", RT_START_FRESH, error));
    kill_often(place, run, 49);
}

PLACE_TEST(a_merge_that_is_killed_leaves_the_earlier_results_whole_or_can_be_made_again) {
    assert_ok(run(place, "old", RT_START_FRESH, error));
    write_changed(place, "small.yaml", small_experiment, "cloud, size: 8x8", "cloud, size: 10x8");
    for (uint32_t shard = 1; shard <= 2; shard++)
        assert_ok(run_shard(place, shard == 1 ? "s1" : "s2", shard, RT_START_FRESH, error));
    assert_ok(merge(place, "new", RT_START_FRESH, error));
    changes = 0;
    copy_folder(place, "old", "out");
    assert_ok(merge(place, "out", RT_START_ANEW, error));
    kill_often(place, merge, changes);
}

RT_TESTS(killed_run, NULL, NULL)
