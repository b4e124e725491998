/* SPDX-License-Identifier: Apache-2.0 */
/* What tests of experiments share: a folder for each test, files in it, and what is said of them. */
#ifndef RT_TESTS_EXPERIMENT_TESTING_H
#define RT_TESTS_EXPERIMENT_TESTING_H

#include "testing.h"

#include "core/base/file.h"
#include "core/base/memory.h"
#include "results/result_directory.h"
#include "run/run.h"

#include <sys/wait.h>

/* A folder of a test's own. */
typedef struct Place {
    char folder[64];
    RtExperiment *experiment; /* for what is loaded there */
} Place;

static inline int make_place(void **state) {
    static Place place;
    strcpy(place.folder, "/tmp/raytally-test-XXXXXX");
    if (!mkdtemp(place.folder)) return -1;
    place.experiment = rt_alloc(1, sizeof(RtExperiment));
    *state = &place;
    return place.experiment ? 0 : -1;
}

static inline int remove_place(void **state) {
    Place *place = *state;
    char command[128];
    rt_free(place->experiment);
    snprintf(command, sizeof command, "rm -rf '%s'", place->folder);
    return system(command);
}

/* A test in a new `place`, which the file's make_places makes: PLACES_WITH, or a set-up of its own. */
#define PLACE_TEST(name)                                                                                     \
    static void name##_in(const Place *place);                                                               \
    RT_TEST_WITH(name, make_places, remove_place) {                                                          \
        name##_in(*state);                                                                                   \
    }                                                                                                        \
    static void name##_in(__attribute__((unused)) const Place *place)

/* Each place has this experiment in small.yaml; NULL: nothing. */
#define PLACES_WITH(experiment)                                                                              \
    static int make_places(void **state) {                                                                   \
        return make_place_with(state, experiment);                                                           \
    }

/* A new experiment of primary rays, with a millisecond for a round; for rt_free. */
static inline RtExperiment *primary_experiment(const char *name) {
    RtExperiment *e = rt_alloc(1, sizeof(RtExperiment));
    assert_non_null(e);
    rt_experiment_init(e);
    strcpy(e->name, name);
    e->milliseconds = 1;
    e->kind_count = 1;
    return e;
}

typedef struct Path {
    char text[256];
} Path;

static inline Path path_in(const Place *place, const char *name) {
    Path path;
    snprintf(path.text, sizeof path.text, "%s/%s", place->folder, name);
    return path;
}

static inline void write_in(const Place *place, const char *name, const char *text) {
    assert_ok(rt_file_write(path_in(place, name).text, text, strlen(text), error));
}

static inline int make_place_with(void **state, const char *experiment) {
    if (make_place(state) != 0) return -1;
    if (experiment) write_in(*state, "small.yaml", experiment);
    return 0;
}

/* The text with `to` in the place of `from`. */
static inline void write_changed(const Place *place, const char *name, const char *text, const char *from,
                                 const char *to) {
    char changed[16384];
    const char *at = strstr(text, from);
    assert_non_null(at);
    snprintf(changed, sizeof changed, "%.*s%s%s", (int)(at - text), text, to, at + strlen(from));
    write_in(place, name, changed);
}

/* small.yaml, to the place's experiment. */
static inline RtStatus load_small(const Place *place, bool quick, RtError *error) {
    return rt_experiment_load(place->experiment, path_in(place, "small.yaml").text, quick, NULL, error);
}

/* Runs small.yaml into a directory of the place, timed on one thread, and counted on one by default. */
static inline RtStatus run_small(const Place *place, const char *directory, bool quick, RtRunOptions how,
                                 RtError *error) {
    OWNED_RESULTS results = {0};
    Path path = path_in(place, directory);
    RT_TRY(load_small(place, quick, error));
    RT_TRY(rt_results_init(&results, place->experiment, error));
    how.directory = path.text;
    how.workload.timing = 1;
    if (!how.workload.threads) how.workload.threads = 1;
    return rt_run_experiment(&results, &how, error);
}

/* For rt_free. */
static inline char *read_in(const Place *place, const char *name) {
    char *text = NULL;
    size_t size;
    assert_ok(rt_file_read(path_in(place, name).text, 1 << 24, &text, &size, error));
    return text;
}

static inline int count_of(const char *text, const char *part) {
    int count = 0;
    for (; (text = strstr(text, part)) != NULL; text += strlen(part)) count++;
    return count;
}

/* All of one or more parts. */
#define assert_in_file(place, name, ...)                                                                     \
    assert_parts_in_file(place, name, (const char *const[]){__VA_ARGS__, NULL})

static inline void assert_parts_in_file(const Place *place, const char *name, const char *const *parts) {
    OWNED_MEMORY char *text = read_in(place, name);
    for (; *parts; parts++)
        if (!strstr(text, *parts)) fail_msg("%s has no '%s':\n%s", name, *parts, text);
}

static inline void assert_not_in_file(const Place *place, const char *name, const char *part) {
    OWNED_MEMORY char *text = read_in(place, name);
    if (strstr(text, part)) fail_msg("%s has '%s':\n%s", name, part, text);
}

static inline void assert_same_file(const Place *place, const char *name, const char *before) {
    OWNED_MEMORY char *now = read_in(place, name);
    assert_string_equal(now, before);
}

static inline void assert_equal_files(const Place *place, const char *a, const char *b) {
    OWNED_MEMORY char *text = read_in(place, b);
    assert_same_file(place, a, text);
}

/* Starts `raytally ARGUMENTS` in the folder, with what it says in the files output and message. */
static inline pid_t start_raytally(const Place *place, const char *arguments) {
    char command[512];
    snprintf(command, sizeof command, "cd '%s' && exec '%s' %s >output 2>message", place->folder, RT_PROGRAM,
             arguments);
    const pid_t child = fork();
    assert_true(child >= 0);
    if (child > 0) return child;
    execl("/bin/sh", "sh", "-c", command, (char *)NULL);
    _exit(127);
}

/* Waits for its end; the exit code, or 128 and the signal that ended it. */
static inline int end_of(pid_t child) {
    int how = 0;
    waitpid(child, &how, 0);
    return WIFEXITED(how) ? WEXITSTATUS(how) : 128 + WTERMSIG(how);
}

static inline int raytally(const Place *place, const char *arguments) {
    return end_of(start_raytally(place, arguments));
}

/* raytally must have ended with this exit code and have said this on standard error. */
static inline void assert_ended(const Place *place, const char *arguments, int ended, int code,
                                const char *says) {
    OWNED_MEMORY char *message = read_in(place, "message");
    if (ended != code || !strstr(message, says)) {
        fail_msg("raytally %s: exit code %d, expected %d with '%s': %s", arguments, ended, code, says,
                 message);
    }
}

/* Runs `raytally ARGUMENTS`, which must end so. */
static inline void assert_ends(const Place *place, const char *arguments, int code, const char *says) {
    assert_ended(place, arguments, raytally(place, arguments), code, says);
}

static inline void assert_runs(const Place *place, const char *arguments) {
    assert_ends(place, arguments, 0, "");
}

#endif
